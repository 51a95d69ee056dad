//! A case with its printed numbers, and the table that all of them make.

use core::cell::Cell;
use core::fmt::Write as _;
use std::sync::LazyLock;

use proptest::prelude::{Strategy, TestCaseError};
use proptest::test_runner::TestRunner;

use crate::kit;
use crate::kit::page::Table;
use crate::kit::statistics::{FractionTest, failing_at_most};

/// A result of the literature: its place in the catalogue, its formula, where it stands, and the
/// numbers that the model gets for it.
pub(crate) struct Case {
    /// Group and number: `C2`.
    pub(crate) id: &'static str,
    /// The formula, as the table shows it.
    pub(crate) formula: &'static str,
    pub(crate) source: &'static str,
    /// Computed once, for the case's own test and for the table.
    pub(crate) figures: LazyLock<Vec<Figure>>,
    /// Cases of the formula with random parameters.
    pub(crate) random: &'static [&'static Random],
}

/// A number that is known, and what the model gets.
#[derive(Clone, Debug)]
pub(crate) struct Figure {
    /// Name of the number, with its unit: `duration, s`.
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

/// A fraction among random cases, with the alternative that the test is there to reject.
pub(crate) fn fraction(
    what: &str,
    test: &FractionTest,
    count: u32,
    (name, alternative): (&str, f64),
) -> Figure {
    let power = test.power(alternative);
    assert!(
        power >= 0.99,
        "{what}: {} cases reject {name} with {:.0} % only",
        test.cases,
        100.0 * power
    );
    let cases = f64::from(test.cases);
    let [low, high] = test.accepted.map(|count| f64::from(count) / cases);
    let what = format!("{} random {what}, rejects {name} with 99 %", test.cases);
    let tolerance = (test.null - low).max(high - test.null);
    figure(what, test.null, f64::from(count) / cases, tolerance)
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
            random: &[],
        }
    }

    /// Adds the random versions of the case.
    pub(crate) const fn and(self, random: &'static [&'static Random]) -> Self {
        // Not `..self`: a constant function cannot drop what that leaves.
        let mut case = self;
        case.random = random;
        case
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
        rows.extend(self.random.iter().map(|random| random.row()));
        rows
    }
}

/// A case's formula with random parameters: a property that tells how near it came to failing.
pub(crate) struct Random {
    /// Random parameters, as the table shows them.
    what: &'static str,
    /// True if the tolerances are those of rounding, which depends on the machine.
    of_rounding: bool,
    /// Computed once, for the property's own test and for the table.
    drawn: LazyLock<Drawn>,
}

/// Number of draws, and the largest error in tolerances; or the draw that failed.
pub(crate) type Drawn = Result<(u32, f64), String>;

impl Random {
    pub(crate) const fn new(what: &'static str, drawn: fn() -> Drawn) -> Self {
        Self {
            what,
            of_rounding: false,
            drawn: LazyLock::new(drawn),
        }
    }

    /// Sets tolerances that include rounding only.
    pub(crate) const fn of_rounding(what: &'static str, drawn: fn() -> Drawn) -> Self {
        Self {
            what,
            of_rounding: true,
            drawn: LazyLock::new(drawn),
        }
    }

    /// Fails with the simplest draw found whose error is larger than its tolerance.
    pub(crate) fn holds(&self) {
        let failure = self.drawn.as_ref().err();
        assert!(failure.is_none(), "{}: {failure:#?}", self.what);
    }

    fn row(&self) -> String {
        let (draws, share) = self.drawn.as_ref().unwrap();
        let worst = if self.of_rounding {
            "rounding".to_owned()
        } else {
            let share = if *share < 0.095 {
                in_words(*share, 1.0)
            } else {
                format!("{share:.1}")
            };
            format!("at most {share} of it")
        };
        format!(
            "|  | any {} |  | {draws} random, {} % | the formula's | {worst} | of each |  |\n",
            self.what,
            in_percent(failing_at_most(*draws)),
        )
    }
}

/// Largest error of all draws, in tolerances.
pub(crate) struct Misses(Cell<f64>);

impl Misses {
    /// Fails where an error is larger than its tolerance, and else remembers their ratio.
    pub(crate) fn within(
        &self,
        what: &str,
        error: f64,
        tolerance: f64,
    ) -> Result<(), TestCaseError> {
        // Not `error > tolerance`: that would let a NaN pass.
        if error <= tolerance {
            if error > 0.0 {
                self.0.set(self.0.get().max(error / tolerance));
            }
            return Ok(());
        }
        let message = format!("{what}: {error:.2e} off, {tolerance:.2e} allowed");
        Err(TestCaseError::fail(message))
    }

    /// Checks a number against the value of the formula.
    pub(crate) fn near(
        &self,
        what: &str,
        [got, expected]: [f64; 2],
        tolerance: f64,
    ) -> Result<(), TestCaseError> {
        let what = format!("{what} {got:.9}, not {expected:.9}");
        self.within(&what, (got - expected).abs(), tolerance)
    }
}

/// Tries `count` random inputs, the same in every run.
pub(crate) fn draw<S: Strategy>(
    count: u32,
    inputs: S,
    test: impl Fn(S::Value, &Misses) -> Result<(), TestCaseError>,
) -> Drawn {
    let (config, misses) = (kit::cases(count), Misses(Cell::new(0.0)));
    let draws = config.cases;
    let outcome = TestRunner::new(config).run(&inputs, |input| test(input, &misses));
    match outcome {
        Ok(()) => Ok((draws, misses.0.get())),
        Err(failure) => Err(failure.to_string()),
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

/// A fraction in percent, to two digits.
fn in_percent(fraction: f64) -> String {
    let percent = 100.0 * fraction;
    let places = if percent < 9.95 { 1 } else { 0 };
    format!("{percent:.places$}")
}

/// An error to one digit. What rounding alone makes is not told to the digit: the test's own sines
/// are the machine's.
fn in_words(error: f64, size: f64) -> String {
    let rounding = 1e-10 * size.max(1e-2);
    if error < rounding {
        "rounding".to_owned()
    } else {
        format!("{error:.0e}")
    }
}

/// The table of the chapter `guide::validation`.
pub(crate) const TABLE: Table = Table {
    page: "validation",
    begin: "<!-- table: begin; rows written by \
            `UPDATE=1 cargo test --test validation` -->\n\n\
            | | what | formula | expected | got | error | tolerance | source |\n\
            |---|---|---|---|---|---|---|---|\n",
    end: "\n<!-- table: end -->",
    command: "cargo test --test validation",
};

/// A [`Random`] and its test, written as `proptest!` would have it: a constant, its number of draws
/// and what is drawn; then the property.
macro_rules! random {
    (
        $(#[$doc:meta])*
        $name:ident = $kind:ident($draws:expr, $what:literal);
        fn $test:ident($($input:ident in $inputs:expr),+ $(,)?) |$misses:ident| $body:block
    ) => {
        $(#[$doc])*
        static $name: $crate::table::Random = $crate::table::Random::$kind($what, || {
            $crate::table::draw($draws, ($($inputs,)+), |($($input,)+), $misses| {
                $body
                Ok(())
            })
        });

        #[test]
        fn $test() {
            $name.holds();
        }
    };
}
pub(crate) use random;
