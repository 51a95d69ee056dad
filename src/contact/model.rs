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
    pub(crate) body: &'a B,
    /// Ground.
    pub(crate) ground: &'a G,
    /// Friction law.
    pub(crate) friction: &'a F,
    /// Distance from the centre of mass to the farthest point of the body's surface, m.
    pub(crate) bounding_radius: R,
    /// True if a contact of the body has a radius or moves over a smooth surface.
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
        Self {
            body,
            ground,
            friction,
            bounding_radius: body.bounding_radius(),
            has_radii: body.is_smooth() || contacts.any(|contact| contact.radius > R::ZERO),
        }
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
    /// Slip, friction and rolling resistance are those of this motion. Depths, closing speeds and
    /// arms are those of the motion itself, because the material moves along its surface.
    #[inline(always)]
    pub(crate) fn seen(&self, motion: &Motion<R>) -> Motion<R> {
        match self.ground.motion() {
            Some(ground) => ground.seen_by(motion),
            None => *motion,
        }
    }

    /// Friction law.
    #[inline(always)]
    #[must_use]
    pub fn friction(&self) -> &'a F {
        self.friction
    }
}
