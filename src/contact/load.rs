//! Force and torque on a body.

use super::point::Contact;
use crate::real::{Real, Vector};
use crate::rotation::Axes;

/// Force and torque of the contacts on the body, and of the applied force if it is added, world
/// axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load<R: Real = f64> {
    /// Force, N.
    pub force: R::Vec3,
    /// Torque about the centre of mass, N m.
    pub torque: R::Vec3,
    /// Number of contacts that touch, summed over the surfaces. A round rim counts with the points
    /// of its quadrature, whose number depends on the pose.
    pub touching: usize,
}

impl<R: Real> Load<R> {
    /// Adds a touching contact with its force (N), and with its arm for a body with other axes.
    #[inline]
    pub(super) fn add_along(&mut self, axes: &Axes<R>, contact: &Contact<R>, force: R::Vec3) {
        self.force += force;
        self.torque += contact.arm_along(axes).cross(force);
        self.touching += 1;
    }

    /// Adds a touching contact with its force (N).
    #[inline]
    pub(crate) fn add(&mut self, contact: &Contact<R>, force: R::Vec3) {
        self.force += force;
        self.torque += contact.arm.cross(force);
        self.touching += 1;
    }
}

impl<R: Real> Default for Load<R> {
    #[inline]
    fn default() -> Self {
        Self {
            force: R::Vec3::ZERO,
            torque: R::Vec3::ZERO,
            touching: 0,
        }
    }
}
