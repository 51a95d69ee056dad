//! Closed forms, conserved quantities and orders: one subject or more for each folder of `src`.

#[path = "../../common/mod.rs"]
mod common;
#[path = "../../kit/mod.rs"]
mod kit;

#[path = "../../physics/adaptive_nystrom.rs"]
mod adaptive_nystrom;
#[path = "../../physics/bodies.rs"]
mod bodies;
#[path = "../../physics/free_rotation.rs"]
mod free_rotation;
#[path = "../../physics/friction_laws.rs"]
mod friction_laws;
#[path = "../../physics/ground_laws.rs"]
mod ground_laws;
#[path = "../../physics/lowest_point.rs"]
mod lowest_point;
#[path = "../../physics/rest_on_shapes.rs"]
mod rest_on_shapes;
