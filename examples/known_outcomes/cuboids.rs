//! Steel cuboids with the edges x, y, y, thrown by hand (*Math. Gazette* 97.16, 2013): the fraction
//! that ends on one of the two square faces.
//!
//! Nothing is known of the throws, except that students rolled the dice by hand. So restitution,
//! friction and the start are fitted on four of the cuboids by a search of a grid. They are
//! compared on four others, and on the seven remaining ones of the source.

use core::fmt::Write as _;

use tumble::ensemble::{Ensemble, RandomSpin, RandomStart, Throw};
use tumble::glam::DVec3;
use tumble::{
    BogackiShampine32, Carried, Coulomb, Cuboid, CuboidFace, FlatGround, Flight, SpringDamper,
    Stepper, UniformGravity,
};

use crate::Size;
use crate::shown::{fraction, reached};
use crate::smooth::{DEGREE, Smooth};
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
const FURTHER: [Measured; 7] = [
    (0.63, 0.738, 840),
    (0.81, 0.496, 740),
    (0.97, 0.385, 530),
    (1.23, 0.154, 532),
    (1.55, 0.040, 606),
    (1.71, 0.031, 609),
    (2.12, 0.007, 275),
];

/// m.
const SIDE: f64 = 0.0127;
/// Density of steel, kg/m³.
const DENSITY: f64 = 7850.0;
const GRAVITY: f64 = 9.81;
/// Penetration of one corner that supports the weight, m.
const DEPTH: f64 = 1e-5;
/// Tolerance, m, of the fit and of the comparison.
const TOLERANCES: [f64; 2] = [1e-4, 1e-5];
/// s.
const PATIENCE: f64 = 10.0;
/// Largest difference that the goal allows.
const GOAL: f64 = 0.03;
/// Values that a chi² of four and of seven fractions exceeds with a probability of 5 %.
const CHI_SQUARE: [f64; 2] = [9.49, 14.07];
/// Value that the chi² of a fit with four coefficients to fifteen fractions exceeds with a
/// probability of 5 %.
const SMOOTH_CHI_SQUARE: f64 = 19.68;

/// Fitted parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Parameters {
    /// Restitution of one corner.
    restitution: f64,
    /// Friction.
    coefficient: f64,
    /// Largest rate of the spin, rad/s.
    rate: f64,
    /// Largest speed along the table at the start, m/s.
    speed: f64,
    /// Height of the hand, m.
    height: f64,
}

/// Number of tosses on a square face, and of all that are decided.
fn on_square(ratio: f64, parameters: Parameters, tolerance: f64, tosses: u64) -> Outcome<[u64; 2]> {
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
        .integrator(Flight(BogackiShampine32::new(tolerance)))
        .build()?;
    let spin = RandomSpin::Isotropic {
        rate: (0.0..=parameters.rate).into(),
    };
    let start = RandomStart::at_height(parameters.height)
        .with_spin(spin)
        .with_speed(DVec3::X, 0.0..=parameters.speed);
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
        let counts = on_square(measured.0, parameters, TOLERANCES[0], tosses)?;
        sum += chi_square(measured, counts);
    }
    Ok(sum)
}

/// The best parameters of a grid, and then of a finer one of restitution and friction around it.
fn fit(size: Size) -> Outcome<Parameters> {
    let starts = [[20.0, 60.0], [0.5, 2.0], [0.15, 0.4]];
    let candidates = grid(&[0.3, 0.45, 0.6, 0.75], &[0.2, 0.4, 0.6], starts);
    let coarse = best_of(candidates, size.for_fit(250))?;
    let around = |value: f64| [0.85, 1.0, 1.15].map(|factor| factor * value);
    let (restitutions, coefficients) = (around(coarse.restitution), around(coarse.coefficient));
    let starts = [[coarse.rate], [coarse.speed], [coarse.height]];
    best_of(
        grid(&restitutions, &coefficients, starts),
        size.for_fit(1_000),
    )
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

/// All combinations of restitutions, frictions, and starts by rate, speed and height.
fn grid<const N: usize>(
    restitutions: &[f64],
    coefficients: &[f64],
    [rates, speeds, heights]: [[f64; N]; 3],
) -> Vec<Parameters> {
    let mut candidates = Vec::new();
    for &restitution in restitutions {
        for &coefficient in coefficients {
            for rate in rates {
                for speed in speeds {
                    candidates.extend(heights.map(|height| Parameters {
                        restitution,
                        coefficient,
                        rate,
                        speed,
                        height,
                    }));
                }
            }
        }
    }
    candidates
}

pub(crate) fn table(size: Size) -> Outcome<String> {
    let best = fit(size)?;
    let mut text = format!(
        "Steel cuboids with the edges x, y, y and y = 12.7 mm: fraction on a square face. One set \
         of parameters for\nall, fitted on four: restitution {:.2} of one corner, friction {:.2}, \
         spin of up to {:.0} rad/s about any axis,\nup to {:.1} m/s along the table, from {:.2} m \
         at any orientation.\n\n\
         | x/y | used for | rolls | measured | tosses | computed | difference | chi² | goal of \
         {GOAL} |\n|---|---|---|---|---|---|---|---|---|\n",
        best.restitution, best.coefficient, best.rate, best.speed, best.height
    );
    let groups: [(&str, &[Measured]); 3] = [
        ("fit", &FITTED),
        ("comparison", &HELD_OUT),
        ("further dice", &FURTHER),
    ];
    for (name, group) in groups {
        let mut sum = 0.0;
        for measured in group {
            let counts = on_square(measured.0, best, TOLERANCES[1], size.of(50_000))?;
            let (row, chi) = row(name, *measured, counts);
            text += &row;
            sum += chi;
        }
        writeln!(text, "| all | {name} | | | | | | {sum:.1} | |")?;
    }
    let [four, seven] = CHI_SQUARE;
    writeln!(
        text,
        "\nIf the model is right, the chi² of four compared cuboids exceeds {four} with a \
         probability of 5 %, and\nthat of seven {seven}."
    )?;
    text += &smooth_curve();
    Ok(text)
}

/// How near a smooth curve comes to the measured fractions that is fitted to all of them.
fn smooth_curve() -> String {
    let all: Vec<Measured> = [&FITTED[..], &HELD_OUT, &FURTHER].concat();
    let curve = Smooth::of(&all);
    let fractions = HELD_OUT.map(|(ratio, ..)| format!("{:.3}", curve.fraction(ratio)));
    let chi = |set: &[Measured]| {
        let terms = set.iter().map(|&(ratio, measured, rolls)| {
            let fraction = curve.fraction(ratio);
            (measured - fraction).powi(2) * rolls as f64 / (fraction * (1.0 - fraction))
        });
        terms.sum::<f64>()
    };
    format!(
        "\nA smooth curve without mechanics (log odds of degree {DEGREE} in ln(x/y), 1/3 for a \
         cube) that is fitted to all\nfifteen has the fractions {} at the four compared ratios, \
         with a chi² of {:.1}. That of all\nfifteen is {:.1}. A right curve exceeds \
         {SMOOTH_CHI_SQUARE} with a probability of 5 %.\n",
        fractions.join(", "),
        chi(&HELD_OUT),
        chi(&all),
    )
}

/// Row of a cuboid, and its chi².
fn row(name: &str, measured: Measured, counts: [u64; 2]) -> (String, f64) {
    let (ratio, known, rolls) = measured;
    let [square, tosses] = counts;
    let difference = square as f64 / tosses as f64 - known;
    let chi = chi_square(measured, counts);
    let row = format!(
        "| {ratio} | {name} | {rolls} | {known} | {tosses} | {} | {difference:.3} \
         | {chi:.1} | {} |\n",
        fraction(square, tosses),
        reached(difference.abs() <= GOAL),
    );
    (row, chi)
}
