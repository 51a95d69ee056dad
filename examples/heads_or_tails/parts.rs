//! Parts of the page: maps, sensitivity, bounced and spun coins.

mod bounced;
mod maps;
mod real_coin;
mod sensitivity;

use indicatif::ProgressBar;
use kuva::prelude::*;

use crate::count::Count;
use crate::real_coin::{OFFSETS, REPEATED, SPINS};
use common::{Check, Outcome, Picture, line};

/// Reference of a check of two counts of the same throws.
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
            report_map: cells(20, 250, 1_000),
            repeated: choose(40, 500, 4_000),
            bounced: choose(200, 10_000, 200_000),
            real: choose(20, 400, 6_400),
            is_quick,
        }
    }

    /// Number of throws of all parts.
    pub(crate) fn throws(&self) -> u64 {
        let cells = 2 * self.map * self.map + self.report_map * self.report_map;
        let bounced = self.bounced + 2 * (self.bounced / crate::bounced::REPEATED);
        let bounced = crate::bounced::ANGLES.len() as u64 * bounced;
        let points = (SPINS.len() * OFFSETS.len()) as u64;
        let real = points * (self.real + self.real / REPEATED);
        cells as u64 + 2 * self.repeated + bounced + real
    }
}

/// All parts, in the order of the page.
pub(crate) fn all(sizes: &Sizes, bar: &ProgressBar) -> Outcome<Vec<Part>> {
    Ok(vec![
        real_coin::part(sizes, bar)?,
        bounced::part(sizes, bar)?,
        maps::part(sizes, bar)?,
        sensitivity::part(sizes)?,
    ])
}

/// Distance of a fraction from a number, over half the width of its interval.
fn deviation(count: &Count, expected: f64) -> f64 {
    let [low, high] = count.interval();
    (expected - 0.5 * (low + high)).abs() / (0.5 * (high - low))
}

fn shown(count: &Count) -> String {
    let [low, high] = count.interval();
    format!("{:.3} [{low:.3}, {high:.3}]", count.fraction())
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
