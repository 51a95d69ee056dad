//! Compensation of the rounding of a step in flight, in the numbers where it arose.
//!
//! The step conserves the energy. The computed energy of its end differs by some units in the last
//! place of its largest term. That error is due to the last place of one number: the orientation,
//! the height, or one of the two velocities. Each of them is changed by some of its own last places
//! until the computed energy equals the energy before the step.
//!
//! A limiter that only removes energy causes a drift of one unit per step. In f64 that is 1e-16 of
//! the energy and negligible. In f32 it is 1e-7, a percent in 1e5 steps. In f32, energy lost by
//! rounding is therefore restored too, but never beyond the energy before the step.

use crate::energy::Energy;
use crate::real::{Quaternion, Real, Vector};
use crate::rotation::Rotation;
use crate::scene::Dynamics;
use crate::state::State;

/// Largest change of a number that counts as rounding, in units in the last place.
const UNITS: f64 = 16.0;
/// Largest such change in contact, where the velocities take the rounding of the springs' energy: 1
/// % in f32.
const UNITS_IN_CONTACT: f64 = 1e5;
/// Trials for the height, and for each velocity.
const TRIALS: u32 = 5;
/// Trials for the orientation, and the number of them that follow the slope of the energy.
const TURNS: u32 = 48;
const SLOPES: u32 = 4;

/// Returns true if energy lost by rounding is restored.
#[inline(always)]
pub(in crate::integrator) fn holds_both_ways<R: Real>() -> bool {
    R::EPSILON > R::from_f64(1e-10)
}

/// Returns the end of a flight without the rounding of its energy.
///
/// Its energy is as close to the energy before, from below, as the last places allow. Returns
/// `None` if no trial lowers it to the energy before.
#[inline(never)]
pub(in crate::integrator) fn rounded<R: Real, D: Dynamics<R>>(
    scene: &D,
    before: &Energy<R>,
    (end, after): (&State<R>, &Energy<R>),
) -> Option<(State<R>, Energy<R>)> {
    let mut search = Search::new(scene, before, end, after);
    let lever =
        scene.inertia_properties().mass() * scene.gravity().length() * end.position.length();
    let (speed, spin) = (after.translation, after.rotation);
    search.orientation(before.rotation, spin >= speed && spin >= lever);
    // Without gravity the linear velocity is constant, and has no rounding of its own.
    if lever >= speed {
        search.height(lever);
        search.speed(speed);
    } else if lever > R::ZERO {
        search.speed(speed);
        search.height(lever);
    }
    search.found().or_else(|| {
        search.spin(spin);
        search.speed(speed);
        search.found()
    })
}

/// Returns the end of a conservative step in contact without its rounding, which both velocities
/// take.
#[inline(never)]
pub(in crate::integrator) fn rounded_in_contact<R: Real, D: Dynamics<R>>(
    scene: &D,
    before: &Energy<R>,
    (end, after): (&State<R>, &Energy<R>),
) -> Option<(State<R>, Energy<R>)> {
    let mut search = Search::new(scene, before, end, after);
    search.units = R::EPSILON * R::from_f64(UNITS_IN_CONTACT);
    search.speed(after.translation);
    search.spin(after.rotation);
    search.found()
}

/// Search for an end of the step with the energy of the start.
struct Search<'a, R: Real, D> {
    scene: &'a D,
    /// Energy of the start, J.
    ceiling: R,
    /// Best end so far, its energy, and the excess of that energy over `ceiling`, J.
    end: State<R>,
    after: Energy<R>,
    excess: R,
    /// Largest relative change of a number's energy that counts as rounding.
    units: R,
    /// Best end so far whose energy is at most `ceiling`.
    best: Option<(State<R>, Energy<R>)>,
}

impl<'a, R: Real, D: Dynamics<R>> Search<'a, R, D> {
    fn new(scene: &'a D, before: &Energy<R>, end: &State<R>, after: &Energy<R>) -> Self {
        let ceiling = before.total();
        let excess = after.total() - ceiling;
        Self {
            scene,
            ceiling,
            end: *end,
            after: *after,
            excess,
            units: R::EPSILON * R::from_f64(UNITS),
            best: (excess <= R::ZERO).then_some((*end, *after)),
        }
    }

    /// Registers a candidate state. Returns the excess of its energy over the ceiling, J.
    fn consider(&mut self, state: &State<R>, energy: &Energy<R>) -> R {
        let total = energy.total();
        let excess = total - self.ceiling;
        let is_better = |(_, best): &(State<R>, Energy<R>)| total > best.total();
        if excess <= R::ZERO && self.best.as_ref().is_none_or(is_better) {
            self.best = Some((*state, *energy));
        }
        if excess.abs() < self.excess.abs() {
            (self.end, self.after, self.excess) = (*state, *energy, excess);
        }
        excess
    }

    /// Returns true if the search may end.
    fn is_done(&self) -> bool {
        self.excess == R::ZERO || (self.best.is_some() && !holds_both_ways::<R>())
    }

    /// Returns the best end with its energy. The trials leave out the springs, because none of them
    /// changes the springs' energy.
    fn found(&self) -> Option<(State<R>, Energy<R>)> {
        let (state, _) = self.best?;
        let energy = Energy::of(self.scene, &state);
        (energy.total() <= self.ceiling).then_some((state, energy))
    }

    /// Changes the orientation until the rotational energy equals that of the start.
    ///
    /// If rotation has most of the energy, the total is compared instead. The search follows the
    /// slope `dE = ϑ · (ω × L)`, and uses single last places if the slope is too flat.
    fn orientation(&mut self, before: R, by_total: bool) {
        let after = self.after;
        let excess_of = |rotation: R, ceiling: R| {
            if by_total {
                Energy { rotation, ..after }.total() - ceiling
            } else {
                rotation - before
            }
        };
        let ceiling = self.ceiling;
        let mut excess = excess_of(after.rotation, ceiling);
        // False for a NaN, too.
        let is_rounding = excess.abs() <= before * (R::EPSILON * R::from_f64(UNITS));
        if excess == R::ZERO || !is_rounding {
            return;
        }
        let (end, momentum) = (self.end, self.end.angular_momentum);
        let properties = self.scene.inertia_properties();
        let rotation = end.rotation();
        let slope = (properties.angular_velocity(&rotation.axes(), momentum)).cross(momentum);
        let per_square = R::ONE / slope.length_squared();
        let few = R::EPSILON * R::from_f64(UNITS);
        let (mut angle, mut nearest) = (R::ZERO, excess);
        for trial in 0..TURNS {
            angle += excess;
            let mut turn = slope * -(angle * per_square);
            let is_small = turn.length_squared() <= few * few;
            if trial >= SLOPES || !is_small {
                turn = last_places::<R>(trial);
            }
            let turned = (Rotation::from_half_vector(turn * R::HALF).after(rotation)).normalised();
            let orientation = turned.to_quat();
            let axes = Rotation::from_quat(orientation).axes();
            let energy = Energy {
                rotation: properties.rotational_energy(&axes, momentum),
                ..after
            };
            excess = excess_of(energy.rotation, ceiling);
            if (excess <= R::ZERO && nearest > R::ZERO) || excess.abs() < nearest.abs() {
                nearest = excess;
                let turned = State { orientation, ..end };
                (self.end, self.after) = (turned, energy);
                self.excess = energy.total() - ceiling;
                self.best = (self.excess <= R::ZERO).then_some((turned, energy));
            }
            if nearest == R::ZERO || (nearest < R::ZERO && !holds_both_ways::<R>()) {
                return;
            }
        }
    }

    /// Moves the body along gravity.
    fn height(&mut self, lever: R) {
        let gravity = self.scene.gravity();
        let mass = self.scene.inertia_properties().mass();
        let per_energy = R::ONE / (mass * gravity.length_squared());
        self.along(lever, |end, after, taken| {
            let position = end.position + gravity * (taken * per_energy);
            let gravity = -(mass * gravity.dot(position));
            (State { position, ..end }, Energy { gravity, ..after })
        });
    }

    /// Scales the linear velocity.
    fn speed(&mut self, size: R) {
        let mass = self.scene.inertia_properties().mass();
        self.along(size, |end, after, taken| {
            let linear_velocity = end.linear_velocity * (R::ONE - taken / (size * R::TWO));
            let translation = mass * linear_velocity.length_squared() * R::HALF;
            let end = State {
                linear_velocity,
                ..end
            };
            let after = Energy {
                translation,
                ..after
            };
            (end, after)
        });
    }

    /// Scales the angular momentum.
    fn spin(&mut self, size: R) {
        let properties = self.scene.inertia_properties();
        let axes = self.end.rotation().axes();
        // Two more units, so that the next step again starts in the middle of the rounding interval
        // of the energy.
        let margin = if self.excess > R::ZERO {
            size * (R::EPSILON * R::TWO)
        } else {
            R::ZERO
        };
        self.along(size, |end, after, taken| {
            let lost = (taken + margin) / (size * R::TWO);
            let angular_momentum = end.angular_momentum * (R::ONE - lost);
            let rotation = properties.rotational_energy(&axes, angular_momentum);
            let end = State {
                angular_momentum,
                ..end
            };
            (end, Energy { rotation, ..after })
        });
    }

    /// Removes the excess from a number whose energy is `size`, J.
    fn along(
        &mut self,
        size: R,
        end_without: impl Fn(State<R>, Energy<R>, R) -> (State<R>, Energy<R>),
    ) {
        let is_rounding = self.excess.abs() <= size * self.units;
        if self.is_done() || !is_rounding {
            return;
        }
        let (end, after) = (self.end, self.after);
        let (mut excess, mut taken, mut factor) = (self.excess, R::ZERO, R::ONE);
        for _ in 0..TRIALS {
            taken += excess * factor;
            let (state, energy) = end_without(end, after, taken);
            let now = self.consider(&state, &energy);
            if self.is_done() {
                return;
            }
            // The change was below the last place of the number, which has not changed.
            factor = if now == excess {
                factor * R::TWO
            } else {
                R::HALF
            };
            excess = now;
        }
    }
}

/// Returns a rotation by some last places, different for each trial.
fn last_places<R: Real>(trial: u32) -> R::Vec3 {
    let unit = |shift: u32| match (trial >> shift) & 3 {
        0 => -R::EPSILON,
        1 => R::EPSILON * R::HALF,
        2 => R::EPSILON,
        _ => -(R::EPSILON * R::HALF),
    };
    R::Vec3::new(unit(0), unit(1), unit(2))
}

/// Returns `sum + term` with stochastic rounding, in single precision.
///
/// The result is rounded up or down with probabilities that make the mean rounding error 0. A step
/// that adds less than some hundred last places is otherwise rounded alike in each step. A body at
/// 10 m/s that falls for 0.1 ms at a time would gain 0.5 % too little or too much. The choice
/// depends on `seed` alone, which is computed from the state: the same state takes the same step.
pub(in crate::integrator) fn advanced<R: Real>(
    sum: R::Vec3,
    term: R::Vec3,
    seed: &mut u32,
) -> R::Vec3 {
    R::Vec3::new(
        added(sum.x(), term.x(), seed),
        added(sum.y(), term.y(), seed),
        added(sum.z(), term.z(), seed),
    )
}

fn added<R: Real>(a: R, b: R, seed: &mut u32) -> R {
    let sum = a + b;
    // Exact error of the sum (Knuth).
    let part = sum - a;
    let error = (a - (sum - part)) + (b - part);
    if error == R::ZERO {
        return sum;
    }
    // Neighbour on the side of the error (Rump et al., SIAM J. Sci. Comput. 31, 2008).
    let step = sum.abs() * (R::EPSILON * R::HALF * (R::ONE + R::EPSILON));
    let neighbour = if error > R::ZERO {
        sum + step
    } else {
        sum - step
    };
    let gap = neighbour - sum;
    let threshold =
        R::from_usize((scrambled(seed) >> 8) as usize) * R::from_f64(1.0 / 16_777_216.0);
    if error.abs() > gap.abs() * threshold {
        neighbour
    } else {
        sum
    }
}

/// Returns the next number of a pseudo-random sequence.
fn scrambled(seed: &mut u32) -> u32 {
    *seed = seed.wrapping_add(0x9e37_79b9);
    let mut mixed = *seed;
    mixed = (mixed ^ (mixed >> 16)).wrapping_mul(0x85eb_ca6b);
    mixed = (mixed ^ (mixed >> 13)).wrapping_mul(0xc2b2_ae35);
    mixed ^ (mixed >> 16)
}

/// Returns a hash of the state. States that differ in a bit have different values.
pub(in crate::integrator) fn seed_of<R: Real>(state: &State<R>) -> u32 {
    let [x, y, z, w] = state.orientation.xyzw();
    let (p, v) = (state.position, state.linear_velocity);
    let mut seed = 0_u32;
    for number in [v.x(), v.y(), v.z(), p.x(), p.y(), p.z(), x, y, z, w] {
        seed ^= number.low_bits();
        seed = seed.wrapping_mul(0x9e37_79b1);
        seed ^= seed >> 15;
    }
    seed
}
