//! The clock of a run, and when it has reached the end.

use crate::error::StepError;
use crate::integrator::{Integrator, Step};
use crate::real::Real;
use crate::state::State;

/// Returns [`StepError::BadDuration`] if a duration is negative or not finite.
pub(crate) fn check_duration<R: Real>(seconds: R) -> Result<(), StepError> {
    if seconds >= R::ZERO && seconds.is_finite() {
        return Ok(());
    }
    Err(StepError::BadDuration {
        seconds: seconds.to_f64(),
    })
}

/// Largest number of steps of one length in a run: 2⁵³ in `f64`, 2⁴⁰ in `f32`.
///
/// [`Clock`] rounds each step by at most `EPSILON²/8` of the time. After `1/(64 EPSILON²)` steps
/// this is a 512th of a step. That number is 2⁴⁰ in `f32` and 2⁹⁸ in `f64`. In `f64`, 2⁵³ steps
/// take more than a hundred days at a nanosecond each.
fn most_steps<R: Real>() -> R {
    let resolved = R::ONE / (R::EPSILON * R::EPSILON * R::from_f64(64.0));
    resolved.at_most(R::from_f64(9_007_199_254_740_992.0))
}

/// Returns [`StepError::TooManySamples`] if the interval is too short. It is too short if the
/// sample times are not distinct numbers, or if a run has more than 4·10⁹ samples.
pub(crate) fn check_samples<R: Real>(seconds: R, interval: Option<R>) -> Result<(), StepError> {
    let most = (R::TWO / R::EPSILON).at_most(R::from_f64(4.0e9));
    match interval {
        Some(interval) if seconds > interval * most => Err(StepError::TooManySamples {
            seconds: seconds.to_f64(),
            interval: interval.to_f64(),
            most: most.to_f64(),
        }),
        _ => Ok(()),
    }
}

/// End of a run, with the condition that decides when the run has reached it.
///
/// `N` steps of the number next to `dt` and the number next to `N dt` differ by rounding. The steps
/// contribute at most half a unit in the last place of the step, which is less than one unit of the
/// sum. The duration contributes half a unit.
///
/// A remainder of up to one and a half units therefore counts as zero. A remainder that differs
/// from a whole step by as much counts as a whole step. The clock, rounded to a number, then
/// differs from the duration by at most one unit.
///
/// If a unit is larger than the step, as in `f32` after 2²⁴ steps, the run ends at the nearest
/// whole number of steps.
#[derive(Clone, Copy)]
pub(crate) struct End<R> {
    /// Time since the start of the run, s.
    seconds: R,
    /// Largest remainder that counts as zero, s.
    slack: R,
    /// Step size of a method with a fixed step, s.
    pub(crate) time_step: Option<R>,
}

impl<R: Real> End<R> {
    #[inline]
    pub(super) fn new(seconds: R, time_step: Option<R>) -> Self {
        let slack = last_place(seconds) * R::from_f64(1.5);
        Self {
            seconds,
            slack: time_step.map_or(slack, |step| slack.at_most(step * R::HALF)),
            time_step,
        }
    }

    /// Returns the error of [`check_steps`](Self::check_steps) before the first step of a run,
    /// unless that step may span many.
    #[inline]
    pub(crate) fn check_first_step<I: Integrator<R>>(
        &self,
        clock: &Clock<R>,
    ) -> Result<(), StepError> {
        if I::SPANS_STEPS {
            return Ok(());
        }
        self.check_steps(clock)
    }

    /// Returns the error of [`check_steps`](Self::check_steps) after a step that could span many,
    /// and has spanned one or less.
    #[inline]
    pub(crate) fn check_next_steps<I: Integrator<R>>(
        &self,
        step: &Step<R>,
        clock: &Clock<R>,
    ) -> Result<(), StepError> {
        if I::SPANS_STEPS && self.time_step.is_some_and(|own| step.elapsed <= own) {
            return self.check_steps(clock);
        }
        Ok(())
    }

    /// Returns an error if the rest of the run takes more than [`most_steps`], so that it would not
    /// end.
    pub(crate) fn check_steps(&self, clock: &Clock<R>) -> Result<(), StepError> {
        let left = clock.left(self.seconds);
        match self.time_step {
            Some(time_step) if left > time_step * most_steps() => Err(StepError::TooManySteps {
                seconds: left.to_f64(),
                time_step: time_step.to_f64(),
                most: most_steps::<R>().to_f64(),
            }),
            _ => Ok(()),
        }
    }

    #[inline]
    pub(crate) fn is_reached(&self, clock: &Clock<R>) -> bool {
        clock.left(self.seconds) <= self.slack
    }

    /// Returns true if the clock neither has to go on to this end nor is beyond it.
    #[inline]
    pub(super) fn is_here(&self, clock: &Clock<R>) -> bool {
        clock.left(self.seconds).abs() <= self.slack
    }

    /// Limit of the next step, s.
    #[inline]
    pub(crate) fn limit(&self, clock: &Clock<R>) -> R {
        let left = clock.left(self.seconds);
        match self.time_step {
            Some(step) if (left - step).abs() <= self.slack => step,
            _ => left,
        }
    }

    /// Returns the end of the run if `time` differs from it by at most a unit in the last place,
    /// else `time`. The last of the samples at equal intervals can differ by so much.
    #[inline]
    pub(super) fn or_at(&self, time: R) -> R {
        if (time - self.seconds).abs() <= last_place(self.seconds) {
            self.seconds
        } else {
            time
        }
    }
}

/// One unit in the last place of a non-negative number: the distance to the next larger one.
#[inline]
fn last_place<R: Real>(number: R) -> R {
    // More than half a unit and, apart from rounding, at most one: the sum rounds to the next
    // number.
    let share = R::EPSILON * R::HALF * (R::ONE + R::EPSILON);
    let next = number + number * share;
    if next.is_finite() {
        next - number
    } else {
        // The largest number has no next one. Its unit is that of the numbers below.
        number * R::EPSILON * R::HALF
    }
}

/// Time since the start of a run and the number of steps and evaluations. The time uses Kahan
/// summation: a million steps of 1e-4 s are 100 s to the last place.
///
/// The counts are modulo 2⁶⁴. Steps that are taken do not come so far, but a saved session may have
/// any counts, and those of a body at rest grow by up to 2⁵³ in a call.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub(crate) struct Clock<R> {
    pub(crate) time: R,
    pub(crate) lost: R,
    pub(crate) steps: u64,
    pub(crate) evaluations: u64,
    pub(crate) rejected: u64,
}

impl<R: Real> Clock<R> {
    pub(crate) fn new() -> Self {
        Self {
            time: R::ZERO,
            lost: R::ZERO,
            steps: 0,
            evaluations: 0,
            rejected: 0,
        }
    }

    #[inline]
    pub(crate) fn left(&self, seconds: R) -> R {
        (seconds - self.time) + self.lost
    }

    /// Adds one step. Returns [`StepError::Stalled`] if the clock does not resolve the step,
    /// because the step would then repeat for ever.
    #[inline]
    pub(crate) fn tick(&mut self, step: &Step<R>) -> Result<(), StepError> {
        let corrected = step.elapsed - self.lost;
        // Far below ε² of the time the sum holds no further digits.
        let resolution = self.time * (R::EPSILON * R::EPSILON * R::from_f64(0.25));
        let takes_time = corrected > -self.lost && step.elapsed > resolution;
        if !takes_time {
            return Err(StepError::Stalled);
        }
        let next = self.time + corrected;
        self.lost = (next - self.time) - corrected;
        self.time = next;
        self.steps = self.steps.wrapping_add(1);
        self.evaluations = self.evaluations.wrapping_add(step.evaluations.into());
        self.rejected = self.rejected.wrapping_add(step.rejected.into());
        Ok(())
    }

    /// Adds the step that has led from `before` to `state`, or lets the state go back to `before`
    /// and returns the error of [`tick`](Self::tick).
    #[inline]
    pub(crate) fn tick_from(
        &mut self,
        before: &State<R>,
        state: &mut State<R>,
        step: &Step<R>,
    ) -> Result<(), StepError> {
        self.tick(step).inspect_err(|_| *state = *before)
    }

    /// Returns true if the clock does not overflow before `seconds` have passed.
    #[inline]
    pub(crate) fn resolves(&self, seconds: R) -> bool {
        (self.time + seconds).is_finite()
    }

    /// Returns [`StepError::BadDuration`] if the clock would overflow before `seconds` have passed.
    pub(crate) fn check_duration(&self, seconds: R) -> Result<(), StepError> {
        check_duration(seconds)?;
        if self.resolves(seconds) {
            return Ok(());
        }
        Err(StepError::BadDuration {
            seconds: seconds.to_f64(),
        })
    }

    /// Adds the time and the counts of another clock.
    #[inline]
    pub(crate) fn add(&mut self, other: &Self) {
        self.advance_by(other.time);
        self.advance_by(-other.lost);
        self.steps = self.steps.wrapping_add(other.steps);
        self.evaluations = self.evaluations.wrapping_add(other.evaluations);
        self.rejected = self.rejected.wrapping_add(other.rejected);
    }

    /// Returns the time of this clock with the counts of another one.
    pub(crate) fn with_counts_of(self, other: &Self) -> Self {
        Self {
            time: self.time,
            lost: self.lost,
            ..*other
        }
    }

    /// Counts whole steps of one length that need not be taken, as many as fit before the end.
    /// Returns true if there were any. Each stride is a power of two of such steps, the largest
    /// that fits, so its length is exact.
    #[inline]
    pub(crate) fn skip(&mut self, end: &End<R>, length: R) -> bool {
        let mut left = self.left(end.seconds);
        let skips = left >= length * R::TWO;
        while left >= length * R::TWO {
            let (mut stride, mut count) = (length, 1_u64);
            while stride * R::TWO <= left {
                stride *= R::TWO;
                count *= 2;
            }
            self.advance_by(stride);
            self.steps = self.steps.wrapping_add(count);
            left = self.left(end.seconds);
        }
        skips
    }

    /// Adds seconds by Knuth's two-sum, which is exact whichever number is larger.
    #[inline]
    pub(crate) fn advance_by(&mut self, seconds: R) {
        let corrected = seconds - self.lost;
        let next = self.time + corrected;
        let part = next - self.time;
        self.lost = -((self.time - (next - part)) + (corrected - part));
        self.time = next;
    }
}
