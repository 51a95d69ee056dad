//! A number that counts the operations applied to it, and vectors and quaternions of such numbers.
//!
//! # Rules of counting
//!
//! - One operation each: addition or subtraction, multiplication, division, square root,
//!   comparison of two numbers.
//! - A change of sign counts nothing: it turns an addition into a subtraction.
//! - Loads, stores, moves between registers, branches and the arithmetic of addresses are no
//!   arithmetic.
//! - A multiplication and an addition are two operations. The library never fuses them, because the
//!   bits of its results are the same on all processors.
//! - Products of the scene's parameters, such as `dt/m`, are known before the first step.

use core::cell::Cell;
use core::cmp::Ordering;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Kinds of operations, in the order of [`Counts`].
#[derive(Clone, Copy)]
enum Kind {
    Sum,
    Product,
    Division,
    Root,
    Comparison,
}

/// Numbers of sums, products, divisions, roots and comparisons.
pub(crate) type Counts = [u64; 5];

std::thread_local! {
    static COUNTS: Cell<Counts> = const { Cell::new([0; 5]) };
}

fn count(kind: Kind) {
    let mut counts = COUNTS.get();
    counts[kind as usize] += 1;
    COUNTS.set(counts);
}

/// Returns the value of `compute`, and the operations that it takes.
pub(crate) fn counted<T>(compute: impl FnOnce() -> T) -> (T, Counts) {
    let before = COUNTS.get();
    let value = compute();
    let after = COUNTS.get();
    (value, core::array::from_fn(|i| after[i] - before[i]))
}

/// Returns the value of `compute` without counting its operations: what is known before the step,
/// or is no part of the formulas.
pub(crate) fn uncounted<T>(compute: impl FnOnce() -> T) -> T {
    let before = COUNTS.get();
    let value = compute();
    COUNTS.set(before);
    value
}

/// Number whose operations are counted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct N(pub(crate) f64);

impl N {
    pub(crate) const ZERO: Self = Self(0.0);

    pub(crate) fn sqrt(self) -> Self {
        count(Kind::Root);
        Self(self.0.sqrt())
    }

    pub(crate) fn at_least(self, least: f64) -> Self {
        if self > Self(least) {
            self
        } else {
            Self(least)
        }
    }
}

impl PartialEq for N {
    fn eq(&self, other: &Self) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

impl PartialOrd for N {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        count(Kind::Comparison);
        self.0.partial_cmp(&other.0)
    }
}

macro_rules! operator {
    ($operator:ident, $method:ident, $sign:tt, $kind:ident) => {
        impl $operator for N {
            type Output = N;
            fn $method(self, other: N) -> N {
                count(Kind::$kind);
                N(self.0 $sign other.0)
            }
        }
        impl $operator<f64> for N {
            type Output = N;
            fn $method(self, other: f64) -> N {
                self $sign N(other)
            }
        }
        impl $operator<N> for f64 {
            type Output = N;
            fn $method(self, other: N) -> N {
                N(self) $sign other
            }
        }
    };
}
operator!(Add, add, +, Sum);
operator!(Sub, sub, -, Sum);
operator!(Mul, mul, *, Product);
operator!(Div, div, /, Division);

impl AddAssign for N {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Neg for N {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

/// Vector of three numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct V(pub(crate) [N; 3]);

impl V {
    pub(crate) const ZERO: Self = Self([N::ZERO; 3]);

    pub(crate) fn of(numbers: impl Into<[f64; 3]>) -> Self {
        Self(numbers.into().map(N))
    }

    pub(crate) fn x(self) -> N {
        self.0[0]
    }

    pub(crate) fn y(self) -> N {
        self.0[1]
    }

    pub(crate) fn z(self) -> N {
        self.0[2]
    }

    pub(crate) fn dot(self, other: Self) -> N {
        self.x() * other.x() + self.y() * other.y() + self.z() * other.z()
    }

    pub(crate) fn cross(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([b * z - c * y, c * x - a * z, a * y - b * x])
    }
}

impl Add for V {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(core::array::from_fn(|i| self.0[i] + other.0[i]))
    }
}

impl Sub for V {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(core::array::from_fn(|i| self.0[i] - other.0[i]))
    }
}

impl Mul<N> for V {
    type Output = Self;
    fn mul(self, factor: N) -> Self {
        Self(self.0.map(|number| number * factor))
    }
}

impl Mul<f64> for V {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        self * N(factor)
    }
}

impl Neg for V {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|number| -number))
    }
}

/// Matrix, by columns.
pub(crate) type M = [V; 3];

/// Product of a matrix and a vector.
pub(crate) fn times(matrix: &M, vector: V) -> V {
    matrix[0] * vector.x() + matrix[1] * vector.y() + matrix[2] * vector.z()
}

/// Quaternion `w + v`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Q {
    pub(crate) w: N,
    pub(crate) v: V,
}

impl Q {
    /// Quaternion product.
    pub(crate) fn times(self, other: Self) -> Self {
        Self {
            w: self.w * other.w - self.v.dot(other.v),
            v: other.v * self.w + self.v * other.w + self.v.cross(other.v),
        }
    }

    /// Time derivative for an angular velocity `2 half` in world axes: `(0, half) q`.
    pub(crate) fn rate(self, half: V) -> Self {
        Self {
            w: -half.dot(self.v),
            v: half * self.w + half.cross(self.v),
        }
    }

    pub(crate) fn plus(self, other: Self, factor: N) -> Self {
        Self {
            w: self.w + other.w * factor,
            v: self.v + other.v * factor,
        }
    }

    pub(crate) fn scaled(self, factor: N) -> Self {
        Self {
            w: self.w * factor,
            v: self.v * factor,
        }
    }

    pub(crate) fn length_squared(self) -> N {
        self.w * self.w + self.v.dot(self.v)
    }

    /// Same rotation, of length 1.
    pub(crate) fn normalised(self) -> Self {
        self.scaled(1.0 / self.length_squared().sqrt())
    }

    /// Columns of the rotation matrix, for a unit quaternion.
    pub(crate) fn axes(self) -> M {
        self.axes_by(self.v + self.v)
    }

    /// Columns of the rotation matrix, for a quaternion of any length.
    pub(crate) fn axes_of_any_length(self) -> M {
        self.axes_by(self.v * (2.0 / self.length_squared()))
    }

    fn axes_by(self, double: V) -> M {
        let ([x, y, z], w) = (self.v.0, self.w);
        let [xx, yy, zz] = [x * double.x(), y * double.y(), z * double.z()];
        let [wx, wy, wz] = (double * w).0;
        let [xy, xz, yz] = [x * double.y(), x * double.z(), y * double.z()];
        [
            V([1.0 - (yy + zz), xy + wz, xz - wy]),
            V([xy - wz, 1.0 - (xx + zz), yz + wx]),
            V([xz + wy, yz - wx, 1.0 - (xx + yy)]),
        ]
    }

    /// First column of the rotation matrix alone, for a unit quaternion: the axis of symmetry.
    pub(crate) fn first_axis(self) -> V {
        let ([x, y, z], w) = (self.v.0, self.w);
        let [y2, z2] = [y + y, z + z];
        V([1.0 - (y * y2 + z * z2), x * y2 + w * z2, x * z2 - w * y2])
    }

    /// Product `q i` with the axis of symmetry, which takes no operation.
    pub(crate) fn times_first_axis(self) -> Self {
        let [x, y, z] = self.v.0;
        Self {
            w: -x,
            v: V([self.w, z, -y]),
        }
    }
}
