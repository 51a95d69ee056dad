//! Contacts that close and open again within one step.
//!
//! Both ends of the step are above ground, so neither the correction of touch-downs nor, in
//! general, a stage contains them. The path between the ends shows them.

use crate::body::RigidPointBody;
use crate::contact::Motion;
use crate::integrator::contact_path::{ContactView, Path, push};
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, OnSurface, size};

/// Returns the velocity of the farthest point that such contacts would have changed, m/s.
///
/// The force is at most that at the greatest depth, for the whole step.
#[inline]
pub(super) fn missed<R: Real, D: Dynamics<R>>(scene: &D, ends: [&Motion<R>; 2], seconds: R) -> R {
    let mut speed = R::ZERO;
    let margin = reach(scene, ends, seconds);
    for surface in 0..scene.contact_model().surfaces() {
        let scene = OnSurface::of(scene, surface);
        speed += missed_on(&scene, ends, seconds, margin);
    }
    speed
}

#[inline]
fn missed_on<R: Real, D: Dynamics<R>>(
    scene: &D,
    ends: [&Motion<R>; 2],
    seconds: R,
    margin: R,
) -> R {
    let contacts = scene.body().contacts();
    let near = |motion: &Motion<R>| {
        (scene.contact_model()).range_within(margin, motion.position, &motion.axes)
    };
    let [first, last] = ends.map(|motion| ContactView::of(scene, motion));
    let (before, after) = (near(ends[0]), near(ends[1]));
    let mut force = R::ZERO;
    for run in [before]
        .into_iter()
        .chain(after.without(before, contacts.len()))
    {
        for point in run.parts(contacts).into_iter().flatten() {
            let (start, end) = (first.side(point), last.side(point));
            if start.depth > R::ZERO || end.depth > R::ZERO {
                continue;
            }
            let path = Path::between(&start, &end, seconds);
            if path.turns_under_ground() {
                let (depth, _) = path.at(path.turn());
                force += push(scene, depth, R::ZERO);
            }
        }
    }
    let properties = scene.inertia_properties();
    let arm = size(scene);
    let mobility = properties.inverse_mass() + properties.largest_inverse_moment() * (arm * arm);
    force * (mobility * seconds)
}

/// Returns the greatest depth that a contact can reach between two ends above ground, m.
///
/// A path with the end slopes `m₀ > 0` and `m₁ < 0` by the fraction of the step descends by at most
/// `|m₁ - m₀|/8` below the higher end, and by `m₀` at most. The slopes of all contacts differ by at
/// most the change of the velocities in the step.
#[inline]
fn reach<R: Real, D: Dynamics<R>>(scene: &D, [start, end]: [&Motion<R>; 2], seconds: R) -> R {
    let bounding_radius = scene.bounding_radius();
    let change = (end.linear_velocity - start.linear_velocity).length();
    let spin = start
        .angular_velocity
        .length()
        .at_least(end.angular_velocity.length());
    let turning = (end.angular_velocity - start.angular_velocity).length();
    let rotation = (turning + spin * spin * seconds) * bounding_radius;
    (change + rotation) * (seconds * R::from_f64(0.125))
}
