//! Pose and velocities of a body, on which forces depend.

use crate::real::{Real, Vector};
use crate::rotation::Axes;

/// Pose and velocities of a body, world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<R: Real = f64> {
    /// Centre of mass, m.
    pub position: R::Vec3,
    /// Axes of the body.
    pub axes: Axes<R>,
    /// Velocity of the centre of mass, m/s.
    pub linear_velocity: R::Vec3,
    /// Angular velocity, rad/s.
    pub angular_velocity: R::Vec3,
}

impl<R: Real> Motion<R> {
    /// Velocity (m/s) of the body's material at `arm` (m, world axes, from the centre of mass):
    /// `v + ω × r`.
    #[inline]
    #[must_use]
    pub fn velocity_at(&self, arm: R::Vec3) -> R::Vec3 {
        self.linear_velocity + self.angular_velocity.cross(arm)
    }
}
