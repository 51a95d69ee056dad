//! Bounds of the springs' energy by the penetration depth of the lowest point.

use crate::body::{RigidPointBody, Rim};
use crate::ground::SpringDamperGround;
use crate::real::Real;
use crate::scene::Dynamics;

/// Number of intervals of a sum over half an arc.
const ARC: usize = 64;
/// Number of parts of an interval that is searched further.
const PARTS: usize = 32;
/// How often an interval is searched further. Depths are then resolved to 1 in `PARTS²`.
const LEVELS: u32 = 2;
/// Number of halvings of the largest depth.
const HALVINGS: usize = 64;

/// Springs of a scene that carry a weight (N).
pub(super) struct Springs<'a, R, D> {
    pub(super) scene: &'a D,
    pub(super) weight: R,
}

impl<R: Real, D: Dynamics<R>> Springs<'_, R, D> {
    /// Returns the most energy that a body gains by sinking into the springs, J: an upper bound of
    /// `m g d - U(d)` over all depths.
    ///
    /// Returns `None` if the springs do not stop a body that falls from the height of twice its
    /// bounding radius.
    pub(super) fn softness(&self) -> Option<R> {
        let deepest = self.deepest()?;
        let halves = || {
            let half = |depth: &R| Some(*depth * R::HALF);
            core::iter::successors(Some(deepest), half).take(HALVINGS)
        };
        let gain = |depth: R| self.weight * depth - self.energy(depth);
        let best = halves().map(gain).fold(R::ZERO, R::at_least);
        let bounds = halves().map(|to| self.gain_between(to * R::HALF, to, best, LEVELS));
        // Below the last of the halves the springs are neglected.
        let last = halves().last().map(|depth| self.weight * depth);
        Some(bounds.chain(last).fold(best, R::at_least))
    }

    /// Returns a depth (m) of at least twice the bounding radius that no body below the barriers
    /// reaches.
    ///
    /// The height of the centre of mass over the lowest point is at least `-R`, and no barrier is
    /// above `m g R`. So the body stays above a depth `d` with `U(d) >= m g (d + 2 R)`.
    fn deepest(&self) -> Option<R> {
        let twice = self.scene.bounding_radius() * R::TWO;
        let double = |depth: &R| Some(*depth * R::TWO);
        core::iter::successors(Some(twice), double)
            .take(HALVINGS)
            .find(|&depth| self.energy(depth) >= self.weight * (depth + twice))
    }

    /// Upper bound of the gain between two depths, or a value of at most `best`.
    ///
    /// The springs' energy never decreases with the depth, so that no gain between two depths
    /// exceeds `m g to - U(from)`.
    fn gain_between(&self, from: R, to: R, best: R, levels: u32) -> R {
        let bound = self.weight * to - self.energy(from);
        if levels == 0 || bound <= best {
            return bound;
        }
        let width = (to - from) / R::from_usize(PARTS);
        let depth = |part: usize| from + width * R::from_usize(part);
        (0..PARTS)
            .map(|part| self.gain_between(depth(part), depth(part + 1), best, levels - 1))
            .fold(R::ZERO, R::at_least)
    }

    /// Lower bound of the springs' energy (J) of a body whose lowest point is at a depth (m).
    ///
    /// The lowest point is a contact or a point of a rim, and each stores at least its own energy.
    fn energy(&self, depth: R) -> R {
        let body = self.scene.body();
        let contact = (!body.contacts().is_empty()).then(|| self.contact_energy(depth));
        let rims = (body.rims().iter()).map(|rim| self.rim_energy(rim, depth));
        contact
            .into_iter()
            .chain(rims)
            .reduce(R::at_most)
            .unwrap_or(R::ZERO)
    }

    fn contact_energy(&self, depth: R) -> R {
        if depth > R::ZERO {
            self.scene.ground().spring_energy(depth)
        } else {
            R::ZERO
        }
    }

    /// Lower bound of the energy under a rim (J) whose lowest point is at a depth (m).
    ///
    /// At the angle θ from it, the rim is at the depth `d - r s (1 - cos θ) >= d - r θ²/2`. The
    /// energy decreases with the angle, so that each interval has at least that of its far end.
    fn rim_energy(&self, rim: &Rim<R>, depth: R) -> R {
        let pi = R::from_f64(core::f64::consts::PI);
        let end = (R::TWO * depth / rim.radius()).sqrt().at_most(pi);
        let width = end / R::from_usize(ARC);
        let energies = (1..=ARC).map(|far| {
            let angle = width * R::from_usize(far);
            self.contact_energy(depth - rim.radius() * angle * angle * R::HALF)
        });
        let sum = energies.fold(R::ZERO, |sum, energy| sum + energy);
        sum * width * (rim.points() / pi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Coin, ContactPoint, Disc, FlatGround, Frictionless, Scene, UniformGravity};

    /// For one contact on a spring of stiffness k the energy is `k d²/2`.
    #[test]
    fn the_deepest_point_is_the_first_doubling_that_stops_a_fall_from_twice_the_radius() {
        for (index, radius) in [1e-3, 0.3, 0.7, 40.0].into_iter().enumerate() {
            let storage = [ContactPoint::default(); 5];
            let coin = Coin::ring_with_storage(storage, 0.2, radius);
            let scene = |stiffness| {
                let ground = FlatGround::level(stiffness, 0.0);
                Scene::new(coin, ground, Frictionless, UniformGravity::down(9.8)).unwrap()
            };
            for weight in [1e-3, 0.9, 5.0, 2e4] {
                // Springs that carry the weight at a thousandth of the radius, or at eight of it.
                for sink in [1e-3, 0.4, 8.0] {
                    let stiffness = weight / (sink * radius);
                    let scene = scene(stiffness);
                    let springs = Springs {
                        scene: &scene,
                        weight,
                    };
                    let stops = |depth: f64| {
                        0.5 * stiffness * depth * depth >= weight * (depth + 2.0 * radius)
                    };
                    let depths = (1..30).map(|power| radius * 2.0_f64.powi(power));
                    let expected = depths.into_iter().find(|&depth| stops(depth));
                    assert!(expected.is_some());
                    assert_eq!(springs.deepest(), expected, "{index} {weight} {sink}");
                }
            }
        }
    }

    /// At a depth d small against the radius r, each of n points in 2 π on a spring of stiffness k
    /// stores the mean of `k (d - r θ²/2)²/2` over the arc in the ground. With its half angle
    /// `e = √(2 d/r)` the integral over the arc is `k d² e 8/15`.
    #[test]
    fn the_energy_of_a_rim_is_a_lower_bound_of_that_of_its_arc() {
        let (radius, stiffness) = (0.7, 30.0);
        let disc = Disc::solid(0.2, radius, 60);
        let ground = FlatGround::level(stiffness, 0.0);
        let scene = Scene::new(disc, ground, Frictionless, UniformGravity::down(9.8)).unwrap();
        let springs = Springs {
            scene: &scene,
            weight: 1.0,
        };
        let rim = &disc.rims()[0];
        let density = rim.points() / core::f64::consts::TAU;
        for depth in [1e-6, 1e-3, 0.1, 0.5] {
            let end = f64::sqrt(2.0 * depth / radius);
            let exact = density * stiffness * depth * depth * end * (8.0 / 15.0);
            let found = springs.rim_energy(rim, depth);
            // Each interval has the energy of its far end: half of the first one is missing.
            let part = found / exact;
            assert!((0.98..1.0).contains(&part), "{depth}: {part}");
        }
    }
}
