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
    /// Newton's dual unknown: the friction's direction over its limit, at most of length 1.
    dual: R::Vec3,
    /// What the dual was linearised about; `None` before the first iteration.
    last: Option<Slip<R>>,
}

/// Mean slip over the step (m/s, along the surface) and the friction law's width there.
#[derive(Clone, Copy, Debug)]
struct Slip<R: Real> {
    velocity: R::Vec3,
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
    count: usize,
    /// All candidates, and how many of them were looked at when the places ran out.
    run: Run,
    seen: usize,
    /// How many ended below ground at the last visit.
    pub(super) end_touching: usize,
}

impl<R: Real> Default for Contacts<R> {
    fn default() -> Self {
        let nothing = Touch {
            arm: R::Vec3::ZERO,
            radius: R::ZERO,
            depth: R::ZERO,
            dual: R::Vec3::ZERO,
            last: None,
        };
        Self {
            touches: [nothing; CAPACITY],
            count: 0,
            run: Run::NONE,
            seen: 0,
            end_touching: 0,
        }
    }
}

impl<R: Real> Contacts<R> {
    /// Collects the contacts of `run` that `keep` (depth at the start, arm) accepts.
    pub(super) fn gather<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        run: Run,
        keep: impl Fn(R, R::Vec3) -> bool,
    ) {
        (self.count, self.seen, self.end_touching) = (0, 0, 0);
        self.run = run;
        for point in run
            .parts(problem.scene.body().contacts())
            .into_iter()
            .flatten()
        {
            let touch = Touch::of(problem, point);
            if keep(touch.depth, touch.arm) {
                let Some(place) = self.touches.get_mut(self.count) else {
                    return;
                };
                *place = touch;
                self.count += 1;
            }
            self.seen += 1;
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Calls `visit` with what each contact does in a trial step that reaches the ground.
    #[inline]
    pub(super) fn visit<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        trial: &Trial<R>,
        mut visit: impl FnMut(&Push<R>),
    ) {
        let mut touching = 0;
        let mut meet = |touch: &mut Touch<R>| {
            let (end_depth, push) = touch.push(problem, trial);
            touching += usize::from(end_depth > R::ZERO);
            if let Some(push) = push {
                visit(&push);
            }
        };
        for touch in self.touches.iter_mut().take(self.count) {
            meet(touch);
        }
        let contacts = problem.scene.body().contacts();
        if self.seen < self.run.count.min(contacts.len()) {
            let points = self.run.parts(contacts).into_iter().flatten();
            for point in points.skip(self.seen) {
                meet(&mut Touch::of(problem, point));
            }
        }
        self.end_touching = touching;
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
            dual: R::Vec3::ZERO,
            last: None,
        }
    }

    /// Depth at the end of a trial step, and the mean force over it, where there is one.
    #[inline]
    fn push<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        trial: &Trial<R>,
    ) -> (R, Option<Push<R>>) {
        let swung = trial.swing.times(self.arm);
        let end_arm = self.arm + swung;
        let moved = trial.shift + swung;
        let (normal, end_depth) = self.fall(problem, moved);
        let mean = problem
            .scene
            .ground()
            .mean_force(self.depth, end_depth, problem.seconds);
        if mean.force <= R::ZERO && mean.slope <= R::ZERO {
            return (end_depth, None);
        }
        let arm = (self.arm + end_arm) * R::HALF - normal * self.radius;
        // The contact's place lies a radius below its centre and is carried round by the turn.
        let place_moved = moved - trial.spin.cross(normal) * (self.radius * R::TWO);
        let along = place_moved - normal * place_moved.dot(normal);
        let slip = along * problem.per_second;
        let friction = problem.scene.friction().force(mean.force, slip);
        let drag = problem.scene.friction().drag(mean.force, slip);
        let slip_direction = self.settle_dual(slip, &drag, problem);
        let push = Push {
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
        };
        (end_depth, Some(push))
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
                let change = (slip - last.velocity).dot(last.direction());
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
            width: drag.width,
            growth: drag.growth,
        });
        direction
    }
}

impl<R: Real> Slip<R> {
    #[inline]
    fn direction(&self) -> R::Vec3 {
        let speed = self.velocity.length();
        if speed > R::ZERO {
            self.velocity * (R::ONE / speed)
        } else {
            R::Vec3::ZERO
        }
    }
}
