//! Friction whose law is a function of the position on the ground.

use super::several::check_is_one;
use super::{FrictionJacobian, RollingResistance, SlidingFriction};
use crate::error::SceneError;
use crate::real::{Real, Vector};

/// Friction that varies over the ground, with the law at a contact from a function of its position.
///
/// The function takes the position of the contact (m, world axes) and returns a law, for example
/// [`Coulomb`](crate::Coulomb) with a coefficient for that position. The force is that of this law,
/// so it never adds energy. [`FrictionPatch`](super::FrictionPatch) is simpler for two laws and one
/// region.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Coulomb, FrictionField, SlidingFriction};
///
/// // A lane that is oiled for the first 12 m.
/// let lane = FrictionField::new(|position: DVec3| Coulomb {
///     coefficient: if position.x < 12.0 { 0.04 } else { 0.2 },
///     slip_speed: 1e-4, // m/s
/// });
/// let [oil, wood] = [5.0, 15.0].map(|x| lane.force_at(DVec3::X * x, 10.0, DVec3::X)); // N
/// assert!((wood.x / oil.x - 5.0).abs() < 1e-9);
/// ```
///
/// *Errors:* The function may return any law, so the law is not checked when the scene is composed.
/// A step checks each force, and returns [`StepError::BrokenLaw`](crate::StepError::BrokenLaw) if
/// the law at a contact adds energy or is not finite. [`trusted`](Self::trusted) leaves these
/// checks out. The function must not panic.
///
/// *Limits:*
/// - The order of a method holds if the function is smooth. Where it jumps, the step that crosses
///   the jump has an error of the jump times the step size, so fixed-step methods are of order 1.
///   The adaptive methods detect the jump and shorten the step, except
///   [`AdaptiveEnergyMomentum`](crate::AdaptiveEnergyMomentum). If the jump lies in the first or
///   the last quarter of its step `h`, its estimate does not contain it, and the velocity has an
///   error of up to a quarter of `h` times the jump of the force over the mass.
/// - [`EnergyMomentum`](crate::EnergyMomentum) evaluates the function at the position that the
///   contact has at the middle of the step if it moves on with its velocity of the start. It keeps
///   order 2 and its guarantee for the energy.
/// - On a [`Rim`](crate::Rim), a jump within the arc that touches is resolved to the distance of
///   its quadrature points.
/// - The resistance to rolling must be `Some` at every position or `None` at every position.
#[derive(Clone, Copy)]
pub struct FrictionField<F> {
    law_at: F,
    is_trusted: bool,
}

impl<F> FrictionField<F> {
    /// Creates the friction from a function that returns the law at a position (m, world axes).
    // `V` is `R::Vec3`. A separate type parameter lets the compiler infer the precision, which it
    // cannot do from a projection.
    #[must_use]
    pub const fn new<R, V, L>(law_at: F) -> Self
    where
        R: Real<Vec3 = V>,
        V: Vector<R>,
        F: Fn(V) -> L,
        L: SlidingFriction<R>,
    {
        Self {
            law_at,
            is_trusted: false,
        }
    }

    /// Returns the same friction, whose forces are not checked while a step evaluates them.
    ///
    /// The caller is responsible for the function: at each position it returns a law that is valid
    /// and that is [trusted](SlidingFriction::is_trusted), as the laws of this crate are. The
    /// checks then cost nothing. A law that breaks its contract is not detected.
    #[must_use]
    pub fn trusted(self) -> Self {
        Self {
            is_trusted: true,
            ..self
        }
    }
}

impl<F> core::fmt::Debug for FrictionField<F> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("FrictionField").finish_non_exhaustive()
    }
}

impl<R, F, L> SlidingFriction<R> for FrictionField<F>
where
    R: Real,
    F: Fn(R::Vec3) -> L,
    L: SlidingFriction<R>,
{
    #[inline]
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        self.force_at(R::Vec3::ZERO, normal_force, slip)
    }

    #[inline]
    fn force_at(&self, position: R::Vec3, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        (self.law_at)(position).force_at(position, normal_force, slip)
    }

    #[inline]
    fn jacobian(&self, normal_force: R, slip: R::Vec3) -> FrictionJacobian<R> {
        self.jacobian_at(R::Vec3::ZERO, normal_force, slip)
    }

    #[inline]
    fn jacobian_at(
        &self,
        position: R::Vec3,
        normal_force: R,
        slip: R::Vec3,
    ) -> FrictionJacobian<R> {
        (self.law_at)(position).jacobian_at(position, normal_force, slip)
    }

    #[inline]
    fn metric_at(&self, position: R::Vec3) -> Option<[R::Vec3; 3]> {
        (self.law_at)(position).metric_at(position)
    }

    #[inline]
    fn rolling_resistance(&self, normal_force: R) -> Option<RollingResistance<R>> {
        self.rolling_resistance_at(R::Vec3::ZERO, normal_force)
    }

    #[inline]
    fn rolling_resistance_at(
        &self,
        position: R::Vec3,
        normal_force: R,
    ) -> Option<RollingResistance<R>> {
        (self.law_at)(position).rolling_resistance_at(position, normal_force)
    }

    #[inline]
    fn depends_on_position(&self) -> bool {
        true
    }

    #[inline]
    fn is_trusted(&self) -> bool {
        self.is_trusted
    }

    fn check(&self) -> Result<(), SceneError> {
        check_is_one(&(self.law_at)(R::Vec3::ZERO))
    }
}
