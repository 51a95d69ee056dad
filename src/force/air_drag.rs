//! Drag of still air on the centre of mass.

use core::f64::consts::PI;

use super::{Force, Wrench};
use crate::error::{self, SceneError};
use crate::real::{Real, Vector};
use crate::state::Motion;

/// Drag of a fluid at rest: linear, quadratic or both.
///
/// `F = -(linear + quadratic |v|) v`, in newtons, world axes. It acts at the centre of mass and has
/// no torque. [`Wind`](super::Wind) makes the fluid move, [`SpinDrag`](super::SpinDrag) slows the
/// spin.
///
/// ```
/// use tumble::AirDrag;
///
/// // A ball of 6.7 cm in air of 1.2 kg/m³, drag coefficient 0.5: 1.06e-3 N at 1 m/s.
/// let area = std::f64::consts::PI * 0.0335 * 0.0335; // m²
/// let drag = AirDrag::quadratic(0.5, area, 1.2);
/// assert!((drag.quadratic - 1.0577e-3).abs() < 1e-7); // N s²/m²
/// ```
///
/// *Limits:* the drag does not depend on the orientation, so it suits balls and bodies that tumble
/// fast. The drag coefficient is constant. That of a smooth sphere is between 0.4 and 0.5 for
/// Reynolds numbers from 1e3 to 2e5, and falls to 0.1 beyond. Linear drag holds for Reynolds
/// numbers below about 0.1 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AirDrag<R = f64> {
    /// Force per speed, N s/m, at least 0.
    pub linear: R,
    /// Force per square of the speed, N s²/m², at least 0.
    pub quadratic: R,
}

impl<R: Real> AirDrag<R> {
    /// Creates a drag in proportion to the speed, with a force per speed in N s/m.
    #[must_use]
    pub fn linear(per_speed: R) -> Self {
        Self {
            linear: per_speed,
            quadratic: R::ZERO,
        }
    }

    /// Creates the linear drag of a sphere of `radius` (m) in a fluid of dynamic `viscosity` (Pa
    /// s): `6 π η r` (Stokes). Air at 20 °C has 1.8e-5 Pa s.
    #[must_use]
    pub fn stokes(radius: R, viscosity: R) -> Self {
        Self::linear(R::from_f64(6.0 * PI) * viscosity * radius)
    }

    /// Creates a drag in proportion to the square of the speed: `C ρ A/2`, with the drag
    /// `coefficient` C, the `area` A of the cross section (m²) and the `density` ρ of the fluid
    /// (kg/m³). Air at 20 °C has 1.2 kg/m³.
    #[must_use]
    pub fn quadratic(coefficient: R, area: R, density: R) -> Self {
        Self {
            linear: R::ZERO,
            quadratic: coefficient * area * density * R::HALF,
        }
    }
}

impl<R: Real> Force<R> for AirDrag<R> {
    #[inline]
    fn wrench(&self, motion: &Motion<R>) -> Wrench<R> {
        let velocity = motion.linear_velocity;
        let per_speed = self.linear + self.quadratic * velocity.length();
        Wrench::of_force(velocity * -per_speed)
    }

    #[inline]
    fn is_passive(&self) -> bool {
        true
    }

    #[inline]
    fn wrench_change(
        &self,
        motion: &Motion<R>,
        linear_change: R::Vec3,
        _angular_change: R::Vec3,
    ) -> Wrench<R> {
        // d(|v| v) = |v| dv + v (v · dv)/|v|
        let velocity = motion.linear_velocity;
        let speed = velocity.length();
        let mut change = linear_change * -(self.linear + self.quadratic * speed);
        if speed > R::ZERO {
            change -= velocity * (self.quadratic * velocity.dot(linear_change) / speed);
        }
        Wrench::of_force(change)
    }

    fn check(&self) -> Result<(), SceneError> {
        error::at_least_zero("linear drag", self.linear, " N s/m")?;
        error::at_least_zero("quadratic drag", self.quadratic, " N s²/m²")
    }

    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }
}
