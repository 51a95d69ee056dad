//! Applied force at a fixed pose: half of it before a step, half of it after.
//!
//! With `u = (v, ω)`, `M` the mass and the inertia at the pose, and `W(u)` the force and torque,
//! the velocities obey `M u' = W(u)`. Two implicit stages of length `h` solve it:
//!
//! ```text
//! u₁ = u + h γ M⁻¹ W(u₁)
//! u₂ = u + h M⁻¹ ((1 - 2γ) W(u₁) + γ W(u₂))         γ = 1 - 1/√2
//! u' = u + h/2 M⁻¹ (W(u₁) + W(u₂))
//! ```
//!
//! The method has order 2 and is L-stable: a drag that stops the body within the step stops it. It
//! is also algebraically stable (Burrage & Butcher, SIAM J. Numer. Anal. 16, 46, 1979; Hairer &
//! Wanner II, section IV.12): with `s = γ - 1/4 > 0`,
//!
//! ```text
//! E' - E = h/2 (W₁ · u₁ + W₂ · u₂) - h² s/2 (W₁ - W₂) · M⁻¹ (W₁ - W₂)
//! ```
//! A passive force has `W · u <= 0`, so its kinetic energy never increases. The work of a drive is
//! `h/2 (P₁ + P₂)`, with its powers at the stages.

use super::problem::{Problem, TrialStep};
use super::shared::seen;
use crate::energy::Energy;
use crate::error::StepError;
use crate::force::{Force, Wrench};
use crate::integrator::energy_limit;
use crate::integrator::interface::Step;
use crate::integrator::linear::SixBySix;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, is_driven};
use crate::state::{Motion, State};

/// `1 - 1/√2`
const GAMMA: f64 = 1.0 - core::f64::consts::FRAC_1_SQRT_2;
/// Number of iterations after which a stage counts as not solved. Far from the solution, quadratic
/// drag divides the velocity by 2 in each.
const MOST_ITERATIONS: u32 = 100;
/// Largest ratio of two corrections at which substitution goes on. It then takes 13 evaluations of
/// the force for all bits of a double, and each iteration of Newton's takes 7 and a matrix.
const FALL: f64 = 1.0 / 16.0;
/// Number of halvings of a step whose stages are not solved.
const MOST_HALVINGS: u32 = 12;

/// Applies the force for a time (s) to the velocities of a state, and to its energy. The work of
/// drives is added to the step. Nothing changes if no force acts.
#[inline(always)]
pub(super) fn pushed<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &mut State<R>,
    energy: &mut Energy<R>,
    seconds: R,
    step: &mut Step<R>,
) -> Result<(), StepError> {
    if scene.force().acts() {
        push(scene, state, energy, seconds, step)
    } else {
        Ok(())
    }
}

#[inline(never)]
fn push<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &mut State<R>,
    energy: &mut Energy<R>,
    seconds: R,
    step: &mut Step<R>,
) -> Result<(), StepError> {
    let (mut done, mut parts) = (0_u32, 1_u32);
    while done < parts {
        let part = seconds / R::from_usize(parts as usize);
        if let Some(end) = two_stages(scene, state, part) {
            hold(scene, (state, energy), &end, step);
            done += 1;
        } else if parts < 1 << MOST_HALVINGS {
            (done, parts) = (done * 2, parts * 2);
        } else {
            return Err(StepError::ForceTooSteep {
                seconds: seconds.to_f64(),
            });
        }
    }
    Ok(())
}

/// Change of the velocities by the force after a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ahead<R: Real> {
    /// m/s
    linear: R::Vec3,
    /// rad/s
    angular: R::Vec3,
}

impl<R: Real> Ahead<R> {
    pub(super) const NONE: Self = Self {
        linear: R::Vec3::ZERO,
        angular: R::Vec3::ZERO,
    };

    /// Change that a body with the mean velocities of a trial would have, in the pose of its end.
    /// The force on a body that friction holds is that on a body at rest.
    #[inline(always)]
    pub(super) fn of<D: Dynamics<R>>(
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
        end: &State<R>,
    ) -> Self {
        if problem.scene.force().acts() && problem.force_seconds > R::ZERO {
            Self::of_mean(problem, trial, end)
        } else {
            Self::NONE
        }
    }

    #[inline(never)]
    fn of_mean<D: Dynamics<R>>(
        problem: &Problem<'_, R, D>,
        trial: &TrialStep<R>,
        end: &State<R>,
    ) -> Self {
        let momentum = problem.start.angular_momentum + end.angular_momentum;
        let mean = State {
            linear_velocity: trial.velocity,
            angular_momentum: momentum * R::HALF,
            ..*end
        };
        let Some(pushed) = two_stages(problem.scene, &mean, problem.force_seconds) else {
            return Self::NONE;
        };
        let [before, after] = [&mean, &pushed.state].map(|state| problem.scene.motion(state));
        Self {
            linear: after.linear_velocity - before.linear_velocity,
            angular: after.angular_velocity - before.angular_velocity,
        }
    }

    /// Motion of a state after the change, relative to the ground's material.
    #[inline(always)]
    pub(super) fn seen<D: Dynamics<R>>(&self, scene: &D, state: &State<R>) -> Motion<R> {
        let motion = seen(scene, state);
        if !scene.force().acts() {
            return motion;
        }
        Motion {
            linear_velocity: motion.linear_velocity + self.linear,
            angular_velocity: motion.angular_velocity + self.angular,
            ..motion
        }
    }
}

/// End of a push: the state, and the work of the drives, J.
struct End<R: Real> {
    state: State<R>,
    work: R,
}

/// Accepts the end of a push. Its computed energy is at most the one before plus the work of the
/// drives: rounding is taken from the velocities. Where that is impossible, because the push has
/// stopped the body, the work of a drive is raised, and a push by a passive force is left out.
fn hold<R: Real, D: Dynamics<R>>(
    scene: &D,
    (state, energy): (&mut State<R>, &mut Energy<R>),
    end: &End<R>,
    step: &mut Step<R>,
) {
    let after = Energy {
        springs: energy.springs,
        ..Energy::without_springs(scene, &end.state)
    };
    let ceiling = energy.total() + end.work;
    if after.total() <= ceiling {
        (*state, *energy) = (end.state, after);
        step.drive_work += end.work;
        return;
    }
    let excess = after.total() - ceiling;
    let held = energy_limit::scaled_down(scene, ceiling, excess, &end.state, after);
    if let Some(held) = held {
        (*state, *energy) = held;
        step.drive_work += end.work;
        step.energy_removed += excess;
    } else if !scene.force().is_passive() {
        (*state, *energy) = (end.state, after);
        step.drive_work += end.work + excess;
    }
}

/// Raises the stated work of a drive by the rounding of the sums, so that the energy after the step
/// is at most the energy before it plus the work, as computed.
#[inline]
pub(in crate::integrator) fn close_account<R: Real, D: Dynamics<R>>(
    scene: &D,
    [before, after]: [R; 2],
    step: &mut Step<R>,
) {
    if !is_driven(scene) {
        return;
    }
    let mut excess = after - (before + step.drive_work);
    while excess > R::ZERO {
        let raised = step.drive_work + excess;
        // The excess is below the resolution of the work.
        let unit = step.drive_work.abs() * R::EPSILON;
        step.drive_work = if raised > step.drive_work {
            raised
        } else {
            step.drive_work + unit
        };
        excess = after - (before + step.drive_work);
    }
}

/// The velocities at a fixed pose, as functions of the force and torque that act on them.
struct Pose<'a, R: Real, D> {
    scene: &'a D,
    motion: Motion<R>,
    state: State<R>,
}

impl<R: Real, D: Dynamics<R>> Pose<'_, R, D> {
    /// State after an impulse.
    fn after(&self, impulse: &Wrench<R>) -> State<R> {
        let properties = self.scene.inertia_properties();
        let momentum = self.state.angular_momentum + impulse.torque;
        State {
            linear_velocity: self.state.linear_velocity + impulse.force * properties.inverse_mass(),
            angular_momentum: properties.without_dead_spin(self.state.rotation(), momentum),
            ..self.state
        }
    }

    /// Motion after an impulse, in the same pose.
    fn motion_after(&self, impulse: &Wrench<R>) -> Motion<R> {
        let end = self.after(impulse);
        let properties = self.scene.inertia_properties();
        Motion {
            linear_velocity: end.linear_velocity,
            angular_velocity: properties.angular_velocity(&self.motion.axes, end.angular_momentum),
            ..self.motion
        }
    }

    /// Momentum that changes of both velocities carry, N s and N m s.
    fn impulse(&self, [linear, angular]: [R::Vec3; 2]) -> Wrench<R> {
        let properties = self.scene.inertia_properties();
        let (inertia, _) =
            properties.inertia_for_solving(&self.motion.axes, self.state.angular_momentum);
        let [x, y, z] = inertia;
        Wrench {
            force: linear * properties.mass(),
            torque: x * angular.x() + y * angular.y() + z * angular.z(),
        }
    }

    /// Momentum that a motion has in addition to that of the start, N s and N m s.
    fn taken(&self, motion: &Motion<R>) -> Wrench<R> {
        let properties = self.scene.inertia_properties();
        let linear = motion.linear_velocity - self.motion.linear_velocity;
        let angular = motion.angular_velocity - self.motion.angular_velocity;
        Wrench {
            force: linear * properties.mass(),
            torque: properties.momentum_for_solving(&self.motion.axes, angular),
        }
    }

    /// Returns true if a correction of both velocities is within their rounding.
    ///
    /// A needle can spin about its own axis with little momentum. The rounding of that spin, times
    /// the largest moment, then exceeds the rounding of the momentum.
    fn is_rounding(&self, motion: &Motion<R>, [linear, angular]: [R::Vec3; 2]) -> bool {
        let few = R::EPSILON * R::from_f64(4.0);
        let start = &self.motion;
        let speed = start.linear_velocity.length() + motion.linear_velocity.length();
        let spin = start.angular_velocity.length() + motion.angular_velocity.length();
        linear.length() <= speed * few && angular.length() <= spin * few
    }

    /// Matrix `M - factor ∂W/∂u` at a motion.
    ///
    /// It is well conditioned for a slender body, unlike `1 - factor ∂W/∂u M⁻¹`.
    fn matrix(&self, motion: &Motion<R>, factor: R) -> SixBySix<R> {
        let mut rows = [[R::ZERO; 6]; 6];
        for (index, velocities) in units::<R>().into_iter().enumerate() {
            let [linear, angular] = velocities;
            let change = (self.scene.force()).wrench_change(motion, linear, angular);
            let entries = numbers(&self.impulse(velocities).plus(&change, -factor));
            for (row, entry) in rows.iter_mut().zip(entries) {
                row[index] = entry;
            }
        }
        SixBySix { rows }
    }

    /// Solves `M (u - u₀) = base + factor W(u)` for the velocities of a stage, from a first guess.
    /// Returns `None` if no iteration converges.
    ///
    /// An iteration has converged when a correction is within the rounding of the momentum.
    fn stage(&self, base: &Wrench<R>, factor: R, guess: Motion<R>) -> Option<Stage<R>> {
        self.stage_by_substitution(base, factor, guess)
            .or_else(|| self.stage_by_newton(base, factor, guess))
    }

    /// Solves a stage by substitution: each iterate is put into the right-hand side.
    ///
    /// Each correction is the last one times about `factor ∂W/∂u M⁻¹`. That is a small number for
    /// the air around most bodies, so that a few evaluations of the force replace the matrices of
    /// Newton's iteration. Returns `None` if a correction is not far below the last one.
    fn stage_by_substitution(
        &self,
        base: &Wrench<R>,
        factor: R,
        guess: Motion<R>,
    ) -> Option<Stage<R>> {
        let (force, momentum) = (self.scene.force(), self.momentum());
        let (mut motion, mut given) = (guess, Wrench::ZERO);
        let mut last = R::MAX;
        loop {
            let next = base.plus(&force.wrench(&motion), factor);
            let size = self.size(&next.plus(&given, -R::ONE));
            given = next;
            motion = self.motion_after(&given);
            if size <= (momentum + self.size(&given)) * R::EPSILON {
                let wrench = force.wrench(&motion);
                return wrench.is_finite().then_some(Stage { motion, wrench });
            }
            // It is false for NaN too.
            let falls = size <= last * R::from_f64(FALL);
            if !falls {
                return None;
            }
            last = size;
        }
    }

    /// Solves a stage by Newton's iteration.
    fn stage_by_newton(&self, base: &Wrench<R>, factor: R, guess: Motion<R>) -> Option<Stage<R>> {
        let mut motion = guess;
        let mut last = R::MAX;
        for _ in 0..MOST_ITERATIONS {
            let wrench = self.scene.force().wrench(&motion);
            let taken = self.taken(&motion);
            let given = base.plus(&wrench, factor);
            let residual = given.plus(&taken, -R::ONE);
            let matrix = self.matrix(&motion, factor);
            let (linear, angular) = matrix.solve(residual.force, residual.torque, self.radius());
            motion.linear_velocity += linear;
            motion.angular_velocity += angular;
            let size = self.size(&self.impulse([linear, angular]));
            if !size.is_finite() {
                return None;
            }
            // Far from the solution, a stiff force gives far more than the motion has taken.
            let rounding = (self.momentum() + self.size(&taken)) * R::EPSILON;
            // The second condition ends an iteration that rounding keeps from falling further.
            let is_stalled = size >= last * R::HALF && size <= rounding * R::from_f64(1e3);
            if size <= rounding || is_stalled || self.is_rounding(&motion, [linear, angular]) {
                let wrench = self.wrench_that_gives(&motion, base, factor);
                return wrench.is_finite().then_some(Stage { motion, wrench });
            }
            last = size;
        }
        None
    }

    /// Wrench with which a motion solves the equation of its stage.
    ///
    /// A stiff force is the small difference of large terms, as that of a strong drag near the
    /// velocity of the wind. Evaluated, it has the rounding of its terms, which moves a light body
    /// in single precision by more than its speed. The momentum has only its own rounding.
    fn wrench_that_gives(&self, motion: &Motion<R>, base: &Wrench<R>, factor: R) -> Wrench<R> {
        let given = self.taken(motion).plus(base, -R::ONE);
        Wrench::ZERO.plus(&given, R::ONE / factor)
    }

    /// Size of the momentum at the start, N s, with the angular momentum as in
    /// [`size`](Self::size).
    fn momentum(&self) -> R {
        let mass = self.scene.inertia_properties().mass();
        self.size(&Wrench {
            force: self.motion.linear_velocity * mass,
            torque: self.state.angular_momentum,
        })
    }

    /// Size of a wrench as a force, N: torques act at the radius of gyration.
    fn size(&self, wrench: &Wrench<R>) -> R {
        wrench.force.length() + wrench.torque.length() / self.radius()
    }

    /// Radius of gyration, or 1 m for a body without one.
    fn radius(&self) -> R {
        let radius = self.scene.inertia_properties().radius_of_gyration();
        if radius > R::ZERO { radius } else { R::ONE }
    }
}

/// Motion of a stage, with the force and torque there.
struct Stage<R: Real> {
    motion: Motion<R>,
    wrench: Wrench<R>,
}

/// Both stages of a push. Returns `None` if one is not solved.
fn two_stages<R: Real, D: Dynamics<R>>(scene: &D, state: &State<R>, seconds: R) -> Option<End<R>> {
    let pose = Pose {
        scene,
        motion: scene.motion(state),
        state: *state,
    };
    let factor = seconds * R::from_f64(GAMMA);
    let first = pose.stage(&Wrench::ZERO, factor, pose.motion)?;
    let base = Wrench::ZERO.plus(&first.wrench, seconds - factor * R::TWO);
    let second = pose.stage(&base, factor, first.motion)?;
    let half = seconds * R::HALF;
    // The drag of a stiff stage is small, and so is its rounding. That of the drive is not.
    let drive = |stage: &Stage<R>| {
        stage.wrench.power(&stage.motion) - scene.force().power(&stage.motion).drag
    };
    let work = if scene.force().is_passive() {
        R::ZERO
    } else {
        half * (drive(&first) + drive(&second))
    };
    let sum = first.wrench.plus(&second.wrench, R::ONE);
    let end = pose.after(&Wrench::ZERO.plus(&sum, half));
    let is_finite = end.not_finite().is_none() && work.is_finite();
    is_finite.then_some(End { state: end, work })
}

/// Unit velocity and unit angular velocity along each axis.
fn units<R: Real>() -> [[R::Vec3; 2]; 6] {
    let (o, i) = (R::ZERO, R::ONE);
    let axes = [
        R::Vec3::new(i, o, o),
        R::Vec3::new(o, i, o),
        R::Vec3::new(o, o, i),
    ];
    let [x, y, z] = axes.map(|axis| [axis, R::Vec3::ZERO]);
    let [a, b, c] = axes.map(|axis| [R::Vec3::ZERO, axis]);
    [x, y, z, a, b, c]
}

/// The six components of a wrench.
fn numbers<R: Real>(wrench: &Wrench<R>) -> [R; 6] {
    let (f, t) = (wrench.force, wrench.torque);
    [f.x(), f.y(), f.z(), t.x(), t.y(), t.z()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AirDrag, EnergyMomentum, Frictionless, Integrator, NoGravity, NoGround};
    use crate::{PointCloud, Scene, Sphere, Wind};
    use glam::DVec3;

    const DRAG: AirDrag = AirDrag {
        linear: 0.2,
        quadratic: 0.0,
    };

    /// Torques act at the radius of gyration: `√(2/5) r` for a solid ball.
    #[test]
    fn the_size_of_a_wrench_counts_torques_at_the_radius_of_gyration() {
        let radius = 0.02;
        let body = Sphere::solid(0.3, radius);
        let scene = Scene::new(body, NoGround, Frictionless, NoGravity).unwrap();
        let state = State::at(DVec3::ZERO);
        let pose = Pose {
            scene: &scene,
            motion: scene.motion(&state),
            state,
        };
        let size = pose.size(&Wrench {
            force: DVec3::new(2.0, 3.0, 6.0),
            torque: DVec3::new(0.1, 0.4, -0.8),
        });
        let expected = 7.0 + 0.9 / (0.4_f64.sqrt() * radius);
        assert!((size / expected - 1.0).abs() < 1e-14, "{size}");
    }

    /// The works of the two halves of a step may cancel, with the rounding of the energies between
    /// them left.
    #[test]
    fn works_that_cancel_leave_no_gain_of_energy() {
        let body = Sphere::solid(0.3, 0.02);
        let still = Scene::new(body, NoGround, Frictionless, NoGravity).unwrap();
        let wind = Wind {
            velocity: DVec3::X,
            force: DRAG,
        };
        let energies = [0.1, 0.1 * (1.0 + f64::EPSILON)];
        let work_of = |close: &dyn Fn(&mut Step<f64>)| {
            let mut step = Step::new(1e-3, 1);
            close(&mut step);
            step.drive_work
        };
        let windy = still.with_force(wind).unwrap();
        let work = work_of(&|step| close_account(&windy, energies, step));
        assert!(work > 0.0 && energies[1] <= energies[0] + work, "{work:e}");
        let lost = work_of(&|step| close_account(&windy, [energies[1], energies[0]], step));
        assert!(lost.abs() <= 0.0, "{lost:e}");
        // Nothing can have done work on a body in still air.
        let in_air = still.with_force(DRAG).unwrap();
        let passive = work_of(&|step| close_account(&in_air, energies, step));
        assert!(passive.abs() <= 0.0, "{passive:e}");
    }

    /// With the drag c the speed falls by `e^(-c t/m)`. The method has order 2, so that its
    /// relative error is some fraction of `(c t/m)³`.
    #[test]
    fn a_body_without_a_radius_of_gyration_is_slowed_by_air() {
        let (mass, time_step) = (0.4, 0.02);
        let body = PointCloud::new([DVec3::new(1.0, 2.0, 3.0)], [mass]).unwrap();
        let scene = Scene::new(body, NoGround, Frictionless, NoGravity).unwrap();
        let scene = scene.with_force(DRAG).unwrap();
        let start = State::at(DVec3::ZERO).with_linear_velocity(DVec3::new(3.0, -4.0, 12.0));
        let (mut state, mut workspace) = (start, Default::default());
        (EnergyMomentum { time_step })
            .step(&scene, &mut state, time_step, &mut workspace)
            .unwrap();
        let exponent = DRAG.linear * time_step / mass;
        let left = state.linear_velocity / start.linear_velocity;
        let off = (left / (-exponent).exp() - DVec3::ONE).abs().max_element();
        assert!(off < exponent.powi(3), "{off:e}");
    }
}
