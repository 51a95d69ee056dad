//! A coin tossed and bounced: what is left of the bias of a caught coin after each bounce.
//!
//! The coin leaves the hand level and heads up, as one that is caught. After n bounces, the side up
//! is that at the n-th time at which the centre of mass is highest after the first touch-down. A
//! toss whose face is proven before that has this face up. The start is uniform in speed and rate,
//! so that the phase of the motion at the catch is nearly uniform.
//!
//! With the angular momentum at 90° from the normal, the phases of heads and of tails are mirror
//! images for a coin whose faces are alike. Then each of the fractions is one half.

use core::f64::consts::TAU;
use core::ops::ControlFlow;

use indicatif::ProgressBar;
use tumble::ensemble::{Ensemble, Pair, SceneHash, Tally, Toss, TossError};
use tumble::{CoinFace, Outcome as Ended, Sample, State, UntilDecided};

use crate::count::Count;
use crate::steel;
use common::Outcome;

/// Bounces after which the side up is counted.
pub(crate) const BOUNCES: usize = 6;
/// One of so many tosses is repeated.
pub(crate) const REPEATED: u64 = 10;
/// Angles between normal and angular momentum, degrees.
pub(crate) const ANGLES: [f64; 2] = [55.0, 90.0];
/// Vertical speeds, m/s, and rates of the normal's motion, revolutions a second.
pub(crate) const SPEEDS: [f64; 2] = [2.0, 2.8];
pub(crate) const RATES: [f64; 2] = [30.0, 46.0];

/// Tosses with the first side up: when caught, after each number of bounces, and at the end.
#[derive(Clone, Debug)]
pub(crate) struct Bounced {
    pub(crate) psi: f64,
    pub(crate) caught: Count,
    pub(crate) after: [Count; BOUNCES],
    pub(crate) end: Count,
    /// Tosses that are repeated with a hundredth of the tolerance, those of which one ends with the
    /// first side up and the other does not, and the change of their number.
    pub(crate) repeated: u64,
    pub(crate) changed: u64,
    pub(crate) fewer: f64,
}

/// Sides up of a toss. True is the first side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Sides {
    caught: bool,
    after: [bool; BOUNCES],
    /// `None` if the toss is undecided or on its edge.
    end: Option<bool>,
}

pub(crate) fn count(psi: f64, tosses: u64, bar: &ProgressBar) -> Outcome<Bounced> {
    let stepper = steel::table(steel::TOLERANCE)?;
    let name = format!("bounced at {psi}");
    let ensemble = Ensemble::new(3, SceneHash::of_bytes(name.as_bytes()));
    let fine = steel::table(0.01 * steel::TOLERANCE)?;
    let played = |stepper: &steel::Table, toss: &mut Toss<'_>| {
        let sides = play(stepper, psi, toss)?;
        bar.inc(1);
        Ok(Ended::Decided(sides))
    };
    let tally = ensemble.run(0..tosses, |toss| played(&stepper, toss))?;
    crate::spun::check(&tally)?;
    let repeated = tosses / REPEATED;
    let pairs = ensemble.compare(0..repeated, |t| played(&stepper, t), |t| played(&fine, t))?;
    crate::spun::check(&pairs)?;
    let (changed, fewer) = changes(&pairs);
    let of = |side: &dyn Fn(&Sides) -> Option<bool>| {
        let counts = tally.decided().iter();
        counts.fold(Count::default(), |sum, (sides, count)| {
            sum.plus(counted(side(sides), count.count()))
        })
    };
    Ok(Bounced {
        psi,
        caught: of(&|sides| Some(sides.caught)),
        after: core::array::from_fn(|n| of(&|sides| Some(sides.after[n]))),
        end: of(&|sides| sides.end),
        repeated,
        changed,
        fewer,
    })
}

/// Pairs of which one ends with the first side up and the other does not, and by how many more do
/// with the larger tolerance.
fn changes(pairs: &Tally<Pair<Sides>>) -> (u64, f64) {
    let is_same = |sides: Ended<Sides>| match sides {
        Ended::Decided(sides) => sides.end == Some(true),
        Ended::Undecided => false,
    };
    let mut sums = (0, 0.0);
    for (pair, count) in pairs.decided() {
        let (coarse, fine) = (is_same(pair.coarse), is_same(pair.fine));
        if coarse != fine {
            sums.0 += count.count();
            sums.1 += if coarse { 1.0 } else { -1.0 } * count.count() as f64;
        }
    }
    sums
}

fn counted(side: Option<bool>, tosses: u64) -> Count {
    let mut count = Count::default();
    *(match side {
        Some(true) => &mut count.heads,
        Some(false) => &mut count.tails,
        None => &mut count.undecided,
    }) = tosses;
    count
}

fn play(stepper: &steel::Table, psi: f64, toss: &mut Toss<'_>) -> Result<Sides, TossError> {
    let speed = toss.uniform(SPEEDS[0]..=SPEEDS[1]);
    let rate = TAU * toss.uniform(RATES[0]..=RATES[1]);
    let barriers = (stepper.barriers())
        .ok_or_else(|| TossError::new("no barriers", "the ground must be level"))?;
    let start = steel::toss(stepper.body(), speed, psi.to_radians(), rate);
    let mut session = stepper.session(start);
    // The hand is so high over the table that the coin does not touch it before the catch.
    session.advance(2.0 * speed / steel::GRAVITY)?;
    let caught = steel::is_heads_up(session.state());
    let mut sides = Vec::new();
    let mut before = *session.state();
    let highest = |sample: &Sample<'_>| {
        if before.linear_velocity.z > 0.0 && sample.state.linear_velocity.z <= 0.0 {
            sides.push(steel::is_heads_up(&top(stepper, &before)));
        }
        before = *sample.state;
        ControlFlow::Continue(())
    };
    let mut both = (highest, UntilDecided::new(barriers));
    session.run(steel::PATIENCE, &mut both)?;
    let end = match both.1.face() {
        Some(CoinFace::Heads) => Some(true),
        Some(CoinFace::Tails) => Some(false),
        _ => None,
    };
    // A toss that is decided before stays on its face. One without an end keeps its last side.
    let last = end.or(sides.last().copied()).unwrap_or(caught);
    let after = core::array::from_fn(|n| sides.get(n).copied().unwrap_or(last));
    Ok(Sides { caught, after, end })
}

/// State at the highest point of a flight, from a state on the way up. In contact it is accurate to
/// a step.
fn top(stepper: &steel::Table, before: &State) -> State {
    let mut state = *before;
    let seconds = before.linear_velocity.z / steel::GRAVITY;
    match stepper.advance(&mut state, seconds) {
        Ok(()) => state,
        Err(_) => *before,
    }
}
