//! Tosses of a real cube: fits ground and body on half of them, and compares the predictions of the
//! other half with the measurement.
//!
//! Run `cargo run --release --example measured_tosses -- --data FILE`. The guide's page `measured`
//! has the protocol and the figures. The data are not part of the project. A run without them
//! prints where to obtain them.

// An example has the standard library.
#![allow(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

mod fit;
mod flights;
mod model;
mod slides;
mod statistics;
mod study;
mod synthetic;
mod tosses;

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use common::{
    BLUE, Check, ORANGE, Options, Outcome, Page, Picture, line, make_folder, marked, not_both,
    program, say,
};
use fit::{Free, fit};
use flights::Weighed;
use indicatif::ProgressBar;
use kuva::prelude::*;
use model::{Model, Parameters, Score, Start, WIDTH, scores};
use study::{Fitted, Halves};
use tosses::{RATE, Toss};
use tumble::glam::DVec3;

/// Name of the example and of its folder.
const NAME: &str = "measured_tosses";
const MARKS: [&str; 2] = [
    "<!-- measured: begin; written by `measured_tosses -- --data FILE --write` -->",
    "<!-- measured: end -->",
];

const HELP: &str = "\
Fits three models of a real cube and its table on half of its tosses, and predicts the other half:
the printed body with Coulomb friction, the body with the centre of mass from its flights, and that
body with a friction that decreases with the load. Each toss is predicted from its first sample
alone, and from up to 15 samples before the first touch-down.

Usage: cargo run --release --example measured_tosses -- --data <FILE> [OPTIONS]

  -d, --data <FILE>     the tosses, CSV or CSV in gzip; see below
      --seed <NUMBER>   seed of the split into halves and of the bootstrap      [default: 1]
      --synthetic       synthetic tosses with noise, to test the fit
      --write           writes the figures into the guide's page `measured`
  -o, --out <FOLDER>    folder of the page and its pictures                     [default: out]
  -q, --quick           a short fit; that of --synthetic is always short
  -h, --help            this text
";

const DATA: &str = "\
The data are not part of this project. They are the tosses of a cube of Pfrommer, Halm & Posa,
\"ContactNets: Learning Discontinuous Contact Dynamics with Smooth, Implicit Representations\" (CoRL 2020):
the repository DAIRLab/contact-nets, BSD 3-clause. Write them in SI units as a table with the columns
  toss,sample,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz
(148 samples a second; centre, m, z up, table at 0; unit quaternion, body to world; velocity, m/s; angular
velocity, rad/s, body axes), and give it with --data FILE.";

/// Options of the command line.
struct Arguments {
    data: Option<PathBuf>,
    seed: u64,
    synthetic: bool,
    is_written: bool,
    options: Options,
}

fn main() -> ExitCode {
    program(parse(), &format!("{HELP}\n{DATA}\n"), work)
}

fn work(arguments: &Arguments) -> Outcome<bool> {
    let tosses = match (&arguments.data, arguments.synthetic) {
        (_, true) => None,
        (Some(file), _) => Some(tosses::read(file)?),
        (None, _) => {
            let missing = "no data: give them with --data FILE, or try --synthetic";
            return Err(format!("{missing}.\n{DATA}").into());
        }
    };
    make_folder(&arguments.options.out.join(NAME))?;
    let page = match tosses {
        Some(tosses) => measured(tosses, arguments),
        None => recover(arguments),
    };
    page?.write(NAME, &arguments.options)
}

fn parse() -> Result<Option<Arguments>, lexopt::Error> {
    use lexopt::prelude::*;
    let mut arguments = Arguments {
        data: None,
        seed: 1,
        synthetic: false,
        is_written: false,
        options: Options {
            out: PathBuf::from("out"),
            quick: false,
        },
    };
    let given: Vec<OsString> = std::env::args_os().skip(1).collect();
    let mut parser = lexopt::Parser::from_args(given);
    while let Some(argument) = parser.next()? {
        match argument {
            Short('d') | Long("data") => arguments.data = Some(parser.value()?.into()),
            Long("seed") => arguments.seed = parser.value()?.parse()?,
            Long("synthetic") => arguments.synthetic = true,
            Long("write") => arguments.is_written = true,
            Short('o') | Long("out") => arguments.options.out = parser.value()?.into(),
            Short('q') | Long("quick") => arguments.options.quick = true,
            Short('h') | Long("help") => return Ok(None),
            other => return Err(other.unexpected()),
        }
    }
    let synthetic = ("--synthetic", arguments.synthetic);
    let write = ("--write", arguments.is_written);
    not_both([("--data", arguments.data.is_some()), synthetic])?;
    // The guide has the figures of the whole fit of the data.
    not_both([synthetic, write])?;
    not_both([("--quick", arguments.options.quick), write])?;
    Ok(Some(arguments))
}

/// Fits on half of the motions and predicts the others.
fn measured(tosses: Vec<Toss>, arguments: &Arguments) -> Outcome<Page> {
    let seed = arguments.seed;
    let halves = Halves::of(tosses, seed)?;
    let weighed = flights::weigh(&halves.fitted, seed)?;
    let (slides, coefficient) = study::coefficient_of_slides(&halves.held, weighed.scale, seed)?;
    let models = study::models(&halves, &weighed, arguments.options.quick)?;
    let [_, coulomb, weakening] = &models;
    let tables = study::tables(&models, seed);
    say(format_args!("{tables}\n"));
    let change = study::change_by_half_the_step(weakening, &halves.held)?;
    let count = |motions: &[Vec<Toss>]| motions.iter().flatten().count();
    let text = vec![
        format!(
            "Fitted on {} tosses, {} motions; held out: {} tosses, {} motions. Left out: {:?}, \
             whose spin changes in flight by more than {:.2} rad/s.",
            count(&halves.fitted),
            halves.fitted.len(),
            count(&halves.held),
            halves.held.len(),
            halves.left_out,
            halves.limit,
        ),
        study::shown(&weighed),
        format!(
            "{slides} held-out slides on a face have the coefficient {}. The fits have {:.3} there \
             with Coulomb's law, and {:.3} with the load-dependent one.",
            coefficient.shown(3),
            coulomb.parameters.coefficient_on_a_face(),
            weakening.parameters.coefficient_on_a_face(),
        ),
        format!(
            "Half the step changes the held-out means of the last model by {:.2} % of the width, \
             {:.2} degrees and {:.1} % of the faces at most.",
            change.x, change.y, change.z
        ),
    ];
    if arguments.is_written {
        store(&tables, &text)?;
    }
    Ok(Page {
        title: "Measured tosses of a cube, predicted",
        text,
        checks: checks(&models, seed),
        pictures: pictures_of(weakening, &halves.held)?,
        film: None,
    })
}

/// Writes tables and paragraphs into the page of the guide.
fn store(tables: &str, text: &[String]) -> Outcome<()> {
    let paragraphs: Vec<String> = text.iter().map(|text| marked::wrapped(text)).collect();
    let figures = format!("{tables}\n{}\n", paragraphs.join("\n\n"));
    marked::write("src/guide/measured.md", MARKS, &figures)
}

/// Checks that the weighed body predicts the same tosses better than the printed one.
fn checks(models: &[Fitted; 3], seed: u64) -> Vec<Check> {
    let [printed, weighed, _] = models;
    let mut checks = Vec::new();
    for (number, (_, start)) in study::STARTS.iter().enumerate() {
        for (what, part, _) in &study::PARTS[..2] {
            let scores = [&weighed.held[number][..], &printed.held[number][..]];
            let difference = study::difference(scores, *part, seed);
            checks.push(Check::between(
                &format!("{what}, weighed less printed body, start: {start}"),
                "upper end of the interval of 95 %, the same held-out tosses",
                difference.high,
                f64::NEG_INFINITY,
                0.0,
            ));
        }
    }
    checks
}

/// Pictures of the predictions of held-out tosses from their flights.
fn pictures_of(fitted: &Fitted, held: &[Vec<Toss>]) -> Outcome<Vec<Picture>> {
    let tosses: Vec<&Toss> = held.iter().flatten().collect();
    let scores: Vec<&Score> = fitted.held[1].iter().flatten().collect();
    Ok(vec![
        one_toss(&fitted.model, Start::Flight, &tosses, &scores)?,
        errors(
            &scores,
            &format!(
                "Errors of {} tosses that were not fitted (60 and more in the last bin)",
                scores.len()
            ),
            60.0,
        )?,
    ])
}

/// Height and path along the table of the toss with median errors, predicted and measured.
fn one_toss(model: &Model, start: Start, tosses: &[&Toss], scores: &[&Score]) -> Outcome<Picture> {
    let mut ranked: Vec<(&&Toss, &&Score)> = tosses.iter().zip(scores).collect();
    ranked.sort_by(|a, b| (a.1.position + a.1.rotation).total_cmp(&(b.1.position + b.1.rotation)));
    let (toss, score) = ranked.get(ranked.len() / 2).ok_or("there is no toss")?;
    let states = (model.predict(toss, start)).ok_or("a step of the model failed")?;
    let scale = model.scale();
    let first = toss.samples[0].position * scale;
    let course = |of: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
        (0..states.len())
            .map(|k| (k as f64 / RATE, 1e3 * of(k)))
            .collect()
    };
    let way = |place: DVec3| (place - first).with_z(0.0).length();
    let predicted = |name: &str, of: &dyn Fn(usize) -> f64| line(course(of), BLUE, name);
    let seen = |name: &str, of: &dyn Fn(usize) -> f64| dots(course(of), name);
    Picture::new(
        "toss",
        vec![
            predicted("predicted", &|k| states[k].position.z),
            predicted("", &|k| way(states[k].position)),
            seen("samples of the toss", &|k| {
                toss.samples[k].position.z * scale
            }),
            seen("", &|k| way(toss.samples[k].position * scale)),
        ],
        |layout| {
            layout
                .with_title(format!(
                    "Toss {}: height of the centre, and path along the table",
                    toss.number
                ))
                .with_subtitle(format!(
                    "mean errors: {:.2} % of the width, {:.2} degrees",
                    score.position, score.rotation
                ))
                .with_x_label("time (s)")
                .with_y_label("mm")
                .with_legend_position(LegendPosition::OutsideRightTop)
        },
    )
}

fn dots(places: Vec<(f64, f64)>, name: &str) -> Plot {
    let dots = ScatterPlot::new()
        .with_data(places)
        .with_color(ORANGE)
        .with_size(3.0);
    Plot::Scatter(if name.is_empty() {
        dots
    } else {
        dots.with_legend(name)
    })
}

/// Distribution of the errors, up to a limit.
fn errors(scores: &[&Score], title: &str, limit: f64) -> Outcome<Picture> {
    let histogram = |of: fn(&Score) -> f64, colour: &str, name: &str| {
        let values: Vec<f64> = scores.iter().map(|score| of(score).min(limit)).collect();
        Plot::Histogram(
            Histogram::new()
                .with_data(values)
                .with_range((0.0, limit))
                .with_bins(30)
                .with_step(true)
                .with_color(colour)
                .with_legend(name),
        )
    };
    Picture::new(
        "errors",
        vec![
            histogram(|score| score.position, BLUE, "position, % of the width"),
            histogram(|score| score.rotation, ORANGE, "rotation, degrees"),
        ],
        |layout| {
            layout
                .with_title(title)
                .with_x_label("mean error over a toss")
                .with_y_label("tosses")
        },
    )
}

/// Checks that a fit finds the parameters with which its tosses were made.
fn recover(arguments: &Arguments) -> Outcome<Page> {
    use synthetic::{GUESS, TRUTH};
    let tosses = synthetic::tosses(64, arguments.seed)?;
    let motions: Vec<Vec<Toss>> = tosses.iter().map(|toss| vec![toss.clone()]).collect();
    let weighed_by = flights::weigh(&motions, arguments.seed)?;
    // A few tosses are enough for the parameters of the ground.
    let tosses = &tosses[..16];
    let guess = Parameters {
        body: TRUTH.body,
        ..GUESS
    };
    let bar = ProgressBar::hidden();
    let free = (Free::Ground, Start::FirstSample);
    let mut found = fit(tosses, guess, free, model::STEPS_OF_SYNTHETIC, 80, &bar)?;
    found = fit(tosses, found, free, model::STEPS_OF_SYNTHETIC, 80, &bar)?;
    let model = Model::new(&found, model::STEPS_OF_SYNTHETIC)?;
    let of_each = scores(&model, tosses, Start::FirstSample);
    let score = Score::mean(of_each.iter());
    let (tosses, of_each): (Vec<_>, Vec<_>) = tosses.iter().zip(&of_each).unzip();
    Ok(Page {
        title: "Synthetic tosses with noise: the fit finds their parameters",
        text: vec![
            "The tosses are made by the model itself, with the noise of a tracker. So they test \
             the fit, not the model."
                .to_owned(),
            study::shown(&weighed_by),
            format!(
                "{:.2} % of the width of {} m, {:.2} degrees are left of noise.",
                score.position, WIDTH, score.rotation
            ),
        ],
        checks: checks_of_recovery(&found, &weighed_by),
        pictures: vec![one_toss(&model, Start::FirstSample, &tosses, &of_each)?],
        film: None,
    })
}

/// Compares the parameters that were found with those of the tosses.
fn checks_of_recovery(found: &Parameters, weighed_by: &Weighed) -> Vec<Check> {
    use synthetic::TRUTH;
    let near = |what: &str, got: f64, truth: f64| {
        Check::near(
            what,
            "parameters of the tosses, to a tenth",
            got,
            truth,
            0.1 * truth,
        )
    };
    let load = |parameters: &Parameters| parameters.transition_load.unwrap_or(f64::INFINITY);
    vec![
        Check::near(
            "height of the centre of mass over the middle, mm",
            "parameters of the tosses, to four standard errors",
            1e3 * weighed_by.centre_of_mass.z,
            1e3 * TRUTH.body.centre_of_mass.z,
            4e3 * weighed_by.centre_error.z,
        ),
        Check::near(
            "true lengths over tracked ones",
            "parameters of the tosses, to four standard errors",
            weighed_by.scale,
            TRUTH.body.scale,
            4.0 * weighed_by.scale_error,
        ),
        near("stiffness, N/m", found.stiffness, TRUTH.stiffness),
        near("damping, N s/m", found.damping, TRUTH.damping),
        near("friction", found.coefficient, TRUTH.coefficient),
        near("transition load, N", load(found), load(&TRUTH)),
        near(
            "coefficient on a face",
            found.coefficient_on_a_face(),
            TRUTH.coefficient_on_a_face(),
        ),
        near("slip speed, m/s", found.slip_speed, TRUTH.slip_speed),
    ]
}
