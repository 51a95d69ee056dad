//! The energy books of a run.

use core::ops::ControlFlow;

use super::{Observer, Sample};
use crate::energy::{Account, Dissipation, Energy};
use crate::real::{Quaternion, Real};
use crate::rotation::Rotation;
use crate::state::State;

/// Books of a run's energy: what was there, what is there, what friction, dampers and the clamp took, and what is left over.
///
/// ```text
/// energy now = energy at start + work of friction + work of dampers + lost to the clamp + residue        (works at most 0)
/// ```
/// The works are integrals of [`Dissipation`] along the run, by Simpson's rule in each step with a middle state from cubic Hermite interpolation: of order 4
/// where the motion is smooth, whatever the integrator is. So the **residue** is the integrator's own error in the energy: it falls at the
/// integrator's order, and a user sees by it whether his step is short enough. It costs two evaluations of the contacts a step, and nothing where no ledger watches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ledger<R: Real = f64> {
    work: Dissipation<R>,
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

    /// What the books lack, J: `now - start - work`. Above 0 where the integrator has made energy.
    #[must_use]
    pub fn residue(&self) -> R {
        self.now().total() - self.start().total() - self.work.total()
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
        if let Some(before) = &self.last {
            let seconds = now.time - before.time;
            let middle = halfway(before, &now, seconds);
            let sixth = seconds * R::from_f64(1.0 / 6.0);
            self.work = self
                .work
                .plus(&before.account.dissipation, sixth)
                .plus(&sample.scene.dissipation(&middle), sixth * R::from_f64(4.0))
                .plus(&now.account.dissipation, sixth);
        } else {
            self.first = Some(now.account.energy);
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
