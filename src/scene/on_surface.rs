//! A scene as one of several surfaces sees it.

use super::Dynamics;
use crate::body::InertiaProperties;
use crate::contact::ContactModel;
use crate::friction::LawOfSurface;
use crate::ground::OneSurface;
use crate::real::Real;

/// Scene whose ground is one surface of the ground of another scene, with the friction law of that
/// surface.
///
/// If the ground has one surface only, this is the scene itself, without a cost.
pub(crate) struct OnSurface<'a, R: Real, D: Dynamics<R>> {
    scene: &'a D,
    ground: OneSurface<'a, D::Ground>,
    friction: LawOfSurface<'a, D::Friction>,
}

impl<'a, R: Real, D: Dynamics<R>> OnSurface<'a, R, D> {
    /// Scene on the surface with this index.
    #[inline(always)]
    pub(crate) fn of(scene: &'a D, surface: usize) -> Self {
        Self {
            scene,
            ground: OneSurface::of(scene.ground(), surface),
            friction: LawOfSurface::of(scene.friction(), surface),
        }
    }
}

impl<'a, R: Real, D: Dynamics<R>> Dynamics<R> for OnSurface<'a, R, D> {
    type Body = D::Body;
    type Ground = OneSurface<'a, D::Ground>;
    type Friction = LawOfSurface<'a, D::Friction>;
    type Force = D::Force;
    type Untested = Self;

    #[inline(always)]
    fn untested(&self) -> &Self {
        self
    }
    #[inline(always)]
    fn contact_model(&self) -> ContactModel<'_, Self::Body, Self::Ground, Self::Friction, R> {
        let model = self.scene.contact_model();
        model.with_laws(&self.ground, &self.friction)
    }
    #[inline(always)]
    fn gravity(&self) -> R::Vec3 {
        self.scene.gravity()
    }
    #[inline(always)]
    fn force(&self) -> &Self::Force {
        self.scene.force()
    }
    #[inline(always)]
    fn inertia_properties(&self) -> &InertiaProperties<R> {
        self.scene.inertia_properties()
    }
    #[inline(always)]
    fn probe<T>(&self, evaluate: impl FnOnce() -> T) -> T {
        self.scene.probe(evaluate)
    }
}
