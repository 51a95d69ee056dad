//! The classical Runge-Kutta method of order 4.

use crate::body::ContactRange;
use crate::error::{self, SceneError, StepError};
use crate::integrator::free_error::{self, Bodies};
use crate::integrator::interface::{Integrator, LIMIT_HALVINGS, Step, step_length};
use crate::integrator::lanes::Lanes;
use crate::integrator::point::Point;
use crate::quadrature::bisect;
use crate::real::Real;
use crate::scene::Dynamics;
use crate::state::State;

/// Classical Runge-Kutta method of order 4.
///
/// It integrates position, velocity, quaternion and angular momentum, and scales the quaternion to
/// length 1 after each step. Use it for smooth phases of motion and as a reference.
///
/// *Torque-free rotation* is exact to rounding for a body with three different moments of inertia,
/// and for one whose moment about the axis of symmetry is the smallest. For three different moments
/// the error that the method would have is also removed where the torques of the step change the
/// angular momentum by less than a part in 4096.
///
/// *Order* 4 in smooth motion, with four force evaluations per step. Order 1 through
/// touch-downs, where the damper's force is discontinuous.
///
/// *May add energy* by O(dt⁵) per step in smooth motion.
///
/// *Stable* for `dt < 2.61/ω` and `dt < 2.78/δ`, and up to `2.83/ω` without dampers. Here ω and δ
/// are the highest frequency and damping rate that the contacts give the body at their arms (see
/// [integrators](crate#integrators)).
/// [`Stepper::largest_stable_step`](crate::Stepper::largest_stable_step) computes the limit at a
/// state.
///
/// *Spin* limits the step too. Let `I₃` be the moment about the axis of symmetry and `I₁` the two
/// equal moments. The rate of nutation is `I₃/I₁` times the spin about the axis of symmetry (twice
/// the spin for a coin).
/// - A lean grows if the nutation rotates by more than `2.83/(1 - I₁/2I₃)` rad per step (3.77 rad
///   for a coin). A coin that spins flat on the ground at 50 rad/s tips over with dt = 0.15 s.
/// - A slender body (`I₃` far below `I₁`) that rotates at ω across its axis, in contact, needs
///   steps below about `√(I₃/I₁)/ω`. A few times that step adds energy without bound.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Rk4<R = f64> {
    /// Step size, s, above 0.
    pub time_step: R,
}

impl<R: Real> Integrator<R> for Rk4<R> {
    /// Contact range of the previous step, in which the next step searches first.
    type Workspace = ContactRange;

    #[inline]
    fn step<D: Dynamics<R>>(
        &self,
        scene: &D,
        state: &mut State<R>,
        limit: R,
        near: &mut ContactRange,
    ) -> Result<Step<R>, StepError> {
        let dt = step_length(self.time_step, limit);
        let start = Point::of(state);
        let mut end = advanced(scene, &start, dt, near);
        end.orientation = free_error::removed(
            scene,
            (&start, &end),
            dt,
            Bodies::Amplifying,
            |free, start, dt| advanced(free, start, dt, &mut { ContactRange::NONE }).orientation,
        );
        *state = end.to_state();
        Ok(Step::new(dt, 4))
    }

    const HAS_LANES: bool = true;

    #[inline]
    fn step_in_lanes<D: Dynamics<R>>(&self, scene: &D, lanes: &mut Lanes<R>, seconds: R) {
        lanes.begin();
        lanes.end();
        let start = lanes.states;
        let half = seconds * R::HALF;
        let untested = scene.untested();
        let mut k1 = lanes.slopes(untested);
        lanes.advance(&start, &k1, half);
        let k2 = lanes.slopes(untested);
        lanes.advance(&start, &k2, half);
        let k3 = lanes.slopes(untested);
        lanes.advance(&start, &k3, seconds);
        let k4 = lanes.slopes(scene);
        k1.replace_by_sum([&k2, &k3, &k4], sum);
        lanes.advance(&start, &k1, seconds * R::from_f64(1.0 / 6.0));
        lanes.normalise();
    }

    fn order(&self) -> u32 {
        4
    }

    fn fixed_step(&self) -> Option<R> {
        Some(self.time_step)
    }

    /// The limit is where `|1 + z + z²/2 + z³/6 + z⁴/24|` exceeds 1 for `z = h λ`,
    /// `λ² + damping λ + stiffness = 0`.
    fn largest_stable_step(&self, stiffness: R, damping: R) -> Option<R> {
        let half = damping * R::HALF;
        let discriminant = half * half - stiffness;
        if discriminant >= R::ZERO {
            return Some(R::from_f64(ON_REAL_AXIS) / (half + discriminant.sqrt()));
        }
        // A pair of complex roots. The half disc |z| < 2.6 is stable throughout. No point of the
        // left half plane with |z| > 2.97 is stable.
        let frequency = stiffness.sqrt();
        let [real, imaginary] = [-half / frequency, (-discriminant).sqrt() / frequency];
        let bracket = [2.6, 3.0].map(R::from_f64);
        let grows_at = |size: R| grows(real * size, imaginary * size);
        let [limit, _] = bisect(bracket, LIMIT_HALVINGS, grows_at);
        Some(limit / frequency)
    }

    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("time step", self.time_step, " s")
    }
}

/// Returns the point at the end of a step.
#[inline(always)]
fn advanced<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &Point<R>,
    dt: R,
    near: &mut ContactRange,
) -> Point<R> {
    let half = dt * R::HALF;
    // The values of the laws are tested at the end of the step.
    let untested = scene.untested();
    let k1 = start.slope_along(untested, start.orientation.axes(), near);
    let k2 = start.plus(&k1, half).slope_near(untested, near);
    let k3 = start.plus(&k2, half).slope_near(untested, near);
    let k4 = start.plus(&k3, dt).slope_near(scene, near);

    let sum = sum(&k1, [&k2, &k3, &k4]);
    start.plus(&sum, dt * R::from_f64(1.0 / 6.0))
}

/// Returns six times the mean of the slopes.
#[inline(always)]
fn sum<R: Real>(k1: &Point<R>, [k2, k3, k4]: [&Point<R>; 3]) -> Point<R> {
    let middle = k2.plus(k3, R::ONE);
    k1.plus(k4, R::ONE).plus(&middle, R::TWO)
}

/// End of the stability region on the negative real axis: `1 - x/2 + x²/6 - x³/24 = 0`.
const ON_REAL_AXIS: f64 = 2.785_293_563_405_282;

/// Returns true if the amplification factor for `z = h λ` exceeds 1 in magnitude.
fn grows<R: Real>(real: R, imaginary: R) -> bool {
    let (mut a, mut b) = (R::ONE, R::ZERO);
    // Horner's scheme: 1 + z (1 + z/2 (1 + z/3 (1 + z/4))).
    for order in [4.0, 3.0, 2.0, 1.0] {
        let per = R::from_f64(1.0 / order);
        (a, b) = (
            R::ONE + (real * a - imaginary * b) * per,
            (real * b + imaginary * a) * per,
        );
    }
    a * a + b * b > R::ONE
}
