//! Plane of springs and dampers.

use super::{
    ContactLaw, GroundBounds, MeanForce, Plane, SpringDamper, SpringDamperGround, Surface,
};
use crate::error::SceneError;
use crate::real::Real;

/// A plane, level or tilted, with a spring and a damper for each contact (Kelvin-Voigt, never
/// pulling). It is the ground of the coin report.
///
/// `normal force = max(0, stiffness · depth + damping · closing_speed)` in newtons where
/// `depth > 0`, else 0. The energy in the springs is `stiffness · depth²/2` for every contact below
/// the plane, also for one that separates so fast that its force is 0.
///
/// *Limits:* the damper's force jumps from 0 to `damping · closing_speed` at touch-down. An
/// explicit method then has order 1 only. A point of mass m bounces with restitution
/// `exp(-2ζ arccos(ζ)/√(1-ζ²))`, `ζ = damping/(2 √(stiffness m)) < 1`, at every speed whose square
/// is far above `(g/ω)²`, with `ω = √(stiffness/m)`. [`SpringDamper`](crate::SpringDamper) has the
/// restitution for a larger ζ. That of a real ball decreases with its speed.
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
    /// Stiffness per contact, N/m, at least 0.
    pub stiffness: R,
    /// Damping per contact, N s/m, at least 0.
    pub damping: R,
    /// Surface of the ground.
    pub plane: Plane<R>,
}

impl<R: Real> FlatGround<R> {
    /// Creates the ground z = 0 from a stiffness in N/m and a damping in N s/m, both per contact.
    #[must_use]
    pub fn level(stiffness: R, damping: R) -> Self {
        Self {
            stiffness,
            damping,
            plane: Plane::level(R::ZERO),
        }
    }

    /// Returns the contact law of the ground.
    #[inline]
    #[must_use]
    pub fn law(&self) -> SpringDamper<R> {
        SpringDamper {
            stiffness: self.stiffness,
            damping: self.damping,
        }
    }

    /// Returns the ground with the same contact law on another plane.
    #[must_use]
    pub fn on(self, plane: Plane<R>) -> Self {
        Self { plane, ..self }
    }
}

impl<R: Real> SpringDamperGround<R> for FlatGround<R> {
    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }

    #[inline]
    fn surface(&self, point: R::Vec3) -> Surface<R> {
        Surface {
            gap: self.plane.gap(point),
            normal: self.plane.normal,
        }
    }

    #[inline]
    fn spring_force(&self, depth: R) -> R {
        self.law().spring_force(depth)
    }

    #[inline]
    fn spring_energy(&self, depth: R) -> R {
        self.law().spring_energy(depth)
    }

    #[inline]
    fn normal_force(&self, depth: R, closing_speed: R) -> R {
        self.law().normal_force(depth, closing_speed)
    }

    #[inline]
    fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        self.law().mean_force(start, end, seconds)
    }

    #[inline]
    fn bounds(&self) -> GroundBounds<R> {
        GroundBounds::Plane(self.plane)
    }

    fn check(&self) -> Result<(), SceneError> {
        self.law().check()?;
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
