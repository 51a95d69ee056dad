//! Polygon around the joint numerical range of stiffness and damping, and the smallest limit of a
//! method along it.

use super::response::Response;
use crate::real::Real;

/// Returns the corners (κ, δ) of a polygon around the joint numerical range. They run from the
/// stiffest motion to the motions without stiffness.
///
/// A motion has at least `least_ratio` (s) as its ratio of damping to stiffness.
pub(super) fn outline<R: Real>(response: &Response<R>, least_ratio: R) -> [[R; 2]; 6] {
    let (zero, one, two) = (R::ZERO, R::ONE, R::TWO);
    let stiffest = response.stiffness.spectral_radius();
    let most_damped = response.damping.spectral_radius();
    let per = |value: R| if value > zero { one / value } else { zero };
    let [k, c] = [per(stiffest), per(most_damped)];
    // Supporting lines p X + q Y = s of X = κ/stiffest and Y = δ/most_damped, each at most 1.
    let support = |p: R, q: R| {
        let sum = (response.stiffness).combined(p * k, &response.damping, q * c);
        sum.spectral_radius()
    };
    let [flat, even, steep] = [support(two, one), support(one, one), support(one, two)];
    let within = |value: R| value.at_least(zero).at_most(one);
    // The lines of non-symmetric matrices may cross below the least damping, which is at most the
    // critical one.
    let low = |x: R| {
        let stiffness = x * stiffest;
        within((least_ratio * stiffness).at_most(stiffness.sqrt() * two) * c)
    };
    let crossing = |x: R, y: R| [within(x), within(y).at_least(low(within(x)))];
    let resting = within(response.friction.spectral_radius() * c);
    let top = within(steep - two);
    let ratio = response.largest_ratio * stiffest * c;
    let corners = [
        crossing(one, flat - two),
        crossing(flat - even, two * even - flat),
        crossing(two * even - steep, steep - even),
        [top, one],
        [((one - resting) / ratio).at_most(top), one],
        [zero, resting],
    ];
    corners.map(|[x, y]| [x * stiffest, y * most_damped])
}

/// Smallest limit along the outline, s. `R::MAX` for an empty outline.
///
/// A softer motion may have a smaller limit than the stiffest, because the stability region of a
/// method need not be convex. So the smallest of some limits is improved between its neighbours,
/// also across a corner.
pub(super) fn least_along<R: Real>(
    outline: &[[R; 2]],
    limit: &impl Fn(R, R) -> Option<R>,
) -> Option<R> {
    let limit_at = |place: R| {
        let [stiffness, damping] = along(outline, place);
        let is_empty = stiffness <= R::ZERO && damping <= R::ZERO;
        if is_empty {
            Some(R::MAX)
        } else {
            limit(stiffness, damping)
        }
    };
    let edges = outline.len().saturating_sub(1);
    let part = R::ONE / R::from_usize(PARTS);
    let (mut least, mut at) = (R::MAX, R::ZERO);
    for number in 0..=edges * PARTS {
        let place = R::from_usize(number) * part;
        let value = limit_at(place)?;
        if value < least {
            (least, at) = (value, place);
        }
    }
    let start = (at - part).at_least(R::ZERO);
    let length = (at + part).at_most(R::from_usize(edges)) - start;
    let found = smallest(|share| limit_at(start + length * share))?;
    Some(found.at_most(least))
}

/// Number of parts into which an edge of the outline is divided.
const PARTS: usize = 8;
/// Steps of the search in two parts, each of which reduces its range by the golden ratio.
const SECTIONS: usize = 16;
/// `(√5 - 1)/2`
const GOLDEN_RATIO: f64 = 0.618_033_988_749_894_8;

/// Point at a place along the outline, in edges from its beginning.
fn along<R: Real>(outline: &[[R; 2]], place: R) -> [R; 2] {
    let mut rest = place;
    for (&start, &end) in outline.iter().zip(outline.iter().skip(1)) {
        if rest <= R::ONE {
            return between(start, end, rest);
        }
        rest -= R::ONE;
    }
    [R::ZERO; 2]
}

/// Point at a fraction of the way between two points.
fn between<R: Real>(start: [R; 2], end: [R; 2], fraction: R) -> [R; 2] {
    let rest = R::ONE - fraction;
    [
        start[0] * rest + end[0] * fraction,
        start[1] * rest + end[1] * fraction,
    ]
}

/// Returns the smallest value of a function between 0 and 1 that has one minimum there, by golden
/// section. Returns `None` if the function does.
fn smallest<R: Real>(value_at: impl Fn(R) -> Option<R>) -> Option<R> {
    let golden = R::from_f64(GOLDEN_RATIO);
    let [mut low, mut high] = [R::ZERO, R::ONE];
    let [mut left, mut right] = [R::ONE - golden, golden];
    let [mut at_left, mut at_right] = [value_at(left)?, value_at(right)?];
    for _ in 0..SECTIONS {
        if at_left < at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - (high - low) * golden;
            at_left = value_at(left)?;
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + (high - low) * golden;
            at_right = value_at(right)?;
        }
    }
    Some(at_left.at_most(at_right))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// From either direction, the smallest sample is the corner, and the smallest value lies a
    /// twentieth of an edge beyond it.
    #[test]
    fn the_smallest_limit_is_found_across_a_corner() {
        let limit = |stiffness: f64, damping: f64| {
            let dip = 1.0 + (damping - 0.95).powi(2) + (1.0 - stiffness);
            Some(dip)
        };
        let mut outline = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
        for _ in 0..2 {
            let least = least_along(&outline, &limit).unwrap();
            assert_relative_eq!(least, 1.0, epsilon = 1e-6);
            outline.reverse();
        }
    }
}
