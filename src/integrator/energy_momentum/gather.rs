//! The contacts that a step may reach.

use super::contacts::{Contacts, Reach};
use super::problem::Problem;
use crate::body::{ContactRange, RigidPointBody};
use crate::ground::Plane;
use crate::real::{Real, Vector};
use crate::scene::Dynamics;

/// Collects the contacts below the ground, and those that the initial motion brings near.
#[inline]
pub(super) fn gather_near<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &mut Contacts<R>,
) {
    contacts.clear();
    for surface in 0..problem.surfaces() {
        let reach = match problem.plane_of(surface) {
            Some(plane) => near_plane(problem, surface, &plane),
            None => near_surface(problem, surface),
        };
        contacts.gather(problem, surface, &reach);
    }
    contacts.thin_out(problem);
}

/// Collects all contacts.
#[cold]
#[inline(never)]
pub(super) fn gather_all<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &mut Contacts<R>,
) {
    contacts.clear();
    for surface in 0..problem.surfaces() {
        contacts.gather(problem, surface, &everything(problem, surface));
    }
    contacts.thin_out(problem);
}

/// All contacts, unless the surface is nowhere.
fn everything<R: Real, D: Dynamics<R>>(problem: &Problem<'_, R, D>, surface: u32) -> Reach<R> {
    let anywhere = !problem.scene.contact_model().is_nowhere(surface as usize);
    let all = ContactRange::all(problem.scene.body().contacts().len());
    Reach {
        range: if anywhere { all } else { ContactRange::NONE },
        is_everything: anywhere,
        with_rims: anywhere,
        ..Reach::NONE
    }
}

/// The contacts that a surface of any shape is so near to that the initial motion and gravity may
/// bring them there.
fn near_surface<R: Real, D: Dynamics<R>>(problem: &Problem<'_, R, D>, surface: u32) -> Reach<R> {
    let (scene, motion, dt) = (problem.scene, &problem.motion, problem.seconds);
    let spin = motion.angular_velocity.length();
    // A contact turns about the centre of mass by no more than a diameter.
    let turned = (dt * spin).at_most(R::TWO) * problem.bounding_radius;
    let fallen = dt * dt * scene.gravity().length();
    let path = motion.linear_velocity.length() * dt + turned + fallen;
    let model = scene.contact_model();
    Reach {
        range: model.range_of_surface(surface as usize, path, motion.position, &motion.axes),
        bend: path,
        with_rims: problem.has_rim_near(surface, path),
        ..Reach::NONE
    }
}

/// The contacts that are below a plane, and those that the initial motion brings near.
#[inline(always)]
fn near_plane<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    surface: u32,
    plane: &Plane<R>,
) -> Reach<R> {
    let (scene, motion, dt) = (problem.scene, &problem.motion, problem.seconds);
    let spin = motion.angular_velocity;
    // Upper bound for what gravity and the curvature of the rotation add to the path of a contact
    // along the normal.
    let bend =
        dt * dt * (scene.gravity().length() + spin.length_squared() * problem.bounding_radius);
    let bend = bend.at_most(R::TWO * problem.bounding_radius + dt * dt * scene.gravity().length());
    let fall = dt * -motion.linear_velocity.dot(plane.normal);
    let tilt = spin.cross(plane.normal);
    // For any number of revolutions, a contact stays within the bounding radius.
    let turned =
        (dt * tilt.length() * problem.bounding_radius).at_most(R::TWO * problem.bounding_radius);
    let margin = (fall + turned).at_least(R::ZERO) + bend;
    let model = scene.contact_model();
    Reach {
        range: model.range_of_surface(surface as usize, margin, motion.position, &motion.axes),
        is_everything: false,
        fall,
        tilt,
        bend,
        // A rim counts as a whole, because its lowest point may be another one at the end.
        with_rims: problem.has_rim_near(surface, margin),
    }
}
