//! Throws a coin, and prints the side that is up when it has come to rest.

use tumble::glam::DVec3;
use tumble::{Coin, Coulomb, FlatGround, State, Stepper, UniformGravity, UntilRest};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let coulomb = Coulomb {
        coefficient: 0.3,
        slip_speed: 1e-3, // m/s
    };
    let stepper = Stepper::builder(Coin::ring(0.006, 0.012)) // kg, m
        .gravity(UniformGravity::down(9.81)) // m/s²
        .ground(FlatGround::level(20.0, 0.01)) // N/m and N s/m, for each of the 120 points
        .friction(coulomb)
        .build()?;
    let start = State::at(DVec3::Z * 0.2); // m
    let mut state = stepper.with_angular_velocity(start, DVec3::new(3.0, 40.0, 0.0)); // rad/s
    let mut rest = UntilRest::new(stepper.body(), 1e-4, 0.25)?; // m, s
    stepper.run(&mut state, 60.0, &mut rest)?; // at most 60 s
    println!("{:?} up", stepper.body().face_up(&state));
    Ok(())
}
