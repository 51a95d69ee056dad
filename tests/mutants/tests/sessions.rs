//! Sessions, symmetries of a scene, and stable steps.

#[path = "../../common/mod.rs"]
mod common;
#[path = "../../kit/mod.rs"]
mod kit;

#[path = "../../physics/symmetry.rs"]
mod symmetry;
