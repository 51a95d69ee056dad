//! Resistance to rolling and spinning at a fixed pose, for a step that is [split](super::split).
//!
//! ```text
//! (I + h K) ω' = I ω
//! ```
//!
//! The equation is backward Euler, for all contacts at once, with the ratios `K` of torque and
//! angular velocity ([`resistances`](super::resistances)), which fit the law at ω' after a few
//! passes. For any such ratios the rotational energy decreases, by `h (2 ω'ᵀ K ω' + ...)/2`, as for
//! the impulses of [`resist`](super::resist). On a ground that rotates, ω is relative to it.

use super::resistances::{Resistances, resolution};
use super::shared::{motion_of, visit_contacts};
use crate::friction::{RollingResistance, SlidingFriction};
use crate::ground::SpringDamperGround;
use crate::integrator::matrix3::Matrix3;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, size};
use crate::state::State;

/// Number of passes that fit the ratios to the law. No pass increases the energy.
const PASSES: u32 = 6;

/// Returns the state after the contacts have resisted its rotation for a time (s).
pub(super) fn slowed<R: Real, D: Dynamics<R>>(scene: &D, state: &State<R>, seconds: R) -> State<R> {
    if scene.friction().rolling_resistance(R::ZERO).is_none() {
        return *state;
    }
    let motion = motion_of(scene, state);
    let time_per_size = seconds / size(scene);
    let resolution = resolution::<R>(motion.angular_velocity, scene.gravity(), time_per_size);
    let resistances = resistances(scene, state, resolution);
    if resistances.groups().is_empty() {
        return *state;
    }
    let properties = scene.inertia_properties();
    let ([x, y, z], momentum) =
        properties.inertia_for_solving(&motion.axes, state.angular_momentum);
    let inertia = Matrix3 { x, y, z };
    let before = scene.contact_model().seen(&motion).angular_velocity;
    let mut change = R::Vec3::ZERO;
    for _ in 0..PASSES {
        let ratio = resistances.ratio(before + change).scaled(seconds);
        let next = inertia.plus(&ratio).solve(-ratio.times(before));
        let is_last = next == change;
        change = next;
        if is_last {
            break;
        }
    }
    let slowed = State {
        angular_momentum: properties
            .without_dead_spin(state.rotation(), momentum + inertia.times(change)),
        ..*state
    };
    if change == R::Vec3::ZERO || slowed.not_finite().is_some() {
        *state
    } else {
        slowed
    }
}

/// Resistances of the contacts that touch in a state.
fn resistances<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &State<R>,
    resolution: R,
) -> Resistances<R> {
    let mut sum = Resistances::none(resolution);
    visit_contacts(scene, &motion_of(scene, state), &mut |contact| {
        let (ground, friction) = contact.laws(scene.ground(), scene.friction());
        let normal_force = ground.normal_force(contact.depth, contact.closing_speed);
        if let Some(law) = friction.rolling_resistance_at(contact.position, normal_force) {
            let of_all = RollingResistance {
                rolling: law.rolling * contact.weight,
                spinning: law.spinning * contact.weight,
                ..law
            };
            sum.add(contact.normal, &of_all);
        }
    });
    sum
}
