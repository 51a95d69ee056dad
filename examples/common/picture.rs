//! Plots, written as SVG and PNG.

use std::path::Path;

use kuva::prelude::*;
use kuva::render::render::{Scene, render_multiple};

use super::{Outcome, write_file};

/// Colours that colour-blind people can distinguish (Okabe and Ito).
pub const BLUE: &str = "#0072b2";
pub const ORANGE: &str = "#e69f00";
pub const GREEN: &str = "#009e73";
pub const PURPLE: &str = "#cc79a7";
pub const VERMILION: &str = "#d55e00";
pub const GREY: &str = "#888888";
pub const BLACK: &str = "#222222";

/// Width and height of the SVG, pixels.
pub type Size = (f64, f64);
pub const WIDE: Size = (900.0, 480.0);
/// Size for a phone, which shows three quarters of it.
const NARROW: Size = (460.0, 350.0);
/// Room for half of the last number of the horizontal axis, such as 100000.
const NARROW_MARGIN: f64 = 26.0;
/// Number of pixels of the PNG for each pixel of the SVG.
const PNG_SCALE: f32 = 2.0;

/// A drawing with its name.
#[derive(Debug)]
pub struct Picture {
    name: &'static str,
    svg: String,
    png: Vec<u8>,
    narrow: Option<Narrow>,
}

/// The same plots for the width of a phone. A page shows title and legend around them, where they
/// wrap.
#[derive(Debug)]
pub struct Narrow {
    pub title: String,
    pub legend: Vec<Entry>,
    svg: String,
}

/// What a plot draws its points with.
#[derive(Clone, Copy, Debug)]
pub enum Mark {
    Line,
    Dashes,
    Dots,
}

/// Entry of a legend.
#[derive(Debug)]
pub struct Entry {
    pub name: String,
    pub colour: String,
    pub mark: Mark,
}

impl Narrow {
    fn new(plots: Vec<Plot>, arrange: impl Fn(Layout) -> Layout) -> Self {
        let mut layout = arrange(layout(&plots, NARROW));
        layout.show_legend = false;
        layout.force_margin_right = Some(NARROW_MARGIN);
        Self {
            title: layout.title.take().unwrap_or_default(),
            legend: plots.iter().filter_map(entry).collect(),
            svg: svg(&render_multiple(plots, layout)),
        }
    }

    /// Drawing for a page, with unique names of its clip paths.
    pub fn svg(&self, tag: &str) -> String {
        with_own_names(&self.svg, tag)
    }
}

impl Picture {
    /// Creates a picture of curves and points in one frame.
    pub fn new(
        name: &'static str,
        plots: Vec<Plot>,
        arrange: impl Fn(Layout) -> Layout,
    ) -> Outcome<Self> {
        let narrow = copied(&plots).map(|plots| Narrow::new(plots, &arrange));
        let layout = arrange(layout(&plots, WIDE));
        let wide = Self::of(name, &render_multiple(plots, layout))?;
        Ok(Self { narrow, ..wide })
    }

    /// Creates a picture of a drawing, which has one width.
    pub fn of(name: &'static str, scene: &Scene) -> Outcome<Self> {
        Ok(Self {
            name,
            svg: svg(scene),
            png: PngBackend::new()
                .with_scale(PNG_SCALE)
                .render_scene(scene)?,
            narrow: None,
        })
    }

    /// Name of the picture, which is that of its files.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Drawing for a page, with unique names of its clip paths.
    pub fn svg(&self, tag: &str) -> String {
        with_own_names(&self.svg, tag)
    }

    /// Drawing for the width of a phone.
    pub fn narrow(&self) -> Option<&Narrow> {
        self.narrow.as_ref()
    }

    /// Writes both files into a folder.
    pub fn write(&self, folder: &Path) -> Outcome<()> {
        let file = folder.join(self.name);
        write_file(&file.with_extension("svg"), &self.svg)?;
        write_file(&file.with_extension("png"), &self.png)
    }
}

/// Copies of plots, if each is of a kind that the examples draw.
fn copied(plots: &[Plot]) -> Option<Vec<Plot>> {
    let copies = plots.iter().map(|plot| match plot {
        Plot::Line(line) => Some(Plot::Line(line.clone())),
        Plot::Scatter(points) => Some(Plot::Scatter(points.clone())),
        _ => None,
    });
    copies.collect()
}

/// Entry of a plot in the legend.
fn entry(plot: &Plot) -> Option<Entry> {
    let (name, colour, mark) = match plot {
        Plot::Line(line) => {
            let mark = match line.line_style {
                LineStyle::Solid => Mark::Line,
                _ => Mark::Dashes,
            };
            (&line.legend_label, &line.color, mark)
        }
        Plot::Scatter(points) => (&points.legend_label, &points.color, Mark::Dots),
        _ => return None,
    };
    Some(Entry {
        name: name.clone()?,
        colour: colour.clone(),
        mark,
    })
}

/// Drawing with a view box, so that a page can scale it.
pub fn svg(scene: &Scene) -> String {
    let view_box = format!("<svg viewBox=\"0 0 {} {}\" ", scene.width, scene.height);
    let text = SvgBackend::new().render_scene(scene);
    text.replacen("<svg ", &view_box, 1)
}

/// Replaces names of clip paths, because they must be unique within a page.
pub fn with_own_names(svg: &str, tag: &str) -> String {
    svg.replace("kuva-clip", &format!("clip-{tag}"))
}

/// Frame that fits the plots.
pub fn layout(plots: &[Plot], (width, height): Size) -> Layout {
    Layout::auto_from_plots(plots)
        .with_width(width)
        .with_height(height)
        .with_theme(Theme {
            grid_color: "#e4e4e4".to_owned(),
            legend_border: "#cccccc".to_owned(),
            axis_color: "#444444".to_owned(),
            ..Theme::light()
        })
}

/// Reduces a curve to the first, lowest, highest and last point of each of `strips` intervals. More
/// points than a picture has pixels would have no visible effect.
pub fn thinned(curve: Vec<(f64, f64)>, strips: usize) -> Vec<(f64, f64)> {
    let strip = curve.len().div_ceil(strips);
    if strip <= 4 {
        return curve;
    }
    curve.chunks(strip).flat_map(extremes).collect()
}

/// First, lowest, highest and last point of an interval, in order and without repetition.
fn extremes(strip: &[(f64, f64)]) -> impl Iterator<Item = (f64, f64)> + '_ {
    let by_value = |a: &usize, b: &usize| strip[*a].1.total_cmp(&strip[*b].1);
    let lowest = (0..strip.len()).min_by(by_value).unwrap_or(0);
    let highest = (0..strip.len()).max_by(by_value).unwrap_or(0);
    let mut kept = vec![0, lowest, highest, strip.len() - 1];
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter().map(|index| strip[index])
}

/// Number of intervals of a curve in a wide picture: one for every two pixels.
const STRIPS: usize = 450;

pub fn line(curve: Vec<(f64, f64)>, colour: &str, name: &str) -> Plot {
    let line = LinePlot::new()
        .with_data(thinned(curve, STRIPS))
        .with_color(colour)
        .with_stroke_width(1.8);
    Plot::Line(if name.is_empty() {
        line
    } else {
        line.with_legend(name)
    })
}
