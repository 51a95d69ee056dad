//! Decided states that are followed to rest, and barriers against the least energy on the boundary.

use core::fmt::Write as _;

use rayon::iter::{IntoParallelIterator, ParallelIterator};

use crate::{Report, Size};
use common::Outcome;
use tumble::EnergyMomentum;

#[path = "../../tests/common/barriers_by_force.rs"]
mod barriers_by_force;
#[path = "../../tests/common/decided_states.rs"]
mod decided_states;

use barriers_by_force::{barriers_hold, by_cone};
use decided_states::{Draw, KINDS, STATES, Start, Tally, Throw, follow, hull};

/// The integrator of [`decided_states`].
type Method<R> = EnergyMomentum<R>;

fn method<R>(time_step: R) -> Method<R> {
    EnergyMomentum { time_step }
}

/// Bodies of all kinds and precisions, each with [`STATES`] states. More than a million of the
/// states are decided.
const BODIES: u64 = 112_000;
/// Hulls whose barriers are compared.
const HULLS: u64 = 10_000;

pub(crate) fn tables(size: Size) -> Outcome<Report> {
    let each = size.of(BODIES).div_ceil(2 * KINDS.len() as u64);
    let mut text = format!(
        "{STATES} states of each body, with an energy just below the barrier. `EnergyMomentum` with \
         steps of 0.1 to\n0.5 √(r/g); penetration at rest of 1e-6 to 2e-2 r; damping ratio 0.02 to \
         0.5; friction 0 to 0.8.\n\n\
         | body | precision | states sought | decided | at rest after 20 √(r/g) | changed face |\n\
         |---|---|---|---|---|---|\n",
    );
    let mut all = Tally::default();
    for (kind, name) in KINDS.into_iter().enumerate() {
        for single in [true, false] {
            let tally = followed(kind, single, each);
            let precision = if single { "f32" } else { "f64" };
            writeln!(
                text,
                "| {name} | {precision} | {} | {} | {} | {} |",
                tally.started, tally.decided, tally.rested, tally.changed
            )?;
            all = all.plus(tally);
        }
    }
    // The p of (1 - p)^N = 0.05.
    let bound = -f64::exp_m1(f64::ln(0.05) / f64::from(all.decided));
    writeln!(
        text,
        "| all | | {} | {} | {} | {} |\n\nWith 95 % confidence, at most {bound:.1e} of such \
         decided states change their face, if none of these did.\n",
        all.started, all.decided, all.rested, all.changed
    )?;
    text += &barriers(size.of(HULLS))?;
    Ok(Report {
        text,
        is_as_expected: all.changed == 0,
    })
}

fn followed(kind: usize, single: bool, states: u64) -> Tally {
    let one = |number| {
        let mut tally = Tally::default();
        if single {
            follow::<f32>(kind, Start::AtBarrier, number, &mut tally);
        } else {
            follow::<f64>(kind, Start::AtBarrier, number, &mut tally);
        }
        tally
    };
    let starts = (0..states).into_par_iter().map(one);
    starts.reduce(Tally::default, Tally::plus)
}

/// Fails by a panic if a barrier is above the least energy on the boundary.
fn barriers(hulls: u64) -> Result<String, core::fmt::Error> {
    let one = |number| {
        let draw = &mut Draw::of(77, number);
        let throw = Throw::drawn(draw);
        let body = hull::<f64>(&throw, draw);
        let (faces, sharp) = barriers_hold(body, throw.radius, draw, by_cone);
        (u64::from(faces), u64::from(sharp))
    };
    let (faces, sharp) = (0..hulls)
        .into_par_iter()
        .map(one)
        .reduce(|| (0, 0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
    let mut text = String::new();
    writeln!(
        text,
        "Barriers of {faces} faces of {hulls} random hulls of 4 to 30 points, against the least \
         energy on the\nboundary of the face by brute force: 0 are above it, and {sharp} are below \
         it by at most the softness of\nthe ground."
    )?;
    Ok(text)
}
