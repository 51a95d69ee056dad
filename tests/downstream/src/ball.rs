//! A body: the solid ball.

use tumble::real::{Matrix, Vector};
use tumble::{ContactPoint, Real, RigidPointBody};

/// A solid ball of even density: one contact, at the centre, with the ball's radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball<R: Real = f64> {
    mass: R,
    contact: [ContactPoint<R>; 1],
}

impl<R: Real> Ball<R> {
    /// Mass in kg, radius in m.
    #[must_use]
    pub fn new(mass: R, radius: R) -> Self {
        let centre = R::Vec3::ZERO;
        Self {
            mass,
            contact: [ContactPoint {
                position: centre,
                radius,
            }],
        }
    }

    /// m.
    #[must_use]
    pub fn radius(&self) -> R {
        self.contact[0].radius
    }
}

impl<R: Real> RigidPointBody<R> for Ball<R> {
    fn mass(&self) -> R {
        self.mass
    }

    /// `2/5 m r²` about every axis.
    fn inertia(&self) -> R::Mat3 {
        let moment = R::from_f64(0.4) * self.mass * self.radius() * self.radius();
        R::Mat3::from_diagonal(R::Vec3::new(moment, moment, moment))
    }

    fn contacts(&self) -> &[ContactPoint<R>] {
        &self.contact
    }
}
