//! Error against cost of every integrator on a chosen scene, and the cheapest setting for a given
//! error.
//!
//! Run `cargo run --release --example choose_accuracy -- --help`. For a scene of your own body,
//! ground and friction, call `tumble::work_precision::measure`, as the function `measure` of this
//! example does.

// The numbers of the scenes are small.
#![allow(clippy::cast_precision_loss, clippy::cast_possible_truncation)]

mod picture;
mod scenes;

use core::error::Error;
use core::fmt::Debug;
use core::ops::RangeInclusive;
use core::str::FromStr;
use std::path::PathBuf;
use std::process::ExitCode;

use common::{Outcome, Page, Picture, make_folder, program, say, table, within};
use lexopt::prelude::*;
use scenes::{Friction, Start};
use tumble::work_precision::{Setting, WorkPrecision};

const HELP: &str = "\
Error against cost of every integrator, and the cheapest setting for an error.

Usage: cargo run --release --example choose_accuracy -- [OPTIONS]

  --scene NAME        trial1 to trial8, toss, smooth, stiff, rest   [trial1]
  --error M           largest acceptable error at the end, m        [1e-4]
  --seconds S         duration of the run, s                        [the scene's]
  --points N          number of points of the coin                  [120]
  --stiffness N/M     stiffness of each of 120 points               [the scene's]
  --slip-speed M/S    slip speed of the friction law                [1e-3]
  --smooth            SmoothCoulomb in place of Coulomb
  --single            in single precision
  --flight            flight in closed form
  --quick             fewer settings
  --out DIR           folder of the page and its picture            [out]
  --help              this text
";

/// Name of the example and of its folder.
const NAME: &str = "choose_accuracy";

struct Options {
    start: Start,
    error: f64,
    single: bool,
    flight: bool,
    quick: bool,
    out: PathBuf,
}

fn main() -> ExitCode {
    program(options(), HELP, work)
}

fn work(options: &Options) -> Outcome<bool> {
    let page_options = common::Options {
        out: options.out.clone(),
        quick: options.quick,
    };
    make_folder(&page_options.out.join(NAME))?;
    let curve = measure(options)?;
    say(format_args!("{curve}\n"));
    page(&curve, options)?.write(NAME, &page_options)
}

fn page(curve: &WorkPrecision, options: &Options) -> Outcome<Page> {
    let start = &options.start;
    let scene = format!(
        "{}, {} s, {} points",
        start.name, start.seconds, start.points
    );
    let title = format!("{}: error after {} s over cost", start.name, start.seconds);
    Ok(Page {
        title: "Error and cost of every integrator",
        text: vec![
            format!(
                "Scene: {scene}. The reference is accurate to {:.0e} m.",
                curve.resolution
            ),
            cheapest(curve, options.error),
            "The table lists the settings for which no other setting has both a smaller error and \
             a lower cost."
                .to_owned(),
            front(curve),
        ],
        checks: Vec::new(),
        pictures: vec![Picture::new(
            "work_precision",
            picture::plots(curve),
            |layout| picture::arranged(layout, &title),
        )?],
        film: None,
    })
}

fn cheapest(curve: &WorkPrecision, error: f64) -> String {
    // An error below the resolution says nothing, so neither does the cheapest setting for it.
    let resolution = curve.resolution;
    if resolution.is_nan() || resolution > error {
        return format!(
            "The reference is not good enough for an error of at most {error:.0e} m: it is \
             accurate to {resolution:.0e} m. No setting can be named."
        );
    }
    match curve.cheapest(error) {
        Some(row) => format!(
            "Lowest cost for an error of at most {error:.0e} m: {}, with {:.1e} m in {:.1} µs.",
            row.setting,
            row.error,
            row.time.as_secs_f64() * 1e6
        ),
        None => format!("No setting has an error of at most {error:.0e} m."),
    }
}

/// Table of the Pareto front.
fn front(curve: &WorkPrecision) -> String {
    let mut rows = vec![table::cells(["setting", "error, m", "cost, µs"])];
    for row in curve.pareto_front() {
        rows.push(table::cells([
            row.setting.to_string(),
            format!("{:.1e}", row.error),
            format!("{:.1}", row.time.as_secs_f64() * 1e6),
        ]));
    }
    table::text(&rows)
}

fn measure(options: &Options) -> Outcome<WorkPrecision> {
    let mut settings = Setting::built_in();
    for setting in &mut settings {
        setting.flight = options.flight;
    }
    if options.quick {
        settings.retain(|setting| {
            setting.parameter
                >= if setting.method.has_tolerance() {
                    1e-6
                } else {
                    1e-3
                }
        });
    }
    options.start.curve(&settings, options.single)
}

/// Changes of the scene by options.
#[derive(Default)]
struct Changes {
    seconds: Option<f64>,
    points: Option<usize>,
    stiffness: Option<f64>,
    slip_speed: Option<f64>,
    smooth: bool,
}

impl Changes {
    fn apply(&self, start: &mut Start) -> Result<(), String> {
        if let (Friction::None, Some(option)) = (start.friction, self.of_friction()) {
            return Err(format!(
                "{option} must be left out for {}, which has no friction",
                start.name
            ));
        }
        start.seconds = self.seconds.unwrap_or(start.seconds);
        start.points = self.points.unwrap_or(start.points);
        start.stiffness = self.stiffness.unwrap_or(start.stiffness);
        if let Friction::Coulomb {
            coefficient,
            slip_speed,
        } = start.friction
        {
            let slip_speed = self.slip_speed.unwrap_or(slip_speed);
            start.friction = match self.smooth {
                true => Friction::Smooth {
                    coefficient,
                    slip_speed,
                },
                false => Friction::Coulomb {
                    coefficient,
                    slip_speed,
                },
            };
        }
        Ok(())
    }

    /// Option that was given and changes the friction law only.
    fn of_friction(&self) -> Option<&'static str> {
        let slip_speed = self.slip_speed.map(|_| "--slip-speed");
        slip_speed.or(self.smooth.then_some("--smooth"))
    }
}

/// Parses the value of an option, which is within bounds.
fn number<T>(
    name: &str,
    bounds: RangeInclusive<T>,
    unit: &str,
    parser: &mut lexopt::Parser,
) -> Outcome<T>
where
    T: FromStr<Err: Error + Send + Sync + 'static> + PartialOrd + Copy + Debug,
{
    Ok(within(name, parser.value()?.parse()?, bounds, unit)?)
}

/// Returns the options, or `None` if the help text is requested.
fn options() -> Outcome<Option<Options>> {
    let mut options = Options {
        start: Start::named("trial1").ok_or("trial1 is a scene")?,
        error: 1e-4,
        single: false,
        flight: false,
        quick: false,
        out: "out".into(),
    };
    let mut changes = Changes::default();
    let mut parser = lexopt::Parser::from_env();
    while let Some(argument) = parser.next()? {
        match argument {
            Long("scene") => {
                let name = parser.value()?.string()?;
                options.start = Start::named(&name).ok_or(format!("there is no scene {name}"))?;
            }
            Long("error") => options.error = number("--error", 1e-15..=1e3, " m", &mut parser)?,
            Long("seconds") => {
                changes.seconds = Some(number("--seconds", 1e-3..=1e3, " s", &mut parser)?);
            }
            Long("points") => {
                changes.points = Some(number("--points", 3..=10_000, "", &mut parser)?);
            }
            Long("stiffness") => {
                let stiffness = number("--stiffness", 1.0..=1e9, " N/m", &mut parser)?;
                changes.stiffness = Some(stiffness);
            }
            Long("slip-speed") => {
                let speed = number("--slip-speed", 1e-9..=1e3, " m/s", &mut parser)?;
                changes.slip_speed = Some(speed);
            }
            Long("smooth") => changes.smooth = true,
            Long("single") => options.single = true,
            Long("flight") => options.flight = true,
            Long("quick") => options.quick = true,
            Long("out") => options.out = parser.value()?.into(),
            Short('h') | Long("help") => return Ok(None),
            _ => return Err(argument.unexpected().into()),
        }
    }
    changes.apply(&mut options.start)?;
    Ok(Some(options))
}
