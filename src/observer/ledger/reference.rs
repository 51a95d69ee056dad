//! Works along the exact motion from the start of a step.
//!
//! A quadrature along the method's own stages would have the same error as the method. At a jump of
//! the force both miss the same impulse, and the energy error cancels out of the balance. So the
//! motion is integrated once more from the start of the step. The substeps are those of the method
//! of Dormand and Prince, with the works as further unknowns, `W' = P(state)`:
//!
//! 1. `attempt` takes a substep and bounds the error of its works.
//! 2. `march` joins substeps, with shorter ones where forces or their derivatives are
//!    discontinuous.
//! 3. `works` repeats this until the error is small compared with the energy error of the step.

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
/// Fraction of the step below which a substep is short.
const SHORT: f64 = 1.0 / 64.0;

/// Returns the works of the step between two nodes. If the substeps cannot follow the motion,
/// returns the best works found as an error.
///
/// Substeps follow the motion if there are not too many, and if the error of the works is a
/// fraction of the works. Sticking friction is so stiff that it may exchange its sign in every
/// substep, each within its tolerance. The works are then an artefact, and their error is as large
/// as they are.
///
/// The energy error of the step is the change of the energy minus these works. An error of the
/// works matters only in comparison with it. So the energy error sets the tolerance, down to the
/// rounding of the energies.
pub(super) fn works<R: Real>(
    scene: &dyn SceneQuery<R>,
    [start, end]: [&Node<R>; 2],
    seconds: R,
) -> Result<Works<R>, Works<R>> {
    let rounding = rounding([start, end]);
    let change = change([start, end]);
    let mut found = attempt(scene, start, seconds).works;
    let mut tolerance = R::MAX;
    loop {
        let unaccounted = (change - found.work.total()).abs();
        let suffices = (unaccounted * R::from_f64(FRACTION)).at_least(rounding);
        // The energy error may be small by chance, so the error of the works limits the tolerance
        // of one pass.
        let next = (unaccounted * R::from_f64(PER_SUBSTEP))
            .at_least(found.error * R::from_f64(PER_PASS))
            .at_least(rounding);
        if found.error <= suffices {
            return Ok(found);
        }
        if tolerance <= next * R::TWO {
            let is_known = found.error <= sizes(&found.work) * R::from_f64(FRACTION);
            return if is_known { Ok(found) } else { Err(found) };
        }
        tolerance = next;
        found = march(scene, start, seconds, tolerance).ok_or(found)?;
    }
}

/// Change of the energy between two nodes, J.
fn change<R: Real>([start, end]: [&Node<R>; 2]) -> R {
    end.account.energy.total() - start.account.energy.total()
}

/// Rounding of the energies at both ends, J.
fn rounding<R: Real>(nodes: [&Node<R>; 2]) -> R {
    let sizes = nodes.map(|node| {
        let energy = &node.account.energy;
        (energy.translation + energy.rotation) + (energy.gravity.abs() + energy.springs.abs())
    });
    (sizes[0] + sizes[1]) * (R::EPSILON * R::from_f64(8.0))
}

/// Works of a step by substeps whose errors are within a tolerance (J) each. Returns `None` if
/// there would be too many.
fn march<R: Real>(
    scene: &dyn SceneQuery<R>,
    start: &Node<R>,
    seconds: R,
    tolerance: R,
) -> Option<Works<R>> {
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
            return Some(sum);
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

/// Substep that has been attempted.
struct Substep<R: Real> {
    end: Node<R>,
    works: Works<R>,
    /// Whether a contact opens or closes, or begins or ceases to push, in the substep.
    jumps: bool,
}

/// Takes one substep.
fn attempt<R: Real>(scene: &dyn SceneQuery<R>, start: &Node<R>, seconds: R) -> Substep<R> {
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
    let unaccounted = change([start, &end]) - work.total();
    let error = error(&powers, jumps, unaccounted, seconds);
    Substep {
        end,
        works: Works { work, error },
        jumps,
    }
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

/// Sum of the absolute values of the three causes.
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
