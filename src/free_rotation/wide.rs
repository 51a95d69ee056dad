//! Numbers of twice the precision: the sum of a number and a small rest.
//!
//! A phase of a thousand revolutions needs three decimal digits more than the result. A product is
//! split as by Dekker (Numerische Mathematik 18, 1971), without fused operations. The upper half of
//! a number is its upper digits, without rounding, so that the lower halves of two f64 have a
//! product of up to 54 digits. Its rounding is below `EPSILON²` of the whole, and all other steps
//! are exact.
//!
//! Products, quotients and roots leave the rest as it comes, which may be some units in the last
//! place of the leading part. No leading part waits for a rest. What is neglected is the product of
//! two rests. Relative errors are a few `EPSILON²`: 1e-31 in f64 and 1e-13 in f32. Sums and
//! differences in which the leading parts may cancel make the rest small again.

use crate::real::Real;

/// The number `high + low`, where `low` is at most a few units in the last place of `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wide<R> {
    pub(super) high: R,
    pub(super) low: R,
}

impl<R: Real> Wide<R> {
    pub(super) const ZERO: Self = Self {
        high: R::ZERO,
        low: R::ZERO,
    };
    pub(super) const ONE: Self = Self {
        high: R::ONE,
        low: R::ZERO,
    };

    #[inline]
    pub(super) fn new(high: R) -> Self {
        Self { high, low: R::ZERO }
    }

    /// Creates the number `first + rest` from two f64, of which f32 keeps its part.
    #[inline]
    pub(super) fn from_f64(first: f64, rest: f64) -> Self {
        let high = R::from_f64(first);
        let low = R::from_f64(first - high.to_f64() + rest);
        Self { high, low }
    }

    /// Sum of two numbers, exact.
    #[inline]
    pub(super) fn sum(a: R, b: R) -> Self {
        let high = a + b;
        let of_b = high - a;
        let low = (a - (high - of_b)) + (b - of_b);
        Self { high, low }
    }

    /// Sum of two numbers, exact for `|a| >= |b|`.
    #[inline]
    fn ordered_sum(a: R, b: R) -> Self {
        let high = a + b;
        let low = b - (high - a);
        Self { high, low }
    }

    /// Product of two numbers, exact in f32, and with an error below `EPSILON²` in f64.
    #[inline]
    pub(super) fn product(a: R, b: R) -> Self {
        let high = a * b;
        let ([a, a_rest], [b, b_rest]) = (halves(a), halves(b));
        let low = ((a * b - high) + a * b_rest + a_rest * b) + a_rest * b_rest;
        Self { high, low }
    }

    /// Sum with a small `low`, also if the leading parts cancel.
    #[inline]
    pub(super) fn plus(self, other: Self) -> Self {
        let sum = Self::sum(self.high, other.high);
        Self::ordered_sum(sum.high, sum.low + (self.low + other.low))
    }

    /// Sum with a number whose `high` is not larger in magnitude. `low` is added as it comes.
    #[inline]
    pub(super) fn plus_smaller(self, other: Self) -> Self {
        Self::ordered_sum(self.high, other.high).and(self.low + other.low)
    }

    /// Adds a small number to the lower part.
    #[inline]
    fn and(self, small: R) -> Self {
        Self {
            high: self.high,
            low: self.low + small,
        }
    }

    /// The nearest number of single width.
    #[inline]
    pub(super) fn nearest(self) -> R {
        self.high + self.low
    }

    #[inline]
    pub(super) fn minus(self, other: Self) -> Self {
        self.plus(other.negated())
    }

    /// Returns true if the number is below the other one.
    #[inline]
    pub(super) fn is_below(self, other: Self) -> bool {
        (self.high - other.high) + (self.low - other.low) < R::ZERO
    }

    #[inline]
    pub(super) fn negated(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }

    #[inline]
    pub(super) fn abs(self) -> Self {
        if self.high < R::ZERO {
            self.negated()
        } else {
            self
        }
    }

    #[inline]
    pub(super) fn times(self, other: Self) -> Self {
        let product = Self::product(self.high, other.high);
        let rest = self.high * other.low + self.low * other.high;
        product.and(rest)
    }

    /// Product with a number of single width.
    #[inline]
    pub(super) fn scaled(self, factor: R) -> Self {
        let product = Self::product(self.high, factor);
        product.and(self.low * factor)
    }

    /// [`fraction`](Self::fraction) of the product with a time of any size.
    #[inline]
    pub(super) fn fraction_after(self, time: R) -> R {
        self.scaled(time).fraction()
    }

    /// Product with a power of two, exact.
    #[inline]
    pub(super) fn shifted(self, factor: R) -> Self {
        Self {
            high: self.high * factor,
            low: self.low * factor,
        }
    }

    #[inline]
    pub(super) fn over(self, other: Self) -> Self {
        // One division serves the quotient and its rest.
        let inverse = R::ONE / other.high;
        let quotient = self.high * inverse;
        // The difference of the leading parts is exact, because they agree to their last places.
        let product = Self::product(quotient, other.high);
        let rest = (self.high - product.high) - product.low + (self.low - quotient * other.low);
        Self {
            high: quotient,
            low: rest * inverse,
        }
    }

    /// Square root, and 0 for numbers that are not above 0.
    #[inline]
    pub(super) fn sqrt(self) -> Self {
        let root = self.high.sqrt();
        if root > R::ZERO {
            let square = Self::product(root, root);
            let rest = (self.high - square.high) - square.low + self.low;
            Self {
                high: root,
                low: rest * (R::HALF / root),
            }
        } else {
            Self::ZERO
        }
    }

    /// Distance from the nearest whole number, at most 1/2 to rounding, of either sign.
    #[inline]
    pub(super) fn fraction(self) -> R {
        // Adding it rounds numbers below 1/EPSILON to whole ones. Larger numbers are whole
        // already, or become smaller than that by the first pass.
        let rounder = R::from_f64(1.5) / R::EPSILON;
        let mut rest = self;
        for _ in 0..3 {
            let whole = (rest.high + rounder) - rounder;
            if whole == R::ZERO {
                break;
            }
            rest = Self::sum(rest.high - whole, rest.low);
        }
        rest.nearest()
    }
}

/// Upper and lower half of the digits of a number.
#[inline]
fn halves<R: Real>(number: R) -> [R; 2] {
    let upper = number.upper_half();
    [upper, number - upper]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp, reason = "a product of two words is exact")]

    use super::*;

    /// Numbers between 1 and 2 without a pattern, with rests between -1 and 1 times `EPSILON`.
    fn wides() -> impl Iterator<Item = Wide<f32>> {
        (1..20_000_u32).map(|i| {
            let bits = i.wrapping_mul(0x9e37_79b1);
            let high = f32::from_bits(0x3f80_0000 | (bits >> 8));
            let units = f32::from(i16::from_ne_bytes([bits.to_ne_bytes()[0], 0])) / 128.0 - 1.0;
            Wide {
                high,
                low: high * f32::EPSILON * units,
            }
        })
    }

    /// Both parts are exact in f64, and so is their sum.
    fn value(number: Wide<f32>) -> f64 {
        f64::from(number.high) + f64::from(number.low)
    }

    #[test]
    fn products_quotients_roots_and_sums_have_twice_the_digits() {
        // The product of the two rests is neglected, and twice as much in a quotient. The new rest
        // is at most three times `EPSILON`, with four roundings of half of `EPSILON`.
        let bound = 8.0 * f64::from(f32::EPSILON) * f64::from(f32::EPSILON);
        for (a, b) in wides().zip(wides().skip(7)) {
            let (x, y) = (value(a), value(b));
            for (name, result, truth) in [
                ("product", a.times(b), x * y),
                ("quotient", a.over(b), x / y),
                ("root", a.sqrt(), x.sqrt()),
                ("sum", a.plus(b), x + y),
            ] {
                let off = value(result) / truth - 1.0;
                assert!(off.abs() < bound, "{name} of {a:?} and {b:?}: {off:e}");
            }
            let difference = value(a.minus(b)) - (x - y);
            assert!(difference.abs() < bound * x.max(y), "{a:?} - {b:?}");
            assert_eq!(a.is_below(b), x < y, "{a:?} < {b:?}");
        }
    }

    #[test]
    fn an_exact_product_is_exact_in_single_precision() {
        for (a, b) in wides().zip(wides().skip(3)) {
            let (x, y) = (a.high, b.high);
            assert_eq!(value(Wide::product(x, y)), f64::from(x) * f64::from(y));
        }
    }
}
