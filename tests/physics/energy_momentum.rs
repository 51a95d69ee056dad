//! The default integrator where the answer is known: the truth of the report's equations, closed
//! forms, and rest. What it does beyond them is in `limits/extremes.rs`.

// Helpers of these tests fail by panicking, like the tests.
#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    clippy::cast_possible_truncation
)]

use crate::common::methods::{Setup, apart, convergence, method, truths};
use crate::kit::erased::Stepper;
use crate::kit::{self, Solid, point_mass};
use core::f64::consts::{FRAC_PI_2, PI};
use tumble::glam::{DQuat, DVec3, Vec3};
use tumble::integrator::EnergyMomentumWorkspace;
use tumble::real::{Matrix, Vector};
use tumble::{
    AirDrag, Block, Capsule, Coin, ContactPoint, Coulomb, Cuboid, Disc, DormandPrince54, Ellipsoid,
    EnergyMomentum, FlatGround, Frictionless, Ground, InertiaProperties, Integrator,
    LoadDependentCoulomb, Plane, PointCloud, Real, RigidPointBody, Rod, RollingResistance,
    SlidingFriction, SmoothCoulomb, SolidCoin, Sphere, SpringDamper, SpringDamperGround, State,
    Terrain, Trial, UniformGravity, Viscous, Waves, Wind,
};

const GRAVITY: f64 = 9.8;

fn scene<'a>(
    body: impl RigidPointBody + 'a,
    ground: impl SpringDamperGround + 'a,
    friction: impl SlidingFriction + 'a,
    time_step: f64,
) -> Stepper<'a> {
    Stepper::new(body)
        .and_then(|stepper| stepper.with_ground(ground))
        .and_then(|stepper| stepper.with_friction(friction))
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(GRAVITY)))
        .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
        .unwrap()
}

/// A trial of the report.
fn trial(number: usize, time_step: f64) -> (Stepper<'static>, State) {
    let trial = Trial::report(number).unwrap();
    let stepper = Stepper::of_trial(&trial, EnergyMomentum { time_step }).unwrap();
    (stepper, trial.state())
}

/// A coin that lies on its springs at rest, at its position (m) relative to the plane z = 0.
fn lying(height: f64) -> State {
    State::at(DVec3::Z * height).with_orientation(DQuat::from_rotation_y(FRAC_PI_2))
}

// -----------------------------------------------------------------------------------------------
// Accuracy
// -----------------------------------------------------------------------------------------------

/// Errors of the position (m) in trial 1 at the times of the truth table up to 1 s, for each step
/// size.
fn errors_in_trial_1(slip_speed: f64, steps: &[f64]) -> Vec<Vec<f64>> {
    let (setup, truths) = (Setup::trial(1, slip_speed), truths(1, slip_speed, 1.0));
    let times: Vec<_> = truths.iter().map(|truth| truth.time).collect();
    let method = method("EnergyMomentum");
    (steps.iter())
        .map(|&step| {
            let records = method.records(&setup, step, &times);
            (records.iter().zip(&truths))
                .map(|(record, truth)| apart(&record.state, &truth.state).place)
                .collect()
        })
        .collect()
}

#[test]
fn trial_1_after_a_second_is_a_sixth_of_a_tenth_of_a_millimetre_from_the_truth() {
    for slip_speed in [1e-3, 1e-6] {
        for (time_step, bound) in [(1e-3, 6e-5), (1e-4, 6e-7)] {
            let errors = errors_in_trial_1(slip_speed, &[time_step]);
            let last = *errors[0].last().unwrap();
            assert!(last <= bound, "{slip_speed}, {time_step} s: {last:e} m");
        }
    }
}

#[test]
fn trial_1_converges_at_order_two_through_its_touch_downs() {
    for slip_speed in [1e-3, 1e-6] {
        let steps = [1e-3, 5e-4, 2.5e-4, 1.25e-4, 6.25e-5];
        let errors: Vec<_> = (errors_in_trial_1(slip_speed, &steps).iter().zip(steps))
            .map(|(errors, step)| {
                let squares: f64 = errors.iter().map(|error| error * error).sum();
                (step, (squares / errors.len() as f64).sqrt())
            })
            .collect();
        let order = convergence(&errors);
        assert!((order - 2.0).abs() < 0.05, "{order}, {errors:?}");
    }
}

#[test]
fn trial_3_sticks_and_rolls_at_order_two_though_its_steps_do_not_resolve_the_slip() {
    // A slip ends in ε/(3 μ g) = 4e-8 s for the slip speed 1e-6 m/s: a thousandth of the shortest
    // of these steps. Where what settles a stick braked its beginning and end too, the error was
    // 2.9e-6 m at 0.1 ms, of order 1.2; without anything that settles it, 3.7e-7.
    let steps = [2e-4, 1e-4, 5e-5, 2.5e-5];
    let (setup, truths) = (Setup::trial(3, 1e-6), truths(3, 1e-6, 1.0));
    let times: Vec<_> = truths.iter().map(|truth| truth.time).collect();
    let errors = steps.map(|step| {
        let records = method("EnergyMomentum").records(&setup, step, &times);
        let (last, truth) = (records.last().unwrap(), truths.last().unwrap());
        (step, apart(&last.state, &truth.state).place)
    });
    assert!(errors[1].1 < 5e-7, "{errors:?}");
    let order = convergence(&errors);
    assert!((order - 2.0).abs() < 0.15, "{order}, {errors:?}");
}

/// Order of the error after this time (s), with steps from 1 ms down to 1/32 ms.
fn order_of(
    body: impl RigidPointBody + Copy,
    ground: impl SpringDamperGround + Copy,
    friction: impl SlidingFriction + Copy,
    (start, spin, seconds): (State, DVec3, f64),
) -> f64 {
    let end = |stepper: &dyn Fn(&mut State)| {
        let mut state = start.with_angular_momentum(body.inertia() * spin);
        stepper(&mut state);
        state.position
    };
    let exact = scene(body, ground, friction, 1e-3)
        .with_integrator(DormandPrince54::new(1e-11))
        .unwrap();
    let truth = end(&|state| exact.advance(state, seconds).map(|_| ()).unwrap());
    let errors = [1, 2, 4, 8, 16, 32].map(|part| {
        let step = 1e-3 / f64::from(part);
        let stepper = scene(body, ground, friction, step);
        let there = end(&|state| stepper.advance(state, seconds).map(|_| ()).unwrap());
        (step, (there - truth).length())
    });
    convergence(&errors)
}

/// A greasy film: friction that saturates with the load, and resistance to rolling and spinning
/// that is not proportional to it either.
#[derive(Clone, Copy)]
struct Film;

impl SlidingFriction for Film {
    fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
        slip * (-0.3 * normal_force / (1.0 + normal_force / 5.0))
    }

    fn rolling_resistance(&self, normal_force: f64) -> Option<RollingResistance> {
        Some(RollingResistance {
            rolling: 1e-3 * normal_force.powf(4.0 / 3.0),
            spinning: 1e-2 * normal_force / (1.0 + normal_force / 5.0),
            turn_speed: 0.1,
        })
    }
}

/// A ball and a cube that bounce and slide. The friction of the mean load of a step is the mean
/// friction only where the friction is proportional to the load: taken for it, the ball had order
/// 1.0 under the second of these laws.
#[test]
fn touch_downs_have_order_two_whether_friction_is_proportional_to_the_load_or_not() {
    let coulomb = Coulomb {
        coefficient: 0.3,
        slip_speed: 1e-2,
    };
    let falling = |transition_load| LoadDependentCoulomb {
        coefficient: 0.3,
        transition_load,
        slip_speed: 1e-2,
    };
    let ground = FlatGround::level(1e4, 20.0);
    let ball = Sphere::solid(1.0, 0.1);
    let start = State::at(DVec3::Z * 0.15).with_linear_velocity(DVec3::new(2.0, 0.0, -0.3));
    let throw = (start, DVec3::Y * 3.0, 0.45);
    let of_ball = [
        order_of(ball, ground, coulomb, throw),
        order_of(ball, ground, falling(5.0), throw),
        order_of(ball, ground, Film, throw),
    ];
    let slope = Plane::through(DVec3::NEG_Z * 0.1, DVec3::new(0.2, 0.1, 1.0));
    let ground = FlatGround::level(4e3, 15.0).on(slope);
    let cube = Cuboid::cube(0.5, 0.12);
    let start = (State::at(DVec3::Z * 0.12).with_rotation_vector(DVec3::new(0.5, 0.3, 0.2)))
        .with_linear_velocity(DVec3::new(0.7, -1.5, 0.4));
    let throw = (start, DVec3::new(1.0, -2.0, 5.0), 0.4);
    let of_cube = [
        order_of(cube, ground, coulomb, throw),
        order_of(cube, ground, falling(40.0), throw),
        order_of(cube, ground, Film, throw),
    ];
    for order in of_ball.into_iter().chain(of_cube) {
        assert!((order - 2.0).abs() < 0.15, "{of_ball:?}, {of_cube:?}");
    }
}

/// Three points on a line, a tetrahedron of points, and a needle; coordinates in metres.
fn clouds<R: Real>() -> [PointCloud<R, Vec<ContactPoint<R>>>; 3] {
    let slant = DVec3::new(1.0, 2.0, 3.0).normalize();
    let rod = [slant, -slant, slant * 0.5];
    let tetrahedron = [DVec3::ZERO, DVec3::X, DVec3::Y * 0.8, DVec3::Z * 0.6];
    let needle = [DVec3::X, DVec3::NEG_X, DVec3::Y * 1e-3, DVec3::NEG_Y * 1e-3];
    [&rod[..], &tetrahedron, &needle].map(|places| {
        let points: Vec<_> = (places.iter())
            .map(|&place| ContactPoint {
                position: vector::<R>(place),
                radius: R::ZERO,
            })
            .collect();
        let masses = vec![R::ONE / R::from_usize(points.len()); points.len()];
        PointCloud::with_storage(points, &masses).unwrap()
    })
}

fn vector<R: Real>(v: DVec3) -> R::Vec3 {
    R::Vec3::new(R::from_f64(v.x), R::from_f64(v.y), R::from_f64(v.z))
}

/// Velocity (m/s) after one step of a body of 1 kg that falls at 7 m/s and slides, 2 m deep in
/// ground without springs, whose dampers slow it by `strain` in a step.
fn after_step_on_dampers<R: Real>(
    body: PointCloud<R, Vec<ContactPoint<R>>>,
    (strain, coefficient): (f64, f64),
    seconds: f64,
    slide: f64,
) -> DVec3 {
    let number = R::from_f64;
    let ground = FlatGround::level(R::ZERO, number(strain / seconds));
    let friction = Coulomb {
        coefficient: number(coefficient),
        slip_speed: number(1e-6),
    };
    let integrator = EnergyMomentum {
        time_step: number(seconds),
    };
    let stepper = Stepper::<EnergyMomentum<R>, R>::new(body)
        .and_then(|stepper| stepper.with_ground(ground))
        .and_then(|stepper| stepper.with_friction(friction))
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(number(GRAVITY))))
        .and_then(|stepper| stepper.with_integrator(integrator))
        .unwrap();
    let mut state = State::at(vector::<R>(DVec3::NEG_Z * 2.0))
        .with_rotation_vector(vector::<R>(DVec3::new(0.4, 0.5, 0.9)))
        .with_linear_velocity(vector::<R>(DVec3::new(slide, 0.0, -7.0)));
    stepper.step(&mut state).unwrap();
    let velocity = state.linear_velocity;
    DVec3::new(
        velocity.x().to_f64(),
        velocity.y().to_f64(),
        velocity.z().to_f64(),
    )
}

/// Dampers and friction of up to 1e25 masses a step, far above `1/EPSILON`.
///
/// Where they hid the inertia in the rounding of the equations, a rod fell freely, turned back, or
/// was left where it was.
#[test]
fn dampers_and_friction_of_any_size_stop_a_body() {
    fn stopped<R: Real>(laws: (f64, f64), seconds: f64, most: f64) {
        for body in clouds::<R>() {
            for slide in [0.0, 1e-200, 1e-9, 3.0] {
                let velocity = after_step_on_dampers(body.clone(), laws, seconds, slide);
                let without_friction = laws.1 == 0.0;
                let rest = DVec3::X * if without_friction { slide } else { 0.0 };
                let error = (velocity - rest).length() / (7.0 + GRAVITY * seconds);
                assert!(
                    error < most,
                    "{laws:?}, {seconds} s, {slide} m/s: {velocity}"
                );
            }
        }
    }
    for strain in [1e7, 1e9, 1e12, 1e15, 1e18, 1e22, 1e25] {
        for coefficient in [0.0, 1e3, 1e7, 1e12] {
            for seconds in [1e-3, 0.3, 50.0] {
                stopped::<f64>((strain, coefficient), seconds, 1e-3);
                // The friction of the others overflows in single precision.
                if strain * coefficient < 1e30 {
                    stopped::<f32>((strain, coefficient), seconds, 1e-2);
                }
            }
        }
    }
}

/// A point that falls onto dampers loses the coefficient of friction times the momentum across the
/// ground, however strong the dampers are.
#[test]
fn the_friction_of_an_impact_on_dampers_is_that_of_its_impulse() {
    fn slid<R: Real>(strain: f64, most: f64) {
        let point = [ContactPoint::default()].to_vec();
        let body = PointCloud::with_storage(point, &[R::ONE]).unwrap();
        let (coefficient, seconds) = (0.1, 1e-3);
        let velocity = after_step_on_dampers::<R>(body, (strain, coefficient), seconds, 3.0);
        let slide = 3.0 - coefficient * (7.0 + GRAVITY * seconds);
        assert!((velocity.x - slide).abs() < most, "{strain:e}: {velocity}");
        assert!(velocity.z.abs() < 0.01, "{strain:e}: {velocity}");
    }
    for strain in [1e3, 1e4, 1e5, 1e6, 1e7, 1e9, 1e12, 1e14, 1e16, 1e20] {
        slid::<f64>(strain, 0.003);
        slid::<f32>(strain, 0.02);
    }
}

/// A cube that slides without friction, over the edge of a block and on a plane.
#[test]
fn a_contact_that_crosses_an_edge_of_a_block_has_order_one() {
    let law = SpringDamper {
        stiffness: 1e4,
        damping: 20.0,
    };
    let cube = Cuboid::cube(1.0, 0.1);
    let start = State::at(DVec3::new(0.26, 0.0, 0.09))
        .with_rotation_vector(DVec3::new(0.3, 0.2, 0.1))
        .with_linear_velocity(DVec3::new(0.6, 0.1, 0.0));
    let throw = (start, DVec3::new(0.2, 1.0, 0.3), 0.3);
    let block = Block {
        centre: DVec3::NEG_Z,
        half: DVec3::new(0.3, 0.3, 1.0),
    };
    let order = order_of(cube, Ground { law, shape: block }, Frictionless, throw);
    assert!((0.4..1.6).contains(&order), "{order}");
    let shape = Plane::level(0.0);
    let order = order_of(cube, Ground { law, shape }, Frictionless, throw);
    assert!(order > 1.75, "{order}");
}

/// A coin of the report that lies on a soft bed with all of its points, slides, spins and rocks.
fn sliding_flat() -> Setup {
    Setup {
        ground: FlatGround::level(10.0, 0.5),
        friction: Coulomb::as_in_the_report(0.3),
        state: lying(-0.0082)
            .with_orientation(
                DQuat::from_rotation_z(0.3) * DQuat::from_rotation_y(FRAC_PI_2 + 0.004),
            )
            .with_linear_velocity(DVec3::new(2.0, 0.5, 0.0))
            .with_angular_momentum(DVec3::new(0.002, 0.001, 0.25)),
    }
}

#[test]
fn smooth_contact_converges_at_order_two() {
    let (setup, end) = (sliding_flat(), [0.24]);
    let truth = method("Rk4").records(&setup, 1e-4, &end)[0].state;
    let errors = [2e-3, 1e-3, 5e-4, 2.5e-4].map(|step| {
        let record = method("EnergyMomentum").records(&setup, step, &end)[0];
        (step, apart(&record.state, &truth).place)
    });
    let order = convergence(&errors);
    assert!((order - 2.0).abs() < 0.05, "{order}, {errors:?}");
}

// -----------------------------------------------------------------------------------------------
// Energy that nothing takes, and energy that is taken
// -----------------------------------------------------------------------------------------------

#[test]
fn what_nothing_takes_is_there_after_a_million_steps() {
    // A coin rolls on springs without dampers and friction, as trial 1 but with four times the
    // spin.
    for time_step in [1e-3, 1e-4] {
        let report = Trial::report(1).unwrap();
        let rolling = Trial {
            angular_momentum: 4.0,
            damping: 0.0,
            coefficient: 0.0,
            ..report
        };
        let stepper = scene(rolling.coin(), rolling.ground(), Frictionless, time_step);
        let mut session = stepper.session(rolling.state());
        let start = session.energy().total();
        let (mut energy_removed, mut iterations, mut divided) = (0.0, 0_u64, 0);
        let steps = 500_000;
        for _ in 0..steps {
            let step = session.step().unwrap();
            energy_removed += step.energy_removed;
            iterations += u64::from(step.iterations);
            divided += u32::from(step.fallback);
        }
        let end = session.energy().total();
        println!(
            "dt {time_step}: {start} to {end}: {:e} of it; energy_removed {energy_removed:e} J, {} iterations, {divided} divided",
            (start - end) / start,
            iterations
        );
        // M g r cos(15 degrees) + L^2/(2 I).
        let expected = GRAVITY * 0.5 * (core::f64::consts::PI / 12.0).cos() + 32.0;
        assert!((start - expected).abs() < 1e-13, "{start}");
        // Each step is free to lose its rounding, a few units of 1.1e-16 (measured: one), and none
        // to gain it: at most linear in the steps.
        let lost = (start - end) / start;
        assert!(
            lost >= 0.0 && lost <= f64::from(steps) * 4.4e-16,
            "{lost:e}"
        );
        assert_eq!(divided, 0);
    }
}

#[test]
fn the_energy_curves_of_the_eight_trials_have_no_rise_at_any_step() {
    for number in 1..=8 {
        // At the finest step until most of the energy is gone.
        for (time_step, seconds) in [(1e-2, 160.0), (1e-3, 160.0), (1e-4, 16.0)] {
            let (stepper, mut state) = trial(number, time_step);
            let mut last = f64::INFINITY;
            let mut still = 0;
            stepper
                .run(&mut state, seconds, &mut |sample: &tumble::Sample<'_>| {
                    let energy = sample.energy().total();
                    assert!(
                        energy <= last,
                        "trial {number}, {time_step} s: {last} to {energy}"
                    );
                    last = energy;
                    // Once it lies still it stays so: see the test of rest.
                    let rests = sample.state.linear_velocity == DVec3::ZERO
                        && sample.state.angular_momentum == DVec3::ZERO;
                    still = if rests { still + 1 } else { 0 };
                    if still > 100 {
                        core::ops::ControlFlow::Break(())
                    } else {
                        core::ops::ControlFlow::Continue(())
                    }
                })
                .unwrap();
        }
    }
}

// -----------------------------------------------------------------------------------------------
// Rest
// -----------------------------------------------------------------------------------------------

#[test]
fn the_eight_trials_come_to_rest_exactly_and_stay_there() {
    // Lying on all 120 springs, z = -M g/(n S).
    let sag = -GRAVITY / (120.0 * 1000.0);
    for number in 1..=8 {
        for time_step in [1e-2, 1e-3] {
            let (stepper, start) = trial(number, time_step);
            let mut session = stepper.session(start);
            let state = loop {
                let before = *session.state();
                let step = session.step().unwrap();
                let state = *session.state();
                if step.evaluations == 0 && state == before && stepper.touching(&state) > 0 {
                    break state;
                }
                assert!(
                    session.time() < 160.0,
                    "trial {number}, {time_step} s: still at {state:?}"
                );
            };
            let (z, touching) = (state.position.z, stepper.touching(&state));
            assert_eq!(state.linear_velocity, DVec3::ZERO);
            assert_eq!(state.angular_momentum, DVec3::ZERO);
            assert_eq!(touching, 120, "trial {number}");
            // The energy's rounding, 1e-19 J of 8e-4 J, hides an offset of sqrt(2 * 64 * 1e-19/(n
            // S)) = 1e-11 m.
            assert!((z - sag).abs() < 1e-11, "trial {number}: {z:e}");
            for _ in 0..1000 {
                session.step().unwrap();
            }
            assert_eq!(*session.state(), state);
        }
    }
}

/// Takes steps until one leaves the body on the ground unchanged without an evaluation.
macro_rules! put_to_sleep {
    ($session:expr) => {{
        let session = &mut $session;
        let sleeps = (0..100_000).any(|_| {
            let before = *session.state();
            let rests = session.step().unwrap().evaluations == 0 && *session.state() == before;
            rests && session.stepper().touching(&before) > 0
        });
        assert!(sleeps, "{}", session.state());
        *session.state()
    }};
}

#[test]
fn a_body_at_rest_wakes_when_its_state_is_changed() {
    let (stepper, start) = trial(1, 1e-2);
    let mut session = stepper.session(start);
    let resting = put_to_sleep!(session);
    // Slightly moved, pushed, rotated.
    for (nudged, what) in [
        (
            State {
                position: resting.position + DVec3::Z * 1e-6,
                ..resting
            },
            "lifted",
        ),
        (resting.with_linear_velocity(DVec3::X * 1e-3), "pushed"),
        (resting.with_angular_momentum(DVec3::Z * 1e-3), "spun"),
    ] {
        session.set_state(nudged);
        session.step().unwrap();
        assert_ne!(*session.state(), nudged, "{what}");
        session.set_state(resting);
        assert_eq!(put_to_sleep!(session), resting);
    }
}

/// A body that sleeps in one scene and is resumed, or whose memory is used again, in another scene
/// whose springs or gravity move it. The new scene knows nothing of the old one: the body wakes,
/// its first step has the bits of a new session, and the energy never increases from that step on.
fn wakes(asleep: &Stepper, awake: &Stepper, lying: State, what: &str) {
    let mut memory = EnergyMomentumWorkspace::new();
    let mut session = asleep.session_in(&mut memory, lying);
    let resting = put_to_sleep!(session);
    let saved = session.save();
    let mut fresh = resting;
    awake.step(&mut fresh).unwrap();
    assert_ne!(fresh, resting, "{what}");
    let mut session = awake.session_in(&mut memory, resting);
    session.step().unwrap();
    assert_eq!(*session.state(), fresh, "{what}");
    let mut session = awake.resume(&saved).unwrap();
    let mut before = session.energy().total();
    for number in 0..200 {
        session.step().unwrap();
        assert!(number > 0 || *session.state() == fresh, "{what}");
        let after = session.energy().total();
        assert!(after <= before, "{what}: {before} J to {after} J");
        before = after;
    }
}

#[test]
fn a_body_that_slept_in_one_scene_wakes_in_another() {
    fn on_ground<'a>(body: impl RigidPointBody + 'a, stiffness: f64) -> Stepper<'a> {
        let friction = Coulomb::as_in_the_report(0.3);
        scene(body, FlatGround::level(stiffness, 0.5), friction, 1e-3)
    }
    let rest_on = |points: f64| lying(-GRAVITY / (1000.0 * points));
    let coin = || on_ground(Coin::ring(1.0, 0.5), 1000.0);
    wakes(
        &coin(),
        &on_ground(Coin::ring(1.0, 0.5), 500.0),
        rest_on(120.0),
        "softer",
    );
    let tilted = UniformGravity {
        acceleration: DVec3::new(5.0, 0.0, -8.0),
    };
    let tilted = coin().with_gravity(tilted).unwrap();
    wakes(&coin(), &tilted, rest_on(120.0), "tilted");
    // More points on the same ground, which throw the body up.
    let few = Coin::ring_with_storage([ContactPoint::default(); 12], 1.0, 0.5);
    wakes(
        &on_ground(few, 1000.0),
        &coin(),
        rest_on(12.0),
        "more points",
    );
    let rim = |points| on_ground(Disc::ring(1.0, 0.5, points), 1000.0);
    wakes(&rim(60), &rim(120), rest_on(60.0), "a rim of more points");
}

#[test]
fn a_body_that_sleeps_in_longer_steps_is_not_moved_by_shorter_ones() {
    let (stepper, start) = trial(1, 1e-2);
    let resting = put_to_sleep!(stepper.session(start));
    let (shorter, _) = trial(1, 1e-3);
    let mut state = resting;
    shorter.step(&mut state).unwrap();
    assert_eq!(state, resting);
}

#[test]
fn a_body_that_creeps_does_not_sleep() {
    // On a slope of 10 degrees at a slip speed of 1e-9 m/s: it creeps by 1.4e-9 m/s, and after
    // 1000 s with steps of 1 ms has come 1.4e-6 m.
    let slope = 10.0_f64.to_radians();
    let normal = DVec3::new(slope.sin(), 0.0, slope.cos());
    let ground = FlatGround::level(1e4, 10.0).on(Plane::through(DVec3::ZERO, normal));
    let friction = Coulomb {
        coefficient: 0.3,
        slip_speed: 1e-9,
    };
    let stepper = scene(point_mass(1.0), ground, friction, 1e-3);
    let mut session = stepper.session(State::at(normal * (-GRAVITY * slope.cos() / 1e4)));
    let downhill = DVec3::new(slope.cos(), 0.0, -slope.sin());
    let mut go = || {
        let from = session.state().position.dot(downhill);
        for _ in 0..10_000 {
            session.step().unwrap();
        }
        (session.state().position.dot(downhill) - from) / 10.0
    };
    go();
    let creep = go();
    let expected = 1e-9 * slope.tan() / (0.3 - slope.tan());
    assert!(
        (creep / expected - 1.0).abs() < 1e-3,
        "{creep:e} {expected:e}"
    );
}

/// Height and upward speed of a ball of 1 kg and 0.5 m on 1 kN/m after so many steps.
fn ball_after<R: Real>(height: f64, speed: f64, time_step: f64, steps: u32) -> (f64, f64) {
    let real = R::from_f64;
    let up = |length: f64| R::Vec3::new(R::ZERO, R::ZERO, real(length));
    let stepper = Stepper::new(Sphere::solid(R::ONE, R::HALF))
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(real(GRAVITY))))
        .and_then(|stepper| stepper.with_ground(FlatGround::level(real(1000.0), real(5.0))))
        .and_then(|stepper| {
            stepper.with_integrator(EnergyMomentum {
                time_step: real(time_step),
            })
        })
        .unwrap();
    let mut state = tumble::State::<R>::at(up(height)).with_linear_velocity(up(speed));
    for _ in 0..steps {
        stepper.step(&mut state).unwrap();
    }
    let (position, velocity) = (state.position, state.linear_velocity);
    (position.z().to_f64(), velocity.z().to_f64())
}

#[test]
fn a_body_that_is_let_go_falls_though_a_step_moves_it_by_less_than_its_place_is_rounded_by() {
    for (height, time_step, steps) in [(100.0, 5e-4, 200), (100.0, 2e-5, 5000), (1.0, 1e-5, 10_000)]
    {
        let (end, _) = ball_after::<f32>(height, 0.0, time_step, steps);
        let share = (height - end) / (0.5 * GRAVITY * 0.01);
        // Two units in the last place instead of one, while the displacement in a step is less than
        // one.
        assert!(
            (0.7..1.8).contains(&share),
            "{height} m, {time_step} s: {share}"
        );
    }
    let (end, _) = ball_after::<f64>(1.0, 0.0, 1e-9, 10_000);
    let share = (1.0 - end) / (0.5 * GRAVITY * 1e-10);
    assert!((0.7..1.8).contains(&share), "{share}");
}

#[test]
fn a_body_that_just_does_not_touch_sinks_until_it_is_borne() {
    // A quarter of the oscillation about m g/K = 9.8 mm, of 50 ms.
    for (time_step, steps) in [(1e-3, 50), (1e-4, 500), (2e-5, 2500), (1e-5, 5000)] {
        let (end, _) = ball_after::<f32>(0.5, 0.0, time_step, steps);
        assert!(end < 0.494, "{time_step} s: {end}");
    }
    let (end, _) = ball_after::<f64>(0.5, 0.0, 1e-9, 10_000);
    assert!(0.5 - end > 0.35 * GRAVITY * 1e-10, "{end}");
}

#[test]
fn a_body_that_is_thrown_up_in_single_precision_comes_down_again() {
    for i in 0..40 {
        let (height, speed) = (0.6 + 0.07 * f64::from(i), 0.05 + 0.01 * f64::from(i));
        // For 3 v/g at least.
        let (end, after) = ball_after::<f32>(height, speed, 1e-4, 160 + 31 * i);
        assert!(
            end < height && after < 0.0,
            "{height} m, {speed} m/s: {end} m, {after} m/s"
        );
    }
}

#[test]
fn a_rocking_coin_does_not_stop_at_a_turning_point() {
    // At 1e-2 s the phase of the oscillation advances by 2π/3 in a step: every third step ends at a
    // turning point. The energy of the oscillation, 7.5e-9 J, is 1e8 roundings of the whole.
    let (ground, step) = (FlatGround::level(1000.0, 0.0), 1e-2);
    let stepper = scene(Coin::ring(1.0, 0.5), ground, Frictionless, step);
    let tilt = DQuat::from_rotation_y(FRAC_PI_2 + 1e-6);
    let mut state = lying(-GRAVITY / 120_000.0).with_orientation(tilt);
    let start = stepper.energy(&state).total();
    stepper.advance(&mut state, 1000.0).unwrap();
    let lost = start - stepper.energy(&state).total();
    assert!(lost < 7.5e-11, "{lost:e}");
}

#[test]
fn a_coin_that_hardly_rocks_does_not_sleep() {
    // Without dampers and friction a coin on its springs rocks for ever; by 1e-6 rad its energy is
    // n S r^2/4 a^2 = 7.5e-9 J, far above rounding.
    let stepper = scene(
        Coin::ring(1.0, 0.5),
        FlatGround::level(1000.0, 0.0),
        Frictionless,
        1e-3,
    );
    let tilt = DQuat::from_rotation_y(FRAC_PI_2 + 1e-6);
    let mut session = stepper.session(lying(-GRAVITY / 120_000.0).with_orientation(tilt));
    let mut swings = 0;
    let mut last = 0.0;
    for _ in 0..100_000 {
        session.step().unwrap();
        let turning = session.state().angular_momentum.y;
        swings += u32::from(turning * last < 0.0);
        last = turning;
    }
    // The springs' n S r^2/2 over the moment m r^2/2: 346 rad/s, slowed by the step to (2/dt)
    // atan(w dt/2) = 342.97 rad/s: 100 s hold 10,917 half swings.
    assert!((10_915..10_920).contains(&swings), "{swings}");
}

// -----------------------------------------------------------------------------------------------
// Closed forms of contact
// -----------------------------------------------------------------------------------------------

#[test]
fn a_coin_that_slides_flat_stops_after_the_printed_way_and_stays_there() {
    // Case C1: v0 = 2 m/s, coefficient 0.3: 0.680272 s and 0.680272 m.
    for (time_step, mu) in [
        (1e-4, 0.3),
        (1e-3, 0.3),
        (1e-3, 10.0),
        (1e-2, 0.3),
        (0.1, 0.3),
    ] {
        let stepper = scene(
            Coin::ring(1.0, 0.5),
            FlatGround::level(1000.0, 0.5),
            Coulomb::as_in_the_report(mu),
            time_step,
        );
        let mut state = lying(-GRAVITY / 120_000.0).with_linear_velocity(DVec3::X * 2.0);
        stepper.advance(&mut state, 1.0).unwrap();
        let way = 4.0 / (2.0 * mu * GRAVITY);
        let miss = state.position.x - way;
        // It slides exactly as the formula says up to the step in which it stops, where less than
        // mu g dt is left of the speed: at most mu g dt^2/8 off, or mu g dt^2/2 where that step
        // ends too early or too late by itself.
        assert!(
            miss.abs() <= 0.5 * mu * GRAVITY * time_step * time_step + 1e-9,
            "{miss:e}"
        );
        assert_eq!(state.linear_velocity, DVec3::ZERO, "{time_step}");
        assert_eq!(state.angular_momentum, DVec3::ZERO, "{time_step}");
        let stopped = state;
        stepper.advance(&mut state, 10.0).unwrap();
        assert_eq!(state, stopped);
    }
}

/// `exp(-2 ζ arccos(ζ)/√(1-ζ²))`, with the hyperbolic form beyond ζ = 1: the share of the speed
/// that a clamped spring and damper give back.
fn restitution(zeta: f64) -> f64 {
    let root = (1.0 - zeta * zeta).abs().sqrt();
    let angle = if zeta < 1.0 {
        zeta.acos() / root
    } else {
        zeta.acosh() / root
    };
    (-2.0 * zeta * angle).exp()
}

/// Bounces a point of 1 kg off a ground of 1e6 N/m without gravity: the share of the speed that is
/// left.
fn bounce(zeta: f64, time_step: f64) -> f64 {
    let stiffness = 1e6_f64;
    let ground = FlatGround::level(stiffness, 2.0 * zeta * stiffness.sqrt());
    let stepper = Stepper::new(point_mass(1.0))
        .and_then(|stepper| stepper.with_ground(ground))
        .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
        .unwrap();
    // Touches down at a third of a step.
    let mut state: State = State::at(DVec3::Z * (time_step / 3.0)).with_linear_velocity(-DVec3::Z);
    // A slow escape: the slowest rate of an overdamped contact is w (ζ - √(ζ²-1)), about w/2ζ.
    let mut steps = 0;
    while state.position.z <= 0.0 || state.linear_velocity.z <= 0.0 {
        stepper.step(&mut state).unwrap();
        steps += 1;
        if f64::from(steps) * time_step > 0.05 * (1.0 + zeta) {
            break;
        }
    }
    state.linear_velocity.z
}

#[test]
fn a_bounce_gives_back_what_the_closed_form_says_where_the_step_resolves_it() {
    // w = 1000 rad/s.
    for zeta in [0.0, 0.01, 0.1, 0.3, 0.6, 0.9, 1.1, 1.5] {
        let expected = restitution(zeta);
        let errors = [2e-5, 1e-5, 5e-6].map(|step| (step, (bounce(zeta, step) - expected).abs()));
        // The second order of w dt = 0.005, and of the damper's 2ζ w dt.
        let phase = 0.005 * (1.0 + 2.0 * zeta);
        assert!(errors[2].1 <= phase * phase + 1e-12, "{zeta}: {errors:?}");
    }
}

#[test]
fn an_overdamped_floor_throws_nothing_back_at_any_step() {
    // Impact at 1 m/s; S = 1e3 N/m, D = 1e4 N s/m, 1 kg: ζ = 158.
    for time_step in [1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0] {
        let stepper = scene(
            point_mass(1.0),
            FlatGround::level(1e3, 1e4),
            Frictionless,
            time_step,
        );
        let mut state = State::at(DVec3::ZERO).with_linear_velocity(-DVec3::Z);
        let (mut fastest, mut rise, mut lowest) = (f64::NEG_INFINITY, 0.0_f64, 0.0_f64);
        for _ in 0..100 {
            stepper.step(&mut state).unwrap();
            fastest = fastest.max(state.linear_velocity.z);
            lowest = lowest.min(state.position.z);
            rise = rise.max(state.position.z - lowest);
        }
        // An impulse at the end of the step stops what the mean force has thrown back, all but a
        // few hundredths; without it 0.98 of the speed came back.
        assert!(fastest < 0.03, "{time_step} s: up at {fastest} m/s");
        assert!(rise < 1e-5, "{time_step} s: up by {rise} m");
        assert!(
            state.position.z <= 0.0,
            "{time_step} s: {}",
            state.position.z
        );
    }
}

/// A contact with an arm feels less than the mass of the body, so a step resolves its damper less
/// well: the end of a rod a quarter of the mass, the corner of a cube from a quarter to a half, an
/// end of a dumbbell with its mass in the middle a fiftieth. Impact at 1 m/s without gravity, and
/// dampers from weak ones to those that stop the body in a hundredth of the step. With the mass of
/// the body, the end of the rod came up at 0.11 m/s, and that of the dumbbell at 0.7 m/s.
#[test]
fn an_overdamped_floor_throws_no_end_of_a_body_back() {
    let dumbbell = PointCloud::new(
        [DVec3::X, DVec3::NEG_X, DVec3::ZERO].map(|end| end * 0.5),
        [0.01, 0.01, 0.98],
    );
    let bodies: [(&str, Box<dyn RigidPointBody>); 3] = [
        ("rod", Box::new(Rod::new(1.0, 1.0))),
        ("cube", Box::new(Cuboid::solid(1.0, DVec3::ONE))),
        ("dumbbell", Box::new(dumbbell.unwrap())),
    ];
    let time_step = 1e-3;
    for (name, body) in &bodies {
        for (damper, tilt) in (0..40).flat_map(|damper| [0.1, 0.3, 1.0].map(|tilt| (damper, tilt)))
        {
            // Strain of the mass of the body: 0.1 to 1000.
            let strain = 10.0_f64.powf(f64::from(damper) / 10.0 - 1.0);
            let ground = FlatGround::level(1e3, strain / time_step);
            let stepper = Stepper::new(&**body)
                .and_then(|stepper| stepper.with_ground(ground))
                .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
                .unwrap();
            let turn = DQuat::from_rotation_x(0.4 * tilt) * DQuat::from_rotation_y(tilt);
            let heights = |turn: DQuat| {
                let height = move |point: &ContactPoint| (turn * point.position).z;
                body.contacts().iter().map(height)
            };
            let lowest = heights(turn).fold(f64::INFINITY, f64::min);
            let number = heights(turn).position(|height| height == lowest).unwrap();
            let mut state = State::at(-DVec3::Z * lowest)
                .with_orientation(turn)
                .with_linear_velocity(-DVec3::Z);
            for _ in 0..3 {
                stepper.step(&mut state).unwrap();
                let arm = state.orientation * body.contacts()[number].position;
                let spin = stepper.angular_velocity(&state);
                let rising = (state.linear_velocity + spin.cross(arm)).z;
                assert!(
                    rising < 0.03,
                    "{name}, strain {strain}, tilted by {tilt} rad: up at {rising} m/s"
                );
            }
        }
    }
}

#[test]
fn a_body_on_a_slope_creeps_as_the_closed_forms_say() {
    // Case C9: on 10 degrees with a coefficient of 0.3 in slip speeds: 1.4258 (report's law) and
    // 0.7265 (smooth law); 15 degrees: 8.36 and 1.986.
    fn creep(friction: impl SlidingFriction, degrees: f64, seconds: f64) -> f64 {
        let slope = degrees.to_radians();
        let normal = DVec3::new(slope.sin(), 0.0, slope.cos());
        let ground = FlatGround::level(1e4, 100.0).on(Plane::through(DVec3::ZERO, normal));
        let stepper = scene(point_mass(1.0), ground, friction, 1e-4);
        let mut state = State::at(normal * (-GRAVITY * slope.cos() / 1e4));
        stepper.advance(&mut state, seconds).unwrap();
        let from = state.position;
        stepper.advance(&mut state, 0.1).unwrap();
        let downhill = DVec3::new(slope.cos(), 0.0, -slope.sin());
        (state.position - from).dot(downhill) / 0.1
    }
    // Resolved: dt < eps/(mu g) = 3.4e-4 s. Beyond it see the next test.
    for eps in [1e-2, 1e-3] {
        let (coefficient, slip_speed) = (0.3, eps);
        for (degrees, report, smooth) in [(10.0_f64, 1.4258, 0.7265), (15.0, 8.36, 1.986)] {
            let t = degrees.to_radians().tan();
            let (first, second) = (t / (0.3 - t), t / (0.09 - t * t).sqrt());
            assert!((first / report - 1.0).abs() < 1e-3 && (second / smooth - 1.0).abs() < 1e-3);
            // The speed settles at the rate a (1 - t/mu)^2/eps with a = mu g cos; 25 of its times
            // leave e^-25.
            let settling = eps / (0.3 * GRAVITY * degrees.to_radians().cos());
            let seconds = 0.5 + 25.0 * settling / (1.0 - t / 0.3).powi(2);
            let found = [
                creep(
                    Coulomb {
                        coefficient,
                        slip_speed,
                    },
                    degrees,
                    seconds,
                ) / eps,
                creep(
                    SmoothCoulomb {
                        coefficient,
                        slip_speed,
                    },
                    degrees,
                    seconds,
                ) / eps,
            ];
            for (found, expected) in found.into_iter().zip([first, second]) {
                assert!(
                    (found / expected - 1.0).abs() < 1e-4,
                    "{eps:e}: {found}, not {expected}"
                );
            }
        }
    }
}

#[test]
fn a_body_creeps_as_fast_at_steps_that_do_not_resolve_its_slip() {
    // The step is 1e-3 to 1e8 times as long as the slip takes to settle, ε/(μ g). The end slip is
    // the mean one, and friction at that bears the weight: the creep is the law's. (Drawn to 0
    // instead of to the mean slip, it was low by 2 (ε + u)²/(μ g h ε): 3.8 % at 1e-6 m/s, 1e-4 s
    // and 10 degrees.)
    let mut worst = 0.0_f64;
    for slip_speed in [1e-2, 1e-4, 1e-6, 1e-8, 1e-10] {
        for time_step in [1e-4, 1e-2] {
            for degrees in [5.0_f64, 10.0, 16.0] {
                let slope = degrees.to_radians();
                let (sin, cos) = slope.sin_cos();
                let ground = FlatGround::level(1e4, 100.0)
                    .on(Plane::through(DVec3::ZERO, DVec3::new(sin, 0.0, cos)));
                let friction = Coulomb {
                    coefficient: 0.3,
                    slip_speed,
                };
                let stepper = scene(point_mass(1.0), ground, friction, time_step);
                let mut state = State::at(DVec3::new(sin, 0.0, cos) * (-GRAVITY * cos / 1e4));
                // 25 of the times in which the speed settles, see above, and 100 steps for what
                // they do not resolve.
                let rate = (1.0 - slope.tan() / 0.3).powi(2) * 0.3 * GRAVITY * cos / slip_speed;
                let seconds = 100.0 * time_step;
                stepper.advance(&mut state, seconds + 25.0 / rate).unwrap();
                let from = state.position;
                stepper.advance(&mut state, seconds).unwrap();
                let way = (state.position - from).dot(DVec3::new(cos, 0.0, -sin));
                let expected = slip_speed * slope.tan() / (0.3 - slope.tan()) * seconds;
                // Each step rounds the place, of a millimetre, to 2e-19 m at most; and Newton's
                // solution is one to 1.8e-12 of the weight's impulse.
                let rounding = 100.0 * 2.2e-19 / expected;
                let off = (way / expected - 1.0).abs();
                assert!(
                    off < 1e-7 + rounding,
                    "{slip_speed:e} m/s, {time_step} s, {degrees} degrees: {off:e}"
                );
                worst = worst.max(off);
            }
        }
    }
    println!("a creep is off by {worst:e} at most");
}

#[test]
fn what_a_step_does_not_resolve_does_not_flip() {
    // On wet ground, where friction is in proportion to slip, a body of 1 kg comes down a slope at
    // g sin/(c N): here in 1e-4 s, a hundredth of a step. Mean forces alone would make the end
    // velocity twice that and 0 by turns.
    let slope = 0.3_f64;
    let normal = DVec3::new(slope.sin(), 0.0, slope.cos());
    let ground = FlatGround::level(1e4, 100.0).on(Plane::through(DVec3::ZERO, normal));
    let friction = Viscous { coefficient: 1e3 };
    let stepper = scene(point_mass(1.0), ground, friction, 1e-2);
    let mut state = State::at(normal * (-GRAVITY * slope.cos() / 1e4));
    let downhill = DVec3::new(slope.cos(), 0.0, -slope.sin());
    for step in 0..5 {
        stepper.step(&mut state).unwrap();
        let speed = state.linear_velocity.dot(downhill);
        // The impulse at the end leaves nothing of what is linear, to Newton's 1.8e-12; the normal
        // force is 1e-12 from the weight's.
        let off = speed / (slope.tan() / 1e3) - 1.0;
        // From rest the first mean slip lags by 2/(2 + z) of itself, z = h c N = 94.
        let lag = if step == 0 { 2.0 / 96.0 } else { 1e-9 };
        assert!(off.abs() <= lag, "step {step}: {off:e}");
    }
}

// -----------------------------------------------------------------------------------------------
// Flight
// -----------------------------------------------------------------------------------------------

#[test]
fn a_body_with_two_equal_moments_flies_exactly_and_without_an_iteration() {
    let stepper = Stepper::new(Coin::ring(1.0, 0.5))
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(GRAVITY)))
        .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step: 0.01 }))
        .unwrap();
    let mut state = State::default()
        .with_linear_velocity(DVec3::new(1.0, 2.0, 3.0))
        .with_angular_momentum(DVec3::new(0.3, 1.0, 0.2));
    let start = state;
    for _ in 0..100 {
        let step = stepper.step(&mut state).unwrap();
        assert_eq!(
            (step.iterations, step.evaluations, step.fallback),
            (0, 0, false)
        );
    }
    let expected = DVec3::new(1.0, 2.0, 3.0 - 0.5 * GRAVITY);
    // 100 steps, each a unit of the place.
    assert!(
        (state.position - expected).length() < 1e-13,
        "{}",
        state.position
    );
    let change = state.angular_momentum - start.angular_momentum;
    assert!(change.length() < 100.0 * f64::EPSILON, "{change}");
    // One step of a second turns as far as a hundred.
    let far = stepper
        .with_integrator(EnergyMomentum { time_step: 1.0 })
        .unwrap();
    let mut once = start;
    far.step(&mut once).unwrap();
    assert!(kit::angle_between(once.orientation, state.orientation) < 1e-13);
}

#[test]
fn the_middle_axis_flips_with_energy_and_momentum_kept() {
    let moments = DVec3::new(1.0, 2.0, 3.0);
    let stepper = Stepper::new(Solid::with_moments(moments))
        .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step: 0.01 }))
        .unwrap();
    let start = State::default().with_angular_momentum(DVec3::new(1e-3, 2.0, 0.0));
    let (momentum, energy) = (start.angular_momentum, stepper.energy(&start).total());
    let mut session = stepper.session(start);
    let (mut flips, mut up) = (0, true);
    for _ in 0..100_000 {
        session.step().unwrap();
        let now = (session.state().orientation * DVec3::Y).y;
        if (up && now < -0.9) || (!up && now > 0.9) {
            (flips, up) = (flips + 1, !up);
        }
    }
    let state = session.into_state();
    let turned = (state.angular_momentum - momentum).length() / momentum.length();
    let lost = (energy - stepper.energy(&state).total()) / energy;
    // A flip takes some 2 ln(4000)/(w √(1/3)) = 28 s.
    assert!((30..60).contains(&flips), "{flips}");
    // 1e5 steps of a solution to 1.8e-12 at worst; the energy of rounding.
    assert!(turned < 1e5 * 1.8e-12, "{turned:e}");
    assert!((0.0..1e5 * 4.4e-16).contains(&lost), "{lost:e}");
}

/// Bodies of about a kilogram: three different moments, two and one equal, sharp, round and thin.
fn nine_bodies() -> [(&'static str, Box<dyn RigidPointBody<f32>>); 9] {
    let size = |x: f64, y: f64, z: f64| <f32 as Real>::Vec3::new(x as f32, y as f32, z as f32);
    [
        ("book", Box::new(Cuboid::solid(1.0, size(0.3, 0.2, 0.05)))),
        (
            "brick",
            Box::new(Cuboid::solid(2.5, size(0.21, 0.1, 0.065))),
        ),
        ("cube", Box::new(Cuboid::solid(0.7, size(0.1, 0.1, 0.1)))),
        ("ring", Box::new(Coin::ring(1.0, 0.2))),
        ("coin", Box::new(SolidCoin::new(0.9, 0.15, 0.02))),
        ("ball", Box::new(Sphere::solid(0.5, 0.11))),
        (
            "egg",
            Box::new(Ellipsoid::solid(0.8, size(0.15, 0.11, 0.08))),
        ),
        ("rod", Box::new(Rod::new(0.3, 0.5))),
        ("capsule", Box::new(Capsule::solid(0.7, 0.05, 0.3))),
    ]
}

#[test]
fn free_flight_in_single_precision_keeps_both_momenta_without_an_iteration() {
    // The reproducer's book among them, which had 1.54 times its angular momentum after 5 s. Steady
    // and unsteady rotation, the middle axis too.
    let axes = [
        (9.0, 24.0, 15.0),
        (1e-3, 1.0, 0.0),
        (0.02, 0.01, 1.0),
        (1.0, 1e-4, 1e-4),
    ];
    let velocity = <f32 as Real>::Vec3::new(10.0, -3.0, 0.01);
    for (name, body) in nine_bodies() {
        for (time_step, seconds) in [(1.0 / 60.0, 5.0), (4e-3, 2.0), (1e-3, 1.0), (1e-4, 0.2)] {
            let stepper = Stepper::new(&*body)
                .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
                .unwrap();
            for (spin, (x, y, z)) in [0.3_f32, 30.0, 300.0]
                .into_iter()
                .flat_map(|spin| axes.map(|axis| (spin, axis)))
            {
                let axis = <f32 as Real>::Vec3::new(x, y, z).normalize();
                let start = tumble::State::<f32>::default().with_linear_velocity(velocity);
                let start = stepper.with_angular_velocity(start, axis * spin);
                let mut state = start;
                let before = stepper.energy(&start).rotation;
                let mut elapsed = 0.0;
                while elapsed < seconds {
                    let step = stepper.step(&mut state).unwrap();
                    assert_eq!(step.iterations, 0, "{name}");
                    elapsed += time_step;
                }
                let turned = (state.angular_momentum - start.angular_momentum).length()
                    / start.angular_momentum.length();
                let slowed = (state.linear_velocity - velocity).length() / velocity.length();
                let lost = (stepper.energy(&state).rotation / before - 1.0).abs();
                let case = format!("{name}, {time_step} s, {spin} rad/s about {axis}");
                // 1e-5 a second is asked, and a unit or two may go at once.
                let most = 1e-5 * seconds + 2.4e-7;
                assert!(turned <= most, "{case}: L is off by {turned:e}");
                assert!(slowed <= most, "{case}: v is off by {slowed:e}");
                // A unit of the energy a step at most.
                let steps = seconds / time_step;
                assert!(
                    lost <= 2.4e-7 + steps * 1.2e-7,
                    "{case}: the energy by {lost:e}"
                );
            }
        }
    }
}

#[test]
fn a_bounce_that_nothing_damps_keeps_its_energy_in_single_precision() {
    // 1e-3 after 100 s is asked. The reproducer's ring at 1/60 s had lost 69 % by then; what is
    // lost is linear in the steps, so that 20 s have a fifth.
    for (name, body) in nine_bodies() {
        for time_step in [1.0 / 60.0, 4e-3, 1e-3] {
            let stepper = Stepper::new(&*body)
                .and_then(|stepper| stepper.with_gravity(UniformGravity::down(9.8)))
                .and_then(|stepper| stepper.with_ground(FlatGround::level(1e5, 0.0)))
                .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
                .unwrap();
            let start = tumble::State::<f32>::at(<f32 as Real>::Vec3::new(0.0, 0.0, 1.0));
            let spin = <f32 as Real>::Vec3::new(3.0, 8.0, 5.0);
            let mut state = stepper.with_angular_velocity(start, spin);
            let before = stepper.energy(&state).total();
            stepper.advance(&mut state, 20.0).unwrap();
            let lost = 1.0 - stepper.energy(&state).total() / before;
            assert!(
                (0.0..=2e-4).contains(&lost),
                "{name}, {time_step} s: {lost:e}"
            );
        }
    }
}

#[test]
fn a_smooth_body_keeps_the_energy_of_its_bounces_in_single_precision() {
    // 1e-3 after 100 s. At 1/60 s the egg of the test above had lost 1.7e-2, this lens 0.16: a
    // residual of the size of the lever's rounding was accepted in any direction.
    let bodies = [
        (1.3, (0.2, 0.2, 0.06), 3e4, (5.0, 1.0, 9.0)),
        (0.4, (0.05, 0.04, 0.03), 1e5, (20.0, -7.0, 2.0)),
        (2.0, (0.3, 0.07, 0.06), 2e5, (0.0, 3.0, 1.0)),
        (0.8, (0.15, 0.11, 0.08), 1e5, (0.03, 0.08, 0.05)),
    ];
    let vector = |(x, y, z)| <f32 as Real>::Vec3::new(x, y, z);
    for (mass, semi_axes, stiffness, spin) in bodies {
        for time_step in [1.0 / 60.0, 4e-3, 1e-3] {
            let stepper = Stepper::new(Ellipsoid::solid(mass, vector(semi_axes)))
                .and_then(|stepper| stepper.with_gravity(UniformGravity::down(9.8)))
                .and_then(|stepper| stepper.with_ground(FlatGround::level(stiffness, 0.0)))
                .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
                .unwrap();
            let start = tumble::State::<f32>::at(vector((0.0, 0.0, 1.0)));
            let mut state = stepper.with_angular_velocity(start, vector(spin));
            let before = stepper.energy(&state).total();
            stepper.advance(&mut state, 100.0).unwrap();
            let lost = 1.0 - stepper.energy(&state).total() / before;
            assert!(
                (0.0..=1e-3).contains(&lost),
                "{semi_axes:?} m, {time_step} s: {lost:e}"
            );
        }
    }
}

#[test]
fn a_light_body_on_hard_springs_keeps_the_energy_of_its_bounces_in_single_precision() {
    // Bounces of a penetration depth of 0.1 to 0.4 mm, which is rounded to 1e-4 of itself. A loss
    // was kept and a gain was taken: 3e-3 in 20 s.
    let size = |x: f32, y: f32, z: f32| <f32 as Real>::Vec3::new(x, y, z);
    for mass in [1e-3, 1e-2] {
        let bodies: [(&str, Box<dyn RigidPointBody<f32>>); 5] = [
            ("box", Box::new(Cuboid::solid(mass, size(0.2, 0.14, 0.06)))),
            ("coin", Box::new(SolidCoin::new(mass, 0.1, 0.02))),
            ("capsule", Box::new(Capsule::solid(mass, 0.05, 0.2))),
            ("ball", Box::new(Sphere::solid(mass, 0.1))),
            (
                "egg",
                Box::new(Ellipsoid::solid(mass, size(0.1, 0.07, 0.05))),
            ),
        ];
        for ((name, body), time_step) in bodies
            .iter()
            .flat_map(|body| [4e-3, 1e-3].map(|time_step| (body, time_step)))
        {
            let stepper = Stepper::new(&**body)
                .and_then(|stepper| stepper.with_gravity(UniformGravity::down(9.8)))
                .and_then(|stepper| stepper.with_ground(FlatGround::level(1e6, 0.0)))
                .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
                .unwrap();
            let start = tumble::State::<f32>::at(size(0.0, 0.0, 1.0));
            let mut state = stepper.with_angular_velocity(start, size(3.0, 8.0, 5.0));
            let before = stepper.energy(&state).total();
            stepper.advance(&mut state, 40.0).unwrap();
            let lost = 1.0 - stepper.energy(&state).total() / before;
            assert!(
                (0.0..=1e-3).contains(&lost),
                "{name} of {mass} kg, {time_step} s: {lost:e}"
            );
        }
    }
}

#[test]
fn rounding_of_the_height_is_not_taken_from_the_motion() {
    // 100 m up, 1 cm/s across: 2.3 % of it went a second in f32. 10 km, 24 %. In f64 at 1e6 m 1e-5.
    fn across<R: Real>(height: f64) -> f64 {
        let number = R::from_f64;
        let body = Coin::ring(R::ONE, R::HALF);
        let stepper = Stepper::new(body)
            .and_then(|stepper| stepper.with_gravity(UniformGravity::down(number(GRAVITY))))
            .and_then(|stepper| {
                stepper.with_integrator(EnergyMomentum {
                    time_step: number(1e-3),
                })
            })
            .unwrap();
        let start = tumble::State::<R>::at(R::Vec3::new(R::ZERO, R::ZERO, number(height)))
            .with_linear_velocity(R::Vec3::new(number(0.01), R::ZERO, R::ZERO))
            .with_angular_momentum(R::Vec3::new(number(0.1), R::ZERO, number(0.2)));
        let mut state = start;
        stepper.advance(&mut state, R::ONE).unwrap();
        let off = |now: R::Vec3, then: R::Vec3| ((now - then).length() / then.length()).to_f64();
        let turned = off(state.angular_momentum, start.angular_momentum);
        let slowed = (state.linear_velocity.x().to_f64() / 0.01 - 1.0).abs();
        turned.max(slowed)
    }
    for height in [100.0, 1e4] {
        let off = across::<f32>(height);
        assert!(off < 1e-5, "f32, {height} m: {off:e}");
    }
    let off = across::<f64>(1e6);
    assert!(off < 1e-13, "f64: {off:e}");
}

#[test]
fn bodies_fall_right_in_single_precision() {
    // Released from rest in any direction of gravity.
    for (time_step, steps) in [(0.1_f32, 100), (1e-2, 1000), (1e-3, 10_000)] {
        for size in [9.81_f32, 100.0] {
            for (x, y, z) in [(0.0, 0.0, -1.0), (0.3, 0.2, -0.9)] {
                for place in [(30.0, 70.0, 100.0), (0.0, 0.0, 1000.0), (0.0, 0.0, 1.0)] {
                    let vector = <f32 as Real>::Vec3::new;
                    let acceleration = vector(x, y, z).normalize() * size;
                    let point = [ContactPoint::bare(vector(0.0, 0.0, 0.0))];
                    let stepper = Stepper::new(PointCloud::with_storage(point, &[1.0]).unwrap())
                        .and_then(|stepper| stepper.with_gravity(UniformGravity { acceleration }))
                        .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
                        .unwrap();
                    let from = vector(place.0, place.1, place.2);
                    let mut session = stepper.session(tumble::State::<f32>::at(from));
                    for _ in 0..steps {
                        session.step().unwrap();
                    }
                    let state = session.into_state();
                    let seconds = f64::from(time_step) * f64::from(steps);
                    let fallen = acceleration.as_dvec3() * (seconds * seconds / 2.0);
                    let off = (state.position.as_dvec3() - from.as_dvec3() - fallen).length();
                    let share = off / fallen.length();
                    // The time step's own rounding is in `seconds`.
                    assert!(
                        share < 1e-3,
                        "{time_step} s, {acceleration} m/s², from {from}: off by {share:e}"
                    );
                }
            }
        }
    }
}

/// Error of the displacement and of the velocity after 10 s, relative to those of the closed form.
fn errors_of_fall(acceleration: [f32; 3], from: [f32; 3], time_step: f32) -> (f64, f64) {
    let vector = |[x, y, z]: [f32; 3]| <f32 as Real>::Vec3::new(x, y, z);
    let (acceleration, from) = (vector(acceleration), vector(from));
    let stepper = Stepper::new(Cuboid::solid(0.35, vector([0.2, 0.15, 0.1])))
        .and_then(|stepper| stepper.with_gravity(UniformGravity { acceleration }))
        .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
        .unwrap();
    let mut session = stepper.session(tumble::State::<f32>::at(from));
    let steps = (10.0 / f64::from(time_step)).round();
    let mut energy = session.energy().total();
    for _ in 0..steps as u32 {
        assert_eq!(session.step().unwrap().iterations, 0);
        let after = session.energy().total();
        assert!(after <= energy);
        energy = after;
    }
    let state = session.into_state();
    // The time step's own rounding is in the time.
    let seconds = f64::from(time_step) * steps;
    let velocity = acceleration.as_dvec3() * seconds;
    let fallen = velocity * (seconds / 2.0);
    let off = state.position.as_dvec3() - from.as_dvec3() - fallen;
    let faster = state.linear_velocity.as_dvec3() - velocity;
    (
        off.length() / fallen.length(),
        faster.length() / velocity.length(),
    )
}

#[test]
fn bodies_fall_right_at_short_steps_in_single_precision() {
    // Other directions, heights and accelerations than those on which the rounding was chosen. A
    // loss of a unit of the energy in one step of four had put the body up to 8e-4 of the
    // displacement too low at 0.1 ms, and ten times as much at 0.01 ms.
    let scenes = [
        ([0.0, 0.0, -24.8], [12.0, -5.0, 40.0]),
        ([0.0, 0.0, -24.8], [-96.0, 424.0, -366.0]),
        ([9.9, -19.8, 7.4], [-410.0, 220.0, 600.0]),
        ([-4.4, 5.7, 5.3], [15.0, 70.0, 177.0]),
        ([37.0, -10.0, -40.0], [321.0, -156.0, -584.0]),
        ([7.0, 5.9, 3.9], [265.0, -211.0, 11.0]),
        ([0.0, 0.0, -60.0], [0.0, 0.0, 13.0]),
        ([-11.0, 0.0, 27.0], [0.0, 900.0, 0.0]),
    ];
    for (number, (acceleration, from)) in scenes.into_iter().enumerate() {
        let (off, _) = errors_of_fall(acceleration, from, 1e-4);
        assert!(
            off < 3e-4,
            "{acceleration:?} from {from:?}, 0.1 ms: {off:e}"
        );
        // A million steps.
        if number < 3 {
            let (off, _) = errors_of_fall(acceleration, from, 1e-5);
            assert!(
                off < 2e-3,
                "{acceleration:?} from {from:?}, 0.01 ms: {off:e}"
            );
        }
    }
}

#[test]
fn a_body_released_where_the_potential_energy_is_0_does_not_hang() {
    // Gravity is perpendicular to the position. The terms of the energy cancel, and any motion
    // exceeded their sum: the body kept its velocity of 0 for ever.
    let scenes = [
        ([0.3, 0.4, 0.0], [-40.0, 30.0, 25.0]),
        ([0.0, -0.5, 0.25], [210.0, 61.0, 122.0]),
        ([1.1, 2.2, -0.7], [330.0, -150.0, 47.142_857]),
        ([-0.02, 0.05, 0.03], [7.0, -5.0, 13.0]),
    ];
    for (acceleration, from) in scenes {
        let (off, faster) = errors_of_fall(acceleration, from, 1e-3);
        assert!(off < 1e-3, "{acceleration:?} from {from:?}: {off:e}");
        assert!(faster < 1e-3, "{acceleration:?} from {from:?}: {faster:e}");
    }
}

// -----------------------------------------------------------------------------------------------
// What a step tells, keeps and bears
// -----------------------------------------------------------------------------------------------

#[test]
fn memory_that_another_session_has_used_changes_no_bit() {
    for number in [1, 5, 7] {
        for time_step in [1e-3, 1e-2, 0.3] {
            let (stepper, start) = trial(number, time_step);
            let mut memory = EnergyMomentumWorkspace::new();
            let (other, elsewhere) = trial(3, 2e-3);
            let mut session = other.session_in(&mut memory, elsewhere);
            for _ in 0..300 {
                session.step().unwrap();
            }
            let (mut kept, mut fresh) = (stepper.session_in(&mut memory, start), start);
            for step in 0..2000 {
                let a = kept.step().unwrap();
                let b = stepper.step(&mut fresh).unwrap();
                let state = *kept.state();
                assert_eq!(state, fresh, "trial {number}, {time_step} s, step {step}");
                // A sleeper saves its work, and tells so.
                assert!(a == b || a.evaluations == 0, "{a:?} {b:?}");
            }
        }
    }
}

#[test]
fn a_coin_of_twelve_hundred_points_keeps_its_promises_beyond_the_contacts_that_a_step_remembers() {
    let points = vec![ContactPoint::default(); 1200];
    let stepper = scene(
        Coin::ring_with_storage(points, 1.0, 0.5),
        FlatGround::level(100.0, 0.05),
        Coulomb::as_in_the_report(0.3),
        1e-3,
    );
    let start = lying(-GRAVITY / 120_000.0)
        .with_linear_velocity(DVec3::new(1.0, 0.5, 0.0))
        .with_angular_momentum(DVec3::new(0.02, 0.0, 0.5));
    let mut session = stepper.session(start);
    let mut last = session.energy().total();
    for _ in 0..1500 {
        let step = session.step().unwrap();
        assert!(!step.fallback, "{step:?}");
        let energy = session.energy().total();
        assert!(energy <= last, "{last} to {energy}");
        last = energy;
    }
    let state = session.into_state();
    assert_eq!(state.linear_velocity, DVec3::ZERO);
    assert_eq!(state.angular_momentum, DVec3::ZERO);
}

#[test]
fn the_report_of_a_step_tells_what_it_took() {
    let (stepper, mut state) = trial(1, 1e-3);
    let step = stepper.step(&mut state).unwrap();
    assert_eq!(step.elapsed, 1e-3);
    assert!(step.iterations >= 1 && step.evaluations > step.iterations);
    assert!(!step.fallback);
    // The rest of a run is shorter than a step.
    let mut session = stepper.session(state);
    let step = session.step_within(2.5e-4).unwrap();
    assert_eq!((step.elapsed, session.time()), (2.5e-4, 2.5e-4));
    // The energy limiter removes what the solver's error would have added: a part in 1e11 of the
    // energy at most, all steps of a second together.
    let mut energy_removed = 0.0;
    for _ in 0..1000 {
        let step = session.step().unwrap();
        assert!(step.energy_removed >= 0.0);
        energy_removed += step.energy_removed;
    }
    assert!(energy_removed < 6.7e-11, "{energy_removed:e}");
    assert_eq!(Integrator::<f64>::order(stepper.integrator()), 2);
}

// -----------------------------------------------------------------------------------------------
// Where the lines of the guide's table of extremes change
// -----------------------------------------------------------------------------------------------

/// Far above a ground that is no plane, and beside it, a step is the same flight as without a
/// ground. As a step in contact it would turn by `2 atan(h ω/2)` in place of `h ω`.
#[test]
fn a_flight_over_any_ground_is_the_flight_without_one() {
    let law = SpringDamper {
        stiffness: 1e4,
        damping: 10.0,
    };
    let block = Block {
        centre: DVec3::Z * -0.5,
        half: DVec3::new(1.0, 1.0, 0.5),
    };
    let height_field = Waves {
        amplitude: 0.1,
        length: 1.0,
    };
    let (block, waves) = (
        Ground { law, shape: block },
        Ground {
            law,
            shape: Terrain { height_field },
        },
    );
    let grounds: [(&str, Box<dyn SpringDamperGround>); 4] = [
        ("a block", Box::new(block)),
        ("two blocks", Box::new([block, block])),
        ("waves", Box::new(waves)),
        ("a block and waves", Box::new((block, waves))),
    ];
    let bodies: [(&str, Box<dyn RigidPointBody>); 4] = [
        ("ball", Box::new(Sphere::solid(0.1, 0.02))),
        (
            "box",
            Box::new(Cuboid::solid(0.1, DVec3::new(0.1, 0.06, 0.02))),
        ),
        ("disc", Box::new(Disc::solid(0.1, 0.02, 40))),
        (
            "egg",
            Box::new(Ellipsoid::solid(0.1, DVec3::new(0.02, 0.03, 0.02))),
        ),
    ];
    // The last one is just above the highest place of each ground, and flies along it.
    let starts = [
        (DVec3::Z * 100.0, DVec3::ZERO),
        (DVec3::new(0.3, 0.2, 0.15), DVec3::X),
    ];
    for ((on, ground), (name, body)) in grounds
        .iter()
        .flat_map(|g| bodies.iter().map(move |b| (g, b)))
    {
        for (position, velocity) in starts {
            let aloft = Stepper::new(&**body)
                .and_then(|stepper| {
                    stepper.with_integrator(EnergyMomentum {
                        time_step: 1.0 / 60.0,
                    })
                })
                .unwrap();
            let above = aloft.with_ground(&**ground).unwrap();
            let spin = DVec3::new(60.0, 20.0, 50.0);
            let start = State::at(position).with_linear_velocity(velocity);
            let start = aloft.with_angular_velocity(start, spin);
            let (mut free, mut over) = (start, start);
            for _ in 0..40 {
                aloft.step(&mut free).unwrap();
                let step = above.step(&mut over).unwrap();
                assert!(step.iterations == 0 && free == over, "{name} over {on}");
            }
        }
    }
}

#[test]
fn a_steady_rotation_about_a_principal_axis_is_exact_in_flight_at_any_step() {
    // Three different moments, spun about the axis of the largest: the parts of a long step are
    // rotations about that axis.
    let body = Solid::with_moments(DVec3::new(1.0, 2.0, 2.5));
    let integrator = EnergyMomentum { time_step: 0.01 };
    let stepper = Stepper::new(body)
        .and_then(|stepper| stepper.with_integrator(integrator))
        .unwrap();
    for angle in [0.01, 0.1, 0.34, 0.36, 1.0, 10.0, 1e3_f64] {
        let spin = DVec3::Z * (angle / integrator.time_step);
        let mut state = State::default().with_angular_momentum(spin * 2.5);
        stepper.step(&mut state).unwrap();
        let expected = DQuat::from_rotation_z(angle);
        // The angle itself is rounded, and sums of it are.
        let off = kit::angle_between(expected, state.orientation);
        assert!(
            off < 1e-13 * (1.0 + angle) + 3e-8 * f64::from(angle > 100.0),
            "{angle}: {off:e}"
        );
    }
}

#[test]
fn a_moment_below_64_units_in_the_last_place_of_the_largest_one_counts_as_none() {
    /// The spin about the axis of a moment of so many units, with the angular momentum of 1 rad/s.
    fn spin<R: Real>(units: f64) -> f64 {
        let moment = R::EPSILON * R::from_f64(units);
        let tensor = R::Mat3::from_diagonal(R::Vec3::new(R::ONE, R::ONE, moment));
        let properties = InertiaProperties::<R>::new(R::ONE, tensor).unwrap();
        let axes = State::<R>::default().rotation().axes();
        let momentum = R::Vec3::new(R::ZERO, R::ZERO, moment);
        properties.angular_velocity(&axes, momentum).z().to_f64()
    }
    assert_eq!([spin::<f64>(63.0), spin::<f32>(63.0)], [0.0, 0.0]);
    // A few roundings.
    assert!((spin::<f64>(65.0) - 1.0).abs() < 1e-15);
    assert!((spin::<f32>(65.0) - 1.0).abs() < 5e-7);
}

#[test]
fn far_from_the_origin_rest_is_where_the_energy_is_lowest_to_its_rounding() {
    /// Deviation from `m g/K` = 9.8 mm at which a kilogram comes to rest on ground at this
    /// height, m.
    fn off<R: Real>(height: f64) -> f64 {
        let number = R::from_f64;
        let point = [ContactPoint::bare(R::Vec3::ZERO)];
        let ground = FlatGround::level(number(1e3), number(30.0));
        let stepper = Stepper::new(PointCloud::with_storage(point, &[R::ONE]).unwrap())
            .and_then(|stepper| stepper.with_ground(ground.on(Plane::level(number(height)))))
            .and_then(|stepper| stepper.with_gravity(UniformGravity::down(number(GRAVITY))))
            .and_then(|stepper| {
                stepper.with_integrator(EnergyMomentum {
                    time_step: number(0.01),
                })
            })
            .unwrap();
        let place = R::Vec3::new(R::ZERO, R::ZERO, number(height));
        let mut state = State::<R> {
            position: place,
            ..State::default()
        };
        for _ in 0..2000 {
            stepper.step(&mut state).unwrap();
        }
        let depth = (number(height) - state.position.z()).to_f64();
        (depth - GRAVITY / 1e3).abs()
    }
    // At x from the lowest place the energy is K x²/2 higher; 64 units in the last place of the
    // energies' sizes count as its rounding.
    let depth = GRAVITY / 1e3;
    let lost = |height: f64, epsilon: f64| (128.0 * epsilon * (height + depth) / depth).sqrt();
    for height in [0.0, 1.0, 1e3, 1e6, 1e9] {
        let off = off::<f64>(height) / depth;
        assert!(off <= lost(height, f64::EPSILON), "{height:e} m: {off:e}");
    }
    for height in [0.0, 1.0, 10.0, 100.0] {
        let off = off::<f32>(height) / depth;
        let epsilon = f64::from(f32::EPSILON);
        assert!(off <= lost(height, epsilon), "{height:e} m: {off:e}");
    }
    // Beyond 128 ε times the height = m g/K, the depth is lost in it.
    assert!(lost(1e12, f64::EPSILON) > 1.0 && off::<f64>(1e14) >= depth * 0.5);
}

#[test]
fn a_bounce_within_a_step_keeps_its_energy_and_loses_its_timing() {
    /// Error of the time that a bounce lasts, over that time π/ω, for a step of so many 1/ω; no
    /// damper, no gravity.
    fn mistimed(step: f64) -> f64 {
        let time_step = step * 1e-3;
        let stepper = Stepper::new(point_mass(1.0))
            .and_then(|stepper| stepper.with_ground(FlatGround::level(1e6, 0.0)))
            .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
            .unwrap();
        let above = time_step / 3.0;
        let mut state = State::at(DVec3::Z * above).with_linear_velocity(-DVec3::Z);
        let mut steps = 0;
        while state.position.z <= 0.0 || state.linear_velocity.z <= 0.0 {
            stepper.step(&mut state).unwrap();
            steps += 1;
        }
        // The speed is what it was, to rounding of each step.
        assert!((state.linear_velocity.z - 1.0).abs() < f64::from(steps) * 4e-16);
        let took = f64::from(steps) * time_step - above - state.position.z;
        (took / (PI * 1e-3) - 1.0).abs()
    }
    // Of the contact's half swing the rule makes π/ω' with ω' = (2/h) atan(hω/2).
    for step in [0.01, 0.1, 1.0, 10.0] {
        let longer = (step / 2.0) / (step / 2.0_f64).atan() - 1.0;
        let error = mistimed(step);
        // What is left is the way from the surface to a whole step.
        assert!(
            (error / longer - 1.0).abs() < 0.1,
            "{step}: {error}, {longer}"
        );
        assert_eq!(error < 0.01, step < 0.3, "{step}: {error}");
    }
    assert!(mistimed(10.0) > 1.0);
}

/// A body that falls at its terminal speed drifts with the wind. Each step moves it across gravity
/// by less than a unit in the last place of its position. On a grid of 32 units, the position of
/// the first and the last scene did not change in ten seconds, and that of the others was up to
/// 22 % off.
#[test]
fn a_body_in_single_precision_drifts_with_the_wind() {
    for (from, time_step, wind) in [
        (100.0_f32, 1e-3, 0.05),
        (100.0, 1e-3, 0.1),
        (100.0, 1e-3, 0.2),
        (300.0, 1e-2, 1.0),
        (10.0, 1e-4, 0.05),
    ] {
        // The linear drag balances the weight of 0.1 g at 0.5 m/s.
        let stepper = tumble::Stepper::builder(Sphere::<f32>::solid(1e-4, 0.01))
            .gravity(UniformGravity::down(9.8_f32))
            .force(Wind {
                velocity: Vec3::X * wind,
                force: AirDrag::linear(1.96e-3_f32),
            })
            .integrator(EnergyMomentum { time_step })
            .build()
            .unwrap();
        let velocity = Vec3::new(wind, 0.0, -0.5);
        let mut state = State::at(Vec3::new(from, 0.0, from)).with_linear_velocity(velocity);
        stepper.advance(&mut state, 10.0).unwrap();
        // The mean of random rounding: 1e-3 of the way is four of its standard deviations or more
        // (a uniform error of a unit, in the root of the number of steps).
        let drift = state.position.x - from;
        assert!(
            (drift / (wind * 10.0) - 1.0).abs() < 5e-3,
            "{from} m, {time_step} s: {drift} m of {} m",
            wind * 10.0
        );
    }
}

/// The end of a step in `f32` is searched among its last places, of which each component has its
/// own. So the velocity across a tilted gravity takes random steps, most where a step adds little.
#[test]
fn rounding_in_f32_hardly_turns_the_velocity_across_a_tilted_gravity() {
    let golden =
        |case: u16, power: i32| (f64::from(case) * 1.112_775_684_278_706_f64.powi(-power)).fract();
    let direction = |height: f64, turn: f64| {
        let (z, angle) = (2.0 * height - 1.0, 2.0 * PI * turn);
        let level = (1.0 - z * z).sqrt();
        DVec3::new(level * angle.cos(), level * angle.sin(), z)
    };
    let mut worst = 0.0_f64;
    for case in 1..=60 {
        let of = |power| golden(case, power);
        // 1e-3 to 100 m/s², 0.01 to 10 m/s.
        let down = direction(of(1), of(2));
        let gravity = (down * 10.0_f64.powf(5.0 * of(3) - 3.0)).as_vec3();
        let speed = 10.0_f64.powf(3.0 * of(4) - 2.0);
        let velocity = (direction(of(5), of(6)) * speed).as_vec3();
        let stepper = Stepper::builder(Sphere::solid(1.0_f32, 0.1))
            .gravity(UniformGravity {
                acceleration: gravity,
            })
            .integrator(EnergyMomentum { time_step: 1e-3 })
            .build()
            .unwrap();
        let mut session = stepper.session(State::at(Vec3::ZERO).with_linear_velocity(velocity));
        session.advance(10.0).unwrap();
        let end = session.state().linear_velocity;
        let change = (end - velocity).as_dvec3();
        let across = (change - down * down.dot(change)).length();
        worst = worst.max(across / 10.0 / f64::from(end.length().max(velocity.length())));
    }
    // It is the rounding that is seen, and no less.
    assert!((1e-7..5e-5).contains(&worst), "{worst:e}");
}
