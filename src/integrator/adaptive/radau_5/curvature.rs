//! Curved ground in the Jacobian.
//!
//! On curved ground the normal `n` rotates as a contact moves along it. As it rotates, the contact
//! of a ball or of a smooth body moves over the body's surface. Let `S` be the derivative of the
//! normal along the ground, and `H` that of the arm with respect to the normal. A contact that
//! moves by `p` on its tangent plane then has
//!
//! ```text
//! δn = S (p + H δn) = (1 - S H)⁻¹ S p        δr = H δn
//! ```
//!
//! `H` of a ball is minus its radius. In general it follows from the displacement `M ϑ` of the arm
//! `r` by a rotation of the body alone. If body and normal are rotated together, the arm is rotated
//! too: `H (ϑ × n) = ϑ × r - M ϑ`.
//!
//! A force that depends on the normal and on the velocity `u` of the contact is rotated with both.
//! With `θ = n × δn`, the rotation of the normal, and the derivative `Q` by the velocity:
//!
//! ```text
//! δF = θ × F + Q (ω × δr - θ × u)
//! ```
//!
//! `Q` of friction in stick is large, so this term matters for a body that rolls on curved ground.

use crate::contact::{Contact, any_across};
use crate::ground::SpringDamperGround;
use crate::integrator::matrix3::Matrix3;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, size};

/// Smallest determinant of `1 - S H`. It is 0 where the ground is curved as the body is.
const LEAST_DETERMINANT: f64 = 1e-3;

/// Changes of a contact on curved ground, per displacement on its tangent plane.
pub(super) struct Curved<R: Real> {
    normal: R::Vec3,
    /// Change of the normal, 1/m.
    change: Matrix3<R>,
    /// Displacement of the arm over the body.
    pub(super) over: Matrix3<R>,
}

impl<R: Real> Curved<R> {
    /// Changes of a contact. `moved` is `M`. `None` if the contact is fixed in the body, or if the
    /// surface is a plane.
    pub(super) fn at<D: Dynamics<R>>(
        scene: &D,
        contact: &Contact<R>,
        moved: &Matrix3<R>,
    ) -> Option<Self> {
        let model = scene.contact_model();
        if model.has_bare_points() || model.plane_of(contact.surface).is_some() {
            return None;
        }
        let normal = contact.normal;
        let first = any_across::<R>(normal);
        let tangents = [first, normal.cross(first)];
        let by_normal = tangents.map(|tangent| {
            let rotation = normal.cross(tangent);
            rotation.cross(contact.arm) - moved.times(rotation)
        });
        let arm = in_plane(&tangents, &by_normal);
        let ground = in_plane(&tangents, &changes_of_normal(scene, contact, &tangents));
        let change = solved(&ground, &arm)?;
        Some(Self {
            normal,
            change: in_space(&tangents, &change),
            over: in_space(&tangents, &product(&arm, &change)),
        })
    }

    /// Change of a vector that is rotated with the normal.
    pub(super) fn rotated(&self, vector: R::Vec3) -> Matrix3<R> {
        let Matrix3 { x, y, z } = self.change;
        let along = R::Vec3::new(x.dot(vector), y.dot(vector), z.dot(vector));
        let rising = self.change.scaled(self.normal.dot(vector));
        rising.plus(&Matrix3::outer(-self.normal, along))
    }
}

/// Change of the ground's normal along each tangent, per displacement, 1/m.
fn changes_of_normal<R: Real, D: Dynamics<R>>(
    scene: &D,
    contact: &Contact<R>,
    tangents: &[R::Vec3; 2],
) -> [R::Vec3; 2] {
    let (ground, _) = contact.laws(scene.ground(), scene.friction());
    // Far from the origin the rounding of the position needs a longer one.
    let resolved = contact.position.length() * (R::EPSILON * R::from_f64(64.0));
    let nudge = (size(scene) * R::EPSILON.sqrt()).at_least(resolved);
    scene.probe(|| {
        let here = ground.surface(contact.position).normal;
        tangents.map(|tangent| {
            let there = ground.surface(contact.position + tangent * nudge).normal;
            (there - here) * (R::ONE / nudge)
        })
    })
}

/// Matrix in the tangent plane, whose columns are two vectors.
fn in_plane<R: Real>(tangents: &[R::Vec3; 2], columns: &[R::Vec3; 2]) -> [[R; 2]; 2] {
    tangents.map(|tangent| columns.map(|column| tangent.dot(column)))
}

/// The matrix in space.
fn in_space<R: Real>(tangents: &[R::Vec3; 2], matrix: &[[R; 2]; 2]) -> Matrix3<R> {
    let [one, two] = *tangents;
    let row = |[a, b]: [R; 2], to: R::Vec3| Matrix3::outer(to, one * a + two * b);
    row(matrix[0], one).plus(&row(matrix[1], two))
}

/// Returns `(1 - S H)⁻¹ S`, or `None` if the inverse does not exist.
fn solved<R: Real>(s: &[[R; 2]; 2], h: &[[R; 2]; 2]) -> Option<[[R; 2]; 2]> {
    let [[a, b], [c, d]] = product(s, h);
    let (a, d) = (R::ONE - a, R::ONE - d);
    let determinant = a * d - b * c;
    // False for a NaN, too.
    (determinant.abs() > R::from_f64(LEAST_DETERMINANT)).then(|| {
        let inverse = [[d, b], [c, a]].map(|row| row.map(|value| value / determinant));
        product(&inverse, s)
    })
}

fn product<R: Real>(one: &[[R; 2]; 2], two: &[[R; 2]; 2]) -> [[R; 2]; 2] {
    let [[a, b], [c, d]] = *two;
    one.map(|[x, y]| [x * a + y * c, x * b + y * d])
}
