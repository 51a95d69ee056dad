//! The metric of a friction law that depends on the direction of the slip.

use super::{FrictionJacobian, SlidingFriction};
use crate::real::{Real, Vector};

/// Metric of a law that is isotropic.
pub(super) fn isotropic<R: Real>() -> [R::Vec3; 3] {
    let (o, one) = (R::ZERO, R::ONE);
    [
        R::Vec3::new(one, o, o),
        R::Vec3::new(o, one, o),
        R::Vec3::new(o, o, one),
    ]
}

/// The [metric](SlidingFriction::metric_at) of a law, divided by a number so that it keeps the
/// length of one slip.
///
/// With this scale the coefficient, the width and the growth of a [`FrictionJacobian`] are those of
/// the isotropic law within: the force is `-coefficient M M u`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Metric<R: Real> {
    /// Rows, which are also the columns.
    rows: [R::Vec3; 3],
}

impl<R: Real> Metric<R> {
    /// Returns the metric of a law, if it has one, scaled for a slip.
    #[inline]
    pub(crate) fn of<F: SlidingFriction<R> + ?Sized>(
        law: &F,
        position: R::Vec3,
        slip: R::Vec3,
    ) -> Option<Self> {
        let rows = law.metric_at(position)?;
        Some(Self { rows }.scaled_for(slip))
    }

    /// A slip of zero has no direction. Its scale is the root mean square of those of all
    /// directions in a plane.
    fn scaled_for(self, slip: R::Vec3) -> Self {
        let (speed, weighed) = (slip.length(), self.times(slip).length());
        let scale = if speed > R::ZERO {
            weighed / speed
        } else {
            let squares = self.rows.map(Vector::length_squared);
            ((squares[0] + squares[1] + squares[2]) * R::HALF).sqrt()
        };
        if scale > R::ZERO {
            let rows = self.rows.map(|row| row * (R::ONE / scale));
            Self { rows }
        } else {
            self
        }
    }

    /// Returns the metric times a vector.
    #[inline]
    pub(crate) fn times(&self, v: R::Vec3) -> R::Vec3 {
        let [x, y, z] = self.rows;
        x * v.x() + y * v.y() + z * v.z()
    }

    /// Returns the metric times the metric times a slip: friction divided by its negative
    /// coefficient.
    #[inline]
    pub(crate) fn along_friction(&self, slip: R::Vec3) -> R::Vec3 {
        self.times(self.times(slip))
    }

    /// Columns of the derivative of the friction with respect to the slip, divided by the negative
    /// coefficient: `M (1 - growth · |w|/width · ŵ ŵᵀ) M` with `w = M u`.
    pub(crate) fn derivative(&self, jacobian: &FrictionJacobian<R>, slip: R::Vec3) -> [R::Vec3; 3] {
        let w = self.times(slip);
        let speed = w.length();
        let weakening = if speed > R::ZERO {
            jacobian.growth / (speed * jacobian.width)
        } else {
            R::ZERO
        };
        self.rows.map(|column| {
            let weakened = column - w * (weakening * w.dot(column));
            self.times(weakened)
        })
    }
}
