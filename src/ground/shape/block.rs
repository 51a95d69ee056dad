//! A block with faces, edges and corners.

use crate::error::{self, SceneError};
use crate::ground::{GroundBounds, Plane, Shape, Surface};
use crate::real::{Real, Vector};

/// Solid block along the world axes: a table with an edge, a step, a wall, a post.
///
/// Outside, the gap is the distance from the block: from a face, an edge or a corner. Inside, it is
/// the negative distance from the nearest face, and the normal is that of this face. So a contact
/// beyond an edge has no force until it meets the side, and a ball rolls over an edge as over a
/// sharp one.
///
/// *Limits:* inside, the normal has a jump where two faces are equally near: a contact that
/// penetrates deeper than half of the thickness is pushed out through the opposite face. The bodies
/// touch with their contacts, so an edge of the block that lies between two contacts of a body has
/// no effect. The contact of an [`Ellipsoid`](crate::Ellipsoid) jumps from face to face at an edge.
/// The body is then sometimes caught at the edge, with its contact deep in the block. A method with
/// a tolerance may pass over a contact with an edge that takes less than a 64th of one of its
/// steps, or less than a 16th if the body touches the block at one end of that step. The normal
/// jumps where a contact crosses an edge, so methods with a fixed step have order 1 there.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Block, Shape};
///
/// // The top of a table, 1 m long, 0.6 m wide and 5 cm thick, 0.75 m above the floor.
/// let centre = DVec3::new(0.0, 0.0, 0.725);
/// let top: Block = Block { centre, half: DVec3::new(0.5, 0.3, 0.025) };
/// let above = top.surface(DVec3::new(0.1, 0.2, 0.85));
/// assert!((above.gap - 0.1_f64).abs() < 1e-12 && above.normal == DVec3::Z);
/// let beyond = top.surface(DVec3::new(0.53, 0.0, 0.79)); // 3 cm beyond the edge, 4 cm above it
/// assert!((beyond.gap - 0.05_f64).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "R::Vec3: serde::Serialize",
        deserialize = "R::Vec3: serde::Deserialize<'de>"
    ))
)]
pub struct Block<R: Real = f64> {
    /// Centre, m, world axes.
    pub centre: R::Vec3,
    /// Half of the length along each world axis, m, above 0.
    pub half: R::Vec3,
}

impl<R: Real> Shape<R> for Block<R> {
    #[inline]
    fn surface(&self, point: R::Vec3) -> Surface<R> {
        let place = point - self.centre;
        let beyond = |place: R, half: R| place.abs() - half;
        let sign = |place: R| if place < R::ZERO { -R::ONE } else { R::ONE };
        let (x, y, z) = (
            beyond(place.x(), self.half.x()),
            beyond(place.y(), self.half.y()),
            beyond(place.z(), self.half.z()),
        );
        let signs = [sign(place.x()), sign(place.y()), sign(place.z())];
        let nearest = x.at_least(y).at_least(z);
        let (gap, [a, b, c]) = if nearest > R::ZERO {
            let outside = R::Vec3::new(
                x.at_least(R::ZERO),
                y.at_least(R::ZERO),
                z.at_least(R::ZERO),
            );
            // Divided by the largest part first, so that no square underflows.
            let scaled = outside * (R::ONE / nearest);
            let length = scaled.length();
            let normal = scaled * (R::ONE / length);
            (nearest * length, [normal.x(), normal.y(), normal.z()])
        } else if z == nearest {
            (z, [R::ZERO, R::ZERO, R::ONE])
        } else if x == nearest {
            (x, [R::ONE, R::ZERO, R::ZERO])
        } else {
            (y, [R::ZERO, R::ONE, R::ZERO])
        };
        Surface {
            gap,
            normal: R::Vec3::new(a * signs[0], b * signs[1], c * signs[2]),
        }
    }

    #[inline]
    fn bounds(&self) -> GroundBounds<R> {
        GroundBounds::Below(Plane::level(self.centre.z() + self.half.z()))
    }

    fn check(&self) -> Result<(), SceneError> {
        error::finite("x of the centre of the block", self.centre.x(), " m")?;
        error::finite("y of the centre of the block", self.centre.y(), " m")?;
        error::finite("z of the centre of the block", self.centre.z(), " m")?;
        error::above_zero("half of the x length of the block", self.half.x(), " m")?;
        error::above_zero("half of the y length of the block", self.half.y(), " m")?;
        error::above_zero("half of the z length of the block", self.half.z(), " m")
    }

    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }
}
