//! Contacts that begin to push at the end of a step to a discontinuity, and the load without them.

use crate::contact::{Contact, Load, Motion, Onset};
use crate::integrator::contact_path::ContactEnd;
use crate::real::Real;
use crate::scene::{Dynamics, OnSurface};

/// Returns the load in a step to a discontinuity at its end, without the contacts that begin to
/// push there.
///
/// A stage at the end of the step may be slightly beyond the path. It would then include a jump of
/// the force that the step does not reach.
pub(super) fn load_before<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &Motion<R>,
    motion: &Motion<R>,
    seconds: R,
) -> Load<R> {
    let mut load = Load::default();
    let turning = scene.contact_model().seen(motion).angular_velocity;
    let mut add = |contact: &Contact<R>| {
        let laws = (scene.ground(), scene.friction());
        load.add(contact, contact.force(laws.0, laws.1));
        load.torque += contact.turning_torque(laws.0, laws.1, turning);
    };
    let is_late = |contact: &Contact<R>| {
        let scene = OnSurface::of(scene, contact.surface);
        comes_late(&ContactEnd::of(&scene, start, &contact.point), seconds)
    };
    scene
        .contact_model()
        .visit_with_onsets(motion, &mut |contact, onset| {
            if onset == Onset::Gradual || !is_late(contact) {
                add(contact);
            }
        });
    load
}

/// Returns true if a contact is above ground, and would be for the first half of a step at constant
/// speed.
#[inline]
pub(super) fn comes_late<R: Real>(side: &ContactEnd<R>, seconds: R) -> bool {
    let halfway = side.depth + side.closing_speed * (seconds * R::HALF);
    side.depth <= R::ZERO && halfway <= R::ZERO
}
