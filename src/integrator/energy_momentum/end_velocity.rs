//! End-velocity correction for steps that do not resolve friction or damping.
//!
//! Friction or a damper resists a slip `u` with the force `c u`. The slip approaches its steady
//! value `u*` in a step as `e^-z`, with the [strain](super::strain) `z`. The mean slip of the step
//! is nearer to `u*` by the factor `1 + z/2`, which is correct. The end slip, however, follows as
//! `(1 - z/2)/(1 + z/2)`. Beyond `z = 2` it changes its sign, and for `z >> 2` it oscillates for
//! ever. A sticking contact would never rest, and an over-damped floor would throw a body back.
//!
//! The correction is an impulse at the end of the step, of the backward Euler kind,
//!
//! ```text
//! p = -k (u' - uₘ),    k = h c θ,    θ = 1/2 - 1/z   (0 up to z = 2)
//! ```
//!
//! with the mean slip `uₘ` and the slip `u'` after all impulses. For one contact and a linear law,
//! the impulse removes the whole deviation from `u*`: the factor is
//! `(1 - z/2 + θ z)/((1 + z/2)(1 + θ z)) = 0`.
//!
//! The impulse is 0 in two cases:
//!
//! * In steady motion, where the end slip equals the mean slip. A creep is therefore that of the
//!   law for any step size.
//! * Where the step resolves friction and dampers. The order therefore stays 2.
//!
//! A friction law is not linear, so `c` is the chord between the mean slip and the end slip. If the
//! end slip is opposite to the mean slip, the chord to 0, `|F|/|uₘ|`, is used. A slide that
//! friction would end within the step then ends at 0. Otherwise `c` is the slope of the law at the
//! mean slip, which is nearly 0 in a slide. A slide that begins or continues in spite of friction
//! is therefore not changed.
//!
//! *Friction of a limited damper.* Where a damper is corrected, the normal impulse of the step
//! changes by `p_n`, to less than its mean force gave. A slide has the friction of the load that is
//! left, so the impulse is along `n + ∂F/∂N`, the normal with the friction of a unit load. Without
//! it, the friction of an impact exceeds `μ` times the impulse of the ground, by a fraction of up
//! to `(z - 2)/(z + 2)`. Resistance to rolling and spinning depends on the load in the same way:
//! its part is the torque of a unit load. A load that a damper gives in addition has no such
//! torque, which could reverse the rotation. These parts alone may return energy, no more than
//! friction and resistance of the mean force have taken.
//!
//! *Applied force.* Half of it acts before the step and half after it. The end slip is that after
//! the second half ([`Ahead`]). So a body that friction holds ends a step with the opposite of what
//! the force is about to give it, and friction has to give the impulse of the force. Drawn to the
//! mean before the force acts, friction would have to give twice of it.
//!
//! *The energy.* Let `y` be the velocities (v, ω). The impulses change the energy by `Σ pᵢ·uₘᵢ`
//! plus a negative part. That part is negative because the impulses draw `y` towards the mean, by
//! factors of 0 to 1 in the metric of the mass. If `u'` has not changed its direction,
//! `p·uₘ <= h θ c uₘ²`. This is less than half of what friction and dampers have dissipated in the
//! step. With an applied force, this holds for the velocities after its second half. Those before
//! it differ by as much as the first half has given, so that a held body has the energy of the
//! start again. The energy limiter is the bound.

use super::applied::Ahead;
use super::contacts::Contacts;
use super::problem::{Problem, TrialStep};
use super::resist::Resistance;
use super::strain::{Along, Strain, leverage};
use super::touch::{Push, Touch};
use crate::contact::Motion;
use crate::friction::FrictionJacobian;
use crate::ground::SpringDamperGround;
use crate::integrator::matrix3::Matrix3;
use crate::real::{Real, Vector};
use crate::scene::Dynamics;
use crate::state::State;

/// Number of passes that fit the impulses of the dampers to their limits.
const PASSES: u32 = 4;

/// Returns the end of a trial after friction and dampers have corrected its velocities, and
/// resistance to rolling and spinning by a matrix `turning`.
pub(super) fn corrected<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &Contacts<R>,
    (trial, ahead): (&TrialStep<R>, &Ahead<R>),
    (strain, turning): (Strain<R>, Option<Matrix3<R>>),
    end: &State<R>,
) -> State<R> {
    let correction = Correction {
        problem,
        strain,
        motion: ahead.seen(problem.scene, end),
    };
    let mut corrected_end = *end;
    // Dampers that the step resolves give no impulse, so that none is limited.
    let passes = if strain.damping <= R::TWO { 1 } else { PASSES };
    for pass in 0..passes {
        let after = (pass > 0).then(|| ahead.seen(problem.scene, &corrected_end));
        let mut sum = Resistance::of_body(problem.scene, &correction.motion, end.angular_momentum);
        let mut is_limited = false;
        if let Some(turning) = &turning {
            let mean = problem.mean_angular_velocity(trial);
            sum.add_turning(turning, correction.motion.angular_velocity - mean);
        }
        contacts.recall_all(problem, trial, &mut |touch, jacobian| {
            is_limited |= correction.add(&mut sum, touch, jacobian, after.as_ref());
        });
        if passes > 1 && problem.resists_turning() {
            let rotation = problem.mean_rotation(trial);
            contacts.visit_active(problem, trial, &mut |touch| {
                correction.add_torque_of_load(&mut sum, touch, rotation, after.as_ref());
            });
        }
        // If no limit is active, another pass gives the same result.
        if pass > 0 && !is_limited {
            break;
        }
        let Some(next) = sum.resisted(problem.scene, end, problem.bounding_radius) else {
            break;
        };
        corrected_end = next;
    }
    corrected_end
}

/// Data from which the impulses of the contacts are computed.
struct Correction<'a, R: Real, D> {
    problem: &'a Problem<'a, R, D>,
    strain: Strain<R>,
    /// Motion at the end of the step, relative to the ground, after the second half of the applied
    /// force.
    motion: Motion<R>,
}

impl<R: Real, D: Dynamics<R>> Correction<'_, R, D> {
    /// Adds the resistances of one contact. Returns true if its damper has reached its limit in the
    /// motion `after` the last pass.
    fn add(
        &self,
        sum: &mut Resistance<R>,
        touch: &Touch<R>,
        jacobian: &FrictionJacobian<R>,
        after: Option<&Motion<R>>,
    ) -> bool {
        let push = &touch.push;
        let n = self.end_normal(push);
        let place = push.end_arm - n * push.radius;
        let end = self.motion.velocity_at(place);
        let along = chord(push, jacobian, end - n * end.dot(n));
        let along = self.per_speed(along, self.share(along, self.strain.friction, R::ONE));
        let rising = self.rising(push);
        let (across, is_limited) = self.across(push, (n, place), after);
        // A slide has the friction of the load that the damper leaves.
        let pushed = n + touch.friction_of_unit_load(self.problem, jacobian);
        sum.add(
            place,
            [n, pushed],
            [along, across],
            end - push.slip - n * rising,
        );
        is_limited
    }

    /// Adds the torque of resistance to rolling and spinning of the load that a damper takes back,
    /// at a [mean rotation](Problem::mean_rotation).
    #[cold]
    #[inline(never)]
    fn add_torque_of_load(
        &self,
        sum: &mut Resistance<R>,
        touch: &Touch<R>,
        rotation: (R::Vec3, R),
        after: Option<&Motion<R>>,
    ) {
        let Some(torque) = touch.torque_of_unit_load(self.problem, rotation) else {
            return;
        };
        let push = &touch.push;
        let n = self.end_normal(push);
        let place = push.end_arm - n * push.radius;
        let rising = self.motion.velocity_at(place).dot(n) - self.rising(push);
        // A load in addition would resist in the direction of the mean, which the end can oppose.
        if rising > R::ZERO {
            let (across, _) = self.across(push, (n, place), after);
            sum.add_torque(place, n, torque * across, rising);
        }
    }

    /// Mean speed at which a contact leaves the ground in the step, m/s.
    fn rising(&self, push: &Push<R>) -> R {
        (push.depth - push.end_depth) * self.problem.per_second
    }

    /// Resistance of a damper across the ground, kg, for a contact with this normal and place at
    /// the end, and whether the damper has reached its limit in the motion `after`.
    fn across(
        &self,
        push: &Push<R>,
        (normal, place): (R::Vec3, R::Vec3),
        after: Option<&Motion<R>>,
    ) -> (R, bool) {
        let damping = push.mean.damping;
        if self.strain.damping <= R::TWO {
            return (R::ZERO, false);
        }
        let properties = self.problem.scene.inertia_properties();
        let leverage = leverage(properties, &self.motion.axes, &Along::at(place, normal));
        let share = self.share(damping, self.strain.damping, leverage);
        let across = self.per_speed(damping, share);
        // Of the impulse that the ground has given, at most the part that brings the contact to
        // rest at the end: less than half.
        let limit = self.per_speed(push.mean.force, share);
        let rising = self.rising(push);
        let beyond = after.map_or(R::ZERO, |after| {
            after.velocity_at(place).dot(normal) - rising
        });
        if across * beyond > limit {
            (limit / beyond, true)
        } else {
            (across, false)
        }
    }

    /// Normal out of the ground at the contact point at the end of the step. The mean normal would
    /// give an apparent slip and rise of order h, from the path of a ball along a curve and its
    /// rotation about the normal.
    fn end_normal(&self, push: &Push<R>) -> R::Vec3 {
        if self.problem.plane_of(push.surface).is_some() {
            return push.normal;
        }
        let ground = self.problem.ground(push.surface);
        ground.surface(self.motion.position + push.end_arm).normal
    }

    /// Returns `h c θ`.
    fn per_speed(&self, coefficient: R, share: R) -> R {
        coefficient * (self.problem.seconds * share)
    }

    /// Factor θ of a contact with the coefficient c (N s/m) and a [`leverage`]. Every other contact
    /// is assumed to have the same strain, but the sum is at most the strain of all contacts. A
    /// sliding contact next to a sticking one is therefore resolved as it would be alone.
    fn share(&self, coefficient: R, strain_of_all: R, leverage: R) -> R {
        let own = coefficient * (self.problem.seconds / self.problem.mass) * leverage;
        share_of((own * self.strain.contacts).at_most(strain_of_all))
    }
}

/// Factor θ of a resistance with a strain in the step.
pub(super) fn share_of<R: Real>(strain: R) -> R {
    if strain > R::TWO {
        R::HALF - R::ONE / strain
    } else {
        R::ZERO
    }
}

/// Slope of friction used for the correction, N s/m. It is `|F|/|u|` at the mean slip if the end
/// slip is opposite to it, else the slope of the law there.
fn chord<R: Real>(push: &Push<R>, jacobian: &FrictionJacobian<R>, end_slip: R::Vec3) -> R {
    if end_slip.dot(push.slip) <= R::ZERO {
        return jacobian.coefficient;
    }
    let steepness = R::ONE - jacobian.growth * (push.slip.length() / jacobian.width);
    jacobian.coefficient * steepness.at_least(R::ZERO)
}
