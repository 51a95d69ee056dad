//! The interface of an integrator: one step of a scene, and its report.

use core::fmt::Debug;

use crate::body::RigidPointBody;
use crate::error::{self, SceneError, StepError};
use crate::integrator::lanes::Lanes;
use crate::real::Real;
use crate::scene::Dynamics;
use crate::stability::LinearMotion;
use crate::state::State;

/// A numerical method that advances a state in time.
///
/// The parameter of its accuracy, a step size or a tolerance, is a field of the method.
///
/// *Requirements on an implementation:*
/// - [`step`](Self::step) advances by at most `limit`.
/// - Its result is a function of scene, state and limit alone. A workspace may save work but never
///   change a result.
/// - The orientation keeps the length 1.
/// - An adaptive method, which chooses its step size, sets [`ADAPTIVE`](Self::ADAPTIVE). Its step
///   may also depend on the step size that the workspace proposes. A new workspace proposes from
///   the state alone.
///
/// [`contract::check_integrator`](crate::contract::check_integrator) tests an implementation.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not an integrator: it does not implement `Integrator<{R}>`",
    label = "this should be an integrator",
    note = "implement `step`, `order` and `check`; the precision `{R}` of scene and integrator must be the same"
)]
pub trait Integrator<R: Real = f64> {
    /// Data that the method may keep from step to step to save work.
    ///
    /// Results must not depend on it, except for the size of the next step of an
    /// [adaptive](Self::ADAPTIVE) method. A clone must give the same results.
    ///
    /// A workspace is used with one scene only. So the method may keep what it has evaluated at a
    /// state, and use it again at the same state. A [`Session`](crate::Session) ensures this,
    /// because it borrows its stepper. Whoever calls [`step`](Self::step) directly creates or
    /// [clears](Self::clear) a workspace for each scene. Otherwise a step can use energies and
    /// forces of the other scene.
    type Workspace: Default + Clone + Debug;

    /// True if the method chooses its step size and keeps the size of the next step in the
    /// workspace.
    const ADAPTIVE: bool = false;

    /// True if one step may span several [fixed steps](Self::fixed_step), as closed-form flight
    /// does. Default: false.
    ///
    /// A run of more fixed steps than its clock can count is then rejected only after a step that
    /// spans none.
    const SPANS_STEPS: bool = false;

    /// True if the method has a [`step_in_lanes`](Self::step_in_lanes).
    #[doc(hidden)]
    const HAS_LANES: bool = false;

    /// Takes the same step of several states, each with the bits of [`step`](Self::step). The body
    /// has three equal moments of inertia, or two equal ones and a larger one.
    #[doc(hidden)]
    #[inline]
    fn step_in_lanes<D: Dynamics<R>>(&self, scene: &D, lanes: &mut Lanes<R>, seconds: R) {
        let _ = (scene, lanes, seconds);
    }

    /// Takes one step of the method's own size, or of `limit` seconds if that is less.
    ///
    /// # Errors
    /// Returns [`StepError`] if the method cannot complete the step. The caller keeps the state
    /// from before the step.
    fn step<D: Dynamics<R>>(
        &self,
        scene: &D,
        state: &mut State<R>,
        limit: R,
        workspace: &mut Self::Workspace,
    ) -> Result<Step<R>, StepError>;

    /// Returns the order of the global error in the step size, in smooth motion.
    fn order(&self) -> u32;

    /// Returns the step size if all steps have the same size, s.
    fn fixed_step(&self) -> Option<R> {
        None
    }

    /// Returns the largest stable step size for a damped linear oscillator, s.
    ///
    /// The oscillator is `y'' + damping y' + stiffness y = 0`, with `stiffness` in 1/s² and
    /// `damping` in 1/s, both at least 0. Every smaller step size is stable too. Returns `None` if
    /// the method is stable at any step size, and 0 if no step size is stable, as for an explicit
    /// Euler step without damping.
    ///
    /// A contact that acts on an effective mass `m` has the stiffness `k/m` and the damping `c/m`.
    /// The value depends on the method alone, not on its own step size.
    /// [`Stepper::largest_stable_step`](crate::Stepper::largest_stable_step) evaluates it for the
    /// contacts of a state.
    ///
    /// The provided method returns `None`. An explicit method should override it with the limit of
    /// its stability region. For a Runge-Kutta method, this is the `h` at which `h λ` leaves the
    /// region for a root of `λ² + damping λ + stiffness = 0`.
    #[inline]
    fn largest_stable_step(&self, stiffness: R, damping: R) -> Option<R> {
        let _ = (stiffness, damping);
        None
    }

    /// Takes one step of a linear motion from `[y, y']`, for
    /// [`Stepper::largest_stable_step`](crate::Stepper::largest_stable_step).
    ///
    /// The step is that of the method on the equation of `motion`, and `time_step` is in its unit
    /// of time. Returns `None` if the method multiplies each solution `e^(λ t)` by a function of
    /// `h λ`. So does a Runge-Kutta method, and
    /// [`largest_stable_step`](Self::largest_stable_step) then says everything. A splitting method
    /// does not, if springs and dampers act on different motions.
    ///
    /// The provided method returns `None`.
    ///
    /// ```
    /// use tumble::LinearMotion;
    ///
    /// /// Semi-implicit Euler.
    /// fn step(motion: &LinearMotion, start: [[f64; 6]; 2], h: f64) -> [[f64; 6]; 2] {
    ///     let [mut y, mut v] = start;
    ///     let acceleration = motion.acceleration(&y, &v);
    ///     for i in 0..6 {
    ///         v[i] += acceleration[i] * h;
    ///         y[i] += v[i] * h;
    ///     }
    ///     [y, v]
    /// }
    /// ```
    fn linear_step(
        &self,
        motion: &LinearMotion,
        start: [[f64; 6]; 2],
        time_step: f64,
    ) -> Option<[[f64; 6]; 2]> {
        let _ = (motion, start, time_step);
        None
    }

    /// Returns the data that an [adaptive](Self::ADAPTIVE) method needs to continue from `state`.
    /// Default: `None`.
    ///
    /// A saved [`Session`](crate::Session) contains them. A new workspace must lead to the same
    /// states once [`set_step_control`](Self::set_step_control) has been applied to it.
    #[inline]
    fn step_control(
        &self,
        workspace: &Self::Workspace,
        state: &State<R>,
    ) -> Option<StepControl<R>> {
        let _ = (workspace, state);
        None
    }

    /// Restores the data returned by [`step_control`](Self::step_control) in a workspace. Default:
    /// no effect.
    ///
    /// If the method has a budget of steps, a new budget begins.
    #[inline]
    fn set_step_control(&self, workspace: &mut Self::Workspace, control: StepControl<R>) {
        let _ = (workspace, control);
    }

    /// Empties a workspace, so that the next step is that with a new one. Default: replaces it by a
    /// new one.
    ///
    /// Override it if the workspace is large and a new one would need as much space on the stack.
    #[inline]
    fn clear(&self, workspace: &mut Self::Workspace) {
        *workspace = Self::Workspace::default();
    }

    /// Checks that the method's parameters are valid. Called once, when a scene is composed.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a parameter is invalid. The error names the quantity, the rule and
    /// the value.
    fn check(&self) -> Result<(), SceneError>;

    /// Checks that the method can step a body. Called once, when a scene is composed. Default: it
    /// can.
    ///
    /// # Errors
    /// Returns [`SceneError`] if it cannot. The error names the quantity, the rule and the value.
    fn check_body(&self, body: &impl RigidPointBody<R>) -> Result<(), SceneError> {
        let _ = body;
        Ok(())
    }
}

/// Data from which an [adaptive](Integrator::ADAPTIVE) method continues: the size of the next step
/// and what determines it.
///
/// Plain data, serialisable with the feature `serde`. It belongs to the state after the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields),
    serde(bound(
        serialize = "R: serde::Serialize, R::Quat: serde::Serialize",
        deserialize = "R: serde::Deserialize<'de>, R::Quat: serde::Deserialize<'de>"
    ))
)]
pub struct StepControl<R: Real = f64> {
    /// Size of the next step, s, above 0. `None` if the method chooses it from the state.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "super::saved::required"))]
    pub next_step: Option<R>,
    /// Measure of the error of the last step, above 0. The method defines it. `None` before the
    /// first step, and for a step without an error.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "super::saved::required"))]
    pub last_error: Option<R>,
    /// Orientation at the start of the next step, before it was scaled to length 1 for the state.
    ///
    /// `None` if it is that of the state. It differs from that of the state by rounding, and is
    /// ignored if it does not belong to the state.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "super::saved::required"))]
    pub orientation: Option<R::Quat>,
}

impl<R: Real> StepControl<R> {
    /// Checks that both numbers are valid.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the length or the error is not above 0, or not finite.
    pub fn check(&self) -> Result<(), SceneError> {
        if let Some(length) = self.next_step {
            error::above_zero("length of the next step", length, " s")?;
        }
        if let Some(error) = self.last_error {
            error::above_zero("error of the last step", error, "")?;
        }
        Ok(())
    }
}

/// Result of a step: time advanced, and the work it took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Step<R = f64> {
    /// Time by which the step advanced, s.
    pub elapsed: R,
    /// Number of evaluations of the contact forces.
    pub evaluations: u32,
    /// Number of attempts that an adaptive method rejected before this step.
    pub rejected: u32,
    /// Number of iterations of an implicit method, over all parts of the step.
    pub iterations: u32,
    /// True if an implicit method needed a fallback, such as a division of the step. The step was
    /// then too large to be accurate.
    pub fallback: bool,
    /// Energy removed so that the total never increases, J.
    ///
    /// It is the energy that the error of the solver would have added.
    pub energy_removed: R,
    /// Work of the drives of the scene in the step, J.
    ///
    /// Drives are a force that is [not passive](crate::Force::is_passive) and a [ground that
    /// moves](crate::MovingGround). [`EnergyMomentum`](crate::EnergyMomentum),
    /// [`CompactEnergyMomentum`](crate::CompactEnergyMomentum) and
    /// [`AdaptiveEnergyMomentum`](crate::AdaptiveEnergyMomentum) state it: the energy after their
    /// step is at most the energy before it plus this work, as computed. It is 0 without a drive.
    /// The other integrators always return 0. The [`Ledger`](crate::Ledger) computes the work for
    /// every integrator.
    pub drive_work: R,
    /// Estimate of the error that the step has added, m, from an adaptive method.
    ///
    /// It is a displacement of the farthest point of the body, at once and through the velocities.
    /// The [method](Integrator#implementors) defines it. `None` if there is no estimate.
    ///
    /// It is no bound. If a contact opens or closes, or friction reverses, it indicates the size of
    /// the error or misses it. With velocities counted for a second, the true error of 99 in 100
    /// random steps of a box on the ground is below 3 tolerances of
    /// [`BogackiShampine32`](crate::BogackiShampine32), 15 of
    /// [`DormandPrince54`](crate::DormandPrince54) and 5 of [`Radau5`](crate::Radau5). Of steps
    /// whose error is above a hundredth of the tolerance, it is below 10, 40 and 200 estimates
    /// (`tests/physics/error_estimate.rs`). The tolerance is chosen for the error of a run:
    /// [`guide::choosing`](crate::guide::choosing).
    pub error_estimate: Option<R>,
}

impl<R: Real> Step<R> {
    /// Creates the result of a step of `elapsed` seconds with `evaluations` force evaluations. The
    /// other fields are zero.
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
            drive_work: R::ZERO,
            error_estimate: None,
        }
    }
}

/// Formats the step as one line with units. `{:.3}` sets the digits of each number.
impl<R: Real> core::fmt::Display for Step<R> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        core::fmt::Display::fmt(&self.elapsed, f)?;
        write!(f, " s, {} evaluations", self.evaluations)?;
        write!(f, ", {} rejected", self.rejected)?;
        write!(f, ", {} iterations", self.iterations)?;
        f.write_str(if self.fallback {
            ", with a fallback, "
        } else {
            ", "
        })?;
        core::fmt::Display::fmt(&self.energy_removed, f)?;
        f.write_str(" J removed")
    }
}

/// Number of bisections of a stability limit.
///
/// The bracket is at most as wide as its start, or a 64th of the largest limit. They resolve f32,
/// and in f64 6e-8 of the start or 1e-9 of the largest limit.
pub(crate) const LIMIT_HALVINGS: u32 = 24;

/// Returns the size of the next step of a method with a fixed `time_step`: `limit` if that is less.
///
/// A step is never longer than its limit. If the time left in a run differs from a whole step by
/// rounding alone, the run passes the whole step as the limit. Ten steps of 0.1 s and an advance by
/// 1 s therefore have the same bits.
#[inline]
#[must_use]
pub fn step_length<R: Real>(time_step: R, limit: R) -> R {
    if limit < time_step { limit } else { time_step }
}
