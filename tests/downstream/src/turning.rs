//! A ground that moves: its material rotates about a vertical axis.

use tumble::{
    GroundBounds, GroundMotion, MeanForce, Real, SceneError, SpringDamperGround, Surface, error,
};

/// A user's surface whose material rotates about a vertical axis, on any level ground.
///
/// It is written without [`MovingGround`](tumble::MovingGround), which does the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turning<G, R = f64> {
    /// Ground at rest.
    pub ground: G,
    /// Angular velocity about the vertical axis through the origin, rad/s.
    pub rate: R,
}

impl<R: Real, G: SpringDamperGround<R>> SpringDamperGround<R> for Turning<G, R> {
    fn surface(&self, point: R::Vec3) -> Surface<R> {
        self.ground.surface(point)
    }
    fn spring_force(&self, depth: R) -> R {
        self.ground.spring_force(depth)
    }
    fn spring_energy(&self, depth: R) -> R {
        self.ground.spring_energy(depth)
    }
    fn normal_force(&self, depth: R, closing_speed: R) -> R {
        self.ground.normal_force(depth, closing_speed)
    }
    fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        self.ground.mean_force(start, end, seconds)
    }
    fn bounds(&self) -> GroundBounds<R> {
        self.ground.bounds()
    }
    fn motion(&self) -> Option<GroundMotion<R>> {
        use tumble::real::Vector;
        let axis = R::Vec3::new(R::ZERO, R::ZERO, self.rate);
        Some(GroundMotion::rotation(R::Vec3::ZERO, axis))
    }
    fn check(&self) -> Result<(), SceneError> {
        self.ground.check()?;
        error::finite("rate of the ground", self.rate, " rad/s")
    }
}
