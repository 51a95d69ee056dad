//! What a step that is too long for friction or dampers must still do: let them stop the body at its end.
//!
//! A mean force over a step knows the mean velocity only. Where friction or a damper could stop a contact in less than half a step, the mean velocity comes out as 0 and the end velocity
//! as minus the start's: a sticking contact would flip for ever, and an over-damped floor throw a body back. The cure is an impulse at the end of the step that resists the end velocity,
//! limited to what the law gives there *beyond* what it has given at the mean velocity. In steady motion the two are the same and nothing happens; where the step resolves friction and
//! dampers, nothing is applied at all, so that the order stays 2.

use super::contacts::{Answer, Contacts, Push};
use super::problem::{Problem, Trial};
use super::resist::{Resisting, resisted};
use crate::friction::SlidingFriction;
use crate::ground::SpringDamperGround;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, Motion};
use crate::state::State;

/// Resistance of all contacts to sliding and to closing, N s/m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strain<R> {
    friction: R,
    damping: R,
}

impl<R: Real> Strain<R> {
    pub(super) const NONE: Self = Self {
        friction: R::ZERO,
        damping: R::ZERO,
    };

    #[inline]
    pub(super) fn add(&mut self, push: &Push<R>, answer: &Answer<R>) {
        self.friction += answer.drag.coefficient;
        self.damping += push.mean.damping;
    }

    /// Of the contacts at the trial that they have responded to last.
    pub(super) fn at<D: Dynamics<R>>(
        problem: &Problem<'_, R, D>,
        contacts: &mut Contacts<R>,
        trial: &Trial<R>,
    ) -> Self {
        let mut strain = Self::NONE;
        contacts.answer(problem, trial, |push, answer| strain.add(push, answer));
        strain
    }

    /// How strongly a step strains them: `2 dt Σc/m`, unresolved above 2.
    #[inline]
    pub(super) fn of_step<D>(&self, problem: &Problem<'_, R, D>) -> Self {
        let factor = R::TWO * problem.seconds / problem.mass;
        Self {
            friction: self.friction * factor,
            damping: self.damping * factor,
        }
    }

    #[inline]
    pub(super) fn is_resolved(&self) -> bool {
        self.friction <= R::TWO && self.damping <= R::TWO
    }
}

/// The share of a limit that is applied: 0 up to a strain of 2, towards 1 far above.
fn share<R: Real>(strain: R) -> R {
    if strain > R::TWO {
        R::ONE - R::TWO / strain
    } else {
        R::ZERO
    }
}

/// The end of a trial after friction and dampers have resisted its velocities, within their limits.
pub(super) fn settle<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &Contacts<R>,
    trial: &Trial<R>,
    strain: Strain<R>,
    end: &State<R>,
) -> State<R> {
    resisted(problem.scene, problem.reach, end, |motion, resist| {
        contacts.recall(problem, trial, |push| {
            resist(&limits(problem, push, strain, motion));
        });
    })
}

/// What one contact may still give at the end of the step.
fn limits<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    push: &Push<R>,
    strain: Strain<R>,
    motion: &Motion<R>,
) -> Resisting<R> {
    let (ground, friction) = (problem.scene.ground(), problem.scene.friction());
    let (normal, place) = (push.normal, push.end_point());
    let velocity = motion.velocity_at(place);
    let rising = velocity.dot(normal);
    let slip = velocity - normal * rising;
    let friction_beyond = friction.force(push.mean.force, slip).length() - push.friction.length();
    let force_at_end = if push.end_depth > R::ZERO {
        ground.normal_force(push.end_depth, -rising)
    } else {
        R::ZERO
    };
    // The ground may take back what it gave too much, but never push a body down into itself.
    let pull = if rising > R::ZERO {
        push.mean.force - force_at_end
    } else {
        R::ZERO
    };
    Resisting {
        place,
        normal,
        along: friction_beyond * (problem.seconds * share(strain.friction)),
        across: pull * (problem.seconds * share(strain.damping)),
    }
}
