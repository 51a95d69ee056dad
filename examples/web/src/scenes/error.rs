//! Errors of the page, as a text that the page shows.

use core::fmt;

use tumble::{SceneError, StepError};

/// Reason why a call of the page has no result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PageError {
    /// A parameter of the scene is invalid.
    Scene(SceneError),
    /// A step failed. The state is the last valid one.
    Step(StepError),
    /// A number of the page names no body, method or start.
    Unknown {
        /// What the number should name.
        kind: &'static str,
        /// The number.
        value: f64,
    },
    /// The scene has no energy barriers: no gravity, or ground too soft for the body.
    NoBarriers,
    /// The body has no faces to count.
    NoFaces,
}

impl From<SceneError> for PageError {
    fn from(error: SceneError) -> Self {
        Self::Scene(error)
    }
}

impl From<StepError> for PageError {
    fn from(error: StepError) -> Self {
        Self::Step(error)
    }
}

impl fmt::Display for PageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(error) => error.fmt(f),
            Self::Step(error) => error.fmt(f),
            Self::Unknown { kind, value } => {
                write!(f, "there is no {kind} with the number {value}")
            }
            Self::NoBarriers => f.write_str(
                "no outcome can be proven: the body needs gravity, and ground that carries it",
            ),
            Self::NoFaces => f.write_str("this body has no faces to count"),
        }
    }
}
