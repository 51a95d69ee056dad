//! What friction removes of an error in the velocities.
//!
//! A step that does not resolve the friction of a contact that sticks has large errors of the
//! velocities. They do little harm, because friction removes them at once. Friction that acts like
//! a damper `c = |f|/|slip|` at each contact for the time `T` leaves of an error `δu` of the six
//! velocities, by one implicit step of Euler,
//!
//! ```text
//! (M + T Σ Jᵀ c P J) δu' = M δu
//! ```
//! Here M is the matrix of mass and inertia, J gives the velocity of a contact, and P is the
//! projection onto the ground.
//!
//! A contact whose slip increases is left out. Its friction cannot stop the slip, and an error
//! along the slip remains. This distinguishes a reversal of the slip, which a step must resolve,
//! from stick, where a numerical slip reverses in each step.

use crate::contact::{Contact, Motion};
use crate::friction::SlidingFriction;
use crate::ground::SpringDamperGround;
use crate::integrator::explicit::Stage;
use crate::integrator::linear::{Factored, SixBySix};
use crate::integrator::matrix3::Matrix3;
use crate::integrator::point::Point;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, size};

/// Time for which an error of the velocities lasts, and in which friction removes it, s.
pub(super) const HORIZON: f64 = 0.01;

/// Equations of what the friction at the end of a step leaves of an error.
pub(super) struct Damping<R: Real> {
    equations: Factored<R>,
    mass: R,
    inertia: Matrix3<R>,
    size: R,
}

impl<R: Real> Damping<R> {
    #[inline(never)]
    pub(super) fn of<D: Dynamics<R>>(scene: &D, point: &Point<R>, end: &Stage<R>) -> Self {
        let properties = scene.inertia_properties();
        let motion = &end.motion;
        let ([x, y, z], _) = properties.inertia_for_solving(&motion.axes, point.angular_momentum);
        let inertia = Matrix3 { x, y, z };
        let torque = end.torque - motion.angular_velocity.cross(point.angular_momentum);
        let rotational_acceleration = properties.angular_velocity(&motion.axes, torque);
        let mut equations = SixBySix::of_body(properties.mass(), &inertia);
        scene.contact_model().visit(motion, |contact| {
            let acceleration =
                end.acceleration + acceleration_at(contact.arm, motion, rotational_acceleration);
            if contact.slip_velocity.dot(acceleration) <= R::ZERO {
                let along = damper(scene, contact) * R::from_f64(HORIZON);
                let normal = contact.normal;
                let block = Matrix3::diagonal(along).plus(&Matrix3::outer(normal * -along, normal));
                equations.add_at(&block, contact.arm, contact.arm);
            }
        });
        // A point has no size. Its equations need no scale of length.
        let size = if size(scene) > R::ZERO {
            size(scene)
        } else {
            R::ONE
        };
        Self {
            equations: Factored::of(equations, size),
            mass: properties.mass(),
            inertia,
            size,
        }
    }

    /// Returns what friction leaves of a `difference` of velocity and angular momentum.
    pub(super) fn remaining(&self, difference: &Point<R>) -> Point<R> {
        let momentum = difference.linear_velocity * self.mass;
        let (velocity, spin) =
            (self.equations).solve(momentum, difference.angular_momentum, self.size);
        Point {
            linear_velocity: velocity,
            angular_momentum: self.inertia.times(spin),
            ..*difference
        }
    }
}

/// Returns the acceleration of a point of the body relative to the centre of mass, m/s².
fn acceleration_at<R: Real>(
    arm: R::Vec3,
    motion: &Motion<R>,
    rotational_acceleration: R::Vec3,
) -> R::Vec3 {
    let spin = motion.angular_velocity;
    rotational_acceleration.cross(arm) + spin.cross(spin.cross(arm))
}

/// Returns the damper that has the friction of a contact at its slip, N s/m. It is 0 without slip.
fn damper<R: Real, D: Dynamics<R>>(scene: &D, contact: &Contact<R>) -> R {
    let (ground, friction) = contact.laws(scene.ground(), scene.friction());
    let normal_force = ground.normal_force(contact.depth, contact.closing_speed);
    let force = friction.force_at(contact.position, normal_force, contact.slip_velocity);
    let damper = force.length() * contact.weight / contact.slip_velocity.length();
    if damper.is_finite() { damper } else { R::ZERO }
}
