//! Derivatives of the applied force with respect to the pose and to the velocities of the body.
//!
//! They are central differences over a width of `ε^(3/8)` of a unit of the argument, 1.4e-6 in f64
//! and 2.5e-3 in f32. The relative error of a derivative is `ε^(5/8)` from rounding and `ε^(3/4)`
//! from curvature.

use super::{Dynamics, size};
use crate::force::{Force, Wrench};
use crate::real::{Real, Vector};
use crate::rotation::{Axes, Rotation};
use crate::state::Motion;

/// The applied force near a motion of the body.
pub(crate) struct ForceDerivatives<'a, R: Real, D> {
    scene: &'a D,
    motion: &'a Motion<R>,
    /// Unit of length, m: the size of the body.
    length: R,
    /// Unit of speed, m/s: that of the body, plus the one that the force gives it within its size.
    /// Without the latter, rounding of the force hides the damping of a body at rest.
    speed: R,
}

impl<'a, R: Real, D: Dynamics<R>> ForceDerivatives<'a, R, D> {
    /// Derivatives at `motion`.
    pub(crate) fn at(scene: &'a D, motion: &'a Motion<R>) -> Self {
        let length = size(scene);
        let properties = scene.inertia_properties();
        let wrench = scene.force().wrench(motion);
        let spin = properties.angular_velocity(&motion.axes, wrench.torque);
        let pushed = (wrench.force * properties.inverse_mass()).length() + spin.length() * length;
        let speed = motion.linear_velocity.length() + motion.angular_velocity.length() * length;
        Self {
            scene,
            motion,
            length,
            speed: speed + (pushed * length).sqrt(),
        }
    }

    /// Derivative along a translation (m) and a rotation (rad) of the body, world axes. Its
    /// velocities stay the same.
    pub(crate) fn along_path(&self, path: R::Vec3, turn: R::Vec3) -> Wrench<R> {
        // The rounding of a place depends on the place, that of an angle does not.
        let distance = if path == R::Vec3::ZERO {
            R::ZERO
        } else {
            self.motion.position.length()
        };
        self.difference(self.length + distance, |by| {
            let rotation = Rotation::<R>::from_rotation_vector(turn * by);
            let Axes { x, y, z } = self.motion.axes;
            Motion {
                position: self.motion.position + path * by,
                axes: Axes {
                    x: rotation.apply(x),
                    y: rotation.apply(y),
                    z: rotation.apply(z),
                },
                ..*self.motion
            }
        })
    }

    /// Derivative along a change of the linear (m/s) and of the angular velocity (rad/s), world
    /// axes.
    pub(crate) fn along_velocity(&self, linear: R::Vec3, angular: R::Vec3) -> Wrench<R> {
        self.difference(self.speed, |by| Motion {
            linear_velocity: self.motion.linear_velocity + linear * by,
            angular_velocity: self.motion.angular_velocity + angular * by,
            ..*self.motion
        })
    }

    /// Central difference for this unit of the argument, or for 1 if that is 0.
    fn difference(&self, unit: R, moved: impl Fn(R) -> Motion<R>) -> Wrench<R> {
        let root = R::EPSILON.sqrt();
        let unit = if unit > R::ZERO { unit } else { R::ONE };
        let nudge = (root * root.sqrt()).sqrt() * unit;
        let wrench = |by| self.scene.force().wrench(&moved(by));
        let difference = wrench(nudge).plus(&wrench(-nudge), -R::ONE);
        Wrench::ZERO.plus(&difference, R::ONE / (nudge + nudge))
    }
}
