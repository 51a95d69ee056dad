//! Friction proportional to the slip.

use super::{FrictionJacobian, SlidingFriction};
use crate::error::{self, SceneError};
use crate::real::Real;

/// Friction proportional to load and slip: a wet or greased ground.
///
/// `force = -coefficient · normal_force · slip`, in newtons, world axes. The force never adds
/// energy: `force · slip <= 0`.
///
/// *Limits:* it does not stick. On a slope of angle θ a body reaches a sliding speed of
/// `tan θ/coefficient`. A film that drags without load is not modelled.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Viscous<R = f64> {
    /// Friction coefficient per slip, s/m, at least 0.
    pub coefficient: R,
}

impl<R: Real> SlidingFriction<R> for Viscous<R> {
    #[inline]
    fn is_proportional_to_load(&self) -> bool {
        true
    }

    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }

    #[inline]
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        slip * -(self.coefficient * normal_force)
    }

    #[inline]
    fn jacobian(&self, normal_force: R, _slip: R::Vec3) -> FrictionJacobian<R> {
        FrictionJacobian {
            coefficient: self.coefficient * normal_force,
            per_load: self.coefficient,
            ..FrictionJacobian::NONE
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        error::at_least_zero("viscous friction", self.coefficient, " s/m")
    }
}
