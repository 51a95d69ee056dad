//! Slides on a face: the coefficient of friction under a quarter of the weight a corner, measured
//! without any model of the contact.

use tumble::glam::{DMat3, DVec3};

use crate::model::{GRAVITY, WIDTH};
use crate::tosses::{RATE, Sample, Toss};

/// Least number of samples of a slide. The standard error of its deceleration is then about 0.02.
const SHORTEST: usize = 6;

/// Coefficients of friction of the slides of a toss: deceleration over g, both in tracked lengths.
pub(crate) fn coefficients(toss: &Toss, scale: f64) -> Vec<f64> {
    (toss.samples)
        .chunk_by(|a, b| slides(a, scale) == slides(b, scale))
        .filter(|samples| samples.len() >= SHORTEST && slides(&samples[0], scale))
        .map(|samples| {
            let [_, velocity, acceleration] = parabola(samples);
            -acceleration.dot(velocity.normalize()) * scale / GRAVITY
        })
        .collect()
}

/// Returns true if a face lies on the table (to 0.02 rad and 1.2 mm) and slides at 0.15 m/s or more
/// without spin (0.5 rad/s). The slip is then above seven slip speeds at all corners.
fn slides(sample: &Sample, scale: f64) -> bool {
    let down = sample.orientation.inverse() * DVec3::NEG_Z;
    let off = sample.position.z - 0.5 * WIDTH / scale;
    down.abs().max_element() > 0.02_f64.cos()
        && off.abs() < 1.2e-3
        && sample.velocity.with_z(0.0).length() > 0.15
        && sample.spin.length() < 0.5
}

/// Position, velocity and acceleration along the table at the first of some samples, by least
/// squares.
fn parabola(samples: &[Sample]) -> [DVec3; 3] {
    let (mut normal, mut right) = (DMat3::ZERO, [DVec3::ZERO; 3]);
    for (number, sample) in samples.iter().enumerate() {
        let t = number as f64 / RATE;
        let terms = DVec3::new(1.0, t, 0.5 * t * t);
        normal += DMat3::from_cols(terms * terms.x, terms * terms.y, terms * terms.z);
        for (right, term) in right.iter_mut().zip(terms.to_array()) {
            *right += sample.position.with_z(0.0) * term;
        }
    }
    let inverse = normal.inverse();
    [0, 1, 2].map(|row| {
        let weights = inverse.row(row);
        right[0] * weights.x + right[1] * weights.y + right[2] * weights.z
    })
}
