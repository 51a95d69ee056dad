//! Round rim or points: compares `Disc` with rings of 12, 120 and 1200 points with the same
//! stiffness of the whole rim.
//!
//! `cargo run --release --example round_rim -- --help` describes the options. The example prints
//! the tables of the documentation of `Disc`, and `.ci/instructions` counts its costs.

use core::error::Error;
use core::ops::ControlFlow;

use common::table::{self, cells};
use lexopt::prelude::*;
use tumble::glam::DVec3;
use tumble::{
    Coin, ContactPoint, Coulomb, Disc, EnergyMomentum, FlatGround, Frictionless, Integrator,
    Nystrom, RigidPointBody, Rk4, Sample, SceneQuery, SlidingFriction, State, Stepper,
    StrangSplitting, Trial, UniformGravity,
};

const RADIUS: f64 = 0.5;
const GRAVITY: f64 = 9.8;
/// Stiffness of the whole rim, N/m: 120 points of 1000 N/m and 0.5 N s/m.
const STIFFNESS: f64 = 120e3;
const DAMPING: f64 = 60.0;
/// Slip speed, m/s.
const SLIP_SPEED: f64 = 1e-3;

type Outcome<T> = Result<T, Box<dyn Error>>;

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

const HELP: &str = "\
Compares coins with 12, 120 and 1200 points on the rim with one whose rim is round. The total
stiffness is the same. Prints where the trials of the coin report end, how the coins rattle as they
roll, and how accurate each integrator is on the round rim. Takes some seconds.

Usage: cargo run --release --example round_rim -- [OPTIONS]

  -h, --help   this text
";

fn main() -> Outcome<()> {
    let mut arguments = lexopt::Parser::from_env();
    match arguments.next()? {
        None => {}
        Some(Short('h') | Long("help")) => {
            print!("{HELP}");
            return Ok(());
        }
        Some(other) => return Err(other.unexpected().into()),
    }
    trials()?;
    println!();
    rolling()?;
    println!();
    steps()
}

/// Compares the positions in the trials of the coin report with those of the round rim.
fn trials() -> Outcome<()> {
    let mut rows = Vec::new();
    for (name, points, body) in Body::all() {
        let mut places = Vec::new();
        for number in [1, 5, 8] {
            for seconds in [1.0, 5.0] {
                let scene = trial(number, points, seconds, Rk4 { time_step: 2e-4 })?;
                places.push(body.with(scene)?.place);
            }
        }
        rows.push((name, places));
    }
    let Some((_, round)) = rows.pop() else {
        return Ok(());
    };
    let mut lines = vec![cells([
        "distance from the round rim, m",
        "trial 1, 1 s",
        "5 s",
        "trial 5, 1 s",
        "5 s",
        "trial 8, 1 s",
        "5 s",
    ])];
    for (name, places) in rows {
        let apart = places.iter().zip(&round).map(|(a, b)| a.distance(*b));
        let apart = apart.map(|apart| format!("{apart:.1e}"));
        lines.push([name].into_iter().chain(apart).collect());
    }
    table::print(&lines);
    Ok(())
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

/// Position error of the round rim after one second of trial 1.
fn steps() -> Outcome<()> {
    let mut lines = vec![cells([
        "round, trial 1, place after 1 s",
        "`Rk4`",
        "`Nystrom`",
        "`StrangSplitting`",
        "`EnergyMomentum`",
    ])];
    let disc = Disc::<f64>::ring(1.0, RADIUS, 120);
    let truth = trial(1, 120.0, 1.0, Rk4 { time_step: 1e-4 })?
        .run(&disc)?
        .place;
    for time_step in [1e-2, 5e-3, 2e-3, 1e-3, 2e-4] {
        let places = [
            trial(1, 120.0, 1.0, Rk4 { time_step })?.run(&disc)?.place,
            trial(1, 120.0, 1.0, Nystrom { time_step })?
                .run(&disc)?
                .place,
            trial(1, 120.0, 1.0, StrangSplitting { time_step })?
                .run(&disc)?
                .place,
            trial(1, 120.0, 1.0, EnergyMomentum { time_step })?
                .run(&disc)?
                .place,
        ];
        let [rk4, nystrom, splitting, implicit] =
            places.map(|place| format!("{:.0e} m", place.distance(truth)));
        let step = format!("steps of {} ms", time_step * 1e3);
        lines.push(cells([step, rk4, nystrom, splitting, implicit]));
    }
    table::print(&lines);
    Ok(())
}

/// A hoop that rolls upright at 4 rad/s, at the penetration depth at which the round rim rests.
fn rolling() -> Outcome<()> {
    let start = State::at(DVec3::Z * (RADIUS * half_arc().cos()))
        .with_linear_velocity(-DVec3::Y * (4.0 * RADIUS))
        .with_angular_momentum(DVec3::X * (4.0 * RADIUS * RADIUS));
    let integrator = StrangSplitting { time_step: 1e-4 };
    let mut lines = vec![cells([
        "upright, 4 rad/s",
        "vertical acceleration, rms, over g",
        "energy lost in 1 s with dampers and friction, J",
    ])];
    for (name, points, body) in Body::all() {
        let seconds = 1.0;
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
        let lost = real.energy[0] - real.energy[1];
        let (rattle, lost) = (format!("{:.1e}", free.rattle), format!("{lost:.4}"));
        lines.push(cells([name, rattle, lost]));
    }
    table::print(&lines);
    Ok(())
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
