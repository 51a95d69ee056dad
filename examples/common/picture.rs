//! Plots, written as SVG and PNG.

use std::fs;
use std::path::Path;

use kuva::prelude::*;
use kuva::render::render::{Scene, render_multiple};

use super::Outcome;

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
/// Number of pixels of the PNG for each pixel of the SVG.
const PNG_SCALE: f32 = 2.0;

/// A drawing with its name.
#[derive(Debug)]
pub struct Picture {
    name: &'static str,
    svg: String,
    png: Vec<u8>,
}

impl Picture {
    /// Creates a picture of curves and points in one frame.
    pub fn new(
        name: &'static str,
        plots: Vec<Plot>,
        arrange: impl FnOnce(Layout) -> Layout,
    ) -> Outcome<Self> {
        let layout = arrange(layout(&plots, WIDE));
        Self::of(name, &render_multiple(plots, layout))
    }

    /// Creates a picture of a drawing.
    pub fn of(name: &'static str, scene: &Scene) -> Outcome<Self> {
        Ok(Self {
            name,
            svg: svg(scene),
            png: PngBackend::new()
                .with_scale(PNG_SCALE)
                .render_scene(scene)?,
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

    /// Writes both files into a folder.
    pub fn write(&self, folder: &Path) -> Outcome<()> {
        let file = folder.join(self.name);
        fs::write(file.with_extension("svg"), &self.svg)?;
        fs::write(file.with_extension("png"), &self.png)?;
        Ok(())
    }
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
