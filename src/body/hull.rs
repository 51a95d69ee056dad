//! Convex hull of points, as a solid.
//!
//! Decisions about facets are exact, so that the facets close, whatever the rounding. They are made
//! for points on a grid of integers, whose cells are below the rounding of sums over the facets.

mod exact;

use core::cmp::Ordering;

use super::mass_properties::{Volume, check_vertices, no_vertex};
use super::{ContactPoint, MassProperties, Solid};
use crate::error::SceneError;
use crate::real::{Matrix, Real, Vector};
use exact::{CELLS, GridPlane, Node, is_between};

impl<R: Real> MassProperties<R> {
    /// Mass properties of the homogeneous solid within the convex hull of points.
    ///
    /// Mass in kg, points in m, in any order. Interior points, points within a facet or an edge,
    /// and duplicates have no effect.
    ///
    /// Facets are found by rotating a plane about each edge (gift wrapping). They are summed as
    /// those of a [`mesh`](Self::mesh). Which points are on a facet is decided in exact integer
    /// arithmetic, so that the facets close for any points. This takes about `n³` such decisions
    /// for n points, once, and no memory.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the mass or a coordinate is not finite, if there is no point, or
    /// if the points lie in a plane, so that the hull has no volume. They do if the volume is at
    /// most 128 ε times the surface of the hull and its size, with ε = 2.2e-16 (1.2e-7 in `f32`). A
    /// box that thin has edges of at most 256 units in the last place of its size.
    pub fn hull<V: Vector<R>>(mass: R, points: &[V]) -> Result<Self, SceneError>
    where
        R: Real<Vec3 = V>,
    {
        check_vertices::<R>(points)?;
        let tip = points.first().ok_or_else(no_vertex)?;
        Grid::of(*tip, points).filled_with(mass)
    }
}

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

/// Points on a grid of integers about one of them, the tip.
///
/// Positions are differences from the tip, as in the sums over a mesh. A grid point differs from
/// such a difference by less than a cell, which is at most 2⁻⁵⁹ of the largest component of all.
struct Grid<'a, R: Real> {
    points: &'a [R::Vec3],
    tip: R::Vec3,
    /// Power of two that is more than half of the largest component, m. Infinite if the size is.
    unit: R,
}

/// Largest volume of points in a plane, relative to the product of size and surface, in units in
/// the last place.
///
/// The rounding of a rotated flat body's points is a hundredth of it, if they are not far from the
/// origin.
const FLAT: f64 = 128.0;

impl<'a, R: Real> Grid<'a, R> {
    fn of(tip: R::Vec3, points: &'a [R::Vec3]) -> Self {
        let largest = points.iter().fold(R::ZERO, |largest, &point| {
            let way = point - tip;
            let [x, y, z] = [way.x(), way.y(), way.z()].map(R::abs);
            largest.at_least(x).at_least(y).at_least(z)
        });
        Self {
            points,
            tip,
            unit: largest.power_of_two(),
        }
    }

    /// Mass properties of the hull. Sums are in units, so that none overflows or underflows.
    fn filled_with(&self, mass: R) -> Result<MassProperties<R>, SceneError> {
        let own = self.volume().solid(mass)?;
        let columns = own.inertia.columns();
        Ok(MassProperties {
            mass,
            centre_of_mass: self.tip + own.centre_of_mass * self.unit,
            inertia: R::Mat3::from_columns(columns.map(|column| column * self.unit * self.unit)),
        })
    }

    /// Volume within the facets, in units from the tip, or 0 for points in a plane.
    ///
    /// A facet is the sum of the triangles between its first point and each of its edges, wherever
    /// that point is on it. The tip is in the hull, so that no term is below 0, and none cancels.
    fn volume(&self) -> Volume<R> {
        let nothing = Volume::about(&R::Vec3::ZERO);
        let (mut volume, mut surface, mut sum) = (nothing, R::ZERO, R::ZERO);
        self.each_triangle(|corners| {
            let nodes = corners.map(|corner| self.node(corner));
            let Some(plane) = GridPlane::through(nodes) else {
                return;
            };
            let part = plane.volume::<R>(self.node(self.tip));
            volume.add_tetrahedron(corners.map(|corner| self.in_units(corner)), part);
            sum += part;
            surface += plane.area::<R>();
        });
        let lengths = (self.points.iter()).map(|&point| self.in_units(point).length());
        let size = lengths.fold(R::ZERO, R::at_least);
        let is_flat = sum <= size * surface * (R::EPSILON * R::from_f64(FLAT));
        if is_flat { nothing } else { volume }
    }

    /// Calls `see` with the triangles of all facets, counter-clockwise from outside.
    fn each_triangle(&self, mut see: impl FnMut([R::Vec3; 3])) {
        for second in 0..self.points.len() {
            for first in 0..second {
                // A line without a facet on its left is no edge, and has none on its right.
                if let Some(left) = self.triangle([first, second]) {
                    see(left);
                    self.triangle([second, first])
                        .into_iter()
                        .for_each(&mut see);
                }
            }
        }
    }

    /// Point from the tip, in units.
    fn in_units(&self, point: R::Vec3) -> R::Vec3 {
        // The inverse is a power of two as well.
        (point - self.tip) * (R::ONE / self.unit)
    }

    fn node(&self, point: R::Vec3) -> Node {
        let point = self.in_units(point);
        [point.x(), point.y(), point.z()].map(|part| (part * R::from_f64(CELLS)).whole())
    }

    fn nodes(&self) -> impl Iterator<Item = Node> {
        self.points.iter().map(|&point| self.node(point))
    }

    /// Triangle between a line and the first point on the facet to its left, if the line is an edge
    /// of this facet from corner to corner.
    fn triangle(&self, edge: [usize; 2]) -> Option<[R::Vec3; 3]> {
        let [start, end] = [self.points.get(edge[0])?, self.points.get(edge[1])?];
        let first = self.first_on_facet(edge, [start, end].map(|&end| self.node(end)))?;
        Some([*start, *end, first])
    }

    fn first_on_facet(&self, numbers: [usize; 2], edge: [Node; 2]) -> Option<R::Vec3> {
        let plane = self.wrap(edge)?;
        let mut first = None;
        for (number, (node, &point)) in self.nodes().zip(self.points).enumerate() {
            let is_within = match plane.side(node) {
                Ordering::Greater => false,
                Ordering::Less => continue,
                Ordering::Equal => match plane.turn(edge, node) {
                    Ordering::Greater => true,
                    Ordering::Less => false,
                    Ordering::Equal => is_between(edge, node),
                },
            };
            // Of points that coincide the first one is the corner.
            let is_repeated = |end: usize| number < numbers[end] && node == edge[end];
            if !is_within || is_repeated(0) || is_repeated(1) {
                return None;
            }
            first = first.or(Some(point));
        }
        first
    }

    /// Plane through the edge with no point in front of it and its facet to the left of the edge.
    ///
    /// For a line that is no edge it is some plane. `None` if all points are on the line.
    fn wrap(&self, [start, end]: [Node; 2]) -> Option<GridPlane> {
        let mut plane: Option<GridPlane> = None;
        for node in self.nodes() {
            let is_beyond = |plane: &GridPlane| plane.side(node) == Ordering::Greater;
            if plane.as_ref().is_none_or(is_beyond) {
                plane = GridPlane::through([start, end, node]);
            }
        }
        plane
    }
}
