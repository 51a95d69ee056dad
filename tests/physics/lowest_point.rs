//! The lowest point of a body above its ground, which events evaluate three times in a step.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::kit::counting::Counting;
use crate::kit::erased::Stepper;
use crate::kit::{self, log_uniform};
use proptest::prelude::*;
use tumble::glam::DVec3;
use tumble::{
    Block, Coin, ContactPoint, Cuboid, FlatGround, Ground, Plane, PointCloud, RigidPointBody,
    Solid as Hull, SpringDamper, SpringDamperGround, State, Terrain, Waves,
};

/// Index and gap of the lowest of all contacts above all surfaces: the first of the lowest ones.
fn lowest_of_all(
    body: &dyn RigidPointBody,
    surfaces: &[&dyn SpringDamperGround],
    state: &State,
) -> (usize, f64) {
    let mut lowest = (0, f64::INFINITY);
    for ground in surfaces {
        for (index, contact) in body.contacts().iter().enumerate() {
            let gap = gap_of(contact, *ground, state);
            if gap < lowest.1 {
                lowest = (index, gap);
            }
        }
    }
    lowest
}

/// Gap of a contact above a surface, m.
fn gap_of(contact: &ContactPoint, ground: &dyn SpringDamperGround, state: &State) -> f64 {
    let centre = state.position + state.orientation * contact.position;
    ground.surface(centre).gap - contact.radius
}

fn bodies() -> Vec<Box<dyn RigidPointBody>> {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y * 0.7, DVec3::Z * 0.4];
    let cloud = PointCloud::new(corners, [0.1, 0.4, 0.2, 0.3]).unwrap();
    vec![
        Box::new(Coin::ring(1.0, 0.5)),
        Box::new(Cuboid::solid(1.0, DVec3::new(0.4, 0.3, 0.2)).rounded(0.03)),
        Box::new(Hull::hull(1.0, corners).unwrap()),
        Box::new(cloud),
    ]
}

proptest! {
    #![proptest_config(kit::cases(300))]

    /// A tilted floor, a block beside it and waves: alone and together, near and far.
    #[test]
    fn the_lowest_point_is_the_lowest_of_all_points(
        turn in prop_oneof![1 => Just(tumble::glam::DQuat::IDENTITY), 4 => kit::orientations()],
        place in (-2.0..2.0_f64, -2.0..2.0_f64, -0.3..2.0_f64),
        tilt in (-0.5..0.5_f64, -0.5..0.5_f64),
        length in log_uniform(0.3, 5.0),
    ) {
        let law = SpringDamper { stiffness: 1e3, damping: 1.0 };
        let plane = Plane::through(DVec3::ZERO, DVec3::new(tilt.0, tilt.1, 1.0));
        let floor = Ground { law, shape: plane };
        let block = Ground { law, shape: Block { centre: DVec3::X, half: DVec3::splat(0.4) } };
        let waves = Waves { amplitude: 0.05 * length, length };
        let waves = Ground { law, shape: Terrain::of(waves) };
        let all: [&dyn SpringDamperGround; 3] = [&floor, &block, &waves];
        let state = State::at(DVec3::from(place)).with_orientation(turn);
        for body in bodies() {
            for ground in all {
                let found = Stepper::new(&*body).and_then(|s| s.with_ground(ground)).unwrap();
                let found = found.lowest_point(&state).unwrap();
                let (_, gap) = lowest_of_all(&*body, &[ground], &state);
                prop_assert!((found.gap - gap).abs() < 1e-14, "{} and {gap} m", found.gap);
                // Of equally low points any may be named.
                let named = gap_of(&body.contacts()[found.index], ground, &state);
                prop_assert!((named - gap).abs() < 1e-14, "{}: {named} and {gap} m", found.index);
            }
            let found = Stepper::new(&*body).and_then(|s| s.with_ground(&all[..])).unwrap();
            let gap = lowest_of_all(&*body, &all, &state).1;
            let found = found.lowest_point(&state).unwrap().gap;
            prop_assert!((found - gap).abs() < 1e-14, "{found} and {gap} m above one of three");
        }
    }
}

/// All points of a coin that lies flat are at the same height, up to rounding. Of the
/// corners of a plate, whose heights are not rounded, the first counts.
#[test]
fn of_equal_points_one_is_the_lowest() {
    let flat = State::at(DVec3::Z).with_rotation_vector(DVec3::Y * core::f64::consts::FRAC_PI_2);
    let ground = FlatGround::level(1e3, 1.0);
    let coin = Stepper::new(Coin::ring(1.0, 0.5)).and_then(|s| s.with_ground(ground));
    let found = coin.unwrap().lowest_point(&flat).unwrap();
    assert!((found.gap - 1.0).abs() < 1e-15);
    let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
    let plate = PointCloud::new(corners.map(|[x, y]| DVec3::new(x, y, 0.0)), [0.25; 4]).unwrap();
    let plate = Stepper::new(plate)
        .and_then(|s| s.with_ground(ground))
        .unwrap();
    for height in [1.0, 0.0, -0.1] {
        let found = plate.lowest_point(&State::at(DVec3::Z * height)).unwrap();
        assert_eq!((found.index, found.gap), (0, height));
    }
}

/// The points of a ring below one of its points are an arc, in whose middle is the lowest one.
#[test]
fn the_lowest_point_of_a_ring_needs_few_evaluations() {
    let body = Coin::ring_with_storage(vec![tumble::ContactPoint::default(); 12_000], 1.0, 0.5);
    let ground = Counting::new(FlatGround::level(1e3, 1.0));
    let stepper = Stepper::new(body)
        .and_then(|s| s.with_ground(&ground))
        .unwrap();
    for (height, lean) in [(0.7, 0.0), (0.7, 0.3), (0.45, 0.1), (3.0, 1.2), (0.1, 1.4)] {
        for roll in [0.0, 1.0, 2.5, 4.0] {
            let state = State::at(DVec3::Z * height).with_orientation(
                tumble::glam::DQuat::from_rotation_y(lean)
                    * tumble::glam::DQuat::from_rotation_x(roll),
            );
            ground.take();
            let found = stepper.lowest_point(&state).unwrap();
            let evaluations = ground.take().surfaces;
            assert!(
                evaluations <= 20,
                "lean {lean}, roll {roll}: {evaluations} evaluations"
            );
            assert!((found.gap - (height - 0.5 * f64::cos(lean))).abs() < 1e-7);
        }
    }
}
