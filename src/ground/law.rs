//! Contact laws: normal force at a given depth and closing speed, independent of the shape.

mod bounce;
mod hunt_crossley;
mod limited_damper;
mod spring_damper;

pub use bounce::{Carried, Impact};
pub use hunt_crossley::HuntCrossley;
pub use limited_damper::LimitedDamper;
pub use spring_damper::SpringDamper;

use super::MeanForce;
use crate::error::SceneError;
use crate::quadrature::unit_3;
use crate::real::Real;

/// The normal force of one contact as a function of depth (m) and closing speed (m/s).
///
/// A [`Ground`](crate::Ground) combines it with a shape. The methods have the same names and the
/// same contract as those of [`SpringDamperGround`](crate::SpringDamperGround):
///
/// * The energy is the integral of the spring force from depth 0.
/// * The rest of the force dissipates energy.
/// * The ground never pulls.
///
/// [`contract::check_ground`](crate::contract::check_ground) tests a law on any shape.
///
/// # Choice of the law
///
/// | law | force at depth d, closing speed u | restitution | force at touch-down | use it for |
/// |---|---|---|---|---|
/// | [`SpringDamper`] | `max(0, k d + c u)` | the same at every speed, any from 1, above 0 | jumps to `c u` | the ground of the coin report; bodies that shall come to rest soon |
/// | [`LimitedDamper`] | `k d + c u`, the damper's part within `± k d` | the same at every speed, any from 1, above 0 | continuous | the same bodies with explicit methods, which keep more of their order |
/// | [`HuntCrossley`] with exponent 1 | `k d max(0, 1 + λ u)` | decreases with the speed, `1 - 2 λ u/3` for slow bounces | continuous | balls whose restitution decreases with the speed |
/// | [`HuntCrossley`] with exponent 3/2 | `k d^(3/2) max(0, 1 + λ u)` | as with exponent 1 | continuous, with a continuous slope | an elastic ball on an elastic plane (Hertz), or points with a soft touch-down |
///
/// ```
/// use tumble::{ContactLaw, Ground, Plane, Stepper, Coin};
///
/// /// Springs that push with the same force at every depth.
/// struct Weights {
///     force: f64, // N
/// }
///
/// impl ContactLaw for Weights {
///     fn spring_force(&self, _depth: f64) -> f64 {
///         self.force
///     }
///     fn spring_energy(&self, depth: f64) -> f64 {
///         self.force * depth
///     }
///     fn normal_force(&self, _depth: f64, _closing_speed: f64) -> f64 {
///         self.force
///     }
/// }
///
/// let ground = Ground { law: Weights { force: 2.0 }, shape: Plane::level(0.1) };
/// let stepper = Stepper::new(Coin::ring(1.0, 0.5))?.with_ground(ground)?;
/// # Ok::<(), tumble::SceneError>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a contact law: it does not implement `ContactLaw<{R}>`",
    label = "this should be a contact law",
    note = "implement `spring_force`, `spring_energy` and `normal_force`; the precision `{R}` of body, ground, friction and gravity must be the same"
)]
pub trait ContactLaw<R: Real = f64> {
    /// Elastic force at a depth (m) above 0: N, at least 0.
    fn spring_force(&self, depth: R) -> R;

    /// Energy in the spring at a depth (m) above 0: J, the integral of
    /// [`spring_force`](Self::spring_force) from 0.
    fn spring_energy(&self, depth: R) -> R;

    /// Force of spring and damper at a depth (m) above 0 that increases at `closing_speed` (m/s):
    /// N, at least 0.
    fn normal_force(&self, depth: R, closing_speed: R) -> R;

    /// Mean force while the depth changes at a constant rate from `start` to `end` (m; below 0 is
    /// above ground) in `seconds`, above 0.
    ///
    /// See [`SpringDamperGround::mean_force`](crate::SpringDamperGround::mean_force).
    #[inline]
    fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        mean_force_by_quadrature(self, start, end, seconds)
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
    /// [`StepError::BrokenLaw`](crate::StepError::BrokenLaw) if they break the contract: that no
    /// force or energy is NaN, and that the spring energy is not negative. Infinite values count as
    /// an overflow, not as a broken contract. It does not check that the law never pulls or that
    /// its damper dissipates, as [`check_ground`](crate::contract::check_ground) does. Override
    /// this method if the law keeps its contract for every finite input, and `check_ground` finds
    /// no fault. The checks then cost nothing. A trusted law that breaks its contract is not
    /// detected.
    #[inline]
    fn is_trusted(&self) -> bool {
        false
    }
}

/// Implements the trait for a pointer to a law, also to `dyn`.
macro_rules! forward {
    ($pointer:ty) => {
        impl<R: Real, L: ContactLaw<R> + ?Sized> ContactLaw<R> for $pointer {
            #[inline]
            fn spring_force(&self, depth: R) -> R {
                (**self).spring_force(depth)
            }
            #[inline]
            fn spring_energy(&self, depth: R) -> R {
                (**self).spring_energy(depth)
            }
            #[inline]
            fn normal_force(&self, depth: R, closing_speed: R) -> R {
                (**self).normal_force(depth, closing_speed)
            }
            #[inline]
            fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
                (**self).mean_force(start, end, seconds)
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
forward!(&L);
#[cfg(feature = "std")]
forward!(alloc::boxed::Box<L>);

/// Provided mean force of contact laws and grounds.
pub(super) fn mean_force_by_quadrature<R: Real, L: ContactLaw<R> + ?Sized>(
    law: &L,
    start: R,
    end: R,
    seconds: R,
) -> MeanForce<R> {
    if !(start > R::ZERO || end > R::ZERO) {
        return MeanForce::NONE;
    }
    let force = |end: R| mean_parts(law, start, end, seconds);
    let (spring, damper) = force(end);
    // One-sided difference over a thousandth of the path, or of the depth if the contact hardly
    // moves.
    let path = (end - start).abs() + (start.abs() + end.abs()) * R::from_f64(1e-3);
    let nudge = path * R::from_f64(1e-3);
    let (spring_beyond, damper_beyond) = force(end + nudge);
    let slope_of = |beyond: R, here: R| {
        if nudge > R::ZERO {
            ((beyond - here) / nudge).at_least(R::ZERO)
        } else {
            R::ZERO
        }
    };
    MeanForce {
        force: not_below_zero(spring + damper),
        slope: slope_of(spring_beyond + damper_beyond, spring + damper),
        stiffness: slope_of(spring_beyond, spring),
        damping: slope_of(damper_beyond, damper) * seconds,
    }
}

/// Returns the larger of a force and 0. NaN is returned as NaN, so that a step detects a broken
/// law.
fn not_below_zero<R: Real>(force: R) -> R {
    if force <= R::ZERO { R::ZERO } else { force }
}

/// Mean force of the spring, and mean of the rest of the normal force.
fn mean_parts<R: Real, L: ContactLaw<R> + ?Sized>(law: &L, start: R, end: R, seconds: R) -> (R, R) {
    let zero = R::ZERO;
    let (from, to) = (start.at_least(zero), end.at_least(zero));
    let (path, submerged) = (end - start, to - from);
    let energy = |depth: R| {
        if depth > zero {
            law.spring_energy(depth)
        } else {
            zero
        }
    };
    let spring_at = |depth: R| {
        if depth > zero {
            law.spring_force(depth)
        } else {
            zero
        }
    };
    // On so short a path the difference of energies is rounding. The force at its middle is then
    // exact to rounding.
    let spring = if submerged.abs() > (from + to) * R::EPSILON.sqrt() {
        (energy(to) - energy(from)) / path
    } else {
        spring_at((from + to) * R::HALF)
    };
    if submerged == zero && path != zero {
        return (spring, zero);
    }
    let closing_speed = path / seconds;
    let share = if path == zero {
        R::ONE
    } else {
        submerged / path
    };
    let mut damper = zero;
    for [place, weight] in unit_3::<R>() {
        let depth = from + submerged * place;
        if depth > zero {
            let beyond = law.normal_force(depth, closing_speed) - law.spring_force(depth);
            damper += beyond * weight;
        }
    }
    (spring, damper * share)
}
