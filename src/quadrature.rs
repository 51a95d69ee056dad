//! Numerical integration by Gauss's rules, and roots by bisection.
//!
//! A Gauss rule with n points integrates polynomials of degree `2n - 1` exactly (Abramowitz and
//! Stegun, Handbook of Mathematical Functions, 25.4.29).

use core::ops::{Add, Mul};

use crate::real::Real;

/// Points from -1 to 1, with weights.
pub(crate) type Rule = &'static [[f64; 2]];

/// Rule with two points.
pub(crate) const GAUSS_2: [[f64; 2]; 2] = both(HALF_OF_2);
/// Rule with four points.
pub(crate) const GAUSS_4: [[f64; 2]; 4] = both(HALF_OF_4);
/// Rule with five points.
pub(crate) const GAUSS_5: [[f64; 2]; 5] = [
    [0.0, 0.568_888_888_888_888_9],
    [0.538_469_310_105_683_1, 0.478_628_670_499_366_5],
    [-0.538_469_310_105_683_1, 0.478_628_670_499_366_5],
    [0.906_179_845_938_664, 0.236_926_885_056_189_1],
    [-0.906_179_845_938_664, 0.236_926_885_056_189_1],
];
/// Rule with six points.
pub(crate) const GAUSS_6: [[f64; 2]; 6] = both(HALF_OF_6);
/// Rule with eight points.
pub(crate) const GAUSS_8: [[f64; 2]; 8] = both(HALF_OF_8);

/// Node above 0 of the rule with two points, and its weight.
pub(crate) const HALF_OF_2: [[f64; 2]; 1] = [[0.577_350_269_189_625_8, 1.0]];
/// Nodes above 0 of the rule with four points, and their weights.
pub(crate) const HALF_OF_4: [[f64; 2]; 2] = [
    [0.339_981_043_584_856_3, 0.652_145_154_862_546_1],
    [0.861_136_311_594_052_6, 0.347_854_845_137_453_9],
];
/// Nodes above 0 of the rule with six points, and their weights.
pub(crate) const HALF_OF_6: [[f64; 2]; 3] = [
    [0.23861918608319693, 0.46791393457269126],
    [0.6612093864662646, 0.3607615730481386],
    [0.932469514203152, 0.1713244923791705],
];
/// Nodes above 0 of the rule with eight points, and their weights.
pub(crate) const HALF_OF_8: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_3],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_5],
    [0.960_289_856_497_536_3, 0.101_228_536_290_376_3],
];
/// Rule with three points on [0, 1]: positions and weights.
pub(crate) const UNIT_3: [[f64; 2]; 3] = [
    [0.112_701_665_379_258_31, 5.0 / 18.0],
    [0.5, 8.0 / 18.0],
    [0.887_298_334_620_741_7, 5.0 / 18.0],
];
/// [`UNIT_3`] in the precision of the caller, without a conversion at run time.
#[inline]
pub(crate) fn unit_3<R: Real>() -> [[R; 2]; 3] {
    let [first, middle, last] = UNIT_3;
    let node = |[place, weight]: [f64; 2]| [R::from_f64(place), R::from_f64(weight)];
    [node(first), node(middle), node(last)]
}

/// Distance of the outer nodes of three from the middle, as a fraction of the interval's half.
pub(crate) const OUTER_OF_3: f64 = 0.774_596_669_241_483_4;

/// Nodes above 0, and their mirror images below.
const fn both<const HALF: usize, const ALL: usize>(half: [[f64; 2]; HALF]) -> [[f64; 2]; ALL] {
    let mut all = [[0.0; 2]; ALL];
    let mut i = 0;
    while i < ALL {
        let [place, weight] = half[i / 2];
        all[i] = [if i % 2 == 0 { place } else { -place }, weight];
        i += 1;
    }
    all
}

/// Integral of a function between two arguments, by the rule with three points.
#[inline]
pub(crate) fn integral_of_3<R: Real, F>(function: impl Fn(R) -> F, from: R, to: R) -> F
where
    F: Add<Output = F> + Mul<R, Output = F>,
{
    let (middle, half) = ((from + to) * R::HALF, (to - from) * R::HALF);
    let out = half * R::from_f64(OUTER_OF_3);
    let [inner, outer] = [8.0 / 9.0, 5.0 / 9.0].map(R::from_f64);
    ((function(middle - out) + function(middle + out)) * outer + function(middle) * inner) * half
}

/// Nodes of the rule with two points between two arguments, and the weight of each.
#[inline(always)]
pub(crate) fn nodes_of_2<R: Real>(from: R, to: R) -> ([R; 2], R) {
    let (middle, half) = ((from + to) * R::HALF, (to - from) * R::HALF);
    let out = half * R::from_f64(GAUSS_2[0][0]);
    ([middle - out, middle + out], half)
}

/// Halves a bracket a number of times and returns the last one.
///
/// At the first end of a bracket a condition does not hold, and at the second it does. The ends may
/// be in either order.
#[inline(always)]
pub(crate) fn bisect<R: Real>(
    [mut fails, mut holds]: [R; 2],
    halvings: u32,
    condition: impl Fn(R) -> bool,
) -> [R; 2] {
    for _ in 0..halvings {
        let middle = (fails + holds) * R::HALF;
        if condition(middle) {
            holds = middle;
        } else {
            fails = middle;
        }
    }
    [fails, holds]
}

/// Gauss's rule with points concentrated towards -1: `x = 2 sinh(Y y)/sinh(Y) - 1`.
pub(crate) const fn crowded<const N: usize>(span: f64) -> [[f64; 2]; N] {
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
pub(crate) const fn legendre<const N: usize>() -> [[f64; 2]; N] {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Integral of `x^power` from -1 to 1.
    fn exact(power: i32) -> f64 {
        if power % 2 == 0 {
            2.0 / f64::from(power + 1)
        } else {
            0.0
        }
    }

    static GAUSS_7: [[f64; 2]; 7] = legendre::<7>();

    #[test]
    fn a_rule_integrates_polynomials_up_to_its_degree_and_no_further() {
        let rules: [(Rule, i32); 6] = [
            (&GAUSS_2, 3),
            (&GAUSS_4, 7),
            (&GAUSS_5, 9),
            (&GAUSS_6, 11),
            (&GAUSS_8, 15),
            (&GAUSS_7, 13),
        ];
        for (rule, degree) in rules {
            let error = |power: i32| {
                let sum: f64 = rule.iter().map(|[x, weight]| weight * x.powi(power)).sum();
                (sum - exact(power)).abs()
            };
            for power in 0..=degree {
                assert!(
                    error(power) < 1e-15 * 8.0,
                    "{degree}: {power}: {}",
                    error(power)
                );
            }
            assert!(error(degree + 1) > 1e-5, "{degree}: {}", error(degree + 1));
        }
    }

    #[test]
    fn three_points_integrate_degree_5() {
        for power in 0..=6 {
            let exact = 1.0 / f64::from(power + 1);
            let by_rule: f64 = (UNIT_3.iter())
                .map(|[x, weight]| weight * x.powi(power))
                .sum();
            let by_function = integral_of_3(|x: f64| x.powi(power), 0.0, 1.0);
            let is_exact = power < 6;
            assert_eq!(
                (by_rule - exact).abs() < 1e-15,
                is_exact,
                "{power}: {by_rule}"
            );
            assert_eq!(
                (by_function - exact).abs() < 1e-15,
                is_exact,
                "{power}: {by_function}"
            );
        }
    }

    #[test]
    fn a_bracket_shrinks_to_a_root_from_either_side() {
        let above = |x: f64| x * x > 2.0;
        let [low, high] = bisect([1.0, 2.0], 40, above);
        assert!(!above(low) && above(high) && high - low < 1e-12);
        let [high, low] = bisect([2.0, 1.0], 40, |x| !above(x));
        assert!(!above(low) && above(high) && high - low < 1e-12);
    }
}
