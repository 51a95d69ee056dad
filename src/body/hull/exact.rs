//! Exact geometry of points on a grid of integers.
//!
//! Coordinates are at most 2⁶⁰ in size. So their differences are at most 2⁶¹, the components of a
//! normal at most 2¹²³, and nothing overflows.

use core::cmp::Ordering;

use crate::real::{Real, Vector};

/// Cells in a unit of length.
pub(super) const CELLS: f64 = (1_u64 << 59) as f64;

/// Point of the grid, or the vector between two of them.
pub(super) type Node = [i64; 3];

/// Plane through three points of the grid.
#[derive(Clone, Copy)]
pub(super) struct GridPlane {
    place: Node,
    /// Components of the normal.
    normal: [Wide; 3],
}

/// The number `high 2⁶³ + low`, with the lower part in `0..2⁶³`.
///
/// Its product with a coordinate is two products of 64 bits.
#[derive(Clone, Copy)]
struct Wide {
    high: i64,
    low: i64,
}

/// 2⁶³, as a number of digits below the upper part.
const DIGITS: f64 = (1_u64 << 63) as f64;

impl Wide {
    const LOW: i128 = i64::MAX as i128;

    #[allow(
        clippy::cast_possible_truncation,
        reason = "components are at most 2¹²³, and the lower part has 63 bits"
    )]
    fn of(number: i128) -> Self {
        Self {
            high: (number >> 63) as i64,
            low: (number & Self::LOW) as i64,
        }
    }

    fn number(self) -> i128 {
        (i128::from(self.high) << 63) + i128::from(self.low)
    }
}

impl GridPlane {
    /// Plane through points that are counter-clockwise from its front. `None` if they are on one
    /// line.
    pub(super) fn through([a, b, c]: [Node; 3]) -> Option<Self> {
        let normal = cross(difference(a, b), difference(a, c));
        (normal != [0; 3]).then(|| Self {
            place: a,
            normal: normal.map(Wide::of),
        })
    }

    /// Side of the plane on which a point is: `Greater` in front of it.
    pub(super) fn side(&self, point: Node) -> Ordering {
        let [high, low] = self.product(difference(self.place, point));
        high.cmp(&0).then(low.cmp(&0))
    }

    /// Volume between the three points and one that is not in front of them, in cubic units.
    pub(super) fn volume<R: Real>(&self, behind: Node) -> R {
        let [high, low] = self
            .product(difference(behind, self.place))
            .map(R::from_whole);
        let cell = R::from_f64(1.0 / CELLS);
        // Neither part is below 0, so that no digit cancels. Factors one by one, none of which
        // underflows in `f32`.
        (high + low / R::from_f64(DIGITS)) * cell * (R::from_f64(DIGITS) * cell * cell)
            / R::from_f64(6.0)
    }

    /// Area of the triangle between the three points, in square units.
    pub(super) fn area<R: Real>(&self) -> R {
        let square = R::from_f64(1.0 / CELLS / CELLS);
        let [x, y, z] = (self.normal).map(|component| R::from_whole(component.number()) * square);
        R::Vec3::new(x, y, z).length() * R::HALF
    }

    /// Scalar product with the normal, as a [`Wide`] number whose upper part has 124 bits.
    fn product(&self, way: Node) -> [i128; 2] {
        let sum = |part: fn(Wide) -> i64| {
            let product = |i: usize| i128::from(part(self.normal[i])) * i128::from(way[i]);
            product(0) + product(1) + product(2)
        };
        let (high, low) = (sum(|one| one.high), sum(|one| one.low));
        [high + (low >> 63), low & Wide::LOW]
    }

    /// Side of the line from `start` to `end` on which a point of the plane is: `Greater` to its
    /// left from the front.
    pub(super) fn turn(&self, [start, end]: [Node; 2], point: Node) -> Ordering {
        // The product is parallel to the plane's normal, so that one component shows its direction.
        let product = cross(difference(start, end), difference(start, point));
        let components = self.normal.into_iter().zip(product);
        let signs = components.map(|(own, other)| (own.number().signum() * other.signum()).cmp(&0));
        signs.fold(Ordering::Equal, Ordering::then)
    }
}

/// Returns true if a point of the line through `start` and `end` is between them.
pub(super) fn is_between([start, end]: [Node; 2], point: Node) -> bool {
    let [a, b, c] = difference(start, point).map(i128::from);
    let [x, y, z] = difference(end, point).map(i128::from);
    a * x + b * y + c * z <= 0
}

fn difference(from: Node, to: Node) -> Node {
    [to[0] - from[0], to[1] - from[1], to[2] - from[2]]
}

fn cross(a: Node, b: Node) -> [i128; 3] {
    let minor = |i: usize, j: usize| {
        i128::from(a[i]) * i128::from(b[j]) - i128::from(a[j]) * i128::from(b[i])
    };
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAR: i64 = 1 << 60;

    /// A plane through corners of the largest cube: points beside it by one cell, near and far.
    #[test]
    fn a_cell_beside_a_plane_is_on_its_side() {
        let corners = [[-FAR, -FAR, FAR], [FAR, -FAR, -FAR], [-FAR, FAR, -FAR]];
        let [a, b, c] = corners;
        let (front, back) = (GridPlane::through([a, c, b]), GridPlane::through([a, b, c]));
        let (front, back) = (front.unwrap(), back.unwrap());
        // x + y + z = -FAR on the plane, and the normal of `back` points up.
        for on in [
            [-FAR, 0, 0],
            [-FAR + 7, -3, -4],
            [FAR, -FAR, -FAR],
            [-1, -2, 3 - FAR],
        ] {
            for step in [-1, 0, 1] {
                for axis in 0..3 {
                    let mut point = on;
                    point[axis] += step;
                    assert_eq!(back.side(point), step.cmp(&0), "{point:?}");
                    assert_eq!(front.side(point), 0.cmp(&step), "{point:?}");
                }
            }
        }
    }

    #[test]
    fn a_line_has_no_plane_and_a_cell_beside_it_has_one() {
        let (start, end) = ([-FAR, -FAR, -FAR], [FAR, FAR, FAR]);
        assert!(GridPlane::through([start, end, [5; 3]]).is_none());
        assert!(GridPlane::through([start, end, start]).is_none());
        let plane = GridPlane::through([start, end, [5, 5, 6]]).unwrap();
        assert_eq!(plane.turn([start, end], [5, 5, 6]), Ordering::Greater);
        assert_eq!(plane.turn([start, end], [5, 5, 4]), Ordering::Less);
        assert_eq!(plane.turn([end, start], [5, 5, 6]), Ordering::Less);
        assert_eq!(plane.turn([start, end], [5, 5, 5]), Ordering::Equal);
        assert!(is_between([start, [4, 4, 4]], [4, 4, 4]));
        assert!(!is_between([start, [4, 4, 4]], [5, 5, 5]));
    }
}
