//! Torque-free rotation within a step: a series for short steps, the closed form for long ones.
//!
//! The power series of `series` costs more with the angle, and the closed form costs the same for
//! any angle. In instructions, the closed form is cheaper from `x = 2 λ t` of about 1/2 in f64 and
//! of about 1.2 in f32, whose series has fewer terms.
//!
//! Nearly equal moments, and a rotation next to a principal axis, have a small `λ`. The angle about
//! the angular momentum is `2T t/|L|`, and may be large in a step with a small `x`. The series
//! rounds it two or three times, so its error is about `EPSILON` times the angle. That of the
//! closed form is about ten times `EPSILON`.

use super::series::{Series, direction_and_length};
use super::turned_far;
use crate::inertia::InertiaProperties;
use crate::real::{Real, Vector, is_single};
use crate::rotation::{Axes, Rotation};

/// Largest `x` of a step by the series, in f64 and f32.
///
/// Chosen from the instructions of three bodies, and tested on three others.
const LONGEST: [f64; 2] = [0.5, 1.2];
/// Largest angle about the angular momentum in a step by the series, rad.
const WIDEST: f64 = 10.0;

impl<R: Real> InertiaProperties<R> {
    /// Orientation after `seconds` of torque-free rotation from `rotation` with these `axes`.
    ///
    /// The angular momentum in world axes is constant and is not changed.
    ///
    /// The result is exact for a body with two equal moments, for any time and spin:
    /// `exp(t L/I₁) q exp(t (L·a)(1/I₃ - 1/I₁) a)`. For three different moments it is exact to
    /// rounding too: a power series in a short time, and [`FreeRotation`](crate::FreeRotation) in a
    /// longer one. So the cost does not increase with the angle. The limit is that of
    /// [`FreeRotation`](crate::FreeRotation), `0.01/EPSILON` revolutions. In a longer time the
    /// angles lose digits.
    #[inline(always)]
    #[must_use]
    pub fn turn_freely(
        &self,
        rotation: Rotation<R>,
        axes: &Axes<R>,
        angular_momentum: R::Vec3,
        seconds: R,
    ) -> Rotation<R> {
        if self.is_asymmetric() {
            self.turn_asymmetric(rotation, axes, angular_momentum, seconds)
        } else {
            self.turn_symmetric(rotation, axes, angular_momentum, seconds)
                .normalised()
        }
    }

    /// Returns the orientation after `seconds` without torque, for three different moments.
    #[inline(never)]
    fn turn_asymmetric(
        &self,
        rotation: Rotation<R>,
        axes: &Axes<R>,
        angular_momentum: R::Vec3,
        seconds: R,
    ) -> Rotation<R> {
        let (direction, length) = direction_and_length::<R>(angular_momentum);
        let frame = self.unequal_axes(axes);
        let series = Series::new(self, length * seconds);
        let start = frame.map(|axis| axis.dot(direction));
        let extent = series.extent(start);
        if extent > longest() || series.angle(start).abs() > R::from_f64(WIDEST) {
            return turned_far(self, rotation, angular_momentum, seconds);
        }
        let turn = series.increment(frame, direction, extent);
        turn.after(rotation).normalised()
    }
}

#[inline]
fn longest<R: Real>() -> R {
    let [of_f64, of_f32] = LONGEST;
    R::from_f64(if is_single::<R>() { of_f32 } else { of_f64 })
}
