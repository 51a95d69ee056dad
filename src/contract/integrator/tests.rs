//! Distances of states, the rounding of times, and the check that no energy increases.

use super::*;
use crate::error::{SceneError, StepError};
use crate::scene::Dynamics;
use crate::{CompactEnergyMomentum, EnergyMomentum, Flight, SymplecticEuler};
use glam::{DQuat, DVec3};

/// `EnergyMomentum` with a fault: a change of the state after a step with a limit (s).
struct Faulty<F> {
    method: EnergyMomentum,
    fault: F,
}

impl<F: Fn(&mut State, f64)> Integrator for Faulty<F> {
    type Workspace = <EnergyMomentum as Integrator>::Workspace;

    fn step<D: Dynamics>(
        &self,
        scene: &D,
        state: &mut State,
        limit: f64,
        workspace: &mut Self::Workspace,
    ) -> Result<Step, StepError> {
        let step = self.method.step(scene, state, limit, workspace)?;
        (self.fault)(state, limit);
        Ok(step)
    }
    fn order(&self) -> u32 {
        self.method.order()
    }
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }
}

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

#[test]
fn an_energy_that_increases_in_short_steps_alone_is_found() {
    let method = EnergyMomentum { time_step: 1e-2 };
    let fault = |state: &mut State, limit: f64| {
        if limit < 1e-2 {
            state.linear_velocity.x += 1e9;
        }
    };
    let plan = CheckPlan { seed: 4, cases: 2 };
    let found = check_energy_never_rises(&Faulty { method, fault }, plan);
    let violation = found.expect_err("an increase");
    assert_eq!(violation.requirement, Requirement::EnergyNeverRises);
}

/// 64 units in the last place of the lengths: the start, and the path of a whole step or of a
/// hundredth of one.
#[test]
fn a_path_that_is_not_velocity_times_time_is_found_beyond_the_rounding_of_both() {
    let time_step = 1e-2;
    let check = |off: f64| {
        let fault = |state: &mut State, _| state.position.x += off;
        let method = EnergyMomentum { time_step };
        let attempt = Attempt {
            integrator: &Faulty { method, fault },
            setup: Setup::flight(time_step).unwrap(),
            time_step,
        };
        attempt.tells_time()
    };
    let start = Setup::flight(time_step).unwrap().start;
    let path = (start.linear_velocity * time_step).length();
    let unit = 64.0 * f64::EPSILON;
    assert_eq!(check(unit * (start.position.length() - 0.1 * path)), Ok(()));
    let off = unit * (start.position.length() + 1.2 * path);
    let violation = check(off).expect_err("another path");
    assert_eq!(violation.requirement, Requirement::TellsTime);
    assert_eq!(
        violation.input,
        Input::Step {
            scene: "free flight",
            case: 0,
            step: 0,
            limit: time_step
        }
    );
}

/// A method of a fixed step that states these numbers, whatever the inner one's are.
struct Stated {
    inner: SymplecticEuler,
    order: u32,
    fixed_step: f64,
}

impl Integrator for Stated {
    type Workspace = <SymplecticEuler as Integrator>::Workspace;

    fn step<D: Dynamics>(
        &self,
        scene: &D,
        state: &mut State,
        limit: f64,
        workspace: &mut Self::Workspace,
    ) -> Result<Step, StepError> {
        self.inner.step(scene, state, limit, workspace)
    }
    fn order(&self) -> u32 {
        self.order
    }
    fn fixed_step(&self) -> Option<f64> {
        Some(self.fixed_step)
    }
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }
}

/// The first step of closed-form flight is the whole second that it may take.
#[test]
fn flight_is_checked_at_the_step_of_the_method_that_it_contains() {
    let plan = CheckPlan { seed: 4, cases: 20 };
    for time_step in [1e-6, 1e-4, 1e-3, 0.3] {
        let own = own_step::<f64, _>(&Flight(Rk4 { time_step }));
        assert_eq!(own, Ok(time_step));
        let found = check_integrator(&Flight(Rk4 { time_step }), plan);
        assert_eq!(found, Ok(()), "{time_step}");
        let flight = Flight(Stated {
            inner: SymplecticEuler { time_step },
            order: 3,
            fixed_step: time_step,
        });
        let violation = check_integrator(&flight, plan).expect_err("the order is 1");
        assert_eq!(violation.requirement, Requirement::Order, "{violation}");
    }
    // A second of free flight is the longest step that is measured.
    assert_eq!(own_step::<f64, _>(&Rk4 { time_step: 3.0 }), Ok(1.0));
    let flight = Flight(EnergyMomentum { time_step: 1e-2 });
    assert_eq!(check_energy_never_rises(&flight, plan), Ok(()));
}

#[test]
fn a_fixed_step_that_is_not_above_0_is_told() {
    for fixed_step in [0.0, -1e-3, f64::NAN] {
        let method = Stated {
            inner: SymplecticEuler { time_step: 1e-3 },
            order: 1,
            fixed_step,
        };
        let violation = check_integrator(&method, CheckPlan::default()).expect_err("no step");
        let sentence = std::format!("{violation}");
        assert!(
            sentence.contains("fixed step of the integrator"),
            "{sentence}"
        );
    }
}

#[test]
fn the_energy_never_increases_with_the_compact_method_either() {
    let plan = CheckPlan { seed: 4, cases: 6 };
    let compact = CompactEnergyMomentum::<8> { time_step: 1e-2 };
    assert_eq!(check_energy_never_rises(&compact, plan), Ok(()));
}
