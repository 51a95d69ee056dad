//! The contribution of bare contacts on level ground to Newton's matrix, in half the operations of
//! [`SixBySix::add`].
//!
//! On level ground the normal is the third axis and no slip occurs along it. The derivative of a
//! contact's force with respect to a path along x, y and z has the columns `(x₀, y₀, 0)`,
//! `(x₁, y₁, 0)` and `(x₂, y₂, z₂)`. A rotation `ϑ` moves the contact at r' by `ϑ × r'`, which
//! gives the columns
//!
//! ```text
//! x₃ = r'_y x₂ - r'_z x₁    x₄ = r'_z x₀ - r'_x x₂    x₅ = r'_x x₁ - r'_y x₀    (so for y)
//! z₃ = r'_y z₂              z₄ = -r'_x z₂             z₅ = 0
//! ```
//!
//! The torque has the columns `r × (xⱼ, yⱼ, zⱼ)`, where r is the lever arm. Numbers are stored in
//! pairs that a processor computes together. Signs, and the sums of a pair, are applied at the end.

use crate::integrator::linear::SixBySix;
use crate::integrator::matrix3::Matrix3;
use crate::real::{Real, Vector};

type Pair<R> = [R; 2];

/// Sums over contacts.
#[derive(Clone, Copy, Debug)]
// Alignment that lets a pair be loaded at once.
#[repr(align(16))]
pub(super) struct Level<R> {
    /// `(xⱼ, yⱼ)` for the three shifts and the three rotations.
    level: [Pair<R>; 6],
    /// `r_z (xⱼ, yⱼ)`.
    lifted: [Pair<R>; 6],
    /// `(r_y xⱼ, r_x yⱼ)`.
    twisted: [Pair<R>; 6],
    /// `z₂, z₃, z₄`.
    rising: [R; 3],
    /// The elements of `rising` times `(r_y, r_x)`.
    tilted: [Pair<R>; 3],
    /// `(r'_x, r'_y)` times the three components of the force.
    swung: [Pair<R>; 3],
    /// `r'_z` times the three components of the force.
    swung_up: [R; 3],
}

/// Derivative of the force of one contact with respect to its path.
#[derive(Clone, Copy, Debug)]
pub(super) struct LevelPath<R> {
    /// `(xⱼ, yⱼ)` for paths along x, y and z.
    pub(super) columns: [Pair<R>; 3],
    /// `z₂`.
    pub(super) rise: R,
}

#[inline(always)]
fn times<R: Real>(a: Pair<R>, b: R) -> Pair<R> {
    [a[0] * b, a[1] * b]
}

#[inline(always)]
fn minus<R: Real>(a: Pair<R>, b: Pair<R>) -> Pair<R> {
    [a[0] - b[0], a[1] - b[1]]
}

#[inline(always)]
fn add<R: Real>(sum: &mut Pair<R>, term: Pair<R>) {
    sum[0] += term[0];
    sum[1] += term[1];
}

impl<R: Real> Level<R> {
    pub(super) const ZERO: Self = Self {
        level: [[R::ZERO; 2]; 6],
        lifted: [[R::ZERO; 2]; 6],
        twisted: [[R::ZERO; 2]; 6],
        rising: [R::ZERO; 3],
        tilted: [[R::ZERO; 2]; 3],
        swung: [[R::ZERO; 2]; 3],
        swung_up: [R::ZERO; 3],
    };

    /// Adds a contact with the given lever arm. `path` is the derivative of its force with respect
    /// to the path of the point `place`. A rotation `ϑ` moves the arm by `ϑ × place`.
    ///
    /// The loop over the stored contacts and that over the others have a copy each, but not on a
    /// processor without a standard library, where memory is scarce.
    #[cfg_attr(feature = "std", inline(always))]
    #[cfg_attr(not(feature = "std"), inline(never))]
    #[allow(
        clippy::needless_range_loop,
        reason = "iterators keep a copy of the array on a small processor's stack"
    )]
    pub(super) fn add(
        &mut self,
        path: &LevelPath<R>,
        force: R::Vec3,
        arm: R::Vec3,
        place: R::Vec3,
    ) {
        let [x, y, z] = path.columns;
        let columns = [
            x,
            y,
            z,
            minus(times(z, place.y()), times(y, place.z())),
            minus(times(x, place.z()), times(z, place.x())),
            minus(times(y, place.x()), times(x, place.y())),
        ];
        for j in 0..6 {
            let column = columns[j];
            add(&mut self.level[j], column);
            add(&mut self.lifted[j], times(column, arm.z()));
            let twisted = [column[0] * arm.y(), column[1] * arm.x()];
            add(&mut self.twisted[j], twisted);
        }
        let rise = path.rise;
        let rising = [rise, rise * place.y(), -(rise * place.x())];
        for j in 0..3 {
            self.rising[j] += rising[j];
            add(&mut self.tilted[j], times([arm.y(), arm.x()], rising[j]));
        }
        let force = [force.x(), force.y(), force.z()];
        for j in 0..3 {
            add(&mut self.swung[j], times([place.x(), place.y()], force[j]));
            self.swung_up[j] += force[j] * place.z();
        }
    }

    /// Equations of a body of this mass and inertia with these sums, plus `share` times the torques
    /// `(ϑ × place) × force`.
    ///
    /// Not inlined, because the compiler would split the pairs again.
    #[inline(never)]
    pub(super) fn equations(
        &self,
        mass: R,
        inertia: &Matrix3<R>,
        share: R,
        equations: &mut SixBySix<R>,
    ) {
        let (level, lifted, twisted) = (&self.level, &self.lifted, &self.twisted);
        let o = R::ZERO;
        let [rise, by_x, by_y] = self.rising;
        let rows = &mut equations.rows;
        *rows = [
            level.map(|[x, _]| x),
            level.map(|[_, y]| y),
            [o, o, rise, by_x, by_y, o],
            lifted.map(|[_, y]| -y),
            lifted.map(|[x, _]| x),
            twisted.map(|[x, y]| y - x),
        ];
        for j in 0..3 {
            rows[3][j + 2] += self.tilted[j][0];
            rows[4][j + 2] += -self.tilted[j][1];
            rows[j][j] += mass;
        }
        // (ϑ × r') × F = r' (F · ϑ) - ϑ (F · r')
        let along = self.swung[0][0] + self.swung[1][1] + self.swung_up[2];
        let columns = [inertia.x, inertia.y, inertia.z];
        for j in 0..3 {
            rows[3][j + 3] += columns[j].x() + self.swung[j][0] * share;
            rows[4][j + 3] += columns[j].y() + self.swung[j][1] * share;
            rows[5][j + 3] += columns[j].z() + self.swung_up[j] * share;
            rows[j + 3][j + 3] += -(along * share);
        }
    }
}
