//! 6 by 6 matrices.

use crate::real::Real;

/// 6 by 6 matrix, stored by rows.
#[derive(Clone, Copy)]
pub(super) struct Matrix<R>(pub(super) [[R; 6]; 6]);

impl<R: Real> Matrix<R> {
    pub(super) const ZERO: Self = Self([[R::ZERO; 6]; 6]);

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
}
