//! What each part adds to a scene: bodies, round rims, grounds, contact and friction laws, applied
//! forces. Closed forms, conserved quantities and scenes that must be equal. `tests/physics` has
//! the methods, their energy and their accuracy.
//!
//! A file holds one subject. `cargo test --test parts rim::` runs those of `rim.rs`.

#[path = "../common/mod.rs"]
mod common;
#[path = "../kit/mod.rs"]
mod kit;

// The body.
mod bodies;
mod hulls;
mod rim;
mod smooth;
mod thick_disc;

// The ground under it.
mod ground_laws;
mod moving_ground;
mod rest_on_shapes;
mod rim_on_shapes;
mod several_surfaces;
mod terrain;

// Friction and applied forces.
mod applied_forces;
mod friction_laws;
mod turning_resistance;
mod varying_friction;
