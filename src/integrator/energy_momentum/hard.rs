//! Contacts of a step that is long compared with the oscillation of the body on them.
//!
//! # Load as an unknown
//!
//! A contact that starts above such ground ends a long step only slightly below it. Its mean force
//! `N(d)` increases with the square of the depth d at the end, over a path that is far longer. The
//! first trial ends deep in the ground. From there Newton's step for d halves d in each iteration,
//! from centimetres to micrometres. It overshoots wherever friction or the rotation is not linear.
//! The contact then has no force and no derivative, and the iteration begins again.
//!
//! The load `λ = N(d)` is a better unknown than d. The depth `d = N⁻¹(λ)` is small for any load
//! that the body can cause, so the equations are almost linear in λ. They are those of an impact
//! between rigid bodies. The dual unknown of friction changes the unknown for stick in the same
//! manner. An iteration has these parts:
//!
//! - The law is differentiated at the depth `d*` with `N(d*) = λ`, whatever the depth d of the
//!   trial is ([`linearise`]). The linear force at the trial is `N(d*) + N'(d*) (d - d*)`
//!   ([`beyond`]). Friction is that under the load λ, with the same linear part.
//! - Newton's step changes d by δ, so the next load is `N(d*) + N'(d*) (d + δ - d*)`
//!   ([`predict`]). A contact whose next load is not positive has none.
//!
//! The residual that ends the iteration is that of the laws, so that no solution of the step
//! changes. There `d* = d`, which is a condition for the end ([`loads_agree`]): where rounding of
//! the springs is large, the residual may be small by chance. Newton's last step is evaluated too,
//! if a contact touches or parts in it ([`touch_or_part`]).
//!
//! # Contacts without a load
//!
//! A contact that a trial has brought to the depth d gets the load that takes the body from there
//! to the surface and carries its weight, `m (2 d/h² + g)` ([`of_penetration`]). If all corners of
//! an edge or a face that lands obliquely had such loads, their linear equations would turn the
//! body flat onto the ground within the step, by large loads of both signs. So only the deepest of
//! these contacts get a load in an iteration, and the others have no force in it ([`DEEPEST`]).
//!
//! # Bound of Newton's step
//!
//! The energy does not increase. Let `T + V` be the energy of motion and springs at the start, and
//! W the weight. In the norm of the kinetic energy, the momentum at the end is at most
//! `√(2 (T + V)) + h W/√m`, and so is the mean momentum. A trial with more is no solution. A
//! rotation by more than a radian is beyond the linear equations. Newton's step is shortened to
//! both bounds ([`shortened`]). The loads are those after the whole step.
//!
//! The constants were chosen on boxes, dice, a coin of twelve points, a rod, a hull, a capsule and
//! a cube on 1e7 to 1e11 N/m. `tests/physics/long_steps.rs` has other bodies and grounds.

use super::contacts::Contacts;
use super::problem::{Problem, TrialStep};
use super::touch::{Increment, Touch};
use crate::ground::{MeanForce, SpringDamperGround};
use crate::real::{Real, Vector};
use crate::scene::Dynamics;

/// Contacts without a load get one if their depth is at least this fraction of that of the deepest.
/// So all contacts of a face that lands flat get one.
const DEEPEST: f64 = 0.9;
/// Accuracy of the load at the depth where a contact is differentiated. The linear force starts
/// there, so that the error has no effect on the solution.
const LOAD_ERROR: f64 = 0.01;
/// Largest relative error of a load at the end of the iteration.
const LOAD_TOLERANCE: f64 = 1e-3;
/// Number of evaluations of a law that search for that depth.
const SEARCH: u32 = 20;
/// Largest rotation of a Newton step, rad.
const MOST_TURN: f64 = 1.0;

/// Differentiates each contact at its load.
#[cold]
#[inline(never)]
pub(super) fn linearise<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &mut Contacts<R>,
) {
    let mut deepest = R::ZERO;
    for touch in contacts.stored() {
        if is_new(problem, touch) {
            deepest = deepest.at_least(touch.push.end_depth);
        }
    }
    let enough = deepest * R::from_f64(DEEPEST);
    for touch in contacts.stored_mut() {
        // Close to the solution the depth of the trial has the load, and is itself the result.
        let has_force = touch.push.mean.force > R::ZERO;
        let last_depth = touch.load_depth;
        touch.load_depth = touch.push.end_depth;
        if is_new(problem, touch) {
            if touch.push.end_depth < enough {
                release(touch);
            } else {
                let load = of_penetration(problem, touch);
                linearise_at(problem, touch, load, touch.push.end_depth);
            }
        } else if touch.load > R::ZERO {
            let near = if has_force {
                touch.push.end_depth
            } else {
                last_depth
            };
            linearise_at(problem, touch, touch.load, near);
        }
    }
}

/// Returns true if a contact has penetrated the ground so far that its law is not to be
/// differentiated there, and farther than its load explains.
fn is_new<R: Real, D: Dynamics<R>>(problem: &Problem<'_, R, D>, touch: &Touch<R>) -> bool {
    let load = of_penetration(problem, touch);
    touch.push.end_depth > R::ZERO && touch.push.mean.force > load && load > touch.load
}

/// Load that takes the body from the depth of a contact to the surface and carries its weight, N.
fn of_penetration<R: Real, D: Dynamics<R>>(problem: &Problem<'_, R, D>, touch: &Touch<R>) -> R {
    let acceleration = touch.push.end_depth * (R::TWO * problem.per_second * problem.per_second);
    (acceleration + problem.scene.gravity().length()) * problem.mass
}

/// Removes the force of a contact from the linear equations.
fn release<R: Real>(touch: &mut Touch<R>) {
    (touch.push.mean, touch.push.force) = (MeanForce::NONE, R::Vec3::ZERO);
}

/// Replaces the force of a contact by that of a load. Leaves it unchanged if no depth has this
/// load.
fn linearise_at<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    touch: &mut Touch<R>,
    load: R,
    near: R,
) {
    if let Some((depth, mean)) = depth_under(problem, touch, load, near) {
        (touch.load_depth, touch.push.mean) = (depth, mean);
        let friction = touch.friction(problem, touch.push.slip);
        touch.push.force = touch.push.normal * mean.force + friction;
    }
}

/// Depth at the end of the step with this load, and the mean force there, by Newton's method from a
/// depth `near` it with a force. The root of the force is linear in the depth for a contact that
/// starts above the ground.
fn depth_under<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    touch: &Touch<R>,
    load: R,
    near: R,
) -> Option<(R, MeanForce<R>)> {
    let (mut low, mut high) = (-R::MAX, R::MAX);
    let mut depth = near;
    for _ in 0..SEARCH {
        let mean = touch.push.mean_force(problem, depth);
        if (mean.force - load).abs() <= load * R::from_f64(LOAD_ERROR) {
            return Some((depth, mean));
        }
        if mean.force > load {
            high = depth;
        } else {
            low = depth;
        }
        let root = mean.force.sqrt();
        let next = depth + (load.sqrt() - root) * (R::TWO * root / mean.slope);
        // It is false for NaN too.
        let is_between = next > low && next < high;
        depth = if is_between {
            next
        } else {
            (low + high) * R::HALF
        };
    }
    None
}

/// Part of a contact's linear force between the depth at which it is differentiated and the depth
/// of the trial, N.
pub(super) fn beyond<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    touch: &Touch<R>,
) -> R::Vec3 {
    let reach = touch.push.end_depth - touch.load_depth;
    touch.loaded(problem) * (touch.push.mean.slope * reach)
}

/// Returns true if the law of each contact has its load at the last trial, to within the rounding
/// of the depth there.
#[cold]
#[inline(never)]
pub(super) fn loads_agree<R: Real, D>(problem: &Problem<'_, R, D>, contacts: &Contacts<R>) -> bool {
    let rounding = problem.depth_scale * R::EPSILON;
    contacts.stored().iter().all(|touch| {
        let (mean, load) = (&touch.push.mean, touch.load);
        (mean.force - load).abs() <= load * R::from_f64(LOAD_TOLERANCE) + mean.slope * rounding
    })
}

/// Sets the loads to those after a Newton step.
#[cold]
#[inline(never)]
pub(super) fn predict<R: Real>(contacts: &mut Contacts<R>, by: &Increment<R>) {
    for touch in contacts.stored_mut() {
        let push = &touch.push;
        touch.load = R::ZERO;
        if push.is_active() {
            let deeper = -push.normal.dot(by.shift + by.turn.cross(push.end_arm));
            let reach = push.end_depth - touch.load_depth + deeper;
            touch.load = (push.mean.force + push.mean.slope * reach).at_least(R::ZERO);
        }
    }
}

/// Returns true if a Newton step makes a contact touch or part, according to its depth or its
/// linear force. The force is not smooth there, so that the step does not square the residual.
#[cold]
#[inline(never)]
pub(super) fn touch_or_part<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &Contacts<R>,
    trial: &TrialStep<R>,
    by: &Increment<R>,
) -> bool {
    contacts.stored().iter().any(|touch| {
        let push = &touch.push;
        let end_arm = touch.end_arm(problem, trial);
        let deeper = -push.normal.dot(by.shift + by.turn.cross(end_arm));
        let depth = push.end_depth + deeper;
        let load = push.mean.force + push.mean.slope * deeper;
        (push.end_depth > R::ZERO) != (depth > R::ZERO)
            || (push.mean.force > R::ZERO) != (load > R::ZERO)
    })
}

/// Shortens a shift and a rotation to the bounds of a solution. `ahead` is the mean momentum after
/// them, in the norm of the kinetic energy, √J.
pub(super) fn shortened<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    [shift, turn]: [R::Vec3; 2],
    ahead: R,
) -> [R::Vec3; 2] {
    let energy = problem.kinetic_energy + problem.spring_energy;
    let fallen = problem.seconds * problem.scene.gravity().length() * problem.mass.sqrt();
    let most = (energy * R::TWO).sqrt() + fallen;
    let mut share = R::ONE;
    // A ground that moves may add any energy.
    if ahead > most && problem.scene.ground().motion().is_none() {
        share = most / ahead;
    }
    let angle = turn.length();
    if angle * share > R::from_f64(MOST_TURN) {
        share = R::from_f64(MOST_TURN) / angle;
    }
    [shift * share, turn * share]
}
