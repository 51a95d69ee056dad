//! Properties of cube and tracker that follow from the flights before the first touch-down,
//! whatever the ground: the centre of mass, and the scale of lengths.

use tumble::glam::{DMat4, DQuat, DVec3, DVec4};

use crate::model::{Corrections, GRAVITY, Start, WIDTH};
use crate::statistics;
use crate::tosses::{RATE, Sample, Toss};
use common::Outcome;

/// Least gap of a sample in flight, m: above the tracker's error.
const CLEAR: f64 = 0.005;
/// Largest number of samples of a flight from which a start is computed: 0.1 s. Over longer times
/// the rotation rate is not constant enough.
const LONGEST_START: usize = 15;

/// Least number of samples of a flight for the test of [`spin_change`].
const TESTABLE: usize = 6;

/// Results of the flights, each with its standard error.
pub(crate) struct Weighed {
    /// Centre of mass from the middle of the cube, m, body axes.
    pub(crate) centre_of_mass: DVec3,
    pub(crate) centre_error: DVec3,
    /// True lengths over tracked lengths.
    pub(crate) scale: f64,
    pub(crate) scale_error: f64,
}

/// Computes the centre of mass and the scale from the flights.
///
/// The centre of mass moves along a parabola, and the tracked middle rotates about it:
/// `middle = x + v t - g t²/2 - R c`, in tracked lengths, with the measured rotation R. All flights
/// together give c and g by least squares. Each flight has its own position x and velocity v, which
/// are eliminated first: only the deviation of each term from a straight line in time is used. The
/// scale follows from g = 9.81 m/s².
///
/// The residuals of one flight are not independent, because the tracker's error drifts within it.
/// The standard errors are therefore those of a bootstrap over whole motions.
pub(crate) fn weigh(motions: &[Vec<Toss>], seed: u64) -> Outcome<Weighed> {
    let sums: Vec<Sums> = motions.iter().map(|motion| Sums::of(motion)).collect();
    let (centre_of_mass, scale) = Sums::solution(sums.iter()).ok_or(
        "the flights before the first touch-down are too short, or rotate too little, to find the \
         centre of mass",
    )?;
    let drawn: Vec<(DVec3, f64)> = statistics::drawings(sums.len(), seed)
        .filter_map(|drawing| Sums::solution(drawing.iter().map(|&motion| &sums[motion])))
        .collect();
    let error = |of: &dyn Fn(&(DVec3, f64)) -> f64| statistics::deviation(drawn.iter().map(of));
    Ok(Weighed {
        centre_of_mass,
        centre_error: DVec3::new(
            error(&|(centre, _)| centre.x),
            error(&|(centre, _)| centre.y),
            error(&|(centre, _)| centre.z),
        ),
        scale,
        scale_error: error(&|&(_, scale)| scale),
    })
}

/// Normal equations of one motion for c and g.
struct Sums {
    normal: DMat4,
    right: DVec4,
}

impl Sums {
    fn of(motion: &[Toss]) -> Self {
        let (mut normal, mut right) = ([[0.0; 4]; 4], [0.0; 4]);
        for toss in motion {
            // A scale of 1 is accurate enough to decide which samples are in flight.
            let flight = flight(toss, 1.0);
            if flight.len() < 3 {
                continue;
            }
            let bent = |of: &dyn Fn(f64, &Sample) -> DVec3| bent(flight, of);
            let terms = [
                bent(&|_, sample| -(sample.orientation * DVec3::X)),
                bent(&|_, sample| -(sample.orientation * DVec3::Y)),
                bent(&|_, sample| -(sample.orientation * DVec3::Z)),
                bent(&|t, _| DVec3::NEG_Z * (0.5 * t * t)),
            ];
            let path = bent(&|_, sample| sample.position);
            for (row, term) in terms.iter().enumerate() {
                for (column, other) in terms.iter().enumerate() {
                    normal[row][column] += product(term, other);
                }
                right[row] += product(term, &path);
            }
        }
        Self {
            normal: DMat4::from_cols_array_2d(&normal),
            right: DVec4::from_array(right),
        }
    }

    /// Centre of mass in true lengths, and true lengths over tracked lengths.
    fn solution<'a>(sums: impl Iterator<Item = &'a Self>) -> Option<(DVec3, f64)> {
        let (mut normal, mut right) = (DMat4::ZERO, DVec4::ZERO);
        for sum in sums {
            normal += sum.normal;
            right += sum.right;
        }
        let found = normal.inverse() * right;
        let scale = GRAVITY / found.w;
        (found.is_finite() && found.w > 0.0).then(|| (found.truncate() * scale, scale))
    }
}

/// Change of the angular velocity from the first half of the flight to the second, rad/s.
///
/// The cube's three moments of inertia are equal to some per cent, so that its angular momentum and
/// with it its angular velocity are constant in free flight. A hand that still holds it changes
/// them. Returns `None` for a flight of fewer than six samples.
pub(crate) fn spin_change(toss: &Toss) -> Option<f64> {
    let flight = flight(toss, 1.0);
    let last = flight.len().checked_sub(1)?;
    let middle = last / 2;
    let spin = |from: usize, to: usize| {
        let turn = flight[to].orientation * flight[from].orientation.inverse();
        let turn = if turn.w < 0.0 { -turn } else { turn };
        turn.to_scaled_axis() * (RATE / (to - from) as f64)
    };
    (flight.len() >= TESTABLE).then(|| (spin(middle, last) - spin(0, middle)).length())
}

/// Returns the first state, in true lengths and of the centre of mass: that of the first sample
/// alone, or that of a parabola and a steady rotation (the moments of inertia are equal) through
/// the samples before the first touch, by least squares.
pub(crate) fn start(toss: &Toss, body: &Corrections, start: Start) -> Sample {
    let first = &toss.samples[0];
    let centre =
        |sample: &Sample| sample.position * body.scale + sample.orientation * body.centre_of_mass;
    let flight = flight(toss, body.scale);
    let flight = &flight[..flight.len().min(LONGEST_START)];
    if start == Start::FirstSample || flight.len() < 3 {
        let arm = first.orientation * body.centre_of_mass;
        let spin = first.orientation * first.spin;
        return Sample {
            position: centre(first),
            velocity: first.velocity * body.scale + spin.cross(arm),
            ..*first
        };
    }
    let (position, velocity) = straight(
        times(flight).map(|(t, sample)| (t, centre(sample) + DVec3::Z * (0.5 * GRAVITY * t * t))),
    );
    let (offset, spin) = straight(times(flight).map(|(t, sample)| {
        let turn = sample.orientation * first.orientation.inverse();
        let turn = if turn.w < 0.0 { -turn } else { turn };
        (t, turn.to_scaled_axis())
    }));
    let orientation = DQuat::from_scaled_axis(offset) * first.orientation;
    Sample {
        position,
        velocity,
        orientation,
        spin: orientation.inverse() * spin,
    }
}

/// Samples before the first touch-down.
fn flight(toss: &Toss, scale: f64) -> &[Sample] {
    let in_flight = |sample: &Sample| {
        let down = (sample.orientation.inverse() * DVec3::NEG_Z).to_array();
        let bounding_radius: f64 = down.iter().map(|part| part.abs() * 0.5 * WIDTH).sum();
        sample.position.z * scale - bounding_radius > CLEAR
    };
    let end = (toss.samples.iter()).position(|sample| !in_flight(sample));
    &toss.samples[..end.unwrap_or(toss.samples.len())]
}

fn times(flight: &[Sample]) -> impl Iterator<Item = (f64, &Sample)> + Clone {
    (flight.iter().enumerate()).map(|(k, sample)| (k as f64 / RATE, sample))
}

/// Deviation of a quantity from a straight line in time in a flight.
fn bent(flight: &[Sample], of: &dyn Fn(f64, &Sample) -> DVec3) -> Vec<DVec3> {
    let values = times(flight).map(|(t, sample)| (t, of(t, sample)));
    let (start, rate) = straight(values.clone());
    values.map(|(t, value)| value - start - rate * t).collect()
}

fn product(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}

/// Value at time 0 and rate of the straight line through values at some times, by least squares.
fn straight(values: impl Iterator<Item = (f64, DVec3)> + Clone) -> (DVec3, DVec3) {
    let (mut count, mut time, mut value) = (0.0, 0.0, DVec3::ZERO);
    for (t, v) in values.clone() {
        count += 1.0;
        time += t;
        value += v;
    }
    let (time, value) = (time / count, value / count);
    let (mut square, mut product) = (0.0, DVec3::ZERO);
    for (t, v) in values {
        square += (t - time) * (t - time);
        product += (v - value) * (t - time);
    }
    let rate = product / square;
    (value - rate * time, rate)
}
