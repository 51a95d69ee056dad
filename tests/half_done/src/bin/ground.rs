//! A ground that implements nothing. The compiler says:
//!
//! > `Sand` is not a ground: it does not implement `SpringDamperGround<
//! > this should be a ground
//! > implement `surface`, `spring_force`, `spring_energy` and `normal_force`; the precision

use tumble::{Coin, Stepper};

struct Sand;

fn main() {
    let _ = Stepper::new(Coin::ring(1.0, 0.5))
        .unwrap()
        .with_ground(Sand);
}
