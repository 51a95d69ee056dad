//! The coin, the table and the start.

use tumble::ensemble::{Ensemble, EnsembleError, RandomSpin, RandomStart, Throw};
use tumble::{
    ContactPoint, Coulomb, DormandPrince54, FlatGround, Flight, SceneError, SolidCoin, Stepper,
    UniformGravity,
};

/// A disc of steel, 20 mm by 2 mm: kg, m, m.
const MASS: f64 = 0.0049;
pub(crate) const RADIUS: f64 = 0.01;
const THICKNESS: f64 = 0.002;
/// Bound on the error of a step, m.
pub(crate) const TOLERANCE: f64 = 1e-5;
/// A toss that lasts longer is undecided, s.
const PATIENCE: f64 = 10.0;

type Coin = SolidCoin<f64, [ContactPoint; 48]>;
pub(crate) type Table = Stepper<Coin, FlatGround, Coulomb, UniformGravity, Flight<DormandPrince54>>;
pub(crate) type CoinThrow<'a> =
    Throw<'a, Coin, FlatGround, Coulomb, UniformGravity, Flight<DormandPrince54>, RandomStart>;

pub(crate) fn table(tolerance: f64) -> Result<Table, SceneError> {
    let points = [ContactPoint::default(); 48];
    Stepper::new(Coin::new_with_storage(points, MASS, RADIUS, THICKNESS))?
        .with_gravity(UniformGravity::down(9.81))?
        // A point that supports the whole weight penetrates by 0.02 mm and bounces at half of its
        // speed.
        .with_ground(FlatGround::level(2400.0, 1.4))?
        .with_friction(Coulomb {
            coefficient: 0.3,
            slip_speed: 1e-2,
        })?
        .with_integrator(Flight(DormandPrince54::new(tolerance)))
}

/// Dropped from 0.3 m at any orientation, with a spin about any axis.
pub(crate) fn throw(table: &Table) -> Result<CoinThrow<'_>, EnsembleError> {
    let rate = (50.0..=70.0).into();
    let start = RandomStart::at_height(0.3).with_spin(RandomSpin::Isotropic { rate });
    Throw::new(table, start, PATIENCE)
}

pub(crate) fn ensemble(throw: &CoinThrow<'_>, seed: u64) -> Ensemble {
    Ensemble::new(seed, throw.scene_hash())
}
