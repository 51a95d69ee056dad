//! A friction law that varies over the ground: a carpet with an edge that fades out.

use tumble::real::Vector;
use tumble::{Real, SlidingFriction};

/// Friction in proportion to load and slip, that grows along x from 0 to `drag` over a width.
///
/// `force = -drag(x) · normal_force · slip`, with `drag(x) = drag · clamp(x/width, 0, 1)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carpet<R = f64> {
    /// Drag on the carpet, s/m.
    pub drag: R,
    /// Width of its edge, m.
    pub width: R,
}

impl<R: Real> SlidingFriction<R> for Carpet<R> {
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        self.force_at(R::Vec3::ZERO, normal_force, slip)
    }

    fn force_at(&self, position: R::Vec3, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        let share = (position.x() / self.width)
            .at_least(R::ZERO)
            .at_most(R::ONE);
        slip * -(self.drag * share * normal_force)
    }

    fn depends_on_position(&self) -> bool {
        true
    }
}
