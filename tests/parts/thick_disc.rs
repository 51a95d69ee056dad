//! A coin with two round rims, and bodies of a user's with more of them.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use core::f64::consts::{FRAC_PI_2, TAU};
use core::ops::ControlFlow;

use crate::kit::erased::Stepper;
use crate::kit::{GRAVITY, cases, difference, directions, end, log_uniform, order, orientations};
use proptest::prelude::*;
use tumble::contract::{CheckPlan, check_body};
use tumble::f64::{Rim, State, ThickDisc};
use tumble::glam::{DMat3, DQuat, DVec3};
use tumble::{
    AdaptiveEnergyMomentum, CoinFace, ContactPoint, Coulomb, DormandPrince54, Dynamics,
    EnergyMomentum, FlatGround, Flight, Frictionless, Integrator, Nystrom, Plane, RigidPointBody,
    Rk4, Sample, SceneQuery, SmoothCoulomb, SolidCoin, StrangSplitting, UniformGravity,
};

const RADIUS: f64 = 0.5;
const THICKNESS: f64 = 0.3;

/// A scene of any body.
macro_rules! scene {
    ($body:expr, $ground:expr, $friction:expr, $integrator:expr) => {
        Stepper::builder($body)
            .gravity(UniformGravity::down(GRAVITY))
            .ground($ground)
            .friction($friction)
            .integrator($integrator)
            .build()
            .unwrap()
    };
}

fn disc() -> ThickDisc {
    ThickDisc::solid(1.0, RADIUS, THICKNESS, 120)
}

/// Height of the centre of mass over the lowest point at a lean (rad) from upright, m.
fn height(lean: f64) -> f64 {
    RADIUS * lean.cos() + 0.5 * THICKNESS * lean.sin().abs()
}

/// A state that leans by an angle (rad), with its lowest point at this depth in the ground (m).
fn leaning(lean: f64, depth: f64) -> State {
    State::at(DVec3::Z * (height(lean) - depth)).with_rotation_vector(DVec3::Y * lean)
}

// -----------------------------------------------------------------------------------------------
// The body
// -----------------------------------------------------------------------------------------------

#[test]
fn it_is_a_solid_cylinder() {
    let (mass, r, h) = (2.0, 0.3, 0.7);
    let coin = ThickDisc::solid(mass, r, h, 60);
    let (along, across) = (mass * r * r / 2.0, mass * (3.0 * r * r + h * h) / 12.0);
    let expected = DMat3::from_diagonal(DVec3::new(along, across, across));
    assert!((coin.inertia() - expected).abs_diff_eq(DMat3::ZERO, 1e-15));
    assert!((coin.bounding_radius() - r.hypot(h / 2.0)).abs() < 1e-15);
    assert_eq!((coin.radius(), coin.thickness()), (r, h));
    check_body(&coin, CheckPlan::default()).unwrap();
    check_body(
        &tumble::ThickDisc::solid(1e-3_f32, 0.01, 0.002, 7),
        CheckPlan::default(),
    )
    .unwrap();
}

#[test]
fn it_shows_heads_tails_or_the_edge_over_which_its_centre_of_mass_is() {
    // Over a rim at the lean atan(h/(2 r)).
    let corner = (THICKNESS / (2.0 * RADIUS)).atan();
    for (lean, face) in [
        (0.0, CoinFace::Edge),
        (corner - 1e-9, CoinFace::Edge),
        (-corner + 1e-9, CoinFace::Edge),
        (corner + 1e-9, CoinFace::Tails),
        (-corner - 1e-9, CoinFace::Heads),
        (-FRAC_PI_2, CoinFace::Heads),
    ] {
        assert_eq!(disc().face_up(&leaning(lean, 0.0)), face, "{lean}");
    }
}

#[test]
fn the_lowest_point_is_on_the_lower_rim_and_a_flight_ends_above_the_ground() {
    let by = Flight(DormandPrince54::new(1e-8));
    let stepper = scene!(disc(), FlatGround::level(1e5, 0.0), Frictionless, by);
    for lean in [-1.2, -0.4, 0.3, 1.1] {
        let lowest = |state: &State| {
            let motion = stepper.scene().motion(state);
            stepper
                .scene()
                .contact_model()
                .lowest_point(&motion)
                .unwrap()
        };
        let mut state = leaning(lean, -0.2);
        assert!((lowest(&state).gap - 0.2).abs() < 1e-15, "{lean}");
        assert_eq!(lowest(&state).index, usize::from(lean > 0.0), "{lean}");
        state = stepper.with_angular_velocity(state, DVec3::new(1.0, 9.0, -3.0));
        let mut stepped = state;
        let step = stepper.step(&mut state).unwrap();
        assert!(lowest(&state).gap >= 0.0, "{lean}: {}", lowest(&state).gap);
        // It falls for 0.2 to 0.3 s. A flight through the upper rim would end at once or never.
        assert!(
            (0.05..0.35).contains(&step.elapsed),
            "{lean}: {}",
            step.elapsed
        );
        stepper.advance(&mut state, 0.4 - step.elapsed).unwrap();
        let by_steps = scene!(disc(), FlatGround::level(1e5, 0.0), Frictionless, by.0);
        by_steps.advance(&mut stepped, 0.4).unwrap();
        let apart = difference(&state, &stepped);
        // After a touch-down the pair is off by some hundred tolerances.
        assert!(apart < 1e-5, "{lean}: {apart:e}");
    }
}

// -----------------------------------------------------------------------------------------------
// Force and energy
// -----------------------------------------------------------------------------------------------

/// Two rims as two bodies of one rim each.
fn one_rim(side: f64) -> Rimmed {
    let centre = DVec3::X * (side * 0.5 * THICKNESS);
    Rimmed {
        inertia: disc().inertia(),
        rims: vec![Rim::new(centre, DVec3::X, RADIUS, 120)],
    }
}

/// A body of 1 kg that is nothing but rims.
struct Rimmed {
    inertia: DMat3,
    rims: Vec<Rim>,
}

impl RigidPointBody for Rimmed {
    fn mass(&self) -> f64 {
        1.0
    }
    fn inertia(&self) -> DMat3 {
        self.inertia
    }
    fn contacts(&self) -> &[ContactPoint] {
        &[]
    }
    fn rims(&self) -> &[Rim] {
        &self.rims
    }
}

proptest! {
    #![proptest_config(cases(200))]

    /// Rims do not know of each other: load, energy and power of the losses are the sums of those
    /// of two bodies with one rim each, on level and tilted planes, in any motion.
    #[test]
    fn the_load_of_two_rims_is_the_sum_of_the_loads_of_each(
        orientation in orientations(), deep in -0.1..1.0_f64,
        slope in prop_oneof![Just(0.0), -0.3..0.3_f64],
        velocity in directions(), spin in directions(), speed in log_uniform(1e-3, 10.0),
    ) {
        let normal = DVec3::new(slope, 0.0, 1.0).normalize();
        let ground = FlatGround::level(1000.0, 0.5).on(Plane::through(DVec3::ZERO, normal));
        let friction = Coulomb { coefficient: 0.3, slip_speed: 1e-3 };
        let by = Rk4 { time_step: 1e-3 };
        let down = orientation.inverse() * -normal;
        let state = State { orientation, ..State::at(normal * (disc().support(down) - deep)) }
            .with_linear_velocity(velocity * speed)
            .with_angular_momentum(spin * (0.1 * speed));
        let both = scene!(disc(), ground, friction, by);
        let motion = both.scene().motion(&state);
        let (whole, springs) = (both.scene().load(&motion), both.energy(&state).springs);
        let parts = [-1.0, 1.0].map(|side| {
            let one = scene!(one_rim(side), ground, friction, by);
            (one.scene().load(&motion), one.energy(&state).springs)
        });
        let [(a, stored_a), (b, stored_b)] = parts;
        let scale = whole.force.length() + 1e-9;
        prop_assert!((whole.force - a.force - b.force).length() < 1e-12 * scale);
        prop_assert!((whole.torque - a.torque - b.torque).length() < 1e-12 * scale);
        prop_assert!((springs - stored_a - stored_b).abs() <= 1e-13 * springs);
        prop_assert_eq!(whole.touching, a.touching + b.touching);
    }
}

/// A rigid displacement of a state by a shift (m) and a rotation vector (rad).
fn moved(state: &State, shift: DVec3, turn: DVec3) -> State {
    let mut moved = *state;
    moved.position += shift;
    moved.orientation = DQuat::from_scaled_axis(turn) * state.orientation;
    moved
}

proptest! {
    #![proptest_config(cases(200))]

    /// The springs of both rims are one potential: along any motion it loses what the load does.
    #[test]
    fn the_force_is_the_gradient_of_the_energy(
        orientation in orientations(), deep in -0.1..1.0_f64,
        shift in directions(), turn in directions(),
    ) {
        let (ground, by) = (FlatGround::level(1000.0, 0.0), Rk4 { time_step: 1e-3 });
        let stepper = scene!(disc(), ground, Frictionless, by);
        let down = orientation.inverse() * -DVec3::Z;
        let state = State { orientation, ..State::at(DVec3::Z * (disc().support(down) - deep)) };
        let rates = stepper.scene().rates(&state);
        let power = (rates.acceleration + DVec3::Z * GRAVITY).dot(shift) + rates.torque.dot(turn);
        let h = 1e-5;
        let springs = |h: f64| stepper.energy(&moved(&state, shift * h, turn * h)).springs;
        let slope = (springs(h) - springs(-h)) / (2.0 * h);
        // Central differences, as for one rim; here 240 points.
        let scale = 240_000.0 * RADIUS * RADIUS;
        prop_assert!((slope + power).abs() < 1e-6 * scale, "{} {}", slope, power);
    }
}

/// Distance between the end of a coin with `count` points on each rim and that of the round rims
/// after half a second, m: root mean square over starts that differ by a part of the distance
/// between two points.
fn apart(start: &State, count: usize) -> f64 {
    let friction = Coulomb {
        coefficient: 0.3,
        slip_speed: 1e-2,
    };
    let by = Rk4 { time_step: 2e-4 };
    let place = |body: &dyn RigidPointBody, points: f64, phase: f64| {
        let mut start = *start;
        start.orientation *= DQuat::from_rotation_x(phase * TAU / points);
        let laws = (FlatGround::level(120e3 / points, 0.0), friction);
        end(body, laws, by, &start, 0.5).position
    };
    let round = place(&disc(), 120.0, 0.0);
    let points = vec![ContactPoint::default(); 2 * count];
    let coin = SolidCoin::new_with_storage(points, 1.0, RADIUS, THICKNESS);
    let phases = [0.1, 0.35, 0.6, 0.85];
    let squares = phases.map(|phase| place(&coin, count as f64, phase).distance_squared(round));
    (squares.iter().sum::<f64>() / 4.0).sqrt()
}

/// The sum over equally spaced points is the trapezoidal rule for the integral round each rim, of
/// second order in their distance. A `Disc` at the middle of the coin would be off by centimetres.
#[test]
fn points_on_both_rims_tend_to_the_round_rims_with_the_square_of_their_distance() {
    let rolling = |lean: f64, spin: DVec3| {
        leaning(lean, 1e-3)
            .with_linear_velocity(DVec3::NEG_Y * 2.0)
            .with_angular_momentum(disc().inertia() * spin)
    };
    for (name, start) in [
        ("on one rim", rolling(0.4, DVec3::X * 4.0)),
        ("on both rims", rolling(0.0, DVec3::new(4.0, 0.0, 0.3))),
        (
            "onto its face",
            leaning(1.2, 0.0).with_angular_momentum(DVec3::new(0.0, 0.02, 0.1)),
        ),
    ] {
        let (few, many) = (apart(&start, 300), apart(&start, 2400));
        println!("{name}: {few:.1e} m, {many:.1e} m");
        // A factor of 64, of which the scatter of the starts may take a half.
        assert!(many < few / 30.0, "{name}: {few:e} {many:e}");
    }
}

// -----------------------------------------------------------------------------------------------
// Rolling on one rim
// -----------------------------------------------------------------------------------------------

/// A cylinder of 1 kg, radius 0.5 m and thickness `2 c` that rolls on one rim at a constant lean.
///
/// Let α be the angle of its faces to the ground, n the unit vector along its axis towards the
/// lower rim, and u the steepest direction in its faces, upwards. In axes that precess, with x in
/// the plane of n and z, `u = (cos α, 0, sin α)` and `n = (sin α, 0, -cos α)`. The contact is at
/// `a = -r u + c n` from the centre of mass, and `ω = ω_n n + Ω sin α u`. So
///
/// ```text
/// v = -ω × a = -(r ω_n + c Ω sin α) e_y        F = m (Ω e_z × v) + m g e_z
/// dL/dt = Ω e_z × (A ω_n n + D Ω sin α u) = Ω sin α (A ω_n + D Ω cos α) e_y = a × F
/// ```
/// with the moments A about the axis and D about a diameter. The last equation gives ω_n. With
/// `c = 0` it is the equation of the thin disc (Routh, Advanced Rigid Dynamics, art. 244).
#[derive(Clone, Copy)]
struct Rolling {
    alpha: f64,
    /// Rate of precession, rad/s.
    rate: f64,
    half: f64,
}

impl Rolling {
    fn spin(&self) -> f64 {
        let (sin, cos) = self.alpha.sin_cos();
        let (r, c, rate) = (RADIUS, self.half, self.rate);
        let [along, across] = self.moments();
        let high = r * sin + c * cos;
        let weight = GRAVITY * (r * cos - c * sin);
        let turning = rate * rate * sin * (across * cos + c * high);
        (weight - turning) / (rate * (along * sin + r * high))
    }

    fn moments(&self) -> [f64; 2] {
        let (r, c) = (RADIUS, self.half);
        [r * r / 2.0, (3.0 * r * r + 4.0 * c * c) / 12.0]
    }

    fn speed(&self) -> f64 {
        RADIUS * self.spin() + self.half * self.rate * self.alpha.sin()
    }

    /// Rate of precession over the expected one, and the largest change of α (rad), in a second on
    /// a ground of this stiffness a point (N/m).
    fn measured(&self, stiffness: f64, time_step: f64) -> [f64; 2] {
        let (sin, cos) = self.alpha.sin_cos();
        let body = ThickDisc::solid(1.0, RADIUS, 2.0 * self.half, 120);
        let friction = Coulomb {
            coefficient: 1.0,
            slip_speed: 1e-2,
        };
        let stepper = scene!(
            body,
            FlatGround::level(stiffness, 0.0),
            friction,
            EnergyMomentum { time_step }
        );
        let depth = depth_at_rest(stiffness, sin);
        let high = RADIUS * sin + self.half * cos - depth;
        let start = State::at(DVec3::Z * high)
            .with_rotation_vector(DVec3::Y * (FRAC_PI_2 - self.alpha))
            .with_linear_velocity(DVec3::NEG_Y * self.speed());
        let (n, u) = (DVec3::new(sin, 0.0, -cos), DVec3::new(cos, 0.0, sin));
        let spin = n * self.spin() + u * (self.rate * sin);
        let mut state = stepper.with_angular_velocity(start, spin);
        let (mut heading, mut before, mut change) = (0.0, DVec3::X, 0.0_f64);
        let watch = &mut |sample: &Sample<'_>| {
            let axis = sample.state.orientation * DVec3::X;
            let level = DVec3::new(axis.x, axis.y, 0.0).normalize();
            heading += before.cross(level).z;
            before = level;
            change = change.max(((-axis.z).acos() - self.alpha).abs());
            ControlFlow::Continue(())
        };
        stepper.run(&mut state, 1.0, watch).unwrap();
        [heading / self.rate, change]
    }
}

/// Depth (m) at which an arc of a rim of 120 points carries 1 kg, with the sine of its angle to the
/// ground: `n S r s (sin α - α cos α)/π = m g` and `d = r s (1 - cos α)`, by bisection in the arc's
/// half angle α.
fn depth_at_rest(stiffness: f64, sine: f64) -> f64 {
    let per_angle = 120.0 * stiffness * RADIUS * sine / core::f64::consts::PI;
    let (mut low, mut high) = (0.0_f64, 1.5_f64);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if per_angle * (middle.sin() - middle * middle.cos()) < GRAVITY {
            low = middle;
        } else {
            high = middle;
        }
    }
    RADIUS * sine * (1.0 - low.cos())
}

/// On a hard ground the coin precesses at the rate of the rigid cylinder and keeps its lean. What
/// is left is the friction along an arc of a length in proportion to the root of the depth.
///
/// A thin disc with this lean and rate would spin at 1.5 times this rate or more: its rate of
/// precession with this spin differs by more than a tenth.
#[test]
fn on_one_rim_it_rolls_at_the_rate_of_the_rigid_cylinder() {
    for (degrees, rate, half) in [(60.0_f64, 1.0, 0.1), (70.0, 0.6, 0.05), (55.0, -0.8, 0.15)] {
        let rolling = Rolling {
            alpha: degrees.to_radians(),
            rate,
            half,
        };
        let thin = Rolling {
            half: 0.0,
            ..rolling
        };
        assert!((thin.spin() / rolling.spin() - 1.0).abs() > 0.1);
        let [soft, hard] = [(1e6, 2e-4), (1e8, 1e-4)].map(|(k, dt)| rolling.measured(k, dt));
        println!("{degrees}: {soft:?} {hard:?}");
        assert!((hard[0] - 1.0).abs() < 2e-3, "{degrees}: {hard:?}");
        assert!(hard[1] < 2e-3, "{degrees}: {hard:?}");
        assert!(
            (soft[0] - 1.0).abs() > 4.0 * (hard[0] - 1.0).abs(),
            "{degrees}: {soft:?} {hard:?}"
        );
    }
}

// -----------------------------------------------------------------------------------------------
// Rocking from rim to rim
// -----------------------------------------------------------------------------------------------

/// Fraction of the energy that a cylinder keeps as it rocks from one rim to the other, in the rigid
/// limit without a rebound.
///
/// It stands on its side and rocks in the plane of its axis, with the angle a from the centre of
/// mass to a rim, `tan a = h/(2 r)`. The impulse acts at the new contact, so the angular momentum
/// about that point stays:
///
/// ```text
/// (I + m R² cos 2a) ω₀ = (I + m R²) ω₁        I = m (3 r² + h²)/12 = m R² (3 + sin² a)/12
/// ω₁/ω₀ = 1 - 2 m R² sin² a/(I + m R²) = 1 - 24 sin² a/(15 + sin² a)
/// ```
/// A rectangular block, with `I = m R²/3`, has `1 - (3/2) sin² a` (Housner, Bulletin of the
/// Seismological Society of America 53, 1963).
fn kept_energy(a: f64) -> f64 {
    let square = a.sin() * a.sin();
    (1.0 - 24.0 * square / (15.0 + square)).powi(2)
}

/// The same fraction on a ground of a stiffness (N/m) and a hundredth of a second of damping a
/// point, for a coin that begins at rest at half of the angle a. The energy at a turning point θ is
/// `m g R (cos(a - θ) - cos a)` above that of the upright coin.
fn rocked(a: f64, stiffness: f64, time_step: f64) -> f64 {
    let (half, radius) = (0.1, 0.1 / a.tan());
    let body = ThickDisc::solid(1.0, radius, 2.0 * half, 60);
    // So strongly damped that no rim rebounds.
    let ground = FlatGround::level(stiffness, 0.1 * stiffness);
    let friction = Coulomb {
        coefficient: 20.0,
        slip_speed: 1e-5,
    };
    let stepper = scene!(body, ground, friction, EnergyMomentum { time_step });
    let corner = half.hypot(radius);
    let mut state =
        State::at(DVec3::Z * (corner * (0.5 * a).cos())).with_rotation_vector(DVec3::Y * (0.5 * a));
    let mut highest = 0.0;
    let watch = &mut |sample: &Sample<'_>| {
        let up = sample.state.orientation * DVec3::Z;
        let lean = -up.x.atan2(up.z);
        // Until it returns from the other side.
        if highest > 0.0 && lean < highest - 1e-4 {
            return ControlFlow::Break(());
        }
        highest = f64::max(highest, lean);
        ControlFlow::Continue(())
    };
    stepper
        .run(&mut state, 4.0 * (corner / GRAVITY).sqrt(), watch)
        .unwrap();
    let energy = |angle: f64| (a - angle).cos() - a.cos();
    energy(highest) / energy(0.5 * a)
}

#[test]
fn rocking_from_rim_to_rim_it_loses_the_energy_of_the_rigid_cylinder() {
    for degrees in [10.0_f64, 20.0, 30.0] {
        let a = degrees.to_radians();
        let expected = kept_energy(a);
        let error = |stiffness, time_step| (rocked(a, stiffness, time_step) / expected - 1.0).abs();
        let [soft, hard] = [error(1e5, 1e-4), error(1e7, 5e-5)];
        println!("{degrees}: {expected:.4}, {soft:.1e}, {hard:.1e}");
        // A block's fraction differs by 0.3 % at 10 degrees, 2.6 % at 20 and 6 % at 30.
        assert!(hard < 2.5e-3, "{degrees}: {hard:e}");
        assert!(hard < 0.1 * soft, "{degrees}: {soft:e} {hard:e}");
    }
}

// -----------------------------------------------------------------------------------------------
// The guarantees of `EnergyMomentum`
// -----------------------------------------------------------------------------------------------

/// Takes steps and asserts that the energy never increases. Returns the fraction of the steps that
/// needed a fallback.
fn follow(stepper: &Stepper, state: &mut State, steps: usize) -> f64 {
    let mut session = stepper.session(*state);
    let mut before = session.energy().total();
    let mut fallbacks = 0;
    for _ in 0..steps {
        let step = session.step().unwrap();
        let after = session.energy().total();
        assert!(after <= before, "{after} {before}");
        before = after;
        fallbacks += i32::from(step.fallback);
        let [x, y, z, w] = session.state().orientation.to_array();
        let excess = (w - 1.0) * (w + 1.0) + x * x + (y * y + z * z);
        assert!(excess.abs() < 9e-16, "{excess:e}");
    }
    *state = session.into_state();
    f64::from(fallbacks) / steps as f64
}

proptest! {
    #![proptest_config(cases(100))]

    /// Thrown in any way, on level and tilted planes, with soft and hard ground, short and long
    /// steps. Some starts are exactly flat on a face, and some exactly upright on both rims.
    #[test]
    fn the_energy_never_increases_and_the_body_stays_rigid(
        orientation in prop_oneof![
            4 => orientations(),
            1 => Just(DQuat::from_rotation_y(FRAC_PI_2)),
            1 => Just(DQuat::IDENTITY),
        ],
        radius in log_uniform(5e-3, 1.0), thickness in log_uniform(0.05, 3.0),
        soft in log_uniform(1e-7, 2e-2), ratio in prop_oneof![Just(0.0), 0.0..0.5_f64],
        coefficient in prop_oneof![Just(0.0), 0.05..0.8_f64], step in log_uniform(3e-3, 0.5),
        slope in prop_oneof![3 => Just(0.0), 1 => -0.3..0.3_f64], spin in directions(),
    ) {
        let time = (radius / GRAVITY).sqrt();
        let stiffness = GRAVITY / (soft * radius) / 10.0;
        let ground = FlatGround::level(stiffness, ratio * stiffness.sqrt())
            .on(Plane::through(DVec3::ZERO, DVec3::new(slope, 0.0, 1.0)));
        let friction = Coulomb { coefficient, slip_speed: 1e-3 * radius / time };
        let body = ThickDisc::solid(1.0, radius, radius * thickness, 60);
        let start = State { orientation, ..State::at(DVec3::Z * (radius * (1.0 + thickness))) };
        let stepper = scene!(body, ground, friction, EnergyMomentum { time_step: step * time });
        let mut state = stepper.with_angular_velocity(start, spin * (2.0 / time));
        follow(&stepper, &mut state, 400);
    }
}

#[test]
fn the_energy_never_increases_in_single_precision() {
    for number in 0..40_u8 {
        let part = f32::from(number);
        let body = tumble::ThickDisc::solid(1.0_f32, 0.5, 0.1 + 0.02 * part, 60);
        let stepper = Stepper::builder(body)
            .gravity(UniformGravity::down(9.8_f32))
            .ground(FlatGround::level(
                10_f32.powi(i32::from(number % 6)) * 100.0,
                0.3,
            ))
            .friction(Coulomb {
                coefficient: 0.3_f32,
                slip_speed: 1e-3,
            })
            .integrator(EnergyMomentum {
                time_step: 1e-3_f32 * (1.0 + part),
            })
            .build()
            .unwrap();
        let spin = tumble::glam::Vec3::new(0.3 * part, 2.0, -1.0);
        let start = tumble::f32::State::at(tumble::glam::Vec3::Z);
        let start = start.with_rotation_vector(tumble::glam::Vec3::Y * (0.1 * part));
        let mut state = stepper.with_angular_velocity(start, spin);
        let mut before = stepper.energy(&state).total();
        for _ in 0..1500 {
            stepper.step(&mut state).unwrap();
            let after = stepper.energy(&state).total();
            assert!(after <= before, "{number}: {after} {before}");
            before = after;
        }
    }
}

/// Upright, each arc is `r δ` deep and `2 √(2 δ/r)` long, and carries half of the weight:
/// `m g/2 = (n S/2π) (4/3) δ √(2 δ/r)`. A lean θ changes the depths by `± h θ/2`. The arcs restore
/// with the slope of that load, the weight tips the coin: it stands if `δ < 3 h²/(8 r)`.
#[test]
fn it_stands_on_its_edge_up_to_the_depth_of_the_closed_form() {
    for (points, thickness, share) in [
        (6, 2e-3, 0.8),
        (60, 1e-3, 0.8),
        (6, 1e-3, 1.2),
        (60, 2e-3, 1.2),
    ] {
        let (mass, radius) = (0.005, 0.0106);
        let depth = share * 3.0 * thickness * thickness / (8.0 * radius);
        let arcs = points as f64 / TAU * (4.0 / 3.0) * depth * (2.0 * depth / radius).sqrt();
        let stiffness = 0.5 * mass * GRAVITY / arcs;
        let damping = 0.02 * stiffness * (depth / GRAVITY).sqrt();
        let friction = Coulomb {
            coefficient: 0.3,
            slip_speed: 1e-4,
        };
        let stepper = scene!(
            ThickDisc::solid(mass, radius, thickness, points),
            FlatGround::level(stiffness, damping),
            friction,
            EnergyMomentum { time_step: 1e-3 }
        );
        let mut state =
            State::at(DVec3::Z * (radius - depth)).with_rotation_vector(DVec3::Y * 2e-3);
        follow(&stepper, &mut state, 2_000);
        let lean = (state.orientation * DVec3::X).z.abs().asin();
        assert_eq!(
            lean < 0.1,
            share < 1.0,
            "{points} points at {share}: a lean of {lean}"
        );
    }
}

/// Both rims touch the ground flat, at different depths: a short and soft coin whose upper rim is
/// below the surface as well. Each carries `n S d`.
#[test]
fn it_rests_on_both_rims_at_once_on_soft_ground() {
    let body = ThickDisc::solid(1.0, RADIUS, 0.01, 120);
    let stiffness = 2.0; // N/m
    let ground = FlatGround::level(stiffness, 0.5);
    let friction = Coulomb {
        coefficient: 0.3,
        slip_speed: 1e-3,
    };
    let stepper = scene!(body, ground, friction, EnergyMomentum { time_step: 2e-3 });
    let mut state = State::at(DVec3::Z * 0.02)
        .with_rotation_vector(DVec3::Y * (FRAC_PI_2 - 0.02))
        .with_angular_momentum(DVec3::new(0.01, 0.02, 0.1));
    follow(&stepper, &mut state, 15_000);
    // n S (d + d + h) = m g with the middle at -(d + h/2).
    let middle = GRAVITY / (2.0 * 120.0 * stiffness);
    assert!(
        (state.position.z + middle).abs() < 1e-4 * middle,
        "{}",
        state.position.z
    );
    assert!(
        state.linear_velocity.length() < 1e-6,
        "{}",
        state.linear_velocity
    );
}

/// Rolling upright on both rims and flat on a face, few steps need a fallback, and on lossless
/// ground without friction none loses energy.
#[test]
fn steps_on_two_rims_are_solved() {
    let lossless = scene!(
        disc(),
        FlatGround::level(1000.0, 0.0),
        Frictionless,
        EnergyMomentum { time_step: 1e-3 }
    );
    let mut state = leaning(0.05, 1e-3)
        .with_linear_velocity(DVec3::NEG_Y * 2.0)
        .with_angular_momentum(DVec3::X * 0.5);
    let first = lossless.energy(&state).total();
    assert!(follow(&lossless, &mut state, 20_000) < 1e-3);
    let lost = 1.0 - lossless.energy(&state).total() / first;
    // Some units in the last place a step, one-sided: 2e4 × 2e-16 × 10.
    assert!(lost < 4e-11, "{lost:e}");
    let friction = Coulomb {
        coefficient: 0.3,
        slip_speed: 1e-3,
    };
    let rough = scene!(
        disc(),
        FlatGround::level(1000.0, 0.5),
        friction,
        EnergyMomentum { time_step: 1e-3 }
    );
    for (lean, spin) in [(0.0, DVec3::X * 0.5), (1.4, DVec3::new(0.0, 0.05, 0.3))] {
        let mut state = leaning(lean, 1e-3).with_angular_momentum(spin);
        let fallbacks = follow(&rough, &mut state, 5_000);
        assert!(fallbacks < 2e-2, "{lean}: {fallbacks}");
    }
}

// -----------------------------------------------------------------------------------------------
// Accuracy through touch-downs
// -----------------------------------------------------------------------------------------------

/// A coin that rolls and rocks from one rim to the other, so that each rim touches down several
/// times a second.
fn rocking_start() -> State {
    leaning(0.12, 1e-3)
        .with_linear_velocity(DVec3::NEG_Y * 1.5)
        .with_angular_momentum(DVec3::new(0.4, 0.0, 0.0))
}

fn smooth_laws() -> (FlatGround, SmoothCoulomb) {
    let friction = SmoothCoulomb {
        coefficient: 0.3,
        slip_speed: 0.3,
    };
    (FlatGround::level(1000.0, 0.0), friction)
}

/// The force of a rim that touches down grows with the power 3/2 of the depth, so that a fixed step
/// leaves an error of at most the order 5/2 there. Methods of order 2 keep theirs.
#[test]
fn explicit_orders_hold_while_it_rocks_from_rim_to_rim() {
    let start = rocking_start();
    let truth = end(disc(), smooth_laws(), Rk4 { time_step: 2e-5 }, &start, 1.0);
    fn error(by: impl Integrator, start: &State, truth: &State) -> f64 {
        difference(&end(disc(), smooth_laws(), by, start, 1.0), truth)
    }
    let fourth = |time_step| error(Rk4 { time_step }, &start, &truth);
    let nystrom = |time_step| error(Nystrom { time_step }, &start, &truth);
    let second = |time_step| error(StrangSplitting { time_step }, &start, &truth);
    let implicit = |time_step| error(EnergyMomentum { time_step }, &start, &truth);
    let pair = |by: &dyn Fn(f64) -> f64, dt: f64| order(by(dt), by(dt / 8.0)) / 3.0;
    let orders = [
        pair(&fourth, 4e-3),
        pair(&nystrom, 4e-3),
        pair(&second, 2e-3),
        pair(&implicit, 2e-3),
    ];
    println!("{orders:.2?}");
    assert!(orders[0] > 2.3 && orders[1] > 2.3, "{orders:?}");
    assert!((orders[2] - 2.0).abs() < 0.15, "{orders:?}");
    assert!((orders[3] - 2.0).abs() < 0.15, "{orders:?}");
}

#[test]
fn the_error_follows_the_tolerance_while_it_rocks_and_after_a_fall() {
    let laws = (
        FlatGround::level(1000.0, 0.5),
        Coulomb {
            coefficient: 0.3,
            slip_speed: 1e-2,
        },
    );
    let fall = leaning(0.7, -0.2).with_angular_momentum(DVec3::splat(0.2));
    // After a touch-down of a rim the pair leaves more than ten tolerances below 1e-5, also on a
    // thin `Disc`.
    for (start, least) in [(rocking_start(), 1e-7), (fall, 1e-5)] {
        let truth = end(disc(), laws, Rk4 { time_step: 1e-5 }, &start, 0.8);
        let error = |end: State| end.position.distance(truth.position);
        for tolerance in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7] {
            let error = error(end(
                disc(),
                laws,
                DormandPrince54::new(tolerance),
                &start,
                0.8,
            ));
            let is_asked = tolerance >= least;
            assert!(
                !is_asked || error < 10.0 * tolerance,
                "{tolerance:e}: {error:e}"
            );
        }
        let error = error(end(
            disc(),
            laws,
            AdaptiveEnergyMomentum::new(1e-3),
            &start,
            0.8,
        ));
        assert!(error < 3e-3, "{error:e}");
    }
}

#[test]
fn f32_and_f64_agree_to_single_precision() {
    let wide = end(
        disc(),
        smooth_laws(),
        EnergyMomentum { time_step: 1e-3 },
        &rocking_start(),
        0.5,
    );
    let stepper = Stepper::builder(tumble::ThickDisc::solid(1.0_f32, 0.5, 0.3, 120))
        .gravity(UniformGravity::down(9.8_f32))
        .ground(FlatGround::level(1000.0_f32, 0.0))
        .friction(SmoothCoulomb {
            coefficient: 0.3_f32,
            slip_speed: 0.3,
        })
        .integrator(EnergyMomentum {
            time_step: 1e-3_f32,
        })
        .build()
        .unwrap();
    let start = rocking_start();
    let mut state = tumble::f32::State::at(start.position.as_vec3())
        .with_rotation_vector(tumble::glam::Vec3::Y * 0.12)
        .with_linear_velocity(start.linear_velocity.as_vec3())
        .with_angular_momentum(start.angular_momentum.as_vec3());
    stepper.advance(&mut state, 0.5).unwrap();
    let apart = state.position.as_dvec3().distance(wide.position);
    // 500 steps that each round a position of 0.5 m by 3e-8 m.
    assert!(apart < 1e-4, "{apart:e}");
}

// -----------------------------------------------------------------------------------------------
// More than two rims
// -----------------------------------------------------------------------------------------------

/// A stepped wheel: a wide rim between two narrow ones, and eight rims round one another.
fn several_rims() -> [Rimmed; 2] {
    let inertia = DMat3::from_diagonal(DVec3::new(0.12, 0.08, 0.08));
    let rim = |x: f64, radius: f64| Rim::new(DVec3::X * x, DVec3::X, radius, 40);
    let rings = (1..=8).map(|i| rim(0.0, 0.0625 * f64::from(i)));
    [
        Rimmed {
            inertia,
            rims: vec![rim(-0.2, 0.2), rim(0.0, 0.5), rim(0.2, 0.2)],
        },
        Rimmed {
            inertia,
            rims: rings.collect(),
        },
    ]
}

/// A body of a user's with three rims, or with eight that touch all at once: thrown, it comes to
/// rest, and flat on the ground all rims carry the same depth.
#[test]
fn a_body_of_a_user_may_have_up_to_eight_rims() {
    let friction = Coulomb {
        coefficient: 0.3,
        slip_speed: 1e-3,
    };
    for body in &several_rims() {
        check_body(body, CheckPlan::default()).unwrap();
        let stepper = scene!(
            body,
            FlatGround::level(1000.0, 0.5),
            friction,
            EnergyMomentum { time_step: 2e-3 }
        );
        let mut state = State::at(DVec3::Z * 0.6)
            .with_rotation_vector(DVec3::Y * 0.9)
            .with_angular_momentum(DVec3::new(0.2, 0.1, 0.1));
        follow(&stepper, &mut state, 10_000);
        if body.rims.len() == 8 {
            let depth = GRAVITY / (8.0 * 40.0 * 1000.0);
            assert!(
                (state.position.z + depth).abs() < 0.05 * depth,
                "{}",
                state.position.z
            );
        }
        assert!(
            state.linear_velocity.length() < 1e-3,
            "{}",
            state.linear_velocity
        );
    }
}

// -----------------------------------------------------------------------------------------------
// Rims beside contacts
// -----------------------------------------------------------------------------------------------

/// A wheel with a ball at the end of its axle, so far out that one of the two touches at a time.
struct WheelAndBall {
    rims: [Rim; 1],
    balls: [ContactPoint; 1],
}

impl WheelAndBall {
    fn new(points: usize) -> Self {
        let (position, radius) = (DVec3::X, 0.1);
        Self {
            rims: [Rim::new(DVec3::ZERO, DVec3::X, 0.5, points)],
            balls: [ContactPoint { position, radius }],
        }
    }
}

impl RigidPointBody for WheelAndBall {
    fn mass(&self) -> f64 {
        1.0
    }
    fn inertia(&self) -> DMat3 {
        DMat3::from_diagonal(DVec3::new(0.1, 0.15, 0.15))
    }
    fn contacts(&self) -> &[ContactPoint] {
        &self.balls
    }
    fn rims(&self) -> &[Rim] {
        &self.rims
    }
}

proptest! {
    #![proptest_config(cases(100))]

    /// The friction of a rim that spins on the spot reverses at its lowest point, and a step knows
    /// where. A later step, in which the rim is out of reach, must not.
    #[test]
    fn a_step_on_a_ball_does_not_depend_on_the_rim_of_the_step_before(
        points in 20..200_usize, spin in 0.3..3.0_f64, depth in 0.001..0.02_f64,
        slide in 0.01..1.0_f64, time_step in log_uniform(1e-4, 1e-2),
    ) {
        let friction = Coulomb { coefficient: 0.3, slip_speed: 1e-3 };
        let ground = FlatGround::level(1000.0, 0.5);
        let body = WheelAndBall::new(points);
        let stepper = scene!(body, ground, friction, EnergyMomentum { time_step });
        let on_rim = State::at(DVec3::Z * (0.5 - depth))
            .with_angular_momentum(DVec3::Z * spin);
        let on_ball = State::at(DVec3::Z * (1.1 - depth))
            .with_rotation_vector(DVec3::Y * FRAC_PI_2)
            .with_linear_velocity(DVec3::new(slide, 0.1, 0.0))
            .with_angular_momentum(DVec3::Z * 0.01);
        let (mut used, mut fresh) = (stepper.session(on_rim), stepper.session(on_ball));
        used.step().unwrap();
        used.set_state(on_ball);
        prop_assert_eq!(used.step().unwrap(), fresh.step().unwrap());
        prop_assert_eq!(used.state(), fresh.state());
    }
}
