//! How the momentum balance of a step answers to a shift `ξ` and a turn `ϑ` of its end: the matrix of Newton's method.
//!
//! A contact's path changes by `ξ + ϑ × r'` (r': its arm at the end), its mean arm by `ϑ × r'/2`, and the Cayley argument by `(ϑ - a × ϑ + a (a·ϑ))/2`.

use super::contacts::{Contacts, Push};
use super::linear::{Block, SixBySix};
use super::problem::{Problem, Trial};
use crate::real::{Real, Vector};
use crate::scene::Dynamics;

/// The matrix at the trial that the contacts have responded to last.
pub(super) fn equations<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &Contacts<R>,
    trial: &Trial<R>,
) -> SixBySix<R> {
    let mut equations = inertial(problem, trial);
    if problem.is_level {
        let mut sum = Level::NONE;
        contacts.recall(problem, trial, |push| sum.add(problem, push));
        sum.add_to(&mut equations);
    } else {
        contacts.recall(problem, trial, |push| add(&mut equations, problem, push));
    }
    if problem.has_radii {
        // The Cayley argument's change by a turn carries the place under a contact's centre.
        let argument = by_turn(trial.spin);
        contacts.recall(problem, trial, |push| {
            add_carried(&mut equations, problem, push, &argument);
        });
    }
    equations
}

/// `1 - â + a aᵀ`: twice the change of the Cayley argument by a turn of the step's end.
#[inline]
fn by_turn<R: Real>(a: R::Vec3) -> Block<R> {
    Block::diagonal(R::ONE)
        .plus(&Block::hat(-a))
        .plus(&Block::outer(a, a))
}

/// Derivatives of the momenta at the end.
#[inline]
fn inertial<R: Real, D: Dynamics<R>>(problem: &Problem<'_, R, D>, trial: &Trial<R>) -> SixBySix<R> {
    let mean = Block::diagonal(R::ONE)
        .plus(&trial.swing)
        .times_block(&problem.inertia.times_block(&by_turn(trial.spin)))
        .scaled(problem.per_second);
    SixBySix {
        force_by_shift: Block::diagonal(problem.mass * problem.per_second),
        force_by_turn: Block::ZERO,
        torque_by_shift: Block::ZERO,
        torque_by_turn: mean.plus(&Block::hat(trial.end_angular_momentum * -R::HALF)),
    }
}

/// One contact anywhere.
#[inline(always)]
fn add<R: Real, D: Dynamics<R>>(
    equations: &mut SixBySix<R>,
    problem: &Problem<'_, R, D>,
    push: &Push<R>,
) {
    let half = problem.seconds * R::HALF;
    equations.add_at(&of_path(problem, push, half), push.arm, push.end_arm);
    // The mean arm turns too: (ϑ × r')/2 × F.
    let quarter = push.force() * (-half * R::HALF);
    let arm_turns =
        Block::outer(push.end_arm, quarter).plus(&Block::diagonal(-quarter.dot(push.end_arm)));
    equations.torque_by_turn = equations.torque_by_turn.plus(&arm_turns);
}

/// What a turn adds to the path of a contact's place, a radius below its centre.
#[inline(always)]
fn add_carried<R: Real, D: Dynamics<R>>(
    equations: &mut SixBySix<R>,
    problem: &Problem<'_, R, D>,
    push: &Push<R>,
    argument: &Block<R>,
) {
    let carried = argument.crossed_by(push.normal).scaled(push.radius);
    let by_turn = of_path(problem, push, problem.seconds * R::HALF).times_block(&carried);
    equations.force_by_turn = equations.force_by_turn.plus(&by_turn);
    equations.torque_by_turn = equations.torque_by_turn.plus(&by_turn.crossed_by(push.arm));
}

/// `-dF/dx` of one contact for its path x over the step, times `factor`: `k (n - uₙ) nᵀ + c/dt (1 - n nᵀ - w' g ûᵀ)`.
#[inline(always)]
fn of_path<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    push: &Push<R>,
    factor: R,
) -> Block<R> {
    let n = push.normal;
    let c = push.drag.coefficient * problem.per_second * factor;
    let loaded = n - push.slip * push.drag.per_load;
    let across = loaded * (push.mean.slope * factor) - n * c;
    let along = push.dual * (-c * push.drag.growth);
    Block::diagonal(c)
        .plus(&Block::outer(across, n))
        .plus(&Block::outer(along, push.slip_direction))
}

/// The contacts' part of the matrix on level ground, where the third row of `-dF/dx` is `(0, 0, k)`: the same as [`add`] without what is 0 there.
#[derive(Clone, Copy, Debug)]
struct Level<R: Real> {
    /// The matrix of the path, `[[xx, xy, xz], [yx, yy, yz], [0, 0, zz]]`.
    xx: R,
    xy: R,
    yx: R,
    yy: R,
    xz: R,
    yz: R,
    zz: R,
    /// Its columns for a turn; the third's third entry is 0.
    by_turn: [R::Vec3; 3],
    /// Torques of both.
    torque_by_shift: [R::Vec3; 3],
    torque_by_turn: [R::Vec3; 3],
}

impl<R: Real> Level<R> {
    const NONE: Self = Self {
        xx: R::ZERO,
        xy: R::ZERO,
        yx: R::ZERO,
        yy: R::ZERO,
        xz: R::ZERO,
        yz: R::ZERO,
        zz: R::ZERO,
        by_turn: [R::Vec3::ZERO; 3],
        torque_by_shift: [R::Vec3::ZERO; 3],
        torque_by_turn: [R::Vec3::ZERO; 3],
    };

    #[inline(always)]
    fn add<D: Dynamics<R>>(&mut self, problem: &Problem<'_, R, D>, push: &Push<R>) {
        let half = problem.seconds * R::HALF;
        let zz = push.mean.slope * half;
        let c = push.drag.coefficient * problem.per_second * half;
        let (u, g) = (push.slip_direction, push.dual * (c * push.drag.growth));
        let loaded = push.slip * (push.drag.per_load * -zz);
        let (xx, xy) = (c - g.x() * u.x(), -(g.x() * u.y()));
        let (yx, yy) = (-(g.y() * u.x()), c - g.y() * u.y());
        let (xz, yz) = (loaded.x(), loaded.y());
        self.xx += xx;
        self.xy += xy;
        self.yx += yx;
        self.yy += yy;
        self.xz += xz;
        self.yz += yz;
        self.zz += zz;

        let (r, b, o) = (push.end_arm, push.arm, R::ZERO);
        let (rx, ry, rz) = (r.x(), r.y(), r.z());
        let turn_x = R::Vec3::new(xz * ry - xy * rz, yz * ry - yy * rz, zz * ry);
        let turn_y = R::Vec3::new(xx * rz - xz * rx, yx * rz - yz * rx, -(zz * rx));
        let turn_z = R::Vec3::new(xy * rx - xx * ry, yy * rx - yx * ry, o);
        self.by_turn[0] += turn_x;
        self.by_turn[1] += turn_y;
        self.by_turn[2] += turn_z;

        self.torque_by_shift[0] += level_torque(b, xx, yx);
        self.torque_by_shift[1] += level_torque(b, xy, yy);
        self.torque_by_shift[2] += b.cross(R::Vec3::new(xz, yz, zz));

        // The mean arm turns too: (ϑ × r')/2 × F.
        let quarter = push.force() * (-half * R::HALF);
        let along = quarter.dot(r);
        self.torque_by_turn[0] += b.cross(turn_x) + r * quarter.x() - R::Vec3::new(along, o, o);
        self.torque_by_turn[1] += b.cross(turn_y) + r * quarter.y() - R::Vec3::new(o, along, o);
        self.torque_by_turn[2] +=
            level_torque(b, turn_z.x(), turn_z.y()) + r * quarter.z() - R::Vec3::new(o, o, along);
    }

    #[inline]
    fn add_to(&self, equations: &mut SixBySix<R>) {
        let o = R::ZERO;
        let shift = Block {
            x: R::Vec3::new(self.xx, self.yx, o),
            y: R::Vec3::new(self.xy, self.yy, o),
            z: R::Vec3::new(self.xz, self.yz, self.zz),
        };
        let block = |[x, y, z]: [R::Vec3; 3]| Block { x, y, z };
        equations.force_by_shift = equations.force_by_shift.plus(&shift);
        equations.force_by_turn = equations.force_by_turn.plus(&block(self.by_turn));
        equations.torque_by_shift = equations.torque_by_shift.plus(&block(self.torque_by_shift));
        equations.torque_by_turn = equations.torque_by_turn.plus(&block(self.torque_by_turn));
    }
}

/// `b × (x, y, 0)`.
#[inline(always)]
fn level_torque<R: Real>(b: R::Vec3, x: R, y: R) -> R::Vec3 {
    R::Vec3::new(-(b.z() * y), b.z() * x, b.x() * y - b.y() * x)
}
