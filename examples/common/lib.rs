//! Common parts of the examples: options, checked figures, pictures, films, and a page that shows
//! them.

#![allow(
    missing_docs,
    clippy::missing_errors_doc,
    clippy::must_use_candidate,
    reason = "only the examples use it"
)]

mod argument;
mod file;
pub mod film;
pub mod hoop_circle;
pub mod marked;
pub mod mesh;
pub mod page;
pub mod picture;
mod program;
pub mod steel_coin;
pub mod table;

use core::error::Error;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use lexopt::prelude::*;

pub use argument::{not_both, within};
pub use file::{cannot, read_text, write_file};
pub use film::{Camera, Column, Film, Pose, Shot, energies, energy_columns};
pub use mesh::Mesh;
pub use page::{Check, Page};
pub use picture::{BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, Picture, line};
pub use program::{make_folder, program, say};

pub type Outcome<T> = Result<T, Box<dyn Error>>;

/// Options of the command line.
#[derive(Debug)]
pub struct Options {
    /// Output folder, created if it does not exist.
    pub out: PathBuf,
    /// True for a shorter run with fewer results.
    pub quick: bool,
}

/// Place in the repository where the option `--write` stores the tables of an example.
#[derive(Clone, Copy, Debug)]
pub struct Stored {
    /// Page of the documentation, from the top folder.
    pub page: &'static str,
    /// Marks before and after the tables.
    pub marks: [&'static str; 2],
}

/// Runs an example: reads the options, runs the example, and returns the exit code.
///
/// The code is 0 if every figure is as expected, 1 if one is not or the run fails, and 2 if the
/// command line is invalid.
pub fn main(name: &str, about: &str, work: impl FnOnce(&Options) -> Outcome<Page>) -> ExitCode {
    let help = help(name, about, "  -q, --quick          a shorter run\n");
    program(parse(None), &help, |(options, _)| {
        make_folder(&options.out.join(name))?;
        work(options)?.write(name, options)
    })
}

/// Runs an example as [`main`] does. Its option `--write` stores the tables of its page in the
/// documentation. It has no option `--quick`.
pub fn main_with_tables(
    name: &str,
    about: &str,
    stored: Stored,
    work: impl FnOnce(&Options) -> Outcome<Page>,
) -> ExitCode {
    let option = format!(
        "      --write          writes the tables into {}\n",
        stored.page
    );
    let help = help(name, about, &option);
    program(parse(Some(stored)), &help, |(options, stored)| {
        make_folder(&options.out.join(name))?;
        let page = work(options)?;
        if let Some(Stored { page: file, marks }) = stored {
            marked::write(file, *marks, &page.tables())?;
        }
        page.write(name, options)
    })
}

fn help(name: &str, about: &str, option: &str) -> String {
    format!(
        "{about}\n\nUsage: cargo run --release --example {name} -- [OPTIONS]\n\n  \
         -o, --out <FOLDER>   where the page and its pictures go   [default: out]\n\
         {option}  -h, --help           this text\n"
    )
}

/// The options, and the place of the tables if they are to be written.
fn parse(stored: Option<Stored>) -> Result<Option<(Options, Option<Stored>)>, lexopt::Error> {
    let mut options = Options {
        out: PathBuf::from("out"),
        quick: false,
    };
    let mut written = None;
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    let mut parser = lexopt::Parser::from_args(arguments);
    while let Some(argument) = parser.next()? {
        match argument {
            Long("write") if stored.is_some() => written = stored,
            Short('o') | Long("out") => options.out = parser.value()?.into(),
            Short('q') | Long("quick") if stored.is_none() => options.quick = true,
            Short('h') | Long("help") => return Ok(None),
            other => return Err(other.unexpected()),
        }
    }
    Ok(Some((options, written)))
}

/// Generator SplitMix64 (Steele, Lea & Flood, OOPSLA 2014), which gives the same numbers in every
/// run.
#[derive(Debug)]
pub struct Random(pub u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform number between two numbers.
    pub fn between(&mut self, least: f64, most: f64) -> f64 {
        let share = (self.bits() >> 11) as f64 / (1_u64 << 53) as f64;
        least + (most - least) * share
    }

    /// Components of a random unit quaternion, uniform over all rotations (Shoemake, Graphics Gems
    /// III, 1992).
    pub fn turn(&mut self) -> [f64; 4] {
        let (share, first, second) = (
            self.between(0.0, 1.0),
            self.between(0.0, core::f64::consts::TAU),
            self.between(0.0, core::f64::consts::TAU),
        );
        let (small, large) = ((1.0 - share).sqrt(), share.sqrt());
        [
            small * first.sin(),
            small * first.cos(),
            large * second.sin(),
            large * second.cos(),
        ]
    }
}
