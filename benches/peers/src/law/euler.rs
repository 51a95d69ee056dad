//! Euler's equations in body axes: the form in which one would write free rotation by hand.
//!
//! Seven numbers instead of thirteen. In body axes the inertia is diagonal and constant:
//!
//! ```text
//! q' = q (0, ω)/2          I ω' = (I ω) × ω
//! ```
//!
//! The centre of mass moves in closed form.

use tumble::State;
use tumble::glam::{DMat3, DQuat, DVec3};

use super::Law;

/// Unit quaternion from body to world axes, and angular velocity in body axes, rad/s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Free {
    pub(crate) orientation: DQuat,
    pub(crate) spin: DVec3,
}

impl Free {
    pub(crate) fn of(law: &Law, state: &State) -> Self {
        let axes = DMat3::from_quat(state.orientation);
        Self {
            orientation: state.orientation,
            spin: (axes.transpose() * state.angular_momentum) / law.inertia,
        }
    }

    /// Returns the whole state, `seconds` after `start`.
    pub(crate) fn state(&self, law: &Law, start: &State, seconds: f64) -> State {
        let orientation = self.orientation.normalize();
        let gravity = DVec3::NEG_Z * law.gravity;
        State {
            position: start.position
                + (start.linear_velocity + gravity * (0.5 * seconds)) * seconds,
            linear_velocity: start.linear_velocity + gravity * seconds,
            orientation,
            angular_momentum: orientation * (law.inertia * self.spin),
        }
    }

    pub(crate) fn rates(&self, inertia: DVec3) -> Self {
        Self {
            orientation: self.orientation * DQuat::from_vec4((0.5 * self.spin).extend(0.0)),
            spin: (inertia * self.spin).cross(self.spin) / inertia,
        }
    }

    fn moved(&self, rates: &Self, seconds: f64) -> Self {
        Self {
            orientation: self.orientation + rates.orientation * seconds,
            spin: self.spin + rates.spin * seconds,
        }
    }

    /// One step of the classical Runge-Kutta method of order 4.
    pub(crate) fn step(&self, inertia: DVec3, dt: f64) -> Self {
        let k1 = self.rates(inertia);
        let k2 = self.moved(&k1, 0.5 * dt).rates(inertia);
        let k3 = self.moved(&k2, 0.5 * dt).rates(inertia);
        let k4 = self.moved(&k3, dt).rates(inertia);
        let mut next = self.moved(&k1, dt / 6.0);
        next = next.moved(&k2, dt / 3.0);
        next = next.moved(&k3, dt / 3.0);
        next.moved(&k4, dt / 6.0)
    }
}
