//! Uniform gravity.

use crate::error::{self, SceneError};
use crate::real::{Real, Vector};

/// A uniform gravity field.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a gravity field: it does not implement `Gravity<{R}>`",
    label = "this should be a gravity field",
    note = "use `UniformGravity::down(9.8)`, or implement `acceleration`; the precision `{R}` of body, ground, friction and gravity must be the same"
)]
pub trait Gravity<R: Real = f64> {
    /// Acceleration of a body in free fall, m/s², world axes.
    fn acceleration(&self) -> R::Vec3;

    /// Checks that the field is valid. Called once, when a scene is composed.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a component is invalid. The error names the quantity, the rule and
    /// the value.
    fn check(&self) -> Result<(), SceneError> {
        let g = self.acceleration();
        error::finite("x of the acceleration by gravity", g.x(), " m/s²")?;
        error::finite("y of the acceleration by gravity", g.y(), " m/s²")?;
        error::finite("z of the acceleration by gravity", g.z(), " m/s²")
    }
}

/// Implements the trait for a pointer to a field, also to `dyn`.
macro_rules! forward {
    ($pointer:ty) => {
        impl<R: Real, A: Gravity<R> + ?Sized> Gravity<R> for $pointer {
            #[inline]
            fn acceleration(&self) -> R::Vec3 {
                (**self).acceleration()
            }
            #[inline]
            fn check(&self) -> Result<(), SceneError> {
                (**self).check()
            }
        }
    };
}
forward!(&A);
#[cfg(feature = "std")]
forward!(alloc::boxed::Box<A>);

/// Absence of gravity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NoGravity;

impl<R: Real> Gravity<R> for NoGravity {
    #[inline]
    fn acceleration(&self) -> R::Vec3 {
        R::Vec3::ZERO
    }
}

/// Gravity with the same acceleration everywhere, in any direction.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "R::Vec3: serde::Serialize",
        deserialize = "R::Vec3: serde::Deserialize<'de>"
    ))
)]
pub struct UniformGravity<R: Real = f64> {
    /// Acceleration of a body in free fall, m/s², world axes.
    pub acceleration: R::Vec3,
}

impl<R: Real> UniformGravity<R> {
    /// Creates a field of `acceleration` (m/s²) along -z.
    ///
    /// Standard gravity is 9.80665, that of the coin report 9.8.
    #[must_use]
    pub fn down(acceleration: R) -> Self {
        Self {
            acceleration: R::Vec3::new(R::ZERO, R::ZERO, -acceleration),
        }
    }
}

impl<R: Real> Gravity<R> for UniformGravity<R> {
    #[inline]
    fn acceleration(&self) -> R::Vec3 {
        self.acceleration
    }
}
