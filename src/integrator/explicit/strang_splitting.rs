//! Drift, kick, drift: exact flight before and after a kick by the forces.

use crate::body::ContactRange;
use crate::contact::Load;
use crate::error::{self, SceneError, StepError};
use crate::force::Force;
use crate::integrator::interface::{Integrator, Step, step_length};
use crate::integrator::lanes::Lanes;
use crate::real::Real;
use crate::rotation::{Axes, Rotation};
use crate::scene::{Dynamics, turned_freely};
use crate::state::State;

/// Strang splitting: half a step of exact flight, a kick by the contact forces, half a step of
/// exact flight.
///
/// ```text
/// drift dt/2:  x += dt/2 v;  q = torque-free rotation under L
/// kick dt:     (v, L) += dt (F/m + g, T)(v*, L*)
///              with (v*, L*) = (v, L) + dt/2 (F/m + g, T)(v, L)
/// drift dt/2
/// ```
/// Here x is the position and v the velocity of the centre of mass, q the orientation, L the
/// angular momentum, and m the mass. F and T are force and torque of contacts and applied forces, g
/// is gravity.
///
/// The kick is the explicit midpoint rule in the velocities, because dampers and friction depend on
/// them.
///
/// *Order* 2 in smooth motion. A step in contact costs two evaluations. A step in flight evaluates
/// neither friction nor springs, and is exact at any step size. For an error of a centimetre after
/// a second, it has the lowest cost ([choosing](crate::guide::choosing)).
///
/// *May add energy* by O(dt²). A force that rotates the velocity at a rate ω, such as
/// [lift](crate::SpinLift), multiplies the velocity by `√(1 + (dt ω)⁴/4)` in each step.
///
/// *Limits.* ω and δ are the highest frequency and damping rate that the contacts give the body at
/// their arms (see [integrators](crate#integrators)). μ is the coefficient of friction and g is
/// gravity.
/// - *Stability:* stable for `dt < min(2/ω, 2/δ)`. This limit is exact for weak damping and for
///   dominant damping. Between them it is conservative: the true limit reaches 3.06/ω.
///   [`Stepper::largest_stable_step`](crate::Stepper::largest_stable_step) computes it at a state.
/// - *Touch-downs:* order 1. The damper's force jumps by `c u`, with `u` the closing speed, and the
///   kick either includes the jump or misses it. The velocity error is up to `dt c u/2m`, of either
///   sign. The measured order on the eight trials is 0.9 to 2.7. With a law without that jump
///   ([`LimitedDamper`](crate::LimitedDamper)) it is 1.7 to 3.4
///   ([accuracy](crate::guide::accuracy)). [`EnergyMomentum`](crate::EnergyMomentum), which
///   averages the force over the step, keeps order 2.
/// - *Sticking:* friction sticks for `dt < 2 slip_speed/(3 μ g)`, where the 3 is `1 + m r²/I` of a
///   ring. In a longer step the kick reverses the slip of a sticking contact instead of ending it.
///   Friction then does almost no work, and a body comes to rest too late. For sticking contacts
///   use [`EnergyMomentum`](crate::EnergyMomentum).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StrangSplitting<R = f64> {
    /// Step size, s, above 0.
    pub time_step: R,
}

impl<R: Real> Integrator<R> for StrangSplitting<R> {
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
        let half = dt * R::HALF;
        let start = state.rotation();
        let middle = drift(scene, state, start, &start.axes(), half);
        let axes = middle.axes();
        let evaluations = kick(scene, state, axes, dt, near);
        let end = drift(scene, state, middle, &axes, half);
        state.orientation = end.to_quat();
        Ok(Step::new(dt, evaluations))
    }

    const HAS_LANES: bool = true;

    #[inline]
    fn step_in_lanes<D: Dynamics<R>>(&self, scene: &D, lanes: &mut Lanes<R>, seconds: R) {
        let half = seconds * R::HALF;
        let mass = scene.inertia_properties();
        lanes.begin();
        lanes.drift(mass, half);
        lanes.set_axes();
        lanes.find_contacts(scene);
        // The velocities at half of the kick give the load of the kick.
        let start = lanes.velocities();
        lanes.find_loads(scene);
        let flies = lanes.loads.flies();
        if !flies.contains(&true) || scene.force().acts() {
            lanes.kick(scene, half);
            lanes.find_loads(scene);
            lanes.set_velocities(&start);
            lanes.kick(scene, seconds);
        } else if !flies.contains(&false) {
            lanes.fall(scene, seconds);
        } else {
            lanes.fall(scene, seconds);
            let fallen = lanes.velocities();
            lanes.set_velocities(&start);
            lanes.kick(scene, half);
            lanes.find_loads(scene);
            lanes.set_velocities(&start);
            lanes.kick(scene, seconds);
            lanes.set_velocities_of(&flies, &fallen);
        }
        lanes.drift(mass, half);
        lanes.end();
    }

    fn order(&self) -> u32 {
        2
    }

    fn fixed_step(&self) -> Option<R> {
        Some(self.time_step)
    }

    /// The limits are `X < 4` and `Y < 2` with `X = stiffness h²`, `Y = damping h`. The exact
    /// region, `Y < 2` and `X + 2 Y < 4/(1 - Y/2)`, is wider where both matter. It allows up to 1.5
    /// times the step size at a damping ratio of 0.33.
    fn largest_stable_step(&self, stiffness: R, damping: R) -> Option<R> {
        let by_springs = R::TWO / stiffness.sqrt();
        Some((R::TWO / damping).at_most(by_springs))
    }

    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("time step", self.time_step, " s")
    }
}

/// Advances position and rotation in flight without force. Returns the new rotation.
///
/// The flight starts from `rotation`, whose axes are `axes`.
#[inline]
fn drift<R: Real>(
    scene: &impl Dynamics<R>,
    state: &mut State<R>,
    rotation: Rotation<R>,
    axes: &Axes<R>,
    seconds: R,
) -> Rotation<R> {
    state.position += state.linear_velocity * seconds;
    turned_freely(scene, rotation, axes, state.angular_momentum, seconds)
}

/// Advances the velocities by the forces at a fixed pose. Returns the number of contact
/// evaluations.
#[inline]
fn kick<R: Real>(
    scene: &impl Dynamics<R>,
    state: &mut State<R>,
    axes: Axes<R>,
    seconds: R,
    near: &mut ContactRange,
) -> u32 {
    // The pose is fixed, and with it the set of penetrating contacts.
    *near = scene
        .contact_model()
        .range_near(*near, state.position, &axes);
    let motion = scene.motion_along(state, axes);
    let contacts = scene.contact_model().load_on(*near, &motion);
    if contacts.touching == 0 && !scene.force().acts() {
        state.linear_velocity += scene.gravity() * seconds;
        return 1;
    }
    let mut middle = *state;
    let load = scene.with_applied_force(contacts, &motion);
    push(scene, &mut middle, &load, seconds * R::HALF);
    let motion = scene.motion_along(&middle, axes);
    let contacts = scene.contact_model().load_on(*near, &motion);
    let load = scene.with_applied_force(contacts, &motion);
    push(scene, state, &load, seconds);
    2
}

/// Advances the velocities by a given load.
#[inline]
fn push<R: Real>(scene: &impl Dynamics<R>, state: &mut State<R>, load: &Load<R>, seconds: R) {
    let inverse_mass = scene.inertia_properties().inverse_mass();
    state.linear_velocity += (load.force * inverse_mass + scene.gravity()) * seconds;
    state.angular_momentum += load.torque * seconds;
}
