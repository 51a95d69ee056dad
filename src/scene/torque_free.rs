//! A scene without the forces of another one.

use super::Dynamics;
use crate::body::InertiaProperties;
use crate::contact::ContactModel;
use crate::force::NoForce;
use crate::ground::NoGround;
use crate::real::{Real, Vector};

/// Body of another scene in empty space: no ground, no gravity and no applied force.
pub(crate) struct TorqueFree<'a, D>(pub(crate) &'a D);

impl<R: Real, D: Dynamics<R>> Dynamics<R> for TorqueFree<'_, D> {
    type Body = D::Body;
    type Ground = NoGround;
    type Friction = D::Friction;
    type Force = NoForce;
    type Untested = Self;

    #[inline(always)]
    fn untested(&self) -> &Self {
        self
    }
    #[inline(always)]
    fn contact_model(&self) -> ContactModel<'_, Self::Body, Self::Ground, Self::Friction, R> {
        let model = self.0.contact_model();
        model.with_laws(&NoGround, model.friction())
    }
    #[inline(always)]
    fn gravity(&self) -> R::Vec3 {
        R::Vec3::ZERO
    }
    #[inline(always)]
    fn force(&self) -> &NoForce {
        &NoForce
    }
    #[inline(always)]
    fn inertia_properties(&self) -> &InertiaProperties<R> {
        self.0.inertia_properties()
    }
}
