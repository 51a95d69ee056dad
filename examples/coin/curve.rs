//! Curves with no more points than a picture can show.

use crate::setup::RADIUS;

/// Points `(x, y)` in order.
pub(crate) type Curve = Vec<(f64, f64)>;

/// Number of time intervals. More than a picture has pixels would have no visible effect.
const STRIPS: usize = 1000;

/// A curve over time, reduced to the first, lowest, highest and last point of each time interval.
pub(crate) fn thinned(curve: Curve) -> Curve {
    let strip = curve.len().div_ceil(STRIPS);
    if strip <= 4 {
        return curve;
    }
    curve.chunks(strip).flat_map(extremes).collect()
}

/// First, lowest, highest and last point of an interval, in order and without repetition.
fn extremes(strip: &[(f64, f64)]) -> impl Iterator<Item = (f64, f64)> + '_ {
    let by_value = |a: &usize, b: &usize| strip[*a].1.total_cmp(&strip[*b].1);
    let lowest = (0..strip.len()).min_by(by_value).unwrap_or(0);
    let highest = (0..strip.len()).max_by(by_value).unwrap_or(0);
    let mut kept = vec![0, lowest, highest, strip.len() - 1];
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter().map(|index| strip[index])
}

/// Distance below which two points on the floor look equal, m.
const NEAR: f64 = 2e-3;

/// A track without the points that are close to the previous one.
pub(crate) fn simplified(track: impl Iterator<Item = (f64, f64)>) -> Curve {
    let mut kept: Curve = Vec::new();
    for (x, y) in track {
        let near = kept
            .last()
            .is_some_and(|last| (x - last.0).hypot(y - last.1) < NEAR);
        if !near {
            kept.push((x, y));
        }
    }
    kept
}

/// Distance beyond which the lowest point has jumped across the coin instead of moving along its
/// rim, m.
const LEAP: f64 = 0.6 * RADIUS;

/// Divides a track where it jumps.
pub(crate) fn pieces(track: &[(f64, f64)]) -> Vec<Curve> {
    track
        .chunk_by(|a, b| (b.0 - a.0).hypot(b.1 - a.1) < LEAP)
        .map(<[_]>::to_vec)
        .collect()
}
