//! A hoop that rolls round a circle on a rigid floor, and touches it at one point.

use core::f64::consts::{FRAC_PI_2, PI};

use tumble::State;
use tumble::glam::{DQuat, DVec3};

/// Radius of the hoop, m. Its mass is 1 kg.
pub const RADIUS: f64 = 0.5;
/// Spin about its own normal, rad/s.
pub const SPIN: f64 = 4.0;
/// Gravity, m/s².
pub const GRAVITY: f64 = 9.8;
/// Lean from flat, rad.
const LEAN: f64 = 75.0 * PI / 180.0;

/// Rate Ω at which the lean rotates about the vertical, rad/s.
///
/// It is a root of `(k_a + 1) ω Ω sin α - k_d Ω² sin α cos α + (g/r) cos α = 0` with `k_a = 1`,
/// `k_d = 1/2` (Routh; McDonald & McDonald).
fn turning_rate() -> f64 {
    let (sin, cos) = LEAN.sin_cos();
    let (a, b, c) = (-0.5 * sin * cos, 2.0 * SPIN * sin, GRAVITY / RADIUS * cos);
    // The slow root, without a difference of nearly equal numbers.
    -2.0 * c / (b + (b * b - 4.0 * a * c).sqrt())
}

/// Returns the state after `seconds`. The centre of the circle is above the origin.
pub fn after(seconds: f64) -> State {
    let omega = turning_rate();
    // The spin about the normal includes Ω cos α of the rotation about the vertical. The rest is
    // the rotation of the body relative to its lean.
    let own = (SPIN - omega * LEAN.cos()) * seconds;
    // The normal leans by α from the vertical, in the xz plane. The lowest point is on the side to
    // which the normal leans down.
    let turned = DQuat::from_rotation_z(omega * seconds) * DQuat::from_rotation_y(LEAN - FRAC_PI_2);
    let normal = turned * DVec3::X;
    let spin = normal * SPIN + (DVec3::Z - normal * normal.z) * omega;
    let arm = (normal * normal.z - DVec3::Z).normalize() * RADIUS;
    // Rolling: the lowest point of the body is at rest.
    let velocity = -(spin.cross(arm));
    // v = Ω z × R about the circle's centre.
    let position = velocity.cross(DVec3::Z) / omega;
    let along = normal * spin.dot(normal);
    let [about_normal, about_diameter] = [RADIUS * RADIUS, 0.5 * RADIUS * RADIUS];
    State {
        position: position.with_z(-arm.z),
        linear_velocity: velocity,
        orientation: turned * DQuat::from_rotation_x(own),
        angular_momentum: along * about_normal + (spin - along) * about_diameter,
    }
}
