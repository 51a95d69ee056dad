//! The page with the animation of the run.

use std::path::Path;

use crate::milestones::{Milestones, Skidding};
use crate::recording::{Moment, Recording};
use crate::setup::RADIUS;
use common::{Column, Film, Mesh, Outcome, Pose, Shot, energies, energy_columns};

/// Writes the page.
pub(crate) fn write(recording: &Recording, path: &Path) -> Outcome<()> {
    let setup = &recording.setup;
    let milestones = Milestones::of(recording);
    let shown = recording.until(milestones.curtain());
    let mut lines = vec![setup.parameters(), setup.computation()];
    if shown.len() < recording.moments.len() {
        lines.push(format!(
            "The run lasts {} s; the film ends when the coin is at rest.",
            setup.duration
        ));
    }
    if matches!(milestones.skidding, Skidding::Until(_)) {
        lines.push(
            "The skid ends where the slip falls below 10 % of its first value for 0.1 s."
                .to_owned(),
        );
    }
    lines.push(
        "The ring has no thickness. It is drawn with one, so that its faces can be told apart."
            .to_owned(),
    );
    // A few points make a polygon with the points as corners. Many points look round.
    let corners = if setup.points < 30 { setup.points } else { 120 };
    let film = Film {
        title: format!("{} of the coin", setup.title()),
        lines,
        size: RADIUS,
        distance: 5.4,
        slower: 1.0,
        bodies: vec![Mesh::coin(RADIUS, corners)],
        readouts: vec![
            Column::new("energy", "J", 3, "ink"),
            Column::new("angle to floor", "°", 1, "ink"),
            Column::new("slip speed", "m/s", 3, "ink"),
        ],
        curves: energy_columns(),
        events: milestones.events(),
        shots: shown.iter().map(shot).collect(),
    };
    film.write(path)
}

fn shot(moment: &Moment) -> Shot {
    let energy = &moment.energy;
    Shot {
        time: moment.time,
        poses: vec![Pose {
            place: moment.centre,
            orientation: moment.orientation,
            lowest: moment.lowest,
        }],
        values: [
            &[energy.total(), moment.tilt.to_degrees(), moment.slip][..],
            &energies(energy),
        ]
        .concat(),
    }
}
