//! Smooth curve through measured fractions of cuboids, which knows no mechanics.
//!
//! A cube has the fraction 1/3 by symmetry. With `u = ln(x/y)`, the log odds of the curve are
//! `-ln 2 + c₁ u + … + c₄ u⁴`. The coefficients have the largest likelihood. Fisher's scoring, a
//! Newton method with the expected second derivative, finds them.

/// Number of coefficients.
pub(crate) const DEGREE: usize = 4;
/// Iterations, each with half of the step of Newton's method: the error is halved at least.
const ITERATIONS: u32 = 200;

type Coefficients = [f64; DEGREE];

/// A smooth curve over the ratio x/y.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Smooth(Coefficients);

impl Smooth {
    /// Fits the curve to ratios, fractions and numbers of rolls.
    pub(crate) fn of(measured: &[(f64, f64, u64)]) -> Self {
        // The slope of a first guess.
        let mut curve = Self([-4.0, 0.0, 0.0, 0.0]);
        for _ in 0..ITERATIONS {
            let mut gradient = Coefficients::default();
            let mut curvature = [Coefficients::default(); DEGREE];
            for &(ratio, fraction, rolls) in measured {
                let (powers, expected) = (powers(ratio), curve.fraction(ratio));
                let weight = rolls as f64 * expected * (1.0 - expected);
                for row in 0..DEGREE {
                    gradient[row] += powers[row] * rolls as f64 * (fraction - expected);
                    for column in 0..DEGREE {
                        curvature[row][column] += weight * powers[row] * powers[column];
                    }
                }
            }
            let step = solved(curvature, gradient);
            for (coefficient, change) in curve.0.iter_mut().zip(step) {
                *coefficient += 0.5 * change;
            }
        }
        curve
    }

    pub(crate) fn fraction(&self, ratio: f64) -> f64 {
        let terms = self.0.iter().zip(powers(ratio)).map(|(c, power)| c * power);
        let log_odds = terms.sum::<f64>() - 2.0_f64.ln();
        1.0 / (1.0 + (-log_odds).exp())
    }
}

/// `u, u², u³, u⁴` of the logarithm u of a ratio.
fn powers(ratio: f64) -> Coefficients {
    let logarithm = ratio.ln();
    [1, 2, 3, 4].map(|power| logarithm.powi(power))
}

/// Solution of linear equations with a positive definite matrix, by elimination.
fn solved(mut matrix: [Coefficients; DEGREE], mut side: Coefficients) -> Coefficients {
    for pivot in 0..DEGREE {
        let (chosen, value) = (matrix[pivot], side[pivot]);
        for row in (0..DEGREE).filter(|row| *row != pivot) {
            let factor = matrix[row][pivot] / chosen[pivot];
            for (entry, of_pivot) in matrix[row].iter_mut().zip(chosen) {
                *entry -= factor * of_pivot;
            }
            side[row] -= factor * value;
        }
    }
    core::array::from_fn(|row| side[row] / matrix[row][row])
}
