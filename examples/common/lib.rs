//! Common parts of the examples: options, checked figures, pictures, films, and a page that shows
//! them.

#![allow(
    missing_docs,
    clippy::missing_errors_doc,
    clippy::must_use_candidate,
    reason = "only the examples use it"
)]

pub mod film;
pub mod marked;
pub mod mesh;
pub mod picture;
pub mod table;

use core::error::Error;
use core::fmt::Write as _;
use std::ffi::OsString;
use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;

use lexopt::prelude::*;

pub use film::{Camera, Column, Film, Pose, Shot, energies, energy_columns};
pub use mesh::Mesh;
pub use picture::{BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, Picture, line};

pub type Outcome<T> = Result<T, Box<dyn Error>>;

/// Options of the command line.
#[derive(Debug)]
pub struct Options {
    /// Output folder, created if it does not exist.
    pub out: PathBuf,
    /// True for a shorter run with fewer results.
    pub quick: bool,
}

/// Runs an example: reads the options, runs the example, and returns the exit code.
///
/// The code is 0 if every figure is as expected, 1 if one is not or the run fails, and 2 if the
/// command line is invalid.
pub fn main(name: &str, about: &str, work: impl FnOnce(&Options) -> Outcome<Page>) -> ExitCode {
    let options = match parse(name, about) {
        Ok(Some(options)) => options,
        Ok(None) => return ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}\nThe options are listed by --help.");
            return ExitCode::from(2);
        }
    };
    let finished = work(&options).and_then(|page| page.write(name, &options));
    match finished {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn parse(name: &str, about: &str) -> Result<Option<Options>, lexopt::Error> {
    let mut options = Options {
        out: PathBuf::from("out"),
        quick: false,
    };
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    let mut parser = lexopt::Parser::from_args(arguments);
    while let Some(argument) = parser.next()? {
        match argument {
            Short('o') | Long("out") => options.out = parser.value()?.into(),
            Short('q') | Long("quick") => options.quick = true,
            Short('h') | Long("help") => {
                println!(
                    "{about}\n\nUsage: cargo run --release --example {name} -- [OPTIONS]\n\n  \
                     -o, --out <FOLDER>   where the page and its pictures go   [default: out]\n  \
                     -q, --quick          a shorter run\n  -h, --help           this text"
                );
                return Ok(None);
            }
            other => return Err(other.unexpected()),
        }
    }
    Ok(Some(options))
}

/// A figure with its expected value.
#[derive(Debug)]
pub struct Check {
    /// Name of the figure, with its unit.
    pub what: String,
    /// Source of the expected value.
    pub source: String,
    pub got: f64,
    pub least: f64,
    pub most: f64,
}

impl Check {
    /// Checks that a figure is within `tolerance` of the expected value.
    pub fn near(what: &str, source: &str, got: f64, expected: f64, tolerance: f64) -> Self {
        Self::between(
            what,
            source,
            got,
            expected - tolerance,
            expected + tolerance,
        )
    }

    /// Checks that a figure is in a range.
    pub fn between(what: &str, source: &str, got: f64, least: f64, most: f64) -> Self {
        Self {
            what: what.to_owned(),
            source: source.to_owned(),
            got,
            least,
            most,
        }
    }

    fn holds(&self) -> bool {
        self.least <= self.got && self.got <= self.most
    }

    /// Cells of the table: name, figure, expected value, result and source.
    fn cells(&self) -> [String; 5] {
        let [least, most] = [self.least, self.most].map(rounded);
        let range = match (self.least.is_finite(), self.most.is_finite()) {
            (true, true) => format!("{least} to {most}"),
            (true, false) => format!("at least {least}"),
            (false, true) => format!("at most {most}"),
            (false, false) => "anything".to_owned(),
        };
        [
            self.what.clone(),
            rounded(self.got),
            range,
            if self.holds() { "pass" } else { "fail" }.to_owned(),
            self.source.clone(),
        ]
    }
}

/// Formats a number with six significant digits, without trailing zeros.
fn rounded(value: f64) -> String {
    let (mantissa, power) = split(value, 5);
    let shown = match power {
        -3..=5 => format!("{value:.*}", usize::try_from(5 - power).unwrap_or(0)),
        _ => mantissa,
    };
    let plain = match shown.contains('.') {
        true => shown.trim_end_matches('0').trim_end_matches('.'),
        false => &shown,
    };
    match power {
        -3..=5 => plain.to_owned(),
        _ => format!("{plain}e{power}"),
    }
}

/// Splits a number into a factor between 1 and 10 with `places` places, and a power of ten.
fn split(value: f64, places: usize) -> (String, i32) {
    let text = format!("{value:.places$e}");
    let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
    (mantissa.to_owned(), power.parse().unwrap_or(0))
}

/// File of the film, next to the page.
const PLAY: &str = "play.html";

/// Page of an example.
#[derive(Debug)]
pub struct Page {
    pub title: &'static str,
    /// Paragraphs of the text.
    pub text: Vec<String>,
    pub checks: Vec<Check>,
    pub pictures: Vec<Picture>,
    /// Film of the run, written to `play.html` next to the page.
    pub film: Option<Film>,
}

impl Page {
    /// Writes the page and its pictures, and prints the figures. Returns true if all figures are as
    /// expected.
    pub fn write(&self, name: &str, options: &Options) -> Outcome<bool> {
        let folder = options.out.join(name);
        let shown = folder.display();
        fs::create_dir_all(&folder)
            .map_err(|error| format!("cannot make the folder {shown}: {error}"))?;
        for picture in &self.pictures {
            picture.write(&folder)?;
        }
        if let Some(film) = &self.film {
            film.write(&folder.join(PLAY))?;
        }
        let page = folder.join(name).with_extension("html");
        fs::write(&page, self.html()?)?;
        println!("{}", self.title);
        for paragraph in &self.text {
            println!("{paragraph}");
        }
        for check in &self.checks {
            let [what, got, range, result, source] = check.cells();
            println!("  {result}  {what}: {got}, expected {range}\n        ({source})");
        }
        println!("Written: {}", page.display());
        Ok(self.checks.iter().all(Check::holds))
    }

    fn html(&self) -> Result<String, core::fmt::Error> {
        let mut html = format!(
            "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>{0}</title>\n\
             <style>body{{font:16px/1.5 system-ui,sans-serif;max-width:960px;margin:24px auto;padding:0 16px;color:#1d2430;background:#fff}}\
             svg{{width:100%;height:auto;min-width:540px}}.wide{{overflow-x:auto}}iframe{{width:100%;height:max(560px,75vh);border:1px solid #d5dbe4;border-radius:8px}}table{{border-collapse:collapse;width:100%;min-width:540px}}\
             td,th{{text-align:left;padding:4px 12px 4px 0;border-bottom:1px solid #d5dbe4;vertical-align:top}}</style></head>\n\
             <body><h1>{0}</h1>\n",
            self.title
        );
        for paragraph in &self.text {
            writeln!(html, "<p>{paragraph}</p>")?;
        }
        if self.film.is_some() {
            writeln!(
                html,
                "<iframe src=\"{PLAY}\" title=\"Film of the run\"></iframe><p><a href=\"{PLAY}\">The film alone</a></p>"
            )?;
        }
        for (number, picture) in self.pictures.iter().enumerate() {
            let svg = picture.svg(&number.to_string());
            writeln!(html, "<div class=\"wide\">{svg}</div>")?;
        }
        html.push_str(
            "<div class=\"wide\"><table><tr><th>figure</th><th>value</th><th>expected</th><th>result</th><th>source</th></tr>\n",
        );
        for check in &self.checks {
            writeln!(
                html,
                "<tr><td>{}</td></tr>",
                check.cells().join("</td><td>")
            )?;
        }
        html.push_str("</table></div></body></html>\n");
        Ok(html)
    }
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
