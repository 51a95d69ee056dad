//! Coulomb friction that depends on the direction of the slip.

use super::{FrictionJacobian, SlidingFriction};
use crate::error::{self, Rule, SceneError};
use crate::real::{Real, Vector, scaled, unit};

/// Coulomb friction with two coefficients, along and across the grain of the ground: planks,
/// brushed metal, the lines of a court.
///
/// `force = -normal_force (μ₁ p a + μ₂ q b)/(√(p² + q²) + max(μ₁, μ₂) · slip_speed)`, in newtons.
/// The unit vectors a and b (world axes) point along and across the grain. The speeds p and q are
/// the components of the slip along and across it, each times its coefficient.
///
/// At a large slip the force is on the ellipse with the half axes `μ₁ N` and `μ₂ N`, in the
/// direction that dissipates most energy (the associated law; e.g. Michałowski & Mróz, Arch. Mech.
/// 30, 259, 1978). The force never adds energy: `force · slip <= 0`. With equal coefficients the
/// law is [`Coulomb`](crate::Coulomb).
///
/// *Limits:*
/// - The law is made for one plane. On another surface its force has a component along the normal,
///   whose work no energy audit counts: methods other than
///   [`EnergyMomentum`](crate::EnergyMomentum) can gain energy there.
/// - The force has a component across the slip, towards the direction of the smaller coefficient.
///   It is up to `|μ₁² - μ₂²|/(μ₁² + μ₂²)` of the force.
/// - It does not stick. Where the load points along the grain or across it, it creeps as `Coulomb`
///   does, with a slip speed of `slip_speed · max(μ₁, μ₂)/μ`, where μ is the coefficient in that
///   direction. In another direction it also creeps sideways, at an angle of up to
///   `asin(|μ₁² - μ₂²|/(μ₁² + μ₂²))`.
/// - In a step of [`EnergyMomentum`](crate::EnergyMomentum) with a
///   [`fallback`](crate::Step::fallback), friction has the size of the law's force and the opposite
///   direction of the slip, without the component across it.
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
    /// Unit vector in the ground's plane, perpendicular to `along`, world axes.
    pub across: R::Vec3,
    /// Coefficients along and across the grain, dimensionless, at least 0.
    pub coefficients: [R; 2],
    /// Slip at which half of the full force is reached, in the direction of the larger coefficient,
    /// m/s, above 0 and a [safe divisor](crate::error::Rule::SafeDivisor), also times that
    /// coefficient.
    pub slip_speed: R,
}

impl<R: Real> AnisotropicCoulomb<R> {
    /// Creates the law for the plane with this normal and a grain in this direction.
    ///
    /// The ground must have this normal. On another one the force has a component across it.
    ///
    /// Both vectors have any length above 0. The direction is projected onto the plane, so it must
    /// not be parallel to the normal. Otherwise the unit vectors of the law are NaN, and a scene
    /// with it returns an error.
    #[must_use]
    pub fn on(normal: R::Vec3, direction: R::Vec3, coefficients: [R; 2], slip_speed: R) -> Self {
        let [normal, direction] = [normal, direction].map(scaled::<R>);
        let across = unit::<R>(normal.cross(direction));
        Self {
            along: unit::<R>(across.cross(normal)),
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
    fn is_proportional_to_load(&self) -> bool {
        true
    }

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
        // Square of the coefficient in the direction of the slip. At zero slip it combines both
        // coefficients.
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

    #[inline]
    fn metric_at(&self, _: R::Vec3) -> Option<[R::Vec3; 3]> {
        let ([along, across], a, b) = (self.coefficients, self.along, self.across);
        let row = |of_a: R, of_b: R| a * (along * of_a) + b * (across * of_b);
        Some([row(a.x(), b.x()), row(a.y(), b.y()), row(a.z(), b.z())])
    }

    fn check(&self) -> Result<(), SceneError> {
        let close = R::EPSILON * R::from_f64(16.0);
        for (name, direction) in [
            ("direction of the friction along the grain", self.along),
            ("direction of the friction across the grain", self.across),
        ] {
            let length = direction.length();
            let is_one = (length - R::ONE).abs() <= close;
            if !is_one {
                let length = length.to_f64();
                return Err(SceneError::new(name, Rule::UnitLength, length, ""));
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
        let [along, across] = self.coefficients;
        error::at_least_zero("coefficient of friction along the grain", along, "")?;
        error::at_least_zero("coefficient of friction across the grain", across, "")?;
        error::slip_speed(self.slip_speed)?;
        // The law divides by this product.
        let width = self.larger() * self.slip_speed;
        if self.larger() > R::ZERO {
            error::safe_divisor(
                "slip speed times coefficient of the friction",
                width,
                " m/s",
            )?;
        }
        Ok(())
    }
}
