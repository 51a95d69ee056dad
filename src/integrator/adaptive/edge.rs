//! Contacts that close and open again within one step at an edge, on a curve of the ground, or on a
//! round rim.
//!
//! The gaps at both ends of such a step belong to different parts of the ground or of the rim, so
//! that no interpolation between them shows the contact. Here the ground is evaluated on the path.
//! A gap changes by at most the path of the body, so that a body with the gap `g` stays above the
//! ground while no point of it has moved by `g`. The path is searched in parts of this length.

use crate::contact::Motion;
use crate::integrator::contact_path::push;
use crate::integrator::point::Point;
use crate::quadrature::bisect;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, size};

/// Shortest part of a step that is searched, as a fraction of it, if both ends are above the
/// ground. A contact that takes less may be overlooked.
const SHORTEST: f64 = 1.0 / 64.0;
/// Shortest part of a step that is searched, as a fraction of it, if the body touches the ground at
/// one end. Near that end all parts are the shortest.
const SHORTEST_IN_TOUCH: f64 = 1.0 / 16.0;
/// Bisections to locate the touch-down, down to 2^-14 of the step.
const HALVINGS: u32 = 10;

/// A contact that begins and ends within a step.
pub(super) struct Brush<R> {
    /// Fraction of the step at which it is about to begin.
    pub(super) before: R,
    /// Greatest force of its springs, N.
    pub(super) force: R,
}

/// Searches the first contact of a body with one surface that begins and ends within a step.
///
/// A plane has no edge, and is searched for rims alone. The step of a body that touches the surface
/// at both ends is not searched, as it is short. `touches` states whether a contact that belongs to
/// no rim touches at each end.
#[inline]
pub(super) fn brush<R: Real, D: Dynamics<R>>(
    scene: &D,
    points: [&Point<R>; 2],
    (motions, touches): ([&Motion<R>; 2], [bool; 2]),
    seconds: R,
) -> Option<Brush<R>> {
    let model = scene.contact_model();
    if touches == [true; 2] || (model.plane().is_some() && !model.has_rims()) {
        return None;
    }
    Search {
        scene,
        points,
        motions,
        seconds,
        path: fastest(scene, motions) * seconds,
    }
    .first(touches)
}

/// Largest speed of a point of the body at the ends of a step, m/s.
fn fastest<R: Real, D: Dynamics<R>>(scene: &D, motions: [&Motion<R>; 2]) -> R {
    let [start, end] = motions.map(|motion| {
        motion.linear_velocity.length() + motion.angular_velocity.length() * size(scene)
    });
    start.at_least(end)
}

struct Search<'a, R: Real, D> {
    scene: &'a D,
    points: [&'a Point<R>; 2],
    motions: [&'a Motion<R>; 2],
    seconds: R,
    /// Longest path of a point of the body in the step, m.
    path: R,
}

impl<R: Real, D: Dynamics<R>> Search<'_, R, D> {
    #[inline(never)]
    fn first(&self, touches: [bool; 2]) -> Option<Brush<R>> {
        if self.motions.iter().all(|motion| self.is_far(motion)) {
            return None;
        }
        let [start, end] = self.motions.map(|motion| self.gap_of(motion));
        // A rim touches where the lowest point of the body is below the ground.
        let touches = [touches[0] || start <= R::ZERO, touches[1] || end <= R::ZERO];
        if start + end >= self.path || touches == [true; 2] {
            return None;
        }
        let shortest = R::from_f64(if touches == [false; 2] {
            SHORTEST
        } else {
            SHORTEST_IN_TOUCH
        });
        // From here on, the body is nearer to the end than to the ground.
        let last = R::ONE - end.at_least(R::ZERO) / self.path;
        let (mut share, mut gap, mut deepest) = (R::ZERO, start, (R::ZERO, R::ZERO));
        let (mut entry, mut leaves) = (None, end > R::ZERO);
        loop {
            let next = share + (gap / self.path).at_least(shortest);
            // It is false for a gap that is not a number.
            let is_within = next < last;
            if !is_within {
                break;
            }
            let here = self.gap(next);
            if here > R::ZERO && entry.is_some() {
                leaves = true;
                break;
            }
            if here <= R::ZERO {
                entry = entry.or((gap > R::ZERO).then_some([share, next]));
                // That of a contact that touches from the start does not count.
                if entry.is_some() && -here > deepest.0 {
                    deepest = (-here, next);
                }
            }
            (share, gap) = (next, here);
        }
        let bracket = entry.filter(|_| leaves)?;
        let [before, _] = bisect(bracket, HALVINGS, |share| self.gap(share) <= R::ZERO);
        Some(Brush {
            before,
            force: self.force_at(deepest.1),
        })
    }

    /// Force of the springs at a fraction of the step, N.
    fn force_at(&self, share: R) -> R {
        let mut force = R::ZERO;
        self.scene.visit_contacts(&self.motion(share), |contact| {
            force += push(self.scene, contact.depth, R::ZERO) * contact.weight;
        });
        force
    }

    /// Returns true if no point of the body is within half of the path above the ground at one
    /// end. In flight no contact is evaluated for it.
    fn is_far(&self, motion: &Motion<R>) -> bool {
        let model = self.scene.contact_model();
        let margin = self.path * R::HALF;
        let pose = (motion.position, &motion.axes);
        let near = model.range_within(margin, pose.0, pose.1);
        near.count == 0 && !model.has_rim_near(0, margin, pose)
    }

    /// Gap of the lowest point of the body, m.
    fn gap_of(&self, motion: &Motion<R>) -> R {
        let lowest = self.scene.contact_model().lowest_point(motion);
        lowest.map_or(R::MAX, |point| point.gap)
    }

    /// Gap of the lowest point of the body at a fraction of the step, m.
    fn gap(&self, share: R) -> R {
        self.gap_of(&self.motion(share))
    }

    /// Pose at a fraction of the step, by Hermite's cubic of position and quaternion. The
    /// velocities are those of the start.
    fn motion(&self, share: R) -> Motion<R> {
        let ([start, end], [first, last]) = (self.points, self.motions);
        let left = R::ONE - share;
        let of_start = (R::ONE + R::TWO * share) * (left * left);
        let of_end = R::ONE - of_start;
        let by_start = share * (left * left) * self.seconds;
        let by_end = -(share * share * left) * self.seconds;
        let turning = [(start, first), (end, last)]
            .map(|(point, motion)| point.orientation.rate(motion.angular_velocity));
        let orientation = (start.orientation.scaled(of_start))
            .plus(end.orientation, of_end)
            .plus(turning[0], by_start)
            .plus(turning[1], by_end);
        Motion {
            position: start.position * of_start
                + end.position * of_end
                + first.linear_velocity * by_start
                + last.linear_velocity * by_end,
            axes: orientation.normalised().axes(),
            ..*first
        }
    }
}
