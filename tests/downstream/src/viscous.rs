//! A friction law: the oil film.

use tumble::{Real, SlidingFriction};

/// Friction of an oily surface: force in proportion to load and slip,
/// `force = -drag · normal_force · slip`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viscous<R = f64> {
    /// s/m.
    pub drag: R,
}

impl<R: Real> SlidingFriction<R> for Viscous<R> {
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        slip * -(self.drag * normal_force)
    }
}
