//! Resistance of the contacts to rolling and spinning, as a function of the angular velocity.
//!
//! ```text
//! T(ω) = -K ω,     K = Σ k_r (1 - n nᵀ) + k_s n nᵀ,     k_r, k_s >= 0
//! ```
//!
//! `k_r` and `k_s` are the ratios of torque and angular speed of a [`RollingResistance`], which
//! decrease with that speed. On a ground that rotates, ω is relative to it.
//!
//! # Resolution
//!
//! ω has a rounding error, and so has each of its parts along and across a normal. A turn speed
//! near that error makes the torque a random number, and `k_s` so large that `k_r` is lost in the
//! sum. So where the angular speed and the turn speed together are below the
//! [`resolution`], the torque is linear: with `resolution` in place of their sum.

use super::dual::direction;
use crate::friction::RollingResistance;
use crate::integrator::matrix3::Matrix3;
use crate::real::{Real, Vector};

/// Number of groups of contacts that are kept apart. A floor with three walls needs as many.
const GROUPS: usize = 4;
/// Size of the [`resolution`] in rounding errors of the angular velocity. The rounding of a torque
/// is then `1/4096` of its bound.
const ROUNDINGS: f64 = 4096.0;
/// Size of the [`resolution`] in rounding errors of the angular speed `h g/L` that the weight gives
/// a body of size L in a step.
///
/// A body at rest creeps as the law says only at turn speeds above it, so it is as small as the
/// equations allow. Spinning by the length s under the weight has the slope `m g s/resolution`.
/// Next to the inertia of a ball, `0.4 m L²`, it makes the rounding of the matrix `s/(26 L)`.
const ROUNDINGS_AT_REST: f64 = 64.0;

/// Angular speed that a step can tell from 0, rad/s, for a body with this angular velocity at its
/// start, under gravity (m/s²). `time_per_size` is the step over the size of the body, s/m.
pub(super) fn resolution<R: Real>(
    angular_velocity: R::Vec3,
    gravity: R::Vec3,
    time_per_size: R,
) -> R {
    let of_weight = gravity.length() * time_per_size;
    let [moving, at_rest] = [ROUNDINGS, ROUNDINGS_AT_REST].map(R::from_f64);
    R::EPSILON * (moving * angular_velocity.length() + at_rest * of_weight)
}

/// Resistances of all contacts. Contacts with the same normal and the same turn speed resist as one
/// contact with the sum of their torques.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resistances<R: Real> {
    groups: [Group<R>; GROUPS],
    count: usize,
    /// rad/s.
    resolution: R,
    /// Whether contacts with different normals or turn speeds are in one group.
    pub(super) is_merged: bool,
}

/// Contacts that resist as one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group<R: Real> {
    normal: R::Vec3,
    law: RollingResistance<R>,
    /// rad/s.
    resolution: R,
}

/// Angular velocity split at a contact.
struct Split<R: Real> {
    rolling: R::Vec3,
    rolling_speed: R,
    /// Along the normal, rad/s.
    spinning: R,
}

impl<R: Real> Resistances<R> {
    /// No contacts, of a step with this [`resolution`] (rad/s).
    pub(super) const fn none(resolution: R) -> Self {
        let law = RollingResistance {
            rolling: R::ZERO,
            spinning: R::ZERO,
            turn_speed: R::ONE,
        };
        let group = Group {
            normal: R::Vec3::ZERO,
            law,
            resolution,
        };
        Self {
            groups: [group; GROUPS],
            count: 0,
            resolution,
            is_merged: false,
        }
    }

    /// Adds a contact. Where there is no group left, it joins the one with the nearest normal.
    pub(super) fn add(&mut self, normal: R::Vec3, law: &RollingResistance<R>) {
        let is_same = |group: &&mut Group<R>| {
            group.normal == normal && group.law.turn_speed == law.turn_speed
        };
        let known = self.groups.iter_mut().take(self.count);
        if let Some(group) = known.into_iter().find(|group| is_same(group)) {
            group.join(law);
        } else if let Some(free) = self.groups.get_mut(self.count) {
            *free = Group {
                normal,
                law: *law,
                ..*free
            };
            self.count += 1;
        } else {
            self.is_merged = true;
            if let Some(group) = nearest(&mut self.groups, normal) {
                group.join(law);
            }
        }
    }

    pub(super) fn groups(&self) -> &[Group<R>] {
        self.groups.get(..self.count).unwrap_or_default()
    }

    /// Torque at an angular velocity (rad/s), N m.
    pub(super) fn torque(&self, angular_velocity: R::Vec3) -> R::Vec3 {
        self.groups().iter().fold(R::Vec3::ZERO, |sum, group| {
            sum + self.torque_of(&group.law, group.normal, angular_velocity)
        })
    }

    /// Torque of one contact or group, N m.
    pub(super) fn torque_of(
        &self,
        law: &RollingResistance<R>,
        normal: R::Vec3,
        angular_velocity: R::Vec3,
    ) -> R::Vec3 {
        law.torque_resolving(self.resolution, normal, angular_velocity)
    }

    /// Ratio of torque and angular velocity: the matrix `K`, N m s.
    pub(super) fn ratio(&self, angular_velocity: R::Vec3) -> Matrix3<R> {
        self.sum(|group| group.matrix(group.ratios(angular_velocity)))
    }

    /// Negative derivative of the torque with respect to the angular velocity, N m s.
    pub(super) fn slope(&self, angular_velocity: R::Vec3) -> Matrix3<R> {
        self.sum(|group| group.slope(angular_velocity))
    }

    fn sum(&self, of: impl Fn(&Group<R>) -> Matrix3<R>) -> Matrix3<R> {
        self.groups()
            .iter()
            .fold(Matrix3::ZERO, |sum, group| sum.plus(&of(group)))
    }
}

impl<R: Real> Group<R> {
    fn join(&mut self, law: &RollingResistance<R>) {
        self.law.rolling += law.rolling;
        self.law.spinning += law.spinning;
    }

    fn split(&self, angular_velocity: R::Vec3) -> Split<R> {
        let spinning = angular_velocity.dot(self.normal);
        let rolling = angular_velocity - self.normal * spinning;
        Split {
            rolling,
            rolling_speed: rolling.length(),
            spinning,
        }
    }

    /// Parts of an angular velocity (rad/s) along the ground and along the normal.
    pub(super) fn parts(&self, angular_velocity: R::Vec3) -> [R::Vec3; 2] {
        let split = self.split(angular_velocity);
        [split.rolling, self.normal * split.spinning]
    }

    /// Ratios of torque and angular speed, of rolling and of spinning, N m s.
    pub(super) fn ratios(&self, angular_velocity: R::Vec3) -> [R; 2] {
        self.ratios_of(&self.split(angular_velocity))
    }

    fn ratios_of(&self, split: &Split<R>) -> [R; 2] {
        let least = self.resolution - self.law.turn_speed;
        let [rolling, spinning] =
            [split.rolling_speed, split.spinning.abs()].map(|speed| speed.at_least(least));
        self.law.per_turn(rolling, spinning)
    }

    /// Negative derivatives of both torques with respect to their angular speeds, N m s.
    pub(super) fn slopes(&self, angular_velocity: R::Vec3) -> [R; 2] {
        let split = self.split(angular_velocity);
        self.slopes_of(&split, self.ratios_of(&split))
    }

    fn slopes_of(&self, split: &Split<R>, [rolling, spinning]: [R; 2]) -> [R; 2] {
        let half_speed = self.law.turn_speed;
        let share = |speed: R| {
            let sum = speed + half_speed;
            if sum < self.resolution {
                R::ONE
            } else {
                half_speed / sum
            }
        };
        [
            rolling * share(split.rolling_speed),
            spinning * share(split.spinning.abs()),
        ]
    }

    /// Matrix that multiplies the parts of an angular velocity along the ground and along the
    /// normal by two factors.
    pub(super) fn matrix(&self, [along, across]: [R; 2]) -> Matrix3<R> {
        let n = self.normal;
        Matrix3::diagonal(along).plus(&Matrix3::outer(n * (across - along), n))
    }

    fn slope(&self, angular_velocity: R::Vec3) -> Matrix3<R> {
        let split = self.split(angular_velocity);
        let ratios = self.ratios_of(&split);
        let [across_path, _] = ratios;
        let [along_path, spinning] = self.slopes_of(&split, ratios);
        let u = direction::<R>(split.rolling);
        self.matrix([across_path, spinning])
            .plus(&Matrix3::outer(u * (along_path - across_path), u))
    }
}

/// Group whose normal is nearest to a direction.
fn nearest<R: Real>(groups: &mut [Group<R>], normal: R::Vec3) -> Option<&mut Group<R>> {
    let mut groups = groups.iter_mut();
    let first = groups.next()?;
    Some(groups.fold(first, |best, group| {
        if group.normal.dot(normal) > best.normal.dot(normal) {
            group
        } else {
            best
        }
    }))
}
