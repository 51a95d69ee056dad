//! An author checks his own parts: what each trait asks of him in words, asked in numbers.

use downstream::{Ball, Midpoint, Turf, Viscous};
use tumble::contract::{
    Battery, Breach, Clause, FrictionRange, GroundRange, check_body, check_energy_never_rises,
    check_friction, check_ground, check_integrator,
};
use tumble::glam::DVec3;

#[test]
fn the_ball_keeps_the_contract_of_a_body() -> Result<(), Breach> {
    check_body(&Ball::new(0.5, 0.1), Battery::default())
}

#[test]
fn the_turf_keeps_the_contract_of_a_ground() -> Result<(), Breach> {
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
    check_ground(&turf, &range, Battery::default())
}

#[test]
fn the_oil_keeps_the_contract_of_friction() -> Result<(), Breach> {
    let range = FrictionRange {
        normal: DVec3::Z,
        normal_force: 1e3,
        slip: 10.0,
    };
    check_friction(&Viscous { drag: 0.5 }, &range, Battery::default())
}

#[test]
fn the_midpoint_rule_keeps_the_contract_of_an_integrator() -> Result<(), Breach> {
    check_integrator::<f64, _>(&Midpoint { time_step: 1e-3 }, Battery::default())
}

#[test]
fn the_midpoint_rule_is_explicit_and_can_add_energy() {
    let midpoint = Midpoint { time_step: 1e-3 };
    let result = check_energy_never_rises::<f64, _>(&midpoint, Battery::default());
    assert!(matches!(result, Err(breach) if breach.clause == Clause::EnergyNeverRises));
}
