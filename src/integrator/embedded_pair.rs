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

mod control;
mod slip;
mod touch;

use super::fingerprint::Fingerprint;
use super::rk4::Point;
use super::{Step, StepControl};
use crate::contact::{Load, Motion};
use crate::error::{self, Quantity, Rule, SceneError, StepError};
use crate::friction::{RollingResistance, SlidingFriction};
use crate::ground::SpringDamperGround;
use crate::real::{Real, Vector};
use crate::rotation::Rotation;
use crate::scene::Dynamics;
use crate::state::State;
use control::{Control, Errors};

/// Coefficients of a pair whose last stage is the first stage of the next step.
pub(crate) struct Pair<const STAGES: usize> {
    /// Row i holds the weights of the slopes 0 to i for the point of slope i + 1. The last row but
    /// one gives the result, and the last row is unused.
    pub(crate) stages: [[f64; STAGES]; STAGES],
    /// Weights of the slopes in the estimate: those of the result minus those of the lower order.
    pub(crate) error: [f64; STAGES],
    /// Fraction of the estimated velocity error that counts.
    ///
    /// The result has a higher order than the estimate and a smaller error, and contacts remove a
    /// part of that error.
    pub(super) trust: f64,
    /// Number of square roots that the controller takes of the error.
    ///
    /// The 2^roots-th root is the next below the order of the estimate in the step size.
    pub(super) roots: u32,
}

impl<const STAGES: usize> Pair<STAGES> {
    /// Returns the weights of the slopes in the result.
    fn weights(&self) -> &[f64] {
        self.stages.iter().rev().nth(1).map_or(&[], |row| row)
    }
}

/// Parameters set by the user.
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

    /// Returns the size below which a step is given up, s: the rounding of the longest step.
    fn shortest_step(&self) -> R {
        self.longest_step * R::EPSILON
    }
}

/// Workspace of an adaptive Runge-Kutta method: proposed step size, last error and used budget.
///
/// It also keeps the last slope, which saves an evaluation. A new workspace chooses the first step
/// from the state alone. To continue after a pause with the same results, keep the workspace with
/// the state. It is plain data.
///
/// The slope is used only for the same state in an equivalent scene. Equivalent scenes have equal
/// mass, moments, bounding radius, gravity and surface. Their bodies have equal numbers of contacts
/// and of rim points. Their laws have equal values at one penetration depth and slip.
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
    pub(super) fn step_control(&self, state: &State<R>) -> StepControl<R> {
        let known = self.known.as_ref().filter(|known| known.state == *state);
        let orientation = known.map(|known| known.place.point.orientation);
        StepControl {
            orientation: orientation.or(self.resumed).map(Rotation::to_quat),
            ..self.control.carried()
        }
    }

    /// Restores the choice of the next step, with a full budget.
    #[inline]
    pub(super) fn set_step_control(&mut self, control: StepControl<R>) {
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
    answers: Answers<R>,
}

impl<R: Real> Known<R> {
    /// Creates the data for the end of a step.
    ///
    /// A step to a discontinuity has left out the contacts that begin to push there, so its slope
    /// is evaluated again.
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

/// Point, slope and motion at one end of a step.
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

/// Numbers that distinguish the slopes of one scene from those of another.
///
/// The numbers are the fingerprint of the energies, and the values of damper and friction at one
/// penetration depth and slip.
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

/// Takes one step with an error below the tolerance, of at most `limit` seconds.
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
            // The proposed step size has underflowed.
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

/// Returns the start of the step: known from the previous step, or evaluated.
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

/// An attempted step of the higher order.
struct Attempt<R: Real, const STAGES: usize> {
    end: Place<R>,
    /// Motions at which the forces of the stages were evaluated.
    motions: [Motion<R>; STAGES],
    /// Difference between the results of the higher and the lower order.
    difference: Point<R>,
}

/// Attempts a step. A step to a discontinuity leaves out the contacts that begin to push at its
/// end.
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
