//! An author checks his own parts: the contract of each trait, in numbers.

use downstream::{Ball, Carpet, Midpoint, Sail, Turf, Viscous};
use tumble::contract::{
    CheckPlan, ForceRange, FrictionRange, GroundRange, Requirement, Violation, check_body,
    check_energy_never_rises, check_force, check_friction, check_ground, check_integrator,
};
use tumble::glam::DVec3;

#[test]
fn the_ball_keeps_the_contract_of_a_body() -> Result<(), Violation> {
    check_body(&Ball::new(0.5, 0.1), CheckPlan::default())
}

#[test]
fn the_turf_keeps_the_contract_of_a_ground() -> Result<(), Violation> {
    let turf = Turf {
        stiffness: 2e3,
        stiffening: 1e6,
        damping: 2e3,
    };
    let range = GroundRange {
        centre: DVec3::ZERO,
        size: 1.0,
        depth: 0.1,
        speed: 5.0,
    };
    check_ground(&turf, &range, CheckPlan::default())
}

#[test]
fn the_oil_and_the_carpet_keep_the_contract_of_friction() -> Result<(), Violation> {
    let range = FrictionRange {
        centre: DVec3::ZERO,
        size: 1.0,
        normal: DVec3::Z,
        normal_force: 1e3,
        slip: 10.0,
    };
    check_friction(&Viscous { drag: 0.5 }, &range, CheckPlan::default())?;
    let carpet = Carpet {
        drag: 0.5,
        width: 0.3,
    };
    check_friction(&carpet, &range, CheckPlan::default())
}

#[test]
fn the_sail_keeps_the_contract_of_a_force() -> Result<(), Violation> {
    let range = ForceRange {
        centre: DVec3::ZERO,
        size: 10.0,
        speed: 30.0,
        angular_speed: 50.0,
    };
    let sail = Sail {
        normal: DVec3::Z,
        drag: 0.01,
    };
    check_force(&sail, &range, CheckPlan::default())
}

#[test]
fn the_midpoint_rule_keeps_the_contract_of_an_integrator() -> Result<(), Violation> {
    check_integrator::<f64, _>(&Midpoint { time_step: 1e-3 }, CheckPlan::default())
}

#[test]
fn the_midpoint_rule_is_explicit_and_can_add_energy() {
    let midpoint = Midpoint { time_step: 1e-3 };
    let result = check_energy_never_rises::<f64, _>(&midpoint, CheckPlan::default());
    assert!(
        matches!(result, Err(violation) if violation.requirement == Requirement::EnergyNeverRises)
    );
}
