//! Curves with no more points than a picture can show.

use crate::setup::RADIUS;

/// Points `(x, y)` in order.
pub(crate) type Curve = Vec<(f64, f64)>;

/// Distance below which two points on the floor look equal in a large picture, m.
pub(crate) const NEAR: f64 = 2e-3;

/// A track without the points that are nearer than `near` (m) to the previous one.
pub(crate) fn simplified(track: impl Iterator<Item = (f64, f64)>, near: f64) -> Curve {
    let mut kept: Curve = Vec::new();
    for (x, y) in track {
        let is_near = kept
            .last()
            .is_some_and(|last| (x - last.0).hypot(y - last.1) < near);
        if !is_near {
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
