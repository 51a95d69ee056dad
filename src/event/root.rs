//! Change of sign of a function within a bracket, by the method ITP.
//!
//! ITP (interpolate, truncate, project) evaluates regula falsi and moves its point towards the
//! middle. The point stays so near to the middle that no more evaluations are needed than by
//! bisection, plus one. For smooth functions it converges as a secant. Oliveira and Takahashi, ACM
//! Transactions on Mathematical Software 47 (2020), article 5.

use crate::real::Real;

/// Returns the last bracket of the change from values of at most 0 to values above 0.
///
/// `left` and `right` are pairs of argument and value. The bracket is at most `tolerance` wide, or
/// its ends are neighbouring numbers. A tolerance of 0 returns the bracket as it is.
///
/// # Errors
/// Returns the first error of `value`.
pub(super) fn bracket<R: Real, E>(
    left: [R; 2],
    right: [R; 2],
    tolerance: R,
    mut value: impl FnMut(R) -> Result<R, E>,
) -> Result<[R; 2], E> {
    let ([mut a, mut low], [mut b, mut high]) = (left, right);
    let truncation = R::from_f64(TRUNCATION) / (b - a);
    if tolerance <= R::ZERO {
        return Ok([a, b]);
    }
    // Half the width that bisection, with one evaluation more, would have left.
    let mut allowed = tolerance;
    while allowed < b - a {
        allowed *= R::TWO;
    }
    while b - a > tolerance {
        let (width, middle) = (b - a, a + (b - a) * R::HALF);
        if middle <= a || middle >= b {
            break;
        }
        let secant = a + width * (low / (low - high));
        let point = between(
            secant,
            middle,
            truncation * width * width,
            allowed - width * R::HALF,
        );
        let point = if point > a && point < b {
            point
        } else {
            middle
        };
        let found = value(point)?;
        if found > R::ZERO {
            (b, high) = (point, found);
        } else {
            (a, low) = (point, found);
        }
        allowed *= R::HALF;
    }
    Ok([a, b])
}

/// Returns the point of the secant, moved by `truncation` towards the middle and at most `reach`
/// from it.
#[inline]
fn between<R: Real>(secant: R, middle: R, truncation: R, reach: R) -> R {
    let apart = middle - secant;
    let to_middle = if apart < R::ZERO { -R::ONE } else { R::ONE };
    // A secant of infinite values is NaN and fails the comparison.
    let truncated = if truncation <= apart.abs() {
        secant + to_middle * truncation
    } else {
        middle
    };
    if (truncated - middle).abs() <= reach {
        truncated
    } else {
        middle - to_middle * reach.at_least(R::ZERO)
    }
}

/// Distance of the truncation, as a fraction of the square of the relative width. The value is that
/// of the authors' experiments.
const TRUNCATION: f64 = 0.2;

#[cfg(test)]
mod tests {
    use super::bracket;

    /// Evaluations of a bracket from 0 to 1 with the tolerance of 2⁻⁵⁰, and its ends.
    fn count(function: impl Fn(f64) -> f64) -> (u32, [f64; 2]) {
        let mut evaluations = 0;
        let tolerance = 0.5_f64.powi(50);
        let ends = [[0.0, function(0.0)], [1.0, function(1.0)]];
        let found = bracket(ends[0], ends[1], tolerance, |x| {
            evaluations += 1;
            Ok::<_, ()>(function(x))
        });
        (evaluations, found.unwrap())
    }

    #[test]
    fn a_root_is_enclosed_with_no_more_evaluations_than_by_bisection_and_one() {
        let functions: [(&dyn Fn(f64) -> f64, f64); 6] = [
            (&|x| x - 0.3, 0.3),
            (&|x| x * x * x - 0.2, 0.2_f64.cbrt()),
            (&|x| x.exp() - 1.1, 1.1_f64.ln()),
            // A jump, a number of things, and a start at 0.
            (&|x| if x > 0.7 { 1e9 } else { -1e-9 }, 0.7),
            (&|x| if x > 0.01 { 1.0 } else { 0.0 }, 0.01),
            (&|x| x, 0.0),
        ];
        for (number, (function, root)) in functions.into_iter().enumerate() {
            let (evaluations, [a, b]) = count(function);
            assert!(b - a <= 0.5_f64.powi(50), "{number}");
            // The root itself is rounded.
            assert!(
                a <= root + f64::EPSILON && root <= b + f64::EPSILON,
                "{number}: {a} {b}"
            );
            assert!(evaluations <= 51, "{number}: {evaluations}");
        }
        // A smooth function takes less than half of them.
        let smooth = count(|x| x * x * x - 0.2).0;
        assert!(smooth <= 25, "{smooth}");
        assert!(count(|x| if x > 0.7 { f64::INFINITY } else { -1.0 }).0 <= 51);
    }
}
