//! Torque-free rotation with three different moments, by a power series in time.
//!
//! Let `l` be the direction of the angular momentum `L` in principal axes, `l₀` its start, and `j`
//! the inverse moments. Euler's equations are `l' = |L| l × (j l)`. They are quadratic, so the
//! coefficients of the series of `l` follow from each other by products of series.
//!
//! `l` gives the rotation except for an angle χ about `L`. The rotation from the start is the
//! shortest rotation from `l₀` to `l`, followed by the rotation about `L` by χ. A shortest rotation
//! does not turn about `l + l₀`, so the angular velocity `j L` gives
//!
//! ```text
//! χ' = |L| (j l)·(l + l₀)/(1 + l·l₀)
//! ```
//! A part of `j` that is common to all axes only adds `|L| j` to `χ'`. The sum `Σ j l²` is
//! constant. So with the excesses `e` of the other two axes over the third,
//!
//! ```text
//! χ' = |L| (j + N/D)      N = Σ e l₀² + Σ e l₀ l      D = 1 + l₀·l
//! ```
//! The quotient is an even function of time.
//!
//! *Number of terms.* Let `A`, `B` and `C` be the rates in `l_a' = A l_b l_c`, `l_b' = B l_c l_a`
//! and `l_c' = C l_a l_b`. Two of the three pairs of rates have opposite signs. For such a pair
//! `A`, `B` the sum `|C| (|B| l_a² + |A| l_b²)` is constant, and the larger one of the two sums is
//! `λ²`, with the rate `λ` of Jacobi's functions. Their poles are at least `π/2λ` from any time.
//! With `x = 2 λ t` the k-th terms of `l` are at most `(π/2) (x/π)^k`, and those of `N/D` are a
//! tenth of that over the largest part of its first term. (Both were computed for 60,000 sets of
//! moments with ratios up to 1e8, many of them on the separatrix, where the bound is sharp.)
//!
//! The terms are summed until the bound is below the rounding of 1. So the result is exact to
//! rounding, and only rounding changes the energy.

use crate::inertia::InertiaProperties;
use crate::real::{Real, Vector};
use crate::rotation::Rotation;

/// Number of terms of a series, enough for the longest step in both precisions.
const TERMS: usize = 24;

/// Direction of a vector, and its length. A vector 0 has the direction 0.
pub(super) fn direction_and_length<R: Real>(vector: R::Vec3) -> (R::Vec3, R) {
    let largest = (vector.x().abs().at_least(vector.y().abs())).at_least(vector.z().abs());
    // Without it the square of a small length would be 0.
    let unit = largest.power_of_two();
    let scaled = vector * (R::ONE / unit);
    let length = scaled.length();
    if length > R::ZERO {
        (scaled * (R::ONE / length), length * unit)
    } else {
        (scaled, length)
    }
}

/// A step. All rates are angles within the step, rad.
pub(super) struct Series<R> {
    /// `A`, `B` and `C`: `|L| (jₖ - jᵢ)` for each axis, of the two axes that follow it.
    rates: [R; 3],
    /// `|L| e` of the first two axes.
    excesses: [R; 2],
    /// `|L| j` of the third axis.
    common: R,
}

impl<R: Real> Series<R> {
    /// Creates the series of a body, for the product of the angular momentum and the time.
    pub(super) fn new(inertia: &InertiaProperties<R>, impulse: R) -> Self {
        let [first, second] = inertia.excesses();
        Self {
            rates: [-second, first, second - first].map(|rate| rate * impulse),
            excesses: [first * impulse, second * impulse],
            common: inertia.common_inverse() * impulse,
        }
    }

    /// Returns `x = 2 λ t` for the direction at the start.
    pub(super) fn extent(&self, [x, y, z]: [R; 3]) -> R {
        let [a, b, c] = self.rates;
        let sum = |[a, b, c]: [R; 3], x: R, y: R| {
            if a * b < R::ZERO {
                c.abs() * (b.abs() * x * x + a.abs() * y * y)
            } else {
                R::ZERO
            }
        };
        let first = sum([a, b, c], x, y).at_least(sum([b, c, a], y, z));
        first.at_least(sum([c, a, b], z, x)).sqrt() * R::TWO
    }

    /// Returns the mean angle about the angular momentum, `2T t/|L|`, rad.
    pub(super) fn angle(&self, [x, y, _]: [R; 3]) -> R {
        let [first, second] = self.excesses;
        self.common + first * x * x + second * y * y
    }

    /// Returns the rotation within the step, world axes. `frame` are the principal axes.
    // Whether the compiler inlines it without a word depends on what else is compiled.
    #[inline(always)]
    pub(super) fn increment(
        &self,
        frame: [R::Vec3; 3],
        direction: R::Vec3,
        extent: R,
    ) -> Rotation<R> {
        let start = frame.map(|axis| axis.dot(direction));
        let ([x, y, z], angle) = self.sum(start, extent);
        let [a, b, c] = frame;
        let change = a * x + b * y + c * z;
        // The shortest rotation, as a Cayley map.
        let tangent = change.cross(direction) * (R::ONE / (R::TWO + change.dot(direction)));
        Rotation::from_half_vector(direction * (angle * R::HALF))
            .after(Rotation::cayley_unscaled(tangent))
    }

    /// Returns `l - l₀` and χ at the end of the step.
    fn sum(&self, start: [R; 3], extent: R) -> ([R; 3], R) {
        let squares = [self.excesses[0] * start[0], self.excesses[1] * start[1]];
        let energy = squares[0] * start[0] + squares[1] * start[1];
        let (mut change, mut angle) = ([R::ZERO; 3], self.common + energy);
        let mut terms = Terms::of(start, energy);
        let ratio = extent * R::from_f64(core::f64::consts::FRAC_1_PI);
        let mut bound = ratio * R::from_f64(core::f64::consts::FRAC_PI_2);
        for order in 1..TERMS {
            let per_order = R::ONE / R::from_usize(order);
            let [x, y, z] = terms.product(order);
            let [a, b, c] = self.rates.map(|rate| rate * per_order);
            let term = [a * x, b * y, c * z];
            change = [
                change[0] + term[0],
                change[1] + term[1],
                change[2] + term[2],
            ];
            terms.add(order, term);
            if order % 2 == 0 {
                let numerator = squares[0] * term[0] + squares[1] * term[1];
                let divisor = start[0] * term[0] + start[1] * term[1] + start[2] * term[2];
                let quotient = terms.quotient(order / 2, numerator, divisor);
                angle += quotient / R::from_usize(order + 1);
            }
            bound *= ratio;
            if bound < R::EPSILON * R::from_f64(0.125) {
                break;
            }
        }
        (change, angle)
    }
}

/// Terms of the series so far.
struct Terms<R> {
    direction: [[R; 3]; TERMS],
    /// Even terms of the quotient and of its divisor.
    quotients: [R; TERMS / 2],
    divisors: [R; TERMS / 2],
}

impl<R: Real> Terms<R> {
    fn of(direction: [R; 3], quotient: R) -> Self {
        let mut terms = Self {
            direction: [[R::ZERO; 3]; TERMS],
            quotients: [R::ZERO; TERMS / 2],
            divisors: [R::ZERO; TERMS / 2],
        };
        terms.direction[0] = direction;
        terms.quotients[0] = quotient;
        terms
    }

    fn add(&mut self, order: usize, direction: [R; 3]) {
        if let Some(term) = self.direction.get_mut(order) {
            *term = direction;
        }
    }

    /// The terms of order `order - 1` of the products of two components of the direction, by the
    /// axis that is not among them.
    fn product(&self, order: usize) -> [R; 3] {
        let terms = self.direction.get(..order).unwrap_or(&[]);
        let [mut x, mut y, mut z] = [R::ZERO; 3];
        for (early, late) in terms.iter().zip(terms.iter().rev()) {
            x += early[1] * late[2];
            y += early[2] * late[0];
            z += early[0] * late[1];
        }
        [x, y, z]
    }

    /// Adds the next even term of the divisor, and returns that of the quotient.
    fn quotient(&mut self, number: usize, numerator: R, divisor: R) -> R {
        if let Some(term) = self.divisors.get_mut(number) {
            *term = divisor;
        }
        let before = self.quotients.get(..number).unwrap_or(&[]);
        let divisors = self.divisors.get(1..=number).unwrap_or(&[]);
        let mut rest = numerator;
        for (quotient, divisor) in before.iter().zip(divisors.iter().rev()) {
            rest -= *quotient * *divisor;
        }
        let next = rest * R::HALF;
        if let Some(term) = self.quotients.get_mut(number) {
            *term = next;
        }
        next
    }
}
