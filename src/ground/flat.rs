//! A plane of springs and dampers.

use super::{Extent, MeanForce, Plane, SpringDamperGround, Surface};
use crate::error::{self, SceneError};
use crate::real::Real;

/// A plane, level or tilted, with a spring and a damper under each contact (Kelvin-Voigt, never pulling): the ground of the report.
///
/// `normal force = max(0, stiffness · depth + damping · closing_speed)` in newtons where `depth > 0`, else 0. Energy in the springs: `stiffness · depth²/2`
/// for every contact below the plane, also one that leaves so fast that its force is 0.
///
/// *Limits:* the damper's force jumps from 0 to `damping · closing_speed` at first touch, which spoils an explicit method's order above 1.
/// A point of mass m bounces with restitution `exp(-2ζ arccos(ζ)/√(1-ζ²))`, `ζ = damping/(2 √(stiffness m))`, at every speed: real balls bounce less the faster they are.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "R: serde::Serialize, R::Vec3: serde::Serialize",
        deserialize = "R: serde::Deserialize<'de>, R::Vec3: serde::Deserialize<'de>"
    ))
)]
pub struct FlatGround<R: Real = f64> {
    /// N/m per contact, at least 0.
    pub stiffness: R,
    /// N s/m per contact, at least 0.
    pub damping: R,
    /// The surface.
    pub plane: Plane<R>,
}

impl<R: Real> FlatGround<R> {
    /// The plane z = 0; stiffness in N/m and damping in N s/m, both per contact.
    #[must_use]
    pub fn level(stiffness: R, damping: R) -> Self {
        Self {
            stiffness,
            damping,
            plane: Plane::level(R::ZERO),
        }
    }

    /// The same springs under another plane.
    #[must_use]
    pub fn on(self, plane: Plane<R>) -> Self {
        Self { plane, ..self }
    }
}

impl<R: Real> FlatGround<R> {
    #[inline]
    fn mean_force_down(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        let (k, c) = (self.stiffness, self.damping);
        let path = end - start;
        if start >= R::ZERO {
            MeanForce {
                force: k * ((start + end) * R::HALF) + c * (path / seconds),
                slope: k * R::HALF + c / seconds,
                stiffness: k * R::HALF,
                damping: c,
            }
        } else if end > R::ZERO {
            let share = end / path;
            let stiffness = k * (share * (R::ONE - share * R::HALF));
            MeanForce {
                force: k * (end * share * R::HALF) + c * (end / seconds),
                slope: stiffness + c / seconds,
                stiffness,
                damping: c * share,
            }
        } else {
            MeanForce::NONE
        }
    }

    #[inline]
    fn mean_force_up(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        let (k, c) = (self.stiffness, self.damping);
        let path = start - end;
        if start <= R::ZERO || k == R::ZERO {
            return MeanForce::NONE;
        }
        let cut = c * path / (seconds * k);
        let (over_start, over_end) = (start - cut, end - cut);
        if over_end >= R::ZERO {
            MeanForce {
                force: k * ((over_start + over_end) * R::HALF),
                slope: k * R::HALF + c / seconds,
                stiffness: k * R::HALF,
                damping: c,
            }
        } else if over_start > R::ZERO {
            let share = over_start / path;
            let stiffness = k * (share * share * R::HALF);
            MeanForce {
                force: k * (over_start * share * R::HALF),
                slope: c * (share / seconds) + stiffness,
                stiffness,
                damping: c * share,
            }
        } else {
            MeanForce::NONE
        }
    }
}

impl<R: Real> SpringDamperGround<R> for FlatGround<R> {
    #[inline]
    fn surface(&self, point: R::Vec3) -> Surface<R> {
        Surface {
            gap: self.plane.gap(point),
            normal: self.plane.normal,
        }
    }

    #[inline]
    fn spring_force(&self, depth: R) -> R {
        self.stiffness * depth
    }

    #[inline]
    fn spring_energy(&self, depth: R) -> R {
        self.stiffness * depth * depth * R::HALF
    }

    #[inline]
    fn normal_force(&self, depth: R, closing_speed: R) -> R {
        (self.stiffness * depth + self.damping * closing_speed).at_least(R::ZERO)
    }

    /// The integral of the whole clamped law along an even path, in closed form (k: stiffness, c: damping, d₀ and d₁: depths, Δ = d₁ - d₀, h: time):
    ///
    /// - going down from d₀ >= 0: `k (d₀ + d₁)/2 + c Δ/h`; from above ground: `k d₁²/(2Δ) + c d₁/h`;
    /// - going up: the clamp cuts where `k d + c Δ/h` falls to 0, at the depth `d* = -c Δ/(h k)`; with `eᵢ = dᵢ - d*` the mean is
    ///   `k (e₀ + e₁)/2` while e₁ >= 0, `k e₀²/(2|Δ|)` while e₀ > 0, then 0.
    ///
    /// Continuous, rising with d₁, and without a 0/0 as Δ goes to 0.
    #[inline]
    fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        let path = end - start;
        if path >= R::ZERO {
            self.mean_force_down(start, end, seconds)
        } else {
            self.mean_force_up(start, end, seconds)
        }
    }

    #[inline]
    fn extent(&self) -> Extent<R> {
        Extent::Plane(self.plane)
    }

    fn check(&self) -> Result<(), SceneError> {
        error::at_least_zero("stiffness of the ground", self.stiffness, " N/m")?;
        error::at_least_zero("damping of the ground", self.damping, " N s/m")?;
        self.plane.check()
    }
}

#[cfg(test)]
mod tests {
    #![allow(
        clippy::float_cmp,
        reason = "these forces are sums of products that round to whole numbers"
    )]

    use super::*;

    #[test]
    fn the_ground_pushes_and_never_pulls() {
        let ground = FlatGround::level(1000.0, 0.5);
        assert_eq!(ground.normal_force(0.01, 2.0), 11.0);
        assert_eq!(ground.normal_force(0.01, -2.0), 9.0);
        assert_eq!(ground.normal_force(0.01, -30.0), 0.0);
    }
}
