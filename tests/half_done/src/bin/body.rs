//! A body that implements nothing. The compiler says:
//!
//! > `Pebble` is not a body: it does not implement `RigidPointBody<
//! > this should be a body
//! > implement `mass`, `inertia` and `contacts`; the precision

use tumble::Stepper;

struct Pebble;

fn main() {
    let _ = Stepper::new(Pebble);
}
