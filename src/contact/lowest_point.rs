//! The point of a body that is lowest above the ground.

use super::model::ContactModel;
use super::point::facing_ground;
use super::rims;
use crate::body::{ContactPoint, RigidPointBody};
use crate::friction::SlidingFriction;
use crate::ground::{OneSurface, SpringDamperGround};
use crate::real::{Real, Vector};
use crate::state::Motion;

/// Lowest point of a body's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowestPoint<R: Real = f64> {
    /// Number of its contact. Rims are numbered after the last contact.
    pub index: usize,
    /// Position, m, world axes.
    pub position: R::Vec3,
    /// Height above the ground, m, negative below ground.
    pub gap: R,
    /// Velocity of the body's material at the point, along the surface and relative to the ground,
    /// m/s.
    pub slip: R::Vec3,
}

impl<R, B, G, F> ContactModel<'_, B, G, F, R>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
{
    /// Returns the point of the body's surface that is lowest above the ground, or deepest below
    /// it. Returns `None` for a body without contacts.
    #[must_use]
    pub fn lowest_point(&self, motion: &Motion<R>) -> Option<LowestPoint<R>> {
        let Motion { position, axes, .. } = motion;
        let contacts = self.body.contacts();
        let mut lowest: Option<LowestPoint<R>> = None;
        for surface in 0..self.surfaces() {
            let ground = OneSurface::of(self.ground, surface);
            let mut look_at = |index: usize, point: &ContactPoint<R>| {
                let candidate = self.surface_point(&ground, index, point, motion);
                if lowest.is_none_or(|known| candidate.gap < known.gap) {
                    lowest = Some(candidate);
                }
            };
            for (index, point) in contacts.iter().enumerate() {
                if self.body.is_smooth() {
                    let facing = facing_ground(self.body, &ground, *position, axes);
                    look_at(index, &facing);
                } else {
                    look_at(index, point);
                }
            }
            for (number, rim) in self.body.rims().iter().enumerate() {
                let place = rims::lowest(rim, &ground, *position, axes);
                look_at(contacts.len() + number, &ContactPoint::bare(place));
            }
        }
        lowest
    }

    /// Point of a contact's surface that faces the ground.
    fn surface_point(
        &self,
        ground: &OneSurface<'_, G>,
        index: usize,
        point: &ContactPoint<R>,
        motion: &Motion<R>,
    ) -> LowestPoint<R> {
        let centre = motion.position + motion.axes.to_world(point.position);
        let surface = ground.surface(centre);
        let position = centre - surface.normal * point.radius;
        let velocity = self.seen(motion).velocity_at(position - motion.position);
        LowestPoint {
            index,
            position,
            gap: surface.gap - point.radius,
            slip: velocity - surface.normal * velocity.dot(surface.normal),
        }
    }
}
