//! Tests of promise G8: invalid input returns an error. There is one test for each parameter.
//! Others check a step that fails, and arbitrary bits in every number, without a panic.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::kit::erased::Stepper;
use crate::kit::{self, Solid as AnySolid, each_explicit, each_method, point_mass};
use core::ops::ControlFlow;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use tumble::error::{LawQuantity, Quantity, Role, Rule};
use tumble::glam::{DMat3, DQuat, DVec3, Vec3};
use tumble::real::{Quaternion, Vector};
use tumble::{
    AirDrag, AnisotropicCoulomb, Block, BogackiShampine32, Bowl, Capsule, Carried, Coin, Cone,
    ConstantForce, ContactLaw, ContactPoint, Coulomb, Cuboid, Disc, Dissipation, DormandPrince54,
    Elevation, Ellipsoid, EnergyMomentum, FlatGround, ForwardEuler, FrictionField, FrictionPatch,
    Ground, HeightField, HuntCrossley, Impact, Integrator, Ledger, LimitedDamper,
    LoadDependentCoulomb, MassProperties, MovingGround, Plane, PointCloud, PointMass, Ramp, Real,
    Region, RigidPointBody, Rim, Rk4, Rod, RollingResistance, SceneError, SlidingFriction,
    SmoothCoulomb, Solid, SolidCoin, Sphere, SpringDamper, SpringDamperGround, State, StepError,
    StrangSplitting, Stribeck, Surface, SymplecticEuler, Terrain, ThickDisc, Trial, UniformGravity,
    Viscous, Waves, WithResistance,
};
use tumble::{
    Dynamics, Every, Flight, Force, Motion, Sample, Shape, Step, Timed, UntilRest, Wind, Wrench,
};

// -----------------------------------------------------------------------------------------------
// One test a parameter
// -----------------------------------------------------------------------------------------------

const NOT_FINITE: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

/// A number as a message writes it: very large and very small ones with an exponent.
fn in_a_message(number: f64) -> String {
    let has_many_digits =
        number != 0.0 && number.is_finite() && !(1e-7..1e16).contains(&number.abs());
    if has_many_digits {
        format!("{number:e}")
    } else {
        number.to_string()
    }
}

/// Checks that a scene is rejected for each invalid value, with its quantity, rule, value and unit,
/// and accepted for each valid one.
fn refuses<T>(
    quantity: &str,
    values: (Rule, &[f64], &[f64]),
    unit: &str,
    compose: impl Fn(f64) -> Result<T, SceneError>,
) {
    errors_are(quantity, values, unit, &|value| compose(value).err());
}

/// Checks the errors of [`refuses`], for any type of scene.
fn errors_are(
    quantity: &str,
    (rule, bad, good): (Rule, &[f64], &[f64]),
    unit: &str,
    error_of: &dyn Fn(f64) -> Option<SceneError>,
) {
    for &value in bad.iter().chain(&NOT_FINITE) {
        let Some(error) = error_of(value) else {
            panic!("{quantity} of {value}{unit} is accepted");
        };
        // A message says first what is wrong with a number that is not finite.
        let is_about_size = matches!(rule, Rule::AboveZero | Rule::AtLeastZero | Rule::AtLeast(_));
        let rule = if is_about_size && !value.is_finite() {
            Rule::Finite
        } else {
            rule
        };
        assert_eq!(
            error.to_string(),
            format!("{quantity} {rule}, got {}{unit}", in_a_message(value))
        );
        assert_eq!(
            (error.quantity, error.rule, error.unit),
            (quantity, rule, unit)
        );
        assert_eq!(error.value.to_bits(), value.to_bits(), "{quantity}");
    }
    for &value in good {
        if let Some(error) = error_of(value) {
            panic!("{error}");
        }
    }
}

/// Refused: 0 and less, and what is not finite.
const ABOVE_ZERO: (Rule, &[f64], &[f64]) = (
    Rule::AboveZero,
    &[0.0, -0.0, -1.0, -5e-324, -f64::MAX],
    &[5e-324, 1e-100, 1.0, 1e100, f64::MAX],
);
/// Like [`ABOVE_ZERO`], for what forces are divided by: a number that is too small for it has a
/// message of its own, in [`a_force_divided_by_a_slip_speed_does_not_overflow`].
const DIVISOR: (Rule, &[f64], &[f64]) = (
    Rule::AboveZero,
    &[0.0, -0.0, -1.0, -5e-324, -f64::MAX],
    &[1e-160, 1e-100, 1.0, 1e100, f64::MAX],
);
/// Refused: less than 0, and what is not finite.
const AT_LEAST_ZERO: (Rule, &[f64], &[f64]) = (
    Rule::AtLeastZero,
    &[-1.0, -5e-324, -f64::MAX],
    &[0.0, -0.0, 5e-324, 1.0, 1e100, f64::MAX],
);
/// Refused: what is not finite.
const FINITE: (Rule, &[f64], &[f64]) = (Rule::Finite, &[], &[0.0, -1.0, 1e100, 5e-324, -f64::MAX]);

#[test]
fn a_message_has_no_hundreds_of_digits() {
    let stepper = Stepper::new(Coin::ring(1.0, 0.5)).unwrap();
    let mut state = State::at(DVec3::Z);
    let error = stepper.advance(&mut state, -1e-320).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the time to advance by must be at least 0 s and end at a finite time, got -1e-320 s"
    );
    let error = Stepper::new(Coin::ring(-3e300, 0.5)).unwrap_err();
    assert!(error.to_string().ends_with("got -3e300 kg"), "{error}");
    let error = Stepper::new(Coin::ring(-0.25, 0.5)).unwrap_err();
    assert!(error.to_string().ends_with("got -0.25 kg"), "{error}");
}

#[test]
fn the_message_of_a_refusal_reads_as_a_sentence() {
    let stepper = Stepper::new(point_mass(1.0)).unwrap();
    let error = stepper
        .with_integrator(Rk4 { time_step: -0.001 })
        .unwrap_err();
    assert_eq!(error.to_string(), "time step must be above 0, got -0.001 s");
}

#[test]
fn a_coin_needs_a_mass_above_zero() {
    let (rule, bad, _) = ABOVE_ZERO;
    // Up to where m r² overflows.
    let limits = (rule, bad, &[1e-300, 1.0, 1e308][..]);
    refuses("mass of the coin", limits, " kg", |mass| {
        Stepper::new(Coin::ring(mass, 0.5))
    });
}

#[test]
fn a_coin_needs_a_radius_above_zero() {
    let (rule, bad, _) = ABOVE_ZERO;
    let limits = (rule, bad, &[5e-324, 1e-100, 1.0, 1e150][..]);
    refuses("radius of the coin", limits, " m", |radius| {
        Stepper::new(Coin::ring(1.0, radius))
    });
}

/// Masses from the overflow of the inverse moment to the overflow of `m r²`.
const MASS: (Rule, &[f64], &[f64]) = (ABOVE_ZERO.0, ABOVE_ZERO.1, &[1e-300, 1e-100, 1.0, 1e300]);
const LENGTH: (Rule, &[f64], &[f64]) = (ABOVE_ZERO.0, ABOVE_ZERO.1, &[5e-324, 1e-100, 1.0, 1e150]);

#[test]
fn every_solid_needs_a_mass_above_zero() {
    refuses("mass of the sphere", MASS, " kg", |mass| {
        Stepper::new(Sphere::solid(mass, 0.5))
    });
    refuses("mass of the sphere", MASS, " kg", |mass| {
        Stepper::new(Sphere::shell(mass, 0.5))
    });
    refuses("mass of the ellipsoid", MASS, " kg", |mass| {
        Stepper::new(Ellipsoid::solid(mass, DVec3::ONE))
    });
    refuses("mass of the disc", MASS, " kg", |mass| {
        Stepper::new(Disc::ring(mass, 0.5, 120))
    });
    refuses("mass of the cuboid", MASS, " kg", |mass| {
        Stepper::new(Cuboid::cube(mass, 0.5))
    });
    refuses("mass of the capsule", MASS, " kg", |mass| {
        Stepper::new(Capsule::solid(mass, 0.5, 1.0))
    });
    refuses("mass of the rod", MASS, " kg", |mass| {
        Stepper::new(Rod::new(mass, 0.5))
    });
    refuses("mass of the point", MASS, " kg", |mass| {
        Stepper::new(PointMass::new(mass))
    });
    refuses("mass of the cone", MASS, " kg", |mass| {
        Stepper::new(Cone::solid(mass, 0.5, 1.0))
    });
    refuses("mass of the coin", MASS, " kg", |mass| {
        Stepper::new(SolidCoin::new(mass, 0.5, 0.1))
    });
    refuses("mass of the coin", MASS, " kg", |mass| {
        Stepper::new(ThickDisc::solid(mass, 0.5, 0.1, 60))
    });
}

#[test]
fn every_solid_needs_lengths_above_zero() {
    refuses("radius of the sphere", LENGTH, " m", |radius| {
        Stepper::new(Sphere::solid(1.0, radius))
    });
    refuses("x edge of the cuboid", LENGTH, " m", |edge| {
        Stepper::new(Cuboid::solid(1.0, DVec3::new(edge, 0.1, 0.1)))
    });
    refuses("y edge of the cuboid", LENGTH, " m", |edge| {
        Stepper::new(Cuboid::solid(1.0, DVec3::new(0.1, edge, 0.1)))
    });
    refuses("z edge of the cuboid", LENGTH, " m", |edge| {
        Stepper::new(Cuboid::solid(1.0, DVec3::new(0.1, 0.1, edge)))
    });
    refuses("x semi-axis of the ellipsoid", LENGTH, " m", |a| {
        Stepper::new(Ellipsoid::solid(1.0, DVec3::new(a, 0.1, 0.1)))
    });
    refuses("y semi-axis of the ellipsoid", LENGTH, " m", |b| {
        Stepper::new(Ellipsoid::solid(1.0, DVec3::new(0.1, b, 0.1)))
    });
    refuses("z semi-axis of the ellipsoid", LENGTH, " m", |c| {
        Stepper::new(Ellipsoid::solid(1.0, DVec3::new(0.1, 0.1, c)))
    });
    refuses("radius of the disc", LENGTH, " m", |radius| {
        Stepper::new(Disc::ring(1.0, radius, 120))
    });
    refuses("radius of the capsule", LENGTH, " m", |radius| {
        Stepper::new(Capsule::solid(1.0, radius, 0.1))
    });
    refuses("length of the rod", LENGTH, " m", |length| {
        Stepper::new(Rod::new(1.0, length))
    });
    refuses("radius of the cone", LENGTH, " m", |radius| {
        Stepper::new(Cone::solid(1.0, radius, 0.1))
    });
    refuses("height of the cone", LENGTH, " m", |height| {
        Stepper::new(Cone::solid(1.0, 0.1, height))
    });
    refuses("radius of the coin", LENGTH, " m", |radius| {
        Stepper::new(SolidCoin::new(1.0, radius, 0.1))
    });
    refuses("thickness of the coin", LENGTH, " m", |thickness| {
        Stepper::new(SolidCoin::new(1.0, 0.1, thickness))
    });
    refuses("radius of the coin", LENGTH, " m", |radius| {
        Stepper::new(ThickDisc::solid(1.0, radius, 0.1, 60))
    });
    refuses("thickness of the coin", LENGTH, " m", |thickness| {
        Stepper::new(ThickDisc::solid(1.0, 0.1, thickness, 60))
    });
}

#[test]
fn a_capsule_may_be_a_ball_but_no_less() {
    let (rule, bad, _) = AT_LEAST_ZERO;
    let limits = (rule, bad, &[0.0, -0.0, 5e-324, 1.0, 1e150][..]);
    refuses("length of the capsule", limits, " m", |length| {
        Stepper::new(Capsule::solid(1.0, 0.1, length))
    });
}

#[test]
fn corners_of_a_box_cannot_be_rounder_than_half_its_shortest_edge() {
    let cube = Cuboid::cube(1.0, 0.5);
    let limits = (
        Rule::AtLeastZero,
        AT_LEAST_ZERO.1,
        &[0.0, 1e-100, 0.1, 0.25][..],
    );
    refuses("radius of the cuboid's corners", limits, " m", |radius| {
        Stepper::new(cube.rounded(radius))
    });
    assert_eq!(
        Stepper::new(cube.rounded(0.375)).unwrap_err().to_string(),
        "x edge of the cuboid minus its corner radii must be at least 0, got -0.25 m"
    );
    let flat = Cuboid::solid(1.0, DVec3::new(1.0, 1.0, 0.5)).rounded(0.375);
    assert_eq!(
        Stepper::new(flat).unwrap_err().to_string(),
        "z edge of the cuboid minus its corner radii must be at least 0, got -0.25 m"
    );
}

#[test]
fn rims_need_enough_points_and_opposite_ones() {
    let blank = ContactPoint::default();
    let coin = |count| {
        Stepper::new(SolidCoin::new_with_storage(
            vec![blank; count],
            1.0,
            0.5,
            0.1,
        ))
    };
    for count in 0..6 {
        assert_eq!(
            coin(count).unwrap_err().to_string(),
            format!("number of points of the coin must be at least 6, got {count}")
        );
    }
    assert_eq!(
        coin(7).unwrap_err().to_string(),
        "number of points of the coin must be even, got 7"
    );
    assert!(coin(6).is_ok());
    for count in 0..4 {
        let cone = Cone::solid_with_storage(vec![blank; count], 1.0, 0.5, 0.1);
        assert_eq!(
            Stepper::new(cone).unwrap_err().to_string(),
            format!("number of contacts of the cone must be at least 4, got {count}")
        );
    }
}

/// An egg with a rim.
struct Banded(Ellipsoid, [Rim; 1]);

impl RigidPointBody for Banded {
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
    fn rims(&self) -> &[Rim] {
        &self.1
    }
}

#[test]
fn a_smooth_body_has_no_rim() {
    let egg = Ellipsoid::solid(1.0, DVec3::new(0.4, 0.3, 0.3));
    let banded = Banded(egg, [Rim::new(DVec3::ZERO, DVec3::X, 0.3, 120)]);
    assert_eq!(
        Stepper::new(banded).err().unwrap().to_string(),
        "number of rims of a smooth body must be at most 0, got 1"
    );
}

/// A body that is nothing but rims and points.
struct Rimmed(Vec<Rim>, Vec<ContactPoint>);

impl RigidPointBody for Rimmed {
    fn mass(&self) -> f64 {
        1.0
    }
    fn inertia(&self) -> DMat3 {
        DMat3::IDENTITY
    }
    fn contacts(&self) -> &[ContactPoint] {
        &self.1
    }
    fn rims(&self) -> &[Rim] {
        &self.0
    }
}

#[test]
fn a_rim_stands_for_points_around_a_place_and_beside_few_contacts() {
    let answer = |body| Stepper::new(body).err().map(|error| error.to_string());
    let rim = |centre, normal, points| Rim::new(centre, normal, 0.5, points);
    let good = rim(DVec3::X, DVec3::Y, 120);
    let alone = |rim| answer(Rimmed(vec![rim], vec![]));
    assert_eq!(alone(good), None);
    assert_eq!(
        alone(rim(DVec3::X, DVec3::Y, 0)).unwrap(),
        "number of points that the rim represents must be above 0, got 0"
    );
    for bad in NOT_FINITE {
        let told = alone(rim(DVec3::X * bad, DVec3::Y, 120)).unwrap();
        let place = "x of the centre of the rim must be finite";
        assert!(told.starts_with(place), "{told}");
        let told = alone(rim(DVec3::X, DVec3::Y * bad, 120)).unwrap();
        assert!(told.starts_with("normal of the rim must be"), "{told}");
    }
    let told = alone(rim(DVec3::X, DVec3::ZERO, 120)).unwrap();
    assert!(told.starts_with("normal of the rim must be"), "{told}");
    // Of any length above 0, also where its square is no number.
    for length in [1e-300, 1e-160, 1e160, 1e300] {
        assert_eq!(rim(DVec3::X, DVec3::Y * length, 120), good, "{length:e}");
        let plane: Plane = Plane::through(DVec3::ZERO, DVec3::Z * length);
        assert!((plane.normal - DVec3::Z).length() < 1e-15, "{length:e}");
        let [normal, grain] = [DVec3::Z, DVec3::X].map(|v| v * length);
        let law = AnisotropicCoulomb::<f64>::on(normal, grain, [0.1, 0.2], 1e-3);
        assert!((law.along - DVec3::X).length() < 1e-15, "{length:e}");
    }
    let beside = |count| answer(Rimmed(vec![good], vec![ContactPoint::default(); count]));
    assert_eq!(beside(32), None);
    assert_eq!(
        beside(33).unwrap(),
        "number of contacts of a body with a rim must be at most 32, got 33"
    );
    assert_eq!(answer(Rimmed(vec![good; 8], vec![])), None);
    assert_eq!(
        answer(Rimmed(vec![good; 9], vec![])).unwrap(),
        "number of rims of a body must be at most 8, got 9"
    );
    // Each of them is checked.
    let last = answer(Rimmed(vec![good, rim(DVec3::X, DVec3::Y, 0)], vec![]));
    assert_eq!(
        last.unwrap(),
        "number of points that the rim represents must be above 0, got 0"
    );
}

/// A disc is saved with this number as a whole number of 32 bits.
#[cfg(all(feature = "serde", target_pointer_width = "64"))]
#[test]
fn a_rim_represents_no_more_points_than_can_be_saved() {
    let most = u32::MAX as usize;
    let round = |points| {
        let disc = Stepper::new(Disc::solid(1.0, 0.5, points)).map(|_| ());
        let thick = Stepper::new(ThickDisc::solid(1.0, 0.5, 0.1, points)).map(|_| ());
        [disc, thick]
    };
    assert_eq!(round(most), [Ok(()), Ok(())]);
    let saved = serde_json::to_string(&Disc::solid(1.0, 0.5, most)).unwrap();
    let loaded: Disc = serde_json::from_str(&saved).unwrap();
    assert_eq!(loaded, Disc::solid(1.0, 0.5, most));
    for result in round(most + 1) {
        let error = result.unwrap_err();
        assert_eq!(error.rule, Rule::AtMost(most));
        assert_eq!(
            error.to_string(),
            "number of points that the rim represents must be at most 4294967295, got 4294967296"
        );
    }
    // In single precision the neighbours of this number are 256 apart.
    let single = |points| Stepper::new(tumble::f32::Disc::solid(1.0, 0.5, points)).err();
    assert_eq!(single(most), None);
    assert_eq!(single(most + 1000).unwrap().rule, Rule::AtMost(most));
}

#[test]
fn a_composite_needs_a_mass_distribution_that_can_be_and_a_contact() {
    let of = |mass, centre_of_mass, moment| {
        let inertia = DMat3::from_diagonal(DVec3::new(1.0, 1.0, moment));
        let distribution = MassProperties {
            mass,
            centre_of_mass,
            inertia,
        };
        Solid::new(distribution, [ContactPoint::bare(DVec3::X)])
    };
    let limits = (ABOVE_ZERO.0, ABOVE_ZERO.1, &[1.0][..]);
    refuses("mass", limits, " kg", |mass| of(mass, DVec3::ZERO, 1.0));
    for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let quantity = format!("{axis} of the centre of mass");
        refuses(&quantity, FINITE, " m", |place| {
            let mut centre = [0.0; 3];
            centre[i] = place;
            of(1.0, DVec3::from(centre), 1.0)
        });
    }
    let limits = (Rule::Finite, &[][..], &[1.0][..]);
    refuses("zz of the inertia tensor", limits, " kg m²", |z| {
        of(1.0, DVec3::ZERO, z)
    });
    let ball = MassProperties::ball(1.0, 0.5).unwrap();
    assert_eq!(
        Solid::new(ball, []).unwrap_err().to_string(),
        "number of contacts must be at least 1, got 0"
    );
    refuses("radius of a contact point", AT_LEAST_ZERO, " m", |radius| {
        let position = DVec3::X;
        Solid::new(
            MassProperties::ball(1.0, 0.5).unwrap(),
            [ContactPoint { position, radius }],
        )
    });
}

#[test]
fn points_of_mass_are_checked_like_a_cloud() {
    let points = |places: &[DVec3], masses: &[f64]| MassProperties::points(places, masses);
    assert_eq!(
        points(&[], &[]).unwrap_err().to_string(),
        "number of points must be at least 1, got 0"
    );
    assert_eq!(
        points(&[DVec3::X], &[]).unwrap_err().to_string(),
        "number of masses must be 1, got 0"
    );
    assert_eq!(
        points(&[DVec3::X], &[0.0]).unwrap_err().to_string(),
        "mass of all points must be above 0, got 0 kg"
    );
    let limits = (Rule::AtLeastZero, AT_LEAST_ZERO.1, &[0.0, 1.0][..]);
    refuses("mass of a point", limits, " kg", |mass| {
        points(&[DVec3::X, DVec3::Y], &[1.0, mass])
    });
    refuses("x of a point of mass", FINITE, " m", |x| {
        points(&[DVec3::new(x, 0.0, 0.0)], &[1.0])
    });
    refuses("y of a point of mass", FINITE, " m", |y| {
        points(&[DVec3::new(0.0, y, 0.0)], &[1.0])
    });
    refuses("z of a point of mass", FINITE, " m", |z| {
        points(&[DVec3::new(0.0, 0.0, z)], &[1.0])
    });
}

/// A ball of 0.5 m that says that it is smaller, or a smooth one with another number of contacts.
#[derive(Debug)]
struct Misstated {
    contacts: Vec<ContactPoint>,
    bounding_radius: f64,
    is_smooth: bool,
}

impl RigidPointBody for Misstated {
    fn mass(&self) -> f64 {
        1.0
    }
    fn inertia(&self) -> DMat3 {
        DMat3::from_diagonal(DVec3::splat(0.1))
    }
    fn contacts(&self) -> &[ContactPoint] {
        &self.contacts
    }
    fn bounding_radius(&self) -> f64 {
        self.bounding_radius
    }
    fn is_smooth(&self) -> bool {
        self.is_smooth
    }
}

/// The ground did not see the ball until it was 0.45 m deep, a smooth body without a contact fell
/// through it, and one with two contacts had twice the force.
#[test]
fn a_body_whose_contacts_do_not_fit_it_is_refused() {
    let ball = ContactPoint {
        position: DVec3::ZERO,
        radius: 0.5,
    };
    let error = |contacts: &[ContactPoint], bounding_radius, is_smooth| {
        let body = Misstated {
            contacts: contacts.to_vec(),
            bounding_radius,
            is_smooth,
        };
        Stepper::new(body).err().map(|error| error.to_string())
    };
    for is_smooth in [false, true] {
        assert_eq!(error(&[ball], 0.5, is_smooth), None);
        assert_eq!(error(&[ball], 0.5 - 1e-12, is_smooth), None);
    }
    assert_eq!(
        error(&[ball], 0.25, false).as_deref(),
        Some(
            "distance of a contact beyond the bounding radius of the body must be at most 0, \
             got 0.25 m"
        )
    );
    assert_eq!(error(&[ball, ball], 0.5, false), None);
    for contacts in [&[][..], &[ball, ball]] {
        assert_eq!(
            error(contacts, 0.5, true),
            Some(format!(
                "number of contacts of a smooth body must be 1, got {}",
                contacts.len()
            ))
        );
    }
}

#[test]
fn a_surface_must_be_closed_and_turned_outwards() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let outwards = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let mesh = |triangles: &[[usize; 3]]| MassProperties::mesh(1.0, &corners, triangles);
    assert!(mesh(&outwards).is_ok());
    assert_eq!(
        mesh(&outwards[1..]).unwrap_err().to_string(),
        "the surface must be closed, got 0.5 m² between its edges"
    );
    // The two missing ends of a tube face each other.
    let box_of = |x: f64, y: f64, z: f64| {
        let sign = |bit: usize, number: usize| if number & bit == 0 { -0.5 } else { 0.5 };
        core::array::from_fn::<DVec3, 8, _>(|number| {
            DVec3::new(
                sign(1, number) * x,
                sign(2, number) * y,
                sign(4, number) * z,
            )
        })
    };
    let sides = [
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
        [1, 7, 5],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
    ];
    let ends = [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6]];
    let long = box_of(0.1, 0.1, 0.3);
    let all: Vec<[usize; 3]> = sides.into_iter().chain(ends).collect();
    assert!(MassProperties::mesh(1.0, &long, &all).is_ok());
    for tube in [&sides[..], &[&sides[..4], &ends].concat()] {
        let error = MassProperties::mesh(1.0, &long, tube).unwrap_err();
        assert_eq!(error.rule, Rule::Closed, "{error}");
    }
    let inwards = outwards.map(|[a, b, c]| [a, c, b]);
    assert_eq!(
        mesh(&inwards).unwrap_err().to_string(),
        format!(
            "volume within the surface must be above 0, got {} m³",
            -1.0 / 6.0
        )
    );
    assert_eq!(
        mesh(&[[0, 1, 4]]).unwrap_err().to_string(),
        "index of a vertex in a triangle of the mesh must be at most 3, got 4"
    );
    assert_eq!(
        mesh(&[]).unwrap_err().to_string(),
        "volume within the surface must be above 0, got 0 m³"
    );
    assert_eq!(
        Solid::hull(1.0, [DVec3::X, DVec3::Y, DVec3::ZERO, DVec3::ZERO])
            .unwrap_err()
            .to_string(),
        "volume within the surface must be above 0, got 0 m³"
    );
    let none = MassProperties::<f64>::hull::<DVec3>(1.0, &[]).unwrap_err();
    assert_eq!(
        none.to_string(),
        "number of vertices must be at least 4, got 0"
    );
    for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let quantity = format!("{axis} of a vertex");
        let limits = (Rule::Finite, &[][..], &[-1.0][..]);
        refuses(&quantity, limits, " m", |place| {
            let mut vertex = [-0.5; 3];
            vertex[i] = place;
            let [_, x, y, z] = corners;
            Solid::hull(1.0, [vertex.into(), x, y, z])
        });
    }
}

#[test]
fn a_coin_too_large_for_its_moments_to_be_numbers_is_refused() {
    let error = Stepper::new(Coin::ring(1.0, 1e200)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "xx of the inertia tensor must be finite, got inf kg m²"
    );
}

#[test]
fn a_coin_needs_three_points() {
    for count in 0..3 {
        let coin = Coin::ring_with_storage(vec![ContactPoint::default(); count], 1.0, 0.5);
        let error = Stepper::new(coin).unwrap_err();
        assert_eq!(
            error.to_string(),
            format!("number of points of the coin must be at least 3, got {count}")
        );
    }
    assert!(
        Stepper::new(Coin::ring_with_storage(
            [ContactPoint::default(); 3],
            1.0,
            0.5
        ))
        .is_ok()
    );
}

#[test]
fn the_mass_of_a_point_is_at_least_zero() {
    let (rule, bad, _) = AT_LEAST_ZERO;
    // The other point has a mass, and the sum must be a number.
    let limits = (rule, bad, &[0.0, -0.0, 5e-324, 1e300][..]);
    let points = [DVec3::X, DVec3::Y];
    refuses("mass of a point", limits, " kg", |mass| {
        PointCloud::new(points, [1.0, mass])
    });
}

#[test]
fn the_mass_of_all_points_is_above_zero_and_a_number() {
    let points = [DVec3::X, DVec3::Y];
    let error = PointCloud::new(points, [0.0, 0.0]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "mass of all points must be above 0, got 0 kg"
    );
    let error = PointCloud::new(points, [f64::MAX, f64::MAX]).unwrap_err();
    assert_eq!(error.rule, Rule::Finite);
    assert!(!error.value.is_finite());
}

/// The centre of mass would be infinite or NaN.
#[test]
fn a_mass_of_all_points_whose_inverse_overflows_is_refused() {
    let rule = "mass of all points must not be so small that its inverse overflows";
    let (points, masses) = ([DVec3::X, DVec3::Y], [1e-310, 0.0]);
    for error in [
        PointCloud::new(points, masses).unwrap_err(),
        MassProperties::points(&points, &masses).unwrap_err(),
    ] {
        assert_eq!(error.to_string(), format!("{rule}, got 1e-310 kg"));
    }
    let (points, mass) = ([Vec3::X], [1e-39]);
    for error in [
        PointCloud::new(points, mass).unwrap_err(),
        MassProperties::points(&points, &mass).unwrap_err(),
    ] {
        assert_eq!(error.rule, Rule::FiniteInverse, "{error}");
    }
    PointCloud::new([DVec3::X], [1e-300]).unwrap();
    PointCloud::new([Vec3::X], [1e-37]).unwrap();
}

#[test]
fn the_place_of_a_point_is_finite() {
    let (rule, bad, _) = FINITE;
    let limits = (rule, bad, &[0.0, -1.0, 5e-324, 1e100][..]);
    let cloud = |point| PointCloud::new([DVec3::ONE, point], [1.0, 1.0]);
    refuses("x of a contact point", limits, " m", |x| {
        cloud(DVec3::new(x, 0.0, 0.0))
    });
    refuses("y of a contact point", limits, " m", |y| {
        cloud(DVec3::new(0.0, y, 0.0))
    });
    refuses("z of a contact point", limits, " m", |z| {
        cloud(DVec3::new(0.0, 0.0, z))
    });
}

#[test]
fn the_radius_of_a_contact_is_at_least_zero() {
    let contact = |radius| ContactPoint {
        position: DVec3::ZERO,
        radius,
    };
    refuses("radius of a contact point", AT_LEAST_ZERO, " m", |radius| {
        PointCloud::with_storage([contact(radius)], &[1.0])
    });
}

#[test]
fn a_cloud_has_a_point_and_as_many_masses_as_points() {
    let error = PointCloud::<f64, [_; 0]>::new([], []).unwrap_err();
    assert_eq!(
        error.to_string(),
        "number of points must be at least 1, got 0"
    );
    for masses in [&[][..], &[1.0], &[1.0, 1.0, 1.0]] {
        let points = [ContactPoint::default(); 2];
        let error = PointCloud::with_storage(points, masses).unwrap_err();
        assert_eq!(
            error.to_string(),
            format!("number of masses must be 2, got {}", masses.len())
        );
    }
}

/// A user's body, which checks nothing itself.
fn solid(mass: f64, inertia: DMat3) -> AnySolid {
    AnySolid {
        mass,
        inertia,
        contacts: Vec::new(),
    }
}

#[test]
fn the_mass_of_a_users_body_is_above_zero() {
    let limits = (MASS.0, MASS.1, &[1e-300, 1.0, f64::MAX][..]);
    refuses("mass", limits, " kg", |mass| {
        Stepper::new(solid(mass, DMat3::IDENTITY))
    });
}

#[test]
fn the_contacts_of_a_users_body_are_checked_like_the_crates_own() {
    let body = |contact| AnySolid {
        contacts: vec![ContactPoint::default(), contact],
        ..solid(1.0, DMat3::IDENTITY)
    };
    let (rule, bad, _) = FINITE;
    refuses(
        "z of a contact point",
        (rule, bad, &[0.0, -1.0, 1e100]),
        " m",
        |z| Stepper::new(body(ContactPoint::bare(DVec3::new(0.0, 0.0, z)))),
    );
    let (rule, bad, _) = AT_LEAST_ZERO;
    refuses(
        "radius of a contact point",
        (rule, bad, &[0.0, 1e100]),
        " m",
        |radius| {
            Stepper::new(body(ContactPoint {
                position: DVec3::ZERO,
                radius,
            }))
        },
    );
}

#[test]
fn an_inertia_tensor_is_finite_in_each_entry() {
    let names = ["xx", "yx", "zx", "xy", "yy", "zy", "xz", "yz", "zz"];
    for (entry, name) in names.into_iter().enumerate() {
        for value in NOT_FINITE {
            let mut entries = DMat3::IDENTITY.to_cols_array();
            entries[entry] = value;
            let error = Stepper::new(solid(1.0, DMat3::from_cols_array(&entries))).unwrap_err();
            let expected = format!(
                "{name} of the inertia tensor must be finite, got {} kg m²",
                in_a_message(value)
            );
            assert_eq!(error.to_string(), expected);
        }
    }
}

#[test]
fn an_inertia_tensor_is_its_own_mirror_image() {
    for (column, row) in [(0, 1), (1, 0), (0, 2), (2, 0), (1, 2), (2, 1)] {
        let mut tensor = DMat3::IDENTITY;
        tensor.col_mut(column)[row] = 0.25;
        let error = Stepper::new(solid(1.0, tensor)).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the inertia tensor must be symmetric, got 0.25 kg m² between mirrored entries"
        );
    }
}

#[test]
fn a_principal_moment_is_at_least_zero() {
    let error = Stepper::new(AnySolid::with_moments(DVec3::new(-0.5, 1.0, 1.0))).unwrap_err();
    assert_eq!(
        error.to_string(),
        "a principal moment of inertia must be at least 0, got -0.5 kg m²"
    );
}

#[test]
fn a_principal_moment_is_at_most_the_sum_of_the_two_others() {
    for axis in 0..3 {
        let moments = |value| {
            let mut moments = DVec3::ONE;
            moments[axis] = value;
            Stepper::new(AnySolid::with_moments(moments))
        };
        let error = moments(2.5).unwrap_err();
        assert_eq!(
            error.to_string(),
            "a principal moment of inertia must not exceed the sum of the other two moments, got 2.5 kg m²"
        );
        // A rod and a plate are the limits.
        assert!(moments(0.0).is_ok() && moments(2.0).is_ok());
    }
}

/// A point on a ground.
fn on_ground(ground: FlatGround) -> Result<(), SceneError> {
    Stepper::new(point_mass(1.0))?
        .with_ground(ground)
        .map(|_| ())
}

#[test]
fn the_stiffness_of_the_ground_is_at_least_zero() {
    refuses("stiffness of the ground", AT_LEAST_ZERO, " N/m", |k| {
        on_ground(FlatGround::level(k, 0.5))
    });
}

#[test]
fn the_damping_of_the_ground_is_at_least_zero() {
    refuses("damping of the ground", AT_LEAST_ZERO, " N s/m", |c| {
        on_ground(FlatGround::level(1e3, c))
    });
}

#[test]
fn the_numbers_of_a_law_of_contact_are_in_their_ranges() {
    fn on(law: impl ContactLaw) -> Result<(), SceneError> {
        let ground: Ground<_, Plane> = Ground::level(law);
        Stepper::new(point_mass(1.0))?
            .with_ground(ground)
            .map(|_| ())
    }
    let (stiffness, exponent, damping) = (1e3, 1.5, 0.1);
    for (name, unit, compose) in [
        (
            "stiffness of the ground",
            " N/m",
            &(|k| {
                on(LimitedDamper {
                    stiffness: k,
                    damping,
                })
            }) as &dyn Fn(f64) -> Result<(), SceneError>,
        ),
        ("stiffness of the ground", " N/m", &|k| {
            on(SpringDamper {
                stiffness: k,
                damping,
            })
        }),
        ("stiffness of the ground", " N/m^n", &|k| {
            on(HuntCrossley {
                stiffness: k,
                exponent,
                damping,
            })
        }),
        ("damping of the ground", " N s/m", &|c| {
            on(LimitedDamper {
                stiffness,
                damping: c,
            })
        }),
        ("damping of the ground", " N s/m", &|c| {
            on(SpringDamper {
                stiffness,
                damping: c,
            })
        }),
        ("damping of the ground", " s/m", &|c| {
            on(HuntCrossley {
                stiffness,
                exponent,
                damping: c,
            })
        }),
    ] {
        refuses(name, AT_LEAST_ZERO, unit, compose);
    }
    let at_least_one: (Rule, &[f64], &[f64]) =
        (Rule::AtLeast(1), &[0.0, 0.999_999, -1.5], &[1.0, 1.5, 7.0]);
    refuses("exponent of the ground", at_least_one, "", |exponent| {
        on(HuntCrossley {
            stiffness,
            exponent,
            damping,
        })
    });
}

#[test]
fn the_numbers_of_a_terrain_are_in_their_ranges() {
    fn on(height_field: impl HeightField) -> Result<(), SceneError> {
        let law = SpringDamper {
            stiffness: 1e3,
            damping: 0.5,
        };
        let ground = Ground {
            law,
            shape: Terrain { height_field },
        };
        Stepper::new(point_mass(1.0))?
            .with_ground(ground)
            .map(|_| ())
    }
    let finite: (Rule, &[f64], &[f64]) = (Rule::Finite, &[], &[0.0, -1.0, 1e9]);
    refuses("curvature of the bowl along x", finite, " 1/m", |number| {
        on(Bowl {
            curvatures: [number, 1.0],
        })
    });
    refuses("curvature of the bowl along y", finite, " 1/m", |number| {
        on(Bowl {
            curvatures: [1.0, number],
        })
    });
    refuses("slope of the ramp", finite, "", |slope| {
        on(Ramp { slope, width: 1.0 })
    });
    refuses("width of the ramp", ABOVE_ZERO, " m", |width| {
        on(Ramp { slope: 0.5, width })
    });
    refuses("amplitude of the waves", finite, " m", |amplitude| {
        on(Waves {
            amplitude,
            length: 1.0,
        })
    });
    let waves = |length| {
        on(Waves {
            amplitude: 0.1,
            length,
        })
    };
    let limits = (ABOVE_ZERO.0, ABOVE_ZERO.1, &[1e-100, 1.0, f64::MAX][..]);
    refuses("length of the waves", limits, " m", waves);
    // The slope of shorter waves would be infinity times 0.
    for length in [5e-324, 1e-308, 1e-160] {
        let error = waves(length).unwrap_err();
        assert_eq!(error.quantity, "square of the length of the waves");
        assert_eq!(error.rule, Rule::FiniteInverse);
    }
}

#[test]
fn a_law_whose_stiffness_overflows_is_refused_where_it_is_made() {
    let carried = Carried {
        mass: 1.0,
        contacts: 4,
    };
    let impact = Impact {
        speed: 1.0,
        restitution: 0.5,
    };
    let errors = [
        SpringDamper::from_bounce(carried, 0.5, 1e-200).unwrap_err(),
        SpringDamper::from_rest(carried, 0.5, 1e-300, 1e300).unwrap_err(),
        LimitedDamper::from_bounce(carried, 0.5, 1e-200).unwrap_err(),
        HuntCrossley::from_bounce(carried, 1.5, impact, 1e-200).unwrap_err(),
        HuntCrossley::from_contact_time(carried, 1.5, impact, 1e-200).unwrap_err(),
        HuntCrossley::from_rest(carried, 1.5, impact, 1e-250, 9.8).unwrap_err(),
    ];
    for error in errors {
        assert_eq!(error.quantity, "stiffness of the ground");
        assert_eq!(error.rule, Rule::Finite);
        assert!(error.value.is_infinite());
    }
}

#[test]
fn a_law_whose_stiffness_is_rounded_to_zero_is_refused_where_it_is_made() {
    let carried = Carried {
        mass: 1e-30,
        contacts: 4,
    };
    let impact = Impact {
        speed: 1.0,
        restitution: 0.5,
    };
    let errors = [
        SpringDamper::from_bounce(carried, 0.5, 1e160).unwrap_err(),
        SpringDamper::from_rest(carried, 0.5, 1e300, 1e-300).unwrap_err(),
        LimitedDamper::from_bounce(carried, 0.5, 1e160).unwrap_err(),
        HuntCrossley::from_bounce(carried, 1.5, impact, 1e200).unwrap_err(),
        HuntCrossley::from_contact_time(carried, 1.5, impact, 1e200).unwrap_err(),
        HuntCrossley::from_rest(carried, 1.5, impact, 1e250, 9.8).unwrap_err(),
    ];
    for error in errors {
        assert_eq!(error.quantity, "stiffness of the ground");
        assert_eq!((error.rule, error.value), (Rule::AboveZero, 0.0));
    }
}

#[test]
fn what_a_law_is_made_from_is_in_its_range() {
    let body = Carried {
        mass: 1.0,
        contacts: 4,
    };
    let of = |mass| Carried { mass, contacts: 4 };
    let impact = |speed, restitution| Impact { speed, restitution };
    let above_zero: (Rule, &[f64], &[f64]) = (Rule::AboveZero, &[0.0, -1.0], &[1e-9, 1.0, 1e9]);
    let part: (Rule, &[f64], &[f64]) = (
        Rule::AboveZeroToOne,
        &[0.0, -0.5, 1.000_001, 7.0],
        &[1e-9, 0.5, 1.0],
    );
    refuses("restitution", part, "", |e| {
        SpringDamper::from_bounce(body, e, 1e-3)
    });
    refuses("restitution", part, "", |e| {
        SpringDamper::from_rest(body, e, 1e-3, 9.8)
    });
    refuses("restitution", part, "", |e| {
        LimitedDamper::from_bounce(body, e, 1e-3)
    });
    refuses("restitution", part, "", |e| {
        LimitedDamper::from_rest(body, e, 1e-3, 9.8)
    });
    refuses("restitution", part, "", |e| {
        HuntCrossley::from_bounce(body, 1.5, impact(1.0, e), 1e-3)
    });
    refuses("restitution", part, "", |e| {
        HuntCrossley::from_contact_time(body, 1.5, impact(1.0, e), 1e-3)
    });
    refuses("restitution", part, "", |e| {
        HuntCrossley::from_rest(body, 1.5, impact(1.0, e), 1e-3, 9.8)
    });
    refuses("time of a bounce", above_zero, " s", |t| {
        SpringDamper::from_bounce(body, 0.5, t)
    });
    refuses("time of a bounce", above_zero, " s", |t| {
        LimitedDamper::from_bounce(body, 0.5, t)
    });
    refuses("time of a bounce", above_zero, " s", |t| {
        HuntCrossley::from_contact_time(body, 1.5, impact(1.0, 0.5), t)
    });
    refuses("depth at rest", above_zero, " m", |d| {
        SpringDamper::from_rest(body, 0.5, d, 9.8)
    });
    refuses("depth at rest", above_zero, " m", |d| {
        LimitedDamper::from_rest(body, 0.5, d, 9.8)
    });
    refuses("depth at rest", above_zero, " m", |d| {
        HuntCrossley::from_rest(body, 1.5, impact(1.0, 0.5), d, 9.8)
    });
    refuses("gravity", above_zero, " m/s²", |g| {
        SpringDamper::from_rest(body, 0.5, 1e-3, g)
    });
    refuses("gravity", above_zero, " m/s²", |g| {
        LimitedDamper::from_rest(body, 0.5, 1e-3, g)
    });
    refuses("gravity", above_zero, " m/s²", |g| {
        HuntCrossley::from_rest(body, 1.5, impact(1.0, 0.5), 1e-3, g)
    });
    refuses("speed of a bounce", above_zero, " m/s", |v| {
        HuntCrossley::from_bounce(body, 1.5, impact(v, 0.5), 1e-3)
    });
    refuses("speed of a bounce", above_zero, " m/s", |v| {
        HuntCrossley::from_contact_time(body, 1.5, impact(v, 0.5), 1e-3)
    });
    refuses("speed of a bounce", above_zero, " m/s", |v| {
        HuntCrossley::from_rest(body, 1.5, impact(v, 0.5), 1e-3, 9.8)
    });
    refuses("depth of a bounce", above_zero, " m", |d| {
        HuntCrossley::from_bounce(body, 1.5, impact(1.0, 0.5), d)
    });
    refuses("mass of the body", above_zero, " kg", |m| {
        SpringDamper::from_bounce(of(m), 0.5, 1e-3)
    });
    let nobody = Carried {
        contacts: 0,
        ..body
    };
    let error = SpringDamper::from_bounce(nobody, 0.5, 1e-3).unwrap_err();
    assert_eq!(
        error.to_string(),
        "number of contacts that support the body must be at least 1, got 0"
    );
    for made in [
        HuntCrossley::from_bounce(body, 0.5, impact(1.0, 0.5), 1e-3),
        HuntCrossley::from_contact_time(body, 0.5, impact(1.0, 0.5), 1e-3),
    ] {
        assert_eq!(
            made.unwrap_err().to_string(),
            "exponent of the ground must be at least 1, got 0.5"
        );
    }
}

#[test]
fn the_height_of_the_plane_is_finite() {
    refuses("height of the plane", FINITE, " m", |height| {
        on_ground(FlatGround::level(1e3, 0.5).on(Plane::level(height)))
    });
}

#[test]
fn the_normal_of_the_plane_has_length_one() {
    let with_normal = |normal| {
        on_ground(FlatGround::level(1e3, 0.5).on(Plane {
            normal,
            height: 0.0,
        }))
    };
    for (normal, length) in [
        (DVec3::ZERO, "0"),
        (DVec3::Z * 2.0, "2"),
        (DVec3::Z * 0.5, "0.5"),
        (DVec3::new(f64::NAN, 0.0, 1.0), "NaN"),
        (DVec3::new(0.0, f64::INFINITY, 1.0), "inf"),
        (DVec3::Z * 1e200, "inf"),
    ] {
        let error = with_normal(normal).unwrap_err();
        assert_eq!(
            error.to_string(),
            format!("normal of the plane must have length 1, got {length}")
        );
    }
    assert!(with_normal(DVec3::new(0.6, 0.0, 0.8)).is_ok());
    // A normal of length 0 has no direction.
    let error = on_ground(FlatGround::level(1e3, 0.5).on(Plane::through(DVec3::ZERO, DVec3::ZERO)))
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "normal of the plane must have length 1, got NaN"
    );
}

#[test]
fn the_coefficient_of_friction_is_at_least_zero() {
    let body = || Stepper::new(point_mass(1.0)).unwrap();
    let slip_speed = 1e-3;
    refuses(
        "coefficient of friction",
        AT_LEAST_ZERO,
        "",
        |coefficient| {
            body().with_friction(Coulomb {
                coefficient,
                slip_speed,
            })
        },
    );
    refuses(
        "coefficient of friction",
        AT_LEAST_ZERO,
        "",
        |coefficient| {
            body().with_friction(SmoothCoulomb {
                coefficient,
                slip_speed,
            })
        },
    );
}

#[test]
fn the_numbers_of_friction_that_falls_with_the_load_are_in_their_ranges() {
    let law = LoadDependentCoulomb {
        coefficient: 0.3,
        transition_load: 50.0,
        slip_speed: 1e-4,
    };
    let with = |law: LoadDependentCoulomb| Stepper::new(point_mass(1.0))?.with_friction(law);
    refuses("coefficient of friction", AT_LEAST_ZERO, "", |number| {
        with(LoadDependentCoulomb {
            coefficient: number,
            ..law
        })
    });
    let load = "transition load of the friction";
    refuses(load, ABOVE_ZERO, " N", |number| {
        with(LoadDependentCoulomb {
            transition_load: number,
            ..law
        })
    });
    refuses("slip speed of the friction", DIVISOR, " m/s", |number| {
        with(LoadDependentCoulomb {
            slip_speed: number,
            ..law
        })
    });
}

#[test]
fn the_numbers_of_stribecks_friction_are_in_their_ranges() {
    let law = Stribeck {
        static_coefficient: 0.4,
        kinetic_coefficient: 0.3,
        stribeck_speed: 0.01,
        viscous: 0.0,
        slip_speed: 1e-4,
    };
    let with = |law: Stribeck| Stepper::new(point_mass(1.0))?.with_friction(law);
    refuses(
        "static coefficient of friction",
        AT_LEAST_ZERO,
        "",
        |number| {
            with(Stribeck {
                static_coefficient: number,
                ..law
            })
        },
    );
    refuses(
        "kinetic coefficient of friction",
        AT_LEAST_ZERO,
        "",
        |number| {
            with(Stribeck {
                kinetic_coefficient: number,
                ..law
            })
        },
    );
    refuses(
        "Stribeck speed of the friction",
        ABOVE_ZERO,
        " m/s",
        |number| {
            with(Stribeck {
                stribeck_speed: number,
                ..law
            })
        },
    );
    refuses("viscous friction", AT_LEAST_ZERO, " s/m", |number| {
        with(Stribeck {
            viscous: number,
            ..law
        })
    });
    refuses("slip speed of the friction", DIVISOR, " m/s", |number| {
        with(Stribeck {
            slip_speed: number,
            ..law
        })
    });
    refuses("viscous friction", AT_LEAST_ZERO, " s/m", |coefficient| {
        Stepper::new(point_mass(1.0))?.with_friction(Viscous { coefficient })
    });
}

#[test]
fn the_numbers_of_turning_resistance_are_in_their_ranges() {
    let law = WithResistance {
        friction: Viscous { coefficient: 1.0 },
        rolling: 1e-3,
        spinning: 1e-3,
        turn_speed: 1e-3,
    };
    let with = |law: WithResistance<Viscous>| {
        Stepper::new(point_mass(1.0))?
            .with_friction(law)
            .map(|_| ())
    };
    refuses(
        "length of the rolling resistance",
        AT_LEAST_ZERO,
        " m",
        |rolling| with(WithResistance { rolling, ..law }),
    );
    refuses(
        "length of the spinning resistance",
        AT_LEAST_ZERO,
        " m",
        |spinning| with(WithResistance { spinning, ..law }),
    );
    refuses(
        "turn speed of the resistance",
        DIVISOR,
        " rad/s",
        |turn_speed| with(WithResistance { turn_speed, ..law }),
    );
    // The resistance of the law inside would have no effect.
    let nested = WithResistance {
        friction: law,
        rolling: 1e-3,
        spinning: 1e-3,
        turn_speed: 1e-3,
    };
    let told = Stepper::new(point_mass(1.0))
        .unwrap()
        .with_friction(nested)
        .map(|_| ())
        .unwrap_err()
        .to_string();
    assert_eq!(
        told,
        "number of resistances in a law with resistance must be 0, got 1"
    );
    refuses("viscous friction", AT_LEAST_ZERO, " s/m", |coefficient| {
        with(WithResistance {
            friction: Viscous { coefficient },
            ..law
        })
    });
}

/// The law divides by slip speed times coefficient.
#[test]
fn a_small_coefficient_along_a_grain_does_not_make_the_divisor_zero() {
    let scene = |coefficient: f64| {
        let law = AnisotropicCoulomb::on(DVec3::Z, DVec3::X, [coefficient; 2], 1e-150);
        Stepper::new(point_mass(1.0))?
            .with_friction(law)
            .map(|_| ())
    };
    let error = scene(1e-20).unwrap_err();
    assert_eq!(error.rule, Rule::SafeDivisor);
    assert_eq!(
        error.quantity,
        "slip speed times coefficient of the friction"
    );
    assert_eq!(
        [0.0, 1e-10].map(|coefficient| scene(coefficient).is_ok()),
        [true; 2]
    );
}

#[test]
fn the_numbers_of_friction_with_a_grain_are_in_their_ranges() {
    let law = AnisotropicCoulomb::on(DVec3::Z, DVec3::X, [0.3, 0.5], 1e-3);
    let with = |law: AnisotropicCoulomb| {
        Stepper::new(point_mass(1.0))?
            .with_friction(law)
            .map(|_| ())
    };
    let names = [
        "coefficient of friction along the grain",
        "coefficient of friction across the grain",
    ];
    for (i, name) in names.into_iter().enumerate() {
        refuses(name, AT_LEAST_ZERO, "", |number| {
            let mut law = law;
            law.coefficients[i] = number;
            with(law)
        });
    }
    refuses("slip speed of the friction", DIVISOR, " m/s", |number| {
        let mut law = law;
        law.slip_speed = number;
        with(law)
    });
    let refusal = |along, across| {
        let mut law = law;
        (law.along, law.across) = (along, across);
        with(law).unwrap_err().to_string()
    };
    assert_eq!(
        refusal(DVec3::X * 2.0, DVec3::Y),
        "direction of the friction along the grain must have length 1, got 2"
    );
    assert_eq!(
        refusal(DVec3::X, DVec3::NAN),
        "direction of the friction across the grain must have length 1, got NaN"
    );
    assert_eq!(
        refusal(DVec3::X, DVec3::X),
        "cosine between the directions of the friction must be 0, got 1"
    );
}

#[test]
fn a_friction_region_is_finite_with_a_unit_direction_and_a_width_of_at_least_zero() {
    let law = Coulomb {
        coefficient: 0.3,
        slip_speed: 1e-3,
    };
    let refusal = |region: Region| {
        let friction = FrictionPatch {
            outside: law,
            inside: law,
            region,
        };
        let result = Stepper::new(point_mass(1.0))
            .unwrap()
            .with_friction(friction);
        result.err().map(|error| error.to_string())
    };
    let strip = |across, from, to| refusal(Region::Strip { across, from, to });
    let half = |across, from| refusal(Region::HalfSpace { across, from });
    let ball = |centre, radius| refusal(Region::Ball { centre, radius });
    for found in [strip(DVec3::X * 2.0, 0.0, 1.0), half(DVec3::X * 2.0, 0.0)] {
        assert_eq!(
            found.as_deref(),
            Some("direction of the friction region must have length 1, got 2")
        );
    }
    for value in NOT_FINITE {
        let edge = format!("edge of the friction region must be finite, got {value} m");
        let told = strip(DVec3::X, value, 1.0);
        assert_eq!(told, Some(format!("lower {edge}")));
        let told = strip(DVec3::X, 0.0, value);
        assert_eq!(told, Some(format!("upper {edge}")));
        assert_eq!(half(DVec3::X, value).as_ref(), Some(&edge));
        let told = ball(DVec3::new(1e200, value, 0.0), 1.0);
        let centre = "y of the centre of the friction region must be finite";
        assert_eq!(told, Some(format!("{centre}, got {value} m")));
        assert!(ball(DVec3::ZERO, value).is_some());
    }
    assert_eq!(
        strip(DVec3::X, 1.0, 0.5).as_deref(),
        Some("width of the friction region must be at least 0, got -0.5 m")
    );
    assert_eq!(
        ball(DVec3::ZERO, -0.5).as_deref(),
        Some("radius of the friction region must be at least 0, got -0.5 m")
    );
    assert_eq!(strip(DVec3::X, 0.0, 0.0), None);
    assert_eq!(ball(DVec3::X * 1e200, 1.0), None);
}

/// The law of a position is not known when the scene is composed, so a step refuses it.
#[test]
fn a_field_of_invalid_laws_ends_the_step_that_meets_one() {
    for bad in [-0.3, f64::NAN, f64::INFINITY] {
        let field = FrictionField::new(|position: DVec3| Coulomb {
            coefficient: if position.x < 0.2 { 0.3 } else { bad },
            slip_speed: 1e-3,
        });
        each_method!(1e-3, |integrator, name| {
            let stepper = Stepper::new(point_mass(1.0))
                .and_then(|stepper| stepper.with_gravity(UniformGravity::down(9.8)))
                .and_then(|stepper| stepper.with_ground(FlatGround::level(1e4, 100.0)))
                .and_then(|stepper| stepper.with_friction(field))
                .and_then(|stepper| stepper.with_integrator(integrator))
                .unwrap();
            let mut state = State::at(DVec3::Z * -9.8e-4).with_linear_velocity(DVec3::X * 2.0);
            let error = stepper.advance(&mut state, 1.0).unwrap_err();
            assert!(
                matches!(
                    error,
                    StepError::BrokenLaw {
                        quantity: LawQuantity::FrictionForce | LawQuantity::FrictionPower,
                        ..
                    }
                ),
                "{name}: {error}"
            );
            let x = state.position.x;
            assert!(
                state.not_finite().is_none() && x > 0.19 && x < 0.21,
                "{name}: {x} m"
            );
        });
    }
}

#[test]
fn the_slip_speed_of_friction_is_above_zero() {
    let body = || Stepper::new(point_mass(1.0)).unwrap();
    let coefficient = 0.3;
    refuses(
        "slip speed of the friction",
        DIVISOR,
        " m/s",
        |slip_speed| {
            body().with_friction(Coulomb {
                coefficient,
                slip_speed,
            })
        },
    );
    refuses(
        "slip speed of the friction",
        DIVISOR,
        " m/s",
        |slip_speed| {
            body().with_friction(SmoothCoulomb {
                coefficient,
                slip_speed,
            })
        },
    );
}

/// A box of 50 kg slides and turns on stiff ground, under forces of up to 1e5 N. The law has a
/// divisor that is just large enough. One that is just too small is refused.
fn a_divisor_is_large_enough<R: Real, F: SlidingFriction<R> + Copy>(law: impl Fn(R) -> F) {
    let real = R::from_f64;
    let vector = |x, y, z| R::Vec3::new(real(x), real(y), real(z));
    let body = Cuboid::<R>::solid(real(50.0), vector(0.3, 0.2, 0.1));
    let (gravity, time_step) = (UniformGravity::down(real(9.81)), real(1e-3));
    let scene = |divisor: f64| {
        Stepper::<EnergyMomentum<R>, R>::builder(body)
            .gravity(gravity)
            .ground(FlatGround::<R>::level(real(1e7), real(100.0)))
            .friction(law(real(divisor)))
            .integrator(EnergyMomentum { time_step })
            .build()
    };
    // Half of the smallest number above 0 is rounded to 0.
    let least = (4.0 / R::MAX.to_f64()).sqrt() * (R::EPSILON.to_f64() / 2.0).sqrt();
    let error = scene(0.9 * least).unwrap_err();
    assert_eq!(error.rule, Rule::SafeDivisor);
    assert_eq!(error.value.to_bits(), real(0.9 * least).to_f64().to_bits());
    assert!(error.quantity.contains(" speed of the "), "{error}");
    let start = State::at(vector(0.0, 0.0, 0.05))
        .with_linear_velocity(vector(1.0, 0.5, -1.0))
        .with_angular_momentum(vector(1.0, 0.0, 10.0));
    let mut state = start;
    scene(1.1 * least)
        .unwrap()
        .advance(&mut state, real(0.2))
        .unwrap();
    let distance = state.position.x().to_f64();
    assert!(
        state.not_finite().is_none() && (0.01..0.199).contains(&distance),
        "{distance}"
    );
}

#[test]
fn a_force_divided_by_a_slip_speed_does_not_overflow() {
    divisors_are_large_enough::<f64>();
    divisors_are_large_enough::<f32>();
}

fn divisors_are_large_enough<R: Real>() {
    let (coefficient, other) = (R::from_f64(0.3), R::from_f64(0.2));
    a_divisor_is_large_enough(|slip_speed: R| Coulomb {
        coefficient,
        slip_speed,
    });
    a_divisor_is_large_enough(|slip_speed: R| SmoothCoulomb {
        coefficient,
        slip_speed,
    });
    a_divisor_is_large_enough(|slip_speed: R| LoadDependentCoulomb {
        coefficient,
        transition_load: R::ONE,
        slip_speed,
    });
    a_divisor_is_large_enough(|slip_speed: R| Stribeck {
        static_coefficient: coefficient,
        kinetic_coefficient: other,
        stribeck_speed: R::ONE,
        viscous: R::ZERO,
        slip_speed,
    });
    let axis = |x, y, z| R::Vec3::new(R::from_f64(x), R::from_f64(y), R::from_f64(z));
    a_divisor_is_large_enough(|slip_speed: R| {
        AnisotropicCoulomb::on(
            axis(0.0, 0.0, 1.0),
            axis(1.0, 0.0, 0.0),
            [R::ONE, coefficient],
            slip_speed,
        )
    });
    a_divisor_is_large_enough(|turn_speed: R| WithResistance {
        friction: Coulomb {
            coefficient,
            slip_speed: R::from_f64(1e-3),
        },
        rolling: R::from_f64(1e-4),
        spinning: R::from_f64(1e-3),
        turn_speed,
    });
}

#[test]
fn each_component_of_gravity_is_finite() {
    for axis in 0..3 {
        let limits = (Rule::Finite, &[][..], &[0.0, -1.0, 1e100, -1e153][..]);
        let quantity = format!("{} of the acceleration by gravity", AXES[axis]);
        refuses(&quantity, limits, " m/s²", |g| {
            let mut acceleration = DVec3::new(1.0, 2.0, 3.0);
            acceleration[axis] = g;
            Stepper::new(point_mass(1.0))?.with_gravity(UniformGravity { acceleration })
        });
    }
}

/// Names of the components of a vector.
const AXES: [&str; 3] = ["x", "y", "z"];

/// The vector 1, 2, 3 with another number along one axis.
fn with_component(axis: usize, value: f64) -> DVec3 {
    let mut vector = DVec3::new(1.0, 2.0, 3.0);
    vector[axis] = value;
    vector
}

#[test]
fn each_component_of_a_force_and_of_the_wind_is_finite() {
    let limits = (Rule::Finite, &[][..], &[0.0, -1.0, 1e100][..]);
    for (axis, name) in AXES.into_iter().enumerate() {
        let quantity = format!("{name} of the constant force");
        refuses(&quantity, limits, " N", |value| {
            let force = with_component(axis, value);
            Stepper::new(point_mass(1.0))?.with_force(ConstantForce { force })
        });
        let quantity = format!("{name} of the velocity of the wind");
        refuses(&quantity, limits, " m/s", |value| {
            let (velocity, force) = (with_component(axis, value), AirDrag::linear(0.1));
            Stepper::new(point_mass(1.0))?.with_force(Wind { velocity, force })
        });
    }
}

#[test]
fn each_component_of_a_block_is_in_its_range() {
    let check = |centre, half| {
        let block: Block = Block { centre, half };
        block.check()
    };
    for (axis, name) in AXES.into_iter().enumerate() {
        let quantity = format!("{name} of the centre of the block");
        // The square of 1e200 overflows.
        let limits = (Rule::Finite, &[][..], &[0.0, -1e200][..]);
        refuses(&quantity, limits, " m", |value| {
            check(with_component(axis, value), DVec3::ONE)
        });
        let quantity = format!("half of the {name} length of the block");
        refuses(&quantity, ABOVE_ZERO, " m", |value| {
            check(DVec3::ZERO, with_component(axis, value))
        });
    }
}

/// A mass or a moment of a body of kilograms and metres, with its other numbers, that is so small
/// that the body would be moved by an infinity; and a force of gravity that is one.
#[test]
fn a_scene_whose_inverse_mass_or_weight_overflows_is_refused() {
    let message = |error: SceneError| error.to_string();
    for mass in [5e-324, 1e-320, 5e-309] {
        let body = AnySolid {
            mass,
            ..AnySolid::with_moments(DVec3::ZERO)
        };
        assert_eq!(
            message(Stepper::new(body).unwrap_err()),
            format!(
                "mass must not be so small that its inverse overflows, got {} kg",
                in_a_message(mass)
            )
        );
    }
    for moment in [5e-324, 1e-320] {
        let error = Stepper::new(AnySolid::with_moments(DVec3::splat(moment))).unwrap_err();
        let rule = "must not be so small that its inverse overflows";
        assert_eq!(
            message(error),
            format!(
                "a principal moment of inertia {rule}, got {} kg m²",
                in_a_message(moment)
            )
        );
    }
    for (mass, g) in [(1e200, 1e200), (f64::MAX, 1.1), (1.0, 1e155)] {
        let stepper = Stepper::new(PointMass::new(mass)).unwrap();
        let error = stepper.with_gravity(UniformGravity::down(g)).unwrap_err();
        assert_eq!(
            message(error),
            "weight (mass times gravity) must be finite, got inf N"
        );
    }
    let single = Stepper::new(PointMass::new(1e30_f32)).unwrap();
    assert!(single.with_gravity(UniformGravity::down(1e9)).is_err());
    let far = AnySolid {
        contacts: vec![ContactPoint::bare(DVec3::splat(1e155))],
        ..AnySolid::with_moments(DVec3::ONE)
    };
    assert_eq!(
        message(Stepper::new(far).unwrap_err()),
        "bounding radius of the body must be finite, got inf m"
    );
}

#[test]
fn the_parameters_of_an_observer_are_in_their_ranges() {
    let point = point_mass(1.0);
    let nothing = || |_: &Sample<'_>| ControlFlow::<()>::Continue(());
    refuses("interval of the samples", ABOVE_ZERO, " s", |seconds| {
        Timed::every(seconds, nothing())
    });
    refuses("time of a body at rest", ABOVE_ZERO, " s", |seconds| {
        UntilRest::new(&point, 1e-4, seconds)
    });
    refuses("distance of a body at rest", AT_LEAST_ZERO, " m", |d| {
        UntilRest::new(&point, d, 0.25)
    });
    let error = Every::steps(0, nothing()).err().unwrap();
    assert_eq!(
        error.to_string(),
        "number of steps between samples must be at least 1, got 0"
    );
    assert!(Every::steps(1, nothing()).is_ok());
}

#[test]
fn the_time_step_of_each_integrator_is_above_zero() {
    let body = || Stepper::new(point_mass(1.0)).unwrap();
    refuses("time step", ABOVE_ZERO, " s", |time_step| {
        body().with_integrator(ForwardEuler { time_step })
    });
    refuses("time step", ABOVE_ZERO, " s", |time_step| {
        body().with_integrator(SymplecticEuler { time_step })
    });
    refuses("time step", ABOVE_ZERO, " s", |time_step| {
        body().with_integrator(StrangSplitting { time_step })
    });
    refuses("time step", ABOVE_ZERO, " s", |time_step| {
        body().with_integrator(Rk4 { time_step })
    });
    refuses("time step", ABOVE_ZERO, " s", |time_step| {
        body().with_integrator(EnergyMomentum { time_step })
    });
}

#[test]
fn the_tolerance_and_the_longest_step_of_each_pair_are_above_zero() {
    let body = || Stepper::new(point_mass(1.0)).unwrap();
    refuses("tolerance", ABOVE_ZERO, " m", |tolerance| {
        body().with_integrator(BogackiShampine32::new(tolerance))
    });
    refuses("tolerance", ABOVE_ZERO, " m", |tolerance| {
        body().with_integrator(DormandPrince54::new(tolerance))
    });
    refuses("longest step", ABOVE_ZERO, " s", |longest_step| {
        body().with_integrator(BogackiShampine32 {
            longest_step,
            ..BogackiShampine32::new(1e-5)
        })
    });
    refuses("longest step", ABOVE_ZERO, " s", |longest_step| {
        body().with_integrator(DormandPrince54 {
            longest_step,
            ..DormandPrince54::new(1e-5)
        })
    });
}

#[test]
fn the_budget_of_each_pair_is_at_least_one_step() {
    let body = || Stepper::new(point_mass(1.0)).unwrap();
    let (bogacki_shampine, dormand_prince) = (
        BogackiShampine32 {
            budget: 0,
            ..BogackiShampine32::new(1e-5)
        },
        DormandPrince54 {
            budget: 0,
            ..DormandPrince54::new(1e-5)
        },
    );
    for error in [
        body().with_integrator(bogacki_shampine).unwrap_err(),
        body().with_integrator(dormand_prince).unwrap_err(),
    ] {
        assert_eq!(
            error.to_string(),
            "budget of steps must be at least 1, got 0"
        );
    }
}

#[test]
fn the_time_step_in_single_precision_is_above_zero() {
    let body = PointCloud::new([Vec3::ZERO], [1.0_f32]).unwrap();
    let error = Stepper::new(body)
        .unwrap()
        .with_integrator(Rk4 {
            time_step: -0.5_f32,
        })
        .unwrap_err();
    assert_eq!(error.to_string(), "time step must be above 0, got -0.5 s");
}

#[test]
fn a_knob_of_a_trial_that_cannot_be_is_refused_when_its_scene_is_composed() {
    let trial = Trial::<f64>::report(1).unwrap();
    let with = |trial: Trial| Stepper::of_trial(&trial, SymplecticEuler { time_step: 1e-4 });
    refuses(
        "coefficient of friction",
        AT_LEAST_ZERO,
        "",
        |coefficient| {
            with(Trial {
                coefficient,
                ..trial
            })
        },
    );
    refuses(
        "slip speed of the friction",
        DIVISOR,
        " m/s",
        |slip_speed| {
            with(Trial {
                slip_speed,
                ..trial
            })
        },
    );
    refuses(
        "damping of the ground",
        AT_LEAST_ZERO,
        " N s/m",
        |damping| with(Trial { damping, ..trial }),
    );
    for number in [0, 9, usize::MAX] {
        assert_eq!(Trial::<f64>::report(number), None);
    }
}

#[test]
fn a_knob_of_a_trials_first_state_is_finite_for_its_own_stepper() {
    let trial = Trial::<f64>::report(1).unwrap();
    let integrator = SymplecticEuler { time_step: 1e-4 };
    refuses("tilt of the coin", FINITE, " rad", |tilt| {
        Trial { tilt, ..trial }.stepper(integrator)
    });
    let quantity = "angular momentum of the coin";
    refuses(quantity, FINITE, " kg m²/s", |angular_momentum| {
        let trial = Trial {
            angular_momentum,
            ..trial
        };
        trial.stepper(integrator)
    });
}

/// A stepper that is not the trial's own does not know its state.
#[test]
fn a_knob_of_a_trials_first_state_that_cannot_be_is_answered_by_the_first_step() {
    let trial = Trial::<f64>::report(1).unwrap();
    let stepper = Stepper::of_trial(&trial, SymplecticEuler { time_step: 1e-4 }).unwrap();
    for value in NOT_FINITE {
        for bad in [
            Trial {
                tilt: value,
                ..trial
            },
            Trial {
                angular_momentum: value,
                ..trial
            },
        ] {
            let answer = stepper.step(&mut bad.state());
            assert!(
                matches!(answer, Err(StepError::BadState { .. })),
                "{answer:?}"
            );
        }
    }
}

// -----------------------------------------------------------------------------------------------
// Steps that cannot go on
// -----------------------------------------------------------------------------------------------

/// The bits of all thirteen numbers: NaN is not equal to itself.
fn bits(state: &State) -> [u64; 13] {
    let State {
        position,
        linear_velocity,
        orientation,
        angular_momentum,
    } = state;
    let mut numbers = position
        .to_array()
        .into_iter()
        .chain(linear_velocity.to_array())
        .chain(orientation.to_array())
        .chain(angular_momentum.to_array());
    [(); 13].map(|()| numbers.next().unwrap().to_bits())
}

/// A state with one of its thirteen numbers replaced, and what that number belongs to.
fn spoilt(state: &State, number: usize, value: f64) -> (State, Quantity) {
    let mut bad = *state;
    let (place, part) = (number % 3, number / 3);
    let quantity = match part {
        0 => {
            bad.position[place] = value;
            Quantity::Position
        }
        1 => {
            bad.linear_velocity[place] = value;
            Quantity::LinearVelocity
        }
        2 => {
            bad.angular_momentum[place] = value;
            Quantity::AngularMomentum
        }
        _ => {
            let mut turn = bad.orientation.to_array();
            turn[number - 9] = value;
            bad.orientation = DQuat::from_array(turn);
            Quantity::Orientation
        }
    };
    (bad, quantity)
}

#[test]
fn a_state_that_is_no_number_is_named_and_left_as_it_is() {
    let trial = Trial {
        slip_speed: 1e-3,
        ..Trial::report(1).unwrap()
    };
    for number in 0..13 {
        for value in NOT_FINITE {
            let (bad, quantity) = spoilt(&trial.state(), number, value);
            assert_eq!(bad.not_finite(), Some(quantity));
            // As text, because NaN does not equal itself.
            let value = value.abs();
            let expected = Some(StepError::BadState { quantity, value }.to_string());
            let text = |error: Option<StepError>| error.map(|error| error.to_string());
            each_explicit!(1e-4, |integrator, method| {
                let stepper = Stepper::of_trial(&trial, integrator).unwrap();
                let mut state = bad;
                let answer = stepper.step(&mut state);
                assert_eq!(text(answer.err()), expected, "{method}");
                let answer = stepper.advance(&mut state, 1.0);
                assert_eq!(text(answer.err()), expected, "{method}");
                assert_eq!(bits(&state), bits(&bad), "{method}");
            });
            let stepper = Stepper::of_trial(&trial, EnergyMomentum { time_step: 1e-4 }).unwrap();
            let mut state = bad;
            assert_eq!(text(stepper.step(&mut state).err()), expected);
            assert_eq!(bits(&state), bits(&bad));
        }
    }
    let text = |quantity, value| StepError::BadState { quantity, value }.to_string();
    assert_eq!(
        text(Quantity::Position, f64::NAN),
        "the position before the step must be finite, got NaN m"
    );
    assert_eq!(
        text(Quantity::Orientation, 0.0),
        "the orientation before the step must be finite, with a length that is not zero, got 0"
    );
}

#[test]
fn an_orientation_without_a_direction_is_blamed_on_the_state_and_a_long_one_is_scaled() {
    let trial = Trial {
        slip_speed: 1e-3,
        ..Trial::report(1).unwrap()
    };
    let step_with = |length: f64| {
        let bad = trial
            .state()
            .with_orientation(DQuat::from_xyzw(0.0, 0.6, 0.0, 0.8) * length);
        let mut answers = Vec::new();
        each_method!(1e-4, |integrator, _method| {
            let mut state = bad;
            let answer = Stepper::of_trial(&trial, integrator)
                .unwrap()
                .step(&mut state);
            assert!(answer.is_ok() || bits(&state) == bits(&bad));
            answers.push(answer.err());
        });
        answers
    };
    // The squares of the last two are 0 and infinite.
    for length in [0.0, -0.0, 5e-324, 1e-200, 1e200] {
        let quantity = Quantity::Orientation;
        let value = (length * 0.6 * (length * 0.6) + length * 0.8 * (length * 0.8)).sqrt();
        let expected = Some(StepError::BadState { quantity, value });
        let answers = step_with(length);
        assert!(
            answers.iter().all(|answer| *answer == expected),
            "length {length:e}: {answers:?}"
        );
    }
    for length in [1e-150, 1e-3, 1.0, 1e3, 1e150] {
        let answers = step_with(length);
        assert!(
            answers.iter().all(Option::is_none),
            "length {length:e}: {answers:?}"
        );
    }
}

#[test]
fn the_limit_of_a_step_is_at_least_zero() {
    let trial = Trial::<f64>::report(1).unwrap();
    let start = trial.state();
    each_method!(1e-4, |integrator, method| {
        let stepper = Stepper::of_trial(&trial, integrator).unwrap();
        let mut session = stepper.session(start);
        for limit in [f64::NAN, f64::NEG_INFINITY, -1.0, -5e-324] {
            let answer = session.step_within(limit);
            let Err(StepError::BadLimit { seconds }) = answer else {
                panic!("{method}, {limit}: {answer:?}");
            };
            assert_eq!(seconds.to_bits(), limit.to_bits(), "{method}");
            assert_eq!(bits(session.state()), bits(&start), "{method}, {limit}");
        }
        for limit in [0.0, -0.0] {
            let step = session.step_within(limit).unwrap();
            assert_eq!(step.elapsed.to_bits(), 0, "{method}");
            assert_eq!(bits(session.state()), bits(&start), "{method}");
        }
        assert_eq!((session.time(), session.step_count()), (0.0, 0), "{method}");
        let step = session.step_within(f64::INFINITY);
        assert_eq!(step.map(|step| step.elapsed), Ok(1e-4), "{method}");
    });
}

/// A bath of thick oil: drag in proportion to the speed up and down, everywhere. An explicit step
/// of more than twice `1 kg/drag` seconds overshoots, more each time.
struct OilBath {
    /// N s/m.
    drag: f64,
}

impl SpringDamperGround for OilBath {
    fn surface(&self, _point: DVec3) -> Surface {
        Surface {
            gap: -1.0,
            normal: DVec3::Z,
        }
    }
    fn spring_force(&self, _depth: f64) -> f64 {
        0.0
    }
    fn spring_energy(&self, _depth: f64) -> f64 {
        0.0
    }
    fn normal_force(&self, _depth: f64, closing_speed: f64) -> f64 {
        self.drag * closing_speed
    }
}

#[test]
fn a_step_that_diverges_says_so_and_leaves_the_last_good_state() {
    each_explicit!(1.0, |integrator, method| {
        let stepper = Stepper::new(point_mass(1.0))
            .unwrap()
            .with_ground(OilBath { drag: 10.0 })
            .unwrap()
            .with_integrator(integrator)
            .unwrap();
        let mut state = State::at(DVec3::X).with_linear_velocity(DVec3::Z);
        let mut good = Vec::new();
        // From 1 m/s by a factor of 9 or more in each step to 1e308: at most 324 steps.
        let answer = stepper.run(&mut state, 400.0, &mut |sample: &tumble::Sample<'_>| {
            good.push(*sample.state);
            core::ops::ControlFlow::Continue(())
        });
        let Err(StepError::Diverged(quantity)) = answer else {
            panic!("{method}: {answer:?}");
        };
        assert!(
            matches!(quantity, Quantity::Position | Quantity::LinearVelocity),
            "{method}: {quantity}"
        );
        assert!(
            good.len() > 50,
            "{method} diverged after {} steps",
            good.len()
        );
        assert_eq!(state.not_finite(), None, "{method}");
        assert_eq!(Some(&state), good.last(), "{method}");
        // A repeated call returns the same error, and leaves the state unchanged again.
        assert_eq!(
            stepper.step(&mut state),
            Err(StepError::Diverged(quantity)),
            "{method}"
        );
        assert_eq!(Some(&state), good.last(), "{method}");
    });
    let message = StepError::Diverged(Quantity::LinearVelocity).to_string();
    let expected = "the linear velocity is no longer finite after the step: shorten the time step or choose an integrator that is stable for it";
    assert_eq!(message, expected);
}

// -----------------------------------------------------------------------------------------------
// Laws that break their contract
// -----------------------------------------------------------------------------------------------

/// Springs of 1000 N/m and dampers of 2 N s/m in level ground, with one value changed.
#[derive(Clone, Copy)]
struct Spoilt {
    gap: fn(DVec3) -> f64,
    normal: fn(DVec3) -> DVec3,
    spring_force: fn(f64) -> f64,
    spring_energy: fn(f64) -> f64,
    normal_force: fn(f64, f64) -> f64,
    friction: fn(f64, DVec3) -> DVec3,
}

const SOUND: Spoilt = Spoilt {
    gap: |point| point.z,
    normal: |_| DVec3::Z,
    spring_force: |depth| 1e3 * depth,
    spring_energy: |depth| 5e2 * depth * depth,
    normal_force: |depth, speed| (1e3 * depth + 2.0 * speed).max(0.0),
    friction: |load, slip| slip * (-0.3 * load / (slip.length() + 1e-3)),
};

impl SpringDamperGround for Spoilt {
    fn surface(&self, point: DVec3) -> Surface {
        Surface {
            gap: (self.gap)(point),
            normal: (self.normal)(point),
        }
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
}

impl SlidingFriction for Spoilt {
    fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
        (self.friction)(normal_force, slip)
    }
}

/// A solid ball of 1 kg that falls from 5 cm above the ground and slides at 1 m/s, for half a
/// second.
fn thrown(
    laws: &Spoilt,
    integrator: impl Integrator,
    mut each: impl FnMut(&State),
) -> Result<(), StepError> {
    let stepper = Stepper::new(Sphere::solid(1.0, 0.1))
        .unwrap()
        .with_gravity(UniformGravity::down(9.8))
        .unwrap()
        .with_ground(laws)
        .unwrap()
        .with_friction(laws)
        .unwrap()
        .with_integrator(integrator)
        .unwrap();
    let mut state = State::at(DVec3::Z * 0.15).with_linear_velocity(DVec3::X);
    for _ in 0..500 {
        let last = state;
        if let Err(error) = stepper.step(&mut state) {
            // The last valid state, and the same error for a repeated call.
            assert_eq!(bits(&state), bits(&last));
            let again = stepper.step(&mut state).unwrap_err();
            assert_eq!(again.to_string(), error.to_string());
            assert_eq!(state.not_finite(), None);
            return Err(error);
        }
        each(&state);
    }
    Ok(())
}

/// Checks that every integrator reports the value, with its role and rule, before it has an effect
/// on the motion.
fn names_the_value(laws: &Spoilt, expected: LawQuantity, is_value: impl Fn(f64) -> bool) {
    let check = |answer: Result<(), StepError>, method: &str| {
        let Err(error @ StepError::BrokenLaw { quantity, value }) = answer else {
            panic!("{method}, {expected}: {answer:?}");
        };
        assert_eq!(quantity, expected, "{method}");
        assert!(is_value(value), "{method}: {error}");
        let message = error.to_string();
        for part in [quantity.to_string(), quantity.rule().to_string()] {
            assert!(message.contains(&part), "{message}");
        }
    };
    each_method!(1e-3, |integrator, method| {
        check(thrown(laws, integrator, |_| {}), method);
    });
    check(
        thrown(laws, DormandPrince54::new(1e-6), |_| {}),
        "DormandPrince54",
    );
    check(
        thrown(laws, BogackiShampine32::new(1e-4), |_| {}),
        "BogackiShampine32",
    );
}

#[test]
fn sound_laws_of_a_user_are_not_blamed_by_any_integrator() {
    each_method!(1e-3, |integrator, method| {
        assert_eq!(thrown(&SOUND, integrator, |_| {}), Ok(()), "{method}");
    });
    let pair = DormandPrince54::new(1e-6);
    assert_eq!(thrown(&SOUND, pair, |_| {}), Ok(()));
}

#[test]
fn a_law_that_returns_nan_is_named_by_every_integrator() {
    let is_nan = f64::is_nan;
    // Over a part of the ground only, which the ball reaches in its fall.
    let gap = Spoilt {
        gap: |point| if point.x > 0.05 { f64::NAN } else { point.z },
        ..SOUND
    };
    names_the_value(&gap, LawQuantity::Gap, is_nan);
    let normal = Spoilt {
        normal: |_| DVec3::new(f64::NAN, 0.0, 1.0),
        ..SOUND
    };
    names_the_value(&normal, LawQuantity::Normal, is_nan);
    let spring_force = Spoilt {
        spring_force: |_| f64::NAN,
        ..SOUND
    };
    names_the_value(&spring_force, LawQuantity::SpringForce, is_nan);
    // Only from 1 cm down.
    let spring_energy = Spoilt {
        spring_energy: |d| if d > 0.01 { f64::NAN } else { 5e2 * d * d },
        ..SOUND
    };
    names_the_value(&spring_energy, LawQuantity::SpringEnergy, is_nan);
    // Only while the contact closes.
    let normal_force = Spoilt {
        normal_force: |d, speed| if speed > 0.0 { f64::NAN } else { 1e3 * d },
        ..SOUND
    };
    names_the_value(&normal_force, LawQuantity::NormalForce, is_nan);
    let friction = Spoilt {
        friction: |_, _| DVec3::NAN,
        ..SOUND
    };
    names_the_value(&friction, LawQuantity::FrictionForce, is_nan);
    assert_eq!(LawQuantity::Gap.role(), Role::GroundShape);
    assert_eq!(LawQuantity::SpringEnergy.role(), Role::GroundLaw);
    assert_eq!(LawQuantity::FrictionForce.role(), Role::FrictionLaw);
}

#[test]
fn a_normal_that_is_no_unit_vector_is_named_with_its_length() {
    for (normal, length) in [
        ((|_| DVec3::Z * 1.001) as fn(DVec3) -> DVec3, 1.001),
        (|_| DVec3::new(0.3, 0.0, 1.0), 1.09_f64.sqrt()),
        (|_| DVec3::ZERO, 0.0),
    ] {
        let laws = Spoilt { normal, ..SOUND };
        let near = |value: f64| (value - length).abs() < 1e-15;
        names_the_value(&laws, LawQuantity::Normal, near);
    }
    // 16 units in the last place, as the sum of many terms may have.
    let laws = Spoilt {
        normal: |_| DVec3::Z * (1.0 + 16.0 * f64::EPSILON),
        ..SOUND
    };
    each_method!(1e-3, |integrator, method| {
        assert_eq!(thrown(&laws, integrator, |_| {}), Ok(()), "{method}");
    });
}

#[test]
fn a_spring_energy_below_zero_is_named_with_its_value_but_not_for_its_rounding() {
    for spring_energy in [
        (|d| -5e2 * d * d) as fn(f64) -> f64,
        |d| 5e2 * d * d - 0.02,
        |d| (5e2 * d - 5.0) * d,
    ] {
        let laws = Spoilt {
            spring_energy,
            ..SOUND
        };
        names_the_value(&laws, LawQuantity::SpringEnergy, |value| value < 0.0);
    }
    // The textbook's form, off by some rounding of 1e5 J at every depth: below 0 at the first
    // millionth of a metre.
    let textbook = Spoilt {
        spring_force: |d| 1e5 * d.exp_m1(),
        spring_energy: |d| 1e5 * (d.exp() - 1.0 - d),
        normal_force: |d, _| 1e5 * d.exp_m1(),
        ..SOUND
    };
    let negative = (1..1000).filter(|&i| (textbook.spring_energy)(1e-10 * f64::from(i)) < 0.0);
    // Rounding of up to 1.1e-16 hides d²/2 below 1.5e-8 m, at 150 of these depths; it is negative
    // at half of them.
    assert!(negative.count() > 30);
    each_method!(1e-4, |integrator, method| {
        assert_eq!(thrown(&textbook, integrator, |_| {}), Ok(()), "{method}");
    });
}

#[test]
fn a_friction_law_that_pushes_is_named_by_every_integrator_and_not_suppressed() {
    // A belt that runs at 2 m/s along x: it drives the slower ball along.
    let belt = Spoilt {
        friction: |load, slip| {
            let past = slip - DVec3::X * 2.0;
            past * (-0.3 * load / (past.length() + 1e-3))
        },
        ..SOUND
    };
    names_the_value(&belt, LawQuantity::FrictionPower, |value| value > 0.0);
    // A slip in the other direction brakes the ball to its own speed. Friction pushes only from
    // rest on.
    let against = Spoilt {
        friction: |load, slip| {
            let past = slip + DVec3::X * 0.5;
            past * (-0.3 * load / (past.length() + 1e-3))
        },
        ..SOUND
    };
    names_the_value(&against, LawQuantity::FrictionPower, |value| value > 0.0);
    let motor = Spoilt {
        friction: |load, slip| slip * (0.3 * load / (slip.length() + 1e-3)),
        ..SOUND
    };
    names_the_value(&motor, LawQuantity::FrictionPower, |value| value > 0.0);
}

#[test]
fn a_resistance_to_turning_that_is_invalid_is_named() {
    struct Motor(RollingResistance);
    impl SlidingFriction for Motor {
        fn force(&self, _normal_force: f64, _slip: DVec3) -> DVec3 {
            DVec3::ZERO
        }
        fn rolling_resistance(&self, normal_force: f64) -> Option<RollingResistance> {
            Some(RollingResistance {
                rolling: self.0.rolling * normal_force.max(1e-9),
                ..self.0
            })
        }
    }
    let quantity = LawQuantity::RollingResistance;
    let invalid: [([f64; 2], fn(f64) -> bool); 5] = [
        ([-1e-3, 1e-2], |value| value < 0.0),
        // At rest the torque is 0/0.
        ([1e-3, 0.0], |value| value == 0.0),
        ([1e-3, -1.0], |value| value < 0.0),
        ([1e-3, f64::INFINITY], f64::is_infinite),
        ([f64::INFINITY, 1e-2], f64::is_infinite),
    ];
    for ([rolling, turn_speed], is_told) in invalid {
        each_method!(1e-3, |integrator, method| {
            let law = Motor(RollingResistance {
                rolling,
                spinning: 0.0,
                turn_speed,
            });
            let stepper = Stepper::new(Sphere::solid(1.0, 0.1))
                .and_then(|stepper| stepper.with_ground(FlatGround::level(1e3, 2.0)))
                .and_then(|stepper| stepper.with_friction(law))
                .and_then(|stepper| stepper.with_integrator(integrator))
                .unwrap();
            let mut state = State::at(DVec3::Z * 0.09).with_angular_momentum(DVec3::Y * 0.01);
            let answer = stepper.step(&mut state);
            assert!(
                matches!(
                    answer,
                    Err(StepError::BrokenLaw { quantity: found, value })
                        if found == quantity && is_told(value)
                ),
                "{method}: {answer:?}"
            );
        });
    }
    let text = StepError::BrokenLaw {
        quantity,
        value: 0.0,
    }
    .to_string();
    let told = "the rolling resistance (finite, turn speed above 0) of the friction law must be \
        at least 0, got 0e0";
    assert!(text.starts_with(told), "{text}");
}

#[test]
fn a_relief_of_nan_does_not_let_a_ball_fall_through() {
    // A hole in a table of heights: NaN for x above 0.1 m. The ball rolls there at 1 m/s.
    let height_field = |x: f64, _y: f64| {
        let height = if x > 0.1 { f64::NAN } else { 0.0 };
        Elevation::new(height, [0.0; 2])
    };
    let ground = Ground {
        law: SpringDamper {
            stiffness: 1e3,
            damping: 2.0,
        },
        shape: Terrain::of(height_field),
    };
    each_method!(1e-3, |integrator, method| {
        let stepper = Stepper::new(Sphere::solid(1.0, 0.1))
            .unwrap()
            .with_gravity(UniformGravity::down(9.8))
            .unwrap()
            .with_ground(ground)
            .unwrap()
            .with_integrator(integrator)
            .unwrap();
        let mut state = State::at(DVec3::Z * 0.09).with_linear_velocity(DVec3::X);
        let answer = stepper.advance(&mut state, 1.0);
        assert!(
            matches!(answer, Err(StepError::BrokenLaw { quantity: LawQuantity::Gap, value }) if value.is_nan()),
            "{method}: {answer:?}"
        );
        let (x, z) = (state.position.x, state.position.z);
        // The step that reaches the hole evaluates it at its start, or one step later.
        assert!((0.09..=0.102).contains(&x), "{method}: {x}");
        assert!(z > 0.0, "{method}: {z}");
    });
    let message = StepError::BrokenLaw {
        quantity: LawQuantity::Gap,
        value: f64::NAN,
    }
    .to_string();
    assert!(
        message.starts_with("the gap of the shape of the ground must not be NaN, got NaN m"),
        "{message}"
    );
}

#[test]
fn a_law_that_is_trusted_is_not_checked() {
    /// A law like [`Spoilt`] that states that it is trusted.
    struct Trusted(Spoilt);
    impl SlidingFriction for Trusted {
        fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
            self.0.force(normal_force, slip)
        }
        fn is_trusted(&self) -> bool {
            true
        }
    }
    let motor = Trusted(Spoilt {
        friction: |load, slip| slip * (0.3 * load / (slip.length() + 1e-3)),
        ..SOUND
    });
    for behind in [&motor as &dyn SlidingFriction, &&motor] {
        let stepper = Stepper::new(Sphere::solid(1.0, 0.1))
            .unwrap()
            .with_ground(FlatGround::level(1e3, 2.0))
            .unwrap()
            .with_friction(behind)
            .unwrap()
            .with_integrator(Rk4 { time_step: 1e-3 })
            .unwrap();
        let mut state = State::at(DVec3::Z * 0.09).with_linear_velocity(DVec3::X);
        stepper.step(&mut state).unwrap();
        assert!(state.linear_velocity.x > 1.0);
    }
}

#[test]
fn an_extent_that_is_no_plane_is_refused_when_the_scene_is_composed() {
    struct Sea {
        level: f64,
        is_bound: bool,
    }
    impl HeightField for Sea {
        fn elevation(&self, _x: f64, _y: f64) -> Elevation {
            Elevation::new(self.level, [0.0; 2])
        }
        fn highest(&self) -> Option<f64> {
            self.is_bound.then_some(self.level)
        }
    }
    let on = |level, is_bound| {
        let shape = Terrain::of(Sea { level, is_bound });
        let law = SpringDamper {
            stiffness: 1e3,
            damping: 2.0,
        };
        Stepper::new(point_mass(1.0))?.with_ground(Ground { law, shape })
    };
    for level in NOT_FINITE {
        let error = on(level, true).map(|_| ()).unwrap_err();
        assert_eq!(error.quantity, "height of the plane");
        assert_eq!(error.rule, Rule::Finite);
    }
    assert!(on(f64::NAN, false).is_ok());
}

#[test]
fn a_duration_below_zero_or_no_number_is_refused_before_anything_moves() {
    let trial = Trial::<f64>::report(1).unwrap();
    let start = trial.state();
    each_explicit!(1e-4, |integrator, method| {
        let stepper = Stepper::of_trial(&trial, integrator).unwrap();
        for seconds in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, -5e-324] {
            let (mut state, mut seen) = (start, 0);
            let refused = |answer: Result<_, StepError>| match answer {
                Err(StepError::BadDuration { seconds: got }) => {
                    assert_eq!(got.to_bits(), seconds.to_bits(), "{method}");
                }
                answer => panic!("{method}: {answer:?}"),
            };
            refused(stepper.advance(&mut state, seconds).map(|()| 0.0));
            let run = stepper.run(&mut state, seconds, &mut |_: &tumble::Sample<'_>| {
                seen += 1;
                core::ops::ControlFlow::Continue(())
            });
            refused(run);
            assert_eq!((state, seen), (start, 0), "{method}");
        }
        for seconds in [0.0, -0.0] {
            let mut state = start;
            assert_eq!(stepper.advance(&mut state, seconds), Ok(()), "{method}");
            assert_eq!(state, start, "{method}");
        }
    });
    assert_eq!(
        StepError::BadDuration { seconds: -1.5 }.to_string(),
        "the time to advance by must be at least 0 s and end at a finite time, got -1.5 s"
    );
    assert_eq!(
        StepError::BadLimit { seconds: -1.5 }.to_string(),
        "the limit of a step must be at least 0 s, got -1.5 s"
    );
}

/// A run that would not end is refused before anything moves or is shown; a flight in closed form
/// of the same duration is one step.
#[test]
fn a_run_of_more_steps_than_its_clock_counts_is_refused() {
    let start = State::default().with_linear_velocity(DVec3::X);
    for (time_step, duration) in [(1e-320, 1.0), (1e-3, 1e308), (5e-324, 1e-300), (1e-9, 1e8)] {
        each_method!(time_step, |integrator, method| {
            let stepper = Stepper::new(point_mass(1.0)).unwrap();
            let stepper = stepper.with_integrator(integrator).unwrap();
            let (mut state, mut shown) = (start, 0);
            let answer = stepper.run(&mut state, duration, &mut |_: &Sample<'_>| {
                shown += 1;
                ControlFlow::Continue(())
            });
            let Err(StepError::TooManySteps {
                seconds,
                time_step: step,
                most,
            }) = answer
            else {
                panic!("{method}: {answer:?}");
            };
            assert_eq!(
                (seconds, step, most),
                (duration, time_step, 2.0_f64.powi(53))
            );
            assert_eq!((state, shown), (start, 0), "{method}");
        });
    }
    let time_step = 1e-3_f32;
    let single = Stepper::new(PointMass::new(1.0_f32)).unwrap();
    let single = single.with_integrator(Rk4 { time_step }).unwrap();
    let answer = single.advance(&mut State::default(), 2e9);
    assert!(
        matches!(answer, Err(StepError::TooManySteps { .. })),
        "{answer:?}"
    );

    let free = Stepper::new(point_mass(1.0)).unwrap();
    let free = free
        .with_integrator(Flight(Rk4 { time_step: 1e-3 }))
        .unwrap();
    let mut state = start;
    free.advance(&mut state, 1e100).unwrap();
    assert_eq!(state.position, DVec3::X * 1e100);
    // On the ground it takes its own steps.
    let table = free.with_ground(FlatGround::level(1e3, 1.0)).unwrap();
    let mut state = State::at(DVec3::Z * -0.01);
    let answer = table.advance(&mut state, 1e100);
    assert!(
        matches!(answer, Err(StepError::TooManySteps { .. })),
        "{answer:?}"
    );
    assert_eq!(
        answer.unwrap_err().to_string(),
        "a run of 1e100 s must have at most 9.0e15 steps, got a step size of 1e-3 s: lengthen the steps or shorten the run"
    );
}

#[test]
fn a_run_of_more_samples_than_can_be_told_apart_is_refused() {
    let stepper = Stepper::new(point_mass(1.0)).unwrap();
    for interval in [1e-12, 1e-320] {
        let mut shown = 0;
        let film = Timed::every(interval, |_: &Sample<'_>| {
            shown += 1;
            ControlFlow::Continue(())
        });
        // Beside another, it is refused as well.
        let mut both = (Ledger::new(), film.unwrap());
        let answer = stepper.run(&mut State::default(), 1.0, &mut both);
        let Err(error @ StepError::TooManySamples { .. }) = answer else {
            panic!("{answer:?}");
        };
        assert_eq!(shown, 0);
        assert_eq!(
            error.to_string(),
            format!(
                "a run of 1e0 s must have at most 4.0e9 samples, got an interval of {interval:e} s: lengthen the interval or shorten the run"
            )
        );
    }
    // Beyond 2²⁴ intervals the next time is no other number of f32.
    let single = Stepper::new(PointMass::new(1.0_f32)).unwrap();
    let mut film = Timed::every(
        1e-4,
        |_: &tumble::f32::Sample<'_>| ControlFlow::Continue(()),
    )
    .unwrap();
    let answer = single.run(&mut State::default(), 1e4, &mut film);
    assert!(
        matches!(answer, Err(StepError::TooManySamples { .. })),
        "{answer:?}"
    );
}

/// A coin of a kilogram on springs of 1 kN/m, with numbers so large that a step cannot resolve the
/// motion. Each method returns an error, or keeps what is constant: in flight the angular momentum.
#[test]
fn a_step_beyond_what_numbers_hold_is_refused_or_right() {
    let coin = Stepper::new(Coin::ring(1.0, 0.5))
        .and_then(|it| it.with_gravity(UniformGravity::down(9.8)))
        .and_then(|it| it.with_ground(FlatGround::level(1e3, 0.5)))
        .unwrap();
    let spin = DVec3::new(0.3, 1.0, 0.2);
    for size in [1e17, 1e20, 1e70, 1e140, 1e153, 1e154, 1e155, 1e200, 1e300] {
        for height in [10.0, 0.45] {
            let start = State::at(DVec3::Z * height).with_angular_momentum(spin * size);
            each_method!(1e-3, |integrator, method| {
                let stepper = coin.with_integrator(integrator).unwrap();
                let mut state = start;
                match stepper.step(&mut state) {
                    Ok(_) if height > 1.0 => {
                        let apart = (state.angular_momentum - start.angular_momentum) / size;
                        // The limiter of the energy scales by its rounding.
                        assert!(apart.length() < 1e-9, "{method}, {size:e}: {apart}");
                    }
                    Ok(_) => assert_eq!(state.not_finite(), None, "{method}, {size:e}"),
                    Err(_) => assert_eq!(bits(&state), bits(&start), "{method}, {size:e}"),
                }
            });
        }
    }
    let start = State::at(DVec3::Z).with_angular_momentum(spin * 1e155);
    let stepper = coin
        .with_integrator(EnergyMomentum { time_step: 1e-3 })
        .unwrap();
    assert_eq!(
        stepper.step(&mut start.clone()).unwrap_err().to_string(),
        "the energy before the step must be finite and far from overflow, got inf J: check the velocities, the penetration depths and the laws of the ground"
    );
    for time_step in [1e15, 1e30, 1e50, 1e60, 1e75, 1e100, 1e200, 1e300] {
        let stepper = coin.with_integrator(EnergyMomentum { time_step }).unwrap();
        // The same by another factor, from other heights.
        for (spin, height) in [(DVec3::ZERO, 10.0), (spin, 10.0), (spin * 7.0, 3.1)] {
            for lean in [0.0, 0.7, 1.3] {
                let start = State::at(DVec3::Z * height)
                    .with_rotation_vector(DVec3::Y * lean)
                    .with_angular_momentum(spin);
                let mut state = start;
                match stepper.step(&mut state) {
                    // Nothing holds it in the air.
                    Ok(_) => assert!(stepper.touching(&state) > 0, "{time_step:e}: {state:?}"),
                    Err(error) => {
                        assert!(matches!(error, StepError::StepTooLong { .. }), "{error}");
                        assert_eq!(bits(&state), bits(&start));
                    }
                }
            }
        }
    }
}

/// An integrator of a user's whose steps are lost in the clock of the run would repeat them for
/// ever.
#[test]
fn a_step_that_the_clock_does_not_resolve_ends_the_run() {
    struct Crumbs;
    impl Integrator for Crumbs {
        type Workspace = ();
        fn step<D: Dynamics>(
            &self,
            _scene: &D,
            state: &mut State,
            limit: f64,
            _workspace: &mut (),
        ) -> Result<Step, StepError> {
            state.linear_velocity.x += 1.0;
            Ok(Step::new(if limit > 0.5 { 0.5 } else { 1e-300 }, 0))
        }
        fn order(&self) -> u32 {
            1
        }
        fn check(&self) -> Result<(), SceneError> {
            Ok(())
        }
    }
    let stepper = Stepper::new(point_mass(1.0)).unwrap();
    let stepper = stepper.with_integrator(Crumbs).unwrap();
    // The state is that after the first step, which took time.
    let mut state = State::default();
    assert_eq!(stepper.advance(&mut state, 1.0), Err(StepError::Stalled));
    assert_eq!(state.linear_velocity, DVec3::X);
    let mut session = stepper.session(State::default());
    assert_eq!(session.advance(1.0), Err(StepError::Stalled));
    assert_eq!(
        (session.state().linear_velocity, session.time()),
        (DVec3::X, 0.5)
    );
    let mut session = stepper.session(State::default());
    let answer = session.run_with_events(1.0, [], |_| ControlFlow::Continue(()));
    assert_eq!(answer, Err(StepError::Stalled));
    assert_eq!(
        (session.state().linear_velocity, session.time()),
        (DVec3::X, 0.5)
    );
}

#[test]
fn a_session_whose_clock_would_overflow_is_not_advanced() {
    let stepper = Stepper::new(point_mass(1.0))
        .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step: 1e300 }))
        .unwrap();
    let mut session = stepper.session(State::default());
    session.advance(1e308).unwrap();
    let error = session.advance(1e308).unwrap_err();
    assert_eq!(error, StepError::BadDuration { seconds: 1e308 });
    assert_eq!(session.run(1e308, &mut ()), Err(error));
    assert_eq!(session.time().to_bits(), 1e308_f64.to_bits());
}

#[test]
fn a_duration_far_below_the_time_step_moves_the_body_a_little() {
    let stepper = Stepper::new(point_mass(1.0)).unwrap();
    let mut state = State::default().with_linear_velocity(DVec3::X);
    for seconds in [1e-30, 5e-324] {
        state.position = DVec3::ZERO;
        stepper.advance(&mut state, seconds).unwrap();
        assert_eq!(state.position.x.to_bits(), seconds.to_bits());
    }
}

// -----------------------------------------------------------------------------------------------
// Any bits anywhere
// -----------------------------------------------------------------------------------------------

/// Any 64 bits: NaN with any payload, infinities, denormal numbers, either zero.
fn any_bits() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => any::<u64>().prop_map(f64::from_bits),
        1 => prop::sample::select(vec![0.0, -0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN_POSITIVE, 5e-324, 1.0, -1.0]),
    ]
}

/// A number that a scene may have, of any size; in one case of twenty, any bits.
fn mostly(legal: impl Strategy<Value = f64> + 'static) -> impl Strategy<Value = f64> {
    prop_oneof![19 => legal.boxed(), 1 => any_bits().boxed()]
}

/// Above 0: of every size that f64 has, or of some everyday one.
fn positive() -> impl Strategy<Value = f64> {
    mostly(
        prop_oneof![1 => (-308.0..308.0_f64).prop_map(|e| 10.0_f64.powf(e)), 2 => (-6.0..6.0_f64).prop_map(|e| 10.0_f64.powf(e))],
    )
}

/// Values of either sign.
fn signed() -> impl Strategy<Value = f64> {
    (positive(), any::<bool>()).prop_map(|(size, up)| if up { size } else { -size })
}

fn vectors() -> impl Strategy<Value = DVec3> {
    (signed(), signed(), signed()).prop_map(DVec3::from)
}

/// Numbers for a whole scene and a state in it.
#[derive(Clone, Debug)]
struct Anything {
    count: usize,
    points: Vec<(DVec3, f64, f64)>,
    body: [f64; 2],
    ground: [f64; 3],
    normal: DVec3,
    friction: [f64; 2],
    gravity: DVec3,
    time_step: f64,
    limit: f64,
    vectors: [DVec3; 3],
    turn: [f64; 4],
}

fn anything() -> impl Strategy<Value = Anything> {
    let points = prop::collection::vec(
        (vectors(), positive(), prop_oneof![Just(0.0), positive()]),
        0..5,
    );
    let normal = prop_oneof![3 => kit::directions(), 1 => vectors()];
    let turn = prop_oneof![3 => kit::orientations().prop_map(|turn| turn.to_array()), 1 => [signed(), signed(), signed(), signed()]];
    let scene = (
        [positive(), positive()],
        (positive(), positive(), signed()).prop_map(<[f64; 3]>::from),
        normal,
        [positive(), positive()],
        vectors(),
    );
    let state = ([vectors(), vectors(), vectors()], turn);
    (0..20_usize, points, scene, positive(), signed(), state).prop_map(
        |(count, points, scene, time_step, limit, (vectors, turn))| {
            let (body, ground, normal, friction, gravity) = scene;
            Anything {
                count,
                points,
                body,
                ground,
                normal,
                friction,
                gravity,
                time_step,
                limit,
                vectors,
                turn,
            }
        },
    )
}

fn vector<R: Real>(vector: DVec3) -> R::Vec3 {
    Vector::new(
        R::from_f64(vector.x),
        R::from_f64(vector.y),
        R::from_f64(vector.z),
    )
}

impl Anything {
    fn state<R: Real>(&self) -> State<R> {
        let [position, linear_velocity, angular_momentum] = self.vectors.map(vector::<R>);
        let [x, y, z, w] = self.turn.map(R::from_f64);
        State {
            position,
            linear_velocity,
            orientation: Quaternion::new(x, y, z, w),
            angular_momentum,
        }
    }

    /// Calls everything that a scene and a state offer. Returns true if the scene could be
    /// composed.
    fn live<R: Real>(&self) -> Result<(), SceneError> {
        let [mass, radius] = self.body.map(R::from_f64);
        let coin = Coin::ring_with_storage(vec![ContactPoint::default(); self.count], mass, radius);
        // Questions that need no scene take anything.
        let _ = (coin.tilt(&self.state()), coin.face_up(&self.state()));
        let plane = self.plane::<R>();
        let _ = coin.contacts_below(plane.normal, plane.height);
        let first = self.live_with(&coin);
        let points = self.points.iter().map(|&(place, radius, _)| ContactPoint {
            position: vector::<R>(place),
            radius: R::from_f64(radius),
        });
        let thickness = R::from_f64(self.points.first().map_or(0.1, |&(_, radius, _)| radius));
        let coin = SolidCoin::new_with_storage(
            vec![ContactPoint::default(); self.count],
            mass,
            radius,
            thickness,
        );
        let _ = (coin.tilt(&self.state()), coin.face_up(&self.state()));
        let _ = coin.contacts_below(plane.normal, plane.height);
        let _ = self.live_with(&coin);
        let places: Vec<_> = points.clone().map(|point| point.position).collect();
        let part = MassProperties::cone(mass, radius, thickness)
            .map(|cone| cone.rotated(self.state().rotation()));
        let whole = match (MassProperties::hull(mass, &places), part) {
            (Ok(hull), Ok(part)) => Ok(hull.with(&part)),
            (one, other) => one.or(other),
        };
        if let Ok(whole) = whole {
            let die = Cuboid::loaded(plane.normal, whole).rounded(thickness);
            let _ = die.face_up(&self.state());
            let _ = self.live_with(&die);
            let _ = self.live_with(&Sphere::loaded(radius, whole));
            let _ = self.live_with(&Ellipsoid::loaded(plane.normal, whole));
        }
        let masses: Vec<_> = self
            .points
            .iter()
            .map(|&(_, _, mass)| R::from_f64(mass))
            .collect();
        let second = PointCloud::with_storage(points.collect::<Vec<_>>(), &masses)
            .and_then(|cloud| self.live_with(&cloud));
        first.or(second)
    }

    fn plane<R: Real>(&self) -> Plane<R> {
        Plane {
            normal: vector::<R>(self.normal),
            height: R::from_f64(self.ground[2]),
        }
    }

    fn live_with<R: Real>(&self, body: &dyn RigidPointBody<R>) -> Result<(), SceneError> {
        let [stiffness, damping, _] = self.ground.map(R::from_f64);
        let [coefficient, slip_speed] = self.friction.map(R::from_f64);
        let stepper = Stepper::new(body)?
            .with_ground(FlatGround {
                stiffness,
                damping,
                plane: self.plane(),
            })?
            .with_gravity(UniformGravity {
                acceleration: vector::<R>(self.gravity),
            })?;
        let time_step = R::from_f64(self.time_step);
        let report = stepper.with_friction(Coulomb {
            coefficient,
            slip_speed,
        })?;
        let smooth = stepper.with_friction(SmoothCoulomb {
            coefficient,
            slip_speed,
        })?;
        self.steps(&report.with_integrator(ForwardEuler { time_step })?);
        self.steps(&smooth.with_integrator(SymplecticEuler { time_step })?);
        self.steps(&report.with_integrator(StrangSplitting { time_step })?);
        self.steps(&smooth.with_integrator(Rk4 { time_step })?);
        self.steps(&report.with_integrator(EnergyMomentum { time_step })?);
        // In single precision the tolerance may be 0.
        let (tolerance, budget) = (R::from_f64(self.friction[1]), 20);
        let third = report.with_integrator(BogackiShampine32 {
            tolerance,
            longest_step: time_step,
            budget,
        });
        if let Ok(stepper) = third {
            self.steps(&stepper);
        }
        let fifth = smooth.with_integrator(DormandPrince54 {
            tolerance,
            longest_step: time_step,
            budget,
        });
        if let Ok(stepper) = fifth {
            self.steps(&stepper);
        }
        Ok(())
    }

    /// A few steps: each leads from a finite state to a finite one, or says why not and leaves the
    /// state. And every question about the state where they end.
    fn steps<R: Real, I: Integrator<R>>(&self, stepper: &Stepper<I, R>) {
        let mut session = stepper.session(self.state::<R>());
        for limit in [R::MAX, R::from_f64(self.limit), R::MAX] {
            let before = *session.state();
            let (step, state) = (session.step_within(limit), session.state());
            match step {
                Ok(_) => assert_eq!(state.not_finite(), None),
                Err(error) => assert_eq!(format!("{state:?}"), format!("{before:?}"), "{error}"),
            }
        }
        let mut state = session.into_state();
        // Two steps with an energy audit. A step size near the largest number has no double.
        let (before, seconds) = (state, R::from_f64(2.0 * self.time_step));
        let mut books = Ledger::new();
        match stepper.run(&mut state, seconds, &mut books) {
            Ok(_) => assert!(state.not_finite().is_none() || seconds == R::ZERO),
            Err(_) => assert!(state.not_finite().is_none() || before.not_finite().is_some()),
        }
        let _ = (
            books.energy_error(),
            stepper.energy(&state),
            stepper.lowest_point(&state),
            stepper.touching(&state),
        );
        let _ = Dissipation::of(stepper.scene(), &state);
    }
}

proptest! {
    #![proptest_config(kit::cases(2000))]

    /// Numbers of every size in a scene and a state, and sometimes arbitrary bits. The result is an
    /// error or a finite state, never a panic.
    #[test]
    fn no_number_in_a_scene_or_a_state_makes_a_panic_in_double_precision(anything in anything()) {
        let _ = anything.live::<f64>();
    }

    #[test]
    fn no_number_in_a_scene_or_a_state_makes_a_panic_in_single_precision(anything in anything()) {
        let _ = anything.live::<f32>();
    }

    /// Arbitrary bits of the state in a plain scene.
    #[test]
    fn no_bits_in_a_state_make_a_panic(numbers in prop::array::uniform13(any_bits()), time_step in prop_oneof![Just(1e-3), Just(f64::MAX), Just(5e-324)]) {
        let [x, y, z, vx, vy, vz, a, b, c, d, lx, ly, lz] = numbers;
        let start = State {
            position: DVec3::new(x, y, z),
            linear_velocity: DVec3::new(vx, vy, vz),
            orientation: DQuat::from_xyzw(a, b, c, d),
            angular_momentum: DVec3::new(lx, ly, lz),
        };
        let trial = Trial::<f64>::report(1).unwrap();
        each_explicit!(time_step, |integrator, method| {
            let stepper = Stepper::of_trial(&trial, integrator).unwrap();
            let mut state = start;
            match stepper.step(&mut state) {
                Ok(_) => prop_assert_eq!(state.not_finite(), None, "{}", method),
                Err(StepError::BadState { quantity, .. }) => {
                    prop_assert!(start.not_finite().is_none_or(|found| found == quantity), "{}", method);
                    prop_assert_eq!(bits(&state), bits(&start), "{}", method);
                }
                Err(StepError::Diverged(_)) => prop_assert_eq!(bits(&state), bits(&start), "{}", method),
                Err(other) => prop_assert!(false, "{method}: {other}"),
            }
        });
    }
}

#[test]
fn most_of_the_scenes_of_any_numbers_can_be_composed() {
    // The tests above would show nothing if every scene were refused: of 200 at least 50 are not.
    let mut runner = proptest::test_runner::TestRunner::new(kit::cases(1));
    let composed = (0..200).filter(|_| {
        anything()
            .new_tree(&mut runner)
            .unwrap()
            .current()
            .live::<f64>()
            .is_ok()
    });
    let count = composed.count();
    assert!(count >= 50, "{count} of 200");
}

#[test]
fn a_turntable_that_is_not_finite_is_refused_for_its_angular_velocity() {
    for rate in NOT_FINITE {
        let ground = MovingGround::turntable(FlatGround::level(1e5, 0.0), DVec3::X, rate);
        let composed = Stepper::new(Coin::ring(1.0, 0.5)).and_then(|s| s.with_ground(ground));
        let error = composed.map(|_| ()).unwrap_err();
        assert_eq!(error.quantity, "z of the angular velocity of the ground");
        assert_eq!(error.rule, Rule::Finite);
    }
}

/// A force across the velocity, as of a magnet: its power is 0 but for rounding, also where the
/// products of a tiny force and a tiny speed underflow.
#[test]
fn a_passive_force_whose_power_underflows_breaks_no_law() {
    struct Magnet;
    impl Force<f32> for Magnet {
        fn wrench(&self, motion: &Motion<f32>) -> Wrench<f32> {
            let across = motion.linear_velocity.cross(Vec3::new(0.3, 0.5, 0.8));
            Wrench {
                force: across * 2.5e-7,
                torque: Vec3::ZERO,
            }
        }
        fn is_passive(&self) -> bool {
            true
        }
    }
    let stepper = tumble::Stepper::new(Sphere::solid(2.9e-8_f32, 1.4e-3))
        .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step: 1e-3 }))
        .and_then(|stepper| stepper.with_force(Magnet))
        .unwrap();
    for number in 0..3000_u16 {
        let part = |root: f32| (f32::from(number) * root).fract() - 0.5;
        let direction = Vec3::new(part(2.0_f32.sqrt()), part(3.0_f32.sqrt()), part(0.618));
        let speed = [1e-15, 1e-18, 1e-19][usize::from(number % 3)];
        let mut state =
            tumble::State::<f32>::at(Vec3::ZERO).with_linear_velocity(direction * speed);
        stepper.step(&mut state).unwrap();
    }
}
