//! Sums of the reports of an integrator's steps.

use std::cell::Cell;

use tumble::{Dynamics, Integrator, LinearMotion, SceneError, State, Step, StepError};

/// Sums over the steps of a run.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) steps: u64,
    pub(crate) iterations: u64,
    /// Number of steps that took a fallback.
    pub(crate) fallbacks: u64,
    /// Energy removed so that the total never increases, J.
    pub(crate) energy_removed: f64,
}

/// An integrator that counts its steps, and takes the same steps as without counting.
#[derive(Debug)]
pub(crate) struct Tallied<I> {
    integrator: I,
    tally: Cell<Tally>,
}

impl<I> Tallied<I> {
    pub(crate) fn new(integrator: I) -> Self {
        Self {
            integrator,
            tally: Cell::new(Tally::default()),
        }
    }

    /// Returns the sums so far.
    pub(crate) fn tally(&self) -> Tally {
        self.tally.get()
    }
}

impl<I: Integrator<f64>> Integrator<f64> for Tallied<I> {
    type Workspace = I::Workspace;

    fn step<D: Dynamics<f64>>(
        &self,
        scene: &D,
        state: &mut State,
        limit: f64,
        workspace: &mut I::Workspace,
    ) -> Result<Step, StepError> {
        let step = self.integrator.step(scene, state, limit, workspace)?;
        let sum = self.tally.get();
        self.tally.set(Tally {
            steps: sum.steps + 1,
            iterations: sum.iterations + u64::from(step.iterations),
            fallbacks: sum.fallbacks + u64::from(step.fallback),
            energy_removed: sum.energy_removed + step.energy_removed,
        });
        Ok(step)
    }

    fn order(&self) -> u32 {
        self.integrator.order()
    }

    fn largest_stable_step(&self, stiffness: f64, damping: f64) -> Option<f64> {
        self.integrator.largest_stable_step(stiffness, damping)
    }

    fn linear_step(
        &self,
        motion: &LinearMotion,
        start: [[f64; 6]; 2],
        time_step: f64,
    ) -> Option<[[f64; 6]; 2]> {
        self.integrator.linear_step(motion, start, time_step)
    }

    fn check(&self) -> Result<(), SceneError> {
        self.integrator.check()
    }
}
