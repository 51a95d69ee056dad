//! Mean and periodic part of the precession: the elliptic integral of the third kind.
//!
//! With `p ≥ a` and the `φ' = Δ` of `landen` let
//!
//! ```text
//! f = a² cos²φ/(a² cos²φ + p² sin²φ)        B = √((p² - a²)(p² - g²))/p
//! ```
//! The precession needs the mean `C` of `f` over the time, and the periodic part
//! `P = ∫ B (f - C) dt`. One step of the mean transforms `p` as well:
//!
//! ```text
//! p₁ = (p² + a g)/(2 p)      ε = (p² - a g)/(p² + a g)      B₁ = B ε/2
//! C = 1/2 - (ε/2) (1 - C₁)
//! P(φ) = P₁(φ₁)/2 + atan(B sin φ cos φ/Δ)/2     with Landen's φ₁
//! ```
//! The means are those of DLMF 19.8.6. For the angles, the difference of both sides has the
//! derivative 0 and is 0 at `φ = 0`. In the limit `a = g = M` all is elementary: `C = M/(M + p)`,
//! and `P = χ - φ` with `tan χ = (p/M) tan φ`. All terms have one sign, and both arctangents are
//! below π/2. So sums are halved as points of the plane, without an arctangent.
//!
//! `C` of a close pair with `G² = a g` and `M = G + d` is `G/(G + p) + d p (p - G)/(p + G)³`, with
//! an error below `0.05 (d/G)²`, computed for many `p`.

use super::angle::Angle;
use super::landen::{Jacobi, MOST_STEPS, MeanStep, Pair};
use super::wide::Wide;
use crate::real::Real;

/// The chain of steps of the mean, with the coefficients of the third kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Chain<R> {
    steps: [MeanStep<R>; MOST_STEPS],
    count: usize,
    /// The mean `M`, and `p/M` at the end.
    limit: R,
    elongation: R,
}

/// Constants of a motion that follow from the chain with all digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Means<R> {
    /// The mean `M`: `π/2` over the quarter period.
    pub(super) limit: Wide<R>,
    /// The mean `C` of `f`.
    pub(super) fraction: Wide<R>,
}

impl<R: Real> Chain<R> {
    /// Creates the chain for `a` and `g`, `p` and `B` at its start.
    #[inline(always)]
    pub(super) fn new(mut pair: Pair<R>, p: Wide<R>, weight: R) -> (Self, Means<R>) {
        let mut steps = [pair.step(weight); MOST_STEPS];
        let (mut p, mut weight, mut count) = (p, weight, 0);
        // Product of the ε/2, and the sum of the products.
        let (mut factor, mut sum) = (Wide::ONE, Wide::ZERO);
        for step in &mut steps {
            *step = pair.step(weight);
            count += 1;
            if pair.is_close() {
                break;
            }
            let product = pair.product();
            let other = product.over(p);
            // `p` is not below `√(a g)`, and no factor is above the first.
            let both = p.plus_smaller(other);
            let apart = p.plus_smaller(other.negated());
            let ratio = apart.over(both).shifted(R::HALF);
            sum = sum.plus_smaller(factor);
            factor = factor.times(ratio);
            weight *= ratio.nearest();
            p = both.shifted(R::HALF);
            pair = pair.next(product);
        }
        let (limit, apart) = pair.limit();
        let last = factor.times(rest_of_means(p, limit, apart));
        let fraction = Wide::ONE.minus(sum.shifted(R::HALF)).minus(last);
        let (p, end) = (p.nearest(), pair.step(weight));
        let chain = Self {
            steps,
            count,
            limit: limit.nearest(),
            elongation: (p + end.arithmetic * end.geometric / p) * R::HALF / limit.nearest(),
        };
        (chain, Means { limit, fraction })
    }

    /// The steps of the mean that were needed.
    #[inline]
    pub(super) fn steps(&self) -> &[MeanStep<R>] {
        self.steps.get(..self.count).unwrap_or(&self.steps)
    }

    #[inline]
    pub(super) fn limit(&self) -> R {
        self.limit
    }

    /// Periodic part `P` at given values of Jacobi's functions.
    #[inline]
    pub(super) fn periodic_part(&self, values: Jacobi<R>) -> Angle<R> {
        let Jacobi {
            sn: mut sin,
            cn: mut cos,
            dn: mut delta,
        } = values;
        let mut tangents = [R::ZERO; MOST_STEPS];
        for (step, tangent) in self.steps().iter().zip(&mut tangents) {
            let (a, g) = (step.arithmetic, step.geometric);
            let over = R::ONE / delta;
            let slope = sin * (cos * over);
            *tangent = step.weight * slope;
            cos = a * cos * (cos * over) - g * sin * (sin * over);
            sin = step.sum() * slope;
            delta = (delta + a * g * over) * R::HALF;
        }
        let rest = Angle {
            cos: cos * cos + self.elongation * sin * sin,
            sin: (self.elongation - R::ONE) * sin * cos,
        };
        let taken = tangents.get(..self.count).unwrap_or(&tangents);
        (taken.iter().rev()).fold(rest, |angle, &tangent| {
            let more = Angle {
                cos: R::ONE,
                sin: tangent,
            };
            angle.plus(more).half()
        })
    }
}

/// `1 - C` of a close pair with the mean `limit`, and the distance of `√(a g)` from it.
fn rest_of_means<R: Real>(p: Wide<R>, limit: Wide<R>, apart: R) -> Wide<R> {
    let geometric = limit.minus(Wide::new(apart));
    let sum = geometric.plus(p);
    let cube = sum.high * sum.high * sum.high;
    let correction = apart * p.high * (p.high - geometric.high) / cube;
    p.over(sum).minus(Wide::new(correction))
}
