//! Convex hull of points with noise, and its facets.

use crate::real::{Real, Vector};

/// Convex hull of points, with the distance within which a point counts as on a plane or a line, m.
pub(super) struct NoisyHull<'a, R: Real, T> {
    points: &'a [T],
    position: fn(&T) -> R::Vec3,
    /// Largest distance from the first point, m.
    size: R,
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
            size,
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

    /// Facet through which a ray from the origin leaves the hull, if it is separate from its
    /// neighbours. `None` if there is none, as for points in a plane.
    ///
    /// Some points are off a plane by about the thickness. The walk can then end on a plane that is
    /// not separate, though the ray also passes through a facet that is. This facet is searched for
    /// among the planes at the edges of the last one, and then among those at all lines between
    /// points near it.
    ///
    /// Two separate facets have no edge in common with the same direction: the plane to its left is
    /// unique, and has the points of both. So if a ray passes through two of them, the outline of
    /// one crosses the other facet, whose plane is above its corners by at most the thickness. This
    /// is not excluded. No such pair was found, and the first facet in this order is returned.
    pub(super) fn separate_facet_along(&self, direction: R::Vec3) -> Option<FacetPlane<R>> {
        let is_found = |plane: &FacetPlane<R>| {
            self.edge_before(plane, direction).is_none() && self.is_separate(plane)
        };
        let last = self.facet_along(direction)?;
        if is_found(&last) {
            return Some(last);
        }
        let both = |[start, end]: [R::Vec3; 2]| [[start, end], [end, start]];
        let lines = (self.edges(&last).flat_map(both)).chain(self.lines_near(&last));
        // The ray is to the left of each edge of its facet.
        let mut ahead = lines.filter(|[start, end]| start.cross(*end).dot(direction) >= R::ZERO);
        ahead.find_map(|[start, end]| self.wrap_about(start, end - start).filter(is_found))
    }

    /// Lines between two points each that are near a plane.
    ///
    /// Let a ray pass through this plane and a facet F, with the distance μ from the boundary of F.
    /// Both planes are within the thickness t of the hull there, and this plane is at most t below
    /// the corners of F. So the planes are inclined by at most about `2 t/μ`. If the height of a
    /// direction is below the barrier, it is `4 t` below that of the boundary at the distance q.
    /// Then μ is at least `√(8 t q)`, and the corners of F are within `√(t/(2 q))` of the size from
    /// this plane. This is 2 `√(t size)` if q is an eighth of the size.
    fn lines_near(&self, plane: &FacetPlane<R>) -> impl Iterator<Item = [R::Vec3; 2]> {
        let distance = (self.thickness * self.size).sqrt() * R::TWO;
        let near = move || {
            self.positions()
                .filter(move |&point| self.height(plane, point).abs() <= distance)
        };
        near().flat_map(move |start| near().map(move |end| [start, end]))
    }

    /// Returns true if the origin is behind the facet, and the facet meets its neighbours.
    fn is_separate(&self, plane: &FacetPlane<R>) -> bool {
        plane.distance() > self.thickness && self.meets_its_neighbours(plane)
    }

    /// Edge of the facet that has the direction on its far side.
    fn edge_before(&self, plane: &FacetPlane<R>, direction: R::Vec3) -> Option<[R::Vec3; 2]> {
        (self.edges(plane)).find(|&[start, end]| start.cross(end).dot(direction) < R::ZERO)
    }

    /// Facet at which a walk to a ray from the origin ends. `None` for points in a plane.
    ///
    /// The walk crosses an edge whenever the direction is on its far side. The cones over the
    /// facets are a regular subdivision of the directions if the origin is inside, so that no facet
    /// is visited twice. With points almost on a plane the walk may end beside the ray.
    fn facet_along(&self, direction: R::Vec3) -> Option<FacetPlane<R>> {
        let mut plane = self.facet_near(direction)?;
        for _ in 0..2 * self.points.len() {
            let across = (self.edge_before(&plane, direction))
                .and_then(|[start, end]| self.wrap_about(end, start - end));
            let Some(next) = across else {
                return Some(plane);
            };
            plane = next;
        }
        Some(plane)
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
    fn meets_its_neighbours(&self, plane: &FacetPlane<R>) -> bool {
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

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec3};

    /// Number of a sequence that fills (-1, 1) evenly for each `dimension`.
    fn part(index: u32, dimension: u32) -> f64 {
        let roots = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0_f64];
        2.0 * (f64::from(index) * roots[dimension as usize % 8].sqrt()).fract() - 1.0
    }

    fn vector(index: u32, first: u32) -> DVec3 {
        DVec3::new(
            part(index, first),
            part(index, first + 1),
            part(index, first + 2),
        )
    }

    /// A box with six more points on its sides and noise of 1e-7 to 1e-4 on all of them.
    fn noisy_box(number: u32) -> [DVec3; 14] {
        let half = DVec3::new(0.5, 0.4, 0.3);
        let noise = 10.0_f64.powf(-5.5 + 1.5 * part(number, 7));
        let axis = vector(number, 0).normalize();
        let turn = DQuat::from_axis_angle(axis, 3.0 * part(number, 3));
        core::array::from_fn(|index| {
            #[allow(clippy::cast_possible_truncation)] // Below 14.
            let seed = number * 14 + index as u32;
            let sign = |bit: usize| if index >> bit & 1 == 0 { -1.0 } else { 1.0 };
            let mut place = DVec3::new(sign(0), sign(1), sign(2));
            if index >= 8 {
                place = vector(seed, 4);
                place[index % 3] = sign(0);
            }
            turn * (place * half + vector(seed, 1) * noise)
        })
    }

    /// Directions within each separate facet of noisy boxes. Those that a body can reach below the
    /// barrier have this facet, and no direction has another one.
    #[test]
    fn a_direction_within_a_separate_facet_has_this_facet() {
        let mut reached = 0;
        for number in 1..=30 {
            let points = noisy_box(number);
            let hull = NoisyHull::<f64, DVec3>::of(&points, |&point| point, 1e-5);
            let pairs = points.iter().flat_map(|&a| points.map(|b| [a, b]));
            let planes = pairs.filter_map(|[a, b]| hull.wrap_about(a, b - a));
            for facet in planes.filter(|plane| hull.is_separate(plane)) {
                let corners = || hull.edges(&facet).map(|[start, _]| start);
                let middle = corners().sum::<DVec3>() * (1.0 / corners().count() as f64);
                // An edge is not nearer to the origin than its line.
                let nearest = hull.edges(&facet).map(|[start, end]| {
                    let along = (end - start).normalize();
                    (start - along * start.dot(along)).length()
                });
                let barrier = nearest.fold(f64::MAX, f64::min) - 4.0 * hull.thickness();
                for corner in corners() {
                    for share in [0.03, 0.3, 0.9] {
                        let direction = (middle + (corner - middle) * share).normalize();
                        let found = hull.separate_facet_along(direction);
                        let is_same = found
                            .as_ref()
                            .map(|found| hull.numbers_on(found).eq(hull.numbers_on(&facet)));
                        assert_ne!(is_same, Some(false), "{number}");
                        let height = points.iter().map(|point| point.dot(direction));
                        if height.fold(0.0, f64::max) < barrier {
                            reached += 1;
                            assert_eq!(is_same, Some(true), "{number}");
                        }
                    }
                }
            }
        }
        assert!(reached > 200, "{reached}");
    }
}
