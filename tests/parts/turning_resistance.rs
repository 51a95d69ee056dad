//! Resistance to rolling and spinning: balls come to rest according to closed forms, with every
//! kind of integrator, and the energy audit includes the resistance.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use core::cell::Cell;

use crate::kit::erased::Stepper;
use crate::kit::{self, log_uniform};
use proptest::prelude::*;
use tumble::glam::{DVec3, Vec3};
use tumble::{
    AdaptiveEnergyMomentum, AdaptiveNystrom, BogackiShampine32, ContactPoint, Coulomb, Cuboid,
    DormandPrince54, Dynamics, EnergyMomentum, FlatGround, Force, ForwardEuler, Frictionless,
    Integrator, Ledger, Motion, Nystrom, Plane, PointCloud, Radau5, RigidPointBody, Rk4,
    RollingResistance, SlidingFriction, Sphere, SpringDamperGround, State, StrangSplitting,
    SymplecticEuler, UniformGravity, WithResistance, Wrench,
};

const G: f64 = 9.8;
const RADIUS: f64 = 0.03;

/// Coulomb's friction with lengths of rolling and spinning resistance (m) and their turn speed.
fn with_resistance([rolling, spinning, turn_speed]: [f64; 3]) -> WithResistance<Coulomb> {
    WithResistance {
        friction: Coulomb {
            coefficient: 0.5,
            slip_speed: 1e-3,
        },
        rolling,
        spinning,
        turn_speed,
    }
}

/// A solid ball of 1 kg on a ground into which it penetrates by 0.1 mm.
fn ball<I: Integrator>(resistance: [f64; 3], by: I) -> Stepper<'static, I> {
    Stepper::new(Sphere::solid(1.0, RADIUS))
        .unwrap()
        .with_gravity(UniformGravity::down(G))
        .unwrap()
        .with_ground(FlatGround::level(1e5, 300.0))
        .unwrap()
        .with_friction(with_resistance(resistance))
        .unwrap()
        .with_integrator(by)
        .unwrap()
}

/// A ball at its penetration depth at rest, with a velocity and a spin.
fn moving<I: Integrator>(scene: &Stepper<I>, velocity: DVec3, spin: DVec3) -> State {
    let state = State::at(DVec3::Z * (RADIUS - G / 1e5)).with_linear_velocity(velocity);
    let axes = state.rotation().axes();
    let momentum = scene
        .scene()
        .inertia_properties()
        .angular_momentum(&axes, spin);
    state.with_angular_momentum(momentum)
}

/// A torque, N m, world axes.
struct Motor(DVec3);

impl Force for Motor {
    fn wrench(&self, _: &Motion) -> Wrench {
        Wrench {
            force: DVec3::ZERO,
            torque: self.0,
        }
    }
    fn is_passive(&self) -> bool {
        false
    }
}

/// Case: a ball that rolls without slip under the torque `ℓ m g` slows down by `5/7 ℓ/r g` (e.g.
/// Mathavan, Jackson & Parkin, Am. J. Phys. 77, 788, 2009, for billiard balls).
fn rolls_out(by: impl Integrator, name: &str) {
    let (rolling, speed) = (1e-3, 0.7);
    // A method of order 1 moves a step with the velocity of one of its ends, half a step off.
    let half_step = if by.order() == 1 {
        by.fixed_step().unwrap() / 2.0
    } else {
        0.0
    };
    let scene = ball([rolling, 0.0, 1e-4], by);
    let mut state = moving(&scene, DVec3::X * speed, DVec3::Y * (speed / RADIUS));
    let slowing = 5.0 / 7.0 * rolling / RADIUS * G;
    scene.advance(&mut state, 1.0).unwrap();
    // The friction that slows it, 5 % of the largest, needs a slip of 5e-5 m/s, of which 2/7 are
    // the ball's. Turn speed over turning: 1e-5 of the torque.
    let slack = 2.0 / 7.0 * 5e-5 + (2e-5 + half_step) * slowing;
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
    rolls_out(ForwardEuler { time_step }, "ForwardEuler");
    rolls_out(Nystrom { time_step }, "Nystrom");
    // The tolerance is below the slack, and the velocity is more accurate than the position.
    let tolerance = 1e-6;
    rolls_out(
        AdaptiveEnergyMomentum::new(tolerance),
        "AdaptiveEnergyMomentum",
    );
    rolls_out(AdaptiveNystrom::new(tolerance), "AdaptiveNystrom");
    rolls_out(BogackiShampine32::new(tolerance), "BogackiShampine32");
    rolls_out(DormandPrince54::new(tolerance), "DormandPrince54");
    rolls_out(Radau5::new(tolerance), "Radau5");
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
    // The mean of a torque that does not change is exact.
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

/// Spin about z of a body without sliding friction, which is slowed by a constant torque.
fn spin_left<B: RigidPointBody, T: SpringDamperGround>(
    body: B,
    ground: T,
    resistance: WithResistance<Frictionless>,
    (gravity, mut state): (f64, State),
    seconds: f64,
) -> DVec3 {
    let stepper = Stepper::new(body)
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(gravity)))
        .and_then(|stepper| stepper.with_ground(ground))
        .and_then(|stepper| stepper.with_friction(resistance))
        .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step: 2e-3 }))
        .unwrap();
    state = stepper.with_angular_velocity(state, DVec3::Z * 50.0);
    stepper.advance(&mut state, seconds).unwrap();
    stepper.angular_velocity(&state)
}

const SLIPPERY: WithResistance<Frictionless> = WithResistance {
    friction: Frictionless,
    rolling: 4e-4,
    spinning: 1e-3,
    turn_speed: 1e-6,
};

/// The torques of the contacts of a flat plate add up to `ℓ m g`, and its moment is `m r²`.
#[test]
fn contacts_on_one_plane_resist_as_their_sum() {
    for points in [3_u32, 8, 40] {
        let radius = 0.05;
        let place = |i: u32| {
            let (y, x) = (core::f64::consts::TAU * f64::from(i) / f64::from(points)).sin_cos();
            DVec3::new(x, y, 0.0) * radius
        };
        let mass = 1.0 / f64::from(points);
        let places = Vec::from_iter((0..points).map(|i| ContactPoint::bare(place(i))));
        let plate = PointCloud::with_storage(places, &vec![mass; points as usize]);
        let ground = FlatGround::level(1e5, 300.0);
        let resting = State::at(DVec3::Z * (-mass * G / 1e5));
        let left = spin_left(plate.unwrap(), ground, SLIPPERY, (G, resting), 2.0);
        let expected = 50.0 - SLIPPERY.spinning * G / (radius * radius) * 2.0;
        assert!(
            (left - DVec3::Z * expected).length() < 1e-4,
            "{points} points: {left}"
        );
    }
}

/// A ball without weight between walls that are closer than its diameter. It rolls on four of them
/// and spins on the two others, each with the load `k d`. So many walls are more than the groups of
/// contacts that are kept for a step.
#[test]
fn a_ball_between_walls_is_slowed_by_each_of_them() {
    let (stiffness, depth, seconds) = (1e5, 1e-4, 0.1);
    let wall = |out: DVec3| {
        let plane = Plane::through(out * (RADIUS - depth), -out);
        FlatGround::level(stiffness, 300.0).on(plane)
    };
    let [x, y, z] = DVec3::AXES;
    let walls = [x, -x, y, -y, z, -z].map(wall);
    let slowing = |rolls: f64, spins: f64| {
        let torque = stiffness * depth * (rolls * SLIPPERY.rolling + spins * SLIPPERY.spinning);
        DVec3::Z * (50.0 - torque * seconds / (0.4 * RADIUS * RADIUS))
    };
    let ball = Sphere::solid(1.0, RADIUS);
    let start = (0.0, State::default());
    let left = |walls: &[FlatGround]| spin_left(ball, walls, SLIPPERY, start, seconds);
    for (walls, rolls, spins) in [
        (&walls[..4], 4.0, 0.0),
        (&walls[2..], 2.0, 2.0),
        (&walls, 4.0, 2.0),
    ] {
        let (left, expected) = (left(walls), slowing(rolls, spins));
        assert!(
            (left - expected).length() < 1e-4,
            "{} walls: {left}, {expected}",
            walls.len()
        );
    }
}

/// Resistance that counts its evaluations at contacts.
struct Counting(WithResistance<Coulomb>, Cell<u32>);

impl SlidingFriction for Counting {
    fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
        self.0.force(normal_force, slip)
    }
    fn jacobian(&self, normal_force: f64, slip: DVec3) -> tumble::FrictionJacobian {
        self.0.jacobian(normal_force, slip)
    }
    fn rolling_resistance(&self, normal_force: f64) -> Option<RollingResistance> {
        self.0.rolling_resistance(normal_force)
    }
    fn rolling_resistance_at(&self, _: DVec3, normal_force: f64) -> Option<RollingResistance> {
        self.1.set(self.1.get() + 1);
        self.0.rolling_resistance(normal_force)
    }
}

/// Each evaluation of the balance needs it, and so do each matrix and the end of the step.
#[test]
fn a_step_evaluates_the_resistance_of_a_contact_twice_an_iteration() {
    let resistance = [2e-3, 1e-3, 1e-2];
    let scene = ball(resistance, EnergyMomentum { time_step: 1e-3 });
    let mut state = moving(&scene, DVec3::X * 0.7, DVec3::new(0.3, 0.7 / RADIUS, 4.0));
    let law = Counting(with_resistance(resistance), Cell::new(0));
    let counting = scene.with_friction(&law).unwrap();
    for _ in 0..20 {
        law.1.set(0);
        let step = counting.step(&mut state).unwrap();
        assert!(law.1.get() <= step.evaluations + step.iterations + 1);
    }
}

/// Speed and position of a ball that rolls out, by steps and by half of them: of order 2.
#[test]
fn a_ball_rolls_out_to_order_two() {
    let at = |steps: f64| {
        let scene = ball(
            [1e-3, 5e-4, 1e-2],
            EnergyMomentum {
                time_step: 0.6 / steps,
            },
        );
        let mut state = moving(&scene, DVec3::X * 0.7, DVec3::new(0.0, 0.7 / RADIUS, 9.0));
        scene.advance(&mut state, 0.6).unwrap();
        state
    };
    let exact = at(2560.0);
    let error = |steps| {
        let state = at(steps);
        let position = (state.position - exact.position).length();
        [
            position,
            (state.linear_velocity - exact.linear_velocity).length(),
        ]
    };
    let [rough, fine] = [error(40.0), error(160.0)];
    for (rough, fine) in rough.into_iter().zip(fine) {
        assert!(rough < 1e-4 && fine < rough / 9.0, "{rough:e} {fine:e}");
    }
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
    let slack = 1e-9;
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

    /// Case: a ball on a slope θ that its resistance holds, with `t = tan θ · radius/rolling < 1`.
    /// It creeps as both laws say: with the angular speed `turn_speed · t/(1 - t)`, and with the
    /// slip `slip_speed · q/(1 - q)`, `q = tan θ/μ`. A resistance that acts beside the step would
    /// let it creep by `5/14 · h g sin θ` at least, here 1e-6 m/s.
    #[test]
    fn a_ball_on_a_slope_creeps_as_its_laws_say(radius in log_uniform(0.005, 0.5), rolling in log_uniform(0.01, 0.2), spinning in log_uniform(1e-3, 0.1), share in 0.1..0.9, coefficient in 0.3..1.0, speeds in [log_uniform(1e-9, 1e-7), log_uniform(1e-9, 1e-7)], time_step in log_uniform(3e-4, 0.03)) {
        let [turn_speed, slip_speed] = [speeds[0] / radius, speeds[1]];
        let law = WithResistance {
            friction: Coulomb { coefficient, slip_speed },
            rolling: rolling * radius,
            spinning: spinning * radius,
            turn_speed,
        };
        let slope = rolling * share;
        let down = DVec3::new(slope, 0.0, -1.0).normalize();
        let stiffness = 0.5 * G / (1e-3 * radius);
        let ground = FlatGround::level(stiffness, 0.3 * stiffness.sqrt());
        let scene = Stepper::new(Sphere::solid(0.5, radius))
            .and_then(|stepper| stepper.with_gravity(UniformGravity { acceleration: down * G }))
            .and_then(|stepper| stepper.with_ground(ground))
            .and_then(|stepper| stepper.with_friction(law))
            .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
            .unwrap();
        let mut state = State::at(DVec3::Z * (radius * 0.999));
        scene.advance(&mut state, 40.0 * time_step + 1.0).unwrap();
        let (from, seconds) = (state.position, 50.0 * time_step);
        scene.advance(&mut state, seconds).unwrap();
        let creep: DVec3 = (state.position - from) / seconds;
        // Along the normal the hard spring still settles, by some 1e-11 m.
        let creep = DVec3 { z: 0.0, ..creep };
        let held = slope / coefficient;
        let rolled = turn_speed * radius * share / (1.0 - share);
        let expected: f64 = rolled + slip_speed * held / (1.0 - held);
        let off = DVec3::length(creep - DVec3::X * expected);
        prop_assert!(off < expected * 1e-3 + 1e-15 / seconds, "{} m/s, not {}", creep, expected);
    }

    /// Case: a ball of single precision that rolls and spins on any plane. Its spin ends at the
    /// rounding of its rotation, where the torque against it may be anything, if the turn speed is
    /// less. It then rolls on with the deceleration `5/7 · rolling/radius · g`.
    ///
    /// Balls with turn speeds below 1e-5 rad/s came to rest, or were thrown aside.
    #[test]
    fn a_ball_of_single_precision_rolls_on_after_its_spin(
        radius in 0.01_f32..0.1,
        mass in 0.05_f32..2.0,
        lengths in [0.003_f32..0.02, 0.1_f32..0.5],
        turn_speed in (-18.4_f32..-4.6).prop_map(f32::exp),
        spin in 5.0_f32..30.0,
        normal in kit::directions(),
        towards in kit::directions(),
    ) {
        let normal = normal.as_vec3();
        let along = towards.as_vec3().reject_from_normalized(normal);
        prop_assume!(along.length() > 0.1);
        let along = along.normalize();
        let [g, depth] = [9.8_f32, 1e-3 * radius];
        let stiffness = mass * g / depth;
        let ground = FlatGround::level(stiffness, 0.1 * (stiffness * mass).sqrt());
        let friction = WithResistance {
            friction: Coulomb { coefficient: 0.5_f32, slip_speed: 1e-3 },
            rolling: lengths[0] * radius,
            spinning: lengths[1] * radius,
            turn_speed,
        };
        let scene = Stepper::builder(Sphere::solid(mass, radius))
            .ground(ground.on(Plane::through(Vec3::ZERO, normal)))
            .friction(friction)
            .gravity(UniformGravity { acceleration: normal * -g })
            .integrator(EnergyMomentum { time_step: 1e-3_f32 })
            .build()
            .unwrap();
        let start = State::at(normal * (radius - depth)).with_linear_velocity(along);
        let turning = normal.cross(along) / radius + normal * spin;
        let mut state = scene.with_angular_velocity(start, turning);
        scene.advance(&mut state, 0.3).unwrap();
        let expected = along * (1.0 - 5.0 / 7.0 * lengths[0] * g * 0.3);
        let off = (state.linear_velocity - expected).length();
        prop_assert!(off < 2e-4, "{} m/s", off);
    }

    /// Case: a ball that lands with spin and rotation, on a damper that the step does not resolve
    /// (strain `h c/m` of 2 to 100). The ground gives less impulse than the mean force, and resists
    /// with the torque of that impulse. It was up to twice as much.
    #[test]
    fn the_torque_of_an_impact_is_that_of_its_impulse(
        radius in 0.02..0.5_f64,
        strain in log_uniform(2.0, 100.0),
        ratio in 0.2..1.5_f64,
        lengths in [log_uniform(1e-4, 1e-2), log_uniform(1e-4, 1e-2)],
        time_step in log_uniform(1e-3, 0.02),
        speed in 0.5..5.0_f64,
        normal in kit::directions(),
        spin in 50.0..200.0_f64,
    ) {
        let damping = strain / time_step;
        let stiffness = f64::powi(damping / ratio, 2);
        let [rolling, spinning] = lengths.map(|length| length * radius);
        let friction = WithResistance {
            friction: Frictionless,
            rolling,
            spinning,
            turn_speed: 1e-4,
        };
        let scene = Stepper::builder(Sphere::solid(1.0, radius))
            .ground(FlatGround::level(stiffness, damping).on(Plane::through(DVec3::ZERO, normal)))
            .friction(friction)
            .gravity(UniformGravity { acceleration: normal * -G })
            .integrator(EnergyMomentum { time_step })
            .build()
            .unwrap();
        let start = State::at(normal * (radius + 1e-7)).with_linear_velocity(normal * -speed);
        let turning = normal.any_orthonormal_vector() * spin + normal * spin;
        let before = scene.with_angular_velocity(start, turning);
        let mut after = before;
        let step = scene.step(&mut after).unwrap();
        let impulse = (after.linear_velocity - before.linear_velocity).dot(normal) + G * time_step;
        let taken = before.angular_momentum - after.angular_momentum;
        prop_assert!(!step.fallback && impulse > 0.0);
        let along = taken.dot(normal) / (spinning * impulse);
        let across = taken.reject_from_normalized(normal).length() / (rolling * impulse);
        prop_assert!((along - 1.0).abs() < 1e-3, "{}", along);
        prop_assert!((across - 1.0).abs() < 1e-3, "{}", across);
    }

    /// Case: a ball with a motor of 5 to 95 % of the torque that resists, about the normal or in a
    /// plane. It turns by the law, `ω₀ f/(1 - f)`, at any step size. From half of that torque on,
    /// it turned by `h (τ - C/2)/I`.
    #[test]
    fn a_motor_turns_a_ball_that_resists_by_its_law(
        share in 0.05..0.95_f64,
        // Slower, the energy of the motion is within the rounding of that of the weight.
        turn_speed in log_uniform(1e-4, 1e-2),
        time_step in log_uniform(1e-4, 0.03),
        lengths in [log_uniform(1e-4, 0.1), log_uniform(1e-4, 0.1)],
        spins in any::<bool>(),
        normal in kit::directions(),
    ) {
        let [rolling, spinning] = lengths.map(|length| length * RADIUS);
        let friction = WithResistance {
            friction: Coulomb { coefficient: 0.5, slip_speed: turn_speed * RADIUS * 1e-3 },
            rolling,
            spinning,
            turn_speed,
        };
        let (axis, most) = if spins {
            (normal, spinning * G)
        } else {
            (normal.any_orthonormal_vector(), rolling * G)
        };
        let scene = Stepper::builder(Sphere::solid(1.0, RADIUS))
            .ground(FlatGround::level(1e5, 300.0).on(Plane::through(DVec3::ZERO, normal)))
            .friction(friction)
            .gravity(UniformGravity { acceleration: normal * -G })
            .force(Motor(axis * (share * most)))
            .integrator(EnergyMomentum { time_step })
            .build()
            .unwrap();
        let expected = turn_speed * share / (1.0 - share);
        let turning = axis * expected;
        let start = State::at(normal * (RADIUS - G / 1e5))
            .with_linear_velocity(turning.cross(normal * RADIUS));
        let mut state = scene.with_angular_velocity(start, turning);
        scene.advance(&mut state, 1.0).unwrap();
        let turned = 2.0 * state.orientation.xyz().dot(axis).asin();
        prop_assert!((turned / expected - 1.0).abs() < 1e-2, "{} of {}", turned, expected);
    }

    /// Case: a thrown box on hard ground, `h √(k/m)` of 40 to 400 for a corner. With resistance a
    /// step found no solution again and again (one of four steps of a die), so that dice of 16 mm
    /// went on rocking.
    #[test]
    fn a_thrown_box_comes_to_rest_on_hard_ground(
        size in log_uniform(5e-3, 0.5),
        sides in [0.5..1.5_f64, 0.5..1.5_f64, 0.5..1.5_f64],
        mass in log_uniform(1e-3, 10.0),
        stretch in log_uniform(40.0, 400.0),
        time_step in log_uniform(2e-3, 0.02),
        lengths in [log_uniform(1e-4, 3e-2), log_uniform(1e-4, 3e-2)],
        turn_speed in log_uniform(1e-2, 1.0),
        normal in kit::directions(),
        tilt in kit::directions(),
    ) {
        let [rolling, spinning] = lengths.map(|length| length * size);
        let ratio = stretch / time_step;
        let ground = FlatGround::level(mass * ratio * ratio, 0.6 * mass * ratio);
        let scene = Stepper::builder(Cuboid::solid(mass, DVec3::from(sides) * size))
            .ground(ground.on(Plane::through(DVec3::ZERO, normal)))
            .friction(with_resistance([rolling, spinning, turn_speed]))
            .gravity(UniformGravity { acceleration: normal * -G })
            .integrator(EnergyMomentum { time_step })
            .build()
            .unwrap();
        let start = State::at(normal * size * 2.0).with_rotation_vector(tilt);
        let mut state = scene.with_angular_velocity(start, tilt * 3.0);
        // A box tumbles for some ten of these times.
        let tumbling = 30.0 * (size / G).sqrt();
        let (steps, mut fallbacks) = (kit::whole(tumbling / time_step).max(600), 0);
        for _ in 0..steps {
            fallbacks += usize::from(scene.step(&mut state).unwrap().fallback);
        }
        // In 5,000 other cases, 2 % at most but for one.
        prop_assert!(fallbacks <= steps / 25, "{} of {} steps have no solution", fallbacks, steps);
        let settled = state;
        for _ in 0..steps / 10 {
            scene.step(&mut state).unwrap();
        }
        let moved = (state.position - settled.position).length();
        prop_assert!(moved < 1e-3 * size, "moved by {} of its size", moved / size);
    }

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

/// Case: a motor whose second half in a step stops the ball. The energy then exceeds what the work
/// of the motor allows by rounding, and nothing is left from which it could be taken. The push was
/// left out, in each step again, so that the ball seemed to turn backwards at `h τ/(2 I)`. One of
/// some thousand motors meets such a rounding; this is one.
#[test]
fn a_push_that_stops_a_ball_is_not_left_out() {
    let (share, turn_speed, time_step) = (
        0.580_251_047_424_665_6,
        3.794_096_923_842_27e-7,
        0.017_894_384_143_319_84,
    );
    let [rolling, spinning] = [0.1, 0.058_356_073_966_258_04].map(|length| length * RADIUS);
    let friction = WithResistance {
        friction: Coulomb {
            coefficient: 0.5,
            slip_speed: turn_speed * RADIUS * 1e-3,
        },
        rolling,
        spinning,
        turn_speed,
    };
    let scene = Stepper::builder(Sphere::solid(1.0, RADIUS))
        .ground(FlatGround::level(1e5, 300.0))
        .friction(friction)
        .gravity(UniformGravity::down(G))
        .force(Motor(DVec3::Z * (share * spinning * G)))
        .integrator(EnergyMomentum { time_step })
        .build()
        .unwrap();
    let expected = turn_speed * share / (1.0 - share);
    let start = State::at(DVec3::Z * (RADIUS - G / 1e5));
    let mut state = scene.with_angular_velocity(start, DVec3::Z * expected);
    for _ in 0..50 {
        let before = scene.energy(&state).total();
        let step = scene.step(&mut state).unwrap();
        assert!(scene.energy(&state).total() <= before + step.drive_work);
        let spin = scene.angular_velocity(&state).z;
        assert!((spin / expected - 1.0).abs() < 0.02, "{spin} of {expected}");
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
