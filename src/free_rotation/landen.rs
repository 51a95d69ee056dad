//! Jacobi's elliptic functions by the arithmetic-geometric mean.
//!
//! For `a ≥ g > 0` let `φ' = Δ = √(a² cos²φ + g² sin²φ)`. With `a = 1` and `g = k'` this is
//! `sin φ = sn`, `cos φ = cn`, `Δ = dn`. One step of the mean replaces `(a, g)` by
//! `(a₁, g₁) = ((a + g)/2, √(a g))`, which converges to `(M, M)`, where `φ' = M`. Two
//! transformations connect the angles before and after a step:
//!
//! - *Gauss's* keeps the number of revolutions. With `c = (a - g)/2` and `n = a₁ + c sin²φ₁`:
//!   `sin φ = a sin φ₁/n`, `cos φ = Δ₁ cos φ₁/n`, `Δ = a (a₁ - c sin²φ₁)/n`.
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
    /// With `x = (a - g)/(a + g)` the terms that are omitted are of relative size `x⁴`, which is
    /// below the rounding of [`Wide`].
    pub(super) fn is_close(&self) -> bool {
        let apart = self.arithmetic.high - self.geometric.high;
        apart.abs() <= self.arithmetic.high * R::EPSILON.sqrt()
    }

    /// The mean `M = a₁ (1 - x²/4)` of a close pair, and the distance `a₁ x²/4` from it to
    /// `√(a g)`.
    pub(super) fn limit(&self) -> (Wide<R>, R) {
        let sum = self.arithmetic.plus(self.geometric).shifted(R::HALF);
        let difference = self.arithmetic.minus(self.geometric).high * R::HALF;
        let lower = difference * difference / (sum.high * R::from_f64(4.0));
        (sum.minus(Wide::new(lower)), lower)
    }

    pub(super) fn product(&self) -> Wide<R> {
        self.arithmetic.times(self.geometric)
    }

    pub(super) fn step(&self, weight: R) -> MeanStep<R> {
        MeanStep {
            arithmetic: self.arithmetic.high,
            geometric: self.geometric.high,
            weight,
        }
    }

    pub(super) fn next(&self, product: Wide<R>) -> Self {
        Self {
            arithmetic: self.arithmetic.plus(self.geometric).shifted(R::HALF),
            geometric: product.sqrt(),
        }
    }
}

/// Returns the phase, the angle after all steps, for given values before them.
#[inline]
pub(super) fn phase<R: Real>(steps: &[MeanStep<R>], values: Jacobi<R>) -> Angle<R> {
    let Jacobi {
        mut sn,
        mut cn,
        mut dn,
    } = values;
    for step in steps {
        let (a, sum) = (step.arithmetic, step.sum());
        let over = R::ONE / (a + dn);
        // a₁ + c sin²φ₁
        let n = a * sum * over;
        let next = ((dn + step.geometric) * n * R::HALF).sqrt();
        (sn, cn, dn) = (sn * sum * over, cn * n / next, next);
    }
    Angle::of(cn, sn)
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
