//! Mass, centre of mass and inertia of solids and of composites.

use super::homogeneous::finite_mass;
use super::point_cloud::{check_masses, check_sum, inertia_of, sum};
use crate::error::{self, Rule, SceneError};
use crate::inertia::finite_entries;
use crate::real::{Matrix, Real, Vector};
use crate::rotation::Rotation;

/// Mass distribution of a body or of a part of it: mass, centre of mass and inertia.
///
/// Homogeneous solids are centred at the origin unless stated otherwise. Their axis of symmetry, if
/// any, is z. [`at`](Self::at) and [`rotated`](Self::rotated) move them, and [`with`](Self::with)
/// joins them by the parallel-axis theorem. A part of negative mass is a hole.
///
/// Vectors are glam's `DVec3` or `Vec3`, which sets the precision.
///
/// The constructors of solids refuse a size that is negative or not finite. The mass of the whole
/// and its moments are checked when a scene is composed.
///
/// ```
/// use tumble::MassProperties;
/// use tumble::glam::DVec3;
///
/// // A hammer: a wooden handle along z with an iron head across its end.
/// let handle = MassProperties::cylinder(0.2, 0.015, 0.3)?;
/// let head = MassProperties::cuboid(0.8, DVec3::new(0.1, 0.03, 0.03))?.at(DVec3::Z * 0.165);
/// let hammer = handle.with(&head);
/// assert!((hammer.centre_of_mass.z - 0.132).abs() < 1e-15);
/// # Ok::<(), tumble::SceneError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "R: serde::Serialize, R::Vec3: serde::Serialize, R::Mat3: serde::Serialize",
        deserialize = "R: serde::Deserialize<'de>, R::Vec3: serde::Deserialize<'de>, \
            R::Mat3: serde::Deserialize<'de>"
    ))
)]
pub struct MassProperties<R: Real = f64> {
    /// Mass, kg.
    pub mass: R,
    /// Centre of mass, m, in the axes and from the origin in which the part is described.
    pub centre_of_mass: R::Vec3,
    /// Inertia tensor about the centre of mass, kg m², in the same axes.
    pub inertia: R::Mat3,
}

// A parameter type `V` of a method is `R::Vec3`. As a type parameter it lets the compiler infer the
// precision, which a projection does not.
impl<R: Real> MassProperties<R> {
    /// Properties of a homogeneous body about the origin with these principal moments, kg m².
    pub(super) fn about_origin(mass: R, x: R, y: R, z: R) -> Self {
        Self {
            mass,
            centre_of_mass: R::Vec3::ZERO,
            inertia: R::Mat3::from_diagonal(R::Vec3::new(x, y, z)),
        }
    }

    /// Mass (kg) concentrated at the origin, with zero moments.
    #[must_use]
    pub fn point(mass: R) -> Self {
        Self::about_origin(mass, R::ZERO, R::ZERO, R::ZERO)
    }

    /// Point masses at positions `places` (m), with masses in kg, at least 0 and not all 0.
    ///
    /// # Errors
    /// Returns [`SceneError`] if there is no point, the numbers of positions and masses differ, a
    /// coordinate is not finite, or a mass is negative. It is also returned if the inverse of the
    /// sum of the masses is not finite, as for masses that are all 0.
    pub fn points<V: Vector<R>>(places: &[V], masses: &[R]) -> Result<Self, SceneError>
    where
        R: Real<Vec3 = V>,
    {
        check_masses(places.len(), masses)?;
        for &place in places {
            error::finite("x of a point of mass", place.x(), " m")?;
            error::finite("y of a point of mass", place.y(), " m")?;
            error::finite("z of a point of mass", place.z(), " m")?;
        }
        let mass = sum(masses.iter().copied());
        check_sum(mass)?;
        let weighted = || places.iter().copied().zip(masses.iter().copied());
        let centre = super::point_cloud::sum_of_vectors(weighted, |p| p) * (R::ONE / mass);
        let centred = || weighted().map(|(place, mass)| (place - centre, mass));
        Ok(Self {
            mass,
            centre_of_mass: centre,
            inertia: inertia_of(centred),
        })
    }

    /// Returns the distribution shifted by `offset`, m.
    #[must_use]
    pub fn at<V: Vector<R>>(self, offset: V) -> Self
    where
        R: Real<Vec3 = V>,
    {
        Self {
            centre_of_mass: self.centre_of_mass + offset,
            ..self
        }
    }

    /// Returns the distribution rotated about the origin.
    ///
    /// With the matrix Q of the rotation, the centre of mass c becomes `Q c`, and the inertia
    /// tensor J becomes `Q J Qᵀ`.
    #[must_use]
    pub fn rotated(self, rotation: Rotation<R>) -> Self {
        let axes = rotation.axes();
        let turn = |columns: [R::Vec3; 3]| columns.map(|column| axes.to_world(column));
        // Q (Q J)ᵀ, which is symmetric as J is.
        let inertia = turn(transposed::<R>(turn(self.inertia.columns())));
        Self {
            centre_of_mass: axes.to_world(self.centre_of_mass),
            inertia: symmetric::<R>(inertia),
            ..self
        }
    }

    /// Returns the mass properties of this part and another joined as one rigid body.
    ///
    /// `J = J₁ + J₂ + μ (|d|² 1 - d dᵀ)`, with `d` from one centre of mass to the other and
    /// `μ = m₁ m₂/(m₁ + m₂)`. This is the parallel-axis theorem for both parts. It avoids the
    /// difference of large numbers that a calculation about the origin has.
    ///
    /// A hole is a part of negative mass. The sum of two masses other than 0 must not be 0, as a
    /// body without mass has no centre: add a hole to something heavier.
    #[must_use]
    pub fn with(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        // A part without mass has no share, beside another one without mass too.
        let share = if other.mass == R::ZERO {
            R::ZERO
        } else {
            other.mass / mass
        };
        let apart = other.centre_of_mass - self.centre_of_mass;
        let pair = parallel_axis::<R>(self.mass * share, apart);
        let [a, b] = [self.inertia.columns(), other.inertia.columns()];
        let column = |i: usize| a[i] + b[i] + pair[i];
        Self {
            mass,
            centre_of_mass: self.centre_of_mass + apart * share,
            inertia: R::Mat3::from_columns([column(0), column(1), column(2)]),
        }
    }

    /// Inertia tensor about `place` (m) instead of the centre of mass, kg m².
    #[must_use]
    pub fn inertia_about(&self, place: R::Vec3) -> R::Mat3 {
        let shift = parallel_axis::<R>(self.mass, place - self.centre_of_mass);
        let own = self.inertia.columns();
        R::Mat3::from_columns([own[0] + shift[0], own[1] + shift[1], own[2] + shift[2]])
    }

    /// Checks that the mass is above 0 and that centre of mass and inertia are finite.
    ///
    /// The moments are checked when a scene is composed.
    ///
    /// # Errors
    /// Returns [`SceneError`] for the first quantity that breaks a rule.
    pub fn check(&self) -> Result<(), SceneError> {
        error::above_zero("mass", self.mass, " kg")?;
        let centre = self.centre_of_mass;
        error::finite("x of the centre of mass", centre.x(), " m")?;
        error::finite("y of the centre of mass", centre.y(), " m")?;
        error::finite("z of the centre of mass", centre.z(), " m")?;
        finite_entries::<R>(self.inertia)
    }

    /// Mass properties of the homogeneous solid inside a closed surface of triangles.
    ///
    /// Each triangle is counter-clockwise as seen from outside. Mass in kg, vertices in m.
    ///
    /// The result is exact for any such surface, including cavities. It is summed over the
    /// tetrahedra between the first corner of the first triangle and each triangle with the corners
    /// a, b, c. A tetrahedron has the volume `v` and the first moment `v (a + b + c)/4`. Its second
    /// moments are `v (a aᵀ + b bᵀ + c cᵀ + s sᵀ)/20` with `s = a + b + c`. Vertices that no
    /// triangle names have no effect.
    ///
    /// # Errors
    /// Returns [`SceneError`] in these cases:
    ///
    /// - There is no vertex.
    /// - The mass or a coordinate is not finite.
    /// - A triangle names a vertex that does not exist.
    /// - The surface is not closed, within `√ε` of the sizes of the sums: its triangles' area
    ///   vectors `A` do not add up to 0, or `∑ centroid Aᵀ` is not the volume times the unit
    ///   matrix. Holes that cancel in all these sums are not found.
    /// - The volume is not above 0, for example because all triangles are inside out.
    pub fn mesh<V: Vector<R>>(
        mass: R,
        vertices: &[V],
        triangles: &[[usize; 3]],
    ) -> Result<Self, SceneError>
    where
        R: Real<Vec3 = V>,
    {
        check_vertices::<R>(vertices)?;
        let first = triangles
            .first()
            .and_then(|corners| vertices.get(corners[0]));
        let tip = first.or(vertices.first());
        let mut volume = Volume::about(tip.ok_or_else(no_vertex)?);
        for &corners in triangles {
            let [Some(a), Some(b), Some(c)] = corners.map(|corner| vertices.get(corner)) else {
                let last = vertices.len().saturating_sub(1);
                let beyond = corners.into_iter().max().unwrap_or_default();
                return Err(SceneError::new(
                    "index of a vertex in a triangle of the mesh",
                    Rule::AtMost(last),
                    f64::from_usize(beyond),
                    "",
                ));
            };
            volume.add([*a, *b, *c]);
        }
        volume.filled_with(mass)
    }
}

/// Checks that each vertex is finite.
pub(super) fn check_vertices<R: Real>(vertices: &[R::Vec3]) -> Result<(), SceneError> {
    for vertex in vertices {
        error::finite("x of a vertex", vertex.x(), " m")?;
        error::finite("y of a vertex", vertex.y(), " m")?;
        error::finite("z of a vertex", vertex.z(), " m")?;
    }
    Ok(())
}

/// Volume with its first and second moments, summed over the triangles of its surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Volume<R: Real> {
    /// Common tip of all tetrahedra. It is on the surface, so that little cancels.
    tip: R::Vec3,
    volume: R,
    /// `∫ p dV` from the tip.
    first: R::Vec3,
    /// `∫ p pᵀ dV` from the tip.
    second: [R::Vec3; 3],
    /// Sum of the triangles' area vectors, m², which is 0 for a closed surface. The next field is
    /// the sum of their sizes.
    area: R::Vec3,
    area_size: R,
    /// `∑ centroid Aᵀ` over the area vectors A from the tip, m³: for a closed surface the volume
    /// times the unit matrix. The next field is the sum of the sizes.
    extents: [R::Vec3; 3],
    extent_size: R,
}

/// Error of a body without a vertex.
pub(super) fn no_vertex() -> SceneError {
    SceneError::new("number of vertices", Rule::AtLeast(4), 0.0, "")
}

impl<R: Real> Volume<R> {
    pub(super) fn about(tip: &R::Vec3) -> Self {
        Self {
            tip: *tip,
            volume: R::ZERO,
            first: R::Vec3::ZERO,
            second: [R::Vec3::ZERO; 3],
            area: R::Vec3::ZERO,
            area_size: R::ZERO,
            extents: [R::Vec3::ZERO; 3],
            extent_size: R::ZERO,
        }
    }

    pub(super) fn add(&mut self, corners: [R::Vec3; 3]) {
        let [a, b, c] = corners.map(|corner| corner - self.tip);
        self.add_tetrahedron([a, b, c], a.dot(b.cross(c)) / R::from_f64(6.0));
        let sum = a + b + c;
        let area = (b - a).cross(c - a) * R::HALF;
        self.area += area;
        self.area_size += area.length();
        let centroid = sum * R::from_f64(1.0 / 3.0);
        self.extents[0] += centroid * area.x();
        self.extents[1] += centroid * area.y();
        self.extents[2] += centroid * area.z();
        self.extent_size += centroid.length() * area.length();
    }

    /// Adds a tetrahedron with three corners from the tip and a volume, m³, and no surface.
    pub(super) fn add_tetrahedron(&mut self, [a, b, c]: [R::Vec3; 3], volume: R) {
        let sum = a + b + c;
        self.volume += volume;
        self.first += sum * (volume * R::from_f64(0.25));
        let weight = volume / R::from_f64(20.0);
        for p in [a, b, c, sum] {
            let weighted = p * weight;
            self.second[0] += weighted * p.x();
            self.second[1] += weighted * p.y();
            self.second[2] += weighted * p.z();
        }
    }

    /// Checks that no part of the surface is missing, as far as its sums show it.
    fn check_closed(&self) -> Result<(), SceneError> {
        let open = |gap: R, unit| {
            Err(SceneError::new(
                "the surface",
                Rule::Closed,
                gap.to_f64(),
                unit,
            ))
        };
        let least = R::EPSILON.sqrt();
        let gap = self.area.length();
        let is_closed = gap <= self.area_size * least;
        if !is_closed {
            return open(gap, " m² between its edges");
        }
        let v = self.volume;
        let unit = R::Mat3::from_diagonal(R::Vec3::new(v, v, v)).columns();
        let gaps = [0, 1, 2].map(|i| (self.extents[i] - unit[i]).length());
        let gap = gaps.into_iter().fold(R::ZERO, R::at_least);
        let is_closed = gap <= self.extent_size * least;
        if !is_closed {
            return open(gap, " m³ between its volumes along x, y and z");
        }
        Ok(())
    }

    /// Mass properties of this volume within its surface with a mass, kg.
    pub(super) fn filled_with(&self, mass: R) -> Result<MassProperties<R>, SceneError> {
        finite_mass(mass)?;
        self.check_closed()?;
        self.solid(mass)
    }

    /// Mass properties of this volume with a mass, kg, whatever its surface.
    pub(super) fn solid(&self, mass: R) -> Result<MassProperties<R>, SceneError> {
        finite_mass(mass)?;
        error::above_zero("volume within the surface", self.volume, " m³")?;
        let density = mass / self.volume;
        let centre = self.first * (R::ONE / self.volume);
        // Tensor about the tip, `tr(S) 1 - S`, minus the contribution of the mass at its centre.
        let second = self.second.map(|column| column * density);
        let trace = second[0].x() + second[1].y() + second[2].z();
        let shift = parallel_axis::<R>(mass, centre);
        let unit = R::Mat3::from_diagonal(R::Vec3::new(trace, trace, trace)).columns();
        let column = |i: usize| unit[i] - second[i] - shift[i];
        Ok(MassProperties {
            mass,
            centre_of_mass: self.tip + centre,
            inertia: symmetric::<R>([column(0), column(1), column(2)]),
        })
    }
}

/// Columns of `m (|d|² 1 - d dᵀ)`.
fn parallel_axis<R: Real>(mass: R, d: R::Vec3) -> [R::Vec3; 3] {
    let (x, y, z) = (d.x(), d.y(), d.z());
    let (xy, yz, zx) = (-(x * y), -(y * z), -(z * x));
    [
        R::Vec3::new(y * y + z * z, xy, zx) * mass,
        R::Vec3::new(xy, z * z + x * x, yz) * mass,
        R::Vec3::new(zx, yz, x * x + y * y) * mass,
    ]
}

fn transposed<R: Real>([a, b, c]: [R::Vec3; 3]) -> [R::Vec3; 3] {
    [
        R::Vec3::new(a.x(), b.x(), c.x()),
        R::Vec3::new(a.y(), b.y(), c.y()),
        R::Vec3::new(a.z(), b.z(), c.z()),
    ]
}

/// Mean of a matrix and its transpose, which removes the asymmetry due to rounding.
fn symmetric<R: Real>(columns: [R::Vec3; 3]) -> R::Mat3 {
    let [a, b, c] = columns;
    let [p, q, r] = transposed::<R>(columns);
    let mean = |u: R::Vec3, v: R::Vec3| (u + v) * R::HALF;
    R::Mat3::from_columns([mean(a, p), mean(b, q), mean(c, r)])
}
