//! Bodies as plain data, with the feature `serde`.
//!
//! A saved body consists of the arguments of its constructor. All other values are computed again
//! when the body is loaded, with the same bits. `PointCloud` and `Solid` are saved as they are,
//! since their contacts have been shifted to the centre of mass.

use core::fmt;
use core::marker::PhantomData;

use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{
    Capsule, Coin, Cone, ContactPoint, Cuboid, Disc, Ellipsoid, MassProperties, PointCloud,
    PointMass, RigidPointBody, Rod, Solid, SolidCoin, Sphere, ThickDisc,
};
use crate::error::{self, Rule, SceneError};
use crate::real::{Real, Vector};

/// Storage for the contacts of a loaded body: an array, or a `Vec` with the feature `std`.
pub trait Storage<R: Real>: AsRef<[ContactPoint<R>]> + AsMut<[ContactPoint<R>]> + Sized {
    /// Returns storage for `count` contacts, or `None` if it cannot hold exactly that many.
    #[doc(hidden)]
    fn for_contacts(count: usize) -> Option<Self>;

    /// Reads all contacts of a list.
    #[doc(hidden)]
    fn read<'de, A: SeqAccess<'de>>(list: A) -> Result<Self, A::Error>
    where
        ContactPoint<R>: Deserialize<'de>;
}

/// Largest number of contacts that is loaded, so that a file cannot exhaust the memory.
#[cfg(feature = "std")]
const MOST_CONTACTS: usize = 1 << 24;
/// Largest number of contacts that are computed from a few numbers of a file.
#[cfg(feature = "std")]
const MOST_COMPUTED: usize = 1 << 20;

impl<R: Real, const N: usize> Storage<R> for [ContactPoint<R>; N] {
    fn for_contacts(count: usize) -> Option<Self> {
        (count == N).then(|| [ContactPoint::default(); N])
    }

    fn read<'de, A: SeqAccess<'de>>(mut list: A) -> Result<Self, A::Error>
    where
        ContactPoint<R>: Deserialize<'de>,
    {
        let unfit = || A::Error::custom(format_args!("the body must have {N} contacts"));
        let mut contacts = [ContactPoint::default(); N];
        for contact in &mut contacts {
            *contact = list.next_element()?.ok_or_else(unfit)?;
        }
        match list.next_element::<ContactPoint<R>>()? {
            None => Ok(contacts),
            Some(_) => Err(unfit()),
        }
    }
}

#[cfg(feature = "std")]
impl<R: Real> Storage<R> for alloc::vec::Vec<ContactPoint<R>> {
    fn for_contacts(count: usize) -> Option<Self> {
        (count <= MOST_COMPUTED).then(|| alloc::vec![ContactPoint::default(); count])
    }

    fn read<'de, A: SeqAccess<'de>>(mut list: A) -> Result<Self, A::Error>
    where
        ContactPoint<R>: Deserialize<'de>,
    {
        let mut contacts = Self::new();
        while let Some(contact) = list.next_element()? {
            if contacts.len() == MOST_CONTACTS {
                return Err(A::Error::custom(format_args!(
                    "the body has more than {MOST_CONTACTS} contacts"
                )));
            }
            contacts.push(contact);
        }
        Ok(contacts)
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
    super::check_whole(&body).map_err(E::custom)?;
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
saved!(ThickDisc, (mass: R, radius: R, thickness: R, points: usize),
    |disc| [disc.mass(), disc.radius(), disc.thickness(), disc.points()],
    ThickDisc::solid(mass, radius, thickness, points));
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

/// Contacts as a list.
struct List<R, P>(P, PhantomData<R>);

impl<R: Real, P: AsRef<[ContactPoint<R>]>> Serialize for List<R, P>
where
    ContactPoint<R>: Serialize,
{
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.as_ref())
    }
}

impl<'de, R: Real, P: Storage<R>> Deserialize<'de> for List<R, P>
where
    ContactPoint<R>: Deserialize<'de>,
{
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader<R, P>(PhantomData<(R, P)>);

        impl<'de, R: Real, P: Storage<R>> Visitor<'de> for Reader<R, P>
        where
            ContactPoint<R>: Deserialize<'de>,
        {
            type Value = P;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of contacts")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<P, A::Error> {
                P::read(list)
            }
        }

        let contacts = deserializer.deserialize_seq(Reader(PhantomData))?;
        Ok(Self(contacts, PhantomData))
    }
}

/// Implements saving and loading of a body that stores its contacts, field by field.
macro_rules! saved_with_contacts {
    (
        $body:ident, ($($field:ident: $type:ty),*), $contacts:ident,
        |$loaded:ident| $check:expr
    ) => {
        const _: () = {
            #[derive(Serialize, Deserialize)]
            #[serde(rename = "Body", bound(
                serialize = "R: Serialize, R::Vec3: Serialize, R::Mat3: Serialize, \
                    P: AsRef<[ContactPoint<R>]>",
                deserialize = "R: Deserialize<'de>, R::Vec3: Deserialize<'de>, \
                    R::Mat3: Deserialize<'de>, P: Storage<R>"
            ))]
            struct Parts<R: Real, P> {
                $($field: $type,)*
                $contacts: List<R, P>,
            }

            impl<R: Real, P: AsRef<[ContactPoint<R>]>> Serialize for $body<R, P>
            where
                R: Serialize,
                R::Vec3: Serialize,
                R::Mat3: Serialize,
            {
                fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                    Parts {
                        $($field: self.$field,)*
                        $contacts: List(self.$contacts.as_ref(), PhantomData),
                    }
                    .serialize(serializer)
                }
            }

            impl<'de, R: Real, P: Storage<R>> Deserialize<'de> for $body<R, P>
            where
                R: Deserialize<'de>,
                R::Vec3: Deserialize<'de>,
                R::Mat3: Deserialize<'de>,
            {
                fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                    let parts = Parts::<R, P>::deserialize(deserializer)?;
                    let $loaded = Self {
                        $($field: parts.$field,)*
                        $contacts: parts.$contacts.0,
                    };
                    $check.map_err(D::Error::custom)?;
                    checked($loaded)
                }
            }
        };
    };
}

saved_with_contacts!(PointCloud, (mass: R, inertia: R::Mat3, centre: R::Vec3), points,
    |cloud| finite_centre::<R>(cloud.centre)
        .and_then(|()| at_least_one("number of points", &cloud.points)));
saved_with_contacts!(Solid, (distribution: MassProperties<R>), contacts,
    |solid| solid.distribution.check()
        .and_then(|()| at_least_one("number of contacts", &solid.contacts)));

/// Checks that the centre of mass of a body from a file is finite.
fn finite_centre<R: Real>(centre: R::Vec3) -> Result<(), SceneError> {
    error::finite("x of the centre of mass", centre.x(), " m")?;
    error::finite("y of the centre of mass", centre.y(), " m")?;
    error::finite("z of the centre of mass", centre.z(), " m")
}

/// Checks that a body from a file has contacts, as its constructors require.
fn at_least_one<R: Real, P: AsRef<[ContactPoint<R>]>>(
    quantity: &'static str,
    contacts: &P,
) -> Result<(), SceneError> {
    if contacts.as_ref().is_empty() {
        Err(SceneError::new(quantity, Rule::AtLeast(1), 0.0, ""))
    } else {
        Ok(())
    }
}
