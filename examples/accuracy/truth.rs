//! Trial 1 of the coin report, and its exact end.

use core::error::Error;

use common::cannot;
use tumble::glam::{DQuat, DVec3};
use tumble::{State, Trial};

/// Simulated time, s.
pub(crate) const DURATION: f64 = 1.0;
/// Slip speed, m/s. The exact solution is known for it, and an explicit method resolves it.
pub(crate) const SLIP_SPEED: f64 = 1e-3;

/// Returns the trial.
pub(crate) fn trial() -> Result<Trial<f64>, &'static str> {
    Ok(Trial {
        slip_speed: SLIP_SPEED,
        ..Trial::report(1).ok_or("the report has a trial 1")?
    })
}

/// Distance between two states of the coin, m: the root of the sum of two squares, the distance of
/// the centres and the displacement of the rim by the rotation between the states.
pub(crate) fn distance(a: &State, b: &State) -> f64 {
    // The arc cosine of the product, as in glam, does not resolve angles below 2e-8.
    let between = a.orientation * b.orientation.conjugate();
    let angle = 2.0 * between.xyz().length().atan2(between.w.abs());
    (a.position - b.position)
        .length()
        .hypot(Trial::<f64>::RADIUS * angle)
}

/// State of trial 1 at the end, to 13 digits.
pub(crate) fn truth() -> Result<State, Box<dyn Error>> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/data/truth_table.csv");
    let mut table = csv::Reader::from_path(path).map_err(cannot("read", path.as_ref()))?;
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
