//! The point of a body that is lowest above the ground.

use super::invariants;
use super::model::ContactModel;
use super::rims;
use crate::body::{ContactPoint, ContactRange, RigidPointBody};
use crate::friction::SlidingFriction;
use crate::ground::{OneSurface, SpringDamperGround};
use crate::real::{Real, Vector};
use crate::state::Motion;

/// Lowest point of a body's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowestPoint<R: Real = f64> {
    /// Number of the contact that is lowest. Rims are numbered after the last contact.
    pub index: usize,
    /// Position, m, world axes.
    pub position: R::Vec3,
    /// Height above the ground, m, negative below ground. In a scene without ground it is the
    /// largest number.
    pub gap: R,
    /// Velocity of the body's material at the point, along the surface and relative to the ground,
    /// m/s, world axes.
    pub slip_velocity: R::Vec3,
}

/// A point of the body's surface that may be the lowest one above a surface of the ground.
struct Candidate<R: Real> {
    index: usize,
    point: ContactPoint<R>,
    surface: usize,
    gap: R,
}

impl<R: Real> Candidate<R> {
    /// Returns the lower of two candidates, and of two at the same height the first in the body.
    fn or_lower(self, other: Self) -> Self {
        let is_before = self.gap > other.gap || (self.gap == other.gap && self.index > other.index);
        if is_before { other } else { self }
    }
}

impl<R, B, G, F> ContactModel<'_, B, G, F, R>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
{
    /// Returns the point of the body's surface that is lowest above the ground, or deepest below
    /// it. Returns `None` for a body without contacts and rims.
    ///
    /// The body's [`contacts_below`](RigidPointBody::contacts_below) leads the search, so that a
    /// ring of any number of points costs a few of them.
    #[must_use]
    pub fn lowest_point(&self, motion: &Motion<R>) -> Option<LowestPoint<R>> {
        let mut lowest: Option<Candidate<R>> = None;
        for surface in 0..self.surfaces() {
            let contact = self.lowest_contact(surface, motion);
            for candidate in contact
                .into_iter()
                .chain(self.lowest_of_rims(surface, motion))
            {
                if lowest
                    .as_ref()
                    .is_none_or(|known| candidate.gap < known.gap)
                {
                    lowest = Some(candidate);
                }
            }
        }
        lowest.map(|found| self.surface_point(&found, motion))
    }

    /// Lowest contact above one surface.
    ///
    /// The contacts below a contact in the middle of a range are another range that contains the
    /// lowest one. It is shorter until only the lowest ones are left.
    fn lowest_contact(&self, surface: usize, motion: &Motion<R>) -> Option<Candidate<R>> {
        let contacts = self.body.contacts();
        let first = contacts.first()?;
        if let Some(moving) = self.moving_contact() {
            let ground = OneSurface::of(self.ground, surface);
            let facing = moving.above(&ground, motion.position, &motion.axes);
            return Some(self.candidate(surface, 0, &facing, motion));
        }
        let mut lowest = self.candidate(surface, 0, first, motion);
        let mut range = ContactRange::all(contacts.len());
        while range.count > 1 {
            let below = self.range_of_surface(surface, lowest.gap, motion.position, &motion.axes);
            if below.count >= range.count {
                break;
            }
            range = below.within(contacts.len());
            let middle = (range.first + range.count / 2) % contacts.len();
            if let Some(point) = contacts.get(middle) {
                lowest = lowest.or_lower(self.candidate(surface, middle, point, motion));
            }
        }
        let numbered = contacts.iter().enumerate();
        let behind = numbered.clone().skip(range.first).chain(numbered);
        Some(
            behind
                .take(range.count)
                .fold(lowest, |lowest, (index, point)| {
                    lowest.or_lower(self.candidate(surface, index, point, motion))
                }),
        )
    }

    /// Lowest point of each rim above one surface.
    fn lowest_of_rims(
        &self,
        surface: usize,
        motion: &Motion<R>,
    ) -> impl Iterator<Item = Candidate<R>> {
        let ground = OneSurface::of(self.ground, surface);
        let contacts = self.body.contacts().len();
        let rims = self.body.rims().iter().enumerate();
        rims.map(move |(number, rim)| {
            let place = rims::lowest(rim, &ground, motion.position, &motion.axes);
            let point = ContactPoint::bare(place);
            self.candidate(surface, contacts + number, &point, motion)
        })
    }

    /// A contact above one surface.
    fn candidate(
        &self,
        surface: usize,
        index: usize,
        point: &ContactPoint<R>,
        motion: &Motion<R>,
    ) -> Candidate<R> {
        let centre = motion.position + motion.axes.to_world(point.position);
        let ground = OneSurface::of(self.ground, surface);
        Candidate {
            index,
            point: *point,
            surface,
            gap: ground.surface(centre).gap - point.radius,
        }
    }

    /// Point of a contact's surface that faces the ground.
    fn surface_point(&self, found: &Candidate<R>, motion: &Motion<R>) -> LowestPoint<R> {
        let centre = motion.position + motion.axes.to_world(found.point.position);
        let surface = OneSurface::of(self.ground, found.surface).surface(centre);
        let position = centre - surface.normal * found.point.radius;
        let velocity = self.seen(motion).velocity_at(position - motion.position);
        let rising = velocity.dot(surface.normal);
        let slip_velocity = velocity - surface.normal * rising;
        debug_assert!(invariants::slips_along(
            slip_velocity,
            surface.normal,
            rising
        ));
        LowestPoint {
            index: found.index,
            position,
            gap: found.gap,
            slip_velocity,
        }
    }
}
