//! What do topspin, slice and air do to a tennis ball? Serves and ground strokes from the racket
//! through the bounce to the second bounce. The coin report names this as a further study.
//!
//! Run `cargo run --release --example tennis -- --help`.

// A program has the standard library. These lints are meant for the library.
#![allow(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

mod checks;
mod film;
mod flight;
mod model;
mod options;
mod pictures;
mod rigid;
mod shots;
mod table;

use std::process::ExitCode;

use common::{Outcome, Page, make_folder, program};

use flight::Flight;
use model::{Air, Court};
use options::Arguments;
use shots::Shot;

fn main() -> ExitCode {
    program(options::parse(), options::HELP, work)
}

/// A shot at its launch angle, with air and without.
struct Hit {
    shot: Shot,
    /// Angle of the launch above the horizontal, degrees. In air the ball then lands at the target.
    angle: f64,
    in_air: Flight,
    without_air: Flight,
}

fn work(arguments: &Arguments) -> Outcome<bool> {
    let (court, options) = (&arguments.court, &arguments.options);
    make_folder(&options.out.join("tennis"))?;
    let time_step = if options.quick { 1e-4 } else { 5e-5 };
    let mut hits = Vec::new();
    for shot in shots::all() {
        hits.push(hit(shot, court, time_step)?);
    }
    let page = Page {
        title: "Tennis: topspin, flat and slice",
        text: [text(court), vec![table::short(&hits)]].concat(),
        checks: checks::all(&hits, court, time_step)?,
        pictures: pictures::all(&hits)?,
        film: Some(film::film(&hits, court)),
    };
    let passed = page.write("tennis", options)?;
    table::write(&hits, &options.out.join("tennis"))?;
    Ok(passed)
}

fn hit(shot: Shot, court: &Court, time_step: f64) -> Outcome<Hit> {
    let angle = shots::aim(&shot, court)?;
    let flown = |air: &Air| {
        let stepper = model::stepper(court, air, time_step)?;
        flight::fly(&stepper, shot.start(&stepper, angle))
    };
    Ok(Hit {
        angle,
        in_air: flown(&Air::of_speed(shot.speed))?,
        without_air: flown(&Air::none())?,
        shot,
    })
}

fn text(court: &Court) -> Vec<String> {
    vec![
        format!(
            "Ground strokes are hit 1 m above the baseline and land 1 m inside the other baseline. \
             Serves are hit 2.7 m above it and land 0.6 m inside the service line. The launch \
             angle is chosen for that. Without air, the ball starts at the same angle. Court: {}, \
             friction {}, restitution {}.",
            court.name, court.friction, court.restitution
        ),
        "Air has a drag coefficient of 0.507 (Cross and Lindsey, Sports Eng. 17, 89, 2014) and a \
         lift coefficient of 1/(2 + v/(r ω)) (Stepanek, Am. J. Phys. 56, 138, 1988). Spin decays \
         by 2 % in 6.4 m at the launch speed (Cross and Lindsey)."
            .to_owned(),
        "The ball is a rigid shell on a spring and a damper, in contact for 5 ms. It slides \
         throughout the bounce, or it rolls at its end."
            .to_owned(),
        "A real ball grips: its friction reverses, with a tangential restitution e of 0.10 to 0.17 \
         (Cross, Am. J. Phys. 70, 1093, 2002). The model has e = 0. With another e, a ball that \
         slips at u before the bounce would lose e u β/(1 + β) more of its speed, and its rim \
         would gain e u/(1 + β). The normal force on a real ball acts ahead of its centre, its \
         moment of inertia is 0.55 m r² instead of β m r² with β = 2/3, and its restitution \
         depends on speed and angle (Cross, Sports Eng. 23, 9, 2020)."
            .to_owned(),
    ]
}
