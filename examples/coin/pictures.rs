//! The report's pictures: energy, track, slip speed and centre, each as SVG and PNG.

use std::error::Error;
use std::fs;
use std::path::Path;

use kuva::prelude::*;
use kuva::render::figure::Figure;
use kuva::render::render::{Scene, render_multiple};
use tumble::Energy;

use crate::curve::{Curve, pieces, simplified, thinned};
use crate::milestones::Milestones;
use crate::recording::{Moment, Recording};
use crate::setup::RADIUS;

/// Colours that colour-blind eyes tell apart (Okabe and Ito).
const BLUE: &str = "#0072b2";
const ORANGE: &str = "#e69f00";
const GREEN: &str = "#009e73";
const PURPLE: &str = "#cc79a7";
const VERMILION: &str = "#d55e00";
const BLACK: &str = "#222222";

/// Width and height, pixels of the SVG.
type Size = (f64, f64);
const WIDE: Size = (900.0, 480.0);
const FLAT: Size = (900.0, 300.0);
const SQUARE: Size = (820.0, 720.0);
/// A picture in the overview of the trials.
const SMALL: Size = (420.0, 280.0);
/// Pixels of the PNG for each pixel of the SVG.
const PNG_SCALE: f32 = 2.0;

/// Writes the four pictures of a run into a folder.
pub(crate) fn write(recording: &Recording, folder: &Path) -> Result<(), Box<dyn Error>> {
    let title = recording.setup.title();
    let energy = energy(recording, WIDE)
        .with_title(format!("{title}: energy by kind"))
        .with_events(recording);
    let track = track(recording, SQUARE).with_title(format!("{title}: track, seen from above"));
    let slip = slip(recording)
        .with_title(format!("{title}: slip speed of the lowest point"))
        .with_events(recording);
    write_both(&energy.scene(), folder, "energy")?;
    write_both(&track.scene(), folder, "track")?;
    write_both(&slip.scene(), folder, "slip")?;
    write_both(&centre(recording), folder, "centre")
}

/// Energy and track as two small SVGs, for the overview of the trials.
pub(crate) fn small(recording: &Recording) -> [String; 2] {
    let number = recording.setup.number;
    let energy = ("energy", energy(recording, SMALL));
    let track = ("track", track(recording, SMALL));
    [energy, track].map(|(name, picture)| {
        // Names of clip paths must be the page's only ones.
        svg(&picture.sparse().scene()).replace("kuva-clip", &format!("{name}-{number}-clip"))
    })
}

fn write_both(scene: &Scene, folder: &Path, name: &str) -> Result<(), Box<dyn Error>> {
    fs::write(folder.join(name).with_extension("svg"), svg(scene))?;
    let png = PngBackend::new()
        .with_scale(PNG_SCALE)
        .render_scene(scene)?;
    fs::write(folder.join(name).with_extension("png"), png)?;
    Ok(())
}

/// With a view box, so that a page may scale it.
fn svg(scene: &Scene) -> String {
    let view_box = format!("<svg viewBox=\"0 0 {} {}\" ", scene.width, scene.height);
    let text = SvgBackend::new().render_scene(scene);
    text.replacen("<svg ", &view_box, 1)
}

/// Curves and the frame around them.
struct Picture {
    curves: Vec<Plot>,
    layout: Layout,
}

impl Picture {
    fn new(curves: Vec<LinePlot>, x_label: &str, y_label: &str, (width, height): Size) -> Self {
        let curves: Vec<Plot> = curves.into_iter().map(Plot::Line).collect();
        let layout = Layout::auto_from_plots(&curves)
            .with_width(width)
            .with_height(height)
            .with_x_label(x_label)
            .with_y_label(y_label)
            .with_theme(theme());
        Self { curves, layout }
    }

    /// With time across. What is positive stands on the axis, also where it ends a hair below zero, as the energy does.
    fn over_time(curves: Vec<LinePlot>, y_label: &str, size: Size) -> Self {
        let values = || {
            curves
                .iter()
                .flat_map(|curve| &curve.data)
                .map(|point| point.y)
        };
        let (lowest, highest) = (values().fold(0.0, f64::min), values().fold(0.0, f64::max));
        let picture = Self::new(curves, "time (s)", y_label, size);
        if lowest < -0.01 * highest {
            return picture;
        }
        picture.with(|layout| layout.with_y_axis_min(0.0))
    }

    fn with(mut self, change: impl FnOnce(Layout) -> Layout) -> Self {
        self.layout = change(self.layout);
        self
    }

    fn with_title(self, title: impl Into<String>) -> Self {
        self.with(|layout| layout.with_title(title))
    }

    fn with_dots(mut self, places: impl Iterator<Item = (f64, f64)>, name: &str) -> Self {
        let dots = ScatterPlot::new()
            .with_data(places.collect::<Vec<_>>())
            .with_color(BLACK)
            .with_size(3.5)
            .with_legend(name);
        self.curves.push(Plot::Scatter(dots));
        self
    }

    /// Marks when things happen: dashed lines, and a line of text under the title.
    fn with_events(self, recording: &Recording) -> Self {
        let events = Milestones::of(recording).events();
        let told: Vec<String> = events
            .iter()
            .map(|(name, time)| format!("{name} at {time:.2} s"))
            .collect();
        self.with(|layout| {
            let layout = layout.with_subtitle(told.join("   ·   "));
            let mark = |(_, time)| ReferenceLine::vertical(time).with_color("#888888");
            let marks = events.into_iter().map(mark);
            marks.fold(layout, Layout::with_reference_line)
        })
    }

    /// With few ticks and without a legend.
    fn sparse(self) -> Self {
        self.with(|layout| {
            let layout = layout.with_label_size(16).with_tick_size(14);
            layout.with_legend_entries(Vec::new()).with_ticks(4)
        })
    }

    fn scene(self) -> Scene {
        render_multiple(self.curves, self.layout)
    }
}

/// Energy by kind over time.
fn energy(recording: &Recording, size: Size) -> Picture {
    let kind = |name, colour, value: fn(&Energy) -> f64| {
        line(over_time(recording, |moment| value(&moment.energy)), colour).with_legend(name)
    };
    let curves = vec![
        kind("total", BLACK, Energy::total).with_stroke_width(2.5),
        kind("gravity", GREEN, |energy| energy.gravity),
        kind("rotation", BLUE, |energy| energy.rotation),
        kind("translation", ORANGE, |energy| energy.translation),
        kind("springs", PURPLE, |energy| energy.springs),
    ];
    Picture::over_time(curves, "energy (J)", size)
        .with(|layout| layout.with_legend_position(LegendPosition::InsideTopRight))
}

/// Path of the lowest point and of the centre on the floor.
fn track(recording: &Recording, size: Size) -> Picture {
    let moving = recording.until(Milestones::of(recording).settled);
    let lowest = moving.iter().map(|m| (m.lowest.x, m.lowest.y));
    let centre = moving.iter().map(|m| (m.centre.x, m.centre.y));
    let mut curves = track_line(lowest.clone(), BLUE, "lowest point", 1.0);
    curves.extend(track_line(centre.clone(), VERMILION, "centre", 1.8));
    let starts = [lowest.clone().next(), centre.clone().next()];
    let (x, y): (Vec<f64>, Vec<f64>) = lowest.chain(centre).unzip();
    let (left, right) = room_for(&x);
    let (bottom, top) = room_for(&y);
    Picture::new(curves, "x (m)", "y (m)", size)
        .with_dots(starts.into_iter().flatten(), "start")
        .with(|layout| {
            layout
                .with_x_axis_min(left)
                .with_x_axis_max(right)
                .with_y_axis_min(bottom)
                .with_y_axis_max(top)
                .with_equal_aspect()
                .with_legend_position(LegendPosition::InsideTopRight)
        })
}

/// Ends of an axis, m: a margin on both sides, and not less than the coin needs.
fn room_for(places: &[f64]) -> (f64, f64) {
    let least = places.iter().copied().fold(f64::INFINITY, f64::min);
    let most = places.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let margin = 0.1_f64.max(RADIUS - (most - least) / 2.0);
    (least - margin, most + margin)
}

/// Slip speed of the lowest point over time.
fn slip(recording: &Recording) -> Picture {
    let slip = line(over_time(recording, |moment| moment.slip), VERMILION);
    Picture::over_time(vec![slip], "slip speed (m/s)", WIDE)
}

/// Height of the centre over time, and its y below.
fn centre(recording: &Recording) -> Scene {
    let height = line(over_time(recording, |moment| moment.centre.z), GREEN);
    let across = line(over_time(recording, |moment| moment.centre.y), BLUE);
    let panel = |curve, label| {
        Picture::over_time(vec![curve], label, FLAT)
            .with(|layout| layout.with_force_margins(90.0, 20.0))
    };
    let upper = panel(height, "height z (m)");
    let lower = panel(across, "y (m)");
    Figure::new(2, 1)
        .with_title(format!(
            "{}: height and y of the centre",
            recording.setup.title()
        ))
        .with_cell_size(FLAT.0, FLAT.1)
        .with_plots(vec![upper.curves, lower.curves])
        .with_layouts(vec![upper.layout, lower.layout])
        .with_shared_x_all()
        .render()
}

/// One line for each piece of a track; the first carries the name.
fn track_line(
    track: impl Iterator<Item = (f64, f64)>,
    colour: &str,
    name: &str,
    width: f64,
) -> Vec<LinePlot> {
    let mut lines: Vec<LinePlot> = pieces(&simplified(track))
        .into_iter()
        .map(|piece| line(piece, colour).with_stroke_width(width))
        .collect();
    if let Some(first) = lines.first_mut() {
        *first = first.clone().with_legend(name);
    }
    lines
}

fn line(curve: Curve, colour: &str) -> LinePlot {
    LinePlot::new()
        .with_data(curve)
        .with_color(colour)
        .with_stroke_width(1.5)
}

fn theme() -> Theme {
    Theme {
        grid_color: "#e4e4e4".to_owned(),
        legend_border: "#cccccc".to_owned(),
        axis_color: "#444444".to_owned(),
        ..Theme::light()
    }
}

/// A quantity over time, until a little after the coin has settled.
fn over_time(recording: &Recording, value: impl Fn(&Moment) -> f64) -> Curve {
    let moving = recording.until(Milestones::of(recording).curtain()).iter();
    thinned(moving.map(|moment| (moment.time, value(moment))).collect())
}
