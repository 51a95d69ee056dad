//! Requirements of an integrator.

use super::plan::CheckPlan;
use super::roles::with_each_role;
use super::scenes::Setup;
use super::stable_step::check_stable_step;
use super::{
    Input, Requirement, Violation, cannot_be, demand, demand_at_least, demand_at_most,
    demand_finite, ulps,
};
use crate::energy::Energy;
use crate::error;
use crate::integrator::{Integrator, Rk4, Step};
use crate::real::{Quaternion, Real, Vector};
use crate::scene::Dynamics;
use crate::state::State;

/// Checks an integrator on scenes scaled to its own step size.
///
/// The scenes are a box in free flight, a box that slides on its springs, and a box that falls on a
/// corner. The step size is the [fixed step](Integrator::fixed_step) of the method. Without one it
/// is the length of its first step in one second of free flight.
///
/// Four more scenes have one role each. They are a box on a mount, which is an applied
/// [`Force`](crate::Force), in flight and on the ground, a box on a turntable
/// ([`MovingGround`](crate::MovingGround)), and a box with resistance to rolling and spinning
/// ([`WithResistance`](crate::WithResistance)).
///
/// The requirements are:
///
/// - A step succeeds and its result is finite.
/// - A step takes more than 0 s, at most its limit, and exactly the time that it returns. Steps
///   towards a time arrive at it.
/// - If the method states a [fixed step](Integrator::fixed_step), a step with a larger limit takes
///   it. A method that [spans steps](Integrator::SPANS_STEPS) takes a whole number of them or its
///   limit.
/// - The same input gives the same bits, whatever steps of the same scene the workspace was used
///   for before. For [adaptive methods](Integrator::ADAPTIVE) this holds for a new workspace, for a
///   copy of the used one, and for one that was [cleared](Integrator::clear).
/// - The orientation has length 1.
/// - The error decreases with the step size at least at the stated order minus 0.3. This is
///   measured by halving the limit while the box slides, and in each scene with a role. It is not
///   checked if the error is rounding already, or if the method takes shorter steps.
/// - With shorter steps, the result tends to that of [`Rk4`]: within four times the last change. If
///   the method takes shorter steps than the limit, it must agree to a twentieth of the motion.
/// - If the method states a [largest stable step](Integrator::largest_stable_step), it is a number
///   of at least 0. Damped oscillators do not grow in 100 steps of 0.9 of it, or of less. Their
///   amplitude in the second half is at most twice that in the first half.
///
/// *Limits:*
/// - A method that takes shorter steps than the limit can leave out a small effect, such as the
///   resistance to rolling alone.
/// - A fixed step above 10 s is not compared with the steps.
/// - A largest stable step that is a tenth too large can pass. One that is too small passes.
/// - The oscillators are translations under an applied force. A largest stable step that holds for
///   applied forces alone, and not for contacts, passes.
///
/// ```
/// use tumble::contract::{CheckPlan, check_integrator};
/// check_integrator(&tumble::Rk4 { time_step: 1e-3 }, CheckPlan::default())?;
/// # Ok::<(), tumble::contract::Violation>(())
/// ```
///
/// # Errors
/// Returns the first [`Violation`], with the requirement that is broken and the input that breaks
/// it.
pub fn check_integrator<R: Real, I: Integrator<R>>(
    integrator: &I,
    plan: CheckPlan,
) -> Result<(), Violation> {
    integrator.check().map_err(cannot_be)?;
    let time_step = own_step::<R, I>(integrator)?;
    let mut draw = plan.draw();
    let flight = Setup::flight(time_step).map_err(cannot_be)?;
    let slide = Setup::slide(time_step).map_err(cannot_be)?;
    let fall = Setup::fall(time_step).map_err(cannot_be)?;
    for setup in [&flight, &slide, &fall] {
        let attempt = Attempt {
            integrator,
            setup,
            time_step,
        };
        attempt.lands_on_limit()?;
        attempt.alike([1.0, 0.37, 1e-3, 10.0].map(R::from_f64), 40)?;
        for _ in 0..plan.cases / 20 {
            attempt.alike([draw.share(), R::TWO, draw.scale(20), draw.share()], 4)?;
        }
    }
    let attempt = |setup| Attempt {
        integrator,
        setup,
        time_step,
    };
    attempt(&flight).tells_time()?;
    attempt(&slide).converges_to_the_motion()?;
    for setup in with_each_role(time_step) {
        Attempt {
            integrator,
            setup: &setup.map_err(cannot_be)?,
            time_step,
        }
        .converges_to_the_motion()?;
    }
    check_stable_step(integrator, time_step, plan.cases / 40, &mut draw)
}

/// Checks that the computed energy never increases, not even by one unit in the last place.
///
/// The check runs one random scene for each case of the plan, with 50 steps of random length. Most
/// scenes are far too stiff, too fast or too slippery for the step size.
///
/// The check is not part of the contract of [`Integrator`]. Explicit methods need not pass, and do
/// not. [`EnergyMomentum`](crate::EnergyMomentum),
/// [`CompactEnergyMomentum`](crate::CompactEnergyMomentum) and
/// [`AdaptiveEnergyMomentum`](crate::AdaptiveEnergyMomentum) pass.
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
/// Returns the [`Violation`] of the first step in which the energy increases, is not finite, or
/// which fails. Its value and bound are the energies after and before the step.
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
            setup: &setup,
            time_step,
        };
        let mut state = setup.start;
        let mut workspace = I::Workspace::default();
        let mut before = Energy::of(&setup.scene, &state).total();
        for number in 0..50 {
            let limit = match draw.pick(3) {
                0 => time_step * draw.scale(10),
                _ => time_step,
            };
            attempt.step(&mut state, limit, number, &mut workspace)?;
            let after = Energy::of(&setup.scene, &state).total();
            let input = || attempt.input(number, limit);
            demand_finite(after, input)?;
            demand_at_most(after, before, Requirement::EnergyNeverRises, input)?;
            before = after;
        }
    }
    Ok(())
}

/// The method's own step size, s: its fixed step, or the length of its first step in one second of
/// free flight.
///
/// The first step of a flight in closed form spans many fixed steps.
fn own_step<R: Real, I: Integrator<R>>(integrator: &I) -> Result<R, Violation> {
    let fixed = integrator.fixed_step();
    if let Some(fixed) = fixed {
        error::above_zero("fixed step of the integrator", fixed, " s").map_err(cannot_be)?;
    }
    let setup = Setup::flight(R::ONE).map_err(cannot_be)?;
    let attempt = Attempt {
        integrator,
        setup: &setup,
        time_step: R::ONE,
    };
    let mut state = setup.start;
    let step = attempt.step(&mut state, R::ONE, 0, &mut I::Workspace::default())?;
    Ok(step.elapsed.at_most(fixed.unwrap_or(R::MAX)))
}

struct Attempt<'a, R: Real, I, S> {
    integrator: &'a I,
    setup: &'a Setup<R, S>,
    time_step: R,
}

impl<R: Real, I: Integrator<R>, S: Dynamics<R>> Attempt<'_, R, I, S> {
    fn input(&self, step: u32, limit: R) -> Input {
        Input::Step {
            scene: self.setup.name,
            case: self.setup.case,
            step,
            limit: limit.to_f64(),
        }
    }

    /// Runs one step and checks the requirements of every step.
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
        let [p, v] = [state.position, state.linear_velocity].map(|v| v.x() + v.y() + v.z());
        let l =
            state.angular_momentum.x() + state.angular_momentum.y() + state.angular_momentum.z();
        let [x, y, z, w] = state.orientation.xyzw();
        for number in [step.elapsed, p, v, l, x + y + z + w] {
            demand(
                number.is_finite(),
                Requirement::Finite,
                number,
                R::MAX,
                input,
            )?;
        }
        let takes = step.elapsed > R::ZERO;
        demand(takes, Requirement::TakesTime, step.elapsed, R::ZERO, input)?;
        demand_at_most(step.elapsed, limit, Requirement::KeepsToLimit, input)?;
        let off = (x * x + y * y + z * z + w * w - R::ONE).abs();
        demand_at_most(off, ulps(16.0), Requirement::UnitOrientation, input)?;
        self.keeps_fixed_step(step.elapsed, limit, input)?;
        Ok(step)
    }

    /// Checks that a step with a limit above the fixed step takes the fixed step. A method that
    /// spans steps may take a whole number of them, or its limit.
    fn keeps_fixed_step(
        &self,
        elapsed: R,
        limit: R,
        input: impl FnOnce() -> Input,
    ) -> Result<(), Violation> {
        let Some(fixed) = self.integrator.fixed_step().filter(|&fixed| fixed < limit) else {
            return Ok(());
        };
        let steps = if I::SPANS_STEPS && elapsed < limit {
            R::from_whole((elapsed / fixed + R::HALF).whole().into()).at_least(R::ONE)
        } else {
            R::ONE
        };
        let off = (elapsed - steps * fixed).abs();
        let keeps = off <= elapsed * ulps(4.0) || I::SPANS_STEPS && elapsed >= limit;
        demand(keeps, Requirement::FixedStep, elapsed, fixed, input)
    }

    /// Takes steps towards a time that is not a whole number of steps away.
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

    /// Takes the same steps five times: twice with a fresh workspace, once with a workspace used
    /// throughout, once with a copy of that, once with a copy that was cleared. An adaptive method
    /// may take another step with a used workspace.
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
            let (mut fifth, mut cleared) = (state, used.clone());
            self.integrator.clear(&mut cleared);
            let anew = self.step(&mut fifth, limit, number, &mut cleared)?;
            let (once, thrice) = ((&once, &first), (&thrice, &third));
            let same = |requirement, ends| self.demand_same(requirement, ends, (number, limit));
            same(Requirement::SameBits, [(&twice, &second), once])?;
            same(Requirement::SameBits, [(&fourth, &step), thrice])?;
            same(
                Requirement::WorkspaceChangesNothing,
                [(&fifth, &anew), once],
            )?;
            if !I::ADAPTIVE {
                same(Requirement::WorkspaceChangesNothing, [thrice, once])?;
            }
            if number % 3 == 0 {
                // A different step in between.
                let mut other = self.setup.start;
                self.step(&mut other, self.time_step, 0, &mut used)?;
            }
            state = *once.0;
        }
        Ok(())
    }

    /// Checks that two steps of the same number and limit have ended with the same bits.
    fn demand_same(
        &self,
        requirement: Requirement,
        [(end, step), (other, as_in)]: [(&State<R>, &Step<R>); 2],
        (number, limit): (u32, R),
    ) -> Result<(), Violation> {
        let same = end == other && step.elapsed == as_in.elapsed;
        let apart = distance(end, other, self.time_step);
        demand(same, requirement, apart, R::ZERO, || {
            self.input(number, limit)
        })
    }

    /// Checks that without force the centre moves by its velocity times the time that has passed.
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

    /// Checks the order, and that the result tends to the motion of the scene.
    fn converges_to_the_motion(&self) -> Result<(), Violation> {
        let (finest, last_change) = self.converges()?;
        self.agrees(&finest, last_change)
    }

    /// Checks that differences between runs with the whole, half, a quarter ... of the step size
    /// decrease at the stated order. Returns the last result and the last difference, if the method
    /// takes steps of these sizes.
    fn converges(&self) -> Result<(State<R>, Option<R>), Violation> {
        // 2 to the power of (order - 0.3), without the factor for the order.
        let mut least = R::from_f64(0.812_252_396);
        // Larger powers of 2 are not representable.
        for _ in 0..self.integrator.order().min(2048) {
            least *= R::TWO;
        }
        let noise = ulps::<R>(4096.0);
        let mut last = None;
        let mut ratio = None;
        let (mut coarse, mut is_whole) = self.run_in(8)?;
        for steps in [16, 32, 64, 128] {
            let (fine, takes_these) = self.run_in(steps)?;
            is_whole &= takes_these;
            if !is_whole {
                return Ok((fine, None));
            }
            let apart = distance(&coarse, &fine, self.time_step);
            coarse = fine;
            if apart < noise {
                last = Some(apart);
                break;
            }
            ratio = last.map(|before: R| before / apart);
            last = Some(apart);
        }
        if let Some(ratio) = ratio {
            let limit = self.time_step;
            demand_at_least(ratio, least, Requirement::Order, || self.input(0, limit))?;
        }
        Ok((coarse, last))
    }

    /// Checks that a result agrees with that of `Rk4` in much shorter steps.
    fn agrees(&self, finest: &State<R>, last_change: Option<R>) -> Result<(), Violation> {
        let reference = Attempt {
            integrator: &Rk4 {
                time_step: self.time_step,
            },
            setup: self.setup,
            time_step: self.time_step,
        };
        let by_change = last_change.map(|change| change * R::from_f64(4.0) + ulps(8192.0));
        // The error of `Rk4` is below 2e-10 m in 128 steps, and a 256th of that in 512 steps.
        let is_coarse = by_change.is_none_or(|bound| bound > R::from_f64(1e-9));
        let (truth, _) = reference.run_in(if is_coarse { 128 } else { 512 })?;
        let bound = by_change.unwrap_or_else(|| {
            distance(&self.setup.start, &truth, self.time_step) * R::from_f64(0.05)
        });
        let apart = distance(finest, &truth, self.time_step);
        let limit = self.time_step;
        demand_at_most(apart, bound, Requirement::Motion, || self.input(0, limit))
    }

    /// Result after the time of eight of the method's own steps, by steps of at most a share of it.
    /// Returns false with it if the method takes shorter steps.
    fn run_in(&self, steps: u32) -> Result<(State<R>, bool), Violation> {
        let limit = self.time_step * R::from_f64(8.0 / f64::from(steps));
        let (mut state, mut workspace) = (self.setup.start, I::Workspace::default());
        let (mut is_whole, mut number) = (true, 0);
        for _ in 0..steps {
            let mut left = limit;
            while left > limit * rounding_of_time() {
                let input = || self.input(number, left);
                let is_soon = number < 100_000;
                demand(is_soon, Requirement::LandsOnLimit, left, R::ZERO, input)?;
                left -= self.step(&mut state, left, number, &mut workspace)?.elapsed;
                is_whole &= left <= limit * rounding_of_time();
                number += 1;
            }
        }
        Ok((state, is_whole))
    }
}

/// Distance between two states, m: positions, rotations by the displacement of a point at 1 m, and
/// velocities times a time.
fn distance<R: Real>(a: &State<R>, b: &State<R>, seconds: R) -> R {
    let (o, one) = (R::ZERO, R::ONE);
    let [x, y] = [R::Vec3::new(one, o, o), R::Vec3::new(o, one, o)];
    (a.position - b.position).length()
        + (a.world_point(x) - b.world_point(x)).length()
        + (a.world_point(y) - b.world_point(y)).length()
        + (a.linear_velocity - b.linear_velocity).length() * seconds
        + (a.angular_momentum - b.angular_momentum).length() * seconds
}

/// Fraction of a time that counts as rounding after steps were subtracted one by one.
fn rounding_of_time<R: Real>() -> R {
    ulps::<R>(4.0e6).at_most(R::from_f64(1e-4)) * R::TWO
}

#[cfg(test)]
mod tests;
