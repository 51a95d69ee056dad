//! A crate as somebody else writes it: his own body, ground, friction, force and integrator for
//! `tumble`, through its public traits alone.
//!
//! Its tests show that they are first-class citizens: they work in the same stepper with everything
//! that is built in, by value, by reference and behind `dyn`, in both precisions, with the bits
//! that a built-in of the same law has, and without an allocation.

mod ball;
mod carpet;
mod midpoint;
mod motor;
mod sail;
mod turf;
mod turning;
mod viscous;

pub use ball::Ball;
pub use carpet::Carpet;
pub use midpoint::Midpoint;
pub use motor::Motor;
pub use sail::Sail;
pub use turf::Turf;
pub use turning::Turning;
pub use viscous::Viscous;
