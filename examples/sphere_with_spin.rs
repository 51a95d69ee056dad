//! A tennis ball that bounces with topspin, without spin and with backspin, and the court pace
//! rating.
//!
//! Run `cargo run --release --example sphere_with_spin -- --help`.

// A program has the standard library. These lints are meant for the library.
#![allow(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

use std::ops::ControlFlow;
use std::process::ExitCode;

use common::{
    BLUE, Camera, Check, Column, Film, GREEN, Mesh, ORANGE, Options, Outcome, Page, Picture, Shot,
    mesh,
};
use kuva::prelude::*;
use tumble::glam::DVec3;
use tumble::{
    Carried, Coulomb, Dynamics, EnergyMomentum, Ground, Sample, Sphere, SpringDamper, State,
    Stepper, UniformGravity,
};

const ABOUT: &str = "\
Bounces a tennis ball on a hard court at 30 m/s and 16 degrees, as the test of the court pace rating
does, with topspin, without spin and with backspin, and compares with the rigid ball that slides or
grips (Brody 1984). Real balls grip more strongly than this model, because their friction reverses
during the contact.";

const MASS: f64 = 0.0577; // kg
const RADIUS: f64 = 0.033; // m
const GRAVITY: f64 = 9.8;
/// Moment of inertia of a thin shell over m r².
const BETA: f64 = 2.0 / 3.0;
/// Speed of the test, m/s. The next constant is its angle, degrees.
const SPEED: f64 = 30.0;
const ANGLE: f64 = 16.0;
const RESTITUTION: f64 = 0.81;
/// Contact time, s. A real ball takes 5 ms. In a short contact, gravity changes the bounce little:
/// `g · time/speed down`, 1.2e-3.
const CONTACT_TIME: f64 = 1e-3;

/// Path of a ball: positions (m) along the court and above it.
type Path = Vec<(f64, f64)>;

/// Result of a bounce: horizontal and vertical speed, and the speed of the rim due to the spin,
/// m/s.
#[derive(Clone, Copy, Debug)]
struct Bounced {
    on: f64,
    up: f64,
    rim: f64,
}

fn main() -> ExitCode {
    common::main("sphere_with_spin", ABOUT, work)
}

fn work(options: &Options) -> Outcome<Page> {
    let time_step = CONTACT_TIME / if options.quick { 200.0 } else { 1000.0 };
    let mut checks = checks_without_spin(time_step)?;
    checks.extend(checks_of_rating(time_step)?);
    let (mut plots, mut films) = (Vec::new(), Vec::new());
    for (name, rim, colour) in [
        ("topspin", 25.0, ORANGE),
        ("no spin", 0.0, BLUE),
        ("backspin", -25.0, GREEN),
    ] {
        let (found, path, shots) = bounce(0.9, rim, time_step)?;
        films.push(shots);
        if rim.abs() > 0.0 {
            checks.push(near(
                &format!("{name}, μ = 0.9: horizontal speed, m/s"),
                found.on,
                self::rigid(0.9, rim).on,
            ));
        }
        plots.push(common::line(path, colour, name));
    }
    Ok(Page {
        title: "A ball with spin",
        text: vec![
            "A ball that grips leaves at the speed at which it rolls. One that slides throughout \
             loses μ (1 + e) times its downward speed. Topspin keeps it fast, backspin lets it \
             slide."
                .to_owned(),
            "The spin of a real ball after the bounce is larger, because its friction reverses \
             during the contact (Cross, Am. J. Phys. 70, 1093, 2002). The model has no spring \
             along the ground."
                .to_owned(),
        ],
        checks,
        pictures: vec![picture(plots)?],
        film: Some(film(&films)),
    })
}

fn picture(plots: Vec<Plot>) -> Outcome<Picture> {
    Picture::new("bounces", plots, |layout| {
        layout
            .with_title("a tennis ball, 30 m/s at 16 degrees, on a court with μ = 0.9")
            .with_x_label("x (m)")
            .with_y_label("height of the middle (m)")
            .with_legend_position(LegendPosition::OutsideRightTop)
    })
}

fn checks_without_spin(time_step: f64) -> Outcome<Vec<Check>> {
    let mut checks = Vec::new();
    for (name, coefficient) in [("slides", 0.5), ("grips", 0.8)] {
        let (found, ..) = bounce(coefficient, 0.0, time_step)?;
        let rigid = rigid(coefficient, 0.0);
        checks.push(near(
            &format!("no spin, μ = {coefficient}, it {name}: horizontal speed, m/s"),
            found.on,
            rigid.on,
        ));
        checks.push(near(
            &format!("no spin, μ = {coefficient}, it {name}: speed of the rim by the spin, m/s"),
            found.rim,
            rigid.rim,
        ));
    }
    Ok(checks)
}

fn checks_of_rating(time_step: f64) -> Outcome<Vec<Check>> {
    let mut checks = Vec::new();
    for (coefficient, source) in [
        (
            0.6,
            "ITF CS 01/02: 100 (1 - μ) + 150 (0.81 - e) = 40.0 for μ = 0.6, e = 0.81",
        ),
        (
            0.8,
            "a ball that grips shows the court an apparent μ of 0.7707: 22.93",
        ),
    ] {
        let (found, ..) = bounce(coefficient, 0.0, time_step)?;
        let expected = 100.0 * (1.0 - apparent(rigid(coefficient, 0.0)));
        checks.push(Check::near(
            &format!("court pace rating, μ = {coefficient}"),
            source,
            100.0 * (1.0 - apparent(found)) + 150.0 * (0.81 - found.up / down()),
            expected,
            // The precision to which the rating is given.
            1.0,
        ));
    }
    Ok(checks)
}

/// Times of the film, s. The ball touches down at 0.1 s.
const SHOWN: [f64; 2] = [0.09, 0.15];

/// The three balls side by side, three diameters apart.
fn film(films: &[Vec<Shot>]) -> Film {
    let together = |k: usize| {
        let shots: Vec<&Shot> = films.iter().map(|shots| &shots[k]).collect();
        let lanes = shots.iter().zip([-1.0, 0.0, 1.0]);
        let poses = lanes.map(|(shot, lane)| shot.poses[0].moved(DVec3::Y * (lane * 6.0 * RADIUS)));
        let values = [1, 0].map(|k| shots.iter().map(move |shot| shot.values[k]));
        Shot {
            time: shots[0].time,
            poses: poses.collect(),
            values: values.into_iter().flatten().collect(),
        }
    };
    let count = films.iter().map(Vec::len).min().unwrap_or(0);
    let speed = |name, colour| Column::new(name, "m/s", 1, colour);
    let ball = |colour| {
        Mesh::ellipsoid(
            DVec3::ZERO,
            DVec3::splat(RADIUS),
            [colour, mesh::IVORY],
            [mesh::SAND; 2],
        )
    };
    Film {
        title: "A tennis ball with topspin, without spin and with backspin".to_owned(),
        lines: vec!["30 m/s at 16 degrees onto a court with μ = 0.9: topspin orange, no spin blue, backspin green.".to_owned()],
        size: RADIUS,
        distance: 22.0,
        slower: 100.0,
        bodies: vec![ball(mesh::ORANGE), ball(mesh::BLUE), ball(mesh::GREEN)],
        readouts: vec![
            speed("topspin: speed of the rim", "ink"),
            speed("no spin", "ink"),
            speed("backspin", "ink"),
        ],
        curves: vec![
            speed("horizontal speed: topspin", "orange"),
            speed("no spin", "blue"),
            speed("backspin", "green"),
        ],
        events: vec![("touches", 0.1)],
        shots: (0..count).map(together).collect(),
    }
}

fn near(what: &str, got: f64, expected: f64) -> Check {
    // Two effects limit the agreement, as fractions of the ball's speed: gravity during the
    // contact, and slip speed over slip while the ball grips.
    Check::near(
        what,
        "rigid ball: Brody, Phys. Teach. 22, 494 (1984)",
        got,
        expected,
        2e-3 * SPEED,
    )
}

/// Speed down before the bounce, m/s.
fn down() -> f64 {
    SPEED * ANGLE.to_radians().sin()
}

/// Apparent coefficient of friction: horizontal change of speed over vertical change of speed.
fn apparent(after: Bounced) -> f64 {
    (SPEED * ANGLE.to_radians().cos() - after.on) / (down() + after.up)
}

/// Result for a rigid ball, which slides throughout or comes to roll.
fn rigid(coefficient: f64, rim: f64) -> Bounced {
    let on = SPEED * ANGLE.to_radians().cos();
    let up = RESTITUTION * down();
    let slip = on - rim;
    let lost = coefficient * (down() + up);
    if lost * (1.0 + 1.0 / BETA) < slip.abs() {
        let lost = lost.copysign(slip);
        Bounced {
            on: on - lost,
            up,
            rim: rim + lost / BETA,
        }
    } else {
        let on = (on + BETA * rim) / (1.0 + BETA);
        Bounced { on, up, rim: on }
    }
}

type Court = Stepper<Sphere, Ground<SpringDamper>, Coulomb, UniformGravity>;

fn court(coefficient: f64, time_step: f64) -> Outcome<Court> {
    let carried = Carried {
        mass: MASS,
        contacts: 1,
    };
    let law = SpringDamper::from_bounce(carried, RESTITUTION, CONTACT_TIME)?;
    Ok(Stepper::builder(Sphere::shell(MASS, RADIUS))
        .gravity(UniformGravity::down(GRAVITY))
        .ground(Ground::level(law))
        .friction(Coulomb {
            coefficient,
            slip_speed: 1e-4,
        })
        .integrator(EnergyMomentum { time_step })
        .build()?)
}

/// Time of the touch-down, s.
const BEFORE: f64 = 0.1;

/// The ball is thrown so that it touches down at [`BEFORE`] with the velocity of the test.
fn thrown(court: &Court, rim: f64) -> State {
    let angle = ANGLE.to_radians();
    let velocity = DVec3::new(angle.cos(), 0.0, -angle.sin()) * SPEED;
    let thrown = velocity + DVec3::Z * (GRAVITY * BEFORE);
    let place = DVec3::Z * RADIUS - (velocity + thrown) * (BEFORE / 2.0);
    let start = State::at(place).with_linear_velocity(thrown);
    court.with_angular_velocity(start, DVec3::Y * (rim / RADIUS))
}

/// Returns the ball right after the bounce, its path, and the shots of the film.
fn bounce(coefficient: f64, rim: f64, time_step: f64) -> Outcome<(Bounced, Path, Vec<Shot>)> {
    let court = court(coefficient, time_step)?;
    let mut state = thrown(&court, rim);
    let mut path = Vec::new();
    let mut after = None;
    let mut camera = Camera::starting(SHOWN[0], 2.5e-4);
    let mut watch = |sample: &Sample<'_>| {
        let state = sample.state;
        let spin = || court.scene().motion(state).angular_velocity.y * RADIUS;
        path.push((state.position.x, state.position.z));
        if (SHOWN[0]..=SHOWN[1]).contains(&sample.time) {
            camera.look(sample, || [state.linear_velocity.x, spin()]);
        }
        if after.is_none() && sample.time > BEFORE && state.position.z > RADIUS {
            after = Some(Bounced {
                on: state.linear_velocity.x,
                up: state.linear_velocity.z,
                rim: spin(),
            });
        }
        ControlFlow::Continue(())
    };
    court.run(&mut state, BEFORE + 0.3, &mut watch)?;
    // One point for each millisecond is sufficient for a drawing.
    let every = (path.len() / 400).max(1);
    let path = path.into_iter().step_by(every).collect();
    Ok((
        after.ok_or("the ball does not leave the court")?,
        path,
        camera.shots,
    ))
}
