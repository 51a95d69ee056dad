//! Step size control of `EnergyMomentum` by step doubling.
//!
//! A step of `h` is compared with two steps of `h/2` from the same state, and the two are kept.
//!
//! *Estimate.* In smooth motion the local error of a method of order 2 is `C h³`. The two halves
//! have `2 C (h/2)³ = C h³/4`, and differ from the whole step by `3 C h³/4`. So their error is a
//! third of the difference (Hairer, Nørsett & Wanner, section II.4). The result is not
//! extrapolated, because each half is a step of `EnergyMomentum`, and only for such a step the
//! energy never increases. A cheaper estimate fails for this method: on linear springs the mean
//! force of a step is the mean of the forces at its ends, so their difference is 0 where the error
//! is not.
//!
//! *Allowed error.* With an error of at most `e` a step, the number of steps is proportional to
//! `e^(-1/3)`, and the error of a run to `e^(2/3)`. So `e` is proportional to `tolerance^(3/2)`,
//! and the error of a run to the tolerance. The unit of length is the size `L` of the body:
//! `e = SHARE tolerance √(tolerance/L)`. At a discontinuity of a force the error of a step is
//! proportional to `h` or less, so a step that is short enough is always accepted.

mod varying_friction;

use super::embedded_pair::Settings;
use super::embedded_pair::control::{self, Control, Errors};
use crate::contact::Motion;
use crate::energy::Energy;
use crate::error::{SceneError, StepError};
use crate::ground::SpringDamperGround;
use crate::integrator::energy_limit;
use crate::integrator::energy_momentum::{self, EnergyMomentum};
use crate::integrator::interface::{Integrator, Step, StepControl};
use crate::integrator::point::Point;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, size};
use crate::state::State;

/// [`EnergyMomentum`] with a tolerance instead of a step size: **the computed energy never
/// increases**, and each step states an estimate of its error.
///
/// A step of this method is two steps of [`EnergyMomentum`] of half its size. A third one, of the
/// whole size, is computed for comparison. [`Step::error_estimate`] is a third of the difference:
///
/// ```text
/// |δx| + r |δφ| + 0.2 s (|δv| + r |δω|)  <=  0.3 tolerance √(tolerance/r) + rounding
/// ```
/// Here `r` is the bounding radius of the body (or its radius of gyration, if that is larger), and
/// `δφ` and `δω` are the errors of the rotation and of the angular velocity. Where the friction
/// varies with the position, the estimate is at least two thirds of what one jump of the friction
/// may change, under the contacts that touch at the middle of the step. The rounding is 16 ε of
/// position and speed, plus what the roundings of the angular momentum, of the energy and of the
/// depths change in the velocities. The root makes the error of a run proportional to the
/// tolerance. It counts as 1 for a tolerance above `r`.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{AdaptiveEnergyMomentum, Coin, Coulomb, FlatGround, State, Stepper, UniformGravity};
///
/// let stepper = Stepper::builder(Coin::ring(1.0, 0.5)) // kg, m
///     .gravity(UniformGravity::down(9.8)) // m/s²
///     .ground(FlatGround::level(1000.0, 0.5)) // N/m and N s/m, for each point
///     .friction(Coulomb { coefficient: 0.3, slip_speed: 1e-10 }) // -, m/s
///     .integrator(AdaptiveEnergyMomentum::new(1e-3)) // m
///     .build()?;
/// let mut session = stepper.session(State::at(DVec3::Z).with_rotation_vector(DVec3::X)); // m, rad
/// let (mut before, mut worst) = (session.energy().total(), 0.0_f64);
/// while session.time() < 1.0 {
///     let step = session.step()?;
///     worst = worst.max(step.error_estimate.unwrap_or(0.0));
///     let after = session.energy().total();
///     assert!(after <= before);
///     before = after;
/// }
/// println!("{} steps, of at most {worst:.1e} m", session.step_count());
/// # assert!(worst > 0.0 && worst <= 0.3 * 1e-3 * (1e-3_f64 / 0.5).sqrt() + 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// - *Order* 2, like [`EnergyMomentum`]. Energy, invariants, stability, stick, contacts and bounded
///   work are those of [`EnergyMomentum`], because each half is a step of it.
/// - *Error of a run:* see the measured range in [`guide::choosing`](crate::guide::choosing). It is
///   the error after a second. After longer times it depends on how the motion amplifies it.
/// - *Cost:* three steps of [`EnergyMomentum`] for two that are kept, and rejected attempts. The
///   factor is about 1.6 for equal step sizes. The method gains where the motion needs short steps
///   for a short time, as in a bounce.
/// - *Estimate for a fixed step:* with a large tolerance all steps have the size `longest_step`,
///   and each one states its error.
/// - *Limit:* a contact that closes and opens again within half a step is not detected. So
///   `longest_step` must be shorter than such a contact that matters. The default is 0.01 s.
/// - *Round rims:* where friction reverses on the arc of a [`Disc`](crate::Disc) or
///   [`ThickDisc`](crate::ThickDisc), the quadrature of `EnergyMomentum` has an error that shorter
///   steps do not reduce, so neither does the tolerance. The estimate does not contain it. Nor does
///   it contain the difference of the two laws that act otherwise in [`EnergyMomentum`].
/// - *Small tolerances:* an error below the rounding of the state counts as allowed. Steps that are
///   very short lose motion to rounding, as described for slow motion in
///   [`guide::accuracy`](crate::guide::accuracy).
/// - *Errors:* a step that fails is repeated with a shorter one. Its error is returned if the step
///   size falls below the rounding of `longest_step`. On a ground whose force is not that of its
///   springs' energy no step is accurate, and the whole `budget` is spent:
///   [`check_ground`](crate::contract::check_ground) finds such a ground.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AdaptiveEnergyMomentum<R = f64> {
    /// Parameter of the accuracy, m, above 0. The error after a second is mostly of this size or
    /// less: [`guide::choosing`](crate::guide::choosing) has the measured range.
    pub tolerance: R,
    /// Largest step size, s, above 0.
    pub longest_step: R,
    /// Largest number of attempted steps in a run, rejected ones included, at least 1.
    pub budget: u32,
}

/// Error of the two halves as a fraction of their difference from the whole step.
const RICHARDSON: f64 = 1.0 / 3.0;
/// Time over which an error of a velocity counts as a displacement, s (a fraction of the second of
/// [`control`]).
///
/// It and [`SHARE`] were chosen on trials 1, 3, 5 and 8 of the coin report with tolerances from
/// 1e-2 to 1e-5 m, so that the error of a run of a second is 0.04 to 1 tolerances.
/// `tests/physics/adaptive_energy_momentum.rs` tests them on those and on other scenes.
const HORIZON: f64 = 0.2;
/// Largest error of a step, relative to `tolerance √(tolerance/L)`.
const SHARE: f64 = 0.3;
/// Roundings of a gap up to which it is not known whether a contact touches: those of the position,
/// of the orientation, and of an arm that is a function of the orientation.
const GAP_ROUNDINGS: f64 = 8.0;
/// Number of square roots that the controller takes of the error, which is of order 3 in the step
/// size.
const ROOTS: u32 = 2;

impl<R: Real> AdaptiveEnergyMomentum<R> {
    /// Creates the method for a tolerance (m), with steps of at most 0.01 s and a budget of a
    /// million steps.
    #[must_use]
    pub fn new(tolerance: R) -> Self {
        Self {
            tolerance,
            longest_step: R::from_f64(0.01),
            budget: 1_000_000,
        }
    }

    fn settings(&self) -> Settings<R> {
        Settings {
            tolerance: self.tolerance,
            longest_step: self.longest_step,
            budget: self.budget,
        }
    }
}

/// Workspace of [`AdaptiveEnergyMomentum`]: proposed step size, last error, used budget, and what
/// [`EnergyMomentum`] keeps.
///
/// A new workspace chooses the first step from the state alone. It
/// [belongs to one scene](crate::Integrator::Workspace).
#[derive(Clone, Debug, Default)]
pub struct Workspace<R: Real = f64> {
    control: Control<R>,
    method: energy_momentum::Workspace<R>,
    rest: Rest<R>,
}

/// The last two steps that have left a state unchanged, and that state. A frame of a display is a
/// whole step and the rest of one.
#[derive(Clone, Copy, Debug, Default)]
struct Rest<R: Real>(Option<([AtRest<R>; 2], State<R>)>);

/// A step that has left a state unchanged.
#[derive(Clone, Copy, Debug)]
struct AtRest<R> {
    /// Length, s.
    seconds: R,
    /// Work of drives, J.
    drive_work: R,
}

impl<R: Real> Rest<R> {
    /// Notes a step that leaves the state unchanged, if the comparison step has left it unchanged
    /// too: any other error changes the size of the next step.
    fn after(&self, start: &State<R>, doubled: &Doubled<R>, error: R) -> Self {
        let step = AtRest {
            seconds: doubled.step.elapsed,
            drive_work: doubled.step.drive_work,
        };
        let before = match &self.0 {
            Some(([last, _], known)) if known == start => *last,
            _ => step,
        };
        let rests = doubled.end == *start && error == R::ZERO;
        Self(rests.then_some(([step, before], *start)))
    }

    /// Returns the step of this length that is known to leave this state unchanged.
    #[inline]
    fn of(&self, state: &State<R>, seconds: R) -> Option<&AtRest<R>> {
        let (steps, _) = self.0.as_ref().filter(|(_, known)| known == state)?;
        steps.iter().find(|step| step.seconds == seconds)
    }
}

impl<R: Real> AtRest<R> {
    /// Returns the report of such a step after the work so far.
    fn report(&self, work: &Step<R>) -> Step<R> {
        Step {
            elapsed: self.seconds,
            drive_work: self.drive_work,
            error_estimate: Some(R::ZERO),
            ..*work
        }
    }
}

impl<R: Real> Integrator<R> for AdaptiveEnergyMomentum<R> {
    type Workspace = Workspace<R>;

    const ADAPTIVE: bool = true;

    fn step<D: Dynamics<R>>(
        &self,
        scene: &D,
        state: &mut State<R>,
        limit: R,
        workspace: &mut Workspace<R>,
    ) -> Result<Step<R>, StepError> {
        if limit <= R::ZERO {
            return Ok(Step::new(R::ZERO, 0));
        }
        state.check()?;
        let settings = self.settings();
        let control = &mut workspace.control;
        let mut work = Step::new(R::ZERO, 0);
        let mut trial = control.first_trial_from((scene, state), ROOTS, &settings, &mut work);
        loop {
            let seconds = control.next_attempt(&settings, &trial, limit)?;
            if let Some(step) = workspace.rest.of(state, seconds) {
                control.accept(ROOTS, &trial, seconds, R::ZERO);
                return Ok(step.report(&work));
            }
            let method = &mut workspace.method;
            let attempt = Doubled::of(&settings, scene, state, seconds, method, &mut work);
            let (error, failure) = match attempt {
                Ok(doubled) => {
                    let error = doubled.relative_error();
                    if error <= R::ONE {
                        control.accept(ROOTS, &trial, seconds, error);
                        workspace.rest = workspace.rest.after(state, &doubled, error);
                        *state = doubled.end;
                        return Ok(doubled.step);
                    }
                    let quantity = doubled.errors.largest();
                    (error, control.too_short(quantity))
                }
                Err(failure) => (R::MAX, failure),
            };
            work.rejected += 1;
            trial.reduce(ROOTS, seconds, error);
            if control.gives_up(&trial, limit) {
                return Err(failure);
            }
        }
    }

    fn order(&self) -> u32 {
        2
    }

    #[inline]
    fn step_control(&self, workspace: &Self::Workspace, _: &State<R>) -> Option<StepControl<R>> {
        Some(workspace.control.carried())
    }

    #[inline]
    fn set_step_control(&self, workspace: &mut Self::Workspace, control: StepControl<R>) {
        workspace.control = Control::carrying(control);
    }

    #[inline]
    fn clear(&self, workspace: &mut Self::Workspace) {
        workspace.method.clear();
        (workspace.control, workspace.rest) = (Control::default(), Rest::default());
    }

    fn check(&self) -> Result<(), SceneError> {
        self.settings().check()
    }
}

/// Returns the largest allowed error of a step, m.
fn allowed<R: Real, D: Dynamics<R>>(settings: &Settings<R>, scene: &D, motion: &Motion<R>) -> R {
    let tolerance = settings.tolerance;
    let fraction = (tolerance / size(scene)).sqrt().at_most(R::ONE);
    tolerance * fraction * R::from_f64(SHARE) + control::rounding(scene, motion, control::HORIZON)
}

/// Returns the error of a step that the rounding of energies causes, m. Shorter steps do not reduce
/// it.
///
/// It matters for a body that is nearly at rest, for one on springs whose energy is far above its
/// own, and on ground so hard that some roundings of the height stop the body.
#[cold]
fn rounding_of_energies<R: Real, D: Dynamics<R>>(scene: &D, [start, end]: [&State<R>; 2]) -> R {
    let energy = Energy::of(scene, end);
    let sum = energy_limit::rounding_of(&energy, &energy);
    let [before, after] = [start, end].map(|state| scene.motion(state));
    let [work, closing] = rounding_of_work(scene, &before, &after);
    error_by(scene, sum, energy.kinetic()) + error_by(scene, work, closing)
}

/// Returns the error of a step that the rounding of the angular momentum causes, m. A slender body
/// has a large inverse moment, by which a rounding about another axis is multiplied.
#[cold]
fn rounding_of_spin<R: Real, D: Dynamics<R>>(scene: &D, state: &State<R>) -> R {
    let most = scene.inertia_properties().largest_inverse_moment();
    let spin = state.angular_momentum.length() * most * (R::EPSILON * R::from_f64(16.0));
    spin * (size(scene) * R::from_f64(HORIZON))
}

/// Returns the error of a step in which the kinetic energy `T` is wrong by `δ`, m.
///
/// `EnergyMomentum` corrects the velocities of a step until the computed energy is no higher than
/// before. This changes a velocity by `δ/√(2 m T)`, and by `√(δ/2m)` at most.
fn error_by<R: Real, D: Dynamics<R>>(scene: &D, energy: R, kinetic: R) -> R {
    if energy == R::ZERO {
        return R::ZERO;
    }
    let per_mass = energy / ((kinetic + energy) * R::TWO).sqrt();
    let properties = scene.inertia_properties();
    let speed = properties.inverse_mass().sqrt();
    let spin = properties.largest_inverse_moment().sqrt();
    per_mass * (speed + spin * size(scene)) * R::from_f64(HORIZON)
}

/// Returns the work of the pushes and of gravity over the rounding of a gap, and the kinetic energy
/// of the mass at the speed at which the contacts close, J.
///
/// A gap, and so the depth `d` of a contact, is known to a rounding `δ`. The energy of springs of
/// stiffness `k` is known to `k d δ`, which is far above `ε k d²/2` where `d` is small. Where the
/// pushes carry the weight, `k δ²` is left. A damper that acts from the touch on begins to act
/// within `δ`, with the velocities before the step. A contact may or may not touch if its gap is
/// [`GAP_ROUNDINGS`] or less.
fn rounding_of_work<R: Real, D: Dynamics<R>>(
    scene: &D,
    before: &Motion<R>,
    after: &Motion<R>,
) -> [R; 2] {
    let rounding = energy_momentum::unit_of_gap(scene, after.position);
    let normal = scene.ground().surface(after.position).normal;
    let deeper = Motion {
        position: after.position - normal * (rounding * R::from_f64(GAP_ROUNDINGS)),
        axes: after.axes,
        ..*before
    };
    let mass = scene.inertia_properties().mass();
    let (mut force, mut pushes, mut power) = (scene.gravity() * mass, R::ZERO, R::ZERO);
    scene.probe(|| {
        scene.visit_contacts(&deeper, |contact| {
            let both = contact.force(scene.ground(), scene.friction());
            let push = both.dot(contact.normal);
            force += contact.normal * push;
            pushes += push;
            power += push * contact.closing_speed;
        });
    });
    if pushes == R::ZERO {
        return [R::ZERO; 2];
    }
    let closing_speed = power / pushes;
    let kinetic = closing_speed * closing_speed * mass * R::HALF;
    [force.length() * rounding, kinetic]
}

/// Two steps of half the size, and their difference from the step of the whole size.
struct Doubled<R: Real> {
    end: State<R>,
    /// Report of the two halves, with the work of all three steps and of rejected attempts.
    step: Step<R>,
    errors: Errors<R>,
    allowed: R,
    /// False if the step of the whole size was divided into the same two halves. Then the
    /// difference is 0, and says nothing of the error.
    is_known: bool,
}

impl<R: Real> Doubled<R> {
    /// Takes a step from `start` as a whole and in two halves, and adds their work to `work`.
    fn of<D: Dynamics<R>>(
        settings: &Settings<R>,
        scene: &D,
        start: &State<R>,
        seconds: R,
        workspace: &mut energy_momentum::Workspace<R>,
        work: &mut Step<R>,
    ) -> Result<Self, StepError> {
        let mut advance = |state: &mut State<R>, time_step: R| {
            let step = EnergyMomentum { time_step }.step(scene, state, time_step, workspace)?;
            work.evaluations += step.evaluations;
            work.iterations += step.iterations;
            Ok(step)
        };
        let (mut whole, mut end) = (*start, *start);
        // The halves come last, so that the workspace remembers the end of the step.
        let is_divided = advance(&mut whole, seconds)?.fallback;
        let half = seconds * R::HALF;
        let first = advance(&mut end, half)?;
        let middle = end;
        let halves = [first, advance(&mut end, seconds - half)?];
        let motion = Point::of(&end).motion(scene);
        let difference = Point::of(&whole).plus(&Point::of(&end), -R::ONE);
        let errors = Errors::of(scene, &difference, &motion)
            .within(HORIZON)
            .scaled(RICHARDSON);
        let errors = match varying_friction::error_of(scene, [start, &middle, &end], seconds) {
            Some(jump) => errors.or_larger(jump.within(HORIZON), varying_friction::BEYOND_SMOOTH),
            None => errors,
        };
        let mut allowed = allowed(settings, scene, &motion);
        if errors.total() > allowed {
            allowed += rounding_of_energies(scene, [start, &end]);
            allowed += rounding_of_spin(scene, &end);
        }
        let mut step = sum_of(scene, [start, &end], &halves, work);
        step.elapsed = seconds;
        step.error_estimate = Some(errors.total());
        Ok(Self {
            end,
            step,
            errors,
            allowed,
            // At rest they agree without having been divided.
            is_known: !(is_divided && whole == end && end != *start),
        })
    }

    /// Error relative to the allowed one, and the largest number if it is not known.
    #[inline]
    fn relative_error(&self) -> R {
        if self.is_known {
            self.errors.total() / self.allowed
        } else {
            R::MAX
        }
    }
}

/// Returns the report of two halves from `start` to `end`, with the work of `work`.
fn sum_of<R: Real, D: Dynamics<R>>(
    scene: &D,
    [start, end]: [&State<R>; 2],
    [first, second]: &[Step<R>; 2],
    work: &Step<R>,
) -> Step<R> {
    let mut step = Step {
        fallback: first.fallback || second.fallback,
        energy_removed: first.energy_removed + second.energy_removed,
        drive_work: first.drive_work + second.drive_work,
        ..*work
    };
    if first.drive_work != R::ZERO || second.drive_work != R::ZERO {
        let energies = [start, end].map(|state| Energy::of(scene, state).total());
        energy_momentum::close_account(scene, energies, &mut step);
    }
    step
}
