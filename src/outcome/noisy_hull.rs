//! Convex hull of points with noise, and its facets.

use crate::real::{Real, Vector};

/// Convex hull of points, with the distance within which a point counts as on a plane or a line, m.
pub(super) struct NoisyHull<'a, R: Real, T> {
    points: &'a [T],
    position: fn(&T) -> R::Vec3,
    thickness: R,
}

/// Plane with all points on it or behind it.
pub(super) struct FacetPlane<R: Real> {
    place: R::Vec3,
    /// Outward normal, of length 1.
    normal: R::Vec3,
}

impl<R: Real> FacetPlane<R> {
    /// Signed distance of the plane from the origin along its normal, m.
    pub(super) fn distance(&self) -> R {
        self.normal.dot(self.place)
    }
}

impl<'a, R: Real, T> NoisyHull<'a, R, T> {
    /// Hull of the positions of `points`. Points within `noise` of its size from a plane are on it,
    /// and within 256 units in the last place in any case.
    pub(super) fn of(points: &'a [T], position: fn(&T) -> R::Vec3, noise: R) -> Self {
        let middle = points.first().map(position).unwrap_or_default();
        let size = points.iter().fold(R::ZERO, |size, point| {
            size.at_least((position(point) - middle).length())
        });
        Self {
            points,
            position,
            thickness: size * noise.at_least(R::EPSILON * R::from_f64(256.0)),
        }
    }

    /// Distance within which a point counts as on a plane, m.
    pub(super) fn thickness(&self) -> R {
        self.thickness
    }

    fn positions(&self) -> impl Iterator<Item = R::Vec3> {
        self.points.iter().map(self.position)
    }

    fn point(&self, index: usize) -> R::Vec3 {
        self.points
            .get(index)
            .map(self.position)
            .unwrap_or_default()
    }

    /// Facet through which a ray from the origin leaves the hull. `None` if the walk over the
    /// facets finds none, as for points in a plane.
    ///
    /// The walk crosses an edge whenever the direction is on its far side. The cones over the
    /// facets are a regular subdivision of the directions if the origin is inside, so that no facet
    /// is visited twice.
    pub(super) fn facet_along(&self, direction: R::Vec3) -> Option<FacetPlane<R>> {
        let mut plane = self.facet_near(direction)?;
        for _ in 0..2 * self.points.len() {
            let crossed = (self.edges(&plane))
                .find(|&[start, end]| start.cross(end).dot(direction) < R::ZERO);
            let Some([start, end]) = crossed else {
                return Some(plane);
            };
            plane = self.wrap_about(end, start - end)?;
        }
        None
    }

    /// A facet at the farthest point in a direction.
    ///
    /// The second farthest point is a neighbour of the farthest one, so that their line is an edge.
    /// If rounding prevents it, or if points coincide, other lines are tried.
    fn facet_near(&self, direction: R::Vec3) -> Option<FacetPlane<R>> {
        let first = self.farthest(|point| point.dot(direction))?;
        let second = self.farthest(|point| {
            let is_other = (point - first).length() > self.thickness;
            if is_other {
                point.dot(direction)
            } else {
                -R::MAX
            }
        });
        let mut others = second.into_iter().chain(self.positions());
        others.find_map(|other| self.wrap_about(first, other - first))
    }

    fn farthest(&self, measure: impl Fn(R::Vec3) -> R) -> Option<R::Vec3> {
        let farther = |best: R::Vec3, point| {
            let is_farther = measure(point) > measure(best);
            if is_farther { point } else { best }
        };
        self.positions().reduce(farther)
    }

    /// Edges of a facet from corner to corner, counter-clockwise from outside.
    pub(super) fn edges(&self, plane: &FacetPlane<R>) -> impl Iterator<Item = [R::Vec3; 2]> {
        // The farthest of the facet's points from the origin is a corner.
        let first = self.farthest(|point| {
            let is_on = self.height(plane, point).abs() <= self.thickness;
            if is_on { point.length() } else { R::ZERO }
        });
        let mut start = first;
        (0..self.points.len()).map_while(move |_| {
            let (from, first) = (start?, first?);
            let next = self.next_corner(plane, from);
            let is_last = (next - first).length() <= self.thickness;
            start = (!is_last).then_some(next);
            Some([from, if is_last { first } else { next }])
        })
    }

    /// Numbers of the points on a facet, in increasing order.
    pub(super) fn numbers_on(&self, plane: &FacetPlane<R>) -> impl Iterator<Item = usize> {
        (0..self.points.len()).filter(|&index| self.is_on(plane, index))
    }

    /// Returns true if the facet and its neighbours meet at its edges.
    ///
    /// A point may be within the thickness of one plane and just outside that of the next. Two
    /// planes can then share more than an edge, and belong to the same directions. So the plane to
    /// the left of each edge must have the points of this one, and the plane to its right must have
    /// the same edge.
    pub(super) fn meets_its_neighbours(&self, plane: &FacetPlane<R>) -> bool {
        let is_near = |a: R::Vec3, b: R::Vec3| (a - b).length() <= self.thickness;
        self.edges(plane).all(|[start, end]| {
            let to_left = self.wrap_about(start, end - start);
            let to_right = self.wrap_about(end, start - end);
            to_left.is_some_and(|own| self.numbers_on(&own).eq(self.numbers_on(plane)))
                && to_right.is_some_and(|other| {
                    (self.edges(&other)).any(|[from, to]| is_near(from, end) && is_near(to, start))
                })
        })
    }

    /// Smallest numbers of three points on a facet that are not on one line.
    pub(super) fn corners_that_name(&self, plane: &FacetPlane<R>) -> Option<[usize; 3]> {
        let mut numbers = self.numbers_on(plane);
        let first = numbers.next()?;
        let way_to = |index: usize| self.point(index) - self.point(first);
        let second = numbers.find(|&index| way_to(index).length() > self.thickness)?;
        let along = way_to(second);
        let width = along.length() * self.thickness;
        let third = numbers.find(|&index| along.cross(way_to(index)).length() > width)?;
        Some([first, second, third])
    }

    fn height(&self, plane: &FacetPlane<R>, point: R::Vec3) -> R {
        plane.normal.dot(point - plane.place)
    }

    /// Plane through the line from `place` in the direction `along` that has no point in front of
    /// it, with its normal to the left of the line.
    fn wrap_about(&self, place: R::Vec3, along: R::Vec3) -> Option<FacetPlane<R>> {
        let mut plane: Option<FacetPlane<R>> = None;
        for third in self.positions() {
            let normal = along.cross(third - place);
            let size = normal.length();
            // The third point is on the line of the two.
            if size <= along.length() * self.thickness {
                continue;
            }
            let is_beyond =
                |plane: &FacetPlane<R>| plane.normal.dot(third - plane.place) > self.thickness;
            if plane.as_ref().is_none_or(is_beyond) {
                let normal = normal * (R::ONE / size);
                plane = Some(FacetPlane { place, normal });
            }
        }
        plane.filter(|plane| {
            self.positions()
                .all(|point| self.height(plane, point) <= self.thickness)
        })
    }

    fn is_on(&self, plane: &FacetPlane<R>, index: usize) -> bool {
        self.height(plane, self.point(index)).abs() <= self.thickness
    }

    /// Corner of the facet after this one, counter-clockwise. It has no point of the facet to its
    /// right, and none beyond it on the same line.
    fn next_corner(&self, plane: &FacetPlane<R>, corner: R::Vec3) -> R::Vec3 {
        let mut next = corner;
        for (index, point) in self.positions().enumerate() {
            let way = point - corner;
            if way.length() <= self.thickness || !self.is_on(plane, index) {
                continue;
            }
            let so_far = next - corner;
            let side = plane.normal.dot(so_far.cross(way));
            let on_line = so_far.length() * self.thickness;
            let is_farther = side <= on_line && way.length() > so_far.length();
            if side < -on_line || is_farther {
                next = point;
            }
        }
        next
    }
}
