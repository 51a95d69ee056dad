//! A step in parts, used if Newton's method does not find the whole step. Friction and dampers act
//! for half the step, springs and inertia for the whole step, friction and dampers for the other
//! half.
//!
//! The first and the last part act at a fixed pose and only dissipate energy
//! ([`resist`](super::resist)). The middle part uses the solver of the whole step without friction
//! and dampers. Its equations are those of a gradient. If that solver fails too, the springs harden
//! in stages ([`soften`]).

use super::contacts::Contacts;
use super::gather::gather_all;
use super::newton;
use super::problem::{Forces, Problem};
use super::resist::{Resisting, resisted};
use super::shared::{End, motion_of, visit_contacts};
use super::soften;
use super::turning;
use super::work;
use crate::energy::Energy;
use crate::friction::SlidingFriction;
use crate::ground::SpringDamperGround;
use crate::integrator::{Step, energy_limit};
use crate::real::{Real, Vector};
use crate::scene::Dynamics;
use crate::state::State;

/// Takes the step. Returns `None` if the conservative part has no solution either.
#[cold]
#[inline(never)]
pub(super) fn step<R: Real, D: Dynamics<R>>(
    scene: &D,
    (start, before): (&State<R>, &Energy<R>),
    seconds: R,
    contacts: &mut Contacts<R>,
    step: &mut Step<R>,
) -> Option<End<R>> {
    let half = seconds * R::HALF;
    let slowed = dissipate(scene, start, half);
    let energy = Energy::of(scene, &slowed);
    let properties = scene.inertia_properties();
    // What is lost about an axis without inertia is not given by the ground.
    let turning = State {
        angular_momentum: properties.without_dead_spin(start.rotation(), start.angular_momentum),
        ..*start
    };
    let work = work::of_impulse(scene, start.position, [&turning, &slowed]);
    // Resistances that hide the inertia may leave velocities of any size.
    if energy_limit::is_no_solution([before, &energy], work) {
        return None;
    }
    let mut problem = Problem {
        forces: Forces::Springs { factor: None },
        ..Problem::new(scene, &slowed, &energy, seconds)
    };
    problem.prepare();
    gather_all(&problem, contacts);
    let mut trial = problem.first_trial(&energy);
    if newton::solve(&problem, contacts, &mut trial, step).is_none() {
        trial = soften::solve(&mut problem, contacts, &energy, step)?;
    }
    let moved = problem.end_of(&trial);
    let moved_energy = Energy::without_springs(scene, &moved);
    if energy_limit::is_no_solution([&energy, &moved_energy], R::ZERO) {
        return None;
    }
    let end = dissipate(scene, &moved, half);
    let is_lossless = slowed == *start && end == moved;
    let work = work + work::of_impulse(scene, end.position, [&moved, &end]);
    (end.not_finite().is_none()).then_some(End {
        state: end,
        is_lossless,
        work,
    })
}

/// Applies friction and dampers to a body at a fixed pose for a time. Each contact resists with the
/// force of its law at its velocity.
///
/// The load of friction has no more of a damper than what stops the contact's share of the mass. A
/// damper that would stop it sooner has its force for a part of the time only.
fn dissipate<R: Real, D: Dynamics<R>>(scene: &D, state: &State<R>, seconds: R) -> State<R> {
    let bounding_radius = scene.bounding_radius().at_least(R::EPSILON);
    let state = &turning::slowed(scene, state, seconds);
    let motion = motion_of(scene, state);
    let touching = if scene.contact_model().has_rims() {
        // A rim has points that touch and are not pushed. Its load counts the others.
        scene.load(&motion).touching
    } else {
        let mut touching = 0;
        visit_contacts(scene, &motion, &mut |_| touching += 1);
        touching
    };
    let share = scene.inertia_properties().mass() / R::from_usize(touching.max(1));
    resisted(
        scene,
        bounding_radius,
        (state, touching),
        |motion, resist| {
            visit_contacts(scene, motion, &mut |contact| {
                let (ground, friction) = contact.laws(scene.ground(), scene.friction());
                let spring = ground.spring_force(contact.depth);
                let normal_force = ground.normal_force(contact.depth, contact.closing_speed);
                let damper = normal_force - spring;
                let time = seconds * contact.weight;
                let stops = share * contact.closing_speed.abs();
                let load = if damper * time > stops {
                    spring + stops / time
                } else {
                    normal_force
                };
                resist(&Resisting {
                    place: contact.arm,
                    normal: contact.normal,
                    along: friction
                        .force_at(contact.position, load, contact.slip_velocity)
                        .length()
                        * time,
                    across: damper.abs() * time,
                });
            });
        },
    )
}
