//! Step size control: acceptance of a step, and the size of the next attempt.

use super::attempt::{Place, Settings};
use super::touch::Discontinuities;
use super::tuning;
use crate::contact::Motion;
use crate::error::{Quantity, StepError};
use crate::integrator::interface::{Step, StepControl, step_length};
use crate::integrator::point::Point;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, size};
use crate::state::State;

/// Time over which an error of a velocity counts as a displacement, s.
pub(in crate::integrator::adaptive) const HORIZON: f64 = 1.0;

/// Errors of a step, as displacement of the farthest point of the body, m.
pub(in crate::integrator::adaptive) struct Errors<R> {
    position: R,
    orientation: R,
    linear_velocity: R,
    angular_momentum: R,
}

impl<R: Real> Errors<R> {
    /// Computes the errors from the difference of two ends of a step.
    #[inline]
    pub(in crate::integrator::adaptive) fn of<D: Dynamics<R>>(
        scene: &D,
        difference: &Point<R>,
        motion: &Motion<R>,
    ) -> Self {
        let (size, horizon) = (size(scene), R::from_f64(HORIZON));
        let spin = scene
            .inertia_properties()
            .angular_velocity(&motion.axes, difference.angular_momentum);
        Self {
            position: difference.position.length(),
            // A rotation by an angle changes the quaternion by half of that angle.
            orientation: difference.orientation.length_squared().sqrt() * (R::TWO * size),
            linear_velocity: difference.linear_velocity.length() * horizon,
            angular_momentum: spin.length() * (size * horizon),
        }
    }

    /// Scales the errors of the velocities to another time than [`HORIZON`], given as a fraction of
    /// it.
    #[inline]
    pub(in crate::integrator::adaptive) fn within(self, share: f64) -> Self {
        let share = R::from_f64(share);
        Self {
            linear_velocity: self.linear_velocity * share,
            angular_momentum: self.angular_momentum * share,
            ..self
        }
    }

    /// Multiplies all errors by a factor.
    #[inline]
    pub(in crate::integrator::adaptive) fn scaled(self, factor: f64) -> Self {
        let factor = R::from_f64(factor);
        Self {
            position: self.position * factor,
            orientation: self.orientation * factor,
            linear_velocity: self.linear_velocity * factor,
            angular_momentum: self.angular_momentum * factor,
        }
    }

    /// Returns the errors of a step whose farthest point is wrong by a rotation (m) and by a
    /// velocity (m/s).
    #[inline]
    pub(in crate::integrator::adaptive) fn of_parts(rotation: R, speed: R) -> Self {
        Self {
            position: R::ZERO,
            orientation: rotation,
            linear_velocity: speed * R::from_f64(HORIZON),
            angular_momentum: R::ZERO,
        }
    }

    /// Adds the errors of another cause.
    #[inline]
    pub(in crate::integrator::adaptive) fn plus(self, other: &Self) -> Self {
        Self {
            position: self.position + other.position,
            orientation: self.orientation + other.orientation,
            linear_velocity: self.linear_velocity + other.linear_velocity,
            angular_momentum: self.angular_momentum + other.angular_momentum,
        }
    }

    /// Returns other errors if their total is more than so many times larger.
    #[inline]
    pub(in crate::integrator::adaptive) fn or_larger(self, other: Self, times: f64) -> Self {
        if other.total() > self.total() * R::from_f64(times) {
            other
        } else {
            self
        }
    }

    #[inline]
    pub(super) fn add_discontinuities(&mut self, discontinuities: &Discontinuities<R>) {
        self.linear_velocity += discontinuities.velocity * R::from_f64(HORIZON);
    }

    #[inline]
    pub(in crate::integrator::adaptive) fn total(&self) -> R {
        (self.position + self.orientation) + (self.linear_velocity + self.angular_momentum)
    }

    /// Returns the quantity with the largest error.
    #[cold]
    pub(in crate::integrator::adaptive) fn largest(&self) -> Quantity {
        let parts = [
            (self.linear_velocity, Quantity::LinearVelocity),
            (self.angular_momentum, Quantity::AngularMomentum),
            (self.orientation, Quantity::Orientation),
        ];
        let mut largest = (self.position, Quantity::Position);
        for part in parts {
            if part.0 > largest.0 {
                largest = part;
            }
        }
        largest.1
    }
}

/// Returns the largest allowed error of a step, m.
///
/// It is a fraction of the tolerance, because the errors of the steps add up, plus the unavoidable
/// rounding.
#[inline]
pub(in crate::integrator::adaptive) fn allowed<R: Real, D: Dynamics<R>>(
    settings: &Settings<R>,
    scene: &D,
    motion: &Motion<R>,
) -> R {
    settings.tolerance * R::from_f64(tuning::TOLERANCE_SHARE) + rounding(scene, motion, HORIZON)
}

/// Returns the error of a step that rounding causes, m. That of the velocity counts for the time
/// `horizon` (s).
#[inline]
pub(in crate::integrator::adaptive) fn rounding<R: Real, D: Dynamics<R>>(
    scene: &D,
    motion: &Motion<R>,
    horizon: f64,
) -> R {
    let size = size(scene);
    let speed = motion.linear_velocity.length() + motion.angular_velocity.length() * size;
    let way = motion.position.length() + size + speed * R::from_f64(horizon);
    way * (R::EPSILON * R::from_f64(16.0))
}

/// Part of a workspace that determines the next step size.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::integrator::adaptive) struct Control<R: Real> {
    /// Proposed size of the next step, s.
    next: Option<R>,
    /// Root of the last step's error relative to the allowed error. Its degree is twice that of the
    /// root of the present error in the rule of [`accept`](Self::accept).
    last: Option<R>,
    /// Number of steps attempted since the workspace was new.
    attempts: u32,
    /// Time advanced since then, s.
    time: R,
    /// Size of the longest step attempted since then, s.
    longest: R,
}

/// Step sizes of the attempts at one step.
pub(in crate::integrator::adaptive) struct TrialSize<R> {
    /// Size proposed by the controller, s.
    pub(in crate::integrator::adaptive) length: R,
    /// Size of a step to a discontinuity, s. `None` if there is none.
    to_discontinuity: Option<R>,
    /// Number of further attempts at a step to a discontinuity.
    steps_left: u32,
    /// True if an attempt was rejected because of its size.
    shortened: bool,
}

impl<R: Real> TrialSize<R> {
    /// Returns the step size to attempt, s.
    #[inline]
    pub(in crate::integrator::adaptive) fn seconds(&self, limit: R) -> R {
        let length = step_length(self.length, limit);
        match self.to_discontinuity {
            Some(to_discontinuity) => length.at_most(to_discontinuity),
            None => length,
        }
    }

    /// Returns true if a step of this size ends at a discontinuity.
    #[inline]
    pub(in crate::integrator::adaptive) fn is_to_discontinuity(&self, seconds: R) -> bool {
        self.to_discontinuity
            .is_some_and(|to_discontinuity| seconds >= to_discontinuity)
    }

    /// Reduces the step size after a step of `seconds` whose `error`, relative to the allowed
    /// error, exceeds 1.
    pub(super) fn shorten(
        &mut self,
        roots: u32,
        seconds: R,
        error: R,
        discontinuities: &Discontinuities<R>,
    ) {
        let first = discontinuities.first.map(|share| share * seconds);
        match first {
            // Most of the error is due to the discontinuity: the step size may be right.
            Some(to_discontinuity)
                if self.steps_left > 0
                    && self
                        .to_discontinuity
                        .is_none_or(|known| to_discontinuity < known) =>
            {
                self.to_discontinuity = Some(to_discontinuity);
                self.steps_left -= 1;
            }
            _ => self.reduce(roots, seconds, error),
        }
    }

    /// Reduces the step size by the `error` of a step of `seconds`, relative to the allowed error.
    pub(in crate::integrator::adaptive) fn reduce(&mut self, roots: u32, seconds: R, error: R) {
        let factor = R::from_f64(tuning::SAFETY) / root(error, roots);
        // An error that is NaN gives the smallest factor.
        let factor = factor.at_least(R::from_f64(tuning::SMALLEST_FACTOR));
        self.length = seconds * factor.at_most(R::from_f64(tuning::SAFETY));
        self.to_discontinuity = None;
        self.shortened = true;
    }
}

impl<R: Real> Control<R> {
    #[inline]
    pub(in crate::integrator::adaptive) fn carried(&self) -> StepControl<R> {
        StepControl {
            next_step: self.next,
            last_error: self.last,
            orientation: None,
        }
    }

    #[inline]
    pub(in crate::integrator::adaptive) fn carrying(control: StepControl<R>) -> Self {
        Self {
            next: control.next_step,
            last: control.last_error,
            ..Self::default()
        }
    }

    /// Returns the first trial of a step: of the size that the previous step proposed, or of
    /// `first_length` s.
    #[inline]
    pub(in crate::integrator::adaptive) fn first_trial(
        &self,
        settings: &Settings<R>,
        first_length: impl FnOnce() -> R,
    ) -> TrialSize<R> {
        let length = self.next.unwrap_or_else(first_length);
        TrialSize {
            length: length.at_most(settings.longest_step),
            to_discontinuity: None,
            steps_left: tuning::STEPS_TO_DISCONTINUITIES,
            shortened: false,
        }
    }

    /// Returns the first trial of a step from a state whose slope is not known.
    pub(in crate::integrator::adaptive) fn first_trial_from<D: Dynamics<R>>(
        &self,
        (scene, state): (&D, &State<R>),
        roots: u32,
        settings: &Settings<R>,
        report: &mut Step<R>,
    ) -> TrialSize<R> {
        self.first_trial(settings, || {
            report.evaluations += 2;
            first_length(roots, settings, scene, &Place::at(scene, Point::of(state)))
        })
    }

    /// Counts one more attempt, and returns its step size, s.
    #[inline]
    pub(in crate::integrator::adaptive) fn next_attempt(
        &mut self,
        settings: &Settings<R>,
        trial: &TrialSize<R>,
        limit: R,
    ) -> Result<R, StepError> {
        self.spend(settings)?;
        let seconds = trial.seconds(limit);
        if seconds <= R::ZERO {
            // The proposed step size has underflowed.
            return Err(self.too_short(Quantity::Position));
        }
        self.longest = self.longest.at_least(seconds);
        Ok(seconds)
    }

    /// Returns true if the next attempt would be shorter than the rounding of the longest one: no
    /// shorter step keeps the tolerance either.
    #[inline]
    pub(in crate::integrator::adaptive) fn gives_up(&self, trial: &TrialSize<R>, limit: R) -> bool {
        trial.seconds(limit) < self.shortest()
    }

    /// Returns the size below which a step is given up, s.
    #[inline]
    fn shortest(&self) -> R {
        self.longest * R::EPSILON
    }

    /// Error of a step that is given up.
    #[cold]
    pub(in crate::integrator::adaptive) fn too_short(&self, quantity: Quantity) -> StepError {
        StepError::StepTooShort {
            quantity,
            length: self.shortest().to_f64(),
            time: self.time.to_f64(),
        }
    }

    #[inline]
    fn spend(&mut self, settings: &Settings<R>) -> Result<(), StepError> {
        if self.attempts >= settings.budget {
            return Err(StepError::BudgetSpent {
                attempts: self.attempts,
                time: self.time.to_f64(),
            });
        }
        self.attempts += 1;
        Ok(())
    }

    /// Sets the next step size after an accepted step.
    ///
    /// The rule is that of a proportional-integral controller (Gustafsson 1991; Hairer, Nørsett &
    /// Wanner, section IV.2): `h' = 0.9 h err^-α err_last^(α/2)`. α is 1/8 for an estimate of order
    /// 5 in the step size and 1/4 for one of order 3, which is near 0.7 over the order.
    ///
    /// If the caller's limit or a discontinuity has shortened the step, it says little about the
    /// size of the next one. The proposal is then unchanged.
    #[inline]
    pub(in crate::integrator::adaptive) fn accept(
        &mut self,
        roots: u32,
        trial: &TrialSize<R>,
        seconds: R,
        error: R,
    ) {
        self.time += seconds;
        if seconds < trial.length {
            self.next = Some(trial.length);
            return;
        }
        let present = root(error.at_least(R::from_f64(1e-8)), roots);
        let last = self.last.unwrap_or(R::ONE);
        let factor = (R::from_f64(tuning::SAFETY) * last / present)
            .at_most(R::from_f64(tuning::LARGEST_GROWTH));
        let factor = if trial.shortened {
            factor.at_most(R::ONE)
        } else {
            factor
        };
        self.next = Some(seconds * factor);
        self.last = Some(present.sqrt());
    }
}

/// Returns the 2^times-th root.
#[inline]
fn root<R: Real>(mut value: R, times: u32) -> R {
    for _ in 0..times {
        value = value.sqrt();
    }
    value
}

/// Returns the size of the very first step, from the state alone, s.
///
/// A is the acceleration of the farthest point and B its rate of change, which follows from a tiny
/// Euler step. The time scale of the motion is A/B. A method whose estimate is of order p in the
/// step size `h` has an error of about `HORIZON B (h B/A)^p/(B/A)²`. Its p-th root gives h (after
/// Hairer, Nørsett & Wanner, section II.4).
pub(in crate::integrator::adaptive) fn first_length<R: Real, D: Dynamics<R>>(
    roots: u32,
    settings: &Settings<R>,
    scene: &D,
    start: &Place<R>,
) -> R {
    let strength = |slope: &Point<R>, motion: &Motion<R>| {
        let errors = Errors::of(scene, slope, motion);
        errors.linear_velocity + errors.angular_momentum
    };
    let acceleration = strength(&start.slope, &start.motion);
    let nudge = settings
        .longest_step
        .at_most(settings.tolerance / acceleration);
    let ahead = start.point.plus(&start.slope, nudge).slope(scene);
    let change = strength(&ahead.plus(&start.slope, -R::ONE), &start.motion) / nudge;
    let rate = change / acceleration;
    let share = settings.tolerance * rate * rate / change;
    let length = root(share, roots) / rate;
    if length < settings.longest_step {
        length.at_least(nudge)
    } else {
        settings.longest_step
    }
}
