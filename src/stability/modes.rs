//! Modes of `y'' + C y' + K y = 0`, as oscillators of one coordinate.
//!
//! With `v = y'`, the motion is `(y, v)' = A (y, v)`. An orthogonal similarity brings A to a block
//! triangular form whose blocks have one or two rows. A block of two rows with a pair of complex
//! eigenvalues has the determinant κ and the trace -δ of the oscillator `y'' + δ y' + κ y = 0`,
//! whose solutions have the same rates. Real eigenvalues -δ are those of `y'' + δ y' = 0`.
//!
//! The form is computed by the QR method with double shifts (Francis 1961; Golub & Van Loan, Matrix
//! Computations, 4th edition, section 7.5). A has its norm near 1 by the choice of the unit of
//! time. The numbers are always f64: in single precision, rounding would hide a weak damping.

use super::matrix::Matrix;
use crate::real::Real;

/// Number of coordinates and velocities.
const SIZE: usize = 12;
/// Steps of the QR method. Two or three for each eigenvalue are usual.
const MOST_STEPS: usize = 30 * SIZE;
/// Steps without a new block after which other shifts are taken.
const PATIENCE: usize = 10;
/// Damping that may be rounding, in units in the last place of the matrices and in the unit of
/// frequency.
const ROUNDING: f64 = 1024.0;
/// Frequency below which a mode may be rounding of one without a frequency, in the unit of
/// frequency.
const SLOWEST: f64 = 1e-3;
/// Calls `see` with the stiffness κ (1/s²) and the damping δ (1/s) of each mode that does not grow.
///
/// The unit of frequency is the larger of the greatest entry of C and the square root of that of K.
/// Modes slower than a thousandth of it are left out. A mode whose damping is rounding has none.
pub(super) fn each_mode<R: Real>(
    stiffness: &Matrix<R>,
    damping: &Matrix<R>,
    mut see: impl FnMut([R; 2]),
) {
    let unit = (stiffness.largest().to_f64().sqrt()).at_least(damping.largest().to_f64());
    if !(unit > 0.0 && unit.is_finite()) {
        return;
    }
    let rounding = R::EPSILON.to_f64() * ROUNDING;
    let mut motion = Triangular::of(companion(stiffness, damping, unit));
    motion.each_block(|[stiffness, damping]| {
        if damping >= -rounding {
            let damping = if damping > rounding { damping } else { 0.0 };
            see([stiffness * unit * unit, damping * unit].map(R::from_f64));
        }
    });
}

/// Matrix A of the motion in this unit of frequency.
fn companion<R: Real>(
    stiffness: &Matrix<R>,
    damping: &Matrix<R>,
    unit: f64,
) -> [[f64; SIZE]; SIZE] {
    let mut rows = [[0.0; SIZE]; SIZE];
    let (positions, velocities) = rows.split_at_mut(SIZE / 2);
    for (i, row) in positions.iter_mut().enumerate() {
        row[SIZE / 2 + i] = 1.0;
    }
    let accelerations = stiffness.0.iter().zip(&damping.0);
    for (row, (by_position, by_velocity)) in velocities.iter_mut().zip(accelerations) {
        let (left, right) = row.split_at_mut(SIZE / 2);
        for (value, k) in left.iter_mut().zip(by_position) {
            *value = -(k.to_f64() / unit / unit);
        }
        for (value, c) in right.iter_mut().zip(by_velocity) {
            *value = -(c.to_f64() / unit);
        }
    }
    rows
}

/// Matrix on the way to its block triangular form, by orthogonal similarities.
struct Triangular<const N: usize>([[f64; N]; N]);

impl<const N: usize> Triangular<N> {
    /// Brings a matrix to Hessenberg form: 0 below the first subdiagonal.
    fn of(rows: [[f64; N]; N]) -> Self {
        let mut matrix = Self(rows);
        for column in 0..N.saturating_sub(2) {
            let below = matrix.0.map(|row| row[column]);
            matrix.reflect(column + 1, &below[column + 1..]);
            for row in matrix.0.iter_mut().skip(column + 2) {
                row[column] = 0.0;
            }
        }
        matrix
    }

    /// Calls `see` with the stiffness and the damping of each block, from the last one on. Blocks
    /// that do not converge are left out.
    fn each_block(&mut self, mut see: impl FnMut([f64; 2])) {
        let (mut end, mut steps_since_block) = (N, 0);
        for _ in 0..MOST_STEPS {
            let start = self.start_of_block(end);
            match end - start {
                0 => return,
                1 => see_real(self.0[start][start], &mut see),
                2 => see_pair(self.sums(end), &mut see),
                _ => {
                    steps_since_block += 1;
                    self.step(start, end, steps_since_block % PATIENCE == 0);
                    continue;
                }
            }
            (end, steps_since_block) = (start, 0);
        }
    }

    /// First row of the block that ends before the row `end`: the entry before it is 0 but for
    /// rounding.
    fn start_of_block(&self, end: usize) -> usize {
        let is_cut = |&row: &usize| {
            let near = self.0[row][row].abs() + self.0[row - 1][row - 1].abs();
            let scale = if near > 0.0 { near } else { 1.0 };
            self.0[row][row - 1].abs() <= f64::EPSILON * scale
        };
        (1..end).rev().find(is_cut).unwrap_or(0)
    }

    /// Trace and determinant of the two rows before `end`.
    fn sums(&self, end: usize) -> [f64; 2] {
        let (i, j) = (end - 2, end - 1);
        let m = &self.0;
        [m[i][i] + m[j][j], m[i][i] * m[j][j] - m[i][j] * m[j][i]]
    }

    /// One step of the QR method, with both eigenvalues of the last two rows as shifts.
    fn step(&mut self, start: usize, end: usize, is_exceptional: bool) {
        let [mut trace, mut determinant] = self.sums(end);
        if is_exceptional {
            let size = self.0[end - 1][end - 2].abs() + self.0[end - 2][end - 3].abs();
            (trace, determinant) = (1.5 * size, size * size);
        }
        let (m, next) = (&self.0, start + 1);
        let (a, d) = (m[start][start], m[next][next]);
        let coupling = m[start][next] * m[next][start];
        let mut column = [
            a * a + coupling - trace * a + determinant,
            m[next][start] * (a + d - trace),
            m[next][start] * m[start + 2][next],
        ];
        for row in start..end - 1 {
            let length = (end - row).min(3);
            self.reflect(row, &column[..length]);
            let below = |i: usize| self.0.get(row + i).map_or(0.0, |values| values[row]);
            column = [below(1), below(2), below(3)];
        }
        for row in start + 2..end {
            self.0[row][..row - 1].fill(0.0);
        }
    }

    /// Similarity by the reflection that takes `column`, in the rows from `first` on, to a multiple
    /// of the first of them.
    fn reflect(&mut self, first: usize, column: &[f64]) {
        let mut mirror = [0.0; N];
        let mirror = &mut mirror[..column.len()];
        mirror.copy_from_slice(column);
        let size = length(mirror);
        if size == 0.0 {
            return;
        }
        mirror[0] += if mirror[0] < 0.0 { -size } else { size };
        let size = length(mirror);
        mirror.iter_mut().for_each(|value| *value /= size);

        let places = first..first + mirror.len();
        let rows = &mut self.0[places.clone()];
        let mut sums = [0.0; N];
        for (row, &part) in rows.iter().zip(&*mirror) {
            add(&mut sums, part, row);
        }
        for (row, &part) in rows.iter_mut().zip(&*mirror) {
            add(row, -2.0 * part, &sums);
        }
        for row in &mut self.0 {
            let row = &mut row[places.clone()];
            let sum: f64 = row.iter().zip(&*mirror).map(|(&a, &b)| a * b).sum();
            add(row, -2.0 * sum, mirror);
        }
    }
}

/// Adds a multiple of a vector.
fn add(to: &mut [f64], factor: f64, other: &[f64]) {
    (to.iter_mut().zip(other)).for_each(|(value, &other)| *value += factor * other);
}

fn length(vector: &[f64]) -> f64 {
    vector.iter().map(|value| value * value).sum::<f64>().sqrt()
}

/// Calls `see` with the oscillator of a real eigenvalue, if it does not grow.
fn see_real(rate: f64, see: &mut impl FnMut([f64; 2])) {
    if rate < -SLOWEST {
        see([0.0, -rate]);
    }
}

/// Calls `see` with the oscillators of two eigenvalues with this sum and product.
fn see_pair([trace, determinant]: [f64; 2], see: &mut impl FnMut([f64; 2])) {
    let half = 0.5 * trace;
    let square = half * half - determinant;
    if square < 0.0 {
        if determinant >= SLOWEST * SLOWEST {
            see([determinant, -trace]);
        }
        return;
    }
    // Without cancellation: the larger of both, and the product by it.
    let larger = if half < 0.0 {
        half - square.sqrt()
    } else {
        half + square.sqrt()
    };
    see_real(larger, see);
    if larger != 0.0 {
        see_real(determinant / larger, see);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    fn modes(stiffness: &[[f64; 6]; 6], damping: &[[f64; 6]; 6]) -> Vec<[f64; 2]> {
        let mut found = Vec::new();
        let (stiffness, damping) = (Matrix(*stiffness), Matrix(*damping));
        each_mode(&stiffness, &damping, |mode| found.push(mode));
        found.sort_by(|a, b| a.partial_cmp(b).unwrap());
        found
    }

    fn diagonal(values: [f64; 6]) -> [[f64; 6]; 6] {
        let mut rows = [[0.0; 6]; 6];
        for (i, value) in values.into_iter().enumerate() {
            rows[i][i] = value;
        }
        rows
    }

    /// `S⁻¹ D S` for the product S of shears: row i plus `shears[i]` times the next row.
    fn sheared(mut rows: [[f64; 6]; 6], shears: &[f64; 6]) -> [[f64; 6]; 6] {
        for (i, shear) in shears.iter().enumerate() {
            let next = (i + 1) % 6;
            let other = rows[next];
            (rows[i].iter_mut().zip(other)).for_each(|(value, other)| *value += shear * other);
            for row in &mut rows {
                row[next] -= shear * row[i];
            }
        }
        rows
    }

    proptest! {
        /// Six oscillators, weakly to strongly damped, in any coordinates.
        #[test]
        fn the_modes_are_the_oscillators_of_which_the_motion_was_composed(
            stiffness in prop::array::uniform6(1.0..10.0_f64),
            ratios in prop::array::uniform6(1e-4..1.5_f64),
            shears in prop::array::uniform6(-1.0..1.0_f64),
        ) {
            let damping: [f64; 6] =
                core::array::from_fn(|i| 2.0 * ratios[i] * stiffness[i].sqrt());
            let expected = modes(&diagonal(stiffness), &diagonal(damping));
            let [k, c] = [stiffness, damping].map(|values| sheared(diagonal(values), &shears));
            let found = modes(&k, &c);
            // A critically damped mode has a double eigenvalue, which rounding splits by its root.
            prop_assume!(ratios.iter().all(|ratio| (ratio - 1.0).abs() > 1e-3));
            prop_assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
                let off = (found - expected).abs();
                prop_assert!(off < 1e-8 * (1.0 + expected), "{found}, not {expected}");
            }
        }
    }

    /// The stiffness has the pair `1 ± i e` of eigenvalues, so `λ² = -(1 ± i e)`: one mode decays
    /// and one grows, which is left out.
    #[test]
    fn a_pair_of_complex_stiffnesses_is_a_mode_that_decays_and_one_that_grows() {
        let e = 0.2;
        let mut stiffness = diagonal([1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
        stiffness[0][1] = -e;
        stiffness[1][0] = e;
        // λ = a + i b with a² - b² = -1, 2 a b = e, and κ = a² + b², δ = -2 a.
        let square = (1.0 + e * e).sqrt();
        let rate = ((square - 1.0) / 2.0).sqrt();
        let found = modes(&stiffness, &[[0.0; 6]; 6]);
        assert_eq!(found.len(), 1);
        assert_relative_eq!(found[0][0], square, max_relative = 1e-13);
        assert_relative_eq!(found[0][1], 2.0 * rate, max_relative = 1e-12);
    }

    /// Free motion, a force that a rotation alone causes, and no number at all.
    #[test]
    fn motions_without_a_rate_have_no_mode() {
        let zero = [[0.0; 6]; 6];
        assert!(modes(&zero, &zero).is_empty());
        let mut thrust = zero;
        thrust[0][4] = 3.0;
        thrust[1][3] = -2.0;
        assert!(modes(&thrust, &zero).is_empty());
        assert!(modes(&diagonal([f64::NAN; 6]), &zero).is_empty());
        assert!(modes(&diagonal([f64::INFINITY; 6]), &zero).is_empty());
    }

    #[test]
    fn scales_far_from_1_have_their_modes() {
        for scale in [1e-250, 1e250] {
            let found = modes(&diagonal([scale; 6]), &diagonal([scale.sqrt(); 6]));
            assert_eq!(found.len(), 6);
            for [stiffness, damping] in found {
                assert_relative_eq!(stiffness, scale, max_relative = 1e-12);
                assert_relative_eq!(damping, scale.sqrt(), max_relative = 1e-12);
            }
        }
    }
}
