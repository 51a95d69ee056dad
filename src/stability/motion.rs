//! The linear motion of a body near a state.

use super::response::Response;
use crate::real::Real;

/// Number of coordinates of a body.
const COORDINATES: usize = 6;
/// Number of coordinates and velocities.
pub(super) const SIZE: usize = 2 * COORDINATES;
/// Damping that may be rounding, in units in the last place of the matrices and in the unit of
/// frequency.
const ROUNDING: f64 = 1024.0;

/// Motion of a body near a state, `y'' + C y' + K y = 0` in six coordinates `y`.
///
/// The matrices K and C are the stiffness and the damping of contacts and forces. They need not be
/// symmetric, because friction grows with the load. The unit of time is such that the greatest
/// entry of C and the square root of that of K are at most 1. An integrator steps the motion in
/// [`linear_step`](crate::Integrator::linear_step).
#[derive(Clone, Debug)]
pub struct LinearMotion {
    stiffness: [[f64; COORDINATES]; COORDINATES],
    damping: [[f64; COORDINATES]; COORDINATES],
    /// Unit of frequency, 1/s.
    unit: f64,
    /// Damping that may be rounding, in the unit of frequency.
    pub(super) rounding: f64,
}

impl LinearMotion {
    /// Returns `None` if nothing depends on the motion, or if a number is not finite.
    pub(super) fn of<R: Real>(response: &Response<R>) -> Option<Self> {
        let (stiffness, damping) = (&response.stiffness, &response.damping);
        let unit = (stiffness.largest().to_f64().sqrt()).max(damping.largest().to_f64());
        (unit > 0.0 && unit.is_finite()).then(|| Self {
            stiffness: stiffness.0.map(|row| row.map(|k| k.to_f64() / unit / unit)),
            damping: damping.0.map(|row| row.map(|c| c.to_f64() / unit)),
            unit,
            rounding: R::EPSILON.to_f64() * ROUNDING,
        })
    }

    /// Returns `y''` for the coordinates `y` and the velocities `v = y'`.
    #[must_use]
    pub fn acceleration(&self, y: &[f64; 6], v: &[f64; 6]) -> [f64; 6] {
        let rows = self.stiffness.iter().zip(&self.damping);
        let mut acceleration = [0.0; COORDINATES];
        for (value, (k, c)) in acceleration.iter_mut().zip(rows) {
            *value = -(dot(k, y) + dot(c, v));
        }
        acceleration
    }

    /// Matrix A of `(y, y')' = A (y, y')`.
    pub(super) fn rates(&self) -> [[f64; SIZE]; SIZE] {
        columns(|[y, v]| [v, self.acceleration(&y, &v)])
    }

    /// Limit of a method for a mode with this stiffness and damping, in the unit of time. Infinite
    /// if it has none.
    pub(super) fn limit_of<R: Real>(
        &self,
        [stiffness, damping]: [f64; 2],
        limit: &impl Fn(R, R) -> Option<R>,
    ) -> f64 {
        let unit = self.unit;
        let [stiffness, damping] = [stiffness * unit * unit, damping * unit].map(R::from_f64);
        limit(stiffness, damping).map_or(f64::INFINITY, |limit| limit.to_f64() * unit)
    }

    /// Seconds of a number in the unit of time. `None` if it is not finite.
    pub(super) fn seconds<R: Real>(&self, time: f64) -> Option<R> {
        let seconds = R::from_f64(time / self.unit);
        (seconds < R::MAX).then_some(seconds)
    }
}

fn dot(a: &[f64; COORDINATES], b: &[f64; COORDINATES]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Returns `start + rate * factor`.
pub(crate) fn ahead(
    start: &[f64; COORDINATES],
    rate: &[f64; COORDINATES],
    factor: f64,
) -> [f64; COORDINATES] {
    let mut end = *start;
    (end.iter_mut().zip(rate)).for_each(|(value, rate)| *value += rate * factor);
    end
}

/// Returns the matrix of a linear function of coordinates and velocities.
pub(super) fn columns(
    function: impl Fn([[f64; COORDINATES]; 2]) -> [[f64; COORDINATES]; 2],
) -> [[f64; SIZE]; SIZE] {
    let mut rows = [[0.0; SIZE]; SIZE];
    for index in 0..SIZE {
        let mut start = [[0.0; COORDINATES]; 2];
        if let Some(one) = start.as_flattened_mut().get_mut(index) {
            *one = 1.0;
        }
        let end = function(start);
        for (row, value) in rows.iter_mut().zip(end.as_flattened()) {
            if let Some(entry) = row.get_mut(index) {
                *entry = *value;
            }
        }
    }
    rows
}
