//! The matrix of Newton's method: the derivative of the momentum balance of a step with respect to
//! a shift `ξ` and a rotation `ϑ` of its end.
//!
//! A contact's path changes by `ξ + ϑ × r'` (r': its arm at the end) and its mean arm by
//! `ϑ × r'/2`. The Cayley argument changes by `(ϑ - a × ϑ + a (a·ϑ))/2`.

use super::answer::{Answer, LinearFriction};
use super::contacts::Contacts;
use super::dual::direction;
use super::level::{Level, LevelPath};
use super::problem::{Problem, TrialStep};
use super::strain::Strain;
use super::touch::{Push, Touch};
use crate::friction::Metric;
use crate::integrator::linear::SixBySix;
use crate::integrator::matrix3::Matrix3;
use crate::real::{Real, Vector, is_single};
use crate::scene::Dynamics;

/// What the contacts that are not stored contribute at a trial.
#[derive(Clone, Copy, Debug)]
pub(super) struct Others<R: Real> {
    /// Strain of the step on their friction and dampers.
    pub(super) strain: Strain<R>,
    /// Torque corrections of those that move over a smooth body, N m.
    pub(super) of_levers: R::Vec3,
    /// Force (N) and torque (N m) by which the linear friction of the matrix exceeds that of the
    /// laws, and by which that of the dual forces does.
    pub(super) excess: [[R::Vec3; 2]; 2],
    /// Their part of the matrix.
    equations: SixBySix<R>,
}

impl<R: Real> Others<R> {
    const NONE: Self = Self {
        strain: Strain::NONE,
        of_levers: R::Vec3::ZERO,
        excess: [[R::Vec3::ZERO; 2]; 2],
        equations: SixBySix::ZERO,
    };

    /// Visits the contacts that are not stored, and calls `visit` with the force of each that
    /// reaches the ground.
    ///
    /// The derivatives are computed with the forces, since both need the motion of the contact.
    #[cold]
    #[inline(never)]
    pub(super) fn of<D: Dynamics<R>>(
        problem: &Problem<'_, R, D>,
        contacts: &Contacts<R>,
        trial: &TrialStep<R>,
        visit: &mut dyn FnMut(&Push<R>),
    ) -> Self {
        let argument = Matrix3::by_turn(trial.cayley);
        let since = contacts.since_last(problem, trial);
        let (mut others, mut level) = (Self::NONE, Level::ZERO);
        contacts.visit_others(problem, trial, &mut |touch, lever, first| {
            visit(&touch.push);
            if problem.moving_contact().is_some() {
                others.of_levers += lever.torque * touch.push.mean.force;
            }
            let jacobian = touch.jacobian(problem);
            let slide = touch.answer_of_slide(problem, &jacobian, contacts.len());
            let answer = slide.unwrap_or_else(|| {
                let since = since.as_ref();
                let answer =
                    contacts.answer_of_other(problem, since, (&mut *touch, jacobian), first);
                others.add_excess(problem, touch, &answer);
                answer
            });
            let push = &touch.push;
            others.strain.add(push, &answer.jacobian);
            if problem.is_bare() {
                let path = of_level_path(problem, touch, &answer);
                level.add(&path, push.force, push.arm, push.end_arm);
            } else {
                others.differentiate(problem, trial, &argument, touch, &answer);
            }
        });
        if problem.is_bare() {
            let share = share_of_arm(problem);
            level.equations(R::ZERO, &Matrix3::ZERO, share, &mut others.equations);
        }
        others
    }

    /// Adds the excess of a contact that does not slide all the time. That of a slide, which has
    /// the law's own derivative, is 0 to rounding.
    #[inline]
    fn add_excess<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        touch: &mut Touch<R>,
        answer: &Answer<R>,
    ) {
        let [of_matrix, of_duals] = &mut self.excess;
        // Of the two, the second matters from the second iteration on only.
        let (sum, excess) = if answer.slip == touch.push.slip {
            let excess = touch.excess_of_dual(problem, answer.dual, &answer.jacobian);
            (of_duals, excess)
        } else {
            touch.remember(answer);
            (of_matrix, touch.excess(problem, LinearFriction::OfMatrix))
        };
        sum[0] += excess;
        sum[1] += touch.push.arm.cross(excess);
    }

    /// Adds the part of a contact in the matrix.
    #[inline(always)]
    fn differentiate<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
        argument: &Matrix3<R>,
        touch: &Touch<R>,
        answer: &Answer<R>,
    ) {
        let push = &touch.push;
        let by_turn = push.path_by_turn(problem, trial, argument);
        let by_turns = (argument, by_turn.as_ref());
        add_anywhere(problem, touch, answer, by_turns, &mut self.equations);
        let share = share_of_arm(problem);
        self.equations
            .add_rotation(push.end_arm, push.force * share);
    }
}

/// The mean arm of a contact rotates too: this factor of `(ϑ × r') × F`.
#[inline(always)]
fn share_of_arm<R: Real, D>(problem: &Problem<'_, R, D>) -> R {
    problem.seconds * -(R::HALF * R::HALF)
}

/// Computes the matrix at the last trial of the contacts. Returns the strain of the step on
/// friction and dampers there.
#[inline(always)]
pub(super) fn equations<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &mut Contacts<R>,
    (others, is_slow): (Option<&Others<R>>, bool),
    trial: &TrialStep<R>,
    equations: &mut SixBySix<R>,
) -> Strain<R> {
    let argument = Matrix3::by_turn(trial.cayley);
    let (mass, inertia) = inertial(problem, trial, &argument);
    let share = share_of_arm(problem);
    let mut strain = others.map_or(Strain::NONE, |others| others.strain);
    if problem.is_bare() {
        let mut level = Level::ZERO;
        contacts.answer(problem, trial, |touch, answer| {
            let push = &touch.push;
            strain.add(push, &answer.jacobian);
            let path = of_level_path(problem, touch, answer);
            level.add(&path, push.force, push.arm, push.end_arm);
        });
        level.equations(mass, &inertia, share, equations);
    } else {
        *equations = SixBySix::of_body(mass, &inertia);
        let by_turn_of_first = contacts.differentiate_path(problem, trial, &argument);
        contacts.answer(problem, trial, |touch, answer| {
            let push = &touch.push;
            strain.add(push, &answer.jacobian);
            let by_turn = if problem.surfaces() > 1 {
                push.path_by_turn(problem, trial, &argument)
            } else {
                by_turn_of_first
            };
            let by_turns = (&argument, by_turn.as_ref());
            add_anywhere(problem, touch, answer, by_turns, equations);
            equations.add_rotation(push.end_arm, push.force * share);
        });
        // Without this term the iteration converges, but not quadratically. In f64 it still reaches
        // rounding, unless a rotation moves the contact point so far that the iteration is slow.
        if let (Some(moving), true) = (problem.moving_contact(), is_single::<R>() || is_slow) {
            let torque = contacts.torque_over_surface(problem, &moving, trial, share);
            equations.add_turning(&torque);
        }
    }
    if let Some(others) = others {
        equations.plus(&others.equations);
    }
    add_reversals(problem, contacts, equations);
    strain
}

/// Adds the contacts whose slip reverses within the step.
#[inline(always)]
fn add_reversals<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &mut Contacts<R>,
    equations: &mut SixBySix<R>,
) {
    contacts.visit_reversals(problem, |reversal| {
        let resistance = reversal.direction * (reversal.coefficient * R::HALF);
        let block = Matrix3::outer(resistance, reversal.direction);
        equations.add_at(&block, reversal.arm, reversal.end_arm);
    });
}

/// Adds a contact of any kind on any ground.
#[inline(never)]
fn add_anywhere<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    touch: &Touch<R>,
    answer: &Answer<R>,
    (argument, path_by_turn): (&Matrix3<R>, Option<&Matrix3<R>>),
    equations: &mut SixBySix<R>,
) {
    let push = &touch.push;
    let path = of_path(problem, touch, answer);
    let mut turn = path.map(|row| push.end_arm.cross(row));
    if push.radius > R::ZERO {
        // The change of the Cayley argument moves the point below the centre of a contact.
        let carried = argument.crossed_by(push.normal * push.radius);
        for (turn, row) in turn.iter_mut().zip(path) {
            *turn += R::Vec3::new(carried.x.dot(row), carried.y.dot(row), carried.z.dot(row));
        }
    }
    if let Some(path_by_turn) = path_by_turn {
        move_over_surface(push, path_by_turn, &path, &mut turn);
    }
    equations.add(path, turn, push.arm);
}

/// Corrects the rows of a moving contact, which at the end is another point of the surface. A
/// rotation changes its path along the ground by `path_by_turn`.
fn move_over_surface<R: Real>(
    push: &Push<R>,
    path_by_turn: &Matrix3<R>,
    path: &[R::Vec3; 3],
    turn: &mut [R::Vec3; 3],
) {
    let n = push.normal;
    let more = path_by_turn.plus(&Matrix3::hat(push.end_arm));
    for (turn, row) in turn.iter_mut().zip(path) {
        let along = *row - n * n.dot(*row);
        *turn += R::Vec3::new(more.x.dot(along), more.y.dot(along), more.z.dot(along));
    }
}

/// Derivatives of the momenta at the end.
#[inline]
fn inertial<R: Real, D>(
    problem: &Problem<'_, R, D>,
    trial: &TrialStep<R>,
    argument: &Matrix3<R>,
) -> (R, Matrix3<R>) {
    let mean = problem.inertia.times_matrix(argument);
    let mean = mean
        .plus(&trial.rotation_change.times_matrix(&mean))
        .scaled(problem.per_second);
    let turned = Matrix3::hat(trial.end_angular_momentum * -R::HALF);
    (problem.mass * problem.per_second, mean.plus(&turned))
}

/// Rows of `-dt/2 dF/dx` of one contact for its path x over the step, that is of
/// `dt/2 (k (n - uₙ) nᵀ + c/dt (1 - n nᵀ - w' g ûᵀ))`.
#[inline(always)]
fn of_path<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    touch: &Touch<R>,
    answer: &Answer<R>,
) -> [R::Vec3; 3] {
    let push = &touch.push;
    if let Some(metric) = touch.metric(problem, answer.slip) {
        return of_path_in_metric(problem, push, answer, &metric);
    }
    let n = push.normal;
    // Rounding leaves a slow slip with a part along the normal. The path along the normal may be so
    // much longer than the slip that this part must not count.
    let u = answer.slip_direction - n * n.dot(answer.slip_direction);
    let c = answer.jacobian.coefficient * R::HALF;
    let loaded = n - answer.slip * answer.jacobian.per_load;
    let across = loaded * (push.mean.slope * (problem.seconds * R::HALF)) - n * c;
    let along = answer.dual * (-c * answer.jacobian.growth);
    let row = |across: R, along: R| n * across + u * along;
    [
        row(across.x(), along.x()) + R::Vec3::new(c, R::ZERO, R::ZERO),
        row(across.y(), along.y()) + R::Vec3::new(R::ZERO, c, R::ZERO),
        row(across.z(), along.z()) + R::Vec3::new(R::ZERO, R::ZERO, c),
    ]
}

/// Rows as of [`of_path`] for friction that is isotropic in a metric M: with `w = M u` those of
/// `dt/2 (k (n - M wₙ) nᵀ + c/dt M (1 - w' g ŵᵀ) M (1 - n nᵀ))`.
#[cold]
#[inline(never)]
fn of_path_in_metric<R: Real, D>(
    problem: &Problem<'_, R, D>,
    push: &Push<R>,
    answer: &Answer<R>,
    metric: &Metric<R>,
) -> [R::Vec3; 3] {
    let (n, jacobian) = (push.normal, &answer.jacobian);
    let w = metric.times(answer.slip);
    let along = direction::<R>(w);
    let column = |path: R::Vec3| {
        let rise = n.dot(path);
        let slip = metric.times(path - n * rise);
        let weakened = slip - answer.dual * (jacobian.growth * along.dot(slip));
        let loaded = n - metric.along_friction(answer.slip) * jacobian.per_load;
        let by_load = loaded * (push.mean.slope * problem.seconds * rise);
        (metric.times(weakened) * jacobian.coefficient + by_load) * R::HALF
    };
    let (o, one) = (R::ZERO, R::ONE);
    let axes = [
        R::Vec3::new(one, o, o),
        R::Vec3::new(o, one, o),
        R::Vec3::new(o, o, one),
    ];
    let [x, y, z] = axes.map(column);
    Matrix3::<R> { x, y, z }.rows()
}

/// Derivative of the force as in [`of_path`], on level ground: n is the third axis, and no slip
/// occurs along it.
#[inline(always)]
fn of_level_path<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    touch: &Touch<R>,
    answer: &Answer<R>,
) -> LevelPath<R> {
    let push = &touch.push;
    if let Some(metric) = touch.metric(problem, answer.slip) {
        let [x, y, z] = of_path_in_metric(problem, push, answer, &metric);
        return LevelPath {
            columns: [[x.x(), y.x()], [x.y(), y.y()], [x.z(), y.z()]],
            rise: z.z(),
        };
    }
    let (slip, dual, u) = (answer.slip, answer.dual, answer.slip_direction);
    let c = answer.jacobian.coefficient * R::HALF;
    let rise = push.mean.slope * (problem.seconds * R::HALF);
    let loaded = -(answer.jacobian.per_load * rise);
    let growth = -(c * answer.jacobian.growth);
    let along = [dual.x() * growth, dual.y() * growth];
    LevelPath {
        columns: [
            [along[0] * u.x() + c, along[1] * u.x()],
            [along[0] * u.y(), along[1] * u.y() + c],
            [slip.x() * loaded, slip.y() * loaded],
        ],
        rise,
    }
}
