//! Integrators: methods that advance a state in time, one file for each method.

mod adaptive;
mod any;
mod contact_path;
mod energy_limit;
mod energy_momentum;
mod explicit;
mod flight;
mod flight_rounding;
mod free_error;
mod interface;
mod lanes;
mod linear;
mod matrix3;
mod point;
#[cfg(feature = "serde")]
pub(crate) mod saved;

pub(crate) use adaptive::DORMAND_PRINCE;
pub(crate) use lanes::Lanes;
pub(crate) use point::Point;

pub use adaptive::{
    AdaptiveEnergyMomentum, AdaptiveEnergyMomentumWorkspace, AdaptiveNystrom,
    AdaptiveNystromWorkspace, BogackiShampine32, DormandPrince54, EmbeddedPairWorkspace, Radau5,
};
pub use any::{AnyIntegrator, Workspace as AnyWorkspace};
pub use energy_momentum::{
    CompactEnergyMomentum, EnergyMomentum, Workspace as EnergyMomentumWorkspace,
};
pub use explicit::{ForwardEuler, Nystrom, Rk4, StrangSplitting, SymplecticEuler};
pub use flight::Flight;
pub use interface::{Integrator, Step, StepControl, step_length};
