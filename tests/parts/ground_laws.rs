//! The contact laws: bounces with the specified restitution and duration, against closed forms;
//! force without a jump; the same ground by different constructors.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::kit::erased::Stepper;
use crate::kit::{self, log_uniform, zero_or};
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use tumble::glam::{DVec3, Vec3};
use tumble::{
    Carried, ContactLaw, ContactModel, Cuboid, FlatGround, Frictionless, Ground, HuntCrossley,
    Impact, LimitedDamper, Plane, PointCloud, RigidPointBody, Rk4, SpringDamper,
    SpringDamperGround, State,
};

/// A bounce: the part of the speed that is left, how long the ground pushed (s), and the greatest
/// depth (m).
struct Bounce {
    restitution: f64,
    seconds: f64,
    depth: f64,
}

/// Drops a body of this mass on as many feet at the same height, with `speed` and without gravity;
/// Runge-Kutta in steps of `time_step`.
fn bounce(law: impl ContactLaw, carried: Carried, speed: f64, time_step: f64) -> Bounce {
    let feet = (0..carried.contacts).map(|i| DVec3::new(f64::from(i), f64::from(i % 2), 0.0));
    let places: Vec<_> = feet.collect();
    let masses = vec![carried.mass / f64::from(carried.contacts); places.len()];
    let body = PointCloud::with_storage(
        places
            .iter()
            .map(|&position| tumble::ContactPoint {
                position,
                radius: 0.0,
            })
            .collect::<Vec<_>>(),
        &masses,
    )
    .unwrap();
    let stepper = Stepper::new(body)
        .unwrap()
        .with_ground(Ground::level(&law))
        .unwrap()
        .with_integrator(Rk4 { time_step })
        .unwrap();
    // Slightly inside, because the forces of some laws jump at the surface.
    let mut state =
        State::at(DVec3::NEG_Z * (1e-12 * speed)).with_linear_velocity(DVec3::NEG_Z * speed);
    let (mut depth, mut steps) = (0.0_f64, 0.0);
    // Until the contact opens, in the ground or at its surface.
    while state.position.z < 0.0
        && law.normal_force(-state.position.z, -state.linear_velocity.z) > 0.0
    {
        stepper.step(&mut state).unwrap();
        depth = depth.max(-state.position.z);
        steps += 1.0;
        assert!(steps < 1e6, "it stays in the ground");
    }
    Bounce {
        restitution: state.linear_velocity.z / speed,
        seconds: steps * time_step,
        depth,
    }
}

fn carried() -> impl Strategy<Value = Carried> {
    (log_uniform(1e-6, 1e6), 1..6_u32).prop_map(|(mass, contacts)| Carried { mass, contacts })
}

proptest! {
    #![proptest_config(kit::cases(60))]

    /// Both laws whose restitution is the same at every speed. The step is 1/4000 of the bounce;
    /// where the law has a kink within a step of dt, Runge-Kutta misses
    /// `(slope of the force) dt²/2`: with `ω dt` of at most π/4000 and damping ratios up to 2.2
    /// (e = 0.03), below 1e-5 of the speed. The end is known to a step.
    #[test]
    fn a_law_made_for_a_bounce_bounces_so(
        carried in carried(), restitution in 0.03..1.0_f64, seconds in log_uniform(1e-6, 1.0), speed in log_uniform(1e-3, 1e3),
    ) {
        let dt = seconds / 4000.0;
        let law = SpringDamper::from_bounce(carried, restitution, seconds).unwrap();
        let found = bounce(law, carried, speed, dt);
        prop_assert!((found.restitution - restitution).abs() < 1e-5, "{} for {restitution}", found.restitution);
        prop_assert!((found.seconds - seconds).abs() < 2.0 * dt, "{} s for {seconds}", found.seconds);
        let law = LimitedDamper::from_bounce(carried, restitution, seconds).unwrap();
        let found = bounce(law, carried, speed, dt);
        prop_assert!((found.restitution - restitution).abs() < 1e-5, "limited: {} for {restitution}", found.restitution);
        prop_assert!((found.seconds - seconds).abs() < 2.0 * dt, "limited: {} s for {seconds}", found.seconds);
    }

    /// The force is smooth but for the first and last touch, where it goes as `d^n`. A step of
    /// 1/4000 of the time to the greatest depth; the last step is late by less than its length.
    #[test]
    fn a_hunt_crossley_law_made_for_a_bounce_bounces_so(
        carried in carried(), restitution in 0.1..1.0_f64, depth in log_uniform(1e-6, 1e-1), speed in log_uniform(1e-3, 1e3),
        exponent in prop_oneof![Just(1.0), Just(1.5), Just(2.0), 1.0..3.0_f64],
    ) {
        let impact = Impact { speed, restitution };
        let law = HuntCrossley::from_bounce(carried, exponent, impact, depth).unwrap();
        let found = bounce(law, carried, speed, depth / speed / 4000.0);
        prop_assert!((found.restitution - restitution).abs() < 1e-5, "{} for {restitution}", found.restitution);
        // Seen at the steps: a parabola's top is missed by acceleration · dt²/8, 1e-6 of the depth.
        prop_assert!((found.depth / depth - 1.0).abs() < 1e-5, "{} m for {depth}", found.depth);
    }

    /// The time is seen to a step, which is 1/4000 of it.
    #[test]
    fn a_hunt_crossley_law_made_for_a_contact_time_takes_it(
        carried in carried(), restitution in 0.05..=1.0_f64, seconds in log_uniform(1e-6, 1.0), speed in log_uniform(1e-3, 1e3),
        exponent in prop_oneof![Just(1.0), Just(1.5), Just(2.0), 1.0..4.0_f64],
    ) {
        let dt = seconds / 4000.0;
        let impact = Impact { speed, restitution };
        let law = HuntCrossley::from_contact_time(carried, exponent, impact, seconds).unwrap();
        let found = bounce(law, carried, speed, dt);
        prop_assert!((found.restitution - restitution).abs() < 1e-5, "{} for {restitution}", found.restitution);
        prop_assert!((found.seconds - seconds).abs() < 2.0 * dt, "{} s for {seconds}", found.seconds);
    }

    #[test]
    fn a_law_made_for_a_depth_at_rest_carries_the_weight_there(
        carried in carried(), restitution in 0.01..1.0_f64, depth in log_uniform(1e-6, 1.0), gravity in log_uniform(0.1, 100.0), exponent in 1.0..3.0_f64,
    ) {
        let weight = carried.mass * gravity;
        let all = f64::from(carried.contacts);
        let law = SpringDamper::from_rest(carried, restitution, depth, gravity).unwrap();
        prop_assert!((law.spring_force(depth) * all / weight - 1.0).abs() < 1e-14);
        let law = LimitedDamper::from_rest(carried, restitution, depth, gravity).unwrap();
        prop_assert!((law.spring_force(depth) * all / weight - 1.0).abs() < 1e-14);
        let impact = Impact { speed: 1.0, restitution };
        let law = HuntCrossley::from_rest(carried, exponent, impact, depth, gravity).unwrap();
        prop_assert!((law.spring_force(depth) * all / weight - 1.0).abs() < 1e-14);
    }

    /// Bit by bit: the report's ground is the report's law on a plane.
    #[test]
    fn a_flat_ground_is_a_spring_and_damper_on_a_plane(
        stiffness in zero_or(1e-6, 1e12), damping in zero_or(1e-6, 1e6), start in -1.0..1.0_f64, end in -1.0..1.0_f64, seconds in log_uniform(1e-6, 1.0),
    ) {
        let flat = FlatGround::level(stiffness, damping);
        let ground: Ground<_, Plane> = Ground::level(SpringDamper { stiffness, damping });
        prop_assert_eq!(flat.mean_force(start, end, seconds), ground.mean_force(start, end, seconds));
        let (force, other) = (flat.normal_force(start.abs(), end), ground.normal_force(start.abs(), end));
        prop_assert_eq!(force.to_bits(), other.to_bits());
        prop_assert_eq!(flat.bounds(), ground.bounds());
    }

    /// Checks that the force does not jump at touch-down.
    ///
    /// At a depth of a billionth of the unit, it is a billionth of the spring's there, or a few of
    /// them, at any speed.
    #[test]
    fn limited_dampers_and_hunt_crossley_touch_softly(
        stiffness in log_uniform(1.0, 1e9), damping in log_uniform(1e-3, 1e3), speed in -100.0..100.0_f64,
    ) {
        let limited = LimitedDamper { stiffness, damping };
        prop_assert!(limited.normal_force(1e-9, speed) <= 2e-9 * stiffness * (1.0 + 1e-15));
        let soft = HuntCrossley { stiffness, exponent: 1.5, damping };
        let most = stiffness * 1e-9_f64.powf(1.5) * (1.0 + damping * speed).max(0.0);
        prop_assert!(soft.normal_force(1e-9, speed) <= most * (1.0 + 1e-14));
    }

    /// The closed forms of the mean force against the midpoint rule on 400 parts of what is in the
    /// ground, and of its slope against differences.
    #[test]
    fn mean_forces_are_means(
        start in -1.0..1.0_f64, end in -1.0..1.0_f64, seconds in log_uniform(1e-3, 1e3),
        damping in zero_or(1e-3, 1e3), exponent in prop_oneof![Just(1.0), Just(1.5), Just(2.0), 1.0..3.0_f64],
    ) {
        let (stiffness, parts) = (1.0, 400);
        let speed = (end - start) / seconds;
        let laws: [&dyn ContactLaw; 3] = [
            &SpringDamper { stiffness, damping },
            &LimitedDamper { stiffness, damping },
            &HuntCrossley { stiffness, exponent, damping },
        ];
        for (number, law) in laws.into_iter().enumerate() {
            let (from, to) = (start.max(0.0), end.max(0.0));
            let (mut sum, mut largest) = (0.0, 0.0_f64);
            for part in 0..parts {
                let depth = from + (to - from) * (f64::from(part) + 0.5) / f64::from(parts);
                let force = if depth > 0.0 { law.normal_force(depth, speed) } else { 0.0 };
                sum += force * (to - from) / (end - start) / f64::from(parts);
                largest = largest.max(force);
            }
            let mean = law.mean_force(start, end, seconds);
            // The midpoint of one part of 400 may lie on the wrong side of a jump.
            prop_assert!((mean.force - sum).abs() <= 1.0 / 400.0 * largest + 1e-12, "law {number}: {} for {sum}", mean.force);
            // The mean force bends upwards nowhere or everywhere within 1e-6, but for kinks: its
            // slope lies between the differences to both sides, to their rounding of 1e-15/1e-6.
            let [less, more] = [-1e-6, 1e-6].map(|aside| law.mean_force(start, end + aside, seconds));
            let slopes = [(mean.force - less.force) / 1e-6, (more.force - mean.force) / 1e-6];
            let slack = (slopes[0] - slopes[1]).abs() + 1e-14 * largest / 1e-6;
            prop_assert!(mean.slope >= slopes[0].min(slopes[1]) - slack, "law {number}: slope {} for {slopes:?}", mean.slope);
            prop_assert!(mean.slope <= slopes[0].max(slopes[1]) + slack, "law {number}: slope {} for {slopes:?}", mean.slope);
        }
    }
}

/// Whether forces and energy are numbers of at least 0 at any finite depth and speed. Products
/// overflow for many of them.
#[test]
fn no_force_and_no_energy_is_nan_at_a_finite_depth() {
    let check = |law: &dyn ContactLaw, name: &str| {
        for depth in [5e-324, 1e-3, 1e3, 1e60, 1e155, 1e210, f64::MAX] {
            let spring = [law.spring_force(depth), law.spring_energy(depth)];
            assert!(spring.iter().all(|x| *x >= 0.0), "{name} {depth:e}");
            for speed in [0.0, 5.0, 1e10, 1e155, f64::MAX] {
                for speed in [speed, -speed] {
                    let force = law.normal_force(depth, speed);
                    assert!(force >= 0.0, "{name} {depth:e} {speed:e}: {force}");
                }
            }
        }
    };
    for stiffness in [0.0, 1e4, 1e200] {
        for damping in [0.0, 0.5, 1e200] {
            let spring_damper = SpringDamper { stiffness, damping };
            check(&spring_damper, &format!("{spring_damper:?}"));
            let limited = LimitedDamper { stiffness, damping };
            check(&limited, &format!("{limited:?}"));
            for exponent in [1.0, 1.5, 2.0, 2.7] {
                let hunt_crossley = HuntCrossley {
                    stiffness,
                    exponent,
                    damping,
                };
                check(&hunt_crossley, &format!("{hunt_crossley:?}"));
            }
        }
    }
    // A contact that separates has no force, also at an infinite depth.
    let law = HuntCrossley {
        stiffness: 1e4,
        exponent: 1.5,
        damping: 0.5,
    };
    assert_eq!(
        law.normal_force(f64::INFINITY, -5.0).to_bits(),
        0.0_f64.to_bits()
    );
}

#[test]
fn hunt_crossley_gives_back_the_printed_part_at_any_exponent() {
    // Case B6 of the validation catalogue (Hunt & Crossley, J. Appl. Mech. 42, 440, 1975), printed
    // to 5e-9; Runge-Kutta's error as above.
    for (damping, restitution) in [
        (0.1, 0.937_475_58),
        (0.3, 0.832_869_79),
        (1.0, 0.593_624_26),
    ] {
        for exponent in [1.0, 1.5, 2.3] {
            let law = HuntCrossley {
                stiffness: 1000.0,
                exponent,
                damping,
            };
            let body = Carried {
                mass: 1.0,
                contacts: 1,
            };
            let found = bounce(law, body, 1.0, 1e-5);
            assert!(
                (found.restitution - restitution).abs() < 1e-6,
                "{} for {restitution} with exponent {exponent}",
                found.restitution
            );
        }
    }
}

#[test]
fn an_elastic_hertz_bounce_takes_2_943_times_depth_over_speed() {
    // Johnson, Contact Mechanics, 1985, eq. 11.24: T = 2.943 δ/v, with δ = (5 m v²/(4 k))^(2/5).
    let (modulus, radius, mass, speed) = (1e7, 0.03, 0.05, 3.0);
    let law = HuntCrossley::hertz(modulus, radius);
    assert!((law.stiffness - 4.0 / 3.0 * 1e7 * 0.03_f64.sqrt()).abs() < 1e-9 * law.stiffness);
    let depth = (5.0 * mass * speed * speed / (4.0 * law.stiffness)).powf(0.4);
    let body = Carried { mass, contacts: 1 };
    let found = bounce(law, body, speed, depth / speed / 4000.0);
    assert!((found.depth / depth - 1.0).abs() < 1e-6);
    // Printed to 1.7e-4 of it, and the last step.
    assert!((found.seconds * speed / depth - 2.943).abs() < 1e-3);
    assert!((found.restitution - 1.0).abs() < 1e-6);
}

/// On a tilted plane a gap is a difference of numbers as large as the position. Without them in the
/// bound of its rounding, 1 in 170 of the touching corners here is left out of the range.
#[test]
fn the_contacts_near_a_tilted_plane_far_from_the_origin_include_those_that_touch() {
    let body = Cuboid::cube(1.0_f32, 1.0);
    let contacts = RigidPointBody::<f32>::contacts(&body);
    let mut random = ChaCha8Rng::seed_from_u64(41);
    let mut number = || (random.next_u32() >> 8) as f32 / (1 << 23) as f32 - 1.0;
    let mut touching = 0;
    for round in 0..60_000 {
        let distance = [10.0, 100.0, 1e3, 1e4][round % 4];
        let [normal, along, turn] = [(); 3].map(|()| Vec3::new(number(), number(), number()));
        let plane = Plane::through(Vec3::ZERO, normal + Vec3::Z * 1.5);
        let along = along.reject_from(plane.normal) * distance;
        let state = State::at(along + plane.normal * (0.75 + 0.12 * number()))
            .with_rotation_vector(turn * 3.0);
        let ground = FlatGround::level(1e3_f32, 0.0).on(plane);
        let model = ContactModel::new(&body, &ground, &Frictionless);
        let axes = state.rotation().axes();
        let range = model.range_within(0.0, state.position, &axes);
        for (index, contact) in contacts.iter().enumerate() {
            if plane.gap(state.position + axes.to_world(contact.position)) < 0.0 {
                touching += 1;
                let place = (index + contacts.len() - range.first) % contacts.len();
                assert!(
                    place < range.count,
                    "round {round}: corner {index}, {range:?}"
                );
            }
        }
    }
    assert!(touching > 20_000, "{touching}");
}
