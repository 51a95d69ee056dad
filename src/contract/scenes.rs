//! Scenes for the checks of an integrator, scaled so that its step size suits them or, on purpose,
//! does not.

use super::plan::Draw;
use crate::body::{ContactPoint, PointCloud};
use crate::error::SceneError;
use crate::friction::SmoothCoulomb;
use crate::gravity::UniformGravity;
use crate::ground::{FlatGround, Plane};
use crate::real::{Real, Vector};
use crate::scene::Scene;
use crate::state::State;

pub(super) type BoxBody<R> = PointCloud<R, [ContactPoint<R>; 8]>;

/// Scene without an applied force, on a ground that does not move.
pub(super) type Plain<R> = Scene<BoxBody<R>, FlatGround<R>, SmoothCoulomb<R>, UniformGravity<R>, R>;

/// Box of 1 m and 1 kg on flat ground.
pub(super) struct Setup<R: Real, S = Plain<R>> {
    pub(super) name: &'static str,
    pub(super) case: u32,
    pub(super) scene: S,
    pub(super) start: State<R>,
}

/// Parameters of a scene, with the metre, the kilogram and the integrator's step size as units.
#[derive(Clone, Copy)]
pub(super) struct Parameters<R: Real> {
    /// Frequency of the body on all four lower corners.
    pub(super) frequency: R,
    pub(super) damping_ratio: R,
    pub(super) coefficient: R,
    pub(super) slip_speed: R,
    pub(super) gravity: R,
    /// Height of the ground.
    pub(super) level: R,
    /// Radius of the corners.
    pub(super) radius: R,
    pub(super) start: State<R>,
}

impl<R: Real> Setup<R> {
    /// Free flight with tumbling, without gravity.
    pub(super) fn flight(time_step: R) -> Result<Self, SceneError> {
        Self::new("free flight", 0, &Parameters::flight(), time_step)
    }

    /// Sliding with all four lower corners on the springs. No contact opens or closes.
    pub(super) fn slide(time_step: R) -> Result<Self, SceneError> {
        let parameters = Parameters::tame();
        Self::new("a box that slides", 0, &parameters, time_step)
    }

    /// Fall on a corner.
    pub(super) fn fall(time_step: R) -> Result<Self, SceneError> {
        let parameters = Parameters {
            start: State::at(v::<R>(0.0, 0.0, 0.6))
                .with_rotation_vector(v::<R>(0.7, 0.4, 0.2))
                .with_linear_velocity(v::<R>(0.02, 0.0, -0.02))
                .with_angular_momentum(v::<R>(0.001, -0.002, 0.001)),
            ..Parameters::tame()
        };
        Self::new("a box that falls on a corner", 0, &parameters, time_step)
    }

    /// Random scene. Most random scenes are far too stiff for the step size.
    pub(super) fn wild(draw: &mut Draw, case: u32, time_step: R) -> Result<Self, SceneError> {
        let around = |draw: &mut Draw, largest: f64, octaves| {
            R::from_f64(largest) * draw.scale::<R>(octaves)
        };
        let or_none = |draw: &mut Draw, largest: f64, octaves| match draw.pick(4) {
            0 => R::ZERO,
            _ => around(draw, largest, octaves),
        };
        let speed = or_none(draw, 1.0, 20);
        let spin = or_none(draw, 10.0, 24);
        let parameters = Parameters {
            frequency: around(draw, 1e4, 26),
            damping_ratio: or_none(draw, 1e3, 20),
            coefficient: or_none(draw, 1e2, 14),
            slip_speed: around(draw, 1.0, 40),
            gravity: or_none(draw, 1.0, 26),
            level: R::ZERO,
            radius: or_none(draw, 0.3, 3),
            start: State {
                orientation: draw.rotation::<R>().to_quat(),
                ..State::at(R::Vec3::new(R::ZERO, R::ZERO, draw.either::<R>()))
                    .with_linear_velocity(draw.direction::<R>() * speed)
                    .with_angular_momentum(draw.direction::<R>() * spin)
            },
        };
        Self::new("a random scene", case, &parameters, time_step)
    }

    fn new(
        name: &'static str,
        case: u32,
        parameters: &Parameters<R>,
        time_step: R,
    ) -> Result<Self, SceneError> {
        let (body, ground, friction, gravity) = parameters.parts(time_step)?;
        Ok(Self {
            name,
            case,
            scene: Scene::new(body, ground, friction, gravity)?,
            start: parameters.start_in(time_step),
        })
    }
}

impl<R: Real> Parameters<R> {
    /// Parameters of a scene that every method resolves.
    ///
    /// An oscillation takes 31 steps, and friction stops a slip in 10 or more. The springs are
    /// compressed by half of the box's half height, so that small oscillations open no contact.
    pub(super) fn tame() -> Self {
        let c = R::from_f64;
        Self {
            frequency: c(0.2),
            damping_ratio: c(0.3),
            coefficient: c(0.3),
            slip_speed: c(0.02),
            gravity: c(0.15 * 0.2 * 0.2),
            level: R::ZERO,
            radius: R::ZERO,
            start: State::at(v::<R>(0.0, 0.0, 0.16))
                .with_rotation_vector(v::<R>(0.02, -0.03, 0.5))
                .with_linear_velocity(v::<R>(0.03, 0.01, 0.001))
                .with_angular_momentum(v::<R>(0.0002, -0.0001, 0.003)),
        }
    }
    /// Parameters of a flight with tumbling, without gravity.
    pub(super) fn flight() -> Self {
        Self {
            gravity: R::ZERO,
            level: R::from_f64(-1e3),
            start: State::at(v::<R>(0.1, -0.2, 0.3))
                .with_linear_velocity(v::<R>(0.03, -0.02, 0.01))
                .with_angular_momentum(v::<R>(0.003, 0.02, -0.004)),
            ..Self::tame()
        }
    }

    /// Parts of the scene for an integrator's step size, s.
    #[allow(clippy::type_complexity, reason = "the four parts of a scene")]
    pub(super) fn parts(
        &self,
        time_step: R,
    ) -> Result<
        (
            BoxBody<R>,
            FlatGround<R>,
            SmoothCoulomb<R>,
            UniformGravity<R>,
        ),
        SceneError,
    > {
        let per_second = R::ONE / time_step;
        let frequency = self.frequency * per_second;
        let quarter = R::from_f64(0.25);
        let ground = FlatGround::level(
            frequency * frequency * quarter,
            self.damping_ratio * frequency * R::HALF,
        );
        let friction = SmoothCoulomb {
            coefficient: self.coefficient,
            slip_speed: self.slip_speed * per_second,
        };
        let gravity = UniformGravity::down(self.gravity * per_second * per_second);
        let plane = Plane::level(self.level);
        let body = lopsided_box(self.radius)?;
        Ok((body, ground.on(plane), friction, gravity))
    }

    /// State at the start for an integrator's step size, s.
    pub(super) fn start_in(&self, time_step: R) -> State<R> {
        let per_second = R::ONE / time_step;
        State {
            linear_velocity: self.start.linear_velocity * per_second,
            angular_momentum: self.start.angular_momentum * per_second,
            ..self.start
        }
    }
}

/// Box with three different moments, none about an axis of the box.
fn lopsided_box<R: Real>(radius: R) -> Result<BoxBody<R>, SceneError> {
    let corner = |x: f64, y: f64, z: f64| ContactPoint {
        position: v::<R>(x, y, z),
        radius,
    };
    let corners = [
        corner(0.5, 0.4, 0.3),
        corner(-0.5, 0.4, 0.3),
        corner(0.5, -0.4, 0.3),
        corner(-0.5, -0.4, 0.3),
        corner(0.5, 0.4, -0.3),
        corner(-0.5, 0.4, -0.3),
        corner(0.5, -0.4, -0.3),
        corner(-0.5, -0.4, -0.3),
    ];
    let masses = [0.12, 0.13, 0.12, 0.125, 0.13, 0.12, 0.13, 0.125].map(R::from_f64);
    PointCloud::with_storage(corners, &masses)
}

pub(super) fn v<R: Real>(x: f64, y: f64, z: f64) -> R::Vec3 {
    R::Vec3::new(R::from_f64(x), R::from_f64(y), R::from_f64(z))
}

#[cfg(test)]
mod tests;
