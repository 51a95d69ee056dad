//! Integrators of the page, chosen by number.

use tumble::{
    AdaptiveEnergyMomentum, AdaptiveNystrom, AnyIntegrator, BogackiShampine32, ContactRange,
    DormandPrince54, Dynamics, EnergyMomentum, Flight, ForwardEuler, Integrator, LinearMotion,
    Nystrom, Radau5, Rk4, SceneError, State, Step, StepControl, StepError, StrangSplitting,
    SymplecticEuler,
};

use super::error::PageError;

/// Integrator of the page. Its numbers are those of the page's list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Method {
    kind: Kind,
    /// Step size of the page, s. An adaptive integrator divides it as its tolerance demands.
    pub time_step: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// An integrator of the library by itself.
    Plain(AnyIntegrator),
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
    pub const COUNT: u32 = 12;

    /// Returns the method with a number of the page, for a step size of the page (s) and a body of
    /// a bounding radius (m).
    ///
    /// # Errors
    /// Returns [`PageError::Unknown`] if no method has the number.
    pub fn from_number(number: f64, time_step: f64, radius: f64) -> Result<Self, PageError> {
        let (tolerance, longest_step, budget) = (TOLERANCE * radius, time_step, BUDGET);
        let kind = match super::whole(number) {
            Some(0) => return Ok(Self::default_of(time_step)),
            Some(1) => Kind::Plain(StrangSplitting { time_step }.into()),
            Some(2) => Kind::Plain(SymplecticEuler { time_step }.into()),
            Some(3) => Kind::Plain(Rk4 { time_step }.into()),
            Some(4) => Kind::Plain(Nystrom { time_step }.into()),
            Some(5) => Kind::Plain(ForwardEuler { time_step }.into()),
            Some(6) => Kind::Plain(AnyIntegrator::from(AdaptiveEnergyMomentum {
                tolerance,
                longest_step,
                budget,
            })),
            Some(7) => Kind::Plain(AnyIntegrator::from(BogackiShampine32 {
                tolerance,
                longest_step,
                budget,
            })),
            Some(8) => Kind::Plain(AnyIntegrator::from(DormandPrince54 {
                tolerance,
                longest_step,
                budget,
            })),
            Some(9) => Kind::Flight(Flight(StrangSplitting { time_step })),
            Some(10) => Kind::Plain(AnyIntegrator::from(Radau5 {
                tolerance,
                longest_step,
                budget,
            })),
            Some(11) => Kind::Plain(AnyIntegrator::from(AdaptiveNystrom {
                tolerance,
                longest_step,
                budget,
            })),
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
            kind: Kind::Plain(EnergyMomentum { time_step }.into()),
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
            Kind::Plain($method) => $result,
            Kind::Flight($method) => $result,
        }
    };
}

type Kept = <AnyIntegrator as Integrator>::Workspace;

impl Integrator for Method {
    type Workspace = (Kept, ContactRange);

    const ADAPTIVE: bool = true;
    const SPANS_STEPS: bool = true;

    fn step<D: Dynamics>(
        &self,
        scene: &D,
        state: &mut State,
        limit: f64,
        (plain, flight): &mut Self::Workspace,
    ) -> Result<Step, StepError> {
        match &self.kind {
            Kind::Plain(method) => method.step(scene, state, limit, plain),
            Kind::Flight(method) => method.step(scene, state, limit, flight),
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

    fn linear_step(
        &self,
        motion: &LinearMotion,
        start: [[f64; 6]; 2],
        time_step: f64,
    ) -> Option<[[f64; 6]; 2]> {
        each!(self, method => method.linear_step(motion, start, time_step))
    }

    fn step_control(&self, (plain, _): &Self::Workspace, state: &State) -> Option<StepControl> {
        match &self.kind {
            Kind::Plain(method) => method.step_control(plain, state),
            Kind::Flight(_) => None,
        }
    }

    fn set_step_control(&self, (plain, _): &mut Self::Workspace, control: StepControl) {
        if let Kind::Plain(method) = &self.kind {
            method.set_step_control(plain, control);
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        each!(self, method => method.check())
    }
}
