//! Round rim or points: compares `Disc` with rings of 12, 120 and 1200 points with the same
//! stiffness of the whole rim.
//!
//! `cargo run --release --example round_rim -- --help` describes the options. The example prints
//! the tables of the documentation of `Disc`, which `--write` stores, and `.ci/instructions` counts
//! its costs.

use core::ops::ControlFlow;
use std::process::ExitCode;

use common::hoop_circle;
use common::table::{self, cells};
use common::{BLACK, BLUE, Check, GREEN, ORANGE, Outcome, Page, Picture, Stored, line};
use kuva::prelude::*;
use tumble::glam::DVec3;
use tumble::{
    Coin, ContactPoint, Coulomb, Disc, Ellipsoid, EnergyMomentum, FlatGround, Frictionless,
    Integrator, MassProperties, Nystrom, RigidPointBody, Rk4, Sample, SceneQuery, SlidingFriction,
    State, Stepper, StrangSplitting, Trial, UniformGravity,
};

const RADIUS: f64 = hoop_circle::RADIUS;
const GRAVITY: f64 = hoop_circle::GRAVITY;
/// Stiffness of the whole rim, N/m: 120 points of 1000 N/m and 0.5 N s/m.
const STIFFNESS: f64 = 120e3;
const DAMPING: f64 = 60.0;
/// Slip speed, m/s.
const SLIP_SPEED: f64 = 1e-3;

/// A coin of 1 kg with this number of points on its rim, or with a round rim.
enum Body {
    Ring(Coin<f64, Vec<ContactPoint>>),
    Round(Disc),
}

impl Body {
    fn all() -> [(String, f64, Self); 4] {
        let ring = |n: u32| {
            let points = vec![ContactPoint::default(); n as usize];
            let coin = Coin::ring_with_storage(points, 1.0, RADIUS);
            (format!("{n} points"), f64::from(n), Self::Ring(coin))
        };
        let round = Self::Round(Disc::ring(1.0, RADIUS, 120));
        [
            ring(12),
            ring(120),
            ring(1200),
            ("round".into(), 120.0, round),
        ]
    }

    /// Calls `run` with the body as its own type.
    fn with<T>(&self, run: impl Run<T>) -> Outcome<T> {
        match self {
            Self::Ring(coin) => run.run(coin),
            Self::Round(disc) => run.run(disc),
        }
    }
}

/// Operation on a body of any type.
trait Run<T> {
    fn run<B: RigidPointBody>(self, body: &B) -> Outcome<T>;
}

/// A body on the rim's springs, with its fraction of them at each point.
struct Scene<F, I> {
    points: f64,
    damping: f64,
    friction: F,
    integrator: I,
    start: State,
    seconds: f64,
}

/// End of a run, its energy at both ends, and the rms variation of its vertical acceleration over
/// gravity.
struct Ride {
    place: DVec3,
    energy: [f64; 2],
    rattle: f64,
}

impl<F: SlidingFriction + Copy, I: Integrator + Copy> Run<Ride> for Scene<F, I> {
    fn run<B: RigidPointBody>(self, body: &B) -> Outcome<Ride> {
        let each = |whole: f64| whole / self.points;
        let stepper = Stepper::builder(body)
            .gravity(UniformGravity::down(GRAVITY))
            .ground(FlatGround::level(each(STIFFNESS), each(self.damping)))
            .friction(self.friction)
            .integrator(self.integrator)
            .build()?;
        let mut state = self.start;
        let (mut squares, mut samples) = (0.0, 0);
        let mut shake = |sample: &Sample<'_>| {
            squares += stepper.scene().rates(sample.state).acceleration.z.powi(2);
            samples += 1;
            ControlFlow::Continue(())
        };
        stepper.run(&mut state, self.seconds, &mut shake)?;
        Ok(Ride {
            place: state.position,
            energy: [stepper.energy(&self.start), stepper.energy(&state)].map(|e| e.total()),
            rattle: (squares / f64::from(samples)).sqrt() / GRAVITY,
        })
    }
}

const ABOUT: &str = "\
Compares coins with 12, 120 and 1200 points on the rim with one whose rim is round. The total
stiffness is the same. Prints where the trials of the coin report end, how the coins rattle as they
roll, where they roll round a circle, and how accurate each integrator is on the round rim.";

const STORED: Stored = Stored {
    page: "src/body/disc.rs",
    marks: [
        "<!-- round rim: begin; written by `round_rim -- --write` -->",
        "<!-- round rim: end -->",
    ],
};

fn main() -> ExitCode {
    common::main_with_tables("round_rim", ABOUT, STORED, |_| work())
}

fn work() -> Outcome<Page> {
    let (distances, rides, circles) = (distances()?, rides()?, circles()?);
    let errors = errors()?;
    Ok(Page {
        title: "Round rim or points?",
        text: vec![
            "Coins with points on the rim are compared with one whose rim is round. The total \
             stiffness is the same. Points make a coin rattle as it rolls."
                .to_owned(),
            table_of_distances(&distances),
            table_of_rides(&rides),
            table_of_circles(&circles),
            table_of_errors(&errors),
        ],
        checks: checks(&rides, &circles, &errors),
        pictures: vec![
            picture_of_distances(&distances)?,
            picture_of_rides(&rides)?,
            picture_of_errors(&errors)?,
        ],
        film: None,
    })
}

/// Trials of the coin report and times (s) at which the coins are compared.
const COMPARED: [(usize, f64); 6] = [(1, 1.0), (1, 5.0), (5, 1.0), (5, 5.0), (8, 1.0), (8, 5.0)];

/// Distances (m) of a coin with points from the round one, in the order of [`COMPARED`].
struct Distances {
    name: String,
    points: f64,
    distances: [f64; COMPARED.len()],
}

/// Compares the positions in the trials of the coin report with those of the round rim.
fn distances() -> Outcome<Vec<Distances>> {
    let mut rows = Vec::new();
    for (name, points, body) in Body::all() {
        let mut places = [DVec3::ZERO; COMPARED.len()];
        for (place, (number, seconds)) in places.iter_mut().zip(COMPARED) {
            let scene = trial(number, points, seconds, Rk4 { time_step: 2e-4 })?;
            *place = body.with(scene)?.place;
        }
        rows.push((name, points, places));
    }
    let (.., round) = rows.pop().ok_or("there is a round rim")?;
    let apart = |places: [DVec3; 6]| core::array::from_fn(|k| places[k].distance(round[k]));
    let rows = rows.into_iter().map(|(name, points, places)| Distances {
        name,
        points,
        distances: apart(places),
    });
    Ok(rows.collect())
}

fn table_of_distances(rows: &[Distances]) -> String {
    let mut lines = vec![cells([
        "distance from the round rim, m",
        "trial 1, 1 s",
        "5 s",
        "trial 5, 1 s",
        "5 s",
        "trial 8, 1 s",
        "5 s",
    ])];
    for row in rows {
        let apart = row.distances.map(two_digits);
        lines.push([row.name.clone()].into_iter().chain(apart).collect());
    }
    table::text(&lines)
}

fn picture_of_distances(rows: &[Distances]) -> Outcome<Picture> {
    let columns = [
        (0, BLUE, "trial 1"),
        (2, ORANGE, "trial 5"),
        (4, GREEN, "trial 8"),
    ];
    let plots = columns.map(|(column, colour, name)| {
        let curve = rows.iter().map(|row| (row.points, row.distances[column]));
        line(curve.collect(), colour, name)
    });
    logarithmic(
        "distance",
        plots.into(),
        "distance from the round rim after 1 s",
        ["number of points", "distance (m)"],
    )
}

/// Picture with two logarithmic axes.
fn logarithmic(
    name: &'static str,
    plots: Vec<Plot>,
    title: &str,
    [x, y]: [&str; 2],
) -> Outcome<Picture> {
    Picture::new(name, plots, |layout| {
        layout
            .with_title(title)
            .with_x_label(x)
            .with_y_label(y)
            .with_log_x()
            .with_log_y()
            .with_legend_position(LegendPosition::OutsideRightTop)
    })
}

/// A trial of the coin report on the springs of the rim.
fn trial<I>(number: usize, points: f64, seconds: f64, integrator: I) -> Outcome<Scene<Coulomb, I>> {
    let trial: Trial = Trial::report(number).ok_or("no such trial")?;
    Ok(Scene {
        points,
        damping: DAMPING,
        friction: Coulomb {
            coefficient: trial.coefficient,
            slip_speed: SLIP_SPEED,
        },
        integrator,
        start: trial.state(),
        seconds,
    })
}

const METHODS: [&str; 4] = ["Rk4", "Nystrom", "StrangSplitting", "EnergyMomentum"];
/// Step sizes, s.
const STEPS: [f64; 5] = [1e-2, 5e-3, 2e-3, 1e-3, 2e-4];

/// Position errors (m) of the round rim after one second of trial 1: a row for each of [`STEPS`],
/// with the [`METHODS`].
type Errors = [[f64; METHODS.len()]; STEPS.len()];

fn errors() -> Outcome<Errors> {
    let truth = end(Rk4 { time_step: 1e-4 })?;
    let mut errors = Errors::default();
    for (row, time_step) in errors.iter_mut().zip(STEPS) {
        let places = [
            end(Rk4 { time_step })?,
            end(Nystrom { time_step })?,
            end(StrangSplitting { time_step })?,
            end(EnergyMomentum { time_step })?,
        ];
        *row = places.map(|place| place.distance(truth));
    }
    Ok(errors)
}

/// Position of the round rim after one second of trial 1.
fn end(integrator: impl Integrator + Copy) -> Outcome<DVec3> {
    let disc = Disc::<f64>::ring(1.0, RADIUS, 120);
    Ok(trial(1, 120.0, 1.0, integrator)?.run(&disc)?.place)
}

fn table_of_errors(errors: &Errors) -> String {
    let methods = METHODS.map(|name| format!("`{name}`"));
    let head = ["round, trial 1, position after 1 s".to_owned()];
    let mut lines = vec![head.into_iter().chain(methods).collect()];
    for (row, time_step) in errors.iter().zip(STEPS) {
        let step = format!("steps of {} ms", time_step * 1e3);
        let row = row.map(|error| format!("{error:.0e} m"));
        lines.push([step].into_iter().chain(row).collect());
    }
    table::text(&lines)
}

fn picture_of_errors(errors: &Errors) -> Outcome<Picture> {
    let colours = [BLUE, GREEN, ORANGE, BLACK];
    let plots = METHODS.into_iter().zip(colours).enumerate();
    let plots = plots.map(|(column, (name, colour))| {
        let curve = errors.iter().zip(STEPS);
        // In micrometres: a logarithmic axis of this drawing ends at 1e-10.
        let curve = curve.map(|(row, step)| (step * 1e3, row[column] * 1e6));
        line(curve.collect(), colour, name)
    });
    logarithmic(
        "error",
        plots.collect(),
        "round rim, trial 1: position error after 1 s",
        ["step size (ms)", "error (μm)"],
    )
}

/// How a hoop rolls: its number of points, its rattle, and the energy that it loses.
struct Rolling {
    name: String,
    points: f64,
    /// Rms vertical acceleration over gravity, without friction and dampers.
    rattle: f64,
    /// Energy lost in a second with friction and dampers, J.
    lost: f64,
}

/// Hoops that roll upright at 4 rad/s, at the penetration depth at which the round rim rests.
fn rides() -> Outcome<Vec<Rolling>> {
    let start = State::at(DVec3::Z * (RADIUS * half_arc().cos()))
        .with_linear_velocity(-DVec3::Y * (4.0 * RADIUS))
        .with_angular_momentum(DVec3::X * (4.0 * RADIUS * RADIUS));
    let integrator = StrangSplitting { time_step: 1e-4 };
    let (mut rides, seconds) = (Vec::new(), 1.0);
    for (name, points, body) in Body::all() {
        let free = body.with(Scene {
            points,
            damping: 0.0,
            friction: Frictionless,
            integrator,
            start,
            seconds,
        })?;
        let friction = Coulomb {
            coefficient: 0.3,
            slip_speed: SLIP_SPEED,
        };
        let real = body.with(Scene {
            points,
            damping: DAMPING,
            friction,
            integrator,
            start,
            seconds,
        })?;
        rides.push(Rolling {
            name,
            points,
            rattle: free.rattle,
            lost: real.energy[0] - real.energy[1],
        });
    }
    Ok(rides)
}

fn table_of_rides(rides: &[Rolling]) -> String {
    let mut lines = vec![cells([
        "upright, 4 rad/s",
        "vertical acceleration, rms, over g",
        "energy lost in 1 s with dampers and friction, J",
    ])];
    for ride in rides {
        let (rattle, lost) = (two_digits(ride.rattle), format!("{:.4}", ride.lost));
        lines.push(cells([ride.name.clone(), rattle, lost]));
    }
    table::text(&lines)
}

fn picture_of_rides(rides: &[Rolling]) -> Outcome<Picture> {
    // The last one is the round rim, which does not rattle.
    let points = &rides[..rides.len() - 1];
    let curve = points.iter().map(|ride| (ride.points, ride.rattle));
    logarithmic(
        "rattle",
        vec![line(curve.collect(), BLUE, "points")],
        "a hoop that rolls upright at 4 rad/s rattles on its points",
        ["number of points", "vertical acceleration, rms, over g"],
    )
}

/// Stiffness of the whole rim (N/m) of hoops that roll round a circle.
const STIFFNESSES: [f64; 4] = [1e6, 1e7, 1e8, 1e9];
/// Duration of the circle, s.
const ROUND: f64 = 10.0;

/// Distances (m) of hoops of one stiffness from the hoop on a rigid floor.
struct Circle {
    stiffness: f64,
    round: f64,
    points: f64,
    ellipsoid: f64,
}

/// Hoops that roll round a circle, without dampers.
fn circles() -> Outcome<Vec<Circle>> {
    let points = vec![ContactPoint::default(); 1200];
    let coin = Coin::ring_with_storage(points, 1.0, RADIUS);
    let disc = Disc::<f64>::ring(1.0, RADIUS, 120);
    let properties = MassProperties {
        mass: 1.0,
        centre_of_mass: DVec3::ZERO,
        inertia: disc.inertia(),
    };
    let thin = DVec3::new(1e-4, RADIUS, RADIUS);
    let ellipsoid = Ellipsoid::loaded(thin, properties);
    let row = |&stiffness: &f64| {
        Ok(Circle {
            stiffness,
            round: roll_round(&disc, stiffness / 120.0)?,
            points: roll_round(&coin, stiffness / 1200.0)?,
            // Its one point has the stiffness of an arc of 6 degrees.
            ellipsoid: roll_round(&ellipsoid, stiffness / 60.0)?,
        })
    };
    STIFFNESSES.iter().map(row).collect()
}

/// Distance (m) of a hoop on points of this stiffness (N/m) from the hoop on a rigid floor.
fn roll_round(body: &impl RigidPointBody, stiffness: f64) -> Outcome<f64> {
    let stepper = Stepper::builder(body)
        .gravity(UniformGravity::down(GRAVITY))
        .ground(FlatGround::level(stiffness, 0.0))
        .friction(Coulomb {
            coefficient: 0.3,
            slip_speed: 1e-4,
        })
        .integrator(EnergyMomentum { time_step: 1e-3 })
        .build()?;
    let mut state = hoop_circle::after(0.0);
    stepper.advance(&mut state, ROUND)?;
    Ok(state.position.distance(hoop_circle::after(ROUND).position))
}

fn table_of_circles(circles: &[Circle]) -> String {
    let mut lines = vec![cells([
        "circle, distance after 10 s, m",
        "round rim",
        "1200 points",
        "thin `Ellipsoid`",
    ])];
    for circle in circles {
        let distances = [circle.round, circle.points, circle.ellipsoid].map(two_digits);
        let stiffness = [format!("whole rim {:.0e} N/m", circle.stiffness)];
        lines.push(stiffness.into_iter().chain(distances).collect());
    }
    table::text(&lines)
}

fn checks(rides: &[Rolling], circles: &[Circle], errors: &Errors) -> Vec<Check> {
    let [.., fine, round] = rides else {
        return Vec::new();
    };
    // From the second to the fourth step size.
    let order = |method: usize| (errors[1][method] / errors[3][method]).ln() / 5.0_f64.ln();
    let checked = [("Rk4", 0, 4.0), ("Nystrom", 1, 4.0), ("Strang", 2, 2.0)];
    let mut checks = vec![
        Check::between(
            "vertical acceleration of the round rim, rms, over g",
            "it rolls at the height of rest",
            round.rattle,
            0.0,
            1e-10,
        ),
        Check::near(
            "energy that 1200 points lose over that of the round rim",
            "the same springs, dampers and friction along the rim",
            fine.lost / round.lost,
            1.0,
            0.01,
        ),
    ];
    if let [.., soft, hard] = circles {
        checks.push(Check::between(
            "round rim on a circle: ratio of the distances at a tenth of the stiffness",
            "the length of the arc that touches, which is as the cube root: 2.15",
            soft.round / hard.round,
            1.7,
            2.6,
        ));
    }
    for (name, method, expected) in checked {
        checks.push(Check::between(
            &format!("{name}, order on the round rim between 5 ms and 1 ms"),
            "order of the method; the force of a round rim is smooth while it touches",
            order(method),
            expected - 0.3,
            f64::INFINITY,
        ));
    }
    checks
}

/// Half of the arc that supports the weight of the upright round rim:
/// `n S r (sin α - α cos α)/π = m g`.
fn half_arc() -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let alpha: f64 = 0.5 * (low + high);
        let force =
            STIFFNESS * RADIUS / core::f64::consts::PI * (alpha.sin() - alpha * alpha.cos());
        if force < GRAVITY {
            low = alpha;
        } else {
            high = alpha;
        }
    }
    low
}

/// Formats a number with two digits, with a power of ten if it is small.
fn two_digits(value: f64) -> String {
    match value.abs() {
        1.0.. => format!("{value:.1}"),
        0.1.. => format!("{value:.2}"),
        _ => format!("{value:.1e}"),
    }
}
