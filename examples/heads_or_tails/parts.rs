//! Parts of the page: maps, sensitivity, bounced and spun coins.

use indicatif::ProgressBar;
use kuva::prelude::*;
use tumble::{CoinFace, Outcome as Ended};

use crate::bounced::{self, Bounced};
use crate::count::Count;
use crate::drawing::{self, Texts};
use crate::real_coin::{self, Point};
use crate::sensitivity::{self, FITTED, Row};
use crate::{maps, steel};
use common::{BLACK, BLUE, Check, GREEN, GREY, ORANGE, Outcome, PURPLE, Picture, line, table};

/// Quantile of the normal distribution that is exceeded in absolute value with 1e-3.
const QUANTILE: f64 = 3.29;
const CHAOS: &str = "McNemar's test, 99.9 %: the motion is chaotic, so that fractions are compared";

/// What a part adds to the page.
#[derive(Debug, Default)]
pub(crate) struct Part {
    pub(crate) text: Vec<String>,
    pub(crate) checks: Vec<Check>,
    pub(crate) pictures: Vec<Picture>,
}

/// Numbers of throws.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sizes {
    /// Tosses of each point of the report's coin, and of the caught coin.
    pub(crate) spun: u64,
    pub(crate) caught: u64,
    /// Cells along each axis of the maps of tosses, and of the map of the report's coin.
    pub(crate) map: usize,
    pub(crate) report_map: usize,
    /// Tosses of the map that are repeated.
    pub(crate) repeated: u64,
    /// Tosses of the bounced coin at each angle, and spins of the real coin at each offset.
    pub(crate) bounced: u64,
    pub(crate) real: u64,
    pub(crate) is_quick: bool,
}

impl Sizes {
    pub(crate) fn of(is_quick: bool, is_full: bool) -> Self {
        let choose = |quick, usual, full| match (is_quick, is_full) {
            (true, _) => quick,
            (_, true) => full,
            _ => usual,
        };
        let cells = |quick, usual, full| usize::try_from(choose(quick, usual, full)).unwrap_or(0);
        Self {
            spun: choose(80, 1_600, 12_800),
            caught: choose(2_000, 35_000, 280_000),
            map: cells(40, 250, 1_000),
            report_map: cells(20, 100, 1_000),
            repeated: choose(40, 500, 4_000),
            bounced: choose(200, 10_000, 200_000),
            real: choose(20, 400, 6_400),
            is_quick,
        }
    }

    /// Number of throws of the parts of this file.
    pub(crate) fn throws(&self) -> u64 {
        let cells = 2 * self.map * self.map + self.report_map * self.report_map;
        let bounced = self.bounced + 2 * (self.bounced / bounced::REPEATED);
        let bounced = bounced::ANGLES.len() as u64 * bounced;
        let points = (real_coin::SPINS.len() * real_coin::OFFSETS.len()) as u64;
        let real = points * (self.real + self.real / real_coin::REPEATED);
        cells as u64 + 2 * self.repeated + bounced + real
    }
}

/// All parts, in the order of the page.
pub(crate) fn all(sizes: &Sizes, bar: &ProgressBar) -> Outcome<Vec<Part>> {
    Ok(vec![
        real(sizes, bar)?,
        bounced(sizes, bar)?,
        maps(sizes, bar)?,
        sensitivity(sizes)?,
    ])
}

fn maps(sizes: &Sizes, bar: &ProgressBar) -> Outcome<Part> {
    let caught = maps::caught(sizes.map, bar)?;
    let bounced = maps::bounced(sizes.map, bar)?;
    let repeated = maps::repeat(sizes.repeated, bar)?;
    let report = maps::report(sizes.report_map, bar)?;
    let undecided = |map: &maps::Map| map.count(Ended::Undecided);
    let text = format!(
        "Maps: a coin of steel (20 mm by 2 mm) leaves the hand level and heads up, and rotates \
         about a diameter. It is caught at the height of the hand, or lands on a table {} m below \
         and bounces ({} x {} throws each, {} on the table undecided after {} s, {} on the edge). \
         {} of {} throws change their face at a hundredth of the tolerance. The map of the coin of \
         the coin report has {} x {} throws, {} undecided after {} s. It is coarser, because a \
         throw of it takes longer. `--full` draws 1000 x 1000 throws in each map.",
        steel::HAND,
        sizes.map,
        sizes.map,
        undecided(&bounced),
        steel::PATIENCE,
        bounced.count(Ended::Decided(CoinFace::Edge)),
        repeated.changed,
        repeated.tosses,
        sizes.report_map,
        sizes.report_map,
        undecided(&report),
        maps::REPORT_PATIENCE,
    );
    Ok(Part {
        text: vec![text],
        checks: map_checks(&caught, &repeated)?,
        pictures: map_pictures(&caught, &bounced, &report)?,
    })
}

fn map_checks(caught: &maps::Map, repeated: &maps::Repeated) -> Outcome<Vec<Check>> {
    let differ = caught.cells.iter().zip(caught.middles());
    let differ = differ.filter(|(cell, (speed, rate))| {
        let is_heads = **cell == Ended::Decided(CoinFace::Heads);
        is_heads != maps::is_caught_heads(*speed, *rate)
    });
    Ok(vec![
        Check::between(
            "cells of the map of the caught coin that differ from the closed form",
            "heads up if cos(2 u ω/g) > 0 (Keller 1986)",
            differ.count() as f64,
            0.0,
            0.0,
        ),
        Check::between(
            "largest relative error of 24 boundaries of the caught coin",
            "u ω/g = (2 n + 1) π/4 (Keller 1986), to the rounding of 60 steps",
            maps::boundary_error()?,
            0.0,
            1e-12,
        ),
        Check::between(
            &format!(
                "map with bounces: heads fewer at a hundredth of the tolerance, over the spread of \
                 the {} faces that change",
                repeated.changed
            ),
            CHAOS,
            repeated.fewer / (repeated.changed as f64).sqrt().max(1.0),
            -QUANTILE,
            QUANTILE,
        ),
    ])
}

fn map_pictures(
    caught: &maps::Map,
    bounced: &maps::Map,
    report: &maps::Map,
) -> Outcome<Vec<Picture>> {
    let [x, y] = ["vertical speed u, m/s", "rate ω about a diameter, rad/s"];
    let [most_speed, most_rate] = [caught.x[1], caught.y[1]];
    let strips = (0..24).filter_map(|n| {
        // The boundary is symmetric in speed and rate.
        let least = maps::boundary(most_rate, n);
        let curve = (0..=200).map(|step| {
            let speed = least + (most_speed - least) * f64::from(step) / 200.0;
            (speed, maps::boundary(speed, n))
        });
        (least < most_speed).then(|| line(curve.collect(), BLACK, ""))
    });
    let frame = |map: &maps::Map| vec![line(vec![(map.x[0], map.y[0])], GREY, "")];
    Ok(vec![
        drawing::picture(
            caught,
            Texts {
                name: "map_caught",
                title: "Tossed and caught (lines: Keller)",
                x,
                y,
            },
            strips.collect(),
        )?,
        drawing::picture(
            bounced,
            Texts {
                name: "map_bounced",
                title: "Tossed, with bounces on a table",
                x,
                y,
            },
            frame(bounced),
        )?,
        drawing::picture(
            report,
            Texts {
                name: "map_report",
                title: "The coin of the coin report, set spinning",
                x: "lean from upright at the start, degrees",
                y: "angular momentum, kg m²/s",
            },
            frame(report),
        )?,
    ])
}

fn bounced(sizes: &Sizes, bar: &ProgressBar) -> Outcome<Part> {
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
        text: vec![text, table::text(&bounced_rows(&curves))],
        checks: bounced_checks(&curves),
        pictures: vec![bounced_picture(&curves)?],
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

fn shown(count: &Count) -> String {
    let [low, high] = count.interval();
    format!("{:.3} [{low:.3}, {high:.3}]", count.fraction())
}

fn bounced_rows(curves: &[Bounced]) -> Vec<Vec<String>> {
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

/// Distance of a fraction from a number, over half the width of its interval.
fn deviation(count: &Count, expected: f64) -> f64 {
    let [low, high] = count.interval();
    (expected - 0.5 * (low + high)).abs() / (0.5 * (high - low))
}

fn bounced_checks(curves: &[Bounced]) -> Vec<Check> {
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

fn bounced_picture(curves: &[Bounced]) -> Outcome<Picture> {
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
            .with_legend_position(LegendPosition::InsideTopRight)
    })
}

fn real(sizes: &Sizes, bar: &ProgressBar) -> Outcome<Part> {
    let mut curves = Vec::new();
    for (spin, number) in real_coin::SPINS.iter().zip(0..) {
        curves.push(real_coin::points(spin, 100 * number, sizes.real, bar)?);
    }
    let text = format!(
        "Spun on a table: a cent (2.5 g, 19.05 mm by 1.52 mm, 48 points on each rim) spins upright \
         about the vertical (friction 0.2, `Nystrom`, {} ms; {} spins at each offset of the centre \
         of mass). The rims consist of points, because a body has one round rim at most. Gelman & \
         Nolan (The American Statistician 56, 2002) state that a coin that is spun can be biased. \
         A rate of 80 % tails for the cent of the United States is often quoted, and is doubted by \
         those who were filmed with it (Did Penn & Teller tell a lie?, Zbl 1360.62072). These \
         spins do not test that rate: the offset of a real cent is not known here, and both ways \
         to start were chosen after trials, to show one with an effect and one without.",
        1e3 * real_coin::STEP,
        sizes.real,
    );
    Ok(Part {
        text: vec![text, table::text(&real_rows(&curves))],
        checks: real_checks(&curves),
        pictures: vec![real_picture(&curves)?],
    })
}

/// Name of a way to start.
fn named(spin: &real_coin::Spin) -> String {
    let [least, most] = spin.rates;
    format!("{least} to {most} rad/s, within {}°", spin.lean)
}

fn real_rows(curves: &[Vec<Point>]) -> Vec<Vec<String>> {
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

fn real_checks(curves: &[Vec<Point>]) -> Vec<Check> {
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

fn real_picture(curves: &[Vec<Point>]) -> Outcome<Picture> {
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

/// A curve of fractions with their intervals.
fn with_intervals(counts: Vec<(f64, Count)>, colour: &str, name: &str) -> [Plot; 2] {
    let places = counts.iter().map(|(x, count)| (*x, count.fraction()));
    let places: Vec<(f64, f64)> = places.collect();
    let errors = counts.iter().map(|(_, count)| {
        let ([low, high], middle) = (count.interval(), count.fraction());
        (middle - low, high - middle)
    });
    let dots = ScatterPlot::new()
        .with_data(places.clone())
        .with_y_err_asymmetric(errors.collect::<Vec<_>>())
        .with_color(colour)
        .with_size(4.0);
    [line(places, colour, name), Plot::Scatter(dots)]
}

fn sensitivity(sizes: &Sizes) -> Outcome<Part> {
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
        text: vec![text, table::text(&sensitivity_rows(&rows))],
        checks: sensitivity_checks(&rows)?,
        pictures: vec![sensitivity_picture(&rows)?],
    })
}

fn sensitivity_rows(rows: &[Row]) -> Vec<Vec<String>> {
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
        .chain(rows.iter().map(sensitivity_row))
        .collect()
}

fn sensitivity_row(row: &Row) -> Vec<String> {
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
        Some((face, _)) => format!("{face:?}").to_lowercase(),
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

fn sensitivity_checks(rows: &[Row]) -> Outcome<Vec<Check>> {
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

fn sensitivity_picture(rows: &[Row]) -> Outcome<Picture> {
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
