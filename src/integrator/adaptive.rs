//! Adaptive methods, which choose their step from a tolerance: explicit Runge-Kutta pairs, a
//! Nystrom method, Radau's implicit method, and `EnergyMomentum` with step doubling.

mod bogacki_shampine_32;
mod bounce;
mod dormand_prince_54;
mod edge;
mod embedded_pair;
mod energy_momentum;
mod method;
mod nystrom;
mod radau_5;

pub use bogacki_shampine_32::BogackiShampine32;
pub use dormand_prince_54::DormandPrince54;
pub(crate) use dormand_prince_54::PAIR as DORMAND_PRINCE;
pub use embedded_pair::Workspace as EmbeddedPairWorkspace;
pub use energy_momentum::{AdaptiveEnergyMomentum, Workspace as AdaptiveEnergyMomentumWorkspace};
pub use nystrom::{AdaptiveNystrom, Workspace as AdaptiveNystromWorkspace};
pub use radau_5::Radau5;
