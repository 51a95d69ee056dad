//! The last word on a step: the computed energy is not above the one before, or the step does not happen.

use crate::energy::Energy;
use crate::integrator::Step;
use crate::real::Real;
use crate::scene::Dynamics;
use crate::state::State;

/// The end of a step with its velocities scaled down until its computed energy is at most `before`; `None` where that cannot be had.
///
/// The solver's residual is all that can lift the energy, so that the factor is 1 to rounding; what was removed is in the step's report. A body whose kinetic
/// energy is below the rounding of its total cannot be scaled. In contact it has come to rest, and stops where it was; in flight it keeps its old velocity.
pub(super) fn hold<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &State<R>,
    before: Energy<R>,
    end: State<R>,
    after: Energy<R>,
    touching: usize,
    step: &mut Step<R>,
) -> Option<(State<R>, Energy<R>)> {
    let ceiling = before.total();
    let excess = after.total() - ceiling;
    if excess <= R::ZERO {
        return Some((end, after));
    }
    if !excess.is_finite() {
        return None;
    }
    let mut share = excess;
    loop {
        let kinetic = after.translation + after.rotation;
        // Also where a number is not one.
        if share >= kinetic {
            break;
        }
        let slowed = slower(&end, (R::ONE - share / kinetic).sqrt());
        let energy = Energy::of(scene, &slowed);
        if energy.total() <= ceiling {
            step.ratcheted += excess;
            return Some((slowed, energy));
        }
        share *= R::TWO;
    }
    let terms = after.translation.abs()
        + after.rotation.abs()
        + after.gravity.abs()
        + after.springs.abs()
        + before.gravity.abs()
        + before.springs.abs();
    if excess > terms * (R::EPSILON * R::from_f64(64.0)) {
        return None;
    }
    let candidate = if touching > 0 {
        slower(start, R::ZERO)
    } else {
        State {
            linear_velocity: start.linear_velocity,
            angular_momentum: start.angular_momentum,
            ..end
        }
    };
    let energy = Energy::of(scene, &candidate);
    if energy.total() <= ceiling {
        Some((candidate, energy))
    } else {
        Some((*start, before))
    }
}

/// The same place with both velocities scaled.
fn slower<R: Real>(state: &State<R>, factor: R) -> State<R> {
    State {
        linear_velocity: state.linear_velocity * factor,
        angular_momentum: state.angular_momentum * factor,
        ..*state
    }
}
