//! The sweep of the extremes, which the energy limiter has to pass.

#[path = "../../kit/mod.rs"]
mod kit;

#[path = "../../limits/driven.rs"]
mod driven;
#[path = "../../limits/extremes.rs"]
mod extremes;
#[path = "../../limits/long.rs"]
mod long;
