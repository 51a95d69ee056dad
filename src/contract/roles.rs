//! Scenes for the checks of an integrator that each have a role which the other scenes lack: an
//! applied force, a ground that moves, or resistance to rolling and spinning.

use super::scenes::{BoxBody, Parameters, Setup, v};
use crate::error::{self, SceneError};
use crate::force::{Force, Wrench};
use crate::friction::{SmoothCoulomb, WithResistance};
use crate::gravity::UniformGravity;
use crate::ground::{FlatGround, GroundMotion, MovingGround};
use crate::real::{Real, Vector};
use crate::scene::Scene;
use crate::state::{Motion, State};

/// Scene that can have all roles.
pub(super) type FullScene<R> = Scene<
    BoxBody<R>,
    MovingGround<FlatGround<R>, R>,
    WithResistance<SmoothCoulomb<R>, R>,
    UniformGravity<R>,
    R,
    Mount<R>,
>;

/// Spring and damper from a point of the body to a fixed point.
///
/// The force is `stiffness (anchor - p) - damping v`, with position p and velocity v of the point
/// of the body. It acts at that point, so it has a torque too.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mount<R: Real> {
    /// Fixed point, m, world axes.
    anchor: R::Vec3,
    /// Point of the body, m, body axes.
    arm: R::Vec3,
    /// N/m.
    stiffness: R,
    /// N s/m.
    damping: R,
}

impl<R: Real> Force<R> for Mount<R> {
    fn wrench(&self, motion: &Motion<R>) -> Wrench<R> {
        let arm = motion.axes.to_world(self.arm);
        let stretch = self.anchor - motion.position - arm;
        let force = stretch * self.stiffness - motion.velocity_at(arm) * self.damping;
        Wrench {
            force,
            torque: arm.cross(force),
        }
    }
    fn is_passive(&self) -> bool {
        false
    }
    fn acts(&self) -> bool {
        self.stiffness > R::ZERO || self.damping > R::ZERO
    }
    fn check(&self) -> Result<(), SceneError> {
        error::at_least_zero("stiffness of the mount", self.stiffness, " N/m")?;
        error::at_least_zero("damping of the mount", self.damping, " N s/m")
    }
}

/// Parameters of the roles, with the metre, the kilogram and the integrator's step size as units.
#[derive(Clone, Copy)]
struct Roles<R: Real> {
    mount: Mount<R>,
    /// Velocity of the ground at the origin.
    velocity: R::Vec3,
    /// Angular velocity of the ground about the vertical.
    rate: R,
    /// Largest torque against rolling and spinning per normal force.
    resistance: R,
}

impl<R: Real> Roles<R> {
    fn none() -> Self {
        Self {
            mount: Mount {
                anchor: R::Vec3::ZERO,
                arm: R::Vec3::ZERO,
                stiffness: R::ZERO,
                damping: R::ZERO,
            },
            velocity: R::Vec3::ZERO,
            rate: R::ZERO,
            resistance: R::ZERO,
        }
    }

    /// A mount beside the centre of mass. An oscillation takes about 40 steps.
    fn mounted(anchor: R::Vec3) -> Self {
        Self {
            mount: Mount {
                anchor,
                arm: v::<R>(0.3, -0.2, 0.1),
                stiffness: R::from_f64(0.02),
                damping: R::from_f64(0.05),
            },
            ..Self::none()
        }
    }

    /// A turntable about a point beside the box.
    fn turning() -> Self {
        Self {
            velocity: v::<R>(-0.05, 0.08, 0.0),
            rate: R::from_f64(0.05),
            ..Self::none()
        }
    }

    fn resisting() -> Self {
        Self {
            resistance: R::from_f64(0.2),
            ..Self::none()
        }
    }
}

/// Scenes with one role each, in which all motion is smooth.
///
/// A method that leaves out the role moves the body by a considerable part of its motion.
pub(super) fn with_each_role<R: Real>(
    time_step: R,
) -> [Result<Setup<R, FullScene<R>>, SceneError>; 4] {
    let with_momentum = |parameters: Parameters<R>, x, y, z| Parameters {
        start: parameters.start.with_angular_momentum(v::<R>(x, y, z)),
        ..parameters
    };
    let tame = Parameters::tame();
    let rolling = with_momentum(tame, 0.003, -0.002, 0.006);
    let flight = with_momentum(Parameters::flight(), 0.003, 0.006, -0.004);
    let above = Roles::mounted(v::<R>(0.3, 0.1, 0.6));
    let beside = Roles::mounted(v::<R>(0.7, 0.1, 0.26));
    [
        ("a box that flies on a mount", flight, above),
        ("a box that slides on a mount", tame, beside),
        ("a box on a turntable", tame, Roles::turning()),
        (
            "a box with resistance to rolling and spinning",
            rolling,
            Roles::resisting(),
        ),
    ]
    .map(|(name, parameters, roles)| compose(name, &parameters, &roles, time_step))
}

/// Oscillator `y'' + damping y' + stiffness y = 0`: a box on a mount at its centre, high above the
/// ground.
///
/// The stiffness is in 1/s² and the damping in 1/s. The start has a deflection along x, a velocity
/// along y, and both along z. A deflection of 1 m goes with a velocity of 1 m per `time` (s).
pub(super) fn oscillator<R: Real>(
    stiffness: R,
    damping: R,
    time: R,
) -> Result<Setup<R, FullScene<R>>, SceneError> {
    let parameters = Parameters {
        level: R::from_f64(-1e9),
        start: State::at(v::<R>(1.0, 0.0, 0.6)).with_linear_velocity(v::<R>(0.0, 1.0, 0.8)),
        ..Parameters::flight()
    };
    let none = Roles::none();
    let roles = Roles {
        mount: Mount {
            stiffness: stiffness * time * time,
            damping: damping * time,
            ..none.mount
        },
        ..none
    };
    compose("an oscillator", &parameters, &roles, time)
}

fn compose<R: Real>(
    name: &'static str,
    parameters: &Parameters<R>,
    roles: &Roles<R>,
    time_step: R,
) -> Result<Setup<R, FullScene<R>>, SceneError> {
    let per_second = R::ONE / time_step;
    let (body, ground, friction, gravity) = parameters.parts(time_step)?;
    let ground = MovingGround {
        ground,
        motion: GroundMotion {
            velocity: roles.velocity * per_second,
            angular_velocity: R::Vec3::new(R::ZERO, R::ZERO, roles.rate * per_second),
        },
    };
    let friction = WithResistance {
        friction,
        rolling: roles.resistance,
        spinning: roles.resistance,
        turn_speed: R::from_f64(0.02) * per_second,
    };
    let mount = Mount {
        stiffness: roles.mount.stiffness * per_second * per_second,
        damping: roles.mount.damping * per_second,
        ..roles.mount
    };
    Ok(Setup {
        name,
        case: 0,
        scene: Scene::new(body, ground, friction, gravity)?.with_force(mount)?,
        start: parameters.start_in(time_step),
    })
}

#[cfg(test)]
mod tests;
