//! Synthetic tosses by the model itself, with the noise of a tracker. A fit must find the
//! parameters with which they were made.

use tumble::glam::{DQuat, DVec3};

use crate::model::{Corrections, Model, Parameters, STEPS_OF_SYNTHETIC, Start};
use crate::tosses::{Sample, Toss};
use common::{Outcome, Random};

/// Parameters of the tosses.
pub(crate) const TRUTH: Parameters = Parameters {
    stiffness: 20_000.0,
    damping: 80.0,
    coefficient: 0.25,
    slip_speed: 0.02,
    transition_load: Some(20.0),
    body: Corrections {
        centre_of_mass: DVec3::new(0.0, 0.0, 0.004),
        ..Corrections::NONE
    },
};

/// Start of a fit.
pub(crate) const GUESS: Parameters = Parameters {
    stiffness: 30_000.0,
    damping: 60.0,
    coefficient: 0.2,
    slip_speed: 0.03,
    transition_load: Some(40.0),
    body: Corrections::NONE,
};

/// Number of samples of a toss: 0.4 s.
const SAMPLES: usize = 60;
/// Noise of each coordinate of each sample except the first, m and rad.
const NOISE: f64 = 1e-4;

pub(crate) fn tosses(count: u32, seed: u64) -> Outcome<Vec<Toss>> {
    let model = Model::new(&TRUTH, STEPS_OF_SYNTHETIC)?;
    let mut random = Random(seed);
    let mut tosses = Vec::new();
    for number in 0..count {
        let start = start(&mut random);
        let mut toss = Toss {
            number,
            samples: vec![start; SAMPLES],
        };
        let states = model
            .predict(&toss, Start::FirstSample)
            .ok_or("a step of the model failed")?;
        for (sample, state) in toss.samples.iter_mut().zip(states).skip(1) {
            let turn = DQuat::from_scaled_axis(any(&mut random, NOISE));
            sample.position = state.position + any(&mut random, NOISE);
            sample.orientation = turn * state.orientation;
        }
        tosses.push(toss);
    }
    Ok(tosses)
}

/// First sample of a toss that is thrown sideways from about 0.1 m above the table.
fn start(random: &mut Random) -> Sample {
    Sample {
        position: DVec3::new(0.0, 0.0, random.between(0.1, 0.15)),
        orientation: DQuat::from_array(random.turn()),
        velocity: any(random, 1.0).with_z(random.between(-0.5, 0.2)),
        spin: any(random, 4.0),
    }
}

fn any(random: &mut Random, most: f64) -> DVec3 {
    DVec3::new(
        random.between(-most, most),
        random.between(-most, most),
        random.between(-most, most),
    )
}
