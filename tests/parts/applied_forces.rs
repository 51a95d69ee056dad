//! Applied forces: closed forms of drag, lift and wind under every integrator, the orders, the
//! energy that never increases, and the work of drives.

// Helpers of these tests fail by panicking, like the tests. Works that nothing does are exactly 0, and
// random scenes are rounded to single precision.
#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    clippy::cast_possible_truncation
)]

use crate::kit::{self, erased::Stepper};
use core::ops::ControlFlow;
use proptest::prelude::*;
use tumble::contract::{CheckPlan, ForceRange, Requirement, check_force};
use tumble::error::LawQuantity;
use tumble::glam::{DVec3, Vec3};
use tumble::real::Vector;
use tumble::{
    AdaptiveNystrom, AirDrag, AnyIntegrator, BogackiShampine32, ConstantForce, Coulomb, Cuboid,
    DormandPrince54, Dynamics, EnergyMomentum, FlatGround, Flight, Force, ForwardEuler, Ledger,
    Motion, NoForce, Nystrom, PointCloud, Radau5, Real, RigidPointBody, Rk4, Sample, Sphere,
    SpinDrag, SpinLift, State, StepError, StrangSplitting, SymplecticEuler, UniformGravity, Wind,
    Wrench,
};

/// Mass and radius of a tennis ball, kg and m, and the density of air, kg/m³.
const BALL: [f64; 2] = [0.0577, 0.0335];
const AIR: f64 = 1.2;
const G: f64 = 9.81;

fn ball() -> Sphere {
    Sphere::shell(BALL[0], BALL[1])
}

fn drag() -> AirDrag {
    AirDrag::quadratic(0.55, core::f64::consts::PI * BALL[1] * BALL[1], AIR)
}

fn lift() -> SpinLift {
    SpinLift::tennis_ball(BALL[1], AIR)
}

/// A brick with three different moments of inertia, kg and m.
fn brick() -> Cuboid {
    Cuboid::solid(0.4, DVec3::new(0.2, 0.1, 0.06))
}

/// Every integrator with a fixed step (s), and its order.
fn fixed(h: f64) -> [(AnyIntegrator, f64); 6] {
    [
        (ForwardEuler { time_step: h }.into(), 1.0),
        (SymplecticEuler { time_step: h }.into(), 1.0),
        (StrangSplitting { time_step: h }.into(), 2.0),
        (Rk4 { time_step: h }.into(), 4.0),
        (Nystrom { time_step: h }.into(), 4.0),
        (EnergyMomentum { time_step: h }.into(), 2.0),
    ]
}

/// The adaptive integrators of an order above 2, with a tolerance (m).
fn adaptive(tolerance: f64) -> [AnyIntegrator; 4] {
    [
        BogackiShampine32::new(tolerance).into(),
        DormandPrince54::new(tolerance).into(),
        AdaptiveNystrom::new(tolerance).into(),
        Radau5::new(tolerance).into(),
    ]
}

/// Every integrator, with a step of 1 ms or a tolerance of 1e-9 m.
fn integrators() -> Vec<AnyIntegrator> {
    let fixed = fixed(1e-3).map(|(integrator, _)| integrator);
    [&fixed[..], &adaptive(1e-9)].concat()
}

/// A scene without ground.
fn air<'a>(
    body: impl RigidPointBody + 'a,
    gravity: f64,
    force: &'a dyn Force,
    integrator: AnyIntegrator,
) -> Stepper<'a, AnyIntegrator> {
    Stepper::builder(body)
        .gravity(UniformGravity::down(gravity))
        .force(force)
        .integrator(integrator)
        .build()
        .unwrap()
}

/// End of a flight of a ball in air.
fn flown(
    gravity: f64,
    force: &dyn Force,
    integrator: AnyIntegrator,
    start: State,
    seconds: f64,
) -> State {
    let mut state = start;
    air(ball(), gravity, force, integrator)
        .advance(&mut state, seconds)
        .unwrap();
    state
}

/// The error of each integrator with a fixed step decreases with its order from a step of 0.02 s to
/// one of 0.01 s, and is at most `largest` at 0.01 s. An error near the rounding shows no order. The
/// error of an adaptive integrator is at most thirty tolerances.
fn converges(largest: f64, rounding: f64, error: impl Fn(AnyIntegrator) -> f64) {
    let pairs = fixed(0.02).into_iter().zip(fixed(0.01));
    for ((coarse, order), (fine, _)) in pairs {
        let [e, f] = [coarse, fine].map(&error);
        let is_order = (e / f).log2() > order - 0.5 || f < rounding;
        assert!(is_order && f < largest, "{fine:?}: {e:e} {f:e}");
    }
    for tolerance in [1e-6, 1e-9] {
        for integrator in adaptive(tolerance) {
            let e = error(integrator);
            assert!(e < 30.0 * tolerance, "{integrator:?}: {e:e}");
        }
    }
}

#[test]
fn a_fall_with_quadratic_drag_follows_the_hyperbolic_tangent() {
    let terminal = (BALL[0] * G / drag().quadratic).sqrt();
    let seconds = 3.0;
    let speed = terminal * (G * seconds / terminal).tanh();
    let fallen = terminal * terminal / G * (G * seconds / terminal).cosh().ln();
    converges(0.2, 1e-12, |integrator| {
        let end = flown(G, &drag(), integrator, State::at(DVec3::ZERO), seconds);
        (end.linear_velocity.z + speed).abs() + (end.position.z + fallen).abs()
    });
    // Later the speed is the terminal one. It is about 23 m/s.
    let end = flown(
        G,
        &drag(),
        EnergyMomentum { time_step: 0.01 }.into(),
        State::at(DVec3::ZERO),
        60.0,
    );
    // Half of the drag acts before a step and half after it, with gravity in between. If each half
    // were exact, the speed after a step would be `v/√(1 + (g h/2v)²)` for the terminal speed v.
    let expected = (G * 0.01).powi(2) / (8.0 * terminal);
    let off = end.linear_velocity.z + terminal;
    assert!((0.8..1.3).contains(&(off / expected)), "{off:e}");
}

#[test]
fn a_projectile_with_linear_drag_follows_its_closed_form() {
    let per_speed = 0.03;
    let (seconds, rate) = (2.0, per_speed / BALL[0]);
    let start = State::at(DVec3::Z).with_linear_velocity(DVec3::new(12.0, -3.0, 9.0));
    let free = DVec3::Z * (-G / rate);
    let left = (-rate * seconds).exp();
    let velocity = free + (start.linear_velocity - free) * left;
    let position =
        start.position + free * seconds + (start.linear_velocity - free) * ((1.0 - left) / rate);
    converges(0.2, 1e-12, |integrator| {
        let force = AirDrag::linear(per_speed);
        let end = flown(G, &force, integrator, start, seconds);
        (end.position - position).length() + (end.linear_velocity - velocity).length()
    });
}

#[test]
fn stokes_drag_and_its_torque_decay_exponentially() {
    let (viscosity, seconds) = (0.9, 0.7); // glycerol, Pa s
    let [mass, radius] = BALL;
    let force = (
        AirDrag::stokes(radius, viscosity),
        SpinDrag::kirchhoff(radius, viscosity),
    );
    let inertia = 2.0 / 3.0 * mass * radius * radius;
    let start = State::at(DVec3::ZERO)
        .with_linear_velocity(DVec3::new(2.0, 1.0, -0.5))
        .with_angular_momentum(DVec3::new(1e-3, -2e-3, 5e-4));
    let pi = core::f64::consts::PI;
    let slowed = (-6.0 * pi * viscosity * radius / mass * seconds).exp();
    let spun_down = (-8.0 * pi * viscosity * radius.powi(3) / inertia * seconds).exp();
    converges(0.2, 1e-13, |integrator| {
        let end = flown(0.0, &force, integrator, start, seconds);
        let off = end.linear_velocity - start.linear_velocity * slowed;
        let spin = end.angular_momentum - start.angular_momentum * spun_down;
        off.length() + spin.length() / (mass * radius)
    });
}

#[test]
fn quadratic_spin_drag_slows_a_spin_as_one_over_time() {
    let (per_square, seconds) = (3e-8, 4.0);
    let force = SpinDrag {
        linear: 0.0,
        quadratic: per_square,
    };
    let inertia = 2.0 / 3.0 * BALL[0] * BALL[1] * BALL[1];
    let first = 300.0;
    let last = first / (1.0 + per_square * first * seconds / inertia);
    let start = State::at(DVec3::ZERO).with_angular_momentum(DVec3::Y * (inertia * first));
    converges(1.0, 1e-9, |integrator| {
        let end = flown(0.0, &force, integrator, start, seconds);
        (end.angular_momentum.length() / inertia - last).abs()
    });
}

#[test]
fn lift_turns_the_velocity_on_a_circle_and_does_no_work() {
    let (spin, speed, seconds) = (200.0, 30.0, 5.0);
    let inertia = 2.0 / 3.0 * BALL[0] * BALL[1] * BALL[1];
    let start = State::at(DVec3::ZERO)
        .with_linear_velocity(DVec3::X * speed)
        .with_angular_momentum(DVec3::Z * (inertia * spin));
    let area = core::f64::consts::PI * BALL[1] * BALL[1];
    let coefficient = lift().coefficient(BALL[1] * spin / speed);
    let rate = 0.5 * AIR * area * coefficient * speed / BALL[0]; // rad/s
    let (sin, cos) = (rate * seconds).sin_cos();
    let centre = DVec3::Y * (speed / rate);
    let position = centre + DVec3::new(sin, -cos, 0.0) * (speed / rate);
    converges(40.0, 1e-9, |integrator| {
        let end = flown(0.0, &lift(), integrator, start, seconds);
        (end.position - position).length()
    });
    let motion = Motion {
        linear_velocity: DVec3::new(3.0, -20.0, 7.0),
        angular_velocity: DVec3::new(50.0, 120.0, -300.0),
        ..moving(&start)
    };
    let wrench = lift().wrench(&motion);
    assert!(wrench.power(&motion).abs() < 1e-15 * wrench.force.length() * 20.0);
    // Under `EnergyMomentum` the speed never increases, and what rounding takes is small.
    let end = flown(
        0.0,
        &lift(),
        EnergyMomentum { time_step: 0.001 }.into(),
        start,
        seconds,
    );
    let lost = 1.0 - end.linear_velocity.length() / speed;
    assert!((0.0..1e-11).contains(&lost), "{lost:e}");
}

/// Motion of a ball in a state.
fn moving(state: &State) -> Motion {
    use tumble::Dynamics;
    let stepper = Stepper::new(ball()).unwrap();
    stepper.scene().motion(state)
}

#[test]
fn topspin_presses_a_ball_down_and_the_coefficient_has_its_limits() {
    let motion = Motion {
        linear_velocity: DVec3::X * 30.0,
        // The top of the ball moves forwards.
        angular_velocity: DVec3::Y * 200.0,
        ..moving(&State::at(DVec3::ZERO))
    };
    assert!(lift().wrench(&motion).force.z < 0.0);
    // 1/(2 + v/(r ω)), Stepanek (1988).
    let parameter = 0.223;
    assert!((lift().coefficient(parameter) - 1.0 / (2.0 + 1.0 / parameter)).abs() < 1e-15);
    assert!((lift().coefficient(1e9) - 0.5).abs() < 1e-8);
    // Without motion, and without spin, there is no lift.
    let still = Motion {
        linear_velocity: DVec3::ZERO,
        ..motion
    };
    assert_eq!(lift().wrench(&still), Wrench::ZERO);
}

#[test]
fn a_throw_in_wind_is_a_throw_in_still_air_seen_from_the_ground() {
    let wind = DVec3::new(4.0, -7.0, 1.5);
    let (start, seconds) = (
        State::at(DVec3::Z)
            .with_linear_velocity(DVec3::new(20.0, 3.0, 5.0))
            .with_angular_momentum(DVec3::new(0.0, 0.004, 0.006)),
        1.5,
    );
    let still = (drag(), lift());
    let seen_from_air = State {
        linear_velocity: start.linear_velocity - wind,
        ..start
    };
    for integrator in integrators() {
        let blown = Wind {
            velocity: wind,
            force: still,
        };
        let blown = flown(G, &blown, integrator, start, seconds);
        let calm = flown(G, &still, integrator, seen_from_air, seconds);
        let off = blown.position - calm.position - wind * seconds;
        // An adaptive method takes other steps, by the rounding of its error estimate.
        assert!(off.length() < 1e-11, "{integrator:?}: {:e}", off.length());
    }
}

#[test]
fn every_method_keeps_its_order_with_drag_lift_and_wind_on_an_asymmetric_body() {
    let force = {
        let spin = SpinDrag {
            linear: 1e-4,
            quadratic: 1e-6,
        };
        let wind = Wind {
            velocity: DVec3::new(3.0, 1.0, 0.0),
            force: AirDrag {
                linear: 0.02,
                quadratic: 0.005,
            },
        };
        (wind, lift(), spin)
    };
    let start = State::at(DVec3::Z)
        .with_linear_velocity(DVec3::new(6.0, -2.0, 5.0))
        .with_angular_momentum(DVec3::new(0.004, 0.009, -0.003));
    let end = |integrator: AnyIntegrator| {
        let mut state = start;
        air(brick(), G, &force, integrator)
            .advance(&mut state, 1.0)
            .unwrap();
        state
    };
    let exact = end(DormandPrince54::new(1e-13).into());
    converges(0.2, 1e-12, |integrator| {
        let end = end(integrator);
        let turn = end.orientation.angle_between(exact.orientation);
        (end.position - exact.position).length() + 0.1 * turn
    });
}

#[test]
fn a_drag_that_stops_a_body_within_the_step_stops_it() {
    let (per_speed, speed, h) = (1e6, 30.0, 1e-3);
    let force = (AirDrag::linear(per_speed), SpinDrag::linear(1e3));
    let stepper = air(ball(), 0.0, &force, EnergyMomentum { time_step: h }.into());
    let mut state = State::at(DVec3::ZERO)
        .with_linear_velocity(DVec3::X * speed)
        .with_angular_momentum(DVec3::Y * 0.01);
    stepper.step(&mut state).unwrap();
    // Each half of the push leaves (1 - 2γ)/(γ² z), with z half the step over the time of decay.
    let gamma = 1.0 - core::f64::consts::FRAC_1_SQRT_2;
    let left = |rate: f64| (1.0 - 2.0 * gamma) / (gamma * gamma * (h / 2.0 * rate));
    let inertia = 2.0 / 3.0 * BALL[0] * BALL[1] * BALL[1];
    let [moving, turning] = [left(per_speed / BALL[0]), left(1e3 / inertia)];
    assert!(state.linear_velocity.length() < 1.01 * speed * moving * moving);
    assert!(state.angular_momentum.length() < 1.01 * 0.01 * turning * turning);
}

/// In wind, a strong drag is the small difference of large terms. Single precision still gives the
/// velocity and the work of double precision, however strong the drag is. At the strongest, the
/// rounding of the terms alone would move the body by 1e7 m/s in a step.
#[test]
fn wind_carries_a_body_in_single_precision_as_in_double() {
    fn carried<R: Real>(linear: f64) -> [f64; 4] {
        let number = R::from_f64;
        let vector = |x, y, z| R::Vec3::new(number(x), number(y), number(z));
        let wind = Wind {
            velocity: vector(3.0, -2.0, 1.0),
            force: AirDrag {
                linear: number(linear),
                quadratic: R::ZERO,
            },
        };
        let time_step = number(0.5);
        let stepper = Stepper::new(Sphere::solid(number(0.3), number(0.1)))
            .and_then(|stepper| stepper.with_force(wind))
            .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
            .unwrap();
        let mut state = State::at(R::Vec3::ZERO).with_linear_velocity(vector(5.0, 0.0, -1.0));
        let step = stepper.step(&mut state).unwrap();
        let v = state.linear_velocity;
        [v.x(), v.y(), v.z(), step.drive_work].map(Real::to_f64)
    }
    for exponent in -3..=12 {
        let linear = 10.0_f64.powi(exponent);
        let [double, single] = [carried::<f64>(linear), carried::<f32>(linear)];
        let size = double.iter().fold(0.0, |most, v| f64::max(most, v.abs()));
        for (double, single) in double.iter().zip(&single) {
            let off = (double - single).abs();
            assert!(off < 1e-5 * size, "{linear} N s/m: {single} for {double}");
        }
        let [x, y, z, _] = double;
        let off = (DVec3::new(x, y, z) - DVec3::new(3.0, -2.0, 1.0)).length();
        // Two pushes of a quarter of a second. Each multiplies the difference by at most 5 m/(c h),
        // where c h/m is large: (1 - 2γ)/γ² is 4.8.
        let most = 3.5 * (5.0 * 0.3 / (linear * 0.25)).powi(2) + 1e-9;
        assert!(
            linear < 10.0 || off < most,
            "{linear} N s/m: off by {off:e} m/s"
        );
    }
}

#[test]
fn a_constant_force_is_gravity_of_its_own() {
    let start = State::at(DVec3::Z).with_linear_velocity(DVec3::new(1.0, 2.0, 3.0));
    let force = ConstantForce {
        force: DVec3::Z * (-G * BALL[0]),
    };
    for integrator in integrators() {
        let pulled = flown(0.0, &force, integrator, start, 1.0);
        let fallen = flown(G, &NoForce, integrator, start, 1.0);
        let off = (pulled.position - fallen.position).length();
        assert!(off < 1e-13, "{integrator:?}: {off:e}");
    }
    let stepper = Stepper::builder(ball()).force(force).build().unwrap();
    let energy = stepper.energy(&State::at(DVec3::Z * 2.0));
    assert!((energy.gravity - 2.0 * G * BALL[0]).abs() < 1e-15);
    // Closed-form flight takes it, too.
    let flight = Stepper::builder(ball())
        .force(force)
        .ground(FlatGround::level(1e4, 0.0))
        .integrator(Flight(EnergyMomentum { time_step: 1e-3 }))
        .build()
        .unwrap();
    assert!(flight.step(&mut State::at(DVec3::Z)).unwrap().elapsed > 0.4);
}

#[test]
fn flight_takes_no_closed_form_under_drag() {
    let stepper = Stepper::builder(ball())
        .gravity(UniformGravity::down(G))
        .force(drag())
        .integrator(Flight(EnergyMomentum { time_step: 1e-3 }))
        .build()
        .unwrap();
    let step = stepper.step(&mut State::at(DVec3::Z)).unwrap();
    assert!((step.elapsed - 1e-3).abs() < 1e-15);
}

#[test]
fn a_body_at_rest_in_still_air_sleeps_as_without_air() {
    let stepper = Stepper::builder(brick())
        .gravity(UniformGravity::down(G))
        .ground(FlatGround::level(1e4, 20.0))
        .friction(Coulomb {
            coefficient: 0.4,
            slip_speed: 1e-4,
        })
        .force((drag(), SpinDrag::linear(1e-4)))
        .build()
        .unwrap();
    let mut session = stepper.session(State::at(DVec3::Z * 0.05));
    session.advance(3.0).unwrap();
    let rest = *session.state();
    session.advance(1.0).unwrap();
    assert_eq!(rest, *session.state());
    assert_eq!(rest.linear_velocity, DVec3::ZERO);
}

#[test]
fn a_drag_that_is_no_drag_is_an_error_of_the_step_and_the_state_stays() {
    struct Thrust(f64);
    impl Force for Thrust {
        fn wrench(&self, motion: &Motion) -> Wrench {
            Wrench::of_force(motion.linear_velocity * self.0)
        }
        fn is_passive(&self) -> bool {
            true
        }
    }
    for (value, quantity) in [
        (1.0, LawQuantity::AppliedPower),
        (f64::NAN, LawQuantity::AppliedForce),
    ] {
        for integrator in integrators() {
            let thrust = Thrust(value);
            let stepper = air(ball(), 0.0, &thrust, integrator);
            let start = State::at(DVec3::Z).with_linear_velocity(DVec3::X);
            let mut state = start;
            let error = stepper.step(&mut state).unwrap_err();
            let is_named =
                matches!(error, StepError::BrokenLaw { quantity: q, .. } if q == quantity);
            assert!(is_named, "{integrator:?}: {error}");
            assert!(error.to_string().contains("applied force"), "{error}");
            assert_eq!(state, start);
        }
    }
}

#[test]
fn invalid_parameters_are_named_when_the_scene_is_composed() {
    let error = |force: &dyn Force| {
        let scene = Stepper::builder(ball()).force(force).build();
        scene.map(|_| ()).unwrap_err().to_string()
    };
    assert!(error(&AirDrag::linear(-1.0)).contains("linear drag must be at least 0"));
    assert!(error(&AirDrag::quadratic(f64::NAN, 1.0, 1.0)).contains("quadratic drag"));
    assert!(error(&SpinDrag::linear(-1.0)).contains("linear spin drag"));
    assert!(error(&SpinLift::tennis_ball(0.0, 1.2)).contains("radius of the lift"));
    let storm = Wind {
        velocity: DVec3::X * f64::INFINITY,
        force: drag(),
    };
    assert!(error(&storm).contains("wind must be finite"));
    let push = ConstantForce {
        force: DVec3::X * f64::NAN,
    };
    assert!(error(&push).contains("constant force must be finite"));
}

#[test]
fn an_outcome_is_decided_in_still_air_and_never_in_wind() {
    let coin = || {
        tumble::Stepper::builder(tumble::Coin::ring(0.01, 0.01))
            .gravity(UniformGravity::down(G))
            .ground(FlatGround::level(1e4, 0.5))
    };
    assert!(coin().force(drag()).build().unwrap().barriers().is_some());
    let wind = Wind {
        velocity: DVec3::X,
        force: drag(),
    };
    assert!(coin().force(wind).build().unwrap().barriers().is_none());
}

#[test]
fn a_scene_without_an_applied_force_is_no_larger() {
    type Bare = tumble::Stepper<Sphere, FlatGround, Coulomb, UniformGravity, EnergyMomentum>;
    type Pushed =
        tumble::Stepper<Sphere, FlatGround, Coulomb, UniformGravity, EnergyMomentum, f64, AirDrag>;
    let drag = core::mem::size_of::<AirDrag>();
    assert_eq!(
        core::mem::size_of::<Bare>() + drag,
        core::mem::size_of::<Pushed>()
    );
}

/// The audit of a bouncing, spinning ball in wind and still air.
fn audited(force: &dyn Force, integrator: AnyIntegrator) -> (Ledger, f64) {
    let stepper = Stepper::builder(ball())
        .gravity(UniformGravity::down(G))
        .ground(FlatGround::level(2e4, 8.0))
        .friction(Coulomb {
            coefficient: 0.5,
            slip_speed: 1e-2,
        })
        .force(force)
        .integrator(integrator)
        .build()
        .unwrap();
    let mut state = State::at(DVec3::Z)
        .with_linear_velocity(DVec3::new(10.0, 0.0, -2.0))
        .with_angular_momentum(DVec3::new(0.0, -0.01, 0.003));
    let (mut ledger, mut work) = (Ledger::new(), 0.0);
    let mut session = stepper.session(state);
    for _ in 0..500 {
        let step = session.step().unwrap();
        work += step.drive_work;
    }
    stepper.run(&mut state, 0.5, &mut ledger).unwrap();
    (ledger, work)
}

#[test]
fn the_ledger_books_drag_and_drive_apart() {
    let accurate = || DormandPrince54::new(1e-10).into();
    let (ledger, _) = audited(&(drag(), lift()), accurate());
    assert!(ledger.work().drag < -0.1, "{:?}", ledger.work());
    assert_eq!(ledger.work().drive, 0.0);
    assert!(ledger.energy_error().abs() < 1e-8);

    let wind = Wind {
        velocity: DVec3::new(15.0, 5.0, 0.0),
        force: (drag(), lift()),
    };
    let (ledger, _) = audited(&wind, accurate());
    assert_eq!(ledger.work().drag, 0.0);
    assert!(ledger.work().drive > 0.01, "{:?}", ledger.work());
    assert!(ledger.energy_error().abs() < 1e-8);

    let both = (wind, SpinDrag::linear(1e-6));
    let (ledger, _) = audited(&both, accurate());
    assert!(ledger.work().drag < 0.0 && ledger.work().drive > 0.01);
    assert!(ledger.energy_error().abs() < 1e-8);
}

#[test]
fn the_stated_work_of_a_drive_is_its_work() {
    let wind = Wind {
        velocity: DVec3::new(15.0, 5.0, 0.0),
        force: (drag(), lift()),
    };
    let (exact, _) = audited(&wind, DormandPrince54::new(1e-10).into());
    let (_, stated) = audited(&wind, EnergyMomentum { time_step: 1e-3 }.into());
    let off = (stated - exact.work().drive).abs();
    assert!(
        off < 2e-3 * exact.work().drive.abs(),
        "{off:e} of {stated:e}"
    );
}

/// Random scenes of a brick: all kinds of forces at once, contacts, and steps that do not resolve
/// them.
fn random_force() -> impl Strategy<Value = (AirDrag, SpinDrag, SpinLift, f64)> {
    let size = |most: f64| (-9.0..1.0_f64).prop_map(move |power| most * 10.0_f64.powf(power));
    let forces = (size(10.0), size(10.0), size(0.1), size(0.1), size(100.0));
    (forces, 0.0..20.0_f64).prop_map(|((a, b, c, d, density), wind)| {
        let drag = AirDrag {
            linear: a,
            quadratic: b,
        };
        let spin = SpinDrag {
            linear: c,
            quadratic: d,
        };
        (drag, spin, SpinLift::tennis_ball(0.1, density), wind)
    })
}

fn direction() -> impl Strategy<Value = DVec3> {
    let part = -1.0..1.0_f64;
    (part.clone(), part.clone(), part).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

/// Steps a brick in double or single precision, and asserts that each energy is at most the one
/// before plus the stated work of the drives.
macro_rules! never_gains {
    ($real:ident, $vector:ident, $forces:expr, $start:expr, $h:expr) => {{
        let c = |value: f64| value as $real;
        let v = |vector: DVec3| $vector::new(c(vector.x), c(vector.y), c(vector.z));
        let (drag, spin, lift, wind) = $forces;
        let drag = tumble::$real::AirDrag {
            linear: c(drag.linear),
            quadratic: c(drag.quadratic),
        };
        let spin = tumble::$real::SpinDrag {
            linear: c(spin.linear),
            quadratic: c(spin.quadratic),
        };
        let lift = tumble::$real::SpinLift::tennis_ball(c(lift.radius), c(lift.density));
        let wind = tumble::$real::Wind {
            velocity: $vector::X * c(wind),
            force: drag,
        };
        let scene = || {
            Stepper::builder(tumble::$real::Cuboid::solid(
                0.4,
                $vector::new(0.2, 0.1, 0.06),
            ))
            .gravity(tumble::$real::UniformGravity::down(9.81))
            .ground(tumble::$real::FlatGround::level(3e3, 4.0))
            .friction(tumble::$real::Coulomb {
                coefficient: 0.4,
                slip_speed: 1e-3,
            })
            .integrator(tumble::$real::EnergyMomentum { time_step: c($h) })
        };
        let [position, velocity, momentum] = $start;
        let start = State::at(v(position))
            .with_linear_velocity(v(velocity))
            .with_angular_momentum(v(momentum));
        let still: &dyn Force<$real> = &(drag, spin, lift);
        let passive = scene().force(still).build().unwrap();
        let mut state = start;
        for _ in 0..60 {
            let before = passive.energy(&state).total();
            let step = passive.step(&mut state).unwrap();
            let after = passive.energy(&state).total();
            prop_assert!(after <= before, "{before:e} {after:e}");
            prop_assert_eq!(step.drive_work, 0.0);
        }
        let blown: &dyn Force<$real> = &(wind, spin, lift);
        let driven = scene().force(blown).build().unwrap();
        let mut state = start;
        for _ in 0..60 {
            let before = driven.energy(&state).total();
            let step = driven.step(&mut state).unwrap();
            let after = driven.energy(&state).total();
            prop_assert!(
                after <= before + step.drive_work,
                "{before:e} {after:e} {step}"
            );
        }
    }};
}

proptest! {
    #![proptest_config(kit::cases(200))]

    /// Case: a plate under a force along the ground, of 5 to 95 % of its friction. It creeps
    /// by the law, `ε f/(1 - f)`, at any step size. From half of its friction on it slid by
    /// `h (F - μ N/2)/m`.
    #[test]
    fn a_body_that_friction_holds_against_a_force_creeps_by_its_law(
        mass in 1e-3..10.0_f64,
        share in 0.05..0.95_f64,
        friction in 0.1..0.8_f64,
        slip_speed in -7.0..-4.0_f64,
        h in -4.0..-1.5_f64,
        angle in 0.0..core::f64::consts::TAU,
    ) {
        let (h, slip_speed) = (10.0_f64.powf(h), 10.0_f64.powf(slip_speed));
        let size = DVec3::new(0.3, 0.2, 0.02);
        let (sin, cos) = angle.sin_cos();
        let along = DVec3::new(cos, sin, 0.0);
        let push = Push(Wrench::of_force(along * (share * friction * mass * G)));
        let stiffness = mass * 1e6;
        let stepper = Stepper::builder(Cuboid::solid(mass, size))
            .ground(FlatGround::level(stiffness, mass * 500.0))
            .friction(Coulomb { coefficient: friction, slip_speed })
            .gravity(UniformGravity::down(G))
            .force(push)
            .integrator(EnergyMomentum { time_step: h })
            .build()
            .unwrap();
        let depth = mass * G / (4.0 * stiffness);
        let mut state = State::at(DVec3::Z * (size.z / 2.0 - depth));
        // The force tilts the plate onto its leading corners first.
        stepper.advance(&mut state, 1.0).unwrap();
        let settled = state;
        stepper.advance(&mut state, 1.0).unwrap();
        let found = (state.position - settled.position).dot(along);
        let expected = slip_speed * share / (1.0 - share);
        prop_assert!((found / expected - 1.0).abs() < 1e-2, "{} of {}", found, expected);
    }

    #[test]
    fn the_energy_minus_the_work_of_drives_never_increases(
        forces in random_force(),
        position in direction(),
        velocity in direction(),
        momentum in direction(),
        h in -5.0..-0.5_f64,
    ) {
        let start = [position * 0.3 + DVec3::Z * 0.2, velocity * 30.0, momentum * 0.1];
        let h = 10.0_f64.powf(h);
        never_gains!(f64, DVec3, forces, start, h);
        never_gains!(f32, Vec3, forces, start, h);
    }
}

#[test]
fn a_body_in_wind_is_held_by_friction_where_it_would_be() {
    // 0.4 kg on 0.3: friction holds 1.2 N, the wind pushes with 0.5 N.
    let stepper = Stepper::builder(brick())
        .gravity(UniformGravity::down(G))
        .ground(FlatGround::level(1e4, 20.0))
        .friction(Coulomb {
            coefficient: 0.3,
            slip_speed: 1e-6,
        })
        .force(Wind {
            velocity: DVec3::X * 10.0,
            force: AirDrag::linear(0.05),
        })
        .build()
        .unwrap();
    let mut state = State::at(DVec3::Z * 0.03);
    stepper.advance(&mut state, 1.0).unwrap();
    let from = state.position.x;
    let mut fastest: f64 = 0.0;
    stepper
        .run(&mut state, 2.0, &mut |sample: &Sample<'_>| {
            fastest = fastest.max(sample.state.linear_velocity.length());
            ControlFlow::Continue(())
        })
        .unwrap();
    // The slip speed of the law allows 1e-6 · 0.5/(1.2 - 0.5) m/s.
    assert!(
        (state.position.x - from).abs() < 2e-5,
        "{}",
        state.position.x - from
    );
    // The last half of a step's push is still in the velocity.
    assert!(fastest < 1e-3, "{fastest}");
}

/// A force given by a function, for the contract checks.
struct Custom<F> {
    passive: bool,
    force: F,
}

/// The same force and torque at all times.
struct Push(Wrench);

impl Force for Push {
    fn wrench(&self, _: &Motion) -> Wrench {
        self.0
    }
    fn is_passive(&self) -> bool {
        false
    }
}

impl<F: Fn(DVec3) -> DVec3> Force for Custom<F> {
    fn wrench(&self, motion: &Motion) -> Wrench {
        Wrench::of_force((self.force)(motion.linear_velocity))
    }
    fn is_passive(&self) -> bool {
        self.passive
    }
}

fn checked(force: &dyn Force) -> Result<(), Requirement> {
    let range = ForceRange {
        centre: DVec3::Z,
        size: 5.0,
        speed: 60.0,
        angular_speed: 600.0,
    };
    check_force(force, &range, CheckPlan::default()).map_err(|violation| {
        assert!(!violation.to_string().is_empty());
        violation.requirement
    })
}

#[test]
fn the_contract_check_passes_the_built_in_forces_and_finds_the_broken_ones() {
    let spin = SpinDrag {
        linear: 1e-6,
        quadratic: 1e-9,
    };
    let wind = Wind {
        velocity: DVec3::new(3.0, 2.0, 1.0),
        force: drag(),
    };
    let push = ConstantForce { force: DVec3::X };
    let built_in: [&dyn Force; 8] = [
        &NoForce,
        &drag(),
        &lift(),
        &spin,
        &wind,
        &push,
        &(drag(), lift(), spin),
        &(wind, push, spin, lift()),
    ];
    for force in built_in {
        assert_eq!(checked(force), Ok(()));
    }
    let passive = |force: fn(DVec3) -> DVec3| Custom {
        passive: true,
        force,
    };
    let thrust = passive(|v| v * 0.1);
    assert_eq!(checked(&thrust), Err(Requirement::PassiveTakes));
    let late = passive(|v| if v.length() > 55.0 { v * 0.1 } else { -v });
    assert_eq!(checked(&late), Err(Requirement::PassiveTakes));
    let infinite = passive(|v| -v / v.length_squared());
    assert_eq!(checked(&infinite), Err(Requirement::Finite));
    let jump = passive(|v| DVec3::new(-v.x.signum(), 0.0, 0.0));
    assert_eq!(checked(&jump), Err(Requirement::Continuous));
    let drive = Custom {
        passive: false,
        force: |v: DVec3| v * 0.1,
    };
    assert_eq!(checked(&drive), Ok(()));
}

/// A linear drag of the spin slows a needle that spins fast about its own axis. Its smallest moment
/// is 1e-12 of the largest, so that the rounding of that spin, times the largest moment, exceeds
/// the rounding of the momentum. Newton's iteration did not end there: `ForceTooSteep`.
///
/// Each of the two pushes of a step multiplies the momentum across the axis by a function of
/// `z = h c/(2 I)`, which follows from its two stages. The spin of 4e9 rad/s is rounded to 5e-7
/// rad/s, 5e-8 of the 10 rad/s across.
#[test]
fn a_needle_that_spins_about_its_own_axis_is_slowed_by_linear_spin_drag() {
    let thin = DVec3::Y * 1e-6;
    let needle = PointCloud::new([DVec3::X, DVec3::NEG_X, thin, -thin], [0.25; 4]).unwrap();
    let moment = 0.5;
    let h = 0.1;
    for z in [1e-6, 1e-3, 0.5, 5.0] {
        let drag = SpinDrag::linear(2.0 * z * moment / h);
        let stepper = Stepper::builder(needle)
            .force(drag)
            .integrator(EnergyMomentum { time_step: h })
            .build()
            .unwrap();
        let turned = State::default().with_rotation_vector(DVec3::new(0.4, -0.9, 0.3));
        let axes = turned.rotation().axes();
        let spin = axes.to_world(DVec3::new(4e9, 6.0, 8.0));
        let properties = stepper.scene().inertia_properties();
        let mut state = turned.with_angular_momentum(properties.angular_momentum(&axes, spin));
        let across =
            (state.angular_momentum - axes.x * axes.x.dot(state.angular_momentum)).length();
        stepper.step(&mut state).unwrap();
        // u₁ = u/(1 + γ z), u₂ = (u - (1 - 2γ) z u₁)/(1 + γ z), u' = u - z (u₁ + u₂)/2
        let gamma = 1.0 - core::f64::consts::FRAC_1_SQRT_2;
        let first = 1.0 / (1.0 + gamma * z);
        let second = (1.0 - (1.0 - 2.0 * gamma) * z * first) / (1.0 + gamma * z);
        let factor = 1.0 - z * (first + second) / 2.0;
        let expected = across * factor * factor;
        let found = state.angular_momentum.length();
        assert!(
            (found / expected - 1.0).abs() < 1e-6,
            "{z}: {found} of {expected}"
        );
    }
}
