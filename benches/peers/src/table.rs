//! Tables of the results.

use crate::aims::Aim;
use crate::measure::{Outcome, Ratio, Row};
use crate::scene::Scene;
use crate::trials::{self, Line};

/// Table of one scene, with one row for each program and setting.
pub(crate) fn of_scene(scene: &Scene, rows: &[Row], markdown: bool) -> String {
    let (heading, unit) = (scene.name, scene.unit.1);
    let above = format!(
        "{}{heading}\n\n{}\n\n",
        if markdown { "### " } else { "" },
        scene.about
    );
    let head = [
        "program",
        "settings",
        &format!("error, {unit}"),
        "energy rise",
        "ns a step",
        "CPU a second",
        "against tumble",
    ]
    .map(String::from);
    let lines = rows.iter().map(|row| match &row.outcome {
        Ok(outcome) => [
            row.name.clone(),
            row.settings.clone(),
            format!("{:.1e}", outcome.error),
            rise(outcome.rise),
            format!("{:.0}", outcome.step(scene)),
            time(outcome.price),
            ratio(outcome.ratio),
        ],
        Err(why) => {
            let mut cells = [""; 7].map(String::from);
            cells[0].clone_from(&row.name);
            cells[1].clone_from(&row.settings);
            cells[2].clone_from(why);
            cells
        }
    });
    above + &table(&head, lines.collect(), markdown)
}

/// Cost of an error for each program on a scene.
///
/// A row has the longest step or the loosest tolerance that keeps the error, if every shorter and
/// tighter setting that was tried keeps it as well. Costs are relative to the plain Rk4.
pub(crate) fn within(error: f64, scene: &Scene, rows: &[Row], markdown: bool) -> String {
    let cheapest = |name: &str| -> Option<(&Row, Outcome)> {
        (rows.iter())
            .filter(|row| row.name == name && !row.is_sampled)
            .rev()
            .map_while(|row| {
                let outcome = row.outcome.as_ref().ok()?;
                (outcome.error <= error).then_some((row, *outcome))
            })
            .min_by(|a, b| a.1.price.total_cmp(&b.1.price))
    };
    let mut names: Vec<&str> = Vec::new();
    for row in rows {
        if !names.contains(&row.name.as_str()) {
            names.push(&row.name);
        }
    }
    let plain = cheapest("plain Rk4").map_or(f64::NAN, |(_, outcome)| outcome.price);
    let mut found: Vec<_> = names.into_iter().filter_map(cheapest).collect();
    found.sort_by(|a, b| a.1.price.total_cmp(&b.1.price));
    let unit = scene.unit.1;
    let head = [
        "program",
        "settings",
        &format!("error, {unit}"),
        "CPU a second",
        "of the plain Rk4's",
    ]
    .map(String::from);
    let lines = found.into_iter().map(|(row, outcome)| {
        [
            row.name.clone(),
            row.settings.clone(),
            format!("{:.1e}", outcome.error),
            time(outcome.price),
            format!("{:.2}", outcome.price / plain),
        ]
    });
    let above = format!(
        "{}{} within {error:.0e} {unit}\n\n",
        if markdown { "## " } else { "" },
        scene.name
    );
    above + &table(&head, lines.collect(), markdown)
}

/// Column of the summary: its heading, the beginning of the names of its programs, and whether they
/// are sampled.
const PEERS: [(&str, &str, bool); 6] = [
    ("plain Rk4", "plain Rk4", false),
    ("ode_solvers", "ode_solvers", false),
    ("ode_solvers, 240 Hz", "ode_solvers", true),
    ("diffsol BDF", "diffsol", false),
    ("rapier3d", "rapier3d ", false),
    ("rapier3d-f64", "rapier3d-f64 ", false),
];

/// Summary with one row for each scene: the least error of each other program, and the range of its
/// costs over tumble's at the same accuracy.
pub(crate) fn summary(measured: &[(Scene, Vec<Row>)], markdown: bool) -> String {
    let mut head = vec!["scene".to_string(), "tumble, least error".into()];
    head.extend(PEERS.iter().map(|(heading, ..)| heading.to_string()));
    let mut lines = Vec::new();
    for (scene, rows) in measured {
        let mut line = vec![
            scene.name.to_string(),
            format!(
                "{:.0e} {}",
                least(&outcomes(rows, "tumble", false)),
                scene.unit.1
            ),
        ];
        for (_, name, is_sampled) in PEERS {
            let found = outcomes(rows, name, is_sampled);
            line.push(if found.is_empty() {
                "-".into()
            } else {
                format!("{:.0e}, {}", least(&found), range(&found))
            });
        }
        lines.push(line);
    }
    table(&head, lines, markdown)
}

/// Table of the scenes on which another program is cheaper or more accurate, with its best setting.
pub(crate) fn where_a_peer_is_better(measured: &[(Scene, Vec<Row>)], markdown: bool) -> String {
    let head = ["scene", "program", "settings", "error", "against tumble"].map(String::from);
    let mut lines = Vec::new();
    for (scene, rows) in measured {
        let mut best: Vec<(&Row, Outcome)> = Vec::new();
        for row in rows.iter().filter(|row| !row.is_ours) {
            let Ok(outcome) = &row.outcome else { continue };
            let Some(now) = advantage(outcome) else {
                continue;
            };
            let same = |(other, _): &&mut (&Row, Outcome)| {
                other.name == row.name && other.is_sampled == row.is_sampled
            };
            match best.iter_mut().find(same) {
                Some(known) if advantage(&known.1).is_some_and(|known| known <= now) => {}
                Some(known) => *known = (row, *outcome),
                None => best.push((row, *outcome)),
            }
        }
        lines.extend(best.into_iter().map(|(row, outcome)| {
            [
                scene.name.to_string(),
                row.name.clone(),
                row.settings.clone(),
                format!("{:.0e} {}", outcome.error, scene.unit.1),
                ratio(outcome.ratio),
            ]
        }));
    }
    let title = if markdown { "### " } else { "" };
    format!(
        "{title}Where a peer is better\n\n{}",
        table(&head, lines, markdown)
    )
}

/// Tables of the trials in one call: all lines, and the mean and the worst ratio of each method.
pub(crate) fn of_trials(lines: &[Line], markdown: bool) -> (String, String) {
    let name = |method: &str| method.trim_start_matches("tumble ").to_string();
    let head = |first: &[&str]| -> Vec<String> {
        (first.iter().map(|heading| heading.to_string()))
            .chain(trials::headings())
            .collect()
    };
    let rows = lines.iter().map(|line| {
        let ratios = line.ratios.iter();
        [line.trial.to_string(), name(line.method)]
            .into_iter()
            .chain(ratios.map(|ratio| ratio.map_or("not reached".into(), digits)))
            .collect::<Vec<_>>()
    });
    let all = table(&head(&["trial", "method"]), rows.collect(), markdown);
    let rows = trials::summary(lines).into_iter().map(|(method, cells)| {
        let cell = |cell: &Option<(f64, f64)>| match cell {
            Some((mean, worst)) => format!("{}, at most {}", digits(*mean), digits(*worst)),
            None => "not reached".into(),
        };
        let first = [name(method)].into_iter();
        first.chain(cells.iter().map(cell)).collect::<Vec<_>>()
    });
    let means = table(&head(&["method"]), rows.collect(), markdown);
    (all, means)
}

/// Each figure beside the bound that it is to keep.
pub(crate) fn of_aims(aims: &[Aim], markdown: bool) -> String {
    let head = ["figure", "at most", "measured", ""].map(String::from);
    let rows = aims.iter().map(|aim| {
        let value = |value: f64| {
            format!("{} {}", digits(value), aim.unit)
                .trim_end()
                .to_owned()
        };
        vec![
            aim.what.clone(),
            value(aim.at_most),
            aim.measured.map_or("-".into(), value),
            if aim.is_reached() {
                "reached"
            } else {
                "not reached"
            }
            .into(),
        ]
    });
    table(&head, rows.collect(), markdown)
}

/// Cost of another program over tumble's, if it is less than 1; 0 if tumble does not reach its
/// accuracy.
fn advantage(outcome: &Outcome) -> Option<f64> {
    match outcome.ratio {
        Ratio::Times(times) if times < 1.0 => Some(times),
        Ratio::NotReached => Some(0.0),
        _ => None,
    }
}

fn outcomes(rows: &[Row], name: &str, is_sampled: bool) -> Vec<Outcome> {
    (rows.iter())
        .filter(|row| row.name.starts_with(name) && row.is_sampled == is_sampled)
        .filter_map(|row| row.outcome.as_ref().ok().copied())
        .collect()
}

fn least(outcomes: &[Outcome]) -> f64 {
    (outcomes.iter())
        .map(|outcome| outcome.error)
        .fold(f64::INFINITY, f64::min)
}

/// Least and largest ratio of a program's usable rows.
fn range(outcomes: &[Outcome]) -> String {
    let ratios: Vec<Ratio> = outcomes.iter().map(|outcome| outcome.ratio).collect();
    let times = || {
        ratios.iter().filter_map(|ratio| match ratio {
            Ratio::Times(times) => Some(*times),
            _ => None,
        })
    };
    let answers = times().count();
    let mut text = match (times().reduce(f64::min), times().reduce(f64::max)) {
        (Some(least), Some(largest)) if answers > 1 => {
            format!("× {} to {}", digits(least), digits(largest))
        }
        (Some(only), _) => format!("× {}", digits(only)),
        _ => String::new(),
    };
    let missed = ratios
        .iter()
        .filter(|ratio| **ratio == Ratio::NotReached)
        .count();
    if missed > 0 {
        text.push_str(&format!(
            "{}{missed} not reached",
            if text.is_empty() { "" } else { "; " }
        ));
    }
    if text.is_empty() {
        "no answer".into()
    } else {
        text
    }
}

fn ratio(ratio: Ratio) -> String {
    match ratio {
        Ratio::Times(times) => format!("× {}", digits(times)),
        Ratio::NotReached => "not reached".into(),
        Ratio::NoAnswer => "no answer".into(),
    }
}

/// Formats a number with two digits, or with all digits before the point.
fn digits(value: f64) -> String {
    match value {
        v if v > 0.0 && v < 1e-3 => format!("{v:.1e}"),
        v if v < 0.1 => format!("{v:.3}"),
        v if v < 1.0 => format!("{v:.2}"),
        v if v < 10.0 => format!("{v:.1}"),
        v => format!("{v:.0}"),
    }
}

/// Formats a table in Markdown or in columns.
fn table<L: AsRef<[String]>>(head: &[String], lines: Vec<L>, markdown: bool) -> String {
    let (open, between, close) = if markdown {
        ("| ", " | ", " |")
    } else {
        ("", "  ", "")
    };
    let width = |column: usize| {
        let cells = lines
            .iter()
            .map(|line| line.as_ref()[column].chars().count());
        if markdown {
            0
        } else {
            cells
                .chain([head[column].chars().count()])
                .max()
                .unwrap_or(0)
        }
    };
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    let mut out = String::new();
    let line_of = |cells: &[String]| {
        let padded: Vec<String> = cells
            .iter()
            .zip(&widths)
            .map(|(cell, width)| format!("{cell:<width$}"))
            .collect();
        format!("{open}{}{close}\n", padded.join(between).trim_end())
    };
    out += &line_of(head);
    if markdown {
        out += &format!("|{}\n", "---|".repeat(head.len()));
    }
    for line in &lines {
        out += &line_of(line.as_ref());
    }
    out + "\n"
}

fn rise(rise: f64) -> String {
    if rise > 0.0 {
        format!("{rise:.0e}")
    } else {
        "0".into()
    }
}

fn time(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{:.3} ms", s * 1e3),
        s if s < 1.0 => format!("{:.2} ms", s * 1e3),
        s => format!("{s:.2} s"),
    }
}
