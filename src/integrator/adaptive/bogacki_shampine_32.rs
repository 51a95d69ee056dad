//! Bogacki-Shampine pair, of order 3 with an error estimate of order 2.

use super::embedded_pair::Pair;
use super::method::adaptive_method;

/// Adaptive Runge-Kutta method of order 3, for loose tolerances and many touch-downs.
///
/// The pair of Bogacki and Shampine (Applied Mathematics Letters 2(4), 1989), with three force
/// evaluations per step. The step size follows from a tolerance.
/// [`guide::choosing`](crate::guide::choosing) says what the tolerance bounds and how large the
/// error of a run is.
///
/// Loose tolerances and motions with many touch-downs suit this method. For tight tolerances use
/// [`DormandPrince54`](crate::DormandPrince54).
///
/// *Error:* 0.17 to 7.1 tolerances in trials 1, 3, 5 and 8 of the coin report, for tolerances of
/// 1e-3 to 1e-9 m. The slip speed is 1e-3 m/s, and the motion lasts up to 1 s.
/// `tests/physics/adaptive.rs` prints the errors. After longer times the error depends on how the
/// motion amplifies it (see the guide).
///
/// *Bounces* without dampers conserve the errors of the steps, which add up. There are more steps
/// at a tighter tolerance, and so more tolerances of error.
///
/// *Torque-free rotation* is exact to rounding. Its error is no part of the estimate where no
/// contact can come into reach.
///
/// *May add energy* by the size of its error.
///
/// *Not for contacts that stick or roll at a small slip speed.* Stability limits each step to about
/// `2.5 slip_speed/(a μ g)`. Here μ is the coefficient of friction, g is gravity, and
/// `a = 1 + m r²/I` is 3 for a ring and 3.5 for a solid ball. With a slip speed of 1e-6 m/s a
/// rolling ball exceeds the default budget of a million steps within a second, for tolerances of
/// 1e-6 m and less ([`BudgetSpent`](crate::StepError::BudgetSpent)). In longer steps the contact
/// slips to and fro. A tolerance far above `slip_speed` times 1 s allows that, and fewer steps. Use
/// [`Radau5`](crate::Radau5) there, or [`EnergyMomentum`](crate::EnergyMomentum).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BogackiShampine32<R = f64> {
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

const PAIR: Pair<4> = Pair {
    stages: [
        [1.0 / 2.0, 0.0, 0.0, 0.0],
        [0.0, 3.0 / 4.0, 0.0, 0.0],
        // Weights of the result. The last slope of this step is the first slope of the next one.
        [2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0, 0.0],
        [0.0; 4],
    ],
    error: [
        2.0 / 9.0 - 7.0 / 24.0,
        1.0 / 3.0 - 1.0 / 4.0,
        4.0 / 9.0 - 1.0 / 3.0,
        -1.0 / 8.0,
    ],
    // The local error of the result is 0.1 to 1.6 of the estimate (medians, trials 8 and 3 of the
    // coin report).
    trust: 1.0,
    roots: 2,
    follows_slip: true,
};

adaptive_method!(BogackiShampine32, order 3);
