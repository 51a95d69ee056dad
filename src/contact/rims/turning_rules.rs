//! Gauss's rules for a piece of arc at whose end friction reverses.
//!
//! Near a point of least slip the slip is `√(δ² + β² x²)`, and friction depends on it and on the
//! law's slip speed ε. As a function of `x`, the force has its singularities at a complex distance
//! of about `σ = (δ + ε)/β` from that point. So the convergence rate of a Gauss rule in `x` depends
//! on the piece's length over σ. The substitution
//!
//! ```text
//! x = length sinh(Y y)/sinh(Y)     y from 0 to 1     sinh(Y) = length/σ
//! ```
//! moves them to `y = ±iπ/(2Y)` for every σ (Johnston and Elliott, International Journal for
//! Numerical Methods in Engineering 62, 2005). Y increases only with the logarithm of `length/σ`,
//! and so does the number of points.
//!
//! The rules are computed at compile time, [`legendre`] by Newton's iteration and `sinh` by its
//! series.

use crate::real::Real;

/// Points from -1 to 1, with weights.
pub(super) type Rule = &'static [[f64; 2]];

/// Rules for a piece that begins at a point of least slip. Each has the largest ratio of the
/// piece's length to the width of the reversal for which it is used.
///
/// Each rule is accurate for ratios from a quarter of the largest one (a 30th in the last two) to
/// the largest one. It integrates `x^k f(x)` with `k <= 3` to 1e-9 times the length, the last one
/// to 2e-8. Here `f` is one of `x/√(x² + c²)`, `c/√(x² + c²)`, `x/(x + c)`, `c/(x + c)`,
/// `x/(√(x² + 0.5 c²) + 0.3 c)`, and the first of them shifted by `±0.3 c`.
const RULES: [(f64, Rule); 10] = [
    (1.0, &legendre::<8>()),
    (1.9, &crowded::<8>(1.4)),
    (4.0, &crowded::<10>(2.1)),
    (10.0, &crowded::<12>(3.0)),
    (16.5, &crowded::<14>(3.5)),
    (33.0, &crowded::<16>(4.2)),
    (122.0, &crowded::<18>(5.5)),
    (1e3, &crowded::<20>(7.6)),
    (1e5, &crowded::<20>(12.2)),
    (3e9, &crowded::<24>(14.0)),
];

/// Rule for a piece from a point of least slip on, for the ratio of its length to the width of the
/// reversal.
///
/// Returns `None` if the reversal needs no special rule, because it is wide, or because it is a
/// jump to 1e-8.
#[inline]
pub(super) fn turning_rule<R: Real>(lengths: R) -> Option<Rule> {
    if lengths <= R::HALF {
        return None;
    }
    let serves = |&&(largest, _): &&(f64, Rule)| lengths <= R::from_f64(largest);
    RULES.iter().find(serves).map(|&(_, rule)| rule)
}

/// Gauss's rule with points concentrated towards -1: `x = 2 sinh(Y y)/sinh(Y) - 1`.
const fn crowded<const N: usize>(span: f64) -> [[f64; 2]; N] {
    let mut rule = legendre::<N>();
    let [all, _] = hyperbolic(span);
    let mut i = 0;
    while i < N {
        let [place, weight] = rule[i];
        let [sinh, cosh] = hyperbolic(span * (0.5 + 0.5 * place));
        rule[i] = [2.0 * sinh / all - 1.0, weight * span * cosh / all];
        i += 1;
    }
    rule
}

/// `sinh z` and `cosh z` for `z >= 0`, by their series, in which no term is negative.
const fn hyperbolic(z: f64) -> [f64; 2] {
    let (mut sums, mut term, mut k) = ([0.0, 1.0], 1.0, 1);
    while k < 120 {
        term *= z / k as f64;
        sums[(k + 1) % 2] += term;
        k += 1;
    }
    sums
}

/// Gauss's rule: the zeros of Legendre's polynomial, with weights `2/((1 - x²) P'(x)²)`.
const fn legendre<const N: usize>() -> [[f64; 2]; N] {
    let mut rule = [[0.0; 2]; N];
    let mut i = 0;
    while i < N {
        let angle = (i as f64 + 0.75) / (N as f64 + 0.5);
        let mut x = cosine(core::f64::consts::PI * angle);
        let mut slope = 1.0;
        let mut step = 0;
        while step < 8 {
            let [value, before] = legendre_polynomials(N, x);
            slope = N as f64 * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
            step += 1;
        }
        rule[i] = [x, 2.0 / ((1.0 - x * x) * slope * slope)];
        i += 1;
    }
    rule
}

/// Legendre's polynomials of degree `n` and `n - 1`, `n >= 1`.
const fn legendre_polynomials(n: usize, x: f64) -> [f64; 2] {
    let (mut before, mut value, mut k) = (1.0, x, 2);
    while k <= n {
        let next = ((2 * k - 1) as f64 * x * value - (k - 1) as f64 * before) / k as f64;
        (before, value) = (value, next);
        k += 1;
    }
    [value, before]
}

/// Cosine by its series, for angles up to π, as an initial guess.
const fn cosine(angle: f64) -> f64 {
    let (mut sum, mut term, mut k) = (1.0, 1.0, 1);
    while k < 14 {
        term *= -angle * angle / ((2 * k) * (2 * k - 1)) as f64;
        sum += term;
        k += 1;
    }
    sum
}
