//! Coulomb friction whose coefficient decreases with the load on the contact.

use super::{Coulomb, FrictionJacobian, SlidingFriction};
use crate::error::{self, SceneError};
use crate::real::Real;

/// Coulomb friction whose coefficient decreases with the load, as on plastics and rubber.
///
/// A contact with the normal force N has the coefficient
///
/// ```text
/// coefficient(N) = coefficient / (1 + N/transition_load)^(1/3)
/// force = -coefficient(N) · N · slip / (|slip| + slip_speed)        newtons, world axes
/// ```
///
/// The friction force is proportional to the true area of contact. Under small loads that area is
/// the sum of many asperities and proportional to N, which gives Coulomb's law. Under large loads
/// the asperities have merged into one elastic contact, whose area grows as `N^(2/3)` (Hertz). The
/// coefficient then decreases as `N^(-1/3)`. The transition between the two limits is this crate's
/// choice: it has both limits, and all its derivatives are finite.
///
/// The force never adds energy (`force · slip <= 0`), is finite at zero slip, and increases with N.
///
/// *Sources:* Archard, Proc. R. Soc. Lond. A 243, 190 (1957), both limits, measured on acrylic;
/// Schallamach, Proc. Phys. Soc. B 65, 657 (1952), `N^(-1/3)` of rubber; Greenwood & Tripp,
/// J. Appl. Mech. 34, 153 (1967), the transition of a rough sphere to Hertz's area.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{LoadDependentCoulomb, SlidingFriction};
///
/// let acrylic = LoadDependentCoulomb {
///     coefficient: 0.25_f64,
///     transition_load: 50.0,
///     slip_speed: 1e-3,
/// };
/// // Under seven times the transition load, half of the coefficient is left.
/// let force = acrylic.force(350.0, DVec3::X * 1e6);
/// assert!((force.x + 0.5 * 0.25 * 350.0).abs() < 1e-6);
/// ```
///
/// *Limits:*
/// - N is the load of one contact point. A body on n points has `N/n` at each, and slides with the
///   larger coefficient of that load. Fitted parameters hold for the number of points that they
///   were fitted with. On a [`Disc`](crate::Disc), N is the load of one of the points that
///   represent its rim.
/// - The law has no wear, no dependence on temperature, and no lower limit. At 1000 transition
///   loads a tenth of the coefficient is left.
/// - Above the yield pressure of the material, the area is proportional to N again. This law does
///   not include it.
/// - It does not stick. It creeps as [`Coulomb`] does with `coefficient(N)`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LoadDependentCoulomb<R = f64> {
    /// Coefficient under small loads, dimensionless, at least 0.
    pub coefficient: R,
    /// Normal force of one contact at which 79 % (`2^(-1/3)`) of the coefficient is left, N, above
    /// 0.
    pub transition_load: R,
    /// Slip at which half of the full force is reached, m/s, above 0 and a
    /// [safe divisor](crate::error::Rule::SafeDivisor).
    pub slip_speed: R,
}

impl<R: Real> LoadDependentCoulomb<R> {
    /// Coefficient of friction of one contact under this normal force (N, at least 0).
    #[inline]
    #[must_use]
    pub fn coefficient_at(&self, normal_force: R) -> R {
        let loads = R::ONE + normal_force / self.transition_load;
        self.coefficient * loads.powf(R::from_f64(-1.0 / 3.0))
    }

    /// Returns Coulomb's law for a constant load.
    #[inline]
    fn under(&self, normal_force: R) -> Coulomb<R> {
        Coulomb {
            coefficient: self.coefficient_at(normal_force),
            slip_speed: self.slip_speed,
        }
    }
}

impl<R: Real> SlidingFriction<R> for LoadDependentCoulomb<R> {
    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }

    #[inline]
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        self.under(normal_force).force(normal_force, slip)
    }

    #[inline]
    fn jacobian(&self, normal_force: R, slip: R::Vec3) -> FrictionJacobian<R> {
        let jacobian = self.under(normal_force).jacobian(normal_force, slip);
        // With x = N/N₀, c = (1 + x)^(-1/3): d(N c)/dN = c (1 - x/(3 (1 + x))) = c (2 + 1/(1 +
        // x))/3. The last form has no quotient of two infinite numbers where x overflows.
        let per_one = R::ONE / (R::ONE + normal_force / self.transition_load);
        let rises = (R::TWO + per_one) * R::from_f64(1.0 / 3.0);
        FrictionJacobian {
            per_load: jacobian.per_load * rises,
            ..jacobian
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        error::at_least_zero("coefficient of friction", self.coefficient, "")?;
        error::above_zero(
            "transition load of the friction",
            self.transition_load,
            " N",
        )?;
        error::slip_speed(self.slip_speed)
    }
}
