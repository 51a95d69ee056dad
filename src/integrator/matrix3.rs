//! 3 by 3 matrices of an implicit step.

use crate::real::{Real, Vector};

/// 3 by 3 matrix, stored by columns.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrator) struct Matrix3<R: Real> {
    pub(in crate::integrator) x: R::Vec3,
    pub(in crate::integrator) y: R::Vec3,
    pub(in crate::integrator) z: R::Vec3,
}

impl<R: Real> Matrix3<R> {
    pub(in crate::integrator) const ZERO: Self = Self {
        x: R::Vec3::ZERO,
        y: R::Vec3::ZERO,
        z: R::Vec3::ZERO,
    };

    /// Returns `value` times the unit matrix.
    #[inline]
    pub(in crate::integrator) fn diagonal(value: R) -> Self {
        let o = R::ZERO;
        Self {
            x: R::Vec3::new(value, o, o),
            y: R::Vec3::new(o, value, o),
            z: R::Vec3::new(o, o, value),
        }
    }

    /// Matrix of the vector product: `hat(a) b = a × b`.
    #[inline]
    pub(in crate::integrator) fn hat(a: R::Vec3) -> Self {
        let o = R::ZERO;
        Self {
            x: R::Vec3::new(o, a.z(), -a.y()),
            y: R::Vec3::new(-a.z(), o, a.x()),
            z: R::Vec3::new(a.y(), -a.x(), o),
        }
    }

    /// Difference between a vector rotated by the Cayley map of `a` and the vector itself, as a
    /// matrix: `2 (â + â²)/(1 + |a|²)`, with `â² = a aᵀ - |a|²`.
    #[inline]
    pub(in crate::integrator) fn rotation_change(a: R::Vec3) -> Self {
        let (x, y, z) = (a.x() * a.x(), a.y() * a.y(), a.z() * a.z());
        let scale = R::TWO / (R::ONE + (x + y + z));
        let (xy, yz, zx) = (a.x() * a.y(), a.y() * a.z(), a.z() * a.x());
        Self {
            x: R::Vec3::new(-(y + z), xy + a.z(), zx - a.y()) * scale,
            y: R::Vec3::new(xy - a.z(), -(z + x), yz + a.x()) * scale,
            z: R::Vec3::new(zx + a.y(), yz - a.x(), -(x + y)) * scale,
        }
    }

    /// Outer product `a bᵀ`.
    #[inline]
    pub(in crate::integrator) fn outer(a: R::Vec3, b: R::Vec3) -> Self {
        Self {
            x: a * b.x(),
            y: a * b.y(),
            z: a * b.z(),
        }
    }

    #[inline]
    pub(in crate::integrator) fn times(&self, v: R::Vec3) -> R::Vec3 {
        self.x * v.x() + self.y * v.y() + self.z * v.z()
    }

    #[inline]
    pub(in crate::integrator) fn times_matrix(&self, other: &Self) -> Self {
        Self {
            x: self.times(other.x),
            y: self.times(other.y),
            z: self.times(other.z),
        }
    }

    /// Product `hat(a) self`: the cross product of `a` with each column.
    #[inline]
    pub(in crate::integrator) fn crossed_by(&self, a: R::Vec3) -> Self {
        Self {
            x: a.cross(self.x),
            y: a.cross(self.y),
            z: a.cross(self.z),
        }
    }

    #[inline]
    pub(in crate::integrator) fn plus(&self, other: &Self) -> Self {
        Self {
            x: self.x + other.x,
            y: self.y + other.y,
            z: self.z + other.z,
        }
    }

    /// `1 - â + a aᵀ`: twice the derivative of a Cayley argument `a` with respect to a rotation of
    /// the end of the step.
    #[inline]
    pub(in crate::integrator) fn by_turn(a: R::Vec3) -> Self {
        Self::diagonal(R::ONE)
            .plus(&Self::hat(-a))
            .plus(&Self::outer(a, a))
    }

    /// Solves `self v = b` by Cramer's rule, for a matrix that is far from singular.
    #[inline]
    pub(in crate::integrator) fn solve(&self, b: R::Vec3) -> R::Vec3 {
        let normal = self.y.cross(self.z);
        let per = R::ONE / self.x.dot(normal);
        R::Vec3::new(
            b.dot(normal) * per,
            self.x.dot(b.cross(self.z)) * per,
            self.x.dot(self.y.cross(b)) * per,
        )
    }

    /// Returns the three rows.
    #[inline]
    pub(in crate::integrator) fn rows(&self) -> [R::Vec3; 3] {
        let (a, b, c) = (self.x, self.y, self.z);
        [
            R::Vec3::new(a.x(), b.x(), c.x()),
            R::Vec3::new(a.y(), b.y(), c.y()),
            R::Vec3::new(a.z(), b.z(), c.z()),
        ]
    }

    #[inline]
    pub(in crate::integrator) fn scaled(&self, factor: R) -> Self {
        Self {
            x: self.x * factor,
            y: self.y * factor,
            z: self.z * factor,
        }
    }
}
