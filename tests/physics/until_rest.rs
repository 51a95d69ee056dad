//! Rest: a run ends where the body lies still, and not where it is only slow.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]
// Times of single samples are compared, not sums.
#![allow(clippy::float_cmp)]

use crate::kit::erased::Stepper;
use core::f64::consts::TAU;
use tumble::glam::{DQuat, DVec3, Vec3};
use tumble::{
    Coulomb, Cuboid, EnergyMomentum, FlatGround, Flight, Integrator, PointMass, Rk4, SolidCoin,
    Sphere, State, UniformGravity, UntilRest,
};

const FRICTION: Coulomb = Coulomb {
    coefficient: 0.3,
    slip_speed: 1e-4,
};

fn die<I: Integrator>(integrator: I) -> Stepper<'static, I> {
    Stepper::new(Cuboid::cube(0.005, 0.016).rounded(0.0015))
        .unwrap()
        .with_gravity(UniformGravity::down(9.81))
        .unwrap()
        .with_ground(FlatGround::level(4000.0, 1.2))
        .unwrap()
        .with_friction(FRICTION)
        .unwrap()
        .with_integrator(integrator)
        .unwrap()
}

fn coin<I: Integrator>(integrator: I) -> Stepper<'static, I> {
    Stepper::new(SolidCoin::new(0.006, 0.012, 0.002))
        .unwrap()
        .with_gravity(UniformGravity::down(9.81))
        .unwrap()
        .with_ground(FlatGround::level(100.0, 0.02))
        .unwrap()
        .with_friction(FRICTION)
        .unwrap()
        .with_integrator(integrator)
        .unwrap()
}

/// A throw from 20 cm, rotating about a different axis for each number.
fn thrown(stepper: &Stepper<impl Integrator>, number: u32) -> State {
    let angle = 2.4 * f64::from(number);
    let axis = DVec3::new(angle.cos(), angle.sin(), (0.7 * angle).sin());
    let state = State::at(DVec3::Z * 0.2).with_orientation(DQuat::from_rotation_x(angle));
    stepper.with_angular_velocity(state, axis * 40.0)
}

/// Upper bound of the displacement of any point of the body: `|shift| + 2 r sin(φ/2)`.
fn moved(bounding_radius: f64, from: &State, to: &State) -> f64 {
    let turn = to.orientation * from.orientation.inverse();
    (to.position - from.position).length() + 2.0 * bounding_radius * turn.xyz().length()
}

const DISTANCE: f64 = 1e-4;

/// Each throw ends, and what has come to rest stays there: within the distance, in twice the time
/// again.
fn rest_lasts(stepper: &Stepper<impl Integrator>) {
    for number in 0..12 {
        let mut state = thrown(stepper, number);
        let mut rest = UntilRest::new(stepper.body(), DISTANCE, 0.25).unwrap();
        let seconds = stepper.run(&mut state, 60.0, &mut rest).unwrap();
        assert!(rest.is_reached() && seconds < 60.0, "throw {number}");
        let lies = state;
        stepper.advance(&mut state, 0.5).unwrap();
        let way = moved(stepper.body().bounding_radius(), &lies, &state);
        assert!(way <= DISTANCE, "throw {number}: {way} m");
    }
}

#[test]
fn a_die_that_rests_stays_where_it_is() {
    rest_lasts(&die(EnergyMomentum { time_step: 1e-3 }));
    rest_lasts(&die(EnergyMomentum {
        time_step: 1.0 / 60.0,
    }));
    rest_lasts(&die(Flight(EnergyMomentum { time_step: 1e-3 })));
}

#[test]
fn a_coin_that_rests_stays_where_it_is() {
    rest_lasts(&coin(EnergyMomentum { time_step: 1e-3 }));
}

/// A ball on springs without a damper bounces for ever between the same two positions. In closed
/// form, a flight begins and ends in one of them.
#[test]
fn a_bounce_is_no_rest() {
    let stepper = Stepper::new(PointMass::new(0.1))
        .unwrap()
        .with_gravity(UniformGravity::down(9.81))
        .unwrap()
        .with_ground(FlatGround::level(1e6, 0.0))
        .unwrap()
        .with_integrator(Flight(EnergyMomentum { time_step: 1e-4 }))
        .unwrap();
    let mut state = State::at(DVec3::Z * 0.2);
    let mut rest = UntilRest::new(stepper.body(), 0.01, 0.1).unwrap();
    stepper.run(&mut state, 10.0, &mut rest).unwrap();
    assert!(!rest.is_reached());
}

/// The distance is that of the farthest point: a wheel that rotates about its axis is not at rest.
#[test]
fn a_spinning_body_does_not_rest() {
    let stepper = Stepper::new(SolidCoin::new(0.006, 0.012, 0.002)).unwrap();
    // 1.2e-4 m of its rim in 0.25 s.
    let mut slow = stepper.with_angular_velocity(State::at(DVec3::Z), DVec3::X * 0.04);
    let mut rest = UntilRest::new(stepper.body(), DISTANCE, 0.25).unwrap();
    stepper.run(&mut slow, 10.0, &mut rest).unwrap();
    assert!(!rest.is_reached());
    // 0.9e-4 m.
    let mut slower = stepper.with_angular_velocity(State::at(DVec3::Z), DVec3::X * 0.03);
    let mut rest = UntilRest::new(stepper.body(), DISTANCE, 0.25).unwrap();
    stepper.run(&mut slower, 10.0, &mut rest).unwrap();
    assert!(rest.is_reached());
}

/// A step of a whole revolution ends at the pose at which it began.
#[test]
fn a_body_that_turns_whole_revolutions_in_each_step_does_not_rest() {
    let flight = Flight(EnergyMomentum { time_step: 1e-3 });
    let ball = Stepper::new(Sphere::solid(1.0, 0.05)).unwrap();
    let ball = ball.with_integrator(flight).unwrap();
    for revolutions in [1.0, 2.0, 5.0] {
        for seconds in [1.0, 1.0 / 60.0] {
            let spin = DVec3::Z * (TAU * revolutions / seconds);
            let mut state = ball.with_angular_velocity(State::at(DVec3::ZERO), spin);
            let mut rest = UntilRest::new(ball.body(), DISTANCE, 0.25).unwrap();
            for _ in 0..60 {
                ball.run(&mut state, seconds, &mut rest).unwrap();
                assert!(!rest.is_reached(), "{revolutions} in {seconds} s");
            }
        }
    }
}

/// The last step of a run can be so short that the body hardly rotates in it.
#[test]
fn a_body_that_turned_a_whole_revolution_before_a_short_step_does_not_rest() {
    let (revolution, rest_of_time) = (0.25, 1e-6);
    let flight = Flight(EnergyMomentum { time_step: 1e-3 });
    let ball = Stepper::new(Sphere::solid(1.0, 0.05)).unwrap();
    let ball = ball.with_integrator(flight).unwrap();
    let spin = DVec3::Z * (TAU / revolution);
    let mut state = ball.with_angular_velocity(State::at(DVec3::ZERO), spin);
    let mut rest = UntilRest::new(ball.body(), DISTANCE, revolution + rest_of_time).unwrap();
    for seconds in [revolution, 2.0 * rest_of_time] {
        ball.run(&mut state, seconds, &mut rest).unwrap();
        assert!(!rest.is_reached(), "after {seconds} s");
    }
}

/// Frame by frame it counts on; a body at rest costs no step, and one that is pushed wakes.
#[test]
fn frames_count_together_and_a_push_wakes() {
    let frame = 1.0 / 60.0;
    let stepper = die(EnergyMomentum { time_step: frame });
    // Not a whole number of frames: their sum would come to it from either side.
    let (mut whole, mut by_frames) = (thrown(&stepper, 3), thrown(&stepper, 3));
    let mut rest = UntilRest::new(stepper.body(), DISTANCE, 0.26).unwrap();
    let seconds = stepper.run(&mut whole, 60.0, &mut rest).unwrap();
    let mut rest = UntilRest::new(stepper.body(), DISTANCE, 0.26).unwrap();
    let mut frames = 0_u32;
    while !rest.is_reached() {
        stepper.run(&mut by_frames, frame, &mut rest).unwrap();
        frames += 1;
    }
    assert_eq!(by_frames, whole);
    assert!((f64::from(frames) * frame - seconds).abs() < 1e-9);

    assert_eq!(stepper.run(&mut by_frames, frame, &mut rest), Ok(0.0));
    by_frames.linear_velocity.z = 1.0;
    assert_eq!(stepper.run(&mut by_frames, frame, &mut rest), Ok(frame));
    assert!(!rest.is_reached());
}

/// The parameters that are refused stand in `tests/limits/bad_input.rs`.
#[test]
fn it_waits_for_a_body_that_does_not_move_at_all_and_works_in_single_precision() {
    let stepper = Stepper::new(PointMass::new(1.0)).unwrap();
    let mut state = State::at(DVec3::ZERO);
    let mut rest = UntilRest::new(stepper.body(), 0.0, 0.5).unwrap();
    assert!(!rest.is_reached());
    let with_rk4 = stepper.with_integrator(Rk4 { time_step: 0.1 }).unwrap();
    // Five steps, which add up to a half from either side.
    let seconds = with_rk4.run(&mut state, 1.0, &mut rest).unwrap();
    assert!((0.5..0.61).contains(&seconds) && rest.is_reached());

    let stepper = Stepper::new(PointMass::new(1.0_f32)).unwrap();
    let time_step = 1e-3;
    let stepper = stepper
        .with_integrator(EnergyMomentum { time_step })
        .unwrap();
    let mut rest = UntilRest::new(stepper.body(), 1e-4, 0.5).unwrap();
    let mut state = State::at(Vec3::ZERO);
    stepper.run(&mut state, 1.0, &mut rest).unwrap();
    assert!(rest.is_reached());
}
