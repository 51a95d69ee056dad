//! A body without contacts. The compiler says:
//!
//! > not all trait items implemented, missing: `contacts`

use tumble::RigidPointBody;
use tumble::glam::DMat3;

struct Pebble;

impl RigidPointBody for Pebble {
    fn mass(&self) -> f64 {
        0.1
    }
    fn inertia(&self) -> DMat3 {
        DMat3::IDENTITY
    }
}

fn main() {}
