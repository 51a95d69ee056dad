//! A real coin on a table: a disc of steel, 20 mm by 2 mm, with 24 points on each rim.

use tumble::{
    ContactPoint, Coulomb, DormandPrince54, FlatGround, Flight, SceneError, SolidCoin, Stepper,
    UniformGravity,
};

/// kg, m, m.
const MASS: f64 = 0.0049;
pub const RADIUS: f64 = 0.01;
const THICKNESS: f64 = 0.002;
/// m/s².
pub const GRAVITY: f64 = 9.81;
/// Bound on the error of a step, m.
pub const TOLERANCE: f64 = 1e-5;
/// s. A toss that lasts longer is undecided.
pub const PATIENCE: f64 = 10.0;

pub type Coin = SolidCoin<f64, [ContactPoint; 48]>;
pub type Method = Flight<DormandPrince54>;
pub type Table = Stepper<Coin, FlatGround, Coulomb, UniformGravity, Method>;

/// The coin over a table. A point that supports the weight penetrates by 0.02 mm and bounces at
/// half of its speed.
pub fn table(tolerance: f64) -> Result<Table, SceneError> {
    let points = [ContactPoint::default(); 48];
    Stepper::new(Coin::new_with_storage(points, MASS, RADIUS, THICKNESS))?
        .with_gravity(UniformGravity::down(GRAVITY))?
        .with_ground(FlatGround::level(2400.0, 1.4))?
        .with_friction(Coulomb {
            coefficient: 0.3,
            slip_speed: 1e-2,
        })?
        .with_integrator(Flight(DormandPrince54::new(tolerance)))
}
