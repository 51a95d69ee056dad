//! Sliding friction: the force along the ground.

mod coulomb;

pub use coulomb::{Coulomb, SmoothCoulomb};

use crate::error::SceneError;
use crate::real::{Real, Vector};

/// A law of sliding friction, applied at each contact.
///
/// *To the implementer:* the force must lie in the plane of `slip`, oppose it (`force · slip <= 0`, so that friction never adds energy), and be finite at zero
/// slip. [`contract::check_friction`](crate::contract::check_friction) tests an implementation.
///
/// ```
/// use tumble::SlidingFriction;
/// use tumble::glam::DVec3;
///
/// /// An oil film: force in proportion to the speed, whatever the load.
/// struct Oil {
///     drag: f64,
/// }
///
/// impl SlidingFriction for Oil {
///     fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
///         if normal_force > 0.0 { -slip * self.drag } else { DVec3::ZERO }
///     }
/// }
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a friction law: it does not implement `SlidingFriction<{R}>`",
    label = "this should be a friction law",
    note = "implement `force`; the precision `{R}` of body, ground, friction and gravity must be the same"
)]
pub trait SlidingFriction<R: Real = f64> {
    /// Force on the body at one contact (N, world axes) that presses with `normal_force` (N, at least 0) and slides at `slip` (m/s, world axes, in the
    /// surface).
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3;

    /// Whether the law can be: called once, when a scene is composed.
    ///
    /// # Errors
    /// Names the quantity, the rule that it breaks, and its value.
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }
}

impl<R: Real, F: SlidingFriction<R> + ?Sized> SlidingFriction<R> for &F {
    #[inline]
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        (**self).force(normal_force, slip)
    }
    #[inline]
    fn check(&self) -> Result<(), SceneError> {
        (**self).check()
    }
}

/// No friction: contacts slide freely, and nothing is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Frictionless;

impl<R: Real> SlidingFriction<R> for Frictionless {
    #[inline]
    fn force(&self, _normal_force: R, _slip: R::Vec3) -> R::Vec3 {
        R::Vec3::ZERO
    }
}
