//! Early end of a toss whose coin rolls upright.
//!
//! It is a heuristic, and no proof: an upright coin may still fall. A coin with the radius r, the
//! thickness t and the mass m stands in a well of depth `m g (√(r² + t²/4) - r)`, and tips over
//! beyond the tilt `a = atan(t/(2 r))`. It counts as upright if, for 50 ms at each step,
//!
//! - its tilt is below a quarter of a,
//! - the energies of rocking and of its vertical motion are each below a tenth of the well,
//! - the gyroscopic moment of rolling along a curve, `(J + m r²) ω Ω`, is below half of the moment
//!   `m g t/2` of its weight about a rim. J is the axial moment of inertia, ω the rate of rolling
//!   and Ω the rate about the vertical.

use core::ops::ControlFlow;

use tumble::glam::DVec3;
use tumble::{Observer, Sample, State};

use crate::profile::Measures;

/// Time for which the coin must be upright, s.
const SECONDS: f64 = 0.05;
/// Largest fraction of the tilt at which the coin tips over.
const TILT: f64 = 0.25;
/// Largest fraction of the depth of the well.
const ENERGY: f64 = 0.1;
/// Largest fraction of the moment of the weight.
const MOMENT: f64 = 0.5;

/// Ends a run when the coin has been upright for a time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UntilUpright {
    coin: Measures,
    gravity: f64,
    /// Time since which it is upright, s.
    since: Option<f64>,
    is_reached: bool,
}

impl UntilUpright {
    pub(crate) fn new(coin: Measures, gravity: f64) -> Self {
        Self {
            coin,
            gravity,
            since: None,
            is_reached: false,
        }
    }

    pub(crate) fn is_reached(&self) -> bool {
        self.is_reached
    }

    fn is_upright(&self, state: &State) -> bool {
        let Measures {
            mass,
            radius,
            thickness,
        } = self.coin;
        let half = 0.5 * thickness;
        let normal = state.orientation * DVec3::X;
        if normal.z.abs() > TILT * (half / radius).atan() {
            return false;
        }
        let moments = self.coin.inertia();
        let [axial, transverse] = [moments.x_axis.x, moments.y_axis.y];
        let about_axis = state.angular_momentum.dot(normal);
        let across = state.angular_momentum - normal * about_axis;
        let (rolling, spin) = (about_axis / axial, across / transverse);
        // The axis along which an upright coin rolls is the one about which it rocks.
        let rocking = spin.dot(normal.cross(DVec3::Z).normalize());
        let about_ground = mass * radius * radius;
        let weight = mass * self.gravity;
        let most = ENERGY * weight * (radius.hypot(half) - radius);
        let moment = (axial + about_ground) * rolling * spin.z;
        0.5 * (transverse + about_ground) * rocking * rocking < most
            && 0.5 * mass * state.linear_velocity.z.powi(2) < most
            && moment.abs() < MOMENT * weight * half
    }
}

impl Observer for UntilUpright {
    fn observe(&mut self, sample: &Sample<'_>) -> ControlFlow<()> {
        if !self.is_upright(sample.state) {
            self.since = None;
            return ControlFlow::Continue(());
        }
        let since = *self.since.get_or_insert(sample.time);
        self.is_reached = sample.time - since >= SECONDS;
        match self.is_reached {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}
