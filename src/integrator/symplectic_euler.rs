//! Semi-implicit Euler: velocities first, then positions with the new velocities.

use super::{Integrator, Step, step_length};
use crate::body::ContactRange;
use crate::error::{self, SceneError, StepError};
use crate::real::Real;
use crate::scene::Dynamics;
use crate::state::State;

/// Semi-implicit (symplectic) Euler with the exact torque-free turn: a kick by the forces, then a
/// drift with the new velocities.
///
/// ```text
/// (v', L') = (v, L) + dt (F/m + g, T)(x, q, v, L);   x' = x + dt v';   q' = free turn of q under L' in dt
/// ```
/// Order 1, one evaluation a step: the cheapest, for games and microcontrollers. Without dampers
/// and friction its energy swings by O(dt) and does not grow. *May add energy* by that much. Stable
/// for `dt < 2 (√(1+ζ²) - ζ)/ω` with the highest frequency ω and damping rate δ that the contacts
/// give the body at their arms, `ζ = δ/2ω`: see [integrators](crate#integrators) and
/// [`Stepper::largest_stable_step`](crate::Stepper::largest_stable_step). Exact in the turn of a
/// symmetric body in flight.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SymplecticEuler<R = f64> {
    /// s, above 0.
    pub time_step: R,
}

impl<R: Real> Integrator<R> for SymplecticEuler<R> {
    /// The contacts that were low in the step before: where to look for them first.
    type Workspace = ContactRange;

    #[inline]
    fn step<D: Dynamics<R>>(
        &self,
        scene: &D,
        state: &mut State<R>,
        limit: R,
        near: &mut ContactRange,
    ) -> Result<Step<R>, StepError> {
        let dt = step_length(self.time_step, limit);
        let mass = scene.inertia_properties();
        let rotation = state.rotation();
        let motion = scene.motion_along(state, rotation.axes());
        *near = scene.contacts_near(*near, motion.position, &motion.axes);
        let load = scene.load_on(*near, &motion);

        // Position and turn use the new velocities: with the old ones each step would add energy to
        // a spring.
        state.linear_velocity += (load.force * mass.inverse_mass() + scene.gravity()) * dt;
        state.angular_momentum += load.torque * dt;
        state.position += state.linear_velocity * dt;
        state.orientation = mass
            .turn_freely(rotation, &motion.axes, state.angular_momentum, dt)
            .to_quat();
        Ok(Step::new(dt, 1))
    }

    fn order(&self) -> u32 {
        1
    }

    fn fixed_step(&self) -> Option<R> {
        Some(self.time_step)
    }

    /// The factor of a step obeys `(z - 1)² + (z - 1) Y + z X = 0` with `X = stiffness h²`,
    /// `Y = damping h`: `|z| < 1` for `X + 2 Y < 4`, where `z = -1`.
    fn largest_stable_step(&self, stiffness: R, damping: R) -> Option<R> {
        let four = R::from_f64(4.0);
        let root = (damping * damping + stiffness * four).sqrt();
        Some(four / (damping + root))
    }

    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("time step", self.time_step, " s")
    }
}
