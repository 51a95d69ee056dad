//! A ball that slides until it rolls.

use tumble::glam::DVec3;
use tumble::{ContactPoint, State};

use super::GRAVITY;
use crate::law::Law;
use crate::scene::{Case, Measure, Scene, Shape};

/// A ball that starts with the speed `v` and no spin, slides, and then rolls at `(5/7) v`, whatever
/// the friction.
///
/// Its slip s begins at v and decreases as `s' = -a s/(s + ε)`, `a = (7/2) μ g`. Of each m/s of
/// slip, 2/7 belong to the speed of the centre. So the displacement is `(5/7) v t + (2/7) ∫ s dt`
/// with `∫ s dt = (v²/2 + ε v)/a` once it rolls. Coulomb's own friction has ε = 0.
pub(crate) fn slides_then_rolls(stiffness: f64, slip_speed: f64) -> Scene {
    let (mass, radius, speed, coefficient, seconds): (f64, f64, f64, f64, f64) =
        (1.0, 0.1, 2.0, 0.3, 1.0);
    let far = |slip_speed: f64| {
        let slip = (0.5 * speed * speed + slip_speed * speed) / (3.5 * coefficient * GRAVITY);
        5.0 / 7.0 * speed * seconds + 2.0 / 7.0 * slip
    };
    let law = Law {
        mass,
        inertia: DVec3::splat(0.4 * mass * radius * radius),
        contacts: vec![ContactPoint {
            position: DVec3::ZERO,
            radius,
        }],
        rim: 0.0,
        stiffness,
        // A fifth of critical damping. Nothing oscillates, because the ball starts at its height at
        // rest.
        damping: 0.4 * (stiffness * mass).sqrt(),
        coefficient,
        slip_speed,
        gravity: GRAVITY,
    };
    let case = |height: f64, slip_speed: f64| Case {
        start: State::at(DVec3::Z * height).with_linear_velocity(DVec3::X * speed),
        answer: State::at(DVec3::new(far(slip_speed), 0.0, height)),
    };
    let sag = mass * GRAVITY / stiffness;
    Scene {
        name: match (stiffness < 1e8, slip_speed < 1e-5) {
            (true, false) => "ball slides, then rolls",
            (true, true) => "the same, slip speed 1e-6 m/s",
            _ => "the same, S = 1e9 N/m",
        },
        about: format!(
            "radius {radius} m, {speed} m/s, μ = {coefficient}, S = {stiffness:.0e} N/m, v_ε = {slip_speed:.0e} m/s; the place after {seconds} s, closed form"
        ),
        law,
        shape: Shape::Ball(radius),
        restitution: 0.0,
        seconds,
        soft: case(radius - sag, slip_speed),
        rigid: case(radius, 0.0),
        measure: Measure::Centre,
        unit: (1.0, "m"),
        useful: 0.1,
        steps: vec![1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5],
        plain_steps: vec![1e-4, 1e-5],
        rapier_steps: vec![1e-2, 1e-3, 1e-4],
        scale: (1.0, 1.0),
    }
}
