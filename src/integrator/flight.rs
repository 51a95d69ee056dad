//! Flight in closed form: one step up to the first touch, whatever moves the body on the ground.

use super::{Integrator, Step, StepControl, energy_limit};
use crate::body::RigidPointBody;
use crate::energy::Energy;
use crate::error::{SceneError, StepError};
use crate::ground::{GroundBounds, Plane, SpringDamperGround};
use crate::real::{Real, Vector};
use crate::rotation::Rotation;
use crate::scene::Dynamics;
use crate::state::State;

/// Another integrator, with flight in closed form: while nothing can touch, one step is exact,
/// however long.
///
/// ```text
/// x(t) = x + v t + g t²/2      v(t) = v + g t      q(t) = exp(t L/I₁) q exp(t (L·a)(1/I₃ - 1/I₁) a)
/// ```
/// The step ends before the first touch, which is found from above ground: with `m` the gap of the
/// lowest place, no place of the body is lower than `m + (n·v - |n × ω| r) s + (n·g - ω² r) s²/2`
/// after `s` more seconds (`n` the ground's normal, `r` the bounding_radius; in torque-free motion |ω|
/// of a body with two equal moments does not change), so that up to the root of this nothing
/// touches; and so on from there, until what is gained is not worth a step. From there the other
/// integrator goes on.
///
/// A method with a [fixed step](Integrator::fixed_step) flies whole steps, so that it meets the
/// ground at the same places of its grid as without: the states that one sees are the same to
/// rounding, for a method that is exact in flight, and else to that method's error in flight. What
/// is seen less is steps: an observer that wants to see a flight asks for times
/// ([`Timed`](crate::Timed)).
///
/// *Energy:* never rises in a flight, by the same last word as in
/// [`EnergyMomentum`](crate::EnergyMomentum): what rounding has lifted is taken from the
/// velocities, a factor of 1 to rounding. Around `EnergyMomentum` it never rises at all.
///
/// *Body:* exact for two equal moments. With three different ones the turn is composed of steps of
/// at most 0.02 rad, of order 4: it is off by less than 1e-9 rad for each radian of the flight's
/// turn, and after 20 000 rad a step of the flight ends. *Ground:* needs to know where the ground
/// is ([`GroundBounds`]): over a ground that may be everywhere nothing is gained. Where the body is
/// on the ground a step costs a look at its lowest place more.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Coin, FlatGround, Flight, State, Stepper, StrangSplitting, UniformGravity};
///
/// let stepper = Stepper::new(Coin::ring(1.0, 0.5))?
///     .with_gravity(UniformGravity::down(9.8))?
///     .with_ground(FlatGround::level(1000.0, 0.5))?
///     .with_integrator(Flight(StrangSplitting { time_step: 1e-3 }))?;
/// let mut state = State::at(DVec3::Z * 5.0).with_angular_momentum(DVec3::new(0.3, 1.0, 0.2));
/// let step = stepper.step(&mut state)?;
/// assert!(step.elapsed > 0.9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Flight<I>(
    /// What moves the body where it can touch.
    pub I,
);

impl<R: Real, I: Integrator<R>> Integrator<R> for Flight<I> {
    type Workspace = I::Workspace;

    const ADAPTIVE: bool = I::ADAPTIVE;
    const SPANS_STEPS: bool = true;

    #[inline]
    fn step<D: Dynamics<R>>(
        &self,
        scene: &D,
        state: &mut State<R>,
        limit: R,
        workspace: &mut I::Workspace,
    ) -> Result<Step<R>, StepError> {
        let flight = Leg::from(scene, state)
            .and_then(|leg| leg.seconds(self.0.fixed_step(), limit))
            .and_then(|seconds| fly_without_rise(scene, state, seconds));
        match flight {
            Some((end, step)) => {
                *state = end;
                Ok(step)
            }
            None => self.0.step(scene, state, limit, workspace),
        }
    }

    fn order(&self) -> u32 {
        self.0.order()
    }

    fn fixed_step(&self) -> Option<R> {
        self.0.fixed_step()
    }

    #[inline]
    fn largest_stable_step(&self, stiffness: R, damping: R) -> Option<R> {
        self.0.largest_stable_step(stiffness, damping)
    }

    #[inline]
    fn step_control(
        &self,
        workspace: &Self::Workspace,
        state: &State<R>,
    ) -> Option<StepControl<R>> {
        self.0.step_control(workspace, state)
    }

    #[inline]
    fn set_step_control(&self, workspace: &mut Self::Workspace, control: StepControl<R>) {
        self.0.set_step_control(workspace, control);
    }

    fn check(&self) -> Result<(), SceneError> {
        self.0.check()
    }
}

/// A flight whose computed energy is not above the one before: what its rounding lifts is taken
/// from the velocities. `None` where that cannot be had.
#[inline]
fn fly_without_rise<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &State<R>,
    seconds: R,
) -> Option<(State<R>, Step<R>)> {
    let end = fly(scene, state, seconds);
    let mut step = Step::new(seconds, 0);
    let (before, after) = (Energy::of(scene, state), Energy::of(scene, &end));
    let excess = after.total() - before.total();
    if excess <= R::ZERO {
        return Some((end, step));
    }
    let (end, _) = energy_limit::scaled_down(scene, before.total(), excess, &end, after)?;
    step.energy_removed = excess;
    Some((end, step))
}

/// The state after a time in which nothing touches.
#[inline]
fn fly<R: Real, D: Dynamics<R>>(scene: &D, state: &State<R>, seconds: R) -> State<R> {
    let mass = scene.inertia_properties();
    let rotation = state.rotation();
    let gravity = scene.gravity();
    let mean_velocity = state.linear_velocity + gravity * (seconds * R::HALF);
    State {
        position: state.position + mean_velocity * seconds,
        linear_velocity: state.linear_velocity + gravity * seconds,
        orientation: mass
            .turn_far(rotation, state.angular_momentum, seconds)
            .to_quat(),
        angular_momentum: state.angular_momentum,
    }
}

/// A flight over a ground below a plane.
struct Leg<'a, R: Real, D> {
    scene: &'a D,
    state: &'a State<R>,
    rotation: Rotation<R>,
    plane: Option<Plane<R>>,
}

impl<'a, R: Real, D: Dynamics<R>> Leg<'a, R, D> {
    /// `None` over a ground that may be everywhere.
    #[inline]
    fn from(scene: &'a D, state: &'a State<R>) -> Option<Self> {
        let plane = match scene.ground().bounds() {
            GroundBounds::Nowhere => None,
            GroundBounds::Plane(plane) | GroundBounds::Below(plane) => Some(plane),
            GroundBounds::Everywhere => return None,
        };
        Some(Self {
            scene,
            state,
            rotation: state.rotation(),
            plane,
        })
    }

    /// How long to fly; `None` where that is not worth a step.
    #[inline]
    fn seconds(&self, fixed_step: Option<R>, limit: R) -> Option<R> {
        // An infinite limit is none.
        let limit = limit.at_most(R::MAX);
        let turn = (self.scene.inertia_properties()).longest_turn(self.state.angular_momentum);
        let Some(plane) = &self.plane else {
            let limit = limit.at_most(turn);
            // With no ground and no limit there is no end.
            return (limit < R::MAX && limit > R::ZERO).then_some(limit);
        };
        let worth = match fixed_step {
            Some(step) => step * R::TWO,
            // A rest of a run is more than half of `EPSILON` of its time, and its clock resolves an
            // eighth of the square of that: it resolves `EPSILON` of the rest.
            None if limit < R::MAX => self.resolution(plane).at_least(limit * R::EPSILON),
            None => self.resolution(plane),
        };
        let free = self.free(plane, worth, limit).at_most(turn);
        if free >= limit {
            // For ever up, and no limit: there is no end.
            return (limit < R::MAX && limit > R::ZERO).then_some(limit);
        }
        // A body in contact has no time to fly, and one that nothing moves is not worth less than
        // that.
        let is_worth = free >= worth && free > R::ZERO;
        is_worth.then(|| match fixed_step {
            Some(step) => whole_steps(free, step).at_most(limit),
            None => free,
        })
    }

    /// The time in which the body moves by a fiftieth of its reach, s; of a point, by the rounding
    /// of its height.
    fn resolution(&self, plane: &Plane<R>) -> R {
        let bounding_radius = self.scene.bounding_radius();
        let length = (bounding_radius * R::from_f64(0.02)).at_least(self.rounding(plane));
        let spin =
            self.state.angular_momentum * self.scene.inertia_properties().largest_inverse_moment();
        let speed = self.state.linear_velocity.length()
            + spin.length() * bounding_radius
            + (self.scene.gravity().length() * bounding_radius.at_least(length)).sqrt();
        if speed > R::ZERO {
            length / speed
        } else {
            R::ZERO
        }
    }

    /// What rounding may hide of the height above the plane, m.
    #[inline]
    fn rounding(&self, plane: &Plane<R>) -> R {
        let gap = plane.gap(self.state.position);
        (gap.abs() + plane.height.abs() + self.scene.bounding_radius())
            * (R::EPSILON * R::from_f64(16.0))
    }

    /// A time up to which nothing touches, s: up to the first touch but for `worth`, or at least
    /// `limit`.
    #[inline]
    fn free(&self, plane: &Plane<R>, worth: R, limit: R) -> R {
        let mass = self.scene.inertia_properties();
        let (gravity, bounding_radius) = (self.scene.gravity(), self.scene.bounding_radius());
        let fall = -gravity.dot(plane.normal);
        let (gap, rising) = (
            plane.gap(self.state.position),
            self.state.linear_velocity.dot(plane.normal),
        );
        // The ball around the body falls along a parabola.
        let rounding = self.rounding(plane);
        let mut time = safe(gap - bounding_radius - rounding, rising, fall).at_least(R::ZERO);
        if mass.is_asymmetric() || time >= limit {
            return time;
        }
        let momentum = self.state.angular_momentum;
        for _ in 0..LOOKS {
            let rotation = if time > R::ZERO {
                mass.turn_far(self.rotation, momentum, time)
            } else {
                self.rotation
            };
            let axes = rotation.axes();
            let spin = mass.angular_velocity(&axes, momentum);
            let lowest = self.scene.body().support(-axes.to_body(plane.normal));
            let height = gap + time * (rising - time * (fall * R::HALF));
            let sinking =
                rising - fall * time - spin.cross(plane.normal).length() * bounding_radius;
            let bend = fall + spin.length_squared() * bounding_radius;
            let more = safe(height - lowest - rounding, sinking, bend);
            // Not above 0, or not a number.
            let more = if more > R::ZERO { more } else { R::ZERO };
            time += more;
            if more < worth || time >= limit {
                break;
            }
        }
        time
    }
}

/// Looks at the body's turn on the way to the ground.
const LOOKS: u32 = 16;

/// Up to when `height + rising s - bend s²/2` stays above 0, s; `R::MAX` for ever, 0 where it is
/// not now.
#[inline]
fn safe<R: Real>(height: R, rising: R, bend: R) -> R {
    if height <= R::ZERO {
        return R::ZERO;
    }
    let discriminant = rising * rising + R::TWO * bend * height;
    // It rises for good, or is bent upwards before it comes down.
    if bend <= R::ZERO && (rising >= R::ZERO || discriminant < R::ZERO) {
        return R::MAX;
    }
    let root = discriminant.sqrt();
    // The form without cancellation.
    if rising > R::ZERO {
        (rising + root) / bend
    } else {
        R::TWO * height / (root - rising)
    }
}

/// The largest whole number of steps up to `seconds`, s.
#[inline]
fn whole_steps<R: Real>(seconds: R, step: R) -> R {
    R::from_usize((seconds / step).floor_index()) * step
}
