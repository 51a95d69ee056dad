//! Random part of the inputs, from a small generator that gives the same numbers on every platform.

use core::f64::consts::TAU;

use crate::real::{Quaternion, Real, Vector};
use crate::rotation::Rotation;

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

    /// Rotation, uniform among all (Shoemake, Graphics Gems III, 1992).
    pub(super) fn rotation<R: Real>(&mut self) -> Rotation<R> {
        let share = self.share::<R>();
        let [first, second] = [R::ONE - share, share].map(R::sqrt);
        let [(a, b), (c, d)] = [0, 1].map(|_| (self.share::<R>() * R::from_f64(TAU)).sin_cos());
        let quat = R::Quat::new(first * a, first * b, second * c, second * d);
        Rotation::from_quat(quat)
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

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn the_generator_gives_the_published_numbers() {
        // The first numbers of SplitMix64 for this seed, as Vigna's reference program prints them.
        let mut draw = Draw { state: 1_234_567 };
        let published = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
        ];
        assert_eq!(published.map(|_| draw.bits()), published);
    }

    #[test]
    fn a_share_has_the_mean_and_the_variance_of_a_uniform_number() {
        const COUNT: u32 = 4000;
        let mut draw = Draw { state: 9 };
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..COUNT {
            let either = draw.either::<f64>();
            assert!(either.abs() < 1.0);
            sum += either;
            squares += either * either;
        }
        // Four standard errors: 0.577/√N for the mean, 0.298/√N for the mean square.
        let count = f64::from(COUNT);
        assert!((sum / count).abs() < 4.0 * 0.577 / count.sqrt());
        assert!((squares / count - 1.0 / 3.0).abs() < 4.0 * 0.298 / count.sqrt());
    }

    #[test]
    fn each_number_below_a_count_is_picked_alike() {
        const COUNT: u32 = 4000;
        let mut draw = Draw { state: 5 };
        let mut counts = [0; 5];
        for _ in 0..COUNT {
            counts[draw.pick(5) as usize] += 1;
        }
        // Four standard errors of a fifth.
        let slack = 4.0 * (f64::from(COUNT) * 4.0 / 25.0).sqrt();
        for count in counts {
            assert!(
                (f64::from(count) - f64::from(COUNT) / 5.0).abs() < slack,
                "{counts:?}"
            );
        }
    }

    /// The components of a random direction have the mean 0 and the mean square 1/3. Those of a
    /// point of the cube have the same.
    #[test]
    fn directions_and_points_have_the_moments_of_the_sphere_and_of_the_cube() {
        const COUNT: u32 = 4000;
        let moments = |next: &mut dyn FnMut() -> DVec3| {
            let (mut sum, mut squares, mut products) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
            for _ in 0..COUNT {
                let v = next();
                sum += v;
                squares += v * v;
                products += DVec3::new(v.y * v.z, v.z * v.x, v.x * v.y);
            }
            let count = f64::from(COUNT);
            [sum / count, squares / count - 1.0 / 3.0, products / count]
        };
        let (mut one, mut other) = (Draw { state: 7 }, Draw { state: 8 });
        let mut direction = || one.direction::<f64>();
        let mut place = || other.place::<f64>();
        // Four standard errors: 0.577/√N for a mean, 0.298/√N for a mean square, at most 0.333/√N
        // for a product.
        let errors = [0.577, 0.298, 0.333].map(|error| 4.0 * error / f64::from(COUNT).sqrt());
        for found in [moments(&mut direction), moments(&mut place)] {
            for (found, error) in found.into_iter().zip(errors) {
                assert!(found.abs().max_element() < error, "{found} {error}");
            }
        }
        for _ in 0..100 {
            assert!((direction().length() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn the_directions_of_a_cube_are_all_those_with_components_of_one_size() {
        let digits = [-1.0, 0.0, 1.0];
        for x in digits {
            for y in digits {
                for z in digits {
                    let wanted = DVec3::new(x, y, z);
                    let found = cube_directions::<f64>()
                        .filter(|direction| {
                            (*direction - wanted.normalize_or_zero()).length() < 1e-15
                        })
                        .count();
                    assert_eq!(found, usize::from(wanted != DVec3::ZERO), "{wanted}");
                }
            }
        }
        assert_eq!(cube_directions::<f64>().count(), 26);
    }

    #[test]
    fn what_is_across_a_normal_is_a_unit_vector_at_right_angles_even_to_itself() {
        for normal in cube_directions::<f64>() {
            for direction in cube_directions::<f64>() {
                let level = across::<f64>(normal, direction);
                assert!((level.length() - 1.0).abs() < 1e-15, "{level}");
                assert!(level.dot(normal).abs() < 1e-15, "{normal} {level}");
                let wanted = direction - normal * direction.dot(normal);
                if wanted.length() > 1e-9 {
                    assert!(level.dot(wanted) >= 0.99 * wanted.length(), "{level}");
                }
            }
        }
    }

    #[test]
    fn a_uniform_rotation_takes_a_vector_to_each_octant_alike() {
        const COUNT: usize = 4000;
        let mut draw = Draw { state: 3 };
        let mut counts = [0; 8];
        for _ in 0..COUNT {
            let axes = draw.rotation::<f64>().axes();
            let rotated = axes.to_world(DVec3::new(1.0, 2.0, 3.0));
            let [x, y, z] = rotated.to_array().map(|number| usize::from(number > 0.0));
            counts[4 * x + 2 * y + z] += 1;
        }
        // Four standard errors of an eighth. Rotations by a fixed angle fail.
        let slack = 4.0 * (COUNT as f64 * 7.0 / 64.0).sqrt();
        for count in counts {
            assert!(
                (count as f64 - COUNT as f64 / 8.0).abs() < slack,
                "{counts:?}"
            );
        }
    }
}
