//! Measured tosses: input, and groups of tosses of the same motion.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::io::Read;
use std::path::Path;

use common::cannot;
use flate2::bufread::GzDecoder;
use tumble::glam::{DQuat, DVec3};

/// Sampling rate, 1/s.
pub(crate) const RATE: f64 = 148.0;

/// Tracked pose and velocities of the cube at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sample {
    /// Centre, m, z up, table at z = 0.
    pub(crate) position: DVec3,
    /// Rotation from body to world axes.
    pub(crate) orientation: DQuat,
    /// Velocity, m/s.
    pub(crate) velocity: DVec3,
    /// Angular velocity, rad/s, body axes.
    pub(crate) spin: DVec3,
}

impl Sample {
    fn is_finite(&self) -> bool {
        let vectors = [self.position, self.velocity, self.spin];
        self.orientation.is_finite() && vectors.iter().all(|vector| vector.is_finite())
    }
}

/// One toss with a sample every `1/RATE` s.
#[derive(Clone, Debug)]
pub(crate) struct Toss {
    pub(crate) number: u32,
    pub(crate) samples: Vec<Sample>,
}

/// Reads a table of tosses, compressed or not.
pub(crate) fn read(path: &Path) -> Result<Vec<Toss>, Box<dyn Error>> {
    let bytes = fs::read(path).map_err(cannot("read", path))?;
    // Magic number of gzip.
    let tosses = if bytes.starts_with(&[0x1f, 0x8b]) {
        parse(GzDecoder::new(bytes.as_slice()))
    } else {
        parse(bytes.as_slice())
    };
    let tosses = tosses.map_err(cannot("read", path))?;
    if tosses.is_empty() {
        return Err(format!("{}: no toss of two samples or more", path.display()).into());
    }
    Ok(tosses)
}

const COLUMNS: [&str; 15] = [
    "toss", "sample", "x", "y", "z", "qw", "qx", "qy", "qz", "vx", "vy", "vz", "wx", "wy", "wz",
];

fn parse(text: impl Read) -> Result<Vec<Toss>, Box<dyn Error>> {
    let mut table = csv::Reader::from_reader(text);
    if *table.headers()? != COLUMNS[..] {
        return Err(format!("the columns must be {}", COLUMNS.join(",")).into());
    }
    let mut tosses: BTreeMap<u32, Vec<Sample>> = BTreeMap::new();
    for row in table.deserialize() {
        let row: (u32, usize, [f64; 13]) = row?;
        let (number, place, [x, y, z, qw, qx, qy, qz, vx, vy, vz, wx, wy, wz]) = row;
        let samples = tosses.entry(number).or_default();
        if place != samples.len() {
            return Err(format!("toss {number} lacks sample {}", samples.len()).into());
        }
        let sample = Sample {
            position: DVec3::new(x, y, z),
            orientation: DQuat::from_xyzw(qx, qy, qz, qw).normalize(),
            velocity: DVec3::new(vx, vy, vz),
            spin: DVec3::new(wx, wy, wz),
        };
        if !sample.is_finite() {
            let rule = "all values must be finite, and the quaternion not zero";
            return Err(format!("toss {number}, sample {place}: {rule}").into());
        }
        samples.push(sample);
    }
    let tosses = tosses.into_iter().filter(|(_, samples)| samples.len() > 1);
    Ok(tosses
        .map(|(number, samples)| Toss { number, samples })
        .collect())
}

/// Groups the tosses by motion.
///
/// Some tosses are copies of others, rotated about the vertical. If a copy were in the fitted half,
/// the held-out half would not be independent. Such a rotation does not change heights.
pub(crate) fn motions(tosses: Vec<Toss>) -> Vec<Vec<Toss>> {
    let mut motions: Vec<Vec<Toss>> = Vec::new();
    for toss in tosses {
        match motions.iter_mut().find(|motion| is_same(&motion[0], &toss)) {
            Some(motion) => motion.push(toss),
            None => motions.push(vec![toss]),
        }
    }
    motions
}

/// Returns true if two tosses have the same heights, to a tenth of a millimetre.
///
/// The table is rounded to 1e-7 m, and two real tosses differ by centimetres.
fn is_same(a: &Toss, b: &Toss) -> bool {
    let heights = |toss: &Toss| -> Vec<f64> {
        (toss.samples.iter())
            .map(|sample| sample.position.z)
            .collect()
    };
    a.samples.len() == b.samples.len()
        && (heights(a).iter().zip(heights(b))).all(|(a, b)| (a - b).abs() < 1e-4)
}
