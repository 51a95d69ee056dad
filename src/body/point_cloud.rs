//! Body made of the user's own points and masses.

use super::{ContactPoint, RigidPointBody, check_contacts};
use crate::error::{self, Rule, SceneError};
use crate::real::{Matrix, Real, Vector};

/// Body made of the user's own points, each with a mass.
///
/// The centre of mass and the whole inertia tensor are computed. Points may be given about any
/// origin and in any axes. A single point makes a body that does not rotate. Points on a line make
/// a body that does not spin about the line. A mass of 0 makes a contact without weight.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{PointCloud, RigidPointBody};
///
/// let jack = PointCloud::new(
///     [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z * 2.0, -DVec3::Z * 2.0],
///     [0.1; 6],
/// )?;
/// let mass: f64 = jack.mass();
/// assert!((mass - 0.6).abs() < 1e-15);
/// assert_eq!(jack.bounding_radius(), 2.0);
/// # Ok::<(), tumble::SceneError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointCloud<R: Real, P> {
    pub(super) mass: R,
    pub(super) inertia: R::Mat3,
    pub(super) centre: R::Vec3,
    pub(super) points: P,
}

impl<R: Real, const N: usize> PointCloud<R, [ContactPoint<R>; N]> {
    /// Creates a body from points (m, in the user's axes and about the user's origin) and their
    /// masses (kg).
    ///
    /// Masses are at least 0 and not all 0. The type of the points, `DVec3` or `Vec3`, sets the
    /// precision.
    ///
    /// # Errors
    /// Returns [`SceneError`] if there is no point, a coordinate is not finite, or a mass is
    /// negative. It is also returned if the inverse of the sum of the masses is not finite, as for
    /// masses that are all 0.
    // `V` is `R::Vec3`. As a type parameter it lets the compiler infer the precision, which a
    // projection does not.
    pub fn new<V: Vector<R>>(points: [V; N], masses: [R; N]) -> Result<Self, SceneError>
    where
        R: Real<Vec3 = V>,
    {
        Self::with_storage(points.map(ContactPoint::bare), &masses)
    }
}

impl<R: Real, P: AsRef<[ContactPoint<R>]> + AsMut<[ContactPoint<R>]>> PointCloud<R, P> {
    /// Creates a body as [`new`](PointCloud::new) does, from the contacts in `points`: an array, a
    /// borrowed slice, or a `Vec`.
    ///
    /// Each contact may have a radius. The contacts are shifted in place so that the centre of mass
    /// is their origin.
    ///
    /// # Errors
    /// Returns [`SceneError`] if there is no point, the numbers of points and masses differ, a
    /// coordinate is not finite, or a mass or radius is negative. It is also returned if the
    /// inverse of the sum of the masses is not finite, as for masses that are all 0.
    pub fn with_storage(mut points: P, masses: &[R]) -> Result<Self, SceneError> {
        check_masses(points.as_ref().len(), masses)?;
        check_contacts(points.as_ref())?;
        let places = points.as_mut();
        let mass = sum(masses.iter().copied());
        check_sum(mass)?;
        let moment = sum_of_vectors(|| weighted(places, masses), |p| p);
        let centre = moment * (R::ONE / mass);
        for place in places.iter_mut() {
            place.position -= centre;
        }
        let inertia = inertia_of(|| weighted(places, masses));
        Ok(Self {
            mass,
            inertia,
            centre,
            points,
        })
    }
}

impl<R: Real, P> PointCloud<R, P> {
    /// Position of the centre of mass from the origin about which the points were given, m, body
    /// axes.
    #[must_use]
    pub fn centre_of_mass(&self) -> R::Vec3 {
        self.centre
    }
}

impl<R: Real, P: AsRef<[ContactPoint<R>]>> RigidPointBody<R> for PointCloud<R, P> {
    #[inline]
    fn mass(&self) -> R {
        self.mass
    }
    #[inline]
    fn inertia(&self) -> R::Mat3 {
        self.inertia
    }
    #[inline]
    fn contacts(&self) -> &[ContactPoint<R>] {
        self.points.as_ref()
    }
}

/// Positions of points with their masses.
fn weighted<R: Real>(
    points: &[ContactPoint<R>],
    masses: &[R],
) -> impl Iterator<Item = (R::Vec3, R)> {
    points
        .iter()
        .map(|point| point.position)
        .zip(masses.iter().copied())
}

/// Checks that there are points, as many masses as points, and no negative mass.
pub(super) fn check_masses<R: Real>(points: usize, masses: &[R]) -> Result<(), SceneError> {
    let counted = |quantity, rule, count: usize| {
        SceneError::new(quantity, rule, R::from_usize(count).to_f64(), "")
    };
    if points == 0 {
        return Err(counted("number of points", Rule::AtLeast(1), 0));
    }
    if masses.len() != points {
        let rule = Rule::Exactly(points);
        return Err(counted("number of masses", rule, masses.len()));
    }
    for &mass in masses {
        error::at_least_zero("mass of a point", mass, " kg")?;
    }
    Ok(())
}

/// Checks that the sum of the masses is above 0 and has a finite inverse, which gives the centre of
/// mass.
pub(super) fn check_sum<R: Real>(mass: R) -> Result<(), SceneError> {
    error::above_zero("mass of all points", mass, " kg")?;
    error::finite_inverse("mass of all points", mass, " kg")
}

/// Computes `Σ m (|p|² 1 - p pᵀ)` about the origin, for positions and their masses.
pub(super) fn inertia_of<R: Real, I: Iterator<Item = (R::Vec3, R)>>(
    weighted: impl Fn() -> I,
) -> R::Mat3 {
    let squares = sum_of_vectors(&weighted, |p| {
        R::Vec3::new(p.x() * p.x(), p.y() * p.y(), p.z() * p.z())
    });
    let products = sum_of_vectors(&weighted, |p| {
        R::Vec3::new(p.y() * p.z(), p.z() * p.x(), p.x() * p.y())
    });
    let (xx, yy, zz) = (squares.x(), squares.y(), squares.z());
    let (yz, zx, xy) = (-products.x(), -products.y(), -products.z());
    R::Mat3::from_columns([
        R::Vec3::new(yy + zz, xy, zx),
        R::Vec3::new(xy, xx + zz, yz),
        R::Vec3::new(zx, yz, xx + yy),
    ])
}

/// Computes `Σ m f(p)` for positions and their masses.
pub(super) fn sum_of_vectors<R: Real, I: Iterator<Item = (R::Vec3, R)>>(
    weighted: impl Fn() -> I,
    of: impl Fn(R::Vec3) -> R::Vec3,
) -> R::Vec3 {
    let component =
        |pick: fn(R::Vec3) -> R| sum(weighted().map(|(place, mass)| mass * pick(of(place))));
    R::Vec3::new(
        component(R::Vec3::x),
        component(R::Vec3::y),
        component(R::Vec3::z),
    )
}

/// Computes a sum by Kahan's method. Its rounding does not grow with the number of terms, so that
/// ten thousand points on a line are still a line.
pub(super) fn sum<R: Real>(terms: impl Iterator<Item = R>) -> R {
    let (mut total, mut lost) = (R::ZERO, R::ZERO);
    for term in terms {
        let corrected = term - lost;
        let next = total + corrected;
        lost = (next - total) - corrected;
        total = next;
    }
    total
}

#[cfg(test)]
mod tests {
    extern crate alloc;

    use super::*;
    use crate::body::InertiaProperties;
    use alloc::vec::Vec;
    use glam::DVec3;

    #[test]
    fn the_centre_of_mass_becomes_the_origin() {
        let cloud = PointCloud::new(
            [DVec3::new(1.0, 0.0, 0.0), DVec3::new(4.0, 0.0, 0.0)],
            [2.0, 1.0],
        )
        .unwrap();
        assert_eq!(cloud.centre_of_mass(), DVec3::new(2.0, 0.0, 0.0));
        assert_eq!(cloud.contacts()[1].position, DVec3::new(2.0, 0.0, 0.0));
    }

    #[test]
    fn ten_thousand_points_on_a_slanted_line_are_a_rod() {
        let direction = DVec3::new(0.3, -0.7, 1.1);
        let points = Vec::from_iter(
            (0..10_000).map(|i| ContactPoint::bare(direction * (f64::from(i) * 1e-3) + DVec3::ONE)),
        );
        let masses = std::vec![0.1; 10_000];
        let rod = PointCloud::with_storage(points, &masses).unwrap();
        let found = InertiaProperties::<f64>::new(rod.mass(), rod.inertia()).unwrap();
        let axes = crate::rotation::Rotation::<f64>::IDENTITY.axes();
        let spin = found.angular_velocity(&axes, direction * 1e3);
        // About the line the body does not rotate. Across it, the spin is due to rounding of the
        // direction.
        assert!(spin.length() < 1e-11, "{spin}");
    }

    #[test]
    fn bad_points_and_masses_are_refused() {
        let one = [DVec3::X];
        let message = |result: Result<PointCloud<f64, [ContactPoint; 1]>, SceneError>| {
            std::format!("{}", result.unwrap_err())
        };
        assert_eq!(
            message(PointCloud::new(one, [-1.0])),
            "mass of a point must be at least 0, got -1 kg"
        );
        assert_eq!(
            message(PointCloud::new(one, [0.0])),
            "mass of all points must be above 0, got 0 kg"
        );
        assert_eq!(
            message(PointCloud::new([DVec3::NAN], [1.0])),
            "x of a contact point must be finite, got NaN m"
        );
        let none = PointCloud::<f64, _>::new([], []).unwrap_err();
        assert_eq!(
            std::format!("{none}"),
            "number of points must be at least 1, got 0"
        );
    }
}
