//! Fitting: the parameters at which the mean error over some tosses is least.

use argmin::core::{CostFunction, Error, Executor, State as _};
use argmin::solver::neldermead::NelderMead;
use indicatif::ProgressBar;

use crate::common::Outcome;
use crate::model::{Corrections, Model, Parameters, Score, WIDTH, scores};
use crate::tosses::Toss;

/// Which of the parameters are free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Free {
    /// Stiffness, damping, friction, slip speed.
    Ground,
    /// These, inertia and corner radius.
    GroundAndBody,
}

/// A simplex moves in steps of about 1: each parameter is multiplied by the exponential of its coordinate times this.
const STEPS: [f64; 6] = [0.3, 0.3, 0.3, 0.5, 0.05, 0.5];

impl Free {
    fn count(self) -> usize {
        match self {
            Self::Ground => 4,
            Self::GroundAndBody => 6,
        }
    }

    /// The parameters at some coordinates from a first guess.
    fn at(self, guess: &Parameters, coordinates: &[f64]) -> Parameters {
        let mut moved = [0.0; 6];
        for (moved, (coordinate, step)) in moved.iter_mut().zip(coordinates.iter().zip(STEPS)) {
            *moved = coordinate * step;
        }
        let factor = moved.map(f64::exp);
        Parameters {
            stiffness: guess.stiffness * factor[0],
            damping: guess.damping * factor[1],
            coefficient: guess.coefficient * factor[2],
            slip_speed: guess.slip_speed * factor[3],
            body: Corrections {
                inertia: guess.body.inertia * factor[4],
                corner_radius: (guess.body.corner_radius * factor[5]).min(0.4 * WIDTH),
                ..guess.body
            },
        }
    }
}

/// What the simplex asks: the error at a place.
struct Cost<'a> {
    tosses: &'a [Toss],
    guess: Parameters,
    free: Free,
    steps: u32,
    bar: &'a ProgressBar,
}

impl CostFunction for Cost<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, coordinates: &Self::Param) -> Result<f64, Error> {
        let parameters = self.free.at(&self.guess, coordinates);
        self.bar.inc(1);
        let Ok(model) = Model::new(&parameters, self.steps) else {
            return Ok(f64::MAX);
        };
        let score = Score::mean(scores(&model, self.tosses).iter());
        // A percent of the width counts like a degree.
        Ok(score.position + score.rotation)
    }
}

/// The parameters that predict some tosses best, from a first guess.
pub(crate) fn fit(
    tosses: &[Toss],
    guess: Parameters,
    free: Free,
    steps: u32,
    iterations: u64,
    bar: &ProgressBar,
) -> Outcome<Parameters> {
    let mut simplex = vec![vec![0.0; free.count()]];
    for k in 0..free.count() {
        let mut corner = vec![0.0; free.count()];
        corner[k] = 1.0;
        simplex.push(corner);
    }
    let cost = Cost {
        tosses,
        guess,
        free,
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
    Ok(free.at(&guess, best))
}
