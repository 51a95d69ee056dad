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
use std::path::PathBuf;

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
  --out DIR           folder of the picture                         [out]
  --help              this text
";

struct Options {
    start: Start,
    error: f64,
    single: bool,
    flight: bool,
    quick: bool,
    out: PathBuf,
}

fn main() -> Result<(), Box<dyn Error>> {
    let Some(options) = options()? else {
        print!("{HELP}");
        return Ok(());
    };
    let curve = measure(&options)?;
    let start = &options.start;
    println!(
        "{}, {} s, {} points\n",
        start.name, start.seconds, start.points
    );
    print!("{curve}");
    println!("\nthe reference is accurate to {:.0e} m", curve.resolution);
    match curve.cheapest(options.error) {
        Some(row) => println!(
            "cheapest for {:.0e} m: {}, {:.1e} m in {:.1} µs",
            options.error,
            row.setting,
            row.error,
            row.time.as_secs_f64() * 1e6
        ),
        None => println!("no setting has an error of at most {:.0e} m", options.error),
    }
    let title = format!("{}: error after {} s over cost", start.name, start.seconds);
    picture::write(&curve, &title, &options.out, "work_precision")?;
    println!(
        "picture: {}",
        options.out.join("work_precision.svg").display()
    );
    Ok(())
}

fn measure(options: &Options) -> Result<WorkPrecision, Box<dyn Error>> {
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

/// Returns the options, or `None` if the help text is requested.
fn options() -> Result<Option<Options>, Box<dyn Error>> {
    let mut options = Options {
        start: Start::named("trial1").ok_or("trial1 is a scene")?,
        error: 1e-4,
        single: false,
        flight: false,
        quick: false,
        out: "out".into(),
    };
    let (mut seconds, mut points, mut stiffness, mut slip, mut smooth) =
        (None, None, None, None, false);
    let mut parser = lexopt::Parser::from_env();
    while let Some(argument) = parser.next()? {
        match argument {
            Long("scene") => {
                let name = parser.value()?.string()?;
                options.start = Start::named(&name).ok_or(format!("there is no scene {name}"))?;
            }
            Long("error") => options.error = parser.value()?.parse()?,
            Long("seconds") => seconds = Some(parser.value()?.parse()?),
            Long("points") => points = Some(parser.value()?.parse()?),
            Long("stiffness") => stiffness = Some(parser.value()?.parse()?),
            Long("slip-speed") => slip = Some(parser.value()?.parse()?),
            Long("smooth") => smooth = true,
            Long("single") => options.single = true,
            Long("flight") => options.flight = true,
            Long("quick") => options.quick = true,
            Long("out") => options.out = parser.value()?.into(),
            Long("help") | Short('h') => return Ok(None),
            _ => return Err(argument.unexpected().into()),
        }
    }
    let start = &mut options.start;
    start.seconds = seconds.unwrap_or(start.seconds);
    start.points = points.unwrap_or(start.points);
    start.stiffness = stiffness.unwrap_or(start.stiffness);
    if let Friction::Coulomb {
        coefficient,
        slip_speed,
    } = start.friction
    {
        let slip_speed = slip.unwrap_or(slip_speed);
        start.friction = if smooth {
            Friction::Smooth {
                coefficient,
                slip_speed,
            }
        } else {
            Friction::Coulomb {
                coefficient,
                slip_speed,
            }
        };
    }
    Ok(Some(options))
}
