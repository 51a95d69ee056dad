//! Energy limiter: the computed energy after a step never exceeds the energy before it.
//!
//! A step that cannot satisfy this is not taken.

mod equilibrium;

use crate::energy::{Dissipation, Energy};
use crate::ground::SpringDamperGround;
use crate::integrator::flight_rounding::{self, holds_both_ways};
use crate::integrator::interface::Step;
use crate::real::{Quaternion, Real, Vector};
use crate::scene::Dynamics;
use crate::state::State;
use equilibrium::Descent;

/// Units in the last place, of the sum of the absolute values of all energies, that count as its
/// rounding.
const ROUNDING: f64 = 64.0;

/// Summary of the contacts during a step.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrator) struct Touched<R> {
    /// Number of contacts that penetrate at the end of the step.
    pub(in crate::integrator) touching: usize,
    /// True if contacts have pushed during the step, without friction and without dampers.
    pub(in crate::integrator) is_lossless: bool,
    /// Work of a ground that moves, J.
    pub(in crate::integrator) work: R,
}

impl<R: Real> Touched<R> {
    /// Work of the ground, J. For a ground at rest the compiler knows that it is 0.
    #[inline(always)]
    fn work_of_ground<D: Dynamics<R>>(&self, scene: &D) -> R {
        match scene.ground().motion() {
            Some(_) => self.work,
            None => R::ZERO,
        }
    }
}

/// Advances a state and its energy to the end of a step, and limits the computed energy to that of
/// the start, plus the work of a ground that moves.
///
/// The velocities are scaled down until the computed energy is no higher. Returns `false` if the
/// step needs a fallback.
///
/// Only the residual of the solver can increase the energy, so the factor is 1 to rounding. On hard
/// ground the residual of a rare step takes up to a quarter of the energy. [`Step`] reports the
/// energy removed. Special cases:
///
/// - A body in contact is at rest if its kinetic energy, before and after, is below the rounding of
///   the total. It stops where it was. In single precision a body at a turning point has as little;
///   it moves on, a little further downhill.
/// - In flight such a body keeps its old velocity.
/// - If a step is too short to change the height of an unsupported body, the body falls by two
///   units in the last place. Otherwise it would hover.
pub(in crate::integrator) fn hold<R: Real, D: Dynamics<R>>(
    scene: &D,
    (state, energy): (&mut State<R>, &mut Energy<R>),
    (end, after): (&State<R>, &Energy<R>),
    contact: Touched<R>,
    step: &mut Step<R>,
) -> bool {
    let work = contact.work_of_ground(scene);
    let ceiling = energy.total() + work;
    let excess = after.total() - ceiling;
    let is_kept = excess == R::ZERO || (excess < R::ZERO && !holds_both_ways::<R>());
    // The exact step has the energy of the start. Rounding of the penetration depths of hard
    // springs is therefore compensated in both directions, whatever its size. A compensation that
    // only removes energy would remove a part of it in each bounce.
    let is_driven = work != R::ZERO;
    // In flight the potential energy may be rounded more than its sum shows, where gravity is
    // almost perpendicular to the position. The search limits itself to what is rounding.
    let is_flight = contact.touching == 0 && energy.springs == R::ZERO;
    let is_exact = holds_both_ways::<R>() && (contact.is_lossless || is_flight);
    if !is_kept && !is_driven && (is_exact || excess.abs() <= rounding_of(energy, after)) {
        if let Some(rounded) = without_rounding(scene, (state, energy), (end, after), contact) {
            (*state, *energy) = rounded;
            return true;
        }
    }
    if excess <= R::ZERO {
        (*state, *energy) = (*end, *after);
        step.drive_work += work;
        return true;
    }
    hold_down(scene, (state, energy), (end, after), contact, step)
}

/// Returns an end of the step without the rounding of its energy, if nothing else has changed the
/// energy.
fn without_rounding<R: Real, D: Dynamics<R>>(
    scene: &D,
    (start, before): (&State<R>, &Energy<R>),
    (end, after): (&State<R>, &Energy<R>),
    contact: Touched<R>,
) -> Option<(State<R>, Energy<R>)> {
    let both_ways = holds_both_ways::<R>();
    let has_pushed = both_ways && contact.is_lossless;
    if contact.touching == 0 && before.springs == R::ZERO && !has_pushed {
        return flight_rounding::rounded(scene, (start, before), (end, after));
    }
    let is_lossless = |state: &State<R>| Dissipation::of(scene, state).total() == R::ZERO;
    // A body at rest on a ground that dissipates has a start without loss, but not an end.
    (both_ways && is_lossless(end) && is_lossless(start))
        .then(|| flight_rounding::rounded_in_contact(scene, before, (end, after)))
        .flatten()
}

/// Limits an end whose energy exceeds that before the step: lowers it, or leaves the state as it
/// was. Returns `false` if the step needs a fallback.
#[inline(never)]
fn hold_down<R: Real, D: Dynamics<R>>(
    scene: &D,
    (state, energy): (&mut State<R>, &mut Energy<R>),
    (end, after): (&State<R>, &Energy<R>),
    contact: Touched<R>,
    step: &mut Step<R>,
) -> bool {
    let (touching, work) = (contact.touching, contact.work_of_ground(scene));
    let ceiling = energy.total() + work;
    let excess = after.total() - ceiling;
    if !excess.is_finite() || is_no_solution([energy, after], work) {
        return false;
    }
    let rounding = rounding_of(energy, after);
    let is_slow = energy.kinetic() <= rounding;
    let fallen = (touching == 0 || is_slow)
        .then(|| fallen(scene, [state, end], touching))
        .flatten();
    if let Some(fallen) = fallen.filter(|(_, energy)| energy.total() <= ceiling) {
        (*state, *energy) = fallen;
        step.drive_work += work;
        return true;
    }
    if let Some(held) = scaled_down(scene, ceiling, excess, end, *after) {
        step.energy_removed += excess;
        step.drive_work += work;
        (*state, *energy) = held;
        return true;
    }
    // In contact and not slow: a turning point of the motion. A shorter step will not end there.
    if excess > rounding || (touching > 0 && !is_slow) {
        return false;
    }
    let other = if touching > 0 {
        turned(scene, ceiling, (end, after)).or_else(|| Some(stopped((state, energy))))
    } else {
        without_gain(state, end)
            .map(|state| (state, Energy::of(scene, &state)))
            .into_iter()
            .find(|(_, energy)| energy.total() <= ceiling)
    };
    if let Some(other) = other.filter(|(_, energy)| energy.total() <= ceiling) {
        step.drive_work += work;
        (*state, *energy) = other;
    }
    true
}

/// Returns the end of a step at a turning point in contact, a little further downhill, where its
/// energy is at most `ceiling` (J).
///
/// In double precision no step of a useful length gains less energy than its rounding there.
fn turned<R: Real, D: Dynamics<R>>(
    scene: &D,
    ceiling: R,
    (end, after): (&State<R>, &Energy<R>),
) -> Option<(State<R>, Energy<R>)> {
    descent(scene, end, rounding_of(after, after))
        .and_then(|descent| descent.lowered(scene, ceiling, (end, after)))
}

/// Returns how a slow body in contact leaves its pose, or `None` if it stays.
fn descent<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &State<R>,
    rounding: R,
) -> Option<Descent<R>> {
    (holds_both_ways::<R>())
        .then(|| Descent::of(scene, state, rounding))
        .flatten()
}

/// Returns true if the end of a step has gained more than a quarter of the energy that the step can
/// convert, with the work of a ground that moves (J).
///
/// The tolerance of the solver leaves 1e-5 of it, except on hard ground, where the springs multiply
/// an error of the path by `(h ω)²`. A larger gain shows that the iteration has
/// ended at no solution. The path to that end is as wrong as its velocities, and the correction of
/// these alone would leave the body where it cannot be. It happens where friction or dampers exceed
/// the inertia by more than the precision.
pub(in crate::integrator) fn is_no_solution<R: Real>(
    [before, after]: [&Energy<R>; 2],
    work: R,
) -> bool {
    let gained = after.total() - before.total() - work;
    let fallen = (before.gravity - after.gravity).abs();
    let convertible = before.kinetic() + before.springs + fallen + work.abs();
    gained > convertible * (R::HALF * R::HALF) + rounding_of(before, after)
}

/// Returns ends of a step in flight that gain no energy beyond rounding.
///
/// The body keeps the old velocity. At the top of its path it keeps the old position and takes the
/// new velocity.
fn without_gain<R: Real>(start: &State<R>, end: &State<R>) -> [State<R>; 2] {
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

/// Returns the end of a step, lowered by two units in the last place of the height.
///
/// The function applies to a body without support that the step has lowered by a unit in the last
/// place at most. It takes at least one unit from the computed gravitational energy, which exceeds
/// the kinetic energy gained.
fn fallen<R: Real, D: Dynamics<R>>(
    scene: &D,
    [start, end]: [&State<R>; 2],
    touching: usize,
) -> Option<(State<R>, Energy<R>)> {
    let gravity = scene.gravity();
    let square = gravity.length_squared();
    let lever = gravity.dot(end.position).abs();
    let fall = gravity.dot(end.position - start.position);
    // The energy does not show a fall by a last place.
    let is_hidden = fall >= R::ZERO && fall <= lever * R::EPSILON;
    if !is_hidden || square == R::ZERO || (touching > 0 && is_supported(scene, start)) {
        return None;
    }
    // Height divided by |g|, for a displacement along g.
    let height = lever / square;
    let fallen = State {
        position: end.position + gravity * (height * (R::EPSILON * R::TWO)),
        ..*end
    };
    Some((fallen, Energy::of(scene, &fallen)))
}

/// Returns true if the contacts support at least half of the body's weight.
// Called rarely and in two places: a single, non-vectorised loop over the contacts is enough.
#[inline(never)]
fn is_supported<R: Real, D: Dynamics<R>>(scene: &D, state: &State<R>) -> bool {
    let gravity = scene.gravity();
    let mut lift = R::ZERO;
    scene.visit_contacts(&scene.motion(state), |contact| {
        lift -= contact.force(scene.ground(), scene.friction()).dot(gravity);
    });
    let weight = gravity.length_squared() * scene.inertia_properties().mass();
    lift >= weight * R::HALF
}

/// Returns the end with its velocities scaled down, or with zero velocities, if its energy is then
/// at most `ceiling`.
pub(in crate::integrator) fn lowered<R: Real, D: Dynamics<R>>(
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
        let (end, energy) = stopped((end, &after));
        (energy.total() <= ceiling).then_some((end, energy))
    })
}

/// Returns the end with its velocities scaled down until the computed energy is at most `ceiling`.
///
/// The energy removed is the smallest doubling of `excess` that suffices.
pub(in crate::integrator) fn scaled_down<R: Real, D: Dynamics<R>>(
    scene: &D,
    ceiling: R,
    excess: R,
    end: &State<R>,
    after: Energy<R>,
) -> Option<(State<R>, Energy<R>)> {
    let mut share = excess;
    loop {
        let kinetic = after.kinetic();
        if !share.is_finite() || share >= kinetic {
            return None;
        }
        let slowed = slower(end, (R::ONE - share / kinetic).sqrt());
        // The springs depend on the pose alone.
        let energy = Energy {
            springs: after.springs,
            ..Energy::without_springs(scene, &slowed)
        };
        if energy.total() <= ceiling {
            return Some((slowed, energy));
        }
        share *= R::TWO;
    }
}

/// Returns true if a step shows that a body in contact is at rest.
///
/// Five conditions hold for rest:
/// - The body moves by less than the resolution of its numbers.
/// - Its kinetic energy is below the rounding of the total energy.
/// - Its velocity decays, or is what rounding leaves of balanced forces.
/// - The contacts support it.
/// - In single precision: it is at no turning point of its motion ([`equilibrium`]).
///
/// If a force sets a body in motion, the body gains more velocity than that in any step, however
/// short.
pub(in crate::integrator) fn has_come_to_rest<R: Real, D: Dynamics<R>>(
    scene: &D,
    [start, end]: [&State<R>; 2],
    [before, after]: [&Energy<R>; 2],
    seconds: R,
) -> bool {
    // A ground that moves would set the body in motion.
    if scene.ground().motion().is_some() {
        return false;
    }
    let (first, last) = (before.kinetic(), after.kinetic());
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
    // Springs that support the weight W with the energy V have the stiffness W²/(2 V). A
    // penetration depth is rounded to some units in the last place of the numbers that it is
    // computed from. For springs that do not support the weight, this estimate has no meaning.
    let mass = scene.inertia_properties().mass();
    let weight = mass * scene.gravity().length();
    let depth = scene.ground().surface(start.position).gap.abs() + bounding_radius;
    let stiffness = weight * weight * R::HALF / before.springs;
    let impulse = seconds * (stiffness * depth + weight) * (R::EPSILON * R::from_f64(8.0));
    let balanced = end.linear_velocity.length() * mass <= impulse
        && end.angular_momentum.length() <= impulse * bounding_radius;
    let is_dying_out = last <= first && first > R::ZERO;
    // The limiter has stopped a body that does not move, and found no descent.
    let moves = end.linear_velocity != R::Vec3::ZERO || end.angular_momentum != R::Vec3::ZERO;
    let leaves = || moves && descent(scene, end, rounding_of(before, after)).is_some();
    (is_dying_out || balanced) && is_supported(scene, end) && !leaves()
}

/// Returns the rounding error of the sum of the terms of two energies, J.
pub(in crate::integrator) fn rounding_of<R: Real>(before: &Energy<R>, after: &Energy<R>) -> R {
    let terms = after.translation
        + after.rotation
        + after.gravity.abs()
        + after.springs.abs()
        + before.gravity.abs()
        + before.springs.abs();
    terms * (R::EPSILON * R::from_f64(ROUNDING))
}

/// Returns the same pose without motion, and its energy.
pub(in crate::integrator) fn stopped<R: Real>(
    (state, energy): (&State<R>, &Energy<R>),
) -> (State<R>, Energy<R>) {
    let state = State {
        linear_velocity: R::Vec3::ZERO,
        angular_momentum: R::Vec3::ZERO,
        ..*state
    };
    let energy = Energy {
        translation: R::ZERO,
        rotation: R::ZERO,
        ..*energy
    };
    (state, energy)
}

/// Returns the same pose with both velocities scaled.
fn slower<R: Real>(state: &State<R>, factor: R) -> State<R> {
    State {
        linear_velocity: state.linear_velocity * factor,
        angular_momentum: state.angular_momentum * factor,
        ..*state
    }
}

#[cfg(test)]
mod tests;
