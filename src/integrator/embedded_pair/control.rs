//! Whether a step is good enough, and how long the next one is tried.

use super::touch::Kinks;
use super::{Place, Settings};
use crate::error::{Quantity, StepError};
use crate::integrator::rk4::Point;
use crate::integrator::{StepControl, step_length};
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, Motion, size};

/// An error of a velocity counts by the way that it makes in this time, s.
const HORIZON: f64 = 1.0;
/// The share of the length that the error would just allow: a step that is turned down costs as
/// much as one that is not.
const SAFETY: f64 = 0.9;
/// The share of the tolerance that one step may take, chosen so that the error of a second of
/// contact is of the size of the tolerance.
const SHARE: f64 = 0.65;
/// A step is at most so much longer, and after a failure at most so much shorter, than the last.
const GROWTH: f64 = 5.0;
const SHRINKAGE: f64 = 0.1;

/// What a step is wrong by, as way of the farthest place of the body, m.
pub(super) struct Errors<R> {
    position: R,
    orientation: R,
    linear_velocity: R,
    angular_momentum: R,
}

impl<R: Real> Errors<R> {
    /// Of a difference of two ends of a step.
    #[inline]
    pub(super) fn of<D: Dynamics<R>>(scene: &D, difference: &Point<R>, motion: &Motion<R>) -> Self {
        let (bounding_radius, horizon) = (size(scene), R::from_f64(HORIZON));
        let spin = scene
            .inertia_properties()
            .angular_velocity(&motion.axes, difference.angular_momentum);
        Self {
            position: difference.position.length(),
            // A turn by an angle moves the quaternion by half of it.
            orientation: difference.orientation.length_squared().sqrt()
                * (R::TWO * bounding_radius),
            linear_velocity: difference.linear_velocity.length() * horizon,
            angular_momentum: spin.length() * (bounding_radius * horizon),
        }
    }

    /// With the errors of the velocities counted by the way that they make in another time, as a
    /// share of [`HORIZON`].
    #[inline]
    pub(super) fn within(self, share: f64) -> Self {
        let share = R::from_f64(share);
        Self {
            linear_velocity: self.linear_velocity * share,
            angular_momentum: self.angular_momentum * share,
            ..self
        }
    }

    #[inline]
    pub(super) fn add_kinks(&mut self, kinks: &Kinks<R>) {
        self.linear_velocity += kinks.velocity * R::from_f64(HORIZON);
    }

    #[inline]
    pub(super) fn total(&self) -> R {
        (self.position + self.orientation) + (self.linear_velocity + self.angular_momentum)
    }

    /// Where most of the error is.
    #[cold]
    pub(super) fn largest(&self) -> Quantity {
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

/// What the estimate of a step may be, m: a share of the tolerance, as the errors of the steps add
/// up, and what rounding does in any case.
#[inline]
pub(super) fn allowed<R: Real, D: Dynamics<R>>(
    settings: &Settings<R>,
    scene: &D,
    motion: &Motion<R>,
) -> R {
    let bounding_radius = size(scene);
    let speed =
        motion.linear_velocity.length() + motion.angular_velocity.length() * bounding_radius;
    let way = motion.position.length() + bounding_radius + speed * R::from_f64(HORIZON);
    settings.tolerance * R::from_f64(SHARE) + way * (R::EPSILON * R::from_f64(16.0))
}

/// The part of a workspace that decides on the next length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Control<R: Real> {
    /// Length that the next step is tried with, s.
    next: Option<R>,
    /// Root of the last step's error as a share of what was allowed; twice as high a root as the
    /// present error's in the rule below.
    last: Option<R>,
    /// Steps tried since the workspace was new.
    attempts: u32,
    /// Time passed since then, s.
    time: R,
}

/// The lengths that are tried for a step.
pub(super) struct Trial<R> {
    /// What the controller proposes, s.
    pub(super) length: R,
    /// To a kink, s; else `None`.
    to_kink: Option<R>,
    /// How often a step to a kink may still be tried.
    kinks_left: u32,
    /// Whether a step was turned down for its length.
    shortened: bool,
}

/// Steps to kinks that are tried for one step: each nearer than the one before.
const KINKS: u32 = 8;

impl<R: Real> Trial<R> {
    /// The length to try, s.
    #[inline]
    pub(super) fn seconds(&self, limit: R) -> R {
        let length = step_length(self.length, limit);
        match self.to_kink {
            Some(to_kink) => length.at_most(to_kink),
            None => length,
        }
    }

    /// Whether a step of this length goes to a kink.
    #[inline]
    pub(super) fn is_to_kink(&self, seconds: R) -> bool {
        self.to_kink.is_some_and(|to_kink| seconds >= to_kink)
    }

    /// After a step of `seconds` with an `error` (as a share of what is allowed) above 1.
    pub(super) fn shorten(&mut self, roots: u32, seconds: R, error: R, kinks: &Kinks<R>) {
        let first_kink = kinks.first.map(|share| share * seconds);
        match first_kink {
            // Most of the error is the kink's: the length may be right.
            Some(to_kink)
                if self.kinks_left > 0 && self.to_kink.is_none_or(|known| to_kink < known) =>
            {
                self.to_kink = Some(to_kink);
                self.kinks_left -= 1;
            }
            _ => {
                let factor = R::from_f64(SAFETY) / root(error, roots);
                // An error that is not a number shrinks the step most.
                let factor = factor.at_least(R::from_f64(SHRINKAGE));
                self.length = seconds * factor.at_most(R::from_f64(SAFETY));
                self.to_kink = None;
                self.shortened = true;
            }
        }
    }
}

impl<R: Real> Control<R> {
    #[inline]
    pub(super) fn carried(&self) -> StepControl<R> {
        StepControl {
            next_step: self.next,
            last_error: self.last,
            orientation: None,
        }
    }

    #[inline]
    pub(super) fn carrying(control: StepControl<R>) -> Self {
        Self {
            next: control.next_step,
            last: control.last_error,
            ..Self::default()
        }
    }

    #[inline]
    pub(super) fn first_trial(&self, first_length: impl FnOnce() -> R) -> Trial<R> {
        Trial {
            length: self.next.unwrap_or_else(first_length),
            to_kink: None,
            kinks_left: KINKS,
            shortened: false,
        }
    }

    /// One more attempt.
    #[inline]
    pub(super) fn spend(&mut self, settings: &Settings<R>) -> Result<(), StepError> {
        if self.attempts >= settings.budget {
            return Err(StepError::BudgetSpent {
                attempts: self.attempts,
                time: self.time.to_f64(),
            });
        }
        self.attempts += 1;
        Ok(())
    }

    #[cold]
    pub(super) fn too_short(&self, settings: &Settings<R>, quantity: Quantity) -> StepError {
        StepError::StepTooShort {
            quantity,
            length: settings.shortest_step().to_f64(),
            time: self.time.to_f64(),
        }
    }

    /// The next length by the rule of a proportional and integral controller (Gustafsson 1991;
    /// Hairer, Nørsett & Wanner, section IV.2): `h' = 0.9 h err^-α err_last^(α/2)`, with α = 1/8
    /// for an estimate of order 5 in the step and 1/4 for one of order 3: just below 0.7 over the
    /// order.
    ///
    /// A step that was cut, by the caller's limit or by a kink, says little about the length of the
    /// next: the proposal stays.
    #[inline]
    pub(super) fn accept(&mut self, roots: u32, trial: &Trial<R>, seconds: R, error: R) {
        self.time += seconds;
        if seconds < trial.length {
            self.next = Some(trial.length);
            return;
        }
        let present = root(error.at_least(R::from_f64(1e-8)), roots);
        let last = self.last.unwrap_or(R::ONE);
        let factor = (R::from_f64(SAFETY) * last / present).at_most(R::from_f64(GROWTH));
        let factor = if trial.shortened {
            factor.at_most(R::ONE)
        } else {
            factor
        };
        self.next = Some(seconds * factor);
        self.last = Some(present.sqrt());
    }
}

/// The 2^times-th root.
#[inline]
fn root<R: Real>(mut value: R, times: u32) -> R {
    for _ in 0..times {
        value = value.sqrt();
    }
    value
}

/// A length for the first step of all, from the state alone.
///
/// With the acceleration A and its rate of change B (both of the farthest place), the motion's own
/// time is A/B, and a method whose estimate goes as the step's power p makes the error
/// `HORIZON B (h B/A)^p/(B/A)²` or so: its p-th root gives h (after Hairer, Nørsett & Wanner,
/// section II.4). B comes from a tiny Euler step.
pub(super) fn first_length<R: Real, D: Dynamics<R>>(
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
