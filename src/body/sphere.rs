//! Ball with one contact.

use super::{ContactPoint, MassProperties, RigidPointBody, homogeneous};
use crate::error::{self, SceneError};
use crate::real::{Real, Vector};

/// Ball with one contact at its centre, whose radius is that of the ball.
///
/// It rolls without rattling and costs one contact.
///
/// The mass distribution is arbitrary. [`solid`](Self::solid) and [`shell`](Self::shell) have their
/// centre of mass in the middle. [`loaded`](Self::loaded) has it anywhere, as in a tippe top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere<R: Real = f64> {
    pub(super) distribution: MassProperties<R>,
    contact: [ContactPoint<R>; 1],
}

impl<R: Real> Sphere<R> {
    /// Creates a homogeneous ball: moments `2 m r²/5`. Mass in kg, radius in m.
    #[must_use]
    pub fn solid(mass: R, radius: R) -> Self {
        Self::loaded(radius, homogeneous::ball(mass, radius))
    }

    /// Creates a thin spherical shell: moments `2 m r²/3`. Mass in kg, radius in m.
    #[must_use]
    pub fn shell(mass: R, radius: R) -> Self {
        Self::loaded(radius, homogeneous::shell(mass, radius))
    }

    /// Creates a ball of this radius (m) about the origin with any mass distribution.
    ///
    /// Body axes are those of the distribution, with the origin at its centre of mass.
    ///
    /// ```
    /// use tumble::glam::DVec3;
    /// use tumble::{MassProperties, Sphere};
    /// // A bowling ball whose centre of mass is 1 mm away from the middle.
    /// let ball = Sphere::loaded(0.108, MassProperties::ball(7.0, 0.108)?.at(DVec3::X * 0.001));
    /// assert_eq!(ball.middle(), DVec3::X * -0.001);
    /// # Ok::<(), tumble::SceneError>(())
    /// ```
    #[must_use]
    pub fn loaded(radius: R, distribution: MassProperties<R>) -> Self {
        Self {
            contact: [ContactPoint {
                // Subtracted from zero to avoid `-0` if there is no offset.
                position: R::Vec3::ZERO - distribution.centre_of_mass,
                radius,
            }],
            distribution,
        }
    }

    /// Radius, m.
    #[inline]
    #[must_use]
    pub fn radius(&self) -> R {
        let [contact] = self.contact;
        contact.radius
    }

    /// Middle of the ball from the centre of mass, m, body axes.
    #[inline]
    #[must_use]
    pub fn middle(&self) -> R::Vec3 {
        let [contact] = self.contact;
        contact.position
    }
}

impl<R: Real> RigidPointBody<R> for Sphere<R> {
    #[inline]
    fn mass(&self) -> R {
        self.distribution.mass
    }
    #[inline]
    fn inertia(&self) -> R::Mat3 {
        self.distribution.inertia
    }
    #[inline]
    fn contacts(&self) -> &[ContactPoint<R>] {
        &self.contact
    }
    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("radius of the sphere", self.radius(), " m")?;
        error::above_zero("mass of the sphere", self.distribution.mass, " kg")?;
        self.distribution.check()
    }
}
