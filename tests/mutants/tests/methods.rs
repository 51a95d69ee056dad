//! The other integrators, many states at once, and bodies with round edges.

#[path = "../../common/mod.rs"]
mod common;
#[path = "../../kit/mod.rs"]
mod kit;

#[path = "../../physics/adaptive.rs"]
mod adaptive;
#[path = "../../physics/adaptive_energy_momentum.rs"]
mod adaptive_energy_momentum;
#[path = "../../physics/flight.rs"]
mod flight;
#[path = "../../physics/many_states.rs"]
mod many_states;
#[path = "../../parts/rim.rs"]
mod rim;
#[path = "../../physics/step_at_rest.rs"]
mod step_at_rest;
