//! How the momentum balance of a step answers to a shift `ξ` and a turn `ϑ` of its end: the matrix of Newton's method.
//!
//! A contact's path changes by `ξ + ϑ × r'` (r': its arm at the end), its mean arm by `ϑ × r'/2`, and the Cayley argument by `(ϑ - a × ϑ + a (a·ϑ))/2`.

use super::contacts::{Answer, Contacts, Push};
use super::linear::{Block, SixBySix};
use super::problem::{Problem, Trial};
use super::settle::Strain;
use crate::real::{Real, Vector};
use crate::scene::Dynamics;

/// The matrix at the trial that the contacts have responded to last, and how the step strains them there.
pub(super) fn equations<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &mut Contacts<R>,
    trial: &Trial<R>,
    equations: &mut SixBySix<R>,
) -> Strain<R> {
    let argument = by_turn(trial.spin);
    *equations = inertial(problem, trial, &argument);
    let mut strain = Strain::NONE;
    contacts.answer(problem, trial, |push, answer| {
        strain.add(push, &answer.drag);
        let path = of_path(problem, push, answer);
        let mut turn = path.map(|row| push.end_arm.cross(row));
        if problem.has_radii {
            // The Cayley argument's change carries the place under a contact's centre.
            let carried = argument.crossed_by(push.normal * push.radius);
            for (turn, row) in turn.iter_mut().zip(path) {
                *turn += R::Vec3::new(carried.x.dot(row), carried.y.dot(row), carried.z.dot(row));
            }
        }
        equations.add(path, turn, push.arm);
        // The mean arm turns too: (ϑ × r')/2 × F.
        let quarter = problem.seconds * (R::HALF * R::HALF);
        equations.add_swing(push.end_arm, push.force * -quarter);
    });
    strain
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
fn inertial<R: Real, D>(
    problem: &Problem<'_, R, D>,
    trial: &Trial<R>,
    argument: &Block<R>,
) -> SixBySix<R> {
    let mean = problem.inertia.times_block(argument);
    let mean = mean
        .plus(&trial.swing.times_block(&mean))
        .scaled(problem.per_second);
    let turned = Block::hat(trial.end_angular_momentum * -R::HALF);
    SixBySix::of_body(problem.mass * problem.per_second, &mean.plus(&turned))
}

/// Rows of `-dt/2 dF/dx` of one contact for its path x over the step: of `dt/2 (k (n - uₙ) nᵀ + c/dt (1 - n nᵀ - w' g ûᵀ))`.
#[inline(always)]
fn of_path<R: Real, D>(
    problem: &Problem<'_, R, D>,
    push: &Push<R>,
    answer: &Answer<R>,
) -> [R::Vec3; 3] {
    let (n, u) = (push.normal, answer.slip_direction);
    let c = answer.drag.coefficient * R::HALF;
    let loaded = n - push.slip * answer.drag.per_load;
    let across = loaded * (push.mean.slope * (problem.seconds * R::HALF)) - n * c;
    let along = answer.dual * (-c * answer.drag.growth);
    if problem.is_bare {
        // n is the third axis, and nothing slides along it.
        let (o, k) = (R::ZERO, push.mean.slope * (problem.seconds * R::HALF));
        return [
            R::Vec3::new(along.x() * u.x() + c, along.x() * u.y(), across.x()),
            R::Vec3::new(along.y() * u.x(), along.y() * u.y() + c, across.y()),
            R::Vec3::new(o, o, k),
        ];
    }
    let row = |across: R, along: R| n * across + u * along;
    [
        row(across.x(), along.x()) + R::Vec3::new(c, R::ZERO, R::ZERO),
        row(across.y(), along.y()) + R::Vec3::new(R::ZERO, c, R::ZERO),
        row(across.z(), along.z()) + R::Vec3::new(R::ZERO, R::ZERO, c),
    ]
}
