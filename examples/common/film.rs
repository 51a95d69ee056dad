//! A page that shows a run in three dimensions. It is `film.html` with the run written into it as
//! whole numbers, and needs no other file.

use std::path::Path;

use serde_json::{Value, json};
use tumble::glam::{DQuat, DVec3};
use tumble::{Energy, Sample};

use super::mesh::Mesh;
use super::{Outcome, write_file};

const TEMPLATE: &str = include_str!("film.html");
/// Placeholder of the run in the template.
const PLACE: &str = "/*RUN*/null";

/// Units of the whole numbers: s, fractions of the size, and fractions of a quaternion.
const TIME: f64 = 1e-4;
const LENGTH: f64 = 2e-4;
const ORIENTATION: f64 = 1e-4;

/// A recorded run.
#[derive(Debug)]
pub struct Film {
    pub title: String,
    /// Lines below the title.
    pub lines: Vec<String>,
    /// Half the size of the body, m: the radius of a coin.
    pub size: f64,
    /// Distance of the viewer from the point in view, in sizes.
    pub distance: f64,
    /// Factor by which the run is slowed down at first. It is one of the page's choices.
    pub slower: f64,
    pub bodies: Vec<Mesh>,
    /// Figures next to the picture.
    pub readouts: Vec<Column>,
    /// Curves below the picture, in one unit. The first is the main curve.
    pub curves: Vec<Column>,
    /// Marks on the curves.
    pub events: Vec<(&'static str, f64)>,
    /// Shots in order of time, at least two.
    pub shots: Vec<Shot>,
}

/// Meaning of a number of each shot.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    pub name: &'static str,
    pub unit: &'static str,
    /// Number of digits after the point.
    pub digits: i32,
    /// Colour of a curve: `ink`, `blue`, `green`, `orange` or `purple`.
    pub colour: &'static str,
}

impl Column {
    pub fn new(name: &'static str, unit: &'static str, digits: i32, colour: &'static str) -> Self {
        Self {
            name,
            unit,
            digits,
            colour,
        }
    }
}

/// Curves of the energy by kind, with the values of [`energies`].
pub fn energy_columns() -> Vec<Column> {
    [
        ("total", "ink"),
        ("gravity", "green"),
        ("rotation", "blue"),
        ("translation", "orange"),
        ("springs", "purple"),
    ]
    .map(|(name, colour)| Column::new(name, "J", 4, colour))
    .to_vec()
}

pub fn energies(energy: &Energy) -> [f64; 5] {
    [
        energy.total(),
        energy.gravity,
        energy.rotation,
        energy.translation,
        energy.springs,
    ]
}

/// A shot of the run at one time.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Time, s.
    pub time: f64,
    /// Pose of each body.
    pub poses: Vec<Pose>,
    /// Values of the readouts, then of the curves.
    pub values: Vec<f64>,
}

/// Pose of a body.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pose {
    /// Position of the mesh's origin, m.
    pub place: DVec3,
    /// Rotation from body to world axes.
    pub orientation: DQuat,
    /// Lowest point, m, which draws a track on the floor.
    pub lowest: DVec3,
}

impl Pose {
    /// Pose of a body whose mesh has its origin at the centre of mass.
    pub fn of(sample: &Sample<'_>) -> Self {
        let state = sample.state;
        let lowest = sample.lowest_point();
        Self {
            place: state.position,
            orientation: state.orientation,
            lowest: lowest.map_or(state.position, |lowest| lowest.position),
        }
    }

    /// Returns the pose shifted by a displacement.
    pub fn moved(self, way: DVec3) -> Self {
        Self {
            place: self.place + way,
            lowest: self.lowest + way,
            ..self
        }
    }
}

/// Takes shots of a run at equal intervals.
#[derive(Debug)]
pub struct Camera {
    /// Time of the first shot, s.
    start: f64,
    /// Interval between two shots, s.
    interval: f64,
    pub shots: Vec<Shot>,
}

impl Camera {
    pub fn new(interval: f64) -> Self {
        Self::starting(0.0, interval)
    }

    pub fn starting(start: f64, interval: f64) -> Self {
        Self {
            start,
            interval,
            shots: Vec::new(),
        }
    }

    /// Takes a shot if one is due, with these readouts and the energy by kind.
    pub fn look<const N: usize>(
        &mut self,
        sample: &Sample<'_>,
        readouts: impl FnOnce() -> [f64; N],
    ) {
        // Times are sums of steps, so they deviate by rounding.
        if sample.time < self.start + self.shots.len() as f64 * self.interval - 1e-9 {
            return;
        }
        let energies = energies(&sample.energy());
        self.shots.push(Shot {
            time: sample.time,
            poses: vec![Pose::of(sample)],
            values: [&readouts()[..], &energies].concat(),
        });
    }
}

impl Film {
    /// Writes the page.
    pub fn write(&self, path: &Path) -> Outcome<()> {
        let run = serde_json::to_string(&self.run())?;
        write_file(path, TEMPLATE.replace(PLACE, &run))
    }

    fn run(&self) -> Value {
        let shots = self.kept();
        let column = |unit: f64, value: &dyn Fn(&Shot) -> f64| differences(&shots, unit, value);
        let length = self.size * LENGTH;
        let actors: Vec<Value> = (0..self.bodies.len())
            .map(|k| self.actor(k, &shots))
            .collect();
        let columns = |columns: &[Column], first: usize| -> Vec<Value> {
            (columns.iter().enumerate())
                .map(|(k, c)| {
                    let numbers = column(0.1_f64.powi(c.digits + 1), &|shot| shot.values[first + k]);
                    json!({ "name": c.name, "unit": c.unit, "digits": c.digits, "colour": c.colour, "numbers": numbers })
                })
                .collect()
        };
        let mut colours = Vec::new();
        let bodies: Vec<Value> = (self.bodies.iter())
            .map(|mesh| mesh.faces(length, &mut colours))
            .collect();
        json!({
            "title": self.title,
            "lines": self.lines,
            "distance": 0.5 * self.distance,
            "slower": self.slower,
            "follow": self.bodies.iter().filter(|body| !body.is_ground()).count() / 2,
            // The page's lengths are scaled so that the size is one half.
            "units": { "time": TIME, "length": 0.5 * LENGTH, "orientation": ORIENTATION },
            "events": self.events,
            "colours": colours,
            "bodies": bodies,
            "time": column(TIME, &|shot| shot.time),
            "actors": actors,
            "readouts": columns(&self.readouts, 0),
            "curves": columns(&self.curves, self.readouts.len()),
        })
    }

    /// Course of a body.
    fn actor(&self, k: usize, shots: &[Shot]) -> Value {
        let length = self.size * LENGTH;
        let column = |unit: f64, value: &dyn Fn(&Shot) -> f64| differences(shots, unit, value);
        let centre = [0, 1, 2].map(|i| column(length, &|shot| shot.poses[k].place[i]));
        let orientation = [3, 0, 1, 2]
            .map(|i| column(ORIENTATION, &|shot| shot.poses[k].orientation.to_array()[i]));
        // On a level floor the track has no height.
        let is_level = !self.bodies.iter().any(Mesh::is_ground);
        let axes = if is_level { 0..2 } else { 0..3 };
        let contact: Vec<_> = axes
            .map(|i| column(length, &|shot| shot.poses[k].lowest[i]))
            .collect();
        json!({
            "body": k,
            "ground": self.bodies[k].is_ground(),
            "centre": centre,
            "orientation": orientation,
            "contact": contact,
        })
    }

    /// Returns the shots from which all of them can be drawn, including first and last.
    fn kept(&self) -> Vec<Shot> {
        let shots = with_steady_signs(&self.shots);
        let mut kept = vec![shots[0].clone()];
        let mut from = 0;
        while from + 1 < shots.len() {
            from = self.next(&shots, from);
            kept.push(shots[from].clone());
        }
        kept
    }

    /// Returns the farthest shot such that all shots between it and `from` lie on a line.
    fn next(&self, shots: &[Shot], from: usize) -> usize {
        let last = shots.len() - 1;
        let mut to = from + 1;
        while to < last && to - from < LONGEST && self.on_the_line(&shots[from..=to + 1]) {
            to += 1;
        }
        to
    }

    fn on_the_line(&self, stretch: &[Shot]) -> bool {
        let (first, last) = (&stretch[0], &stretch[stretch.len() - 1]);
        let span = last.time - first.time;
        stretch.iter().all(|shot| {
            let part = (shot.time - first.time) / span;
            (shot.poses.iter().zip(first.poses.iter().zip(&last.poses))).all(|(pose, (a, b))| {
                let place = a.place.lerp(b.place, part);
                let orientation = a.orientation * (1.0 - part) + b.orientation * part;
                let lowest = a.lowest.lerp(b.lowest, part);
                let leaps = a.lowest.distance(b.lowest) > LEAP * self.size;
                place.distance(pose.place) < NEAR * self.size
                    && (leaps || lowest.distance(pose.lowest) < NEAR_ON_FLOOR * self.size)
                    && (orientation - pose.orientation).length() < NEAR
            })
        })
    }
}

/// Deviation from the line between its neighbours within which a shot may be left out, in sizes and
/// in each part of the quaternion (half of an angle in radians).
const NEAR: f64 = 1e-3;
/// Deviation of the track on the floor within which a shot may be left out, in sizes.
const NEAR_ON_FLOOR: f64 = 0.02;
/// Distance, in sizes, beyond which the lowest point has jumped across the body, which leaves no
/// track.
const LEAP: f64 = 0.6;
/// Longest gap between two stored shots, in shots.
const LONGEST: usize = 100;

/// Returns the shots with continuous signs of the quaternions. `q` and `−q` are the same
/// orientation, but interpolation between them is a whole revolution.
fn with_steady_signs(shots: &[Shot]) -> Vec<Shot> {
    let mut before = shots[0].poses.clone();
    (shots.iter().cloned())
        .map(|mut shot| {
            for (pose, before) in shot.poses.iter_mut().zip(&before) {
                if pose.orientation.dot(before.orientation) < 0.0 {
                    pose.orientation = -pose.orientation;
                }
            }
            before.clone_from(&shot.poses);
            shot
        })
        .collect()
}

/// Returns each value in units as the difference from the previous one. Small numbers make a small
/// file.
fn differences(shots: &[Shot], unit: f64, value: &dyn Fn(&Shot) -> f64) -> Vec<i64> {
    let mut before = 0;
    (shots.iter())
        .map(|shot| {
            let now = whole(value(shot) / unit);
            let difference = now - before;
            before = now;
            difference
        })
        .collect()
}

/// Returns the nearest whole number, limited to the range of the type.
#[allow(clippy::cast_possible_truncation)] // The cast saturates, which is what is wanted.
pub(crate) fn whole(value: f64) -> i64 {
    value.round() as i64
}
