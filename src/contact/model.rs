//! The parts of a scene on which contact depends.

use crate::body::RigidPointBody;
use crate::friction::{LawOfSurface, SlidingFriction};
use crate::ground::{OneSurface, SpringDamperGround};
use crate::real::Real;
use crate::state::Motion;

/// Body, ground and friction law, as the parts on which contact depends.
///
/// *For authors of integrators:* [`load`](Self::load) returns the force and torque of all contacts
/// in a motion, and [`visit`](Self::visit) visits each contact. A method can keep the contact range
/// of its last evaluation in its workspace. [`range_near`](Self::range_near) then finds the next
/// range faster, and [`load_on`](Self::load_on) returns its load.
#[derive(Clone, Copy, Debug)]
pub struct ContactModel<'a, B, G, F, R: Real = f64> {
    /// Body.
    pub(super) body: &'a B,
    /// Ground.
    pub(super) ground: &'a G,
    /// Friction law.
    pub(super) friction: &'a F,
    /// Extent of the body's surface.
    pub(super) extent: Extent<R>,
}

/// Extent of a body's surface, computed once when a scene is composed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent<R> {
    /// Distance from the centre of mass to the farthest point of the surface, m.
    pub(crate) bounding_radius: R,
    /// True if the surface extends beyond the positions of the contacts: one has a radius or moves
    /// over a smooth surface.
    ///
    /// The force then acts at a point other than the contact's own position.
    pub(crate) has_radii: bool,
}

impl<'a, R, B, G, F> ContactModel<'a, B, G, F, R>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
{
    /// Contact model of a body on a ground. It evaluates every contact of the body once.
    #[must_use]
    pub fn new(body: &'a B, ground: &'a G, friction: &'a F) -> Self {
        let mut contacts = body.contacts().iter();
        let extent = Extent {
            bounding_radius: body.bounding_radius(),
            has_radii: body.is_smooth() || contacts.any(|contact| contact.radius > R::ZERO),
        };
        Self::composed(body, ground, friction, extent)
    }

    /// Contact model of a body whose extent is known.
    #[inline(always)]
    pub(crate) fn composed(body: &'a B, ground: &'a G, friction: &'a F, extent: Extent<R>) -> Self {
        Self {
            body,
            ground,
            friction,
            extent,
        }
    }

    /// Contact model of the same body with another ground and friction law.
    #[inline(always)]
    pub(crate) fn with_laws<'b, G2, F2>(
        &self,
        ground: &'b G2,
        friction: &'b F2,
    ) -> ContactModel<'b, B, G2, F2, R>
    where
        'a: 'b,
        G2: SpringDamperGround<R>,
        F2: SlidingFriction<R>,
    {
        self.with_parts(self.body, ground, friction)
    }

    /// Contact model of the same body behind another type, for example a pointer to it, with
    /// another ground and friction law. No contact is evaluated, in contrast to
    /// [`new`](Self::new).
    #[doc(hidden)]
    #[inline(always)]
    #[must_use]
    pub fn with_parts<'b, B2, G2, F2>(
        &self,
        body: &'b B2,
        ground: &'b G2,
        friction: &'b F2,
    ) -> ContactModel<'b, B2, G2, F2, R>
    where
        B2: RigidPointBody<R>,
        G2: SpringDamperGround<R>,
        F2: SlidingFriction<R>,
    {
        ContactModel::composed(body, ground, friction, self.extent)
    }

    /// Extent of the body's surface.
    #[inline(always)]
    pub(crate) fn extent(&self) -> Extent<R> {
        self.extent
    }

    /// Body.
    #[inline(always)]
    #[must_use]
    pub fn body(&self) -> &'a B {
        self.body
    }

    /// Ground.
    #[inline(always)]
    #[must_use]
    pub fn ground(&self) -> &'a G {
        self.ground
    }

    /// Number of surfaces of the ground.
    #[inline(always)]
    pub(crate) fn surfaces(&self) -> usize {
        self.ground.surfaces().unwrap_or(1)
    }

    /// Ground and friction law of one surface.
    #[inline(always)]
    pub(crate) fn laws_of(&self, surface: usize) -> (OneSurface<'a, G>, LawOfSurface<'a, F>) {
        (
            OneSurface::of(self.ground, surface),
            LawOfSurface::of(self.friction, surface),
        )
    }

    /// Motion of the body as the ground sees it: relative to the ground's material, if that moves.
    ///
    /// Slip, closing speed, friction and rolling resistance are those of this motion. Depths and
    /// arms are those of the motion itself. The closing speeds of both are the same where the
    /// material moves along its surface, as [`MovingGround`](crate::MovingGround) requires.
    #[inline(always)]
    pub(crate) fn seen(&self, motion: &Motion<R>) -> Motion<R> {
        match self.ground.motion() {
            Some(ground) => ground.seen_by(motion),
            None => *motion,
        }
    }

    /// Returns true if the ground's material moves.
    // Not forced inline: the compiler then knows the answer of a ground at rest before it inlines
    // what a moving one needs.
    #[inline]
    pub(super) fn ground_moves(&self) -> bool {
        self.ground.motion().is_some()
    }

    /// Friction law.
    #[inline(always)]
    #[must_use]
    pub fn friction(&self) -> &'a F {
        self.friction
    }
}
