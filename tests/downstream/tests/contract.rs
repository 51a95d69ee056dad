//! An author checks his own parts: the contract of each trait, in numbers.

use downstream::{Ball, Carpet, Midpoint, Motor, Sail, Turf, Turning, Viscous};
use tumble::contract::{
    CheckPlan, ForceRange, FrictionRange, GroundRange, Requirement, Violation, check_body,
    check_energy_never_rises, check_force, check_friction, check_ground, check_integrator,
};
use tumble::error::LawQuantity;
use tumble::glam::DVec3;
use tumble::{
    Apex, FlatGround, Force, FrictionField, GroundMotion, Motion, Sample, SpringDamperGround,
    State, StepError, Stepper, Surface, Wrench,
};

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

const AIR: ForceRange = ForceRange {
    centre: DVec3::ZERO,
    size: 10.0,
    speed: 30.0,
    angular_speed: 50.0,
};

/// A scene with a user's misbehaving part: the error of its first step, and that the state stays.
fn refused(step: impl FnOnce(&mut State) -> Result<(), StepError>) -> StepError {
    let start =
        State::at(DVec3::new(0.4, 0.0, 0.09)).with_linear_velocity(DVec3::new(1.0, 0.5, -0.3));
    let mut state = start;
    let error = step(&mut state).expect_err("the part is broken");
    assert_eq!(state, start, "{error}");
    error
}

/// A force that states that it is passive.
struct Passive(fn(&Motion) -> DVec3);

impl Force for Passive {
    fn wrench(&self, motion: &Motion) -> Wrench {
        Wrench::of_force((self.0)(motion))
    }
    fn is_passive(&self) -> bool {
        true
    }
}

#[test]
fn a_users_motor_keeps_the_contract_and_a_force_that_gains_or_is_nan_is_caught() {
    let motor = Motor {
        rate: 3.0,
        drag: 0.1,
    };
    check_force(&motor, &AIR, CheckPlan::default()).unwrap();
    let faults: [(fn(&Motion) -> DVec3, Requirement, LawQuantity); 2] = [
        (
            |motion| motion.linear_velocity * 0.1,
            Requirement::PassiveTakes,
            LawQuantity::AppliedPower,
        ),
        (
            |_| DVec3::splat(f64::NAN),
            Requirement::Finite,
            LawQuantity::AppliedForce,
        ),
    ];
    for (force, requirement, law) in faults {
        let violation = check_force(&Passive(force), &AIR, CheckPlan::default()).unwrap_err();
        assert_eq!(violation.requirement, requirement, "{violation}");
        let stepper = Stepper::new(Ball::new(0.5, 0.1))
            .and_then(|stepper| stepper.with_force(Passive(force)))
            .unwrap();
        let error = refused(|state| stepper.step(state).map(|_| ()));
        assert!(
            matches!(error, StepError::BrokenLaw { quantity, .. } if quantity == law),
            "{error}"
        );
    }
    let weak = Motor {
        drag: -1.0,
        ..motor
    };
    let stepper = Stepper::new(Ball::new(0.5, 0.1)).unwrap();
    let error = stepper.with_force(weak).expect_err("the drag is negative");
    assert_eq!(error.quantity, "drag of the motor");
}

#[test]
fn a_field_of_a_law_that_pushes_is_caught_by_check_and_step() {
    let field = || FrictionField::new(|position: DVec3| Viscous { drag: -position.x });
    let range = FrictionRange {
        centre: DVec3::X,
        size: 0.5,
        normal: DVec3::Z,
        normal_force: 1e3,
        slip: 10.0,
    };
    let violation = check_friction(&field(), &range, CheckPlan::default()).unwrap_err();
    assert_eq!(violation.requirement, Requirement::Opposes, "{violation}");
    let stepper = Stepper::new(Ball::new(0.5, 0.1))
        .and_then(|stepper| stepper.with_ground(FlatGround::level(2e3, 5.0)))
        .and_then(|stepper| stepper.with_friction(field()))
        .unwrap();
    let error = refused(|state| stepper.step(state).map(|_| ()));
    let law = LawQuantity::FrictionPower;
    assert!(
        matches!(error, StepError::BrokenLaw { quantity, .. } if quantity == law),
        "{error}"
    );
}

/// A ground whose material moves with any velocity.
#[derive(Debug)]
struct Moves(DVec3);

impl SpringDamperGround for Moves {
    fn surface(&self, point: DVec3) -> Surface {
        Surface {
            gap: point.z,
            normal: DVec3::Z,
        }
    }
    fn spring_force(&self, depth: f64) -> f64 {
        2e3 * depth
    }
    fn spring_energy(&self, depth: f64) -> f64 {
        1e3 * depth * depth
    }
    fn normal_force(&self, depth: f64, _closing_speed: f64) -> f64 {
        2e3 * depth
    }
    fn motion(&self) -> Option<GroundMotion> {
        Some(GroundMotion::translation(self.0))
    }
}

#[test]
fn material_that_leaves_its_surface_or_is_nan_is_caught() {
    let range = GroundRange {
        centre: DVec3::ZERO,
        size: 1.0,
        depth: 0.1,
        speed: 5.0,
    };
    check_ground(&Moves(DVec3::X), &range, CheckPlan::default()).unwrap();
    let turning = Turning {
        ground: Moves(DVec3::ZERO),
        rate: 3.0,
    };
    check_ground(&turning, &range, CheckPlan::default()).unwrap();
    let violation = check_ground(&Moves(DVec3::Z), &range, CheckPlan::default()).unwrap_err();
    assert_eq!(violation.requirement, Requirement::MotionAlongSurface);
    let nan = || Moves(DVec3::X * f64::NAN);
    let violation = check_ground(&nan(), &range, CheckPlan::default()).unwrap_err();
    assert_eq!(violation.requirement, Requirement::Finite, "{violation}");
    let stepper = Stepper::new(Ball::new(0.5, 0.1)).unwrap();
    let error = stepper.with_ground(nan()).expect_err("the speed is NaN");
    assert_eq!(error.quantity, "x of the velocity of the ground");
}

#[test]
fn an_event_that_is_nan_ends_a_run_with_its_index() {
    let stepper = Stepper::new(Ball::new(0.5, 0.1)).unwrap();
    let start = State::at(DVec3::Z).with_linear_velocity(DVec3::X);
    let mut session = stepper.session(start);
    let root = |sample: &Sample<'_>| (0.2 - sample.state.position.x).sqrt();
    let error = session.run_until_event(1.0, [&Apex, &root]).unwrap_err();
    assert!(
        matches!(error, StepError::BadEvent { event: 1, .. }),
        "{error}"
    );
    assert!(session.state().position.is_finite() && session.time() < 1.0);
}
