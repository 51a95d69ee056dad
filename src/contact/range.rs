//! Which contacts can touch: a range that includes all of them, from the body's hint.

use super::model::ContactModel;
use crate::body::{ContactRange, RigidPointBody};
use crate::friction::SlidingFriction;
use crate::ground::{GroundBounds, OneSurface, SpringDamperGround};
use crate::real::{Real, Vector};
use crate::rotation::Axes;
use crate::state::Motion;

impl<R, B, G, F> ContactModel<'_, B, G, F, R>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
{
    /// Contact range that includes every contact less than `margin` (m) above the ground.
    ///
    /// In flight no contact is evaluated to compute it.
    #[inline(always)]
    #[must_use]
    pub fn range_within(&self, margin: R, position: R::Vec3, axes: &Axes<R>) -> ContactRange {
        self.low_contacts(margin, position, axes, |normal, offset| {
            self.body.contacts_below(normal, offset)
        })
    }

    /// Contact range that includes every touching contact, found faster from a previous range
    /// `near`.
    ///
    /// It equals that of [`range_within`](Self::range_within) with a margin of 0, for every value
    /// of `near`.
    #[inline(always)]
    #[must_use]
    pub fn range_near(
        &self,
        near: ContactRange,
        position: R::Vec3,
        axes: &Axes<R>,
    ) -> ContactRange {
        self.low_contacts(R::ZERO, position, axes, |normal, offset| {
            self.body.contacts_below_near(normal, offset, near)
        })
    }

    #[inline(always)]
    fn low_contacts(
        &self,
        margin: R,
        position: R::Vec3,
        axes: &Axes<R>,
        below: impl FnOnce(R::Vec3, R) -> ContactRange,
    ) -> ContactRange {
        if self.ground.surfaces().is_some() {
            return self.range_of_all_surfaces(margin, position, axes);
        }
        self.low_contacts_of(self.ground.bounds(), margin, position, axes, below)
    }

    /// Contact range that includes every contact less than `margin` (m) above any of several
    /// surfaces: all contacts, or none, because several ranges are not one range.
    #[cold]
    #[inline(never)]
    fn range_of_all_surfaces(&self, margin: R, position: R::Vec3, axes: &Axes<R>) -> ContactRange {
        let is_near = |surface| self.range_of_surface(surface, margin, position, axes).count > 0;
        if (0..self.surfaces()).any(is_near) {
            ContactRange::all(self.body.contacts().len())
        } else {
            ContactRange::NONE
        }
    }

    /// Contact range that includes every contact less than `margin` (m) above one surface.
    #[inline]
    pub(crate) fn range_of_surface(
        &self,
        surface: usize,
        margin: R,
        position: R::Vec3,
        axes: &Axes<R>,
    ) -> ContactRange {
        let bounds = OneSurface::of(self.ground, surface).bounds();
        self.low_contacts_of(bounds, margin, position, axes, |normal, offset| {
            self.body.contacts_below(normal, offset)
        })
    }

    #[inline(always)]
    fn low_contacts_of(
        &self,
        bounds: GroundBounds<R>,
        margin: R,
        position: R::Vec3,
        axes: &Axes<R>,
        below: impl FnOnce(R::Vec3, R) -> ContactRange,
    ) -> ContactRange {
        match bounds {
            GroundBounds::Nowhere => ContactRange::NONE,
            GroundBounds::Everywhere => ContactRange::all(self.body.contacts().len()),
            GroundBounds::Plane(plane) | GroundBounds::Below(plane) => {
                let (gap, size, normal) = if plane.is_level() {
                    let gap = position.z() - plane.height;
                    (gap, gap.abs(), axes.rise())
                } else {
                    // The gap is the sum of numbers as large as the horizontal position.
                    let size = position.length();
                    (plane.gap(position), size, axes.to_body(plane.normal))
                };
                let offset = self.offset(margin, size + plane.height.abs(), gap);
                if offset < -self.extent.bounding_radius {
                    ContactRange::NONE
                } else {
                    below(normal, offset)
                }
            }
        }
    }

    /// Offset of the plane, along its normal from the centre of mass, below which contacts are less
    /// than `margin` above it, m. `gap` is that of the centre of mass, and `size` that of the
    /// numbers in it.
    #[inline(always)]
    pub(super) fn offset(&self, margin: R, size: R, gap: R) -> R {
        // Bound of the rounding of a gap, far larger than the rounding of the body's own
        // arithmetic.
        let size = size + self.extent.bounding_radius;
        let rounding = size * (R::EPSILON * R::from_f64(8.0));
        margin + rounding - gap
    }

    /// Height of a level plane that the whole ground is below.
    #[inline(always)]
    pub(super) fn height_of_bound(&self) -> Option<R> {
        match self.ground.bounds() {
            GroundBounds::Plane(plane) | GroundBounds::Below(plane)
                if plane.is_level() && self.ground.surfaces().is_none() =>
            {
                Some(plane.height)
            }
            _ => None,
        }
    }

    /// Returns true if a body is so high above a plane that no part of it touches.
    #[inline]
    pub(super) fn is_aloft(&self, motion: &Motion<R>) -> bool {
        let is_above = |surface| match OneSurface::of(self.ground, surface).bounds() {
            GroundBounds::Nowhere => true,
            GroundBounds::Plane(plane) | GroundBounds::Below(plane) => {
                plane.gap(motion.position) > self.extent.bounding_radius
            }
            GroundBounds::Everywhere => false,
        };
        (0..self.surfaces()).all(is_above)
    }
}
