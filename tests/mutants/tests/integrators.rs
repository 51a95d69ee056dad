//! Integrators where the answer is known, and steps that repeat or stop.

#[path = "../../common/mod.rs"]
mod common;
#[path = "../../kit/mod.rs"]
mod kit;

#[path = "../../physics/energy_momentum.rs"]
mod energy_momentum;
#[path = "../../physics/growth.rs"]
mod growth;
#[path = "../../physics/many_contacts.rs"]
mod many_contacts;
#[path = "../../physics/radau.rs"]
mod radau;
#[path = "../../physics/until_rest.rs"]
mod until_rest;
#[path = "../../physics/work_precision.rs"]
mod work_precision;
