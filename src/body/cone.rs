//! Cone: its tip and the rim of its base.

use super::coin::place_on_circle;
use super::solid::centre;
use super::{ContactPoint, MassProperties, RigidPointBody, check_contacts, homogeneous};
use crate::error::{self, Rule, SceneError};
use crate::real::{Real, Vector};

/// Homogeneous cone along body z.
///
/// Contact 0 is its tip, the others are points on the rim of its base. The centre of mass is a
/// quarter of the height above the base.
///
/// `P` stores the contacts: an array, a borrowed slice, or a `Vec`.
///
/// *Limit:* the rim is a polygon, as for a [`Coin`](super::Coin). It deviates from the circle by
/// `r (1 - cos(π/n))`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone<R: Real = f64, P = [ContactPoint<R>; 121]> {
    distribution: MassProperties<R>,
    radius: R,
    height: R,
    contacts: P,
}

impl<R: Real> Cone<R> {
    /// Creates a cone whose rim has 120 points. Mass in kg, radius of the base and height in m.
    #[must_use]
    pub fn solid(mass: R, radius: R, height: R) -> Self {
        Self::solid_with_storage([ContactPoint::default(); 121], mass, radius, height)
    }
}

impl<R: Real, P: AsRef<[ContactPoint<R>]> + AsMut<[ContactPoint<R>]>> Cone<R, P> {
    /// Creates a cone with as many contacts as `storage` holds, at least 4: its tip and the points
    /// of its rim. Mass in kg, radius of the base and height in m.
    #[must_use]
    pub fn solid_with_storage(mut storage: P, mass: R, radius: R, height: R) -> Self {
        let distribution = homogeneous::cone(mass, radius, height);
        let contacts = storage.as_mut();
        if let Some((tip, rim)) = contacts.split_first_mut() {
            *tip = ContactPoint::bare(R::Vec3::new(R::ZERO, R::ZERO, height));
            let count = rim.len();
            for (i, point) in rim.iter_mut().enumerate() {
                let (x, y) = place_on_circle(radius, i + 1, count);
                *point = ContactPoint::bare(R::Vec3::new(x, y, R::ZERO));
            }
        }
        centre(contacts, distribution.centre_of_mass);
        Self {
            distribution,
            radius,
            height,
            contacts: storage,
        }
    }
}

impl<R: Real, P> Cone<R, P> {
    /// Radius of the base, m.
    #[inline]
    #[must_use]
    pub fn radius(&self) -> R {
        self.radius
    }

    /// Height, m.
    #[inline]
    #[must_use]
    pub fn height(&self) -> R {
        self.height
    }
}

impl<R: Real, P: AsRef<[ContactPoint<R>]>> RigidPointBody<R> for Cone<R, P> {
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
        self.contacts.as_ref()
    }
    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("mass of the cone", self.distribution.mass, " kg")?;
        error::above_zero("radius of the cone", self.radius, " m")?;
        error::above_zero("height of the cone", self.height, " m")?;
        let count = self.contacts.as_ref().len();
        if count < 4 {
            return Err(SceneError::new(
                "number of contacts of the cone",
                Rule::AtLeast(4),
                R::from_usize(count).to_f64(),
                "",
            ));
        }
        check_contacts(self.contacts.as_ref())
    }
}
