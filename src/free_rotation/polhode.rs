//! Path of the angular momentum in the body: which axis it circles, how wide and how fast.
//!
//! Let `L` be the angular momentum in principal axes and `j` the inverse moments. Euler's equations
//! are `L' = L × (j L)`, and they conserve `L²` and `2T = Σ j L²`. Let `b` be the axis with the
//! middle `j`. Then `2T - j_b L²` decides which of the others, `a`, the path circles: that with the
//! largest `j` if it is above 0, with the smallest `j` if it is below 0. The sums
//!
//! ```text
//! E_b = L_a² (j_a - j_b) + L_c² (j_c - j_b)      E_c = L_a² (j_a - j_c) + L_b² (j_b - j_c)
//! ```
//! are constants too. With an angle φ that grows by 2π in a period, the solution for `L_a > 0` is
//!
//! ```text
//! L_a = Δ/√((j_a - j_b) (j_a - j_c))    L_b = H sin φ    L_c = (λ/p) H cos φ
//! φ' = ±Δ = ±√(λ² cos²φ + g² sin²φ)     of the sign of j_a - j_c
//! λ² = E_c (j_a - j_b)    g² = E_b (j_a - j_c)    p² = E_c (j_a - j_c)
//! (p/λ)² = (j_c - j_a)/(j_b - j_a)      H² = L_b² + (p/λ)² L_c²
//! ```
//! In Jacobi's functions of `u = u₀ ± λ t` and the complementary modulus `k' = g/λ` this is
//! `sin φ = sn u`, `cos φ = cn u` and `Δ = λ dn u` (Landau & Lifshitz, Mechanics, § 37).
//!
//! Only `E_b` is a difference, of two squares that are equal on the separatrix. It is computed with
//! twice the digits, as are all constants that are multiplied by the time.

use super::landen::{Jacobi, Pair};
use super::wide::Wide;
use crate::real::{Real, Vector, is_single};

/// Angular momentum and inverse moment about one principal axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Principal<R: Real> {
    /// Unit vector, body axes.
    pub(super) axis: R::Vec3,
    /// Times a factor near 1, which the unit of time takes back.
    pub(super) momentum: Wide<R>,
    pub(super) inverse: Wide<R>,
}

impl<R: Real> Principal<R> {
    /// Reverses the direction of the axis.
    fn reversed(self) -> Self {
        Self {
            axis: -self.axis,
            momentum: self.momentum.negated(),
            inverse: self.inverse,
        }
    }

    fn square(&self) -> Wide<R> {
        self.momentum.times(self.momentum)
    }
}

/// Path of the angular momentum, in units that make the largest numbers about 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polhode<R: Real> {
    /// The axes `a`, `b` and `c`, a right-handed frame with `L_a ≥ 0`.
    pub(super) axes: [R::Vec3; 3],
    /// `L_a/Δ`, `L_b/sin φ` and `L_c/cos φ` over `|L|`.
    pub(super) amplitudes: [R; 3],
    /// `sin φ`, `cos φ` and `Δ` at the start.
    pub(super) start: Jacobi<R>,
    /// `λ` and `g`.
    pub(super) pair: Pair<R>,
    /// `p`, and `p/λ`.
    pub(super) third: Wide<R>,
    pub(super) elongation: R,
    /// `|L| j_b`, the precession at the middle axis, and `|L| (j_c - j_b)`.
    pub(super) slow: Wide<R>,
    pub(super) side: Wide<R>,
    /// 1 or -1, the direction of φ, and 0 for a rotation about the middle axis.
    pub(super) direction: R,
    /// The path ends at the middle axis, or stays there.
    pub(super) is_separatrix: bool,
}

/// Smallest square of `k'` that differs from the separatrix, for f64 and f32. The products of the
/// numbers are still normal. In f64 the path stays at the middle axis for 280 radians of `u`.
const SMALLEST_SQUARE: [f64; 2] = [1e-240, 1e-30];

/// Axis beside the middle one.
#[derive(Clone, Copy)]
struct Outer<R: Real> {
    axis: Principal<R>,
    /// Square of the angular momentum.
    square: Wide<R>,
    /// Distance of the inverse moment from that of the middle axis.
    gap: Wide<R>,
}

impl<R: Real> Outer<R> {
    #[inline]
    fn new(axis: Principal<R>, gap: Wide<R>) -> Self {
        Self {
            square: axis.square(),
            axis,
            gap,
        }
    }

    #[inline]
    fn product(&self) -> Wide<R> {
        self.square.times(self.gap)
    }
}

impl<R: Real> Polhode<R> {
    /// Creates the path for three axes with different inverse moments, the smallest first. The
    /// angular momentum is not 0.
    #[inline(always)]
    pub(super) fn new([low, middle, high]: [Principal<R>; 3]) -> Self {
        let all = high.inverse.minus(low.inverse);
        let low = Outer::new(low, middle.inverse.minus(low.inverse));
        let high = Outer::new(high, high.inverse.minus(middle.inverse));
        let (falling, rising) = (low.product(), high.product());
        let excess = rising.minus(falling);
        // The rounding of `Wide`: what is closer is on the separatrix.
        let rounding = (rising.high + falling.high) * (R::EPSILON * R::EPSILON * R::from_f64(8.0));
        let is_separatrix = excess.high.abs() <= rounding;
        let forward = excess.high > R::ZERO;
        let (mut a, mut c) = if forward { (high, low) } else { (low, high) };
        if a.axis.momentum.high < R::ZERO {
            a.axis = a.axis.reversed();
        }
        if a.axis.axis.cross(middle.axis).dot(c.axis.axis) < R::ZERO {
            c.axis = c.axis.reversed();
        }
        Self::around((a, middle, c), all, (excess, forward, is_separatrix))
    }

    /// Creates the path around `a`, with the distance of the inverse moments of `a` and `c`, for
    /// the value of `E_b`.
    #[inline(always)]
    fn around(
        (a, b, c): (Outer<R>, Principal<R>, Outer<R>),
        to_c: Wide<R>,
        (excess, forward, is_separatrix): (Wide<R>, bool, bool),
    ) -> Self {
        let (to_b, square) = (a.gap, b.square());
        let sum = (a.square.times(to_c)).plus(square.times(c.gap));
        let length = (a.square.plus(square).plus(c.square)).sqrt();
        let between = if forward { c.gap.negated() } else { c.gap };
        let (a, c) = (a.axis, c.axis);
        let (pair, is_separatrix) = pair(sum.times(to_b), excess.abs().times(to_c), is_separatrix);
        let steepness = (to_b.nearest() * to_c.nearest()).sqrt();
        let elongation = (to_c.nearest() / to_b.nearest()).sqrt();
        let (along, wide) = (b.momentum.nearest(), elongation * c.momentum.nearest());
        let height = (along * along + wide * wide).sqrt();
        let (sn, cn) = if height > R::ZERO {
            (along / height, wide / height)
        } else {
            (R::ZERO, R::ONE)
        };
        let dn = (a.momentum.nearest() * steepness).at_least(pair.geometric.nearest());
        let is_at_rest = is_separatrix && a.momentum.high == R::ZERO && c.momentum.high == R::ZERO;
        let direction = match (is_at_rest, forward) {
            (true, _) => R::ZERO,
            (false, true) => R::ONE,
            (false, false) => -R::ONE,
        };
        Self {
            axes: [a.axis, b.axis, c.axis],
            amplitudes: [R::ONE / steepness, height, height / elongation]
                .map(|size| size / length.nearest()),
            start: Jacobi { sn, cn, dn },
            pair,
            third: sum.times(to_c).sqrt(),
            elongation,
            slow: length.times(b.inverse),
            side: length.times(between),
            direction,
            is_separatrix,
        }
    }
}

/// Returns `λ` and `g` for their squares, and true on the separatrix, where `g` is the smallest
/// one.
fn pair<R: Real>(square: Wide<R>, other: Wide<R>, is_separatrix: bool) -> (Pair<R>, bool) {
    let [of_f64, of_f32] = SMALLEST_SQUARE;
    let smallest = R::from_f64(if is_single::<R>() { of_f32 } else { of_f64 });
    let is_separatrix = is_separatrix || other.high < square.high * smallest;
    let arithmetic = square.sqrt();
    let geometric = if is_separatrix {
        arithmetic.scaled(smallest.sqrt())
    } else {
        other.sqrt()
    };
    let pair = Pair {
        arithmetic,
        geometric,
    };
    (pair, is_separatrix)
}
