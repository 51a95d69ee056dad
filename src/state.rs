//! The state of a body: where it is, how it is turned, how it moves. Plain data.

use crate::error::Quantity;
use crate::real::{Quaternion, Real, Vector};
use crate::rotation::Rotation;

/// Everything that changes while a body moves. SI units; the world's z axis points up.
///
/// Plain data with nothing hidden: save it, load it, and the run goes on with the same bits. A
/// state belongs to no stepper; one stepper serves a million states.
///
/// The feature `serde` writes and reads the numbers as they are. A text format may round them:
/// `serde_json` keeps each bit only with its feature `float_roundtrip` (without it one f64 in five
/// comes back beside itself).
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
    /// The turn from body axes to world axes; a unit quaternion. One that is longer or shorter is
    /// scaled to 1 by the first step, unless its square is 0 or infinite: then the step answers
    /// [`BadState`](crate::StepError::BadState).
    pub orientation: R::Quat,
    /// Angular momentum about the centre of mass, kg m²/s, world axes.
    pub angular_momentum: R::Vec3,
}

impl<R: Real> State<R> {
    /// At rest at `position` (m), body axes along the world's. The position's type, `DVec3` or
    /// `Vec3`, is the precision.
    // `V` is `R::Vec3`. As a type of its own it tells the compiler the precision, which a
    // projection does not.
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

    /// The same, moving at `linear_velocity` (m/s, world axes).
    #[must_use]
    pub fn with_linear_velocity(self, linear_velocity: R::Vec3) -> Self {
        Self {
            linear_velocity,
            ..self
        }
    }

    /// The same, turned to `orientation` (body axes to world axes).
    #[must_use]
    pub fn with_orientation(self, orientation: R::Quat) -> Self {
        Self {
            orientation,
            ..self
        }
    }

    /// The same, turned by `|vector|` radians about `vector` (world axes) from body axes along the
    /// world's.
    #[must_use]
    pub fn with_rotation_vector(self, vector: R::Vec3) -> Self {
        self.with_orientation(Rotation::<R>::from_rotation_vector(vector).to_quat())
    }

    /// The same, spinning with `angular_momentum` (kg m²/s, world axes).
    #[must_use]
    pub fn with_angular_momentum(self, angular_momentum: R::Vec3) -> Self {
        Self {
            angular_momentum,
            ..self
        }
    }

    /// The turn from body axes to world axes, of length 1.
    #[inline]
    #[must_use]
    pub fn rotation(&self) -> Rotation<R> {
        Rotation::from_quat(self.orientation)
    }

    /// A place fixed in the body (m, body axes, from the centre of mass) in the world (m, world
    /// axes).
    #[must_use]
    pub fn world_point(&self, body_point: R::Vec3) -> R::Vec3 {
        self.position + self.rotation().apply(body_point)
    }

    /// The first part that is not finite, if any.
    #[inline]
    #[must_use]
    pub fn not_finite(&self) -> Option<Quantity> {
        // An infinity or a NaN stays in every sum. A sum that overflows by itself only costs the
        // longer look.
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
}

/// At rest at the origin, body axes along the world's.
impl<R: Real> Default for State<R> {
    fn default() -> Self {
        Self::at(R::Vec3::ZERO)
    }
}

/// One line with units: `{:.3}` sets the digits of each number. The quaternion is x, y, z, w.
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

/// Numbers in brackets, each with the formatter's precision.
fn write_list<R: Real>(f: &mut core::fmt::Formatter<'_>, numbers: &[R]) -> core::fmt::Result {
    let mut before = "[";
    for number in numbers {
        f.write_str(before)?;
        core::fmt::Display::fmt(number, f)?;
        before = ", ";
    }
    f.write_str("]")
}

/// Comparison by the largest difference of any component; a turn and its negative quaternion are
/// the same turn.
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
