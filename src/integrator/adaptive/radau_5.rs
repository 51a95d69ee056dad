//! Radau's implicit method of order 5, for stiff friction and stiff ground at high accuracy.
//!
//! The stages of a step: the Jacobian (`jacobian`, `curvature`), the increments of the three stages
//! (`stages`, `reduced`, `linear`), and the error estimate. Touch-downs and step size control are
//! those of the explicit pairs (`embedded_pair`).
//!
//! # Estimate
//!
//! The difference `e` from a formula of order 3, with its stiff parts damped, is proportional to
//! `h⁴` in smooth motion (Hairer & Wanner, Solving Ordinary Differential Equations II, section
//! IV.8). The error of the result is proportional to `h⁶`. With `e` alone, a tight tolerance would
//! take far more steps than it needs. With a fixed power of it, the error would be
//! too large where the motion is not smooth: a jump of the force gives both formulas errors of the
//! same size. So the estimate is
//!
//! ```text
//! e · min(1, |δ₃|/|δ₁|)
//! ```
//! `δ₁` and `δ₃` are the first and the third difference of the slopes at the start and at the three
//! stages. In motion with a time scale τ their ratio is about `(h/τ)²/6`, which is the missing
//! factor `h²`. If a force jumps within the step, `|δ₃|` is 3.3 to 10 times the jump, wherever it
//! is, so the ratio is never small by chance.

mod curvature;
mod jacobian;
mod linear;
mod reduced;
mod stages;

use super::embedded_pair::control::{self, Errors};
use super::embedded_pair::{Attempt, Formula, LeftOut, Pair, Place, Planned, Settings};
use super::method::adaptive_method;
use crate::contact::Motion;
use crate::force::Force;
use crate::integrator::free_error;
use crate::integrator::interface::Step;
use crate::integrator::point::Point;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, turned_freely};
use jacobian::Jacobian;
use stages::{Equations, Increments, NODES, STAGES, Solution, WEIGHTS, differences};

/// Radau's implicit method of order 5 with a tolerance: for bodies that stick or roll at a small
/// slip speed, and for stiff ground.
///
/// Where friction sticks, stability limits the step of an explicit method to a few
/// `slip_speed/(a μ g)`. Here μ is the coefficient of friction, g is gravity, and `a = 1 + m r²/I`
/// is 3 for a ring and 3.5 for a solid ball. This method has no such limit (Radau IIA with three
/// stages, L-stable). A ball that is set down sliding and then rolls, at a slip speed of 1e-6 m/s,
/// takes less than 200 steps in a second for a tolerance of 1e-9 m, where
/// [`DormandPrince54`](crate::DormandPrince54) exceeds its default budget of a million.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Coulomb, FlatGround, Radau5, Sphere, State, Stepper, UniformGravity};
///
/// // A ball is set down sliding at 1 m/s. It slides, then rolls at 5/7 of that speed.
/// let stepper = Stepper::builder(Sphere::solid(0.5, 0.1)) // kg, m
///     .gravity(UniformGravity::down(9.8)) // m/s²
///     .ground(FlatGround::level(1e5, 50.0)) // N/m and N s/m
///     .friction(Coulomb { coefficient: 0.3, slip_speed: 1e-6 }) // -, m/s
///     .integrator(Radau5::new(1e-9)) // m
///     .build()?;
/// let depth = 0.5 * 9.8 / 1e5;
/// let start = State::at(DVec3::Z * (0.1 - depth)).with_linear_velocity(DVec3::X); // m, m/s
/// let mut session = stepper.session(start);
/// session.advance(1.0)?;
/// assert!((session.state().linear_velocity.x - 5.0 / 7.0).abs() < 1e-9);
/// assert!(session.step_count() < 200);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// - *Order* 5.
/// - *Error of a run:* at most 10 tolerances after a second in the eight trials of the coin report,
///   for tolerances from 1e-4 to 1e-8 m and a slip speed of 1e-3 m/s. In trials 1, 3, 5 and 8 the
///   same holds at 1e-6 m/s. It is mostly 0.1 to 2 tolerances (`tests/physics/radau.rs` prints it).
///   After longer times it depends on how the motion amplifies it.
/// - *Cost:* 5 to 30 force evaluations per attempted step in contact and 1 in free flight, with the
///   Jacobian and linear equations of six real and six complex unknowns. Where neither friction nor
///   the ground is stiff, an explicit pair costs less.
/// - *Fast spin in air:* under an applied force, each step has an error of its rotation. These add
///   up, so that the error of a run is many tolerances if the body rotates many times. Use a
///   hundredth of the error as the tolerance there, or
///   [`AdaptiveNystrom`](crate::AdaptiveNystrom).
/// - *Jacobian:* from the derivatives of the laws, and from differences of the normal where the
///   ground is curved. An applied force, and a law without derivatives of its own, are
///   differentiated by differences. So strong drag or a stiff mount does not limit the step either.
/// - *Small slip speed:* a ball on a plane takes as many steps at 1e-7 m/s as at 1e-3 m/s. On
///   curved ground it takes a few times as many (`tests/physics/radau.rs` prints them). A smooth
///   body whose contact moves over its surface takes several times as many, also on a plane.
/// - *Touch-downs* end a step, as in `DormandPrince54`. In `f32`, a touch-down on a strong damper
///   may end the run with [`StepTooShort`](crate::StepError::StepTooShort), where the rounding of
///   the depth changes the speed of the body by more than the tolerance over 1 s. This is most
///   frequent with round rims.
/// - *May add energy* by the size of its error.
/// - *Torque-free rotation* is exact to rounding
///   ([`turn_freely`](crate::InertiaProperties::turn_freely)). Its error is no part of the estimate
///   where no contact can come into reach.
/// - *Limit:* the slip speed must be above the rounding of the velocities. At 1 m/s, 1e-12 m/s is
///   tested in double precision, and 1e-6 m/s in single precision. Far below that, a body that
///   comes to rest takes tiny steps. Use [`EnergyMomentum`](crate::EnergyMomentum) there.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Radau5<R = f64> {
    /// Parameter of the accuracy, m, above 0. The error after a second is mostly of this size or
    /// less, and at most ten times as large in the scenes of the tests.
    pub tolerance: R,
    /// Largest step size, s, above 0.
    pub longest_step: R,
    /// Largest number of attempted steps in a run, rejected ones included, at least 1.
    pub budget: u32,
}

/// The three stages of Radau IIA.
#[derive(Clone, Copy)]
struct RadauIIA;

const PAIR: RadauIIA = RadauIIA;

/// What step size control and the search for touch-downs use of the method.
const IN_COMMON: Pair<STAGES> = Pair {
    stages: [[0.0; STAGES], WEIGHTS, [0.0; STAGES]],
    error: [0.0; STAGES],
    trust: 1.0,
    roots: 2,
    follows_slip: false,
};

/// Largest change of the last iteration, as a fraction of the tolerance, and of the slip over which
/// friction changes in a second.
const SOLVED: f64 = 0.01;

impl<R: Real> Formula<R, STAGES> for RadauIIA {
    fn pair(&self) -> &Pair<STAGES> {
        &IN_COMMON
    }

    fn attempt<D: Dynamics<R>>(
        &self,
        settings: &Settings<R>,
        planned: &Planned<'_, R, D>,
        report: &mut Step<R>,
    ) -> Option<Attempt<R, STAGES>> {
        let Planned {
            scene,
            start,
            seconds,
            ..
        } = *planned;
        if !has_equations(seconds) {
            return Some(straight(planned));
        }
        if let Some(attempt) = free(planned) {
            report.evaluations += 1;
            return Some(attempt);
        }
        let jacobian = Jacobian::at(scene, &start.motion, start.point.angular_momentum);
        let equations = Equations::of(&jacobian, start.point.orientation, seconds);
        let evaluations = core::cell::Cell::new(1);
        let slope_at = |increment: &Point<R>| {
            evaluations.set(evaluations.get() + 1);
            let point = start.point.plus(increment, R::ONE);
            Place::under(scene, point, |motion| planned.load(motion)).slope
        };
        let size_of = |point: &Point<R>| size_of(planned, point);
        let targets = targets(settings, scene, &start.motion, jacobian.width);
        let solved = equations.increments(&start.slope, targets, slope_at, size_of);
        let attempt = solved.map(|solution| {
            report.iterations += solution.iterations;
            solved_step(settings, planned, &equations, &solution, slope_at)
        });
        report.evaluations += evaluations.get() + 1;
        attempt
    }
}

/// Returns the step that solves its equations, with the estimate of its error.
fn solved_step<R: Real, D: Dynamics<R>>(
    settings: &Settings<R>,
    planned: &Planned<'_, R, D>,
    equations: &Equations<'_, R>,
    solution: &Solution<R>,
    slope_at: impl Fn(&Point<R>) -> Point<R>,
) -> Attempt<R, STAGES> {
    let Planned {
        scene,
        start,
        seconds,
        ..
    } = *planned;
    let increments = &solution.increments;
    let end = end_of(planned, increments);
    let [first_slope, second_slope, _] = solution.slopes;
    let slopes = [first_slope, second_slope, end.slope];
    let [third, first] = differences(&start.slope, &slopes).map(|point| size_of(planned, &point));
    let share = (third / first).at_most(R::ONE);
    let mut error = equations.error(increments, &start.slope, seconds);
    let allowed = control::allowed(settings, scene, &start.motion);
    if size_of(planned, &error) * share > allowed {
        // A stiff part of the estimate, damped once more.
        error = equations.error(increments, &slope_at(&error), seconds);
    }
    Attempt {
        end,
        motions: increments.map(|z| start.point.plus(&z, R::ONE).motion(scene)),
        difference: error.scaled(share),
        left_out: left_out(&start.point, &end.point),
    }
}

/// Size of a change of the state in a step, m.
fn size_of<R: Real, D: Dynamics<R>>(planned: &Planned<'_, R, D>, change: &Point<R>) -> R {
    Errors::of(planned.scene, change, &planned.start.motion).total()
}

/// Returns a step of flight, which is exact: a parabola and the torque-free rotation. Returns
/// `None` if a force acts besides gravity, or if a contact may come into reach.
///
/// The equations of the stages could need far shorter steps there. In a slender body a rounding of
/// the angular momentum is a large angular velocity.
#[inline(never)]
fn free<R: Real, D: Dynamics<R>>(planned: &Planned<'_, R, D>) -> Option<Attempt<R, STAGES>> {
    let Planned {
        scene,
        start,
        seconds,
        ..
    } = *planned;
    let acceleration = start.slope.linear_velocity;
    let is_free = acceleration == scene.gravity()
        && start.slope.angular_momentum == R::Vec3::ZERO
        && !scene.force().acts();
    if !is_free {
        return None;
    }
    let Point {
        position,
        linear_velocity,
        orientation,
        angular_momentum,
    } = start.point;
    let at = |seconds: R| Point {
        position: position + (linear_velocity + acceleration * (seconds * R::HALF)) * seconds,
        linear_velocity: linear_velocity + acceleration * seconds,
        orientation: turned_freely(
            scene,
            orientation,
            &start.motion.axes,
            angular_momentum,
            seconds,
        ),
        angular_momentum,
    };
    let end = at(seconds);
    let is_out_of_reach = free_error::is_out_of_reach(
        scene,
        [&start.motion, &end.motion(scene)],
        (angular_momentum, acceleration.length()),
        seconds,
    );
    is_out_of_reach.then(|| Attempt {
        end: Place::under(scene, end, |motion| planned.load(motion)),
        motions: NODES.map(|node| at(seconds * R::from_f64(node)).motion(scene)),
        difference: start.slope.scaled(R::ZERO),
        left_out: LeftOut::Whole,
    })
}

/// Returns false for a step so short that the coefficients of its equations, which have the inverse
/// of its size, would overflow.
fn has_equations<R: Real>(seconds: R) -> bool {
    seconds * (R::MAX * R::from_f64(1.0 / 16.0)) > R::ONE
}

/// Step along the slope at its start. Its error, in proportion to the square of the step size,
/// underflows in a step without equations.
#[cold]
#[inline(never)]
fn straight<R: Real, D: Dynamics<R>>(planned: &Planned<'_, R, D>) -> Attempt<R, STAGES> {
    let Planned {
        scene,
        start,
        seconds,
        ..
    } = *planned;
    let increments = NODES.map(|node| start.slope.scaled(seconds * R::from_f64(node)));
    let end = end_of(planned, &increments);
    Attempt {
        end,
        motions: increments.map(|z| start.point.plus(&z, R::ONE).motion(scene)),
        difference: start.slope.scaled(R::ZERO),
        left_out: left_out(&start.point, &end.point),
    }
}

/// Largest change that the iteration may leave, m, and the rounding of a change.
fn targets<R: Real, D: Dynamics<R>>(
    settings: &Settings<R>,
    scene: &D,
    motion: &Motion<R>,
    width: R,
) -> [R; 2] {
    let rounding = control::rounding(scene, motion, control::HORIZON);
    let target = settings.tolerance.at_most(width) * R::from_f64(SOLVED);
    [target + rounding, rounding]
}

/// Returns the part of the estimate that the end of the step leaves out: its rotation is exact
/// without torques.
fn left_out<R: Real>(start: &Point<R>, end: &Point<R>) -> LeftOut<R> {
    if end.angular_momentum == start.angular_momentum {
        LeftOut::Whole
    } else {
        LeftOut::Nothing
    }
}

/// End of the step. A rotation without torques is exact.
fn end_of<R: Real, D: Dynamics<R>>(
    planned: &Planned<'_, R, D>,
    [.., last]: &Increments<R>,
) -> Place<R> {
    let Planned {
        scene,
        start,
        seconds,
        ..
    } = *planned;
    let mut end = start.point.plus(last, R::ONE).normalised();
    if end.angular_momentum == start.point.angular_momentum {
        let axes = &start.motion.axes;
        let Point {
            orientation,
            angular_momentum,
            ..
        } = start.point;
        end.orientation = turned_freely(scene, orientation, axes, angular_momentum, seconds);
    }
    Place::under(scene, end, |motion| planned.load(motion))
}

adaptive_method!(Radau5, order 5);
