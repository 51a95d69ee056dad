//! The energy books of a run.

use core::ops::ControlFlow;

use super::{Observer, Probe, Sample};
use crate::energy::{Account, Dissipation, Energy};
use crate::real::{Quaternion, Real};
use crate::rotation::Rotation;
use crate::state::State;

/// Books of a run's energy: what was there, what is there, what friction, dampers and the clamp took, and what is left over.
///
/// ```text
/// energy now = energy at start + work of friction + work of dampers + lost to the clamp + handed in + residue        (works at most 0)
/// ```
/// The works are integrals of [`Dissipation`] along the run, by Simpson's rule in each step with a middle state from cubic Hermite interpolation: of order 4
/// where the motion is smooth, whatever the integrator is. So the **residue** is the integrator's own error in the energy: it falls at the
/// integrator's order, and a user sees by it whether his step is short enough. It costs two evaluations of the contacts a step, and nothing where no ledger watches.
///
/// Say `tumble::f64::Ledger::new()` where no other line says in which precision it counts.
///
/// One ledger may watch several runs: the books go on over the pause, and what the state gained between two runs, a push by the user say, is **handed in**.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ledger<R: Real = f64> {
    work: Dissipation<R>,
    handed_in: R,
    first: Option<Energy<R>>,
    last: Option<Moment<R>>,
}

/// What the next step's quadrature needs of the one before.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Moment<R: Real> {
    time: R,
    state: State<R>,
    account: Account<R>,
}

impl<R: Real> Ledger<R> {
    /// Empty books; the first sample opens them.
    #[must_use]
    pub fn new() -> Self {
        Self {
            work: Dissipation {
                friction: R::ZERO,
                damper: R::ZERO,
                clamp: R::ZERO,
            },
            handed_in: R::ZERO,
            first: None,
            last: None,
        }
    }

    /// Work done by friction, dampers and clamp so far, J; each at most 0 but for the error of the quadrature.
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
        self.last.map_or(nothing(), |moment| moment.account.energy)
    }

    /// Energy that the state has gained between the runs that were watched, J; 0 where each run went on from the end of the one before.
    #[must_use]
    pub fn handed_in(&self) -> R {
        self.handed_in
    }

    /// What the books lack, J: `now - start - work - handed_in`. Above 0 where the integrator has made energy.
    #[must_use]
    pub fn residue(&self) -> R {
        self.now().total() - self.start().total() - self.work.total() - self.handed_in
    }

    /// Work from one moment to the next of the same run.
    fn work_of_step(&mut self, before: &Moment<R>, now: &Moment<R>, scene: &dyn Probe<R>) {
        let seconds = now.time - before.time;
        let middle = scene.dissipation(&halfway(before, now, seconds));
        let sixth = seconds * R::from_f64(1.0 / 6.0);
        self.work = self
            .work
            .plus(&before.account.dissipation, sixth)
            .plus(&middle, sixth * R::from_f64(4.0))
            .plus(&now.account.dissipation, sixth);
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
            state: *sample.state,
            account: sample.scene.account(sample.state),
        };
        match self.last {
            None => self.first = Some(now.account.energy),
            // A run begins: no time has passed since the end of the one before.
            Some(before) if sample.step == 0 => {
                self.handed_in += now.account.energy.total() - before.account.energy.total();
            }
            Some(before) => self.work_of_step(&before, &now, sample.scene),
        }
        self.last = Some(now);
        ControlFlow::Continue(())
    }
}

/// The state in the middle of a step, by cubic Hermite interpolation: `(a + b)/2 + h/8 (a' - b')`.
fn halfway<R: Real>(a: &Moment<R>, b: &Moment<R>, seconds: R) -> State<R> {
    let eighth = seconds * R::from_f64(0.125);
    let cubic = |from: R::Vec3, to: R::Vec3, from_slope: R::Vec3, to_slope: R::Vec3| {
        (from + to) * R::HALF + (from_slope - to_slope) * eighth
    };
    let (p, q) = (&a.state, &b.state);
    let (p_rates, q_rates) = (&a.account.rates, &b.account.rates);
    // The chord's middle, turned on by what the spins at both ends say beyond a constant one.
    let correction = Rotation::<R>::from_rotation_vector(
        (p_rates.angular_velocity - q_rates.angular_velocity) * eighth,
    );
    State {
        position: cubic(p.position, q.position, p.linear_velocity, q.linear_velocity),
        linear_velocity: cubic(
            p.linear_velocity,
            q.linear_velocity,
            p_rates.acceleration,
            q_rates.acceleration,
        ),
        orientation: correction
            .after(middle_of_turns(p.orientation, q.orientation))
            .to_quat(),
        angular_momentum: cubic(
            p.angular_momentum,
            q.angular_momentum,
            p_rates.torque,
            q_rates.torque,
        ),
    }
}

/// The turn halfway between two that are less than half a turn apart.
fn middle_of_turns<R: Real>(a: R::Quat, b: R::Quat) -> Rotation<R> {
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
        assert!(halves.residue().abs() < 1e-4, "{:e}", halves.residue());
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
        assert!(ledger.residue().abs() < 1e-4, "{:e}", ledger.residue());
    }
}
