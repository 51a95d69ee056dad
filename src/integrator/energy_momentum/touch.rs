//! One contact of an implicit step: its path over a trial step, and the force that goes with it.

use super::problem::{Problem, Trial};
use crate::body::{ContactPoint, RigidPointBody};
use crate::friction::Drag;
use crate::ground::{MeanForce, SpringDamperGround};
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, facing_ground};

/// One contact of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch<R: Real> {
    /// From the centre of mass to the contact's centre at the start of the step, m.
    pub(super) arm: R::Vec3,
    /// What it did over the last trial step.
    pub(super) push: Push<R>,
    /// Where Newton's matrix was last made; not so far, where the step has just begun.
    pub(super) dual: Option<Dual<R>>,
}

/// Newton's dual unknown of a contact, and the slip that it was found at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dual<R: Real> {
    /// The friction's direction over its limit, at most of length 1.
    direction: R::Vec3,
    /// m/s.
    slip: R::Vec3,
    /// Of the friction's [`Drag`].
    width: R,
    growth: R,
}

/// What a contact does over a trial step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Push<R: Real> {
    /// Unit vector out of the ground.
    pub(super) normal: R::Vec3,
    pub(super) mean: MeanForce<R>,
    /// The normal force and friction together, N.
    pub(super) force: R::Vec3,
    /// Mean slip, m/s.
    pub(super) slip: R::Vec3,
    /// From the centre of mass to where the mean force acts, m.
    pub(super) arm: R::Vec3,
    /// From the centre of mass to the contact's centre at the end of the step, m.
    pub(super) end_arm: R::Vec3,
    /// At the start of the step, m; negative above ground.
    pub(super) depth: R,
    /// m; negative above ground.
    pub(super) end_depth: R,
    pub(super) radius: R,
    /// Of a place of a rim: how many contacts it stands for.
    pub(super) weight: R,
}

/// How friction at a contact answers to its slip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer<R: Real> {
    pub(super) drag: Drag<R>,
    /// Newton's dual unknown: the friction's direction over its limit, at most of length 1.
    pub(super) dual: R::Vec3,
    /// Unit vector along the slip, or 0.
    pub(super) slip_direction: R::Vec3,
}

impl<R: Real> Push<R> {
    /// All zeros, so that a workspace in a `static` takes no place in a program's image.
    const NONE: Self = Self {
        normal: R::Vec3::ZERO,
        mean: MeanForce::NONE,
        force: R::Vec3::ZERO,
        slip: R::Vec3::ZERO,
        arm: R::Vec3::ZERO,
        end_arm: R::Vec3::ZERO,
        depth: R::ZERO,
        end_depth: R::ZERO,
        radius: R::ZERO,
        weight: R::ZERO,
    };

    /// Whether there is a force, or would be one a little deeper.
    #[inline]
    pub(super) fn is_felt(&self) -> bool {
        self.mean.force > R::ZERO || self.mean.slope > R::ZERO
    }

    /// How many contacts it stands for, and how many that is for one: both 1 where the body has no rim.
    #[inline]
    fn weights<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>) -> Option<[R; 2]> {
        (!problem.scene.body().rims().is_empty()).then(|| [self.weight, R::ONE / self.weight])
    }

    #[inline]
    fn mean_force<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        end_depth: R,
    ) -> MeanForce<R> {
        let mean = problem.mean_force(self.depth, end_depth);
        match self.weights(problem) {
            Some([weight, _]) => MeanForce {
                force: mean.force * weight,
                slope: mean.slope * weight,
                stiffness: mean.stiffness * weight,
                damping: mean.damping * weight,
            },
            None => mean,
        }
    }

    #[inline]
    fn friction<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>, slip: R::Vec3) -> R::Vec3 {
        match self.weights(problem) {
            Some([weight, each]) => problem.friction(self.mean.force * each, slip) * weight,
            None => problem.friction(self.mean.force, slip),
        }
    }

    #[inline]
    pub(super) fn drag<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        slip: R::Vec3,
    ) -> Drag<R> {
        let Some([weight, each]) = self.weights(problem) else {
            return problem.drag(self.mean.force, slip);
        };
        let drag = problem.drag(self.mean.force * each, slip);
        Drag {
            coefficient: drag.coefficient * weight,
            ..drag
        }
    }
}

impl<R: Real> Touch<R> {
    pub(super) const NONE: Self = Self {
        arm: R::Vec3::ZERO,
        push: Push::NONE,
        dual: None,
    };

    #[inline]
    pub(super) fn of<D: Dynamics<R>>(problem: &Problem<'_, R, D>, point: &ContactPoint<R>) -> Self {
        let (body, ground) = (problem.scene.body(), problem.scene.ground());
        let motion = &problem.motion;
        let facing;
        let point = if body.is_smooth() {
            facing = facing_ground(body, ground, motion.position, &motion.axes);
            &facing
        } else {
            point
        };
        let arm = motion.axes.to_world(point.position);
        let surface = ground.surface(motion.position + arm);
        Self {
            arm,
            push: Push {
                normal: surface.normal,
                depth: point.radius - surface.gap,
                radius: point.radius,
                ..Push::NONE
            },
            dual: None,
        }
    }

    /// Works out what a bare contact on level ground does over a trial step, and whether that is felt.
    #[inline(always)]
    pub(super) fn respond_on_level<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        trial: &Trial<R>,
    ) -> bool {
        let swung = trial.swing.times(self.arm);
        let moved = trial.shift + swung;
        let end_depth = self.push.depth - moved.z();
        let mean = self.push.mean_force(problem, end_depth);
        self.push.end_depth = end_depth;
        self.push.mean = mean;
        if !self.push.is_felt() {
            return false;
        }
        let end_arm = self.arm + swung;
        let along = R::Vec3::new(moved.x(), moved.y(), R::ZERO);
        let arm = (self.arm + end_arm) * R::HALF;
        let friction = self.slide(problem, along, arm, end_arm);
        let up = friction.z() + mean.force;
        self.push.force = R::Vec3::new(friction.x(), friction.y(), up);
        true
    }

    /// The same for a contact of any kind on any ground.
    #[inline(never)]
    pub(super) fn respond<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        trial: &Trial<R>,
    ) {
        let is_smooth = problem.scene.body().is_smooth();
        let swung = if is_smooth {
            wandered(problem, trial) - self.arm
        } else {
            trial.swing.times(self.arm)
        };
        let moved = trial.shift + swung;
        let (normal, end_depth) = self.fall(problem, moved);
        self.push.normal = normal;
        self.push.end_depth = end_depth;
        self.push.mean = self.push.mean_force(problem, end_depth);
        if !self.push.is_felt() {
            return;
        }
        let end_arm = self.arm + swung;
        let mut arm = (self.arm + end_arm) * R::HALF;
        let mut along = moved - normal * normal.dot(moved);
        let radius = self.push.radius;
        if is_smooth {
            arm = carried::<R>(arm, normal, swung, trial.spin);
            let path = trial.shift + trial.spin.cross(arm) * R::TWO;
            along = path - normal * normal.dot(path);
        } else if radius > R::ZERO {
            // The contact's place lies a radius below its centre and is carried round by the turn.
            arm -= normal * radius;
            along -= trial.spin.cross(normal) * (radius * R::TWO);
        }
        let friction = self.slide(problem, along, arm, end_arm);
        self.push.force = normal * self.push.mean.force + friction;
    }

    /// Friction (N) over a path along the ground.
    #[inline(always)]
    fn slide<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        along: R::Vec3,
        arm: R::Vec3,
        end_arm: R::Vec3,
    ) -> R::Vec3 {
        let slip = along * problem.per_second;
        self.push.slip = slip;
        self.push.arm = arm;
        self.push.end_arm = end_arm;
        self.push.friction(problem, slip)
    }

    /// The normal along which the force does the springs' work, and the depth at the end, for a contact whose centre moves by `moved`.
    #[inline]
    fn fall<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>, moved: R::Vec3) -> (R::Vec3, R) {
        if let Some(plane) = &problem.plane {
            return (plane.normal, self.push.depth - plane.normal.dot(moved));
        }
        // A curved ground: Gonzalez's discrete gradient, so that force times path is the change of depth.
        let ground = problem.scene.ground();
        let start = problem.motion.position + self.arm;
        let middle = ground.surface(start + moved * R::HALF).normal;
        let end_depth = self.push.radius - ground.surface(start + moved).gap;
        let square = moved.length_squared();
        let lack = (self.push.depth - end_depth) - middle.dot(moved);
        if square > R::ZERO && lack.abs() < square.sqrt() {
            (middle + moved * (lack / square), end_depth)
        } else {
            (middle, end_depth)
        }
    }

    /// How friction answers at the last trial step.
    #[inline(always)]
    pub(super) fn answer<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>) -> Answer<R> {
        let (push, slip) = (&self.push, self.push.slip);
        let drag = push.drag(problem, slip);
        Answer {
            drag,
            dual: self.next_dual(problem, &drag),
            slip_direction: direction::<R>(slip),
        }
    }

    /// Keeps what the next answer is found from.
    #[inline(always)]
    pub(super) fn remember(&mut self, answer: &Answer<R>) {
        self.dual = Some(Dual {
            direction: answer.dual,
            slip: self.push.slip,
            width: answer.drag.width,
            growth: answer.drag.growth,
        });
    }

    /// The dual after Newton's step from the last answer's slip u to this one's u': `(u' - w' g (û·(u' - u)))/w`, on the unit disc (Chan, Golub & Mulet 1999).
    #[inline]
    fn next_dual<D>(&self, problem: &Problem<'_, R, D>, drag: &Drag<R>) -> R::Vec3 {
        let slip = self.push.slip;
        let Some(last) = &self.dual else {
            // A slide that the step can hardly brake begins with Newton's own derivative; one that it can stop, with stick.
            let slides = drag.coefficient * problem.seconds < problem.mass * R::from_f64(0.1);
            return if slides {
                slip * (R::ONE / drag.width)
            } else {
                R::Vec3::ZERO
            };
        };
        let change = (slip - last.slip).dot(direction::<R>(last.slip));
        let next = (slip - last.direction * (last.growth * change)) * (R::ONE / last.width);
        let square = next.length_squared();
        if square > R::ONE {
            next * (R::ONE / square.sqrt())
        } else {
            next
        }
    }
}

/// From the centre of mass to the place of a smooth body that faces the ground at the end of a trial step, m, world axes.
#[inline]
fn wandered<R: Real, D: Dynamics<R>>(problem: &Problem<'_, R, D>, trial: &Trial<R>) -> R::Vec3 {
    let (position, axes) = problem.place_at_end(trial);
    let (body, ground) = (problem.scene.body(), problem.scene.ground());
    let facing = facing_ground(body, ground, position, &axes);
    axes.to_world(facing.position)
}

/// The arm of a force along `normal` that does the springs' work on a smooth body: with the step's turn `2a`, `normal · (2a × arm) = normal · swung`.
///
/// The mean of the arms at start and end does so but for terms of third order in the turn, because at its own place the surface moves like the body's material; what
/// lacks is added along `normal × 2a`, where that is not too small to divide by.
#[inline]
fn carried<R: Real>(mean: R::Vec3, normal: R::Vec3, swung: R::Vec3, spin: R::Vec3) -> R::Vec3 {
    let lever = normal.cross(spin) * R::TWO;
    let lack = normal.dot(swung) - lever.dot(mean);
    let square = lever.length_squared();
    let most = mean.length_squared() * square * spin.length_squared();
    if square > R::ZERO && lack * lack <= most {
        mean + lever * (lack / square)
    } else {
        mean
    }
}

/// The unit vector along `slip`, or 0.
#[inline]
fn direction<R: Real>(slip: R::Vec3) -> R::Vec3 {
    let speed = slip.length();
    if speed > R::ZERO {
        slip * (R::ONE / speed)
    } else {
        R::Vec3::ZERO
    }
}
