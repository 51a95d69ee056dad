//! The response of friction at a contact to its slip, which Newton's matrix contains.

use super::dual::{Dual, Linear, direction, on_disc, weighed};
use super::problem::{Problem, TrialStep};
use super::touch::{Increment, Touch};
use crate::friction::FrictionJacobian;
use crate::integrator::matrix3::Matrix3;
use crate::real::{Real, Vector};
use crate::scene::Dynamics;

/// Fraction of a slip that friction takes in a step, below which the slide will not end in it.
const HARDLY: f64 = 0.1;

/// Response of friction at a contact to its slip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer<R: Real> {
    /// Slip for which friction is differentiated, m/s.
    pub(super) slip: R::Vec3,
    pub(super) jacobian: FrictionJacobian<R>,
    /// Newton's dual unknown: friction divided by its limit, a vector of length at most 1.
    pub(super) dual: R::Vec3,
    /// Unit vector along the slip, or 0.
    pub(super) slip_direction: R::Vec3,
}

impl<R: Real> Answer<R> {
    #[inline(always)]
    fn at(slip: R::Vec3, jacobian: FrictionJacobian<R>, dual: R::Vec3) -> Self {
        Self {
            slip,
            jacobian,
            dual,
            slip_direction: direction::<R>(slip),
        }
    }
}

/// Friction that Newton's method has in place of that of the laws.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum LinearFriction {
    /// That of the matrix, at the last trial.
    OfMatrix,
    /// That of the dual unknowns, which the step to the last trial has led to.
    OfDuals,
}

/// Change of a trial since an earlier one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Since<'a, R: Real> {
    shift: R::Vec3,
    cayley: R::Vec3,
    rotation_change: Matrix3<R>,
    /// Newton's step from the earlier trial, if slips and dual unknowns continue from its end.
    step: Option<&'a Increment<R>>,
}

impl<'a, R: Real> Since<'a, R> {
    pub(super) fn between(
        earlier: &TrialStep<R>,
        step: Option<&'a Increment<R>>,
        trial: &TrialStep<R>,
    ) -> Self {
        let back = earlier.rotation_change.scaled(-R::ONE);
        Self {
            shift: trial.shift - earlier.shift,
            cayley: trial.cayley - earlier.cayley,
            rotation_change: trial.rotation_change.plus(&back),
            step,
        }
    }
}

impl<R: Real> Touch<R> {
    /// Computes the response of friction at the last trial step.
    #[inline(always)]
    pub(super) fn answer<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>) -> Answer<R> {
        let slip = self.push.slip;
        let jacobian = self.jacobian(problem);
        let dual = match &self.dual {
            Dual::After(dual) => *dual,
            Dual::At(last) => on_disc::<R>(self.dual_after(problem, last)),
            // A slide that the step can hardly brake begins with Newton's own derivative.
            Dual::Unknown
                if jacobian.coefficient * problem.seconds < problem.mass * R::from_f64(HARDLY) =>
            {
                self.dual_of_law(problem, slip, &jacobian)
            }
            _ => {
                // Field by field, so that the answer of a slide stays in registers.
                let Answer {
                    slip,
                    jacobian,
                    dual,
                    ..
                } = self.answer_in_stick(problem, &jacobian);
                return Answer::at(slip, jacobian, dual);
            }
        };
        Answer::at(slip, jacobian, dual)
    }

    /// Computes the response of friction at the last trial step by Newton's own derivative, if
    /// friction can hardly brake the slide of a body on this number of such contacts.
    #[inline]
    pub(super) fn answer_of_slide<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        jacobian: &FrictionJacobian<R>,
        contacts: usize,
    ) -> Option<Answer<R>> {
        let of_all = jacobian.coefficient * R::from_usize(contacts);
        (of_all * problem.seconds < problem.mass * R::from_f64(HARDLY)).then(|| {
            Answer::at(
                self.push.slip,
                *jacobian,
                self.dual_of_law(problem, self.push.slip, jacobian),
            )
        })
    }

    /// Response of friction with these derivatives and the dual unknown that continues.
    #[inline]
    pub(super) fn continued_answer<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        jacobian: FrictionJacobian<R>,
    ) -> Answer<R> {
        let slip = self.push.slip;
        let dual = match &self.dual {
            Dual::Unknown => self.dual_of_law(problem, slip, &jacobian),
            Dual::At(last) => on_disc::<R>(self.dual_after(problem, last)),
            Dual::After(dual) => *dual,
        };
        Answer::at(slip, jacobian, dual)
    }

    /// Computes the response of friction of a contact that the step may stop.
    ///
    /// In stick, the slip at the start of the step is the creep at the end of the step before,
    /// while the slip of the first trial is far above it. At the first trial, friction is
    /// differentiated for the slip at the start, and [`excess`](Self::excess) accounts for the
    /// difference.
    #[cold]
    #[inline(never)]
    fn answer_in_stick<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        jacobian: &FrictionJacobian<R>,
    ) -> Answer<R> {
        let (n, slip) = (self.push.normal, self.push.slip);
        let arm = self.arm - n * self.push.radius;
        let velocity = problem.velocity_before_force(arm) - problem.ground_velocity(arm, n);
        let slip_at_start = velocity - n * n.dot(velocity);
        let at_start = self.jacobian_at(problem, slip_at_start);
        let dual_at_start = self.dual_of_law(problem, slip_at_start, &at_start);
        // Along a rim that rolls or spins, friction reverses, and points near its reversal have a
        // small slip for that reason. The reversal has a derivative of its own.
        let is_rim = problem.has_rims();
        let ratio = R::from_f64(if is_rim { 1.0 / 16.0 } else { 0.5 });
        let sticks = at_start.coefficient * problem.seconds > problem.mass * R::TWO
            && slip_at_start.length() < slip.length() * ratio;
        if sticks {
            Answer::at(slip_at_start, at_start, dual_at_start)
        } else if is_rim && slip_at_start.dot(slip) < R::ZERO {
            let dual = self.dual_of_law(problem, slip, jacobian);
            Answer::at(slip, *jacobian, dual)
        } else {
            Answer::at(slip, *jacobian, dual_at_start)
        }
    }

    /// Excess of a linear friction over the friction of the law at the last trial, N.
    pub(super) fn excess<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        linear: LinearFriction,
    ) -> R::Vec3 {
        let slip = self.push.slip;
        let dual = match &self.dual {
            Dual::At(at) if linear == LinearFriction::OfDuals => at.direction,
            Dual::After(dual) if linear == LinearFriction::OfDuals => *dual,
            Dual::At(at) if at.slip != slip => self.dual_after(problem, at),
            _ => return R::Vec3::ZERO,
        };
        self.excess_of_dual(problem, dual, &self.jacobian(problem))
    }

    /// Excess of the force of a dual unknown over the friction of the law at the last trial, N.
    #[inline]
    pub(super) fn excess_of_dual<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        dual: R::Vec3,
        jacobian: &FrictionJacobian<R>,
    ) -> R::Vec3 {
        let slip = self.push.slip;
        let metric = self.metric(problem, slip);
        let excess = weighed(slip, metric.as_ref()) - dual * jacobian.width;
        weighed(excess, metric.as_ref()) * jacobian.coefficient
    }

    /// Derivative of the friction of the last slip with respect to the normal force.
    #[inline]
    pub(super) fn friction_of_unit_load<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        jacobian: &FrictionJacobian<R>,
    ) -> R::Vec3 {
        self.along_friction(problem, self.push.slip) * -jacobian.per_load
    }

    /// Friction of a slip, divided by the negative coefficient: the slip itself, if the law is
    /// isotropic.
    #[inline]
    fn along_friction<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        slip: R::Vec3,
    ) -> R::Vec3 {
        let metric = self.metric(problem, slip);
        metric.map_or(slip, |metric| metric.along_friction(slip))
    }

    /// Dual unknown of the law itself at a slip: its force divided by the limit.
    #[inline]
    fn dual_of_law<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        slip: R::Vec3,
        jacobian: &FrictionJacobian<R>,
    ) -> R::Vec3 {
        let metric = self.metric(problem, slip);
        weighed(slip, metric.as_ref()) * (R::ONE / jacobian.width)
    }

    /// Dual unknown after Newton's step to the last slip.
    #[inline]
    pub(super) fn dual_after<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        last: &Linear<R>,
    ) -> R::Vec3 {
        let metric = self.metric(problem, last.slip);
        last.after(self.push.slip, metric.as_ref())
    }

    /// Derivative of the last linear force with respect to the normal force.
    pub(super) fn loaded<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>) -> R::Vec3 {
        let slip = match &self.dual {
            Dual::At(at) => at.slip,
            _ => self.push.slip,
        };
        self.push.normal
            - self.along_friction(problem, slip) * self.jacobian_at(problem, slip).per_load
    }

    /// Gives a contact that is not stored the dual unknown at a trial before the last one, advanced
    /// by the Newton step from there. It continues from the dual unknown of the stored contact that
    /// it follows, if there is one before that trial.
    ///
    /// The load is that of the last trial. For most laws the dual unknown does not depend on it.
    #[cold]
    #[inline(never)]
    pub(super) fn look_back<D: Dynamics<R>>(
        &mut self,
        problem: &Problem<'_, R, D>,
        since: &Since<'_, R>,
        first: Option<&Self>,
    ) {
        let (slip, end_arm, n) = (self.push.slip, self.push.end_arm, self.push.normal);
        let swung = since.rotation_change.times(self.arm);
        let path = since.shift + swung - since.cayley.cross(n) * (self.push.radius * R::TWO);
        self.push.slip -= (path - n * n.dot(path)) * problem.per_second;
        self.push.end_arm -= swung;
        if let Some(first) = first {
            let jacobian = self.jacobian(problem);
            self.remember(&Answer::at(self.push.slip, jacobian, first.last_dual()));
        } else {
            self.note_answer(problem);
        }
        if let Some(by) = since.step {
            self.advance(problem, by, None);
        }
        (self.push.slip, self.push.end_arm) = (slip, end_arm);
    }

    /// Dual unknown where friction was last differentiated, 0 if nowhere.
    fn last_dual(&self) -> R::Vec3 {
        match &self.dual {
            Dual::Unknown => R::Vec3::ZERO,
            Dual::At(at) => at.direction,
            Dual::After(_) => self.before,
        }
    }

    /// Stores the data from which the next dual unknown is computed.
    #[inline(always)]
    pub(super) fn remember(&mut self, answer: &Answer<R>) {
        self.dual = Dual::At(Linear {
            direction: answer.dual,
            slip: answer.slip,
            width: answer.jacobian.width,
            growth: answer.jacobian.growth,
        });
    }

    /// Computes and stores the dual unknown at the last trial.
    #[cold]
    #[inline(never)]
    pub(super) fn note_answer<D: Dynamics<R>>(&mut self, problem: &Problem<'_, R, D>) {
        if self.push.is_active() {
            let answer = self.answer(problem);
            self.remember(&answer);
        }
    }
}
