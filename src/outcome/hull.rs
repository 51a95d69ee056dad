//! Faces of the convex hull of contacts.

use super::noisy_hull::NoisyHull;
use super::{Basin, Faces};
use crate::body::{ContactPoint, PointCloud, RigidPointBody, Solid};
use crate::real::{Real, Vector};

/// Facet of the convex hull of a body's contacts, on which the body lies.
///
/// It is named by the smallest numbers of three contacts on it that are not on one line, so that no
/// two facets have the same name. Contacts within 1e-5 of the hull's size from the facet's plane
/// are on it (3e-5 in `f32`), so that a face keeps its corners if they are rounded, as in a file
/// with six digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HullFace {
    /// Numbers of three contacts, in increasing order.
    pub contacts: [usize; 3],
}

/// Largest distance of a contact from the plane of its facet, relative to the size of the hull. It
/// lowers the barriers by four times as much.
const NOISE: f64 = 1e-5;

impl HullFace {
    /// Returns the facet below the centre of mass for a direction that points down, with the height
    /// of its barrier. Use it to implement [`Faces`] for a body of your own.
    ///
    /// For a point q of an edge between the contacts a and b, the body reaches at least
    /// `|q| + min(ρ_a, ρ_b)` in the direction of q, with the radii ρ. So the height is the distance
    /// of the centre of mass from the nearest edge of the facet, plus the least radius. For corners
    /// that are off the plane, it is lowered by 4e-5 of the hull's size (1.2e-4 in `f32`).
    ///
    /// Returns `None` if no facet is below the centre of mass: a ray in this direction does not
    /// leave the hull of the contacts' positions through a facet. This occurs only if the centre of
    /// mass is on the hull or outside of it. Other directions of such a body can have a facet,
    /// whose barrier holds.
    ///
    /// It is also `None` if the facet cannot be separated from its neighbour. Then some contacts
    /// are on the plane of one and just off the plane of the other. This occurs for a face with
    /// noise of 1e-5 of the hull's size, and for a very flat body. A facet that can be separated is
    /// returned for all directions that a body reaches below its barrier.
    ///
    /// *Limit:* a facet on which the body does not rest has a basin of its own, so that the barrier
    /// of its neighbour is lower than it could be. A face whose corners have more noise than 1e-5
    /// of the hull's size is several facets. If an edge between them passes below the centre of
    /// mass, there is no barrier, and the face is never decided. *Cost:* proportional to the number
    /// of contacts times the number of corners of all facets that the search visits, including the
    /// neighbours of the result. If the search ends on a facet that is not separate, the cost also
    /// has the square of the number of contacts near that facet.
    #[must_use]
    pub fn basin<R: Real, B: RigidPointBody<R> + ?Sized>(
        body: &B,
        down: R::Vec3,
    ) -> Option<Basin<Self, R>> {
        let contacts = body.contacts();
        let noise = R::from_f64(NOISE);
        let hull = NoisyHull::<R, ContactPoint<R>>::of(contacts, |contact| contact.position, noise);
        let plane = hull.separate_facet_along(down)?;
        let edges = hull.edges(&plane).map(|edge| distance_of_segment(edge));
        let nearest = edges.reduce(R::at_most)?;
        let radii = (hull.numbers_on(&plane)).filter_map(|index| Some(contacts.get(index)?.radius));
        Some(Basin {
            face: Self {
                contacts: hull.corners_that_name(&plane)?,
            },
            // Corners are on the facet to within the thickness.
            height: nearest + radii.reduce(R::at_most)? - hull.thickness() * R::from_f64(4.0),
        })
    }
}

/// Distance of a segment from the origin, m.
fn distance_of_segment<R: Real, V: Vector<R>>([start, end]: [V; 2]) -> R {
    let along = end - start;
    let square = along.length_squared();
    if square <= R::ZERO {
        return start.length();
    }
    let part = (-start.dot(along) / square).at_least(R::ZERO);
    (start + along * part.at_most(R::ONE)).length()
}

/// The facets of the contacts' convex hull.
impl<R: Real, P: AsRef<[ContactPoint<R>]>> Faces<R> for Solid<R, P> {
    type Face = HullFace;

    fn basin(&self, down: R::Vec3) -> Option<Basin<HullFace, R>> {
        HullFace::basin(self, down)
    }
}

/// The facets of the points' convex hull.
impl<R: Real, P: AsRef<[ContactPoint<R>]>> Faces<R> for PointCloud<R, P> {
    type Face = HullFace;

    fn basin(&self, down: R::Vec3) -> Option<Basin<HullFace, R>> {
        HullFace::basin(self, down)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// kg, m: a block with the half lengths 3, 4 and 12, whose corners are 13 from its middle.
    fn corners() -> [DVec3; 8] {
        core::array::from_fn(|index| {
            let side = |bit: usize| if index >> bit & 1 == 0 { -1.0 } else { 1.0 };
            DVec3::new(3.0 * side(0), 4.0 * side(1), 12.0 * side(2))
        })
    }

    /// The facet `+z` is 12 from the middle and its nearest edges 3 further out. The thickness is
    /// 1e-5 of the longest path from the first corner, 26.
    #[test]
    fn the_height_of_a_facet_is_lowered_by_four_times_the_thickness_of_the_hull() {
        let radius = 0.5;
        let contacts = corners().map(|position| ContactPoint { position, radius });
        let body = PointCloud::with_storage(contacts, &[0.125; 8]).unwrap();
        let basin = HullFace::basin(&body, DVec3::new(0.1, -0.2, 1.0).normalize()).unwrap();
        assert_eq!(basin.face.contacts, [4, 5, 6]);
        let thickness = 1e-5 * 26.0;
        let lowered = 153.0_f64.sqrt() + radius - basin.height;
        assert!(
            (lowered / (4.0 * thickness) - 1.0).abs() < 1e-2,
            "{lowered:e}"
        );
    }

    /// A hexagonal prism in any orientation, with its corners rounded to six digits: each facet is
    /// whole, and its barrier is that of the exact prism. The least is a third of the way to its
    /// edge, so that a face which is split in two would show.
    #[test]
    fn a_face_with_rounded_corners_is_one_facet() {
        let turned = |number: u32| {
            let axis = DVec3::new(f64::from(number), 3.0, f64::from(number * number % 7)) - 4.0;
            glam::DQuat::from_axis_angle(axis.normalize(), 0.37 * f64::from(number))
        };
        let corner = |index: usize| {
            #[allow(clippy::cast_precision_loss)] // Below 12.
            let angle = (index % 6) as f64 * core::f64::consts::FRAC_PI_3;
            DVec3::new(angle.cos(), angle.sin(), if index < 6 { -0.8 } else { 0.8 })
        };
        let sides = (0..6).map(|index| {
            let angle = (f64::from(index) + 0.5) * core::f64::consts::FRAC_PI_3;
            DVec3::new(angle.cos(), angle.sin(), 0.0)
        });
        let facets = sides.chain([DVec3::Z, -DVec3::Z]);
        for number in 1..=100 {
            let rotation = turned(number);
            let exact: [DVec3; 12] = core::array::from_fn(|index| rotation * corner(index));
            let rounded = exact.map(|corner| (corner * 1e6).round() * 1e-6);
            let basin = |corners, down| {
                let body = PointCloud::new(corners, [1.0; 12]).unwrap();
                HullFace::basin(&body, rotation * down).unwrap()
            };
            for down in facets.clone() {
                let [expected, basin] = [exact, rounded].map(|corners| basin(corners, down));
                assert_eq!(basin.face, expected.face);
                let apart = (basin.height - expected.height).abs();
                assert!(apart < 1e-5, "{number}, {down}: {apart:e} m");
            }
        }
    }

    /// A block of 6 m, 8 m and 4 m whose centre of mass is 3 m above its top. A direction has a
    /// facet if the ray along it meets the block.
    #[test]
    fn a_centre_of_mass_outside_the_hull_has_the_facets_that_rays_leave_the_hull_through() {
        let corners = corners().map(|corner| corner * DVec3::new(1.0, 1.0, 1.0 / 6.0));
        let distribution = crate::MassProperties::ball(1.0, 0.1).unwrap();
        let contacts = corners.map(ContactPoint::bare);
        let body = Solid::new(distribution.at(DVec3::Z * 5.0), contacts).unwrap();
        let basin = HullFace::basin(&body, -DVec3::Z).unwrap();
        assert_eq!(basin.face.contacts, [0, 1, 2]);
        assert!((basin.height - (7.0_f64 * 7.0 + 9.0).sqrt()).abs() < 1e-2);
        // The lowest edge that the ray can cross: from it on the rays leave through a side.
        let leaning = |x: f64| HullFace::basin(&body, DVec3::new(x, 0.0, -7.0).normalize());
        assert_eq!(leaning(2.99).unwrap().face, basin.face);
        let side = leaning(3.01).unwrap();
        assert_eq!(side.face.contacts, [1, 3, 5]);
        assert_eq!(leaning(7.01), None);
        for down in [DVec3::Z, DVec3::X, -DVec3::Y] {
            assert_eq!(HullFace::basin(&body, down), None);
        }
    }

    #[test]
    fn solids_and_point_clouds_have_the_facets_of_their_hull() {
        let solid = Solid::hull(1.0, corners()).unwrap();
        let cloud = PointCloud::new(corners(), [0.125; 8]).unwrap();
        for down in [DVec3::X, -DVec3::Y, DVec3::Z] {
            let facet = HullFace::basin(&solid, down);
            assert!(facet.is_some());
            assert_eq!(solid.basin(down), facet);
            assert_eq!(cloud.basin(down), facet);
        }
    }

    /// Cubes of 20 mm with noise of 1e-5 of their size, tossed until most of them are at rest. Once
    /// a face is decided, each later state has it.
    #[test]
    fn a_decided_cube_with_noise_keeps_its_face() {
        let mut number = 0;
        let mut vector = || {
            number += 1;
            let part = |root: f64| 2.0 * (f64::from(number) * root.sqrt()).fract() - 1.0;
            DVec3::new(part(2.0), part(3.0), part(5.0))
        };
        let mut decided = 0;
        for _ in 0..300 {
            let turn = glam::DQuat::from_scaled_axis(vector() * 3.0);
            let corner = |index: usize| corners()[index] / DVec3::new(3.0, 4.0, 12.0) * 0.01;
            let noisy = core::array::from_fn(|index| turn * (corner(index) + vector() * 2e-7));
            let stepper = crate::Stepper::builder(PointCloud::new(noisy, [0.001; 8]).unwrap())
                .ground(crate::FlatGround::level(2e4, 3.0))
                .friction(crate::Coulomb {
                    coefficient: 0.4,
                    slip_speed: 1e-3,
                })
                .gravity(crate::UniformGravity::down(9.8))
                .integrator(crate::EnergyMomentum { time_step: 2e-4 })
                .build()
                .unwrap();
            let barriers = stepper.barriers().unwrap();
            let mut state = crate::State::at(DVec3::Z * 0.05)
                .with_rotation_vector(vector() * 3.0)
                .with_linear_velocity(vector() * 0.3)
                .with_angular_momentum(vector() * 1e-5);
            let mut first = None;
            for _ in 0..60 {
                stepper.advance(&mut state, 0.02).unwrap();
                if let (None, crate::Outcome::Decided(face)) = (first, barriers.outcome(&state)) {
                    first = Some(face);
                    decided += 1;
                }
                if first.is_some() {
                    let down = state.orientation.inverse() * -DVec3::Z;
                    assert_eq!(stepper.body().basin(down).map(|basin| basin.face), first);
                }
            }
        }
        assert!(decided > 200, "{decided}");
    }
}
