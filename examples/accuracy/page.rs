//! Page: error over step size for each integrator with fixed steps.

use std::path::Path;

use common::{
    BLACK, BLUE, Check, GREEN, GREY, ORANGE, Options, Outcome, PURPLE, Page, Picture, line,
    make_folder,
};
use kuva::prelude::*;
use tumble::{
    EnergyMomentum, ForwardEuler, Integrator, Nystrom, Rk4, State, StrangSplitting, SymplecticEuler,
};

use crate::truth::{DURATION, distance, trial, truth};

/// Step sizes (s) and errors (m). Each step size divides the second.
type Curve = Vec<(f64, f64)>;
/// Name of a method, its colour and its errors.
type Named = (&'static str, &'static str, Curve);

/// Numbers of steps in the second. The order is measured between the last two.
const COUNTS: [u32; 12] = [
    60, 100, 160, 250, 400, 640, 1000, 1600, 2500, 4000, 5000, 10_000,
];

/// Writes the page into a folder. Returns true if all figures are as expected.
pub(crate) fn write(out: &Path) -> Outcome<bool> {
    make_folder(&out.join("accuracy"))?;
    let curves = curves(&truth()?)?;
    let page = Page {
        title: "Error and step size of every integrator with a fixed step",
        text: vec![
            "Trial 1 of the coin report for a second, compared with a solution of 13 digits. The \
             error is the root of the sum of two squares: the distance of the centres, and the \
             displacement of the rim by the rotation between the two states."
                .to_owned(),
            "Points of the rim touch down and lift off, where the derivatives of the force jump. \
             Methods of high order therefore do not reach their order on this scene."
                .to_owned(),
        ],
        checks: checks(&curves),
        pictures: vec![picture(&curves)?],
        film: None,
    };
    let options = Options {
        out: out.into(),
        quick: false,
    };
    page.write("accuracy", &options)
}

/// Errors of each method with a fixed step size.
fn curves(truth: &State) -> Outcome<[Named; 6]> {
    Ok([
        (
            "ForwardEuler",
            GREY,
            curve(truth, |time_step| ForwardEuler { time_step })?,
        ),
        (
            "SymplecticEuler",
            ORANGE,
            curve(truth, |time_step| SymplecticEuler { time_step })?,
        ),
        (
            "StrangSplitting",
            GREEN,
            curve(truth, |time_step| StrangSplitting { time_step })?,
        ),
        (
            "EnergyMomentum",
            BLACK,
            curve(truth, |time_step| EnergyMomentum { time_step })?,
        ),
        ("Rk4", BLUE, curve(truth, |time_step| Rk4 { time_step })?),
        (
            "Nystrom",
            PURPLE,
            curve(truth, |time_step| Nystrom { time_step })?,
        ),
    ])
}

fn curve<I: Integrator>(truth: &State, integrator: impl Fn(f64) -> I) -> Outcome<Curve> {
    let mut curve = Curve::new();
    for count in COUNTS {
        let (trial, time_step) = (trial()?, DURATION / f64::from(count));
        let stepper = trial.stepper(integrator(time_step))?;
        let mut state = trial.state();
        stepper.advance(&mut state, DURATION)?;
        curve.push((time_step, distance(&state, truth)));
    }
    Ok(curve)
}

fn checks(curves: &[Named]) -> Vec<Check> {
    let expected = [
        ("ForwardEuler", 1.0),
        ("SymplecticEuler", 1.0),
        ("EnergyMomentum", 2.0),
    ];
    let mut checks = Vec::new();
    for (name, order) in expected {
        let found = curves.iter().find(|(known, ..)| *known == name);
        let Some([.., coarse, fine]) = found.map(|(.., curve)| &curve[..]) else {
            continue;
        };
        checks.push(Check::near(
            &format!("{name}: order of the error between 0.2 ms and 0.1 ms"),
            "order of the method",
            (coarse.1 / fine.1).ln() / (coarse.0 / fine.0).ln(),
            order,
            0.2,
        ));
    }
    checks
}

fn picture(curves: &[Named]) -> Outcome<Picture> {
    // The coin has a radius of half a metre: a larger error says nothing.
    let plots = curves.iter().map(|(name, colour, curve)| {
        let shown = curve.iter().filter(|(_, error)| *error < 1.0);
        let shown = shown.map(|&(step, error)| (1e3 * step, error));
        line(shown.collect(), colour, name)
    });
    Picture::new("error", plots.collect(), |layout| {
        layout
            .with_title("trial 1 of the coin report: error after 1 s")
            .with_x_label("step size (ms)")
            .with_y_label("error (m)")
            .with_log_x()
            .with_log_y()
            .with_legend_position(LegendPosition::OutsideRightTop)
    })
}
