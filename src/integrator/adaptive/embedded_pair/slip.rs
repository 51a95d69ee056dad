//! Contacts whose slip reverses within a step.
//!
//! Coulomb friction changes by `2 μ N` while the slip passes from a few slip speeds on one side of
//! 0 to a few on the other. For a step that is long in comparison, this is almost a jump. The
//! stages of a Runge-Kutta step weigh such a force by their positions in the step, and the
//! difference of the pair does not measure the error. An example is a jump in the middle of a step
//! of Dormand and Prince. The error of the result is up to 0.24 of the change, and their difference
//! is 0.003. If the friction of a contact reverses in a step, the sum over the stages is therefore
//! compared with the integral along the path of the slip. The same holds for a contact whose
//! friction law varies over the ground, because the law may have a jump there.

use super::touch::AttemptedStep;
use super::tuning::{self, FRICTION_PARTS};
use crate::body::ContactPoint;
use crate::contact::Motion;
use crate::friction::SlidingFriction;
use crate::integrator::contact_path::{ContactEnd, Path, arm, push, slip};
use crate::quadrature::integral_of_3;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, size};

/// Slip and position of a contact, which change uniformly over a step.
struct Slide<R: Real> {
    slip: R::Vec3,
    slip_change: R::Vec3,
    position: R::Vec3,
    displacement: R::Vec3,
}

impl<R: Real> Slide<R> {
    /// Returns the slide between two motions, with the arm and the normal of the contact in each.
    #[inline]
    fn between<D: Dynamics<R>>(
        scene: &D,
        [start, end]: [&Motion<R>; 2],
        arms: [(R::Vec3, R::Vec3); 2],
    ) -> Self {
        let (first, last) = (slip(scene, start, arms[0]), slip(scene, end, arms[1]));
        let (from, to) = (start.position + arms[0].0, end.position + arms[1].0);
        Self {
            slip: first,
            slip_change: last - first,
            position: from,
            displacement: to - from,
        }
    }

    #[inline]
    fn slip(&self, share: R) -> R::Vec3 {
        self.slip + self.slip_change * share
    }

    #[inline]
    fn position(&self, share: R) -> R::Vec3 {
        self.position + self.displacement * share
    }
}

impl<R: Real, D: Dynamics<R>> AttemptedStep<'_, R, D> {
    /// Returns the error of a contact that pushes at both ends and whose slip reverses, m/s.
    ///
    /// It is the error in the velocity of the farthest point of the body. The slip is taken as
    /// `u(s) = u₀ + s (u₁ - u₀)`, smallest at `s = -u₀ · (u₁ - u₀)/|u₁ - u₀|²`. If it changes by
    /// less than its smallest value, the direction of friction cannot change much.
    #[inline]
    pub(super) fn slip_error(&self, point: &ContactPoint<R>, sides: &[ContactEnd<R>; 2]) -> R {
        let arm_in = |motion| arm(self.scene, motion, point);
        let arms = [arm_in(self.ends[0]), arm_in(self.ends[1])];
        let slide = Slide::between(self.scene, self.ends, arms);
        let (first, change) = (slide.slip, slide.slip_change);
        let square = change.length_squared();
        let share = (-first.dot(change) / square)
            .at_least(R::ZERO)
            .at_most(R::ONE);
        if (first + change * share).length_squared() < square {
            self.reversal_error(point, sides, &slide, share)
        } else if self.scene.friction().depends_on_position() {
            self.varying_friction_error(point, sides, &slide)
        } else {
            R::ZERO
        }
    }

    /// Returns the error in the velocity of the farthest point, m/s, of a contact whose friction
    /// law varies along its path.
    ///
    /// A jump of the law within the step has the same effect as a reversal of the slip. It is
    /// located to a part of the step, so the error is known to a fraction of itself.
    #[inline(never)]
    fn varying_friction_error(
        &self,
        point: &ContactPoint<R>,
        sides: &[ContactEnd<R>; 2],
        slide: &Slide<R>,
    ) -> R {
        let part = |index: u32| R::from_f64(f64::from(index) / f64::from(FRICTION_PARTS));
        let load = sides[0].normal_force.at_least(sides[1].normal_force);
        let friction = self.scene.friction();
        let at = |share: R| friction.force_at(slide.position(share), load, slide.slip);
        let start = at(R::ZERO);
        if (1..=FRICTION_PARTS).all(|index| at(part(index)) == start) {
            return R::ZERO;
        }
        let path = Path::between(&sides[0], &sides[1], self.seconds);
        let force = |share: R| self.friction_on(&path, slide, share);
        let mut truth = R::Vec3::ZERO;
        for index in 0..FRICTION_PARTS {
            truth += integral_of_3(force, part(index), part(index + 1));
        }
        self.velocity_by_impulse(
            point,
            (truth - self.friction_of_stages(point)) * self.seconds,
        )
    }

    /// Returns the friction of the contact at a fraction of the step, N.
    #[inline]
    fn friction_on(&self, path: &Path<R>, slide: &Slide<R>, share: R) -> R::Vec3 {
        let (depth, slope) = path.at(share);
        let normal_force = push(self.scene, depth, slope / self.seconds);
        let (position, slip) = (slide.position(share), slide.slip(share));
        (self.scene.friction()).force_at(position, normal_force, slip)
    }

    /// Returns the error in the velocity of the farthest point, m/s, if the slip is smallest at the
    /// fraction `share` of the step.
    #[inline(never)]
    fn reversal_error(
        &self,
        point: &ContactPoint<R>,
        [start, end]: &[ContactEnd<R>; 2],
        slide: &Slide<R>,
        share: R,
    ) -> R {
        let path = Path::between(start, end, self.seconds);
        let force = |share: R| self.friction_on(&path, slide, share);
        let about = R::from_f64(tuning::REVERSAL);
        let from = (share - about).at_least(R::ZERO).at_most(R::ONE);
        let to = (share + about).at_least(R::ZERO).at_most(R::ONE);
        let about = (force(to) - force(from)).length();
        let steadily = (force(R::ONE) - force(R::ZERO)).length() * (to - from);
        if about <= steadily * R::from_f64(tuning::SUDDEN) {
            return R::ZERO;
        }
        // Each side of the reversal is smooth.
        let truth = integral_of_3(force, R::ZERO, share) + integral_of_3(force, share, R::ONE);
        let impulse = (truth - self.friction_of_stages(point)) * self.seconds;
        self.velocity_by_impulse(point, impulse)
    }

    /// Returns the mean friction of the contact as the method has summed it, N.
    fn friction_of_stages(&self, point: &ContactPoint<R>) -> R::Vec3 {
        let mut sum = R::Vec3::ZERO;
        for (motion, weight) in self.weighted_motions() {
            let arm = arm(self.scene, motion, point);
            let (position, slip) = (motion.position + arm.0, slip(self.scene, motion, arm));
            let normal_force = ContactEnd::of(self.scene, motion, point).normal_force;
            sum += (self.scene.friction()).force_at(position, normal_force, slip) * weight;
        }
        sum
    }

    /// Returns the velocity of the farthest point of the body for an impulse at a contact, m/s.
    fn velocity_by_impulse(&self, point: &ContactPoint<R>, impulse: R::Vec3) -> R {
        let motion = self.ends[1];
        let mass = self.scene.inertia_properties();
        let (arm, _) = arm(self.scene, motion, point);
        let spin = mass.angular_velocity(&motion.axes, arm.cross(impulse));
        impulse.length() * mass.inverse_mass() + spin.length() * size(self.scene)
    }
}
