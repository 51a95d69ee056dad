//! One contact of an implicit step: its path over a trial step, and the corresponding force.

use super::dual::{Dual, on_disc};
use super::lever::Lever;
use super::partial;
use super::problem::{Problem, TrialStep};
use crate::body::ContactPoint;
use crate::contact::MovingContact;
use crate::friction::{FrictionJacobian, Metric, RollingResistance, SlidingFriction};
use crate::ground::{MeanForce, SpringDamperGround};
use crate::integrator::matrix3::Matrix3;
use crate::real::{Real, Vector};
use crate::scene::Dynamics;

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
    pub(super) load_depth: R,
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
    /// Cayley argument.
    pub(super) fn of(shift: R::Vec3, turn: R::Vec3, cayley: R::Vec3) -> Self {
        Self {
            shift,
            turn,
            twist: turn - cayley.cross(turn) + cayley * cayley.dot(turn),
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
    pub(super) fn is_active(&self) -> bool {
        self.mean.force > R::ZERO || self.mean.slope > R::ZERO
    }

    /// Returns true if a contact with a force touches for a part of the step only, and if that
    /// makes a [difference](partial) to friction.
    #[inline(always)]
    fn needs_part(&self, law: &impl SlidingFriction<R>) -> bool {
        !law.is_proportional_to_load() && self.depth.at_most(self.end_depth) <= R::ZERO
    }

    /// Part of the step for which the contact touches, at least `EPSILON`. It is the whole one if
    /// both ends are above the ground, as of a contact whose force Newton's last step has
    /// predicted.
    pub(super) fn part_in_contact(&self) -> R {
        let deeper = self.depth.at_least(self.end_depth);
        if deeper <= R::ZERO {
            return R::ONE;
        }
        (deeper / (self.depth - self.end_depth).abs()).at_least(R::EPSILON)
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
        trial: &TrialStep<R>,
        argument: &Matrix3<R>,
    ) -> Option<Matrix3<R>> {
        let moving = problem.moving_contact()?;
        let (_, axes) = problem.place_at_end(trial);
        Some(self.path_over(moving.over_surface(self.normal, &axes), trial, argument))
    }

    fn path_over(
        &self,
        [first, second]: [(R::Vec3, R::Vec3); 2],
        trial: &TrialStep<R>,
        argument: &Matrix3<R>,
    ) -> Matrix3<R> {
        let a = trial.cayley;
        let over = |(moved, turn): (R::Vec3, R::Vec3)| Matrix3::outer(a.cross(moved), turn);
        let carried = argument.crossed_by(-self.arm);
        let turned = Matrix3::hat(-self.end_arm).crossed_by(a);
        (carried.plus(&turned))
            .plus(&over(first))
            .plus(&over(second))
    }

    /// Change of the slip by a Newton step, m/s.
    pub(super) fn slip_by<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        by: &Increment<R>,
        path_by_turn: Option<&Matrix3<R>>,
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
        load_depth: R::ZERO,
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
    /// the first trial in which the contact is active.
    #[inline(always)]
    pub(super) fn take<D: Dynamics<R>>(&mut self, problem: &Problem<'_, R, D>, start: &Self) {
        if problem.moving_contact().is_some() {
            // Newton's matrix reads it even if the contact was active in no trial.
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
    pub(super) fn become_rim_point<D: Dynamics<R>>(
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
        let friction = |load| {
            if push.needs_part(&problem.law(push.surface)) {
                let part = (push.surface, push.part_in_contact());
                partial::friction(problem, part, (position, load), slip)
            } else {
                problem.friction(push.surface, position, load, slip)
            }
        };
        match push.weights(problem) {
            Some([weight, each]) => friction(push.mean.force * each) * weight,
            None => friction(push.mean.force),
        }
    }

    /// Resistance to rolling and spinning under a normal force (N).
    pub(super) fn rolling_resistance<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        normal_force: R,
    ) -> Option<RollingResistance<R>> {
        let (push, position) = (&self.push, self.friction_position(problem));
        let law = problem.law(push.surface);
        let [weight, each] = push.weights(problem).unwrap_or([R::ONE; 2]);
        let load = normal_force * each;
        let of_one = if push.needs_part(&law) {
            partial::resistance(&law, push.part_in_contact(), (position, load))?
        } else {
            law.rolling_resistance_at(position, load)?
        };
        Some(RollingResistance {
            rolling: of_one.rolling * weight,
            spinning: of_one.spinning * weight,
            ..of_one
        })
    }

    /// Torque (N m for a load of 1 N) of resistance to rolling and spinning at a [mean
    /// rotation](Problem::mean_rotation), under the mean normal force. `None` without a force or
    /// resistance.
    pub(super) fn torque_of_unit_load<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        (angular_velocity, resolution): (R::Vec3, R),
    ) -> Option<R::Vec3> {
        let load = self.push.mean.force;
        if load <= R::ZERO {
            return None;
        }
        let law = self.rolling_resistance(problem, load)?;
        let normal = self.normal_of_resistance(problem);
        let torque = law.torque_resolving(resolution, normal, angular_velocity);
        Some(torque * (R::ONE / load))
    }

    /// Normal of the ground at which rolling and spinning are told apart: that at the middle of the
    /// step, which [does not depend on the trial](Problem::middle_of).
    pub(super) fn normal_of_resistance<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
    ) -> R::Vec3 {
        let surface = self.push.surface;
        problem.plane_of(surface).map_or_else(
            || {
                let middle = problem.middle_of(surface, self.arm, self.push.radius);
                problem.ground(surface).surface(middle).normal
            },
            |plane| plane.normal,
        )
    }

    /// Derivative of the friction of one point with respect to the magnitude of the slip, N s/m.
    pub(super) fn friction_slope<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>) -> R {
        let jacobian = self.jacobian(problem);
        let steepness = R::ONE - jacobian.growth * (self.push.slip.length() / jacobian.width);
        jacobian.coefficient * steepness.at_least(R::ZERO) / self.push.weight
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
    pub(super) fn jacobian_at<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        slip: R::Vec3,
    ) -> FrictionJacobian<R> {
        let (push, position) = (&self.push, self.friction_position(problem));
        let jacobian = |load| {
            if push.needs_part(&problem.law(push.surface)) {
                let part = (push.surface, push.part_in_contact());
                partial::jacobian(problem, part, (position, load), slip)
            } else {
                problem.jacobian(push.surface, position, load, slip)
            }
        };
        let Some([weight, each]) = push.weights(problem) else {
            return jacobian(push.mean.force);
        };
        let jacobian = jacobian(push.mean.force * each);
        FrictionJacobian {
            coefficient: jacobian.coefficient * weight,
            ..jacobian
        }
    }

    /// Metric of the friction law, scaled for a slip, if the law is not isotropic.
    #[inline]
    pub(super) fn metric<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        slip: R::Vec3,
    ) -> Option<Metric<R>> {
        let law = problem.law(self.push.surface);
        // The position costs much, and a law has a metric everywhere or nowhere.
        law.metric_at(R::Vec3::ZERO)?;
        Metric::of(&law, self.friction_position(problem), slip)
    }

    /// Returns true if there is a force, or if Newton's last step has predicted one.
    #[inline(always)]
    fn may_be_active(&self) -> bool {
        self.push.is_active() || self.load > R::ZERO
    }

    /// Vector from the centre of mass to the contact's centre at the end of a trial step, m. One
    /// without a force has it from the rotation of the body: the trial has stored none.
    pub(super) fn end_arm<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
    ) -> R::Vec3 {
        if self.may_be_active() {
            return self.push.end_arm;
        }
        match problem.moving_contact() {
            Some(moving) => end_arm(problem, &moving, self.push.surface, trial),
            None => self.arm + trial.rotation_change.times(self.arm),
        }
    }

    /// Computes motion and force of a bare contact on level ground over a trial step. Returns true
    /// if there is a force.
    #[inline(always)]
    pub(super) fn respond_on_level<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
    ) -> bool {
        let swung = trial.rotation_change.times(self.arm);
        let moved = trial.shift + swung;
        let end_depth = self.push.depth - moved.z();
        let mean = self.push.mean_force(problem, end_depth);
        self.push.end_depth = end_depth;
        self.push.mean = mean;
        if !self.may_be_active() {
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
    /// that is possible. Returns the torque correction of a smooth body.
    #[inline]
    pub(super) fn respond_anywhere<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
    ) -> Lever<R> {
        if problem.is_bare() {
            self.respond_on_level(problem, trial);
            Lever::NONE
        } else {
            self.respond(problem, trial)
        }
    }

    /// Computes motion and force of a contact of any kind on any ground. Returns the torque
    /// correction of a smooth body.
    #[inline(never)]
    pub(super) fn respond<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
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
        if !self.may_be_active() {
            return Lever::NONE;
        }
        let end_arm = self.arm + swung;
        let mut arm = (self.arm + end_arm) * R::HALF;
        let mut lever = Lever::NONE;
        let mut along = moved - normal * normal.dot(moved);
        let radius = self.push.radius;
        if moving.is_some() {
            lever = Lever::new(arm, normal, swung, trial.cayley);
            let path = trial.shift + trial.cayley.cross(arm) * R::TWO;
            along = path - normal * normal.dot(path);
        } else if radius > R::ZERO {
            // The contact point is a radius below the centre of the contact and is carried along by
            // the rotation.
            arm -= normal * radius;
            along -= trial.cayley.cross(normal) * (radius * R::TWO);
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
        trial: &TrialStep<R>,
    ) -> Lever<R> {
        let last = self.push;
        let lever = self.respond(problem, trial);
        let rounding = problem.rounding_of_path(trial) * problem.per_second;
        let is_same = (last.slip - self.push.slip).length() <= rounding;
        if last.is_active() && self.push.is_active() && is_same {
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

    /// Advances slip and dual unknown to the end of a Newton step.
    pub(super) fn advance<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        by: &Increment<R>,
        path_by_turn: Option<&Matrix3<R>>,
    ) {
        self.push.slip += self.push.slip_by(problem, by, path_by_turn);
        if let Dual::At(at) = &self.dual {
            self.before = at.direction;
            self.dual = Dual::After(on_disc::<R>(self.dual_after(problem, at)));
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
    trial: &TrialStep<R>,
) -> R::Vec3 {
    let (position, axes) = problem.place_at_end(trial);
    let facing = moving.above(&problem.ground(surface), position, &axes);
    axes.to_world(facing.position)
}
