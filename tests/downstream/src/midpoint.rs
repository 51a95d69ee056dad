//! An integrator: the explicit midpoint rule.

use tumble::integrator::step_length;
use tumble::rotation::Rotation;
use tumble::{Dynamics, Integrator, Real, SceneError, State, Step, StepError, error};

/// Explicit midpoint rule, with an exact rotation by the angular velocity at the middle.
///
/// Order 2, with two evaluations a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Midpoint<R = f64> {
    /// s, above 0.
    pub time_step: R,
}

impl<R: Real> Integrator<R> for Midpoint<R> {
    type Workspace = ();

    fn step<D: Dynamics<R>>(
        &self,
        scene: &D,
        state: &mut State<R>,
        limit: R,
        _workspace: &mut (),
    ) -> Result<Step<R>, StepError> {
        let dt = step_length(self.time_step, limit);
        let start = *state;
        let middle = moved(scene, &start, &start, dt * R::HALF);
        *state = moved(scene, &start, &middle, dt);
        Ok(Step::new(dt, 2))
    }

    fn order(&self) -> u32 {
        2
    }

    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("time step", self.time_step, " s")
    }
}

/// `from`, moved on for `seconds` at the rates of `at`.
fn moved<R: Real>(
    scene: &impl Dynamics<R>,
    from: &State<R>,
    at: &State<R>,
    seconds: R,
) -> State<R> {
    let motion = scene.motion(at);
    let load = scene.load(&motion);
    let turn = Rotation::from_rotation_vector(motion.angular_velocity * seconds);
    State {
        position: from.position + motion.linear_velocity * seconds,
        linear_velocity: from.linear_velocity
            + (load.force * scene.inertia_properties().inverse_mass() + scene.gravity()) * seconds,
        orientation: turn.after(from.rotation()).normalised().to_quat(),
        angular_momentum: from.angular_momentum + load.torque * seconds,
    }
}
