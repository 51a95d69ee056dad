//! Maps of the outcome over the start.

use indicatif::ProgressBar;
use tumble::{CoinFace, Outcome as Ended};

use super::{CHAOS, Part, Sizes};
use crate::count::QUANTILE;
use crate::drawing::{self, Texts};
use crate::{maps, steel};
use common::{BLACK, Check, GREY, Outcome, Picture, line};

pub(super) fn part(sizes: &Sizes, bar: &ProgressBar) -> Outcome<Part> {
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
         the coin report has {} x {} throws (`Nystrom`, {} ms), {} undecided after {} s. `--full` \
         draws 1000 x 1000 throws in each map.",
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
        1e3 * maps::REPORT_STEP,
        undecided(&report),
        maps::REPORT_PATIENCE,
    );
    Ok(Part {
        text: vec![text],
        checks: checks(&caught, &repeated)?,
        pictures: pictures(&caught, &bounced, &report)?,
    })
}

fn checks(caught: &maps::Map, repeated: &maps::Repeated) -> Outcome<Vec<Check>> {
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

fn pictures(caught: &maps::Map, bounced: &maps::Map, report: &maps::Map) -> Outcome<Vec<Picture>> {
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
