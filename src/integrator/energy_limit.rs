//! The last word on a step: the computed energy is not above the one before, or the step does not
//! happen.

use super::{Step, flight_rounding};
use crate::energy::{Dissipation, Energy};
use crate::ground::SpringDamperGround;
use crate::real::{Quaternion, Real, Vector};
use crate::scene::Dynamics;
use crate::state::State;

/// Units in the last place of the sum of all energies' sizes that count as its rounding.
const ROUNDING: f64 = 64.0;

/// What the contacts have done in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touched {
    /// Number of contacts that touch at the end of the step.
    pub(super) touching: usize,
    /// Contacts have pushed in the step, without friction and without dampers.
    pub(super) is_lossless: bool,
}

/// Moves a state with its energy on to the end of a step, with its velocities scaled down until its
/// computed energy is no higher; `false` where that cannot be had.
///
/// The solver's residual is all that can lift the energy, so that the factor is 1 to rounding; what
/// was removed is in the step's report. A body in contact that has less kinetic energy than the
/// rounding of the total, before and after, has come to rest, and stops where it was; in flight it
/// keeps its old velocity. One that falls by less than its place's rounding falls by that: else it
/// would hang for ever.
pub(super) fn hold<R: Real, D: Dynamics<R>>(
    scene: &D,
    (state, energy): (&mut State<R>, &mut Energy<R>),
    (end, after): (&State<R>, &Energy<R>),
    contact: Touched,
    step: &mut Step<R>,
) -> bool {
    let ceiling = energy.total();
    let excess = after.total() - ceiling;
    let is_kept =
        excess == R::ZERO || (excess < R::ZERO && !flight_rounding::holds_both_ways::<R>());
    // The exact step has the energy of the start: rounding of depths of hard springs is put back
    // whatever its size. What only took it would take a part of it in each bounce.
    let is_exact = flight_rounding::holds_both_ways::<R>() && contact.is_lossless;
    if !is_kept && (is_exact || excess.abs() <= rounding_of(energy, after)) {
        if let Some(rounded) = without_rounding(scene, (state, energy), (end, after), contact) {
            (*state, *energy) = rounded;
            return true;
        }
    }
    if excess <= R::ZERO {
        (*state, *energy) = (*end, *after);
        return true;
    }
    hold_down(scene, (state, energy), (end, after), contact.touching, step)
}

/// An end without the rounding of its energy, where nothing else has changed the energy of the
/// step.
fn without_rounding<R: Real, D: Dynamics<R>>(
    scene: &D,
    (start, before): (&State<R>, &Energy<R>),
    (end, after): (&State<R>, &Energy<R>),
    contact: Touched,
) -> Option<(State<R>, Energy<R>)> {
    let both_ways = flight_rounding::holds_both_ways::<R>();
    let has_pushed = both_ways && contact.is_lossless;
    if contact.touching == 0 && before.springs == R::ZERO && !has_pushed {
        return flight_rounding::rounded(scene, before, (end, after));
    }
    let is_conservative =
        || [start, end].map(|state| Dissipation::of(scene, state).total()) == [R::ZERO; 2];
    (both_ways && is_conservative())
        .then(|| flight_rounding::rounded_in_contact(scene, before, (end, after)))
        .flatten()
}

/// The same for an end whose energy is above the one before.
#[inline(never)]
fn hold_down<R: Real, D: Dynamics<R>>(
    scene: &D,
    (state, energy): (&mut State<R>, &mut Energy<R>),
    (end, after): (&State<R>, &Energy<R>),
    touching: usize,
    step: &mut Step<R>,
) -> bool {
    let ceiling = energy.total();
    let excess = after.total() - ceiling;
    if !excess.is_finite() {
        return false;
    }
    let rounding = rounding_of(energy, after);
    let is_slow = energy.translation + energy.rotation <= rounding;
    let fallen = (touching == 0 || is_slow)
        .then(|| fallen(scene, [state, end], touching))
        .flatten();
    if let Some(fallen) = fallen.filter(|(_, energy)| energy.total() <= ceiling) {
        (*state, *energy) = fallen;
        return true;
    }
    if let Some(held) = scaled_down(scene, ceiling, excess, end, *after) {
        step.energy_removed += excess;
        (*state, *energy) = held;
        return true;
    }
    // In contact and not slow: a turning point. A shorter step will not end on it.
    if excess > rounding || (touching > 0 && !is_slow) {
        return false;
    }
    for other in without_gain(state, end, touching) {
        let other_energy = Energy::of(scene, &other);
        if other_energy.total() <= ceiling {
            (*state, *energy) = (other, other_energy);
            break;
        }
    }
    true
}

/// Where a step may end that would gain no more than rounding: stopped in contact; in flight with
/// the old velocity, or, at the top of its path, turned round where it is.
fn without_gain<R: Real>(start: &State<R>, end: &State<R>, touching: usize) -> [State<R>; 2] {
    if touching > 0 {
        return [stopped(start); 2];
    }
    let coasting = State {
        linear_velocity: start.linear_velocity,
        angular_momentum: start.angular_momentum,
        ..*end
    };
    let turning = State {
        position: start.position,
        ..*end
    };
    [coasting, turning]
}

/// Of a step from start to end that has not changed the height of a body which nothing bears: its
/// end, lower by two units in the last place of the height. That takes one unit or more from the
/// computed energy of gravity; what the body has gained of speed is worth less.
fn fallen<R: Real, D: Dynamics<R>>(
    scene: &D,
    [start, end]: [&State<R>; 2],
    touching: usize,
) -> Option<(State<R>, Energy<R>)> {
    let gravity = scene.gravity();
    let square = gravity.length_squared();
    let is_held = gravity.dot(end.position - start.position) == R::ZERO && square > R::ZERO;
    if !is_held || (touching > 0 && is_borne(scene, start)) {
        return None;
    }
    // The height over |g|, for a way along g.
    let height = gravity.dot(end.position).abs() / square;
    let fallen = State {
        position: end.position + gravity * (height * (R::EPSILON * R::TWO)),
        ..*end
    };
    Some((fallen, Energy::of(scene, &fallen)))
}

/// Whether the contacts bear at least half of the body's weight.
// Asked seldom and in two places: one loop over contacts is enough, and none of its parts need go
// abreast.
#[inline(never)]
fn is_borne<R: Real, D: Dynamics<R>>(scene: &D, state: &State<R>) -> bool {
    let gravity = scene.gravity();
    let mut lift = R::ZERO;
    scene.visit_contacts(&scene.motion(state), |contact| {
        lift -= contact.force(scene.ground(), scene.friction()).dot(gravity);
    });
    let weight = gravity.length_squared() * scene.inertia_properties().mass();
    lift >= weight * R::HALF
}

/// The end with its velocities scaled down, or without any, if its energy is then at most the
/// ceiling.
pub(super) fn lowered<R: Real, D: Dynamics<R>>(
    scene: &D,
    ceiling: R,
    end: &State<R>,
    after: Energy<R>,
) -> Option<(State<R>, Energy<R>)> {
    let excess = after.total() - ceiling;
    if excess <= R::ZERO {
        return Some((*end, after));
    }
    if !excess.is_finite() {
        return None;
    }
    scaled_down(scene, ceiling, excess, end, after).or_else(|| {
        let end = stopped(end);
        let energy = Energy::of(scene, &end);
        (energy.total() <= ceiling).then_some((end, energy))
    })
}

/// The end with its velocities scaled, by the smallest doubling of the excess that brings the
/// computed energy to the ceiling.
pub(super) fn scaled_down<R: Real, D: Dynamics<R>>(
    scene: &D,
    ceiling: R,
    excess: R,
    end: &State<R>,
    after: Energy<R>,
) -> Option<(State<R>, Energy<R>)> {
    let mut share = excess;
    loop {
        let kinetic = after.translation + after.rotation;
        if !share.is_finite() || share >= kinetic {
            return None;
        }
        let slowed = slower(end, (R::ONE - share / kinetic).sqrt());
        let energy = Energy::of(scene, &slowed);
        if energy.total() <= ceiling {
            return Some((slowed, energy));
        }
        share *= R::TWO;
    }
}

/// Whether a step has shown a body in contact to be at rest: it moves by less than numbers can
/// hold, with less kinetic energy than the rounding of the total, and what velocity it has is dying
/// out or is what rounding leaves of balanced forces; and that its contacts bear it. A body that a
/// force sets going gains more velocity than that, however short the step.
pub(super) fn has_come_to_rest<R: Real, D: Dynamics<R>>(
    scene: &D,
    [start, end]: [&State<R>; 2],
    [before, after]: [&Energy<R>; 2],
    seconds: R,
) -> bool {
    let kinetic = |energy: &Energy<R>| energy.translation + energy.rotation;
    let (first, last) = (kinetic(before), kinetic(after));
    let bounding_radius = scene.bounding_radius();
    let stays = |from: R, to: R| (to - from).abs() <= (from.abs() + bounding_radius) * R::EPSILON;
    let (p, q) = (start.position, end.position);
    if !(stays(p.x(), q.x()) && stays(p.y(), q.y()) && stays(p.z(), q.z())) {
        return false;
    }
    if first.at_least(last) > rounding_of(before, after) {
        return false;
    }
    let turned = start
        .orientation
        .xyzw()
        .into_iter()
        .zip(end.orientation.xyzw());
    if turned.into_iter().any(|(a, b)| (a - b).abs() > R::EPSILON) {
        return false;
    }
    // Springs that bear the weight W with the energy V have the stiffness W²/(2 V); a depth is
    // rounded to some last places of the numbers that make it. Of springs that do not, that says
    // nothing.
    let mass = scene.inertia_properties().mass();
    let weight = mass * scene.gravity().length();
    let depth = scene.ground().surface(start.position).gap.abs() + bounding_radius;
    let stiffness = weight * weight * R::HALF / before.springs;
    let impulse = seconds * (stiffness * depth + weight) * (R::EPSILON * R::from_f64(8.0));
    let balanced = end.linear_velocity.length() * mass <= impulse
        && end.angular_momentum.length() <= impulse * bounding_radius;
    let is_dying_out = last <= first && first > R::ZERO;
    (is_dying_out || balanced) && is_borne(scene, end)
}

/// The rounding of the sum of two energies' terms, J.
pub(super) fn rounding_of<R: Real>(before: &Energy<R>, after: &Energy<R>) -> R {
    let terms = after.translation
        + after.rotation
        + after.gravity.abs()
        + after.springs.abs()
        + before.gravity.abs()
        + before.springs.abs();
    terms * (R::EPSILON * R::from_f64(ROUNDING))
}

/// The same place without motion.
pub(super) fn stopped<R: Real>(state: &State<R>) -> State<R> {
    State {
        linear_velocity: R::Vec3::ZERO,
        angular_momentum: R::Vec3::ZERO,
        ..*state
    }
}

/// The same place with both velocities scaled.
fn slower<R: Real>(state: &State<R>, factor: R) -> State<R> {
    State {
        linear_velocity: state.linear_velocity * factor,
        angular_momentum: state.angular_momentum * factor,
        ..*state
    }
}
