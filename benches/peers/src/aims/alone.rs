//! Aims that concern the library alone.

use core::hint::black_box;
use core::time::Duration;

use cpu_time::ThreadTime;
use tumble::glam::{DVec3, Vec3};
use tumble::{
    ContactPoint, Coulomb, Cuboid, EnergyMomentum, FlatGround, SolidCoin, State, Stepper,
    UniformGravity,
};

use crate::aims::Aim;

const GRAVITY: f64 = 9.8;
/// Step of a frame of a game, s.
const FRAME: f64 = 1.0 / 60.0;

pub(super) fn text(error: impl core::fmt::Display) -> String {
    error.to_string()
}

/// Least time of some repetitions, ns.
pub(super) fn least(
    repetitions: usize,
    mut work: impl FnMut() -> Result<(), String>,
) -> Result<f64, String> {
    let mut least = Duration::MAX;
    for _ in 0..repetitions {
        let clock = ThreadTime::now();
        work()?;
        least = least.min(clock.elapsed());
    }
    Ok(1e9 * least.as_secs_f64())
}

/// Cost of a contact in a step of `EnergyMomentum`, of a coin that slides flat on its points.
///
/// All points together have one stiffness and one damping, so that the motion is that of one ground
/// for any number of them.
pub(super) fn of_contacts() -> Result<Vec<Aim>, String> {
    const STEPS: u32 = 40;
    const STIFFNESS: f64 = 1e5;
    const DAMPING: f64 = 30.0;
    let mut aims = Vec::new();
    for count in [12, 120, 1_200, 12_000] {
        eprintln!("{count} contacts ...");
        let points = vec![ContactPoint::default(); 2 * count];
        let coin = SolidCoin::new_with_storage(points, 1.0, 0.5, 0.02);
        let share = 1.0 / count as f64;
        let stepper = Stepper::builder(coin)
            .gravity(UniformGravity::down(GRAVITY))
            .ground(FlatGround::level(STIFFNESS * share, DAMPING * share))
            .friction(Coulomb {
                coefficient: 0.3,
                slip_speed: 1e-3,
            })
            .integrator(EnergyMomentum { time_step: 1e-3 })
            .build()
            .map_err(text)?;
        let flat = DVec3::Y * core::f64::consts::FRAC_PI_2;
        let start = State::at(DVec3::Z * (0.01 - GRAVITY / STIFFNESS))
            .with_rotation_vector(flat)
            .with_linear_velocity(DVec3::X * 2.0);
        let time = least(7, || {
            let mut session = stepper.session(black_box(start));
            for _ in 0..STEPS {
                session.step().map_err(text)?;
            }
            Ok(())
        })?;
        let contact = time / f64::from(STEPS) / count as f64;
        let what = format!("`EnergyMomentum`, a coin slides flat on {count} points: a contact");
        aims.push(Aim::new(what, 45.0, Some(contact)).in_unit("ns"));
    }
    Ok(aims)
}

/// Cost of a step of a frame on stiff ground over that of a fourth of it, of thrown boxes.
pub(super) fn of_long_steps() -> Result<Aim, String> {
    eprintln!("long steps ...");
    let cost = |time_step: f64| -> Result<f64, String> {
        let stepper = Stepper::builder(Cuboid::solid(1.0, DVec3::new(0.3, 0.2, 0.1)))
            .gravity(UniformGravity::down(GRAVITY))
            .ground(FlatGround::level(1e9, 1e3))
            .friction(Coulomb {
                coefficient: 0.4,
                slip_speed: 1e-3,
            })
            .integrator(EnergyMomentum { time_step })
            .build()
            .map_err(text)?;
        let mut steps = 0;
        let time = least(5, || {
            steps = 0;
            for throw in 0..20 {
                let [x, y] = [7, 13].map(|factor| f64::from(factor * throw % 20) - 10.0);
                let start = State::at(DVec3::Z * 0.3)
                    .with_linear_velocity(DVec3::new(1.0, 0.1 * y, -1.0))
                    .with_rotation_vector(DVec3::new(0.1 * x, 0.1 * y, 0.3));
                let start = stepper.with_angular_velocity(start, DVec3::new(x, y, 3.0));
                let mut session = stepper.session(start);
                while session.time() < 1.0 {
                    session.step().map_err(text)?;
                    steps += 1;
                }
            }
            Ok(())
        })?;
        Ok(time / f64::from(steps))
    };
    let what = "`EnergyMomentum`, 20 thrown boxes for 1 s, 1e9 N/m a point: a step of 1/60 s over \
                one of 1/240 s";
    Ok(Aim::new(
        what,
        2.0,
        Some(cost(FRAME)? / cost(0.25 * FRAME)?),
    ))
}

/// Cost of a frame of a body that has come to rest.
pub(super) fn of_rest() -> Result<Aim, String> {
    eprintln!("rest ...");
    const FRAMES: u32 = 10_000;
    let stepper = Stepper::builder(Cuboid::solid(1.0, DVec3::new(0.3, 0.2, 0.1)))
        .gravity(UniformGravity::down(GRAVITY))
        .ground(FlatGround::level(1e4, 10.0))
        .friction(Coulomb {
            coefficient: 0.4,
            slip_speed: 1e-3,
        })
        .integrator(EnergyMomentum { time_step: 1e-3 })
        .build()
        .map_err(text)?;
    let mut session = stepper.session(State::at(DVec3::Z * 0.05));
    session.advance(60.0).map_err(text)?;
    let time = least(5, || {
        for _ in 0..FRAMES {
            session.advance(black_box(FRAME)).map_err(text)?;
        }
        Ok(())
    })?;
    let what = "a body at rest in a session, `advance` by 1/60 s";
    Ok(Aim::new(what, 100.0, Some(time / f64::from(FRAMES))).in_unit("ns"))
}

/// Change of the angular momentum of a box in flight, and of the energy of one that bounces, in
/// single precision with steps of a frame.
pub(super) fn of_single_precision() -> Result<[Aim; 2], String> {
    eprintln!("single precision ...");
    let body = || Cuboid::<f32>::solid(1.0, Vec3::new(0.3, 0.2, 0.05));
    let integrator = EnergyMomentum {
        time_step: FRAME as f32,
    };
    let flying = Stepper::builder(body())
        .integrator(integrator)
        .build()
        .map_err(text)?;
    let start = State::at(Vec3::ZERO).with_linear_velocity(Vec3::X * 10.0);
    let start = flying.with_angular_velocity(start, Vec3::new(3.0, 29.0, 7.0));
    let mut state = start;
    flying.advance(&mut state, 5.0).map_err(text)?;
    let change = (state.angular_momentum - start.angular_momentum).length();
    let a_second = f64::from(change / start.angular_momentum.length()) / 5.0;

    let bouncing = Stepper::builder(body())
        .gravity(UniformGravity::down(GRAVITY as f32))
        .ground(FlatGround::level(1e5, 0.0))
        .integrator(integrator)
        .build()
        .map_err(text)?;
    let start = State::at(Vec3::Z * 0.5).with_rotation_vector(Vec3::new(0.4, 0.7, 0.2));
    let mut state = start;
    bouncing.advance(&mut state, 100.0).map_err(text)?;
    let energy = |state: &State<f32>| f64::from(bouncing.energy(state).total());
    let lost = (energy(&start) - energy(&state)) / energy(&start);
    let what = "one box in `f32`, steps of 1/60 s";
    Ok([
        Aim::new(
            format!("{what}: change of the angular momentum in flight, a second"),
            1e-5,
            Some(a_second),
        ),
        Aim::new(
            format!("{what}: energy lost after 100 s of elastic bounces"),
            1e-3,
            Some(lost.abs()),
        ),
    ])
}
