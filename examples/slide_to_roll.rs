//! A ball that starts to slide and then rolls, at five sevenths of its speed.
//!
//! Run `cargo run --release --example slide_to_roll -- --help`.

// A program has the standard library. These lints are meant for the library.
#![allow(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

use std::ops::ControlFlow;
use std::process::ExitCode;

use common::{
    BLUE, Camera, Check, Column, Film, GREEN, Mesh, ORANGE, Options, Outcome, PURPLE, Page,
    Picture, Shot, mesh,
};
use kuva::prelude::*;
use tumble::glam::DVec3;
use tumble::{
    Coulomb, Dynamics, EnergyMomentum, FlatGround, Sample, Sphere, SpringDamper, State, Stepper,
    UniformGravity,
};

const ABOUT: &str = "\
Balls start to slide without spin, or with backspin, and are followed until they roll. With
β = I/(m r²) a ball rolls at v/(1 + β) after the time β/(1 + β) v/(μ g), whatever the friction.
One with enough backspin comes back.";

const MASS: f64 = 0.17; // kg
const RADIUS: f64 = 0.0286; // m
const GRAVITY: f64 = 9.8; // m/s²
const COEFFICIENT: f64 = 0.2;
const SPEED: f64 = 2.0; // m/s
/// Slip speed, m/s. At a slip of a thousandth of the speed the force is below Coulomb's by 5e-4.
const SLIP_SPEED: f64 = 1e-6;

/// State of a ball at one time: time (s), speed (m/s), speed of its rim due to the spin (m/s),
/// position (m), energy (J).
#[derive(Clone, Copy, Debug)]
struct Moment {
    time: f64,
    speed: f64,
    rim: f64,
    place: f64,
    energy: f64,
}

fn main() -> ExitCode {
    common::main("slide_to_roll", ABOUT, work)
}

fn work(options: &Options) -> Outcome<Page> {
    let time_step = if options.quick { 2e-4 } else { 5e-5 };
    let (solid, solid_shots) = run(Sphere::solid(MASS, RADIUS), 0.0, time_step)?;
    let (shell, shell_shots) = run(Sphere::shell(MASS, RADIUS), 0.0, time_step)?;
    // Backspin: the rim moves back four times as fast as the ball moves forward.
    let (back, back_shots) = run(Sphere::solid(MASS, RADIUS), -4.0 * SPEED, time_step)?;
    let mut checks = Vec::new();
    for (name, moments, beta) in [("solid ball", &solid, 0.4), ("shell", &shell, 2.0 / 3.0)] {
        checks.extend(figures(name, moments, beta, time_step));
    }
    checks.push(Check::near(
        "solid ball with backspin: final speed, m/s",
        "(v + β r ω)/(1 + β): below 0, it comes back",
        back[back.len() - 1].speed,
        SPEED * (1.0 - 0.4 * 4.0) / 1.4,
        1e-5 * SPEED,
    ));
    let energies = |moments: &Vec<Moment>| moments.iter().map(|m| m.energy).collect();
    checks.push(Check::energy([&solid, &shell, &back].map(energies)));
    Ok(Page {
        title: "From sliding to rolling",
        text: vec![format!(
            "Balls slide at {SPEED} m/s on a ground with the coefficient {COEFFICIENT}. Friction \
             slows the ball and spins it, until the two speeds are equal. From then on it \
             dissipates nothing."
        )],
        checks,
        pictures: vec![
            picture_without_spin(&solid, &shell)?,
            picture_with_backspin(&back)?,
        ],
        film: Some(film(&[solid_shots, shell_shots, back_shots])),
    })
}

fn curve(moments: &[Moment], value: fn(&Moment) -> f64) -> Vec<(f64, f64)> {
    moments.iter().map(|m| (m.time, value(m))).collect()
}

fn picture_without_spin(solid: &[Moment], shell: &[Moment]) -> Outcome<Picture> {
    let [solid_rim, shell_rim] = [solid, shell].map(|moments| curve(moments, |m| m.rim));
    let [solid, shell] = [solid, shell].map(|moments| curve(moments, |m| m.speed));
    let plots = vec![
        common::line(solid_rim, ORANGE, "solid ball: spin times radius"),
        common::line(shell_rim, PURPLE, "shell: spin times radius"),
        common::line(solid, BLUE, "solid ball: speed"),
        common::line(shell, GREEN, "shell: speed"),
    ];
    Picture::new("speeds", plots, |layout| {
        arranged(layout, "initially without spin")
    })
}

fn picture_with_backspin(back: &[Moment]) -> Outcome<Picture> {
    let [rim, speed] = [curve(back, |m| m.rim), curve(back, |m| m.speed)];
    let plots = vec![
        common::line(rim, ORANGE, "solid ball: spin times radius"),
        common::line(speed, BLUE, "solid ball: speed"),
    ];
    Picture::new("backspin", plots, |layout| {
        arranged(layout, "with backspin")
    })
}

fn arranged(layout: Layout, how: &str) -> Layout {
    layout
        .with_title(format!("from sliding to rolling, {how}"))
        .with_x_label("time (s)")
        .with_y_label("m/s")
        .with_legend_position(LegendPosition::OutsideRightTop)
}

/// Compares with Kleppner & Kolenkow, An Introduction to Mechanics, ch. 6; Coriolis 1835.
fn figures(name: &str, moments: &[Moment], beta: f64, time_step: f64) -> Vec<Check> {
    let share = beta / (1.0 + beta);
    let (first, last) = (moments[0], moments[moments.len() - 1]);
    let when = share * SPEED / (COEFFICIENT * GRAVITY);
    // Until a thousandth of the slip is left, plus a step. Shortly before the end the force is too
    // small by `SLIP_SPEED/slip`.
    let slack = 1e-3 * when + time_step;
    let rolls = moments.iter().find(|m| m.speed - m.rim < 1e-3 * SPEED);
    let rolls = rolls.copied().unwrap_or(last);
    let way = (share - share * share / 2.0) * SPEED * SPEED / (COEFFICIENT * GRAVITY);
    vec![
        Check::near(
            &format!("{name}: final speed, m/s"),
            "v/(1 + β), whatever the friction",
            last.speed,
            SPEED / (1.0 + beta),
            1e-5 * SPEED,
        ),
        Check::near(
            &format!("{name}: time until it rolls, s"),
            "β/(1 + β) v/(μ g)",
            rolls.time,
            when,
            slack,
        ),
        Check::near(
            &format!("{name}: distance until it rolls, m"),
            "(b - b²/2) v²/(μ g), b = β/(1 + β)",
            rolls.place,
            way,
            slack * SPEED,
        ),
        Check::near(
            &format!("{name}: fraction of the energy that friction dissipated"),
            "β/(1 + β)",
            2.0 * (first.energy - last.energy) / (MASS * SPEED * SPEED),
            share,
            1e-4,
        ),
    ]
}

/// The three balls side by side, three diameters apart.
fn film(films: &[Vec<Shot>; 3]) -> Film {
    let together = |k: usize| {
        let shots = films.each_ref().map(|shots| &shots[k]);
        let lanes = shots.iter().zip([1.0, 0.0, -1.0]);
        let poses = lanes.map(|(shot, lane)| shot.poses[0].moved(DVec3::Y * (lane * 6.0 * RADIUS)));
        let speeds = shots.map(|shot| shot.values[0]);
        let slips = shots.map(|shot| shot.values[1]);
        Shot {
            time: shots[0].time,
            poses: poses.collect(),
            values: [slips, speeds].concat(),
        }
    };
    let count = films.iter().map(Vec::len).min().unwrap_or(0);
    let ball = |colour| {
        let colours = [colour, mesh::IVORY];
        Mesh::ellipsoid(DVec3::ZERO, DVec3::splat(RADIUS), colours, [mesh::SAND; 2])
    };
    let speed = |name, digits, colour| Column::new(name, "m/s", digits, colour);
    Film {
        title: "From sliding to rolling".to_owned(),
        lines: vec![
            "Solid ball blue, shell green, solid ball with backspin orange. A ball rolls when its \
             slip is 0."
                .to_owned(),
        ],
        size: RADIUS,
        distance: 26.0,
        slower: 4.0,
        bodies: vec![ball(mesh::BLUE), ball(mesh::GREEN), ball(mesh::ORANGE)],
        readouts: vec![
            speed("slip of the solid ball", 2, "ink"),
            speed("slip of the shell", 2, "ink"),
            speed("slip with backspin", 2, "ink"),
        ],
        curves: vec![
            speed("speed: solid ball", 2, "blue"),
            speed("shell", 2, "green"),
            speed("with backspin", 2, "orange"),
        ],
        events: Vec::new(),
        shots: (0..count).map(together).collect(),
    }
}

/// Returns every moment of the run, and the shots of the film with speed and slip (m/s).
fn run(ball: Sphere, rim: f64, time_step: f64) -> Outcome<(Vec<Moment>, Vec<Shot>)> {
    // The ball starts at its penetration depth at rest, 10 µm.
    let sink = 1e-5;
    let stiffness = MASS * GRAVITY / sink;
    let law = SpringDamper {
        stiffness,
        damping: (MASS * stiffness).sqrt(),
    };
    let stepper = Stepper::builder(ball)
        .gravity(UniformGravity::down(GRAVITY))
        .ground(FlatGround::level(law.stiffness, law.damping))
        .friction(Coulomb {
            coefficient: COEFFICIENT,
            slip_speed: SLIP_SPEED,
        })
        .integrator(EnergyMomentum { time_step })
        .build()?;
    let start = State::at(DVec3::Z * (RADIUS - sink)).with_linear_velocity(DVec3::X * SPEED);
    let spin = DVec3::Y * (rim / RADIUS);
    let axes = start.rotation().axes();
    let momentum = stepper
        .scene()
        .inertia_properties()
        .angular_momentum(&axes, spin);
    let mut state = start.with_angular_momentum(momentum);
    let (mut moments, mut camera) = (Vec::new(), Camera::new(0.005));
    let mut watch = |sample: &Sample<'_>| {
        let state = sample.state;
        let spin = stepper.scene().motion(state).angular_velocity;
        let (speed, rim) = (state.linear_velocity.x, spin.y * RADIUS);
        camera.look(sample, || [speed, speed - rim]);
        moments.push(Moment {
            time: sample.time,
            speed,
            rim,
            place: state.position.x,
            energy: sample.energy().total(),
        });
        ControlFlow::Continue(())
    };
    stepper.run(&mut state, 2.0, &mut watch)?;
    Ok((moments, camera.shots))
}
