//! Ground whose material moves along its own surface: conveyors and turntables.

use super::{GroundBounds, MeanForce, OneSurface, Plane, SpringDamperGround, Surface};
use crate::error::{self, Rule, SceneError};
use crate::real::{Real, Vector};
use crate::state::Motion;

/// Motion of a ground's material: that of a rigid body with constant velocity and angular velocity.
///
/// The material at the position x has the velocity `velocity + angular_velocity × x`, along the
/// surface. So the surface stays where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "R::Vec3: serde::Serialize",
        deserialize = "R::Vec3: serde::Deserialize<'de>"
    ))
)]
pub struct GroundMotion<R: Real = f64> {
    /// Velocity of the material at the origin, m/s, world axes.
    pub velocity: R::Vec3,
    /// Angular velocity, rad/s, world axes.
    pub angular_velocity: R::Vec3,
}

impl<R: Real> GroundMotion<R> {
    /// Creates a motion with the same velocity (m/s, world axes) everywhere.
    #[must_use]
    pub fn translation(velocity: R::Vec3) -> Self {
        Self {
            velocity,
            angular_velocity: R::Vec3::ZERO,
        }
    }

    /// Creates a rotation with an angular velocity (rad/s) about the axis through `centre` (m).
    ///
    /// Both are in world axes.
    #[must_use]
    pub fn rotation(centre: R::Vec3, angular_velocity: R::Vec3) -> Self {
        // The point of the axis nearest to the origin: any other adds its rounding to the velocity.
        let square = angular_velocity.length_squared();
        let nearest = if square > R::ZERO {
            centre - angular_velocity * (centre.dot(angular_velocity) / square)
        } else {
            centre
        };
        Self {
            velocity: nearest.cross(angular_velocity),
            angular_velocity,
        }
    }

    /// Velocity of the material at a position (m from the origin), m/s, world axes.
    #[inline]
    #[must_use]
    pub fn velocity_at(&self, position: R::Vec3) -> R::Vec3 {
        self.velocity + self.angular_velocity.cross(position)
    }

    /// Motion of a body relative to the ground, in the same pose: the velocity of each point of the
    /// body is that relative to the ground below it.
    #[inline]
    #[must_use]
    pub(crate) fn seen_by(&self, motion: &Motion<R>) -> Motion<R> {
        Motion {
            linear_velocity: motion.linear_velocity - self.velocity_at(motion.position),
            angular_velocity: motion.angular_velocity - self.angular_velocity,
            ..*motion
        }
    }

    /// Power of a force and a torque about a position, if they act on the material there, W.
    #[inline]
    pub(crate) fn power(&self, position: R::Vec3, [force, torque]: [R::Vec3; 2]) -> R {
        force.dot(self.velocity_at(position)) + torque.dot(self.angular_velocity)
    }

    pub(crate) fn check(&self) -> Result<(), SceneError> {
        let (v, w) = (self.velocity, self.angular_velocity);
        // The angular velocity of a turntable determines its velocity.
        for (name, rate) in [
            ("x of the angular velocity of the ground", w.x()),
            ("y of the angular velocity of the ground", w.y()),
            ("z of the angular velocity of the ground", w.z()),
        ] {
            error::finite(name, rate, " rad/s")?;
        }
        for (name, speed) in [
            ("x of the velocity of the ground", v.x()),
            ("y of the velocity of the ground", v.y()),
            ("z of the velocity of the ground", v.z()),
        ] {
            error::finite(name, speed, " m/s")?;
        }
        // The check against a plane compares lengths.
        let (rate, speed) = (w.length_squared(), v.length_squared());
        error::finite(
            "square of the angular velocity of the ground",
            rate,
            " rad²/s²",
        )?;
        error::finite("square of the velocity of the ground", speed, " m²/s²")
    }

    /// Checks that both velocities are 0.
    pub(super) fn check_at_rest(
        &self,
        [velocity, angular_velocity]: [&'static str; 2],
    ) -> Result<(), SceneError> {
        zero(velocity, self.velocity.length(), " m/s")?;
        zero(angular_velocity, self.angular_velocity.length(), " rad/s")
    }

    /// Checks that a plane stays where it is: the velocity is along it, and the angular velocity
    /// across it.
    fn check_along(&self, plane: &Plane<R>) -> Result<(), SceneError> {
        let n = plane.normal;
        let tilting = n.cross(self.angular_velocity).length();
        let rising = self.velocity_at(n * plane.height).dot(n).abs();
        let rounding = R::EPSILON * R::from_f64(64.0);
        let rate = self.angular_velocity.length();
        let speed = self.velocity.length() + rate * plane.height.abs();
        let (across, along) = (
            "velocity of the ground across its plane",
            "angular velocity of the ground along its plane",
        );
        if rising > speed * rounding {
            let value = rising.to_f64();
            return Err(SceneError::new(across, Rule::Zero, value, " m/s"));
        }
        if tilting > rate * rounding {
            let value = tilting.to_f64();
            return Err(SceneError::new(along, Rule::Zero, value, " rad/s"));
        }
        Ok(())
    }
}

/// Checks that a value is 0.
fn zero<R: Real>(quantity: &'static str, value: R, unit: &'static str) -> Result<(), SceneError> {
    if value == R::ZERO {
        Ok(())
    } else {
        Err(SceneError::new(quantity, Rule::Zero, value.to_f64(), unit))
    }
}

/// Ground whose material moves along its surface.
///
/// Friction acts on the slip relative to the material. So the ground does work on the body: it is a
/// drive. [`Dissipation::drive`](crate::Dissipation::drive) is its power, and the energy after a
/// step of [`EnergyMomentum`](crate::EnergyMomentum) is at most the energy before it plus
/// [`Step::drive_work`](crate::Step::drive_work).
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Coulomb, EnergyMomentum, FlatGround, MovingGround, Sphere, State, Stepper};
/// use tumble::UniformGravity;
///
/// // A ball that is set down at rest on a turntable.
/// let turntable = MovingGround::turntable(FlatGround::level(1e5, 10.0), DVec3::ZERO, 2.0); // rad/s
/// let stepper = Stepper::builder(Sphere::solid(0.1, 0.02)) // kg, m
///     .gravity(UniformGravity::down(9.8))
///     .ground(turntable)
///     .friction(Coulomb { coefficient: 0.5, slip_speed: 1e-4 })
///     .integrator(EnergyMomentum { time_step: 1e-3 })
///     .build()?;
/// let mut ball = State::at(DVec3::new(0.3, 0.0, 0.02 - 9.8e-6));
/// stepper.advance(&mut ball, 1.0)?; // s
/// // It rolls on a circle, at 2/7 of the rate of the table.
/// let speed = ball.linear_velocity.length();
/// assert!(speed > 0.0 && speed < 2.0 * 0.3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// *Limits:* the material moves, and what is stated in world axes stays: the shape, the region of a
/// [`FrictionPatch`](crate::FrictionPatch), and the grain of an
/// [`AnisotropicCoulomb`](crate::AnisotropicCoulomb). So a carpet cannot turn with a turntable. The
/// motion is constant, so a body does not slow the ground. A body on a moving ground never falls
/// asleep, and its outcome is never proved. When a scene is composed, a motion across the surface
/// is refused for planes only. For other shapes [`check_ground`](crate::contract::check_ground)
/// finds it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "G: serde::Serialize, R::Vec3: serde::Serialize",
        deserialize = "G: serde::Deserialize<'de>, R::Vec3: serde::Deserialize<'de>"
    ))
)]
pub struct MovingGround<G, R: Real = f64> {
    /// Surface and contact law. It has no motion of its own.
    pub ground: G,
    /// Motion of the material.
    pub motion: GroundMotion<R>,
}

impl<R: Real, G: SpringDamperGround<R>> MovingGround<G, R> {
    /// Creates a belt that moves with a velocity (m/s, world axes) along the surface of a ground.
    #[must_use]
    pub fn conveyor(ground: G, velocity: R::Vec3) -> Self {
        Self {
            ground,
            motion: GroundMotion::translation(velocity),
        }
    }

    /// Creates a level table that rotates at `rate` (rad/s, counterclockwise from above) about the
    /// vertical axis through `centre` (m).
    #[must_use]
    pub fn turntable(ground: G, centre: R::Vec3, rate: R) -> Self {
        Self {
            ground,
            motion: GroundMotion::rotation(centre, R::Vec3::new(R::ZERO, R::ZERO, rate)),
        }
    }
}

impl<R: Real, G: SpringDamperGround<R>> SpringDamperGround<R> for MovingGround<G, R> {
    #[inline]
    fn surface(&self, point: R::Vec3) -> Surface<R> {
        self.ground.surface(point)
    }

    #[inline]
    fn surface_under(&self, centre: R::Vec3, radius: R) -> Option<Surface<R>> {
        self.ground.surface_under(centre, radius)
    }

    #[inline]
    fn spring_force(&self, depth: R) -> R {
        self.ground.spring_force(depth)
    }

    #[inline]
    fn spring_energy(&self, depth: R) -> R {
        self.ground.spring_energy(depth)
    }

    #[inline]
    fn normal_force(&self, depth: R, closing_speed: R) -> R {
        self.ground.normal_force(depth, closing_speed)
    }

    #[inline]
    fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        self.ground.mean_force(start, end, seconds)
    }

    #[inline]
    fn bounds(&self) -> GroundBounds<R> {
        self.ground.bounds()
    }

    #[inline]
    fn surfaces(&self) -> Option<usize> {
        self.ground.surfaces()
    }

    #[inline]
    fn with_surface(&self, index: usize, visit: &mut dyn FnMut(&dyn SpringDamperGround<R>)) {
        self.ground.with_surface(index, visit);
    }

    #[inline]
    fn motion(&self) -> Option<GroundMotion<R>> {
        Some(self.motion)
    }

    fn check(&self) -> Result<(), SceneError> {
        self.ground.check()?;
        if let Some(motion) = self.ground.motion() {
            motion.check_at_rest([
                "velocity of the ground inside a moving ground",
                "angular velocity of the ground inside a moving ground",
            ])?;
        }
        self.motion.check()?;
        let mut checked = Ok(());
        for index in 0..self.ground.surfaces().unwrap_or(1) {
            if let GroundBounds::Plane(plane) = OneSurface::of(&self.ground, index).bounds() {
                checked = checked.and_then(|()| self.motion.check_along(&plane));
            }
        }
        checked
    }

    #[inline]
    fn is_trusted(&self) -> bool {
        self.ground.is_trusted()
    }
}
