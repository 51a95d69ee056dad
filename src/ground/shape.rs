//! Where a ground's surface is, whatever its law.

mod reliefs;
mod terrain;

pub use reliefs::{Bowl, Ramp, Waves};
pub use terrain::{Elevation, Relief, Terrain};

use super::{Extent, Plane, Surface};
use crate::error::SceneError;
use crate::real::Real;

/// The shape of a ground: how far a point lies above its surface, and which way out is. A [`Ground`](crate::Ground) joins it with a law.
///
/// A [`Plane`] is one, and a [`Terrain`] of any height. The methods are those of [`SpringDamperGround`](crate::SpringDamperGround) of the same names, with the same duties: the gap changes by `normal · path`, so
/// that it is a distance.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Shape, Surface};
///
/// /// A bowl that is part of a sphere about the origin.
/// struct Hollow {
///     radius: f64,
/// }
///
/// impl Shape for Hollow {
///     fn surface(&self, point: DVec3) -> Surface {
///         Surface { gap: self.radius - point.length(), normal: (-point).try_normalize().unwrap_or(DVec3::Z) }
///     }
/// }
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not the shape of a ground: it does not implement `Shape<{R}>`",
    label = "this should be a shape",
    note = "implement `surface`; the precision `{R}` of body, ground, friction and gravity must be the same"
)]
pub trait Shape<R: Real = f64> {
    /// The surface as seen from `point` (m, world axes).
    fn surface(&self, point: R::Vec3) -> Surface<R>;

    /// Where the ground can be at all. The default is everywhere.
    #[inline]
    fn extent(&self) -> Extent<R> {
        Extent::Everywhere
    }

    /// Whether the shape can be: called once, when a scene is composed.
    ///
    /// # Errors
    /// Names the quantity, the rule that it breaks, and its value.
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }
}

/// Behind a pointer, also as `dyn`.
macro_rules! forward {
    ($pointer:ty) => {
        impl<R: Real, S: Shape<R> + ?Sized> Shape<R> for $pointer {
            #[inline]
            fn surface(&self, point: R::Vec3) -> Surface<R> {
                (**self).surface(point)
            }
            #[inline]
            fn extent(&self) -> Extent<R> {
                (**self).extent()
            }
            #[inline]
            fn check(&self) -> Result<(), SceneError> {
                (**self).check()
            }
        }
    };
}
forward!(&S);
#[cfg(feature = "std")]
forward!(alloc::boxed::Box<S>);

impl<R: Real> Shape<R> for Plane<R> {
    #[inline]
    fn surface(&self, point: R::Vec3) -> Surface<R> {
        Surface {
            gap: self.gap(point),
            normal: self.normal,
        }
    }
    #[inline]
    fn extent(&self) -> Extent<R> {
        Extent::Plane(*self)
    }
    fn check(&self) -> Result<(), SceneError> {
        Plane::check(self)
    }
}
