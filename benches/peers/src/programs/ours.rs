//! The library.

use tumble::glam::{DMat3, DVec3};
use tumble::{
    AdaptiveNystrom, BogackiShampine32, Coin, ContactPoint, Coulomb, DormandPrince54,
    EnergyMomentum, FlatGround, Flight, Gravity, Integrator, Nystrom, Radau5, RigidPointBody, Rk4,
    Sample, SlidingFriction, SpringDamperGround, State, Stepper, StrangSplitting, Timed,
    UniformGravity,
};

use core::ops::ControlFlow;

use super::{End, Program, Watch};
use crate::scene::{Scene, Shape};

/// A composed scene and its name.
struct Ours<S> {
    stepper: S,
    name: &'static str,
    settings: String,
    start: State,
    seconds: f64,
    is_sampled: bool,
}

/// A body with given mass, inertia and contacts.
struct Given {
    mass: f64,
    inertia: DVec3,
    contacts: Vec<ContactPoint>,
    /// Bounding radius, m.
    bounding_radius: f64,
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
    // A body in flight has no contact here, but a tolerance in metres requires the size of the
    // body.
    fn bounding_radius(&self) -> f64 {
        self.bounding_radius
    }
}

/// A hoop that touches at its lowest point alone.
struct Hoop {
    given: Given,
    /// Represents the contact.
    ball: [ContactPoint; 1],
}

impl Hoop {
    fn of(scene: &Scene, radius: f64) -> Self {
        let ball = ContactPoint {
            position: DVec3::ZERO,
            radius,
        };
        Self {
            given: given(scene),
            ball: [ball],
        }
    }
}

impl RigidPointBody for Hoop {
    fn mass(&self) -> f64 {
        self.given.mass()
    }
    fn inertia(&self) -> DMat3 {
        self.given.inertia()
    }
    fn contacts(&self) -> &[ContactPoint] {
        &self.ball
    }
    fn bounding_radius(&self) -> f64 {
        self.ball[0].radius
    }
    fn is_symmetric(&self) -> bool {
        true
    }
    fn is_smooth(&self) -> bool {
        true
    }
    fn support_point(&self, towards: DVec3) -> DVec3 {
        towards.with_x(0.0).normalize_or_zero() * self.ball[0].radius
    }
}

impl<B, G, F, A, I> Program for Ours<Stepper<B, G, F, A, I>>
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

    fn is_sampled(&self) -> bool {
        self.is_sampled
    }

    fn run(&self, watch: Option<Watch<'_>>) -> Result<End, String> {
        if self.is_sampled {
            self.run_sampled(watch)
        } else {
            self.run_in_one_call(watch)
        }
    }
}

impl<B, G, F, A, I> Ours<Stepper<B, G, F, A, I>>
where
    B: RigidPointBody,
    G: SpringDamperGround,
    F: SlidingFriction,
    A: Gravity,
    I: Integrator,
{
    fn run_sampled(&self, mut watch: Option<Watch<'_>>) -> Result<End, String> {
        let (mut state, mut steps) = (self.start, 0);
        let observer = |sample: &Sample<'_>| {
            steps = sample.step;
            match &mut watch {
                Some(watch) => watch(sample.state),
                None => {
                    core::hint::black_box(sample.state);
                }
            }
            ControlFlow::Continue(())
        };
        let mut samples = Timed::every(super::sample_interval(self.seconds), observer)
            .map_err(|error| error.to_string())?;
        let run = self.stepper.run(&mut state, self.seconds, &mut samples);
        run.map_err(|error| error.to_string())?;
        Ok(End {
            state,
            steps,
            preparation: 0.0,
        })
    }

    fn run_in_one_call(&self, mut watch: Option<Watch<'_>>) -> Result<End, String> {
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

/// Tolerances of the table of all programs, in units of the scene's length.
pub(crate) const TOLERANCES: [f64; 10] =
    [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11];

/// Returns the library on a scene: each integrator with each step size of the scene, and with each
/// tolerance.
///
/// The adaptive methods are also sampled at 240 Hz.
pub(crate) fn programs(scene: &Scene) -> Result<Vec<Box<dyn Program + '_>>, String> {
    let mut all = with_steps(scene)?;
    all.extend(with_tolerances(scene, &TOLERANCES, false)?);
    all.extend(with_tolerances(scene, &TOLERANCES, true)?);
    if scene.shape == Shape::Free {
        let time_step = 0.1;
        for is_sampled in [false, true] {
            let settings = if is_sampled { "240 Hz" } else { "one step" };
            let flight = Flight(Rk4 { time_step });
            all.push(composed(
                scene,
                "Flight",
                settings.into(),
                flight,
                is_sampled,
            )?);
        }
    }
    Ok(all)
}

fn with_steps(scene: &Scene) -> Result<Vec<Box<dyn Program + '_>>, String> {
    let mut all: Vec<Box<dyn Program>> = Vec::new();
    let step = super::name_of_step;
    for &time_step in &scene.steps {
        all.push(composed(
            scene,
            "EnergyMomentum",
            step(time_step),
            EnergyMomentum { time_step },
            false,
        )?);
    }
    for &time_step in &scene.steps {
        all.push(composed(
            scene,
            "StrangSplitting",
            step(time_step),
            StrangSplitting { time_step },
            false,
        )?);
    }
    for &time_step in &scene.steps {
        let rk4 = Rk4 { time_step };
        all.push(composed(scene, "Rk4", step(time_step), rk4, false)?);
    }
    for &time_step in &scene.steps {
        all.push(composed(
            scene,
            "Nystrom",
            step(time_step),
            Nystrom { time_step },
            false,
        )?);
    }
    Ok(all)
}

/// Returns the adaptive methods with each of the tolerances, in units of the scene's length.
pub(crate) fn with_tolerances<'a>(
    scene: &'a Scene,
    tolerances: &[f64],
    is_sampled: bool,
) -> Result<Vec<Box<dyn Program + 'a>>, String> {
    let plan = (tolerances, is_sampled);
    let mut all = with_tolerance(scene, "DormandPrince54", plan, |setting| DormandPrince54 {
        tolerance: setting.tolerance,
        longest_step: setting.longest_step,
        budget: setting.budget,
    })?;
    if scene.shape == Shape::Free {
        return Ok(all);
    }
    all.extend(with_tolerance(
        scene,
        "BogackiShampine32",
        plan,
        |setting| BogackiShampine32 {
            tolerance: setting.tolerance,
            longest_step: setting.longest_step,
            budget: setting.budget,
        },
    )?);
    all.extend(with_tolerance(scene, "AdaptiveNystrom", plan, |setting| {
        AdaptiveNystrom {
            tolerance: setting.tolerance,
            longest_step: setting.longest_step,
            budget: setting.budget,
        }
    })?);
    all.extend(with_tolerance(scene, "Radau5", plan, |setting| Radau5 {
        tolerance: setting.tolerance,
        longest_step: setting.longest_step,
        budget: setting.budget,
    })?);
    Ok(all)
}

/// Setting of an adaptive method.
struct Setting {
    /// m.
    tolerance: f64,
    /// s.
    longest_step: f64,
    /// Largest number of steps.
    budget: u32,
}

/// Returns an adaptive method with each of the tolerances. Flights are in closed form where the
/// body can touch; in the free scenes that would leave nothing to the method.
fn with_tolerance<'a, I: Integrator + 'a>(
    scene: &'a Scene,
    name: &'static str,
    (tolerances, is_sampled): (&[f64], bool),
    method: impl Fn(Setting) -> I,
) -> Result<Vec<Box<dyn Program + 'a>>, String>
where
    Flight<I>: Integrator,
{
    let (length, time) = scene.scale;
    // In empty space no step is too long to find a contact.
    let longest_step = match scene.shape {
        Shape::Free => scene.seconds,
        _ => 0.1 * time,
    };
    let one = |&tolerance: &f64| {
        let label = super::name_of_tolerance(tolerance, is_sampled);
        let method = method(Setting {
            tolerance: tolerance * length,
            longest_step,
            budget: super::most_steps(&scene.law),
        });
        match scene.shape {
            Shape::Free => composed(scene, name, label, method, is_sampled),
            _ => composed(scene, name, label, Flight(method), is_sampled),
        }
    };
    tolerances.iter().map(one).collect()
}

/// Energy of a state as the library computes it, J.
pub(crate) fn energy(scene: &Scene) -> Result<impl Fn(&State) -> f64 + use<>, String> {
    let integrator = EnergyMomentum { time_step: 1e-3 };
    let stepper =
        composed_of(scene, given(scene), integrator).map_err(|error| error.to_string())?;
    Ok(move |state: &State| stepper.energy(state).total())
}

/// Composes a scene with an integrator as one type.
fn composed<'a, I: Integrator + 'a>(
    scene: &'a Scene,
    name: &'static str,
    settings: String,
    integrator: I,
    is_sampled: bool,
) -> Result<Box<dyn Program + 'a>, String> {
    let boxed = move || -> Result<Box<dyn Program + 'a>, tumble::SceneError> {
        Ok(match scene.shape {
            Shape::Free => {
                let stepper = Stepper::new(given(scene))?.with_integrator(integrator)?;
                Box::new(ours_of(stepper, name, settings, scene, is_sampled))
            }
            Shape::Ball(_) => {
                let stepper = composed_of(scene, given(scene), integrator)?;
                Box::new(ours_of(stepper, name, settings, scene, is_sampled))
            }
            Shape::Hoop(radius) => {
                let stepper = composed_of(scene, Hoop::of(scene, radius), integrator)?;
                Box::new(ours_of(stepper, name, settings, scene, is_sampled))
            }
            Shape::Coin(radius) => {
                let points = vec![ContactPoint::default(); scene.law.contacts.len()];
                let coin = Coin::ring_with_storage(points, scene.law.mass, radius);
                Box::new(ours_of(
                    composed_of(scene, coin, integrator)?,
                    name,
                    settings,
                    scene,
                    is_sampled,
                ))
            }
        })
    };
    boxed().map_err(|error| error.to_string())
}

fn ours_of<S>(
    stepper: S,
    name: &'static str,
    settings: String,
    scene: &Scene,
    is_sampled: bool,
) -> Ours<S> {
    Ours {
        stepper,
        name,
        settings,
        start: scene.soft.start,
        seconds: scene.seconds,
        is_sampled,
    }
}

fn given(scene: &Scene) -> Given {
    Given {
        mass: scene.law.mass,
        inertia: scene.law.inertia,
        contacts: scene.law.contacts.clone(),
        bounding_radius: match scene.shape {
            Shape::Free => 0.5,
            _ => scene.law.bounding_radius(),
        },
    }
}

type OnGround<B, I> = Stepper<B, FlatGround, Coulomb, UniformGravity, I>;

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
