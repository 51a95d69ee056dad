//! The energy audit of a run.

mod reference;

use core::ops::ControlFlow;

use super::{Observer, Sample, SceneQuery};
use crate::energy::{Dissipation, Energy};
use crate::real::{Quaternion, Real};
use crate::rotation::Rotation;
use crate::state::State;
use reference::{Node, Part, Works};

/// Energy audit of a run: works of friction, dampers, clamp, drag and drives, and the energy error
/// of the integrator.
///
/// ```text
/// energy now = energy at start + work of friction, dampers, clamp and drag (each at most 0)
///            + work of drives + handed in + energy error
/// ```
/// - *Works.* The works are those of the exact motion. The ledger integrates that motion from the
///   first sample on, beside that of the integrator and with its own error control. It locates
///   contacts that open or close.
/// - *Energy error.* The remainder is the difference between the energy of the computed motion and
///   that of the exact one. It decreases at the order of the integrator, also through touch-downs,
///   and with the tolerance of an adaptive method. It shows whether a step size is small enough.
/// - *Long runs.* Every motion that bounces or tumbles amplifies small errors. When the exact
///   motion is a sixteenth of the bounding radius away, it starts again from the computed state.
///   The energy error is then the sum of the differences at these times. So it is that of the
///   integrator, and not the distance of two motions that have nothing in common. For a body
///   without extension, the exact motion starts again after each step.
/// - *Cost.* A step costs seven evaluations of the contacts if the motion is smooth and the
///   integrator is less accurate than order 5. A contact that opens or closes costs some tens more,
///   up to a few hundred for a tight tolerance. Fast rotation without contact costs up to 55
///   evaluations. A run without a ledger has no such cost.
/// - *Limits.* If a step does not resolve the contact, the exact motion takes too many substeps. An
///   example is a slip speed below `μ N/m` times the step size, with the load `N` and the mass `m`.
///   In a bounce `N` is many times `m g`. The works then follow from the powers at both ends
///   of the step and between, and the energy error includes the part that these works miss. This is
///   common under [`Radau5`](crate::Radau5). Its steps are many times as long as the time in which
///   friction stops a slip, and the error that the ledger states can be a thousand times that of
///   the motion. A contact that closes and opens between two substeps is missed. The ledger must
///   receive every step, so it is not suited for [`Every`](crate::Every).
/// - *Single precision.* The works have an error of their own, which grows as the steps become
///   shorter: of 4000 bounces in `f32` it was 2e-6 of the energy in the median and 5 % at most,
///   where the energy of the motion was right to 5e-5. In `f64` it was below a fiftieth of the
///   error of a step.
/// - *Damped bounces.* The error within a bounce is much larger than what is left of it after the
///   bounce, and the works are accurate to a part of it. So the energy error after a damped bounce
///   can have another size and sign than that of the motion. It decreases with the step size as
///   that does: where half of the step does not reduce it as the order says, it is not that of the
///   motion. For a box of the mass m that bounced on springs of k at a step size of 0.9
///   `√(m/k)`, the works were accurate to a twentieth of the largest error, 1 % of the works. The
///   part is larger where many contacts open and close in a step: up to twice the error for a cone
///   on tens of points at `ω dt = 0.5`, half of it at 0.25, and a twentieth at 0.12.
/// - *Friction that jumps* between two positions, as in a [`FrictionPatch`](crate::FrictionPatch),
///   is not located. For each contact that passes the edge, the works may be off by two fifths of
///   the step size times the jump of the power. That is of order 1, like the error of the methods
///   with a fixed step.
///
/// One ledger may observe several runs. The audit continues after the pause. Energy that the state
/// gained between two runs, for example by a push of the user, is *handed in*. Use
/// `tumble::f64::Ledger::new()` if nothing else determines the precision.
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
    /// Exact motion at the last sample, if it differs from that of the integrator.
    exact: Option<Node<R>>,
    /// Number of steps still to be evaluated along their chord.
    to_skip: u32,
    /// Number of steps that were evaluated along their chord the last time.
    skipped: u32,
}

/// Last sample, from which the next step starts.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Moment<R: Real> {
    time: R,
    node: Node<R>,
}

impl<R: Real> Ledger<R> {
    /// Creates an empty audit, which begins with the first sample.
    #[must_use]
    pub fn new() -> Self {
        Self {
            work: Dissipation::default(),
            handed_in: R::ZERO,
            first: None,
            last: None,
            exact: None,
            to_skip: 0,
            skipped: 0,
        }
    }

    /// Work done so far, by cause, J. Each but that of drives is at most 0, except for its own
    /// error.
    #[must_use]
    pub fn work(&self) -> Dissipation<R> {
        self.work
    }

    /// Energy by kind at the first sample, J, or 0 before it.
    #[must_use]
    pub fn start(&self) -> Energy<R> {
        self.first.unwrap_or(nothing())
    }

    /// Energy by kind at the last sample, J, or 0 before the first.
    #[must_use]
    pub fn now(&self) -> Energy<R> {
        self.last
            .map_or(nothing(), |moment| moment.node.account.energy)
    }

    /// Energy that the state has gained between the observed runs, J.
    ///
    /// It is 0 if each run continued from the end of the previous one.
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

    /// Energy, powers and rates at a sample. They are known if a step did not change the state.
    fn node(&self, sample: &Sample<'_, R>) -> Node<R> {
        match self.last {
            Some(last) if sample.step > 0 && last.node.state == *sample.state => last.node,
            _ => Node::at(sample.scene, sample.state),
        }
    }

    /// Adds the works between two samples of the same run.
    fn enter(&mut self, before: &Moment<R>, now: &Moment<R>, scene: &dyn SceneQuery<R>) {
        let seconds = now.time - before.time;
        let nodes = [&before.node, &now.node];
        let exact = self.exact.take().unwrap_or(before.node);
        let works = if before.node.state == now.node.state {
            at_rest(&now.node, seconds)
        } else if self.to_skip > 0 {
            self.to_skip -= 1;
            chord(scene, nodes, seconds)
        } else {
            match reference::follow(scene, &exact, nodes, seconds) {
                Ok(followed) => {
                    self.skipped = 0;
                    self.exact = kept(scene, &followed, &now.node.state);
                    followed.works
                }
                Err(works) => self.fall_back(works, chord(scene, nodes, seconds)),
            }
        };
        self.work = self.work.plus(&works.work, R::ONE);
    }

    /// Returns the more accurate of two works of a step that the substeps could not follow.
    ///
    /// Steps that the substeps cannot follow come in series. So after a step along its chord, some
    /// steps use the chord at once, twice as many as the last time.
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
            node: self.node(sample),
        };
        let energy = now.node.account.energy;
        match self.last {
            None => self.first = Some(energy),
            // A run begins: no time has passed since the end of the previous one.
            Some(before) if sample.step == 0 => {
                let exact = self.exact.filter(|_| before.node.state == now.node.state);
                // The scene may be another one.
                self.exact = exact.map(|node| Node::at(sample.scene, &node.state));
                self.handed_in += energy.total() - before.node.energy();
            }
            Some(before) => self.enter(&before, &now, sample.scene),
        }
        self.last = Some(now);
        ControlFlow::Continue(())
    }
}

/// Most steps that use the chord after one that could not be followed.
const MOST_SKIPPED: u32 = 64;

/// Separation from the state of the integrator beyond which the exact motion starts again from that
/// state, in bounding radii.
const FARTHEST: f64 = 1.0 / 16.0;

/// End of the exact motion, or `None` if the exact motion should start again from the state of the
/// integrator.
///
/// The exact motion starts again if the two have become different motions, or if its own error
/// exceeds their separation. The latter occurs in fast rotation without contact, for which several
/// integrators have closed forms.
fn kept<R: Real>(scene: &dyn SceneQuery<R>, exact: &Part<R>, state: &State<R>) -> Option<Node<R>> {
    let is_near = scene.separation(&exact.end.state, state) <= R::from_f64(FARTHEST);
    (is_near && exact.is_closer_than(scene, state)).then_some(exact.end)
}

/// Works of a step that did not change the state: its powers act during the whole step.
fn at_rest<R: Real>(node: &Node<R>, seconds: R) -> Works<R> {
    Works {
        work: Dissipation::default().plus(&node.account.dissipation, seconds),
        error: R::ZERO,
    }
}

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

/// Rotation halfway between two rotations that are less than half a revolution apart.
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

    /// Trial 1 for one second, with a slip speed that the step resolves.
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
        // Rounding of the time: 1e-16 of the length of each step.
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
