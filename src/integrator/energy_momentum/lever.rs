//! The torque that the normal force of a smooth body needs beside that of its mean arm.

use crate::real::{Real, Vector, is_single};

/// Torque that a smooth body's normal force needs in addition to that of the mean arm, divided by
/// the force, m.
///
/// With the step's rotation `2a`, the force does the work of the springs if
/// `normal · (2a × arm) = normal · swung`, where `swung` is the change of the arm. The mean of the
/// arms at start and end satisfies this, except for terms of third order in the rotation. The
/// reason is that at the contact point the surface moves like the material of the body. The missing
/// work is done by a torque along the part of the rotation across the normal, if that part is not
/// too small to divide by.
///
/// In single precision, a torque whose size is within its rounding is left out, but its rounding is
/// stored, because a neighbouring trial may include the torque. A torque well above rounding is
/// used up to the length of the mean arm. On a flat or long body the point moves by much more than
/// the rotation.
///
/// Friction acts at the mean arm, where its slip is measured. A correction of the arm in place of
/// the torque would add the rounding of the division to the slip. Stick multiplies that rounding by
/// `μ N/ε`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lever<R: Real> {
    pub(super) torque: R::Vec3,
    /// Part of the torque that is rounding of the points of the surface.
    pub(super) rounding: R::Vec3,
}

impl<R: Real> Lever<R> {
    pub(super) const NONE: Self = Self {
        torque: R::Vec3::ZERO,
        rounding: R::Vec3::ZERO,
    };

    /// Adds the lever of another contact, as the mean of both with the normal forces as weights.
    ///
    /// `known` is the normal force of the contacts before, N, and `normal_force` that of the next.
    #[inline]
    pub(super) fn with(self, other: Self, known: &mut R, normal_force: R) -> Self {
        let sum = *known + normal_force;
        if *known == R::ZERO {
            *known = sum;
            return other;
        }
        let share = normal_force / sum;
        *known = sum;
        Self {
            torque: self.torque + (other.torque - self.torque) * share,
            rounding: self.rounding + (other.rounding - self.rounding) * share,
        }
    }

    #[inline]
    pub(super) fn new(mean: R::Vec3, normal: R::Vec3, swung: R::Vec3, cayley: R::Vec3) -> Self {
        let across = (cayley - normal * normal.dot(cayley)) * R::TWO;
        let square = across.length_squared();
        let residual = normal.dot(swung) - normal.cross(cayley).dot(mean) * R::TWO;
        let most = mean.length() * (square * cayley.length_squared()).sqrt();
        let rounding = mean.length() * (R::EPSILON * R::from_f64(4.0));
        let is_large = is_single::<R>()
            && residual.abs() > rounding * R::from_f64(64.0)
            && residual * residual <= square * mean.length_squared();
        let is_known = residual.abs() > rounding && (residual.abs() <= most || is_large);
        let may_be_known = is_single::<R>() && rounding <= most && residual.abs() <= rounding;
        if !(square > R::ZERO && (is_known || may_be_known)) {
            return Self::NONE;
        }
        let per_residual = across * (R::ONE / square);
        Self {
            torque: if is_known {
                per_residual * residual
            } else {
                R::Vec3::ZERO
            },
            rounding: per_residual * rounding,
        }
    }
}
