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

    /// The shift and turn that a force and a torque make.
    pub(super) fn solve(&self, force: R::Vec3, torque: R::Vec3, reach: R) -> (R::Vec3, R::Vec3) {
        let mut factors = Factors::NONE;
        self.factor(reach, &mut factors);
        self.solve_with(&factors, force, torque, reach)
    }

    /// As [`solve`](Self::solve), with the factors that [`factor`](Self::factor) has found. Where stiffness has swallowed the inertia beyond rounding, so that the matrix is
    /// singular, that of a body heavier by the root of the rounding: smaller steps, in a direction that can be had.
    #[inline]
    pub(super) fn solve_with(
        &self,
        factors: &Factors<R>,
        force: R::Vec3,
        torque: R::Vec3,
        reach: R,
    ) -> (R::Vec3, R::Vec3) {
        let (shift, turn) = factors.solve(force, torque);
        if shift.is_finite() && turn.is_finite() {
            return (shift, turn);
        }
        self.solve_heavier(force, torque, reach)
    }

    #[cold]
    fn solve_heavier(&self, force: R::Vec3, torque: R::Vec3, reach: R) -> (R::Vec3, R::Vec3) {
        let share = R::EPSILON.sqrt();
        let heavier = Self {
            force_by_shift: self.force_by_shift.with_diagonal_raised(share),
            torque_by_turn: self.torque_by_turn.with_diagonal_raised(share),
            ..*self
        };
        let mut factors = Factors::NONE;
        heavier.factor(reach, &mut factors);
        factors.solve(force, torque)
    }

    /// The matrix as a product of triangular ones, by Gauss's elimination. Turns and torques are measured with the length `reach`, so that pivots compare like with like
    /// whatever the body's size. Inertia and springs make the diagonal strong: rows are exchanged only where a pivot is small beside what is below it.
    #[inline]
    pub(super) fn factor(&self, reach: R, factors: &mut Factors<R>) {
        self.fill(reach, factors);
        if !factors.eliminate::<false>() {
            self.factor_with_exchanges(reach, factors);
        }
    }

    #[cold]
    fn factor_with_exchanges(&self, reach: R, factors: &mut Factors<R>) {
        self.fill(reach, factors);
        factors.order = [0, 1, 2, 3, 4, 5];
        factors.exchanged = true;
        factors.eliminate::<true>();
    }

    #[inline]
    fn fill(&self, reach: R, factors: &mut Factors<R>) {
        let per_reach = R::ONE / reach;
        let top = [&self.force_by_shift, &self.force_by_turn];
        let bottom = [&self.torque_by_shift, &self.torque_by_turn];
        let [a, b, c, d, e, f] = &mut factors.rows;
        fill([a, b, c], top, R::ONE, per_reach);
        fill([d, e, f], bottom, per_reach, per_reach);
        factors.per_reach = per_reach;
        factors.exchanged = false;
    }
}

/// The factors of six equations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factors<R: Real> {
    /// Above the diagonal the upper one, below it the lower one, whose diagonal is 1.
    rows: [[R; 6]; 6],
    /// One over the diagonal of the upper one.
    inverse: [R; 6],
    /// The equation that each row comes from, where rows have been exchanged.
    order: [u8; 6],
    exchanged: bool,
    per_reach: R,
}

/// A pivot may be so many times smaller than what is below it.
const LARGEST_FACTOR: f64 = 16.0;

impl<R: Real> Factors<R> {
    pub(super) const NONE: Self = Self {
        rows: [[R::ZERO; 6]; 6],
        inverse: [R::ZERO; 6],
        order: [0, 1, 2, 3, 4, 5],
        exchanged: false,
        per_reach: R::ONE,
    };

    /// One function a column, so that every index is known at compile time. Whether every pivot will do.
    #[inline(always)]
    fn eliminate<const EXCHANGING: bool>(&mut self) -> bool {
        self.eliminate_column::<0, EXCHANGING>()
            && self.eliminate_column::<1, EXCHANGING>()
            && self.eliminate_column::<2, EXCHANGING>()
            && self.eliminate_column::<3, EXCHANGING>()
            && self.eliminate_column::<4, EXCHANGING>()
            && self.eliminate_column::<5, EXCHANGING>()
    }

    /// The rows below lose their entry of the column. With exchanges the largest entry moves up first.
    #[inline(always)]
    fn eliminate_column<const P: usize, const EXCHANGING: bool>(&mut self) -> bool {
        let rows = &mut self.rows;
        if EXCHANGING {
            for below in P + 1..6 {
                if rows[below][P].abs() > rows[P][P].abs() {
                    rows.swap(P, below);
                    self.order.swap(P, below);
                }
            }
        }
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
        EXCHANGING || largest <= R::from_f64(LARGEST_FACTOR)
    }

    /// The shift and turn that a force and a torque make; not finite where the matrix is singular.
    #[inline]
    fn solve(&self, force: R::Vec3, torque: R::Vec3) -> (R::Vec3, R::Vec3) {
        let torque = torque * self.per_reach;
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
            R::Vec3::new(x[3], x[4], x[5]) * self.per_reach,
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

/// Three rows from two blocks.
#[inline]
fn fill<R: Real>(
    rows: [&mut [R; 6]; 3],
    [shift, turn]: [&Block<R>; 2],
    row_scale: R,
    turn_scale: R,
) {
    let pick: [fn(R::Vec3) -> R; 3] = [R::Vec3::x, R::Vec3::y, R::Vec3::z];
    for (row, of) in rows.into_iter().zip(pick) {
        let per_turn = row_scale * turn_scale;
        *row = [
            of(shift.x) * row_scale,
            of(shift.y) * row_scale,
            of(shift.z) * row_scale,
            of(turn.x) * per_turn,
            of(turn.y) * per_turn,
            of(turn.z) * per_turn,
        ];
    }
}
