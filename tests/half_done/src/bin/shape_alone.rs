//! A shape where a ground should be. The compiler says:
//!
//! > `tumble::Plane<
//! > is not a ground: it does not implement `SpringDamperGround<
//! > a `Shape`, such as `Plane` or `Terrain`, becomes a ground with a law: `Ground { law: SpringDamper { stiffness, damping }, shape }`

use tumble::{Plane, Sphere, Stepper};

fn main() {
    let _ = Stepper::new(Sphere::solid(1.0, 0.5))
        .unwrap()
        .with_ground(Plane::level(0.0));
}
