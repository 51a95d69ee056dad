//! Body with any mass distribution and any contacts.

use super::{ContactPoint, MassProperties, RigidPointBody, check_contacts};
use crate::error::{Rule, SceneError};
use crate::real::Real;

/// Body whose mass distribution and contacts are given independently.
///
/// Examples are a composite, a solid with the contacts of its hull, or a body with mass and inertia
/// from a data sheet.
///
/// `P` stores the contacts: an array, a borrowed slice, or a `Vec`.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{ContactPoint, MassProperties, RigidPointBody, Solid};
///
/// // A spinning top: a disc on a peg. Its contacts are the round tip of the peg and eight points
/// // on the rim of the disc.
/// let peg = MassProperties::cylinder(0.01, 0.003, 0.06)?;
/// let disc = MassProperties::cylinder(0.05, 0.03, 0.008)?.at(DVec3::Z * 0.005);
/// let eighth = core::f64::consts::FRAC_PI_4;
/// let rim = |i: u8| DVec3::X.rotate_z(f64::from(i) * eighth) * 0.03;
/// let contacts: [ContactPoint; 9] = core::array::from_fn(|i| match i {
///     0 => ContactPoint { position: DVec3::Z * -0.027, radius: 0.003 },
///     i => ContactPoint::bare(rim(i as u8) + DVec3::Z * 0.001),
/// });
/// let top = Solid::new(peg.with(&disc), contacts)?;
/// // The contact positions are now relative to the centre of mass.
/// assert!(top.contacts()[0].position.z < -0.027);
/// # Ok::<(), tumble::SceneError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid<R: Real, P> {
    /// Mass distribution, with its centre of mass in the axes in which it was given.
    pub(super) distribution: MassProperties<R>,
    pub(super) contacts: P,
}

impl<R: Real, P: AsRef<[ContactPoint<R>]> + AsMut<[ContactPoint<R>]>> Solid<R, P> {
    /// Creates a body from a mass distribution and contacts in the same axes and about the same
    /// origin.
    ///
    /// The contacts are shifted so that the centre of mass becomes their origin.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the mass, the centre of mass or the inertia is not finite, if
    /// there is no contact, or if a contact is not finite or has a radius below 0. A scene checks
    /// that mass and inertia are those of a solid.
    pub fn new(distribution: MassProperties<R>, mut contacts: P) -> Result<Self, SceneError> {
        distribution.check()?;
        check_contacts(contacts.as_ref())?;
        if contacts.as_ref().is_empty() {
            let rule = Rule::AtLeast(1);
            return Err(SceneError::new("number of contacts", rule, 0.0, ""));
        }
        Ok(Self {
            contacts: {
                centre(contacts.as_mut(), distribution.centre_of_mass);
                contacts
            },
            distribution,
        })
    }
}

/// Shifts contacts so that `centre` becomes their origin.
pub(super) fn centre<R: Real>(contacts: &mut [ContactPoint<R>], centre: R::Vec3) {
    for contact in contacts {
        contact.position -= centre;
    }
}

impl<R: Real, P> Solid<R, P> {
    /// Position of the centre of mass in the axes in which the body was given, m.
    #[must_use]
    pub fn centre_of_mass(&self) -> R::Vec3 {
        self.distribution.centre_of_mass
    }
}

impl<R: Real, P: AsRef<[ContactPoint<R>]>> RigidPointBody<R> for Solid<R, P> {
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
}
