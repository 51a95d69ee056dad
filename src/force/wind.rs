//! Air that moves with a constant velocity.

use super::{Force, ForcePower, Wrench};
use crate::error::{self, SceneError};
use crate::real::{Real, Vector};
use crate::state::Motion;

/// Any force of the air, in air that moves with a constant velocity.
///
/// The wrapped force is evaluated at the velocity of the body relative to the air. Wind can do
/// positive work, so it is a drive: see [`Step::drive_work`](crate::Step::drive_work).
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{AirDrag, Sphere, State, Stepper, Wind};
///
/// let wind = Wind { velocity: DVec3::X * 5.0, force: AirDrag::linear(0.1) }; // m/s, N s/m
/// let ball = Stepper::builder(Sphere::solid(0.02, 0.1)).force(wind).build()?; // kg, m
/// let mut state = State::at(DVec3::ZERO);
/// ball.advance(&mut state, 10.0)?;
/// assert!((state.linear_velocity.x - 5.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "R::Vec3: serde::Serialize, E: serde::Serialize",
        deserialize = "R::Vec3: serde::Deserialize<'de>, E: serde::Deserialize<'de>"
    ))
)]
pub struct Wind<E, R: Real = f64> {
    /// Velocity of the air, m/s, world axes.
    pub velocity: R::Vec3,
    /// Force in air at rest.
    pub force: E,
}

impl<R: Real, E> Wind<E, R> {
    #[inline]
    fn relative(&self, motion: &Motion<R>) -> Motion<R> {
        Motion {
            linear_velocity: motion.linear_velocity - self.velocity,
            ..*motion
        }
    }
}

impl<R: Real, E: Force<R>> Force<R> for Wind<E, R> {
    #[inline]
    fn wrench(&self, motion: &Motion<R>) -> Wrench<R> {
        self.force.wrench(&self.relative(motion))
    }

    #[inline]
    fn is_passive(&self) -> bool {
        false
    }

    #[inline]
    fn constant_force(&self) -> Option<R::Vec3> {
        self.force.constant_force()
    }

    #[inline]
    fn power(&self, motion: &Motion<R>) -> ForcePower<R> {
        ForcePower {
            drag: R::ZERO,
            drive: self.wrench(motion).power(motion),
        }
    }

    #[inline]
    fn wrench_change(
        &self,
        motion: &Motion<R>,
        linear_change: R::Vec3,
        angular_change: R::Vec3,
    ) -> Wrench<R> {
        let relative = self.relative(motion);
        self.force
            .wrench_change(&relative, linear_change, angular_change)
    }

    #[inline]
    fn acts(&self) -> bool {
        self.force.acts()
    }

    fn check(&self) -> Result<(), SceneError> {
        let v = self.velocity;
        error::finite("x of the velocity of the wind", v.x(), " m/s")?;
        error::finite("y of the velocity of the wind", v.y(), " m/s")?;
        error::finite("z of the velocity of the wind", v.z(), " m/s")?;
        self.force.check()
    }

    #[inline]
    fn is_trusted(&self) -> bool {
        self.force.is_trusted()
    }
}
