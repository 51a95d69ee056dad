//! Cylinder with hemispherical ends.

use super::{ContactPoint, RigidPointBody, homogeneous};
use crate::error::{self, SceneError};
use crate::real::{Real, Vector};

/// Cylinder between two hemispheres, along body z: two contacts with its radius.
///
/// On flat ground the two contacts represent the whole capsule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule<R: Real = f64> {
    mass: R,
    length: R,
    ends: [ContactPoint<R>; 2],
}

impl<R: Real> Capsule<R> {
    /// Creates a homogeneous capsule. Mass in kg, radius in m, length between the centres of its
    /// ends in m. A length of 0 gives a ball.
    #[must_use]
    pub fn solid(mass: R, radius: R, length: R) -> Self {
        let end = |z: R| ContactPoint {
            position: R::Vec3::new(R::ZERO, R::ZERO, z),
            radius,
        };
        Self {
            mass,
            length,
            ends: [end(-(length * R::HALF)), end(length * R::HALF)],
        }
    }

    /// Radius, m.
    #[inline]
    #[must_use]
    pub fn radius(&self) -> R {
        let [end, _] = self.ends;
        end.radius
    }

    /// Length between the centres of the ends, m.
    #[inline]
    #[must_use]
    pub fn length(&self) -> R {
        self.length
    }
}

impl<R: Real> RigidPointBody<R> for Capsule<R> {
    #[inline]
    fn mass(&self) -> R {
        self.mass
    }
    #[inline]
    fn inertia(&self) -> R::Mat3 {
        homogeneous::capsule(self.mass, self.radius(), self.length).inertia
    }
    #[inline]
    fn is_symmetric(&self) -> bool {
        true
    }
    #[inline]
    fn contacts(&self) -> &[ContactPoint<R>] {
        &self.ends
    }
    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("mass of the capsule", self.mass, " kg")?;
        error::above_zero("radius of the capsule", self.radius(), " m")?;
        error::at_least_zero("length of the capsule", self.length, " m")
    }
}
