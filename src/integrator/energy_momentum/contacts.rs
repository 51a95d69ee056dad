//! The contacts of an implicit step: collected once, then evaluated for their mean force at each
//! iteration.
//!
//! # Contacts beyond the storage
//!
//! A contact that is not stored is computed anew from the trial. Only its dual unknown of friction
//! depends on the iterations before. Each dual unknown follows from the one before, the trials of
//! both, and the Newton step between them. For a contact that is not stored, the dual unknown
//! before is that of a stored contact which is near in the body's order. Everything else is its
//! own. One of each few candidates is stored for that purpose.
//!
//! The error of that neighbour's value is multiplied by the change of the slip divided by the width
//! of the law. It vanishes as the iteration converges. So the solution does not depend on which
//! contacts are stored, only the way to it does. A chain that begins at a later trial without a
//! neighbour is no substitute. While the slip of a contact in stick falls towards the slip speed of
//! the law, its friction at each trial is that of a slide, and only the dual unknown knows that it
//! will stick.
//!
//! One visit to such a contact computes its force and its derivatives, so that the number of visits
//! does not depend on the number of iterations before.

use super::answer::{Answer, LinearFriction, Since};
use super::lever::Lever;
use super::panels::Panels;
use super::problem::{Problem, TrialStep};
use super::reversal::Reversal;
use super::touch::{Increment, Push, Touch};
use crate::body::{ContactRange, RigidPointBody};
use crate::contact::MovingContact;
use crate::friction::FrictionJacobian;
use crate::integrator::matrix3::Matrix3;
use crate::real::{Real, Vector};
use crate::scene::Dynamics;
use crate::state::State;

/// Which contacts a surface may touch during a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach<R: Real> {
    /// Range that includes them.
    pub(super) range: ContactRange,
    /// Whether each contact of that range counts.
    pub(super) is_everything: bool,
    /// Path of the centre of mass towards the surface, m.
    pub(super) fall: R,
    /// Velocity towards the surface per metre of the arm, 1/s.
    pub(super) tilt: R::Vec3,
    /// Bound for what the acceleration adds to the path, m.
    pub(super) bend: R,
    /// Whether a rim may touch.
    pub(super) with_rims: bool,
}

impl<R: Real> Reach<R> {
    pub(super) const NONE: Self = Self {
        range: ContactRange::NONE,
        is_everything: false,
        fall: R::ZERO,
        tilt: R::Vec3::ZERO,
        bend: R::ZERO,
        with_rims: false,
    };

    /// Returns true if a contact with this depth and arm at the start of a step may touch in it.
    #[inline(always)]
    fn includes(&self, seconds: R, depth: R, arm: R::Vec3) -> bool {
        if self.is_everything {
            return true;
        }
        // -n · (ω × r) = (ω × n) · r
        let end = depth + self.fall + seconds * self.tilt.dot(arm) + self.bend;
        self.range.count > 0 && (depth > R::ZERO || end > R::ZERO)
    }
}

/// TrialStep at which friction was differentiated, and Newton's step from there, if slips and dual
/// unknowns continue from its end.
#[derive(Clone, Copy, Debug)]
struct Noted<R: Real> {
    trial: TrialStep<R>,
    step: Option<Increment<R>>,
}

impl<R: Real> Noted<R> {
    const NONE: Self = Self {
        trial: TrialStep::NONE,
        step: None,
    };
}

/// Contacts that may touch during a step.
///
/// `Touches` is the storage of those that a step remembers from iteration to iteration, an array.
/// If there are more, one of each few is remembered, and the others are computed anew. The stages
/// of a step take a slice in its place, so that they are compiled once for all capacities.
#[derive(Clone, Debug)]
pub(super) struct Contacts<R: Real, Touches: ?Sized = [Touch<R>]> {
    remembered: usize,
    /// All candidates on a surface. On several surfaces it is the same range for each.
    range: ContactRange,
    /// Number of candidates on all surfaces, and the number of them that were evaluated before the
    /// storage was full.
    candidates: usize,
    seen: usize,
    /// Number of candidates of which the middle one is stored, if not all are.
    each: usize,
    /// Number of remembered contacts that belong to the body itself. The points of a rim come after
    /// them.
    fixed: usize,
    /// Whether a rim may touch during the step.
    with_rim: bool,
    panels: Panels,
    /// Torque correction of moving contacts at the last trial.
    pub(super) lever: Lever<R>,
    /// Derivative of the first moving contact's path along the ground with respect to a rotation of
    /// the end of the step, where the matrix was last computed, m.
    path_by_turn: Matrix3<R>,
    /// The last trial at which friction was differentiated, and the number of such trials in this
    /// step.
    noted: Noted<R>,
    notes: usize,
    touches: Touches,
}

impl<R: Real, const CAPACITY: usize> Contacts<R, [Touch<R>; CAPACITY]> {
    pub(super) const NONE: Self = Self {
        remembered: 0,
        range: ContactRange::NONE,
        candidates: 0,
        seen: 0,
        each: 0,
        fixed: 0,
        with_rim: false,
        panels: Panels::NONE,
        lever: Lever::NONE,
        path_by_turn: Matrix3::ZERO,
        noted: Noted::NONE,
        notes: 0,
        touches: [Touch::NONE; CAPACITY],
    };
}

impl<R: Real> Contacts<R> {
    /// Number of contacts that are remembered at most.
    #[inline(always)]
    fn capacity(&self) -> usize {
        self.touches.len()
    }

    /// Forgets the contacts of the last step.
    #[inline]
    pub(super) fn clear(&mut self) {
        (self.candidates, self.seen) = (0, 0);
        (self.remembered, self.fixed) = (0, 0);
        self.with_rim = false;
        self.lever = Lever::NONE;
        self.notes = 0;
    }

    /// Adds the contacts with a surface that are within reach.
    #[inline]
    pub(super) fn gather<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        surface: u32,
        reach: &Reach<R>,
    ) {
        let contacts = problem.scene.body().contacts();
        let range = if problem.surfaces() > 1 {
            // Candidates are counted surface by surface.
            ContactRange::all(contacts.len())
        } else {
            reach.range
        };
        self.range = ContactRange {
            count: range.count.min(contacts.len()),
            ..range
        };
        self.with_rim |= reach.with_rims && problem.has_rims();
        let (mut remembered, mut seen) = (self.remembered, self.seen);
        let is_full = seen < self.candidates;
        self.candidates = self.candidates.saturating_add(self.range.count);
        if is_full {
            return;
        }
        if reach.range.count == 0 {
            // No contact can reach this surface, one of several: all are counted, none evaluated.
            self.seen += self.range.count;
            return;
        }
        'all: for part in range.parts(contacts) {
            for point in part {
                let touch = Touch::of(problem, surface, point);
                if reach.includes(problem.seconds, touch.push.depth, touch.arm) {
                    let Some(place) = self.touches.get_mut(remembered) else {
                        break 'all;
                    };
                    place.take(problem, &touch);
                    remembered += 1;
                }
                seen += 1;
            }
        }
        (self.remembered, self.seen) = (remembered, seen);
        self.fixed = remembered;
    }

    /// Where there are too many contacts, or too many to leave room for the points of rims, stores
    /// the middle one of each few candidates.
    #[inline]
    pub(super) fn thin_out<D: Dynamics<R>>(&mut self, problem: &Problem<'_, R, D>) {
        let leaves_no_room = self.has_rims_near(problem) && self.remembered > self.capacity() / 2;
        if self.has_others() || leaves_no_room {
            self.store_evenly_spaced(problem);
        }
    }

    #[cold]
    #[inline(never)]
    fn store_evenly_spaced<D: Dynamics<R>>(&mut self, problem: &Problem<'_, R, D>) {
        let contacts = problem.scene.body().contacts();
        // The points of rims need their share of the storage.
        let share = if self.with_rim { 2 } else { 1 };
        let most = (self.capacity() / share).max(1);
        // It saturates so that no program contains the panic of a step of 0.
        let each = (self.candidates / most).saturating_add(1);
        (self.each, self.remembered) = (each, 0);
        for number in (each / 2..self.candidates).step_by(each) {
            let each_surface = self.range.count.max(1);
            let (surface, place) = (number / each_surface, number % each_surface);
            let surface = u32::try_from(surface).unwrap_or(u32::MAX);
            // In the order of the parts of a contact range: a range that begins after the last
            // contact begins at the first.
            let [head, tail] = self.range.parts(contacts);
            let point = head.get(place).or_else(|| tail.get(place - head.len()));
            let (Some(point), Some(touch)) = (point, self.touches.get_mut(self.remembered)) else {
                break;
            };
            *touch = Touch::of(problem, surface, point);
            self.remembered += 1;
        }
        (self.seen, self.fixed) = (self.remembered, self.remembered);
    }

    /// Number of contacts, remembered or not.
    #[inline]
    pub(super) fn len(&self) -> usize {
        self.remembered + (self.candidates - self.seen)
    }

    /// Returns true if not all contacts are stored.
    #[inline]
    pub(super) fn has_others(&self) -> bool {
        self.seen < self.candidates
    }

    /// Returns true if no contact can touch during the step.
    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.len() == 0 && !self.with_rim
    }

    /// Returns true if all contacts are known to be above the ground at the start of the step.
    #[inline]
    pub(super) fn begin_above_ground<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>) -> bool {
        let is_above = |touch: &Touch<R>| touch.push.depth <= R::ZERO;
        !self.has_others()
            && self.stored().iter().all(is_above)
            && !(self.with_rim && problem.has_rim_below_ground())
    }

    /// Returns true if all contacts that are below the ground at the `end` of the step were
    /// collected. There are `touching` of them.
    pub(super) fn includes_those_at<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        (end, touching): (&State<R>, usize),
    ) -> bool {
        if self.has_others() {
            let may_lack_rim = problem.has_rims() && !self.with_rim;
            let lacks_rim = may_lack_rim && touching > own_touching(problem, end);
            return !lacks_rim && self.covers_those_at(problem, end);
        }
        let below = |touches: &[Touch<R>]| {
            let ended_below = |touch: &&Touch<R>| touch.push.end_depth > R::ZERO;
            touches.iter().filter(ended_below).count()
        };
        if !self.with_rim {
            return touching <= below(self.stored());
        }
        // A rim is collected as a whole. Only contacts of the body itself can be missing.
        problem.scene.body().contacts().is_empty() || {
            let fixed = self.touches.get(..self.fixed).unwrap_or_default();
            own_touching(problem, end) <= below(fixed)
        }
    }

    /// Returns true if the collected range contains all contacts that are below the ground at the
    /// `end` of the step.
    #[cold]
    #[inline(never)]
    fn covers_those_at<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>, end: &State<R>) -> bool {
        let (scene, all) = (problem.scene, problem.scene.body().contacts().len());
        // Without a hint of the body, the range below the ground reads each contact.
        if self.range.count == all {
            return true;
        }
        let axes = end.rotation().axes();
        let below = scene
            .contact_model()
            .range_within(R::ZERO, end.position, &axes);
        let missing = below.without(self.range, all);
        missing.iter().all(|range| range.count == 0)
    }

    /// Returns true if a rim may touch during the step.
    #[inline(always)]
    pub(super) fn has_rims_near<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>) -> bool {
        self.with_rim && problem.has_rims()
    }

    /// Torque correction of a moving contact at the last trial. `None` if the contacts are fixed in
    /// the body.
    #[inline(always)]
    pub(super) fn lever<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>) -> Option<&Lever<R>> {
        problem.moving_contact().map(|_| &self.lever)
    }

    /// Computes the force of every contact over a trial step, and calls `visit` for those that
    /// reach the ground.
    #[inline(always)]
    pub(super) fn respond<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
        mut visit: impl FnMut(&Push<R>),
    ) {
        if self.has_rims_near(problem) {
            let (touches, room) = (&mut self.touches, [self.fixed, self.remembered]);
            self.remembered = self.panels.place_points((problem, trial), touches, room);
        }
        let mut done = 0;
        if problem.is_bare() {
            for touch in self.touches.iter_mut().take(self.remembered) {
                if touch.respond_on_level(problem, trial) {
                    visit(&touch.push);
                }
            }
            done = self.remembered;
        }
        self.respond_from(done, problem, |touch| touch.respond(problem, trial), visit);
    }

    /// Computes forces by `respond`, from the contact with the number `first` on. Calls `visit` for
    /// those that reach the ground, and sums the torque corrections of moving contacts.
    #[inline(always)]
    fn respond_from<D: Dynamics<R>>(
        &mut self,
        first: usize,
        problem: &Problem<'_, R, D>,
        mut respond: impl FnMut(&mut Touch<R>) -> Lever<R>,
        mut visit: impl FnMut(&Push<R>),
    ) {
        let (is_moving, mut normal_force) = (problem.moving_contact().is_some(), R::ZERO);
        for touch in self.touches.iter_mut().take(self.remembered).skip(first) {
            let lever = respond(touch);
            if is_moving {
                let force = touch.push.mean.force;
                self.lever = self.lever.with(lever, &mut normal_force, force);
            }
            if touch.push.is_active() {
                visit(&touch.push);
            }
        }
    }

    /// Computes the forces like [`respond`](Self::respond), with the slips to which Newton's step
    /// has [advanced](Self::advance) the last ones.
    ///
    /// The points of a rim are placed anew for each trial and have no last slip.
    #[cold]
    #[inline(never)]
    pub(super) fn respond_with_slips<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
        visit: &mut dyn FnMut(&Push<R>),
    ) {
        if self.has_rims_near(problem) {
            self.respond(problem, trial, visit);
        } else {
            let respond = |touch: &mut Touch<R>| touch.respond_with_slip(problem, trial);
            self.respond_from(0, problem, respond, visit);
        }
    }

    /// Calls `visit` with each point at which friction reverses between two panels of a rim.
    #[inline(always)]
    pub(super) fn visit_reversals<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        visit: impl FnMut(&Reversal<R>),
    ) {
        if self.has_rims_near(problem) {
            self.panels.visit_reversals(problem, &self.touches, visit);
        }
    }

    /// Force (N) and torque (N m) by which a linear friction exceeds that of the laws at the last
    /// trial, of the stored contacts.
    #[cold]
    #[inline(never)]
    pub(super) fn excess<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        linear: LinearFriction,
    ) -> [R::Vec3; 2] {
        let (mut force, mut torque) = (R::Vec3::ZERO, R::Vec3::ZERO);
        for touch in self.touches.iter().take(self.remembered) {
            if touch.push.is_active() {
                let excess = touch.excess(problem, linear);
                force += excess;
                torque += touch.push.arm.cross(excess);
            }
        }
        [force, torque]
    }

    /// The stored contacts.
    #[inline]
    pub(super) fn stored(&self) -> &[Touch<R>] {
        self.touches.get(..self.remembered).unwrap_or_default()
    }

    /// The stored contacts, to be changed.
    #[inline]
    pub(super) fn stored_mut(&mut self) -> &mut [Touch<R>] {
        let stored = ..self.remembered;
        self.touches.get_mut(stored).unwrap_or_default()
    }

    /// Advances the slips and dual unknowns of the last trial to the end of a Newton step.
    #[cold]
    #[inline(never)]
    pub(super) fn advance<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        by: &Increment<R>,
    ) {
        self.noted.step.get_or_insert(*by);
        let path_by_turn = problem.moving_contact().map(|_| &self.path_by_turn);
        // The path by a rotation is known for the first moving contact.
        let known = path_by_turn.map_or(self.remembered, |_| self.remembered.min(1));
        for touch in self.touches.iter_mut().take(known) {
            if touch.push.is_active() {
                touch.advance(problem, by, path_by_turn);
            }
        }
    }

    /// Computes and stores the derivative of the first moving contact's path along the ground with
    /// respect to a rotation. Returns `None` if the contacts are fixed in the body.
    #[inline(always)]
    pub(super) fn differentiate_path<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
        argument: &Matrix3<R>,
    ) -> Option<Matrix3<R>> {
        let touch = self.touches.first()?;
        let path_by_turn = touch.push.path_by_turn(problem, trial, argument)?;
        self.path_by_turn = path_by_turn;
        Some(path_by_turn)
    }

    /// Derivative of the torque of moving contacts with respect to a rotation of the end of the
    /// step, N m. It contains only the motion of the contact point over the surface, with `factor`
    /// times the contact force.
    #[cold]
    #[inline(never)]
    pub(super) fn torque_over_surface<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        moving: &MovingContact<'_, D::Body, R>,
        trial: &TrialStep<R>,
        factor: R,
    ) -> Matrix3<R> {
        let (_, axes) = problem.place_at_end(trial);
        let mut sum = Matrix3::diagonal(R::ZERO);
        let stored = self.stored().iter();
        for touch in stored.filter(|touch| touch.push.is_active()) {
            let force = touch.push.force * factor;
            let [first, second] = moving.over_surface(touch.push.normal, &axes);
            let torque =
                |(moved, turn): (R::Vec3, R::Vec3)| Matrix3::outer(moved.cross(force), turn);
            sum = sum.plus(&torque(first)).plus(&torque(second));
        }
        sum
    }

    /// Stores what [`answer`](Self::answer) stores, without the derivatives.
    #[cold]
    #[inline(never)]
    pub(super) fn note_answers<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
    ) {
        self.note(trial);
        for touch in self.touches.iter_mut().take(self.remembered) {
            touch.note_answer(problem);
        }
    }

    /// Computes the Jacobian of friction at the last trial step, which was `trial`, for the
    /// contacts that reach the ground. Calls `visit` with each contact and that Jacobian.
    #[inline(always)]
    pub(super) fn answer<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
        mut visit: impl FnMut(&Touch<R>, &Answer<R>),
    ) {
        if self.has_others() {
            self.note(trial);
        }
        for touch in self.touches.iter_mut().take(self.remembered) {
            if touch.push.is_active() {
                let answer = touch.answer(problem);
                touch.remember(&answer);
                visit(touch, &answer);
            }
        }
    }

    /// Calls `visit` for the stored contacts that reach the ground, with the Jacobian of friction.
    /// Motion and force are those of the last trial step.
    pub(super) fn recall<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        mut visit: impl FnMut(&Touch<R>, &FrictionJacobian<R>),
    ) {
        for touch in self.touches.iter().take(self.remembered) {
            if touch.push.is_active() {
                visit(touch, &touch.jacobian(problem));
            }
        }
    }

    /// Calls `visit` like [`recall`](Self::recall), for all contacts. The last trial step was
    /// `trial`.
    pub(super) fn recall_all<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
        visit: &mut dyn FnMut(&Touch<R>, &FrictionJacobian<R>),
    ) {
        self.recall(problem, |touch, jacobian| visit(touch, jacobian));
        if self.has_others() {
            self.visit_others(problem, trial, &mut |touch, _, _| {
                visit(touch, &touch.jacobian(problem));
            });
        }
    }

    /// Calls `visit` with each active contact of the last trial step, which was `trial`.
    pub(super) fn visit_active<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
        visit: &mut dyn FnMut(&Touch<R>),
    ) {
        let stored = self.stored().iter().filter(|touch| touch.push.is_active());
        stored.for_each(&mut *visit);
        if self.has_others() {
            self.visit_others(problem, trial, &mut |touch, _, _| visit(touch));
        }
    }

    /// Notes a trial at which friction is differentiated, for the contacts that are not stored.
    fn note(&mut self, trial: &TrialStep<R>) {
        self.noted = Noted {
            trial: *trial,
            step: None,
        };
        self.notes += 1;
    }

    /// Computes the force of each contact that is not stored over a trial step. Calls `visit` with
    /// those that reach the ground, with the torque correction of each, and with the stored contact
    /// that it follows.
    #[cold]
    #[inline(never)]
    pub(super) fn visit_others<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
        visit: &mut dyn FnMut(&mut Touch<R>, &Lever<R>, &Touch<R>),
    ) {
        let [head, tail] = self.range.parts(problem.scene.body().contacts());
        let surfaces = 0..problem.surfaces();
        let mut candidates =
            surfaces.flat_map(|surface| head.iter().chain(tail).map(move |point| (surface, point)));
        let mut touch = Touch::NONE;
        let last = self.remembered.saturating_sub(1);
        for group in 0..=self.candidates / self.each.max(1) {
            // A last group of fewer candidates may have none that is stored.
            let Some(first) = self.touches.get(group.min(last)) else {
                break;
            };
            let few = candidates.by_ref().take(self.each).enumerate();
            for (number, (surface, point)) in few {
                if number == self.each / 2 {
                    continue;
                }
                touch.begin(problem, surface, point);
                let lever = touch.respond_anywhere(problem, trial);
                if touch.push.is_active() {
                    visit(&mut touch, &lever, first);
                }
            }
        }
    }

    /// Change of a trial since the last one at which friction was differentiated, if there is one.
    /// A contact that moves over the surface of the body begins anew at each trial.
    pub(super) fn since_last<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
    ) -> Option<Since<'_, R>> {
        let (noted, is_fixed) = (&self.noted, problem.moving_contact().is_none());
        (self.notes > 0 && is_fixed)
            .then(|| Since::between(&noted.trial, noted.step.as_ref(), trial))
    }

    /// Response of friction at the last trial of a contact that is not stored and follows another
    /// one, with these derivatives.
    pub(super) fn answer_of_other<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        since: Option<&Since<'_, R>>,
        (touch, jacobian): (&mut Touch<R>, FrictionJacobian<R>),
        first: &Touch<R>,
    ) -> Answer<R> {
        let Some(since) = since else {
            return touch.answer(problem);
        };
        // Nothing came before the first trial that was noted.
        touch.look_back(problem, since, (self.notes > 1).then_some(first));
        touch.continued_answer(problem, jacobian)
    }
}

/// Number of contacts of the body itself, not of its rims, that touch at the `end` of a step.
#[cold]
#[inline(never)]
fn own_touching<R: Real, D: Dynamics<R>>(problem: &Problem<'_, R, D>, end: &State<R>) -> usize {
    let scene = problem.scene;
    scene.contact_model().touching_points(&scene.motion(end))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::energy_momentum::Workspace;
    use crate::integrator::energy_momentum::dual::Dual;
    use crate::{
        Bowl, Capsule, Coulomb, Cuboid, Disc, EnergyMomentum, FlatGround, Ground, Integrator,
        Sphere, SpringDamper, SpringDamperGround, State, Stepper, Terrain, ThickDisc,
        UniformGravity,
    };
    use glam::Vec3;

    /// Contacts of a step that no test takes: each field has a value that would change the next
    /// step.
    fn left_over<const N: usize>() -> Contacts<f32, [Touch<f32>; N]> {
        let mut touch = Touch::NONE;
        (touch.arm, touch.before) = (Vec3::ONE, Vec3::Y);
        (touch.load, touch.load_depth) = (50.0, 0.3);
        let push = &mut touch.push;
        (push.mean.force, push.mean.slope, push.mean.stiffness) = (30.0, 1e3, 1e3);
        (push.force, push.slip) = (Vec3::new(3.0, -9.0, 30.0), Vec3::new(-0.7, 0.4, 0.0));
        (push.arm, push.end_arm) = (Vec3::X, Vec3::new(0.7, -0.9, 1.1));
        push.normal = Vec3::Y;
        (push.depth, push.end_depth, push.weight) = (0.2, 0.1, 3.0);
        touch.dual = Dual::After(Vec3::new(0.6, -0.8, 0.0));
        let mut noted = Noted::NONE;
        noted.trial.velocity = Vec3::ONE;
        Contacts {
            touches: [touch; N],
            remembered: 100,
            candidates: 300,
            seen: 100,
            each: 3,
            fixed: 50,
            with_rim: true,
            panels: Panels::LEFT_OVER,
            path_by_turn: Matrix3::diagonal(1.0),
            noted,
            notes: 5,
            ..Contacts::NONE
        }
    }

    /// Steps of 5 ms of a body of 0.05 kg, from poses and motions at the ground, each with an empty
    /// workspace and with one that holds contacts. Returns the number of steps that iterated.
    fn same_steps(
        body: &dyn RigidPointBody<f32>,
        ground: &dyn SpringDamperGround<f32>,
        is_rough: bool,
    ) -> u32 {
        let time_step = 5e-3_f32;
        let integrator = EnergyMomentum { time_step };
        let stepper = Stepper::builder(body)
            .gravity(UniformGravity::down(9.8_f32))
            .ground(ground)
            .integrator(integrator);
        let coulomb = Coulomb::<f32> {
            coefficient: 0.4,
            slip_speed: if is_rough { 1e-3 } else { 1e-1 },
        };
        let stepper = stepper.friction(coulomb).build().unwrap();
        let scene = stepper.scene();
        let mut count = 0;
        for number in 0_u8..120 {
            let n = f32::from(number);
            let wave = |per_number: f32| (n * per_number).sin();
            let start = State::at(Vec3::new(0.0, 0.0, 0.02 + 0.03 * wave(0.37)))
                .with_rotation_vector(Vec3::new(wave(1.1), wave(2.3), wave(0.7)) * 2.0)
                .with_linear_velocity(Vec3::new(wave(1.7), wave(0.9), wave(2.9)))
                .with_angular_momentum(Vec3::new(wave(1.3), wave(3.1), wave(0.3)) * 3e-4);
            let mut full = Workspace::new();
            full.contacts = left_over();
            let steps = [Workspace::new(), full].map(|mut workspace| {
                let mut state = start;
                let step = integrator.step(scene, &mut state, time_step, &mut workspace);
                (state, step.unwrap())
            });
            assert_eq!(steps[0], steps[1], "start {number}");
            count += u32::from(steps[0].1.iterations > 0);
        }
        count
    }

    #[test]
    fn a_step_depends_on_nothing_that_the_workspace_held_before() {
        let law = SpringDamper::<f32> {
            stiffness: 1e3,
            damping: 1.0,
        };
        let curvatures = [2.0_f32, 1.0];
        let shape = Terrain::of::<f32>(Bowl { curvatures });
        let grounds: [&dyn SpringDamperGround<f32>; 3] = [
            &FlatGround::level(1e3_f32, 1.0),
            // Hard: the loads of its contacts are unknowns of the step.
            &FlatGround::level(1e7_f32, 1.0),
            &Ground { law, shape },
        ];
        let bodies: [&dyn RigidPointBody<f32>; 5] = [
            &ThickDisc::<f32>::solid(0.05, 0.03, 0.02, 60),
            &Disc::<f32>::solid(0.05, 0.04, 120),
            &Cuboid::<f32>::solid(0.05, Vec3::new(0.03, 0.05, 0.02)),
            &Capsule::<f32>::solid(0.05, 0.01, 0.06),
            &Sphere::<f32>::solid(0.05, 0.03),
        ];
        for body in bodies {
            for ground in grounds {
                for is_rough in [false, true] {
                    assert!(same_steps(body, ground, is_rough) > 20);
                }
            }
        }
    }
}
