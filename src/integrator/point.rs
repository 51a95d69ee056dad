//! States and their time derivatives as vectors of thirteen numbers.

use crate::body::ContactRange;
use crate::contact::{Load, Motion};
use crate::real::{Real, Vector};
use crate::rotation::{Axes, Rotation};
use crate::scene::Dynamics;
use crate::state::State;

/// The thirteen numbers that a Runge-Kutta method adds: a state, or its time derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point<R: Real> {
    pub(crate) position: R::Vec3,
    pub(crate) linear_velocity: R::Vec3,
    pub(crate) orientation: Rotation<R>,
    pub(crate) angular_momentum: R::Vec3,
}

impl<R: Real> Point<R> {
    /// Returns the point of thirteen zeros: no change.
    #[inline]
    pub(crate) fn zero() -> Self {
        Self {
            position: R::Vec3::ZERO,
            linear_velocity: R::Vec3::ZERO,
            orientation: Rotation::of_parts(R::ZERO, R::Vec3::ZERO),
            angular_momentum: R::Vec3::ZERO,
        }
    }

    #[inline]
    pub(crate) fn of(state: &State<R>) -> Self {
        Self {
            position: state.position,
            linear_velocity: state.linear_velocity,
            orientation: state.rotation(),
            angular_momentum: state.angular_momentum,
        }
    }

    #[inline]
    pub(crate) fn to_state(self) -> State<R> {
        State {
            position: self.position,
            linear_velocity: self.linear_velocity,
            orientation: self.orientation.normalised().to_quat(),
            angular_momentum: self.angular_momentum,
        }
    }

    /// Returns the point with the quaternion scaled to length 1.
    #[inline]
    pub(crate) fn normalised(self) -> Self {
        Self {
            orientation: self.orientation.normalised(),
            ..self
        }
    }

    #[inline]
    pub(crate) fn plus(&self, slope: &Self, seconds: R) -> Self {
        Self {
            position: self.position + slope.position * seconds,
            linear_velocity: self.linear_velocity + slope.linear_velocity * seconds,
            orientation: self.orientation.plus(slope.orientation, seconds),
            angular_momentum: self.angular_momentum + slope.angular_momentum * seconds,
        }
    }

    /// Returns the point with each number multiplied by a factor.
    #[inline]
    pub(crate) fn scaled(&self, factor: R) -> Self {
        Self {
            position: self.position * factor,
            linear_velocity: self.linear_velocity * factor,
            orientation: self.orientation.scaled(factor),
            angular_momentum: self.angular_momentum * factor,
        }
    }

    /// Returns the time derivative at this point.
    #[inline(always)]
    pub(crate) fn slope(&self, scene: &impl Dynamics<R>) -> Self {
        let mut range = ContactRange::NONE;
        self.slope_near(scene, &mut range)
    }

    /// Returns the time derivative, given the contact range of a nearby point.
    ///
    /// `range` is updated. [`ContactRange::NONE`] is valid if no range is known.
    #[inline(always)]
    pub(crate) fn slope_near(&self, scene: &impl Dynamics<R>, range: &mut ContactRange) -> Self {
        self.slope_along(scene, self.orientation.axes_of_any_length(), range)
    }

    /// Returns the time derivative, given the axes and the contact range of a nearby point.
    #[inline(always)]
    pub(crate) fn slope_along(
        &self,
        scene: &impl Dynamics<R>,
        axes: Axes<R>,
        range: &mut ContactRange,
    ) -> Self {
        let motion = self.motion_along(scene, axes);
        *range = scene
            .contact_model()
            .range_near(*range, motion.position, &motion.axes);
        self.slope_under(
            scene,
            &motion,
            &scene.contact_model().load_on(*range, &motion),
        )
    }

    /// Returns pose, axes and velocities at this point, on which the forces depend.
    #[inline(always)]
    pub(crate) fn motion(&self, scene: &impl Dynamics<R>) -> Motion<R> {
        self.motion_along(scene, self.orientation.axes_of_any_length())
    }

    /// Returns position and velocities at this point for the given axes.
    #[inline(always)]
    pub(crate) fn motion_along(&self, scene: &impl Dynamics<R>, axes: Axes<R>) -> Motion<R> {
        let mass = scene.inertia_properties();
        Motion {
            position: self.position,
            axes,
            linear_velocity: self.linear_velocity,
            angular_velocity: mass.angular_velocity(&axes, self.angular_momentum),
        }
    }

    /// Returns the time derivative at this point for a given load of the contacts.
    #[inline(always)]
    pub(crate) fn slope_under(
        &self,
        scene: &impl Dynamics<R>,
        motion: &Motion<R>,
        load: &Load<R>,
    ) -> Self {
        let load = scene.with_applied_force(*load, motion);
        let inverse_mass = scene.inertia_properties().inverse_mass();
        Self {
            position: self.linear_velocity,
            linear_velocity: load.force * inverse_mass + scene.gravity(),
            orientation: self.orientation.rate(motion.angular_velocity),
            angular_momentum: load.torque,
        }
    }
}
