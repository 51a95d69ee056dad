//! Lift of a spinning ball (Magnus effect).

use core::f64::consts::PI;

use super::{Force, Wrench};
use crate::error::{self, SceneError};
use crate::real::{Real, Vector};
use crate::state::Motion;

/// Lift of a spinning ball in still air: a force across its velocity and its spin (Magnus effect).
///
/// ```text
/// F = C_L ρ A v²/2   along ω × v          C_L = S slope/(1 + S slope/limit)
/// ```
/// `S = r |ω × v|/v²` is the spin parameter: speed of the surface over speed of the ball, with the
/// part of the spin across the velocity. `A = π r²` is the cross section and `ρ` the density of the
/// air. A ball with topspin is pressed down. The force is perpendicular to the velocity, so it does
/// no work.
///
/// [`tennis_ball`](Self::tennis_ball) has slope 1 and limit 1/2, hence `C_L = 1/(2 + v/(r ω))`:
/// the fit of Stepanek, rounded (Am. J. Phys. 56, 138, 1988).
///
/// *Limits:* the coefficient is a fit for rough balls at S from 0.05 to 0.6. A smooth ball can have
/// a lift of the other sign near its drag crisis. Use [`Wind`](super::Wind) for moving air.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpinLift<R = f64> {
    /// Radius of the ball, m, above 0.
    pub radius: R,
    /// Density of the air, kg/m³, at least 0.
    pub density: R,
    /// Lift coefficient over spin parameter for slow spin, at least 0.
    pub slope: R,
    /// Lift coefficient for fast spin, above 0.
    pub limit: R,
}

impl<R: Real> SpinLift<R> {
    /// Creates the lift of a tennis ball of `radius` (m) in air of `density` (kg/m³).
    #[must_use]
    pub fn tennis_ball(radius: R, density: R) -> Self {
        Self {
            radius,
            density,
            slope: R::ONE,
            limit: R::HALF,
        }
    }

    /// Lift coefficient at a spin parameter (at least 0).
    #[must_use]
    pub fn coefficient(&self, spin_parameter: R) -> R {
        let rise = self.slope * spin_parameter;
        rise / (R::ONE + rise / self.limit)
    }
}

impl<R: Real> Force<R> for SpinLift<R> {
    #[inline]
    fn wrench(&self, motion: &Motion<R>) -> Wrench<R> {
        let velocity = motion.linear_velocity;
        let across = motion.angular_velocity.cross(velocity);
        let square = velocity.length_squared();
        // S v² slope/limit
        let saturation = across.length() * self.radius * (self.slope / self.limit);
        let sum = square + saturation;
        if sum <= R::ZERO {
            return Wrench::ZERO;
        }
        let area = R::from_f64(PI) * self.radius * self.radius;
        let per_radius = self.density * area * R::HALF * self.slope;
        Wrench::of_force(across * (per_radius * self.radius * (square / sum)))
    }

    #[inline]
    fn is_passive(&self) -> bool {
        true
    }

    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("radius of the lift", self.radius, " m")?;
        error::at_least_zero("density of the air", self.density, " kg/m³")?;
        error::at_least_zero("slope of the lift coefficient", self.slope, "")?;
        error::above_zero("limit of the lift coefficient", self.limit, "")
    }

    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }
}
