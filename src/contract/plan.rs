//! Random part of the inputs, from a small generator that gives the same numbers on every platform.

use core::f64::consts::TAU;

use crate::real::{Real, Vector};

/// Number and seed of the random inputs that a check tries after its fixed extremes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CheckPlan {
    /// Seed of the random inputs.
    pub seed: u64,
    /// Number of random inputs.
    pub cases: u32,
}

/// Plan with seed 0 and two hundred inputs.
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

/// Generator SplitMix64 (Steele, Lea & Flood, OOPSLA 2014).
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

    /// Uniform number from 0 to 1 with 20 bits, which every precision can represent.
    pub(super) fn share<R: Real>(&mut self) -> R {
        let whole = u32::try_from(self.bits() >> 44).unwrap_or_default();
        R::from_f64((f64::from(whole) + 0.5) / f64::from(1_u32 << 20))
    }

    /// Uniform number from -1 to 1.
    pub(super) fn either<R: Real>(&mut self) -> R {
        self.share::<R>() * R::TWO - R::ONE
    }

    /// Number with a (roughly) uniform logarithm from 2⁻ᵒᶜᵗᵃᵛᵉˢ to 1.
    pub(super) fn scale<R: Real>(&mut self, octaves: u32) -> R {
        let down = u32::try_from(self.bits() >> 32).unwrap_or_default() % octaves.max(1);
        let mut value = R::HALF + self.share::<R>() * R::HALF;
        for _ in 0..down {
            value *= R::HALF;
        }
        value
    }

    /// Returns a number below `count`.
    pub(super) fn pick(&mut self, count: u32) -> u32 {
        u32::try_from(self.bits() >> 32).unwrap_or_default() % count.max(1)
    }

    /// Unit vector, uniform on the sphere (Archimedes).
    pub(super) fn direction<R: Real>(&mut self) -> R::Vec3 {
        let z = self.either::<R>();
        let (sin, cos) = (self.share::<R>() * R::from_f64(TAU)).sin_cos();
        let level = (R::ONE - z * z).sqrt();
        unit::<R>(R::Vec3::new(level * cos, level * sin, z))
    }

    /// Point of the cube from -1 to 1.
    pub(super) fn place<R: Real>(&mut self) -> R::Vec3 {
        let (x, y, z) = (self.either(), self.either(), self.either());
        R::Vec3::new(x, y, z)
    }
}

/// Directions to the faces, corners and edges of a cube.
pub(super) fn cube_directions<R: Real>() -> impl Iterator<Item = R::Vec3> {
    let component = |digit: u32| match digit % 3 {
        0 => -R::ONE,
        1 => R::ZERO,
        _ => R::ONE,
    };
    // Number in base 3. Number 13 is the middle of the cube.
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

/// Vector scaled to length 1, or z for a vector of length 0.
pub(super) fn unit<R: Real>(vector: R::Vec3) -> R::Vec3 {
    let length = vector.length();
    if length > R::ZERO {
        vector * (R::ONE / length)
    } else {
        R::Vec3::new(R::ZERO, R::ZERO, R::ONE)
    }
}

/// Unit vector perpendicular to another one.
pub(super) fn across<R: Real>(normal: R::Vec3, direction: R::Vec3) -> R::Vec3 {
    let level = direction - normal * direction.dot(normal);
    // Two passes are enough: the second removes what rounding left in the first.
    let once = unit::<R>(level);
    let level = unit::<R>(once - normal * once.dot(normal));
    if level.dot(normal).abs() > R::HALF {
        // The direction was along the normal. Any perpendicular vector is suitable.
        return unit::<R>(normal.cross(R::Vec3::new(R::ONE, R::ZERO, R::ZERO)));
    }
    level
}
