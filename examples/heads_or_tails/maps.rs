//! Maps of outcomes over two parameters of the start, with a throw in each cell.
//!
//! A coin that leaves the hand level, with the vertical speed u and the rate ω about a diameter, is
//! caught at the same height after `2 u/g`. By then it has rotated by `2 u ω/g`. So heads is up if
//! `cos(2 u ω/g) > 0`, and the boundaries are the hyperbolas `u ω/g = (2 n + 1) π/4` (Keller, Am.
//! Math. Monthly 93, 1986).

use core::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use indicatif::ProgressBar;
use rayon::prelude::*;
use tumble::ensemble::{Ensemble, SceneHash, TossError};
use tumble::glam::DQuat;
use tumble::{
    CoinFace, Nystrom, Outcome as Ended, SceneError, Start, State, Stepper, Trial, UniformGravity,
    UntilDecided,
};

use crate::steel;
use common::Outcome;

/// Cells of a map, and the range of its axes.
#[derive(Debug)]
pub(crate) struct Map {
    /// Cells along each axis.
    pub(crate) size: usize,
    pub(crate) x: [f64; 2],
    pub(crate) y: [f64; 2],
    /// Row after row, that of the lowest y first.
    pub(crate) cells: Vec<Ended<CoinFace>>,
}

/// Vertical speeds, m/s, and rates of rotation about a diameter, rad/s, of a toss by hand.
const SPEEDS: [f64; 2] = [0.0, 3.0];
const RATES: [f64; 2] = [0.0, 120.0];
/// Leans from upright, degrees, and angular momenta, kg m²/s, of the coin of the coin report.
const LEANS: [f64; 2] = [0.0, 60.0];
const SPINS: [f64; 2] = [0.0, 3.0];
/// s. A throw of the report's coin that lasts longer is undecided.
pub(crate) const REPORT_PATIENCE: f64 = 20.0;
/// s. With a shorter step of 2 ms as many labels agree with those of 0.5 ms: the motion is chaotic.
pub(crate) const REPORT_STEP: f64 = 5e-3;

impl Map {
    /// Plays a throw at the middle of each cell. All threads share the cells.
    fn play<F>(size: usize, [x, y]: [[f64; 2]; 2], bar: &ProgressBar, throw: F) -> Outcome<Self>
    where
        F: Fn(f64, f64) -> Result<Ended<CoinFace>, TossError> + Sync,
    {
        let mut map = Self {
            size,
            x,
            y,
            cells: Vec::new(),
        };
        let cells = (0..size * size).into_par_iter().map(|cell| {
            let (x, y) = map.middle(cell);
            let face = throw(x, y);
            bar.inc(1);
            face
        });
        map.cells = cells.collect::<Result<Vec<_>, _>>()?;
        Ok(map)
    }

    fn middle(&self, cell: usize) -> (f64, f64) {
        let of = |[least, most]: [f64; 2], place: usize| {
            least + (most - least) * (place as f64 + 0.5) / self.size as f64
        };
        (of(self.x, cell % self.size), of(self.y, cell / self.size))
    }

    /// Starts of the cells, in their order.
    pub(crate) fn middles(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        (0..self.cells.len()).map(|cell| self.middle(cell))
    }

    /// Number of cells with an outcome.
    pub(crate) fn count(&self, outcome: Ended<CoinFace>) -> usize {
        self.cells.iter().filter(|cell| **cell == outcome).count()
    }
}

/// A coin that is caught at the height at which it was thrown.
pub(crate) fn caught(size: usize, bar: &ProgressBar) -> Outcome<Map> {
    let stepper = in_the_air()?;
    Map::play(size, [SPEEDS, RATES], bar, |speed, rate| {
        let end = fly(&stepper, speed, rate)?;
        Ok(Ended::Decided(stepper.body().face_up(&end)))
    })
}

type Air = Stepper<
    tumble::Disc,
    tumble::NoGround,
    tumble::Frictionless,
    UniformGravity,
    tumble::EnergyMomentum,
>;

fn in_the_air() -> Result<Air, SceneError> {
    Stepper::builder(tumble::Disc::solid(0.0049, 0.01, 48))
        .gravity(UniformGravity::down(steel::GRAVITY))
        .integrator(tumble::EnergyMomentum { time_step: 0.01 })
        .build()
}

fn fly(stepper: &Air, speed: f64, rate: f64) -> Result<State, TossError> {
    let mut state = steel::toss(stepper.body(), speed, FRAC_PI_2, rate);
    stepper.advance(&mut state, 2.0 * speed / steel::GRAVITY)?;
    Ok(state)
}

/// Whether heads is up at the catch, in closed form.
pub(crate) fn is_caught_heads(speed: f64, rate: f64) -> bool {
    (2.0 * speed * rate / steel::GRAVITY).cos() > 0.0
}

/// Rate (rad/s) at the n-th boundary between heads and tails of the caught coin, in closed form.
pub(crate) fn boundary(speed: f64, n: u32) -> f64 {
    (2.0 * f64::from(n) + 1.0) * FRAC_PI_4 * steel::GRAVITY / speed
}

/// Largest relative distance of the simulated boundaries from those of the closed form. Each is
/// bisected between the middles of its two strips.
pub(crate) fn boundary_error() -> Outcome<f64> {
    let stepper = in_the_air()?;
    let mut largest = 0.0_f64;
    for speed in [0.8, 1.7, 2.9] {
        for n in 0..8 {
            let (exact, strip) = (boundary(speed, n), 2.0 * boundary(speed, 0));
            let [mut low, mut high] = [exact - 0.5 * strip, exact + 0.5 * strip];
            let is_heads =
                |rate| Ok::<_, TossError>(steel::is_heads_up(&fly(&stepper, speed, rate)?));
            let before = is_heads(low)?;
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                *(if is_heads(middle)? == before {
                    &mut low
                } else {
                    &mut high
                }) = middle;
            }
            largest = largest.max((low / exact - 1.0).abs());
        }
    }
    Ok(largest)
}

/// The same tosses with a table 0.2 m below the hand, on which the coin bounces.
pub(crate) fn bounced(size: usize, bar: &ProgressBar) -> Outcome<Map> {
    let stepper = steel::table(steel::TOLERANCE)?;
    Map::play(size, [SPEEDS, RATES], bar, |speed, rate| {
        land(&stepper, speed, rate)
    })
}

fn land(stepper: &steel::Table, speed: f64, rate: f64) -> Result<Ended<CoinFace>, TossError> {
    let barriers = (stepper.barriers())
        .ok_or_else(|| TossError::new("no barriers", "the ground must be level"))?;
    let mut state = steel::toss(stepper.body(), speed, FRAC_PI_2, rate);
    let mut decided = UntilDecided::new(barriers);
    stepper.run(&mut state, steel::PATIENCE, &mut decided)?;
    Ok(decided.outcome())
}

/// Tosses at random points of the map that are repeated with a hundredth of the tolerance.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Repeated {
    pub(crate) tosses: u64,
    /// Tosses of which one is heads and the other is not.
    pub(crate) changed: u64,
    /// Heads that became another outcome, less those that became heads.
    pub(crate) fewer: f64,
}

pub(crate) fn repeat(tosses: u64, bar: &ProgressBar) -> Outcome<Repeated> {
    let coarse = steel::table(steel::TOLERANCE)?;
    let fine = steel::table(0.01 * steel::TOLERANCE)?;
    let play = |stepper: &steel::Table, toss: &mut tumble::ensemble::Toss<'_>| {
        let speed = toss.uniform(SPEEDS[0]..=SPEEDS[1]);
        let rate = toss.uniform(RATES[0]..=RATES[1]);
        bar.inc(1);
        land(stepper, speed, rate)
    };
    let ensemble = Ensemble::new(2, SceneHash::of_bytes(b"map"));
    let pairs = ensemble.compare(
        0..tosses,
        |toss| play(&coarse, toss),
        |toss| play(&fine, toss),
    )?;
    crate::spun::check(&pairs)?;
    let mut repeated = Repeated {
        tosses,
        ..Repeated::default()
    };
    for (pair, count) in pairs.decided() {
        let is_heads = |face| face == Ended::Decided(CoinFace::Heads);
        let change = f64::from(is_heads(pair.coarse)) - f64::from(is_heads(pair.fine));
        if change != 0.0 {
            repeated.changed += count.count();
            repeated.fewer += change * count.count() as f64;
        }
    }
    Ok(repeated)
}

/// The coin of the coin report, set spinning at each lean (degrees) with each angular momentum.
pub(crate) fn report(size: usize, bar: &ProgressBar) -> Outcome<Map> {
    Map::play(size, [LEANS, SPINS], bar, |lean, angular_momentum| {
        let trial = Trial {
            start: Start::Spinning,
            // Heads points up, if the tilt is negative.
            tilt: -lean.to_radians(),
            angular_momentum,
            coefficient: 0.3,
            slip_speed: 1e-3,
            damping: Trial::<f64>::DAMPING,
        };
        let stepper = trial.stepper(Nystrom {
            time_step: REPORT_STEP,
        })?;
        let barriers = (stepper.barriers())
            .ok_or_else(|| TossError::new("no barriers", "the ground must be level"))?;
        let start = trial.state();
        // A phase that is no symmetry of the polygon.
        let phase = DQuat::from_rotation_x(0.3 * TAU / 120.0);
        let mut state = State {
            orientation: start.orientation * phase,
            ..start
        };
        let mut decided = UntilDecided::new(barriers);
        stepper.run(&mut state, REPORT_PATIENCE, &mut decided)?;
        Ok(decided.outcome())
    })
}
