//! Friction that decreases from a static to a kinetic coefficient, and increases again with the
//! speed.

use super::{FrictionJacobian, SlidingFriction};
use crate::error::{self, SceneError};
use crate::real::{Real, Vector};

/// Friction with a static and a kinetic coefficient, joined by Stribeck's curve, and a viscous
/// part.
///
/// With the size u of the slip, `force = -normal_force · slip · (μ(u)/(u + slip_speed) + viscous)`,
/// in newtons, world axes. The coefficient is
/// `μ(u) = kinetic + (static - kinetic)/(1 + (u/stribeck_speed)²)`. The force never adds energy
/// (`force · slip <= 0`) and is finite at zero slip.
///
/// *Sources:* Stribeck, Z. VDI 46, 1341 (1902), for the curve; Hess & Soom, J. Tribol. 112, 147
/// (1990), for the form, which needs no exponential function.
///
/// *Limits:*
/// - It does not stick. It creeps as [`Coulomb`](crate::Coulomb) does with the static coefficient.
/// - The static coefficient is nearly reached if `slip_speed` is far below `stribeck_speed`. With ε
///   and vₛ the two speeds, the force comes nearest to it at the slip
///   `u = (μₛ ε vₛ²/(2 (μₛ - μₖ)))^(1/3)`. There it is smaller by `1.5 ε/u`: 1.5 % for μₛ = 2 μₖ
///   and ε = vₛ/1000.
/// - Where μ decreases, sliding is unstable (squeal, stick-slip), with growth rates up to
///   `0.65 (μₛ - μₖ) g/vₛ`. The step size has to resolve them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stribeck<R = f64> {
    /// Coefficient at slow slip, dimensionless, at least 0.
    pub static_coefficient: R,
    /// Coefficient at fast slip, dimensionless, at least 0.
    pub kinetic_coefficient: R,
    /// Slip at which the coefficient is midway between static and kinetic, m/s, above 0.
    pub stribeck_speed: R,
    /// Viscous friction per normal force, s/m, at least 0.
    pub viscous: R,
    /// Slip at which half of the static force is reached, m/s, above 0 and a
    /// [safe divisor](crate::error::Rule::SafeDivisor).
    pub slip_speed: R,
}

impl<R: Real> Stribeck<R> {
    /// Coefficient at a slip, and minus its derivative (s/m).
    #[inline]
    fn coefficient(&self, speed: R) -> [R; 2] {
        let share = speed / self.stribeck_speed;
        let beyond = self.static_coefficient - self.kinetic_coefficient;
        let per_one = R::ONE / (R::ONE + share * share);
        let falls = beyond * (R::TWO * (share * per_one) * per_one) / self.stribeck_speed;
        [self.kinetic_coefficient + beyond * per_one, falls]
    }
}

impl<R: Real> SlidingFriction<R> for Stribeck<R> {
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
        let speed = slip.length();
        let [coefficient, _] = self.coefficient(speed);
        slip * -((coefficient / (speed + self.slip_speed) + self.viscous) * normal_force)
    }

    /// Derivatives of the force. Where the force decreases with the slip, the growth is limited to
    /// 1, so that the iteration treats the force as constant.
    #[inline]
    fn jacobian(&self, normal_force: R, slip: R::Vec3) -> FrictionJacobian<R> {
        let speed = slip.length();
        let [coefficient, falls] = self.coefficient(speed);
        let width = speed + self.slip_speed;
        let dry = coefficient / width;
        let per_load = dry + self.viscous;
        // force = c u with c = N (μ/w + v): -c' w/c = (μ/w - μ')/(μ/w + v).
        let growth = if per_load > R::ZERO {
            ((dry + falls) / per_load).at_least(R::ZERO).at_most(R::ONE)
        } else {
            R::ZERO
        };
        FrictionJacobian {
            coefficient: per_load * normal_force,
            per_load,
            width,
            growth,
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        error::at_least_zero(
            "static coefficient of friction",
            self.static_coefficient,
            "",
        )?;
        error::at_least_zero(
            "kinetic coefficient of friction",
            self.kinetic_coefficient,
            "",
        )?;
        error::above_zero(
            "Stribeck speed of the friction",
            self.stribeck_speed,
            " m/s",
        )?;
        error::at_least_zero("viscous friction", self.viscous, " s/m")?;
        error::slip_speed(self.slip_speed)
    }
}
