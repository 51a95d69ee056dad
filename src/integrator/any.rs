//! Built-in integrator chosen at run time.

use crate::body::ContactRange;
use crate::error::{SceneError, StepError};
use crate::integrator::adaptive::{
    AdaptiveEnergyMomentum, AdaptiveEnergyMomentumWorkspace, AdaptiveNystrom,
    AdaptiveNystromWorkspace, BogackiShampine32, DormandPrince54, EmbeddedPairWorkspace, Radau5,
};
use crate::integrator::energy_momentum::{EnergyMomentum, Workspace as EnergyMomentumWorkspace};
use crate::integrator::explicit::{ForwardEuler, Nystrom, Rk4, StrangSplitting, SymplecticEuler};
use crate::integrator::interface::{Integrator, Step, StepControl};
use crate::real::Real;
use crate::scene::Dynamics;
use crate::stability::LinearMotion;
use crate::state::State;

/// A built-in integrator chosen at run time, for example from a file, a menu or an argument.
///
/// Its steps have the same bits as those of the chosen method. `Display` writes the name of the
/// method, and the feature `serde` saves and loads it. [`Flight`](crate::Flight) accepts it like
/// any integrator. The program then contains all methods, and takes longer to compile than with a
/// single one.
/// ```
/// use tumble::{AnyIntegrator, EnergyMomentum, Rk4, Trial};
///
/// let trial = Trial::<f64>::report(1).ok_or("no such trial")?;
/// let time_step = 1e-3; // s
/// let implicit: AnyIntegrator = EnergyMomentum { time_step }.into();
/// let methods = [implicit, Rk4 { time_step }.into()];
/// for method in methods {
///     let mut state = trial.state();
///     trial.stepper(method)?.advance(&mut state, 0.1)?;
///     println!("{method}: {:.4} m", state.position.z);
/// }
/// assert_eq!(methods[1].to_string(), "Rk4");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum AnyIntegrator<R = f64> {
    /// Forward Euler: see [`ForwardEuler`].
    ForwardEuler(ForwardEuler<R>),
    /// Semi-implicit Euler: see [`SymplecticEuler`].
    SymplecticEuler(SymplecticEuler<R>),
    /// Strang splitting: see [`StrangSplitting`].
    StrangSplitting(StrangSplitting<R>),
    /// Classical Runge-Kutta: see [`Rk4`].
    Rk4(Rk4<R>),
    /// Nyström's method with touch-down correction: see [`Nystrom`].
    Nystrom(Nystrom<R>),
    /// Adaptive, of order 3: see [`BogackiShampine32`].
    BogackiShampine32(BogackiShampine32<R>),
    /// Adaptive, of order 5: see [`DormandPrince54`].
    DormandPrince54(DormandPrince54<R>),
    /// Implicit, with an energy that never increases: see [`EnergyMomentum`].
    EnergyMomentum(EnergyMomentum<R>),
    /// Implicit and adaptive, with an energy that never increases: see [`AdaptiveEnergyMomentum`].
    AdaptiveEnergyMomentum(AdaptiveEnergyMomentum<R>),
    /// Adaptive, with touch-down correction: see [`AdaptiveNystrom`].
    AdaptiveNystrom(AdaptiveNystrom<R>),
    /// Implicit, of order 5 and adaptive: see [`Radau5`].
    Radau5(Radau5<R>),
}

/// Workspace of [`AnyIntegrator`], which contains the workspace of the method in use.
// Not an enum: switching an enum to another method in place would need a branch that panics.
#[derive(Clone, Debug, Default)]
pub struct Workspace<R: Real = f64> {
    near: ContactRange,
    pair: Option<EmbeddedPairWorkspace<R>>,
    implicit: Option<EnergyMomentumWorkspace<R>>,
    adaptive: Option<AdaptiveEnergyMomentumWorkspace<R>>,
    nystrom: Option<AdaptiveNystromWorkspace<R>>,
}

impl<R: Real> Workspace<R> {
    #[inline]
    fn pair(&mut self) -> &mut EmbeddedPairWorkspace<R> {
        self.pair.get_or_insert_with(Default::default)
    }

    #[inline]
    fn implicit(&mut self) -> &mut EnergyMomentumWorkspace<R> {
        self.implicit.get_or_insert_with(Default::default)
    }

    #[inline]
    fn adaptive(&mut self) -> &mut AdaptiveEnergyMomentumWorkspace<R> {
        self.adaptive.get_or_insert_with(Default::default)
    }

    #[inline]
    fn nystrom(&mut self) -> &mut AdaptiveNystromWorkspace<R> {
        self.nystrom.get_or_insert_with(Default::default)
    }
}

/// Evaluates the same expression with the method of each variant.
macro_rules! each {
    ($any:expr, $method:ident => $result:expr) => {
        match $any {
            AnyIntegrator::ForwardEuler($method) => $result,
            AnyIntegrator::SymplecticEuler($method) => $result,
            AnyIntegrator::StrangSplitting($method) => $result,
            AnyIntegrator::Rk4($method) => $result,
            AnyIntegrator::Nystrom($method) => $result,
            AnyIntegrator::BogackiShampine32($method) => $result,
            AnyIntegrator::DormandPrince54($method) => $result,
            AnyIntegrator::EnergyMomentum($method) => $result,
            AnyIntegrator::AdaptiveEnergyMomentum($method) => $result,
            AnyIntegrator::AdaptiveNystrom($method) => $result,
            AnyIntegrator::Radau5($method) => $result,
        }
    };
}

impl<R: Real> Integrator<R> for AnyIntegrator<R> {
    type Workspace = Workspace<R>;

    /// True because some of the methods are adaptive.
    const ADAPTIVE: bool = true;

    fn step<D: Dynamics<R>>(
        &self,
        scene: &D,
        state: &mut State<R>,
        limit: R,
        workspace: &mut Workspace<R>,
    ) -> Result<Step<R>, StepError> {
        match self {
            Self::ForwardEuler(method) => method.step(scene, state, limit, &mut workspace.near),
            Self::SymplecticEuler(method) => method.step(scene, state, limit, &mut workspace.near),
            Self::StrangSplitting(method) => method.step(scene, state, limit, &mut workspace.near),
            Self::Rk4(method) => method.step(scene, state, limit, &mut workspace.near),
            Self::Nystrom(method) => method.step(scene, state, limit, &mut workspace.near),
            Self::BogackiShampine32(method) => method.step(scene, state, limit, workspace.pair()),
            Self::DormandPrince54(method) => method.step(scene, state, limit, workspace.pair()),
            Self::EnergyMomentum(method) => method.step(scene, state, limit, workspace.implicit()),
            Self::AdaptiveEnergyMomentum(method) => {
                method.step(scene, state, limit, workspace.adaptive())
            }
            Self::AdaptiveNystrom(method) => method.step(scene, state, limit, workspace.nystrom()),
            Self::Radau5(method) => method.step(scene, state, limit, workspace.pair()),
        }
    }

    fn order(&self) -> u32 {
        each!(self, method => Integrator::<R>::order(method))
    }

    fn fixed_step(&self) -> Option<R> {
        each!(self, method => method.fixed_step())
    }

    fn largest_stable_step(&self, stiffness: R, damping: R) -> Option<R> {
        each!(self, method => method.largest_stable_step(stiffness, damping))
    }

    fn linear_step(
        &self,
        motion: &LinearMotion,
        start: [[f64; 6]; 2],
        time_step: f64,
    ) -> Option<[[f64; 6]; 2]> {
        each!(self, method => Integrator::<R>::linear_step(method, motion, start, time_step))
    }

    fn step_control(&self, workspace: &Workspace<R>, state: &State<R>) -> Option<StepControl<R>> {
        match self {
            Self::BogackiShampine32(method) => control_of(method, workspace.pair.as_ref(), state),
            Self::DormandPrince54(method) => control_of(method, workspace.pair.as_ref(), state),
            Self::Radau5(method) => control_of(method, workspace.pair.as_ref(), state),
            Self::AdaptiveEnergyMomentum(method) => {
                control_of(method, workspace.adaptive.as_ref(), state)
            }
            Self::AdaptiveNystrom(method) => control_of(method, workspace.nystrom.as_ref(), state),
            _ => None,
        }
    }

    fn set_step_control(&self, workspace: &mut Workspace<R>, control: StepControl<R>) {
        match self {
            Self::BogackiShampine32(method) => method.set_step_control(workspace.pair(), control),
            Self::DormandPrince54(method) => method.set_step_control(workspace.pair(), control),
            Self::Radau5(method) => method.set_step_control(workspace.pair(), control),
            Self::AdaptiveEnergyMomentum(method) => {
                method.set_step_control(workspace.adaptive(), control);
            }
            Self::AdaptiveNystrom(method) => method.set_step_control(workspace.nystrom(), control),
            _ => {}
        }
    }

    /// Keeps the workspace of the method in use, which is emptied in its place.
    fn clear(&self, workspace: &mut Self::Workspace) {
        workspace.near = ContactRange::NONE;
        (workspace.pair, workspace.nystrom) = (None, None);
        match (self, &mut workspace.implicit) {
            (Self::EnergyMomentum(method), Some(own)) => method.clear(own),
            (_, other) => *other = None,
        }
        match (self, &mut workspace.adaptive) {
            (Self::AdaptiveEnergyMomentum(method), Some(own)) => method.clear(own),
            (_, other) => *other = None,
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        each!(self, method => method.check())
    }
}

/// Choice of the next step by a method, whose workspace is new before its first step.
fn control_of<R: Real, I: Integrator<R>>(
    method: &I,
    workspace: Option<&I::Workspace>,
    state: &State<R>,
) -> Option<StepControl<R>> {
    match workspace {
        Some(workspace) => method.step_control(workspace, state),
        None => method.step_control(&I::Workspace::default(), state),
    }
}

/// Writes the name of the method.
impl<R> core::fmt::Display for AnyIntegrator<R> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Self::ForwardEuler(_) => "ForwardEuler",
            Self::SymplecticEuler(_) => "SymplecticEuler",
            Self::StrangSplitting(_) => "StrangSplitting",
            Self::Rk4(_) => "Rk4",
            Self::Nystrom(_) => "Nystrom",
            Self::BogackiShampine32(_) => "BogackiShampine32",
            Self::DormandPrince54(_) => "DormandPrince54",
            Self::EnergyMomentum(_) => "EnergyMomentum",
            Self::AdaptiveEnergyMomentum(_) => "AdaptiveEnergyMomentum",
            Self::AdaptiveNystrom(_) => "AdaptiveNystrom",
            Self::Radau5(_) => "Radau5",
        })
    }
}

macro_rules! from_each {
    ($($method:ident)*) => {
        $(impl<R> From<$method<R>> for AnyIntegrator<R> {
            fn from(method: $method<R>) -> Self {
                Self::$method(method)
            }
        })*
    };
}
from_each!(ForwardEuler SymplecticEuler StrangSplitting Rk4 Nystrom);
from_each!(BogackiShampine32 DormandPrince54 EnergyMomentum AdaptiveEnergyMomentum);
from_each!(AdaptiveNystrom Radau5);
