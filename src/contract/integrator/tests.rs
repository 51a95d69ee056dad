//! Distances of states, the rounding of times, and the check that no energy increases.

use super::*;
use crate::{EnergyMomentum, SymplecticEuler};
use glam::{DQuat, DVec3};

#[test]
fn the_distance_of_two_states_is_the_sum_of_its_parts() {
    let start = State::at(DVec3::new(1.0, 2.0, 3.0))
        .with_rotation_vector(DVec3::new(0.3, -0.2, 0.1))
        .with_linear_velocity(DVec3::new(-1.0, 0.5, 2.0))
        .with_angular_momentum(DVec3::new(0.3, 0.7, -0.2));
    let about = |axis: DVec3| {
        let mut state = start;
        state.orientation *= DQuat::from_axis_angle(axis, 0.2);
        state
    };
    // A point at 1 m moves by the chord of 0.2 rad.
    let chord = 2.0 * f64::sin(0.1);
    let shift = DVec3::new(2.0, 3.0, 6.0);
    let moved = |mut state: State| {
        state.linear_velocity += shift;
        state
    };
    let mut away = start;
    away.position += shift;
    for (other, expected) in [
        (start, 0.0),
        // Each point moves along.
        (away, 21.0),
        (about(DVec3::X), chord),
        (about(DVec3::Y), chord),
        (about(DVec3::Z), 2.0 * chord),
        (moved(start), 7.0 * 0.01),
        (
            start.with_angular_momentum(start.angular_momentum + shift),
            7.0 * 0.01,
        ),
        (moved(about(DVec3::Z)), 2.0 * chord + 7.0 * 0.01),
    ] {
        let found = distance(&start, &other, 0.01);
        assert!((found - expected).abs() < 1e-14, "{found}, not {expected}");
    }
}

#[test]
fn times_are_rounded_by_millions_of_units_in_the_last_place_and_a_share_at_most() {
    let exact = rounding_of_time::<f64>();
    assert!(
        (exact / (8e6 * f64::EPSILON) - 1.0).abs() < 1e-12,
        "{exact:e}"
    );
    let coarse = rounding_of_time::<f32>();
    assert!((coarse / 2e-4 - 1.0).abs() < 1e-6, "{coarse:e}");
}

#[test]
fn the_energy_of_an_explicit_method_increases_and_that_of_the_implicit_one_does_not() {
    let plan = CheckPlan { seed: 4, cases: 6 };
    let implicit = EnergyMomentum { time_step: 1e-2 };
    assert_eq!(check_energy_never_rises(&implicit, plan), Ok(()));
    let explicit = SymplecticEuler { time_step: 1e-2 };
    let violation = check_energy_never_rises(&explicit, plan).expect_err("an increase");
    assert_eq!(violation.requirement, Requirement::EnergyNeverRises);
    assert!(violation.value > violation.bound);
    let Input::Step { scene, limit, .. } = violation.input else {
        panic!("{:?}", violation.input);
    };
    assert_eq!(scene, "a random scene");
    assert!(limit > 0.0 && limit <= 1e-2, "{limit}");
}
