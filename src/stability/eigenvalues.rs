//! Eigenvalues of a matrix.
//!
//! Orthogonal similarities bring the matrix to a block triangular form whose blocks have one or two
//! rows, by the QR method with double shifts (Francis 1961; Golub & Van Loan, Matrix Computations,
//! 4th edition, section 7.5). The numbers are always f64: in single precision, rounding would hide
//! a weak damping.

use crate::real::Real;

/// Steps of the QR method for each row. Two or three for each eigenvalue are usual.
const MOST_STEPS: usize = 30;
/// Steps of the QR method without a new block after which other shifts are taken.
const PATIENCE: usize = 10;

/// Calls `see` with the real and the imaginary part of each eigenvalue. Of a conjugate pair, it is
/// called with the one whose imaginary part is positive.
pub(super) fn each_eigenvalue<const N: usize>(rows: [[f64; N]; N], see: impl FnMut([f64; 2])) {
    Triangular::of(rows).each_eigenvalue(see);
}

/// Matrix on the way to its block triangular form, by orthogonal similarities.
struct Triangular<const N: usize> {
    rows: [[f64; N]; N],
    /// Entry that counts as 0.
    rounding: f64,
}

impl<const N: usize> Triangular<N> {
    /// Brings a matrix to Hessenberg form: 0 below the first subdiagonal.
    fn of(rows: [[f64; N]; N]) -> Self {
        let largest = (rows.iter().flatten()).fold(0.0_f64, |a, b| a.max(b.abs()));
        let mut matrix = Self {
            rows,
            rounding: f64::EPSILON * largest,
        };
        for column in 0..N.saturating_sub(2) {
            let below = matrix.rows.map(|row| row[column]);
            matrix.reflect(column + 1, &below[column + 1..]);
            for row in matrix.rows.iter_mut().skip(column + 2) {
                row[column] = 0.0;
            }
        }
        matrix
    }

    /// Calls `see` with the eigenvalues of each block, from the last one on. Blocks that do not
    /// converge are left out.
    fn each_eigenvalue(&mut self, mut see: impl FnMut([f64; 2])) {
        let (mut end, mut steps_since_block) = (N, 0);
        for _ in 0..MOST_STEPS * N {
            let start = self.start_of_block(end);
            match end - start {
                0 => return,
                1 => see([self.rows[start][start], 0.0]),
                2 => see_pair(self.last_rows(end), &mut see),
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
        let is_cut = |&row: &usize| self.rows[row][row - 1].abs() <= self.rounding;
        (1..end).rev().find(is_cut).unwrap_or(0)
    }

    /// Block of the two rows before `end`.
    fn last_rows(&self, end: usize) -> [[f64; 2]; 2] {
        let block = |row: usize| [self.rows[row][end - 2], self.rows[row][end - 1]];
        [block(end - 2), block(end - 1)]
    }

    /// One step of the QR method, with both eigenvalues of the last two rows as shifts.
    fn step(&mut self, start: usize, end: usize, is_exceptional: bool) {
        let m = &self.rows;
        let [[mut first, mut b], [mut c, mut second]] = self.last_rows(end);
        if is_exceptional {
            let size = m[end - 1][end - 2].abs() + m[end - 2][end - 3].abs();
            first = second + 0.75 * size;
            (second, b, c) = (first, -0.4375 * size, size);
        }
        // First column of the product of the shifted matrices, divided by the entry below the
        // diagonal. Formed from differences, it has no cancellation where eigenvalues are close.
        let next = start + 1;
        let [to_first, to_second] = [first, second].map(|shift| shift - m[start][start]);
        let mut column = [
            (to_first * to_second - b * c) / m[next][start] + m[start][next],
            m[next][next] - m[start][start] - to_first - to_second,
            m[start + 2][next],
        ];
        for row in start..end - 1 {
            let length = (end - row).min(3);
            self.reflect(row, &column[..length]);
            let below = |i: usize| self.rows.get(row + i).map_or(0.0, |values| values[row]);
            column = [below(1), below(2), below(3)];
        }
        for row in start + 2..end {
            self.rows[row][..row - 1].fill(0.0);
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
        let rows = &mut self.rows[places.clone()];
        let mut sums = [0.0; N];
        for (row, &part) in rows.iter().zip(&*mirror) {
            add(&mut sums, part, row);
        }
        for (row, &part) in rows.iter_mut().zip(&*mirror) {
            add(row, -2.0 * part, &sums);
        }
        for row in &mut self.rows {
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

pub(super) fn length(vector: &[f64]) -> f64 {
    Real::sqrt(vector.iter().map(|value| value * value).sum::<f64>())
}

/// Calls `see` with the eigenvalues of two rows.
fn see_pair([[a, b], [c, d]]: [[f64; 2]; 2], see: &mut impl FnMut([f64; 2])) {
    let half = 0.5 * (a - d);
    let coupling = b * c;
    let square = half * half + coupling;
    if square < 0.0 {
        see([d + half, Real::sqrt(-square)]);
        return;
    }
    // Without cancellation: the one that is farther from d, and the other by their product.
    let root = Real::sqrt(square);
    let far = half + if half < 0.0 { -root } else { root };
    let near = if far == 0.0 { 0.0 } else { -coupling / far };
    see([d + far, 0.0]);
    see([d + near, 0.0]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// `J + N` with blocks of one, two and three equal eigenvalues, in other coordinates. Each
        /// is a defective eigenvalue, which rounding splits by its root.
        #[test]
        fn every_eigenvalue_of_a_defective_matrix_is_found(
            direction in prop::array::uniform6(-1.0..1.0_f64),
            size in 1e-9..1.0_f64,
        ) {
            let square: f64 = direction.iter().map(|x| x * x).sum();
            prop_assume!(square > 0.1);
            let mirror = |i: usize, j: usize| {
                f64::from(u8::from(i == j)) - 2.0 * direction[i] * direction[j] / square
            };
            let block = [
                [2.0, 0.0, 0.0, 0.0, 0.0, 0.0],
                [0.0, 1.0, size, 0.0, 0.0, 0.0],
                [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
                [0.0, 0.0, 0.0, 0.5, size, 0.0],
                [0.0, 0.0, 0.0, 0.0, 0.5, size],
                [0.0, 0.0, 0.0, 0.0, 0.0, 0.5],
            ];
            let product = |a: &dyn Fn(usize, usize) -> f64, b: &dyn Fn(usize, usize) -> f64| {
                core::array::from_fn(|i| {
                    core::array::from_fn(|j| (0..6).map(|k| a(i, k) * b(k, j)).sum())
                })
            };
            let half: [[f64; 6]; 6] = product(&mirror, &|i, j| block[i][j]);
            let rows: [[f64; 6]; 6] = product(&|i, j| half[i][j], &mirror);
            let mut found = alloc::vec::Vec::new();
            each_eigenvalue(rows, |[re, im]| {
                let pair = if im > 0.0 { 2 } else { 1 };
                found.extend(core::iter::repeat_n([re, im], pair));
            });
            prop_assert_eq!(found.len(), 6);
            found.sort_by(|a, b| a[0].total_cmp(&b[0]));
            for (found, expected) in found.iter().zip([0.5, 0.5, 0.5, 1.0, 1.0, 2.0]) {
                let off = length(&[found[0] - expected, found[1]]);
                prop_assert!(off < 1e-4, "{found:?}, not {expected}");
            }
        }
    }
}
