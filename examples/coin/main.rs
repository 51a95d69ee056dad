//! The coin of the coin report: runs, summarises, draws and animates it:
//! `cargo run --release --example coin -- --help`.

// A program has the standard library. These lints are meant for the library.
#![allow(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

use std::error::Error;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use common::{cannot, make_folder};
use indicatif::{ProgressBar, ProgressStyle};

use options::{HELP, Options, Task, UsageError};
use recording::Recording;
use setup::Setup;
use summary::Summary;

mod curve;
mod milestones;
mod options;
mod overview;
mod page;
mod pictures;
mod poster;
mod recorder;
mod recording;
mod report;
#[path = "../../tests/common/report_loop.rs"]
mod report_loop;
mod run;
mod setup;
mod summary;
mod table;
mod tally;

/// Number of trials in the coin report.
const TRIALS: usize = 8;

fn main() -> ExitCode {
    match perform() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => complain(&*error),
    }
}

/// Prints an error. Returns 2 if the command line is invalid, and 1 for any other error.
fn complain(error: &(dyn Error + 'static)) -> ExitCode {
    // If the error cannot be printed, the exit code alone states it.
    let _ = writeln!(io::stderr(), "error: {error}");
    if error.is::<UsageError>() {
        let _ = writeln!(io::stderr(), "The options are listed by --help.");
        return ExitCode::from(2);
    }
    ExitCode::FAILURE
}

fn perform() -> Result<(), Box<dyn Error>> {
    let options = Options::parse(std::env::args_os().skip(1))?;
    match &options.task {
        Task::Help => io::stdout().write_all(HELP.as_bytes())?,
        Task::OneTrial => one_trial(&options)?,
        Task::AllTrials => all_trials(&options)?,
        Task::ReadmePicture(file) => readme_picture(&options, file)?,
    }
    Ok(())
}

fn one_trial(options: &Options) -> Result<(), Box<dyn Error>> {
    let setup = options.overrides.apply(options.number)?;
    make_folder(&options.out)?;
    let recording = run_and_tell(setup, options.quiet)?;
    write(&recording, &options.out, FULL)?;
    tell_where(options, &options.out.join("coin.html"))?;
    Ok(())
}

fn all_trials(options: &Options) -> Result<(), Box<dyn Error>> {
    let mut cards = Vec::new();
    for number in 1..=TRIALS {
        let setup = options.overrides.apply(number)?;
        let folder = options.out.join(overview::folder(&setup));
        make_folder(&folder)?;
        let recording = run_and_tell(setup, options.quiet)?;
        write(&recording, &folder, BRIEF)?;
        cards.push(overview::card(&recording));
    }
    let page = options.out.join("overview.html");
    overview::write(&cards, &page)?;
    tell_where(options, &page)?;
    Ok(())
}

fn readme_picture(options: &Options, file: &Path) -> Result<(), Box<dyn Error>> {
    let setup = options.overrides.apply(options.number)?;
    let recording = run_and_tell(setup, options.quiet)?;
    poster::write(&recording, file)
}

fn run_and_tell(setup: Setup, quiet: bool) -> Result<Recording, Box<dyn Error>> {
    let bar = progress_bar(&setup, quiet)?;
    let recording = run::run(setup, &bar)?;
    bar.finish_and_clear();
    if !quiet {
        writeln!(io::stdout(), "{}", Summary(&recording))?;
    }
    Ok(recording)
}

/// Progress bar, which is visible only on a terminal.
fn progress_bar(setup: &Setup, quiet: bool) -> Result<ProgressBar, Box<dyn Error>> {
    if quiet {
        return Ok(ProgressBar::hidden());
    }
    let style = ProgressStyle::with_template("{msg} {wide_bar} {percent} %, {eta} left")?;
    Ok(ProgressBar::new(0)
        .with_style(style)
        .with_message(setup.title()))
}

/// How much is written of a run.
#[derive(Clone, Copy, Debug)]
struct Detail {
    /// Number of moments for each row of the table.
    every: usize,
    /// True for pictures as PNG, besides SVG.
    with_png: bool,
}

const FULL: Detail = Detail {
    every: 1,
    with_png: true,
};
/// The files of eight trials are small enough to be sent to somebody.
const BRIEF: Detail = Detail {
    every: 20,
    with_png: false,
};

/// Writes table, page and pictures into an existing folder.
fn write(recording: &Recording, folder: &Path, detail: Detail) -> Result<(), Box<dyn Error>> {
    let table = folder.join("coin.csv");
    table::write(recording, &table, detail.every).map_err(cannot("write", &table))?;
    page::write(recording, &folder.join("coin.html"))?;
    pictures::write(recording, folder, detail.with_png)
}

fn tell_where(options: &Options, page: &Path) -> io::Result<()> {
    if options.quiet {
        return Ok(());
    }
    let (folder, page) = (options.out.display(), page.display());
    writeln!(
        io::stdout(),
        "Written into {folder}. Open {page} in a browser."
    )
}
