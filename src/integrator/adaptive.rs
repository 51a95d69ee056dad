//! Adaptive methods: explicit Runge-Kutta pairs that choose their step from a tolerance.

mod bogacki_shampine_32;
mod dormand_prince_54;
mod embedded_pair;
mod method;

pub use bogacki_shampine_32::BogackiShampine32;
pub use dormand_prince_54::DormandPrince54;
pub(crate) use dormand_prince_54::PAIR as DORMAND_PRINCE;
pub use embedded_pair::Workspace as EmbeddedPairWorkspace;
