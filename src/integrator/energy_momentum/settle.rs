//! What a step that is too long for friction or dampers must still do: let them stop the body at its end.
//!
//! A mean force over a step knows the mean velocity only. Where friction or a damper could stop a contact in less than half a step, the mean velocity comes out as 0 and the end velocity as minus the start's:
//! a sticking contact would flip for ever, and an over-damped floor throw a body back. The cure is an impulse at the end of the step that resists the end velocity,
//!
//! ```text
//! (M + Σ Jᵢᵀ kᵢ Jᵢ) y' = M y        y = (v', ω'),   kᵢ >= 0
//! ```
//!
//! whose impulses `kᵢ uᵢ'` are limited to what the law gives at the end velocity *beyond* what it has given at the mean one. Whatever the `kᵢ >= 0` are, the kinetic energy falls:
//! `y'ᵀ M y' <= yᵀ M y`. In steady motion the two are the same and nothing happens; where the step resolves friction and dampers, nothing is applied at all, so that
//! the order stays 2.

use super::contacts::{Contacts, Push};
use super::linear::{Block, SixBySix};
use super::problem::{Problem, Trial};
use crate::friction::SlidingFriction;
use crate::ground::SpringDamperGround;
use crate::real::{Real, Vector};
use crate::rotation::Axes;
use crate::scene::Dynamics;
use crate::state::State;

/// Passes that fit the resistances to their limits. Each keeps the energy from rising; more of them only share an impulse better.
const PASSES: u32 = 4;

/// How strongly a step overstrains friction and dampers: `2 dt Σc/m`, unresolved above 2.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strain<R> {
    friction: R,
    damping: R,
}

impl<R: Real> Strain<R> {
    pub(super) fn of<D: Dynamics<R>>(
        problem: &Problem<'_, R, D>,
        contacts: &mut Contacts<R>,
        trial: &Trial<R>,
    ) -> Self {
        let (mut drag, mut damping) = (R::ZERO, R::ZERO);
        contacts.visit(problem, trial, |push| {
            drag += push.drag.coefficient;
            damping += push.mean.damping;
        });
        let factor = R::TWO * problem.seconds / problem.mass;
        Self {
            friction: drag * factor,
            damping: damping * factor,
        }
    }

    pub(super) fn is_resolved(&self) -> bool {
        self.friction <= R::TWO && self.damping <= R::TWO
    }

    /// The share of a limit that is applied: 0 up to a strain of 2, towards 1 far above.
    fn share(strain: R) -> R {
        if strain > R::TWO {
            R::ONE - R::TWO / strain
        } else {
            R::ZERO
        }
    }
}

/// Lets friction and dampers resist the end velocity of a trial, within their limits.
pub(super) fn settle<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &mut Contacts<R>,
    trial: &Trial<R>,
    strain: Strain<R>,
    end: &mut State<R>,
) {
    let axes = end.rotation().axes();
    let mut settled = *end;
    for _ in 0..PASSES {
        let Some(next) = pass(problem, contacts, trial, strain, &axes, end, &settled) else {
            break;
        };
        settled = next;
    }
    *end = settled;
}

/// One pass: resistances from the velocities of `known`, applied to those of `end`.
fn pass<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &mut Contacts<R>,
    trial: &Trial<R>,
    strain: Strain<R>,
    axes: &Axes<R>,
    end: &State<R>,
    known: &State<R>,
) -> Option<State<R>> {
    let properties = problem.scene.mass_properties();
    let spin = properties.angular_velocity(axes, end.angular_momentum);
    let known_spin = properties.angular_velocity(axes, known.angular_momentum);
    let (inertia, _) = properties.inertia_for_solving(axes, end.angular_momentum);
    let mut equations = SixBySix {
        force_by_shift: Block::diagonal(problem.mass),
        force_by_turn: Block::ZERO,
        torque_by_shift: Block::ZERO,
        torque_by_turn: Block {
            x: inertia[0],
            y: inertia[1],
            z: inertia[2],
        },
    };
    let (mut impulse, mut turning) = (R::Vec3::ZERO, R::Vec3::ZERO);
    let mut active = false;
    contacts.visit(problem, trial, |push| {
        let place = push.end_point();
        let at_end = end.linear_velocity + spin.cross(place);
        let at_known = known.linear_velocity + known_spin.cross(place);
        let resistance = resistance(problem, push, strain, at_end, at_known);
        let Some(resistance) = resistance else {
            return;
        };
        active = true;
        let path = Block::hat(-place);
        let by_turn = resistance.times_block(&path);
        equations.force_by_shift = equations.force_by_shift.plus(&resistance);
        equations.force_by_turn = equations.force_by_turn.plus(&by_turn);
        equations.torque_by_shift = equations
            .torque_by_shift
            .plus(&resistance.crossed_by(place));
        equations.torque_by_turn = equations.torque_by_turn.plus(&by_turn.crossed_by(place));
        let resisted = resistance.times(at_end);
        impulse += resisted;
        turning += place.cross(resisted);
    });
    if !active {
        return None;
    }
    // Solved for the change of y, so that what no contact resists stays as it is to the last place.
    let (change, turn) = equations.solve(-impulse, -turning, problem.reach);
    let tensor: Block<R> = Block {
        x: inertia[0],
        y: inertia[1],
        z: inertia[2],
    };
    let settled = State {
        linear_velocity: end.linear_velocity + change,
        angular_momentum: end.angular_momentum + tensor.times(turn),
        ..*end
    };
    settled.not_finite().is_none().then_some(settled)
}

/// Resistance of one contact, N s²/m... as an impulse for each m/s of end velocity; `None` where the laws ask for none.
fn resistance<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    push: &Push<R>,
    strain: Strain<R>,
    at_end: R::Vec3,
    at_known: R::Vec3,
) -> Option<Block<R>> {
    let (ground, friction) = (problem.scene.ground(), problem.scene.friction());
    let n = push.normal;
    let rising = at_end.dot(n);
    let slip = at_end - n * rising;
    let beyond_friction = friction.force(push.mean.force, slip).length() - push.friction.length();
    let along = limited(
        beyond_friction * problem.seconds * Strain::share(strain.friction),
        slip.length(),
        (at_known - n * at_known.dot(n)).length(),
    );
    let at_end_force = if push.end_depth > R::ZERO {
        ground.normal_force(push.end_depth, -rising)
    } else {
        R::ZERO
    };
    let across = limited(
        (push.mean.force - at_end_force) * problem.seconds * Strain::share(strain.damping),
        rising,
        at_known.dot(n).abs(),
    );
    (along > R::ZERO || across > R::ZERO)
        .then(|| Block::diagonal(along).plus(&Block::outer(n * (across - along), n)))
}

/// Resistance whose impulse at the speed `known` is `limit`: 0 where the contact does not move at `speed` above 0, or has no limit above 0.
fn limited<R: Real>(limit: R, speed: R, known: R) -> R {
    if limit > R::ZERO && speed > R::ZERO {
        // A contact that has stopped keeps a resistance that holds it to a millionth of its speed.
        limit / known.at_least(speed * R::from_f64(1e-6))
    } else {
        R::ZERO
    }
}
