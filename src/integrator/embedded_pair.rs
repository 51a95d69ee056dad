//! Runge-Kutta pairs that choose their steps: attempt, estimate, control. The pairs' files hold
//! their coefficients.
//!
//! The stages of a step:
//!
//! 1. `attempt`: a step of the proposed length, or to the limit; the pair's difference is an
//!    estimate of its error;
//! 2. `touch` and `slip`: contacts that begin or cease to push in it, or whose friction turns
//!    round, whose kink no such estimate sees for sure, with a bound of what they spoil;
//! 3. `control`: both below the tolerance: done. Else again, to the first kink that matters, or
//!    shorter.

mod control;
mod slip;
mod touch;

use super::fingerprint::Fingerprint;
use super::rk4::Point;
use super::{Step, StepControl};
use crate::error::{self, Quantity, Rule, SceneError, StepError};
use crate::friction::{RollingResistance, SlidingFriction};
use crate::ground::SpringDamperGround;
use crate::real::{Real, Vector};
use crate::rotation::Rotation;
use crate::scene::{Dynamics, Load, Motion};
use crate::state::State;
use control::{Control, Errors};

/// Coefficients of a pair whose last stage is the first of the next step.
pub(crate) struct Pair<const STAGES: usize> {
    /// Row i weighs the slopes 0 to i for the place of slope i + 1; the last but one gives the
    /// result, the last is idle.
    pub(crate) stages: [[f64; STAGES]; STAGES],
    /// Weights of the slopes in the estimate: those of the result less those of the lower order.
    pub(crate) error: [f64; STAGES],
    /// What counts of an estimated error of the velocities: how much larger it is than what the
    /// result, of a higher order, errs and contacts leave of that.
    pub(super) trust: f64,
    /// The controller works with the 2^roots-th root of the error: next below the estimate's order
    /// in the step.
    pub(super) roots: u32,
}

impl<const STAGES: usize> Pair<STAGES> {
    /// Weights of the slopes in the result.
    fn weights(&self) -> &[f64] {
        self.stages.iter().rev().nth(1).map_or(&[], |row| row)
    }
}

/// The user's choices.
pub(super) struct Settings<R> {
    pub(super) tolerance: R,
    pub(super) longest_step: R,
    pub(super) budget: u32,
}

impl<R: Real> Settings<R> {
    pub(super) fn check(&self) -> Result<(), SceneError> {
        error::above_zero("tolerance", self.tolerance, " m")?;
        error::above_zero("longest step", self.longest_step, " s")?;
        if self.budget == 0 {
            return Err(SceneError::new(
                "budget of steps",
                Rule::AtLeast(1),
                0.0,
                "",
            ));
        }
        Ok(())
    }

    /// A step below this is given up: it is rounding beside the longest one.
    fn shortest_step(&self) -> R {
        self.longest_step * R::EPSILON
    }
}

/// What a method that chooses its steps carries from one to the next: the length that it proposes,
/// the last error, and how much of the budget is spent. It also keeps the last slope, which saves
/// work.
///
/// A new one chooses the first step from the state alone. To go on after a pause as if there had
/// been none, keep it with the state: it is plain data. Its slope counts only for the same state in
/// a scene that answers alike (mass, moments, reach, number of contacts and of the rim's points,
/// gravity, surface, and the laws at one depth and slip).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Workspace<R: Real = f64> {
    control: Control<R>,
    known: Option<Known<R>>,
    /// The orientation that a step begins with whose start is not known.
    resumed: Option<Rotation<R>>,
}

impl<R: Real> Workspace<R> {
    /// What the next step depends on, beside the state.
    #[inline]
    pub(super) fn step_control(&self, state: &State<R>) -> StepControl<R> {
        let known = self.known.as_ref().filter(|known| known.state == *state);
        let orientation = known.map(|known| known.place.point.orientation);
        StepControl {
            orientation: orientation.or(self.resumed).map(Rotation::to_quat),
            ..self.control.carried()
        }
    }

    /// Goes on with this choice of the next step, and with the whole budget.
    #[inline]
    pub(super) fn set_step_control(&mut self, control: StepControl<R>) {
        self.resumed = control.orientation.map(Rotation::unscaled);
        self.control = Control::carrying(control);
    }

    /// The point to begin with at a state. Scaled to length 1 again, an orientation is not always
    /// the one that the step before has ended with.
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

/// A state, and what has been computed there.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Known<R: Real> {
    state: State<R>,
    place: Place<R>,
    answers: Answers<R>,
}

impl<R: Real> Known<R> {
    /// Of the end of a step. One to a kink has left out what begins to push there: its slope is
    /// evaluated anew.
    #[inline(always)]
    fn of<D: Dynamics<R>>(scene: &D, state: &State<R>, end: &Place<R>, to_kink: bool) -> Self {
        let place = if to_kink {
            Place::at(scene, end.point)
        } else {
            *end
        };
        Self {
            state: *state,
            place,
            answers: Answers::of(scene, state),
        }
    }
}

/// Either end of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place<R: Real> {
    point: Point<R>,
    slope: Point<R>,
    motion: Motion<R>,
}

impl<R: Real> Place<R> {
    #[inline(always)]
    fn at<D: Dynamics<R>>(scene: &D, point: Point<R>) -> Self {
        Self::under(scene, point, |motion| scene.load(motion))
    }

    #[inline(always)]
    fn under<D: Dynamics<R>>(
        scene: &D,
        point: Point<R>,
        load: impl FnOnce(&Motion<R>) -> Load<R>,
    ) -> Self {
        let motion = point.motion(scene);
        Self {
            point,
            slope: point.slope_under(scene, &motion, &load(&motion)),
            motion,
        }
    }
}

/// What tells the slopes of one scene from another's: what tells the energies, and the answers of
/// damper and friction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Answers<R: Real> {
    fingerprint: Fingerprint<R>,
    normal_force: R,
    friction: R::Vec3,
    turning: Option<RollingResistance<R>>,
}

impl<R: Real> Answers<R> {
    #[inline]
    fn of<D: Dynamics<R>>(scene: &D, state: &State<R>) -> Self {
        let friction = scene.friction();
        Self {
            fingerprint: Fingerprint::of(scene, state),
            normal_force: scene
                .probe(|| scene.ground().normal_force(scene.bounding_radius(), R::ONE)),
            friction: scene
                .probe(|| friction.force(R::ONE, R::Vec3::new(R::ONE, R::ZERO, R::ZERO))),
            turning: scene.probe(|| friction.rolling_resistance(R::ONE)),
        }
    }
}

/// One step that is below the tolerance, at most `limit` seconds long.
pub(super) fn step<R: Real, D: Dynamics<R>, const STAGES: usize>(
    pair: &Pair<STAGES>,
    settings: &Settings<R>,
    scene: &D,
    state: &mut State<R>,
    limit: R,
    workspace: &mut Workspace<R>,
) -> Result<Step<R>, StepError> {
    if limit <= R::ZERO {
        return Ok(Step::new(R::ZERO, 0));
    }
    let mut report = Step::new(R::ZERO, 0);
    let start = start_of(scene, state, workspace, &mut report)?;
    let control = &mut workspace.control;
    let mut trial = control.first_trial(|| {
        report.evaluations += 1;
        control::first_length(pair.roots, settings, scene, &start)
    });
    trial.length = trial.length.at_most(settings.longest_step);
    loop {
        control.spend(settings)?;
        let seconds = trial.seconds(limit);
        if seconds <= R::ZERO {
            // A proposal that has underflowed.
            return Err(control.too_short(settings, Quantity::Position));
        }
        let to_kink = trial.is_to_kink(seconds);
        let attempt = attempt(pair, scene, &start, seconds, to_kink);
        report.evaluations += u32::try_from(STAGES).unwrap_or(u32::MAX) - 1;
        let end = &attempt.end;
        let mut errors = Errors::of(scene, &attempt.difference, &end.motion).within(pair.trust);
        let allowed = control::allowed(settings, scene, &end.motion);
        let bounds = [errors.total(), allowed];
        let kinks = touch::kinks(pair, scene, &start, &attempt, seconds, to_kink, bounds);
        errors.add_kinks(&kinks);
        let error = errors.total() / allowed;
        if errors.total() <= allowed {
            control.accept(pair.roots, &trial, seconds, error);
            *state = end.point.to_state();
            report.elapsed = seconds;
            report.evaluations += u32::from(to_kink);
            workspace.known = Some(Known::of(scene, state, end, to_kink));
            workspace.resumed = None;
            return Ok(report);
        }
        report.rejected += 1;
        trial.shorten(pair.roots, seconds, error, &kinks);
        if trial.seconds(limit) < settings.shortest_step() {
            return Err(control.too_short(settings, errors.largest()));
        }
    }
}

/// Where the step begins: known from the last one, or evaluated.
#[inline]
fn start_of<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &State<R>,
    workspace: &Workspace<R>,
    report: &mut Step<R>,
) -> Result<Place<R>, StepError> {
    if let Some(known) = &workspace.known {
        if known.state == *state && known.answers == Answers::of(scene, state) {
            return Ok(known.place);
        }
    }
    if let Some(quantity) = state.not_finite() {
        return Err(StepError::BadState(quantity));
    }
    if !state.rotation().is_a_turn() {
        return Err(StepError::BadState(Quantity::Orientation));
    }
    report.evaluations += 1;
    Ok(Place::at(scene, workspace.point(state)))
}

/// A step of the higher order.
struct Attempt<R: Real, const STAGES: usize> {
    end: Place<R>,
    /// What the forces of each stage were computed from.
    motions: [Motion<R>; STAGES],
    /// To a step of the lower order.
    difference: Point<R>,
}

/// One attempt, which leaves out what begins to push at its end where it goes to a kink.
#[inline(always)]
fn attempt<R: Real, D: Dynamics<R>, const STAGES: usize>(
    pair: &Pair<STAGES>,
    scene: &D,
    start: &Place<R>,
    seconds: R,
    to_kink: bool,
) -> Attempt<R, STAGES> {
    if to_kink {
        attempt_under(pair, scene, start, seconds, |motion| {
            touch::load_before(scene, &start.motion, motion, seconds)
        })
    } else {
        attempt_under(pair, scene, start, seconds, |motion| scene.load(motion))
    }
}

#[inline(always)]
fn attempt_under<R: Real, D: Dynamics<R>, const STAGES: usize>(
    pair: &Pair<STAGES>,
    scene: &D,
    start: &Place<R>,
    seconds: R,
    load: impl Fn(&Motion<R>) -> Load<R>,
) -> Attempt<R, STAGES> {
    let mut slopes = [start.slope; STAGES];
    let mut motions = [start.motion; STAGES];
    let mut end = *start;
    for (i, row) in pair.stages.iter().enumerate().take(STAGES - 1) {
        let mut point = start.point;
        for (slope, &weight) in slopes.iter().zip(row).take(i + 1) {
            point = point.plus(slope, seconds * R::from_f64(weight));
        }
        if i + 2 == STAGES {
            point = point.normalised();
        }
        end = Place::under(scene, point, &load);
        if let (Some(slope), Some(motion)) = (slopes.get_mut(i + 1), motions.get_mut(i + 1)) {
            *slope = end.slope;
            *motion = end.motion;
        }
    }
    let mut difference = start.slope.plus(&start.slope, -R::ONE);
    for (slope, &weight) in slopes.iter().zip(&pair.error) {
        difference = difference.plus(slope, seconds * R::from_f64(weight));
    }
    Attempt {
        end,
        motions,
        difference,
    }
}
