//! The contact law of the coin report: a spring and a damper in parallel that never pull.

use super::bounce::{self, Carried};
use super::{ContactLaw, MeanForce};
use crate::error::{self, SceneError};
use crate::real::Real;

/// A spring and a damper in parallel (Kelvin-Voigt) that never pull.
///
/// It is the law of the coin report and of [`FlatGround`](crate::FlatGround).
///
/// `normal force = max(0, stiffness · depth + damping · closing_speed)`, in newtons. The energy in
/// the spring is `stiffness · depth²/2`, also where the contact separates so fast that its force is
/// 0.
///
/// *Limits:* the damper's force jumps from 0 to `damping · closing_speed` at touch-down. An
/// explicit method then has order 1 only. A point of mass m bounces with restitution
/// `exp(-2ζ α)`, with `α = arccos(ζ)/√(1-ζ²)` and `ζ = damping/(2 √(stiffness m))`. For ζ = 1, α is
/// 1, and for ζ > 1 it is `arcosh(ζ)/√(ζ²-1)`. So the restitution is above 0 for every damping. It
/// holds at every speed whose square is far above `(g/ω)²`, with `ω = √(stiffness/m)`. The
/// restitution of a real ball decreases with its speed ([`HuntCrossley`](crate::HuntCrossley)).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpringDamper<R = f64> {
    /// Stiffness per contact, N/m, at least 0.
    pub stiffness: R,
    /// Damping per contact, N s/m, at least 0.
    pub damping: R,
}

impl<R: Real> SpringDamper<R> {
    /// Creates the law that gives a body this restitution (-, above 0, at most 1) and a bounce of
    /// duration `contact_time` (s).
    ///
    /// The result holds without gravity during the bounce, for contacts that touch together under
    /// the centre of mass: `restitution = exp(-2ζ α)`, `contact_time = 2 α/ω`,
    /// `α = arccos(ζ)/√(1-ζ²)` (Schwager & Pöschel, Granular Matter 9, 465, 2007). Where
    /// `speed · ω` is not far above g, gravity makes a bounce longer and its restitution smaller.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a number is outside its range, or if the stiffness or the damping
    /// overflows, or if the stiffness is rounded to 0.
    pub fn from_bounce(
        carried: Carried<R>,
        restitution: R,
        contact_time: R,
    ) -> Result<Self, SceneError> {
        let ratio = bounce::spring_damper_ratio(restitution)?;
        let frequency = bounce::frequency_in(2.0 * bounce::release_angle(ratio), contact_time)?;
        carried.on(frequency, ratio)
    }

    /// Creates the law on which a body penetrates by `sink_depth` (m, above 0) at rest under a
    /// gravity of this size (m/s², above 0), and bounces with this restitution (-, above 0, at most
    /// 1).
    ///
    /// The stiffness is `m g/sink_depth`, with the mass m that each contact carries
    /// (`carried.mass/carried.contacts`). The restitution has the limits of
    /// [`from_bounce`](Self::from_bounce).
    ///
    /// # Errors
    /// Returns [`SceneError`] if a number is outside its range, or if the stiffness or the damping
    /// overflows, or if the stiffness is rounded to 0.
    pub fn from_rest(
        carried: Carried<R>,
        restitution: R,
        sink_depth: R,
        gravity: R,
    ) -> Result<Self, SceneError> {
        let ratio = bounce::spring_damper_ratio(restitution)?;
        carried.on(bounce::frequency_at_rest(sink_depth, gravity)?, ratio)
    }
}

impl<R: Real> SpringDamper<R> {
    #[inline]
    fn mean_force_down(&self, start: R, end: R, per_second: R) -> MeanForce<R> {
        let (k, c) = (self.stiffness, self.damping);
        let path = end - start;
        if start >= R::ZERO {
            MeanForce {
                force: k * ((start + end) * R::HALF) + c * (path * per_second),
                slope: k * R::HALF + c * per_second,
                stiffness: k * R::HALF,
                damping: c,
            }
        } else if end > R::ZERO {
            let share = end / path;
            let stiffness = k * (share * (R::ONE - share * R::HALF));
            MeanForce {
                force: k * (end * share * R::HALF) + c * (end * per_second),
                slope: stiffness + c * per_second,
                stiffness,
                damping: c * share,
            }
        } else {
            MeanForce::NONE
        }
    }

    #[inline]
    pub(super) fn mean_force_up(&self, start: R, end: R, per_second: R) -> MeanForce<R> {
        let (k, c) = (self.stiffness, self.damping);
        let path = start - end;
        if start <= R::ZERO || k == R::ZERO {
            return MeanForce::NONE;
        }
        let cut = c * path * per_second / k;
        let (over_start, over_end) = (start - cut, end - cut);
        if over_end >= R::ZERO {
            MeanForce {
                force: k * ((over_start + over_end) * R::HALF),
                slope: k * R::HALF + c * per_second,
                stiffness: k * R::HALF,
                damping: c,
            }
        } else if over_start > R::ZERO {
            let share = over_start / path;
            let stiffness = k * (share * share * R::HALF);
            MeanForce {
                force: k * (over_start * share * R::HALF),
                slope: c * (share * per_second) + stiffness,
                stiffness,
                damping: c * share,
            }
        } else {
            MeanForce::NONE
        }
    }
}

impl<R: Real> ContactLaw<R> for SpringDamper<R> {
    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }

    #[inline]
    fn spring_force(&self, depth: R) -> R {
        self.stiffness * depth
    }

    #[inline]
    fn spring_energy(&self, depth: R) -> R {
        self.stiffness * depth * depth * R::HALF
    }

    #[inline]
    fn normal_force(&self, depth: R, closing_speed: R) -> R {
        (self.stiffness * depth + self.damping * closing_speed).at_least(R::ZERO)
    }

    /// Integral of the whole clamped law along a path of constant rate, in closed form.
    ///
    /// Symbols: k is the stiffness, c the damping, d₀ and d₁ are the depths, Δ = d₁ - d₀, and h is
    /// the time.
    ///
    /// - The depth increases from d₀ >= 0: `k (d₀ + d₁)/2 + c Δ/h`.
    /// - The depth increases from above ground: `k d₁²/(2Δ) + c d₁/h`.
    /// - The depth decreases: the clamp begins where `k d + c Δ/h` falls to 0, at the depth
    ///   `d* = -c Δ/(h k)`. With `eᵢ = dᵢ - d*` the mean is `k (e₀ + e₁)/2` while e₁ >= 0,
    ///   `k e₀²/(2|Δ|)` while e₀ > 0, then 0.
    ///
    /// The mean is continuous, increases with d₁, and has no 0/0 as Δ goes to 0.
    #[inline]
    fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        let path = end - start;
        // Equal for all contacts of a step, so that the division can be moved out of their loop.
        let per_second = R::ONE / seconds;
        if path >= R::ZERO {
            self.mean_force_down(start, end, per_second)
        } else {
            self.mean_force_up(start, end, per_second)
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        error::at_least_zero("stiffness of the ground", self.stiffness, " N/m")?;
        error::at_least_zero("damping of the ground", self.damping, " N s/m")
    }
}
