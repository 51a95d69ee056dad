//! The rigid body: its mass, its inertia, and the points that can touch the ground.
//!
//! # Bodies
//!
//! | body | contacts | axes | asks |
//! |---|---|---|---|
//! | [`Coin`] | a ring of points, the report's coin | normal along x | [`tilt`](Coin::tilt), [`face_up`](Coin::face_up) |
//! | [`Disc`], thin ring or solid | the whole circle of its rim | normal along x | [`tilt`](Disc::tilt), [`face_up`](Disc::face_up) |
//! | [`SolidCoin`] | the points of two rims | normal along x | [`tilt`](SolidCoin::tilt), [`face_up`](SolidCoin::face_up): heads, tails or edge |
//! | [`Sphere`], solid, hollow or loaded | one ball | any | |
//! | [`Cuboid`], sharp or rounded, also loaded | eight corners, bare or balls | along the edges | [`side_up`](Cuboid::face_up), [`pips`](CuboidFace::pips) |
//! | [`Ellipsoid`], also loaded: an egg | one, which wanders over its surface | axes along x, y, z | |
//! | [`Capsule`] | two balls | axis along z | |
//! | [`Cone`] | its tip and the points of its rim | axis along z | |
//! | [`Rod`] | its two ends | along z | |
//! | [`PointMass`] | itself | any | |
//! | [`Solid::hull`] | the user's points | the user's | |
//! | [`Solid`] | any, apart from where the mass is | the user's | |
//! | [`PointCloud`] | the user's points, each with a mass | the user's | |
//!
//! Mass, centre of mass and inertia of solids, points and what is joined from them:
//! [`MassProperties`].

mod capsule;
mod coin;
mod cone;
mod cuboid;
mod disc;
mod ellipsoid;
mod energy_level;
mod hull;
mod inertia_properties;
mod jacobi;
mod mass_properties;
mod point_cloud;
mod rim;
mod rod;
#[cfg(feature = "serde")]
mod saved;
mod solid;
mod solid_coin;
mod sphere;

pub use capsule::Capsule;
pub use coin::{Coin, CoinFace};
pub use cone::Cone;
pub use cuboid::{Cuboid, CuboidFace};
pub use disc::Disc;
pub use ellipsoid::Ellipsoid;
pub use inertia_properties::InertiaProperties;
pub use mass_properties::MassProperties;
pub use point_cloud::PointCloud;
use rim::MOST_NODES;
pub use rim::Rim;
pub(crate) use rim::{Arc, CUTS, GAUSS_6, GAUSS_8, Panel, Panels, QUARTER, SHORT, sink_last};
pub use rod::{PointMass, Rod};
#[cfg(feature = "serde")]
pub use saved::Storage;
pub use solid::Solid;
pub use solid_coin::SolidCoin;
pub use sphere::Sphere;

use crate::error::{self, Rule, SceneError};
use crate::real::{Real, Vector};

/// A rigid body made of points.
///
/// *To the caller:* everything is in body axes with the centre of mass at the origin, in SI units,
/// and constant.
///
/// *To the implementer:* [`mass`](Self::mass), [`inertia`](Self::inertia) and
/// [`contacts`](Self::contacts) are enough. A sphere has one contact, at its centre, with its
/// radius; a box has eight, with radius 0. Override [`contacts_below`](Self::contacts_below) where
/// the shape tells which few of many contacts are low: it is asked in each step.
/// [`contract::check_body`](crate::contract::check_body) tests an implementation.
///
/// ```
/// use tumble::glam::{DMat3, DVec3};
/// use tumble::{ContactPoint, RigidPointBody};
///
/// /// Two balls on a light bar: a dumb-bell along x.
/// struct DumbBell {
///     contacts: [ContactPoint; 2],
/// }
///
/// impl RigidPointBody for DumbBell {
///     fn mass(&self) -> f64 {
///         2.0
///     }
///     fn inertia(&self) -> DMat3 {
///         DMat3::from_diagonal(DVec3::new(0.008, 0.508, 0.508))
///     }
///     fn contacts(&self) -> &[ContactPoint] {
///         &self.contacts
///     }
/// }
/// let ball = |x| ContactPoint { position: DVec3::new(x, 0.0, 0.0), radius: 0.1 };
/// let bell = DumbBell { contacts: [ball(-0.5), ball(0.5)] };
/// assert_eq!(bell.bounding_radius(), 0.6);
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a body: it does not implement `RigidPointBody<{R}>`",
    label = "this should be a body",
    note = "implement `mass`, `inertia` and `contacts`; the precision `{R}` of body, ground, friction and gravity must be the same"
)]
pub trait RigidPointBody<R: Real = f64> {
    /// Mass, kg, above 0.
    fn mass(&self) -> R;

    /// Inertia tensor about the centre of mass, kg m², body axes. Zero for a single point; of rank
    /// 2 for points on a line.
    fn inertia(&self) -> R::Mat3;

    /// The places that can touch the ground. A contact's number is its place in this slice.
    fn contacts(&self) -> &[ContactPoint<R>];

    /// The circle of the body all of whose places can touch, beside [`contacts`](Self::contacts):
    /// none where nothing else is said, one at most, and at most 32 contacts beside it. A
    /// [smooth](Self::is_smooth) body has none.
    #[inline]
    fn rims(&self) -> &[Rim<R>] {
        &[]
    }

    /// Distance from the centre of mass to the farthest place of the surface, m.
    fn bounding_radius(&self) -> R {
        let rims = self.rims().iter().map(Rim::bounding_radius);
        let contacts = self.contacts().iter();
        (contacts.map(|contact| contact.position.length() + contact.radius))
            .chain(rims)
            .fold(R::ZERO, R::at_least)
    }

    /// A cyclic run of contact numbers that holds every contact whose surface reaches below the
    /// plane `normal · p = offset` (body axes, `normal` of length 1): every contact with
    /// `normal · position - radius < offset`.
    ///
    /// The run may hold more, and by default holds all; it must not miss one.
    #[inline]
    fn contacts_below(&self, normal: R::Vec3, offset: R) -> ContactRange {
        let _ = (normal, offset);
        ContactRange::all(self.contacts().len())
    }

    /// As [`contacts_below`](Self::contacts_below), for a caller who knows the run under a plane
    /// that is not far from this one, as that of a moment ago: the same run, found sooner.
    ///
    /// Whatever `near` is, the answer must be that of [`contacts_below`](Self::contacts_below): a
    /// run of contacts that depends on what is known would sum forces in another order.
    #[inline]
    fn contacts_below_near(&self, normal: R::Vec3, offset: R, near: ContactRange) -> ContactRange {
        let _ = near;
        self.contacts_below(normal, offset)
    }

    /// How far the surface reaches in a `direction` (unit vector, body axes), m from the centre of
    /// mass: the body's support function. Never less than the greatest
    /// `direction · position + radius` of a contact; a little more does no harm. It is what a
    /// closed-form [`Flight`](crate::Flight) asks for.
    fn support(&self, direction: R::Vec3) -> R {
        if self.is_smooth() {
            return direction.dot(self.support_point(direction));
        }
        let rims = self.rims().iter().map(|rim| rim.support(direction));
        let contacts = self.contacts().iter();
        (contacts.map(|contact| direction.dot(contact.position) + contact.radius))
            .chain(rims)
            .fold(-self.bounding_radius(), R::at_least)
    }

    /// Whether the body has one contact that wanders over its surface as it turns: the place that
    /// [`support_point`](Self::support_point) tells. An egg does, and no body of fixed contacts.
    ///
    /// Such a body gives in [`contacts`](Self::contacts) one contact that stands for it, with a
    /// radius above 0 (a ball within it will do), and tells its own
    /// [`bounding_radius`](Self::bounding_radius).
    #[inline]
    fn is_smooth(&self) -> bool {
        false
    }

    /// Of a smooth body: the place of its surface that is farthest in the direction `towards` (body
    /// axes, length 1), from the centre of mass, m, body axes. Not asked of others.
    ///
    /// The surface must be convex. On a plane, force and energy then belong together: as the body
    /// turns, depth changes as if the place were fixed in the body.
    #[inline]
    fn support_point(&self, towards: R::Vec3) -> R::Vec3 {
        towards * self.bounding_radius()
    }

    /// Whether the body can be: called once, when a scene is composed, before anything else is
    /// asked.
    ///
    /// Mass and inertia are checked in any case; an implementer adds the rules of his own
    /// parameters.
    ///
    /// # Errors
    /// Names the quantity, the rule that it breaks, and its value.
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }
}

/// Behind a pointer, also as `dyn`.
macro_rules! forward {
    ($pointer:ty) => {
        impl<R: Real, B: RigidPointBody<R> + ?Sized> RigidPointBody<R> for $pointer {
            #[inline]
            fn mass(&self) -> R {
                (**self).mass()
            }
            #[inline]
            fn inertia(&self) -> R::Mat3 {
                (**self).inertia()
            }
            #[inline]
            fn contacts(&self) -> &[ContactPoint<R>] {
                (**self).contacts()
            }
            #[inline]
            fn rims(&self) -> &[Rim<R>] {
                (**self).rims()
            }
            #[inline]
            fn bounding_radius(&self) -> R {
                (**self).bounding_radius()
            }
            #[inline]
            fn contacts_below(&self, normal: R::Vec3, offset: R) -> ContactRange {
                (**self).contacts_below(normal, offset)
            }
            #[inline]
            fn contacts_below_near(
                &self,
                normal: R::Vec3,
                offset: R,
                near: ContactRange,
            ) -> ContactRange {
                (**self).contacts_below_near(normal, offset, near)
            }
            #[inline]
            fn support(&self, direction: R::Vec3) -> R {
                (**self).support(direction)
            }
            #[inline]
            fn is_smooth(&self) -> bool {
                (**self).is_smooth()
            }
            #[inline]
            fn support_point(&self, towards: R::Vec3) -> R::Vec3 {
                (**self).support_point(towards)
            }
            #[inline]
            fn check(&self) -> Result<(), SceneError> {
                (**self).check()
            }
        }
    };
}
forward!(&B);
#[cfg(feature = "std")]
forward!(alloc::boxed::Box<B>);

/// A place of the body that can touch the ground: a small ball fixed in the body, or a bare point
/// where the radius is 0.
///
/// Its depth is `radius - gap(position)`, and the ground's force acts at
/// `position - radius * normal`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "R: serde::Serialize, R::Vec3: serde::Serialize",
        deserialize = "R: serde::Deserialize<'de>, R::Vec3: serde::Deserialize<'de>"
    ))
)]
pub struct ContactPoint<R: Real = f64> {
    /// From the centre of mass, m, body axes.
    pub position: R::Vec3,
    /// m, at least 0.
    pub radius: R,
}

impl<R: Real> ContactPoint<R> {
    /// A point of radius 0, at `position` (m, body axes, from the centre of mass).
    #[must_use]
    pub fn bare(position: R::Vec3) -> Self {
        Self {
            position,
            radius: R::ZERO,
        }
    }
}

/// That every contact is finite and none has a negative radius.
///
/// # Errors
/// Names the first quantity that is not.
pub fn check_contacts<R: Real>(contacts: &[ContactPoint<R>]) -> Result<(), SceneError> {
    for contact in contacts {
        error::finite("x of a contact point", contact.position.x(), " m")?;
        error::finite("y of a contact point", contact.position.y(), " m")?;
        error::finite("z of a contact point", contact.position.z(), " m")?;
        error::at_least_zero("radius of a contact point", contact.radius, " m")?;
    }
    Ok(())
}

/// That the rim of a body can be, that there is no more than one, not on a smooth body, and that
/// few enough contacts stand beside it.
///
/// # Errors
/// Names the first quantity that breaks a rule.
pub fn check_rims<R: Real>(body: &(impl RigidPointBody<R> + ?Sized)) -> Result<(), SceneError> {
    let rims = body.rims();
    let Some(rim) = rims.first() else {
        return Ok(());
    };
    rim.check()?;
    let at_most = |quantity, most, count: usize| {
        if count <= most {
            return Ok(());
        }
        let rule = Rule::AtMost(most);
        Err(SceneError::new(quantity, rule, count as f64, ""))
    };
    at_most("number of rims of a body", 1, rims.len())?;
    if body.is_smooth() {
        // The contact that wanders over its surface would stand for each place of the rim.
        at_most("number of rims of a smooth body", 0, rims.len())?;
    }
    let contacts = body.contacts().len();
    at_most("number of contacts beside a rim", BESIDE_A_RIM, contacts)
}

/// An implicit step remembers 128 contacts, and keeps 96 of these places for a rim.
const BESIDE_A_RIM: usize = 128 - MOST_NODES;

/// A cyclic run of contact numbers: `first`, `first + 1`, ..., beginning again at 0 after the last
/// contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactRange {
    /// Number of the first contact of the run.
    pub first: usize,
    /// How many contacts the run holds.
    pub count: usize,
}

impl ContactRange {
    /// No contact.
    pub const NONE: Self = Self { first: 0, count: 0 };

    /// All of `count` contacts.
    #[inline]
    #[must_use]
    pub const fn all(count: usize) -> Self {
        Self { first: 0, count }
    }

    /// What this run holds of `contacts` numbers that `other` does not: at most two runs.
    #[inline]
    #[must_use]
    pub(crate) fn without(self, other: Self, contacts: usize) -> [Self; 2] {
        let (run, other) = (self.within(contacts), other.within(contacts));
        if run.count == 0 || other.count == 0 {
            return [run, Self::NONE];
        }
        // A division for each of the remainders would take as long as two contacts.
        let once_round = |place: usize| {
            if place < contacts {
                place
            } else {
                place - contacts
            }
        };
        // Places counted from the start of this run, round the body: `other` covers [start, start +
        // its count), and that again one round earlier.
        let start = once_round(other.first + contacts - run.first);
        let end = start + other.count;
        let wrapped = end.saturating_sub(contacts);
        let after = end.min(run.count);
        let head = Self {
            first: once_round(run.first + wrapped),
            count: start.min(run.count).saturating_sub(wrapped),
        };
        let tail = Self {
            first: once_round(run.first + after),
            count: run.count - after.max(wrapped.min(run.count)),
        };
        [head, tail]
    }

    /// The same contacts of a body that has so many, as [`parts`](Self::parts) takes them: from one
    /// of its contacts on, and at most once round.
    #[inline]
    fn within(self, contacts: usize) -> Self {
        Self {
            first: if self.first < contacts { self.first } else { 0 },
            count: self.count.min(contacts),
        }
    }

    /// The run's part up to the last of `contacts`, and the part that begins again at contact 0.
    #[inline]
    #[must_use]
    pub fn parts<T>(self, contacts: &[T]) -> [&[T]; 2] {
        let end = self.first.checked_add(self.count);
        match end.and_then(|end| contacts.get(self.first..end)) {
            Some(head) => [head, &[]],
            None => self.parts_across_the_end(contacts),
        }
    }

    #[cold]
    fn parts_across_the_end<T>(self, contacts: &[T]) -> [&[T]; 2] {
        let to_end = contacts.get(self.first..).unwrap_or_default();
        let wrapped = self.count.min(contacts.len()) - to_end.len();
        [to_end, contacts.get(..wrapped).unwrap_or_default()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_past_the_last_contact_begins_again_at_the_first() {
        let contacts = [0, 1, 2, 3, 4];
        assert_eq!(
            ContactRange { first: 3, count: 4 }.parts(&contacts),
            [&[3, 4][..], &[0, 1]]
        );
        assert_eq!(
            ContactRange { first: 1, count: 3 }.parts(&contacts),
            [&[1, 2, 3][..], &[]]
        );
        assert_eq!(ContactRange::all(5).parts(&contacts), [&contacts[..], &[]]);
        assert_eq!(ContactRange::NONE.parts(&contacts), [&[][..], &[]]);
    }

    #[test]
    fn what_a_run_holds_beyond_another_is_each_of_its_contacts_that_the_other_lacks_once() {
        const FIRSTS: [usize; 8] = [0, 1, 2, 3, 4, 5, 6, usize::MAX];
        const COUNTS: [usize; 7] = [0, 1, 2, 3, 4, 5, usize::MAX];
        let contacts = [0, 1, 2, 3, 4];
        let runs = || {
            FIRSTS.into_iter().flat_map(|first| {
                COUNTS
                    .into_iter()
                    .map(move |count| ContactRange { first, count })
            })
        };
        for held in 0..=contacts.len() {
            let contacts = &contacts[..held];
            let has =
                |run: ContactRange, contact: &i32| run.parts(contacts).concat().contains(contact);
            for (run, other) in runs().flat_map(|run| runs().map(move |other| (run, other))) {
                let rest = run.without(other, held);
                let mut found = rest.map(|run| run.parts(contacts).concat()).concat();
                found.sort_unstable();
                let lacking = contacts
                    .iter()
                    .filter(|contact| has(run, contact) && !has(other, contact));
                assert!(
                    found.iter().eq(lacking),
                    "{held}: {run:?} without {other:?}: {rest:?}"
                );
            }
        }
    }

    #[test]
    fn a_run_beyond_the_contacts_is_cut_and_never_panics() {
        let contacts = [0, 1];
        assert_eq!(
            ContactRange { first: 7, count: 9 }.parts(&contacts),
            [&[][..], &[0, 1]]
        );
    }
}
