//! What a scene is: a law, a start, a time, and the known answer.

use tumble::State;
use tumble::glam::{DMat3, DVec3};

use crate::law::Law;

/// What the body is to a program that wants a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shape {
    /// In free flight: nothing can touch.
    Free,
    /// One contact, at the centre, with this radius (m).
    Ball(f64),
    /// A rim of this radius (m) about the body's x axis.
    Coin(f64),
}

/// What is compared with the answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Measure {
    /// Distance of the centres.
    Centre,
    /// Distance of the centres, and how far the turn between the two moves a rim of this radius
    /// (m).
    Rim(f64),
    /// Angular velocity in body axes.
    BodySpin,
}

/// A scene with a known answer.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    /// What happens, and where the answer comes from.
    pub(crate) about: String,
    pub(crate) law: Law,
    pub(crate) shape: Shape,
    /// Coefficient of restitution, for a program that wants one.
    pub(crate) restitution: f64,
    /// s
    pub(crate) seconds: f64,
    /// Of the point law, at its own height of rest where the scene starts in contact.
    pub(crate) soft: Case,
    /// Of rigid bodies, for rapier, which knows no stiffness.
    pub(crate) rigid: Case,
    pub(crate) measure: Measure,
    /// The error is divided by this, and has the unit that stands beside it.
    pub(crate) unit: (f64, &'static str),
    /// An error above this is no answer, in the same unit.
    pub(crate) useful: f64,
    /// Steps (s) of tumble's integrators.
    pub(crate) steps: Vec<f64>,
    /// Steps (s) of the plain Rk4.
    pub(crate) plain_steps: Vec<f64>,
    /// Steps (s) of a tuned rapier.
    pub(crate) rapier_steps: Vec<f64>,
    /// A length (m) and a time (s) that make the numbers of the scene about 1.
    pub(crate) scale: (f64, f64),
}

/// A start and the answer at the end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    pub(crate) start: State,
    pub(crate) answer: State,
}

impl Scene {
    /// Error of an end against an answer, in the scene's unit.
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

/// The angle of the turn between two states, rad; small ones to rounding, for it is taken from the
/// sine.
fn angle_between(a: &State, b: &State) -> f64 {
    let turn = a.orientation.normalize().inverse() * b.orientation.normalize();
    2.0 * turn.xyz().length().atan2(turn.w.abs())
}
