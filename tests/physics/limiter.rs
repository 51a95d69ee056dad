//! What the energy limiter leaves as it is: bounces without losses, falls, sliding and rest.
//!
//! The sweep of the extremes tests that the energy never increases. A limiter that removes too
//! much, or a step that is always taken by a fallback, would pass it.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::kit::erased::Stepper;
use tumble::glam::DVec3;
use tumble::real::Vector;
use tumble::{
    ContactPoint, Coulomb, Cuboid, EnergyMomentum, FlatGround, Frictionless, PointCloud, Real,
    SlidingFriction, State, UniformGravity,
};

/// A point of 0.5 kg on level ground.
fn point<'a, R: Real>(
    damping: f64,
    friction: impl SlidingFriction<R> + 'a,
    step: f64,
) -> Stepper<'a, EnergyMomentum<R>, R> {
    let number = R::from_f64;
    let body = PointCloud::with_storage([ContactPoint::bare(R::Vec3::ZERO)], &[number(0.5)]);
    Stepper::builder(body.unwrap())
        .ground(FlatGround::level(number(3e3), number(damping)))
        .friction(friction)
        .gravity(UniformGravity::down(number(9.8)))
        .integrator(EnergyMomentum {
            time_step: number(step),
        })
        .build()
        .unwrap()
}

fn at<R: Real>(height: f64, speed: f64) -> State<R> {
    let vector = |x: f64, z: f64| R::Vec3::new(R::from_f64(x), R::ZERO, R::from_f64(z));
    State::at(vector(0.0, height)).with_linear_velocity(vector(speed, 0.0))
}

/// Bounces of 4000 steps. In double precision the limiter only removes energy: a unit in the last
/// place in each step at most. In single precision it compensates in both directions, so that the
/// energy stays within what counts as its rounding: 64 units of the terms before and after a step,
/// which are at most twice the total.
fn bounces_keep_the_energy<R: Real>(units: f64) {
    let stepper = point::<R>(0.0, Frictionless, 1e-3);
    let mut state = at::<R>(0.3, 0.7);
    let start = stepper.energy(&state).total().to_f64();
    let (mut highest, mut removed, mut fallbacks) = (0.0_f64, 0.0, 0);
    for number in 0..4000 {
        let step = stepper.step(&mut state).unwrap();
        removed += step.energy_removed.to_f64();
        fallbacks += u32::from(step.fallback);
        if number > 3000 {
            highest = highest.max(state.position.z().to_f64());
        }
    }
    let lost = 1.0 - stepper.energy(&state).total().to_f64() / start;
    let unit = R::EPSILON.to_f64();
    assert!((0.0..units * unit).contains(&lost), "{} units", lost / unit);
    assert!(removed <= units * unit * start, "{removed}");
    assert_eq!(fallbacks, 0);
    // Sampled every millisecond at the top: g t²/2 of at most 1.3e-6 m.
    assert!((highest - 0.3).abs() < 2e-6 + units * unit, "{highest}");
    let along = state.linear_velocity.x().to_f64();
    assert!((along - 0.7).abs() < units * unit, "{along}");
}

#[test]
fn bounces_without_losses_keep_energy_and_height() {
    bounces_keep_the_energy::<f64>(4000.0);
    bounces_keep_the_energy::<f32>(128.0);
}

/// Rounding must not hold a body in the air: in steps of a tenth of a microsecond it falls by 5e-14
/// m in the first one, below the last digit of its height.
#[test]
fn a_body_falls_in_steps_below_its_last_digit() {
    let stepper = point::<f64>(0.0, Frictionless, 1e-7);
    let mut state = at::<f64>(1e3, 0.0);
    for _ in 0..1000 {
        let before = state.position.z;
        let step = stepper.step(&mut state).unwrap();
        assert!(state.position.z <= before);
        assert!(!step.fallback, "{step:?}");
    }
    // 1000 steps take 1e-4 s: 4.9e-8 m.
    let fallen = 1e3 - state.position.z;
    assert!(
        (fallen - 4.9e-8).abs() < 1e-9 + 1000.0 * 2.3e-13,
        "{fallen:e}"
    );
    assert!((state.linear_velocity.z + 9.8e-4).abs() < 1e-6, "{state}");
}

/// A point that slides is slowed by `μ g`, and its weight is balanced at `m g/k`.
#[test]
fn a_body_slides_as_far_as_friction_lets_it_and_rests_there() {
    let friction = Coulomb {
        coefficient: 0.2,
        slip_speed: 1e-6,
    };
    let stepper = point::<f64>(20.0, friction, 1e-3);
    let depth = 0.5 * 9.8 / 3e3;
    let mut state = at::<f64>(-depth, 0.5);
    stepper.advance(&mut state, 2.0).unwrap();
    let expected = 0.5 * 0.5 / (2.0 * 0.2 * 9.8);
    assert!((state.position.x - expected).abs() < 1e-6, "{state}");
    assert!((state.position.z + depth).abs() < 1e-12, "{state}");
    let rest = state;
    let steps: Vec<_> = (0..20).map(|_| stepper.step(&mut state).unwrap()).collect();
    assert!((state.position - rest.position).length() < 1e-12, "{state}");
    assert!(steps.iter().all(|step| !step.fallback), "{steps:?}");
}

/// A box that falls flat on dampers comes to rest at the depth that carries it, with the energy
/// of its position and its springs.
#[test]
fn a_box_comes_to_rest_where_its_springs_carry_it() {
    let body = Cuboid::solid(0.5, DVec3::new(0.2, 0.3, 0.1));
    let stepper = Stepper::builder(body)
        .ground(FlatGround::level(2e3, 5.0))
        .friction(Coulomb {
            coefficient: 0.4,
            slip_speed: 1e-6,
        })
        .gravity(UniformGravity::down(9.8))
        .integrator(EnergyMomentum { time_step: 2e-3 })
        .build()
        .unwrap();
    let mut state = State::at(DVec3::Z * 0.08).with_rotation_vector(DVec3::X * 0.02);
    stepper.advance(&mut state, 3.0).unwrap();
    let depth = 0.5 * 9.8 / (4.0 * 2e3);
    assert!((state.position.z - (0.05 - depth)).abs() < 1e-10, "{state}");
    assert!(state.linear_velocity.length() < 1e-9, "{state}");
    let mut session = stepper.session(state);
    let steps: Vec<_> = (0..20).map(|_| session.step().unwrap()).collect();
    assert!(steps.iter().all(|step| !step.fallback), "{steps:?}");
    assert_eq!(steps[19].evaluations, 0, "{:?}", steps[19]);
}

/// Without gravity and a contact nothing changes the velocity of the centre of mass. The energy of
/// the spin has roundings, and the orientation takes them: a velocity that took them would change
/// in its last bits.
#[test]
fn without_gravity_the_velocity_keeps_its_bits() {
    let stepper = Stepper::new(Cuboid::solid(0.7, DVec3::new(0.3, 0.2, 0.1)))
        .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step: 1e-2 }))
        .unwrap();
    let velocity = DVec3::new(3.1, -0.7, 1.3);
    let mut state = State::at(DVec3::new(10.0, 20.0, 30.0)).with_linear_velocity(velocity);
    state = stepper.with_angular_velocity(state, DVec3::new(2.0, 5.0, 3.0));
    for step in 0..2000 {
        stepper.step(&mut state).unwrap();
        assert_eq!(state.linear_velocity, velocity, "step {step}");
    }
}
