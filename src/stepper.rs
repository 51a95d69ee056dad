//! The stepper: composes a scene and an integrator, and moves states on.

use core::ops::ControlFlow;

use crate::body::RigidPointBody;
use crate::energy::Energy;
use crate::error::{Quantity, SceneError, StepError};
use crate::friction::{Frictionless, SlidingFriction};
use crate::gravity::{Gravity, NoGravity};
use crate::ground::{NoGround, SpringDamperGround};
use crate::integrator::{EnergyMomentum, Integrator, Step};
use crate::observer::{Observer, Sample, SceneQuery};
use crate::real::{Real, Vector};
use crate::scene::{CheckedScene, Dynamics, LowestPoint, Record, Scene};
use crate::stability;
use crate::state::State;

/// Moves the states of one body in one scene on in time.
///
/// [`new`](Self::new) starts in empty space; each `with_*` names one thing that the scene has, and
/// what is not named costs nothing. The state is the caller's, so one stepper serves any number of
/// states, also from several threads.
///
/// Its type names precision, body, ground, friction, gravity and integrator. In a struct of your
/// own, take it from [`mod@crate::f64`] or [`mod@crate::f32`], and name what differs from empty
/// space and from
/// [`EnergyMomentum`]: `tumble::f64::Stepper<Coin, FlatGround, Coulomb, UniformGravity>`.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Coin, Coulomb, FlatGround, State, Stepper, StrangSplitting, UniformGravity};
///
/// let stepper = Stepper::new(Coin::ring(1.0, 0.5))?
///     .with_gravity(UniformGravity::down(9.8))?
///     .with_ground(FlatGround::level(1000.0, 0.5))?
///     .with_friction(Coulomb { coefficient: 0.3, slip_speed: 1e-3 })?
///     .with_integrator(StrangSplitting { time_step: 1e-3 })?;
/// let mut state = State::at(DVec3::Z).with_angular_momentum(DVec3::new(0.3, 1.0, 0.2));
/// let before = stepper.energy(&state).total();
/// stepper.advance(&mut state, 2.0)?;
/// assert!(stepper.energy(&state).total() < before);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepper<R: Real, B, G = NoGround, F = Frictionless, A = NoGravity, I = EnergyMomentum<R>>
{
    scene: Scene<R, B, G, F, A>,
    integrator: I,
}

impl<R: Real, B: RigidPointBody<R>> Stepper<R, B> {
    /// A body in empty space, without gravity, moved on by [`EnergyMomentum`] with a time step of
    /// 1 ms.
    ///
    /// # Errors
    /// Where the body cannot be; names quantity, rule and value.
    pub fn new(body: B) -> Result<Self, SceneError> {
        Ok(Self {
            scene: Scene::new(body, NoGround, Frictionless, NoGravity)?,
            integrator: EnergyMomentum {
                time_step: R::from_f64(1e-3),
            },
        })
    }
}

impl<R, B, G, F, A, I> Stepper<R, B, G, F, A, I>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    A: Gravity<R>,
{
    /// The same with this ground.
    ///
    /// # Errors
    /// Where the ground cannot be; names quantity, rule and value.
    pub fn with_ground<G2: SpringDamperGround<R>>(
        self,
        ground: G2,
    ) -> Result<Stepper<R, B, G2, F, A, I>, SceneError> {
        let (body, _, friction, gravity) = self.scene.into_parts();
        Stepper::compose(body, ground, friction, gravity, self.integrator)
    }

    /// The same with this friction.
    ///
    /// # Errors
    /// Where the friction cannot be; names quantity, rule and value.
    pub fn with_friction<F2: SlidingFriction<R>>(
        self,
        friction: F2,
    ) -> Result<Stepper<R, B, G, F2, A, I>, SceneError> {
        let (body, ground, _, gravity) = self.scene.into_parts();
        Stepper::compose(body, ground, friction, gravity, self.integrator)
    }

    /// The same with this gravity.
    ///
    /// # Errors
    /// Where the gravity is not finite.
    pub fn with_gravity<A2: Gravity<R>>(
        self,
        gravity: A2,
    ) -> Result<Stepper<R, B, G, F, A2, I>, SceneError> {
        let (body, ground, friction, _) = self.scene.into_parts();
        Stepper::compose(body, ground, friction, gravity, self.integrator)
    }

    /// The same moved on by this integrator.
    ///
    /// # Errors
    /// Where the integrator's parameters cannot be; names quantity, rule and value.
    pub fn with_integrator<I2: Integrator<R>>(
        self,
        integrator: I2,
    ) -> Result<Stepper<R, B, G, F, A, I2>, SceneError> {
        integrator.check()?;
        Ok(Stepper {
            scene: self.scene,
            integrator,
        })
    }

    fn compose(
        body: B,
        ground: G,
        friction: F,
        gravity: A,
        integrator: I,
    ) -> Result<Self, SceneError> {
        Ok(Self {
            scene: Scene::new(body, ground, friction, gravity)?,
            integrator,
        })
    }

    /// Body, ground, friction and gravity, for questions about a state.
    #[inline]
    #[must_use]
    pub fn scene(&self) -> &Scene<R, B, G, F, A> {
        &self.scene
    }

    /// The body.
    #[inline]
    #[must_use]
    pub fn body(&self) -> &B {
        self.scene.body()
    }

    /// The integrator.
    #[inline]
    #[must_use]
    pub fn integrator(&self) -> &I {
        &self.integrator
    }

    /// The same state, with the angular momentum that the body, turned as it is there, has at this
    /// angular velocity (rad/s, world axes): `L = J ω`.
    ///
    /// A [`State`] holds the angular momentum, which is what stays in flight; what is known of a
    /// throw is mostly how fast it turns. `state.orientation * vector` takes a vector of body axes
    /// to world axes.
    ///
    /// ```
    /// use tumble::glam::DVec3;
    /// use tumble::{Coin, State, Stepper};
    ///
    /// let stepper = Stepper::new(Coin::ring(1.0, 0.5))?; // kg, m; its normal is body x
    /// let state = State::at(DVec3::Z).with_rotation_vector(DVec3::Y * 0.3); // rad
    /// let state = stepper.with_angular_velocity(state, state.orientation * DVec3::X * 8.0); // rad/s about its normal
    /// assert!((state.angular_momentum.length() - 1.0 * 0.5 * 0.5 * 8.0).abs() < 1e-12); // m r² ω
    /// assert!((stepper.angular_velocity(&state).length() - 8.0).abs() < 1e-12);
    /// # Ok::<(), tumble::SceneError>(())
    /// ```
    #[must_use]
    pub fn with_angular_velocity(&self, state: State<R>, angular_velocity: R::Vec3) -> State<R> {
        let axes = state.rotation().axes();
        let masses = self.scene.inertia_properties();
        state.with_angular_momentum(masses.angular_momentum(&axes, angular_velocity))
    }

    /// Gives the body an impulse `J` (N s, world axes) at a point `p` of the world (m), which need
    /// not be a point of the body.
    ///
    /// The velocity of the centre of mass `x` changes by `J/m`, and the angular momentum about it
    /// by `(p - x) × J`. A body without a moment about an axis takes no angular momentum about it.
    ///
    /// ```
    /// use tumble::glam::DVec3;
    /// use tumble::{Rod, State, Stepper};
    ///
    /// // A rod of 1.2 m along z, hit 0.2 m above its middle: its lower end does not move at first.
    /// let stepper = Stepper::new(Rod::new(0.5, 1.2))?; // kg, m
    /// let mut state = State::at(DVec3::Z); // m
    /// stepper.apply_impulse(&mut state, DVec3::X * 3.0, DVec3::Z * 1.2)?; // N s, m
    /// let arm = DVec3::Z * -0.6; // m
    /// let end = state.linear_velocity + stepper.angular_velocity(&state).cross(arm);
    /// assert!(end.length() < 1e-14); // m/s
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns [`StepError::BadImpulse`] if the impulse or the point is not finite, or if the
    /// motion after it is not. Returns [`StepError::BadState`] if the state is not finite. The
    /// state is left as it was.
    pub fn apply_impulse(
        &self,
        state: &mut State<R>,
        impulse: R::Vec3,
        point: R::Vec3,
    ) -> Result<(), StepError> {
        if let Some(quantity) = state.not_finite() {
            return Err(StepError::BadState(quantity));
        }
        let finite = |quantity, value: R| {
            let value = value.to_f64();
            let is_finite = value.is_finite();
            is_finite
                .then_some(())
                .ok_or(StepError::BadImpulse { quantity, value })
        };
        finite("x of the impulse", impulse.x())?;
        finite("y of the impulse", impulse.y())?;
        finite("z of the impulse", impulse.z())?;
        finite("x of the impulse's point", point.x())?;
        finite("y of the impulse's point", point.y())?;
        finite("z of the impulse's point", point.z())?;
        let masses = self.scene.inertia_properties();
        let momentum = state.angular_momentum + (point - state.position).cross(impulse);
        let momentum = masses.without_dead_spin(state.rotation(), momentum);
        let velocity = state.linear_velocity + impulse * masses.inverse_mass();
        if !velocity.is_finite() {
            finite("speed after an impulse", velocity.length())?;
        }
        if !momentum.is_finite() {
            finite("spin after an impulse", momentum.length())?;
        }
        (state.linear_velocity, state.angular_momentum) = (velocity, momentum);
        Ok(())
    }

    /// Angular velocity of the body, rad/s, world axes: `ω = J⁻¹ L`.
    #[must_use]
    pub fn angular_velocity(&self, state: &State<R>) -> R::Vec3 {
        self.scene.motion(state).angular_velocity
    }

    /// Energy of a state, by kind, J.
    #[must_use]
    pub fn energy(&self, state: &State<R>) -> Energy<R> {
        Energy::of(&self.scene, state)
    }

    /// The lowest point of the body and its slip; `None` for a body without contacts.
    #[must_use]
    pub fn lowest_point(&self, state: &State<R>) -> Option<LowestPoint<R>> {
        self.scene.lowest_point(state)
    }

    /// Velocity of the body's material at its lowest point, along the ground, m/s, world axes;
    /// `None` for a body without contacts.
    #[must_use]
    pub fn slip_velocity(&self, state: &State<R>) -> Option<R::Vec3> {
        Some(self.lowest_point(state)?.slip)
    }

    /// How many contacts touch the ground.
    #[must_use]
    pub fn touching(&self, state: &State<R>) -> usize {
        self.scene.touching(state)
    }
}

impl<R, B, G, F, A, I> Stepper<R, B, G, F, A, I>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    A: Gravity<R>,
    I: Integrator<R>,
{
    /// Largest step (s) for which the integrator is stable on the contacts that touch at a state.
    /// `None` if there is no bound: an implicit or adaptive integrator, a body in flight, or a
    /// state that is not finite.
    ///
    /// It follows from the stiffness, the damping and the friction of all contacts together, with
    /// their arms and the body's inertia. Every shorter step is stable too. A longer one can make
    /// small errors grow until the energy does. 0 if no step is stable, as for
    /// [`ForwardEuler`](crate::ForwardEuler) on springs without dampers. The integrator's own step
    /// size does not matter.
    ///
    /// *Limits:* the bound belongs to this state. It falls when more contacts touch, when the body
    /// leans, when a slip ends (a contact that sticks is a damper of `μ N/slip_speed`), and with
    /// the depth if the contact law stiffens. For a run, take the least value along it, as below; a
    /// body in flight has none. Rotation is not part of it: in contact a step should turn the body
    /// by much less than 1 rad. It is proven for contacts that stick or slide, not for a slip near
    /// the slip speed. With [`Nystrom`](crate::Nystrom), friction can make it up to 10 % too long.
    /// It costs some ten thousand multiplications, so that it is not for each step.
    ///
    /// ```
    /// use core::ops::ControlFlow;
    /// use tumble::f64::{Rk4, Sample, Trial};
    ///
    /// let trial = Trial { slip_speed: 1e-2, ..Trial::report(1).ok_or("no such trial")? };
    /// let stepper = trial.stepper(Rk4 { time_step: 1e-3 })?;
    /// let (mut state, mut least) = (trial.state(), f64::MAX);
    /// stepper.run(&mut state, 0.5, &mut |sample: &Sample<'_>| {
    ///     let limit = stepper.largest_stable_step(sample.state);
    ///     least = least.min(limit.unwrap_or(f64::MAX));
    ///     ControlFlow::Continue(())
    /// })?;
    /// assert!(least > 1e-3, "the step of 1 ms is too long for a limit of {least} s");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn largest_stable_step(&self, state: &State<R>) -> Option<R> {
        stability::largest_stable_step(&self.scene, state, |stiffness, damping| {
            self.integrator.largest_stable_step(stiffness, damping)
        })
    }

    /// One step of the integrator's own length.
    ///
    /// # Errors
    /// Where the state is not finite, before or after; the state is left as it was.
    #[inline]
    pub fn step(&self, state: &mut State<R>) -> Result<Step<R>, StepError> {
        self.move_on(state, R::MAX, &mut I::Workspace::default())
    }

    /// One step of the integrator's own length, or of `limit` seconds where that is less, with a
    /// workspace that the caller keeps from step to step.
    ///
    /// A limit of 0 s returns a step of 0 s and leaves the state at its time. Any other step takes
    /// more than 0 s.
    ///
    /// # Errors
    /// As [`step`](Self::step), and [`StepError::BadLimit`] if `limit` is below 0 or NaN.
    #[inline]
    pub fn step_within(
        &self,
        state: &mut State<R>,
        limit: R,
        workspace: &mut I::Workspace,
    ) -> Result<Step<R>, StepError> {
        if limit >= R::ZERO {
            self.move_on(state, limit, workspace)
        } else {
            Err(StepError::BadLimit {
                seconds: limit.to_f64(),
            })
        }
    }

    /// As [`step_within`](Self::step_within), with a limit that is known to be at least 0.
    #[inline]
    pub(crate) fn move_on(
        &self,
        state: &mut State<R>,
        limit: R,
        workspace: &mut I::Workspace,
    ) -> Result<Step<R>, StepError> {
        if !self.scene.is_trusted() {
            return self.move_on_checked(state, limit, workspace);
        }
        let before = *state;
        let step = self.integrator.step(&self.scene, state, limit, workspace);
        let error = match (step, state.not_finite()) {
            (Ok(step), None) if step.elapsed > R::ZERO || limit <= R::ZERO => return Ok(step),
            (Ok(_), None) => StepError::Stalled,
            (Ok(_), Some(quantity)) => blame(&before, quantity),
            // What is wrong with a state shows in its energy, too.
            (Err(error), _) => before.not_finite().map_or(error, StepError::BadState),
        };
        *state = before;
        Err(error)
    }

    /// As [`move_on`](Self::move_on), with a check of every value that a law returns.
    // A function of its own: where the laws are trusted, nothing of it is left in the program.
    #[inline(never)]
    fn move_on_checked(
        &self,
        state: &mut State<R>,
        limit: R,
        workspace: &mut I::Workspace,
    ) -> Result<Step<R>, StepError> {
        let before = *state;
        let record = Record::new();
        let scene = CheckedScene::of(&self.scene, &record);
        match self.integrator.step(&scene, state, limit, workspace) {
            Ok(step)
                if record.is_empty()
                    && state.not_finite().is_none()
                    && (step.elapsed > R::ZERO || limit <= R::ZERO) =>
            {
                Ok(step)
            }
            outcome => self.examined(outcome, limit, (&before, state), &record, workspace),
        }
    }

    /// What a step leads to that has failed, or during which a value broke a contract: its outcome
    /// where rounding explains the value, else an error and the state from before.
    #[cold]
    #[inline(never)]
    fn examined(
        &self,
        outcome: Result<Step<R>, StepError>,
        limit: R,
        (before, state): (&State<R>, &mut State<R>),
        record: &Record<R>,
        workspace: &mut I::Workspace,
    ) -> Result<Step<R>, StepError> {
        let broken_law = broken_law(&self.scene, before, record);
        let error = match (broken_law, outcome, state.not_finite()) {
            (None, Ok(step), None) if step.elapsed > R::ZERO || limit <= R::ZERO => {
                return Ok(step);
            }
            (None, Ok(_), None) => StepError::Stalled,
            (Some(error), _, _) => {
                // It may know of a state that no longer holds.
                *workspace = I::Workspace::default();
                error
            }
            (None, Ok(_), Some(quantity)) => blame(before, quantity),
            (None, Err(error), _) => before.not_finite().map_or(error, StepError::BadState),
        };
        *state = *before;
        Err(error)
    }

    /// Moves a state on by exactly `seconds`, at least 0.
    ///
    /// The time that has passed differs from `seconds` by at most one unit in its last place. It
    /// differs only where a whole number of steps is kept whole: ten steps of 0.1 s and an advance
    /// by 1 s have the same bits. In `f32` this holds up to 2²⁶ steps; beyond that the clock may be
    /// wrong by one more unit for each 2²⁶ steps.
    ///
    /// # Errors
    /// As [`step`](Self::step). Returns [`StepError::BadDuration`] if `seconds` is negative or not
    /// finite, and [`StepError::TooManySteps`] if steps of the integrator's length would be more
    /// than 2⁵³ (2⁴⁰ in `f32`). The state is that after the last good step.
    pub fn advance(&self, state: &mut State<R>, seconds: R) -> Result<(), StepError> {
        self.run(state, seconds, &mut ())?;
        Ok(())
    }

    /// Moves a state on by exactly `seconds` and shows it to `observer` at the start and after each
    /// step. Returns the time that the run has covered, s: less than `seconds` where the observer
    /// ended it.
    ///
    /// # Errors
    /// As [`advance`](Self::advance). Returns [`StepError::TooManySamples`] if the observer's
    /// [interval](Observer::interval) asks for more than 4·10⁹ samples (2²⁴ in `f32`, whose numbers
    /// tell no more apart), and [`StepError::Stalled`] if an integrator takes no time for a step.
    pub fn run(
        &self,
        state: &mut State<R>,
        seconds: R,
        observer: &mut (impl Observer<R> + ?Sized),
    ) -> Result<R, StepError> {
        let mut clock = Clock::new();
        let mut workspace = I::Workspace::default();
        self.run_with(state, seconds, observer, &mut workspace, &mut clock)?;
        Ok(clock.time)
    }

    /// As [`run`](Self::run), with the caller's workspace and a new clock, which shows what was
    /// done after an error as well.
    #[inline]
    pub(crate) fn run_with(
        &self,
        state: &mut State<R>,
        seconds: R,
        observer: &mut (impl Observer<R> + ?Sized),
        workspace: &mut I::Workspace,
        clock: &mut Clock<R>,
    ) -> Result<(), StepError> {
        check_duration(seconds)?;
        check_samples(seconds, observer.interval())?;
        let end = self.end_at(seconds);
        if !I::SPANS_STEPS {
            end.check_steps(clock)?;
        }
        let mut flow = self.show(observer, state, clock);
        while flow.is_continue() && !end.is_reached(clock) {
            // Whoever asks for times between the steps is led there from the step's start.
            let before = observer.asks_for().map(|_| Before {
                clock: *clock,
                state: *state,
                workspace: I::ADAPTIVE.then(|| workspace.clone()),
            });
            let step = self.move_on(state, end.limit(clock), workspace)?;
            clock.tick(&step)?;
            if I::SPANS_STEPS && end.time_step.is_some_and(|own| step.elapsed <= own) {
                end.check_steps(clock)?;
            }
            if let Some(before) = before {
                flow = self.show_between(observer, &end, &before, state, clock)?;
            }
            if flow.is_continue() {
                flow = self.show(observer, state, clock);
            }
        }
        Ok(())
    }

    /// The states at the times that are asked for, from the start of a step to its end.
    fn show_between(
        &self,
        observer: &mut (impl Observer<R> + ?Sized),
        end_of_run: &End<R>,
        before: &Before<R, I::Workspace>,
        end: &State<R>,
        clock: &Clock<R>,
    ) -> Result<ControlFlow<()>, StepError> {
        let mut last = None;
        while let Some(time) = observer.asks_for() {
            let asked = self.end_at(end_of_run.or_at(time));
            // A time that is asked for twice would be so for ever.
            if !asked.is_reached(clock) || last == Some(time) {
                break;
            }
            last = Some(time);
            let state = if clock.left(asked.seconds).abs() <= asked.slack {
                *end
            } else {
                self.state_at(&asked, before)?
            };
            let sample = Sample {
                time,
                ..self.sample(&state, clock)
            };
            if observer.observe_asked(&sample).is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// The state at a time after the start of a step, by steps of its own.
    fn state_at(
        &self,
        asked: &End<R>,
        before: &Before<R, I::Workspace>,
    ) -> Result<State<R>, StepError> {
        let (mut state, mut clock) = (before.state, before.clock);
        let mut workspace = before.workspace.clone().unwrap_or_default();
        while !asked.is_reached(&clock) {
            let step = self.move_on(&mut state, asked.limit(&clock), &mut workspace)?;
            clock.tick(&step)?;
        }
        Ok(state)
    }

    #[inline]
    pub(crate) fn end_at(&self, seconds: R) -> End<R> {
        End::new(seconds, self.integrator.fixed_step())
    }

    #[inline]
    fn show(
        &self,
        observer: &mut (impl Observer<R> + ?Sized),
        state: &State<R>,
        clock: &Clock<R>,
    ) -> ControlFlow<()> {
        observer.observe(&self.sample(state, clock))
    }

    #[inline]
    fn sample<'a>(&'a self, state: &'a State<R>, clock: &Clock<R>) -> Sample<'a, R> {
        Sample {
            time: clock.time,
            step: clock.steps,
            evaluations: clock.evaluations,
            rejected: clock.rejected,
            state,
            scene: &self.scene,
        }
    }
}

/// Refuses a duration that is negative or not finite.
pub(crate) fn check_duration<R: Real>(seconds: R) -> Result<(), StepError> {
    if seconds >= R::ZERO && seconds.is_finite() {
        return Ok(());
    }
    Err(StepError::BadDuration {
        seconds: seconds.to_f64(),
    })
}

/// Whether a step that went wrong was handed something wrong.
#[cold]
fn blame<R: Real>(before: &State<R>, after: Quantity) -> StepError {
    if let Some(quantity) = before.not_finite() {
        return StepError::BadState(quantity);
    }
    if before.rotation().is_a_turn() {
        StepError::Diverged(after)
    } else {
        StepError::BadState(Quantity::Orientation)
    }
}

/// The value that has broken the contract of a law during a step from the state `before`.
///
/// A spring energy below 0 may be rounding: of the body's energy, which hides it, or of the terms
/// of the law's own formula. `e^x - 1 - x` is off by some rounding of 1 at every x. Those terms are
/// taken to be as large as the energy at a depth of 1 m.
fn broken_law<R: Real>(
    scene: &impl Dynamics<R>,
    before: &State<R>,
    record: &Record<R>,
) -> Option<StepError> {
    if record.is_empty() {
        return None;
    }
    let energy = Energy::of(scene, before);
    let terms = energy.translation
        + energy.rotation
        + energy.gravity.abs()
        + energy.springs.abs()
        + energy_at_a_metre(scene.ground());
    let rounding = terms * (R::EPSILON * R::from_f64(LAW_ROUNDING));
    let (quantity, value) = record.violation(rounding)?;
    Some(StepError::BrokenLaw {
        quantity,
        value: value.to_f64(),
    })
}

/// Units in the last place of all terms below which a negative spring energy counts as rounding.
const LAW_ROUNDING: f64 = 8.0;

/// Energy in the springs under a contact at a depth of 1 m, J; at the largest binary fraction of it
/// where the energy is finite. At least 0.
fn energy_at_a_metre<R: Real>(ground: &impl SpringDamperGround<R>) -> R {
    let mut depth = R::ONE;
    for _ in 0..64 {
        let energy = ground.spring_energy(depth);
        if energy.is_finite() {
            return energy.at_least(R::ZERO);
        }
        depth *= R::HALF;
    }
    R::ZERO
}

/// The most steps of one length in a run: 2⁵³ in `f64`, 2⁴⁰ in `f32`.
///
/// [`Clock`] rounds each step by at most an eighth of the square of `EPSILON` of the time, which is
/// a 512th of a step after `1/(64 EPSILON²)` steps. That number is 2⁴⁰ in `f32` and 2⁹⁸ in `f64`,
/// where 2⁵³ steps take more than a hundred days at a nanosecond each.
fn most_steps<R: Real>() -> R {
    let resolved = R::ONE / (R::EPSILON * R::EPSILON * R::from_f64(64.0));
    resolved.at_most(R::from_f64(9_007_199_254_740_992.0))
}

/// Refuses samples at an interval so short that their times are not distinct numbers, or so short
/// that a run has more than 4·10⁹ of them.
fn check_samples<R: Real>(seconds: R, interval: Option<R>) -> Result<(), StepError> {
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

/// The end of a run, and when it is reached.
///
/// `N` steps of the number next to `dt` and the number next to `N dt` differ by rounding: by at
/// most half a unit in the last place of the step, which is less than one unit of the sum, and half
/// a unit of the duration. So a rest of up to one and a half units is none, and a rest that differs
/// by as much from a whole step is a whole step. The clock, rounded to a number, then differs from
/// the duration by at most one unit. Where a unit is more than the step, as in `f32` after 2²⁴
/// steps, the run ends at the nearest whole number of steps.
#[derive(Clone, Copy)]
pub(crate) struct End<R> {
    /// Since the start of the run, s.
    seconds: R,
    /// s.
    slack: R,
    /// Of a method whose steps are all alike, s.
    pub(crate) time_step: Option<R>,
}

impl<R: Real> End<R> {
    #[inline]
    fn new(seconds: R, time_step: Option<R>) -> Self {
        let slack = last_place(seconds) * R::from_f64(1.5);
        Self {
            seconds,
            slack: time_step.map_or(slack, |step| slack.at_most(step * R::HALF)),
            time_step,
        }
    }

    /// Refuses a run that would not end: one whose rest takes more than [`most_steps`].
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

    /// The limit of the next step, s.
    #[inline]
    pub(crate) fn limit(&self, clock: &Clock<R>) -> R {
        let left = clock.left(self.seconds);
        match self.time_step {
            Some(step) if (left - step).abs() <= self.slack => step,
            _ => left,
        }
    }

    /// The end itself in place of a time that differs from it by a unit in the last place: the last
    /// of the samples at equal intervals.
    #[inline]
    fn or_at(&self, time: R) -> R {
        if (time - self.seconds).abs() <= last_place(self.seconds) {
            self.seconds
        } else {
            time
        }
    }
}

/// One unit in the last place of a number that is at least 0: the distance to the next larger one.
#[inline]
fn last_place<R: Real>(number: R) -> R {
    // More than half a unit, and at most one but for rounding: the sum rounds to the next number.
    let share = R::EPSILON * R::HALF * (R::ONE + R::EPSILON);
    (number + number * share) - number
}

/// The start of a step, for a look between it and the end.
struct Before<R: Real, W> {
    clock: Clock<R>,
    state: State<R>,
    /// Of a method that carries its choice of the step in it.
    workspace: Option<W>,
}

/// Time since the start of a run, by Kahan's sum: a million steps of 1e-4 s are 100 s to the last
/// place. And what it has cost.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    fn left(&self, seconds: R) -> R {
        (seconds - self.time) + self.lost
    }

    /// One more step. A step that the clock does not resolve would repeat for ever.
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
        self.steps += 1;
        self.evaluations += u64::from(step.evaluations);
        self.rejected += u64::from(step.rejected);
        Ok(())
    }

    /// The time and the counts of another clock in addition to these.
    #[inline]
    pub(crate) fn add(&mut self, other: &Self) {
        self.advance_by(other.time);
        self.advance_by(-other.lost);
        self.steps += other.steps;
        self.evaluations += other.evaluations;
        self.rejected += other.rejected;
    }

    /// Counts whole steps of one length that need not be taken, as many as fit before the end, and
    /// returns whether there were any. Each stride is the largest power of two of them, whose
    /// length is exact.
    #[inline]
    pub(crate) fn skip(&mut self, end: &End<R>, length: R) -> bool {
        let steps = self.steps;
        let mut left = self.left(end.seconds);
        while left >= length * R::TWO {
            let (mut stride, mut count) = (length, 1_u64);
            while stride * R::TWO <= left {
                stride *= R::TWO;
                count *= 2;
            }
            self.advance_by(stride);
            self.steps += count;
            left = self.left(end.seconds);
        }
        self.steps > steps
    }

    /// Adds seconds by Knuth's sum, which loses nothing whichever number is larger.
    #[inline]
    fn advance_by(&mut self, seconds: R) {
        let corrected = seconds - self.lost;
        let next = self.time + corrected;
        let part = next - self.time;
        self.lost = -((self.time - (next - part)) + (corrected - part));
        self.time = next;
    }
}
