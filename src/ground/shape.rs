//! Shapes of a ground's surface, independent of the contact law.

mod block;
mod reliefs;
mod terrain;

pub use block::Block;
pub use reliefs::{Bowl, Ramp, Waves};
pub use terrain::{Elevation, HeightField, Terrain};

use super::{GroundBounds, Plane, Surface};
use crate::error::SceneError;
use crate::real::Real;

/// The surface shape of a ground: the height of a point above the surface, and the outward normal.
///
/// A [`Ground`](crate::Ground) combines it with a contact law. [`Plane`] is a shape, and so is a
/// [`Terrain`] of any height function.
///
/// The methods have the same names and the same contract as those of
/// [`SpringDamperGround`](crate::SpringDamperGround). The gap must be a distance: for a small
/// displacement of the point it changes by `normal · displacement`.
///
/// *Limit:* a shape is one surface. Consider a groove of two planes at a right angle, where the gap
/// is the distance to the nearest plane. The ground then pushes a ball along one normal at a time.
/// Two surfaces push with `k d` each and lift with `√2 k d`. One surface lifts with `k d/√2`, so
/// the ball penetrates twice as deep: 1.96 mm instead of 0.98 mm for 1 kg on 7071 N/m. A groove is
/// therefore a ground of [several surfaces](crate::SpringDamperGround#several-surfaces).
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
    /// Returns the signed distance of `point` (m, world axes) from the surface, and the outward
    /// normal of the surface there.
    ///
    /// The gap must be a distance: a small displacement of the point changes it by
    /// `normal · displacement`. Otherwise the springs create or destroy energy as a contact moves
    /// along the surface. For a height z = h(x, y) use a [`Terrain`](crate::Terrain).
    fn surface(&self, point: R::Vec3) -> Surface<R>;

    /// Returns the surface as [`surface`](Self::surface) does, or `None` if a contact with this
    /// centre (m, world axes) and radius (m) certainly does not touch it.
    ///
    /// Override this method if that is cheaper to find out than the distance. A step asks for each
    /// contact that the [`bounds`](Self::bounds) do not exclude. Default: the surface.
    #[inline]
    fn surface_under(&self, centre: R::Vec3, radius: R) -> Option<Surface<R>> {
        let _ = radius;
        Some(self.surface(centre))
    }

    /// Region that the ground can occupy. Default: everywhere.
    #[inline]
    fn bounds(&self) -> GroundBounds<R> {
        GroundBounds::Everywhere
    }

    /// Checks that the shape is valid. Called once, when a scene is composed.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a quantity is invalid. The error names the quantity, the rule and
    /// the value.
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }

    /// Returns true if the values of the shape need no check while a step evaluates them. Default:
    /// false.
    ///
    /// A step checks some values of a shape that is not trusted, and returns
    /// [`StepError::BrokenLaw`](crate::StepError::BrokenLaw) if they break the contract: that the
    /// gap is a number, and that the normal has length 1. Override this method if the shape
    /// keeps its contract for every finite input, and
    /// [`check_ground`](crate::contract::check_ground) finds no fault. The checks then cost
    /// nothing. A trusted shape that breaks its contract is not detected.
    #[inline]
    fn is_trusted(&self) -> bool {
        false
    }
}

/// Implements the trait for a pointer to a shape, also to `dyn`.
macro_rules! forward {
    ($pointer:ty) => {
        impl<R: Real, S: Shape<R> + ?Sized> Shape<R> for $pointer {
            #[inline]
            fn surface(&self, point: R::Vec3) -> Surface<R> {
                (**self).surface(point)
            }
            #[inline]
            fn surface_under(&self, centre: R::Vec3, radius: R) -> Option<Surface<R>> {
                (**self).surface_under(centre, radius)
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
