//! Newton's iteration on the momentum balance of a step.
//!
//! With the end velocities `v' = 2 vₘ - v` and `L' = R (2 J ωₘ - L)` of a trial, the equations are
//!
//! ```text
//! m (v' - v)/2 - dt/2 (F + m g) = 0,     (L' - L)/2 - dt/2 T = 0
//! ```
//!
//! A small change of the trial shifts the end of the step by `ξ` and turns it by `ϑ`: a contact's path changes by `ξ + ϑ × r'`, its mean arm by `ϑ × r'/2`, and
//! the Cayley argument by `(ϑ - a × ϑ + a (a·ϑ))/2`. In these unknowns the derivatives need neither inverses nor the map's own.

use super::contacts::{Contacts, Push};
use super::linear::{Block, SixBySix};
use super::problem::{Problem, Trial};
use super::settle::Strain;
use crate::integrator::Step;
use crate::real::{Real, Vector};
use crate::scene::Dynamics;

/// Full steps of Newton's, after which the iteration goes on carefully from the best trial.
const BOLD: u32 = 30;
/// So many tolerances are rounding (2e-16 of the momentum in f64).
const EXACT: f64 = 1e-4;
/// So many tolerances from the solution (2e-8 of the momentum in f64), Newton's step is the last one.
const CLOSE: f64 = 1e4;
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
    strain: Strain<R>,
    equations: SixBySix<R>,
}

/// A trial with what is lacking there, and where Newton's step leads from it.
#[derive(Clone, Copy, Debug)]
struct Base<R: Real> {
    trial: Trial<R>,
    size: R,
    shift: R::Vec3,
    turn: R::Vec3,
}

/// Solves the step: the trial and how it strains friction and dampers, or `None` where the iteration does not converge. Counts its work in `step`.
///
/// Full steps first: with the dual unknown they pass from slip to stick and back, which a search along the line would forbid. Where they run in a circle
/// (a spring so stiff that the step out of contact overshoots), the iteration goes back to the best trial and takes only steps that reduce what is lacking.
pub(super) fn solve<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &mut Contacts<R>,
    step: &mut Step<R>,
) -> Option<(Trial<R>, Strain<R>)> {
    let mut trial = problem.first_trial();
    let mut base: Option<Base<R>> = None;
    let mut best: Option<(R, Trial<R>)> = None;
    let mut share = R::ONE;
    for iteration in 0..LIMIT {
        let sum = add_up(problem, contacts, &trial);
        step.evaluations += 1;
        let (force_lack, torque_lack) = lack(problem, &trial, &sum);
        let size = norm(problem, force_lack, torque_lack);
        let tolerance = scale(problem, &trial, &sum) * tolerance::<R>();
        if size <= tolerance * R::from_f64(EXACT) {
            return Some((trial, sum.strain));
        }
        let progress = best.is_none_or(|(least, _)| size < least * R::HALF);
        // No further progress near the end: rounding is reached.
        if !progress && size <= tolerance * R::from_f64(1e3) {
            return Some((trial, sum.strain));
        }
        if best.is_none_or(|(least, _)| size < least) {
            best = Some((size, trial));
        }
        if let Some(base) = base {
            let worse = !size.is_finite() || (iteration > BOLD && size >= base.size);
            if worse {
                share *= R::HALF;
                if share < R::EPSILON {
                    return None;
                }
                trial = change(problem, &base.trial, base.shift * share, base.turn * share);
                continue;
            }
        } else if !size.is_finite() {
            return None;
        }
        step.iterations += 1;
        let (shift, turn) = sum
            .equations
            .solve(-force_lack, -torque_lack, problem.reach);
        // Newton's next step squares what is lacking: nothing is left to look at.
        if progress && size <= tolerance * R::from_f64(CLOSE) {
            let last = change(problem, &trial, shift, turn);
            return Some((last, sum.strain));
        }
        let here = Base {
            trial,
            size,
            shift,
            turn,
        };
        share = R::ONE;
        base = Some(here);
        trial = match best {
            Some((least, best)) if iteration == BOLD => {
                base = Some(Base {
                    trial: best,
                    // The next evaluation is at the best trial itself and must pass.
                    size: least * R::TWO,
                    ..here
                });
                best
            }
            _ => change(problem, &trial, shift, turn),
        };
    }
    None
}

/// Of the momentum's size: 1.8e-12 in f64, 6e-6 in f32.
#[inline]
fn tolerance<R: Real>() -> R {
    let root = R::EPSILON.sqrt();
    root * root.sqrt()
}

/// The trial after a shift and a turn of its end.
#[inline]
fn change<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    trial: &Trial<R>,
    shift: R::Vec3,
    turn: R::Vec3,
) -> Trial<R> {
    let a = trial.spin;
    let change = (turn - a.cross(turn) + a * a.dot(turn)) * R::HALF;
    problem.trial(
        trial.velocity + shift * problem.per_second,
        trial.spin + change,
    )
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
    let properties = problem.scene.mass_properties();
    let spin = properties.angular_velocity(&problem.motion.axes, angular);
    (linear.length_squared() * properties.inverse_mass() + angular.dot(spin).at_least(R::ZERO))
        .sqrt()
}

/// Size of the momenta that balance, √J: the body's own, gravity's, the contacts', and what rounding of places makes of
/// stiff springs and rounding of paths of strong dampers.
#[inline]
fn scale<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    trial: &Trial<R>,
    sum: &Sum<R>,
) -> R {
    let start = &problem.start;
    let half = problem.seconds * R::HALF;
    let energy = problem.mass * start.linear_velocity.length_squared()
        + problem
            .angular_momentum
            .dot(problem.motion.angular_velocity)
            .at_least(R::ZERO);
    let weight = problem.mass * problem.scene.gravity().length();
    let place = start.position.length() + problem.reach;
    let path = trial.shift.length() + trial.spin.length() * (R::TWO * problem.reach);
    let rounding = (sum.stiffness * place + sum.slope * path) * (R::EPSILON / tolerance::<R>());
    energy.sqrt() + half * (weight + sum.normal + rounding) / problem.mass.sqrt()
}

/// Forces, torques and their derivatives at a trial.
#[inline]
fn add_up<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &mut Contacts<R>,
    trial: &Trial<R>,
) -> Sum<R> {
    let mut sum = Sum {
        force: R::Vec3::ZERO,
        torque: R::Vec3::ZERO,
        normal: R::ZERO,
        stiffness: R::ZERO,
        slope: R::ZERO,
        strain: Strain::NONE,
        equations: inertial(problem, trial),
    };
    // The Cayley argument's change by a turn, for contacts with a radius.
    let argument = by_turn(trial.spin);
    for index in 0..contacts.len() {
        let Some(push) = contacts.push(index, problem, trial) else {
            continue;
        };
        let force = push.force();
        sum.force += force;
        sum.torque += push.arm.cross(force);
        sum.normal += push.mean.force;
        sum.stiffness += push.mean.stiffness;
        sum.slope += push.mean.slope;
        sum.strain.add(&push);
        add_stiffness(&mut sum.equations, problem, &push, &argument, force);
    }
    sum
}

/// `1 - â + a aᵀ`: twice the change of the Cayley argument by a turn of the step's end.
#[inline]
fn by_turn<R: Real>(a: R::Vec3) -> Block<R> {
    Block::diagonal(R::ONE)
        .plus(&Block::hat(-a))
        .plus(&Block::outer(a, a))
}

/// Derivatives of the momenta at the end.
#[inline]
fn inertial<R: Real, D: Dynamics<R>>(problem: &Problem<'_, R, D>, trial: &Trial<R>) -> SixBySix<R> {
    let mean = Block::diagonal(R::ONE)
        .plus(&trial.swing)
        .times_block(&problem.inertia.times_block(&by_turn(trial.spin)))
        .scaled(problem.per_second);
    SixBySix {
        force_by_shift: Block::diagonal(problem.mass * problem.per_second),
        force_by_turn: Block::ZERO,
        torque_by_shift: Block::ZERO,
        torque_by_turn: mean.plus(&Block::hat(trial.end_angular_momentum * -R::HALF)),
    }
}

/// Adds how one contact's force and torque answer to a shift and a turn of the step's end.
#[inline(always)]
fn add_stiffness<R: Real, D: Dynamics<R>>(
    equations: &mut SixBySix<R>,
    problem: &Problem<'_, R, D>,
    push: &Push<R>,
    argument: &Block<R>,
    force: R::Vec3,
) {
    let half = problem.seconds * R::HALF;
    let stiffness = stiffness(problem, push, half);
    let mut by_turn = stiffness.after_turn_of(push.end_arm);
    if push.radius > R::ZERO {
        let carried = argument.crossed_by(push.normal).scaled(push.radius);
        by_turn = by_turn.plus(&stiffness.times_block(&carried));
    }
    equations.add_turned(&stiffness, &by_turn, push.arm);
    // The mean arm turns too: (ϑ × r')/2 × F.
    let quarter = force * (-half * R::HALF);
    let arm_turns =
        Block::outer(push.end_arm, quarter).plus(&Block::diagonal(-quarter.dot(push.end_arm)));
    equations.torque_by_turn = equations.torque_by_turn.plus(&arm_turns);
}

/// `-dF/dx` of one contact for its path x over the step, times `factor`: `k (n - uₙ) nᵀ + c/dt (1 - n nᵀ - w' g ûᵀ)`.
#[inline(always)]
fn stiffness<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    push: &Push<R>,
    factor: R,
) -> Block<R> {
    let n = push.normal;
    let c = push.drag.coefficient * problem.per_second * factor;
    let loaded = n - push.slip * push.drag.per_load;
    let across = loaded * (push.mean.slope * factor) - n * c;
    let along = push.dual * (-c * push.drag.growth);
    Block::diagonal(c)
        .plus(&Block::outer(across, n))
        .plus(&Block::outer(along, push.slip_direction))
}
