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
/// - With [`EnergyMomentum`](crate::EnergyMomentum), a step of an impact that ends in stick often
///   finds no solution and is divided, and the result depends on the phase: in half of the impacts
///   of a ball at a ratio of the coefficients of 0.4, a quarter at 0.6, none at 0.9.
/// - With [`EnergyMomentum`](crate::EnergyMomentum), stick and rolling cost more at small slip
///   speeds. A ball or a box in a wind takes five iterations a step at a slip speed of 1e-3 m/s,
///   and at most twelve down to 1e-9 m/s if the ratio of the coefficients is 0.9. At a ratio of 0.5
///   it takes 20 to 40 from 1e-5 m/s on, and steps are divided: 1 of 100 at 1e-5 m/s, up to 2 of 3
///   at 1e-7, and nearly all at 1e-9.
/// - It does not stick. It creeps as `Coulomb` does, with a slip speed of
///   `slip_speed · max(μ₁, μ₂)/μ`, where μ is the coefficient in the direction of the slip.
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
    /// m/s, above 0.
    pub slip_speed: R,
}

impl<R: Real> AnisotropicCoulomb<R> {
    /// Creates the law for the plane with this normal and a grain in this direction.
    ///
    /// Both vectors have any length above 0. The direction is projected onto the plane.
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

    /// Derivative of the force with respect to the slip for a unit load, with the opposite sign, in
    /// the axes of the grain, s/m. `components` are those of the slip, m/s.
    ///
    /// With `w = (μ₁ u₁, μ₂ u₂)` the force is `-μᵢ wᵢ/W`, `W = |w| + w₀`.
    fn derivative(&self, components: [R; 2]) -> [[R; 2]; 2] {
        let coefficients = self.coefficients;
        let w = [0, 1].map(|i| coefficients[i] * components[i]);
        let (u, speed) = direction_of(w);
        let width = speed + self.larger() * self.slip_speed;
        let share = speed / width;
        [0, 1].map(|i| {
            [0, 1].map(|j| {
                let of_unit = identity::<R>(i, j) - u[i] * u[j] * share;
                coefficients[i] * coefficients[j] * of_unit / width
            })
        })
    }
}

/// Direction of a vector of two components, or 0, and its length.
fn direction_of<R: Real>([x, y]: [R; 2]) -> ([R; 2], R) {
    let length = (x * x + y * y).sqrt();
    if length > R::ZERO {
        ([x / length, y / length], length)
    } else {
        ([R::ZERO; 2], R::ZERO)
    }
}

/// Element of the unit matrix.
fn identity<R: Real>(i: usize, j: usize) -> R {
    if i == j { R::ONE } else { R::ZERO }
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

    fn anisotropy_at(&self, _: R::Vec3, _: R, slip: R::Vec3) -> Option<[R::Vec3; 3]> {
        let jacobian = self.jacobian(R::ONE, slip);
        if jacobian.coefficient <= R::ZERO {
            return None;
        }
        let components = [self.along.dot(slip), self.across.dot(slip)];
        let whole = self.derivative(components);
        // What the scalar derivatives say.
        let (u, speed) = direction_of(components);
        let along_slip = jacobian.growth * speed / jacobian.width;
        let more = |i: usize, j: usize| {
            let isotropic = identity::<R>(i, j) - u[i] * u[j] * along_slip;
            whole[i][j] / jacobian.coefficient - isotropic
        };
        let (a, b) = (self.along, self.across);
        let of_a = a * more(0, 0) + b * more(0, 1);
        let of_b = a * more(1, 0) + b * more(1, 1);
        let row = |a: R, b: R| of_a * a + of_b * b;
        Some([row(a.x(), b.x()), row(a.y(), b.y()), row(a.z(), b.z())])
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
