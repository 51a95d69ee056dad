//! Continuation in the stiffness of the springs, if Newton's method does not find a step without
//! friction and dampers.
//!
//! On hard ground the loads of the contacts decide the motion, and each depth at the end of the
//! step is far smaller than the path to it. Newton's step for the loads rotates the body by an
//! angle whose square, times the size of the body, may exceed such a depth. The contact then has
//! neither a force nor a derivative, and the iteration begins again. It ends nowhere where several
//! points of a rim or of a face land in the same step, or where the middle of a smooth body is not
//! the centre of mass.
//!
//! With the forces of the springs multiplied by a factor `s`, the hardness `K h²/m` is `s` times
//! smaller. At a hardness of 1 Newton's method converges. The depth of a contact that lands is
//! `N⁻¹(λ/s)` for its load λ, so that it varies with `s` as `1/√s`. The solution for `s` is thus a
//! first trial for a larger factor: it differs from the solution by no more than the depths
//! themselves, and Newton's method approaches a small depth from a larger one without overshoot.
//! The factor increases to 1 in such stages. The last one has the equations of the step, so that
//! its solution conserves the energy like any other.
//!
//! A contact that starts at the depth d in the ground has the energy `k d²/2` in its spring. Scaled
//! by `s`, it would begin with less energy, and a stage would differ from the next one in its
//! motion. So its depths increase by `d (1/√s - 1)` ([`Problem::mean_force`]). The energy of a
//! linear spring is then that of the step at each factor.
//!
//! The constants were chosen on discs, cylinders, coins and loaded ellipsoids of 0.1 kg.
//! `tests/physics/elastic_bounces.rs` has other bodies and grounds.

use super::contacts::Contacts;
use super::gather::gather_all;
use super::newton;
use super::problem::{Forces, Problem, TrialStep};
use crate::energy::Energy;
use crate::integrator::Step;
use crate::real::Real;
use crate::scene::Dynamics;

/// Factor by which the stiffness increases from one stage to the next. The depth of a contact that
/// lands is then divided by 4, for which Newton's method needs two iterations.
const STRIDE: f64 = 16.0;
/// Smallest such factor. A stage that fails is tried again with the square root of its factor.
const LEAST_STRIDE: f64 = 1.2;
/// Number of evaluations after which no further stage begins.
const WORK: u32 = 120;

/// Solves a step without friction and dampers. Returns `None` if a stage does not converge.
#[cold]
#[inline(never)]
pub(super) fn solve<R: Real, D: Dynamics<R>>(
    problem: &mut Problem<'_, R, D>,
    contacts: &mut Contacts<R>,
    energy: &Energy<R>,
    step: &mut Step<R>,
) -> Option<TrialStep<R>> {
    let most = step.evaluations + WORK;
    let mut trial = problem.first_trial(energy);
    let mut known = R::ZERO;
    let mut next = softness(problem, contacts, &trial);
    step.evaluations += 1;
    let mut stride = R::from_f64(STRIDE);
    while step.evaluations < most {
        if let Some(end) = stage(problem, contacts, &trial, next, step) {
            (trial, known) = (end, next);
            if known >= R::ONE {
                return Some(trial);
            }
        } else {
            stride = stride.sqrt();
            if known == R::ZERO || stride < R::from_f64(LEAST_STRIDE) {
                return None;
            }
        }
        next = (known * stride).at_most(R::ONE);
    }
    None
}

/// Factor of the springs with which the hardness of the contacts at a trial is at most 1.
fn softness<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &mut Contacts<R>,
    trial: &TrialStep<R>,
) -> R {
    let mut stiffness = R::ZERO;
    gather_all(problem, contacts);
    contacts.respond(problem, trial, |push| stiffness += push.mean.stiffness);
    if contacts.has_others() {
        contacts.visit_others(problem, trial, &mut |touch, _, _| {
            stiffness += touch.push.mean.stiffness;
        });
    }
    let hardness = stiffness * problem.seconds * problem.seconds / problem.mass;
    R::ONE / hardness.at_least(R::ONE)
}

/// Solves the step with the springs multiplied by a factor, from the trial before.
fn stage<R: Real, D: Dynamics<R>>(
    problem: &mut Problem<'_, R, D>,
    contacts: &mut Contacts<R>,
    from: &TrialStep<R>,
    factor: R,
    step: &mut Step<R>,
) -> Option<TrialStep<R>> {
    problem.forces = Forces::Springs {
        factor: Some(factor),
    };
    gather_all(problem, contacts);
    let mut trial = *from;
    newton::solve(problem, contacts, &mut trial, step)?;
    Some(trial)
}
