//! Thin straight rod, and a single point.

use super::{ContactPoint, RigidPointBody, homogeneous};
use crate::error::{self, SceneError};
use crate::real::{Matrix, Real, Vector};

/// Thin straight rod along body z, with a bare contact at each end.
///
/// It has no moment about its own axis and does not spin about it. So its angular momentum is
/// perpendicular to the axis, as
/// [`Stepper::with_angular_velocity`](crate::Stepper::with_angular_velocity) sets it. A state with
/// a part along the axis describes no motion of a rod. In contact
/// [`EnergyMomentum`](crate::EnergyMomentum) drops that part, and the other methods keep it, so
/// that they end at different motions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rod<R: Real = f64> {
    mass: R,
    length: R,
    ends: [ContactPoint<R>; 2],
}

impl<R: Real> Rod<R> {
    /// Creates a homogeneous rod: moment `m l²/12` across it. Mass in kg, length in m.
    #[must_use]
    pub fn new(mass: R, length: R) -> Self {
        let end = |z: R| ContactPoint::bare(R::Vec3::new(R::ZERO, R::ZERO, z));
        Self {
            mass,
            length,
            ends: [end(-(length * R::HALF)), end(length * R::HALF)],
        }
    }

    /// Length, m.
    #[inline]
    #[must_use]
    pub fn length(&self) -> R {
        self.length
    }
}

impl<R: Real> RigidPointBody<R> for Rod<R> {
    #[inline]
    fn mass(&self) -> R {
        self.mass
    }
    #[inline]
    fn inertia(&self) -> R::Mat3 {
        homogeneous::rod(self.mass, self.length).inertia
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
        error::above_zero("mass of the rod", self.mass, " kg")?;
        error::above_zero("length of the rod", self.length, " m")
    }
}

/// Point with a mass: it slides and bounces and does not rotate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMass<R: Real = f64> {
    mass: R,
    place: [ContactPoint<R>; 1],
}

impl<R: Real> PointMass<R> {
    /// Creates a point with this mass, kg.
    #[must_use]
    pub fn new(mass: R) -> Self {
        Self {
            mass,
            place: [ContactPoint::default()],
        }
    }
}

impl<R: Real> RigidPointBody<R> for PointMass<R> {
    #[inline]
    fn mass(&self) -> R {
        self.mass
    }
    #[inline]
    fn inertia(&self) -> R::Mat3 {
        R::Mat3::from_diagonal(R::Vec3::ZERO)
    }
    #[inline]
    fn is_symmetric(&self) -> bool {
        true
    }
    #[inline]
    fn contacts(&self) -> &[ContactPoint<R>] {
        &self.place
    }
    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("mass of the point", self.mass, " kg")
    }
}
