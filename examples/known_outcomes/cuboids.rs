//! Steel cuboids with the edges x, y, y, thrown by hand (*Math. Gazette* 97.16, 2013): the fraction
//! that ends on one of the two square faces.
//!
//! Restitution, friction and spin are fitted on four of the cuboids by a search of a grid, and
//! compared on the other four.

use core::fmt::Write as _;

use tumble::ensemble::{Ensemble, RandomSpin, RandomStart, Throw};
use tumble::glam::DVec3;
use tumble::{
    Carried, Coulomb, Cuboid, CuboidFace, DormandPrince54, FlatGround, Flight, SpringDamper,
    Stepper, UniformGravity,
};

use crate::Size;
use crate::shown::{fraction, reached};
use common::Outcome;

/// A measured cuboid: x/y, fraction on the square faces, and number of rolls.
type Measured = (f64, f64, u64);

/// The fitted cuboids, every other one of the table.
const FITTED: [Measured; 4] = [
    (0.47, 0.916, 332),
    (0.93, 0.399, 516),
    (1.44, 0.052, 654),
    (1.87, 0.009, 680),
];
const HELD_OUT: [Measured; 4] = [
    (0.75, 0.548, 799),
    (1.16, 0.148, 1011),
    (1.60, 0.017, 702),
    (2.65, 0.006, 503),
];

/// m.
const SIDE: f64 = 0.0127;
/// Density of steel, kg/m³.
const DENSITY: f64 = 7850.0;
const GRAVITY: f64 = 9.81;
/// Height of the hand, m.
const HEIGHT: f64 = 0.15;
/// Speed along the table at the start, m/s.
const SPEED: f64 = 0.5;
/// Penetration of one corner that supports the weight, m.
const DEPTH: f64 = 1e-5;
/// Bound on the error of a step, m.
const TOLERANCE: f64 = 1e-5;
/// s.
const PATIENCE: f64 = 10.0;
/// Largest difference that the goal allows.
const GOAL: f64 = 0.03;
/// Value that a chi² of four fractions exceeds with a probability of 5 %.
const CHI_SQUARE: f64 = 9.49;

/// Fitted parameters: restitution of one corner, friction, and largest rate of the spin, rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Parameters {
    restitution: f64,
    coefficient: f64,
    rate: f64,
}

/// Number of tosses on a square face, and of all that are decided.
fn on_square(ratio: f64, parameters: Parameters, tosses: u64) -> Outcome<[u64; 2]> {
    let mass = DENSITY * ratio * SIDE.powi(3);
    let carried = Carried { mass, contacts: 1 };
    let law = SpringDamper::from_rest(carried, parameters.restitution, DEPTH, GRAVITY)?;
    let stepper = Stepper::builder(Cuboid::solid(mass, DVec3::new(ratio * SIDE, SIDE, SIDE)))
        .gravity(UniformGravity::down(GRAVITY))
        .ground(FlatGround::level(law.stiffness, law.damping))
        .friction(Coulomb {
            coefficient: parameters.coefficient,
            slip_speed: 1e-2,
        })
        .integrator(Flight(DormandPrince54::new(TOLERANCE)))
        .build()?;
    let spin = RandomSpin::Isotropic {
        rate: (0.0..=parameters.rate).into(),
    };
    let start = RandomStart::at_height(HEIGHT)
        .with_spin(spin)
        .with_speed(DVec3::X, 0.0..=SPEED);
    let throw = Throw::new(&stepper, start, PATIENCE)?;
    let ensemble = Ensemble::new(9, throw.scene_hash());
    let tally = ensemble.run(0..tosses, |toss| throw.play(toss))?;
    let square = tally.count(&CuboidFace::X) + tally.count(&CuboidFace::MinusX);
    let decided = tally.decided().iter().map(|(_, count)| count.count());
    Ok([square, decided.sum()])
}

/// Square of the difference of two fractions over the sum of their variances.
fn chi_square((_, measured, rolls): Measured, [square, tosses]: [u64; 2]) -> f64 {
    // One more of each kind, so that no variance is 0.
    let smoothed = (square as f64 + 1.0) / (tosses as f64 + 2.0);
    let computed = square as f64 / tosses as f64;
    let variance = smoothed * (1.0 - smoothed) * (1.0 / rolls as f64 + 1.0 / tosses as f64);
    (computed - measured).powi(2) / variance
}

fn misfit(parameters: Parameters, tosses: u64) -> Outcome<f64> {
    let mut sum = 0.0;
    for measured in FITTED {
        sum += chi_square(measured, on_square(measured.0, parameters, tosses)?);
    }
    Ok(sum)
}

/// The best parameters of a grid, and then of a finer one around it.
fn fit(size: Size) -> Outcome<Parameters> {
    let restitutions = [0.25, 0.4, 0.6];
    let coefficients = [0.1, 0.2, 0.4];
    let candidates = grid(restitutions, coefficients, [20.0, 60.0]);
    let coarse = best_of(candidates, size.for_fit(400))?;
    let around = |value: f64| [0.85, 1.0, 1.15].map(|factor| factor * value);
    let (restitutions, coefficients) = (around(coarse.restitution), around(coarse.coefficient));
    let candidates = grid(restitutions, coefficients, [coarse.rate]);
    best_of(candidates, size.for_fit(1_500))
}

fn best_of(candidates: Vec<Parameters>, tosses: u64) -> Outcome<Parameters> {
    let mut best = None;
    let mut least = f64::INFINITY;
    for parameters in candidates {
        let misfit = misfit(parameters, tosses)?;
        if misfit < least {
            (least, best) = (misfit, Some(parameters));
        }
    }
    Ok(best.ok_or("the grid is empty")?)
}

fn grid<const N: usize, const M: usize>(
    restitutions: [f64; N],
    coefficients: [f64; N],
    rates: [f64; M],
) -> Vec<Parameters> {
    let mut candidates = Vec::new();
    for restitution in restitutions {
        for coefficient in coefficients {
            candidates.extend(rates.map(|rate| Parameters {
                restitution,
                coefficient,
                rate,
            }));
        }
    }
    candidates
}

pub(crate) fn table(size: Size) -> Outcome<String> {
    let best = fit(size)?;
    let mut text = format!(
        "Steel cuboids with the edges x, y, y and y = 12.7 mm: fraction on a square face. One set \
         of parameters for\nall, fitted on four: restitution {:.2} of one corner, friction {:.2}, \
         spin of up to {:.0} rad/s about any axis.\nNot fitted: dropped from {HEIGHT} m at any \
         orientation, with up to {SPEED} m/s along the table.\n\n\
         | x/y | used for | rolls | measured | tosses | computed | difference | chi² | goal of \
         {GOAL} |\n|---|---|---|---|---|---|---|---|---|\n",
        best.restitution, best.coefficient, best.rate
    );
    for (name, group) in [("fit", FITTED), ("comparison", HELD_OUT)] {
        let mut sum = 0.0;
        for measured in group {
            let (ratio, known, rolls) = measured;
            let counts = on_square(ratio, best, size.of(50_000))?;
            let [square, tosses] = counts;
            let difference = square as f64 / tosses as f64 - known;
            let chi = chi_square(measured, counts);
            sum += chi;
            writeln!(
                text,
                "| {ratio} | {name} | {rolls} | {known} | {tosses} | {} | {difference:.3} | \
                 {chi:.1} | {} |",
                fraction(square, tosses),
                reached(difference.abs() <= GOAL),
            )?;
        }
        writeln!(text, "| all four | {name} | | | | | | {sum:.1} | |")?;
    }
    writeln!(
        text,
        "\nThe chi² of the four compared cuboids exceeds {CHI_SQUARE} with a probability of 5 % if \
         the model is right."
    )?;
    Ok(text)
}
