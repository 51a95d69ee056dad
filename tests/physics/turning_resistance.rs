//! Resistance to rolling and spinning: balls come to rest according to closed forms, with every
//! kind of integrator, and the energy audit includes the resistance.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::kit::{self, log_uniform};
use proptest::prelude::*;
use tumble::glam::DVec3;
use tumble::{
    Coulomb, Dynamics, EnergyMomentum, FlatGround, Integrator, Ledger, Rk4, RollingResistance,
    SlidingFriction, Sphere, State, Stepper, StrangSplitting, SymplecticEuler, UniformGravity,
    WithResistance,
};

const G: f64 = 9.8;
const RADIUS: f64 = 0.03;

type Scene<I> = Stepper<Sphere, FlatGround, WithResistance<Coulomb>, UniformGravity, I>;

/// A solid ball of 1 kg on a ground into which it penetrates by 0.1 mm.
fn ball<I: Integrator>([rolling, spinning, turn_speed]: [f64; 3], by: I) -> Scene<I> {
    let friction = WithResistance {
        friction: Coulomb {
            coefficient: 0.5,
            slip_speed: 1e-3,
        },
        rolling,
        spinning,
        turn_speed,
    };
    Stepper::new(Sphere::solid(1.0, RADIUS))
        .unwrap()
        .with_gravity(UniformGravity::down(G))
        .unwrap()
        .with_ground(FlatGround::level(1e5, 300.0))
        .unwrap()
        .with_friction(friction)
        .unwrap()
        .with_integrator(by)
        .unwrap()
}

/// A ball at its penetration depth at rest, with a velocity and a spin.
fn moving<I: Integrator>(scene: &Scene<I>, velocity: DVec3, spin: DVec3) -> State {
    let state = State::at(DVec3::Z * (RADIUS - G / 1e5)).with_linear_velocity(velocity);
    let axes = state.rotation().axes();
    let momentum = scene
        .scene()
        .inertia_properties()
        .angular_momentum(&axes, spin);
    state.with_angular_momentum(momentum)
}

/// Case: a ball that rolls without slip under the torque `ℓ m g` slows down by `5/7 ℓ/r g` (e.g.
/// Mathavan, Jackson & Parkin, Am. J. Phys. 77, 788, 2009, for billiard balls).
fn rolls_out(by: impl Integrator, name: &str) {
    let (rolling, speed) = (1e-3, 0.7);
    let scene = ball([rolling, 0.0, 1e-4], by);
    let mut state = moving(&scene, DVec3::X * speed, DVec3::Y * (speed / RADIUS));
    let slowing = 5.0 / 7.0 * rolling / RADIUS * G;
    scene.advance(&mut state, 1.0).unwrap();
    // EnergyMomentum is seen right after half a step of the torque on the ball alone,
    // `ℓ m g h/2 · r/I` = 4.1e-4 m/s of slip, of which 2/7 are the ball's; the friction that slows
    // it, 5 % of the largest, needs a slip of 5e-5 m/s. Turn speed over turning: 1e-5 of the
    // torque.
    let slack = 2.0 / 7.0 * (4.1e-4 + 5e-5) + 1e-5 * slowing;
    let left = speed - slowing;
    assert!(
        (state.linear_velocity.x - left).abs() < slack,
        "{name}: {} m/s, not {left}",
        state.linear_velocity.x
    );
    let way = speed - slowing / 2.0;
    assert!(
        (state.position.x - way).abs() < slack,
        "{name}: {} m, not {way}",
        state.position.x
    );
}

#[test]
fn a_ball_rolls_out_at_the_rate_of_its_resistance_with_every_kind_of_integrator() {
    let time_step = 1e-3;
    rolls_out(EnergyMomentum { time_step }, "EnergyMomentum");
    // Friction near the slip 0 is as stiff as μ m g/(2/7 m)/1e-3 m/s = 17000/s.
    let time_step = 5e-5;
    rolls_out(StrangSplitting { time_step }, "StrangSplitting");
    rolls_out(SymplecticEuler { time_step }, "SymplecticEuler");
    rolls_out(Rk4 { time_step }, "Rk4");
}

#[test]
fn a_ball_that_rolls_out_comes_to_rest_where_it_should() {
    let (rolling, speed) = (3e-3, 0.3);
    let scene = ball([rolling, 0.0, 1e-6], EnergyMomentum { time_step: 1e-3 });
    let mut state = moving(&scene, DVec3::X * speed, DVec3::Y * (speed / RADIUS));
    scene.advance(&mut state, 1.0).unwrap();
    let way = speed * speed / (2.0 * 5.0 / 7.0 * rolling / RADIUS * G);
    // The last step, of 0.7 mm/s, and the slip of 4 % of 1e-3 m/s of the friction that slows it.
    assert!(
        (state.position.x - way).abs() < 5e-5,
        "{} m, not {way}",
        state.position.x
    );
    assert!(
        state.linear_velocity.length() < 1e-4,
        "{}",
        state.linear_velocity
    );
}

#[test]
fn a_ball_spins_down_on_the_spot() {
    // I ω' = -ℓ m g: from 50 rad/s, `2/5 m r² · 50/(ℓ m g)` seconds.
    let (spinning, spin) = (1e-3, 50.0);
    let seconds = 0.4 * RADIUS * RADIUS * spin / (spinning * G);
    let scene = ball([0.0, spinning, 1e-6], EnergyMomentum { time_step: 1e-3 });
    let mut state = moving(&scene, DVec3::ZERO, DVec3::Z * spin);
    scene.advance(&mut state, seconds / 2.0).unwrap();
    let turns = |state: &State| scene.scene().motion(state).angular_velocity;
    // Backward Euler of a torque that does not change is exact.
    assert!(
        (turns(&state) - DVec3::Z * (spin / 2.0)).length() < 1e-5,
        "{}",
        turns(&state)
    );
    scene.advance(&mut state, seconds / 2.0 + 0.01).unwrap();
    assert!(turns(&state).length() < 1e-4, "{}", turns(&state));
    // Rolling resistance does not see it.
    let scene = ball([spinning, 0.0, 1e-6], EnergyMomentum { time_step: 1e-3 });
    let mut state = moving(&scene, DVec3::ZERO, DVec3::Z * spin);
    scene.advance(&mut state, 0.1).unwrap();
    let left = scene.scene().motion(&state).angular_velocity;
    assert!((left - DVec3::Z * spin).length() < 1e-9, "{left}");
}

#[test]
fn the_books_hold_what_resistance_takes() {
    let scene = ball([2e-3, 1e-3, 1e-2], EnergyMomentum { time_step: 1e-3 });
    let speed = 0.7;
    let mut state = moving(
        &scene,
        DVec3::X * speed,
        DVec3::new(0.0, speed / RADIUS, 20.0),
    );
    let before = scene.energy(&state).total();
    let mut ledger = Ledger::new();
    scene.run(&mut state, 0.5, &mut ledger).unwrap();
    let lost = before - scene.energy(&state).total();
    assert!(lost > 0.1, "{lost} J");
    // The torque is constant. The audit evaluates the ball right after half a step of it, when it
    // slips by `ℓ m g h/2 · r/I` = s = 8.2e-4 m/s, which friction would dissipate at
    // `μ m g s²/(s + 1e-3)`, 1.8e-3 W.
    let slack = 1.8e-3 * 0.5;
    assert!(
        (ledger.work().friction + lost).abs() < slack,
        "{} J of {lost}",
        ledger.work().friction
    );
    assert!(
        ledger.energy_error().abs() < slack,
        "{} J of {lost}",
        ledger.energy_error()
    );
}

proptest! {
    #![proptest_config(kit::cases(300))]

    /// The torque never acts along the rotation, and never exceeds its limits.
    #[test]
    fn the_torque_opposes_the_turning(rolling in log_uniform(1e-6, 1e3), spinning in log_uniform(1e-6, 1e3), turn_speed in log_uniform(1e-9, 1.0), normal in kit::directions(), axis in kit::directions(), speed in log_uniform(1e-9, 1e3)) {
        let law = RollingResistance { rolling, spinning, turn_speed };
        let torque = law.torque(normal, axis * speed);
        prop_assert!(torque.dot(axis) <= 0.0);
        prop_assert!(torque.dot(normal).abs() <= spinning * (1.0 + 1e-15) + rolling * 1e-15);
        prop_assert!((torque - normal * normal.dot(torque)).length() <= rolling * (1.0 + 1e-15) + spinning * 1e-15);
    }
}

#[test]
fn a_law_without_resistance_says_so() {
    let coulomb = Coulomb {
        coefficient: 0.3,
        slip_speed: 1e-3,
    };
    assert!(coulomb.rolling_resistance(5.0).is_none());
    let law: &dyn SlidingFriction = &coulomb;
    assert!((&law).rolling_resistance(5.0).is_none());
}
