//! What the energy limiter leaves as it is.

#[path = "../../physics/limiter.rs"]
mod limiter;
