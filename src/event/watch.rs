//! Watch over the events of a run: their values at the last sample, and the search in a step.
//!
//! Let `[a, b]` be the interval between two samples of a step. An event changes its sign in it if
//! the signs at `a` and `b` differ. Otherwise it can change twice. Then the value `y` has an
//! extremum in between: `y y' < 0` at `a` and `y y' > 0` at `b`. The zero of `y'` is located, and
//! if the sign there is another, the first change lies before it.
//!
//! The derivative is that along the rates of the state, `y' = (y(x + δ x') - y(x - δ x'))/2δ`, from
//! one evaluation of the forces. Its error is of the order of δ² times the third derivative of `y`
//! by the state, so the extremum of a height is found far better than to δ. At an end of the
//! interval the value also approaches or departs if it does so over the δ within the interval:
//! a body that starts aligned has its extremum there, with `y' = 0`.
//!
//! A value that is 0 at the start of a run has no sign there. If it departs in the direction
//! opposite to its sign at `b`, a moment at which it still has the sign of its departure is found
//! by halving the interval, and the first change lies before that moment.
//!
//! The earliest change is passed on, and the search continues behind it. So the changes come in the
//! order of time. The state of an occurrence is that at the end of the last bracket, where the
//! value has its new sign. A run that continues there does not find the same change again.

use core::ops::ControlFlow;

use super::root::bracket;
use super::{Event, EventDirection, Occurrence};
use crate::error::StepError;
use crate::observer::Sample;
use crate::real::Real;
use crate::rotation::Rotation;
use crate::scene::Rates;
use crate::state::State;

/// One moment of a step.
#[derive(Clone, Copy)]
pub(crate) struct Instant<R: Real> {
    /// Time since the start of the step, s.
    pub(crate) after: R,
    /// Time since the start of the session, s.
    pub(crate) time: R,
    pub(crate) state: State<R>,
}

/// Path of the body through one step.
pub(crate) trait Path<R: Real> {
    /// Returns the moment at this time after the start of the step, s.
    fn at(&mut self, after: R) -> Result<Instant<R>, StepError>;
    /// Returns the sample at a moment.
    fn sample<'s>(&'s self, instant: &'s Instant<R>) -> Sample<'s, R>;
}

/// How the search in a step has ended.
pub(crate) enum Flow<R: Real> {
    /// The run goes on.
    Continue,
    /// The handler has ended the run at this occurrence, at this time after the start of the step.
    Stop(Occurrence<R>, R),
    /// The event with this index occurs too often.
    Chatter(usize),
}

/// Value of an event at one moment, and its changes shortly before and after.
#[derive(Clone, Copy, Default)]
struct Reading<R> {
    value: R,
    /// Increase up to this moment, and from this moment on.
    increases: [R; 2],
}

impl<R: Real> Reading<R> {
    /// Derivative, in a unit that depends on the step.
    fn slope(&self) -> R {
        let [up_to_here, from_here] = self.increases;
        up_to_here + from_here
    }

    /// Derivative at the start of an interval: the negative one, if there is one, of that at this
    /// moment and that from this moment on. Both are relative to a `side`.
    fn approach(&self, side: R) -> R {
        let [_, from_here] = self.increases;
        (self.slope() * side).at_most(from_here * side)
    }

    /// Derivative at the end of an interval: the positive one, if there is one, of that at this
    /// moment and that up to this moment. Both are relative to a `side`.
    fn departure(&self, side: R) -> R {
        let [up_to_here, _] = self.increases;
        (self.slope() * side).at_least(up_to_here * side)
    }
}

/// What is known of one event at the last sample.
#[derive(Clone, Copy)]
struct Track<R> {
    last: Reading<R>,
    /// Value from which a change counts: 0, or the last number of things.
    reference: R,
    /// Sign of the last value that was not 0, relative to the reference. 0 at the start.
    side: R,
    /// Occurrences in the chosen direction.
    count: u64,
    /// Changes of the sign since the last sample.
    changes: u32,
    /// A bit for each of the last 64 intervals between samples, set if the sign has changed more
    /// often than the interval resolves.
    unresolved: u64,
}

impl<R: Real> Track<R> {
    const NEW: Self = Self {
        last: Reading {
            value: R::ZERO,
            increases: [R::ZERO; 2],
        },
        reference: R::ZERO,
        side: R::ZERO,
        count: 0,
        changes: 0,
        unresolved: 0,
    };

    /// Returns the direction in which a value differs from the last side, if it does.
    #[inline]
    fn change_to(&self, value: R) -> Option<EventDirection> {
        if value > self.reference && self.side <= R::ZERO {
            Some(EventDirection::Rising)
        } else if value < self.reference && self.side >= R::ZERO {
            Some(EventDirection::Falling)
        } else {
            None
        }
    }

    /// Returns true if the value approaches the reference at the last sample and departs from it at
    /// this reading.
    #[inline]
    fn turns_before(&self, reading: &Reading<R>) -> bool {
        self.last.approach(self.side) < R::ZERO && reading.departure(self.side) > R::ZERO
    }

    /// Begins the next interval between samples, which stands for this number of steps.
    fn begin_interval(&mut self, steps: usize) {
        self.changes = 0;
        self.unresolved = u32::try_from(steps)
            .ok()
            .and_then(|steps| self.unresolved.checked_shl(steps))
            .unwrap_or_default();
    }

    /// Notes a change of the sign. An interval that the caller has chosen resolves one, and a step
    /// of the method none if most steps have one.
    fn note_change(&mut self, is_sampled: bool) {
        self.changes += 1;
        if self.changes > u32::from(is_sampled) {
            self.unresolved |= 1;
        }
    }

    fn adopt(&mut self, reading: Reading<R>, is_integer_valued: bool) {
        self.last = reading;
        if is_integer_valued {
            self.reference = reading.value;
        } else if reading.value > R::ZERO {
            self.side = R::ONE;
        } else if reading.value < R::ZERO {
            self.side = -R::ONE;
        }
    }
}

/// The events of a run, and what is known of them.
pub(crate) struct Watch<'e, R: Real, const N: usize> {
    events: [&'e dyn Event<R>; N],
    tracks: [Track<R>; N],
    /// Time by which a state is moved for a derivative, s.
    nudge: R,
    has_begun: bool,
}

impl<'e, R: Real, const N: usize> Watch<'e, R, N> {
    pub(crate) fn new(events: [&'e dyn Event<R>; N]) -> Self {
        Self {
            events,
            tracks: [Track::NEW; N],
            nudge: R::ZERO,
            has_begun: false,
        }
    }

    /// Returns the shortest interval of the events, s.
    pub(crate) fn interval(&self) -> Option<R> {
        let intervals = self.events.iter().filter_map(|event| event.interval());
        intervals.reduce(|first, second| first.at_most(second))
    }

    /// Finds the events of a step from `start` to `end` and passes them to `handle`.
    ///
    /// `spanned` is the number of steps of the method that the step spans.
    pub(crate) fn step(
        &mut self,
        path: &mut dyn Path<R>,
        [start, end]: [&Instant<R>; 2],
        spanned: usize,
        handle: &mut dyn FnMut(&Occurrence<R>) -> ControlFlow<()>,
    ) -> Result<Flow<R>, StepError> {
        self.nudge = end.after * R::from_f64(NUDGE);
        if !self.has_begun {
            let readings = self.read(path, start)?;
            self.adopt(&readings);
            self.has_begun = true;
        }
        let parts = self.parts_of(end.after);
        let mut from = start.after;
        for part in 1..=parts {
            for (event, track) in self.events.iter().zip(&mut self.tracks) {
                if event.interval().is_some() {
                    track.begin_interval(spanned.div_ceil(parts));
                } else if part == 1 {
                    track.begin_interval(spanned);
                }
            }
            let flow = if part == parts {
                self.interval_to(path, from, end, handle)?
            } else {
                let share = R::from_usize(part) / R::from_usize(parts);
                let to = path.at(end.after * share)?;
                let flow = self.interval_to(path, from, &to, handle)?;
                from = to.after;
                flow
            };
            if !matches!(flow, Flow::Continue) {
                return Ok(flow);
            }
        }
        let often = |track: &Track<R>| track.unresolved.count_ones() > OFTEN;
        Ok(self
            .tracks
            .iter()
            .position(often)
            .map_or(Flow::Continue, Flow::Chatter))
    }

    /// Returns the number of intervals between samples in a step of this length.
    fn parts_of(&self, seconds: R) -> usize {
        let Some(interval) = self.interval() else {
            return 1;
        };
        let parts = (seconds / interval).floor_index();
        let is_whole = R::from_usize(parts) * interval >= seconds;
        (if is_whole { parts } else { parts + 1 }).max(1)
    }

    /// Finds the events of an interval from `from` to the moment `end`.
    fn interval_to(
        &mut self,
        path: &mut dyn Path<R>,
        mut from: R,
        end: &Instant<R>,
        handle: &mut dyn FnMut(&Occurrence<R>) -> ControlFlow<()>,
    ) -> Result<Flow<R>, StepError> {
        let at_end = self.read(path, end)?;
        let mut changed = 0;
        for _ in 0..MOST {
            let Some((index, first)) = self.first_change(path, from, end, &at_end)? else {
                self.adopt(&at_end);
                return Ok(Flow::Continue);
            };
            let readings = self.read(path, &first)?;
            let stop = self.deliver(&first, &readings, handle);
            self.adopt(&readings);
            if let Some(occurrence) = stop {
                return Ok(Flow::Stop(occurrence, first.after));
            }
            (from, changed) = (first.after, index);
        }
        Ok(Flow::Chatter(changed))
    }

    /// Returns the earliest change of an event in an interval, with the index of the event.
    fn first_change(
        &self,
        path: &mut dyn Path<R>,
        from: R,
        end: &Instant<R>,
        at_end: &[Reading<R>; N],
    ) -> Result<Option<(usize, Instant<R>)>, StepError> {
        let mut first: Option<(usize, Instant<R>)> = None;
        let watched = self.events.iter().zip(&self.tracks).zip(at_end);
        for (index, ((event, track), at_end)) in watched.enumerate() {
            let search = Search {
                event: *event,
                index,
                track,
                nudge: self.nudge,
            };
            // A later change than the one known is of no interest.
            let found = match &first {
                None => search.change(path, from, end, *at_end)?,
                Some((_, known)) => {
                    let reading = search.read(path, known)?;
                    search.change(path, from, known, reading)?
                }
            };
            first = found.map(|found| (index, found)).or(first);
        }
        Ok(first)
    }

    /// Passes the events that have changed at a moment to `handle`. Returns the first occurrence
    /// that ends the run.
    fn deliver(
        &mut self,
        instant: &Instant<R>,
        readings: &[Reading<R>; N],
        handle: &mut dyn FnMut(&Occurrence<R>) -> ControlFlow<()>,
    ) -> Option<Occurrence<R>> {
        let mut stop = None;
        let watched = self.events.iter().zip(&mut self.tracks).zip(readings);
        for (index, ((event, track), reading)) in watched.enumerate() {
            let Some(direction) = track.change_to(reading.value) else {
                continue;
            };
            track.note_change(event.interval().is_some());
            if !event.direction().includes(direction) {
                continue;
            }
            track.count += 1;
            let occurrence = Occurrence {
                event: index,
                count: track.count,
                direction,
                time: instant.time,
                state: instant.state,
            };
            if handle(&occurrence).is_break() {
                stop = stop.or(Some(occurrence));
            }
        }
        stop
    }

    fn adopt(&mut self, readings: &[Reading<R>; N]) {
        let watched = self.events.iter().zip(&mut self.tracks).zip(readings);
        for ((event, track), reading) in watched {
            track.adopt(*reading, event.is_integer_valued());
        }
    }

    /// Returns value and derivative of each event at a moment.
    fn read(&self, path: &dyn Path<R>, instant: &Instant<R>) -> Result<[Reading<R>; N], StepError> {
        let mut readings = [Reading::default(); N];
        if N == 0 {
            return Ok(readings);
        }
        let around = around(path, instant, self.nudge);
        for (index, (reading, event)) in readings.iter_mut().zip(&self.events).enumerate() {
            *reading = read(path, (index, *event), instant, &around)?;
        }
        Ok(readings)
    }
}

/// Search for a change of one event.
struct Search<'w, R: Real> {
    event: &'w dyn Event<R>,
    index: usize,
    track: &'w Track<R>,
    nudge: R,
}

/// Moment at which a value has the other sign, and the value there.
type Beyond<R> = (Instant<R>, Reading<R>);

/// Why the search for an extremum has ended before it was found.
enum Ended<R: Real> {
    Changed(Instant<R>, Reading<R>),
    Failed(StepError),
}

impl<R: Real> Search<'_, R> {
    fn read(&self, path: &dyn Path<R>, instant: &Instant<R>) -> Result<Reading<R>, StepError> {
        let around = around(path, instant, self.nudge);
        read(path, (self.index, self.event), instant, &around)
    }

    /// Returns the first moment after a change between `from` and `end`, if there is one.
    fn change(
        &self,
        path: &mut dyn Path<R>,
        from: R,
        end: &Instant<R>,
        at_end: Reading<R>,
    ) -> Result<Option<Instant<R>>, StepError> {
        let beyond = match self.track.change_to(at_end.value) {
            Some(_) => Some(match self.soon(path, from, (end, at_end.value))? {
                Some(sooner) => sooner,
                None => (*end, at_end),
            }),
            None if self.track.turns_before(&at_end) => self.beyond(path, from, (end, at_end))?,
            None => None,
        };
        let Some((inner, reading)) = beyond else {
            return Ok(None);
        };
        let change = self.track.change_to(reading.value);
        change
            .map(|direction| self.locate(path, from, (&inner, reading.value), direction))
            .transpose()
    }

    /// Returns a moment at which a value that is 0 at the start of the run has the sign with which
    /// it departs, if it has the other sign at the end of the interval.
    fn soon(
        &self,
        path: &mut dyn Path<R>,
        from: R,
        (end, value): (&Instant<R>, R),
    ) -> Result<Option<Beyond<R>>, StepError> {
        let [_, departing] = self.track.last.increases;
        let has_sign_of = |value: R, other: R| {
            (value > R::ZERO && other > R::ZERO) || (value < R::ZERO && other < R::ZERO)
        };
        if self.track.side != R::ZERO || !has_sign_of(-value, departing) {
            return Ok(None);
        }
        let mut length = (end.after - from) * R::HALF;
        while length > end.after * R::EPSILON {
            let instant = path.at(from + length)?;
            let reading = self.read(path, &instant)?;
            if has_sign_of(reading.value, departing) {
                return Ok(Some((instant, reading)));
            }
            length *= R::HALF;
        }
        Ok(None)
    }

    /// Returns the moment after a change: the far end of the last bracket.
    fn locate(
        &self,
        path: &mut dyn Path<R>,
        from: R,
        (end, value): (&Instant<R>, R),
        direction: EventDirection,
    ) -> Result<Instant<R>, StepError> {
        let sign = if direction == EventDirection::Rising {
            R::ONE
        } else {
            -R::ONE
        };
        let beyond = |value: R| (value - self.track.reference) * sign;
        let mut found = *end;
        let left = [from, beyond(self.track.last.value)];
        let right = [end.after, beyond(value)];
        let tolerance = end.after * (R::EPSILON * R::from_f64(RESOLVED));
        bracket(left, right, tolerance, |after| {
            let instant = path.at(after)?;
            let sample = path.sample(&instant);
            let beyond = beyond(valid((self.index, self.event), &sample)?);
            if beyond > R::ZERO {
                found = instant;
            }
            Ok::<_, StepError>(beyond)
        })?;
        Ok(found)
    }

    /// Returns a moment in the middle of an interval at which the value has changed its sign, if
    /// its extremum has the other sign.
    fn beyond(
        &self,
        path: &mut dyn Path<R>,
        from: R,
        (end, at_end): (&Instant<R>, Reading<R>),
    ) -> Result<Option<Beyond<R>>, StepError> {
        let side = self.track.side;
        let left = [from, self.track.last.approach(side)];
        let right = [end.after, at_end.departure(side)];
        // Near an extremum the value differs by the square of the distance.
        let tolerance = end.after * R::EPSILON.sqrt();
        let extremum = bracket(left, right, tolerance, |after| {
            let instant = path.at(after).map_err(Ended::Failed)?;
            let reading = self.read(path, &instant).map_err(Ended::Failed)?;
            if self.track.change_to(reading.value).is_some() {
                return Err(Ended::Changed(instant, reading));
            }
            Ok(reading.slope() * side)
        });
        match extremum {
            Ok(_) => Ok(None),
            Err(Ended::Changed(instant, reading)) => Ok(Some((instant, reading))),
            Err(Ended::Failed(error)) => Err(error),
        }
    }
}

/// Returns the value of an event, or an error if it is NaN.
fn valid<R: Real>(
    (index, event): (usize, &dyn Event<R>),
    sample: &Sample<'_, R>,
) -> Result<R, StepError> {
    let value = event.value(sample);
    // NaN alone differs from itself.
    if value.partial_cmp(&value).is_some() {
        return Ok(value);
    }
    Err(StepError::BadEvent {
        event: index,
        time: sample.time.to_f64(),
    })
}

/// Returns the value of an event at a moment, and its derivative by the moments around it.
fn read<R: Real>(
    path: &dyn Path<R>,
    (index, event): (usize, &dyn Event<R>),
    instant: &Instant<R>,
    [before, behind]: &[Instant<R>; 2],
) -> Result<Reading<R>, StepError> {
    let value = valid((index, event), &path.sample(instant))?;
    let increases = if event.is_integer_valued() {
        [R::ZERO; 2]
    } else {
        let value_at = |near| valid((index, event), &path.sample(near));
        [value - value_at(before)?, value_at(behind)? - value]
    };
    Ok(Reading { value, increases })
}

/// Returns the moments some seconds before and after another one, with the state moved along its
/// rates.
fn around<R: Real>(path: &dyn Path<R>, instant: &Instant<R>, seconds: R) -> [Instant<R>; 2] {
    let rates = path.sample(instant).rates();
    [-seconds, seconds].map(|seconds| moved(instant, &rates, seconds))
}

fn moved<R: Real>(instant: &Instant<R>, rates: &Rates<R>, seconds: R) -> Instant<R> {
    let state = &instant.state;
    let turn = Rotation::from_rotation_vector(rates.angular_velocity * seconds);
    Instant {
        after: instant.after + seconds,
        time: instant.time + seconds,
        state: State {
            position: state.position + state.linear_velocity * seconds,
            linear_velocity: state.linear_velocity + rates.acceleration * seconds,
            orientation: turn.after(state.rotation()).to_quat(),
            angular_momentum: state.angular_momentum + rates.torque * seconds,
        },
    }
}

/// Width of the last bracket of a change, in units in the last place of its end.
const RESOLVED: f64 = 4.0;

/// Time by which a state is moved for a derivative, as a fraction of the step. Any fraction far
/// below 1 and far above the rounding serves, because only the sign is used.
const NUDGE: f64 = 1.0 / 256.0;

/// Changes in an interval between two samples after which an event counts as chatter.
const MOST: u32 = 1000;

/// Number of the last 64 intervals that do not resolve an event, above which it counts as chatter.
/// An oscillation that changes its sign in every second step is not resolved by the steps.
const OFTEN: u32 = 32;
