//! A cent that spins on a table.

use indicatif::ProgressBar;
use kuva::prelude::*;

use super::{CHAOS, Part, Sizes, deviation, shown, with_intervals};
use crate::count::QUANTILE;
use crate::real_coin::{self, Point};
use common::{Check, GREEN, GREY, Outcome, PURPLE, Picture, line, table};

pub(super) fn part(sizes: &Sizes, bar: &ProgressBar) -> Outcome<Part> {
    let mut curves = Vec::new();
    for (spin, number) in real_coin::SPINS.iter().zip(0..) {
        curves.push(real_coin::points(spin, 100 * number, sizes.real, bar)?);
    }
    let text = format!(
        "Spun on a table: a cent (2.5 g, 19.05 mm by 1.52 mm, 48 points on each rim) spins upright \
         about the vertical (friction 0.2, `Nystrom`, {} ms; {} spins at each offset of the centre \
         of mass). Gelman & \
         Nolan (The American Statistician 56, 2002) state that a coin that is spun can be biased. \
         A rate of 80 % tails for the cent of the United States is often quoted, and is doubted by \
         those who were filmed with it (Did Penn & Teller tell a lie?, Zbl 1360.62072). These \
         spins do not test that rate: the offset of a real cent is not known here, and both ways \
         to start were chosen after trials, to show one with an effect and one without.",
        1e3 * real_coin::STEP,
        sizes.real,
    );
    Ok(Part {
        text: vec![text, table::text(&rows(&curves))],
        checks: checks(&curves),
        pictures: vec![picture(&curves)?],
    })
}

/// Name of a way to start.
fn named(spin: &real_coin::Spin) -> String {
    let [least, most] = spin.rates;
    format!("{least} to {most} rad/s, within {}°", spin.lean)
}

fn rows(curves: &[Vec<Point>]) -> Vec<Vec<String>> {
    let head = [
        "start",
        "centre of mass towards heads, μm",
        "heads up, 99.9 %",
        "the side up at the start",
        "on the edge or undecided",
        "other face at half of the step",
    ];
    let mut rows = vec![table::cells(head)];
    for (spin, curve) in real_coin::SPINS.iter().zip(curves) {
        rows.extend(curve.iter().map(|point| {
            table::cells([
                named(spin),
                point.offset.to_string(),
                shown(&point.count),
                format!("{} of {}", point.count.straight, point.count.decided()),
                point.count.undecided.to_string(),
                format!("{} of {}", point.changed, point.repeated),
            ])
        }));
    }
    rows
}

/// Difference of heads at each negative offset from tails at the opposite one, in standard errors.
fn mirrored(curve: &[Point]) -> impl Iterator<Item = f64> + '_ {
    curve.iter().filter_map(|point| {
        let other = curve
            .iter()
            .find(|other| point.offset < 0.0 && (other.offset + point.offset).abs() < 1e-6)?;
        let [p, q] = [point.count.fraction(), 1.0 - other.count.fraction()];
        let [n, m] = [point, other].map(|point| point.count.decided().max(1) as f64);
        let pooled = (p * n + q * m) / (n + m);
        let variance = pooled * (1.0 - pooled) * (1.0 / n + 1.0 / m);
        Some((p - q).abs() / variance.sqrt().max(1e-9))
    })
}

fn checks(curves: &[Vec<Point>]) -> Vec<Check> {
    let points = || curves.iter().flatten();
    let changed: u64 = points().map(|point| point.changed).sum();
    let fewer: f64 = points().map(|point| point.fewer).sum();
    let fair = points().filter(|point| point.offset == 0.0);
    vec![
        Check::between(
            "spun cent without offset: distance from one half over half the interval",
            "symmetry of coin and start, 99.9 %",
            fair.map(|point| deviation(&point.count, 0.5))
                .fold(0.0, f64::max),
            0.0,
            1.0,
        ),
        Check::between(
            "spun cent: heads against tails at the opposite offset, in standard errors",
            "mirror image, 99.9 %",
            curves
                .iter()
                .flat_map(|curve| mirrored(curve))
                .fold(0.0, f64::max),
            0.0,
            QUANTILE,
        ),
        Check::between(
            &format!(
                "spun cent: heads fewer at half of the step, over the spread of the {changed} \
                 faces that change"
            ),
            CHAOS,
            fewer / (changed as f64).sqrt().max(1.0),
            -QUANTILE,
            QUANTILE,
        ),
    ]
}

fn picture(curves: &[Vec<Point>]) -> Outcome<Picture> {
    let mut plots = vec![line(vec![(-50.0, 0.5), (200.0, 0.5)], GREY, "one half")];
    for ((curve, spin), colour) in curves.iter().zip(&real_coin::SPINS).zip([PURPLE, GREEN]) {
        let counts = curve.iter().map(|point| (point.offset, point.count));
        plots.extend(with_intervals(counts.collect(), colour, &named(spin)));
    }
    Picture::new("spun", plots, |layout| {
        layout
            .with_title("A cent spun on a table: heads comes up")
            .with_x_label("centre of mass from the middle towards heads, μm")
            .with_y_label("fraction of the decided spins")
            .with_legend_position(LegendPosition::InsideTopRight)
    })
}
