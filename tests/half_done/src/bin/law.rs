//! A ground whose law implements nothing. The compiler says:
//!
//! > `Sand` is not a contact law: it does not implement `ContactLaw<
//! > this should be a contact law
//! > implement `spring_force`, `spring_energy` and `normal_force`; the precision

use tumble::{Coin, Ground, Stepper};

struct Sand;

fn main() {
    let _ = Stepper::new(Coin::ring(1.0, 0.5))
        .unwrap()
        .with_ground(Ground::level(Sand));
}
