//! Numbers of twice the precision: the sum of two numbers that do not overlap.
//!
//! A phase of a thousand revolutions needs three decimal digits more than the result. The products
//! are exact by Dekker's splitting (Numerische Mathematik 18, 1971), without fused operations.
//! Relative errors are a few `EPSILON²`: 1e-31 in f64 and 1e-13 in f32.

use crate::real::Real;

/// The number `high + low`, where `low` is below one unit in the last place of `high`.
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

    /// Product of two numbers, exact.
    #[inline]
    pub(super) fn product(a: R, b: R) -> Self {
        let high = a * b;
        let ([a, a_rest], [b, b_rest]) = (halves(a), halves(b));
        let low = ((a * b - high) + a * b_rest + a_rest * b) + a_rest * b_rest;
        Self { high, low }
    }

    #[inline]
    pub(super) fn plus(self, other: Self) -> Self {
        let sum = Self::sum(self.high, other.high);
        Self::ordered_sum(sum.high, sum.low + (self.low + other.low))
    }

    #[inline]
    pub(super) fn minus(self, other: Self) -> Self {
        self.plus(other.negated())
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
        Self::ordered_sum(product.high, product.low + rest)
    }

    /// Product with a number of single width.
    #[inline]
    pub(super) fn scaled(self, factor: R) -> Self {
        let product = Self::product(self.high, factor);
        Self::ordered_sum(product.high, product.low + self.low * factor)
    }

    /// [`fraction`](Self::fraction) of the product with a time of any size.
    #[inline]
    pub(super) fn fraction_after(self, time: R) -> R {
        // The splitting of a large number would overflow.
        let unit = time.power_of_two();
        self.scaled(time / unit).shifted(unit).fraction()
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
        let quotient = self.high / other.high;
        // The difference of the leading parts is exact, because they agree to their last places.
        let product = Self::product(quotient, other.high);
        let rest = (self.high - product.high) - product.low + (self.low - quotient * other.low);
        Self::ordered_sum(quotient, rest / other.high)
    }

    /// Square root, and 0 for numbers that are not above 0.
    #[inline]
    pub(super) fn sqrt(self) -> Self {
        let root = self.high.sqrt();
        if root > R::ZERO {
            let square = Self::product(root, root);
            let rest = (self.high - square.high) - square.low + self.low;
            Self::ordered_sum(root, rest * R::HALF / root)
        } else {
            Self::ZERO
        }
    }

    /// Distance from the nearest whole number, at most 1/2 to rounding, of either sign.
    #[inline]
    fn fraction(self) -> R {
        // Adding it rounds numbers below 1/EPSILON to whole ones. Larger numbers are whole
        // already, or become smaller than that by the first pass.
        let rounder = R::from_f64(1.5) / R::EPSILON;
        let mut rest = self;
        for _ in 0..3 {
            let whole = (rest.high + rounder) - rounder;
            rest = Self::sum(rest.high - whole, rest.low);
        }
        rest.high
    }
}

/// Upper and lower half of the digits of a number.
#[inline]
fn halves<R: Real>(number: R) -> [R; 2] {
    // 2²⁷ + 1 for the 53 digits of f64, 2¹² + 1 for the 24 of f32.
    let splitter = if R::EPSILON < R::from_f64(1e-10) {
        R::from_f64(134_217_729.0)
    } else {
        R::from_f64(4097.0)
    };
    let scaled = number * splitter;
    let upper = scaled - (scaled - number);
    [upper, number - upper]
}
