//! Exact motion beside that of the integrator, and its works.
//!
//! A quadrature along the method's own stages would have the same error as the method. At a jump of
//! the force both miss the same impulse, and the energy error cancels out of the balance. So the
//! motion is integrated once more.
//!
//! This motion goes on from step to step and does not start again from each state of the
//! integrator. Let a method end each step with a slip velocity that is wrong by `s`. Friction
//! removes such an error at a rate `λ`. An exact motion that starts from each of these states
//! dissipates in every step the part `λ h` of the energy `m v s` that the error has. The sum over a
//! time `t` is `λ t m v s`, although the energy is wrong by `m v s` only. With a slip speed of
//! 1 mm/s, `λ` is some thousand per second.
//!
//! The substeps are those of the method of Dormand and Prince, with the works as further unknowns,
//! `W' = P(state)`:
//!
//! 1. `attempt` takes a substep and bounds the error of its works.
//! 2. `march` joins substeps, with shorter ones where forces or their derivatives are
//!    discontinuous. `fly` joins those of a fast rotation without contact.
//! 3. `follow` repeats this until the error is small compared with the energy error of the step.

use crate::energy::{Dissipation, EnergyRates};
use crate::integrator::{DORMAND_PRINCE, Point};
use crate::observer::SceneQuery;
use crate::real::Real;
use crate::state::State;

/// Either end of a step or substep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node<R: Real> {
    pub(super) state: State<R>,
    pub(super) account: EnergyRates<R>,
}

impl<R: Real> Node<R> {
    pub(super) fn at(scene: &dyn SceneQuery<R>, state: &State<R>) -> Self {
        Self {
            state: *state,
            account: scene.account(state),
        }
    }

    /// Total energy, J.
    pub(super) fn energy(&self) -> R {
        self.account.energy.total()
    }

    /// Rates of the state.
    fn slope(&self) -> Point<R> {
        let rates = &self.account.rates;
        Point {
            position: self.state.linear_velocity,
            linear_velocity: rates.acceleration,
            orientation: self.state.rotation().rate(rates.angular_velocity),
            angular_momentum: rates.torque,
        }
    }
}

/// Works of a step or substep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Works<R: Real> {
    pub(super) work: Dissipation<R>,
    /// Bound of their error, J.
    pub(super) error: R,
}

/// Fraction of the energy error of a step that the error of its works may reach, or else of the
/// works themselves.
const FRACTION: f64 = 1.0 / 8.0;
/// Fraction of the last energy error that a substep of the next pass may add.
const PER_SUBSTEP: f64 = 1.0 / 64.0;
/// Least fraction of the last error of the works that a pass may have as its tolerance.
const PER_PASS: f64 = 1.0 / 4096.0;
/// Most substeps of a pass, including rejected ones. A jump takes one substep for each bit of its
/// time, up to 50.
const MOST_SUBSTEPS: u32 = 256;
/// Most successive substeps that are short without a jump nearby. Friction that sticks is stiff,
/// and would need too many substeps.
const MOST_STUCK: u32 = 32;
/// Substeps of a free flight that one substep does not follow accurately. They reduce its error by
/// a factor of 3e4.
const FLIGHT_SUBSTEPS: usize = 8;
/// Fraction of the step below which a substep is short.
const SHORT: f64 = 1.0 / 64.0;

/// Follows the exact motion from `start` during a step of the integrator from `before` to `after`.
/// If the substeps cannot follow the motion, returns the best works found as an error.
///
/// Substeps follow the motion if there are not too many, and if the error of the works is a
/// fraction of the works. Sticking friction is so stiff that it may exchange its sign in every
/// substep, each within its tolerance. The works are then an artefact, and their error is as large
/// as they are.
///
/// The energy error that the step adds is the change of the energy minus these works. An error of
/// the works matters only in comparison with it. So the added energy error sets the tolerance, down
/// to the rounding of the energies.
pub(super) fn follow<R: Real>(
    scene: &dyn SceneQuery<R>,
    start: &Node<R>,
    [before, after]: [&Node<R>; 2],
    seconds: R,
) -> Result<Part<R>, Works<R>> {
    let (rounding, change) = (rounding(start), after.energy() - before.energy());
    let whole = attempt(scene, start, seconds);
    if whole.error_in_flight > R::ZERO {
        let is_accurate = whole.is_closer_than(scene, &after.state);
        let refined = (!is_accurate).then(|| fly(scene, start, seconds)).flatten();
        return Ok(refined.unwrap_or(whole));
    }
    let mut found = whole;
    let mut tolerance = R::MAX;
    loop {
        let works = found.works;
        let unaccounted = (change - works.work.total()).abs();
        let suffices = (unaccounted * R::from_f64(FRACTION)).at_least(rounding);
        // The energy error may be small by chance, so the error of the works limits the tolerance
        // of one pass.
        let next = (unaccounted * R::from_f64(PER_SUBSTEP))
            .at_least(works.error * R::from_f64(PER_PASS))
            .at_least(rounding);
        if works.error <= suffices {
            return Ok(found);
        }
        if tolerance <= next * R::TWO {
            let is_known = works.error <= sizes(&works.work) * R::from_f64(FRACTION);
            return if is_known { Ok(found) } else { Err(works) };
        }
        tolerance = next;
        found = march(scene, start, seconds, tolerance).ok_or(works)?;
    }
}

/// Rounding of the energies at both ends of a step, J.
fn rounding<R: Real>(start: &Node<R>) -> R {
    let energy = &start.account.energy;
    let sizes = energy.kinetic() + (energy.gravity.abs() + energy.springs.abs());
    sizes * (R::EPSILON * R::from_f64(16.0))
}

/// Works of a step by substeps whose errors are within a tolerance (J) each. Returns `None` if
/// there would be too many.
fn march<R: Real>(
    scene: &dyn SceneQuery<R>,
    start: &Node<R>,
    seconds: R,
    tolerance: R,
) -> Option<Part<R>> {
    let mut sum = Works {
        work: Dissipation::default(),
        error: R::ZERO,
    };
    let (mut node, mut left, mut length) = (*start, seconds, seconds * R::HALF);
    // Length of the substeps before a jump, s, while the jump is being located.
    let mut usual = None;
    let (short, mut stuck) = (seconds * R::from_f64(SHORT), 0);
    for _ in 0..MOST_SUBSTEPS {
        length = length.at_most(left);
        let substep = attempt(scene, &node, length);
        let accepted = substep.works.error <= tolerance;
        if !accepted {
            if substep.jumps {
                usual = usual.or(Some(length));
            }
            length *= R::HALF;
            continue;
        }
        sum.work = sum.work.plus(&substep.works.work, R::ONE);
        sum.error += substep.works.error;
        if length >= left {
            return Some(Part {
                works: sum,
                ..substep
            });
        }
        (node, left) = (substep.end, left - length);
        if substep.jumps {
            length = usual.take().unwrap_or(length);
        } else if usual.is_none() && substep.works.error * R::from_f64(64.0) <= tolerance {
            // The error grows with the fifth or sixth power of the length.
            length *= R::TWO;
        }
        stuck = if length < short { stuck + 1 } else { 0 };
        if stuck > MOST_STUCK && usual.is_none() {
            return None;
        }
    }
    None
}

/// Part of the exact motion: a substep that has been attempted, or several that were accepted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part<R: Real> {
    pub(super) end: Node<R>,
    pub(super) works: Works<R>,
    /// Whether a contact opens or closes, or begins or ceases to push, in the substep.
    jumps: bool,
    /// Estimate of the error of the end of a free flight, in bounding radii. It is 0 in contact and
    /// under forces that dissipate, because the works show such an error.
    error_in_flight: R,
}

impl<R: Real> Part<R> {
    /// Returns true if the error in flight is small compared with the separation from a state, or
    /// as small as rounding.
    pub(super) fn is_closer_than(&self, scene: &dyn SceneQuery<R>, state: &State<R>) -> bool {
        let separation = scene.separation(&self.end.state, state);
        let rounding = R::EPSILON * R::from_f64(64.0);
        self.error_in_flight * R::from_f64(8.0) <= separation.at_least(rounding)
    }
}

/// Follows a free flight in substeps of equal length. Returns `None` if it is none.
fn fly<R: Real>(scene: &dyn SceneQuery<R>, start: &Node<R>, seconds: R) -> Option<Part<R>> {
    let length = seconds / R::from_usize(FLIGHT_SUBSTEPS);
    let (mut end, mut error_in_flight) = (*start, R::ZERO);
    let mut last = None;
    for _ in 0..FLIGHT_SUBSTEPS {
        let substep = attempt(scene, &end, length);
        if substep.jumps || substep.works.error > R::ZERO {
            return None;
        }
        error_in_flight += substep.error_in_flight;
        end = substep.end;
        last = Some(substep);
    }
    last.map(|last| Part {
        error_in_flight,
        ..last
    })
}

/// Takes one substep.
fn attempt<R: Real>(scene: &dyn SceneQuery<R>, start: &Node<R>, seconds: R) -> Part<R> {
    let point = Point::of(&start.state);
    let mut slopes = [start.slope(); 7];
    let mut powers = [start.account.dissipation; 7];
    let (mut end, mut jumps) = (*start, false);
    for (i, row) in DORMAND_PRINCE.stages.iter().enumerate().take(6) {
        let mut stage = point;
        for (slope, &weight) in slopes.iter().zip(row).take(i + 1) {
            stage = stage.plus(slope, seconds * R::from_f64(weight));
        }
        end = Node::at(scene, &stage.to_state());
        jumps |= end.account.contacts != start.account.contacts;
        if let (Some(slope), Some(power)) = (slopes.get_mut(i + 1), powers.get_mut(i + 1)) {
            (*slope, *power) = (end.slope(), end.account.dissipation);
        }
    }
    let [.., weights, _] = &DORMAND_PRINCE.stages;
    let work = weighted(&powers, weights, seconds);
    let unaccounted = end.energy() - start.energy() - work.total();
    let error = error(&powers, jumps, unaccounted, seconds);
    Part {
        end,
        works: Works { work, error },
        jumps,
        error_in_flight: if is_flight(start, &powers, jumps) {
            error_of_pose(scene, &end.state, &slopes, seconds)
        } else {
            R::ZERO
        },
    }
}

/// Returns true if neither contacts nor a force that dissipates act in a substep.
fn is_flight<R: Real>(start: &Node<R>, powers: &[Dissipation<R>; 7], jumps: bool) -> bool {
    let touches = jumps || start.account.contacts != 0;
    !touches && powers.iter().all(|power| *power == Dissipation::default())
}

/// Estimate of the error of the pose at the end of a substep, in bounding radii.
fn error_of_pose<R: Real>(
    scene: &dyn SceneQuery<R>,
    end: &State<R>,
    slopes: &[Point<R>; 7],
    seconds: R,
) -> R {
    let lower_order = (slopes.iter().zip(&DORMAND_PRINCE.error))
        .fold(Point::of(end), |sum, (slope, &weight)| {
            sum.plus(slope, seconds * R::from_f64(weight))
        });
    scene.separation(end, &lower_order.to_state())
}

/// Bound of the error of the works of a substep, J.
fn error<R: Real>(powers: &[Dissipation<R>; 7], jumps: bool, unaccounted: R, seconds: R) -> R {
    // Without dissipation the works have no error, however wrong the states are.
    if !jumps && powers.iter().all(|power| *power == Dissipation::default()) {
        return R::ZERO;
    }
    let estimate = sizes(&weighted(powers, &DORMAND_PRINCE.error, seconds));
    // The estimate may miss a jump between two stages, but no jump is larger than the spread of the
    // powers.
    let jump = if jumps {
        spread(powers) * seconds
    } else {
        R::ZERO
    };
    // An error of the states appears in the energy balance.
    estimate + jump + unaccounted.abs()
}

/// Sum of the powers with the weights of a row, times the length of the substep.
fn weighted<R: Real>(powers: &[Dissipation<R>], row: &[f64], seconds: R) -> Dissipation<R> {
    (powers.iter().zip(row)).fold(Dissipation::default(), |sum, (power, &weight)| {
        sum.plus(power, seconds * R::from_f64(weight))
    })
}

/// Sum of the absolute values of all causes.
pub(super) fn sizes<R: Real>(of: &Dissipation<R>) -> R {
    of.friction.abs() + of.damper.abs() + of.clamp.abs() + of.drag.abs() + of.drive.abs()
}

/// Largest difference of any of the powers from the first.
fn spread<R: Real>(powers: &[Dissipation<R>; 7]) -> R {
    let [first, ..] = powers;
    (powers.iter())
        .map(|power| sizes(&power.plus(first, -R::ONE)))
        .fold(R::ZERO, R::at_least)
}
