//! One contact that touches: its geometry, its velocity and its force.

use super::moving::MovingContact;
use crate::body::{ContactPoint, RigidPointBody};
use crate::friction::{LawOfSurface, SlidingFriction};
use crate::ground::{OneSurface, SpringDamperGround};
use crate::real::{Real, Vector};
use crate::rotation::Axes;
use crate::state::Motion;

/// Contact that touches, with position, penetration depth and velocity, world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<R: Real = f64> {
    /// Contact as defined by the body.
    pub point: ContactPoint<R>,
    /// Index of the surface that it touches; 0 if the ground is one surface.
    pub surface: usize,
    /// Position of the point at which the force acts, m.
    pub position: R::Vec3,
    /// Vector from the centre of mass to the point at which the force acts, m.
    pub arm: R::Vec3,
    /// Outward normal of the ground, unit vector.
    pub normal: R::Vec3,
    /// Penetration depth, m, above 0.
    pub depth: R,
    /// Rate of increase of the penetration depth, m/s.
    pub closing_speed: R,
    /// Velocity along the surface, relative to the ground, m/s.
    pub slip_velocity: R::Vec3,
    /// Number of contacts of the body that it represents: 1, except for a quadrature point of a
    /// [`Rim`](crate::Rim).
    pub weight: R,
}

impl<R: Real> Contact<R> {
    /// Contact of `point` with a surface, if it touches.
    #[inline]
    pub(super) fn at<B: RigidPointBody<R>, G: SpringDamperGround<R>>(
        body: &B,
        ground: &OneSurface<'_, G>,
        motion: &Motion<R>,
        point: &ContactPoint<R>,
    ) -> Option<Self> {
        let facing;
        let point = match MovingContact::of(body) {
            Some(moving) => {
                facing = moving.above(ground, motion.position, &motion.axes);
                &facing
            }
            None => point,
        };
        Self::of(ground, motion, point, R::ONE)
    }

    /// Contact of a fixed `point` with a surface, if it touches.
    #[inline]
    pub(super) fn of<G: SpringDamperGround<R>>(
        ground: &OneSurface<'_, G>,
        motion: &Motion<R>,
        point: &ContactPoint<R>,
        weight: R,
    ) -> Option<Self> {
        let centre_arm = motion.axes.to_world(point.position);
        let centre = motion.position + centre_arm;
        let under = ground.surface_under(centre, point.radius)?;
        let depth = point.radius - under.gap;
        (depth > R::ZERO).then(|| {
            let normal = under.normal;
            let arm = surface_arm(point, centre_arm, normal);
            let velocity = motion.velocity_at(arm);
            let rising = velocity.dot(normal);
            Self {
                point: *point,
                surface: ground.index(),
                position: surface_arm(point, centre, normal),
                arm,
                normal,
                depth,
                closing_speed: -rising,
                slip_velocity: velocity - normal * rising,
                weight,
            }
        })
    }

    /// Arm of the same contact for a body with other axes.
    #[inline]
    pub(crate) fn arm_along(&self, axes: &Axes<R>) -> R::Vec3 {
        let centre_arm = axes.to_world(self.point.position);
        surface_arm(&self.point, centre_arm, self.normal)
    }

    /// Displacement of the point at which the force acts, per rotation of the body about each world
    /// axis, m. The centre of mass stays.
    ///
    /// The point below the centre of a ball is not carried along. That of a smooth body moves over
    /// its surface too.
    pub(crate) fn arm_by_turn<B: RigidPointBody<R>>(
        &self,
        body: &B,
        axes: &Axes<R>,
    ) -> [R::Vec3; 3] {
        let (o, i) = (R::ZERO, R::ONE);
        let turns = [[i, o, o], [o, i, o], [o, o, i]].map(|[x, y, z]| R::Vec3::new(x, y, z));
        let carried = self.arm + self.normal * self.point.radius;
        let Some(moving) = MovingContact::of(body) else {
            return turns.map(|turn| turn.cross(carried));
        };
        let nudge = R::EPSILON.sqrt();
        // Where the search for the normal has ended early, the arm belongs to another one.
        let here = moving.towards(-self.normal, axes);
        turns.map(|turn| {
            let towards = turn.cross(self.normal) * nudge - self.normal;
            let moved = moving.towards(towards, axes) - here;
            turn.cross(self.arm) + moved * (R::ONE / nudge)
        })
    }

    /// Laws of the surface that the contact touches.
    #[inline(always)]
    pub(crate) fn laws<'a, G, F>(
        &self,
        ground: &'a G,
        friction: &'a F,
    ) -> (OneSurface<'a, G>, LawOfSurface<'a, F>)
    where
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        (
            OneSurface::of(ground, self.surface),
            LawOfSurface::of(friction, self.surface),
        )
    }

    /// Force of the ground on the body at this contact, normal and friction together, N.
    #[inline]
    #[must_use]
    pub fn force<G, F>(&self, ground: &G, friction: &F) -> R::Vec3
    where
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        let (ground, friction) = self.laws::<G, F>(ground, friction);
        let normal_force = ground.normal_force(self.depth, self.closing_speed);
        let rub = friction.force_at(self.position, normal_force, self.slip_velocity);
        (self.normal * normal_force + rub) * self.weight
    }

    /// Torque of rolling resistance on a body that rotates relative to the ground (rad/s), in
    /// addition to that of the force, N m.
    ///
    /// It is 0 unless the friction law has rolling resistance.
    #[inline]
    #[must_use]
    pub fn turning_torque<G, F>(
        &self,
        ground: &G,
        friction: &F,
        angular_velocity: R::Vec3,
    ) -> R::Vec3
    where
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
    {
        let (ground, friction) = self.laws::<G, F>(ground, friction);
        let normal_force = ground.normal_force(self.depth, self.closing_speed);
        match friction.rolling_resistance_at(self.position, normal_force) {
            Some(resistance) => resistance.torque(self.normal, angular_velocity) * self.weight,
            None => R::Vec3::ZERO,
        }
    }
}

/// Vector from the centre of mass to the point of a contact's surface that faces the ground, m,
/// world axes.
#[inline]
fn surface_arm<R: Real>(point: &ContactPoint<R>, centre_arm: R::Vec3, normal: R::Vec3) -> R::Vec3 {
    // A bare point, the most frequent case, needs no arithmetic.
    if point.radius == R::ZERO {
        centre_arm
    } else {
        centre_arm - normal * point.radius
    }
}
