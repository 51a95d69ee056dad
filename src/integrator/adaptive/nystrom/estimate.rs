//! One attempted step, and the estimate of its error.

use super::damping::{Damping, HORIZON};
use super::dip;
use crate::integrator::adaptive::embedded_pair::Settings;
use crate::integrator::adaptive::embedded_pair::control::{self, Errors};
use crate::integrator::explicit::{Purpose, Stage, Start, Taken, taken};
use crate::integrator::free_error;
use crate::integrator::point::Point;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, LimitedScene, Stiffest, size};
use crate::state::State;

/// Error of the velocities as a fraction of the third difference.
///
/// It, [`LAST`] and [`HORIZON`] were chosen on trials 1, 3, 5 and 8 of the coin report with
/// tolerances from 1e-3 to 1e-5 m, for the lowest cost of one tolerance in all of them. The form of
/// the estimate was compared on all eight. `tests/physics/adaptive_nystrom.rs` tests the error.
const FRACTION: f64 = 0.006;
/// Weight of the difference between the end and the last stage, compared with that of the third
/// difference.
const LAST: f64 = 5.0;
/// Error of the direction of the correction of touch-downs, over the correction and the squared
/// angle of the step.
///
/// It, [`ROTATION`] and the limit of friction were compared on all eight trials.
const MISDIRECTED: f64 = 1.0;
/// Error of the correction of touch-downs over its change by the second pass.
///
/// It was chosen among 0.1, 0.3 and 1, on all eight trials and on bounces of a point mass from 400
/// heights on six grounds. `tests/physics/passing_contacts.rs` tests the error on others.
const INEXACT: f64 = 0.3;
/// Error of the angle of a rotation that precesses, over `z³ |Δω| h/2`.
///
/// In torque-free rotation with different moments and axes it is 0.004 as the median and 0.03 at
/// most.
const ROTATION: f64 = 1e-2;
/// Error of the angle of a uniform rotation, over `z⁹`.
const UNIFORM: f64 = 1e-4;
/// Time in which the errors of the steps may add up to the tolerance, s.
pub(super) const SPAN: f64 = 1.0;

/// Attempted step with its error.
pub(super) struct Attempt<R: Real> {
    pub(super) state: State<R>,
    /// First stage of the next step.
    pub(super) end: Stage<R>,
    pub(super) errors: Errors<R>,
    /// Contact with the stiffest friction at the end.
    pub(super) stiffest: Stiffest<R>,
    allowed: R,
}

impl<R: Real> Attempt<R> {
    /// Takes a step from `start` and estimates its error.
    #[inline]
    pub(super) fn of<D: Dynamics<R>>(
        settings: &Settings<R>,
        (scene, limited): (&D, &LimitedScene<'_, R, D>),
        start: &Start<R>,
    ) -> Self {
        let taken = if limited.limit().applies() {
            taken_with_limit(limited, start)
        } else {
            taken(scene, start, Purpose::Estimate)
        };
        let state = taken.end.to_state();
        // The next step begins at the rounded state.
        let point = Point::of(&state);
        let limit = limited.limit();
        let of_stages = limit.removed(scene) * R::from_f64(1.0 / 4.0);
        limit.search();
        let end = Stage::at(limited, point, taken.near);
        let removed = of_stages.at_least(limit.removed(scene));
        let removed = Errors::of_parts(R::ZERO, removed * start.seconds);
        let allowed = allowed(settings, scene, &end, start.seconds);
        let errors =
            errors_of(scene, start, &taken, (&point, &end), allowed).plus(&removed.within(HORIZON));
        Self {
            state,
            end,
            errors,
            stiffest: limit.stiffest(),
            allowed,
        }
    }

    /// Returns the error relative to the allowed error, which may underflow to 0.
    #[inline]
    pub(super) fn relative_error(&self) -> R {
        let error = self.errors.total();
        if error == R::ZERO {
            R::ZERO
        } else {
            error / self.allowed
        }
    }
}

/// Takes a step with limited friction. Few bodies need it, so it is not inlined.
#[inline(never)]
fn taken_with_limit<R: Real, D: Dynamics<R>>(
    limited: &LimitedScene<'_, R, D>,
    start: &Start<R>,
) -> Taken<R> {
    taken(limited, start, Purpose::Estimate)
}

/// Returns the largest allowed error of a step, m.
///
/// It is proportional to the step size, because the errors of the steps add up.
#[inline]
fn allowed<R: Real, D: Dynamics<R>>(
    settings: &Settings<R>,
    scene: &D,
    end: &Stage<R>,
    seconds: R,
) -> R {
    let share = seconds * R::from_f64(1.0 / SPAN);
    settings.tolerance * share + control::rounding(scene, &end.motion, HORIZON)
}

/// Returns the error of a step. Its parts are the forces that the stages have summed (after what
/// friction removes of their error), the correction of touch-downs, contacts that closed and opened
/// again, and the rotation.
#[inline]
fn errors_of<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &Start<R>,
    taken: &Taken<R>,
    (point, end): (&Point<R>, &Stage<R>),
    allowed: R,
) -> Errors<R> {
    let differences = differences(taken, point, end, start.seconds);
    let sum = |[third, last]: &[Point<R>; 2]| {
        let [third, last] = [third, last].map(|part| Errors::of(scene, part, &end.motion));
        (third.plus(&last.scaled(LAST)))
            .within(HORIZON)
            .scaled(FRACTION)
    };
    let mut errors = sum(&differences);
    if errors.total() > allowed {
        let damping = Damping::of(scene, point, end);
        errors = sum(&differences.map(|difference| damping.remaining(&difference)));
    }
    let missed = dip::missed(
        scene,
        [&start.point, point],
        [&start.stage.motion, &end.motion],
        start.seconds,
    );
    let correction = correction_error(scene, start, taken, (point, end));
    let turned = rotation_error(scene, start, end) * counted(scene, start, (point, end));
    errors.plus(&Errors::of_parts(turned, missed + correction).within(HORIZON))
}

/// Returns the error of the correction of touch-downs, as a velocity of the farthest point, m/s.
///
/// - *Direction.* The correction takes arm and force of a contact as linear functions of time. Both
///   rotate with the body by the angle `φ = ω h`, so the relative error is proportional to `φ²`.
/// - *Path.* The path of a contact leads to the end that the first pass has corrected, not to that
///   of the second. Where a step ends soon after a touch-down, a large part of the impulse depends
///   on it.
#[inline]
fn correction_error<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &Start<R>,
    taken: &Taken<R>,
    (point, end): (&Point<R>, &Stage<R>),
) -> R {
    let [whole, changed] = [taken.correction, taken.correction_change].map(|rates| {
        let difference = change(point, rates, start.seconds);
        Errors::of(scene, &difference, &end.motion).total()
    });
    let angle = start.stage.motion.angular_velocity.length() * start.seconds;
    whole * (angle * angle * R::from_f64(MISDIRECTED)) + changed * R::from_f64(INEXACT)
}

/// Returns the error of the rotation without forces, as a displacement of the farthest point, m.
///
/// The error of a uniform rotation at `ω` is left out of the step, up to a part that is
/// proportional to `z⁹` with `z = |ω| h/2`. In a rotation that precesses the terms of `h⁵` contain
/// the change `Δω`, so the error of the angle is proportional to `z³ |Δω| h`.
#[inline]
fn rotation_error<R: Real, D: Dynamics<R>>(scene: &D, start: &Start<R>, end: &Stage<R>) -> R {
    let half = start.seconds * R::HALF;
    let [first, last] = [&start.stage, end].map(|stage| stage.motion.angular_velocity);
    let angle = first.length().at_least(last.length()) * half;
    let change = (last - first).length() * half;
    let cube = angle * angle * angle;
    let uniform = cube * cube * cube * R::from_f64(UNIFORM);
    size(scene) * (cube * change * R::from_f64(ROTATION) + uniform)
}

/// Returns the fraction of the error of the rotation that counts. A step in flight leaves it out.
/// Where a contact may come into reach, it counts for the poses of the stages.
#[inline]
fn counted<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &Start<R>,
    (point, end): (&Point<R>, &Stage<R>),
) -> R {
    let momenta = [start.point, *point].map(|point| point.angular_momentum);
    let weight = free_error::weight(scene, momenta);
    // False for a body without angular momentum, too.
    let is_nearly_free = weight > R::ZERO;
    if !is_nearly_free {
        return R::ONE;
    }
    let ends = [&start.stage, end];
    let [first, last] = ends.map(|stage| stage.acceleration.length());
    let is_out_of_reach = free_error::is_out_of_reach(
        scene,
        ends.map(|stage| &stage.motion),
        (start.point.angular_momentum, first.at_least(last)),
        start.seconds,
    );
    if is_out_of_reach {
        R::ONE - weight
    } else {
        R::ONE
    }
}

/// Returns two differences of velocity and angular momentum: the third difference, and the
/// difference between the end of the step and its last stage.
#[inline]
fn differences<R: Real>(
    taken: &Taken<R>,
    point: &Point<R>,
    end: &Stage<R>,
    seconds: R,
) -> [Point<R>; 2] {
    let [acceleration, torque] = taken.last;
    let last = [end.acceleration - acceleration, end.torque - torque];
    [taken.third_difference, last].map(|rates| change(point, rates, seconds))
}

/// Returns the change of velocity and angular momentum by an acceleration and a torque, without a
/// change of the pose.
#[inline]
fn change<R: Real>(point: &Point<R>, [acceleration, torque]: [R::Vec3; 2], seconds: R) -> Point<R> {
    Point {
        linear_velocity: acceleration * seconds,
        angular_momentum: torque * seconds,
        ..point.plus(point, -R::ONE)
    }
}
