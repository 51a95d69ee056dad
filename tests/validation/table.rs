//! A case with its printed numbers, and the table that all of them make.

use core::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// A result of the literature: its place in the catalogue, its formula, where it stands, and the numbers that the model gets for it.
pub(crate) struct Case {
    /// Group and number: `C2`.
    pub(crate) id: &'static str,
    /// The formula, as the table shows it.
    pub(crate) formula: &'static str,
    pub(crate) source: &'static str,
    /// Computed once, for the case's own test and for the table.
    pub(crate) figures: LazyLock<Vec<Figure>>,
}

/// A number that is known, and what the model gets.
#[derive(Clone, Debug)]
pub(crate) struct Figure {
    /// What it is, with its unit: `duration, s`.
    pub(crate) what: String,
    pub(crate) expected: f64,
    pub(crate) got: f64,
    /// Largest difference that the model, the step and the printed digits explain.
    pub(crate) tolerance: f64,
}

/// A number of a case.
pub(crate) fn figure(what: impl Into<String>, expected: f64, got: f64, tolerance: f64) -> Figure {
    Figure {
        what: what.into(),
        expected,
        got,
        tolerance,
    }
}

impl Case {
    pub(crate) const fn new(
        id: &'static str,
        formula: &'static str,
        source: &'static str,
        figures: fn() -> Vec<Figure>,
    ) -> Self {
        Self {
            id,
            formula,
            source,
            figures: LazyLock::new(figures),
        }
    }

    /// Fails at the first number that is farther off than its tolerance.
    pub(crate) fn holds(&self) {
        assert!(!self.figures.is_empty());
        for Figure {
            what,
            expected,
            got,
            tolerance,
        } in self.figures.iter()
        {
            let error = (got - expected).abs();
            assert!(
                error <= *tolerance,
                "{}, {what}: {got:.9}, not {expected:.9}; {error:.1e} off, {tolerance:.1e} allowed",
                self.id
            );
        }
    }

    /// The case's lines of the table. What stands alike in all of them is told once.
    pub(crate) fn rows(&self) -> String {
        let mut rows = String::new();
        for (number, figure) in self.figures.iter().enumerate() {
            let [id, formula, source] = match number {
                0 => [self.id, self.formula, self.source],
                _ => [""; 3],
            };
            // A bar would end the cell.
            let formula = formula.replace('|', "\\|");
            let Figure {
                what,
                expected,
                got,
                tolerance,
            } = figure;
            let error = (got - expected).abs();
            // One place more than agree, where the tolerance is wide.
            let digits = digits_for(*expected, error.max(1e-9).min(*tolerance));
            writeln!(
                rows,
                "| {id} | {what} | {formula} | {} | {} | {} | {tolerance:.0e} | {source} |",
                in_digits(*expected, digits),
                in_digits(*got, digits),
                in_words(error, expected.abs()),
            )
            .unwrap();
        }
        rows
    }
}

/// Places after the point that show a number to a difference, and at most nine.
fn digits_for(number: f64, difference: f64) -> usize {
    let [leading, last] = [number, difference].map(|x| x.abs().max(1e-12).log10().floor());
    // The difference may be as small as rounding, or far larger than what is shown to be 0.
    let places = (-last).min(6.0 - leading.min(0.0)).clamp(0.0, 9.0);
    (0..10)
        .find(|&count| f64::from(count) >= places)
        .map_or(9, |count| count as usize)
}

fn in_digits(number: f64, places: usize) -> String {
    let text = format!("{number:.places$}");
    // No "-0.000".
    if text.chars().any(|c| matches!(c, '1'..='9')) {
        text
    } else {
        text.replace('-', "")
    }
}

/// An error to one digit. What rounding alone makes is not told to the digit: the test's own sines are the machine's.
fn in_words(error: f64, size: f64) -> String {
    let rounding = 1e-10 * size.max(1e-2);
    if error < rounding {
        "rounding".to_owned()
    } else {
        format!("{error:.0e}")
    }
}

/// The chapter that shows the table.
pub(crate) struct Table;

/// The one there is.
pub(crate) const TABLE: Table = Table;

impl Table {
    const BEGIN: &str = "<!-- table: begin; the rows are what `UPDATE=1 cargo test --test validation` writes -->\n\n| | what | formula | expected | got | error | tolerance | source |\n|---|---|---|---|---|---|---|---|\n";
    const END: &str = "\n<!-- table: end -->";

    fn file() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("src/guide/validation.md")
    }

    /// The chapter as it is.
    pub(crate) fn stored(&self) -> String {
        fs::read_to_string(Self::file()).unwrap()
    }

    /// The rows in the chapter.
    pub(crate) fn rows_in<'a>(&self, chapter: &'a str) -> &'a str {
        let (_, rest) = chapter.split_once(Self::BEGIN).unwrap();
        rest.split_once(Self::END).unwrap().0
    }

    /// Puts other rows into the chapter.
    pub(crate) fn store(&self, chapter: &str, rows: &str) {
        let (before, rest) = chapter.split_once(Self::BEGIN).unwrap();
        let (_, after) = rest.split_once(Self::END).unwrap();
        let text = [before, Self::BEGIN, rows, Self::END, after].concat();
        fs::write(Self::file(), text).unwrap();
    }
}
