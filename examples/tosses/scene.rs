//! The start over the table of `common::steel_coin`.

use common::steel_coin::{Coin, Method, PATIENCE};
use tumble::ensemble::{Ensemble, EnsembleError, RandomSpin, RandomStart, Throw};
use tumble::{Coulomb, FlatGround, UniformGravity};

pub(crate) use common::steel_coin::{RADIUS, TOLERANCE, Table, table};

pub(crate) type CoinThrow<'a> =
    Throw<'a, Coin, FlatGround, Coulomb, UniformGravity, Method, RandomStart>;

/// Dropped from 0.3 m at any orientation, with a spin about any axis.
pub(crate) fn throw(table: &Table) -> Result<CoinThrow<'_>, EnsembleError> {
    let rate = (50.0..=70.0).into();
    let start = RandomStart::at_height(0.3).with_spin(RandomSpin::Isotropic { rate });
    Throw::new(table, start, PATIENCE)
}

pub(crate) fn ensemble(throw: &CoinThrow<'_>, seed: u64) -> Ensemble {
    Ensemble::new(seed, throw.scene_hash())
}
