//! A body whose contact moves over its surface: an ellipsoid.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use core::f64::consts::{FRAC_PI_2, TAU};

use crate::kit::erased::Stepper;
use crate::kit::{self, GRAVITY, cases, difference, directions, end, log_uniform, order};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use tumble::contract::{CheckPlan, Requirement, check_body};
use tumble::f32 as single;
use tumble::f64::{
    Capsule, Coin, Cone, Cuboid, Disc, Ellipsoid, MassProperties, Sphere, ThickDisc,
};
use tumble::glam::{DMat3, DQuat, DVec3, Vec3};
use tumble::{
    Bowl, ContactPoint, Coulomb, DormandPrince54, EnergyMomentum, FlatGround, Frictionless, Ground,
    Integrator, RigidPointBody, Rk4, Shape, SmoothCoulomb, SpringDamper, State, StrangSplitting,
    Terrain, UniformGravity, Waves,
};

proptest! {
    #![proptest_config(cases(128))]

    /// The whole surface is behind the tangent plane at the point that is farthest in a direction,
    /// and touches it.
    #[test]
    fn the_support_is_the_farthest_place_of_the_surface(
        axes in (log_uniform(1e-3, 1e3), log_uniform(1e-3, 1e3), log_uniform(1e-3, 1e3)),
        towards in directions(), other in directions(),
    ) {
        let semi_axes = DVec3::from(axes);
        let egg = Ellipsoid::solid(1.0, semi_axes);
        let place = egg.support_point(towards);
        // On the surface: (x/a)² + (y/b)² + (z/c)² = 1.
        prop_assert!(((place / semi_axes).length() - 1.0).abs() < 1e-14);
        let beyond = towards.dot(other.normalize() * semi_axes - place);
        prop_assert!(beyond <= 1e-14 * semi_axes.max_element(), "{}", beyond);
        let height = (semi_axes * towards).length();
        prop_assert!((towards.dot(place) - height).abs() <= 1e-14 * height);
    }
}

#[test]
fn an_ellipsoid_with_equal_axes_is_a_sphere() {
    let distribution = MassProperties::ball(0.5, 0.1)
        .unwrap()
        .at(DVec3::new(0.01, 0.0, -0.03));
    let start = State::at(DVec3::Z * 0.2)
        .with_rotation_vector(DVec3::new(0.3, 0.2, 0.0))
        .with_linear_velocity(DVec3::new(0.5, 0.1, 0.0))
        .with_angular_momentum(DVec3::new(0.004, 0.01, 0.02));
    let laws = (
        FlatGround::level(4e3, 5.0),
        SmoothCoulomb {
            coefficient: 0.3,
            slip_speed: 1e-2,
        },
    );
    let apart = |seconds: f64, time_step: f64| {
        let egg = Ellipsoid::loaded(DVec3::splat(0.1), distribution);
        let ball = Sphere::loaded(0.1, distribution);
        let by = EnergyMomentum { time_step };
        let implicit = difference(
            &end(egg, laws, by, &start, seconds),
            &end(ball, laws, by, &start, seconds),
        );
        let by = StrangSplitting { time_step };
        let explicit = difference(
            &end(egg, laws, by, &start, seconds),
            &end(ball, laws, by, &start, seconds),
        );
        (implicit, explicit)
    };
    let (implicit, explicit) = apart(1.0, 1e-3);
    // The same forces at the same points, except for rounding.
    assert!(explicit < 1e-11, "{explicit:e}");
    assert!(implicit < 1e-7, "{implicit:e}");
}

/// At rest on its side a body with radius of curvature ρ below and its centre of mass at height c
/// rocks at `ω² = m g (ρ - c)/I` where it slides, and at `m g (ρ - c)/(I + m c²)` where it rolls;
/// an ellipse has `ρ = a²/c` at the end of its semi-axis c.
#[test]
fn an_ellipsoid_rocks_at_the_rate_of_its_curvature() {
    let (mass, a, c) = (0.5, 0.15, 0.1);
    let egg = Ellipsoid::solid(mass, DVec3::new(a, 0.1, c));
    let moment = egg.inertia().y_axis.y;
    let push = mass * GRAVITY * (a * a / c - c);
    let ground = FlatGround::level(1e5, 0.0);
    let sink = mass * GRAVITY / 1e5;
    let amplitude = 1e-3;
    let start = State::at(DVec3::Z * (c - sink)).with_rotation_vector(DVec3::Y * amplitude);
    let rocked = |end: &State| 2.0 * end.orientation.y / amplitude;
    let by = EnergyMomentum { time_step: 1e-4 };
    let period = |moment: f64| TAU / (push / moment).sqrt();
    let slides = end(egg, (ground, Frictionless), by, &start, period(moment));
    // The depth takes sink/(ρ - c) = 6e-4 of the lever arm. The effect of the rotation is of second
    // order in the amplitude and in the phase of one period.
    assert!((rocked(&slides) - 1.0).abs() < 1e-4, "{}", rocked(&slides));
    let slides = end(
        egg,
        (ground, Frictionless),
        by,
        &start,
        period(moment) / 4.0,
    );
    assert!(rocked(&slides).abs() < 2e-3, "{}", rocked(&slides));
    let grip = Coulomb {
        coefficient: 1.0,
        slip_speed: 1e-8,
    };
    let rolling = moment + mass * c * c;
    let rolls = end(egg, (ground, grip), by, &start, period(rolling) / 4.0);
    assert!(rocked(&rolls).abs() < 2e-3, "{}", rocked(&rolls));
}

#[test]
fn the_orders_are_those_of_fixed_contacts() {
    let egg = Ellipsoid::loaded(
        DVec3::new(0.15, 0.1, 0.08),
        MassProperties::ellipsoid(0.5, DVec3::new(0.15, 0.1, 0.08))
            .unwrap()
            .at(DVec3::new(0.02, 0.0, 0.01)),
    );
    let laws = (
        FlatGround::level(500.0, 0.5),
        SmoothCoulomb {
            coefficient: 0.3,
            slip_speed: 0.3,
        },
    );
    // In touch all the time: nothing is made or lost.
    let start = State::at(DVec3::Z * 0.07)
        .with_rotation_vector(DVec3::new(0.2, 0.1, 0.0))
        .with_linear_velocity(DVec3::new(0.2, 0.1, 0.0))
        .with_angular_momentum(DVec3::new(0.002, 0.003, 0.004));
    let truth = end(egg, laws, Rk4 { time_step: 1e-5 }, &start, 0.1);
    let error = |end: State| difference(&end, &truth);
    let second = |time_step: f64| {
        [
            error(end(egg, laws, EnergyMomentum { time_step }, &start, 0.1)),
            error(end(egg, laws, StrangSplitting { time_step }, &start, 0.1)),
        ]
    };
    let (coarse, fine) = (second(1e-3), second(5e-4));
    for (coarse, fine) in coarse.into_iter().zip(fine) {
        let found = order(coarse, fine);
        assert!((found - 2.0).abs() < 0.1, "{found} {coarse:e} {fine:e}");
    }
    let fourth = |time_step| error(end(egg, laws, Rk4 { time_step }, &start, 0.1));
    let (coarse, fine) = (fourth(4e-3), fourth(2e-3));
    let found = order(coarse, fine);
    assert!((found - 4.0).abs() < 0.4, "{found} {coarse:e} {fine:e}");
}

#[test]
fn an_egg_keeps_its_energy_where_nothing_takes_it() {
    let egg = Ellipsoid::solid(0.5, DVec3::new(0.15, 0.1, 0.08));
    let lost = |time_step: f64| {
        let stepper = Stepper::new(egg)
            .and_then(|stepper| stepper.with_gravity(UniformGravity::down(GRAVITY)))
            .and_then(|stepper| stepper.with_ground(FlatGround::level(2e3, 0.0)))
            .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
            .unwrap();
        let mut state = State::at(DVec3::Z * 0.2)
            .with_rotation_vector(DVec3::new(0.2, 0.5, 0.0))
            .with_angular_momentum(DVec3::new(0.004, 0.01, 0.02));
        let first = stepper.energy(&state).total();
        let mut before = first;
        for _ in 0..1000 {
            stepper.step(&mut state).unwrap();
            let after = stepper.energy(&state).total();
            assert!(after <= before, "{after} {before}");
            before = after;
        }
        (first - before) / first
    };
    // Arm and depth belong together, so that only rounding is taken.
    let lost = lost(1e-3);
    assert!(lost < 1e-9, "{lost:e}");
}

/// An egg that is dropped into a bowl or onto waves, off the middle. Its force has a potential only
/// if the ground's normal at its contact is that for which the contact was found.
fn egg_on<S: Shape + Copy, I: Integrator>(
    shape: S,
    dampers: bool,
    integrator: I,
    seconds: f64,
) -> (State, f64) {
    let (damping, coefficient) = if dampers { (5.0, 0.3) } else { (0.0, 0.0) };
    let stepper = Stepper::builder(Ellipsoid::solid(0.5, DVec3::new(0.06, 0.05, 0.04)))
        .gravity(UniformGravity::down(GRAVITY))
        .ground(Ground {
            law: SpringDamper {
                stiffness: 4e3,
                damping,
            },
            shape,
        })
        .friction(SmoothCoulomb {
            coefficient,
            slip_speed: 1e-2,
        })
        .integrator(integrator)
        .build()
        .unwrap();
    let mut state = State::at(DVec3::new(0.05, 0.02, 0.09))
        .with_rotation_vector(DVec3::new(0.3, 0.5, 0.1))
        .with_angular_momentum(DVec3::new(0.0, 2e-3, 0.0));
    let before = stepper.energy(&state).total();
    stepper.advance(&mut state, seconds).unwrap();
    (state, (stepper.energy(&state).total() - before) / before)
}

fn bowl(radius: f64) -> Terrain<Bowl> {
    Terrain::of(Bowl {
        curvatures: [1.0 / radius, 0.7 / radius],
    })
}

#[test]
fn on_curved_ground_an_egg_keeps_its_energy_with_every_method() {
    let mut kept = Vec::new();
    for radius in [0.3, 1.0, 5.0] {
        let (_, explicit) = egg_on(bowl(radius), false, DormandPrince54::new(1e-9), 1.0);
        let (_, implicit) = egg_on(bowl(radius), false, EnergyMomentum { time_step: 1e-3 }, 1.0);
        kept.extend([explicit, implicit]);
        let waves = Terrain::of(Waves {
            amplitude: 0.05 * radius,
            length: radius * TAU * 0.05_f64.sqrt(),
        });
        let (_, explicit) = egg_on(waves, false, DormandPrince54::new(1e-9), 1.0);
        let (_, implicit) = egg_on(waves, false, EnergyMomentum { time_step: 1e-3 }, 1.0);
        kept.extend([explicit, implicit]);
        // Hills of 0.3, 1 and 3 times the curvature of the body.
        let hill = bowl(-0.09 / radius.min(3.0));
        let (_, explicit) = egg_on(hill, false, DormandPrince54::new(1e-9), 0.3);
        let (_, implicit) = egg_on(hill, false, EnergyMomentum { time_step: 1e-3 }, 0.3);
        kept.extend([explicit, implicit]);
    }
    println!("{kept:?}");
    assert!(kept.iter().all(|change| change.abs() < 2e-8), "{kept:?}");
}

#[test]
fn on_curved_ground_the_motion_of_an_egg_is_that_of_all_methods_to_order_two() {
    for radius in [0.3, 1.0, 5.0] {
        let (truth, _) = egg_on(bowl(radius), true, DormandPrince54::new(1e-10), 0.5);
        let error = |time_step| {
            let (state, _) = egg_on(bowl(radius), true, EnergyMomentum { time_step }, 0.5);
            (state.position - truth.position).length()
        };
        let (coarse, fine) = (error(1e-3), error(2.5e-4));
        println!("{radius} m: {coarse:e} {fine:e} m");
        // The step is a quarter.
        assert!(
            (10.0..25.0).contains(&(coarse / fine)),
            "{coarse:e} {fine:e}"
        );
        assert!(fine < 1e-5, "{fine:e}");
    }
}

/// Of 384,000 such steps the largest loss is 1e-6 of the energy. With the contact for the normal
/// under the middle, 1564 lost more than 1e-3, up to 0.18: none in 14,400 rejects a share of 3e-4
/// with 99 %.
#[test]
fn on_curved_ground_of_any_hardness_the_bounces_of_an_egg_keep_their_energy() {
    let time_step = 1.0 / 240.0;
    let coordinates = |most: f64| [-most..most, -most..most, -most..most];
    let scenes = (
        [0.03..0.08_f64, 0.03..0.08, 0.03..0.08],
        (log_uniform(0.1, 300.0), log_uniform(0.16, 8.0)),
        coordinates(2.0),
        coordinates(0.05),
        coordinates(1.0),
    );
    let mut runner = TestRunner::deterministic();
    for _ in 0..60 {
        let (axes, (hardness, radius), pose, place, velocity) =
            scenes.new_tree(&mut runner).unwrap().current();
        let stepper = Stepper::builder(Ellipsoid::solid(0.5, DVec3::from(axes)))
            .gravity(UniformGravity::down(GRAVITY))
            .ground(Ground {
                law: SpringDamper {
                    stiffness: 0.5 * (hardness / time_step).powi(2),
                    damping: 0.0,
                },
                shape: bowl(radius),
            })
            .integrator(EnergyMomentum { time_step })
            .build()
            .unwrap();
        let start = State::at(DVec3::new(place[0], place[1], 0.15))
            .with_rotation_vector(DVec3::from(pose))
            .with_linear_velocity(DVec3::new(velocity[0], velocity[1], -1.0));
        let mut session = stepper.session(start);
        let mut before = session.energy().total();
        for _ in 0..240 {
            session.step().unwrap();
            let after = session.energy().total();
            assert!(before - after <= 1e-5 * before, "{before} {after}");
            before = after;
        }
    }
}

/// A user's smooth body: a ball that is defined by its support point only, correctly or not.
struct Ball<const COUNT: usize = 1>([ContactPoint; COUNT], f64);

impl<const COUNT: usize> RigidPointBody for Ball<COUNT> {
    fn mass(&self) -> f64 {
        0.5
    }
    fn inertia(&self) -> DMat3 {
        MassProperties::ball(0.5, 0.1).unwrap().inertia
    }
    fn contacts(&self) -> &[ContactPoint] {
        &self.0
    }
    fn is_smooth(&self) -> bool {
        true
    }
    fn support_point(&self, towards: DVec3) -> DVec3 {
        towards * self.1
    }
}

#[test]
fn a_support_that_is_not_the_farthest_place_is_caught() {
    let contact = ContactPoint {
        position: DVec3::ZERO,
        radius: 0.1,
    };
    let check = |support| check_body(&Ball([contact], support), CheckPlan::default());
    check(0.1).unwrap();
    for wrong in [-0.1, 0.2, f64::NAN] {
        let violation = check(wrong).unwrap_err();
        let told = if wrong.is_nan() {
            Requirement::Finite
        } else {
            Requirement::Support
        };
        assert_eq!(violation.requirement, told, "{violation}");
    }
    let two = check_body(&Ball([contact; 2], 0.1), CheckPlan::default()).unwrap_err();
    assert_eq!(two.requirement, Requirement::Support, "{two}");
}

#[test]
fn a_smooth_body_of_a_user_may_be_a_ball() {
    let contact = ContactPoint {
        position: DVec3::ZERO,
        radius: 0.1,
    };
    let ball = Ball([contact], 0.1);
    let start = State::at(DVec3::Z * 0.2).with_linear_velocity(DVec3::X);
    let laws = (
        FlatGround::level(4e3, 5.0),
        SmoothCoulomb {
            coefficient: 0.3,
            slip_speed: 1e-2,
        },
    );
    let by = Rk4 { time_step: 1e-3 };
    let apart = difference(
        &end(&ball as &dyn RigidPointBody, laws, by, &start, 1.0),
        &end(Sphere::solid(0.5, 0.1), laws, by, &start, 1.0),
    );
    // Both round differently at each evaluation of a contact, and bounces amplify it, like a start
    // that is shifted by a few units in its last place. Ten times that, for 4000 evaluations.
    let rounding = (1..=8).map(|units| {
        let height = 0.2 * (1.0 + f64::from(units) * f64::EPSILON);
        let moved = State::at(DVec3::Z * height).with_linear_velocity(DVec3::X);
        let [there, here] =
            [moved, start].map(|start| end(Sphere::solid(0.5, 0.1), laws, by, &start, 1.0));
        difference(&there, &here)
    });
    let rounding = rounding.fold(0.0, f64::max);
    assert!(apart < 10.0 * rounding, "{apart:e}, {rounding:e}");
    assert!(rounding < 1e-11, "{rounding:e}");
}

/// A hoop with a smooth rim, whose one contact moves along it: a user's body.
struct Hoop([ContactPoint; 1], f64);

impl RigidPointBody for Hoop {
    fn mass(&self) -> f64 {
        1.0
    }
    fn inertia(&self) -> DMat3 {
        DMat3::from_diagonal(DVec3::new(1.0, 0.5, 0.5) * (self.1 * self.1))
    }
    fn contacts(&self) -> &[ContactPoint] {
        &self.0
    }
    fn bounding_radius(&self) -> f64 {
        self.1
    }
    fn is_smooth(&self) -> bool {
        true
    }
    fn support_point(&self, towards: DVec3) -> DVec3 {
        DVec3::new(0.0, towards.y, towards.z).normalize_or_zero() * self.1
    }
}

/// Iterations of a step in stick on average, at most.
const MOST_ITERATIONS: f64 = 5.0;

/// The same for a body that spins flat on several points. They hinder each other while it comes to
/// rest, and which of them stick changes from step to step.
const MOST_ITERATIONS_FLAT: f64 = 7.0;

/// A body that rolls, spins or leans, and the stiffness of the ground at each of its contacts, N/m.
struct Sticking {
    name: &'static str,
    body: Box<dyn RigidPointBody>,
    stiffness: f64,
    start: State,
}

/// A touching state, rotated by an angle (rad) about y, with this angular velocity (rad/s), in
/// which the lowest point is at rest.
fn rolling(body: &dyn RigidPointBody, lean: f64, spin: DVec3) -> State {
    let orientation = DQuat::from_rotation_y(lean);
    let down = orientation.inverse() * -DVec3::Z;
    let lowest = if body.is_smooth() {
        body.support_point(down)
    } else if let [rim, ..] = body.rims() {
        rim.support_point(down)
    } else {
        let depth = |contact: &&ContactPoint| contact.position.dot(down) + contact.radius;
        let lowest = (body.contacts().iter()).max_by(|a, b| depth(a).total_cmp(&depth(b)));
        lowest.map_or(DVec3::ZERO, |contact| {
            contact.position + down * contact.radius
        })
    };
    let arm = orientation * lowest;
    let axes = DMat3::from_quat(orientation);
    let inertia = axes * body.inertia() * axes.transpose();
    State::at(DVec3::Z * -arm.z)
        .with_orientation(orientation)
        .with_linear_velocity(-spin.cross(arm))
        .with_angular_momentum(inertia * spin)
}

fn sticking() -> Vec<Sticking> {
    let mut scenes: Vec<Sticking> = Vec::new();
    let mut add = |name, body: Box<dyn RigidPointBody>, stiffness, lean, spin: [f64; 3]| {
        let start = rolling(&*body, lean, DVec3::from(spin));
        scenes.push(Sticking {
            name,
            body,
            stiffness,
            start,
        });
    };
    let hoop = || Box::new(Hoop([ContactPoint::default()], 0.3));
    let egg = || Box::new(Ellipsoid::solid(0.4, DVec3::new(0.12, 0.09, 0.07)));
    add("hoop, rolls", hoop(), 8e3, 0.1, [5.0, 0.0, 0.0]);
    add("hoop, spins", hoop(), 8e3, 0.2, [0.0, 0.0, 7.0]);
    add("hoop, leans", hoop(), 8e3, 0.4, [0.0, 0.0, 0.0]);
    add("egg, rolls", egg(), 5e3, 0.2, [0.0, 3.0, 0.0]);
    add("egg, spins", egg(), 5e3, 0.05, [0.2, 0.0, 9.0]);
    add("egg, leans", egg(), 5e3, 0.7, [0.0, 0.0, 0.0]);
    let ball = || Box::new(Sphere::solid(0.7, 0.06));
    add("ball, rolls", ball(), 5e3, 0.0, [4.0, 9.0, 0.0]);
    add("ball, spins", ball(), 5e3, 0.0, [4.0, 9.0, 30.0]);
    add(
        "coin, rolls",
        Box::new(Coin::ring(0.5, 0.3)),
        1e3,
        0.05,
        [4.0, 0.0, 0.0],
    );
    let disc = || Box::new(Disc::ring(0.5, 0.3, 120));
    add("disc, rolls", disc(), 1e3, 0.0, [4.0, 0.0, 0.0]);
    add("disc, spins", disc(), 1e3, 0.1, [0.2, 0.0, 5.0]);
    add(
        "cuboid, leans",
        Box::new(Cuboid::solid(0.8, DVec3::new(0.1, 0.15, 0.2))),
        8e3,
        0.3,
        [0.0, 0.0, 0.5],
    );
    add(
        "capsule, rolls",
        Box::new(Capsule::solid(0.8, 0.05, 0.2)),
        8e3,
        1.5,
        [8.0, 0.0, 0.0],
    );
    add(
        "cone, leans",
        Box::new(Cone::solid(0.8, 0.1, 0.2)),
        1e3,
        1.0,
        [0.0, 0.5, 1.0],
    );
    scenes
}

/// Position after 0.2 s, and the iterations of a step on average.
fn stuck(scene: &Sticking, slip_speed: f64, time_step: f64) -> (DVec3, f64) {
    let friction = Coulomb {
        coefficient: 0.7,
        slip_speed,
    };
    let ground = FlatGround::level(scene.stiffness, scene.stiffness * 5e-4);
    let stepper = Stepper::new(&*scene.body)
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(GRAVITY)))
        .and_then(|stepper| stepper.with_ground(ground))
        .and_then(|stepper| stepper.with_friction(friction))
        .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
        .unwrap();
    let (mut state, mut iterations, mut fallbacks) = (scene.start, 0, 0);
    let steps = kit::whole(0.2 / time_step);
    for _ in 0..steps {
        let report = stepper.step(&mut state).unwrap();
        iterations += report.iterations;
        fallbacks += usize::from(report.fallback);
    }
    // On a rim the reversals of friction begin, end and join in single steps, and so do the points
    // that stick under a body that spins flat.
    let is_several = scene.body.contacts().len() > 1;
    let most = if is_several || !scene.body.rims().is_empty() {
        steps / 100
    } else {
        0
    };
    let name = scene.name;
    assert!(
        fallbacks <= most,
        "{name}, {slip_speed:e} m/s: {fallbacks} of {steps} divided"
    );
    (state.position, f64::from(iterations) / steps as f64)
}

#[test]
fn stick_is_of_order_two_at_any_slip_speed_and_takes_few_iterations() {
    for scene in sticking() {
        for slip_speed in [1e-6, 1e-8, 1e-10, 1e-12] {
            let steps = [1e-3, 5e-4, 1.25e-4];
            let [coarse, fine, truth] = steps.map(|step| stuck(&scene, slip_speed, step));
            let name = scene.name;
            let iterations = coarse.1.max(fine.1);
            assert!(
                iterations <= MOST_ITERATIONS,
                "{name}, {slip_speed:e} m/s: {iterations} iterations"
            );
            let error = |end: DVec3| (end - truth.0).length();
            // With the truth at an eighth of the step, order 2 gives (64 - 1)/(16 - 1): 2.07. Terms
            // of the next order are worth up to a quarter at these steps.
            let found = order(error(coarse.0), error(fine.0));
            assert!(found > 1.75, "{name}, {slip_speed:e} m/s: order {found}");
        }
    }
}

/// Bodies that roll, spin and lean on one or several contacts, or on one or two round rims, and
/// those that spin flat on several points. Neither the first trial of a step nor its first
/// derivative was chosen on these scenes.
fn sticking_elsewhere() -> [Vec<Sticking>; 2] {
    let (mut scenes, mut flat) = (Vec::new(), Vec::new());
    let sticking = |name, body: Box<dyn RigidPointBody>, stiffness, lean, spin: [f64; 3]| {
        let start = rolling(&*body, lean, DVec3::from(spin));
        Sticking {
            name,
            body,
            stiffness,
            start,
        }
    };
    let mut add = |name, body, stiffness, lean, spin| {
        scenes.push(sticking(name, body, stiffness, lean, spin));
    };
    let brick = || Box::new(Cuboid::solid(2.1, DVec3::new(0.24, 0.11, 0.07)));
    add("brick on an edge", brick(), 3e4, 0.55, [0.0, 0.4, 0.0]);
    add("brick, edge tilts", brick(), 3e4, 0.25, [0.1, 0.0, 0.8]);
    let pill = || Box::new(Capsule::solid(0.03, 0.012, 0.04));
    add("pill, rolls", pill(), 500.0, 1.45, [6.0, 0.0, 0.0]);
    add("pill, leans", pill(), 500.0, 0.5, [0.0, 0.5, 2.0]);
    let plate = || Box::new(Disc::solid(0.9, 0.14, 90));
    add("plate, leans", plate(), 2e3, 0.35, [0.0, 0.0, 0.0]);
    add("plate spins", plate(), 2e3, 0.6, [0.0, 0.0, 2.0]);
    add(
        "plate on its face",
        plate(),
        2e3,
        FRAC_PI_2,
        [0.0, 0.0, 9.0],
    );
    add("plate, rolls", plate(), 2e3, 0.0, [7.0, 0.0, 0.0]);
    let puck = || Box::new(ThickDisc::solid(0.6, 0.09, 0.03, 72));
    add("puck, leans", puck(), 2e3, 0.5, [0.0, 0.0, 0.0]);
    add("puck spins", puck(), 2e3, 0.8, [0.0, 0.0, 3.0]);
    add("puck on its face", puck(), 2e3, FRAC_PI_2, [0.0, 0.0, 7.0]);
    add("puck, rolls", puck(), 2e3, 0.0, [5.0, 0.0, 0.0]);
    let pebble = || Box::new(Ellipsoid::solid(0.15, DVec3::new(0.04, 0.03, 0.015)));
    add("pebble, leans", pebble(), 4e3, 1.1, [0.0, 0.0, 0.0]);
    add("pebble, spins", pebble(), 4e3, 0.1, [0.5, 0.0, 14.0]);
    let mut add_flat = |name, body, stiffness, lean, spin: f64| {
        flat.push(sticking(name, body, stiffness, lean, [0.0, 0.0, spin]));
    };
    add_flat("brick on its face", brick(), 3e4, 0.0, 4.0);
    add_flat("pill on its side", pill(), 500.0, FRAC_PI_2, 5.0);
    [scenes, flat]
}

#[test]
fn a_step_in_stick_takes_few_iterations_on_contacts_that_pull_against_each_other() {
    let limits = [MOST_ITERATIONS, MOST_ITERATIONS_FLAT];
    for (scenes, most) in sticking_elsewhere().iter().zip(limits) {
        for scene in scenes {
            for slip_speed in [3e-7, 3e-9, 3e-11, 1e-12] {
                for time_step in [1e-3, 4e-4] {
                    let (_, iterations) = stuck(scene, slip_speed, time_step);
                    let name = scene.name;
                    assert!(
                        iterations <= most,
                        "{name}, {slip_speed:e} m/s, {time_step} s: {iterations} iterations"
                    );
                }
            }
        }
    }
}

#[test]
fn a_block_on_a_slope_sticks_at_any_slip_speed() {
    let (sin, cos) = 20_f64.to_radians().sin_cos();
    let gravity = UniformGravity {
        acceleration: DVec3::new(sin, 0.0, -cos) * GRAVITY,
    };
    for slip_speed in [1e-10, 1e-12, 1e-14, 1e-16] {
        let friction = Coulomb {
            coefficient: 0.8,
            slip_speed,
        };
        let stepper = Stepper::new(Cuboid::solid(1.0, DVec3::splat(0.1)))
            .and_then(|stepper| stepper.with_gravity(gravity))
            .and_then(|stepper| stepper.with_ground(FlatGround::level(1e5, 50.0)))
            .and_then(|stepper| stepper.with_friction(friction))
            .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step: 1e-2 }))
            .unwrap();
        let mut state = State::at(DVec3::Z * 0.05);
        stepper.advance(&mut state, 0.5).unwrap();
        let settled = state.position;
        stepper.advance(&mut state, 0.5).unwrap();
        // What is left after half a second is the rocking of the block on its springs: a fall of
        // 0.1 mm at first, damped within 0.1 s. A block that slides goes 5 mm and more.
        let moved = (state.position - settled).length();
        assert!(moved < 1e-6, "{slip_speed:e} m/s: {moved:e} m");
    }
}

/// A body of single precision that falls, touches and slides, in one session or with a new
/// workspace in each step. Returns the bits of its last state.
fn bits_after(
    body: &impl RigidPointBody<f32>,
    start: &State<f32>,
    keeps_workspace: bool,
) -> [u32; 13] {
    let stepper = Stepper::new(body)
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(9.8)))
        .and_then(|stepper| stepper.with_ground(FlatGround::level(3e3, 2.0)))
        .and_then(|stepper| {
            stepper.with_friction(Coulomb {
                coefficient: 0.4,
                slip_speed: 1e-3,
            })
        })
        .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step: 2e-3 }))
        .unwrap();
    let (mut state, mut session) = (*start, stepper.session(*start));
    for _ in 0..400 {
        if keeps_workspace {
            session.step().unwrap();
            state = *session.state();
        } else {
            stepper.step(&mut state).unwrap();
        }
    }
    let (x, v, q, l) = (
        state.position.to_array(),
        state.linear_velocity.to_array(),
        state.orientation.to_array(),
        state.angular_momentum.to_array(),
    );
    let numbers: Vec<u32> = [&x[..], &v, &q, &l]
        .concat()
        .iter()
        .map(|x| x.to_bits())
        .collect();
    numbers.try_into().unwrap()
}

/// The matrix of a smooth body in single precision has a term of the motion over the surface. It
/// once used the force of an earlier step where a contact was near, but not felt.
#[test]
fn a_kept_workspace_changes_no_bit_of_a_smooth_body_in_single_precision() {
    let egg = single::Ellipsoid::solid(1.0, Vec3::new(0.3, 0.2, 0.25));
    let capsule = single::Capsule::solid(0.5, 0.05, 0.2);
    let mut starts = Vec::new();
    for number in 0..12_u8 {
        let t = f32::from(number);
        starts.push(
            State::<f32>::at(Vec3::new(0.0, 0.0, 0.3 + 0.02 * t))
                .with_linear_velocity(Vec3::new(0.3 * t.sin(), 0.2, -0.5))
                .with_rotation_vector(Vec3::new(0.3 * t, 0.7, -0.1 * t))
                .with_angular_momentum(Vec3::new(0.02, 0.01 * t.cos(), 0.03)),
        );
    }
    for start in &starts {
        assert_eq!(
            bits_after(&egg, start, true),
            bits_after(&egg, start, false)
        );
        assert_eq!(
            bits_after(&capsule, start, true),
            bits_after(&capsule, start, false)
        );
    }
}
