//! The robust protocol: the cheapest setting for an error that every smaller setting keeps as well.
//!
//! A step size counts only if each smaller one of the grid keeps the error, so that no setting is
//! reported that keeps it by chance. The grid has multiples of 0.05 ms up to 5 ms. Above that, each
//! step size is 1 % larger than the one before. Below 0.05 ms they are halved, down to 6.25 µs. A
//! tolerance counts only if each smaller one keeps the error, with ten a decade. Trials 1, 3, 5 and
//! 8 have chosen constants of the adaptive methods, and `AdaptiveNystrom` was compared on all eight
//! trials. No constant of the crate was chosen on the tosses.
//!
//! The cost of a setting is its time over that of a plain Rk4 at the Rk4's own robust step. The
//! programs run alternately in one measurement.

use core::error::Error;
use core::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};
use tumble::State;
use tumble::work_precision::{Method, Setting};

use crate::robust_scenes::{Case, Family, cases};

/// Errors, m.
const ERRORS: [f64; 3] = [1e-2, 1e-4, 1e-6];
/// Error of the tables in README and guide, m.
const HEADLINE: f64 = 1e-4;
/// Spacing of the grid, s.
const GRID: f64 = 5e-5;
/// Step size (s) below which the grid is even. Above it, step sizes increase by 1 %.
const EVEN_UP_TO: f64 = 5e-3;
/// Longest step size, s.
const LONGEST_STEP: f64 = 5e-2;
/// Number of repetitions, of which each cost is the least.
const TURNS: usize = 15;

/// Compared program: a method of the crate, or a Rk4 as a user would write it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Program {
    Plain,
    Ours(Method),
}

impl Program {
    const ALL: [Self; 9] = [
        Self::Plain,
        Self::Ours(Method::Rk4),
        Self::Ours(Method::StrangSplitting),
        Self::Ours(Method::EnergyMomentum),
        Self::Ours(Method::Nystrom),
        Self::Ours(Method::BogackiShampine32),
        Self::Ours(Method::DormandPrince54),
        Self::Ours(Method::AdaptiveNystrom),
        Self::Ours(Method::Radau5),
    ];

    fn name(self) -> String {
        match self {
            Self::Plain => "a Rk4 written by hand".into(),
            Self::Ours(method) => format!("`{}`", method.name()),
        }
    }

    fn has_tolerance(self) -> bool {
        matches!(self, Self::Ours(method) if method.has_tolerance())
    }

    /// Returns the grid, beginning with the smallest setting.
    fn grid(self) -> Vec<f64> {
        if self.has_tolerance() {
            return (-100..=-10)
                .map(|tenth| 10_f64.powf(f64::from(tenth) / 10.0))
                .collect();
        }
        let halves = (1..=3).rev().map(|k| GRID / f64::from(1_u32 << k));
        let even = (1_u32..)
            .map(|k| GRID * f64::from(k))
            .take_while(|&step| step <= EVEN_UP_TO);
        let growing = core::iter::successors(Some(EVEN_UP_TO * 1.01), |step| Some(step * 1.01));
        halves
            .chain(even)
            .chain(growing.take_while(|&step| step <= LONGEST_STEP))
            .collect()
    }

    /// Returns the end of a run with this setting and its time, s, or `None` if the run failed.
    fn run(self, case: &Case, value: f64) -> Option<(State, f64)> {
        match self {
            Self::Plain => Some(case.plain(value)),
            Self::Ours(method) => case.run(Setting {
                method,
                parameter: value,
                flight: method.has_tolerance(),
            }),
        }
    }
}

/// Largest robust setting of a program on a scene for each of [`ERRORS`].
struct Found {
    program: Program,
    settings: [Option<f64>; ERRORS.len()],
    /// Costs over that of the plain Rk4, for each of [`ERRORS`].
    costs: [Option<f64>; ERRORS.len()],
}

/// Measures the cases whose names contain `wanted`. Prints a table, writes `robust.csv`, and with
/// `write` the tables of README and guide.
pub(crate) fn run(wanted: &str, write: bool, folder: &Path) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(folder)?;
    let cases: Vec<Case> = (cases()?.into_iter())
        .filter(|case| case.name.contains(wanted))
        .collect();
    let bar = ProgressBar::new((cases.len() * Program::ALL.len()) as u64).with_style(
        ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed} of about {duration}  {msg}")?,
    );
    let mut measured = Vec::new();
    for case in &cases {
        let mut found: Vec<Found> = Vec::new();
        for program in Program::ALL {
            bar.set_message(format!("{}, {}", case.name, program.name()));
            found.push(largest_robust(case, program));
            bar.inc(1);
        }
        add_costs(case, &mut found);
        measured.push((case, found));
    }
    bar.finish_and_clear();
    fs::write(folder.join("robust.csv"), csv(&measured))?;
    let tables = tables(&measured);
    println!("{tables}");
    if write {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        put_between_marks(&root.join("README.md"), &summary(&measured))?;
        put_between_marks(&root.join("src/guide/choosing.md"), &tables)?;
    }
    Ok(())
}

/// Searches from the smallest setting on, until one exceeds the error.
fn largest_robust(case: &Case, program: Program) -> Found {
    let mut settings = [None; ERRORS.len()];
    let mut holds = ERRORS.map(|error| error >= 3.0 * case.resolution);
    for value in program.grid() {
        let error = program
            .run(case, value)
            .map_or(f64::INFINITY, |(end, _)| case.error(&end));
        for (i, wanted) in ERRORS.into_iter().enumerate() {
            holds[i] &= error <= wanted;
            if holds[i] {
                settings[i] = Some(value);
            }
        }
        if !holds.contains(&true) {
            break;
        }
    }
    Found {
        program,
        settings,
        costs: [None; ERRORS.len()],
    }
}

/// Times the robust settings alternately, and compares them with the plain Rk4.
fn add_costs(case: &Case, found: &mut [Found]) {
    for i in 0..ERRORS.len() {
        let mut least = vec![f64::INFINITY; found.len()];
        for _ in 0..TURNS {
            for (least, found) in least.iter_mut().zip(found.iter()) {
                let run = found.settings[i].and_then(|value| found.program.run(case, value));
                *least = least.min(run.map_or(f64::INFINITY, |(_, seconds)| seconds));
            }
        }
        let plain = least[0];
        for (found, least) in found.iter_mut().zip(least) {
            found.costs[i] = (least.is_finite() && plain.is_finite()).then_some(least / plain);
        }
    }
}

type Measured<'a> = [(&'a Case, Vec<Found>)];

fn csv(measured: &Measured<'_>) -> String {
    let mut text = "scene,program,error_m,setting,cost_of_plain_rk4\n".to_owned();
    let cell = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:e}"));
    for (case, all) in measured {
        for found in all {
            for (i, error) in ERRORS.iter().enumerate() {
                let (setting, cost) = (cell(found.settings[i]), cell(found.costs[i]));
                let name = found.program.name().replace('`', "");
                let _ = writeln!(text, "{},{name},{error:e},{setting},{cost}", case.name);
            }
        }
    }
    text
}

/// Returns the cost of one tolerance for all trials: the smallest of their robust ones for
/// [`HEADLINE`].
fn one_tolerance(measured: &Measured<'_>) -> String {
    let mut text = format!(
        "| within {HEADLINE:e} m, one tolerance for all trials | tolerance \
         | cost of the hand-written Rk4: geometric mean, worst |\n|---|---|---|\n"
    );
    let i = headline();
    for program in Program::ALL
        .into_iter()
        .filter(|program| program.has_tolerance())
    {
        let mut trials = Vec::new();
        for (case, all) in measured {
            let found = |wanted| {
                let of_program = all.iter().find(|found| found.program == wanted);
                of_program.and_then(|found| found.settings[i])
            };
            if case.family == Family::Trial {
                trials.push((case, found(Program::Plain), found(program)));
            }
        }
        let smallest = (trials.iter()).try_fold(f64::INFINITY, |least, (_, _, value)| {
            value.map(|value| least.min(value))
        });
        let costs: Option<Vec<f64>> = smallest.and_then(|value| {
            (trials.iter())
                .map(|(case, plain, _)| cost_of_one(case, program, value, (*plain)?))
                .collect()
        });
        let (Some(value), Some(costs)) = (smallest, costs) else {
            let _ = writeln!(text, "| {} | none | - |", program.name());
            continue;
        };
        let sum: f64 = costs.iter().map(|cost| cost.ln()).sum();
        let mean = (sum / costs.len().max(1) as f64).exp();
        let worst = costs.iter().copied().fold(0.0, f64::max);
        let (name, value) = (program.name(), setting(program, value));
        let _ = writeln!(text, "| {name} | {value} | {mean:.3}, {worst:.2} |");
    }
    text
}

/// Returns the time of a program over that of the plain Rk4 with a step of `plain` seconds, the
/// least of alternate runs each.
fn cost_of_one(case: &Case, program: Program, value: f64, plain: f64) -> Option<f64> {
    let mut least = [f64::INFINITY; 2];
    for _ in 0..TURNS {
        let runs = [
            program.run(case, value)?.1,
            Program::Plain.run(case, plain)?.1,
        ];
        for (least, seconds) in least.iter_mut().zip(runs) {
            *least = least.min(seconds);
        }
    }
    Some(least[0] / least[1])
}

/// Returns the summary, the cost of one tolerance, and a table with one row for each scene.
fn tables(measured: &Measured<'_>) -> String {
    let mut text = summary(measured);
    let _ = write!(text, "\n{}", one_tolerance(measured));
    let _ = write!(
        text,
        "\nThe same scene by scene, setting and cost:\n\n| within {HEADLINE:e} m |"
    );
    for program in Program::ALL {
        let _ = write!(text, " {} |", program.name());
    }
    let _ = writeln!(text, "\n|---|{}", "---|".repeat(Program::ALL.len()));
    let i = headline();
    for (case, all) in measured {
        let _ = write!(text, "| {} |", case.name);
        for found in all {
            let cell = match (found.settings[i], found.costs[i]) {
                (Some(value), Some(cost)) => {
                    format!("{}, {cost:.2}", setting(found.program, value))
                }
                (Some(value), None) => setting(found.program, value),
                _ => "none".into(),
            };
            let _ = write!(text, " {cell} |");
        }
        text.push('\n');
    }
    text
}

/// Best, median and worst over the scenes of a group, for [`HEADLINE`].
fn summary(measured: &Measured<'_>) -> String {
    let mut text = format!(
        "| within {HEADLINE:e} m | setting: best, median, worst | cost of the hand-written Rk4: best, median, worst |\n|---|---|---|\n"
    );
    for (family, title) in [
        (Family::Trial, "eight trials"),
        (Family::Toss, "eight tosses"),
    ] {
        for program in Program::ALL {
            let of_family = || {
                (measured.iter())
                    .filter(move |(case, _)| case.family == family)
                    .flat_map(|(_, all)| all)
                    .filter(move |found| found.program == program)
            };
            let i = headline();
            let settings = spread(of_family().map(|found| found.settings[i]), f64::total_cmp);
            let costs = spread(of_family().map(|found| found.costs[i]), |a, b| {
                b.total_cmp(a)
            });
            let settings =
                settings.map(|value| value.map_or("none".into(), |v| setting(program, v)));
            let costs = costs.map(|value| value.map_or("-".into(), |cost| format!("{cost:.2}")));
            let _ = writeln!(
                text,
                "| {title}, {} | {} | {} |",
                program.name(),
                settings.join(", "),
                costs.join(", ")
            );
        }
    }
    text
}

/// Best, median and worst value.
///
/// The median of an even number is the worse of the two middle values. `order` sorts from worst to
/// best, and `None` is worst.
fn spread(
    values: impl Iterator<Item = Option<f64>>,
    order: impl Fn(&f64, &f64) -> core::cmp::Ordering,
) -> [Option<f64>; 3] {
    let mut all: Vec<Option<f64>> = values.collect();
    all.sort_by(|a, b| match (a, b) {
        (Some(a), Some(b)) => order(a, b),
        _ => a.is_some().cmp(&b.is_some()),
    });
    let at = |index: usize| all.get(index).copied().flatten();
    [
        at(all.len().wrapping_sub(1)),
        at((all.len().max(1) - 1) / 2),
        at(0),
    ]
}

fn headline() -> usize {
    ERRORS
        .iter()
        .position(|&error| error.to_bits() == HEADLINE.to_bits())
        .unwrap_or(0)
}

/// Formats a setting, `9.9 ms`, or `3.1e-5 m` for a tolerance. It is rounded down, so that the
/// printed setting is robust, too.
fn setting(program: Program, value: f64) -> String {
    if program.has_tolerance() {
        return format!("{:.1e} m", two_digits_down(value));
    }
    let milliseconds = value * 1e3;
    let digits = if milliseconds >= EVEN_UP_TO * 1e3 {
        10.0
    } else {
        1e4
    };
    format!("{} ms", (milliseconds * digits + 1e-6).floor() / digits)
}

/// Rounds a positive number down to two digits. A power of ten that is computed with an error stays
/// one.
fn two_digits_down(value: f64) -> f64 {
    let unit = 10_f64.powf((value.log10() + 1e-9).floor() - 1.0);
    (value / unit + 1e-6).floor() * unit
}

/// Replaces the text between the markers of this table.
fn put_between_marks(path: &Path, table: &str) -> Result<(), Box<dyn Error>> {
    let text = fs::read_to_string(path)?;
    let [begin, end] = ["<!-- robust: begin", "<!-- robust: end -->"];
    let first = text.find(begin).ok_or("the page has lost its mark")?;
    let body = first + text[first..].find("-->").ok_or("the mark has no end")? + 3;
    let last = text.find(end).ok_or("the page has lost its end mark")?;
    fs::write(
        path,
        format!("{}\n\n{table}\n{}", &text[..body], &text[last..]),
    )?;
    println!("written: {}", path.display());
    Ok(())
}

/// Returns the result of a closure and the seconds that it took.
pub(crate) fn timed<T>(program: impl FnOnce() -> T) -> (T, f64) {
    let clock = Instant::now();
    let result = program();
    (result, clock.elapsed().as_secs_f64())
}
