//! A rigid hoop on a rigid floor: the limit of the trials on rigid ground.
//!
//! The lowest point of a smooth rim stays on the floor, which exerts the constraint force, and
//! Coulomb's friction acts there. The hoop is the limit of the point law for a stiff ground and
//! many points, and it is what rapier solves.

use ode_solvers::System;
use tumble::State;
use tumble::glam::{DMat3, DQuat, DVec3};

use super::GRAVITY;
use crate::programs::ode::{Method, Span, Vector, solve};

/// A hoop of 1 kg and 0.5 m.
struct RigidHoop {
    coefficient: f64,
    slip_speed: f64,
}

const RADIUS: f64 = 0.5;
const MASS: f64 = 1.0;
/// Moments of inertia, kg m²: about the normal, and about a diameter.
const MOMENTS: (f64, f64) = (0.25, 0.125);

/// Returns the state of the hoop after `seconds`.
pub(super) fn after(start: &State, coefficient: f64, seconds: f64) -> Result<State, String> {
    let hoop = RigidHoop {
        coefficient,
        // Small compared with slips of some cm/s: a tenth of it changes the result of trial 1 by
        // 1e-5 m.
        slip_speed: 1e-4,
    };
    let span = Span {
        end: seconds,
        sample: None,
        most_steps: 500_000,
    };
    let (y, _) = solve(hoop, Method::Dop853, span, pack(start), 1e-10)?;
    Ok(unpack(&y))
}

fn pack(state: &State) -> Vector {
    let (x, v, l) = (
        state.position,
        state.linear_velocity,
        state.angular_momentum,
    );
    let q = state.orientation;
    Vector::from([
        x.x, x.y, x.z, v.x, v.y, v.z, q.x, q.y, q.z, q.w, l.x, l.y, l.z,
    ])
}

fn unpack(y: &Vector) -> State {
    let vector = |i: usize| DVec3::new(y[i], y[i + 1], y[i + 2]);
    State {
        position: vector(0),
        linear_velocity: vector(3),
        orientation: DQuat::from_xyzw(y[6], y[7], y[8], y[9]).normalize(),
        angular_momentum: vector(10),
    }
}

/// Quantities of a state that the equations contain.
struct Pose {
    axes: DMat3,
    spin: DVec3,
    /// Vector from the centre to the lowest point of the rim.
    arm: DVec3,
}

impl RigidHoop {
    fn pose(state: &State) -> Pose {
        let axes = DMat3::from_quat(state.orientation);
        let moments = DVec3::new(MOMENTS.0, MOMENTS.1, MOMENTS.1);
        let normal = axes.x_axis;
        // The downward direction, minus its component along the normal.
        let down = (normal * normal.z - DVec3::Z).normalize();
        Pose {
            axes,
            spin: axes * ((axes.transpose() * state.angular_momentum) / moments),
            arm: down * RADIUS,
        }
    }

    /// Force and torque for a normal force of `push` newtons.
    fn load(&self, state: &State, pose: &Pose, push: f64) -> (DVec3, DVec3) {
        let slip = (state.linear_velocity + pose.spin.cross(pose.arm)).with_z(0.0);
        let friction = slip * (-self.coefficient * push / (slip.length() + self.slip_speed));
        let at_contact = friction.with_z(push);
        let weight = DVec3::Z * (-MASS * GRAVITY);
        (at_contact + weight, pose.arm.cross(at_contact))
    }

    /// Second time derivative of the lowest point's height `z - r √(1 - n²)` for a normal force,
    /// with `n` the vertical component of the normal.
    fn lift(&self, state: &State, pose: &Pose, push: f64) -> f64 {
        let (force, torque) = self.load(state, pose, push);
        let (spin, normal) = (pose.spin, pose.axes.x_axis);
        // I ω' = T - ω × L, in body axes.
        let moments = DVec3::new(MOMENTS.0, MOMENTS.1, MOMENTS.1);
        let turning = torque - spin.cross(state.angular_momentum);
        let spin_rate = pose.axes * ((pose.axes.transpose() * turning) / moments);
        let n = normal.z;
        let n1 = spin.cross(normal).z;
        let n2 = (spin_rate.cross(normal) + spin.cross(spin.cross(normal))).z;
        let root = (1.0 - n * n).sqrt();
        // d²/dt² of -√(1 - n²).
        let sagging = (n1 * n1 + n * n2) / root + (n * n1) * (n * n1) / root.powi(3);
        force.z / MASS + RADIUS * sagging
    }
}

impl System<f64, Vector> for RigidHoop {
    fn system(&self, _: f64, y: &Vector, dy: &mut Vector) {
        let state = unpack(y);
        let pose = Self::pose(&state);
        // The acceleration is linear in the normal force, and the floor does not pull.
        let (free, pushed) = (self.lift(&state, &pose, 0.0), self.lift(&state, &pose, 1.0));
        let push = (-free / (pushed - free)).max(0.0);
        let (force, torque) = self.load(&state, &pose, push);
        let turn = DQuat::from_vec4((0.5 * pose.spin).extend(0.0)) * state.orientation;
        *dy = pack(&State {
            position: state.linear_velocity,
            linear_velocity: force / MASS,
            orientation: turn,
            angular_momentum: torque,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::coins;

    /// Checks that the steady circle of the closed form is a solution of these equations.
    #[test]
    fn the_hoop_rolls_round_the_circle_of_the_closed_form() {
        let (start, answer) = coins::circle(1.0);
        let end = after(&start, 0.3, 1.0).unwrap();
        // The slip speed of friction lets the rim creep by about 0.8e-4 m/s.
        assert!(
            (end.position - answer.position).length() < 2e-4,
            "{end:?} {answer:?}"
        );
    }
}
