//! Flight in closed form: one step up to the first touch-down, combined with any integrator for
//! contact.
//!
//! A lower bound of the gap gives the safe duration of flight. Let `m` be the gap of the lowest
//! point, `n` the normal of the ground and `r` the bounding radius. The acceleration of a point
//! about the centre of mass is at most `b r`, with a bound `b` of `|ω|² + |ω'|`. After `s` more
//! seconds no point of the body has a gap below `m + (n·v - |n × ω| r) s + (n·g - b r) s²/2`. No
//! contact can close before the root of this bound. The bound is evaluated again at the root, until
//! the gain is not worth a step.
//!
//! In torque-free motion `ω' = J⁻¹ (L × ω)`. Let `j` be the inverse moments. For two equal moments
//! `|ω|` and `|L × ω|` are constant, and `b = |ω|² + j_max |L × ω|`. For three different moments
//! `|ω| ≤ j_max |L|`, and the part of `ω` across `L` is at most half of `(j_max - j_min) |L|`. So
//! `b = 3/2 (j_max |L|)²`.

use crate::body::{InertiaProperties, RigidPointBody};
use crate::energy::Energy;
use crate::error::{SceneError, StepError};
use crate::force::Force;
use crate::free_rotation::FreeRotation;
use crate::ground::Plane;
use crate::integrator::energy_limit;
use crate::integrator::interface::{Integrator, Step, StepControl};
use crate::real::{Real, Vector};
use crate::rotation::Rotation;
use crate::scene::{Dynamics, is_asymmetric};
use crate::stability::LinearMotion;
use crate::state::State;

/// Adds closed-form flight to an integrator: while no contact can close, one step is exact, of any
/// size.
///
/// ```text
/// x(t) = x + v t + g t²/2      v(t) = v + g t
/// q(t) = exp(t L/I₁) q exp(t s a)     s = (L·a')(1/I₃ - 1/I₁)     for two equal moments
/// ```
/// Here `exp` is the rotation by a rotation vector, and `L` is the angular momentum. The axis of
/// symmetry is `a` in body axes, and `a'` in world axes at the start. `I₃` is the moment of inertia
/// about it, and `I₁` the two equal moments. For three different moments the rotation is
/// [`FreeRotation`]. The flight ends before the first touch-down. From there the wrapped integrator
/// `I` takes the steps.
///
/// *Fixed steps:* with a method of a [fixed step](Integrator::fixed_step) the flight lasts a whole
/// number of steps. The body then reaches the ground at the same point of the time grid as without
/// `Flight`. The states agree to rounding if the method is exact in flight, else to the error of
/// that method in flight. There are fewer steps, so an observer that needs states during the flight
/// should use [`Timed`](crate::Timed).
///
/// *Energy:* never increases in a flight, because the same energy limiter as in
/// [`EnergyMomentum`](crate::EnergyMomentum) scales the velocities to remove any gain by rounding.
/// The factor is 1 to rounding. With `EnergyMomentum` as the wrapped integrator, the energy never
/// increases in contact either.
///
/// *Body:* any moments of inertia. For two equal moments the angles are rounded once. For three
/// different moments they have twice the digits.
///
/// *Applied force:* a scene with an applied force ([`Force`](crate::Force)) has no closed form, and
/// the wrapped integrator takes all steps. A force with a constant part only, such as
/// [`ConstantForce`](crate::ConstantForce), acts like gravity and keeps the closed form.
///
/// *Ground:* over a ground with [`GroundBounds::Everywhere`] there is no gain. While the body is in
/// contact, each step costs one more search for its lowest point.
///
/// [`GroundBounds::Everywhere`]: crate::GroundBounds::Everywhere
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Coin, FlatGround, Flight, State, Stepper, StrangSplitting, UniformGravity};
///
/// let stepper = Stepper::builder(Coin::ring(1.0, 0.5))
///     .gravity(UniformGravity::down(9.8))
///     .ground(FlatGround::level(1000.0, 0.5))
///     .integrator(Flight(StrangSplitting { time_step: 1e-3 }))
///     .build()?;
/// let mut state = State::at(DVec3::Z * 5.0).with_angular_momentum(DVec3::new(0.3, 1.0, 0.2));
/// let step = stepper.step(&mut state)?;
/// assert!(step.elapsed > 0.9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Flight<I>(
    /// Integrator for the motion in contact.
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
        let flight = Leg::from(scene, state).and_then(|mut leg| {
            let seconds = leg.seconds(self.0.fixed_step(), limit)?;
            fly_without_rise(scene, state, leg.turn.at(seconds), seconds)
        });
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

    fn linear_step(
        &self,
        motion: &LinearMotion,
        start: [[f64; 6]; 2],
        time_step: f64,
    ) -> Option<[[f64; 6]; 2]> {
        self.0.linear_step(motion, start, time_step)
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

    #[inline]
    fn clear(&self, workspace: &mut Self::Workspace) {
        self.0.clear(workspace);
    }

    fn check(&self) -> Result<(), SceneError> {
        self.0.check()
    }

    fn check_body(&self, body: &impl RigidPointBody<R>) -> Result<(), SceneError> {
        self.0.check_body(body)
    }
}

/// Returns the end of a flight whose computed energy never exceeds the energy before it.
///
/// Any gain by rounding is removed from the velocities. Returns `None` if that is impossible.
#[inline]
fn fly_without_rise<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &State<R>,
    rotation: Rotation<R>,
    seconds: R,
) -> Option<(State<R>, Step<R>)> {
    let end = ballistic(scene, state, rotation, seconds);
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

/// Returns the state after `seconds` without contact, with the given `rotation`.
#[inline]
pub(super) fn ballistic<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &State<R>,
    rotation: Rotation<R>,
    seconds: R,
) -> State<R> {
    let gravity = scene.gravity();
    let mean_velocity = state.linear_velocity + gravity * (seconds * R::HALF);
    State {
        position: state.position + mean_velocity * seconds,
        linear_velocity: state.linear_velocity + gravity * seconds,
        orientation: rotation.to_quat(),
        angular_momentum: state.angular_momentum,
    }
}

/// Rotation in flight. The constants of three different moments are computed when they are needed
/// first, because a body in contact does not need them.
struct Turn<'a, R: Real> {
    inertia: &'a InertiaProperties<R>,
    is_asymmetric: bool,
    start: Rotation<R>,
    momentum: R::Vec3,
    free: Option<FreeRotation<R>>,
}

impl<R: Real> Turn<'_, R> {
    #[inline]
    fn at(&mut self, seconds: R) -> Rotation<R> {
        let (inertia, start, momentum) = (self.inertia, self.start, self.momentum);
        if !self.is_asymmetric {
            let turned = inertia.turn_symmetric(start, &start.axes(), momentum, seconds);
            return turned.normalised();
        }
        self.free
            .get_or_insert_with(|| FreeRotation::new(inertia, start, momentum))
            .rotation_at(seconds)
    }

    /// Bound of the acceleration of a point over its distance from the centre of mass, 1/s².
    #[inline]
    fn bend(&self, spin: R::Vec3) -> R {
        let fastest = self.inertia.largest_inverse_moment();
        if !self.is_asymmetric {
            return spin.length_squared() + fastest * self.momentum.cross(spin).length();
        }
        let fastest = fastest * self.momentum.length();
        fastest * fastest * R::from_f64(1.5)
    }
}

/// A phase of flight above the planes that bound the surfaces of the ground from above.
struct Leg<'a, R: Real, D> {
    scene: &'a D,
    state: &'a State<R>,
    turn: Turn<'a, R>,
    surfaces: usize,
}

impl<'a, R: Real, D: Dynamics<R>> Leg<'a, R, D> {
    /// Returns `None` if the ground may be anywhere, or if an applied force acts. The flight then
    /// has no closed form.
    #[inline]
    fn from(scene: &'a D, state: &'a State<R>) -> Option<Self> {
        if scene.force().acts() {
            return None;
        }
        let model = scene.contact_model();
        let surfaces = model.surfaces();
        if (0..surfaces).any(|surface| model.is_unbounded(surface)) {
            return None;
        }
        Some(Self {
            scene,
            state,
            turn: Turn {
                inertia: scene.inertia_properties(),
                is_asymmetric: is_asymmetric(scene),
                start: state.rotation(),
                momentum: state.angular_momentum,
                free: None,
            },
            surfaces,
        })
    }

    /// Returns the duration of the flight, s, or `None` if it is not worth a step.
    #[inline]
    fn seconds(&mut self, fixed_step: Option<R>, limit: R) -> Option<R> {
        // An infinite limit is no limit.
        let limit = limit.at_most(R::MAX);
        let (mut free, mut worth) = (R::MAX, R::ZERO);
        for surface in 0..self.surfaces {
            let Some(plane) = self.scene.contact_model().plane_above(surface) else {
                continue;
            };
            let worth_here = match fixed_step {
                Some(step) => step * R::TWO,
                // The rest of a run is more than half of `EPSILON` of its time. The clock resolves
                // an eighth of the square of that, which is `EPSILON` of the rest.
                None if limit < R::MAX => self.resolution(&plane).at_least(limit * R::EPSILON),
                None => self.resolution(&plane),
            };
            let before = limit.at_most(free);
            free = before.at_most(self.free(&plane, worth_here, before));
            worth = worth.at_least(worth_here);
        }
        if free >= limit {
            // There is no ground, or the body rises for ever. Without a limit the flight has no end.
            return (limit < R::MAX && limit > R::ZERO).then_some(limit);
        }
        // A body in contact has no time of flight. A body without motion has `worth = 0`, hence the
        // comparison with 0.
        let is_worth = free >= worth && free > R::ZERO;
        is_worth.then(|| match fixed_step {
            Some(step) => whole_steps(free, step).at_most(limit),
            None => free,
        })
    }

    /// Returns the time in which the body moves by a fiftieth of its bounding radius, s.
    ///
    /// For a point mass it is the time to move by the rounding of its height.
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

    /// Returns a bound of the rounding error of the height above the plane, m.
    #[inline]
    fn rounding(&self, plane: &Plane<R>) -> R {
        let gap = plane.gap(self.state.position);
        (plane.size_of_gap(gap, self.state.position) + self.scene.bounding_radius())
            * (R::EPSILON * R::from_f64(16.0))
    }

    /// Returns a duration in which no contact closes, s.
    ///
    /// It ends before the first touch-down by at most `worth`, or is at least `limit`.
    #[inline]
    fn free(&mut self, plane: &Plane<R>, worth: R, limit: R) -> R {
        let mass = self.scene.inertia_properties();
        let (gravity, bounding_radius) = (self.scene.gravity(), self.scene.bounding_radius());
        let fall = -gravity.dot(plane.normal);
        let (gap, rising) = (
            plane.gap(self.state.position),
            self.state.linear_velocity.dot(plane.normal),
        );
        // The bounding sphere falls along a parabola.
        let rounding = self.rounding(plane);
        let mut time = safe(gap - bounding_radius - rounding, rising, fall).at_least(R::ZERO);
        if time >= limit {
            return time;
        }
        let momentum = self.state.angular_momentum;
        for _ in 0..EVALUATIONS {
            let rotation = if time > R::ZERO {
                self.turn.at(time)
            } else {
                self.turn.start
            };
            let axes = rotation.axes();
            let spin = mass.angular_velocity(&axes, momentum);
            let lowest = self.scene.body().support(-axes.to_body(plane.normal));
            let height = gap + time * (rising - time * (fall * R::HALF));
            let sinking =
                rising - fall * time - spin.cross(plane.normal).length() * bounding_radius;
            let bend = fall + self.turn.bend(spin) * bounding_radius;
            let more = safe(height - lowest - rounding, sinking, bend);
            // Replaces negative values and NaN by 0.
            let more = if more > R::ZERO { more } else { R::ZERO };
            time += more;
            if more < worth || time >= limit {
                break;
            }
        }
        time
    }
}

/// Number of evaluations of the rotation before the ground is reached.
const EVALUATIONS: u32 = 16;

/// Returns the time up to which `height + rising s - bend s²/2` stays above 0, s.
///
/// Returns `R::MAX` if it stays above 0 for ever, and 0 if `height` is not above 0.
#[inline]
fn safe<R: Real>(height: R, rising: R, bend: R) -> R {
    if height <= R::ZERO {
        return R::ZERO;
    }
    let discriminant = rising * rising + R::TWO * bend * height;
    // It rises for ever, or accelerates upwards before it reaches 0.
    if bend <= R::ZERO && (rising >= R::ZERO || discriminant < R::ZERO) {
        return R::MAX;
    }
    let root = discriminant.sqrt();
    // This form has no cancellation.
    if rising > R::ZERO {
        (rising + root) / bend
    } else {
        R::TWO * height / (root - rising)
    }
}

/// Returns the largest whole number of steps within `seconds`, as a time, s.
#[inline]
fn whole_steps<R: Real>(seconds: R, step: R) -> R {
    R::from_usize((seconds / step).floor_index()) * step
}
