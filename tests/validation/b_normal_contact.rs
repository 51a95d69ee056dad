//! Group B, normal contact: bounces and damped oscillations.
//!
//! The printed numbers are tested with the printed parameters, the formulas with parameters of any
//! size.

use core::f64::consts::{PI, TAU};

use proptest::prelude::*;
use tumble::glam::DVec3;
use tumble::{
    Coin, ContactPoint, Coulomb, EnergyMomentum, FlatGround, Flight, Ground, HuntCrossley, Plane,
    Rk4, SpringDamperGround, State, Surface, UniformGravity,
};

use crate::kit::erased::Stepper;
use crate::kit::{self, log_uniform, zero_or};
use crate::scenes::{flat, move_point};
use crate::table::{Case, figure, random};

pub(crate) const CASES: &[&Case] = &[
    &ELASTIC_BOUNCE,
    &DASHPOT,
    &CLAMPED_DASHPOT,
    &UPRIGHT_SAG,
    &SWING_OF_A_COIN,
    &HUNT_AND_CROSSLEY,
    &ZENO,
    &SLOW_BOUNCE,
    &HOPS,
];

/// Frictionless motion along z from height `start[0]` at velocity `start[1]`: height and velocity
/// after `seconds`, taken in `steps` steps.
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

// -----------------------------------------------------------------------------------------------
// B1: an elastic bounce under gravity
// -----------------------------------------------------------------------------------------------

/// Duration and greatest depth of a bounce at speed v of a mass on a spring of frequency ω under
/// gravity (a harmonic oscillation about g/ω² under the surface, from the surface to the surface):
/// `(2/ω)(π - arctan(vω/g))` and `g/ω² + √((g/ω²)² + (v/ω)²)`.
fn elastic_bounce(frequency: f64, g: f64, speed: f64) -> [f64; 2] {
    let rest = g / (frequency * frequency);
    let seconds = 2.0 / frequency * (PI - (speed * frequency).atan2(g));
    [seconds, rest + rest.hypot(speed / frequency)]
}

static ELASTIC_BOUNCE: Case = Case::new(
    "B1",
    "`(2/ω)(π - arctan(vω/g))`, `g/ω² + √((g/ω²)² + (v/ω)²)`",
    "the harmonic oscillator about its loaded rest",
    || {
        // m = 1 kg, S = 1000 N/m, v = 1 m/s.
        let bounce = |g: f64, seconds: f64| {
            let ground = FlatGround::level(1000.0, 0.0);
            let [z, v] = fall([1.0, g], ground, [0.0, -1.0], seconds, 1000);
            let [depth, _] = fall([1.0, g], ground, [0.0, -1.0], seconds / 2.0, 500);
            [seconds - z / v, -depth]
        };
        let [under_gravity, without] = [bounce(9.8, 0.118_352_270), bounce(0.0, 0.099_345_883)];
        // Half a unit of the last printed digit; Runge-Kutta: (ω dt)⁴ ωt/120 = 1e-11.
        vec![
            figure(
                "under gravity: duration, s",
                0.118_352_270,
                under_gravity[0],
                1e-9,
            ),
            figure("depth, m", 0.042_906_495, under_gravity[1], 1e-9),
            figure(
                "without gravity: duration, s",
                0.099_345_883,
                without[0],
                1e-9,
            ),
            figure("depth, m", 0.031_622_777, without[1], 1e-9),
        ]
    },
)
.and(&[&ANY_BOUNCE]);

#[test]
fn an_elastic_bounce_takes_the_printed_time_and_reaches_the_printed_depth() {
    ELASTIC_BOUNCE.holds();
}

random! {
    ANY_BOUNCE = new(200, "mass, stiffness, speed and gravity");
    fn elastic_bounces_of_any_size_follow_the_closed_form(
        mass in log_uniform(1e-6, 1e6),
        stiffness in log_uniform(1e-2, 1e10),
        speed in log_uniform(1e-4, 1e4),
        g in prop_oneof![Just(0.0), log_uniform(1e-3, 1e3)],
    ) |misses| {
        let frequency = (stiffness / mass).sqrt();
        let [seconds, depth] = elastic_bounce(frequency, g, speed);
        let ground = FlatGround::level(stiffness, 0.0);
        // Runge-Kutta in 500 steps of at most π/250 of an oscillation's radian: (4π/1000)⁴ 2π/120 =
        // 1.3e-9 of the oscillation's size; the force has no jump at either end.
        let swing = depth.max(speed / frequency);
        let [z, v] = fall([mass, g], ground, [0.0, -speed], seconds, 500);
        misses.within("place after it", z.abs(), 2e-9 * swing)?;
        misses.near("speed after it", [v, speed], 2e-9 * swing * frequency)?;
        let [z, v] = fall([mass, g], ground, [0.0, -speed], seconds / 2.0, 250);
        misses.near("depth", [-z, depth], 2e-9 * swing)?;
        misses.within("speed at the deepest", v.abs(), 2e-9 * swing * frequency)?;
    }
}

// -----------------------------------------------------------------------------------------------
// B2: restitution of a spring and damper
// -----------------------------------------------------------------------------------------------

/// A ground that also pulls: a spring and damper that hold a point to the plane z = 0 from both
/// sides, from 1 m above it on.
#[derive(Clone, Copy)]
struct Glue {
    stiffness: f64,
    damping: f64,
}

impl Glue {
    /// Height above the springs' rest at which the glue begins, m.
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

static DASHPOT: Case = Case::new(
    "B2",
    "`exp(-πζ/√(1-ζ²))`",
    "linear dashpot let go at the surface: Stronge, Impact Mechanics (2000)",
    || {
        let after = |ratio: f64| {
            let [stiffness, damping] = spring_of_10_rad_per_s(ratio);
            let root = (1.0 - ratio * ratio).sqrt();
            let ground = Glue { stiffness, damping };
            let [z, v] = fall([1.0, 0.0], ground, [0.0, -1.0], PI / (10.0 * root), 1000);
            assert!(z.abs() < 1e-10, "{z:e} m");
            v
        };
        // Half a unit of the last printed digit.
        vec![
            figure(
                "ground that may pull, ζ = 0.1: restitution",
                0.729_248,
                after(0.1),
                5e-7,
            ),
            figure("ζ = 0.3", 0.372_326, after(0.3), 5e-7),
            figure("ζ = 0.5", 0.163_034, after(0.5), 5e-7),
        ]
    },
)
.and(&[&ANY_DASHPOT]);

#[test]
fn a_spring_and_damper_that_may_pull_gives_back_the_printed_part_of_the_speed() {
    DASHPOT.holds();
}

random! {
    ANY_DASHPOT = new(100, "mass, frequency and ζ up to 0.95");
    fn springs_and_dampers_that_may_pull_give_back_the_same_at_any_size(
        mass in log_uniform(1e-3, 1e3),
        frequency in log_uniform(0.1, 1e3),
        ratio in zero_or(1e-3, 0.95),
    ) |misses| {
        let root = (1.0 - ratio * ratio).sqrt();
        let ground = Glue { stiffness: mass * frequency * frequency, damping: 2.0 * ratio * mass * frequency };
        // A tenth of a metre deep at most, well within the glue's reach.
        let speed = 0.1 * frequency;
        let [z, v] = fall([mass, 0.0], ground, [0.0, -speed], PI / (frequency * root), 1000);
        // Runge-Kutta: (ω dt)⁵/120 a step of the oscillation's size, in each of 1000; and the
        // rounding of a depth that is told from 1 m above.
        let step = PI / root / 1000.0;
        let miss = 1000.0 * step.powi(5) / 120.0 + 1e-12;
        misses.within("place", z.abs(), miss * 0.1)?;
        misses.near("restitution", [v / speed, (-PI * ratio / root).exp()], miss)?;
    }
}

/// Restitution of the ground that never pulls, and the time after which the contact opens: where
/// the force, not the depth, has come to 0 (Schwager & Pöschel, Granular Matter 9, 465, 2007):
/// `exp(-2ζ arccos(ζ)/√(1-ζ²))`, for ζ > 1 with arcosh and √(ζ²-1).
pub(crate) fn clamped_restitution(ratio: f64) -> [f64; 2] {
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

/// Speed after a bounce at 1 m/s on the built-in ground without gravity, with some `steps` steps to
/// the moment when the contact opens.
fn restitution_of_flat_ground(mass: f64, frequency: f64, ratio: f64, steps: u32) -> f64 {
    let stiffness = mass * frequency * frequency;
    let ground = FlatGround::level(stiffness, 2.0 * ratio * mass * frequency);
    let [_, radians] = clamped_restitution(ratio);
    // And a while longer: it has separated, and flies at a steady speed, in the ground or above. It
    // starts a little inside, because at the surface the damper's force jumps.
    let start = [-1e-12 / frequency, -1.0];
    fall(
        [mass, 0.0],
        ground,
        start,
        1.4 * radians / frequency,
        // Not a whole number of steps to the moment when the contact opens, nor a third of one,
        // where Runge-Kutta happens to be right.
        steps * 7 / 5 - 2,
    )[1]
}

static CLAMPED_DASHPOT: Case = Case::new(
    "B3",
    "`exp(-2ζ arccos(ζ)/√(1-ζ²))`",
    "Schwager & Pöschel, Granular Matter 9, 465 (2007)",
    || {
        // The formula's numbers for the damping ratios of case B2, and at critical damping e^-2.
        // Runge-Kutta is of order 2 at the kink where the force ends: see the property below.
        let after = |ratio| restitution_of_flat_ground(1.0, 10.0, ratio, 4000);
        vec![
            figure(
                "ground that never pulls, ζ = 0.1: restitution",
                0.744_079,
                after(0.1),
                2e-6,
            ),
            figure("ζ = 0.3", 0.450_975, after(0.3), 2e-6),
            figure("ζ = 0.5", 0.298_436, after(0.5), 2e-6),
            figure("ζ = 1", 0.135_335, after(1.0), 2e-6),
        ]
    },
)
.and(&[&ANY_DAMPING, &SKIDDING_BOUNCE]);

#[test]
fn a_spring_and_damper_that_never_pulls_gives_back_more() {
    CLAMPED_DASHPOT.holds();
}

random! {
    /// Checks the restitution from a hard ball to a sandbag. It is the same at every speed, so one
    /// speed is enough; every mass and stiffness.
    ANY_DAMPING = new(200, "mass, frequency and damping, from none to ζ = 30");
    fn bounces_of_any_damping_give_back_what_the_closed_form_says(
        mass in log_uniform(1e-6, 1e6),
        frequency in log_uniform(1e-2, 1e5),
        ratio in prop_oneof![Just(0.0), Just(1.0), log_uniform(1e-3, 30.0)],
    ) |misses| {
        let [restitution, radians] = clamped_restitution(ratio);
        let found = restitution_of_flat_ground(mass, frequency, ratio, 4000);
        // The kink falls anywhere into a step of dt: the speed misses up to the force's slope there
        // times dt²/2, with 2ζω dt and ω dt of up to `step`; a few times that.
        let step = radians / 4000.0 * f64::max(1.0, 2.0 * ratio);
        misses.near("restitution", [found, restitution], 2.0 * step * step)?;
    }
}

random! {
    /// A ball that slides all through its bounce (Brody, Phys. Teach. 22, 494, 1984; Garwin 1969):
    /// friction takes `μ (1 + e) v` of the speed along the ground, as the same force does upwards,
    /// and nothing of the bounce: the height follows the same numbers, bit by bit, with and without
    /// it.
    SKIDDING_BOUNCE = new(100, "ball that slides through its bounce: `μ (1 + e) v` lost");
    fn a_skidding_bounce_loses_the_coefficient_of_what_it_gains_in_height(
        ratio in zero_or(1e-3, 3.0),
        coefficient in log_uniform(1e-3, 0.5),
        frequency in log_uniform(1.0, 1e4),
        heading in 0.0..TAU,
    ) |misses| {
        let ground = FlatGround::level(frequency * frequency, 2.0 * ratio * frequency);
        let [_, radians] = clamped_restitution(ratio);
        let seconds = 1.5 * radians / frequency;
        // At least a third of the speed along the ground is left: 3 m/s less twice the half of
        // 1 m/s.
        let forward = DVec3::new(heading.cos(), heading.sin(), 0.0);
        let start = State::at(DVec3::Z * (-1e-12 / frequency)).with_linear_velocity(forward * 3.0 - DVec3::Z);
        let (mut skidding, mut sliding) = (start, start);
        move_point([1.0, 0.0], ground, Coulomb::as_in_the_report(coefficient), &mut skidding, [seconds, seconds / 2000.0]);
        move_point([1.0, 0.0], ground, tumble::Frictionless, &mut sliding, [seconds, seconds / 2000.0]);
        prop_assert_eq!(skidding.linear_velocity.z.to_bits(), sliding.linear_velocity.z.to_bits());
        let lost = 3.0 - skidding.linear_velocity.dot(forward);
        let expected = coefficient * (skidding.linear_velocity.z + 1.0);
        // The slip speed's fraction, 1e-10 m/s of 2 m/s, and rounding in 2000 steps.
        misses.near("speed lost", [lost, expected], 1e-10 * expected + 1e-12)?;
    }
}

// -----------------------------------------------------------------------------------------------
// B4: how far an upright rim sinks
// -----------------------------------------------------------------------------------------------

/// Half of the arc (rad) on which an upright ring of `count` springs of `stiffness` rests: the
/// springs of the arc carry the weight, `(N S r/π) (sin φ - φ cos φ) = M g`.
pub(crate) fn contact_arc(count: usize, stiffness: f64, radius: f64, weight: f64) -> f64 {
    let load = PI * weight / (count as f64 * stiffness * radius);
    let (mut low, mut high) = (0.0, PI);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let (sin, cos) = f64::sin_cos(middle);
        if sin - middle * cos < load {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

static UPRIGHT_SAG: Case = Case::new(
    "B4",
    "`(NSr/π)(sin φ - φ cos φ) = Mg`, sag `r (1 - cos φ)`",
    "the balance of a rim on a bed of springs",
    || {
        let (count, stiffness, radius) = (1200, 1000.0, 0.5);
        let arc = contact_arc(count, stiffness, radius, 9.8);
        let coin = Coin::ring_with_storage(vec![ContactPoint::default(); count], 1.0, radius);
        // Some twenty contacts: ω = 140 rad/s, ζ = 0.35, so that 0.4 s leave e^-20 of the first
        // swing.
        let stepper = Stepper::new(coin)
            .unwrap()
            .with_gravity(UniformGravity::down(9.8))
            .unwrap()
            .with_ground(FlatGround::level(stiffness, 5.0))
            .unwrap();
        let mut state = State::at(DVec3::Z * radius * arc.cos());
        stepper.advance(&mut state, 0.4).unwrap();
        // The sum over points for the integral: the load misses by up to (h/2φ)², h the points'
        // distance in rad (Euler & Maclaurin, with f' = φ at each end), the arc by a third, the sag
        // by two thirds of that; a point more or less touches.
        let miss = (TAU / count as f64 / (2.0 * arc)).powi(2);
        let sag = radius * (1.0 - arc.cos());
        vec![
            figure(
                "upright ring of 1200 points, 1000 N/m: sag, m",
                sag,
                radius - state.position.z,
                0.67 * miss * sag,
            ),
            figure(
                "points that touch",
                arc * count as f64 / PI,
                stepper.touching(&state) as f64,
                1.0,
            ),
        ]
    },
)
.and(&[&ANY_SAG]);

random! {
    /// A polygon of springs for the bed: the load is a sum over points for an integral whose slope
    /// is `sin φ` at both ends, which lie anywhere between two points. By Euler & Maclaurin it
    /// misses up to `h² sin φ/6` of `2 (sin φ - φ cos φ)`, h the points' distance in rad; `φ` that
    /// by `2 φ sin φ`, and the sag `r (1 - cos φ)` up to `r h² sin φ/(12 φ)`.
    ANY_SAG = new(48, "ring of 60 to 3000 points, mass, radius, g and arc up to 0.8 rad, \
        at any rotation");
    fn rings_of_any_number_of_points_sink_until_their_springs_carry_them(
        points_in_arc in 2.0..30.0_f64,
        arc in log_uniform(0.05, 0.8),
        mass in log_uniform(1e-3, 1e3),
        radius in log_uniform(1e-2, 10.0),
        g in log_uniform(0.1, 100.0),
        turn in 0.0..TAU,
    ) |misses| {
        let count = kit::whole(TAU * points_in_arc / (2.0 * arc)).max(4);
        let n = count as f64;
        let stiffness = PI * mass * g / (n * radius * (arc.sin() - arc * arc.cos()));
        // The springs of the arc together, N φ/π of them; the dampers let it creep to rest at once,
        // ζ = 1.
        let frequency = (n * arc / PI * stiffness / mass).sqrt();
        let damping = 2.0 * stiffness / frequency;
        let stepper = Stepper::new(Coin::ring_with_storage(vec![ContactPoint::default(); count], mass, radius)).unwrap()
            .with_gravity(UniformGravity::down(g)).unwrap()
            .with_ground(FlatGround::level(stiffness, damping)).unwrap()
            .with_integrator(EnergyMomentum { time_step: 0.1 / frequency }).unwrap();
        let mut state = State::at(DVec3::Z * radius * arc.cos()).with_rotation_vector(DVec3::X * turn);
        // After 30/ω, e^-30 of the first oscillation.
        stepper.advance(&mut state, 30.0 / frequency).unwrap();
        let step = TAU / n;
        let sag = radius * (1.0 - arc.cos());
        let miss = radius * step * step * arc.sin() / (12.0 * arc);
        misses.near("sag", [radius - state.position.z, sag], miss + 1e-13 * radius)?;
    }
}

#[test]
fn an_upright_ring_sinks_until_its_springs_carry_it() {
    UPRIGHT_SAG.holds();
}

// -----------------------------------------------------------------------------------------------
// B5: damped oscillations about rest of a body on all its points
// -----------------------------------------------------------------------------------------------

/// Height above rest of an underdamped oscillation that starts at rest `first` above it.
fn damped_swing(frequency: f64, ratio: f64, first: f64, seconds: f64) -> f64 {
    let root = (1.0 - ratio * ratio).sqrt();
    let (sin, cos) = (frequency * root * seconds).sin_cos();
    first * (-ratio * frequency * seconds).exp() * (cos + ratio / root * sin)
}

/// A ring of `count` points, `mass` and 0.5 m that swings flat about its rest: its largest distance
/// from the closed form in three periods, in amplitudes.
fn miss_of_a_flat_ring(count: usize, mass: f64, stiffness: f64, damping: f64) -> f64 {
    let total = count as f64 * stiffness;
    let frequency = (total / mass).sqrt();
    let ratio = count as f64 * damping / (2.0 * (total * mass).sqrt());
    let (rest, g) = (-9.8 / (frequency * frequency), 9.8);
    // A tenth of the depth at rest: no point ever leaves.
    let first = -0.1 * rest;
    let period = TAU / (frequency * (1.0 - ratio * ratio).sqrt());
    let stepper = Stepper::new(Coin::ring_with_storage(
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

static SWING_OF_A_COIN: Case = Case::new(
    "B5",
    "`ω = √(NS/M)`, `ζ = ND/(2√(NSM))`, `δ = 2πζ/√(1-ζ²)`",
    "the damped oscillator of N springs and dampers",
    || {
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
        // Printed to 5e-7; a period is known to 1.5e-6 of itself, and the oscillation is level
        // there.
        vec![figure(
            "the coin of the coin report, flat: logarithmic decrement",
            0.546_192,
            decrement,
            1e-6,
        )]
    },
)
.and(&[&ANY_FLAT_RING]);

#[test]
fn the_reports_coin_swings_flat_about_its_rest_with_the_printed_decrement() {
    SWING_OF_A_COIN.holds();
    let miss = miss_of_a_flat_ring(120, 1.0, 1000.0, 0.5);
    assert!(miss < SWING, "{miss:e} of the amplitude");
}

random! {
    /// Springs and dampers under many points add up, whatever their number.
    ANY_FLAT_RING = new(200, "number of points, mass, stiffness and damping up to ζ = 0.9");
    fn flat_rings_of_any_number_of_points_swing_about_rest_by_the_closed_form(
        count in 3..200_usize,
        mass in log_uniform(1e-3, 1e3),
        stiffness in log_uniform(1.0, 1e6),
        ratio in prop_oneof![Just(0.0), log_uniform(1e-3, 0.9)],
    ) |misses| {
        // c = 2ζ√(K m), shared by the points. The oscillation of 9.8/ω² must stand clear of the
        // rounding of a turned coin, 1e-16 m.
        let total = stiffness * count as f64;
        prop_assume!(0.1 * 9.8 * mass / total > 1e-7);
        let damping = 2.0 * ratio * (total * mass).sqrt() / count as f64;
        let miss = miss_of_a_flat_ring(count, mass, stiffness, damping);
        misses.within("share of the amplitude", miss, 3.0 * SWING)?;
    }
}

// -----------------------------------------------------------------------------------------------
// B6: a damper that grows with depth
// -----------------------------------------------------------------------------------------------

/// Restitution of `F = k dⁿ (1 + λ u)` at `share = λ v`: the e of
/// `share (1 + e) = ln((1 + share)/(1 - e share))`, whatever n and k, by bisection.
fn hunt_and_crossley(share: f64) -> f64 {
    let (mut low, mut high) = (0.0, f64::min(1.0, 1.0 / share));
    for _ in 0..60 {
        let e = 0.5 * (low + high);
        if share * (1.0 + e) > ((1.0 + share) / (1.0 - e * share)).ln() {
            low = e;
        } else {
            high = e;
        }
    }
    low
}

/// Speed after a bounce at 1 m/s of 1 kg without gravity, in `steps` steps to four times v over the
/// spring's 10 rad/s.
fn restitution_of_hunt_crossley(exponent: f64, share: f64, steps: u32) -> f64 {
    let law = HuntCrossley {
        stiffness: 100.0,
        exponent,
        damping: share,
    };
    fall([1.0, 0.0], Ground::level(law), [0.0, -1.0], 4.0, steps)[1]
}

static HUNT_AND_CROSSLEY: Case = Case::new(
    "B6",
    "`λv (1 + e) = ln((1 + λv)/(1 - e λv))`",
    "Hunt & Crossley, J. Appl. Mech. 42, 440 (1975)",
    || {
        // Half a unit of the last printed digit, and Runge-Kutta in 4000 steps of 1e-2 rad,
        // (1e-2)⁴/120 and of order 2.5 where a force d^(3/2) begins and ends.
        let after = restitution_of_hunt_crossley;
        vec![
            figure(
                "n = 1, λv = 0.1: restitution",
                0.937_475_58,
                after(1.0, 0.1, 4000),
                2e-6,
            ),
            figure(
                "n = 3/2, λv = 0.3",
                0.832_869_79,
                after(1.5, 0.3, 4000),
                2e-6,
            ),
            figure("n = 3/2, λv = 1", 0.593_624_26, after(1.5, 1.0, 4000), 2e-6),
        ]
    },
)
.and(&[&ANY_HUNT_AND_CROSSLEY]);

#[test]
fn a_damper_that_grows_with_depth_gives_back_less_the_faster_the_ball() {
    HUNT_AND_CROSSLEY.holds();
}

random! {
    ANY_HUNT_AND_CROSSLEY = new(40, "exponent 1, 3/2 or 2, λv = 0.01 to 10");
    fn the_restitution_of_hunt_and_crossley_does_not_depend_on_the_springs(
        exponent in prop_oneof![Just(1.0), Just(1.5), Just(2.0)],
        share in log_uniform(0.01, 10.0),
    ) |misses| {
        let found = restitution_of_hunt_crossley(exponent, share, 8000);
        let expected = hunt_and_crossley(share);
        // Of order 2 at the kinks of a linear spring, (ω dt)² = 2.5e-5, times the damper.
        misses.near("restitution", [found, expected], 2.5e-5 * (1.0 + share))?;
    }
}

// -----------------------------------------------------------------------------------------------
// B7, B8: bounces under gravity, until they are too slow
// -----------------------------------------------------------------------------------------------

/// Damping ratio of the ground that never pulls for a restitution above e^-2.
pub(crate) fn ratio_for(restitution: f64) -> f64 {
    let (mut low, mut high) = (0.0, 0.999);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if clamped_restitution(middle)[0] > restitution {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Times (s) of the landings and heights (m) of the tops between them of a point dropped from a
/// height under g on a ground of 1 kg ω² and a damping ratio.
fn landings_and_tops(
    [height, g]: [f64; 2],
    [frequency, ratio]: [f64; 2],
    step: f64,
    seconds: f64,
) -> [Vec<f64>; 2] {
    let ground = FlatGround::level(frequency * frequency, 2.0 * ratio * frequency);
    let stepper = Stepper::new(kit::point_mass(1.0))
        .unwrap()
        .with_gravity(UniformGravity::down(g))
        .unwrap()
        .with_ground(ground)
        .unwrap()
        .with_integrator(Flight(EnergyMomentum {
            time_step: step / frequency,
        }))
        .unwrap();
    let (mut landings, mut tops) = (Vec::new(), Vec::new());
    let mut before = [height, 0.0];
    stepper
        .run(
            &mut State::at(DVec3::Z * height),
            seconds,
            &mut |sample: &tumble::Sample<'_>| {
                let [z, v] = [sample.state.position.z, sample.state.linear_velocity.z];
                if before[0] > 0.0 && z <= 0.0 {
                    landings.push(sample.time + z / v.abs());
                }
                if before[1] > 0.0 && v <= 0.0 && z > 0.0 {
                    tops.push(z + v * v / (2.0 * g));
                }
                before = [z, v];
                core::ops::ControlFlow::Continue(())
            },
        )
        .unwrap();
    [landings, tops]
}

static ZENO: Case = Case::new(
    "B7",
    "`hₙ = e²ⁿ h`, `t₀ (1 + e)/(1 - e)`",
    "Zeno's ball, e.g. Stronge, Impact Mechanics (2000)",
    || {
        let (e, frequency) = (0.5, 1e4);
        let ratio = ratio_for(e);
        // The mean force over a step depends on the time of the landing within the step: order 2,
        // (ω dt)²/12 = 8e-5.
        let [landings, tops] = landings_and_tops([1.0, 9.8], [frequency, ratio], 0.03, 1.5);
        let contact = clamped_restitution(ratio)[1] / frequency;
        let speed = 19.6_f64.sqrt();
        // Gravity changes the speed by at most g t_c in a contact: a fraction of g t_c/v of what it
        // takes in, and the shares double from bounce to bounce.
        let share = |bounce: i32| 9.8 * contact / speed * (f64::powi(2.0, bounce) - 1.0) / e;
        // What is left after landing n (0 the first): flights 2 t₀ eⁿ⁺¹/(1-e); each contact takes
        // its time as well.
        let fall = f64::sqrt(2.0 / 9.8);
        let last = 8;
        let rest = 2.0 * fall * f64::powi(e, last + 1) / (1.0 - e);
        let total = landings[last as usize] - f64::from(last) * contact + rest;
        vec![
            figure(
                "e = 1/2, dropped from 1 m: first top, m",
                0.25,
                tops[0],
                2.0 * share(1) * 0.25,
            ),
            figure("third top, m", 1.0 / 64.0, tops[2], 2.0 * share(3) / 64.0),
            figure(
                "end of bouncing, less the contacts, s",
                1.355_262,
                total,
                2.0 * fall * (0..last).map(|n| e.powi(n + 1) * share(n + 1)).sum::<f64>() + 5e-7,
            ),
        ]
    },
)
.and(&[&ANY_ZENO]);

random! {
    /// Tolerance as in the printed case. In bounce n the rebound, `e v₀ eⁿ`, is off by up to
    /// `g t_c`, so that after n bounces the speed is off by
    /// `(g t_c/v₀) Σ e^-(k+1) = (g t_c/v₀) (e^-n - 1)/(1 - e)` of itself, and by some (ω dt)² a
    /// bounce, for its step. A top goes with the square; a flight with the first power, and each
    /// contact takes up to two of its times longer until the surface is reached.
    ANY_ZENO = new(48, "height, g, restitution of 0.2 to 0.95, and vω/g of 1e4 to 1e7");
    fn balls_of_any_restitution_bounce_down_zenos_stairs(
        height in log_uniform(1e-3, 1e3),
        g in log_uniform(0.1, 100.0),
        e in 0.2..0.95_f64,
        hardness in log_uniform(1e4, 1e7),
    ) |misses| {
        let (ratio, step) = (ratio_for(e), 5e-3);
        let (speed, fall) = ((2.0 * g * height).sqrt(), (2.0 * height / g).sqrt());
        let frequency = hardness * g / speed;
        let contact = clamped_restitution(ratio)[1] / frequency;
        let seconds = fall * (1.0 + 2.0 * (e + e * e + e.powi(3) + 0.6 * e.powi(4))) + 4.0 * contact;
        let [landings, tops] = landings_and_tops([height, g], [frequency, ratio], step, seconds);
        let off = |n: i32| g * contact / speed * (e.powi(-n) - 1.0) / (1.0 - e) + 4.0 * step * step * f64::from(n);
        for (n, top) in (1..).zip(&tops[..3]) {
            let expected = e.powi(2 * n) * height;
            misses.near("top", [*top, expected], 2.0 * off(n) * (1.0 + off(n)) * expected)?;
        }
        // Up to the fourth landing; what follows is the formula's.
        let total = landings[3] - 3.0 * contact + 2.0 * fall * e.powi(4) / (1.0 - e);
        let late: f64 = (1..4).map(|n| 2.0 * fall * e.powi(n) * off(n)).sum();
        misses.near("end", [total, fall * (1.0 + e) / (1.0 - e)], late)?;
    }
}

#[test]
fn a_bouncing_ball_comes_to_an_end_after_zenos_time() {
    ZENO.holds();
}

/// Remaining speed (m/s) when a point comes back to the surface, under 9.8 m/s² and with
/// ω = 100 rad/s; 0 where it stays.
fn restitution_under_gravity(ratio: f64, speed: f64) -> f64 {
    let frequency = 100.0;
    let stepper = Stepper::new(kit::point_mass(1.0))
        .unwrap()
        .with_gravity(UniformGravity::down(9.8))
        .unwrap()
        .with_ground(FlatGround::level(1e4, 200.0 * ratio))
        .unwrap()
        .with_integrator(Rk4 { time_step: 1e-5 })
        .unwrap();
    let mut state = State::at(DVec3::Z * -1e-12).with_linear_velocity(DVec3::Z * -speed);
    let mut back = 0.0;
    stepper
        .run(
            &mut state,
            10.0 / frequency,
            &mut |sample: &tumble::Sample<'_>| {
                if sample.state.position.z < 0.0 {
                    return core::ops::ControlFlow::Continue(());
                }
                // At the surface, which it has passed within the step, in flight.
                let risen = 19.6 * sample.state.position.z;
                back = (sample.state.linear_velocity.z.powi(2) + risen).sqrt();
                core::ops::ControlFlow::Break(())
            },
        )
        .unwrap();
    back / speed
}

/// Restitution of the ground that never pulls, of damping ratio ζ, at the impact speed v under
/// gravity, with ω = g = 1: `y = z + 1` swings as `y'' + 2ζ y' + y = 0` from 1 at -v, until the
/// force `-z - 2ζ z'` is 0 again; from there it flies up to the surface, the force below 0 on the
/// whole way (`-z - 2ζ z'` is convex in time, 0 at first and below it at the end).
///
/// `None` where it does not come up so.
fn slow_restitution(ratio: f64, speed: f64) -> Option<f64> {
    let square = 1.0 - ratio * ratio;
    let root = square.abs().sqrt();
    let swing = |t: f64| {
        let decay = (-ratio * t).exp();
        let (cos, sin) = if square > 0.0 {
            ((root * t).cos(), (root * t).sin() / root)
        } else {
            ((root * t).cosh(), (root * t).sinh() / root)
        };
        [
            decay * (cos + (ratio - speed) * sin) - 1.0,
            decay * (-speed * cos + (ratio * speed - 1.0) * sin),
        ]
    };
    let force = |t: f64| {
        let [z, v] = swing(t);
        -z - 2.0 * ratio * v
    };
    // A hundredth of a radian at a time, no further than a whole oscillation.
    let first = (1..1000).find(|&i| force(0.01 * f64::from(i)) < 0.0)?;
    let (mut low, mut high) = (0.01 * f64::from(first - 1), 0.01 * f64::from(first));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if force(middle) < 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    let [z, v] = swing(low);
    let square = v * v + 2.0 * z;
    (v > 0.0 && square > 0.0).then(|| square.sqrt() / speed)
}

random! {
    /// Checks not only the limit, but the whole curve of the restitution over the impact's speed.
    ANY_SLOW_BOUNCE = new(64, "ζ up to 3 and vω/g of 0.1 to 1e6: the damped oscillation about \
        the loaded rest, until the force is 0");
    fn bounces_at_any_speed_under_gravity_give_back_what_the_damped_swing_says(
        ratio in zero_or(1e-3, 3.0),
        speed in log_uniform(0.1, 1e6),
    ) |misses| {
        prop_assume!((ratio - 1.0).abs() > 1e-3);
        let found = restitution_under_gravity(ratio, speed * 9.8 / 100.0);
        let Some(expected) = slow_restitution(ratio, speed) else {
            // It stays; or it comes up after all, when the damper has separated, with less than a
            // tenth of g/ω.
            misses.within("speed of what stays", found * speed, 0.1)?;
            return Ok(());
        };
        // As of B3: the kink falls anywhere into a step, of 1e-3 rad, and moves the speed by up to
        // the force's slope, v + g/ω, times half the step's square, and a few times that. What is
        // left of the speed after the flight up through the ground knows it by one over its
        // fraction of it.
        let step = 1e-3 * f64::max(1.0, 2.0 * ratio);
        let miss = 2.0 * step * step * (1.0 + 1.0 / speed) / expected.min(1.0);
        misses.near("restitution", [found, expected], miss)?;
    }
}

static SLOW_BOUNCE: Case = Case::new(
    "B8",
    "`e → exp(-2ζ arccos(ζ)/√(1-ζ²))` for `vω/g → ∞`",
    "arXiv 2204.10917",
    || {
        let [restitution, radians] = clamped_restitution(0.3);
        // As of case B7: gravity is a fraction of g t_c/v.
        [1e5, 1e3]
            .map(|ratio| {
                let got = restitution_under_gravity(0.3, ratio * 9.8 / 100.0);
                figure(
                    format!("ζ = 0.3, vω/g = {ratio:e}: restitution"),
                    restitution,
                    got,
                    radians / ratio,
                )
            })
            .to_vec()
    },
)
.and(&[&ANY_SLOW_BOUNCE]);

#[test]
fn a_bounce_gives_back_less_the_slower_it_is_and_in_the_end_nothing() {
    SLOW_BOUNCE.holds();
    let found = [1e3, 1e2, 1e1, 3.0, 1.0, 0.1]
        .map(|ratio| restitution_under_gravity(0.3, ratio * 9.8 / 100.0));
    for pair in found.windows(2) {
        assert!(pair[1] <= pair[0], "{found:?}");
    }
    assert!(found[5] == 0.0 && found[3] < 0.9 * found[0], "{found:?}");
}

// -----------------------------------------------------------------------------------------------
// B11: hops down a slope
// -----------------------------------------------------------------------------------------------

/// Ways (m) along a smooth slope from landing to landing of a point of 1 kg that is dropped from a
/// height over it.
fn hops([height, g]: [f64; 2], slope: f64, [frequency, ratio]: [f64; 2], count: usize) -> Vec<f64> {
    let (sin, cos) = slope.sin_cos();
    let (normal, downhill) = (DVec3::new(sin, 0.0, cos), DVec3::new(cos, 0.0, -sin));
    let ground = FlatGround::level(frequency * frequency, 2.0 * ratio * frequency)
        .on(Plane::through(DVec3::ZERO, normal));
    let stepper = Stepper::new(kit::point_mass(1.0))
        .unwrap()
        .with_gravity(UniformGravity::down(g))
        .unwrap()
        .with_ground(ground)
        .unwrap()
        .with_integrator(Flight(EnergyMomentum {
            time_step: 5e-3 / frequency,
        }))
        .unwrap();
    let mut state = State::at(DVec3::Z * height);
    let (mut landings, mut above) = (Vec::new(), true);
    // Each flight takes up to two falls.
    let longest = 2.0 * (2.0 * height / g).sqrt() * (count + 2) as f64;
    stepper
        .run(&mut state, longest, &mut |sample: &tumble::Sample<'_>| {
            let now = sample.state;
            let (gap, rate) = (now.position.dot(normal), now.linear_velocity.dot(normal));
            if above && gap <= 0.0 {
                // Back to where it was at the surface.
                let since = gap / rate;
                landings.push((now.position - now.linear_velocity * since).dot(downhill));
            }
            above = gap > 0.0;
            if landings.len() > count {
                return core::ops::ControlFlow::Break(());
            }
            core::ops::ControlFlow::Continue(())
        })
        .unwrap();
    landings.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

/// Dropped from h, it meets the slope at `v = √(2 g h)`: along the slope it is accelerated by g sin
/// θ all the time, across it it bounces with e under g cos θ, for `tₙ = 2 eⁿ v/g`. So hop n is
/// `uₙ tₙ + g sin θ tₙ²/2` long, with `uₙ₊₁ = uₙ + g sin θ tₙ` from `v sin θ` on; for e = 1,
/// `8 n h sin θ`.
///
/// And what it may miss: each contact takes t_c, in which it runs on at u, and gains g sin θ t_c;
/// gravity changes the rebound by g t_c at most (as in B7), and its step by 4 (ω dt)² of it; the
/// flight with it.
fn hop(
    [height, g]: [f64; 2],
    slope: f64,
    e: f64,
    [contact, step]: [f64; 2],
    number: i32,
) -> [f64; 2] {
    let (speed, sin) = ((2.0 * g * height).sqrt(), slope.sin());
    let (mut along, mut flight, mut way) = (speed * sin, 0.0, 0.0);
    for n in 1..=number {
        along += g * sin * flight;
        flight = 2.0 * e.powi(n) * speed / g;
        way = along * flight + g * sin * flight * flight / 2.0;
    }
    let times = f64::from(number);
    let off = g * contact / speed * e.powi(-number) * times + 4.0 * step * step * times;
    // The way goes with the flight and with its square; `u` is late by each contact.
    let late =
        (along + g * sin * flight) * contact * (times + 1.0) + g * sin * contact * times * flight;
    [way, 2.0 * off * way + late]
}

static HOPS: Case = Case::new(
    "B11",
    "hop n down a slope: `8 n h sin θ`; with e, `uₙ tₙ + g sin θ tₙ²/2`",
    "Bukhovtsev et al., Problems in Elementary Physics (1971)",
    || {
        let (fall, slope, frequency) = ([0.5, 9.8], 30.0_f64.to_radians(), 1e5);
        let found = hops(fall, slope, [frequency, 0.0], 3);
        let contact = PI / frequency;
        (1..)
            .zip(found)
            .map(|(n, got)| {
                let [_, miss] = hop(fall, slope, 1.0, [contact, 5e-3], n);
                figure(
                    format!("30°, dropped from 0.5 m, elastic: hop {n}, m"),
                    2.0 * f64::from(n),
                    got,
                    miss,
                )
            })
            .collect()
    },
)
.and(&[&ANY_HOPS]);

#[test]
fn an_elastic_ball_hops_down_a_slope_by_one_two_three() {
    HOPS.holds();
}

random! {
    ANY_HOPS = new(32, "height, g, slope of 3° to 70°, e of 0.3 to 1, vω/g of 1e4 to 1e6: three hops");
    fn balls_of_any_restitution_hop_down_any_slope_by_the_closed_form(
        height in log_uniform(1e-2, 100.0),
        g in log_uniform(0.1, 100.0),
        degrees in 3.0..70.0_f64,
        e in prop_oneof![Just(1.0), 0.3..0.99_f64],
        hardness in log_uniform(1e4, 1e6),
    ) |misses| {
        let slope = degrees.to_radians();
        let ratio = if e < 1.0 { ratio_for(e) } else { 0.0 };
        let frequency = hardness * g / (2.0 * g * height).sqrt();
        let contact = clamped_restitution(ratio)[1] / frequency;
        let found = hops([height, g], slope, [frequency, ratio], 3);
        for (n, got) in (1..).zip(found) {
            let [expected, miss] = hop([height, g], slope, e, [contact, 5e-3], n);
            misses.near("hop", [got, expected], miss)?;
        }
    }
}
