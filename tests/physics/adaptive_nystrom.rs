//! Tests of `AdaptiveNystrom`: the error follows the tolerance on scenes that chose no constant, a
//! contact within one step is not missed, and one tolerance costs less than with a pair that ends
//! its steps at touch-downs.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::common::methods::{Record, Setup, apart, method, truths};
use crate::kit;
use crate::kit::erased::Stepper;
use tumble::glam::{DQuat, DVec3};
use tumble::work_precision::reference;
use tumble::{
    AdaptiveNystrom, BogackiShampine32, Coin, Coulomb, Cuboid, Disc, DormandPrince54, FlatGround,
    Integrator, Nystrom, PointCloud, RigidPointBody, SolidCoin, State, Trial, UniformGravity,
};

/// 1e-3 to 1e-6 m, five a decade, so that none is met by luck.
fn tolerances() -> impl Iterator<Item = f64> {
    (0..16).map(|fifths| 10.0_f64.powf(-3.0 - f64::from(fifths) / 5.0))
}

fn trial(number: usize) -> Trial {
    Trial {
        slip_speed: 1e-3,
        ..Trial::report(number).unwrap()
    }
}

/// Least and largest error of the position up to 1 s, in tolerances.
fn errors(number: usize, truths: &[Record]) -> [f64; 2] {
    let (mut least, mut largest) = (f64::MAX, 0.0);
    for tolerance in tolerances() {
        let stepper = trial(number)
            .stepper(AdaptiveNystrom::new(tolerance))
            .unwrap();
        let (mut state, mut time, mut worst) = (trial(number).state(), 0.0, 0.0_f64);
        for truth in truths {
            stepper.advance(&mut state, truth.time - time).unwrap();
            time = truth.time;
            worst = worst.max(apart(&state, &truth.state).place);
        }
        let ratio = worst / tolerance;
        (least, largest) = (ratio.min(least), ratio.max(largest));
    }
    println!("trial {number}: errors of {least:.3} to {largest:.2} tolerances");
    [least, largest]
}

/// The lower limits are far below 1, because the estimate is an upper bound where friction sticks
/// and where errors of different signs cancel.
#[test]
fn the_error_of_a_run_is_at_most_five_tolerances_in_the_trials_that_chose_the_constants() {
    for number in [1, 3, 5, 8] {
        let [least, largest] = errors(number, &truths(number, 1e-3, 1.0));
        assert!(least >= 0.002 && largest <= 5.0, "{least} to {largest}");
    }
}

/// The truth is a run with steps of 10 µs, which is accurate to 2e-10 m. No constant of the
/// estimate was chosen on these trials, but its form was compared on them.
#[test]
fn the_error_of_a_run_is_at_most_five_tolerances_in_trials_that_chose_no_constant() {
    for number in [2, 4, 6, 7] {
        let times = [0.1, 0.25, 0.5, 1.0];
        let truths = method("Nystrom").records(&Setup::trial(number, 1e-3), 1e-5, &times);
        let [least, largest] = errors(number, &truths);
        assert!(least >= 0.02 && largest <= 5.0, "{least} to {largest}");
    }
}

/// Error of the position of any point of the body at the end of a toss of 0.4 s with bounces, in
/// tolerances.
fn error_of_toss<B: RigidPointBody + Clone>(
    body: B,
    carrying: f64,
    spin: DVec3,
    tolerance: f64,
) -> f64 {
    let stiffness = body.mass() * 9.8 / (2e-5 * carrying);
    let body: &dyn RigidPointBody = &body;
    let stepper = Stepper::new(body)
        .and_then(|stepper| {
            let damping = 0.42 * (stiffness * body.mass()).sqrt();
            stepper.with_ground(FlatGround::level(stiffness, damping))
        })
        .and_then(|stepper| {
            stepper.with_friction(Coulomb {
                coefficient: 0.3,
                slip_speed: 1e-3,
            })
        })
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(9.8)))
        .and_then(|stepper| stepper.with_integrator(AdaptiveNystrom::new(tolerance)))
        .unwrap();
    let start = State::at(DVec3::Z * 0.07)
        .with_linear_velocity(DVec3::new(0.2, -0.3, 0.1))
        .with_rotation_vector(DVec3::new(0.4, 0.7, -0.2));
    let start = stepper.with_angular_velocity(start, spin);
    let truth = reference(stepper.scene(), &start, 0.4).unwrap();
    // A hundredth of the finest tolerance.
    assert!(truth.resolution < 1e-7, "{:e}", truth.resolution);
    let mut state = start;
    stepper.advance(&mut state, 0.4).unwrap();
    let angle = kit::angle_between(state.orientation, truth.end.orientation);
    let rim = stepper.body().bounding_radius() * angle;
    (state.position - truth.end.position).length().hypot(rim) / tolerance
}

#[test]
fn the_error_of_a_toss_with_bounces_is_at_most_five_tolerances() {
    for spin in [DVec3::new(5.0, 30.0, -9.0), DVec3::new(-14.0, 6.0, 33.0)] {
        for tolerance in [1e-3, 1e-4, 1e-5] {
            let coin = error_of_toss(SolidCoin::new(4.93e-3, 0.01, 0.002), 120.0, spin, tolerance);
            let die = error_of_toss(Cuboid::cube(4.8e-3, 0.016), 4.0, spin, tolerance);
            println!("{tolerance:e} m: coin {coin:.4}, die {die:.4} tolerances");
            assert!(coin <= 5.0 && die <= 5.0, "{coin}, {die}");
        }
    }
}

/// A rod that rotates above ground touches it with one end twice a revolution, for 25 ms. Both ends
/// of a step of 0.1 s, and its stages, may be above ground.
#[test]
fn a_contact_that_closes_and_opens_within_one_step_is_not_missed() {
    let rod = PointCloud::new([DVec3::X * 0.5, DVec3::X * -0.5], [0.5, 0.5]).unwrap();
    let run = |stepper: &dyn Fn(&mut State), start: &State| {
        let mut state = *start;
        stepper(&mut state);
        state.linear_velocity.z
    };
    let scene = Stepper::new(rod)
        .and_then(|stepper| stepper.with_ground(FlatGround::level(1e4, 1.0)))
        .unwrap();
    let start = State::at(DVec3::Z * 0.499);
    let start = scene.with_angular_velocity(start, DVec3::Y * 5.0);
    let fine = scene.with_integrator(Nystrom { time_step: 1e-5 }).unwrap();
    let truth = run(&|state| fine.advance(state, 0.8).unwrap(), &start);
    assert!(truth > 0.05, "{truth} m/s");
    for tolerance in [1e-2, 1e-4] {
        let adaptive = scene
            .with_integrator(AdaptiveNystrom::new(tolerance))
            .unwrap();
        let speed = run(&|state| adaptive.advance(state, 0.8).unwrap(), &start);
        assert!(
            (speed - truth).abs() < 0.05 * truth,
            "{speed} m/s, not {truth} m/s"
        );
    }
}

/// A step leaves out the phase error of a uniform rotation, `z⁵/720` with `z = |ω| h/2`, up to
/// terms of `z⁹`. Without that, the ten steps of this second would rotate the body too little by
/// 4e-4 rad.
#[test]
fn a_uniform_rotation_takes_the_longest_steps_and_keeps_its_phase() {
    let integrator = AdaptiveNystrom::new(1e-4);
    let stepper = Stepper::new(Coin::ring(1.0, 0.5))
        .and_then(|stepper| stepper.with_integrator(integrator))
        .unwrap();
    let start = stepper.with_angular_velocity(State::default(), DVec3::X * 10.0);
    let mut session = stepper.session(start);
    let (mut left, mut steps) = (1.0, 0);
    while left > 1e-12 {
        left -= session.step_within(left).unwrap().elapsed;
        steps += 1;
    }
    let state = session.into_state();
    let exact: State = State::default().with_rotation_vector(DVec3::X * 10.0);
    let between: DQuat = state.orientation * exact.orientation.conjugate();
    let angle = 2.0 * between.xyz().length();
    println!("{steps} steps, wrong by {angle:e} rad");
    // Steps of 0.1 s have z = 0.5. The first ones are shorter. The terms of z⁹ are 3e-5 z⁹ each.
    assert!(steps <= 20 && angle < 3e-6, "{steps} steps, {angle:e} rad");
}

/// A coin that spins upright on the spot stands on a point that hardly slips. Explicit steps above
/// 0.6 ms amplify the rounding of its slip at the first slip speed, and above 0.6 µs at the second
/// one. Trials 4 and 6 have chosen no constant.
#[test]
fn the_cost_of_spinning_on_the_spot_does_not_depend_on_the_slip_speed() {
    for number in [4, 6] {
        for slip_speed in [1e-3, 1e-6] {
            let trial = Trial {
                slip_speed,
                ..Trial::report(number).unwrap()
            };
            let (end, evaluations) = end_of(&trial, AdaptiveNystrom::new(1e-4));
            let (tighter, _) = end_of(&trial, AdaptiveNystrom::new(1e-5));
            let error = apart(&end, &tighter).place;
            println!("trial {number}, {slip_speed:e} m/s: {evaluations}, {error:e} m");
            assert!(evaluations <= 700, "{evaluations}");
            assert!(error < 1e-4, "{error:e} m");
        }
    }
}

/// The slip of a round rim that spins on the spot reverses within the arc that touches. Limited
/// friction would take that arc for a contact that hardly slips, and a thousand times as many
/// steps.
#[test]
fn a_round_rim_spins_on_the_spot_in_few_more_steps_at_a_small_slip_speed() {
    let upright = DQuat::from_rotation_x(core::f64::consts::FRAC_PI_2);
    for (radius, turns) in [(0.01, 300.0), (0.05, 60.0), (0.2, 9.0)] {
        for tolerance in [1e-2 * radius, 1e-4 * radius] {
            let steps = [1e-3, 1e-7].map(|slip_speed| {
                let stepper = Stepper::builder(Disc::solid(0.02, radius, 60))
                    .gravity(UniformGravity::down(9.8))
                    .ground(FlatGround::level(5e3, 0.5))
                    .friction(Coulomb {
                        coefficient: 0.4,
                        slip_speed,
                    })
                    .integrator(AdaptiveNystrom::new(tolerance))
                    .build()
                    .unwrap();
                let start = State::at(DVec3::Z * radius).with_orientation(upright);
                let start = stepper.with_angular_velocity(start, DVec3::Z * turns);
                let mut session = stepper.session(start);
                session.advance(1.0).unwrap();
                session.step_count()
            });
            assert!(
                steps[1] <= 2 * steps[0],
                "{radius} m, {tolerance:e}: {steps:?}"
            );
        }
    }
}

/// A first stage with limited friction is evaluated again for each step size, so a session that is
/// saved and knows only the next step size continues with the same bits.
#[test]
fn a_spin_on_the_spot_continues_with_the_same_bits_from_its_step_control() {
    let trial = trial(6);
    let stepper = trial.stepper(AdaptiveNystrom::new(1e-4)).unwrap();
    let mut session = stepper.session(trial.state());
    for _ in 0..40 {
        session.step().unwrap();
        let (mut kept, mut resumed) = (session.clone(), stepper.resume(&session.save()).unwrap());
        let first = kept.step().unwrap();
        let second = resumed.step().unwrap();
        assert_eq!(
            first.elapsed.to_bits(),
            second.elapsed.to_bits(),
            "{first:?}"
        );
        assert_eq!(kept.state(), resumed.state());
    }
}

/// Force evaluations of a second of a trial.
fn evaluations<I: Integrator>(number: usize, integrator: I) -> f64 {
    f64::from(end_of(&trial(number), integrator).1)
}

/// State after a second of a trial, and the number of force evaluations.
fn end_of<I: Integrator>(trial: &Trial, integrator: I) -> (State, u32) {
    let stepper = trial.stepper(integrator).unwrap();
    let mut session = stepper.session(trial.state());
    let (mut left, mut evaluations) = (1.0, 0);
    while left > 1e-12 {
        let step = session.step_within(left).unwrap();
        left -= step.elapsed;
        evaluations += step.evaluations;
    }
    (session.into_state(), evaluations)
}

/// The errors of the pairs are up to ten tolerances, and those of `AdaptiveNystrom` up to five.
/// With the tolerances for one error, it needs less than 0.8 of their evaluations, as the geometric
/// mean over all eight trials.
#[test]
fn one_tolerance_costs_less_than_steps_that_end_at_touch_downs() {
    for error in [1e-3, 1e-4] {
        let mean = |of: &dyn Fn(usize) -> f64| {
            let sum: f64 = (1..=8).map(|number| of(number).ln()).sum();
            (sum / 8.0).exp()
        };
        let ours = mean(&|number| evaluations(number, AdaptiveNystrom::new(error / 5.0)));
        let bogacki = mean(&|number| evaluations(number, BogackiShampine32::new(error / 10.0)));
        let dormand = mean(&|number| evaluations(number, DormandPrince54::new(error / 10.0)));
        println!("{error:e} m: {ours:.0}, pairs {bogacki:.0} and {dormand:.0} evaluations");
        assert!(ours < 0.8 * bogacki && ours < 0.8 * dormand, "{ours}");
    }
}
