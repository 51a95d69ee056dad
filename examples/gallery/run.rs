//! Builds the programs of the examples and runs them.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

use common::Outcome;

use crate::exhibits::Exhibit;

/// An example and the result of its run.
#[derive(Debug)]
pub(crate) struct Shown {
    pub(crate) exhibit: Exhibit,
    /// The figures that it has checked.
    pub(crate) figures: Vec<Figure>,
    /// Error of a program that ended early.
    error: Option<String>,
}

impl Shown {
    pub(crate) fn is_as_expected(&self) -> bool {
        self.failed() == 0 && self.error.is_none()
    }

    fn failed(&self) -> usize {
        self.figures.iter().filter(|figure| !figure.passed).count()
    }

    /// Result in a line.
    pub(crate) fn result(&self) -> String {
        let figures = |count| if count == 1 { "figure" } else { "figures" };
        match (&self.error, self.figures.len(), self.failed()) {
            (Some(error), ..) => error.clone(),
            (None, 0, 0) => String::new(),
            (None, passed, 0) => format!("{passed} {} checked", figures(passed)),
            (None, _, failed) => format!("{failed} {} not as expected", figures(failed)),
        }
    }
}

/// A figure as an example prints it: `  pass  WHAT: GOT, expected RANGE`, and `(SOURCE)` in the next
/// line.
#[derive(Debug)]
pub(crate) struct Figure {
    passed: bool,
    what: String,
    got: String,
    range: String,
    source: String,
}

impl Figure {
    fn read(line: &str, next: &str) -> Option<Self> {
        let (passed, rest) = match line.strip_prefix("  pass  ") {
            Some(rest) => (true, rest),
            None => (false, line.strip_prefix("  fail  ")?),
        };
        let (figure, range) = rest.rsplit_once(", expected ")?;
        let (what, got) = figure.rsplit_once(": ")?;
        let source = next.trim().strip_prefix('(')?.strip_suffix(')')?;
        let [what, got, range, source] = [what, got, range, source].map(str::to_owned);
        Some(Self {
            passed,
            what,
            got,
            range,
            source,
        })
    }

    /// Row of a table: figure, value, expected value, source.
    pub(crate) fn row(&self) -> String {
        let cells = [&self.what, &self.got, &self.range, &self.source];
        let [what, got, range, source] = cells.map(|cell| cell.replace('|', "\\|"));
        format!("| {what} | {got} | {range} | {source} |")
    }
}

/// The figures in what an example prints.
fn figures(text: &str) -> Vec<Figure> {
    let next = text.lines().skip(1).chain([""]);
    let pairs = text.lines().zip(next);
    pairs
        .filter_map(|(line, next)| Figure::read(line, next))
        .collect()
}

/// Builds the programs of the gallery in the profile of this program, and no others. Returns their
/// folder, which is that of this program.
pub(crate) fn build(exhibits: &[Exhibit]) -> Outcome<PathBuf> {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.arg("build");
    for exhibit in exhibits {
        command.args(["--example", exhibit.name]);
    }
    // From the top folder, where this program was built: what it shares with the others is then not
    // built again.
    command.current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    if !cfg!(debug_assertions) {
        command.arg("--release");
    }
    if !command.status()?.success() {
        return Err("the examples cannot be built".into());
    }
    let program = env::current_exe()?;
    Ok(program.parent().ok_or("the program has a folder")?.into())
}

/// Runs an example, which writes its files into its folder of the gallery.
pub(crate) fn run(exhibit: Exhibit, programs: &Path, folder: &Path) -> Shown {
    let out = match exhibit.own_files {
        Some(_) => folder.join(exhibit.name),
        None => folder.into(),
    };
    let program = programs
        .join(exhibit.name)
        .with_extension(env::consts::EXE_EXTENSION);
    let mut command = Command::new(program);
    command.args(exhibit.options).arg("--out").arg(out);
    let mut shown = Shown {
        exhibit,
        figures: Vec::new(),
        error: None,
    };
    match command.output() {
        Err(error) => shown.error = Some(error.to_string()),
        Ok(output) => {
            shown.figures = figures(&String::from_utf8_lossy(&output.stdout));
            if !output.status.success() && shown.failed() == 0 {
                shown.error = Some(String::from_utf8_lossy(&output.stderr).trim().to_owned());
            }
        }
    }
    let page = folder.join(shown.exhibit.page());
    if shown.error.is_none() && !page.exists() {
        shown.error = Some(format!("it has not written {}", page.display()));
    }
    shown
}
