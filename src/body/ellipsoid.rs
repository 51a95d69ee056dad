//! Smooth ellipsoid with any mass distribution, such as an egg.

use super::{ContactPoint, MassProperties, RigidPointBody, homogeneous};
use crate::error::{self, SceneError};
use crate::real::{Real, Vector};

/// Ellipsoid with its semi-axes along the body axes.
///
/// Its one contact moves over its surface to the point that faces the ground.
///
/// The contact point is `s = (a² d_x, b² d_y, c² d_z)/h`. Here a, b, c are the semi-axes and d is
/// the direction to the ground. The distance of the tangent plane from the middle is
/// `h = √(a² d_x² + b² d_y² + c² d_z²)`. The point is the gradient of the support function h
/// (Schneider, *Convex Bodies: The Brunn-Minkowski Theory*, section 1.7). The force acts there.
/// The slip velocity is that of the body's material there, `v + ω × s`.
///
/// *Limits:* the contact is where the normals of body and ground are opposite. Penetration depth
/// and force are exact there, on a plane, on hills (the tests go to three times the curvature of
/// the body), and in valleys that are less curved than the body. A valley as curved as the body, or
/// an edge, would be touched at more than one point. The contact is then that for the normal under
/// the middle or an opposite one, and may jump between them as the body moves. Its force has no
/// potential, the energy error of a [`Ledger`](crate::Ledger) does not tend to 0, and a method with
/// a tolerance may end with [`StepTooShort`](crate::StepError::StepTooShort). With `EnergyMomentum`
/// the computed energy never increases there either. The force of one contact has no moment about
/// the contact point, so an ellipsoid that spins on a point loses its spin only with
/// [`WithResistance`](crate::WithResistance).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid<R: Real = f64> {
    pub(super) distribution: MassProperties<R>,
    semi_axes: R::Vec3,
    /// Ball inside the ellipsoid, which represents it in `contacts`.
    within: [ContactPoint<R>; 1],
}

// A parameter type `V` of a method is `R::Vec3`. As a type parameter it lets the compiler infer the
// precision, which a projection does not.
impl<R: Real> Ellipsoid<R> {
    /// Creates a homogeneous ellipsoid: moments `m (b² + c²)/5` and so on. Mass in kg, semi-axes in
    /// m.
    #[must_use]
    pub fn solid<V: Vector<R>>(mass: R, semi_axes: V) -> Self
    where
        R: Real<Vec3 = V>,
    {
        Self::loaded(semi_axes, homogeneous::ellipsoid(mass, semi_axes))
    }

    /// Creates an ellipsoid with these semi-axes (m), its middle at the origin and any mass
    /// distribution.
    #[must_use]
    pub fn loaded<V: Vector<R>>(semi_axes: V, distribution: MassProperties<R>) -> Self
    where
        R: Real<Vec3 = V>,
    {
        let least = semi_axes.x().at_most(semi_axes.y()).at_most(semi_axes.z());
        Self {
            semi_axes,
            within: [ContactPoint {
                // Subtracted from zero to avoid `-0` if there is no offset.
                position: R::Vec3::ZERO - distribution.centre_of_mass,
                radius: least,
            }],
            distribution,
        }
    }

    /// Semi-axes, m.
    #[inline]
    #[must_use]
    pub fn semi_axes(&self) -> R::Vec3 {
        self.semi_axes
    }

    /// Middle of the ellipsoid from the centre of mass, m, body axes.
    #[inline]
    #[must_use]
    pub fn middle(&self) -> R::Vec3 {
        let [within] = self.within;
        within.position
    }
}

impl<R: Real> RigidPointBody<R> for Ellipsoid<R> {
    #[inline]
    fn mass(&self) -> R {
        self.distribution.mass
    }
    #[inline]
    fn inertia(&self) -> R::Mat3 {
        self.distribution.inertia
    }
    #[inline]
    fn contacts(&self) -> &[ContactPoint<R>] {
        &self.within
    }
    /// Radius of a ball around the ellipsoid, m.
    ///
    /// It is not less than the distance of the farthest point. It exceeds that distance by at most
    /// the middle's offset.
    #[inline]
    fn bounding_radius(&self) -> R {
        let (a, b, c) = (self.semi_axes.x(), self.semi_axes.y(), self.semi_axes.z());
        self.middle().length() + a.at_least(b).at_least(c)
    }
    #[inline]
    fn is_smooth(&self) -> bool {
        true
    }
    #[inline]
    fn support_point(&self, towards: R::Vec3) -> R::Vec3 {
        // Scaled by the largest semi-axis, so that no square of a length overflows or vanishes.
        let (a, b, c) = (self.semi_axes.x(), self.semi_axes.y(), self.semi_axes.z());
        let scale = a.at_least(b).at_least(c);
        let ratios = [a / scale, b / scale, c / scale];
        let [x, y, z] = ratios;
        let stretched = R::Vec3::new(x * towards.x(), y * towards.y(), z * towards.z());
        let height = stretched.length();
        if height > R::ZERO {
            let factor = scale / height;
            let place = R::Vec3::new(x * stretched.x(), y * stretched.y(), z * stretched.z());
            self.middle() + place * factor
        } else {
            self.middle()
        }
    }
    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("x semi-axis of the ellipsoid", self.semi_axes.x(), " m")?;
        error::above_zero("y semi-axis of the ellipsoid", self.semi_axes.y(), " m")?;
        error::above_zero("z semi-axis of the ellipsoid", self.semi_axes.z(), " m")?;
        error::above_zero("mass of the ellipsoid", self.distribution.mass, " kg")?;
        self.distribution.check()
    }
}
