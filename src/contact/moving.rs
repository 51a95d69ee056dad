//! The contact of a smooth body, which moves over its surface as the body rotates.

use core::marker::PhantomData;

use crate::body::{ContactPoint, RigidPointBody};
use crate::ground::SpringDamperGround;
use crate::real::{Real, Vector};
use crate::rotation::Axes;

/// Contact that moves over the surface of a smooth body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MovingContact<'a, B, R> {
    body: &'a B,
    numbers: PhantomData<R>,
}

impl<'a, B: RigidPointBody<R>, R: Real> MovingContact<'a, B, R> {
    /// Moving contact of a body, or `None` if its contacts are fixed in it.
    #[inline(always)]
    pub(super) fn of(body: &'a B) -> Option<Self> {
        let moving = Self {
            body,
            numbers: PhantomData,
        };
        body.is_smooth().then_some(moving)
    }

    /// Point of the body that faces the ground, as a bare contact for a pose of the body: the
    /// ground's normal at the point is opposite to the body's.
    ///
    /// There the gap has a derivative by the pose as on the tangent plane, because the point is the
    /// lowest one over that plane. So the force of the springs has a potential.
    ///
    /// The search begins with the normal under the contact that represents the body, and goes on to
    /// that at the point for the normal before. The difference of two normals is multiplied each
    /// time by the ratio of the radii of curvature of body and ground. Where it does not decrease,
    /// the ground has an edge or is as curved as the body, and the first point is taken.
    #[inline]
    pub(crate) fn above<G: SpringDamperGround<R>>(
        &self,
        ground: &G,
        position: R::Vec3,
        axes: &Axes<R>,
    ) -> ContactPoint<R> {
        let middle = self.body.contacts().first().copied().unwrap_or_default();
        let normal_at = |point: R::Vec3| ground.surface(position + axes.to_world(point)).normal;
        let facing = |normal: R::Vec3| self.body.support_point(axes.to_body(-normal));
        let mut normal = normal_at(middle.position);
        let first = facing(normal);
        let (mut point, mut last) = (first, R::MAX);
        for _ in 0..SEARCHES {
            let there = normal_at(point);
            let change = (there - normal).length_squared();
            if change >= last && change > R::EPSILON {
                return ContactPoint::bare(first);
            }
            // What is left is rounding, or small against the force.
            if change >= last || change <= R::EPSILON * R::EPSILON.sqrt() {
                break;
            }
            (normal, last) = (there, change);
            point = facing(normal);
        }
        ContactPoint::bare(point)
    }

    /// Vector from the centre of mass to the point of the surface that is farthest in a direction,
    /// m, world axes.
    #[inline]
    pub(super) fn towards(&self, direction: R::Vec3, axes: &Axes<R>) -> R::Vec3 {
        axes.to_world(self.body.support_point(axes.to_body(direction)))
    }

    /// Displacement of the contact point over the surface by a rotation ϑ of the body, on a plane
    /// with this normal: `moved` times `turn · ϑ`, for each of the two pairs, m.
    pub(crate) fn over_surface(&self, normal: R::Vec3, axes: &Axes<R>) -> [(R::Vec3, R::Vec3); 2] {
        let nudge = R::EPSILON.sqrt();
        let first = any_across::<R>(normal);
        let here = self.towards(-normal, axes);
        let pair = |along: R::Vec3| {
            let there = self.towards(along * nudge - normal, axes);
            ((there - here) * (R::ONE / nudge), normal.cross(along))
        };
        [pair(first), pair(normal.cross(first))]
    }
}

/// Most searches for the normal at a contact. On ground that is three times less curved than the
/// body, these many are enough for an angle of 2e-12 in `f64`.
const SEARCHES: u32 = 26;

/// A unit vector at right angles to the given one.
fn any_across<R: Real>(normal: R::Vec3) -> R::Vec3 {
    let o = R::ZERO;
    let other = if normal.x().abs() < R::HALF {
        R::Vec3::new(R::ONE, o, o)
    } else {
        R::Vec3::new(o, R::ONE, o)
    };
    let across = normal.cross(other);
    let length = across.length();
    if length > R::ZERO {
        across * (R::ONE / length)
    } else {
        R::Vec3::ZERO
    }
}
