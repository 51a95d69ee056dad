//! The checks that an author runs on his own implementation: everything that is built in passes
//! them, and broken implementations are caught, each by the clause that it breaks.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::kit::erased::Stepper;
use core::cell::Cell;

use tumble::body::ContactRange;
use tumble::contract::{
    CheckPlan, FrictionRange, GroundRange, Input, Requirement, Violation, check_body,
    check_energy_never_rises, check_friction, check_ground, check_integrator,
};
use tumble::glam::{DMat3, DQuat, DVec3, Vec3};
use tumble::integrator::step_length;
use tumble::{
    AdaptiveEnergyMomentum, AdaptiveNystrom, AnisotropicCoulomb, BogackiShampine32, Bowl, Coin,
    ContactLaw, ContactPoint, Coulomb, DormandPrince54, Dynamics, Elevation, EnergyMomentum,
    FlatGround, ForwardEuler, FrictionJacobian, Frictionless, Ground, GroundBounds, HuntCrossley,
    Integrator, LimitedDamper, LoadDependentCoulomb, MassProperties, MeanForce, NoGround, Nystrom,
    Plane, PointCloud, Radau5, Ramp, Real, RigidPointBody, Rk4, RollingResistance, SceneError,
    SlidingFriction, SmoothCoulomb, SpringDamper, SpringDamperGround, State, Step, StepError,
    StrangSplitting, Stribeck, Surface, SymplecticEuler, Terrain, Viscous, Waves, WithResistance,
    error,
};

/// Ten batteries of other numbers.
fn batteries() -> impl Iterator<Item = CheckPlan> {
    (0..10).map(|seed| CheckPlan { seed, cases: 200 })
}

const RANGE: GroundRange = GroundRange {
    centre: DVec3::ZERO,
    size: 1.0,
    depth: 0.05,
    speed: 5.0,
};

const RANGE_32: GroundRange<f32> = GroundRange {
    centre: Vec3::ZERO,
    size: 1.0,
    depth: 0.05,
    speed: 5.0,
};

const SLIDES: FrictionRange = FrictionRange {
    centre: DVec3::ZERO,
    size: 1.0,
    normal: DVec3::Z,
    normal_force: 1e3,
    slip: 10.0,
};

/// Violation of a ground that the default plan finds.
fn fault_of_ground(ground: &impl SpringDamperGround) -> Violation {
    check_ground(ground, &RANGE, CheckPlan::default()).unwrap_err()
}

fn fault_of_friction(friction: &impl SlidingFriction) -> Violation {
    check_friction(friction, &SLIDES, CheckPlan::default()).unwrap_err()
}

fn fault_of_body(body: &impl RigidPointBody) -> Violation {
    check_body(body, CheckPlan::default()).unwrap_err()
}

fn fault_of_integrator(integrator: &impl Integrator) -> Violation {
    check_integrator(integrator, CheckPlan::default()).unwrap_err()
}

// What is built in.

#[test]
fn every_built_in_body_passes() {
    let blank = ContactPoint::default();
    let rod = [-1.0, 0.0, 2.0].map(|x| DVec3::new(x, 2.0 * x, 3.0 * x));
    for plan in batteries() {
        check_body(&Coin::ring(1.0, 0.5), plan).unwrap();
        check_body(&Coin::ring(1e-12, 1e6), plan).unwrap();
        check_body(&Coin::<f32>::ring(1.0, 0.5), plan).unwrap();
        check_body(&Coin::ring_with_storage([blank; 3], 2.0, 0.01), plan).unwrap();
        check_body(&Coin::ring_with_storage(vec![blank; 1001], 2.0, 0.01), plan).unwrap();
        check_body(&PointCloud::new(rod, [1.0; 3]).unwrap(), plan).unwrap();
        check_body(&PointCloud::new([DVec3::X], [1.0]).unwrap(), plan).unwrap();
        check_body(&Coin::ring(1.0, 0.5) as &dyn RigidPointBody, plan).unwrap();
    }
}

#[test]
fn every_built_in_ground_passes() {
    let tilted = Plane::through(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.2, -0.1, 1.0));
    for plan in batteries() {
        check_ground(&NoGround, &RANGE, plan).unwrap();
        check_ground(&NoGround, &RANGE_32, plan).unwrap();
        check_ground(&FlatGround::level(0.0_f32, 2.0), &RANGE_32, plan).unwrap();
        check_ground(&FlatGround::level(1e3_f32, 0.5), &RANGE_32, plan).unwrap();
        for (stiffness, damping) in [(1e3, 0.5), (1e3, 0.0), (0.0, 3.0), (1e15, 1e9), (1.0, 1e6)] {
            let ground = FlatGround::level(stiffness, damping).on(tilted);
            check_ground(&ground, &RANGE, plan).unwrap();
            check_ground(&Provided(ground), &RANGE, plan).unwrap();
            let law = LimitedDamper { stiffness, damping };
            let limited = Ground { law, shape: tilted };
            check_ground(&limited, &RANGE, plan).unwrap();
            check_ground(&Ground::level(ground.law()), &RANGE, plan).unwrap();
        }
        // Depths, and half of the region's size, below the radii of curvature: 1 m, 2.5 m and 2.2 m
        // at least, in a region of 1 m.
        let law = SpringDamper {
            stiffness: 1e3,
            damping: 0.5,
        };
        let curvatures = [0.4, -0.2];
        let shape = Terrain {
            height_field: Bowl { curvatures },
        };
        check_ground(&Ground { law, shape }, &RANGE, plan).unwrap();
        let height_field = Waves {
            amplitude: 0.1,
            length: 3.0,
        };
        let shape = Terrain { height_field };
        check_ground(&Ground { law, shape }, &RANGE, plan).unwrap();
        let height_field = Ramp {
            slope: 0.5,
            width: 1.0,
        };
        let shape = Terrain { height_field };
        check_ground(&Ground { law, shape }, &RANGE, plan).unwrap();
        // Without its hessian the search takes longer, and finds the same point.
        let shape = Terrain::of(|x: f64, y: f64| {
            Elevation::new(0.1 * x * x - 0.05 * x * y, [0.2 * x - 0.05 * y, -0.05 * x])
        });
        check_ground(&Ground { law, shape }, &RANGE, plan).unwrap();
        for exponent in [1.0, 1.5, 2.0, 1.3, 2.71] {
            for (stiffness, damping) in [(1e3, 0.5), (1e3, 0.0), (0.0, 3.0), (1e12, 1e3)] {
                let law = HuntCrossley {
                    stiffness,
                    exponent,
                    damping,
                };
                check_ground(&Ground::level(law), &RANGE, plan).unwrap();
                #[allow(clippy::cast_possible_truncation, reason = "numbers for f32")]
                let law = HuntCrossley {
                    stiffness: stiffness as f32,
                    exponent: exponent as f32,
                    damping: damping as f32,
                };
                check_ground(&Ground::level(law), &RANGE_32, plan).unwrap();
            }
        }
    }
}

#[test]
fn every_built_in_friction_passes() {
    let slides_32 = FrictionRange {
        centre: Vec3::ZERO,
        size: 1.0,
        normal: Vec3::new(1.0, 2.0, 3.0),
        normal_force: 1e3,
        slip: 10.0,
    };
    for plan in batteries() {
        check_friction(&Frictionless, &SLIDES, plan).unwrap();
        for slip_speed in [1e-12, 1e-3, 1.0] {
            for coefficient in [0.0, 0.3, 1e6] {
                let coulomb = Coulomb {
                    coefficient,
                    slip_speed,
                };
                let smooth = SmoothCoulomb {
                    coefficient,
                    slip_speed,
                };
                check_friction(&coulomb, &SLIDES, plan).unwrap();
                check_friction(&smooth, &SLIDES, plan).unwrap();
                check_friction(&Differences(coulomb), &SLIDES, plan).unwrap();
                let viscous = Viscous { coefficient };
                check_friction(&viscous, &SLIDES, plan).unwrap();
                let resisting = WithResistance {
                    friction: coulomb,
                    rolling: coefficient * 1e-3,
                    spinning: 0.0,
                    turn_speed: slip_speed,
                };
                check_friction(&resisting, &SLIDES, plan).unwrap();
                for transition_load in [1e-9, 1.0, 1e9] {
                    let weakening = LoadDependentCoulomb {
                        coefficient,
                        transition_load,
                        slip_speed,
                    };
                    check_friction(&weakening, &SLIDES, plan).unwrap();
                }
                for (kinetic, viscous) in [(0.5, 0.0), (1.0, 0.1), (2.0, 10.0), (0.0, 0.0)] {
                    let stribeck = Stribeck {
                        static_coefficient: coefficient,
                        kinetic_coefficient: kinetic * coefficient,
                        stribeck_speed: slip_speed * 30.0,
                        viscous,
                        slip_speed,
                    };
                    check_friction(&stribeck, &SLIDES, plan).unwrap();
                }
                for across in [0.0, 0.2, 1.0] {
                    let coefficients = [coefficient, coefficient * across];
                    let grain = DVec3::new(0.3, -0.9, 0.1);
                    let anisotropic =
                        AnisotropicCoulomb::on(SLIDES.normal, grain, coefficients, slip_speed);
                    check_friction(&anisotropic, &SLIDES, plan).unwrap();
                }
            }
        }
        let coulomb = Coulomb::<f32>::as_in_the_report(0.3);
        check_friction(&coulomb, &slides_32, plan).unwrap();
        let coefficients = [0.3_f32, 0.1];
        let anisotropic = AnisotropicCoulomb::on(slides_32.normal, Vec3::X, coefficients, 1e-6);
        check_friction(&anisotropic, &slides_32, plan).unwrap();
        let weakening = LoadDependentCoulomb {
            coefficient: 0.4_f32,
            transition_load: 10.0,
            slip_speed: 1e-5,
        };
        check_friction(&weakening, &slides_32, plan).unwrap();
        let stribeck = Stribeck {
            static_coefficient: 0.4_f32,
            kinetic_coefficient: 0.3,
            stribeck_speed: 1e-2,
            viscous: 1e-3,
            slip_speed: 1e-5,
        };
        check_friction(&stribeck, &slides_32, plan).unwrap();
    }
}

fn every_built_in_integrator_passes_in<R: Real>(time_step: R) {
    let plan = CheckPlan::default();
    check_integrator::<R, _>(&EnergyMomentum { time_step }, plan).unwrap();
    check_integrator::<R, _>(&ForwardEuler { time_step }, plan).unwrap();
    check_integrator::<R, _>(&SymplecticEuler { time_step }, plan).unwrap();
    check_integrator::<R, _>(&StrangSplitting { time_step }, plan).unwrap();
    check_integrator::<R, _>(&Rk4 { time_step }, plan).unwrap();
    check_integrator::<R, _>(&Nystrom { time_step }, plan).unwrap();
}

#[test]
fn every_built_in_integrator_that_chooses_its_steps_passes() {
    let plan = CheckPlan::default();
    for tolerance in [1e-9, 1e-5, 1e-2] {
        check_integrator::<f64, _>(&BogackiShampine32::new(tolerance), plan).unwrap();
        check_integrator::<f64, _>(&DormandPrince54::new(tolerance), plan).unwrap();
        check_integrator::<f64, _>(&AdaptiveEnergyMomentum::new(tolerance), plan).unwrap();
        check_integrator::<f64, _>(&AdaptiveNystrom::new(tolerance), plan).unwrap();
        check_integrator::<f64, _>(&Radau5::new(tolerance), plan).unwrap();
    }
    for tolerance in [1e-5, 1e-2] {
        check_integrator::<f32, _>(&BogackiShampine32::new(tolerance), plan).unwrap();
        check_integrator::<f32, _>(&DormandPrince54::new(tolerance), plan).unwrap();
        check_integrator::<f32, _>(&AdaptiveEnergyMomentum::new(tolerance), plan).unwrap();
        check_integrator::<f32, _>(&AdaptiveNystrom::new(tolerance), plan).unwrap();
        check_integrator::<f32, _>(&Radau5::new(tolerance), plan).unwrap();
    }
}

#[test]
fn an_adaptive_method_that_is_given_its_steps_has_its_order() {
    let plan = CheckPlan::default();
    for longest_step in [1e-3, 0.7] {
        let bogacki_shampine = BogackiShampine32 {
            longest_step,
            ..BogackiShampine32::new(1e100)
        };
        let dormand_prince = DormandPrince54 {
            longest_step,
            ..DormandPrince54::new(1e100)
        };
        check_integrator::<f64, _>(&bogacki_shampine, plan).unwrap();
        let implicit = AdaptiveEnergyMomentum {
            longest_step,
            ..AdaptiveEnergyMomentum::new(1e100)
        };
        check_integrator::<f64, _>(&dormand_prince, plan).unwrap();
        check_integrator::<f64, _>(&implicit, plan).unwrap();
        let nystrom = AdaptiveNystrom {
            longest_step,
            ..AdaptiveNystrom::new(1e100)
        };
        check_integrator::<f64, _>(&nystrom, plan).unwrap();
        let radau = Radau5 {
            longest_step,
            ..Radau5::new(1e100)
        };
        check_integrator::<f64, _>(&radau, plan).unwrap();
    }
}

#[test]
fn every_built_in_integrator_passes() {
    for time_step in [1e-9, 1e-3, 0.7] {
        every_built_in_integrator_passes_in::<f64>(time_step);
    }
    for time_step in [1e-6, 1e-3, 0.7] {
        every_built_in_integrator_passes_in::<f32>(time_step);
    }
}

#[test]
fn the_energy_never_rises_with_the_default_integrator_and_does_with_the_others() {
    for plan in batteries() {
        check_energy_never_rises::<f64, _>(&EnergyMomentum { time_step: 1e-3 }, plan).unwrap();
        check_energy_never_rises::<f32, _>(&EnergyMomentum { time_step: 1e-3 }, plan).unwrap();
        for tolerance in [1e-3, 1e100] {
            let adaptive = AdaptiveEnergyMomentum::new(tolerance);
            check_energy_never_rises::<f64, _>(&adaptive, plan).unwrap();
        }
        // In single precision a wild scene may need steps below the rounding of the longest one.
        let adaptive = AdaptiveEnergyMomentum::new(1e30);
        check_energy_never_rises::<f32, _>(&adaptive, plan).unwrap();
    }
    let time_step = 1e-3;
    let plan = CheckPlan::default();
    for violation in [
        check_energy_never_rises::<f64, _>(&ForwardEuler { time_step }, plan),
        check_energy_never_rises::<f64, _>(&SymplecticEuler { time_step }, plan),
        check_energy_never_rises::<f64, _>(&StrangSplitting { time_step }, plan),
        check_energy_never_rises::<f64, _>(&Rk4 { time_step }, plan),
    ] {
        let violation = violation.unwrap_err();
        assert_eq!(
            violation.requirement,
            Requirement::EnergyNeverRises,
            "{violation}"
        );
        assert!(violation.value > violation.bound, "{violation}");
    }
}

// Bodies.

/// A ring that changes one result of the inner coin.
struct Spoilt<const FAULT: char> {
    coin: Coin,
    asked: Cell<u32>,
}

fn spoilt<const FAULT: char>() -> Spoilt<FAULT> {
    Spoilt {
        coin: Coin::ring(1.0, 0.5),
        asked: Cell::new(0),
    }
}

impl<const FAULT: char> Spoilt<FAULT> {
    fn times_asked(&self) -> u32 {
        self.asked.set(self.asked.get() + 1);
        self.asked.get()
    }
}

impl<const FAULT: char> RigidPointBody for Spoilt<FAULT> {
    fn mass(&self) -> f64 {
        match FAULT {
            'm' => -1.0,
            'b' => 1.0 + f64::from(self.times_asked()),
            _ => 1.0,
        }
    }
    fn inertia(&self) -> DMat3 {
        match FAULT {
            // A slab has at most the sum of the two others.
            't' => DMat3::from_diagonal(DVec3::new(0.3, 0.125, 0.125)),
            'a' => DMat3::from_cols(DVec3::new(0.25, 0.1, 0.0), DVec3::Y, DVec3::Z),
            'n' => DMat3::from_diagonal(DVec3::new(0.1, -0.1, 0.1)),
            _ => self.coin.inertia(),
        }
    }
    fn contacts(&self) -> &[ContactPoint] {
        let contacts = self.coin.contacts();
        // Rubber: the hundredth question finds a point gone.
        if FAULT == 'c' && self.times_asked() > 99 {
            &contacts[1..]
        } else {
            contacts
        }
    }
    fn bounding_radius(&self) -> f64 {
        match FAULT {
            'r' => 0.499_999,
            'i' => f64::INFINITY,
            _ => 0.5,
        }
    }
    fn contacts_below(&self, normal: DVec3, offset: f64) -> ContactRange {
        let run = self.coin.contacts_below(normal, offset);
        match FAULT {
            // One short at the end.
            's' if run.count > 1 => ContactRange {
                count: run.count - 1,
                ..run
            },
            // No wrap from the last contact to the first.
            'w' => ContactRange {
                count: run.count.min(120 - run.first),
                ..run
            },
            // Upside down.
            'u' => self.coin.contacts_below(-normal, offset),
            // A different result from time to time, which is never too small.
            'o' if self.times_asked() % 50 == 0 => ContactRange::all(120),
            _ => run,
        }
    }
    fn contacts_below_near(&self, normal: DVec3, offset: f64, near: ContactRange) -> ContactRange {
        match FAULT {
            // The previous result, as if nothing had moved.
            'e' => near,
            // None missed, but as many more as were known.
            'l' if near.count > 1 => ContactRange::all(120),
            _ => self.contacts_below(normal, offset),
        }
    }
    fn range_ends(&self, range: ContactRange) -> Option<[DVec3; 4]> {
        match FAULT {
            // Those of a range that begins one contact earlier.
            'g' => self.coin.range_ends(ContactRange {
                first: range.first.wrapping_sub(1),
                count: range.count.saturating_add(1),
            }),
            _ => self.coin.range_ends(range),
        }
    }
    fn check(&self) -> Result<(), SceneError> {
        error::at_least_zero("parameter", if FAULT == 'k' { -1.0 } else { 1.0 }, "")
    }
}

#[test]
fn a_body_with_impossible_mass_or_inertia_is_caught() {
    let message = |violation: Violation| match violation.requirement {
        Requirement::Composes { quantity, .. } => quantity,
        _ => panic!("{violation}"),
    };
    assert_eq!(message(fault_of_body(&spoilt::<'m'>())), "mass");
    assert_eq!(message(fault_of_body(&spoilt::<'k'>())), "parameter");
    assert_eq!(
        message(fault_of_body(&spoilt::<'a'>())),
        "the inertia tensor"
    );
    assert_eq!(
        message(fault_of_body(&spoilt::<'n'>())),
        "a principal moment of inertia"
    );
    assert!(message(fault_of_body(&spoilt::<'t'>())).contains("moment"));
}

#[test]
fn a_body_that_is_not_rigid_is_caught() {
    assert_eq!(
        fault_of_body(&spoilt::<'b'>()).requirement,
        Requirement::Rigid
    );
    assert_eq!(
        fault_of_body(&spoilt::<'c'>()).requirement,
        Requirement::Rigid
    );
    assert_eq!(
        fault_of_body(&spoilt::<'o'>()).requirement,
        Requirement::Rigid
    );
}

#[test]
fn a_reach_that_is_too_short_is_caught_at_a_contact_beyond_it() {
    let violation = fault_of_body(&spoilt::<'r'>());
    assert_eq!(violation.requirement, Requirement::Reach);
    assert!(
        matches!(violation.input, Input::Contact { .. }),
        "{violation}"
    );
    assert_eq!(
        fault_of_body(&spoilt::<'i'>()).requirement,
        Requirement::Finite
    );
}

#[test]
fn contacts_below_near_that_depends_on_what_is_known_is_caught() {
    let violation = fault_of_body(&spoilt::<'l'>());
    assert_eq!(
        violation.requirement,
        Requirement::ContactsBelow,
        "{violation}"
    );
}

#[test]
fn contacts_below_that_misses_one_is_caught_with_the_plane_that_shows_it() {
    for violation in [
        fault_of_body(&spoilt::<'s'>()),
        fault_of_body(&spoilt::<'w'>()),
        fault_of_body(&spoilt::<'u'>()),
        fault_of_body(&spoilt::<'e'>()),
        fault_of_body(&spoilt::<'g'>()),
    ] {
        assert_eq!(
            violation.requirement,
            Requirement::ContactsBelow,
            "{violation}"
        );
        let Input::Below {
            normal,
            offset,
            index,
        } = violation.input
        else {
            panic!("{violation}");
        };
        let coin: Coin = Coin::ring(1.0, 0.5);
        assert!(
            normal.dot(coin.contacts()[index].position) < offset,
            "{violation}"
        );
    }
}

#[test]
fn a_good_body_within_the_spoiling_one_passes() {
    check_body(&spoilt::<'_'>(), CheckPlan::default()).unwrap();
}

// Grounds.

/// A law with the provided mean force.
pub(super) struct Provided(pub(super) FlatGround);

impl SpringDamperGround for Provided {
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
    fn bounds(&self) -> GroundBounds {
        self.0.bounds()
    }
}

/// A ground in which each result can be wrong.
struct Any {
    surface: fn(DVec3) -> Surface,
    spring_force: fn(f64) -> f64,
    spring_energy: fn(f64) -> f64,
    normal_force: fn(f64, f64) -> f64,
    extent: GroundBounds,
    under: Option<fn(DVec3, f64) -> Option<Surface>>,
    mean_force: Option<fn(f64, f64, f64) -> MeanForce>,
}

/// Springs of 1000 N/m and dampers of 2 N s/m in level ground, nothing wrong.
const RIGHT: Any = Any {
    surface: |point| Surface {
        gap: point.z,
        normal: DVec3::Z,
    },
    spring_force: |depth| 1e3 * depth,
    spring_energy: |depth| 5e2 * depth * depth,
    normal_force: |depth, speed| (1e3 * depth + 2.0 * speed).max(0.0),
    extent: GroundBounds::Everywhere,
    under: None,
    mean_force: None,
};

impl SpringDamperGround for Any {
    fn surface(&self, point: DVec3) -> Surface {
        (self.surface)(point)
    }
    fn spring_force(&self, depth: f64) -> f64 {
        (self.spring_force)(depth)
    }
    fn spring_energy(&self, depth: f64) -> f64 {
        (self.spring_energy)(depth)
    }
    fn normal_force(&self, depth: f64, closing_speed: f64) -> f64 {
        (self.normal_force)(depth, closing_speed)
    }
    fn surface_under(&self, centre: DVec3, radius: f64) -> Option<Surface> {
        let surface = (self.surface)(centre);
        self.under
            .map_or(Some(surface), |under| under(centre, radius))
    }
    fn bounds(&self) -> GroundBounds {
        self.extent
    }
    fn mean_force(&self, start: f64, end: f64, seconds: f64) -> MeanForce {
        match self.mean_force {
            Some(mean_force) => mean_force(start, end, seconds),
            None => Provided(FlatGround::level(1e3, 2.0)).mean_force(start, end, seconds),
        }
    }
}

#[test]
fn grounds_that_are_right_pass_whatever_their_law_and_shape() {
    struct Law<S, F, E>(S, F, E);
    impl<S, F, E> SpringDamperGround for Law<S, F, E>
    where
        S: Fn(DVec3) -> Surface,
        F: Fn(f64) -> f64,
        E: Fn(f64) -> f64,
    {
        fn surface(&self, point: DVec3) -> Surface {
            (self.0)(point)
        }
        fn spring_force(&self, depth: f64) -> f64 {
            (self.1)(depth)
        }
        fn spring_energy(&self, depth: f64) -> f64 {
            (self.2)(depth)
        }
        fn normal_force(&self, depth: f64, closing_speed: f64) -> f64 {
            // Hunt and Crossley's damper.
            ((self.1)(depth) * (1.0 + 0.3 * closing_speed)).max(0.0)
        }
    }
    let ball = |point: DVec3| {
        let away = point - DVec3::new(0.0, 0.0, -2.0);
        Surface {
            gap: away.length() - 2.0,
            normal: away.normalize(),
        }
    };
    // A gutter: two planes that meet along x.
    let gutter = |point: DVec3| {
        let [left, right] = [1.0, -1.0].map(|side| DVec3::new(0.0, 0.6 * side, 0.8));
        let [a, b] = [left, right].map(|normal| normal.dot(point));
        if a < b {
            Surface {
                gap: a,
                normal: left,
            }
        } else {
            Surface {
                gap: b,
                normal: right,
            }
        }
    };
    let level = RIGHT.surface;
    for plan in batteries() {
        // Hertz.
        let hertz = (|d: f64| 1e5 * d.powf(1.5), |d: f64| 4e4 * d.powf(2.5));
        check_ground(&Law(level, hertz.0, hertz.1), &RANGE, plan).unwrap();
        check_ground(&Law(ball, hertz.0, hertz.1), &RANGE, plan).unwrap();
        check_ground(&Law(gutter, hertz.0, hertz.1), &RANGE, plan).unwrap();
        // A mat of 1 cm on stone.
        let stone = |d: f64| 1e3 * d + 1e6 * (d - 0.01).max(0.0);
        let stored = |d: f64| 5e2 * d * d + 5e5 * (d - 0.01).max(0.0).powi(2);
        check_ground(&Law(level, stone, stored), &RANGE, plan).unwrap();
        // A crust with a force that does not depend on the depth, and mud whose force levels off.
        check_ground(&Law(level, |_| 3.0, |d: f64| 3.0 * d), &RANGE, plan).unwrap();
        let mud = |d: f64| 5.0 * d / (0.01 + d);
        let kept = |d: f64| 5.0 * (d - 0.01 * (d / 0.01).ln_1p());
        check_ground(&Law(level, mud, kept), &RANGE, plan).unwrap();
    }
}

#[test]
fn a_surface_whose_normal_is_not_that_of_its_gap_is_caught() {
    // A slope by its height, not by its distance.
    let steep = Any {
        surface: |p| Surface {
            gap: p.z - 0.5 * p.x,
            normal: DVec3::new(-0.5, 0.0, 1.0).normalize(),
        },
        ..RIGHT
    };
    assert_eq!(
        fault_of_ground(&steep).requirement,
        Requirement::GapAlongNormal
    );
    // A dome with a normal that points up everywhere.
    let dome = Any {
        surface: |p| Surface {
            gap: (p + DVec3::Z * 2.0).length() - 2.0,
            normal: DVec3::Z,
        },
        ..RIGHT
    };
    assert_eq!(
        fault_of_ground(&dome).requirement,
        Requirement::GapAlongNormal
    );
    // A very small step.
    let step = Any {
        surface: |p| Surface {
            gap: p.z - if p.x > 0.0 { 1e-6 } else { 0.0 },
            normal: DVec3::Z,
        },
        ..RIGHT
    };
    let violation = fault_of_ground(&step);
    assert_eq!(violation.requirement, Requirement::GapAlongNormal);
    let Input::Displacement { from, to } = violation.input else {
        panic!("{violation}");
    };
    assert!(from.x.min(to.x) <= 0.0 && from.x.max(to.x) > 0.0);
    let long = Any {
        surface: |p| Surface {
            gap: p.z,
            normal: DVec3::Z * (1.0 + 1e-9),
        },
        ..RIGHT
    };
    assert_eq!(fault_of_ground(&long).requirement, Requirement::UnitNormal);
    let nothing = Any {
        surface: |p| Surface {
            gap: (p.z * 0.0) / 0.0,
            normal: DVec3::Z,
        },
        ..RIGHT
    };
    assert_eq!(fault_of_ground(&nothing).requirement, Requirement::Finite);
}

#[test]
fn a_surface_under_a_contact_that_is_another_one_or_missing_is_caught() {
    let wrong: [fn(DVec3, f64) -> Option<Surface>; 3] = [
        // A contact with a radius is left out until its centre is below ground.
        |point, _| (point.z < 0.0).then(|| (RIGHT.surface)(point)),
        // One that is 1e-9 m deep is left out.
        |point, radius| (point.z < radius - 1e-9).then(|| (RIGHT.surface)(point)),
        |point, _| {
            Some(Surface {
                gap: point.z * (1.0 + 1e-12),
                normal: DVec3::Z,
            })
        },
    ];
    for under in wrong {
        let under = Some(under);
        let violation = fault_of_ground(&Any { under, ..RIGHT });
        let requirement = violation.requirement;
        assert_eq!(requirement, Requirement::SurfaceUnder, "{violation}");
    }
    let right: fn(DVec3, f64) -> Option<Surface> =
        |point, radius| (point.z < radius).then(|| (RIGHT.surface)(point));
    let under = Some(right);
    check_ground(&Any { under, ..RIGHT }, &RANGE, CheckPlan::default()).unwrap();
}

#[test]
fn an_extent_that_is_not_true_is_caught() {
    for extent in [
        GroundBounds::Nowhere,
        GroundBounds::Plane(Plane::level(1e-6)),
        GroundBounds::Plane(Plane::through(
            DVec3::ZERO,
            DVec3::new(1e-6, 0.0, 1.0).normalize(),
        )),
        // The ground is said to lie lower than it does.
        GroundBounds::Below(Plane::level(-1e-4)),
        // No plane of this tilt has it all below.
        GroundBounds::Below(Plane::through(DVec3::ZERO, DVec3::new(0.1, 0.0, 1.0))),
    ] {
        let violation = fault_of_ground(&Any { extent, ..RIGHT });
        assert_eq!(
            violation.requirement,
            Requirement::GroundBounds,
            "{violation}"
        );
    }
    let crooked = Plane {
        normal: DVec3::Z * 1.01,
        height: 0.0,
    };
    let violation = fault_of_ground(&Any {
        extent: GroundBounds::Below(crooked),
        ..RIGHT
    });
    assert!(
        matches!(violation.requirement, Requirement::Composes { .. }),
        "{violation}"
    );
    let low_enough = Any {
        extent: GroundBounds::Below(Plane::level(0.2)),
        ..RIGHT
    };
    check_ground(&low_enough, &RANGE, CheckPlan::default()).unwrap();
}

#[test]
fn a_potential_that_is_not_the_integral_of_the_force_is_caught() {
    let twice = Any {
        spring_energy: |d| 1e3 * d * d,
        ..RIGHT
    };
    assert_eq!(
        fault_of_ground(&twice).requirement,
        Requirement::EnergyIsIntegral
    );
    // A millionth too much.
    let nearly = Any {
        spring_energy: |d| 5e2 * (1.0 + 1e-6) * d * d,
        ..RIGHT
    };
    assert_eq!(
        fault_of_ground(&nearly).requirement,
        Requirement::EnergyIsIntegral
    );
    // Consistent from point to point, but not 0 at the surface.
    let lifted = Any {
        spring_energy: |d| 5e2 * d * d + 1e-6,
        ..RIGHT
    };
    let violation = fault_of_ground(&lifted);
    assert_eq!(violation.requirement, Requirement::EnergyIsIntegral);
    assert!(
        matches!(violation.input, Input::Depths { from: 0.0, .. }),
        "{violation}"
    );
    // A force that stiffens in the deep, with the energy of one that does not.
    let stiffening = Any {
        spring_force: |d| 1e3 * d * (1.0 + 100.0 * (d - 0.045).max(0.0)),
        normal_force: |d, _| 1e3 * d * (1.0 + 100.0 * (d - 0.045).max(0.0)),
        ..RIGHT
    };
    assert_eq!(
        fault_of_ground(&stiffening).requirement,
        Requirement::EnergyIsIntegral
    );
    let sinking = Any {
        spring_energy: |d| -5e2 * d * d,
        ..RIGHT
    };
    assert_eq!(
        fault_of_ground(&sinking).requirement,
        Requirement::SpringEnergyRises
    );
}

#[test]
fn a_ground_that_pulls_is_caught_with_depth_and_speed() {
    let glue = Any {
        normal_force: |d, speed| 1e3 * d + 2.0 * speed,
        ..RIGHT
    };
    let violation = fault_of_ground(&glue);
    assert_eq!(violation.requirement, Requirement::NeverPulls);
    let Input::Penetration {
        depth,
        closing_speed,
    } = violation.input
    else {
        panic!("{violation}");
    };
    assert!(1e3 * depth + 2.0 * closing_speed < 0.0, "{violation}");
    let magnet = Any {
        spring_force: |d| 1e3 * d - 0.1,
        ..RIGHT
    };
    assert_eq!(
        fault_of_ground(&magnet).requirement,
        Requirement::SpringPushes
    );
}

#[test]
fn dampers_that_give_energy_are_caught() {
    let backwards = Any {
        normal_force: |d, speed| (1e3 * d - 2.0 * speed).max(0.0),
        ..RIGHT
    };
    assert_eq!(
        fault_of_ground(&backwards).requirement,
        Requirement::DamperTakes
    );
    // A trampoline: a fast contact is thrown back harder.
    let trampoline = Any {
        normal_force: |d, speed| 1e3 * d * if speed < -4.0 { 1.01 } else { 1.0 },
        ..RIGHT
    };
    assert_eq!(
        fault_of_ground(&trampoline).requirement,
        Requirement::DamperTakes
    );
}

#[test]
fn a_mean_force_that_is_not_the_laws_is_caught() {
    fn right(start: f64, end: f64, seconds: f64) -> MeanForce {
        FlatGround::level(1e3, 2.0).mean_force(start, end, seconds)
    }
    fn with(mean_force: fn(f64, f64, f64) -> MeanForce) -> Any {
        Any {
            mean_force: Some(mean_force),
            ..RIGHT
        }
    }
    check_ground(&with(right), &RANGE, CheckPlan::default()).unwrap();
    // The force at the end alone takes too much during compression and returns too much during
    // rebound.
    let at_end = with(|start, end, seconds| MeanForce {
        force: (1e3 * end.max(0.0) + 2.0 * (end - start).min(0.0) / seconds).max(0.0),
        ..right(start, end, seconds)
    });
    let pushing_above = with(|start, end, seconds| MeanForce {
        force: right(start, end, seconds).force + 1e-3,
        ..right(start, end, seconds)
    });
    // A third of it less.
    let weak = with(|start, end, seconds| MeanForce {
        force: right(start, end, seconds).force * 0.7,
        ..right(start, end, seconds)
    });
    // A third more takes enough during compression, and returns too much during rebound.
    let strong = with(|start, end, seconds| MeanForce {
        force: right(start, end, seconds).force * 1.3,
        ..right(start, end, seconds)
    });
    // During compression, where it takes even more.
    let greedy = with(|start, end, seconds| MeanForce {
        force: right(start, end, seconds).force * if end > start { 1.3 } else { 1.0 },
        ..right(start, end, seconds)
    });
    let softening = with(|start, end, seconds| MeanForce {
        slope: -1.0,
        ..right(start, end, seconds)
    });
    let requirement = |ground: Any| fault_of_ground(&ground).requirement;
    assert_eq!(requirement(pushing_above), Requirement::MeanForceAbove);
    assert_eq!(requirement(softening), Requirement::MeanForceSigns);
    assert_eq!(requirement(greedy), Requirement::MeanForceIsMean);
    assert_eq!(requirement(weak), Requirement::MeanForceTakes);
    assert!(matches!(
        requirement(strong),
        Requirement::MeanForceTakes | Requirement::MeanForceIsMean
    ));
    assert!(matches!(
        requirement(at_end),
        Requirement::MeanForceTakes | Requirement::MeanForceIsMean
    ));
}

// Friction laws.

/// Friction of a load above a threshold of 1 N, with the provided Jacobian. Just above the
/// threshold its coefficient is nearly in proportion to a high power of the load.
struct AboveThreshold;

impl SlidingFriction for AboveThreshold {
    fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
        slip * (-0.3 * (normal_force - 1.0).max(0.0) / (slip.length() + 1e-3))
    }
}

#[test]
fn a_friction_that_begins_at_a_load_passes_with_the_provided_jacobian() {
    for seed in 0..200 {
        let plan = CheckPlan {
            seed,
            ..CheckPlan::default()
        };
        check_friction(&AboveThreshold, &SLIDES, plan).unwrap();
    }
}

/// Resists rotation with a negative torque.
struct Pushing(f64);

impl SlidingFriction for Pushing {
    fn force(&self, _normal_force: f64, _slip: DVec3) -> DVec3 {
        DVec3::ZERO
    }
    fn rolling_resistance(&self, normal_force: f64) -> Option<RollingResistance> {
        (normal_force > 0.0 || self.0 < 0.0).then_some(RollingResistance {
            rolling: self.0 * normal_force,
            spinning: 0.0,
            turn_speed: 1.0,
        })
    }
}

#[test]
fn a_resistance_that_drives_or_comes_and_goes_is_found() {
    for factor in [-1.0, 1.0] {
        let violation =
            check_friction(&Pushing(factor), &SLIDES, CheckPlan::default()).unwrap_err();
        assert_eq!(
            violation.requirement,
            Requirement::TurningOpposes,
            "{violation}"
        );
    }
}

/// Resists rolling ten times as much on one half of the ground, and does not report it.
struct HalfRough;

impl SlidingFriction for HalfRough {
    fn force(&self, _normal_force: f64, _slip: DVec3) -> DVec3 {
        DVec3::ZERO
    }
    fn rolling_resistance(&self, normal_force: f64) -> Option<RollingResistance> {
        self.rolling_resistance_at(DVec3::ZERO, normal_force)
    }
    fn rolling_resistance_at(
        &self,
        position: DVec3,
        normal_force: f64,
    ) -> Option<RollingResistance> {
        let length = if position.x > 0.0 { 1e-2 } else { 1e-3 };
        Some(RollingResistance {
            rolling: length * normal_force,
            spinning: 0.0,
            turn_speed: 1.0,
        })
    }
}

#[test]
fn a_resistance_that_varies_over_the_ground_must_be_reported() {
    let violation = fault_of_friction(&HalfRough);
    assert_eq!(violation.requirement, Requirement::SameEverywhere);
    assert!(
        matches!(violation.input, Input::Slide { position, .. } if position.x > 0.0),
        "{violation}"
    );
}

/// A law with the provided drag.
struct Differences(Coulomb);

impl SlidingFriction for Differences {
    fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
        self.0.force(normal_force, slip)
    }
}

/// A friction law from a closure.
struct Rub<F>(F);

impl<F: Fn(f64, DVec3) -> DVec3> SlidingFriction for Rub<F> {
    fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
        (self.0)(normal_force, slip)
    }
}

#[test]
fn friction_laws_that_are_right_pass() {
    let oil = Rub(|load: f64, slip: DVec3| if load > 0.0 { -slip * 0.2 } else { DVec3::ZERO });
    // Stribeck's curve: less at speed than at rest.
    let stribeck = Rub(|load: f64, slip: DVec3| {
        let speed = slip.length();
        -slip * (load * (0.3 + 0.2 * (-speed).exp()) / (speed + 1e-3))
    });
    // Skates: along x they glide, along y they grip. On level ground only.
    let skates = Rub(|load: f64, slip: DVec3| {
        let grip = DVec3::new(0.01 * slip.x, 0.5 * slip.y, 0.0);
        -grip * (load / (slip.length() + 1e-3))
    });
    for plan in batteries() {
        check_friction(&oil, &SLIDES, plan).unwrap();
        check_friction(&stribeck, &SLIDES, plan).unwrap();
        check_friction(&skates, &SLIDES, plan).unwrap();
    }
    let slope = FrictionRange {
        normal: DVec3::new(0.0, 0.3, 1.0),
        ..SLIDES
    };
    let violation = check_friction(&skates, &slope, CheckPlan::default()).unwrap_err();
    assert_eq!(violation.requirement, Requirement::InSurface);
}

#[test]
fn friction_that_gives_energy_is_caught_with_load_and_slip() {
    let motor = Rub(|load: f64, slip: DVec3| slip * (0.3 * load / (slip.length() + 1e-3)));
    let violation = fault_of_friction(&motor);
    assert_eq!(violation.requirement, Requirement::Opposes);
    assert!(
        matches!(violation.input, Input::Slide { normal_force, .. } if normal_force > 0.0),
        "{violation}"
    );
    // A belt that runs at 1 mm/s along x drags slower bodies along.
    let belt = Rub(|load: f64, slip: DVec3| {
        let past = slip - DVec3::X * 1e-3;
        -past * (0.3 * load / (past.length() + 1e-3))
    });
    assert!(matches!(
        fault_of_friction(&belt).requirement,
        Requirement::Opposes | Requirement::NoSlipNoForce
    ));
    // Only sideways to the slip it takes nothing, and lifts.
    let lift = Rub(|load: f64, slip: DVec3| {
        -slip * (0.3 * load / (slip.length() + 1e-3)) + DVec3::Z * (0.1 * load * slip.length())
    });
    assert_eq!(fault_of_friction(&lift).requirement, Requirement::InSurface);
}

#[test]
fn friction_that_is_no_number_at_zero_slip_is_caught() {
    let naive = Rub(|load: f64, slip: DVec3| -slip.normalize() * (0.3 * load));
    let violation = fault_of_friction(&naive);
    assert_eq!(violation.requirement, Requirement::Finite);
    assert!(
        matches!(violation.input, Input::Slide { slip, .. } if slip == DVec3::ZERO),
        "{violation}"
    );
}

/// A law with a coefficient from the position, and what it reports about that.
struct Patchy<F> {
    coefficient: F,
    reports: bool,
}

impl<F: Fn(DVec3) -> f64> SlidingFriction for Patchy<F> {
    fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
        self.force_at(DVec3::ZERO, normal_force, slip)
    }
    fn force_at(&self, position: DVec3, normal_force: f64, slip: DVec3) -> DVec3 {
        slip * -((self.coefficient)(position) * normal_force / (slip.length() + 1e-3))
    }
    fn depends_on_position(&self) -> bool {
        self.reports
    }
}

#[test]
fn friction_is_checked_at_several_positions() {
    let ice = Patchy {
        coefficient: |position: DVec3| if position.x > 0.5 { 0.02 } else { 0.3 },
        reports: true,
    };
    for plan in batteries() {
        check_friction(&ice, &SLIDES, plan).unwrap();
    }
    let hidden = Patchy {
        reports: false,
        ..ice
    };
    let violation = fault_of_friction(&hidden);
    assert_eq!(violation.requirement, Requirement::SameEverywhere);
    let motor = Patchy {
        coefficient: |position: DVec3| if position.x > 0.5 { -0.02 } else { 0.3 },
        reports: true,
    };
    let violation = fault_of_friction(&motor);
    assert_eq!(violation.requirement, Requirement::Opposes);
    assert!(
        matches!(violation.input, Input::Slide { position, .. } if position.x > 0.5),
        "{violation}"
    );
    // Outside the region that is stated, the law is not evaluated.
    let near = FrictionRange {
        size: 0.4,
        ..SLIDES
    };
    check_friction(&motor, &near, CheckPlan::default()).unwrap();
}

/// A law that says that it is proportional to the load, with a force and a rolling torque.
struct Proportional<F, T>(F, T);

impl<F: Fn(f64) -> f64, T: Fn(f64) -> f64> SlidingFriction for Proportional<F, T> {
    fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
        slip * -((self.0)(normal_force) / (slip.length() + 1e-3))
    }
    fn rolling_resistance(&self, normal_force: f64) -> Option<RollingResistance> {
        Some(RollingResistance {
            rolling: (self.1)(normal_force),
            spinning: 0.0,
            turn_speed: 1e-3,
        })
    }
    fn is_proportional_to_load(&self) -> bool {
        true
    }
}

#[test]
fn a_law_that_is_not_proportional_to_the_load_and_says_so_is_caught() {
    let right = Proportional(|load: f64| 0.3 * load, |load: f64| 1e-3 * load);
    for plan in batteries() {
        check_friction(&right, &SLIDES, plan).unwrap();
    }
    let limit = SLIDES.normal_force * 0.2;
    let saturated = Proportional(|load: f64| 0.3 * load.min(limit), |load: f64| 1e-3 * load);
    let requirement = fault_of_friction(&saturated).requirement;
    assert_eq!(requirement, Requirement::ProportionalToLoad);
    let hertz = Proportional(
        |load: f64| 0.3 * load,
        |load: f64| 1e-3 * load.powf(4.0 / 3.0),
    );
    let requirement = fault_of_friction(&hertz).requirement;
    assert_eq!(requirement, Requirement::ProportionalToLoad);
}

#[test]
fn friction_without_load_is_caught() {
    let sticky = Rub(|load: f64, slip: DVec3| -slip * (load + 1.0));
    assert_eq!(
        fault_of_friction(&sticky).requirement,
        Requirement::NoLoadNoForce
    );
}

#[test]
fn a_drag_that_does_not_fit_its_force_is_caught() {
    struct Misfit(FrictionJacobian);
    impl SlidingFriction for Misfit {
        fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
            -slip * (0.3 * normal_force)
        }
        fn jacobian(&self, normal_force: f64, _slip: DVec3) -> FrictionJacobian {
            FrictionJacobian {
                coefficient: self.0.coefficient * normal_force,
                ..self.0
            }
        }
    }
    let right = FrictionJacobian {
        coefficient: 0.3,
        per_load: 0.3,
        width: 1.0,
        growth: 0.0,
    };
    check_friction(&Misfit(right), &SLIDES, CheckPlan::default()).unwrap();
    for wrong in [
        FrictionJacobian {
            coefficient: 0.31,
            ..right
        },
        FrictionJacobian {
            width: 0.0,
            ..right
        },
        FrictionJacobian {
            growth: 1.5,
            ..right
        },
    ] {
        let violation = fault_of_friction(&Misfit(wrong));
        assert_eq!(
            violation.requirement,
            Requirement::JacobianFits,
            "{violation}"
        );
    }
}

// Integrators.

/// Semi-implicit Euler of 1 ms with one fault.
struct Faulty<const FAULT: char>;

impl<const FAULT: char> Integrator for Faulty<FAULT> {
    type Workspace = u32;

    const ADAPTIVE: bool = FAULT == 'r';

    fn step<D: Dynamics>(
        &self,
        scene: &D,
        state: &mut State,
        limit: f64,
        workspace: &mut u32,
    ) -> Result<Step, StepError> {
        let own = 1e-3;
        let dt = step_length(own, limit);
        let start = *state;
        let inner = SymplecticEuler {
            time_step: match FAULT {
                // Takes the whole step, whatever the limit.
                'l' | 't' => own,
                // Advances by nine tenths of the displacement, and by the whole time.
                'n' => dt * 0.9,
                _ => dt,
            },
        };
        inner.step(scene, state, f64::MAX, &mut ContactRange::default())?;
        *workspace += 1;
        let q = start.orientation;
        match FAULT {
            // Linear, without scaling.
            'q' => {
                state.orientation = DQuat::from_xyzw(q.x + 1e-6, q.y, q.z, q.w);
            }
            'w' | 'r' if *workspace > 3 => state.position.x += 1e-12,
            'x' => state.position.x = f64::NAN,
            // A constant error of the velocity in a second of time.
            'o' => state.linear_velocity *= 1.0 - dt,
            _ => {}
        }
        Ok(Step::new(
            match FAULT {
                'l' => own,
                't' => dt,
                'z' => 0.0,
                's' if limit < own => dt * 1e-6,
                _ => dt,
            },
            1,
        ))
    }

    fn order(&self) -> u32 {
        if FAULT == 'p' { 2 } else { 1 }
    }

    fn clear(&self, workspace: &mut u32) {
        if FAULT != 'r' {
            *workspace = 0;
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("time step", if FAULT == 'c' { 0.0 } else { 1e-3 }, " s")
    }
}

#[test]
fn integrators_that_break_a_clause_are_caught_by_it() {
    check_integrator(&Faulty::<'_'>, CheckPlan::default()).unwrap();
    let clauses = [
        (
            fault_of_integrator(&Faulty::<'l'>),
            Requirement::KeepsToLimit,
        ),
        (fault_of_integrator(&Faulty::<'t'>), Requirement::TellsTime),
        (fault_of_integrator(&Faulty::<'n'>), Requirement::TellsTime),
        (fault_of_integrator(&Faulty::<'z'>), Requirement::TakesTime),
        (
            fault_of_integrator(&Faulty::<'s'>),
            Requirement::LandsOnLimit,
        ),
        (
            fault_of_integrator(&Faulty::<'q'>),
            Requirement::UnitOrientation,
        ),
        (
            fault_of_integrator(&Faulty::<'w'>),
            Requirement::WorkspaceChangesNothing,
        ),
        (
            fault_of_integrator(&Faulty::<'r'>),
            Requirement::WorkspaceChangesNothing,
        ),
        (fault_of_integrator(&Faulty::<'x'>), Requirement::Finite),
        (fault_of_integrator(&Faulty::<'p'>), Requirement::Order),
    ];
    for (violation, requirement) in clauses {
        assert_eq!(violation.requirement, requirement, "{violation}");
    }
    let violation = fault_of_integrator(&Faulty::<'c'>);
    assert!(
        matches!(violation.requirement, Requirement::Composes { .. }),
        "{violation}"
    );
}

#[test]
fn an_integrator_that_remembers_behind_the_workspaces_back_is_caught() {
    struct Drunk(Cell<u32>);
    impl Integrator for Drunk {
        type Workspace = ();
        fn step<D: Dynamics>(
            &self,
            scene: &D,
            state: &mut State,
            limit: f64,
            _workspace: &mut (),
        ) -> Result<Step, StepError> {
            self.0.set(self.0.get() + 1);
            state.position.x += 1e-15 * f64::from(self.0.get());
            Rk4 { time_step: 1e-3 }.step(scene, state, limit, &mut ContactRange::default())
        }
        fn order(&self) -> u32 {
            4
        }
        fn check(&self) -> Result<(), SceneError> {
            Ok(())
        }
    }
    let violation = fault_of_integrator(&Drunk(Cell::new(0)));
    assert_eq!(violation.requirement, Requirement::SameBits, "{violation}");
}

#[test]
fn an_integrator_that_refuses_a_tame_step_is_caught() {
    struct Lazy;
    impl Integrator for Lazy {
        type Workspace = ();
        fn step<D: Dynamics>(
            &self,
            _scene: &D,
            _state: &mut State,
            _limit: f64,
            _workspace: &mut (),
        ) -> Result<Step, StepError> {
            Err(StepError::Stalled)
        }
        fn order(&self) -> u32 {
            1
        }
        fn check(&self) -> Result<(), SceneError> {
            Ok(())
        }
    }
    let violation = fault_of_integrator(&Lazy);
    assert_eq!(
        violation.requirement,
        Requirement::Steps(StepError::Stalled)
    );
}

// Messages.

#[test]
fn a_breach_says_rule_values_and_input() {
    let glue = Any {
        normal_force: |d, speed| 1e3 * d + 2.0 * speed,
        ..RIGHT
    };
    let message = fault_of_ground(&glue).to_string();
    for part in ["must not pull", "got -", "bound is 0", "at depth", "m/s"] {
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn a_run_that_may_hold_more_is_no_panic_but_passes() {
    struct Whole([ContactPoint; 1], ContactRange);
    impl RigidPointBody for Whole {
        fn mass(&self) -> f64 {
            1.0
        }
        fn inertia(&self) -> DMat3 {
            DMat3::IDENTITY
        }
        fn contacts(&self) -> &[ContactPoint] {
            &self.0
        }
        fn contacts_below(&self, _normal: DVec3, _offset: f64) -> ContactRange {
            self.1
        }
    }
    for first in [0, 1, usize::MAX] {
        let run = ContactRange {
            first,
            count: usize::MAX,
        };
        let body = Whole([ContactPoint::bare(DVec3::X)], run);
        check_body(&body, CheckPlan::default()).unwrap();
    }
}

/// A part that returns a number drawn from its input: any bits, or a plausible one.
struct Noise {
    seed: u64,
    contacts: Vec<ContactPoint>,
}

impl Noise {
    /// A number for an input, the same each time.
    fn bits(&self, input: &[f64]) -> u64 {
        let mix = |hash: u64, number: &f64| {
            (hash ^ number.to_bits())
                .wrapping_mul(0x9e37_79b9_7f4a_7c15)
                .rotate_left(23)
        };
        input.iter().fold(self.seed, mix)
    }

    fn number(&self, input: &[f64], plausible: f64) -> f64 {
        let bits = self.bits(input);
        match bits % 97 {
            0 => f64::from_bits(bits),
            1 => f64::NAN,
            2 => f64::MAX,
            3 => -plausible,
            _ => plausible,
        }
    }

    fn vector(&self, input: &[f64], plausible: DVec3) -> DVec3 {
        let part = |salt: f64, value: f64| self.number(&[input, &[salt]].concat(), value);
        DVec3::new(
            part(1.0, plausible.x),
            part(2.0, plausible.y),
            part(3.0, plausible.z),
        )
    }
}

impl RigidPointBody for Noise {
    fn mass(&self) -> f64 {
        self.number(&[0.5], 1.0)
    }
    fn inertia(&self) -> DMat3 {
        DMat3::from_diagonal(self.vector(&[0.25], DVec3::ONE))
    }
    fn contacts(&self) -> &[ContactPoint] {
        &self.contacts
    }
    fn bounding_radius(&self) -> f64 {
        self.number(&[0.75], 2.0)
    }
    fn contacts_below(&self, normal: DVec3, offset: f64) -> ContactRange {
        let bits = self.bits(&[normal.x, normal.y, normal.z, offset]);
        let one = |bits: u64| match bits % 5 {
            0 => usize::MAX,
            1 => usize::MAX - 1,
            _ => usize::try_from(bits % 9).unwrap(),
        };
        match bits % 3 {
            0 => ContactRange {
                first: one(bits >> 8),
                count: one(bits >> 16),
            },
            _ => ContactRange::all(usize::MAX),
        }
    }
}

impl SpringDamperGround for Noise {
    fn surface(&self, p: DVec3) -> Surface {
        Surface {
            gap: self.number(&[p.x, p.y, p.z], p.z),
            normal: self.vector(&[p.x, p.y, p.z], DVec3::Z),
        }
    }
    fn spring_force(&self, depth: f64) -> f64 {
        self.number(&[depth, 1.0], 1e3 * depth)
    }
    fn spring_energy(&self, depth: f64) -> f64 {
        self.number(&[depth, 2.0], 5e2 * depth * depth)
    }
    fn normal_force(&self, depth: f64, speed: f64) -> f64 {
        self.number(&[depth, speed], 1e3 * depth)
    }
}

impl SlidingFriction for Noise {
    fn force(&self, load: f64, slip: DVec3) -> DVec3 {
        self.vector(&[load, slip.x, slip.y, slip.z], -slip * load)
    }
}

#[test]
fn no_number_that_a_part_returns_makes_a_check_or_a_step_panic() {
    let plan = CheckPlan { seed: 3, cases: 5 };
    let mut broken = 0;
    for seed in 0..400 {
        let corner = |i: u32| {
            let (sin, cos) = f64::from(i).sin_cos();
            ContactPoint::bare(DVec3::new(sin, cos, 0.3))
        };
        let noise = Noise {
            seed,
            contacts: (0..u32::try_from(seed % 7).unwrap()).map(corner).collect(),
        };
        // Every result is valid except a panic, an overflow, or an endless loop.
        let _ = check_body(&noise, plan);
        let _ = check_ground(&noise, &RANGE, plan);
        let _ = check_friction(&noise, &SLIDES, plan);
        let wild = noise.number(&[4.0], f64::MAX);
        let range = GroundRange {
            size: wild,
            depth: noise.number(&[5.0], 5e-324),
            ..RANGE
        };
        let _ = check_ground(&RIGHT, &range, plan);
        let slides = FrictionRange {
            centre: DVec3::splat(wild),
            size: wild,
            normal: DVec3::splat(wild),
            slip: wild,
            ..SLIDES
        };
        let _ = check_friction(&Differences(Coulomb::as_in_the_report(0.3)), &slides, plan);
        let Ok(stepper) = Stepper::new(&noise)
            .and_then(|stepper| stepper.with_ground(&noise))
            .and_then(|stepper| stepper.with_friction(&noise))
        else {
            continue;
        };
        let start = State::at(DVec3::Z * 0.2).with_linear_velocity(DVec3::X);
        let mut state = start;
        broken += usize::from(stepper.advance(&mut state, 0.02).is_err());
        let nystrom = stepper
            .with_integrator(Nystrom { time_step: 1e-3 })
            .unwrap();
        let _ = nystrom.advance(&mut { start }, 0.02);
    }
    // Not only scenes that cannot be composed.
    assert!(broken > 20, "{broken}");
}

#[test]
fn the_message_of_a_wrong_inertia_has_the_bound_of_its_moment() {
    struct Heavy(DVec3);
    impl RigidPointBody for Heavy {
        fn mass(&self) -> f64 {
            1.0
        }
        fn inertia(&self) -> DMat3 {
            DMat3::from_diagonal(self.0)
        }
        fn contacts(&self) -> &[ContactPoint] {
            &[]
        }
    }
    let said = |x, y, z| fault_of_body(&Heavy(DVec3::new(x, y, z)));
    let violation = said(0.5, 0.4, 1.0);
    assert!((violation.bound - 0.9).abs() < 1e-15, "{violation}");
    let violation = said(0.5, 0.25, 1.0);
    assert!(
        violation
            .to_string()
            .contains("got 1e0, the bound is 7.5e-1"),
        "{violation}"
    );
    // What is no number, or negative, has its rule in words.
    for (violation, rule) in [
        (said(f64::NAN, 1.0, 1.0), "must be finite: got NaN;"),
        (said(1.0, 1.0, -1.0), "must be at least 0: got -1e0;"),
    ] {
        let message = violation.to_string();
        assert!(message.contains(rule), "{message}");
        assert!(!message.contains("the bound is"), "{message}");
    }
}

#[test]
fn a_friction_law_that_pushes_is_shown_where_it_pushes_hard() {
    let motor = Rub(|load: f64, slip: DVec3| slip * (0.3 * load / (slip.length() + 1e-3)));
    let violation = fault_of_friction(&motor);
    // At the largest load, 1 kN, and the largest slip, 10 m/s: 3 kW.
    assert!((violation.value - 3e3).abs() < 1.0, "{violation}");
}

#[test]
fn a_law_in_the_textbooks_form_passes_for_all_its_rounding() {
    // Off by some rounding of 1e5 J at every depth, and below 0 at the smallest.
    struct Textbook;
    impl ContactLaw for Textbook {
        fn spring_force(&self, d: f64) -> f64 {
            1e5 * (d.exp() - 1.0)
        }
        fn spring_energy(&self, d: f64) -> f64 {
            1e5 * (d.exp() - 1.0 - d)
        }
        fn normal_force(&self, d: f64, _closing_speed: f64) -> f64 {
            self.spring_force(d)
        }
    }
    let ground = Ground::level(Textbook);
    assert!((1..100).any(|i| Textbook.spring_energy(1e-13 * f64::from(i)) < 0.0));
    for plan in batteries() {
        check_ground(&ground, &RANGE, plan).unwrap();
    }
}

/// An ellipsoid whose contact point is too near to the middle in one direction, by a share.
struct Flattened {
    semi_axes: DVec3,
    share: f64,
}

impl RigidPointBody for Flattened {
    fn mass(&self) -> f64 {
        2.0
    }
    fn inertia(&self) -> DMat3 {
        MassProperties::ellipsoid(2.0, self.semi_axes)
            .unwrap()
            .inertia
    }
    fn contacts(&self) -> &[ContactPoint] {
        const WITHIN: [ContactPoint; 1] = [ContactPoint {
            position: DVec3::ZERO,
            radius: 0.05,
        }];
        &WITHIN
    }
    fn bounding_radius(&self) -> f64 {
        self.semi_axes.max_element()
    }
    fn is_smooth(&self) -> bool {
        true
    }
    fn support_point(&self, towards: DVec3) -> DVec3 {
        let scaled = self.semi_axes * self.semi_axes * towards;
        let place = scaled / scaled.dot(towards).sqrt();
        place * DVec3::new(1.0 - self.share, 1.0, 1.0)
    }
}

/// A wrong place is farther than the right one in directions close by.
#[test]
fn a_support_point_that_is_one_per_cent_off_is_found_by_any_seed() {
    for semi_axes in [
        DVec3::new(0.3, 0.2, 0.25),
        DVec3::new(0.4, 0.1, 0.1),
        DVec3::new(0.12, 0.2, 0.6),
    ] {
        let body = |share| Flattened { semi_axes, share };
        for seed in 0..20 {
            let plan = CheckPlan {
                seed,
                ..CheckPlan::default()
            };
            check_body(&body(0.0), plan).unwrap();
            let fault = check_body(&body(0.01), plan).unwrap_err();
            assert_eq!(fault.requirement, Requirement::Support, "{semi_axes}");
        }
    }
}

/// An ellipsoid with a support function of its own, of another scale.
struct OwnSupport(Flattened, f64);

impl RigidPointBody for OwnSupport {
    fn mass(&self) -> f64 {
        self.0.mass()
    }
    fn inertia(&self) -> DMat3 {
        self.0.inertia()
    }
    fn contacts(&self) -> &[ContactPoint] {
        self.0.contacts()
    }
    fn bounding_radius(&self) -> f64 {
        self.0.bounding_radius()
    }
    fn is_smooth(&self) -> bool {
        true
    }
    fn support_point(&self, towards: DVec3) -> DVec3 {
        self.0.support_point(towards)
    }
    fn support(&self, direction: DVec3) -> f64 {
        (self.0.semi_axes * direction).length() * self.1
    }
}

/// Closed-form flight takes the body for smaller than it is.
#[test]
fn a_support_function_below_the_surface_of_a_smooth_body_is_found() {
    for semi_axes in [DVec3::new(0.3, 0.2, 0.25), DVec3::new(2.0, 0.8, 0.7)] {
        let body = |scale| {
            OwnSupport(
                Flattened {
                    semi_axes,
                    share: 0.0,
                },
                scale,
            )
        };
        let check = |scale| check_body(&body(scale), CheckPlan::default());
        check(1.0).unwrap();
        for scale in [0.8, 1.0 - 1e-9] {
            assert_eq!(
                check(scale).unwrap_err().requirement,
                Requirement::Reach,
                "{scale}"
            );
        }
    }
}

/// Euler's method for other equations: a fault that is proportional to the step changes the limit
/// and not the order.
struct OtherMotion<F>(ForwardEuler, F);

impl<F: Fn(&State, &mut State)> Integrator for OtherMotion<F> {
    type Workspace = <ForwardEuler as Integrator>::Workspace;

    fn step<D: Dynamics<f64>>(
        &self,
        scene: &D,
        state: &mut State,
        limit: f64,
        workspace: &mut Self::Workspace,
    ) -> Result<Step, StepError> {
        let start = *state;
        let step = self.0.step(scene, state, limit, workspace)?;
        (self.1)(&start, state);
        Ok(step)
    }
    fn order(&self) -> u32 {
        1
    }
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }
}

#[test]
fn a_method_that_converges_to_another_motion_is_found() {
    for time_step in [1e-5, 2e-3, 3.0] {
        let fault = |change: fn(&State, &mut State)| {
            let method = OtherMotion(ForwardEuler { time_step }, change);
            check_integrator(&method, CheckPlan::default()).map_err(|fault| fault.requirement)
        };
        assert_eq!(fault(|_, _| ()), Ok(()));
        let other = Err(Requirement::Motion);
        // Without forces, with a third more of them, without torques, with opposite ones, and with
        // half of the rotation.
        assert_eq!(
            fault(|start, end| end.linear_velocity = start.linear_velocity),
            other
        );
        assert_eq!(
            fault(|start, end| end.linear_velocity +=
                (end.linear_velocity - start.linear_velocity) / 3.0),
            other
        );
        assert_eq!(
            fault(|start, end| end.angular_momentum = start.angular_momentum),
            other
        );
        assert_eq!(
            fault(|start, end| end.angular_momentum =
                2.0 * start.angular_momentum - end.angular_momentum),
            other
        );
        assert_eq!(
            fault(|start, end| end.orientation =
                start.orientation.lerp(end.orientation, 0.5).normalize()),
            other
        );
    }
}

/// A spring whose force is no number in the last part of the range.
struct Torn(FlatGround);

impl SpringDamperGround for Torn {
    fn surface(&self, point: DVec3) -> tumble::Surface {
        self.0.surface(point)
    }
    fn spring_force(&self, depth: f64) -> f64 {
        if depth > 0.95 * RANGE.depth {
            f64::NAN
        } else {
            self.0.spring_force(depth)
        }
    }
    fn spring_energy(&self, depth: f64) -> f64 {
        self.0.spring_energy(depth)
    }
    fn normal_force(&self, depth: f64, closing_speed: f64) -> f64 {
        self.spring_force(depth) + self.0.normal_force(depth, closing_speed)
            - self.0.spring_force(depth)
    }
}

/// The messages name what is not finite, and not another quantity: the spring energy of a force
/// that is NaN was said to be too small, and a position that is NaN to be the length of the step.
#[test]
fn a_number_that_is_not_finite_is_shown() {
    let fault = fault_of_ground(&Torn(FlatGround::level(1e3, 1.0)));
    assert_eq!(fault.requirement, Requirement::Finite);
    assert!(fault.value.is_nan(), "{fault}");
    let lost = |_: &State, end: &mut State| end.position.x = f64::NAN;
    let fault = fault_of_integrator(&OtherMotion(ForwardEuler { time_step: 1e-3 }, lost));
    assert_eq!(fault.requirement, Requirement::Finite);
    assert!(fault.value.is_nan(), "{fault}");
}
