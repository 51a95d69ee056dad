//! What is asked of an integrator.

use super::plan::CheckPlan;
use super::scenes::Setup;
use super::{
    Input, Requirement, Violation, cannot_be, demand, demand_at_least, demand_at_most,
    demand_finite, ulps,
};
use crate::energy::Energy;
use crate::integrator::{Integrator, Step};
use crate::real::{Quaternion, Real, Vector};
use crate::state::State;

/// Checks an integrator, on scenes scaled to its own step: a box in free flight, one that slides on
/// its springs, one that falls on a corner.
///
/// A step succeeds and is finite; takes more than 0 s, at most its limit, and just the time that it
/// tells; steps towards a moment land on it. The same input gives the same bits, whatever was done
/// with the workspace before (where the method [chooses its steps](Integrator::ADAPTIVE): with
/// a new workspace, or a copy of the one that was used). The orientation has length 1. The error
/// falls with the step at least at the stated order less 0.3, by halving the limit while the box
/// slides (not asked where it is rounding already, or where the method chooses shorter steps).
///
/// ```
/// use tumble::contract::{CheckPlan, check_integrator};
/// check_integrator(&tumble::Rk4 { time_step: 1e-3 }, CheckPlan::default())?;
/// # Ok::<(), tumble::contract::Violation>(())
/// ```
///
/// # Errors
/// The first clause that is broken, with the input that breaks it.
pub fn check_integrator<R: Real, I: Integrator<R>>(
    integrator: &I,
    plan: CheckPlan,
) -> Result<(), Violation> {
    integrator.check().map_err(cannot_be)?;
    let time_step = own_step::<R, I>(integrator)?;
    let mut draw = plan.draw();
    let setups = [
        Setup::flight(time_step),
        Setup::slide(time_step),
        Setup::fall(time_step),
    ];
    for setup in setups {
        let attempt = Attempt {
            integrator,
            setup: setup.map_err(cannot_be)?,
            time_step,
        };
        attempt.lands_on_limit()?;
        attempt.alike([1.0, 0.37, 1e-3, 10.0].map(R::from_f64), 40)?;
        for _ in 0..plan.cases / 20 {
            attempt.alike([draw.share(), R::TWO, draw.scale(20), draw.share()], 4)?;
        }
    }
    let flight = Attempt {
        integrator,
        setup: Setup::flight(time_step).map_err(cannot_be)?,
        time_step,
    };
    flight.tells_time()?;
    let slide = Attempt {
        integrator,
        setup: Setup::slide(time_step).map_err(cannot_be)?,
        time_step,
    };
    slide.converges()
}

/// Checks that the computed energy never rises, by no unit in the last place: in as many random
/// scenes as the battery has cases, with 50 steps of random length in each. Most of them are far
/// too stiff, too fast or too slippery for the step.
///
/// It is not in the contract of [`Integrator`]: explicit methods need not pass, and do not.
/// [`EnergyMomentum`](crate::EnergyMomentum) does.
///
/// ```
/// use tumble::contract::{CheckPlan, Requirement, check_energy_never_rises};
/// use tumble::{EnergyMomentum, SymplecticEuler};
///
/// check_energy_never_rises(&EnergyMomentum { time_step: 1e-2 }, CheckPlan::default())?;
/// let violation = check_energy_never_rises(&SymplecticEuler { time_step: 1e-2 }, CheckPlan::default());
/// assert!(violation.is_err());
/// # Ok::<(), tumble::contract::Violation>(())
/// ```
///
/// # Errors
/// The first step in which the energy rises (the energies after and before are the breach's value
/// and bound), is not finite, or is refused.
pub fn check_energy_never_rises<R: Real, I: Integrator<R>>(
    integrator: &I,
    plan: CheckPlan,
) -> Result<(), Violation> {
    integrator.check().map_err(cannot_be)?;
    let time_step = own_step::<R, I>(integrator)?;
    let mut draw = plan.draw();
    for case in 0..plan.cases {
        let setup = Setup::wild(&mut draw, case, time_step).map_err(cannot_be)?;
        let attempt = Attempt {
            integrator,
            setup,
            time_step,
        };
        let mut state = attempt.setup.start;
        let mut workspace = I::Workspace::default();
        let mut before = Energy::of(&attempt.setup.scene, &state).total();
        for number in 0..50 {
            let limit = match draw.pick(3) {
                0 => time_step * draw.scale(10),
                _ => time_step,
            };
            attempt.step(&mut state, limit, number, &mut workspace)?;
            let after = Energy::of(&attempt.setup.scene, &state).total();
            let input = || attempt.input(number, limit);
            demand_finite(after, input)?;
            demand_at_most(after, before, Requirement::EnergyNeverRises, input)?;
            before = after;
        }
    }
    Ok(())
}

/// The method's own step, s: what it takes of a second of free flight.
fn own_step<R: Real, I: Integrator<R>>(integrator: &I) -> Result<R, Violation> {
    let attempt = Attempt {
        integrator,
        setup: Setup::flight(R::ONE).map_err(cannot_be)?,
        time_step: R::ONE,
    };
    let mut state = attempt.setup.start;
    let step = attempt.step(&mut state, R::ONE, 0, &mut I::Workspace::default())?;
    Ok(step.elapsed)
}

struct Attempt<'a, R: Real, I> {
    integrator: &'a I,
    setup: Setup<R>,
    time_step: R,
}

impl<R: Real, I: Integrator<R>> Attempt<'_, R, I> {
    fn input(&self, step: u32, limit: R) -> Input {
        Input::Step {
            scene: self.setup.name,
            case: self.setup.case,
            step,
            limit: limit.to_f64(),
        }
    }

    /// A step, with what is asked of every one.
    fn step(
        &self,
        state: &mut State<R>,
        limit: R,
        number: u32,
        workspace: &mut I::Workspace,
    ) -> Result<Step<R>, Violation> {
        let input = || self.input(number, limit);
        let outcome = self
            .integrator
            .step(&self.setup.scene, state, limit, workspace);
        let step = outcome.map_err(|error| Violation {
            requirement: Requirement::Steps(error),
            input: input(),
            value: 0.0,
            bound: 0.0,
        })?;
        let whole = state.not_finite().is_none() && step.elapsed.is_finite();
        demand(whole, Requirement::Finite, step.elapsed, R::MAX, input)?;
        let takes = step.elapsed > R::ZERO;
        demand(takes, Requirement::TakesTime, step.elapsed, R::ZERO, input)?;
        demand_at_most(step.elapsed, limit, Requirement::KeepsToLimit, input)?;
        let [x, y, z, w] = state.orientation.xyzw();
        let off = (x * x + y * y + z * z + w * w - R::ONE).abs();
        demand_at_most(off, ulps(16.0), Requirement::UnitOrientation, input)?;
        Ok(step)
    }

    /// Steps towards a moment that is no whole number of steps away.
    fn lands_on_limit(&self) -> Result<(), Violation> {
        let total = self.time_step * R::from_f64(2.37);
        let (mut state, mut left, mut number) = (self.setup.start, total, 0);
        let mut workspace = I::Workspace::default();
        while left > total * rounding_of_time() {
            let input = || self.input(number, left);
            demand(
                number < 10_000,
                Requirement::LandsOnLimit,
                left,
                R::ZERO,
                input,
            )?;
            left -= self.step(&mut state, left, number, &mut workspace)?.elapsed;
            number += 1;
        }
        Ok(())
    }

    /// The same steps four times: twice with a fresh workspace, once with one that is used for
    /// everything, once with a copy of that. A method that chooses its steps may take another one
    /// with a used workspace.
    fn alike(&self, shares: [R; 4], steps: u32) -> Result<(), Violation> {
        let mut state = self.setup.start;
        let mut used = I::Workspace::default();
        for (number, share) in (0..steps).zip(shares.into_iter().cycle()) {
            let limit = self.time_step * share;
            let [mut once, mut twice, mut thrice] = [state; 3];
            let first = self.step(&mut once, limit, number, &mut I::Workspace::default())?;
            let second = self.step(&mut twice, limit, number, &mut I::Workspace::default())?;
            let mut copy = used.clone();
            let third = self.step(&mut thrice, limit, number, &mut used)?;
            let mut fourth = state;
            let step = self.step(&mut fourth, limit, number, &mut copy)?;
            let same =
                |end: &State<R>, step: &Step<R>, other: &State<R>, as_in: &Step<R>, requirement| {
                    let same = end == other && step.elapsed == as_in.elapsed;
                    let apart = distance(end, other, self.time_step);
                    demand(same, requirement, apart, R::ZERO, || {
                        self.input(number, limit)
                    })
                };
            same(&twice, &second, &once, &first, Requirement::SameBits)?;
            same(&fourth, &step, &thrice, &third, Requirement::SameBits)?;
            if !I::ADAPTIVE {
                same(
                    &thrice,
                    &third,
                    &once,
                    &first,
                    Requirement::WorkspaceChangesNothing,
                )?;
            }
            if number % 3 == 0 {
                // Something else in between.
                let mut other = self.setup.start;
                self.step(&mut other, self.time_step, 0, &mut used)?;
            }
            state = once;
        }
        Ok(())
    }

    /// Without force the centre has moved by its velocity times the time that has passed.
    fn tells_time(&self) -> Result<(), Violation> {
        for (number, share) in (0..).zip([1.0, 0.37, 0.01]) {
            let limit = self.time_step * R::from_f64(share);
            let (start, mut state) = (self.setup.start, self.setup.start);
            let step = self.step(&mut state, limit, number, &mut I::Workspace::default())?;
            let way = start.linear_velocity * step.elapsed;
            let off = (state.position - start.position - way).length();
            let bound = (start.position.length() + way.length()) * ulps(64.0);
            demand_at_most(off, bound, Requirement::TellsTime, || {
                self.input(number, limit)
            })?;
        }
        Ok(())
    }

    /// Differences of runs with a whole, a half, a quarter ... of the step must shrink at the
    /// stated order.
    fn converges(&self) -> Result<(), Violation> {
        // 2 to the power of order - 0.3.
        let mut least = R::from_f64(0.812_252_396);
        // No power of 2 beyond is a number.
        for _ in 0..self.integrator.order().min(2048) {
            least *= R::TWO;
        }
        let noise = ulps::<R>(4096.0);
        let mut last = None;
        let mut ratio = None;
        let mut coarse = self.run_in(8)?;
        for steps in [16, 32, 64, 128] {
            let fine = self.run_in(steps)?;
            let (Some(a), Some(b)) = (coarse, fine) else {
                return Ok(());
            };
            let apart = distance(&a, &b, self.time_step);
            if apart < noise {
                break;
            }
            ratio = last.map(|before: R| before / apart);
            last = Some(apart);
            coarse = fine;
        }
        match ratio {
            None => Ok(()),
            Some(ratio) => {
                let limit = self.time_step;
                demand_at_least(ratio, least, Requirement::Order, || self.input(0, limit))
            }
        }
    }

    /// Eight of the method's own steps, in `steps` steps; `None` where it takes shorter ones.
    fn run_in(&self, steps: u32) -> Result<Option<State<R>>, Violation> {
        let limit = self.time_step * R::from_f64(8.0 / f64::from(steps));
        let (mut state, mut workspace) = (self.setup.start, I::Workspace::default());
        for number in 0..steps {
            let step = self.step(&mut state, limit, number, &mut workspace)?;
            if step.elapsed < limit - limit * rounding_of_time() {
                return Ok(None);
            }
        }
        Ok(Some(state))
    }
}

/// How far apart two states are: places, turns as they move a point 1 m away, velocities times a
/// time. m.
fn distance<R: Real>(a: &State<R>, b: &State<R>, seconds: R) -> R {
    let (o, one) = (R::ZERO, R::ONE);
    let [x, y] = [R::Vec3::new(one, o, o), R::Vec3::new(o, one, o)];
    (a.position - b.position).length()
        + (a.world_point(x) - b.world_point(x)).length()
        + (a.world_point(y) - b.world_point(y)).length()
        + (a.linear_velocity - b.linear_velocity).length() * seconds
        + (a.angular_momentum - b.angular_momentum).length() * seconds
}

/// What counts as rounding of a time that is left after steps were subtracted one by one, as a
/// share of it.
fn rounding_of_time<R: Real>() -> R {
    ulps::<R>(4.0e6).at_most(R::from_f64(1e-4)) * R::TWO
}
