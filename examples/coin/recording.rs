//! What is kept of a run: moments, about a hundred for each second, and the books.

use tumble::glam::{DQuat, DVec3};
use tumble::{Dissipation, Energy};

use crate::setup::Setup;
use crate::tally::Tally;

/// A run that is over. SI units, world axes: x and y along the floor, z up.
#[derive(Debug)]
pub(crate) struct Recording {
    pub(crate) setup: Setup,
    /// In the order of time, never empty.
    pub(crate) moments: Vec<Moment>,
    pub(crate) books: Option<Books>,
    /// What the integrator's steps reported; no steps where the report's loop ran.
    pub(crate) tally: Tally,
    /// Seconds that the computer took.
    pub(crate) wall_time: f64,
}

/// The coin at one moment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    pub(crate) time: f64,
    pub(crate) centre: DVec3,
    pub(crate) velocity: DVec3,
    /// Body to world. The body's x axis is the normal of the coin.
    pub(crate) orientation: DQuat,
    pub(crate) angular_momentum: DVec3,
    /// The lowest point of the rim.
    pub(crate) lowest: DVec3,
    /// Speed of that point along the floor.
    pub(crate) slip: f64,
    /// Angle between the coin's plane and the floor, radians: a quarter turn when it stands.
    pub(crate) tilt: f64,
    /// Number of points in contact.
    pub(crate) touching: usize,
    /// Joules; that of gravity is zero with the centre at the height of the floor.
    pub(crate) energy: Energy,
}

/// Where the energy went since the start.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Books {
    /// Work of friction, dampers and clamp, joules; losses are negative.
    pub(crate) work: Dissipation,
    /// What they do not explain, joules: the error of the method.
    pub(crate) residue: f64,
}

impl Recording {
    pub(crate) fn first(&self) -> &Moment {
        &self.moments[0]
    }

    pub(crate) fn last(&self) -> &Moment {
        &self.moments[self.moments.len() - 1]
    }

    /// The moments up to a time, or all of them.
    pub(crate) fn until(&self, end: Option<f64>) -> &[Moment] {
        let end = end.unwrap_or(f64::INFINITY);
        let count = self.moments.partition_point(|moment| moment.time <= end);
        &self.moments[..count]
    }
}
