//! A spring and a damper whose force never exceeds the spring's: no jump at first touch.

use super::bounce::{self, Carried};
use super::{ContactLaw, MeanForce, SpringDamper};
use crate::error::SceneError;
use crate::real::Real;

/// A spring and a damper side by side, where the damper's force is at most as large as the
/// spring's.
///
/// `normal force = k d + min(k d, max(-k d, c u))` for stiffness k, depth d, damping c and closing
/// speed u, in newtons: between 0 and `2 k d`, so that it is continuous at first touch, where
/// [`SpringDamper`]'s jumps. A leaving contact feels the same as there: the limit is the clamp.
///
/// A point of mass m bounces, with `ζ = c/(2 √(k m)) < 1`, `cos β = ζ` and
/// `tan θ = sin 2β/(2 + cos 2β)`, with the restitution
/// `sin β/sin(β - θ) · exp(-ζ (2β - θ)/sin β)/√(1 + 8ζ²)`: from the surface it swings on a spring
/// of stiffness 2k until the damper is no longer limited, then damped until the force has come to 0.
/// Hyperbolic functions stand there for ζ > 1.
///
/// *Limits:* the restitution is the same at every speed. The force has kinks, so that explicit
/// methods come to order 2, not 4.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LimitedDamper<R = f64> {
    /// N/m per contact, at least 0.
    pub stiffness: R,
    /// N s/m per contact, at least 0.
    pub damping: R,
}

impl<R: Real> LimitedDamper<R> {
    /// The law by which a body bounces with this restitution (-, above 0, at most 1), on and off in
    /// `contact_time` (s).
    ///
    /// Without gravity during the bounce, and for contacts that touch together under the centre of
    /// mass. The time is `(arctan(√8 ζ)/√2 + (2β - θ)/sin β)/ω`, in the letters above.
    ///
    /// # Errors
    /// Where a number is not in its range.
    pub fn from_bounce(
        carried: Carried<R>,
        restitution: R,
        contact_time: R,
    ) -> Result<Self, SceneError> {
        let ratio = bounce::limited_damper_ratio(restitution)?;
        let [_, angle] = bounce::limited_damper(ratio);
        let frequency = bounce::frequency_in(angle, contact_time)?;
        Ok(Self::limited(carried.on(frequency, ratio)?))
    }

    /// The law on which a body sinks by `sink_depth` (m) at rest under `gravity` (m/s²), and
    /// bounces with this restitution (-, above 0, at most 1).
    ///
    /// # Errors
    /// Where a number is not in its range.
    pub fn from_rest(
        carried: Carried<R>,
        restitution: R,
        sink_depth: R,
        gravity: R,
    ) -> Result<Self, SceneError> {
        let ratio = bounce::limited_damper_ratio(restitution)?;
        let frequency = bounce::frequency_at_rest(sink_depth, gravity)?;
        Ok(Self::limited(carried.on(frequency, ratio)?))
    }

    fn limited(law: SpringDamper<R>) -> Self {
        Self {
            stiffness: law.stiffness,
            damping: law.damping,
        }
    }

    /// The law without the limit, which is the same for a contact that leaves.
    #[inline]
    fn unlimited(&self) -> SpringDamper<R> {
        SpringDamper {
            stiffness: self.stiffness,
            damping: self.damping,
        }
    }

    #[inline]
    fn mean_force_down(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        let (k, c) = (self.stiffness, self.damping);
        if end <= R::ZERO || k == R::ZERO {
            return MeanForce::NONE;
        }
        let path = end - start;
        let from = start.at_least(R::ZERO);
        let share = if start >= R::ZERO { R::ONE } else { end / path };
        let spring = k * ((from + end) * share * R::HALF);
        let stiffness = k * (share * (R::ONE - share * R::HALF));
        // Above this depth the damper gives no more than the spring.
        let cut = c * path / (seconds * k);
        if end <= cut {
            MeanForce {
                force: spring * R::TWO,
                slope: stiffness * R::TWO,
                stiffness,
                damping: spring * (seconds / path),
            }
        } else if from >= cut {
            MeanForce {
                force: spring + c * ((end - from) / seconds),
                slope: stiffness + c / seconds,
                stiffness,
                damping: c * share,
            }
        } else {
            let (limited, free) = ((cut - from) / path, (end - cut) / path);
            let damper = k * (limited * (from + cut) * R::HALF + free * cut);
            let force = spring + damper;
            let answer = k * (end + cut) + c * ((end - cut) / seconds);
            MeanForce {
                force,
                slope: ((answer - force) / path).at_least(stiffness),
                stiffness,
                damping: damper * (seconds / path),
            }
        }
    }
}

impl<R: Real> ContactLaw<R> for LimitedDamper<R> {
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
        let spring = self.stiffness * depth;
        let damper = self.damping * closing_speed;
        spring + damper.at_most(spring).at_least(-spring)
    }

    /// The integral of the whole law along an even path, in closed form (k: stiffness, c: damping,
    /// d₀ and d₁: depths, Δ = d₁ - d₀, h: time).
    ///
    /// Going down, the damper is limited as far as the depth `d* = c Δ/(h k)`: with the integral
    /// `G(d) = k d²` there and `k (d²/2 + d* d - d*²/2)` beyond, the mean is
    /// `(G(d₁) - G(max(0, d₀)))/Δ`, of which the spring's share is `k/2 (d₁² - max(0, d₀)²)/Δ`.
    /// Going up, as of [`SpringDamper`].
    #[inline]
    fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        if end >= start {
            self.mean_force_down(start, end, seconds)
        } else {
            self.unlimited().mean_force_up(start, end, R::ONE / seconds)
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        self.unlimited().check()
    }
}
