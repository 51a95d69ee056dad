//! Contacts that close and open again within one step at an edge, on a curve of the ground, or on a
//! round rim, and rims that begin or cease to touch within one.
//!
//! The gaps at both ends of such a step belong to different parts of the ground or of the rim, so
//! that no interpolation between them shows the contact. Here the ground is evaluated on the path.
//! A gap changes by at most the path of the body, so that a body with the gap `g` stays above the
//! ground while no point of it has moved by `g`. The path is searched in parts of this length.

use crate::body::RigidPointBody;
use crate::contact::Motion;
use crate::integrator::contact_path::push;
use crate::integrator::point::Point;
use crate::quadrature::{bisect, integral_of_3};
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

/// Factor between the depths at both ends of a step up to which the force of a rim is smooth in
/// between. The forces of its springs then differ by a factor of 4 at most. Neither this value nor
/// the next two were compared with others.
const ALIKE: f64 = 2.5;
/// Bisections to locate where a rim begins or ceases to touch: a 64th of the step.
const RIM_HALVINGS: u32 = 6;
/// Parts in which the force of the rims is integrated.
const RIM_PARTS: u32 = 4;

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

/// Returns the error of the mean normal force of the rims (N) in a step within which they begin or
/// cease to touch one surface, or nearly so.
///
/// The force of a rim is proportional to the power 3/2 of its depth, and with a damper to the root
/// of it at first. A step sums such a force badly, and its own estimate may be small by chance. So
/// the force on the path between both ends is compared with that of the `stages`, which are given
/// with their weights.
#[inline]
pub(super) fn rim_error<'m, R: Real, D: Dynamics<R>>(
    scene: &D,
    points: [&Point<R>; 2],
    motions: [&Motion<R>; 2],
    stages: impl Iterator<Item = (&'m Motion<R>, R)>,
    seconds: R,
) -> R {
    let path = R::ZERO;
    Search {
        scene,
        points,
        motions,
        seconds,
        path,
    }
    .rim_error(stages)
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

    /// Error of the mean normal force of the rims, N.
    fn rim_error<'m>(&self, stages: impl Iterator<Item = (&'m Motion<R>, R)>) -> R {
        if self.depths_are_alike() {
            return R::ZERO;
        }
        let ends = self.motions.map(|motion| self.rim_force(motion));
        if ends == [R::ZERO; 2] {
            return R::ZERO;
        }
        let mut taken = R::ZERO;
        for (motion, weight) in stages {
            taken += self.rim_force(motion) * weight;
        }
        (self.mean_rim_force(ends) - taken).abs()
    }

    /// Returns true if a body of rims alone is above the ground at both ends, or touches at both
    /// with depths so alike that the force is smooth in between.
    fn depths_are_alike(&self) -> bool {
        let [start, end] = self.motions.map(|motion| {
            let depth = -self.gap_of(motion);
            depth.at_least(R::ZERO)
        });
        let alike = start.at_most(end) * R::from_f64(ALIKE) >= start.at_least(end);
        alike && self.scene.body().contacts().is_empty()
    }

    /// Normal force of the rims, N.
    fn rim_force(&self, motion: &Motion<R>) -> R {
        let mut force = R::ZERO;
        let model = self.scene.contact_model();
        model.visit_rims(motion, &mut |contact| {
            force += push(self.scene, contact.depth, contact.closing_speed) * contact.weight;
        });
        force
    }

    /// Mean normal force of the rims on the path, N, which have these forces at its ends.
    fn mean_rim_force(&self, ends: [R; 2]) -> R {
        let force = |share| self.rim_force(&self.motion(share));
        let [first, last] = ends.map(|force| force > R::ZERO);
        let [mut from, mut to] = [R::ZERO, R::ONE];
        if first != last {
            let has_changed = |share| (force(share) > R::ZERO) != first;
            let [before, after] = bisect([from, to], RIM_HALVINGS, has_changed);
            (from, to) = if first { (from, after) } else { (before, to) };
        }
        let length = (to - from) * R::from_f64(1.0 / f64::from(RIM_PARTS));
        let mut sum = R::ZERO;
        for part in 0..RIM_PARTS {
            let first = from + length * R::from_f64(f64::from(part));
            sum += integral_of_3(force, first, first + length);
        }
        sum
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

    /// Motion at a fraction of the step: the pose by Hermite's cubic of position and quaternion,
    /// and velocities that change evenly.
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
            linear_velocity: first.linear_velocity * left + last.linear_velocity * share,
            angular_velocity: first.angular_velocity * left + last.angular_velocity * share,
        }
    }
}
