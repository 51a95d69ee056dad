//! Force that is the same in every motion.

use super::{Force, Wrench};
use crate::error::{self, SceneError};
use crate::real::{Real, Vector};
use crate::state::Motion;

/// A constant force at the centre of mass, world axes: buoyancy, thrust, a uniform field.
///
/// It has the potential energy `-F · x`, which counts as
/// [`Energy::gravity`](crate::Energy::gravity). It is therefore not a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "R::Vec3: serde::Serialize",
        deserialize = "R::Vec3: serde::Deserialize<'de>"
    ))
)]
pub struct ConstantForce<R: Real = f64> {
    /// Force, N.
    pub force: R::Vec3,
}

impl<R: Real> Force<R> for ConstantForce<R> {
    #[inline]
    fn wrench(&self, _motion: &Motion<R>) -> Wrench<R> {
        Wrench::ZERO
    }

    #[inline]
    fn is_passive(&self) -> bool {
        true
    }

    #[inline]
    fn constant_force(&self) -> Option<R::Vec3> {
        Some(self.force)
    }

    #[inline]
    fn acts(&self) -> bool {
        false
    }

    fn check(&self) -> Result<(), SceneError> {
        error::finite("x of the constant force", self.force.x(), " N")?;
        error::finite("y of the constant force", self.force.y(), " N")?;
        error::finite("z of the constant force", self.force.z(), " N")
    }

    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }
}
