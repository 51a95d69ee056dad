//! Semi-implicit Euler: first the velocities, then the positions with the new velocities.

use crate::body::ContactRange;
use crate::error::{self, SceneError, StepError};
use crate::integrator::interface::{Integrator, Step, step_length};
use crate::integrator::lanes::Lanes;
use crate::real::Real;
use crate::scene::{Dynamics, turned_freely};
use crate::stability::{LinearMotion, ahead};
use crate::state::State;

/// Semi-implicit (symplectic) Euler method with exact torque-free rotation.
///
/// A kick by the forces updates the velocities. A drift with the new velocities follows.
///
/// ```text
/// (v', L') = (v, L) + dt (F/m + g, T)(x, q, v, L)
/// x' = x + dt v'
/// q' = torque-free rotation of q under L' for dt
/// ```
/// Here x is the position and v the velocity of the centre of mass, q the orientation, L the
/// angular momentum, and m the mass. F and T are force and torque of contacts and applied forces, g
/// is gravity, and a prime marks the end of the step.
///
/// Order 1, with one force evaluation per step. It is the cheapest method, suited to games and
/// microcontrollers. The rotation in flight is exact to rounding, for any moments of inertia.
///
/// *May add energy.* Without dampers, friction and applied forces the energy oscillates by O(dt)
/// while the same contacts touch. A bounce changes it by a fraction from `-x` to `x/(1-x)`, where
/// `x = (dt ω)²/4`, as the phase of its touch-down has it. Over many bounces the energy is a random
/// walk, which may end at many times the first energy. A force that rotates the velocity at a rate
/// ω, such as [lift](crate::SpinLift), multiplies the velocity by `√(1 + (dt ω)²)` in each step.
///
/// *Stable* for `dt < 2 (√(1+ζ²) - ζ)/ω` with `ζ = δ/2ω`. Here ω and δ are the highest frequency
/// and damping rate that the contacts give the body at their arms (see
/// [integrators](crate#integrators)).
/// [`Stepper::largest_stable_step`](crate::Stepper::largest_stable_step) computes the limit at a
/// state.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SymplecticEuler<R = f64> {
    /// Step size, s, above 0.
    pub time_step: R,
}

impl<R: Real> Integrator<R> for SymplecticEuler<R> {
    /// Contact range of the previous step, in which the next step searches first.
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
        *near = scene
            .contact_model()
            .range_near(*near, motion.position, &motion.axes);
        let contacts = scene.contact_model().load_on(*near, &motion);
        let load = scene.with_applied_force(contacts, &motion);

        // Position and rotation use the new velocities. With the old ones each step would add
        // energy to a spring.
        state.linear_velocity += (load.force * mass.inverse_mass() + scene.gravity()) * dt;
        state.angular_momentum += load.torque * dt;
        state.position += state.linear_velocity * dt;
        let momentum = state.angular_momentum;
        state.orientation = turned_freely(scene, rotation, &motion.axes, momentum, dt).to_quat();
        Ok(Step::new(dt, 1))
    }

    const HAS_LANES: bool = true;

    #[inline]
    fn step_in_lanes<D: Dynamics<R>>(&self, scene: &D, lanes: &mut Lanes<R>, seconds: R) {
        lanes.begin();
        lanes.find_contacts(scene);
        lanes.find_loads(scene);
        lanes.kick(scene, seconds);
        lanes.drift(scene.inertia_properties(), seconds);
        lanes.end();
    }

    fn order(&self) -> u32 {
        1
    }

    fn fixed_step(&self) -> Option<R> {
        Some(self.time_step)
    }

    /// The amplification factor `z` of a step obeys `(z - 1)² + (z - 1) Y + z X = 0` with
    /// `X = stiffness h²`, `Y = damping h`. `|z| < 1` for `X + 2 Y < 4`, and `z = -1` at the limit.
    fn largest_stable_step(&self, stiffness: R, damping: R) -> Option<R> {
        let four = R::from_f64(4.0);
        let root = (damping * damping + stiffness * four).sqrt();
        Some(four / (damping + root))
    }

    fn linear_step(
        &self,
        motion: &LinearMotion,
        [y, v]: [[f64; 6]; 2],
        time_step: f64,
    ) -> Option<[[f64; 6]; 2]> {
        let v = ahead(&v, &motion.acceleration(&y, &v), time_step);
        Some([ahead(&y, &v, time_step), v])
    }

    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("time step", self.time_step, " s")
    }
}
