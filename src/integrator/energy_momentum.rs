//! Implicit, of order 2, with an energy that cannot rise.
//!
//! Why it cannot is derived in [`guide::energy`](crate::guide::energy). The stages of a step, one
//! module each:
//!
//! 1. `problem`, `contacts`, `touch`: the two momentum equations of the step, and the contacts'
//!    mean forces along its path;
//! 2. `newton`, `stiffness`, `linear`: their solution (`block`, `level`: its arithmetic). What it
//!    leaves over is all that could lift the energy;
//! 3. `settle`, `resist`: at the end of a step too long for friction or dampers they resist the end
//!    velocity, by impulses that only take energy; (`turning`: resistance to rolling and spinning,
//!    where the friction law has it, half before and half after the step;)
//! 4. `energy_limit`: where the computed energy is above the one before, rounding of a flight is
//!    put back into the last places of the orientation, the height or the speed
//!    (`flight_rounding`), and in contact both velocities are scaled down until it is not. A body
//!    whose motion is below the rounding of its energy has come to rest;
//! 5. where 2 or 4 fails, `split`: dissipation, conservative motion, dissipation; else halves, down
//!    to sixteenths; else `descent`: downhill, as far as the energy allows; else time passes and
//!    the body stays. Each end goes through 4, so that the induction from step to step needs no
//!    assumption on convergence.

mod block;
mod contacts;
mod descent;
mod end_velocity;
mod level;
mod linear;
mod newton;
mod problem;
mod resist;
mod split;
mod stiffness;
mod touch;
mod turning;

use super::fingerprint::Fingerprint;
use super::{Integrator, Step, energy_limit, flight_rounding, step_length};
use crate::body::{ContactRange, RigidPointBody, Rim};
use crate::energy::Energy;
use crate::error::{self, Quantity, SceneError, StepError};
use crate::ground::{GroundBounds, SpringDamperGround};
use crate::real::{Real, Vector};
use crate::rotation::Rotation;
use crate::scene::{Contact, Dynamics, Motion};
use crate::state::State;
use contacts::Contacts;
use end_velocity::Strain;
use energy_limit::Touched;
use problem::Problem;

/// The energy-momentum method: implicit, of order 2, and **the computed energy never rises**. The
/// crate's default.
///
/// `stepper.energy(&after).total() <= stepper.energy(&before).total()` holds for every step, with
/// no tolerance, in every scene that composes: whatever the time step, stiffness, damping,
/// friction, spin, size and shape. [`guide::energy`](crate::guide::energy) derives why.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Coin, Coulomb, EnergyMomentum, FlatGround, State, Stepper, UniformGravity};
///
/// // A fiftieth of a second as the step, on a ground on which an explicit method wants a three-hundredth of it, or less.
/// let stepper = Stepper::new(Coin::ring(1.0, 0.5))? // kg, m
///     .with_gravity(UniformGravity::down(9.8))? // m/s²
///     .with_ground(FlatGround::level(1e9, 0.0))? // N/m and N s/m, for each point
///     .with_friction(Coulomb { coefficient: 0.8, slip_speed: 1e-10 })? // -, m/s
///     .with_integrator(EnergyMomentum { time_step: 0.02 })?; // s
/// let mut state = State::at(DVec3::Z).with_angular_momentum(DVec3::new(3.0, 10.0, 2.0)); // m, kg m²/s
/// for _ in 0..500 {
///     let before = stepper.energy(&state).total();
///     stepper.step(&mut state)?;
///     assert!(stepper.energy(&state).total() <= before);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// - *Order* 2, also where contacts begin: the mean force over the step integrates the damper's
///   jump.
/// - *Conserves* the energy where nothing takes it, to the rounding of each step.
/// - *Stable* at any step. A step in which free motion would go beyond 1e25 sizes of the body may
///   return [`StepTooLong`](crate::StepError::StepTooLong).
/// - *Accurate* where the step resolves the contact: `dt < 1/ω`, with `ω = √(K/m)` and `K` the
///   stiffness of all contacts that touch. Beyond it a bounce without dampers still keeps its
///   energy, but not its timing, and one with dampers not its restitution; friction that stops a
///   body within a step stops it at the step's end. [`guide::accuracy`](crate::guide::accuracy)
///   goes through the extremes.
/// - *Cost:* in contact two to five iterations a step, each about as expensive as two evaluations
///   of all contacts. Flight costs no iteration: it is exact for a body with two equal moments, and
///   of order 2 with energy and angular momentum kept for three different ones. A body at rest
///   costs a comparison, once a step with the same workspace has found it so.
/// - *Stick* costs about the same at any slip speed of the friction law down to 1e-12 m/s: in `f64`
///   up to five iterations a step on average at one contact, five to twelve where several contacts
///   or a round rim stick.
/// - *Work* is bounded: at most 31 attempts of at most 3 × 60 evaluations each, and beside them at
///   most 4 searches downhill of at most 3 × 31 × 4 evaluations. Each end costs an energy, and one
///   more for each doubling of its excess, which scales both velocities down where the solver's
///   error would lift the energy in contact. In flight the last places of the orientation, the
///   height or the speed take it.
/// - *Too long a step shows:* [`Step`] tells the iterations, whether the step had to be divided
///   (`fallback`), and the energy that the solver's error would have added (`energy_removed`).
/// - *Contacts:* up to 128 are remembered from iteration to iteration. Further ones take part
///   without memory, with more iterations where they stick. Nothing is allocated.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EnergyMomentum<R = f64> {
    /// s, above 0.
    pub time_step: R,
}

/// What [`EnergyMomentum`] keeps from step to step to save work: the contacts' places, the last
/// energy, and the state that a step has left as it was.
///
/// Nothing of it changes a result: a new one gives the same bits. It may go from one stepper to
/// another: what it knows counts only for the same state in a scene with the same mass, moments,
/// reach, number of contacts and of the rim's points, gravity and surface, and with springs that
/// answer alike at a depth of the reach. Scenes that differ in nothing of this, but in springs at
/// other depths or in places of contacts, want a workspace each.
#[derive(Clone, Debug)]
pub struct Workspace<R: Real = f64> {
    contacts: Contacts<R>,
    /// The state after the last step, its energy, and the scene that they belong to: friction and
    /// dampers do nothing to a body without motion.
    known: Option<(State<R>, Energy<R>, Fingerprint<R>)>,
    /// The length of a step that has left that state as it was, s.
    rest: Option<R>,
}

impl<R: Real> Default for Workspace<R> {
    fn default() -> Self {
        Self::new()
    }
}

impl<R: Real> Workspace<R> {
    /// One that remembers nothing. It can be made at compile time, to lie in a `static` where the
    /// stack is small.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            contacts: Contacts::NONE,
            known: None,
            rest: None,
        }
    }

    /// Whether a step of this length is known to leave this state as it is.
    #[inline]
    fn rests<D: Dynamics<R>>(&self, scene: &D, state: &State<R>, seconds: R) -> bool {
        self.rest == Some(seconds) && self.energy(scene, state).is_some()
    }

    /// The energy of this state in this scene, if the last step has ended with it.
    #[inline]
    fn energy<D: Dynamics<R>>(&self, scene: &D, state: &State<R>) -> Option<Energy<R>> {
        let (known, energy, fingerprint) = self.known?;
        (known == *state && fingerprint == Fingerprint::of(scene, state)).then_some(energy)
    }
}

impl<R: Real> Integrator<R> for EnergyMomentum<R> {
    type Workspace = Workspace<R>;

    #[inline]
    fn step<D: Dynamics<R>>(
        &self,
        scene: &D,
        state: &mut State<R>,
        limit: R,
        workspace: &mut Workspace<R>,
    ) -> Result<Step<R>, StepError> {
        let dt = step_length(self.time_step, limit);
        if dt <= R::ZERO || workspace.rests(scene, state, dt) {
            return Ok(Step::new(dt, 0));
        }
        // An orientation that no scaling makes a turn: every attempt would fail, and the body stay
        // where it is.
        let is_a_turn =
            Rotation::<R>::unscaled(state.orientation).is_a_turn() || state.rotation().is_a_turn();
        if !is_a_turn {
            return Err(StepError::BadState(Quantity::Orientation));
        }
        move_on(scene, state, dt, workspace)
    }

    fn order(&self) -> u32 {
        2
    }

    fn fixed_step(&self) -> Option<R> {
        Some(self.time_step)
    }

    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("time step", self.time_step, " s")
    }
}

/// Finest division of a step that cannot be taken whole.
const PARTS: u32 = 16;
/// So many sixteenths of a step may go without a solution until the search for others ends.
const MOST_LOST: u32 = 2;

/// A step in contact that is longer may converge to where rounding takes it, s. In this time a body
/// falls by 5e12 m on earth.
const LONG: f64 = 1e6;

/// Refuses an energy that says nothing: a step compares sums of several such energies.
#[inline]
fn check_energy<R: Real>(energy: &Energy<R>) -> Result<(), StepError> {
    let sizes = energy.translation + energy.rotation + energy.gravity.abs() + energy.springs.abs();
    if (sizes * R::from_f64(16.0)).is_finite() {
        Ok(())
    } else {
        Err(StepError::BadEnergy {
            joules: sizes.to_f64(),
        })
    }
}

fn move_on<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &mut State<R>,
    dt: R,
    workspace: &mut Workspace<R>,
) -> Result<Step<R>, StepError> {
    let start = *state;
    let before = workspace
        .energy(scene, &start)
        .unwrap_or_else(|| Energy::of(scene, &start));
    check_energy(&before)?;
    let mut energy = before;
    let mut step = Step::new(dt, 0);
    turning::resisted(scene, state, &mut energy, dt * R::HALF);
    // In sixteenths of the step: what is done, and the length that is tried.
    let (mut done, mut length) = (0, PARTS);
    let mut lost = 0;
    while done < PARTS {
        let seconds = sixteenths(dt, length);
        if attempt(scene, state, &mut energy, seconds, workspace, &mut step) {
            done += length;
            length = longest_part(done);
        } else if length > 1 {
            length /= 2;
            step.fallback = true;
        } else {
            lost += 1;
            // Where solution after solution fails, the rest goes downhill at once.
            if lost > MOST_LOST {
                length = PARTS - done;
            }
            let seconds = sixteenths(dt, length);
            let from = *state;
            if let Some(lower) = descent::step(scene, state, energy.total(), seconds, &mut step) {
                (*state, energy) = lower;
            }
            let is_stuck = descent::is_left_in_the_air(scene, [&from, state], seconds);
            if is_stuck && descent::is_unresolved(scene, &from, seconds) {
                return Err(too_long(dt));
            }
            done += length;
        }
    }
    let is_suspect = step.fallback || (step.iterations > 0 && dt > R::from_f64(LONG));
    if is_suspect && descent::is_unresolved(scene, &start, dt) {
        return Err(too_long(dt));
    }
    turning::resisted(scene, state, &mut energy, dt * R::HALF);
    if energy.springs > R::ZERO
        && energy_limit::has_come_to_rest(scene, [&start, state], [&before, &energy], dt)
    {
        *state = energy_limit::stopped(&start);
        energy = Energy::of(scene, state);
    }
    if *state == start {
        fall(scene, state, &mut energy, dt, &mut step);
    }
    workspace.known = Some((*state, energy, Fingerprint::of(scene, state)));
    workspace.rest = (*state == start).then_some(dt);
    Ok(step)
}

#[cold]
fn too_long<R: Real>(dt: R) -> StepError {
    StepError::StepTooLong {
        seconds: dt.to_f64(),
    }
}

/// As [`Dynamics::motion`], but compiled once, for the stages that a step seldom needs.
#[inline(never)]
fn motion_of<R: Real, D: Dynamics<R>>(scene: &D, state: &State<R>) -> Motion<R> {
    scene.motion(state)
}

/// As [`Dynamics::visit_contacts`], but compiled once, for the stages that a step seldom needs.
#[inline(never)]
fn visit_contacts<R: Real, D: Dynamics<R>>(
    scene: &D,
    motion: &Motion<R>,
    visit: &mut dyn FnMut(&Contact<R>),
) {
    scene.visit_contacts(motion, visit);
}

fn sixteenths<R: Real>(dt: R, count: u32) -> R {
    dt * (R::from_usize(count as usize) / R::from_usize(PARTS as usize))
}

/// A body that a step has left as it was may still hang on a spring whose swing is far too quick
/// for the step: where another motion lowers the energy, it takes that one. A fall by rounding is
/// none: the body would never sleep.
fn fall<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &mut State<R>,
    energy: &mut Energy<R>,
    seconds: R,
    step: &mut Step<R>,
) {
    let ceiling = energy.total() - energy_limit::rounding_of(energy, energy) * R::HALF;
    if let Some(lower) = descent::step(scene, state, ceiling, seconds, step) {
        (*state, *energy) = lower;
    }
}

/// The longest part of a step that begins at `done` sixteenths: the largest power of 2 that divides
/// it.
fn longest_part(done: u32) -> u32 {
    if done == 0 {
        PARTS
    } else {
        1 << done.trailing_zeros()
    }
}

/// One attempt at a step: whole by Newton's method, else split. Whether one of them ends with an
/// energy that is no higher; if not, state and energy stay.
fn attempt<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &mut State<R>,
    energy: &mut Energy<R>,
    seconds: R,
    workspace: &mut Workspace<R>,
    step: &mut Step<R>,
) -> bool {
    let problem = Problem::new(scene, state, energy, seconds);
    let contacts = &mut workspace.contacts;
    let mut end = *state;
    let mut is_lossless = false;
    for wide in [false, true] {
        gather(&problem, contacts, wide);
        if contacts.is_empty() {
            end = fly(&problem);
        } else if let Some(strain) = whole(&problem, contacts, &mut end, step) {
            is_lossless = strain.is_none();
        } else {
            break;
        }
        let (end_energy, touching) = Energy::with_touching(scene, &end);
        // A contact that was not foreseen has come down: look at all of them.
        if !wide && !contacts.foresaw(touching) {
            continue;
        }
        let known = (&mut *state, &mut *energy);
        let contact = Touched {
            touching,
            is_lossless,
        };
        if energy_limit::hold(scene, known, (&end, &end_energy), contact, step) {
            return true;
        }
        break;
    }
    step.fallback = true;
    let Some((end, is_lossless)) = split::step(scene, state, seconds, contacts, step) else {
        return false;
    };
    let (end_energy, touching) = Energy::with_touching(scene, &end);
    let contact = Touched {
        touching,
        is_lossless,
    };
    energy_limit::hold(scene, (state, energy), (&end, &end_energy), contact, step)
}

/// Free flight, without an iteration: exact for a body with two equal moments, else of order 2 with
/// the energy and the angular momentum of the start. Not inlined: what it can be prepared with
/// would be computed for steps in contact too.
#[inline(never)]
fn fly<R: Real, D: Dynamics<R>>(problem: &Problem<'_, R, D>) -> State<R> {
    let (start, seconds) = (&problem.start, problem.seconds);
    let gravity = problem.scene.gravity();
    let mean_velocity = start.linear_velocity + gravity * (seconds * R::HALF);
    let (axes, momentum) = (&problem.motion.axes, start.angular_momentum);
    let properties = problem.scene.inertia_properties();
    let rotation = if properties.is_asymmetric() {
        properties.rotated_at_constant_energy(problem.rotation, axes, momentum, seconds)
    } else {
        (properties.turn_symmetric(problem.rotation, axes, momentum, seconds)).normalised()
    };
    let plain = State {
        position: start.position + mean_velocity * seconds,
        linear_velocity: start.linear_velocity + gravity * seconds,
        orientation: rotation.to_quat(),
        angular_momentum: momentum,
    };
    if !flight_rounding::holds_both_ways::<R>() {
        return plain;
    }
    let mut seed = flight_rounding::seed_of(start);
    State {
        position: flight_rounding::advanced::<R>(
            start.position,
            mean_velocity * seconds,
            &mut seed,
        ),
        linear_velocity: flight_rounding::advanced::<R>(
            start.linear_velocity,
            gravity * seconds,
            &mut seed,
        ),
        ..plain
    }
}

/// The whole step at once: Newton's method, then what friction and dampers still must stop. Returns
/// how the step strains friction and dampers, or `None` if its `end` could not be had.
fn whole<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &mut Contacts<R>,
    end: &mut State<R>,
    step: &mut Step<R>,
) -> Option<Strain<R>> {
    let mut trial = problem.first_trial();
    let strain = newton::solve(problem, contacts, &mut trial, step)?;
    *end = problem.end_of(&trial);
    let strain = strain.of_step(problem);
    if !strain.is_resolved() {
        *end = end_velocity::settle(problem, contacts, &trial, strain, end);
    }
    end.not_finite().is_none().then_some(strain)
}

/// Collects the contacts that may touch in the step: those below ground, and those that its first
/// motion brings near; all where `wide`.
fn gather<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &mut Contacts<R>,
    wide: bool,
) {
    let (scene, motion, dt) = (problem.scene, &problem.motion, problem.seconds);
    let Some(plane) = problem.plane.filter(|_| !wide) else {
        let run = match scene.ground().bounds() {
            GroundBounds::Nowhere => ContactRange::NONE,
            _ => ContactRange::all(scene.body().contacts().len()),
        };
        let anywhere = !matches!(scene.ground().bounds(), GroundBounds::Nowhere);
        contacts.gather(problem, run, |_, _| true, |_| anywhere);
        return;
    };
    let spin = motion.angular_velocity;
    // What gravity and the turn's own curvature may add to the path of a contact along the normal.
    let bend =
        dt * dt * (scene.gravity().length() + spin.length_squared() * problem.bounding_radius);
    let bend = bend.at_most(R::TWO * problem.bounding_radius + dt * dt * scene.gravity().length());
    let fall = dt * -motion.linear_velocity.dot(plane.normal);
    let tilt = spin.cross(plane.normal);
    // However many turns it makes, a contact stays within the reach.
    let swing =
        (dt * tilt.length() * problem.bounding_radius).at_most(R::TWO * problem.bounding_radius);
    let margin = (fall + swing).at_least(R::ZERO) + bend;
    let run = scene.contacts_within(margin, motion.position, &motion.axes);
    // -n · (ω × r) = (ω × n) · r
    let keep = |depth: R, arm: R::Vec3| {
        depth > R::ZERO || depth + fall + dt * tilt.dot(arm) + bend > R::ZERO
    };
    // A rim counts as a whole: its lowest place may be another at the end.
    let may_touch = |rim: &Rim<R>| {
        let lowest = rim.support(-motion.axes.to_body(plane.normal));
        plane.gap(motion.position) - lowest <= margin
    };
    contacts.gather(problem, run, keep, may_touch);
}
