//! A tippe top that turns upside down, with the final spin from Jellett's integral.
//!
//! Run `cargo run --release --example tippe_top -- --help`.

// A program has the standard library. These lints are meant for the library.
#![allow(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

use std::ops::ControlFlow;
use std::process::ExitCode;

use common::{
    BLUE, Camera, Check, Column, Film, GREEN, Mesh, ORANGE, Options, Outcome, Page, Picture, Shot,
    energy_columns, mesh,
};
use kuva::prelude::*;
use tumble::glam::{DMat3, DVec3};
use tumble::{
    Coulomb, Dynamics, EnergyMomentum, FlatGround, MassProperties, Sample, Sphere, State, Stepper,
    UniformGravity,
};

const ABOUT: &str = "\
Spins a sphere whose centre of mass is below its middle. Friction at the slipping contact turns it
upside down, while Jellett's integral -L·a (a from the centre of mass to the contact) stays.";

// The top of Rauch-Wojciechowski, Skoldstam & Glad (Regul. Chaotic Dyn. 10, 333, 2005) and of later
// papers, in SI units.
const MASS: f64 = 0.02;
const RADIUS: f64 = 0.02;
/// Distance of the centre of mass from the middle, in radii.
const OFFSET: f64 = 0.3;
/// Moments about the axis and across it, in m R².
const ALONG: f64 = 2.0 / 5.0;
const ACROSS: f64 = 131.0 / 350.0;
const GRAVITY: f64 = 9.82;
/// Spin at the start, rad/s. It is 155 in these papers.
const SPIN: f64 = 155.0;
/// Angle of the axis from upright at the start, rad.
const LEAN: f64 = 0.1;

/// State of the top at one time.
#[derive(Clone, Copy, Debug)]
struct Moment {
    time: f64,
    /// Angle of the axis from upright, degrees.
    lean: f64,
    /// Spin about the vertical, rad/s.
    spin: f64,
    jellett: f64,
    energy: f64,
}

fn main() -> ExitCode {
    common::main("tippe_top", ABOUT, work)
}

fn work(options: &Options) -> Outcome<Page> {
    let duration = if options.quick { 15.0 } else { 20.0 };
    let (moments, shots) = run(duration, 1e-4)?;
    let (coarse, _) = run(duration, 2e-4)?;
    let (first, last) = (moments[0], moments[moments.len() - 1]);
    // Upright on its head the arm has the length R (1 + offset), and the spin is along the axis: J
    // = R (1 + offset) I₃ ω.
    let inverted = first.jellett / (RADIUS * (1.0 + OFFSET) * ALONG * MASS * RADIUS * RADIUS);
    Ok(Page {
        title: "Tippe top",
        text: vec![
            "A sphere with its centre of mass 0.3 radii below its middle is spun about its axis at \
             155 rad/s and leaves the upright position by friction alone."
                .to_owned(),
            format!(
                "From {:.0} to {:.0} degrees, from {:.1} to {:.1} rad/s, from {:.4} to {:.4} J.",
                first.lean, last.lean, first.spin, last.spin, first.energy, last.energy
            ),
        ],
        checks: checks(&moments, &coarse, inverted),
        pictures: vec![
            picture_of_lean(&moments)?,
            picture_of_spin(&moments, inverted)?,
        ],
        film: Some(film(shots)),
    })
}

fn curve(moments: &[Moment], value: fn(&Moment) -> f64) -> Vec<(f64, f64)> {
    moments.iter().map(|m| (m.time, value(m))).collect()
}

fn picture_of_lean(moments: &[Moment]) -> Outcome<Picture> {
    let lean = common::line(curve(moments, |m| m.lean), BLUE, "axis from upright");
    Picture::new("lean", vec![lean], |layout| {
        layout
            .with_title("tippe top: angle of the axis")
            .with_x_label("time (s)")
            .with_y_label("degrees")
            .with_legend_position(LegendPosition::InsideBottomRight)
    })
}

fn picture_of_spin(moments: &[Moment], inverted: f64) -> Outcome<Picture> {
    let end = moments[moments.len() - 1].time;
    let spins = vec![
        common::line(
            curve(moments, |m| m.spin),
            ORANGE,
            "spin about the vertical",
        ),
        common::line(
            vec![(0.0, inverted), (end, inverted)],
            GREEN,
            "upside down, by Jellett's integral",
        ),
    ];
    Picture::new("spin", spins, |layout| {
        layout
            .with_title("tippe top: spin")
            .with_x_label("time (s)")
            .with_y_label("rad/s")
            .with_legend_position(LegendPosition::InsideTopRight)
    })
}

/// Largest relative change of Jellett's integral.
fn drift(moments: &[Moment]) -> f64 {
    let first = moments[0].jellett;
    let changes = moments.iter().map(|m| (m.jellett / first - 1.0).abs());
    changes.fold(0.0, f64::max)
}

fn checks(moments: &[Moment], coarse: &[Moment], inverted: f64) -> Vec<Check> {
    let last = moments[moments.len() - 1];
    vec![
        Check::between(
            "angle of the axis at the end, degrees",
            "upside down, which it approaches ever more slowly",
            last.lean,
            170.0,
            180.0,
        ),
        Check::near(
            "spin at the end, rad/s",
            "Jellett's integral: the spin decreases by (1 - offset)/(1 + offset)",
            last.spin,
            inverted,
            0.01 * inverted,
        ),
        Check::between(
            "drift of Jellett's integral, relative",
            "conserved for any contact force at distance R from the middle (Jellett 1872)",
            drift(moments),
            0.0,
            JELLETT,
        ),
        Check::between(
            "order of that drift in the time step",
            "EnergyMomentum is of order 2",
            (drift(coarse) / drift(moments)).log2(),
            1.7,
            2.3,
        ),
        Check::energy([moments.iter().map(|m| m.energy).collect()]),
    ]
}

/// Tolerance of the relative drift.
///
/// A step rotates the top by `ω dt` = 0.0155 rad. The square of that, 2.4e-4, is the error of a
/// method of order 2 for a rotation of one radian.
const JELLETT: f64 = 2.4e-4;

fn run(duration: f64, time_step: f64) -> Outcome<(Vec<Moment>, Vec<Shot>)> {
    let moment = MASS * RADIUS * RADIUS;
    let inertia = DMat3::from_diagonal(DVec3::new(ACROSS, ACROSS, ALONG) * moment);
    let distribution = MassProperties {
        mass: MASS,
        centre_of_mass: DVec3::NEG_Z * (OFFSET * RADIUS),
        inertia,
    };
    let stepper = Stepper::new(Sphere::loaded(RADIUS, distribution))?
        .with_gravity(UniformGravity::down(GRAVITY))?
        // The top penetrates by 20 µm, a thousandth of the radius.
        .with_ground(FlatGround::level(1e4, 4.0))?
        .with_friction(Coulomb {
            coefficient: 0.3,
            slip_speed: 1e-3,
        })?
        .with_integrator(EnergyMomentum { time_step })?;
    let turned = State::at(DVec3::ZERO).with_rotation_vector(DVec3::X * LEAN);
    let middle = turned.world_point(stepper.body().middle());
    let axis = turned.world_point(DVec3::Z);
    let sink = MASS * GRAVITY / 1e4;
    let mut state = State {
        position: DVec3::Z * (RADIUS - sink - middle.z),
        ..turned
    }
    .with_angular_momentum(axis * (ALONG * moment * SPIN));
    let mut moments: Vec<Moment> = Vec::new();
    // Between two shots the top rotates by about half a radian.
    let mut camera = Camera::new(0.004);
    let mut watch = |sample: &Sample<'_>| {
        camera.look(sample, || {
            let moment = look(stepper.scene(), sample.time, sample.state, 0.0);
            [moment.lean, moment.spin]
        });
        if sample.time >= moments.len() as f64 * 0.01 - 1e-9 {
            let energy = sample.energy().total();
            moments.push(look(stepper.scene(), sample.time, sample.state, energy));
        }
        ControlFlow::Continue(())
    };
    stepper.run(&mut state, duration, &mut watch)?;
    Ok((moments, camera.shots))
}

fn film(shots: Vec<Shot>) -> Film {
    let middle = DVec3::Z * (OFFSET * RADIUS);
    Film {
        title: "Tippe top".to_owned(),
        lines: vec![
            "A sphere with its centre of mass below its middle, spun at 155 rad/s: blue below at \
             first, red at the end."
                .to_owned(),
        ],
        size: RADIUS,
        distance: 6.5,
        slower: 2.0,
        bodies: vec![Mesh::ellipsoid(
            middle,
            DVec3::splat(RADIUS),
            [mesh::IVORY, mesh::SAND],
            [mesh::RED, mesh::BLUE],
        )],
        readouts: vec![
            Column::new("axis from upright", "°", 1, "ink"),
            Column::new("spin", "rad/s", 1, "ink"),
        ],
        curves: energy_columns(),
        events: Vec::new(),
        shots,
    }
}

fn look(scene: &impl Dynamics<Body = Sphere>, time: f64, state: &State, energy: f64) -> Moment {
    let axes = state.rotation().axes();
    let arm = axes.to_world(scene.body().middle()) - DVec3::Z * scene.body().radius();
    Moment {
        time,
        lean: axes.z.z.clamp(-1.0, 1.0).acos().to_degrees(),
        spin: scene.motion(state).angular_velocity.z,
        jellett: -state.angular_momentum.dot(arm),
        energy,
    }
}
