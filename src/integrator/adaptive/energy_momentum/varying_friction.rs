//! Error of a step over ground whose friction varies: what a jump near an end of the step changes.
//!
//! The whole step takes the friction at its middle, at `s = 1/2` of its path, and its halves take
//! it at `s = 1/4` and `3/4`. A jump of the force by `ΔF` before the first of these positions or
//! after the last is not between any two of them, so that the difference of the results is 0. The
//! momentum is then wrong by up to `h ΔF/4`.
//!
//! *Estimate.* `(h/4) |F(0) - 2 F(1/4) + F(1/2)|` for the first half, and likewise for the second.
//! It is `h ΔF/4` or more for one jump anywhere, and 0 for a force that is linear in the path. For
//! a smooth force the two halves have `h³ |F''|/32`, three times the error of the midpoint rule,
//! `h³ |F''|/96`, which the difference of the results contains. So the estimate counts only where
//! it is [`BEYOND_SMOOTH`] times that of the difference.
//!
//! Only the position varies in `F`. The load and the slip of each contact are those at the middle.
//! A contact that does not touch there does not count.

use crate::contact::{Contact, Motion};
use crate::friction::SlidingFriction;
use crate::integrator::adaptive::embedded_pair::control::Errors;
use crate::integrator::point::Point;
use crate::real::{Real, Vector};
use crate::scene::Dynamics;
use crate::state::State;

/// Multiple of the error of a smooth force above which there is a jump.
pub(super) const BEYOND_SMOOTH: f64 = 4.0;

/// Returns the error of a step of `seconds` through three states, at its start, middle and end.
/// `None` if the friction is the same everywhere.
pub(super) fn error_of<R: Real, D: Dynamics<R>>(
    scene: &D,
    states: [&State<R>; 3],
    seconds: R,
) -> Option<Errors<R>> {
    if !scene.friction().depends_on_position() {
        return None;
    }
    let [start, middle, end] = states.map(|state| scene.motion(state));
    let quarter = seconds * R::from_f64(0.25);
    let of_half = |outer: &Motion<R>| {
        let change = second_difference(scene, &middle, outer);
        Errors::of(scene, &change.scaled(quarter), &middle)
    };
    Some(of_half(&start).plus(&of_half(&end)))
}

/// Returns the second difference of the friction on the path from the middle of a step to one of
/// its ends, as rates of change of the velocities.
fn second_difference<R: Real, D: Dynamics<R>>(
    scene: &D,
    middle: &Motion<R>,
    outer: &Motion<R>,
) -> Point<R> {
    let mut change = Point::zero();
    let inverse_mass = scene.inertia_properties().inverse_mass();
    let (ground, friction) = (scene.ground(), scene.friction());
    let turning = scene.contact_model().seen(middle).angular_velocity;
    scene.probe(|| {
        scene.visit_contacts(middle, |contact| {
            let displacement = displacement_to(scene, contact, middle, outer);
            let [near, between, far] = [0.0, 0.5, 1.0].map(|share| {
                let position = contact.position + displacement * R::from_f64(share);
                let moved = Contact {
                    position,
                    ..*contact
                };
                let torque = moved.turning_torque(ground, friction, turning);
                [moved.force(ground, friction), torque]
            });
            let [force, torque] =
                [0, 1].map(|part| (near[part] - between[part]) + (far[part] - between[part]));
            change.linear_velocity += force * inverse_mass;
            change.angular_momentum += contact.arm.cross(force) + torque;
        });
    });
    change
}

/// Returns the displacement of a contact from the middle of a step to one of its ends, m.
fn displacement_to<R: Real, D: Dynamics<R>>(
    scene: &D,
    contact: &Contact<R>,
    middle: &Motion<R>,
    outer: &Motion<R>,
) -> R::Vec3 {
    let of_centre = outer.position - middle.position;
    // Only a quadrature point of a rim has another weight. It and a contact that moves over the
    // body do not turn along with it.
    let is_fixed = scene.contact_model().moving_contact().is_none() && contact.weight == R::ONE;
    if is_fixed {
        of_centre + (contact.arm_along(&outer.axes) - contact.arm)
    } else {
        of_centre
    }
}
