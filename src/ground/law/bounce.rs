//! Parameters of the contact laws from measured quantities of a bounce, in f64 with `libm`.

use super::{ContactLaw, SpringDamper};
use crate::error::{self, Rule, SceneError};
use crate::quadrature::UNIT_3;
use crate::real::Real;

/// The mass of a body, and the number of contacts that carry it together under its centre.
///
/// A ball or a corner is one contact. A flat coin of 120 points that lies on its face has 120. The
/// parameters of the resulting law are those of each contact.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Carried<R = f64> {
    /// Mass of the body, kg, above 0.
    pub mass: R,
    /// Number of contacts, at least 1.
    pub contacts: u32,
}

impl<R: Real> Carried<R> {
    /// Mass (kg) that one contact carries.
    pub(super) fn by_each(&self) -> Result<f64, SceneError> {
        error::above_zero("mass of the body", self.mass, " kg")?;
        if self.contacts == 0 {
            let rule = Rule::AtLeast(1);
            return Err(SceneError::new(
                "number of contacts that support the body",
                rule,
                0.0,
                "",
            ));
        }
        Ok(self.mass.to_f64() / f64::from(self.contacts))
    }

    /// Spring and damper of each contact on which the body oscillates with this frequency (rad/s)
    /// and damping ratio.
    pub(super) fn on(&self, frequency: f64, ratio: f64) -> Result<SpringDamper<R>, SceneError> {
        let mass = self.by_each()?;
        let law = SpringDamper {
            stiffness: R::from_f64(mass * frequency * frequency),
            damping: R::from_f64(2.0 * ratio * mass * frequency),
        };
        law.check()?;
        error::above_zero("stiffness of the ground", law.stiffness, " N/m")?;
        Ok(law)
    }
}

/// A measured impact: the speed at touch-down, and the restitution at this speed.
///
/// The restitution of [`HuntCrossley`](crate::HuntCrossley) decreases with the speed, so it is
/// given together with one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Impact<R = f64> {
    /// Closing speed at touch-down, m/s, above 0.
    pub speed: R,
    /// Speed of separation over the closing speed, dimensionless, above 0, at most 1.
    pub restitution: R,
}

impl<R: Real> Impact<R> {
    /// Loss `λ v` of a bounce by the law of Hunt and Crossley.
    pub(super) fn loss(&self) -> Result<f64, SceneError> {
        error::above_zero("speed of a bounce", self.speed, " m/s")?;
        hunt_crossley_loss(self.restitution)
    }
}

/// Frequency (rad/s) of a bounce that takes this phase angle (rad) and this time (s).
pub(super) fn frequency_in<R: Real>(angle: f64, contact_time: R) -> Result<f64, SceneError> {
    error::above_zero("time of a bounce", contact_time, " s")?;
    Ok(angle / contact_time.to_f64())
}

/// Frequency (rad/s) on a spring with this penetration depth (m) at rest under a gravity (m/s²).
pub(super) fn frequency_at_rest<R: Real>(sink_depth: R, gravity: R) -> Result<f64, SceneError> {
    error::above_zero("depth at rest", sink_depth, " m")?;
    error::above_zero("gravity", gravity, " m/s²")?;
    Ok(libm::sqrt(gravity.to_f64() / sink_depth.to_f64()))
}

/// Checks that a restitution is above 0 and at most 1.
fn checked<R: Real>(restitution: R) -> Result<f64, SceneError> {
    let value = restitution.to_f64();
    if value > 0.0 && value <= 1.0 {
        Ok(value)
    } else {
        let rule = Rule::AboveZeroToOne;
        Err(SceneError::new("restitution", rule, value, ""))
    }
}

/// Returns the zero of a decreasing function between `low` and `high`, to the last place.
fn where_it_passes_zero(low: f64, high: f64, falling: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (low, high);
    // The interval shrinks to 2⁻¹²⁸ of its length.
    for _ in 0..128 {
        let middle = low + (high - low) * 0.5;
        if falling(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low + (high - low) * 0.5
}

// -----------------------------------------------------------------------------------------------
// Spring and damper that never pull
// -----------------------------------------------------------------------------------------------

/// Half the time of a bounce, `arccos(ζ)/√(1-ζ²)`, in radians of the undamped oscillation.
pub(super) fn release_angle(ratio: f64) -> f64 {
    let square = (1.0 - ratio) * (1.0 + ratio);
    if square.abs() < 1e-12 {
        // Both branches tend to 1 - (ζ - 1)/3.
        1.0 + (1.0 - ratio) / 3.0
    } else if square > 0.0 {
        let root = libm::sqrt(square);
        libm::atan2(root, ratio) / root
    } else {
        let root = libm::sqrt(-square);
        libm::log1p((ratio - 1.0) + root) / root
    }
}

/// Damping ratio of a spring and damper that never pull with this restitution: the inverse of
/// `e = exp(-2ζ arccos(ζ)/√(1-ζ²))`.
pub(super) fn spring_damper_ratio<R: Real>(restitution: R) -> Result<f64, SceneError> {
    let aim = libm::log(checked(restitution)?);
    // Far above 1 the restitution is 1/(4ζ²).
    let high = 1.0 + libm::exp(-0.5 * aim);
    Ok(where_it_passes_zero(0.0, high, |ratio| {
        -2.0 * ratio * release_angle(ratio) - aim
    }))
}

// -----------------------------------------------------------------------------------------------
// Limited damper
// -----------------------------------------------------------------------------------------------

/// Logarithm of the restitution, and duration in radians of the undamped oscillation, of a spring
/// with a limited damper.
///
/// The unit of frequency is that of the undamped oscillation. While the damper is limited,
/// `d″ = -2 d` from the surface at the speed 1 until `d = 2ζ d′`. This ends at the time
/// `arctan(√8 ζ)/√2`, with the speed `1/√(1+8ζ²)` left. From then on `d = A exp(-ζ t) sin(φ)`,
/// `φ = θ + t sin β`. Its first two derivatives are `-A exp(-ζ t) sin(φ - β)` and
/// `A exp(-ζ t) sin(φ - 2β)`. This phase begins where `2 sin θ = sin(2β - θ)`, and ends where the
/// force is 0, `φ = 2β`. For ζ > 1 all angles are hyperbolic.
pub(super) fn limited_damper(ratio: f64) -> [f64; 2] {
    let limited = libm::sqrt(1.0 + 8.0 * ratio * ratio);
    let first = libm::atan(libm::sqrt(8.0) * ratio) / libm::sqrt(2.0);
    let square = (1.0 - ratio) * (1.0 + ratio);
    if square.abs() < 1e-12 {
        // The angles are in the ratio 2β : θ = 3 : 1, and sin β/sin(β - θ) is 3.
        return [libm::log(3.0 / limited) - 4.0 / 3.0, first + 4.0 / 3.0];
    }
    let root = libm::sqrt(square.abs());
    // β and β - θ, with sin 2β = 2ζ sin β and cos 2β = 2ζ² - 1.
    let (whole, rest, sine_of_rest) = if square > 0.0 {
        let whole = libm::atan2(root, ratio);
        let rest = whole - libm::atan(2.0 * ratio * root / (1.0 + 2.0 * ratio * ratio));
        (whole, rest, libm::sin(rest))
    } else {
        // exp β = s.
        let s = ratio + root;
        let whole = libm::log1p((ratio - 1.0) + root);
        let rest = 0.5 * libm::log1p(2.0 * root * s / (1.0 + 2.0 * ratio * s));
        (whole, rest, libm::sinh(rest))
    };
    let second = (whole + rest) / root;
    let left = libm::log(root / (sine_of_rest * limited)) - ratio * second;
    [left, first + second]
}

/// Restitution below which that of a limited damper counts as this one.
const LEAST_RESTITUTION: f64 = 1e-140;

/// Damping ratio of a spring with a limited damper with this restitution.
pub(super) fn limited_damper_ratio<R: Real>(restitution: R) -> Result<f64, SceneError> {
    // Of a smaller restitution, the square of the ratio would overflow.
    let aim = libm::log(checked(restitution)?.max(LEAST_RESTITUTION));
    // Far above 1 the restitution is 1/(√8 ζ).
    let high = 1.0 + libm::exp(-aim);
    Ok(where_it_passes_zero(0.0, high, |ratio| {
        limited_damper(ratio)[0] - aim
    }))
}

// -----------------------------------------------------------------------------------------------
// Hunt and Crossley
// -----------------------------------------------------------------------------------------------

/// Loss D = λ v of Hunt and Crossley's law with restitution e at the speed v:
/// `D (1 + e) = ln((1 + D)/(1 - e D))`.
fn hunt_crossley_loss<R: Real>(restitution: R) -> Result<f64, SceneError> {
    let e = checked(restitution)?;
    let lost = 1.0 - e;
    if lost < 1e-4 {
        // Both sides agree to D². With e = 1 - 2D/3 + 4D²/9 - ..., the error of the restitution is
        // 1e-12 at most.
        return Ok(1.5 * lost * (1.0 + lost));
    }
    let residual = |loss: f64| loss * (1.0 + e) - libm::log1p(loss) + libm::log1p(-e * loss);
    Ok(where_it_passes_zero(0.0, 1.0 / e, residual))
}

/// Work of the springs during compression, over m v²: `1/D - ln(1 + D)/D²`.
pub(super) fn work_down(loss: f64) -> f64 {
    if loss < 1e-4 {
        // The next term is D³/5.
        0.5 - loss / 3.0 + loss * loss / 4.0
    } else {
        (loss - libm::log1p(loss)) / (loss * loss)
    }
}

/// Time of a Hunt-Crossley bounce, in units of greatest depth over speed: `A(D) + A(-e D)/e` for
/// the loss D = λ v and the restitution e.
///
/// `d″ = -(k/m) dⁿ (1 + λ d′)` gives `d′ dd′/(1 + λ d′) = -(k/m) dⁿ dd`. Its integral is the depth
/// at each speed, and with it the time is `∫ dd′/d″`. Compression from the speed v to 0 takes
/// `A(D)` times depth over v. Rebound, reversed in time, is a compression from the speed e v with
/// -λ in place of λ.
///
/// Let `1 + λ d′ = exp(-L (1 - X))` with `L = -ln(1 + D)`. X goes from 0 at the surface to 1 at the
/// greatest depth, where `(d/depth)^(n+1) = g(X)/g(1)`, `g(X) = L X - exp(-L) (exp(L X) - 1)`. The
/// substitution `X = s^(n+1)` removes the infinite slope at the surface:
/// `A = g′(0)/g(1) ∫₀¹ (g(X)/(X g(1)))^(-n/(n+1)) ds`, between 1 and `g′(0)/g(1)`. Without loss A
/// is `B(1/2, 1/(n+1))/(n+1)`: π/2 for n = 1, 1.4716 for Hertz's 3/2.
pub(super) fn hunt_crossley_time(exponent: f64, restitution: f64, loss: f64) -> f64 {
    let down = -libm::log1p(loss);
    // -ln(1 - e D) by the relation of e and D, because e D may be rounded to 1.
    let up = loss * (1.0 + restitution) + down;
    way_time(exponent, down, PANELS) + way_time(exponent, up, PANELS) / restitution
}

/// Number of panels with three nodes each. The error of the integral is 1e-8 for exponents up to 4,
/// and 1e-6 up to 10. A test compares it with sixteen times as many panels.
const PANELS: u32 = 64;

/// The integral `A` of [`hunt_crossley_time`].
fn way_time(exponent: f64, loss: f64, panels: u32) -> f64 {
    let [start, whole] = [way_slope(loss), way_work(loss, 1.0)];
    let power = exponent + 1.0;
    let mut mean = 0.0;
    for panel in 0..panels {
        for [place, weight] in UNIT_3 {
            let x = libm::pow((f64::from(panel) + place) / f64::from(panels), power);
            // A large exponent rounds nodes near the surface to 0.
            let share = if x > 0.0 {
                way_work(loss, x) / x
            } else {
                start
            };
            mean += weight * libm::pow(share / whole, -exponent / power);
        }
    }
    start / whole * mean / f64::from(panels)
}

/// Size of L below which g is computed by its series over L², whose next term is `L³/24`. Above it
/// the difference loses `2⁻⁵²/L²`.
const SMALL_LOSS: f64 = 1e-3;

/// Function `g(X)`, over L² where L is small.
fn way_work(loss: f64, x: f64) -> f64 {
    if loss.abs() < SMALL_LOSS {
        let second = x * (1.0 - x * 0.5);
        let third = x * (1.0 - x * (1.0 - x / 3.0));
        let fourth = x * (1.0 - x * (1.5 - x * (1.0 - x * 0.25)));
        second - loss * (third * 0.5 - loss * fourth / 6.0)
    } else {
        loss * x + libm::exp(-loss * (1.0 - x)) * libm::expm1(-loss * x)
    }
}

/// Derivative `g′(0) = L (1 - exp(-L))`, over L² where L is small.
fn way_slope(loss: f64) -> f64 {
    if loss.abs() < SMALL_LOSS {
        1.0 - loss * (0.5 - loss / 6.0)
    } else {
        -loss * libm::expm1(-loss)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn restitution_of_hunt_crossley(loss: f64) -> f64 {
        where_it_passes_zero(0.0, (1.0 / loss).min(1.0), |e| {
            loss * (1.0 + e) - libm::log1p(loss) + libm::log1p(-e * loss)
        })
    }

    #[test]
    fn damping_ratios_have_the_printed_restitutions() {
        // Case G3 of the validation catalogue: e = 0.75 needs ζ = 0.0971578.
        let ratio = spring_damper_ratio(0.75).unwrap();
        assert!((ratio - 0.097_157_8).abs() < 5e-8, "{ratio}");
        for (ratio, e) in [(0.1, 0.744_079), (0.3, 0.450_975), (0.5, 0.298_436)] {
            assert!((spring_damper_ratio(e).unwrap() - ratio).abs() < 2e-6);
        }
        assert!((spring_damper_ratio(libm::exp(-2.0)).unwrap() - 1.0).abs() < 1e-12);
        assert!(spring_damper_ratio(1.0).unwrap() < 1e-15);
    }

    #[test]
    fn losses_have_the_printed_restitutions() {
        // Case B6 of the validation catalogue.
        for (loss, e) in [
            (0.1, 0.937_475_58),
            (0.3, 0.832_869_79),
            (1.0, 0.593_624_26),
        ] {
            // Half a unit of the last printed digit, times dD/de of at most 1.9.
            assert!((hunt_crossley_loss(e).unwrap() - loss).abs() < 1.5e-8);
        }
        for loss in [1e-6, 2e-5, 1e-2, 3.0, 40.0] {
            let e: f64 = if loss < 1e-3 {
                1.0 - loss * 2.0 / 3.0 + loss * loss * 4.0 / 9.0
            } else {
                restitution_of_hunt_crossley(loss)
            };
            // Truncation error of the parabola, and rounding of e.
            let found = hunt_crossley_loss(e).unwrap();
            assert!((found - loss).abs() < 1e-8 * loss, "{found}, not {loss}");
        }
    }

    #[test]
    fn any_restitution_has_its_damping_ratio() {
        for e in [1e-140, 1e-20, 1e-3, 0.1, 0.2636, 0.5, 0.9, 0.999_999] {
            let ratio = spring_damper_ratio(e).unwrap();
            let found = libm::exp(-2.0 * ratio * release_angle(ratio));
            assert!((found - e).abs() < 1e-12 * e, "{found}, not {e}");
            let ratio = limited_damper_ratio(e).unwrap();
            let found = libm::exp(limited_damper(ratio)[0]);
            assert!((found - e).abs() < 1e-9 * e, "limited: {found}, not {e}");
        }
    }

    #[test]
    fn the_branches_of_the_formulas_meet_at_critical_damping() {
        for aside in [1e-5, -1e-5, 1e-12, 0.0] {
            // Slopes of at most 1.
            assert!((release_angle(1.0 + aside) - 1.0).abs() <= aside.abs() + 1e-15);
            let [left, radians] = limited_damper(1.0 + aside);
            assert!((left + 4.0 / 3.0).abs() <= 2.0 * aside.abs() + 1e-9);
            let critical = libm::atan(libm::sqrt(8.0)) / libm::sqrt(2.0) + 4.0 / 3.0;
            assert!((radians - critical).abs() <= 2.0 * aside.abs() + 1e-9);
        }
    }

    #[test]
    fn an_elastic_bounce_takes_the_time_of_the_beta_function() {
        for exponent in [1.0, 1.1, 1.5, 2.0, 3.0, 4.0] {
            let share = 1.0 / (exponent + 1.0);
            let gamma = libm::tgamma;
            let root = libm::sqrt(core::f64::consts::PI);
            let beta = gamma(0.5) * gamma(share) / gamma(0.5 + share);
            assert!((gamma(0.5) - root).abs() < 1e-14);
            let found = hunt_crossley_time(exponent, 1.0, 0.0);
            let expected = 2.0 * share * beta;
            assert!(
                (found / expected - 1.0).abs() < 1e-9,
                "{found}, not {expected}"
            );
        }
    }

    /// Includes both sides of the limit of the series.
    #[test]
    fn the_time_of_a_bounce_is_that_of_a_finer_rule() {
        for exponent in [1.0, 1.5, 2.0, 2.7, 4.0, 10.0] {
            let tolerance = if exponent <= 4.0 { 1e-8 } else { 1e-6 };
            for loss in [
                -300.0, -20.0, -1.0, -1e-3, -9.99e-4, 0.0, 9.99e-4, 1e-3, 1.0, 20.0, 1e6,
            ] {
                let [found, finer] = [PANELS, 16 * PANELS].map(|n| way_time(exponent, loss, n));
                assert!(
                    (found / finer - 1.0).abs() < tolerance,
                    "{exponent}, {loss}: {found}, not {finer}"
                );
            }
            // The slope of A is of the order of 1.
            let [series, difference] =
                [9.999_999e-4, 1.000_000_1e-3].map(|loss| way_time(exponent, loss, PANELS));
            assert!(
                (series - difference).abs() < 1e-9,
                "{exponent}: {series}, {difference}"
            );
        }
    }

    #[test]
    fn the_table_of_contact_times_is_right() {
        for (exponent, row) in [
            (1.0, [core::f64::consts::PI, 3.3127, 3.6371, 4.5138, 6.7623]),
            (1.5, [2.9433, 3.1039, 3.4104, 4.2495, 6.4492]),
            (2.0, [2.8044, 2.9577, 3.2517, 4.0647, 6.2315]),
        ] {
            for (e, printed) in [1.0, 0.9, 0.75, 0.5, 0.25].into_iter().zip(row) {
                let found = hunt_crossley_time(exponent, e, hunt_crossley_loss(e).unwrap());
                assert!((found - printed).abs() < 5.1e-5, "{exponent}, {e}: {found}");
            }
        }
    }
}
