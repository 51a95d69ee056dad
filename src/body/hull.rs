//! Convex hull of points, as a solid.

use super::mass_properties::{Volume, check_vertices, no_vertex};
use super::{ContactPoint, MassProperties, Solid};
use crate::error::SceneError;
use crate::real::{Real, Vector};

impl<R: Real> MassProperties<R> {
    /// Mass properties of the homogeneous solid within the convex hull of points.
    ///
    /// Mass in kg, points in m, in any order. Interior points and duplicates have no effect.
    ///
    /// Facets are found by rotating a plane about each edge (gift wrapping). They are summed as
    /// those of a [`mesh`](Self::mesh). This takes about `n³` operations for n points, once, and no
    /// memory. Points within 256 units in the last place of the hull's size from a facet's plane
    /// belong to the facet. If the facets do not meet, other distances from 16 to 4096 units are
    /// tried.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the mass or a coordinate is not finite, if there is no point, or
    /// if the points lie in a plane, so that the hull has no volume. It also returns one if the
    /// facets do not meet at any of these distances, because points almost in a plane are too many.
    pub fn hull<V: Vector<R>>(mass: R, points: &[V]) -> Result<Self, SceneError>
    where
        R: Real<Vec3 = V>,
    {
        check_vertices::<R>(points)?;
        let tip = points.first().ok_or_else(no_vertex)?;
        let within = |units: f64| {
            let hull =
                Hull::<R, V>::within(points, |&point| point, R::EPSILON * R::from_f64(units));
            hull.volume(tip)
        };
        let closed = (THICKNESSES.into_iter().map(within)).find(Volume::is_closed);
        closed
            .unwrap_or_else(|| within(THICKNESSES[0]))
            .filled_with(mass)
    }
}

/// Units in the last place of the hull's size within which a point counts as on a plane.
///
/// A point may be within the thickness of one plane and just outside that of the next. The facets
/// do not meet then, and those of another thickness do: with the first one alone, one of a thousand
/// boxes with some more points on its faces is not closed.
const THICKNESSES: [f64; 5] = [256.0, 64.0, 1024.0, 16.0, 4096.0];

impl<R: Real, const N: usize> Solid<R, [ContactPoint<R>; N]> {
    /// Creates the homogeneous convex hull of points (m), with a bare contact at each of them.
    ///
    /// Its mass distribution is that of the hull. Mass in kg.
    ///
    /// ```
    /// use tumble::glam::DVec3;
    /// use tumble::{RigidPointBody, Solid};
    /// // A tetrahedral die with edges L of 20 mm: moments m L²/20.
    /// let a: f64 = 0.02 / 8.0_f64.sqrt();
    /// let corners = [(a, a, a), (a, -a, -a), (-a, a, -a), (-a, -a, a)].map(DVec3::from);
    /// let die = Solid::hull(0.004, corners)?;
    /// assert!((die.inertia().x_axis.x / (0.004 * 0.02 * 0.02 / 20.0) - 1.0).abs() < 1e-14);
    /// # Ok::<(), tumble::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// Returns [`SceneError`] if the mass is not above 0, a coordinate is not finite, or the points
    /// lie in a plane.
    // `V` is `R::Vec3`. As a type parameter it lets the compiler infer the precision, which a
    // projection does not.
    pub fn hull<V: Vector<R>>(mass: R, points: [V; N]) -> Result<Self, SceneError>
    where
        R: Real<Vec3 = V>,
    {
        let distribution = MassProperties::hull(mass, &points)?;
        Self::new(distribution, points.map(ContactPoint::bare))
    }
}

/// Convex hull of points, with the distance within which a point counts as on a plane or a line, m.
pub(crate) struct Hull<'a, R: Real, T> {
    points: &'a [T],
    position: fn(&T) -> R::Vec3,
    thickness: R,
}

/// Plane with all points on it or behind it.
pub(crate) struct FacetPlane<R: Real> {
    place: R::Vec3,
    /// Outward normal, of length 1.
    normal: R::Vec3,
}

impl<R: Real> FacetPlane<R> {
    /// Signed distance of the plane from the origin along its normal, m.
    pub(crate) fn distance(&self) -> R {
        self.normal.dot(self.place)
    }
}

impl<'a, R: Real, T> Hull<'a, R, T> {
    /// Hull of the positions of `points`. Points within `noise` of its size from a plane are on it,
    /// and within 256 units in the last place in any case.
    pub(crate) fn of(points: &'a [T], position: fn(&T) -> R::Vec3, noise: R) -> Self {
        let least = R::EPSILON * R::from_f64(THICKNESSES[0]);
        Self::within(points, position, noise.at_least(least))
    }

    /// Hull of the positions of `points`. Points within `share` of its size from a plane are on it.
    fn within(points: &'a [T], position: fn(&T) -> R::Vec3, share: R) -> Self {
        let middle = points.first().map(position).unwrap_or_default();
        let size = points.iter().fold(R::ZERO, |size, point| {
            size.at_least((position(point) - middle).length())
        });
        Self {
            points,
            position,
            thickness: size * share,
        }
    }

    /// Distance within which a point counts as on a plane, m.
    pub(crate) fn thickness(&self) -> R {
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
    pub(crate) fn facet_along(&self, direction: R::Vec3) -> Option<FacetPlane<R>> {
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
    pub(crate) fn edges(&self, plane: &FacetPlane<R>) -> impl Iterator<Item = [R::Vec3; 2]> {
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
    pub(crate) fn numbers_on(&self, plane: &FacetPlane<R>) -> impl Iterator<Item = usize> {
        (0..self.points.len()).filter(|&index| self.is_on(plane, index))
    }

    /// Returns true if the facet and its neighbours meet at its edges.
    ///
    /// A point may be within the thickness of one plane and just outside that of the next. Two
    /// planes can then share more than an edge, and belong to the same directions. So the plane to
    /// the left of each edge must have the points of this one, and the plane to its right must have
    /// the same edge.
    pub(crate) fn meets_its_neighbours(&self, plane: &FacetPlane<R>) -> bool {
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
    pub(crate) fn corners_that_name(&self, plane: &FacetPlane<R>) -> Option<[usize; 3]> {
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

    /// Volume within the facets, with the tip of its tetrahedra.
    fn volume(&self, tip: &R::Vec3) -> Volume<R> {
        let mut volume = Volume::about(tip);
        for first in 0..self.points.len() {
            for second in first + 1..self.points.len() {
                self.each_triangle(first, second, |corners| volume.add(corners));
            }
        }
        volume
    }

    /// Calls `see` with the triangles of the facet to the left of the edge from `first` to
    /// `second`, counter-clockwise from outside.
    ///
    /// Nothing is called unless this is an edge of the facet and `first` is the least number of a
    /// point on its outline. So each facet is visited once.
    fn each_triangle(&self, first: usize, second: usize, mut see: impl FnMut([R::Vec3; 3])) {
        let Some(plane) = self.wrap(first, second) else {
            return;
        };
        if !self.is_edge(&plane, first, second) || !self.leads(&plane, first) {
            return;
        }
        let (start, end) = (self.point(first), self.point(second));
        let mut corner = end;
        for _ in 0..self.points.len() {
            let next = self.next_corner(&plane, corner);
            // The walk is back at the start. A start within an edge is not a corner, so the first
            // corner is compared as well.
            let is_back = |to: R::Vec3| (next - to).length() <= self.thickness;
            if is_back(start) || is_back(end) {
                return;
            }
            see([start, corner, next]);
            corner = next;
        }
    }

    /// Returns true if no point with a lesser number begins an edge of the facet.
    fn leads(&self, plane: &FacetPlane<R>, number: usize) -> bool {
        self.edges(plane).all(|[start, end]| {
            let along = end - start;
            // Twice the thickness: `begins_an_edge` decides.
            let width = along.length() * self.thickness * R::TWO;
            let is_near = |index| along.cross(self.point(index) - start).length() <= width;
            let mut lesser = (0..number).filter(|&index| self.is_on(plane, index));
            !lesser.any(|index| is_near(index) && self.begins_an_edge(plane, index))
        })
    }

    fn begins_an_edge(&self, plane: &FacetPlane<R>, number: usize) -> bool {
        (0..self.points.len()).any(|other| self.is_edge(plane, number, other))
    }

    /// Plane through two points that has no point in front of it, with its normal to their left.
    ///
    /// Returns `None` if the two points are not an edge of the hull.
    fn wrap(&self, first: usize, second: usize) -> Option<FacetPlane<R>> {
        let place = self.point(first);
        self.wrap_about(place, self.point(second) - place)
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

    /// Returns true if the facet in this plane lies to the left of the line and no other point is
    /// farther along it. A point that is as far, with a lesser number, also makes it false.
    fn is_edge(&self, plane: &FacetPlane<R>, first: usize, second: usize) -> bool {
        let start = self.point(first);
        let length = (self.point(second) - start).length();
        let along = (self.point(second) - start) * (R::ONE / length);
        let left = plane.normal.cross(along);
        self.positions().enumerate().all(|(index, point)| {
            let way = point - start;
            let (side, ahead) = (left.dot(way), along.dot(way));
            let is_elsewhere = side > self.thickness || !self.is_on(plane, index);
            let is_before = ahead < length - self.thickness
                || (ahead <= length + self.thickness && index >= second);
            is_elsewhere || (side >= -self.thickness && is_before)
        })
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
