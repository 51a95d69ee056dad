//! Number types of the crate: [`f32`](primitive@f32) and [`f64`](primitive@f64).
//!
//! [`Real`] names glam's vector, quaternion and matrix of one precision, and the few operations
//! that the core uses. These are `+ - * /` and square roots in one fixed order, which IEEE 754
//! rounds identically on every processor. Sine and cosine come from the `libm` crate, which has the
//! same results on every platform, in contrast to the standard library. In `f32` they come from
//! arithmetic of this crate that needs no double precision.
//!
//! `Real`, [`Vector`], [`Quaternion`] and [`Matrix`] are sealed. They are public so that a body,
//! ground or friction law can be written once for both precisions. Code for one precision needs
//! none of them, except for functions with the same bits on every machine: `R::Vec3` *is*
//! `glam::DVec3` when `R` is `f64`.

use core::fmt::{Debug, Display, LowerExp};
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

#[cfg(feature = "std")]
extern crate std;

mod sine;

mod sealed {
    pub trait Sealed {}
}
use sealed::Sealed;

/// Floating-point number: `f32` or `f64`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a number type of this crate: use `f64` or `f32`",
    label = "this should be `f64` or `f32`",
    note = "write `1.0` for `1`; if the compiler cannot infer the precision, use the names of `tumble::f64` or `tumble::f32`"
)]
pub trait Real:
    Sealed
    + Copy
    + PartialEq
    + PartialOrd
    + Default
    + Debug
    + Display
    + LowerExp
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    /// Type of glam's vector of three such numbers.
    type Vec3: Vector<Self>;
    /// Type of glam's quaternion of such numbers.
    type Quat: Quaternion<Self>;
    /// Type of glam's 3 by 3 matrix of such numbers.
    type Mat3: Matrix<Self>;

    /// The number 0.
    const ZERO: Self;
    /// The number 1.
    const ONE: Self;
    /// The number 1/2.
    const HALF: Self;
    /// The number 2.
    const TWO: Self;
    /// Distance from 1 to the next larger number: 2.2e-16 in f64, 1.2e-7 in f32.
    const EPSILON: Self;
    /// Largest finite number.
    const MAX: Self;

    /// Returns the nearest number of this type. For a literal it is computed at compile time.
    #[must_use]
    fn from_f64(value: f64) -> Self;
    /// Returns the nearest number of this type.
    #[must_use]
    fn from_usize(value: usize) -> Self;
    /// Returns the number as an `f64`, for messages and tables. The conversion from `f32` is exact.
    #[must_use]
    fn to_f64(self) -> f64;
    /// Square root, correctly rounded, or NaN below 0.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Absolute value.
    #[must_use]
    fn abs(self) -> Self;
    /// Returns true if the number is neither infinite nor NaN.
    #[must_use]
    fn is_finite(self) -> bool;
    /// Sine and cosine of an angle in radians, with the same bits everywhere.
    #[must_use]
    fn sin_cos(self) -> (Self, Self);
    /// Angle in radians from the first axis to the point (`x`, `self`), from the `libm` crate.
    #[must_use]
    fn atan2(self, x: Self) -> Self;
    /// Power of `self`, from the `libm` crate. The result is NaN for a negative `self`, except for
    /// integer exponents.
    #[must_use]
    fn powf(self, exponent: Self) -> Self;
    /// Returns the largest integer not above `self`, as an index up to 2³² - 1.
    ///
    /// Returns 0 for any value that is not above 0, including NaN.
    #[must_use]
    fn floor_index(self) -> usize;
    /// Returns the number without its fraction, or the nearest integer of this type. 0 for NaN.
    #[doc(hidden)]
    #[must_use]
    fn whole(self) -> i64;
    /// Returns the nearest number of this type. No integer is beyond the largest one.
    #[doc(hidden)]
    #[must_use]
    fn from_whole(value: i128) -> Self;
    /// Last 32 bits of the number as it is stored.
    #[doc(hidden)]
    #[must_use]
    fn low_bits(self) -> u32;
    /// Returns true if both numbers are stored as the same bits. 0 and -0 differ.
    #[doc(hidden)]
    #[must_use]
    fn has_bits_of(self, other: Self) -> bool;
    /// Largest power of two that is not above the absolute value, at least the smallest normal
    /// number. Infinity for numbers that are not finite.
    #[doc(hidden)]
    #[must_use]
    fn power_of_two(self) -> Self;

    /// Returns the number without the lower half of its digits: 26 binary digits in f64, 12 in f32.
    #[doc(hidden)]
    #[must_use]
    fn upper_half(self) -> Self;

    /// Returns the larger of the two numbers, or `other` if they are equal or if either is NaN. A
    /// NaN in `self` is dropped, and a NaN in `other` is returned.
    #[inline]
    #[must_use]
    fn at_least(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    /// Returns the smaller of the two numbers, or `other` if they are equal or if either is NaN. A
    /// NaN in `self` is dropped, and a NaN in `other` is returned.
    #[inline]
    #[must_use]
    fn at_most(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
}

/// Vector of three numbers along x, y and z: glam's `Vec3` or `DVec3`.
pub trait Vector<R: Real>:
    Sealed
    + Copy
    + PartialEq
    + Default
    + Debug
    + Display
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Neg<Output = Self>
    + Mul<R, Output = Self>
    + AddAssign
    + SubAssign
{
    /// The vector (0, 0, 0).
    const ZERO: Self;
    /// Creates the vector (x, y, z).
    #[must_use]
    fn new(x: R, y: R, z: R) -> Self;
    /// First component.
    #[must_use]
    fn x(self) -> R;
    /// Second component.
    #[must_use]
    fn y(self) -> R;
    /// Third component.
    #[must_use]
    fn z(self) -> R;

    /// Scalar product, summed from x to z.
    #[inline]
    #[must_use]
    fn dot(self, other: Self) -> R {
        self.x() * other.x() + self.y() * other.y() + self.z() * other.z()
    }
    /// Vector product, right-handed.
    #[inline]
    #[must_use]
    fn cross(self, other: Self) -> Self {
        Self::new(
            self.y() * other.z() - self.z() * other.y(),
            self.z() * other.x() - self.x() * other.z(),
            self.x() * other.y() - self.y() * other.x(),
        )
    }
    /// Square of the length.
    #[inline]
    #[must_use]
    fn length_squared(self) -> R {
        self.dot(self)
    }
    /// Length.
    #[inline]
    #[must_use]
    fn length(self) -> R {
        self.dot(self).sqrt()
    }
    /// Returns true if each component is finite.
    #[inline]
    #[must_use]
    fn is_finite(self) -> bool {
        self.x().is_finite() && self.y().is_finite() && self.z().is_finite()
    }
}

/// Quaternion of four numbers x, y, z, w: glam's `Quat` or `DQuat`.
///
/// It is only stored and never multiplied, because glam's product is not bitwise reproducible.
/// [`Real`] names the types of one precision.
pub trait Quaternion<R: Real>:
    Sealed + Copy + PartialEq + Default + Debug + Display + Send + Sync + 'static
{
    /// Creates the quaternion w + x i + y j + z k.
    #[must_use]
    fn new(x: R, y: R, z: R, w: R) -> Self;
    /// Returns the components x, y, z, w.
    #[must_use]
    fn xyzw(self) -> [R; 4];
}

/// Matrix of nine numbers in three columns: glam's `Mat3` or `DMat3`.
pub trait Matrix<R: Real>:
    Sealed + Copy + PartialEq + Default + Debug + Display + Send + Sync + 'static
{
    /// Creates the matrix with these columns.
    #[must_use]
    fn from_columns(columns: [R::Vec3; 3]) -> Self;
    /// Returns the three columns.
    #[must_use]
    fn columns(self) -> [R::Vec3; 3];

    /// Creates the matrix with this diagonal and 0 elsewhere.
    #[inline]
    #[must_use]
    fn from_diagonal(diagonal: R::Vec3) -> Self {
        let o = R::ZERO;
        Self::from_columns([
            R::Vec3::new(diagonal.x(), o, o),
            R::Vec3::new(o, diagonal.y(), o),
            R::Vec3::new(o, o, diagonal.z()),
        ])
    }
}

/// Square root. IEEE 754 rounds it correctly, so the results of the processor and of libm have the
/// same bits.
macro_rules! square_root {
    ($value:expr, $libm:path) => {{
        #[cfg(feature = "std")]
        let root = $value.sqrt();
        #[cfg(not(feature = "std"))]
        let root = $libm($value);
        root
    }};
}

macro_rules! implement_real {
    (
        $real:ident, $vec:ident, $quat:ident, $mat:ident, $lower:literal,
        $sqrt:path, $sincos:path, $atan2:path, $pow:path
    ) => {
        impl Sealed for $real {}
        impl Real for $real {
            type Vec3 = glam::$vec;
            type Quat = glam::$quat;
            type Mat3 = glam::$mat;

            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const HALF: Self = 0.5;
            const TWO: Self = 2.0;
            const EPSILON: Self = $real::EPSILON;
            const MAX: Self = $real::MAX;

            #[inline]
            #[allow(
                clippy::cast_possible_truncation,
                reason = "rounding to f32 is the purpose"
            )]
            fn from_f64(value: f64) -> Self {
                value as $real
            }
            #[inline]
            fn from_usize(value: usize) -> Self {
                value as $real
            }
            #[inline]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline]
            fn sqrt(self) -> Self {
                square_root!(self, $sqrt)
            }
            #[inline]
            fn abs(self) -> Self {
                $real::abs(self)
            }
            #[inline]
            fn is_finite(self) -> bool {
                $real::is_finite(self)
            }
            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                $sincos(self)
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                $atan2(self, x)
            }
            #[inline]
            fn powf(self, exponent: Self) -> Self {
                $pow(self, exponent)
            }
            #[inline]
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "`as` saturates and converts NaN to 0"
            )]
            fn floor_index(self) -> usize {
                self as u32 as usize
            }
            #[inline]
            #[allow(
                clippy::cast_possible_truncation,
                reason = "`as` saturates and converts NaN to 0"
            )]
            fn whole(self) -> i64 {
                self as i64
            }
            #[inline]
            fn from_whole(value: i128) -> Self {
                value as $real
            }
            #[inline]
            #[allow(
                clippy::cast_possible_truncation,
                clippy::unnecessary_cast,
                reason = "only the last bits are needed"
            )]
            fn low_bits(self) -> u32 {
                self.to_bits() as u32
            }
            #[inline]
            fn has_bits_of(self, other: Self) -> bool {
                self.to_bits() == other.to_bits()
            }
            #[inline]
            fn power_of_two(self) -> Self {
                let exponent = $real::INFINITY.to_bits();
                $real::from_bits(self.to_bits() & exponent).max($real::MIN_POSITIVE)
            }
            #[inline]
            fn upper_half(self) -> Self {
                $real::from_bits(self.to_bits() & !((1 << $lower) - 1))
            }
        }

        impl Sealed for glam::$vec {}
        impl Vector<$real> for glam::$vec {
            const ZERO: Self = glam::$vec::ZERO;
            #[inline]
            fn new(x: $real, y: $real, z: $real) -> Self {
                glam::$vec::new(x, y, z)
            }
            #[inline]
            fn x(self) -> $real {
                self.x
            }
            #[inline]
            fn y(self) -> $real {
                self.y
            }
            #[inline]
            fn z(self) -> $real {
                self.z
            }
        }

        impl Sealed for glam::$quat {}
        impl Quaternion<$real> for glam::$quat {
            #[inline]
            fn new(x: $real, y: $real, z: $real, w: $real) -> Self {
                glam::$quat::from_xyzw(x, y, z, w)
            }
            #[inline]
            fn xyzw(self) -> [$real; 4] {
                [self.x, self.y, self.z, self.w]
            }
        }

        impl Sealed for glam::$mat {}
        impl Matrix<$real> for glam::$mat {
            #[inline]
            fn from_columns([x, y, z]: [glam::$vec; 3]) -> Self {
                glam::$mat::from_cols(x, y, z)
            }
            #[inline]
            fn columns(self) -> [glam::$vec; 3] {
                [self.x_axis, self.y_axis, self.z_axis]
            }
        }
    };
}

implement_real!(
    f32,
    Vec3,
    Quat,
    Mat3,
    12,
    libm::sqrtf,
    sine::sin_cos,
    libm::atan2f,
    libm::powf
);
implement_real!(
    f64,
    DVec3,
    DQuat,
    DMat3,
    27,
    libm::sqrt,
    libm::sincos,
    libm::atan2,
    libm::pow
);

/// Returns true for single precision.
#[inline(always)]
pub(crate) fn is_single<R: Real>() -> bool {
    R::EPSILON > R::from_f64(1e-10)
}

/// Vector whose largest component is between 1 and 2, or NaN for 0. Its direction has the same bits
/// as that of the vector, because the factor is a power of two.
pub(crate) fn scaled<R: Real>(v: R::Vec3) -> R::Vec3 {
    let largest = (v.x().abs()).at_least(v.y().abs()).at_least(v.z().abs());
    if largest <= R::ZERO {
        return v * (R::ONE / R::ZERO);
    }
    // Below its smallest value a power of two is not the largest one in a number.
    let unit = largest.power_of_two();
    R::Vec3::new(v.x() / unit, v.y() / unit, v.z() / unit)
}

/// Unit vector along a vector of any length above 0, also where the square of that length overflows
/// or underflows. It is not finite for 0.
pub(crate) fn unit<R: Real>(v: R::Vec3) -> R::Vec3 {
    let v = scaled::<R>(v);
    v * (R::ONE / v.length())
}
