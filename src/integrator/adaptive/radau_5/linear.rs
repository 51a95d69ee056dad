//! Solution of the linear equations of the stages by Gaussian elimination, with real and with
//! complex coefficients.

use crate::real::Real;
use core::ops::{Add, Div, Mul, Sub};

/// Number of equations: shift, rotation, velocity, angular momentum and length of the quaternion.
pub(super) const SIZE: usize = 13;

/// Number that linear equations can have as coefficients.
pub(super) trait Scalar<R: Real>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// Number with this real part.
    fn real(value: R) -> Self;
    /// Size for the choice of a pivot.
    fn size(self) -> R;
}

impl<R: Real> Scalar<R> for R {
    #[inline]
    fn real(value: R) -> Self {
        value
    }
    #[inline]
    fn size(self) -> R {
        self.abs()
    }
}

/// Complex number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Complex<R> {
    pub(super) re: R,
    pub(super) im: R,
}

impl<R: Real> Add for Complex<R> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            re: self.re + other.re,
            im: self.im + other.im,
        }
    }
}

impl<R: Real> Sub for Complex<R> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self {
            re: self.re - other.re,
            im: self.im - other.im,
        }
    }
}

impl<R: Real> Mul for Complex<R> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }
}

impl<R: Real> Div for Complex<R> {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        // The square of a divisor could overflow. Its ratios cannot (Smith 1962).
        if other.re.abs() >= other.im.abs() {
            let ratio = other.im / other.re;
            let divisor = other.re + other.im * ratio;
            Self {
                re: (self.re + self.im * ratio) / divisor,
                im: (self.im - self.re * ratio) / divisor,
            }
        } else {
            let ratio = other.re / other.im;
            let divisor = other.re * ratio + other.im;
            Self {
                re: (self.re * ratio + self.im) / divisor,
                im: (self.im * ratio - self.re) / divisor,
            }
        }
    }
}

impl<R: Real> Scalar<R> for Complex<R> {
    #[inline]
    fn real(value: R) -> Self {
        Self {
            re: value,
            im: R::ZERO,
        }
    }
    #[inline]
    fn size(self) -> R {
        self.re.abs() + self.im.abs()
    }
}

/// The matrix `λ 1 - J` as a product of triangular matrices, with its rows in the order of their
/// pivots.
pub(super) struct Factors<T> {
    rows: [[T; SIZE]; SIZE],
    /// Number of the equation that each row was.
    order: [usize; SIZE],
}

impl<T> Factors<T> {
    /// Factors `shift · 1 - matrix`.
    pub(super) fn of<R: Real>(shift: T, matrix: &[[R; SIZE]; SIZE]) -> Self
    where
        T: Scalar<R>,
    {
        let zero = T::real(R::ZERO);
        let mut rows = [[zero; SIZE]; SIZE];
        for (i, (row, given)) in rows.iter_mut().zip(matrix).enumerate() {
            for (j, (entry, given)) in row.iter_mut().zip(given).enumerate() {
                let diagonal = if i == j { shift } else { zero };
                *entry = diagonal - T::real(*given);
            }
        }
        let mut factors = Self {
            rows,
            order: core::array::from_fn(|i| i),
        };
        for column in 0..SIZE {
            factors.bring_up_pivot(column);
            factors.eliminate(column);
        }
        factors
    }

    /// Exchanges rows until the one with the largest entry in a column is the first of those left.
    #[inline]
    fn bring_up_pivot<R: Real>(&mut self, column: usize)
    where
        T: Scalar<R>,
    {
        for i in column + 1..SIZE {
            if self.rows[i][column].size() > self.rows[column][column].size() {
                self.rows.swap(i, column);
                self.order.swap(i, column);
            }
        }
    }

    /// Eliminates a column from the rows below its pivot. The factors take the place of the zeros.
    #[inline]
    fn eliminate<R: Real>(&mut self, column: usize)
    where
        T: Scalar<R>,
    {
        let pivot = self.rows[column];
        for row in self.rows.iter_mut().skip(column + 1) {
            // Much of the matrix is zero.
            if row[column].size() == R::ZERO {
                continue;
            }
            let factor = row[column] / pivot[column];
            row[column] = factor;
            for j in column + 1..SIZE {
                row[j] = row[j] - factor * pivot[j];
            }
        }
    }

    /// Solves the equations for a right-hand side.
    pub(super) fn solve<R: Real>(&self, right: &[T; SIZE]) -> [T; SIZE]
    where
        T: Scalar<R>,
    {
        let zero = T::real(R::ZERO);
        let mut solution = self
            .order
            .map(|equation| right.get(equation).copied().unwrap_or(zero));
        for i in 1..SIZE {
            for j in 0..i {
                solution[i] = solution[i] - self.rows[i][j] * solution[j];
            }
        }
        for i in (0..SIZE).rev() {
            for j in i + 1..SIZE {
                solution[i] = solution[i] - self.rows[i][j] * solution[j];
            }
            solution[i] = solution[i] / self.rows[i][i];
        }
        solution
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix that needs row exchanges: the first pivots are 0.
    fn matrix() -> [[f64; SIZE]; SIZE] {
        core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                let far = (i + 5) % SIZE == j;
                let spread = f64::from(u32::try_from((i * 7 + j * 3) % 11).unwrap()) / 50.0;
                if i == j {
                    3.0
                } else if far {
                    -8.0
                } else {
                    spread
                }
            })
        })
    }

    #[test]
    fn real_and_complex_equations_are_solved_to_rounding() {
        let matrix = matrix();
        let right: [f64; SIZE] = core::array::from_fn(|i| 1.0 + i as f64);
        let shift = 3.0;
        let x = Factors::of(shift, &matrix).solve(&right);
        let complex = Complex { re: shift, im: 2.0 };
        let given = right.map(|value| Complex {
            re: value,
            im: -value,
        });
        let z = Factors::of(complex, &matrix).solve(&given);
        for i in 0..SIZE {
            let mut sums = (shift * x[i], complex * z[i]);
            for j in 0..SIZE {
                sums.0 -= matrix[i][j] * x[j];
                sums.1 = sums.1 - Complex::real(matrix[i][j]) * z[j];
            }
            assert!((sums.0 - right[i]).abs() < 1e-12, "{i}: {}", sums.0);
            assert!((sums.1 - given[i]).size() < 1e-12, "{i}: {:?}", sums.1);
        }
    }
}
