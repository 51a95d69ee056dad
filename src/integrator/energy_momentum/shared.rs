//! What several stages need: the end of a step, and functions that are compiled once.

use crate::contact::{Contact, Motion};
use crate::real::Real;
use crate::scene::Dynamics;
use crate::state::State;

/// End of a step, or of a part of it, before its energy is limited.
pub(super) struct End<R: Real> {
    pub(super) state: State<R>,
    /// True if contacts may have pushed, and friction and dampers have done no work.
    pub(super) is_lossless: bool,
    /// Work of a ground that moves, J.
    pub(super) work: R,
}

impl<R: Real> End<R> {
    /// End of a flight.
    #[inline(always)]
    pub(super) fn without_work(state: State<R>) -> Self {
        Self {
            state,
            is_lossless: false,
            work: R::ZERO,
        }
    }
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
