//! A ground from a law and a shape.

use super::{ContactLaw, Extent, MeanForce, Plane, Shape, SpringDamperGround, Surface};
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
/// [`FlatGround`](crate::FlatGround) is the same as a [`SpringDamper`](crate::SpringDamper) on a [`Plane`], bit by bit.
/// A law is the same everywhere on the ground: where its stiffness changed from place to place, the energy of a loaded spring would change along the surface, and the ground would have to push sideways for it.
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
    fn extent(&self) -> Extent<R> {
        self.shape.extent()
    }
    fn check(&self) -> Result<(), SceneError> {
        self.law.check()?;
        self.shape.check()
    }
}
