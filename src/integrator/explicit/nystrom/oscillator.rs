//! Stability of the method on `y'' + damping y' + stiffness y = 0`.

use super::stages::{END, FOURTH, Row, SECOND, THIRD};
use crate::real::Real;

/// Returns true if an amplification factor of a step exceeds 1 in magnitude. The arguments are
/// `stiffness h²` and `damping h`.
pub(super) fn grows<R: Real>(stiffness: R, damping: R) -> bool {
    let [y, v] = [[R::ONE, R::ZERO], [R::ZERO, R::ONE]].map(|s| stepped(stiffness, damping, s));
    let trace = y[0] + v[1];
    let determinant = y[0] * v[1] - y[1] * v[0];
    // If stable, the roots of z² - trace z + determinant lie within the unit circle.
    let stable = determinant <= R::ONE && trace.abs() <= R::ONE + determinant;
    !stable
}

/// Returns position and velocity (times `h`) after a step.
fn stepped<R: Real>(stiffness: R, damping: R, start: [R; 2]) -> [R; 2] {
    let mut bends = [R::ZERO; 4];
    let bend = |[y, v]: [R; 2]| -(stiffness * y + damping * v);
    bends[0] = bend(start);
    bends[1] = bend(ahead(&SECOND, start, &bends));
    bends[2] = bend(ahead(&THIRD, start, &bends));
    bends[3] = bend(ahead(&FOURTH, start, &bends));
    ahead(&END, start, &bends)
}

/// Returns position and velocity that a row of coefficients gives from the start and the previous
/// stages.
fn ahead<R: Real, const N: usize>(row: &Row<N>, start: [R; 2], bends: &[R; 4]) -> [R; 2] {
    let [mut y, mut v] = start;
    y += v * R::from_f64(row.time);
    for ((&bend, &place), &speed) in bends.iter().zip(&row.places).zip(&row.speeds) {
        y += bend * R::from_f64(place);
        v += bend * R::from_f64(speed);
    }
    [y, v]
}
