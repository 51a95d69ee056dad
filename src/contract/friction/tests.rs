//! The value and the bound that a fault of known size is reported with.

use super::*;
use crate::error::Rule;
use crate::friction::{FrictionJacobian, RollingResistance};
use crate::{AnisotropicCoulomb, Coulomb, SmoothCoulomb, Viscous, WithResistance};
use glam::{DVec3, Vec3};

const LOAD: f64 = 20.0;
const SLIP: DVec3 = DVec3::new(3.0, 4.0, 0.0);
const AT: DVec3 = DVec3::new(1.0, 2.0, 3.0);

const RANGE: FrictionRange = FrictionRange {
    centre: DVec3::ZERO,
    size: 1.0,
    normal: DVec3::Z,
    normal_force: LOAD,
    slip: 5.0,
};

const COULOMB: Coulomb = Coulomb {
    coefficient: 0.3,
    slip_speed: 1e-3,
};

/// A law of which each test gives the parts.
struct Given {
    force: fn(f64, DVec3) -> DVec3,
    /// Force at a position, in addition.
    at: fn(DVec3) -> DVec3,
    resistance: fn(f64) -> Option<RollingResistance>,
    /// Factor of its torques at a position.
    resists_at: fn(DVec3) -> f64,
}

impl Given {
    fn friction() -> Self {
        Self {
            force: |load, slip| -slip.normalize_or_zero() * (0.5 * load),
            at: |_| DVec3::ZERO,
            resistance: |_| None,
            resists_at: |_| 1.0,
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
    fn rolling_resistance_at(
        &self,
        position: DVec3,
        normal_force: f64,
    ) -> Option<RollingResistance> {
        let factor = (self.resists_at)(position);
        let resistance = self.rolling_resistance(normal_force)?;
        Some(RollingResistance {
            rolling: resistance.rolling * factor,
            spinning: resistance.spinning * factor,
            ..resistance
        })
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
        friction: COULOMB,
        rolling: 0.01,
        spinning: 0.02,
        turn_speed: 0.5,
    };
    assert_eq!(check_friction(&law, &RANGE, CheckPlan::default()), Ok(()));
}

#[test]
fn a_rolling_resistance_that_differs_elsewhere_or_without_a_position_is_told_by_both() {
    let right = Given {
        resistance: |load| {
            Some(RollingResistance {
                rolling: 0.5 * load,
                spinning: 0.0,
                turn_speed: 1.0,
            })
        },
        ..Given::friction()
    };
    assert_eq!(check(&right).at(LOAD, SLIP), Ok(()));
    for (resists_at, change) in [
        // The torque is 10 N m without a position, and this factor of it here and elsewhere.
        (
            (|position| if position == AT { 0.5 } else { 1.0 }) as fn(DVec3) -> f64,
            10.0,
        ),
        (|position| if position == AT { 1.0 } else { 0.5 }, 5.0),
        (|_| 0.5, 5.0),
    ] {
        let law = Given {
            resists_at,
            ..right
        };
        let found = check(&law).at(LOAD, SLIP);
        assert_found(found, Requirement::SameEverywhere, [change, 0.0]);
    }
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

#[test]
fn an_invalid_range_is_told_by_its_quantity() {
    let faults: [(fn(&mut FrictionRange), &str, Rule); 8] = [
        (
            |range| range.centre.x = f64::NAN,
            "a component of the centre of the range",
            Rule::Finite,
        ),
        (
            |range| range.size = -0.1,
            "size of the range",
            Rule::AtLeastZero,
        ),
        (
            |range| range.normal = DVec3::ZERO,
            "length of the normal of the range",
            Rule::AboveZero,
        ),
        (
            |range| range.normal.y = f64::NAN,
            "a component of the normal of the range",
            Rule::Finite,
        ),
        (
            |range| range.normal_force = 0.0,
            "normal force of the range",
            Rule::AboveZero,
        ),
        (
            |range| range.normal_force = f64::INFINITY,
            "normal force of the range",
            Rule::Finite,
        ),
        (
            |range| range.slip = -1.0,
            "slip of the range",
            Rule::AboveZero,
        ),
        (
            |range| range.slip = f64::NAN,
            "slip of the range",
            Rule::Finite,
        ),
    ];
    for (fault, quantity, rule) in faults {
        let mut range = RANGE;
        fault(&mut range);
        let violation = check_friction(&COULOMB, &range, CheckPlan::default());
        let requirement = Requirement::Composes { quantity, rule };
        assert_eq!(violation.expect_err(quantity).requirement, requirement);
    }
}

/// The law holds in the plane of the direction alone. In that of another normal its force would
/// leave the surface.
#[test]
fn a_normal_of_any_length_above_0_has_its_direction() {
    let direction = DVec3::new(0.6, 0.0, 0.8);
    let law = AnisotropicCoulomb::on(direction, DVec3::Y, [0.2, 0.5], 1e-3);
    for length in [1e-300, 1e-160, 1.0, 1e160, 1e300] {
        let normal = direction * length;
        let range = FrictionRange { normal, ..RANGE };
        let found = check_friction(&law, &range, CheckPlan::default());
        assert_eq!(found, Ok(()), "{length:e}");
    }
}

/// A force whose size depends on the slip alone, in units of the load.
struct BySpeed(fn(f64) -> f64);

impl SlidingFriction for BySpeed {
    fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
        let size = (self.0)(slip.length());
        slip.normalize_or_zero() * (-size * normal_force)
    }
}

#[test]
fn a_jump_at_zero_slip_is_found_however_small_it_is() {
    let jumps: [(fn(f64) -> f64, f64); 4] = [
        (|_| 0.3, 0.3),
        (|speed| 0.3 + speed, 0.3),
        (|speed| 1e-6 + speed / (speed + 1e-3), 1e-6),
        // A slip speed that keeps the division from 0 alone.
        (|speed| 0.3 * speed / (speed + f64::MIN_POSITIVE), 0.3),
    ];
    for (size, jump) in jumps {
        let found = check_friction(&BySpeed(size), &RANGE, CheckPlan::default());
        assert_found(
            found,
            Requirement::Continuous,
            [jump * LOAD, jump * LOAD / 2.0],
        );
        let input = found.expect_err("a jump").input;
        let Input::Slide { slip, .. } = input else {
            panic!("{input}");
        };
        assert!(slip.length() < 1e-150, "{input}");
    }
    // Along y alone.
    let grooves = Given {
        force: |load, slip| {
            DVec3::new(-slip.x, -slip.y.signum() * f64::from(slip.y != 0.0), 0.0) * load
        },
        ..Given::friction()
    };
    let check = check(&grooves);
    assert_eq!(check.has_no_jump(&RANGE, DVec3::X), Ok(()));
    let found = check.has_no_jump(&RANGE, DVec3::Y);
    assert_found(found, Requirement::Continuous, [LOAD, LOAD / 2.0]);
}

#[test]
fn a_law_with_a_tiny_slip_speed_has_no_jump() {
    let laws: [fn(f64) -> f64; 4] = [
        |speed| 0.3 * (speed / 1e-100).tanh(),
        |speed| 0.3 * (speed / 1e-12).min(1.0),
        |speed| speed.powf(0.2),
        |_| 0.0,
    ];
    for size in laws {
        let law = BySpeed(size);
        let check = Check {
            friction: &law,
            normal: DVec3::Z,
            position: AT,
            centre: DVec3::ZERO,
        };
        assert_eq!(check.has_no_jump(&RANGE, DVec3::X), Ok(()));
    }
    for slip_speed in [1e-12, 1e-30, 1e-100] {
        let coefficient = 0.3;
        let coulomb = Coulomb {
            coefficient,
            slip_speed,
        };
        let found = check_friction(&coulomb, &RANGE, CheckPlan::default());
        assert_eq!(found, Ok(()), "{slip_speed:e}");
        let smooth = SmoothCoulomb {
            coefficient,
            slip_speed,
        };
        let found = check_friction(&smooth, &RANGE, CheckPlan::default());
        assert_eq!(found, Ok(()), "{slip_speed:e}");
    }
    let range = FrictionRange {
        centre: Vec3::ZERO,
        size: 1.0,
        normal: Vec3::Z,
        normal_force: 20.0,
        slip: 5.0,
    };
    for slip_speed in [1e-10, 1e-12] {
        let coulomb = Coulomb {
            coefficient: 0.3_f32,
            slip_speed,
        };
        let found = check_friction(&coulomb, &range, CheckPlan::default());
        assert_eq!(found, Ok(()), "{slip_speed:e}");
    }
    let oil = Viscous { coefficient: 1e-3 };
    assert_eq!(check_friction(&oil, &range, CheckPlan::default()), Ok(()));
}

#[test]
fn no_slip_beyond_the_range_is_tried_for_a_jump() {
    let range = FrictionRange {
        slip: 1e-151,
        ..RANGE
    };
    let found = check(&Given::friction()).has_no_jump(&range, DVec3::X);
    assert_eq!(found, Ok(()));
}
