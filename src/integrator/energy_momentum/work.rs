//! Work of a ground that moves.
//!
//! A contact force F at the position x does the work `F · (s + u)` per second, with the slip s
//! relative to the ground's material and the velocity u of the material. The first part is never
//! positive. The second is the work of the ground. With `u = V + Ω × x`, the sum over all contacts
//! needs only the momentum p and the angular momentum L about the centre of mass that they have
//! given to a body at the position x:
//!
//! ```text
//! W = p · (V + Ω × x) + L · Ω
//! ```
//! So it follows from the states before and after a stage, whatever the stage has done in between.
//! Normal forces give no work to this sum, because the material moves along the surface.

use super::problem::Problem;
use crate::ground::SpringDamperGround;
use crate::real::Real;
use crate::scene::Dynamics;
use crate::state::State;

/// Work of the ground in the whole step of a problem, J, to the end of its trial and after its
/// velocities are corrected.
#[inline]
pub(super) fn of_whole<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    [end, corrected]: [&State<R>; 2],
) -> R {
    if problem.scene.ground().motion().is_none() {
        return R::ZERO;
    }
    let half = problem.seconds * R::HALF;
    let middle = problem.motion.position + problem.motion.linear_velocity * half;
    let fallen = State {
        linear_velocity: problem.start.linear_velocity + problem.scene.gravity() * problem.seconds,
        // An angular momentum about an axis without inertia is lost, and not to the ground.
        angular_momentum: problem.angular_momentum,
        ..problem.start
    };
    of_impulse(problem.scene, middle, [&fallen, end])
        + of_impulse(problem.scene, end.position, [end, corrected])
}

/// Work of the ground on a body that contacts have given other velocities at a position (m), J.
#[inline]
pub(super) fn of_impulse<R: Real, D: Dynamics<R>>(
    scene: &D,
    position: R::Vec3,
    [before, after]: [&State<R>; 2],
) -> R {
    match scene.ground().motion() {
        Some(ground) => {
            let mass = scene.inertia_properties().mass();
            let momentum = (after.linear_velocity - before.linear_velocity) * mass;
            let turning = after.angular_momentum - before.angular_momentum;
            ground.power(position, [momentum, turning])
        }
        None => R::ZERO,
    }
}
