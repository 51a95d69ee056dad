//! Small matrices with real and with complex entries: products, the inverse of three equations, and
//! Gaussian elimination.

use crate::real::Real;
use core::ops::{Add, Div, Mul, Sub};

/// Number that linear equations can have as coefficients.
pub(super) trait Scalar<R: Real>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// Number with this real part.
    fn real(value: R) -> Self;
    /// Product with a real number.
    fn scaled(self, factor: R) -> Self;
    /// Size for the choice of a pivot.
    fn size(self) -> R;
}

impl<R: Real> Scalar<R> for R {
    #[inline]
    fn real(value: R) -> Self {
        value
    }
    #[inline]
    fn scaled(self, factor: R) -> Self {
        self * factor
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
    fn scaled(self, factor: R) -> Self {
        Self {
            re: self.re * factor,
            im: self.im * factor,
        }
    }
    #[inline]
    fn size(self) -> R {
        self.re.abs() + self.im.abs()
    }
}

/// Matrix by its rows.
pub(super) type Rows<T, const M: usize, const N: usize> = [[T; N]; M];

/// Product of a real matrix with a vector.
#[inline(always)]
pub(super) fn image<R: Real, T: Scalar<R>, const M: usize, const N: usize>(
    matrix: &Rows<R, M, N>,
    vector: &[T; N],
) -> [T; M] {
    matrix.map(|row| sum(row.iter().zip(vector), |(&a, &b)| b.scaled(a)))
}

/// Product of a matrix with a vector.
#[inline(always)]
pub(super) fn product<R: Real, T: Scalar<R>, const M: usize, const N: usize>(
    matrix: &Rows<T, M, N>,
    vector: &[T; N],
) -> [T; M] {
    matrix.map(|row| sum(row.iter().zip(vector), |(&a, &b)| a * b))
}

/// Row `left` times a real matrix.
#[inline(always)]
pub(super) fn row_times<R: Real, T: Scalar<R>, const M: usize, const N: usize>(
    left: &[T; M],
    matrix: &Rows<R, M, N>,
) -> [T; N] {
    core::array::from_fn(|j| sum(left.iter().zip(matrix), |(&a, row)| a.scaled(row[j])))
}

/// Real row `left` times a matrix.
#[inline(always)]
pub(super) fn real_row_times<R: Real, T: Scalar<R>, const M: usize, const N: usize>(
    left: &[R; M],
    matrix: &Rows<T, M, N>,
) -> [T; N] {
    core::array::from_fn(|j| sum(left.iter().zip(matrix), |(&a, row)| row[j].scaled(a)))
}

/// Sums of the entries of two vectors.
#[inline(always)]
pub(super) fn plus<R: Real, T: Scalar<R>, const N: usize>(a: &[T; N], b: &[T; N]) -> [T; N] {
    core::array::from_fn(|i| a[i] + b[i])
}

#[inline(always)]
fn sum<R: Real, T: Scalar<R>, I: Iterator>(items: I, term: impl Fn(I::Item) -> T) -> T {
    items
        .map(term)
        .fold(T::real(R::ZERO), |sum, term| sum + term)
}

/// Inverse of three equations, by cofactors.
pub(super) fn inverse<R: Real, T: Scalar<R>>([a, b, c]: &Rows<T, 3, 3>) -> Rows<T, 3, 3> {
    let minor = |p: &[T; 3], q: &[T; 3], i: usize, j: usize| p[i] * q[j] - p[j] * q[i];
    let cross = |p, q| [minor(p, q, 1, 2), minor(p, q, 2, 0), minor(p, q, 0, 1)];
    let columns = [cross(b, c), cross(c, a), cross(a, b)];
    let determinant = a[0] * columns[0][0] + a[1] * columns[0][1] + a[2] * columns[0][2];
    let inverse = T::real(R::ONE) / determinant;
    core::array::from_fn(|i| columns.map(|column| column[i] * inverse))
}

/// Returns `shift · 1 - matrix`.
#[inline(always)]
pub(super) fn shifted<R: Real, T: Scalar<R>, const N: usize>(
    shift: T,
    matrix: &Rows<R, N, N>,
) -> Rows<T, N, N> {
    core::array::from_fn(|i| {
        core::array::from_fn(|j| {
            let diagonal = if i == j { shift } else { T::real(R::ZERO) };
            diagonal - T::real(matrix[i][j])
        })
    })
}

/// A matrix as a product of triangular matrices, with its rows in the order of their pivots. The
/// inverses of the pivots take their places.
pub(super) struct Factors<T, const N: usize> {
    rows: Rows<T, N, N>,
    /// Number of the equation that each row was.
    order: [usize; N],
}

impl<T, const N: usize> Factors<T, N> {
    pub(super) fn of<R: Real>(rows: Rows<T, N, N>) -> Self
    where
        T: Scalar<R>,
    {
        let mut factors = Self {
            rows,
            order: core::array::from_fn(|i| i),
        };
        for column in 0..N {
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
        for i in column + 1..N {
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
        let inverse = T::real(R::ONE) / self.rows[column][column];
        self.rows[column][column] = inverse;
        let pivot = self.rows[column];
        for row in self.rows.iter_mut().skip(column + 1) {
            let factor = row[column] * inverse;
            row[column] = factor;
            for j in column + 1..N {
                row[j] = row[j] - factor * pivot[j];
            }
        }
    }

    /// Solves the equations for a right-hand side.
    #[inline]
    pub(super) fn solve<R: Real>(&self, right: &[T; N]) -> [T; N]
    where
        T: Scalar<R>,
    {
        let zero = T::real(R::ZERO);
        let mut solution = self
            .order
            .map(|equation| right.get(equation).copied().unwrap_or(zero));
        for i in 1..N {
            for j in 0..i {
                solution[i] = solution[i] - self.rows[i][j] * solution[j];
            }
        }
        for i in (0..N).rev() {
            for j in i + 1..N {
                solution[i] = solution[i] - self.rows[i][j] * solution[j];
            }
            solution[i] = solution[i] * self.rows[i][i];
        }
        solution
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: usize = 6;

    /// A matrix that needs row exchanges: the first pivots are 0.
    fn matrix() -> Rows<f64, SIZE, SIZE> {
        core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                let far = (i + 2) % SIZE == j;
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
        let x = Factors::of(shifted(shift, &matrix)).solve(&right);
        let complex = Complex { re: shift, im: 2.0 };
        let given = right.map(|value| Complex {
            re: value,
            im: -value,
        });
        let z = Factors::of(shifted(complex, &matrix)).solve(&given);
        let found = product(&shifted(shift, &matrix), &x);
        let of_complex = product(&shifted(complex, &matrix), &z);
        for i in 0..SIZE {
            assert!((found[i] - right[i]).abs() < 1e-12, "{i}: {}", found[i]);
            let off = of_complex[i] - given[i];
            assert!(off.size() < 1e-12, "{i}: {off:?}");
        }
    }

    #[test]
    fn a_matrix_times_its_inverse_is_the_unit_matrix() {
        let matrix = [[1.1, -7.0, 2.0], [7.0, 2.0, -0.5], [-1.5, 0.5, 0.8]];
        for im in [0.0, 3.0, -20.0] {
            let given = matrix.map(|row| {
                row.map(|re| Complex {
                    re,
                    im: im * re * re,
                })
            });
            let inverse = inverse(&given);
            for i in 0..3 {
                let found = product(&given, &inverse.map(|row| row[i]));
                for (j, entry) in found.into_iter().enumerate() {
                    let unit = Scalar::<f64>::real(f64::from(u8::from(i == j)));
                    assert!((entry - unit).size() < 1e-12, "{im} {i} {j}: {entry:?}");
                }
            }
        }
    }
}
