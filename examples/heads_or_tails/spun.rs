//! The coin of the coin report, set rolling or spinning at a lean.

use core::f64::consts::TAU;
use std::ops::ControlFlow;

use indicatif::ProgressBar;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use rayon::prelude::*;
use tumble::glam::DQuat;
use tumble::{CoinFace, Nystrom, Sample, Start, State, StepError, Trial, UntilDecided};

use crate::count::Count;
use common::Outcome;

/// Leans at which the coin starts, degrees from upright.
pub(crate) const LEANS: [f64; 9] = [0.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0];
/// The lean of a start differs from the intended one by at most so much, degrees.
pub(crate) const LEAN_SPREAD: f64 = 1.0;
/// The angular momentum differs from the intended one by at most this part.
pub(crate) const SPIN_SPREAD: f64 = 0.2;
/// s. Ends of steps are samples of the motion, which a coin at 20 rad/s changes by 0.02 rad.
pub(crate) const STEP: f64 = 2e-3;
/// s. A toss that lasts longer is undecided.
const PATIENCE: f64 = 60.0;
const SEED: u64 = 1;

/// A way to start the coin, with its angular momentum, kg m²/s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Throw {
    pub(crate) name: &'static str,
    pub(crate) start: Start,
    pub(crate) angular_momentum: f64,
    /// One of so many tosses is thrown, because they last long.
    pub(crate) thinned: u64,
}

/// One of so many tosses is repeated with a quarter of the step.
pub(crate) const REPEATED: u64 = 10;

/// The angular momenta of trials 1, 4 and 6.
pub(crate) const THROWS: [Throw; 3] = [
    Throw {
        name: "rolling, 1 kg m²/s",
        start: Start::Rolling,
        angular_momentum: 1.0,
        thinned: 1,
    },
    Throw {
        name: "spinning, 1 kg m²/s",
        start: Start::Spinning,
        angular_momentum: 1.0,
        thinned: 1,
    },
    Throw {
        name: "spinning, 5 kg m²/s",
        start: Start::Spinning,
        angular_momentum: 5.0,
        thinned: 4,
    },
];

/// Outcomes of one way to start at one lean.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    pub(crate) lean: f64,
    pub(crate) count: Count,
    /// Tosses that were repeated with a quarter of the step, and those of which one is heads and
    /// the other is not.
    pub(crate) repeated: u64,
    pub(crate) changed: u64,
    /// Outcomes of the repeated tosses with the long step, and with the short one.
    pub(crate) long: Count,
    pub(crate) short: Count,
}

/// Throws the coin at each lean; heads points up at the start, where the coin leans at all.
pub(crate) fn curve(throw: &Throw, tosses: u64, bar: &ProgressBar) -> Outcome<Vec<Point>> {
    let leans = LEANS.iter().zip(0..);
    leans
        .map(|(&lean, place)| point(throw, (lean, place), tosses, bar))
        .collect()
}

fn point(
    throw: &Throw,
    (lean, place): (f64, u64),
    tosses: u64,
    bar: &ProgressBar,
) -> Outcome<Point> {
    let first = (place + 100 * throw_number(throw)) << 32;
    let run = |numbers: core::ops::Range<u64>, step: f64| -> Result<Vec<Count>, StepError> {
        (numbers.into_par_iter())
            .map(|number| {
                let count = toss(throw, lean, first + number, step);
                bar.inc(1);
                count
            })
            .collect()
    };
    let long = run(0..tosses, STEP)?;
    let short = run(0..tosses / REPEATED, 0.25 * STEP)?;
    let changed = (long.iter().zip(&short)).filter(|(a, b)| a.heads != b.heads);
    Ok(Point {
        lean,
        changed: changed.count() as u64,
        repeated: short.len() as u64,
        long: (long.iter().take(short.len())).fold(Count::default(), |sum, count| sum.plus(*count)),
        count: long.into_iter().fold(Count::default(), Count::plus),
        short: short.into_iter().fold(Count::default(), Count::plus),
    })
}

fn throw_number(throw: &Throw) -> u64 {
    let place = THROWS.iter().position(|other| other.name == throw.name);
    place.unwrap_or(0) as u64
}

/// One toss: its random numbers are those of the stream with its number.
fn toss(throw: &Throw, lean: f64, number: u64, time_step: f64) -> Result<Count, StepError> {
    let mut stream = ChaCha8Rng::seed_from_u64(SEED);
    stream.set_stream(number);
    let mut spread = || 2.0 * ((stream.next_u64() >> 11) as f64 / (1_u64 << 53) as f64) - 1.0;
    let trial = Trial {
        start: throw.start,
        // Heads points up, if the tilt is negative.
        tilt: -(lean + LEAN_SPREAD * spread()).to_radians(),
        angular_momentum: throw.angular_momentum * (1.0 + SPIN_SPREAD * spread()),
        coefficient: 0.3,
        slip_speed: 1e-3,
        damping: Trial::<f64>::DAMPING,
    };
    // Any of the polygon's angles: the coin is turned about its normal.
    let phase = DQuat::from_rotation_x(0.5 * spread() * TAU / 120.0);
    let stepper = match trial.stepper(Nystrom { time_step }) {
        Ok(stepper) => stepper,
        Err(_) => return Ok(Count::default()),
    };
    let Some(barriers) = stepper.barriers() else {
        return Ok(Count::default());
    };
    let state = trial.state();
    let mut state = State {
        orientation: state.orientation * phase,
        ..state
    };
    let first = stepper.body().face_up(&state);
    let mut passed = false;
    let pass = |sample: &Sample<'_>| {
        passed |= stepper.body().face_up(sample.state) != first;
        ControlFlow::Continue(())
    };
    let mut both = (pass, UntilDecided::new(barriers));
    stepper.run(&mut state, PATIENCE, &mut both)?;
    let face = both.1.face();
    Ok(Count {
        heads: u64::from(face == Some(CoinFace::Heads)),
        tails: u64::from(face == Some(CoinFace::Tails)),
        undecided: u64::from(face.is_none()),
        straight: u64::from(face.is_some() && !passed),
    })
}
