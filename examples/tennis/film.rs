//! The film: the three ground strokes side by side.

use common::{Column, Film, Mesh, Pose, Shot, mesh};
use tumble::glam::DVec3;

use crate::Hit;
use crate::flight::{Flight, Moment};
use crate::model::{Court, RADIUS};
use crate::shots::Stroke;

/// Factor by which the balls are drawn larger than they are.
const ENLARGED: f64 = 8.0;
/// Distance between the paths, m.
const LANE: f64 = 1.5;

/// Film of the ground strokes in air.
pub(crate) fn film(hits: &[Hit], court: &Court) -> Film {
    let strokes = hits.iter().filter(|hit| hit.shot.stroke == Stroke::Ground);
    let flights: Vec<&Flight> = strokes.map(|hit| &hit.in_air).collect();
    let count = flights.iter().map(|flight| flight.path.len()).max();
    let ball = |colour| {
        Mesh::ellipsoid(
            DVec3::ZERO,
            DVec3::splat(ENLARGED * RADIUS),
            [colour, mesh::IVORY],
            [mesh::SAND; 2],
        )
    };
    let spin = |name| Column::new(name, "rpm", 0, "ink");
    let speed = |name, colour| Column::new(name, "m/s", 1, colour);
    let bounced = |flight: &Flight| flight.bounce[0].time;
    let names = ["topspin", "flat", "slice"];
    Film {
        title: "Tennis: topspin, flat and slice".to_owned(),
        lines: vec![format!(
            "Ground strokes in air on the {} court: topspin orange, flat blue, slice green. The \
             balls are drawn {ENLARGED} times as large. Dashed lines mark the bounces.",
            court.name
        )],
        size: ENLARGED * RADIUS,
        distance: 42.0,
        slower: 4.0,
        bodies: vec![ball(mesh::ORANGE), ball(mesh::BLUE), ball(mesh::GREEN)],
        readouts: vec![
            spin("topspin: spin"),
            spin("flat: spin"),
            spin("slice: spin"),
        ],
        curves: vec![
            speed("speed: topspin", "orange"),
            speed("flat", "blue"),
            speed("slice", "green"),
        ],
        events: names
            .into_iter()
            .zip(flights.iter().map(|f| bounced(f)))
            .collect(),
        shots: (0..count.unwrap_or(0)).map(|k| shot(&flights, k)).collect(),
    }
}

/// Shot of all balls at one time. A ball that has bounced twice stays where it is.
fn shot(flights: &[&Flight], k: usize) -> Shot {
    let moments: Vec<&Moment> = (flights.iter())
        .map(|flight| &flight.path[k.min(flight.path.len() - 1)])
        .collect();
    let lanes = moments.iter().zip([LANE, 0.0, -LANE]);
    let spins = moments.iter().map(|moment| moment.turns());
    let speeds = moments.iter().map(|moment| moment.velocity.length());
    Shot {
        time: moments.iter().map(|moment| moment.time).fold(0.0, f64::max),
        poses: lanes.map(|(moment, lane)| pose(moment, lane)).collect(),
        values: spins.chain(speeds).collect(),
    }
}

fn pose(moment: &Moment, lane: f64) -> Pose {
    let place = moment.position + DVec3::Y * lane;
    Pose {
        // The bottom of the enlarged ball is that of the ball.
        place: place + DVec3::Z * ((ENLARGED - 1.0) * RADIUS),
        orientation: moment.orientation,
        lowest: place - DVec3::Z * RADIUS,
    }
}
