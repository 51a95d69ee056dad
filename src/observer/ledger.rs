//! The energy audit of a run.

mod reference;

use core::ops::ControlFlow;

use super::{Observer, Sample, SceneQuery};
use crate::energy::{Dissipation, Energy};
use crate::real::{Quaternion, Real};
use crate::rotation::Rotation;
use crate::state::State;
use reference::{Node, Works};

/// Energy audit of a run: what friction, dampers and separation took, and the energy error of the
/// integrator.
///
/// ```text
/// energy now = energy at start + work of friction + work of dampers + work of the clamp
///            + handed in + energy error                                   (each work at most 0)
/// ```
/// - *Works.* In each step they are those of the exact motion from the start of the step. The
///   ledger integrates that motion with an error control of its own. It locates contacts that open
///   or close, so the works are as accurate as the states.
/// - *Energy error.* What is left over is the sum of the energy errors that the integrator makes in
///   its steps. It falls at the order of the integrator, through touch-downs too, and with the
///   tolerance of an adaptive method. It shows whether a step is short enough. It is not the
///   difference from the energy of the true motion: an error of one step also changes what friction
///   and dampers take in later steps.
/// - *Cost.* Seven evaluations of the contacts a step where the motion is smooth and the integrator
///   less accurate than order 5. A contact that opens or closes takes some tens more, up to a few
///   hundred for a tight tolerance. A run without a ledger pays nothing.
/// - *Limits.* Where a step does not resolve the contact, as with a slip speed far below `mu g`
///   times the step under [`EnergyMomentum`](crate::EnergyMomentum), the exact motion takes too
///   many substeps. The works then follow from the powers at both ends of the step and between, and
///   the energy error counts what these miss. A contact that closes and opens between two substeps
///   is missed. The ledger must see every step: it is not meant for [`Every`](crate::Every).
/// - *Mean velocities.* [`EnergyMomentum`](crate::EnergyMomentum) is accurate in the mean velocity
///   of a step, and the exact motion starts from the velocity at its end. The stated energy error
///   is up to about 200 times the difference from the true energy, and of order 2 as that is.
///
/// One ledger may watch several runs. The audit goes on over the pause. What the state gained
/// between two runs, by a push of the user for example, is *handed in*. Use
/// `tumble::f64::Ledger::new()` where nothing else fixes the precision.
///
/// ```
/// use tumble::f64::Ledger;
/// use tumble::{DormandPrince54, Trial};
///
/// let trial = Trial { slip_speed: 1e-3, ..Trial::report(1).ok_or("no such trial")? };
/// let mut ledger = Ledger::new();
/// trial.stepper(DormandPrince54::new(1e-9))?.run(&mut trial.state(), 0.2, &mut ledger)?;
/// assert!(ledger.work().friction < -0.1); // J
/// assert!(ledger.energy_error().abs() < 1e-7); // J
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ledger<R: Real = f64> {
    work: Dissipation<R>,
    handed_in: R,
    first: Option<Energy<R>>,
    last: Option<Moment<R>>,
    /// Number of steps still to be taken along their chord.
    to_skip: u32,
    /// Number of steps that were taken along their chord the last time.
    skipped: u32,
}

/// The last sample, from which the next step is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Moment<R: Real> {
    time: R,
    node: Node<R>,
}

impl<R: Real> Ledger<R> {
    /// An empty audit, which begins with the first sample.
    #[must_use]
    pub fn new() -> Self {
        Self {
            work: Dissipation::default(),
            handed_in: R::ZERO,
            first: None,
            last: None,
            to_skip: 0,
            skipped: 0,
        }
    }

    /// Work done by friction, dampers and clamp so far, J; each at most 0 but for its own error.
    #[must_use]
    pub fn work(&self) -> Dissipation<R> {
        self.work
    }

    /// Energy by kind at the first sample; 0 before it.
    #[must_use]
    pub fn start(&self) -> Energy<R> {
        self.first.unwrap_or(nothing())
    }

    /// Energy by kind at the last sample; 0 before the first.
    #[must_use]
    pub fn now(&self) -> Energy<R> {
        self.last
            .map_or(nothing(), |moment| moment.node.account.energy)
    }

    /// Energy that the state has gained between the runs that were watched, J; 0 where each run
    /// went on from the end of the one before.
    #[must_use]
    pub fn handed_in(&self) -> R {
        self.handed_in
    }

    /// Energy error of the integrator, J: `now - start - work - handed_in`. Above 0 if the
    /// integrator has added energy.
    #[must_use]
    pub fn energy_error(&self) -> R {
        self.now().total() - self.start().total() - self.work.total() - self.handed_in
    }

    /// Adds the works from one moment to the next of the same run.
    fn enter(&mut self, before: &Moment<R>, now: &Moment<R>, scene: &dyn SceneQuery<R>) {
        let seconds = now.time - before.time;
        let nodes = [&before.node, &now.node];
        let works = if self.to_skip > 0 {
            self.to_skip -= 1;
            chord(scene, nodes, seconds)
        } else {
            match reference::works(scene, nodes, seconds) {
                Ok(works) => {
                    self.skipped = 0;
                    works
                }
                Err(works) => self.fall_back(works, chord(scene, nodes, seconds)),
            }
        };
        self.work = self.work.plus(&works.work, R::ONE);
    }

    /// Returns the more accurate of two works of a step that the substeps could not follow.
    ///
    /// Such steps come in series. So after the chord some steps take it at once, twice as many as
    /// the last time.
    fn fall_back(&mut self, followed: Works<R>, chord: Works<R>) -> Works<R> {
        if followed.error <= chord.error {
            return followed;
        }
        self.skipped = (self.skipped * 2).clamp(1, MOST_SKIPPED);
        self.to_skip = self.skipped;
        chord
    }
}

impl<R: Real> Default for Ledger<R> {
    fn default() -> Self {
        Self::new()
    }
}

impl<R: Real> Observer<R> for Ledger<R> {
    fn observe(&mut self, sample: &Sample<'_, R>) -> ControlFlow<()> {
        let now = Moment {
            time: sample.time,
            node: Node::at(sample.scene, sample.state),
        };
        let energy = now.node.account.energy;
        match self.last {
            None => self.first = Some(energy),
            // A run begins: no time has passed since the end of the one before.
            Some(before) if sample.step == 0 => {
                self.handed_in += energy.total() - before.node.account.energy.total();
            }
            Some(before) => self.enter(&before, &now, sample.scene),
        }
        self.last = Some(now);
        ControlFlow::Continue(())
    }
}

/// Most steps that take the chord after one that could not be followed.
const MOST_SKIPPED: u32 = 64;

/// Works of a step that does not resolve its contacts, by Simpson's rule along the straight line
/// between its ends.
fn chord<R: Real>(scene: &dyn SceneQuery<R>, [start, end]: [&Node<R>; 2], seconds: R) -> Works<R> {
    let (a, b) = (&start.state, &end.state);
    let middle = State {
        position: (a.position + b.position) * R::HALF,
        linear_velocity: (a.linear_velocity + b.linear_velocity) * R::HALF,
        orientation: halfway::<R>(a.orientation, b.orientation).to_quat(),
        angular_momentum: (a.angular_momentum + b.angular_momentum) * R::HALF,
    };
    let ends = start
        .account
        .dissipation
        .plus(&end.account.dissipation, R::ONE);
    let middle = scene.dissipation(&middle);
    let trapezium = Dissipation::default().plus(&ends, seconds * R::HALF);
    let third = R::from_f64(1.0 / 3.0);
    let work = Dissipation::default()
        .plus(&trapezium, third)
        .plus(&middle, seconds * (third * R::TWO));
    Works {
        work,
        error: reference::sizes(&work.plus(&trapezium, -R::ONE)),
    }
}

/// The rotation halfway between two that are less than half a turn apart.
fn halfway<R: Real>(a: R::Quat, b: R::Quat) -> Rotation<R> {
    let ([ax, ay, az, aw], [bx, by, bz, bw]) = (a.xyzw(), b.xyzw());
    let same_side = ax * bx + ay * by + az * bz + aw * bw >= R::ZERO;
    let sign = if same_side { R::ONE } else { -R::ONE };
    Rotation::from_quat(R::Quat::new(
        ax + bx * sign,
        ay + by * sign,
        az + bz * sign,
        aw + bw * sign,
    ))
}

fn nothing<R: Real>() -> Energy<R> {
    Energy {
        translation: R::ZERO,
        rotation: R::ZERO,
        gravity: R::ZERO,
        springs: R::ZERO,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::StrangSplitting;
    use crate::trial::Trial;
    use glam::DVec3;

    /// Trial 1 for a second, with a slip speed that the step resolves.
    fn trial() -> Trial<f64> {
        Trial {
            slip_speed: 1e-3,
            ..Trial::report(1).unwrap()
        }
    }

    #[test]
    fn books_go_on_over_a_pause() {
        let stepper = trial()
            .stepper(StrangSplitting { time_step: 1e-4 })
            .unwrap();
        let (mut state, mut whole) = (trial().state(), Ledger::new());
        stepper.run(&mut state, 1.0, &mut whole).unwrap();
        let (mut state, mut halves) = (trial().state(), Ledger::new());
        stepper.run(&mut state, 0.5, &mut halves).unwrap();
        stepper.run(&mut state, 0.5, &mut halves).unwrap();
        assert_eq!(halves.start(), whole.start());
        assert_eq!(halves.now(), whole.now());
        assert_eq!(halves.handed_in().to_bits(), 0);
        // The clock's rounding: 1e-16 of each step's length.
        let gap = halves.work().plus(&whole.work(), -1.0);
        for (gap, work) in [
            (gap.friction, whole.work().friction),
            (gap.damper, whole.work().damper),
            (gap.clamp, whole.work().clamp),
        ] {
            assert!(gap.abs() <= 1e-11 * work.abs(), "{gap:e} of {work:e} J");
        }
        assert!(
            halves.energy_error().abs() < 1e-4,
            "{:e}",
            halves.energy_error()
        );
    }

    #[test]
    fn a_push_between_two_runs_is_no_error_of_the_integrator() {
        let stepper = trial()
            .stepper(StrangSplitting { time_step: 1e-4 })
            .unwrap();
        let (mut state, mut ledger) = (trial().state(), Ledger::new());
        stepper.run(&mut state, 0.1, &mut ledger).unwrap();
        let before = stepper.energy(&state).total();
        state.linear_velocity += DVec3::X * 2.0;
        let push = stepper.energy(&state).total() - before;
        stepper.run(&mut state, 0.1, &mut ledger).unwrap();
        assert_eq!(ledger.handed_in().to_bits(), push.to_bits());
        assert!(
            ledger.energy_error().abs() < 1e-4,
            "{:e}",
            ledger.energy_error()
        );
    }
}
