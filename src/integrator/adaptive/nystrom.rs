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
//! otherwise be too large. `dip` adds the contacts that close and open again within one step.
//! `estimate` adds the rotation, whose error does not depend on a force, and the correction of
//! touch-downs: its direction in a body that rotates within the step, and its path.
//!
//! # Second pass of the correction
//!
//! The first pass computes the forces of a touch-down from a path to the end that the stages have
//! found. If the step ends soon after the touch-down, that end is wrong by as much as the contact
//! has done, and so is the path. [`Nystrom`](crate::Nystrom) leaves it at that. Here a second pass
//! follows, with a path to the corrected end. What it changes is a measure of what is still wrong.
//!
//! # Friction of a contact that hardly slips
//!
//! The lowest point of a body that spins upright on the spot has almost no slip and almost no
//! friction. Its friction is stiff, though, and a step longer than its limit of stability would
//! amplify the rounding of the slip. In a step whose error may contain all the friction of such a
//! contact, friction is limited to what is stable ([`FrictionLimit`]). The friction that is removed
//! counts as an error. A contact that sticks under a load is not limited, and neither is a round
//! rim.
//!
//! # Allowed error
//!
//! It is `tolerance h/(1 s)`, because the errors of the steps add up. With an allowed error that
//! does not depend on the step size, the error of a run is proportional to the number of its steps.
//! That number differs by more than a factor of ten between the trials of the coin report.

mod damping;
mod dip;
mod estimate;

use super::embedded_pair::Settings;
use super::embedded_pair::control::Control;
use crate::body::ContactRange;
use crate::contact::Motion;
use crate::error::{SceneError, StepError};
use crate::integrator::explicit::{Stage, Start};
use crate::integrator::interface::{Integrator, Step, StepControl};
use crate::integrator::point::Point;
use crate::real::Real;
use crate::scene::{Dynamics, FrictionLimit, LimitedScene, Stiffest};
use crate::state::State;
use damping::HORIZON;
use estimate::{Attempt, SPAN};

/// [`Nystrom`](crate::Nystrom) with a tolerance instead of a step size, for loose and medium
/// tolerances.
///
/// One tolerance fits scenes whose fixed step sizes for the same error differ by a factor of forty.
/// A step does not end at each touch-down, in contrast to
/// [`DormandPrince54`](crate::DormandPrince54): it contains the correction of
/// [`Nystrom`](crate::Nystrom). So the method has a lower cost for errors above a hundredth of a
/// millimetre, if a body slides, rolls or spins on the spot. If it sticks, the cost is that of
/// [`BogackiShampine32`](crate::BogackiShampine32) or higher.
///
/// A step is accepted if
///
/// ```text
/// 0.01 s · 0.006 (|δ₃| + 5 |δ₄|)  <=  tolerance · h/(1 s) + rounding
/// ```
/// Here `h` is the step size and `|δ| = |δv| + r |δω|`, with the bounding radius `r` of the body
/// (or its radius of gyration, if that is larger). `δ₃` is the third difference of the forces over
/// the stages. `δ₄` is the difference between the forces at the end of the step and at its last
/// stage. Friction reduces both, where it opposes them. The rotation, contacts that close and open
/// within the step, the correction of touch-downs (direction and path), and friction that the step
/// has limited add their parts. [`Step::error_estimate`] is the left side.
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
/// - *Order* 4, and 2 through touch-downs. Four force evaluations per attempted step, and a fifth
///   if friction is limited.
/// - *Rotation:* the phase error of [`Nystrom`](crate::Nystrom) in a uniform rotation is left out.
/// - *Error of a run:* see the measured range in [`guide::choosing`](crate::guide::choosing). It is
///   the error after a second. After longer times it depends on how the motion amplifies it.
/// - *May add energy* by the size of its error.
/// - *Bounces without dampers*, at a tolerance far above the depth of the contact: a step may
///   contain the whole contact. The speed after a slow bounce can then be wrong by up to 40
///   tolerances in a second, as with [`DormandPrince54`](crate::DormandPrince54).
/// - *Spinning on the spot:* where a contact hardly slips and has hardly any friction, the step may
///   exceed the limit of stability of its friction, whatever the slip speed. Friction is then
///   limited to what is stable. The friction of a round rim is resolved instead, in somewhat more
///   steps at a small slip speed.
/// - *Stick at a small slip speed:* the steps may exceed the limit of stability of the friction, as
///   long as friction itself removes the error. For a slip speed below 1e-4 m/s use
///   [`AdaptiveEnergyMomentum`](crate::AdaptiveEnergyMomentum).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AdaptiveNystrom<R = f64> {
    /// Parameter of the accuracy, m, above 0. The error after a second is mostly of this size or
    /// less: [`guide::choosing`](crate::guide::choosing) has the measured range.
    pub tolerance: R,
    /// Largest step size, s, above 0.
    pub longest_step: R,
    /// Largest number of attempted steps in a run, rejected ones included, at least 1.
    pub budget: u32,
}

/// Number of square roots that the controller takes of the error. The error is proportional to the
/// fourth power of the step size in smooth motion.
const ROOTS: u32 = 2;
/// Product of the step size and a damping rate up to which friction is not limited. The method is
/// stable up to 2.78.
const STABLE: f64 = 2.5;

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
/// A new workspace chooses the first step from the state alone. It
/// [belongs to one scene](crate::Integrator::Workspace).
#[derive(Clone, Debug, Default)]
pub struct Workspace<R: Real = f64> {
    control: Control<R>,
    known: Option<Known<R>>,
}

/// A state with its first stage.
#[derive(Clone, Copy, Debug)]
struct Known<R: Real> {
    state: State<R>,
    stage: Stage<R>,
    /// Contact with the stiffest friction.
    stiffest: Stiffest<R>,
    /// True if the forces are those of a limited friction.
    is_limited: bool,
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
        let mut start = Begin::of(scene, state, workspace, &mut report)?;
        let control = &mut workspace.control;
        let mut trial = control.first_trial_from((scene, state), ROOTS, &settings, &mut report);
        loop {
            let seconds = control.next_attempt(&settings, &trial, limit)?;
            let friction_limit = start.limit(&settings, scene, seconds);
            let limited = LimitedScene::of(scene, &friction_limit);
            start.prepare(&limited, seconds, &mut report);
            let attempt = Attempt::of(&settings, (scene, &limited), &start.start);
            report.evaluations += 4;
            let error = attempt.relative_error();
            if error <= R::ONE {
                control.accept(ROOTS, &trial, seconds, error);
                *state = attempt.state;
                workspace.known = Some(Known {
                    state: *state,
                    stage: attempt.end,
                    stiffest: attempt.stiffest,
                    is_limited: friction_limit.changes(&attempt.stiffest),
                });
                report.elapsed = seconds;
                report.error_estimate = Some(attempt.errors.total());
                return Ok(report);
            }
            report.rejected += 1;
            trial.reduce(ROOTS, seconds, error);
            if control.gives_up(&trial, limit) {
                return Err(control.too_short(attempt.errors.largest()));
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

/// Start of a step, whose first stage depends on the step size if friction is limited.
struct Begin<R: Real> {
    start: Start<R>,
    stiffest: Stiffest<R>,
    /// True if the forces of the first stage are those of a limited friction.
    is_limited: bool,
}

impl<R: Real> Begin<R> {
    /// Returns the start of the step, with its first stage from the previous step if that is known.
    fn of<D: Dynamics<R>>(
        scene: &D,
        state: &State<R>,
        workspace: &Workspace<R>,
        report: &mut Step<R>,
    ) -> Result<Self, StepError> {
        let point = Point::of(state);
        if let Some(known) = &workspace.known {
            if known.state == *state {
                return Ok(Self {
                    start: Start::with_stage(point, known.stage, R::ZERO),
                    stiffest: known.stiffest,
                    is_limited: known.is_limited,
                });
            }
        }
        state.check()?;
        report.evaluations += 1;
        let limit = FrictionLimit::none();
        let stage = Stage::at(&LimitedScene::of(scene, &limit), point, ContactRange::NONE);
        Ok(Self {
            start: Start::with_stage(point, stage, R::ZERO),
            stiffest: limit.stiffest(),
            is_limited: false,
        })
    }

    /// Returns the limit of the friction in a step of `seconds`.
    ///
    /// There is one if the stiffest contact has so little friction that the error of a step may
    /// contain all of it. A round rim that spins on the spot has none: its slip is 0 at a point of
    /// the arc that touches, and the friction on both sides of that point brakes the spin.
    fn limit<D: Dynamics<R>>(
        &self,
        settings: &Settings<R>,
        scene: &D,
        seconds: R,
    ) -> FrictionLimit<R> {
        let negligible = settings.tolerance * R::from_f64(1.0 / (HORIZON * SPAN));
        let is_loaded = self.stiffest.acceleration(scene) > negligible;
        if is_loaded || scene.contact_model().has_rims() {
            return FrictionLimit::none();
        }
        FrictionLimit::of(scene, seconds, self.most_touching(scene), STABLE)
    }

    /// Returns an upper bound of the number of contacts that touch at the start. A contact counts
    /// for each surface that it may touch.
    #[inline]
    fn most_touching<D: Dynamics<R>>(&self, scene: &D) -> usize {
        let (model, stage) = (scene.contact_model(), &self.start.stage);
        let of_surface = |surface| {
            let Motion { position, axes, .. } = &stage.motion;
            model
                .range_of_surface(surface, R::ZERO, *position, axes)
                .count
        };
        match model.surfaces() {
            1 => stage.range.count,
            surfaces => (0..surfaces).map(of_surface).sum(),
        }
    }

    /// Evaluates the first stage again, if the friction of a step of `seconds` is another one.
    #[inline]
    fn prepare<D: Dynamics<R>>(
        &mut self,
        limited: &LimitedScene<'_, R, D>,
        seconds: R,
        report: &mut Step<R>,
    ) {
        self.start.seconds = seconds;
        let is_limited = limited.limit().changes(&self.stiffest);
        if is_limited || self.is_limited {
            report.evaluations += 1;
            let (point, near) = (self.start.point, self.start.stage.range);
            self.start = Start::with_stage(point, Stage::at(limited, point, near), seconds);
            self.is_limited = is_limited;
        }
    }
}
