//! Implicit energy-momentum method of order 2, with an energy that never increases.
//!
//! The proof is in [`guide::energy`](crate::guide::energy). A step has these stages
//! (`shared`: what several of them use):
//!
//! 0. `fly`: a step without a contact at both ends is a flight, without the stages 1 to 3.
//! 1. `problem`, `gather`, `contacts`, `panels`, `touch`: the two momentum equations of the step,
//!    the contacts that it may reach, and their mean forces along its path (`dual`, `answer`: the
//!    unknowns of friction; `partial`: its load at a touch-down; `reversal`: friction that reverses
//!    along a rim; `lever`: contacts that move over the body).
//! 2. `newton`, `balance`, `stiffness`: the solution of the equations (`level`: its arithmetic;
//!    `hard`: contacts that the step does not resolve; `rolling`, `resistances`:
//!    resistance to rolling and spinning, if the friction law has it). Only the residual of that
//!    solution could increase the energy.
//! 3. `strain`, `end_velocity`, `resist`: end-velocity correction for steps that do not resolve
//!    friction or damping. It uses impulses that only dissipate energy. `applied`: the applied
//!    force, half before and half after the step.
//! 4. `energy_limit`: a correction if the computed energy exceeds the energy before the step. In
//!    flight, the rounding is corrected in the last places of the orientation, the height or the
//!    speed (`flight_rounding`). In contact, both velocities are scaled down until the energy no
//!    longer exceeds it. A body whose motion is below the rounding of its energy comes to rest. In
//!    single precision one at a turning point of its motion moves on (`energy_limit/equilibrium`).
//! 5. Fallbacks if stage 2 or 4 fails. The first is `split` (dissipation, conservative motion,
//!    dissipation; `turning`: resistance to rolling and spinning), in which the springs harden in
//!    stages if necessary (`soften`). The second is a divided step, down to sixteenths. The third
//!    is `descent`, a step downhill as far as the energy allows. In the last one time passes and
//!    the body stays. Each end passes through stage 4. The induction from step to step therefore
//!    needs no assumption on convergence.

mod answer;
mod applied;
mod balance;
mod contacts;
mod descent;
mod dual;
mod end_velocity;
mod gather;
mod hard;
mod level;
mod lever;
mod newton;
mod panels;
mod partial;
mod problem;
mod resist;
mod resistances;
mod reversal;
mod rolling;
mod shared;
mod soften;
mod split;
mod stiffness;
mod strain;
mod touch;
mod turning;
mod work;
mod workspace;

use core::fmt;

use crate::body::RigidPointBody;
use crate::energy::Energy;
use crate::error::{self, Quantity, Rule, SceneError, StepError};
use crate::force::Force;
use crate::integrator::flight::ballistic;
use crate::integrator::interface::{Integrator, Step, step_length};
use crate::integrator::{energy_limit, flight_rounding};
use crate::real::Real;
use crate::rotation::Rotation;
use crate::scene::{Dynamics, turned_freely};
use crate::state::State;
use applied::Ahead;
pub(in crate::integrator) use applied::close_account;
use contacts::Contacts;
use energy_limit::Touched;
use gather::{gather_all, gather_near};
use panels::FOR_RIMS;
use problem::Problem;
pub(in crate::integrator) use problem::unit_of_gap;
use rolling::Rolling;
use shared::End;
use workspace::Memory;
pub use workspace::Workspace;

/// The energy-momentum method: implicit, of order 2, and **the computed energy never increases**.
/// The default of the crate.
///
/// `stepper.energy(&after).total() <= stepper.energy(&before).total()` holds for every step,
/// without a tolerance, in every valid scene without a drive. It holds for any step size,
/// stiffness, damping, friction, spin, size and shape. If a moving ground or an applied force
/// drives the body, the energy increases at most by [`Step::drive_work`].
/// [`guide::energy`](crate::guide::energy) contains the derivation.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Coin, Coulomb, EnergyMomentum, FlatGround, State, Stepper, UniformGravity};
///
/// // The step size is a fiftieth of a second. On this ground an explicit method needs a
/// // three-hundredth of it, or less.
/// let stepper = Stepper::builder(Coin::ring(1.0, 0.5)) // kg, m
///     .gravity(UniformGravity::down(9.8)) // m/s²
///     .ground(FlatGround::level(1e9, 0.0)) // N/m and N s/m, for each point
///     .friction(Coulomb { coefficient: 0.8, slip_speed: 1e-10 }) // -, m/s
///     .integrator(EnergyMomentum { time_step: 0.02 }) // s
///     .build()?;
/// let momentum = DVec3::new(3.0, 10.0, 2.0); // kg m²/s
/// let mut state = State::at(DVec3::Z).with_angular_momentum(momentum); // m
/// for _ in 0..500 {
///     let before = stepper.energy(&state).total();
///     stepper.step(&mut state)?;
///     assert!(stepper.energy(&state).total() <= before);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// - *Order* 2, also at touch-downs: the mean force over the step integrates the discontinuity of
///   the damper force. The order is 1 in these cases: a friction law of your own that jumps to 0
///   with the load, at a touch-down, a contact that crosses an edge of a [`Block`](crate::Block) or
///   of a [`FrictionPatch`](crate::FrictionPatch), a round rim with dampers
///   ([`Disc`](crate::Disc)), and a smooth body in a valley that is more curved than itself, whose
///   force has no potential ([`Ellipsoid`](crate::Ellipsoid)).
/// - *Two laws act otherwise* than in explicit methods, at any step size: a friction whose force
///   leaves the surface ([`AnisotropicCoulomb`](crate::AnisotropicCoulomb) away from its plane),
///   and a torque about an axis without inertia (a [`Rod`](crate::Rod) with
///   [`WithResistance`](crate::WithResistance)).
/// - *Conserves* the energy if nothing dissipates it, to the rounding of each step. The exception
///   is a step whose equations have no solution even in its smallest parts (reported by
///   `fallback`). It may lose any part of the energy. Such steps are rare, and need hard ground
///   (*long steps*).
/// - *Stable* for any step size on the ground and under drag. Under an applied force that depends
///   on the pose, such as a spring of your own, it is stable for `dt < 2/ω` with the frequency ω
///   that the force gives the body: half of the force acts at each end of the step. Beyond that
///   the motion grows, by the work of the force. A step in which free motion would exceed 1e25
///   sizes of the body may return [`StepTooLong`](crate::StepError::StepTooLong).
/// - *Accurate* if the step resolves the contact: `dt < 1/ω` for the step size `dt`, with
///   `ω = √(K/m)`, the mass `m`, and the stiffness `K` of all contacts that touch. With longer
///   steps, a bounce without dampers still conserves its energy, but its timing is wrong. A bounce
///   with dampers has the wrong restitution. Friction that stops a body within a step stops it at
///   the end of the step. [`guide::accuracy`](crate::guide::accuracy) describes the extremes. Under
///   an applied force it is accurate if the step resolves that too: `dt < m/c` for a drag `c` per
///   speed. With a longer step a sinking body has the wrong speed.
/// - *Cost* in contact: two to five iterations a step, each about as expensive as two evaluations
///   of all contacts. Flight costs no iteration. It is exact to rounding over any ground, for any
///   moments of inertia
///   ([`InertiaProperties::turn_freely`](crate::InertiaProperties::turn_freely)). The exception
///   is a step that may bring more contacts to the ground than are stored, 128. It is solved as a
///   step in contact, also if none touches. A body at rest costs a comparison, once a step of the
///   same session has detected the rest. A step of another size can move it once more to a lower
///   energy, by some 1e-11 of its size in `f64`.
/// - *Long steps* on hard ground, where a bounce lasts much less than a step, cost about as many
///   iterations as shorter steps. The unknowns of the contacts are then their forces, as between
///   rigid bodies. This holds for a stiffness of all touching contacts from 64 to 1e10 times the
///   mass over the square of the step size. Above that, and for bodies with a rim or with more
///   contacts than are stored, many steps take the first fallback. In it the springs harden in
///   stages, which costs some tens of iterations. Elastic bounces conserve their energy in it. In
///   `f32`, rounding of the depths of hard contacts takes energy. Above `ω dt = 300`, a rare step
///   of a smooth body other than a ball is not solved accurately. Up to a quarter of its energy of
///   motion is then lost, also that of a slide without friction.
/// - *Stick* costs about the same at any slip speed of the friction law down to 1e-12 m/s. In `f64`
///   the average is two to five iterations a step, also where several contacts or a round rim
///   stick. Bodies that spin flat on several points, rims that roll with small slip at two points
///   close together, and bodies on a ground that rotates can take up to nine. In `f32` the same
///   holds down to 1e-7 m/s, for a body that hardly moves ([limits](#single-precision)). A rare
///   step finds no stick and is divided. A body on a slope α then moves by up to `g sin α dt²/2`.
/// - *Dampers and friction of any size* stop a body that falls on them. A body that starts in the
///   ground on dampers with `dt c/m` above 1e4 may move as if they were weaker: sink at up to
///   `g dt`, or leave a compressed spring at a part of a free spring's speed. A resistance `c` with
///   `dt c/m` above `1/(64 EPSILON)`, 7e13 in `f64` and 1.3e5 in `f32`, may act as one of that
///   size, so that the body sinks or creeps at up to `64 EPSILON g dt`.
/// - *Cost of the worst step* is bounded: at most 31 attempts of at most 6 × 60 evaluations each.
///   At most 4 downhill searches of at most 3 × 31 × 4 evaluations come in addition. Each end costs
///   one evaluation of the energy, and one more for each doubling of the excess energy. In contact,
///   both velocities are scaled down if the solver's error would increase the energy. In flight,
///   the last places of the orientation, the height or the speed are corrected.
/// - *Diagnostics* of a step that is too long: [`Step`] contains the number of iterations, whether
///   the step needed a fallback (`fallback`), and the energy that the solver's error would have
///   added (`energy_removed`).
/// - *Contacts:* up to 128 are stored from iteration to iteration. If there are more, one of each
///   few is stored. The others are computed anew at each iteration, and continue from the friction
///   of the stored one beside them. So the cost of a step is proportional to the number of
///   contacts, with some more iterations where neighbours slip differently. Nothing is allocated.
/// - *Round rims:* the rims that touch share the storage that the contacts leave. A rim has up to
///   eight points between discontinuities, and fewer if more than twelve such pieces touch.
///
/// # Single precision
///
/// What holds in `f64` holds in `f32`, with these limits:
///
/// - *Far from the origin*, a body beyond `1/EPSILON` of its sizes can stay where it is, also in
///   `f64`.
/// - *Flight* in tilted gravity: rounding changes the velocity across gravity at random, most in
///   weak gravity. In 10 s at steps of 1 ms it is by at most 5e-5 of the speed a second, from 1e-3
///   m/s² on.
/// - *Slow motion in contact*, as of a body that rocks or that rolls up a slope: rounding takes up
///   to `ε (m g r + m v²/2)` a step, with the distance r of the body's farthest point from the
///   origin, where the step resolves the contact. An oscillation ends after as many steps as its
///   energy has such units. So take no shorter steps than the motion needs, and an origin near the
///   ground. An oscillation with less than 128 units, at `0.1 √(g/size)`, ends at once; a faster
///   one has a smaller bound. A [`PointMass`](crate::PointMass), a body on ground that moves and a
///   body under a drive
///   can stop at a turning point for good, at steps below `√(128 ε E/m)/a` with the energy E and
///   the acceleration a there.
/// - *Resistance to rolling and spinning* is linear where the angular speed and the turn speed
///   together are below 5e-4 of the body's angular speed, or below 8e-6 of the one that the weight
///   gives it in a step (`f64`: 1e-12 and 1.4e-14).
/// - *Friction* is linear in the slip if two conditions hold. First, `dt c/m` would be above 128,
///   with the friction force over the slip `c`. Second, the slip and the slip speed of the law
///   together are below 1.2e-4 of the speed of the body's fastest points, in world axes.
/// - *Oblique impacts* at 1 to 4 m/s: up to 1 of 200 is wrong by more than a hundredth of the
///   momentum.
/// - *Impacts steeper than 53°* on hard ground, at a slip speed of 1e-6 m/s: 1 of 17 ends with a
///   momentum that differs by more than a hundredth. It is that of a slip speed of about 1e-4 of
///   the speed.
/// - *A ball that rolls to rest* at a penetration depth `m g/k` below 3e-6 radii can roll up to 2.4
///   times as far.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EnergyMomentum<R = f64> {
    /// Step size, s, positive.
    pub time_step: R,
}

impl<R: Real> Integrator<R> for EnergyMomentum<R> {
    type Workspace = Workspace<R>;

    #[inline]
    fn step<D: Dynamics<R>>(
        &self,
        scene: &D,
        state: &mut State<R>,
        limit: R,
        workspace: &mut Workspace<R>,
    ) -> Result<Step<R>, StepError> {
        let dt = step_length(self.time_step, limit);
        step(scene, state, dt, workspace.parts())
    }

    fn order(&self) -> u32 {
        2
    }

    fn fixed_step(&self) -> Option<R> {
        Some(self.time_step)
    }

    #[inline]
    fn clear(&self, workspace: &mut Workspace<R>) {
        workspace.clear();
    }

    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("time step", self.time_step, " s")
    }
}

/// [`EnergyMomentum`] with memory for a chosen number of contacts: for microcontrollers, and for
/// thousands of sessions.
///
/// Its workspace stores `CONTACTS` contacts from iteration to iteration, and that of
/// `EnergyMomentum` stores 128. In `f32`, 12 contacts need 2.4 kB and 128 need 21.5 kB; in `f64`
/// they need 4.7 and 42.7 kB (with addresses of 64 bits). As long as at most `CONTACTS` contacts
/// may touch in a step, the steps have the same bits as those of `EnergyMomentum`. If there are
/// more, the method computes the others anew at each iteration, as `EnergyMomentum` does beyond
/// 128. All that is said of `EnergyMomentum` then holds, but the bits differ, a step takes more
/// time, and a step in the air near the ground rotates the body as a step in contact does.
///
/// The number must be above 0, which is checked when the program is compiled. A body with round
/// rims needs at least 96, which is checked when the scene is composed. The points of a rim depend
/// on the storage, so that the bits of such a body may differ from those of `EnergyMomentum`.
///
/// ```
/// use tumble::{CompactEnergyMomentum, Cuboid, FlatGround, State, Stepper, UniformGravity};
/// use tumble::glam::Vec3;
///
/// let stepper = Stepper::builder(Cuboid::solid(0.01_f32, Vec3::splat(0.02))) // kg, m
///     .gravity(UniformGravity::down(9.8)) // m/s²
///     .ground(FlatGround::level(1000.0, 0.5)) // N/m and N s/m, for each corner
///     .integrator(CompactEnergyMomentum::<8, f32> { time_step: 1e-3 }) // s
///     .build()?;
/// let mut state = State::at(Vec3::Z); // m
/// stepper.advance(&mut state, 0.5)?; // s
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CompactEnergyMomentum<const CONTACTS: usize, R = f64> {
    /// Step size, s, positive.
    pub time_step: R,
}

/// Prints the number of stored contacts too, because it may change the bits of a result.
impl<R: fmt::Debug, const CONTACTS: usize> fmt::Debug for CompactEnergyMomentum<CONTACTS, R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("CompactEnergyMomentum")
            .field("contacts", &CONTACTS)
            .field("time_step", &self.time_step)
            .finish()
    }
}

impl<R: Real, const CONTACTS: usize> Integrator<R> for CompactEnergyMomentum<CONTACTS, R> {
    type Workspace = Workspace<R, CONTACTS>;

    #[inline]
    fn step<D: Dynamics<R>>(
        &self,
        scene: &D,
        state: &mut State<R>,
        limit: R,
        workspace: &mut Workspace<R, CONTACTS>,
    ) -> Result<Step<R>, StepError> {
        let dt = step_length(self.time_step, limit);
        step(scene, state, dt, workspace.parts())
    }

    fn order(&self) -> u32 {
        2
    }

    fn fixed_step(&self) -> Option<R> {
        Some(self.time_step)
    }

    #[inline]
    fn clear(&self, workspace: &mut Workspace<R, CONTACTS>) {
        workspace.clear();
    }

    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("time step", self.time_step, " s")
    }

    fn check_body(&self, body: &impl RigidPointBody<R>) -> Result<(), SceneError> {
        if CONTACTS >= FOR_RIMS as usize || body.rims().is_empty() {
            return Ok(());
        }
        let quantity = "number of contacts that the method stores, for a body with round rims,";
        let rule = Rule::AtLeast(FOR_RIMS);
        Err(SceneError::new(quantity, rule, CONTACTS as f64, ""))
    }
}

/// Takes a step of a length (s).
#[inline(always)]
fn step<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &mut State<R>,
    dt: R,
    (contacts, memory): (&mut Contacts<R>, &mut Memory<R>),
) -> Result<Step<R>, StepError> {
    if dt <= R::ZERO {
        return Ok(Step::new(R::ZERO, 0));
    }
    if let Some(drive_work) = memory.work_at_rest(state, dt) {
        return Ok(Step {
            drive_work,
            ..Step::new(dt, 0)
        });
    }
    // An orientation that no scaling makes a rotation: every attempt would fail, and the body
    // would stay at its pose.
    let is_a_turn =
        Rotation::<R>::unscaled(state.orientation).is_a_turn() || state.rotation().is_a_turn();
    if !is_a_turn {
        return Err(state.error_of(Quantity::Orientation));
    }
    move_on(scene, state, dt, (contacts, memory))
}

/// Finest division of a step that cannot be taken as a whole.
const PARTS: u32 = 16;
/// Number of sixteenths of a step without a solution after which no further solutions are tried.
const MOST_LOST: u32 = 2;

/// A longer step in contact may converge to a result of rounding, s. In this time a body falls by
/// 5e12 m on earth.
const LONG: f64 = 1e6;

/// Returns an error if the energy is not usable: a step compares sums of several such energies.
#[inline]
fn check_energy<R: Real>(energy: &Energy<R>) -> Result<(), StepError> {
    let sizes = energy.kinetic() + energy.gravity.abs() + energy.springs.abs();
    if (sizes * R::from_f64(16.0)).is_finite() {
        Ok(())
    } else {
        Err(StepError::BadEnergy {
            joules: sizes.to_f64(),
        })
    }
}

fn move_on<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &mut State<R>,
    dt: R,
    (contacts, memory): (&mut Contacts<R>, &mut Memory<R>),
) -> Result<Step<R>, StepError> {
    let start = *state;
    let before = memory
        .energy(&start)
        .unwrap_or_else(|| Energy::of(scene, &start));
    check_energy(&before)?;
    let mut energy = before;
    let mut step = Step::new(dt, 0);
    applied::pushed(scene, state, &mut energy, dt * R::HALF, &mut step)?;
    move_in_parts(scene, state, &mut energy, (dt, &start), contacts, &mut step)?;
    let is_suspect = step.fallback || (step.iterations > 0 && dt > R::from_f64(LONG));
    if is_suspect && descent::is_unresolved(scene, &start, dt) {
        return Err(too_long(dt));
    }
    applied::pushed(scene, state, &mut energy, dt * R::HALF, &mut step)?;
    if energy.springs > R::ZERO
        && energy_limit::has_come_to_rest(scene, [&start, state], [&before, &energy], dt)
    {
        (*state, energy) = energy_limit::stopped((&start, &before));
    }
    if *state == start {
        fall(scene, state, &mut energy, dt, &mut step);
    }
    applied::close_account(scene, [before.total(), energy.total()], &mut step);
    memory.note([&start, state], &energy, &step);
    Ok(step)
}

/// Part of a step, or the whole.
struct Part<'a, R: Real> {
    /// Length, s.
    seconds: R,
    /// State before the applied force acted, for the first part.
    unpushed: Option<&'a State<R>>,
    /// Time for which the applied force acts after it, s.
    force_seconds: R,
}

/// Takes a step as a whole, or in parts where that fails: in halves, down to sixteenths, and the
/// smallest parts downhill in energy. `unpushed` is the state before the applied force acted.
#[inline(always)]
fn move_in_parts<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &mut State<R>,
    energy: &mut Energy<R>,
    (dt, unpushed): (R, &State<R>),
    contacts: &mut Contacts<R>,
    step: &mut Step<R>,
) -> Result<(), StepError> {
    // In sixteenths of the step: the part that is done, and the length that is tried.
    let (mut done, mut length) = (0, PARTS);
    let mut lost = 0;
    while done < PARTS {
        let part = Part {
            seconds: sixteenths(dt, length),
            unpushed: (done == 0).then_some(unpushed),
            force_seconds: if done + length == PARTS {
                dt * R::HALF
            } else {
                R::ZERO
            },
        };
        if attempt(scene, state, energy, &part, contacts, step) {
            done += length;
            length = longest_part(done);
        } else if length > 1 {
            length /= 2;
            step.fallback = true;
        } else {
            lost += 1;
            // After repeated failures, the rest of the step goes downhill at once.
            if lost > MOST_LOST {
                length = PARTS - done;
            }
            let seconds = sixteenths(dt, length);
            if !goes_downhill(scene, (state, energy), seconds, step) {
                return Err(too_long(dt));
            }
            done += length;
        }
    }
    Ok(())
}

/// Takes a part of a step downhill in energy. Returns false if it leaves the body in the air, since
/// the step is too long for it.
#[inline(always)]
fn goes_downhill<R: Real, D: Dynamics<R>>(
    scene: &D,
    (state, energy): (&mut State<R>, &mut Energy<R>),
    seconds: R,
    step: &mut Step<R>,
) -> bool {
    let (from, ceiling) = (*state, energy.total());
    take_lower(scene, (state, energy), ceiling, seconds, step);
    let is_stuck = descent::is_left_in_the_air(scene, [&from, state], seconds);
    !(is_stuck && descent::is_unresolved(scene, &from, seconds))
}

/// Moves a body downhill in energy, if that leads to an energy of at most `ceiling` (J).
#[inline(always)]
fn take_lower<R: Real, D: Dynamics<R>>(
    scene: &D,
    (state, energy): (&mut State<R>, &mut Energy<R>),
    ceiling: R,
    seconds: R,
    step: &mut Step<R>,
) {
    if let Some(lower) = descent::step(scene, (state, energy), ceiling, seconds, step) {
        (*state, *energy) = lower;
    }
}

#[cold]
fn too_long<R: Real>(dt: R) -> StepError {
    StepError::StepTooLong {
        seconds: dt.to_f64(),
    }
}

fn sixteenths<R: Real>(dt: R, count: u32) -> R {
    dt * (R::from_usize(count as usize) / R::from_usize(PARTS as usize))
}

/// Moves a body downhill that a step has left unchanged. Such a body may still rest on a spring
/// whose oscillation is much too fast for the step. If another motion lowers the energy, the body
/// takes it. A decrease within rounding is ignored, because the body would otherwise never sleep.
fn fall<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &mut State<R>,
    energy: &mut Energy<R>,
    seconds: R,
    step: &mut Step<R>,
) {
    let ceiling = energy.total() - energy_limit::rounding_of(energy, energy) * R::HALF;
    take_lower(scene, (state, energy), ceiling, seconds, step);
}

/// Longest part of a step that begins at `done` sixteenths: the largest power of 2 that divides
/// `done`.
fn longest_part(done: u32) -> u32 {
    if done == 0 {
        PARTS
    } else {
        1 << done.trailing_zeros()
    }
}

/// Attempts one step: as a whole by Newton's method, else split. Returns true if one of them ends
/// with an energy that is not higher. Otherwise state and energy are unchanged.
fn attempt<R: Real, D: Dynamics<R>>(
    scene: &D,
    state: &mut State<R>,
    energy: &mut Energy<R>,
    part: &Part<'_, R>,
    contacts: &mut Contacts<R>,
    step: &mut Step<R>,
) -> bool {
    let mut problem = Problem::new(scene, state, energy, part.seconds);
    (problem.unpushed, problem.force_seconds) = (part.unpushed, part.force_seconds);
    gather_near(&problem, contacts);
    let mut are_all = false;
    // Without a contact at both ends every mean force is 0, so the step is a flight.
    let mut flies = contacts.begin_above_ground(&problem);
    loop {
        let end = if flies {
            End::without_work(fly(&problem))
        } else {
            problem.prepare();
            let Some(end) = whole(&problem, energy, contacts, step) else {
                break;
            };
            end
        };
        let (after, touching) = Energy::with_touching(scene, &end.state);
        let lands = flies && touching > 0;
        flies = false;
        if lands && !contacts.is_empty() {
            continue;
        }
        // A contact that was not collected touches at the end: collect all contacts.
        if !(are_all || contacts.includes_those_at(&problem, (&end.state, touching))) {
            gather_all(&problem, contacts);
            are_all = true;
            continue;
        }
        let known = (&mut *state, &mut *energy);
        if limited(scene, known, &end, (&after, touching), step) {
            return true;
        }
        break;
    }
    step.fallback = true;
    attempt_split(scene, (state, energy), part.seconds, contacts, step)
}

/// Attempts one step split into dissipation and conservative motion. Returns true if it ends with
/// an energy that is not higher.
fn attempt_split<R: Real, D: Dynamics<R>>(
    scene: &D,
    (state, energy): (&mut State<R>, &mut Energy<R>),
    seconds: R,
    contacts: &mut Contacts<R>,
    step: &mut Step<R>,
) -> bool {
    let split = split::step(scene, (&*state, &*energy), seconds, contacts, step);
    let Some(end) = split else {
        return false;
    };
    let (after, touching) = Energy::with_touching(scene, &end.state);
    limited(scene, (state, energy), &end, (&after, touching), step)
}

/// Advances a state and its energy to an end, whose energy and number of touching contacts are
/// given, as far as [the energy limiter](energy_limit::hold) allows. Returns false if it does not.
#[inline(always)]
fn limited<R: Real, D: Dynamics<R>>(
    scene: &D,
    known: (&mut State<R>, &mut Energy<R>),
    end: &End<R>,
    (after, touching): (&Energy<R>, usize),
    step: &mut Step<R>,
) -> bool {
    let contact = Touched {
        touching,
        is_lossless: end.is_lossless,
        work: end.work,
    };
    energy_limit::hold(scene, known, (&end.state, after), contact, step)
}

/// Free flight without an iteration, exact to rounding. It is not inlined, because its preparation
/// would then be computed for steps in contact too.
#[inline(never)]
fn fly<R: Real, D: Dynamics<R>>(problem: &Problem<'_, R, D>) -> State<R> {
    let (start, seconds) = (&problem.start, problem.seconds);
    let gravity = problem.scene.gravity();
    let mean_velocity = start.linear_velocity + gravity * (seconds * R::HALF);
    let (axes, momentum) = (&problem.motion.axes, start.angular_momentum);
    let rotation = turned_freely(problem.scene, problem.rotation, axes, momentum, seconds);
    let plain = ballistic(problem.scene, start, rotation, seconds);
    if !flight_rounding::holds_both_ways::<R>() {
        return plain;
    }
    let mut seed = flight_rounding::seed_of(start);
    let drawn = State {
        position: flight_rounding::advanced::<R>(
            start.position,
            mean_velocity * seconds,
            &mut seed,
        ),
        linear_velocity: flight_rounding::advanced::<R>(
            start.linear_velocity,
            gravity * seconds,
            &mut seed,
        ),
        ..plain
    };
    // Another force than gravity changes the velocity between two flights, and so the constant of
    // the path.
    if problem.scene.force().acts() {
        drawn
    } else {
        flight_rounding::on_parabola(start, drawn, gravity)
    }
}

/// Solves the whole step by Newton's method, and then applies the end-velocity correction of
/// friction and dampers.
///
/// Returns `None` if the end could not be computed.
fn whole<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    energy: &Energy<R>,
    contacts: &mut Contacts<R>,
    step: &mut Step<R>,
) -> Option<End<R>> {
    let mut trial = problem.first_trial(energy);
    let strain = newton::solve(problem, contacts, &mut trial, step)?;
    let mut end = problem.end_of(&trial);
    let strain = strain.of_step(problem).with_arms(problem, contacts, &end);
    if strain.hides_inertia() {
        return None;
    }
    let ahead = if strain.is_resolved() && !problem.resists_turning() {
        Ahead::NONE
    } else {
        Ahead::of(problem, &trial, &end)
    };
    let turning = Rolling::at(problem, contacts, &trial).and_then(|rolling| {
        rolling.correction(problem, ahead.seen(problem.scene, &end).angular_velocity)
    });
    let mut work = work::of_whole(problem, [&end; 2]);
    if !strain.is_resolved() || turning.is_some() {
        // The correction would take the energy that shows a false solution.
        if is_no_solution(problem, energy, &end) {
            return None;
        }
        let before = end;
        let resistances = (strain, turning);
        end = end_velocity::corrected(problem, contacts, (&trial, &ahead), resistances, &before);
        work = work::of_whole(problem, [&before, &end]);
    }
    let is_finite = end.not_finite().is_none();
    let is_lossless = strain.is_none() && !problem.resists_turning();
    is_finite.then_some(End {
        state: end,
        is_lossless,
        work,
    })
}

/// Returns true if the end of a trial has gained too much energy for a solution of the step. It is
/// not inlined, as a step that resolves the contact does not need it.
#[inline(never)]
fn is_no_solution<R: Real, D: Dynamics<R>>(
    problem: &Problem<'_, R, D>,
    before: &Energy<R>,
    end: &State<R>,
) -> bool {
    let after = Energy::without_springs(problem.scene, end);
    let work = work::of_whole(problem, [end; 2]);
    energy_limit::is_no_solution([before, &after], work)
}
