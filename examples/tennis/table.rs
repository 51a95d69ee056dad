//! Tables: speeds and spins before and after the bounce, and the trajectories.

use std::path::Path;

use common::{Outcome, cannot, table};

use crate::Hit;
use crate::flight::{Flight, Moment};
use crate::model::RADIUS;
use crate::rigid;
use crate::shots::{NET, NET_HEIGHT};

const HEADER: [&str; 18] = [
    "shot",
    "air",
    "launch_speed_m_per_s",
    "launch_angle_deg",
    "launch_spin_rpm",
    "clearance_of_net_m",
    "bounce_x_m",
    "bounce_y_m",
    "bounce_time_s",
    "speed_before_m_per_s",
    "angle_before_deg",
    "spin_before_rpm",
    "speed_after_m_per_s",
    "angle_after_deg",
    "spin_after_rpm",
    "slip_after_m_per_s",
    "top_after_m",
    "second_bounce_x_m",
];

/// Writes `bounces.csv` and `trajectories.csv` into a folder.
pub(crate) fn write(hits: &[Hit], folder: &Path) -> Outcome<()> {
    let file = folder.join("bounces.csv");
    bounces(hits, &file).map_err(cannot("write", &file))?;
    let file = folder.join("trajectories.csv");
    trajectories(hits, &file).map_err(cannot("write", &file))?;
    Ok(())
}

/// Launch, landing and bounce of each shot.
fn bounces(hits: &[Hit], path: &Path) -> Result<(), csv::Error> {
    let mut bounces = csv::Writer::from_path(path)?;
    bounces.write_record(HEADER)?;
    for hit in hits {
        for (air, flight) in [("yes", &hit.in_air), ("no", &hit.without_air)] {
            bounces.write_record(row(hit, air, flight))?;
        }
    }
    bounces.flush()?;
    Ok(())
}

/// Height of the bottom of the ball over the net's middle, m. Empty if the ball lands before it.
fn clearance(flight: &Flight, places: usize) -> String {
    let height = flight.height_at(NET);
    height.map_or(String::new(), |height| {
        format!("{:.places$}", height - RADIUS - NET_HEIGHT)
    })
}

fn row(hit: &Hit, air: &str, flight: &Flight) -> [String; HEADER.len()] {
    let [before, after] = &flight.bounce;
    let landing = flight.landing();
    let launch = flight.path[0].turns();
    let slip = rigid::slip(after.velocity, after.spin).length();
    [
        hit.shot.name.to_owned(),
        air.to_owned(),
        hit.shot.speed.to_string(),
        format!("{:.4}", hit.angle),
        format!("{launch:.1}"),
        clearance(flight, 4),
        format!("{:.4}", landing.x),
        format!("{:.4}", landing.y),
        format!("{:.5}", before.time),
        format!("{:.4}", before.velocity.length()),
        format!("{:.4}", before.angle()),
        format!("{:.1}", before.turns()),
        format!("{:.4}", after.velocity.length()),
        format!("{:.4}", after.angle()),
        format!("{:.1}", after.turns()),
        format!("{slip:.4}"),
        format!("{:.4}", flight.top_after_bounce()),
        format!("{:.4}", flight.end().position.x),
    ]
}

/// Motion of each shot every 5 ms.
fn trajectories(hits: &[Hit], path: &Path) -> Result<(), csv::Error> {
    let mut file = csv::Writer::from_path(path)?;
    file.write_record([
        "shot",
        "air",
        "time_s",
        "x_m",
        "y_m",
        "z_m",
        "speed_m_per_s",
        "spin_rpm",
    ])?;
    for hit in hits {
        for (air, flight) in [("yes", &hit.in_air), ("no", &hit.without_air)] {
            for moment in flight.path.iter().step_by(5) {
                file.write_record([
                    hit.shot.name.to_owned(),
                    air.to_owned(),
                    format!("{:.5}", moment.time),
                    format!("{:.5}", moment.position.x),
                    format!("{:.5}", moment.position.y),
                    format!("{:.5}", moment.position.z),
                    format!("{:.4}", moment.velocity.length()),
                    format!("{:.1}", moment.turns()),
                ])?;
            }
        }
    }
    file.flush()?;
    Ok(())
}

/// Short table for the page.
pub(crate) fn short(hits: &[Hit]) -> String {
    let head = table::cells([
        "shot",
        "launch, m/s",
        "angle, °",
        "spin, rpm",
        "over the net, m",
        "before, m/s",
        "angle, °",
        "spin, rpm",
        "bounce",
        "after, m/s",
        "angle, °",
        "spin, rpm",
        "top, m",
        "farther without air, m",
    ]);
    let rows = hits.iter().map(|hit| {
        let flight = &hit.in_air;
        let [before, after] = &flight.bounce;
        let slip = rigid::slip(after.velocity, after.spin).length();
        // A ball that grips is left with some slip speeds.
        let how = if slip < 0.1 { "grips" } else { "slides" };
        let farther = hit.without_air.landing().x - flight.landing().x;
        [
            vec![hit.shot.name.to_owned()],
            motion(&flight.path[0]),
            vec![clearance(flight, 2)],
            motion(before),
            vec![how.to_owned()],
            motion(after),
            vec![
                format!("{:.2}", flight.top_after_bounce()),
                format!("{farther:.1}"),
            ],
        ]
        .concat()
    });
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(rows).collect();
    table::text(&rows)
}

/// Cells of speed, angle and spin.
fn motion(moment: &Moment) -> Vec<String> {
    let [speed, angle] = [moment.velocity.length(), moment.angle()];
    vec![
        format!("{speed:.1}"),
        format!("{angle:.1}"),
        format!("{:.0}", moment.turns()),
    ]
}
