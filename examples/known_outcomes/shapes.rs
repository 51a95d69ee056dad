//! Thick coins without bounces, two-dimensional dice with many, and cuboids of steel.

use core::f64::consts::TAU;
use core::fmt::Write as _;

use tumble::ensemble::{Ensemble, RandomOrientation, RandomSpin, RandomStart, Throw};
use tumble::glam::{DMat3, DVec3};
use tumble::{
    Carried, CoinFace, Coulomb, DormandPrince54, FlatGround, Flight, SpringDamper, Stepper,
    UniformGravity,
};

use crate::caught::{Axis, on_edge};
use crate::cuboids;
use crate::profile::{Measures, Profile};
use crate::shown::{fraction, interval};
use crate::{Report, Size};
use common::Outcome;

pub(crate) fn tables(size: Size) -> Outcome<Report> {
    let (coins, is_as_expected) = coins(size)?;
    let text = [coins, dice(size)?, cuboids::table(size)?].join("\n");
    Ok(Report {
        text,
        is_as_expected,
    })
}

/// Thickness over diameter: a nickel, and the two fair coins of Yong & Mahadevan.
const RATIOS: [f64; 3] = [0.092, 0.354, 0.577];

fn coins(size: Size) -> Outcome<(String, bool)> {
    let mut text = String::from(
        "Thick coins that are tossed about a diameter, caught and put down without a bounce \
         (Yong & Mahadevan,\narXiv 1008.4559): fraction on edge. Accepted is what has a \
         probability above 1e-3.\n\n\
         | axis of the spin | thickness over diameter | formula | expected | tosses | computed | \
         standard errors | undecided |\n|---|---|---|---|---|---|---|---|\n",
    );
    let mut is_as_expected = true;
    let laws = [
        (Axis::Isotropic, "any direction", "`k/√(1 + k²)`"),
        (Axis::Horizontal, "horizontal", "`(2/π) atan k`"),
    ];
    for (axis, name, formula) in laws {
        for ratio in RATIOS {
            let tosses = size.of(1_000_000);
            let [edge, undecided] = on_edge(ratio, axis, tosses)?;
            let expected = axis.formula(ratio);
            let error = (expected * (1.0 - expected) / tosses as f64).sqrt();
            let deviation = (edge as f64 / tosses as f64 - expected) / error;
            is_as_expected &= deviation.abs() < 3.29;
            writeln!(
                text,
                "| {name} | {ratio} | {formula} | {expected:.4} | {tosses} | {} | {deviation:.1} | \
                 {undecided} |",
                fraction(edge, tosses),
            )?;
        }
    }
    Ok((text, is_as_expected))
}

/// Long side over short side of the two-dimensional die.
const LONG: f64 = 1.5;
/// Short side, m.
const SHORT: f64 = 0.02;
const GRAVITY: f64 = 9.81;

/// Ratio of the fractions on the long and the short sides in the limit of many bounces (Pender &
/// Uhrin).
fn pender() -> f64 {
    let diagonal = LONG.hypot(1.0);
    (diagonal - 1.0) / (diagonal - LONG) * LONG.atan() / (1.0 / LONG).atan()
}

fn dice(size: Size) -> Outcome<String> {
    let mut text = format!(
        "Two-dimensional die with the sides 1 and {LONG} (Pender & Uhrin, arXiv 1407.6307): number \
         on a long side over number\non a short side. They suggest `(d - 1)/(d - {LONG}) · \
         atan {LONG}/atan(1/{LONG})` with the diagonal d, which is {:.2}. It is an\napproximation \
         for a die that rolls over many sides. On real surfaces they expect and observe ratios \
         that are\nsomewhat closer to one.\n\n\
         | restitution of a corner | friction | tosses | ratio | undecided |\n\
         |---|---|---|---|---|\n",
        pender()
    );
    for coefficient in [0.0, 0.3, 1.0] {
        for restitution in [0.3, 0.5, 0.8, 0.9, 0.98] {
            let tosses = size.of(10_000);
            let [long, short] = landed(restitution, coefficient, tosses)?;
            let decided = long + short;
            let [low, high] = interval(long, decided).map(|part| part / (1.0 - part));
            let ratio = long as f64 / short as f64;
            writeln!(
                text,
                "| {restitution} | {coefficient} | {tosses} | {ratio:.2} [{low:.2}, {high:.2}] | \
                 {} |",
                tosses - decided,
            )?;
        }
    }
    Ok(text)
}

/// Number of dice on a long side, and on a short side.
fn landed(restitution: f64, coefficient: f64, tosses: u64) -> Outcome<[u64; 2]> {
    let measures = Measures {
        mass: 0.01,
        radius: 0.5 * LONG * SHORT,
        thickness: SHORT,
    };
    let moment = measures.mass * SHORT * SHORT * (1.0 + LONG * LONG) / 12.0;
    let inertia = DMat3::from_diagonal(DVec3::splat(moment));
    let carried = Carried {
        mass: measures.mass,
        contacts: 1,
    };
    let law = SpringDamper::from_rest(carried, restitution, 1e-4 * SHORT, GRAVITY)?;
    let stepper = Stepper::builder(Profile::rectangle(measures, inertia))
        .gravity(UniformGravity::down(GRAVITY))
        .ground(FlatGround::level(law.stiffness, law.damping))
        .friction(Coulomb {
            coefficient,
            slip_speed: 1e-2,
        })
        .integrator(Flight(DormandPrince54::new(1e-7)))
        .build()?;
    let rotation = RandomOrientation::Tilted {
        axis: DVec3::X,
        tilt: (0.0..=TAU).into(),
        phase: 0.0.into(),
    };
    let spin = RandomSpin::World {
        axis: DVec3::Y,
        rate: (-60.0..=60.0).into(),
    };
    let start = RandomStart::at_height(0.2..=0.4)
        .with_orientation(rotation)
        .with_spin(spin);
    let throw = Throw::new(&stepper, start, 60.0)?;
    let ensemble = Ensemble::new(10, throw.scene_hash());
    let tally = ensemble.run(0..tosses, |toss| throw.play(toss))?;
    let faces = [CoinFace::Heads, CoinFace::Tails].map(|face| tally.count(&face));
    // The faces of the coin are the long sides, and its edge the short ones.
    Ok([faces.iter().sum(), tally.count(&CoinFace::Edge)])
}
