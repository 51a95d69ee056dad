//! Contact mechanics: the contacts of a body that touch a ground, and their force and torque.
//!
//! [`ContactModel`] holds the three parts that contact depends on: body, ground and friction law.
//! Whether a body consists of points, is smooth or has circular rims, and whether the ground is a
//! level plane, is decided here.

mod invariants;
mod lanes;
mod level;
mod load;
mod lowest_point;
mod model;
mod point;
mod range;
mod rims;
mod spring_energy;
mod total_load;
mod visit;

pub use crate::state::Motion;
pub(crate) use lanes::{AxesInLanes, LANES, Loads, Motions, Numbers, Ranges, Vectors};
pub use load::Load;
pub use lowest_point::LowestPoint;
pub use model::ContactModel;
pub use point::Contact;
pub(crate) use point::facing_ground;
pub(crate) use rims::{Discontinuities, Velocities, arcs_below, discontinuities};
