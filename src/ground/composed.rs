//! Ground composed of a contact law and a shape.

use super::{ContactLaw, GroundBounds, MeanForce, Plane, Shape, SpringDamperGround, Surface};
use crate::error::SceneError;
use crate::real::Real;

/// A ground that combines the force of a [`ContactLaw`] with the surface of a [`Shape`].
///
/// ```
/// use tumble::{Carried, Coin, Ground, HuntCrossley, Impact, Stepper};
///
/// // A ball of 57 g that penetrates by 6 mm when it hits with 7 m/s, and leaves with three
/// // quarters of the speed.
/// let ball = Carried { mass: 0.057, contacts: 1 };
/// let impact = Impact { speed: 7.0, restitution: 0.75 };
/// let court = Ground::level(HuntCrossley::from_bounce(ball, 1.5, impact, 6e-3)?);
/// # let stepper = Stepper::new(Coin::ring(1.0, 0.5))?.with_ground(court)?;
/// # Ok::<(), tumble::SceneError>(())
/// ```
///
/// [`FlatGround`](crate::FlatGround) gives the same results as a
/// [`SpringDamper`](crate::SpringDamper) on a [`Plane`], bit by bit.
///
/// # Uniform law
///
/// The law is the same everywhere on the surface: there are no softer and stiffer regions. A
/// stiffness k(x, y) gives the springs' energy `k d²/2` a gradient along the surface. The force
/// then has a tangential part, `-(d²/2) ∇k`, which pushes a loaded contact towards the soft side.
///
/// * *Without this part* energy is created. A contact that slides at depth d from k₁ to k₂ gains
///   `(k₂ - k₁) d²/2` at each bounce. If the body slides slowly under its weight W, its energy
///   increases by `W²/2 (1/k₁ - 1/k₂)`: 0.024 J for 1 kg from 1000 to 2000 N/m.
/// * *With this part* a force acts along the ground that is no friction.
///
/// For this reason a law takes the depth and not the position.
///
/// Friction stores no energy, so its coefficient may depend on the position:
/// [`FrictionPatch`](crate::FrictionPatch), [`FrictionField`](crate::FrictionField). Damping stores
/// none either. For a ground whose damping differs from region to region, use one stepper for each
/// region, and advance the state by the stepper of its region.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ground<L, S = Plane> {
    /// Contact law.
    pub law: L,
    /// Shape of the surface.
    pub shape: S,
}

impl<L, R: Real> Ground<L, Plane<R>> {
    /// Creates a ground with the plane z = 0.
    #[must_use]
    pub fn level(law: L) -> Self {
        Self {
            law,
            shape: Plane::level(R::ZERO),
        }
    }
}

impl<R: Real, L: ContactLaw<R>, S: Shape<R>> SpringDamperGround<R> for Ground<L, S> {
    #[inline]
    fn surface(&self, point: R::Vec3) -> Surface<R> {
        self.shape.surface(point)
    }
    #[inline]
    fn surface_under(&self, centre: R::Vec3, radius: R) -> Option<Surface<R>> {
        self.shape.surface_under(centre, radius)
    }
    #[inline]
    fn spring_force(&self, depth: R) -> R {
        self.law.spring_force(depth)
    }
    #[inline]
    fn spring_energy(&self, depth: R) -> R {
        self.law.spring_energy(depth)
    }
    #[inline]
    fn normal_force(&self, depth: R, closing_speed: R) -> R {
        self.law.normal_force(depth, closing_speed)
    }
    #[inline]
    fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        self.law.mean_force(start, end, seconds)
    }
    #[inline]
    fn bounds(&self) -> GroundBounds<R> {
        self.shape.bounds()
    }
    fn check(&self) -> Result<(), SceneError> {
        self.law.check()?;
        self.shape.check()
    }
    #[inline]
    fn is_trusted(&self) -> bool {
        self.law.is_trusted() && self.shape.is_trusted()
    }
}
