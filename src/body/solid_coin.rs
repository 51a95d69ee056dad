//! Coin with a thickness: two rims.

use super::coin::{inertia_of_thick, lowest_guess, place_on_circle, walk_down};
use super::{CoinFace, ContactPoint, ContactRange, RigidPointBody, check_contacts};
use crate::error::{self, Rule, SceneError};
use crate::real::{Real, Vector};
use crate::state::State;

/// Coin with a thickness: a homogeneous cylinder with contact points on its two rims.
///
/// It can lie on a face, roll on one rim, and stand on both.
///
/// Body axes are as for [`Coin`](super::Coin): the coin's normal is x. The rims are at
/// `x = ±thickness/2`. Contact `2 k` is a point of the rim at -x, contact `2 k + 1` the opposite
/// point at +x. Moments: `m r²/2` about the normal, `m (3 r² + h²)/12` about a diameter, with the
/// thickness h.
///
/// *Limit:* each rim is a polygon with n points. It deviates from the circle by `r (1 - cos(π/n))`.
/// A [`ThickDisc`](super::ThickDisc) has two round rims.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidCoin<R: Real = f64, P = [ContactPoint<R>; 240]> {
    mass: R,
    radius: R,
    thickness: R,
    points: P,
}

impl<R: Real> SolidCoin<R> {
    /// Creates a coin with 120 points on each rim. Mass in kg, radius and thickness in m.
    #[must_use]
    pub fn new(mass: R, radius: R, thickness: R) -> Self {
        Self::new_with_storage([ContactPoint::default(); 240], mass, radius, thickness)
    }
}

impl<R: Real, P: AsRef<[ContactPoint<R>]> + AsMut<[ContactPoint<R>]>> SolidCoin<R, P> {
    /// Creates a coin with as many points as `storage` holds: an even number of at least 6, half of
    /// them on each rim. Mass in kg, radius and thickness in m.
    #[must_use]
    pub fn new_with_storage(mut storage: P, mass: R, radius: R, thickness: R) -> Self {
        let points = storage.as_mut();
        let count = points.len() / 2;
        let half = thickness * R::HALF;
        for (i, pair) in points.chunks_exact_mut(2).enumerate() {
            let (y, z) = place_on_circle(radius, i + 1, count);
            for (point, x) in pair.iter_mut().zip([-half, half]) {
                *point = ContactPoint::bare(R::Vec3::new(x, y, z));
            }
        }
        Self {
            mass,
            radius,
            thickness,
            points: storage,
        }
    }
}

impl<R: Real, P> SolidCoin<R, P> {
    /// Radius, m.
    #[inline]
    #[must_use]
    pub fn radius(&self) -> R {
        self.radius
    }

    /// Thickness, m.
    #[inline]
    #[must_use]
    pub fn thickness(&self) -> R {
        self.thickness
    }

    /// Angle between the coin's plane and the horizontal, rad: π/2 upright, 0 flat on either face.
    #[must_use]
    pub fn tilt(&self, state: &State<R>) -> R {
        super::coin::tilt(state)
    }

    /// Face that points up if the coin comes to rest from here without bouncing.
    ///
    /// Returns [`CoinFace::Edge`] if the centre of mass is above the edge, that is if
    /// `r |n_z| < (h/2) √(1 - n_z²)` with the normal n.
    ///
    /// A fraction `h/√(4 r² + h²)` of all orientations fulfils this condition.
    #[must_use]
    pub fn face_up(&self, state: &State<R>) -> CoinFace {
        CoinFace::of_thick(self.radius, self.thickness, state)
    }
}

impl<R: Real, P: AsRef<[ContactPoint<R>]>> RigidPointBody<R> for SolidCoin<R, P> {
    #[inline]
    fn mass(&self) -> R {
        self.mass
    }

    #[inline]
    fn inertia(&self) -> R::Mat3 {
        inertia_of_thick(self.mass, self.radius, self.thickness)
    }

    #[inline]
    fn is_symmetric(&self) -> bool {
        true
    }

    #[inline]
    fn contacts(&self) -> &[ContactPoint<R>] {
        self.points.as_ref()
    }

    #[inline]
    fn contacts_below(&self, normal: R::Vec3, offset: R) -> ContactRange {
        // Points of the lower rim count, because its arc below the plane is the longer one.
        // Opposite points are neighbours in the numbering.
        let offset = offset + normal.x().abs() * self.thickness * R::HALF;
        let (y, z) = (normal.y() * self.radius, normal.z() * self.radius);
        if offset * offset > y * y + z * z {
            return if offset > R::ZERO {
                ContactRange::all(self.points.as_ref().len())
            } else {
                ContactRange::NONE
            };
        }
        let pairs = self.pairs_below(normal, offset);
        ContactRange {
            first: 2 * pairs.first,
            count: 2 * pairs.count,
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("mass of the coin", self.mass, " kg")?;
        error::above_zero("radius of the coin", self.radius, " m")?;
        error::above_zero("thickness of the coin", self.thickness, " m")?;
        let count = self.points.as_ref().len();
        let refuse = |rule| {
            let count = R::from_usize(count).to_f64();
            SceneError::new("number of points of the coin", rule, count, "")
        };
        if count < 6 {
            return Err(refuse(Rule::AtLeast(6)));
        }
        if count % 2 == 1 {
            return Err(refuse(Rule::Even));
        }
        check_contacts(self.points.as_ref())
    }
}

impl<R: Real, P: AsRef<[ContactPoint<R>]>> SolidCoin<R, P> {
    /// Range of pairs of opposite points that are below a plane, as measured across the coin's
    /// normal. It is found from the lowest pair outwards to both sides.
    #[inline]
    fn pairs_below(&self, normal: R::Vec3, offset: R) -> ContactRange {
        let points = self.points.as_ref();
        let count = points.len() / 2;
        if count == 0 {
            return ContactRange::NONE;
        }
        let height = |pair: usize| {
            points.get(2 * pair).map_or(R::MAX, |point| {
                point.position.y() * normal.y() + point.position.z() * normal.z()
            })
        };
        let guess = lowest_guess(count, -normal.y(), -normal.z());
        let lowest = walk_down(count, guess, height);
        let is_below = |steps: &usize| height((lowest + *steps) % count) < offset;
        let ahead = (0..count).take_while(is_below).count();
        let behind = (1..=count - ahead)
            .take_while(|steps| is_below(&(count - steps)))
            .count();
        ContactRange {
            first: (lowest + count - behind) % count,
            count: ahead + behind,
        }
    }
}
