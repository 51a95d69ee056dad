//! An applied force: drag of a flat plate, across it alone.

use tumble::error::{self, SceneError};
use tumble::real::{Real, Vector};
use tumble::{Force, Motion, Wrench};

/// A sail that turns with the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sail<R: Real> {
    /// Normal of the sail, body axes, length 1.
    pub normal: R::Vec3,
    /// Force per square of the speed across it, N s²/m².
    pub drag: R,
}

impl<R: Real> Force<R> for Sail<R> {
    fn wrench(&self, motion: &Motion<R>) -> Wrench<R> {
        let normal = motion.axes.to_world(self.normal);
        let across = motion.linear_velocity.dot(normal);
        Wrench::of_force(normal * -(self.drag * across * across.abs()))
    }

    fn is_passive(&self) -> bool {
        true
    }

    fn check(&self) -> Result<(), SceneError> {
        error::at_least_zero("drag of the sail", self.drag, " N s²/m²")
    }
}
