//! Friction laws beyond Coulomb's, against closed forms: stopping, sliding down a slope, and the ellipse of a grain.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

mod kit;

use kit::{directions, log_uniform, point_mass};
use proptest::prelude::*;
use tumble::glam::DVec3;
use tumble::{
    AnisotropicCoulomb, Coulomb, EnergyMomentum, FlatGround, Plane, SlidingFriction, State,
    Stepper, Stribeck, UniformGravity, Viscous,
};

const G: f64 = 9.8;

/// A point of 1 kg that slides on a slope of this angle (rad) at its depth of rest, from `velocity` for `seconds`.
fn slide(
    friction: impl SlidingFriction,
    angle: f64,
    velocity: DVec3,
    [seconds, time_step]: [f64; 2],
) -> State {
    let normal = DVec3::new(-angle.sin(), 0.0, angle.cos());
    let stiffness = 1e4;
    let depth = G * angle.cos() / stiffness;
    let stepper = Stepper::new(point_mass(1.0))
        .unwrap()
        .with_gravity(UniformGravity::down(G))
        .unwrap()
        .with_ground(FlatGround::level(stiffness, 200.0).on(Plane::through(DVec3::ZERO, normal)))
        .unwrap()
        .with_friction(friction)
        .unwrap()
        .with_integrator(EnergyMomentum { time_step })
        .unwrap();
    let mut state = State::at(normal * -depth).with_linear_velocity(velocity);
    stepper.advance(&mut state, seconds).unwrap();
    state
}

fn stribeck(slip_speed: f64) -> Stribeck {
    Stribeck {
        static_coefficient: 0.5,
        kinetic_coefficient: 0.3,
        stribeck_speed: 0.5,
        viscous: 0.0,
        slip_speed,
    }
}

#[test]
fn a_block_with_stribeck_friction_stops_where_the_curve_says() {
    // v dv/dx = -g μ(v) with μ = k + (s - k)/(1 + v²/w²): x = (v²/k - (s - k) w²/k² ln(1 + k v²/(s w²)))/(2g).
    let (law, v) = (stribeck(1e-7), 2.0_f64);
    let [s, k, w] = [
        law.static_coefficient,
        law.kinetic_coefficient,
        law.stribeck_speed,
    ];
    let far =
        (v * v / k - (s - k) * w * w / (k * k) * (k * v * v / (s * w * w)).ln_1p()) / (2.0 * G);
    let end = slide(law, 0.0, DVec3::X * v, [1.0, 1e-3]);
    // Of order 2: (μ' g dt)² of the way, 1e-5, and the last step's v dt/2 of 1e-3 · g μ · 1e-3/2.
    assert!(
        (end.position.x - far).abs() < 1e-5 * far + 3e-6,
        "{} m, not {far}",
        end.position.x
    );
    assert!(end.linear_velocity.length() < 1e-12);
}

#[test]
fn on_a_slope_between_the_two_coefficients_stribeck_friction_holds_what_rests_and_not_what_slides()
{
    // tan 22° = 0.404: between 0.3 and 0.5. What rests creeps at ε t/(s - t) = 4.2 ε (as of Coulomb); what slides faster than 0.5 m/s · √((s-t)/(t-k)) = 0.48 m/s gains speed.
    let angle = 22_f64.to_radians();
    let downhill = DVec3::new(-angle.cos(), 0.0, -angle.sin());
    let law = stribeck(1e-7);
    let rests = slide(law, angle, DVec3::ZERO, [1.0, 1e-2]);
    let t = angle.tan();
    let creep = law.slip_speed * t / (law.static_coefficient - t);
    // Over the second that it took: at the end of a step that is too long for the friction, the velocity itself is 0.
    let speed = rests.position.dot(downhill);
    // Each step begins at rest, for which 2 creep/dt of g sin θ are taken off the force: 2e-5 of it, and s/(s-t) = 5 times as much off the creep.
    assert!(
        (speed / creep - 1.0).abs() < 1e-3,
        "{speed} m/s, not {creep}"
    );
    for (start, gains) in [(0.45, false), (0.52, true)] {
        let end = slide(law, angle, downhill * start, [0.3, 1e-3]);
        assert_eq!(
            end.linear_velocity.dot(downhill) > start,
            gains,
            "{start} m/s"
        );
    }
}

proptest! {
    #![proptest_config(kit::cases(30))]

    /// `v' = g (sin θ - c cos θ v)`: it tends to `tan θ/c`, with the time constant `1/(c g cos θ)`.
    #[test]
    fn viscous_friction_lets_a_body_down_at_a_steady_speed(degrees in 1.0..60.0_f64, coefficient in log_uniform(0.1, 10.0)) {
        let angle = degrees.to_radians();
        let rate = coefficient * G * angle.cos();
        let end = slide(Viscous { coefficient }, angle, DVec3::ZERO, [3.0 / rate, 0.01 / rate]);
        let speed = angle.tan() / coefficient * (1.0 - (-3.0_f64).exp());
        // Of order 2: (0.01)²/12 · 3 of exp(-3).
        prop_assert!((end.linear_velocity.length() / speed - 1.0).abs() < 1e-5, "{} m/s, not {speed}", end.linear_velocity.length());
    }
}

proptest! {
    #![proptest_config(kit::cases(300))]

    #[test]
    fn friction_with_a_grain_lies_on_its_ellipse(
        normal in directions(), grain in directions(), slip in directions(), coefficients in [log_uniform(0.01, 10.0), log_uniform(0.01, 10.0)], load in log_uniform(1e-3, 1e3),
    ) {
        prop_assume!(normal.cross(grain).length() > 1e-3 && normal.cross(slip).length() > 1e-3);
        let law = AnisotropicCoulomb::on(normal, grain, coefficients, 1e-12);
        let slip = (slip - normal * normal.dot(slip)).normalize();
        let force = law.force(load, slip);
        let [along, across] = [law.along.dot(force), law.across.dot(force)];
        let size = (along / (coefficients[0] * load)).hypot(across / (coefficients[1] * load));
        // The slip speed leaves 1e-12 · (larger over smaller) of it, at most 1e-9.
        prop_assert!((size - 1.0).abs() < 2e-9, "{size}");
        // The direction that takes most: no other force of the ellipse opposes this slip more.
        for other in 0..32 {
            let (sin, cos) = (f64::from(other) * 0.2).sin_cos();
            let rival = law.along * (coefficients[0] * load * cos) + law.across * (coefficients[1] * load * sin);
            prop_assert!(force.dot(slip) <= -rival.dot(slip) + 1e-8 * load * coefficients[0].max(coefficients[1]));
        }
    }

    #[test]
    fn friction_with_an_even_grain_is_coulombs(
        normal in directions(), grain in directions(), slip in directions(), speed in log_uniform(1e-6, 1e2), coefficient in log_uniform(1e-3, 10.0), slip_speed in log_uniform(1e-6, 1.0),
    ) {
        prop_assume!(normal.cross(grain).length() > 1e-3 && normal.cross(slip).length() > 1e-3);
        let even = AnisotropicCoulomb::on(normal, grain, [coefficient; 2], slip_speed);
        let coulomb = Coulomb { coefficient, slip_speed };
        let slip = (slip - normal * normal.dot(slip)).normalize() * speed;
        let (force, expected) = (even.force(2.0, slip), coulomb.force(2.0, slip));
        // Directions are orthonormal to some units in the last place, and up to a thousandth from parallel.
        prop_assert!((force - expected).length() <= 1e-12 * expected.length());
        let (drag, expected) = (even.drag(2.0, slip), coulomb.drag(2.0, slip));
        prop_assert!((drag.coefficient / expected.coefficient - 1.0).abs() < 1e-12);
        prop_assert!((drag.width / expected.width - 1.0).abs() < 1e-12);
    }

    /// Newton's iteration is told the slope of the force along the slip, `c (1 - growth |slip|/width)`, or 0 where the force falls.
    #[test]
    fn the_drag_of_stribeck_friction_is_the_slope_of_its_force(speed in log_uniform(1e-5, 10.0), viscous in prop_oneof![Just(0.0), log_uniform(1e-3, 10.0)], kinetic in 0.0..1.0_f64) {
        let law = Stribeck { viscous, kinetic_coefficient: kinetic, ..stribeck(1e-3) };
        let along = |speed: f64| -law.force(3.0, DVec3::Y * speed).y;
        let nudge = 1e-5 * speed;
        let slope = (along(speed + nudge) - along(speed - nudge)) / (2.0 * nudge);
        let drag = law.drag(3.0, DVec3::Y * speed);
        let told = drag.coefficient * (1.0 - drag.growth * speed / drag.width);
        // Where the slope is below what a growth of 1 says, it falls.
        let least = drag.coefficient * (1.0 - speed / drag.width);
        prop_assert!((told - slope.max(least)).abs() < 1e-8 * drag.coefficient, "{told}, not {slope}");
    }
}
