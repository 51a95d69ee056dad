//! Common parts of the property tests: ranges of input, bodies of several kinds, and each
//! integrator.

// Each test program uses another part of it.
#![allow(dead_code, unused_imports, unused_macros)]
// A test helper that fails ends its test.
#![allow(clippy::unwrap_used, clippy::panic)]

pub(crate) mod counting;
pub(crate) mod erased;
pub(crate) mod once;
pub(crate) mod page;
pub(crate) mod rigid;
pub(crate) mod statistics;

use erased::Stepper;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use tumble::glam::{DMat3, DQuat, DVec3};
use tumble::{
    AnyIntegrator, Coin, ContactPoint, FlatGround, ForwardEuler, Integrator, Nystrom, PointCloud,
    RigidPointBody, Rk4, SlidingFriction, State, StrangSplitting, SymplecticEuler, UniformGravity,
};

/// `cases` random inputs, the same in every run of the tests. `PROPTEST_CASES` and
/// `PROPTEST_RNG_SEED` ask for more and for others.
///
/// A property that holds for all of them fails for at most
/// [`failing_at_most`](statistics::failing_at_most) of the inputs that are drawn from, with 95 %
/// confidence: 10 % after 30 cases, 3 % after 100, 1 % after 300. A test claims no more than that.
pub(crate) fn cases(cases: u32) -> ProptestConfig {
    let asked = ProptestConfig::default();
    ProptestConfig {
        cases: if asked.cases == 256 {
            cases
        } else {
            asked.cases
        },
        rng_seed: match asked.rng_seed {
            RngSeed::Random => RngSeed::Fixed(0x7_0b1e),
            fixed => fixed,
        },
        failure_persistence: None,
        ..asked
    }
}

/// Returns true if `PROPTEST_CASES` or `PROPTEST_RNG_SEED` selects other inputs than those of a
/// stored result.
pub(crate) fn asks_for_other_draws() -> bool {
    let asked = ProptestConfig::default();
    asked.cases != 256 || !matches!(asked.rng_seed, RngSeed::Random)
}

/// Explicit integrators of one time step, with their names.
pub(crate) fn explicit_methods(time_step: f64) -> [(AnyIntegrator, &'static str); 5] {
    [
        (ForwardEuler { time_step }.into(), "ForwardEuler"),
        (SymplecticEuler { time_step }.into(), "SymplecticEuler"),
        (StrangSplitting { time_step }.into(), "StrangSplitting"),
        (Rk4 { time_step }.into(), "Rk4"),
        (Nystrom { time_step }.into(), "Nystrom"),
    ]
}

/// The same method with another step size (s), if its step size is fixed.
pub(crate) fn with_time_step(mut method: AnyIntegrator, time_step: f64) -> AnyIntegrator {
    match &mut method {
        AnyIntegrator::ForwardEuler(ForwardEuler { time_step: own })
        | AnyIntegrator::SymplecticEuler(SymplecticEuler { time_step: own })
        | AnyIntegrator::StrangSplitting(StrangSplitting { time_step: own })
        | AnyIntegrator::Rk4(Rk4 { time_step: own })
        | AnyIntegrator::Nystrom(Nystrom { time_step: own }) => *own = time_step,
        other => panic!("{other} has no fixed step, or is not explicit"),
    }
    method
}

/// Runs a block with each explicit integrator of one time step, by value and by name.
macro_rules! each_explicit {
    ($time_step:expr, |$integrator:ident, $name:ident| $block:block) => {
        for ($integrator, $name) in $crate::kit::explicit_methods($time_step) {
            $block
        }
    };
}
pub(crate) use each_explicit;

/// Runs a block with each integrator of one time step, by value and by name.
macro_rules! each_method {
    ($time_step:expr, |$integrator:ident, $name:ident| $block:block) => {{
        let time_step = $time_step;
        let implicit = tumble::EnergyMomentum { time_step }.into();
        let explicit = $crate::kit::explicit_methods(time_step);
        for ($integrator, $name) in explicit.into_iter().chain([(implicit, "EnergyMomentum")]) {
            $block
        }
    }};
}
pub(crate) use each_method;

/// Numbers whose logarithm is spread evenly.
pub(crate) fn log_uniform(low: f64, high: f64) -> impl Strategy<Value = f64> + Clone {
    (low.ln()..high.ln()).prop_map(f64::exp)
}

/// 0 in one case of eight, else numbers whose logarithm is spread evenly.
pub(crate) fn zero_or(low: f64, high: f64) -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 7 => log_uniform(low, high)]
}

/// Unit vectors: the axes among them.
pub(crate) fn directions() -> impl Strategy<Value = DVec3> {
    let component = || -1.0..1.0;
    let any = (component(), component(), component())
        .prop_map(|(x, y, z)| DVec3::new(x, y, z))
        .prop_filter("a direction has a length", |v| v.length() > 0.1)
        .prop_map(DVec3::normalize);
    let axes = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Z];
    prop_oneof![1 => prop::sample::select(axes.to_vec()), 4 => any]
}

/// Rotations from body to world axes: none, half a revolution, any.
pub(crate) fn orientations() -> impl Strategy<Value = DQuat> {
    let angle = prop_oneof![Just(0.0), Just(core::f64::consts::PI), -3.2..3.2_f64];
    (directions(), angle).prop_map(|(axis, angle)| DQuat::from_axis_angle(axis, angle))
}

/// A body of any shape and size, with the words that a failing test prints for it.
pub(crate) struct AnyBody {
    name: String,
    body: Box<dyn RigidPointBody>,
}

impl core::fmt::Debug for AnyBody {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(&self.name)
    }
}

impl core::ops::Deref for AnyBody {
    type Target = dyn RigidPointBody;
    fn deref(&self) -> &Self::Target {
        &*self.body
    }
}

impl AnyBody {
    /// Positions of the contacts, m, body axes.
    pub(crate) fn places(&self) -> Vec<DVec3> {
        self.contacts()
            .iter()
            .map(|contact| contact.position)
            .collect()
    }

    fn ring(count: usize, mass: f64, radius: f64) -> Self {
        let points = vec![ContactPoint::default(); count];
        Self {
            name: format!("a ring of {count} points, {mass:e} kg, {radius:e} m"),
            body: Box::new(Coin::ring_with_storage(points, mass, radius)),
        }
    }

    fn cloud(kind: &str, places: impl Iterator<Item = DVec3>, masses: Vec<f64>) -> Self {
        let points: Vec<_> = places.map(ContactPoint::bare).collect();
        Self {
            name: format!("{kind} of {points:?} with masses {masses:?}"),
            body: Box::new(PointCloud::with_storage(points, &masses).unwrap()),
        }
    }
}

/// Rings of 3 to 200 points, clouds of 2 to 11, rods, and single points; from a crumb to a house.
pub(crate) fn bodies() -> impl Strategy<Value = AnyBody> {
    let size = || log_uniform(1e-4, 10.0);
    let mass = || log_uniform(1e-6, 1e4);
    let component = || -1.0..1.0_f64;
    let place = (component(), component(), component()).prop_map(DVec3::from);
    let places = prop::collection::vec((place, 0.1..1.0_f64), 2..12);
    let ring = (3..=200_usize, mass(), size())
        .prop_map(|(count, mass, radius)| AnyBody::ring(count, mass, radius));
    let cloud = (places, mass(), size()).prop_map(|(points, mass, size)| {
        let (places, shares): (Vec<_>, Vec<_>) = points.into_iter().unzip();
        let masses = shares.iter().map(|share| share * mass).collect();
        AnyBody::cloud("a cloud", places.into_iter().map(|p| p * size), masses)
    });
    let rod = (2..9_usize, directions(), mass(), size()).prop_map(|(count, along, mass, size)| {
        let places = (0..count).map(|i| along * (i as f64 * size));
        AnyBody::cloud("a rod", places, vec![mass; count])
    });
    let point = mass()
        .prop_map(|mass| AnyBody::cloud("a point", core::iter::once(DVec3::ZERO), vec![mass]));
    prop_oneof![4 => ring, 4 => cloud, 1 => rod, 1 => point]
}

/// A body of any inertia, with contacts anywhere.
#[derive(Clone, Debug)]
pub(crate) struct Solid {
    pub(crate) mass: f64,
    pub(crate) inertia: DMat3,
    pub(crate) contacts: Vec<ContactPoint>,
}

impl Solid {
    /// Mass 1 kg, these principal moments about x, y and z (kg m²), and no contacts.
    pub(crate) fn with_moments(moments: DVec3) -> Self {
        Self {
            mass: 1.0,
            inertia: DMat3::from_diagonal(moments),
            contacts: Vec::new(),
        }
    }
}

impl RigidPointBody for Solid {
    fn mass(&self) -> f64 {
        self.mass
    }
    fn inertia(&self) -> DMat3 {
        self.inertia
    }
    fn contacts(&self) -> &[ContactPoint] {
        &self.contacts
    }
}

/// A number without what stands after its point.
pub(crate) fn whole(number: f64) -> usize {
    // A test's own count, small and above 0.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    {
        number as usize
    }
}

/// A single point mass, kg.
pub(crate) fn point_mass(mass: f64) -> PointCloud<f64, [ContactPoint; 1]> {
    PointCloud::new([DVec3::ZERO], [mass]).unwrap()
}

/// Angle of the rotation between two orientations, rad.
pub(crate) fn angle_between(a: DQuat, b: DQuat) -> f64 {
    // The arcsine of the vector part keeps the digits that the arccosine of the scalar part loses
    // at small angles.
    let turn = a.conjugate() * b;
    2.0 * turn.xyz().length().min(1.0).asin()
}

/// Measured order of convergence: the slope from errors at a step and at half of it.
pub(crate) fn order(coarse: f64, fine: f64) -> f64 {
    (coarse / fine).log2()
}

/// Largest difference of two states, over their numbers in m, m/s, rad and kg m²/s.
pub(crate) fn difference(a: &State, b: &State) -> f64 {
    [
        (a.position - b.position).length(),
        (a.linear_velocity - b.linear_velocity).length(),
        angle_between(a.orientation, b.orientation),
        (a.angular_momentum - b.angular_momentum).length(),
    ]
    .into_iter()
    .fold(0.0, larger)
}

/// The larger of two numbers, or NaN if one is NaN, which no bound then accepts.
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

/// m/s².
pub(crate) const GRAVITY: f64 = 9.8;

/// State of a body after some seconds on level ground.
pub(crate) fn end<B: RigidPointBody, F: SlidingFriction>(
    body: B,
    (ground, friction): (FlatGround, F),
    integrator: impl Integrator,
    start: &State,
    seconds: f64,
) -> State {
    let mut state = *start;
    Stepper::new(body)
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(GRAVITY)))
        .and_then(|stepper| stepper.with_ground(ground))
        .and_then(|stepper| stepper.with_friction(friction))
        .and_then(|stepper| stepper.with_integrator(integrator))
        .unwrap()
        .advance(&mut state, seconds)
        .unwrap();
    state
}
