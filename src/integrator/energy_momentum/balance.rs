//! Momentum balance of a trial step: its residual, and the scale on which that is rounding.

use super::contacts::Contacts;
use super::problem::{Problem, TrialStep};
use super::strain::Strain;
use super::touch::Push;
use crate::real::{Real, Vector, is_single};
use crate::scene::Dynamics;

/// Bound on the ratio of the size of a momentum at a contact to that at the centre of mass, in the
/// norm of the kinetic energy. For a rod of ten points at its end the ratio is two. Larger ratios
/// are not considered.
const MOST_LEVERAGE: f64 = 8.0;

/// Sum of the effects of the contacts over a trial step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sum<R: Real> {
    pub(super) force: R::Vec3,
    pub(super) torque: R::Vec3,
    /// Sum of the magnitudes of the normal forces, N.
    pub(super) normal: R,
    /// Sum of the stiffnesses of the springs over the step, N/m.
    pub(super) stiffness: R,
    /// Sum of the slopes of the normal forces, dampers included, N/m.
    pub(super) slope: R,
}

impl<R: Real> Sum<R> {
    pub(super) const NONE: Self = Self {
        force: R::Vec3::ZERO,
        torque: R::Vec3::ZERO,
        normal: R::ZERO,
        stiffness: R::ZERO,
        slope: R::ZERO,
    };

    #[inline(always)]
    pub(super) fn add(&mut self, push: &Push<R>) {
        self.force += push.force;
        self.torque += push.arm.cross(push.force);
        self.normal += push.mean.force;
        self.stiffness += push.mean.stiffness;
        self.slope += push.mean.slope;
    }
}

/// Unknowns of a trial, with the residual there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Iterate<R: Real> {
    pub(super) velocity: R::Vec3,
    pub(super) cayley: R::Vec3,
    /// Size of the residual, √J.
    pub(super) residual: R,
}

/// Momentum balance of a trial.
pub(super) struct Balance<R: Real> {
    /// Unknowns and size of the residual.
    pub(super) iterate: Iterate<R>,
    /// Residual of the linear momentum, N s.
    pub(super) force_residual: R::Vec3,
    /// Residual of the angular momentum, N m s.
    pub(super) torque_residual: R::Vec3,
    /// Sum of the magnitudes of the normal forces, N.
    pub(super) load: R,
    /// Sum of the stiffnesses of the springs over the step, N/m.
    pub(super) stiffness: R,
    /// Unit of the thresholds for the residual, √J.
    pub(super) tolerance: R,
    /// Part of the residual that rounding of the lever of a moving contact explains, √J.
    pub(super) rounding: R,
}

impl<R: Real> Balance<R> {
    /// Balance of a trial with the effects of its contacts.
    #[inline(always)]
    pub(super) fn of<D: Dynamics<R>>(
        problem: &Problem<'_, R, D>,
        (contacts, trial): (&Contacts<R>, &TrialStep<R>),
        sum: &Sum<R>,
        scale: &Scale<R>,
    ) -> Self {
        let (force_residual, torque_residual) = residual(problem, trial, sum);
        let angular = beyond_lever(problem, contacts, sum.normal, torque_residual);
        Self {
            iterate: Iterate {
                velocity: trial.velocity,
                cayley: trial.cayley,
                residual: norm(problem, force_residual, angular),
            },
            force_residual,
            torque_residual,
            load: sum.normal,
            stiffness: sum.stiffness,
            tolerance: scale.at(problem, trial, sum) * tolerance::<R>(),
            rounding: rounding_of_lever(problem, contacts, sum.normal),
        }
    }
}

/// Tolerance relative to the size of the momentum: 1.8e-12 in f64, 6e-6 in f32.
#[inline]
pub(super) fn tolerance<R: Real>() -> R {
    let root = R::EPSILON.sqrt();
    root * root.sqrt()
}

/// Residual of the momentum balance.
#[inline]
pub(super) fn residual<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    trial: &TrialStep<R>,
    sum: &Sum<R>,
) -> (R::Vec3, R::Vec3) {
    let half = problem.seconds * R::HALF;
    let gained = (trial.end_velocity - problem.start.linear_velocity) * R::HALF;
    let weight = problem.scene.gravity() * half;
    (
        (gained - weight) * problem.mass - sum.force * half,
        (trial.end_angular_momentum - problem.angular_momentum) * R::HALF - sum.torque * half,
    )
}

/// Size of a momentum in the norm of the kinetic energy, √J.
#[inline]
pub(super) fn norm<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    linear: R::Vec3,
    angular: R::Vec3,
) -> R {
    let properties = problem.scene.inertia_properties();
    let turning = properties.rotational_energy(&problem.motion.axes, angular) * R::TWO;
    (linear.length_squared() * properties.inverse_mass() + turning).sqrt()
}

/// Residual of the momentum balance after the forces have increased by this force (N) and torque
/// (N m).
#[inline]
pub(super) fn without_excess<R: Real, D>(
    problem: &Problem<'_, R, D>,
    [force, torque]: [R::Vec3; 2],
    [more_force, more_torque]: [R::Vec3; 2],
) -> [R::Vec3; 2] {
    let half = problem.seconds * R::HALF;
    [force - more_force * half, torque - more_torque * half]
}

/// Effect of rounding of the lever of a moving contact on the balance, √J; 0 for other contacts.
#[inline]
fn rounding_of_lever<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &Contacts<R>,
    normal_force: R,
) -> R {
    match contacts.lever(problem) {
        Some(lever) if !is_single::<R>() => {
            let impulse = problem.seconds * R::HALF * normal_force;
            norm(problem, R::Vec3::ZERO, lever.rounding * impulse)
        }
        _ => R::ZERO,
    }
}

/// Residual of the torque beyond the effect of rounding of the lever of a moving contact, in single
/// precision. In double precision, and for other contacts, the whole residual.
///
/// The rounding of the surface is along the torque of the lever, so its work is that of the springs
/// to rounding. A residual of the same size in another direction would do much more work: in f32,
/// at a rotation of 1e-3 rad, a thousandth of the energy.
#[inline]
fn beyond_lever<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &Contacts<R>,
    normal_force: R,
    torque_residual: R::Vec3,
) -> R::Vec3 {
    let Some(lever) = contacts.lever(problem) else {
        return torque_residual;
    };
    let along = lever.rounding;
    let square = along.length_squared();
    if !(is_single::<R>() && square > R::ZERO) {
        return torque_residual;
    }
    let most = problem.seconds * R::HALF * normal_force;
    let part = torque_residual.dot(along) / square;
    torque_residual - along * part.at_most(most).at_least(-most)
}

/// Size of a shift and a rotation over the step in the norm of the kinetic energy, √J.
#[cold]
#[inline(never)]
pub(super) fn size_of_motion<R: Real, D>(
    problem: &Problem<'_, R, D>,
    shift: R::Vec3,
    turn: R::Vec3,
) -> R {
    let turning = turn.dot(problem.inertia.times(turn));
    (shift.length_squared() * problem.mass + turning).sqrt() * problem.per_second
}

/// Size of the momenta that balance, √J. It includes the body's own momentum and that of gravity
/// and of the contacts. It also includes two rounding terms: rounding of positions times stiffness,
/// and rounding of paths times damping.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale<R> {
    pub(super) own: R,
    weight: R,
    root_of_mass: R,
}

impl<R: Real> Scale<R> {
    #[inline]
    pub(super) fn of<D: Dynamics<R>>(problem: &Problem<'_, R, D>) -> Self {
        Self {
            own: (problem.kinetic_energy * R::TWO).sqrt(),
            weight: problem.mass * problem.scene.gravity().length(),
            root_of_mass: problem.mass.sqrt(),
        }
    }

    /// Returns true if one more step reduces the residual of the angular momentum to rounding as
    /// well, for a larger linear momentum. The square of the total residual must be small compared
    /// with the angular momentum alone.
    pub(super) fn turns_closely<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        torque_residual: R::Vec3,
        size: R,
    ) -> bool {
        let angular = norm(problem, R::Vec3::ZERO, problem.angular_momentum);
        let residual = norm(problem, R::Vec3::ZERO, torque_residual);
        angular == R::ZERO || residual * size <= angular * self.own * R::EPSILON * R::from_f64(4.0)
    }

    /// Upper bound for the effect of rounding of the slips on friction, √J.
    #[cold]
    #[inline(never)]
    pub(super) fn rounding_of_slips<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
        strain: &Strain<R>,
    ) -> R {
        let impulse = strain.friction_over(problem.rounding_of_path(trial)) * R::HALF;
        impulse * R::from_f64(MOST_LEVERAGE) / self.root_of_mass
    }

    #[inline]
    pub(super) fn at<D>(
        &self,
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
        sum: &Sum<R>,
    ) -> R {
        let half = problem.seconds * R::HALF;
        let path =
            trial.shift.length() + trial.cayley.length() * (R::TWO * problem.bounding_radius);
        let rounding = (sum.stiffness * problem.depth_scale + sum.slope * path)
            * (R::EPSILON / tolerance::<R>());
        self.own + half * (self.weight + sum.normal + rounding) / self.root_of_mass
    }
}
