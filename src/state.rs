//! The state of a body: position, orientation and motion. Plain data.

mod motion;

pub use motion::Motion;

use crate::error::{Quantity, StepError};
use crate::real::{Quaternion, Real, Vector};
use crate::rotation::Rotation;

/// State of a body: all quantities that change while it moves, in SI units. The world's z axis
/// points up.
///
/// A state is plain data without hidden parts. A run that continues from a saved and loaded state
/// gives the same bits. A state does not belong to a stepper; one stepper serves any number of
/// states.
///
/// The feature `serde` writes and reads the numbers as they are. A text format may round them.
/// `serde_json` keeps every bit only with its feature `float_roundtrip`; without it, one f64 in
/// five is read back as a neighbouring value.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "R::Vec3: serde::Serialize, R::Quat: serde::Serialize",
        deserialize = "R::Vec3: serde::Deserialize<'de>, R::Quat: serde::Deserialize<'de>"
    ))
)]
pub struct State<R: Real = f64> {
    /// Centre of mass, m, world axes.
    pub position: R::Vec3,
    /// Velocity of the centre of mass, m/s, world axes.
    pub linear_velocity: R::Vec3,
    /// Rotation from body axes to world axes, a unit quaternion. Any other quaternion is scaled to
    /// length 1 wherever it is used, and the first step that rotates the body stores the scaled
    /// one. If the square of its length is 0 or infinite, the step returns
    /// [`BadState`](crate::StepError::BadState).
    pub orientation: R::Quat,
    /// Angular momentum about the centre of mass, kg m²/s, world axes.
    pub angular_momentum: R::Vec3,
}

impl<R: Real> State<R> {
    /// Creates a state at rest at `position` (m), with the body axes along the world axes. The type
    /// of the position, `DVec3` or `Vec3`, sets the precision.
    // `V` is `R::Vec3`. A separate type parameter lets the compiler infer the precision, which it
    // cannot do from a projection.
    #[must_use]
    pub fn at<V: Vector<R>>(position: V) -> Self
    where
        R: Real<Vec3 = V>,
    {
        Self {
            position,
            linear_velocity: R::Vec3::ZERO,
            orientation: Rotation::<R>::IDENTITY.to_quat(),
            angular_momentum: R::Vec3::ZERO,
        }
    }

    /// Returns the state with a velocity of `linear_velocity` (m/s, world axes).
    #[must_use]
    pub fn with_linear_velocity(self, linear_velocity: R::Vec3) -> Self {
        Self {
            linear_velocity,
            ..self
        }
    }

    /// Returns the state with this orientation (rotation from body axes to world axes).
    #[must_use]
    pub fn with_orientation(self, orientation: R::Quat) -> Self {
        Self {
            orientation,
            ..self
        }
    }

    /// Returns the state with the orientation given by a rotation vector (rad, world axes). The
    /// body is rotated by `|vector|` radians about `vector`, starting from body axes along the
    /// world axes.
    #[must_use]
    pub fn with_rotation_vector(self, vector: R::Vec3) -> Self {
        self.with_orientation(Rotation::<R>::from_rotation_vector(vector).to_quat())
    }

    /// Returns the state with this angular momentum (kg m²/s, world axes).
    #[must_use]
    pub fn with_angular_momentum(self, angular_momentum: R::Vec3) -> Self {
        Self {
            angular_momentum,
            ..self
        }
    }

    /// Rotation from body axes to world axes, normalised to length 1. It is not finite if the
    /// square of the length of `orientation` is 0, infinite or NaN.
    #[inline]
    #[must_use]
    pub fn rotation(&self) -> Rotation<R> {
        Rotation::from_quat(self.orientation)
    }

    /// Position in the world (m, world axes) of a point fixed in the body (m, body axes, from the
    /// centre of mass).
    #[must_use]
    pub fn world_point(&self, body_point: R::Vec3) -> R::Vec3 {
        self.position + self.rotation().apply(body_point)
    }

    /// Returns the first quantity that is not finite, if any.
    #[inline]
    #[must_use]
    pub fn not_finite(&self) -> Option<Quantity> {
        // An infinity or a NaN stays in every sum. A sum of finite numbers that overflows only
        // costs the slower check.
        let [x, y, z, w] = self.orientation.xyzw();
        let sum = self.position + self.linear_velocity + self.angular_momentum;
        let is_finite = (sum.x() + sum.y() + sum.z() + (x + y + z + w)).is_finite();
        if is_finite {
            None
        } else {
            self.find_not_finite()
        }
    }

    #[cold]
    fn find_not_finite(&self) -> Option<Quantity> {
        let [x, y, z, w] = self.orientation.xyzw();
        if !self.position.is_finite() {
            Some(Quantity::Position)
        } else if !self.linear_velocity.is_finite() {
            Some(Quantity::LinearVelocity)
        } else if !(x.is_finite() && y.is_finite() && z.is_finite() && w.is_finite()) {
            Some(Quantity::Orientation)
        } else if !self.angular_momentum.is_finite() {
            Some(Quantity::AngularMomentum)
        } else {
            None
        }
    }

    /// Checks that a step can begin with this state.
    #[inline]
    pub(crate) fn check(&self) -> Result<(), StepError> {
        match self.not_finite() {
            Some(quantity) => Err(self.error_of(quantity)),
            None if self.rotation().is_a_turn() => Ok(()),
            None => Err(self.error_of(Quantity::Orientation)),
        }
    }

    /// Error of a step from a state with this invalid quantity.
    #[cold]
    #[inline(never)]
    pub(crate) fn error_of(&self, quantity: Quantity) -> StepError {
        let [x, y, z, w] = self.orientation.xyzw();
        let length = match quantity {
            Quantity::Position => self.position.length(),
            Quantity::LinearVelocity => self.linear_velocity.length(),
            Quantity::Orientation => (x * x + y * y + (z * z + w * w)).sqrt(),
            Quantity::AngularMomentum => self.angular_momentum.length(),
        };
        StepError::BadState {
            quantity,
            value: length.to_f64(),
        }
    }
}

/// State at rest at the origin, with the body axes along the world axes.
impl<R: Real> Default for State<R> {
    fn default() -> Self {
        Self::at(R::Vec3::ZERO)
    }
}

/// Formats the state as one line with units. `{:.3}` sets the digits of each number. The quaternion
/// is x, y, z, w.
///
/// ```
/// use tumble::{State, glam::DVec3};
///
/// let state = State::at(DVec3::Z).with_linear_velocity(DVec3::X * 0.25);
/// assert_eq!(
///     format!("{state:.1}"),
///     "position [0.0, 0.0, 1.0] m, velocity [0.2, 0.0, 0.0] m/s, \
///      orientation [0.0, 0.0, 0.0, 1.0], angular momentum [0.0, 0.0, 0.0] kg m²/s",
/// );
/// ```
impl<R: Real> core::fmt::Display for State<R> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let components = |v: R::Vec3| [v.x(), v.y(), v.z()];
        f.write_str("position ")?;
        write_list(f, &components(self.position))?;
        f.write_str(" m, velocity ")?;
        write_list(f, &components(self.linear_velocity))?;
        f.write_str(" m/s, orientation ")?;
        write_list(f, &self.orientation.xyzw())?;
        f.write_str(", angular momentum ")?;
        write_list(f, &components(self.angular_momentum))?;
        f.write_str(" kg m²/s")
    }
}

/// Writes numbers in brackets, each with the formatter's precision.
fn write_list<R: Real>(f: &mut core::fmt::Formatter<'_>, numbers: &[R]) -> core::fmt::Result {
    let mut before = "[";
    for number in numbers {
        f.write_str(before)?;
        core::fmt::Display::fmt(number, f)?;
        before = ", ";
    }
    f.write_str("]")
}

/// Comparison by the largest difference of any component. A quaternion and its negative are the
/// same rotation.
#[cfg(feature = "approx-05")]
mod approximate {
    use super::{Quaternion, Real, State, Vector};
    use approx::AbsDiffEq;

    impl<R: Real> AbsDiffEq for State<R> {
        type Epsilon = R;

        fn default_epsilon() -> R {
            R::EPSILON
        }

        fn abs_diff_eq(&self, other: &Self, epsilon: R) -> bool {
            let near = |a: R::Vec3, b: R::Vec3| {
                let d = a - b;
                d.x().abs() <= epsilon && d.y().abs() <= epsilon && d.z().abs() <= epsilon
            };
            let [p, q] = [self.orientation.xyzw(), other.orientation.xyzw()];
            let differs_by = |sign: R| {
                p.iter()
                    .zip(q)
                    .all(|(&a, b)| (a - b * sign).abs() <= epsilon)
            };
            near(self.position, other.position)
                && near(self.linear_velocity, other.linear_velocity)
                && near(self.angular_momentum, other.angular_momentum)
                && (differs_by(R::ONE) || differs_by(-R::ONE))
        }
    }
}

#[cfg(all(test, feature = "approx-05"))]
mod tests {
    use super::*;
    use approx::AbsDiffEq;
    use glam::{DQuat, DVec3};

    /// Changes each of the thirteen numbers in turn.
    fn changed(state: &State, by: f64) -> [State; 13] {
        core::array::from_fn(|number| {
            let mut other = *state;
            match number {
                0..3 => other.position[number] += by,
                3..6 => other.linear_velocity[number - 3] += by,
                6..9 => other.angular_momentum[number - 6] += by,
                _ => {
                    let mut orientation = other.orientation.to_array();
                    orientation[number - 9] += by;
                    other.orientation = DQuat::from_array(orientation);
                }
            }
            other
        })
    }

    #[test]
    fn states_are_compared_in_each_number_and_by_rotation() {
        let state = State::at(DVec3::new(0.3, -0.2, 0.7))
            .with_linear_velocity(DVec3::new(0.1, 0.4, -0.6))
            .with_rotation_vector(DVec3::new(0.4, -0.9, 0.2))
            .with_angular_momentum(DVec3::new(-0.5, 0.2, 0.8));
        let opposite = state.with_orientation(-state.orientation);
        for same in [state, opposite] {
            for near in changed(&same, 0.9e-9) {
                assert!(state.abs_diff_eq(&near, 1e-9), "{near:?}");
            }
            for far in changed(&same, 1.1e-9)
                .into_iter()
                .chain(changed(&same, f64::NAN))
            {
                assert!(!state.abs_diff_eq(&far, 1e-9), "{far:?}");
            }
        }
    }
}
