//! Composition of a stepper from its parts, with one check at the end.

use core::marker::PhantomData;

use crate::body::RigidPointBody;
use crate::error::SceneError;
use crate::force::{Force, NoForce};
use crate::friction::SlidingFriction;
use crate::gravity::Gravity;
use crate::ground::SpringDamperGround;
use crate::integrator::Integrator;
use crate::real::Real;
use crate::scene::{Dynamics, Scene};
use crate::stepper::Stepper;

/// Parts of a scene and its integrator, before they are checked.
///
/// Created by [`Stepper::builder`]. Each method replaces one part, and [`build`](Self::build)
/// checks all of them once.
#[derive(Clone, Copy, Debug)]
#[must_use = "a builder does nothing before `build`"]
pub struct StepperBuilder<B, G, F, A, I, R: Real = f64, E = NoForce> {
    body: B,
    ground: G,
    friction: F,
    gravity: A,
    integrator: I,
    force: E,
    precision: PhantomData<R>,
}

impl<R: Real, B, G, F, A, I, E> StepperBuilder<B, G, F, A, I, R, E> {
    pub(super) fn new(
        body: B,
        ground: G,
        friction: F,
        gravity: A,
        integrator: I,
        force: E,
    ) -> Self {
        Self {
            body,
            ground,
            friction,
            gravity,
            integrator,
            force,
            precision: PhantomData,
        }
    }

    /// Sets the ground. Default: none.
    pub fn ground<G2>(self, ground: G2) -> StepperBuilder<B, G2, F, A, I, R, E>
    where
        G2: SpringDamperGround<R>,
    {
        let (friction, gravity, force) = (self.friction, self.gravity, self.force);
        StepperBuilder::new(self.body, ground, friction, gravity, self.integrator, force)
    }

    /// Sets the friction law. Default: no friction.
    pub fn friction<F2>(self, friction: F2) -> StepperBuilder<B, G, F2, A, I, R, E>
    where
        F2: SlidingFriction<R>,
    {
        let (ground, gravity, force) = (self.ground, self.gravity, self.force);
        StepperBuilder::new(self.body, ground, friction, gravity, self.integrator, force)
    }

    /// Sets gravity. Default: none.
    pub fn gravity<A2>(self, gravity: A2) -> StepperBuilder<B, G, F, A2, I, R, E>
    where
        A2: Gravity<R>,
    {
        let (ground, friction, force) = (self.ground, self.friction, self.force);
        StepperBuilder::new(self.body, ground, friction, gravity, self.integrator, force)
    }

    /// Sets the integrator. Default: [`EnergyMomentum`](crate::EnergyMomentum) with a step size of
    /// 1 ms.
    pub fn integrator<I2>(self, integrator: I2) -> StepperBuilder<B, G, F, A, I2, R, E>
    where
        I2: Integrator<R>,
    {
        let (ground, friction, force) = (self.ground, self.friction, self.force);
        StepperBuilder::new(self.body, ground, friction, self.gravity, integrator, force)
    }

    /// Sets the applied force, for example [`AirDrag`](crate::AirDrag). Default: none. A tuple
    /// applies several forces.
    pub fn force<E2>(self, force: E2) -> StepperBuilder<B, G, F, A, I, R, E2>
    where
        E2: Force<R>,
    {
        let (ground, friction, gravity) = (self.ground, self.friction, self.gravity);
        StepperBuilder::new(self.body, ground, friction, gravity, self.integrator, force)
    }

    /// Checks the parts and composes the stepper.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a part is invalid, if the integrator cannot step the body, or if
    /// there are several friction laws and their number is not that of the surfaces. Also returns
    /// it if the weight, the constant force, the bounding radius, or the inverse of the mass or of
    /// a moment of inertia overflows. The error names the quantity, the rule and the value.
    pub fn build(self) -> Result<Stepper<B, G, F, A, I, R, E>, SceneError>
    where
        B: RigidPointBody<R>,
        G: SpringDamperGround<R>,
        F: SlidingFriction<R>,
        A: Gravity<R>,
        I: Integrator<R>,
        E: Force<R>,
    {
        self.integrator.check()?;
        let scene = Scene::new(self.body, self.ground, self.friction, self.gravity)?;
        let scene = scene.with_force(self.force)?;
        self.integrator.check_body(scene.body())?;
        Ok(Stepper {
            scene,
            integrator: self.integrator,
        })
    }
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString;

    use crate::*;

    #[test]
    fn a_builder_composes_what_the_parts_one_by_one_do() {
        let (coin, gravity) = (Coin::<f64>::ring(1.0, 0.5), UniformGravity::down(9.8));
        let (ground, viscous) = (FlatGround::level(1e3, 0.5), Viscous { coefficient: 0.2 });
        let integrator = Rk4 { time_step: 1e-3 };
        let at_once = Stepper::builder(coin)
            .friction(viscous)
            .integrator(integrator)
            .ground(ground)
            .gravity(gravity)
            .build()
            .unwrap();
        let one_by_one = Stepper::new(coin)
            .and_then(|stepper| stepper.with_gravity(gravity))
            .and_then(|stepper| stepper.with_ground(ground))
            .and_then(|stepper| stepper.with_friction(viscous))
            .and_then(|stepper| stepper.with_integrator(integrator))
            .unwrap();
        assert_eq!(at_once, one_by_one);
    }

    #[test]
    fn each_invalid_part_is_named_when_it_is_built() {
        let builder = || Stepper::builder(Coin::<f64>::ring(1.0, 0.5));
        let errors = [
            Stepper::builder(Coin::<f64>::ring(-1.0, 0.5)).build().err(),
            builder().ground(FlatGround::level(-1.0, 0.0)).build().err(),
            builder()
                .friction(Viscous { coefficient: -1.0 })
                .build()
                .err(),
            builder()
                .gravity(UniformGravity::down(f64::NAN))
                .build()
                .err(),
            builder().integrator(Rk4 { time_step: -1.0 }).build().err(),
        ];
        let named = [
            "mass",
            "stiffness",
            "viscous friction",
            "gravity",
            "time step",
        ];
        for (error, name) in errors.into_iter().zip(named) {
            let text = error.unwrap().to_string();
            assert!(text.contains(name), "{text}");
        }
    }
}
