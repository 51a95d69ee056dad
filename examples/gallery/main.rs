//! All examples on one page: runs each of them, and writes a page with a card and a thumbnail for
//! each.
//!
//! Run `cargo run --release --example gallery -- --help`.

// A program has the standard library. These lints are meant for the library.
#![allow(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

mod card;
mod exhibits;
mod run;
mod written;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use common::{Outcome, cannot, make_folder, program, say, write_file};
use indicatif::{ProgressBar, ProgressStyle};
use lexopt::prelude::*;
use rayon::prelude::*;

use exhibits::Exhibit;
use run::Shown;

const HELP: &str = "\
Builds and runs all examples, and writes one page that shows them side by side. The films move. Each
card opens the page of an example. Takes about a minute after the examples are built.

Usage: cargo run --release --example gallery -- [OPTIONS]

      --write          writes the checked figures into the guide
  -o, --out <FOLDER>   folder of the pages     [default: out/gallery]
  -h, --help           this text
";

const TEMPLATE: &str = include_str!("gallery.html");
/// Placeholder of the cards in the template.
const PLACE: &str = "<!--CARDS-->";

struct Arguments {
    folder: PathBuf,
    is_written: bool,
}

fn main() -> ExitCode {
    program(parse(), HELP, work)
}

/// Returns the arguments, or `None` if the help text is requested.
fn parse() -> Result<Option<Arguments>, lexopt::Error> {
    let mut arguments = Arguments {
        folder: PathBuf::from("out/gallery"),
        is_written: false,
    };
    let mut parser = lexopt::Parser::from_env();
    while let Some(argument) = parser.next()? {
        match argument {
            Long("write") => arguments.is_written = true,
            Short('o') | Long("out") => arguments.folder = parser.value()?.into(),
            Short('h') | Long("help") => return Ok(None),
            other => return Err(other.unexpected()),
        }
    }
    Ok(Some(arguments))
}

/// Writes the gallery. Returns true if all examples found their figures as expected.
fn work(arguments: &Arguments) -> Outcome<bool> {
    let folder = &arguments.folder;
    make_folder(folder)?;
    let exhibits = exhibits::all();
    let programs = run::build(&exhibits)?;
    let begin = Instant::now();
    let shown = run_all(exhibits, &programs, folder)?;
    let cards: String = shown.iter().map(card::html).collect();
    let page = folder.join("index.html");
    write_file(&page, TEMPLATE.replace(PLACE, &cards))?;
    if arguments.is_written {
        written::write(&shown)?;
    }
    for failed in shown.iter().filter(|shown| !shown.is_as_expected()) {
        let _ = writeln!(io::stderr(), "{}: {}", failed.exhibit.name, failed.result());
    }
    say(format_args!(
        "{} examples in {:.0} s, {:.1} MB\nWritten: {}\n",
        shown.len(),
        begin.elapsed().as_secs_f64(),
        size(folder).map_err(cannot("read", folder))? as f64 * 1e-6,
        page.display()
    ));
    Ok(shown.iter().all(Shown::is_as_expected))
}

/// Runs all examples: first those that measure times, one by one, then as many at a time as there
/// are processors. Returns them in the order of their cards.
fn run_all(exhibits: Vec<Exhibit>, programs: &Path, folder: &Path) -> Outcome<Vec<Shown>> {
    let style = ProgressStyle::with_template("{pos} of {len} examples {wide_bar} {elapsed} {msg}")?;
    let bar = ProgressBar::new(exhibits.len() as u64).with_style(style);
    bar.enable_steady_tick(core::time::Duration::from_millis(200));
    let run = |(card, exhibit): (usize, Exhibit)| {
        bar.set_message(exhibit.name);
        let shown = run::run(exhibit, programs, folder);
        bar.inc(1);
        (card, shown)
    };
    let (timed, others): (Vec<_>, Vec<_>) =
        (exhibits.into_iter().enumerate()).partition(|(_, exhibit)| exhibit.measures_times);
    let mut shown: Vec<_> = timed.into_iter().map(run).collect();
    shown.par_extend(others.into_par_iter().with_max_len(1).map(run));
    shown.sort_by_key(|&(card, _)| card);
    bar.finish_and_clear();
    Ok(shown.into_iter().map(|(_, shown)| shown).collect())
}

/// Size of all files in a folder, bytes.
fn size(folder: &Path) -> std::io::Result<u64> {
    let mut sum = 0;
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        sum += match entry.file_type()?.is_dir() {
            true => size(&entry.path())?,
            false => entry.metadata()?.len(),
        };
    }
    Ok(sum)
}
