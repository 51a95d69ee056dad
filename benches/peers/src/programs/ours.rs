//! The library.

use tumble::glam::{DMat3, DVec3};
use tumble::{
    Coin, ContactPoint, Coulomb, EnergyMomentum, FlatGround, Gravity, Integrator, RigidPointBody,
    Rk4, Sample, SlidingFriction, SpringDamperGround, State, Stepper, StrangSplitting,
    UniformGravity,
};

use core::ops::ControlFlow;

use super::{End, Program, Watch};
use crate::scene::{Scene, Shape};

/// A composed scene and what it is called.
struct Ours<S> {
    stepper: S,
    name: &'static str,
    settings: String,
    start: State,
    seconds: f64,
}

/// A body whose mass, inertia and contacts are given.
struct Given {
    mass: f64,
    inertia: DVec3,
    contacts: Vec<ContactPoint>,
}

impl RigidPointBody for Given {
    fn mass(&self) -> f64 {
        self.mass
    }
    fn inertia(&self) -> DMat3 {
        DMat3::from_diagonal(self.inertia)
    }
    fn contacts(&self) -> &[ContactPoint] {
        &self.contacts
    }
}

impl<B, G, F, A, I> Program for Ours<Stepper<f64, B, G, F, A, I>>
where
    B: RigidPointBody,
    G: SpringDamperGround,
    F: SlidingFriction,
    A: Gravity,
    I: Integrator,
{
    fn name(&self) -> String {
        format!("tumble {}", self.name)
    }

    fn settings(&self) -> String {
        self.settings.clone()
    }

    fn is_ours(&self) -> bool {
        true
    }

    fn run(&self, mut watch: Option<Watch<'_>>) -> Result<End, String> {
        let (mut state, mut steps) = (self.start, 0);
        let mut observer = |sample: &Sample<'_>| {
            steps = sample.step;
            if let Some(watch) = &mut watch {
                watch(sample.state);
            }
            ControlFlow::Continue(())
        };
        let run = self.stepper.run(&mut state, self.seconds, &mut observer);
        run.map_err(|error| error.to_string())?;
        Ok(End {
            state,
            steps,
            preparation: 0.0,
        })
    }
}

/// The library on a scene: each integrator at each of the scene's steps.
pub(crate) fn programs(scene: &Scene) -> Result<Vec<Box<dyn Program + '_>>, String> {
    let mut all: Vec<Box<dyn Program>> = Vec::new();
    for &time_step in &scene.steps {
        all.push(composed(
            scene,
            "EnergyMomentum",
            time_step,
            EnergyMomentum { time_step },
        )?);
    }
    for &time_step in &scene.steps {
        all.push(composed(
            scene,
            "StrangSplitting",
            time_step,
            StrangSplitting { time_step },
        )?);
    }
    for &time_step in &scene.steps {
        all.push(composed(scene, "Rk4", time_step, Rk4 { time_step })?);
    }
    Ok(all)
}

/// The energy of a state by the library's own books, J.
pub(crate) fn energy(scene: &Scene) -> Result<impl Fn(&State) -> f64 + use<>, String> {
    let integrator = EnergyMomentum { time_step: 1e-3 };
    let stepper =
        composed_of(scene, given(scene), integrator).map_err(|error| error.to_string())?;
    Ok(move |state: &State| stepper.energy(state).total())
}

/// A scene with an integrator, behind one type.
fn composed<'a, I: Integrator + 'a>(
    scene: &'a Scene,
    name: &'static str,
    time_step: f64,
    integrator: I,
) -> Result<Box<dyn Program + 'a>, String> {
    let boxed = || -> Result<Box<dyn Program + 'a>, tumble::SceneError> {
        Ok(match scene.shape {
            Shape::Free => {
                let stepper = Stepper::new(given(scene))?.with_integrator(integrator)?;
                Box::new(ours_of(stepper, name, time_step, scene))
            }
            Shape::Ball(_) => {
                let stepper = composed_of(scene, given(scene), integrator)?;
                Box::new(ours_of(stepper, name, time_step, scene))
            }
            Shape::Coin(radius) => {
                let points = vec![ContactPoint::default(); scene.law.contacts.len()];
                let coin = Coin::ring_in(points, scene.law.mass, radius);
                Box::new(ours_of(
                    composed_of(scene, coin, integrator)?,
                    name,
                    time_step,
                    scene,
                ))
            }
        })
    };
    boxed().map_err(|error| error.to_string())
}

fn ours_of<S>(stepper: S, name: &'static str, time_step: f64, scene: &Scene) -> Ours<S> {
    Ours {
        stepper,
        name,
        settings: format!("{time_step:.0e} s"),
        start: scene.soft.start,
        seconds: scene.seconds,
    }
}

fn given(scene: &Scene) -> Given {
    Given {
        mass: scene.law.mass,
        inertia: scene.law.inertia,
        contacts: scene.law.contacts.clone(),
    }
}

type OnGround<B, I> = Stepper<f64, B, FlatGround, Coulomb, UniformGravity, I>;

fn composed_of<B: RigidPointBody, I: Integrator>(
    scene: &Scene,
    body: B,
    integrator: I,
) -> Result<OnGround<B, I>, tumble::SceneError> {
    let law = &scene.law;
    Stepper::new(body)?
        .with_ground(FlatGround::level(law.stiffness, law.damping))?
        .with_friction(Coulomb {
            coefficient: law.coefficient,
            slip_speed: law.slip_speed,
        })?
        .with_gravity(UniformGravity::down(law.gravity))?
        .with_integrator(integrator)
}
