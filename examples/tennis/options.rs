//! The command line.

use std::error::Error;
use std::ffi::OsString;
use std::fmt;
use std::path::PathBuf;

use common::{Options, within};
use lexopt::prelude::*;

use crate::model::{self, Air, Court};

/// The text of `--help`.
pub(crate) const HELP: &str = "\
Serves a tennis ball and hits it from the baseline: with topspin, flat and with slice. Follows each
shot through the air, the bounce and the second arc, and again without air. Compares each bounce
with the rigid ball that slides or grips, and courts, the drop test and trajectories with printed
figures.

Usage: cargo run --release --example tennis -- [OPTIONS]

  -c, --court <COURT>          hard, clay or grass                    [default: hard]
      --friction <NUMBER>      coefficient of friction of the court   [default: the court's]
      --restitution <NUMBER>   of the vertical speed                  [default: the court's]
  -o, --out <FOLDER>           where the page, its pictures and the tables go   [default: out]
  -q, --quick                  a time step twice as long
  -h, --help                   this text

Courts: hard   friction 0.63, restitution 0.81 (medium pace, ITF)
        clay   friction 0.80, restitution 0.90 (Cross 2003)
        grass  friction 0.53, restitution 0.75 (Cross 2010)
";

/// Arguments of the command line.
pub(crate) struct Arguments {
    pub(crate) court: Court,
    pub(crate) options: Options,
}

/// Returns the arguments, or `None` if the help text is requested.
///
/// A friction or a restitution that the library rejects is an invalid argument.
pub(crate) fn parse() -> Result<Option<Arguments>, Box<dyn Error>> {
    let mut options = Options {
        out: PathBuf::from("out"),
        quick: false,
    };
    let (mut court, mut friction, mut restitution) = (Court::HARD, None, None);
    let given: Vec<OsString> = std::env::args_os().skip(1).collect();
    let mut parser = lexopt::Parser::from_args(given);
    while let Some(argument) = parser.next()? {
        match argument {
            Short('c') | Long("court") => court = Court::named(&parser.value()?.string()?)?,
            Long("friction") => {
                let value = number("friction", parser.value()?)?;
                friction = Some(within("--friction", value, 0.0..=10.0, "")?);
            }
            Long("restitution") => restitution = Some(number("restitution", parser.value()?)?),
            Short('o') | Long("out") => options.out = parser.value()?.into(),
            Short('q') | Long("quick") => options.quick = true,
            Short('h') | Long("help") => return Ok(None),
            other => return Err(other.unexpected().into()),
        }
    }
    court.friction = friction.unwrap_or(court.friction);
    court.restitution = restitution.unwrap_or(court.restitution);
    model::stepper(&court, &Air::none(), 1e-4)?;
    Ok(Some(Arguments { court, options }))
}

/// A value that is not a number.
#[derive(Debug)]
struct NotANumber {
    quantity: &'static str,
    value: OsString,
}

impl fmt::Display for NotANumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { quantity, value } = self;
        write!(
            f,
            "{quantity} must be a number, got {}",
            value.to_string_lossy()
        )
    }
}

impl Error for NotANumber {}

fn number(quantity: &'static str, value: OsString) -> Result<f64, NotANumber> {
    let read = value.to_str().and_then(|text| text.parse().ok());
    read.ok_or(NotANumber { quantity, value })
}
