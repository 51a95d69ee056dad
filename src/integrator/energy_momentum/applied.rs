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

use super::linear::SixBySix;
use crate::energy::Energy;
use crate::error::StepError;
use crate::force::{Force, Wrench};
use crate::integrator::energy_limit;
use crate::integrator::interface::Step;
use crate::real::{Real, Vector};
use crate::scene::Dynamics;
use crate::state::{Motion, State};

/// `1 - 1/√2`
const GAMMA: f64 = 1.0 - core::f64::consts::FRAC_1_SQRT_2;
/// Number of iterations after which a stage counts as not solved.
const MOST_ITERATIONS: u32 = 40;
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

/// End of a push: the state, and the work of the drives, J.
struct End<R: Real> {
    state: State<R>,
    work: R,
}

/// Accepts the end of a push. Its computed energy is at most the one before plus the work of the
/// drives: rounding is taken from the velocities, and the push is left out where that is
/// impossible.
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
    }
}

/// Raises the stated work by the rounding of the sums, so that the energy after the step is at most
/// the energy before it plus the work, as computed.
pub(super) fn close_account<R: Real>(before: R, after: R, step: &mut Step<R>) {
    if step.drive_work == R::ZERO {
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

    /// Change of both velocities by an impulse.
    fn change(&self, impulse: &Wrench<R>) -> [R::Vec3; 2] {
        let properties = self.scene.inertia_properties();
        [
            impulse.force * properties.inverse_mass(),
            properties.angular_velocity(&self.motion.axes, impulse.torque),
        ]
    }

    /// Motion after an impulse.
    fn motion_after(&self, impulse: &Wrench<R>) -> Motion<R> {
        let [linear, angular] = self.change(impulse);
        Motion {
            linear_velocity: self.motion.linear_velocity + linear,
            angular_velocity: self.motion.angular_velocity + angular,
            ..self.motion
        }
    }

    /// Matrix `1 - factor ∂W/∂u M⁻¹` at a motion.
    fn matrix(&self, motion: &Motion<R>, factor: R) -> SixBySix<R> {
        let mut rows = [[R::ZERO; 6]; 6];
        for (index, column) in units::<R>().iter().enumerate() {
            let [linear, angular] = self.change(column);
            let change = (self.scene.force()).wrench_change(motion, linear, angular);
            let entries = numbers(&column.plus(&change, -factor));
            for (row, entry) in rows.iter_mut().zip(entries) {
                row[index] = entry;
            }
        }
        SixBySix { rows }
    }

    /// Solves `W = W(u + M⁻¹ (base + factor W))` for the force and torque of a stage, from a first
    /// guess. Returns `None` if Newton's iteration does not converge.
    fn stage(&self, base: &Wrench<R>, factor: R, guess: Wrench<R>) -> Option<Wrench<R>> {
        let mut wrench = guess;
        let mut last = R::MAX;
        for _ in 0..MOST_ITERATIONS {
            let motion = self.motion_after(&base.plus(&wrench, factor));
            let found = self.scene.force().wrench(&motion);
            let residual = found.plus(&wrench, -R::ONE);
            let size = self.size(&residual);
            if !size.is_finite() {
                return None;
            }
            let rounding = self.size(&found) * (R::EPSILON * R::from_f64(4.0));
            if size <= rounding || (size >= last * R::HALF && size <= rounding * R::from_f64(1e3)) {
                return Some(found);
            }
            last = size;
            let matrix = self.matrix(&motion, factor);
            let (force, torque) = matrix.solve(residual.force, residual.torque, R::ONE);
            wrench = wrench.plus(&Wrench { force, torque }, R::ONE);
        }
        None
    }

    /// Size of a wrench as a force, N: torques act at the radius of gyration.
    fn size(&self, wrench: &Wrench<R>) -> R {
        let radius = self.scene.inertia_properties().radius_of_gyration();
        let torque = if radius > R::ZERO {
            wrench.torque.length() / radius
        } else {
            R::ZERO
        };
        wrench.force.length() + torque
    }
}

/// Both stages of a push. Returns `None` if one is not solved.
fn two_stages<R: Real, D: Dynamics<R>>(scene: &D, state: &State<R>, seconds: R) -> Option<End<R>> {
    let pose = Pose {
        scene,
        motion: scene.motion(state),
        state: *state,
    };
    let factor = seconds * R::from_f64(GAMMA);
    let first = pose.stage(&Wrench::ZERO, factor, scene.force().wrench(&pose.motion))?;
    let base = Wrench::ZERO.plus(&first, seconds - factor * R::TWO);
    let second = pose.stage(&base, factor, first)?;
    let half = seconds * R::HALF;
    let drive = |impulse: &Wrench<R>| scene.force().power(&pose.motion_after(impulse)).drive;
    let work = if scene.force().is_passive() {
        R::ZERO
    } else {
        half * (drive(&Wrench::ZERO.plus(&first, factor)) + drive(&base.plus(&second, factor)))
    };
    let end = pose.after(&Wrench::ZERO.plus(&first.plus(&second, R::ONE), half));
    let is_finite = end.not_finite().is_none() && work.is_finite();
    is_finite.then_some(End { state: end, work })
}

/// Unit force and torque along each axis.
fn units<R: Real>() -> [Wrench<R>; 6] {
    let (o, i) = (R::ZERO, R::ONE);
    let axes = [
        R::Vec3::new(i, o, o),
        R::Vec3::new(o, i, o),
        R::Vec3::new(o, o, i),
    ];
    let [fx, fy, fz] = axes.map(Wrench::of_force);
    let [tx, ty, tz] = axes.map(Wrench::of_torque);
    [fx, fy, fz, tx, ty, tz]
}

/// The six components of a wrench.
fn numbers<R: Real>(wrench: &Wrench<R>) -> [R; 6] {
    let (f, t) = (wrench.force, wrench.torque);
    [f.x(), f.y(), f.z(), t.x(), t.y(), t.z()]
}
