//! Rotation of bodies: the unit quaternion as four plain numbers, and the body's axes in the world.
//!
//! glam's single-precision quaternion multiplies by SIMD, with last bits that depend on the
//! processor. So the core stores glam's type and computes with [`Rotation`].

use crate::real::{Quaternion, Real, Vector};

/// Rotation from body axes to world axes: the unit quaternion `w + v`, with `v = x i + y j + z k`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation<R: Real = f64> {
    w: R,
    v: R::Vec3,
}

impl<R: Real> Rotation<R> {
    /// Identity rotation.
    pub const IDENTITY: Self = Self {
        w: R::ONE,
        v: R::Vec3::ZERO,
    };

    /// Creates a rotation from glam's quaternion, scaled to length 1.
    ///
    /// The result is not finite if the square of the quaternion's length is 0, infinite or NaN.
    #[inline]
    #[must_use]
    pub fn from_quat(quaternion: R::Quat) -> Self {
        Self::unscaled(quaternion).normalised()
    }

    /// Creates a rotation from the four numbers of glam's quaternion, without scaling.
    #[inline]
    pub(crate) fn unscaled(quaternion: R::Quat) -> Self {
        let [x, y, z, w] = quaternion.xyzw();
        Self {
            w,
            v: R::Vec3::new(x, y, z),
        }
    }

    /// Returns glam's quaternion for this rotation.
    #[inline]
    #[must_use]
    pub fn to_quat(self) -> R::Quat {
        R::Quat::new(self.v.x(), self.v.y(), self.v.z(), self.w)
    }

    /// Creates the right-handed rotation by `|vector|` radians about `vector`:
    /// `cos(|h|) + h sin(|h|)/|h|` with `h = vector/2`.
    #[inline]
    #[must_use]
    pub fn from_rotation_vector(vector: R::Vec3) -> Self {
        let half = vector * R::HALF;
        let square = half.length_squared();
        if square.is_finite() {
            Self::of_half_vector(half, cos_and_sinc(square))
        } else {
            Self::of_huge_vector(half)
        }
    }

    /// Creates the rotation about a vector whose squared length overflows.
    #[cold]
    fn of_huge_vector(half: R::Vec3) -> Self {
        let largest = (half.x().abs().at_least(half.y().abs())).at_least(half.z().abs());
        let unit = largest.power_of_two();
        let scaled = half * (R::ONE / unit);
        let length = scaled.length();
        let (sin, cos) = (length * unit).sin_cos();
        Self {
            w: cos,
            v: scaled * (sin / length),
        }
    }

    /// Creates the right-handed rotation by `2 |half|` radians about `half`.
    #[inline]
    pub(crate) fn from_half_vector(half: R::Vec3) -> Self {
        Self::of_half_vector(half, cos_and_sinc(half.length_squared()))
    }

    /// Creates the rotation about `half`, given [`cos_and_sinc`] of its squared length.
    #[inline(always)]
    pub(crate) fn of_half_vector(half: R::Vec3, (cos, sinc): (R, R)) -> Self {
        Self {
            w: cos,
            v: half * sinc,
        }
    }

    /// Creates a rotation from the scalar and the vector part of its quaternion, without scaling.
    #[inline(always)]
    pub(crate) fn of_parts(w: R, v: R::Vec3) -> Self {
        Self { w, v }
    }

    /// Returns the scalar and the vector part of the quaternion.
    #[inline(always)]
    pub(crate) fn parts(self) -> (R, R::Vec3) {
        (self.w, self.v)
    }

    /// Creates the rotation by `2 atan(|a|)` about `a`, without sine or cosine.
    ///
    /// It is the Cayley map `(1 - A)⁻¹ (1 + A)`, where `A` is the matrix of the cross product with
    /// `a`: `A r = a × r` for every vector r. The result is invalid, with the length 0, if the
    /// square of `|a|` overflows.
    #[inline]
    #[must_use]
    pub fn cayley(a: R::Vec3) -> Self {
        let scale = R::ONE / (R::ONE + a.length_squared()).sqrt();
        Self {
            w: scale,
            v: a * scale,
        }
    }

    /// Cayley map of `a`, not scaled to length 1: `1 + a`.
    #[inline]
    pub(crate) fn cayley_unscaled(a: R::Vec3) -> Self {
        Self { w: R::ONE, v: a }
    }

    /// Quaternion product `self other`: the rotation by `other`, followed by that of `self` (both
    /// about world axes).
    #[inline]
    #[must_use]
    pub fn after(self, other: Self) -> Self {
        Self {
            w: self.w * other.w - self.v.dot(other.v),
            v: other.v * self.w + self.v * other.w + self.v.cross(other.v),
        }
    }

    /// Rotates the body further by `2 half` radians about its own `axis`:
    /// `q (cos + a sin) = q cos + q a sin`.
    #[inline(always)]
    pub(crate) fn spun(self, axis: BodyAxis<R>, half: R) -> Self {
        // The product is computed last, so that it need not be kept meanwhile.
        let of_half = cos_and_sinc(half * half);
        self.spun_with(self.times(axis), half, of_half)
    }

    /// Returns [`spun`](Self::spun), given the [product](Self::times) with the axis and
    /// [`cos_and_sinc`] of `half²`.
    #[inline(always)]
    pub(crate) fn spun_with(self, product: Self, half: R, (cos, sinc): (R, R)) -> Self {
        self.scaled(cos).plus(product, half * sinc)
    }

    /// Quaternion product with an axis: with i, j or k for an axis of the body.
    #[inline]
    pub(crate) fn times(self, axis: BodyAxis<R>) -> Self {
        let (w, x, y, z) = (self.w, self.v.x(), self.v.y(), self.v.z());
        let (w, v) = match axis {
            BodyAxis::X => (-x, R::Vec3::new(w, z, -y)),
            BodyAxis::Y => (-y, R::Vec3::new(-z, w, x)),
            BodyAxis::Z => (-z, R::Vec3::new(y, -x, w)),
            BodyAxis::Other(a) => (-self.v.dot(a), a * w + self.v.cross(a)),
        };
        Self { w, v }
    }

    /// Inverse rotation.
    #[inline]
    #[must_use]
    pub fn inverse(self) -> Self {
        Self {
            w: self.w,
            v: -self.v,
        }
    }

    /// Returns `self + delta factor`, component by component: the sum of a Runge-Kutta stage.
    #[inline]
    pub(crate) fn plus(self, delta: Self, factor: R) -> Self {
        Self {
            w: self.w + delta.w * factor,
            v: self.v + delta.v * factor,
        }
    }

    /// Returns about the part `share` of a small rotation, not scaled to length 1.
    #[inline]
    pub(crate) fn part(self, share: R) -> Self {
        let share_of_vector = if self.w < R::ZERO { -share } else { share };
        Self {
            w: (R::ONE - share) + self.w.abs() * share,
            v: self.v * share_of_vector,
        }
    }

    /// Time derivative of the quaternion of a body with this `angular_velocity` (rad/s, world
    /// axes): `(0, ω) q / 2`.
    #[inline]
    pub(crate) fn rate(self, angular_velocity: R::Vec3) -> Self {
        let half = angular_velocity * R::HALF;
        Self {
            w: -half.dot(self.v),
            v: half * self.w + half.cross(self.v),
        }
    }

    /// `|sin(φ/2)|` of the rotation by φ.
    #[inline]
    pub(crate) fn sine_of_half(self) -> R {
        self.v.length()
    }

    /// Square of the quaternion's length, 1 to rounding.
    #[inline]
    #[must_use]
    pub fn length_squared(self) -> R {
        self.w * self.w + self.v.length_squared()
    }

    /// Returns true if the square of the length is 1 within one half. It is false for a quaternion
    /// whose square is 0 or infinite, which cannot be scaled.
    #[inline]
    pub(crate) fn is_a_turn(self) -> bool {
        (self.length_squared() - R::ONE).abs() < R::HALF
    }

    /// Returns the same rotation scaled to length 1, to one unit in the last place.
    ///
    /// A rotation that has this length already is returned unchanged.
    #[inline]
    #[must_use]
    pub fn normalised(self) -> Self {
        let excess = self.length_squared() - R::ONE;
        // A factor that differs from 1 in the last place changes one component by as much and
        // another not at all. This would tilt the rotation in the same direction in every step.
        let scale = if excess.abs() < R::EPSILON * R::TWO {
            R::ONE
        } else if excess * excess < R::EPSILON * R::HALF {
            // After a step the length is 1 to rounding. Then one term of 1/sqrt(1 + e) = 1 - e/2 +
            // 3e²/8 is exact to the last place.
            R::ONE - excess * R::HALF
        } else {
            // An overflowed length gives NaN, which is detected, instead of a rotation of length 0.
            let overflow = excess * R::ZERO;
            let square = self.length_squared();
            let scale = (R::ONE + overflow) / square.sqrt();
            // A subnormal square has lost digits. The length that it gives is then near 1, and its
            // square has all of them.
            let is_subnormal = square * R::EPSILON <= R::ZERO;
            if is_subnormal {
                let near = self.scaled(scale);
                return near.scaled(R::ONE / near.length_squared().sqrt());
            }
            scale
        };
        self.scaled(scale)
    }

    /// Returns true if the length is so near to 1 that [`normalised`](Self::normalised) takes no
    /// root.
    #[inline(always)]
    pub(crate) fn is_almost_unit(self) -> bool {
        let excess = self.length_squared() - R::ONE;
        excess * excess < R::EPSILON * R::HALF
    }

    /// Returns [`normalised`](Self::normalised) of a quaternion that
    /// [is almost of length 1](Self::is_almost_unit), without a branch.
    #[inline(always)]
    pub(crate) fn normalised_almost_unit(self) -> Self {
        let excess = self.length_squared() - R::ONE;
        let scale = R::ONE - excess * R::HALF;
        let is_unit = excess.abs() < R::EPSILON * R::TWO;
        self.scaled(if is_unit { R::ONE } else { scale })
    }

    /// Returns the quaternion with each number multiplied by a factor.
    #[inline]
    pub(crate) fn scaled(self, factor: R) -> Self {
        Self {
            w: self.w * factor,
            v: self.v * factor,
        }
    }

    /// Body axes in the world: the columns of the rotation matrix.
    #[inline]
    #[must_use]
    pub fn axes(self) -> Axes<R> {
        self.axes_scaled(R::TWO)
    }

    /// Body axes in the world, for a quaternion of any length above 0.
    #[inline]
    pub(crate) fn axes_of_any_length(self) -> Axes<R> {
        self.axes_scaled(R::TWO / self.length_squared())
    }

    /// Body axes with the factor `two` applied last, so that the products need not wait for a
    /// division.
    #[inline]
    fn axes_scaled(self, two: R) -> Axes<R> {
        let (w, x, y, z) = (self.w, self.v.x(), self.v.y(), self.v.z());
        let (xx, yy, zz) = (x * x, y * y, z * z);
        let (wx, wy, wz) = (w * x, w * y, w * z);
        let (xy, xz, yz) = (x * y, x * z, y * z);
        let along = |sum: R| R::ONE - sum * two;
        let across = |sum: R| sum * two;
        Axes {
            x: R::Vec3::new(along(yy + zz), across(xy + wz), across(xz - wy)),
            y: R::Vec3::new(across(xy - wz), along(xx + zz), across(yz + wx)),
            z: R::Vec3::new(across(xz + wy), across(yz - wx), along(xx + yy)),
        }
    }

    /// Converts a body vector to world axes.
    #[inline]
    #[must_use]
    pub fn apply(self, body: R::Vec3) -> R::Vec3 {
        self.axes().to_world(body)
    }
}

/// Computes `cos h` and `sin(h)/h` from `h²`.
///
/// It uses the shortest of three Taylor series that is exact to the last place of f64 (next term
/// below 1e-17), otherwise the `libm` crate. A step seldom rotates a body by more than a radian.
/// The series need neither square root nor division.
#[inline]
pub(crate) fn cos_and_sinc<R: Real>(square: R) -> (R, R) {
    if Series::Short.suffices(square) {
        Series::short(square)
    } else if Series::Middle.suffices(square) {
        Series::middle(square)
    } else if Series::Long.suffices(square) {
        long_series(square)
    } else {
        let half = square.sqrt();
        let (sin, cos) = half.sin_cos();
        (cos, sin / half)
    }
}

/// Computes the longest series. As a function of its own it leaves the registers of most steps, in
/// which a body rotates less, to their other numbers.
#[inline(never)]
fn long_series<R: Real>(square: R) -> (R, R) {
    Series::long(square)
}

/// Taylor series of `cos h` and `sin(h)/h` in `s = h²`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Series {
    Short,
    Middle,
    Long,
}

impl Series {
    /// Returns true if the series is exact at this `h²`.
    #[inline(always)]
    pub(crate) fn suffices<R: Real>(self, square: R) -> bool {
        square
            < match self {
                Self::Short => R::from_f64(1.0 / 65536.0),
                Self::Middle => R::from_f64(1.0 / 1024.0),
                Self::Long => R::from_f64(0.25),
            }
    }

    /// Computes the shortest series.
    #[inline(always)]
    pub(crate) fn short<R: Real>(s: R) -> (R, R) {
        let c = R::from_f64;
        let cos = (c(1.0 / 24.0) * s - c(0.5)) * s;
        let sinc = (c(1.0 / 120.0) * s - c(1.0 / 6.0)) * s;
        (cos + R::ONE, sinc + R::ONE)
    }

    /// Computes the series of middle length.
    #[inline(always)]
    pub(crate) fn middle<R: Real>(s: R) -> (R, R) {
        let c = R::from_f64;
        let cos = (((c(1.0 / 40320.0) * s - c(1.0 / 720.0)) * s + c(1.0 / 24.0)) * s - c(0.5)) * s;
        let sinc = (((c(1.0 / 362880.0) * s - c(1.0 / 5040.0)) * s + c(1.0 / 120.0)) * s
            - c(1.0 / 6.0))
            * s;
        (cos + R::ONE, sinc + R::ONE)
    }

    /// Computes all series, and returns the shortest one that is exact, for `h` up to 1/2.
    #[inline(always)]
    pub(crate) fn chosen<R: Real>(s: R) -> (R, R) {
        let (short, middle, long) = (Self::short(s), Self::middle(s), Self::long(s));
        if Self::Short.suffices(s) {
            short
        } else if Self::Middle.suffices(s) {
            middle
        } else {
            long
        }
    }

    /// Computes the longest series, for `h` up to 1/2.
    #[inline(always)]
    pub(crate) fn long<R: Real>(s: R) -> (R, R) {
        let c = R::from_f64;
        // Written out, so that the compiler rounds each coefficient to R, and never the program.
        let cos = ((((((c(1.0 / 20922789888000.0) * s - c(1.0 / 87178291200.0)) * s
            + c(1.0 / 479001600.0))
            * s
            - c(1.0 / 3628800.0))
            * s
            + c(1.0 / 40320.0))
            * s
            - c(1.0 / 720.0))
            * s
            + c(1.0 / 24.0))
            * s
            - R::HALF;
        let sinc = ((((((c(1.0 / 355687428096000.0) * s - c(1.0 / 1307674368000.0)) * s
            + c(1.0 / 6227020800.0))
            * s
            - c(1.0 / 39916800.0))
            * s
            + c(1.0 / 362880.0))
            * s
            - c(1.0 / 5040.0))
            * s
            + c(1.0 / 120.0))
            * s
            - c(1.0 / 6.0);
        (R::ONE + s * cos, R::ONE + s * sinc)
    }
}

/// Body axes in the world, perpendicular unit vectors: the columns of the rotation matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes<R: Real = f64> {
    /// The body's x axis, world axes.
    pub x: R::Vec3,
    /// The body's y axis, world axes.
    pub y: R::Vec3,
    /// The body's z axis, world axes.
    pub z: R::Vec3,
}

impl<R: Real> Axes<R> {
    /// Converts a body vector to world axes.
    #[inline]
    #[must_use]
    pub fn to_world(&self, body: R::Vec3) -> R::Vec3 {
        self.x * body.x() + self.y * body.y() + self.z * body.z()
    }

    /// Converts two body vectors to world axes.
    #[inline]
    pub(crate) fn both_to_world(&self, [first, second]: [R::Vec3; 2]) -> [R::Vec3; 2] {
        [self.to_world(first), self.to_world(second)]
    }

    /// World z axis in body axes: the z component of each body axis.
    #[inline]
    pub(crate) fn rise(&self) -> R::Vec3 {
        R::Vec3::new(self.x.z(), self.y.z(), self.z.z())
    }

    /// Converts a world vector to body axes.
    #[inline]
    #[must_use]
    pub fn to_body(&self, world: R::Vec3) -> R::Vec3 {
        R::Vec3::new(self.x.dot(world), self.y.dot(world), self.z.dot(world))
    }
}

/// Direction fixed in the body.
///
/// Most bodies are given in axes along their principal ones, which need no arithmetic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum BodyAxis<R: Real> {
    X,
    Y,
    Z,
    /// Unit vector, body axes.
    Other(R::Vec3),
}

impl<R: Real> BodyAxis<R> {
    /// Creates the direction along a unit vector, body axes.
    pub(crate) fn along(vector: R::Vec3) -> Self {
        let (o, one) = (R::ZERO, R::ONE);
        if vector == R::Vec3::new(one, o, o) {
            Self::X
        } else if vector == R::Vec3::new(o, one, o) {
            Self::Y
        } else if vector == R::Vec3::new(o, o, one) {
            Self::Z
        } else {
            Self::Other(vector)
        }
    }

    /// Returns the unit vector in world axes.
    #[inline]
    pub(crate) fn in_world(self, axes: &Axes<R>) -> R::Vec3 {
        match self {
            Self::X => axes.x,
            Self::Y => axes.y,
            Self::Z => axes.z,
            Self::Other(vector) => axes.to_world(vector),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec3};

    #[test]
    fn every_branch_of_the_exponential_agrees_with_the_closed_form() {
        for k in 1..4000 {
            let angle = f64::from(k) * 1e-3;
            let axis = DVec3::new(1.0, -2.0, 0.5).normalize();
            let ours = Rotation::<f64>::from_rotation_vector(axis * angle).to_quat();
            let theirs = DQuat::from_axis_angle(axis, angle);
            // Two roundings of numbers below 1, plus that of the library.
            assert!(
                (ours - theirs).length() < 4.0 * f64::EPSILON,
                "angle {angle}: {ours} {theirs}"
            );
        }
    }

    #[test]
    fn a_rotation_vector_of_any_finite_length_is_a_rotation() {
        for exponent in [100, 153, 155, 200, 307] {
            let angle = 10.0_f64.powi(exponent);
            let ours = Rotation::<f64>::from_rotation_vector(DVec3::Y * -angle).to_quat();
            let (sin, cos) = (0.5 * angle).sin_cos();
            let theirs = DQuat::from_xyzw(0.0, -sin, 0.0, cos);
            assert!((ours - theirs).length() < 4.0 * f64::EPSILON, "{angle:e}");
            let slanted = DVec3::new(angle, -0.5 * angle, 0.25 * angle);
            let length = Rotation::<f64>::from_rotation_vector(slanted).length_squared();
            assert!((length - 1.0).abs() < 4.0 * f64::EPSILON, "{angle:e}");
        }
        let largest = glam::Vec3::splat(f32::MAX);
        let length = Rotation::<f32>::from_rotation_vector(largest).length_squared();
        assert!((length - 1.0).abs() < 4.0 * f32::EPSILON, "{length}");
    }

    #[test]
    fn a_tiny_quaternion_is_scaled_to_length_one() {
        // The squares of the first ones are normal numbers, of the others subnormal ones.
        for size in [1e-150, 1e-155, 1e-158, 1e-160, 3e-162] {
            let tiny = DQuat::from_xyzw(size, -size, 0.0, 2.0 * size);
            let excess = Rotation::<f64>::from_quat(tiny).length_squared() - 1.0;
            assert!(excess.abs() <= 4.0 * f64::EPSILON, "{size}: {excess}");
        }
        for size in [1e-18, 1e-20, 1e-22, 3e-23] {
            let tiny = glam::Quat::from_xyzw(size, -size, 0.0, 2.0 * size);
            let excess = Rotation::<f32>::from_quat(tiny).length_squared() - 1.0;
            assert!(excess.abs() <= 4.0 * f32::EPSILON, "{size}: {excess}");
        }
    }

    #[test]
    fn a_turn_and_its_inverse_cancel() {
        let turn = Rotation::<f64>::from_rotation_vector(DVec3::new(0.3, 1.0, -2.0));
        let back = turn.inverse().after(turn);
        assert!((back.to_quat() - DQuat::IDENTITY).length() < 4.0 * f64::EPSILON);
    }

    #[test]
    fn the_axes_agree_with_the_matrix_of_the_quaternion() {
        let quat = DQuat::from_xyzw(0.1, -0.7, 0.3, 0.5).normalize();
        let matrix = glam::DMat3::from_quat(quat);
        let axes = Rotation::<f64>::from_quat(quat).axes();
        for (ours, theirs) in [
            (axes.x, matrix.x_axis),
            (axes.y, matrix.y_axis),
            (axes.z, matrix.z_axis),
        ] {
            assert!((ours - theirs).length() < 4.0 * f64::EPSILON);
        }
        let vector = DVec3::new(1.0, 2.0, 3.0);
        assert!((axes.to_body(axes.to_world(vector)) - vector).length() < 1e-14);
    }

    #[test]
    fn the_cayley_map_turns_by_twice_the_arctangent() {
        let a = DVec3::new(0.0, 0.0, 0.75);
        let turn = Rotation::<f64>::cayley(a);
        let expected = DQuat::from_rotation_z(2.0 * 0.75_f64.atan());
        assert!((turn.to_quat() - expected).length() < 4.0 * f64::EPSILON);
    }
}
