//! Friction of a contact that touches for a part of the step.
//!
//! The load of such a contact is 0 for the rest of the step. Its mean load over the step, N, is
//! that over the part φ in which it touches, N/φ, times φ. So the mean friction is
//!
//! ```text
//! φ F(N/φ)
//! ```
//!
//! with an error of order h², because the load N/φ changes little in the step. At the mean load of
//! the step, `F(N)`, the error is of order 1, and the step that contains a touch-down has one of
//! order h. The part follows from the depths at both ends, as the mean force does: the depth is
//! linear in time over the step.
//!
//! Both are the same for a law that [is proportional to the
//! load](SlidingFriction::is_proportional_to_load), which therefore does not need this module.

use super::problem::Problem;
use crate::friction::{FrictionJacobian, RollingResistance, SlidingFriction};
use crate::real::Real;
use crate::scene::Dynamics;

/// Friction (N) on a surface at a position (m, world axes), under a mean load (N) over a step, of
/// which the contact touches for a part.
#[cold]
#[inline(never)]
pub(super) fn friction<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    (surface, part): (u32, R),
    (position, load): (R::Vec3, R),
    slip: R::Vec3,
) -> R::Vec3 {
    problem.friction(surface, position, load / part, slip) * part
}

/// Derivatives of [`friction`], for a part that does not depend on the trial.
#[cold]
#[inline(never)]
pub(super) fn jacobian<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    (surface, part): (u32, R),
    (position, load): (R::Vec3, R),
    slip: R::Vec3,
) -> FrictionJacobian<R> {
    let jacobian = problem.jacobian(surface, position, load / part, slip);
    FrictionJacobian {
        coefficient: jacobian.coefficient * part,
        ..jacobian
    }
}

/// Resistance to rolling and spinning under a mean load (N) over a step, of which the contact
/// touches for a part.
#[cold]
#[inline(never)]
pub(super) fn resistance<R: Real, F: SlidingFriction<R>>(
    law: &F,
    part: R,
    (position, load): (R::Vec3, R),
) -> Option<RollingResistance<R>> {
    let resistance = law.rolling_resistance_at(position, load / part)?;
    Some(RollingResistance {
        rolling: resistance.rolling * part,
        spinning: resistance.spinning * part,
        ..resistance
    })
}
