//! Contacts that begin or cease to push within a step, or whose slip reverses.
//!
//! The damper's force is discontinuous at touch-down. If a contact separates faster than its spring
//! can follow, the derivative of the force is discontinuous. A Runge-Kutta step treats the force as
//! smooth. Its error depends on the time of the discontinuity within the step, and its own estimate
//! may be small by chance. Each contact is therefore evaluated separately at both ends of the step.
//! Its gap in between follows from cubic Hermite interpolation.

use core::cell::Cell;

use super::attempt::{Attempt, Pair, Place, Planned};
use super::late::comes_late;
use super::tuning;
use crate::body::{ContactPoint, ContactRange, RigidPointBody};
use crate::contact::Motion;
use crate::friction::SlidingFriction;
use crate::integrator::adaptive::{bounce, edge};
use crate::integrator::contact_path::{ContactEnd, ContactView, Path, arm, path_error, push, slip};
use crate::integrator::point::Point;
use crate::quadrature::{bisect, integral_of_3};
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, OnSurface, mobility, size};

/// Errors caused by contacts in a step within which their force or its derivative is discontinuous.
#[derive(Clone, Copy, Debug)]
pub(super) struct Discontinuities<R> {
    /// Bound of the error in the velocity of the farthest point of the body, m/s.
    pub(super) velocity: R,
    /// Fraction of the step just after the first discontinuity that matters.
    pub(super) first: Option<R>,
}

impl<R: Real> Discontinuities<R> {
    /// Returns the value for a step without discontinuities.
    pub(super) fn none() -> Self {
        Self {
            velocity: R::ZERO,
            first: None,
        }
    }

    /// Adds the error of another contact.
    fn add(&mut self, other: &Self) {
        self.velocity += other.velocity;
        self.first = match (self.first, other.first) {
            (Some(first), Some(there)) => Some(first.at_most(there)),
            (first, there) => first.or(there),
        };
    }
}

/// Returns the discontinuities of a step, and the velocity error that they cause.
///
/// `smooth` is the error estimate of the step without them. A step to a discontinuity has been
/// taken [without its late contacts](super::late::load_before).
#[inline]
pub(super) fn discontinuities<R: Real, D: Dynamics<R>, const STAGES: usize>(
    pair: &Pair<STAGES>,
    planned: &Planned<'_, R, D>,
    attempt: &Attempt<R, STAGES>,
    [smooth, allowed]: [R; 2],
) -> Discontinuities<R> {
    let Planned {
        scene,
        start,
        seconds,
        to_discontinuity,
    } = *planned;
    let mut discontinuities = Discontinuities::none();
    let contacts = scene.body().contacts();
    let margin = bounce::reach(scene, [&start.motion, &attempt.end.motion], seconds);
    let path_error = path_error(scene, [&start.motion, &attempt.end.motion], seconds);
    let gained = Cell::new(None);
    let ends = [&start.point, &attempt.end.point];
    let energy_gained = || bounce::once(&gained, || bounce::energy_gained(scene, ends));
    for surface in 0..scene.contact_model().surfaces() {
        let near_surface = |place: &Place<R>| {
            let Motion { position, axes, .. } = &place.motion;
            (scene.contact_model()).range_of_surface(surface, margin, *position, axes)
        };
        let (before, after) = (near_surface(start), near_surface(&attempt.end));
        // If a step is too large in any case, and has many contacts near the ground, this
        // evaluation is not worth its cost.
        if smooth > allowed && before.count.saturating_add(after.count) > tuning::MANY_CONTACTS {
            continue;
        }
        let step = AttemptedStep {
            weights: pair.weights(),
            follows_slip: pair.follows_slip,
            scene: &OnSurface::of(scene, surface),
            motions: &attempt.motions,
            ends: [&start.motion, &attempt.end.motion],
            seconds,
            to_discontinuity,
            allowed,
            may_pass: smooth <= allowed,
            path_error,
            energy_gained: &energy_gained,
        };
        let [head, tail] = after.without(before, contacts.len());
        step.add_surface([before, head, tail], (ends, smooth), &mut discontinuities);
    }
    discontinuities
}

/// An attempted step. Its type has no number of stages, so that it is compiled once for all pairs.
pub(super) struct AttemptedStep<'a, R: Real, D> {
    /// Weights of the stages in the result.
    weights: &'a [f64],
    follows_slip: bool,
    pub(super) scene: &'a D,
    motions: &'a [Motion<R>],
    pub(super) ends: [&'a Motion<R>; 2],
    pub(super) seconds: R,
    to_discontinuity: bool,
    allowed: R,
    /// Whether the error estimate of the step without discontinuities is allowed.
    may_pass: bool,
    /// Error of the path of a contact, m.
    path_error: R,
    /// Energy that the step has gained, J.
    energy_gained: &'a dyn Fn() -> R,
}

impl<R: Real, D: Dynamics<R>> AttemptedStep<'_, R, D> {
    /// Adds the errors of the contacts in the ranges `near` a surface. Adds those of edges and rims
    /// that meet it between both ends, if the step may still be accepted.
    #[inline(always)]
    fn add_surface(
        &self,
        near: [ContactRange; 3],
        (ends, smooth): ([&Point<R>; 2], R),
        discontinuities: &mut Discontinuities<R>,
    ) {
        let touches = self.add_contacts(near, discontinuities);
        if smooth + discontinuities.velocity <= self.allowed {
            self.add_brush(ends, touches, discontinuities);
            if self.scene.contact_model().has_rims() {
                self.add_rims(ends, discontinuities);
            }
        }
    }

    /// Adds the errors of contacts. Returns whether any of them pushes at each end of the step.
    ///
    /// Not inlined, so that it is compiled once for all pairs.
    #[inline(never)]
    fn add_contacts(
        &self,
        near: [ContactRange; 3],
        discontinuities: &mut Discontinuities<R>,
    ) -> [bool; 2] {
        let contacts = self.scene.body().contacts();
        let views = self.ends.map(|motion| ContactView::of(self.scene, motion));
        let mut touches = [false; 2];
        for part in near.into_iter().flat_map(|range| range.parts(contacts)) {
            for point in part {
                let [start, end] = self.add_contact(point, &views, discontinuities);
                touches = [touches[0] || start, touches[1] || end];
            }
        }
        touches
    }

    /// Adds the errors of one contact. Returns whether it pushes at each end of the step.
    #[inline(always)]
    fn add_contact(
        &self,
        point: &ContactPoint<R>,
        [start, end]: &[ContactView<'_, R, D>; 2],
        discontinuities: &mut Discontinuities<R>,
    ) -> [bool; 2] {
        let (start, end) = (start.side(point), end.side(point));
        let pushes = [start.pushes(), end.pushes()];
        let path = Path::between(&start, &end, self.seconds);
        let opens = path.turns_above_ground();
        if pushes == [true; 2] {
            if !opens && self.bends(&start, &end) {
                discontinuities.velocity += self.bend_error(point, &[start, end]);
            } else if !opens && self.stage_parts(point, [&start, &end]) {
                discontinuities.velocity += self.stage_error(point, &path);
            }
            if self.follows_slip {
                discontinuities.velocity += self.slip_error(point, &[start, end]);
            }
            if !opens {
                return pushes;
            }
        }
        let last = if pushes[0] != pushes[1] {
            Some(R::ONE)
        } else if path.turns_under_ground() || opens {
            Some(path.turn())
        } else if let Some(depth) = path.greatest_depth(self.path_error) {
            discontinuities.velocity += self.near_miss_error(point, depth);
            return pushes;
        } else if self.meets(&start, R::ONE) || self.meets(&end, R::from_f64(tuning::STAGES_AHEAD))
        {
            None
        } else {
            return pushes;
        };
        discontinuities.add(&self.contact_error(point, &path, &[start, end], last));
        pushes
    }

    /// Adds the rims that begin or cease to touch.
    #[inline(never)]
    fn add_rims(&self, ends: [&Point<R>; 2], discontinuities: &mut Discontinuities<R>) {
        let stages = self.weighted_motions();
        let error = edge::rim_error(self.scene, ends, self.ends, stages, self.seconds);
        let mobility = mobility(self.scene);
        discontinuities.velocity +=
            error * self.seconds * mobility * R::from_f64(tuning::ERROR_WEIGHT);
    }

    /// Adds a contact that only the path between both ends shows.
    #[inline]
    fn add_brush(
        &self,
        ends: [&Point<R>; 2],
        touches: [bool; 2],
        discontinuities: &mut Discontinuities<R>,
    ) {
        let motions = (self.ends, touches);
        if let Some(brush) = edge::brush(self.scene, ends, motions, self.seconds) {
            let velocity = brush.force * self.seconds * mobility(self.scene);
            let matters = velocity * R::from_f64(tuning::UNTREATED) > self.allowed;
            let first = brush.before.at_least(R::from_f64(tuning::SHORTEST_PART));
            discontinuities.add(&Discontinuities {
                velocity,
                first: matters.then_some(first),
            });
        }
    }

    /// Returns true if the force of a contact is not linear in its depth and closing speed from one
    /// end of the step to the other.
    #[inline]
    fn bends(&self, start: &ContactEnd<R>, end: &ContactEnd<R>) -> bool {
        let depth = (start.depth + end.depth) * R::HALF;
        let closing_speed = (start.closing_speed + end.closing_speed) * R::HALF;
        let twice = push(self.scene, depth, closing_speed) * R::TWO;
        let sum = start.normal_force + end.normal_force;
        (twice - sum).abs() > sum * R::EPSILON.sqrt()
    }

    /// Returns the velocity error of a contact that pushes at both ends of the step, if the slope
    /// of its force has a discontinuity in between.
    ///
    /// The stages of a step integrate a smooth force as accurately as Gauss's rule does.
    #[inline(never)]
    fn bend_error(&self, point: &ContactPoint<R>, [start, end]: &[ContactEnd<R>; 2]) -> R {
        let path = Path::between(start, end, self.seconds);
        let force = |share: R| self.force_on(&path, share);
        let bent = Bent::between(force, R::ZERO, R::ONE);
        let weight = self.error_weight(point, bent.integral);
        if bent.doubt * weight <= self.allowed * R::from_f64(tuning::SMOOTH) {
            return R::ZERO;
        }
        (bent.integral - self.mean_of_stages(point)).abs() * weight
    }

    /// Returns true if a stage has lost a contact, unless the step is too large in any case.
    ///
    /// The force of the stages has a discontinuity then, although that of the path has none, and
    /// the estimate of the step may be small by chance. A stage departs from the path by part of
    /// what the speeds cover, so a contact that is deeper at both ends is not evaluated.
    #[inline]
    fn stage_parts(&self, point: &ContactPoint<R>, ends: [&ContactEnd<R>; 2]) -> bool {
        let [start, end] = ends;
        let speed = start.closing_speed.abs() + end.closing_speed.abs();
        let depth = start.depth.at_most(end.depth) - speed * self.seconds;
        self.may_pass
            && push(self.scene, depth, -speed) <= R::ZERO
            && (self.weighted_motions().skip(1))
                .any(|(motion, _)| !ContactEnd::of(self.scene, motion, point).pushes())
    }

    /// Returns the velocity error of a contact that pushes along the whole path, but not in each
    /// stage.
    #[inline(never)]
    fn stage_error(&self, point: &ContactPoint<R>, path: &Path<R>) -> R {
        let truth = Bent::between(|share| self.force_on(path, share), R::ZERO, R::ONE).integral;
        (truth - self.mean_of_stages(point)).abs() * self.error_weight(point, truth)
    }

    /// Returns the velocity error per error of the mean normal force of a contact, m/s/N, under a
    /// load (N).
    #[inline]
    fn error_weight(&self, point: &ContactPoint<R>, load: R) -> R {
        let mobility = mobility_with_friction(self.scene, point, self.ends[1], load);
        self.seconds * mobility * R::from_f64(tuning::ERROR_WEIGHT)
    }

    /// Returns the normal force on a path at a fraction of the step, N.
    #[inline]
    fn force_on(&self, path: &Path<R>, share: R) -> R {
        let (depth, slope) = path.at(share);
        push(self.scene, depth, slope / self.seconds)
    }

    /// Returns true if a contact at one end of the step is above ground, but would be below it
    /// after this part of the step.
    ///
    /// A stage may have evaluated it as penetrating, although the path does not: a stage ahead of
    /// the end, or one before the contact was thrown off, whose force has bent the path.
    #[inline]
    fn meets(&self, end: &ContactEnd<R>, part: R) -> bool {
        let ahead = end.closing_speed * (self.seconds * part);
        end.depth <= R::ZERO && end.depth + ahead > R::ZERO
    }

    /// Returns the error of one contact, and its discontinuity if that matters.
    ///
    /// The contact begins or ceases to push before the fraction `last` of the step. `None` means
    /// that it comes close without doing so.
    #[inline(never)]
    fn contact_error(
        &self,
        point: &ContactPoint<R>,
        path: &Path<R>,
        [start, end]: &[ContactEnd<R>; 2],
        last: Option<R>,
    ) -> Discontinuities<R> {
        let force = |share: R| self.force_on(path, share);
        let pushes = start.pushes();
        let share = last.map_or(R::ONE, |last| first_change(force, pushes, last));
        let integral = |from, to| Bent::between(force, from, to).integral;
        let truth = match [pushes, end.pushes()] {
            [false, _] => integral(share, R::ONE),
            [true, false] => integral(R::ZERO, share),
            // It opens and closes again.
            [true, true] => integral(R::ZERO, share) + integral(share, R::ONE),
        };
        let taken = if self.to_discontinuity && comes_late(start, self.seconds) {
            R::ZERO
        } else {
            self.mean_of_stages(point)
        };
        let motion = self.ends[usize::from(!pushes)];
        let load = truth
            .at_least(start.normal_force)
            .at_least(end.normal_force);
        let mobility = mobility_with_friction(self.scene, point, motion, load);
        let mut velocity =
            (truth - taken).abs() * (self.seconds * mobility) * R::from_f64(tuning::ERROR_WEIGHT);
        if !(pushes || end.pushes()) {
            velocity = velocity.at_least(self.excess_impulse(point, end) * mobility);
        }
        let ends = if pushes == end.pushes() {
            start.normal_force + end.normal_force
        } else {
            (start.normal_force - end.normal_force).abs()
        };
        let change = force(share) + ends;
        let jump = Jump {
            share,
            resolution: self.resolution(path, share),
            acceleration: mobility * change,
        };
        // No step can end nearer to the discontinuity.
        if velocity <= jump.acceleration * (jump.resolution * self.seconds) {
            return Discontinuities::none();
        }
        let matters = velocity * R::from_f64(tuning::UNTREATED) > self.allowed;
        Discontinuities {
            velocity,
            first: matters.then(|| self.just_beyond(&jump)),
        }
    }

    /// Returns the velocity error of a contact whose path turns above ground, but so near to it
    /// that the contact may reach this `depth` (m).
    #[inline(never)]
    fn near_miss_error(&self, point: &ContactPoint<R>, depth: R) -> R {
        let load = push(self.scene, depth, R::ZERO);
        load * self.seconds * mobility_with_friction(self.scene, point, self.ends[1], load)
    }

    /// Returns the impulse with which a contact that parts within the step has pushed too much,
    /// N s.
    #[inline]
    fn excess_impulse(&self, point: &ContactPoint<R>, end: &ContactEnd<R>) -> R {
        let (leaving_speed, gained) = (-end.closing_speed, (self.energy_gained)());
        if gained > R::ZERO && leaving_speed > R::ZERO {
            let leaving = (self.ends[1], leaving_speed);
            bounce::excess_impulse(self.scene, point, leaving, gained)
        } else {
            R::ZERO
        }
    }

    /// Returns the fraction of the step in which a contact moves by the rounding of its depth.
    fn resolution(&self, path: &Path<R>, share: R) -> R {
        let length = self.ends[1].position.length() + size(self.scene);
        let (_, slope) = path.at(share);
        length * (R::EPSILON * R::from_f64(4.0)) / slope.abs()
    }

    /// Returns the mean normal force of the contact as the method has summed it, N.
    fn mean_of_stages(&self, point: &ContactPoint<R>) -> R {
        let mut sum = R::ZERO;
        for (motion, weight) in self.weighted_motions() {
            sum += ContactEnd::of(self.scene, motion, point).normal_force * weight;
        }
        sum
    }

    /// Returns the stages whose slopes have a weight in the result, with their weights.
    pub(super) fn weighted_motions(&self) -> impl Iterator<Item = (&Motion<R>, R)> {
        (self.motions.iter().zip(self.weights))
            .filter(|(_, weight)| **weight != 0.0)
            .map(|(motion, weight)| (motion, R::from_f64(*weight)))
    }

    /// Returns a fraction of the step just beyond a discontinuity.
    ///
    /// It is so close that the force causes no relevant error before it, and so far that the
    /// rounded depth is beyond it: a step from there would contain the jump at its start.
    fn just_beyond(&self, jump: &Jump<R>) -> R {
        let harmless =
            self.allowed / (jump.acceleration * self.seconds * R::from_f64(tuning::LOCATION));
        let beyond = harmless.at_least(jump.resolution);
        let there = jump.share + beyond.at_most(R::ONE - jump.share);
        there.at_least(R::from_f64(tuning::SHORTEST_PART))
    }
}

/// A discontinuity of the force of a contact within a step.
struct Jump<R> {
    /// Fraction of the step at which it is.
    share: R,
    /// Fraction of the step to which it can be located.
    resolution: R,
    /// Change of the acceleration of the farthest point of the body, m/s².
    acceleration: R,
}

/// Integral of a force whose slope may have discontinuities.
struct Bent<R> {
    /// Integral over the fraction of the step, N.
    integral: R,
    /// Largest difference from Gauss's rule on the whole and on each half: 0 to rounding, unless
    /// the force is no polynomial.
    doubt: R,
}

impl<R: Real> Bent<R> {
    fn between(force: impl Fn(R) -> R, from: R, to: R) -> Self {
        let over = |parts: u32| {
            let at = |index: u32| {
                let share = R::from_f64(f64::from(index) / f64::from(parts));
                from + (to - from) * share
            };
            (0..parts).fold(R::ZERO, |sum, index| {
                sum + integral_of_3(&force, at(index), at(index + 1))
            })
        };
        let [whole, halves] = [over(1), over(2)];
        if (halves - whole).abs() <= whole.abs() * R::EPSILON.sqrt() {
            return Self {
                integral: whole,
                doubt: R::ZERO,
            };
        }
        let integral = over(tuning::FORCE_PARTS);
        Self {
            integral,
            doubt: (integral - whole).abs().at_least((integral - halves).abs()),
        }
    }
}

/// Returns the first fraction of a step, up to `last`, at which a force begins or ceases to push.
///
/// The result is slightly beyond the change. The change is known to occur.
fn first_change<R: Real>(force: impl Fn(R) -> R, pushes: bool, last: R) -> R {
    let changed = |share: R| (force(share) > R::ZERO) != pushes;
    let mut bracket = bisect([R::ZERO, last], HALVINGS, changed);
    for _ in 0..ROUNDS {
        let [before, first] = bracket;
        // Of a step that ends just beyond a touch-down, the part with a force must be resolved too.
        let rest = (last - first).at_least(R::EPSILON);
        if first - before <= rest * R::from_f64(tuning::REST_RESOLUTION) {
            break;
        }
        bracket = bisect(bracket, HALVINGS / 2, changed);
    }
    let [_, first] = bracket;
    first
}

/// Bisections to locate a discontinuity. They resolve a millionth of the step.
const HALVINGS: u32 = 20;
/// Most rounds of half as many bisections beyond them, down to rounding.
const ROUNDS: u32 = 4;

/// Returns the speed of the farthest point of the body per normal impulse at a contact, 1/kg.
///
/// It includes the friction of the contact under a load (N).
fn mobility_with_friction<R: Real, D: Dynamics<R>>(
    scene: &D,
    point: &ContactPoint<R>,
    motion: &Motion<R>,
    load: R,
) -> R {
    let mass = scene.inertia_properties();
    let (arm, normal) = arm(scene, motion, point);
    let slip = slip(scene, motion, (arm, normal));
    let friction = scene.friction();
    // That of one newton has no rounding of the load.
    let load = if friction.is_proportional_to_load() {
        R::ONE
    } else {
        load
    };
    let mut force = normal;
    if load > R::ZERO {
        force += friction.force_at(motion.position + arm, load, slip) * (R::ONE / load);
    }
    let spin = mass.angular_velocity(&motion.axes, arm.cross(force));
    force.length() * mass.inverse_mass() + spin.length() * size(scene)
}
