//! The scenes are what their documentation states.

use super::*;
use crate::body::RigidPointBody;
use crate::contract::CheckPlan;
use crate::ground::SpringDamperGround;
use crate::integrator::{EnergyMomentum, Integrator};
use crate::scene::Dynamics;
use glam::DVec3;

const TIME_STEP: f64 = 0.01;

fn wild(cases: u32) -> impl Iterator<Item = Setup<f64>> {
    let mut draw = CheckPlan::default().draw();
    (0..cases).map(move |case| Setup::wild(&mut draw, case, TIME_STEP).unwrap())
}

#[test]
fn the_box_has_eight_corners_and_three_moments_about_none_of_its_axes() {
    let setup = Setup::<f64>::flight(TIME_STEP).unwrap();
    let body = setup.scene.body();
    let first = body.contacts()[0].position;
    for corner in 0..8 {
        let side = |bit: u32, length| f64::from(corner >> bit & 1) * length;
        let path = DVec3::new(side(0, 1.0), side(1, 0.8), side(2, 0.6));
        let is_there = |contact: &&ContactPoint| {
            let off = first - contact.position - path;
            off.length() < 1e-15 && contact.radius == 0.0
        };
        assert_eq!(body.contacts().iter().filter(is_there).count(), 1, "{path}");
    }
    assert!((body.mass() - 1.0).abs() < 1e-15);
    let inertia = body.inertia();
    let [xx, yy, zz] = [inertia.x_axis.x, inertia.y_axis.y, inertia.z_axis.z];
    assert!(xx < 0.9 * yy && yy < 0.9 * zz, "{inertia}");
    // No axis of the box is a principal one: each has a product of inertia.
    let products = [inertia.x_axis.y, inertia.x_axis.z, inertia.y_axis.z].map(f64::abs);
    for [one, other] in [[0, 1], [0, 2], [1, 2]] {
        assert!(products[one].max(products[other]) > 1e-3, "{inertia}");
    }
}

#[test]
fn the_springs_of_the_sliding_box_are_compressed_by_half_of_its_half_height() {
    let setup = Setup::<f64>::slide(TIME_STEP).unwrap();
    let stiffness = 4.0 * setup.scene.ground().spring_force(1.0);
    let weight = -setup.scene.gravity().z;
    assert!((weight / stiffness - 0.15).abs() < 1e-15);
    // An oscillation takes 31 steps.
    let steps = core::f64::consts::TAU / stiffness.sqrt() / TIME_STEP;
    assert!((31.0..32.0).contains(&steps), "{steps}");
}

/// In the steps in which the order of a method is measured, and as many again.
#[test]
fn the_sliding_box_stays_on_its_four_lower_corners() {
    let setup = Setup::<f64>::slide(TIME_STEP).unwrap();
    let time_step = 0.1 * TIME_STEP;
    let (method, mut workspace) = (EnergyMomentum { time_step }, Default::default());
    let mut state = setup.start;
    for _ in 0..160 {
        let corners = setup.scene.body().contacts();
        let below = corners
            .iter()
            .map(|c| state.world_point(c.position).z < 0.0);
        let lower = corners.iter().map(|c| c.position.z < 0.0);
        assert!(below.eq(lower));
        (method.step(&setup.scene, &mut state, TIME_STEP, &mut workspace)).unwrap();
    }
}

/// 200 scenes, as many as a check draws. Frequencies have 26 octaves below 1e4 for each step.
#[test]
fn random_scenes_have_all_sizes_and_some_have_no_gravity() {
    let frequency = |setup: &Setup<f64>| {
        let stiffness = 4.0 * setup.scene.ground().spring_force(1.0);
        stiffness.sqrt() * TIME_STEP
    };
    let (mut hard, mut soft, mut weightless) = (0, 0, 0);
    for setup in wild(200) {
        let frequency = frequency(&setup);
        assert!((1e4 / 2.0_f64.powi(26)..1e4).contains(&frequency));
        hard += u32::from(frequency > 10.0);
        soft += u32::from(frequency < 0.1);
        let gravity = setup.scene.gravity().length() * TIME_STEP * TIME_STEP;
        assert!(gravity <= 1.0);
        weightless += u32::from(gravity == 0.0);
    }
    assert!(hard > 50 && soft > 50, "{hard} {soft}");
    // A quarter of them, with four standard errors.
    assert!((25..75).contains(&weightless), "{weightless}");
}

#[test]
fn random_scenes_begin_in_random_orientations() {
    let up = wild(200).map(|setup| setup.start.rotation().axes().rise());
    let sum: DVec3 = up.sum();
    // A standard error of a component is √(200/3).
    assert!(
        sum.abs().max_element() < 4.0 * f64::sqrt(200.0 / 3.0),
        "{sum}"
    );
}

#[test]
fn the_box_in_flight_tumbles_about_all_axes_high_above_the_ground() {
    let setup = Setup::<f64>::flight(TIME_STEP).unwrap();
    let motion = setup.scene.motion(&setup.start);
    let angles = motion.angular_velocity * TIME_STEP;
    assert!(angles.abs().min_element() > 5e-3, "{angles}");
    let displacement = motion.linear_velocity * TIME_STEP;
    assert!(displacement.abs().min_element() > 5e-3, "{displacement}");
    assert_eq!(setup.scene.gravity(), DVec3::ZERO);
    assert!(setup.scene.ground().surface(setup.start.position).gap > 100.0);
}

/// Within 40 steps, which is as many as a check takes of each scene.
#[test]
fn the_falling_box_meets_the_ground_with_one_corner() {
    let setup = Setup::<f64>::fall(TIME_STEP).unwrap();
    let time_step = 0.1 * TIME_STEP;
    let (method, mut workspace) = (EnergyMomentum { time_step }, Default::default());
    let mut state = setup.start;
    let corners = setup.scene.body().contacts();
    let mut below = (0..40).map(|_| {
        (method.step(&setup.scene, &mut state, TIME_STEP, &mut workspace)).unwrap();
        let is_below = |c: &&ContactPoint| state.world_point(c.position).z < 0.0;
        corners.iter().filter(is_below).count()
    });
    assert_eq!(below.find(|&count| count > 0), Some(1));
}
