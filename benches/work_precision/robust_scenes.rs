//! Scenes of the robust protocol: the eight trials of the coin report, and eight tosses.

use core::error::Error;
use core::hint::black_box;

use tumble::glam::DVec3;
use tumble::work_precision::{Method, Setting, reference};
use tumble::{
    AdaptiveEnergyMomentum, AdaptiveNystrom, BogackiShampine32, Coulomb, Cuboid, DormandPrince54,
    Dynamics, EnergyMomentum, FlatGround, Flight, ForwardEuler, Integrator, Nystrom, Radau5,
    RigidPointBody, Rk4, Scene, SceneError, SolidCoin, State, Stepper, StrangSplitting,
    SymplecticEuler, Trial, UniformGravity,
};

use crate::plain_rk4::{self, Law};
use crate::robust::timed;

/// Slip speed that an explicit method resolves, m/s.
const SLIP_SPEED: f64 = 1e-3;
/// Penetration depth at rest of the tossed bodies, m.
const SINK: f64 = 2e-5;
/// Damping over critical damping of one contact: a restitution of about a half.
const DAMPING_RATIO: f64 = 0.21;
const GRAVITY: f64 = 9.8;

/// Group of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    Trial,
    Toss,
}

/// A scene with its start and its end.
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) family: Family,
    /// Difference between the reference and one that is ten times less accurate, m.
    pub(crate) resolution: f64,
    end: State,
    seconds: f64,
    start: State,
    /// Bounding radius, m.
    bounding_radius: f64,
    law: Law,
    program: Box<Run>,
}

type Run = dyn Fn(&State, f64, Setting) -> Option<(State, f64)>;

impl Case {
    /// Distance of the centres and, in quadrature, the displacement of the farthest point by the
    /// rotation between the two, m.
    pub(crate) fn error(&self, end: &State) -> f64 {
        let between = end.orientation * self.end.orientation.conjugate();
        let angle = 2.0 * between.xyz().length().atan2(between.w.abs());
        (end.position - self.end.position)
            .length()
            .hypot(self.bounding_radius * angle)
    }

    /// Returns the end with an integrator of the crate and the time that it took, s, or `None` if
    /// the run failed.
    pub(crate) fn run(&self, setting: Setting) -> Option<(State, f64)> {
        (self.program)(&self.start, self.seconds, setting)
    }

    /// Returns the end with a Rk4 written by hand, and the time that it took, s.
    pub(crate) fn plain(&self, time_step: f64) -> (State, f64) {
        timed(|| {
            let steps = (self.seconds / time_step).ceil();
            let dt = self.seconds / steps;
            let mut state = black_box(self.start);
            for _ in 0..steps as u64 {
                state = plain_rk4::step(&self.law, &state, dt);
            }
            state
        })
    }
}

/// Returns all scenes.
pub(crate) fn cases() -> Result<Vec<Case>, Box<dyn Error>> {
    let mut all = Vec::new();
    for number in 1..=8 {
        all.push(trial(number)?);
    }
    // Heights (m), velocities (m/s) and angular velocities (rad/s) without a system, chosen before
    // any run.
    let throws = [
        (
            0.12,
            DVec3::new(0.3, 0.1, 0.4),
            DVec3::new(3.0, 41.0, -7.0),
            0.3,
        ),
        (
            0.08,
            DVec3::new(-0.5, 0.2, 0.0),
            DVec3::new(12.0, -18.0, 25.0),
            1.1,
        ),
        (
            0.15,
            DVec3::new(0.1, 0.6, 0.9),
            DVec3::new(-2.0, 9.0, 60.0),
            -0.6,
        ),
        (
            0.05,
            DVec3::new(0.8, 0.0, -0.2),
            DVec3::new(30.0, 4.0, -11.0),
            2.0,
        ),
    ];
    for (i, throw) in throws.into_iter().enumerate() {
        let coin = SolidCoin::new(4.93e-3, 0.01, 0.002);
        all.push(toss(
            format!("toss {} of a steel coin", i + 1),
            coin,
            120.0,
            throw,
        )?);
    }
    for (i, throw) in throws.into_iter().enumerate() {
        let die = Cuboid::cube(4.8e-3, 0.016);
        all.push(toss(format!("toss {} of a die", i + 1), die, 4.0, throw)?);
    }
    Ok(all)
}

fn trial(number: usize) -> Result<Case, Box<dyn Error>> {
    let trial = Trial {
        slip_speed: SLIP_SPEED,
        ..Trial::report(number).ok_or("no such trial")?
    };
    let law = Law {
        mass: Trial::<f64>::MASS,
        inertia: DVec3::new(0.25, 0.125, 0.125),
        contacts: trial.coin().contacts().to_vec(),
        rim: 0.0,
        stiffness: Trial::<f64>::STIFFNESS,
        damping: trial.damping,
        coefficient: trial.coefficient,
        slip_speed: trial.slip_speed,
        gravity: Trial::<f64>::GRAVITY,
    };
    let name = format!("trial {number}");
    case(name, Family::Trial, trial.coin(), law, trial.state(), 1.0)
}

/// A body thrown from a height (m) with velocity, angular velocity and an initial rotation about y
/// (rad). `carrying` contacts support it at rest.
fn toss<B: RigidPointBody + 'static>(
    name: String,
    body: B,
    carrying: f64,
    (height, velocity, spin, rotation): (f64, DVec3, DVec3, f64),
) -> Result<Case, Box<dyn Error>> {
    let mass = body.mass();
    let stiffness = mass * GRAVITY / (SINK * carrying);
    let law = Law {
        mass,
        inertia: body.inertia().to_cols_array_2d().map_diagonal(),
        contacts: body.contacts().to_vec(),
        rim: 0.0,
        stiffness,
        damping: 2.0 * DAMPING_RATIO * (stiffness * mass).sqrt(),
        coefficient: 0.3,
        slip_speed: SLIP_SPEED,
        gravity: GRAVITY,
    };
    let state = State::at(DVec3::Z * height)
        .with_linear_velocity(velocity)
        .with_rotation_vector(DVec3::Y * rotation);
    let state = Stepper::new(&body)?.with_angular_velocity(state, spin);
    case(name, Family::Toss, body, law, state, 0.4)
}

/// Diagonal of a matrix that is diagonal in body axes.
trait Diagonal {
    fn map_diagonal(self) -> DVec3;
}

impl Diagonal for [[f64; 3]; 3] {
    fn map_diagonal(self) -> DVec3 {
        DVec3::new(self[0][0], self[1][1], self[2][2])
    }
}

fn case<B: RigidPointBody + 'static>(
    name: String,
    family: Family,
    body: B,
    law: Law,
    start: State,
    seconds: f64,
) -> Result<Case, Box<dyn Error>> {
    let bounding_radius = body.bounding_radius();
    let ground = FlatGround::level(law.stiffness, law.damping);
    let friction = Coulomb {
        coefficient: law.coefficient,
        slip_speed: law.slip_speed,
    };
    let gravity = UniformGravity::down(law.gravity);
    let known = reference(
        &Scene::new(&body, ground, friction, gravity)?,
        &start,
        seconds,
    )?;
    let stepper = Stepper::new(body)?
        .with_ground(ground)?
        .with_friction(friction)?
        .with_gravity(gravity)?;
    Ok(Case {
        name,
        family,
        resolution: known.resolution,
        end: known.end,
        seconds,
        start,
        bounding_radius,
        law,
        program: Box::new(move |start, seconds, setting| run(&stepper, start, seconds, setting)),
    })
}

type OnGround<B, I> = Stepper<B, FlatGround, Coulomb, UniformGravity, I>;

fn run<B: RigidPointBody>(
    stepper: &OnGround<B, EnergyMomentum>,
    start: &State,
    seconds: f64,
    setting: Setting,
) -> Option<(State, f64)> {
    let value = setting.parameter;
    match setting.method {
        Method::ForwardEuler => moved(stepper, ForwardEuler { time_step: value }, start, seconds),
        Method::SymplecticEuler => moved(
            stepper,
            SymplecticEuler { time_step: value },
            start,
            seconds,
        ),
        Method::StrangSplitting => moved(
            stepper,
            StrangSplitting { time_step: value },
            start,
            seconds,
        ),
        Method::Rk4 => moved(stepper, Rk4 { time_step: value }, start, seconds),
        Method::Nystrom => moved(stepper, Nystrom { time_step: value }, start, seconds),
        Method::EnergyMomentum => {
            moved(stepper, EnergyMomentum { time_step: value }, start, seconds)
        }
        Method::BogackiShampine32 => moved(
            stepper,
            Flight(BogackiShampine32::new(value)),
            start,
            seconds,
        ),
        Method::AdaptiveEnergyMomentum => {
            moved(stepper, AdaptiveEnergyMomentum::new(value), start, seconds)
        }
        Method::AdaptiveNystrom => {
            moved(stepper, Flight(AdaptiveNystrom::new(value)), start, seconds)
        }
        Method::Radau5 => moved(stepper, Flight(Radau5::new(value)), start, seconds),
        _ => moved(stepper, Flight(DormandPrince54::new(value)), start, seconds),
    }
}

fn moved<B: RigidPointBody, I: Integrator>(
    stepper: &OnGround<B, EnergyMomentum>,
    integrator: I,
    start: &State,
    seconds: f64,
) -> Option<(State, f64)> {
    let composed = || -> Result<OnGround<&B, I>, SceneError> {
        let scene = stepper.scene();
        Stepper::new(stepper.body())?
            .with_ground(*scene.ground())?
            .with_friction(*scene.friction())?
            .with_gravity(UniformGravity::down(GRAVITY))?
            .with_integrator(integrator)
    };
    let stepper = composed().ok()?;
    let mut state = black_box(*start);
    let (done, time) = timed(|| stepper.advance(&mut state, seconds));
    done.ok()?;
    Some((state, time))
}
