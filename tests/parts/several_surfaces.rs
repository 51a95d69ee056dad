//! Grounds of several surfaces: closed forms, two halves of a surface against the whole, edges, and
//! that the energy never increases.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]
// Exact zeros and equal bits are compared. A random scene is the same in both precisions.
#![allow(clippy::float_cmp, clippy::cast_possible_truncation)]

use core::ops::ControlFlow;

use crate::kit;
use crate::kit::counting::Counting;
use crate::kit::erased::Stepper;
use proptest::prelude::*;
use tumble::contract::{CheckPlan, FrictionRange, GroundRange, check_friction, check_ground};
use tumble::error::{LawQuantity, Rule, StepError};
use tumble::glam::{DVec3, Vec3};
use tumble::{
    AnyIntegrator, Block, BogackiShampine32, Capsule, Coin, Coulomb, Cuboid, Disc, DormandPrince54,
    Dynamics, Ellipsoid, EnergyMomentum, FlatGround, Flight, FrictionField, Frictionless, Ground,
    Integrator, Ledger, LimitedDamper, MovingGround, Nystrom, Plane, PointMass, RigidPointBody,
    Rk4, Sample, SlidingFriction, Sphere, SpringDamper, SpringDamperGround, State, StrangSplitting,
    Surface, SymplecticEuler, UniformGravity, Viscous, WithResistance,
};

const G: f64 = 9.81;

fn coulomb(coefficient: f64) -> Coulomb {
    Coulomb {
        coefficient,
        slip_speed: 1e-4,
    }
}

/// Plane through a point with springs (N/m) and dampers (N s/m).
fn plane(stiffness: f64, damping: f64, point: DVec3, normal: DVec3) -> FlatGround {
    FlatGround::level(stiffness, damping).on(Plane::through(point, normal))
}

/// A ball of 1 kg in a groove of 90 degrees rests on two springs of 7071 N/m. Each carries
/// `m g/√2`, so each is 0.981 mm deep.
///
/// `EnergyMomentum` stops an oscillation whose kinetic energy is below the rounding of the energy,
/// some 1e-9 m from there.
#[test]
fn a_ball_rests_in_a_groove_at_the_closed_form_depth() {
    let groove =
        |damping| [1.0, -1.0].map(|x| plane(7071.0, damping, DVec3::ZERO, DVec3::new(x, 0.0, 1.0)));
    let depth = G / 2.0_f64.sqrt() / 7071.0;
    assert!((depth - 0.981e-3).abs() < 1e-6);
    let smooth = Ellipsoid::solid(1.0, DVec3::splat(0.05));
    kit::each_method!(1e-4, |integrator, name| {
        let stepper = Stepper::builder(Sphere::solid(1.0, 0.05))
            .gravity(UniformGravity::down(G))
            .ground(groove(60.0))
            .integrator(integrator)
            .build()
            .unwrap();
        let mut state = State::at(DVec3::Z * 0.07);
        stepper.advance(&mut state, 1.0).unwrap();
        let centre = (0.05 - depth) * 2.0_f64.sqrt();
        let off = state.position - DVec3::Z * centre;
        assert!(off.length() < 1e-8, "{name}: {off}");
        let lowest = stepper.lowest_point(&state).unwrap();
        assert!((lowest.gap + depth).abs() < 1e-8, "{name}: {lowest:?}");

        let mut state = State::at(DVec3::Z * 0.07);
        let stepper = Stepper::builder(smooth)
            .gravity(UniformGravity::down(G))
            .ground(groove(60.0))
            .integrator(integrator)
            .build()
            .unwrap();
        stepper.advance(&mut state, 1.0).unwrap();
        let off = state.position - DVec3::Z * centre;
        assert!(off.length() < 1e-8, "{name}, ellipsoid: {off}");
    });
}

/// The longest stable step is that under the law of the surface that the body touches, wherever it
/// stands in the list. Here the resistance to rotation limits it: a ball that lies still has the
/// damping rate `r N/(turn_speed J)`.
#[test]
fn the_longest_stable_step_is_that_of_the_law_below() {
    fn limit(ground: impl SpringDamperGround, friction: impl SlidingFriction) -> f64 {
        let stepper = Stepper::builder(Sphere::solid(1.0, 0.05))
            .ground(ground)
            .friction(friction)
            .integrator(SymplecticEuler { time_step: 1e-6 })
            .build()
            .unwrap();
        let state = State::at(DVec3::Z * 0.045);
        stepper.largest_stable_step(&state).unwrap()
    }
    let floor = plane(1e3, 0.0, DVec3::ZERO, DVec3::Z);
    let wall = plane(1e3, 0.0, DVec3::X * -9.0, DVec3::X);
    let law = |rolling| WithResistance {
        friction: Frictionless,
        rolling,
        spinning: 0.0,
        turn_speed: 1e-3,
    };
    let (strong, weak) = (law(1e-2), law(1e-6));
    let alone = |law: WithResistance<Frictionless>| limit(floor, law);
    assert!(
        alone(strong) < 0.1 * alone(weak),
        "the resistance limits the step"
    );
    for (on_floor, on_wall) in [(strong, weak), (weak, strong)] {
        let expected = alone(on_floor);
        for limit in [
            limit([floor, wall], [on_floor, on_wall]),
            limit([wall, floor], [on_wall, on_floor]),
        ] {
            assert!(
                (limit / expected - 1.0).abs() < 1e-9,
                "{limit} s for {expected} s"
            );
        }
    }
}

/// Two surfaces in the same place, each with half of the springs and dampers, are one surface.
/// Coulomb's friction is proportional to the load, so its halves make the whole too.
#[test]
fn two_halves_of_a_surface_are_the_whole() {
    fn compared<B: RigidPointBody + Copy, I: Integrator + Copy>(
        name: &str,
        body: B,
        integrator: I,
        [position, turn]: [f64; 2],
    ) {
        let tilted = |share: f64| {
            plane(
                2e3 * share,
                2.0 * share,
                DVec3::ZERO,
                DVec3::new(0.1, 0.0, 1.0),
            )
        };
        let whole = Stepper::builder(body)
            .gravity(UniformGravity::down(G))
            .ground(tilted(1.0))
            .friction(WithResistance {
                friction: coulomb(0.4),
                rolling: 1e-4,
                spinning: 1e-4,
                turn_speed: 1e-2,
            })
            .integrator(integrator)
            .build()
            .unwrap();
        let halves = whole.with_ground([tilted(0.5), tilted(0.5)]).unwrap();
        let start = State::at(DVec3::Z * 0.045)
            .with_rotation_vector(DVec3::new(0.3, 0.9, -0.2))
            .with_linear_velocity(DVec3::new(0.4, 0.5, -0.3))
            .with_angular_momentum(DVec3::new(2e-4, -3e-4, 5e-4));
        let (mut one, mut two) = (start, start);
        let (mut first, mut second) = (Ledger::new(), Ledger::new());
        whole.run(&mut one, 0.1, &mut first).unwrap();
        halves.run(&mut two, 0.1, &mut second).unwrap();
        let falls = start.linear_velocity.z - G * 0.1;
        assert!(one.linear_velocity.z - falls > 0.01, "{name}: no touch");
        let off = (two.position - one.position).length();
        assert!(off < position, "{name}: {off:e} m");
        let turned = kit::angle_between(one.orientation, two.orientation);
        assert!(turned < turn, "{name}: {turned:e} rad");
        let works = [first.work(), second.work()];
        let lost = works.map(|work| [work.friction, work.damper]);
        for (one, two) in lost[0].into_iter().zip(lost[1]) {
            assert!(
                (one - two).abs() < 1e-5 * one.abs() + 1e-9,
                "{name}: {one} {two}"
            );
        }
    }
    fn each<B: RigidPointBody + Copy>(name: &str, body: B) {
        let method = EnergyMomentum { time_step: 1e-4 };
        compared(name, body, method, [1e-8, 1e-6]);
        compared(name, body, DormandPrince54::new(1e-9), [1e-7, 1e-5]);
    }
    each("coin", Coin::ring(0.2, 0.05));
    let cuboid = Cuboid::solid(0.2, DVec3::new(0.1, 0.06, 0.04));
    kit::each_method!(1e-4, |integrator, name| {
        compared(name, cuboid, integrator, [1e-8, 1e-6]);
    });
    let flight = Flight(EnergyMomentum { time_step: 1e-4 });
    compared("flight", cuboid, flight, [1e-8, 1e-6]);
    compared("3(2)", cuboid, BogackiShampine32::new(1e-9), [1e-7, 1e-5]);
    each("disc", Disc::solid(0.2, 0.05, 120));
    each(
        "ellipsoid",
        Ellipsoid::solid(0.2, DVec3::new(0.06, 0.05, 0.04)),
    );
    each("capsule", Capsule::solid(0.2, 0.03, 0.08));
}

/// A body that never reaches the walls moves as without them, to rounding.
#[test]
fn a_wall_out_of_reach_changes_nothing() {
    let floor = FlatGround::level(2e3, 2.0);
    let wall = plane(1e5, 3.0, DVec3::X * -3.0, DVec3::X);
    let start = State::at(DVec3::Z * 0.2)
        .with_rotation_vector(DVec3::new(0.3, 0.9, -0.2))
        .with_linear_velocity(DVec3::new(0.4, 0.5, -0.3))
        .with_angular_momentum(DVec3::new(2e-4, -3e-4, 5e-4));
    kit::each_method!(1e-3, |integrator, name| {
        // Contacts with a radius, because the sums of bare contacts have another order on a plane.
        let alone = Stepper::builder(Capsule::solid(0.2, 0.03, 0.08))
            .gravity(UniformGravity::down(G))
            .ground(floor)
            .friction(coulomb(0.3))
            .integrator(integrator)
            .build()
            .unwrap();
        let walled = alone.with_ground((floor, wall)).unwrap();
        let (mut one, mut two) = (start, start);
        alone.advance(&mut one, 0.5).unwrap();
        walled.advance(&mut two, 0.5).unwrap();
        let off = (one.position - two.position).length();
        assert!(off < 1e-9, "{name}: {off:e}");
    });
}

/// A slope that is the last of three surfaces is touched as if it were the only one: at the same
/// moments, in as many steps and evaluations. So the searches for the touch-down of `Nystrom`, of
/// the adaptive pairs and of `Flight` know each surface.
#[test]
fn the_last_surface_is_touched_as_the_only_one() {
    let slope = plane(2e3, 2.0, DVec3::ZERO, DVec3::new(0.3, 0.1, 1.0).normalize());
    let wall = plane(1e5, 3.0, DVec3::X * -3.0, DVec3::X);
    let lid = plane(1e4, 1.0, DVec3::Z * 3.0, -DVec3::Z);
    let start = State::at(DVec3::Z * 0.3)
        .with_rotation_vector(DVec3::new(0.3, 0.9, -0.2))
        .with_linear_velocity(DVec3::new(0.4, 0.5, -0.3))
        .with_angular_momentum(DVec3::new(2e-4, -3e-4, 5e-4));
    fn same(
        name: &str,
        surfaces: [FlatGround; 3],
        start: State,
        integrator: impl Integrator + Copy,
    ) {
        let end = |ground: &[FlatGround]| {
            let stepper = Stepper::builder(Capsule::solid(0.2, 0.03, 0.08))
                .gravity(UniformGravity::down(G))
                .ground(ground)
                .friction(coulomb(0.3))
                .integrator(integrator)
                .build()
                .unwrap();
            let (mut state, mut cost, mut touched) = (start, [0; 2], false);
            let mut watch = |sample: &Sample<'_>| {
                cost = [sample.step, sample.evaluations];
                touched |= sample.touching() > 0;
                ControlFlow::Continue(())
            };
            stepper.run(&mut state, 0.4, &mut watch).unwrap();
            assert!(touched, "{name}");
            (state, cost)
        };
        let [(one, cost), (other, other_cost)] = [&surfaces[2..], &surfaces[..]].map(end);
        let off = (one.position - other.position).length();
        assert!(off < 1e-9, "{name}: {off:e} m");
        // A flight has to be out of reach of each surface for its longest steps, and the reach is a
        // bound. So an adaptive method may take a step more in each flight.
        let more = [0, 1].map(|part| other_cost[part].abs_diff(cost[part]));
        assert!(
            more[0] * 100 <= cost[0] && more[1] * 100 <= cost[1],
            "{name}: {more:?} of {cost:?}"
        );
    }
    let surfaces = [wall, lid, slope];
    kit::each_method!(1e-3, |integrator, name| {
        same(name, surfaces, start, integrator);
    });
    same("Flight", surfaces, start, Flight(Rk4 { time_step: 1e-3 }));
    same("5(4)", surfaces, start, DormandPrince54::new(1e-7));
    same("3(2)", surfaces, start, BogackiShampine32::new(1e-6));
}

/// A ball that flies through a room without gravity lands on the first wall in its way, after the
/// distance over the speed, with each kind of method.
#[test]
fn a_landing_in_a_room_is_that_on_the_first_wall() {
    let (radius, half) = (0.03, DVec3::new(0.5, 0.7, 0.4));
    let walls = [
        DVec3::X,
        -DVec3::X,
        DVec3::Y,
        -DVec3::Y,
        DVec3::Z,
        -DVec3::Z,
    ]
    .map(|inwards| plane(1e4, 1.0, inwards * -(inwards * half).length(), inwards));
    let velocities = [
        DVec3::new(1.0, 0.2, 0.3),
        DVec3::new(-0.1, 0.9, -0.2),
        DVec3::new(0.2, -0.3, -0.9),
    ];
    kit::each_method!(1e-2, |integrator, name| {
        let stepper = Stepper::builder(Sphere::solid(0.1, radius))
            .ground(walls)
            .integrator(integrator)
            .build()
            .unwrap();
        for velocity in velocities {
            let times = (DVec3::splat(-radius) + half) / velocity.abs();
            let first = times.min_element();
            let mut session = stepper.session(State::default().with_linear_velocity(velocity));
            let end = session.run_until_event(10.0, [&tumble::Landing]).unwrap();
            let landing = end.occurrence().unwrap();
            let off = landing.time - first;
            assert!(off.abs() < 1e-12, "{name}, {velocity}: {off:e} s");
            let lowest = stepper.lowest_point(session.state()).unwrap();
            let out = lowest.position / half;
            assert!(
                (out.abs().max_element() - 1.0).abs() < 1e-12,
                "{name}: {out}"
            );
        }
    });
}

/// Of 1200 points none is evaluated above a wall that they cannot reach, and few above the floor.
/// An adaptive pair evaluates the wall twice at most. `EnergyMomentum` evaluates each point about
/// once.
#[test]
fn a_wall_out_of_reach_is_not_evaluated() {
    let points = 1200;
    let floor = Counting::new(FlatGround::level(10.0, 0.01));
    let wall = Counting::new(plane(1e3, 1.0, DVec3::X * -3.0, DVec3::X));
    let storage = vec![tumble::ContactPoint::default(); points];
    let coin = Coin::ring_with_storage(storage, 1.0, 0.5);
    let start = State::at(DVec3::Z * 0.49).with_rotation_vector(DVec3::Y * 0.1);
    let evaluations = |integrator: AnyIntegrator| {
        let stepper = Stepper::builder(&coin)
            .gravity(UniformGravity::down(G))
            .ground((&floor, &wall))
            .friction(coulomb(0.3))
            .integrator(integrator)
            .build()
            .unwrap();
        let mut session = stepper.session(start);
        session.step().unwrap();
        floor.take();
        wall.take();
        session.step().unwrap();
        [floor.take().surfaces, wall.take().surfaces]
    };
    let time_step = 1e-4;
    let methods = [
        (AnyIntegrator::from(SymplecticEuler { time_step }), 0),
        (StrangSplitting { time_step }.into(), 0),
        (Rk4 { time_step }.into(), 0),
        (Nystrom { time_step }.into(), 0),
        (DormandPrince54::new(1e-6).into(), 2),
        (EnergyMomentum { time_step }.into(), 10),
    ];
    for (method, most) in methods {
        let [on_floor, on_wall] = evaluations(method).map(|count| count as usize);
        assert!(on_wall <= most, "{method:?}: {on_wall} above the wall");
        assert!(
            (1..points * 2).contains(&on_floor),
            "{method:?}: {on_floor}"
        );
    }
}

/// A block is pressed on the floor by its weight and on a wall by a tilted gravity. It slides along
/// both. The way is `v²/(2 (μ₁ g₁ + μ₂ g₂))`.
#[test]
fn each_surface_has_its_own_friction() {
    let (mu, gravity, v) = ([0.2, 0.5], [9.0, 3.0], 1.5);
    let stiffness = 9.0e5;
    let damping = 2.0 * f64::sqrt(stiffness);
    let surfaces = (
        FlatGround::level(stiffness, damping),
        Ground {
            law: LimitedDamper { stiffness, damping },
            shape: Plane::through(DVec3::ZERO, DVec3::Y),
        },
    );
    let deceleration = mu[0] * gravity[0] + mu[1] * gravity[1];
    let seconds = v / deceleration;
    kit::each_method!(1e-5, |integrator, name| {
        let stepper = Stepper::builder(PointMass::new(1.0))
            .gravity(UniformGravity {
                acceleration: DVec3::new(0.0, -gravity[1], -gravity[0]),
            })
            .ground(surfaces)
            .friction((coulomb(mu[0]), [coulomb(mu[1])]))
            .integrator(integrator)
            .build()
            .unwrap();
        let depth = DVec3::new(0.0, gravity[1], gravity[0]) / stiffness;
        let mut state = State::at(-depth).with_linear_velocity(DVec3::X * v);
        let mut ledger = Ledger::new();
        stepper.run(&mut state, seconds, &mut ledger).unwrap();
        let way = v * v / (2.0 * deceleration);
        assert!(
            (state.position.x / way - 1.0).abs() < 3e-4,
            "{name}: {}",
            state.position.x
        );
        let heat = -ledger.work().friction;
        assert!(
            (heat / (v * v / 2.0) - 1.0).abs() < 1e-3,
            "{name}: {heat} J"
        );
        // The other order of the laws would stop it later.
        let other = mu[1] * gravity[0] + mu[0] * gravity[1];
        assert!((v * v / (2.0 * other) / way - 1.0).abs() > 0.3);
    });
}

/// A ball between a floor and a lid that is closer than its diameter is squeezed by both:
/// `k₁ d₁ - k₂ d₂ = m g` with `d₁ + d₂ = 2 r - h`.
#[test]
fn a_ball_is_squeezed_between_floor_and_lid() {
    let (mass, radius, height, [k1, k2]) = (0.5, 0.05, 0.098, [4e3, 9e3]);
    let d1 = (mass * G + k2 * (2.0 * radius - height)) / (k1 + k2);
    kit::each_method!(1e-4, |integrator, name| {
        let stepper = Stepper::builder(Sphere::solid(mass, radius))
            .gravity(UniformGravity::down(G))
            .ground((
                FlatGround::level(k1, 40.0),
                plane(k2, 60.0, DVec3::Z * height, -DVec3::Z),
            ))
            .integrator(integrator)
            .build()
            .unwrap();
        let mut state = State::at(DVec3::Z * 0.0495);
        stepper.advance(&mut state, 1.0).unwrap();
        let depth = radius - state.position.z;
        assert!((depth - d1).abs() < 1e-9, "{name}: {depth} instead of {d1}");
    });
}

/// A ball without friction flies between two walls without gravity. Each has its own restitution,
/// that of its spring and damper.
#[test]
fn each_wall_throws_a_ball_back_by_its_own_law() {
    let (mass, radius) = (0.1, 0.02);
    let restitution = [0.9, 0.6];
    let carried = tumble::Carried { mass, contacts: 1 };
    let wall = |index: usize, normal: DVec3| Ground {
        law: SpringDamper::from_bounce(carried, restitution[index], 1e-3).unwrap(),
        shape: Plane::through(normal * -0.1, normal),
    };
    let stepper = Stepper::builder(Sphere::solid(mass, radius))
        .ground((wall(0, DVec3::X), wall(1, -DVec3::X)))
        .integrator(EnergyMomentum { time_step: 1e-5 })
        .build()
        .unwrap();
    let mut state = State::at(DVec3::ZERO).with_linear_velocity(DVec3::X * 2.0);
    let mut speed = 2.0;
    for bounce in 0..4 {
        let before = state.linear_velocity.x;
        while state.linear_velocity.x * before > 0.0 || state.position.x.abs() > 0.05 {
            stepper.step(&mut state).unwrap();
        }
        speed *= restitution[(bounce + 1) % 2];
        let found = state.linear_velocity.x.abs();
        assert!(
            (found / speed - 1.0).abs() < 2e-3,
            "{bounce}: {found} instead of {speed}"
        );
    }
}

/// A ball rolls over the edge of a table and leaves it as soon as its contact force vanishes. With
/// a slow start that is where a sphere leaves a sharp edge: a ball that rolls without slip leaves
/// at `cos θ = 10/17` (a classic result; `m g cos θ = m v²/r`, `v² = 10/7 g r (1 - cos θ)`).
#[test]
fn a_ball_rolls_over_an_edge_and_leaves_it() {
    let radius = 0.02;
    let table = Ground {
        law: SpringDamper {
            stiffness: 1e7,
            damping: 500.0,
        },
        shape: Block {
            centre: DVec3::new(-0.5, 0.0, -0.1),
            half: DVec3::new(0.5, 1.0, 0.1),
        },
    };
    let stepper = Stepper::builder(Sphere::solid(0.1, radius))
        .gravity(UniformGravity::down(G))
        .ground((table, FlatGround::level(1e5, 10.0).on(Plane::level(-0.2))))
        .friction(Coulomb {
            coefficient: 20.0,
            slip_speed: 1e-6,
        })
        .integrator(EnergyMomentum { time_step: 1e-5 })
        .build()
        .unwrap();
    let slow = 0.01;
    let axes = State::at(DVec3::ZERO).rotation().axes();
    let momentum =
        (stepper.scene().inertia_properties()).angular_momentum(&axes, DVec3::Y * (slow / radius));
    let mut state = State::at(DVec3::new(-0.001, 0.0, radius))
        .with_linear_velocity(DVec3::X * slow)
        .with_angular_momentum(momentum);
    let mut last = state;
    for _ in 0..200_000 {
        stepper.step(&mut state).unwrap();
        if state.position.x > 0.0 && stepper.energy(&state).springs == 0.0 {
            break;
        }
        last = state;
    }
    let cosine = last.position.z / last.position.length();
    // The start has 1e-4 J/kg more than rest: the angle is that of a slightly higher edge.
    let head = slow * slow / (G * radius);
    let expected = (10.0 + 7.0 * head) / 17.0;
    assert!(
        (cosine - expected).abs() < 5e-3,
        "{cosine} instead of {expected}"
    );
    // It then falls on the floor beside the table, and touches nothing on its way.
    stepper.advance(&mut state, 0.1).unwrap();
    assert!(state.position.x > 0.02, "{state}");
}

/// A block keeps the contract of a ground that need not be checked, at faces, edges and corners.
#[test]
fn a_block_passes_the_check_of_a_ground() {
    let half = DVec3::new(0.5, 0.4, 0.1);
    let ground = Ground {
        law: SpringDamper {
            stiffness: 1e4,
            damping: 10.0,
        },
        shape: Block::<f64> {
            centre: DVec3::ZERO,
            half,
        },
    };
    let plan = CheckPlan {
        cases: 5000,
        ..CheckPlan::default()
    };
    for centre in [DVec3::Z * 0.1, DVec3::new(0.5, 0.0, 0.1), half, DVec3::ZERO] {
        let range = GroundRange {
            centre,
            size: 0.3,
            depth: 0.01,
            speed: 5.0,
        };
        check_ground(&ground, &range, plan).unwrap();
    }
}

/// A point beyond the edge feels nothing of a table, above or below its top, and one that comes
/// from the side is stopped by the side.
#[test]
fn a_contact_beyond_an_edge_feels_nothing() {
    let table = Block {
        centre: DVec3::ZERO,
        half: DVec3::new(0.5, 0.5, 0.1),
    };
    let ground = Ground {
        law: SpringDamper {
            stiffness: 1e4,
            damping: 10.0,
        },
        shape: table,
    };
    let stepper = Stepper::builder(PointMass::new(0.1))
        .gravity(UniformGravity::down(G))
        .ground(ground)
        .integrator(EnergyMomentum { time_step: 1e-3 })
        .build()
        .unwrap();
    let mut falls = State::at(DVec3::new(0.501, 0.0, 0.3));
    stepper.advance(&mut falls, 0.5).unwrap();
    let expected = 0.3 - G * 0.125;
    assert!((falls.position.z - expected).abs() < 1e-12, "{falls}");
    let mut comes = State::at(DVec3::new(0.6, 0.0, 0.09)).with_linear_velocity(DVec3::X * -5.0);
    stepper.advance(&mut comes, 0.05).unwrap();
    assert!(
        comes.position.x > 0.49 && comes.linear_velocity.x > 0.0,
        "{comes}"
    );
}

/// A tray of a floor and four walls, with 1e-3 of play for a body.
fn tray<R: tumble::Real>(half: [f64; 2], stiffness: f64, damping: f64) -> [FlatGround<R>; 5] {
    let flat = |point: DVec3, normal: DVec3| {
        use tumble::real::Vector;
        let vector = |v: DVec3| R::Vec3::new(R::from_f64(v.x), R::from_f64(v.y), R::from_f64(v.z));
        FlatGround::level(R::from_f64(stiffness), R::from_f64(damping))
            .on(Plane::through(vector(point), vector(normal)))
    };
    [
        flat(DVec3::ZERO, DVec3::Z),
        flat(DVec3::X * half[0], -DVec3::X),
        flat(DVec3::X * -half[0], DVec3::X),
        flat(DVec3::Y * half[1], -DVec3::Y),
        flat(DVec3::Y * -half[1], DVec3::Y),
    ]
}

/// A die in a tray stays inside, comes to rest and sleeps: its next steps cost no iteration.
#[test]
fn a_die_in_a_tray_comes_to_rest() {
    let die = Cuboid::solid(0.005, DVec3::splat(0.016));
    let stepper = Stepper::builder(die)
        .gravity(UniformGravity::down(G))
        .ground(tray::<f64>([0.05, 0.04], 2e3, 1.0))
        .friction(coulomb(0.3))
        .integrator(EnergyMomentum { time_step: 1e-4 })
        .build()
        .unwrap();
    let mut session = stepper.session(
        State::at(DVec3::new(0.0, 0.0, 0.05))
            .with_linear_velocity(DVec3::new(1.5, -1.1, 0.0))
            .with_rotation_vector(DVec3::new(0.4, 0.2, 0.1))
            .with_angular_momentum(DVec3::new(1e-5, -2e-5, 1e-5)),
    );
    session.advance(4.0).unwrap();
    let state = *session.state();
    assert!(
        state.position.x.abs() < 0.045 && state.position.y.abs() < 0.035,
        "{state}"
    );
    assert!(state.linear_velocity == DVec3::ZERO, "{state}");
    assert_eq!(session.step().unwrap().iterations, 0);
}

/// `Flight` ends a flight before the first surface that is touched, so it takes a body through a
/// room like the method alone, in fewer steps.
#[test]
fn flight_ends_before_the_first_surface() {
    let method = EnergyMomentum { time_step: 2e-4 };
    let plain = Stepper::builder(Sphere::solid(0.1, 0.03))
        .gravity(UniformGravity::down(G))
        .ground(tray::<f64>([0.5, 0.4], 2e4, 1.0))
        .friction(coulomb(0.3))
        .integrator(method)
        .build()
        .unwrap();
    let flying = plain.with_integrator(Flight(method)).unwrap();
    let start = State::at(DVec3::new(0.0, 0.0, 0.3))
        .with_linear_velocity(DVec3::new(3.0, -2.0, 1.0))
        .with_angular_momentum(DVec3::new(1e-4, 2e-5, 1e-5));
    let (mut one, mut two) = (start, start);
    let mut counts = [0; 2];
    let mut count = |_: &Sample<'_>| {
        counts[0] += 1;
        ControlFlow::Continue(())
    };
    plain.run(&mut one, 1.0, &mut count).unwrap();
    let mut count = |_: &Sample<'_>| {
        counts[1] += 1;
        ControlFlow::Continue(())
    };
    flying.run(&mut two, 1.0, &mut count).unwrap();
    let off = (one.position - two.position).length();
    assert!(off < 1e-9, "{off:e} m after {counts:?} steps");
    assert!(counts[1] * 3 < counts[0], "{counts:?}");
}

/// The order of each method for a body that slides and turns in a groove of unlike walls.
#[test]
fn every_method_keeps_its_order_in_a_groove() {
    fn end<I: Integrator>(integrator: I) -> State {
        let stepper = Stepper::builder(Sphere::solid(0.1, 0.05))
            .gravity(UniformGravity::down(G))
            .ground((
                plane(100.0, 2.0, DVec3::ZERO, DVec3::new(1.0, 0.0, 1.0)),
                plane(170.0, 1.0, DVec3::ZERO, DVec3::new(-0.5, 0.1, 1.0)),
            ))
            .friction((Viscous { coefficient: 0.4 }, Viscous { coefficient: 0.1 }))
            .integrator(integrator)
            .build()
            .unwrap();
        let mut state = State::at(DVec3::new(0.01, 0.0, 0.055))
            .with_linear_velocity(DVec3::new(0.02, -0.3, 0.0))
            .with_angular_momentum(DVec3::new(1e-4, 2e-4, 3e-4));
        stepper.advance(&mut state, 0.16).unwrap();
        state
    }
    let truth = end(DormandPrince54::new(1e-12));
    let mut errors = Vec::new();
    for time_step in [2e-3, 1e-3] {
        kit::each_method!(time_step, |integrator, name| {
            let error = (end(integrator).position - truth.position).length();
            errors.push((name, integrator.order(), error));
        });
    }
    let (coarse, fine) = errors.split_at(errors.len() / 2);
    for ((name, order, coarse), (_, _, fine)) in coarse.iter().zip(fine) {
        let found = kit::order(*coarse, *fine);
        assert!(
            (found - f64::from(*order)).abs() < 0.5,
            "{name}: order {found}"
        );
    }
}

/// All surfaces of a moving ground move as one: a ball at the rim of a turntable takes its rate.
#[test]
fn surfaces_move_as_one() {
    let rate = 3.0;
    let pot = (
        FlatGround::level(1e5, 60.0),
        plane(1e5, 60.0, DVec3::X * 0.3, -DVec3::X),
    );
    let belt = MovingGround::conveyor(pot, DVec3::Y * rate);
    let stepper = Stepper::builder(Cuboid::solid(0.1, DVec3::splat(0.05)))
        .gravity(UniformGravity {
            acceleration: DVec3::new(3.0, 0.0, -G),
        })
        .ground(belt)
        .friction(coulomb(0.5))
        .integrator(EnergyMomentum { time_step: 1e-4 })
        .build()
        .unwrap();
    let mut state = State::at(DVec3::new(0.275, 0.0, 0.025));
    let mut ledger = Ledger::new();
    stepper.run(&mut state, 1.5, &mut ledger).unwrap();
    assert!((state.linear_velocity.y - rate).abs() < 1e-3, "{state}");
    let work = 0.1 * rate * rate;
    let drive = ledger.work().drive;
    assert!(
        (drive / work - 1.0).abs() < 2e-3,
        "{drive} J instead of {work}"
    );
    let range = GroundRange {
        centre: DVec3::ZERO,
        size: 0.5,
        depth: 0.01,
        speed: 1.0,
    };
    check_ground(&belt, &range, CheckPlan::default()).unwrap();
    let lifted = MovingGround::conveyor(pot, DVec3::X);
    let error = stepper.with_ground(lifted).unwrap_err();
    assert_eq!(error.rule, Rule::Zero, "{error}");
}

/// Slices, boxed grounds and nested tuples are the same ground.
#[test]
fn every_composition_is_the_same_ground() {
    let [floor, a, b, c, d] = tray::<f64>([0.2, 0.2], 3e3, 2.0);
    let start = State::at(DVec3::Z * 0.1)
        .with_linear_velocity(DVec3::new(3.0, 2.0, 0.0))
        .with_angular_momentum(DVec3::new(1e-4, 2e-4, 3e-4));
    fn end<T: SpringDamperGround>(ground: T, mut state: State) -> State {
        let stepper = Stepper::builder(Cuboid::solid(0.1, DVec3::splat(0.04)))
            .gravity(UniformGravity::down(G))
            .ground(ground)
            .friction(coulomb(0.3))
            .integrator(EnergyMomentum { time_step: 1e-3 })
            .build()
            .unwrap();
        stepper.advance(&mut state, 0.5).unwrap();
        state
    }
    let array = [floor, a, b, c, d];
    let expected = end(array, start);
    assert!(expected.position.x.abs() < 0.2 && expected.position.y.abs() < 0.2);
    assert_eq!(end(&array[..], start), expected);
    assert_eq!(end((floor, a, b, c, d), start), expected);
    assert_eq!(end((floor, [a, b], (c, d)), start), expected);
    let boxed: Box<dyn SpringDamperGround> = Box::new((floor, [a, b, c, d]));
    assert_eq!(end(&boxed, start), expected);
    // No surface is no ground.
    let empty: [FlatGround; 0] = [];
    let mut falls = start;
    falls.position.z = 0.0;
    let z = end(empty, falls).position.z;
    assert!((z + G * 0.125).abs() < 1e-12, "{z}");
}

#[test]
fn wrong_numbers_and_moving_parts_are_refused() {
    let floor = FlatGround::level(1e3, 1.0);
    let body = PointMass::new(1.0);
    let composed = |laws: &[Coulomb]| {
        let laws = laws.to_vec();
        Stepper::builder(body)
            .ground((floor, floor))
            .friction(laws.as_slice())
            .build()
            .map(|_| ())
    };
    composed(&[coulomb(0.1), coulomb(0.2)]).unwrap();
    let error = composed(&[coulomb(0.1)]).unwrap_err();
    assert_eq!(
        (error.rule, error.value),
        (Rule::Exactly(2), 1.0),
        "{error}"
    );
    let belt = MovingGround::conveyor(floor, DVec3::X);
    let error = Stepper::builder(body)
        .ground((floor, belt))
        .build()
        .map(|_| ())
        .unwrap_err();
    assert_eq!((error.rule, error.value), (Rule::Zero, 1.0), "{error}");
    let table = MovingGround::turntable(floor, DVec3::ZERO, f64::NAN);
    let error = Stepper::builder(body).ground((floor, table)).build();
    assert!(error.is_err(), "a rate that is not a number");
    let still = MovingGround::conveyor(floor, DVec3::ZERO);
    Stepper::builder(body)
        .ground((floor, still))
        .build()
        .unwrap();
    let bent = floor.on(Plane {
        normal: DVec3::Z * 2.0,
        height: 0.0,
    });
    let error = Stepper::builder(body)
        .ground([floor, bent])
        .build()
        .map(|_| ())
        .unwrap_err();
    assert_eq!(error.rule, Rule::UnitLength, "{error}");
    {
        let law = (coulomb(0.1), coulomb(0.2));
        let around = WithResistance {
            friction: law,
            rolling: 1e-3,
            spinning: 1e-3,
            turn_speed: 1e-2,
        };
        let error = SlidingFriction::<f64>::check(&around).unwrap_err();
        assert_eq!(
            (error.rule, error.value),
            (Rule::Exactly(1), 2.0),
            "{error}"
        );
        let field = FrictionField::new(move |_: DVec3| law);
        let error = SlidingFriction::<f64>::check(&field).unwrap_err();
        assert_eq!(error.rule, Rule::Exactly(1), "{error}");
    }
    let flat = Ground {
        law: SpringDamper {
            stiffness: 1.0,
            damping: 1.0,
        },
        shape: Block {
            centre: DVec3::ZERO,
            half: DVec3::new(1.0, 0.0, 1.0),
        },
    };
    let error = Stepper::builder(body)
        .ground(flat)
        .build()
        .map(|_| ())
        .unwrap_err();
    assert_eq!(error.rule, Rule::AboveZero, "{error}");
}

/// A wall whose force is NaN from a depth on, and a wall that pulls at friction.
struct Broken;

impl SpringDamperGround for Broken {
    fn surface(&self, point: DVec3) -> Surface {
        Surface {
            gap: point.x + 1.0,
            normal: DVec3::X,
        }
    }
    fn spring_force(&self, depth: f64) -> f64 {
        if depth > 0.01 {
            f64::NAN
        } else {
            100.0 * depth
        }
    }
    fn spring_energy(&self, depth: f64) -> f64 {
        50.0 * depth * depth
    }
    fn normal_force(&self, depth: f64, _closing_speed: f64) -> f64 {
        self.spring_force(depth)
    }
}

/// A broken law of one surface among several is found by the checks and by a step.
#[test]
fn one_broken_surface_is_found() {
    let ground = (FlatGround::level(1e3, 1.0), Broken);
    let range = GroundRange {
        centre: DVec3::ZERO,
        size: 0.5,
        depth: 0.1,
        speed: 1.0,
    };
    assert!(check_ground(&ground, &range, CheckPlan::default()).is_err());
    check_ground(&(ground.0, ground.0), &range, CheckPlan::default()).unwrap();
    kit::each_method!(1e-3, |integrator, name| {
        let stepper = Stepper::builder(Sphere::solid(0.1, 0.1))
            .gravity(UniformGravity::down(G))
            .ground(&ground)
            .friction((coulomb(0.3), Frictionless))
            .integrator(integrator)
            .build()
            .unwrap();
        let mut state = State::at(DVec3::Z * 0.1).with_linear_velocity(DVec3::X * -3.0);
        let error = stepper.advance(&mut state, 1.0).unwrap_err();
        let is_found = matches!(
            error,
            StepError::BrokenLaw {
                quantity: LawQuantity::NormalForce
                    | LawQuantity::SpringForce
                    | LawQuantity::MeanForce,
                ..
            }
        );
        assert!(is_found, "{name}: {error}");
    });

    /// Friction that pushes.
    struct Active;
    impl tumble::SlidingFriction for Active {
        fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
            slip * normal_force
        }
    }
    let range = FrictionRange {
        centre: DVec3::ZERO,
        size: 1.0,
        normal: DVec3::Z,
        normal_force: 10.0,
        slip: 1.0,
    };
    check_friction(&[coulomb(0.3), coulomb(0.1)], &range, CheckPlan::default()).unwrap();
    assert!(check_friction(&(coulomb(0.3), Active), &range, CheckPlan::default()).is_err());
}

/// Takes random steps in random rooms and checks that the energy never increases, as computed.
macro_rules! never_gains {
    ($real:ty, $vec:ty, $body:expr, $room:expr, $start:expr, $h:expr) => {{
        let [position, velocity, momentum, turn]: [DVec3; 4] = $start;
        let (stiffness, damping, half, edge): (f64, f64, [f64; 2], DVec3) = $room;
        let cast = |v: DVec3| <$vec>::new(v.x as $real, v.y as $real, v.z as $real);
        let step = tumble::Ground {
            law: tumble::SpringDamper::<$real> {
                stiffness: stiffness as $real,
                damping: damping as $real,
            },
            shape: tumble::Block::<$real> {
                centre: cast(edge),
                half: cast(DVec3::splat(0.1)),
            },
        };
        let stepper = Stepper::new($body)
            .and_then(|stepper| stepper.with_gravity(tumble::UniformGravity::down(9.8)))
            .and_then(|stepper| {
                stepper.with_ground((tray::<$real>(half, stiffness, damping), step))
            })
            .and_then(|stepper| {
                stepper.with_friction(tumble::Coulomb {
                    coefficient: 0.6,
                    slip_speed: 1e-4,
                })
            })
            .and_then(|stepper| {
                stepper.with_integrator(tumble::EnergyMomentum {
                    time_step: $h as $real,
                })
            })
            .unwrap();
        let mut state = tumble::State::<$real>::at(cast(position))
            .with_rotation_vector(cast(turn))
            .with_linear_velocity(cast(velocity))
            .with_angular_momentum(cast(momentum));
        let mut before = stepper.energy(&state).total();
        for _ in 0..60 {
            stepper.step(&mut state).unwrap();
            let after = stepper.energy(&state).total();
            prop_assert!(
                after <= before,
                "{before:e} J before, {after:e} J after {state}"
            );
            before = after;
        }
    }};
}

fn vector(size: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-size..size).prop_map(DVec3::from_array)
}

proptest! {
    #![proptest_config(kit::cases(300))]

    /// Any body in a tray with a block in it, thrown anywhere, also into the walls.
    #[test]
    fn no_step_among_surfaces_increases_the_energy(
        position in vector(0.4),
        velocity in vector(10.0),
        momentum in vector(0.02),
        turn in vector(3.0),
        room in (1.0..6.0_f64, 0.0..2.0_f64, prop::array::uniform2(0.05..0.4), vector(0.3)),
        h in -5.0..-1.5_f64,
        kind in 0..4_u8,
    ) {
        let (stiffness, ratio, half, edge) = room;
        let k = 10.0_f64.powf(stiffness);
        let room = (k, ratio * k.sqrt(), half, edge);
        let (start, h) = ([position, velocity, momentum, turn], 10.0_f64.powf(h));
        let size = DVec3::new(0.1, 0.07, 0.03);
        let small = Vec3::new(0.1, 0.07, 0.03);
        match kind {
            0 => {
                never_gains!(f64, DVec3, tumble::Cuboid::<f64>::solid(0.3, size), room, start, h);
                never_gains!(f32, Vec3, tumble::Cuboid::<f32>::solid(0.3, small), room, start, h);
            }
            1 => {
                never_gains!(f64, DVec3, tumble::Ellipsoid::<f64>::solid(0.3, size), room, start, h);
                never_gains!(f32, Vec3, tumble::Ellipsoid::<f32>::solid(0.3, small), room, start, h);
            }
            2 => {
                never_gains!(f64, DVec3, tumble::Disc::<f64>::solid(0.3, 0.05, 120), room, start, h);
                never_gains!(f32, Vec3, tumble::Disc::<f32>::solid(0.3, 0.05, 120), room, start, h);
            }
            _ => {
                never_gains!(f64, DVec3, tumble::Coin::<f64>::ring(0.3, 0.05), room, start, h);
                never_gains!(f32, Vec3, tumble::Capsule::<f32>::solid(0.3, 0.03, 0.08), room, start, h);
            }
        }
    }
}
