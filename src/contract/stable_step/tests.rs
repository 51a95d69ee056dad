//! Limits that are too large are found, and conservative ones are not.

use super::*;
use crate::contract::{CheckPlan, check_integrator};
use crate::error::{SceneError, StepError};
use crate::integrator::Step;
use crate::scene::Dynamics;
use crate::{ForwardEuler, Nystrom, Rk4, StrangSplitting, SymplecticEuler};

const TIME_STEP: f64 = 1e-3;

/// A method that states another limit: a function of the inner one's, of stiffness and of damping.
struct Claim<I, F>(I, F);

impl<I: Integrator, F: Fn(f64, [f64; 2]) -> Option<f64>> Integrator for Claim<I, F> {
    type Workspace = I::Workspace;

    fn step<D: Dynamics>(
        &self,
        scene: &D,
        state: &mut State,
        limit: f64,
        workspace: &mut I::Workspace,
    ) -> Result<Step, StepError> {
        self.0.step(scene, state, limit, workspace)
    }
    fn order(&self) -> u32 {
        self.0.order()
    }
    fn largest_stable_step(&self, stiffness: f64, damping: f64) -> Option<f64> {
        let limit = self.0.largest_stable_step(stiffness, damping).unwrap();
        (self.1)(limit, [stiffness, damping])
    }
    fn check(&self) -> Result<(), SceneError> {
        self.0.check()
    }
}

fn check<I: Integrator>(
    inner: I,
    limit: impl Fn(f64, [f64; 2]) -> Option<f64>,
) -> Result<(), Violation> {
    let plan = CheckPlan {
        cases: 80,
        ..CheckPlan::default()
    };
    check_integrator(&Claim(inner, limit), plan)
}

/// The result for a limit that is multiplied by a factor, with each method that states a limit.
fn check_times(factor: f64) -> [Result<(), Violation>; 5] {
    let time_step = TIME_STEP;
    let scaled = |limit: f64, _| Some(limit * factor);
    [
        check(ForwardEuler { time_step }, scaled),
        check(SymplecticEuler { time_step }, scaled),
        check(StrangSplitting { time_step }, scaled),
        check(Rk4 { time_step }, scaled),
        check(Nystrom { time_step }, scaled),
    ]
}

#[test]
fn a_limit_that_is_too_large_is_found_with_each_method() {
    for factor in [1.15, 1.5, 10.0, 1e300] {
        for found in check_times(factor) {
            let violation = found.expect_err("a limit that is too large");
            assert_eq!(violation.requirement, Requirement::StableStep, "{factor}");
            assert!(violation.value > violation.bound, "{violation}");
            let sentence = std::format!("{violation}");
            assert!(sentence.contains("largest_stable_step: got "), "{sentence}");
            assert!(sentence.contains("at a stiffness of "), "{sentence}");
        }
    }
}

#[test]
fn a_limit_that_is_too_small_passes() {
    for factor in [1.0, 0.6, 1e-3, 0.0] {
        assert_eq!(check_times(factor), [Ok(()); 5], "{factor}");
    }
}

/// A limit without the damping, one without the springs, and one of another dimension.
#[test]
fn a_limit_of_another_formula_is_found() {
    let method = SymplecticEuler {
        time_step: TIME_STEP,
    };
    let found = |limit: fn([f64; 2]) -> f64| {
        check(method, |_, rates| Some(limit(rates))).map_err(|violation| violation.requirement)
    };
    let wrong = Err(Requirement::StableStep);
    assert_eq!(found(|[stiffness, _]| 2.0 / stiffness.sqrt()), wrong);
    assert_eq!(found(|[_, damping]| 2.0 / damping), wrong);
    assert_eq!(found(|_| TIME_STEP), wrong);
    assert_eq!(found(|_| f64::INFINITY), wrong);
    let exact = |[stiffness, damping]: [f64; 2]| {
        4.0 / (damping + f64::sqrt(damping * damping + 4.0 * stiffness))
    };
    assert_eq!(found(exact), Ok(()));
}

#[test]
fn a_limit_that_is_negative_or_not_a_number_is_named() {
    for limit in [-1e-3, f64::NAN, f64::NEG_INFINITY] {
        let time_step = TIME_STEP;
        let found = check(Rk4 { time_step }, |_, _| Some(limit));
        let sentence = std::format!("{}", found.expect_err("no limit"));
        assert!(sentence.contains("largest stable step"), "{sentence}");
    }
}

#[test]
fn a_method_without_a_limit_is_not_checked() {
    let method = SymplecticEuler {
        time_step: TIME_STEP,
    };
    assert_eq!(check(method, |_, _| None), Ok(()));
}

/// With a shorter step, the weight of the box that slides overflows.
#[test]
fn the_shortest_steps_of_the_scenes_pass() {
    let plan = CheckPlan::default();
    let method = SymplecticEuler { time_step: 1e-76 };
    assert_eq!(check_integrator::<f64, _>(&method, plan), Ok(()));
    let method = SymplecticEuler { time_step: 3e-11 };
    assert_eq!(check_integrator::<f32, _>(&method, plan), Ok(()));
}
