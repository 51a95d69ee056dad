//! Contact with the ground, normal and along it, where a formula has the answer: bounces, damped swings, a block that slides to rest, creep on a slope, drilling.
//!
//! Case numbers are those of the crate's validation catalogue. The printed numbers are tested with the printed parameters, the formulas with parameters of any size.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

mod kit;

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use kit::{log_uniform, point_mass, zero_or};
use proptest::prelude::*;
use tumble::glam::DVec3;
use tumble::{
    Coin, ContactPoint, Coulomb, FlatGround, Plane, PointCloud, RigidPointBody, Rk4,
    SlidingFriction, SmoothCoulomb, SpringDamperGround, State, Stepper, Surface, UniformGravity,
};

/// A single point under gravity on a ground, moved on by Runge-Kutta in steps of a given length.
fn move_point(
    [mass, g]: [f64; 2],
    ground: impl SpringDamperGround,
    friction: impl SlidingFriction,
    state: &mut State,
    [seconds, time_step]: [f64; 2],
) {
    Stepper::new(point_mass(mass))
        .unwrap()
        .with_gravity(UniformGravity::down(g))
        .unwrap()
        .with_ground(ground)
        .unwrap()
        .with_friction(friction)
        .unwrap()
        .with_integrator(Rk4 { time_step })
        .unwrap()
        .advance(state, seconds)
        .unwrap();
}

/// Frictionless motion along z from height `start[0]` at velocity `start[1]`: height and velocity after `seconds`, taken in `steps` steps.
fn fall(
    masses: [f64; 2],
    ground: impl SpringDamperGround,
    start: [f64; 2],
    seconds: f64,
    steps: u32,
) -> [f64; 2] {
    let mut state = State::at(DVec3::Z * start[0]).with_linear_velocity(DVec3::Z * start[1]);
    let time_step = seconds / f64::from(steps);
    move_point(
        masses,
        ground,
        tumble::Frictionless,
        &mut state,
        [seconds, time_step],
    );
    [state.position.z, state.linear_velocity.z]
}

// ---------------------------------------------------------------------------------------------------------------------
// B1: an elastic bounce under gravity
// ---------------------------------------------------------------------------------------------------------------------

/// Duration and greatest depth of a bounce at speed v of a mass on a spring of frequency ω under gravity (a harmonic swing about g/ω² under the surface, from the
/// surface to the surface): `(2/ω)(π - arctan(vω/g))` and `g/ω² + √((g/ω²)² + (v/ω)²)`.
fn elastic_bounce(frequency: f64, g: f64, speed: f64) -> [f64; 2] {
    let rest = g / (frequency * frequency);
    let seconds = 2.0 / frequency * (PI - (speed * frequency).atan2(g));
    [seconds, rest + rest.hypot(speed / frequency)]
}

#[test]
fn an_elastic_bounce_takes_the_printed_time_and_reaches_the_printed_depth() {
    // Case B1: m = 1 kg, S = 1000 N/m, v = 1 m/s: 0.118352270 s and 0.042906495 m under 9.8 m/s², 0.099345883 s and 0.031622777 m without gravity.
    for (g, seconds, depth) in [
        (9.8, 0.118_352_270, 0.042_906_495),
        (0.0, 0.099_345_883, 0.031_622_777),
    ] {
        let ground = FlatGround::level(1000.0, 0.0);
        let [z, v] = fall([1.0, g], ground, [0.0, -1.0], seconds, 1000);
        // Printed to 5e-10 s, which 1 m/s makes 5e-10 m, and at 9.8 m/s² 5e-9 m/s. Runge-Kutta: (ω dt)⁴ ωt/120 = 1e-11.
        assert!(z.abs() < 1e-9, "{z:e} m after the bounce");
        assert!((v - 1.0).abs() < 1e-8, "{v} m/s after the bounce");
        let [z, v] = fall([1.0, g], ground, [0.0, -1.0], seconds / 2.0, 500);
        assert!((z + depth).abs() < 1e-9, "{z} m at the deepest");
        // The force there is ω² A = 42 m/s² at most: 5e-10 s of it.
        assert!(v.abs() < 3e-8, "{v:e} m/s at the deepest");
    }
}

proptest! {
    #![proptest_config(kit::cases(200))]

    #[test]
    fn elastic_bounces_of_any_size_follow_the_closed_form(
        mass in log_uniform(1e-6, 1e6),
        stiffness in log_uniform(1e-2, 1e10),
        speed in log_uniform(1e-4, 1e4),
        g in prop_oneof![Just(0.0), log_uniform(1e-3, 1e3)],
    ) {
        let frequency = (stiffness / mass).sqrt();
        let [seconds, depth] = elastic_bounce(frequency, g, speed);
        let ground = FlatGround::level(stiffness, 0.0);
        // Runge-Kutta in 500 steps of at most π/250 of a swing's radian: (4π/1000)⁴ 2π/120 = 1.3e-9 of the swing's size; the force has no jump at either end.
        let swing = depth.max(speed / frequency);
        let [z, v] = fall([mass, g], ground, [0.0, -speed], seconds, 500);
        prop_assert!(z.abs() < 2e-9 * swing, "{z:e} m after the bounce, {swing:e} m deep");
        prop_assert!((v - speed).abs() < 2e-9 * swing * frequency, "{v} m/s after the bounce");
        let [z, v] = fall([mass, g], ground, [0.0, -speed], seconds / 2.0, 250);
        prop_assert!((z + depth).abs() < 2e-9 * swing, "{z} m at the deepest, not {depth}");
        prop_assert!(v.abs() < 2e-9 * swing * frequency, "{v:e} m/s at the deepest");
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// B2: restitution of a spring and damper
// ---------------------------------------------------------------------------------------------------------------------

/// A ground that also pulls: a spring and damper that hold a point to the plane z = 0 from both sides, from 1 m above it on.
#[derive(Clone, Copy)]
struct Glue {
    stiffness: f64,
    damping: f64,
}

impl Glue {
    /// How far above the springs' rest the glue begins, m.
    const REACH: f64 = 1.0;
}

impl SpringDamperGround for Glue {
    fn surface(&self, point: DVec3) -> Surface {
        Surface {
            gap: point.z - Self::REACH,
            normal: DVec3::Z,
        }
    }
    fn spring_force(&self, depth: f64) -> f64 {
        self.stiffness * (depth - Self::REACH)
    }
    fn spring_energy(&self, depth: f64) -> f64 {
        self.stiffness * (depth - Self::REACH).powi(2) / 2.0
    }
    fn normal_force(&self, depth: f64, closing_speed: f64) -> f64 {
        self.spring_force(depth) + self.damping * closing_speed
    }
}

/// Stiffness and damping of a spring under a mass of 1 kg with 10 rad/s, by its damping ratio.
fn spring_of_10_rad_per_s(ratio: f64) -> [f64; 2] {
    [100.0, 20.0 * ratio]
}

#[test]
fn a_spring_and_damper_that_may_pull_gives_back_the_printed_part_of_the_speed() {
    // Case B2, the linear dashpot with release at the surface (e.g. Stronge, Impact Mechanics, 2000): e = exp(-πζ/√(1-ζ²)) after π/ω_d.
    for (ratio, restitution) in [(0.1, 0.729_248), (0.3, 0.372_326), (0.5, 0.163_034_f64)] {
        let [stiffness, damping] = spring_of_10_rad_per_s(ratio);
        let root = (1.0 - ratio * ratio).sqrt();
        assert!((restitution - (-PI * ratio / root).exp()).abs() < 5e-7);
        let ground = Glue { stiffness, damping };
        let [z, v] = fall([1.0, 0.0], ground, [0.0, -1.0], PI / (10.0 * root), 1000);
        // Half a unit of the last printed place.
        assert!(
            (v - restitution).abs() < 5e-7,
            "{v} m/s at damping ratio {ratio}"
        );
        assert!(z.abs() < 1e-10, "{z:e} m");
    }
}

/// Restitution of the ground that never pulls, and the time after which it lets go: where the force, not the depth, has come to 0
/// (Schwager & Pöschel, Granular Matter 9, 465, 2007): `exp(-2ζ arccos(ζ)/√(1-ζ²))`, for ζ > 1 with arcosh and √(ζ²-1).
fn clamped_restitution(ratio: f64) -> [f64; 2] {
    let angle = if ratio < 0.999_999 {
        ratio.acos() / (1.0 - ratio * ratio).sqrt()
    } else if ratio > 1.000_001 {
        ratio.acosh() / (ratio * ratio - 1.0).sqrt()
    } else {
        // The common limit of both; they differ from it by a third of the distance of ζ from 1.
        1.0
    };
    [(-2.0 * ratio * angle).exp(), 2.0 * angle]
}

/// Speed after a bounce at 1 m/s on the built-in ground without gravity, with `steps` steps to the moment when it lets go.
fn restitution_of_flat_ground(mass: f64, frequency: f64, ratio: f64, steps: u32) -> f64 {
    let stiffness = mass * frequency * frequency;
    let ground = FlatGround::level(stiffness, 2.0 * ratio * mass * frequency);
    let [_, radians] = clamped_restitution(ratio);
    // Half as long again: it has let go, and flies at a steady speed, in the ground or above. It starts a little inside, because at the surface the damper's force jumps.
    let start = [-1e-12 / frequency, -1.0];
    fall(
        [mass, 0.0],
        ground,
        start,
        1.5 * radians / frequency,
        steps * 3 / 2,
    )[1]
}

#[test]
fn a_spring_and_damper_that_never_pulls_gives_back_more() {
    // The formula's numbers for the damping ratios of case B2, and at critical damping e^-2. Runge-Kutta is of order 2 at the kink where the force ends.
    for (ratio, restitution) in [
        (0.1, 0.744_079),
        (0.3, 0.450_975),
        (0.5, 0.298_436),
        (1.0, 0.135_335),
    ] {
        let found = restitution_of_flat_ground(1.0, 10.0, ratio, 4000);
        assert!(
            (found - restitution).abs() < 1e-5,
            "{found} at damping ratio {ratio}, not {restitution}"
        );
    }
}

proptest! {
    #![proptest_config(kit::cases(200))]

    /// From a hard ball to a sandbag: at every speed alike, so one speed is enough; every mass and stiffness.
    #[test]
    fn bounces_of_any_damping_give_back_what_the_closed_form_says(
        mass in log_uniform(1e-6, 1e6),
        frequency in log_uniform(1e-2, 1e5),
        ratio in prop_oneof![Just(0.0), Just(1.0), log_uniform(1e-3, 30.0)],
    ) {
        let [restitution, radians] = clamped_restitution(ratio);
        let found = restitution_of_flat_ground(mass, frequency, ratio, 4000);
        // The kink falls anywhere into a step of dt: the speed misses up to the force's slope there times dt²/2, with 2ζω dt and ω dt of up to `step`; a few times that.
        let step = radians / 4000.0 * f64::max(1.0, 2.0 * ratio);
        prop_assert!((found - restitution).abs() < 2.0 * step * step, "{found}, not {restitution}, step {step:e}");
    }
}

proptest! {
    #![proptest_config(kit::cases(100))]

    /// A ball that slides all through its bounce (Brody, Phys. Teach. 22, 494, 1984; Garwin 1969): friction takes `μ (1 + e) v` of the speed along the ground, as the same
    /// force does upwards, and nothing of the bounce: the height follows the same numbers, bit by bit, with and without it.
    #[test]
    fn a_skidding_bounce_loses_the_coefficient_of_what_it_gains_in_height(
        ratio in zero_or(1e-3, 3.0),
        coefficient in log_uniform(1e-3, 0.5),
        frequency in log_uniform(1.0, 1e4),
        heading in 0.0..TAU,
    ) {
        let ground = FlatGround::level(frequency * frequency, 2.0 * ratio * frequency);
        let [_, radians] = clamped_restitution(ratio);
        let seconds = 1.5 * radians / frequency;
        // At least a third of the speed along the ground is left: 3 m/s less twice the half of 1 m/s.
        let forward = DVec3::new(heading.cos(), heading.sin(), 0.0);
        let start = State::at(DVec3::Z * (-1e-12 / frequency)).with_linear_velocity(forward * 3.0 - DVec3::Z);
        let (mut skidding, mut sliding) = (start, start);
        move_point([1.0, 0.0], ground, Coulomb::as_in_the_report(coefficient), &mut skidding, [seconds, seconds / 2000.0]);
        move_point([1.0, 0.0], ground, tumble::Frictionless, &mut sliding, [seconds, seconds / 2000.0]);
        prop_assert_eq!(skidding.linear_velocity.z.to_bits(), sliding.linear_velocity.z.to_bits());
        let lost = 3.0 - skidding.linear_velocity.dot(forward);
        let expected = coefficient * (skidding.linear_velocity.z + 1.0);
        // The slip speed's share, 1e-10 m/s of 2 m/s, and rounding in 2000 steps.
        prop_assert!((lost - expected).abs() < 1e-10 * expected + 1e-12, "{lost} m/s, not {expected}");
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// B5: damped swings about rest of a body on all its points
// ---------------------------------------------------------------------------------------------------------------------

/// A coin flat on the ground at a height.
fn flat(height: f64) -> State {
    State::at(DVec3::Z * height).turned_by(DVec3::Y * FRAC_PI_2)
}

/// Height above rest of an underdamped swing that starts at rest `first` above it.
fn damped_swing(frequency: f64, ratio: f64, first: f64, seconds: f64) -> f64 {
    let root = (1.0 - ratio * ratio).sqrt();
    let (sin, cos) = (frequency * root * seconds).sin_cos();
    first * (-ratio * frequency * seconds).exp() * (cos + ratio / root * sin)
}

/// A ring of `count` points, `mass` and 0.5 m that swings flat about its rest: its largest distance from the closed form in three periods, in amplitudes.
fn miss_of_a_flat_ring(count: usize, mass: f64, stiffness: f64, damping: f64) -> f64 {
    let total = count as f64 * stiffness;
    let frequency = (total / mass).sqrt();
    let ratio = count as f64 * damping / (2.0 * (total * mass).sqrt());
    let (rest, g) = (-9.8 / (frequency * frequency), 9.8);
    // A tenth of the depth at rest: no point ever leaves.
    let first = -0.1 * rest;
    let period = TAU / (frequency * (1.0 - ratio * ratio).sqrt());
    let stepper = Stepper::new(Coin::ring_in(
        vec![ContactPoint::default(); count],
        mass,
        0.5,
    ))
    .unwrap()
    .with_gravity(UniformGravity::down(g))
    .unwrap()
    .with_ground(FlatGround::level(stiffness, damping))
    .unwrap()
    .with_integrator(Rk4 {
        time_step: period / 200.0,
    })
    .unwrap();
    let mut state = flat(rest + first);
    (1..=24).fold(0.0, |worst, eighth| {
        stepper.advance(&mut state, period / 8.0).unwrap();
        let expected = damped_swing(frequency, ratio, first, f64::from(eighth) * period / 8.0);
        f64::max(worst, (state.position.z - rest - expected).abs() / first)
    })
}

// Runge-Kutta in 200 steps a period: (2π/200)⁴ 6π/120 = 1.5e-7 of the amplitude after three.
const SWING: f64 = 2e-7;

#[test]
fn the_reports_coin_swings_flat_about_its_rest_with_the_printed_decrement() {
    // Case B5: ω = √(N S/M) = 346.410 rad/s, ζ = N D/(2√(N S M)) = 0.0866025, logarithmic decrement 2πζ/√(1-ζ²) = 0.546192.
    let ring = Stepper::new(Coin::ring(1.0, 0.5))
        .unwrap()
        .with_gravity(UniformGravity::down(9.8))
        .unwrap()
        .with_ground(FlatGround::level(1000.0, 0.5))
        .unwrap()
        .with_integrator(Rk4 { time_step: 1e-5 })
        .unwrap();
    let (frequency, ratio) = (346.410_f64, 0.086_602_5_f64);
    let period = TAU / (frequency * (1.0 - ratio * ratio).sqrt());
    let rest = -9.8 / 120_000.0;
    let mut state = flat(0.9 * rest);
    ring.advance(&mut state, period).unwrap();
    let decrement = (-0.1 * rest / (state.position.z - rest)).ln();
    // Printed to 5e-7; a period is known to 1.5e-6 of itself, and the swing is level there.
    assert!((decrement - 0.546_192).abs() < 1e-6, "{decrement}");
    let miss = miss_of_a_flat_ring(120, 1.0, 1000.0, 0.5);
    assert!(miss < SWING, "{miss:e} of the amplitude");
}

proptest! {
    #![proptest_config(kit::cases(200))]

    /// Springs and dampers under many points add up, whatever their number.
    #[test]
    fn flat_rings_of_any_number_of_points_swing_about_rest_by_the_closed_form(
        count in 3..200_usize,
        mass in log_uniform(1e-3, 1e3),
        stiffness in log_uniform(1.0, 1e6),
        ratio in prop_oneof![Just(0.0), log_uniform(1e-3, 0.9)],
    ) {
        // c = 2ζ√(K m), shared by the points. The swing of 9.8/ω² must stand clear of the rounding of a turned coin, 1e-16 m.
        let total = stiffness * count as f64;
        prop_assume!(0.1 * 9.8 * mass / total > 1e-7);
        let damping = 2.0 * ratio * (total * mass).sqrt() / count as f64;
        let miss = miss_of_a_flat_ring(count, mass, stiffness, damping);
        prop_assert!(miss < 3.0 * SWING, "{miss:e} of the amplitude");
    }
}

/// A ground whose springs swing `mass` on `count` contacts by 0.3 rad in a step, without dampers: as stiff as Runge-Kutta follows with ease.
fn ground_for(time_step: f64, mass: f64, count: usize) -> FlatGround {
    FlatGround::level(mass * (0.3 / time_step).powi(2) / count as f64, 0.0)
}

// ---------------------------------------------------------------------------------------------------------------------
// C1: sliding to rest
// ---------------------------------------------------------------------------------------------------------------------

/// Time and way from speed `v0` to `v` under the report's law: `dv/dt = -a v/(v + ε)` with `a = μ g`, so `t = (v0 - v + ε ln(v0/v))/a` and
/// `x = ((v0² - v²)/2 + ε (v0 - v))/a`. For ε = 0, a block's v0/μg and v0²/2μg.
fn slide(deceleration: f64, eps: f64, v0: f64, v: f64) -> [f64; 2] {
    let way = (v0 * v0 - v * v) / 2.0 + eps * (v0 - v);
    [
        (v0 - v + eps * (v0 / v).ln()) / deceleration,
        way / deceleration,
    ]
}

/// The same under the smooth law, `dv/dt = -a v/√(v² + ε²)`.
fn smooth_slide(deceleration: f64, eps: f64, v0: f64, v: f64) -> [f64; 2] {
    let time = |v: f64| v.hypot(eps) - eps * (eps / v).asinh();
    let way = |v: f64| (v * v.hypot(eps) + eps * eps * (v / eps).asinh()) / 2.0;
    [
        (time(v0) - time(v)) / deceleration,
        (way(v0) - way(v)) / deceleration,
    ]
}

#[test]
fn a_coin_that_slides_flat_comes_to_rest_after_the_printed_time_and_way() {
    // Case C1: v0 = 2 m/s, μ = 0.3: 0.680272 s and 0.680272 m. With the report's slip speed of 1e-10 m/s the formula has nothing to add but what an explicit step does at
    // rest: to and fro by μ g dt.
    let dt = 1e-4;
    let stepper = Stepper::new(Coin::ring(1.0, 0.5))
        .unwrap()
        .with_gravity(UniformGravity::down(9.8))
        .unwrap()
        .with_ground(FlatGround::level(1000.0, 0.5))
        .unwrap()
        .with_friction(Coulomb::as_in_the_report(0.3))
        .unwrap()
        .with_integrator(Rk4 { time_step: dt })
        .unwrap();
    let mut state = flat(-9.8 / 120_000.0).with_linear_velocity(DVec3::X * 2.0);
    let one_step = 0.3 * 9.8 * dt;
    let mut stopped = 0.0;
    stepper
        .run(&mut state, 1.0, &mut |sample: &tumble::Sample<'_>| {
            if sample.state.linear_velocity.x > one_step {
                stopped = sample.time;
            }
            core::ops::ControlFlow::Continue(())
        })
        .unwrap();
    assert!(
        (stopped - 0.680_272).abs() < 2.0 * dt,
        "stopped at {stopped} s"
    );
    // In the remaining 0.32 s it is at rest but for one step's worth of speed, which has no direction on average.
    let way = state.position.x;
    assert!((way - 0.680_272).abs() < 0.32 * one_step, "after {way} m");
    // It neither tips nor turns: friction acts in the plane of its centre, but for the 8e-5 m that it has sunk.
    assert!(
        state.angular_momentum.length() < 1e-3,
        "{}",
        state.angular_momentum
    );
}

proptest! {
    #![proptest_config(kit::cases(200))]

    #[test]
    fn a_block_slides_by_the_closed_form_under_both_laws_of_friction(
        mass in log_uniform(1e-3, 1e3),
        coefficient in log_uniform(1e-3, 10.0),
        g in log_uniform(0.1, 100.0),
        v0 in log_uniform(1e-3, 1e3),
        eps_share in log_uniform(1e-9, 10.0),
        part in 0.1..0.95_f64,
        heading in 0.0..TAU,
    ) {
        let (eps, v) = (v0 * eps_share, v0 * part);
        let forward = DVec3::new(heading.cos(), heading.sin(), 0.0);
        let slid = |friction: &dyn SlidingFriction, [seconds, way]: [f64; 2]| {
            let time_step = seconds / 1000.0;
            let ground = ground_for(time_step, mass, 1);
            let start = State::at(DVec3::Z * (-mass * g / ground.stiffness)).with_linear_velocity(forward * v0);
            let mut state = start;
            move_point([mass, g], ground, friction, &mut state, [seconds, time_step]);
            let along = state.linear_velocity.dot(forward);
            let aside = (state.linear_velocity - forward * along).length();
            let gone = (state.position - start.position).dot(forward);
            // A step changes v by a thousandth of v0, a hundredth of v at most: Runge-Kutta, (1/100)⁵/120 a step. A thousand of them are 1e-9 of v.
            prop_assert!((along - v).abs() < 1e-8 * v0, "{along} m/s, not {v}");
            prop_assert!((gone - way).abs() < 1e-8 * way, "{gone} m, not {way}");
            prop_assert!(aside < 1e-12 * v0, "{aside:e} m/s aside");
            Ok(())
        };
        let a = coefficient * g;
        slid(&Coulomb { coefficient, slip_speed: eps }, slide(a, eps, v0, v))?;
        slid(&SmoothCoulomb { coefficient, slip_speed: eps }, smooth_slide(a, eps, v0, v))?;
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// C9: creep on a slope
// ---------------------------------------------------------------------------------------------------------------------

/// Speed (m/s, downhill) of a point of 1 kg after it has been let go on a slope, long enough to be steady.
fn creep(friction: impl SlidingFriction, coefficient: f64, eps: f64, tangent: f64) -> f64 {
    let slope = tangent.atan();
    let normal = DVec3::new(slope.sin(), 0.0, slope.cos());
    // The rate at which the speed settles: a (1 - t/μ)²/ε for the report's law, faster for the smooth one, with a = μ g cos θ. 25 of its times leave e^-25 = 1e-11.
    let a = coefficient * 9.8 * slope.cos();
    let settling = eps / a / (1.0 - tangent / coefficient).powi(2);
    let time_step = 0.2 * eps / a;
    let ground = ground_for(time_step, 1.0, 1).on(Plane::through(DVec3::ZERO, normal));
    let mut state = State::at(normal * (-9.8 * slope.cos() / ground.stiffness));
    move_point(
        [1.0, 9.8],
        ground,
        friction,
        &mut state,
        [25.0 * settling, time_step],
    );
    let downhill = DVec3::new(slope.cos(), 0.0, -slope.sin());
    let speed = state.linear_velocity.dot(downhill);
    assert!((state.linear_velocity - downhill * speed).length() < 1e-9 * speed);
    speed
}

#[test]
fn a_body_on_a_slope_creeps_at_the_printed_speeds() {
    // Case C9, μ = 0.3, in slip speeds: at 10 degrees 1.4258 (report's law) and 0.7265 (smooth law), at 15 degrees 8.36 and 1.986. Half a unit of the last place.
    let eps = 1e-3;
    for (degrees, report, smooth, places) in [
        (10.0_f64, 1.4258, 0.7265, [5e-5, 5e-5]),
        (15.0, 8.36, 1.986, [5e-3, 5e-4]),
    ] {
        let tangent = degrees.to_radians().tan();
        let found = creep(
            Coulomb {
                coefficient: 0.3,
                slip_speed: eps,
            },
            0.3,
            eps,
            tangent,
        ) / eps;
        assert!(
            (found - report).abs() < places[0],
            "{found} at {degrees} degrees"
        );
        let found = creep(
            SmoothCoulomb {
                coefficient: 0.3,
                slip_speed: eps,
            },
            0.3,
            eps,
            tangent,
        ) / eps;
        assert!(
            (found - smooth).abs() < places[1],
            "{found} at {degrees} degrees, smooth"
        );
    }
}

proptest! {
    #![proptest_config(kit::cases(200))]

    /// `ε t/(μ - t)` and `ε t/√(μ² - t²)` for a slope of t = tan θ below μ: where the two forces balance.
    #[test]
    fn a_body_creeps_down_any_slope_that_would_hold_it_at_the_speed_of_the_closed_form(
        coefficient in log_uniform(1e-2, 10.0),
        share in 0.01..0.8_f64,
        eps in log_uniform(1e-6, 1.0),
    ) {
        let tangent = share * coefficient;
        let found = creep(Coulomb { coefficient, slip_speed: eps }, coefficient, eps, tangent);
        let expected = eps * tangent / (coefficient - tangent);
        prop_assert!((found / expected - 1.0).abs() < 1e-7, "{found}, not {expected}");
        let found = creep(SmoothCoulomb { coefficient, slip_speed: eps }, coefficient, eps, tangent);
        let expected = eps * tangent / (coefficient * coefficient - tangent * tangent).sqrt();
        prop_assert!((found / expected - 1.0).abs() < 1e-7, "{found}, not {expected}, smooth");
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// C11: drilling
// ---------------------------------------------------------------------------------------------------------------------

/// Rate (rad/s) about the vertical of a body that lies flat (body x down) on its points, each with its share of the weight, after it has drilled for some time.
fn drill(
    body: impl RigidPointBody,
    friction: Coulomb,
    rate: f64,
    [seconds, time_step]: [f64; 2],
) -> f64 {
    let axial = body.inertia().x_axis.x;
    let (mass, count) = (body.mass(), body.contacts().len());
    let ground = ground_for(time_step, mass, count);
    let stepper = Stepper::new(body)
        .unwrap()
        .with_gravity(UniformGravity::down(9.8))
        .unwrap()
        .with_ground(ground)
        .unwrap()
        .with_friction(friction)
        .unwrap()
        .with_integrator(Rk4 { time_step })
        .unwrap();
    let mut state = flat(-9.8 * mass / (ground.stiffness * count as f64));
    state.angular_momentum = DVec3::Z * (axial * rate);
    stepper.advance(&mut state, seconds).unwrap();
    state.angular_momentum.z / axial
}

#[test]
fn a_ring_that_drills_stops_after_the_printed_time() {
    // Case C11: R dω/dt = -μ g; R = 0.5 m, ω = 10 rad/s, μ = 0.3: 1.700680 s. A hundredth before it, R ω = μ g/100; after it, what a step does at rest.
    let friction = Coulomb::as_in_the_report(0.3);
    let coin = || Coin::ring(1.0, 0.5);
    let dt = 1e-3;
    let before = 0.5 * drill(coin(), friction, 10.0, [1.700_680 - 0.01, dt]);
    assert!((before - 0.3 * 9.8 * 0.01).abs() < 3e-6, "{before} m/s");
    let after = 0.5 * drill(coin(), friction, 10.0, [1.75, dt]);
    assert!(after.abs() < 0.3 * 9.8 * dt, "{after} m/s");
}

#[test]
fn a_disc_drills_to_rest_by_a_third_quicker_than_a_ring() {
    // R dω/dt = -(4/3) μ g: half the inertia, and a mean arm of 2R/3. A disc of 20 rings of equal points, of which ring i has as many as its area asks for: the mean arm
    // misses 2R/3 by 1/(12·20²), the inertia 1/2 by as much twice: within 1e-3, as the catalogue asks.
    let rings = 20;
    let mut points = Vec::new();
    for i in 0..rings {
        let count = 2 * i + 1;
        let radius = 0.5 * (f64::from(i) + 0.5) / f64::from(rings);
        for k in 0..3 * count {
            let (sin, cos) =
                (TAU * (f64::from(k) + 0.37 * f64::from(i)) / f64::from(3 * count)).sin_cos();
            points.push(ContactPoint::bare(DVec3::new(
                0.0,
                radius * cos,
                radius * sin,
            )));
        }
    }
    let masses = vec![1.0 / points.len() as f64; points.len()];
    let disc = PointCloud::in_storage(points, &masses).unwrap();
    let friction = Coulomb::as_in_the_report(0.3);
    let seconds = 0.5;
    let after = 0.5 * drill(disc, friction, 10.0, [seconds, 5e-3]);
    let lost = 5.0 - after;
    let expected = 4.0 / 3.0 * 0.3 * 9.8 * seconds;
    assert!(
        (lost / expected - 1.0).abs() < 1e-3,
        "{lost} m/s, not {expected}"
    );
}

proptest! {
    #![proptest_config(kit::cases(200))]

    /// The rim's speed obeys the law of a sliding block, for every number of points.
    #[test]
    fn rings_of_any_size_drill_by_the_closed_form_of_sliding(
        count in 3..200_usize,
        mass in log_uniform(1e-2, 10.0),
        radius in log_uniform(0.01, 10.0),
        rim_speed in log_uniform(1e-3, 100.0),
        angle in log_uniform(0.01, 100.0),
        eps_share in log_uniform(1e-9, 1.0),
        part in 0.1..0.95_f64,
    ) {
        // The friction that would stop it after this angle: v²/(2 μ g) is the rim's way.
        let coefficient = rim_speed * rim_speed / (2.0 * 9.8 * radius * angle);
        let slip_speed = eps_share * rim_speed;
        let [seconds, _] = slide(coefficient * 9.8, slip_speed, rim_speed, part * rim_speed);
        let ring = Coin::ring_in(vec![ContactPoint::default(); count], mass, radius);
        let friction = Coulomb { coefficient, slip_speed };
        // 400 steps for the friction, and steps of a tenth of a radian, or Runge-Kutta makes it nutate.
        let rate = rim_speed / radius;
        let time_step = f64::min(seconds / 400.0, 0.1 / rate);
        let after = radius * drill(ring, friction, rate, [seconds, time_step]);
        prop_assert!((after - part * rim_speed).abs() < 1e-6 * rim_speed, "{after} m/s of {rim_speed}");
    }
}
