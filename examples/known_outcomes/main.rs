//! Outcomes against numbers that are known without this crate: coins on edge, thick coins and dice,
//! decided states that are followed to rest, and the labels of each method.
//! `cargo run --release --example known_outcomes -- --help`.

// An example has the standard library.
#![allow(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

mod caught;
mod certificate;
mod cuboids;
mod edge;
mod means;
mod methods;
mod profile;
mod shapes;
mod shown;
mod smooth;
mod upright;

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use common::{Outcome, make_folder, marked, not_both, program, read_text, say, write_file};

const HELP: &str = "\
Counts outcomes and compares them with numbers that are known without this crate. Each fraction has
a 95 % interval of Wilson. Without a subject, all subjects are run.

Usage: cargo run --release --example known_outcomes -- [OPTIONS]

      --edge            nickels that end on their edge
      --rims            nickels with round rims
      --shapes          thick coins, two-dimensional dice and cuboids of steel
      --certify         decided states that are followed to rest, and barriers by brute force
      --methods         labels and cost of a toss by each method
      --means           what each means of a cheap toss saves
      --percent <COUNT> percentage of the tosses; all take half an hour on one core
                        [default: 5, with --write that of the tables of the guide]
  -q, --quick           a thousandth of the tosses; with --write, their tables are stored
      --check           plays a thousandth of the tosses, and fails if a table differs from the
                        stored one: then the tables of the guide are stale too
      --write           writes the tables into the guide
  -o, --out <FOLDER>    folder of the tables                              [default: out]
  -h, --help            this text
";

/// A part of the program, with its page of the guide.
#[derive(Clone, Copy, Debug)]
struct Subject {
    name: &'static str,
    page: &'static str,
    /// Percentage of the tosses in the tables of the page.
    percent: u64,
    tables: fn(Size) -> Outcome<Report>,
}

/// Tables of a subject, and whether every figure is as it must be.
#[derive(Debug)]
pub(crate) struct Report {
    pub(crate) text: String,
    pub(crate) is_as_expected: bool,
}

const SUBJECTS: [Subject; 6] = [
    Subject {
        name: "edge",
        page: "src/guide/edge.md",
        percent: 100,
        tables: edge::tables,
    },
    Subject {
        name: "rims",
        page: "src/guide/edge.md",
        percent: 50,
        tables: edge::rims,
    },
    Subject {
        name: "shapes",
        page: "src/guide/validation.md",
        percent: 10,
        tables: shapes::tables,
    },
    Subject {
        name: "certify",
        page: "src/guide/outcomes.md",
        percent: 100,
        tables: certificate::tables,
    },
    Subject {
        name: "methods",
        page: "src/guide/outcomes.md",
        percent: 100,
        tables: methods::tables,
    },
    Subject {
        name: "means",
        page: "src/guide/outcomes.md",
        percent: 30,
        tables: means::tables,
    },
];

/// Number of tosses of a thousand that are played.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size(u64);

impl Size {
    const QUICK: Self = Self(1);

    /// Number of tosses in place of `full`, at least 20.
    pub(crate) fn of(self, full: u64) -> u64 {
        (full * self.0 / 1000).max(20)
    }

    /// Repetitions of a measurement of time.
    pub(crate) fn repetitions(self) -> usize {
        if self == Self::QUICK { 1 } else { 3 }
    }

    /// A text that depends on the speed of the machine. A quick run omits it, so that its tables
    /// are the same on every machine.
    pub(crate) fn machine(self, text: String) -> String {
        if self == Self::QUICK {
            "-".to_owned()
        } else {
            text
        }
    }

    /// Number of tosses of a fit, which is the same for each percentage, and small in a quick run.
    pub(crate) fn for_fit(self, tosses: u64) -> u64 {
        if self == Self::QUICK { 20 } else { tosses }
    }
}

#[derive(Debug)]
struct Arguments {
    subjects: Vec<Subject>,
    /// `None` if no size is given.
    size: Option<Size>,
    is_written: bool,
    is_checked: bool,
    out: PathBuf,
}

fn main() -> ExitCode {
    program(parse(), HELP, work)
}

fn parse() -> Result<Option<Arguments>, lexopt::Error> {
    use lexopt::prelude::*;
    let mut arguments = Arguments {
        subjects: Vec::new(),
        size: None,
        is_written: false,
        is_checked: false,
        out: PathBuf::from("out"),
    };
    let given: Vec<OsString> = std::env::args_os().skip(1).collect();
    let (mut percentage, mut is_quick) = (None, false);
    let mut parser = lexopt::Parser::from_args(given);
    while let Some(argument) = parser.next()? {
        match argument {
            Long("percent") => {
                percentage = Some(percent(parser.value()?.parse()?)?);
            }
            Short('q') | Long("quick") => is_quick = true,
            Long("check") => arguments.is_checked = true,
            Long("write") => arguments.is_written = true,
            Short('o') | Long("out") => arguments.out = parser.value()?.into(),
            Short('h') | Long("help") => return Ok(None),
            Long(name) => match SUBJECTS.iter().find(|subject| subject.name == name) {
                Some(subject) => arguments.subjects.push(*subject),
                None => return Err(argument.unexpected()),
            },
            other => return Err(other.unexpected()),
        }
    }
    let check = ("--check", arguments.is_checked);
    // Both play a thousandth of the tosses.
    for quick in [("--quick", is_quick), check] {
        not_both([("--percent", percentage.is_some()), quick])?;
    }
    // What is written first is not another one afterwards.
    not_both([check, ("--write", arguments.is_written)])?;
    if is_quick || arguments.is_checked {
        arguments.size = Some(Size::QUICK);
    } else {
        arguments.size = percentage.map(|count| Size(10 * count));
    }
    if arguments.subjects.is_empty() {
        arguments.subjects = SUBJECTS.to_vec();
    }
    if let (true, Some(count)) = (arguments.is_written, percentage) {
        all_of_the_guide(&arguments.subjects, count)?;
    }
    Ok(Some(arguments))
}

/// Refuses to write tables of another percentage than the guide's.
fn all_of_the_guide(subjects: &[Subject], count: u64) -> Result<(), String> {
    match subjects.iter().find(|subject| subject.percent != count) {
        None => Ok(()),
        Some(Subject { name, percent, .. }) => Err(format!(
            "--percent must be {percent} for the tables of {name} in the guide, got {count}"
        )),
    }
}

fn percent(count: u64) -> Result<u64, lexopt::Error> {
    match count {
        1..=100 => Ok(count),
        _ => Err(format!("--percent must be from 1 to 100, got {count}").into()),
    }
}

/// Folder of the tables of a quick run.
const QUICK_TABLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/known_outcomes/quick");

fn work(arguments: &Arguments) -> Outcome<bool> {
    let folder = arguments.out.join("known_outcomes");
    make_folder(&folder)?;
    let mut is_as_expected = true;
    for subject in &arguments.subjects {
        let size = match arguments.size {
            None if arguments.is_written => Size(10 * subject.percent),
            size => size.unwrap_or(Size(50)),
        };
        let report = (subject.tables)(size)?;
        is_as_expected &= report.is_as_expected;
        say(format_args!("{}\n", report.text));
        let file = folder.join(format!("{}.md", subject.name));
        write_file(&file, &report.text)?;
        say(format_args!("Written: {}\n\n", file.display()));
        if arguments.is_written {
            subject.write(size, &report.text)?;
        }
        if arguments.is_checked {
            is_as_expected &= subject.is_stored(&report.text)?;
        }
    }
    Ok(is_as_expected)
}

impl Subject {
    /// Writes the tables into the guide, or those of a quick run into their own file.
    fn write(&self, size: Size, text: &str) -> Outcome<()> {
        let Self {
            name,
            page,
            percent,
            ..
        } = self;
        if size == Size::QUICK {
            return write_file(&self.quick_table(), text);
        }
        let begin = format!(
            "<!-- {name}: begin; \
             written by `known_outcomes -- --{name} --percent {percent} --write` -->"
        );
        let end = format!("<!-- {name}: end -->");
        marked::write(page, [&begin, &end], text)
    }

    /// Compares the tables of a quick run with the stored ones.
    fn is_stored(&self, text: &str) -> Outcome<bool> {
        let file = self.quick_table();
        let stored = read_text(&file)?;
        for (before, now) in stored.lines().zip(text.lines()) {
            if before != now {
                say(format_args!("stored: {before}\nnow:    {now}\n"));
            }
        }
        let is_stored = stored == text;
        let result = if is_stored { "as stored" } else { "differ" };
        say(format_args!("{}: tables {result}\n\n", file.display()));
        Ok(is_stored)
    }

    fn quick_table(&self) -> PathBuf {
        PathBuf::from(QUICK_TABLES).join(format!("{}.md", self.name))
    }
}
