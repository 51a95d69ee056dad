//! Friction of a contact that touches for a part of the step.
//!
//! The load of such a contact is 0 for the rest of the step. Its mean load over the step, N, is
//! that over the part φ in which it touches, N/φ, times φ. So the mean friction is
//!
//! ```text
//! φ F(N/φ)
//! ```
//!
//! with an error of order h², because the load N/φ changes little in the step. Taken at the mean
//! load, F(N) has an error of order 1 unless the law is proportional to the load, and the step that
//! contains a touch-down then one of order h. The part follows from the depths at both ends, as the
//! mean force does: the depth is linear in time over the step.
//!
//! A law that is proportional to the load has the same friction by both, to rounding. It keeps that
//! of the mean load. In single precision this is also the load at which friction of small slip is
//! made [linear](Problem::friction).

use super::problem::Problem;
use crate::friction::{FrictionJacobian, RollingResistance, SlidingFriction};
use crate::real::{Real, Vector};
use crate::scene::Dynamics;

/// Friction (N) of a mean load (N) over a step, of which a contact touches for a part.
#[cold]
#[inline(never)]
pub(super) fn friction<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    surface: u32,
    position: R::Vec3,
    [load, part]: [R; 2],
    slip: R::Vec3,
) -> R::Vec3 {
    let law = problem.law(surface);
    let force = |load| law.force_at(position, load, slip).length();
    if is_proportional(part, [load, load / part].map(force)) {
        problem.friction(surface, position, load, slip)
    } else {
        problem.friction(surface, position, load / part, slip) * part
    }
}

/// Derivatives of [`friction`], for a part that does not depend on the trial.
#[cold]
#[inline(never)]
pub(super) fn jacobian<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    surface: u32,
    position: R::Vec3,
    [load, part]: [R; 2],
    slip: R::Vec3,
) -> FrictionJacobian<R> {
    let law = problem.law(surface);
    let coefficient = |load| law.jacobian_at(position, load, slip).coefficient;
    if is_proportional(part, [load, load / part].map(coefficient)) {
        return problem.jacobian(surface, position, load, slip);
    }
    let of_part = problem.jacobian(surface, position, load / part, slip);
    FrictionJacobian {
        coefficient: of_part.coefficient * part,
        ..of_part
    }
}

/// Resistance to rolling and spinning of a mean load (N) over a step, of which a contact touches
/// for a part.
#[cold]
#[inline(never)]
pub(super) fn resistance<R: Real, F: SlidingFriction<R>>(
    law: &F,
    position: R::Vec3,
    [load, part]: [R; 2],
) -> Option<RollingResistance<R>> {
    let of_step = law.rolling_resistance_at(position, load)?;
    let of_part = law.rolling_resistance_at(position, load / part)?;
    if is_proportional(part, [of_step.rolling, of_part.rolling])
        && is_proportional(part, [of_step.spinning, of_part.spinning])
    {
        return Some(of_step);
    }
    Some(RollingResistance {
        rolling: of_part.rolling * part,
        spinning: of_part.spinning * part,
        ..of_part
    })
}

/// Returns true if a number is that of the part times the part, to rounding. It is also true where
/// the number of the part has overflowed.
fn is_proportional<R: Real>(part: R, [of_step, of_part]: [R; 2]) -> bool {
    let rounding = of_step.abs() * (R::EPSILON * R::from_f64(16.0));
    !of_part.is_finite() || (of_part * part - of_step).abs() <= rounding
}
