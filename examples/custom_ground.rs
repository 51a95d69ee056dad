//! A user's own ground: a valley in which every oscillation has the same period.
//!
//! Run `cargo run --release --example custom_ground -- --help`.

// A program has the standard library. These lints are meant for the library.
#![allow(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::process::ExitCode;

use common::{
    BLACK, BLUE, Camera, Check, Column, Film, GREEN, Mesh, ORANGE, Options, Outcome, Page, Picture,
    Pose, Shot, mesh,
};
use kuva::prelude::*;
use tumble::contract::{CheckPlan, GroundRange, check_ground};
use tumble::glam::DVec3;
use tumble::{
    Elevation, EnergyMomentum, Ground, HeightField, PointCloud, Sample, SpringDamper, State,
    Stepper, Terrain, UniformGravity,
};

const ABOUT: &str = "\
Releases beads in a valley whose profile is a cycloid, a terrain that is defined in this file. An
oscillation takes 4π √(a/g), whatever its initial height (Huygens 1673).";

/// Radius of the circle that generates the cycloid, m.
const CIRCLE: f64 = 0.1;
const GRAVITY: f64 = 9.8;
/// Stiffness under a bead of 1 kg, N/m. The bead penetrates by at most 20 µm, 1e-4 of the smallest
/// radius of curvature on its path.
const STIFFNESS: f64 = 1e6;
/// Initial angles of the circle for the beads, rad.
const STARTS: [f64; 3] = [0.4, 0.9, 1.5];
/// Time between two shots of the film, s.
const INTERVAL: f64 = 0.01;

/// Valley along y: `x = a (φ + sin φ)`, `z = a (1 - cos φ)`.
#[derive(Clone, Copy, Debug)]
struct Cycloid;

impl Cycloid {
    fn place(angle: f64) -> DVec3 {
        DVec3::new(angle + angle.sin(), 0.0, 1.0 - angle.cos()) * CIRCLE
    }

    /// Angle φ by Newton's method, up to 2.4. The valley is straight beyond.
    fn angle(x: f64) -> f64 {
        let aim = (x / CIRCLE).clamp(-3.0, 3.0);
        let mut angle = aim / 2.0;
        for _ in 0..30 {
            let step = (angle + angle.sin() - aim) / (1.0 + angle.cos());
            angle -= step;
            if step.abs() < 1e-15 {
                break;
            }
        }
        angle
    }
}

impl HeightField for Cycloid {
    fn elevation(&self, x: f64, _y: f64) -> Elevation {
        let angle = Self::angle(x);
        let half = (angle / 2.0).cos();
        let place = Self::place(angle);
        let slope = (angle / 2.0).tan();
        Elevation::new(place.z + slope * (x - place.x), [slope, 0.0]).with_hessian([
            1.0 / (4.0 * CIRCLE * half.powi(4)),
            0.0,
            0.0,
        ])
    }
}

/// Path of a bead: time (s), x (m) and energy (J).
type Way = Vec<(f64, f64, f64)>;

/// A bead: its path and the shots of the film.
struct Bead {
    way: Way,
    shots: Vec<Shot>,
}

const COLOURS: [&str; 3] = [BLUE, ORANGE, GREEN];

fn main() -> ExitCode {
    common::main("custom_ground", ABOUT, work)
}

fn work(options: &Options) -> Outcome<Page> {
    let period = 4.0 * PI * (CIRCLE / GRAVITY).sqrt();
    let steps = if options.quick { 1000.0 } else { 4000.0 };
    let range = GroundRange {
        centre: DVec3::new(0.0, 0.0, 0.05),
        size: 0.1,
        depth: 1e-3,
        speed: 1.0,
    };
    check_ground(&ground(), &range, CheckPlan::default())?;
    let mut beads = Vec::new();
    for start in STARTS {
        beads.push(oscillate(start, period / steps, 2.0 * period)?);
    }
    Ok(Page {
        title: "A user's own ground",
        text: vec![
            "A height field has a height and a gradient. The crate finds the nearest point of the \
             surface, so that the springs have a potential, and the example checks \
             this."
                .to_owned(),
        ],
        checks: checks(&beads, period, steps),
        pictures: vec![valley()?, oscillations(&beads)?],
        film: Some(film(&beads)),
    })
}

fn checks(beads: &[Bead], period: f64, steps: f64) -> Vec<Check> {
    let mut checks = Vec::new();
    for (bead, height) in beads.iter().zip(heights()) {
        checks.push(Check::near(
            &format!("period of the oscillation {height}, s"),
            "4π √(a/g) at every height (Huygens, Horologium oscillatorium, 1673)",
            period_of(&bead.way),
            period,
            // Penetration depth over radius of curvature, and the error of order 2: (2π/steps)²/12.
            period * (1e-4 + (2.0 * PI / steps).powi(2) / 12.0),
        ));
    }
    let pairs = beads.iter().flat_map(|bead| bead.way.windows(2));
    let gains = pairs.map(|pair| pair[1].2 - pair[0].2);
    checks.push(Check::energy_gains("between two steps", gains));
    checks
}

fn heights() -> [String; 3] {
    STARTS.map(|start| format!("from {:.0} mm", Cycloid::place(start).z * 1e3))
}

fn oscillations(beads: &[Bead]) -> Outcome<Picture> {
    let mut plots = Vec::new();
    for ((bead, colour), height) in beads.iter().zip(COLOURS).zip(&heights()) {
        // More points than pixels would have no visible effect.
        let every = bead.way.len().div_ceil(1000);
        let curve = bead
            .way
            .iter()
            .step_by(every)
            .map(|&(time, x, _)| (time, x));
        plots.push(common::line(curve.collect(), colour, height));
    }
    Picture::new("swings", plots, |layout| {
        layout
            .with_title("beads in a cycloid valley meet at the bottom")
            .with_x_label("time (s)")
            .with_y_label("x (m)")
            .with_legend_position(LegendPosition::OutsideRightTop)
    })
}

fn valley() -> Outcome<Picture> {
    let profile = (-60..=60).map(|i| {
        let place = Cycloid::place(f64::from(i) / 60.0 * 1.8);
        (place.x, place.z)
    });
    let mut plots = vec![common::line(profile.collect(), BLACK, "the valley")];
    for ((start, colour), height) in STARTS.into_iter().zip(COLOURS).zip(&heights()) {
        let place = Cycloid::place(start);
        let mark = vec![(place.x, place.z), (place.x, place.z + 0.02)];
        plots.push(common::line(mark, colour, height));
    }
    Picture::new("valley", plots, |layout| {
        layout
            .with_title("the valley, and the initial positions of the beads")
            .with_x_label("x (m)")
            .with_y_label("z (m)")
            .with_legend_position(LegendPosition::OutsideRightTop)
    })
}

/// Radius of the drawn beads, m. The bodies are points.
const BEAD: f64 = 0.008;
/// Distance between the paths of two drawn beads, m.
const APART: f64 = 0.05;

/// The beads side by side in the valley.
fn film(beads: &[Bead]) -> Film {
    let count = beads.iter().map(|bead| bead.shots.len()).min().unwrap_or(0);
    let together = |k: usize| {
        let shots: Vec<&Shot> = beads.iter().map(|bead| &bead.shots[k]).collect();
        let lanes = shots.iter().zip([-APART, 0.0, APART]);
        let poses = lanes.map(|(shot, lane)| shot.poses[0].moved(DVec3::Y * lane));
        let positions = shots.iter().map(|shot| 1e3 * shot.poses[0].place.x);
        Shot {
            time: shots[0].time,
            poses: [Pose::default()].into_iter().chain(poses).collect(),
            values: positions.collect(),
        }
    };
    let bead = |colour| {
        Mesh::ellipsoid(
            // The point touches the ground, so that the bead lies above it.
            DVec3::Z * BEAD,
            DVec3::splat(BEAD),
            [colour, mesh::IVORY],
            [colour; 2],
        )
    };
    let column = |name, colour| Column::new(name, "mm", 1, colour);
    let [blue, orange, green] = [
        column("x, from 8 mm", "blue"),
        column("x, from 38 mm", "orange"),
        column("x, from 93 mm", "green"),
    ];
    Film {
        title: "Beads in a cycloid valley".to_owned(),
        lines: vec!["They start at different heights and meet at the bottom.".to_owned()],
        size: CIRCLE,
        distance: 5.0,
        slower: 2.0,
        bodies: vec![
            Mesh::ground(&surface(), [mesh::SAND, mesh::IVORY]),
            bead(mesh::BLUE),
            bead(mesh::ORANGE),
            bead(mesh::GREEN),
        ],
        readouts: Vec::new(),
        curves: vec![blue, orange, green],
        events: Vec::new(),
        shots: (0..count).map(together).collect(),
    }
}

/// Points of the valley for the film.
fn surface() -> Vec<Vec<DVec3>> {
    let row = |i: i32| {
        let place = Cycloid::place(f64::from(i) * 0.1);
        (-4..=4).map(move |k| place.with_y(f64::from(k) * 0.025))
    };
    (-19..=19).map(|i| row(i).collect()).collect()
}

/// The valley with its springs.
fn ground() -> Ground<SpringDamper, Terrain<Cycloid>> {
    Ground {
        law: SpringDamper {
            stiffness: STIFFNESS,
            damping: 2.0 * STIFFNESS.sqrt(),
        },
        shape: Terrain {
            height_field: Cycloid,
        },
    }
}

fn oscillate(start: f64, time_step: f64, seconds: f64) -> Outcome<Bead> {
    let stepper = Stepper::builder(PointCloud::new([DVec3::ZERO], [1.0])?)
        .gravity(UniformGravity::down(GRAVITY))
        .ground(ground())
        .integrator(EnergyMomentum { time_step })
        .build()?;
    let (mut way, mut camera) = (Way::new(), Camera::new(INTERVAL));
    let mut watch = |sample: &Sample<'_>| {
        camera.look(sample, || []);
        let (x, energy) = (sample.state.position.x, sample.energy().total());
        way.push((sample.time, x, energy));
        ControlFlow::Continue(())
    };
    stepper.run(&mut State::at(Cycloid::place(start)), seconds, &mut watch)?;
    Ok(Bead {
        way,
        shots: camera.shots,
    })
}

/// Time from the first passage through the bottom to the third.
fn period_of(way: &Way) -> f64 {
    let crossings = way.windows(2).filter(|pair| pair[0].1 * pair[1].1 < 0.0);
    let times: Vec<f64> = crossings
        .map(|pair| {
            let [(t0, x0, _), (t1, x1, _)] = [pair[0], pair[1]];
            t0 - x0 * (t1 - t0) / (x1 - x0)
        })
        .collect();
    match times[..] {
        [first, _, third, ..] => third - first,
        _ => f64::NAN,
    }
}
