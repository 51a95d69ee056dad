//! A friction law that implements nothing. The compiler says:
//!
//! > `Honey` is not a friction law: it does not implement `SlidingFriction<
//! > this should be a friction law
//! > implement `force`; the precision

use tumble::{Coin, Stepper};

struct Honey;

fn main() {
    let _ = Stepper::new(Coin::ring(1.0, 0.5))
        .unwrap()
        .with_friction(Honey);
}
