//! Dormand-Prince pair, of order 5 with an error estimate of order 4.

use super::embedded_pair::Pair;
use super::method::adaptive_method;

/// Adaptive Runge-Kutta method of order 5, for tight tolerances.
///
/// The pair of Dormand and Prince (Journal of Computational and Applied Mathematics 6(1), 1980),
/// with six force evaluations per step. The step size follows from a tolerance.
/// [`guide::choosing`](crate::guide::choosing) says what the tolerance bounds and how large the
/// error of a run is.
///
/// *Cost:* a tolerance ten times tighter costs `10^(1/5)`, 1.6 times as much, in smooth motion.
///
/// *Error:* 0.18 to 9.9 tolerances in trials 1, 3, 5 and 8 of the coin report, for tolerances of
/// 1e-3 to 1e-9 m. The slip speed is 1e-3 m/s, and the motion lasts up to 1 s.
/// `tests/physics/adaptive.rs` prints the errors. After longer times the error depends on how the
/// motion amplifies it (see the guide).
///
/// *Torque-free rotation* is exact to rounding. Its error is no part of the estimate where no
/// contact can come into reach. There the steps grow to the longest one at any tolerance.
///
/// *Bounces* without dampers, at a tolerance far above the depth of the contact: a step may contain
/// the whole contact. The speed after a slow bounce can then be wrong by up to 40 tolerances in a
/// second.
///
/// *May add energy* by the size of its error.
///
/// *Not for contacts that stick or roll at a small slip speed.* Stability limits each step to about
/// `3.3 slip_speed/(a μ g)`. Here μ is the coefficient of friction, g is gravity, and
/// `a = 1 + m r²/I` is 3 for a ring and 3.5 for a solid ball. With a slip speed of 1e-6 m/s a
/// rolling ball exceeds the default budget of a million steps within a second, for tolerances of
/// 1e-6 m and less ([`BudgetSpent`](crate::StepError::BudgetSpent)). In longer steps the contact
/// slips to and fro. A tolerance far above `slip_speed` times 1 s allows that, and fewer steps. Use
/// [`Radau5`](crate::Radau5) there, or [`EnergyMomentum`](crate::EnergyMomentum).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DormandPrince54<R = f64> {
    /// Parameter of the accuracy, m, above 0.
    ///
    /// The estimated error of a step is at most 0.65 of it, plus rounding. The error is a
    /// displacement of the farthest point of the body, in which an error of a velocity counts for
    /// 1 s. The true error of a step can be larger: see
    /// [`Step::error_estimate`](crate::Step::error_estimate) and
    /// [`guide::choosing`](crate::guide::choosing).
    pub tolerance: R,
    /// Largest step size, s, above 0.
    pub longest_step: R,
    /// Largest number of attempted steps in a run, rejected ones included, at least 1.
    pub budget: u32,
}

pub(crate) const PAIR: Pair<7> = Pair {
    stages: [
        [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0, 0.0],
        [
            19372.0 / 6561.0,
            -25360.0 / 2187.0,
            64448.0 / 6561.0,
            -212.0 / 729.0,
            0.0,
            0.0,
            0.0,
        ],
        [
            9017.0 / 3168.0,
            -355.0 / 33.0,
            46732.0 / 5247.0,
            49.0 / 176.0,
            -5103.0 / 18656.0,
            0.0,
            0.0,
        ],
        // Weights of the result. The last slope of this step is the first slope of the next one.
        [
            35.0 / 384.0,
            0.0,
            500.0 / 1113.0,
            125.0 / 192.0,
            -2187.0 / 6784.0,
            11.0 / 84.0,
            0.0,
        ],
        [0.0; 7],
    ],
    error: [
        71.0 / 57600.0,
        0.0,
        -71.0 / 16695.0,
        71.0 / 1920.0,
        -17253.0 / 339_200.0,
        22.0 / 525.0,
        -1.0 / 40.0,
    ],
    // The local error of the result is 0.1 to 0.8 of the estimate, and less for tighter tolerances.
    // These are medians of trials 3 and 8 of the coin report, with tolerances of 1e-5 and 1e-7 m.
    trust: 1.0 / 3.0,
    roots: 3,
    follows_slip: true,
};

adaptive_method!(DormandPrince54, order 5);
