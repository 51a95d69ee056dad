//! Euler's disk: a coin that spins down on its rim. It becomes flatter while its contact moves
//! faster.
//!
//! Run `cargo run --release --example eulers_disk -- --help`.

// A program has the standard library. These lints are meant for the library.
#![allow(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

use std::ops::ControlFlow;
use std::process::ExitCode;

use common::{
    BLACK, BLUE, Camera, Check, Column, Film, GREEN, GREY, Mesh, ORANGE, Options, Outcome, PURPLE,
    Page, Picture, Shot, energy_columns,
};
use kuva::prelude::*;
use tumble::glam::DVec3;
use tumble::{Coin, Dynamics, EnergyMomentum, FlatGround, Sample, State, Stepper, UniformGravity};

const ABOUT: &str = "\
Lets a coin of 120 points spin on its rim at a small angle and follows the angle down. On springs
with dampers it falls at a constant rate, angle = (4/3) (damping/stiffness) (g/r) (t0 - t): the
exponent is 1. Air has 1/3 or 4/9, dry rolling 2/3 and viscous rolling 1/2.";

// The coin and the ground of the coin report.
const MASS: f64 = 1.0;
const RADIUS: f64 = 0.5;
const GRAVITY: f64 = 9.8;
const STIFFNESS: f64 = 1000.0;
const DAMPING: f64 = 0.5;
/// Angle at the start, rad.
const FIRST: f64 = 0.2;
/// Range of angles that is compared, rad. Above it the start still has an effect. Below it the
/// contact patch is no longer a small part of the rim.
const WINDOW: [f64; 2] = [0.05, 0.16];

/// Angle at which the curve ends, rad. Below it, half of the rim touches.
const FLAT: f64 = 0.02;
/// Time from there to the end of the film, s, in which the disk comes to rest.
const AFTERWARDS: f64 = 3.0;

/// Error of the formulas of a small patch: the square of its half-angle, which is
/// `∛(3π M g/(n S r α))` = 0.25 rad in the middle of the range.
const PATCH: f64 = 0.06;

/// Time (s) and angle (rad).
type Curve = Vec<(f64, f64)>;

fn main() -> ExitCode {
    common::main("eulers_disk", ABOUT, work)
}

fn work(options: &Options) -> Outcome<Page> {
    let time_step = if options.quick { 1e-3 } else { 2.5e-4 };
    let (angles, shots) = run(time_step)?;
    let curve = smoothed(&angles);
    let in_window = |&(_, angle): &(f64, f64)| (WINDOW[0]..=WINDOW[1]).contains(&angle);
    let fallen: Curve = curve.iter().copied().filter(in_window).collect();
    let fit = Fit::of(&fallen);
    // Dissipated power: the dampers under the patch take τ M g r α Ω² of the energy (3/2) M g r α,
    // with Ω² α = g/(k r) and k = 1/2 for a ring.
    let rate = 4.0 / 3.0 * DAMPING / STIFFNESS * GRAVITY / RADIUS;
    let slope = rate_of(&fallen);
    Ok(Page {
        title: "Euler's disk",
        text: vec![
            "A ring of 1 kg and 0.5 m spins on its rim at 0.2 rad, without friction, at the rate \
             at which its centre stays, Ω² sin α = 2 g/r. Only the dampers dissipate \
             energy."
                .to_owned(),
            format!(
                "It lies at {:.2} s by the fit; the angle falls at {slope:.5} rad/s.",
                fit.end
            ),
        ],
        checks: vec![
            Check::near(
                "exponent n of angle ~ (t0 - t)^n",
                "power lost ~ Ω² α, so n = 1/(1 - 1 + 2/2) = 1",
                fit.exponent,
                1.0,
                PATCH,
            ),
            Check::near(
                "rate of the fall over (4/3) (damping/stiffness) (g/r)",
                "dampers under a small patch; its half-angle of 0.25 counts by its square",
                slope / rate,
                1.0,
                PATCH,
            ),
        ],
        pictures: vec![
            picture_of_exponent(&curve, &fallen, fit.end)?,
            picture_of_angle(curve, fit.end, rate)?,
        ],
        film: Some(film(shots)),
    })
}

/// Angle over the time that is left until `end` (s), with powers through the middle of the range.
fn picture_of_exponent(curve: &[(f64, f64)], fallen: &[(f64, f64)], end: f64) -> Outcome<Picture> {
    let left = |(time, angle): (f64, f64)| (end - time, angle);
    let before: Curve = (curve.iter())
        .filter(|&&(time, angle)| time < end - 0.05 && angle > 0.01)
        .map(|&point| left(point))
        .collect();
    let middle = left(fallen[fallen.len() / 2]);
    let power = |exponent: f64| {
        let at = |factor: f64| (middle.0 * factor, middle.1 * factor.powf(exponent));
        vec![at(0.2), at(2.5)]
    };
    let plots = vec![
        common::line(power(1.0 / 3.0), GREY, "1/3: film of air"),
        common::line(power(0.5), GREEN, "1/2: viscous rolling"),
        common::line(power(2.0 / 3.0), ORANGE, "2/3: dry rolling"),
        common::line(power(1.0), PURPLE, "1: dampers under points"),
        common::line(before, BLACK, "this coin"),
    ];
    Picture::new("exponent", plots, |layout| {
        layout
            .with_title("Euler's disk: angle over the remaining time")
            .with_log_scale()
            .with_x_label("remaining time (s)")
            .with_y_label("angle (rad)")
            .with_legend_position(LegendPosition::InsideBottomRight)
    })
}

fn picture_of_angle(curve: Curve, end: f64, rate: f64) -> Outcome<Picture> {
    let fall = vec![
        common::line(curve, BLUE, "angle, mean over 0.5 s"),
        common::line(
            vec![(end - FIRST / rate, FIRST), (end, 0.0)],
            PURPLE,
            "(4/3) (damping/stiffness) (g/r) (t0 - t)",
        ),
    ];
    Picture::new("angle", fall, |layout| {
        layout
            .with_title("Euler's disk: angle to the ground")
            .with_x_label("time (s)")
            .with_y_label("angle (rad)")
            .with_legend_position(LegendPosition::InsideTopRight)
    })
}

/// Returns time (s) and angle (rad) until the disk is nearly flat, and the shots of the film, which
/// goes on until it rests.
fn run(time_step: f64) -> Outcome<(Curve, Vec<Shot>)> {
    let stepper = Stepper::builder(Coin::ring(MASS, RADIUS))
        .gravity(UniformGravity::down(GRAVITY))
        .ground(FlatGround::level(STIFFNESS, DAMPING))
        .integrator(EnergyMomentum { time_step })
        .build()?;
    // The plane leans by a rotation about y from upright.
    let turned = State::at(DVec3::ZERO)
        .with_rotation_vector(DVec3::Y * (FIRST - core::f64::consts::FRAC_PI_2));
    let axes = turned.rotation().axes();
    // Depth of the lowest point under the weight, distributed along the rim: M g = (n S/2π) (2/3) r
    // sin α φ³ with the half-angle φ of the patch, depth r sin α φ²/2.
    let steep = FIRST.sin();
    let patch = (3.0 * core::f64::consts::PI * MASS * GRAVITY
        / (120.0 * STIFFNESS * RADIUS * steep))
        .cbrt();
    let sink = RADIUS * steep * patch * patch / 2.0;
    let precession = (2.0 * GRAVITY / (RADIUS * steep)).sqrt();
    // No spin about the normal: the rotation about the vertical without its component along the
    // normal.
    let spin = DVec3::Z - axes.x * axes.x.z;
    let spin = spin * precession;
    let momentum = stepper
        .scene()
        .inertia_properties()
        .angular_momentum(&axes, spin);
    let mut state = State {
        position: DVec3::Z * (RADIUS * steep - sink),
        ..turned
    }
    .with_angular_momentum(momentum);
    let (mut curve, mut flat) = (Vec::new(), None);
    let mut camera = Camera::new(0.01);
    let mut watch = |sample: &Sample<'_>| {
        let angle = stepper.body().tilt(sample.state);
        camera.look(sample, || [angle.to_degrees()]);
        if flat.is_none() {
            curve.push((sample.time, angle));
            flat = (angle <= FLAT).then_some(sample.time);
        }
        match flat {
            Some(flat) if sample.time > flat + AFTERWARDS => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    };
    stepper.run(&mut state, 40.0, &mut watch)?;
    Ok((curve, camera.shots))
}

fn film(shots: Vec<Shot>) -> Film {
    Film {
        title: "Euler's disk".to_owned(),
        lines: vec![
            "A ring on its rim, without friction. It falls at a constant rate, because only the \
             dampers dissipate energy."
                .to_owned(),
            "The ring has no thickness. It is drawn with one.".to_owned(),
        ],
        size: RADIUS,
        distance: 5.4,
        slower: 1.0,
        bodies: vec![Mesh::coin(RADIUS, 120)],
        readouts: vec![Column::new("angle to floor", "°", 2, "ink")],
        curves: energy_columns(),
        events: Vec::new(),
        shots,
    }
}

/// Means over half a second, which contains many nutations.
fn smoothed(curve: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let count = curve.partition_point(|&(time, _)| time < 0.5);
    let mean = |part: &[(f64, f64)]| {
        let sum = part
            .iter()
            .fold((0.0, 0.0), |sum, p| (sum.0 + p.0, sum.1 + p.1));
        (sum.0 / part.len() as f64, sum.1 / part.len() as f64)
    };
    curve
        .windows(count)
        .step_by(count / 5 + 1)
        .map(mean)
        .collect()
}

/// Fitted law `angle = c (end - t)^exponent`.
#[derive(Debug)]
struct Fit {
    end: f64,
    exponent: f64,
}

impl Fit {
    /// Fit by least squares of the logarithms, with a golden-section search for the end.
    fn of(curve: &[(f64, f64)]) -> Self {
        let last = curve[curve.len() - 1].0;
        let span = last - curve[0].0;
        let (mut low, mut high) = (last + 1e-3 * span, last + 3.0 * span);
        let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
        for _ in 0..100 {
            let (a, b) = (high - golden * (high - low), low + golden * (high - low));
            if Self::with_end(curve, a).1 < Self::with_end(curve, b).1 {
                high = b;
            } else {
                low = a;
            }
        }
        Self::with_end(curve, f64::midpoint(low, high)).0
    }

    /// Line through the logarithms, and the remaining sum of squares.
    fn with_end(curve: &[(f64, f64)], end: f64) -> (Self, f64) {
        let logs = || {
            curve
                .iter()
                .map(|&(time, angle)| ((end - time).ln(), angle.ln()))
        };
        let (exponent, left) = straight(logs);
        (Self { end, exponent }, left)
    }
}

/// Slope of the line of least squares, and the mean square deviation from it.
fn straight<I: Iterator<Item = (f64, f64)>>(points: impl Fn() -> I) -> (f64, f64) {
    let count = points().count() as f64;
    let (x, y) = points().fold((0.0, 0.0), |sum, p| (sum.0 + p.0, sum.1 + p.1));
    let (x, y) = (x / count, y / count);
    let moment = |f: fn(f64, f64) -> f64| points().map(|p| f(p.0 - x, p.1 - y)).sum::<f64>();
    let (xx, xy, yy) = (
        moment(|x, _| x * x),
        moment(|x, y| x * y),
        moment(|_, y| y * y),
    );
    (xy / xx, (yy - xy * xy / xx) / count)
}

/// Rate at which the angle decreases, rad/s.
fn rate_of(curve: &[(f64, f64)]) -> f64 {
    -straight(|| curve.iter().copied()).0
}
