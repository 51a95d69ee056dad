//! Contact law of Hunt and Crossley, with Hertz's exponent or any other.

use super::bounce::{self, Carried, Impact};
use super::{ContactLaw, MeanForce};
use crate::error::{self, Rule, SceneError};
use crate::quadrature::OUTER_OF_3;
use crate::real::Real;

/// Hunt and Crossley's law (J. Appl. Mech. 42, 440, 1975): a nonlinear spring with a damper force
/// proportional to the spring force.
///
/// `normal force = k dⁿ max(0, 1 + λ u)` in newtons, for stiffness k, depth d, exponent n, damping
/// λ and closing speed u. The energy in the spring is `k d^(n+1)/(n+1)`.
///
/// | exponent | spring |
/// |---|---|
/// | 3/2 | an elastic ball on an elastic plane (Hertz 1881; [`hertz`](Self::hertz)) |
/// | 1 | a linear spring |
/// | 2 | a cone |
///
/// With these three exponents a force costs no more than a square root. Other exponents use the
/// power function of `libm`, about 50 ns.
///
/// A point that touches down at speed v separates with restitution e, where
/// `λ v (1 + e) = ln((1 + λ v)/(1 - e λ v))` for every exponent, stiffness and mass. The
/// restitution is `1 - 2 λ v/3` for slow bounces and `1/(λ v)` at most. The contact never separates
/// while the ground pushes, and the force is continuous at touch-down.
///
/// *Limits:* at small depth the damping is weak. A body that settles at the depth d oscillates with
/// the damping ratio `λ g/(2ω)`, `ω² = n g/d`. It takes long to come to rest where `λ v` is small.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HuntCrossley<R = f64> {
    /// Stiffness per contact, N/mⁿ, at least 0.
    pub stiffness: R,
    /// Exponent n of the depth, dimensionless, at least 1.
    pub exponent: R,
    /// Damping λ, s/m, at least 0.
    pub damping: R,
}

/// Relative length of a path below which Gauss's rule is more accurate than the difference of the
/// energies: difference of the depths over their sum.
///
/// On shorter paths the error of the rule is below 1e-14 of the force for exponents up to 3. The
/// error of the difference is 50 units in the last place.
const SHORT: f64 = 0.02;

impl<R: Real> HuntCrossley<R> {
    /// Creates Hertz's contact of an elastic ball of this radius (m) with an elastic plane, without
    /// damping.
    ///
    /// The exponent is 3/2 and the stiffness `4/3 E √r`. The modulus E (Pa) combines both
    /// materials: `1/E = (1-ν₁²)/E₁ + (1-ν₂²)/E₂`.
    ///
    /// *Limits:* depths below a tenth of the radius, no adhesion, and speeds small compared with
    /// the speed of sound.
    #[must_use]
    pub fn hertz(modulus: R, radius: R) -> Self {
        Self {
            stiffness: modulus * radius.sqrt() * R::from_f64(4.0 / 3.0),
            exponent: R::from_f64(1.5),
            damping: R::ZERO,
        }
    }

    /// Creates the law by which a body penetrates by `depth` (m, above 0) in an impact of this
    /// speed and restitution, with this `exponent` (at least 1).
    ///
    /// The result holds without gravity during the bounce, for contacts that touch together under
    /// the centre of mass. The damping λ solves the relation of [`HuntCrossley`] between
    /// restitution and speed v. The stiffness is then
    /// `(n + 1) m (v/λ - ln(1 + λ v)/λ²)/depth^(n+1)`, with the exponent n and the mass m that each
    /// contact carries (`carried.mass/carried.contacts`). An elastic bounce with exponent 3/2 takes
    /// `2.943 depth/speed`.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a number is outside its range, or if the stiffness or the damping
    /// overflows, or if the stiffness is rounded to 0.
    pub fn from_bounce(
        carried: Carried<R>,
        exponent: R,
        impact: Impact<R>,
        depth: R,
    ) -> Result<Self, SceneError> {
        let loss = impact.loss()?;
        check_exponent(exponent)?;
        error::above_zero("depth of a bounce", depth, " m")?;
        let speed = impact.speed.to_f64();
        Self::with_loss(carried, exponent, loss, speed, depth.to_f64())
    }

    /// Creates the law by which an impact of this speed and restitution takes `contact_time` (s).
    ///
    /// The greatest depth is `contact_time · speed/c`, and [`from_bounce`](Self::from_bounce) gives
    /// the law for this depth. The number c depends on exponent and restitution only:
    ///
    /// | exponent | e = 1 | 0.9 | 0.75 | 0.5 | 0.25 |
    /// |---|---|---|---|---|---|
    /// | 1 | 3.1416 | 3.3127 | 3.6371 | 4.5138 | 6.7623 |
    /// | 3/2 | 2.9433 | 3.1039 | 3.4104 | 4.2495 | 6.4492 |
    /// | 2 | 2.8044 | 2.9577 | 3.2517 | 4.0647 | 6.2315 |
    ///
    /// Without loss, `c = 2/(n + 1) B(1/2, 1/(n + 1))` with Euler's beta function: π for a linear
    /// spring, 2.943 for Hertz's. With loss, c is an integral, computed by Gauss's rule. The
    /// constructor then costs about 400 powers and exponentials. A faster bounce of the same
    /// law is shorter, in proportion to `speed^(-(n-1)/(n+1))` where the loss is small.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a number is outside its range, or if the stiffness or the damping
    /// overflows, or if the stiffness is rounded to 0.
    pub fn from_contact_time(
        carried: Carried<R>,
        exponent: R,
        impact: Impact<R>,
        contact_time: R,
    ) -> Result<Self, SceneError> {
        let loss = impact.loss()?;
        check_exponent(exponent)?;
        error::above_zero("time of a bounce", contact_time, " s")?;
        let [speed, restitution] = [impact.speed, impact.restitution].map(Real::to_f64);
        let depths = bounce::hunt_crossley_time(exponent.to_f64(), restitution, loss);
        let depth = contact_time.to_f64() * speed / depths;
        Self::with_loss(carried, exponent, loss, speed, depth)
    }

    /// Creates the law by which a body that hits with this speed (m/s) penetrates by this depth
    /// (m), with the loss `λ v`.
    fn with_loss(
        carried: Carried<R>,
        exponent: R,
        loss: f64,
        speed: f64,
        depth: f64,
    ) -> Result<Self, SceneError> {
        let power = exponent.to_f64() + 1.0;
        let work = carried.by_each()? * speed * speed * bounce::work_down(loss);
        let law = Self {
            stiffness: R::from_f64(work * power / libm::pow(depth, power)),
            exponent,
            damping: R::from_f64(loss / speed),
        };
        law.check()?;
        error::above_zero("stiffness of the ground", law.stiffness, " N/m^n")?;
        Ok(law)
    }

    /// Creates the law on which a body penetrates by `sink_depth` (m, above 0) at rest under a
    /// gravity of this size (m/s², above 0), and that gives this impact its restitution.
    ///
    /// The stiffness is `m g/sink_depthⁿ`, with the exponent n and the mass m that each contact
    /// carries (`carried.mass/carried.contacts`). The damping is that of
    /// [`from_bounce`](Self::from_bounce).
    ///
    /// # Errors
    /// Returns [`SceneError`] if a number is outside its range, or if the stiffness or the damping
    /// overflows, or if the stiffness is rounded to 0.
    pub fn from_rest(
        carried: Carried<R>,
        exponent: R,
        impact: Impact<R>,
        sink_depth: R,
        gravity: R,
    ) -> Result<Self, SceneError> {
        let loss = impact.loss()?;
        check_exponent(exponent)?;
        error::above_zero("depth at rest", sink_depth, " m")?;
        error::above_zero("gravity", gravity, " m/s²")?;
        let weight = carried.by_each()? * gravity.to_f64();
        let power = libm::pow(sink_depth.to_f64(), exponent.to_f64());
        let law = Self {
            stiffness: R::from_f64(weight / power),
            exponent,
            damping: R::from_f64(loss / impact.speed.to_f64()),
        };
        law.check()?;
        error::above_zero("stiffness of the ground", law.stiffness, " N/m^n")?;
        Ok(law)
    }

    /// Power `dⁿ` of a depth.
    #[inline]
    fn power(&self, depth: R) -> R {
        match self.kind() {
            Kind::Linear => depth,
            Kind::Hertz => depth * depth.sqrt(),
            Kind::Square => depth * depth,
            Kind::Any => depth.powf(self.exponent),
        }
    }

    #[inline]
    fn kind(&self) -> Kind {
        if self.exponent == R::ONE {
            Kind::Linear
        } else if self.exponent == R::from_f64(1.5) {
            Kind::Hertz
        } else if self.exponent == R::TWO {
            Kind::Square
        } else {
            Kind::Any
        }
    }

    /// Mean force of the spring between two depths of at least 0, `ΔV/Δd`, and its derivative with
    /// respect to the second.
    #[inline]
    fn mean_spring(&self, from: R, to: R) -> [R; 2] {
        let k = self.stiffness;
        match self.kind() {
            Kind::Linear => [k * ((from + to) * R::HALF), k * R::HALF],
            Kind::Hertz => mean_of_hertz(from, to).map(|mean| k * mean),
            Kind::Square => {
                let third = k * R::from_f64(1.0 / 3.0);
                let squares = from * from + from * to + to * to;
                [third * squares, third * (from + to * R::TWO)]
            }
            Kind::Any => self.mean_of_any(from, to),
        }
    }

    fn mean_of_any(&self, from: R, to: R) -> [R; 2] {
        let (path, sum) = (to - from, from + to);
        if path.abs() > sum * R::from_f64(SHORT) {
            let mean = (self.spring_energy(to) - self.spring_energy(from)) / path;
            let slope = (self.spring_force(to) - mean) / path;
            return [mean, slope.at_least(R::ZERO)];
        }
        // Gauss's rule with three points, and its derivative.
        let middle = sum * R::HALF;
        if middle <= R::ZERO {
            return [R::ZERO; 2];
        }
        let outer = R::from_f64(0.5 * OUTER_OF_3);
        let depths = [middle, middle - path * outer, middle + path * outer];
        let [force, low, high] = depths.map(|depth| self.spring_force(depth));
        let [inner, lower, upper] = [force / depths[0], low / depths[1], high / depths[2]];
        let (of_middle, of_others) = (R::from_f64(4.0 / 9.0), R::from_f64(5.0 / 18.0));
        let mean = (low + high) * of_others + force * of_middle;
        let others = lower * (R::HALF - outer) + upper * (R::HALF + outer);
        let slope = self.exponent * (others * of_others + inner * R::HALF * of_middle);
        [mean, slope]
    }
}

/// Exponents without a power function, and the others.
#[derive(Clone, Copy)]
enum Kind {
    Linear,
    Hertz,
    Square,
    Any,
}

/// Mean of `d^(3/2)` between two depths, and its derivative with respect to the second.
///
/// With u and v the square roots of the depths, they are `2/5 (u⁴ + u³v + u²v² + uv³ + v⁴)/(u + v)`
/// and `1/5 (2u³ + 4u²v + 6uv² + 3v³)/(u + v)²`. No difference in them can cancel.
#[inline]
fn mean_of_hertz<R: Real>(from: R, to: R) -> [R; 2] {
    let (u, v) = (from.sqrt(), to.sqrt());
    let sum = u + v;
    if sum <= R::ZERO {
        return [R::ZERO; 2];
    }
    let n = R::from_f64;
    let fourth = from * from + (from + to) * (u * v) + from * to + to * to;
    // Each root over the sum is at most 1, which avoids a small square as divisor.
    let (p, q) = (u / sum, v / sum);
    let third = n(2.0) * p * p * u + n(4.0) * p * q * u + n(6.0) * p * q * v + n(3.0) * q * q * v;
    [n(0.4) * (fourth / sum), n(0.2) * third]
}

impl<R: Real> ContactLaw<R> for HuntCrossley<R> {
    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }

    #[inline]
    fn spring_force(&self, depth: R) -> R {
        // A stiffness of 0 times a power that overflows is NaN, of which this is 0.
        (self.stiffness * self.power(depth)).at_least(R::ZERO)
    }

    #[inline]
    fn spring_energy(&self, depth: R) -> R {
        let energy = self.stiffness * (self.power(depth) * depth) / (self.exponent + R::ONE);
        energy.at_least(R::ZERO)
    }

    #[inline]
    fn normal_force(&self, depth: R, closing_speed: R) -> R {
        let factor = R::ONE + self.damping * closing_speed;
        // The product has the limit, not the factor: a spring force that overflows times 0 is NaN.
        (self.stiffness * self.power(depth) * factor).at_least(R::ZERO)
    }

    /// Mean force `(1 + λ Δ/h) ΔV/Δ`, with Δ the path length and h the time. On a path of constant
    /// rate the factor of the damper is constant.
    #[inline]
    fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        let (from, to) = (start.at_least(R::ZERO), end.at_least(R::ZERO));
        if from + to <= R::ZERO {
            return MeanForce::NONE;
        }
        let path = end - start;
        let factor = R::ONE + self.damping * (path / seconds);
        if factor <= R::ZERO {
            return MeanForce::NONE;
        }
        let [mut spring, mut stiffness] = self.mean_spring(from, to);
        if end <= R::ZERO {
            // The contact separates: the path above the ground reduces the mean.
            spring *= from / -path;
            stiffness = spring / -path;
        } else if start < R::ZERO {
            let share = end / path;
            stiffness = (share * stiffness) + spring * ((R::ONE - share) / path);
            spring *= share;
        }
        MeanForce {
            force: factor * spring,
            slope: factor * stiffness + (self.damping / seconds) * spring,
            stiffness: factor * stiffness,
            damping: self.damping * spring,
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        error::at_least_zero("stiffness of the ground", self.stiffness, " N/m^n")?;
        check_exponent(self.exponent)?;
        error::at_least_zero("damping of the ground", self.damping, " s/m")
    }
}

fn check_exponent<R: Real>(exponent: R) -> Result<(), SceneError> {
    let quantity = "exponent of the ground";
    error::finite(quantity, exponent, "")?;
    if exponent >= R::ONE {
        return Ok(());
    }
    let value = exponent.to_f64();
    Err(SceneError::new(quantity, Rule::AtLeast(1), value, ""))
}
