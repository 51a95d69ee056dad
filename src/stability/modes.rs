//! Modes of a linear motion, as oscillators of one coordinate.
//!
//! An eigenvalue λ of the motion is a solution `e^(λ t) x`. A pair of complex eigenvalues has the
//! rates of the oscillator `y'' + δ y' + κ y = 0` with `κ = |λ|²` and `δ = -2 Re λ`. A real
//! eigenvalue -δ is that of `y'' + δ y' = 0`.

use super::eigenvalues::{each_eigenvalue, length};
use super::motion::{LinearMotion, SIZE};
use crate::real::Real;

/// Frequency below which a mode may be rounding of one without a frequency, in the unit of
/// frequency.
const SLOWEST: f64 = 1e-3;
/// Growth of a mode, relative to its rate, up to which it counts as an oscillation without damping.
const FLUTTER: f64 = 0.1;
/// Frequency below which a mode is taken for a free motion, in the unit of frequency and in f64. A
/// chain of four derivatives with rounding has `ε^(1/4)`, 1.2e-4.
const FREE: f64 = 2e-4;
/// Angle by which a mode turns in a step that resolves it, rad.
///
/// [`Nystrom`](crate::Nystrom) amplifies an oscillation on springs by less than 1e-4 per rad there.
pub(super) const RESOLVED: f64 = 0.8;

/// What the modes of a motion say of the step of a method.
pub(super) struct Modes {
    /// Smallest limit of a mode, in the unit of time. Infinite if no mode has one.
    pub(super) limit: f64,
    /// Smallest step size that a mode does not allow or does not resolve, in the unit of time.
    pub(super) scale: f64,
    /// Limit and rate of the modes that are resolved up to their limit: what bounds their step is
    /// weak amplification.
    resolved: [[f64; 2]; SIZE],
    resolved_count: usize,
    /// Largest rate at which a mode grows by itself, in the unit of frequency.
    pub(super) growth: f64,
    /// Number of eigenvalues that may be rounding of 0.
    pub(super) free: usize,
}

impl Modes {
    /// Looks at the modes that are not slow and that grow by little. A damping that is rounding
    /// counts as none.
    pub(super) fn of<R: Real>(motion: &LinearMotion, limit: &impl Fn(R, R) -> Option<R>) -> Self {
        let mut modes = Self {
            limit: f64::INFINITY,
            scale: f64::INFINITY,
            resolved: [[0.0; 2]; SIZE],
            resolved_count: 0,
            growth: 0.0,
            free: 0,
        };
        each_eigenvalue(motion.rates(), |[re, im]| {
            let rate = length(&[re, im]);
            if rate < FREE.max(8.0 * motion.rounding) {
                modes.free += if im > 0.0 { 2 } else { 1 };
                return;
            }
            if re > 0.5 * motion.rounding {
                modes.growth = modes.growth.max(re);
            }
            if rate < SLOWEST || re > FLUTTER * rate {
                return;
            }
            let [stiffness, damping] = if im > 0.0 {
                [rate * rate, -2.0 * re]
            } else {
                [0.0, -re]
            };
            let damping = if damping > motion.rounding {
                damping
            } else {
                0.0
            };
            let limit = motion.limit_of([stiffness, damping], limit);
            if re > 0.5 * motion.rounding && limit == 0.0 {
                // Only damping makes a step of the method stable, and the motion has none.
                modes.scale = modes.scale.min(RESOLVED / rate);
                return;
            }
            modes.see(rate, limit);
        });
        modes
    }

    /// Limit and rate of the modes that are resolved up to their limit.
    pub(super) fn resolved(&self) -> impl Iterator<Item = &[f64; 2]> {
        self.resolved.iter().take(self.resolved_count)
    }

    fn see(&mut self, rate: f64, limit: f64) {
        self.limit = self.limit.min(limit);
        if limit * rate >= RESOLVED {
            self.scale = self.scale.min(limit);
            return;
        }
        self.scale = self.scale.min(RESOLVED / rate);
        if let Some(place) = self.resolved.get_mut(self.resolved_count) {
            *place = [limit, rate];
            self.resolved_count += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::matrix::Matrix;
    use super::super::response::Response;
    use super::*;
    use alloc::vec::Vec;
    use approx::assert_relative_eq;
    use core::cell::RefCell;
    use proptest::prelude::*;

    fn modes(stiffness: &[[f64; 6]; 6], damping: &[[f64; 6]; 6]) -> Vec<[f64; 2]> {
        let response = Response {
            stiffness: Matrix(*stiffness),
            damping: Matrix(*damping),
        };
        let found = RefCell::new(Vec::new());
        if let Some(motion) = LinearMotion::of(&response) {
            Modes::of(&motion, &|stiffness: f64, damping| {
                found.borrow_mut().push([stiffness, damping]);
                None
            });
        }
        let mut found = found.into_inner();
        found.sort_by(|a, b| a.partial_cmp(b).unwrap());
        found
    }

    fn diagonal(values: [f64; 6]) -> [[f64; 6]; 6] {
        let mut rows = [[0.0; 6]; 6];
        for (i, value) in values.into_iter().enumerate() {
            rows[i][i] = value;
        }
        rows
    }

    /// `S⁻¹ D S` for the product S of shears: row i plus `shears[i]` times the next row.
    fn sheared(mut rows: [[f64; 6]; 6], shears: &[f64; 6]) -> [[f64; 6]; 6] {
        for (i, shear) in shears.iter().enumerate() {
            let next = (i + 1) % 6;
            let other = rows[next];
            (rows[i].iter_mut().zip(other)).for_each(|(value, other)| *value += shear * other);
            for row in &mut rows {
                row[next] -= shear * row[i];
            }
        }
        rows
    }

    proptest! {
        /// Six oscillators, weakly to strongly damped, in any coordinates.
        #[test]
        fn the_modes_are_the_oscillators_of_which_the_motion_was_composed(
            stiffness in prop::array::uniform6(1.0..10.0_f64),
            ratios in prop::array::uniform6(1e-4..1.5_f64),
            shears in prop::array::uniform6(-1.0..1.0_f64),
        ) {
            let damping: [f64; 6] =
                core::array::from_fn(|i| 2.0 * ratios[i] * stiffness[i].sqrt());
            let expected = modes(&diagonal(stiffness), &diagonal(damping));
            let [k, c] = [stiffness, damping].map(|values| sheared(diagonal(values), &shears));
            let found = modes(&k, &c);
            // A critically damped mode has a double eigenvalue, which rounding splits by its root.
            prop_assume!(ratios.iter().all(|ratio| (ratio - 1.0).abs() > 1e-3));
            prop_assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
                let off = (found - expected).abs();
                prop_assert!(off < 1e-8 * (1.0 + expected), "{found}, not {expected}");
            }
        }
    }

    /// The stiffness has the pair `1 ± i e` of eigenvalues, so `λ² = -(1 ± i e)`: one mode decays
    /// and one grows, which is left out.
    #[test]
    fn a_pair_of_complex_stiffnesses_is_a_mode_that_decays_and_one_that_grows() {
        let e = 0.5;
        let mut stiffness = diagonal([1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
        stiffness[0][1] = -e;
        stiffness[1][0] = e;
        // λ = a + i b with a² - b² = -1, 2 a b = e, and κ = a² + b², δ = -2 a.
        let square = (1.0 + e * e).sqrt();
        let rate = ((square - 1.0) / 2.0).sqrt();
        let found = modes(&stiffness, &[[0.0; 6]; 6]);
        assert_eq!(found.len(), 1);
        assert_relative_eq!(found[0][0], square, max_relative = 1e-13);
        assert_relative_eq!(found[0][1], 2.0 * rate, max_relative = 1e-12);
    }

    /// Free motion, a force that a rotation alone causes, and no number at all.
    #[test]
    fn motions_without_a_rate_have_no_mode() {
        let zero = [[0.0; 6]; 6];
        assert!(modes(&zero, &zero).is_empty());
        let mut thrust = zero;
        thrust[0][4] = 3.0;
        thrust[1][3] = -2.0;
        assert!(modes(&thrust, &zero).is_empty());
        assert!(modes(&diagonal([f64::NAN; 6]), &zero).is_empty());
        assert!(modes(&diagonal([f64::INFINITY; 6]), &zero).is_empty());
    }

    #[test]
    fn scales_far_from_1_have_their_modes() {
        for scale in [1e-250, 1e250] {
            let found = modes(&diagonal([scale; 6]), &diagonal([scale.sqrt(); 6]));
            assert_eq!(found.len(), 6);
            for [stiffness, damping] in found {
                assert_relative_eq!(stiffness, scale, max_relative = 1e-12);
                assert_relative_eq!(damping, scale.sqrt(), max_relative = 1e-12);
            }
        }
    }

    /// As above, with a growth of 1e-3 of the rate: an oscillation that bounds the step, as if it
    /// had no damping.
    #[test]
    fn a_mode_that_grows_by_little_is_an_oscillation() {
        let mut stiffness = diagonal([1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
        stiffness[0][1] = -2e-3;
        stiffness[1][0] = 2e-3;
        let found = modes(&stiffness, &[[0.0; 6]; 6]);
        assert_eq!(found.len(), 2);
        let mut dampings = [0.0; 2];
        for ([stiffness, damping], place) in found.iter().zip(&mut dampings) {
            assert_relative_eq!(*stiffness, 1.0, max_relative = 1e-5);
            *place = *damping;
        }
        let [least, most] = [dampings[0].min(dampings[1]), dampings[0].max(dampings[1])];
        assert!(least.abs() < 1e-300);
        assert_relative_eq!(most, 2e-3, epsilon = 1e-8);
    }
}
