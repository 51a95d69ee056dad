//! Common parts of several test files: the loop of the coin report, and the tables in `tests/data`.

// Each test program uses another part of it.
#![allow(dead_code)]
// A test helper that fails ends its test.
#![allow(clippy::unwrap_used, clippy::panic)]

pub(crate) mod continuous;
pub(crate) mod methods;
pub(crate) mod report_loop;

/// A table of numbers with named columns.
#[derive(Debug)]
pub(crate) struct Table {
    names: csv::StringRecord,
    rows: Vec<Vec<f64>>,
}

impl Table {
    /// The table in the text of a CSV file with a header.
    pub(crate) fn parse(text: &str) -> Self {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let names = reader.headers().unwrap().clone();
        let rows = reader.deserialize().map(Result::unwrap).collect();
        Self { names, rows }
    }

    /// The rows, top to bottom.
    pub(crate) fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        (self.rows.iter()).map(|values| Row {
            names: &self.names,
            values,
        })
    }
}

/// A row of a [`Table`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row<'a> {
    names: &'a csv::StringRecord,
    values: &'a [f64],
}

impl Row<'_> {
    /// The number in the column `name`.
    pub(crate) fn get(&self, name: &str) -> f64 {
        let column = self.names.iter().position(|other| other == name);
        self.values[column.unwrap_or_else(|| panic!("no column {name}"))]
    }

    /// The numbers in the three columns `names`.
    pub(crate) fn vector(&self, names: [&str; 3]) -> [f64; 3] {
        names.map(|name| self.get(name))
    }
}

/// The report's own loop in trial 1, 3, 5 or 8, as `tests/data/README.md` describes it.
pub(crate) fn trace(trial: usize) -> Table {
    Table::parse(match trial {
        1 => include_str!("../data/trace_trial1.csv"),
        3 => include_str!("../data/trace_trial3.csv"),
        5 => include_str!("../data/trace_trial5.csv"),
        8 => include_str!("../data/trace_trial8.csv"),
        _ => panic!("there is no trace of trial {trial}"),
    })
}

/// The continuous model in trials 1, 3, 5 and 8, as `tests/data/README.md` describes it.
pub(crate) fn truth_table() -> Table {
    Table::parse(include_str!("../data/truth_table.csv"))
}

/// The works of the continuous model in all eight trials, as `tests/data/README.md` describes them.
pub(crate) fn works_table() -> Table {
    Table::parse(include_str!("../data/works.csv"))
}

/// Largest difference of two vectors in a component.
pub(crate) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a.iter().zip(b)).fold(0.0, |worst, (a, b)| f64::max(worst, (a - b).abs()))
}
