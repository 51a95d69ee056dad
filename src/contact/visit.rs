//! A visit to each contact that touches, on the points of a body and on its rims.

use super::invariants;
use super::model::ContactModel;
use super::point::Contact;
use super::rims::{self, Touching};
use crate::body::{ContactRange, RigidPointBody};
use crate::friction::SlidingFriction;
use crate::ground::{OneSurface, SpringDamperGround};
use crate::real::Real;
use crate::state::Motion;

/// How the force of a contact begins when it touches down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Onset {
    /// With the jump of the damper's force.
    Sudden,
    /// From 0, with the part of a rim that is below ground.
    Gradual,
}

/// What is done with each contact that touches.
///
/// A closure is a visitor. A type of its own can force the compiler to inline its method, which a
/// closure cannot.
pub(super) trait Visitor<R: Real> {
    /// Enters a contact.
    fn enter(&mut self, contact: &Contact<R>);
}

impl<R: Real, V: FnMut(&Contact<R>)> Visitor<R> for V {
    #[inline(always)]
    fn enter(&mut self, contact: &Contact<R>) {
        self(contact);
    }
}

// The inlining hints here and in `total_load` make the compiler treat a step as one piece, without
// passing data between stages through memory. The loop over contacts as a separate function took
// 8 % fewer instructions and 1.2 to 1.8 times as long.
impl<R, B, G, F> ContactModel<'_, B, G, F, R>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
{
    /// Calls `visit` with each contact that touches, in the order of the contact range.
    #[inline(always)]
    pub fn visit(&self, motion: &Motion<R>, visit: impl FnMut(&Contact<R>)) {
        let range = self.range_within(R::ZERO, motion.position, &motion.axes);
        self.visit_on(range, motion, visit);
    }

    /// Calls `visit` with each contact in `range` that touches, and with the quadrature points of
    /// the rims.
    #[inline(always)]
    pub(super) fn visit_on(
        &self,
        range: ContactRange,
        motion: &Motion<R>,
        mut visitor: impl Visitor<R>,
    ) {
        self.visit_points_with(range, motion, &mut visitor);
        if !self.body.rims().is_empty() {
            self.visit_rims(motion, &mut |contact| visitor.enter(contact));
        }
    }

    /// Number of contact points that touch, without the quadrature points of rims.
    #[cold]
    pub(crate) fn touching_points(&self, motion: &Motion<R>) -> usize {
        let range = self.range_within(R::ZERO, motion.position, &motion.axes);
        let mut count = 0;
        self.visit_points(range, motion, &mut |_| count += 1);
        count
    }

    /// Calls `visit` with each contact point in `range` that touches, without the quadrature points
    /// of a rim.
    #[inline(always)]
    pub(super) fn visit_points(
        &self,
        range: ContactRange,
        motion: &Motion<R>,
        visit: &mut impl FnMut(&Contact<R>),
    ) {
        self.visit_points_with(range, motion, visit);
    }

    #[inline(always)]
    fn visit_points_with(
        &self,
        range: ContactRange,
        motion: &Motion<R>,
        visitor: &mut impl Visitor<R>,
    ) {
        if self.ground_moves() {
            self.visit_seen(range, &self.seen(motion), visitor);
        } else {
            self.visit_seen(range, motion, visitor);
        }
    }

    /// Visits the contacts of the motion relative to the ground's material.
    #[inline(always)]
    fn visit_seen(&self, range: ContactRange, motion: &Motion<R>, visitor: &mut impl Visitor<R>) {
        if self.ground.surfaces().is_none() {
            self.visit_on_surface(0, range, motion, visitor);
        } else if range.count > 0 {
            self.visit_each_surface(motion, visitor);
        }
    }

    /// Visits the contacts with each of several surfaces, which has its own contact range.
    #[cold]
    #[inline(never)]
    fn visit_each_surface(&self, motion: &Motion<R>, visitor: &mut dyn Visitor<R>) {
        for surface in 0..self.surfaces() {
            let range = self.range_of_surface(surface, R::ZERO, motion.position, &motion.axes);
            let visit = &mut |contact: &Contact<R>| visitor.enter(contact);
            self.visit_on_surface(surface, range, motion, visit);
        }
    }

    #[inline(always)]
    fn visit_on_surface(
        &self,
        surface: usize,
        range: ContactRange,
        motion: &Motion<R>,
        visitor: &mut impl Visitor<R>,
    ) {
        let ground = OneSurface::of(self.ground, surface);
        let contacts = self.body.contacts();
        // One loop for both parts of a range that continues at the first contact, so that the
        // visitor is compiled once.
        let mut ahead = contacts.get(range.first..).unwrap_or_default().iter();
        for _ in 0..range.count.min(contacts.len()) {
            let Some(point) = ahead.next().or_else(|| {
                ahead = contacts.iter();
                ahead.next()
            }) else {
                break;
            };
            if let Some(contact) = Contact::at(self.body, &ground, motion, point) {
                debug_assert!(invariants::touches(&contact, self.surfaces()));
                visitor.enter(&contact);
            }
        }
    }

    /// Calls `visit` with each contact that touches, and whether its force begins with a jump when
    /// it touches down.
    ///
    /// The points of a rim touch one after the other, so that the force of the rim has no jump.
    #[inline(always)]
    pub(crate) fn visit_with_onsets(
        &self,
        motion: &Motion<R>,
        visit: &mut impl FnMut(&Contact<R>, Onset),
    ) {
        let range = self.range_within(R::ZERO, motion.position, &motion.axes);
        self.visit_points(range, motion, &mut |contact: &Contact<R>| {
            visit(contact, Onset::Sudden);
        });
        self.visit_rims(motion, &mut |contact| visit(contact, Onset::Gradual));
    }

    /// Calls `visit` with each quadrature point of the rims that touches.
    ///
    /// It is compiled once for all visitors. A call for each quadrature point costs far less than
    /// the point itself.
    #[inline(never)]
    pub(crate) fn visit_rims(&self, motion: &Motion<R>, visit: &mut dyn FnMut(&Contact<R>)) {
        let motion = &self.seen(motion);
        for surface in 0..self.surfaces() {
            let laws = self.laws_of(surface);
            let laws = (&laws.0, &laws.1);
            for rim in self.body.rims() {
                match Touching::of(laws, rim, motion) {
                    Touching::Nothing => {}
                    Touching::Arc(sweep) => {
                        sweep.visit(|node| {
                            let contact = sweep.contact(surface, rim, motion, node);
                            debug_assert!(invariants::touches(&contact, self.surfaces()));
                            visit(&contact);
                        });
                    }
                    Touching::Any => rims::visit_any(laws, rim, motion, visit),
                }
            }
        }
    }
}
