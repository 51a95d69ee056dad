//! Closed forms, conserved quantities and orders: one subject or more for each folder of `src`.

#[path = "../../common/mod.rs"]
mod common;
#[path = "../../kit/mod.rs"]
mod kit;

#[path = "../../physics/adaptive_nystrom.rs"]
mod adaptive_nystrom;
#[path = "../../parts/bodies.rs"]
mod bodies;
#[path = "../../physics/free_rotation.rs"]
mod free_rotation;
#[path = "../../parts/friction_laws.rs"]
mod friction_laws;
#[path = "../../parts/ground_laws.rs"]
mod ground_laws;
#[path = "../../physics/lowest_point.rs"]
mod lowest_point;
#[path = "../../parts/rest_on_shapes.rs"]
mod rest_on_shapes;
