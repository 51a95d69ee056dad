//! Slow bodies at the turning points of their motion, in single precision.
//!
//! There the kinetic energy is below the rounding of the total. `EnergyMomentum` took a body that
//! rolls up a slope, or that swings in a bowl, for one at rest, and it stayed there for good.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::kit::erased::Stepper;
use tumble::ground::{Bowl, Plane, SpringDamper, Terrain};
use tumble::real::{Real, Vector};
use tumble::{
    Coulomb, EnergyMomentum, FlatGround, Ground, MassProperties, Rotation, Sphere,
    SpringDamperGround, State, UniformGravity,
};

/// Multiples of which the fractional parts are the numbers of a scene.
const ROOTS: [f64; 8] = [
    0.618_034, 0.754_878, 0.569_840, 0.324_718, 0.819_173, 0.671_043, 0.549_700, 0.430_159,
];
/// Bodies of each kind, and how long each moves, s.
const BODIES: u32 = 80;
const SECONDS: f64 = 10.0;
/// Time after which the depth of the start no longer matters, s.
const SETTLED: f64 = 0.5;
const GRAVITY: f64 = 9.8;
/// Largest loss of energy in a step, in units `ε (m g r + m v²/2)` with the distance r of the
/// farthest point of the body from the origin.
const LOSS: f64 = 1.0;

/// A ball that moves to and fro along x: its numbers.
#[derive(Clone, Copy, Debug)]
struct Scene {
    mass: f64,
    radius: f64,
    /// Depth at rest, in radii, and damping ratio.
    depth: f64,
    damping_ratio: f64,
    /// Height of the ground at the origin, m.
    height: f64,
    /// Tangent of the slope at the start.
    slope: f64,
    /// A length of the scene, in radii.
    length: f64,
    time_step: f64,
}

impl Scene {
    fn of(number: u32) -> Self {
        let part = |root: usize| (f64::from(number) * ROOTS[root]).fract();
        let decades = |root: usize, low: f64, high: f64| low * (high / low).powf(part(root));
        Self {
            mass: decades(0, 1e-2, 10.0),
            radius: decades(1, 0.02, 0.5),
            depth: decades(2, 3e-4, 1e-2),
            damping_ratio: part(3),
            height: 2.0 * part(4) - 1.0,
            slope: decades(5, 0.01, 0.2),
            length: decades(6, 2.0, 20.0),
            time_step: decades(7, 1e-3, 1.0 / 60.0),
        }
    }

    /// Stiffness and damping of the ground, N/m and N s/m.
    fn law<R: Real>(&self) -> SpringDamper<R> {
        let stiffness = self.mass * GRAVITY / (self.depth * self.radius);
        let damping = 2.0 * self.damping_ratio * (stiffness * self.mass).sqrt();
        SpringDamper {
            stiffness: R::from_f64(stiffness),
            damping: R::from_f64(damping),
        }
    }
}

/// What a run has shown.
#[derive(Clone, Copy, Debug)]
struct Swing {
    turns: u32,
    /// Energy lost after the start, J, and a unit in the last place of the energies, J.
    lost: f64,
    unit: f64,
    /// Energy of the motion, J.
    energy: f64,
    steps: u32,
}

/// Runs a body. `energy` is that of its motion, J.
fn run<R: Real>(
    scene: &Scene,
    body: Sphere<R>,
    ground: impl SpringDamperGround<R>,
    start: State<R>,
    energy: f64,
) -> Swing {
    let real = R::from_f64;
    let stepper = Stepper::builder(body)
        .gravity(UniformGravity::down(real(GRAVITY)))
        .ground(ground)
        .friction(Coulomb {
            coefficient: real(0.6),
            slip_speed: real(1e-4),
        })
        .integrator(EnergyMomentum {
            time_step: real(scene.time_step),
        })
        .build()
        .unwrap();
    let (mut session, mut last) = (stepper.session(start), start.position.x());
    let (mut turns, mut forward, mut steps) = (0, None, 0);
    let energy_of = |state: &State<R>| stepper.energy(state).total().to_f64();
    let mut settled = energy_of(&start);
    // A movement counts from a ten-thousandth of the body on.
    let least = real(1e-4 * scene.radius);
    while session.time() < real(SECONDS) {
        session.step().unwrap();
        steps += 1;
        if session.time() <= real(SETTLED) {
            settled = energy_of(session.state());
        }
        let x = session.state().position.x();
        let (is_move, is_forward) = ((x - last).abs() > least, x > last);
        if is_move {
            turns += u32::from(forward.is_some_and(|forward| forward != is_forward));
            (forward, last) = (Some(is_forward), x);
        }
    }
    let at_start = stepper.energy(&start);
    let sizes = R::from_f64(scene.mass * GRAVITY)
        * (start.position.length() + R::from_f64(scene.radius))
        + at_start.kinetic();
    Swing {
        turns,
        lost: settled - energy_of(session.state()),
        unit: sizes.to_f64() * f64::from(f32::EPSILON),
        energy,
        steps,
    }
}

fn vector<R: Real>([x, y, z]: [f64; 3]) -> R::Vec3 {
    R::Vec3::new(R::from_f64(x), R::from_f64(y), R::from_f64(z))
}

/// A ball that is let go on the wall of a bowl, below whose bottom the origin is.
fn in_a_bowl<R: Real>(scene: &Scene) -> Swing {
    let curvature = 1.0 / (scene.length * scene.radius);
    let x = scene.slope / curvature;
    let way = curvature * x * x / 2.0;
    let field = move |x: R, y: R| {
        let bowl = Bowl {
            curvatures: [R::from_f64(curvature); 2],
        };
        let mut elevation = tumble::ground::HeightField::elevation(&bowl, x, y);
        elevation.height += R::from_f64(scene.height);
        elevation
    };
    let ground = Ground {
        law: scene.law::<R>(),
        shape: Terrain::of::<R>(field),
    };
    let body = Sphere::solid(R::from_f64(scene.mass), R::from_f64(scene.radius));
    let tilt = scene.slope.atan();
    let out = scene.radius * (1.0 - scene.depth);
    let centre = [
        x - out * tilt.sin(),
        0.0,
        scene.height + way + out * tilt.cos(),
    ];
    let energy = scene.mass * GRAVITY * (way - scene.radius * (1.0 - tilt.cos()));
    run(scene, body, ground, State::at(vector::<R>(centre)), energy)
}

/// A ball that rolls up a slope, turns, and rolls down.
fn up_a_slope<R: Real>(scene: &Scene) -> Swing {
    let tilt = scene.slope.atan();
    // It turns after a third of the time.
    let speed = SECONDS / 3.0 * GRAVITY * tilt.sin() * 5.0 / 7.0;
    let normal = vector::<R>([-tilt.sin(), 0.0, tilt.cos()]);
    let law = scene.law::<R>();
    let point = vector::<R>([0.0, 0.0, scene.height]);
    let ground = FlatGround::level(law.stiffness, law.damping).on(Plane::through(point, normal));
    let body = Sphere::solid(R::from_f64(scene.mass), R::from_f64(scene.radius));
    let uphill = vector::<R>([tilt.cos() * speed, 0.0, tilt.sin() * speed]);
    let momentum = 0.4 * scene.mass * scene.radius * speed;
    let start = State::at(point + normal * R::from_f64(scene.radius * (1.0 - scene.depth)))
        .with_linear_velocity(uphill)
        .with_angular_momentum(vector::<R>([0.0, momentum, 0.0]));
    run(scene, body, ground, start, 0.7 * scene.mass * speed * speed)
}

/// A ball that rocks about its lowest position, since its centre of mass is not in the middle.
fn rocking<R: Real>(scene: &Scene) -> Swing {
    let offset = scene.radius * 0.2;
    let load = MassProperties::ball(R::from_f64(scene.mass), R::from_f64(scene.radius))
        .unwrap()
        .at(vector::<R>([0.0, 0.0, -offset]));
    let body = Sphere::loaded(R::from_f64(scene.radius), load);
    let law = scene.law::<R>();
    let plane = Plane::level(R::from_f64(scene.height));
    let ground = FlatGround::level(law.stiffness, law.damping).on(plane);
    let turned = Rotation::<R>::from_rotation_vector(vector::<R>([0.0, scene.slope * 5.0, 0.0]));
    let middle = vector::<R>([0.0, 0.0, scene.height + scene.radius * (1.0 - scene.depth)]);
    let state = State::at(R::Vec3::ZERO).with_orientation(turned.to_quat());
    let start = State {
        position: middle - state.world_point(body.middle()),
        ..state
    };
    let energy = scene.mass * GRAVITY * offset * (1.0 - (scene.slope * 5.0).cos());
    run(scene, body, ground, start, energy)
}

/// Runs bodies of a kind in both precisions. Single precision loses at most [`LOSS`] units a step,
/// and a body that has most of its energy left turns as often as in double precision.
#[track_caller]
fn turns_as_often(kind: &str, single: fn(&Scene) -> Swing, double: fn(&Scene) -> Swing) {
    let (mut compared, mut worst) = (0, 0.0_f64);
    for number in 1..=BODIES {
        let scene = Scene::of(number);
        let (here, there) = (single(&scene), double(&scene));
        let loss = (here.lost - there.lost) / (here.unit * f64::from(here.steps));
        worst = worst.max(loss);
        assert!(loss < LOSS, "{kind} {number}: {loss} {here:?} {scene:?}");
        if here.energy > LOSS * here.unit * f64::from(here.steps) {
            compared += 1;
            assert!(
                here.turns.abs_diff(there.turns) <= 1 + there.turns / 10,
                "{kind} {number}: {here:?} {there:?} {scene:?}"
            );
        }
    }
    println!("{kind}: {compared} of {BODIES} compared, at most {worst:.2} units a step");
    assert!(compared >= BODIES / 3, "{kind}: only {compared} compared");
}

#[test]
fn a_ball_in_a_bowl_turns_in_single_precision_as_often_as_in_double() {
    turns_as_often("bowl", in_a_bowl::<f32>, in_a_bowl::<f64>);
}

#[test]
fn a_ball_that_rolls_up_a_slope_comes_back_in_single_precision() {
    turns_as_often("slope", up_a_slope::<f32>, up_a_slope::<f64>);
}

#[test]
fn a_loaded_ball_rocks_in_single_precision_as_often_as_in_double() {
    turns_as_often("rocking", rocking::<f32>, rocking::<f64>);
}

/// A body that begins deep in soft ground is thrown out. At first its kinetic energy is below the
/// rounding of that of the springs, but it is at no turning point. Taken for one, it jumped by some
/// 4e-4 radii in a step, ten thousand units in the last place of its depth.
#[test]
fn a_body_that_soft_ground_throws_out_does_not_jump() {
    // Mass (kg), radius (m), stiffness (N/m), step size (s).
    let scenes = [
        [1.0, 91.629_82, 86.245_42, 1.703_302e-6],
        [127.2, 643.39, 492.58, 9.26e-6],
        [170.9, 10.436, 17_734.4, 1.99e-6],
        [2.0, 0.5, 3e3, 1e-6],
        [0.03, 0.02, 5e2, 1e-7],
    ];
    for [mass, radius, stiffness, time_step] in scenes.map(|scene| scene.map(f32::from_f64)) {
        let stepper = Stepper::builder(Sphere::solid(mass, radius))
            .gravity(UniformGravity::down(9.8_f32))
            .ground(FlatGround::level(stiffness, 0.0))
            .integrator(EnergyMomentum { time_step })
            .build()
            .unwrap();
        let mut state = State::at(tumble::glam::Vec3::ZERO);
        for number in 0..1000 {
            let before = state;
            stepper.step(&mut state).unwrap();
            let path = (state.position - before.position).length();
            let speed = (before.linear_velocity.length()).max(state.linear_velocity.length());
            let unit = f32::EPSILON * radius;
            assert!(
                path <= speed * time_step + 2.0 * unit,
                "{radius} m, step {number}: {path:e} m at {speed:e} m/s"
            );
        }
    }
}
