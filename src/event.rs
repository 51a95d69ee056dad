//! Events: moments of a run at which a function of the state changes sign.
//!
//! [`Session::run_until_event`](crate::Session::run_until_event) ends a run at an event, and
//! [`Session::run_with_events`](crate::Session::run_with_events) passes the events of a run to a
//! closure. Both locate an event within its step.

mod built_in;
mod root;
mod watch;

pub use built_in::{Apex, ContactCloses, ContactOpens, Landing, LiftOff, SlipEnds};
pub(crate) use watch::{Flow, Instant, Path, Watch};

use crate::error::{self, Rule, SceneError};
use crate::observer::Sample;
use crate::real::Real;
use crate::state::State;

/// Event of a run: the moment at which a function of the state changes sign.
///
/// A closure from a sample to a number is an event. Time counts from the start of the session.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Apex, Event, Landing, PointMass, Sample, State, Stepper, UniformGravity};
///
/// let stepper = Stepper::new(PointMass::new(0.1))?.with_gravity(UniformGravity::down(10.0))?;
/// let start = State::at(DVec3::Z).with_linear_velocity(DVec3::Z * 4.0); // m, m/s
/// let mut session = stepper.session(start);
/// let height = |sample: &Sample<'_>| sample.state.position.z - 1.5; // m
/// let end = session.run_until_event(1.0, [&Apex, &height.falling(), &Landing])?;
/// let apex = end.occurrence().ok_or("no event")?;
/// assert_eq!(apex.event, 0);
/// assert!((apex.time - 0.4).abs() < 1e-12);
/// assert!((apex.state.position.z - 1.8).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// *What is found:* the value is compared at both ends of each step. If it changes sign, the moment
/// is located in the step. If it has the same sign at both ends and first approaches 0, then
/// departs from it, its extremum in between is located as well. In this way two changes of sign in
/// one step are found, as of a grazing contact.
///
/// *What is not found:* a third change of sign within a step, and a pair of changes if the value
/// has several extrema in the step. A step of [`Flight`](crate::Flight) may take seconds. For a
/// value that oscillates faster than the steps, see [`sampled_every`](Self::sampled_every). A value
/// that reaches 0 and returns, or stays at 0, is no event.
///
/// *The start:* if the value is 0 at the start of a run, the event occurs as soon as it is not 0,
/// in the direction of that change.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not an event: it does not implement `Event<{R}>`",
    label = "this should be an event",
    note = "implement `value`, or write a closure `|sample: &Sample<'_>| sample.state.position.z`; the precision `{R}` of scene and event must be the same"
)]
pub trait Event<R: Real = f64> {
    /// Returns the value whose change of sign is the event. It must not be NaN.
    ///
    /// The value must depend on the sample only. It is also evaluated at states that are no part of
    /// the run: up to 1/256 of the step before and after a sample, and at trial moments within the
    /// step. Their times do not increase from call to call.
    fn value(&self, sample: &Sample<'_, R>) -> R;

    /// Returns the direction in which the value changes at the event. Default: both.
    #[inline]
    fn direction(&self) -> EventDirection {
        EventDirection::Both
    }

    /// Returns the number of the occurrence that ends
    /// [`run_until_event`](crate::Session::run_until_event). Default: 1.
    #[inline]
    fn count(&self) -> u64 {
        1
    }

    /// Returns true if the value is a whole number, such as a number of contacts. Each change of it
    /// is then the event, in place of each change of sign. Default: false.
    #[inline]
    fn is_integer_valued(&self) -> bool {
        false
    }

    /// Returns the longest interval without a sample, s. Default: `None`, which is a step.
    ///
    /// A run with too short an interval is rejected at once, with
    /// [`TooManySamples`](crate::StepError::TooManySamples).
    #[inline]
    fn interval(&self) -> Option<R> {
        None
    }

    /// Returns the event in one direction: the value becomes positive, or a count increases.
    fn rising(self) -> EventWith<Self, R>
    where
        Self: Sized,
    {
        EventWith {
            direction: EventDirection::Rising,
            ..EventWith::new(self)
        }
    }

    /// Returns the event in one direction: the value becomes negative, or a count decreases.
    fn falling(self) -> EventWith<Self, R>
    where
        Self: Sized,
    {
        EventWith {
            direction: EventDirection::Falling,
            ..EventWith::new(self)
        }
    }

    /// Returns the event with another [count](Self::count): the `number`-th occurrence ends the
    /// run.
    ///
    /// # Errors
    /// Returns [`SceneError`] if `number` is 0.
    fn nth(self, number: u64) -> Result<EventWith<Self, R>, SceneError>
    where
        Self: Sized,
    {
        if number == 0 {
            let quantity = "number of the occurrence";
            return Err(SceneError::new(quantity, Rule::AtLeast(1), 0.0, ""));
        }
        Ok(EventWith {
            count: number,
            ..EventWith::new(self)
        })
    }

    /// Returns the event with samples within each step, at most `seconds` apart.
    ///
    /// Each sample costs a step of the method. Choose half of the shortest time between two
    /// occurrences. Changes of the sign that are further apart than the samples are no
    /// [chatter](EventEnd::Chatter).
    ///
    /// # Errors
    /// Returns [`SceneError`] if `seconds` is not above 0 or not finite. The error names the
    /// quantity, the rule and the value.
    fn sampled_every(self, seconds: R) -> Result<EventWith<Self, R>, SceneError>
    where
        Self: Sized,
    {
        error::above_zero("interval of the samples of an event", seconds, " s")?;
        Ok(EventWith {
            interval: Some(seconds),
            ..EventWith::new(self)
        })
    }
}

impl<R: Real, F: Fn(&Sample<'_, R>) -> R> Event<R> for F {
    #[inline]
    fn value(&self, sample: &Sample<'_, R>) -> R {
        self(sample)
    }
}

/// Event with a direction, a count or an interval that was chosen for a run.
///
/// Created by the methods of [`Event`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EventWith<E, R: Real = f64> {
    event: E,
    direction: EventDirection,
    count: u64,
    interval: Option<R>,
}

impl<R: Real, E: Event<R>> EventWith<E, R> {
    fn new(event: E) -> Self {
        Self {
            direction: event.direction(),
            count: event.count(),
            interval: event.interval(),
            event,
        }
    }
}

impl<R: Real, E: Event<R>> Event<R> for EventWith<E, R> {
    #[inline]
    fn value(&self, sample: &Sample<'_, R>) -> R {
        self.event.value(sample)
    }
    fn direction(&self) -> EventDirection {
        self.direction
    }
    fn count(&self) -> u64 {
        self.count
    }
    fn is_integer_valued(&self) -> bool {
        self.event.is_integer_valued()
    }
    fn interval(&self) -> Option<R> {
        self.interval
    }
}

/// Direction in which the value of an event changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventDirection {
    /// The value increases.
    Rising,
    /// The value decreases.
    Falling,
    /// The value increases or decreases.
    Both,
}

impl EventDirection {
    /// Returns true if an event of this direction includes a change in the other direction.
    #[inline]
    fn includes(self, change: Self) -> bool {
        self == Self::Both || self == change
    }
}

/// One occurrence of an event in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Occurrence<R: Real = f64> {
    /// Index of the event in the array of the run.
    pub event: usize,
    /// Number of this occurrence of the event since the start of the run, from 1.
    pub count: u64,
    /// Direction in which the value changes.
    pub direction: EventDirection,
    /// Time since the start of the session, s.
    pub time: R,
    /// State just after the change: the value has its new sign.
    pub state: State<R>,
}

/// How a run with events has ended.
#[must_use = "a run may have ended before its time"]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EventEnd<R: Real = f64> {
    /// The run has covered its time.
    TimeCovered,
    /// An event ended the run. State and clock of the session are those of the occurrence.
    Event(Occurrence<R>),
    /// An event occurs faster than the steps resolve.
    ///
    /// Its sign changed in more than half of the last 64 steps, or a thousand times in one step. An
    /// event with [samples](Event::sampled_every) of its own counts by intervals between samples,
    /// of which each resolves one change.
    /// Examples are the bounces of a ball whose flights become shorter than a step, and the
    /// rounding error of a velocity at rest. The session is at the end of the last step.
    Chatter {
        /// Index of the event in the array of the run.
        event: usize,
        /// Time since the start of the session, s.
        time: R,
    },
}

impl<R: Real> EventEnd<R> {
    /// Returns the occurrence that ended the run, if one did.
    #[must_use]
    pub fn occurrence(&self) -> Option<&Occurrence<R>> {
        match self {
            Self::Event(occurrence) => Some(occurrence),
            Self::TimeCovered | Self::Chatter { .. } => None,
        }
    }
}
