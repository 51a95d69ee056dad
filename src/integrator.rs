//! How a state moves on in time: one file a method.

mod any;
mod bogacki_shampine_32;
mod contact_path;
mod dormand_prince_54;
mod embedded_pair;
mod energy_limit;
mod energy_momentum;
mod fingerprint;
mod flight;
mod flight_rounding;
mod forward_euler;
mod nystrom;
mod rk4;
mod strang_splitting;
mod symplectic_euler;

pub(crate) use dormand_prince_54::PAIR as DORMAND_PRINCE;
pub(crate) use rk4::Point;

pub use any::{AnyIntegrator, Workspace as AnyWorkspace};
pub use bogacki_shampine_32::BogackiShampine32;
pub use dormand_prince_54::DormandPrince54;
pub use embedded_pair::Workspace as EmbeddedPairWorkspace;
pub use energy_momentum::{EnergyMomentum, Workspace as EnergyMomentumWorkspace};
pub use flight::Flight;
pub use forward_euler::ForwardEuler;
pub use nystrom::Nystrom;
pub use rk4::Rk4;
pub use strang_splitting::StrangSplitting;
pub use symplectic_euler::SymplecticEuler;

use core::fmt::Debug;

use crate::error::{self, SceneError, StepError};
use crate::real::Real;
use crate::scene::Dynamics;
use crate::state::State;

/// A method that moves a state on in time.
///
/// Its accuracy (a time step, a tolerance) is its own field. *To the implementer:*
/// [`step`](Self::step) must advance by at most `limit`, must be a function of scene, state and
/// limit alone (a workspace may save work, never change a result), and keep the orientation's
/// length at 1. A method that chooses its steps says so by [`ADAPTIVE`](Self::ADAPTIVE):
/// its step is a function of scene, state, limit and the proposal that the workspace holds, and a
/// new workspace proposes from the state alone.
/// [`contract::check_integrator`](crate::contract::check_integrator) tests an implementation.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not an integrator: it does not implement `Integrator<{R}>`",
    label = "this should be an integrator",
    note = "implement `step`, `order` and `check`; the precision `{R}` of scene and integrator must be the same"
)]
pub trait Integrator<R: Real = f64> {
    /// What the method may keep from step to step to save work: its results must not depend on it,
    /// but for a length of the next step where the method [chooses its steps](Self::ADAPTIVE).
    /// A copy must do as well.
    type Workspace: Default + Clone + Debug;

    /// Whether the method chooses the length of its steps, and carries its choice of the next one
    /// in the workspace.
    const ADAPTIVE: bool = false;

    /// Whether one step may span several of the [fixed steps](Self::fixed_step), as closed-form
    /// flight does. Default: false. A run of more fixed steps than its clock counts is then refused
    /// only after a step that spans none.
    const SPANS_STEPS: bool = false;

    /// One step of the method's own length, or of `limit` seconds where that is less.
    ///
    /// # Errors
    /// Where the method cannot go on; the caller keeps the state from before.
    fn step<D: Dynamics<R>>(
        &self,
        scene: &D,
        state: &mut State<R>,
        limit: R,
        workspace: &mut Self::Workspace,
    ) -> Result<Step<R>, StepError>;

    /// Order of the error in the time step, in smooth motion.
    fn order(&self) -> u32;

    /// The length of its steps where they are all alike, s.
    fn fixed_step(&self) -> Option<R> {
        None
    }

    /// Largest stable step (s) for the oscillator `y'' + damping y' + stiffness y = 0`, with
    /// `stiffness` in 1/s² and `damping` in 1/s, both at least 0: every shorter step is stable too.
    /// `None` if the method is stable at any step.
    ///
    /// 0 if no step is stable, as for an explicit Euler step without damping. A contact that acts
    /// on an effective mass `m` has the stiffness `k/m` and the damping `c/m`. The value depends on
    /// the method alone, not on its own step size.
    /// [`Stepper::largest_stable_step`](crate::Stepper::largest_stable_step) evaluates it for the
    /// contacts of a state.
    ///
    /// The provided method returns `None`. An explicit method should override it with the limit of
    /// its stability region: for a Runge-Kutta method, the `h` at which `h λ` leaves the region for
    /// a root of `λ² + damping λ + stiffness = 0`.
    #[inline]
    fn largest_stable_step(&self, stiffness: R, damping: R) -> Option<R> {
        let _ = (stiffness, damping);
        None
    }

    /// Returns what a method that [chooses its steps](Self::ADAPTIVE) must carry on from
    /// `state`, for a [`Session`](crate::Session) that is saved. Default: `None`.
    ///
    /// A workspace that is new but for [`set_step_control`](Self::set_step_control) must lead to
    /// the same states.
    #[inline]
    fn step_control(
        &self,
        workspace: &Self::Workspace,
        state: &State<R>,
    ) -> Option<StepControl<R>> {
        let _ = (workspace, state);
        None
    }

    /// Puts what [`step_control`](Self::step_control) has returned into a workspace, and begins a
    /// new budget of steps where the method has one. Default: no effect.
    #[inline]
    fn set_step_control(&self, workspace: &mut Self::Workspace, control: StepControl<R>) {
        let _ = (workspace, control);
    }

    /// Whether the method's parameters can be: called once, when a scene is composed.
    ///
    /// # Errors
    /// Names the quantity, the rule that it breaks, and its value.
    fn check(&self) -> Result<(), SceneError>;
}

/// The choice of the next step by a method that [chooses its steps](Integrator::ADAPTIVE).
///
/// Plain data, with the feature `serde`. It belongs to the state after the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "R: serde::Serialize, R::Quat: serde::Serialize",
        deserialize = "R: serde::Deserialize<'de>, R::Quat: serde::Deserialize<'de>"
    ))
)]
pub struct StepControl<R: Real = f64> {
    /// Length of the next step, s, above 0. `None` if the method chooses it from the state.
    pub next_step: Option<R>,
    /// Measure of the error of the last step, at least 0, by the method's own definition. `None`
    /// before the first step.
    pub last_error: Option<R>,
    /// Orientation that the next step begins with, if that is not the state's: before it was scaled
    /// to length 1, to rounding, for the state. Ignored if it does not belong to the state.
    pub orientation: Option<R::Quat>,
}

impl<R: Real> StepControl<R> {
    /// Checks that both numbers are valid.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the length is not above 0, the error is negative, or either is not
    /// finite.
    pub fn check(&self) -> Result<(), SceneError> {
        if let Some(length) = self.next_step {
            error::above_zero("length of the next step", length, " s")?;
        }
        if let Some(error) = self.last_error {
            error::at_least_zero("error of the last step", error, "")?;
        }
        Ok(())
    }
}

/// What a step did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Step<R = f64> {
    /// Time advanced by, s.
    pub elapsed: R,
    /// How often the contacts' forces were evaluated.
    pub evaluations: u32,
    /// How many attempts were turned down before, by a method that chooses its steps.
    pub rejected: u32,
    /// Iterations of an implicit method, over all parts of the step.
    pub iterations: u32,
    /// Whether an implicit method could not take the step whole: it was too long to be accurate.
    pub fallback: bool,
    /// Energy that was removed so that the total does not rise, J: what the solver's error would
    /// have added.
    pub energy_removed: R,
}

impl<R: Real> Step<R> {
    /// A step of `elapsed` seconds at the cost of `evaluations` of the forces.
    #[inline]
    #[must_use]
    pub fn new(elapsed: R, evaluations: u32) -> Self {
        Self {
            elapsed,
            evaluations,
            rejected: 0,
            iterations: 0,
            fallback: false,
            energy_removed: R::ZERO,
        }
    }
}

/// One line with units: `{:.3}` sets the digits of each number.
impl<R: Real> core::fmt::Display for Step<R> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        core::fmt::Display::fmt(&self.elapsed, f)?;
        write!(f, " s, {} evaluations", self.evaluations)?;
        write!(f, ", {} rejected", self.rejected)?;
        write!(f, ", {} iterations", self.iterations)?;
        f.write_str(if self.fallback { ", divided, " } else { ", " })?;
        core::fmt::Display::fmt(&self.energy_removed, f)?;
        f.write_str(" J removed")
    }
}

/// The last number before a condition begins to hold, by bisection between one where it does not
/// hold and one where it does.
fn last_before<R: Real>(bracket: [R; 2], holds: impl Fn(R) -> bool) -> R {
    let [mut low, mut high] = bracket;
    // The bracket is at most as wide as its start, or a 64th of the result: this resolves f32 and
    // is 6e-8 of the result in f64.
    for _ in 0..24 {
        let middle = (low + high) * R::HALF;
        if holds(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    low
}

/// Returns the length of the next step of a method with a fixed `time_step`: `limit` if that is
/// less.
///
/// A step is never longer than its limit. A run passes the whole step as the limit if what is left
/// differs from it by rounding alone, so that ten steps of 0.1 s and an advance by 1 s have the
/// same bits.
#[inline]
#[must_use]
pub fn step_length<R: Real>(time_step: R, limit: R) -> R {
    if limit < time_step { limit } else { time_step }
}
