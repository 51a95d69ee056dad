//! Angles as points of the plane: sums and halves without sine or arctangent.
//!
//! The distance of the point from the origin has no meaning, so that neither a sum nor a half needs
//! a division.

use crate::real::Real;

/// Angle given by its cosine and sine, both times the same length above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Angle<R> {
    pub(super) cos: R,
    pub(super) sin: R,
}

/// Length above which a half is scaled to length 1. In f32 the square of the product with a
/// tangent is below 1e38 for tangents up to 1e15, and they are at most `1/EPSILON`.
const LONG: f64 = 1e4;

impl<R: Real> Angle<R> {
    /// Creates the angle of so many revolutions, of length 1. They are at most 1/2 of either sign.
    #[inline]
    pub(super) fn revolutions(revolutions: R) -> Self {
        // Quarters of a revolution are removed exactly. Otherwise the sine would do it, with more
        // instructions.
        let rounder = R::from_f64(1.5) / R::EPSILON;
        let quarters = (revolutions * R::from_f64(4.0) + rounder) - rounder;
        let rest = revolutions - quarters * R::from_f64(0.25);
        let (sin, cos) = (rest * R::from_f64(core::f64::consts::TAU)).sin_cos();
        let count = quarters.abs();
        let removed = Self {
            cos: R::ONE - count,
            sin: quarters * (R::TWO - count),
        };
        Self { cos, sin }.plus(removed)
    }

    /// Sum of the angles. The lengths are multiplied.
    #[inline]
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            cos: self.cos * other.cos - self.sin * other.sin,
            sin: self.sin * other.cos + self.cos * other.sin,
        }
    }

    #[inline]
    pub(super) fn negated(self) -> Self {
        Self {
            cos: self.cos,
            sin: -self.sin,
        }
    }

    /// Returns the angle as a point at distance 1 from the origin.
    #[inline]
    pub(super) fn unit(self) -> Self {
        let length = self.length();
        Self {
            cos: self.cos / length,
            sin: self.sin / length,
        }
    }

    /// Half of the angle between -π and π. The length is at most doubled, and at most `LONG` or 2.
    #[inline]
    pub(super) fn half(self) -> Self {
        // The sum of the point and the point at the same distance on the first axis, or the normal
        // of their difference. The larger of the two has no cancellation.
        let Self { cos, sin } = self;
        let length = self.length();
        let [cos, sin] = if cos >= R::ZERO {
            [length + cos, sin]
        } else if sin >= R::ZERO {
            [sin, length - cos]
        } else {
            [-sin, cos - length]
        };
        if length > R::from_f64(LONG) {
            Self { cos, sin }.unit()
        } else {
            Self { cos, sin }
        }
    }

    #[inline]
    fn length(self) -> R {
        (self.cos * self.cos + self.sin * self.sin).sqrt()
    }
}
