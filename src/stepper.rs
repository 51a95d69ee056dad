//! The stepper: composes a scene and an integrator, and moves states on.

use core::ops::ControlFlow;

use crate::body::RigidPointBody;
use crate::energy::Energy;
use crate::error::{Quantity, SceneError, StepError};
use crate::friction::{Frictionless, SlidingFriction};
use crate::gravity::{Gravity, NoGravity};
use crate::ground::{NoGround, SpringDamperGround};
use crate::integrator::{EnergyMomentum, Integrator, Step};
use crate::observer::{Observer, Probe, Sample};
use crate::real::Real;
use crate::scene::{Dynamics, LowestPoint, Scene};
use crate::stability;
use crate::state::State;

/// Moves the states of one body in one scene on in time.
///
/// [`new`](Self::new) starts in empty space; each `with_*` names one thing that the scene has, and what is not named costs nothing. The state is the
/// caller's, so one stepper serves any number of states, also from several threads.
///
/// Its type names precision, body, ground, friction, gravity and integrator. In a struct of your own, take it from [`mod@crate::f64`] or [`mod@crate::f32`], and name what differs from empty space and from
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
    /// A body in empty space, without gravity, moved on by [`EnergyMomentum`] with a time step of 1 ms.
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

    /// The same state, with the angular momentum that the body, turned as it is there, has at this angular velocity (rad/s, world axes): `L = J ω`.
    ///
    /// A [`State`] holds the angular momentum, which is what stays in flight; what is known of a throw is mostly how fast it turns. `state.orientation * vector` takes a vector
    /// of body axes to world axes.
    ///
    /// ```
    /// use tumble::glam::DVec3;
    /// use tumble::{Coin, State, Stepper};
    ///
    /// let stepper = Stepper::new(Coin::ring(1.0, 0.5))?; // kg, m; its normal is body x
    /// let state = State::at(DVec3::Z).turned_by(DVec3::Y * 0.3); // rad
    /// let state = stepper.spinning(state, state.orientation * DVec3::X * 8.0); // rad/s about its normal
    /// assert!((state.angular_momentum.length() - 1.0 * 0.5 * 0.5 * 8.0).abs() < 1e-12); // m r² ω
    /// assert!((stepper.angular_velocity(&state).length() - 8.0).abs() < 1e-12);
    /// # Ok::<(), tumble::SceneError>(())
    /// ```
    #[must_use]
    pub fn spinning(&self, state: State<R>, angular_velocity: R::Vec3) -> State<R> {
        let axes = state.rotation().axes();
        let masses = self.scene.mass_properties();
        state.with_angular_momentum(masses.angular_momentum(&axes, angular_velocity))
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

    /// Velocity of the body's material at its lowest point, along the ground, m/s, world axes; `None` for a body without contacts.
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
    /// Largest step (s) for which the integrator is stable on the contacts that touch at a state. `None` if there is no
    /// bound: an implicit or adaptive integrator, a body in flight, or a state that is not finite.
    ///
    /// It follows from the stiffness, the damping and the friction of all contacts together, with their arms and the body's
    /// inertia. Every shorter step is stable too. A step above it makes small errors grow until the energy does. 0 if
    /// no step is stable, as for [`ForwardEuler`](crate::ForwardEuler) on springs without dampers. The integrator's own step size
    /// does not matter.
    ///
    /// *Limits:* the bound belongs to this state. It falls when more contacts touch, when the body leans, when a slip ends (a
    /// contact that sticks is a damper of `μ N/slip_speed`), and with the depth if the contact law stiffens. For a run, take
    /// the least value along it, as below; a body in flight has none. Rotation is not part of it: in contact a step should
    /// turn the body by much less than 1 rad. It is proven for contacts that stick or slide, not for a slip near the slip speed. It costs about as much as twenty steps.
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

    /// One step of the integrator's own length, or of `limit` seconds where that is less, with a workspace that the caller keeps from step to step.
    ///
    /// # Errors
    /// As [`step`](Self::step), and where `limit` is below 0 or NaN.
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
            Err(StepError::BadDuration)
        }
    }

    /// As [`step_within`](Self::step_within), with a limit that is known to be at least 0.
    #[inline]
    fn move_on(
        &self,
        state: &mut State<R>,
        limit: R,
        workspace: &mut I::Workspace,
    ) -> Result<Step<R>, StepError> {
        let before = *state;
        let step = self.integrator.step(&self.scene, state, limit, workspace);
        let error = match (step, state.not_finite()) {
            (Ok(step), None) => return Ok(step),
            (Ok(_), Some(quantity)) => blame(&before, quantity),
            (Err(error), _) => error,
        };
        *state = before;
        Err(error)
    }

    /// Moves a state on by exactly `seconds`, at least 0.
    ///
    /// # Errors
    /// As [`step`](Self::step), and where `seconds` is negative or not finite. The state is that after the last good step.
    pub fn advance(&self, state: &mut State<R>, seconds: R) -> Result<(), StepError> {
        self.run(state, seconds, &mut ())?;
        Ok(())
    }

    /// Moves a state on by exactly `seconds` and shows it to `observer` at the start and after each step. Returns the time that the run has covered, s: less
    /// than `seconds` where the observer ended it.
    ///
    /// # Errors
    /// As [`advance`](Self::advance), and where a foreign integrator takes no time for a step.
    pub fn run(
        &self,
        state: &mut State<R>,
        seconds: R,
        observer: &mut (impl Observer<R> + ?Sized),
    ) -> Result<R, StepError> {
        if !(seconds >= R::ZERO && seconds.is_finite()) {
            return Err(StepError::BadDuration);
        }
        let mut workspace = I::Workspace::default();
        let mut clock = Clock::new();
        let mut flow = self.show(observer, state, &clock);
        // What rounding leaves of the time when the last whole step has been taken.
        let rounding = rounding_of(seconds);
        while flow.is_continue() && clock.left(seconds) > rounding {
            // Whoever asks for times between the steps is led there from the step's start.
            let before = observer.asks_for().map(|_| Before {
                clock,
                state: *state,
                workspace: I::CHOOSES_STEPS.then(|| workspace.clone()),
            });
            let step = self.move_on(state, clock.left(seconds), &mut workspace)?;
            clock.tick(&step)?;
            if let Some(before) = before {
                flow = self.show_between(observer, &before, state, &clock)?;
            }
            if flow.is_continue() {
                flow = self.show(observer, state, &clock);
            }
        }
        Ok(clock.time)
    }

    /// The states at the times that are asked for, from the start of a step to its end.
    fn show_between(
        &self,
        observer: &mut (impl Observer<R> + ?Sized),
        before: &Before<R, I::Workspace>,
        end: &State<R>,
        clock: &Clock<R>,
    ) -> Result<ControlFlow<()>, StepError> {
        let mut last = None;
        while let Some(time) = observer.asks_for() {
            // A time that is asked for twice would be so for ever.
            let is_due = time - clock.time <= rounding_of(time);
            if !is_due || last == Some(time) {
                break;
            }
            last = Some(time);
            let state = if (clock.time - time).abs() <= rounding_of(time) {
                *end
            } else {
                self.state_at(time, before)?
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
    fn state_at(&self, time: R, before: &Before<R, I::Workspace>) -> Result<State<R>, StepError> {
        let (mut state, mut clock) = (before.state, before.clock);
        let mut workspace = before.workspace.clone().unwrap_or_default();
        while clock.left(time) > rounding_of(time) {
            let step = self.move_on(&mut state, clock.left(time), &mut workspace)?;
            clock.tick(&step)?;
        }
        Ok(state)
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

/// What rounding leaves of a time when the last whole step has been taken, s.
#[inline]
fn rounding_of<R: Real>(seconds: R) -> R {
    seconds * (R::EPSILON * R::from_f64(8.0))
}

/// The start of a step, for a look between it and the end.
struct Before<R: Real, W> {
    clock: Clock<R>,
    state: State<R>,
    /// Of a method that carries its choice of the step in it.
    workspace: Option<W>,
}

/// Time since the start of a run, by Kahan's sum: a million steps of 1e-4 s are 100 s to the last place. And what it has cost.
#[derive(Clone, Copy)]
struct Clock<R> {
    time: R,
    lost: R,
    steps: u64,
    evaluations: u64,
    rejected: u64,
}

impl<R: Real> Clock<R> {
    fn new() -> Self {
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

    #[inline]
    fn tick(&mut self, step: &Step<R>) -> Result<(), StepError> {
        let takes_time = step.elapsed > R::ZERO;
        if !takes_time {
            return Err(StepError::Stalled);
        }
        let corrected = step.elapsed - self.lost;
        let next = self.time + corrected;
        self.lost = (next - self.time) - corrected;
        self.time = next;
        self.steps += 1;
        self.evaluations += u64::from(step.evaluations);
        self.rejected += u64::from(step.rejected);
        Ok(())
    }
}
