//! Tosses of the coin of `common::steel_coin`.

use tumble::glam::{DQuat, DVec3};
use tumble::{RigidPointBody, State};

pub(crate) use common::steel_coin::{GRAVITY, PATIENCE, TOLERANCE, Table, table};

/// Height of the hand over the table, m.
pub(crate) const HAND: f64 = 0.2;

/// Leaves the hand level and heads up, with a vertical speed (m/s). The angular momentum is at the
/// angle `psi` (rad) from the normal, and the normal goes round it at `rate` (rad/s).
pub(crate) fn toss<B: RigidPointBody>(body: &B, speed: f64, psi: f64, rate: f64) -> State {
    let diameter = body.inertia().y_axis.y;
    State::at(DVec3::Z * HAND)
        .with_linear_velocity(DVec3::Z * speed)
        .with_orientation(DQuat::from_rotation_y(-core::f64::consts::FRAC_PI_2))
        .with_angular_momentum(DVec3::new(psi.sin(), 0.0, psi.cos()) * (diameter * rate))
}

/// Whether heads points up.
pub(crate) fn is_heads_up(state: &State) -> bool {
    (state.orientation * DVec3::X).z > 0.0
}
