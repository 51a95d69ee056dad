//! The guide's tables of extremes (`guide::accuracy`), line by line: the number at which a run is
//! no longer accurate, found from both sides. Other lines stand elsewhere: long steps, free spin,
//! small moments and places far from the origin in `physics/energy_momentum.rs`, stability limits
//! of the explicit integrators in `physics/energy.rs`.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::common::methods::{apart, truths};
use crate::kit::erased::Stepper;
use crate::kit::point_mass;
use core::f64::consts::FRAC_PI_2;
use tumble::glam::{DMat3, DQuat, DVec3};
use tumble::real::{Quaternion, Vector};
use tumble::{
    BogackiShampine32, Carried, Coin, ContactPoint, Coulomb, DormandPrince54, EnergyMomentum,
    FlatGround, ForwardEuler, Frictionless, Ground, Integrator, NoGravity, Nystrom, Real,
    RigidPointBody, Rk4, SlidingFriction, Sphere, SpringDamper, SpringDamperGround, State,
    StepError, StrangSplitting, Surface, SymplecticEuler, Trial, UniformGravity, WithResistance,
};

const G: f64 = 9.8;

fn scene<'a, I: Integrator>(
    body: impl RigidPointBody + 'a,
    ground: FlatGround,
    friction: impl SlidingFriction + 'a,
    by: I,
) -> Stepper<'a, I> {
    Stepper::new(body)
        .and_then(|stepper| stepper.with_ground(ground))
        .and_then(|stepper| stepper.with_friction(friction))
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(G)))
        .and_then(|stepper| stepper.with_integrator(by))
        .unwrap()
}

// -----------------------------------------------------------------------------------------------
// EnergyMomentum
// -----------------------------------------------------------------------------------------------

#[test]
fn a_damper_stops_an_impact_at_the_right_depth_up_to_two_of_its_times_and_at_most_twice_as_deep() {
    // A damper alone stops 1 kg that comes at 1 m/s at the depth m v/C; a step takes the speed by
    // (1 - z/2)/(1 + z/2), z = h C/m, for e^-z.
    for strain in [0.1, 1.0, 1.9, 2.0, 4.0, 100.0_f64] {
        let time_step = 1e-3;
        let damping = strain / time_step;
        let stepper = Stepper::new(point_mass(1.0))
            .and_then(|stepper| stepper.with_ground(FlatGround::level(0.0, damping)))
            .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
            .unwrap();
        let mut state = State::at(DVec3::ZERO).with_linear_velocity(-DVec3::Z);
        stepper.step(&mut state).unwrap();
        // Beyond 2 the impulse at the end of the step stops it.
        let left = ((1.0 - strain / 2.0) / (1.0 + strain / 2.0)).max(0.0);
        assert!((-state.linear_velocity.z - left).abs() < 1e-11, "{strain}");
        let off = (left - (-strain).exp()).abs();
        let stopped_or_resolved = !(1.05..3.0).contains(&strain);
        assert_eq!(off < 0.036, stopped_or_resolved, "{strain}: {off}");
        for _ in 0..1000 {
            stepper.step(&mut state).unwrap();
        }
        let deeper = -state.position.z * damping;
        let expected = (2.0 * strain / (2.0 + strain)).max(1.0);
        assert!(
            (deeper - expected).abs() < 1e-9,
            "{strain}: {deeper}, not {expected}"
        );
    }
}

#[test]
fn an_overdamped_floor_takes_its_load_in_its_own_time_at_steps_that_do_not_resolve_its_dampers() {
    // d = m g/S (1 - e^(-S t/D)); S = 1e3 N/m, D = 1e4 N s/m, 1 kg: h D/m is 10 to 1e4. Next to it
    // the inertia counts as m S/D² = 1e-5.
    let load = |time_step: f64| {
        let ground = FlatGround::level(1e3, 1e4);
        let stepper = scene(
            point_mass(1.0),
            ground,
            Frictionless,
            EnergyMomentum { time_step },
        );
        let mut state = State::at(DVec3::ZERO);
        stepper.advance(&mut state, 10.0).unwrap();
        -state.position.z / (G / 1e3 * (1.0 - (-1.0_f64).exp())) - 1.0
    };
    for time_step in [1e-3, 1e-2, 0.1, 1.0] {
        let off = load(time_step).abs();
        // Order 2 in h S/D, (h S/D)²/12 of the exponent; the first step starts from rest, and its
        // lag of 2 m/(h D) of one step is 2e-4 s of 10 s.
        let slow = time_step * 0.1;
        assert!(off < slow * slow / 12.0 + 1e-4, "{time_step} s: {off:e}");
    }
}

#[test]
fn a_slide_is_exact_until_the_step_in_which_it_ends() {
    let (mu, time_step) = (0.3, 1e-2);
    let slows = mu * G * time_step;
    let mut worst = 0.0_f64;
    for part in 0..20 {
        // From 20 steps of slide to 21.
        let start = slows * (20.0 + f64::from(part) / 20.0);
        let ground = FlatGround::level(1000.0, 5.0);
        let friction = Coulomb::as_in_the_report(mu);
        let stepper = scene(
            point_mass(1.0),
            ground,
            friction,
            EnergyMomentum { time_step },
        );
        let mut state = State::at(DVec3::Z * (-G / 1000.0)).with_linear_velocity(DVec3::X * start);
        for _ in 0..20 {
            stepper.step(&mut state).unwrap();
        }
        let t = 20.0 * time_step;
        let place = start * t - 0.5 * mu * G * t * t;
        // Friction lacks ε/u of itself: 1e-10 m/s of 3e-2.
        assert!((state.position.x - place).abs() < 1e-9, "{part}");
        for _ in 0..20 {
            stepper.step(&mut state).unwrap();
        }
        assert!(
            state.linear_velocity.x.abs() < 1e-9,
            "{part}: {}",
            state.linear_velocity
        );
        let way = start * start / (2.0 * mu * G);
        worst = worst.max((state.position.x - way).abs() / (slows * time_step));
    }
    // In units of μ g h²: half of one at most, and an eighth where it would have stopped in the
    // middle of a step.
    assert!((0.12..0.5).contains(&worst), "{worst}");
}

#[test]
fn a_fast_spin_in_contact_is_braked_along_the_chord_of_its_turn() {
    // A ring that lies on all of its points and spins: the torque is μ m g r, the mean arm over a
    // step r cos(atan(h Ω/2)).
    for angle in [0.01, 0.1, 0.28, 0.29, 1.0, 10.0, 100.0_f64] {
        let time_step = 1e-3;
        let stepper = scene(
            Coin::ring(1.0, 0.5),
            FlatGround::level(1000.0, 0.5),
            Coulomb::as_in_the_report(0.3),
            EnergyMomentum { time_step },
        );
        let mut state = State::at(DVec3::Z * (-G / 120_000.0))
            .with_orientation(DQuat::from_rotation_y(FRAC_PI_2))
            .with_angular_momentum(DVec3::Z * (0.25 * angle / time_step));
        let before = state.angular_momentum.z;
        stepper.step(&mut state).unwrap();
        let braked = (before - state.angular_momentum.z) / (0.3 * G * 0.5 * time_step);
        let expected = 1.0 / (1.0 + angle * angle / 4.0).sqrt();
        // The spin falls by 0.006 rad/s in the step, of 10 rad/s at least; half of that is the mean
        // spin's. Rounding of the momentum, of 2.5e4 kg m²/s at most, is 4e-12 of 1.5e-3.
        let slack = 2e-4 * angle * angle.min(1.0) + 1e-8;
        assert!(
            (braked - expected).abs() < slack,
            "{angle}: {braked}, not {expected}"
        );
        assert_eq!(braked > 0.99, angle < 0.285, "{angle}: {braked}");
    }
}

#[test]
fn energies_are_held_up_to_a_sixteenth_of_the_largest_number() {
    /// Returns true if a kilogram continues to fly at this speed, m/s.
    fn flies<R: Real>(speed: f64) -> bool {
        let point = Sphere::<R>::solid(R::ONE, R::ONE);
        let stepper = Stepper::new(point)
            .and_then(|stepper| stepper.with_gravity(NoGravity))
            .and_then(|stepper| {
                stepper.with_integrator(EnergyMomentum {
                    time_step: R::from_f64(1e-3),
                })
            })
            .unwrap();
        let velocity = R::Vec3::new(R::from_f64(speed), R::ZERO, R::ZERO);
        let mut state = State::<R> {
            linear_velocity: velocity,
            ..State::default()
        };
        let energy = stepper.energy(&state).total();
        let moved = stepper.step(&mut state).is_ok() && state.position.x() > R::ZERO;
        energy.is_finite() && moved && stepper.energy(&state).total() <= energy
    }
    // A step sums several energies, so that 8 v² is 3.4e38 or 1.8e308 at most.
    assert!(flies::<f32>(6.5e18) && !flies::<f32>(6.6e18));
    assert!(flies::<f64>(4.7e153) && !flies::<f64>(4.8e153));
}

#[test]
fn a_start_deep_in_the_ground_is_thrown_out_with_the_energy_of_the_springs() {
    // One metre deep in springs of 1e6 N/m: 5e5 J, of which g takes 9.8 J during the rise.
    let stepper = scene(
        point_mass(1.0),
        FlatGround::level(1e6, 0.0),
        Frictionless,
        EnergyMomentum { time_step: 1e-4 },
    );
    let mut state = State::at(-DVec3::Z);
    stepper.advance(&mut state, 0.01).unwrap();
    let expected = (1e6 - 2.0 * G * (1.0 + state.position.z)).sqrt();
    // The energy's rounding, a hundred steps of it.
    assert!((state.linear_velocity.z / expected - 1.0).abs() < 100.0 * f64::EPSILON);
}

#[test]
fn a_slow_slide_goes_on_while_its_energy_is_above_the_rounding_of_the_energies() {
    // A coin that lies: gravity's 8e-4 J and the springs' 4e-4 J before and after a step, times 64
    // ε, are 3.4e-17 J: 8e-9 m/s. One unit in the last place of them is 1.1e-19 J, 4.7e-10 m/s:
    // below it, rounding may lift the energy by more than there is to take.
    let after = |speed: f64| {
        let stepper = scene(
            Coin::ring(1.0, 0.5),
            FlatGround::level(1000.0, 0.5),
            Frictionless,
            EnergyMomentum { time_step: 1e-3 },
        );
        let mut state = State::at(DVec3::Z * (-G / 120_000.0))
            .with_orientation(DQuat::from_rotation_y(FRAC_PI_2))
            .with_linear_velocity(DVec3::X * speed);
        stepper.advance(&mut state, 1.0).unwrap();
        state.linear_velocity.x / speed
    };
    let (goes, rests) = (after(2e-8), after(1e-10));
    // Each of the thousand steps may take a unit in the last place of the energies, of 2e-16 J.
    assert!((0.5..=1.0).contains(&goes), "{goes}");
    assert!(rests.abs() < f64::EPSILON, "{rests}");
}

#[test]
fn a_ball_that_rolls_out_has_the_right_speed_and_the_right_way() {
    // A solid ball decelerates at 5/7 ℓ/r g.
    let (rolling, radius, speed) = (3e-3, 0.03, 0.7);
    let off = |time_step: f64| {
        let friction = WithResistance {
            friction: Coulomb {
                coefficient: 0.5,
                slip_speed: 1e-8,
            },
            rolling,
            spinning: 0.0,
            turn_speed: 1e-6,
        };
        let ground = FlatGround::level(1e4, 300.0);
        let by = EnergyMomentum { time_step };
        let stepper = scene(Sphere::solid(1.0, radius), ground, friction, by);
        let mut state = State::at(DVec3::Z * (radius - G / 1e4))
            .with_linear_velocity(DVec3::X * speed)
            .with_angular_momentum(DVec3::Y * (0.4 * radius * speed));
        stepper.advance(&mut state, 0.5).unwrap();
        let slowing = 5.0 / 7.0 * rolling / radius * G;
        let way = speed * 0.5 - slowing * 0.125;
        [
            state.linear_velocity.x - (speed - slowing * 0.5),
            state.position.x - way,
        ]
    };
    for time_step in [4e-3, 2e-3, 1e-3, 5e-4] {
        // The law lacks turn_speed/ω of itself, which is r turn_speed ln 2 = 2.1e-8 m/s until then;
        // Coulomb's has a slip of 1e-9 m/s.
        for off in off(time_step) {
            assert!(off.abs() < 2.3e-8, "{time_step} s: {off:e}");
        }
    }
}

/// A ring that lies on all of its points, slides and comes to stick on a slope of 6 degrees.
/// Returns its position after 0.3 s, and the iterations of the last step.
fn sticks_on(points: usize) -> (DVec3, u32) {
    // Together as stiff as the report's 120 points.
    let share = 120.0 / points as f64;
    let ring = Coin::ring_with_storage(vec![ContactPoint::default(); points], 1.0, 0.5);
    let friction = Coulomb {
        coefficient: 0.3,
        slip_speed: 1e-8,
    };
    let by = EnergyMomentum { time_step: 1e-3 };
    let down_slope = UniformGravity {
        acceleration: DVec3::new(1.0, 0.0, -G),
    };
    let stepper = scene(
        ring,
        FlatGround::level(1000.0 * share, 0.5 * share),
        friction,
        by,
    )
    .with_gravity(down_slope)
    .unwrap();
    let mut state = State::at(DVec3::Z * (-G / 120_000.0))
        .with_orientation(DQuat::from_rotation_y(FRAC_PI_2))
        .with_linear_velocity(DVec3::new(0.02, 0.01, 0.0))
        .with_angular_momentum(DVec3::new(0.01, 0.02, 0.03));
    let mut iterations = 0;
    for _ in 0..300 {
        iterations = stepper.step(&mut state).unwrap().iterations;
    }
    (state.position, iterations)
}

#[test]
fn contacts_beyond_those_that_are_stored_stick_as_those_do() {
    let (truth, stored) = sticks_on(128);
    // A ring of 100 points has another position: while it rocks into its bed, friction differs
    // slightly. Of the 4e-4 m of its displacement, 1e-7 m.
    let (fewer, few) = sticks_on(100);
    println!("{few}, {stored}: {:e} m", fewer.distance(truth));
    assert!(few.abs_diff(stored) <= 1 && fewer.distance(truth) < 1e-7);
    for points in [160, 200, 256, 400] {
        let (place, most) = sticks_on(points);
        println!("{points}: {most}, {:e} m", place.distance(truth));
        assert!(most < 2 * stored, "{points}: {most}");
        assert!(place.distance(truth) < 1e-7, "{points}: {place}");
    }
}

// -----------------------------------------------------------------------------------------------
// The explicit integrators
// -----------------------------------------------------------------------------------------------

/// A body with three moments, without contacts.
struct Flyer(DVec3);

impl RigidPointBody for Flyer {
    fn mass(&self) -> f64 {
        1.0
    }
    fn inertia(&self) -> DMat3 {
        DMat3::from_diagonal(self.0)
    }
    fn contacts(&self) -> &[ContactPoint] {
        &[]
    }
}

/// Fraction of the first lean after 400 steps of flight by `Rk4`, with `y` rad of nutation a step
/// about the axis of the moment `I₃ = flatness I₁`.
fn lean_after_400_steps(flatness: f64, y: f64) -> f64 {
    let stepper = Stepper::new(Flyer(DVec3::new(1.0, 1.0, flatness)))
        .and_then(|stepper| stepper.with_integrator(Rk4 { time_step: 1.0 }))
        .unwrap();
    let mut state = State::default().with_angular_momentum(DVec3::new(1e-3 * y, 0.0, y));
    let lean = |state: &State| (state.orientation * DVec3::Z).angle_between(state.angular_momentum);
    let first = lean(&state);
    for _ in 0..400 {
        stepper.step(&mut state).unwrap();
    }
    lean(&state) / first
}

#[test]
fn runge_kutta_bears_so_much_nutation_of_a_flat_body_and_any_of_a_long_one() {
    // The quaternion of a spin about the axis rotates at b = y/(2 I₃/I₁) rad a step, a small lean
    // in it at a = y - b. Each step multiplies what rotates at x by a number of the square 1 -
    // x⁶/72 + x⁸/576, and scales the whole to length 1. So the lean grows if its number is the
    // larger one.
    let square = |x: f64| 1.0 - x.powi(6) / 72.0 + x.powi(8) / 576.0;
    let growth = |flatness: f64, y: f64| {
        let b = y / (2.0 * flatness);
        square(y - b) / square(b)
    };
    for flatness in [1.5, 1.8, 2.0] {
        // `2.83/(1 - I₁/2I₃)`, to a percent; 3.77 of a coin.
        let limit = 2.83 / (1.0 - 0.5 / flatness);
        assert!(growth(flatness, 0.99 * limit) < 1.0 && growth(flatness, 1.01 * limit) > 1.0);
        let lean = [0.97, 1.03].map(|share| lean_after_400_steps(flatness, share * limit));
        assert!(lean[0] < 1.0 && lean[1] > 1.0, "{flatness}: {lean:?}");
    }
    // Rods, cigars: whatever takes energy from a spin about the axis of the least moment would tip
    // it over. The error of the method is removed there.
    for flatness in [0.5, 0.8] {
        for y in [0.3, 0.6, 3.0] {
            let lean = lean_after_400_steps(flatness, y);
            assert!((growth(flatness, y) - 1.0).abs() > 1e-7);
            assert!((lean - 1.0).abs() < 1e-9, "{flatness}, {y}: {lean}");
        }
    }
}

/// Number of steps and position error (m) of a ball that bounces for a second, against its path
/// with a tolerance of 1e-12 m.
fn bounces<R: Real, I: Integrator<R>>(by: I) -> (u64, f64) {
    let number = R::from_f64;
    let end = |steps: &mut u64| {
        let stepper = Stepper::new(Sphere::solid(R::ONE, number(0.1)))
            .and_then(|stepper| stepper.with_ground(FlatGround::level(number(1e4), number(2.0))))
            .and_then(|stepper| stepper.with_gravity(UniformGravity::down(number(G))))
            .and_then(|stepper| stepper.with_integrator(by))
            .unwrap();
        let mut state = State::<R>::at(R::Vec3::new(R::ZERO, R::ZERO, number(0.5)));
        let count = &mut |sample: &tumble::Sample<'_, R>| {
            *steps = sample.step;
            core::ops::ControlFlow::Continue(())
        };
        stepper.run(&mut state, R::ONE, count).unwrap();
        state.position.z().to_f64()
    };
    let mut steps = 0;
    let place = end(&mut steps);
    (steps, place)
}

#[test]
fn a_tolerance_counts_down_to_the_rounding_of_the_state_and_below_it_as_that() {
    // 16 ε of position, bounding radius and displacement in a second, 2 to 6 m here: 1e-14 m in
    // f64, 7e-6 m in f32.
    let (_, truth) = bounces::<f64, _>(DormandPrince54::new(1e-12));
    let double = [1e-9, 1e-11, 1e-16, 1e-18].map(|t| bounces::<f64, _>(DormandPrince54::new(t)));
    let single = [1e-3, 1e-4, 1e-8, 1e-10].map(|t| bounces::<f32, _>(DormandPrince54::new(t)));
    let third = [1e-3, 1e-4, 1e-8, 1e-10].map(|t| bounces::<f32, _>(BogackiShampine32::new(t)));
    println!("{double:?} {single:?} {third:?} {truth}");
    for steps in [
        double.map(|run| run.0),
        single.map(|run| run.0),
        third.map(|run| run.0),
    ] {
        // A hundredth of the tolerance in f64, a tenth in f32: more steps. Below the rounding: as
        // many, but for those that search for the few touch-downs.
        assert!(steps[1] * 10 >= steps[0] * 11, "{steps:?}");
        assert!(
            steps[2].abs_diff(steps[3]) <= 3 + steps[3] / 50,
            "{steps:?}"
        );
    }
    for (tolerance, (_, place)) in [1e-3, 1e-4].into_iter().zip(single) {
        assert!(
            (place - truth).abs() < 10.0 * tolerance,
            "{tolerance}: {place}, not {truth}"
        );
    }
}

/// A ground whose force jumps at a depth of 1 cm, where no contact opens or closes.
struct Shelf(f64);

impl SpringDamperGround for Shelf {
    fn surface(&self, point: DVec3) -> Surface {
        Surface {
            gap: point.z,
            normal: DVec3::Z,
        }
    }
    fn spring_force(&self, depth: f64) -> f64 {
        if depth > 0.01 { self.0 } else { 1.0 }
    }
    fn spring_energy(&self, depth: f64) -> f64 {
        depth.min(0.01) + self.0 * (depth - 0.01).max(0.0)
    }
    fn normal_force(&self, depth: f64, _closing_speed: f64) -> f64 {
        self.spring_force(depth)
    }
}

#[test]
fn a_jump_of_the_force_inside_the_ground_is_passed_by_a_step_that_makes_it_harmless_or_refused() {
    // The shortest step is 2.2e-17 s. A jump of F in a step h makes the velocity of 1 kg wrong by
    // up to F h, which counts by the displacement in a second.
    let passes = |jump: f64, tolerance: f64| {
        let stepper = Stepper::new(point_mass(1.0))
            .and_then(|stepper| stepper.with_ground(Shelf(jump)))
            .and_then(|stepper| stepper.with_gravity(UniformGravity::down(G)))
            .and_then(|stepper| stepper.with_integrator(DormandPrince54::new(tolerance)))
            .unwrap();
        let mut state = State::at(-DVec3::Z * 0.005).with_linear_velocity(-DVec3::Z);
        match stepper.advance(&mut state, 0.006) {
            Ok(()) => true,
            Err(StepError::StepTooShort { .. }) => false,
            Err(other) => panic!("{other}"),
        }
    };
    for jump in [1e6, 1e9] {
        let harmless = jump * 0.1 * f64::EPSILON;
        assert!(passes(jump, 10.0 * harmless), "{jump:e}");
        assert!(!passes(jump, 1e-3 * harmless), "{jump:e}");
    }
}

/// Slip of a point of 1 kg on the ground after 2000 steps, m/s, from 1 m/s.
fn slip_after(by: impl Integrator, slip_speed: f64) -> f64 {
    let friction = Coulomb {
        coefficient: 0.5,
        slip_speed,
    };
    let ground = FlatGround::level(1e3, 10.0);
    let stepper = scene(point_mass(1.0), ground, friction, by);
    let mut state = State::at(DVec3::Z * (-G / 1e3)).with_linear_velocity(DVec3::X);
    // Whole steps: a shorter last one may end a chatter.
    for _ in 0..2000 {
        stepper.step(&mut state).unwrap();
    }
    state.linear_velocity.x.abs()
}

#[test]
fn a_stick_chatters_with_explicit_steps_above_its_limit() {
    // A point responds with 1/m only, a ring with 3/m: the limit is 2 ε/(μ g).
    let slip_speed = 1e-3;
    let limit = 2.0 * slip_speed / (0.5 * G);
    let all = |time_step: f64| {
        [
            slip_after(ForwardEuler { time_step }, slip_speed),
            slip_after(SymplecticEuler { time_step }, slip_speed),
            slip_after(StrangSplitting { time_step }, slip_speed),
            slip_after(Rk4 { time_step }, slip_speed),
            slip_after(EnergyMomentum { time_step }, slip_speed),
        ]
    };
    let below = all(limit * 0.5);
    assert!(below.iter().all(|&slip| slip < 1e-9), "{below:?}");
    let time_step = limit * 4.0;
    let above = all(time_step).map(|slip| slip / (0.5 * G * time_step));
    println!("{above:?}");
    assert!(
        above[..4].iter().all(|slip| (0.05..1.0).contains(slip)),
        "{above:?}"
    );
    assert!(above[4] < 1e-9, "{above:?}");
}

// -----------------------------------------------------------------------------------------------
// Single precision
// -----------------------------------------------------------------------------------------------

/// Position error (m) in trial 1 after a second.
fn error_in_trial_1<R: Real, I: Integrator<R>>(by: I) -> f64 {
    let mut trial = Trial::<R>::report(1).unwrap();
    trial.slip_speed = R::from_f64(1e-6);
    let mut state = trial.state();
    Stepper::of_trial(&trial, by)
        .unwrap()
        .advance(&mut state, R::ONE)
        .unwrap();
    let vector = |v: R::Vec3| DVec3::new(v.x().to_f64(), v.y().to_f64(), v.z().to_f64());
    let [x, y, z, w] = state.orientation.xyzw().map(Real::to_f64);
    let state = State::at(vector(state.position))
        .with_linear_velocity(vector(state.linear_velocity))
        .with_orientation(DQuat::from_xyzw(x, y, z, w))
        .with_angular_momentum(vector(state.angular_momentum));
    apart(&state, &truths(1, 1e-6, 1.0).last().unwrap().state).place
}

/// Single precision is as good as double at the first step (s), and loses to rounding at the second
/// by so many times the truth's error there.
fn has_a_best_step<S: Integrator<f32>, D: Integrator<f64>>(
    name: &str,
    single: impl Fn(f32) -> S,
    double: impl Fn(f64) -> D,
    [good, lost]: [f64; 2],
    times: f64,
) {
    #[allow(clippy::cast_possible_truncation)] // A time step.
    let single = |step: f64| error_in_trial_1::<f32, S>(single(step as f32));
    let double = |step: f64| error_in_trial_1::<f64, D>(double(step));
    let (f32_good, f64_good) = (single(good), double(good));
    let (f32_lost, f64_lost) = (single(lost), double(lost));
    println!("{name}: {f32_good:e} {f64_good:e}, {f32_lost:e} {f64_lost:e}");
    assert!(
        (0.6..1.6).contains(&(f32_good / f64_good)),
        "{name}: {f32_good:e} {f64_good:e}"
    );
    assert!(
        f32_lost > times * f64_lost,
        "{name}: {f32_lost:e} {f64_lost:e}"
    );
}

#[test]
fn single_precision_is_as_accurate_down_to_a_millisecond_and_loses_below_its_best_step() {
    macro_rules! best {
        ($method:ident, $steps:expr, $times:expr) => {
            has_a_best_step(
                stringify!($method),
                |time_step| $method { time_step },
                |time_step| $method { time_step },
                $steps,
                $times,
            );
        };
    }
    best!(EnergyMomentum, [1e-3, 1e-5], 100.0);
    best!(StrangSplitting, [1e-3, 1e-5], 100.0);
    best!(Rk4, [1e-3, 1e-5], 100.0);
    best!(Nystrom, [1e-2, 1e-5], 100.0);
    // Of order 1: their own error is still the larger one there.
    best!(SymplecticEuler, [1e-3, 1e-6], 100.0);
    best!(ForwardEuler, [1e-4, 1e-6], 20.0);
}

/// Least and greatest of the restitutions that bounces have without gravity on springs made for
/// `wanted`, of a step of `resolution = h ω`, over the phases of the first touch.
fn restitutions(wanted: f64, resolution: f64) -> [f64; 2] {
    let carried = Carried {
        mass: 1.0,
        contacts: 1,
    };
    let law = SpringDamper::from_bounce(carried, wanted, 1e-3).unwrap();
    let time_step = resolution / law.stiffness.sqrt();
    let stepper = Stepper::new(point_mass(1.0))
        .and_then(|stepper| stepper.with_ground(Ground::level(law)))
        .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
        .unwrap();
    let mut range = [f64::INFINITY, 0.0_f64];
    for phase in 0..64 {
        // It comes down at 1 m/s.
        let above = time_step * (f64::from(phase) + 0.5) / 64.0;
        let mut state = State::at(DVec3::Z * above).with_linear_velocity(-DVec3::Z);
        stepper.advance(&mut state, 0.1 + 20.0 * time_step).unwrap();
        let speed = state.linear_velocity.z;
        range = [range[0].min(speed), range[1].max(speed)];
    }
    range
}

/// Restitution of a bounce that a step does not resolve: without dampers all of it is left. With
/// dampers it deviates more and more from the specified one.
#[test]
fn a_restitution_is_kept_while_the_step_resolves_the_bounce() {
    for resolution in [0.1, 1.0, 10.0, 50.0] {
        let [least, greatest] = restitutions(1.0, resolution);
        // Up to a few hundred steps in the ground, each right to a unit in the last place of the
        // energy.
        assert!(least > 1.0 - 1e-13 && greatest <= 1.0, "{resolution}");
    }
    for wanted in [0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 0.8] {
        let off = |resolution| {
            let range = restitutions(wanted, resolution);
            range
                .map(|got| (got - wanted).abs())
                .into_iter()
                .fold(0.0, f64::max)
        };
        // Of order 2 up to h ω = 1.
        assert!((2e-4..7e-4).contains(&off(0.1)), "{wanted}: {}", off(0.1));
        assert!(off(0.3) < 0.006 && off(0.5) < 0.015, "{wanted}");
        assert!((0.02..0.06).contains(&off(1.0)), "{wanted}: {}", off(1.0));
        assert!((0.05..0.15).contains(&off(2.0)), "{wanted}: {}", off(2.0));
    }
    // Beyond, the phase of the touch decides.
    let [least, greatest] = restitutions(0.5, 10.0);
    assert!((0.3..0.4).contains(&least) && (0.7..0.75).contains(&greatest));
    let [least, greatest] = restitutions(0.5, 50.0);
    assert!((0.05..0.1).contains(&least) && (0.7..0.75).contains(&greatest));
}
