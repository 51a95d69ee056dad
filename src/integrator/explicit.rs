//! Explicit methods with a fixed step.

mod forward_euler;
mod nystrom;
mod rk4;
mod strang_splitting;
mod symplectic_euler;

pub use forward_euler::ForwardEuler;
pub use nystrom::Nystrom;
pub(in crate::integrator) use nystrom::{Purpose, Stage, Start, Taken, taken};
pub use rk4::Rk4;
pub use strang_splitting::StrangSplitting;
pub use symplectic_euler::SymplecticEuler;
