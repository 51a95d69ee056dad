//! Two starts 1e-9 m apart: how fast they separate, in the eight trials of the coin report.
//!
//! The distance of two states is `|Δx| + r Δθ`, with the distance of their positions, the radius
//! and the angle between their orientations. The second start leans by `1e-9 m/r` more. Both are
//! advanced by the same fixed steps, so that the distance has an error of rounding only, and its
//! rate does not contain that of the step.
//!
//! While the distance is small it obeys the equations linearised about the motion, and in a chaotic
//! motion it grows on average as `exp(λ t)`, with the largest Lyapunov exponent λ (Benettin,
//! Galgani, Giorgilli & Strelcyn, Meccanica 15, 1980). A coin comes to rest, so that there is no
//! limit of long times: the rate here is that of an interval. It is the slope of the least squares
//! line through `ln d(t)`, from the first distance above 1e-7 m to the first above 1e-3 m. Its
//! standard error is that of the mean slope of eight equal parts of the interval. A distance that
//! is better fitted by a power of time is reported as such, and is no sign of chaos.

use rayon::prelude::*;
use tumble::glam::{DQuat, DVec3};
use tumble::{
    CoinFace, FlatGround, Integrator, Nystrom, Outcome as Ended, RigidPointBody, Rk4, State,
    Stepper, Trial, UniformGravity,
};

use common::Outcome;

/// Distance of the starts, m.
pub(crate) const START: f64 = 1e-9;
/// Interval of distances of a fit, m.
pub(crate) const FITTED: [f64; 2] = [1e-7, 1e-3];
/// s. Two starts are followed for so long.
const SECONDS: f64 = 30.0;
/// s. Interval of the distances.
const INTERVAL: f64 = 0.02;
/// s.
pub(crate) const STEP: f64 = 5e-5;
/// m/s. An explicit step resolves friction if it is shorter than `2/3` of this over `μ g`, which is
/// 0.085 ms for the largest coefficient of the trials, 0.8. With the 1e-10 m/s of the report, the
/// chatter of unresolved friction would add distance that the motion does not have.
const SLIP_SPEED: f64 = 1e-3;
/// Number of parts of a fit, for its standard error.
const PARTS: usize = 8;

/// The distance of two motions, and their outcomes.
#[derive(Clone, Debug)]
pub(crate) struct Pair {
    /// Time, s, and distance, m.
    pub(crate) distances: Vec<(f64, f64)>,
    /// States of the first motion at these times.
    states: Vec<State>,
    /// Face and time, s, at which each of the motions is decided.
    pub(crate) decided: [Option<(CoinFace, f64)>; 2],
}

/// Growth of a distance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Growth {
    /// Rate and standard error, 1/s, of an exponential.
    pub(crate) rate: f64,
    pub(crate) error: f64,
    /// Interval of the fit, s.
    pub(crate) interval: [f64; 2],
    /// Root mean square deviations of ln d from an exponential and from a power of time.
    pub(crate) deviations: [f64; 2],
}

impl Growth {
    /// Whether an exponential fits the distance better than a power of time.
    pub(crate) fn is_exponential(&self) -> bool {
        self.deviations[0] < self.deviations[1]
    }
}

/// A trial with two integrators.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) trial: usize,
    pub(crate) pairs: [Pair; 2],
}

impl Pair {
    /// Growth between the distances of [`FITTED`]. `None` if the distance does not cover them.
    pub(crate) fn growth(&self) -> Option<Growth> {
        let first = self.first_above(FITTED[0])?;
        let last = self.first_above(FITTED[1])?;
        let curve = self.distances.get(first..=last)?;
        if curve.len() < 2 * PARTS {
            return None;
        }
        let logs: Vec<(f64, f64)> = curve.iter().map(|(t, d)| (*t, d.ln())).collect();
        let powers: Vec<(f64, f64)> = logs.iter().map(|(t, log)| (t.ln(), *log)).collect();
        let (rate, deviation) = line(&logs);
        let ends = (0..=PARTS).map(|part| logs[part * (logs.len() - 1) / PARTS]);
        let ends: Vec<(f64, f64)> = ends.collect();
        let slopes = ends
            .windows(2)
            .map(|w| (w[1].1 - w[0].1) / (w[1].0 - w[0].0));
        let slopes: Vec<f64> = slopes.collect();
        let mean = slopes.iter().sum::<f64>() / PARTS as f64;
        let squares: f64 = slopes.iter().map(|slope| (slope - mean).powi(2)).sum();
        Some(Growth {
            rate,
            error: (squares / (PARTS * (PARTS - 1)) as f64).sqrt(),
            interval: [curve[0].0, curve[curve.len() - 1].0],
            deviations: [deviation, line(&powers).1],
        })
    }

    fn first_above(&self, distance: f64) -> Option<usize> {
        self.distances.iter().position(|(_, d)| *d > distance)
    }

    /// First time at which the distance exceeds a distance, s.
    pub(crate) fn time_above(&self, distance: f64) -> Option<f64> {
        Some(self.distances.get(self.first_above(distance)?)?.0)
    }

    pub(crate) fn largest(&self) -> f64 {
        self.distances.iter().map(|(_, d)| *d).fold(0.0, f64::max)
    }
}

impl Row {
    /// Growth with each of the integrators. `None` if a distance does not cover [`FITTED`], or if
    /// the motions of the two integrators part before it does: then the fits are those of two
    /// motions, and neither need be that of the trial.
    pub(crate) fn growths(&self) -> Option<[Growth; 2]> {
        let [first, second] = self.pairs.each_ref().map(Pair::growth);
        let growths = [first?, second?];
        let follows = |growth: &Growth| {
            let parted = self.methods_apart();
            parted.is_none_or(|time| time >= growth.interval[1])
        };
        growths.iter().all(follows).then_some(growths)
    }

    /// First time, s, at which the motions of the two integrators are 1 mm apart.
    pub(crate) fn methods_apart(&self) -> Option<f64> {
        let [first, second] = &self.pairs;
        let states = first.states.iter().zip(&second.states);
        let radius = Trial::<f64>::RADIUS;
        let index = states
            .map(|(a, b)| distance(a, b, radius))
            .position(|distance| distance > 1e-3)?;
        Some(first.distances.get(index)?.0)
    }
}

/// Slope of the least squares line, and the root mean square deviation from it.
fn line(points: &[(f64, f64)]) -> (f64, f64) {
    let count = points.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let slope = mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x).powi(2));
    let square = mean(&|p| (p.1 - y - slope * (p.0 - x)).powi(2));
    (slope, square.sqrt())
}

/// Distance of two states of a coin of radius `radius`, m.
fn distance(a: &State, b: &State, radius: f64) -> f64 {
    let rotation = b.orientation * a.orientation.conjugate();
    // The vector part is accurate for small angles, where the scalar part is not.
    let sine = DVec3::new(rotation.x, rotation.y, rotation.z).length();
    (a.position - b.position).length() + radius * 2.0 * sine.atan2(rotation.w.abs())
}

/// Time for which two starts are followed, s.
pub(crate) fn seconds(is_quick: bool) -> f64 {
    if is_quick { 0.2 * SECONDS } else { SECONDS }
}

/// The eight trials, each with two integrators.
pub(crate) fn rows(is_quick: bool) -> Outcome<Vec<Row>> {
    let seconds = seconds(is_quick);
    let rows = (1..=8_usize).into_par_iter().map(|trial| {
        let nystrom = pair(trial, Nystrom { time_step: STEP }, seconds)?;
        let rk4 = pair(trial, Rk4 { time_step: STEP }, seconds)?;
        Ok(Row {
            trial,
            pairs: [nystrom, rk4],
        })
    });
    let rows: Result<Vec<_>, String> = rows.collect();
    Ok(rows?)
}

fn pair<I: Integrator>(trial: usize, integrator: I, seconds: f64) -> Result<Pair, String> {
    let text = |error: &dyn core::fmt::Display| error.to_string();
    let report = Trial::report(trial).ok_or("no such trial")?;
    let trial = Trial {
        slip_speed: SLIP_SPEED,
        ..report
    };
    let stepper = trial.stepper(integrator).map_err(|error| text(&error))?;
    let barriers = stepper.barriers().ok_or("no level ground")?;
    let radius = Trial::<f64>::RADIUS;
    let mut states = starts(trial.state(), radius);
    let mut pair = Pair {
        distances: Vec::new(),
        states: Vec::new(),
        decided: [None; 2],
    };
    let mut time = 0.0;
    while time < seconds {
        pair.distances
            .push((time, distance(&states[0], &states[1], radius)));
        pair.states.push(states[0]);
        for (state, decided) in states.iter_mut().zip(&mut pair.decided) {
            stepper
                .advance(state, INTERVAL)
                .map_err(|error| text(&error))?;
            if let (None, Ended::Decided(face)) = (*decided, barriers.outcome(state)) {
                *decided = Some((face, time + INTERVAL));
            }
        }
        time += INTERVAL;
    }
    Ok(pair)
}

/// A start, and one that leans more by `START/radius`.
fn starts(start: State, radius: f64) -> [State; 2] {
    let lean = DQuat::from_rotation_y(START / radius);
    let other = State {
        orientation: lean * start.orientation,
        ..start
    };
    [start, other]
}

/// Measured and exact rate at which the coin of the coin report tips over from upright, 1/s,
/// without spin and friction.
///
/// In equilibrium the contact i at the distance z_i below the centre of mass pushes with
/// `N_i = k (z_i - h)`, and `Σ N_i = m g` determines the height h. A lean by a small angle θ
/// changes heights and forces in second order only, and the forces have the torque `θ Σ N_i z_i`.
/// So θ grows as `cosh(λ t)` with `λ² = Σ N_i z_i/I`.
pub(crate) fn tipping() -> Outcome<[f64; 2]> {
    let trial = Trial::<f64>::report(4).ok_or("no such trial")?;
    let coin = trial.coin();
    let below: Vec<f64> = coin
        .contacts()
        .iter()
        .map(|contact| -contact.position.z)
        .collect();
    let (stiffness, weight) = (
        Trial::<f64>::STIFFNESS,
        Trial::<f64>::MASS * Trial::<f64>::GRAVITY,
    );
    let force = |z: f64, height: f64| stiffness * (z - height).max(0.0);
    let [mut low, mut high] = [0.0, Trial::<f64>::RADIUS];
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        let total: f64 = below.iter().map(|z| force(*z, middle)).sum();
        *(if total > weight { &mut low } else { &mut high }) = middle;
    }
    let torque: f64 = below.iter().map(|z| force(*z, low) * z).sum();
    let exact = (torque / coin.inertia().y_axis.y).sqrt();
    let stepper = Stepper::builder(coin)
        .gravity(UniformGravity::down(Trial::<f64>::GRAVITY))
        .ground(FlatGround::level(stiffness, Trial::<f64>::DAMPING))
        .integrator(Nystrom { time_step: STEP })
        .build()?;
    let radius = Trial::<f64>::RADIUS;
    let mut states = starts(State::at(DVec3::Z * low), radius);
    let mut pair = Pair {
        distances: Vec::new(),
        states: Vec::new(),
        decided: [None; 2],
    };
    for step in 0..200 {
        let time = INTERVAL * f64::from(step);
        pair.distances
            .push((time, distance(&states[0], &states[1], radius)));
        for state in &mut states {
            stepper.advance(state, INTERVAL)?;
        }
    }
    let growth = pair.growth().ok_or("the coin does not tip over")?;
    Ok([growth.rate, exact])
}
