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
//! The rules are computed at compile time.

use crate::quadrature::{Rule, crowded, legendre};
use crate::real::Real;

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
