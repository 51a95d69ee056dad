//! Phase error of the method in a uniform rotation, which a step can leave out.
//!
//! The quaternion of a body that rotates uniformly at `ω` oscillates: `q'' = -(ω²/4) q`. With
//! `z = |ω| h/2`, a step gives `q(h) = (C + S ω/|ω|) q`, where the coefficients of the method
//! determine
//!
//! ```text
//! C = 1 - z²/2 + z⁴/24 - 11 z⁶/11520     S = z - z³/6 + 11 z⁵/1440
//! ```
//! The half angle `atan(S/C)` is too small by `z⁵/1440 - z⁷/8960`, up to terms of `z⁹`. For two
//! equal moments the error of a body that rolls or spins about a principal axis is of this kind.

use super::stages::Stage;
use crate::real::{Real, Vector};
use crate::rotation::Rotation;

/// Returns the orientation at the `end` of a step without the phase error of a uniform rotation at
/// the mean angular velocity of its first and last stage.
#[inline(always)]
pub(super) fn without_phase_error<R: Real>(
    [first, .., last]: [&Stage<R>; 4],
    end: Rotation<R>,
    seconds: R,
) -> Rotation<R> {
    let spin = (first.motion.angular_velocity + last.motion.angular_velocity) * R::HALF;
    let square = spin.length_squared() * (seconds * seconds * R::from_f64(0.25));
    let relative = R::from_f64(1.0 / 1440.0) - square * R::from_f64(1.0 / 8960.0);
    end.plus(end.rate(spin), square * square * relative * seconds)
}
