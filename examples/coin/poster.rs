//! The picture of the README: an SVG in which the coin tumbles, with its track and the curve of its
//! energy.

use std::fmt::Write;
use std::path::Path;

use common::{Outcome, write_file};
use tumble::glam::{DVec2, DVec3};

use crate::curve::{NEAR, pieces, simplified};
use crate::milestones::Milestones;
use crate::recording::{Moment, Recording};
use crate::setup::RADIUS;

const TEMPLATE: &str = include_str!("poster.svg");

/// Width of the picture, pixels.
const WIDTH: f64 = 900.0;
/// Height of the floor, the upper part of the picture, pixels. The curve is below it.
const FLOOR_HEIGHT: f64 = 350.0;
/// Point of the curve for time 0 and zero energy.
const CURVE_START: DVec2 = DVec2::new(30.0, 446.0);
/// Point of the curve for the end of the run and the energy at the start.
const CURVE_END: DVec2 = DVec2::new(WIDTH - 30.0, 372.0);
const MARGIN: f64 = 26.0;

/// Length of the film, s. The next constant is its number of frames.
const FILM: f64 = 14.0;
const PICTURES: u32 = 350;
/// Times of the film at which a coin stays in the picture, s.
const GHOSTS: [f64; 7] = [0.0, 0.36, 1.3, 3.0, 5.0, 7.4, 10.5];
/// Half the thickness of the drawn coin, m.
const HALF_THICKNESS: f64 = 0.014;
/// Angle of the view below the horizontal, rad.
const PITCH: f64 = 0.5;

/// Writes the picture.
///
/// # Errors
///
/// Returns an error if the file cannot be written.
pub(crate) fn write(recording: &Recording, path: &Path) -> Outcome<()> {
    let film = Film::of(recording);
    let eye = Eye::on(film.moments);
    let text = TEMPLATE
        .replace("/*FILM*/", &format!("{FILM}s"))
        .replace("/*COIN*/", &keyframes(&film, &eye))
        .replace("<!--GRID-->", &grid(&eye))
        .replace("<!--TRACK-->", &track(&film, &eye))
        .replace("<!--GHOSTS-->", &ghosts(&film, &eye))
        .replace("<!--CURVE-->", &curve(&film))
        .replace("<!--START-->", &format!("{:.1}", film.energy()))
        .replace("<!--SECONDS-->", &format!("{:.0}", film.length()));
    write_file(path, text)
}

/// The moments of a run until the coin is at rest, played at increasing speed.
struct Film<'a> {
    moments: &'a [Moment],
}

impl<'a> Film<'a> {
    fn of(recording: &'a Recording) -> Self {
        let moments = recording.until(Milestones::of(recording).curtain());
        Self { moments }
    }

    /// Energy at the start, J.
    fn energy(&self) -> f64 {
        self.moments[0].energy.total()
    }

    /// Length of the run, simulated seconds.
    fn length(&self) -> f64 {
        self.moments[self.moments.len() - 1].time
    }

    /// Simulated time at a time of the film: `t + c t²`, in real time at the start. A short run has
    /// constant speed.
    fn time(&self, film: f64) -> f64 {
        let even = (self.length() / FILM).min(1.0);
        let faster = (self.length() - even * FILM) / (FILM * FILM);
        even * film + faster * film * film
    }

    /// Returns the moment that is shown at a time of the film.
    fn at(&self, film: f64) -> &'a Moment {
        let time = self.time(film);
        let next = self.moments.partition_point(|moment| moment.time < time);
        &self.moments[next.min(self.moments.len() - 1)]
    }
}

/// A parallel projection, in which the coin moves from left to right.
struct Eye {
    right: DVec3,
    up: DVec3,
    /// Direction from the scene to the viewer.
    out: DVec3,
    /// Pixels for each metre.
    scale: f64,
    /// Position of the scene's origin in the picture, pixels.
    origin: DVec2,
}

impl Eye {
    /// Creates a view of the whole run.
    fn on(moments: &[Moment]) -> Self {
        let travel = moments[moments.len() - 1].centre - moments[0].centre;
        let right = DVec3::new(travel.x, travel.y, 0.0)
            .try_normalize()
            .unwrap_or(DVec3::X);
        let away = DVec3::Z.cross(right);
        let (sin, cos) = PITCH.sin_cos();
        let mut eye = Self {
            right,
            up: DVec3::Z * cos + away * sin,
            out: DVec3::Z * sin - away * cos,
            scale: 1.0,
            origin: DVec2::ZERO,
        };
        eye.frame(moments);
        eye
    }

    /// Chooses scale and origin so that every coin of the run is in the picture.
    fn frame(&mut self, moments: &[Moment]) {
        let (mut least, mut most) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for moment in moments {
            let place = self.see(moment.centre);
            let [u, v] = in_plane(moment).map(|radius| self.see_way(radius));
            let bounding_radius = DVec2::new(u.x.hypot(v.x), u.y.hypot(v.y));
            least = least.min(place - bounding_radius);
            most = most.max(place + bounding_radius);
        }
        let room = DVec2::new(WIDTH, FLOOR_HEIGHT) - 2.0 * MARGIN;
        self.scale = (room / (most - least)).min_element();
        self.origin = DVec2::new(WIDTH, FLOOR_HEIGHT) / 2.0 - self.scale * (least + most) / 2.0;
    }

    /// Projects a position to pixels, with y down.
    fn see(&self, place: DVec3) -> DVec2 {
        self.origin + self.see_way(place)
    }

    /// Projects a displacement to pixels.
    fn see_way(&self, way: DVec3) -> DVec2 {
        self.scale * DVec2::new(way.dot(self.right), -way.dot(self.up))
    }

    /// Transform of a disc of radius 1 to one with this centre and these perpendicular radii, in
    /// the format of SVG and CSS.
    fn disc(&self, centre: DVec3, radii: [DVec3; 2]) -> String {
        let [u, v] = radii.map(|radius| self.see_way(radius));
        let c = self.see(centre);
        format!(
            "matrix({:.1},{:.1},{:.1},{:.1},{:.1},{:.1})",
            u.x, u.y, v.x, v.y, c.x, c.y
        )
    }
}

/// Two perpendicular radii of the coin. The first points to the mark.
fn in_plane(moment: &Moment) -> [DVec3; 2] {
    [DVec3::Y, DVec3::Z].map(|axis| moment.orientation * axis * RADIUS)
}

/// The coin as drawn at one moment: transforms of unit discs.
struct Drawn {
    face: String,
    middle: String,
    back: String,
    shadow: String,
    contact: DVec2,
    heads: bool,
}

impl Drawn {
    fn of(moment: &Moment, eye: &Eye) -> Self {
        let radii = in_plane(moment);
        let normal = moment.orientation * DVec3::X;
        let heads = normal.dot(eye.out) > 0.0;
        let side = if heads { 1.0 } else { -1.0 };
        let half = normal * side * HALF_THICKNESS;
        let level = |v: DVec3| DVec3::new(v.x, v.y, 0.0);
        Self {
            face: eye.disc(moment.centre + half, radii),
            middle: eye.disc(moment.centre, radii),
            back: eye.disc(moment.centre - half, radii),
            shadow: eye.disc(level(moment.centre), radii.map(level)),
            contact: eye.see(level(moment.lowest)),
            heads,
        }
    }

    /// Returns one coin that does not move.
    fn still(&self) -> String {
        let face = if self.heads { "heads" } else { "tails" };
        format!(
            "<g><use href=\"#edge-{face}\" transform=\"{}\"/><use href=\"#edge-{face}\" transform=\"{}\"/><use href=\"#{face}\" transform=\"{}\"/></g>\n",
            self.back, self.middle, self.face
        )
    }
}

/// CSS rules that move the coin, its shadow, the contact point and the cursor on the curve.
fn keyframes(film: &Film<'_>, eye: &Eye) -> String {
    let drawn = |when| Drawn::of(film.at(when), eye);
    let shown = |yes| format!("opacity:{}", u8::from(yes));
    [
        rule("face", |when| format!("transform:{}", drawn(when).face)),
        rule("middle", |when| format!("transform:{}", drawn(when).middle)),
        rule("back", |when| format!("transform:{}", drawn(when).back)),
        rule("shadow", |when| format!("transform:{}", drawn(when).shadow)),
        rule("heads", |when| shown(drawn(when).heads)),
        rule("tails", |when| shown(!drawn(when).heads)),
        rule("contact", |when| moved(drawn(when).contact)),
        rule("cursor", |when| moved(on_curve(film, film.at(when)))),
    ]
    .concat()
}

fn moved(to: DVec2) -> String {
    format!("transform:translate({:.1}px,{:.1}px)", to.x, to.y)
}

/// A CSS rule with the style at each frame of the film. Unchanged styles are not repeated.
fn rule(name: &str, style: impl Fn(f64) -> String) -> String {
    let mut text = format!("@keyframes {name}{{");
    let mut before = String::new();
    for picture in 0..PICTURES {
        let part = f64::from(picture) / f64::from(PICTURES);
        let now = style(part * FILM);
        if now != before {
            // Writing to a string does not fail.
            let _ = write!(text, "{:.2}%{{{now}}}", 100.0 * part);
        }
        before = now;
    }
    text + "}\n"
}

/// Lines on the floor every half metre, around the middle of the picture and beyond its edges.
fn grid(eye: &Eye) -> String {
    let middle = eye.right * ((WIDTH / 2.0 - eye.origin.x) / eye.scale);
    let x = (2.0 * middle.x).round() / 2.0;
    let y = (2.0 * middle.y).round() / 2.0;
    let see = |x, y| eye.see(DVec3::new(x, y, 0.0));
    let lines = (-16..=16).map(|k| {
        let at = 0.5 * f64::from(k);
        let along_y = line_through([see(x + at, y - 9.0), see(x + at, y + 9.0)]);
        let along_x = line_through([see(x - 9.0, y + at), see(x + 9.0, y + at)]);
        along_y + &along_x
    });
    lines.collect()
}

/// Track of the lowest point.
fn track(film: &Film<'_>, eye: &Eye) -> String {
    let lowest = film.moments.iter().map(|m| (m.lowest.x, m.lowest.y));
    let see = |(x, y)| eye.see(DVec3::new(x, y, 0.0));
    let pieces = pieces(&simplified(lowest, NEAR));
    let lines = pieces
        .into_iter()
        .map(|piece| line_through(piece.into_iter().map(see)));
    lines.collect()
}

/// Coins that stay in the picture.
fn ghosts(film: &Film<'_>, eye: &Eye) -> String {
    let ghost = |when: f64| Drawn::of(film.at(when), eye).still();
    GHOSTS.into_iter().map(ghost).collect()
}

/// Total energy over time.
fn curve(film: &Film<'_>) -> String {
    let some = film.moments.iter().step_by(8);
    line_through(some.map(|moment| on_curve(film, moment)))
}

/// Position of a moment on the curve of the energy.
fn on_curve(film: &Film<'_>, moment: &Moment) -> DVec2 {
    let energy = moment.energy.total() / film.energy();
    let part = DVec2::new(moment.time / film.length(), energy);
    CURVE_START + part * (CURVE_END - CURVE_START)
}

/// Path of an SVG through points in pixels, such as `M1 2L3 4`.
fn line_through(places: impl IntoIterator<Item = DVec2>) -> String {
    let mut path = String::new();
    for place in places {
        let command = if path.is_empty() { 'M' } else { 'L' };
        let _ = write!(path, "{command}{:.1} {:.1}", place.x, place.y);
    }
    path
}
