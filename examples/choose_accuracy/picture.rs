//! Diagram of error over cost, one line for each method.

use core::error::Error;
use std::fs;
use std::path::Path;

use kuva::prelude::*;
use kuva::render::render::{Scene, render_multiple};
use tumble::work_precision::{Method, Row, WorkPrecision};

/// Colours that colour-blind people can distinguish (Okabe and Ito).
const COLOURS: [(Method, &str); 11] = [
    (Method::ForwardEuler, "#999999"),
    (Method::SymplecticEuler, "#e69f00"),
    (Method::StrangSplitting, "#009e73"),
    (Method::Rk4, "#0072b2"),
    (Method::Nystrom, "#56b4e9"),
    (Method::EnergyMomentum, "#222222"),
    (Method::BogackiShampine32, "#cc79a7"),
    (Method::DormandPrince54, "#d55e00"),
    (Method::AdaptiveEnergyMomentum, "#b8a800"),
    (Method::AdaptiveNystrom, "#332288"),
    (Method::Radau5, "#882255"),
];

/// Writes `name`.svg and `name`.png into a folder.
#[allow(dead_code, reason = "the bench uses it; the example writes a page")]
pub(crate) fn write(
    curve: &WorkPrecision,
    title: &str,
    folder: &Path,
    name: &str,
) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(folder)?;
    let plots = plots(curve);
    let layout = Layout::auto_from_plots(&plots)
        .with_width(900.0)
        .with_height(560.0);
    let scene = render_multiple(plots, arranged(layout, title));
    fs::write(folder.join(name).with_extension("svg"), svg(&scene))?;
    let png = PngBackend::new().with_scale(2.0).render_scene(&scene)?;
    fs::write(folder.join(name).with_extension("png"), png)?;
    Ok(())
}

/// Drawing with a view box, so that a page can scale it.
#[allow(dead_code, reason = "the bench uses it; the example writes a page")]
fn svg(scene: &Scene) -> String {
    let view_box = format!("<svg viewBox=\"0 0 {} {}\" ", scene.width, scene.height);
    let text = SvgBackend::new().render_scene(scene);
    text.replacen("<svg ", &view_box, 1)
}

/// Returns the curves of the diagram, with their points.
pub(crate) fn plots(curve: &WorkPrecision) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (method, colour) in COLOURS {
        let places: Vec<(f64, f64)> = (curve.rows.iter())
            .filter(|row| row.setting.method == method && says_something(row))
            .map(|row| (row.time.as_secs_f64() * 1e6, row.error))
            .collect();
        if places.is_empty() {
            continue;
        }
        let line = LinePlot::new()
            .with_data(places.clone())
            .with_color(colour)
            .with_stroke_width(1.8)
            .with_legend(method.name());
        let dots = ScatterPlot::new()
            .with_data(places)
            .with_color(colour)
            .with_size(3.5);
        plots.push(Plot::Line(line));
        plots.push(Plot::Scatter(dots));
    }
    plots
}

/// Returns the frame of the diagram.
pub(crate) fn arranged(layout: Layout, title: &str) -> Layout {
    layout
        .with_title(title)
        .with_x_label("cost (µs)")
        .with_y_label("error (m)")
        .with_log_x()
        .with_log_y()
        .with_legend_position(LegendPosition::OutsideRightTop)
}

/// Returns true for a significant error: above that of rounding and below the size of the coin.
fn says_something(row: &Row) -> bool {
    row.error < 2.0 && row.error > 1e-14
}
