//! A boiled egg that is spun on its side and rises onto its end.
//!
//! Run `cargo run --release --example rising_egg -- --help`.

// A program has the standard library. These lints are meant for the library.
#![allow(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

use std::ops::ControlFlow;
use std::process::ExitCode;

use common::{
    BLUE, Camera, Check, Column, Film, GREEN, Mesh, ORANGE, Options, Outcome, Page, Picture, Shot,
    energy_columns, mesh,
};
use kuva::prelude::*;
use tumble::glam::DVec3;
use tumble::{
    Coulomb, Ellipsoid, EnergyMomentum, FlatGround, Sample, State, Stepper, UniformGravity,
};

const ABOUT: &str = "\
Spins a smooth spheroid that lies on its side. Weak friction at its contact lifts it onto its end,
as Moffatt and Shimomura explain: the angular momentum about the vertical times the height of the
centre is constant (Jellett's constant), so that one decreases as the other increases.";

/// Mass, kg. The next constants are the semi-axes, m: the long one and the other two.
const MASS: f64 = 0.06;
const LONG: f64 = 0.03;
const SHORT: f64 = 0.02;
const GRAVITY: f64 = 9.81;
/// Spin about the vertical, rad/s: 24 revolutions a second.
const SPIN: f64 = 150.0;
/// Angle of the long axis from level at the start, rad.
const LEAN: f64 = 0.05;

#[derive(Clone, Copy, Debug)]
struct Moment {
    time: f64,
    /// Angle of the long axis from level, degrees.
    rise: f64,
    /// Height of the centre, m.
    height: f64,
    /// Angular momentum about the vertical times the height, kg m³/s.
    jellett: f64,
    energy: f64,
}

fn main() -> ExitCode {
    common::main("rising_egg", ABOUT, work)
}

fn work(options: &Options) -> Outcome<Page> {
    let (moments, shots) = run(if options.quick { 3.0 } else { 6.0 })?;
    let (first, last) = (moments[0], moments[moments.len() - 1]);
    Ok(Page {
        title: "Rising egg",
        text: vec![
            "A homogeneous spheroid of 60 mm by 40 mm is spun at 150 rad/s about the vertical, on \
             its side except for 0.05 rad; the friction coefficient is 0.1."
                .to_owned(),
            format!(
                "Its long axis goes from {:.0} to {:.0} degrees, its centre from {:.1} to {:.1} \
                 mm.",
                first.rise,
                last.rise,
                1e3 * first.height,
                1e3 * last.height
            ),
        ],
        checks: checks(&moments),
        pictures: vec![picture_of_rise(&moments)?, picture_of_jellett(&moments)?],
        film: Some(film(shots)),
    })
}

fn picture_of_rise(moments: &[Moment]) -> Outcome<Picture> {
    let curve = moments.iter().map(|m| (m.time, m.rise)).collect();
    let rise = common::line(curve, BLUE, "long axis from level");
    Picture::new("rise", vec![rise], |layout| {
        layout
            .with_title("rising egg: angle of the long axis")
            .with_x_label("time (s)")
            .with_y_label("degrees")
            .with_legend_position(LegendPosition::InsideBottomRight)
    })
}

fn picture_of_jellett(moments: &[Moment]) -> Outcome<Picture> {
    let share = |value: fn(&Moment) -> f64| {
        let start = value(&moments[0]);
        moments.iter().map(|m| (m.time, value(m) / start)).collect()
    };
    let kept = vec![
        common::line(
            share(|m| m.jellett / m.height),
            ORANGE,
            "angular momentum about the vertical",
        ),
        common::line(share(|m| m.height), BLUE, "height of the centre"),
        common::line(share(|m| m.jellett), GREEN, "their product"),
    ];
    Picture::new("jellett", kept, |layout| {
        layout
            .with_title("rising egg: Jellett's constant")
            .with_x_label("time (s)")
            .with_y_label("fraction of the start")
            .with_legend_position(LegendPosition::OutsideRightTop)
    })
}

fn checks(moments: &[Moment]) -> Vec<Check> {
    let (first, last) = (moments[0], moments[moments.len() - 1]);
    let drift = moments.iter().fold(0.0, |most: f64, m| {
        most.max((m.jellett / first.jellett - 1.0).abs())
    });
    let fall = (last.jellett / last.height) / (first.jellett / first.height);
    vec![
        Check::between(
            "largest angle of the long axis from level, degrees",
            "it stands on its end (Moffatt & Shimomura, Nature 416, 385, 2002)",
            moments.iter().map(|m| m.rise).fold(0.0, f64::max),
            80.0,
            90.0,
        ),
        Check::near(
            "angular momentum about the vertical at the end, fraction of that at the start",
            "Jellett's constant in the gyroscopic approximation: height at the start over height \
             at the end",
            fall,
            first.height / last.height,
            APPROXIMATE,
        ),
        Check::between(
            "largest relative change of the product during the rise",
            "constant except for terms of g/(spin² a)",
            drift,
            0.0,
            APPROXIMATE,
        ),
        Check::energy([moments.iter().map(|m| m.energy).collect()]),
    ]
}

/// Relative error of the approximation, which leaves out terms of the relative size `g/(Ω² a)`.
///
/// This is 0.032 with the long semi-axis a and the 101 rad/s about the vertical that are left at
/// the end.
const APPROXIMATE: f64 = 0.032;

fn run(duration: f64) -> Outcome<(Vec<Moment>, Vec<Shot>)> {
    let egg = Ellipsoid::solid(MASS, DVec3::new(SHORT, SHORT, LONG));
    let stepper = Stepper::new(egg)?
        .with_gravity(UniformGravity::down(GRAVITY))?
        // The egg penetrates by 59 µm.
        .with_ground(FlatGround::level(1e4, 5.0))?
        .with_friction(Coulomb {
            coefficient: 0.1,
            slip_speed: 1e-2,
        })?
        .with_integrator(EnergyMomentum { time_step: 1e-4 })?;
    let turned = State::at(DVec3::ZERO)
        .with_rotation_vector(DVec3::Y * (core::f64::consts::FRAC_PI_2 - LEAN));
    let axes = turned.rotation().axes();
    // Distance of the tangent plane from the middle.
    let height = (LONG * axes.z.z).hypot(SHORT * (1.0 - axes.z.z * axes.z.z).sqrt());
    let properties = tumble::Dynamics::inertia_properties(stepper.scene());
    // The gyroscopic balance C n = A Ω cos θ: the angular momentum is vertical.
    let across = properties.moments().x;
    let mut state = State {
        position: DVec3::Z * (height - MASS * GRAVITY / 1e4),
        ..turned
    }
    .with_angular_momentum(DVec3::Z * (across * SPIN));
    let mut moments: Vec<Moment> = Vec::new();
    // Between two shots the egg rotates by about half a radian.
    let mut camera = Camera::new(0.004);
    let mut watch = |sample: &Sample<'_>| {
        camera.look(sample, || {
            [risen(sample.state), 1e3 * sample.state.position.z]
        });
        if sample.time >= moments.len() as f64 * 0.005 - 1e-9 {
            let state = sample.state;
            moments.push(Moment {
                time: sample.time,
                rise: risen(state),
                height: state.position.z,
                jellett: state.angular_momentum.z * state.position.z,
                energy: sample.energy().total(),
            });
        }
        ControlFlow::Continue(())
    };
    stepper.run(&mut state, duration, &mut watch)?;
    Ok((moments, camera.shots))
}

/// Angle of the long axis from level, degrees.
fn risen(state: &State) -> f64 {
    let tip = state.rotation().axes().z.z;
    tip.abs().min(1.0).asin().to_degrees()
}

fn film(shots: Vec<Shot>) -> Film {
    Film {
        title: "Rising egg".to_owned(),
        lines: vec![
            "A spheroid of 60 mm by 40 mm, spun on its side at 150 rad/s, stands up by friction."
                .to_owned(),
        ],
        size: LONG,
        distance: 6.0,
        slower: 4.0,
        bodies: vec![Mesh::ellipsoid(
            DVec3::ZERO,
            DVec3::new(SHORT, SHORT, LONG),
            [mesh::IVORY, mesh::SAND],
            [mesh::RED, mesh::BLUE],
        )],
        readouts: vec![
            Column::new("long axis from level", "°", 1, "ink"),
            Column::new("height of the centre", "mm", 1, "ink"),
        ],
        curves: energy_columns(),
        events: Vec::new(),
        shots,
    }
}
