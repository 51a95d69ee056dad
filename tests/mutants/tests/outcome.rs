//! The certificate: `src/outcome`.

#[path = "../../common/mod.rs"]
mod common;
#[path = "../../kit/mod.rs"]
mod kit;

#[path = "../../physics/outcome.rs"]
mod outcome;
