//! The value and the bound that a fault of known size is reported with.

use super::*;
use crate::friction::{FrictionJacobian, RollingResistance};
use crate::{Coulomb, WithResistance};
use glam::DVec3;

const LOAD: f64 = 20.0;
const SLIP: DVec3 = DVec3::new(3.0, 4.0, 0.0);
const AT: DVec3 = DVec3::new(1.0, 2.0, 3.0);

/// A law of which each test gives the parts.
struct Given {
    force: fn(f64, DVec3) -> DVec3,
    /// Force at a position, in addition.
    at: fn(DVec3) -> DVec3,
    resistance: fn(f64) -> Option<RollingResistance>,
}

impl Given {
    fn friction() -> Self {
        Self {
            force: |load, slip| -slip.normalize_or_zero() * (0.5 * load),
            at: |_| DVec3::ZERO,
            resistance: |_| None,
        }
    }
}

impl SlidingFriction for Given {
    fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
        (self.force)(normal_force, slip)
    }
    fn force_at(&self, position: DVec3, normal_force: f64, slip: DVec3) -> DVec3 {
        (self.force)(normal_force, slip) + (self.at)(position)
    }
    fn jacobian(&self, normal_force: f64, slip: DVec3) -> FrictionJacobian {
        let speed = slip.length().max(1e-9);
        let coefficient = (self.force)(normal_force, slip).length() / speed;
        FrictionJacobian {
            coefficient,
            per_load: coefficient / normal_force,
            width: speed,
            growth: 1.0,
        }
    }
    fn rolling_resistance(&self, normal_force: f64) -> Option<RollingResistance> {
        (self.resistance)(normal_force)
    }
}

fn check(friction: &Given) -> Check<'_, f64, Given> {
    Check {
        friction,
        normal: DVec3::Z,
        position: AT,
        centre: DVec3::ZERO,
    }
}

fn assert_found(found: Result<(), Violation>, requirement: Requirement, [value, bound]: [f64; 2]) {
    let violation = found.expect_err("a fault");
    assert_eq!(violation.requirement, requirement);
    for (found, expected) in [(violation.value, value), (violation.bound, bound)] {
        let off = (found - expected).abs();
        assert!(off <= 1e-12 * expected.abs(), "{found:e}, not {expected:e}");
    }
}

#[test]
fn an_honest_law_passes() {
    assert_eq!(check(&Given::friction()).at(LOAD, SLIP), Ok(()));
}

#[test]
fn a_force_that_pushes_or_lifts_is_told_with_the_rounding_of_its_terms() {
    let pushes = Given {
        force: |load, slip| slip.normalize_or_zero() * (0.5 * load),
        ..Given::friction()
    };
    let bound = 10.0 * 5.0 * 4.0 * f64::EPSILON;
    let found = check(&pushes).at(LOAD, SLIP);
    assert_found(found, Requirement::Opposes, [50.0, bound]);
    let lifts = Given {
        force: |_, slip| DVec3::Z * 12.0 - slip,
        ..Given::friction()
    };
    let bound = 13.0 * 16.0 * f64::EPSILON;
    let found = check(&lifts).at(LOAD, SLIP);
    assert_found(found, Requirement::InSurface, [12.0, bound]);
}

#[test]
fn a_force_that_differs_elsewhere_or_without_a_position_is_told_by_both_differences() {
    // Against the slip, so that the law is honest at each position.
    for (at, change) in [
        (
            (|position| -SLIP * (0.2 * position.length_squared() / 14.0)) as fn(DVec3) -> DVec3,
            2.0,
        ),
        (|_| -SLIP * 0.2, 1.0),
        (
            |position| -SLIP * (0.2 + 0.2 * f64::from(position != AT)),
            2.0,
        ),
    ] {
        let law = Given {
            at,
            ..Given::friction()
        };
        let found = check(&law).at(LOAD, SLIP);
        assert_found(found, Requirement::SameEverywhere, [change, 0.0]);
    }
}

fn resists(rolling: f64, turn_speed: f64) -> RollingResistance {
    RollingResistance {
        rolling,
        spinning: 0.1,
        turn_speed,
    }
}

#[test]
fn a_rolling_resistance_is_there_always_or_never() {
    let sometimes = Given {
        resistance: |load| (load > 0.0).then_some(resists(0.1, 1.0)),
        ..Given::friction()
    };
    let found = check(&sometimes).turning_at(LOAD, SLIP);
    assert_found(found, Requirement::TurningOpposes, [1.0, 0.0]);
    let at_rest_only = Given {
        resistance: |load| (load <= 0.0).then_some(resists(0.1, 1.0)),
        ..Given::friction()
    };
    let found = check(&at_rest_only).turning_at(LOAD, SLIP);
    assert_found(found, Requirement::TurningOpposes, [1.0, 0.0]);

    let law = WithResistance {
        friction: Coulomb {
            coefficient: 0.3,
            slip_speed: 1e-3,
        },
        rolling: 0.01,
        spinning: 0.02,
        turn_speed: 0.5,
    };
    let range = FrictionRange {
        centre: DVec3::ZERO,
        size: 1.0,
        normal: DVec3::Z,
        normal_force: LOAD,
        slip: 5.0,
    };
    assert_eq!(check_friction(&law, &range, CheckPlan::default()), Ok(()));
}

#[test]
fn a_rolling_resistance_has_no_torque_without_load_and_a_rotation_speed_above_0() {
    let sticky = Given {
        resistance: |_| Some(resists(0.3, 1.0)),
        ..Given::friction()
    };
    let found = check(&sticky).turning_at(0.0, SLIP);
    assert_found(found, Requirement::NoLoadNoForce, [0.3, 0.0]);
    assert_eq!(check(&sticky).turning_at(LOAD, SLIP), Ok(()));
    let stiff = Given {
        resistance: |_| Some(resists(0.3, 0.0)),
        ..Given::friction()
    };
    let found = check(&stiff).turning_at(LOAD, SLIP);
    assert_found(found, Requirement::TurningOpposes, [0.0, 0.0]);
    let negative = Given {
        resistance: |_| Some(resists(-0.3, 1.0)),
        ..Given::friction()
    };
    let found = check(&negative).turning_at(LOAD, SLIP);
    assert_found(found, Requirement::TurningOpposes, [-0.3, 0.0]);
}

/// Friction of 0.5 along x and 0.2 along y, with a metric of these rows, or none at the origin.
struct Grained {
    rows: [DVec3; 3],
    is_everywhere: bool,
}

impl SlidingFriction for Grained {
    fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
        let weighed = DVec3::new(0.5, 0.2, 0.0) * slip;
        DVec3::new(0.5, 0.2, 0.0) * weighed.normalize_or_zero() * -normal_force
    }
    fn metric_at(&self, position: DVec3) -> Option<[DVec3; 3]> {
        (self.is_everywhere || position != DVec3::ZERO).then_some(self.rows)
    }
}

#[test]
fn a_metric_is_symmetric_and_tells_the_direction_of_the_force() {
    let check = |x: [f64; 3], y: [f64; 3], is_everywhere: bool| {
        let law = Grained {
            rows: [DVec3::from(x), DVec3::from(y), DVec3::ZERO],
            is_everywhere,
        };
        let check = Check {
            friction: &law,
            normal: DVec3::Z,
            position: AT,
            centre: DVec3::ZERO,
        };
        check.at(LOAD, SLIP).map_err(|told| told.requirement)
    };
    assert_eq!(check([0.5, 0.0, 0.0], [0.0, 0.2, 0.0], true), Ok(()));
    // A factor of all rows has no effect.
    assert_eq!(check([5.0, 0.0, 0.0], [0.0, 2.0, 0.0], true), Ok(()));
    let fault = Err(Requirement::MetricFits);
    assert_eq!(check([0.5, 0.0, 0.0], [0.0, 0.201, 0.0], true), fault);
    assert_eq!(check([0.5, 0.0, 0.0], [0.0, 0.0, 0.0], true), fault);
    assert_eq!(check([0.5, 1e-6, 0.0], [0.0, 0.2, 0.0], true), fault);
    assert_eq!(check([0.5, 0.0, 0.0], [0.0, 0.2, 0.0], false), fault);
    let finite = Err(Requirement::Finite);
    assert_eq!(check([f64::NAN, 0.0, 0.0], [0.0, 0.2, 0.0], true), finite);
}
