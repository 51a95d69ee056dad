//! The command line: which trial, which parameters, how to compute, where to write.

use std::ffi::OsString;
use std::fmt;
use std::mem::discriminant;
use std::path::PathBuf;

use lexopt::prelude::*;

use tumble::{Start, Trial};

use common::not_both;

use crate::setup::{Method, Setup};

/// The text of `--help`.
pub(crate) const HELP: &str = "\
The coin of the coin report: a ring of points that rolls or spins on an elastic floor with
friction, tumbles and comes to rest. Writes a table, pictures and a page that shows it in 3-D.

Usage: cargo run --release --example coin -- [OPTIONS]

What to run
  -t, --trial <1..8>            trial of the coin report to start from        [default: 1]
  -a, --all                     all eight trials, and one page that shows them side by side;
                                with a row of the table every 0.2 s, and pictures as SVG only
      --readme-picture <FILE>   only draw the coin of the trial, as an animated SVG, into FILE

The five parameters of the coin report: each replaces the value of the trial
      --direction <DIRECTION>   of the angular momentum: rolling (along the coin's normal)
                                or spinning (along the upright diameter)
      --size <NUMBER>           of the angular momentum, in kg m2/s
      --tilt <DEGREES>          of the coin's plane away from upright
      --friction <NUMBER>       coefficient of friction
      --damping <N·s/m>         of the floor, for each point

Fixed in the coin report
  -n, --points <NUMBER>         points on the rim                             [default: 120]
      --stiffness <N/m>         of the floor, for each point                  [default: 1000]
      --slip-speed <M/S>        below this speed friction falls to 0          [default: 1e-10]

How to compute
  -i, --integrator <METHOD>     energy-momentum, report, forward-euler, symplectic-euler,
                                strang, rk4 or nystrom; the energy of energy-momentum never
                                increases, report is the unchanged loop of the coin report
                                                                   [default: energy-momentum]
  -s, --step <SECONDS>          step size                 [default: 1e-3 for energy-momentum
                                                 and nystrom, 1e-4, the report's, for others]
  -d, --duration <SECONDS>      of the run                                    [default: 160]
      --no-audit                no energy audit: several times faster

  -o, --out <FOLDER>            folder of the files                           [default: out]
  -q, --quiet                   no progress bar and no summary
  -h, --help                    this text

Trials: 1 rolling, 15 degrees, friction 0.3        5 spinning, 15 degrees, friction 0.1, size 1.5
        2 like 1, size 1.5                         6 spinning, upright, friction 0.3, size 5
        3 like 1, friction 0.8                     7 spinning, 15 degrees, friction 0.3, size 5
        4 spinning, upright, friction 0.3          8 spinning, 15 degrees, friction 0.3
";

/// Options of the command line.
#[derive(Debug)]
pub(crate) struct Options {
    pub(crate) task: Task,
    /// Number of the trial in the coin report.
    pub(crate) number: usize,
    /// True if the number is given.
    is_numbered: bool,
    pub(crate) overrides: Overrides,
    /// Output folder, created if it does not exist.
    pub(crate) out: PathBuf,
    pub(crate) quiet: bool,
}

/// Task of the program.
#[derive(Debug, PartialEq)]
pub(crate) enum Task {
    Help,
    OneTrial,
    AllTrials,
    ReadmePicture(PathBuf),
}

/// Values that replace those of a trial, in the units of [`Setup`].
#[derive(Debug, Default)]
pub(crate) struct Overrides {
    start: Option<Start>,
    size: Option<f64>,
    tilt_degrees: Option<f64>,
    friction: Option<f64>,
    damping: Option<f64>,
    points: Option<usize>,
    stiffness: Option<f64>,
    slip_speed: Option<f64>,
    method: Option<Method>,
    time_step: Option<f64>,
    duration: Option<f64>,
    no_audit: bool,
}

impl Overrides {
    /// Returns a trial of the coin report with the values of the command line.
    pub(crate) fn apply(&self, number: usize) -> Result<Setup, UsageError> {
        let trial = Trial::report(number).ok_or_else(|| no_trial(number))?;
        let setup = Setup::new(number, self.with_options(trial));
        let method = self.method.unwrap_or(setup.method);
        let time_step = self.time_step.unwrap_or(method.usual_step());
        let duration = self.duration.unwrap_or(setup.duration);
        check_steps(duration, time_step)?;
        Ok(Setup {
            points: self.points.unwrap_or(setup.points),
            stiffness: self.stiffness.unwrap_or(setup.stiffness),
            method,
            time_step,
            duration,
            audit: !self.no_audit,
            ..setup
        })
    }

    fn with_options(&self, trial: Trial) -> Trial {
        Trial {
            start: self.start.unwrap_or(trial.start),
            angular_momentum: self.size.unwrap_or(trial.angular_momentum),
            tilt: self.tilt_degrees.map_or(trial.tilt, f64::to_radians),
            coefficient: self.friction.unwrap_or(trial.coefficient),
            damping: self.damping.unwrap_or(trial.damping),
            slip_speed: self.slip_speed.unwrap_or(trial.slip_speed),
        }
    }
}

impl Options {
    /// Reads the arguments that follow the program's name.
    pub(crate) fn parse(arguments: impl IntoIterator<Item = OsString>) -> Result<Self, UsageError> {
        let mut options = Self {
            task: Task::OneTrial,
            number: 1,
            is_numbered: false,
            overrides: Overrides::default(),
            out: PathBuf::from("out"),
            quiet: false,
        };
        let mut parser = lexopt::Parser::from_args(arguments);
        while let Some(argument) = parser.next()? {
            let option = whole_name(argument)?;
            options.read(&option, &mut parser)?;
            if options.task == Task::Help {
                break;
            }
        }
        let all = ("--all", options.task == Task::AllTrials);
        not_both([("--trial", options.is_numbered), all]).map_err(UsageError)?;
        // Errors of the command line come before the work.
        options.overrides.apply(options.number)?;
        Ok(options)
    }

    fn read(&mut self, option: &str, parser: &mut lexopt::Parser) -> Result<(), UsageError> {
        match option {
            "--help" => self.task = Task::Help,
            "--all" => self.choose(Task::AllTrials)?,
            "--readme-picture" => self.choose(Task::ReadmePicture(parser.value()?.into()))?,
            "--trial" => (self.number, self.is_numbered) = (number_of_trial(parser)?, true),
            "--out" => self.out = parser.value()?.into(),
            "--quiet" => self.quiet = true,
            _ => self.overrides.read(option, parser)?,
        }
        Ok(())
    }

    fn choose(&mut self, task: Task) -> Result<(), UsageError> {
        let is_another =
            !matches!(self.task, Task::OneTrial) && discriminant(&self.task) != discriminant(&task);
        not_both([("--all", is_another), ("--readme-picture", true)]).map_err(UsageError)?;
        self.task = task;
        Ok(())
    }
}

impl Overrides {
    fn read(&mut self, option: &str, parser: &mut lexopt::Parser) -> Result<(), UsageError> {
        match option {
            "--direction" => self.start = Some(start(parser)?),
            "--size" => self.size = Some(number(parser, option, "kg m2/s")?),
            "--tilt" => self.tilt_degrees = Some(number(parser, option, "degrees")?),
            "--friction" => self.friction = Some(number(parser, option, "")?),
            "--damping" => self.damping = Some(number(parser, option, "N·s/m")?),
            "--points" => self.points = Some(points(parser)?),
            "--stiffness" => self.stiffness = Some(number(parser, option, "N/m")?),
            "--slip-speed" => self.slip_speed = Some(number(parser, option, "m/s")?),
            "--integrator" => self.method = Some(method(parser)?),
            "--step" => self.time_step = Some(seconds(parser, option)?),
            "--no-audit" => self.no_audit = true,
            "--duration" => self.duration = Some(seconds(parser, option)?),
            unknown => return Err(UsageError(format!("there is no option {unknown}"))),
        }
        Ok(())
    }
}

/// Returns the long name of an option, for example `--trial` for `-t`.
fn whole_name(argument: lexopt::Arg<'_>) -> Result<String, UsageError> {
    let long = match argument {
        Long(long) => long,
        Short('t') => "trial",
        Short('a') => "all",
        Short('n') => "points",
        Short('i') => "integrator",
        Short('s') => "step",
        Short('d') => "duration",
        Short('o') => "out",
        Short('q') => "quiet",
        Short('h') => "help",
        other => return Err(other.unexpected().into()),
    };
    Ok(format!("--{long}"))
}

/// An invalid command line, described for the user.
#[derive(Debug)]
pub(crate) struct UsageError(String);

impl UsageError {
    pub(crate) fn new(message: impl fmt::Display) -> Self {
        Self(message.to_string())
    }
}

impl fmt::Display for UsageError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl std::error::Error for UsageError {}

impl From<lexopt::Error> for UsageError {
    fn from(error: lexopt::Error) -> Self {
        Self::new(error)
    }
}

fn number_of_trial(parser: &mut lexopt::Parser) -> Result<usize, UsageError> {
    let text = text(parser)?;
    match text.parse() {
        Ok(number @ 1..=8) => Ok(number),
        _ => Err(no_trial(text)),
    }
}

fn no_trial(number: impl fmt::Display) -> UsageError {
    UsageError(format!("--trial must be 1 to 8, got '{number}'"))
}

fn start(parser: &mut lexopt::Parser) -> Result<Start, UsageError> {
    match text(parser)?.as_str() {
        "rolling" => Ok(Start::Rolling),
        "spinning" => Ok(Start::Spinning),
        other => Err(UsageError(format!(
            "--direction must be rolling or spinning, got '{other}'"
        ))),
    }
}

fn method(parser: &mut lexopt::Parser) -> Result<Method, UsageError> {
    let text = text(parser)?;
    text.parse()
        .map_err(|choices| UsageError(format!("--integrator must be {choices}, got '{text}'")))
}

/// Largest number of points. A larger number is probably a mistake, because the run would take
/// days.
const MOST_POINTS: usize = 1_000_000;

fn points(parser: &mut lexopt::Parser) -> Result<usize, UsageError> {
    let text = text(parser)?;
    match text.parse() {
        Ok(points @ 3..=MOST_POINTS) => Ok(points),
        _ => Err(UsageError(format!(
            "--points must be a whole number from 3 to {MOST_POINTS}, got '{text}'"
        ))),
    }
}

/// Parses a finite number. The library checks its physical range.
fn number(parser: &mut lexopt::Parser, option: &str, unit: &str) -> Result<f64, UsageError> {
    let text = text(parser)?;
    let space = if unit.is_empty() { "" } else { " in " };
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(UsageError(format!(
            "{option} must be a number{space}{unit}, got '{text}'"
        ))),
    }
}

/// Largest number of steps. They take hours.
const MOST_STEPS: f64 = 1e9;

fn check_steps(duration: f64, time_step: f64) -> Result<(), UsageError> {
    let steps = duration / time_step;
    if steps <= MOST_STEPS {
        return Ok(());
    }
    Err(UsageError(format!(
        "--duration must be at most {MOST_STEPS:e} of --step, got {steps:.3e}: {duration} s in steps \
         of {time_step} s"
    )))
}

fn seconds(parser: &mut lexopt::Parser, option: &str) -> Result<f64, UsageError> {
    let seconds = number(parser, option, "s")?;
    if seconds > 0.0 {
        Ok(seconds)
    } else {
        Err(UsageError(format!(
            "{option} must be above 0 s, got {seconds}"
        )))
    }
}

fn text(parser: &mut lexopt::Parser) -> Result<String, UsageError> {
    let value = parser.value()?;
    value
        .into_string()
        .map_err(|raw| UsageError(format!("not readable as text: {}", raw.to_string_lossy())))
}
