//! The inputs that the checks try: extremes of the range first, then random ones that fill it and
//! are the same at every run and on every machine.
//!
//! Each part records the arguments that a check passes to it.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]
#![allow(clippy::float_cmp, reason = "a check tries its bounds themselves")]
#![allow(
    clippy::cast_possible_truncation,
    reason = "numbers of octaves and sectors are small"
)]

use core::cell::RefCell;

use tumble::body::ContactRange;
use tumble::contract::{
    CheckPlan, ForceRange, FrictionRange, GroundRange, check_body, check_force, check_friction,
    check_ground, check_integrator,
};
use tumble::glam::{DMat3, DVec3};
use tumble::integrator::Integrator;
use tumble::{
    AirDrag, ContactPoint, Coulomb, Cuboid, Dynamics, Ellipsoid, FlatGround, Force,
    FrictionJacobian, GroundBounds, MeanForce, Motion, RigidPointBody, Rk4, RollingResistance,
    SceneError, SlidingFriction, SpringDamperGround, State, Step, StepError, Surface, Wrench,
};

/// Random inputs of each check, enough for a fair count in eight octants.
const PLAN: CheckPlan = CheckPlan {
    seed: 5,
    cases: 400,
};

/// A part that records the arguments of its methods.
#[derive(Debug)]
struct Recorded<T> {
    part: T,
    calls: RefCell<Vec<(Method, Vec<f64>)>>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Method {
    Surface,
    SpringForce,
    NormalForce,
    MeanForce,
    Friction,
    Jacobian,
    Resistance,
    Wrench,
    Below,
    BelowNear,
    SupportPoint,
    Step,
}

impl<T> Recorded<T> {
    fn of(part: T) -> Self {
        Self {
            part,
            calls: RefCell::default(),
        }
    }

    fn record(&self, method: Method, arguments: impl IntoIterator<Item = f64>) {
        let call = (method, arguments.into_iter().collect());
        self.calls.borrow_mut().push(call);
    }

    /// Arguments of the calls of a method.
    fn arguments_of<const N: usize>(&self, method: Method) -> Vec<[f64; N]> {
        let calls = self.calls.borrow();
        let of_method = calls.iter().filter(|(called, _)| *called == method);
        of_method
            .map(|(_, arguments)| arguments.as_slice().try_into().unwrap())
            .collect()
    }

    /// FNV-1a over the bits of all arguments.
    fn hash(&self) -> u64 {
        let calls = self.calls.borrow();
        let words = calls
            .iter()
            .flat_map(|(method, arguments)| {
                let numbers = arguments.iter().map(|number| number.to_bits());
                core::iter::once(*method as u64).chain(numbers)
            })
            .flat_map(u64::to_le_bytes);
        words.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        })
    }
}

fn vector([x, y, z]: [f64; 3]) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Fails unless the directions are spread over the eight octants: in each at least half of an equal
/// share. Directions that leave out one octant fail.
fn assert_fill_octants(directions: &[DVec3]) {
    let mut counts = [0; 8];
    for direction in directions {
        let [x, y, z] = direction.to_array().map(|number| usize::from(number > 0.0));
        counts[4 * x + 2 * y + z] += 1;
    }
    let least = directions.len() / 16;
    assert!(counts.iter().all(|&count| count > least), "{counts:?}");
}

/// Fails unless the numbers reach both bounds, and none lies beyond them.
fn assert_span(numbers: impl Iterator<Item = f64> + Clone, from: f64, to: f64) {
    let least = numbers.clone().fold(f64::MAX, f64::min);
    let most = numbers.fold(f64::MIN, f64::max);
    assert!(least == from && most == to, "{least:e} to {most:e}");
}

/// Fails unless the logarithms of the numbers fill so many octaves below the largest number.
fn assert_fill_octaves(numbers: impl Iterator<Item = f64> + Clone, octaves: usize) {
    let most = numbers.clone().fold(f64::MIN, f64::max);
    let mut counts = vec![0; octaves];
    for number in numbers.filter(|&number| number > 0.0) {
        let octave = (most / number).log2().floor() as usize;
        if let Some(count) = counts.get_mut(octave) {
            *count += 1;
        }
    }
    assert!(counts.iter().all(|&count| count > 0), "{counts:?}");
}

// Ground.

impl<G: SpringDamperGround> SpringDamperGround for Recorded<G> {
    fn surface(&self, point: DVec3) -> Surface {
        self.record(Method::Surface, point.to_array());
        self.part.surface(point)
    }
    fn spring_force(&self, depth: f64) -> f64 {
        self.record(Method::SpringForce, [depth]);
        self.part.spring_force(depth)
    }
    fn spring_energy(&self, depth: f64) -> f64 {
        self.part.spring_energy(depth)
    }
    fn normal_force(&self, depth: f64, closing_speed: f64) -> f64 {
        self.record(Method::NormalForce, [depth, closing_speed]);
        self.part.normal_force(depth, closing_speed)
    }
    fn mean_force(&self, start: f64, end: f64, seconds: f64) -> MeanForce {
        self.record(Method::MeanForce, [start, end, seconds]);
        self.part.mean_force(start, end, seconds)
    }
    fn bounds(&self) -> GroundBounds {
        self.part.bounds()
    }
}

const GROUND: GroundRange = GroundRange {
    centre: DVec3::new(3.0, -2.0, 0.0),
    size: 2.0,
    depth: 0.05,
    speed: 5.0,
};

fn checked_ground() -> Recorded<FlatGround> {
    let ground = Recorded::of(FlatGround::level(1000.0, 0.5));
    check_ground(&ground, &GROUND, PLAN).unwrap();
    ground
}

#[test]
fn a_ground_is_tried_in_the_whole_region_and_no_farther() {
    let ground = checked_ground();
    let points = ground.arguments_of(Method::Surface).into_iter();
    let from_centre: Vec<_> = (points.map(vector))
        .map(|point| point - GROUND.centre)
        .collect();
    // A path from a point is a thousandth of the region long.
    let farthest = from_centre.iter().map(|path| path.abs().max_element());
    let farthest = farthest.fold(0.0, f64::max);
    assert!((2.0..2.002).contains(&farthest), "{farthest}");
    let away: Vec<_> = (from_centre.iter().copied())
        .filter(|path| path.z.abs() > 0.1)
        .collect();
    assert_fill_octants(&away);
    let distances = away.iter().map(|path| path.abs().max_element());
    assert!(distances.clone().filter(|&far| far > 1.0).count() > away.len() / 2);
    assert!(distances.filter(|&far| far < 1.0).count() > away.len() / 20);
}

#[test]
fn a_ground_is_tried_at_its_surface_below_and_above_it() {
    let ground = checked_ground();
    let heights: Vec<_> = (ground.arguments_of(Method::Surface).into_iter())
        .map(|[.., z]: [f64; 3]| z)
        .collect();
    for wanted in [0.0, -0.025, 0.025] {
        let count = heights.iter().filter(|&&z| (z - wanted).abs() < 1e-9);
        assert!(count.count() > 400, "{wanted}");
    }
}

#[test]
fn a_path_over_a_ground_leads_along_across_and_at_an_angle_to_the_normal() {
    let ground = checked_ground();
    let points: Vec<_> = (ground.arguments_of(Method::Surface).into_iter())
        .map(vector)
        .collect();
    let length = GROUND.size * f64::EPSILON.sqrt().sqrt();
    let mut counts = [0; 3];
    // Start, middle and end of a path are asked for one after the other.
    for path in points.windows(3) {
        let way = path[2] - path[0];
        let is_path = (way.length() / length - 1.0).abs() < 1e-9
            && (path[0] + path[2] - 2.0 * path[1]).length() < 1e-12;
        if is_path {
            let cosine = way.z / way.length();
            let kinds = [1.0, 0.0, 0.5_f64.sqrt()];
            let kind = kinds
                .iter()
                .position(|kind| (cosine.abs() - kind).abs() < 1e-9);
            counts[kind.unwrap()] += 1;
        }
    }
    assert!(
        counts
            .iter()
            .all(|&count| count == counts[0] && count > 1000),
        "{counts:?}"
    );
}

#[test]
fn a_law_is_tried_at_depths_and_speeds_of_all_sizes() {
    let ground = checked_ground();
    let pressed = ground.arguments_of(Method::NormalForce);
    let depths = pressed.iter().map(|&[depth, _]: &[f64; 2]| depth);
    assert!(depths.clone().all(|depth| depth > 0.0 && depth <= 0.05));
    assert!(depths.clone().any(|depth| depth == 0.05));
    assert_fill_octaves(depths, 39);
    let speeds = pressed.iter().map(|&[_, speed]| speed);
    assert_span(speeds.clone(), -5.0, 5.0);
    assert!(speeds.clone().any(|speed| speed == 0.0));
    assert_fill_octaves(speeds.clone(), 29);
    assert_fill_octaves(speeds.map(|speed| -speed), 29);
}

#[test]
fn a_mean_force_is_tried_on_paths_of_each_kind() {
    let ground = checked_ground();
    let paths = ground.arguments_of(Method::MeanForce);
    let ends = paths.iter().flat_map(|&[start, end, _]| [start, end]);
    assert_span(ends, -0.05, 0.05);
    let count = |is_kind: fn(f64, f64) -> bool| {
        let of_kind = paths.iter().filter(|[start, end, _]| is_kind(*start, *end));
        of_kind.count()
    };
    for (kind, found) in [
        (
            "into the ground",
            count(|start, end| start < 0.0 && end > 0.0),
        ),
        ("out of it", count(|start, end| start > 0.0 && end < 0.0)),
        ("deeper", count(|start, end| start > 0.0 && end > start)),
        ("less deep", count(|start, end| end > 0.0 && end < start)),
        ("above it", count(|start, end| start < 0.0 && end < 0.0)),
    ] {
        assert!(found > 60, "{kind}: {found}");
    }
    assert!(count(|start, end| start == end) > 20);
    let speeds = paths.iter().filter(|[start, end, _]| start != end);
    let speeds = speeds.map(|[start, end, seconds]| (end - start).abs() / seconds);
    assert!(speeds.clone().all(|speed| speed < 5.0 * (1.0 + 1e-12)));
    assert_fill_octaves(speeds, 19);
}

// Friction.

impl<F: SlidingFriction> SlidingFriction for Recorded<F> {
    fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
        self.part.force(normal_force, slip)
    }
    fn force_at(&self, position: DVec3, normal_force: f64, slip: DVec3) -> DVec3 {
        let place = position.to_array().into_iter();
        let arguments = place.chain([normal_force]).chain(slip.to_array());
        self.record(Method::Friction, arguments);
        self.part.force_at(position, normal_force, slip)
    }
    fn jacobian_at(&self, position: DVec3, normal_force: f64, slip: DVec3) -> FrictionJacobian {
        let place = position.to_array().into_iter();
        let arguments = place.chain([normal_force]).chain(slip.to_array());
        self.record(Method::Jacobian, arguments);
        self.part.jacobian_at(position, normal_force, slip)
    }
    fn depends_on_position(&self) -> bool {
        true
    }
    fn rolling_resistance(&self, normal_force: f64) -> Option<RollingResistance> {
        self.record(Method::Resistance, [normal_force]);
        self.part.rolling_resistance(normal_force)
    }
}

const FRICTION: FrictionRange = FrictionRange {
    centre: DVec3::new(1.0, 2.0, 3.0),
    size: 0.5,
    normal: DVec3::new(0.0, 3.0, 4.0),
    normal_force: 1e3,
    slip: 10.0,
};

fn checked_friction() -> Recorded<Coulomb> {
    let friction = Recorded::of(Coulomb {
        coefficient: 0.3,
        slip_speed: 1e-3,
    });
    check_friction(&friction, &FRICTION, PLAN).unwrap();
    friction
}

#[test]
fn a_friction_law_is_tried_at_loads_slips_and_places_of_the_whole_range() {
    let friction = checked_friction();
    // The force is evaluated there too, and beside for its differences.
    let calls: Vec<[f64; 7]> = friction.arguments_of(Method::Jacobian);
    assert!(friction.arguments_of::<7>(Method::Friction).len() > 4 * calls.len());
    let paths: Vec<_> = (calls.iter())
        .map(|&[x, y, z, ..]| (DVec3::new(x, y, z) - FRICTION.centre) / FRICTION.size)
        .collect();
    assert!(paths.iter().all(|path| path.abs().max_element() <= 1.0));
    assert!(paths.contains(&DVec3::ZERO) && paths.contains(&-DVec3::Y));
    // The random ones come last.
    assert_fill_octants(&paths[paths.len() - 400..]);

    let loads = calls.iter().map(|&[_, _, _, load, ..]| load);
    assert_span(loads.clone(), 0.0, 1e3);
    assert_fill_octaves(loads, 40);
    let slips = calls.iter().map(|&[.., x, y, z]| DVec3::new(x, y, z));
    let speeds = slips.clone().map(DVec3::length);
    assert!(speeds.clone().all(|speed| speed <= 10.0 * (1.0 + 1e-15)));
    assert!(speeds.clone().any(|speed| speed == 0.0));
    assert!(speeds.clone().any(|speed| speed > 10.0 * (1.0 - 1e-15)));
    assert_fill_octaves(speeds, 40);
}

#[test]
fn slips_lie_in_the_surface_in_all_its_directions() {
    let friction = checked_friction();
    let calls: Vec<[f64; 7]> = friction.arguments_of(Method::Jacobian);
    let slips: Vec<_> = (calls.iter())
        .map(|&[.., x, y, z]| DVec3::new(x, y, z))
        .collect();
    let normal = FRICTION.normal.normalize();
    let lifted = slips.iter().map(|slip| slip.dot(normal).abs());
    assert!((lifted.zip(&slips)).all(|(lifted, slip)| lifted <= 1e-15 * slip.length()));
    // The random ones, in parts of 30 degrees.
    let (along, across) = (DVec3::X, normal.cross(DVec3::X));
    let mut counts = [0; 12];
    for slip in &slips[slips.len() - 400..] {
        let turns = slip.dot(across).atan2(slip.dot(along)) / core::f64::consts::TAU;
        counts[(turns.rem_euclid(1.0) * 12.0) as usize % 12] += 1;
    }
    assert!(counts.iter().all(|&count| count > 400 / 24), "{counts:?}");
}

// Force.

impl<E: Force> Force for Recorded<E> {
    fn wrench(&self, motion: &Motion) -> Wrench {
        let rotated = motion.axes.to_world(DVec3::new(1.0, 2.0, 3.0));
        let vectors = [
            motion.position,
            rotated,
            motion.linear_velocity,
            motion.angular_velocity,
        ];
        self.record(
            Method::Wrench,
            vectors.into_iter().flat_map(|vector| vector.to_array()),
        );
        self.part.wrench(motion)
    }
    fn is_passive(&self) -> bool {
        self.part.is_passive()
    }
}

const FORCE: ForceRange = ForceRange {
    centre: DVec3::new(-1.0, 0.5, 2.0),
    size: 4.0,
    speed: 30.0,
    angular_speed: 200.0,
};

fn checked_force() -> Recorded<AirDrag> {
    let force = Recorded::of(AirDrag::linear(0.01));
    check_force(&force, &FORCE, PLAN).unwrap();
    force
}

#[test]
fn a_force_is_tried_at_all_places_poses_and_velocities() {
    let force = checked_force();
    let calls: Vec<[f64; 12]> = force.arguments_of(Method::Wrench);
    let part = |first: usize| {
        let vectors = calls.iter().map(move |call| &call[first..first + 3]);
        vectors.map(|part| DVec3::from_slice(part)).collect()
    };
    let [places, rotated, linear, angular]: [Vec<_>; 4] = [0, 3, 6, 9].map(part);
    let places: Vec<_> = (places.iter())
        .map(|place| (*place - FORCE.centre) / FORCE.size)
        .collect();
    assert!(places.iter().all(|place| place.abs().max_element() <= 1.0));
    assert_fill_octants(&places);
    assert_fill_octants(&rotated);
    for (velocities, most) in [(&linear, 30.0), (&angular, 200.0)] {
        // The velocities of the test of continuity are changed a little.
        let speeds = velocities.iter().map(|velocity| velocity.length());
        assert!(speeds.clone().all(|speed| speed <= most * 1.001));
        assert!(speeds.clone().any(|speed| speed == 0.0));
        assert_fill_octaves(speeds, 19);
        let random = &velocities[velocities.len() - 800..];
        assert_fill_octants(random);
    }
    let cosines = linear.iter().zip(&angular).filter(|(linear, angular)| {
        let product = linear.length() * angular.length();
        product > 1e-3 && linear.dot(**angular) > 0.999_999 * product
    });
    let aligned = cosines.count();
    assert!((100..1000).contains(&aligned), "{aligned}");
}

// Bodies.

impl<B: RigidPointBody> RigidPointBody for Recorded<B> {
    fn mass(&self) -> f64 {
        self.part.mass()
    }
    fn inertia(&self) -> DMat3 {
        self.part.inertia()
    }
    fn contacts(&self) -> &[ContactPoint] {
        self.part.contacts()
    }
    fn bounding_radius(&self) -> f64 {
        self.part.bounding_radius()
    }
    fn contacts_below(&self, normal: DVec3, offset: f64) -> ContactRange {
        let arguments = normal.to_array().into_iter().chain([offset]);
        self.record(Method::Below, arguments);
        self.part.contacts_below(normal, offset)
    }
    fn contacts_below_near(&self, normal: DVec3, offset: f64, near: ContactRange) -> ContactRange {
        let known = [near.first as f64, near.count as f64];
        let arguments = normal.to_array().into_iter().chain([offset]).chain(known);
        self.record(Method::BelowNear, arguments);
        self.part.contacts_below_near(normal, offset, near)
    }
    fn is_smooth(&self) -> bool {
        self.part.is_smooth()
    }
    fn support_point(&self, towards: DVec3) -> DVec3 {
        self.record(Method::SupportPoint, towards.to_array());
        self.part.support_point(towards)
    }
}

#[test]
fn a_body_is_cut_by_planes_of_all_directions_and_offsets() {
    let body = Recorded::of(Cuboid::solid(2.0, DVec3::new(0.3, 0.2, 0.1)));
    check_body(&body, PLAN).unwrap();
    let planes: Vec<[f64; 4]> = body.arguments_of(Method::Below);
    let normals: Vec<_> = (planes.iter())
        .map(|&[x, y, z, _]| DVec3::new(x, y, z))
        .collect();
    assert!(normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-15));
    assert_fill_octants(&normals);
    let radius = body.part.bounding_radius();
    let offsets = planes.iter().map(|&[.., offset]| offset / radius);
    for below in [-1.0, -0.5, 0.0, 0.5] {
        let range = below..below + 0.5;
        let count = offsets.clone().filter(|offset| range.contains(offset));
        assert!(count.count() > planes.len() / 20, "{below}");
    }
    // Planes through a contact, a little above or below it.
    let contacts = body.part.contacts().to_vec();
    let through = planes.iter().filter(|[x, y, z, offset]| {
        let heights = contacts
            .iter()
            .map(|contact| contact.position.dot(DVec3::new(*x, *y, *z)));
        heights
            .clone()
            .any(|height| (height - offset).abs() < 1e-12)
    });
    assert!(through.count() > planes.len() / 10);
    assert!(body.arguments_of::<6>(Method::BelowNear).len() > planes.len());
}

#[test]
fn a_smooth_body_is_asked_for_its_support_in_all_directions() {
    let body = Recorded::of(Ellipsoid::solid(2.0, DVec3::new(0.3, 0.2, 0.1)));
    check_body(&body, PLAN).unwrap();
    let towards: Vec<_> = (body.arguments_of(Method::SupportPoint).into_iter())
        .map(vector)
        .collect();
    assert_fill_octants(&towards);
}

// Integrators.

impl<I: Integrator> Integrator for Recorded<I> {
    type Workspace = I::Workspace;

    fn step<D: Dynamics>(
        &self,
        scene: &D,
        state: &mut State,
        limit: f64,
        workspace: &mut I::Workspace,
    ) -> Result<Step, StepError> {
        let vectors = [
            state.position,
            state.linear_velocity,
            state.angular_momentum,
        ];
        let numbers = vectors.into_iter().flat_map(|vector| vector.to_array());
        let turn = state.orientation.to_array();
        let of_scene = [
            scene.inertia_properties().inverse_mass(),
            scene.bounding_radius(),
            scene.gravity().z,
        ];
        let arguments = numbers.chain(turn).chain([limit]).chain(of_scene);
        self.record(Method::Step, arguments);
        self.part.step(scene, state, limit, workspace)
    }
    fn order(&self) -> u32 {
        self.part.order()
    }
    fn clear(&self, workspace: &mut I::Workspace) {
        self.part.clear(workspace);
    }
    fn check(&self) -> Result<(), SceneError> {
        self.part.check()
    }
}

// Stored hashes. Those of the other checks are in `contract_reach`.

#[test]
fn the_inputs_of_a_smooth_body_and_of_an_integrator_are_the_stored_ones() {
    let ellipsoid = Recorded::of(Ellipsoid::solid(2.0, DVec3::new(0.3, 0.2, 0.1)));
    check_body(&ellipsoid, PLAN).unwrap();
    let integrator = Recorded::of(Rk4 { time_step: 1e-3 });
    check_integrator(&integrator, CheckPlan { cases: 20, ..PLAN }).unwrap();
    // The inputs of an integrator contain the states that it reaches.
    let hashes = [ellipsoid.hash(), integrator.hash()];
    let stored = [0xd3b8_8faf_7c1a_3858, 0x4e4c_8b46_3797_aebb];
    assert_eq!(hashes, stored, "{hashes:#x?}");
}
