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
//!
//! # Falls in single precision
//!
//! A loss that is not restored lowers the ceiling of all later steps by a unit, and the body by
//! that unit over its weight. So a fall goes wrong by a fraction of a unit for each step without a
//! hit, and a search must almost always hit. Three rules achieve that without a bias of the motion:
//!
//! - `on_parabola` rounds the path to the grid of the position, not each displacement. `x - way(v)`
//!   with `way(v) = (v - g t/2) t` and `t = g·v/g²` is constant in free fall. Its part on a grid of
//!   `GRID` units survives every rounding below half of that, so no rounding adds to the next. A
//!   body at rest in one step moves with its velocity, however small the displacement of a step is.
//! - `fall` then looks for the energy of the start near that end. The shift along gravity is
//!   rounded at random in each component. The component that is solved for the rest is another one
//!   in each trial.
//! - The velocity only takes some last places of either sign. It never loses more than half of what
//!   the step has added, as a body would otherwise return to a state where it has been, and stay.
//!
//! What remains: if one unit of the position has more energy than one unit of the total, some
//! velocities have no height with the energy of the start. While a step adds less than the missing
//! energy, each such gap costs a unit.

use crate::energy::Energy;
use crate::real::{Quaternion, Real, Vector, is_single};
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
/// Trials for a fall, and the number of them that change the velocity by few last places.
const FALLS: u32 = 48;
const FINE_FALLS: u32 = 24;
/// Largest change of one component of the position that is solved for, in units in the last place.
const SOLVED: f64 = 3.0;
/// Grid of the constant part of the position, and the largest distance from that grid after a step,
/// in units in the last place.
const GRID: f64 = 32.0;
const OFF_GRID: f64 = 8.0;

/// Returns true if energy lost by rounding is restored.
#[inline(always)]
pub(in crate::integrator) fn holds_both_ways<R: Real>() -> bool {
    is_single::<R>()
}

/// Returns the end of a flight without the rounding of its energy.
///
/// Its energy is as close to the energy before, from below, as the last places allow. Returns
/// `None` if no trial lowers it to the energy before.
#[inline(never)]
pub(in crate::integrator) fn rounded<R: Real, D: Dynamics<R>>(
    scene: &D,
    (start, before): (&State<R>, &Energy<R>),
    (end, after): (&State<R>, &Energy<R>),
) -> Option<(State<R>, Energy<R>)> {
    let mut search = Search::new(scene, before, end, after);
    let lever =
        scene.inertia_properties().mass() * scene.gravity().length() * end.position.length();
    let (speed, spin) = (after.translation, after.rotation);
    search.orientation(before.rotation, spin >= speed && spin >= lever);
    // Without gravity the linear velocity is constant, and has no rounding of its own.
    if holds_both_ways::<R>() {
        search.fall(start, speed);
    } else if lever >= speed {
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
    #[inline(never)]
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

    /// Changes the height, or the velocity if that has most of the energy, and last places of both,
    /// until the energy equals that of the start.
    #[inline(never)]
    fn fall(&mut self, start: &State<R>, speed: R) {
        let (gravity, mass) = (self.scene.gravity(), self.scene.inertia_properties().mass());
        let end = self.end;
        let lever = mass * absolute::<R>(gravity).dot(absolute::<R>(end.position));
        let is_within = |size: R| self.excess.abs() <= size * self.units;
        let adjusted = if is_within(lever) {
            Adjusted::Position
        } else {
            Adjusted::Velocity
        };
        let is_rounding = is_within(lever) || is_within(speed);
        if self.is_done() || lever == R::ZERO || !is_rounding {
            return;
        }
        let after = self.after;
        let gain = absolute::<R>(end.linear_velocity - start.linear_velocity);
        let slope = adjusted.slope(gravity, mass, &end);
        let per_square = R::ONE / slope.length_squared();
        let mut seed = seed_of(&end);
        let (mut excess, mut taken) = (self.excess, R::ZERO);
        for trial in 1..=FALLS {
            // The mean of all trials: their scatter is no reason to move the body.
            taken += excess / R::from_usize(trial as usize);
            let shift = slope * -(taken * per_square);
            let state = near((&end, adjusted), shift, (trial, gain), &mut seed);
            excess = self.consider(&state, &self.falling(&state, &after));
            if self.is_done() {
                return;
            }
            let slope = adjusted.slope(gravity, mass, &state);
            if let Some(state) = solved((&state, adjusted), gravity, slope, excess, trial) {
                self.consider(&state, &self.falling(&state, &after));
                if self.is_done() {
                    return;
                }
            }
        }
        self.sink(lever);
    }

    /// Lowers a body that has no other end, by the rounding of its potential energy, doubled until
    /// the energy is no higher. Otherwise its velocity would be reduced in each step: it would
    /// hang.
    fn sink(&mut self, lever: R) {
        let (gravity, end, after) = (self.scene.gravity(), self.end, self.after);
        let per_way = self.scene.inertia_properties().mass() * gravity.length_squared();
        let mut down = gravity * (lever * R::EPSILON / per_way);
        for _ in 0..TRIALS {
            if self.best.is_some() {
                return;
            }
            let state = State {
                position: end.position + down,
                ..end
            };
            self.consider(&state, &self.falling(&state, &after));
            down = down + down;
        }
    }

    /// Returns `energy` with the parts that a fall changes.
    #[inline(never)]
    fn falling(&self, state: &State<R>, energy: &Energy<R>) -> Energy<R> {
        let mass = self.scene.inertia_properties().mass();
        Energy {
            translation: mass * state.linear_velocity.length_squared() * R::HALF,
            gravity: -(mass * self.scene.gravity().dot(state.position)),
            ..*energy
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

/// Vector of the state that is adjusted in a fall, beside last places of both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Adjusted {
    Position,
    Velocity,
}

impl Adjusted {
    /// Derivative of the energy with respect to the vector.
    fn slope<R: Real>(self, gravity: R::Vec3, mass: R, state: &State<R>) -> R::Vec3 {
        match self {
            Self::Position => gravity * -mass,
            Self::Velocity => state.linear_velocity * mass,
        }
    }
}

fn absolute<R: Real>(v: R::Vec3) -> R::Vec3 {
    R::Vec3::new(v.x().abs(), v.y().abs(), v.z().abs())
}

/// Returns a state near `end`, shifted in the position or in the velocity, with a scatter that
/// grows with the number of the trial. `gain` is what the step has added to the velocity.
///
/// The components that gravity does not change stay as they are, unless they are shifted.
fn near<R: Real>(
    (end, adjusted): (&State<R>, Adjusted),
    shift: R::Vec3,
    (trial, gain): (u32, R::Vec3),
    seed: &mut u32,
) -> State<R> {
    let few = R::from_usize(if trial > 1 { 2 } else { 0 });
    let many = R::from_usize(match trial {
        0..=1 => 0,
        2..=FINE_FALLS => 2 + trial / 3,
        _ => 2 + (trial - FINE_FALLS) * 8,
    } as usize);
    let none = R::Vec3::ZERO;
    let (down, slower) = match adjusted {
        Adjusted::Position => (shift, none),
        Adjusted::Velocity => (none, shift),
    };
    State {
        position: scattered::<R>(end.position, down, (few, gain, R::MAX), seed),
        linear_velocity: scattered::<R>(end.linear_velocity, slower, (many, gain, R::ONE), seed),
        ..*end
    }
}

/// Returns `number + shift`, scattered by `units` last places, but by no more than `most` gains.
///
/// A shift is scattered by a last place at least, which rounds it at random.
#[inline(never)]
fn scattered<R: Real>(
    number: R::Vec3,
    shift: R::Vec3,
    (units, gain, most): (R, R::Vec3, R),
    seed: &mut u32,
) -> R::Vec3 {
    let mut one = |x: R, by: R, gain: R| {
        let unit = (x + by).power_of_two() * R::EPSILON;
        let free = (unit * units).at_most(gain * most);
        if by == R::ZERO && free == R::ZERO {
            return x;
        }
        let width = if by == R::ZERO {
            free
        } else {
            free.at_least(unit)
        };
        x + (by + (random::<R>(seed) - R::HALF) * width)
    };
    R::Vec3::new(
        one(number.x(), shift.x(), gain.x()),
        one(number.y(), shift.y(), gain.y()),
        one(number.z(), shift.z(), gain.z()),
    )
}

/// Returns the state with one component solved for the excess, another one for each trial.
///
/// Returns `None` if that component would change by more than rounding.
fn solved<R: Real>(
    (state, adjusted): (&State<R>, Adjusted),
    gravity: R::Vec3,
    slope: R::Vec3,
    excess: R,
    trial: u32,
) -> Option<State<R>> {
    let (zero, one) = (R::ZERO, R::ONE);
    let axes = [
        R::Vec3::new(zero, zero, one),
        R::Vec3::new(one, zero, zero),
        R::Vec3::new(zero, one, zero),
    ];
    let axis = (0..3)
        .map(|next| axes[((trial + next) % 3) as usize])
        .find(|axis| gravity.dot(*axis) != zero)?;
    let (number, units) = match adjusted {
        Adjusted::Position => (state.position, SOLVED),
        Adjusted::Velocity => (state.linear_velocity, UNITS),
    };
    let by = excess / slope.dot(axis);
    let most = number.dot(axis).abs() * (R::EPSILON * R::from_f64(units));
    // False for a NaN, too.
    let is_rounding = by.abs() <= most;
    let number = number - axis * by;
    is_rounding.then_some(match adjusted {
        Adjusted::Position => State {
            position: number,
            ..*state
        },
        Adjusted::Velocity => State {
            linear_velocity: number,
            ..*state
        },
    })
}

/// Returns the end of a flight with the path, not the displacement, rounded to the grid of the
/// position.
///
/// In free fall `x - way(v)` is constant. The component of `x` becomes `c + way(v')`, with the
/// constant `c` on a grid of `GRID` units, so that it is the same `c` in each step. A distance of
/// at most `OFF_GRID` units from that grid remains. Components whose way is longer than half of `x`
/// stay as they are: there, random rounding is as accurate.
pub(in crate::integrator) fn on_parabola<R: Real>(
    start: &State<R>,
    end: State<R>,
    gravity: R::Vec3,
) -> State<R> {
    let per_square = R::ONE / gravity.length_squared();
    let way = |v: R::Vec3| {
        let time = v.dot(gravity) * per_square;
        (v - gravity * (time * R::HALF)) * time
    };
    let (from, to) = (way(start.linear_velocity), way(end.linear_velocity));
    let (old, new) = (start.position, end.position);
    let position = R::Vec3::new(
        on_grid(old.x(), from.x(), to.x()).unwrap_or(new.x()),
        on_grid(old.y(), from.y(), to.y()).unwrap_or(new.y()),
        on_grid(old.z(), from.z(), to.z()).unwrap_or(new.z()),
    );
    State { position, ..end }
}

/// Returns the position `x` after the way from `from` to `to`, or `None` if the ways are too
/// long or the same.
fn on_grid<R: Real>(x: R, from: R, to: R) -> Option<R> {
    let size = x.abs().power_of_two();
    // False for a NaN, too: without gravity there is no way.
    let is_short = from.abs() <= size * R::HALF && to.abs() <= size * R::HALF;
    if !is_short || from == to {
        return None;
    }
    // A sum with 1.5 sizes has the unit of `x`, one with 1.5 grids the grid.
    let (unit, grid) = (size * R::from_f64(1.5), size * R::from_f64(1.5 * GRID));
    let (from, to) = ((from + unit) - unit, (to + unit) - unit);
    let constant = x - from;
    let nearest = (constant + grid) - grid;
    let most = size * (R::EPSILON * R::from_f64(OFF_GRID));
    let off = (constant - nearest).at_most(most).at_least(-most);
    Some((nearest + off) + to)
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
    scattered::<R>(sum, term, (R::ZERO, R::Vec3::ZERO, R::ZERO), seed)
}

/// Returns a pseudo-random number from 0 to 1.
fn random<R: Real>(seed: &mut u32) -> R {
    R::from_usize((scrambled(seed) >> 8) as usize) * R::from_f64(1.0 / 16_777_216.0)
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

#[cfg(test)]
mod tests;
