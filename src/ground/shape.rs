//! Where a ground's surface is, whatever its law.

mod reliefs;
mod terrain;

pub use reliefs::{Bowl, Ramp, Waves};
pub use terrain::{Elevation, HeightField, Terrain};

use super::{GroundBounds, Plane, Surface};
use crate::error::SceneError;
use crate::real::Real;

/// The shape of a ground: how far a point lies above its surface, and which way out is. A
/// [`Ground`](crate::Ground) joins it with a law.
///
/// A [`Plane`] is one, and a [`Terrain`] of any height. The methods are those of
/// [`SpringDamperGround`](crate::SpringDamperGround) of the same names, with the same duties: the
/// gap changes by `normal · path`, so that it is a distance.
///
/// *Limit:* one contact touches one surface. In a groove where the gap is that to the nearest of
/// two planes at a right angle, the ground pushes a ball along one normal at a time. Two surfaces
/// would push with `k d` each and lift with `√2 k d`; one lifts with `k d/√2`. So the ball
/// penetrates twice as deep: 1.9 mm instead of 0.98 mm for 1 kg on 7071 N/m.
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
    fn bounds(&self) -> GroundBounds<R> {
        GroundBounds::Everywhere
    }

    /// Whether the shape can be: called once, when a scene is composed.
    ///
    /// # Errors
    /// Names the quantity, the rule that it breaks, and its value.
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }

    /// Returns true if the values of the shape need no check while a step evaluates them. Default:
    /// false.
    ///
    /// A step checks the values of a law that is not trusted, and returns
    /// [`StepError::BrokenLaw`](crate::StepError::BrokenLaw) if one breaks the contract.
    /// Override it if the law keeps its contract for every finite input, and
    /// [`check_ground`](crate::contract::check_ground) finds nothing: the checks then cost nothing.
    /// A trusted law that breaks its contract goes unnoticed.
    #[inline]
    fn is_trusted(&self) -> bool {
        false
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
            fn bounds(&self) -> GroundBounds<R> {
                (**self).bounds()
            }
            #[inline]
            fn check(&self) -> Result<(), SceneError> {
                (**self).check()
            }
            #[inline]
            fn is_trusted(&self) -> bool {
                (**self).is_trusted()
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
    fn bounds(&self) -> GroundBounds<R> {
        GroundBounds::Plane(*self)
    }
    fn check(&self) -> Result<(), SceneError> {
        Plane::check(self)
    }
    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }
}
