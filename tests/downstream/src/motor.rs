//! A drive: a motor that turns the body about the vertical axis.

use tumble::error::{self, SceneError};
use tumble::real::{Real, Vector};
use tumble::{Force, Motion, Wrench};

/// Torque that maintains an angular speed about the vertical axis: `drag · (rate - ω_z)`.
///
/// It does positive work on a body that is slower than the motor, so it is a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor<R = f64> {
    /// Angular speed that the motor maintains, rad/s.
    pub rate: R,
    /// Torque per difference of the angular speeds, N m s.
    pub drag: R,
}

impl<R: Real> Force<R> for Motor<R> {
    fn wrench(&self, motion: &Motion<R>) -> Wrench<R> {
        let torque = (self.rate - motion.angular_velocity.z()) * self.drag;
        Wrench::of_torque(R::Vec3::new(R::ZERO, R::ZERO, torque))
    }

    fn is_passive(&self) -> bool {
        false
    }

    fn check(&self) -> Result<(), SceneError> {
        error::at_least_zero("drag of the motor", self.drag, " N m s")
    }
}
