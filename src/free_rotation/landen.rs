//! Jacobi's elliptic functions by the arithmetic-geometric mean.
//!
//! For `a ≥ g > 0` let `φ' = Δ = √(a² cos²φ + g² sin²φ)`. With `a = 1` and `g = k'` this is
//! `sin φ = sn`, `cos φ = cn`, `Δ = dn`. One step of the mean replaces `(a, g)` by
//! `(a₁, g₁) = ((a + g)/2, √(a g))`, which converges to `(M, M)`, where `φ' = M`. Two
//! transformations connect the angles before and after a step:
//!
//! - *Gauss's* keeps the number of revolutions. With `c = (a - g)/2` and `n = a₁ + c sin²φ₁`:
//!   `sin φ = a sin φ₁/n`, `cos φ = Δ₁ cos φ₁/n`, `Δ = a (a₁ - c sin²φ₁)/n`. So
//!   `n = a (a + g)/(a + Δ)` and `Δ₁² = n (Δ + g)/2`.
//! - *Landen's* doubles the angle: `tan(φ₁ - φ) = (g/a) tan φ` and `2 Δ₁ = Δ + a g/Δ`. It is used
//!   for the integral of the third kind, in `precession`.
//!
//! Gauss's transformation is exact in both directions without a winding number, and none of its
//! expressions cancels, also for `g → 0`. The quarter period is `π/(2 M)`. See Abramowitz & Stegun,
//! sections 16.4, 16.12 and 17.6; DLMF section 19.8.

use super::angle::Angle;
use super::wide::Wide;
use crate::real::Real;

/// Largest number of steps of the mean. f64 needs 13 of them for a ratio `g/a` of 1e-120.
pub(super) const MOST_STEPS: usize = 14;

/// One step of the mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeanStep<R> {
    /// `a` and `g` before the step.
    pub(super) arithmetic: R,
    pub(super) geometric: R,
    /// Coefficient `B` of the integral of the third kind, see `precession`.
    pub(super) weight: R,
}

impl<R: Real> MeanStep<R> {
    /// `a + g`
    #[inline]
    pub(super) fn sum(&self) -> R {
        self.arithmetic + self.geometric
    }

    /// `c = (a - g)/2`
    #[inline]
    fn difference(&self) -> R {
        (self.arithmetic - self.geometric) * R::HALF
    }
}

/// Values of `sin φ`, `cos φ` and `Δ`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Jacobi<R> {
    pub(super) sn: R,
    pub(super) cn: R,
    pub(super) dn: R,
}

/// A pair `(a, g)` of the mean, with all digits of [`Wide`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pair<R> {
    pub(super) arithmetic: Wide<R>,
    pub(super) geometric: Wide<R>,
}

impl<R: Real> Pair<R> {
    /// Returns true if both numbers are so close that the next step is elementary.
    ///
    /// With `x = (a - g)/(a + g)` the mean is `M = a₁ (1 - x²/4 - 5 x⁴/64 - ...)`. The terms that
    /// are omitted are below a third of `EPSILON²` for `x² ≤ 2 EPSILON`. `Δ` is then constant to
    /// half of `EPSILON`.
    #[inline]
    pub(super) fn is_close(&self) -> bool {
        let a = self.arithmetic.high;
        let apart = a - self.geometric.high;
        apart * apart <= a * a * (R::EPSILON * R::from_f64(8.0))
    }

    /// The mean `M = a₁ (1 - x²/4)` of a close pair, and the distance `a₁ x²/4` from it to
    /// `√(a g)`.
    pub(super) fn limit(&self) -> (Wide<R>, R) {
        let sum = self.mean();
        let difference = self.arithmetic.minus(self.geometric).nearest() * R::HALF;
        let lower = difference * difference / (sum.high * R::from_f64(4.0));
        (sum.minus(Wide::new(lower)), lower)
    }

    pub(super) fn product(&self) -> Wide<R> {
        self.arithmetic.times(self.geometric)
    }

    pub(super) fn step(&self, weight: R) -> MeanStep<R> {
        MeanStep {
            arithmetic: self.arithmetic.nearest(),
            geometric: self.geometric.nearest(),
            weight,
        }
    }

    pub(super) fn next(&self, product: Wide<R>) -> Self {
        Self {
            arithmetic: self.mean(),
            geometric: product.sqrt(),
        }
    }

    /// The arithmetic mean. `a` is not below `g`.
    #[inline]
    fn mean(&self) -> Wide<R> {
        (self.arithmetic.plus_smaller(self.geometric)).shifted(R::HALF)
    }
}

/// Returns the phase, the angle after all steps, for given values before them.
#[inline]
pub(super) fn phase<R: Real>(steps: &[MeanStep<R>], values: Jacobi<R>) -> Angle<R> {
    let Jacobi { mut sn, cn, mut dn } = values;
    for step in steps {
        let a = step.arithmetic;
        // n = a₁ + c sin²φ₁
        let n = a * step.sum() / (a + dn);
        dn = ((dn + step.geometric) * n * R::HALF).sqrt();
        // tan φ₁ = (Δ₁/a) tan φ
        sn *= dn / a;
    }
    Angle { cos: cn, sin: sn }.unit()
}

/// Returns the values before all steps for a phase after them.
#[inline]
pub(super) fn functions<R: Real>(steps: &[MeanStep<R>], limit: R, phase: Angle<R>) -> Jacobi<R> {
    let (mut sn, mut cn, mut dn) = (phase.sin, phase.cos, limit);
    for step in steps.iter().rev() {
        let (a, c) = (step.arithmetic, step.difference());
        let over = R::ONE / (step.sum() * R::HALF + c * sn * sn);
        // a₁ - c sin²φ₁, without cancellation.
        let falling = step.geometric + c * cn * cn;
        (sn, cn, dn) = (a * sn * over, cn * dn * over, a * falling * over);
    }
    Jacobi { sn, cn, dn }
}
