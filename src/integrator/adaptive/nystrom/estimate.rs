//! One attempted step, and the estimate of its error.

use super::damping::{Damping, HORIZON};
use super::dip;
use crate::integrator::adaptive::embedded_pair::Settings;
use crate::integrator::adaptive::embedded_pair::control::{self, Errors};
use crate::integrator::explicit::{Stage, Start, Taken, taken};
use crate::integrator::point::Point;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, size};
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
/// Error of the angle over `(ω h/2)⁵`. The factor of 5 in comparison with a uniform rotation
/// allows for one that precesses.
const ROTATION: f64 = 1e-3;
/// Time in which the errors of the steps may add up to the tolerance, s.
const SPAN: f64 = 1.0;

/// Attempted step with its error.
pub(super) struct Attempt<R: Real> {
    pub(super) state: State<R>,
    /// First stage of the next step.
    pub(super) end: Stage<R>,
    pub(super) errors: Errors<R>,
    allowed: R,
}

impl<R: Real> Attempt<R> {
    /// Takes a step from `start` and estimates its error.
    #[inline]
    pub(super) fn of<D: Dynamics<R>>(settings: &Settings<R>, scene: &D, start: &Start<R>) -> Self {
        let taken = taken::<_, _, true>(scene, start);
        let state = taken.end.to_state();
        // The next step begins at the rounded state.
        let point = Point::of(&state);
        let end = Stage::at(scene, point, taken.near);
        let allowed = allowed(settings, scene, &end, start.seconds);
        let errors = errors_of(scene, start, &taken, (&point, &end), allowed);
        Self {
            state,
            end,
            errors,
            allowed,
        }
    }

    /// Returns the error relative to the allowed error.
    #[inline]
    pub(super) fn relative_error(&self) -> R {
        self.errors.total() / self.allowed
    }
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
    settings.tolerance * share + control::rounding(scene, &end.motion)
}

/// Returns the error of a step: of the forces that the stages have summed, after what friction
/// removes of it, and of contacts that closed and opened again, and of
/// the rotation.
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
    let missed = dip::missed(scene, [&start.stage.motion, &end.motion], start.seconds);
    let turned = rotation_error(scene, start, end);
    errors.plus(&Errors::of_parts(turned, missed).within(HORIZON))
}

/// Returns the error of the rotation without forces, as a displacement of the farthest point, m.
///
/// The quaternion of a body that rotates at `ω` oscillates with `ω/2`. The relative phase error is
/// `1e-4 (ω h/2)⁴` (see [`Nystrom`](crate::Nystrom)), and the error of the angle in a step
/// `2e-4 (ω h/2)⁵`.
#[inline]
fn rotation_error<R: Real, D: Dynamics<R>>(scene: &D, start: &Start<R>, end: &Stage<R>) -> R {
    let rates = [&start.stage, end].map(|stage| stage.motion.angular_velocity.length());
    let angle = rates[0].at_least(rates[1]) * (start.seconds * R::HALF);
    let square = angle * angle;
    size(scene) * (square * square * angle) * R::from_f64(ROTATION)
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
    let zero = point.plus(point, -R::ONE);
    [taken.third_difference, last].map(|[acceleration, torque]| Point {
        linear_velocity: acceleration * seconds,
        angular_momentum: torque * seconds,
        ..zero
    })
}
