//! Tests of `AdaptiveEnergyMomentum`: the energy never increases, the error follows the tolerance
//! on scenes that no constant was chosen on, and every run ends.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::common::methods::{Setup, apart, convergence, method, truths};
use crate::kit::erased::Stepper;
use crate::kit::once::Once;
use crate::kit::{self, log_uniform, zero_or};
use core::ops::ControlFlow;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use tumble::glam::{DVec3, Vec3};
use tumble::real::{Quaternion, Vector};
use tumble::work_precision::reference;
use tumble::{
    AdaptiveEnergyMomentum, Capsule, Coin, Coulomb, Cuboid, Disc, DormandPrince54, Ellipsoid,
    EnergyMomentum, FlatGround, FrictionField, Integrator, Ledger, MovingGround, Plane, Real,
    RigidPointBody, Sample, SolidCoin, Sphere, State, Step, StepError, Trial, UniformGravity,
};

/// 1e-2 to 1e-5 m, three a decade, so that none is met by luck.
fn tolerances() -> impl Iterator<Item = f64> {
    (0..10).map(|thirds| 10.0_f64.powf(-2.0 - f64::from(thirds) / 3.0))
}

fn trial(number: usize) -> Trial {
    Trial {
        slip_speed: 1e-3,
        ..Trial::report(number).unwrap()
    }
}

// -----------------------------------------------------------------------------------------------
// Error and tolerance
// -----------------------------------------------------------------------------------------------

/// Errors over tolerances of one trial, against its true states up to 1 s.
fn ratios(number: usize, truths: &[(f64, State)]) -> Vec<(f64, f64)> {
    let ratio = |tolerance| {
        let method = AdaptiveEnergyMomentum::new(tolerance);
        let stepper = trial(number).stepper(method).unwrap();
        let (mut session, mut worst) = (stepper.session(trial(number).state()), 0.0_f64);
        for (time, truth) in truths {
            session.advance(time - session.time()).unwrap();
            worst = worst.max(apart(session.state(), truth).place);
        }
        worst / tolerance
    };
    tolerances().map(|t| (t, ratio(t))).collect()
}

/// The scenes on which the horizon and the fraction of the tolerance were chosen.
#[test]
fn the_error_follows_the_tolerance_in_the_trials_that_the_constants_were_chosen_on() {
    for number in [1, 3, 5, 8] {
        let truths: Vec<_> = (truths(number, 1e-3, 1.0).iter())
            .map(|truth| (truth.time, truth.state))
            .collect();
        let ratios = ratios(number, &truths);
        println!("trial {number}: {ratios:.3?}");
        for (tolerance, ratio) in &ratios {
            let is_near = (0.02..=2.0).contains(ratio);
            assert!(is_near, "trial {number}: {ratio} of {tolerance:e} m");
        }
        // Longest steps bound the error of the loosest tolerances.
        let fine: Vec<_> = (ratios.iter().skip(3)).map(|(t, r)| (*t, r * t)).collect();
        let slope = convergence(&fine);
        assert!(
            (slope - 1.0).abs() < 0.15,
            "trial {number}: error goes as tolerance^{slope:.2}"
        );
    }
}

/// Upper bound of the error over the tolerance after a second, in scenes that chose no constant.
///
/// It is derived from the number of steps. A step adds at most `0.3 tolerance √(tolerance/r)`, in
/// position and rotation. A motion with the rate `w` (rad/s) needs steps with
/// `(w h)³/48 <= 0.3 (tolerance/r)^1.5`, so a second has `w/2.4 √(r/tolerance)` of them, and their
/// errors add up to `w/8` tolerances: 5 at 40 rad/s, the fastest rotation of the trials. Errors of
/// velocities that grow by more than five in a second are not contained in it.
const MOST: f64 = 5.0;

#[test]
fn the_error_is_five_tolerances_at_most_in_the_other_trials() {
    let times = [0.1, 0.25, 0.5, 1.0];
    for number in [2, 4, 6, 7] {
        let truths = method("Nystrom").records(&Setup::trial(number, 1e-3), 1e-5, &times);
        let truths: Vec<_> = truths.iter().map(|t| (t.time, t.state)).collect();
        let ratios = ratios(number, &truths);
        println!("trial {number}: {ratios:.3?}");
        for (tolerance, ratio) in ratios {
            let is_near = (0.01..=MOST).contains(&ratio);
            assert!(is_near, "trial {number}: {ratio} of {tolerance:e} m");
        }
    }
}

/// Largest and smallest error over tolerance of a scene at its end.
fn ratios_of<B: RigidPointBody + Copy>(
    body: B,
    (ground, friction): (FlatGround, Coulomb),
    start: &State,
    seconds: f64,
) -> Vec<f64> {
    let body: &dyn RigidPointBody = &body;
    let composed = |tolerance| {
        Stepper::builder(body)
            .gravity(UniformGravity::down(9.8))
            .ground(ground)
            .friction(friction)
            .integrator(AdaptiveEnergyMomentum::new(tolerance))
            .build()
            .unwrap()
    };
    let scene = composed(1e-3);
    let size = scene.body().bounding_radius();
    let truth = reference(scene.scene(), start, seconds).unwrap();
    // A hundredth of the finest tolerance.
    assert!(truth.resolution < 1e-7, "{:e}", truth.resolution);
    let ratio = |tolerance| {
        let mut state = *start;
        composed(tolerance).advance(&mut state, seconds).unwrap();
        let angle = kit::angle_between(state.orientation, truth.end.orientation);
        (state.position - truth.end.position)
            .length()
            .hypot(size * angle)
            / tolerance
    };
    tolerances().map(ratio).collect()
}

/// Throws of the robust protocol of `benches/work_precision`: height (m), velocity (m/s), angular
/// velocity (rad/s), and lean (rad).
fn throws() -> [(f64, DVec3, DVec3, f64); 4] {
    let v = DVec3::new;
    [
        (0.12, v(0.3, 0.1, 0.4), v(3.0, 41.0, -7.0), 0.3),
        (0.08, v(-0.5, 0.2, 0.0), v(12.0, -18.0, 25.0), 1.1),
        (0.15, v(0.1, 0.6, 0.9), v(-2.0, 9.0, 60.0), -0.6),
        (0.05, v(0.8, 0.0, -0.2), v(30.0, 4.0, -11.0), 2.0),
    ]
}

/// Errors of the four throws of a body that sinks 20 µm at rest on `carrying` contacts.
fn tosses<B: RigidPointBody + Copy>(name: &str, body: B, carrying: f64) {
    let mass = body.mass();
    let stiffness = mass * 9.8 / (2e-5 * carrying);
    let damping = 2.0 * 0.21 * (stiffness * mass).sqrt();
    let friction = Coulomb {
        coefficient: 0.3,
        slip_speed: 1e-3,
    };
    let ground = FlatGround::level(stiffness, damping);
    let free = Stepper::new(body).unwrap();
    for (height, velocity, spin, lean) in throws() {
        let start = State::at(DVec3::Z * height)
            .with_linear_velocity(velocity)
            .with_rotation_vector(DVec3::Y * lean);
        let start = free.with_angular_velocity(start, spin);
        let ratios = ratios_of(body, (ground, friction), &start, 0.4);
        println!("{name}: {ratios:.3?}");
        assert!(ratios.iter().all(|r| *r <= MOST), "{name}: {ratios:?}");
        assert!(ratios.iter().all(|r| *r > 0.0), "{name}: {ratios:?}");
    }
}

#[test]
fn the_error_is_five_tolerances_at_most_in_tosses_of_a_coin_and_of_a_die() {
    tosses("coin", SolidCoin::new(4.93e-3, 0.01, 0.002), 120.0);
    tosses("die", Cuboid::cube(4.8e-3, 0.016), 4.0);
}

/// A step that `EnergyMomentum` divides into two halves equals two steps of half the size. Their
/// difference is 0, and the step was accepted with a wrong bounce.
#[test]
fn a_step_that_was_divided_into_its_own_halves_is_no_estimate() {
    let coin = SolidCoin::new(4.93e-3, 0.01, 0.002);
    // So hard that some steps have no solution as a whole.
    let stiffness = 4.93e-3 * 9.8 / (2e-7 * 120.0);
    let ground = FlatGround::level(stiffness, 0.42 * (stiffness * 4.93e-3).sqrt());
    let friction = Coulomb {
        coefficient: 0.3,
        slip_speed: 1e-3,
    };
    let scene = Stepper::builder(&coin as &dyn RigidPointBody)
        .gravity(UniformGravity::down(9.8))
        .ground(ground)
        .friction(friction)
        .build()
        .unwrap();
    let mut divided = 0;
    for number in 0..400 {
        let part = |factor: i32| f64::from(number * factor % 101) / 101.0;
        let start = State::at(DVec3::Z * (0.004 + 0.01 * part(13)))
            .with_linear_velocity(DVec3::new(0.3, 0.1, -2.0 * part(29)))
            .with_rotation_vector(DVec3::new(3.0 * part(7), 3.0 * part(17), 0.4));
        let spin = DVec3::new(20.0 * part(3) - 10.0, 50.0 * part(5) - 25.0, 9.0);
        let start = scene.with_angular_velocity(start, spin);
        for time_step in [0.01, 0.005, 0.0025] {
            let after = |time_step: f64, state: &State| {
                let method = Once(EnergyMomentum { time_step });
                let stepper = scene.with_integrator(method).unwrap();
                let mut state = *state;
                let step = stepper.step(&mut state).unwrap();
                (state, step.fallback)
            };
            let (whole, fallback) = after(time_step, &start);
            let (middle, _) = after(0.5 * time_step, &start);
            if !fallback || whole != after(0.5 * time_step, &middle).0 {
                continue;
            }
            divided += 1;
            let method = AdaptiveEnergyMomentum {
                longest_step: time_step,
                ..AdaptiveEnergyMomentum::new(1e-3)
            };
            let mut state = start;
            let adaptive = scene.with_integrator(method).unwrap();
            let step = adaptive.step(&mut state).unwrap();
            let is_taken_whole = step.elapsed >= time_step && step.error_estimate == Some(0.0);
            assert!(!is_taken_whole, "start {number}, {time_step} s");
        }
    }
    assert!(divided > 0, "no step was divided");
}

#[test]
fn the_error_is_five_tolerances_at_most_where_a_ball_begins_to_roll() {
    let (mass, radius, stiffness) = (0.2, 0.03, 1e5);
    let ground = FlatGround::level(stiffness, 10.0);
    let friction = Coulomb {
        coefficient: 0.3,
        slip_speed: 1e-3,
    };
    let start = State::at(DVec3::Z * (radius - mass * 9.8 / stiffness))
        .with_linear_velocity(DVec3::X)
        .with_angular_momentum(DVec3::Z * 1e-3);
    let ratios = ratios_of(Sphere::solid(mass, radius), (ground, friction), &start, 1.0);
    println!("ball: {ratios:.3?}");
    assert!(
        ratios.iter().all(|r| (0.01..=MOST).contains(r)),
        "{ratios:?}"
    );
}

/// Scenes that were first run after the constants had been fixed, with that of a round rim below.
#[test]
fn the_error_is_five_tolerances_at_most_in_scenes_seen_after_the_choice() {
    let v = DVec3::new;
    let egg = Ellipsoid::solid(0.06, v(0.022, 0.022, 0.028));
    let capsule = Capsule::solid(0.3, 0.02, 0.1);
    let brick = Cuboid::solid(1.5, v(0.2, 0.1, 0.06));
    let scenes = [
        ("egg", later(egg, [5e3, 2.0], 0.06, v(2e-4, 1e-4, -3e-4))),
        (
            "capsule",
            later(capsule, [2e4, 10.0], 0.12, v(1e-3, -2e-3, 5e-4)),
        ),
        (
            "brick",
            later(brick, [8e3, 40.0], 0.2, v(0.01, 0.03, -0.02)),
        ),
    ];
    for (name, ratios) in scenes {
        println!("{name}: {ratios:.3?}");
        let is_near = |ratio: &f64| *ratio > 0.0 && *ratio <= MOST;
        assert!(ratios.iter().all(is_near), "{name}: {ratios:?}");
    }
}

/// Position of a point mass that slides along x over ground whose friction jumps at `border` (m),
/// after `seconds`. It starts at 0 with `speed`, and does not stop.
fn across_a_border(border: f64, [before, after]: [f64; 2], speed: f64, seconds: f64) -> f64 {
    let decelerations = [before * 9.8, after * 9.8];
    let at_border = (speed * speed - 2.0 * decelerations[0] * border).sqrt();
    let time = seconds - (speed - at_border) / decelerations[0];
    border + (at_border - decelerations[1] * time / 2.0) * time
}

/// The halves of a step take the friction at a quarter and at three quarters of its path. Steps of
/// up to 10 ms, and 40 borders of unequal places in them: before friction was compared at the ends
/// too, the error was up to 200 times a tolerance of 1e-5 m, and 2000 times one of 1e-6 m.
#[test]
fn the_error_is_one_tolerance_at_most_where_friction_jumps() {
    let (stiffness, speed, seconds) = (1e4, 2.0, 0.4);
    for coefficients in [[0.1, 0.4], [0.4, 0.1]] {
        for (tolerance, number) in tolerances().flat_map(|t| (0..40).map(move |n| (t, n))) {
            let border = 0.2 + 0.0037 * f64::from(number);
            let friction = FrictionField::new(move |position: DVec3| Coulomb {
                coefficient: coefficients[usize::from(position.x >= border)],
                slip_speed: 1e-6,
            });
            let stepper = Stepper::builder(kit::point_mass(1.0))
                .gravity(UniformGravity::down(9.8))
                .ground(FlatGround::level(stiffness, 10.0))
                .friction(friction)
                .integrator(AdaptiveEnergyMomentum::new(tolerance))
                .build()
                .unwrap();
            let mut state =
                State::at(DVec3::Z * (-9.8 / stiffness)).with_linear_velocity(DVec3::X * speed);
            stepper.advance(&mut state, seconds).unwrap();
            let truth = across_a_border(border, coefficients, speed, seconds);
            let error = (state.position.x - truth).abs();
            assert!(
                error <= tolerance,
                "{coefficients:?}, {border} m: {error:e} m with a tolerance of {tolerance:e} m"
            );
        }
    }
}

/// Bodies that turn, of contacts that are fixed in them and of one that moves, against a tolerance
/// of a 300th. Before, boxes had up to 6 tolerances and balls up to 17.
#[test]
fn the_error_is_one_tolerance_at_most_where_turning_bodies_cross_a_border() {
    let edges = DVec3::new(0.1, 0.07, 0.05);
    for number in 0..12 {
        let border = 0.15 + 0.0123 * f64::from(number);
        let coefficients = [[0.1, 0.4], [0.4, 0.1]][number as usize % 2];
        let box_ends = |tolerance| {
            end_beyond(
                Cuboid::solid(1.0, edges),
                0.025,
                tolerance,
                (border, coefficients),
            )
        };
        let ball_ends = |tolerance| {
            end_beyond(
                Sphere::solid(1.0, 0.1),
                0.1,
                tolerance,
                (border, coefficients),
            )
        };
        for tolerance in [1e-3, 1e-4, 1e-5] {
            for ends in [&box_ends as &dyn Fn(f64) -> DVec3, &ball_ends] {
                let error = (ends(tolerance) - ends(tolerance / 300.0)).length();
                assert!(
                    error <= tolerance,
                    "{border} m: {error:e} m of {tolerance:e} m"
                );
            }
        }
    }
}

/// Position after 0.3 s of a body that slides and turns over a border of friction.
fn end_beyond<B: RigidPointBody + Copy>(
    body: B,
    height: f64,
    tolerance: f64,
    (border, coefficients): (f64, [f64; 2]),
) -> DVec3 {
    let friction = FrictionField::new(move |position: DVec3| Coulomb {
        coefficient: coefficients[usize::from(position.x >= border)],
        slip_speed: 1e-4,
    });
    let stepper = Stepper::builder(body)
        .gravity(UniformGravity::down(9.8))
        .ground(FlatGround::level(1e4, 10.0))
        .friction(friction)
        .integrator(AdaptiveEnergyMomentum::new(tolerance))
        .build()
        .unwrap();
    let contacts = if body.contacts().len() == 1 { 1.0 } else { 4.0 };
    let mut state = State::at(DVec3::Z * (height - 9.8 / (1e4 * contacts)))
        .with_linear_velocity(DVec3::new(2.0, 0.3, 0.0))
        .with_angular_momentum(
            DVec3::new(0.01, -0.02, 0.02) * (contacts - 4.0).abs() + DVec3::Z * 0.003,
        );
    stepper.advance(&mut state, 0.3).unwrap();
    state.position
}

/// On a round rim on which friction reverses, the rule of eight points has an error that no
/// tolerance reduces. So the first four tolerances are met, down to a millimetre. An error of 1e-3
/// of the load (see `Disc`) bounds the rest: the bounce changes the velocity by some 4 m/s, and
/// 4 mm/s for 0.4 s are 1.6 mm.
#[test]
fn the_error_has_a_floor_on_a_round_rim_on_which_friction_reverses() {
    let disc = Disc::solid(0.4, 0.15, 64);
    let ratios = later(disc, [500.0, 0.2], 0.2, DVec3::new(0.02, 0.05, 0.01));
    println!("round disc: {ratios:.3?}");
    assert!(ratios[..4].iter().all(|r| *r <= MOST), "{ratios:?}");
    for (tolerance, ratio) in tolerances().zip(&ratios) {
        assert!(ratio * tolerance <= 1.6e-3 + MOST * tolerance, "{ratios:?}");
    }
}

/// Errors over tolerances of a throw onto level ground (N/m, N s/m), from a height (m), after
/// half a second.
fn later<B: RigidPointBody + Copy>(
    body: B,
    [stiffness, damping]: [f64; 2],
    height: f64,
    angular_momentum: DVec3,
) -> Vec<f64> {
    let friction = Coulomb {
        coefficient: 0.5,
        slip_speed: 1e-3,
    };
    let start = State::at(DVec3::Z * height)
        .with_linear_velocity(DVec3::new(0.7, -0.3, -0.5))
        .with_rotation_vector(DVec3::new(0.4, -0.9, 0.2))
        .with_angular_momentum(angular_momentum);
    let ground = FlatGround::level(stiffness, damping);
    ratios_of(body, (ground, friction), &start, 0.5)
}

// -----------------------------------------------------------------------------------------------
// Euler's disk
// -----------------------------------------------------------------------------------------------

/// Time (s) in which a ring of the coin report that spins at 0.2 rad falls to 0.02 rad, as in the
/// example `eulers_disk`.
fn spin_down<I: Integrator>(integrator: I) -> f64 {
    let (radius, first, gravity) = (0.5, 0.2_f64, 9.8);
    let coin = Coin::ring(1.0, radius);
    let stepper = Stepper::builder(coin)
        .gravity(UniformGravity::down(gravity))
        .ground(FlatGround::level(1000.0, 0.5))
        .integrator(integrator)
        .build()
        .unwrap();
    let turn = DVec3::Y * (first - core::f64::consts::FRAC_PI_2);
    let turned = State::at(DVec3::Z * radius * first.sin()).with_rotation_vector(turn);
    let normal = turned.rotation().axes().x;
    let rate = (2.0 * gravity / (radius * first.sin())).sqrt();
    let mut state = stepper.with_angular_velocity(turned, (DVec3::Z - normal * normal.z) * rate);
    let mut flat = None;
    let mut watch = |sample: &Sample<'_>| {
        flat = (coin.tilt(sample.state) <= 0.02).then_some(sample.time);
        match flat {
            Some(_) => ControlFlow::Break(()),
            None => ControlFlow::Continue(()),
        }
    };
    stepper.run(&mut state, 40.0, &mut watch).unwrap();
    flat.unwrap()
}

#[test]
fn eulers_disk_spins_down_within_two_percent_with_a_tolerance_of_a_millimetre() {
    // The tolerance of the reference has moved the result by 1e-3 or less at ten times its size.
    let [truth, coarse] = [1e-7, 1e-6].map(|t| spin_down(DormandPrince54::new(t)));
    assert!((coarse / truth - 1.0).abs() < 1e-3, "{coarse} s, {truth} s");
    for tolerance in [1e-3, 5e-4, 2e-4, 1e-4] {
        let time = spin_down(AdaptiveEnergyMomentum::new(tolerance));
        println!("{tolerance:e} m: {time:.3} s of {truth:.3} s");
        assert!((time / truth - 1.0).abs() < 0.02, "{time} s, {truth} s");
    }
    let too_long = spin_down(EnergyMomentum { time_step: 2e-2 });
    println!("steps of 20 ms: {too_long:.3} s");
    assert!((too_long / truth - 1.0).abs() > 0.02, "{too_long} s");
}

// -----------------------------------------------------------------------------------------------
// The estimate
// -----------------------------------------------------------------------------------------------

/// In smooth motion the estimate is the error of the step: it is compared with the difference to
/// steps of a sixteenth, whose own error is smaller by a factor of 256.
#[test]
fn the_estimate_of_a_smooth_step_is_its_error() {
    for h in [4e-3, 2e-3, 1e-3] {
        let fixed = AdaptiveEnergyMomentum {
            longest_step: h,
            ..AdaptiveEnergyMomentum::new(1e30)
        };
        let ball = |integrator| {
            Stepper::builder(Sphere::solid(1.0, 0.1))
                .gravity(UniformGravity::down(9.8))
                .ground(FlatGround::level(1000.0, 1.0))
                .integrator(integrator)
                .build()
                .unwrap()
        };
        // In contact throughout, in the middle of an oscillation.
        let start = State::at(DVec3::Z * 0.08).with_linear_velocity(DVec3::new(0.2, 0.0, 0.3));
        let mut end = start;
        let step = ball(fixed).step(&mut end).unwrap();
        assert!((step.elapsed - h).abs() <= 0.0 && step.rejected == 0);
        let mut truth = start;
        let fine = Stepper::builder(Sphere::solid(1.0, 0.1))
            .gravity(UniformGravity::down(9.8))
            .ground(FlatGround::level(1000.0, 1.0))
            .integrator(EnergyMomentum {
                time_step: h / 32.0,
            })
            .build()
            .unwrap();
        fine.advance(&mut truth, h).unwrap();
        let position = (end.position - truth.position).length();
        let velocity = (end.linear_velocity - truth.linear_velocity).length();
        let ratio = step.error_estimate.unwrap() / (position + 0.2 * velocity);
        println!("{h} s: estimate over error {ratio:.4}");
        assert!((ratio - 1.0).abs() < 0.05, "{h} s: {ratio}");
    }
}

#[test]
fn methods_without_an_estimate_state_none_and_the_pairs_state_theirs() {
    let mut state = trial(1).state();
    let fixed = trial(1)
        .stepper(EnergyMomentum { time_step: 1e-3 })
        .unwrap();
    assert_eq!(fixed.step(&mut state).unwrap().error_estimate, None);
    let tolerance = 1e-5;
    let pair = trial(1).stepper(DormandPrince54::new(tolerance)).unwrap();
    let estimate = pair.step(&mut state).unwrap().error_estimate.unwrap();
    assert!(estimate >= 0.0 && estimate <= 0.65 * tolerance + 1e-13);
}

// -----------------------------------------------------------------------------------------------
// Promises
// -----------------------------------------------------------------------------------------------

/// A random scene: a box or a coin thrown on level ground, at rest or moving.
#[derive(Clone, Debug)]
struct Case {
    mass: f64,
    sides: [f64; 3],
    is_coin: bool,
    /// Frequency (1/s) of the mass on one contact, and its damping ratio.
    contact: (f64, f64),
    friction: Coulomb,
    /// Velocity of the ground, m/s.
    belt: f64,
    height: f64,
    velocity: DVec3,
    spin: DVec3,
    method: AdaptiveEnergyMomentum,
    limits: [f64; 2],
}

fn scenes() -> impl Strategy<Value = Case> {
    let vectors = |largest| (kit::directions(), zero_or(1e-3, largest)).prop_map(|(d, s)| d * s);
    let side = || log_uniform(5e-3, 1.0);
    let body = (
        log_uniform(1e-3, 10.0),
        [side(), side(), side()],
        any::<bool>(),
    );
    let contact = (log_uniform(10.0, 1e4), zero_or(1e-2, 2.0));
    let friction = (zero_or(0.05, 1.5), log_uniform(1e-6, 1e-1));
    let motion = (-0.1..1.0, vectors(10.0), vectors(50.0));
    let method = (log_uniform(1e-5, 0.1), log_uniform(1e-3, 0.05));
    let drive = (zero_or(1e-2, 5.0), log_uniform(1e-6, 1.0));
    (body, contact, friction, motion, method, drive).prop_map(
        |(body, contact, friction, motion, (tolerance, longest_step), (belt, limit))| Case {
            mass: body.0,
            sides: body.1,
            is_coin: body.2,
            contact,
            friction: Coulomb {
                coefficient: friction.0,
                slip_speed: friction.1,
            },
            belt,
            height: motion.0,
            velocity: motion.1,
            spin: motion.2,
            method: AdaptiveEnergyMomentum {
                tolerance,
                longest_step,
                budget: 5_000,
            },
            limits: [f64::from(f32::MAX), limit],
        },
    )
}

impl Case {
    fn keeps_its_promises<R: Real>(&self) -> Result<bool, TestCaseError> {
        let [mass, a, b, c] =
            [self.mass, self.sides[0], self.sides[1], self.sides[2]].map(R::from_f64);
        if self.is_coin {
            self.with_body(Coin::<R>::ring(mass, a))
        } else {
            self.with_body(Cuboid::solid(mass, R::Vec3::new(a, b, c)))
        }
    }

    fn with_body<R: Real, B: RigidPointBody<R>>(&self, body: B) -> Result<bool, TestCaseError> {
        let real = R::from_f64;
        let vector = |v: DVec3| R::Vec3::new(real(v.x), real(v.y), real(v.z));
        let (frequency, ratio) = self.contact;
        let stiffness = self.mass * frequency * frequency;
        let damping = 2.0 * ratio * self.mass * frequency;
        let plain = FlatGround::level(real(stiffness), real(damping));
        let belt = R::Vec3::new(real(self.belt), R::ZERO, R::ZERO);
        let stepper = Stepper::builder(body)
            .gravity(UniformGravity::down(real(9.8)))
            .ground(MovingGround::conveyor(plain, belt))
            .friction(Coulomb {
                coefficient: real(self.friction.coefficient),
                slip_speed: real(self.friction.slip_speed),
            })
            .integrator(AdaptiveEnergyMomentum {
                tolerance: real(self.method.tolerance),
                longest_step: real(self.method.longest_step),
                budget: self.method.budget,
            })
            .build()
            .unwrap();
        let start = tumble::State::at(vector(DVec3::Z * self.height))
            .with_linear_velocity(vector(self.velocity));
        let start = stepper.with_angular_velocity(start, vector(self.spin));
        let mut session = stepper.session(start);
        let mut before = session.energy().total();
        for number in 0..60 {
            let (start, limit) = (*session.state(), real(self.limits[number % 2]));
            let step = match session.step_within(limit) {
                Ok(step) => step,
                Err(StepError::StepTooShort { .. } | StepError::BudgetSpent { .. }) => {
                    prop_assert!(*session.state() == start);
                    return Ok(false);
                }
                Err(error) => return Err(TestCaseError::fail(error.to_string())),
            };
            let after = session.energy().total();
            self.check(&step, session.state(), limit, [before, after])?;
            before = after;
        }
        Ok(true)
    }
}

impl Case {
    /// Checks the energy (J) before and after a step, its time, and the length of the orientation.
    fn check<R: Real>(
        &self,
        step: &Step<R>,
        state: &State<R>,
        limit: R,
        [before, after]: [R; 2],
    ) -> Result<(), TestCaseError> {
        let is_held = after <= before + step.drive_work;
        prop_assert!(is_held, "{:?} to {:?} J, {:?}", before, after, step);
        let is_free = self.belt > 0.0 || step.drive_work == R::ZERO;
        prop_assert!(is_free, "{:?}", step);
        let is_within = step.elapsed > R::ZERO && step.elapsed <= limit;
        prop_assert!(is_within, "{:?} of {:?} s", step, limit);
        prop_assert!(step.error_estimate.is_some_and(|error| error >= R::ZERO));
        let [x, y, z, w] = state.orientation.xyzw();
        let excess = (w - R::ONE) * (w + R::ONE) + x * x + (y * y + z * z);
        let is_rigid = excess.abs() <= R::EPSILON * R::from_f64(4.0);
        prop_assert!(is_rigid, "{:?}", excess);
        Ok(())
    }
}

/// Runs random scenes. Nearly all of them must come to their end.
fn promises<R: Real>(count: u32) {
    let ended = core::cell::Cell::new([0_u32; 2]);
    let result = TestRunner::new(kit::cases(count)).run(&scenes(), |case| {
        let mut counts = ended.get();
        counts[usize::from(case.keeps_its_promises::<R>()?)] += 1;
        ended.set(counts);
        Ok(())
    });
    assert!(result.is_ok(), "{}", result.unwrap_err());
    let [refused, whole] = ended.get();
    println!("{whole} scenes to the end, {refused} with a tolerance that cannot be kept");
    assert!(refused * 50 <= whole, "{refused} refused, {whole} not");
}

#[test]
fn the_energy_never_increases_and_the_body_stays_rigid() {
    promises::<f64>(400);
}

#[test]
fn the_energy_never_increases_and_the_body_stays_rigid_in_single_precision() {
    promises::<f32>(400);
}

const MASS: f64 = 0.3; // kg

/// A throw in single precision onto ground so hard that a few roundings of the height stop a body.
#[derive(Clone, Debug)]
struct HardLanding {
    kind: u8,
    size: f64,
    /// Stiffness relative to `m g/r`, and damping ratio of the mass on one contact.
    law: (f64, f64),
    friction: (f64, f64),
    tilt: f64,
    /// rad, m/s and rad/s.
    pose: DVec3,
    velocity: DVec3,
    spin: DVec3,
    /// Fraction of the size.
    tolerance: f64,
}

fn hard_landings() -> impl Strategy<Value = HardLanding> {
    let vectors = |largest: f64| (kit::directions(), 0.0..largest).prop_map(|(d, s)| d * s);
    let law = (log_uniform(1e6, 1e10), log_uniform(0.01, 10.0));
    let friction = (0.1..0.8, log_uniform(1e-5, 1e-2));
    let tilt = prop_oneof![Just(0.0), Just(0.3)];
    let motion = (vectors(3.0), vectors(1.5), vectors(12.0));
    let size = (0..6_u8, log_uniform(0.01, 1.0), log_uniform(1e-3, 1e-2));
    (size, law, friction, tilt, motion).prop_map(|(size, law, friction, tilt, motion)| {
        HardLanding {
            kind: size.0,
            size: size.1,
            law,
            friction,
            tilt,
            pose: motion.0,
            velocity: motion.1,
            spin: motion.2,
            tolerance: size.2,
        }
    })
}

fn real(number: f64) -> f32 {
    Real::from_f64(number)
}

impl HardLanding {
    fn run(&self) -> Result<(), StepError> {
        let (m, r) = (real(MASS), real(self.size));
        match self.kind {
            0 => self.run_of(Sphere::solid(m, r)),
            1 => self.run_of(Cuboid::solid(m, Vec3::new(r, 0.7 * r, 0.4 * r))),
            2 => self.run_of(Coin::<f32>::ring(m, r)),
            3 => self.run_of(Disc::solid(m, r, 48)),
            4 => self.run_of(Ellipsoid::solid(m, Vec3::new(r, 0.7 * r, 0.4 * r))),
            _ => self.run_of(Capsule::solid(m, 0.5 * r, r)),
        }
    }

    fn run_of<B: RigidPointBody<f32>>(&self, body: B) -> Result<(), StepError> {
        let mass = real(MASS);
        let stiffness = real(self.law.0) * mass * 9.81 / real(self.size);
        let damping = 2.0 * real(self.law.1) * (stiffness * mass).sqrt();
        let normal = Vec3::new(real(self.tilt.sin()), 0.0, real(self.tilt.cos()));
        let stepper = Stepper::builder(body)
            .gravity(UniformGravity::down(9.81_f32))
            .ground(FlatGround::level(stiffness, damping).on(Plane::through(Vec3::ZERO, normal)))
            .friction(Coulomb {
                coefficient: real(self.friction.0),
                slip_speed: real(self.friction.1),
            })
            .integrator(AdaptiveEnergyMomentum {
                budget: 100_000,
                ..AdaptiveEnergyMomentum::new(real(self.tolerance * self.size))
            })
            .build()
            .unwrap();
        let start = State::at(Vec3::Z * real(1.6 * self.size))
            .with_rotation_vector(self.pose.as_vec3())
            .with_linear_velocity(self.velocity.as_vec3());
        let start = stepper.with_angular_velocity(start, self.spin.as_vec3());
        stepper.session(start).advance(0.6).map(|_| ())
    }
}

/// Of 3000 such throws 15 fail, nearly all of the ellipsoid. When the rounding of a depth did not
/// count as allowed, 1265 failed. 6 of 200 reject a share of 8 % with 99 %.
#[test]
fn runs_on_hard_ground_come_to_their_end_in_single_precision() {
    let mut runner = TestRunner::deterministic();
    let mut draw = || hard_landings().new_tree(&mut runner).unwrap().current();
    let failed = (0..200).filter(|_| draw().run().is_err()).count();
    assert!(failed <= 6, "{failed}");
}

/// The energy error of the audit decreases with the tolerance, from a millimetre on. At a centimetre
/// the motion itself differs.
#[test]
fn the_energy_error_of_the_audit_decreases_with_the_tolerance() {
    for number in 1..=4 {
        let error = |tolerance: f64| {
            let mut ledger = Ledger::new();
            let stepper = trial(number)
                .stepper(AdaptiveEnergyMomentum::new(tolerance))
                .unwrap();
            stepper
                .run(&mut trial(number).state(), 1.0, &mut ledger)
                .unwrap();
            ledger.energy_error().abs()
        };
        let errors = [1e-3, 1e-4, 1e-5].map(|t| (t, error(t)));
        println!("trial {number}: {errors:?}");
        let slope = convergence(&errors);
        assert!(slope > 0.8, "energy error goes as tolerance^{slope:.2}");
    }
}

#[test]
fn a_resumed_session_has_the_same_bits() {
    let stepper = trial(8).stepper(AdaptiveEnergyMomentum::new(1e-3)).unwrap();
    let mut session = stepper.session(trial(8).state());
    session.advance(0.3).unwrap();
    let mut resumed = stepper.resume(&session.save()).unwrap();
    for _ in 0..5 {
        session.advance(0.1).unwrap();
        session.step().unwrap();
        resumed.advance(0.1).unwrap();
        resumed.step().unwrap();
        assert_eq!(session.state(), resumed.state());
    }
    // A new session chooses another first step.
    let mut new = stepper.session(*session.state());
    new.step().unwrap();
    session.step().unwrap();
    assert_ne!(session.state(), new.state());
}

#[test]
fn the_budget_ends_a_run_and_a_step_keeps_to_any_limit() {
    let method = AdaptiveEnergyMomentum {
        budget: 20,
        ..AdaptiveEnergyMomentum::new(1e-5)
    };
    let stepper = trial(1).stepper(method).unwrap();
    let mut state = trial(1).state();
    let error = stepper.advance(&mut state, 1.0).unwrap_err();
    assert!(matches!(error, StepError::BudgetSpent { attempts: 20, .. }));
    for limit in [1e-300, 1e-100, 1e-12, 1e-3] {
        let step = stepper.session(trial(1).state()).step_within(limit);
        let elapsed = step.unwrap().elapsed;
        assert!(
            elapsed > 0.0 && elapsed <= limit,
            "{elapsed:e} of {limit:e}"
        );
    }
}

#[test]
fn a_body_at_rest_stays_there_and_costs_no_evaluation() {
    let stepper = trial(1).stepper(AdaptiveEnergyMomentum::new(1e-3)).unwrap();
    let start = State::at(DVec3::Z * 0.02).with_rotation_vector(DVec3::Y * 1.5);
    let mut session = stepper.session(start);
    session.advance(60.0).unwrap();
    let (rest, evaluations) = (*session.state(), session.evaluation_count());
    assert_eq!(rest.linear_velocity, DVec3::ZERO);
    session.advance(10.0).unwrap();
    // The rounding of the energy, 64 ε · 1e-3 J, moves it by 1e-11 m on springs of 1.2e5 N/m.
    let moved = kit::difference(session.state(), &rest);
    assert!(moved < 1e-9, "{moved:e}");
    let more = session.evaluation_count() - evaluations;
    // A thousand steps, of which only those of a new size are evaluated.
    assert!(more < 500, "{more} evaluations");
    // The frames of a display are two steps each, of 10 ms and of 6.7 ms.
    session.advance(1.0 / 60.0).unwrap();
    let evaluations = session.evaluation_count();
    for _ in 0..600 {
        session.advance(1.0 / 60.0).unwrap();
    }
    let more = session.evaluation_count() - evaluations;
    assert!(more < 100, "{more} evaluations in 600 frames");
}
