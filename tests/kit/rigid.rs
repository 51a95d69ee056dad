//! How far a body is from rigid.
//!
//! Everything is measured on the stored quaternion as it is, with glam's product, which does not
//! scale it to length 1 first: a length that drifts would stretch the body.

use tumble::glam::{DQuat, DVec3};

/// Error of the length of a quaternion after a step.
///
/// A square that differs from 1 by less than 4.4e-16 is left unchanged. The square is known to the
/// rounding of four squares and three sums (at most 4 units of 1.1e-16). Half of both is that of
/// the length: 4.4e-16. Measured: 3.3e-16.
pub(crate) const LENGTH: f64 = 4.5e-16;

/// Relative change of a distance: twice that of the quaternion, and the rounding of the two rotated
/// points, a few units of 1.1e-16 each. The design promises 4e-15. Measured: 2.1e-15 over all tests
/// of `tests/physics/rigidity.rs`.
pub(crate) const DISTANCE: f64 = 4e-15;

/// Distance of the quaternion's length from 1, and largest change of a distance between two of
/// `points`, relative to the larger of the two arms.
///
/// (A pair much closer together than its arms is long loses digits to subtraction in this
/// measurement, not in the body.)
pub(crate) fn deformation(points: &[DVec3], orientation: DQuat) -> (f64, f64) {
    let turned: Vec<_> = points.iter().map(|&point| orientation * point).collect();
    // Each point with a few others: neighbours, and across the body.
    let strides = [1, 2, points.len() / 3, points.len() / 2];
    let pairs = (0..points.len()).flat_map(|i| strides.map(|s| (i, (i + s) % points.len())));
    let stretch = pairs.map(|(i, j)| {
        let scale = points[i].length().max(points[j].length());
        let change = turned[i].distance(turned[j]) - points[i].distance(points[j]);
        if scale > 0.0 {
            change.abs() / scale
        } else {
            0.0
        }
    });
    // The sum is rounded a few times itself, so the length is measured by its excess, without a
    // square root.
    let [x, y, z, w] = orientation.to_array();
    let excess = ((w - 1.0) * (w + 1.0) + x * x + (y * y + z * z)) / 2.0;
    (excess.abs(), stretch.fold(0.0, f64::max))
}
