//! Newton's dual unknown of a contact: friction divided by its limit, as a function of the slip.
//!
//! A law that is not isotropic is so in its metric: with `w = M u` its force is `-c M w`. The dual
//! unknown is then that of w, and its limit is the unit disc for each direction of the slip.

use crate::friction::Metric;
use crate::real::{Real, Vector};

/// Newton's dual unknown of a contact: friction divided by its limit, a vector of length at most 1.
#[derive(Clone, Copy, Debug)]
pub(super) enum Dual<R: Real> {
    /// None yet: a step begins. It is the first variant, so that an empty workspace is all zeros.
    Unknown,
    /// A linear function of the slip, from the last matrix.
    At(Linear<R>),
    /// Its value after Newton's last step.
    After(R::Vec3),
}

/// Dual unknown as a linear function of the slip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Linear<R: Real> {
    /// Dual unknown, and the slip (m/s) for which friction was differentiated.
    pub(super) direction: R::Vec3,
    pub(super) slip: R::Vec3,
    /// Width and growth of the friction's [`FrictionJacobian`].
    pub(super) width: R,
    pub(super) growth: R,
}

impl<R: Real> Linear<R> {
    /// Dual unknown after Newton's step from the slip u to the slip u':
    /// `(u' - w' g (û·(u' - u)))/w` (Chan, Golub & Mulet 1999), in the metric of the law for u.
    #[inline]
    pub(super) fn after(&self, slip: R::Vec3, metric: Option<&Metric<R>>) -> R::Vec3 {
        let (from, to) = (weighed(self.slip, metric), weighed(slip, metric));
        let change = (to - from).dot(direction::<R>(from));
        (to - self.direction * (self.growth * change)) * (R::ONE / self.width)
    }
}

/// Vector in the metric of a law, if it has one.
#[inline(always)]
pub(super) fn weighed<R: Real>(vector: R::Vec3, metric: Option<&Metric<R>>) -> R::Vec3 {
    metric.map_or(vector, |metric| metric.times(vector))
}

/// Unit vector along `slip`, or 0.
#[inline]
pub(super) fn direction<R: Real>(slip: R::Vec3) -> R::Vec3 {
    let speed = slip.length();
    if speed > R::ZERO {
        slip * (R::ONE / speed)
    } else {
        R::Vec3::ZERO
    }
}

/// Projects a vector on the unit disc.
#[inline]
pub(super) fn on_disc<R: Real>(vector: R::Vec3) -> R::Vec3 {
    let square = vector.length_squared();
    if square > R::ONE {
        vector * (R::ONE / square.sqrt())
    } else {
        vector
    }
}
