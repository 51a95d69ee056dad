//! The three stages of a step, and the solution of their equations by the simplified Newton method.
//!
//! The stages are at the fractions `c_i` of the step, and their increments are
//! `z_i = h Σ a_ij f(y + z_j)`. The inverse of `a` has one real and two complex eigenvalues. In the
//! coordinates `w = T⁻¹ z` of its eigenvectors, the linear equations of an iteration fall into 13
//! real and 13 complex ones, which `reduced` solves:
//!
//! ```text
//! (γ/h - J) δw₁ = (T⁻¹ f)₁ - γ/h w₁
//! ((α + iβ)/h - J) (δw₂ + i δw₃) = (T⁻¹ f)₂ + i (T⁻¹ f)₃ - (α + iβ)/h (w₂ + i w₃)
//! ```
//! (Hairer & Wanner, Solving Ordinary Differential Equations II, sections IV.5 and IV.8.)

use super::jacobian::Jacobian;
use super::linear::Complex;
use super::reduced::{Local, Reduced};
use crate::integrator::point::Point;
use crate::real::{Quaternion, Real, Vector};
use crate::rotation::Rotation;

/// Number of stages.
pub(super) const STAGES: usize = 3;

/// Times of the stages as fractions `c` of the step: `(4 ∓ √6)/10` and 1.
pub(super) const NODES: [f64; STAGES] = [0.155_051_025_721_682_2, 0.644_948_974_278_317_8, 1.0];

/// Weights of the slopes in the result: the last row of `a`.
pub(super) const WEIGHTS: [f64; STAGES] =
    [0.376_403_062_700_467_25, 0.512_485_826_188_421_6, 1.0 / 9.0];

/// Eigenvalues of the inverse of `a`: γ, and α ± iβ.
const GAMMA: f64 = 3.637_834_252_744_496;
const ALPHA: f64 = 2.681_082_873_627_752;
const BETA: f64 = 3.050_430_199_247_410_5;

/// Eigenvectors of the inverse of `a`, and the inverse of that matrix.
const T: [[f64; STAGES]; STAGES] = [
    [
        0.091_232_394_870_892_94,
        -0.141_255_295_020_954_2,
        -0.030_029_194_105_147_424,
    ],
    [
        0.241_717_932_707_107,
        0.204_129_352_293_799_93,
        0.382_942_112_757_261_9,
    ],
    [0.966_048_182_615_093, 1.0, 0.0],
];
const INVERSE_T: [[f64; STAGES]; STAGES] = [
    [
        4.325_579_890_063_155,
        0.339_199_251_815_809_87,
        0.541_770_539_935_874_9,
    ],
    [
        -4.178_718_591_551_905,
        -0.327_682_820_761_062_4,
        0.476_623_554_500_550_45,
    ],
    [
        -0.502_872_634_945_786_9,
        2.571_926_949_855_605,
        -0.596_039_204_828_224_9,
    ],
];

/// Weights of the increments in the error estimate. With the slope at the start they give a
/// difference from a formula of order 3.
const ERROR: [f64; STAGES] = [-10.048_809_399_827_414, 1.382_142_733_160_748, -1.0 / 3.0];

/// Weights of the slopes at 0 and at the stages in their third difference: 1 for a slope that is
/// the cube of the time over the step.
const THIRD: [f64; STAGES + 1] = [
    -10.0,
    15.580_782_047_249_224,
    -8.914_115_380_582_557,
    10.0 / 3.0,
];

/// Least number of iterations. The first leaves an error of order 3 in the step size, and each adds
/// an order. Four have the order of the result, however large the tolerance is.
const LEAST: u32 = 4;
/// Largest number of iterations.
const MOST: u32 = 10;

/// The linear equations of one step.
pub(super) struct Equations<'a, R: Real> {
    jacobian: &'a Jacobian<R>,
    real: Reduced<R>,
    complex: Reduced<Complex<R>>,
    gamma: R,
    lambda: Complex<R>,
    /// Orientation at the start, which the coordinates of a rotation refer to.
    orientation: Rotation<R>,
}

/// Solution of the equations of a step.
pub(super) struct Solution<R: Real> {
    pub(super) increments: Increments<R>,
    /// Slopes of the stages, from the last iteration but one.
    pub(super) slopes: [Point<R>; STAGES],
    pub(super) iterations: u32,
}

/// Increments of the stages from the start of the step.
pub(super) type Increments<R> = [Point<R>; STAGES];

impl<'a, R: Real> Equations<'a, R> {
    pub(super) fn of(jacobian: &'a Jacobian<R>, orientation: Rotation<R>, seconds: R) -> Self {
        let per_second = R::ONE / seconds;
        let gamma = R::from_f64(GAMMA) * per_second;
        let lambda = Complex {
            re: R::from_f64(ALPHA) * per_second,
            im: R::from_f64(BETA) * per_second,
        };
        Self {
            jacobian,
            real: Reduced::of(gamma, jacobian),
            complex: Reduced::of(lambda, jacobian),
            gamma,
            lambda,
            orientation,
        }
    }

    /// Solves for the increments of the stages, until a change of `target` (m) is left, or one that
    /// is below the `rounding` (m). Returns `None` if the iteration does not converge.
    ///
    /// `slope_at` is the slope at an increment. `first` is that at the start.
    pub(super) fn increments(
        &self,
        first: &Point<R>,
        [target, rounding]: [R; 2],
        slope_at: impl Fn(&Point<R>) -> Point<R>,
        size_of: impl Fn(&Point<R>) -> R,
    ) -> Option<Solution<R>> {
        let zero = first.scaled(R::ZERO);
        let (mut w, mut z, mut slopes) = ([zero; STAGES], [zero; STAGES], [*first; STAGES]);
        let mut last: Option<R> = None;
        for iteration in 1..=MOST {
            let changes = self.changes(&slopes, &w);
            for (w, change) in w.iter_mut().zip(&changes) {
                *w = w.plus(change, R::ONE);
            }
            let moved = combined(&T, &changes);
            for (z, moved) in z.iter_mut().zip(&moved) {
                *z = z.plus(moved, R::ONE);
            }
            let size = moved.iter().map(&size_of).fold(R::ZERO, R::at_least);
            // The first change is the motion without the forces that begin to act within the step,
            // such as that of a damper at touch-down. So the rate is known from the third on.
            let rate = last.map_or(R::HALF, |last| size / last);
            let left = size * (rate / (R::ONE - rate)).at_most(R::ONE);
            let is_solved = size <= rounding
                || (iteration >= LEAST && (size <= target || (rate < R::ONE && left <= target)));
            if is_solved {
                return Some(Solution {
                    increments: z,
                    slopes,
                    iterations: iteration,
                });
            }
            // Changes below the target may be rounding, which does not fall: those of a body at
            // rest. The test also ends an iteration that is no longer finite.
            let converges = rate < R::ONE || size <= target;
            if !converges {
                return None;
            }
            last = (iteration > 1).then_some(size);
            slopes = z.map(|z| slope_at(&z));
        }
        None
    }

    /// Changes of the transformed increments in one iteration.
    fn changes(&self, slopes: &[Point<R>; STAGES], w: &[Point<R>; STAGES]) -> Increments<R> {
        let [f1, f2, f3] = combined(&INVERSE_T, slopes);
        let [w1, w2, w3] = w;
        let Complex { re, im } = self.lambda;
        let right = self.local(&f1.plus(w1, -self.gamma));
        let right_re = self.local(&f2.plus(w2, -re).plus(w3, im));
        let right_im = self.local(&f3.plus(w3, -re).plus(w2, -im));
        let right_pair = right_re.zip(&right_im, |re, im| Complex { re, im });
        let pair = self.complex.solve(self.jacobian, &right_pair);
        [
            self.point(&self.real.solve(self.jacobian, &right)),
            self.point(&pair.map(|part| part.re)),
            self.point(&pair.map(|part| part.im)),
        ]
    }

    /// Estimated error of the result, from the increments and a slope near the start.
    ///
    /// The stiff parts of the difference between the two formulas are damped by the real matrix.
    pub(super) fn error(
        &self,
        increments: &Increments<R>,
        slope: &Point<R>,
        seconds: R,
    ) -> Point<R> {
        let mut sum = *slope;
        for (increment, weight) in increments.iter().zip(ERROR) {
            sum = sum.plus(increment, R::from_f64(weight) / seconds);
        }
        self.point(&self.real.solve(self.jacobian, &self.local(&sum)))
    }

    /// Coordinates of a difference of points. The rotation is twice the change of the quaternion.
    fn local(&self, point: &Point<R>) -> Local<R> {
        let turn = point.orientation.after(self.orientation.inverse());
        let [x, y, z, length] = turn.to_quat().xyzw();
        let (p, v, l) = (
            point.position,
            point.linear_velocity,
            point.angular_momentum,
        );
        Local {
            shift: [p.x(), p.y(), p.z()],
            turn: [x, y, z].map(|part| part * R::TWO),
            rates: [v.x(), v.y(), v.z(), l.x(), l.y(), l.z()],
            length,
        }
    }

    /// Difference of points with these coordinates.
    fn point(&self, local: &Local<R>) -> Point<R> {
        let [px, py, pz] = local.shift;
        let [x, y, z] = local.turn.map(|part| part * R::HALF);
        let [vx, vy, vz, lx, ly, lz] = local.rates;
        let turn = Rotation::unscaled(R::Quat::new(x, y, z, local.length));
        Point {
            position: R::Vec3::new(px, py, pz),
            linear_velocity: R::Vec3::new(vx, vy, vz),
            orientation: turn.after(self.orientation),
            angular_momentum: R::Vec3::new(lx, ly, lz),
        }
    }
}

/// Third difference of the slopes over a step, and the first one, from the slope at the start.
pub(super) fn differences<R: Real>(start: &Point<R>, slopes: &[Point<R>; STAGES]) -> [Point<R>; 2] {
    let [at_start, of_stages @ ..] = THIRD.map(R::from_f64);
    let mut third = start.scaled(at_start);
    for (slope, weight) in slopes.iter().zip(of_stages) {
        third = third.plus(slope, weight);
    }
    let [.., end] = slopes;
    [third, end.plus(start, -R::ONE)]
}

/// Product of a matrix of numbers with three points.
fn combined<R: Real>(matrix: &[[f64; STAGES]; STAGES], points: &Increments<R>) -> Increments<R> {
    let [first, second, third] = points;
    matrix.map(|[a, b, c]| {
        (first.scaled(R::from_f64(a)))
            .plus(second, R::from_f64(b))
            .plus(third, R::from_f64(c))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::adaptive::embedded_pair::Place;
    use crate::scene::Scene;
    use crate::state::State;
    use crate::{Coulomb, Cuboid, FlatGround, Plane, UniformGravity};
    use glam::DVec3;

    /// Difference of points with 1 at one of 13 coordinates.
    fn unit(number: usize) -> Local<f64> {
        let one = |at: usize| f64::from(u8::from(at == number));
        Local {
            shift: core::array::from_fn(one),
            turn: core::array::from_fn(|i| one(3 + i)),
            rates: core::array::from_fn(|i| one(6 + i)),
            length: one(12),
        }
    }

    /// The box slides and spins on four corners in a slope. The Jacobian is a difference here.
    #[test]
    fn the_linear_equations_are_those_of_the_differentiated_motion() {
        let ground =
            FlatGround::level(2e3, 6.0).on(Plane::through(DVec3::ZERO, DVec3::new(0.1, -0.2, 1.0)));
        let scene = Scene::new(
            Cuboid::solid(0.8, DVec3::new(0.3, 0.2, 0.1)),
            ground,
            Coulomb {
                coefficient: 0.4,
                slip_speed: 0.3,
            },
            UniformGravity::down(9.8),
        )
        .unwrap();
        let state = State::at(DVec3::Z * 0.01)
            .with_rotation_vector(DVec3::new(0.2, 0.1, 0.7))
            .with_linear_velocity(DVec3::new(1.0, -0.4, -0.1))
            .with_angular_momentum(DVec3::new(0.02, -0.01, 0.03));
        let start = Place::at(&scene, Point::of(&state));
        let jacobian = Jacobian::at(&scene, &start.motion, start.point.angular_momentum);
        let nudge = 1e-6;
        for seconds in [1e-3, 0.03, 1.0] {
            let equations = Equations::of(&jacobian, start.point.orientation, seconds);
            for number in 0..13 {
                let wanted = unit(number);
                let change = equations.point(&wanted);
                let slope = |by: f64| Place::at(&scene, start.point.plus(&change, by)).slope;
                let rate = slope(nudge).plus(&slope(-nudge), -1.0).scaled(0.5 / nudge);
                let right = change.scaled(equations.gamma).plus(&rate, -1.0);
                let found = equations.real.solve(&jacobian, &equations.local(&right));
                let off = found.zip(&wanted, |a, b| a - b);
                let parts = off.shift.into_iter().chain(off.turn).chain(off.rates);
                let largest = parts.chain([off.length]).fold(0.0, |a, b| b.abs().max(a));
                assert!(largest < 1e-5, "{number}, {seconds} s: off by {largest:e}");
            }
        }
    }
}
