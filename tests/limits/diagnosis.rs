//! The work of finding out why a step failed.

use super::contract::Provided;
use core::cell::Cell;
use tumble::glam::DVec3;
use tumble::{Coin, Dynamics, FlatGround, Integrator, SceneError, State, Step, StepError, Stepper};

/// A method that fails once. After that it takes steps of a nanosecond, each with this number of
/// evaluations.
struct FailsOnce {
    evaluations: u32,
    calls: Cell<u32>,
}

impl Integrator for FailsOnce {
    type Workspace = ();
    const ADAPTIVE: bool = true;

    fn step<D: Dynamics<f64>>(
        &self,
        _: &D,
        _: &mut State,
        _: f64,
        (): &mut (),
    ) -> Result<Step, StepError> {
        self.calls.set(self.calls.get() + 1);
        if self.calls.get() == 1 {
            return Err(StepError::Stalled);
        }
        Ok(Step::new(1e-9, self.evaluations))
    }
    fn order(&self) -> u32 {
        1
    }
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }
}

/// A step that fails is taken again to examine the values of the laws. The method may then cover
/// much less in a step, and the time of the failed step is not known.
#[test]
fn a_failed_step_of_costly_evaluations_is_not_repeated_hundreds_of_times() {
    for evaluations in [0, 20, 1_000, 20_000, u32::MAX] {
        let integrator = FailsOnce {
            evaluations,
            calls: Cell::new(0),
        };
        let stepper = Stepper::builder(Coin::ring(1.0, 0.5))
            // Its values are tested, as those of a user's law.
            .ground(Provided(FlatGround::level(1e3, 0.5)))
            .integrator(integrator)
            .build()
            .unwrap();
        let error = stepper.step(&mut State::at(DVec3::Z)).unwrap_err();
        assert!(matches!(error, StepError::Stalled), "{error}");
        let steps = stepper.integrator().calls.get() - 1;
        let work = u64::from(steps) * u64::from(evaluations);
        assert!(steps <= 256, "{steps} steps");
        assert!(
            steps == 1 || work < 10_000,
            "{work} evaluations in {steps} steps"
        );
    }
}
