//! Flight in closed form: it has the same states as flight step by step, and never ends in the
//! ground, for any rotation of the body.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::kit::erased::Stepper;
use core::ops::ControlFlow;
use tumble::contract::{CheckPlan, check_integrator};
use tumble::glam::DVec3;
use tumble::{
    Coin, ContactPoint, Coulomb, DormandPrince54, Dynamics, EnergyMomentum, FlatGround, Flight,
    Integrator, Plane, PointCloud, RigidPointBody, Rk4, Sample, SceneQuery, State, StrangSplitting,
    SymplecticEuler, Timed, UniformGravity,
};

/// A toss that lands after 1.3 s.
fn toss() -> State {
    State::at(DVec3::new(0.0, 0.0, 1.0))
        .with_linear_velocity(DVec3::new(0.4, -0.2, 6.0))
        .with_rotation_vector(DVec3::new(0.3, 0.8, -0.2))
        .with_angular_momentum(DVec3::new(0.4, 1.1, -0.7))
}

fn table<'a, I: Integrator>(
    body: impl RigidPointBody + 'a,
    plane: Plane,
    integrator: I,
) -> Stepper<'a, I> {
    Stepper::new(body)
        .and_then(|stepper| stepper.with_ground(FlatGround::level(1000.0, 0.5).on(plane)))
        .and_then(|stepper| {
            stepper.with_friction(Coulomb {
                coefficient: 0.3,
                slip_speed: 1e-3,
            })
        })
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(9.8)))
        .and_then(|stepper| stepper.with_integrator(integrator))
        .unwrap()
}

fn level() -> Plane {
    Plane::level(0.0)
}

/// The states at multiples of 0.05 s, and the number of steps.
fn film(stepper: &Stepper<impl Integrator>, seconds: f64) -> (Vec<State>, u64) {
    let (mut states, mut steps) = (Vec::new(), 0);
    let film = Timed::every(0.05, |sample: &Sample<'_>| {
        states.push(*sample.state);
        ControlFlow::Continue(())
    })
    .unwrap();
    let mut count = |sample: &Sample<'_>| {
        steps = sample.step;
        ControlFlow::Continue(())
    };
    stepper
        .run(&mut toss(), seconds, &mut (film, &mut count))
        .unwrap();
    (states, steps)
}

fn apart(a: &State, b: &State) -> f64 {
    let sign = a.orientation.dot(b.orientation).signum();
    (a.position - b.position).length()
        + (a.linear_velocity - b.linear_velocity).length()
        + (a.orientation - b.orientation * sign).length()
        + (a.angular_momentum - b.angular_momentum).length()
}

#[test]
fn a_toss_with_bounces_has_the_same_states_to_rounding() {
    // 1500 steps of numbers near 10 round by 2e-15 each in the flight; the contact makes it grow,
    // by what a push grows there (100 in a second).
    fn compare<I: Integrator + Copy>(integrator: I) {
        let (plain, many) = film(&table(Coin::ring(1.0, 0.5), level(), integrator), 2.0);
        let (flown, few) = film(
            &table(Coin::ring(1.0, 0.5), level(), Flight(integrator)),
            2.0,
        );
        assert_eq!(plain.len(), flown.len());
        assert!(few < many / 2, "{few} of {many} steps");
        for (k, (a, b)) in plain.iter().zip(&flown).enumerate() {
            let bound = if k <= 26 { 2e-11 } else { 1e-8 };
            let off = apart(a, b);
            assert!(off < bound, "{off:e} at {:.2} s", 0.05 * k as f64);
        }
    }
    compare(StrangSplitting { time_step: 1e-3 });
    compare(EnergyMomentum { time_step: 1e-3 });
}

#[test]
fn methods_that_are_not_exact_in_flight_differ_by_their_error_there() {
    let truth = film(
        &table(
            Coin::ring(1.0, 0.5),
            level(),
            Flight(StrangSplitting { time_step: 1e-3 }),
        ),
        1.25,
    )
    .0;
    let rk4 = film(
        &table(Coin::ring(1.0, 0.5), level(), Rk4 { time_step: 1e-3 }),
        1.25,
    )
    .0;
    let flown = film(
        &table(
            Coin::ring(1.0, 0.5),
            level(),
            Flight(Rk4 { time_step: 1e-3 }),
        ),
        1.25,
    )
    .0;
    let euler = film(
        &table(
            Coin::ring(1.0, 0.5),
            level(),
            Flight(SymplecticEuler { time_step: 1e-3 }),
        ),
        1.25,
    )
    .0;
    for (((truth, rk4), flown), euler) in truth.iter().zip(&rk4).zip(&flown).zip(&euler) {
        assert_eq!(truth, flown);
        assert_eq!(truth, euler);
        assert!(apart(truth, rk4) < 1e-8);
    }
}

#[test]
fn around_energy_momentum_the_energy_never_rises_in_flight_either() {
    let asymmetric = PointCloud::new(
        [DVec3::X, DVec3::Y * 0.7, DVec3::Z * -0.4, -DVec3::ONE],
        [0.4, 0.3, 0.2, 0.6],
    )
    .unwrap();
    // Energy removed, as a fraction of the energy: the rounding of a parabola and a rotation.
    fn watch<B: RigidPointBody>(body: B) -> u32 {
        let stepper = table(body, level(), Flight(EnergyMomentum { time_step: 1e-3 }));
        let (mut random, mut flights) = (Random(11), 0);
        for _ in 0..2000 {
            let throw = 10.0_f64.powf(3.0 * random.number());
            let spin = 10.0_f64.powf(4.0 * random.number());
            let mut state = State::at(DVec3::new(1e3 * random.number(), 0.0, 3.0 * throw))
                .with_linear_velocity(random.vector() * throw)
                .with_rotation_vector(random.vector() * 3.0)
                .with_angular_momentum(random.vector() * spin);
            for _ in 0..3 {
                let before = stepper.energy(&state).total();
                let step = stepper.step(&mut state).unwrap();
                let after = stepper.energy(&state).total();
                assert!(after <= before, "{before:e} to {after:e} in {step:?}");
                assert!(
                    step.energy_removed <= 1e-13 * before,
                    "{step:?} of {before:e}"
                );
                flights += u32::from(step.elapsed > 0.01);
            }
        }
        flights
    }
    assert!(watch(Coin::ring(1.0, 0.5)) > 1000);
    assert!(watch(asymmetric) > 1000);
}

/// Numbers between -1 and 1 without a pattern.
struct Random(u64);

impl Random {
    fn number(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }
}

/// Number of steps from the end of a flight of so many seconds to the first touch-down.
fn steps_to_touch<I: Integrator>(stepper: &Stepper<'_, I>, start: State, flight: f64) -> u32 {
    let mut session = stepper.session(start);
    session.step_within(flight).unwrap();
    (1..100)
        .find(|_| {
            session.step().unwrap();
            stepper.touching(session.state()) > 0
        })
        .unwrap_or(100)
}

/// Checks that nothing touches within the first step of random tosses.
fn assert_flights_end_above_ground<B: RigidPointBody + Copy>(body: B, size: f64) {
    let mut random = Random(7);
    let mut flights = 0;
    for _ in 0..150 {
        let plane = Plane::through(random.vector(), random.vector() * 0.5 + DVec3::Z);
        let stepper = table(body, plane, Flight(StrangSplitting { time_step: 1e-4 }));
        let spin = 10.0_f64.powf(2.0 * random.number());
        let start = State::at(plane.normal * (plane.height + size * (1.2 + random.number().abs())))
            .with_linear_velocity(random.vector() * 4.0)
            .with_rotation_vector(random.vector() * 3.0)
            .with_angular_momentum(random.vector() * spin * body.inertia().x_axis.x);
        if stepper.touching(&start) > 0 {
            continue;
        }
        let step = stepper.session(start).step_within(5.0).unwrap();
        if step.elapsed < 3e-4 {
            continue;
        }
        flights += 1;
        for k in 0..=100 {
            let share = step.elapsed * f64::from(k) / 100.0;
            let mut session = stepper.session(start);
            session.step_within(share).unwrap();
            let gap = stepper.lowest_point(session.state()).unwrap().gap;
            assert!(gap > 0.0, "{gap:e} after {share} s of {} s", step.elapsed);
        }
    }
    assert!(flights > 100, "{flights}");
}

#[test]
fn no_flight_of_a_coin_goes_into_the_ground() {
    assert_flights_end_above_ground(Coin::ring(1.0, 0.5), 0.5);
}

#[test]
fn no_flight_of_a_lopsided_body_goes_into_the_ground() {
    let body = PointCloud::new(
        [
            DVec3::new(0.3, 0.0, 0.1),
            DVec3::new(-0.2, 0.3, 0.0),
            DVec3::new(0.0, -0.4, 0.2),
            DVec3::new(0.1, 0.1, -0.3),
        ],
        [0.4, 0.3, 0.2, 0.6],
    )
    .unwrap();
    assert_flights_end_above_ground(body, 0.5);
}

#[test]
fn the_first_step_of_a_toss_ends_within_two_steps_of_the_first_touch() {
    let stepper = table(
        Coin::ring(1.0, 0.5),
        level(),
        Flight(StrangSplitting { time_step: 1e-3 }),
    );
    let flight = stepper.session(toss()).step().unwrap();
    assert_eq!(flight.evaluations, 0);
    let left = steps_to_touch(&stepper, toss(), flight.elapsed);
    assert!(flight.elapsed > 1.0 && left <= 3, "{flight:?}, {left}");
}

#[test]
fn empty_space_takes_one_step_of_any_length() {
    let stepper = Stepper::new(Coin::ring(1.0, 0.5))
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(9.8)))
        .and_then(|stepper| stepper.with_integrator(Flight(EnergyMomentum { time_step: 1e-3 })))
        .unwrap();
    let (mut state, mut steps) = (toss(), 0);
    let mut count = |sample: &Sample<'_>| {
        steps = sample.step;
        ControlFlow::Continue(())
    };
    stepper.run(&mut state, 1000.0, &mut count).unwrap();
    assert_eq!(steps, 1);
    let z = 1.0 + 6.0 * 1000.0 - 4.9 * 1e6;
    assert!((state.position.z / z - 1.0).abs() < 1e-15);
    // Without a limit there is no end: the other method's own step.
    assert!(stepper.step(&mut state).unwrap().elapsed < 2e-3);
}

#[test]
fn a_body_with_three_moments_flies_for_any_number_of_revolutions() {
    let body = PointCloud::new(
        [DVec3::X, DVec3::Y * 0.7, DVec3::Z * -0.4, -DVec3::ONE],
        [0.4, 0.3, 0.2, 0.6],
    )
    .unwrap();
    let spin = 1e5 * body.inertia().x_axis.x;
    let stepper = Stepper::new(body)
        .and_then(|stepper| stepper.with_integrator(Flight(EnergyMomentum { time_step: 1e-3 })))
        .unwrap();
    let start = State::default().with_angular_momentum(DVec3::new(0.3, 0.8, 0.2) * spin);
    let mut session = stepper.session(start);
    let before = session.energy().total();
    let step = session.step_within(1e5).unwrap();
    let state = session.into_state();
    assert!((step.elapsed - 1e5).abs() < 1e-9);
    let end = stepper.free_rotation(&start).rotation_at(1e5).to_quat();
    assert_eq!(state.orientation, end);
    let after = stepper.energy(&state).total();
    // The limiter removes what rounding adds, some units in the last place.
    assert!(after <= before && after > before * (1.0 - 1e-14));
}

#[test]
fn flight_with_every_kind_of_method_keeps_the_contract() {
    let plan = CheckPlan::default();
    let time_step = 1e-3;
    check_integrator::<f64, _>(&Flight(StrangSplitting { time_step }), plan).unwrap();
    check_integrator::<f64, _>(&Flight(EnergyMomentum { time_step }), plan).unwrap();
    check_integrator::<f64, _>(&Flight(DormandPrince54::new(1e-6)), plan).unwrap();
    check_integrator::<f32, _>(&Flight(Rk4 { time_step: 1e-3 }), plan).unwrap();
}

#[test]
fn a_ball_flies_until_it_touches() {
    let ball = PointCloud::with_storage(
        [ContactPoint {
            position: DVec3::ZERO,
            radius: 0.1,
        }],
        &[1.0],
    )
    .unwrap();
    let stepper = table(ball, level(), Flight(DormandPrince54::new(1e-6)));
    let mut state = State::at(DVec3::Z);
    let step = stepper.step(&mut state).unwrap();
    let fall = (2.0_f64 * 0.9 / 9.8).sqrt();
    assert!((step.elapsed - fall).abs() < 1e-6, "{step:?}");
    assert_eq!(stepper.scene().touching(&state), 0);
    assert!(stepper.scene().bounding_radius() > 0.09);
}
