//! Contacts that close and open again within one step.
//!
//! Both ends of the step are above ground, so neither the correction of touch-downs nor, in
//! general, a stage contains them. The path between the ends shows them.

use core::cell::Cell;

use crate::body::RigidPointBody;
use crate::contact::Motion;
use crate::integrator::adaptive::{bounce, edge};
use crate::integrator::contact_path::{ContactView, Path, path_error, push};
use crate::integrator::point::Point;
use crate::real::Real;
use crate::scene::{Dynamics, OnSurface, mobility};

/// Returns the velocity of the farthest point that such contacts would have changed, m/s, or have
/// changed too much.
///
/// The force is at most that at the greatest depth, for the whole step. If the step has gained
/// energy, a contact that a stage has met has pushed too much.
#[inline]
pub(super) fn missed<R: Real, D: Dynamics<R>>(
    scene: &D,
    points: [&Point<R>; 2],
    ends: [&Motion<R>; 2],
    seconds: R,
) -> R {
    let mut impulse = R::ZERO;
    let margin = bounce::reach(scene, ends, seconds);
    let gained = Cell::new(None);
    let energy_gained = || bounce::once(&gained, || bounce::energy_gained(scene, points));
    for surface in 0..scene.contact_model().surfaces() {
        let scene = OnSurface::of(scene, surface);
        let distances = [margin, path_error(&scene, ends, seconds)];
        let (of_contacts, touches) = missed_on(&scene, ends, (seconds, distances), &energy_gained);
        impulse += of_contacts;
        if let Some(brush) = edge::brush(&scene, points, (ends, touches), seconds) {
            impulse += brush.force * seconds;
        }
    }
    impulse * mobility(scene)
}

/// Impulse of such contacts on one surface, N s, and whether the body touches it at both ends.
///
/// The distances are that within which contacts count as near, and the error of their paths.
#[inline]
fn missed_on<R: Real, D: Dynamics<R>>(
    scene: &D,
    ends: [&Motion<R>; 2],
    (seconds, [margin, path_error]): (R, [R; 2]),
    energy_gained: &dyn Fn() -> R,
) -> (R, [bool; 2]) {
    let contacts = scene.body().contacts();
    let near = |motion: &Motion<R>| {
        (scene.contact_model()).range_within(margin, motion.position, &motion.axes)
    };
    let [first, last] = ends.map(|motion| ContactView::of(scene, motion));
    let (before, after) = (near(ends[0]), near(ends[1]));
    let (mut force, mut excess, mut touches) = (R::ZERO, R::ZERO, [false; 2]);
    for range in [before]
        .into_iter()
        .chain(after.without(before, contacts.len()))
    {
        for point in range.parts(contacts).into_iter().flatten() {
            let (start, end) = (first.side(point), last.side(point));
            let is_below = [start.depth > R::ZERO, end.depth > R::ZERO];
            if is_below != [false; 2] {
                touches = [touches[0] || is_below[0], touches[1] || is_below[1]];
                continue;
            }
            let path = Path::between(&start, &end, seconds);
            if let Some(depth) = path.greatest_depth(path_error) {
                force += push(scene, depth, R::ZERO);
            }
            let meets = start.depth + start.closing_speed * seconds > R::ZERO;
            let leaving_speed = -end.closing_speed;
            if meets && leaving_speed > R::ZERO && energy_gained() > R::ZERO {
                let leaving = (ends[1], leaving_speed);
                excess += bounce::excess_impulse(scene, point, leaving, energy_gained());
            }
        }
    }
    (force * seconds + excess, touches)
}
