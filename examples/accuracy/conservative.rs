//! Conservative motion in single precision: free flight of bodies with three moments, elastic
//! bounces, and falls.
//!
//! The figures do not depend on a clock or a machine.

use core::error::Error;

use common::table::{cells, text};
use common::{marked, say};
use tumble::f32::{
    Capsule, Coin, Cone, Cuboid, Disc, Ellipsoid, EnergyMomentum, FlatGround, PointCloud,
    SolidCoin, Sphere, State, Stepper, UniformGravity,
};
use tumble::glam::Vec3;
use tumble::{RigidPointBody, StepError};

/// Step sizes, s. The first is a frame of a game.
const STEPS: [f32; 4] = [1.0 / 60.0, 4e-3, 1e-3, 1e-4];

const BEGIN: &str = "<!-- f32 motion: begin; written by `accuracy -- --f32-motion --write` -->";
const END: &str = "<!-- f32 motion: end -->";

type Body = Box<dyn RigidPointBody<f32>>;
type Failure = Box<dyn Error>;

/// Prints the tables, or writes them into the page of the guide.
pub(crate) fn tables(is_written: bool) -> Result<(), Failure> {
    let tables = [flights()?, bounces()?, falls()?].join("\n");
    if !is_written {
        say(tables);
        return Ok(());
    }
    marked::write("src/guide/accuracy.md", [BEGIN, END], &tables)
}

/// Bodies of a kilogram. The first three have three different moments.
fn bodies() -> Result<[(&'static str, Body); 9], Failure> {
    let corners = [
        Vec3::new(0.3, 0.0, 0.0),
        Vec3::new(-0.1, 0.2, 0.0),
        Vec3::new(-0.1, -0.1, 0.25),
        Vec3::new(-0.1, -0.1, -0.25),
    ];
    Ok([
        (
            "box 0.3 x 0.2 x 0.05 m",
            Box::new(Cuboid::solid(1.0, Vec3::new(0.3, 0.2, 0.05))),
        ),
        (
            "ellipsoid 0.3, 0.2, 0.1 m",
            Box::new(Ellipsoid::solid(1.0, Vec3::new(0.3, 0.2, 0.1))),
        ),
        (
            "four points",
            Box::new(PointCloud::new(corners, [0.4, 0.3, 0.2, 0.1])?),
        ),
        ("ring of 120 points, 0.5 m", Box::new(Coin::ring(1.0, 0.5))),
        ("disc, 0.3 m", Box::new(Disc::solid(1.0, 0.3, 120))),
        (
            "coin of 0.3 m, 0.05 m thick",
            Box::new(SolidCoin::new(1.0, 0.3, 0.05)),
        ),
        ("ball, 0.2 m", Box::new(Sphere::solid(1.0, 0.2))),
        (
            "capsule, 0.1 m, 0.3 m long",
            Box::new(Capsule::solid(1.0, 0.1, 0.3)),
        ),
        (
            "cone, 0.2 m, 0.3 m high",
            Box::new(Cone::solid(1.0, 0.2, 0.3)),
        ),
    ])
}

fn head(what: &str) -> Vec<String> {
    let mut head = vec![what.to_owned()];
    head.extend(STEPS.map(|step| match step {
        step if step > 0.01 => "1/60 s".to_owned(),
        step => format!("{} ms", (step * 1e4).round() * 0.1),
    }));
    head
}

/// Largest relative change of the angular momentum in 10 s, over three spins.
fn flights() -> Result<String, Failure> {
    let mut rows = vec![head("free flight for 10 s, change of L / L")];
    for (name, body) in bodies()?.iter().take(3) {
        let mut row = vec![(*name).to_owned()];
        for time_step in STEPS {
            let stepper = Stepper::new(&**body)?.with_integrator(EnergyMomentum { time_step })?;
            let mut worst = 0.0_f32;
            for spin in [0.3, 30.0, 300.0] {
                let start = State::at(Vec3::ZERO).with_linear_velocity(Vec3::new(7.0, -3.0, 6.0));
                let start = stepper.with_angular_velocity(start, Vec3::new(0.1, 1.0, 0.2) * spin);
                let mut state = start;
                stepper.advance(&mut state, 10.0)?;
                let change = state.angular_momentum - start.angular_momentum;
                worst = worst.max(change.length() / start.angular_momentum.length());
            }
            row.push(format!("{worst:.1e}"));
        }
        rows.push(row);
    }
    Ok(text(&rows))
}

/// Relative change of the energy in 100 s of bounces without losses.
fn bounces() -> Result<String, Failure> {
    let mut rows = vec![head("elastic bounces for 100 s, change of E / E")];
    for (name, body) in bodies()? {
        let mut row = vec![name.to_owned()];
        for time_step in STEPS {
            let change = bounce(&*body, time_step).map_or("-".into(), |it| format!("{it:.1e}"));
            row.push(change);
        }
        rows.push(row);
    }
    Ok(text(&rows))
}

/// Relative change of the energy of bounces from 1 m, with a spin, on 1e5 N/m.
fn bounce(body: &dyn RigidPointBody<f32>, time_step: f32) -> Result<f32, Failure> {
    let stepper = Stepper::builder(body)
        .gravity(UniformGravity::down(9.8))
        .ground(FlatGround::level(1e5, 0.0))
        .integrator(EnergyMomentum { time_step })
        .build()?;
    let state = State::at(Vec3::Z).with_linear_velocity(Vec3::new(0.3, 0.2, 0.0));
    let mut state = stepper.with_angular_velocity(state, Vec3::new(0.6, 2.0, 0.9));
    let before = stepper.energy(&state).total();
    stepper.advance(&mut state, 100.0)?;
    Ok((stepper.energy(&state).total() - before) / before)
}

/// Largest relative error of the displacement in a fall of 10 s from rest, over directions of
/// gravity and starting points.
fn falls() -> Result<String, Failure> {
    let gravities = [100.0, 9.81, 1.6, 0.1, 0.01, 0.001];
    let mut top = vec!["fall for 10 s, error of the displacement".to_owned()];
    top.extend(gravities.map(|gravity| format!("{gravity} m/s²")));
    let mut rows = vec![top];
    let steps = [
        ("100 ms", 0.1),
        ("10 ms", 1e-2),
        ("1 ms", 1e-3),
        ("0.1 ms", 1e-4),
        ("0.01 ms", 1e-5),
    ];
    for (name, time_step) in steps {
        let mut row = cells([name]);
        for gravity in gravities {
            row.push(format!("{:.1e}", worst_fall(gravity, time_step)?));
        }
        rows.push(row);
    }
    Ok(text(&rows))
}

fn worst_fall(gravity: f32, time_step: f32) -> Result<f64, Failure> {
    let directions = [
        Vec3::NEG_Z,
        Vec3::X,
        Vec3::new(0.5, -0.3, -0.8),
        Vec3::new(-0.1, 0.9, 0.2),
    ];
    let starts = [
        Vec3::ZERO,
        Vec3::Z,
        Vec3::new(30.0, -70.0, 100.0),
        Vec3::splat(1000.0),
    ];
    let mut worst = 0.0_f64;
    for direction in directions.map(Vec3::normalize) {
        for start in starts {
            let fallen = fall(direction * gravity, start, time_step)?;
            let wanted = (direction * gravity).as_dvec3() * 50.0;
            let miss = ((fallen - start).as_dvec3() - wanted).length() / wanted.length();
            worst = worst.max(miss);
        }
    }
    Ok(worst)
}

/// Position after 10 s.
fn fall(acceleration: Vec3, start: Vec3, time_step: f32) -> Result<Vec3, StepError> {
    let mut state = State::at(start);
    let stepper = Stepper::new(Sphere::solid(1.0, 0.1))
        .and_then(|it| it.with_gravity(UniformGravity { acceleration }))
        .and_then(|it| it.with_integrator(EnergyMomentum { time_step }));
    let Ok(stepper) = stepper else {
        return Err(StepError::Stalled);
    };
    stepper.advance(&mut state, 10.0)?;
    Ok(state.position)
}
