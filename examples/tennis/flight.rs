//! Flight of a shot until the second bounce, with the motion before and after the first.

use std::ops::ControlFlow;

use common::Outcome;
use tumble::glam::{DQuat, DVec3};
use tumble::{Dynamics, Sample, State};

use crate::model::{Game, RADIUS};

/// Longest flight, s. Every shot bounces twice before.
const PATIENCE: f64 = 10.0;
/// Interval of the recorded motion, s.
const INTERVAL: f64 = 1e-3;

/// Motion of the ball at one time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    /// s
    pub(crate) time: f64,
    /// Centre, m.
    pub(crate) position: DVec3,
    pub(crate) orientation: DQuat,
    /// m/s
    pub(crate) velocity: DVec3,
    /// rad/s
    pub(crate) spin: DVec3,
}

impl Moment {
    fn of(game: &Game, sample: &Sample<'_>) -> Self {
        let state = sample.state;
        Self {
            time: sample.time,
            position: state.position,
            orientation: state.orientation,
            velocity: state.linear_velocity,
            spin: game.scene().motion(state).angular_velocity,
        }
    }

    /// Spin in revolutions a minute: above 0 if the top of the ball moves forwards, else below. A
    /// spin about another axis counts with its size.
    pub(crate) fn turns(&self) -> f64 {
        let per_minute = 60.0 / std::f64::consts::TAU;
        let size = self.spin.length().copysign(self.spin.y);
        size * per_minute
    }

    /// Angle of the velocity above the horizontal, degrees.
    pub(crate) fn angle(&self) -> f64 {
        let along = self.velocity.truncate().length();
        self.velocity.z.atan2(along).to_degrees()
    }
}

/// A flight through one bounce to the second.
#[derive(Debug)]
pub(crate) struct Flight {
    /// Motion at intervals, and at the ends of the flight.
    pub(crate) path: Vec<Moment>,
    /// Last moment before the first bounce, and first after it.
    pub(crate) bounce: [Moment; 2],
    /// Largest increase of the energy in a step, J. It is at most 0 with `EnergyMomentum`.
    pub(crate) energy_gain: f64,
}

impl Flight {
    /// Point of the first touch-down, m.
    pub(crate) fn landing(&self) -> DVec3 {
        touch_down(&self.bounce[0])
    }

    /// Last moment before the second bounce.
    pub(crate) fn end(&self) -> &Moment {
        &self.path[self.path.len() - 1]
    }

    /// Largest height of the centre after the first bounce, m.
    pub(crate) fn top_after_bounce(&self) -> f64 {
        let after = |moment: &&Moment| moment.time > self.bounce[1].time;
        let heights = self.path.iter().filter(after).map(|m| m.position.z);
        heights.fold(RADIUS, f64::max)
    }

    /// Height of the centre at a distance from the baseline, m. `None` beyond the first bounce.
    pub(crate) fn height_at(&self, distance: f64) -> Option<f64> {
        let pairs = self.path.windows(2);
        let mut first_arc = pairs.take_while(|pair| pair[1].time <= self.bounce[0].time);
        let pair = first_arc.find(|pair| pair[1].position.x >= distance)?;
        let [from, to] = [pair[0].position, pair[1].position];
        Some(from.lerp(to, (distance - from.x) / (to.x - from.x)).z)
    }
}

/// Point at which a ball that is about to touch does so, m.
fn touch_down(before: &Moment) -> DVec3 {
    let seconds = (before.position.z - RADIUS) / -before.velocity.z;
    before.position + before.velocity * seconds
}

/// Point of the first touch-down, m.
pub(crate) fn landing(game: &Game, mut state: State) -> Outcome<DVec3> {
    let mut last = None;
    let mut watch = |sample: &Sample<'_>| {
        if sample.state.position.z < RADIUS {
            return ControlFlow::Break(());
        }
        last = Some(Moment::of(game, sample));
        ControlFlow::Continue(())
    };
    let seconds = game.run(&mut state, PATIENCE, &mut watch)?;
    let before = last.filter(|_| seconds < PATIENCE);
    Ok(touch_down(&before.ok_or("the ball does not land")?))
}

/// Follows a ball until its second bounce.
pub(crate) fn fly(game: &Game, mut state: State) -> Outcome<Flight> {
    let mut record = Record::default();
    let mut watch = |sample: &Sample<'_>| {
        record.energy(sample.energy().total());
        record.take(Moment::of(game, sample))
    };
    game.run(&mut state, PATIENCE, &mut watch)?;
    record.finish()
}

/// What is known of a flight so far.
#[derive(Default)]
struct Record {
    path: Vec<Moment>,
    last: Option<Moment>,
    before: Option<Moment>,
    after: Option<Moment>,
    last_energy: Option<f64>,
    energy_gain: Option<f64>,
}

impl Record {
    fn energy(&mut self, energy: f64) {
        if let Some(last) = self.last_energy.replace(energy) {
            let gain = energy - last;
            self.energy_gain = Some(self.energy_gain.map_or(gain, |most| most.max(gain)));
        }
    }

    /// Takes a moment, and ends the flight at the second touch-down.
    fn take(&mut self, now: Moment) -> ControlFlow<()> {
        let touches = now.position.z < RADIUS;
        match (touches, self.before, self.after) {
            (true, None, _) => self.before = self.last,
            (false, Some(_), None) => self.after = Some(now),
            (true, _, Some(_)) => {
                self.path.extend(self.last);
                return ControlFlow::Break(());
            }
            _ => {}
        }
        // Times are sums of steps, so they deviate by rounding.
        if now.time > self.path.len() as f64 * INTERVAL - 1e-9 {
            self.path.push(now);
        }
        self.last = Some(now);
        ControlFlow::Continue(())
    }

    fn finish(self) -> Outcome<Flight> {
        let (Some(before), Some(after)) = (self.before, self.after) else {
            return Err("the ball does not bounce".into());
        };
        Ok(Flight {
            path: self.path,
            bounce: [before, after],
            energy_gain: self.energy_gain.unwrap_or(f64::NEG_INFINITY),
        })
    }
}
