//! The eight trials of the coin report in one call: the adaptive methods of tumble beside those of
//! `ode_solvers`.
//!
//! A tolerance counts for an error if every tighter one that was tried keeps the error as well, and
//! the cost of an error is the least cost of such a tolerance.

use tumble::State;

use crate::answers::coins;
use crate::measure::{self, Row};
use crate::programs::{Program, ode, ours};
use crate::scene::Scene;

/// Errors of position and of the rim, m, and the method of `ode_solvers` beside which they stand.
const ERRORS: [(f64, &str); 6] = [
    (1e-3, "ode_solvers Dopri5"),
    (1e-4, "ode_solvers Dopri5"),
    (1e-5, "ode_solvers Dopri5"),
    (1e-6, "ode_solvers Dop853"),
    (1e-8, "ode_solvers Dop853"),
    (1e-9, "ode_solvers Dop853"),
];

/// Methods of tumble.
const OURS: [&str; 4] = [
    "tumble DormandPrince54",
    "tumble BogackiShampine32",
    "tumble AdaptiveNystrom",
    "tumble Radau5",
];

/// Costs of a method on a trial over those of `ode_solvers`, one for each error.
pub(crate) struct Line {
    pub(crate) trial: usize,
    pub(crate) method: &'static str,
    pub(crate) ratios: [Option<f64>; ERRORS.len()],
}

/// Measures the eight trials, with a slip speed of 1e-3 m/s, for 1 s.
pub(crate) fn measure(turns: usize) -> Result<Vec<Line>, String> {
    let mut lines = Vec::new();
    for trial in 1..=8 {
        eprintln!("trial {trial} in one call ...");
        let mut scene = coins::trial_without_answer(trial)?;
        scene.soft.answer = answer(&scene)?;
        let mut programs = ours::with_tolerances(&scene, &tolerances(-2, -11), false)?;
        let (dopri5, dop853) = (tolerances(-2, -11), tolerances(-4, -13));
        programs.extend(measure::explicit(&scene, &dopri5, &dop853, false));
        let rows = measure::rows_of(&scene, &programs, turns)?;
        lines.extend(OURS.map(|method| Line {
            trial,
            method,
            ratios:
                ERRORS.map(|(error, peer)| {
                    Some(cost(&rows, method, error)? / cost(&rows, peer, error)?)
                }),
        }));
    }
    Ok(lines)
}

/// Returns four tolerances a decade.
fn tolerances(first: i32, last: i32) -> Vec<f64> {
    let quarters = 4 * last..=4 * first;
    (quarters.rev())
        .map(|quarter| 10_f64.powf(f64::from(quarter) / 4.0))
        .collect()
}

/// Returns the end of a trial.
///
/// It is that of `DormandPrince54` with a tolerance of 1e-12 m.
///
/// # Errors
///
/// Returns an error if Dop853 of `ode_solvers`, with its tightest tolerance, ends more than 1e-9 m
/// away: a tenth of the least error that Dop853 is compared at would be hidden otherwise.
pub(crate) fn answer(scene: &Scene) -> Result<State, String> {
    let end = |program: &dyn Program| program.run(None).map(|end| end.state);
    let ours = ours::with_tolerances(scene, &[1e-12], false)?;
    let answer = end(&*ours[0])?;
    let peer = ode::OdeSolvers {
        law: &scene.law,
        start: scene.soft.start,
        seconds: scene.seconds,
        method: ode::Method::Dop853,
        form: ode::Form::World,
        tolerance: 1e-13,
        scale: scene.scale,
        is_sampled: false,
    };
    let apart = scene.error(&end(&peer)?, &answer);
    if apart > 1e-9 {
        return Err(format!(
            "{}: the references differ by {apart:.1e} m",
            scene.name
        ));
    }
    Ok(answer)
}

/// Returns the least cost of the tolerances of a method that keep an error, as every tighter one
/// does. The tightest tolerances may take more steps than allowed, and are left out.
fn cost(rows: &[Row], method: &str, error: f64) -> Option<f64> {
    (rows.iter())
        .filter(|row| row.name == method)
        .rev()
        .skip_while(|row| row.outcome.is_err())
        .map_while(|row| {
            row.outcome
                .as_ref()
                .ok()
                .filter(|found| found.error <= error)
        })
        .map(|outcome| outcome.price)
        .min_by(f64::total_cmp)
}

/// Headings of the errors.
pub(crate) fn headings() -> Vec<String> {
    (ERRORS.iter())
        .map(|(error, peer)| format!("{error:.0e} m, {}", peer.trim_start_matches("ode_solvers ")))
        .collect()
}

/// Geometric mean and largest ratio of each method over the trials, for each error. A method that
/// misses an error in some trial has none.
pub(crate) fn summary(lines: &[Line]) -> Vec<(&'static str, [Option<(f64, f64)>; ERRORS.len()])> {
    let of_method = |method: &'static str| {
        let cells = core::array::from_fn(|column| {
            let ratios = lines.iter().filter(|line| line.method == method);
            let ratios: Vec<f64> = ratios
                .map(|line| line.ratios[column])
                .collect::<Option<_>>()?;
            let logarithms: f64 = ratios.iter().map(|ratio| ratio.ln()).sum();
            let mean = (logarithms / ratios.len() as f64).exp();
            Some((mean, ratios.into_iter().fold(0.0, f64::max)))
        });
        (method, cells)
    };
    OURS.map(of_method).into()
}
