//! The contacts of an implicit step: gathered once, then asked for their mean force at each iteration.

use super::problem::{Problem, Trial};
use crate::body::{ContactPoint, RigidPointBody, Run};
use crate::friction::{Drag, SlidingFriction};
use crate::ground::{MeanForce, SpringDamperGround};
use crate::real::{Real, Vector};
use crate::scene::Dynamics;

/// How many contacts a step remembers from iteration to iteration. Of further ones it forgets the direction of slip, so that
/// sticking takes more iterations; every promise holds for them too.
pub(super) const CAPACITY: usize = 128;

/// One contact of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch<R: Real> {
    /// From the centre of mass to the contact's centre at the start of the step, m.
    arm: R::Vec3,
    radius: R,
    /// At the start of the step, m; negative above ground.
    depth: R,
    /// At the end of the last trial step, m.
    end_depth: R,
    /// Newton's dual unknown: the friction's direction over its limit, at most of length 1.
    dual: R::Vec3,
    /// What the dual was linearised about; `None` before the first iteration.
    last: Option<Slip<R>>,
}

/// Mean slip over the step (m/s, along the surface) and the friction law's width there.
#[derive(Clone, Copy, Debug)]
struct Slip<R: Real> {
    velocity: R::Vec3,
    /// Unit vector, or 0.
    direction: R::Vec3,
    width: R,
    growth: R,
}

/// What a contact does over a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Push<R: Real> {
    pub(super) normal: R::Vec3,
    pub(super) mean: MeanForce<R>,
    pub(super) friction: R::Vec3,
    pub(super) drag: Drag<R>,
    /// Mean slip, m/s.
    pub(super) slip: R::Vec3,
    /// Unit vector along the slip, or 0.
    pub(super) slip_direction: R::Vec3,
    pub(super) dual: R::Vec3,
    /// From the centre of mass to where the mean force acts.
    pub(super) arm: R::Vec3,
    /// From the centre of mass to the contact's centre at the end of the step.
    pub(super) end_arm: R::Vec3,
    pub(super) end_depth: R,
    pub(super) radius: R,
}

impl<R: Real> Push<R> {
    #[inline]
    pub(super) fn force(&self) -> R::Vec3 {
        self.normal * self.mean.force + self.friction
    }

    /// From the centre of mass to where the ground's force acts at the end of the step.
    #[inline]
    pub(super) fn end_point(&self) -> R::Vec3 {
        self.end_arm - self.normal * self.radius
    }
}

/// The contacts that may touch during a step.
#[derive(Clone, Debug)]
pub(super) struct Contacts<R: Real> {
    touches: [Touch<R>; CAPACITY],
    remembered: usize,
    /// All candidates, and how many of them were looked at when the places ran out.
    run: Run,
    seen: usize,
}

impl<R: Real> Default for Contacts<R> {
    fn default() -> Self {
        let nothing = Touch {
            arm: R::Vec3::ZERO,
            radius: R::ZERO,
            depth: R::ZERO,
            end_depth: R::ZERO,
            dual: R::Vec3::ZERO,
            last: None,
        };
        Self {
            touches: [nothing; CAPACITY],
            remembered: 0,
            run: Run::NONE,
            seen: 0,
        }
    }
}

impl<R: Real> Contacts<R> {
    /// Collects the contacts of `run` that `keep` (depth at the start, arm) accepts.
    #[inline]
    pub(super) fn gather<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        run: Run,
        keep: impl Fn(R, R::Vec3) -> bool,
    ) {
        let contacts = problem.scene.body().contacts();
        (self.remembered, self.seen) = (0, 0);
        self.run = Run {
            count: run.count.min(contacts.len()),
            ..run
        };
        for point in run.parts(contacts).into_iter().flatten() {
            let touch = Touch::of(problem, point);
            if keep(touch.depth, touch.arm) {
                let Some(place) = self.touches.get_mut(self.remembered) else {
                    return;
                };
                *place = touch;
                self.remembered += 1;
            }
            self.seen += 1;
        }
    }

    /// How many contacts there are, remembered or not.
    #[inline]
    pub(super) fn len(&self) -> usize {
        self.remembered + (self.run.count - self.seen)
    }

    /// Whether `touching` contacts below ground at the end of the step are no more than the last trial has seen there.
    pub(super) fn foresaw(&self, touching: usize) -> bool {
        let ended_below = |touch: &&Touch<R>| touch.end_depth > R::ZERO;
        self.seen < self.run.count
            || touching
                <= self
                    .touches
                    .iter()
                    .take(self.remembered)
                    .filter(ended_below)
                    .count()
    }

    /// What the contact number `index`, below [`len`](Self::len), does in a trial step; `None` where it does not reach the ground.
    #[inline(always)]
    pub(super) fn push<D: Dynamics<R>>(
        &mut self,
        index: usize,
        problem: &Problem<'_, R, D>,
        trial: &Trial<R>,
    ) -> Option<Push<R>> {
        if index < self.remembered {
            let touch = self.touches.get_mut(index)?;
            touch.push(problem, trial)
        } else {
            self.forgotten(index, problem)?.push(problem, trial)
        }
    }

    /// A contact that found no place, made anew.
    #[cold]
    fn forgotten<D: Dynamics<R>>(
        &self,
        index: usize,
        problem: &Problem<'_, R, D>,
    ) -> Option<Touch<R>> {
        let contacts = problem.scene.body().contacts();
        let along_run = self.run.first + self.seen + (index - self.remembered);
        let point = contacts.get(along_run % contacts.len().max(1))?;
        Some(Touch::of(problem, point))
    }
}

impl<R: Real> Touch<R> {
    #[inline]
    fn of<D: Dynamics<R>>(problem: &Problem<'_, R, D>, point: &ContactPoint<R>) -> Self {
        let arm = problem.motion.axes.to_world(point.position);
        let surface = problem
            .scene
            .ground()
            .surface(problem.motion.position + arm);
        Self {
            arm,
            radius: point.radius,
            depth: point.radius - surface.gap,
            end_depth: R::ZERO,
            dual: R::Vec3::ZERO,
            last: None,
        }
    }

    /// What the contact does over a trial step, where there is a force.
    #[inline(always)]
    fn push<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        trial: &Trial<R>,
    ) -> Option<Push<R>> {
        let swung = trial.swing.times(self.arm);
        let end_arm = self.arm + swung;
        let moved = trial.shift + swung;
        let (normal, end_depth) = self.fall(problem, moved);
        self.end_depth = end_depth;
        let mean = problem
            .scene
            .ground()
            .mean_force(self.depth, end_depth, problem.seconds);
        if mean.force <= R::ZERO && mean.slope <= R::ZERO {
            return None;
        }
        let mut arm = (self.arm + end_arm) * R::HALF;
        let mut along = moved - normal * normal.dot(moved);
        if self.radius > R::ZERO {
            // The contact's place lies a radius below its centre and is carried round by the turn.
            arm -= normal * self.radius;
            along -= trial.spin.cross(normal) * (self.radius * R::TWO);
        }
        let slip = along * problem.per_second;
        let friction = problem.scene.friction().force(mean.force, slip);
        let drag = problem.scene.friction().drag(mean.force, slip);
        let slip_direction = self.settle_dual(slip, &drag, problem);
        Some(Push {
            normal,
            mean,
            friction,
            drag,
            slip,
            slip_direction,
            dual: self.dual,
            arm,
            end_arm,
            end_depth,
            radius: self.radius,
        })
    }

    /// The normal along which the force does the springs' work, and the depth at the end, for a contact whose centre moves by `moved`.
    #[inline]
    fn fall<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>, moved: R::Vec3) -> (R::Vec3, R) {
        if let Some(plane) = &problem.plane {
            return (plane.normal, self.depth - plane.normal.dot(moved));
        }
        // A curved ground: Gonzalez's discrete gradient, so that force times path is the change of depth.
        let ground = problem.scene.ground();
        let start = problem.motion.position + self.arm;
        let middle = ground.surface(start + moved * R::HALF).normal;
        let end_depth = self.radius - ground.surface(start + moved).gap;
        let square = moved.length_squared();
        let lack = (self.depth - end_depth) - middle.dot(moved);
        if square > R::ZERO && lack.abs() < square.sqrt() {
            (middle + moved * (lack / square), end_depth)
        } else {
            (middle, end_depth)
        }
    }

    /// The dual after Newton's step: `(u' - w' g (û·(u' - u)))/w`, on the unit disc (Chan, Golub & Mulet 1999). Returns the new slip's direction.
    #[inline]
    fn settle_dual<D: Dynamics<R>>(
        &mut self,
        slip: R::Vec3,
        drag: &Drag<R>,
        problem: &Problem<'_, R, D>,
    ) -> R::Vec3 {
        let speed = slip.length();
        let direction = if speed > R::ZERO {
            slip * (R::ONE / speed)
        } else {
            R::Vec3::ZERO
        };
        self.dual = match self.last {
            // A slide that the step can hardly brake begins with Newton's own derivative; one that it can stop, with stick.
            None if drag.coefficient * problem.seconds < problem.mass * R::from_f64(0.1) => {
                slip * (R::ONE / drag.width)
            }
            None => R::Vec3::ZERO,
            Some(last) => {
                let change = (slip - last.velocity).dot(last.direction);
                let dual = (slip - self.dual * (last.growth * change)) * (R::ONE / last.width);
                let size = dual.length();
                if size > R::ONE {
                    dual * (R::ONE / size)
                } else {
                    dual
                }
            }
        };
        self.last = Some(Slip {
            velocity: slip,
            direction,
            width: drag.width,
            growth: drag.growth,
        });
        direction
    }
}
