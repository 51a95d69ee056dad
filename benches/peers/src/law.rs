//! The point law in plain numbers: what every program but rapier integrates, and what the energies are computed by.

use tumble::glam::{DMat3, DQuat, DVec3};
use tumble::{ContactPoint, State};

/// One body of contact points on a level spring-damper ground at z = 0, with Coulomb's friction made finite at zero slip. SI units.
#[derive(Clone, Debug)]
pub(crate) struct Law {
    pub(crate) mass: f64,
    /// Principal moments, along the body's axes.
    pub(crate) inertia: DVec3,
    /// None where the body is in free flight.
    pub(crate) contacts: Vec<ContactPoint>,
    /// N/m a contact.
    pub(crate) stiffness: f64,
    /// N s/m a contact.
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

    /// The loop over all points, as anyone would write it.
    pub(crate) fn load(&self, state: &State) -> Load {
        let axes = DMat3::from_quat(state.orientation.normalize());
        let spin = self.spin(axes, state.angular_momentum);
        let mut force = DVec3::new(0.0, 0.0, -self.mass * self.gravity);
        let mut torque = DVec3::ZERO;
        for contact in &self.contacts {
            let arm = axes * contact.position - DVec3::Z * contact.radius;
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
        }
        Load { force, torque }
    }

    /// Kinetic energy and that of gravity, J.
    pub(crate) fn energy_without_springs(&self, state: &State) -> f64 {
        let axes = DMat3::from_quat(state.orientation.normalize());
        let spin = self.spin(axes, state.angular_momentum);
        0.5 * self.mass * state.linear_velocity.length_squared()
            + 0.5 * spin.dot(state.angular_momentum)
            + self.mass * self.gravity * state.position.z
    }

    /// The height at which the springs carry the weight of a body that is turned so, m, by bisection.
    pub(crate) fn height_at_rest(&self, orientation: DQuat) -> f64 {
        let reach = self.reach();
        let (mut low, mut high) = (-reach, reach);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            let state = State::at(DVec3::Z * middle).with_orientation(orientation);
            if self.load(&state).force.z > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    /// Distance from the centre of mass to the farthest place of the surface, m.
    pub(crate) fn reach(&self) -> f64 {
        (self.contacts.iter())
            .map(|contact| contact.position.length() + contact.radius)
            .fold(0.0, f64::max)
    }
}
