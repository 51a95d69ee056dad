//! A fixed-step Rk4 on the point law, as a user would write it in an hour, for comparison with the
//! library.
//!
//! It evaluates all points in each stage, and treats a quaternion as four more numbers.

use tumble::glam::{DMat3, DQuat, DVec3};
use tumble::{ContactPoint, State};

/// One body of contact points on a level spring-damper ground at z = 0, with Coulomb friction that
/// is finite at zero slip. SI units.
#[derive(Clone, Debug)]
pub(crate) struct Law {
    pub(crate) mass: f64,
    /// Principal moments along the body axes, kg m².
    pub(crate) inertia: DVec3,
    /// Contact points. Empty for a body in free flight.
    pub(crate) contacts: Vec<ContactPoint>,
    /// Radius of a round rim about the body's x axis that touches at its lowest point alone, m;
    /// 0 for none.
    pub(crate) rim: f64,
    /// Stiffness of a contact, N/m.
    pub(crate) stiffness: f64,
    /// Damping of a contact, N s/m.
    pub(crate) damping: f64,
    pub(crate) coefficient: f64,
    pub(crate) slip_speed: f64,
    pub(crate) gravity: f64,
}

/// Force and torque about the centre of mass, world axes.
pub(crate) struct Load {
    pub(crate) force: DVec3,
    pub(crate) torque: DVec3,
}

impl Law {
    /// Angular velocity, world axes.
    pub(crate) fn spin(&self, axes: DMat3, angular_momentum: DVec3) -> DVec3 {
        axes * ((axes.transpose() * angular_momentum) / self.inertia)
    }

    /// Force and torque, summed over all points.
    pub(crate) fn load(&self, state: &State) -> Load {
        let axes = DMat3::from_quat(state.orientation.normalize());
        let spin = self.spin(axes, state.angular_momentum);
        let mut force = DVec3::new(0.0, 0.0, -self.mass * self.gravity);
        let mut torque = DVec3::ZERO;
        let mut add = |arm: DVec3| {
            let depth = -(state.position.z + arm.z);
            if depth > 0.0 {
                let velocity = state.linear_velocity + spin.cross(arm);
                let normal = (self.stiffness * depth - self.damping * velocity.z).max(0.0);
                let slip = velocity.with_z(0.0);
                let friction =
                    slip * (-self.coefficient * normal / (slip.length() + self.slip_speed));
                let push = friction.with_z(normal);
                force += push;
                torque += arm.cross(push);
            }
        };
        for contact in &self.contacts {
            add(axes * contact.position - DVec3::Z * contact.radius);
        }
        if self.rim > 0.0 {
            let normal = axes.x_axis;
            let down = normal * normal.z - DVec3::Z;
            add(down.normalize() * self.rim);
        }
        Load { force, torque }
    }
}

/// Rates of change of the four parts of a state.
#[derive(Clone, Copy)]
pub(crate) struct Rates {
    pub(crate) position: DVec3,
    pub(crate) velocity: DVec3,
    pub(crate) orientation: DQuat,
    pub(crate) angular_momentum: DVec3,
}

/// Rates of a state: `x' = v`, `v' = F/m`, `q' = ω q/2`, `L' = T`.
pub(crate) fn rates(law: &Law, state: &State) -> Rates {
    let load = law.load(state);
    let axes = DMat3::from_quat(state.orientation.normalize());
    let spin = law.spin(axes, state.angular_momentum);
    Rates {
        position: state.linear_velocity,
        velocity: load.force / law.mass,
        orientation: DQuat::from_vec4((0.5 * spin).extend(0.0)) * state.orientation,
        angular_momentum: load.torque,
    }
}

/// Returns the state after `dt` (s).
pub(crate) fn step(law: &Law, state: &State, dt: f64) -> State {
    let k1 = rates(law, state);
    let k2 = rates(law, &moved(state, &k1, 0.5 * dt));
    let k3 = rates(law, &moved(state, &k2, 0.5 * dt));
    let k4 = rates(law, &moved(state, &k3, dt));
    let mut next = moved(state, &k1, dt / 6.0);
    next = moved(&next, &k2, dt / 3.0);
    next = moved(&next, &k3, dt / 3.0);
    next = moved(&next, &k4, dt / 6.0);
    next.with_orientation(next.orientation.normalize())
}

fn moved(state: &State, rates: &Rates, dt: f64) -> State {
    State {
        position: state.position + rates.position * dt,
        linear_velocity: state.linear_velocity + rates.velocity * dt,
        orientation: state.orientation + rates.orientation * dt,
        angular_momentum: state.angular_momentum + rates.angular_momentum * dt,
    }
}
