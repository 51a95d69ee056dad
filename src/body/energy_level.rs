//! Torque-free rotation with three different moments that conserves energy.
//!
//! In principal axes the angular momentum `p` moves on a sphere, along the curve of constant
//! energy. A composition of rotations stays on the sphere to rounding. It leaves the curve by its
//! error of third order. To return to the curve, the squares of the two components other than `p_k`
//! are scaled by `M/M'`, with
//!
//! ```text
//! M = Σ p_i² |1/I_i - 1/I_k|        i != k
//! ```
//!
//! and `p_k²` becomes the remainder of `|p|²`. If the energy is below that of the middle axis, `k`
//! is the axis of the largest moment, otherwise that of the smallest. The scaled squares then never
//! exceed `|p|²`, and `M` has no cancellation, however steady the rotation is. The formula is a
//! closed form for any step size.

use super::inertia_properties::InertiaProperties;
use crate::real::{Real, Vector};
use crate::rotation::{Axes, Rotation};

/// Curve of constant energy through an angular momentum.
#[derive(Clone, Copy, Debug)]
struct EnergyLevel<R> {
    /// Number of the principal axis that the curve encloses.
    pole: usize,
    /// Angular momentum at the start, principal axes.
    start: [R; 3],
}

impl<R: Real> InertiaProperties<R> {
    /// Returns the orientation after `seconds` without torque, from `rotation` with these `axes`,
    /// for three different moments.
    ///
    /// The rotational energy equals that of the start to rounding, for any time. The method is of
    /// order 2. The angular momentum in world axes is constant.
    #[inline(never)]
    pub(crate) fn rotated_at_constant_energy(
        &self,
        rotation: Rotation<R>,
        axes: &Axes<R>,
        angular_momentum: R::Vec3,
        seconds: R,
    ) -> Rotation<R> {
        let level = self.level_of(self.in_principal_axes(axes, angular_momentum));
        let rotated = self.turn_freely(rotation, axes, angular_momentum, seconds);
        let [x, y, z] = self.in_principal_axes(&rotated.axes(), angular_momentum);
        let [shift_x, shift_y, shift_z] = self.shift_onto(level, [x, y, z]);
        let here = R::Vec3::new(x, y, z);
        let shift = R::Vec3::new(shift_x, shift_y, shift_z);
        // Rotation from the corrected direction p + d to the current direction p, by the half
        // angle's tangent: (d × p)/(p·p + p·(p + d)).
        let scale = here.length_squared() * R::TWO + here.dot(shift);
        let is_less_than_a_turn = scale > R::ZERO;
        if !is_less_than_a_turn {
            return rotated;
        }
        let argument = self
            .principal_axes()
            .to_world(shift.cross(here) * (R::ONE / scale));
        (rotated.after(Rotation::cayley_unscaled(argument))).normalised()
    }

    fn in_principal_axes(&self, axes: &Axes<R>, angular_momentum: R::Vec3) -> [R; 3] {
        let momentum = self
            .principal_axes()
            .to_body(axes.to_body(angular_momentum));
        [momentum.x(), momentum.y(), momentum.z()]
    }

    fn inverse_moments(&self) -> [R; 3] {
        let moments = self.moments();
        [moments.x(), moments.y(), moments.z()].map(|moment| R::ONE / moment)
    }

    /// Returns the curve through this angular momentum, principal axes.
    fn level_of(&self, momentum: [R; 3]) -> EnergyLevel<R> {
        let [x, y, z] = self.inverse_moments();
        let largest = x.at_least(y).at_least(z);
        let smallest = x.at_most(y).at_most(z);
        let middle = (x + y + z) - largest - smallest;
        let [mut square, mut doubled_energy] = [R::ZERO; 2];
        for (part, inverse) in momentum.into_iter().zip([x, y, z]) {
            square += part * part;
            doubled_energy += part * part * inverse;
        }
        let inverse = if doubled_energy <= square * middle {
            smallest
        } else {
            largest
        };
        let pole = [x, y, z]
            .iter()
            .position(|&other| other == inverse)
            .unwrap_or(0);
        EnergyLevel {
            pole,
            start: momentum,
        }
    }

    /// Energy deficit: twice the energy at the start minus twice that at `here`.
    ///
    /// It is computed relative to the axis with the largest component of the momentum. There the
    /// squares that count are small, and so is their rounding. Near the middle axis, rounding of
    /// the whole energy would cause a thousand times the angle error.
    fn lost(&self, level: EnergyLevel<R>, here: [R; 3]) -> R {
        let inverse = self.inverse_moments();
        let (mut about, mut longest) = (R::ZERO, -R::ONE);
        for (part, inverse) in here.into_iter().zip(inverse) {
            if part.abs() > longest {
                (about, longest) = (inverse, part.abs());
            }
        }
        let mut lost = R::ZERO;
        for ((then, now), inverse) in level.start.into_iter().zip(here).zip(inverse) {
            lost += (then - now) * (then + now) * (inverse - about);
        }
        lost
    }

    /// `M` about a pole, and the sum of the squares of the other two components.
    fn distance(&self, pole: usize, momentum: [R; 3]) -> (R, R) {
        let inverse = self.inverse_moments();
        let at_pole = inverse.get(pole).copied().unwrap_or(R::ZERO);
        let [mut distance, mut beside] = [R::ZERO; 2];
        for (number, (part, inverse)) in momentum.into_iter().zip(inverse).enumerate() {
            if number != pole {
                distance += part * part * (inverse - at_pole).abs();
                beside += part * part;
            }
        }
        (distance, beside)
    }

    /// Change that brings an angular momentum onto the curve, principal axes.
    fn shift_onto(&self, level: EnergyLevel<R>, momentum: [R; 3]) -> [R; 3] {
        let (distance, beside) = self.distance(level.pole, momentum);
        let is_off_the_pole = distance > R::ZERO;
        if !is_off_the_pole {
            return [R::ZERO; 3];
        }
        // σ² - 1 and σ - 1 are small where the error is small, so nothing cancels.
        let inverse = self.inverse_moments();
        let [x, y, z] = inverse;
        let is_lowest = inverse.get(level.pole) == Some(&x.at_most(y).at_most(z));
        let lost = self.lost(level, momentum);
        let excess = (if is_lowest { lost } else { -lost } / distance).at_least(-R::ONE);
        let factor = excess / ((R::ONE + excess).sqrt() + R::ONE);
        let mut shift = momentum.map(|part| part * factor);
        if let (Some(shift), Some(&part)) = (shift.get_mut(level.pole), momentum.get(level.pole)) {
            let square = (part * part - excess * beside).at_least(R::ZERO);
            let sign = if part < R::ZERO { -R::ONE } else { R::ONE };
            let sum = part.abs() + square.sqrt();
            *shift = if sum > R::ZERO {
                -(sign * excess * beside) / sum
            } else {
                R::ZERO
            };
        }
        shift
    }
}
