//! Trial 1 of the report, and where it ends.

use core::error::Error;

use tumble::glam::{DQuat, DVec3};
use tumble::{State, Trial};

/// Simulated time, s.
pub(crate) const DURATION: f64 = 1.0;
/// m/s; the truth is known for this one, which an explicit method resolves.
pub(crate) const SLIP_SPEED: f64 = 1e-3;

/// The trial.
pub(crate) fn trial() -> Result<Trial<f64>, &'static str> {
    Ok(Trial {
        slip_speed: SLIP_SPEED,
        ..Trial::report(1).ok_or("the report has a trial 1")?
    })
}

/// How far apart two states of the coin are, m: the centres' distance, and how far the turn between
/// them moves the rim.
pub(crate) fn distance(a: &State, b: &State) -> f64 {
    // The arc cosine of the product, as glam has it, would tell no angles below 2e-8 from 0.
    let between = a.orientation * b.orientation.conjugate();
    let angle = 2.0 * between.xyz().length().atan2(between.w.abs());
    (a.position - b.position)
        .length()
        .hypot(Trial::<f64>::RADIUS * angle)
}

/// The state of trial 1 at the end, to 13 digits.
pub(crate) fn truth() -> Result<State, Box<dyn Error>> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/truth_table.csv");
    let mut table = csv::Reader::from_path(path)?;
    let headings = table.headers()?.clone();
    for line in table.records() {
        let line = line?;
        let number = |name: &str| -> Result<f64, Box<dyn Error>> {
            let column = headings
                .iter()
                .position(|heading| heading == name)
                .ok_or("the table lacks a column")?;
            Ok(line[column].parse()?)
        };
        if (number("trial")?, number("v_eps")?, number("t")?) == (1.0, SLIP_SPEED, DURATION) {
            let turn = DQuat::from_xyzw(number("qx")?, number("qy")?, number("qz")?, number("qw")?);
            return Ok(
                State::at(DVec3::new(number("x")?, number("y")?, number("z")?))
                    .with_orientation(turn),
            );
        }
    }
    Err("the table lacks trial 1 at its end".into())
}
