//! Contact mechanics: the contacts of a body that touch a ground, and their force and torque.
//!
//! [`ContactModel`] holds the three parts that contact depends on: body, ground and friction law.
//! Whether a body consists of points, is smooth or has circular rims, and whether the ground is a
//! level plane, is decided here. `kind.rs` has what other modules ask about it.

mod invariants;
mod kind;
mod lanes;
mod level;
mod load;
mod lowest_point;
mod model;
mod moving;
mod point;
mod range;
mod rims;
mod spring_energy;
mod total_load;
mod visit;

pub use crate::state::Motion;
pub use lanes::LoopOverLanes;
pub(crate) use lanes::{AddRow, AxesInLanes, LANES, Loads, Motions, Numbers, Ranges, Vectors};
pub use load::Load;
pub use lowest_point::LowestPoint;
pub use model::ContactModel;
pub(crate) use model::Extent;
pub(crate) use moving::{MovingContact, any_across};
pub use point::Contact;
pub(crate) use rims::RimStep;
pub(crate) use visit::Onset;
