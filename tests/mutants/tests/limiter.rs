//! What the energy limiter leaves as it is.

#[path = "../../kit/mod.rs"]
mod kit;
#[path = "../../physics/limiter.rs"]
mod limiter;
