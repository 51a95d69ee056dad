//! What a run shows: samples, events and the energy audit.

#[path = "../../common/mod.rs"]
mod common;
#[path = "../../kit/mod.rs"]
mod kit;

#[path = "../../physics/audit.rs"]
mod audit;
#[path = "../../physics/events.rs"]
mod events;
#[path = "../../physics/force_stability.rs"]
mod force_stability;
#[path = "../../physics/growth.rs"]
mod growth;
#[path = "../../physics/stable_step.rs"]
mod stable_step;
#[path = "../../physics/time.rs"]
mod time;
