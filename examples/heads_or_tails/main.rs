//! Has the lean of a coin at its start an effect on heads and tails? The question of the coin
//! report, with proven outcomes. `cargo run --release --example heads_or_tails -- --help`.

// An example has the standard library.
#![allow(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

mod bounced;
mod caught;
mod count;
mod drawing;
mod maps;
mod parts;
mod real_coin;
mod sensitivity;
mod spun;
mod steel;

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use common::{
    BLUE, Check, GREEN, GREY, ORANGE, Options, Outcome, Page, Picture, line, make_folder, marked,
    not_both, program, table,
};
use count::Count;
use indicatif::{ProgressBar, ProgressStyle};
use kuva::prelude::*;
use parts::Sizes;
use spun::{LEAN_SPREAD, LEANS, Point, SPIN_SPREAD, STEP, THROWS};

const HELP: &str = "\
Has the lean of a coin at its start an effect on heads and tails? The question of the coin report:

- the coin of the coin report starts rolling or spinning at leans of 0 to 60 degrees
- a cent spins on a table, with its centre of mass off the middle
- a coin is tossed and caught
- a coin is tossed and bounces: the bias after each bounce
- maps of the outcome over speed and rate, and over lean and spin (250 x 250 throws each)
- the distance of two starts 1e-9 m apart, in the eight trials of the coin report

A toss ends when its face is proven. It takes some minutes on two cores.

Usage: cargo run --release --example heads_or_tails -- [OPTIONS]

      --write           writes the answer into README.md
      --full            eight times the tosses or more, and maps of 1000 x 1000
  -o, --out <FOLDER>    where the page and its pictures go   [default: out]
  -q, --quick           a twentieth of the tosses or less, and maps of 40 x 40 and 20 x 20
  -h, --help            this text
";

/// Name of the example and of its folder.
const NAME: &str = "heads_or_tails";
const MARKS: [&str; 2] = [
    "<!-- heads or tails: begin; written by `heads_or_tails -- --write` -->",
    "<!-- heads or tails: end -->",
];
/// Reference in the README, which a page elsewhere cannot follow.
const MORE: &str = "; [more](src/guide/outcomes.md)";
const COLOURS: [&str; 3] = [BLUE, ORANGE, GREEN];

struct Arguments {
    is_written: bool,
    is_full: bool,
    options: Options,
}

fn main() -> ExitCode {
    program(parse(), HELP, work)
}

fn parse() -> Result<Option<Arguments>, lexopt::Error> {
    use lexopt::prelude::*;
    let mut arguments = Arguments {
        is_written: false,
        is_full: false,
        options: Options {
            out: PathBuf::from("out"),
            quick: false,
        },
    };
    let given: Vec<OsString> = std::env::args_os().skip(1).collect();
    let mut parser = lexopt::Parser::from_args(given);
    while let Some(argument) = parser.next()? {
        match argument {
            Long("write") => arguments.is_written = true,
            Long("full") => arguments.is_full = true,
            Short('o') | Long("out") => arguments.options.out = parser.value()?.into(),
            Short('q') | Long("quick") => arguments.options.quick = true,
            Short('h') | Long("help") => return Ok(None),
            other => return Err(other.unexpected()),
        }
    }
    let quick = ("--quick", arguments.options.quick);
    let [full, write] = [arguments.is_full, arguments.is_written];
    not_both([quick, ("--full", full)])?;
    // The README has the answer of the usual number of tosses.
    not_both([quick, ("--write", write)])?;
    not_both([("--full", full), ("--write", write)])?;
    Ok(Some(arguments))
}

fn work(arguments: &Arguments) -> Outcome<bool> {
    make_folder(&arguments.options.out.join(NAME))?;
    let sizes = Sizes::of(arguments.options.quick, arguments.is_full);
    let (spun_tosses, caught_tosses) = (sizes.spun, sizes.caught);
    let bar = bar(&sizes)?;
    let mut curves = Vec::new();
    for throw in &THROWS {
        let tosses = spun_tosses / throw.thinned;
        curves.push(spun::curve(throw, tosses, &bar)?);
    }
    let mut catches = Vec::new();
    for tilt in caught::TILTS {
        let counts = caught::ANGLES.map(|psi| {
            let chi = tilt.unwrap_or(psi);
            let count = caught::count(psi, chi, caught_tosses, &bar)?;
            Ok((psi, chi, count))
        });
        catches.push(counts.into_iter().collect::<Outcome<Vec<_>>>()?);
    }
    let parts = parts::all(&sizes, &bar)?;
    bar.finish_and_clear();
    let answer = answer(&curves);
    table::print(&spun_rows(&curves));
    if arguments.is_written {
        marked::write("README.md", MARKS, &format!("{answer}\n"))?;
    }
    let mut page = page(answer, &curves, &catches)?;
    for part in parts {
        page.text.extend(part.text);
        page.checks.extend(part.checks);
        page.pictures.extend(part.pictures);
    }
    page.write(NAME, &arguments.options)
}

/// Shows itself only on a terminal.
fn bar(sizes: &Sizes) -> Outcome<ProgressBar> {
    let counts = THROWS.map(|throw| sizes.spun / throw.thinned);
    let spun: u64 = counts
        .iter()
        .map(|count| count + count / spun::REPEATED)
        .sum();
    let spun = spun * LEANS.len() as u64;
    let caught = (caught::TILTS.len() * caught::ANGLES.len()) as u64 * sizes.caught;
    let style =
        ProgressStyle::with_template("tosses {wide_bar} {percent} %, {per_sec}, {eta} left")?;
    Ok(ProgressBar::new(spun + caught + sizes.throws()).with_style(style))
}

/// The answer to the question of the report, in two sentences.
fn answer(curves: &[Vec<Point>]) -> String {
    let shown = |count: &Count| {
        let [low, high] = count.interval().map(percent);
        format!("{} % [{low}, {high}]", percent(count.fraction()))
    };
    let upright = curves.iter().map(|curve| pooled(curve, 0.0..=0.0));
    let upright = upright.fold(Count::default(), Count::plus);
    let leaning: Vec<Count> = (curves.iter())
        .map(|curve| pooled(curve, 5.0..=60.0))
        .collect();
    let [rolling, spinning, fast] = leaning.as_slice() else {
        return String::new();
    };
    let passed =
        |count: &Count| percent(1.0 - count.straight as f64 / count.decided().max(1) as f64);
    marked::wrapped(&format!(
        "**Does the lean at the start bias heads or tails? {effect}.** A ring of 0.5 m radius \
         leans by 5° to 60°. Set rolling, it ends with the side up that pointed up at the start \
         in {} of the tosses; set spinning, with 1 kg m²/s, in {}; an upright one in {} (99.9 % \
         intervals{MORE}). With 5 kg m²/s it first rises until it is upright ({} % do) and \
         forgets its lean: {}, with {} % undecided after a minute.",
        shown(rolling),
        shown(spinning),
        shown(&upright),
        passed(fast),
        shown(fast),
        percent(fast.undecided as f64 / (fast.decided() + fast.undecided).max(1) as f64),
        effect = if has_effect(curves) { "Yes" } else { "No" },
    ))
}

/// Why one side is favoured.
fn reason(curves: &[Vec<Point>]) -> String {
    let passed = THROWS.iter().zip(curves).map(|(throw, curve)| {
        let count = pooled(curve, 5.0..=60.0);
        let straight = count.straight as f64 / count.decided().max(1) as f64;
        format!("{} % ({})", percent(straight), throw.name)
    });
    let passed: Vec<String> = passed.collect();
    format!(
        "With these starts the side that points up is favoured, because the weight makes a leaning \
         coin fall further to the side to which it leans. The other side can come up only if the \
         coin becomes upright again. It never does so in {} of the decided tosses at 5° to 60°. \
         With some other spins and leans the other side is favoured: see the map over both.",
        passed.join(", ")
    )
}

/// Sum of the outcomes at some leans, degrees.
fn pooled(curve: &[Point], leans: core::ops::RangeInclusive<f64>) -> Count {
    let points = curve.iter().filter(|point| leans.contains(&point.lean));
    points.fold(Count::default(), |sum, point| sum.plus(point.count))
}

/// Whether any lean differs from one half at the level of 1e-3, for all leans together.
fn has_effect(curves: &[Vec<Point>]) -> bool {
    let leaning = || curves.iter().flatten().filter(|point| point.lean > 0.0);
    let level = 1e-3 / leaning().count() as f64;
    leaning().any(|point| point.count.p_value() < level)
}

fn percent(fraction: f64) -> String {
    format!("{:.1}", 100.0 * fraction)
}

fn spun_rows(curves: &[Vec<Point>]) -> Vec<Vec<String>> {
    let head = [
        "start",
        "lean",
        "side up at the start comes up, 99.9 %",
        "p",
        "never upright again",
        "undecided",
        "repeated, heads, heads at a quarter of the step",
    ];
    let mut rows = vec![table::cells(head)];
    for (throw, curve) in THROWS.iter().zip(curves) {
        rows.extend(curve.iter().map(|point| {
            let count = &point.count;
            let [low, high] = count.interval();
            table::cells([
                throw.name.to_owned(),
                format!("{}°", point.lean),
                format!("{:.3} [{low:.3}, {high:.3}]", count.fraction()),
                format!("{:.0e}", count.p_value()),
                format!("{} of {}", count.straight, count.decided()),
                count.undecided.to_string(),
                format!(
                    "{}, {}, {}",
                    point.repeated, point.long.heads, point.short.heads
                ),
            ])
        }));
    }
    rows
}

type Catches = Vec<Vec<(f64, f64, Count)>>;

fn page(answer: String, curves: &[Vec<Point>], catches: &Catches) -> Outcome<Page> {
    Ok(Page {
        title: "Heads or tails",
        text: vec![
            answer.replace('\n', " ").replace(MORE, ""),
            format!(
                "The coin of the coin report (friction 0.3, slip speed 1 mm/s) starts at each lean \
                 within {LEAN_SPREAD}° of it, with an angular momentum within {} % of the stated \
                 one and at any angle of its polygon. A toss ends when its energy is below the \
                 barrier between the faces (`Nystrom`, {} ms), or undecided after a minute. \
                 Fractions are those of the decided tosses, bars intervals of Wilson, 99.9 %.",
                100.0 * SPIN_SPREAD,
                1e3 * STEP,
            ),
            reason(curves),
        ],
        checks: checks(curves, catches),
        pictures: vec![spun_picture(curves)?, caught_picture(catches)?],
        film: None,
    })
}

fn checks(curves: &[Vec<Point>], catches: &Catches) -> Vec<Check> {
    let mut checks: Vec<Check> = (THROWS.iter().zip(curves))
        .filter_map(|(throw, curve)| {
            let [low, high] = curve.first()?.count.interval();
            Some(Check::between(
                &format!(
                    "one half in the interval at 0°: distance from its middle over half its \
                     width, {}",
                    throw.name
                ),
                "symmetry of the start, 99.9 %",
                (0.5 - 0.5 * (low + high)).abs() / (0.5 * (high - low)),
                0.0,
                1.0,
            ))
        })
        .collect();
    let (changed, more) = curves
        .iter()
        .flatten()
        .fold((0, 0.0), |(changed, more), point| {
            let difference = point.long.heads as f64 - point.short.heads as f64;
            (changed + point.changed, more + difference)
        });
    checks.push(Check::between(
        &format!(
            "heads fewer at a quarter of the step, over the spread of the {changed} faces that \
             change"
        ),
        "McNemar's test, 99.9 %: the motion is chaotic, so that fractions are compared",
        more / (changed as f64).sqrt().max(1.0),
        -3.29,
        3.29,
    ));
    let errors = catches.iter().flatten().map(|(psi, chi, count)| {
        (count.fraction() - caught::formula(*psi, *chi)).abs() * count.decided() as f64
    });
    checks.push(Check::between(
        "tossed and caught: largest difference from the formula, in tosses of one point",
        "1/2 + asin(min(1, cot ψ cot χ))/π; equally spaced phases miss it by 2 tosses at most",
        errors.fold(0.0, f64::max),
        0.0,
        2.0,
    ));
    checks
}

fn spun_picture(curves: &[Vec<Point>]) -> Outcome<Picture> {
    let mut plots = vec![line(vec![(0.0, 0.5), (60.0, 0.5)], GREY, "one half")];
    for ((throw, curve), colour) in THROWS.iter().zip(curves).zip(COLOURS) {
        let places: Vec<(f64, f64)> = (curve.iter())
            .map(|point| (point.lean, point.count.fraction()))
            .collect();
        let errors = curve.iter().map(|point| {
            let ([low, high], middle) = (point.count.interval(), point.count.fraction());
            (middle - low, high - middle)
        });
        plots.push(line(places.clone(), colour, throw.name));
        let dots = ScatterPlot::new()
            .with_data(places)
            .with_y_err_asymmetric(errors.collect::<Vec<_>>())
            .with_color(colour)
            .with_size(4.0);
        plots.push(Plot::Scatter(dots));
    }
    Picture::new("lean", plots, |layout| {
        layout
            .with_title("The side that points up at the start comes up")
            .with_x_label("lean from upright at the start, degrees")
            .with_y_label("fraction of the decided tosses")
            .with_legend_position(LegendPosition::OutsideRightTop)
    })
}

fn caught_picture(catches: &Catches) -> Outcome<Picture> {
    let mut plots = Vec::new();
    for ((catch, tilt), colour) in catches.iter().zip(caught::TILTS).zip(COLOURS) {
        let name = tilt.map_or("χ = ψ".to_owned(), |chi| format!("χ = {chi}°"));
        let curve = (160..=360).map(|step| {
            let psi = 0.25 * f64::from(step);
            (psi, caught::formula(psi, tilt.unwrap_or(psi)))
        });
        plots.push(line(curve.collect(), colour, &name));
        let places = (catch.iter()).map(|(psi, _, count)| (*psi, count.fraction()));
        let dots = ScatterPlot::new()
            .with_data(places.collect::<Vec<_>>())
            .with_color(colour)
            .with_size(4.0);
        plots.push(Plot::Scatter(dots));
    }
    Picture::new("caught", plots, |layout| {
        layout
            .with_title("Tossed and caught: the same side comes up (lines: formula)")
            .with_x_label("angle ψ between normal and angular momentum, degrees")
            .with_y_label("fraction of the tosses")
            .with_legend_position(LegendPosition::InsideTopRight)
    })
}
