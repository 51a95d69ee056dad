//! The coin of the coin report, set rolling or spinning at a lean.

use core::f64::consts::TAU;
use std::ops::ControlFlow;

use indicatif::ProgressBar;
use tumble::ensemble::{Ensemble, Pair, SceneHash, Tally, Toss, TossError};
use tumble::glam::DQuat;
use tumble::{CoinFace, Nystrom, Outcome as Ended, Sample, Start, State, Trial, UntilDecided};

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
    // The results are not saved, so that a name suffices as their scene.
    let ensemble = Ensemble::new(SEED, SceneHash::of_bytes(b"heads or tails"));
    let play = |toss: &mut Toss<'_>, step: f64| {
        let outcome = self::toss(throw, lean, toss, step);
        bar.inc(1);
        outcome
    };
    let middle = first + tosses / REPEATED;
    let pairs = ensemble.compare(
        first..middle,
        |toss| play(toss, STEP),
        |toss| play(toss, 0.25 * STEP),
    )?;
    let others = ensemble.run(middle..first + tosses, |toss| play(toss, STEP))?;
    check(&pairs)?;
    check(&others)?;
    let of = |choose: fn(&Pair<Face>) -> Ended<Face>| {
        let counts = pairs.decided().iter();
        let counts = counts.map(|(pair, count)| counted(choose(pair), count.count()));
        counts.fold(Count::default(), Count::plus)
    };
    let long = of(|pair| pair.coarse);
    let is_heads = |outcome| counted(outcome, 1).heads;
    let changed = (pairs.decided().iter())
        .filter(|(pair, _)| is_heads(pair.coarse) != is_heads(pair.fine))
        .map(|(_, count)| count.count());
    let undecided = counted(Ended::Undecided, others.undecided().count());
    let decided = others.decided().iter();
    let decided = decided.map(|(face, count)| counted(Ended::Decided(*face), count.count()));
    Ok(Point {
        lean,
        changed: changed.sum(),
        repeated: pairs.compared(),
        long,
        short: of(|pair| pair.fine),
        count: decided.fold(long.plus(undecided), Count::plus),
    })
}

/// Face that comes up, and true if the coin never passed upright.
type Face = (CoinFace, bool);

fn counted(outcome: Ended<Face>, tosses: u64) -> Count {
    let mut count = Count::default();
    match outcome {
        Ended::Decided((face, is_straight)) => {
            let counter = match face {
                CoinFace::Heads => &mut count.heads,
                _ => &mut count.tails,
            };
            *counter = tosses;
            count.straight = if is_straight { tosses } else { 0 };
        }
        Ended::Undecided => count.undecided = tosses,
    }
    count
}

/// No toss may fail.
pub(crate) fn check<L>(tally: &Tally<L>) -> Outcome<()> {
    if tally.errors().is_empty() && tally.panics().count() == 0 {
        return Ok(());
    }
    Err(format!(
        "tosses failed: {:?}, panics: {:?}",
        tally.errors(),
        tally.panics()
    )
    .into())
}

fn throw_number(throw: &Throw) -> u64 {
    let place = THROWS.iter().position(|other| other.name == throw.name);
    place.unwrap_or(0) as u64
}

/// One toss: its random numbers are those of the stream with its number.
fn toss(
    throw: &Throw,
    lean: f64,
    toss: &mut Toss<'_>,
    time_step: f64,
) -> Result<Ended<Face>, TossError> {
    let mut spread = || 2.0 * toss.fraction() - 1.0;
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
    let stepper = trial.stepper(Nystrom { time_step })?;
    let barriers = (stepper.barriers())
        .ok_or_else(|| TossError::new("no barriers", "the ground must be level"))?;
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
    Ok(match both.1.outcome() {
        Ended::Decided(face) => Ended::Decided((face, !passed)),
        Ended::Undecided => Ended::Undecided,
    })
}
