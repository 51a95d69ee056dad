//! Coin of the coin report: a ring of points.

use super::{ContactPoint, ContactRange, RigidPointBody, check_contacts, homogeneous};
use crate::error::{self, Rule, SceneError};
use crate::real::{Matrix, Real, Vector};
use crate::state::State;

/// Coin whose mass and contacts lie on its rim: `n` equal points on a circle, as in the coin
/// report.
///
/// Body axes: the coin's normal is x and the rim lies in the yz plane. Point k = 1 ... n is at
/// `(0, r cos(2πk/n), r sin(2πk/n))` and has the contact number `k - 1`. For any n of at least 3
/// the moments are exactly `m r²` about the normal and `m r²/2` about a diameter.
///
/// *Limit:* the rim is a polygon. As the upright coin rolls, its centre rises and falls by
/// `r (1 - cos(π/n))`. This is 1.7e-4 m for the 120 points of the coin report and r = 0.5 m. With
/// few points the coin rattles from corner to corner. [`Disc`](super::Disc) is round, and its
/// documentation states which of the two is better in which case. On both, several points touch at
/// once. Their friction resists the rotation about the vertical, so that a leaning coin rolls round
/// a wider circle than a hoop that touches at one point.
///
/// `P` stores the points: an array, a borrowed slice, or a `Vec`.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Coin, Coulomb, CoinFace, FlatGround, State, Stepper, UniformGravity};
///
/// let coin = Coin::ring(1.0, 0.5); // kg, m
/// let stepper = Stepper::builder(coin)
///     .ground(FlatGround::level(1000.0, 0.5)) // N/m and N s/m a point
///     .friction(Coulomb { coefficient: 0.3, slip_speed: 1e-3 }) // m/s
///     .gravity(UniformGravity::down(9.8)) // m/s²
///     .build()?;
/// // Dropped from 0.7 m, heads up and leaning, with a spin of 6 rad/s about its normal.
/// let state = State::at(DVec3::new(0.0, 0.0, 0.7)).with_rotation_vector(DVec3::new(0.0, -1.2, 0.0));
/// let mut state = stepper.with_angular_velocity(state, state.orientation * DVec3::X * 6.0);
/// assert_eq!(coin.face_up(&state), CoinFace::Heads);
/// stepper.advance(&mut state, 0.5)?; // s
/// println!("{:.2} rad from flat, {} of 120 points touch", coin.tilt(&state), stepper.touching(&state));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coin<R: Real = f64, P = [ContactPoint<R>; 120]> {
    mass: R,
    radius: R,
    points: P,
}

impl<R: Real> Coin<R> {
    /// Creates a ring of 120 points, as in the coin report. Mass in kg, radius in m.
    #[must_use]
    pub fn ring(mass: R, radius: R) -> Self {
        Self::ring_with_storage([ContactPoint::default(); 120], mass, radius)
    }
}

impl<R: Real, P: AsRef<[ContactPoint<R>]> + AsMut<[ContactPoint<R>]>> Coin<R, P> {
    /// Creates a ring of as many points as `storage` holds, at least 3. Mass in kg, radius in m.
    ///
    /// ```
    /// use tumble::{Coin, ContactPoint};
    /// let coarse = Coin::ring_with_storage([ContactPoint::default(); 12], 1.0, 0.5);
    /// let fine = Coin::ring_with_storage(vec![ContactPoint::default(); 1200], 1.0, 0.5);
    /// ```
    #[must_use]
    pub fn ring_with_storage(mut storage: P, mass: R, radius: R) -> Self {
        let points = storage.as_mut();
        let count = points.len();
        for (i, point) in points.iter_mut().enumerate() {
            let (y, z) = place_on_circle(radius, i + 1, count);
            *point = ContactPoint::bare(R::Vec3::new(R::ZERO, y, z));
        }
        Self {
            mass,
            radius,
            points: storage,
        }
    }
}

impl<R: Real, P> Coin<R, P> {
    /// Radius of the rim, m.
    #[inline]
    #[must_use]
    pub fn radius(&self) -> R {
        self.radius
    }

    /// Angle between the coin's plane and the horizontal, rad: π/2 upright, 0 flat on either face.
    #[must_use]
    pub fn tilt(&self, state: &State<R>) -> R {
        tilt(state)
    }

    /// Face that points up.
    ///
    /// Returns [`CoinFace::Edge`] if neither face does, which is the case for a coin upright to
    /// rounding. A ring has no edge to stand on, in contrast to a [`SolidCoin`](super::SolidCoin).
    #[must_use]
    pub fn face_up(&self, state: &State<R>) -> CoinFace {
        CoinFace::up(state.rotation().axes().x.z())
    }
}

/// Angle between the plane across body x and the horizontal, rad.
pub(super) fn tilt<R: Real>(state: &State<R>) -> R {
    let normal = state.rotation().axes().x;
    let level = (normal.x() * normal.x() + normal.y() * normal.y()).sqrt();
    level.atan2(normal.z().abs())
}

/// Point k = 1 ... n of a circle: `(r cos(2πk/n), r sin(2πk/n))`.
pub(super) fn place_on_circle<R: Real>(radius: R, k: usize, count: usize) -> (R, R) {
    let step = R::from_f64(core::f64::consts::TAU) / R::from_usize(count);
    let (sin, cos) = (step * R::from_usize(k)).sin_cos();
    (radius * cos, radius * sin)
}

impl<R: Real, P: AsRef<[ContactPoint<R>]>> RigidPointBody<R> for Coin<R, P> {
    #[inline]
    fn mass(&self) -> R {
        self.mass
    }

    #[inline]
    fn inertia(&self) -> R::Mat3 {
        let normal = self.mass * self.radius * self.radius;
        let diameter = normal * R::HALF;
        R::Mat3::from_diagonal(R::Vec3::new(normal, diameter, diameter))
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
    fn bounding_radius(&self) -> R {
        self.radius
    }

    #[inline]
    fn contacts_below(&self, normal: R::Vec3, offset: R) -> ContactRange {
        self.contacts_below_near(normal, offset, ContactRange::NONE)
    }

    #[inline]
    fn contacts_below_near(&self, normal: R::Vec3, offset: R, near: ContactRange) -> ContactRange {
        let points = self.points.as_ref();
        let (y, z) = (normal.y() * self.radius, normal.z() * self.radius);
        // The lowest point of the continuous rim is at -|(y, z)|, the highest at +|(y, z)|.
        let extent = y * y + z * z;
        if offset * offset > extent {
            return if offset > R::ZERO {
                ContactRange::all(points.len())
            } else {
                ContactRange::NONE
            };
        }
        arc_near(points, normal, offset, near).unwrap_or_else(|| arc_below(points, normal, offset))
    }

    /// Heights along the ring have one minimum and one maximum. So the contacts below a plane are
    /// one arc, and these are its ends.
    #[inline]
    fn range_ends(&self, range: ContactRange) -> Option<[R::Vec3; 4]> {
        let points = self.points.as_ref();
        let after = range.first.checked_add(range.count)?;
        let places = [
            range.first.checked_sub(1)?,
            range.first,
            after.checked_sub(1)?,
            after,
        ];
        let [before, first, last, after] = places.map(|place| points.get(place));
        Some([before?, first?, last?, after?].map(|point| point.position))
    }

    /// Support function of the round rim, which encloses the points.
    #[inline]
    fn support(&self, direction: R::Vec3) -> R {
        let (y, z) = (direction.y(), direction.z());
        // A point of the rim may lie outside the circle by rounding.
        self.radius * (y * y + z * z).sqrt() * (R::ONE + R::EPSILON * R::from_f64(4.0))
    }

    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("mass of the coin", self.mass, " kg")?;
        error::above_zero("radius of the coin", self.radius, " m")?;
        let count = self.points.as_ref().len();
        if count < 3 {
            return Err(SceneError::new(
                "number of points of the coin",
                Rule::AtLeast(3),
                R::from_usize(count).to_f64(),
                "",
            ));
        }
        check_contacts(self.points.as_ref())
    }
}

/// Arc of a ring below a plane, found by a walk from a guess of the lowest point to both sides.
///
/// The walk continues while points are below the plane.
///
/// Heights along a ring have one minimum. So no other point is visited and no arc is missed.
#[inline]
fn arc_below<R: Real>(points: &[ContactPoint<R>], normal: R::Vec3, offset: R) -> ContactRange {
    let guess = lowest_guess(points.len(), -normal.y(), -normal.z());
    let range = arc_around(points, guess, |point| height(point, normal) < offset);
    if range.count > 0 {
        return range;
    }
    // A shallow arc may lie next to the guess.
    let height_of = |i: usize| (points.get(i)).map_or(R::MAX, |point| height(point, normal));
    let lowest = walk_down(points.len(), guess, height_of);
    arc_around(points, lowest, |point| height(point, normal) < offset)
}

/// Arc of a ring below a plane, found by a walk from both ends of a known arc.
///
/// Returns `None` if the walk finds no end of the arc, or if it would cross the ring's first point.
#[inline]
fn arc_near<R: Real>(
    points: &[ContactPoint<R>],
    normal: R::Vec3,
    offset: R,
    near: ContactRange,
) -> Option<ContactRange> {
    let below = |place: usize| Some(height(points.get(place)?, normal) < offset);
    let (mut first, mut last) = (
        near.first,
        near.first.checked_add(near.count)?.checked_sub(1)?,
    );
    if below(first)? {
        while below(first.checked_sub(1)?)? {
            first -= 1;
        }
    } else {
        while !below(first)? {
            first += 1;
        }
    }
    if below(last)? {
        while below(last + 1)? {
            last += 1;
        }
    } else {
        while !below(last)? {
            last = last.checked_sub(1)?;
        }
    }
    let count = last.checked_sub(first)? + 1;
    Some(ContactRange { first, count })
}

/// Height of a point of the ring along a direction, m.
#[inline(always)]
fn height<R: Real>(point: &ContactPoint<R>, normal: R::Vec3) -> R {
    point.position.y() * normal.y() + point.position.z() * normal.z()
}

/// Longest contact range around `middle` whose points are all `below`. It is empty if the middle
/// itself is not below.
#[inline]
fn arc_around<T>(points: &[T], middle: usize, below: impl Fn(&T) -> bool) -> ContactRange {
    let (before, after) = points.split_at_checked(middle).unwrap_or_default();
    let ahead = (after.iter().chain(before))
        .take_while(|point| below(point))
        .count();
    if ahead == 0 || ahead == points.len() {
        return ContactRange::all(ahead);
    }
    let behind = (before.iter().rev().chain(after.iter().rev()))
        .take_while(|point| below(point))
        .count();
    ContactRange {
        first: if behind > middle {
            middle + points.len() - behind
        } else {
            middle - behind
        },
        count: ahead + behind,
    }
}

/// Number of the lowest of `count` points on a ring, found downhill from `start`.
pub(super) fn walk_down<R: Real>(count: usize, start: usize, height: impl Fn(usize) -> R) -> usize {
    let after = |i: usize| if i + 1 < count { i + 1 } else { 0 };
    let before = |i: usize| if i > 0 { i - 1 } else { count.wrapping_sub(1) };

    let (mut lowest, mut low) = (start, height(start));
    // At most one revolution, for any values.
    for _ in 0..count {
        let (a, b) = (after(lowest), before(lowest));
        let (up, down) = (height(a), height(b));
        if up < low {
            (lowest, low) = (a, up);
        } else if down < low {
            (lowest, low) = (b, down);
        } else {
            break;
        }
    }
    lowest
}

/// Number of the ring's point nearest to the direction (`y`, `z`), or of a neighbour of it.
///
/// The angle is `atan t ≈ t (π/4 + 0.273 (1 - t))` in an eighth of a revolution. It is accurate to
/// 0.0038 rad (Rajan et al., IEEE Signal Processing Magazine 23(3), 2006). This error is a tenth of
/// the spacing of 120 points. The caller walks on from there.
#[inline]
pub(super) fn lowest_guess<R: Real>(count: usize, y: R, z: R) -> usize {
    let c = R::from_f64;
    let (along, across) = (y.abs(), z.abs());
    let steep = across > along;
    let t = if steep {
        along / across
    } else {
        across / along
    };
    let eighth = t * (c(0.125) + c(0.273 / core::f64::consts::TAU) * (R::ONE - t));
    let quarter = if steep { c(0.25) - eighth } else { eighth };
    let half = if y < R::ZERO {
        R::HALF - quarter
    } else {
        quarter
    };
    let turns = if z < R::ZERO { R::ONE - half } else { half };
    // Point k = 1 ... n is at k/n revolutions and is contact k - 1.
    let k = (turns * R::from_usize(count) + R::HALF).floor_index();
    if k == 0 || k > count {
        count.wrapping_sub(1)
    } else {
        k - 1
    }
}

/// Side of a coin that points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum CoinFace {
    /// The face on the side of body x.
    Heads,
    /// The face on the side of body -x.
    Tails,
    /// Neither face: the coin stands upright on its rim.
    Edge,
}

/// In words, for example `heads`.
impl core::fmt::Display for CoinFace {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Self::Heads => "heads",
            Self::Tails => "tails",
            Self::Edge => "edge",
        })
    }
}

impl CoinFace {
    /// Face that points up, by the z component of the unit vector out of heads.
    pub(super) fn up<R: Real>(up: R) -> Self {
        // Within the rounding of a unit vector, the normal is horizontal and points to neither
        // side.
        if up > R::EPSILON {
            Self::Heads
        } else if up < -R::EPSILON {
            Self::Tails
        } else {
            Self::Edge
        }
    }

    /// Face of a coin with this radius and thickness (m) that points up if it comes to rest without
    /// bouncing. It is the edge if the centre of mass is above the edge.
    pub(super) fn of_thick<R: Real>(radius: R, thickness: R, state: &State<R>) -> Self {
        let normal = state.rotation().axes().x;
        let level = (normal.x() * normal.x() + normal.y() * normal.y()).sqrt();
        if radius * normal.z().abs() < thickness * R::HALF * level {
            Self::Edge
        } else {
            Self::up(normal.z())
        }
    }
}

/// Inertia tensor of a homogeneous cylinder along x, kg m².
#[inline]
pub(super) fn inertia_of_thick<R: Real>(mass: R, radius: R, thickness: R) -> R::Mat3 {
    // The cylinder's z is the coin's x.
    let cylinder = homogeneous::cylinder(mass, radius, thickness);
    let [across, _, along] = cylinder.inertia.columns();
    R::Mat3::from_diagonal(R::Vec3::new(along.z(), across.x(), across.x()))
}

#[cfg(test)]
mod tests {
    #![allow(
        clippy::float_cmp,
        reason = "the angle of an upright coin is exact: it has no number to round"
    )]

    use super::*;
    use glam::{DQuat, DVec3};

    fn ring<const N: usize>() -> Coin<f64, [ContactPoint; N]> {
        Coin::ring_with_storage([ContactPoint::default(); N], 1.0, 0.5)
    }

    /// Checks that the range contains exactly the contacts below the plane.
    fn the_arc_is_right<const N: usize>() {
        let coin = ring::<N>();
        for step in 0..1000 {
            let turn = DQuat::from_scaled_axis(DVec3::new(
                0.017 * f64::from(step),
                0.3 * f64::from(step % 7),
                -0.11 * f64::from(step),
            ));
            let normal = turn * DVec3::Z;
            for offset in [-0.6, -0.499, -0.4, -0.01, 0.0, 0.3, 0.6] {
                let range = coin.contacts_below(normal, offset);
                let inside = |i: usize| (i + N - range.first) % N < range.count;
                for (i, contact) in coin.contacts().iter().enumerate() {
                    let below = normal.dot(contact.position) < offset;
                    assert_eq!(
                        below,
                        inside(i),
                        "N {N} step {step} offset {offset} contact {i} {range:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn walking_finds_the_arc_that_visiting_every_point_finds() {
        the_arc_is_right::<3>();
        the_arc_is_right::<4>();
        the_arc_is_right::<12>();
        the_arc_is_right::<120>();
        the_arc_is_right::<1200>();
    }

    #[test]
    fn from_a_known_arc_the_same_arc_is_found() {
        let coin = ring::<120>();
        let (mut near, mut sooner) = (ContactRange::NONE, 0);
        for step in 0..10_000 {
            // Rolls by a third of the spacing of two points, with changing penetration depth and
            // tilt.
            let step = f64::from(step);
            let turn = DQuat::from_rotation_x(0.0175 * step)
                * DQuat::from_rotation_y(0.05 * (0.01 * step).sin());
            let normal = turn.inverse() * DVec3::Z;
            let offset = -0.5 * (1.0 - 0.01 * (1.0 + (0.03 * step).cos()));
            let range = coin.contacts_below(normal, offset);
            let from_afar = ContactRange {
                first: range.first + 60,
                count: 7,
            };
            let endless = ContactRange {
                first: range.first + 2,
                count: usize::MAX,
            };
            for known in [near, range, from_afar, endless, ContactRange::all(120)] {
                assert_eq!(
                    coin.contacts_below_near(normal, offset, known),
                    range,
                    "{known:?}"
                );
            }
            sooner += usize::from(arc_near(coin.contacts(), normal, offset, near).is_some());
            near = range;
        }
        // Except for arcs across the ring's first point, and short arcs.
        assert!(sooner > 6000, "{sooner}");
    }

    #[test]
    fn the_points_have_the_moments_that_the_constructor_states() {
        let coin = ring::<7>();
        let mut moments = DVec3::ZERO;
        for contact in coin.contacts() {
            let p = contact.position;
            moments += DVec3::new(
                p.y * p.y + p.z * p.z,
                p.x * p.x + p.z * p.z,
                p.x * p.x + p.y * p.y,
            ) / 7.0;
        }
        assert!((moments - DVec3::new(0.25, 0.125, 0.125)).length() < 1e-15);
    }

    #[test]
    fn tilt_and_face_are_those_of_the_normal() {
        let coin = ring::<12>();
        let upright = State::at(DVec3::ZERO);
        assert_eq!(coin.tilt(&upright), core::f64::consts::FRAC_PI_2);
        assert_eq!(coin.face_up(&upright), CoinFace::Edge);
        let heads = upright.with_rotation_vector(DVec3::new(0.0, -0.3, 0.0));
        assert!((coin.tilt(&heads) - (core::f64::consts::FRAC_PI_2 - 0.3)).abs() < 1e-15);
        assert_eq!(coin.face_up(&heads), CoinFace::Heads);
        assert_eq!(
            coin.face_up(&upright.with_rotation_vector(DVec3::new(0.0, 0.3, 0.0))),
            CoinFace::Tails
        );
    }
}
