//! Fractions with their intervals, as the tables show them.

use tumble::ensemble::wilson;

/// Confidence of the intervals.
pub(crate) const CONFIDENCE: f64 = 0.95;

/// Wilson's interval of a fraction. The whole interval from 0 to 1 if there is no toss.
pub(crate) fn interval(count: u64, total: u64) -> [f64; 2] {
    wilson(count, total, CONFIDENCE).unwrap_or([0.0, 1.0])
}

/// A fraction in percent with its interval: `7.6 [6.7, 8.6]`.
pub(crate) fn percent(count: u64, total: u64) -> String {
    let [low, high] = interval(count, total);
    let fraction = count as f64 / total.max(1) as f64;
    let places = places(100.0 * (high - low));
    let [middle, low, high] = [fraction, low, high].map(|part| 100.0 * part);
    format!("{middle:.places$} [{low:.places$}, {high:.places$}]")
}

/// A fraction with its interval: `.076 [.067, .086]`.
pub(crate) fn fraction(count: u64, total: u64) -> String {
    let [low, high] = interval(count, total);
    let fraction = count as f64 / total.max(1) as f64;
    let places = places(high - low);
    format!("{fraction:.places$} [{low:.places$}, {high:.places$}]")
}

/// Places after the point that show an interval of a width to two digits.
fn places(width: f64) -> usize {
    (0..6)
        .find(|&places| width * 10_f64.powi(places) >= 5.0)
        .map_or(6, |places| places as usize)
}

/// Result of a check, as the tables show it.
pub(crate) fn reached(is_reached: bool) -> &'static str {
    if is_reached { "reached" } else { "not reached" }
}
