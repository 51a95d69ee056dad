//! Newton's iteration on the momentum balance of a step.
//!
//! A trial has the mean velocity `vₘ`, the mean angular velocity `ωₘ` and the rotation R of the
//! step. With its end velocities `v' = 2 vₘ - v` and `L' = R (2 J ωₘ - L)`, the equations are
//!
//! ```text
//! m (v' - v)/2 - dt/2 (F + m g) = 0,     (L' - L)/2 - dt/2 T = 0
//! ```
//!
//! A small change of the trial shifts the end of the step by `ξ` and rotates it by `ϑ`. A contact's
//! path then changes by `ξ + ϑ × r'` and its mean arm by `ϑ × r'/2`. The Cayley argument changes by
//! `(ϑ - a × ϑ + a (a·ϑ))/2`. In these unknowns the derivatives need neither inverses nor the
//! derivative of the Cayley map.
//!
//! # Stick
//!
//! A contact that sticks has the slip `u = ε d/(1 - |d|)`, where `d` is its friction divided by
//! `μ N` and `ε` is the slip speed of the law. The slip is a difference of velocities v, known to
//! `2e-16 v`. The law multiplies that error by `μ N/ε`. At `ε = 1e-10 m/s` it is a millionth of the
//! friction, at 1e-16 m/s all of it. The balance with the force of the law cannot be more accurate,
//! although the velocities are correct to rounding. This has two consequences:
//!
//! - The iteration is close if two conditions hold. The momenta balance with the *dual* forces
//!   `-μ N d`, which lie within the limit of the law, and Newton's step is small
//!   ([`Newton::is_close_by_dual`]). That step is the last one.
//! - If the slip at the start is within its own rounding, the dual unknown cannot be computed from
//!   it. The slip is then carried along as an unknown. Each Newton step adds its increment, which
//!   is known to a relative error of 2e-16 ([`Increment`]). The slip stays within the rounding of
//!   the difference.
//!
//! A step that does not resolve friction advances its dual unknowns by the same increments. A
//! contact's path bends by the square of a large step, which is far above the creep. The slip that
//! follows from the velocities would therefore give any dual unknown. The points of a round rim are
//! placed anew for each trial, so that their dual unknowns follow from the new slips.
//!
//! # Hard contacts
//!
//! If the step is long compared with the oscillation of the body on its contacts, their loads are
//! the unknowns ([`hard`]).
//!
//! # First trial in stick
//!
//! The slip of the first trial is far above the creep of a contact that sticks. A derivative there
//! is that of a slide, and the iteration needs several steps to find the friction of stick. The
//! slip at the start of the step is a better estimate of the creep, because the end-velocity
//! correction of the step before has aimed at it. It is a function of the state, so that no result
//! depends on a workspace. The law is therefore differentiated for the slip at the start. Let `F'`
//! be its linear function of the slip. The first Newton step solves the balance with `F'(u)` in
//! place of `F(u)`, at the slip u of the first trial. It finds friction for contacts that all
//! stick, and for contacts of which one slides while the other sticks.

use super::answer::LinearFriction;
use super::balance::{
    Balance, Iterate, Scale, Sum, norm, residual, size_of_motion, tolerance, without_excess,
};
use super::contacts::Contacts;
use super::hard;
use super::problem::{Forces, Problem, TrialStep};
use super::rolling::{self, Rolling};
use super::stiffness::{self, Others};
use super::strain::Strain;
use super::touch::{Increment, Push};
use crate::body::RigidPointBody;
use crate::integrator::Step;
use crate::integrator::linear::Factored;
use crate::real::{Real, Vector, is_single};
use crate::scene::Dynamics;

/// Number of full Newton steps, after which the iteration continues carefully from the best trial.
const BOLD: u32 = 30;
/// Number of Newton steps after which the matrix contains the motion of a moving contact point over
/// the surface of the body.
const SLOW: u32 = 10;
/// Factor of the threshold for rounding. The threshold is this many fourth roots of the precision's
/// unit, times the tolerance. In f64 it is 1e-4 tolerances or 2e-16 of the momentum, in f32 1.5e-2
/// tolerances or 1e-7 of it.
///
/// The inverse of the threshold in tolerances corresponds to 1.2 square roots of that unit. Within
/// that distance Newton's step is the last one, because it squares the residual.
const EXACT: f64 = 0.8192;
/// Fraction of the distance from which one step is enough, within which an iteration without
/// progress may end.
const STALLED: f64 = 0.1;
/// Bound on the ratio of Newton's step to the distance from which one step is enough. Free motion
/// has the ratio 1, and springs and friction reduce it.
const MOST_AMPLIFIED: f64 = 1024.0;
/// Whether derivatives of contacts that are not stored may wait until they are needed. It changes
/// no bit. A processor without a standard library has little memory for code, and few contacts.
const DEFERS: bool = cfg!(feature = "std");
/// Number of evaluations after which the step is abandoned.
const LIMIT: u32 = 60;
/// Stiffness of all contacts, times the square of the step size, divided by the mass, above which
/// the contacts are [hard]. At the bound, a contact that starts as high above the ground as it
/// would end below it without force ends at a sixth of that depth. Newton's method finds it in two
/// or three halvings.
const HARD: f64 = 64.0;
/// Stiffness in the units of [`HARD`] up to which the loads of contacts are unknowns. At this bound
/// the depth under a load is a hundred thousandth of the body's way in the step. At 1e15 and 1e21,
/// random steps of the tests left a body in its place that a force could move.
const HARDEST: f64 = 1e10;

/// Derivatives from which a Newton step starts.
#[derive(Clone, Copy, PartialEq)]
enum Derivatives {
    /// Those of the trial before, with which one more step is expected to reach rounding.
    Known,
    /// Those of the laws at the trial.
    OfLaws,
    /// Those at the trial, with the loads of hard contacts as unknowns.
    ByLoads,
}

/// Newton's step from a set of unknowns.
#[derive(Clone, Copy, Debug)]
struct Base<R: Real> {
    iterate: Iterate<R>,
    /// Sum of the magnitudes of the normal forces there, N.
    load: R,
    shift: R::Vec3,
    turn: R::Vec3,
}

/// Solves the step. Leaves the solution in `trial` and returns its strain on friction and dampers,
/// or `None` if the iteration does not converge. The work is counted in `step`.
///
/// Full steps come first. With the dual unknown they pass from slip to stick and back, which a line
/// search would prevent. They can run in a cycle, for example if a spring is so stiff that the step
/// out of contact overshoots. The iteration then starts again from the best trial and takes only
/// steps that reduce the residual.
pub(super) fn solve<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &mut Contacts<R>,
    trial: &mut TrialStep<R>,
    step: &mut Step<R>,
) -> Option<Strain<R>> {
    let mut newton = Newton::new(problem);
    for iteration in 0..LIMIT {
        let here = newton.balance(contacts, trial, iteration == 1);
        step.evaluations += 1;
        if newton.has_converged(&here) && newton.loads_agree(contacts) {
            return Some(newton.strain_at(contacts, trial));
        }
        newton.choose_unknowns(&here, trial);
        if newton.is_worse(&here, iteration) {
            newton.shorten_the_step(contacts, trial)?;
            continue;
        }
        step.iterations += 1;
        newton.is_slow = iteration >= SLOW;
        newton.notice_hardness(&here, contacts);
        let is_last = newton.step_from(&here, contacts, trial);
        // Newton's next step squares the residual, so no further evaluation is needed.
        if is_last {
            return Some(newton.strain);
        }
        newton.remember(&here);
        if iteration == BOLD {
            // The residual of a hard contact is no measure for the distance from the solution.
            if newton.is_hard {
                return None;
            }
            newton.return_to_the_best(trial);
        }
    }
    None
}

/// State of the iteration.
struct Newton<'a, 'b, R: Real, D> {
    problem: &'a Problem<'b, R, D>,
    scale: Scale<R>,
    matrix: Factored<R>,
    /// What the contacts that are not stored contribute at the last trial, if there are any and
    /// it has been computed.
    others: Option<Others<R>>,
    /// Strain on friction and dampers at the last derivatives.
    strain: Strain<R>,
    /// Last accepted trial and the step from there, or `None` before the first step.
    base: Option<Base<R>>,
    best: Option<Iterate<R>>,
    /// Fraction of the step from `base` that the trial takes.
    share: R,
    /// Resistance to rolling and spinning at the last trial.
    rolling: Option<Rolling<R>>,
    /// Whether slips are carried along as unknowns.
    with_slips: bool,
    /// Multiple of the tolerance that counts as rounding.
    exact: R,
    /// Multiple of the tolerance from which one step is enough.
    close: R,
    /// Whether the contact moves over the surface of the body.
    is_moving: bool,
    /// Whether the step is long compared with the oscillation of the body on its contacts.
    is_hard: bool,
    /// Whether the iteration has taken so many steps that their number may depend on a derivative
    /// which the first ones leave out.
    is_slow: bool,
}

impl<'a, 'b, R: Real, D: Dynamics<R>> Newton<'a, 'b, R, D> {
    #[inline(always)]
    fn new(problem: &'a Problem<'b, R, D>) -> Self {
        let exact = R::EPSILON.sqrt().sqrt() * R::from_f64(EXACT);
        Self {
            problem,
            scale: Scale::of(problem),
            matrix: Factored::NONE,
            others: None,
            strain: Strain::NONE,
            base: None,
            best: None,
            share: R::ONE,
            rolling: None,
            with_slips: false,
            exact,
            close: R::ONE / exact,
            is_moving: problem.moving_contact().is_some(),
            is_hard: false,
            is_slow: false,
        }
    }

    /// Evaluates the momentum balance at a trial, which may be the second one.
    #[inline(always)]
    fn balance(
        &mut self,
        contacts: &mut Contacts<R>,
        trial: &TrialStep<R>,
        is_second: bool,
    ) -> Balance<R> {
        let problem = self.problem;
        let mut sum = Sum::NONE;
        if self.with_slips && self.base.is_some() {
            contacts.respond_with_slips(problem, trial, &mut |push| sum.add(push));
        } else {
            contacts.respond(problem, trial, |push| sum.add(push));
        }
        sum.torque += contacts.lever.torque * sum.normal;
        if contacts.has_others() {
            let of_levers =
                self.visit_others(contacts, (trial, is_second), &mut |push| sum.add(push));
            sum.torque += of_levers;
        }
        self.rolling = Rolling::at(problem, contacts, trial);
        if let Some(rolling) = self.rolling() {
            sum.torque += rolling.torque;
        }
        let mut balance = Balance::of(problem, (contacts, trial), &sum, &self.scale);
        if let Some(rolling) = self.rolling() {
            balance.rounding += rolling.rounding(problem, trial);
        }
        balance
    }

    /// Calls `visit` with the forces of the contacts that are not stored. Returns the torque
    /// corrections of those that move over a smooth body, N m.
    ///
    /// Their derivatives are computed at the same visit, unless those of the first trial are likely
    /// to be enough for the second: a step that resolves friction and dampers is almost linear.
    #[cold]
    #[inline(never)]
    fn visit_others(
        &mut self,
        contacts: &Contacts<R>,
        (trial, is_second): (&TrialStep<R>, bool),
        visit: &mut dyn FnMut(&Push<R>),
    ) -> R::Vec3 {
        if DEFERS && is_second && self.strain.of_step(self.problem).is_resolved() {
            self.others = None;
            let mut of_levers = R::Vec3::ZERO;
            contacts.visit_others(self.problem, trial, &mut |touch, lever, _| {
                of_levers += lever.torque * touch.push.mean.force;
                visit(&touch.push);
            });
            of_levers
        } else {
            let others = Others::of(self.problem, contacts, trial, visit);
            let of_levers = others.of_levers;
            self.others = Some(others);
            of_levers
        }
    }

    /// Computes what the contacts that are not stored contribute at the last trial, if the visit
    /// for their forces has left it out.
    #[cold]
    #[inline(never)]
    fn complete_others(&mut self, contacts: &Contacts<R>, trial: &TrialStep<R>) {
        if self.others.is_none() {
            self.others = Some(Others::of(self.problem, contacts, trial, &mut |_| {}));
        }
    }

    /// Returns true if the residual halves at least, compared with the best trial before.
    #[inline(always)]
    fn is_progress(&self, here: &Balance<R>) -> bool {
        (self.best).is_none_or(|best| here.iterate.residual < best.residual * R::HALF)
    }

    /// Returns true if the residual is rounding, or if it is small and no longer decreases.
    ///
    /// No further progress near the end means that rounding is reached. In f32 the end is so far
    /// from rounding that slow progress counts.
    #[inline(always)]
    fn has_converged(&self, here: &Balance<R>) -> bool {
        let size = here.iterate.residual;
        if size <= here.tolerance * self.exact + here.rounding {
            return true;
        }
        let stalls = !self.is_progress(here)
            && (self.best).is_none_or(|best| size > best.residual * slowest::<R>());
        stalls && size <= here.tolerance * self.close * R::from_f64(STALLED) + here.rounding
    }

    /// Returns true unless the last Newton step has predicted other loads of hard contacts than
    /// those at the trial. The residual may then be small by chance.
    #[inline(always)]
    fn loads_agree(&self, contacts: &Contacts<R>) -> bool {
        !self.is_hard || hard::loads_agree(self.problem, contacts)
    }

    /// Carries the slips along as unknowns from the moment at which the residual is within the
    /// rounding of slips that are computed from the velocities.
    #[inline(always)]
    fn choose_unknowns(&mut self, here: &Balance<R>, trial: &TrialStep<R>) {
        if !(self.with_slips || self.strain.of_step(self.problem).is_resolved()) {
            let of_slips = (self.scale).rounding_of_slips(self.problem, trial, &self.strain);
            self.with_slips =
                here.iterate.residual <= of_slips && of_slips > here.tolerance * self.close;
        }
    }

    /// Returns true if the step to this trial is to be shortened. Among the full steps, only a
    /// residual that is not finite is worse.
    #[inline(always)]
    fn is_worse(&self, here: &Balance<R>, iteration: u32) -> bool {
        let is_larger = (self.base)
            .is_some_and(|base| iteration > BOLD && here.iterate.residual >= base.iterate.residual);
        !here.iterate.residual.is_finite() || is_larger
    }

    /// Halves the step from the last accepted trial. Returns `None` if there is no such trial, or
    /// if the step is below rounding.
    #[inline(always)]
    fn shorten_the_step(
        &mut self,
        contacts: &mut Contacts<R>,
        trial: &mut TrialStep<R>,
    ) -> Option<()> {
        let base = self.base?;
        self.share *= R::HALF;
        if self.share < R::EPSILON {
            return None;
        }
        // The dual unknowns continue from here.
        contacts.note_answers(self.problem, trial);
        let (shift, turn) = (base.shift * self.share, base.turn * self.share);
        change(self.problem, trial, &base.iterate, shift, turn);
        Some(())
    }

    /// Moves the trial by Newton's step. Returns true if it is the last one.
    #[inline(always)]
    fn step_from(
        &mut self,
        here: &Balance<R>,
        contacts: &mut Contacts<R>,
        trial: &mut TrialStep<R>,
    ) -> bool {
        let problem = self.problem;
        let loads_agree = self.loads_agree(contacts);
        let derivatives = self.choose_derivatives(here, loads_agree);
        self.linearise(derivatives, contacts, trial);
        let is_resolved = self.strain.of_step(problem).is_resolved();
        let mut residual = match derivatives {
            Derivatives::ByLoads => self.residual_by_loads(contacts, trial),
            _ => [here.force_residual, here.torque_residual],
        };
        let begins_in_stick = self.base.is_none() && !is_resolved && {
            let excess = self.excess(contacts, LinearFriction::OfMatrix);
            residual = without_excess(problem, residual, excess);
            excess != [R::Vec3::ZERO; 2]
        };
        let (mut shift, mut turn) = self.solved(residual, here.iterate.cayley);
        if derivatives == Derivatives::ByLoads {
            [shift, turn] = self.step_by_loads(here, contacts, [shift, turn]);
        }
        let by = Increment::of(shift, turn, here.iterate.cayley);
        let is_last = !begins_in_stick
            && loads_agree
            && self.is_accurate(derivatives, here, contacts, [shift, turn])
            && !(self.is_hard && hard::touch_or_part(problem, contacts, trial, &by))
            && !(is_single::<R>() && is_resolved && self.may_end_a_slide(contacts, &by));
        change(problem, trial, &here.iterate, shift, turn);
        // The points of rims are placed anew for each trial. This reads the rims of the body,
        // because `ContactModel` would make the firmware larger (`.ci/embedded.sh`).
        let is_without_rims = problem.scene.body().rims().is_empty();
        if !is_resolved && (begins_in_stick || is_last || is_without_rims) {
            contacts.advance(problem, &by);
        }
        self.accept(here, shift, turn);
        is_last
    }

    /// Chooses the derivatives from which Newton's step starts.
    #[inline(always)]
    fn choose_derivatives(&self, here: &Balance<R>, loads_agree: bool) -> Derivatives {
        if self.is_enough(here) && loads_agree {
            Derivatives::Known
        } else if self.is_hard {
            Derivatives::ByLoads
        } else {
            Derivatives::OfLaws
        }
    }

    /// Computes the derivatives and the strain at a trial.
    #[inline(always)]
    fn linearise(
        &mut self,
        derivatives: Derivatives,
        contacts: &mut Contacts<R>,
        trial: &mut TrialStep<R>,
    ) {
        let problem = self.problem;
        if derivatives == Derivatives::ByLoads {
            hard::linearise(problem, contacts);
            self.rolling = Rolling::at(problem, contacts, trial);
        }
        if derivatives != Derivatives::Known {
            self.differentiate(derivatives, contacts, trial);
        } else if !self.strain.of_step(problem).is_resolved() {
            // A step that is resolved is resolved here too. For any other step, the strain is
            // evaluated at its end.
            self.strain = self.strain_at(contacts, trial);
        }
    }

    /// Returns true if Newton's step reaches rounding with these derivatives.
    #[inline(always)]
    fn is_accurate(
        &self,
        derivatives: Derivatives,
        here: &Balance<R>,
        contacts: &Contacts<R>,
        [shift, turn]: [R::Vec3; 2],
    ) -> bool {
        let is_near = || derivatives == Derivatives::Known || self.is_close(here);
        self.rolling().is_none_or(Rolling::is_exact)
            && (is_near() && self.is_small(here, shift, turn)
                || self.is_close_in_stick(here, contacts, shift, turn))
    }

    /// Notes the trial as the last accepted one, from which Newton's step is taken as a whole.
    #[inline(always)]
    fn accept(&mut self, here: &Balance<R>, shift: R::Vec3, turn: R::Vec3) {
        self.share = R::ONE;
        self.base = Some(Base {
            iterate: here.iterate,
            load: here.load,
            shift,
            turn,
        });
    }

    /// Resistance to rolling and spinning at the last trial, if the law has any. The law is asked,
    /// so that a program does not contain what it does not need.
    #[inline(always)]
    fn rolling(&self) -> Option<&Rolling<R>> {
        self.rolling
            .as_ref()
            .filter(|_| self.problem.resists_turning())
    }

    /// Solves for the shift and the rotation by which a trial with this Cayley argument and
    /// residual is balanced.
    #[inline(always)]
    fn solved(&self, residual: [R::Vec3; 2], cayley: R::Vec3) -> (R::Vec3, R::Vec3) {
        let (problem, [force, torque]) = (self.problem, residual);
        match self.rolling() {
            Some(rolling) => rolling.step(problem, &self.matrix, cayley, residual),
            None => (self.matrix).solve(-force, -torque, problem.bounding_radius),
        }
    }

    /// Notes whether the contacts are hard. Rims are not, whose points are placed anew for each
    /// trial, nor contacts that are not stored.
    #[inline(always)]
    fn notice_hardness(&mut self, here: &Balance<R>, contacts: &Contacts<R>) {
        let problem = self.problem;
        let hardness = here.stiffness * problem.seconds * problem.seconds / problem.mass;
        self.is_hard |= hardness > R::from_f64(HARD)
            && hardness < R::from_f64(HARDEST)
            && !matches!(problem.forces, Forces::Springs { factor: Some(_) })
            && !(contacts.has_others() || contacts.has_rims_near(problem));
    }

    /// Residual of the momentum balance with the linear forces of hard contacts.
    #[cold]
    #[inline(never)]
    fn residual_by_loads(&self, contacts: &Contacts<R>, trial: &TrialStep<R>) -> [R::Vec3; 2] {
        let problem = self.problem;
        let mut sum = Sum::NONE;
        for touch in contacts.stored() {
            if touch.push.is_active() {
                let more = hard::beyond(problem, touch);
                sum.add(&touch.push);
                sum.force += more;
                sum.torque += touch.push.arm.cross(more);
            }
        }
        sum.torque += contacts.lever.torque * sum.normal;
        if let Some(rolling) = self.rolling() {
            sum.torque += rolling.torque;
        }
        let (force, torque) = residual(problem, trial, &sum);
        [force, torque]
    }

    /// Sets the loads after Newton's step. Returns the step that the trial takes.
    #[cold]
    #[inline(never)]
    fn step_by_loads(
        &self,
        here: &Balance<R>,
        contacts: &mut Contacts<R>,
        [shift, turn]: [R::Vec3; 2],
    ) -> [R::Vec3; 2] {
        let (problem, iterate) = (self.problem, &here.iterate);
        hard::predict(contacts, &Increment::of(shift, turn, iterate.cayley));
        let all_shift = iterate.velocity * problem.seconds + shift;
        let ahead = size_of_motion(problem, all_shift, iterate.cayley * R::TWO + turn);
        hard::shortened(problem, [shift, turn], ahead)
    }

    /// Returns true if one more step with the last derivatives is expected to reach rounding,
    /// because it reduces the residual by the same factor again.
    ///
    /// It does not if the last trial was far below the ground. The residual of its load hides that
    /// of friction, and its derivatives hold the body by the friction of that load.
    #[inline(always)]
    fn is_enough(&self, here: &Balance<R>) -> bool {
        let size = here.iterate.residual;
        self.base.is_some_and(|base| {
            size * (size / base.iterate.residual) <= here.tolerance * self.exact
                && here.load * R::TWO >= base.load
        })
    }

    /// Computes strain and derivatives at a trial.
    #[inline(always)]
    fn differentiate(
        &mut self,
        derivatives: Derivatives,
        contacts: &mut Contacts<R>,
        trial: &TrialStep<R>,
    ) {
        let problem = self.problem;
        if DEFERS && contacts.has_others() {
            self.complete_others(contacts, trial);
        }
        let (others, equations) = (self.others.as_ref(), &mut self.matrix.equations);
        let known = (others, self.is_slow);
        self.strain = stiffness::equations(problem, contacts, known, trial, equations);
        if problem.resists_turning() && derivatives == Derivatives::OfLaws {
            rolling::add_loads(problem, contacts, trial, equations);
        }
        self.matrix.factor(problem.bounding_radius);
    }

    /// Strain on friction and dampers at the last trial.
    #[inline(never)]
    fn strain_at(&mut self, contacts: &Contacts<R>, trial: &TrialStep<R>) -> Strain<R> {
        if DEFERS && contacts.has_others() {
            self.complete_others(contacts, trial);
        }
        let of_others = self
            .others
            .as_ref()
            .map_or(Strain::NONE, |others| others.strain);
        Strain::at(self.problem, contacts, of_others)
    }

    /// Force (N) and torque (N m) by which a linear friction exceeds that of the laws at the last
    /// trial.
    #[cold]
    #[inline(never)]
    fn excess(&self, contacts: &Contacts<R>, linear: LinearFriction) -> [R::Vec3; 2] {
        let [force, torque] = contacts.excess(self.problem, linear);
        let Some(others) = &self.others else {
            return [force, torque];
        };
        let [of_matrix, of_duals] = others.excess;
        let [more_force, more_torque] = match linear {
            LinearFriction::OfMatrix => of_matrix,
            LinearFriction::OfDuals => of_duals,
        };
        [force + more_force, torque + more_torque]
    }

    /// Returns true if the residual is so small that Newton's step squares it to rounding.
    #[inline(always)]
    fn is_close(&self, here: &Balance<R>) -> bool {
        let size = here.iterate.residual;
        let is_close = size <= here.tolerance * self.close
            && (!is_single::<R>()
                || (self.scale).turns_closely(self.problem, here.torque_residual, size));
        self.is_progress(here) && is_close && !(self.is_moving && is_single::<R>())
    }

    /// Returns true if Newton's step is not much larger than a residual that it squares to
    /// rounding.
    ///
    /// Where friction or springs exceed the inertia by more than the precision, rounding of the
    /// matrix hides the inertia, and the step may be of any size.
    #[inline(always)]
    fn is_small(&self, here: &Balance<R>, shift: R::Vec3, turn: R::Vec3) -> bool {
        let most = here.tolerance * self.close * R::from_f64(MOST_AMPLIFIED);
        size_of_motion(self.problem, shift, turn) <= most
    }

    /// Returns true if Newton's step may end a slide that the step resolves, if the friction of
    /// each contact stays as it is. The strain `h Σ|F|/|u|/m` is then that at the end. In `f64` the
    /// last of Newton's steps is too short for that.
    ///
    /// `(Σ|F|/|u|)²` is at most `n Σ F²/u²` for n contacts, which needs no roots. The contacts that
    /// are not stored are as the stored ones, which are spread evenly among them.
    #[inline(always)]
    fn may_end_a_slide(&self, contacts: &Contacts<R>, by: &Increment<R>) -> bool {
        let problem = self.problem;
        let (mut count, mut squares) = (R::ZERO, R::ZERO);
        for push in contacts.stored().iter().map(|touch| &touch.push) {
            let friction = (push.force - push.normal * push.mean.force).length_squared();
            if push.is_active() && friction > R::ZERO {
                let slip = push.slip + push.slip_by(problem, by, None);
                count += R::ONE;
                squares += friction / slip.length_squared();
            }
        }
        let stored = R::from_usize(contacts.stored().len().max(1));
        let each = R::from_usize(contacts.len()) / stored;
        let per_speed = problem.seconds / problem.mass * each;
        count * squares * (per_speed * per_speed) > R::TWO * R::TWO
    }

    /// Returns true if the momenta balance with the dual forces and Newton's step is small. The
    /// balance with the forces of the laws cannot show it in stick.
    #[inline(always)]
    fn is_close_in_stick(
        &self,
        here: &Balance<R>,
        contacts: &Contacts<R>,
        shift: R::Vec3,
        turn: R::Vec3,
    ) -> bool {
        // Scale of the body's own motion only, so that a slow creep is accurate to its own
        // rounding.
        let close_of_own = || self.scale.own * tolerance::<R>() * self.close;
        self.base.is_some()
            && !self.strain.of_step(self.problem).is_resolved()
            && size_of_motion(self.problem, shift, turn) <= close_of_own()
            && self.is_close_by_dual(here, contacts)
    }

    /// Returns true if the momenta balance with the dual forces in place of those of the laws.
    ///
    /// The dual forces are those of the matrix, from the step before. They are within the limits of
    /// the laws and accurate to second order.
    #[cold]
    #[inline(never)]
    fn is_close_by_dual(&self, here: &Balance<R>, contacts: &Contacts<R>) -> bool {
        let excess = self.excess(contacts, LinearFriction::OfDuals);
        let residual = [here.force_residual, here.torque_residual];
        let [force, torque] = without_excess(self.problem, residual, excess);
        norm(self.problem, force, torque) <= here.tolerance * self.close
    }

    /// Notes the trial if it is the best so far.
    #[inline(always)]
    fn remember(&mut self, here: &Balance<R>) {
        if (self.best).is_none_or(|best| here.iterate.residual < best.residual) {
            self.best = Some(here.iterate);
        }
    }

    /// Starts the iteration again from the best trial, as if it were the first one.
    #[cold]
    #[inline(never)]
    fn return_to_the_best(&mut self, trial: &mut TrialStep<R>) {
        if let Some(best) = self.best {
            self.problem.set(trial, best.velocity, best.cayley);
            self.base = None;
        }
    }
}

/// Largest ratio of the residual after an iteration to the residual before it that counts as
/// progress near the end.
#[inline(always)]
fn slowest<R: Real>() -> R {
    R::from_f64(if is_single::<R>() { 0.95 } else { 0.5 })
}

/// Sets the trial to the one after a shift and a rotation of the end of the step.
#[inline]
fn change<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    trial: &mut TrialStep<R>,
    from: &Iterate<R>,
    shift: R::Vec3,
    turn: R::Vec3,
) {
    let a = from.cayley;
    let change = (turn - a.cross(turn) + a * a.dot(turn)) * R::HALF;
    let velocity = from.velocity + shift * problem.per_second;
    problem.set(trial, velocity, a + change);
}
