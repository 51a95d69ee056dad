//! Step size control of Nyström's method.
//!
//! # Estimate
//!
//! The step is the one of [`Nystrom`](crate::Nystrom), with its correction of touch-downs. What it
//! leaves as an error of the velocities has two causes.
//!
//! - *The weighted sum of the forces over the stages* is exact for a cubic function of time. For
//!   other functions it is wrong by an amount that the third difference `δ₃ = h Σ d_i f(c_i)` over
//!   the four stages bounds. In smooth motion `δ₃` is proportional to `h⁴`, and the error to `h⁵`.
//!   If friction jumps by `Δf` within the step, `|δ₃|` is 3.6 to 7.8 `h Δf`, wherever the jump is,
//!   so it is never small by chance. The contacts that the correction replaces are left out.
//! - *The effect of one stage on the next*, which the correction does not contain, changes the
//!   force at the end of the step: the last stage has the same time as the end, and another state.
//!   The difference `δ₄ = h (f_end - f_4)` is proportional to `h³`. The force at the end is that of
//!   the first stage of the next step, so it costs no evaluation in a step that is accepted.
//!
//! The error as a displacement is `T a (|δ₃| + b |δ₄|)`. `|δ|` is the velocity of the farthest
//! point. Friction that opposes the error is taken into account by `damping`, if the error would
//! otherwise be too large. `dip` adds the contacts that close and open again within one step, and
//! `estimate` the rotation, whose error does not depend on a force.
//!
//! # Allowed error
//!
//! It is `tolerance h/(1 s)`, because the errors of the steps add up. With an allowed error that
//! does not depend on the step size, the error of a run is proportional to the number of its steps.
//! That number differs by more than a factor of ten between the trials of the coin report.

mod damping;
mod dip;
mod estimate;

use super::embedded_pair::control::{self, Control, Trial};
use super::embedded_pair::{Answers, Place, Settings};
use super::energy_momentum::check_state;
use crate::body::ContactRange;
use crate::error::{Quantity, SceneError, StepError};
use crate::integrator::explicit::{Stage, Start};
use crate::integrator::interface::{Integrator, Step, StepControl};
use crate::integrator::point::Point;
use crate::real::Real;
use crate::scene::Dynamics;
use crate::state::State;
use estimate::Attempt;

/// [`Nystrom`](crate::Nystrom) with a tolerance instead of a step size, for loose and medium
/// tolerances.
///
/// One tolerance fits scenes whose fixed step sizes for the same error differ by a factor of forty.
/// A step does not end at each touch-down, in contrast to
/// [`DormandPrince54`](crate::DormandPrince54): it contains the correction of
/// [`Nystrom`](crate::Nystrom). So the method has a lower cost for errors above a hundredth of a
/// millimetre, if a body slides and rolls. If it sticks, or spins upright on the spot, the cost is
/// that of [`BogackiShampine32`](crate::BogackiShampine32) or higher.
///
/// A step is accepted if
///
/// ```text
/// 0.01 s · 0.006 (|δ₃| + 5 |δ₄|)  <=  tolerance · h/(1 s) + rounding
/// ```
/// Here `h` is the step size and `|δ| = |δv| + r |δω|`, with the bounding radius `r` of the body
/// (or its radius of gyration, if that is larger). `δ₃` is the third difference of the forces over
/// the stages. `δ₄` is the difference between the forces at the end of the step and at its last
/// stage. Friction reduces both, where it opposes them. The rotation, and contacts that close and
/// open within the step, add their parts. [`Step::error_estimate`] is the left side.
///
/// ```
/// use tumble::{AdaptiveNystrom, Trial};
///
/// let trial = Trial { slip_speed: 1e-3, ..Trial::report(1).ok_or("no such trial")? };
/// let stepper = trial.stepper(AdaptiveNystrom::new(1e-4))?; // m
/// let mut session = stepper.session(trial.state());
/// session.advance(1.0)?;
/// println!("{} steps", session.step_count());
/// # assert!(session.step_count() < 200);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// - *Order* 4, and 2 through touch-downs. Four force evaluations per attempted step.
/// - *Error of a run:* see the measured range in [`guide::choosing`](crate::guide::choosing). It is
///   the error after a second. After longer times it depends on how the motion amplifies it.
/// - *May add energy* by the size of its error.
/// - *Stick at a small slip speed:* the steps may exceed the limit of stability of the friction, as
///   long as friction itself removes the error. For a slip speed below 1e-4 m/s use
///   [`AdaptiveEnergyMomentum`](crate::AdaptiveEnergyMomentum).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AdaptiveNystrom<R = f64> {
    /// Parameter of the accuracy, m, above 0. The error after a second is of this size.
    pub tolerance: R,
    /// Largest step size, s, above 0.
    pub longest_step: R,
    /// Largest number of attempted steps in a run, rejected ones included, at least 1.
    pub budget: u32,
}

/// Number of square roots that the controller takes of the error. The error is proportional to the
/// fourth power of the step size in smooth motion.
const ROOTS: u32 = 2;

impl<R: Real> AdaptiveNystrom<R> {
    /// Creates the method for a tolerance (m), with steps of at most 0.1 s and a budget of a
    /// million steps.
    #[must_use]
    pub fn new(tolerance: R) -> Self {
        Self {
            tolerance,
            longest_step: R::from_f64(0.1),
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

/// Workspace of [`AdaptiveNystrom`]: proposed step size, last error, used budget, and the forces at
/// the end of the last step.
///
/// A new workspace chooses the first step from the state alone. To continue after a pause with the
/// same results, keep the workspace with the state.
#[derive(Clone, Debug, Default)]
pub struct Workspace<R: Real = f64> {
    control: Control<R>,
    known: Option<Known<R>>,
}

/// A state with its first stage, and what identifies the scene in which it was evaluated.
#[derive(Clone, Copy, Debug)]
struct Known<R: Real> {
    state: State<R>,
    stage: Stage<R>,
    /// `None` for a friction law that depends on the position, which no values identify.
    answers: Option<Answers<R>>,
}

impl<R: Real> Known<R> {
    /// Returns true if this is the first stage of a step from `state`.
    fn is_of<D: Dynamics<R>>(&self, scene: &D, state: &State<R>) -> bool {
        self.state == *state
            && self.answers.is_some()
            && self.answers == Answers::of_uniform(scene, state)
    }
}

impl<R: Real> Integrator<R> for AdaptiveNystrom<R> {
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
        let settings = self.settings();
        let mut report = Step::new(R::ZERO, 0);
        let mut start = start_of(scene, state, workspace, &mut report)?;
        let control = &mut workspace.control;
        let mut trial = first_trial(&settings, scene, state, control, &mut report);
        loop {
            control.spend(&settings)?;
            start.seconds = trial.seconds(limit);
            if start.seconds <= R::ZERO {
                // The proposed step size has underflowed.
                return Err(control.too_short(&settings, Quantity::Position));
            }
            let attempt = Attempt::of(&settings, scene, &start);
            report.evaluations += 4;
            let error = attempt.relative_error();
            if error <= R::ONE {
                control.accept(ROOTS, &trial, start.seconds, error);
                *state = attempt.state;
                workspace.known = Some(Known {
                    state: *state,
                    stage: attempt.end,
                    answers: Answers::of_uniform(scene, state),
                });
                report.elapsed = start.seconds;
                report.error_estimate = Some(attempt.errors.total());
                return Ok(report);
            }
            report.rejected += 1;
            trial.reduce(ROOTS, start.seconds, error);
            if trial.seconds(limit) < settings.shortest_step() {
                return Err(control.too_short(&settings, attempt.errors.largest()));
            }
        }
    }

    fn order(&self) -> u32 {
        4
    }

    #[inline]
    fn step_control(&self, workspace: &Self::Workspace, _: &State<R>) -> Option<StepControl<R>> {
        Some(workspace.control.carried())
    }

    #[inline]
    fn set_step_control(&self, workspace: &mut Self::Workspace, control: StepControl<R>) {
        workspace.control = Control::carrying(control);
    }

    fn check(&self) -> Result<(), SceneError> {
        self.settings().check()
    }
}

/// Returns the start of the step, with its first stage from the previous step if that is known.
fn start_of<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &State<R>,
    workspace: &Workspace<R>,
    report: &mut Step<R>,
) -> Result<Start<R>, StepError> {
    if let Some(known) = &workspace.known {
        if known.is_of(scene, state) {
            let point = Point::of(state);
            return Ok(Start::with_stage(point, known.stage, R::ZERO));
        }
    }
    check_state(state)?;
    report.evaluations += 1;
    Ok(Start::of(
        scene,
        &Point::of(state),
        R::ZERO,
        ContactRange::NONE,
    ))
}

/// Returns the first attempt at a step: of the proposed size, or of a size that follows from the
/// state alone.
fn first_trial<R: Real, D: Dynamics<R>>(
    settings: &Settings<R>,
    scene: &D,
    state: &State<R>,
    control: &Control<R>,
    report: &mut Step<R>,
) -> Trial<R> {
    let mut trial = control.first_trial(|| {
        report.evaluations += 2;
        let start = Place::at(scene, Point::of(state));
        control::first_length(ROOTS, settings, scene, &start)
    });
    trial.length = trial.length.at_most(settings.longest_step);
    trial
}
