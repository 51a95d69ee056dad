//! Integrators that are compiled once, for tests in which the types of a scene are not the subject.
//! The stepper of `erased.rs` contains one. This module serves tests that need the type of a body.
//!
//! An integrator is generic over the scene, so it is compiled anew for each type of scene that a
//! test composes, which took most of the time that these programs need to compile. [`Once`] hands
//! the integrator one type of scene instead, whose parts are behind pointers. The arithmetic is the
//! same, and so are the bits: `tests/physics/once.rs` compares them. The types stay where a hint,
//! an allocation or the composition is the subject.

use tumble::{
    ContactModel, Dynamics, EnergyMomentum, Force, InertiaProperties, Integrator, LinearMotion,
    Real, RigidPointBody, SceneError, SlidingFriction, SpringDamperGround, State, Step,
    StepControl, StepError,
};

/// An integrator that reaches the parts of a scene through pointers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Once<I>(pub(crate) I);

/// The integrator that a stepper has by default.
pub(crate) const DEFAULT: Once<EnergyMomentum> = Once(EnergyMomentum { time_step: 1e-3 });

impl<R: Real, I: Integrator<R>> Integrator<R> for Once<I> {
    type Workspace = I::Workspace;

    const ADAPTIVE: bool = I::ADAPTIVE;
    const SPANS_STEPS: bool = I::SPANS_STEPS;

    fn step<D: Dynamics<R>>(
        &self,
        scene: &D,
        state: &mut State<R>,
        limit: R,
        workspace: &mut I::Workspace,
    ) -> Result<Step<R>, StepError> {
        let mut step = |scene: &Pointed<'_, R>| self.step_of(scene, state, limit, workspace);
        with_pointers(scene.untested(), None, &mut |untested| {
            with_pointers(scene, Some(untested), &mut step)
        })
    }

    fn order(&self) -> u32 {
        self.0.order()
    }

    fn fixed_step(&self) -> Option<R> {
        self.0.fixed_step()
    }

    fn largest_stable_step(&self, stiffness: R, damping: R) -> Option<R> {
        self.0.largest_stable_step(stiffness, damping)
    }

    fn linear_step(
        &self,
        motion: &LinearMotion,
        start: [[f64; 6]; 2],
        time_step: f64,
    ) -> Option<[[f64; 6]; 2]> {
        self.0.linear_step(motion, start, time_step)
    }

    fn step_control(&self, workspace: &I::Workspace, state: &State<R>) -> Option<StepControl<R>> {
        self.0.step_control(workspace, state)
    }

    fn set_step_control(&self, workspace: &mut I::Workspace, control: StepControl<R>) {
        self.0.set_step_control(workspace, control);
    }

    fn clear(&self, workspace: &mut I::Workspace) {
        self.0.clear(workspace);
    }

    fn check(&self) -> Result<(), SceneError> {
        self.0.check()
    }
}

impl<I> Once<I> {
    /// The step of the method. It stands alone, so that it is compiled once.
    #[inline(never)]
    fn step_of<R: Real>(
        &self,
        scene: &Pointed<'_, R>,
        state: &mut State<R>,
        limit: R,
        workspace: &mut I::Workspace,
    ) -> Result<Step<R>, StepError>
    where
        I: Integrator<R>,
    {
        self.0.step(scene, state, limit, workspace)
    }
}

/// Calls `step` with the scene, whose parts are behind pointers.
fn with_pointers<R: Real, D: Dynamics<R>>(
    scene: &D,
    untested: Option<&Pointed<'_, R>>,
    step: &mut dyn FnMut(&Pointed<'_, R>) -> Result<Step<R>, StepError>,
) -> Result<Step<R>, StepError> {
    let body: &dyn RigidPointBody<R> = scene.body();
    let ground: &dyn SpringDamperGround<R> = scene.ground();
    let friction: &dyn SlidingFriction<R> = scene.friction();
    step(&Pointed {
        // Not a new model, which would evaluate every contact of the body in each step.
        model: scene.contact_model().with_parts(&body, &ground, &friction),
        gravity: scene.gravity(),
        force: scene.force(),
        inertia: scene.inertia_properties(),
        untested,
        probe: &|evaluate| scene.probe(evaluate),
    })
}

/// A scene whose parts are behind pointers.
struct Pointed<'a, R: Real> {
    model: ContactModel<
        'a,
        &'a dyn RigidPointBody<R>,
        &'a dyn SpringDamperGround<R>,
        &'a dyn SlidingFriction<R>,
        R,
    >,
    gravity: R::Vec3,
    force: &'a dyn Force<R>,
    inertia: &'a InertiaProperties<R>,
    /// The scene without a test of the values that its laws return. `None` for such a scene.
    untested: Option<&'a Self>,
    probe: &'a dyn Fn(&mut dyn FnMut()),
}

impl<'a, R: Real> Dynamics<R> for Pointed<'a, R> {
    type Body = &'a dyn RigidPointBody<R>;
    type Ground = &'a dyn SpringDamperGround<R>;
    type Friction = &'a dyn SlidingFriction<R>;
    type Force = &'a dyn Force<R>;
    type Untested = Self;

    fn contact_model(&self) -> ContactModel<'_, Self::Body, Self::Ground, Self::Friction, R> {
        self.model
    }
    fn gravity(&self) -> R::Vec3 {
        self.gravity
    }
    fn force(&self) -> &Self::Force {
        &self.force
    }
    fn inertia_properties(&self) -> &InertiaProperties<R> {
        self.inertia
    }
    fn untested(&self) -> &Self {
        self.untested.unwrap_or(self)
    }
    fn probe<T>(&self, evaluate: impl FnOnce() -> T) -> T {
        let (mut evaluate, mut value) = (Some(evaluate), None);
        (self.probe)(&mut || value = evaluate.take().map(|evaluate| evaluate()));
        value.unwrap()
    }
}
