//! The linear equations `(λ - J) x = r` of an iteration, reduced to those of the velocities.
//!
//! Forces make the rates of the velocities stiff. The other rates follow from the kinematics. With
//! the blocks of the [`Jacobian`], the length s of the quaternion, W for the angular velocity by L,
//! and u for v and L together,
//!
//! ```text
//! ξ = (r_ξ + v)/λ        ϑ = E (r_ϑ + ω r_s/λ + W L)        s = (r_s - ω·ϑ/4)/λ
//! (λ - F_u) u - F_ξ v/λ - F_ϑ E W L = r_u + F_ξ r_ξ/λ + F_ϑ E (r_ϑ + ω r_s/λ)
//! E = (λ - A + ω ωᵀ/4λ)⁻¹
//! ```
//! So six equations are left of 13. A is the derivative of `ϑ'` with respect to ϑ.

use super::jacobian::Jacobian;
use super::linear::{
    Factors, Rows, Scalar, image, inverse, plus, product, real_row_times, row_times, shifted,
};
use crate::real::Real;

/// Coordinates of a difference of points.
#[derive(Clone, Copy)]
pub(super) struct Local<T> {
    /// Shift, m.
    pub(super) shift: [T; 3],
    /// Rotation, rad, world axes.
    pub(super) turn: [T; 3],
    /// Velocity and angular momentum.
    pub(super) rates: [T; 6],
    /// Length of the quaternion.
    pub(super) length: T,
}

impl<T: Copy> Local<T> {
    /// Applies a function to each coordinate.
    #[inline(always)]
    pub(super) fn map<U>(&self, each: impl Fn(T) -> U) -> Local<U> {
        Local {
            shift: self.shift.map(&each),
            turn: self.turn.map(&each),
            rates: self.rates.map(&each),
            length: each(self.length),
        }
    }

    /// Applies a function to each coordinate of two differences.
    #[inline(always)]
    pub(super) fn zip<U>(&self, other: &Self, each: impl Fn(T, T) -> U) -> Local<U> {
        Local {
            shift: core::array::from_fn(|i| each(self.shift[i], other.shift[i])),
            turn: core::array::from_fn(|i| each(self.turn[i], other.turn[i])),
            rates: core::array::from_fn(|i| each(self.rates[i], other.rates[i])),
            length: each(self.length, other.length),
        }
    }
}

/// The equations for one λ.
pub(super) struct Reduced<T> {
    /// `1/λ`.
    per_rate: T,
    /// `ω/λ`.
    angle: [T; 3],
    /// E.
    turning: Rows<T, 3, 3>,
    /// `F_ϑ E`.
    by_turn: Rows<T, 6, 3>,
    rates: Factors<T, 6>,
}

impl<T> Reduced<T> {
    pub(super) fn of<R: Real>(rate: T, jacobian: &Jacobian<R>) -> Self
    where
        T: Scalar<R>,
    {
        let [by_turn, by_momentum] = &jacobian.turning;
        let per_rate = T::real(R::ONE) / rate;
        let angle = jacobian.spin.map(|part| per_rate.scaled(part));
        let turning = turning(per_rate, by_turn, &angle);
        let by_turn = jacobian.by_turn.map(|row| real_row_times(&row, &turning));
        let mut rows = shifted(rate, &jacobian.by_rates);
        for (row, (by_shift, by_turn)) in
            (rows.iter_mut()).zip(jacobian.by_shift.iter().zip(&by_turn))
        {
            let by_path = by_shift.map(|entry| per_rate.scaled(entry));
            let by_rotation = row_times(by_turn, by_momentum);
            for (entry, part) in row.iter_mut().zip(by_path.into_iter().chain(by_rotation)) {
                *entry = *entry - part;
            }
        }
        Self {
            per_rate,
            angle,
            turning,
            by_turn,
            rates: Factors::of(rows),
        }
    }

    /// Solves the equations for a right-hand side.
    pub(super) fn solve<R: Real>(&self, jacobian: &Jacobian<R>, right: &Local<T>) -> Local<T>
    where
        T: Scalar<R>,
    {
        let per_rate = self.per_rate;
        let [_, by_momentum] = &jacobian.turning;
        let shift = right.shift.map(|part| part * per_rate);
        let turn = plus(&right.turn, &self.angle.map(|part| part * right.length));
        let by_shift = image(&jacobian.by_shift, &shift);
        let known = plus(&by_shift, &product(&self.by_turn, &turn));
        let rates = self.rates.solve(&plus(&right.rates, &known));
        let [vx, vy, vz, lx, ly, lz] = rates;
        let spin = image(by_momentum, &[lx, ly, lz]);
        let turn = product(&self.turning, &plus(&turn, &spin));
        let [lengthening] = product(&[self.angle], &turn);
        Local {
            shift: plus(&shift, &[vx, vy, vz].map(|part| part * per_rate)),
            turn,
            rates,
            length: right.length * per_rate - lengthening.scaled(R::from_f64(0.25)),
        }
    }
}

/// Returns E. It is computed as a matrix near 1, times `1/λ`, because the cube of λ could overflow.
fn turning<R: Real, T: Scalar<R>>(
    per_rate: T,
    by_turn: &Rows<R, 3, 3>,
    angle: &[T; 3],
) -> Rows<T, 3, 3> {
    let near_one = core::array::from_fn(|i| {
        core::array::from_fn(|j| {
            let unit = T::real(if i == j { R::ONE } else { R::ZERO });
            let lengthened = (angle[i] * angle[j]).scaled(R::from_f64(0.25));
            unit - per_rate.scaled(by_turn[i][j]) + lengthened
        })
    });
    inverse(&near_one).map(|row| row.map(|entry| entry * per_rate))
}
