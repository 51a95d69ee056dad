//! A ground: springs that stiffen.

use tumble::real::Vector;
use tumble::{GroundBounds, Plane, Real, SpringDamperGround, Surface};

/// The plane z = 0 on springs that stiffen with depth, with a damper that fades out at the surface
/// (so that the force has no jump there).
///
/// `normal force = max(0, (stiffness + stiffening · depth²) · depth + damping · depth · closing_speed)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turf<R = f64> {
    /// N/m per contact.
    pub stiffness: R,
    /// N/m³ per contact.
    pub stiffening: R,
    /// N s/m² per contact.
    pub damping: R,
}

impl<R: Real> SpringDamperGround<R> for Turf<R> {
    fn surface(&self, point: R::Vec3) -> Surface<R> {
        Surface {
            gap: point.z(),
            normal: Plane::level(R::ZERO).normal,
        }
    }

    fn spring_force(&self, depth: R) -> R {
        (self.stiffness + self.stiffening * depth * depth) * depth
    }

    fn spring_energy(&self, depth: R) -> R {
        let square = depth * depth;
        (self.stiffness + self.stiffening * square * R::HALF) * square * R::HALF
    }

    fn normal_force(&self, depth: R, closing_speed: R) -> R {
        (self.spring_force(depth) + self.damping * depth * closing_speed).at_least(R::ZERO)
    }

    fn bounds(&self) -> GroundBounds<R> {
        GroundBounds::Plane(Plane::level(R::ZERO))
    }
}
