//! Resistance to rolling and spinning within a step.
//!
//! The contacts resist the mean angular velocity ω of the step with the torque `T(ω)`, under their
//! mean normal forces. The rotation of the step is that by ω, so the energy changes by `h ω·T`,
//! which is never positive.
//!
//! # Newton's step
//!
//! The torque saturates beyond the turn speed of the law, which may be far below the change of ω in
//! a step. A derivative at the trial is then no guide: the body that is to stop has none, and the
//! body at rest is held as if by a spring. So Newton's step is linear in all other forces only. A
//! is their matrix, `B ϑ` the change of ω by a rotation ϑ of the end, and `δ̂` the change of ω by
//! Newton's step with the torque of the trial. Then the change δ obeys
//!
//! ```text
//! δ = δ̂ + G (T(ω + δ) - T(ω)),     G = h/2 B (A⁻¹)_ϑϑ
//! ```
//!
//! These three equations are solved by Newton's method ([`Rolling::change`]). For one axis it
//! converges from `ω + δ = 0` without a detour, because the torque is concave there. It begins at
//! the trial if the residual is smaller there. If a pass does not reduce the residual, it is
//! replaced by one with the ratio `T/ω`, which leads to the minimum of a parabola above the
//! potential of the law.
//!
//! The torque also depends on the loads. That derivative is part of A ([`add_loads`]), except under
//! [hard](super::hard) contacts. Their loads change in an iteration by far more than themselves,
//! and some become 0, so that a torque linear in them would turn a light body by any angle. There
//! an iteration has the torque of the loads with which it begins.
//!
//! # End of the step
//!
//! As for friction, the mean of a step that does not resolve the resistance is right and its end is
//! not. The [end-velocity correction](super::end_velocity) includes the resistance
//! ([`Rolling::correction`]).

use super::contacts::Contacts;
use super::end_velocity::share_of;
use super::problem::{Problem, TrialStep};
use super::resistances::{Group, Resistances};
use super::touch::Touch;
use crate::integrator::linear::{Factored, SixBySix};
use crate::integrator::matrix3::Matrix3;
use crate::real::{Real, Vector};
use crate::scene::Dynamics;

/// Number of passes that fit the angular velocity to the law. Five are usual.
const PASSES: u32 = 40;

/// Resistance of the contacts at a trial.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rolling<R: Real> {
    resistances: Resistances<R>,
    /// Mean angular velocity relative to the ground, rad/s.
    angular_velocity: R::Vec3,
    /// N m.
    pub(super) torque: R::Vec3,
}

impl<R: Real> Rolling<R> {
    /// Resistance at a trial, under the normal forces of the last one. `None` if the friction law
    /// has no such resistance.
    #[inline(always)]
    pub(super) fn at<D: Dynamics<R>>(
        problem: &Problem<'_, R, D>,
        contacts: &Contacts<R>,
        trial: &TrialStep<R>,
    ) -> Option<Self> {
        problem
            .resists_turning()
            .then(|| Self::of(problem, contacts, trial))
    }

    #[cold]
    #[inline(never)]
    fn of<D: Dynamics<R>>(
        problem: &Problem<'_, R, D>,
        contacts: &Contacts<R>,
        trial: &TrialStep<R>,
    ) -> Self {
        let mut rolling = Self {
            resistances: Resistances::none(problem.turn_resolution()),
            angular_velocity: problem.mean_angular_velocity(trial),
            torque: R::Vec3::ZERO,
        };
        contacts.visit_active(problem, trial, &mut |touch| {
            rolling.add(problem, touch, touch.push.mean.force);
        });
        rolling
    }

    fn add<D: Dynamics<R>>(&mut self, problem: &Problem<'_, R, D>, touch: &Touch<R>, load: R) {
        if load <= R::ZERO {
            return;
        }
        if let Some(law) = touch.rolling_resistance(problem, load) {
            let normal = touch.normal_of_resistance(problem);
            self.resistances.add(normal, &law);
            self.torque += (self.resistances).torque_of(&law, normal, self.angular_velocity);
        }
    }

    /// Effect of rounding of the angular velocity on the balance, √J.
    #[cold]
    #[inline(never)]
    pub(super) fn rounding<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
    ) -> R {
        let of_body = trial.cayley.length() * (R::TWO * problem.per_second);
        let size = of_body.at_least(self.angular_velocity.length());
        let slope = self
            .resistances
            .groups()
            .iter()
            .fold(R::ZERO, |sum, group| {
                let [across_path, _] = group.ratios(self.angular_velocity);
                let [_, spinning] = group.slopes(self.angular_velocity);
                sum + across_path.at_least(spinning)
            });
        let rounding = size * slope * (R::EPSILON * R::from_f64(4.0));
        let per_root = problem
            .scene
            .inertia_properties()
            .largest_inverse_moment()
            .sqrt();
        rounding * (problem.seconds * R::HALF) * per_root
    }

    /// Whether the groups of contacts have the torque of the contacts for any angular velocity, and
    /// not for that of the trial alone.
    pub(super) fn is_exact(&self) -> bool {
        !self.resistances.is_merged
    }

    /// Solves for the shift and the rotation by which a trial with this residual (N s, N m s) is
    /// balanced.
    #[cold]
    #[inline(never)]
    pub(super) fn step<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        matrix: &Factored<R>,
        cayley: R::Vec3,
        [force, torque]: [R::Vec3; 2],
    ) -> (R::Vec3, R::Vec3) {
        let solve = |force, torque| matrix.solve(force, torque, problem.bounding_radius);
        let half = problem.seconds * R::HALF;
        let by = |torque| solve(R::Vec3::ZERO, torque);
        let along = [
            by(R::Vec3::new(half, R::ZERO, R::ZERO)),
            by(R::Vec3::new(R::ZERO, half, R::ZERO)),
            by(R::Vec3::new(R::ZERO, R::ZERO, half)),
        ];
        let columns = |of: fn((R::Vec3, R::Vec3)) -> R::Vec3| {
            let [x, y, z] = along.map(of);
            Matrix3 { x, y, z }
        };
        let by_rotation = Matrix3::<R>::by_turn(cayley).scaled(problem.per_second);
        let (shift, turn) = solve(-force, -torque);
        let by_torque = by_rotation.times_matrix(&columns(|(_, turn)| turn));
        let here = self.resistances.torque(self.angular_velocity);
        let change = self.change(by_rotation.times(turn), &by_torque, here);
        // The rotation follows from the change of the angular velocity: as the effect of the
        // torques it is a small difference of two large ones.
        let shift = shift + columns(|(shift, _)| shift).times(self.torque_after(change) - here);
        (shift, by_rotation.solve(change))
    }

    /// Torque (N m) after a change of the angular velocity (rad/s).
    fn torque_after(&self, change: R::Vec3) -> R::Vec3 {
        self.resistances.torque(self.angular_velocity + change)
    }

    /// Solves `δ = δ̂ + G (T(ω + δ) - T(ω))` for the change δ of the angular velocity. `freely`
    /// (δ̂) is the change without a change of the torque, `by_torque` the matrix G, and `torque` is
    /// `T(ω)`.
    fn change(&self, freely: R::Vec3, by_torque: &Matrix3<R>, torque: R::Vec3) -> R::Vec3 {
        let here = self.angular_velocity;
        let residual = |by: R::Vec3| by - freely - by_torque.times(self.torque_after(by) - torque);
        let with =
            |matrix: &Matrix3<R>| Matrix3::diagonal(R::ONE).plus(&by_torque.times_matrix(matrix));
        let free = here + freely - by_torque.times(torque);
        let mut by = -here;
        let mut off = residual(by);
        if freely.length() < off.length() {
            (by, off) = (R::Vec3::ZERO, -freely);
        }
        for _ in 0..PASSES {
            let more = with(&self.resistances.slope(here + by)).solve(-off);
            if more.length() <= by.length() * R::EPSILON {
                break;
            }
            let mut next = by + more;
            let mut next_off = residual(next);
            // It is false for NaN too.
            let is_better = next_off.length() < off.length();
            if !is_better {
                next = with(&self.resistances.ratio(here + by)).solve(free) - here;
                next_off = residual(next);
            }
            (by, off) = (next, next_off);
        }
        by
    }

    /// Matrix (N m s²) by which the end-velocity correction resists the difference between the
    /// angular velocity at the end of the step (rad/s, relative to the ground) and its mean. `None`
    /// if the step resolves the resistance.
    #[cold]
    #[inline(never)]
    pub(super) fn correction<D: Dynamics<R>>(
        &self,
        problem: &Problem<'_, R, D>,
        end: R::Vec3,
    ) -> Option<Matrix3<R>> {
        let shares = self.shares(problem);
        if shares == [R::ZERO; 2] {
            return None;
        }
        let groups = self.resistances.groups().iter();
        Some(groups.fold(Matrix3::ZERO, |sum, group| {
            let [along, across] = self.chords(group, end);
            let factors = [along * shares[0], across * shares[1]];
            sum.plus(&group.matrix(factors).scaled(problem.seconds))
        }))
    }

    /// Factors θ of the correction, for rolling and for spinning, as if all groups had one normal.
    fn shares<D: Dynamics<R>>(&self, problem: &Problem<'_, R, D>) -> [R; 2] {
        let mut strains = [R::ZERO; 2];
        for group in self.resistances.groups() {
            let parts = group.parts(self.angular_velocity);
            let ratios = group.ratios(self.angular_velocity);
            for ((strain, part), ratio) in strains.iter_mut().zip(parts).zip(ratios) {
                *strain += ratio * (problem.seconds / problem.moment_about(part));
            }
        }
        strains.map(share_of)
    }

    /// Slopes of the torques used for the correction, N m s: those to 0 if the end is opposite to
    /// the mean, else those of the law at the mean.
    fn chords(&self, group: &Group<R>, end: R::Vec3) -> [R; 2] {
        let mean = self.angular_velocity;
        let [rolling, spinning] = group.parts(mean);
        let is_reversed = [rolling, spinning].map(|part| end.dot(part) <= R::ZERO);
        let (ratios, slopes) = (group.ratios(mean), group.slopes(mean));
        [0, 1].map(|part| {
            if is_reversed[part] {
                ratios[part]
            } else {
                slopes[part]
            }
        })
    }
}

/// Adds the derivative of the torque by the loads to the matrix.
#[cold]
#[inline(never)]
pub(super) fn add_loads<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    contacts: &Contacts<R>,
    trial: &TrialStep<R>,
    equations: &mut SixBySix<R>,
) {
    let rotation = problem.mean_rotation(trial);
    contacts.visit_active(problem, trial, &mut |touch| {
        if let Some(by_load) = touch.torque_of_unit_load(problem, rotation) {
            let push = &touch.push;
            let slope = push.mean.slope * (problem.seconds * R::HALF);
            equations.add_torque(by_load * slope, push.normal, push.end_arm);
        }
    });
}

#[cfg(test)]
mod tests {
    use crate::{EnergyMomentum, FlatGround, Frictionless, MovingGround, Sphere, State, Stepper};
    use crate::{SpringDamperGround, UniformGravity, WithResistance};
    use glam::DVec3;

    /// The table gives the ball the angular momentum L about the vertical, at its own rate Ω. So it
    /// does the work `Ω L`.
    #[test]
    fn a_turntable_works_on_a_ball_whose_spin_it_resists() {
        let (radius, depth, rate, time_step) = (0.05, 1e-3, 2.0, 1e-3);
        let flat = FlatGround::level(1e4, 0.0);
        let friction = WithResistance {
            friction: Frictionless,
            rolling: 1e-3,
            spinning: 2e-3,
            turn_speed: 1e-2,
        };
        let stepper = Stepper::builder(Sphere::solid(0.2, radius))
            .ground(MovingGround::turntable(flat, DVec3::ZERO, rate))
            .friction(friction)
            .gravity(UniformGravity::down(9.8))
            .integrator(EnergyMomentum { time_step })
            .build()
            .unwrap();
        let mut state = State::at(DVec3::new(0.3, -0.1, radius - depth));
        let before = stepper.energy(&state).total();
        let step = stepper.step(&mut state).unwrap();
        // The ball is slower than the table throughout, so that the torque is nearly the largest.
        let largest = friction.spinning * flat.spring_force(depth) * time_step;
        let given = state.angular_momentum.z / largest;
        assert!((0.9..1.0).contains(&given), "{given}");
        let expected = rate * state.angular_momentum.z;
        assert!((step.drive_work - expected).abs() < 1e-15, "{expected:e}");
        assert!(stepper.energy(&state).rotation > 0.0);
        assert!(stepper.energy(&state).total() <= before + step.drive_work);
    }
}
