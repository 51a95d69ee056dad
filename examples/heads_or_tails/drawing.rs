//! Drawings of maps: runs of equal cells, drawn as one path for each outcome.

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
    let paths: Vec<Primitive> = seen
        .map(|(outcome, colour, _)| path(map, *outcome, colour, &frame))
        .collect();
    let mut scene = render_multiple(lines, layout);
    scene.elements.splice(0..0, paths);
    Picture::of(texts.name, &scene)
}

/// The cells of an outcome as rectangles: one for each run of them in a row.
fn path(map: &Map, outcome: Ended<CoinFace>, colour: &str, frame: &ComputedLayout) -> Primitive {
    let (left, bottom) = (frame.map_x(map.x[0]), frame.map_y(map.y[0]));
    let width = (frame.map_x(map.x[1]) - left) / map.size as f64;
    let height = (bottom - frame.map_y(map.y[1])) / map.size as f64;
    let mut d = String::new();
    for (row, cells) in map.cells.chunks(map.size).enumerate() {
        let y = bottom - (row + 1) as f64 * height;
        let mut first = 0;
        for run in cells.chunk_by(|a, b| a == b) {
            if run.first() == Some(&outcome) {
                let x = left + first as f64 * width;
                let long = run.len() as f64 * width;
                // A little higher and longer than a run, so that no line of the page shows between.
                let (long, high) = (long + 0.05, height + 0.05);
                // Writing to a string does not fail.
                let _ = write!(d, "M{x:.2} {y:.2}h{long:.2}v{high:.2}h-{long:.2}z");
            }
            first += run.len();
        }
    }
    Primitive::Path(Box::new(PathData {
        d,
        fill: Some(Color::from(colour)),
        stroke: Color::None,
        stroke_width: 0.0,
        opacity: None,
        stroke_dasharray: None,
    }))
}
