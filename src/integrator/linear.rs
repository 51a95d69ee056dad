//! The six equations of a rigid body in an implicit step, and their solution by Gaussian
//! elimination.

use crate::integrator::matrix3::Matrix3;
use crate::real::{Real, Vector};

/// Six linear equations of a rigid body: force and torque, row by row, as functions of a shift and
/// a rotation.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrator) struct SixBySix<R: Real> {
    pub(in crate::integrator) rows: [[R; 6]; 6],
}

impl<R: Real> SixBySix<R> {
    pub(in crate::integrator) const ZERO: Self = Self {
        rows: [[R::ZERO; 6]; 6],
    };

    /// Creates equations in which the force depends only on the shift and the torque only on the
    /// rotation.
    #[inline]
    pub(in crate::integrator) fn of_body(mass: R, inertia: &Matrix3<R>) -> Self {
        let o = R::ZERO;
        let [x, y, z] = inertia.rows();
        Self {
            rows: [
                [mass, o, o, o, o, o],
                [o, mass, o, o, o, o],
                [o, o, mass, o, o, o],
                [o, o, o, x.x(), x.y(), x.z()],
                [o, o, o, y.x(), y.y(), y.z()],
                [o, o, o, z.x(), z.y(), z.z()],
            ],
        }
    }

    /// Adds a force at `arm` that depends linearly on the path of the point `place`:
    /// `block (ξ + ϑ × place)`. A rotation `ϑ` moves that point by `ϑ × place`.
    pub(in crate::integrator) fn add_at(
        &mut self,
        block: &Matrix3<R>,
        arm: R::Vec3,
        place: R::Vec3,
    ) {
        let shift = block.rows();
        self.add(shift, shift.map(|row| place.cross(row)), arm);
    }

    /// Adds a force on level ground that depends linearly on the path of the point `place` where it
    /// acts: by `along` on the horizontal path, by `across` on the vertical one.
    pub(in crate::integrator) fn add_on_level(&mut self, [along, across]: [R; 2], place: R::Vec3) {
        let (x, y, z) = (place.x(), place.y(), place.z());
        let (ax, ay, az) = (along * x, along * y, along * z);
        let (cx, cy) = (across * x, across * y);
        let (leaning, azz) = (cx * y, az * z);
        let [fx, fy, fz, tx, ty, tz] = &mut self.rows;
        (fx[0], fx[4], fx[5]) = (fx[0] + along, fx[4] + az, fx[5] - ay);
        (fy[1], fy[3], fy[5]) = (fy[1] + along, fy[3] - az, fy[5] + ax);
        (fz[2], fz[3], fz[4]) = (fz[2] + across, fz[3] + cy, fz[4] - cx);
        (tx[1], tx[2]) = (tx[1] - az, tx[2] + cy);
        (tx[3], tx[4], tx[5]) = (tx[3] + azz + cy * y, tx[4] - leaning, tx[5] - ax * z);
        (ty[0], ty[2]) = (ty[0] + az, ty[2] - cx);
        (ty[3], ty[4], ty[5]) = (ty[3] - leaning, ty[4] + azz + cx * x, ty[5] - ay * z);
        (tz[0], tz[1]) = (tz[0] - ay, tz[1] + ax);
        (tz[3], tz[4], tz[5]) = (tz[3] - ax * z, tz[4] - ay * z, tz[5] + (ax * x + ay * y));
    }

    /// Adds a force at `arm`, given by the rows of its derivatives with respect to the shift and to
    /// the rotation.
    #[inline(always)]
    pub(in crate::integrator) fn add(
        &mut self,
        shift: [R::Vec3; 3],
        turn: [R::Vec3; 3],
        arm: R::Vec3,
    ) {
        let row = |s: R::Vec3, t: R::Vec3| [s.x(), s.y(), s.z(), t.x(), t.y(), t.z()];
        let [x, y, z] = [
            row(shift[0], turn[0]),
            row(shift[1], turn[1]),
            row(shift[2], turn[2]),
        ];
        let [fx, fy, fz, tx, ty, tz] = &mut self.rows;
        for j in 0..6 {
            fx[j] += x[j];
            fy[j] += y[j];
            fz[j] += z[j];
            tx[j] += z[j] * arm.y() - y[j] * arm.z();
            ty[j] += x[j] * arm.z() - z[j] * arm.x();
            tz[j] += y[j] * arm.x() - x[j] * arm.y();
        }
    }

    /// Adds the torque of a force whose lever arm a rotation moves by `ϑ × place`:
    /// `(ϑ × place) × force`.
    #[inline(always)]
    pub(in crate::integrator) fn add_rotation(&mut self, place: R::Vec3, force: R::Vec3) {
        let along = force.dot(place);
        let [_, _, _, x, y, z] = &mut self.rows;
        let by = |row: &mut [R; 6], arm: R| {
            row[3] += arm * force.x();
            row[4] += arm * force.y();
            row[5] += arm * force.z();
        };
        by(x, place.x());
        by(y, place.y());
        by(z, place.z());
        x[3] -= along;
        y[4] -= along;
        z[5] -= along;
    }

    /// Adds other equations of the same unknowns.
    #[cold]
    #[inline(never)]
    pub(in crate::integrator) fn plus(&mut self, other: &Self) {
        for (row, more) in self.rows.iter_mut().zip(&other.rows) {
            for (entry, more) in row.iter_mut().zip(more) {
                *entry += *more;
            }
        }
    }

    /// Adds a torque that depends only on the rotation.
    pub(in crate::integrator) fn add_turning(&mut self, block: &Matrix3<R>) {
        let [_, _, _, rows @ ..] = &mut self.rows;
        for (row, more) in rows.iter_mut().zip(block.rows()) {
            row[3] += more.x();
            row[4] += more.y();
            row[5] += more.z();
        }
    }

    /// Adds a torque that depends on the path of the point `place` along `normal`:
    /// `torque (normal · (ξ + ϑ × place))`.
    pub(in crate::integrator) fn add_torque(
        &mut self,
        torque: R::Vec3,
        normal: R::Vec3,
        place: R::Vec3,
    ) {
        let turn = place.cross(normal);
        let [_, _, _, rows @ ..] = &mut self.rows;
        let torques = [torque.x(), torque.y(), torque.z()];
        for ([a, b, c, d, e, f], torque) in rows.iter_mut().zip(torques) {
            (*a, *b, *c) = (
                *a + normal.x() * torque,
                *b + normal.y() * torque,
                *c + normal.z() * torque,
            );
            (*d, *e, *f) = (
                *d + turn.x() * torque,
                *e + turn.y() * torque,
                *f + turn.z() * torque,
            );
        }
    }

    /// Returns the equations without the dependence of the force on the rotation and of the torque
    /// on the shift.
    pub(in crate::integrator) fn uncoupled(&self) -> Self {
        let mut rows = self.rows;
        for (i, row) in rows.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                if (i < 3) != (j < 3) {
                    *entry = R::ZERO;
                }
            }
        }
        Self { rows }
    }

    /// Solves for the shift and the rotation caused by a force and a torque.
    pub(in crate::integrator) fn solve(
        &self,
        force: R::Vec3,
        torque: R::Vec3,
        length: R,
    ) -> (R::Vec3, R::Vec3) {
        Factored::of(*self, length).solve(force, torque, length)
    }

    #[cold]
    fn solve_heavier(&self, force: R::Vec3, torque: R::Vec3, length: R) -> (R::Vec3, R::Vec3) {
        let share = R::EPSILON.sqrt();
        let mut heavier = *self;
        let [a, b, c, d, e, f] = &mut heavier.rows;
        let raised = |x: &mut R, y: &mut R, z: &mut R| {
            let more = (x.abs() + y.abs() + z.abs()) * share;
            *x += more;
            *y += more;
            *z += more;
        };
        raised(&mut a[0], &mut b[1], &mut c[2]);
        raised(&mut d[3], &mut e[4], &mut f[5]);
        let mut factors = Factors::NONE;
        heavier.factor(length, &mut factors);
        factors.solve(force, torque)
    }

    /// Factors the matrix into triangular ones by Gaussian elimination. Rotations and torques are
    /// scaled with `length`, a size of the body, so that pivots have the same unit for any size.
    /// Inertia and springs make the diagonal large. Rows are exchanged only if a pivot is small
    /// compared with the entries below it.
    #[inline]
    fn factor(&self, length: R, factors: &mut Factors<R>) {
        self.fill(length, factors);
        if !factors.eliminate() {
            self.factor_with_exchanges(length, factors);
        }
    }

    #[cold]
    fn factor_with_exchanges(&self, length: R, factors: &mut Factors<R>) {
        self.fill(length, factors);
        factors.order = [0, 1, 2, 3, 4, 5];
        factors.exchanged = true;
        factors.eliminate_with_exchanges();
    }

    #[inline]
    fn fill(&self, length: R, factors: &mut Factors<R>) {
        let per_length = R::ONE / length;
        let square = per_length * per_length;
        let scales = [R::ONE, per_length, square];
        for i in 0..6 {
            for j in 0..6 {
                factors.rows[i][j] = self.rows[i][j] * scales[i / 3 + j / 3];
            }
        }
        factors.per_length = per_length;
        factors.exchanged = false;
    }
}

/// Six equations with their factors.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrator) struct Factored<R: Real> {
    pub(in crate::integrator) equations: SixBySix<R>,
    factors: Factors<R>,
}

impl<R: Real> Factored<R> {
    /// Computes the factors of these equations.
    pub(in crate::integrator) fn of(equations: SixBySix<R>, length: R) -> Self {
        let mut factored = Self {
            equations,
            ..Self::NONE
        };
        factored.factor(length);
        factored
    }

    pub(in crate::integrator) const NONE: Self = Self {
        equations: SixBySix::ZERO,
        factors: Factors::NONE,
    };

    /// Computes the factors of the equations.
    #[inline]
    pub(in crate::integrator) fn factor(&mut self, length: R) {
        self.equations.factor(length, &mut self.factors);
    }

    /// Solves for the shift and the rotation caused by a force and a torque. If the stiffness
    /// exceeds the inertia beyond rounding, the matrix is singular. The inertia is then increased
    /// by the square root of the rounding, which gives smaller steps in a usable direction.
    #[inline]
    pub(in crate::integrator) fn solve(
        &self,
        force: R::Vec3,
        torque: R::Vec3,
        length: R,
    ) -> (R::Vec3, R::Vec3) {
        let (shift, turn) = self.factors.solve(force, torque);
        // A value that is not finite does not give 0. This takes fewer operations than six checks.
        let nothing = (shift + turn) * R::ZERO;
        if nothing.x() + nothing.y() + nothing.z() == R::ZERO {
            return (shift, turn);
        }
        self.equations.solve_heavier(force, torque, length)
    }
}

/// The factors of six equations.
#[derive(Clone, Copy, Debug)]
struct Factors<R: Real> {
    /// Triangular factors: the upper one above the diagonal, the lower one below it. The diagonal
    /// of the lower factor is 1.
    rows: [[R; 6]; 6],
    /// Inverse of the diagonal of the upper factor.
    inverse: [R; 6],
    /// Equation that each row comes from, if rows have been exchanged.
    order: [u8; 6],
    exchanged: bool,
    per_length: R,
}

/// Largest allowed ratio of an entry below a pivot to the pivot.
const LARGEST_FACTOR: f64 = 16.0;

impl<R: Real> Factors<R> {
    const NONE: Self = Self {
        rows: [[R::ZERO; 6]; 6],
        inverse: [R::ZERO; 6],
        order: [0; 6],
        exchanged: false,
        per_length: R::ZERO,
    };

    /// Eliminates all columns, with one function per column, so that every index is known at
    /// compile time. Returns true if every pivot is large enough.
    #[inline(always)]
    fn eliminate(&mut self) -> bool {
        self.eliminate_column::<0>()
            && self.eliminate_column::<1>()
            && self.eliminate_column::<2>()
            && self.eliminate_column::<3>()
            && self.eliminate_column::<4>()
            && self.eliminate_column::<5>()
    }

    /// Eliminates the entries of a column in the rows below.
    #[inline(always)]
    fn eliminate_column<const P: usize>(&mut self) -> bool {
        let rows = &mut self.rows;
        let upper = rows[P];
        let inverse = R::ONE / upper[P];
        self.inverse[P] = inverse;
        let mut largest = R::ZERO;
        for row in rows.iter_mut().skip(P + 1) {
            let factor = row[P] * inverse;
            row[P] = factor;
            largest = largest.at_least(factor.abs());
            for column in P + 1..6 {
                row[column] -= factor * upper[column];
            }
        }
        largest <= R::from_f64(LARGEST_FACTOR)
    }

    /// Eliminates all columns, moving the row with the largest entry of a column up first.
    fn eliminate_with_exchanges(&mut self) {
        let rows = &mut self.rows;
        for p in 0..6 {
            for below in p + 1..6 {
                if rows[below][p].abs() > rows[p][p].abs() {
                    rows.swap(p, below);
                    self.order.swap(p, below);
                }
            }
            let upper = rows[p];
            let inverse = R::ONE / upper[p];
            self.inverse[p] = inverse;
            for row in rows.iter_mut().skip(p + 1) {
                let factor = row[p] * inverse;
                row[p] = factor;
                for column in p + 1..6 {
                    row[column] -= factor * upper[column];
                }
            }
        }
    }

    /// Solves for the shift and the rotation caused by a force and a torque. The result is not
    /// finite if the matrix is singular.
    #[inline]
    fn solve(&self, force: R::Vec3, torque: R::Vec3) -> (R::Vec3, R::Vec3) {
        let torque = torque * self.per_length;
        let right = [
            force.x(),
            force.y(),
            force.z(),
            torque.x(),
            torque.y(),
            torque.z(),
        ];
        let x = self.substitute(if self.exchanged {
            self.exchange(right)
        } else {
            right
        });
        (
            R::Vec3::new(x[0], x[1], x[2]),
            R::Vec3::new(x[3], x[4], x[5]) * self.per_length,
        )
    }

    #[cold]
    fn exchange(&self, right: [R; 6]) -> [R; 6] {
        (self.order).map(|equation| right.get(usize::from(equation)).copied().unwrap_or(R::ZERO))
    }

    #[inline(always)]
    fn substitute(&self, mut x: [R; 6]) -> [R; 6] {
        let rows = &self.rows;
        for j in 0..5 {
            for i in j + 1..6 {
                x[i] -= rows[i][j] * x[j];
            }
        }
        for j in (0..6).rev() {
            x[j] *= self.inverse[j];
            for i in 0..j {
                x[i] -= rows[i][j] * x[j];
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// On level ground the block is diagonal.
    #[test]
    fn a_force_on_level_ground_has_the_entries_of_any_force() {
        let (along, across) = (3.0, 7.0);
        let block = Matrix3 {
            x: DVec3::X * along,
            y: DVec3::Y * along,
            z: DVec3::Z * across,
        };
        let place = DVec3::new(2.0, -5.0, 11.0);
        // All entries are whole numbers, so that no sum rounds. They are not 0 at the start.
        let rows = core::array::from_fn(|row| core::array::from_fn(|j| (7 * row + j) as f64));
        let start = SixBySix::<f64> { rows };
        let (mut level, mut any) = (start, start);
        level.add_on_level([along, across], place);
        any.add_at(&block, place, place);
        assert_eq!(level.rows, any.rows);
        assert_ne!(level.rows, rows);
    }
}
