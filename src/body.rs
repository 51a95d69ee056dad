//! The rigid body: its mass, its inertia, and the points that can touch the ground.
//!
//! # Bodies
//!
//! | body | contacts | axes | queries |
//! |---|---|---|---|
//! | [`Coin`] | a ring of points; the coin of the coin report | normal along x | [`tilt`](Coin::tilt), [`face_up`](Coin::face_up) |
//! | [`Disc`], thin ring or solid | the whole circle of its rim | normal along x | [`tilt`](Disc::tilt), [`face_up`](Disc::face_up) |
//! | [`ThickDisc`]: a coin with a thickness | the whole circles of its two rims | normal along x | [`tilt`](ThickDisc::tilt), [`face_up`](ThickDisc::face_up): heads, tails or edge |
//! | [`SolidCoin`] | the points of two rims | normal along x | [`tilt`](SolidCoin::tilt), [`face_up`](SolidCoin::face_up): heads, tails or edge |
//! | [`Sphere`], solid, hollow or loaded | one ball | any | |
//! | [`Cuboid`], sharp or rounded, also loaded | eight corners, bare or balls | along the edges | [`face_up`](Cuboid::face_up), [`pips`](CuboidFace::pips) |
//! | [`Ellipsoid`], also loaded: an egg | one, which moves over its surface | axes along x, y, z | |
//! | [`Capsule`] | two balls | axis along z | |
//! | [`Cone`] | its tip and the points of its rim | axis along z | |
//! | [`Rod`] | its two ends | along z | |
//! | [`PointMass`] | itself | any | |
//! | [`Solid::hull`] | the user's points | the user's | |
//! | [`Solid`] | any, independent of the mass distribution | the user's | |
//! | [`PointCloud`] | the user's points, each with a mass | the user's | |
//!
//! A constructor that returns no `Result` accepts any numbers. That masses, radii and edges are
//! above 0 is checked when a scene is composed. The error names the quantity and its value.
//!
//! [`MassProperties`] holds the mass, the centre of mass and the inertia of solids, of points and
//! of bodies joined from them.

mod capsule;
mod coin;
mod cone;
mod cuboid;
mod disc;
mod ellipsoid;
mod homogeneous;
mod hull;
mod mass_properties;
mod point_cloud;
mod rim;
mod rod;
#[cfg(feature = "serde")]
mod saved;
mod solid;
mod solid_coin;
mod sphere;
mod thick_disc;

pub use capsule::Capsule;
pub use coin::{Coin, CoinFace};
pub use cone::Cone;
pub use cuboid::{Cuboid, CuboidFace};
pub use disc::Disc;
pub use ellipsoid::Ellipsoid;
pub use mass_properties::MassProperties;
pub use point_cloud::PointCloud;
pub use rim::Rim;
pub(crate) use rim::{Arc, CUTS, Direction, Panel, Panels, QUARTER, SHORT, sink_last, turned};
pub use rod::{PointMass, Rod};
#[cfg(feature = "serde")]
pub use saved::Storage;
pub use solid::Solid;
pub use solid_coin::SolidCoin;
pub use sphere::Sphere;
pub use thick_disc::ThickDisc;

use crate::error::{self, Rule, SceneError};
pub use crate::inertia::InertiaProperties;
use crate::real::{Real, Vector};

/// A rigid body whose contacts are points, balls or round rims.
///
/// *For callers:* all quantities are in body axes with the centre of mass at the origin, in SI
/// units, and constant.
///
/// *For implementers:* [`mass`](Self::mass), [`inertia`](Self::inertia) and
/// [`contacts`](Self::contacts) are required. A sphere has one contact, at its centre, with its
/// radius. A box has eight contacts, with radius 0. Override
/// [`contacts_below`](Self::contacts_below) if the shape determines which few of many contacts are
/// low, because each step calls it. [`contract::check_body`](crate::contract::check_body) tests an
/// implementation.
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

    /// Inertia tensor about the centre of mass, kg m², body axes.
    ///
    /// The tensor is symmetric. None of its principal moments is negative, and none exceeds the sum
    /// of the other two. It is zero for a single point and of rank 2 for points on a line.
    fn inertia(&self) -> R::Mat3;

    /// Points of the body that can touch the ground. The number of a contact is its index in this
    /// slice.
    fn contacts(&self) -> &[ContactPoint<R>];

    /// Circular edges that can touch along their whole length, in addition to
    /// [`contacts`](Self::contacts).
    ///
    /// Default: none. A body has at most 8 rims. A body with rims has at most 32 contact points in
    /// addition. A [smooth](Self::is_smooth) body has none.
    ///
    /// [`EnergyMomentum`](crate::EnergyMomentum) stores up to 96 points of rims in a step, which
    /// the rims that touch share. This suffices for three rims that touch all round, or for eight
    /// that touch along a short arc. With more, each rim has fewer points and is less accurate. The
    /// explicit methods store none.
    #[inline]
    fn rims(&self) -> &[Rim<R>] {
        &[]
    }

    /// Returns true if two principal moments of inertia are equal for every body of this type.
    ///
    /// Default: false, which is valid for all bodies. Steps find equal moments by themselves. A
    /// type that returns true lets the compiler leave out the free rotation of three different
    /// moments, which saves code in firmware. No result depends on it.
    ///
    /// A scene is not composed with a body that returns true and has three different moments.
    #[inline]
    fn is_symmetric(&self) -> bool {
        false
    }

    /// Distance from the centre of mass to the farthest point of the surface, m.
    ///
    /// A scene is not composed with a contact or rim that is farther away.
    fn bounding_radius(&self) -> R {
        let rims = self.rims().iter().map(Rim::bounding_radius);
        let contacts = self.contacts().iter();
        (contacts.map(|contact| contact.position.length() + contact.radius))
            .chain(rims)
            .fold(R::ZERO, R::at_least)
    }

    /// Cyclic contact range that includes every contact below a plane.
    ///
    /// The plane is `normal · p = offset` in body axes, with `normal` of length 1. A contact is
    /// below it if `normal · position - radius < offset`.
    ///
    /// The range may include more contacts. It must not omit one. By default it is the range from
    /// the first contact below the plane to the last one, for which each contact is evaluated.
    #[inline]
    fn contacts_below(&self, normal: R::Vec3, offset: R) -> ContactRange {
        let contacts = self.contacts();
        if contacts.is_empty() || self.is_smooth() {
            return ContactRange::all(contacts.len());
        }
        ContactRange::spanning(contacts, normal, offset)
    }

    /// Contact range of [`contacts_below`](Self::contacts_below), found faster from the known range
    /// `near` of a similar plane.
    ///
    /// The similar plane is for example that of the previous evaluation.
    ///
    /// The result must equal that of [`contacts_below`](Self::contacts_below) for every value of
    /// `near`. A range that depended on `near` would change the order in which forces are summed.
    #[inline]
    fn contacts_below_near(&self, normal: R::Vec3, offset: R, near: ContactRange) -> ContactRange {
        let _ = near;
        self.contacts_below(normal, offset)
    }

    /// Contacts that show without a search that a known `range` is still that of
    /// [`contacts_below`](Self::contacts_below). Default: `None`.
    ///
    /// The four positions (m, body axes) are those of the contacts `before` the range, `first` and
    /// `last` in it, and `after` it. Return them only if the range holds every contact below a
    /// plane whenever `first` and `last` are below it (`normal · position < offset`), and `before`
    /// and `after` are not. This is so for a convex ring of bare points. The range must not
    /// continue at contact 0.
    ///
    /// [`Stepper::advance_many`](crate::Stepper::advance_many) uses it. It tests several states at
    /// once, and searches for those that fail the test.
    #[inline]
    fn range_ends(&self, range: ContactRange) -> Option<[R::Vec3; 4]> {
        let _ = range;
        None
    }

    /// Support function: the largest distance of the surface from the centre of mass in a
    /// `direction`, m.
    ///
    /// `direction` is a unit vector in body axes. The value is never less than the greatest
    /// `direction · position + radius` of a contact, nor than that of the
    /// [support point](Self::support_point) of a smooth body. It may be slightly greater. A
    /// closed-form [`Flight`](crate::Flight) uses it.
    fn support(&self, direction: R::Vec3) -> R {
        if self.is_smooth() {
            return direction.dot(self.support_point(direction));
        }
        let rims = self.rims().iter().map(|rim| rim.support(direction));
        let contacts = self.contacts().iter();
        (contacts.map(|contact| direction.dot(contact.position) + contact.radius))
            .chain(rims)
            .reduce(R::at_least)
            .unwrap_or_else(|| -self.bounding_radius())
    }

    /// Returns true for a smooth convex body, such as an ellipsoid, whose contact point moves over
    /// the surface as the body rotates.
    ///
    /// [`support_point`](Self::support_point) computes that point. A body with contacts fixed in it
    /// is not smooth in this sense.
    ///
    /// For such a body, [`contacts`](Self::contacts) returns one contact that represents the moving
    /// one, such as a ball inside the body. Such a body must also override
    /// [`bounding_radius`](Self::bounding_radius).
    #[inline]
    fn is_smooth(&self) -> bool {
        false
    }

    /// Point of a smooth body's surface that is farthest in the direction `towards`, m from the
    /// centre of mass, body axes.
    ///
    /// `towards` is of length 1, in body axes. Called for smooth bodies only.
    ///
    /// The surface must be strictly convex, with finite radii of curvature, which
    /// [`check_body`](crate::contract::check_body) does not test. The default is a sphere of the
    /// bounding radius. Force and energy are consistent: as the body rotates, the
    /// penetration depth changes as if the point were fixed in the body. On ground that is not a
    /// plane, the point is searched where the normals of body and ground are opposite, in most
    /// poses by four to eight calls. A valley that is more curved than the body is a limit of
    /// [`Ellipsoid`].
    #[inline]
    fn support_point(&self, towards: R::Vec3) -> R::Vec3 {
        towards * self.bounding_radius()
    }

    /// Checks that the body is valid. Called once, when a scene is composed, before any other
    /// method.
    ///
    /// Mass and inertia are checked in any case. An implementer adds the rules for the body's own
    /// parameters.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the body is invalid. The error names the quantity, the rule that
    /// it breaks, and its value.
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }
}

/// Implements the trait for a pointer to a body, also to `dyn`.
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
            fn is_symmetric(&self) -> bool {
                (**self).is_symmetric()
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
            fn range_ends(&self, range: ContactRange) -> Option<[R::Vec3; 4]> {
                (**self).range_ends(range)
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

/// Point of the body that can touch the ground: a small ball fixed in the body, or a bare point if
/// the radius is 0.
///
/// Its penetration depth is `radius - gap`, with the gap of the ground at the centre of the ball.
/// The ground's force acts at the point of the ball that faces the ground: the centre minus
/// `radius * normal`, in world axes, with the outward normal of the ground.
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
    /// Position from the centre of mass, m, body axes.
    pub position: R::Vec3,
    /// Radius, m, at least 0.
    pub radius: R,
}

impl<R: Real> ContactPoint<R> {
    /// Creates a contact of radius 0 at `position` (m, body axes, from the centre of mass).
    #[must_use]
    pub fn bare(position: R::Vec3) -> Self {
        Self {
            position,
            radius: R::ZERO,
        }
    }
}

/// Checks that every contact is finite and that no radius is negative.
///
/// # Errors
/// Returns [`SceneError`] for the first quantity that breaks a rule.
pub fn check_contacts<R: Real>(contacts: &[ContactPoint<R>]) -> Result<(), SceneError> {
    for contact in contacts {
        error::finite("x of a contact point", contact.position.x(), " m")?;
        error::finite("y of a contact point", contact.position.y(), " m")?;
        error::finite("z of a contact point", contact.position.z(), " m")?;
        error::at_least_zero("radius of a contact point", contact.radius, " m")?;
    }
    Ok(())
}

/// Checks all that a scene requires of a body, and returns its inertia.
///
/// # Errors
/// Returns [`SceneError`] for the first quantity that breaks a rule.
pub(crate) fn check_whole<R: Real>(
    body: &(impl RigidPointBody<R> + ?Sized),
) -> Result<InertiaProperties<R>, SceneError> {
    body.check()?;
    check_contacts(body.contacts())?;
    check_rims(body)?;
    let bounding_radius = body.bounding_radius();
    error::finite("bounding radius of the body", bounding_radius, " m")?;
    error::at_least_zero("bounding radius of the body", bounding_radius, " m")?;
    let inertia = inertia_of(body)?;
    check_reach(body)?;
    check_moving_contact(body)?;
    Ok(inertia)
}

/// Checks that no contact or rim is beyond the bounding radius, within `√ε` of it. The ground would
/// not see it until the bounding sphere touches.
fn check_reach<R: Real>(body: &(impl RigidPointBody<R> + ?Sized)) -> Result<(), SceneError> {
    let bounding_radius = body.bounding_radius();
    let most = bounding_radius + bounding_radius * R::EPSILON.sqrt();
    let contacts = body.contacts().iter();
    let places = contacts.map(|contact| (contact.position, contact.radius));
    let rims = body.rims().iter().map(|rim| (rim.farthest(), R::ZERO));
    for (place, radius) in places.chain(rims) {
        // In squares: a root of double precision is a large function where there is none.
        let room = most - radius;
        if room < R::ZERO || place.length_squared() > room * room {
            let beyond = place.length() + radius - bounding_radius;
            let quantity = "distance of a contact beyond the bounding radius of the body";
            let rule = Rule::AtMostZero;
            return Err(SceneError::new(quantity, rule, beyond.to_f64(), " m"));
        }
    }
    Ok(())
}

/// Checks that a smooth body has the one contact that represents the moving one.
fn check_moving_contact<R: Real>(
    body: &(impl RigidPointBody<R> + ?Sized),
) -> Result<(), SceneError> {
    let count = body.contacts().len();
    if !body.is_smooth() || count == 1 {
        return Ok(());
    }
    let quantity = "number of contacts of a smooth body";
    Err(SceneError::new(
        quantity,
        Rule::Exactly(1),
        count as f64,
        "",
    ))
}

/// Computes the inertia of a body, and checks it against [`RigidPointBody::is_symmetric`].
///
/// # Errors
/// Returns [`SceneError`] for the first quantity that breaks a rule.
pub(crate) fn inertia_of<R: Real>(
    body: &(impl RigidPointBody<R> + ?Sized),
) -> Result<InertiaProperties<R>, SceneError> {
    let inertia = InertiaProperties::new(body.mass(), body.inertia())?;
    if body.is_symmetric() && inertia.is_asymmetric() {
        return Err(SceneError::new(
            "number of different principal moments of a symmetric body",
            Rule::AtMost(2),
            3.0,
            "",
        ));
    }
    Ok(inertia)
}

/// Checks the rims of a body: each is valid, there are no more than allowed, and a smooth body has
/// none.
///
/// Also checks that a body with rims has no more contacts than allowed.
///
/// # Errors
/// Returns [`SceneError`] for the first quantity that breaks a rule.
pub fn check_rims<R: Real>(body: &(impl RigidPointBody<R> + ?Sized)) -> Result<(), SceneError> {
    let rims = body.rims();
    if rims.is_empty() {
        return Ok(());
    }
    for rim in rims {
        rim.check()?;
    }
    let at_most = |quantity, most, count: usize| {
        if count <= most {
            return Ok(());
        }
        let rule = Rule::AtMost(most);
        Err(SceneError::new(quantity, rule, count as f64, ""))
    };
    at_most("number of rims of a body", MOST_RIMS, rims.len())?;
    if body.is_smooth() {
        // The moving contact of a smooth body would replace each point of the rim.
        at_most("number of rims of a smooth body", 0, rims.len())?;
    }
    let contacts = body.contacts().len();
    at_most(
        "number of contacts of a body with a rim",
        BESIDE_RIMS,
        contacts,
    )
}

/// Most rims of a body. Each has room for 12 points in an implicit step, which is enough for the
/// two pieces of a short arc that are below the ground at its start or at its end.
pub(crate) const MOST_RIMS: usize = 8;

/// Most contacts of a body with rims. An implicit step stores 128 contacts and reserves 96 of them
/// for rims.
pub(crate) const BESIDE_RIMS: usize = 128 - 96;

/// Cyclic contact range: `first`, `first + 1`, ..., continuing at 0 after the last contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactRange {
    /// Number of the first contact of the range.
    pub first: usize,
    /// Number of contacts in the range.
    pub count: usize,
}

impl ContactRange {
    /// Empty range.
    pub const NONE: Self = Self { first: 0, count: 0 };

    /// Range of all `count` contacts.
    #[inline]
    #[must_use]
    pub const fn all(count: usize) -> Self {
        Self { first: 0, count }
    }

    /// Range from the first contact below the plane `normal · p = offset` to the last one. The
    /// plane is in body axes.
    fn spanning<R: Real>(contacts: &[ContactPoint<R>], normal: R::Vec3, offset: R) -> Self {
        // False for a plane that is NaN, so that no contact is omitted.
        let is_above =
            |contact: &ContactPoint<R>| normal.dot(contact.position) - contact.radius > offset;
        let Some(first) = contacts.iter().position(|contact| !is_above(contact)) else {
            return Self::NONE;
        };
        let last = contacts.iter().rposition(|contact| !is_above(contact));
        Self {
            first,
            count: last.map_or(0, |last| last + 1 - first),
        }
    }

    /// Contacts of this range that `other` does not contain, for a body of `contacts` contacts: at
    /// most two ranges.
    #[inline]
    #[must_use]
    pub(crate) fn without(self, other: Self, contacts: usize) -> [Self; 2] {
        let (range, other) = (self.within(contacts), other.within(contacts));
        if range.count == 0 || other.count == 0 {
            return [range, Self::NONE];
        }
        // A division for each remainder would take as long as two contacts.
        let once_round = |place: usize| {
            if place < contacts {
                place
            } else {
                place - contacts
            }
        };
        // Positions are counted cyclically from the start of this range. `other` covers [start,
        // start + its count), and the same interval one revolution earlier.
        let start = once_round(other.first + contacts - range.first);
        let end = start + other.count;
        let wrapped = end.saturating_sub(contacts);
        let after = end.min(range.count);
        let head = Self {
            first: once_round(range.first + wrapped),
            count: start.min(range.count).saturating_sub(wrapped),
        };
        let tail = Self {
            first: once_round(range.first + after),
            count: range.count - after.max(wrapped.min(range.count)),
        };
        [head, tail]
    }

    /// Range limited to a body with this many contacts, as [`parts`](Self::parts) reads it: it
    /// starts at an existing contact and covers each contact at most once.
    #[inline]
    pub(crate) fn within(self, contacts: usize) -> Self {
        Self {
            first: if self.first < contacts { self.first } else { 0 },
            count: self.count.min(contacts),
        }
    }

    /// Part of the range up to the last of `contacts`, and the part that continues at contact 0.
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
        assert_eq!(ContactRange::NONE.parts(&contacts), [&[0_i32; 0][..], &[]]);
    }

    #[test]
    fn without_a_hint_a_run_is_from_the_first_contact_below_a_plane_to_the_last() {
        let cube = crate::Cuboid::cube(1.0, 0.2).rounded(0.01);
        let contacts = cube.contacts();
        let directions = (0..200).map(|i: i32| {
            let [x, y, z] = [13, 29, 31].map(|step| f64::from(i * step % 97) - 48.0);
            glam::DVec3::new(x, y, z).normalize_or(glam::DVec3::Z)
        });
        for normal in directions {
            for offset in (-20..=20).map(|step| 0.01 * f64::from(step)) {
                let below =
                    |point: &ContactPoint| normal.dot(point.position) - point.radius <= offset;
                let range = cube.contacts_below(normal, offset);
                let inside = range.first..range.first + range.count;
                let low = || (0..contacts.len()).filter(|&i| below(&contacts[i]));
                assert!(low().all(|i| inside.contains(&i)));
                assert_eq!(low().min(), (range.count > 0).then_some(inside.start));
                assert_eq!(
                    low().max().map(|last| last + 1),
                    (range.count > 0).then_some(inside.end)
                );
            }
            assert_eq!(cube.contacts_below(normal, f64::NAN), ContactRange::all(8));
        }
    }

    #[test]
    fn what_a_run_holds_beyond_another_is_each_of_its_contacts_that_the_other_lacks_once() {
        const FIRSTS: [usize; 8] = [0, 1, 2, 3, 4, 5, 6, usize::MAX];
        const COUNTS: [usize; 7] = [0, 1, 2, 3, 4, 5, usize::MAX];
        let contacts = [0, 1, 2, 3, 4];
        let ranges = || {
            FIRSTS.into_iter().flat_map(|first| {
                COUNTS
                    .into_iter()
                    .map(move |count| ContactRange { first, count })
            })
        };
        for held in 0..=contacts.len() {
            let contacts = &contacts[..held];
            let has = |range: ContactRange, contact: &i32| {
                range.parts(contacts).concat().contains(contact)
            };
            for (range, other) in
                ranges().flat_map(|range| ranges().map(move |other| (range, other)))
            {
                let rest = range.without(other, held);
                let mut found = rest.map(|range| range.parts(contacts).concat()).concat();
                found.sort_unstable();
                let lacking = contacts
                    .iter()
                    .filter(|contact| has(range, contact) && !has(other, contact));
                assert!(
                    found.iter().eq(lacking),
                    "{held}: {range:?} without {other:?}: {rest:?}"
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
