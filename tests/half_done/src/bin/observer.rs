//! An observer that implements nothing. The compiler says:
//!
//! > `Camera` is not an observer: it does not implement `Observer<
//! > this should be an observer
//! > implement `observe`, or write a closure

use tumble::{Coin, State, Stepper};

struct Camera;

fn main() {
    let stepper = Stepper::new(Coin::ring(1.0, 0.5)).unwrap();
    let _ = stepper.run(&mut State::default(), 1.0, &mut Camera);
}
