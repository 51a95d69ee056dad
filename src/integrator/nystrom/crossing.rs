//! Contacts that begin or cease to push within a step, and what the stages have missed of their
//! forces.

use super::{END, SECOND, Stage};
use crate::body::{ContactPoint, RigidPointBody};
use crate::friction::SlidingFriction;
use crate::integrator::contact_path::{ContactEnd, Path, Sight, arm, push, slip};
use crate::integrator::rk4::Point;
use crate::real::{Real, Vector};
use crate::rotation::Axes;
use crate::scene::{Dynamics, Load, Motion};

/// The `end` of a step, with what its stages have missed.
#[inline(always)]
pub(super) fn corrected<R: Real, D: Dynamics<R>>(
    scene: &D,
    stages: [&Stage<R>; 4],
    end: Point<R>,
    seconds: R,
) -> Point<R> {
    let [first, .., last] = stages;
    if first.run.count == 0 && last.run.count == 0 {
        return end;
    }
    // So short a step moves nothing, and rounding of a depth would be an infinite speed.
    if !(R::ONE / seconds).is_finite() {
        return end;
    }
    let motion = end.motion(scene);
    let missed = missed(scene, stages, &motion, seconds);
    if missed.speeds.touching == 0 {
        return end;
    }
    missed.added_to(end, scene, &motion.axes, seconds)
}

/// What the weighted sums over the stages lack of the true means of force and torque over the step.
struct Missed<R: Real> {
    /// Of `∫ f ds`, which the velocities take.
    speeds: Load<R>,
    /// Of `∫ (1 - s) f ds`, which place and turn take.
    places: Load<R>,
}

#[inline(always)]
fn missed<R: Real, D: Dynamics<R>>(
    scene: &D,
    [first, _, third, last]: [&Stage<R>; 4],
    end: &Motion<R>,
    seconds: R,
) -> Missed<R> {
    let mut missed = Missed {
        speeds: Load::default(),
        places: Load::default(),
    };
    let step = Taken {
        scene,
        ends: [Sight::of(scene, &first.motion), Sight::of(scene, end)],
        late: [
            Sight::of(scene, &third.motion),
            Sight::of(scene, &last.motion),
        ],
        seconds,
        per_second: R::ONE / seconds,
    };
    let contacts = scene.body().contacts();
    // The last stage stands at the end but for an order of the step; a contact that only one of
    // them touches does so with next to no time.
    let [head, tail] = last.run.without(first.run, contacts.len());
    for run in [first.run, head, tail] {
        for part in run.parts(contacts) {
            for point in part {
                step.look_at(point, &mut missed);
            }
        }
    }
    missed
}

/// A step that has been taken.
struct Taken<'a, R: Real, D> {
    scene: &'a D,
    ends: [Sight<'a, R, D>; 2],
    /// The third stage and the last one.
    late: [Sight<'a, R, D>; 2],
    seconds: R,
    per_second: R,
}

impl<R: Real, D: Dynamics<R>> Taken<'_, R, D> {
    #[inline(always)]
    fn look_at(&self, point: &ContactPoint<R>, missed: &mut Missed<R>) {
        let [start, end] = &self.ends;
        let (start, end) = (start.side(point), end.side(point));
        if start.pushes() != end.pushes() {
            self.weigh(point, [start, end], missed);
        }
    }

    /// One contact that begins or ceases to push.
    #[inline(never)]
    fn weigh(
        &self,
        point: &ContactPoint<R>,
        [start, end]: [ContactEnd<R>; 2],
        missed: &mut Missed<R>,
    ) {
        let path = Path::between(&start, &end, self.seconds);
        let per_second = self.per_second;
        let force = |share: R| {
            let (depth, slope) = path.at(share);
            push(self.scene, depth, slope * per_second)
        };
        let [from, to] = pushing(&path, force, start.pushes());
        let [mut speeds, mut places] = means(force, from, to);
        // The second stage stands on the path. The later ones do not, and what is to be replaced is
        // what they have seen.
        let [third, last] = &self.late;
        let taken = [
            start.normal_force,
            force(R::from_f64(SECOND.time)),
            third.side(point).normal_force,
            last.side(point).normal_force,
        ];
        for (taken, (speed, place)) in taken
            .into_iter()
            .zip(END.speeds.into_iter().zip(END.places))
        {
            speeds -= taken * R::from_f64(speed);
            places -= taken * R::from_f64(place);
        }
        let load = start.normal_force.at_least(end.normal_force);
        let [first, last] = &self.ends;
        let pushes = [
            self.direction(point, first.motion, load),
            self.direction(point, last.motion, load),
        ];
        missed.add(pushes, [speeds, places]);
    }

    /// Force and torque on the body for each newton of the contact's normal force, in a motion and
    /// under a `load` (N).
    #[inline(always)]
    fn direction(&self, point: &ContactPoint<R>, motion: &Motion<R>, load: R) -> [R::Vec3; 2] {
        let (arm, normal) = arm(self.scene, motion, point);
        let along = slip(motion, (arm, normal));
        let rub = self.scene.friction().force(load, along);
        let push = normal + rub * (R::ONE / load);
        [push, arm.cross(push)]
    }
}

impl<R: Real> Missed<R> {
    /// One contact more, with its directions at both ends: `∫ f D ds` to first order in how `D`
    /// changes, as `D(s) = (1 - s) D(0) + s D(1)`.
    #[inline(always)]
    fn add(&mut self, [first, last]: [[R::Vec3; 2]; 2], [speeds, places]: [R; 2]) {
        let rest = speeds - places;
        for (sum, [early, late]) in [
            (&mut self.speeds, [places, rest]),
            (&mut self.places, [places * R::HALF; 2]),
        ] {
            sum.force += first[0] * early + last[0] * late;
            sum.torque += first[1] * early + last[1] * late;
            sum.touching += 1;
        }
    }

    /// The end of a step with these `axes`, and with this.
    #[inline(always)]
    fn added_to<D: Dynamics<R>>(
        &self,
        mut end: Point<R>,
        scene: &D,
        axes: &Axes<R>,
        seconds: R,
    ) -> Point<R> {
        let mass = scene.inertia_properties();
        let inverse_mass = mass.inverse_mass();
        let turn = mass.angular_velocity(axes, self.places.torque);
        end.position += self.places.force * (inverse_mass * seconds * seconds);
        end.orientation = (end.orientation).plus(end.orientation.rate(turn), seconds * seconds);
        end.linear_velocity += self.speeds.force * (inverse_mass * seconds);
        end.angular_momentum += self.speeds.torque * seconds;
        end
    }
}

/// The shares of the step between which a contact pushes that does so at one of its ends: at the
/// start, or not.
#[inline(always)]
fn pushing<R: Real>(path: &Path<R>, force: impl Fn(R) -> R, at_start: bool) -> [R; 2] {
    let surface = path.surface();
    if at_start {
        // It may let go before it leaves the ground.
        [R::ZERO, edge(force, R::ZERO, surface.unwrap_or(R::ONE))]
    } else {
        // What goes down through the surface pushes from there on, by spring and damper both; what
        // was in the ground before begins later.
        let from = surface.unwrap_or_else(|| edge(force, R::ONE, R::ZERO));
        [from, R::ONE]
    }
}

/// Where a force falls to 0 on the way from one share of the step to another, or jumps there: where
/// the chord leads through the force at two places near the end of the way, or half as far.
#[inline(always)]
fn edge<R: Real>(force: impl Fn(R) -> R, inside: R, outside: R) -> R {
    let at = |share: f64| {
        let place = inside + (outside - inside) * R::from_f64(share);
        (place, force(place))
    };
    for [first, second] in [[0.75, 0.9], [0.5, 0.7]] {
        let second = at(second);
        if second.1 > R::ZERO {
            return beyond(at(first), second, outside);
        }
    }
    edge_by_halving(force, inside, outside)
}

/// Where the chord through a force at two places falls to 0, at most `limit`.
#[inline(always)]
fn beyond<R: Real>((first, more): (R, R), (second, less): (R, R), limit: R) -> R {
    let on = (second - first) * (less / (more - less));
    let rest = limit - second;
    // Both have the sign of the way; a chord that does not fall leads nowhere.
    if on.abs() < rest.abs() && less < more {
        second + on
    } else {
        limit
    }
}

/// By halving, and from the last share where it pushes on along its chord, so that rounding does
/// not decide between two places.
#[inline(never)]
fn edge_by_halving<R: Real>(force: impl Fn(R) -> R, inside: R, outside: R) -> R {
    let [mut near, mut far] = [inside, outside];
    for _ in 0..HALVINGS {
        let middle = (near + far) * R::HALF;
        if force(middle) > R::ZERO {
            near = middle;
        } else {
            far = middle;
        }
    }
    let last = near - (far - near);
    beyond((last, force(last)), (near, force(near)), far)
}

/// To a 64th of the step, and a square of that on the chord; the force is next to 0 there, so that
/// what is missed of its integral goes as the square once more.
const HALVINGS: u32 = 6;

/// `∫ f ds` and `∫ (1 - s) f ds` over a part of the step, by Gauss's rule with two points: the
/// spring-damper's force is a cubic there.
#[inline(always)]
fn means<R: Real>(force: impl Fn(R) -> R, from: R, to: R) -> [R; 2] {
    let (middle, half) = ((from + to) * R::HALF, (to - from) * R::HALF);
    let out = half * R::from_f64(0.577_350_269_189_625_8);
    let (early, late) = (middle - out, middle + out);
    let (first, second) = (force(early), force(late));
    [
        (first + second) * half,
        (first * (R::ONE - early) + second * (R::ONE - late)) * half,
    ]
}
