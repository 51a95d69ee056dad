//! Newton's iteration on the momentum balance of a step.
//!
//! With the end velocities `v' = 2 vₘ - v` and `L' = R (2 J ωₘ - L)` of a trial, the equations are
//!
//! ```text
//! m (v' - v)/2 - dt/2 (F + m g) = 0,     (L' - L)/2 - dt/2 T = 0
//! ```
//!
//! A small change of the trial shifts the end of the step by `ξ` and turns it by `ϑ`: a contact's
//! path changes by `ξ + ϑ × r'`, its mean arm by `ϑ × r'/2`, and the Cayley argument by
//! `(ϑ - a × ϑ + a (a·ϑ))/2`. In these unknowns the derivatives need neither inverses nor the map's
//! own.
//!
//! # Stick
//!
//! A contact that sticks has the slip `u = ε d/(1 - |d|)`, where `d` is its friction over `μ N` and
//! `ε` the slip speed of the law. The slip is a difference of velocities v, known to `2e-16 v`.
//! The law makes `μ N/ε` times that of it: at `ε = 1e-10 m/s` a millionth of the friction, at
//! 1e-16 m/s all of it. The balance with the law's force cannot be better, although the
//! velocities are right to rounding. Two things follow:
//!
//! - The iteration is close where the momenta balance with the *dual* forces `-μ N d`, which lie
//!   within the law's limit, and where Newton's step is small ([`is_close_by_dual`]). That step is
//!   the last one.
//! - Where the slip begins within its own rounding, so that the dual unknown cannot be had from
//!   it, the slip is carried along as an unknown: each of Newton's steps adds its increment, which
//!   is known to 2e-16 of itself ([`Increment`]). It stays within the rounding of the difference.

use super::contacts::Contacts;
use super::end_velocity::Strain;
use super::linear::Factored;
use super::problem::{Problem, Trial};
use super::stiffness;
use super::touch::{Increment, Push};
use crate::body::RigidPointBody;
use crate::integrator::Step;
use crate::real::{Real, Vector};
use crate::scene::Dynamics;

/// Full steps of Newton's, after which the iteration goes on carefully from the best trial.
const BOLD: u32 = 30;
/// So many fourth roots of the precision's unit, times the tolerance, are rounding: 1e-4 tolerances
/// or 2e-16 of the momentum in f64, 1.5e-2 tolerances or 1e-7 of it in f32.
///
/// Its inverse, 1.2 square roots of that unit, is so near to the solution that Newton's step is the
/// last one: it squares what is lacking.
const EXACT: f64 = 0.8192;
/// Of the distance from which one step is enough, an iteration without progress may end at this
/// fraction.
const STALLED: f64 = 0.1;
/// A momentum at a contact is at most so many times larger in the norm of the kinetic energy than
/// at the centre of mass: for a rod of ten points at its end, twice; more need not be looked for.
const MOST_LEVERAGE: f64 = 8.0;
/// Evaluations after which the step is given up.
const LIMIT: u32 = 60;

/// What the contacts do over a trial step, together.
#[derive(Clone, Copy, Debug)]
struct Sum<R: Real> {
    force: R::Vec3,
    torque: R::Vec3,
    /// Sum of the sizes of the normal forces, N.
    normal: R,
    /// Sum of the stiffnesses of the springs over the step, N/m.
    stiffness: R,
    /// Sum of the slopes of the normal forces, dampers included, N/m.
    slope: R,
}

impl<R: Real> Sum<R> {
    const NONE: Self = Self {
        force: R::Vec3::ZERO,
        torque: R::Vec3::ZERO,
        normal: R::ZERO,
        stiffness: R::ZERO,
        slope: R::ZERO,
    };

    #[inline(always)]
    fn add(&mut self, push: &Push<R>) {
        self.force += push.force;
        self.torque += push.arm.cross(push.force);
        self.normal += push.mean.force;
        self.stiffness += push.mean.stiffness;
        self.slope += push.mean.slope;
    }
}

/// The unknowns of a trial, with what is lacking there.
#[derive(Clone, Copy, Debug)]
struct Place<R: Real> {
    velocity: R::Vec3,
    spin: R::Vec3,
    size: R,
}

/// Newton's step from a place.
#[derive(Clone, Copy, Debug)]
struct Base<R: Real> {
    place: Place<R>,
    shift: R::Vec3,
    turn: R::Vec3,
}

/// Solves the step: the trial, which is left in `trial`, and how it strains friction and dampers,
/// or `None` where the iteration does not converge. Counts its work in `step`.
///
/// Full steps first: with the dual unknown they pass from slip to stick and back, which a search
/// along the line would forbid. Where they run in a circle (a spring so stiff that the step out of
/// contact overshoots), the iteration goes back to the best trial and takes only steps that reduce
/// what is lacking.
pub(super) fn solve<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &mut Contacts<R>,
    trial: &mut Trial<R>,
    step: &mut Step<R>,
) -> Option<Strain<R>> {
    let mut matrix = Factored::NONE;
    let mut strain = Strain::NONE;
    let mut base: Option<Base<R>> = None;
    let mut best: Option<Place<R>> = None;
    let mut share = R::ONE;
    let mut increment = None;
    let mut with_increments = false;
    let scale = Scale::of(problem);
    let is_smooth = problem.scene.body().is_smooth();
    let exact = R::EPSILON.sqrt().sqrt() * R::from_f64(EXACT);
    let close = R::ONE / exact;
    // Of the body's own motion alone, so that a slow creep is found to rounding of itself.
    let close_of_own = scale.own * tolerance::<R>() * close;
    for iteration in 0..LIMIT {
        let mut sum = Sum::NONE;
        match increment.take() {
            None => contacts.respond(problem, trial, |push| sum.add(push)),
            Some(by) => {
                contacts.respond_by_increment(problem, trial, &by, &mut |push| sum.add(push));
            }
        }
        sum.torque += contacts.lever.torque * sum.normal;
        step.evaluations += 1;
        let (force_lack, torque_lack) = lack(problem, trial, &sum);
        let here = Place {
            velocity: trial.velocity,
            spin: trial.spin,
            size: norm(
                problem,
                force_lack,
                beyond_lever(problem, contacts, sum.normal, torque_lack),
            ),
        };
        let tolerance = scale.at(problem, trial, &sum) * tolerance::<R>();
        let rounding = rounding_of_lever(problem, contacts, sum.normal);
        if here.size <= tolerance * exact + rounding {
            return Some(Strain::at(problem, contacts, trial));
        }
        let progress = best.is_none_or(|best| here.size < best.size * R::HALF);
        // No further progress near the end: rounding is reached. In f32 the end is so far from
        // there that a slow progress counts.
        let stalls = !progress && best.is_none_or(|best| here.size > best.size * slowest::<R>());
        if stalls && here.size <= tolerance * close * R::from_f64(STALLED) + rounding {
            return Some(Strain::at(problem, contacts, trial));
        }
        if !(with_increments || strain.of_step(problem).is_resolved()) {
            let of_slips = scale.rounding_of_slips(problem, trial, &strain);
            with_increments = here.size <= of_slips && of_slips > tolerance * close;
        }
        if let Some(base) = &base {
            let worse =
                !here.size.is_finite() || (iteration > BOLD && here.size >= base.place.size);
            if worse {
                share *= R::HALF;
                if share < R::EPSILON {
                    return None;
                }
                // The dual unknowns go on from here.
                contacts.note_answers(problem, trial);
                change(
                    problem,
                    trial,
                    &base.place,
                    base.shift * share,
                    base.turn * share,
                );
                continue;
            }
        } else if !here.size.is_finite() {
            return None;
        }
        step.iterations += 1;
        // What would be lacking after one more step with the last derivatives, if it takes off as
        // large a share again.
        let once_more = base.map_or(R::MAX, |base| here.size * (here.size / base.place.size));
        let enough = once_more <= tolerance * exact;
        let is_close = here.size <= tolerance * close
            && (!is_single::<R>() || scale.turns_closely(problem, torque_lack, here.size));
        let last = enough || (progress && is_close && !(is_smooth && is_single::<R>()));
        if enough {
            // A step that is resolved is so here too; how far another one is not, is asked where it
            // ends.
            if !strain.of_step(problem).is_resolved() {
                strain = Strain::at(problem, contacts, trial);
            }
        } else {
            strain = stiffness::equations(problem, contacts, trial, &mut matrix.equations);
            matrix.factor(problem.bounding_radius);
        }
        let (shift, turn) = matrix.solve(-force_lack, -torque_lack, problem.bounding_radius);
        let last = last
            || base.is_some()
                && !strain.of_step(problem).is_resolved()
                && size_of_motion(problem, shift, turn) <= close_of_own
                && is_close_by_dual(
                    problem,
                    contacts,
                    [force_lack, torque_lack],
                    tolerance * close,
                );
        change(problem, trial, &here, shift, turn);
        if with_increments && iteration < BOLD {
            increment = Some(Increment::of(shift, turn, here.spin));
        }
        // Newton's next step squares what is lacking: nothing is left to look at.
        if last {
            return Some(strain);
        }
        if best.is_none_or(|best| here.size < best.size) {
            best = Some(here);
        }
        share = R::ONE;
        let mut place = here;
        if iteration == BOLD {
            if let Some(best) = best {
                problem.set(trial, best.velocity, best.spin);
                // The next evaluation is at the best trial itself and must pass.
                place.size = best.size * R::TWO;
            }
        }
        base = Some(Base { place, shift, turn });
    }
    None
}

/// Whether one Newton's step from the distance that is close leaves errors that add up to something
/// within thousands of steps.
#[inline(always)]
pub(super) fn is_single<R: Real>() -> bool {
    R::EPSILON > R::from_f64(1e-10)
}

/// The largest part of what was lacking that may be lacking after an iteration which counts as
/// progress near the end.
#[inline(always)]
fn slowest<R: Real>() -> R {
    R::from_f64(if is_single::<R>() { 0.95 } else { 0.5 })
}

/// Of the momentum's size: 1.8e-12 in f64, 6e-6 in f32.
#[inline]
fn tolerance<R: Real>() -> R {
    let root = R::EPSILON.sqrt();
    root * root.sqrt()
}

/// The trial after a shift and a turn of the step's end.
#[inline]
fn change<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    trial: &mut Trial<R>,
    from: &Place<R>,
    shift: R::Vec3,
    turn: R::Vec3,
) {
    let a = from.spin;
    let change = (turn - a.cross(turn) + a * a.dot(turn)) * R::HALF;
    let velocity = from.velocity + shift * problem.per_second;
    problem.set(trial, velocity, a + change);
}

/// By how much the momentum balance fails.
#[inline]
fn lack<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    trial: &Trial<R>,
    sum: &Sum<R>,
) -> (R::Vec3, R::Vec3) {
    let half = problem.seconds * R::HALF;
    let gained = (trial.end_velocity - problem.start.linear_velocity) * R::HALF;
    let weight = problem.scene.gravity() * half;
    (
        (gained - weight) * problem.mass - sum.force * half,
        (trial.end_angular_momentum - problem.angular_momentum) * R::HALF - sum.torque * half,
    )
}

/// Size of a momentum in the norm of the kinetic energy, √J.
#[inline]
fn norm<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    linear: R::Vec3,
    angular: R::Vec3,
) -> R {
    let properties = problem.scene.inertia_properties();
    let turning = properties.rotational_energy(&problem.motion.axes, angular) * R::TWO;
    (linear.length_squared() * properties.inverse_mass() + turning).sqrt()
}

/// Whether the momenta balance with the dual forces in place of the laws'.
///
/// The duals are those of the matrix, from the step before: within the laws' limits, and right to
/// second order.
#[cold]
#[inline(never)]
fn is_close_by_dual<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &Contacts<R>,
    [force_lack, torque_lack]: [R::Vec3; 2],
    close: R,
) -> bool {
    let half = problem.seconds * R::HALF;
    let (force, torque) = contacts.dual_excess(problem);
    norm(
        problem,
        force_lack - force * half,
        torque_lack - torque * half,
    ) <= close
}

/// What rounding of a smooth body's surface makes of the balance, √J; 0 of other bodies.
#[inline]
fn rounding_of_lever<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &Contacts<R>,
    normal_force: R,
) -> R {
    if problem.scene.body().is_smooth() && !is_single::<R>() {
        let impulse = problem.seconds * R::HALF * normal_force;
        norm(problem, R::Vec3::ZERO, contacts.lever.rounding * impulse)
    } else {
        R::ZERO
    }
}

/// What is lacking of the torque beyond what rounding of a smooth body's surface makes of it, in
/// single precision; elsewhere all of it.
///
/// That rounding is along the lever's torque and does the springs' work to rounding. A residual of
/// the same size in another direction would do much more: in f32, at a rotation of 1e-3 rad, a
/// thousandth of the energy.
#[inline]
fn beyond_lever<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &Contacts<R>,
    normal_force: R,
    torque_lack: R::Vec3,
) -> R::Vec3 {
    let along = contacts.lever.rounding;
    let square = along.length_squared();
    if !(is_single::<R>() && problem.scene.body().is_smooth() && square > R::ZERO) {
        return torque_lack;
    }
    let most = problem.seconds * R::HALF * normal_force;
    let part = torque_lack.dot(along) / square;
    torque_lack - along * part.at_most(most).at_least(-most)
}

/// Size of a shift and a turn over the step in the norm of the kinetic energy, √J.
#[cold]
#[inline(never)]
fn size_of_motion<R: Real, D>(problem: &Problem<'_, R, D>, shift: R::Vec3, turn: R::Vec3) -> R {
    let turning = turn.dot(problem.inertia.times(turn));
    (shift.length_squared() * problem.mass + turning).sqrt() * problem.per_second
}

/// Size of the momenta that balance, √J: the body's own, gravity's, the contacts', and what
/// rounding of places makes of stiff springs and rounding of paths of strong dampers.
#[derive(Clone, Copy, Debug)]
struct Scale<R> {
    own: R,
    weight: R,
    root_of_mass: R,
}

impl<R: Real> Scale<R> {
    #[inline]
    fn of<D: Dynamics<R>>(problem: &Problem<'_, R, D>) -> Self {
        Self {
            own: (problem.kinetic_energy * R::TWO).sqrt(),
            weight: problem.mass * problem.scene.gravity().length(),
            root_of_mass: problem.mass.sqrt(),
        }
    }

    /// Whether one more step leaves no more than rounding of the angular momentum as well, where
    /// the linear one is the larger: the square of what is lacking of their sum is to be small
    /// against the angular one alone.
    fn turns_closely<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        torque_lack: R::Vec3,
        size: R,
    ) -> bool {
        let angular = norm(problem, R::Vec3::ZERO, problem.angular_momentum);
        let lack = norm(problem, R::Vec3::ZERO, torque_lack);
        angular == R::ZERO || lack * size <= angular * self.own * R::EPSILON * R::from_f64(4.0)
    }

    /// What rounding of the slips makes of friction, √J, at most.
    #[cold]
    #[inline(never)]
    fn rounding_of_slips<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        trial: &Trial<R>,
        strain: &Strain<R>,
    ) -> R {
        let impulse = strain.friction_over(problem.rounding_of_path(trial)) * R::HALF;
        impulse * R::from_f64(MOST_LEVERAGE) / self.root_of_mass
    }

    #[inline]
    fn at<D>(&self, problem: &Problem<'_, R, D>, trial: &Trial<R>, sum: &Sum<R>) -> R {
        let half = problem.seconds * R::HALF;
        let path = trial.shift.length() + trial.spin.length() * (R::TWO * problem.bounding_radius);
        let rounding =
            (sum.stiffness * problem.place + sum.slope * path) * (R::EPSILON / tolerance::<R>());
        self.own + half * (self.weight + sum.normal + rounding) / self.root_of_mass
    }
}
