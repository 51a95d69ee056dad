//! A round rim on ground that is not a plane: the arcs that touch, and the edges of the ground
//! below them.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use core::cell::Cell;
use core::f64::consts::{PI, SQRT_2, TAU};

use crate::kit::erased::Stepper;
use crate::kit::{GRAVITY, cases, difference, orientations, whole};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::TestRunner;
use tumble::f64::{Disc, State, Surface};
use tumble::glam::DVec3;
use tumble::ground::{Bowl, HeightField, Ramp, Terrain, Waves};
use tumble::{
    Block, Coulomb, Dynamics, EnergyMomentum, Ground, Shape, SpringDamper, SpringDamperGround,
    UniformGravity,
};

const RADIUS: f64 = 0.4;
/// Poses on each shape.
const POSES: usize = 60;
/// Relative error, mostly of the rule with eight points on a piece of rim on hills. A missed arc or
/// edge gives some percent.
const SMALL: f64 = 1e-4;
/// Points that a rim represents.
const POINTS: u8 = 40;
const SPRING: SpringDamper = SpringDamper {
    stiffness: 2500.0,
    damping: 0.0,
};

fn block(half: DVec3) -> Ground<SpringDamper, Block> {
    let centre = DVec3::new(0.1, 0.0, 0.0);
    let shape = Block { centre, half };
    Ground { law: SPRING, shape }
}

/// Bounds of the relative errors: of nine poses in ten, and of all.
type Bounds = [f64; 2];
/// An edge is missed between two neighbouring points that lie nearest the same face.
const ON_BOXES: Bounds = [SMALL, 0.05];
/// Hills as long as the rim's diameter.
const ON_HILLS: Bounds = [SMALL, 1e-3];

/// Calls a check with each shape of ground, its name, how deep a rim may be in it (m), and the
/// bounds of the errors.
macro_rules! on_shapes {
    ($check:path) => {
        $check("block", &block(DVec3::new(0.3, 0.5, 0.3)), 0.05, ON_BOXES);
        $check("slab", &block(DVec3::new(0.2, 0.5, 0.05)), 0.03, ON_BOXES);
        $check("post", &block(DVec3::new(0.03, 0.03, 0.2)), 0.02, ON_BOXES);
        let bowl = Bowl {
            curvatures: [1.0, 0.7],
        };
        $check("bowl", &terrain(bowl), 0.05, [SMALL; 2]);
        let ramp = Ramp {
            slope: 0.5,
            width: 0.2,
        };
        $check("ramp", &terrain(ramp), 0.05, [SMALL; 2]);
        let waves = Waves {
            amplitude: 0.05,
            length: 0.8,
        };
        $check("waves", &terrain(waves), 0.05, ON_HILLS);
    };
}

fn terrain<H: HeightField>(field: H) -> Ground<SpringDamper, Terrain<H>> {
    Ground {
        law: SPRING,
        shape: Terrain::of(field),
    }
}

/// Poses of a rim that touches a ground, by at most this depth (m), the same ones in every run.
fn poses(ground: &impl SpringDamperGround, depth: f64, count: usize) -> Vec<State> {
    let place = (-0.6..0.6, -0.6..0.6, -0.2..0.6_f64).prop_map(DVec3::from);
    let states = (place, orientations()).prop_map(|(place, orientation)| State {
        orientation,
        ..State::at(place)
    });
    let touches = |state: &State| {
        let least = (0..500_u16)
            .map(|number| gap_at(ground, state, TAU * f64::from(number) / 500.0))
            .fold(f64::MAX, f64::min);
        least > -depth && least < -1e-3
    };
    let mut runner = TestRunner::new(cases(1));
    let mut draw = || states.new_tree(&mut runner).unwrap().current();
    core::iter::repeat_with(&mut draw)
        .filter(touches)
        .take(count)
        .collect()
}

/// Gap below the point of the rim at an angle, m.
fn gap_at(ground: &impl SpringDamperGround, state: &State, angle: f64) -> f64 {
    let arm = DVec3::new(0.0, angle.cos(), angle.sin()) * RADIUS;
    ground.surface(state.position + state.orientation * arm).gap
}

/// Energy of the springs under a rim by the midpoint rule with many points, J.
fn summed_energy(ground: &impl SpringDamperGround, state: &State) -> f64 {
    let count = 100_000_u32;
    let energy_at = |number: u32| {
        let angle = TAU * (f64::from(number) + 0.5) / f64::from(count);
        ground.spring_energy((-gap_at(ground, state, angle)).max(0.0))
    };
    (0..count).map(energy_at).sum::<f64>() * f64::from(POINTS) / f64::from(count)
}

/// The arcs are those below the ground, and each piece between two edges of it is integrated alone.
#[test]
fn the_energy_is_the_sum_over_many_points() {
    on_shapes!(compare_energy);
}

fn compare_energy(name: &str, ground: &impl SpringDamperGround, depth: f64, bounds: Bounds) {
    let stepper = rim_on(ground);
    let error_in = |state: State| {
        let energy = stepper.energy(&state).springs;
        let sum = summed_energy(ground, &state);
        let error = (energy - sum).abs() / sum;
        (error, format!("{name}: {energy} J, {sum} J at {state:?}"))
    };
    let poses = poses(ground, depth, POSES);
    are_small(poses.into_iter().map(error_in).collect(), bounds);
}

/// Checks errors, each with a description of its pose.
fn are_small(mut errors: Vec<(f64, String)>, bounds: Bounds) {
    errors.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let usual = &errors[errors.len() * 9 / 10 - 1];
    for ((error, pose), bound) in [usual, &errors[errors.len() - 1]].into_iter().zip(bounds) {
        assert!(*error < bound, "{error:e} instead of {bound}: {pose}");
    }
}

/// Lengths of hills in radii of the rim, and the relative error on them in any pose.
const HILLS: [[f64; 2]; 3] = [[4.0, 1e-4], [2.0, 1e-3], [1.0, 2e-2]];

/// The error grows where hills are short against the rim, as [`Disc`] states.
#[test]
fn the_error_on_hills_grows_as_they_become_shorter() {
    for [radii, small] in HILLS {
        for slope in [0.1, 0.7] {
            let length = radii * RADIUS;
            let amplitude = slope * length / TAU;
            let hills = terrain(Waves { amplitude, length });
            compare_energy("hills", &hills, 0.05, [small; 2]);
        }
    }
}

/// The force is the gradient of the springs' energy, so that the springs are a true potential.
#[test]
fn the_force_is_the_gradient_of_the_energy_on_any_shape() {
    on_shapes!(compare_force);
}

fn compare_force(name: &str, ground: &impl SpringDamperGround, depth: f64, bounds: Bounds) {
    let step = 1e-6;
    let stepper = rim_on(ground);
    let scene = stepper.scene();
    let error_in = |state: State| {
        let energy_at = |shift: DVec3| {
            let mut moved = state;
            moved.position += shift;
            stepper.energy(&moved).springs
        };
        let along = |axis: DVec3| energy_at(axis * -step) - energy_at(axis * step);
        let gradient = DVec3::from_array(DVec3::AXES.map(along)) / (2.0 * step);
        let force = scene.load(&scene.motion(&state)).force;
        let error = (force - gradient).length() / force.length();
        (
            error,
            format!("{name}: {force} N, {gradient} N at {state:?}"),
        )
    };
    let poses = poses(ground, depth, POSES);
    are_small(poses.into_iter().map(error_in).collect(), bounds);
}

/// The limit that [`Disc`] states: under an upright rim that is nearer to the edge of a box than it
/// is deep, both ends of a short arc are nearest the top, and the piece between them the side.
#[test]
fn an_edge_under_a_short_arc_may_be_missed() {
    let half = DVec3::new(0.3, 0.5, 0.3);
    let (ground, depth) = (block(half), 1e-3);
    let stepper = rim_on(ground);
    let error_at = |turn: f64| {
        let place = DVec3::new(0.4 - 0.9 * depth, 0.05, half.z + RADIUS - depth);
        let state = State::at(place).with_rotation_vector(DVec3::X * turn);
        let force = stepper.scene().load(&stepper.scene().motion(&state)).force;
        let sum = summed_force(&ground, &state);
        (force - sum).length() / sum.length()
    };
    let worst = (0..40_u8).map(|turn| error_at(f64::from(turn) * 0.04));
    let worst = worst.fold(0.0, f64::max);
    assert!((0.1..0.5).contains(&worst), "{worst}");
}

/// Force of the springs on a rim by the midpoint rule with many points, N.
fn summed_force(ground: &impl SpringDamperGround, state: &State) -> DVec3 {
    let count = 100_000_u32;
    let force_at = |number: u32| {
        let angle = TAU * (f64::from(number) + 0.5) / f64::from(count);
        let arm = DVec3::new(0.0, angle.cos(), angle.sin()) * RADIUS;
        let surface = ground.surface(state.position + state.orientation * arm);
        surface.normal * ground.normal_force((-surface.gap).max(0.0), 0.0)
    };
    (0..count).map(force_at).sum::<DVec3>() * f64::from(POINTS) / f64::from(count)
}

/// Valley along x with a small hole under one point of a horizontal rim.
struct ValleyWithHole;

impl Shape for ValleyWithHole {
    fn surface(&self, point: DVec3) -> Surface {
        let normal = DVec3::new(0.0, -point.y.signum(), 2.0).normalize();
        let gap = if point.y > 0.999 * RADIUS {
            1.0
        } else {
            normal.dot(point)
        };
        Surface { gap, normal }
    }
}

/// The end of such an arc is also close behind its beginning, and both edges lie between.
#[test]
fn an_arc_along_almost_the_whole_rim_is_cut_at_edges() {
    let ground = Ground {
        law: SPRING,
        shape: ValleyWithHole,
    };
    let flat = State::at(DVec3::Z * -0.05).with_rotation_vector(DVec3::Y * (-PI / 2.0));
    let energy = rim_on(&ground).energy(&flat).springs;
    let sum = summed_energy(&ground, &flat);
    assert!((energy - sum).abs() < SMALL * sum, "{energy} J, {sum} J");
}

fn rim_on<'a>(ground: impl SpringDamperGround + 'a) -> Stepper<'a> {
    let disc = Disc::solid(1.0, RADIUS, POINTS.into());
    Stepper::new(disc).unwrap().with_ground(ground).unwrap()
}

/// Places (m) of a disc that falls on the edges of a block, and turns of it (rad).
const STARTS: [[f64; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [0.1, 0.2, 0.3],
    [-0.2, 0.4, 0.9],
    [0.15, -0.3, 2.0],
];

/// End of a disc that falls on the edges of a block without dampers, the energy that it lost, and
/// the energy that was removed as a numerical error, J.
fn fall_on_a_block([x, y, turn]: [f64; 3], friction: f64, time_step: f64) -> (State, [f64; 2]) {
    let mut state = State::at(DVec3::new(x, y, 0.75))
        .with_linear_velocity(DVec3::new(0.4, -0.4, -1.5))
        .with_rotation_vector(DVec3::new(0.5, 0.9, -0.3) + turn)
        .with_angular_momentum(DVec3::new(0.05, 0.2, -0.1));
    let friction = Coulomb {
        coefficient: friction,
        slip_speed: 1e-2,
    };
    let stepper = rim_on(block(DVec3::new(0.2, 0.6, 0.1)))
        .with_gravity(UniformGravity::down(GRAVITY))
        .and_then(|stepper| stepper.with_friction(friction))
        .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
        .unwrap();
    let before = stepper.energy(&state).total();
    let mut removed = 0.0;
    for _ in 0..whole(0.4 / time_step) {
        removed += stepper.step(&mut state).unwrap().energy_removed;
    }
    (state, [before - stepper.energy(&state).total(), removed])
}

/// Without friction and dampers no energy is lost at the edges, and the error is of order 2. (With
/// the arc of the plane under the lowest point, the loss did not depend on the step size.)
#[test]
fn an_edge_takes_no_energy() {
    for start in STARTS {
        let fine = fall_on_a_block(start, 0.0, 1e-3 / 64.0).0;
        let error_at = |time_step: f64| {
            let (end, [lost, removed]) = fall_on_a_block(start, 0.0, time_step);
            let energies = [lost.abs(), removed];
            assert!(
                energies.iter().all(|energy| *energy < 1e-7),
                "{time_step} s: {energies:?} J, started at {start:?}"
            );
            difference(&end, &fine)
        };
        let order = (error_at(1e-3) / error_at(1e-3 / 8.0)).log2() / 3.0;
        assert!((1.8..2.2).contains(&order), "{order} from {start:?}");
    }
}

/// With friction, energy decreases, and none of it is removed as a numerical error.
#[test]
fn with_friction_at_an_edge_no_energy_is_removed() {
    for start in STARTS {
        let (_, [lost, removed]) = fall_on_a_block(start, 0.4, 1e-3);
        assert!(lost > 0.1, "{lost} J from {start:?}");
        assert!(removed <= 1e-9 * lost, "{removed} J from {start:?}");
    }
}

/// Ground just below everything, whose normal changes from place to place, and which counts how
/// often it is asked.
struct AllEdges {
    count: Cell<u32>,
}

impl Shape for &AllEdges {
    fn surface(&self, point: DVec3) -> Surface {
        let count = self.count.get();
        self.count.set(count + 1);
        // Fractional parts of quadratic multiples of an irrational number are in no order.
        let (sin, cos) = (PI * (f64::from(count * count) * SQRT_2).fract()).sin_cos();
        let normal = DVec3::new(cos, 0.0, sin);
        let gap = 1e-6 + 1e-9 * point.z.abs();
        Surface { gap, normal }
    }
}

/// On ground that is all edges, a search down to 0.06° everywhere would take thousands of
/// evaluations.
#[test]
fn a_search_for_arcs_ends_after_a_bounded_number_of_evaluations() {
    let edges = AllEdges {
        count: Cell::new(0),
    };
    let stepper = rim_on(Ground {
        law: SPRING,
        shape: &edges,
    });
    edges.count.set(0);
    let springs = stepper.energy(&State::default()).springs;
    let count = edges.count.get();
    assert!(springs == 0.0 && (24..600).contains(&count), "{count}");
}
