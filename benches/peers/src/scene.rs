//! Definition of a scene: a law, a start, a duration, and the known result.

use tumble::State;
use tumble::glam::{DMat3, DVec3};

use crate::law::Law;

/// Shape of the body, for a program that needs one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shape {
    /// Body in free flight, which cannot touch.
    Free,
    /// Body with one contact, at the centre, with this radius (m).
    Ball(f64),
    /// Body with a rim of this radius (m) about the body's x axis.
    Coin(f64),
    /// Body with a round rim of this radius (m) about the body's x axis, which touches at its
    /// lowest point alone.
    Hoop(f64),
}

/// Quantity that is compared with the known result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Measure {
    /// Distance of the centres.
    Centre,
    /// Distance of the centres, and the displacement of a rim of this radius (m) by the rotation
    /// between the two states.
    Rim(f64),
    /// Angular velocity in body axes.
    BodySpin,
}

/// A scene with a known result.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    /// Description of the motion, and the source of the known result.
    pub(crate) about: String,
    pub(crate) law: Law,
    pub(crate) shape: Shape,
    /// Coefficient of restitution, for a program that needs one.
    pub(crate) restitution: f64,
    /// Duration, s.
    pub(crate) seconds: f64,
    /// Start and result of the point law, at its own height at rest if the scene starts in contact.
    pub(crate) soft: Case,
    /// Start and result of rigid bodies, for rapier, which has no stiffness.
    pub(crate) rigid: Case,
    pub(crate) measure: Measure,
    /// Divisor of the error, and the unit of the quotient.
    pub(crate) unit: (f64, &'static str),
    /// Error above which a result is not usable, in the same unit.
    pub(crate) useful: f64,
    /// Step sizes (s) of tumble's integrators.
    pub(crate) steps: Vec<f64>,
    /// Step sizes (s) of the plain Rk4.
    pub(crate) plain_steps: Vec<f64>,
    /// Step sizes (s) of a tuned rapier.
    pub(crate) rapier_steps: Vec<f64>,
    /// A length (m) and a time (s) that make the numbers of the scene about 1.
    pub(crate) scale: (f64, f64),
}

/// A start and the known result at the end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    pub(crate) start: State,
    pub(crate) answer: State,
}

impl Scene {
    /// Error of an end state against the known result, in the unit of the scene.
    pub(crate) fn error(&self, end: &State, answer: &State) -> f64 {
        let centre = (end.position - answer.position).length();
        let error = match self.measure {
            Measure::Centre => centre,
            Measure::Rim(radius) => centre.hypot(radius * angle_between(end, answer)),
            Measure::BodySpin => (self.body_spin(end) - self.body_spin(answer)).length(),
        };
        error / self.unit.0
    }

    fn body_spin(&self, state: &State) -> DVec3 {
        let axes = DMat3::from_quat(state.orientation.normalize());
        (axes.transpose() * state.angular_momentum) / self.law.inertia
    }
}

/// Angle of the rotation between two states, rad. It is computed from the sine, so small angles are
/// accurate to rounding.
fn angle_between(a: &State, b: &State) -> f64 {
    let turn = a.orientation.normalize().inverse() * b.orientation.normalize();
    2.0 * turn.xyz().length().atan2(turn.w.abs())
}
