//! Many states that are stepped in lanes: each has the bits of its own run.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use tumble::glam::{DVec3, Quat, Vec3};
use tumble::{
    AirDrag, Coin, ContactPoint, Coulomb, Cuboid, Disc, Dynamics, EnergyMomentum, FlatGround,
    Force, ForwardEuler, GroundBounds, Integrator, MovingGround, NoGround, Nystrom, Plane,
    RigidPointBody, Rk4, Rod, SlidingFriction, SmoothCoulomb, Sphere, SpringDamperGround, State,
    StateError, StepError, Stepper, StrangSplitting, Surface, SymplecticEuler, UniformGravity,
    WithResistance,
};

/// Random numbers from -1 to 1: a multiplicative congruential generator (Knuth's MMIX).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self, size: f64) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next()) * size
    }
}

/// States in any orientation: in flight, rolling, sliding and flat on a face, with spins from 0 to
/// those that turn the body by more than a radian in a step of 10 ms.
fn states(count: usize, seed: u64) -> Vec<State> {
    let mut random = Random(seed);
    let state = |i: usize| {
        let spin = [0.0, 0.1, 1.0, 5.0, 30.0][i % 5];
        let flat = DVec3::new(0.0, core::f64::consts::FRAC_PI_2, 0.0);
        let (height, rotation) = match i % 7 {
            3 => (-0.28, flat),
            6 => (1.5, random.vector(3.0)),
            _ => (0.1, random.vector(3.0)),
        };
        State::at(random.vector(0.3) + DVec3::Z * height)
            .with_rotation_vector(rotation)
            .with_linear_velocity(random.vector(2.0))
            .with_angular_momentum(random.vector(spin))
    };
    (0..count).map(state).collect()
}

/// Bits of the numbers of a state: 0 and -0 differ.
fn bits(state: &State) -> [u64; 13] {
    let (x, v, q, l) = (
        state.position,
        state.linear_velocity,
        state.orientation,
        state.angular_momentum,
    );
    [
        x.x, x.y, x.z, v.x, v.y, v.z, q.x, q.y, q.z, q.w, l.x, l.y, l.z,
    ]
    .map(f64::to_bits)
}

/// Checks that groups of states end with the bits that each has alone.
fn check<B, G, F, I, E>(
    name: &str,
    stepper: &Stepper<B, G, F, UniformGravity, I, f64, E>,
    seconds: f64,
) where
    B: RigidPointBody,
    G: SpringDamperGround,
    F: SlidingFriction,
    I: Integrator,
    E: Force,
{
    let start = states(21, 7);
    let mut together = start.clone();
    stepper.advance_many(&mut together, seconds).unwrap();
    let mut touched = 0;
    for (i, (mut alone, together)) in start.into_iter().zip(together).enumerate() {
        let touches_first = stepper.touching(&alone) > 0;
        stepper.advance(&mut alone, seconds).unwrap();
        assert_eq!(
            bits(&alone),
            bits(&together),
            "{name}, state {i}: {alone} {together}"
        );
        touched += usize::from(touches_first || stepper.touching(&alone) > 0);
    }
    // Lanes that touch beside lanes that do not, unless there is no ground.
    let no_ground = matches!(stepper.scene().ground().bounds(), GroundBounds::Nowhere);
    assert!(
        touched < 21 && (touched > 0) != no_ground,
        "{name}: {touched}"
    );
}

/// A scene with a method that is replaced.
type Template<B, G, F, E> = Stepper<B, G, F, UniformGravity, EnergyMomentum, f64, E>;

/// Step sizes (s) for which all three series of the rotation are needed, and numbers of steps.
/// Lanes are tested after some steps, and a run may end with a part of a step.
const RUNS: [(f64, f64); 3] = [(1e-4, 70.0), (1e-3, 70.5), (1e-2, 3.0)];

/// Checks a scene with each method.
fn check_methods<B, G, F, E>(name: &str, scene: &Template<B, G, F, E>)
where
    B: RigidPointBody + Clone,
    G: SpringDamperGround + Clone,
    F: SlidingFriction + Clone,
    E: Force + Clone,
{
    check_one_method(name, scene);
    for (time_step, steps) in RUNS {
        let seconds = time_step * steps;
        let with = || scene.clone();
        let euler = with()
            .with_integrator(SymplecticEuler { time_step })
            .unwrap();
        check(name, &euler, seconds);
        let rk4 = with().with_integrator(Rk4 { time_step }).unwrap();
        check(name, &rk4, seconds);
        let nystrom = with().with_integrator(Nystrom { time_step }).unwrap();
        check(name, &nystrom, seconds);
    }
}

/// Checks a scene with the method that has the most branches.
fn check_one_method<B, G, F, E>(name: &str, scene: &Template<B, G, F, E>)
where
    B: RigidPointBody + Clone,
    G: SpringDamperGround + Clone,
    F: SlidingFriction + Clone,
    E: Force + Clone,
{
    for (time_step, steps) in RUNS {
        let strang = scene
            .clone()
            .with_integrator(StrangSplitting { time_step })
            .unwrap();
        check(name, &strang, time_step * steps);
    }
}

fn ring(points: usize) -> Coin<f64, Vec<ContactPoint>> {
    Coin::ring_with_storage(vec![ContactPoint::default(); points], 1.0, 0.5)
}

const COULOMB: Coulomb = Coulomb {
    coefficient: 0.3,
    slip_speed: 1e-3,
};

fn scene<B: RigidPointBody>(
    body: B,
) -> Stepper<B, FlatGround, Coulomb, UniformGravity, EnergyMomentum> {
    Stepper::builder(body)
        .gravity(UniformGravity::down(9.8))
        .ground(FlatGround::level(300.0, 0.5))
        .friction(COULOMB)
        .build()
        .unwrap()
}

#[test]
fn each_of_many_states_has_the_bits_of_its_own_run_for_any_number_of_contacts() {
    check_methods("12 points", &scene(ring(12)));
    check_methods("120 points", &scene(ring(120)));
    check_methods("1200 points", &scene(ring(1200)));
    check_one_method("rod", &scene(Rod::new(1.0, 1.0)));
}

#[test]
fn bodies_whose_contacts_are_no_points_have_the_bits_of_their_own_run() {
    check_one_method("sphere", &scene(Sphere::solid(1.0, 0.3)));
    check_methods("disc", &scene(Disc::ring(1.0, 0.5, 120)));
}

#[test]
fn a_body_with_three_moments_has_the_bits_of_its_own_run() {
    check_methods("box", &scene(Cuboid::solid(1.0, DVec3::new(0.3, 0.6, 0.9))));
}

/// A ring whose axis of symmetry is none of its axes.
#[derive(Clone)]
struct Slanted(Coin<f64, Vec<ContactPoint>>, Vec<ContactPoint>);

impl Slanted {
    fn new() -> Self {
        let turn = tumble::glam::DQuat::from_scaled_axis(DVec3::new(0.4, -1.1, 2.0));
        let turned = |contact: &ContactPoint| ContactPoint::bare(turn * contact.position);
        let ring = ring(30);
        let contacts = ring.contacts().iter().map(turned).collect();
        Self(ring, contacts)
    }
}

impl RigidPointBody for Slanted {
    fn mass(&self) -> f64 {
        self.0.mass()
    }
    fn inertia(&self) -> tumble::glam::DMat3 {
        // Of a ring with this normal: m r²/2 (1 + n nᵀ).
        let normal = tumble::glam::DQuat::from_scaled_axis(DVec3::new(0.4, -1.1, 2.0)) * DVec3::X;
        let [x, y, z] = [normal * normal.x, normal * normal.y, normal * normal.z];
        let product = tumble::glam::DMat3::from_cols(x, y, z);
        (tumble::glam::DMat3::IDENTITY + product) * 0.125
    }
    fn contacts(&self) -> &[ContactPoint] {
        &self.1
    }
}

#[test]
fn a_users_body_has_the_bits_of_its_own_run() {
    check_one_method("slanted", &scene(Slanted::new()));
}

#[test]
fn other_grounds_frictions_and_forces_have_the_bits_of_their_own_run() {
    let coin = || scene(ring(40));
    let tilted = FlatGround::level(300.0, 0.5).on(Plane {
        normal: DVec3::new(0.0, 0.6, 0.8),
        height: 0.0,
    });
    check_one_method("tilted", &coin().with_ground(tilted).unwrap());
    let belt = MovingGround::conveyor(FlatGround::level(300.0, 0.5), DVec3::X * 0.5);
    check_one_method("belt", &coin().with_ground(belt).unwrap());
    let walls = [
        FlatGround::level(300.0, 0.5),
        FlatGround::level(300.0, 0.5).on(Plane {
            normal: DVec3::X,
            height: -0.2,
        }),
    ];
    check_one_method("walls", &coin().with_ground(walls).unwrap());
    check_one_method("nothing", &coin().with_ground(NoGround).unwrap());
    let smooth = SmoothCoulomb {
        coefficient: 0.3,
        slip_speed: 1e-2,
    };
    check_one_method("smooth", &coin().with_friction(smooth).unwrap());
    let resistance = WithResistance {
        friction: COULOMB,
        rolling: 1e-3,
        spinning: 1e-3,
        turn_speed: 1e-2,
    };
    check_one_method("resistance", &coin().with_friction(resistance).unwrap());
    let drag = AirDrag::quadratic(0.5, 0.8, 1.2);
    check_one_method("drag", &coin().with_force(drag).unwrap());
}

#[test]
fn methods_without_lanes_have_the_bits_of_their_own_run() {
    let time_step = 1e-3;
    let euler = scene(ring(12))
        .with_integrator(ForwardEuler { time_step })
        .unwrap();
    check("ForwardEuler", &euler, 0.02);
    check("EnergyMomentum", &scene(ring(12)), 0.02);
}

/// Coins just above the ground: each touches down in another step and bounces, and its contacts
/// close and open in turn.
fn falling() -> [State; 16] {
    core::array::from_fn(|i| {
        let part = i as f64 / 16.0;
        let state = State::at(DVec3::ZERO)
            .with_rotation_vector(DVec3::new(0.4 * part, 0.2 + 1.2 * part, 0.3))
            .with_linear_velocity(DVec3::new(0.5 * part, 0.1, -0.5))
            .with_angular_momentum(DVec3::new(0.2, 0.3 * part, -0.1));
        let normal = state.orientation * DVec3::X;
        let lowest = 0.5 * (1.0 - normal.z * normal.z).sqrt();
        State {
            position: DVec3::Z * (lowest + 0.002 + 0.02 * part),
            ..state
        }
    })
}

/// Checks coins that touch down in different steps, with a method and a number of points.
fn check_touch_downs(points: usize, integrator: impl Integrator) {
    let stepper = scene(ring(points)).with_integrator(integrator).unwrap();
    let time_step = stepper.integrator().fixed_step().unwrap();
    let (mut first, mut changes) = ([0; 16], 0);
    let (mut together, mut separate) = (falling(), falling());
    for step in 1..400 {
        stepper
            .advance_many(&mut together, 5.0 * time_step)
            .unwrap();
        for (i, alone) in separate.iter_mut().enumerate() {
            let before = stepper.touching(alone);
            stepper.advance(alone, 5.0 * time_step).unwrap();
            assert_eq!(bits(alone), bits(&together[i]), "state {i}, step {step}");
            let touching = stepper.touching(alone);
            changes += usize::from(touching != before);
            if touching > 0 && first[i] == 0 {
                first[i] = step;
            }
        }
    }
    let mut steps = first.to_vec();
    steps.sort_unstable();
    steps.dedup();
    assert!(steps.len() > 8 && changes > 100, "{first:?}, {changes}");
}

#[test]
fn lanes_that_touch_down_in_different_steps_have_the_bits_of_their_own_run() {
    for points in [3, 12, 120] {
        check_touch_downs(points, Nystrom { time_step: 5e-4 });
        check_touch_downs(points, Rk4 { time_step: 5e-4 });
        check_touch_downs(points, StrangSplitting { time_step: 5e-4 });
    }
}

/// A user's laws. They refuse arguments that their contracts exclude, and fail above a depth.
#[derive(Clone, Copy)]
struct Strict {
    breaks_at: f64,
}

impl SpringDamperGround for Strict {
    fn surface(&self, point: DVec3) -> Surface {
        Surface {
            gap: point.z,
            normal: DVec3::Z,
        }
    }
    fn spring_force(&self, depth: f64) -> f64 {
        assert!(depth > 0.0);
        if depth > self.breaks_at {
            -1.0
        } else {
            300.0 * depth
        }
    }
    fn spring_energy(&self, depth: f64) -> f64 {
        if depth > self.breaks_at {
            -1.0
        } else {
            150.0 * depth * depth
        }
    }
    fn normal_force(&self, depth: f64, closing_speed: f64) -> f64 {
        assert!(depth > 0.0);
        (self.spring_force(depth) + 0.5 * closing_speed).max(0.0)
    }
    fn bounds(&self) -> GroundBounds {
        GroundBounds::Plane(Plane::level(0.0))
    }
}

#[derive(Clone, Copy)]
struct Own;

impl SlidingFriction for Own {
    fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
        assert!(normal_force >= 0.0);
        slip * (-0.3 * normal_force / (slip.length() + 1e-3))
    }
}

#[test]
fn a_users_laws_are_evaluated_as_their_contracts_allow_and_have_the_bits_of_their_own_run() {
    let strict = Strict { breaks_at: 10.0 };
    let own = scene(ring(120)).with_ground(strict).unwrap();
    check_methods("own", &own.with_friction(Own).unwrap());
}

/// Runs states one after the other, as `advance_many` promises.
fn alone<I: Integrator, B: RigidPointBody, G: SpringDamperGround, F: SlidingFriction>(
    stepper: &Stepper<B, G, F, UniformGravity, I>,
    states: &mut [State],
    seconds: f64,
) -> Vec<Option<StepError>> {
    let run = |state: &mut State| stepper.advance(state, seconds).err();
    states.iter_mut().map(run).collect()
}

#[test]
fn the_first_state_that_fails_is_named_and_all_others_reach_the_end() {
    let laws = scene(ring(12))
        .with_ground(Strict { breaks_at: 0.3 })
        .unwrap();
    let time_step = 1e-3;
    let stepper = laws
        .with_friction(Own)
        .and_then(|laws| laws.with_integrator(StrangSplitting { time_step }))
        .unwrap();
    let start = states(40, 3);
    let (mut together, mut separate) = (start.clone(), start);
    let errors = alone(&stepper, &mut separate, 0.2);
    let failed = stepper.advance_many(&mut together, 0.2);
    let count = errors.iter().flatten().count();
    assert!((1..39).contains(&count), "{count} of 40 fail");
    let index = errors.iter().position(Option::is_some).unwrap();
    let error = errors[index].unwrap();
    assert_eq!(failed, Err(StateError { index, error }));
    for (a, b) in separate.iter().zip(&together) {
        assert_eq!(bits(a), bits(b));
    }
}

/// Friction that drives a body which slides faster than 1 m/s.
#[derive(Clone, Copy)]
struct Driving;

impl SlidingFriction for Driving {
    fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
        let speed = slip.length();
        let sign = if speed > 1.0 { 0.3 } else { -0.3 };
        slip * (sign * normal_force / (speed + 1e-3))
    }
}

/// Checks that states fail with the errors of their own runs.
fn check_errors(integrator: impl Integrator) {
    let stepper = scene(ring(12))
        .with_friction(Driving)
        .and_then(|laws| laws.with_integrator(integrator))
        .unwrap();
    let (mut together, mut separate) = (states(40, 3), states(40, 3));
    let errors = alone(&stepper, &mut separate, 0.2);
    let failed = stepper.advance_many(&mut together, 0.2);
    let index = errors.iter().position(Option::is_some).unwrap();
    let error = errors[index].unwrap();
    assert!(errors.iter().any(Option::is_none), "all fail");
    assert_eq!(failed, Err(StateError { index, error }));
    for (a, b) in separate.iter().zip(&together) {
        assert_eq!(bits(a), bits(b));
    }
}

#[test]
fn a_friction_law_that_fails_in_some_lanes_has_the_errors_of_their_own_runs() {
    let time_step = 1e-3;
    check_errors(SymplecticEuler { time_step });
    check_errors(StrangSplitting { time_step });
    check_errors(Rk4 { time_step });
    check_errors(Nystrom { time_step });
}

#[test]
fn a_state_that_is_not_finite_is_named_and_stays_as_it_was() {
    let time_step = 1e-3;
    let stepper = scene(ring(12)).with_integrator(Rk4 { time_step }).unwrap();
    let mut together = states(8, 5);
    let mut others = together.clone();
    together[6].linear_velocity.y = f64::NAN;
    let before = together[6];
    let failed = stepper.advance_many(&mut together, 0.05);
    let failed = failed.unwrap_err();
    assert_eq!(failed.index, 6);
    let text = failed.to_string();
    let rule = "the linear velocity before the step must be finite, got NaN m/s";
    assert_eq!(text, format!("state 6: {rule}"));
    assert_eq!(bits(&together[6]), bits(&before));
    alone(&stepper, &mut others, 0.05);
    for i in [0, 1, 2, 3, 4, 5, 7] {
        assert_eq!(bits(&together[i]), bits(&others[i]));
    }
}

#[test]
fn a_duration_is_refused_as_for_one_state_and_no_states_are_no_error() {
    let time_step = 1e-3;
    let stepper = scene(ring(12)).with_integrator(Rk4 { time_step }).unwrap();
    let start = states(8, 5);
    for seconds in [-1.0, f64::NAN, f64::INFINITY, 1e30] {
        let mut together = start.clone();
        let failed = stepper.advance_many(&mut together, seconds).unwrap_err();
        let error = stepper.advance(&mut start[0].clone(), seconds).unwrap_err();
        assert_eq!(failed.index, 0);
        assert_eq!(failed.error.to_string(), error.to_string());
        assert_eq!(together, start);
        assert_eq!(stepper.advance_many(&mut [], seconds), Ok(()));
    }
    let mut unmoved = start.clone();
    stepper.advance_many(&mut unmoved, 0.0).unwrap();
    assert_eq!(unmoved, start);
}

#[test]
fn many_states_in_single_precision_have_the_bits_of_their_own_run() {
    let to_single = |state: &State| tumble::f32::State {
        position: state.position.as_vec3(),
        linear_velocity: state.linear_velocity.as_vec3(),
        orientation: state.orientation.as_quat(),
        angular_momentum: state.angular_momentum.as_vec3(),
    };
    let stepper = tumble::f32::Stepper::builder(Coin::<f32>::ring(1.0, 0.5))
        .gravity(UniformGravity::<f32>::down(9.8))
        .ground(FlatGround::<f32>::level(300.0, 0.5))
        .friction(Coulomb::<f32> {
            coefficient: 0.3,
            slip_speed: 1e-3,
        })
        .integrator(StrangSplitting::<f32> { time_step: 1e-3 })
        .build()
        .unwrap();
    let start: Vec<_> = states(24, 11).iter().map(to_single).collect();
    let mut together = start.clone();
    stepper.advance_many(&mut together, 0.3).unwrap();
    let bits = |state: &tumble::f32::State| {
        let vector = |v: Vec3| v.to_array().map(f32::to_bits);
        let quaternion = |q: Quat| q.to_array().map(f32::to_bits);
        (
            vector(state.position),
            vector(state.linear_velocity),
            quaternion(state.orientation),
            vector(state.angular_momentum),
        )
    };
    for (mut alone, together) in start.into_iter().zip(together) {
        stepper.advance(&mut alone, 0.3).unwrap();
        assert_eq!(bits(&alone), bits(&together));
    }
}
