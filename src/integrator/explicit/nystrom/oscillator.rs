//! Stability of the method on `y'' + damping y' + stiffness y = 0`.
//!
//! A step multiplies position and velocity by a 2 x 2 matrix. Its eigenvalues lie within the unit
//! circle if its determinant is at most 1 and its trace in magnitude at most `1 + determinant`.
//! Both differences are polynomials in `X = stiffness h²` and `Y = damping h`. Where the damping is
//! small, they are far smaller than the rounding of the matrix. So they are computed from their
//! coefficients, which follow from those of the method.

use super::stages::{END, FOURTH, Row, SECOND, THIRD};
use crate::real::Real;
use crate::stability::{LinearMotion, ahead};

/// Takes a step of a linear motion, from and to coordinates and velocities.
pub(super) fn step(motion: &LinearMotion, start: [[f64; 6]; 2], time_step: f64) -> [[f64; 6]; 2] {
    let acceleration = |[y, v]: [[f64; 6]; 2]| motion.acceleration(&y, &v);
    let first = acceleration(start);
    let second = acceleration(stage(&SECOND, &start, &[first], time_step));
    let third = acceleration(stage(&THIRD, &start, &[first, second], time_step));
    let fourth = acceleration(stage(&FOURTH, &start, &[first, second, third], time_step));
    stage(&END, &start, &[first, second, third, fourth], time_step)
}

/// Returns the coordinates and velocities that a row of coefficients gives from the start and the
/// previous stages.
fn stage<const N: usize>(
    row: &Row<N>,
    [start, speed]: &[[f64; 6]; 2],
    stages: &[[f64; 6]; N],
    time_step: f64,
) -> [[f64; 6]; 2] {
    let (mut y, mut v) = (ahead(start, speed, row.time * time_step), *speed);
    for ((stage, place), share) in stages.iter().zip(row.places).zip(row.speeds) {
        y = ahead(&y, stage, place * time_step * time_step);
        v = ahead(&v, stage, share * time_step);
    }
    [y, v]
}

/// Returns true if an amplification factor of a step exceeds 1 in magnitude. The arguments are
/// `X` and `Y`, at least 0.
pub(super) fn grows<R: Real>(x: R, y: R) -> bool {
    let area = determinant_above_1(x, y);
    let above_trace = one_and_determinant_above_trace_per_x(x, y);
    // 1 + determinant + trace = 2 (1 + determinant) - (1 + determinant - trace)
    let above_minus_trace = (R::TWO + area) * R::TWO - above_trace * x;
    let is_stable = area <= R::ZERO && above_trace >= R::ZERO && above_minus_trace >= R::ZERO;
    !is_stable
}

/// Determinant of the step's matrix, minus 1.
fn determinant_above_1<R: Real>(x: R, y: R) -> R {
    let c = R::from_f64;
    let of_damping = ((y * c(1.0 / 24.0) - c(1.0 / 6.0)) * y + c(0.5)) * y - R::ONE;
    let of_both = x * y * (x * c(13.0) - y * y * c(61.0)) * c(1.0 / 2880.0);
    let of_squares = x * x * y * (y * c(79.0 / 21_600.0) + x * c(113.0 / 691_200.0));
    let of_springs = x * x * x * (c(73.0 / 172_800.0) - x * c(1.0 / 25_600.0));
    of_damping * y + of_both + of_squares + of_springs
}

/// `(1 + determinant - trace)/X` of the step's matrix.
fn one_and_determinant_above_trace_per_x<R: Real>(x: R, y: R) -> R {
    let c = R::from_f64;
    let of_damping = ((c(1.0 / 6.0) - y * c(1.0 / 24.0)) * y - c(0.5)) * y + R::ONE;
    let of_first = (y * y * c(1.0 / 2880.0) + y * c(1.0 / 24.0) - c(1.0 / 12.0)) * x;
    let of_second = x * x * (c(1.0 / 360.0) - y * c(1.0 / 86_400.0) - x * c(1.0 / 25_600.0));
    of_damping + of_first + of_second
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Integrator, Nystrom};
    use approx::assert_relative_eq;

    /// Returns position and velocity (times `h`) after a step.
    fn stepped(x: f64, y: f64, start: [f64; 2]) -> [f64; 2] {
        let bend = |[place, speed]: [f64; 2]| -(x * place + y * speed);
        let mut bends = [bend(start), 0.0, 0.0, 0.0];
        bends[1] = bend(ahead(&SECOND, start, &bends));
        bends[2] = bend(ahead(&THIRD, start, &bends));
        bends[3] = bend(ahead(&FOURTH, start, &bends));
        ahead(&END, start, &bends)
    }

    /// Returns position and velocity that a row of coefficients gives from the start and the
    /// previous stages.
    fn ahead<const N: usize>(row: &Row<N>, start: [f64; 2], bends: &[f64; 4]) -> [f64; 2] {
        let [mut y, mut v] = start;
        y += v * row.time;
        for ((bend, place), speed) in bends.iter().zip(row.places).zip(row.speeds) {
            y += bend * place;
            v += bend * speed;
        }
        [y, v]
    }

    #[test]
    fn the_polynomials_are_those_of_a_step() {
        for x in [0.0, 0.3, 2.0, 5.0, 9.0] {
            for y in [0.0, 0.2, 1.1, 2.7] {
                let [first, second] = [[1.0, 0.0], [0.0, 1.0]].map(|start| stepped(x, y, start));
                let determinant = first[0] * second[1] - first[1] * second[0];
                let trace = first[0] + second[1];
                let excess = determinant_above_1(x, y);
                assert_relative_eq!(excess, determinant - 1.0, epsilon = 1e-13);
                let above = one_and_determinant_above_trace_per_x(x, y) * x;
                assert_relative_eq!(above, 1.0 + determinant - trace, epsilon = 1e-13);
            }
        }
    }

    /// Relative error of the limit from where damping removes what a step adds, to leading order:
    /// `Y = 73 X³/172800`. The next term, `X⁴/25600`, is 7e-4 of the last at a ratio of 1e-9. The
    /// limit is a fifth root, with an error of 1.4e-4.
    fn error_of_limit<R: Real>(ratio: f64) -> f64 {
        let frequency = 300.0;
        let time_step = R::from_f64(1e-3);
        let (stiffness, damping) = (frequency * frequency, 2.0 * ratio * frequency);
        let limit = Nystrom { time_step }
            .largest_stable_step(R::from_f64(stiffness), R::from_f64(damping))
            .unwrap();
        let expected = (2.0 * ratio * (172_800.0 / 73.0)).powf(0.2) / frequency;
        limit.to_f64() / expected - 1.0
    }

    #[test]
    fn a_damping_below_rounding_bounds_the_step_in_both_precisions() {
        for ratio in [1e-20, 1e-16, 1e-12, 1e-9] {
            for error in [error_of_limit::<f32>(ratio), error_of_limit::<f64>(ratio)] {
                assert!(error.abs() < 2e-4, "ratio {ratio:e}: {error:e}");
            }
        }
    }
}
