//! Growth of a small disturbance in one step, for the tests of the stability limit.

use tumble::State;
use tumble::glam::{DQuat, DVec3};

/// The largest factor by which a step takes a small disturbance with it: spectral radius of the
/// step's derivative by central differences.
pub(crate) fn factor_of_a_step(step: impl Fn(&mut State), start: &State, dt: f64) -> f64 {
    // Lengths of the size of the body, times of the step, and a mass of 1 kg: all of order 1 m but
    // for the disturbance. It must not lift a contact: one of 1e-10 did, by its velocity.
    let small = 1e-12;
    let moved = |i: usize, by: f64| {
        let (mut state, push) = (*start, DVec3::AXES[i % 3] * by);
        match i / 3 {
            0 => state.position += push,
            1 => {
                state.orientation = (DQuat::from_scaled_axis(push) * state.orientation).normalize()
            }
            2 => state.linear_velocity += push / dt,
            _ => state.angular_momentum += push / dt,
        }
        step(&mut state);
        state
    };
    let columns: Vec<Vec<f64>> = (0..12)
        .map(|i| {
            let (a, b) = (moved(i, small), moved(i, -small));
            let turn = a.orientation * b.orientation.conjugate();
            // The rotation between the two is far below 1 rad.
            let turn = turn.xyz() * (2.0 * turn.w.signum());
            let parts = [
                a.position - b.position,
                turn,
                (a.linear_velocity - b.linear_velocity) * dt,
                (a.angular_momentum - b.angular_momentum) * dt,
            ];
            let parts = parts.iter().flat_map(DVec3::to_array);
            parts.map(|part| part / (2.0 * small)).collect()
        })
        .collect();
    spectral_radius(columns)
}

/// Spectral radius by the 2^16th power: a constant mode, or one with linear growth (a factor of 1,
/// twice), gives a value below 1 + 16 ln 2/2^16 = 1.0002.
fn spectral_radius(mut matrix: Vec<Vec<f64>>) -> f64 {
    let mut logarithm = 0.0;
    for squaring in 0..16 {
        let largest = matrix.iter().flatten().fold(0.0_f64, |a, b| a.max(b.abs()));
        logarithm += largest.ln() / f64::from(1 << squaring);
        let product = |column: &Vec<f64>, row: usize| {
            let terms = column.iter().zip(&matrix);
            terms
                .map(|(factor, other)| factor * other[row])
                .sum::<f64>()
                / largest.powi(2)
        };
        matrix = (matrix.iter())
            .map(|column| (0..12).map(|row| product(column, row)).collect())
            .collect();
    }
    logarithm.exp()
}

/// The smallest of some multiples of a step size, 1.03 to 4, at which a disturbance grows by more
/// than 2 % in a step, or infinity.
pub(crate) fn growing_from(factor: impl Fn(f64) -> f64) -> f64 {
    const PARTS: [f64; 10] = [1.03, 1.1, 1.2, 1.35, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0];
    let grows = |part: &f64| factor(*part) > 1.02;
    PARTS.into_iter().find(grows).unwrap_or(f64::INFINITY)
}
