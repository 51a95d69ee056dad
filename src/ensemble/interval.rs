//! Confidence interval of a fraction.

use crate::error::{Rule, SceneError};
use crate::quadrature::bisect;

/// Returns Wilson's confidence interval `[low, high]` for the probability of a success, from
/// `count` successes in `total` trials.
///
/// `confidence` is the nominal coverage, above 0 and below 1, for example 0.95. Let n be `total`
/// and `p = count/n` the observed fraction. Let z be the two-sided quantile of the standard normal
/// distribution: a normal number x has `|x| <= z` with the probability `confidence`. The ends are
///
/// ```text
/// (p + z²/(2 n) ± z √(p (1 - p)/n + z²/(4 n²))) / (1 + z²/n)
/// ```
/// Source: E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209. The trials are independent. The
/// coverage is near the confidence on average over p, and not exact for each p. Without a trial it
/// is `[0, 1]`.
///
/// ```
/// let [low, high] = tumble::ensemble::wilson(10, 20, 0.95)?;
/// assert!((low - 0.2993).abs() < 1e-4 && (high - 0.7007).abs() < 1e-4);
/// # Ok::<(), tumble::SceneError>(())
/// ```
///
/// # Errors
/// Returns [`SceneError`] if `count` exceeds `total`, or if the confidence is not between 0 and 1.
pub fn wilson(count: u64, total: u64, confidence: f64) -> Result<[f64; 2], SceneError> {
    let z = normal_quantile(confidence)?;
    if count > total {
        let most = usize::try_from(total).unwrap_or(usize::MAX);
        let rule = Rule::AtMost(most);
        return Err(SceneError::new("successes", rule, count as f64, ""));
    }
    if total == 0 {
        return Ok([0.0, 1.0]);
    }
    let (n, p) = (total as f64, count as f64 / total as f64);
    let square = z * z / n;
    let middle = (p + 0.5 * square) / (1.0 + square);
    let variance = p * (1.0 - p) / n + 0.25 * square / n;
    let half = z * variance.sqrt() / (1.0 + square);
    // Exactly 0 without a success and 1 without a failure, where the terms cancel to rounding.
    let low = if count == 0 { 0.0 } else { middle - half };
    let high = if count == total { 1.0 } else { middle + half };
    Ok([low.max(0.0), high.min(1.0)])
}

/// Quantile z of the normal distribution, with `P(|x| <= z)` equal to the confidence.
///
/// Bisection of `erfc(z/√2) = 1 - confidence`: it needs no fitted constant.
fn normal_quantile(confidence: f64) -> Result<f64, SceneError> {
    if !(confidence > 0.0 && confidence < 1.0) {
        let rule = Rule::BetweenZeroAndOne;
        return Err(SceneError::new("confidence", rule, confidence, ""));
    }
    // Beyond 40 the complement is below the least f64. 64 halvings leave less than an ulp of it.
    let complement = |z: f64| libm::erfc(z * core::f64::consts::FRAC_1_SQRT_2);
    let is_beyond = |z: f64| complement(z) <= 1.0 - confidence;
    let [_, high] = bisect([0.0, 40.0], 64, is_beyond);
    Ok(high)
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString;

    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // Two-sided quantiles of the normal distribution, to the digits of the confidence.
        let known = [
            (0.682_689_492_137_085_9, 1.0),
            (0.95, 1.959_963_984_540_054),
            (0.999, 3.290_526_731_491_926),
        ];
        for (confidence, z) in known {
            assert!((normal_quantile(confidence).unwrap() - z).abs() < 1e-12);
        }
    }

    #[test]
    fn the_interval_solves_the_score_equation() {
        // Wilson's ends are the p at which |count/n - p| = z √(p (1 - p)/n).
        for (count, total) in [(1, 7), (3, 10), (500, 1000), (999, 1000)] {
            let fraction = count as f64 / total as f64;
            for end in wilson(count, total, 0.99).unwrap() {
                let error = 2.575_829_303_548_901 * (end * (1.0 - end) / total as f64).sqrt();
                assert!(((fraction - end).abs() - error).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn an_interval_without_a_success_or_a_failure_contains_its_fraction() {
        for total in 1..200 {
            for tenths in 1..1000 {
                let confidence = f64::from(tenths) / 1000.0;
                let [low, high] = [0, total].map(|count| wilson(count, total, confidence).unwrap());
                assert!(low[0].to_bits() == 0 && high[1].to_bits() == 1.0_f64.to_bits());
            }
        }
    }

    #[test]
    fn the_extremes_have_an_interval_too() {
        let [low, high] = wilson(0, 10, 0.95).unwrap();
        assert!(low.to_bits() == 0 && high > 0.2 && high < 0.35);
        let [low, high] = wilson(u64::MAX, u64::MAX, 0.95).unwrap();
        assert!(low > 1.0 - 1e-15 && low <= high && high.to_bits() == 1.0_f64.to_bits());
        assert!(wilson(0, 0, 0.5).is_ok());
        for confidence in [0.0, 1.0, f64::NAN, -1.0] {
            assert!(wilson(1, 2, confidence).is_err());
        }
        let error = wilson(3, 2, 0.95).unwrap_err();
        assert_eq!(error.to_string(), "successes must be at most 2, got 3");
    }
}
