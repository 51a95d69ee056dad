//! Session: one state that is advanced in time, with its clock and the data kept from step to step.

mod events;

pub use events::DenseStep;

use core::borrow::BorrowMut;

use crate::body::RigidPointBody;
use crate::energy::Energy;
use crate::error::{self, Rule, SceneError, StepError};
use crate::force::{Force, NoForce};
use crate::friction::{Frictionless, SlidingFriction};
use crate::gravity::{Gravity, NoGravity};
use crate::ground::{NoGround, SpringDamperGround};
use crate::integrator::{EnergyMomentum, Integrator, Step, StepControl};
use crate::observer::Observer;
use crate::real::Real;
use crate::state::State;
use crate::stepper::{Clock, Stepper, has_bits_of};

/// One state that is advanced in time, with its clock and the data that the integrator keeps
/// between steps.
///
/// Created by [`Stepper::session`]. A session borrows the stepper and owns the state, the
/// integrator's workspace and the clock. Use it to advance one body by many calls, as in a game or
/// a plot. [`Stepper::advance`] starts with a new workspace in each call. Where the stack is small,
/// [`Stepper::session_in`] borrows the workspace, too.
///
/// | | [`Stepper`] | `Session` |
/// |---|---|---|
/// | state | owned by the caller | owned by the session |
/// | time since the start | counted by the caller | [`time`](Self::time) |
/// | next step of an adaptive method | chosen anew in each call | continues |
/// | body at rest, and a fixed step | evaluated in each call | skipped |
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Coin, Coulomb, FlatGround, State, Stepper, UniformGravity};
///
/// let stepper = Stepper::builder(Coin::ring(1.0, 0.5)) // kg, m
///     .gravity(UniformGravity::down(9.8)) // m/s²
///     .ground(FlatGround::level(1000.0, 0.5)) // N/m and N s/m, for each point
///     .friction(Coulomb { coefficient: 0.3, slip_speed: 1e-3 }) // -, m/s
///     .build()?;
/// let mut session = stepper.session(State::at(DVec3::Z)); // m
/// for _ in 0..60 {
///     session.advance(1.0 / 60.0)?; // s, one frame
/// }
/// assert!((session.time() - 1.0).abs() < 1e-15);
/// assert!(session.state().position.z < 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// *Reproducibility.* With a fixed step, each call gives the same bits as the same call of the
/// stepper with the same state. An adaptive method gives the same bits in the first call. It then
/// continues with its own step size. Its budget of steps applies to each call.
///
/// *Rest.* If a step of a fixed size leaves the state unchanged, every further step does too. The
/// session then counts further whole steps without taking them. It also skips an
/// [`advance`](Self::advance) by the same time as before. The exception is [`run`](Self::run): it
/// takes every step, because its observer receives each. Of the adaptive methods,
/// [`AdaptiveEnergyMomentum`](crate::AdaptiveEnergyMomentum) skips steps of the last two sizes
/// itself, and the others take every step. If a body rests for more than 2³⁰ steps of a call and
/// then moves in a shorter last step, the size of that step may differ by rounding.
pub struct Session<
    'a,
    B,
    G = NoGround,
    F = Frictionless,
    A = NoGravity,
    I: Integrator<R> = EnergyMomentum,
    R: Real = f64,
    E = NoForce,
    W = <I as Integrator<R>>::Workspace,
> {
    stepper: &'a Stepper<B, G, F, A, I, R, E>,
    state: State<R>,
    workspace: W,
    clock: Clock<R>,
    rest: Rest<R>,
}

/// Steps that are known to leave the present state unchanged, for a method that is not adaptive.
///
/// A step of such a method is a function of scene, state and step size alone.
#[derive(Clone, Copy, Debug)]
struct Rest<R> {
    /// True if a whole step leaves the state unchanged.
    step: bool,
    /// Duration (s) of an advance that leaves the state unchanged, with the clock counts of that
    /// advance.
    advance: Option<(R, Clock<R>)>,
}

impl<R: Real> Rest<R> {
    const UNKNOWN: Self = Self {
        step: false,
        advance: None,
    };
}

/// Time, number of steps and state at one moment of a session.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "R: serde::Serialize, State<R>: serde::Serialize",
        deserialize = "R: serde::Deserialize<'de>, State<R>: serde::Deserialize<'de>"
    ))
)]
pub struct Moment<R: Real = f64> {
    /// Time since the start of the session, s.
    pub time: R,
    /// Number of steps since the start of the session.
    pub steps: u64,
    /// State at that time.
    pub state: State<R>,
}

/// A session as plain data, from which a run continues with the same bits.
///
/// [`Session::save`] returns it and [`Stepper::resume`] takes it. It contains the state, the clock,
/// and the step size that an adaptive method has chosen for the next step. It does not contain the
/// scene, whose parts are plain data, too. It contains nothing that was evaluated in the scene, so
/// it may be resumed in another one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields),
    serde(bound(
        serialize = "R: serde::Serialize, State<R>: serde::Serialize, StepControl<R>: serde::Serialize",
        deserialize = "R: serde::Deserialize<'de>, State<R>: serde::Deserialize<'de>, \
            StepControl<R>: serde::Deserialize<'de>"
    ))
)]
pub struct SavedSession<R: Real = f64> {
    state: State<R>,
    clock: Clock<R>,
    #[cfg_attr(
        feature = "serde",
        serde(deserialize_with = "crate::integrator::saved::required")
    )]
    control: Option<StepControl<R>>,
}

impl<R: Real> SavedSession<R> {
    /// Returns the state.
    #[must_use]
    pub fn state(&self) -> &State<R> {
        &self.state
    }

    /// Returns the time since the start of the session, s.
    #[must_use]
    pub fn time(&self) -> R {
        self.clock.time
    }

    fn check(&self) -> Result<(), SceneError> {
        error::at_least_zero("time of the saved session", self.clock.time, " s")?;
        let Clock { time, lost, .. } = self.clock;
        // Of a time that a clock has counted, it is at most a unit in the last place.
        let is_rounding = lost.abs() <= time * (R::EPSILON * R::from_f64(4.0));
        if !is_rounding {
            let quantity = "rounding of the saved time";
            return Err(SceneError::new(quantity, Rule::Zero, lost.to_f64(), " s"));
        }
        self.control.map_or(Ok(()), |control| control.check())
    }
}

impl<R, B, G, F, A, I, E> Stepper<B, G, F, A, I, R, E>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    A: Gravity<R>,
    I: Integrator<R>,
    E: Force<R>,
{
    /// Creates a session with this state, at the time 0 s.
    #[must_use]
    pub fn session(&self, state: State<R>) -> Session<'_, B, G, F, A, I, R, E> {
        self.session_with(state, I::Workspace::default())
    }

    /// Creates a session with this state, at the time 0 s, whose workspace is in memory of the
    /// caller. For example, this is a `static` on a device with a small stack.
    ///
    /// The session [clears](Integrator::clear) the workspace first. So it does not matter what the
    /// workspace has been used for before: the bits are those of [`session`](Self::session). Events
    /// and [dense steps](Session::dense_step) need another workspace on the stack.
    ///
    /// ```
    /// use tumble::glam::DVec3;
    /// use tumble::integrator::EnergyMomentumWorkspace;
    /// use tumble::{Coin, FlatGround, State, Stepper, UniformGravity};
    ///
    /// let stepper = Stepper::builder(Coin::ring(1.0, 0.5)) // kg, m
    ///     .gravity(UniformGravity::down(9.8)) // m/s²
    ///     .ground(FlatGround::level(1000.0, 0.5)) // N/m and N s/m, for each point
    ///     .build()?;
    /// let mut memory = EnergyMomentumWorkspace::new();
    /// let mut session = stepper.session_in(&mut memory, State::at(DVec3::Z)); // m
    /// session.advance(1.0)?; // s
    /// let mut own = stepper.session(State::at(DVec3::Z));
    /// own.advance(1.0)?;
    /// assert_eq!(session.state(), own.state());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn session_in<'a>(
        &'a self,
        memory: &'a mut I::Workspace,
        state: State<R>,
    ) -> Session<'a, B, G, F, A, I, R, E, &'a mut I::Workspace> {
        self.integrator().clear(memory);
        self.session_with(state, memory)
    }

    #[inline]
    fn session_with<W>(
        &self,
        state: State<R>,
        workspace: W,
    ) -> Session<'_, B, G, F, A, I, R, E, W> {
        Session {
            stepper: self,
            state,
            workspace,
            clock: Clock::new(),
            rest: Rest::UNKNOWN,
        }
    }

    /// Creates a session that continues a saved one.
    ///
    /// The states have the same bits if scene and integrator are the same. An adaptive method
    /// evaluates the state once more, which increases the count of evaluations by at most one. At
    /// rest any method may evaluate it a few times more.
    ///
    /// In another scene the run continues from the saved state, and everything is evaluated anew.
    /// All that holds for a new session with this state holds. In particular, the energy in the
    /// new scene never increases with [`EnergyMomentum`], from the first step. An adaptive method
    /// proposes the saved step size, which it reduces if the error is too large.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the time or the size of the next step is invalid. The error names
    /// the quantity, the rule and the value. A state that is not finite makes the first step fail.
    pub fn resume(
        &self,
        saved: &SavedSession<R>,
    ) -> Result<Session<'_, B, G, F, A, I, R, E>, SceneError> {
        saved.check()?;
        let mut session = self.session(saved.state);
        session.clock = saved.clock;
        if let Some(control) = saved.control {
            (self.integrator()).set_step_control(&mut session.workspace, control);
        }
        Ok(session)
    }
}

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
    /// Takes one step of the integrator's own size.
    ///
    /// # Errors
    /// Returns [`StepError`] if [`Stepper::step`] does, and [`StepError::Stalled`] if the step is
    /// too short for the clock. State and clock are then unchanged.
    #[inline]
    pub fn step(&mut self) -> Result<Step<R>, StepError> {
        self.step_up_to(R::MAX)
    }

    /// Takes one step of the integrator's own size, or of `limit` seconds if that is less.
    ///
    /// A limit of 0 s returns a step of 0 s and changes nothing. Any other step takes more than
    /// 0 s.
    ///
    /// # Errors
    /// Returns the errors of [`step`](Self::step), and [`StepError::BadLimit`] if `limit` is
    /// negative or NaN. State and clock are then unchanged.
    pub fn step_within(&mut self, limit: R) -> Result<Step<R>, StepError> {
        if limit > R::ZERO {
            return self.step_up_to(limit);
        }
        let error = if limit == R::ZERO {
            self.state.check().err()
        } else {
            Some(StepError::BadLimit {
                seconds: limit.to_f64(),
            })
        };
        error.map_or(Ok(Step::new(R::ZERO, 0)), Err)
    }

    /// Takes one step for a limit that is known to be above 0.
    #[inline]
    fn step_up_to(&mut self, limit: R) -> Result<Step<R>, StepError> {
        let before = self.state;
        let at_rest = self.stepper.whole_step_at_rest(self.rest.step, limit);
        let step = match at_rest {
            Some(length) => Step::new(length, 0),
            None => {
                self.renew_budget();
                let step = self.take_step(&before, limit);
                step.map_err(|error| error.at(self.clock.time.to_f64()))?
            }
        };
        self.clock.tick_from(&before, &mut self.state, &step)?;
        if at_rest.is_none() {
            self.learn(&before, &step);
        }
        Ok(step)
    }

    /// Takes one step from the present state, of which the caller has a copy.
    #[inline]
    fn take_step(&mut self, before: &State<R>, limit: R) -> Result<Step<R>, StepError> {
        let workspace = self.workspace.borrow_mut();
        (self.stepper).move_on_from(before, &mut self.state, limit, workspace)
    }

    /// Advances the state by `seconds`, at least 0, like [`Stepper::advance`].
    ///
    /// # Errors
    /// Returns [`StepError`] if [`Stepper::advance`] does. State and clock are then those after the
    /// last successful step.
    #[inline]
    pub fn advance(&mut self, seconds: R) -> Result<(), StepError> {
        match &self.rest.advance {
            Some((known, counts)) if *known == seconds && self.clock.resolves(seconds) => {
                self.clock.add(counts);
                Ok(())
            }
            _ => self.advance_by(seconds),
        }
    }

    /// Advances the state by `seconds` and passes samples to `observer`, like [`Stepper::run`].
    ///
    /// Returns the time that the run has covered, s. The samples count time and steps from the
    /// start of this run. Each step is taken, also if the body is at rest.
    ///
    /// # Errors
    /// Returns [`StepError`] if [`Stepper::run`] does. State and clock are then those after the
    /// last successful step.
    pub fn run(
        &mut self,
        seconds: R,
        observer: &mut (impl Observer<R> + ?Sized),
    ) -> Result<R, StepError> {
        self.clock.check_duration(seconds)?;
        self.renew_budget();
        let (before, mut clock) = (self.state, Clock::new());
        let (state, workspace) = (&mut self.state, self.workspace.borrow_mut());
        let outcome = (self.stepper).run_with(state, seconds, observer, workspace, &mut clock);
        self.clock.add(&clock);
        if !has_bits_of(&self.state, &before) {
            self.rest = Rest::UNKNOWN;
        }
        outcome.map(|()| clock.time)
    }

    /// Returns an iterator over single steps, with the moment after each step.
    ///
    /// It ends only after an error.
    ///
    /// ```
    /// use tumble::glam::DVec3;
    /// use tumble::{Coin, State, Stepper, UniformGravity};
    ///
    /// let stepper = Stepper::new(Coin::ring(1.0, 0.5))?.with_gravity(UniformGravity::down(9.8))?;
    /// let mut session = stepper.session(State::at(DVec3::Z));
    /// for moment in session.steps() {
    ///     if moment?.state.position.z < 0.0 {
    ///         break;
    ///     }
    /// }
    /// assert!((session.time() - (2.0_f64 / 9.8).sqrt()).abs() < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn steps(&mut self) -> impl Iterator<Item = Result<Moment<R>, StepError>> {
        self.moments(|session| session.step().map(|_| ()))
    }

    /// Returns an iterator over samples at equal intervals (s).
    ///
    /// It ends only after an error. The first item is the present moment. Each further item is the
    /// moment after an [`advance`](Self::advance) by `interval`.
    ///
    /// The session stays at the last sample taken. If a fixed step does not divide the interval,
    /// the last step before each sample is shorter. [`Timed`](crate::Timed) in a [`run`](Self::run)
    /// does not change the steps.
    ///
    /// ```
    /// use tumble::glam::DVec3;
    /// use tumble::{Coin, FlatGround, State, Stepper, UniformGravity};
    ///
    /// let stepper = Stepper::builder(Coin::ring(1.0, 0.5))
    ///     .gravity(UniformGravity::down(9.8))
    ///     .ground(FlatGround::level(1000.0, 0.5))
    ///     .build()?;
    /// let mut session = stepper.session(State::at(DVec3::Z));
    /// let mut heights = Vec::new();
    /// for moment in session.samples(1.0 / 60.0)?.take(61) {
    ///     heights.push(moment?.state.position.z);
    /// }
    /// assert_eq!((heights.len(), heights[0]), (61, 1.0));
    /// assert!((session.time() - 1.0).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns [`SceneError`] if the interval is not above 0 or not finite. The error names the
    /// quantity, the rule and the value.
    pub fn samples(
        &mut self,
        interval: R,
    ) -> Result<impl Iterator<Item = Result<Moment<R>, StepError>>, SceneError> {
        error::above_zero("interval of the samples", interval, " s")?;
        let present = core::iter::once(Ok(self.moment()));
        Ok(present.chain(self.moments(move |session| session.advance(interval))))
    }

    /// Returns an iterator over the moments after each call of `move_on`, up to the first error.
    fn moments(
        &mut self,
        mut move_on: impl FnMut(&mut Self) -> Result<(), StepError>,
    ) -> impl Iterator<Item = Result<Moment<R>, StepError>> {
        let mut has_failed = false;
        core::iter::from_fn(move || {
            if has_failed {
                return None;
            }
            let moved = move_on(self);
            has_failed = moved.is_err();
            Some(moved.map(|()| self.moment()))
        })
    }

    /// Returns time, number of steps and state.
    #[must_use]
    pub fn moment(&self) -> Moment<R> {
        Moment {
            time: self.clock.time,
            steps: self.clock.steps,
            state: self.state,
        }
    }

    /// Returns the state.
    #[inline]
    #[must_use]
    pub fn state(&self) -> &State<R> {
        &self.state
    }

    /// Returns the state for modification, for example by an impulse or to another pose.
    ///
    /// The clock continues. The next step is that of a new session with the changed state.
    pub fn state_mut(&mut self) -> &mut State<R> {
        self.rest = Rest::UNKNOWN;
        if self.stepper.chooses_steps() {
            (self.stepper.integrator()).clear(self.workspace.borrow_mut());
        }
        &mut self.state
    }

    /// Replaces the state. The clock continues.
    ///
    /// The next step is that of a new session with this state.
    pub fn set_state(&mut self, state: State<R>) {
        *self.state_mut() = state;
    }

    /// Applies an impulse (N s, world axes) to the body at a point (m, world axes).
    ///
    /// The next step is that of a new session with the changed state.
    ///
    /// # Errors
    /// Returns [`StepError`] if [`Stepper::apply_impulse`] does.
    pub fn apply_impulse(&mut self, impulse: R::Vec3, point: R::Vec3) -> Result<(), StepError> {
        let mut state = self.state;
        self.stepper.apply_impulse(&mut state, impulse, point)?;
        *self.state_mut() = state;
        Ok(())
    }

    /// Ends the session and returns the state.
    #[must_use]
    pub fn into_state(self) -> State<R> {
        self.state
    }

    /// Returns the stepper.
    #[must_use]
    pub fn stepper(&self) -> &'a Stepper<B, G, F, A, I, R, E> {
        self.stepper
    }

    /// Returns the energy of the state by kind, J.
    #[must_use]
    pub fn energy(&self) -> Energy<R> {
        self.stepper.energy(&self.state)
    }

    /// Returns the time since the start of the session, s.
    #[inline]
    #[must_use]
    pub fn time(&self) -> R {
        self.clock.time
    }

    /// Returns the number of steps since the start of the session, modulo 2⁶⁴.
    #[must_use]
    pub fn step_count(&self) -> u64 {
        self.clock.steps
    }

    /// Returns the number of contact force evaluations since the start of the session, modulo 2⁶⁴.
    #[must_use]
    pub fn evaluation_count(&self) -> u64 {
        self.clock.evaluations
    }

    /// Returns the number of attempts that an adaptive method has rejected since the start of the
    /// session, modulo 2⁶⁴.
    #[must_use]
    pub fn rejected_count(&self) -> u64 {
        self.clock.rejected
    }

    /// Returns the session as plain data, from which [`Stepper::resume`] continues.
    ///
    /// The bits stay if the format keeps them: `serde_json` does with its feature
    /// `float_roundtrip`.
    ///
    /// ```
    /// use tumble::{DormandPrince54, Trial};
    ///
    /// let trial = Trial::<f64>::report(1).ok_or("no such trial")?;
    /// let stepper = trial.stepper(DormandPrince54::new(1e-5))?;
    /// let mut session = stepper.session(trial.state());
    /// session.advance(0.3)?;
    /// let saved = session.save(); // with the feature `serde` it can be written to a file
    /// let mut resumed = stepper.resume(&saved)?;
    /// session.advance(0.3)?;
    /// resumed.advance(0.3)?;
    /// assert_eq!(session.state(), resumed.state());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn save(&self) -> SavedSession<R> {
        SavedSession {
            state: self.state,
            clock: self.clock,
            control: (self.stepper.integrator()).step_control(self.workspace.borrow(), &self.state),
        }
    }

    /// Begins a new budget of steps, so that each call has the budget of a run.
    #[inline]
    fn renew_budget(&mut self) {
        if self.stepper.chooses_steps() {
            let integrator = self.stepper.integrator();
            let workspace = self.workspace.borrow_mut();
            if let Some(control) = integrator.step_control(workspace, &self.state) {
                integrator.set_step_control(workspace, control);
            }
        }
    }

    #[inline(never)]
    fn advance_by(&mut self, seconds: R) -> Result<(), StepError> {
        self.clock.check_duration(seconds)?;
        self.rest.advance = None;
        self.renew_budget();
        let (start, mut clock) = (self.state, Clock::new());
        let (state, workspace) = (&mut self.state, self.workspace.borrow_mut());
        let rests = &mut self.rest.step;
        let outcome = (self.stepper).advance_with((state, rests), seconds, workspace, &mut clock);
        self.clock.add(&clock);
        outcome?;
        if !self.stepper.chooses_steps() && has_bits_of(&self.state, &start) {
            // A repetition of this advance costs no evaluation.
            (clock.evaluations, clock.rejected) = (0, 0);
            self.rest.advance = Some((seconds, clock));
        }
        Ok(())
    }

    /// Updates the knowledge about rest after a step from `before` to the present state.
    #[inline]
    fn learn(&mut self, before: &State<R>, step: &Step<R>) {
        if (self.stepper).learn(before, &self.state, step, &mut self.rest.step) {
            self.rest.advance = None;
        }
    }
}

impl<R: Real, B, G, F, A, I: Integrator<R>, E, W: Clone> Clone
    for Session<'_, B, G, F, A, I, R, E, W>
{
    fn clone(&self) -> Self {
        Self {
            workspace: self.workspace.clone(),
            ..*self
        }
    }
}

impl<R: Real, B, G, F, A, I: Integrator<R>, E, W> core::fmt::Debug
    for Session<'_, B, G, F, A, I, R, E, W>
{
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Session")
            .field("state", &self.state)
            .field("time", &self.clock.time)
            .field("steps", &self.clock.steps)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use crate::error::{SceneError, StepError};
    use crate::integrator::step_length;
    use crate::*;

    /// Moves a body in shorter steps only.
    #[derive(Clone, Copy, Debug)]
    struct Lazy;

    impl Integrator for Lazy {
        type Workspace = ();

        fn step<D: Dynamics>(
            &self,
            _: &D,
            state: &mut State,
            limit: f64,
            (): &mut (),
        ) -> Result<Step, StepError> {
            let elapsed = step_length(1e-3, limit);
            if elapsed < 1e-3 {
                state.position.x += elapsed;
            }
            Ok(Step::new(elapsed, 1))
        }
        fn order(&self) -> u32 {
            1
        }
        fn fixed_step(&self) -> Option<f64> {
            Some(1e-3)
        }
        fn check(&self) -> Result<(), SceneError> {
            Ok(())
        }
    }

    /// A flight of steps that are too short to move the body is one step of closed form, whether
    /// the session has taken single steps of it before or not.
    #[test]
    fn a_flight_too_short_to_move_the_body_is_counted_alike_before_and_after_a_save() {
        let time_step = 1e-123;
        let stepper = Stepper::builder(Coin::ring(1.0, 0.5))
            .ground(FlatGround::level(1e3, 1.0))
            .integrator(Flight(StrangSplitting { time_step }))
            .build()
            .unwrap();
        let start = State::at(glam::DVec3::ONE).with_linear_velocity(glam::DVec3::X);
        let mut session = stepper.session(start);
        session.step().unwrap();
        session.advance(time_step).unwrap();
        assert_eq!(*session.state(), start);
        let mut fresh = stepper.session(*session.state());
        let before = session.step_count();
        session.advance(20.0 * time_step).unwrap();
        fresh.advance(20.0 * time_step).unwrap();
        assert_eq!(session.step_count() - before, fresh.step_count());
    }

    #[test]
    fn a_step_of_no_time_refuses_the_states_that_a_step_refuses() {
        let stepper = Stepper::new(Coin::ring(1.0, 0.5)).unwrap();
        let mut none = State::at(glam::DVec3::Z);
        none.orientation = glam::DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);
        let fast = State::default().with_linear_velocity(glam::DVec3::X * f64::NAN);
        for state in [none, fast] {
            let of_step = stepper.session(state).step().unwrap_err();
            let of_none = stepper.session(state).step_within(0.0).unwrap_err();
            let quantities = [of_none, of_step].map(|error| match error {
                StepError::BadState { quantity, .. } => Some(quantity),
                _ => None,
            });
            assert!(quantities[0].is_some());
            assert_eq!(quantities[0], quantities[1]);
        }
    }

    #[test]
    fn an_impulse_that_is_refused_changes_no_session() {
        let stepper = Stepper::builder(Coin::ring(1.0, 0.5))
            .gravity(UniformGravity::down(9.8))
            .ground(FlatGround::level(1e3, 1.0))
            .integrator(DormandPrince54::new(1e-6))
            .build()
            .unwrap();
        let mut session = stepper.session(State::at(glam::DVec3::Z * 0.4));
        session.advance(0.1).unwrap();
        let saved = session.save();
        let refused = session.apply_impulse(glam::DVec3::X * f64::NAN, glam::DVec3::ZERO);
        assert!(matches!(refused, Err(StepError::BadImpulse { .. })));
        assert_eq!(session.save(), saved);
        session
            .apply_impulse(glam::DVec3::X, glam::DVec3::ZERO)
            .unwrap();
        assert_ne!(session.save(), saved);
    }

    /// A body at rest in contact is known to rest, though the method could span several steps in
    /// flight.
    #[test]
    fn a_step_at_rest_costs_no_evaluation_around_a_closed_form_flight() {
        let stepper = Stepper::builder(Sphere::solid(1.0, 0.1))
            .gravity(UniformGravity::down(9.8))
            .ground(FlatGround::level(1e3, 50.0))
            .integrator(Flight(EnergyMomentum { time_step: 1e-3 }))
            .build()
            .unwrap();
        let mut session = stepper.session(State::at(glam::DVec3::Z * 0.2));
        let came_to_rest = (0..100_000).any(|_| {
            let before = *session.state();
            session.step().unwrap();
            *session.state() == before
        });
        assert!(came_to_rest && stepper.touching(session.state()) > 0);
        assert_eq!(session.step().unwrap().evaluations, 0);
    }

    #[test]
    fn a_body_that_rests_in_whole_steps_alone_moves_in_the_last_one_at_once() {
        let stepper = Stepper::builder(Coin::ring(1.0, 0.5))
            .integrator(Lazy)
            .build()
            .unwrap();
        let mut by_stepper = State::default();
        stepper.advance(&mut by_stepper, 3.1005).unwrap();
        let mut session = stepper.session(State::default());
        session.advance(3.1005).unwrap();
        assert_eq!(*session.state(), by_stepper);
        assert!((by_stepper.position.x - 5e-4).abs() < 1e-12);
        // 10¹² steps, which nobody can count one by one.
        session.advance(1e9 + 5e-4).unwrap();
        let last = session.state().position.x - by_stepper.position.x;
        assert!(last > 0.0 && last < 1e-3, "{last}");
    }

    #[test]
    fn rejected_attempts_are_counted_from_step_to_step() {
        let stepper = Stepper::builder(Coin::ring(1.0, 0.5))
            .gravity(UniformGravity::down(9.8))
            .ground(FlatGround::level(1000.0, 0.5))
            .integrator(BogackiShampine32::new(1e-6))
            .build()
            .unwrap();
        let mut session = stepper.session(State::at(glam::DVec3::Z * 0.51));
        let mut rejected = 0;
        while session.time() < 0.2 {
            rejected += u64::from(session.step().unwrap().rejected);
            assert_eq!(session.rejected_count(), rejected);
        }
        assert!(rejected > 0);
    }
}
