//! Small linear algebra of an implicit step: 3 by 3 blocks, and the six equations of a rigid body.

use crate::real::{Real, Vector};

/// A 3 by 3 matrix by its columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block<R: Real> {
    pub(super) x: R::Vec3,
    pub(super) y: R::Vec3,
    pub(super) z: R::Vec3,
}

impl<R: Real> Block<R> {
    pub(super) const ZERO: Self = Self {
        x: R::Vec3::ZERO,
        y: R::Vec3::ZERO,
        z: R::Vec3::ZERO,
    };

    /// `value` times the unit matrix.
    #[inline]
    pub(super) fn diagonal(value: R) -> Self {
        let o = R::ZERO;
        Self {
            x: R::Vec3::new(value, o, o),
            y: R::Vec3::new(o, value, o),
            z: R::Vec3::new(o, o, value),
        }
    }

    /// The matrix of the vector product: `hat(a) b = a × b`.
    #[inline]
    pub(super) fn hat(a: R::Vec3) -> Self {
        let o = R::ZERO;
        Self {
            x: R::Vec3::new(o, a.z(), -a.y()),
            y: R::Vec3::new(-a.z(), o, a.x()),
            z: R::Vec3::new(a.y(), -a.x(), o),
        }
    }

    /// `a bᵀ`.
    #[inline]
    pub(super) fn outer(a: R::Vec3, b: R::Vec3) -> Self {
        Self {
            x: a * b.x(),
            y: a * b.y(),
            z: a * b.z(),
        }
    }

    #[inline]
    pub(super) fn times(&self, v: R::Vec3) -> R::Vec3 {
        self.x * v.x() + self.y * v.y() + self.z * v.z()
    }

    #[inline]
    pub(super) fn times_block(&self, other: &Self) -> Self {
        Self {
            x: self.times(other.x),
            y: self.times(other.y),
            z: self.times(other.z),
        }
    }

    /// `self (ϑ × place)` as a matrix for ϑ: `-self hat(place)`.
    #[inline]
    pub(super) fn after_turn_of(&self, place: R::Vec3) -> Self {
        Self {
            x: self.z * place.y() - self.y * place.z(),
            y: self.x * place.z() - self.z * place.x(),
            z: self.y * place.x() - self.x * place.y(),
        }
    }

    /// `hat(a) self`: each column crossed by `a`.
    #[inline]
    pub(super) fn crossed_by(&self, a: R::Vec3) -> Self {
        Self {
            x: a.cross(self.x),
            y: a.cross(self.y),
            z: a.cross(self.z),
        }
    }

    #[inline]
    pub(super) fn plus(&self, other: &Self) -> Self {
        Self {
            x: self.x + other.x,
            y: self.y + other.y,
            z: self.z + other.z,
        }
    }

    /// With the diagonal raised by a share of its own sum.
    #[cold]
    fn with_diagonal_raised(&self, share: R) -> Self {
        let sum = self.x.x().abs() + self.y.y().abs() + self.z.z().abs();
        self.plus(&Self::diagonal(sum * share))
    }

    #[inline]
    pub(super) fn scaled(&self, factor: R) -> Self {
        Self {
            x: self.x * factor,
            y: self.y * factor,
            z: self.z * factor,
        }
    }
}

/// Six linear equations of a rigid body: a force and a torque that answer to a displacement and a turn.
#[derive(Clone, Copy, Debug)]
pub(super) struct SixBySix<R: Real> {
    pub(super) force_by_shift: Block<R>,
    pub(super) force_by_turn: Block<R>,
    pub(super) torque_by_shift: Block<R>,
    pub(super) torque_by_turn: Block<R>,
}

impl<R: Real> SixBySix<R> {
    pub(super) const ZERO: Self = Self {
        force_by_shift: Block::ZERO,
        force_by_turn: Block::ZERO,
        torque_by_shift: Block::ZERO,
        torque_by_turn: Block::ZERO,
    };

    /// Adds what a force at `arm` answers to the path of a place at `place`, which a turn moves by `ϑ × place`: `block (ξ + ϑ × place)`.
    #[inline(always)]
    pub(super) fn add_at(&mut self, block: &Block<R>, arm: R::Vec3, place: R::Vec3) {
        let by_turn = block.after_turn_of(place);
        self.force_by_shift = self.force_by_shift.plus(block);
        self.force_by_turn = self.force_by_turn.plus(&by_turn);
        self.torque_by_shift = self.torque_by_shift.plus(&block.crossed_by(arm));
        self.torque_by_turn = self.torque_by_turn.plus(&by_turn.crossed_by(arm));
    }

    /// The shift and turn that a force and a torque make. Where stiffness has swallowed the inertia beyond rounding, so that the matrix is singular, that
    /// of a body heavier by the root of the rounding: smaller steps, in a direction that can be had.
    pub(super) fn solve(&self, force: R::Vec3, torque: R::Vec3, reach: R) -> (R::Vec3, R::Vec3) {
        let (shift, turn) = self.solve_regular(force, torque, reach);
        if shift.is_finite() && turn.is_finite() {
            return (shift, turn);
        }
        let share = R::EPSILON.sqrt();
        let heavier = Self {
            force_by_shift: self.force_by_shift.with_diagonal_raised(share),
            torque_by_turn: self.torque_by_turn.with_diagonal_raised(share),
            ..*self
        };
        heavier.solve_regular(force, torque, reach)
    }

    /// By Gauss's elimination with row pivots. Turns and torques are measured with the length `reach`, so that pivots compare like with like whatever the
    /// body's size. Not finite where the matrix is singular.
    #[inline]
    fn solve_regular(&self, force: R::Vec3, torque: R::Vec3, reach: R) -> (R::Vec3, R::Vec3) {
        let per_reach = R::ONE / reach;
        let mut rows = [[R::ZERO; 7]; 6];
        let top = [&self.force_by_shift, &self.force_by_turn];
        let bottom = [&self.torque_by_shift, &self.torque_by_turn];
        fill(&mut rows[0..3], top, force, R::ONE, per_reach);
        fill(&mut rows[3..6], bottom, torque, per_reach, per_reach);
        let solution = eliminate(rows);
        (
            R::Vec3::new(solution[0], solution[1], solution[2]),
            R::Vec3::new(solution[3], solution[4], solution[5]) * per_reach,
        )
    }
}

/// Three rows from two blocks and a right-hand side.
#[inline]
fn fill<R: Real>(
    rows: &mut [[R; 7]],
    [shift, turn]: [&Block<R>; 2],
    right: R::Vec3,
    row_scale: R,
    turn_scale: R,
) {
    let pick: [fn(R::Vec3) -> R; 3] = [R::Vec3::x, R::Vec3::y, R::Vec3::z];
    for (row, of) in rows.iter_mut().zip(pick) {
        let per_turn = row_scale * turn_scale;
        *row = [
            of(shift.x) * row_scale,
            of(shift.y) * row_scale,
            of(shift.z) * row_scale,
            of(turn.x) * per_turn,
            of(turn.y) * per_turn,
            of(turn.z) * per_turn,
            of(right) * row_scale,
        ];
    }
}

/// Gauss's elimination with row pivots, one function a column so that every index is known at compile time.
#[inline]
fn eliminate<R: Real>(mut rows: [[R; 7]; 6]) -> [R; 6] {
    eliminate_column::<R, 0>(&mut rows);
    eliminate_column::<R, 1>(&mut rows);
    eliminate_column::<R, 2>(&mut rows);
    eliminate_column::<R, 3>(&mut rows);
    eliminate_column::<R, 4>(&mut rows);
    let mut solution = [R::ZERO; 6];
    for i in (0..6).rev() {
        let mut sum = rows[i][6];
        for j in i + 1..6 {
            sum -= rows[i][j] * solution[j];
        }
        solution[i] = sum / rows[i][i];
    }
    solution
}

/// The largest entry of the column moves up by exchanges; the rows below lose theirs.
#[inline(always)]
fn eliminate_column<R: Real, const P: usize>(rows: &mut [[R; 7]; 6]) {
    for below in P + 1..6 {
        if rows[below][P].abs() > rows[P][P].abs() {
            rows.swap(P, below);
        }
    }
    let upper = rows[P];
    let inverse = R::ONE / upper[P];
    for row in rows.iter_mut().skip(P + 1) {
        let factor = row[P] * inverse;
        for column in P + 1..7 {
            row[column] -= factor * upper[column];
        }
    }
}
