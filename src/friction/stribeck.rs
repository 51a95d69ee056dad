//! Friction that falls from a static to a kinetic coefficient, and rises again with the speed.

use super::{FrictionJacobian, SlidingFriction};
use crate::error::{self, SceneError};
use crate::real::{Real, Vector};

/// Friction with a static and a kinetic coefficient, joined by Stribeck's curve, and a viscous
/// part.
///
/// With the slip's size u: `force = -normal_force · slip · (μ(u)/(u + slip_speed) + viscous)`, in
/// newtons, world axes, with `μ(u) = kinetic + (static - kinetic)/(1 + (u/stribeck_speed)²)`
/// (Stribeck, Z. VDI 46, 1341, 1902, for the curve; Hess & Soom, J. Tribol. 112, 147, 1990, for the
/// form, which needs no power of e). Never adds energy: `force · slip <= 0`. Finite at zero slip.
///
/// *Limits:* it does not stick; it creeps as [`Coulomb`](crate::Coulomb) does with the static
/// coefficient. The static coefficient is nearly reached, where `slip_speed` is far below
/// `stribeck_speed`: at most, at the slip `(μₛ ε vₛ²/(2 (μₛ - μₖ)))^(1/3) = u`, with ε and vₛ the
/// two speeds, the force is short of it by `1.5 ε/u`: 1.5 % for μₛ = 2 μₖ and ε = vₛ/1000. Where μ
/// falls, sliding is unstable (squeal, stick and slip), with growth rates up to
/// `0.65 (μₛ - μₖ) g/vₛ`: a time step has to resolve it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stribeck<R = f64> {
    /// Coefficient of slow slip, dimensionless, at least 0.
    pub static_coefficient: R,
    /// Coefficient of fast slip, dimensionless, at least 0.
    pub kinetic_coefficient: R,
    /// m/s, above 0. The slip at which half of the way between the coefficients is gone.
    pub stribeck_speed: R,
    /// s/m, at least 0. Viscous friction, per normal force.
    pub viscous: R,
    /// m/s, above 0. The slip at which half of the static force is reached.
    pub slip_speed: R,
}

impl<R: Real> Stribeck<R> {
    /// The coefficient at a slip, and minus its derivative (s/m) there.
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
    fn is_trusted(&self) -> bool {
        true
    }

    #[inline]
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        let speed = slip.length();
        let [coefficient, _] = self.coefficient(speed);
        slip * -((coefficient / (speed + self.slip_speed) + self.viscous) * normal_force)
    }

    /// Where the force falls with the slip, the growth is the largest that there is, 1: the
    /// iteration takes the force as steady.
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
        error::above_zero("slip speed of the friction", self.slip_speed, " m/s")
    }
}
