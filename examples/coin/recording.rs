//! Recorded data of a run: moments, about a hundred for each second, and the energy audit.

use tumble::glam::{DQuat, DVec3};
use tumble::{Dissipation, Energy};

use crate::setup::Setup;
use crate::tally::Tally;

/// A completed run. SI units, world axes: x and y along the floor, z up.
#[derive(Debug)]
pub(crate) struct Recording {
    pub(crate) setup: Setup,
    /// Moments in order of time, never empty.
    pub(crate) moments: Vec<Moment>,
    pub(crate) audit: Option<Audit>,
    /// Sums over the steps of the integrator. The report's loop has none.
    pub(crate) tally: Tally,
    /// Processing time of the computer, s.
    pub(crate) wall_time: f64,
}

/// The coin at one moment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    pub(crate) time: f64,
    pub(crate) centre: DVec3,
    pub(crate) velocity: DVec3,
    /// Rotation from body to world axes. The body's x axis is the normal of the coin.
    pub(crate) orientation: DQuat,
    pub(crate) angular_momentum: DVec3,
    /// Position of the lowest point of the rim.
    pub(crate) lowest: DVec3,
    /// Speed of the lowest point along the floor.
    pub(crate) slip: f64,
    /// Angle between the coin's plane and the floor, rad: π/2 for an upright coin.
    pub(crate) tilt: f64,
    /// Number of points in contact.
    pub(crate) touching: usize,
    /// Energy by kind, J. That of gravity is zero with the centre at the height of the floor.
    pub(crate) energy: Energy,
}

/// Energy dissipated since the start, by cause.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Audit {
    /// Work of friction, dampers and clamp, J. Losses are negative.
    pub(crate) work: Dissipation,
    /// Unaccounted energy, J: the energy error of the method.
    pub(crate) energy_error: f64,
}

impl Recording {
    pub(crate) fn first(&self) -> &Moment {
        &self.moments[0]
    }

    pub(crate) fn last(&self) -> &Moment {
        &self.moments[self.moments.len() - 1]
    }

    /// Returns the moments up to a time, or all of them.
    pub(crate) fn until(&self, end: Option<f64>) -> &[Moment] {
        let end = end.unwrap_or(f64::INFINITY);
        let count = self.moments.partition_point(|moment| moment.time <= end);
        &self.moments[..count]
    }
}
