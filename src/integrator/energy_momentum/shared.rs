//! What several stages need: functions that are compiled once, and the precision.

use crate::contact::{Contact, Motion};
use crate::real::Real;
use crate::scene::Dynamics;
use crate::state::State;

/// Returns true for single precision. One Newton step from the close distance then leaves errors
/// that accumulate to a noticeable size within thousands of steps.
#[inline(always)]
pub(super) fn is_single<R: Real>() -> bool {
    R::EPSILON > R::from_f64(1e-10)
}

/// Calls [`Dynamics::motion`], but is compiled once, for the stages that a step seldom needs.
#[inline(never)]
pub(super) fn motion_of<R: Real, D: Dynamics<R>>(scene: &D, state: &State<R>) -> Motion<R> {
    scene.motion(state)
}

/// Motion of a state relative to the ground's material.
#[inline(always)]
pub(super) fn seen<R: Real, D: Dynamics<R>>(scene: &D, state: &State<R>) -> Motion<R> {
    scene.contact_model().seen(&motion_of(scene, state))
}

/// Calls [`Dynamics::visit_contacts`], but is compiled once, for the stages that a step seldom
/// needs.
#[inline(never)]
pub(super) fn visit_contacts<R: Real, D: Dynamics<R>>(
    scene: &D,
    motion: &Motion<R>,
    visit: &mut dyn FnMut(&Contact<R>),
) {
    scene.visit_contacts(motion, visit);
}
