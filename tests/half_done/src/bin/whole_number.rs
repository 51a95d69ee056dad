//! A whole number where a mass should be. The compiler says:
//!
//! > `{integer}` is not a number type of this crate: use `f64` or `f32`
//! > write `1.0` for `1`

use tumble::{Sphere, Stepper};

fn main() {
    let _ = Stepper::new(Sphere::solid(1, 1));
}
