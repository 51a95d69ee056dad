//! Thick coins that are tossed, caught at the height of the start, and put down without a bounce.

use core::f64::consts::{FRAC_PI_2, TAU};

use tumble::ensemble::{Ensemble, EnsembleError, SceneHash, Toss, TossError};
use tumble::glam::{DQuat, DVec3};
use tumble::{
    CoinFace, Coulomb, EnergyMomentum, FlatGround, Flight, Outcome as Ended, SceneError, SolidCoin,
    State, Stepper, UniformGravity,
};

use common::Outcome;

/// kg, m, m/s².
const MASS: f64 = 0.005;
const RADIUS: f64 = 0.01;
const GRAVITY: f64 = 9.81;
/// Time of the flight, s.
const TIME: f64 = 0.4;
/// Rates of the spin, rad/s: the phase at the catch is spread over ten whole revolutions.
const RATES: [f64; 2] = [100.0, 100.0 + 10.0 * TAU / TIME];
/// Time after which a coin that was put down is undecided, s.
const PATIENCE: f64 = 2.0;

/// Distribution of the axis of the spin, which is a diameter of the coin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Axis {
    Isotropic,
    Horizontal,
}

impl Axis {
    /// Fraction on edge of a coin whose thickness is `ratio` diameters (Yong & Mahadevan).
    pub(crate) fn formula(self, ratio: f64) -> f64 {
        match self {
            // The normal is uniform over the sphere.
            Self::Isotropic => ratio / ratio.hypot(1.0),
            // The normal is uniform over a vertical great circle.
            Self::Horizontal => ratio.atan() / FRAC_PI_2,
        }
    }

    fn draw(self, toss: &mut Toss<'_>) -> DVec3 {
        let (z, angle) = (toss.uniform(-1.0..=1.0), toss.uniform(0.0..=TAU));
        let z = if self == Self::Isotropic { z } else { 0.0 };
        let level = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(level * angle.cos(), level * angle.sin(), z)
    }
}

type Table = Stepper<SolidCoin, FlatGround, Coulomb, UniformGravity, Flight<EnergyMomentum>>;

/// A table on which a point does not bounce: its damping ratio is 3.
fn table(ratio: f64) -> Result<Table, SceneError> {
    let stiffness = 1e5_f64;
    let damping = 6.0 * (stiffness * MASS).sqrt();
    Stepper::builder(SolidCoin::new(MASS, RADIUS, 2.0 * RADIUS * ratio))
        .gravity(UniformGravity::down(GRAVITY))
        .ground(FlatGround::level(stiffness, damping))
        .friction(Coulomb {
            coefficient: 0.3,
            slip_speed: 1e-3,
        })
        .integrator(Flight(EnergyMomentum { time_step: 1e-3 }))
        .build()
}

/// Number of coins on edge, and of those that are not decided.
pub(crate) fn on_edge(ratio: f64, axis: Axis, tosses: u64) -> Outcome<[u64; 2]> {
    let table = table(ratio)?;
    let barriers = table.barriers().ok_or(EnsembleError::NoBarriers)?;
    let ensemble = Ensemble::new(8, SceneHash::of_debug(&(axis, ratio)));
    let tally = ensemble.run(0..tosses, |toss| {
        let mut state = put_down(&table, caught(&table, axis, toss)?);
        let mut decided = tumble::UntilDecided::new(barriers);
        table.run(&mut state, PATIENCE, &mut decided)?;
        Ok(match decided.outcome() {
            Ended::Decided(face) => Ended::Decided(face == CoinFace::Edge),
            Ended::Undecided => Ended::Undecided,
        })
    })?;
    let decided = tally.count(&true) + tally.count(&false);
    Ok([tally.count(&true), tally.tosses() - decided])
}

/// Orientation at the catch. At the start the normal points as far upwards as the axis allows.
fn caught(table: &Table, axis: Axis, toss: &mut Toss<'_>) -> Result<DQuat, TossError> {
    let axis = axis.draw(toss);
    let rate = toss.uniform(RATES[0]..=RATES[1]);
    let normal = (DVec3::Z - axis * axis.z).try_normalize();
    let normal = normal.unwrap_or(DVec3::X);
    // Far above the table.
    let start = State::at(DVec3::Z * 1e3)
        .with_orientation(DQuat::from_rotation_arc(DVec3::X, normal))
        .with_linear_velocity(DVec3::Z * (0.5 * GRAVITY * TIME));
    let mut state = table.with_angular_velocity(start, axis * rate);
    table.advance(&mut state, TIME)?;
    Ok(state.orientation)
}

/// The coin at rest, just above the table.
fn put_down(table: &Table, orientation: DQuat) -> State {
    let mut state = State::at(DVec3::Z).with_orientation(orientation);
    if let Some(lowest) = table.lowest_point(&state) {
        state.position.z -= lowest.gap;
    }
    state
}
