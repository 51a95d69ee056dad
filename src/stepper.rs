//! The stepper: combines a scene with an integrator and advances states in time.

mod builder;
mod clock;
mod diagnosis;
mod many;
mod rest;
#[cfg(feature = "serde")]
mod saved;

pub use builder::StepperBuilder;
pub(crate) use clock::{Clock, End, check_duration, check_samples};
pub(crate) use rest::has_bits_of;

use core::ops::ControlFlow;

use crate::body::RigidPointBody;
use crate::contact::LowestPoint;
use crate::energy::Energy;
use crate::error::{SceneError, StepError};
use crate::force::{Force, NoForce};
use crate::free_rotation::FreeRotation;
use crate::friction::{Frictionless, SlidingFriction};
use crate::gravity::{Gravity, NoGravity};
use crate::ground::{NoGround, SpringDamperGround};
use crate::integrator::{EnergyMomentum, Integrator, Step};
use crate::observer::{Observer, Sample, SceneQuery};
use crate::outcome::{Barriers, Faces};
use crate::real::{Real, Vector};
use crate::scene::{Alarm, Dynamics, Scene, ScreenedScene};
use crate::stability;
use crate::state::State;

/// Advances the states of one body in one scene in time.
///
/// [`builder`](Self::builder) takes the parts of the scene and checks them once. A part that is not
/// named costs nothing. [`with_ground`](Self::with_ground), [`with_friction`](Self::with_friction),
/// [`with_gravity`](Self::with_gravity), [`with_force`](Self::with_force) and
/// [`with_integrator`](Self::with_integrator) each replace one part of an existing stepper.
///
/// The caller owns the state. One stepper therefore serves any number of states, also from several
/// threads.
///
/// The type names body, ground, friction, gravity, integrator, precision and applied force, in this
/// order. For a field of your own struct, name only what differs from empty space, from
/// [`EnergyMomentum`] and from `f64`:
///
/// ```
/// use tumble::{Coin, Coulomb, FlatGround, SceneError, Stepper, UniformGravity};
///
/// struct Game {
///     table: Stepper<Coin, FlatGround, Coulomb, UniformGravity>,
/// }
///
/// let table = Stepper::builder(Coin::ring(0.01, 0.01))
///     .gravity(UniformGravity::down(9.81))
///     .ground(FlatGround::level(1e4, 0.5))
///     .friction(Coulomb { coefficient: 0.3, slip_speed: 1e-3 })
///     .build()?;
/// let game = Game { table };
/// # assert_eq!(game.table.body().radius(), 0.01);
/// # Ok::<(), SceneError>(())
/// ```
///
/// In single precision, [`crate::f32::Stepper`] has the defaults of `f32`.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Coin, Coulomb, FlatGround, State, Stepper, StrangSplitting, UniformGravity};
///
/// let stepper = Stepper::builder(Coin::ring(1.0, 0.5))
///     .gravity(UniformGravity::down(9.8))
///     .ground(FlatGround::level(1000.0, 0.5))
///     .friction(Coulomb { coefficient: 0.3, slip_speed: 1e-3 })
///     .integrator(StrangSplitting { time_step: 1e-3 })
///     .build()?;
/// let mut state = State::at(DVec3::Z).with_angular_momentum(DVec3::new(0.3, 1.0, 0.2));
/// let before = stepper.energy(&state).total();
/// stepper.advance(&mut state, 2.0)?;
/// assert!(stepper.energy(&state).total() < before);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepper<
    B,
    G = NoGround,
    F = Frictionless,
    A = NoGravity,
    I = EnergyMomentum,
    R: Real = f64,
    E = NoForce,
> {
    scene: Scene<B, G, F, A, R, E>,
    integrator: I,
}

impl<R: Real, B: RigidPointBody<R>>
    Stepper<B, NoGround, Frictionless, NoGravity, EnergyMomentum<R>, R>
{
    /// Creates a stepper for `body` in empty space, without gravity. The integrator is
    /// [`EnergyMomentum`] with a step size of 1 ms.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the body is invalid. The error names the quantity, the rule and
    /// the value.
    pub fn new(body: B) -> Result<Self, SceneError> {
        Self::builder(body).build()
    }

    /// Starts the composition of a stepper for `body`. The defaults are those of
    /// [`new`](Self::new).
    #[inline]
    pub fn builder(
        body: B,
    ) -> StepperBuilder<B, NoGround, Frictionless, NoGravity, EnergyMomentum<R>, R> {
        let time_step = R::from_f64(1e-3);
        let integrator = EnergyMomentum { time_step };
        StepperBuilder::new(body, NoGround, Frictionless, NoGravity, integrator, NoForce)
    }
}

impl<R, B, G, F, A, I, E> Stepper<B, G, F, A, I, R, E>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    A: Gravity<R>,
    E: Force<R>,
{
    /// Replaces the ground.
    ///
    /// To replace ground and friction together, as for several surfaces with a law for each, use
    /// the [builder](Stepper::builder).
    ///
    /// # Errors
    /// Returns [`SceneError`] if the ground is invalid, or if there are several friction laws and
    /// their number is not that of the surfaces. The error names the quantity, the rule and the
    /// value.
    pub fn with_ground<G2: SpringDamperGround<R>>(
        self,
        ground: G2,
    ) -> Result<Stepper<B, G2, F, A, I, R, E>, SceneError> {
        let (body, _, friction, gravity, force) = self.scene.into_parts();
        Stepper::compose(body, ground, friction, gravity, force, self.integrator)
    }

    /// Replaces the friction law.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the friction law is invalid, or if there are several laws and
    /// their number is not that of the surfaces. The error names the quantity, the rule and the
    /// value.
    pub fn with_friction<F2: SlidingFriction<R>>(
        self,
        friction: F2,
    ) -> Result<Stepper<B, G, F2, A, I, R, E>, SceneError> {
        let (body, ground, _, gravity, force) = self.scene.into_parts();
        Stepper::compose(body, ground, friction, gravity, force, self.integrator)
    }

    /// Replaces gravity.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the gravity, the weight of the body, or its sum with the constant
    /// part of the applied force is not finite.
    pub fn with_gravity<A2: Gravity<R>>(
        self,
        gravity: A2,
    ) -> Result<Stepper<B, G, F, A2, I, R, E>, SceneError> {
        let (body, ground, friction, _, force) = self.scene.into_parts();
        Stepper::compose(body, ground, friction, gravity, force, self.integrator)
    }

    /// Replaces the applied force, for example [`AirDrag`](crate::AirDrag). A tuple applies several
    /// forces.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a parameter of the force is invalid, or if the weight together
    /// with the [constant part](Force::constant_force) of the force is not finite. The error names
    /// the quantity, the rule and the value.
    pub fn with_force<E2: Force<R>>(
        self,
        force: E2,
    ) -> Result<Stepper<B, G, F, A, I, R, E2>, SceneError> {
        Ok(Stepper {
            scene: self.scene.with_force(force)?,
            integrator: self.integrator,
        })
    }

    /// Replaces the integrator.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a parameter of the integrator is invalid, or if it cannot step the
    /// body. The error names the quantity, the rule and the value.
    pub fn with_integrator<I2: Integrator<R>>(
        self,
        integrator: I2,
    ) -> Result<Stepper<B, G, F, A, I2, R, E>, SceneError> {
        integrator.check()?;
        integrator.check_body(self.scene.body())?;
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
        force: E,
        integrator: I,
    ) -> Result<Self, SceneError> {
        Ok(Self {
            scene: Scene::new(body, ground, friction, gravity)?.with_force(force)?,
            integrator,
        })
    }

    /// Returns the scene: body, ground, friction, gravity and applied force. Use it for queries
    /// about a state.
    #[inline]
    #[must_use]
    pub fn scene(&self) -> &Scene<B, G, F, A, R, E> {
        &self.scene
    }

    /// Returns the body.
    #[inline]
    #[must_use]
    pub fn body(&self) -> &B {
        self.scene.body()
    }

    /// Returns the integrator.
    #[inline]
    #[must_use]
    pub fn integrator(&self) -> &I {
        &self.integrator
    }

    /// Returns `state` with the angular momentum that corresponds to an angular velocity (rad/s,
    /// world axes): `L = J ω`. `J` is the inertia tensor at the orientation of `state`.
    ///
    /// A [`State`] holds the angular momentum, because it is constant in flight. The initial
    /// conditions of a throw mostly give the angular velocity. `state.orientation * vector`
    /// transforms a vector from body axes to world axes. The part of the angular velocity about an
    /// axis without moment of inertia is lost, as about the axis of a [`Rod`](crate::Rod).
    ///
    /// ```
    /// use tumble::glam::DVec3;
    /// use tumble::{Coin, State, Stepper};
    ///
    /// let stepper = Stepper::new(Coin::ring(1.0, 0.5))?; // kg, m; its normal is body x
    /// let state = State::at(DVec3::Z).with_rotation_vector(DVec3::Y * 0.3); // rad
    /// let spin = state.orientation * DVec3::X * 8.0; // rad/s, about its normal
    /// let state = stepper.with_angular_velocity(state, spin);
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

    /// Applies an impulse `J` (N s, world axes) at a point `p` of the world (m). The point need not
    /// belong to the body.
    ///
    /// The velocity of the centre of mass `x` changes by `J/m`, where `m` is the mass. The angular
    /// momentum about the centre of mass changes by `(p - x) × J`. If the body has no moment of
    /// inertia about an axis, its angular momentum about that axis does not change.
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
    /// Returns [`StepError::BadState`] if the state is not finite or its orientation is invalid.
    /// Returns [`StepError::BadImpulse`] if the impulse or the point is not finite, or if the
    /// motion after it is not finite. On an error the state is unchanged.
    pub fn apply_impulse(
        &self,
        state: &mut State<R>,
        impulse: R::Vec3,
        point: R::Vec3,
    ) -> Result<(), StepError> {
        state.check()?;
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
        let gained = (point - state.position).cross(impulse);
        let gained = masses.without_dead_spin(state.rotation(), gained);
        let momentum = state.angular_momentum + gained;
        let velocity = state.linear_velocity + impulse * masses.inverse_mass();
        if !velocity.is_finite() {
            finite("speed after an impulse", velocity.length())?;
        }
        if !momentum.is_finite() {
            finite("angular momentum after an impulse", momentum.length())?;
        }
        (state.linear_velocity, state.angular_momentum) = (velocity, momentum);
        Ok(())
    }

    /// Angular velocity of the body, rad/s, world axes: `ω = J⁻¹ L`, with the inertia tensor `J`
    /// and the angular momentum `L`. About an axis without moment of inertia it is 0.
    #[must_use]
    pub fn angular_velocity(&self, state: &State<R>) -> R::Vec3 {
        self.scene.motion(state).angular_velocity
    }

    /// Torque-free rotation of the body from `state`, in closed form.
    ///
    /// The rotation is that of the body in flight, whatever the ground.
    #[must_use]
    pub fn free_rotation(&self, state: &State<R>) -> FreeRotation<R> {
        let inertia = self.scene.inertia_properties();
        FreeRotation::new(inertia, state.rotation(), state.angular_momentum)
    }

    /// Energy of a state by kind, J.
    #[must_use]
    pub fn energy(&self, state: &State<R>) -> Energy<R> {
        Energy::of(&self.scene, state)
    }

    /// Lowest point of the body, with its slip velocity. `None` for a body without contacts and
    /// rims.
    #[must_use]
    pub fn lowest_point(&self, state: &State<R>) -> Option<LowestPoint<R>> {
        self.scene.lowest_point(state)
    }

    /// Velocity of the body's material at its lowest point along the ground and relative to it,
    /// m/s, world axes. `None` for a body without contacts and rims.
    #[must_use]
    pub fn slip_velocity(&self, state: &State<R>) -> Option<R::Vec3> {
        Some(self.lowest_point(state)?.slip_velocity)
    }

    /// Number of contacts that touch the ground, summed over its surfaces.
    ///
    /// A round rim counts with the points of its quadrature, whose number depends on the pose.
    #[must_use]
    pub fn touching(&self, state: &State<R>) -> usize {
        self.scene.touching(state)
    }

    /// Computes the energy barriers between the faces of the body, which prove on which face it
    /// stays.
    ///
    /// Returns `None` if there is no bound: no ground, several surfaces, ground that moves or is
    /// not a level plane, gravity that does not point along -z, or springs of which a single
    /// contact is too soft to carry the body. It also returns `None` if an applied force is not
    /// passive. Call it once for many states.
    #[must_use]
    #[allow(clippy::type_complexity, reason = "the scene's parts are its type")]
    pub fn barriers(&self) -> Option<Barriers<'_, Scene<B, G, F, A, R, E>, R>>
    where
        B: Faces<R>,
    {
        Barriers::of(&self.scene)
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
    /// Largest step size (s) for which the integrator is stable on the contacts that touch in
    /// `state` and under the applied force. Returns `None` if there is no bound: an implicit or
    /// adaptive integrator, a body in flight without an applied force, or a state that is not
    /// finite. It is `None` for [`EnergyMomentum`] too, which has a bound under an applied force
    /// that depends on the pose: that of [`StrangSplitting`](crate::StrangSplitting) without a
    /// ground.
    ///
    /// The bound follows from the stiffness, the damping and the friction of all contacts together,
    /// with their lever arms and the inertia of the body. The applied force counts by its
    /// derivatives with respect to velocities and pose. Every shorter step is stable too, except
    /// under a force that rotates the velocity. A longer step can amplify small errors until the
    /// energy grows as well. Returns 0 if no step is stable: [`ForwardEuler`](crate::ForwardEuler)
    /// and [`Nystrom`](crate::Nystrom) amplify every motion on a spring without a damper, such as
    /// an applied force or one of several surfaces. The step size set in the integrator has no
    /// effect on the result.
    ///
    /// *Limits:*
    ///
    /// * The bound holds for this state only. It decreases when more contacts touch, when the body
    ///   leans, or when a slip ends. A sticking contact acts as a damper of `μ N/slip_speed`, with
    ///   the friction coefficient `μ` and the normal force `N`. The bound also decreases with the
    ///   penetration depth if the contact law stiffens.
    /// * For a run, take the smallest value along it, as in the example. A body in flight has no
    ///   bound by contacts. The bound by quadratic drag decreases as the speed increases.
    /// * The bound does not include rotation. In contact, a step should rotate the body by much
    ///   less than 1 rad.
    /// * The bound is that of the motion linearised at the state, for every motion of the body on
    ///   its contacts and forces. Beyond it, a disturbance grows from step to step. Take a step
    ///   somewhat below it, because contacts are not linear.
    /// * For an integrator of your own that is neither a Runge-Kutta method nor has a
    ///   [`linear_step`](crate::Integrator::linear_step), the bound can be too long.
    /// * A motion that grows by itself has no bound, such as a fall from a balance, or the flutter
    ///   of a body that slides. An oscillation that grows by less than a tenth per rad is bounded
    ///   as one without damping. For [`ForwardEuler`](crate::ForwardEuler) it has no bound. Neither
    ///   has a motion a thousand times slower than the fastest.
    /// * A force that rotates the velocity at a rate ω, as lift or a magnetic force does, bounds
    ///   [`Rk4`](crate::Rk4) and [`Nystrom`](crate::Nystrom) by `2.83/ω`. The other explicit
    ///   methods have no stable step under it. In each step of size h,
    ///   [`ForwardEuler`](crate::ForwardEuler), whose bound is 0, and
    ///   [`SymplecticEuler`](crate::SymplecticEuler) multiply the velocity by `√(1 + (h ω)²)`, and
    ///   [`StrangSplitting`](crate::StrangSplitting) by `√(1 + (h ω)⁴/4)`. The bound of the last
    ///   two is below `0.01/ω`, where rounding hides the growth.
    /// * One call computes the eigenvalues of a 12 by 12 matrix, for methods other than
    ///   Runge-Kutta methods some thirty times. That is too slow for every step.
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
        let method = &self.integrator;
        stability::largest_stable_step(
            &self.scene,
            state,
            |stiffness, damping| method.largest_stable_step(stiffness, damping),
            |motion, start, size| method.linear_step(motion, start, size),
        )
    }

    /// Takes one step with the step size of the integrator.
    ///
    /// # Errors
    /// Returns [`StepError`] if the state is not finite before or after the step, or if the step
    /// fails for another reason. On an error the state is unchanged.
    #[inline]
    pub fn step(&self, state: &mut State<R>) -> Result<Step<R>, StepError> {
        self.move_on(state, R::MAX, &mut I::Workspace::default())
    }

    /// Takes one step of at most `limit` seconds, which must be above 0. The step is the
    /// integrator's own, or `limit` if that is shorter.
    ///
    /// The workspace must be one of this scene.
    #[inline]
    pub(crate) fn move_on(
        &self,
        state: &mut State<R>,
        limit: R,
        workspace: &mut I::Workspace,
    ) -> Result<Step<R>, StepError> {
        let before = *state;
        self.move_on_from(&before, state, limit, workspace)
    }

    /// Takes a step like [`move_on`](Self::move_on), from a state of which the caller has a copy.
    #[inline]
    pub(crate) fn move_on_from(
        &self,
        before: &State<R>,
        state: &mut State<R>,
        limit: R,
        workspace: &mut I::Workspace,
    ) -> Result<Step<R>, StepError> {
        if !self.scene.is_trusted() {
            return self.move_on_screened((before, state), limit, workspace);
        }
        let step = self.integrator.step(&self.scene, state, limit, workspace);
        match (&step, state.not_finite()) {
            (Ok(step), None) if step.elapsed > R::ZERO => Ok(*step),
            _ => self.examined(step, limit, (before, state), workspace),
        }
    }

    /// Takes a step like [`move_on`](Self::move_on) and tests every value that a law returns.
    #[inline]
    fn move_on_screened(
        &self,
        (before, state): (&State<R>, &mut State<R>),
        limit: R,
        workspace: &mut I::Workspace,
    ) -> Result<Step<R>, StepError> {
        let alarm = Alarm::default();
        let scene = ScreenedScene::of(&self.scene, &alarm);
        let step = self.integrator.step(&scene, state, limit, workspace);
        match (&step, state.not_finite()) {
            (Ok(step), None) if !alarm.is_raised() && step.elapsed > R::ZERO => Ok(*step),
            _ => self.examined(step, limit, (before, state), workspace),
        }
    }

    /// Advances a state by `seconds`, which must be at least 0.
    ///
    /// The time that has passed differs from `seconds` by at most one unit in its last place. It
    /// differs only if `seconds` is a whole number of steps up to rounding: no short step is added.
    /// Ten steps of 0.1 s and an advance by 1 s therefore give the same bits. In `f32` this holds
    /// up to 2²⁶ steps. Beyond that, the clock may be wrong by one more unit for each 2²⁶ steps.
    ///
    /// Each step is taken, at rest too. A [`Session`](crate::Session) counts the steps of a body at
    /// rest instead.
    ///
    /// # Errors
    /// Returns the errors of [`step`](Self::step). Returns [`StepError::BadDuration`] if `seconds`
    /// is negative or not finite. Returns [`StepError::TooManySteps`] if the run would take more
    /// than 2⁵³ steps (2⁴⁰ in `f32`) of the integrator's step size. On an error the state is the
    /// one after the last successful step.
    pub fn advance(&self, state: &mut State<R>, seconds: R) -> Result<(), StepError> {
        self.run(state, seconds, &mut ())?;
        Ok(())
    }

    /// Advances a state like [`advance`](Self::advance) and calls `observer` at the start and after
    /// each step. Returns the time that the run has covered, s. It is less than `seconds` if the
    /// observer ended the run.
    ///
    /// # Errors
    /// Returns the errors of [`advance`](Self::advance). Returns [`StepError::TooManySamples`] if
    /// the observer's [interval](Observer::interval) leads to more than 4·10⁹ samples. In `f32` the
    /// limit is 2²⁴, because `f32` does not resolve more. Returns [`StepError::Stalled`] if an
    /// integrator returns a step that takes no time.
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

    /// Advances a state like [`run`](Self::run), with the caller's workspace and a new clock. After
    /// an error, the clock holds the time and the counts up to that error.
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
        end.check_first_step::<I>(clock)?;
        let mut flow = self.show(observer, state, clock);
        let mut scratch = None;
        while flow.is_continue() && !end.is_reached(clock) {
            // States between the steps are computed from the start of the step.
            let before = observer.requested_time().map(|_| Before {
                clock: *clock,
                state: *state,
                workspace: self.chooses_steps().then(|| workspace.clone()),
            });
            let start = *state;
            let step = self.move_on(state, end.limit(clock), workspace);
            let step = step.map_err(|error| error.at(clock.time.to_f64()))?;
            clock.tick_from(&start, state, &step)?;
            end.check_next_steps::<I>(&step, clock)?;
            if let Some(before) = before {
                let path = (&before, &mut scratch);
                flow = self.show_between(observer, &end, path, state, clock)?;
            }
            // The state is that after the step, whatever the observer has said of a time within it.
            let shown = self.show(observer, state, clock);
            flow = if flow.is_break() { flow } else { shown };
        }
        Ok(())
    }

    /// Samples the requested times between the start and the end of a step.
    fn show_between(
        &self,
        observer: &mut (impl Observer<R> + ?Sized),
        end_of_run: &End<R>,
        (before, scratch): (&Before<R, I::Workspace>, &mut Option<I::Workspace>),
        end: &State<R>,
        clock: &Clock<R>,
    ) -> Result<ControlFlow<()>, StepError> {
        let mut last = None;
        while let Some(time) = observer.requested_time() {
            let asked = self.end_at(end_of_run.or_at(time));
            let is_ahead = !time.is_finite() || !asked.is_reached(clock);
            let is_past = asked.is_reached(&before.clock) && !asked.is_here(&before.clock);
            // An observer that does not move on would be asked for ever.
            if is_ahead || is_past || last.is_some_and(|last| time <= last) {
                break;
            }
            last = Some(time);
            let state = if asked.is_here(clock) {
                *end
            } else {
                self.state_at(&asked, before, scratch)?
            };
            let sample = Sample {
                time,
                ..self.sample(&state, clock)
            };
            if observer.observe_requested(&sample).is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// State at a time after the start of a step, computed by separate steps. A method that does
    /// not choose its steps takes them in `scratch`: no result depends on what it holds.
    fn state_at(
        &self,
        asked: &End<R>,
        before: &Before<R, I::Workspace>,
        scratch: &mut Option<I::Workspace>,
    ) -> Result<State<R>, StepError> {
        let (mut state, mut clock) = (before.state, before.clock);
        let workspace = match &before.workspace {
            Some(workspace) => scratch.insert(workspace.clone()),
            None => scratch.get_or_insert_default(),
        };
        while !asked.is_reached(&clock) {
            let step = self.move_on(&mut state, asked.limit(&clock), workspace);
            clock.tick(&step.map_err(|error| error.at(clock.time.to_f64()))?)?;
        }
        Ok(state)
    }

    /// Returns true if the method has its own size for the next step. A method with a fixed step
    /// has none.
    #[inline]
    pub(crate) fn chooses_steps(&self) -> bool {
        I::ADAPTIVE && self.integrator.fixed_step().is_none()
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

/// Start of a step, from which states between the start and the end of the step are computed.
struct Before<R: Real, W> {
    clock: Clock<R>,
    state: State<R>,
    /// Workspace of a method that chooses its steps, which stores that choice.
    workspace: Option<W>,
}
