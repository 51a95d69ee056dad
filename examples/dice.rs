//! Throws of dice until they rest. By the chi-square test, a fair die shows each face equally
//! often, and a loaded one does not.
//!
//! Run `cargo run --release --example dice -- --help`.

// A program has the standard library. These lints are meant for the library.
#![allow(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

use std::ops::ControlFlow;
use std::process::ExitCode;

use common::{
    BLUE, Camera, Check, Column, Film, Mesh, ORANGE, Options, Outcome, Page, Picture, Random,
    energy_columns, mesh,
};
use indicatif::{ProgressBar, ProgressStyle};
use kuva::prelude::*;
use tumble::glam::{DQuat, DVec3};
use tumble::{
    Coulomb, Cuboid, EnergyMomentum, FlatGround, MassProperties, Sample, State, Stepper,
    UniformGravity, UntilRest,
};

const ABOUT: &str = "\
Throws a die of 16 mm with round corners a few thousand times, each time until it is at rest, and
counts the faces. Then throws a die whose centre of mass is 2 mm away from its middle.";

/// Mass of a die of acrylic, kg. The next constant is its edge, m.
const MASS: f64 = 0.0048;
const EDGE: f64 = 0.016;
const CORNER: f64 = 0.0015;
/// Displacement of a loaded die's centre of mass from the middle towards the four, m.
const LOAD: f64 = 0.002;
const GRAVITY: f64 = 9.81;
/// Chi-square with 5 degrees of freedom that one fair die in a thousand exceeds.
const CRITICAL: f64 = 20.515;
/// Longest time of a throw, s. A die that moves for longer is an error.
const PATIENCE: f64 = 20.0;

type Die = Stepper<Cuboid, FlatGround, Coulomb, UniformGravity>;

fn main() -> ExitCode {
    common::main("dice", ABOUT, work)
}

fn work(options: &Options) -> Outcome<Page> {
    let throws = if options.quick { 600 } else { 6000 };
    let fair_die = stepper(0.0)?;
    let fair = count(&fair_die, throws, 1)?;
    let loaded = count(&stepper(LOAD)?, throws, 2)?;
    Ok(Page {
        title: "Dice",
        text: text(throws, fair, loaded),
        checks: checks(throws, &fair, &loaded),
        pictures: vec![picture(throws, fair, loaded)?],
        film: Some(film(&fair_die)?),
    })
}

/// Fractions of the faces with 95 % intervals.
fn picture(throws: u32, fair: [u32; 6], loaded: [u32; 6]) -> Outcome<Picture> {
    let bars = |faces: [u32; 6], colour: &str, name: &str, beside: f64| {
        let places = (1..).zip(faces).map(|(face, count)| {
            (
                f64::from(face) + beside,
                f64::from(count) / f64::from(throws),
            )
        });
        let places = places.collect::<Vec<_>>();
        // 1.96 standard deviations of a fraction p of n throws, √(p (1 - p)/n).
        let errors = places
            .iter()
            .map(|&(_, p)| 1.96 * (p * (1.0 - p) / f64::from(throws)).sqrt())
            .collect::<Vec<_>>();
        let dots = ScatterPlot::new()
            .with_data(places)
            .with_y_err(errors)
            .with_color(colour)
            .with_size(2.5) // The intervals are longer.
            .with_legend(name);
        Plot::Scatter(dots)
    };
    let sixth = common::line(
        vec![(0.5, 1.0 / 6.0), (6.5, 1.0 / 6.0)],
        common::GREY,
        "1/6",
    );
    let plots = vec![
        sixth,
        bars(fair, BLUE, "fair", -0.08),
        bars(loaded, ORANGE, "loaded towards the four", 0.08),
    ];
    Picture::new("faces", plots, |layout| {
        layout
            .with_title("fraction of throws by face, with 95 % intervals")
            .with_x_tick_step(1.0)
            .with_x_axis_min(0.5)
            .with_x_axis_max(6.5)
            .with_x_label("face")
            .with_y_label("fraction")
            .with_y_axis_min(0.0)
            .with_legend_position(LegendPosition::InsideTopRight)
    })
}

fn text(throws: u32, fair: [u32; 6], loaded: [u32; 6]) -> Vec<String> {
    vec![
        format!(
            "Each of {throws} throws begins with a random orientation, spin and speed half a \
                 metre above the table and ends when the die is at rest."
        ),
        format!(
            "{throws} throws reject, with 99 %, a die one of whose sides has a probability \
                 {:.1} percentage points above a sixth, and the opposite side one as far below it.",
            100.0 * rejected_tilt(throws)
        ),
        format!(
            "Faces one to six of the fair die: {}. Of one whose centre of mass lies {:.0} mm \
                 towards the four: {}.",
            listed(fair),
            1e3 * LOAD,
            listed(loaded)
        ),
    ]
}

fn checks(throws: u32, fair: &[u32; 6], loaded: &[u32; 6]) -> Vec<Check> {
    let expected = f64::from(throws) / 6.0;
    let [fair_square, loaded_square] = [fair, loaded].map(|faces| chi_square(faces, expected));
    // The standard deviation of a count around n/6 is √(n/6 · 5/6).
    let spread = (expected * 5.0 / 6.0).sqrt();
    let three = (f64::from(loaded[2]) - expected) / spread;
    vec![
        Check::between(
            "chi-square of the fair die",
            "chi-square with 5 degrees of freedom, 0.999 quantile",
            fair_square,
            0.0,
            CRITICAL,
        ),
        Check::between(
            "probability of at least this chi-square, fair die",
            "survival function of chi-square with 5 degrees of freedom",
            survival(fair_square),
            1e-3,
            1.0,
        ),
        Check::between(
            "chi-square of the loaded die",
            "beyond the 1 - 1e-9 quantile",
            loaded_square,
            50.8,
            f64::INFINITY,
        ),
        Check::between(
            "threes of the loaded die beyond a sixth, in standard deviations",
            "the heavy side, four, lies below",
            three,
            5.0,
            f64::INFINITY,
        ),
    ]
}

fn stepper(load: f64) -> Outcome<Die> {
    let edges = DVec3::splat(EDGE);
    // The face at -z is the four.
    let heavy = MassProperties::cuboid(MASS, edges)?.at(DVec3::NEG_Z * load);
    // A corner that supports the whole weight penetrates by 12 µm, and bounces at 0.6 of its speed.
    let ground = FlatGround::level(4000.0, 1.2);
    Ok(
        Stepper::builder(Cuboid::loaded(edges, heavy).rounded(CORNER))
            .gravity(UniformGravity::down(GRAVITY))
            .ground(ground)
            .friction(Coulomb {
                coefficient: 0.3,
                slip_speed: 1e-4,
            })
            .integrator(EnergyMomentum { time_step: 1e-3 })
            .build()?,
    )
}

fn listed(faces: [u32; 6]) -> String {
    faces.map(|count| count.to_string()).join(", ")
}

/// Number of throws that showed each face.
fn count(die: &Die, throws: u32, seed: u64) -> Outcome<[u32; 6]> {
    let mut random = Random(seed);
    let mut faces = [0; 6];
    let style = ProgressStyle::with_template("{pos} of {len} throws {wide_bar} {eta} left")?;
    let bar = ProgressBar::new(u64::from(throws)).with_style(style);
    for _ in bar.wrap_iter(0..throws) {
        let (face, _) = throw(die, thrown(die, &mut random))?;
        faces[usize::from(face) - 1] += 1;
    }
    Ok(faces)
}

/// A die as it leaves the hand.
fn thrown(die: &Die, random: &mut Random) -> State {
    let mut any = |most: f64| {
        DVec3::new(
            random.between(-most, most),
            random.between(-most, most),
            random.between(-most, most),
        )
    };
    // Up to 60 rad/s about each axis.
    let spin = any(60.0);
    let velocity = any(1.0);
    let state = State::at(DVec3::Z * 0.5)
        .with_orientation(DQuat::from_array(random.turn()))
        .with_linear_velocity(velocity);
    die.with_angular_velocity(state, spin)
}

/// Returns the face that a throw shows, and the time at which the die rests.
fn throw(die: &Die, mut state: State) -> Outcome<(u8, f64)> {
    // At rest, it moves by at most a hundredth of a millimetre in 50 ms.
    let mut rest = UntilRest::new(die.body(), 1e-5, 0.05)?;
    let time = die.run(&mut state, PATIENCE, &mut rest)?;
    if !rest.is_reached() {
        return Err(format!("a die is not at rest after {PATIENCE} s").into());
    }
    let side = die
        .body()
        .face_up(&state)
        .ok_or("the die stands on an edge")?;
    Ok((side.pips(), time))
}

/// Film of the first counted throw.
fn film(die: &Die) -> Outcome<Film> {
    let mut state = thrown(die, &mut Random(1));
    let (face, time) = throw(die, state)?;
    let mut camera = Camera::new(0.002);
    let mut watch = |sample: &Sample<'_>| {
        let height = 1e3 * sample.state.position.z;
        camera.look(sample, || [height, sample.touching() as f64]);
        ControlFlow::Continue(())
    };
    die.run(&mut state, time + 0.2, &mut watch)?;
    Ok(Film {
        title: "A throw of the fair die".to_owned(),
        lines: vec![format!("It shows {face} and lies after {time:.2} s.")],
        size: 0.5 * EDGE,
        distance: 14.0,
        slower: 4.0,
        bodies: vec![Mesh::die(DVec3::ZERO, EDGE, mesh::IVORY, mesh::INK)],
        readouts: vec![
            Column::new("height of the centre", "mm", 1, "ink"),
            Column::new("corners that touch", "", 0, "ink"),
        ],
        curves: energy_columns(),
        events: vec![("lies", time)],
        shots: camera.shots,
    })
}

/// Chi-square of the counts: `Σ (count - expected)²/expected`.
fn chi_square(faces: &[u32; 6], expected: f64) -> f64 {
    let terms = faces.map(|count| (f64::from(count) - expected).powi(2) / expected);
    terms.iter().sum()
}

/// Probability that chi-square with 5 degrees of freedom is at least x.
fn survival(x: f64) -> f64 {
    survivals(x).nth(2).unwrap_or(0.0)
}

/// Probabilities that chi-square with 1, 3, 5, … degrees of freedom is at least x:
/// `erfc √(x/2) + √(2x/π) e^(-x/2) (1 + x/3 + x²/15 + …)`.
fn survivals(x: f64) -> impl Iterator<Item = f64> {
    let mut tail = libm::erfc((x / 2.0).sqrt());
    let mut term = (2.0 * x / std::f64::consts::PI).sqrt() * (-x / 2.0).exp();
    let mut freedom = 1.0;
    std::iter::from_fn(move || {
        let found = tail;
        tail += term;
        freedom += 2.0;
        term *= x / freedom;
        Some(found)
    })
}

/// Power of the test of the fair die for a noncentrality.
///
/// It is that of chi-square with 5 + 2 J degrees of freedom, where J has Poisson's distribution
/// with half of the noncentrality as its mean.
fn power(noncentrality: f64) -> f64 {
    let mean = 0.5 * noncentrality;
    let mut weight = (-mean).exp();
    let mut sum = 0.0;
    // Up to 200 terms: more than ten standard deviations above the means that occur here.
    for (number, survival) in (1..200).zip(survivals(CRITICAL).skip(2)) {
        sum += weight * survival;
        weight *= mean / f64::from(number);
    }
    sum
}

/// Least δ of a die with `1/6 + δ` and `1/6 - δ` on opposite sides that `throws` throws reject with
/// a probability of 99 %. Its noncentrality is `12 n δ²`.
fn rejected_tilt(throws: u32) -> f64 {
    let (mut low, mut high) = (0.0, 100.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if power(middle) < 0.99 {
            low = middle;
        } else {
            high = middle;
        }
    }
    (high / (12.0 * f64::from(throws))).sqrt()
}
