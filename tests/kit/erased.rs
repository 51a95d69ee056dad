//! Steppers of one type, for tests in which the types of a scene are not the subject.
//!
//! A scene is compiled anew for each combination of its parts: its contacts, the energy of a state,
//! the samples of a run. That took most of the time that these programs need to compile.
//! [`Stepper`] is composed like [`tumble::Stepper`], but has its parts behind pointers, so that all
//! scenes are of one type. The arithmetic is the same, and so are the bits:
//! `tests/physics/once.rs` compares them.
//!
//! The parts are never freed, so that a stepper is `Copy`, like one of built-in parts.

use core::fmt::{self, Debug, Formatter};
use core::ops::Deref;

use super::once::Once;
use tumble::{
    EnergyMomentum, Force, Frictionless, Gravity, Integrator, NoForce, NoGravity, NoGround,
    Observer, Real, RigidPointBody, SceneError, SlidingFriction, SpringDamperGround, State,
    StepError, StepperBuilder, Trial, UniformGravity,
};

type Body<'a, R> = &'a dyn RigidPointBody<R>;
type Ground<'a, R> = &'a dyn SpringDamperGround<R>;
type Friction<'a, R> = &'a dyn SlidingFriction<R>;
type Applied<'a, R> = &'a dyn Force<R>;

type Inner<'a, I, R> = tumble::Stepper<
    Body<'a, R>,
    Ground<'a, R>,
    Friction<'a, R>,
    UniformGravity<R>,
    Once<I>,
    R,
    Applied<'a, R>,
>;

/// A [`tumble::Stepper`] whose type does not name the parts of its scene.
#[derive(Clone, Copy)]
pub(crate) struct Stepper<'a, I = EnergyMomentum, R: Real = f64>(Inner<'a, I, R>);

impl<'a, R: Real> Stepper<'a, EnergyMomentum<R>, R> {
    pub(crate) fn new(body: impl RigidPointBody<R> + 'a) -> Result<Self, SceneError> {
        Self::builder(body).build()
    }

    pub(crate) fn builder(body: impl RigidPointBody<R> + 'a) -> Builder<'a, EnergyMomentum<R>, R> {
        let time_step = R::from_f64(1e-3);
        let builder = tumble::Stepper::builder(leaked(body) as Body<'a, R>)
            .gravity(uniform(&NoGravity))
            .ground(&NoGround as Ground<'a, R>)
            .friction(&Frictionless as Friction<'a, R>)
            .force(&NoForce as Applied<'a, R>)
            .integrator(Once(EnergyMomentum { time_step }));
        Builder(builder)
    }
}

impl<'a, I: Integrator<R>, R: Real> Stepper<'a, I, R> {
    /// [`Trial::stepper`].
    pub(crate) fn of_trial(trial: &Trial<R>, integrator: I) -> Result<Self, SceneError> {
        Stepper::builder(trial.coin())
            .ground(trial.ground())
            .friction(trial.friction())
            .gravity(trial.gravity())
            .integrator(integrator)
            .build()
    }

    pub(crate) fn with_gravity(self, gravity: impl Gravity<R>) -> Result<Self, SceneError> {
        self.0.with_gravity(uniform(&gravity)).map(Self)
    }

    pub(crate) fn with_ground(
        self,
        ground: impl SpringDamperGround<R> + 'a,
    ) -> Result<Self, SceneError> {
        self.0
            .with_ground(leaked(ground) as Ground<'a, R>)
            .map(Self)
    }

    pub(crate) fn with_friction(
        self,
        friction: impl SlidingFriction<R> + 'a,
    ) -> Result<Self, SceneError> {
        let friction = leaked(friction) as Friction<'a, R>;
        self.0.with_friction(friction).map(Self)
    }

    pub(crate) fn with_force(self, force: impl Force<R> + 'a) -> Result<Self, SceneError> {
        self.0.with_force(leaked(force) as Applied<'a, R>).map(Self)
    }

    pub(crate) fn with_integrator<J: Integrator<R>>(
        self,
        integrator: J,
    ) -> Result<Stepper<'a, J, R>, SceneError> {
        self.0.with_integrator(Once(integrator)).map(Stepper)
    }

    pub(crate) fn integrator(&self) -> &I {
        &self.0.integrator().0
    }

    /// [`tumble::Stepper::run`], compiled once for all observers.
    pub(crate) fn run(
        &self,
        state: &mut State<R>,
        seconds: R,
        observer: &mut dyn Observer<R>,
    ) -> Result<R, StepError> {
        self.0.run(state, seconds, observer)
    }
}

impl<I: Debug, R: Real> Debug for Stepper<'_, I, R> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Stepper")
            .field(&self.0.integrator().0)
            .finish()
    }
}

impl<'a, I, R: Real> Deref for Stepper<'a, I, R> {
    type Target = Inner<'a, I, R>;
    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

type InnerBuilder<'a, I, R> = StepperBuilder<
    Body<'a, R>,
    Ground<'a, R>,
    Friction<'a, R>,
    UniformGravity<R>,
    Once<I>,
    R,
    Applied<'a, R>,
>;

/// A [`StepperBuilder`] of a [`Stepper`].
#[derive(Clone, Copy)]
pub(crate) struct Builder<'a, I, R: Real = f64>(InnerBuilder<'a, I, R>);

impl<'a, I, R: Real> Builder<'a, I, R> {
    pub(crate) fn gravity(self, gravity: impl Gravity<R>) -> Self {
        Self(self.0.gravity(uniform(&gravity)))
    }

    pub(crate) fn ground(self, ground: impl SpringDamperGround<R> + 'a) -> Self {
        Self(self.0.ground(leaked(ground) as Ground<'a, R>))
    }

    pub(crate) fn friction(self, friction: impl SlidingFriction<R> + 'a) -> Self {
        Self(self.0.friction(leaked(friction) as Friction<'a, R>))
    }

    pub(crate) fn force(self, force: impl Force<R> + 'a) -> Self {
        Self(self.0.force(leaked(force) as Applied<'a, R>))
    }

    pub(crate) fn integrator<J: Integrator<R>>(self, integrator: J) -> Builder<'a, J, R> {
        Builder(self.0.integrator(Once(integrator)))
    }

    pub(crate) fn build(self) -> Result<Stepper<'a, I, R>, SceneError>
    where
        I: Integrator<R>,
    {
        self.0.build().map(Stepper)
    }
}

fn uniform<R: Real>(gravity: &impl Gravity<R>) -> UniformGravity<R> {
    UniformGravity {
        acceleration: gravity.acceleration(),
    }
}

fn leaked<'a, T: 'a>(part: T) -> &'a T {
    Box::leak(Box::new(part))
}
