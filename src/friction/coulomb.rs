//! Coulomb friction with two regularisations at zero slip.

use super::{FrictionJacobian, SlidingFriction};
use crate::error::{self, SceneError};
use crate::real::{Real, Vector};

/// Coulomb friction that becomes viscous at small slip, as in the coin report.
///
/// `force = -coefficient · normal_force · slip / (|slip| + slip_speed)`, in newtons, world axes.
/// The force never adds energy (`force · slip <= 0`) and is finite at zero slip.
///
/// *Limits:*
/// - It does not stick. On a slope of angle θ a body creeps at
///   `slip_speed · tan θ / (coefficient - tan θ)`.
/// - At a slip of 100 slip speeds the force is still 1 % below that of Coulomb's law.
/// - Small slip speeds make the equations stiff. In stick, explicit methods oscillate with velocity
///   changes of about `coefficient · g · time step`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Coulomb<R = f64> {
    /// Coefficient of friction, dimensionless, at least 0.
    pub coefficient: R,
    /// Slip at which half of the full force is reached, m/s, above 0 and a
    /// [safe divisor](crate::error::Rule::SafeDivisor).
    pub slip_speed: R,
}

impl<R: Real> Coulomb<R> {
    /// Slip speed of the coin report, m/s. It is far below the slip of any visible motion, for
    /// which the law is Coulomb's.
    pub const REPORT_SLIP_SPEED: f64 = 1e-10;

    /// Creates the law of the coin report, with a slip speed of 1e-10 m/s.
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
    fn is_proportional_to_load(&self) -> bool {
        true
    }

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

/// Coulomb friction that becomes viscous at small slip, with a smooth transition.
///
/// `force = -coefficient · normal_force · slip / √(slip² + slip_speed²)`, in newtons, world axes.
/// The force never adds energy (`force · slip <= 0`). It is finite, with all its derivatives, at
/// zero slip.
///
/// *Limits:* those of [`Coulomb`], with less creep and a faster approach to Coulomb's law. On a
/// slope of angle θ a body creeps at `slip_speed · tan θ / √(coefficient² - tan² θ)`. At 7 slip
/// speeds the force is 1 % below that of Coulomb's law.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SmoothCoulomb<R = f64> {
    /// Coefficient of friction, dimensionless, at least 0.
    pub coefficient: R,
    /// Slip at which 71 % of the full force is reached, m/s, above 0 and a
    /// [safe divisor](crate::error::Rule::SafeDivisor).
    pub slip_speed: R,
}

impl<R: Real> SmoothCoulomb<R> {
    /// Regularised size of the slip, `√(slip² + slip_speed²)`.
    #[inline]
    fn width(&self, slip: R::Vec3) -> R {
        // The square of a tiny slip speed may underflow. The root is therefore limited to the slip
        // speed from below.
        (slip.length_squared() + self.slip_speed * self.slip_speed)
            .sqrt()
            .at_least(self.slip_speed)
    }
}

impl<R: Real> SlidingFriction<R> for SmoothCoulomb<R> {
    #[inline]
    fn is_proportional_to_load(&self) -> bool {
        true
    }

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
    error::slip_speed(slip_speed)
}
