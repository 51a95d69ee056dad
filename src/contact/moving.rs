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

    /// Point of the body that faces the ground, as a bare contact for a pose of the body. The
    /// normal is that under the contact which represents the body.
    #[inline]
    pub(crate) fn above<G: SpringDamperGround<R>>(
        &self,
        ground: &G,
        position: R::Vec3,
        axes: &Axes<R>,
    ) -> ContactPoint<R> {
        let middle = self.body.contacts().first().copied().unwrap_or_default();
        let surface = ground.surface(position + axes.to_world(middle.position));
        ContactPoint::bare(self.body.support_point(axes.to_body(-surface.normal)))
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
