//! Drift, kick, drift: exact flight before and after a kick by the forces.

use crate::body::ContactRange;
use crate::contact::Load;
use crate::error::{self, SceneError, StepError};
use crate::force::Force;
use crate::integrator::interface::{Integrator, LIMIT_HALVINGS, Step, step_length};
use crate::integrator::lanes::Lanes;
use crate::quadrature::bisect;
use crate::real::Real;
use crate::rotation::{Axes, Rotation};
use crate::scene::{Dynamics, turned_freely};
use crate::stability::{LinearMotion, ahead};
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
///   dominant damping. Between them steps may be longer, at a damping ratio of 0.22 up to 4.5/ω.
///   [`Stepper::largest_stable_step`](crate::Stepper::largest_stable_step) computes the limit at a
///   state.
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

    /// A step is stable for `Y < 2` and `(X + 2 Y) (1 - Y/2) < 4`, with `X = stiffness h²` and
    /// `Y = damping h`. With `t = h ω/2` and `ζ = damping/2ω` the second condition is
    ///
    /// ```text
    /// t (t + 2 ζ) (1 - 2 ζ t) < 1
    /// ```
    /// It holds for `t <= 1`. Beyond, the left side has one maximum before `Y = 2`. If it is above
    /// 1, the limit is where the left side first reaches 1, below `t = 1.6`.
    fn largest_stable_step(&self, stiffness: R, damping: R) -> Option<R> {
        let by_spring = R::TWO / stiffness.sqrt();
        let by_damper = R::TWO / damping;
        if by_damper <= by_spring {
            return Some(by_damper);
        }
        let (one, twice_ratio) = (R::ONE, by_spring / by_damper);
        let exceeds = |t: R| t * (t + twice_ratio) * (one - twice_ratio * t) >= one;
        let square = twice_ratio * twice_ratio;
        let root = ((one - square) * (one - square) + square * R::from_f64(3.0)).sqrt();
        let top = (one - square + root) / (twice_ratio * R::from_f64(3.0));
        if !exceeds(top.at_most(R::from_f64(1.6))) {
            return Some(by_damper);
        }
        let bracket = [one, top.at_most(R::from_f64(1.6))];
        let [limit, _] = bisect(bracket, LIMIT_HALVINGS, exceeds);
        Some(by_spring * limit)
    }

    fn linear_step(
        &self,
        motion: &LinearMotion,
        [y, v]: [[f64; 6]; 2],
        time_step: f64,
    ) -> Option<[[f64; 6]; 2]> {
        let half = 0.5 * time_step;
        let middle = ahead(&y, &v, half);
        let half_kicked = ahead(&v, &motion.acceleration(&middle, &v), half);
        let kicked = ahead(&v, &motion.acceleration(&middle, &half_kicked), time_step);
        Some([ahead(&middle, &kicked, half), kicked])
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
