//! Sliding friction: the force along the ground.

mod anisotropic;
mod coulomb;
mod load_dependent;
mod resistance;
mod stribeck;
mod viscous;

pub use anisotropic::AnisotropicCoulomb;
pub use coulomb::{Coulomb, SmoothCoulomb};
pub use load_dependent::LoadDependentCoulomb;
pub use resistance::{RollingResistance, WithResistance};
pub use stribeck::Stribeck;
pub use viscous::Viscous;

use crate::error::SceneError;
use crate::real::{Real, Vector};

/// A law of sliding friction, applied at each contact.
///
/// *To the implementer:* the force must lie in the plane of `slip` (of bare points on level ground
/// nothing else of it counts), oppose it (`force · slip <= 0`, so that friction never adds energy),
/// and be finite at zero slip. [`contract::check_friction`](crate::contract::check_friction) tests
/// an implementation. A step returns [`StepError::BrokenLaw`](crate::StepError::BrokenLaw) for a
/// law that pushes (`force · slip > 0`) or is not finite. Drives are no friction.
///
/// # Which law when
///
/// | law | size of the force at a slip u under the load N | take it for |
/// |---|---|---|
/// | [`Coulomb`] | `μ N u/(u + ε)` | the report's; dry friction with one coefficient |
/// | [`SmoothCoulomb`] | `μ N u/√(u² + ε²)` | the same, with less creep at the same ε, and all derivatives |
/// | [`Stribeck`] | `N u (μ(u)/(u + ε) + v)`, μ falling from static to kinetic | stick and slip, squeal, greased contacts |
/// | [`LoadDependentCoulomb`] | `μ N (1 + N/N₀)^(-1/3) u/(u + ε)` | plastics and rubber, which slide with less under impacts |
/// | [`AnisotropicCoulomb`] | on an ellipse of half axes `μ₁ N`, `μ₂ N` | grain: wood, brushed metal |
/// | [`Viscous`] | `c N u` | wet ground |
/// | any of them in [`WithResistance`] | and torques against rolling and spinning | balls that roll out, tops that spin down |
/// | [`Frictionless`] | 0 | ice, and what is computed without friction |
///
/// ```
/// use tumble::SlidingFriction;
/// use tumble::glam::DVec3;
///
/// /// An oil film: force in proportion to the speed, whatever the load.
/// struct Oil {
///     drag: f64,
/// }
///
/// impl SlidingFriction for Oil {
///     fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
///         if normal_force > 0.0 { -slip * self.drag } else { DVec3::ZERO }
///     }
/// }
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a friction law: it does not implement `SlidingFriction<{R}>`",
    label = "this should be a friction law",
    note = "implement `force`; the precision `{R}` of body, ground, friction and gravity must be the same"
)]
pub trait SlidingFriction<R: Real = f64> {
    /// Force on the body at one contact (N, world axes) that presses with `normal_force` (N, at
    /// least 0) and slides at `slip` (m/s, world axes, in the surface).
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3;

    /// How the force answers to slip and load, for an implicit step: see [`FrictionJacobian`].
    ///
    /// The provided method takes differences of [`force`](Self::force). It steers Newton's
    /// iteration only: an error in it costs iterations, not accuracy.
    #[inline]
    fn jacobian(&self, normal_force: R, slip: R::Vec3) -> FrictionJacobian<R> {
        drag_by_differences(self, normal_force, slip)
    }

    /// How a contact that presses with `normal_force` (N) resists the body's rolling and spinning,
    /// if the law does at all: always, or never.
    ///
    /// The provided method says never, which costs nothing. [`WithResistance`] adds it to any law.
    #[inline]
    fn rolling_resistance(&self, _normal_force: R) -> Option<RollingResistance<R>> {
        None
    }

    /// Whether the law can be: called once, when a scene is composed.
    ///
    /// # Errors
    /// Names the quantity, the rule that it breaks, and its value.
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }

    /// Returns true if the values of the law need no check while a step evaluates them. Default:
    /// false.
    ///
    /// A step checks the values of a law that is not trusted, and returns
    /// [`StepError::BrokenLaw`](crate::StepError::BrokenLaw) if one breaks the contract. Override
    /// it if the law keeps its contract for every finite input, and
    /// [`check_friction`](crate::contract::check_friction) finds nothing: the checks then cost
    /// nothing. A trusted law that breaks its contract goes unnoticed.
    #[inline]
    fn is_trusted(&self) -> bool {
        false
    }
}

/// Behind a pointer, also as `dyn`.
macro_rules! forward {
    ($pointer:ty) => {
        impl<R: Real, F: SlidingFriction<R> + ?Sized> SlidingFriction<R> for $pointer {
            #[inline]
            fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
                (**self).force(normal_force, slip)
            }
            #[inline]
            fn jacobian(&self, normal_force: R, slip: R::Vec3) -> FrictionJacobian<R> {
                (**self).jacobian(normal_force, slip)
            }
            #[inline]
            fn rolling_resistance(&self, normal_force: R) -> Option<RollingResistance<R>> {
                (**self).rolling_resistance(normal_force)
            }
            #[inline]
            fn check(&self) -> Result<(), SceneError> {
                (**self).check()
            }
            #[inline]
            fn is_trusted(&self) -> bool {
                (**self).is_trusted()
            }
        }
    };
}
forward!(&F);
#[cfg(feature = "std")]
forward!(alloc::boxed::Box<F>);

/// The local shape of a friction law: `force = -coefficient · slip`, with the coefficient falling
/// as the slip grows.
///
/// The derivative along the slip is taken as `coefficient (1 - growth · |slip|/width)` where
/// `width` is proportional to `|slip|/|force|`: for [`Coulomb`] the width is `|slip| + slip_speed`
/// and grows by 1 m/s for each m/s of slip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionJacobian<R: Real = f64> {
    /// `|force|/|slip|`, N s/m, at least 0; the limit for slip to 0 where there is none.
    pub coefficient: R,
    /// Derivative of the coefficient with respect to the normal force, s/m.
    pub per_load: R,
    /// m/s, above 0.
    pub width: R,
    /// Derivative of the width with respect to the slip's size, 0 to 1.
    pub growth: R,
}

impl<R: Real> FrictionJacobian<R> {
    /// No friction.
    pub const NONE: Self = Self {
        coefficient: R::ZERO,
        per_load: R::ZERO,
        width: R::ONE,
        growth: R::ZERO,
    };
}

/// The provided [`SlidingFriction::jacobian`].
fn drag_by_differences<R: Real, F: SlidingFriction<R> + ?Sized>(
    friction: &F,
    normal_force: R,
    slip: R::Vec3,
) -> FrictionJacobian<R> {
    let speed = slip.length();
    if !(speed > R::ZERO && normal_force > R::ZERO) {
        return FrictionJacobian::NONE;
    }
    let nudged = R::ONE + R::EPSILON.sqrt();
    let nudge = R::EPSILON.sqrt();
    let along = |load: R, factor: R| -(friction.force(load, slip * factor).dot(slip) / speed);
    let force = along(normal_force, R::ONE);
    let coefficient = force / speed;
    if coefficient <= R::ZERO {
        return FrictionJacobian::NONE;
    }
    let slope = (along(normal_force, nudged) - force) / (speed * nudge);
    let per_load = (along(normal_force * nudged, R::ONE) - force) / (normal_force * nudge * speed);
    FrictionJacobian {
        coefficient,
        per_load,
        width: speed,
        growth: (R::ONE - slope / coefficient)
            .at_least(R::ZERO)
            .at_most(R::ONE),
    }
}

/// No friction: contacts slide freely, and nothing is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Frictionless;

impl<R: Real> SlidingFriction<R> for Frictionless {
    #[inline]
    fn force(&self, _normal_force: R, _slip: R::Vec3) -> R::Vec3 {
        R::Vec3::ZERO
    }
    #[inline]
    fn jacobian(&self, _normal_force: R, _slip: R::Vec3) -> FrictionJacobian<R> {
        FrictionJacobian::NONE
    }
    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }
}
