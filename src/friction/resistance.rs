//! Resistance to rolling and to spinning: a torque in addition to the friction force.

use super::several::check_is_one;
use super::{FrictionJacobian, SlidingFriction};
use crate::error::{self, Rule, SceneError};
use crate::real::{Real, Vector};

/// Torque of one contact against rolling and spinning of the body.
///
/// `torque = -rolling ωₜ/(|ωₜ| + turn_speed) - spinning ωₙ/(|ωₙ| + turn_speed)`. The angular
/// velocity ω has the part ωₜ along the ground (rolling) and the part ωₙ along its normal (spinning
/// friction).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollingResistance<R = f64> {
    /// Largest torque against rolling, N m, at least 0.
    pub rolling: R,
    /// Largest torque against spinning, N m, at least 0.
    pub spinning: R,
    /// Angular speed at which half of the torque is reached, rad/s, above 0 and a
    /// [safe divisor](crate::error::Rule::SafeDivisor).
    pub turn_speed: R,
}

impl<R: Real> RollingResistance<R> {
    /// Torque (N m, world axes) on a body with this angular velocity (rad/s) on a ground with this
    /// normal.
    ///
    /// The torque never adds energy: `torque · angular_velocity <= 0`.
    #[inline]
    #[must_use]
    pub fn torque(&self, normal: R::Vec3, angular_velocity: R::Vec3) -> R::Vec3 {
        let (rolling, spinning) = split::<R>(normal, angular_velocity);
        let [per_rolling, per_spinning] = self.per_turn(rolling.length(), spinning.length());
        -(rolling * per_rolling + spinning * per_spinning)
    }

    /// As [`torque`](Self::torque), but linear at angular speeds of which the sum with the turn
    /// speed is below a `resolution` (rad/s).
    #[inline]
    pub(crate) fn torque_resolving(
        &self,
        resolution: R,
        normal: R::Vec3,
        angular_velocity: R::Vec3,
    ) -> R::Vec3 {
        if resolution <= self.turn_speed {
            return self.torque(normal, angular_velocity);
        }
        let (rolling, spinning) = split::<R>(normal, angular_velocity);
        let least = resolution - self.turn_speed;
        let [of_rolling, of_spinning] =
            [rolling, spinning].map(|part| part.length().at_least(least));
        let [per_rolling, per_spinning] = self.per_turn(of_rolling, of_spinning);
        -(rolling * per_rolling + spinning * per_spinning)
    }

    /// Ratio of torque to angular speed, N m s, for both parts of the angular velocity (rad/s).
    #[inline]
    pub(crate) fn per_turn(&self, rolling: R, spinning: R) -> [R; 2] {
        [
            self.rolling / (rolling + self.turn_speed),
            self.spinning / (spinning + self.turn_speed),
        ]
    }
}

/// Parts of an angular velocity (rad/s) along the ground and along its normal.
#[inline]
fn split<R: Real>(normal: R::Vec3, angular_velocity: R::Vec3) -> (R::Vec3, R::Vec3) {
    let spinning = normal * normal.dot(angular_velocity);
    (angular_velocity - spinning, spinning)
}

/// A friction law combined with resistance to rolling and to spinning.
///
/// A contact with the normal force N resists with torques of up to `rolling · N` and
/// `spinning · N`: see [`RollingResistance`]. Both lengths are the usual ones:
///
/// * *Rolling:* a wheel that the force `f · N` keeps rolling has `rolling = f · radius`.
/// * *Spinning:* a ball of radius r on an elastic plane has a contact patch of radius `a = √(r d)`
///   at the penetration depth d (Hertz). Coulomb's law under Hertz's pressure gives
///   `spinning = 3π/16 μ a` (Johnson, Contact Mechanics, 1985). On a bed of independent springs
///   (Winkler) the patch has `a = √(2 r d)`, and the same integral gives `spinning = 8/15 μ a`.
///
/// ```
/// use tumble::{Coulomb, WithResistance};
///
/// // A billiard ball on cloth: it rolls out with the deceleration 5/7 · rolling/radius · g.
/// let friction = Coulomb { coefficient: 0.2, slip_speed: 1e-4 }; // -, m/s
/// let cloth = WithResistance { friction, rolling: 2.9e-4, spinning: 1.2e-3, turn_speed: 1e-2 };
/// # use tumble::{Sphere, Stepper};
/// # Stepper::new(Sphere::solid(0.17, 0.0286))?.with_friction(cloth)?;
/// # Ok::<(), tumble::SceneError>(())
/// ```
///
/// *Limits:*
/// - It does not hold a body at rest. A ball on a slope of angle θ, with `tan θ < rolling/radius`,
///   creeps at the angular speed `turn_speed · t/(1 - t)`, `t = tan θ · radius/rolling`.
/// - On a body with many contacts it acts at each of them.
/// - The law inside must have no resistance of its own.
/// - A torque about an axis without inertia (a [`Rod`](crate::Rod)) is left out by
///   `EnergyMomentum`. Explicit methods keep it as angular momentum, which deflects the body when
///   it tilts. The two differ there by some percent of the angular velocity, at any step size.
/// - [`EnergyMomentum`](crate::EnergyMomentum) has the creep of the law at any step size, as long
///   as friction sticks there. A bounce within a step has the resistance of the impulse that the
///   ground gives, where that is less than its mean load. If more than four directions of the
///   ground resist at once, each contact resists as itself, but a step takes more iterations.
/// - In [`EnergyMomentum`](crate::EnergyMomentum) the torque is linear at small angular speeds, if
///   the turn speed is near the rounding of the rotation: in `f32` below 5e-4 of the angular speed
///   of the body. See *Single precision* there.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WithResistance<F, R = f64> {
    /// Law of the friction force.
    pub friction: F,
    /// Largest rolling torque per normal force, m, at least 0.
    pub rolling: R,
    /// Largest spinning torque per normal force, m, at least 0.
    pub spinning: R,
    /// Angular speed at which half of the torque is reached, rad/s, above 0 and a
    /// [safe divisor](crate::error::Rule::SafeDivisor).
    pub turn_speed: R,
}

impl<R: Real, F: SlidingFriction<R>> SlidingFriction<R> for WithResistance<F, R> {
    #[inline]
    fn is_proportional_to_load(&self) -> bool {
        self.friction.is_proportional_to_load()
    }

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

    #[inline]
    fn force_at(&self, position: R::Vec3, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        self.friction.force_at(position, normal_force, slip)
    }

    #[inline]
    fn jacobian_at(
        &self,
        position: R::Vec3,
        normal_force: R,
        slip: R::Vec3,
    ) -> FrictionJacobian<R> {
        self.friction.jacobian_at(position, normal_force, slip)
    }

    #[inline]
    fn metric_at(&self, position: R::Vec3) -> Option<[R::Vec3; 3]> {
        self.friction.metric_at(position)
    }

    #[inline]
    fn depends_on_position(&self) -> bool {
        self.friction.depends_on_position()
    }

    fn check(&self) -> Result<(), SceneError> {
        check_is_one(&self.friction)?;
        self.friction.check()?;
        if self.friction.rolling_resistance(R::ONE).is_some() {
            let quantity = "number of resistances in a law with resistance";
            return Err(SceneError::new(quantity, Rule::Exactly(0), 1.0, ""));
        }
        error::at_least_zero("length of the rolling resistance", self.rolling, " m")?;
        error::at_least_zero("length of the spinning resistance", self.spinning, " m")?;
        error::safe_divisor("turn speed of the resistance", self.turn_speed, " rad/s")
    }
}
