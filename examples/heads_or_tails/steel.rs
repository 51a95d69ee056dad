//! A real coin on a table: a disc of steel, 20 mm by 2 mm, with 24 points on each rim.

use tumble::glam::{DQuat, DVec3};
use tumble::{
    ContactPoint, Coulomb, DormandPrince54, FlatGround, Flight, RigidPointBody, SceneError,
    SolidCoin, State, Stepper, UniformGravity,
};

/// kg, m, m.
const MASS: f64 = 0.0049;
const RADIUS: f64 = 0.01;
const THICKNESS: f64 = 0.002;
/// m/s².
pub(crate) const GRAVITY: f64 = 9.81;
/// Height of the hand over the table, m.
pub(crate) const HAND: f64 = 0.2;
/// Bound on the error of a step, m.
pub(crate) const TOLERANCE: f64 = 1e-5;
/// s. A toss that lasts longer is undecided.
pub(crate) const PATIENCE: f64 = 10.0;

type Coin = SolidCoin<f64, [ContactPoint; 48]>;
pub(crate) type Table = Stepper<Coin, FlatGround, Coulomb, UniformGravity, Flight<DormandPrince54>>;

/// The coin over a table. A point that supports the weight penetrates by 0.02 mm and bounces at
/// half of its speed.
pub(crate) fn table(tolerance: f64) -> Result<Table, SceneError> {
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

/// Leaves the hand level and heads up, with a vertical speed (m/s). The angular momentum is at the
/// angle `psi` (rad) from the normal, and the normal goes round it at `rate` (rad/s).
pub(crate) fn toss<B: RigidPointBody>(body: &B, speed: f64, psi: f64, rate: f64) -> State {
    let diameter = body.inertia().y_axis.y;
    State::at(DVec3::Z * HAND)
        .with_linear_velocity(DVec3::Z * speed)
        .with_orientation(DQuat::from_rotation_y(-core::f64::consts::FRAC_PI_2))
        .with_angular_momentum(DVec3::new(psi.sin(), 0.0, psi.cos()) * (diameter * rate))
}

/// Whether heads points up.
pub(crate) fn is_heads_up(state: &State) -> bool {
    (state.orientation * DVec3::X).z > 0.0
}
