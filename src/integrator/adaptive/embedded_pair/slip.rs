//! Contacts whose slip reverses within a step.
//!
//! Coulomb friction changes by `2 μ N` while the slip passes from a few slip speeds on one side of
//! 0 to a few on the other. For a step that is long in comparison, this is almost a jump. The
//! stages of a Runge-Kutta step weigh such a force by their positions in the step, and the
//! difference of the pair does not measure the error. An example is a jump in the middle of a step
//! of Dormand and Prince. The error of the result is up to 0.24 of the change, and their difference
//! is 0.003. If the friction of a contact reverses in a step, the sum over the stages is therefore
//! compared with the integral along the path of the slip.

use super::touch::Taken;
use crate::body::ContactPoint;
use crate::friction::SlidingFriction;
use crate::integrator::contact_path::{ContactEnd, Path, arm, push, slip};
use crate::quadrature::integral_of_3;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, size};

/// Factor for a reversal that a step may miss, compared with a change in proportion to the time. It
/// applies to the change of friction around the smallest slip. A step sums a steady change well.
const QUICK: f64 = 2.0;
/// Fraction of the step, on both sides of the smallest slip, in which this change is evaluated.
const ABOUT: f64 = 1.0 / 16.0;

impl<R: Real, D: Dynamics<R>, const STAGES: usize> Taken<'_, R, D, STAGES> {
    /// Returns the error of a contact that pushes at both ends and whose slip reverses, m/s.
    ///
    /// It is the error in the velocity of the farthest point of the body. The slip is taken as
    /// `u(s) = u₀ + s (u₁ - u₀)`, smallest at `s = -u₀ · (u₁ - u₀)/|u₁ - u₀|²`. If it changes by
    /// less than its smallest value, the direction of friction cannot change much.
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

    /// Returns the error in the velocity of the farthest point, m/s, if the slip is smallest at the
    /// fraction `share` of the step.
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
        // Each side of the reversal is smooth.
        let truth = integral_of_3(force, R::ZERO, share) + integral_of_3(force, share, R::ONE);
        let impulse = (truth - self.friction_of_stages(point)) * self.seconds;
        self.way_of(point, impulse)
    }

    /// Returns the mean friction of the contact as the method has summed it, N.
    fn friction_of_stages(&self, point: &ContactPoint<R>) -> R::Vec3 {
        let mut sum = R::Vec3::ZERO;
        for (motion, weight) in self.weighed_motions() {
            let slip = slip(motion, arm(self.scene, motion, point));
            let normal_force = ContactEnd::of(self.scene, motion, point).normal_force;
            sum += self.scene.friction().force(normal_force, slip) * weight;
        }
        sum
    }

    /// Returns the velocity of the farthest point of the body for an impulse at a contact, m/s.
    fn way_of(&self, point: &ContactPoint<R>, impulse: R::Vec3) -> R {
        let motion = self.ends[1];
        let mass = self.scene.inertia_properties();
        let (arm, _) = arm(self.scene, motion, point);
        let spin = mass.angular_velocity(&motion.axes, arm.cross(impulse));
        impulse.length() * mass.inverse_mass() + spin.length() * size(self.scene)
    }
}
