//! Tosses from random starts, each followed until its face is proven.

use core::f64::consts::TAU;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use tumble::glam::{DQuat, DVec3};
use tumble::{Barriers, Dynamics, Outcome, Real, RigidPointBody, Scene, State, UntilDecided};
use tumble::{Coulomb, FlatGround, UniformGravity};

use crate::memory::Block;
use crate::scenes::bodies::{Body, FACES};
use crate::scenes::error::PageError;
use crate::scenes::parameters::{PageStepper, Parameters};

/// Place of the undecided tosses in the counts.
pub const UNDECIDED: usize = FACES;
/// Place of the tosses that ended with an error.
pub const FAILED: usize = FACES + 1;
/// Numbers of the counts.
pub const COUNTS: usize = FACES + 2;

/// Intervals of the starts, from which each toss takes its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Starts {
    /// Height of the centre of mass, m.
    pub height: [f64; 2],
    /// Angular velocity about an axis in any direction, rad/s.
    pub rate: [f64; 2],
    /// Time after which a toss is undecided, s.
    pub seconds: f64,
}

impl Starts {
    /// Returns the starts for a body of this bounding radius (m) under this gravity (m/s²).
    ///
    /// Lengths are measured in radii, and times in `√(radius/gravity)`, so that bodies of
    /// all sizes are thrown alike.
    #[must_use]
    pub fn of(radius: f64, gravity: f64) -> Self {
        let unit = Real::sqrt(radius / gravity);
        Self {
            height: [2.0 * radius, 4.0 * radius],
            rate: [2.0 / unit, 6.0 / unit],
            seconds: 150.0 * unit,
        }
    }

    /// Returns the start of a toss: any orientation, and a spin about any axis.
    ///
    /// The random numbers are those of `tumble::ensemble`: stream `number` of ChaCha8.
    #[must_use]
    pub fn draw(&self, stepper: &PageStepper, seed: u64, number: u64) -> State {
        let mut stream = ChaCha8Rng::seed_from_u64(seed);
        stream.set_stream(number);
        let numbers: [f64; 8] = core::array::from_fn(|_| fraction(&mut stream));
        let [phase, tilt, third, rate, heading, rise, height, _] = numbers;
        let z = 2.0 * rise - 1.0;
        let level = Real::sqrt(1.0 - z * z);
        let (sin, cos) = Real::sin_cos(TAU * heading);
        let spin = DVec3::new(level * cos, level * sin, z) * between(self.rate, rate);
        let state = State::at(DVec3::Z * between(self.height, height))
            .with_orientation(uniform_rotation([phase, tilt, third]));
        stepper.with_angular_velocity(state, spin)
    }
}

/// Uniform number, at least 0 and below 1: a multiple of 2⁻⁵³.
fn fraction(stream: &mut ChaCha8Rng) -> f64 {
    (stream.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

fn between([low, high]: [f64; 2], fraction: f64) -> f64 {
    low + (high - low) * fraction
}

/// Rotation that is uniform over all rotations (K. Shoemake, Graphics Gems III, 1992, p. 124).
fn uniform_rotation([phase, share, third]: [f64; 3]) -> DQuat {
    let (small, large) = (Real::sqrt(1.0 - share), Real::sqrt(share));
    let ((sin1, cos1), (sin2, cos2)) = (Real::sin_cos(TAU * phase), Real::sin_cos(TAU * third));
    let quaternion = DQuat::from_xyzw(small * sin1, small * cos1, large * sin2, large * cos2);
    tumble::f64::Rotation::from_quat(quaternion).to_quat()
}

type PageScene = Scene<Body, FlatGround, Coulomb, UniformGravity>;

/// Plays a range of tosses with the default method and adds them to the counts.
///
/// # Errors
/// Returns [`PageError`] if the scene is invalid, or if no face of it can be proven.
pub fn play(
    counts: &Block<COUNTS>,
    parameters: &Parameters,
    seed: u64,
    tosses: core::ops::Range<u32>,
) -> Result<(), PageError> {
    let stepper = parameters.default_stepper()?;
    if !stepper.body().has_faces() {
        return Err(PageError::NoFaces);
    }
    let barriers = stepper.barriers().ok_or(PageError::NoBarriers)?;
    let starts = Starts::of(stepper.body().bounding_radius(), parameters.gravity);
    for number in tosses {
        let state = starts.draw(&stepper, seed, number.into());
        let place = end_of(&stepper, barriers, state, starts.seconds);
        counts.set(place, counts.get(place) + 1.0);
    }
    Ok(())
}

/// Place in the counts of a toss from a state.
fn end_of(
    stepper: &PageStepper,
    barriers: Barriers<'_, PageScene>,
    mut state: State,
    seconds: f64,
) -> usize {
    let mut decided = UntilDecided::new(barriers);
    match stepper
        .run(&mut state, seconds, &mut decided)
        .map(|_| decided.outcome())
    {
        Ok(Outcome::Decided(face)) => face,
        Ok(Outcome::Undecided) => UNDECIDED,
        Err(_) => FAILED,
    }
}

/// Returns the face that is proven at a state, if any.
#[must_use]
pub fn proven_face(stepper: &PageStepper, state: &State) -> Option<usize> {
    if !stepper.body().has_faces() || stepper.scene().gravity() == DVec3::ZERO {
        return None;
    }
    match stepper.barriers()?.outcome(state) {
        Outcome::Decided(face) => Some(face),
        Outcome::Undecided => None,
    }
}

/// Quantile of the normal distribution for a two-sided confidence of 95 %.
const Z95: f64 = 1.959_963_984_540_054;

/// Interval of Wilson (J. Am. Stat. Assoc. 22, 209, 1927) at 95 % for the probability behind
/// `count` successes in `total` trials.
#[must_use]
pub fn wilson(count: f64, total: f64) -> [f64; 2] {
    if total <= 0.0 {
        return [0.0, 1.0];
    }
    let p = count / total;
    let square = Z95 * Z95 / total;
    let middle = (p + 0.5 * square) / (1.0 + square);
    let half = Z95 * Real::sqrt(p * (1.0 - p) / total + 0.25 * square / total) / (1.0 + square);
    [f64::max(middle - half, 0.0), f64::min(middle + half, 1.0)]
}
