//! The run as a table, `coin.csv`, with a row for each moment and units in the header.

use std::path::Path;

use crate::milestones::Milestones;
use crate::recording::{Moment, Recording};

const HEADER: [&str; 24] = [
    "time_s",
    "x_m",
    "y_m",
    "z_m",
    "velocity_x_m_per_s",
    "velocity_y_m_per_s",
    "velocity_z_m_per_s",
    "orientation_w",
    "orientation_x",
    "orientation_y",
    "orientation_z",
    "angular_momentum_x_kg_m2_per_s",
    "angular_momentum_y_kg_m2_per_s",
    "angular_momentum_z_kg_m2_per_s",
    "lowest_x_m",
    "lowest_y_m",
    "lowest_z_m",
    "slip_m_per_s",
    "tilt_deg",
    "points_in_contact",
    "energy_translation_J",
    "energy_rotation_J",
    "energy_gravity_J",
    "energy_springs_J",
];

/// Writes a row for every `every`-th moment. The table ends when the coin has settled.
pub(crate) fn write(recording: &Recording, path: &Path, every: usize) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    table.write_record(HEADER)?;
    let shown = recording.until(Milestones::of(recording).curtain());
    for moment in shown.iter().step_by(every) {
        table.write_record(row(moment))?;
    }
    table.flush()?;
    Ok(())
}

/// Formats numbers with as many digits as are needed to read the same numbers back.
fn row(moment: &Moment) -> [String; HEADER.len()] {
    let q = moment.orientation;
    let energy = moment.energy;
    [
        // A time is a whole number of steps. Six decimals remove its rounding.
        format!("{:.6}", moment.time),
        moment.centre.x.to_string(),
        moment.centre.y.to_string(),
        moment.centre.z.to_string(),
        moment.velocity.x.to_string(),
        moment.velocity.y.to_string(),
        moment.velocity.z.to_string(),
        q.w.to_string(),
        q.x.to_string(),
        q.y.to_string(),
        q.z.to_string(),
        moment.angular_momentum.x.to_string(),
        moment.angular_momentum.y.to_string(),
        moment.angular_momentum.z.to_string(),
        moment.lowest.x.to_string(),
        moment.lowest.y.to_string(),
        moment.lowest.z.to_string(),
        moment.slip.to_string(),
        moment.tilt.to_degrees().to_string(),
        moment.touching.to_string(),
        energy.translation.to_string(),
        energy.rotation.to_string(),
        energy.gravity.to_string(),
        energy.springs.to_string(),
    ]
}
