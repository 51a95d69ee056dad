//! A ground whose shape implements nothing. The compiler says:
//!
//! > `Hill` is not the shape of a ground: it does not implement `Shape<
//! > this should be a shape
//! > implement `surface`; the precision

use tumble::{Coin, Ground, SpringDamper, Stepper};

struct Hill;

fn main() {
    let law = SpringDamper {
        stiffness: 1e3,
        damping: 0.5,
    };
    let _ = Stepper::new(Coin::ring(1.0, 0.5))
        .unwrap()
        .with_ground(Ground { law, shape: Hill });
}
