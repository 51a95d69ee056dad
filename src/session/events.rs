//! Runs with events, and the states within a step.

use core::borrow::BorrowMut;
use core::ops::ControlFlow;

use super::{Moment, Rest, Session};
use crate::body::RigidPointBody;
use crate::error::StepError;
use crate::event::{Event, EventEnd, Flow, Instant, Occurrence, Path, Watch};
use crate::force::{Force, NoForce};
use crate::friction::SlidingFriction;
use crate::gravity::Gravity;
use crate::ground::SpringDamperGround;
use crate::integrator::{Integrator, Step};
use crate::observer::Sample;
use crate::real::Real;
use crate::state::State;
use crate::stepper::{Clock, End, Stepper, check_samples};

impl<'a, R, B, G, F, A, I, E, W> Session<'a, B, G, F, A, I, R, E, W>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    A: Gravity<R>,
    I: Integrator<R>,
    E: Force<R>,
    W: BorrowMut<I::Workspace>,
{
    /// Advances the state up to an event, and by at most `seconds`.
    ///
    /// The run ends when one of the events has occurred as often as its [count](Event::count)
    /// states. State and clock of the session are then those of the occurrence. The next call
    /// continues there.
    ///
    /// It also ends, before its time is over, with [`EventEnd::Chatter`]: an event occurs faster
    /// than the steps resolve, as [`Apex`](crate::Apex) and [`Landing`](crate::Landing) do when a
    /// body comes to rest. [`advance`](Self::advance) covers the rest, or a run without that event.
    ///
    /// *Cost* of a body at rest: each step evaluates the events, because their values may depend on
    /// the time. [`advance`](Self::advance) counts all steps of a body at rest at once.
    ///
    /// ```
    /// use tumble::glam::DVec3;
    /// use tumble::{EnergyMomentum, Event, EventEnd, FlatGround, Landing, PointMass, State};
    /// use tumble::{Stepper, UniformGravity};
    ///
    /// let stepper = Stepper::builder(PointMass::new(0.1)) // kg
    ///     .gravity(UniformGravity::down(9.8)) // m/s²
    ///     .ground(FlatGround::level(1e6, 0.0)) // N/m and N s/m
    ///     .integrator(EnergyMomentum { time_step: 1e-4 }) // s
    ///     .build()?;
    /// let mut session = stepper.session(State::at(DVec3::Z)); // m
    /// let end = session.run_until_event(10.0, [&Landing])?; // s
    /// let fall = f64::sqrt(2.0 / 9.8); // s
    /// assert!(matches!(end, EventEnd::Event(landing) if (landing.time - fall).abs() < 1e-12));
    /// assert!(session.state().position.z.abs() < 1e-12);
    /// // Two landings later, each after a contact and a flight of twice the fall.
    /// let end = session.run_until_event(10.0, [&Landing.nth(2)?])?;
    /// assert!(matches!(end, EventEnd::Event(_)));
    /// let contact = core::f64::consts::PI * f64::sqrt(0.1 / 1e6); // s, half a period of the spring
    /// assert!((session.time() - 5.0 * fall - 2.0 * contact).abs() < 3e-5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns the errors of [`run_with_events`](Self::run_with_events).
    pub fn run_until_event<const N: usize>(
        &mut self,
        seconds: R,
        events: [&dyn Event<R>; N],
    ) -> Result<EventEnd<R>, StepError> {
        self.run_with_events(seconds, events, |occurrence| {
            let count = events
                .get(occurrence.event)
                .map_or(1, |event| event.count());
            if occurrence.count >= count {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        })
    }

    /// Advances the state by `seconds` and passes each occurrence of the events to
    /// `handle`, in the order of time.
    ///
    /// If `handle` returns `Break`, the run ends at the occurrence: state and clock of the session
    /// are those of the occurrence. Other events that occur at the same moment are passed on first.
    /// Without `Break` the steps are those of [`advance`](Self::advance), bit by bit. An event that
    /// occurs faster than the steps resolve ends the run before its time is over, with
    /// [`EventEnd::Chatter`].
    ///
    /// *Accuracy:* the moment is located on the path of the method within the step: a step of that
    /// length from the start of the step. The bracket is some units in the last place of the step.
    /// So the error is that of the method. Where a method is exact in flight, it is rounding, below
    /// 1e-12 s in the first seconds. In contact, it has the order of the method.
    ///
    /// *Cost:* each step costs one evaluation of the contact forces and three values of each event,
    /// or one value of an event whose value [is a whole number](Event::is_integer_valued). An
    /// occurrence costs some ten further steps. None of this is included in the counts of steps and
    /// evaluations. A run with no event (`[]`) costs nothing of it.
    ///
    /// ```
    /// use core::ops::ControlFlow;
    /// use tumble::glam::DVec3;
    /// use tumble::{Apex, Event, EventEnd, PointMass, State, Stepper, UniformGravity};
    ///
    /// let stepper = Stepper::new(PointMass::new(0.1))?.with_gravity(UniformGravity::down(9.8))?;
    /// let start = State::at(DVec3::Z).with_linear_velocity(DVec3::Z * 4.9); // m, m/s
    /// let mut session = stepper.session(start);
    /// let mut top = f64::NAN;
    /// let end = session.run_with_events(2.0, [&Apex], |apex| {
    ///     top = apex.state.position.z;
    ///     ControlFlow::Continue(())
    /// })?;
    /// assert_eq!(end, EventEnd::TimeCovered);
    /// assert!((top - 2.225).abs() < 1e-12 && session.time() == 2.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns [`StepError`] if [`advance`](Self::advance) does. Returns [`StepError::BadEvent`] if
    /// the value of an event is NaN, and [`StepError::TooManySamples`] if an
    /// [interval](Event::interval) is too short for the run. State and clock are then those after
    /// the last successful step.
    pub fn run_with_events<const N: usize>(
        &mut self,
        seconds: R,
        events: [&dyn Event<R>; N],
        mut handle: impl FnMut(&Occurrence<R>) -> ControlFlow<()>,
    ) -> Result<EventEnd<R>, StepError> {
        self.clock.check_duration(seconds)?;
        let mut watch = Watch::new(events);
        check_samples(seconds, watch.interval())?;
        self.renew_budget();
        let mut clock = Clock::new();
        let end = self.steps_with_events(seconds, &mut watch, &mut clock, &mut handle);
        self.clock.add(&clock);
        end
    }

    /// Takes one step of the integrator's own size and returns the path within it.
    ///
    /// ```
    /// use tumble::glam::DVec3;
    /// use tumble::{PointMass, Rk4, State, Stepper, UniformGravity};
    ///
    /// let stepper = Stepper::new(PointMass::new(0.1))?
    ///     .with_gravity(UniformGravity::down(10.0))?
    ///     .with_integrator(Rk4 { time_step: 0.1 })?;
    /// let mut session = stepper.session(State::at(DVec3::Z));
    /// let mut step = session.dense_step()?;
    /// let middle = step.state_after(0.05)?; // s after the start of the step
    /// assert!((middle.position.z - 0.9875).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns [`StepError`] if [`step`](Self::step) does.
    pub fn dense_step(&mut self) -> Result<DenseStep<'a, B, G, F, A, I, R, E>, StepError> {
        self.renew_budget();
        let path = self.path(&Clock::new(), self.clock.time, true);
        let step = self.step()?;
        Ok(DenseStep {
            path,
            length: step.elapsed,
            end: self.moment(),
        })
    }

    /// Takes the steps of a run with events.
    fn steps_with_events<const N: usize>(
        &mut self,
        seconds: R,
        watch: &mut Watch<'_, R, N>,
        clock: &mut Clock<R>,
        handle: &mut dyn FnMut(&Occurrence<R>) -> ControlFlow<()>,
    ) -> Result<EventEnd<R>, StepError> {
        let end = self.stepper.end_at(seconds);
        end.check_first_step::<I>(clock)?;
        while !end.is_reached(clock) {
            let mut path = self.path(clock, clock.time, N > 0);
            let step = self.step_of_run(&end, clock)?;
            let ends = [path.start(), path.instant(step.elapsed, self.state)];
            let spanned = (end.time_step).map_or(1, |own| (step.elapsed / own).floor_index());
            let flow = watch.step(&mut path, [&ends[0], &ends[1]], spanned.max(1), handle)?;
            match flow {
                Flow::Continue => {}
                Flow::Stop(occurrence, after) => {
                    let counts = if after < step.elapsed {
                        self.go_back(&path, &occurrence, after)?
                    } else {
                        *clock
                    };
                    *clock = path.run_until(after).with_counts_of(&counts);
                    return Ok(EventEnd::Event(occurrence));
                }
                Flow::Chatter(event) => {
                    *clock = path.run_until(step.elapsed).with_counts_of(clock);
                    let time = ends[1].time;
                    return Ok(EventEnd::Chatter { event, time });
                }
            }
        }
        Ok(EventEnd::TimeCovered)
    }

    /// Takes one step of a run, or counts it if the body is at rest.
    fn step_of_run(&mut self, end: &End<R>, clock: &mut Clock<R>) -> Result<Step<R>, StepError> {
        let limit = end.limit(clock);
        if let Some(length) = self.stepper.whole_step_at_rest(self.rest.step, limit) {
            end.check_steps(clock)?;
            let step = Step::new(length, 0);
            clock.tick(&step)?;
            return Ok(step);
        }
        let before = self.state;
        let step = self.take_step(&before, limit);
        let step = step.map_err(|error| error.at(clock.time.to_f64()))?;
        clock.tick_from(&before, &mut self.state, &step)?;
        self.learn(&before, &step);
        end.check_next_steps::<I>(&step, clock)?;
        Ok(step)
    }

    /// Replaces the last step by its part up to an occurrence. Returns the clock of the run there.
    fn go_back(
        &mut self,
        path: &StepPath<'a, B, G, F, A, I, R, E>,
        occurrence: &Occurrence<R>,
        after: R,
    ) -> Result<Clock<R>, StepError> {
        let mut workspace = path.workspace.clone().unwrap_or_default();
        let (_, part) = path.part(after, &mut workspace)?;
        *self.workspace.borrow_mut() = workspace;
        (self.state, self.rest) = (occurrence.state, Rest::UNKNOWN);
        let mut there = path.run;
        there.add(&part);
        Ok(there)
    }

    /// Returns the path of the step that begins now, at this time of the run. Its errors name the
    /// time `begin`, s. Without a `search` no state within the step is asked for.
    fn path(&self, run: &Clock<R>, begin: R, search: bool) -> StepPath<'a, B, G, F, A, I, R, E> {
        let mut clock = self.clock;
        clock.add(run);
        StepPath {
            stepper: self.stepper,
            state: self.state,
            workspace: (search && self.stepper.chooses_steps())
                .then(|| self.workspace.borrow().clone()),
            scratch: None,
            session: self.clock,
            run: *run,
            clock,
            begin,
        }
    }
}

/// Path of the body through one step, by shorter steps from the start of the step.
struct StepPath<'a, B, G, F, A, I: Integrator<R>, R: Real, E> {
    stepper: &'a Stepper<B, G, F, A, I, R, E>,
    /// State at the start of the step.
    state: State<R>,
    /// Workspace of a method that chooses its steps, at the start of the step.
    workspace: Option<I::Workspace>,
    /// Workspace of any other method, once a moment within the step was evaluated. No result
    /// depends on it. A new one in each step cost `EnergyMomentum` seven times the step.
    scratch: Option<I::Workspace>,
    /// Clock of the session at the start of the run.
    session: Clock<R>,
    /// Clock of the run at the start of the step.
    run: Clock<R>,
    /// Clock of the session at the start of the step.
    clock: Clock<R>,
    /// Time of the start of the step in errors, s.
    begin: R,
}

impl<R, B, G, F, A, I, E> StepPath<'_, B, G, F, A, I, R, E>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    A: Gravity<R>,
    I: Integrator<R>,
    E: Force<R>,
{
    /// Takes the steps from the start of the step to a time within it. Returns the state there, and
    /// the clock of these steps.
    fn part(
        &self,
        after: R,
        workspace: &mut I::Workspace,
    ) -> Result<(State<R>, Clock<R>), StepError> {
        let (mut state, mut clock) = (self.state, Clock::new());
        // A sum of several steps is rounded.
        while clock.left(after) > after * (R::EPSILON * R::HALF) {
            let step = (self.stepper).move_on(&mut state, clock.left(after), workspace);
            let step = step.map_err(|error| error.at((self.begin + clock.time).to_f64()))?;
            clock.tick(&step)?;
        }
        Ok((state, clock))
    }

    /// Clock of the run at a time after the start of the step.
    fn run_until(&self, after: R) -> Clock<R> {
        let mut run = self.run;
        run.advance_by(after);
        run
    }

    /// The time is the sum that the session's clock has if the run ends there, bit by bit.
    fn instant(&self, after: R, state: State<R>) -> Instant<R> {
        let mut clock = self.session;
        clock.add(&self.run_until(after));
        Instant {
            after,
            time: clock.time,
            state,
        }
    }

    fn start(&self) -> Instant<R> {
        self.instant(R::ZERO, self.state)
    }
}

impl<R, B, G, F, A, I, E> Path<R> for StepPath<'_, B, G, F, A, I, R, E>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    A: Gravity<R>,
    I: Integrator<R>,
    E: Force<R>,
{
    fn at(&mut self, after: R) -> Result<Instant<R>, StepError> {
        let mut scratch = match &self.workspace {
            Some(workspace) => workspace.clone(),
            None => self.scratch.take().unwrap_or_default(),
        };
        let (state, _) = self.part(after, &mut scratch)?;
        self.scratch = Some(scratch);
        Ok(self.instant(after, state))
    }

    fn sample<'s>(&'s self, instant: &'s Instant<R>) -> Sample<'s, R> {
        Sample {
            time: instant.time,
            step: self.clock.steps,
            evaluations: self.clock.evaluations,
            rejected: self.clock.rejected,
            state: &instant.state,
            scene: self.stepper.scene(),
        }
    }
}

/// One step of a session, with the states within it: dense output.
///
/// Created by [`Session::dense_step`]. A state within the step is that at the end of a shorter step
/// of the method from the start of the step. So it has the order of the method, and costs a step.
/// It is no part of the run. With [`EnergyMomentum`](crate::EnergyMomentum) its energy never
/// exceeds that at the start of the step, but from one state within the step to a later one the
/// energy may increase. [`Timed`](crate::Timed) passes the states at regular times to an observer.
pub struct DenseStep<'a, B, G, F, A, I: Integrator<R>, R: Real = f64, E = NoForce> {
    path: StepPath<'a, B, G, F, A, I, R, E>,
    length: R,
    end: Moment<R>,
}

impl<R, B, G, F, A, I, E> DenseStep<'_, B, G, F, A, I, R, E>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    A: Gravity<R>,
    I: Integrator<R>,
    E: Force<R>,
{
    /// Returns the moment at the start of the step.
    #[must_use]
    pub fn start(&self) -> Moment<R> {
        Moment {
            time: self.path.clock.time,
            steps: self.path.clock.steps,
            state: self.path.state,
        }
    }

    /// Returns the moment at the end of the step.
    #[must_use]
    pub fn end(&self) -> Moment<R> {
        self.end
    }

    /// Returns the length of the step, s.
    #[must_use]
    pub fn length(&self) -> R {
        self.length
    }

    /// Returns the state at a time after the start of the step, s, from 0 to its
    /// [length](Self::length).
    ///
    /// # Errors
    /// Returns [`StepError::BadTime`] if the time is outside of the step, and the errors of
    /// [`Session::step`].
    pub fn state_after(&mut self, seconds: R) -> Result<State<R>, StepError> {
        if !(seconds >= R::ZERO && seconds <= self.length) {
            return Err(StepError::BadTime {
                seconds: seconds.to_f64(),
                length: self.length.to_f64(),
            });
        }
        if seconds == self.length {
            return Ok(self.end.state);
        }
        self.path.at(seconds).map(|instant| instant.state)
    }
}

impl<R: Real, B, G, F, A, I: Integrator<R>, E> core::fmt::Debug
    for DenseStep<'_, B, G, F, A, I, R, E>
{
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("DenseStep")
            .field("length", &self.length)
            .field("end", &self.end)
            .finish_non_exhaustive()
    }
}
