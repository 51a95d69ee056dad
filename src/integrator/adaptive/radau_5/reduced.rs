//! The linear equations `(λ - J) x = r` of an iteration, reduced to those of the velocities.
//!
//! Forces make the rates of the velocities stiff. The other rates follow from the kinematics: with
//! the blocks of the [`Jacobian`], W for the angular velocity by L, and u for v and L together,
//!
//! ```text
//! ξ = (r_ξ + v)/λ        ϑ = E (r_ϑ + W L)        E = (λ - A)⁻¹
//! (λ - F_u) u - F_ξ v/λ - F_ϑ E W L = r_u + F_ξ r_ξ/λ + F_ϑ E r_ϑ
//! ```
//! So six equations are left of 13. A is the derivative of `ϑ'` with respect to ϑ. It only rotates
//! ϑ, at about the rate of the body.

use super::jacobian::Jacobian;
use super::linear::{
    Factors, Rows, Scalar, image, inverse_near_one, plus, product, real_row_times, row_times,
    shifted,
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
        // The rate itself has no cube if the step is short.
        let turning =
            inverse_near_one(per_rate, by_turn).map(|row| row.map(|entry| entry * per_rate));
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
        let by_shift = image(&jacobian.by_shift, &shift);
        let known = plus(&by_shift, &product(&self.by_turn, &right.turn));
        let rates = self.rates.solve(&plus(&right.rates, &known));
        let [vx, vy, vz, lx, ly, lz] = rates;
        let spin = image(by_momentum, &[lx, ly, lz]);
        Local {
            shift: plus(&shift, &[vx, vy, vz].map(|part| part * per_rate)),
            turn: product(&self.turning, &plus(&right.turn, &spin)),
            rates,
            length: right.length * per_rate,
        }
    }
}
