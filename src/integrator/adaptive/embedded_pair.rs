//! Adaptive Runge-Kutta pairs: attempt, error estimate and step size control. The coefficients are
//! in the files of the pairs.
//!
//! The stages of a step:
//!
//! 1. `attempt`: a step of the proposed size, or to the limit. The difference of the two results of
//!    the pair estimates its error.
//! 2. `touch` and `slip`: contacts that begin or cease to push in the step, or whose friction
//!    reverses. The estimate does not detect such discontinuities reliably. These modules bound the
//!    error that they cause.
//! 3. `control`: the step is accepted if the total error is within the tolerance. Otherwise it is
//!    repeated up to the first discontinuity that matters, or with a smaller step size.
//!
//! `tuning` has the constants that were chosen.

mod attempt;
pub(super) mod control;
mod late;
mod slip;
mod touch;
mod tuning;

use crate::error::{Quantity, StepError};
use crate::integrator::interface::{Step, StepControl};
use crate::integrator::point::Point;
use crate::real::Real;
use crate::rotation::Rotation;
use crate::scene::Dynamics;
use crate::state::State;
pub(super) use attempt::Place;
pub(in crate::integrator::adaptive) use attempt::{Attempt, LeftOut, Planned};
pub(crate) use attempt::{Formula, Pair, Settings};
use control::{Control, Errors};
use touch::Discontinuities;

/// Workspace of an adaptive Runge-Kutta method: proposed step size, last error and used budget.
///
/// It also keeps the last slope, which saves an evaluation where a step begins at the same state. A
/// new workspace chooses the first step from the state alone. It is plain data, and
/// [belongs to one scene](crate::Integrator::Workspace).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Workspace<R: Real = f64> {
    control: Control<R>,
    known: Option<Known<R>>,
    /// Orientation at the start of a step whose start is not known.
    resumed: Option<Rotation<R>>,
}

impl<R: Real> Workspace<R> {
    /// Returns the data, besides the state, that determine the next step.
    #[inline]
    pub(crate) fn step_control(&self, state: &State<R>) -> StepControl<R> {
        let known = self.known.as_ref().filter(|known| known.state == *state);
        let orientation = known.map(|known| known.place.point.orientation);
        StepControl {
            orientation: orientation.or(self.resumed).map(Rotation::to_quat),
            ..self.control.carried()
        }
    }

    /// Restores the choice of the next step, with a full budget.
    #[inline]
    pub(crate) fn set_step_control(&mut self, control: StepControl<R>) {
        self.resumed = control.orientation.map(Rotation::unscaled);
        self.control = Control::carrying(control);
    }

    /// Returns the point at which a step from `state` begins.
    ///
    /// An orientation that is scaled to length 1 again may differ from the one at the end of the
    /// previous step.
    #[inline]
    fn point(&self, state: &State<R>) -> Point<R> {
        let point = Point::of(state);
        match self.resumed {
            Some(orientation) if orientation.normalised().to_quat() == state.orientation => Point {
                orientation,
                ..point
            },
            _ => point,
        }
    }
}

/// A state, and the quantities that have been computed at it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Known<R: Real> {
    state: State<R>,
    place: Place<R>,
}

impl<R: Real> Known<R> {
    /// Creates the data for the end of a step.
    ///
    /// A step to a discontinuity has left out the contacts that begin to push there, so its slope
    /// is evaluated again.
    #[inline(always)]
    fn of<D: Dynamics<R>>(
        scene: &D,
        state: &State<R>,
        end: &Place<R>,
        to_discontinuity: bool,
    ) -> Self {
        let place = if to_discontinuity {
            Place::at(scene, end.point)
        } else {
            *end
        };
        Self {
            state: *state,
            place,
        }
    }
}

/// Takes one step of a method, given by its formula and its parameters, with an error below the
/// tolerance, of at most `limit` seconds.
pub(crate) fn step<R: Real, D: Dynamics<R>, const STAGES: usize>(
    (formula, settings): (&impl Formula<R, STAGES>, &Settings<R>),
    scene: &D,
    state: &mut State<R>,
    limit: R,
    workspace: &mut Workspace<R>,
) -> Result<Step<R>, StepError> {
    if limit <= R::ZERO {
        return Ok(Step::new(R::ZERO, 0));
    }
    let pair = formula.pair();
    let mut report = Step::new(R::ZERO, 0);
    let start = start_of(scene, state, workspace, &mut report)?;
    let control = &mut workspace.control;
    let mut trial = control.first_trial(settings, || {
        report.evaluations += 1;
        control::first_length(pair.roots, settings, scene, &start)
    });
    loop {
        let seconds = control.next_attempt(settings, &trial, limit)?;
        let planned = Planned {
            scene,
            start: &start,
            seconds,
            to_discontinuity: trial.is_to_discontinuity(seconds),
        };
        let attempt = formula.attempt(settings, &planned, &mut report);
        let quantity = if let Some(attempt) = &attempt {
            let judged = Judged::of(pair, settings, &planned, attempt);
            let error = judged.relative_error();
            if judged.is_accurate() {
                control.accept(pair.roots, &trial, seconds, error);
                workspace.resumed = None;
                report.error_estimate = Some(judged.errors.total());
                workspace.known = Some(taken(&planned, state, &attempt.end, &mut report));
                return Ok(report);
            }
            trial.shorten(pair.roots, seconds, error, &judged.discontinuities);
            judged.errors.largest()
        } else {
            trial.reduce(pair.roots, seconds, R::from_f64(tuning::UNSOLVED_ERROR));
            Quantity::LinearVelocity
        };
        report.rejected += 1;
        if control.gives_up(&trial, limit) {
            return Err(control.too_short(quantity));
        }
    }
}

/// The errors of an attempted step.
struct Judged<R> {
    errors: Errors<R>,
    discontinuities: Discontinuities<R>,
    allowed: R,
}

impl<R: Real> Judged<R> {
    /// Adds the errors that the discontinuities of a step cause to its estimate.
    #[inline(always)]
    fn of<D: Dynamics<R>, const STAGES: usize>(
        pair: &Pair<STAGES>,
        settings: &Settings<R>,
        planned: &Planned<'_, R, D>,
        attempt: &Attempt<R, STAGES>,
    ) -> Self {
        let motion = &attempt.end.motion;
        let allowed = control::allowed(settings, planned.scene, motion);
        let difference = attempt.counted(planned);
        let mut errors = Errors::of(planned.scene, &difference, motion).within(pair.trust);
        let bounds = [errors.total(), allowed];
        let discontinuities = touch::discontinuities(pair, planned, attempt, bounds);
        errors.add_discontinuities(&discontinuities);
        Self {
            errors,
            discontinuities,
            allowed,
        }
    }

    /// An end of infinite speed has an infinite rounding error, which would allow any error.
    #[inline(always)]
    fn is_accurate(&self) -> bool {
        let error = self.errors.total();
        error <= self.allowed && error.is_finite()
    }

    /// Error relative to the allowed one.
    #[inline(always)]
    fn relative_error(&self) -> R {
        self.errors.total() / self.allowed
    }
}

/// Writes the end of an accepted step, and returns what the next step can use of it.
#[inline(always)]
fn taken<R: Real, D: Dynamics<R>>(
    planned: &Planned<'_, R, D>,
    state: &mut State<R>,
    end: &Place<R>,
    report: &mut Step<R>,
) -> Known<R> {
    *state = end.point.to_state();
    report.elapsed = planned.seconds;
    report.evaluations += u32::from(planned.to_discontinuity);
    Known::of(planned.scene, state, end, planned.to_discontinuity)
}

/// Returns the start of the step: known from the previous step, or evaluated.
#[inline]
fn start_of<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &State<R>,
    workspace: &Workspace<R>,
    report: &mut Step<R>,
) -> Result<Place<R>, StepError> {
    if let Some(known) = &workspace.known {
        if known.state == *state {
            return Ok(known.place);
        }
    }
    state.check()?;
    report.evaluations += 1;
    Ok(Place::at(scene, workspace.point(state)))
}
