//! 6 by 6 matrices.

use crate::real::Real;

/// 6 by 6 matrix, stored by rows.
#[derive(Clone, Copy)]
pub(super) struct Matrix<R>(pub(super) [[R; 6]; 6]);

/// Number of squarings for a spectral radius: the 2²⁰th power leaves a factor of
/// `condition^(1/2²⁰)`.
const SQUARINGS: usize = 20;

impl<R: Real> Matrix<R> {
    pub(super) const ZERO: Self = Self([[R::ZERO; 6]; 6]);

    pub(super) fn add(&mut self, other: &Self) {
        *self = self.combined(R::ONE, other, R::ONE);
    }

    /// Returns `p self + q other`.
    pub(super) fn combined(&self, p: R, other: &Self, q: R) -> Self {
        let mut sum = *self;
        for (row, others) in sum.0.iter_mut().zip(&other.0) {
            for (value, &other) in row.iter_mut().zip(others) {
                *value = *value * p + other * q;
            }
        }
        sum
    }

    /// Adds `factor column rowᵀ`.
    pub(super) fn add_outer(&mut self, factor: R, column: &[R; 6], row: &[R; 6]) {
        for (values, &left) in self.0.iter_mut().zip(column) {
            for (value, &right) in values.iter_mut().zip(row) {
                *value += factor * left * right;
            }
        }
    }

    /// Adds a vector to a column.
    pub(super) fn add_column(&mut self, index: usize, column: &[R; 6]) {
        for (row, &value) in self.0.iter_mut().zip(column) {
            if let Some(sum) = row.get_mut(index) {
                *sum += value;
            }
        }
    }

    pub(super) fn largest(&self) -> R {
        (self.0.iter().flatten()).fold(R::ZERO, |largest, value| value.abs().at_least(largest))
    }

    fn squared(&self, scale: R) -> Self {
        let mut square = Self::ZERO;
        for (row, left) in square.0.iter_mut().zip(&self.0) {
            for (&factor, right) in left.iter().zip(&self.0) {
                for (value, &other) in row.iter_mut().zip(right) {
                    *value += (factor * scale) * (other * scale);
                }
            }
        }
        square
    }

    /// Largest magnitude of an eigenvalue, by repeated squaring: `ρ(A) = s₀ √(s₁ √(s₂ …))`, where
    /// the s are the scales of the powers.
    pub(super) fn spectral_radius(&self) -> R {
        let mut scales = [R::ONE; SQUARINGS];
        let mut power = *self;
        for scale in &mut scales {
            *scale = power.largest();
            if !(*scale > R::ZERO && scale.is_finite()) {
                return R::ZERO;
            }
            power = power.squared(R::ONE / *scale);
        }
        let radius = |inner: R, &scale: &R| scale * inner.sqrt();
        scales.iter().rev().fold(R::ONE, radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_spectral_radius_is_that_of_symmetric_skew_and_defective_matrices() {
        let mut matrix = Matrix::<f64>::ZERO;
        assert_relative_eq!(matrix.spectral_radius(), 0.0);
        // A block of rotation by a right angle times 3, a diagonal of 2, and a coupling of 1e3
        // between equal eigenvalues.
        matrix.0[0][1] = 3.0;
        matrix.0[1][0] = -3.0;
        matrix.0[2][2] = 2.0;
        matrix.0[3][3] = 2.0;
        matrix.0[2][3] = 1e3;
        assert_relative_eq!(matrix.spectral_radius(), 3.0, max_relative = 1e-5);
        // Defective and dominant: the last scale is that of the power n = 2¹⁹, whose largest entry
        // is 1e3 n 2ⁿ⁻¹. The relative error of its root is ln(500 n)/n = 3.7e-5.
        matrix.0[0][1] = 1.0;
        assert_relative_eq!(matrix.spectral_radius(), 2.0, max_relative = 4e-5);
        // Scales far from 1.
        let small = matrix.combined(1e-200, &matrix, 0.0);
        assert_relative_eq!(small.spectral_radius(), 2e-200, max_relative = 4e-5);
    }
}
