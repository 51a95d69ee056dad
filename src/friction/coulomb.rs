//! Coulomb friction, made finite at zero slip in two ways.

use super::{FrictionJacobian, SlidingFriction};
use crate::error::{self, SceneError};
use crate::real::{Real, Vector};

/// Coulomb friction that turns viscous at small slip, in the report's form.
///
/// `force = -coefficient · normal_force · slip / (|slip| + slip_speed)`, in newtons, world axes.
/// Never adds energy: `force · slip <= 0`. Finite at zero slip.
///
/// *Limits:* it does not stick. On a slope of angle θ a body creeps at
/// `slip_speed · tan θ / (coefficient - tan θ)`. At a slip of 100 slip speeds the force is still 1
/// % short of Coulomb's. Small slip speeds make the equations stiff: explicit methods chatter in
/// stick, with flips of about `coefficient · g · time step`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Coulomb<R = f64> {
    /// Dimensionless, at least 0.
    pub coefficient: R,
    /// m/s, above 0. The slip at which half of the full force is reached.
    pub slip_speed: R,
}

impl<R: Real> Coulomb<R> {
    /// The slip speed of the report, m/s: small enough to be Coulomb's law for every slip that
    /// matters.
    pub const REPORT_SLIP_SPEED: f64 = 1e-10;

    /// The report's law: a slip speed of 1e-10 m/s.
    #[must_use]
    pub fn as_in_the_report(coefficient: R) -> Self {
        Self {
            coefficient,
            slip_speed: R::from_f64(Self::REPORT_SLIP_SPEED),
        }
    }
}

impl<R: Real> SlidingFriction<R> for Coulomb<R> {
    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }

    #[inline]
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        slip * (-self.coefficient * normal_force / (slip.length() + self.slip_speed))
    }

    #[inline]
    fn jacobian(&self, normal_force: R, slip: R::Vec3) -> FrictionJacobian<R> {
        let width = slip.length() + self.slip_speed;
        let per_load = self.coefficient / width;
        FrictionJacobian {
            coefficient: per_load * normal_force,
            per_load,
            width,
            growth: R::ONE,
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        check(self.coefficient, self.slip_speed)
    }
}

/// Coulomb friction that turns viscous at small slip, smoothly.
///
/// `force = -coefficient · normal_force · slip / √(slip² + slip_speed²)`, in newtons, world axes.
/// Never adds energy: `force · slip <= 0`. Finite, with all its derivatives, at zero slip.
///
/// *Limits:* as of [`Coulomb`], with less creep and a quicker approach: on a slope of angle θ a
/// body creeps at `slip_speed · tan θ / √(coefficient² - tan² θ)`, and the force is 1 % short of
/// Coulomb's at 7 slip speeds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SmoothCoulomb<R = f64> {
    /// Dimensionless, at least 0.
    pub coefficient: R,
    /// m/s, above 0. The slip at which 71 % of the full force is reached.
    pub slip_speed: R,
}

impl<R: Real> SmoothCoulomb<R> {
    /// `√(slip² + slip_speed²)`.
    #[inline]
    fn width(&self, slip: R::Vec3) -> R {
        // The square of a tiny slip speed may underflow; the root is never below the slip speed
        // itself.
        (slip.length_squared() + self.slip_speed * self.slip_speed)
            .sqrt()
            .at_least(self.slip_speed)
    }
}

impl<R: Real> SlidingFriction<R> for SmoothCoulomb<R> {
    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }

    #[inline]
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        slip * -(self.coefficient * normal_force / self.width(slip))
    }

    #[inline]
    fn jacobian(&self, normal_force: R, slip: R::Vec3) -> FrictionJacobian<R> {
        let width = self.width(slip);
        let per_load = self.coefficient / width;
        FrictionJacobian {
            coefficient: per_load * normal_force,
            per_load,
            width,
            growth: slip.length() / width,
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        check(self.coefficient, self.slip_speed)
    }
}

fn check<R: Real>(coefficient: R, slip_speed: R) -> Result<(), SceneError> {
    error::at_least_zero("coefficient of friction", coefficient, "")?;
    error::above_zero("slip speed of the friction", slip_speed, " m/s")
}
