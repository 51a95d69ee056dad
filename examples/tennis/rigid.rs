//! Closed form of the bounce of a rigid ball: it slides throughout, or it rolls at the end.
//!
//! The contact point slips with `u = v + ω × (-r z)` along the court. Friction of a normal impulse
//! `m J` changes the velocity by at most `μ J` against `u`, and the spin by `-z × Δv/(β r)`. Both
//! change the slip by `(1 + 1/β) Δv`. If that would reverse the slip, friction ends it: the ball
//! grips. Brody, Phys. Teach. 22, 494 (1984), for spin about the horizontal axis.

use tumble::glam::DVec3;

use crate::model::{BETA, RADIUS};

/// Velocity (m/s) and spin (rad/s) after a bounce along the court, and whether the ball grips.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rigid {
    pub(crate) along: DVec3,
    pub(crate) spin: DVec3,
    pub(crate) grips: bool,
}

/// Slip of the contact point, m/s.
pub(crate) fn slip(velocity: DVec3, spin: DVec3) -> DVec3 {
    (velocity + spin.cross(DVec3::NEG_Z * RADIUS)).with_z(0.0)
}

/// Bounce with a coefficient of friction and a normal impulse over mass, m/s.
pub(crate) fn bounce(velocity: DVec3, spin: DVec3, friction: f64, impulse: f64) -> Rigid {
    let slip = slip(velocity, spin);
    let both = 1.0 + 1.0 / BETA;
    let most = friction * impulse;
    let grips = most * both >= slip.length();
    let change = if grips {
        slip / -both
    } else {
        slip.normalize() * -most
    };
    Rigid {
        along: (velocity + change).with_z(0.0),
        spin: spin + DVec3::NEG_Z.cross(change) / (BETA * RADIUS),
        grips,
    }
}
