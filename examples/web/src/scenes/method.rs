//! Integrators of the page, chosen by number.

use tumble::integrator::{
    AdaptiveEnergyMomentumWorkspace, EmbeddedPairWorkspace, EnergyMomentumWorkspace,
};
use tumble::{
    AdaptiveEnergyMomentum, BogackiShampine32, ContactRange, DormandPrince54, Dynamics,
    EnergyMomentum, Flight, ForwardEuler, Integrator, Nystrom, Radau5, Rk4, SceneError, State,
    Step, StepControl, StepError, StrangSplitting, SymplecticEuler,
};

use super::error::PageError;

/// Integrator of the page. Its numbers are those of the page's list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Method {
    kind: Kind,
    /// Step size of the page, s. An adaptive integrator divides it as its tolerance demands.
    pub time_step: f64,
}

// Not `AnyIntegrator`, which contains `AdaptiveNystrom`: the page has no room for both that and
// `Radau5`.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    ForwardEuler(ForwardEuler),
    SymplecticEuler(SymplecticEuler),
    StrangSplitting(StrangSplitting),
    Rk4(Rk4),
    Nystrom(Nystrom),
    EnergyMomentum(EnergyMomentum),
    BogackiShampine32(BogackiShampine32),
    DormandPrince54(DormandPrince54),
    AdaptiveEnergyMomentum(AdaptiveEnergyMomentum),
    Radau5(Radau5),
    /// Closed-form flight, and `StrangSplitting` in contact.
    Flight(Flight<StrangSplitting>),
}

/// Tolerance of the adaptive integrators, as a fraction of the bounding radius of the body.
const TOLERANCE: f64 = 1e-3;
/// Largest number of steps that an adaptive integrator attempts in one step of the page. It is far
/// above the few hundred that steep friction needs, and takes the page less than a second.
const BUDGET: u32 = 20_000;

impl Method {
    /// Count of the methods.
    pub const COUNT: u32 = 11;

    /// Returns the method with a number of the page, for a step size of the page (s) and a body of
    /// a bounding radius (m).
    ///
    /// # Errors
    /// Returns [`PageError::Unknown`] if no method has the number.
    pub fn from_number(number: f64, time_step: f64, radius: f64) -> Result<Self, PageError> {
        let (tolerance, longest_step, budget) = (TOLERANCE * radius, time_step, BUDGET);
        let kind = match super::whole(number) {
            Some(0) => return Ok(Self::default_of(time_step)),
            Some(1) => Kind::StrangSplitting(StrangSplitting { time_step }),
            Some(2) => Kind::SymplecticEuler(SymplecticEuler { time_step }),
            Some(3) => Kind::Rk4(Rk4 { time_step }),
            Some(4) => Kind::Nystrom(Nystrom { time_step }),
            Some(5) => Kind::ForwardEuler(ForwardEuler { time_step }),
            Some(6) => Kind::AdaptiveEnergyMomentum(AdaptiveEnergyMomentum {
                tolerance,
                longest_step,
                budget,
            }),
            Some(7) => Kind::BogackiShampine32(BogackiShampine32 {
                tolerance,
                longest_step,
                budget,
            }),
            Some(8) => Kind::DormandPrince54(DormandPrince54 {
                tolerance,
                longest_step,
                budget,
            }),
            Some(9) => Kind::Flight(Flight(StrangSplitting { time_step })),
            Some(10) => Kind::Radau5(Radau5 {
                tolerance,
                longest_step,
                budget,
            }),
            _ => {
                return Err(PageError::Unknown {
                    kind: "integrator",
                    value: number,
                });
            }
        };
        Ok(Self { kind, time_step })
    }

    /// Returns the library's default method with a step size, s.
    #[must_use]
    pub fn default_of(time_step: f64) -> Self {
        Self {
            kind: Kind::EnergyMomentum(EnergyMomentum { time_step }),
            time_step,
        }
    }

    /// Returns true if the method chooses the size of its steps.
    #[must_use]
    pub fn is_adaptive(&self) -> bool {
        self.fixed_step().is_none()
    }
}

/// Evaluates the same expression with the method of each variant.
macro_rules! each {
    ($any:expr, $method:ident => $result:expr) => {
        match &$any.kind {
            Kind::ForwardEuler($method) => $result,
            Kind::SymplecticEuler($method) => $result,
            Kind::StrangSplitting($method) => $result,
            Kind::Rk4($method) => $result,
            Kind::Nystrom($method) => $result,
            Kind::EnergyMomentum($method) => $result,
            Kind::BogackiShampine32($method) => $result,
            Kind::DormandPrince54($method) => $result,
            Kind::AdaptiveEnergyMomentum($method) => $result,
            Kind::Radau5($method) => $result,
            Kind::Flight($method) => $result,
        }
    };
}

/// Workspaces of the methods.
#[derive(Clone, Debug, Default)]
pub struct Kept {
    near: ContactRange,
    pair: EmbeddedPairWorkspace,
    implicit: EnergyMomentumWorkspace,
    adaptive: AdaptiveEnergyMomentumWorkspace,
}

impl Integrator for Method {
    type Workspace = Kept;

    const ADAPTIVE: bool = true;
    const SPANS_STEPS: bool = true;

    fn step<D: Dynamics>(
        &self,
        scene: &D,
        state: &mut State,
        limit: f64,
        kept: &mut Kept,
    ) -> Result<Step, StepError> {
        match &self.kind {
            Kind::ForwardEuler(method) => method.step(scene, state, limit, &mut kept.near),
            Kind::SymplecticEuler(method) => method.step(scene, state, limit, &mut kept.near),
            Kind::StrangSplitting(method) => method.step(scene, state, limit, &mut kept.near),
            Kind::Rk4(method) => method.step(scene, state, limit, &mut kept.near),
            Kind::Nystrom(method) => method.step(scene, state, limit, &mut kept.near),
            Kind::Flight(method) => method.step(scene, state, limit, &mut kept.near),
            Kind::EnergyMomentum(method) => method.step(scene, state, limit, &mut kept.implicit),
            Kind::BogackiShampine32(method) => method.step(scene, state, limit, &mut kept.pair),
            Kind::DormandPrince54(method) => method.step(scene, state, limit, &mut kept.pair),
            Kind::Radau5(method) => method.step(scene, state, limit, &mut kept.pair),
            Kind::AdaptiveEnergyMomentum(method) => {
                method.step(scene, state, limit, &mut kept.adaptive)
            }
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

    fn step_control(&self, kept: &Kept, state: &State) -> Option<StepControl> {
        match &self.kind {
            Kind::BogackiShampine32(method) => method.step_control(&kept.pair, state),
            Kind::DormandPrince54(method) => method.step_control(&kept.pair, state),
            Kind::Radau5(method) => method.step_control(&kept.pair, state),
            Kind::AdaptiveEnergyMomentum(method) => method.step_control(&kept.adaptive, state),
            _ => None,
        }
    }

    fn set_step_control(&self, kept: &mut Kept, control: StepControl) {
        match &self.kind {
            Kind::BogackiShampine32(method) => method.set_step_control(&mut kept.pair, control),
            Kind::DormandPrince54(method) => method.set_step_control(&mut kept.pair, control),
            Kind::Radau5(method) => method.set_step_control(&mut kept.pair, control),
            Kind::AdaptiveEnergyMomentum(method) => {
                method.set_step_control(&mut kept.adaptive, control);
            }
            _ => {}
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        each!(self, method => method.check())
    }
}
