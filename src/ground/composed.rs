//! A ground from a law and a shape.

use super::{ContactLaw, GroundBounds, MeanForce, Plane, Shape, SpringDamperGround, Surface};
use crate::error::SceneError;
use crate::real::Real;

/// A ground that pushes by a [`ContactLaw`], with the surface of a [`Shape`].
///
/// ```
/// use tumble::{Carried, Coin, Ground, HuntCrossley, Stepper};
///
/// // A ball of 57 g that goes down by 6 mm when it hits with 7 m/s, and leaves with three quarters of the speed.
/// let ball = Carried { mass: 0.057, contacts: 1 };
/// let court = Ground::level(HuntCrossley::from_bounce(ball, 1.5, 0.75, 7.0, 6e-3)?);
/// # let stepper = Stepper::new(Coin::ring(1.0, 0.5))?.with_ground(court)?;
/// # Ok::<(), tumble::SceneError>(())
/// ```
///
/// [`FlatGround`](crate::FlatGround) is the same as a [`SpringDamper`](crate::SpringDamper) on a
/// [`Plane`], bit by bit.
///
/// # One law everywhere
///
/// There are no softer and stiffer regions. With a stiffness k(x, y) the springs' energy `k d²/2`
/// has a slope along the surface, and its force is not normal alone: `-(d²/2) ∇k` pushes a loaded
/// contact towards the soft side. Left out, a contact that slides at the depth d from k₁ to k₂
/// would be given `(k₂ - k₁) d²/2` by nobody, at each bounce anew; sliding slowly under the weight
/// W it would be raised by `W²/2 (1/k₁ - 1/k₂)`: 0.024 J for 1 kg from 1000 to 2000 N/m. Put in, it
/// would be a force along the ground that is no friction. So a law is told the depth, not the
/// place.
///
/// Damping and friction store nothing, so that both may differ from region to region: move the
/// state by one stepper or another, whichever region it is in
/// ([an example](crate::guide::extending::friction)).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ground<L, S = Plane> {
    /// How it pushes back.
    pub law: L,
    /// Where it is.
    pub shape: S,
}

impl<L, R: Real> Ground<L, Plane<R>> {
    /// The plane z = 0.
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
