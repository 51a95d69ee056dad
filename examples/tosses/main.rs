//! Tosses of a coin in parts, on any number of machines, with one answer: each part is a file, and
//! the files are merged. `cargo run --release --example tosses -- --help`.

// An example has the standard library.
#![allow(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

mod measure;
mod parts;
mod replay;
mod scene;

use std::ffi::OsString;
use std::ops::Range;
use std::path::PathBuf;
use std::process::ExitCode;

use common::{Outcome, program, within};

const HELP: &str = "\
Tosses a coin of steel until its face is decided, and counts heads, tails and edge. Each part of
the tosses is a file, written when it is complete. A toss that is in a file of the folder is not
played again: run the same command after an interruption. A file that cannot be read is renamed to
its name with .broken, and its tosses are played again. The result has the same bytes for any parts,
threads and machines.

Usage: cargo run --release --example tosses -- [OPTIONS]

      --from <TOSS>       first toss                               [default: 0]
      --to <TOSS>         end of the tosses, exclusive             [default: 1000]
      --part <COUNT>      tosses in a part                         [default: 250]
      --seed <SEED>       seed of the random numbers               [default: 1]
      --threads <COUNT>   threads                                  [default: as many as the processor]
  -o, --out <FOLDER>      where the parts and the result go        [default: out/tosses]

Tasks in place of these parts, one at a time:

      --merge             plays nothing: merges the parts that are there, and lists the gaps
      --toss <TOSS>       replays one toss: film play.html and path path.csv
      --label-error       repeats the tosses at a hundredth of the tolerance, and counts the labels
                          that change
      --efficiency        time on one thread and on all threads
      --cost              time of a toss, and of up to a million million tosses

      --write             with --cost: writes the table into the guide
  -h, --help              this text
";

/// What to do with the tosses.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Task {
    Play,
    Merge,
    Replay(u64),
    LabelError,
    Efficiency,
    Cost,
}

impl Task {
    /// Least number of tosses: a measurement needs one.
    fn least_tosses(self) -> u64 {
        match self {
            Self::Play | Self::Merge | Self::Replay(_) => 0,
            Self::LabelError | Self::Efficiency | Self::Cost => 1,
        }
    }
}

#[derive(Debug)]
pub(crate) struct Arguments {
    pub(crate) tosses: Range<u64>,
    pub(crate) part: u64,
    pub(crate) seed: u64,
    pub(crate) threads: usize,
    pub(crate) out: PathBuf,
    pub(crate) task: Task,
    pub(crate) write: bool,
}

/// Bounds of the command line: tosses of the last row of the table of costs in `guide::outcomes`,
/// files that a folder can have, and threads.
const MOST_TOSSES: u64 = 1_000_000_000_000;
const MOST_PARTS: u64 = 1_000_000;
const MOST_THREADS: usize = 1024;

fn main() -> ExitCode {
    program(parse(), HELP, |arguments| work(arguments).map(|()| true))
}

fn parse() -> Result<Option<Arguments>, lexopt::Error> {
    use lexopt::prelude::*;
    let mut arguments = Arguments {
        tosses: 0..1000,
        part: 250,
        seed: 1,
        threads: 0,
        out: PathBuf::from("out/tosses"),
        task: Task::Play,
        write: false,
    };
    let given: Vec<OsString> = std::env::args_os().skip(1).collect();
    let mut tasks: Vec<(&str, Task)> = Vec::new();
    let mut parser = lexopt::Parser::from_args(given);
    while let Some(argument) = parser.next()? {
        match argument {
            Long("from") => arguments.tosses.start = parser.value()?.parse()?,
            Long("to") => arguments.tosses.end = parser.value()?.parse()?,
            Long("part") => arguments.part = parser.value()?.parse()?,
            Long("seed") => arguments.seed = parser.value()?.parse()?,
            Long("threads") => arguments.threads = parser.value()?.parse()?,
            Short('o') | Long("out") => arguments.out = parser.value()?.into(),
            Long("merge") => tasks.push(("--merge", Task::Merge)),
            Long("toss") => {
                tasks.push(("--toss", Task::Replay(parser.value()?.parse()?)));
            }
            Long("label-error") => tasks.push(("--label-error", Task::LabelError)),
            Long("efficiency") => tasks.push(("--efficiency", Task::Efficiency)),
            Long("cost") => tasks.push(("--cost", Task::Cost)),
            Long("write") => arguments.write = true,
            Short('h') | Long("help") => return Ok(None),
            other => return Err(other.unexpected()),
        }
    }
    match tasks[..] {
        [] => {}
        [(_, task)] => arguments.task = task,
        [(first, _), (second, _), ..] => {
            let message = format!("only one task at a time, got {first} and {second}");
            return Err(message.into());
        }
    }
    arguments.check()?;
    Ok(Some(arguments))
}

impl Arguments {
    /// Refuses what contradicts itself, an empty name of the folder, and more tosses, files or
    /// threads than the bounds.
    fn check(&self) -> Result<(), String> {
        if self.out.as_os_str().is_empty() {
            return Err("--out must be the name of a folder, got an empty one".into());
        }
        if self.write && !matches!(self.task, Task::Cost) {
            return Err("--write needs --cost, whose table it writes".into());
        }
        if self.tosses.end < self.tosses.start || self.part == 0 {
            let (Range { start, end }, part) = (&self.tosses, self.part);
            return Err(format!(
                "--to must be at least --from, and --part at least 1, got {end}, {start} and {part}"
            ));
        }
        let tosses = self.tosses.end - self.tosses.start;
        let least = self.task.least_tosses();
        within("--to minus --from", tosses, least..=MOST_TOSSES, " tosses")?;
        // The other tasks write no parts, and a merge does not depend on their length.
        if matches!(self.task, Task::Play) {
            let parts = tosses.div_ceil(self.part);
            let name = "--to minus --from over --part";
            within(name, parts, 0..=MOST_PARTS, " files")?;
        }
        within("--threads", self.threads, 0..=MOST_THREADS, "")?;
        Ok(())
    }
}

fn work(arguments: &Arguments) -> Outcome<()> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(arguments.threads);
    let pool = pool.build()?;
    // The error of `work` need not be sent between threads, its text can.
    let worked = pool.install(|| {
        let worked = match arguments.task {
            Task::Play => parts::play(arguments),
            Task::Merge => parts::merge(arguments),
            Task::Replay(toss) => replay::replay(arguments, toss),
            Task::LabelError => measure::label_error(arguments),
            Task::Efficiency => measure::efficiency(arguments),
            Task::Cost => measure::cost(arguments),
        };
        worked.map_err(|error| error.to_string())
    });
    Ok(worked?)
}
