//! The error of a Runge-Kutta method in torque-free rotation, which its steps leave out.
//!
//! A step that adds quaternions has two errors: that of the torques, and that which it would have
//! without any torque. For three different moments the second is the larger one in flight, and next
//! to the middle axis the motion amplifies it. It is known. The same step in a scene without forces
//! ends at an orientation `q_f`, and the exact rotation
//! ([`turn_freely`](crate::InertiaProperties::turn_freely)) at `q_e`. So the end `q` of the step
//! becomes
//!
//! ```text
//! q (q_f⁻¹ q_e)^w
//! ```
//! The weight `w` is 1 in flight, where `q = q_f`, so that the result is exact there. It decreases
//! with the change of the angular momentum in the step, and is 0 from 1/4096 of it. A contact then
//! causes the larger error, and a correction would only cost time. The correction is of the order
//! of the method's local error. So the order stays, and the end of a step is a continuous function
//! of the torques.
//!
//! A body with two equal moments is not corrected.

use crate::integrator::point::Point;
use crate::real::{Real, Vector};
use crate::rotation::Rotation;
use crate::scene::{Dynamics, TorqueFree};

/// Relative change of the angular momentum in a step above which the error of the contacts is the
/// larger one.
const SMALL: f64 = 1.0 / 4096.0;

/// Returns the orientation at the `end` of a step of `seconds`, without the error of its method in
/// torque-free rotation.
///
/// `by_method` returns the orientation after the same step in another scene.
#[inline(always)]
pub(in crate::integrator) fn removed<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &Point<R>,
    end: &Point<R>,
    seconds: R,
    by_method: impl FnOnce(&TorqueFree<'_, D>, &Point<R>, R) -> Rotation<R>,
) -> Rotation<R> {
    if scene.inertia_properties().is_asymmetric() {
        // Copies, because references would keep both points in memory through the whole step.
        corrected(scene, &{ *start }, &{ *end }, seconds, by_method)
    } else {
        end.orientation
    }
}

#[inline(never)]
fn corrected<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &Point<R>,
    end: &Point<R>,
    seconds: R,
    by_method: impl FnOnce(&TorqueFree<'_, D>, &Point<R>, R) -> Rotation<R>,
) -> Rotation<R> {
    let (rotation, momentum) = (start.orientation, start.angular_momentum);
    let impulse = (end.angular_momentum - momentum).length();
    let weight = R::ONE - impulse / (momentum.length() * R::from_f64(SMALL));
    // False for a body without angular momentum, too.
    let is_nearly_free = weight > R::ZERO;
    if !is_nearly_free {
        return end.orientation;
    }
    let inertia = scene.inertia_properties();
    let exact = inertia.turn_freely(rotation, &rotation.axes(), momentum, seconds);
    // Torques below the rounding of the momentum do not change the rotation. Torques of the stages
    // that cancel to the last bit, which no scene is known to have, would count as none.
    if weight == R::ONE {
        return exact;
    }
    let free_end = by_method(&TorqueFree(scene), start, seconds);
    let error = free_end.inverse().after(exact);
    end.orientation.after(error.part(weight)).normalised()
}
