//! The page that plays the run: `page.html` with the run written into it as whole numbers.

use std::error::Error;
use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::frames::kept;
use crate::milestones::Milestones;
use crate::recording::{Moment, Recording};
use crate::setup::RADIUS;

const TEMPLATE: &str = include_str!("page.html");
/// Where the run goes in the template.
const PLACE: &str = "/*RUN*/null";

/// What one unit of each whole number means.
const TIME: f64 = 1e-4;
const LENGTH: f64 = 1e-4;
const ORIENTATION: f64 = 1e-4;
const SPEED: f64 = 1e-3;
const ENERGY: f64 = 1e-4;

/// Writes the page.
pub(crate) fn write(recording: &Recording, path: &Path) -> Result<(), Box<dyn Error>> {
    let run = serde_json::to_string(&run(recording))?;
    fs::write(path, TEMPLATE.replace(PLACE, &run))?;
    Ok(())
}

fn run(recording: &Recording) -> Value {
    let setup = &recording.setup;
    let milestones = Milestones::of(recording);
    json!({
        "title": format!("{} of the coin", setup.title()),
        "knobs": setup.knobs(),
        "computation": setup.computation(),
        "radius": RADIUS,
        "points": setup.points,
        "units": {
            "time": TIME,
            "length": LENGTH,
            "orientation": ORIENTATION,
            "speed": SPEED,
            "energy": ENERGY,
        },
        "events": milestones.events(),
        "duration": setup.duration,
        "frames": frames(&kept(recording.until(milestones.curtain()))),
    })
}

fn frames(moments: &[Moment]) -> Value {
    let column = |unit, value: fn(&Moment) -> f64| differences(moments.iter().map(value), unit);
    json!({
        "time": column(TIME, |moment| moment.time),
        "centre": [
            column(LENGTH, |moment| moment.centre.x),
            column(LENGTH, |moment| moment.centre.y),
            column(LENGTH, |moment| moment.centre.z),
        ],
        "orientation": [
            column(ORIENTATION, |moment| moment.orientation.w),
            column(ORIENTATION, |moment| moment.orientation.x),
            column(ORIENTATION, |moment| moment.orientation.y),
            column(ORIENTATION, |moment| moment.orientation.z),
        ],
        "slip": column(SPEED, |moment| moment.slip),
        "energy": {
            "gravity": column(ENERGY, |moment| moment.energy.gravity),
            "rotation": column(ENERGY, |moment| moment.energy.rotation),
            "translation": column(ENERGY, |moment| moment.energy.translation),
            "springs": column(ENERGY, |moment| moment.energy.springs),
        },
    })
}

/// Each value in units, as the difference to the one before: small numbers, a small file.
fn differences(values: impl Iterator<Item = f64>, unit: f64) -> Vec<i64> {
    let mut before = 0;
    values
        .map(|value| {
            let now = whole(value / unit);
            let difference = now - before;
            before = now;
            difference
        })
        .collect()
}

/// The nearest whole number; the ends of the range stand for what is beyond them.
#[allow(clippy::cast_possible_truncation)] // The cast saturates, which is what is wanted.
fn whole(value: f64) -> i64 {
    value.round() as i64
}
