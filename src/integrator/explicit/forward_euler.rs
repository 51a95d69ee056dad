//! Forward Euler method of the coin report, with an exact rotation.

use crate::body::ContactRange;
use crate::error::{self, SceneError, StepError};
use crate::integrator::interface::{Integrator, Step, step_length};
use crate::real::Real;
use crate::rotation::Rotation;
use crate::scene::Dynamics;
use crate::state::State;

/// Forward Euler method in the order of operations of the coin report, applied to a plain state.
///
/// The body rotates exactly about its angular velocity.
///
/// ```text
/// ω = J⁻¹ L;   q' = exp(dt ω) q;   x' = x + dt v;   v' = v + dt (F/m + g);   L' = L + dt Σ r' × F
/// ```
/// Here x and v are position and velocity of the centre of mass, q is the orientation, L the
/// angular momentum, J the inertia tensor, m the mass and g gravity. F is a force (in `F/m` the
/// sum of all forces), and r' its arm after the rotation. A prime marks the end of the step.
///
/// The forces are those at the old positions and velocities. The torque uses the *new* arms r' with
/// these old forces. The loop of the report computes the slip velocity from the angular velocity of
/// the previous step. A plain state does not hold it, so the two differ by O(dt).
///
/// Order 1, with one force evaluation per step.
///
/// *Adds energy.* Free flight gains `m g² dt²/2` per step. A contact loses `stiffness · dt` of its
/// damping. An underdamped contact is therefore stable only for `dt < damping/stiffness`, in any
/// pose.
///
/// Kept as the baseline. [`SymplecticEuler`](crate::SymplecticEuler) has the same cost and should
/// be used instead.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ForwardEuler<R = f64> {
    /// Step size, s, above 0.
    pub time_step: R,
}

impl<R: Real> Integrator<R> for ForwardEuler<R> {
    /// Contact range of the previous step, in which the next step searches first.
    type Workspace = ContactRange;

    #[inline]
    fn step<D: Dynamics<R>>(
        &self,
        scene: &D,
        state: &mut State<R>,
        limit: R,
        near: &mut ContactRange,
    ) -> Result<Step<R>, StepError> {
        let dt = step_length(self.time_step, limit);
        let mass = scene.inertia_properties();
        let old_rotation = state.rotation();
        let motion = scene.motion_along(state, old_rotation.axes());
        let turn = Rotation::from_half_vector(motion.angular_velocity * (dt * R::HALF));
        let rotation = turn.after(old_rotation).normalised();
        *near = scene
            .contact_model()
            .range_near(*near, motion.position, &motion.axes);
        let contacts = scene
            .contact_model()
            .load_with_arms(*near, &motion, Some(&rotation.axes()));
        let load = scene.with_applied_force(contacts, &motion);

        state.position += state.linear_velocity * dt;
        state.linear_velocity += (load.force * mass.inverse_mass() + scene.gravity()) * dt;
        state.angular_momentum += load.torque * dt;
        state.orientation = rotation.to_quat();
        Ok(Step::new(dt, 1))
    }

    fn order(&self) -> u32 {
        1
    }

    fn fixed_step(&self) -> Option<R> {
        Some(self.time_step)
    }

    /// The amplification factor `z` of a step obeys `(z - 1)² + (z - 1) Y + X = 0` with
    /// `X = stiffness h²`, `Y = damping h`. `|z| < 1` for `X < Y` and `2 Y - X < 4`.
    fn largest_stable_step(&self, stiffness: R, damping: R) -> Option<R> {
        let by_spring = damping / stiffness;
        let discriminant = damping * damping - stiffness * R::from_f64(4.0);
        if discriminant < R::ZERO {
            return Some(by_spring);
        }
        let by_damper = R::from_f64(4.0) / (damping + discriminant.sqrt());
        // Without springs and dampers `by_spring` is no number, and the limit infinite.
        Some(by_spring.at_most(by_damper))
    }

    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("time step", self.time_step, " s")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step multiplies the motion by `z = 1 + w` with `w² + w Y + X = 0`.
    fn largest_factor(stiffness: f64, damping: f64, h: f64) -> f64 {
        let (x, y) = (stiffness * h * h, damping * h);
        let discriminant = y * y - 4.0 * x;
        if discriminant < 0.0 {
            // |z|² is the product of the two roots z.
            (1.0 - y + x).sqrt()
        } else {
            let root = discriminant.sqrt();
            (1.0 - 0.5 * (y - root))
                .abs()
                .max((1.0 - 0.5 * (y + root)).abs())
        }
    }

    #[test]
    fn the_largest_stable_step_is_where_a_step_no_longer_shrinks_the_motion() {
        let method = ForwardEuler { time_step: 1.0 };
        for (stiffness, damping) in [
            (4.0, 5.0),
            (4.0, 1.0),
            (9.0, 100.0),
            (2.0, 3.0),
            (50.0, 14.0),
        ] {
            let limit = method.largest_stable_step(stiffness, damping).unwrap();
            let factor = |share: f64| largest_factor(stiffness, damping, share * limit);
            assert!(factor(0.99) < 1.0, "{stiffness} {damping}");
            assert!(factor(1.01) > 1.0, "{stiffness} {damping}");
        }
    }
}
