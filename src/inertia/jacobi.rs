//! Principal moments and axes of an inertia tensor.

use crate::real::{Real, Vector};

/// Computes the moments and the right-handed unit axes of a symmetric matrix by Jacobi's method.
///
/// It uses only `+ - * /` and square roots. A diagonal matrix is left unchanged.
pub(super) fn principal_axes<R: Real>(mut a: [[R; 3]; 3]) -> ([R; 3], [R::Vec3; 3]) {
    let (o, one) = (R::ZERO, R::ONE);
    let mut axes = [
        R::Vec3::new(one, o, o),
        R::Vec3::new(o, one, o),
        R::Vec3::new(o, o, one),
    ];
    // Each sweep squares the off-diagonal remainder. 5 sweeps reach rounding, the rest is margin.
    for _ in 0..12 {
        annihilate::<R, 0, 1>(&mut a, &mut axes);
        annihilate::<R, 0, 2>(&mut a, &mut axes);
        annihilate::<R, 1, 2>(&mut a, &mut axes);
    }
    ([a[0][0], a[1][1], a[2][2]], axes)
}

/// Rotates matrix and axes in the plane of axes P and Q so that their common entry becomes 0.
fn annihilate<R: Real, const P: usize, const Q: usize>(
    a: &mut [[R; 3]; 3],
    axes: &mut [R::Vec3; 3],
) {
    if a[P][Q] == R::ZERO {
        return;
    }
    let (c, s) = annihilating_turn(a[P][P], a[Q][Q], a[P][Q]);
    let [row_p, row_q] = [a[P], a[Q]];
    for k in 0..3 {
        a[P][k] = c * row_p[k] - s * row_q[k];
        a[Q][k] = s * row_p[k] + c * row_q[k];
    }
    for row in a.iter_mut() {
        let [column_p, column_q] = [row[P], row[Q]];
        row[P] = c * column_p - s * column_q;
        row[Q] = s * column_p + c * column_q;
    }
    a[P][Q] = R::ZERO;
    a[Q][P] = R::ZERO;
    let [axis_p, axis_q] = [axes[P], axes[Q]];
    axes[P] = axis_p * c - axis_q * s;
    axes[Q] = axis_p * s + axis_q * c;
}

/// Cosine and sine of the smaller rotation in the plane of two axes that makes their off-diagonal
/// entry 0 (Golub & Van Loan, section 8.5).
fn annihilating_turn<R: Real>(app: R, aqq: R, apq: R) -> (R, R) {
    let tau = (aqq - app) / (R::TWO * apq);
    let root = (R::ONE + tau * tau).sqrt();
    let t = if tau >= R::ZERO {
        R::ONE / (tau + root)
    } else {
        R::ONE / (tau - root)
    };
    let c = R::ONE / (R::ONE + t * t).sqrt();
    (c, t * c)
}
