//! Fit of the parameters that minimise the mean error over some tosses.

use argmin::core::{CostFunction, Error, Executor, State as _};
use argmin::solver::neldermead::NelderMead;
use indicatif::ProgressBar;

use crate::model::{Corrections, Model, Parameters, Score, Start, WIDTH, scores};
use crate::tosses::Toss;
use common::Outcome;

/// Set of the free parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Free {
    /// Stiffness, damping, friction with its transition load if it has one, and slip speed.
    Ground,
    /// The parameters of the ground, the inertia and the corner radius.
    GroundAndBody,
}

/// Free parameters, each with its step. A simplex moves in steps of about 1, and each parameter is
/// multiplied by the exponential of its coordinate times the step.
fn numbers(parameters: &mut Parameters, free: Free) -> Vec<(&mut f64, f64)> {
    let mut numbers = vec![
        (&mut parameters.stiffness, 0.3),
        (&mut parameters.damping, 0.3),
        (&mut parameters.coefficient, 0.3),
        (&mut parameters.slip_speed, 0.5),
    ];
    numbers.extend(parameters.transition_load.as_mut().map(|load| (load, 0.7)));
    if free == Free::GroundAndBody {
        let Corrections {
            inertia,
            corner_radius,
            ..
        } = &mut parameters.body;
        numbers.extend([(inertia, 0.05), (corner_radius, 0.5)]);
    }
    numbers
}

/// Parameters at some coordinates relative to a first guess.
fn at(mut guess: Parameters, free: Free, coordinates: &[f64]) -> Parameters {
    for ((number, step), coordinate) in numbers(&mut guess, free).into_iter().zip(coordinates) {
        *number *= (coordinate * step).exp();
    }
    guess.body.corner_radius = guess.body.corner_radius.min(0.4 * WIDTH);
    guess
}

/// Objective of the simplex: the error at a point.
struct Cost<'a> {
    tosses: &'a [Toss],
    guess: Parameters,
    free: Free,
    start: Start,
    steps: u32,
    bar: &'a ProgressBar,
}

impl CostFunction for Cost<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, coordinates: &Self::Param) -> Result<f64, Error> {
        let parameters = at(self.guess, self.free, coordinates);
        self.bar.inc(1);
        let Ok(model) = Model::new(&parameters, self.steps) else {
            return Ok(f64::MAX);
        };
        let score = Score::mean(scores(&model, self.tosses, self.start).iter());
        // One percent of the width counts like one degree.
        Ok(score.position + score.rotation)
    }
}

/// Returns the parameters that predict some tosses best, from a first guess.
pub(crate) fn fit(
    tosses: &[Toss],
    guess: Parameters,
    (free, start): (Free, Start),
    steps: u32,
    iterations: u64,
    bar: &ProgressBar,
) -> Outcome<Parameters> {
    let count = numbers(&mut guess.clone(), free).len();
    let mut simplex = vec![vec![0.0; count]];
    for k in 0..count {
        let mut corner = vec![0.0; count];
        corner[k] = 1.0;
        simplex.push(corner);
    }
    let cost = Cost {
        tosses,
        guess,
        free,
        start,
        steps,
        bar,
    };
    let result = Executor::new(cost, NelderMead::new(simplex).with_sd_tolerance(1e-4)?)
        .configure(|state| state.max_iters(iterations))
        .run()?;
    let best = result
        .state()
        .get_best_param()
        .ok_or("the fit tried nothing")?;
    Ok(at(guess, free, best))
}
