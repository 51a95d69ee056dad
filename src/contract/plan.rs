//! The random part of the inputs: small, written out, the same everywhere.

use core::f64::consts::TAU;

use crate::real::{Real, Vector};

/// How many random inputs a check tries beyond its fixed extremes, and which.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CheckPlan {
    /// Other seeds give other inputs.
    pub seed: u64,
    /// Number of random inputs.
    pub cases: u32,
}

/// Two hundred inputs.
impl Default for CheckPlan {
    fn default() -> Self {
        Self {
            seed: 0,
            cases: 200,
        }
    }
}

impl CheckPlan {
    pub(super) fn draw(self) -> Draw {
        Draw { state: self.seed }
    }
}

/// SplitMix64 (Steele, Lea & Flood, OOPSLA 2014).
#[derive(Clone, Debug)]
pub(super) struct Draw {
    state: u64,
}

impl Draw {
    fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Evenly from 0 to 1, of 20 bits, which every precision holds.
    pub(super) fn share<R: Real>(&mut self) -> R {
        let whole = u32::try_from(self.bits() >> 44).unwrap_or_default();
        R::from_f64((f64::from(whole) + 0.5) / f64::from(1_u32 << 20))
    }

    /// Evenly from -1 to 1.
    pub(super) fn either<R: Real>(&mut self) -> R {
        self.share::<R>() * R::TWO - R::ONE
    }

    /// Of even logarithm (roughly) from 2⁻ᵒᶜᵗᵃᵛᵉˢ to 1.
    pub(super) fn scale<R: Real>(&mut self, octaves: u32) -> R {
        let down = u32::try_from(self.bits() >> 32).unwrap_or_default() % octaves.max(1);
        let mut value = R::HALF + self.share::<R>() * R::HALF;
        for _ in 0..down {
            value *= R::HALF;
        }
        value
    }

    /// One of `count`, as a number below it.
    pub(super) fn pick(&mut self, count: u32) -> u32 {
        u32::try_from(self.bits() >> 32).unwrap_or_default() % count.max(1)
    }

    /// A unit vector, evenly on the sphere (Archimedes).
    pub(super) fn direction<R: Real>(&mut self) -> R::Vec3 {
        let z = self.either::<R>();
        let (sin, cos) = (self.share::<R>() * R::from_f64(TAU)).sin_cos();
        let level = (R::ONE - z * z).sqrt();
        unit::<R>(R::Vec3::new(level * cos, level * sin, z))
    }

    /// A point of the cube from -1 to 1.
    pub(super) fn place<R: Real>(&mut self) -> R::Vec3 {
        let (x, y, z) = (self.either(), self.either(), self.either());
        R::Vec3::new(x, y, z)
    }
}

/// The directions to faces, corners and edges of a cube.
pub(super) fn cube_directions<R: Real>() -> impl Iterator<Item = R::Vec3> {
    let component = |digit: u32| match digit % 3 {
        0 => -R::ONE,
        1 => R::ZERO,
        _ => R::ONE,
    };
    // In base 3; number 13 is the middle of the cube.
    (0..27_u32)
        .filter(|&number| number != 13)
        .map(move |number| {
            unit::<R>(R::Vec3::new(
                component(number),
                component(number / 3),
                component(number / 9),
            ))
        })
}

/// The vector at length 1; z where it has none.
pub(super) fn unit<R: Real>(vector: R::Vec3) -> R::Vec3 {
    let length = vector.length();
    if length > R::ZERO {
        vector * (R::ONE / length)
    } else {
        R::Vec3::new(R::ZERO, R::ZERO, R::ONE)
    }
}

/// A unit vector at right angles to another one.
pub(super) fn across<R: Real>(normal: R::Vec3, direction: R::Vec3) -> R::Vec3 {
    let level = direction - normal * direction.dot(normal);
    // Twice is enough: the second time takes what rounding left of the first.
    let once = unit::<R>(level);
    let level = unit::<R>(once - normal * once.dot(normal));
    if level.dot(normal).abs() > R::HALF {
        // The direction was along the normal: any other will do.
        return unit::<R>(normal.cross(R::Vec3::new(R::ONE, R::ZERO, R::ZERO)));
    }
    level
}
