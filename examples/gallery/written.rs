//! The table of the guide with the figures that the examples have checked.

use common::{Outcome, marked};

use crate::run::Shown;

const PAGE: &str = "src/guide/gallery.md";
const MARKS: [&str; 2] = [
    "<!-- figures: begin; written by `gallery -- --write` -->",
    "<!-- figures: end -->",
];

/// Writes the figures of all examples but those that depend on the speed of the machine.
pub(crate) fn write(shown: &[Shown]) -> Outcome<()> {
    let mut table = String::from("| figure | value | expected | source |\n|---|---|---|---|\n");
    let steady = |shown: &&Shown| !shown.exhibit.measures_times && !shown.figures.is_empty();
    for shown in shown.iter().filter(steady) {
        table += &format!("| **`{}`** | | | |\n", shown.exhibit.name);
        for figure in &shown.figures {
            table += &figure.row();
            table.push('\n');
        }
    }
    marked::write(PAGE, MARKS, table.trim_end())
}
