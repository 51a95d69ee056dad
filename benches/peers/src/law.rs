//! The point law in plain numbers, which every program except rapier integrates. It also computes
//! the energies of all programs.

pub(crate) mod euler;
#[path = "../../../examples/common/plain_rk4.rs"]
mod plain_rk4;

pub(crate) use plain_rk4::{Law, rates, step};
use tumble::State;
use tumble::glam::{DMat3, DQuat, DVec3};

impl Law {
    /// Kinetic energy and energy of gravity, J.
    pub(crate) fn energy_without_springs(&self, state: &State) -> f64 {
        let axes = DMat3::from_quat(state.orientation.normalize());
        let spin = self.spin(axes, state.angular_momentum);
        0.5 * self.mass * state.linear_velocity.length_squared()
            + 0.5 * spin.dot(state.angular_momentum)
            + self.mass * self.gravity * state.position.z
    }

    /// Height at which the springs support the weight of a body with this orientation, m, by
    /// bisection.
    pub(crate) fn height_at_rest(&self, orientation: DQuat) -> f64 {
        let bounding_radius = self.bounding_radius();
        let (mut low, mut high) = (-bounding_radius, bounding_radius);
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

    /// Distance from the centre of mass to the farthest point of the surface, m.
    pub(crate) fn bounding_radius(&self) -> f64 {
        (self.contacts.iter())
            .map(|contact| contact.position.length() + contact.radius)
            .fold(self.rim, f64::max)
    }
}
