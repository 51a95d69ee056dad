//! Coulomb friction that differs with the direction of the slip.

use super::{FrictionJacobian, SlidingFriction};
use crate::error::{self, Rule, SceneError};
use crate::real::{Real, Vector};

/// Coulomb friction with two coefficients, along and across a grain of the ground: planks, brushed
/// metal, a court's lines.
///
/// With p and q the slip's components along and across, each times its coefficient:
/// `force = -normal_force (μ₁ p a + μ₂ q b)/(√(p² + q²) + max(μ₁, μ₂) · slip_speed)`, in newtons,
/// for the unit vectors a and b, world axes. A large slip meets a force on the ellipse with the
/// half axes `μ₁ N` and `μ₂ N`, in the direction that takes most energy (the associated law; e.g.
/// Michałowski & Mróz, Arch. Mech. 30, 259, 1978). Never adds energy: `force · slip <= 0`. With
/// both coefficients the same it is [`Coulomb`](crate::Coulomb).
///
/// *Limits:* one plane: on another surface the force leaves it (and takes energy all the same).
/// Across the slip it pushes towards the easier direction by up to `|μ₁² - μ₂²|/(μ₁² + μ₂²)` of
/// itself. It does not stick: as of `Coulomb`, with the creep speed `slip_speed · max(μ₁, μ₂)/μ`
/// times that of the direction's own coefficient μ.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "R: serde::Serialize, R::Vec3: serde::Serialize",
        deserialize = "R: serde::Deserialize<'de>, R::Vec3: serde::Deserialize<'de>"
    ))
)]
pub struct AnisotropicCoulomb<R: Real = f64> {
    /// Unit vector in the ground's plane, along the grain, world axes.
    pub along: R::Vec3,
    /// Unit vector in the ground's plane, at right angles to `along`.
    pub across: R::Vec3,
    /// Along and across the grain, dimensionless, at least 0.
    pub coefficients: [R; 2],
    /// m/s, above 0. The slip at which half of the full force is reached, in the direction of the
    /// larger coefficient.
    pub slip_speed: R,
}

impl<R: Real> AnisotropicCoulomb<R> {
    /// On the plane with this normal, with a grain in this direction (both of any length above 0;
    /// of the direction, what lies in the plane counts).
    #[must_use]
    pub fn on(normal: R::Vec3, direction: R::Vec3, coefficients: [R; 2], slip_speed: R) -> Self {
        let unit = |v: R::Vec3| v * (R::ONE / v.length());
        let across = unit(normal.cross(direction));
        Self {
            along: unit(across.cross(normal)),
            across,
            coefficients,
            slip_speed,
        }
    }

    #[inline]
    fn larger(&self) -> R {
        let [along, across] = self.coefficients;
        along.at_least(across)
    }
}

impl<R: Real> SlidingFriction<R> for AnisotropicCoulomb<R> {
    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }

    #[inline]
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        let [along, across] = self.coefficients;
        let (p, q) = (along * self.along.dot(slip), across * self.across.dot(slip));
        let width = (p * p + q * q).sqrt() + self.larger() * self.slip_speed;
        if width > R::ZERO {
            let load = -(normal_force / width);
            self.along * (along * p * load) + self.across * (across * q * load)
        } else {
            R::Vec3::ZERO
        }
    }

    #[inline]
    fn jacobian(&self, normal_force: R, slip: R::Vec3) -> FrictionJacobian<R> {
        let [along, across] = self.coefficients;
        let speed = slip.length();
        // The square of the coefficient in the slip's direction; without slip, of the two together.
        let square = if speed > R::ZERO {
            let slip = slip * (R::ONE / speed);
            let (p, q) = (along * self.along.dot(slip), across * self.across.dot(slip));
            p * p + q * q
        } else {
            (along * along + across * across) * R::HALF
        };
        let coefficient = square.sqrt();
        if coefficient <= R::ZERO {
            return FrictionJacobian::NONE;
        }
        let width = speed + self.slip_speed * (self.larger() / coefficient);
        let per_load = coefficient / width;
        FrictionJacobian {
            coefficient: per_load * normal_force,
            per_load,
            width,
            growth: R::ONE,
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        let close = R::EPSILON * R::from_f64(16.0);
        for direction in [self.along, self.across] {
            let length = direction.length();
            let is_one = (length - R::ONE).abs() <= close;
            if !is_one {
                return Err(SceneError::new(
                    "direction of the friction",
                    Rule::UnitLength,
                    length.to_f64(),
                    "",
                ));
            }
        }
        let cosine = self.along.dot(self.across);
        if cosine.abs() > close {
            return Err(SceneError::new(
                "cosine between the directions of the friction",
                Rule::Zero,
                cosine.to_f64(),
                "",
            ));
        }
        for coefficient in self.coefficients {
            error::at_least_zero("coefficient of friction", coefficient, "")?;
        }
        error::above_zero("slip speed of the friction", self.slip_speed, " m/s")
    }
}
