//! Pictures of the trajectories: from the side with and without air, and from above.

use common::{BLACK, GREY, Outcome, Picture, line};
use kuva::prelude::*;

use crate::Hit;
use crate::flight::{Flight, Moment};
use crate::shots::{BASELINE, NET, NET_HEIGHT, SERVICE_LINE, Stroke};

/// All pictures of the page.
pub(crate) fn all(hits: &[Hit]) -> Outcome<Vec<Picture>> {
    Ok(vec![
        side(hits, Stroke::Ground, "strokes", "ground strokes", BASELINE)?,
        side(hits, Stroke::Serve, "serves", "serves", SERVICE_LINE)?,
        above(hits)?,
        spins(hits)?,
    ])
}

/// A curve through the moments of a flight, one every `milliseconds`, and those of the bounce.
fn curve(
    flight: &Flight,
    milliseconds: usize,
    value: impl Fn(&Moment) -> [f64; 2],
) -> Vec<(f64, f64)> {
    let regular = flight.path.iter().step_by(milliseconds);
    let mut moments: Vec<&Moment> = regular
        .chain(&flight.bounce)
        .chain([flight.end()])
        .collect();
    moments.sort_by(|a, b| a.time.total_cmp(&b.time));
    moments
        .into_iter()
        .map(value)
        .map(|[x, y]| (x, y))
        .collect()
}

/// Interval of the points of a solid curve, ms.
const SOLID: usize = 5;
/// Interval of the points of a dashed curve, ms. The dashes of the PNG begin anew at each point.
const DASHED: usize = 40;

fn of_stroke(hits: &[Hit], stroke: Stroke) -> impl Iterator<Item = &Hit> {
    hits.iter().filter(move |hit| hit.shot.stroke == stroke)
}

fn dashed(curve: Vec<(f64, f64)>, colour: &str) -> LinePlot {
    let line = LinePlot::new().with_data(curve).with_color(colour);
    line.with_stroke_width(1.4).with_dashed()
}

/// Height over distance, in air and without.
fn side(
    hits: &[Hit],
    stroke: Stroke,
    name: &'static str,
    title: &str,
    last_line: f64,
) -> Outcome<Picture> {
    let height = |moment: &Moment| [moment.position.x, moment.position.z];
    let mut plots = Vec::new();
    for hit in of_stroke(hits, stroke) {
        let colour = hit.shot.colour;
        plots.push(Plot::Line(dashed(
            curve(&hit.without_air, DASHED, height),
            colour,
        )));
        plots.push(line(
            curve(&hit.in_air, SOLID, height),
            colour,
            hit.shot.name,
        ));
    }
    // The dashes are explained by a curve of their own, which is a point.
    let meaning = dashed(vec![(NET, 0.0), (NET, 0.0)], GREY).with_legend("without air");
    plots.push(Plot::Line(meaning));
    for (x, top, name) in [(NET, NET_HEIGHT, "net, line"), (last_line, 0.06, "")] {
        plots.push(line(vec![(x, 0.0), (x, top)], BLACK, name));
    }
    Picture::new(name, plots, |layout| {
        layout
            .with_title(format!("{title}, with and without air"))
            .with_x_label("distance from the baseline (m)")
            .with_y_label("height (m)")
            .with_y_axis_min(0.0)
            .with_x_axis_max(45.0)
            .with_clamp_axis()
            .with_legend_position(LegendPosition::OutsideRightTop)
    })
}

/// Serves from above: the sidespin of the slice bends its path.
fn above(hits: &[Hit]) -> Outcome<Picture> {
    let place = |moment: &Moment| [moment.position.x, moment.position.y];
    let mut plots = Vec::new();
    for hit in of_stroke(hits, Stroke::Serve) {
        let shot = &hit.shot;
        plots.push(line(
            curve(&hit.in_air, SOLID, place),
            shot.colour,
            shot.name,
        ));
        let landing = hit.in_air.landing();
        let dot = ScatterPlot::new()
            .with_data(vec![(landing.x, landing.y)])
            .with_color(shot.colour)
            .with_size(5.0);
        plots.push(Plot::Scatter(dot));
    }
    Picture::new("above", plots, |layout| {
        layout
            .with_title("serves from above, in air; the dot is the bounce")
            .with_x_label("distance from the baseline (m)")
            .with_y_label("to the left (m)")
            .with_y_axis_min(-1.0)
            .with_legend_position(LegendPosition::OutsideRightTop)
    })
}

/// Spin of the ground strokes over time, through the bounce.
fn spins(hits: &[Hit]) -> Outcome<Picture> {
    let spin = |moment: &Moment| [moment.time, moment.turns()];
    let plots = of_stroke(hits, Stroke::Ground)
        .map(|hit| {
            line(
                curve(&hit.in_air, SOLID, spin),
                hit.shot.colour,
                hit.shot.name,
            )
        })
        .collect();
    Picture::new("spins", plots, |layout| {
        layout
            .with_title("spin of the ground strokes: the court turns backspin into topspin")
            .with_x_label("time (s)")
            .with_y_label("topspin (revolutions a minute)")
            .with_legend_position(LegendPosition::OutsideRightTop)
    })
}
