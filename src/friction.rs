//! Sliding friction: tangential force at a contact.

mod anisotropic;
mod coulomb;
mod field;
mod load_dependent;
mod metric;
mod patch;
mod resistance;
mod several;
mod stribeck;
mod viscous;

pub use anisotropic::AnisotropicCoulomb;
pub use coulomb::{Coulomb, SmoothCoulomb};
pub use field::FrictionField;
pub use load_dependent::LoadDependentCoulomb;
pub(crate) use metric::Metric;
pub use patch::{FrictionPatch, Region};
pub use resistance::{RollingResistance, WithResistance};
pub(crate) use several::LawOfSurface;
pub use stribeck::Stribeck;
pub use viscous::Viscous;

use crate::error::SceneError;
use crate::real::{Real, Vector};

/// A law of sliding friction, applied at each contact.
///
/// *To the implementer:* the force must keep this contract:
///
/// * It lies in the surface, as `slip` does. A component along the normal would act as a normal
///   force whose work no energy audit counts. It has no effect on the force of bare points on level
///   ground, but on that of a rim or a ball.
/// * It opposes the slip (`force · slip <= 0`), so that friction never adds energy.
/// * It is 0 if `normal_force` is 0.
/// * It is finite at zero slip, and tends to 0 with the slip: a law with a jump there has no
///   coefficient ([`jacobian`](SlidingFriction::jacobian)).
///
/// [`contract::check_friction`](crate::contract::check_friction) tests an implementation. A step
/// returns [`StepError::BrokenLaw`](crate::StepError::BrokenLaw) for a force that adds energy
/// (`force · slip > 0`) or is not finite. A drive therefore cannot be implemented as friction.
///
/// # Choice of the law
///
/// | law | size of the force at slip u, normal force N and slip speed ε | use it for |
/// |---|---|---|
/// | [`Coulomb`] | `μ N u/(u + ε)` | the friction of the coin report; dry friction with one coefficient |
/// | [`SmoothCoulomb`] | `μ N u/√(u² + ε²)` | dry friction with less creep at the same ε, and all derivatives |
/// | [`Stribeck`] | `N u (μ(u)/(u + ε) + v)`, μ decreasing from static to kinetic | stick-slip, squeal, greased contacts |
/// | [`LoadDependentCoulomb`] | `μ N (1 + N/N₀)^(-1/3) u/(u + ε)` | plastics and rubber, whose coefficient is smaller under impacts |
/// | [`AnisotropicCoulomb`] | on an ellipse of half axes `μ₁ N`, `μ₂ N` | grain: wood, brushed metal |
/// | [`Viscous`] | `c N u` | wet ground |
/// | any of them in [`WithResistance`] | the same, and torques against rolling and spinning | balls that roll to rest, tops that spin to rest |
/// | two of them in [`FrictionPatch`] | that of the law of the region | an ice patch, a carpet, a line |
/// | a function of the position, [`FrictionField`] | that of the law at the contact | any other ground whose friction varies |
/// | [`Frictionless`] | 0 | ice, and scenes without friction |
///
/// # Several surfaces
///
/// On a ground of [several surfaces](crate::SpringDamperGround#several-surfaces), a law holds for
/// all of them. A tuple of two to six laws, an array or a slice of laws has one law for each
/// surface, in the same order. Their numbers must agree when a scene is composed.
/// [`WithResistance`], [`FrictionPatch`] and [`FrictionField`] take one law, and may each be one of
/// several.
///
/// # Your own law
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
    /// Friction force on the body at one contact, N, world axes.
    ///
    /// `normal_force` is the normal force on the contact (N, at least 0). `slip` is the velocity of
    /// the contact point along the surface and relative to it (m/s, world axes).
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3;

    /// Derivatives of the force with respect to slip and normal force, for implicit integrators:
    /// see [`FrictionJacobian`].
    ///
    /// The provided method takes differences of [`force`](Self::force). The derivatives steer
    /// Newton's iteration, where a small error costs iterations, not accuracy. They also enter the
    /// end velocity of a step that does not resolve friction, and
    /// [`Stepper::largest_stable_step`](crate::Stepper::largest_stable_step). If the force is
    /// not opposite to the slip, they are those of its component along the slip, and
    /// [`metric_at`](Self::metric_at) gives its direction. At zero slip or zero load it returns
    /// [`FrictionJacobian::NONE`].
    #[inline]
    fn jacobian(&self, normal_force: R, slip: R::Vec3) -> FrictionJacobian<R> {
        jacobian_by_differences(|load, slip| self.force(load, slip), normal_force, slip)
    }

    /// Friction force on the body at a contact at `position` (m, world axes), N, world axes.
    ///
    /// The crate evaluates this method wherever it needs the force. The provided method returns
    /// [`force`](Self::force), so a law without a position implements `force` only. A law that
    /// varies over the ground overrides this method and
    /// [`depends_on_position`](Self::depends_on_position), and `force` is then its value at the
    /// origin. [`FrictionField`] makes such a law from a function of the position.
    ///
    /// The contract is that of [`force`](Self::force), at each position.
    #[inline]
    fn force_at(&self, position: R::Vec3, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        let _ = position;
        self.force(normal_force, slip)
    }

    /// Derivatives of [`force_at`](Self::force_at) with respect to slip and normal force, at a
    /// contact at `position` (m, world axes).
    ///
    /// The provided method returns [`jacobian`](Self::jacobian), or takes differences of
    /// [`force_at`](Self::force_at) if the law [depends on the
    /// position](Self::depends_on_position).
    #[inline]
    fn jacobian_at(
        &self,
        position: R::Vec3,
        normal_force: R,
        slip: R::Vec3,
    ) -> FrictionJacobian<R> {
        if self.depends_on_position() {
            let force = |load, slip| self.force_at(position, load, slip);
            jacobian_by_differences(force, normal_force, slip)
        } else {
            self.jacobian(normal_force, slip)
        }
    }

    /// Metric of a law whose force depends on the direction of the slip: the three rows of a
    /// symmetric matrix M (world axes, dimensionless). The force is `M f(M u)` at the slip u, where
    /// f is opposite to `M u`, and its size depends on the length of `M u` alone.
    ///
    /// A law with the coefficients μ₁ along a and μ₂ along b has `M = μ₁ a aᵀ + μ₂ b bᵀ`. A factor
    /// that is common to all rows has no effect.
    ///
    /// A law must return `Some` at every position, or `None` at every position. The provided method
    /// returns `None`, which costs nothing. A law whose force is not opposite to the slip needs
    /// this method: otherwise implicit integrators find stick slowly or not at all.
    #[inline]
    fn metric_at(&self, position: R::Vec3) -> Option<[R::Vec3; 3]> {
        let _ = position;
        None
    }

    /// Resistance to rolling and spinning of a contact at `position` (m, world axes).
    ///
    /// The provided method returns [`rolling_resistance`](Self::rolling_resistance). A law must
    /// return `Some` from both methods at every position, or `None` from both.
    #[inline]
    fn rolling_resistance_at(
        &self,
        position: R::Vec3,
        normal_force: R,
    ) -> Option<RollingResistance<R>> {
        let _ = position;
        self.rolling_resistance(normal_force)
    }

    /// Returns true if force or resistance depend on the position of the contact. Default: false.
    ///
    /// A law for which this is false costs nothing more, because the integrators do not compute
    /// positions for it. It must have the same values at all positions.
    #[inline]
    fn depends_on_position(&self) -> bool {
        false
    }

    /// Returns true if force and resistance are proportional to the normal force. Default: false.
    ///
    /// [`EnergyMomentum`](crate::EnergyMomentum) then takes the friction of a touch-down at the
    /// mean load of the step. It is the same as at the load of the part of the step in which the
    /// contact touches, and needs no division.
    #[inline]
    fn is_proportional_to_load(&self) -> bool {
        false
    }

    /// Resistance of a contact with `normal_force` (N) to rolling and spinning of the body, if the
    /// law has one. A law must return `Some` at every normal force, or `None` at every normal
    /// force.
    ///
    /// The provided method returns `None`, which costs nothing. [`WithResistance`] adds the
    /// resistance to any law.
    #[inline]
    fn rolling_resistance(&self, _normal_force: R) -> Option<RollingResistance<R>> {
        None
    }

    /// Number of surfaces, if the law differs between the surfaces of a ground. Default: `None`,
    /// the law holds for every surface.
    ///
    /// A law that returns `Some` must also override [`with_surface`](Self::with_surface). Otherwise
    /// the friction is 0. See [several surfaces](Self#several-surfaces).
    #[inline]
    fn surfaces(&self) -> Option<usize> {
        None
    }

    /// Calls `visit` once with the law of one of [several](Self::surfaces) surfaces. Default: does
    /// nothing.
    ///
    /// The index is below the number of surfaces. The law itself holds for one surface.
    #[inline]
    fn with_surface(&self, index: usize, visit: &mut dyn FnMut(&dyn SlidingFriction<R>)) {
        let _ = (index, visit);
    }

    /// Checks that the law is valid. Called once, when a scene is composed.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a quantity is invalid. The error names the quantity, the rule and
    /// the value.
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }

    /// Returns true if the values of the law need no check while a step evaluates them. Default:
    /// false.
    ///
    /// A step checks some values of a law that is not trusted, and returns
    /// [`StepError::BrokenLaw`](crate::StepError::BrokenLaw) if they break the contract: that the
    /// force is finite and does no positive work, that the torques of a resistance are finite and
    /// at least 0, and that its turn speed is finite and above 0. It does not check that the force
    /// is along the surface, as [`check_friction`](crate::contract::check_friction) does.
    /// [`Rk4`](crate::Rk4) and [`Nystrom`](crate::Nystrom) check the values of their last stage.
    /// Override this method if the law keeps its contract for every finite input, and
    /// `check_friction` finds no fault. The checks then cost nothing. A trusted law that breaks its
    /// contract is not detected.
    #[inline]
    fn is_trusted(&self) -> bool {
        false
    }
}

/// Implements the trait for a pointer to a law, also to `dyn`.
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
            fn force_at(&self, position: R::Vec3, normal_force: R, slip: R::Vec3) -> R::Vec3 {
                (**self).force_at(position, normal_force, slip)
            }
            #[inline]
            fn jacobian_at(
                &self,
                position: R::Vec3,
                normal_force: R,
                slip: R::Vec3,
            ) -> FrictionJacobian<R> {
                (**self).jacobian_at(position, normal_force, slip)
            }
            #[inline]
            fn metric_at(&self, position: R::Vec3) -> Option<[R::Vec3; 3]> {
                (**self).metric_at(position)
            }
            #[inline]
            fn rolling_resistance_at(
                &self,
                position: R::Vec3,
                normal_force: R,
            ) -> Option<RollingResistance<R>> {
                (**self).rolling_resistance_at(position, normal_force)
            }
            #[inline]
            fn depends_on_position(&self) -> bool {
                (**self).depends_on_position()
            }
            #[inline]
            fn is_proportional_to_load(&self) -> bool {
                (**self).is_proportional_to_load()
            }
            #[inline]
            fn surfaces(&self) -> Option<usize> {
                (**self).surfaces()
            }
            #[inline]
            fn with_surface(&self, index: usize, visit: &mut dyn FnMut(&dyn SlidingFriction<R>)) {
                (**self).with_surface(index, visit);
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

/// Local derivatives of a friction law `force = -coefficient · slip`, where the coefficient
/// decreases as the slip increases.
///
/// The derivative of the force along the slip is approximated by
/// `-coefficient (1 - growth · |slip|/width)`: `growth · |slip|/width` is the relative decrease of
/// the coefficient per relative increase of the slip. `width` is at least the slip, and
/// `coefficient · width` is the limit to which the saturating part of the friction tends, which
/// [`EnergyMomentum`](crate::EnergyMomentum) uses in stick. Where the whole law saturates, `growth`
/// is the derivative of the width. For [`Coulomb`] the width is `|slip| + slip_speed`, and it grows
/// by 1 m/s for each m/s of slip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionJacobian<R: Real = f64> {
    /// Force against the slip per slip, `-force · slip/|slip|²`, N s/m, at least 0. This is
    /// `|force|/|slip|` if the force is opposite to the slip. At zero slip it is the limit, where
    /// the provided [`SlidingFriction::jacobian`] returns 0.
    pub coefficient: R,
    /// Derivative of the coefficient with respect to the normal force, s/m.
    pub per_load: R,
    /// Limit of the saturating part of the friction over the coefficient, m/s, above 0, and at
    /// least the slip.
    pub width: R,
    /// Relative decrease of the coefficient per relative increase of the slip, times
    /// `width/|slip|`, 0 to 1.
    pub growth: R,
}

impl<R: Real> FrictionJacobian<R> {
    /// Derivatives of a law without friction.
    pub const NONE: Self = Self {
        coefficient: R::ZERO,
        per_load: R::ZERO,
        width: R::ONE,
        growth: R::ZERO,
    };
}

/// Provided [`SlidingFriction::jacobian`], computed by differences of a force.
fn jacobian_by_differences<R: Real>(
    force_of: impl Fn(R, R::Vec3) -> R::Vec3,
    normal_force: R,
    slip: R::Vec3,
) -> FrictionJacobian<R> {
    let speed = slip.length();
    if !(speed > R::ZERO && normal_force > R::ZERO) {
        return FrictionJacobian::NONE;
    }
    let nudged = R::ONE + R::EPSILON.sqrt();
    let nudge = R::EPSILON.sqrt();
    let along = |load: R, factor: R| -(force_of(load, slip * factor).dot(slip) / speed);
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

/// Absence of friction: contacts slide freely, and nothing is computed.
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
    fn is_proportional_to_load(&self) -> bool {
        true
    }
    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }
}
