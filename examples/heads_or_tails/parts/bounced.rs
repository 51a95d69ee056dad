//! The bias of a coin that is tossed and bounces.

use indicatif::ProgressBar;
use kuva::prelude::*;

use super::{CHAOS, Part, Sizes, deviation, shown, with_intervals};
use crate::bounced::{self, Bounced};
use crate::count::{Count, QUANTILE};
use common::{BLUE, Check, GREY, Outcome, Picture, table};

pub(super) fn part(sizes: &Sizes, bar: &ProgressBar) -> Outcome<Part> {
    let mut curves = Vec::new();
    for psi in bounced::ANGLES {
        curves.push(bounced::count(psi, sizes.bounced, bar)?);
    }
    let text = format!(
        "Tossed and bounced: the coin of steel leaves the hand level at {} to {} m/s and {} to {} \
         revolutions a second, with the angular momentum at ψ from the normal and the vertical \
         ({} tosses at each ψ). After n bounces the side up is that at the n-th highest point \
         after the first touch-down.",
        bounced::SPEEDS[0],
        bounced::SPEEDS[1],
        bounced::RATES[0],
        bounced::RATES[1],
        sizes.bounced,
    );
    Ok(Part {
        text: vec![text, table::text(&rows(&curves))],
        checks: checks(&curves),
        pictures: vec![picture(&curves)?],
    })
}

/// Fractions of a curve: caught, after each bounce, and at the end.
fn stages(curve: &Bounced) -> Vec<(String, Count)> {
    let after = curve.after.iter().zip(1..);
    let after = after.map(|(count, n)| (format!("after bounce {n}"), *count));
    core::iter::once(("caught".to_owned(), curve.caught))
        .chain(after)
        .chain([("at the end".to_owned(), curve.end)])
        .collect()
}

fn rows(curves: &[Bounced]) -> Vec<Vec<String>> {
    let mut head = vec!["side up at the start comes up, 99.9 %".to_owned()];
    head.extend(curves.iter().map(|curve| format!("ψ = {}°", curve.psi)));
    let mut rows = vec![head];
    let columns: Vec<_> = curves.iter().map(stages).collect();
    let Some(first) = columns.first() else {
        return rows;
    };
    for (number, (name, _)) in first.iter().enumerate() {
        let counts = columns.iter().filter_map(|column| column.get(number));
        rows.push(
            core::iter::once(name.clone())
                .chain(counts.map(|(_, count)| shown(count)))
                .collect(),
        );
    }
    let undecided = curves.iter().map(|curve| curve.end.undecided.to_string());
    rows.push(
        core::iter::once("on the edge or undecided".to_owned())
            .chain(undecided)
            .collect(),
    );
    rows
}

fn checks(curves: &[Bounced]) -> Vec<Check> {
    let caught = curves.iter().map(|curve| {
        let expected = crate::caught::formula(curve.psi, curve.psi);
        Check::between(
            &format!(
                "caught at ψ = {}°: distance from the formula over half the interval",
                curve.psi
            ),
            "1/2 + asin(cot² ψ)/π (Diaconis, Holmes & Montgomery 2007), 99.9 %",
            deviation(&curve.caught, expected),
            0.0,
            1.0,
        )
    });
    let changed: u64 = curves.iter().map(|curve| curve.changed).sum();
    let repeated: u64 = curves.iter().map(|curve| curve.repeated).sum();
    let fewer: f64 = curves.iter().map(|curve| curve.fewer).sum();
    let fair = curves.iter().filter(|curve| curve.psi > 89.0);
    let fair = fair
        .flat_map(stages)
        .map(|(_, count)| deviation(&count, 0.5));
    caught
        .chain([Check::between(
            "bounced at ψ = 90°: largest distance from one half over half the interval",
            "both faces alike, so that each fraction is 1/2; 99.9 % each",
            fair.fold(0.0, f64::max),
            0.0,
            1.0,
        )])
        .chain([Check::between(
            &format!(
                "bounced: first side up fewer at a hundredth of the tolerance, over the spread of \
                 the {changed} of {repeated} ends that change"
            ),
            CHAOS,
            fewer / (changed as f64).sqrt().max(1.0),
            -QUANTILE,
            QUANTILE,
        )])
        .collect()
}

fn picture(curves: &[Bounced]) -> Outcome<Picture> {
    let mut plots = Vec::new();
    for (curve, colour) in curves.iter().zip([BLUE, GREY]) {
        let counts = stages(curve).into_iter().zip(0_u8..);
        let counts = counts.map(|((_, count), number)| (f64::from(number), count));
        plots.extend(with_intervals(
            counts.collect(),
            colour,
            &format!("ψ = {}°", curve.psi),
        ));
    }
    Picture::new("bounced", plots, |layout| {
        layout
            .with_title("Tossed and bounced: the side up at the start is up")
            .with_x_label("bounces (0: caught; the last: at the end)")
            .with_y_label("fraction of the tosses")
            .with_legend_position(LegendPosition::InsideTopLeft)
    })
}
