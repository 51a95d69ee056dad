//! Distance of two starts.

use kuva::prelude::*;

use super::{Part, Sizes};
use crate::count::QUANTILE;
use crate::sensitivity::{self, FITTED, Row};
use common::{BLUE, Check, GREEN, ORANGE, Outcome, PURPLE, Picture, line, table};

pub(super) fn part(sizes: &Sizes) -> Outcome<Part> {
    let rows = sensitivity::rows(sizes.is_quick)?;
    let text = format!(
        "Sensitivity: two starts {:.0e} m apart in each trial of the coin report, with `Nystrom` \
         and with `Rk4` ({} ms), for {} s. The slip speed is 1 mm/s, which these steps resolve, \
         not the 1e-10 m/s of the report. The rate is that of ln d between {:.0e} and {:.0e} m; \
         `power of time` means that a power fits the distance better than an exponential. Both \
         methods follow the same motion until they are 1 mm apart; where that is before the end of \
         a fit, the rate is not determined.",
        sensitivity::START,
        1e3 * sensitivity::STEP,
        sensitivity::seconds(sizes.is_quick),
        FITTED[0],
        FITTED[1],
    );
    Ok(Part {
        text: vec![text, table::text(&table_of(&rows))],
        checks: checks(&rows)?,
        pictures: vec![picture(&rows)?],
    })
}

fn table_of(rows: &[Row]) -> Vec<Vec<String>> {
    let head = [
        "trial",
        "rate, `Nystrom`, 1/s",
        "rate, `Rk4`, 1/s",
        "fitted, s",
        "growth",
        "d > 1 mm, s",
        "d > 0.1 m, s",
        "largest d, m",
        "faces",
        "decided, s",
        "methods 1 mm apart, s",
    ];
    core::iter::once(table::cells(head))
        .chain(rows.iter().map(row))
        .collect()
}

fn row(row: &Row) -> Vec<String> {
    let [pair, _] = &row.pairs;
    let growths = row.growths();
    let rate = |integrator: usize| {
        growths.map_or("-".to_owned(), |growths| {
            format!(
                "{:.2} ± {:.2}",
                growths[integrator].rate, growths[integrator].error
            )
        })
    };
    let interval = growths.map(|[growth, _]| growth.interval);
    let time = |time: Option<f64>| time.map_or("never".to_owned(), |t| format!("{t:.2}"));
    let faces = pair.decided.map(|decided| match decided {
        Some((face, _)) => face.to_string(),
        None => "undecided".to_owned(),
    });
    let decided = pair.decided.map(|decided| time(decided.map(|(_, t)| t)));
    table::cells([
        row.trial.to_string(),
        rate(0),
        rate(1),
        interval.map_or("-".to_owned(), |[t, end]| format!("{t:.2} to {end:.2}")),
        kind(row).to_owned(),
        time(pair.time_above(1e-3)),
        time(pair.time_above(0.1)),
        format!("{:.1e}", pair.largest()),
        faces.join(", "),
        decided.join(", "),
        time(row.methods_apart()),
    ])
}

/// Kind of growth, in words.
fn kind(row: &Row) -> &'static str {
    let [pair, _] = &row.pairs;
    match row.growths() {
        None if pair.largest() < FITTED[0] => "not chaotic",
        None if pair.largest() < FITTED[1] => "not to 1 mm",
        None => "not determined",
        Some([growth, _]) if growth.is_exponential() => "exponential",
        Some(_) => "power of time",
    }
}

fn checks(rows: &[Row]) -> Outcome<Vec<Check>> {
    let [measured, exact] = sensitivity::tipping()?;
    let both = rows.iter().filter_map(|row| {
        let [first, second] = row.growths()?;
        Some((first.rate - second.rate).abs() / first.error.hypot(second.error))
    });
    let both: Vec<f64> = both.collect();
    let mut checks = vec![Check::near(
        "rate at which the upright coin tips over without friction, measured over exact",
        "λ² = Σ N_i z_i/I; the height and cosh(λ t) at the ends of the fit change it by 9e-5",
        measured / exact,
        1.0,
        1e-4,
    )];
    // A quick run is too short for a fit. Then there is nothing to compare.
    if !both.is_empty() {
        checks.push(Check::between(
            &format!(
                "rates of the two integrators: largest difference in {} trials, in standard errors",
                both.len()
            ),
            "99.9 %",
            both.into_iter().fold(0.0, f64::max),
            0.0,
            QUANTILE,
        ));
    }
    Ok(checks)
}

fn picture(rows: &[Row]) -> Outcome<Picture> {
    const COLOURS: [&str; 8] = [
        BLUE, ORANGE, GREEN, PURPLE, "#d55e00", "#56b4e9", "#222222", "#999933",
    ];
    let curves = rows.iter().zip(COLOURS).map(|(row, colour)| {
        let logs = row.pairs[0]
            .distances
            .iter()
            .map(|(t, d)| (*t, d.max(1e-12).log10()));
        line(logs.collect(), colour, &format!("trial {}", row.trial))
    });
    Picture::new("sensitivity", curves.collect(), |layout| {
        layout
            .with_title("Two starts 1e-9 m apart")
            .with_x_label("time, s")
            .with_y_label("distance: log10 of metres")
            .with_legend_position(LegendPosition::OutsideRightTop)
    })
}
