//! Amplification of a linear motion by the steps of a method.

use super::eigenvalues::{each_eigenvalue, length};
use super::modes::{Modes, RESOLVED};
use super::motion::{LinearMotion, SIZE, ahead, columns};
use crate::quadrature::bisect;

/// Growth of a motion that counts as none, per rad.
const TOLERANCE: f64 = 1e-9;
/// Rounding of the magnitude of an eigenvalue.
const ROUNDING: f64 = 1e-11;
/// Distance of the step sizes that are tried, relative to the limit of the modes. The eighth is
/// just beyond that limit: a method may be stable again a little farther.
const PART: f64 = 1.001 / 8.0;
/// Longest step that is tried, relative to the limit of the modes.
const FARTHEST: f64 = 4.0;
/// Halvings between the last step size that is stable and the first that is not.
const HALVINGS: u32 = 20;

/// Amplification of a motion by the steps of a method, which takes a step of the given size from
/// coordinates and velocities.
pub(super) struct Amplification<'a, S> {
    motion: &'a LinearMotion,
    modes: &'a Modes,
    step: S,
}

impl<'a, S: Fn([[f64; 6]; 2], f64) -> [[f64; 6]; 2]> Amplification<'a, S> {
    pub(super) fn new(motion: &'a LinearMotion, modes: &'a Modes, step: S) -> Self {
        Self {
            motion,
            modes,
            step,
        }
    }

    /// Returns the largest step size up to which no step amplifies the motion, in its unit of time.
    pub(super) fn largest_step(&self) -> f64 {
        let found = self.first_growth();
        let is_amplified = |rate: f64| {
            let near_exact = |change: f64| (0.6..0.95).contains(&change);
            self.grows(RESOLVED / rate, near_exact)
        };
        // Rounding hides the growth of resolved modes.
        (self.modes.resolved())
            .filter(|[limit, rate]| *limit < found && is_amplified(*rate))
            .fold(found, |least, [limit, _]| least.min(*limit))
    }

    /// Returns the step size at which an eigenvalue first exceeds 1 by more than rounding. The
    /// search begins below the scale of the modes.
    fn first_growth(&self) -> f64 {
        let grows = |size: f64| self.grows(size, |_| true);
        let part = self.modes.scale * PART;
        let mut end = part;
        while !grows(end) {
            if end >= self.modes.scale * FARTHEST {
                return end;
            }
            end += part;
        }
        let [stable, _] = bisect([end - part, end], HALVINGS, grows);
        stable
    }

    /// Returns true if a step amplifies a motion by more than twice the rate at which one grows by
    /// itself. Motions are told by their relative change in the step.
    ///
    /// The free motions are those that a step changes least. They are left out: rounding hides
    /// whether they grow.
    fn grows(&self, size: f64, counts: impl Fn(f64) -> bool) -> bool {
        let own_growth = 1.0 + 2.0 * self.modes.growth * size;
        let tolerance = TOLERANCE.max(self.motion.rounding);
        let mut changes = [[0.0; 2]; SIZE];
        let mut places = changes.iter_mut();
        let change = columns(|start| difference(&(self.step)(start, size), &start));
        each_eigenvalue(change, |[re, im]| {
            let factor = length(&[1.0 + re, im]);
            let pair = if im > 0.0 { 2 } else { 1 };
            for place in places.by_ref().take(pair) {
                *place = [length(&[re, im]), factor];
            }
        });
        changes.sort_unstable_by(|[a, _], [b, _]| a.total_cmp(b));
        (changes.iter().skip(self.modes.free)).any(|&[change, factor]| {
            counts(change) && factor > own_growth * (1.0 + tolerance * change + ROUNDING)
        })
    }
}

fn difference(end: &[[f64; 6]; 2], start: &[[f64; 6]; 2]) -> [[f64; 6]; 2] {
    let [[y, v], [start_y, start_v]] = [end, start];
    [ahead(y, start_y, -1.0), ahead(v, start_v, -1.0)]
}

#[cfg(test)]
mod tests {
    use super::super::matrix::Matrix;
    use super::super::response::Response;
    use super::*;
    use crate::{Integrator, Nystrom, StrangSplitting, SymplecticEuler};
    use proptest::prelude::*;

    /// Ratio of the largest step for one oscillator along a direction of all six coordinates, with
    /// five free motions, to the limit that the method states.
    fn ratio_to_own_limit(
        method: &impl Integrator,
        [stiffness, damping]: [f64; 2],
        direction: &[f64; 6],
    ) -> f64 {
        let square: f64 = direction.iter().map(|x| x * x).sum();
        let along = |rate: f64| {
            Matrix(direction.map(|row| direction.map(|column| rate * row * column / square)))
        };
        let motion = LinearMotion::of(&Response {
            stiffness: along(stiffness),
            damping: along(damping),
        })
        .unwrap();
        let limit = |stiffness: f64, damping: f64| method.largest_stable_step(stiffness, damping);
        let modes = Modes::of(&motion, &limit);
        let amplification = Amplification::new(&motion, &modes, |start, size| {
            method.linear_step(&motion, start, size).unwrap()
        });
        let found: f64 = motion.seconds(amplification.largest_step()).unwrap();
        found / limit(stiffness, damping).unwrap()
    }

    proptest! {
        /// Hardly damped to overdamped. Below a damping ratio of 7e-5 the limit of `Nystrom` is
        /// that at which it amplifies the oscillation by as little.
        #[test]
        fn the_largest_step_of_one_oscillator_is_that_of_the_method(
            direction in prop::array::uniform6(-1.0..1.0_f64),
            exponent in -9.0..1.0_f64,
            frequency in 1.0..1e4_f64,
        ) {
            let ratio = 10.0_f64.powf(exponent);
            prop_assume!(direction.iter().any(|x| x.abs() > 0.1));
            let rates = [frequency * frequency, 2.0 * ratio * frequency];
            let time_step = 1.0;
            let ratios = [
                ratio_to_own_limit(&SymplecticEuler { time_step }, rates, &direction),
                ratio_to_own_limit(&StrangSplitting { time_step }, rates, &direction),
                ratio_to_own_limit(&Nystrom { time_step }, rates, &direction),
            ];
            for ratio in ratios {
                prop_assert!((ratio - 1.0).abs() < 1e-5, "{ratios:?}");
            }
        }
    }
}
