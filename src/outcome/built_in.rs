//! Faces of the built-in coins and of the cuboid, in closed form.

use super::{Basin, Faces};
use crate::body::{
    Coin, CoinFace, ContactPoint, Cuboid, CuboidFace, Disc, RigidPointBody, SolidCoin, ThickDisc,
};
use crate::real::{Real, Vector};

/// Face of a thin coin over which body x points up, for the direction that points down.
fn thin<R: Real>(down: R::Vec3) -> CoinFace {
    if down.x() < R::ZERO {
        CoinFace::Heads
    } else {
        CoinFace::Tails
    }
}

/// Smallest extent of a ring of `count` points in any direction of its plane, m: `r cos(π/n)`.
fn inscribed<R: Real>(radius: R, count: usize) -> R {
    let (_, cos) = (R::from_f64(core::f64::consts::PI) / R::from_usize(count)).sin_cos();
    radius * cos
}

/// Heads and tails. Between them the coin is upright, on a point or between two: `r cos(π/n)`.
impl<R: Real, P: AsRef<[ContactPoint<R>]>> Faces<R> for Coin<R, P> {
    type Face = CoinFace;

    #[inline]
    fn basin(&self, down: R::Vec3) -> Option<Basin<CoinFace, R>> {
        Some(Basin {
            face: thin::<R>(down),
            height: inscribed(self.radius(), self.contacts().len()),
        })
    }
}

/// Heads and tails. Between them the disc is upright: `r`.
impl<R: Real> Faces<R> for Disc<R> {
    type Face = CoinFace;

    #[inline]
    fn basin(&self, down: R::Vec3) -> Option<Basin<CoinFace, R>> {
        Some(Basin {
            face: thin::<R>(down),
            height: self.radius(),
        })
    }
}

/// Heads, tails and edge, as [`SolidCoin::face_up`] tells them apart.
///
/// Between edge and face the centre of mass is above a rim, with the normal at the angle
/// `tan θ = 2 r/h` from the vertical. With the thickness h and n points on each rim, the height is
/// at least `(h/2) cos θ + r cos(π/n) sin θ = (h²/4 + r² cos(π/n))/√(r² + h²/4)`.
///
/// The edge is decided only on a ground so hard that its barrier exceeds the energy of a coin at
/// rest on it: about `m g h²/(8 r)` must exceed the energy that the body gains by sinking in.
impl<R: Real, P: AsRef<[ContactPoint<R>]>> Faces<R> for SolidCoin<R, P> {
    type Face = CoinFace;

    fn basin(&self, down: R::Vec3) -> Option<Basin<CoinFace, R>> {
        let extent = inscribed(self.radius(), self.contacts().len() / 2);
        Some(thick(down, [self.radius(), self.thickness()], extent))
    }
}

/// Heads, tails and edge, as [`ThickDisc::face_up`] tells them apart.
///
/// Between edge and face the centre of mass is above a rim: `√(r² + h²/4)` with the thickness h.
///
/// The edge is decided only on a ground so hard that its barrier exceeds the energy of a coin at
/// rest on it: about `m g h²/(8 r)` must exceed the energy that the body gains by sinking in.
impl<R: Real> Faces<R> for ThickDisc<R> {
    type Face = CoinFace;

    fn basin(&self, down: R::Vec3) -> Option<Basin<CoinFace, R>> {
        Some(thick(
            down,
            [self.radius(), self.thickness()],
            self.radius(),
        ))
    }
}

/// Heads, tails or edge of a coin with this radius and thickness (m) for the direction that points
/// down, if each rim extends at least by `extent` (m) in any direction of its plane.
fn thick<R: Real>(down: R::Vec3, [radius, thickness]: [R; 2], extent: R) -> Basin<CoinFace, R> {
    let half = thickness * R::HALF;
    let level = (down.y() * down.y() + down.z() * down.z()).sqrt();
    let face = if radius * down.x().abs() < half * level {
        CoinFace::Edge
    } else {
        thin::<R>(down)
    };
    let corner = (radius * radius + half * half).sqrt();
    Basin {
        face,
        height: (half * half + radius * extent) / corner,
    }
}

/// The six sides, each named by the side that is up. Between two sides the centre of mass is above
/// their edge.
///
/// No face is reported if the centre of mass is not between the corners.
impl<R: Real> Faces<R> for Cuboid<R> {
    type Face = CuboidFace;

    fn basin(&self, down: R::Vec3) -> Option<Basin<CuboidFace, R>> {
        use CuboidFace::{MinusX, MinusY, MinusZ, X, Y, Z};
        let [low, .., high] = self.contacts() else {
            return None;
        };
        let [low, high] = [-low.position, high.position].map(|v| [v.x(), v.y(), v.z()]);
        let is_outside = |distance: &R| *distance <= R::ZERO;
        if low.iter().chain(&high).any(is_outside) {
            return None;
        }
        let opposite = [[X, MinusX], [Y, MinusY], [Z, MinusZ]];
        // The side through which the direction leaves the box: the least distance along it.
        let mut nearest: Option<(R, usize, R, CuboidFace)> = None;
        for (axis, along) in [down.x(), down.y(), down.z()].into_iter().enumerate() {
            let is_high = along > R::ZERO;
            let distance = *(if is_high { &high } else { &low }).get(axis)?;
            let face = *opposite.get(axis)?.get(usize::from(is_high))?;
            let path = distance / along.abs();
            if nearest.is_none_or(|(least, ..)| path < least) {
                nearest = Some((path, axis, distance, face));
            }
        }
        let (_, axis, distance, face) = nearest?;
        let others = (0..3).filter(|&other| other != axis);
        let sides = others.filter_map(|other| Some(low.get(other)?.at_most(*high.get(other)?)));
        let side = sides.reduce(R::at_most)?;
        let edge = (distance * distance + side * side).sqrt();
        Some(Basin {
            face,
            height: edge + self.corner_radius(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use core::f64::consts::TAU;
    use glam::DVec3;

    /// Least support of contacts and rims over the directions at this angle from the normal.
    ///
    /// A `Coin` reports that of the circle around its contacts.
    fn least_support(body: &impl RigidPointBody, angle: f64) -> f64 {
        let support = |direction: DVec3| {
            let contacts = body.contacts().iter();
            let rims = body.rims().iter().map(|rim| rim.support(direction));
            (contacts.map(|contact| direction.dot(contact.position)))
                .chain(rims)
                .fold(f64::NEG_INFINITY, f64::max)
        };
        let (sin, cos) = angle.sin_cos();
        let around = (0..7200).map(|step| TAU * f64::from(step) / 7200.0);
        around
            .map(|turn| support(DVec3::new(cos, sin * turn.cos(), sin * turn.sin())))
            .fold(f64::INFINITY, f64::min)
    }

    /// The lowest directions between two points of a rim are among those sampled.
    #[test]
    fn the_height_of_a_coin_is_the_least_support_upright() {
        for count in [3, 4, 5, 12] {
            let storage = std::vec![ContactPoint::default(); count];
            let coin = Coin::ring_with_storage(storage, 0.2, 0.7);
            let basin = coin.basin(DVec3::new(0.1, 0.0, 1.0)).unwrap();
            let least = least_support(&coin, 0.25 * TAU);
            assert_relative_eq!(basin.height, least, max_relative = 1e-9);
        }
    }

    #[test]
    fn the_height_of_a_thick_coin_is_the_least_support_on_a_rim() {
        let (radius, thickness) = (0.7_f64, 0.3);
        // The normal is at this angle from the vertical if the centre of mass is above a rim.
        let angle = (2.0 * radius / thickness).atan();
        for count in [3, 4, 6] {
            let storage = std::vec![ContactPoint::default(); 2 * count];
            let coin = SolidCoin::new_with_storage(storage, 0.2, radius, thickness);
            let basin = coin.basin(DVec3::X).unwrap();
            assert_relative_eq!(
                basin.height,
                least_support(&coin, angle),
                max_relative = 1e-9
            );
        }
        let disc = ThickDisc::solid(0.2, radius, thickness, 40);
        let basin = disc.basin(DVec3::X).unwrap();
        assert_relative_eq!(
            basin.height,
            least_support(&disc, angle),
            max_relative = 1e-9
        );
    }

    /// In whatever direction the centre of mass is off, and whatever direction points down.
    #[test]
    fn a_cuboid_whose_centre_of_mass_is_not_between_its_corners_has_no_faces() {
        let edges = DVec3::new(0.6, 0.8, 1.0);
        let loaded = |centre: DVec3| {
            let distribution = crate::MassProperties::ball(1.0, 0.1).unwrap();
            Cuboid::loaded(edges, distribution.at(centre))
        };
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        for towards in axes.into_iter().chain(axes.map(|axis| -axis)) {
            let extent = (edges * towards).length() / 2.0;
            let inside = loaded(towards * (extent - 1e-3));
            let outside = loaded(towards * (extent + 1e-3));
            for down in axes.into_iter().chain(axes.map(|axis| -axis)) {
                assert!(inside.basin(down).is_some(), "{towards} {down}");
                assert_eq!(outside.basin(down), None, "{towards} {down}");
            }
        }
    }

    #[test]
    fn the_face_of_a_thick_coin_changes_where_the_centre_of_mass_is_above_a_rim() {
        let disc = ThickDisc::solid(0.2, 0.7, 0.3, 40);
        let angle = (2.0 * 0.7 / 0.3_f64).atan();
        for (shift, x, face) in [
            (-1e-6, 1.0, CoinFace::Tails),
            (-1e-6, -1.0, CoinFace::Heads),
            (1e-6, 1.0, CoinFace::Edge),
            (1e-6, -1.0, CoinFace::Edge),
        ] {
            let (sin, cos) = (angle + shift).sin_cos();
            let down = DVec3::new(x * cos, 0.6 * sin, -0.8 * sin);
            assert_eq!(disc.basin(down).unwrap().face, face, "{shift} {x}");
        }
    }
}
