//! Nyström's method, corrected for contacts that close or open within a step.
//!
//! # Coefficients
//!
//! Three sets of conditions leave three numbers free:
//! - the conditions of the orders (Hairer, Nørsett & Wanner I, section II.14)
//! - `B_i = b_i (1 - c_i)`, which the correction of touch-downs requires
//! - `c_4 = 1`
//!
//! The choice of Nyström (1925) has order 5 if forces depend on the position alone. Here two nodes
//! are `1/4` and `5/8`, and `Σ_ij B_i A_ij c_j = 1/120 - 1/1440`. This choice has smaller errors of
//! phase and amplitude for an oscillation on springs. The matrix `a` then follows from
//! `Σ_i b_i a_ij = b_j (1 - c_j)` and `b_4 a_43 a_32 c_2 = 1/24`. It is the only one that makes the
//! velocities a method of order 4 with these nodes and weights.
//!
//! # Correction of touch-downs
//!
//! The force of a contact that closes is discontinuous by `Δf`, or its derivative is. The weighted
//! sum over the stages then has an error of `h Δf`, whatever the order. The path of the contact
//! between both ends of the step is known, however, and with it the leading term of that error. For
//! each contact that pushes at one end of the step and not at the other, the end of the step is
//! corrected by
//!
//! ```text
//! Δp = h (∫ f ds - Σ b_i f(c_i))     and the pose by     h² (∫ (1 - s) f ds - Σ B_i f(c_i))
//! ```
//! Here `s` is the fraction of the step, and `f(s)` is the normal force for a penetration depth
//! that follows Hermite's cubic between both ends. `f(c_i)` is the force that the stages have used.
//!
//! The arm and the direction `D` of the force are those at both ends:
//! `Δp = Δp_B D(0) + (Δp - Δp_B) D(1)`. This follows from `B_i = b_i (1 - c_i)`, and `Δp_B` is the
//! part that corrects the pose. The remaining error is the effect of one stage on the next. It is
//! smaller by one power of the step size, hence order 2.
//!
//! With an estimate there is a second pass, with paths to the corrected end (`adaptive::nystrom`).

mod crossing;
mod lanes;
mod oscillator;
mod stages;
mod uniform;

use crate::body::ContactRange;
use crate::contact::Load;
use crate::error::{self, SceneError, StepError};
use crate::integrator::free_error::{self, Bodies};
use crate::integrator::interface::{Integrator, LIMIT_HALVINGS, Step, step_length};
use crate::integrator::lanes::Lanes;
use crate::integrator::point::Point;
use crate::quadrature::bisect;
use crate::real::{Real, Vector};
use crate::rotation::Rotation;
use crate::scene::Dynamics;
use crate::stability::LinearMotion;
use crate::state::State;
use crossing::SeenStages;
use stages::{END, THIRD_DIFFERENCE};
pub(in crate::integrator) use stages::{Stage, Start};

/// Nyström's method of order 4, corrected for contacts that close or open within a step.
///
/// Nyström's methods are Runge-Kutta methods for second-order differential equations. This one has
/// a low cost for errors between 1e-4 and 1e-6 m when a body rolls and slides.
/// [`AdaptiveNystrom`](crate::AdaptiveNystrom) takes a tolerance in place of a step size.
///
/// The pose `y = (x, q)` follows from its second derivative. Velocity and angular momentum
/// `p = (v, L)` follow from the same loads:
///
/// ```text
/// y_i = y + c_i h y' + h² Σ_j A_ij y''_j     p_i = p + h Σ_j a_ij p'_j
/// x'' = F/m + g                              q'' = (0, J⁻¹ (T - ω × L)) q/2 - ω² q/4
/// ```
/// Here `h` is the step size, `c` are the nodes, and `A` and `a` are the matrices of coefficients.
/// F and T are force and torque of the contacts, and J is the inertia tensor. `(0, v)` is the
/// quaternion with the vector part v, and `ω²` is the squared length of the angular velocity ω.
///
/// Four force evaluations per step. Order 4 in smooth motion, order 5 on linear springs.
/// Torque-free rotation is exact to rounding for a body with three different moments of inertia,
/// and for one whose moment about the axis of symmetry is the smallest.
///
/// Relative errors of an oscillation on springs at `ω dt = 1`:
///
/// | coefficients | phase | amplitude growth per step |
/// |---|---|---|
/// | this method | 9.9e-5 | 1.9e-4 |
/// | Nyström (1925) | 1.45e-4 | 2.4e-4 |
///
/// *Touch-downs.* When a contact closes, the damper's force is discontinuous, and so is the
/// derivative of the spring's force. Every method of high order then falls to order 1 (Gear &
/// Østerby, ACM Transactions on Mathematical Software 10, 23, 1984; Hairer, Nørsett & Wanner I,
/// section II.6). This method computes the leading term of that error from the path of the contact
/// between both ends of the step. It corrects the end of the step by it, which gives order 2
/// through touch-downs.
///
/// [`guide::choosing`](crate::guide::choosing#robust-settings) lists the longest step size for an
/// error of 0.1 mm in each trial of the coin report, and `tests/physics/truth.rs` compares the
/// error with that of [`Rk4`](crate::Rk4) in trial 1, with 150 touch-downs in a second.
///
/// *Limits.* ω and δ are the highest frequency and damping rate that the contacts give the body at
/// their arms (see [integrators](crate#integrators)), and `ζ = δ/2ω`.
/// - *Stable* for `dt < 2.36/ω` and `dt < 2.78/δ`, and up to `3.08/ω` with `ζ = 0.1`, if the
///   damping exceeds the growth stated in the next item.
///   [`Stepper::largest_stable_step`](crate::Stepper::largest_stable_step) computes the limit at a
///   state.
/// - *May add energy.* An oscillation without dampers grows by the relative amount 2.1e-4 (ω dt)⁶
///   per step. Damping of `ζ > 2.1e-4 (ω dt)⁵` removes more than that.
/// - *Not corrected:* a contact that closes and opens again within one step, which only the stages
///   can include, and torques of [rolling and spinning resistance](crate::WithResistance).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Nystrom<R = f64> {
    /// Step size, s, above 0.
    pub time_step: R,
}

impl<R: Real> Integrator<R> for Nystrom<R> {
    /// Contact range of the previous step, in which the next step searches first.
    type Workspace = ContactRange;

    #[inline]
    fn step<D: Dynamics<R>>(
        &self,
        scene: &D,
        state: &mut State<R>,
        limit: R,
        near: &mut ContactRange,
    ) -> Result<Step<R>, StepError> {
        let dt = step_length(self.time_step, limit);
        let start = Start::of(scene.untested(), &Point::of(state), dt, *near);
        let taken = taken(scene, &start, Purpose::End);
        *near = taken.near;
        *state = taken.end.to_state();
        Ok(Step::new(dt, 4))
    }

    const HAS_LANES: bool = true;

    #[inline]
    fn step_in_lanes<D: Dynamics<R>>(&self, scene: &D, lanes: &mut Lanes<R>, seconds: R) {
        lanes.begin();
        lanes.end();
        // The axes of a stage are those of a quaternion of any length.
        lanes.set_axes_of_any_length();
        lanes::step(scene, lanes, seconds);
    }

    fn order(&self) -> u32 {
        4
    }

    fn fixed_step(&self) -> Option<R> {
        Some(self.time_step)
    }

    /// The limit is where an amplification factor of the oscillator exceeds 1 in magnitude. The
    /// factor is not a function of `h λ`. The limit is searched among 128 step sizes, then by
    /// bisection.
    fn largest_stable_step(&self, stiffness: R, damping: R) -> Option<R> {
        // Without damping the oscillation grows at every step size.
        if damping <= R::ZERO {
            return Some(R::ZERO);
        }
        // No larger step size is stable: the tip of the region, at a damping ratio of 0.64.
        let by_springs = R::from_f64(3.71) / stiffness.sqrt();
        let longest = (R::from_f64(4.76) / damping).at_most(by_springs);
        let longest = longest.at_most(R::MAX);
        let part = longest * R::from_f64(1.0 / 128.0);
        let grows = |h: R| oscillator::grows(stiffness * (h * h), damping * h);
        let mut end = part;
        while end < longest && !grows(end) {
            end += part;
        }
        let [stable, _] = bisect([end - part, end], LIMIT_HALVINGS, grows);
        Some(stable)
    }

    fn linear_step(
        &self,
        motion: &LinearMotion,
        start: [[f64; 6]; 2],
        time_step: f64,
    ) -> Option<[[f64; 6]; 2]> {
        Some(oscillator::step(motion, start, time_step))
    }

    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("time step", self.time_step, " s")
    }
}

/// Step that has been taken.
pub(in crate::integrator) struct Taken<R: Real> {
    /// End of the step, with the correction of touch-downs.
    pub(in crate::integrator) end: Point<R>,
    /// Acceleration and torque of the last stage.
    pub(in crate::integrator) last: [R::Vec3; 2],
    /// Mean acceleration and torque by which the correction has changed the step.
    pub(in crate::integrator) correction: [R::Vec3; 2],
    /// Change of that correction by its last pass.
    pub(in crate::integrator) correction_change: [R::Vec3; 2],
    /// Third difference of acceleration and torque over the stages, without the contacts that the
    /// correction replaces. Zero if the step is taken for its end alone.
    pub(in crate::integrator) third_difference: [R::Vec3; 2],
    /// Contact range of the last stage.
    pub(in crate::integrator) near: ContactRange,
}

/// What a step is taken for.
#[derive(Clone, Copy, PartialEq)]
pub(in crate::integrator) enum Purpose {
    /// Its end alone.
    End,
    /// Its end, and what an estimate of its error needs. The errors that are known are left out.
    Estimate,
}

/// Takes a step.
#[inline(always)]
pub(in crate::integrator) fn taken<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &Start<R>,
    purpose: Purpose,
) -> Taken<R> {
    let (bodies, passes) = match purpose {
        Purpose::End => (Bodies::Amplifying, 1),
        Purpose::Estimate => (Bodies::All, 2),
    };
    start.with_stages(scene, |stages| {
        let (point, seconds) = (&start.point, start.seconds);
        let mut end = start.ahead(&END, stages);
        end.orientation = turned(stages, end.orientation, seconds, purpose);
        end.orientation = free_error::removed(
            scene,
            (point, &end),
            seconds,
            bodies,
            |free, point, seconds| free_orientation(free, point, seconds, purpose),
        );
        let seen = SeenStages::at(stages);
        let corrected = crossing::corrected(scene, &seen, end, seconds, passes);
        let [.., fourth] = stages;
        let inverse_mass = scene.inertia_properties().inverse_mass();
        let rates = |load: &Load<R>| [load.force * inverse_mass, load.torque];
        Taken {
            end: corrected.end,
            last: [fourth.acceleration, fourth.torque],
            correction: rates(&corrected.correction),
            correction_change: rates(&corrected.change),
            third_difference: match purpose {
                Purpose::End => [R::Vec3::ZERO; 2],
                Purpose::Estimate => third_difference(scene, stages, &corrected.third_difference),
            },
            near: fourth.range,
        }
    })
}

/// Returns the orientation at the end of a step in a scene without torques.
fn free_orientation<R: Real, D: Dynamics<R>>(
    scene: &D,
    point: &Point<R>,
    seconds: R,
    purpose: Purpose,
) -> Rotation<R> {
    let start = Start::of(scene, point, seconds, ContactRange::NONE);
    start.with_stages(scene, |stages| {
        let end = start.ahead(&END, stages).orientation;
        turned(stages, end, seconds, purpose)
    })
}

/// Returns the orientation at the end of a step. An estimate need not contain the phase error of a
/// uniform rotation, which is left out for it.
#[inline(always)]
fn turned<R: Real>(
    stages: [&Stage<R>; 4],
    end: Rotation<R>,
    seconds: R,
    purpose: Purpose,
) -> Rotation<R> {
    match purpose {
        Purpose::End => end,
        Purpose::Estimate => uniform::without_phase_error(stages, end, seconds),
    }
}

/// Returns the third difference of acceleration and torque, without that of the `replaced` forces.
fn third_difference<R: Real, D: Dynamics<R>>(
    scene: &D,
    stages: [&Stage<R>; 4],
    replaced: &Load<R>,
) -> [R::Vec3; 2] {
    let mut acceleration = -replaced.force * scene.inertia_properties().inverse_mass();
    let mut torque = -replaced.torque;
    for (stage, weight) in stages.into_iter().zip(THIRD_DIFFERENCE) {
        acceleration += stage.acceleration * R::from_f64(weight);
        torque += stage.torque * R::from_f64(weight);
    }
    [acceleration, torque]
}
