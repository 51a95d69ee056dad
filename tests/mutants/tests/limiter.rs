//! What the energy limiter leaves as it is, and slow bodies that it may not stop.

#[path = "../../kit/mod.rs"]
mod kit;
#[path = "../../physics/limiter.rs"]
mod limiter;
#[path = "../../physics/turning_points.rs"]
mod turning_points;
