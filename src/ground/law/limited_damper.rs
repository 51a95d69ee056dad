//! Spring and damper without a jump of the force at touch-down.

use super::bounce::{self, Carried};
use super::{ContactLaw, MeanForce, SpringDamper};
use crate::error::SceneError;
use crate::real::Real;

/// A spring and a damper in parallel, where the damper's force is at most as large as the spring's.
///
/// `normal force = k d + min(k d, max(-k d, c u))` in newtons, for stiffness k, depth d, damping c
/// and closing speed u. The force is between 0 and `2 k d`, so it is continuous at touch-down,
/// where the force of [`SpringDamper`] jumps. For a separating contact the two laws are equal,
/// because the lower limit is the clamp at 0.
///
/// The restitution of a point of mass m is `sin β/sin(β - θ) · exp(-ζ (2β - θ)/sin β)/√(1 + 8ζ²)`,
/// with `ζ = c/(2 √(k m)) < 1`, `cos β = ζ` and `tan θ = sin 2β/(2 + cos 2β)`. From touch-down the
/// point oscillates on a spring of stiffness 2k until the damper is no longer limited. The
/// oscillation is then damped until the force is 0. For ζ > 1 the functions are hyperbolic.
///
/// *Limits:* the restitution is the same at every speed. The slope of the force has
/// discontinuities, so explicit methods have order 2 instead of 4.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LimitedDamper<R = f64> {
    /// Stiffness per contact, N/m, at least 0.
    pub stiffness: R,
    /// Damping per contact, N s/m, at least 0.
    pub damping: R,
}

impl<R: Real> LimitedDamper<R> {
    /// Creates the law that gives a body this restitution (-, above 0, at most 1) and a bounce of
    /// duration `contact_time` (s).
    ///
    /// The result holds without gravity during the bounce, for contacts that touch together under
    /// the centre of mass. The duration is `(arctan(√8 ζ)/√2 + (2β - θ)/sin β)/ω`, in the symbols
    /// of [`LimitedDamper`], with `ω = √(k/m)`. A restitution below 1e-140 counts as 1e-140.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a number is outside its range, or if the stiffness or the damping
    /// overflows, or if the stiffness is rounded to 0.
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

    /// Creates the law on which a body penetrates by `sink_depth` (m, above 0) at rest under a
    /// gravity of this size (m/s², above 0), and bounces with this restitution (-, above 0, at most
    /// 1). A restitution below 1e-140 counts as 1e-140.
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

    /// Returns the law without the limit, which is equal for a separating contact.
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
        // Above this depth the damper's force is below the spring's.
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
        // The sum of a damper at its lower limit is 0. Infinities of both signs have the sum NaN,
        // of which this is 0 too.
        (spring + damper.at_most(spring)).at_least(R::ZERO)
    }

    /// Integral of the whole law along a path of constant rate, in closed form.
    ///
    /// Symbols: k is the stiffness, c the damping, d₀ and d₁ are the depths, Δ = d₁ - d₀, and h is
    /// the time.
    ///
    /// While the depth increases, the damper is limited up to the depth `d* = c Δ/(h k)`. The
    /// integral is `G(d) = k d²` there and `k (d²/2 + d* d - d*²/2)` beyond. The mean is
    /// `(G(d₁) - G(max(0, d₀)))/Δ`, of which the spring contributes `k/2 (d₁² - max(0, d₀)²)/Δ`.
    /// While the depth decreases, the mean is that of [`SpringDamper`].
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
