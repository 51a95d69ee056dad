//! Observer of a run: stores moments at intervals and the energy audit, and updates the progress
//! bar.

use std::ops::ControlFlow;

use indicatif::ProgressBar;
use tumble::{Coin, ContactPoint, Ledger, Observer, Sample};

use crate::recording::{Audit, Moment};
use crate::setup::Setup;

/// A ring of any number of points.
pub(crate) type RingCoin = Coin<f64, Vec<ContactPoint>>;

/// Number of stored moments for each second of a short run.
const MOMENTS_PER_SECOND: f64 = 100.0;
/// Largest number of moments of a run.
const MOST_MOMENTS: f64 = 200_000.0;

/// An observer of the library that makes a recording.
#[derive(Debug)]
pub(crate) struct Recorder<'a> {
    coin: &'a RingCoin,
    bar: &'a ProgressBar,
    /// Interval between two moments, s.
    interval: f64,
    duration: f64,
    ledger: Option<Ledger>,
    moments: Vec<Moment>,
}

impl<'a> Recorder<'a> {
    pub(crate) fn new(setup: &Setup, coin: &'a RingCoin, bar: &'a ProgressBar) -> Self {
        bar.set_length(milliseconds(setup.duration));
        Self {
            coin,
            bar,
            interval: (1.0 / MOMENTS_PER_SECOND).max(setup.duration / MOST_MOMENTS),
            duration: setup.duration,
            ledger: setup.audit.then(Ledger::new),
            moments: Vec::new(),
        }
    }

    /// Time of the last moment, s.
    pub(crate) fn time(&self) -> f64 {
        self.moments.last().map_or(0.0, |moment| moment.time)
    }

    /// Returns the moments and the energy audit, if there is one.
    pub(crate) fn finish(self) -> (Vec<Moment>, Option<Audit>) {
        let audit = self.ledger.map(|ledger| Audit {
            work: ledger.work(),
            energy_error: ledger.energy_error(),
        });
        (self.moments, audit)
    }

    /// Returns true if the next moment or the end of the run is reached. Times are sums of steps,
    /// so they may deviate by rounding.
    fn is_due(&self, time: f64) -> bool {
        let next = self.moments.len() as f64 * self.interval;
        time >= next - 1e-6 * self.interval || time >= self.duration
    }

    fn moment(&self, sample: &Sample<'_>) -> Moment {
        let state = sample.state;
        let lowest = sample.lowest_point();
        Moment {
            time: sample.time,
            centre: state.position,
            velocity: state.linear_velocity,
            orientation: state.orientation,
            angular_momentum: state.angular_momentum,
            lowest: lowest.map_or(state.position, |lowest| lowest.position),
            slip: lowest.map_or(0.0, |lowest| lowest.slip_velocity.length()),
            tilt: self.coin.tilt(state),
            touching: sample.touching(),
            energy: sample.energy(),
        }
    }
}

impl Observer for Recorder<'_> {
    fn observe(&mut self, sample: &Sample<'_>) -> ControlFlow<()> {
        if let Some(ledger) = &mut self.ledger {
            ledger.observe(sample)?;
        }
        if self.is_due(sample.time) {
            let moment = self.moment(sample);
            self.moments.push(moment);
            self.bar.set_position(milliseconds(sample.time));
        }
        ControlFlow::Continue(())
    }
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // For the bar's eyes only.
fn milliseconds(seconds: f64) -> u64 {
    (seconds * 1e3) as u64
}
