//! The stored tables: RESULTS.md in this folder, and the part of the guide's page between its
//! markers.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

/// Returns the versions of the compared programs.
pub(crate) fn versions() -> String {
    format!(
        "rapier3d {}, rapier3d-f64 {}, ode_solvers {}, diffsol {}",
        rapier3d::VERSION,
        rapier3d_f64::VERSION,
        version_in_lock("ode_solvers"),
        version_in_lock("diffsol")
    )
}

/// Writes all tables into RESULTS.md, and the summary and the costs of an error into the page of
/// the guide.
pub(crate) fn write(all: &str, summary: &str, within: &str) -> Result<(), String> {
    let measured = measured();
    let results = format!(
        "# Beside peers: all rows\n\n{measured} The [README](README.md) says what the columns are and what each program was given.\nWritten by `cargo run --release -- --write` in this folder.\n\n{}\n",
        all.trim_end()
    );
    store(&folder().join("RESULTS.md"), &results)?;
    let sections = within.replace("## ", "### ").replace("####", "###");
    let marks = [
        "<!-- peers: begin; written by `cargo run --release -- --write` in benches/peers -->",
        "<!-- peers: end -->",
    ];
    put_between(marks, &format!("{measured}\n\n{summary}{sections}"))
}

/// Writes the trials in one call into TRIALS.md, and their means into the page of the guide.
pub(crate) fn write_trials(all: &str, means: &str) -> Result<(), String> {
    let measured = measured();
    let results = format!(
        "# The eight trials in one call\n\n{measured}\n\
         The [README](README.md) says what the numbers are.\n\
         Written by `cargo run --release -- --trials --write` in this folder.\n\n{}\n",
        all.trim_end()
    );
    store(&folder().join("TRIALS.md"), &results)?;
    let marks = [
        "<!-- peers trials: begin; \
         written by `cargo run --release -- --trials --write` in benches/peers -->",
        "<!-- peers trials: end -->",
    ];
    put_between(marks, &format!("{measured}\n\n{means}"))
}

/// Writes the figures that the project aims at into AIMS.md.
pub(crate) fn write_aims(table: &str) -> Result<(), String> {
    let text = format!(
        "# Figures aimed at\n\n{}\n\
         Each figure is to be at most the second column.\n\
         The [README](README.md) says what the scenes are.\n\
         Written by `cargo run --release -- --aims --write` in this folder.\n\
         The last rows are those that other commands store:\n\
         `.ci/instructions --update` and `--example known_outcomes -- --methods --write`.\n\n{}\n",
        measured(),
        table.trim_end()
    );
    store(&folder().join("AIMS.md"), &text)
}

fn folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the sentence on what was measured, when, and where.
fn measured() -> String {
    format!(
        "{}, tumble {}, {},\n{}; one core of a busy machine: compare rows, not machines.",
        today(),
        version_in_lock("tumble"),
        versions(),
        compiler()
    )
}

/// Replaces the text between two marks of the page of the guide.
fn put_between([begin, end]: [&str; 2], table: &str) -> Result<(), String> {
    let page = folder().join("../../src/guide/peers.md");
    let text = fs::read_to_string(&page).map_err(|error| format!("{}: {error}", page.display()))?;
    let marks = text.find(begin).zip(text.find(end));
    let (first, last) = marks.ok_or("the page has lost its marks")?;
    let before = &text[..first + begin.len()];
    store(&page, &format!("{before}\n\n{table}{}", &text[last..]))
}

fn store(path: &Path, text: &str) -> Result<(), String> {
    fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))?;
    eprintln!("{}", path.display());
    Ok(())
}

/// Returns the version of a package in the Cargo.lock of this folder.
fn version_in_lock(package: &str) -> &'static str {
    let lock = include_str!("../Cargo.lock");
    let entry = lock.split("[[package]]").find(|entry| {
        entry
            .lines()
            .any(|line| line == format!("name = \"{package}\""))
    });
    entry
        .and_then(|entry| entry.split("version = \"").nth(1))
        .and_then(|rest| rest.split('"').next())
        .unwrap_or("of unknown version")
}

fn compiler() -> String {
    let output = Command::new("rustc").arg("--version").output();
    let text = output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    let words = text.unwrap_or_default();
    words.split(' ').take(2).collect::<Vec<_>>().join(" ")
}

/// Returns the date, such as `2026-11-21`.
///
/// It follows from the calendar's cycle of 400 years of 146 097 days, counted from the first of
/// March of the year 0.
fn today() -> String {
    let days = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |time| time.as_secs() / 86_400)
        + 719_468;
    let (cycle, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let of_year = day - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let date = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = year + cycle * 400 + u64::from(month <= 2);
    format!("{year}-{month:02}-{date:02}")
}
