//! A gravity field that implements nothing. The compiler says:
//!
//! > ` is not a gravity field: it does not implement `Gravity<
//! > this should be a gravity field
//! > use `UniformGravity::down(9.8)`, or implement `acceleration`; the precision

use tumble::{Coin, Stepper};

fn main() {
    let _ = Stepper::new(Coin::ring(1.0, 0.5))
        .unwrap()
        .with_gravity(9.8);
}
