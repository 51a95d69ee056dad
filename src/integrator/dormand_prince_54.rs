//! The pair of Dormand and Prince, of order 5 with an estimate of order 4.

use super::embedded_pair::{self, Pair, Settings, Workspace};
use super::{Integrator, Step, StepControl};
use crate::error::{SceneError, StepError};
use crate::real::Real;
use crate::scene::Dynamics;
use crate::state::State;

/// Runge-Kutta of order 5 that chooses its steps for a tolerance (Dormand & Prince, Journal of
/// Computational and Applied Mathematics 6(1), 1980): six evaluations a step.
///
/// [`guide::choosing`](crate::guide::choosing) says what the tolerance bounds and what error a run
/// has for it. The method for tight tolerances: each tenfold tighter one costs `10^(1/5)`, 1.6
/// times as much in smooth motion. In trials 1, 3, 5 and 8 of the report (slip speed 1e-3 m/s, up
/// to 1 s, tolerances of 1e-3 to 1e-9 m) the error is 0.18 to 9.9 tolerances (`tests/adaptive.rs`
/// prints it); later it is what the motion makes of it, see there. *May add energy* by the size of
/// its error.
///
/// *Not for contacts that stick or roll at a small slip speed:* stability bounds each step by about
/// `2 slip_speed/(3 μ g)`, whatever the tolerance, and a run ends with
/// [`BudgetSpent`](crate::StepError::BudgetSpent). With a slip speed of 1e-6 m/s a rolling ball
/// takes a million steps in half a second. Take [`EnergyMomentum`](crate::EnergyMomentum) there.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DormandPrince54<R = f64> {
    /// m, above 0: what a step may add to the error, see
    /// [`guide::choosing`](crate::guide::choosing).
    pub tolerance: R,
    /// s, above 0: no step is longer.
    pub longest_step: R,
    /// How many steps may be tried in a run, those that are turned down included, at least 1.
    pub budget: u32,
}

impl<R: Real> DormandPrince54<R> {
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

pub(crate) const PAIR: Pair<7> = Pair {
    stages: [
        [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0, 0.0],
        [
            19372.0 / 6561.0,
            -25360.0 / 2187.0,
            64448.0 / 6561.0,
            -212.0 / 729.0,
            0.0,
            0.0,
            0.0,
        ],
        [
            9017.0 / 3168.0,
            -355.0 / 33.0,
            46732.0 / 5247.0,
            49.0 / 176.0,
            -5103.0 / 18656.0,
            0.0,
            0.0,
        ],
        // The weights of the result: the first slope of the next step is the last one of this.
        [
            35.0 / 384.0,
            0.0,
            500.0 / 1113.0,
            125.0 / 192.0,
            -2187.0 / 6784.0,
            11.0 / 84.0,
            0.0,
        ],
        [0.0; 7],
    ],
    error: [
        71.0 / 57600.0,
        0.0,
        -71.0 / 16695.0,
        71.0 / 1920.0,
        -17253.0 / 339_200.0,
        22.0 / 525.0,
        -1.0 / 40.0,
    ],
    // In trials 3 and 8 of the report the local error of the result is 0.1 to 0.8 of the estimate
    // (medians, tolerances of 1e-5 and 1e-7 m), and less for tighter ones.
    trust: 1.0 / 3.0,
    roots: 3,
};

impl<R: Real> Integrator<R> for DormandPrince54<R> {
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
        5
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
