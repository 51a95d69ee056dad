//! Labels that change under a smaller tolerance, the time on one thread and on many, and the cost
//! of many tosses.

use std::time::Instant;

use tumble::ensemble::Ensemble;

use crate::Arguments;
use crate::scene::{self, CoinThrow};
use common::{Outcome, marked, say};

pub(crate) fn label_error(arguments: &Arguments) -> Outcome<()> {
    let tables = [scene::TOLERANCE, 0.01 * scene::TOLERANCE].map(scene::table);
    let [coarse, fine] = tables;
    let (coarse, fine) = (coarse?, fine?);
    let (coarse, fine) = (scene::throw(&coarse)?, scene::throw(&fine)?);
    let ensemble = scene::ensemble(&coarse, arguments.seed);
    let tosses = arguments.tosses.clone();
    let pairs = ensemble.compare(tosses, |toss| coarse.play(toss), |toss| fine.play(toss))?;
    let [low, high] = pairs.label_error(0.95)?;
    say(format_args!("{pairs}\n"));
    say(format_args!(
        "labels that change at a hundredth of the tolerance: {} of {}, 95 % interval [{low:.4}, \
         {high:.4}]\n",
        pairs.changed(),
        pairs.compared()
    ));
    Ok(())
}

/// Repetitions of the measurement, of which the fastest counts on each side: other programs only
/// lengthen a time.
const REPETITIONS: usize = 5;

/// Time of all tosses on the threads of the pool, s.
fn seconds(
    arguments: &Arguments,
    ensemble: &Ensemble,
    throw: &CoinThrow<'_>,
) -> Result<f64, String> {
    let clock = Instant::now();
    let tally = ensemble.run(arguments.tosses.clone(), |toss| throw.play(toss));
    tally.map_err(|error| error.to_string())?;
    Ok(clock.elapsed().as_secs_f64())
}

/// Plays the same tosses on one thread and on all threads of the pool, in turns.
pub(crate) fn efficiency(arguments: &Arguments) -> Outcome<()> {
    let table = scene::table(scene::TOLERANCE)?;
    let throw = scene::throw(&table)?;
    let ensemble = scene::ensemble(&throw, arguments.seed);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let time = || seconds(arguments, &ensemble, &throw);
    let threads = rayon::current_num_threads();
    let mut best = [f64::INFINITY; 2];
    for _ in 0..REPETITIONS {
        best[0] = best[0].min(one.install(time)?);
        best[1] = best[1].min(time()?);
    }
    let tosses = arguments.tosses.end - arguments.tosses.start;
    say(format_args!(
        "{tosses} tosses: {:.3} s on one thread, {:.3} s on {threads}; efficiency {:.3}\n",
        best[0],
        best[1],
        best[0] / best[1] / threads as f64
    ));
    Ok(())
}

const BEGIN: &str = "<!-- cost of tosses: begin; written by `tosses -- --cost --write` -->";
const END: &str = "<!-- cost of tosses: end -->";

/// Prints the time of a toss on one core, and what many tosses cost.
pub(crate) fn cost(arguments: &Arguments) -> Outcome<()> {
    let table = scene::table(scene::TOLERANCE)?;
    let throw = scene::throw(&table)?;
    let ensemble = scene::ensemble(&throw, arguments.seed);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let time = || seconds(arguments, &ensemble, &throw);
    let mut best = f64::INFINITY;
    for _ in 0..REPETITIONS {
        best = best.min(one.install(time)?);
    }
    let tosses = arguments.tosses.end - arguments.tosses.start;
    let seconds = best / tosses as f64;
    let text = cost_table(tosses, seconds);
    say(&text);
    if arguments.write {
        marked::write("src/guide/outcomes.md", [BEGIN, END], &text)?;
    }
    Ok(())
}

/// Core-hours of ensembles of several sizes, for the time of a toss on one core.
fn cost_table(tosses: u64, seconds: f64) -> String {
    let mut text = format!(
        "A toss of the coin of `examples/tosses` takes {:.2} ms on one core, in the fastest of\n\
         {REPETITIONS} runs of {tosses} tosses.\n\n\
         | tosses | core-hours | parts of ten minutes | 95 % interval of a fraction near 1/2 |\n\
         |---|---|---|---|\n",
        1e3 * seconds
    );
    for (name, count) in [("10⁶", 1e6), ("10⁹", 1e9), ("10¹²", 1e12)] {
        let whole = seconds * count;
        text += &format!(
            "| {name} | {} | {} | ±{:.1e} |\n",
            two_digits(whole / 3600.0),
            two_digits((whole / 600.0).ceil()),
            1.96 * 0.5 / f64::sqrt(count)
        );
    }
    text
}

/// A positive number with two digits that count: `0.29`, `4`, `290`, `1.7e6`.
fn two_digits(number: f64) -> String {
    let unit = 10_f64.powf(number.log10().floor() - 1.0);
    let rounded = (number / unit).round() * unit;
    if rounded < 1.0 {
        format!("{rounded:.2}")
    } else if rounded < 1e4 {
        format!("{rounded}")
    } else {
        format!("{rounded:.1e}")
    }
}
