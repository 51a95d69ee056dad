//! The study: three models, fitted on half of the motions, predict the other half by two protocols.

use indicatif::{ProgressBar, ProgressStyle};
use tumble::glam::DVec3;

use crate::fit::{Free, fit};
use crate::flights::{self, Weighed};
use crate::model::{self, Corrections, Model, Parameters, STEPS, Score, Start, scores};
use crate::slides;
use crate::statistics::{Interval, below, median};
use crate::tosses::{self, Toss};
use common::{Outcome, Random};

/// Start of every fit: another program's fit of the first model.
const GUESS: Parameters = Parameters {
    stiffness: 34_784.0,
    damping: 114.0,
    coefficient: 0.183,
    slip_speed: 0.0215,
    transition_load: None,
    body: Corrections::NONE,
};
/// Initial values of the radius of a sharp corner, m, and of the transition load, N.
const SHARP: f64 = 0.002;
const TRANSITION_LOAD: f64 = 30.0;

/// Factor on the median of the fitted half above which a change of spin is not that of free flight.
const MEDIANS: f64 = 10.0;

pub(crate) const STARTS: [(Start, &str); 2] = [
    (Start::FirstSample, "first sample alone"),
    (Start::Flight, "up to 15 samples of flight"),
];

/// The motions in two halves, without the tosses that are not in free flight.
pub(crate) struct Halves {
    pub(crate) fitted: Vec<Vec<Toss>>,
    pub(crate) held: Vec<Vec<Toss>>,
    /// Numbers of the excluded tosses, and the change of spin beyond which they are excluded,
    /// rad/s.
    pub(crate) left_out: Vec<u32>,
    pub(crate) limit: f64,
}

impl Halves {
    /// Splits the motions at random first, so that the exclusion of tosses does not move others.
    pub(crate) fn of(tosses: Vec<Toss>, seed: u64) -> Outcome<Self> {
        let [fitted, held] = halves(tosses::motions(tosses), seed);
        let typical = median(fitted.iter().flatten().filter_map(flights::spin_change))
            .ok_or("no toss has a flight that is long enough")?;
        let limit = MEDIANS * typical;
        let mut left_out = Vec::new();
        let mut keep = |motions: Vec<Vec<Toss>>| -> Vec<Vec<Toss>> {
            let flies = |toss: &Toss| flights::spin_change(toss).is_none_or(|spin| spin <= limit);
            (motions.into_iter())
                .map(|motion| {
                    let (kept, out): (Vec<_>, Vec<_>) = motion.into_iter().partition(flies);
                    left_out.extend(out.iter().map(|toss| toss.number));
                    kept
                })
                .filter(|motion| !motion.is_empty())
                .collect()
        };
        let (fitted, held) = (keep(fitted), keep(held));
        Ok(Self {
            fitted,
            held,
            left_out,
            limit,
        })
    }
}

/// Splits the motions at random into two halves.
fn halves(mut motions: Vec<Vec<Toss>>, seed: u64) -> [Vec<Vec<Toss>>; 2] {
    let mut random = Random(seed);
    for k in (1..motions.len()).rev() {
        motions.swap(k, below(&mut random, k + 1));
    }
    let second = motions.split_off(motions.len() / 2);
    [motions, second]
}

/// A model with the result of its fit, and its errors on the held-out half by both protocols.
pub(crate) struct Fitted {
    pub(crate) name: &'static str,
    pub(crate) parameters: Parameters,
    pub(crate) model: Model,
    /// Errors on the fitted half, by the protocol of the fit.
    pub(crate) known: Score,
    /// Errors on the held-out half for each of [`STARTS`], by motion.
    pub(crate) held: [Vec<Vec<Score>>; 2],
}

/// Fits the three models one after another, each from the result of the previous one.
pub(crate) fn models(halves: &Halves, weighed: &Weighed, quick: bool) -> Outcome<[Fitted; 3]> {
    let known: Vec<Toss> = halves.fitted.iter().flatten().cloned().collect();
    let iterations = if quick { 10 } else { 40 };
    let bar = ProgressBar::new_spinner().with_style(ProgressStyle::with_template(
        "{spinner} fitting: {pos} tries in {elapsed}, {per_sec}",
    )?);
    bar.enable_steady_tick(core::time::Duration::from_millis(200));
    let find = |guess, free: (Free, Start)| {
        // The simplex is started again at its best point.
        let found = fit(&known, guess, free, model::STEPS_OF_FIT, iterations, &bar)?;
        fit(&known, found, free, model::STEPS_OF_FIT, iterations, &bar)
    };
    let printed = find(GUESS, (Free::Ground, Start::FirstSample))?;
    let body = Corrections {
        corner_radius: SHARP,
        centre_of_mass: weighed.centre_of_mass,
        scale: weighed.scale,
        ..Corrections::NONE
    };
    let guess = Parameters { body, ..printed };
    let loaded = find(guess, (Free::GroundAndBody, Start::Flight))?;
    let guess = Parameters {
        transition_load: Some(TRANSITION_LOAD),
        coefficient: 1.2 * loaded.coefficient,
        ..loaded
    };
    let weakening = find(guess, (Free::GroundAndBody, Start::Flight))?;
    bar.finish_and_clear();
    let judged = |name, parameters, start| judge(name, parameters, start, &known, &halves.held);
    Ok([
        judged("printed body, Coulomb", printed, Start::FirstSample)?,
        judged("weighed body, Coulomb", loaded, Start::Flight)?,
        judged(
            "weighed body, load-dependent Coulomb",
            weakening,
            Start::Flight,
        )?,
    ])
}

fn judge(
    name: &'static str,
    parameters: Parameters,
    start: Start,
    known: &[Toss],
    held: &[Vec<Toss>],
) -> Outcome<Fitted> {
    let model = Model::new(&parameters, STEPS)?;
    let known = Score::mean(scores(&model, known, start).iter());
    let held = STARTS.map(|(start, _)| by_motion(&model, held, start));
    Ok(Fitted {
        name,
        parameters,
        model,
        known,
        held,
    })
}

fn by_motion(model: &Model, motions: &[Vec<Toss>], start: Start) -> Vec<Vec<Score>> {
    let flat: Vec<Toss> = motions.iter().flatten().cloned().collect();
    let mut scores = scores(model, &flat, start).into_iter();
    (motions.iter())
        .map(|motion| scores.by_ref().take(motion.len()).collect())
        .collect()
}

type Part = fn(&Score) -> f64;

/// Compared quantities: name, part of the errors, and number of printed places.
pub(crate) const PARTS: [(&str, Part, usize); 3] = [
    ("position, % of the width", |score| score.position, 1),
    ("rotation, degrees", |score| score.rotation, 1),
    ("right face, %", |score| 100.0 * score.right_face, 0),
];

/// Mean of a part of the errors.
pub(crate) fn mean(scores: &[Vec<Score>], part: Part, seed: u64) -> Interval {
    let values: Vec<Vec<f64>> = (scores.iter())
        .map(|motion| motion.iter().map(part).collect())
        .collect();
    Interval::of(&values, seed)
}

/// Mean of the differences of a part, toss by toss.
pub(crate) fn difference([scores, others]: [&[Vec<Score>]; 2], part: Part, seed: u64) -> Interval {
    let values: Vec<Vec<f64>> = (scores.iter().zip(others))
        .map(|(motion, other)| {
            (motion.iter().zip(other))
                .map(|(score, other)| part(score) - part(other))
                .collect()
        })
        .collect();
    Interval::of(&values, seed)
}

/// Coefficient of friction of the slides on a face, over the motions that have any.
pub(crate) fn coefficient_of_slides(
    motions: &[Vec<Toss>],
    scale: f64,
    seed: u64,
) -> Outcome<(usize, Interval)> {
    let found: Vec<Vec<f64>> = (motions.iter())
        .map(|motion| {
            let slides = motion.iter().map(|toss| slides::coefficients(toss, scale));
            slides.flatten().collect()
        })
        .filter(|slides: &Vec<f64>| !slides.is_empty())
        .collect();
    if found.is_empty() {
        return Err("no toss slides on a face".into());
    }
    Ok((found.iter().flatten().count(), Interval::of(&found, seed)))
}

/// Returns the tables of the guide's page.
pub(crate) fn tables(models: &[Fitted; 3], seed: u64) -> String {
    let mut text = String::from(
        "| held-out tosses | start of a toss | position, % of the width | rotation, degrees | right face, % |\n|---|---|---|---|---|\n",
    );
    for fitted in models {
        for (number, (_, start)) in STARTS.iter().enumerate() {
            let cells =
                PARTS.map(|(_, part, places)| mean(&fitted.held[number], part, seed).shown(places));
            text += &format!("| {} | {start} | {} |\n", fitted.name, cells.join(" | "));
        }
    }
    text += "\n| difference, the same held-out tosses | start of a toss | position, % of the width | rotation, degrees | right face, % |\n|---|---|---|---|---|\n";
    for pair in models.windows(2) {
        for (number, (_, start)) in STARTS.iter().enumerate() {
            let cells = PARTS.map(|(_, part, places)| {
                let scores = [&pair[1].held[number][..], &pair[0].held[number][..]];
                difference(scores, part, seed).shown(places)
            });
            text += &format!(
                "| {} less {} | {start} | {} |\n",
                pair[1].name,
                pair[0].name,
                cells.join(" | ")
            );
        }
    }
    text += "\n| fitted | stiffness, N/m a corner | damping, N s/m a corner | coefficient | transition load, N | slip speed, m/s | inertia, of the printed | corner radius, mm | position and rotation on the fitted half |\n|---|---|---|---|---|---|---|---|---|\n";
    for fitted in models {
        text += &row(fitted);
    }
    text
}

fn row(fitted: &Fitted) -> String {
    let Parameters {
        stiffness,
        damping,
        coefficient,
        slip_speed,
        transition_load,
        body,
    } = &fitted.parameters;
    let load = transition_load.map_or("none".to_owned(), |load| format!("{load:.1}"));
    format!(
        "| {} | {stiffness:.0} | {damping:.0} | {coefficient:.3} | {load} | {slip_speed:.3} | {:.2} | {:.1} | {:.1} %, {:.1} degrees |\n",
        fitted.name,
        body.inertia,
        1e3 * body.corner_radius,
        fitted.known.position,
        fitted.known.rotation,
    )
}

/// Describes the results of the flights.
pub(crate) fn shown(weighed: &Weighed) -> String {
    let [x, y, z] = (1e3 * weighed.centre_of_mass).to_array();
    let [dx, dy, dz] = (1e3 * weighed.centre_error).to_array();
    format!(
        "The flights give the centre of mass ({x:.1} ± {dx:.1}, {y:.1} ± {dy:.1}, {z:.1} ± \
         {dz:.1}) mm from the middle, and true lengths {:.4} ± {:.4} of the tracked ones.",
        weighed.scale, weighed.scale_error
    )
}

/// Largest change of the held-out means, by both protocols, if the step size is halved.
pub(crate) fn change_by_half_the_step(fitted: &Fitted, held: &[Vec<Toss>]) -> Outcome<DVec3> {
    let finer = Model::new(&fitted.parameters, 2 * STEPS)?;
    let mut largest = DVec3::ZERO;
    for ((start, _), coarse) in STARTS.into_iter().zip(&fitted.held) {
        let fine = Score::mean(by_motion(&finer, held, start).iter().flatten());
        let coarse = Score::mean(coarse.iter().flatten());
        let change = PARTS.map(|(_, part, _)| (part(&fine) - part(&coarse)).abs());
        largest = largest.max(DVec3::from_array(change));
    }
    Ok(largest)
}
