//! The report's law: a spring and a damper side by side, that never pull.

use super::bounce::{self, Carried};
use super::{ContactLaw, MeanForce};
use crate::error::{self, SceneError};
use crate::real::Real;

/// A spring and a damper side by side (Kelvin-Voigt) that never pull: the law of the report, and of
/// [`FlatGround`](crate::FlatGround).
///
/// `normal force = max(0, stiffness · depth + damping · closing_speed)`, in newtons. Energy in the
/// spring: `stiffness · depth²/2`, also where the contact leaves so fast that its force is 0.
///
/// *Limits:* the damper's force jumps from 0 to `damping · closing_speed` at first touch, which
/// spoils an explicit method's order above 1. A point of mass m bounces with restitution
/// `exp(-2ζ arccos(ζ)/√(1-ζ²))`, `ζ = damping/(2 √(stiffness m))`, at every speed whose square is
/// far above `(g/ω)²`, `ω = √(stiffness/m)`: real balls bounce less the faster they are
/// ([`HuntCrossley`](crate::HuntCrossley)).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpringDamper<R = f64> {
    /// N/m per contact, at least 0.
    pub stiffness: R,
    /// N s/m per contact, at least 0.
    pub damping: R,
}

impl<R: Real> SpringDamper<R> {
    /// The law by which a body bounces with this restitution (-, above 0, at most 1), on and off in
    /// `contact_time` (s).
    ///
    /// Without gravity during the bounce, and for contacts that touch together under the centre of
    /// mass: `restitution = exp(-2ζ α)`, `contact_time = 2 α/ω`, `α = arccos(ζ)/√(1-ζ²)` (Schwager
    /// & Pöschel, Granular Matter 9, 465, 2007). Gravity makes a bounce longer and its restitution
    /// less where `speed · ω` is not far above g.
    ///
    /// # Errors
    /// Where a number is not in its range.
    pub fn from_bounce(
        carried: Carried<R>,
        restitution: R,
        contact_time: R,
    ) -> Result<Self, SceneError> {
        let ratio = bounce::spring_damper_ratio(restitution)?;
        let frequency = bounce::frequency_in(2.0 * bounce::release_angle(ratio), contact_time)?;
        carried.on(frequency, ratio)
    }

    /// The law on which a body sinks by `sink_depth` (m) at rest under `gravity` (m/s²), and
    /// bounces with this restitution (-, above 0, at most 1).
    ///
    /// `stiffness = m g/depth`; the restitution as of [`from_bounce`](Self::from_bounce).
    ///
    /// # Errors
    /// Where a number is not in its range.
    pub fn from_rest(
        carried: Carried<R>,
        restitution: R,
        sink_depth: R,
        gravity: R,
    ) -> Result<Self, SceneError> {
        let ratio = bounce::spring_damper_ratio(restitution)?;
        carried.on(bounce::frequency_at_rest(sink_depth, gravity)?, ratio)
    }
}

impl<R: Real> SpringDamper<R> {
    #[inline]
    fn mean_force_down(&self, start: R, end: R, per_second: R) -> MeanForce<R> {
        let (k, c) = (self.stiffness, self.damping);
        let path = end - start;
        if start >= R::ZERO {
            MeanForce {
                force: k * ((start + end) * R::HALF) + c * (path * per_second),
                slope: k * R::HALF + c * per_second,
                stiffness: k * R::HALF,
                damping: c,
            }
        } else if end > R::ZERO {
            let share = end / path;
            let stiffness = k * (share * (R::ONE - share * R::HALF));
            MeanForce {
                force: k * (end * share * R::HALF) + c * (end * per_second),
                slope: stiffness + c * per_second,
                stiffness,
                damping: c * share,
            }
        } else {
            MeanForce::NONE
        }
    }

    #[inline]
    pub(super) fn mean_force_up(&self, start: R, end: R, per_second: R) -> MeanForce<R> {
        let (k, c) = (self.stiffness, self.damping);
        let path = start - end;
        if start <= R::ZERO || k == R::ZERO {
            return MeanForce::NONE;
        }
        let cut = c * path * per_second / k;
        let (over_start, over_end) = (start - cut, end - cut);
        if over_end >= R::ZERO {
            MeanForce {
                force: k * ((over_start + over_end) * R::HALF),
                slope: k * R::HALF + c * per_second,
                stiffness: k * R::HALF,
                damping: c,
            }
        } else if over_start > R::ZERO {
            let share = over_start / path;
            let stiffness = k * (share * share * R::HALF);
            MeanForce {
                force: k * (over_start * share * R::HALF),
                slope: c * (share * per_second) + stiffness,
                stiffness,
                damping: c * share,
            }
        } else {
            MeanForce::NONE
        }
    }
}

impl<R: Real> ContactLaw<R> for SpringDamper<R> {
    #[inline]
    fn is_trusted(&self) -> bool {
        true
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

    /// The integral of the whole clamped law along an even path, in closed form (k: stiffness, c:
    /// damping, d₀ and d₁: depths, Δ = d₁ - d₀, h: time):
    ///
    /// - going down from d₀ >= 0: `k (d₀ + d₁)/2 + c Δ/h`; from above ground:
    ///   `k d₁²/(2Δ) + c d₁/h`;
    /// - going up: the clamp cuts where `k d + c Δ/h` falls to 0, at the depth `d* = -c Δ/(h k)`;
    ///   with `eᵢ = dᵢ - d*` the mean is `k (e₀ + e₁)/2` while e₁ >= 0, `k e₀²/(2|Δ|)` while e₀ >
    ///   0, then 0.
    ///
    /// Continuous, rising with d₁, and without a 0/0 as Δ goes to 0.
    #[inline]
    fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        let path = end - start;
        // The same for all contacts of a step: its division is taken out of their loop.
        let per_second = R::ONE / seconds;
        if path >= R::ZERO {
            self.mean_force_down(start, end, per_second)
        } else {
            self.mean_force_up(start, end, per_second)
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        error::at_least_zero("stiffness of the ground", self.stiffness, " N/m")?;
        error::at_least_zero("damping of the ground", self.damping, " N s/m")
    }
}
