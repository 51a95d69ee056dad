//! The equations of one implicit step: the data at its start, a trial for its end, and the state
//! that a trial represents.
//!
//! # Resolution of the slip in single precision
//!
//! A slip is a difference of velocities, and is rounded as they are. Under a load that stops the
//! body within a few steps, the friction of a slip speed near that rounding exceeds the inertia by
//! more than the precision. Newton's matrix then loses the inertia, and the friction of stick has
//! any direction. So friction is linear in the slip if two conditions hold. The slip and the slip
//! speed of the law together are below some [`ROUNDINGS`] of the body's fastest points at the start
//! of the step, and the strain of friction is above [`RESOLVED`]. The slip speed is then in effect
//! the one at which the first of them ends. Friction still opposes the slip, with the friction of
//! the law at most. A body that hardly moves, such as one that friction holds on a slope, has the
//! law as it is, and so has one that rolls under its weight, unless the slip speed is very small.

use super::resistances::resolution;
use crate::contact::{Motion, MovingContact};
use crate::energy::Energy;
use crate::force::Force;
use crate::friction::{FrictionJacobian, LawOfSurface, SlidingFriction};
use crate::ground::{MeanForce, OneSurface, Plane, SpringDamperGround, Surface};
use crate::integrator::matrix3::Matrix3;
use crate::real::{Real, Vector, is_single};
use crate::rotation::{Axes, Rotation};
use crate::scene::Dynamics;
use crate::state::State;

/// Size of the resolution of a slip in rounding errors of the velocity. With 256 and 64 of them,
/// the worst impacts of random boxes were 0.2 of their speed wrong, as without.
const ROUNDINGS: f64 = 1024.0;
/// Strain `h c/m` of friction with the coefficient c up to which the law stays as it is. A ball
/// that rolls under its weight in steps of 1 ms has it at a slip speed of `8e-5 μ` m/s. With 512
/// instead, the worst hundredth of the impacts of random boxes had four times the error.
const RESOLVED: f64 = 128.0;

/// Forces that act in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Forces<R: Real> {
    /// Those of all laws, on points of the body without a radius, and the ground is level.
    BarePoints,
    /// Those of all laws, on contacts of any kind and ground of any shape.
    AnyContacts,
    /// Springs alone, without friction and dampers. The factor multiplies them during a
    /// [continuation](super::soften).
    Springs { factor: Option<R> },
}

/// Data of a step at its start.
#[derive(Clone, Copy, Debug)]
pub(super) struct Problem<'a, R: Real, D> {
    pub(super) scene: &'a D,
    pub(super) start: State<R>,
    pub(super) rotation: Rotation<R>,
    pub(super) motion: Motion<R>,
    /// Angular momentum without the part that a degenerate body cannot have (a rod, about its own
    /// axis).
    pub(super) angular_momentum: R::Vec3,
    /// The ground, if it is one plane.
    pub(super) plane: Option<Plane<R>>,
    pub(super) forces: Forces<R>,
    pub(super) seconds: R,
    pub(super) per_second: R,
    /// Time for which the applied force acts after the step, s.
    pub(super) force_seconds: R,
    /// State before the applied force acted, if it acted just before the step.
    pub(super) unpushed: Option<&'a State<R>>,
    /// Slip that a step in single precision can tell from 0, m/s.
    pub(super) slip_resolution: R,
    pub(super) mass: R,
    /// Inertia tensor at the start, world axes. A principal moment of zero is replaced by the
    /// largest moment, and the angular momentum about that axis by zero.
    pub(super) inertia: Matrix3<R>,
    /// Length that represents the size of the body, m, positive.
    pub(super) bounding_radius: R,
    /// Size of the numbers whose difference is the depth of a contact, m.
    pub(super) depth_scale: R,
    /// Kinetic energy at the start, J.
    pub(super) kinetic_energy: R,
    /// Energy of the springs at the start, J.
    pub(super) spring_energy: R,
}

/// Mean velocity and Cayley argument of a step, which are the six unknowns, and the quantities that
/// follow from them for every contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrialStep<R: Real> {
    /// Mean velocity of the centre of mass, m/s.
    pub(super) velocity: R::Vec3,
    /// Half the mean angle, `a = dt ω/2`: the argument of the Cayley map.
    pub(super) cayley: R::Vec3,
    /// Displacement of the centre of mass, m.
    pub(super) shift: R::Vec3,
    /// Change of a vector by the rotation of the step:
    /// `(1 - â)⁻¹ (1 + â) - 1 = 2 (â + â²)/(1 + |a|²)`. It is small if the rotation is small, so
    /// that there is no cancellation.
    pub(super) rotation_change: Matrix3<R>,
    /// Velocity at the end, `2 vₘ - v`.
    pub(super) end_velocity: R::Vec3,
    /// Angular momentum at the end, `R (2 J ωₘ - L)`.
    pub(super) end_angular_momentum: R::Vec3,
}

impl<R: Real> TrialStep<R> {
    pub(super) const NONE: Self = Self {
        velocity: R::Vec3::ZERO,
        cayley: R::Vec3::ZERO,
        shift: R::Vec3::ZERO,
        rotation_change: Matrix3::ZERO,
        end_velocity: R::Vec3::ZERO,
        end_angular_momentum: R::Vec3::ZERO,
    };
}

/// Derivatives of a law whose friction is linear, with a share of the coefficient of `law`, or
/// those of the law for all of it.
#[cold]
#[inline(never)]
fn linear<R: Real>(law: &FrictionJacobian<R>, share: R) -> FrictionJacobian<R> {
    if share < R::ONE {
        FrictionJacobian {
            coefficient: law.coefficient * share,
            per_load: law.per_load * share,
            width: law.width / share,
            growth: R::ZERO,
        }
    } else {
        *law
    }
}

/// Size of the numbers whose rounding a gap has, m. On level ground the horizontal position does
/// not count.
#[inline(always)]
fn distance_from<R: Real>(plane: Option<Plane<R>>, position: R::Vec3) -> R {
    match plane {
        Some(plane) if plane.is_level() => position.z().abs() + plane.height.abs(),
        _ => position.length(),
    }
}

/// Unit in the last place of the gap of a contact, m: that of the numbers whose difference it is.
pub(in crate::integrator) fn unit_of_gap<R: Real, D: Dynamics<R>>(
    scene: &D,
    position: R::Vec3,
) -> R {
    let plane = scene.contact_model().plane();
    (scene.bounding_radius() + distance_from(plane, position)) * R::EPSILON
}

impl<'a, R: Real, D: Dynamics<R>> Problem<'a, R, D> {
    pub(super) fn new(scene: &'a D, start: &State<R>, energy: &Energy<R>, seconds: R) -> Self {
        let rotation = start.rotation();
        let axes = rotation.axes();
        let properties = scene.inertia_properties();
        let angular_velocity = properties.angular_velocity(&axes, start.angular_momentum);
        let bounding_radius = scene.bounding_radius();
        let model = scene.contact_model();
        let plane = model.plane();
        Self {
            scene,
            start: *start,
            rotation,
            motion: Motion {
                position: start.position,
                axes,
                linear_velocity: start.linear_velocity,
                angular_velocity,
            },
            angular_momentum: start.angular_momentum,
            plane,
            forces: if plane.is_some_and(|plane| plane.is_level()) && model.has_bare_points() {
                Forces::BarePoints
            } else {
                Forces::AnyContacts
            },
            seconds,
            per_second: R::ONE / seconds,
            force_seconds: R::ZERO,
            unpushed: None,
            slip_resolution: R::ZERO,
            mass: properties.mass(),
            inertia: Matrix3::ZERO,
            bounding_radius: if bounding_radius > R::ZERO {
                bounding_radius
            } else {
                R::ONE
            },
            depth_scale: bounding_radius + distance_from(plane, start.position),
            kinetic_energy: energy.kinetic(),
            spring_energy: energy.springs,
        }
    }

    /// Computes what the equations need and a flight does not: the inertia, and the angular
    /// momentum that belongs to it.
    #[inline(always)]
    pub(super) fn prepare(&mut self) {
        let properties = self.scene.inertia_properties();
        let ([x, y, z], angular_momentum) =
            properties.inertia_for_solving(&self.motion.axes, self.start.angular_momentum);
        self.inertia = Matrix3 { x, y, z };
        self.angular_momentum = angular_momentum;
        if is_single::<R>() {
            let around = self.motion.angular_velocity.length() * self.bounding_radius;
            let speed = self.motion.linear_velocity.length() + around;
            self.slip_resolution = speed * (R::EPSILON * R::from_f64(ROUNDINGS));
        }
    }

    /// Returns true if the contacts are bare points of the body on level ground.
    #[inline(always)]
    pub(super) fn is_bare(&self) -> bool {
        matches!(self.forces, Forces::BarePoints)
    }

    /// Returns true if friction and dampers are left out.
    #[inline(always)]
    fn is_without_loss(&self) -> bool {
        matches!(self.forces, Forces::Springs { .. })
    }

    /// Returns true if contacts resist rolling and spinning. It is a constant of most friction
    /// laws, so that a program does not contain what it does not need.
    #[inline(always)]
    pub(super) fn resists_turning(&self) -> bool {
        !self.is_without_loss() && self.scene.friction().rolling_resistance(R::ZERO).is_some()
    }

    /// [`resolution`] of the angular velocity, rad/s.
    pub(super) fn turn_resolution(&self) -> R {
        let time_per_size = self.seconds / self.bounding_radius;
        resolution::<R>(
            self.motion.angular_velocity,
            self.scene.gravity(),
            time_per_size,
        )
    }

    /// One surface of the ground.
    #[inline(always)]
    pub(super) fn ground(&self, surface: u32) -> OneSurface<'a, D::Ground> {
        self.scene.contact_model().laws_of(surface as usize).0
    }

    /// Friction law of one surface.
    #[inline(always)]
    pub(super) fn law(&self, surface: u32) -> LawOfSurface<'a, D::Friction> {
        self.scene.contact_model().laws_of(surface as usize).1
    }

    /// Number of surfaces of the ground.
    #[inline(always)]
    pub(super) fn surfaces(&self) -> u32 {
        u32::try_from(self.scene.contact_model().surfaces()).unwrap_or(u32::MAX)
    }

    /// One surface of the ground, if it is a plane.
    #[inline(always)]
    pub(super) fn plane_of(&self, surface: u32) -> Option<Plane<R>> {
        if self.plane.is_some() || self.scene.ground().surfaces().is_none() {
            self.plane
        } else {
            self.plane_among_several(surface)
        }
    }

    #[cold]
    #[inline(never)]
    fn plane_among_several(&self, surface: u32) -> Option<Plane<R>> {
        self.scene.contact_model().plane_of(surface as usize)
    }

    /// Contact that moves over the surface of the body. `None` if the contacts are fixed in it.
    #[inline(always)]
    pub(super) fn moving_contact(&self) -> Option<MovingContact<'a, D::Body, R>> {
        self.scene.contact_model().moving_contact()
    }

    /// Returns true if the body has rims, whose points are placed anew for each trial.
    #[inline(always)]
    pub(super) fn has_rims(&self) -> bool {
        self.scene.contact_model().has_rims()
    }

    /// Returns true if a rim may be less than `margin` (m) above a surface at the start.
    #[inline]
    pub(super) fn has_rim_near(&self, surface: u32, margin: R) -> bool {
        let (model, pose) = (
            self.scene.contact_model(),
            (self.motion.position, &self.motion.axes),
        );
        model.has_rim_near(surface as usize, margin, pose)
    }

    /// Returns true if a rim may be below the ground at the start.
    #[inline]
    pub(super) fn has_rim_below_ground(&self) -> bool {
        let is_below = || {
            let lowest = self.scene.contact_model().lowest_point(&self.motion);
            lowest.is_some_and(|point| point.gap <= R::ZERO)
        };
        (0..self.surfaces()).any(|surface| {
            let is_near = self.has_rim_near(surface, R::ZERO);
            is_near && (self.plane_of(surface).is_some() || is_below())
        })
    }

    /// Mean force of a surface on a contact whose depth changes uniformly from `start` to `end`
    /// over the step.
    #[inline(always)]
    pub(super) fn mean_force(&self, surface: u32, start: R, end: R) -> MeanForce<R> {
        match self.forces {
            Forces::Springs { factor } => self.mean_force_of_springs(factor, surface, start, end),
            _ => self.ground(surface).mean_force(start, end, self.seconds),
        }
    }

    /// Mean force of the springs alone. If a factor makes them softer, a contact that starts in the
    /// ground is deeper, so that its spring has the same energy.
    #[cold]
    fn mean_force_of_springs(
        &self,
        factor: Option<R>,
        surface: u32,
        start: R,
        end: R,
    ) -> MeanForce<R> {
        let ground = self.ground(surface);
        let Some(factor) = factor else {
            return mean_force_of(&Springs(&ground), start, end, self.seconds);
        };
        let deeper = start.at_least(R::ZERO) * (R::ONE / factor.sqrt() - R::ONE);
        let [start, end] = [start + deeper, end + deeper];
        let mean = mean_force_of(&Springs(&ground), start, end, self.seconds);
        MeanForce {
            force: mean.force * factor,
            slope: mean.slope * factor,
            stiffness: mean.stiffness * factor,
            damping: mean.damping * factor,
        }
    }

    #[inline(always)]
    pub(super) fn friction(
        &self,
        surface: u32,
        position: R::Vec3,
        normal_force: R,
        slip: R::Vec3,
    ) -> R::Vec3 {
        if self.is_without_loss() {
            R::Vec3::ZERO
        } else {
            let law = self.law(surface);
            let force = law.force_at(position, normal_force, slip);
            match self.beyond(slip) {
                Some(far) => {
                    let far = law.force_at(position, normal_force, far).length();
                    let coefficients = [force.length() / slip.length(), far / self.slip_resolution];
                    force * self.share_resolved(slip, coefficients)
                }
                None => force,
            }
        }
    }

    #[inline]
    pub(super) fn jacobian(
        &self,
        surface: u32,
        position: R::Vec3,
        normal_force: R,
        slip: R::Vec3,
    ) -> FrictionJacobian<R> {
        if self.is_without_loss() {
            return FrictionJacobian::NONE;
        }
        let jacobian = |slip| (self.law(surface)).jacobian_at(position, normal_force, slip);
        let law = jacobian(slip);
        match self.beyond(slip) {
            Some(far) => {
                let coefficients = [law.coefficient, jacobian(far).coefficient];
                linear(&law, self.share_resolved(slip, coefficients))
            }
            None => law,
        }
    }

    /// A slip of the size of the [resolution](Self::slip_resolution) in the direction of one that
    /// is below it.
    #[inline(always)]
    fn beyond(&self, slip: R::Vec3) -> Option<R::Vec3> {
        if !is_single::<R>() {
            return None;
        }
        let (speed, resolution) = (slip.length(), self.slip_resolution);
        if speed >= resolution {
            None
        } else if speed > R::ZERO {
            Some(slip * (resolution / speed))
        } else {
            Some(R::Vec3::new(resolution, R::ZERO, R::ZERO))
        }
    }

    /// Share of a friction force that is linear below the resolution, from its coefficients (force
    /// over slip) at a slip and at the resolution.
    ///
    /// Coulomb's coefficient is `μ N/(u + ε)`. So the two coefficients give the sum `u + ε` of any
    /// such law. It is infinite for a law that is linear itself.
    #[cold]
    #[inline(never)]
    fn share_resolved(&self, slip: R::Vec3, [here, there]: [R; 2]) -> R {
        let ratio = there / here;
        // It is false without friction too.
        if ratio < R::ONE {
            let part = slip.length() / self.slip_resolution;
            let sum = (R::ONE - part) * ratio / (R::ONE - ratio);
            let strain = here * self.seconds / self.mass;
            let of_strain = R::from_f64(RESOLVED) / strain;
            // `u + ε` is at least u, which rounding of a ratio near 1 would hide.
            sum.at_least(part).at_least(of_strain).at_most(R::ONE)
        } else {
            R::ONE
        }
    }

    /// Position of a contact at the middle of the step (m, world axes), for the velocities of the
    /// start. `arm` and `radius` are those of the contact's centre at the start.
    ///
    /// Friction is evaluated there. The position does not depend on the trial. Otherwise the
    /// equations would have no solution if the law has a jump there, and Newton's matrix would need
    /// the derivative of the law. Its error is of order h², so the step stays of order 2.
    #[inline(never)]
    pub(super) fn middle_of(&self, surface: u32, arm: R::Vec3, radius: R) -> R::Vec3 {
        let half = self.seconds * R::HALF;
        let centre = self.motion.position + self.motion.linear_velocity * half;
        // Argument of the Cayley map for the rotation of half a step.
        let cayley = self.motion.angular_velocity * (half * R::HALF);
        let ground = self.ground(surface);
        if let Some(moving) = self.moving_contact() {
            let rotation = Rotation::cayley_unscaled(cayley).after(self.rotation);
            let axes = rotation.normalised().axes();
            let facing = moving.above(&ground, centre, &axes);
            return centre + axes.to_world(facing.position);
        }
        let place = centre + arm + Matrix3::<R>::rotation_change(cayley).times(arm);
        if radius > R::ZERO {
            place - ground.surface(place).normal * radius
        } else {
            place
        }
    }

    /// Velocity of the ground's material below an arm (m, world axes) at the middle of the step,
    /// along the ground with this normal, m/s.
    ///
    /// The position of the body is that of [`middle_of`](Self::middle_of), for the same reasons.
    #[inline(always)]
    pub(super) fn ground_velocity(&self, arm: R::Vec3, normal: R::Vec3) -> R::Vec3 {
        if self.scene.ground().motion().is_none() {
            return R::Vec3::ZERO;
        }
        let velocity = self.ground_velocity_at_centre() + self.ground_rotation_velocity(arm);
        velocity - normal * velocity.dot(normal)
    }

    /// Velocity of the ground's material under the body at the middle of the step, m/s.
    #[inline]
    pub(super) fn ground_velocity_at_centre(&self) -> R::Vec3 {
        let half = self.seconds * R::HALF;
        let middle = self.motion.position + self.motion.linear_velocity * half;
        match self.scene.ground().motion() {
            Some(ground) => ground.velocity_at(middle),
            None => R::Vec3::ZERO,
        }
    }

    /// What the rotation of the ground adds to that velocity at an arm (m, world axes), m/s.
    #[inline]
    pub(super) fn ground_rotation_velocity(&self, arm: R::Vec3) -> R::Vec3 {
        match self.scene.ground().motion() {
            Some(ground) => ground.angular_velocity.cross(arm),
            None => R::Vec3::ZERO,
        }
    }

    /// Mean angular velocity of a trial relative to the ground, rad/s.
    pub(super) fn mean_angular_velocity(&self, trial: &TrialStep<R>) -> R::Vec3 {
        let of_body = trial.cayley * (R::TWO * self.per_second);
        match self.scene.ground().motion() {
            Some(ground) => of_body - ground.angular_velocity,
            None => of_body,
        }
    }

    /// Mean angular velocity of a trial relative to the ground with its [`resolution`], both in
    /// rad/s.
    pub(super) fn mean_rotation(&self, trial: &TrialStep<R>) -> (R::Vec3, R) {
        (self.mean_angular_velocity(trial), self.turn_resolution())
    }

    /// Moment of inertia about a direction, kg m². The smallest one about no direction.
    pub(super) fn moment_about(&self, direction: R::Vec3) -> R {
        let square = direction.length_squared();
        if square > R::ZERO {
            direction.dot(self.inertia.times(direction)) / square
        } else {
            R::ONE / self.scene.inertia_properties().largest_inverse_moment()
        }
    }

    /// First trial of a step from this energy: the velocities of the start, and what gravity adds
    /// to them, unless the body may stick to the ground, which then carries most of the weight.
    pub(super) fn first_trial(&self, energy: &Energy<R>) -> TrialStep<R> {
        let half = self.seconds * R::HALF;
        let mut velocity = self.start.linear_velocity;
        if !(energy.springs > R::ZERO && self.may_stick()) {
            velocity += self.scene.gravity() * half;
        }
        self.trial(velocity, self.motion.angular_velocity * half)
    }

    /// Returns true if the step does not resolve the friction of the weight without slip.
    fn may_stick(&self) -> bool {
        let weight = self.mass * self.scene.gravity().length();
        let friction = self.jacobian(0, self.motion.position, weight, R::Vec3::ZERO);
        friction.coefficient * self.seconds > self.mass * R::TWO
    }

    /// Velocity at an arm (m, world axes) at the start, before the applied force acted, m/s. In
    /// stick it is the creep, and after the force a multiple of it.
    #[inline]
    pub(super) fn velocity_before_force(&self, arm: R::Vec3) -> R::Vec3 {
        match self.unpushed {
            Some(state) if self.scene.force().acts() => self.scene.motion(state).velocity_at(arm),
            _ => self.motion.velocity_at(arm),
        }
    }

    /// TrialStep with these unknowns.
    pub(super) fn trial(&self, velocity: R::Vec3, cayley: R::Vec3) -> TrialStep<R> {
        let mut trial = TrialStep::NONE;
        self.set(&mut trial, velocity, cayley);
        trial
    }

    /// Sets the unknowns of a trial in place.
    #[inline(never)]
    pub(super) fn set(&self, trial: &mut TrialStep<R>, velocity: R::Vec3, cayley: R::Vec3) {
        let change = Matrix3::rotation_change(cayley);
        let mean_momentum = self.inertia.times(cayley) * (R::TWO * self.per_second);
        let turned = mean_momentum * R::TWO - self.angular_momentum;
        trial.velocity = velocity;
        trial.cayley = cayley;
        trial.shift = velocity * self.seconds;
        trial.rotation_change = change;
        trial.end_velocity = velocity * R::TWO - self.start.linear_velocity;
        trial.end_angular_momentum = turned + change.times(turned);
    }

    /// Rounding of a contact's path over a trial, m: some units in the last place of the two paths
    /// whose sum it is.
    #[inline]
    pub(super) fn rounding_of_path(&self, trial: &TrialStep<R>) -> R {
        let paths = trial.shift.length() + trial.cayley.length() * (R::TWO * self.bounding_radius);
        paths * (R::EPSILON * R::from_f64(8.0))
    }

    /// Rounding of a gap, m: some units in the last place of the numbers that it is computed from.
    #[inline]
    pub(super) fn rounding_of_gap(&self) -> R {
        self.depth_scale * (R::EPSILON * R::from_f64(8.0))
    }

    /// Position of the body at the end of a trial, and its axes there.
    #[inline]
    pub(super) fn place_at_end(&self, trial: &TrialStep<R>) -> (R::Vec3, Axes<R>) {
        let turn = Rotation::cayley_unscaled(trial.cayley).after(self.rotation);
        let position = self.motion.position + trial.shift;
        (position, turn.normalised().axes())
    }

    /// State at the end of a trial.
    pub(super) fn end_of(&self, trial: &TrialStep<R>) -> State<R> {
        let rotation = Rotation::cayley_unscaled(trial.cayley)
            .after(self.rotation)
            .normalised();
        State {
            position: self.start.position + trial.shift,
            linear_velocity: trial.end_velocity,
            orientation: rotation.to_quat(),
            angular_momentum: self
                .scene
                .inertia_properties()
                .without_dead_spin(rotation, trial.end_angular_momentum),
        }
    }
}

/// The springs of a ground, without its dampers.
struct Springs<'a, G>(&'a G);

impl<R: Real, G: SpringDamperGround<R>> SpringDamperGround<R> for Springs<'_, G> {
    fn surface(&self, point: R::Vec3) -> Surface<R> {
        self.0.surface(point)
    }
    fn surface_under(&self, centre: R::Vec3, radius: R) -> Option<Surface<R>> {
        self.0.surface_under(centre, radius)
    }
    fn spring_force(&self, depth: R) -> R {
        self.0.spring_force(depth)
    }
    fn spring_energy(&self, depth: R) -> R {
        self.0.spring_energy(depth)
    }
    fn normal_force(&self, depth: R, _closing_speed: R) -> R {
        self.0.spring_force(depth)
    }
}

/// Mean force of springs over a path between two depths, m.
///
/// Its provided derivative is a difference over a thousandth of the path. In hard ground that is
/// more than the depth. If only one end of the path is in the ground, the derivative of
/// `(V(end) - V(start))/(end - start)` follows from the force at the end without a loss of digits.
fn mean_force_of<R: Real, G: SpringDamperGround<R>>(
    springs: &Springs<'_, G>,
    start: R,
    end: R,
    seconds: R,
) -> MeanForce<R> {
    let mut mean = springs.mean_force(start, end, seconds);
    if (start > R::ZERO) != (end > R::ZERO) {
        let force_at_end = if end > R::ZERO {
            springs.spring_force(end)
        } else {
            R::ZERO
        };
        mean.slope = ((force_at_end - mean.force) / (end - start)).at_least(R::ZERO);
        mean.stiffness = mean.slope;
    }
    mean
}
