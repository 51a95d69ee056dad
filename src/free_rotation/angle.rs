//! Angles as points of the unit circle: sums and halves without sine or arctangent.

use crate::real::Real;

/// Angle given by its cosine and sine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Angle<R> {
    pub(super) cos: R,
    pub(super) sin: R,
}

impl<R: Real> Angle<R> {
    /// Creates the angle of the point (`x`, `y`), which must not be the origin.
    #[inline]
    pub(super) fn of(x: R, y: R) -> Self {
        let length = (x * x + y * y).sqrt();
        Self {
            cos: x / length,
            sin: y / length,
        }
    }

    /// Creates the angle of so many revolutions.
    #[inline]
    pub(super) fn revolutions(revolutions: R) -> Self {
        let (sin, cos) = (revolutions * R::from_f64(core::f64::consts::TAU)).sin_cos();
        Self { cos, sin }
    }

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

    /// Half of the angle between -π and π.
    #[inline]
    pub(super) fn half(self) -> Self {
        // The larger of the two half-angle formulas has no cancellation.
        if self.cos >= R::ZERO {
            Self::of(R::ONE + self.cos, self.sin)
        } else if self.sin >= R::ZERO {
            Self::of(self.sin, R::ONE - self.cos)
        } else {
            Self::of(-self.sin, self.cos - R::ONE)
        }
    }
}
