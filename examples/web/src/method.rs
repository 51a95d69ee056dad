//! Integrators of the page, chosen by number.

use tumble::{
    Dynamics, EnergyMomentum, ForwardEuler, Integrator, Nystrom, Rk4, SceneError, State, Step,
    StepError, StrangSplitting, SymplecticEuler,
};

use crate::error::PageError;

/// Integrator with a fixed step size.
///
/// `tumble::AnyIntegrator` also has the adaptive methods, whose code the page would carry unused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// The default, whose energy never increases.
    EnergyMomentum(EnergyMomentum),
    /// See `tumble::StrangSplitting`.
    StrangSplitting(StrangSplitting),
    /// See `tumble::SymplecticEuler`.
    SymplecticEuler(SymplecticEuler),
    /// See `tumble::Rk4`.
    Rk4(Rk4),
    /// See `tumble::Nystrom`.
    Nystrom(Nystrom),
    /// See `tumble::ForwardEuler`.
    ForwardEuler(ForwardEuler),
}

impl Method {
    /// Returns the method with a number of the page and a step size, s.
    ///
    /// # Errors
    /// Returns [`PageError::Unknown`] if no method has the number.
    pub fn from_number(number: f64, time_step: f64) -> Result<Self, PageError> {
        let kind = "integrator";
        Ok(match crate::whole(number) {
            Some(0) => Self::default_of(time_step),
            Some(1) => Self::StrangSplitting(StrangSplitting { time_step }),
            Some(2) => Self::SymplecticEuler(SymplecticEuler { time_step }),
            Some(3) => Self::Rk4(Rk4 { time_step }),
            Some(4) => Self::Nystrom(Nystrom { time_step }),
            Some(5) => Self::ForwardEuler(ForwardEuler { time_step }),
            _ => {
                return Err(PageError::Unknown {
                    kind,
                    value: number,
                });
            }
        })
    }

    /// Returns the library's default method with a step size, s.
    #[must_use]
    pub fn default_of(time_step: f64) -> Self {
        Self::EnergyMomentum(EnergyMomentum { time_step })
    }
}

/// Evaluates the same expression with the method of each variant.
macro_rules! each {
    ($any:expr, $method:ident => $result:expr) => {
        match $any {
            Method::EnergyMomentum($method) => $result,
            Method::StrangSplitting($method) => $result,
            Method::SymplecticEuler($method) => $result,
            Method::Rk4($method) => $result,
            Method::Nystrom($method) => $result,
            Method::ForwardEuler($method) => $result,
        }
    };
}

impl Integrator for Method {
    type Workspace = (
        <EnergyMomentum as Integrator>::Workspace,
        tumble::ContactRange,
    );

    fn step<D: Dynamics>(
        &self,
        scene: &D,
        state: &mut State,
        limit: f64,
        workspace: &mut Self::Workspace,
    ) -> Result<Step, StepError> {
        let (implicit, near) = workspace;
        match self {
            Self::EnergyMomentum(method) => method.step(scene, state, limit, implicit),
            Self::StrangSplitting(method) => method.step(scene, state, limit, near),
            Self::SymplecticEuler(method) => method.step(scene, state, limit, near),
            Self::Rk4(method) => method.step(scene, state, limit, near),
            Self::Nystrom(method) => method.step(scene, state, limit, near),
            Self::ForwardEuler(method) => method.step(scene, state, limit, near),
        }
    }

    fn order(&self) -> u32 {
        each!(self, method => Integrator::<f64>::order(method))
    }

    fn fixed_step(&self) -> Option<f64> {
        each!(self, method => method.fixed_step())
    }

    fn largest_stable_step(&self, stiffness: f64, damping: f64) -> Option<f64> {
        each!(self, method => method.largest_stable_step(stiffness, damping))
    }

    fn check(&self) -> Result<(), SceneError> {
        each!(self, method => method.check())
    }
}
