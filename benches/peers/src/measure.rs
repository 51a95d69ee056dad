//! Error, energy and cost of each program on a scene. The programs run alternately.

use cpu_time::ThreadTime;
use tumble::State;

use crate::programs::rapier::{Rapier, Tuning};
use crate::programs::{Program, ode, ours, plain, stiff};
use crate::scene::{Case, Scene, Shape};

/// Result of one program on one scene.
pub(crate) struct Row {
    pub(crate) name: String,
    pub(crate) settings: String,
    pub(crate) is_ours: bool,
    /// True if its state is sampled 240 times a second.
    pub(crate) is_sampled: bool,
    /// Outcome of the run, or the reason why the program failed.
    pub(crate) outcome: Result<Outcome, String>,
}

#[derive(Clone, Copy)]
pub(crate) struct Outcome {
    /// Error in the unit of the scene.
    pub(crate) error: f64,
    /// Largest increase of the energy above any earlier value, over the sum of the kinetic energy
    /// at the start and the weight times the length of the scene.
    pub(crate) rise: f64,
    pub(crate) steps: u64,
    /// Cost in CPU seconds for a simulated second: the median over the repetitions.
    pub(crate) price: f64,
    /// Cost over that of the cheapest row of tumble that is as accurate.
    pub(crate) ratio: Ratio,
}

/// Comparison of a cost with that of tumble.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Ratio {
    /// Ratio to the cost of tumble at the same accuracy.
    Times(f64),
    /// No row of tumble is as accurate.
    NotReached,
    /// The error is as large as the result.
    NoAnswer,
}

impl Outcome {
    /// Returns the cost of a step, ns.
    pub(crate) fn step(&self, scene: &Scene) -> f64 {
        self.price * scene.seconds / self.steps as f64 * 1e9
    }
}

/// Measures all programs on a scene.
pub(crate) fn rows(scene: &Scene, turns: usize) -> Result<Vec<Row>, String> {
    let mut programs = ours::programs(scene)?;
    programs.extend(peers(scene));
    let mut rows = rows_of(scene, &programs, turns)?;
    compare(scene, &mut rows);
    Ok(rows)
}

/// Measures error, energy and cost of some programs on a scene. Nothing is compared.
pub(crate) fn rows_of(
    scene: &Scene,
    programs: &[Box<dyn Program + '_>],
    turns: usize,
) -> Result<Vec<Row>, String> {
    let energy = ours::energy(scene)?;
    let mut rows = Vec::new();
    for program in programs {
        rows.push(Row {
            name: program.name(),
            settings: program.settings(),
            is_ours: program.is_ours(),
            is_sampled: program.is_sampled(),
            outcome: accuracy(scene, &**program, &energy),
        });
    }
    let prices = prices(scene, programs, &rows, turns);
    for (row, price) in rows.iter_mut().zip(prices) {
        if let Ok(outcome) = &mut row.outcome {
            outcome.price = price;
        }
    }
    Ok(rows)
}

/// Returns the adaptive methods of the library and the stiff method of `diffsol`, in one call. The
/// latter has tighter tolerances too.
pub(crate) fn programs_for_stick(scene: &Scene) -> Result<Vec<Box<dyn Program + '_>>, String> {
    let mut programs = ours::with_tolerances(scene, &ours::TOLERANCES, false)?;
    programs.extend(implicit(scene, &BDF, false));
    programs.extend(implicit(scene, &[1e-12, 1e-13], false));
    Ok(programs)
}

/// Returns all programs except the library.
fn peers(scene: &Scene) -> Vec<Box<dyn Program + '_>> {
    let mut all = plain(scene);
    for is_sampled in [false, true] {
        all.extend(explicit(scene, &DOPRI5, &DOP853, is_sampled));
        if scene.shape != Shape::Free {
            all.extend(implicit(scene, &BDF, is_sampled));
        }
    }
    all.extend(rapier(scene));
    all
}

/// Returns a Rk4 written by hand. In free flight, Euler's equations in body axes are included as
/// well.
fn plain(scene: &Scene) -> Vec<Box<dyn Program + '_>> {
    let (law, start, seconds) = (&scene.law, scene.soft.start, scene.seconds);
    let mut all: Vec<Box<dyn Program>> = Vec::new();
    for &time_step in &scene.plain_steps {
        all.push(Box::new(plain::PlainRk4 {
            law,
            start,
            seconds,
            time_step,
        }));
    }
    if scene.shape == Shape::Free {
        for &time_step in &scene.plain_steps {
            all.push(Box::new(plain::PlainEuler {
                law,
                start,
                seconds,
                time_step,
            }));
        }
    }
    all
}

/// Relative tolerances of each method, down to the limit set by rounding.
const DOPRI5: [f64; 9] = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11];
const DOP853: [f64; 10] = [
    1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13,
];
const BDF: [f64; 8] = [1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11];

/// Returns the explicit methods of `ode_solvers` with relative tolerances.
pub(crate) fn explicit<'a>(
    scene: &'a Scene,
    dopri5: &[f64],
    dop853: &[f64],
    is_sampled: bool,
) -> Vec<Box<dyn Program + 'a>> {
    let methods = (dopri5.iter())
        .map(|&tolerance| (ode::Method::Dopri5, tolerance))
        .chain((dop853.iter()).map(|&tolerance| (ode::Method::Dop853, tolerance)));
    let form = match scene.shape {
        Shape::Free => ode::Form::Body,
        _ => ode::Form::World,
    };
    let boxed = |(method, tolerance)| -> Box<dyn Program + 'a> {
        Box::new(ode::OdeSolvers {
            law: &scene.law,
            start: scene.soft.start,
            seconds: scene.seconds,
            method,
            form,
            tolerance,
            scale: scene.scale,
            is_sampled,
        })
    };
    methods.map(boxed).collect()
}

fn implicit<'a>(
    scene: &'a Scene,
    tolerances: &[f64],
    is_sampled: bool,
) -> Vec<Box<dyn Program + 'a>> {
    let boxed = |&tolerance: &f64| -> Box<dyn Program + 'a> {
        Box::new(stiff::Bdf {
            law: &scene.law,
            start: scene.soft.start,
            seconds: scene.seconds,
            tolerance,
            scale: scene.scale,
            is_sampled,
        })
    };
    tolerances.iter().map(boxed).collect()
}

fn rapier(scene: &Scene) -> Vec<Box<dyn Program + '_>> {
    let mut all: Vec<Box<dyn Program>> = Vec::new();
    all.push(Box::new(Rapier::<f32>::new(scene, Tuning::Default)));
    for &time_step in &scene.rapier_steps {
        all.push(best(scene, time_step, Rapier::<f32>::new));
    }
    all.push(Box::new(Rapier::<f64>::new(scene, Tuning::Default)));
    for &time_step in &scene.rapier_steps {
        all.push(best(scene, time_step, Rapier::<f64>::new));
    }
    all
}

/// Returns the most accurate of rapier's settings at a step size. It is tuned on this scene and its
/// result.
fn best<'a, P: Program + 'a>(
    scene: &'a Scene,
    time_step: f64,
    with: impl Fn(&'a Scene, Tuning) -> P,
) -> Box<dyn Program + 'a> {
    let error = |program: &P| match program.run(None) {
        Ok(end) => scene.error(&end.state, &scene.rigid.answer),
        Err(_) => f64::INFINITY,
    };
    let candidates = Tuning::all(time_step, scene)
        .into_iter()
        .map(|tuning| with(scene, tuning));
    let rated = candidates.map(|program| (error(&program), program));
    let (_, program) = rated
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .expect("there are settings to try");
    Box::new(program)
}

/// Measures error and energy of a run, without its cost.
fn accuracy(
    scene: &Scene,
    program: &dyn Program,
    energy: &dyn Fn(&State) -> f64,
) -> Result<Outcome, String> {
    let Case { start, answer } = if program.is_rigid() {
        scene.rigid
    } else {
        scene.soft
    };
    // The ground of rapier stores no energy.
    let energy = |state: &State| match program.is_rigid() {
        true => scene.law.energy_without_springs(state),
        false => energy(state),
    };
    let kinetic = scene.law.energy_without_springs(&State {
        position: start.position.with_z(0.0),
        ..start
    });
    let weight = scene.law.mass * scene.law.gravity * scene.scale.0;
    let (mut least, mut rise) = (f64::INFINITY, 0.0_f64);
    let mut watch = |state: &State| {
        let now = energy(state);
        rise = rise.max(now - least);
        least = least.min(now);
    };
    let end = program.run(Some(&mut watch))?;
    Ok(Outcome {
        error: scene.error(&end.state, &answer),
        rise: rise / (kinetic + weight),
        steps: end.steps,
        price: f64::NAN,
        ratio: Ratio::NoAnswer,
    })
}

/// Least CPU time of a repetition, s, so that the resolution of the clock does not matter.
const LEAST_TURN: f64 = 2e-3;

/// Most calls in a repetition.
const MOST_CALLS: u32 = 100_000;

/// Measures the CPU seconds for a simulated second. The programs run alternately, and each cost is
/// the median over the repetitions.
fn prices(
    scene: &Scene,
    programs: &[Box<dyn Program + '_>],
    rows: &[Row],
    turns: usize,
) -> Vec<f64> {
    let works = |i: usize| rows[i].outcome.is_ok();
    let calls: Vec<u32> = (programs.iter().enumerate())
        .map(|(i, program)| if works(i) { calls_of(&**program) } else { 0 })
        .collect();
    let mut samples = vec![Vec::new(); programs.len()];
    for _ in 0..turns {
        for (i, program) in programs.iter().enumerate().filter(|&(i, _)| works(i)) {
            let spent = seconds_of(&**program, calls[i]) / f64::from(calls[i]);
            samples[i].push(spent / scene.seconds);
        }
    }
    samples.into_iter().map(median).collect()
}

/// Number of calls that take [`LEAST_TURN`]. It is found by calls in a row, because a first one
/// that an interrupt or a cold memory delays says nothing about the next.
fn calls_of(program: &dyn Program) -> u32 {
    let mut calls = 1;
    while calls < MOST_CALLS && seconds_of(program, calls) < LEAST_TURN {
        calls = (2 * calls).min(MOST_CALLS);
    }
    calls
}

/// CPU time of some calls, s, without what a program prepares.
fn seconds_of(program: &dyn Program, calls: u32) -> f64 {
    let clock = ThreadTime::now();
    let mut preparation = 0.0;
    for _ in 0..calls {
        let end = core::hint::black_box(program.run(None));
        preparation += end.map_or(0.0, |end| end.preparation);
    }
    clock.elapsed().as_secs_f64() - preparation
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Factor within which a row of tumble counts as equally accurate. Two programs with the same
/// method differ by so much.
const AS_ACCURATE: f64 = 1.1;

/// Computes the cost of each row over that of the cheapest row of tumble that is as accurate.
fn compare(scene: &Scene, rows: &mut [Row]) {
    let ours = |is_sampled: bool| -> Vec<Outcome> {
        (rows.iter())
            .filter(|row| row.is_ours && row.is_sampled == is_sampled)
            .filter_map(|row| row.outcome.as_ref().ok().copied())
            .collect()
    };
    let ours = [ours(false), ours(true)];
    for row in rows {
        let ours = &ours[usize::from(row.is_sampled)];
        if let Ok(outcome) = &mut row.outcome {
            let enough = ours
                .iter()
                .filter(|ours| ours.error <= outcome.error * AS_ACCURATE);
            let cheapest = enough.map(|ours| ours.price).reduce(f64::min);
            outcome.ratio = match cheapest {
                _ if outcome.error > scene.useful || outcome.error.is_nan() => Ratio::NoAnswer,
                Some(price) => Ratio::Times(outcome.price / price),
                None => Ratio::NotReached,
            };
        }
    }
}
