//! One contact of an implicit step: its path over a trial step, and the corresponding force.

use super::block::Block;
use super::problem::{Problem, Trial};
use super::shared::is_single;
use crate::body::ContactPoint;
use crate::contact::MovingContact;
use crate::friction::{FrictionJacobian, SlidingFriction};
use crate::ground::{MeanForce, SpringDamperGround};
use crate::real::{Real, Vector};
use crate::scene::Dynamics;

/// Fraction of a slip that friction takes in a step, below which the slide will not end in it.
const HARDLY: f64 = 0.1;

/// One contact of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch<R: Real> {
    /// Vector from the centre of mass to the contact's centre at the start of the step, m.
    pub(super) arm: R::Vec3,
    /// Motion and force of the contact over the last trial step.
    pub(super) push: Push<R>,
    pub(super) dual: Dual<R>,
    /// Dual unknown where friction was last differentiated, if a Newton step has advanced it since.
    pub(super) before: R::Vec3,
    /// Mean normal force at which a hard contact is next differentiated, N; 0 if there is none.
    pub(super) load: R,
    /// Depth at the end of the step at which a hard contact was last differentiated, m.
    pub(super) settled_depth: R,
}

/// Newton's dual unknown of a contact: friction divided by its limit, a vector of length at most 1.
#[derive(Clone, Copy, Debug)]
pub(super) enum Dual<R: Real> {
    /// None yet: a step begins. It is the first variant, so that an empty workspace is all zeros.
    Unknown,
    /// A linear function of the slip, from the last matrix.
    At(Linear<R>),
    /// Its value after Newton's last step.
    After(R::Vec3),
}

/// Dual unknown as a linear function of the slip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Linear<R: Real> {
    /// Dual unknown, and the slip (m/s) for which friction was differentiated.
    direction: R::Vec3,
    slip: R::Vec3,
    /// Width and growth of the friction's [`FrictionJacobian`].
    width: R,
    growth: R,
}

impl<R: Real> Linear<R> {
    /// Dual unknown after Newton's step from the slip u to the slip u':
    /// `(u' - w' g (û·(u' - u)))/w` (Chan, Golub & Mulet 1999).
    #[inline]
    fn after(&self, slip: R::Vec3) -> R::Vec3 {
        let change = (slip - self.slip).dot(direction::<R>(self.slip));
        (slip - self.direction * (self.growth * change)) * (R::ONE / self.width)
    }
}

/// Motion and force of a contact over a trial step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Push<R: Real> {
    /// Index of the surface that the contact faces.
    pub(super) surface: u32,
    /// Unit vector out of the ground.
    pub(super) normal: R::Vec3,
    pub(super) mean: MeanForce<R>,
    /// Sum of the normal force and friction, N.
    pub(super) force: R::Vec3,
    /// Mean slip, m/s.
    pub(super) slip: R::Vec3,
    /// Vector from the centre of mass to the point at which the mean force acts, m.
    pub(super) arm: R::Vec3,
    /// Vector from the centre of mass to the contact's centre at the end of the step, m.
    pub(super) end_arm: R::Vec3,
    /// Penetration depth at the start of the step, m; negative above ground.
    pub(super) depth: R,
    /// Penetration depth at the end of the step, m; negative above ground.
    pub(super) end_depth: R,
    pub(super) radius: R,
    /// Number of contacts that a point of a rim represents.
    pub(super) weight: R,
}

/// Response of friction at a contact to its slip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer<R: Real> {
    /// Slip for which friction is differentiated, m/s.
    pub(super) slip: R::Vec3,
    pub(super) drag: FrictionJacobian<R>,
    /// Newton's dual unknown: friction divided by its limit, a vector of length at most 1.
    pub(super) dual: R::Vec3,
    /// Unit vector along the slip, or 0.
    pub(super) slip_direction: R::Vec3,
}

impl<R: Real> Answer<R> {
    #[inline(always)]
    fn at(slip: R::Vec3, drag: FrictionJacobian<R>, dual: R::Vec3) -> Self {
        Self {
            slip,
            drag,
            dual,
            slip_direction: direction::<R>(slip),
        }
    }

    /// Excess of the dual force over the friction of the law, N.
    #[inline]
    pub(super) fn excess_of_dual(&self) -> R::Vec3 {
        (self.slip - self.dual * self.drag.width) * self.drag.coefficient
    }
}

/// Contribution of a Newton step to the path of every contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Increment<R: Real> {
    /// Shift of the step's end, m.
    pub(super) shift: R::Vec3,
    /// Rotation of the step's end, rad.
    pub(super) turn: R::Vec3,
    /// Twice the change of the Cayley argument.
    twist: R::Vec3,
}

impl<R: Real> Increment<R> {
    /// Creates the increment from a shift and a rotation of the step's end, for a trial with this
    /// spin.
    pub(super) fn of(shift: R::Vec3, turn: R::Vec3, spin: R::Vec3) -> Self {
        Self {
            shift,
            turn,
            twist: turn - spin.cross(turn) + spin * spin.dot(turn),
        }
    }
}

/// Change of a trial since an earlier one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Since<'a, R: Real> {
    shift: R::Vec3,
    spin: R::Vec3,
    rotation_change: Block<R>,
    /// Newton's step from the earlier trial, if slips and dual unknowns continue from its end.
    step: Option<&'a Increment<R>>,
}

impl<'a, R: Real> Since<'a, R> {
    pub(super) fn between(
        earlier: &Trial<R>,
        step: Option<&'a Increment<R>>,
        trial: &Trial<R>,
    ) -> Self {
        let back = earlier.rotation_change.scaled(-R::ONE);
        Self {
            shift: trial.shift - earlier.shift,
            spin: trial.spin - earlier.spin,
            rotation_change: trial.rotation_change.plus(&back),
            step,
        }
    }
}

impl<R: Real> Push<R> {
    /// All zeros, so that a workspace in a `static` takes no space in a program's image.
    const NONE: Self = Self {
        surface: 0,
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

    /// Returns true if there is a force, or would be one slightly deeper.
    #[inline]
    pub(super) fn is_felt(&self) -> bool {
        self.mean.force > R::ZERO || self.mean.slope > R::ZERO
    }

    /// Number of contacts that the point represents, and its inverse. `None` if the body has no
    /// rim: both are then 1.
    #[inline]
    fn weights<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>) -> Option<[R; 2]> {
        (problem.has_rims()).then(|| [self.weight, R::ONE / self.weight])
    }

    #[inline]
    pub(super) fn mean_force<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        end_depth: R,
    ) -> MeanForce<R> {
        let mean = problem.mean_force(self.surface, self.depth, end_depth);
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

    /// Derivative of a moving contact's path along the ground with respect to a rotation of the
    /// step's end, m. `None` if the contacts are fixed in the body.
    ///
    /// The path is `2a × (r + r')/2`. A rotation ϑ changes 2a by `argument ϑ`, carries the point r'
    /// along (`ϑ × r'`) and moves it over the surface. The last contribution is computed from
    /// points in two nearby directions.
    #[inline(always)]
    pub(super) fn path_by_turn<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        trial: &Trial<R>,
        argument: &Block<R>,
    ) -> Option<Block<R>> {
        let moving = problem.moving_contact()?;
        let (_, axes) = problem.place_at_end(trial);
        Some(self.path_over(moving.over_surface(self.normal, &axes), trial, argument))
    }

    fn path_over(
        &self,
        [first, second]: [(R::Vec3, R::Vec3); 2],
        trial: &Trial<R>,
        argument: &Block<R>,
    ) -> Block<R> {
        let a = trial.spin;
        let over = |(moved, turn): (R::Vec3, R::Vec3)| Block::outer(a.cross(moved), turn);
        let carried = argument.crossed_by(-self.arm);
        let turned = Block::hat(-self.end_arm).crossed_by(a);
        (carried.plus(&turned))
            .plus(&over(first))
            .plus(&over(second))
    }

    /// Change of the slip by a Newton step, m/s.
    fn slip_by<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        by: &Increment<R>,
        path_by_turn: Option<&Block<R>>,
    ) -> R::Vec3 {
        let n = self.normal;
        let path = match path_by_turn {
            Some(path_by_turn) => by.shift + path_by_turn.times(by.turn),
            None => by.shift + by.turn.cross(self.end_arm) - by.twist.cross(n * self.radius),
        };
        (path - n * n.dot(path)) * problem.per_second
    }
}

impl<R: Real> Touch<R> {
    pub(super) const NONE: Self = Self {
        arm: R::Vec3::ZERO,
        push: Push::NONE,
        dual: Dual::Unknown,
        before: R::Vec3::ZERO,
        load: R::ZERO,
        settled_depth: R::ZERO,
    };

    #[inline]
    pub(super) fn of<D: Dynamics<R>>(
        problem: &Problem<'_, R, D>,
        surface: u32,
        point: &ContactPoint<R>,
    ) -> Self {
        let mut touch = Self::NONE;
        touch.begin(problem, surface, point);
        touch
    }

    /// Sets what is known of a contact at the start of a step.
    #[inline]
    pub(super) fn begin<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        surface: u32,
        point: &ContactPoint<R>,
    ) {
        let (model, ground) = (problem.scene.contact_model(), problem.ground(surface));
        let motion = &problem.motion;
        let point = model.contact_above(&ground, (motion.position, &motion.axes), point);
        self.arm = motion.axes.to_world(point.position);
        let under = ground.surface(motion.position + self.arm);
        let push = &mut self.push;
        (push.surface, push.normal) = (surface, under.normal);
        (push.depth, push.radius) = (point.radius - under.gap, point.radius);
        push.weight = R::ONE;
        self.dual = Dual::Unknown;
        self.load = R::ZERO;
    }

    /// Becomes a contact at the start of a step. The fields that are not set here are written by
    /// the first trial that feels the contact.
    #[inline(always)]
    pub(super) fn take<D: Dynamics<R>>(&mut self, problem: &Problem<'_, R, D>, start: &Self) {
        if problem.moving_contact().is_some() {
            // Newton's matrix reads it even where no trial has felt the contact.
            self.push = start.push;
        }
        (self.arm, self.push.depth) = (start.arm, start.push.depth);
        (self.dual, self.load) = (Dual::Unknown, R::ZERO);
        (self.push.radius, self.push.weight) = (start.push.radius, R::ONE);
        self.push.surface = start.push.surface;
        if let Some(plane) = &problem.plane {
            self.push.normal = plane.normal;
        }
    }

    /// Becomes a point of a rim (m, body axes) that represents a number of contact points. The
    /// other fields are written by the trial that follows.
    #[inline(always)]
    pub(super) fn lay<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        surface: u32,
        place: R::Vec3,
        weight: R,
    ) {
        let motion = &problem.motion;
        self.arm = motion.axes.to_world(place);
        let under = problem.ground(surface).surface(motion.position + self.arm);
        let push = &mut self.push;
        (push.surface, push.normal) = (surface, under.normal);
        (push.depth, push.radius, push.weight) = (R::ZERO - under.gap, R::ZERO, weight);
        self.load = R::ZERO;
    }

    /// Position at which friction is evaluated, m, world axes. It is computed only for a law that
    /// depends on it.
    #[inline(always)]
    fn friction_position<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>) -> R::Vec3 {
        if problem.scene.friction().depends_on_position() {
            problem.middle_of(self.push.surface, self.arm, self.push.radius)
        } else {
            R::Vec3::ZERO
        }
    }

    /// Friction (N) of a slip under the mean normal force of the last trial.
    #[inline]
    pub(super) fn friction<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        slip: R::Vec3,
    ) -> R::Vec3 {
        let (push, position) = (&self.push, self.friction_position(problem));
        match push.weights(problem) {
            Some([weight, each]) => {
                problem.friction(push.surface, position, push.mean.force * each, slip) * weight
            }
            None => problem.friction(push.surface, position, push.mean.force, slip),
        }
    }

    /// Derivative of the friction of one point with respect to the magnitude of the slip, N s/m.
    fn friction_slope<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>) -> R {
        let drag = self.jacobian(problem);
        let steepness = R::ONE - drag.growth * (self.push.slip.length() / drag.width);
        drag.coefficient * steepness.at_least(R::ZERO) / self.push.weight
    }

    /// Derivatives of the friction at the last trial.
    #[inline]
    pub(super) fn jacobian<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
    ) -> FrictionJacobian<R> {
        self.jacobian_at(problem, self.push.slip)
    }

    /// Derivatives of the friction of a slip under the mean normal force of the last trial.
    #[inline]
    fn jacobian_at<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        slip: R::Vec3,
    ) -> FrictionJacobian<R> {
        let (push, position) = (&self.push, self.friction_position(problem));
        let Some([weight, each]) = push.weights(problem) else {
            return problem.jacobian(push.surface, position, push.mean.force, slip);
        };
        let drag = problem.jacobian(push.surface, position, push.mean.force * each, slip);
        FrictionJacobian {
            coefficient: drag.coefficient * weight,
            ..drag
        }
    }

    /// Returns true if there is a force, or if Newton's last step has predicted one.
    #[inline(always)]
    fn may_be_felt(&self) -> bool {
        self.push.is_felt() || self.load > R::ZERO
    }

    /// Computes motion and force of a bare contact on level ground over a trial step. Returns true
    /// if there is a force.
    #[inline(always)]
    pub(super) fn respond_on_level<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        trial: &Trial<R>,
    ) -> bool {
        let swung = trial.rotation_change.times(self.arm);
        let moved = trial.shift + swung;
        let end_depth = self.push.depth - moved.z();
        let mean = self.push.mean_force(problem, end_depth);
        self.push.end_depth = end_depth;
        self.push.mean = mean;
        if !self.may_be_felt() {
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

    /// Computes motion and force of a contact over a trial step, by the shorter computation where
    /// that is possible.
    #[inline]
    pub(super) fn respond_anywhere<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        trial: &Trial<R>,
    ) {
        if problem.is_bare {
            self.respond_on_level(problem, trial);
        } else {
            self.respond(problem, trial);
        }
    }

    /// Computes motion and force of a contact of any kind on any ground. Returns the torque
    /// correction of a smooth body.
    #[inline(never)]
    pub(super) fn respond<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        trial: &Trial<R>,
    ) -> Lever<R> {
        let moving = problem.moving_contact();
        let swung = match &moving {
            Some(moving) => end_arm(problem, moving, self.push.surface, trial) - self.arm,
            None => trial.rotation_change.times(self.arm),
        };
        let moved = trial.shift + swung;
        let (normal, end_depth) = self.fall(problem, moved);
        self.push.normal = normal;
        self.push.end_depth = end_depth;
        self.push.mean = self.push.mean_force(problem, end_depth);
        if !self.may_be_felt() {
            return Lever::NONE;
        }
        let end_arm = self.arm + swung;
        let mut arm = (self.arm + end_arm) * R::HALF;
        let mut lever = Lever::NONE;
        let mut along = moved - normal * normal.dot(moved);
        let radius = self.push.radius;
        if moving.is_some() {
            lever = Lever::new(arm, normal, swung, trial.spin);
            let path = trial.shift + trial.spin.cross(arm) * R::TWO;
            along = path - normal * normal.dot(path);
        } else if radius > R::ZERO {
            // The contact point is a radius below the centre of the contact and is carried along by
            // the rotation.
            arm -= normal * radius;
            along -= trial.spin.cross(normal) * (radius * R::TWO);
        }
        let friction = self.slide(problem, along, arm, end_arm);
        self.push.force = normal * self.push.mean.force + friction;
        lever
    }

    /// Computes motion and force like [`respond`](Self::respond), and keeps the last slip, to which
    /// Newton's step has [advanced](Self::advance) it.
    ///
    /// The slip is kept if it agrees with the difference of velocities to rounding. It has the same
    /// error in each iteration. The friction of a slip far below that rounding is therefore
    /// determined.
    pub(super) fn respond_with_slip<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        trial: &Trial<R>,
    ) -> Lever<R> {
        let last = self.push;
        let lever = self.respond(problem, trial);
        let rounding = problem.rounding_of_path(trial) * problem.per_second;
        let is_same = (last.slip - self.push.slip).length() <= rounding;
        if last.is_felt() && self.push.is_felt() && is_same {
            self.push.slip = last.slip;
            let friction = self.friction(problem, last.slip);
            self.push.force = self.push.normal * self.push.mean.force + friction;
        }
        lever
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
        let slip = along * problem.per_second - problem.ground_velocity(arm, self.push.normal);
        self.push.slip = slip;
        self.push.arm = arm;
        self.push.end_arm = end_arm;
        self.friction(problem, slip)
    }

    /// Normal along which the force does the work of the springs, and the depth at the end, for a
    /// contact whose centre moves by `moved`.
    #[inline]
    fn fall<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>, moved: R::Vec3) -> (R::Vec3, R) {
        if let Some(plane) = &problem.plane_of(self.push.surface) {
            return (plane.normal, self.push.depth - plane.normal.dot(moved));
        }
        self.fall_on_a_shape(problem, moved)
    }

    /// Normal and depth like [`fall`](Self::fall), on ground that is not a plane: Gonzalez's
    /// discrete gradient, so that normal times path is the change of depth.
    ///
    /// A change of depth within its rounding is not corrected. Divided by the path of a contact at
    /// rest, it would turn the normal by any angle.
    #[cold]
    #[inline(never)]
    fn fall_on_a_shape<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        moved: R::Vec3,
    ) -> (R::Vec3, R) {
        let ground = problem.ground(self.push.surface);
        let start = problem.motion.position + self.arm;
        let middle = ground.surface(start + moved * R::HALF).normal;
        let end_depth = self.push.radius - ground.surface(start + moved).gap;
        let square = moved.length_squared();
        let residual = (self.push.depth - end_depth) - middle.dot(moved);
        if residual.abs() > problem.rounding_of_gap() && residual.abs() < square.sqrt() {
            (middle + moved * (residual / square), end_depth)
        } else {
            (middle, end_depth)
        }
    }

    /// Computes the response of friction at the last trial step.
    #[inline(always)]
    pub(super) fn answer<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>) -> Answer<R> {
        let slip = self.push.slip;
        let drag = self.jacobian(problem);
        let dual = match &self.dual {
            Dual::After(dual) => *dual,
            Dual::At(last) => on_disc::<R>(last.after(slip)),
            // A slide that the step can hardly brake begins with Newton's own derivative.
            Dual::Unknown
                if drag.coefficient * problem.seconds < problem.mass * R::from_f64(HARDLY) =>
            {
                slip * (R::ONE / drag.width)
            }
            _ => {
                // Field by field, so that the answer of a slide stays in registers.
                let Answer {
                    slip, drag, dual, ..
                } = self.answer_in_stick(problem, &drag);
                return Answer::at(slip, drag, dual);
            }
        };
        Answer::at(slip, drag, dual)
    }

    /// Computes the response of friction at the last trial step by Newton's own derivative, if
    /// friction can hardly brake the slide of a body on this number of such contacts.
    #[inline]
    pub(super) fn answer_of_slide<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        drag: &FrictionJacobian<R>,
        contacts: usize,
    ) -> Option<Answer<R>> {
        let of_all = drag.coefficient * R::from_usize(contacts);
        (of_all * problem.seconds < problem.mass * R::from_f64(HARDLY)).then(|| {
            Answer::at(
                self.push.slip,
                *drag,
                self.push.slip * (R::ONE / drag.width),
            )
        })
    }

    /// Response of friction with these derivatives and the dual unknown that continues.
    #[inline]
    pub(super) fn continued_answer(&self, drag: FrictionJacobian<R>) -> Answer<R> {
        let slip = self.push.slip;
        let dual = match &self.dual {
            Dual::Unknown => slip * (R::ONE / drag.width),
            Dual::At(last) => on_disc::<R>(last.after(slip)),
            Dual::After(dual) => *dual,
        };
        Answer::at(slip, drag, dual)
    }

    /// Computes the response of friction of a contact that the step may stop.
    ///
    /// In stick, the slip at the start of the step is the creep at the end of the step before,
    /// while the slip of the first trial is far above it. At the first trial, friction is
    /// differentiated for the slip at the start, and [`excess`](Self::excess) accounts for the
    /// difference.
    #[cold]
    #[inline(never)]
    fn answer_in_stick<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        drag: &FrictionJacobian<R>,
    ) -> Answer<R> {
        let (n, slip) = (self.push.normal, self.push.slip);
        let arm = self.arm - n * self.push.radius;
        let velocity = problem.motion.velocity_at(arm) - problem.ground_velocity(arm, n);
        let slip_at_start = velocity - n * n.dot(velocity);
        let at_start = self.jacobian_at(problem, slip_at_start);
        let dual_at_start = slip_at_start * (R::ONE / at_start.width);
        // Along a rim that rolls or spins, friction reverses, and points near its reversal have a
        // small slip for that reason. The reversal has a derivative of its own.
        let is_rim = problem.has_rims();
        let ratio = R::from_f64(if is_rim { 1.0 / 16.0 } else { 0.5 });
        let sticks = at_start.coefficient * problem.seconds > problem.mass * R::TWO
            && slip_at_start.length() < slip.length() * ratio;
        if sticks {
            Answer::at(slip_at_start, at_start, dual_at_start)
        } else if is_rim && slip_at_start.dot(slip) < R::ZERO {
            Answer::at(slip, *drag, slip * (R::ONE / drag.width))
        } else {
            Answer::at(slip, *drag, dual_at_start)
        }
    }

    /// Excess of the linear friction in the matrix over the friction of the law at the last trial,
    /// N. With `to_dual`, that of the dual force.
    pub(super) fn excess<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        to_dual: bool,
    ) -> R::Vec3 {
        let slip = self.push.slip;
        let dual = match &self.dual {
            Dual::At(at) if to_dual => at.direction,
            Dual::After(dual) if to_dual => *dual,
            Dual::At(at) if at.slip != slip => at.after(slip),
            _ => return R::Vec3::ZERO,
        };
        let drag = self.jacobian(problem);
        (slip - dual * drag.width) * drag.coefficient
    }

    /// Derivative of the last linear force with respect to the normal force.
    pub(super) fn loaded<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>) -> R::Vec3 {
        let slip = match &self.dual {
            Dual::At(at) => at.slip,
            _ => self.push.slip,
        };
        self.push.normal - slip * self.jacobian_at(problem, slip).per_load
    }

    /// Advances slip and dual unknown to the end of a Newton step.
    pub(super) fn advance<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        by: &Increment<R>,
        path_by_turn: Option<&Block<R>>,
    ) {
        self.push.slip += self.push.slip_by(problem, by, path_by_turn);
        if let Dual::At(at) = &self.dual {
            self.before = at.direction;
            self.dual = Dual::After(on_disc::<R>(at.after(self.push.slip)));
        }
    }

    /// Gives a contact that is not stored the dual unknown at a trial before the last one, advanced
    /// by the Newton step from there. It continues from the dual unknown of the stored contact that
    /// it follows, if there is one before that trial.
    ///
    /// The load is that of the last trial. For most laws the dual unknown does not depend on it.
    #[cold]
    #[inline(never)]
    pub(super) fn look_back<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        since: &Since<'_, R>,
        first: Option<&Self>,
    ) {
        let (slip, end_arm, n) = (self.push.slip, self.push.end_arm, self.push.normal);
        let swung = since.rotation_change.times(self.arm);
        let path = since.shift + swung - since.spin.cross(n) * (self.push.radius * R::TWO);
        self.push.slip -= (path - n * n.dot(path)) * problem.per_second;
        self.push.end_arm -= swung;
        if let Some(first) = first {
            let drag = self.jacobian(problem);
            self.remember(&Answer::at(self.push.slip, drag, first.last_dual()));
        } else {
            self.note_answer(problem);
        }
        if let Some(by) = since.step {
            self.advance(problem, by, None);
        }
        (self.push.slip, self.push.end_arm) = (slip, end_arm);
    }

    /// Dual unknown where friction was last differentiated, 0 if nowhere.
    fn last_dual(&self) -> R::Vec3 {
        match &self.dual {
            Dual::Unknown => R::Vec3::ZERO,
            Dual::At(at) => at.direction,
            Dual::After(_) => self.before,
        }
    }

    /// Stores the data from which the next dual unknown is computed.
    #[inline(always)]
    pub(super) fn remember(&mut self, answer: &Answer<R>) {
        self.dual = Dual::At(Linear {
            direction: answer.dual,
            slip: answer.slip,
            width: answer.drag.width,
            growth: answer.drag.growth,
        });
    }

    /// Computes and stores the dual unknown at the last trial.
    #[cold]
    #[inline(never)]
    pub(super) fn note_answer<D: Dynamics<R>>(&mut self, problem: &Problem<'_, R, D>) {
        if self.push.is_felt() {
            let answer = self.answer(problem);
            self.remember(&answer);
        }
    }
}

/// Vector from the centre of mass to the moving contact with a surface at the end of a trial step,
/// m, world axes.
#[inline]
fn end_arm<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    moving: &MovingContact<'_, D::Body, R>,
    surface: u32,
    trial: &Trial<R>,
) -> R::Vec3 {
    let (position, axes) = problem.place_at_end(trial);
    let facing = moving.above(&problem.ground(surface), position, &axes);
    axes.to_world(facing.position)
}

/// Torque that a smooth body's normal force needs in addition to that of the mean arm, divided by
/// the force, m.
///
/// With the step's rotation `2a`, the force does the work of the springs if
/// `normal · (2a × arm) = normal · swung`, where `swung` is the change of the arm. The mean of the
/// arms at start and end satisfies this, except for terms of third order in the rotation. The
/// reason is that at the contact point the surface moves like the material of the body. The missing
/// work is done by a torque along the part of the rotation across the normal, if that part is not
/// too small to divide by.
///
/// In single precision, a torque whose size is within its rounding is left out, but its rounding is
/// stored, because a neighbouring trial may include the torque. A torque well above rounding is
/// used up to the length of the mean arm. On a flat or long body the point moves by much more than
/// the rotation.
///
/// Friction acts at the mean arm, where its slip is measured. A correction of the arm in place of
/// the torque would add the rounding of the division to the slip. Stick multiplies that rounding by
/// `μ N/ε`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lever<R: Real> {
    pub(super) torque: R::Vec3,
    /// Part of the torque that is rounding of the points of the surface.
    pub(super) rounding: R::Vec3,
}

impl<R: Real> Lever<R> {
    pub(super) const NONE: Self = Self {
        torque: R::Vec3::ZERO,
        rounding: R::Vec3::ZERO,
    };

    /// Adds the lever of another contact, as the mean of both with the normal forces as weights.
    ///
    /// `known` is the normal force of the contacts before, N, and `normal_force` that of the next.
    #[inline]
    pub(super) fn with(self, other: Self, known: &mut R, normal_force: R) -> Self {
        let sum = *known + normal_force;
        if *known == R::ZERO {
            *known = sum;
            return other;
        }
        let share = normal_force / sum;
        *known = sum;
        Self {
            torque: self.torque + (other.torque - self.torque) * share,
            rounding: self.rounding + (other.rounding - self.rounding) * share,
        }
    }

    #[inline]
    fn new(mean: R::Vec3, normal: R::Vec3, swung: R::Vec3, spin: R::Vec3) -> Self {
        let across = (spin - normal * normal.dot(spin)) * R::TWO;
        let square = across.length_squared();
        let residual = normal.dot(swung) - normal.cross(spin).dot(mean) * R::TWO;
        let most = mean.length() * (square * spin.length_squared()).sqrt();
        let rounding = mean.length() * (R::EPSILON * R::from_f64(4.0));
        let is_large = is_single::<R>()
            && residual.abs() > rounding * R::from_f64(64.0)
            && residual * residual <= square * mean.length_squared();
        let is_known = residual.abs() > rounding && (residual.abs() <= most || is_large);
        let may_be_known = is_single::<R>() && rounding <= most && residual.abs() <= rounding;
        if !(square > R::ZERO && (is_known || may_be_known)) {
            return Self::NONE;
        }
        let per_residual = across * (R::ONE / square);
        Self {
            torque: if is_known {
                per_residual * residual
            } else {
                R::Vec3::ZERO
            },
            rounding: per_residual * rounding,
        }
    }
}

/// A point of a rim at which friction reverses, between the points on either side.
///
/// A shift `δ` of the slip moves that point by `δ/u'`, where `u'` is the slope of the slip along
/// the rim. The neighbouring points move with the rim and keep their friction, which is far from
/// its reversal. Their own derivatives therefore do not contain the reversal. The friction that
/// changes its sign is `2 μ p δ/u'`, with `p` the load per length at the reversal. For any law,
/// `μ p` follows from the frictions on both sides. The slope `u'` is that of the parabolas through
/// the slips of three points, two on one side and one on the other. It differs from the slope
/// between the two nearest points by several per cent, and with it the rate at which Newton's
/// iteration converges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reversal<R: Real> {
    /// Lever arm from the centre of mass, mean over the step, m.
    pub(super) arm: R::Vec3,
    /// Lever arm at the end of the step, m.
    pub(super) end_arm: R::Vec3,
    /// Direction in which the slip changes along the rim, unit vector.
    pub(super) direction: R::Vec3,
    /// Resistance to a slip in that direction, excluding that of the points themselves, N s/m.
    pub(super) coefficient: R,
}

impl<R: Real> Reversal<R> {
    /// Creates the reversal between the middle two of four neighbouring points if their slips are
    /// opposite.
    pub(super) fn between<D: Dynamics<R>>(
        problem: &Problem<'_, R, D>,
        [before, left, right, after]: [&Touch<R>; 4],
        points_per_metre: R,
    ) -> Option<Self> {
        let (a, b) = (&left.push, &right.push);
        let is_beside = |touch: &Touch<R>| touch.push.surface == a.surface && touch.push.is_felt();
        if !(is_beside(left) && is_beside(right) && a.slip.dot(b.slip) < R::ZERO) {
            return None;
        }
        let change = b.slip - a.slip;
        let direction = direction::<R>(change);
        let slips = [before, left, right, after].map(|touch| touch.push.slip.dot(direction));
        let gap = |from: &Touch<R>, to: &Touch<R>| (to.arm - from.arm).length();
        let gaps = [gap(before, left), gap(left, right), gap(right, after)];
        // Position of the reversal between the two points, from 0 to 1.
        let place = slips[1] / (slips[1] - slips[2]);
        // The slip of a point that is not felt is that of an earlier trial.
        let bend = if is_beside(before) && is_beside(after) {
            relative_slope(slips, gaps, place)
        } else {
            R::ONE
        };
        let braking = |push: &Push<R>| -push.force.dot(direction) / push.weight;
        let reversed = (braking(b) * place - braking(a) * (R::ONE - place)) * R::TWO;
        let slope = reversed / (change.length() * bend);
        let of_points = (left.friction_slope(problem) + right.friction_slope(problem)) * R::HALF;
        let coefficient = (slope - of_points) * (gaps[1] * points_per_metre);
        (coefficient > R::ZERO).then(|| Self {
            arm: (a.arm + b.arm) * R::HALF,
            end_arm: (a.end_arm + b.end_arm) * R::HALF,
            direction,
            coefficient,
        })
    }
}

/// Slope of a function at a position (0 to 1) between the middle two of four points, divided by the
/// slope between these two. The function is known at the points by its values and by the gaps
/// between them. A slope of less than half is not used.
fn relative_slope<R: Real>(values: [R; 4], gaps: [R; 3], place: R) -> R {
    let slope = |i: usize| (values[i + 1] - values[i]) / gaps[i];
    let [first, middle, last] = [slope(0), slope(1), slope(2)];
    let bend = (middle - first) / (gaps[0] + gaps[1]) + (last - middle) / (gaps[1] + gaps[2]);
    let more = bend * (place - R::HALF) * gaps[1] / middle;
    if more > -R::HALF {
        R::ONE + more
    } else {
        R::ONE
    }
}

/// Unit vector along `slip`, or 0.
#[inline]
fn direction<R: Real>(slip: R::Vec3) -> R::Vec3 {
    let speed = slip.length();
    if speed > R::ZERO {
        slip * (R::ONE / speed)
    } else {
        R::Vec3::ZERO
    }
}

/// Projects a vector on the unit disc.
#[inline]
fn on_disc<R: Real>(vector: R::Vec3) -> R::Vec3 {
    let square = vector.length_squared();
    if square > R::ONE {
        vector * (R::ONE / square.sqrt())
    } else {
        vector
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Coulomb, Disc, Energy, FlatGround, State, Stepper};
    use glam::DVec3;

    /// Four neighbouring points with these slips along y, m/s.
    fn four_points(slips: [f64; 4], felt: [bool; 4]) -> [Touch<f64>; 4] {
        core::array::from_fn(|i| {
            let mut touch = Touch::NONE;
            touch.arm = DVec3::new(0.0, 0.01 * i as f64, -0.3);
            touch.push.slip = DVec3::Y * slips[i];
            touch.push.force = DVec3::Y * -slips[i].signum();
            (touch.push.normal, touch.push.weight) = (DVec3::Z, 2.0);
            touch.push.mean.force = if felt[i] { 2.0 } else { 0.0 };
            touch
        })
    }

    fn coefficient(points: &[Touch<f64>; 4]) -> Option<f64> {
        let stepper = Stepper::builder(Disc::<f64>::solid(1.0, 0.3, 40))
            .ground(FlatGround::level(1e3, 1.0))
            .friction(Coulomb {
                coefficient: 0.3,
                slip_speed: 1e-3,
            })
            .build()
            .unwrap();
        let start = State::at(DVec3::Z * 0.3);
        let energy = Energy::of(stepper.scene(), &start);
        let problem = Problem::new(stepper.scene(), &start, &energy, 1e-3);
        Reversal::between(&problem, points.each_ref(), 100.0).map(|found| found.coefficient)
    }

    /// The slip of a point that is not felt is that of an earlier trial, or of an earlier step.
    #[test]
    fn a_reversal_of_friction_reads_no_slip_of_a_point_that_is_not_felt() {
        let all = |slips| coefficient(&four_points(slips, [true; 4]));
        let [flat, bent] = [[-0.25, -0.05, 0.15, 0.35], [-0.25, -0.05, 0.15, 0.5]].map(all);
        assert!(flat.is_some() && flat != bent, "{flat:?}");
        for felt in [[true, true, true, false], [false, true, true, true]] {
            for outer in [0.5, -7.0, f64::NAN] {
                let left = if felt[0] { -0.25 } else { outer };
                let right = if felt[3] { 0.35 } else { outer };
                let slips = [left, -0.05, 0.15, right];
                assert_eq!(coefficient(&four_points(slips, felt)), flat, "{outer}");
            }
        }
        let inner = four_points([-0.25, -0.05, 0.15, 0.35], [true, true, false, true]);
        assert_eq!(coefficient(&inner), None);
    }
}
