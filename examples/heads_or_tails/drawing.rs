//! Drawings of maps: a rectangle for each run of equal cells in a row, and one path for each
//! outcome. The most frequent outcome is the background, so that the drawing is small.

use core::fmt::Write as _;

use kuva::prelude::*;
use kuva::render::color::Color;
use kuva::render::layout::ComputedLayout;
use kuva::render::render::{PathData, Primitive, render_multiple};
use tumble::{CoinFace, Outcome as Ended};

use crate::maps::Map;
use common::picture::{self, WIDE};
use common::{BLACK, BLUE, ORANGE, Outcome, PURPLE, Picture};

/// Outcomes with their colours and names.
const OUTCOMES: [(Ended<CoinFace>, &str, &str); 4] = [
    (Ended::Decided(CoinFace::Heads), BLUE, "heads"),
    (Ended::Decided(CoinFace::Tails), ORANGE, "tails"),
    (Ended::Decided(CoinFace::Edge), PURPLE, "edge"),
    (Ended::Undecided, BLACK, "undecided"),
];

/// Texts of a map: title and names of its axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Texts {
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    pub(crate) x: &'static str,
    pub(crate) y: &'static str,
}

/// Draws a map below lines in its own coordinates.
pub(crate) fn picture(map: &Map, texts: Texts, lines: Vec<Plot>) -> Outcome<Picture> {
    let seen = OUTCOMES
        .iter()
        .filter(|(outcome, ..)| map.count(*outcome) > 0);
    let legend = seen.clone().map(|&(_, colour, label)| LegendEntry {
        label: label.to_owned(),
        color: colour.to_owned(),
        shape: LegendShape::Rect,
        dasharray: None,
    });
    let layout = picture::layout(&lines, WIDE)
        .with_title(texts.title)
        .with_x_label(texts.x)
        .with_y_label(texts.y)
        .with_x_axis_min(map.x[0])
        .with_x_axis_max(map.x[1])
        .with_y_axis_min(map.y[0])
        .with_y_axis_max(map.y[1])
        .with_show_grid(false)
        .with_legend_entries(legend.collect())
        .with_legend_position(LegendPosition::OutsideRightTop);
    let frame = ComputedLayout::from_layout(&layout);
    let most = seen.clone().max_by_key(|(outcome, ..)| map.count(*outcome));
    let background = most.map(|(_, colour, _)| background(colour, &frame, map));
    let others = seen.filter(|(outcome, ..)| most.is_some_and(|(first, ..)| first != outcome));
    let others = others.map(|(outcome, colour, _)| runs(map, *outcome, colour, &frame));
    let paths: Vec<Primitive> = background.into_iter().chain(others).collect();
    let mut scene = render_multiple(lines, layout);
    scene.elements.splice(0..0, paths);
    Picture::of(texts.name, &scene)
}

/// A rectangle of the size of the map.
fn background(colour: &str, frame: &ComputedLayout, map: &Map) -> Primitive {
    let [left, right] = map.x.map(|x| frame.map_x(x));
    let [bottom, top] = map.y.map(|y| frame.map_y(y));
    filled(
        format!("M{left:.2} {top:.2}H{right:.2}V{bottom:.2}H{left:.2}z"),
        colour,
    )
}

/// The cells of an outcome as rectangles: one for each run of them in a row.
fn runs(map: &Map, outcome: Ended<CoinFace>, colour: &str, frame: &ComputedLayout) -> Primitive {
    let [left, right] = map.x.map(|x| frame.map_x(x));
    let [bottom, top] = map.y.map(|y| frame.map_y(y));
    let (width, height) = (right - left, bottom - top);
    let size = map.size as f64;
    // A little higher than a row, so that the background does not show between rows.
    let high = height / size + 0.05;
    let mut d = String::new();
    for (row, cells) in map.cells.chunks(map.size).enumerate() {
        let y = bottom - (row + 1) as f64 * height / size;
        let mut first = 0;
        for run in cells.chunk_by(|a, b| a == b) {
            if run.first() == Some(&outcome) {
                let x = left + first as f64 * width / size;
                let end = x + run.len() as f64 * width / size;
                // Writing to a string does not fail.
                let _ = write!(d, "M{x:.2} {y:.2}H{end:.2}v{high:.2}H{x:.2}z");
            }
            first += run.len();
        }
    }
    filled(d, colour)
}

fn filled(d: String, colour: &str) -> Primitive {
    Primitive::Path(Box::new(PathData {
        d,
        fill: Some(Color::from(colour)),
        stroke: Color::None,
        stroke_width: 0.0,
        opacity: None,
        stroke_dasharray: None,
    }))
}
