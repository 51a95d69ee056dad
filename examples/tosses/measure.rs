//! Labels that change under a smaller tolerance, and the time on one thread and on many.

use std::time::Instant;

use crate::Arguments;
use crate::scene;
use common::Outcome;

pub(crate) fn label_error(arguments: &Arguments) -> Outcome<()> {
    let tables = [scene::TOLERANCE, 0.01 * scene::TOLERANCE].map(scene::table);
    let [coarse, fine] = tables;
    let (coarse, fine) = (coarse?, fine?);
    let (coarse, fine) = (scene::throw(&coarse)?, scene::throw(&fine)?);
    let ensemble = scene::ensemble(&coarse, arguments.seed);
    let tosses = arguments.tosses.clone();
    let pairs = ensemble.compare(tosses, |toss| coarse.play(toss), |toss| fine.play(toss))?;
    let [low, high] = pairs.label_error(0.95)?;
    println!("{pairs}");
    println!(
        "labels that change at a hundredth of the tolerance: {} of {}, 95 % interval [{low:.4}, \
         {high:.4}]",
        pairs.changed(),
        pairs.compared()
    );
    Ok(())
}

/// Repetitions of the measurement, of which the fastest counts on each side: other programs only
/// lengthen a time.
const REPETITIONS: usize = 5;

/// Plays the same tosses on one thread and on all threads of the pool, in turns.
pub(crate) fn efficiency(arguments: &Arguments) -> Outcome<()> {
    let table = scene::table(scene::TOLERANCE)?;
    let throw = scene::throw(&table)?;
    let ensemble = scene::ensemble(&throw, arguments.seed);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let time = || -> Result<f64, String> {
        let clock = Instant::now();
        let tally = ensemble.run(arguments.tosses.clone(), |toss| throw.play(toss));
        tally.map_err(|error| error.to_string())?;
        Ok(clock.elapsed().as_secs_f64())
    };
    let threads = rayon::current_num_threads();
    let mut best = [f64::INFINITY; 2];
    for _ in 0..REPETITIONS {
        best[0] = best[0].min(one.install(time)?);
        best[1] = best[1].min(time()?);
    }
    let tosses = arguments.tosses.end - arguments.tosses.start;
    println!(
        "{tosses} tosses: {:.3} s on one thread, {:.3} s on {threads}; efficiency {:.3}",
        best[0],
        best[1],
        best[0] / best[1] / threads as f64
    );
    Ok(())
}
