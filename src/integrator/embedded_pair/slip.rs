//! Contacts whose slip turns round within a step.
//!
//! Coulomb's friction changes by `2 μ N` while the slip passes from a few slip speeds on one side
//! of 0 to a few on the other: next to a jump, for a step that is long beside that. The stages of a
//! Runge-Kutta step weigh such a force by where they lie, and the pair's difference knows little of
//! it: with the jump in the middle of a step of Dormand and Prince, the result is off by up to 0.24
//! of the change, and their difference by 0.003. So where the friction of a contact turns round in
//! a step, what the stages have summed of it is compared with the integral along the path of its
//! slip.

use super::touch::{Taken, mean};
use crate::body::ContactPoint;
use crate::friction::SlidingFriction;
use crate::integrator::contact_path::{ContactEnd, Path, arm, push, slip};
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, size};

/// The friction turns round so quickly that a step may miss it where, about the smallest slip, it
/// changes this much more than in proportion to the time. A step sums a steady change well.
const QUICK: f64 = 2.0;
/// The share of the step, to both sides of the smallest slip, in which that is asked.
const ABOUT: f64 = 1.0 / 16.0;

impl<R: Real, D: Dynamics<R>, const STAGES: usize> Taken<'_, R, D, STAGES> {
    /// What the step makes wrong of a contact that pushes at both ends and whose slip turns round:
    /// in the velocity of the farthest place, m/s.
    ///
    /// The slip is taken as `u(s) = u₀ + s (u₁ - u₀)`, smallest at
    /// `s = -u₀ · (u₁ - u₀)/|u₁ - u₀|²`. Where it changes by less than its smallest value, the
    /// friction cannot turn by much.
    #[inline]
    pub(super) fn wrong_of_slip(&self, point: &ContactPoint<R>, sides: &[ContactEnd<R>; 2]) -> R {
        let [first, last] = self
            .ends
            .map(|motion| slip(motion, arm(self.scene, motion, point)));
        let change = last - first;
        let square = change.length_squared();
        let share = (-first.dot(change) / square)
            .at_least(R::ZERO)
            .at_most(R::ONE);
        if (first + change * share).length_squared() < square {
            self.wrong_of_friction(point, sides, [first, change], share)
        } else {
            R::ZERO
        }
    }

    /// With the smallest slip after a share of the step.
    #[inline(never)]
    fn wrong_of_friction(
        &self,
        point: &ContactPoint<R>,
        [start, end]: &[ContactEnd<R>; 2],
        [first, change]: [R::Vec3; 2],
        share: R,
    ) -> R {
        let friction = self.scene.friction();
        let path = Path::between(start, end, self.seconds);
        let force = |share: R| {
            let (depth, slope) = path.at(share);
            let normal_force = push(self.scene, depth, slope / self.seconds);
            friction.force(normal_force, first + change * share)
        };
        let [from, to] = [-ABOUT, ABOUT].map(|about| {
            (share + R::from_f64(about))
                .at_least(R::ZERO)
                .at_most(R::ONE)
        });
        let about = (force(to) - force(from)).length();
        let steadily = (force(R::ONE) - force(R::ZERO)).length() * (to - from);
        if about <= steadily * R::from_f64(QUICK) {
            return R::ZERO;
        }
        // Each side of the turn is smooth.
        let truth = mean(force, R::ZERO, share) + mean(force, share, R::ONE);
        let impulse = (truth - self.friction_of_stages(point)) * self.seconds;
        self.way_of(point, impulse)
    }

    /// What the method has made of the contact's friction, N.
    fn friction_of_stages(&self, point: &ContactPoint<R>) -> R::Vec3 {
        let mut sum = R::Vec3::ZERO;
        for (motion, weight) in self.weighed_motions() {
            let slip = slip(motion, arm(self.scene, motion, point));
            let normal_force = ContactEnd::of(self.scene, motion, point).normal_force;
            sum += self.scene.friction().force(normal_force, slip) * weight;
        }
        sum
    }

    /// Velocity of the farthest place for an impulse at a contact, m/s.
    fn way_of(&self, point: &ContactPoint<R>, impulse: R::Vec3) -> R {
        let motion = self.ends[1];
        let mass = self.scene.inertia_properties();
        let (arm, _) = arm(self.scene, motion, point);
        let spin = mass.angular_velocity(&motion.axes, arm.cross(impulse));
        impulse.length() * mass.inverse_mass() + spin.length() * size(self.scene)
    }
}
