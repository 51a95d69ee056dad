//! An integrator that implements nothing. The compiler says:
//!
//! > `Magic` is not an integrator: it does not implement `Integrator<
//! > this should be an integrator
//! > implement `step`, `order` and `check`; the precision

use tumble::{Coin, Stepper};

struct Magic;

fn main() {
    let _ = Stepper::new(Coin::ring(1.0, 0.5))
        .unwrap()
        .with_integrator(Magic);
}
