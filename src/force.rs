//! Applied forces: force and torque on the body besides gravity and contacts.

mod air_drag;
mod constant_force;
mod spin_drag;
mod spin_lift;
mod sum;
mod wind;

pub use air_drag::AirDrag;
pub use constant_force::ConstantForce;
pub use spin_drag::SpinDrag;
pub use spin_lift::SpinLift;
pub use wind::Wind;

use crate::error::SceneError;
use crate::real::{Real, Vector};
use crate::state::Motion;

/// A force on the body that depends on its pose and its velocities, not on time.
///
/// A scene has one applied force. A tuple of two to four forces acts as their sum. Gravity is a
/// separate part of a scene, see [`Gravity`](crate::Gravity).
///
/// *To the implementer:*
///
/// - [`wrench`](Self::wrench) is finite for every finite motion, and continuous.
/// - [`is_passive`](Self::is_passive) is true if the wrench never does positive work:
///   `force · v + torque · ω <= 0`. A constant part does not count, because it has a potential. The
///   energy then never increases with
///   [`EnergyMomentum`](crate::EnergyMomentum). Another force is a *drive*. Its work is stated by
///   [`Step::drive_work`](crate::Step::drive_work), and the energy minus this work never increases.
///
/// [`contract::check_force`](crate::contract::check_force) tests an implementation. A step returns
/// [`StepError::BrokenLaw`](crate::StepError::BrokenLaw) for a force that is not finite, or that is
/// passive and does positive work.
///
/// | force | use it for |
/// |---|---|
/// | [`AirDrag`] | drag of still air or water: linear, quadratic or both |
/// | [`SpinLift`] | lift of a spinning ball (Magnus effect) |
/// | [`SpinDrag`] | torque of the air against spin |
/// | [`Wind`] around one of them | the same in moving air |
/// | [`ConstantForce`] | thrust, buoyancy, a uniform field: has a potential |
/// | a tuple of them | their sum |
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Force, Motion, Wrench};
///
/// /// A spring that pulls the centre of mass towards the z axis. It is not passive: it returns the
/// /// energy that it has stored.
/// struct Tether {
///     stiffness: f64, // N/m
/// }
///
/// impl Force for Tether {
///     fn wrench(&self, motion: &Motion) -> Wrench {
///         let [x, y, _] = motion.position.to_array();
///         Wrench { force: DVec3::new(x, y, 0.0) * -self.stiffness, torque: DVec3::ZERO }
///     }
///     fn is_passive(&self) -> bool {
///         false
///     }
/// }
/// ```
///
/// *Limits:* the force depends on the state alone, so a thrust that is switched on and off is two
/// scenes. An explicit method needs a step below about `2 m/c` for a linear drag `c`:
/// [`Stepper::largest_stable_step`](crate::Stepper::largest_stable_step) computes the limit of any
/// force at a state. [`Radau5`](crate::Radau5) has no such limit.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not an applied force: it does not implement `Force<{R}>`",
    label = "this should be an applied force",
    note = "implement `wrench` and `is_passive`; the precision `{R}` of body and force must be the same"
)]
pub trait Force<R: Real = f64> {
    /// Force at the centre of mass (N) and torque about it (N m), world axes, without the
    /// [constant part](Self::constant_force).
    fn wrench(&self, motion: &Motion<R>) -> Wrench<R>;

    /// Returns true if the [`wrench`](Self::wrench) never does positive work on the body. The
    /// [constant part](Self::constant_force) does not count, because it has a potential. The method
    /// must always return the same value.
    fn is_passive(&self) -> bool;

    /// Part of the force that is the same in every motion, N, world axes. Default: none.
    ///
    /// It is treated like gravity: it has the potential energy `-F · x`, which counts as
    /// [`Energy::gravity`](crate::Energy::gravity), and all methods integrate it exactly in flight.
    #[inline]
    fn constant_force(&self) -> Option<R::Vec3> {
        None
    }

    /// Power of the force in a motion, W, without its constant part.
    ///
    /// The provided method counts the power as drag if the force is passive, else as drive.
    #[inline]
    fn power(&self, motion: &Motion<R>) -> ForcePower<R> {
        let power = self.wrench(motion).power(motion);
        if self.is_passive() {
            ForcePower {
                drag: power,
                drive: R::ZERO,
            }
        } else {
            ForcePower {
                drag: R::ZERO,
                drive: power,
            }
        }
    }

    /// Change of the wrench for a small change of the linear velocity (m/s) and of the angular
    /// velocity (rad/s), to first order. For implicit methods.
    ///
    /// The provided method takes a difference. The values only steer Newton's iteration: an error
    /// in them costs iterations, not accuracy.
    #[inline]
    fn wrench_change(
        &self,
        motion: &Motion<R>,
        linear_change: R::Vec3,
        angular_change: R::Vec3,
    ) -> Wrench<R> {
        change_by_difference(self, motion, linear_change, angular_change)
    }

    /// Returns false if the force is zero, except for its constant part. Nothing is then computed
    /// for it. It must always return the same value. Default: true.
    #[inline]
    fn acts(&self) -> bool {
        true
    }

    /// Checks that the force is valid. Called once, when a scene is composed.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a quantity is invalid. The error names the quantity, the rule and
    /// the value.
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }

    /// Returns true if the values of the force need no check while a step evaluates them. Default:
    /// false.
    ///
    /// Override this method if the force keeps its contract for every finite motion. The checks
    /// then cost nothing. A trusted force that breaks its contract is not detected.
    #[inline]
    fn is_trusted(&self) -> bool {
        false
    }
}

/// Implements the trait for a pointer to a force, also to `dyn`.
macro_rules! forward {
    ($pointer:ty) => {
        impl<R: Real, E: Force<R> + ?Sized> Force<R> for $pointer {
            #[inline]
            fn wrench(&self, motion: &Motion<R>) -> Wrench<R> {
                (**self).wrench(motion)
            }
            #[inline]
            fn is_passive(&self) -> bool {
                (**self).is_passive()
            }
            #[inline]
            fn constant_force(&self) -> Option<R::Vec3> {
                (**self).constant_force()
            }
            #[inline]
            fn power(&self, motion: &Motion<R>) -> ForcePower<R> {
                (**self).power(motion)
            }
            #[inline]
            fn wrench_change(
                &self,
                motion: &Motion<R>,
                linear_change: R::Vec3,
                angular_change: R::Vec3,
            ) -> Wrench<R> {
                (**self).wrench_change(motion, linear_change, angular_change)
            }
            #[inline]
            fn acts(&self) -> bool {
                (**self).acts()
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
forward!(&E);
#[cfg(feature = "std")]
forward!(alloc::boxed::Box<E>);

/// Force and torque of an applied force, world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrench<R: Real = f64> {
    /// Force at the centre of mass, N.
    pub force: R::Vec3,
    /// Torque about the centre of mass, N m.
    pub torque: R::Vec3,
}

impl<R: Real> Wrench<R> {
    /// No force and no torque.
    pub const ZERO: Self = Self {
        force: R::Vec3::ZERO,
        torque: R::Vec3::ZERO,
    };

    /// Force at the centre of mass (N) without a torque.
    #[inline]
    #[must_use]
    pub fn of_force(force: R::Vec3) -> Self {
        Self {
            force,
            torque: R::Vec3::ZERO,
        }
    }

    /// Torque (N m) without a force.
    #[inline]
    #[must_use]
    pub fn of_torque(torque: R::Vec3) -> Self {
        Self {
            force: R::Vec3::ZERO,
            torque,
        }
    }

    /// Returns `self + other * factor`.
    #[inline]
    #[must_use]
    pub fn plus(&self, other: &Self, factor: R) -> Self {
        Self {
            force: self.force + other.force * factor,
            torque: self.torque + other.torque * factor,
        }
    }

    /// Power on a body in a motion, W: `force · v + torque · ω`.
    #[inline]
    #[must_use]
    pub fn power(&self, motion: &Motion<R>) -> R {
        self.force.dot(motion.linear_velocity) + self.torque.dot(motion.angular_velocity)
    }

    /// Returns true if all components are finite.
    #[inline]
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.force.is_finite() && self.torque.is_finite()
    }
}

/// Power of an applied force by kind, W.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForcePower<R = f64> {
    /// Power of the passive part, at most 0.
    pub drag: R,
    /// Power of the drives, of either sign.
    pub drive: R,
}

/// Provided [`Force::wrench_change`]. The difference is taken over a change of about the square
/// root of the precision, relative to the velocities.
fn change_by_difference<R: Real, E: Force<R> + ?Sized>(
    force: &E,
    motion: &Motion<R>,
    linear_change: R::Vec3,
    angular_change: R::Vec3,
) -> Wrench<R> {
    let share = |change: R::Vec3, velocity: R::Vec3| {
        let (change, speed) = (change.length(), velocity.length());
        let nudge = R::EPSILON.sqrt() * speed.at_least(R::EPSILON.sqrt());
        if change > R::ZERO {
            nudge / change
        } else {
            R::MAX
        }
    };
    let factor = share(linear_change, motion.linear_velocity)
        .at_most(share(angular_change, motion.angular_velocity));
    if !(factor > R::ZERO && factor < R::MAX) {
        return Wrench::ZERO;
    }
    let moved = Motion {
        linear_velocity: motion.linear_velocity + linear_change * factor,
        angular_velocity: motion.angular_velocity + angular_change * factor,
        ..*motion
    };
    let difference = force.wrench(&moved).plus(&force.wrench(motion), -R::ONE);
    Wrench::ZERO.plus(&difference, R::ONE / factor)
}

/// Absence of an applied force. It costs nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NoForce;

impl<R: Real> Force<R> for NoForce {
    #[inline(always)]
    fn wrench(&self, _motion: &Motion<R>) -> Wrench<R> {
        Wrench::ZERO
    }
    #[inline(always)]
    fn is_passive(&self) -> bool {
        true
    }
    #[inline(always)]
    fn acts(&self) -> bool {
        false
    }
    #[inline(always)]
    fn is_trusted(&self) -> bool {
        true
    }
}
