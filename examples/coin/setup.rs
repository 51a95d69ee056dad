//! Definition of a run: a trial of the coin report, coin and floor, and the method.

use std::fmt;
use std::str::FromStr;

use tumble::{Start, Trial};

/// Mass of the coin, kg.
pub(crate) const MASS: f64 = Trial::<f64>::MASS;
/// Radius of the rim, m.
pub(crate) const RADIUS: f64 = Trial::<f64>::RADIUS;
/// Acceleration of gravity, m/s².
pub(crate) const GRAVITY: f64 = Trial::<f64>::GRAVITY;

/// A complete run.
#[derive(Clone, Debug)]
pub(crate) struct Setup {
    /// Number of the trial in the coin report, 1 to 8.
    pub(crate) number: usize,
    /// The five parameters of the coin report, and the slip speed.
    pub(crate) trial: Trial,
    /// Number of points on the rim.
    pub(crate) points: usize,
    /// Stiffness of the floor for each point, N/m.
    pub(crate) stiffness: f64,
    pub(crate) method: Method,
    /// Step size, s.
    pub(crate) time_step: f64,
    /// Duration, s.
    pub(crate) duration: f64,
    /// True if the energy is audited. This costs several times the run itself.
    pub(crate) audit: bool,
}

/// Method that advances the state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Method {
    EnergyMomentum,
    /// The unchanged loop of the coin report.
    Report,
    ForwardEuler,
    SymplecticEuler,
    Strang,
    Rk4,
    Nystrom,
}

impl Setup {
    /// Returns a trial as in the coin report.
    pub(crate) fn new(number: usize, trial: Trial) -> Self {
        Self {
            number,
            trial,
            points: 120,
            stiffness: Trial::<f64>::STIFFNESS,
            method: Method::EnergyMomentum,
            time_step: Method::EnergyMomentum.usual_step(),
            duration: 160.0,
            audit: true,
        }
    }

    /// Title of the run, such as `Trial 1`.
    pub(crate) fn title(&self) -> String {
        format!("Trial {}", self.number)
    }

    /// The five parameters in one line.
    pub(crate) fn parameters(&self) -> String {
        format!(
            "{}, tilt {}°, friction {}, damping {} N·s/m, |L| {} kg·m²/s",
            name(self.trial.start),
            rounded(self.trial.tilt.to_degrees()),
            self.trial.coefficient,
            self.trial.damping,
            self.trial.angular_momentum
        )
    }

    /// The method in one line.
    pub(crate) fn computation(&self) -> String {
        format!(
            "{}, step {:e} s, {} points",
            self.method, self.time_step, self.points
        )
    }

    /// Energy of the coin at rest on its face, J: `−(M g)²/(2 n S)`.
    ///
    /// The springs support its weight, so it lies slightly below the floor.
    pub(crate) fn energy_at_rest(&self) -> f64 {
        let weight = MASS * GRAVITY;
        -weight * weight / (2.0 * self.points as f64 * self.stiffness)
    }
}

/// Rounds off the last digits that a conversion of units causes.
fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

fn name(start: Start) -> &'static str {
    match start {
        Start::Rolling => "rolling",
        Start::Spinning => "spinning",
    }
}

impl Method {
    /// Default step size, s.
    pub(crate) fn usual_step(self) -> f64 {
        match self {
            // After 1 s of trial 1 the errors are 0.06 mm and 0.1 µm. Symplectic Euler has an error
            // of 0.38 mm with 1e-4 s.
            Self::EnergyMomentum | Self::Nystrom => 1e-3,
            // The step size of the coin report, whose loop is stable below 5e-4 s.
            _ => 1e-4,
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::EnergyMomentum => "energy-momentum",
            Self::Report => "the report's loop",
            Self::ForwardEuler => "forward Euler",
            Self::SymplecticEuler => "symplectic Euler",
            Self::Strang => "Strang splitting",
            Self::Rk4 => "Runge–Kutta 4",
            Self::Nystrom => "Nyström",
        })
    }
}

impl FromStr for Method {
    /// Error with the list of the valid values.
    type Err = &'static str;

    fn from_str(word: &str) -> Result<Self, Self::Err> {
        match word {
            "energy-momentum" => Ok(Self::EnergyMomentum),
            "report" => Ok(Self::Report),
            "forward-euler" => Ok(Self::ForwardEuler),
            "symplectic-euler" => Ok(Self::SymplecticEuler),
            "strang" => Ok(Self::Strang),
            "rk4" => Ok(Self::Rk4),
            "nystrom" => Ok(Self::Nystrom),
            _ => Err(
                "energy-momentum, report, forward-euler, symplectic-euler, strang, rk4 or nystrom",
            ),
        }
    }
}
