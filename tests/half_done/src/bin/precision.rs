//! A ground in one precision under a body in the other. The compiler says:
//!
//! > is not a ground: it does not implement `SpringDamperGround<f32>`
//! > the precision `f32` of body, ground, friction and gravity must be the same

use tumble::{Coin, FlatGround, Stepper};

fn main() {
    let coin = Coin::<f32>::ring(1.0, 0.5);
    let _ = Stepper::new(coin)
        .unwrap()
        .with_ground(FlatGround::<f64>::level(1e3, 0.5));
}
