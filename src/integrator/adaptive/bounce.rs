//! Contacts that touch and part within one attempted step: their greatest depth, and an impulse
//! that is too large.
//!
//! No end of the step contains such a contact, and few stages do. An estimate compares numbers that
//! follow from those stages, and may be small by chance. The energy of the two ends is independent
//! of them. If nothing drives the body, a gain `ΔE` of the energy is an error, and the impulse `δJ`
//! without which there is none follows from the speed `c` at which the contact leaves the ground,
//! and its effective inverse mass `w`:
//!
//! ```text
//! c δJ - w δJ²/2 = ΔE
//! ```

use core::cell::Cell;

use crate::body::ContactPoint;
use crate::contact::Motion;
use crate::energy::Energy;
use crate::integrator::contact_path::arm;
use crate::integrator::energy_limit::rounding_of;
use crate::integrator::point::Point;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, is_driven};

/// Returns the greatest depth that a contact can reach between two ends above ground, m.
///
/// A path with the end slopes `m₀ > 0` and `m₁ < 0` by the fraction of the step descends by at most
/// `|m₁ - m₀|/4` below the higher end, which it does if all of the change happens at once. The
/// slopes of all contacts differ by at most the change of the velocities in the step.
#[inline]
pub(super) fn reach<R: Real, D: Dynamics<R>>(
    scene: &D,
    [start, end]: [&Motion<R>; 2],
    seconds: R,
) -> R {
    let bounding_radius = scene.bounding_radius();
    let change = (end.linear_velocity - start.linear_velocity).length();
    let spin = start
        .angular_velocity
        .length()
        .at_least(end.angular_velocity.length());
    let turning = (end.angular_velocity - start.angular_velocity).length();
    let rotation = (turning + spin * spin * seconds) * bounding_radius;
    (change + rotation) * (seconds * R::from_f64(0.25))
}

/// Returns a number that is computed at its first use. A `OnceCell` would need a panic.
#[inline]
pub(super) fn once<R: Real>(known: &Cell<Option<R>>, compute: impl FnOnce() -> R) -> R {
    known.get().unwrap_or_else(|| {
        let number = compute();
        known.set(Some(number));
        number
    })
}

/// Energy that an attempted step has gained beyond rounding, J, or a number that is not positive.
/// It is 0 if the ground or the applied force may drive the body.
#[inline(never)]
pub(super) fn energy_gained<R: Real, D: Dynamics<R>>(scene: &D, ends: [&Point<R>; 2]) -> R {
    if is_driven(scene) {
        return R::ZERO;
    }
    let [before, after] = ends.map(|end| Energy::of(scene, &end.to_state()));
    after.total() - before.total() - rounding_of(&before, &after)
}

/// Impulse with which a contact of a step that has `gained` this energy (J) has pushed too much,
/// N s. The motion is that at the end, and the speed (m/s) is that of the contact away from the
/// ground.
#[inline(never)]
pub(super) fn excess_impulse<R: Real, D: Dynamics<R>>(
    scene: &D,
    point: &ContactPoint<R>,
    (motion, leaving_speed): (&Motion<R>, R),
    gained: R,
) -> R {
    let inertia = scene.inertia_properties();
    let (arm, normal) = arm(scene, motion, point);
    let spin = inertia.angular_velocity(&motion.axes, arm.cross(normal));
    let inverse_mass = inertia.inverse_mass() + spin.cross(arm).dot(normal);
    let square = leaving_speed * leaving_speed - gained * inverse_mass * R::TWO;
    (leaving_speed - square.at_least(R::ZERO).sqrt()) / inverse_mass
}
