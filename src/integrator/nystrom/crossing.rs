//! Contacts that begin or cease to push within a step, and what the stages have missed of their forces.

use super::{END, SECOND, Stage, THIRD};
use crate::body::{ContactPoint, RigidPointBody};
use crate::friction::SlidingFriction;
use crate::integrator::passage::{Path, Side, Sight, push};
use crate::integrator::rk4::Point;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, Load};

/// What the weighted sums over the stages lack of the true means of force and torque over the step.
pub(super) struct Missed<R: Real> {
    /// Of `∫ f ds`, which the velocities take.
    pub(super) speeds: Load<R>,
    /// Of `∫ (1 - s) f ds`, which place and turn take.
    pub(super) places: Load<R>,
}

/// What the stages of a step to `end` have missed.
#[inline(always)]
pub(super) fn missed<R: Real, D: Dynamics<R>>(
    scene: &D,
    [first, .., last]: [&Stage<R>; 4],
    end: &Point<R>,
    seconds: R,
) -> Missed<R> {
    let mut missed = Missed {
        speeds: Load::default(),
        places: Load::default(),
    };
    if first.run.count + last.run.count == 0 {
        return missed;
    }
    let end = end.motion(scene);
    let step = Taken {
        scene,
        ends: [Sight::of(scene, &first.motion), Sight::of(scene, &end)],
        seconds,
    };
    let contacts = scene.body().contacts();
    // The last stage stands at the end but for an order of the step; a contact that only one of them touches does so with next to no time.
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
    seconds: R,
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
    fn weigh(&self, point: &ContactPoint<R>, [start, end]: [Side<R>; 2], missed: &mut Missed<R>) {
        let path = Path::between(&start, &end, self.seconds);
        let per_second = R::ONE / self.seconds;
        let force = |share: R| {
            let (depth, slope) = path.at(share);
            push(self.scene, depth, slope * per_second)
        };
        let [from, to] = pushing(&path, force, start.pushes());
        let [mut speeds, mut places] = means(force, from, to);
        let taken = [
            start.normal_force,
            force(R::from_f64(SECOND.time)),
            force(R::from_f64(THIRD.time)),
            end.normal_force,
        ];
        for (taken, (speed, place)) in taken
            .into_iter()
            .zip(END.speeds.into_iter().zip(END.places))
        {
            speeds -= taken * R::from_f64(speed);
            places -= taken * R::from_f64(place);
        }
        let load = start.normal_force.at_least(end.normal_force);
        let (arm, push) = self.direction(point, (from + to) * R::HALF, load);
        missed.add(arm, push * speeds, push * places);
    }

    /// Arm of the contact (m) at a share of the step, and force on the body for each newton of the normal force, there and under a `load` (N).
    #[inline(always)]
    fn direction(&self, point: &ContactPoint<R>, share: R, load: R) -> (R::Vec3, R::Vec3) {
        let between = |a: R::Vec3, b: R::Vec3| a + (b - a) * share;
        let [start, end] = &self.ends;
        let (motion, next) = (start.motion, end.motion);
        let (first, _) = start.arm(point);
        let (last, normal) = end.arm(point);
        let arm = between(first, last);
        let spin = between(motion.angular_velocity, next.angular_velocity);
        let velocity = between(motion.linear_velocity, next.linear_velocity) + spin.cross(arm);
        let slip = velocity - normal * velocity.dot(normal);
        let rub = self.scene.friction().force(load, slip);
        (arm, normal + rub * (R::ONE / load))
    }
}

impl<R: Real> Missed<R> {
    #[inline(always)]
    fn add(&mut self, arm: R::Vec3, speeds: R::Vec3, places: R::Vec3) {
        for (sum, force) in [(&mut self.speeds, speeds), (&mut self.places, places)] {
            sum.force += force;
            sum.torque += arm.cross(force);
            sum.touching += 1;
        }
    }
}

/// The shares of the step between which a contact pushes that does so at one of its ends: at the start, or not.
#[inline(always)]
fn pushing<R: Real>(path: &Path<R>, force: impl Fn(R) -> R, at_start: bool) -> [R; 2] {
    let surface = path.surface();
    if at_start {
        // In the ground it may let go before it leaves.
        let inside = [R::ZERO, surface.unwrap_or(R::ONE)];
        [R::ZERO, edge(force, inside, at_start)]
    } else {
        // It pushes as soon as it is in the ground, or begins to while it is there.
        let start = surface.unwrap_or_else(|| edge(force, [R::ZERO, R::ONE], at_start));
        [start, R::ONE]
    }
}

/// Where a force that pushes at one end of a part of the step falls to 0: by halving, and from the last share where it pushes on along its chord, so that rounding does not decide between two places.
#[inline(always)]
fn edge<R: Real>(force: impl Fn(R) -> R, [mut low, mut high]: [R; 2], at_start: bool) -> R {
    for _ in 0..HALVINGS {
        let middle = (low + high) * R::HALF;
        if (force(middle) > R::ZERO) == at_start {
            low = middle;
        } else {
            high = middle;
        }
    }
    let (inside, outside) = if at_start { (low, high) } else { (high, low) };
    let width = outside - inside;
    let (near, far) = (force(inside), force(inside - width));
    let on = near / (far - near);
    if on > R::ZERO && on < R::ONE {
        inside + width * on
    } else {
        outside
    }
}

/// To a 64th of the step, and a square of that on the chord; the force is next to 0 there, so that what is missed of its integral goes as the square once more.
const HALVINGS: u32 = 6;

/// `∫ f ds` and `∫ (1 - s) f ds` over a part of the step, by Gauss's rule with two points: the spring-damper's force is a cubic there.
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
