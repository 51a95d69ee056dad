//! The classical Runge-Kutta method of order 4.

use super::{Integrator, Step, step_length};
use crate::body::ContactRange;
use crate::contact::{Load, Motion};
use crate::error::{self, SceneError, StepError};
use crate::quadrature::bisect;
use crate::real::Real;
use crate::rotation::{Axes, Rotation};
use crate::scene::Dynamics;
use crate::state::State;

/// Classical Runge-Kutta method of order 4.
///
/// It integrates position, velocity, quaternion and angular momentum, and scales the quaternion to
/// length 1 after each step. Use it for smooth phases of motion and as a reference.
///
/// *Order* 4 in smooth motion, with four force evaluations per step. Order 1 to 2 through
/// touch-downs, where the damper's force is discontinuous.
///
/// *May add energy* by O(dt⁵) per step in smooth motion.
///
/// *Stable* for `dt < 2.62/ω` and `dt < 2.78/δ`, and up to `2.83/ω` without dampers. Here ω and δ
/// are the highest frequency and damping rate that the contacts give the body at their arms (see
/// [integrators](crate#integrators)).
/// [`Stepper::largest_stable_step`](crate::Stepper::largest_stable_step) computes the limit at a
/// state.
///
/// *Spin* limits the step too. The rate of nutation is `I₃/I₁` times the spin about the axis of
/// symmetry (twice the spin for a coin). A lean grows in two cases:
/// - The nutation rotates by more than `2.83/(1 - I₁/2I₃)` rad per step (3.77 rad for a coin). A
///   coin that spins flat on the ground at 50 rad/s tips over with dt = 0.15 s.
/// - `I₃ < I₁`. The lean then grows at any step size, because the method takes energy from the
///   spin.
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
        let half = dt * R::HALF;
        let start = Point::of(state);
        let k1 = start.slope_along(scene, start.orientation.axes(), near);
        let k2 = start.plus(&k1, half).slope_near(scene, near);
        let k3 = start.plus(&k2, half).slope_near(scene, near);
        let k4 = start.plus(&k3, dt).slope_near(scene, near);

        let middle = k2.plus(&k3, R::ONE);
        let sum = k1.plus(&k4, R::ONE).plus(&middle, R::TWO);
        *state = start.plus(&sum, dt * R::from_f64(1.0 / 6.0)).to_state();
        Ok(Step::new(dt, 4))
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
        let [limit, _] = bisect(bracket, super::LIMIT_HALVINGS, grows_at);
        Some(limit / frequency)
    }

    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("time step", self.time_step, " s")
    }
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

/// The thirteen numbers that the method adds: a state, or its time derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point<R: Real> {
    pub(crate) position: R::Vec3,
    pub(crate) linear_velocity: R::Vec3,
    pub(crate) orientation: Rotation<R>,
    pub(crate) angular_momentum: R::Vec3,
}

impl<R: Real> Point<R> {
    #[inline]
    pub(crate) fn of(state: &State<R>) -> Self {
        Self {
            position: state.position,
            linear_velocity: state.linear_velocity,
            orientation: state.rotation(),
            angular_momentum: state.angular_momentum,
        }
    }

    #[inline]
    pub(crate) fn to_state(self) -> State<R> {
        State {
            position: self.position,
            linear_velocity: self.linear_velocity,
            orientation: self.orientation.normalised().to_quat(),
            angular_momentum: self.angular_momentum,
        }
    }

    /// Returns the point with the quaternion scaled to length 1.
    #[inline]
    pub(crate) fn normalised(self) -> Self {
        Self {
            orientation: self.orientation.normalised(),
            ..self
        }
    }

    #[inline]
    pub(crate) fn plus(&self, slope: &Self, seconds: R) -> Self {
        Self {
            position: self.position + slope.position * seconds,
            linear_velocity: self.linear_velocity + slope.linear_velocity * seconds,
            orientation: self.orientation.plus(slope.orientation, seconds),
            angular_momentum: self.angular_momentum + slope.angular_momentum * seconds,
        }
    }

    /// Returns the time derivative at this point.
    #[inline(always)]
    pub(super) fn slope(&self, scene: &impl Dynamics<R>) -> Self {
        let mut run = ContactRange::NONE;
        self.slope_near(scene, &mut run)
    }

    /// Returns the time derivative, given the contact range of a nearby point.
    ///
    /// `run` is updated. [`ContactRange::NONE`] is valid if no range is known.
    #[inline(always)]
    fn slope_near(&self, scene: &impl Dynamics<R>, run: &mut ContactRange) -> Self {
        self.slope_along(scene, self.orientation.axes_of_any_length(), run)
    }

    /// Returns the time derivative, given the axes and the contact range of a nearby point.
    #[inline(always)]
    fn slope_along(&self, scene: &impl Dynamics<R>, axes: Axes<R>, run: &mut ContactRange) -> Self {
        let motion = self.motion_along(scene, axes);
        *run = scene
            .contact_model()
            .range_near(*run, motion.position, &motion.axes);
        self.slope_under(
            scene,
            &motion,
            &scene.contact_model().load_on(*run, &motion),
        )
    }

    /// Returns pose, axes and velocities at this point, on which the forces depend.
    #[inline(always)]
    pub(super) fn motion(&self, scene: &impl Dynamics<R>) -> Motion<R> {
        self.motion_along(scene, self.orientation.axes_of_any_length())
    }

    /// Returns position and velocities at this point for the given axes.
    #[inline(always)]
    pub(super) fn motion_along(&self, scene: &impl Dynamics<R>, axes: Axes<R>) -> Motion<R> {
        let mass = scene.inertia_properties();
        Motion {
            position: self.position,
            axes,
            linear_velocity: self.linear_velocity,
            angular_velocity: mass.angular_velocity(&axes, self.angular_momentum),
        }
    }

    /// Returns the time derivative at this point for a given load of the contacts.
    #[inline(always)]
    pub(super) fn slope_under(
        &self,
        scene: &impl Dynamics<R>,
        motion: &Motion<R>,
        load: &Load<R>,
    ) -> Self {
        let inverse_mass = scene.inertia_properties().inverse_mass();
        Self {
            position: self.linear_velocity,
            linear_velocity: load.force * inverse_mass + scene.gravity(),
            orientation: self.orientation.rate(motion.angular_velocity),
            angular_momentum: load.torque,
        }
    }
}
