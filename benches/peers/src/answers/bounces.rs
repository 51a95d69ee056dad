//! Elastic bounces of a ball.

use tumble::glam::DVec3;
use tumble::{ContactPoint, State};

use super::GRAVITY;
use crate::law::Law;
use crate::scene::{Case, Measure, Scene, Shape};

/// A ball that is dropped on a spring without a damper returns to its height each time.
///
/// A flight between two contacts at the speed `v = √(2 g h)` lasts `2 v/g`. A contact lasts
/// `(2/ω)(π - arctan(v ω/g))` with `ω = √(S/m)`. The contact of a rigid ball has no duration.
pub(crate) fn elastic(stiffness: f64) -> Scene {
    let (mass, radius, height, seconds): (f64, f64, f64, f64) = (1.0, 0.1, 1.0, 10.0);
    let speed = (2.0 * GRAVITY * height).sqrt();
    let omega = (stiffness / mass).sqrt();
    let touches = 2.0 / omega * (core::f64::consts::PI - (speed * omega / GRAVITY).atan());
    let law = Law {
        mass,
        inertia: DVec3::splat(0.4 * mass * radius * radius),
        contacts: vec![ContactPoint {
            position: DVec3::ZERO,
            radius,
        }],
        rim: 0.0,
        stiffness,
        damping: 0.0,
        coefficient: 0.0,
        slip_speed: 1e-3,
        gravity: GRAVITY,
    };
    // Time of the last top, and of the end a tenth of a second after a top.
    let period = |touch: f64| 2.0 * speed / GRAVITY + touch;
    let seconds = (seconds / period(touches)).floor() * period(touches) + 0.1;
    let case = |touch: f64| {
        let fallen = seconds % period(touch);
        let fallen = if fallen > 0.5 * period(touch) {
            period(touch) - fallen
        } else {
            fallen
        };
        Case {
            start: State::at(DVec3::Z * (height + radius)),
            answer: State::at(DVec3::Z * (height + radius - 0.5 * GRAVITY * fallen * fallen)),
        }
    };
    Scene {
        name: if stiffness < 1e8 {
            "elastic bounces"
        } else {
            "the same, S = 1e9 N/m"
        },
        about: format!(
            "radius {radius} m, dropped from {height} m, S = {stiffness:.0e} N/m, no damper; the height after {seconds:.2} s, some eleven bounces, closed form"
        ),
        law,
        shape: Shape::Ball(radius),
        restitution: 1.0,
        seconds,
        soft: case(touches),
        rigid: case(0.0),
        measure: Measure::Centre,
        unit: (1.0, "m"),
        useful: 0.1,
        steps: vec![1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5],
        plain_steps: vec![1e-4, 1e-5],
        rapier_steps: vec![1e-2, 1e-3],
        scale: (1.0, 1.0),
    }
}
