//! The kinds of body and ground, as questions of mechanics.
//!
//! The contacts of a body are points and balls that are fixed in it, or one contact that moves over
//! a smooth surface. Rims may touch in addition to fixed contacts. A surface of the ground is a
//! plane, or is nowhere above one, or may be anywhere, or nowhere. An integrator does not ask for a
//! kind, but for what follows from it.
//!
//! The type of a body decides the answers about its contacts, so that the compiler leaves out what
//! the body does not need.

use super::model::ContactModel;
use super::moving::MovingContact;
use super::point::Contact;
use crate::body::{ContactPoint, RigidPointBody, Rim};
use crate::friction::SlidingFriction;
use crate::ground::{GroundBounds, OneSurface, Plane, SpringDamperGround};
use crate::real::{Real, Vector};
use crate::rotation::Axes;

impl<'a, R, B, G, F> ContactModel<'a, B, G, F, R>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
{
    /// Contact that moves over the surface of the body as the body rotates. `None` if the contacts
    /// are fixed in the body.
    #[inline(always)]
    pub(crate) fn moving_contact(&self) -> Option<MovingContact<'a, B, R>> {
        MovingContact::of(self.body)
    }

    /// Contact of the body at a pose above a ground: `point` itself if it is fixed in the body, or
    /// the moving contact.
    #[inline(always)]
    pub(crate) fn contact_above(
        &self,
        ground: &impl SpringDamperGround<R>,
        (position, axes): (R::Vec3, &Axes<R>),
        point: &ContactPoint<R>,
    ) -> ContactPoint<R> {
        match self.moving_contact() {
            Some(moving) => moving.above(ground, position, axes),
            None => *point,
        }
    }

    /// Number that identifies a contact on its surface of the ground. A moving contact keeps it.
    #[inline]
    pub(crate) fn identity_of(&self, contact: &Contact<R>) -> u64 {
        let number = match self.moving_contact() {
            Some(_) => 1,
            None => checksum(contact),
        };
        number.wrapping_add((contact.surface as u64) << 8)
    }

    /// Returns true if the body has rims, which touch along an arc.
    #[inline(always)]
    pub(crate) fn has_rims(&self) -> bool {
        !self.body.rims().is_empty()
    }

    /// Returns true if a rim may be less than `margin` (m) above a plane.
    #[inline(always)]
    fn has_rim_within(
        &self,
        margin: R,
        plane: &Plane<R>,
        (position, axes): (R::Vec3, &Axes<R>),
    ) -> bool {
        let is_near = |rim: &Rim<R>| {
            let lowest = rim.support(-axes.to_body(plane.normal));
            plane.gap(position) - lowest <= margin
        };
        self.body.rims().iter().any(is_near)
    }

    /// Returns true if a rim may be less than `margin` (m) above one surface of the ground.
    #[inline]
    pub(crate) fn has_rim_near(
        &self,
        surface: usize,
        margin: R,
        pose: (R::Vec3, &Axes<R>),
    ) -> bool {
        if !self.has_rims() || self.is_nowhere(surface) {
            return false;
        }
        let plane = self.plane_above(surface);
        plane.is_none_or(|plane| self.has_rim_within(margin, &plane, pose))
    }

    /// The ground, if it is one plane.
    #[inline(always)]
    pub(crate) fn plane(&self) -> Option<Plane<R>> {
        match self.ground.bounds() {
            GroundBounds::Plane(plane) => Some(plane),
            _ => None,
        }
    }

    /// One surface of the ground, if it is a plane.
    #[inline(always)]
    pub(crate) fn plane_of(&self, surface: usize) -> Option<Plane<R>> {
        match self.bounds_of(surface) {
            GroundBounds::Plane(plane) => Some(plane),
            _ => None,
        }
    }

    /// Plane that no point of a surface is above. `None` if the surface is nowhere, or may be
    /// anywhere.
    #[inline(always)]
    pub(crate) fn plane_above(&self, surface: usize) -> Option<Plane<R>> {
        match self.bounds_of(surface) {
            GroundBounds::Plane(plane) | GroundBounds::Below(plane) => Some(plane),
            GroundBounds::Nowhere | GroundBounds::Everywhere => None,
        }
    }

    /// Returns true if a contact may touch a surface at any height of the body.
    #[inline(always)]
    pub(crate) fn is_unbounded(&self, surface: usize) -> bool {
        matches!(self.bounds_of(surface), GroundBounds::Everywhere)
    }

    /// Returns true if no contact touches a surface at any pose.
    #[inline(always)]
    pub(crate) fn is_nowhere(&self, surface: usize) -> bool {
        matches!(self.bounds_of(surface), GroundBounds::Nowhere)
    }

    /// The ground, if it is a plane and the contacts are fixed in the body. Penetration depth and
    /// closing speed are then linear in the position of a contact in the body.
    #[inline(always)]
    pub(crate) fn plane_under_fixed_contacts(&self) -> Option<Plane<R>> {
        match self.moving_contact() {
            Some(_) => None,
            None => self.plane(),
        }
    }

    /// Height of a ground that is a level plane, if all contacts are bare points of the body.
    #[inline(always)]
    pub(super) fn height_under_bare_points(&self) -> Option<R> {
        match self.ground.bounds() {
            GroundBounds::Plane(plane) if self.has_bare_points() && plane.is_level() => {
                Some(plane.height)
            }
            _ => None,
        }
    }

    /// Returns true if all contacts are bare points of the body, which touch at their own position.
    #[inline(always)]
    pub(crate) fn has_bare_points(&self) -> bool {
        !self.extent.has_radii
    }

    #[inline(always)]
    fn bounds_of(&self, surface: usize) -> GroundBounds<R> {
        OneSurface::of(self.ground, surface).bounds()
    }
}

/// Checksum of the position of a contact in the body, above 0. It is different for each contact.
fn checksum<R: Real>(contact: &Contact<R>) -> u64 {
    let position = contact.point.position;
    let mut sum = 0_u64;
    for number in [position.x(), position.y(), position.z()] {
        sum = (sum ^ number.to_f64().to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        sum ^= sum >> 32;
    }
    sum | 1
}
