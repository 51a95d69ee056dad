//! The bounces of a dropped ball: the time and restitution of each, and how they sound.
//!
//! Run `cargo run --release --example bounces -- --help`.

// A program has the standard library. These lints are meant for the library.
#![allow(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::process::ExitCode;

use common::{
    BLUE, Camera, Check, Column, Film, Mesh, ORANGE, Options, Outcome, Page, Picture, Shot, mesh,
};
use kuva::prelude::*;
use tumble::glam::DVec3;
use tumble::{
    AirDrag, Apex, Carried, Contact, Coulomb, Dynamics, EnergyMomentum, EventEnd, Ground, Landing,
    LiftOff, Sample, Sphere, SpringDamper, SpringDamperGround, State, Stepper, UniformGravity,
};

const ABOUT: &str = "\
Drops a table tennis ball from 305 mm, finds each touch-down, each lift-off and each apex as an
event, and compares them with the geometric series of a ball without air and with the closed form of
a ball with quadratic drag. The intervals between the sounds give the restitution
(Bernstein 1977).";

/// Mass (kg) and radius (m) of a ball of 40 mm by the rules of table tennis.
const MASS: f64 = 0.0027;
const RADIUS: f64 = 0.02;
const GRAVITY: f64 = 9.81;
/// Height of the drop under the ball, m. The ball rises to 240 to 260 mm (technical leaflet T3).
const HEIGHT: f64 = 0.305;
/// Ratio of the speed after a bounce to that before it: `√(250/305)`.
const RESTITUTION: f64 = 0.905;
/// Contact time, s, of the order of that of a real ball.
const CONTACT_TIME: f64 = 1e-3;
/// Drag coefficient of a smooth sphere at Reynolds numbers of some thousands, and density of air.
const DRAG: f64 = 0.45;
const DENSITY: f64 = 1.2; // kg/m³
/// Impact speed at which the count of bounces ends, m/s. Below it, the weight of the ball counts in
/// the contact.
const SLOWEST: f64 = 0.1;

type Dropped =
    Stepper<Sphere, Ground<SpringDamper>, Coulomb, UniformGravity, EnergyMomentum, f64, AirDrag>;

/// One bounce, and the apex after it.
#[derive(Clone, Copy, Debug, Default)]
struct Bounce {
    /// Times of touch-down and lift-off, s.
    lands: f64,
    leaves: f64,
    /// Speeds down before and up after it, m/s.
    before: f64,
    after: f64,
    /// Height of the apex after it above that of touch-down, m.
    apex: f64,
}

impl Bounce {
    fn restitution(&self) -> f64 {
        self.after / self.before
    }
}

fn main() -> ExitCode {
    common::main("bounces", ABOUT, work)
}

fn work(options: &Options) -> Outcome<Page> {
    let time_step = CONTACT_TIME / if options.quick { 50.0 } else { 100.0 };
    let vacuum = bounces(&stepper(AirDrag::default(), time_step)?)?;
    let air = bounces(&stepper(drag(), time_step)?)?;
    let mut checks = checks_without_air(&vacuum);
    checks.extend(checks_in_air(&air));
    let (clicks, shots) = sound(&stepper(drag(), time_step)?)?;
    Ok(Page {
        title: "The bounces of a ball",
        text: vec![
            format!(
                "Without air the ball bounces {} times before it is slower than {SLOWEST} m/s, in \
                 air {} times. The first intervals between two sounds are {} s in air and {} s \
                 without.",
                vacuum.len(),
                air.len(),
                list(&intervals(&air)),
                list(&intervals(&vacuum))
            ),
            format!(
                "Without air the intervals have the ratio of the restitution, {RESTITUTION}. In air \
                 the ball loses speed on its way too, so that the first sounds alone give {:.3}.",
                ratio_of_sounds(&air)
            ),
        ],
        checks,
        pictures: vec![
            picture_of_sound(&clicks)?,
            picture_of_click(&clicks)?,
            picture_of_intervals(&vacuum, &air)?,
            picture_of_restitution(&vacuum, &air)?,
        ],
        film: Some(film(shots, &air)),
    })
}

/// Drag of the ball in still air.
fn drag() -> AirDrag {
    AirDrag::quadratic(DRAG, PI * RADIUS * RADIUS, DENSITY)
}

fn stepper(drag: AirDrag, time_step: f64) -> Outcome<Dropped> {
    let carried = Carried {
        mass: MASS,
        contacts: 1,
    };
    let law = SpringDamper::from_bounce(carried, RESTITUTION, CONTACT_TIME)?;
    Ok(Stepper::builder(Sphere::shell(MASS, RADIUS))
        .gravity(UniformGravity::down(GRAVITY))
        .ground(Ground::level(law))
        .friction(Coulomb {
            coefficient: 0.4,
            slip_speed: 1e-3,
        })
        .integrator(EnergyMomentum { time_step })
        .force(drag)
        .build()?)
}

fn start() -> State {
    State::at(DVec3::Z * (HEIGHT + RADIUS))
}

/// Every bounce until the ball lands more slowly than [`SLOWEST`].
fn bounces(stepper: &Dropped) -> Outcome<Vec<Bounce>> {
    let mut found: Vec<Bounce> = Vec::new();
    let mut session = stepper.session(start());
    let end = session.run_with_events(60.0, [&Landing, &LiftOff, &Apex], |event| {
        let (state, time) = (event.state, event.time);
        let speed = state.linear_velocity.z.abs();
        if event.event == 0 {
            if speed < SLOWEST {
                return ControlFlow::Break(());
            }
            found.push(Bounce {
                lands: time,
                before: speed,
                ..Bounce::default()
            });
        } else if let Some(bounce) = found.last_mut() {
            if event.event == 1 {
                (bounce.leaves, bounce.after) = (time, speed);
            } else {
                bounce.apex = state.position.z - RADIUS;
            }
        }
        ControlFlow::Continue(())
    })?;
    match end {
        EventEnd::Event(_) => Ok(found),
        EventEnd::TimeCovered | EventEnd::Chatter { .. } => Err("the bounces do not end".into()),
    }
}

/// Checks of a ball without air. In a contact of the time T, gravity changes a velocity by at most
/// `g T`, which bounds what each bounce deviates from the series.
fn checks_without_air(found: &[Bounce]) -> Vec<Check> {
    let deviation = |bounce: &Bounce| {
        (bounce.restitution() - RESTITUTION).abs() * bounce.before / (GRAVITY * CONTACT_TIME)
    };
    let fall = (2.0 * HEIGHT / GRAVITY).sqrt();
    let speed = GRAVITY * fall;
    let parabola =
        |pair: &[Bounce]| (pair[1].lands - pair[0].leaves - 2.0 * pair[0].after / GRAVITY).abs();
    vec![
        Check::near(
            "no air: speed of the first touch-down, m/s",
            "√(2 g h)",
            found[0].before,
            speed,
            1e-9,
        ),
        Check::between(
            "no air: height after the first bounce, mm",
            "240 to 260 mm (ITTF technical leaflet T3), the restitution is chosen for 250 mm",
            1e3 * found[0].apex,
            240.0,
            260.0,
        ),
        Check::between(
            "no air: largest deviation of a restitution, in g T/v",
            "gravity during the contact: at most 1",
            found.iter().map(deviation).fold(0.0, f64::max),
            0.0,
            1.0,
        ),
        Check::between(
            "no air: largest deviation of a flight from 2 v/g, s",
            "a parabola; touch-down and lift-off are located to rounding",
            found.windows(2).map(parabola).fold(0.0, f64::max),
            0.0,
            1e-11,
        ),
        check_of_series(found),
        check_of_silence(found),
    ]
}

/// Each flight lasts 2 v/g. A contact changes v by at most g T, and so each later flight by 2 T.
fn check_of_series(found: &[Bounce]) -> Check {
    const BOUNCES: u8 = 10;
    let fall = (2.0 * HEIGHT / GRAVITY).sqrt();
    let flights = (1..=BOUNCES).map(|k| 2.0 * fall * RESTITUTION.powi(k.into()));
    let contacts = f64::from(BOUNCES) * CONTACT_TIME;
    Check::near(
        "no air: time of touch-down 11, s",
        "geometric series, √(2h/g) (1 + 2 Σ eᵏ), with ten contacts",
        found[usize::from(BOUNCES)].lands,
        fall + flights.sum::<f64>() + contacts,
        2.0 * contacts,
    )
}

/// The geometric series goes on after the last bounce that is counted.
fn check_of_silence(found: &[Bounce]) -> Check {
    let fall = (2.0 * HEIGHT / GRAVITY).sqrt();
    let last = &found[found.len() - 1];
    let silent = last.lands + 2.0 * fall_of(last.before) * RESTITUTION / (1.0 - RESTITUTION);
    let contacts = found.len() as f64 * CONTACT_TIME;
    Check::near(
        "no air: time until silence, s",
        "√(2h/g) (1 + e)/(1 - e): Bernstein, Am. J. Phys. 45, 41 (1977)",
        silent - contacts,
        fall * (1.0 + RESTITUTION) / (1.0 - RESTITUTION),
        2.0 * contacts,
    )
}

/// Time in which a body falls to a speed, s.
fn fall_of(speed: f64) -> f64 {
    speed / GRAVITY
}

/// Checks of a ball in air with quadratic drag, against the closed form of its way up and down:
/// `v² = u² (1 - exp(-2 g h/u²))` and `h = u²/(2 g) ln(1 + v²/u²)`, with the terminal speed u.
fn checks_in_air(found: &[Bounce]) -> Vec<Check> {
    let terminal_square = MASS * GRAVITY / drag().quadratic;
    let falls = |height: f64| {
        (terminal_square * -(-2.0 * GRAVITY * height / terminal_square).exp_m1()).sqrt()
    };
    let rises =
        |speed: f64| terminal_square / (2.0 * GRAVITY) * (speed * speed / terminal_square).ln_1p();
    let worst = |deviations: &mut dyn Iterator<Item = f64>| deviations.fold(0.0, f64::max);
    let up = worst(
        &mut found
            .iter()
            .map(|one| (one.apex / rises(one.after) - 1.0).abs()),
    );
    let down = worst(
        &mut found
            .windows(2)
            .map(|pair| (pair[1].before / falls(pair[0].apex) - 1.0).abs()),
    );
    let source = "closed form of a vertical throw with quadratic drag";
    vec![
        Check::near(
            "air: speed of the first touch-down, m/s",
            source,
            found[0].before,
            falls(HEIGHT),
            1e-6,
        ),
        Check::between(
            "air: largest relative deviation of an apex",
            source,
            up,
            0.0,
            1e-6,
        ),
        Check::between(
            "air: largest relative deviation of a landing speed",
            source,
            down,
            0.0,
            1e-6,
        ),
        Check::between(
            "air: restitution by the first two intervals between sounds",
            "smaller than that of the bounce, because the air slows the ball, too",
            ratio_of_sounds(found),
            0.85,
            RESTITUTION - 0.01,
        ),
    ]
}

/// Intervals between two touch-downs, s.
fn intervals(found: &[Bounce]) -> Vec<f64> {
    found
        .windows(2)
        .map(|pair| pair[1].lands - pair[0].lands)
        .collect()
}

/// Ratio of the second interval to the first.
fn ratio_of_sounds(found: &[Bounce]) -> f64 {
    let between = intervals(found);
    between[1] / between[0]
}

fn list(values: &[f64]) -> String {
    let first = values.iter().take(3).map(|value| format!("{value:.3}"));
    first.collect::<Vec<_>>().join(", ")
}

/// Force of the ground at every step of contact, for each bounce, and the shots of the film.
fn sound(stepper: &Dropped) -> Outcome<(Vec<Click>, Vec<Shot>)> {
    let (mut clicks, mut camera) = (Vec::new(), Camera::new(0.005));
    let mut click = Click::new();
    let mut watch = |sample: &Sample<'_>| {
        let state = sample.state;
        camera.look(sample, || {
            [1e3 * (state.position.z - RADIUS), state.linear_velocity.z]
        });
        let force = contact_force(stepper, state);
        if force > 0.0 {
            click.push((sample.time, force));
        } else if !click.is_empty() {
            clicks.push(core::mem::take(&mut click));
        }
        ControlFlow::Continue(())
    };
    let mut state = start();
    stepper.run(&mut state, SHOWN, &mut watch)?;
    Ok((clicks, camera.shots))
}

/// Force (N) of the ground over the time (s) in one contact.
type Click = Vec<(f64, f64)>;

/// Time of the picture and of the film, s.
const SHOWN: f64 = 3.0;

fn contact_force(stepper: &Dropped, state: &State) -> f64 {
    let (scene, mut force) = (stepper.scene(), 0.0);
    scene.visit_contacts(&scene.motion(state), &mut |contact: &Contact| {
        force += scene
            .ground()
            .normal_force(contact.depth, contact.closing_speed);
    });
    force
}

/// The record of a microphone on the table: one line for each contact, as high as its force.
fn picture_of_sound(clicks: &[Click]) -> Outcome<Picture> {
    let mut curve = vec![(0.0, 0.0)];
    for click in clicks {
        let peak = click.iter().map(|&(_, force)| force).fold(0.0, f64::max);
        let time = click[0].0;
        curve.extend([(time, 0.0), (time, peak), (time, 0.0)]);
    }
    curve.push((SHOWN, 0.0));
    Picture::new("sound", vec![common::line(curve, BLUE, "")], |layout| {
        layout
            .with_title("the sound of a ball that is dropped: the force on the table")
            .with_x_label("time (s)")
            .with_y_label("greatest force of each contact (N)")
            .with_y_axis_min(0.0)
    })
}

/// The force during the first contact and during a later one.
fn picture_of_click(clicks: &[Click]) -> Outcome<Picture> {
    let of = |number: usize, colour, name: &str| {
        let start = clicks[number - 1][0].0;
        let curve = clicks[number - 1]
            .iter()
            .map(|&(time, force)| (1e3 * (time - start), force));
        common::line(curve.collect(), colour, name)
    };
    let plots = vec![of(1, BLUE, "first contact"), of(6, ORANGE, "sixth contact")];
    Picture::new("click", plots, |layout| {
        layout
            .with_title("one click: as long for a slow ball as for a fast one")
            .with_x_label("time since the touch-down (ms)")
            .with_y_label("force of the ground (N)")
            .with_y_axis_min(0.0)
            .with_legend_position(LegendPosition::InsideTopRight)
    })
}

/// Interval to the next touch-down over the number of the bounce.
fn picture_of_intervals(vacuum: &[Bounce], air: &[Bounce]) -> Outcome<Picture> {
    let curve = |found: &[Bounce]| {
        let numbers = (1..).map(f64::from);
        numbers.zip(intervals(found)).collect::<Vec<_>>()
    };
    let plots = vec![
        common::line(curve(vacuum), BLUE, "without air"),
        common::line(curve(air), ORANGE, "in air"),
    ];
    Picture::new("intervals", plots, |layout| {
        layout
            .with_title("the interval between two sounds")
            .with_x_label("number of the bounce")
            .with_y_label("interval to the next (s)")
            .with_log_y()
            .with_legend_position(LegendPosition::InsideTopRight)
    })
}

/// Restitution over the impact speed: of the bounce itself, and as the sounds show it.
fn picture_of_restitution(vacuum: &[Bounce], air: &[Bounce]) -> Outcome<Picture> {
    let of_bounce = |found: &[Bounce]| {
        let points = found
            .iter()
            .map(|bounce| (bounce.before, bounce.restitution()));
        points.collect::<Vec<_>>()
    };
    let between = intervals(air);
    let of_sounds = (air.iter().skip(1).zip(between.windows(2)))
        .map(|(bounce, pair)| (bounce.before, pair[1] / pair[0]));
    let plots = vec![
        common::line(of_bounce(vacuum), BLUE, "bounce, without air"),
        common::line(of_sounds.collect(), ORANGE, "ratio of intervals, in air"),
    ];
    Picture::new("restitution", plots, |layout| {
        layout
            .with_title("the restitution, and what the sounds show of it in air")
            .with_x_label("speed of the touch-down (m/s)")
            .with_y_label("ratio")
            .with_legend_position(LegendPosition::InsideBottomLeft)
    })
}

fn film(shots: Vec<Shot>, air: &[Bounce]) -> Film {
    let events = air.iter().zip(["first bounce", "second", "third"]);
    Film {
        title: "A table tennis ball that is dropped".to_owned(),
        lines: vec!["Dropped from 305 mm in air, with a restitution of 0.905.".to_owned()],
        size: RADIUS,
        distance: 24.0,
        slower: 2.0,
        bodies: vec![Mesh::ellipsoid(
            DVec3::ZERO,
            DVec3::splat(RADIUS),
            [mesh::IVORY, mesh::ORANGE],
            [mesh::SAND; 2],
        )],
        readouts: vec![
            Column::new("height", "mm", 1, "ink"),
            Column::new("vertical velocity", "m/s", 2, "ink"),
        ],
        curves: common::energy_columns(),
        events: events.map(|(bounce, name)| (name, bounce.lands)).collect(),
        shots,
    }
}
