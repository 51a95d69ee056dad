//! Conveyors and turntables: closed forms, the frame of the belt, the work of the drive, and that
//! the energy minus that work never increases.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]
// Exact zeros and equal bits are compared. A random scene is the same in both precisions.
#![allow(clippy::float_cmp, clippy::cast_possible_truncation)]

use core::f64::consts::PI;

use crate::kit::erased::Stepper;
use crate::kit::{self, directions, log_uniform};
use proptest::prelude::*;
use tumble::contract::{CheckPlan, GroundRange, Requirement, check_ground};
use tumble::error::Rule;
use tumble::glam::{DVec3, Vec3};
use tumble::{
    Barriers, Bowl, Capsule, Coin, Coulomb, Cuboid, Disc, Dissipation, DormandPrince54, Dynamics,
    Ellipsoid, EnergyMomentum, FlatGround, Ground, GroundBounds, GroundMotion, Integrator, Ledger,
    MeanForce, Motion, MovingGround, Plane, PointMass, RigidPointBody, Rod, Scene, SceneError,
    SlidingFriction, SolidCoin, Sphere, SpringDamper, SpringDamperGround, State, Surface, Terrain,
    UniformGravity, Viscous, WithResistance,
};

const G: f64 = 9.8;

/// Friction whose slip speed is above what explicit methods need at the steps of these tests: a
/// slip decays within `slip_speed/(μ g)`, 10 µs for μ = 1.
fn coulomb(coefficient: f64) -> Coulomb {
    Coulomb {
        coefficient,
        slip_speed: 1e-4,
    }
}

/// Level ground in which a point of this weight (N) sinks by 10 µm, with a damping ratio of 1.
fn floor(mass: f64, points: f64) -> FlatGround {
    let stiffness = mass * G / points / 1e-5;
    FlatGround::level(stiffness, 2.0 * (stiffness * mass / points).sqrt())
}

/// A block on a belt slides with the acceleration μ g until it has the belt's speed u, over the
/// distance u²/(2 μ g), and then rides. The belt's force μ m g moves at u for the time u/(μ g), so
/// its work is m u²: half of it is kinetic energy, half is heat.
#[test]
fn a_block_on_a_belt_slides_and_then_rides() {
    let (mass, mu, u) = (0.4, 0.3, 1.2);
    kit::each_method!(1e-5, |integrator, name| {
        let stepper = Stepper::builder(PointMass::new(mass))
            .gravity(UniformGravity::down(G))
            .ground(MovingGround::conveyor(floor(mass, 1.0), DVec3::X * u))
            .friction(coulomb(mu))
            .integrator(integrator)
            .build()
            .unwrap();
        let mut state = State::at(DVec3::Z * -1e-5);
        let mut ledger = Ledger::new();
        let slides = u / (mu * G);
        stepper.run(&mut state, slides / 2.0, &mut ledger).unwrap();
        // The slip speed ε of the law makes the slide longer: the speed lags by ε ln 2 here.
        let expected = mu * G * slides / 2.0 - 1e-4 * 2.0_f64.ln();
        assert!(
            (state.linear_velocity.x / expected - 1.0).abs() < 1e-4,
            "{name}: {}",
            state.linear_velocity.x
        );
        stepper.run(&mut state, slides, &mut ledger).unwrap();
        assert!(
            (state.linear_velocity.x - u).abs() < 1e-4,
            "{name}: {}",
            state.linear_velocity.x
        );
        // The integral of that lag over the slide is ε u/(μ g).
        let way = u * u / (2.0 * mu * G) + u * slides / 2.0 - 1e-4 * slides;
        assert!(
            (state.position.x / way - 1.0).abs() < 1e-4,
            "{name}: {} m",
            state.position.x
        );
        let [drive, heat] = [ledger.work().drive, -ledger.work().friction];
        let work = mass * u * u;
        assert!((drive / work - 1.0).abs() < 1e-3, "{name}: {drive} J");
        assert!((heat / (work / 2.0) - 1.0).abs() < 1e-3, "{name}: {heat} J");
    });
}

/// Seen from the belt, the ground is at rest and the body has the velocity minus that of the belt.
#[test]
fn a_belt_is_a_ground_at_rest_in_another_frame() {
    let belt = DVec3::new(0.7, -0.4, 0.0);
    let body = Cuboid::solid(0.2, DVec3::new(0.1, 0.06, 0.04));
    let start = State::at(DVec3::new(0.1, 0.2, 0.05))
        .with_rotation_vector(DVec3::new(0.3, 0.5, -0.2))
        .with_linear_velocity(DVec3::new(1.0, 0.5, -0.3))
        .with_angular_momentum(DVec3::new(2e-4, -3e-4, 5e-4));
    kit::each_method!(1e-4, |integrator, name| {
        let plain = Stepper::builder(body)
            .gravity(UniformGravity::down(G))
            .ground(FlatGround::level(2e4, 5.0))
            .friction(coulomb(0.4))
            .integrator(integrator)
            .build()
            .unwrap();
        let moving = plain
            .with_ground(MovingGround::conveyor(*plain.scene().ground(), belt))
            .unwrap();
        let seconds = 0.2;
        let mut still = start;
        plain.advance(&mut still, seconds).unwrap();
        let mut carried = start.with_linear_velocity(start.linear_velocity + belt);
        moving.advance(&mut carried, seconds).unwrap();
        let off = carried.position - still.position - belt * seconds;
        assert!(off.length() < 1e-9, "{name}: {off}");
        let off = carried.linear_velocity - still.linear_velocity - belt;
        assert!(off.length() < 1e-7, "{name}: {off}");
        let turned = kit::angle_between(carried.orientation, still.orientation);
        assert!(turned < 1e-7, "{name}: {turned:e}");
    });
}

/// The same for round rims, smooth bodies and balls of a body, by the implicit method and by one
/// that looks for reversals of the slip.
#[test]
fn rims_and_smooth_bodies_feel_the_belt() {
    fn compared<B: RigidPointBody + Copy, I: Integrator + Copy>(
        name: &str,
        body: B,
        integrator: I,
    ) {
        let belt = DVec3::new(0.7, -0.4, 0.0);
        let plain = Stepper::builder(body)
            .gravity(UniformGravity::down(G))
            .ground(FlatGround::level(2e3, 2.0))
            .friction(coulomb(0.4))
            .integrator(integrator)
            .build()
            .unwrap();
        let moving = plain
            .with_ground(MovingGround::conveyor(*plain.scene().ground(), belt))
            .unwrap();
        let start = State::at(DVec3::Z * 0.045)
            .with_rotation_vector(DVec3::new(0.3, 0.9, -0.2))
            .with_linear_velocity(DVec3::new(0.4, 0.5, -0.3))
            .with_angular_momentum(DVec3::new(2e-4, -3e-4, 5e-4));
        let (mut still, seconds) = (start, 0.1);
        plain.advance(&mut still, seconds).unwrap();
        let falls = start.linear_velocity.z - G * seconds;
        let lifted = still.linear_velocity.z - falls;
        assert!(lifted > 0.01, "{name}: it does not touch");
        let mut carried = start.with_linear_velocity(start.linear_velocity + belt);
        moving.advance(&mut carried, seconds).unwrap();
        let off = carried.position - still.position - belt * seconds;
        assert!(off.length() < 1e-8, "{name}: {off}");
        let turned = kit::angle_between(carried.orientation, still.orientation);
        assert!(turned < 1e-6, "{name}: {turned:e}");
    }
    fn each<B: RigidPointBody + Copy>(name: &str, body: B) {
        compared(name, body, EnergyMomentum { time_step: 1e-4 });
        compared(name, body, DormandPrince54::new(1e-10));
    }
    each("disc", Disc::solid(0.2, 0.05, 120));
    each(
        "ellipsoid",
        Ellipsoid::solid(0.2, DVec3::new(0.06, 0.05, 0.04)),
    );
    each("capsule", Capsule::solid(0.2, 0.03, 0.08));
}

/// Ground that only says that it is below a plane, so that its loads are those of any ground.
#[derive(Clone, Copy)]
struct Below(FlatGround);

impl SpringDamperGround for Below {
    fn surface(&self, point: DVec3) -> Surface {
        self.0.surface(point)
    }
    fn spring_force(&self, depth: f64) -> f64 {
        self.0.spring_force(depth)
    }
    fn spring_energy(&self, depth: f64) -> f64 {
        self.0.spring_energy(depth)
    }
    fn normal_force(&self, depth: f64, closing_speed: f64) -> f64 {
        self.0.normal_force(depth, closing_speed)
    }
    fn mean_force(&self, start: f64, end: f64, seconds: f64) -> MeanForce {
        self.0.mean_force(start, end, seconds)
    }
    fn bounds(&self) -> GroundBounds {
        GroundBounds::Below(Plane::level(0.0))
    }
    fn is_trusted(&self) -> bool {
        true
    }
}

/// Motions of level ground: at rest, a belt, a turntable, and both at once.
fn level_motions() -> [GroundMotion; 4] {
    let belt = GroundMotion::translation(DVec3::new(0.7, -0.4, 0.0));
    let table = GroundMotion::rotation(DVec3::new(0.3, -0.2, 0.0), DVec3::Z * 3.0);
    let both = GroundMotion {
        velocity: table.velocity + belt.velocity,
        ..table
    };
    [GroundMotion::translation(DVec3::ZERO), belt, table, both]
}

proptest! {
    #![proptest_config(kit::cases(1000))]

    /// The hub may be anywhere on the axis, above or below the table.
    #[test]
    fn a_turntable_on_any_plane_is_valid_wherever_its_hub_is(
        [normal, aside] in [directions(), directions()],
        height in -10.0..10.0_f64,
        hub in -1e3..1e3_f64,
        rate in log_uniform(1e-6, 1e3),
    ) {
        let plane = Plane { normal, height };
        let motion = GroundMotion::rotation(normal * hub + aside, normal * rate);
        let ground = MovingGround { ground: FlatGround::level(1e4, 1.0).on(plane), motion };
        prop_assert_eq!(SpringDamperGround::<f64>::check(&ground), Ok(()));
        // The axis is where it was.
        let still = motion.velocity_at(aside + normal * hub).length();
        prop_assert!(still <= 1e-12 * rate * (hub.abs() + 2.0), "{}", still);
    }
}

/// Force and torque of the contacts of a body on level ground that moves, by the definition: the
/// material below a contact at `p` moves with `V + Ω × p`. Also the force that rounding can cause.
fn load_by_definition<D: Dynamics>(
    scene: &D,
    (ground, friction, material): (&FlatGround, &Coulomb, &GroundMotion),
    motion: &Motion,
) -> ([DVec3; 2], f64) {
    let (mut load, mut forces) = ([DVec3::ZERO; 2], 0.0);
    for point in scene.body().contacts() {
        let arm = motion.axes.to_world(point.position);
        let place = motion.position + arm;
        let carried = material.velocity + material.angular_velocity.cross(place);
        let velocity = motion.linear_velocity + motion.angular_velocity.cross(arm);
        let slip = (velocity - carried).with_z(0.0);
        if place.z < 0.0 {
            let normal_force = ground.normal_force(-place.z, -velocity.z);
            let force = friction.force(normal_force, slip) + DVec3::Z * normal_force;
            load[0] += force;
            load[1] += arm.cross(force);
            // A slip that rounding changes by an ulp of 10 m/s changes the direction of friction.
            forces += force.length() * (1.0 + 10.0 / friction.slip_speed);
        }
    }
    // Some roundings of each depth, of a place below 1 m, and of each force and sum.
    let depths = ground.spring_force(1.0) * scene.body().contacts().len() as f64;
    (load, 16.0 * f64::EPSILON * (forces + depths))
}

/// Bare points on level ground have a computation of their own. It has the forces of the
/// definition, and of the computation for all grounds, when the material moves.
#[test]
fn bare_points_feel_the_material_of_level_ground_as_of_any_ground() {
    /// Number of loads that were compared, and of those in which the material's motion changes the
    /// force by a thousand times the rounding.
    fn compare(body: impl RigidPointBody + Copy, counts: &mut [u32; 2]) {
        let ground = FlatGround::level(100.0, 0.5);
        let friction = Coulomb {
            slip_speed: 1e-2,
            ..coulomb(0.4)
        };
        let plain = Stepper::new(body).unwrap().with_friction(friction).unwrap();
        for motion in level_motions() {
            let level = plain.with_ground(MovingGround { ground, motion }).unwrap();
            let ground = Below(ground);
            let any = plain.with_ground(MovingGround { ground, motion }).unwrap();
            for i in 0..60 {
                let i = f64::from(i);
                let state = State::at(DVec3::new(0.3, -0.2, 0.03 * (i % 7.0) - 0.08))
                    .with_linear_velocity(DVec3::new(0.2, -0.1, 0.05 * (i % 5.0) - 0.1))
                    .with_rotation_vector(DVec3::new(0.1 * i, 1.57 + 0.02 * (i % 4.0), 0.3))
                    .with_angular_momentum(DVec3::new(2e-4, -1e-4, 3e-4));
                let seen = level.scene().motion(&state);
                let load = level.scene().load(&seen);
                let material = (&ground.0, &friction, &motion);
                let (defined, rounding) = load_by_definition(level.scene(), material, &seen);
                let general = any.scene().load(&seen);
                for [force, torque] in [defined, [general.force, general.torque]] {
                    let off = (load.force - force).length() + (load.torque - torque).length();
                    assert!(off <= rounding, "{motion:?}, {i}: {off:e} N");
                }
                let rest = plain.with_ground(ground.0).unwrap().scene().load(&seen);
                let moved = (load.force - rest.force).length();
                counts[0] += u32::from(load.touching > 0);
                counts[1] += u32::from(moved > 1e3 * rounding);
            }
        }
    }
    let mut counts = [0; 2];
    compare(Coin::ring(0.2, 0.15), &mut counts);
    compare(Cuboid::solid(0.2, DVec3::new(0.3, 0.2, 0.1)), &mut counts);
    let [touching, moved] = counts;
    assert!(touching > 200 && moved * 2 > touching, "{counts:?}");
}

/// The same in a motion, by every method.
#[test]
fn every_method_moves_bare_points_over_level_ground_as_over_any_ground() {
    let ground = FlatGround::level(2e3, 2.0);
    let start = State::at(DVec3::new(0.1, 0.2, 0.01))
        .with_rotation_vector(DVec3::new(0.3, 1.5, -0.2))
        .with_linear_velocity(DVec3::new(0.4, 0.5, -0.3))
        .with_angular_momentum(DVec3::new(2e-4, -3e-4, 5e-4));
    let plain = Stepper::builder(Coin::ring(0.2, 0.06))
        .gravity(UniformGravity::down(G))
        .friction(Coulomb {
            slip_speed: 1e-2,
            ..coulomb(0.4)
        })
        .build()
        .unwrap();
    for motion in level_motions() {
        kit::each_method!(1e-4, |integrator, name| {
            let plain = plain.with_integrator(integrator).unwrap();
            let moving = plain.with_ground(MovingGround { ground, motion }).unwrap();
            let mut level = start;
            moving.advance(&mut level, 0.05).unwrap();
            let ground = Below(ground);
            let moving = plain.with_ground(MovingGround { ground, motion }).unwrap();
            let mut any = start;
            moving.advance(&mut any, 0.05).unwrap();
            let falls = start.linear_velocity.z - G * 0.05;
            assert!(
                level.linear_velocity.z > falls + 0.1,
                "{name}: it does not touch"
            );
            let off = (level.position - any.position).length();
            let turned = kit::angle_between(level.orientation, any.orientation);
            assert!(off < 1e-9 && turned < 1e-7, "{name}: {off:e} m, {turned:e}");
        });
    }
}

/// State of a ball at `place` on a turntable, that moves with `velocity` and rolls without slip.
fn rolling(stepper: &Stepper<impl Integrator>, place: DVec3, velocity: DVec3, rate: f64) -> State {
    let radius = stepper.body().contacts()[0].radius;
    let start = State::at(place + DVec3::Z * (radius - 1e-5)).with_linear_velocity(velocity);
    // v + ω × (-r z) = Ω z × x, so ω = z × (v - Ω z × x)/r.
    let slip = velocity - DVec3::Z.cross(place) * rate;
    let spin = DVec3::Z.cross(slip) / radius;
    let axes = start.rotation().axes();
    let properties = stepper.scene().inertia_properties();
    start.with_angular_momentum(properties.angular_momentum(&axes, spin))
}

fn table<I: Integrator>(
    ball: Sphere,
    centre: DVec3,
    rate: f64,
    integrator: I,
) -> Stepper<'static, I> {
    Stepper::builder(ball)
        .gravity(UniformGravity::down(G))
        .ground(MovingGround::turntable(floor(0.1, 1.0), centre, rate))
        .friction(coulomb(0.8))
        .integrator(integrator)
        .build()
        .unwrap()
}

/// A rod whose state has an angular momentum about its own axis, which has no inertia. The step
/// drops it. It was counted as work of the table: -0.04 J in the first step here.
#[test]
fn what_a_rod_cannot_have_is_no_work_of_a_turntable() {
    for split in [false, true] {
        // A step of 1 ms on hard ground is taken in parts.
        let floor = if split {
            floor(0.1, 1e-9)
        } else {
            floor(0.1, 2.0)
        };
        let stepper = Stepper::builder(Rod::new(0.1, 0.2))
            .ground(MovingGround::turntable(floor, DVec3::ZERO, 5.0))
            .gravity(UniformGravity::down(G))
            .build()
            .unwrap();
        let lean = DVec3::Y * (PI / 6.0);
        let lowest = 0.1 * (PI / 6.0).cos() - 1e-5;
        let still = State::at(DVec3::Z * lowest).with_rotation_vector(lean);
        let along = still.orientation * DVec3::Z;
        let with_spin = still.with_angular_momentum(along * 0.01);
        let work = |start: State| {
            let mut state = start;
            stepper.step(&mut state).unwrap().drive_work
        };
        let (expected, found) = (work(still), work(with_spin));
        assert!(
            (found - expected).abs() < 1e-12,
            "{expected:e} and {found:e} J"
        );
    }
}

/// The centre of a ball that rolls on a turntable runs round a circle at `k/(1 + k)` of the table's
/// rate, `k = I/(m r²)`, wherever the circle lies: after one revolution it is at its start (Weltner,
/// Am. J. Phys. 47, 984, 1979). Half a revolution after the start it is a diameter away.
#[test]
fn a_ball_on_a_turntable_runs_round_a_circle() {
    let (rate, place, velocity) = (3.0, DVec3::new(0.2, -0.1, 0.0), DVec3::new(0.1, 0.15, 0.0));
    for (ball, k) in [
        (Sphere::solid(0.1, 0.02), 0.4),
        (Sphere::shell(0.1, 0.02), 2.0 / 3.0),
    ] {
        let own = k / (1.0 + k) * rate;
        let turn = 2.0 * PI / own;
        kit::each_method!(1e-5, |integrator, name| {
            let stepper = table(ball, DVec3::new(0.05, 0.0, 0.0), rate, integrator);
            let place_on_table = place - DVec3::new(0.05, 0.0, 0.0);
            let mut state = rolling(&stepper, place_on_table, velocity, rate);
            state.position += place - place_on_table;
            let start = state.position;
            stepper.advance(&mut state, turn / 2.0).unwrap();
            let diameter = 2.0 * velocity.length() / own;
            let away = (state.position - start).length();
            assert!(
                (away / diameter - 1.0).abs() < 1e-3,
                "{name}, k = {k}: {away} m"
            );
            stepper.advance(&mut state, turn / 2.0).unwrap();
            let off = (state.position - start).length();
            assert!(off < 2e-3 * diameter, "{name}, k = {k}: {off} m");
        });
    }
}

/// A ball set down at rest slides, and then rolls on a circle of the same rate.
///
/// Friction F changes `m v` by F and the velocity u that the spin gives to the contact point by
/// `F/(k m)`. So `v - k u` never changes. It is 0 for this ball. When the table stops, the ball
/// slides until `v + u = 0`. Then both are 0: it stays where it is.
#[test]
fn a_ball_set_down_runs_round_and_stays_when_the_table_stops() {
    let rate = 3.0;
    let ball = Sphere::solid(0.1, 0.02);
    let stepper = table(ball, DVec3::ZERO, rate, EnergyMomentum { time_step: 1e-4 });
    let mut state = State::at(DVec3::new(0.3, 0.0, 0.02 - 1e-5));
    stepper.advance(&mut state, 0.5).unwrap();
    let first = state.linear_velocity;
    assert!(first.length() > 0.1, "{first}");
    let turn = 2.0 * PI / (2.0 / 7.0 * rate);
    stepper.advance(&mut state, turn / 4.0).unwrap();
    // A quarter of a revolution turns the velocity by a right angle, to the left.
    let off = (state.linear_velocity - DVec3::Z.cross(first)).length() / first.length();
    assert!(off < 1e-3, "{off}");
    let stopped = stepper.with_ground(floor(0.1, 1.0)).unwrap();
    stopped.advance(&mut state, 0.5).unwrap();
    assert!(
        state.linear_velocity.length() < 1e-6,
        "{}",
        state.linear_velocity
    );
}

/// A ball that rolls at `v` at the position x of a table of the rate Ω has `v - k u` with
/// `u = Ω z × x - v`. When the table stops, it ends at `v - k/(1 + k) Ω z × x` and goes straight on.
#[test]
fn a_rolling_ball_goes_straight_on_when_the_table_stops() {
    let (rate, place) = (3.0, DVec3::new(0.2, -0.1, 0.0));
    let velocity = DVec3::new(0.6, 0.15, 0.0);
    let stepper = table(
        Sphere::solid(0.1, 0.02),
        DVec3::ZERO,
        rate,
        EnergyMomentum { time_step: 1e-4 },
    );
    let mut state = rolling(&stepper, place, velocity, rate);
    let expected = velocity - DVec3::Z.cross(place) * (2.0 / 7.0 * rate);
    stepper.advance(&mut state, 0.7).unwrap();
    let stopped = stepper.with_ground(floor(0.1, 1.0)).unwrap();
    stopped.advance(&mut state, 0.5).unwrap();
    let (from, found) = (state.position, state.linear_velocity);
    let off = (found - expected).length() / expected.length();
    assert!(off < 1e-3, "{found} instead of {expected}");
    stopped.advance(&mut state, 1.0).unwrap();
    let off = (state.position - from - found).length() / found.length();
    assert!(off < 1e-4, "{off}");
}

/// A ball that spins with a turntable does not rotate relative to it: the longest stable step is
/// that of a ball at rest on the ground at rest, whose spinning friction is strongest.
#[test]
fn the_longest_stable_step_on_a_turntable_is_that_of_the_rotation_relative_to_it() {
    let friction = WithResistance {
        friction: tumble::Frictionless,
        rolling: 0.0,
        spinning: 1e-2,
        turn_speed: 1e-3,
    };
    let body = Sphere::solid(1.0, 0.05);
    let (floor, rate) = (FlatGround::level(1e3, 0.0), 3.0);
    let still = State::at(DVec3::Z * 0.045);
    let inertia = 0.4 * 0.05 * 0.05;
    let spinning = still.with_angular_momentum(DVec3::Z * (rate * inertia));
    let limit = |ground: MovingGround<FlatGround>, state: &State| {
        let stepper = Stepper::builder(body)
            .ground(ground)
            .friction(friction)
            .integrator(tumble::Rk4 { time_step: 1e-6 })
            .build()
            .unwrap();
        stepper.largest_stable_step(state).unwrap()
    };
    let table = |rate| MovingGround::turntable(floor, DVec3::ZERO, rate);
    let expected = limit(table(0.0), &still);
    let with_it = limit(table(rate), &spinning);
    assert!(
        (with_it / expected - 1.0).abs() < 1e-9,
        "{with_it} s for {expected} s"
    );
    let across = limit(table(rate), &still);
    assert!(across > 10.0 * expected, "{across} s");
}

/// A ring that lies in the middle of a turntable is turned with the torque μ m g r, so that its
/// angular velocity is μ g/r t until it has that of the table.
#[test]
fn a_ring_on_a_turntable_takes_its_rate() {
    let (mass, radius, rate, mu) = (0.05, 0.04, 2.0, 0.25);
    kit::each_method!(1e-5, |integrator, name| {
        let ring = Coin::ring(mass, radius);
        let stepper = Stepper::builder(ring)
            .gravity(UniformGravity::down(G))
            .ground(MovingGround::turntable(
                floor(mass, 120.0),
                DVec3::ZERO,
                rate,
            ))
            .friction(coulomb(mu))
            .integrator(integrator)
            .build()
            .unwrap();
        let mut state = State::at(DVec3::Z * -1e-5).with_rotation_vector(DVec3::Y * (PI / 2.0));
        let grips = rate * radius / (mu * G);
        stepper.advance(&mut state, grips / 2.0).unwrap();
        let spin = |state: &State| stepper.scene().motion(state).angular_velocity.z;
        // The slip speed ε of the law makes the slide longer: the rim lags by ε ln 2.
        let expected = rate / 2.0 - 1e-4 * 2.0_f64.ln() / radius;
        assert!(
            (spin(&state) / expected - 1.0).abs() < 2e-4,
            "{name}: {}",
            spin(&state)
        );
        stepper.advance(&mut state, grips).unwrap();
        assert!(
            (spin(&state) / rate - 1.0).abs() < 1e-3,
            "{name}: {}",
            spin(&state)
        );
    });
}

/// Spinning friction acts on the rotation relative to the table.
#[test]
fn spinning_friction_turns_a_ball_with_the_table() {
    let cloth = WithResistance {
        friction: coulomb(0.5),
        rolling: 0.0,
        spinning: 1e-3,
        turn_speed: 1e-2,
    };
    let (mass, radius, rate) = (0.1, 0.02, 2.0);
    kit::each_method!(1e-4, |integrator, name| {
        let stepper = Stepper::builder(Sphere::solid(mass, radius))
            .gravity(UniformGravity::down(G))
            .ground(MovingGround::turntable(floor(mass, 1.0), DVec3::ZERO, rate))
            .friction(cloth)
            .integrator(integrator)
            .build()
            .unwrap();
        let spin = |state: &State| stepper.scene().motion(state).angular_velocity.z;
        let mut state = State::at(DVec3::Z * (radius - 1e-5));
        // The torque is 1e-3 m · m g, and the moment 2/5 m r².
        let growth = 1e-3 * G / (0.4 * radius * radius);
        let time = rate / growth / 2.0;
        stepper.advance(&mut state, time).unwrap();
        // Half of the torque is reached at a turn speed of 1e-2 rad/s.
        assert!(
            (spin(&state) / (growth * time) - 1.0).abs() < 0.02,
            "{name}: {}",
            spin(&state)
        );
        stepper.advance(&mut state, 1.0).unwrap();
        assert!(
            (spin(&state) - rate).abs() < 1e-3,
            "{name}: {}",
            spin(&state)
        );
    });
}

/// The order of each method on a turntable, in sliding contact of a ball.
#[test]
fn every_method_keeps_its_order_on_a_turntable() {
    fn end<I: Integrator>(integrator: I) -> State {
        let stepper = Stepper::builder(Sphere::solid(0.1, 0.05))
            .gravity(UniformGravity::down(G))
            .ground(MovingGround::turntable(
                FlatGround::level(400.0, 2.0),
                DVec3::new(0.1, 0.0, 0.0),
                4.0,
            ))
            .friction(Viscous { coefficient: 0.4 })
            .integrator(integrator)
            .build()
            .unwrap();
        let mut state = State::at(DVec3::new(0.3, 0.1, 0.045))
            .with_linear_velocity(DVec3::new(0.5, -0.3, 0.0))
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

/// Takes random steps and checks that the energy after each is at most the energy before it plus
/// the stated work, as computed.
macro_rules! never_gains {
    ($real:ty, $vec:ty, $ground:expr, $start:expr, $h:expr) => {{
        let [position, velocity, momentum, belt]: [DVec3; 4] = $start;
        let (ground, rate): (FlatGround, f64) = $ground;
        let cast = |v: DVec3| <$vec>::new(v.x as $real, v.y as $real, v.z as $real);
        let motion = tumble::GroundMotion::<$real> {
            velocity: cast(DVec3::new(belt.x, belt.y, 0.0)),
            angular_velocity: cast(DVec3::Z * rate),
        };
        let ground =
            tumble::FlatGround::<$real>::level(ground.stiffness as $real, ground.damping as $real);
        let size = cast(DVec3::new(0.1, 0.07, 0.03));
        let stepper = Stepper::new(tumble::Cuboid::<$real>::solid(0.3, size))
            .and_then(|stepper| stepper.with_gravity(tumble::UniformGravity::down(9.8)))
            .and_then(|stepper| stepper.with_ground(tumble::MovingGround { ground, motion }))
            .and_then(|stepper| {
                stepper.with_friction(tumble::WithResistance {
                    friction: tumble::Coulomb {
                        coefficient: 0.6,
                        slip_speed: 1e-4,
                    },
                    rolling: 1e-3,
                    spinning: 1e-3,
                    turn_speed: 1e-2,
                })
            })
            .and_then(|stepper| {
                stepper.with_integrator(tumble::EnergyMomentum {
                    time_step: $h as $real,
                })
            })
            .unwrap();
        let mut state = tumble::State::<$real>::at(cast(position))
            .with_linear_velocity(cast(velocity))
            .with_angular_momentum(cast(momentum));
        let mut before = stepper.energy(&state).total();
        for number in 0..60 {
            let step = stepper.step(&mut state).unwrap();
            let after = stepper.energy(&state).total();
            prop_assert!(
                after <= before + step.drive_work,
                "step {number}: {before:e} -> {after:e}, work {:e}",
                step.drive_work
            );
            before = after;
        }
    }};
}

proptest! {
    #![proptest_config(kit::cases(400))]

    #[test]
    fn the_energy_minus_the_work_of_the_ground_never_increases(
        stiffness in 1.0..9.0_f64,
        ratio in kit::zero_or(1e-3, 1e3),
        rate in -30.0..30.0_f64,
        position in kit::directions(),
        velocity in kit::directions(),
        momentum in kit::directions(),
        belt in kit::directions(),
        speeds in (-2.0..2.0_f64, -2.0..2.0_f64),
        h in -5.0..-1.0_f64,
    ) {
        let stiffness = 10.0_f64.powf(stiffness);
        let ground = FlatGround::level(stiffness, ratio * stiffness.sqrt());
        let [speed, drift] = [10.0_f64.powf(speeds.0), 10.0_f64.powf(speeds.1)];
        let start = [
            DVec3::new(position.x, position.y, 0.05 * position.z.abs()),
            velocity * speed,
            momentum * (1e-3 * speed),
            belt * drift,
        ];
        let h = 10.0_f64.powf(h);
        never_gains!(f64, DVec3, (ground, rate), start, h);
        never_gains!(f32, Vec3, (ground, rate), start, h);
    }
}

/// The stated work is that of the accurate motion.
#[test]
fn the_stated_work_is_the_work_of_the_belt() {
    let body = Cuboid::solid(0.2, DVec3::new(0.1, 0.06, 0.04));
    let stepper = Stepper::builder(body)
        .gravity(UniformGravity::down(G))
        .ground(MovingGround::turntable(
            FlatGround::level(5e3, 5.0),
            DVec3::Y * 0.3,
            5.0,
        ))
        .friction(coulomb(0.4))
        .integrator(EnergyMomentum { time_step: 1e-4 })
        .build()
        .unwrap();
    let start = State::at(DVec3::new(0.1, 0.0, 0.03))
        .with_rotation_vector(DVec3::new(0.2, 0.1, 0.4))
        .with_linear_velocity(DVec3::new(0.5, 0.2, 0.0));
    let (mut state, mut stated, mut time) = (start, 0.0, 0.0);
    while time < 0.5 {
        let step = stepper.step(&mut state).unwrap();
        stated += step.drive_work;
        time += step.elapsed;
    }
    let accurate = stepper.with_integrator(DormandPrince54::new(1e-9)).unwrap();
    let (mut truth, mut ledger) = (start, Ledger::new());
    accurate.run(&mut truth, time, &mut ledger).unwrap();
    let work = ledger.work().drive;
    assert!(work.abs() > 1e-3, "{work}");
    assert!((stated / work - 1.0).abs() < 0.02, "{stated} J, {work} J");
}

/// A body that rests on a ground is carried along as soon as the ground moves: it does not sleep
/// on, and its face is not proved.
#[test]
fn a_body_on_a_moving_ground_is_awake_and_undecided() {
    let coin = SolidCoin::new(0.005, 0.012, 0.002);
    let ground = FlatGround::level(500.0, 0.5);
    let still = Stepper::builder(coin)
        .gravity(UniformGravity::down(G))
        .ground(ground)
        .friction(coulomb(0.3))
        .integrator(EnergyMomentum { time_step: 1e-3 })
        .build()
        .unwrap();
    let belt = MovingGround::conveyor(ground, DVec3::X);
    let moving = still.with_ground(belt).unwrap();
    let gravity = UniformGravity::down(G);
    let still_scene = Scene::new(coin, ground, coulomb(0.3), gravity).unwrap();
    let moving_scene = Scene::new(coin, belt, coulomb(0.3), gravity).unwrap();
    assert!(Barriers::of(&still_scene).is_some());
    assert!(Barriers::of(&moving_scene).is_none());
    let start = State::at(DVec3::Z * 1e-3).with_rotation_vector(DVec3::Y * (PI / 2.0));
    let mut memory = Default::default();
    let mut session = still.session_in(&mut memory, start);
    for _ in 0..2000 {
        session.step().unwrap();
    }
    let state = session.into_state();
    assert_eq!(state.linear_velocity, DVec3::ZERO);
    // The same memory, which knows that the body rests.
    let mut session = moving.session_in(&mut memory, state);
    session.step().unwrap();
    let velocity = session.state().linear_velocity;
    assert!(velocity.x > 1e-3, "{velocity}");
}

#[test]
fn the_power_of_the_belt_is_force_times_speed() {
    let stepper = Stepper::builder(PointMass::new(0.4))
        .gravity(UniformGravity::down(G))
        .ground(MovingGround::conveyor(floor(0.4, 1.0), DVec3::X * 2.0))
        .friction(Coulomb {
            coefficient: 0.5,
            slip_speed: 1e-9,
        })
        .build()
        .unwrap();
    // The point moves at 0.5 m/s, so its slip is -1.5 m/s and the force 0.5 · 0.4 kg · g.
    let state = State::at(DVec3::Z * -1e-5).with_linear_velocity(DVec3::X * 0.5);
    let power = Dissipation::of(stepper.scene(), &state);
    let force = 0.5 * 0.4 * G;
    assert!((power.drive - force * 2.0).abs() < 1e-8, "{power:?}");
    assert!((power.friction + force * 1.5).abs() < 1e-8, "{power:?}");
    let slip = stepper.slip_velocity(&state).unwrap();
    assert!((slip + DVec3::X * 1.5).length() < 1e-12, "{slip}");
    let account = tumble::EnergyRates::of(stepper.scene(), &state);
    assert!((account.dissipation.drive - power.drive).abs() < 1e-12);
}

#[test]
fn ground_that_would_leave_its_plane_is_named() {
    let named = |motion: GroundMotion| {
        let ground = MovingGround {
            ground: FlatGround::level(1e4, 1.0),
            motion,
        };
        let error: SceneError = SpringDamperGround::check(&ground).unwrap_err();
        (error.quantity, error.rule)
    };
    assert_eq!(
        named(GroundMotion::translation(DVec3::new(1.0, 0.0, 0.1))),
        ("velocity of the ground across its plane", Rule::Zero)
    );
    assert_eq!(
        named(GroundMotion::rotation(
            DVec3::ZERO,
            DVec3::new(0.1, 0.0, 1.0)
        )),
        ("angular velocity of the ground along its plane", Rule::Zero)
    );
    assert_eq!(
        named(GroundMotion::translation(DVec3::X * f64::NAN)),
        ("x of the velocity of the ground", Rule::Finite)
    );
    assert_eq!(
        named(GroundMotion::rotation(DVec3::X * f64::INFINITY, DVec3::Z)),
        ("x of the velocity of the ground", Rule::Finite)
    );
    assert_eq!(
        named(GroundMotion::rotation(DVec3::ZERO, DVec3::Y * f64::NAN)),
        ("x of the angular velocity of the ground", Rule::Finite)
    );
}

#[test]
fn the_velocity_of_a_ground_is_told_with_its_own_value() {
    let told = |x: f64| {
        let ground = MovingGround::conveyor(FlatGround::level(1e4, 1.0), DVec3::X * x + DVec3::Y);
        let error: SceneError = SpringDamperGround::check(&ground).unwrap_err();
        error.to_string()
    };
    assert_eq!(
        told(f64::NEG_INFINITY),
        "x of the velocity of the ground must be finite, got -inf m/s"
    );
    assert_eq!(
        told(1e200),
        "square of the velocity of the ground must be finite, got inf m²/s²"
    );
}

/// The motion inside would have no effect, so a moving ground in motion is refused.
#[test]
fn a_moving_ground_inside_another_is_refused() {
    let belt = |velocity| MovingGround::conveyor(FlatGround::level(1e4, 1.0), velocity);
    let table = |ground| MovingGround::turntable(ground, DVec3::ZERO, 1.0);
    let error: SceneError = SpringDamperGround::check(&table(belt(DVec3::X * 2.0))).unwrap_err();
    assert_eq!(
        error.to_string(),
        "velocity of the ground inside a moving ground must be 0, got 2 m/s"
    );
    let twice = MovingGround::conveyor(table(belt(DVec3::ZERO)), DVec3::X);
    let error: SceneError = SpringDamperGround::check(&twice).unwrap_err();
    assert_eq!(
        error.to_string(),
        "angular velocity of the ground inside a moving ground must be 0, got 1 rad/s"
    );
    assert_eq!(SpringDamperGround::check(&table(belt(DVec3::ZERO))), Ok(()));
}

/// A bowl that turns about its own axis stays where it is. A bowl on a belt does not.
#[test]
fn the_contract_check_finds_material_that_leaves_its_surface() {
    let law = SpringDamper {
        stiffness: 1e4,
        damping: 1.0,
    };
    let bowl = Ground {
        law,
        shape: Terrain::of(Bowl {
            curvatures: [1.0; 2],
        }),
    };
    let range = GroundRange {
        centre: DVec3::ZERO,
        size: 0.5,
        depth: 0.01,
        speed: 5.0,
    };
    let check = |motion: GroundMotion| {
        let ground = MovingGround {
            ground: bowl,
            motion,
        };
        check_ground(&ground, &range, CheckPlan::default())
    };
    check(GroundMotion::rotation(DVec3::ZERO, DVec3::Z * 3.0)).unwrap();
    let fault = check(GroundMotion::translation(DVec3::X)).unwrap_err();
    assert_eq!(fault.requirement, Requirement::MotionAlongSurface);
}
