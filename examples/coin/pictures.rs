//! The pictures of the coin report: energy, track, slip speed and centre, each as SVG and PNG.

use std::f64::consts::TAU;
use std::path::Path;

use kuva::prelude::*;
use kuva::render::figure::Figure;
use kuva::render::render::{Scene, render_multiple};
use tumble::Energy;
use tumble::glam::DVec3;

use common::picture::{
    self, BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, Picture, Size, VERMILION, WIDE,
};
use common::{Outcome, write_file};

use crate::curve::{Curve, NEAR, pieces, simplified};
use crate::milestones::Milestones;
use crate::recording::{Moment, Recording};
use crate::setup::RADIUS;

/// Size of a flat picture. Two of them form one picture.
const FLAT: Size = (900.0, 300.0);
const SQUARE: Size = (820.0, 720.0);
/// A picture in the overview of the trials.
const SMALL: Size = (420.0, 280.0);

/// Writes the four pictures of a run into a folder, as SVG and, if `with_png` is true, as PNG.
pub(crate) fn write(recording: &Recording, folder: &Path, with_png: bool) -> Outcome<()> {
    let title = recording.setup.title();
    let energy = energy(recording, WIDE)
        .with_title(format!("{title}: energy by kind"))
        .with_events(recording);
    let track = track(recording, SQUARE).with_title(format!("{title}: track, seen from above"));
    let slip = slip(recording)
        .with_title(format!("{title}: slip speed of the lowest point"))
        .with_events(recording);
    let scenes = [
        ("energy", energy.scene()),
        ("track", track.scene()),
        ("slip", slip.scene()),
        ("centre", centre(recording)),
    ];
    for (name, scene) in &scenes {
        if with_png {
            Picture::of(name, scene)?.write(folder)?;
        } else {
            let file = folder.join(name).with_extension("svg");
            write_file(&file, picture::svg(scene))?;
        }
    }
    Ok(())
}

/// Returns energy and track as two small SVGs, for the overview of the trials.
pub(crate) fn small(recording: &Recording) -> [String; 2] {
    let number = recording.setup.number;
    let energy = ("energy", energy(recording, SMALL));
    let track = ("track", track(recording, SMALL));
    [energy, track].map(|(name, sketch)| {
        picture::with_own_names(
            &picture::svg(&sketch.sparse().scene()),
            &format!("{name}-{number}"),
        )
    })
}

/// Curves and the frame around them.
struct Sketch {
    curves: Vec<Plot>,
    layout: Layout,
}

impl Sketch {
    fn new(curves: Vec<LinePlot>, x_label: &str, y_label: &str, size: Size) -> Self {
        let curves: Vec<Plot> = curves.into_iter().map(Plot::Line).collect();
        let layout = picture::layout(&curves, size)
            .with_x_label(x_label)
            .with_y_label(y_label);
        Self { curves, layout }
    }

    /// Frame with time on the horizontal axis.
    ///
    /// The vertical axis of positive quantities starts at 0, also if rounding makes a value
    /// slightly negative, such as the energy at the end.
    fn over_time(curves: Vec<LinePlot>, y_label: &str, size: Size) -> Self {
        let values = || {
            curves
                .iter()
                .flat_map(|curve| &curve.data)
                .map(|point| point.y)
        };
        let (lowest, highest) = (values().fold(0.0, f64::min), values().fold(0.0, f64::max));
        let sketch = Self::new(curves, "time (s)", y_label, size);
        if lowest < -0.01 * highest {
            return sketch;
        }
        sketch.with(|layout| layout.with_y_axis_min(0.0))
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

    /// Marks the times of events by dashed lines, and by a line of text under the title.
    fn with_events(self, recording: &Recording) -> Self {
        let events = Milestones::of(recording).events();
        let told: Vec<String> = events
            .iter()
            .map(|(name, time)| format!("{name} at {time:.2} s"))
            .collect();
        self.with(|layout| {
            let layout = layout.with_subtitle(told.join("   ·   "));
            let mark = |(_, time)| ReferenceLine::vertical(time).with_color(GREY);
            let marks = events.into_iter().map(mark);
            marks.fold(layout, Layout::with_reference_line)
        })
    }

    /// Reduces the number of ticks and removes the legend.
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
fn energy(recording: &Recording, size: Size) -> Sketch {
    let kind = |name, colour, value: fn(&Energy) -> f64| {
        line(
            over_time(recording, size, |moment| value(&moment.energy)),
            colour,
        )
        .with_legend(name)
    };
    let curves = vec![
        kind("total", BLACK, Energy::total).with_stroke_width(2.5),
        kind("gravity", GREEN, |energy| energy.gravity),
        kind("rotation", BLUE, |energy| energy.rotation),
        kind("translation", ORANGE, |energy| energy.translation),
        kind("springs", PURPLE, |energy| energy.springs),
    ];
    Sketch::over_time(curves, "energy (J)", size)
        .with(|layout| layout.with_legend_position(LegendPosition::InsideTopRight))
}

/// Path of the lowest point and of the centre on the floor.
fn track(recording: &Recording, size: Size) -> Sketch {
    let settled = Milestones::of(recording).settled;
    let moving = recording.until(settled);
    let lowest = moving.iter().map(|m| (m.lowest.x, m.lowest.y));
    let centre = moving.iter().map(|m| (m.centre.x, m.centre.y));
    // A small picture shows less.
    let near = NEAR * SQUARE.0 / size.0;
    let mut curves = track_line(lowest.clone(), near, BLUE, "lowest point", 1.0);
    curves.extend(track_line(centre.clone(), near, VERMILION, "centre", 1.8));
    let starts = [lowest.clone().next(), centre.clone().next()];
    // The coin at both ends gives the scale, also if its track is short.
    let ends = [
        recording.first(),
        moving.last().unwrap_or(recording.first()),
    ];
    let rims = ends.map(rim);
    let end = match settled {
        Some(_) => "coin at rest",
        None => "coin at the end",
    };
    let names = ["coin at the start", end];
    for (rim, name) in rims.iter().zip(names) {
        let outline = line(rim.clone(), GREY).with_legend(name);
        curves.push(outline.with_dashed());
    }
    let shown = lowest.chain(centre).chain(rims.into_iter().flatten());
    let (x, y): (Vec<f64>, Vec<f64>) = shown.unzip();
    let (left, right) = room_for(&x);
    let (bottom, top) = room_for(&y);
    Sketch::new(curves, "x (m)", "y (m)", size)
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

/// Rim of the coin, seen from above.
fn rim(moment: &Moment) -> Curve {
    let point = |k: u32| {
        let (sin, cos) = (TAU * f64::from(k) / 60.0).sin_cos();
        let place =
            moment.centre + moment.orientation * DVec3::new(0.0, RADIUS * cos, RADIUS * sin);
        (place.x, place.y)
    };
    (0..=60).map(point).collect()
}

/// Ends of an axis, m: a margin on both sides, and at least the size of the coin.
fn room_for(places: &[f64]) -> (f64, f64) {
    let least = places.iter().copied().fold(f64::INFINITY, f64::min);
    let most = places.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let margin = 0.1_f64.max(RADIUS - (most - least) / 2.0);
    (least - margin, most + margin)
}

/// Slip speed of the lowest point over time.
fn slip(recording: &Recording) -> Sketch {
    let slip = line(over_time(recording, WIDE, |moment| moment.slip), VERMILION);
    Sketch::over_time(vec![slip], "slip speed (m/s)", WIDE)
}

/// Height of the centre over time, and its y coordinate below.
fn centre(recording: &Recording) -> Scene {
    let height = line(over_time(recording, FLAT, |moment| moment.centre.z), GREEN);
    let across = line(over_time(recording, FLAT, |moment| moment.centre.y), BLUE);
    let panel = |curve, label| {
        Sketch::over_time(vec![curve], label, FLAT)
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

/// Draws one line for each piece of a track. The first has the name of the track.
fn track_line(
    track: impl Iterator<Item = (f64, f64)>,
    near: f64,
    colour: &str,
    name: &str,
    width: f64,
) -> Vec<LinePlot> {
    let mut lines: Vec<LinePlot> = pieces(&simplified(track, near))
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

/// A quantity over time, until shortly after the coin has settled.
fn over_time(recording: &Recording, size: Size, value: impl Fn(&Moment) -> f64) -> Curve {
    let moving = recording.until(Milestones::of(recording).curtain()).iter();
    let curve = moving.map(|moment| (moment.time, value(moment))).collect();
    picture::thinned(curve, strips(size))
}

/// Number of intervals of a curve: one for every two pixels.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a width is a small number above 0"
)]
fn strips((width, _): Size) -> usize {
    (width / 2.0) as usize
}
