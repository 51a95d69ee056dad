//! The pair of Bogacki and Shampine, of order 3 with an estimate of order 2.

use super::embedded_pair::{self, Pair, Settings, Workspace};
use super::{Integrator, Step, StepControl};
use crate::error::{SceneError, StepError};
use crate::real::Real;
use crate::scene::Dynamics;
use crate::state::State;

/// Runge-Kutta of order 3 that chooses its steps for a tolerance (Bogacki & Shampine, Applied
/// Mathematics Letters 2(4), 1989): three evaluations a step.
///
/// [`guide::choosing`](crate::guide::choosing) says what the tolerance bounds and what error a run
/// has for it. Of the two methods that choose their steps, the one for loose tolerances and for
/// contact with many touch-downs; [`DormandPrince54`](crate::DormandPrince54) is the one for tight
/// tolerances. In trials 1, 3, 5 and 8 of the report (slip speed 1e-3 m/s, up to 1 s, tolerances of
/// 1e-3 to 1e-9 m) the error is 0.17 to 7.1 tolerances (`tests/adaptive.rs` prints it); later it is
/// what the motion makes of it, see there. *May add energy* by the size of its error.
///
/// *Not for contacts that stick or roll at a small slip speed:* stability bounds each step by about
/// `2 slip_speed/(3 μ g)`, whatever the tolerance, and a run ends with
/// [`BudgetSpent`](crate::StepError::BudgetSpent). With a slip speed of 1e-6 m/s a rolling ball
/// takes a million steps in half a second. Take [`EnergyMomentum`](crate::EnergyMomentum) there.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BogackiShampine32<R = f64> {
    /// m, above 0: what a step may add to the error, see
    /// [`guide::choosing`](crate::guide::choosing).
    pub tolerance: R,
    /// s, above 0: no step is longer.
    pub longest_step: R,
    /// How many steps may be tried in a run, those that are turned down included, at least 1.
    pub budget: u32,
}

impl<R: Real> BogackiShampine32<R> {
    /// For a tolerance (m), with steps of at most 0.1 s and a budget of a million of them.
    #[must_use]
    pub fn new(tolerance: R) -> Self {
        Self {
            tolerance,
            longest_step: R::from_f64(0.1),
            budget: 1_000_000,
        }
    }

    fn settings(&self) -> Settings<R> {
        Settings {
            tolerance: self.tolerance,
            longest_step: self.longest_step,
            budget: self.budget,
        }
    }
}

const PAIR: Pair<4> = Pair {
    stages: [
        [1.0 / 2.0, 0.0, 0.0, 0.0],
        [0.0, 3.0 / 4.0, 0.0, 0.0],
        // The weights of the result: the first slope of the next step is the last one of this.
        [2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0, 0.0],
        [0.0; 4],
    ],
    error: [
        2.0 / 9.0 - 7.0 / 24.0,
        1.0 / 3.0 - 1.0 / 4.0,
        4.0 / 9.0 - 1.0 / 3.0,
        -1.0 / 8.0,
    ],
    // The result's local error is 0.1 to 1.6 of the estimate (medians, trials 8 and 3 of the
    // report).
    trust: 1.0,
    roots: 2,
};

impl<R: Real> Integrator<R> for BogackiShampine32<R> {
    type Workspace = Workspace<R>;

    const ADAPTIVE: bool = true;

    fn step<D: Dynamics<R>>(
        &self,
        scene: &D,
        state: &mut State<R>,
        limit: R,
        workspace: &mut Workspace<R>,
    ) -> Result<Step<R>, StepError> {
        embedded_pair::step(&PAIR, &self.settings(), scene, state, limit, workspace)
    }

    fn order(&self) -> u32 {
        3
    }

    #[inline]
    fn step_control(
        &self,
        workspace: &Self::Workspace,
        state: &State<R>,
    ) -> Option<StepControl<R>> {
        Some(workspace.step_control(state))
    }

    #[inline]
    fn set_step_control(&self, workspace: &mut Self::Workspace, control: StepControl<R>) {
        workspace.set_step_control(control);
    }

    fn check(&self) -> Result<(), SceneError> {
        self.settings().check()
    }
}
