//! The moments that the coin report describes: the end of skidding, the fall, the rest.

use std::f64::consts::FRAC_PI_4;

use crate::recording::{Moment, Recording};
use crate::setup::{GRAVITY, MASS, RADIUS};

/// Times from the start, s. `None` if the event does not happen within the run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Milestones {
    pub(crate) skidding: Skidding,
    /// Time at which the coin's plane passes 45 degrees for the first time. `None` if the coin
    /// starts below.
    pub(crate) halfway_down: Option<f64>,
    /// Time from which its energy is that of the coin at rest on its face.
    pub(crate) settled: Option<f64>,
}

/// The first skid: the coin slips at its contact until friction makes it roll.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Skidding {
    /// The coin starts with its lowest point at rest, as a spinning coin does.
    Never,
    /// The skid ends at this time from the start, s.
    Until(f64),
    /// The skid lasts until the end of the run.
    Always,
}

/// Least initial slip that counts as a skid, m/s.
const SLOWEST_SKID: f64 = 0.01;
/// Fraction of the initial slip below which the coin rolls.
const ROLLING_PART: f64 = 0.1;
/// Time for which the slip must stay below that fraction, s.
const ROLLING_TIME: f64 = 0.1;
/// Fraction of `M g r` within which the energy of a settled coin is that at rest.
const SETTLED_PART: f64 = 1e-3;

impl Milestones {
    pub(crate) fn of(recording: &Recording) -> Self {
        Self {
            skidding: skidding(&recording.moments),
            halfway_down: halfway_down(&recording.moments),
            settled: settled(recording),
        }
    }

    /// A time soon after the coin has settled. Nothing of interest happens later.
    pub(crate) fn curtain(&self) -> Option<f64> {
        self.settled.map(|time| 1.1 * time + 0.5)
    }

    /// Times of the events, with short names for the margin of a picture.
    pub(crate) fn events(&self) -> Vec<(&'static str, f64)> {
        let skidding = match self.skidding {
            Skidding::Until(time) => Some(time),
            Skidding::Never | Skidding::Always => None,
        };
        let named = [
            ("passes 45°", self.halfway_down),
            ("slip below 10 %", skidding),
            ("settled", self.settled),
        ];
        let happens = |(name, time): (_, Option<f64>)| Some((name, time?));
        named.into_iter().filter_map(happens).collect()
    }
}

fn skidding(moments: &[Moment]) -> Skidding {
    let start = moments[0].slip;
    if start < SLOWEST_SKID {
        return Skidding::Never;
    }
    let mut rolls_since = None;
    for moment in moments {
        if moment.slip > ROLLING_PART * start {
            rolls_since = None;
            continue;
        }
        let since = *rolls_since.get_or_insert(moment.time);
        if moment.time - since >= ROLLING_TIME {
            return Skidding::Until(since);
        }
    }
    Skidding::Always
}

fn halfway_down(moments: &[Moment]) -> Option<f64> {
    let first = moments.iter().position(|moment| moment.tilt < FRAC_PI_4)?;
    (first > 0).then(|| moments[first].time)
}

fn settled(recording: &Recording) -> Option<f64> {
    let rest = recording.setup.energy_at_rest();
    let tolerance = SETTLED_PART * MASS * GRAVITY * RADIUS;
    let moves = |moment: &Moment| (moment.energy.total() - rest).abs() > tolerance;
    let still = match recording.moments.iter().rposition(moves) {
        Some(last_move) => last_move + 1,
        None => 0,
    };
    Some(recording.moments.get(still)?.time)
}
