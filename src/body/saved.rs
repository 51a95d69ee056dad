//! Bodies as plain data, with the feature `serde`.
//!
//! A saved body consists of the arguments of its constructor. All other values are computed again
//! when the body is loaded, with the same bits.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{
    Capsule, Coin, Cone, ContactPoint, Cuboid, Disc, Ellipsoid, InertiaProperties, MassProperties,
    PointMass, RigidPointBody, Rod, SolidCoin, Sphere, check_contacts,
};
use crate::real::Real;

/// Storage for the contacts of a loaded body: an array, or a `Vec` with the feature `std`.
pub trait Storage<R: Real>: AsRef<[ContactPoint<R>]> + AsMut<[ContactPoint<R>]> + Sized {
    /// Returns storage for `count` contacts, or `None` if it cannot hold exactly that many.
    #[doc(hidden)]
    fn for_contacts(count: usize) -> Option<Self>;
}

impl<R: Real, const N: usize> Storage<R> for [ContactPoint<R>; N] {
    fn for_contacts(count: usize) -> Option<Self> {
        (count == N).then(|| [ContactPoint::default(); N])
    }
}

#[cfg(feature = "std")]
impl<R: Real> Storage<R> for alloc::vec::Vec<ContactPoint<R>> {
    /// Returns at most 2²⁴ contacts, so that a number in a file cannot exhaust the memory.
    fn for_contacts(count: usize) -> Option<Self> {
        (count <= 1 << 24).then(|| alloc::vec![ContactPoint::default(); count])
    }
}

fn storage<R: Real, P: Storage<R>, E: Error>(count: usize) -> Result<P, E> {
    let unfit = || {
        E::custom(format_args!(
            "the storage of the body cannot hold {count} contacts"
        ))
    };
    P::for_contacts(count).ok_or_else(unfit)
}

/// Checks that a scene can be composed with the body, and returns the body.
fn checked<R: Real, B: RigidPointBody<R>, E: Error>(body: B) -> Result<B, E> {
    body.check().map_err(E::custom)?;
    check_contacts(body.contacts()).map_err(E::custom)?;
    super::check_rims(&body).map_err(E::custom)?;
    InertiaProperties::new(body.mass(), body.inertia()).map_err(E::custom)?;
    Ok(body)
}

/// Implements saving and loading of one type of body, with named fields.
macro_rules! saved {
    (
        $body:ident $(<$storage:ident>)?, ($($field:ident: $type:ty),*),
        |$this:ident| [$($value:expr),*], $build:expr
    ) => {
        const _: () = {
            #[derive(Serialize, Deserialize)]
            #[serde(rename = "Body", bound(
                serialize = "R: Serialize, R::Vec3: Serialize, R::Mat3: Serialize",
                deserialize = "R: Deserialize<'de>, R::Vec3: Deserialize<'de>, \
                    R::Mat3: Deserialize<'de>"
            ))]
            struct Parts<R: Real> {
                $($field: $type),*
            }

            impl<R: Real $(, $storage: AsRef<[ContactPoint<R>]>)?> Serialize for $body<R $(, $storage)?>
            where
                R: Serialize,
                R::Vec3: Serialize,
                R::Mat3: Serialize,
            {
                fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                    let $this = self;
                    Parts::<R> { $($field: $value),* }.serialize(serializer)
                }
            }

            impl<'de, R: Real $(, $storage: Storage<R>)?> Deserialize<'de> for $body<R $(, $storage)?>
            where
                R: Deserialize<'de>,
                R::Vec3: Deserialize<'de>,
                R::Mat3: Deserialize<'de>,
            {
                fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                    let Parts { $($field),* } = Parts::<R>::deserialize(deserializer)?;
                    checked($build)
                }
            }
        };
    };
}

saved!(Coin<P>, (mass: R, radius: R, points: usize),
    |coin| [coin.mass(), coin.radius(), coin.contacts().len()],
    Coin::ring_with_storage(storage::<R, P, D::Error>(points)?, mass, radius));
saved!(SolidCoin<P>, (mass: R, radius: R, thickness: R, points: usize),
    |coin| [coin.mass(), coin.radius(), coin.thickness(), coin.contacts().len()],
    SolidCoin::new_with_storage(storage::<R, P, D::Error>(points)?, mass, radius, thickness));
saved!(Cone<P>, (mass: R, radius: R, height: R, points: usize),
    |cone| [cone.mass(), cone.radius(), cone.height(), cone.contacts().len()],
    Cone::solid_with_storage(storage::<R, P, D::Error>(points)?, mass, radius, height));
saved!(Disc, (mass: R, radius: R, points: usize, solid: bool),
|disc| [disc.mass(), disc.radius(), disc.points(), disc.is_solid()],
if solid {
    Disc::solid(mass, radius, points)
} else {
    Disc::ring(mass, radius, points)
});
saved!(Cuboid, (edges: R::Vec3, corner_radius: R, distribution: MassProperties<R>),
    |cuboid| [cuboid.edges(), cuboid.corner_radius(), cuboid.distribution],
    Cuboid::loaded(edges, distribution).rounded(corner_radius));
saved!(Sphere, (radius: R, distribution: MassProperties<R>),
    |sphere| [sphere.radius(), sphere.distribution],
    Sphere::loaded(radius, distribution));
saved!(Ellipsoid, (semi_axes: R::Vec3, distribution: MassProperties<R>),
    |ellipsoid| [ellipsoid.semi_axes(), ellipsoid.distribution],
    Ellipsoid::loaded(semi_axes, distribution));
saved!(Capsule, (mass: R, radius: R, length: R),
    |capsule| [capsule.mass(), capsule.radius(), capsule.length()],
    Capsule::solid(mass, radius, length));
saved!(Rod, (mass: R, length: R),
    |rod| [rod.mass(), rod.length()],
    Rod::new(mass, length));
saved!(PointMass, (mass: R), |point| [point.mass()], PointMass::new(mass));
