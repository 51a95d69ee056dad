//! Torque of still air against the spin of a body.

use core::f64::consts::PI;

use super::{Force, Wrench};
use crate::error::{self, SceneError};
use crate::real::{Real, Vector};
use crate::state::Motion;

/// Torque of a fluid at rest against spin: linear, quadratic or both.
///
/// `T = -(linear + quadratic |ω|) ω`, in N m, world axes.
///
/// *Limits:* the torque does not depend on the axis of the spin or on the speed of the centre of
/// mass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpinDrag<R = f64> {
    /// Torque per angular speed, N m s, at least 0.
    pub linear: R,
    /// Torque per square of the angular speed, N m s², at least 0.
    pub quadratic: R,
}

impl<R: Real> SpinDrag<R> {
    /// Creates a torque in proportion to the angular speed, in N m s.
    #[must_use]
    pub fn linear(per_speed: R) -> Self {
        Self {
            linear: per_speed,
            quadratic: R::ZERO,
        }
    }

    /// Creates the linear torque on a sphere of `radius` (m) in a fluid of dynamic `viscosity`
    /// (Pa s): `8 π η r³` (Kirchhoff; Lamb, Hydrodynamics, section 334).
    #[must_use]
    pub fn kirchhoff(radius: R, viscosity: R) -> Self {
        Self::linear(R::from_f64(8.0 * PI) * viscosity * radius * radius * radius)
    }

    /// Creates a torque in proportion to the square of the angular speed: `C ρ r⁵/2`, with the
    /// moment `coefficient` C, the `radius` r (m) and the `density` ρ of the fluid (kg/m³).
    #[must_use]
    pub fn quadratic(coefficient: R, radius: R, density: R) -> Self {
        let square = radius * radius;
        Self {
            linear: R::ZERO,
            quadratic: coefficient * density * square * square * radius * R::HALF,
        }
    }
}

impl<R: Real> Force<R> for SpinDrag<R> {
    #[inline]
    fn wrench(&self, motion: &Motion<R>) -> Wrench<R> {
        let spin = motion.angular_velocity;
        let per_speed = self.linear + self.quadratic * spin.length();
        Wrench::of_torque(spin * -per_speed)
    }

    #[inline]
    fn is_passive(&self) -> bool {
        true
    }

    #[inline]
    fn wrench_change(
        &self,
        motion: &Motion<R>,
        _linear_change: R::Vec3,
        angular_change: R::Vec3,
    ) -> Wrench<R> {
        let spin = motion.angular_velocity;
        let speed = spin.length();
        let mut change = angular_change * -(self.linear + self.quadratic * speed);
        if speed > R::ZERO {
            change -= spin * (self.quadratic * spin.dot(angular_change) / speed);
        }
        Wrench::of_torque(change)
    }

    fn check(&self) -> Result<(), SceneError> {
        error::at_least_zero("linear spin drag", self.linear, " N m s")?;
        error::at_least_zero("quadratic spin drag", self.quadratic, " N m s²")
    }

    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }
}
