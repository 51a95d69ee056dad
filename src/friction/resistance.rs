//! Resistance to rolling and to spinning: a torque beside the force of friction.

use super::{FrictionJacobian, SlidingFriction};
use crate::error::{self, SceneError};
use crate::real::{Real, Vector};

/// How one contact resists the body's turning: with ω's parts along the ground (rolling) and along
/// its normal (spinning, spin on the spot),
/// `torque = -rolling ωₜ/(|ωₜ| + turn_speed) - spinning ωₙ/(|ωₙ| + turn_speed)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollingResistance<R = f64> {
    /// Largest torque against rolling, N m, at least 0.
    pub rolling: R,
    /// Largest torque against spinning, N m, at least 0.
    pub spinning: R,
    /// rad/s, above 0. The turning at which half of the torque is reached.
    pub turn_speed: R,
}

impl<R: Real> RollingResistance<R> {
    /// Torque on a body (N m, world axes) that turns with this angular velocity (rad/s) on a ground
    /// with this normal.
    ///
    /// Never adds energy: `torque · angular_velocity <= 0`.
    #[inline]
    #[must_use]
    pub fn torque(&self, normal: R::Vec3, angular_velocity: R::Vec3) -> R::Vec3 {
        let spinning = normal * normal.dot(angular_velocity);
        let rolling = angular_velocity - spinning;
        let [roll, drill] = self.per_turn(rolling.length(), spinning.length());
        -(rolling * roll + spinning * drill)
    }

    /// Torque over turning, N m s, for both parts of it (rad/s).
    #[inline]
    pub(crate) fn per_turn(&self, rolling: R, spinning: R) -> [R; 2] {
        [
            self.rolling / (rolling + self.turn_speed),
            self.spinning / (spinning + self.turn_speed),
        ]
    }
}

/// A friction law with resistance to rolling and to spinning beside it.
///
/// Each contact that presses with N resists with torques of up to `rolling · N` and `spinning · N`:
/// see [`RollingResistance`]. The lengths are those of the field: a wheel that takes the force f N
/// to be kept rolling has `rolling = f · radius`; a ball of radius r sunk by d has a patch of the
/// radius a = √(2 r d), and by Coulomb's law under Hertz's pressure `spinning = 3π/16 μ a`
/// (Johnson, Contact Mechanics, 1985).
///
/// ```
/// use tumble::{Coulomb, WithResistance};
///
/// // A billiard ball on cloth: it rolls out with the deceleration 5/7 · rolling/radius · g.
/// let cloth = WithResistance { friction: Coulomb { coefficient: 0.2, slip_speed: 1e-4 }, rolling: 2.9e-4, spinning: 1.2e-3, turn_speed: 1e-2 };
/// # use tumble::{Sphere, Stepper};
/// # Stepper::new(Sphere::solid(0.17, 0.0286))?.with_friction(cloth)?;
/// # Ok::<(), tumble::SceneError>(())
/// ```
///
/// *Limits:* it does not hold: a ball on a slope of angle θ, with `tan θ < rolling/radius`, creeps
/// at the turning `turn_speed · t/(1 - t)`, `t = tan θ · radius/rolling`. Bodies on many contacts
/// feel it at each. [`EnergyMomentum`](crate::EnergyMomentum) takes it in two halves, before and
/// after each step (its energy never rises), under the load at those moments: a bounce that is
/// shorter than the step feels none. The way of a ball that rolls out is of order 2; the speed that
/// is seen after a step is that of half a step before, off by `h/2 · 5/7 · rolling/radius · g` of a
/// solid ball: friction passes the last half of the torque on in the next step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WithResistance<F, R = f64> {
    /// The force.
    pub friction: F,
    /// Against rolling, m, at least 0.
    pub rolling: R,
    /// Against spinning, m, at least 0.
    pub spinning: R,
    /// rad/s, above 0. The turning at which half of the torque is reached.
    pub turn_speed: R,
}

impl<R: Real, F: SlidingFriction<R>> SlidingFriction<R> for WithResistance<F, R> {
    #[inline]
    fn is_trusted(&self) -> bool {
        self.friction.is_trusted()
    }

    #[inline]
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        self.friction.force(normal_force, slip)
    }

    #[inline]
    fn jacobian(&self, normal_force: R, slip: R::Vec3) -> FrictionJacobian<R> {
        self.friction.jacobian(normal_force, slip)
    }

    #[inline]
    fn rolling_resistance(&self, normal_force: R) -> Option<RollingResistance<R>> {
        Some(RollingResistance {
            rolling: self.rolling * normal_force,
            spinning: self.spinning * normal_force,
            turn_speed: self.turn_speed,
        })
    }

    fn check(&self) -> Result<(), SceneError> {
        self.friction.check()?;
        error::at_least_zero("length of the rolling resistance", self.rolling, " m")?;
        error::at_least_zero("length of the spinning resistance", self.spinning, " m")?;
        error::above_zero("turn speed of the resistance", self.turn_speed, " rad/s")
    }
}
