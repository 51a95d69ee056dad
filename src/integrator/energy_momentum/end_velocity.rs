//! What a step that is too long for friction or dampers must still do: let them settle its end
//! velocity.
//!
//! Where friction or a damper resists a slip `u` with `c u`, the slip that it settles at, `u*`, is
//! approached as `e^-z` in a step, with the strain `z = h c/m`. The step's mean slip is nearer to
//! `u*` by `1 + z/2`, as it should be; but its end slip follows as `(1 - z/2)/(1 + z/2)`: beyond
//! `z = 2` it turns round, and for `z >> 2` it flips for ever. A sticking contact would never rest,
//! and an over-damped floor throw a body back. The cure is an impulse at the end of the step, of
//! backward Euler's kind,
//!
//! ```text
//! p = -k (u' - uₘ),    k = h c θ,    θ = 1/2 - 1/z   (0 up to z = 2)
//! ```
//!
//! with the mean slip `uₘ` and the slip `u'` after all impulses. For one contact and a law that is
//! linear they leave nothing of a departure from `u*`: the factor is
//! `(1 - z/2 + θ z)/((1 + z/2)(1 + θ z)) = 0`. The impulse is 0 in steady motion, where the end
//! slip is the mean one, so that a creep is the law's at any step; and 0 where the step resolves
//! friction and dampers, so that the order stays 2.
//!
//! A friction law is not linear: `c` is the chord between the mean slip and the end's. Where the
//! end slip has turned against the mean one, the chord to 0 stands for it, `|F|/|uₘ|`: a slide that
//! friction would end within the step ends at 0 by it. Elsewhere it is the law's own slope at the
//! mean slip, next to 0 in a slide: one that begins or goes on in spite of friction is left alone.
//!
//! *The energy.* With `y` the velocities (v, ω), the impulses change it by `Σ pᵢ·uₘᵢ` and a part
//! below 0 (they draw `y` towards the mean, by factors of 0 to 1 in the metric of the mass). Where
//! `u'` has not turned, `p·uₘ <= h θ c uₘ²`: less than the half of what friction and dampers have
//! taken in the step.

use super::contacts::Contacts;
use super::motion_of;
use super::problem::{Problem, Trial};
use super::resist::Resistance;
use super::touch::Push;
use crate::friction::FrictionJacobian;
use crate::ground::SpringDamperGround;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, Motion};
use crate::state::State;

/// Passes that fit the dampers' impulses to their limits.
const PASSES: u32 = 4;

/// Resistance of all contacts to sliding and to closing, N s/m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strain<R> {
    contacts: R,
    friction: R,
    damping: R,
}

impl<R: Real> Strain<R> {
    pub(super) const NONE: Self = Self {
        contacts: R::ZERO,
        friction: R::ZERO,
        damping: R::ZERO,
    };

    #[inline]
    pub(super) fn add(&mut self, push: &Push<R>, drag: &FrictionJacobian<R>) {
        self.contacts += R::ONE;
        self.friction += drag.coefficient;
        self.damping += push.mean.damping;
    }

    /// Of the contacts at the trial that they have responded to last.
    pub(super) fn at<D: Dynamics<R>>(
        problem: &Problem<'_, R, D>,
        contacts: &Contacts<R>,
        trial: &Trial<R>,
    ) -> Self {
        let mut strain = Self::NONE;
        contacts.recall(problem, trial, |push, drag| strain.add(push, drag));
        strain
    }

    /// Impulse of friction (N s) over a path (m) along the ground, where its slope is that of
    /// stick.
    #[inline]
    pub(super) fn friction_over(&self, path: R) -> R {
        self.friction * path
    }

    /// How strongly a step strains them: `z = h Σc/m`, unresolved above 2.
    #[inline]
    pub(super) fn of_step<D>(&self, problem: &Problem<'_, R, D>) -> Self {
        let factor = problem.seconds / problem.mass;
        Self {
            friction: self.friction * factor,
            damping: self.damping * factor,
            ..*self
        }
    }

    /// Returns true if neither friction nor a damper resists.
    #[inline]
    pub(super) fn is_none(&self) -> bool {
        self.friction == R::ZERO && self.damping == R::ZERO
    }

    #[inline]
    pub(super) fn is_resolved(&self) -> bool {
        self.friction <= R::TWO && self.damping <= R::TWO
    }
}

/// The end of a trial after friction and dampers have settled its velocities.
pub(super) fn settle<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &Contacts<R>,
    trial: &Trial<R>,
    strain: Strain<R>,
    end: &State<R>,
) -> State<R> {
    let settling = Settling {
        problem,
        strain,
        motion: motion_of(problem.scene, end),
    };
    let mut settled = *end;
    for pass in 0..PASSES {
        let after = (pass > 0).then(|| motion_of(problem.scene, &settled));
        let mut sum = Resistance::of_body(problem.scene, &settling.motion, end.angular_momentum);
        let mut is_limited = false;
        contacts.recall(problem, trial, |push, drag| {
            is_limited |= settling.add(&mut sum, push, drag, after.as_ref());
        });
        // Without a limit, another pass is the same one.
        if pass > 0 && !is_limited {
            break;
        }
        let Some(next) = sum.resisted(problem.scene, end, problem.bounding_radius) else {
            break;
        };
        settled = next;
    }
    settled
}

/// What the contacts' impulses are found from.
struct Settling<'a, R: Real, D> {
    problem: &'a Problem<'a, R, D>,
    strain: Strain<R>,
    /// At the end of the step.
    motion: Motion<R>,
}

impl<R: Real, D: Dynamics<R>> Settling<'_, R, D> {
    /// Adds the resistances of one contact, and tells whether its damper has reached its limit in
    /// the motion `after` the last pass.
    fn add(
        &self,
        sum: &mut Resistance<R>,
        push: &Push<R>,
        drag: &FrictionJacobian<R>,
        after: Option<&Motion<R>>,
    ) -> bool {
        let n = self.end_normal(push);
        let place = push.end_arm - n * push.radius;
        let end = self.motion.velocity_at(place);
        let along = chord(push, drag, end - n * end.dot(n));
        let along = self.per_speed(along, self.share(along, self.strain.friction));
        let damping = push.mean.damping;
        let share = self.share(damping, self.strain.damping);
        let mut across = self.per_speed(damping, share);
        let rising = (push.depth - push.end_depth) * self.problem.per_second;
        // The ground may take back as much of what it has given, but never pull.
        let limit = self.per_speed(push.mean.force, share);
        let beyond = after.map_or(R::ZERO, |after| after.velocity_at(place).dot(n) - rising);
        let is_limited = across * beyond > limit;
        if is_limited {
            across = limit / beyond;
        }
        sum.add(place, n, [along, across], end - push.slip - n * rising);
        is_limited
    }

    /// Out of the ground where the contact is at the end. The mean one would take a ball's way
    /// round a curve, and its turn about the normal, for a slip and a rise of order h.
    fn end_normal(&self, push: &Push<R>) -> R::Vec3 {
        if self.problem.plane.is_some() {
            return push.normal;
        }
        let ground = self.problem.scene.ground();
        ground.surface(self.motion.position + push.end_arm).normal
    }

    /// `h c θ`.
    fn per_speed(&self, coefficient: R, share: R) -> R {
        coefficient * (self.problem.seconds * share)
    }

    /// θ of a contact with the coefficient c (N s/m), as if every other one were strained as much,
    /// but no more than all together are: one that slides beside one that sticks is resolved as it
    /// would be alone.
    fn share(&self, coefficient: R, strain_of_all: R) -> R {
        let own = coefficient * (self.problem.seconds / self.problem.mass);
        let strain = (own * self.strain.contacts).at_most(strain_of_all);
        if strain > R::TWO {
            R::HALF - R::ONE / strain
        } else {
            R::ZERO
        }
    }
}

/// `|F|/|u|` of the friction at the mean slip where the slip at the end of the step has turned
/// against it; elsewhere the law's slope there, N s/m.
fn chord<R: Real>(push: &Push<R>, drag: &FrictionJacobian<R>, end_slip: R::Vec3) -> R {
    if end_slip.dot(push.slip) <= R::ZERO {
        return drag.coefficient;
    }
    let steepness = R::ONE - drag.growth * (push.slip.length() / drag.width);
    drag.coefficient * steepness.at_least(R::ZERO)
}
