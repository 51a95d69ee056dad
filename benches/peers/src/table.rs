//! The tables.

use crate::measure::{Outcome, Ratio, Row};
use crate::scene::Scene;

/// One scene: a row a program and setting.
pub(crate) fn print_scene(scene: &Scene, rows: &[Row], markdown: bool) {
    let (heading, unit) = (scene.name, scene.unit.1);
    println!(
        "{}{heading}\n\n{}\n",
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
    print(&head, lines.collect(), markdown);
}

/// A row a scene: for each peer its least error, and the row of it that is cheapest against ours of the same accuracy.
pub(crate) fn print_summary(measured: &[(Scene, Vec<Row>)], markdown: bool) {
    let peers = ["plain Rk4", "ode_solvers", "rapier3d ", "rapier3d-f64 "];
    let mut head = vec!["scene".to_string(), "tumble, least error".into()];
    head.extend(peers.iter().map(|peer| peer.trim().to_string()));
    let mut lines = Vec::new();
    for (scene, rows) in measured {
        let of = |name: &str| -> Vec<Outcome> {
            (rows.iter())
                .filter(|row| row.name.starts_with(name))
                .filter_map(|row| row.outcome.as_ref().ok().copied())
                .collect()
        };
        let least = |outcomes: &[Outcome]| {
            outcomes
                .iter()
                .map(|outcome| outcome.error)
                .fold(f64::INFINITY, f64::min)
        };
        let mut line = vec![
            scene.name.to_string(),
            format!("{:.0e} {}", least(&of("tumble")), scene.unit.1),
        ];
        for peer in peers {
            let outcomes = of(peer);
            line.push(format!("{:.0e}, {}", least(&outcomes), range(&outcomes)));
        }
        lines.push(line);
    }
    println!("{}Summary\n", if markdown { "## " } else { "" });
    print(&head, lines, markdown);
}

/// The least and the largest ratio of a program's rows that are an answer.
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

/// Two digits, or all before the point.
fn digits(value: f64) -> String {
    match value {
        v if v < 0.1 => format!("{v:.3}"),
        v if v < 1.0 => format!("{v:.2}"),
        v if v < 10.0 => format!("{v:.1}"),
        v => format!("{v:.0}"),
    }
}

/// A table in markdown, or in columns.
fn print<L: AsRef<[String]>>(head: &[String], lines: Vec<L>, markdown: bool) {
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
    let print_line = |cells: &[String]| {
        let padded: Vec<String> = cells
            .iter()
            .zip(&widths)
            .map(|(cell, width)| format!("{cell:<width$}"))
            .collect();
        println!("{open}{}{close}", padded.join(between).trim_end());
    };
    print_line(head);
    if markdown {
        println!("|{}", "---|".repeat(head.len()));
    }
    for line in &lines {
        print_line(line.as_ref());
    }
    println!();
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
