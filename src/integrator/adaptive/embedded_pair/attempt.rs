//! A pair of Runge-Kutta methods, and one attempted step by it.

use super::late;
use crate::contact::{Load, Motion};
use crate::error::{self, Rule, SceneError};
use crate::integrator::free_error::{self, NearlyFree};
use crate::integrator::interface::Step;
use crate::integrator::point::Point;
use crate::real::{Real, Vector};
use crate::rotation::Rotation;
use crate::scene::{Dynamics, TorqueFree};

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
    pub(crate) trust: f64,
    /// Number of square roots that the controller takes of the error.
    ///
    /// The 2^roots-th root is the next below the order of the estimate in the step size.
    pub(crate) roots: u32,
    /// Whether the error of a friction that reverses within a step is added. A method that solves
    /// for the friction of its stages needs no such bound, and in stick none is known.
    pub(crate) follows_slip: bool,
}

/// A formula for steps with an estimate of their error.
pub(crate) trait Formula<R: Real, const STAGES: usize> {
    /// Weights of the stages in the result, and the parameters of step size control.
    fn pair(&self) -> &Pair<STAGES>;

    /// Attempts a step with the loads of [`Planned`]. Adds the work to `report`. Returns `None` if
    /// the equations of an implicit formula have no solution that is found.
    fn attempt<D: Dynamics<R>>(
        &self,
        settings: &Settings<R>,
        planned: &Planned<'_, R, D>,
        report: &mut Step<R>,
    ) -> Option<Attempt<R, STAGES>>;
}

/// A step to attempt: its start and its size.
pub(in crate::integrator::adaptive) struct Planned<'a, R: Real, D> {
    pub(in crate::integrator::adaptive) scene: &'a D,
    pub(in crate::integrator::adaptive) start: &'a Place<R>,
    /// Step size, s.
    pub(in crate::integrator::adaptive) seconds: R,
    /// True if the step ends just beyond a discontinuity of a force.
    pub(in crate::integrator::adaptive) to_discontinuity: bool,
}

impl<R: Real, D: Dynamics<R>> Planned<'_, R, D> {
    /// Returns the load of a stage.
    #[inline(never)]
    pub(in crate::integrator::adaptive) fn load(&self, motion: &Motion<R>) -> Load<R> {
        if self.to_discontinuity {
            self.load_before(motion)
        } else {
            self.load_of_all(motion)
        }
    }

    #[inline(always)]
    fn load_of_all(&self, motion: &Motion<R>) -> Load<R> {
        self.scene.contact_model().load(motion)
    }

    /// Leaves out the contacts that begin to push at the end of the step.
    #[inline(always)]
    fn load_before(&self, motion: &Motion<R>) -> Load<R> {
        late::load_before(self.scene, &self.start.motion, motion, self.seconds)
    }
}

impl<R: Real, const STAGES: usize> Formula<R, STAGES> for Pair<STAGES> {
    fn pair(&self) -> &Self {
        self
    }

    #[inline(always)]
    fn attempt<D: Dynamics<R>>(
        &self,
        _: &Settings<R>,
        planned: &Planned<'_, R, D>,
        report: &mut Step<R>,
    ) -> Option<Attempt<R, STAGES>> {
        report.evaluations += u32::try_from(STAGES).unwrap_or(u32::MAX) - 1;
        // Compiled for each kind of load, because the stages of an explicit step cost little more
        // than their loads.
        if planned.to_discontinuity {
            attempt_under(self, planned, |motion| planned.load_before(motion))
        } else {
            attempt_under(self, planned, |motion| planned.load_of_all(motion))
        }
    }
}

impl<const STAGES: usize> Pair<STAGES> {
    /// Returns the weights of the slopes in the result.
    pub(super) fn weights(&self) -> &[f64] {
        self.stages.iter().rev().nth(1).map_or(&[], |row| row)
    }
}

/// Parameters set by the user.
pub(crate) struct Settings<R> {
    pub(crate) tolerance: R,
    pub(crate) longest_step: R,
    pub(crate) budget: u32,
}

impl<R: Real> Settings<R> {
    pub(crate) fn check(&self) -> Result<(), SceneError> {
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
}

/// Point, slope and motion at one end of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::integrator::adaptive) struct Place<R: Real> {
    pub(in crate::integrator::adaptive) point: Point<R>,
    pub(in crate::integrator::adaptive) slope: Point<R>,
    pub(in crate::integrator::adaptive) motion: Motion<R>,
}

impl<R: Real> Place<R> {
    #[inline(always)]
    pub(in crate::integrator::adaptive) fn at<D: Dynamics<R>>(scene: &D, point: Point<R>) -> Self {
        Self::under(scene, point, |motion| scene.contact_model().load(motion))
    }

    #[inline(always)]
    pub(in crate::integrator::adaptive) fn under<D: Dynamics<R>>(
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

/// An attempted step of the higher order.
pub(in crate::integrator::adaptive) struct Attempt<R: Real, const STAGES: usize> {
    pub(in crate::integrator::adaptive) end: Place<R>,
    /// Motions at which the forces of the stages were evaluated.
    pub(in crate::integrator::adaptive) motions: [Motion<R>; STAGES],
    /// Difference between the results of the higher and the lower order.
    pub(in crate::integrator::adaptive) difference: Point<R>,
    /// The part of the difference that the end of the step leaves out.
    pub(in crate::integrator::adaptive) left_out: LeftOut<R>,
}

impl<R: Real, const STAGES: usize> Attempt<R, STAGES> {
    /// Returns the difference that the estimate counts.
    ///
    /// Without the part that is left out, steps in flight are long, and the poses of their stages
    /// are inexact. So that part counts where a contact may come into reach.
    #[inline(always)]
    pub(super) fn counted<D: Dynamics<R>>(&self, planned: &Planned<'_, R, D>) -> Point<R> {
        if self.left_out.is_nothing() || !self.is_out_of_reach(planned) {
            return self.difference;
        }
        Point {
            orientation: self.left_out.of(self.difference.orientation),
            ..self.difference
        }
    }

    /// Returns true if no contact can come into reach in this step, which is nearly free.
    #[inline(never)]
    pub(in crate::integrator::adaptive) fn is_out_of_reach<D: Dynamics<R>>(
        &self,
        planned: &Planned<'_, R, D>,
    ) -> bool {
        let Planned { scene, start, .. } = *planned;
        let ends = [start, &self.end];
        let [first, last] = ends.map(|place| place.slope.linear_velocity.length());
        free_error::is_out_of_reach(
            scene,
            ends.map(|place| &place.motion),
            (start.point.angular_momentum, first.at_least(last)),
            planned.seconds,
        )
    }
}

/// Part of the difference of the orientations that is an error in torque-free rotation. See
/// `free_error`.
#[derive(Clone, Copy)]
pub(in crate::integrator::adaptive) enum LeftOut<R: Real> {
    Nothing,
    /// `w d_f`.
    Part(Rotation<R>),
    /// All of it: the step is exact.
    Whole,
}

impl<R: Real> LeftOut<R> {
    /// Returns true if the end of the step is that of the method.
    fn is_nothing(&self) -> bool {
        matches!(self, Self::Nothing)
    }

    /// Returns the difference of two orientations without this part.
    fn of(&self, difference: Rotation<R>) -> Rotation<R> {
        match *self {
            Self::Nothing => difference,
            Self::Part(part) => difference.plus(part, -R::ONE),
            Self::Whole => Point::zero().orientation,
        }
    }
}

#[inline(never)]
fn attempt_under<R: Real, D: Dynamics<R>, const STAGES: usize>(
    pair: &Pair<STAGES>,
    planned: &Planned<'_, R, D>,
    load: impl Fn(&Motion<R>) -> Load<R>,
) -> Option<Attempt<R, STAGES>> {
    let Planned {
        scene,
        start,
        seconds,
        ..
    } = *planned;
    let mut slopes = [start.slope; STAGES];
    let mut motions = [start.motion; STAGES];
    let (mut end, mut left_out) = (*start, LeftOut::Nothing);
    for (i, row) in pair.stages.iter().enumerate().take(STAGES - 1) {
        let mut point = sum(&start.point, &slopes, row, i + 1, seconds);
        if i + 2 == STAGES {
            // A copy, because a reference would keep the point in memory.
            (point.orientation, left_out) =
                without_free_error(pair, scene, &start.point, &{ point }, seconds);
            point = point.normalised();
        }
        end = Place::under(scene, point, &load);
        if let (Some(slope), Some(motion)) = (slopes.get_mut(i + 1), motions.get_mut(i + 1)) {
            *slope = end.slope;
            *motion = end.motion;
        }
    }
    Some(Attempt {
        end,
        motions,
        difference: difference(&slopes, pair, seconds),
        left_out,
    })
}

/// Returns the difference between the results of the two orders.
#[inline(always)]
fn difference<R: Real, const STAGES: usize>(
    slopes: &[Point<R>; STAGES],
    pair: &Pair<STAGES>,
    seconds: R,
) -> Point<R> {
    let mut difference = Point::zero();
    for (slope, &weight) in slopes.iter().zip(&pair.error) {
        difference = difference.plus(slope, seconds * R::from_f64(weight));
    }
    difference
}

/// Returns the orientation at the end of a step without the error in torque-free rotation, and the
/// part of the difference that this leaves out.
#[inline(never)]
fn without_free_error<R: Real, D: Dynamics<R>, const STAGES: usize>(
    pair: &Pair<STAGES>,
    scene: &D,
    start: &Point<R>,
    end: &Point<R>,
    seconds: R,
) -> (Rotation<R>, LeftOut<R>) {
    let Some(free) = NearlyFree::of(scene, start, end, seconds) else {
        return (end.orientation, LeftOut::Nothing);
    };
    if free.is_free() {
        return (free.exact, LeftOut::Whole);
    }
    let [free_end, difference] =
        without_torques(pair, &TorqueFree(scene), start, free.exact, seconds);
    let left_out = LeftOut::Part(difference.scaled(free.weight));
    (free.corrected(end.orientation, free_end), left_out)
}

/// Returns a point plus the weighted sum of the first `count` slopes.
#[inline(always)]
fn sum<R: Real, const STAGES: usize>(
    start: &Point<R>,
    slopes: &[Point<R>; STAGES],
    weights: &[f64; STAGES],
    count: usize,
    seconds: R,
) -> Point<R> {
    let mut point = *start;
    for (slope, &weight) in slopes.iter().zip(weights).take(count) {
        point = point.plus(slope, seconds * R::from_f64(weight));
    }
    point
}

/// Returns the orientation at the end of a step in a scene without torques, and the difference of
/// the orientations by the two orders. The last slope is that of the `exact` end, as in a corrected
/// step.
fn without_torques<R: Real, D: Dynamics<R>, const STAGES: usize>(
    pair: &Pair<STAGES>,
    scene: &D,
    start: &Point<R>,
    exact: Rotation<R>,
    seconds: R,
) -> [Rotation<R>; 2] {
    let mut slopes = [start.slope(scene); STAGES];
    let mut end = start.orientation;
    for (i, row) in pair.stages.iter().enumerate().take(STAGES - 1) {
        let mut point = sum(start, &slopes, row, i + 1, seconds);
        if i + 2 == STAGES {
            end = point.orientation;
            point.orientation = exact;
        }
        if let Some(slope) = slopes.get_mut(i + 1) {
            *slope = point.slope(scene);
        }
    }
    [end, difference(&slopes, pair, seconds).orientation]
}
