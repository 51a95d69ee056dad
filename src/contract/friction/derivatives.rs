//! Derivatives of a friction law, compared with differences of its force.
//!
//! With the coefficient `c = -force · slip/slip²`, the load N and the slip s, the logarithmic
//! derivatives are compared:
//!
//! ```text
//! N/c dc/dN = N per_load/c        -s/c dc/ds = growth s/width
//! ```
//! Each is measured by two differences, to a point just below and to one just above. A value
//! between the two is right, so that a law may have a derivative that jumps.

use crate::contract::{Input, Requirement, Violation, demand_at_least, demand_at_most};
use crate::friction::{FrictionJacobian, SlidingFriction};
use crate::real::{Real, Vector};

/// A contact that slides.
pub(super) struct Slide<'a, R: Real, F: ?Sized> {
    pub(super) friction: &'a F,
    pub(super) position: R::Vec3,
    pub(super) load: R,
    pub(super) slip: R::Vec3,
}

impl<R: Real, F: SlidingFriction<R> + ?Sized> Slide<'_, R, F> {
    /// Checks `per_load`, `growth` and `width`. Where there is no force they have no effect.
    pub(super) fn check(&self, input: impl Fn() -> Input + Copy) -> Result<(), Violation> {
        let coefficient = self.coefficient(R::ONE, R::ONE);
        if !self.is_resolved(coefficient) {
            return Ok(());
        }
        let (told, rounding) = (self.jacobian(R::ONE), self.rounding(coefficient));
        let measured = around(|factor| self.coefficient(factor, R::ONE) / coefficient);
        let per_load = Told {
            value: told.per_load,
            unit: coefficient / self.load,
            requirement: Requirement::PerLoadFits,
            rounding,
        };
        per_load.check(measured, input)?;
        self.check_growth(coefficient, &told, rounding, input)
    }

    /// Checks the growth, which is the measured one limited to 0 to 1.
    ///
    /// If it was limited to 1, the force decreases by more than the growth tells, and a wrong width
    /// would not show. The width must then grow by 1, as it says.
    fn check_growth(
        &self,
        coefficient: R,
        told: &FrictionJacobian<R>,
        rounding: R,
        input: impl Fn() -> Input + Copy,
    ) -> Result<(), Violation> {
        let speed = self.slip.length();
        let most = speed / told.width;
        let growth = Told {
            value: told.growth,
            unit: R::ONE / most,
            requirement: Requirement::GrowthFits,
            rounding,
        };
        let falls = around(|factor| self.coefficient(R::ONE, factor) / coefficient).map(|d| -d);
        let limited = falls.map(|fall| fall.at_least(R::ZERO).at_most(most));
        growth.check(limited, input)?;
        let is_limited = falls.iter().all(|fall| *fall > most + rounding);
        if is_limited {
            let widens = around(|factor| self.jacobian(factor).width / speed).map(|d| d * most);
            growth.check(widens, input)?;
        }
        Ok(())
    }

    fn jacobian(&self, factor: R) -> FrictionJacobian<R> {
        (self.friction).jacobian_at(self.position, self.load, self.slip * factor)
    }

    /// Ratio of force and slip with load and slip multiplied by factors.
    fn coefficient(&self, load: R, slip: R) -> R {
        let slip = self.slip * slip;
        let per_speed = R::ONE / slip.length();
        let force = (self.friction).force_at(self.position, self.load * load, slip);
        -(force.dot(slip * per_speed) * per_speed)
    }

    /// Truncation and rounding of a logarithmic derivative, also of one that the law computes
    /// by differences. They are larger if the force is nearly perpendicular to the slip.
    fn rounding(&self, coefficient: R) -> R {
        let force = (self.friction).force_at(self.position, self.load, self.slip);
        let braking = coefficient * self.slip.length();
        R::EPSILON.sqrt() * R::from_f64(32.0) * (force.length() / braking)
    }

    /// Returns true if force and slip are so far from 0 that no product underflows.
    fn is_resolved(&self, coefficient: R) -> bool {
        let square = self.slip.length_squared();
        let tiny = R::ONE / (R::MAX * R::EPSILON * R::EPSILON);
        [self.load, square, coefficient, coefficient * square]
            .into_iter()
            .all(|value| value.is_finite() && value > tiny)
    }
}

/// Fraction by which load and slip are changed. The truncation of a difference is of this size, and
/// its rounding is that of a force over it.
fn change<R: Real>() -> R {
    R::EPSILON.sqrt() * R::from_f64(4.0)
}

/// Factor of the largest load and slip of a check, so that the changed ones do not exceed them.
pub(super) fn inward<R: Real>() -> R {
    R::ONE - change::<R>()
}

/// Changes of a function with its factor, below and above 1, over that of the factor.
fn around<R: Real>(function: impl Fn(R) -> R) -> [R; 2] {
    let middle = function(R::ONE);
    [-change::<R>(), change()].map(|change| (function(R::ONE + change) - middle) / change)
}

/// A number of a Jacobian, as a logarithmic derivative in a unit.
struct Told<R> {
    value: R,
    unit: R,
    requirement: Requirement,
    /// Error of the measured derivatives.
    rounding: R,
}

impl<R: Real> Told<R> {
    /// Checks that the number is between two measured ones.
    fn check(&self, [a, b]: [R; 2], input: impl Fn() -> Input + Copy) -> Result<(), Violation> {
        // The law may compute the derivative by differences, whose error grows with it.
        let rounding = self.rounding * (R::ONE + a.abs().at_least(b.abs()));
        let least = (a.at_most(b) - rounding) * self.unit;
        let most = (a.at_least(b) + rounding) * self.unit;
        demand_at_least(self.value, least, self.requirement, input)?;
        demand_at_most(self.value, most, self.requirement, input)
    }
}

#[cfg(test)]
mod tests;
