//! The eight trials of the coin report: a coin set down on its rim, rolling or spinning.

use crate::body::Coin;
use crate::error::{self, SceneError};
use crate::friction::Coulomb;
use crate::gravity::UniformGravity;
use crate::ground::FlatGround;
use crate::integrator::Integrator;
use crate::real::{Real, Vector};
use crate::rotation::Rotation;
use crate::state::State;
use crate::stepper::Stepper;

/// Direction of the initial angular momentum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Start {
    /// Along the coin's normal: the coin rolls like a wheel.
    Rolling,
    /// Along the coin's upright diameter: the coin spins on the spot.
    Spinning,
}

/// Start of a trial of the coin report, with its parameters: direction and size of the angular
/// momentum, tilt, friction (coefficient and slip speed), damping.
///
/// The coin is a ring of 120 points with 1 kg and a radius of 0.5 m. Its lowest point is on the
/// plane z = 0, under gravity of 9.8 m/s², on springs of 1000 N/m a point.
///
/// `Trial::report(1)` does not determine the precision. Write `tumble::f64::Trial` if the compiler
/// requires a type annotation.
///
/// ```
/// use tumble::f64::{SymplecticEuler, Trial};
///
/// let trial = Trial { coefficient: 0.5, ..Trial::report(1).ok_or("no such trial")? };
/// let stepper = trial.stepper(SymplecticEuler { time_step: 1e-3 })?;
/// let mut state = trial.state();
/// stepper.advance(&mut state, 1.0)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Trial<R = f64> {
    /// Direction of the initial angular momentum: the coin rolls or spins.
    pub start: Start,
    /// Tilt of the coin from upright about the world's y axis, rad.
    pub tilt: R,
    /// Size of the angular momentum, kg m²/s.
    pub angular_momentum: R,
    /// Coefficient of friction, dimensionless.
    pub coefficient: R,
    /// Slip speed of the friction, m/s.
    pub slip_speed: R,
    /// Damping of the ground, N s/m for each point.
    pub damping: R,
}

/// Stepper of the scene of a trial.
pub type TrialStepper<I, R = f64> =
    Stepper<Coin<R>, FlatGround<R>, Coulomb<R>, UniformGravity<R>, I, R>;

impl<R: Real> Trial<R> {
    /// Mass of the coin, kg.
    pub const MASS: f64 = 1.0;
    /// Radius of the coin, m.
    pub const RADIUS: f64 = 0.5;
    /// Gravity, m/s².
    pub const GRAVITY: f64 = 9.8;
    /// Stiffness of the ground, N/m for each point.
    pub const STIFFNESS: f64 = 1000.0;
    /// Damping of the ground, N s/m for each point.
    pub const DAMPING: f64 = 0.5;

    /// Returns trial 1 to 8 of the coin report, and `None` for other numbers.
    #[must_use]
    pub fn report(number: usize) -> Option<Self> {
        use Start::{Rolling, Spinning};
        const LEAN: f64 = core::f64::consts::PI / 12.0;
        let (start, tilt, coefficient, angular_momentum) = match number {
            1 => (Rolling, LEAN, 0.3, 1.0),
            2 => (Rolling, LEAN, 0.3, 1.5),
            3 => (Rolling, LEAN, 0.8, 1.0),
            4 => (Spinning, 0.0, 0.3, 1.0),
            5 => (Spinning, LEAN, 0.1, 1.5),
            6 => (Spinning, 0.0, 0.3, 5.0),
            7 => (Spinning, LEAN, 0.3, 5.0),
            8 => (Spinning, LEAN, 0.3, 1.0),
            _ => return None,
        };
        Some(Self {
            start,
            tilt: R::from_f64(tilt),
            angular_momentum: R::from_f64(angular_momentum),
            coefficient: R::from_f64(coefficient),
            slip_speed: R::from_f64(Coulomb::<f64>::REPORT_SLIP_SPEED),
            damping: R::from_f64(Self::DAMPING),
        })
    }

    /// Returns the coin of the coin report, with 120 points.
    #[must_use]
    pub fn coin(&self) -> Coin<R> {
        Coin::ring(R::from_f64(Self::MASS), R::from_f64(Self::RADIUS))
    }

    /// Returns the ground of the coin report with this trial's damping.
    #[must_use]
    pub fn ground(&self) -> FlatGround<R> {
        FlatGround::level(R::from_f64(Self::STIFFNESS), self.damping)
    }

    /// Returns the friction law of the coin report with this trial's coefficient and slip speed.
    #[must_use]
    pub fn friction(&self) -> Coulomb<R> {
        Coulomb {
            coefficient: self.coefficient,
            slip_speed: self.slip_speed,
        }
    }

    /// Returns the gravity of the coin report.
    #[must_use]
    pub fn gravity(&self) -> UniformGravity<R> {
        UniformGravity::down(R::from_f64(Self::GRAVITY))
    }

    /// Returns the initial state: the coin is tilted, its centre of mass is at rest, and the lowest
    /// point of its rim is on z = 0.
    #[must_use]
    pub fn state(&self) -> State<R> {
        let (o, one) = (R::ZERO, R::ONE);
        let turn = Rotation::<R>::from_rotation_vector(R::Vec3::new(o, self.tilt, o));
        let direction = match self.start {
            Start::Rolling => turn.apply(R::Vec3::new(one, o, o)),
            Start::Spinning => turn.apply(R::Vec3::new(o, o, one)),
        };
        let height = R::from_f64(Self::RADIUS) * self.tilt.sin_cos().1.abs();
        State::at(R::Vec3::new(o, o, height))
            .with_orientation(turn.to_quat())
            .with_angular_momentum(direction * self.angular_momentum)
    }

    /// Returns a stepper with the coin, ground, friction and gravity of this trial and an
    /// integrator.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a parameter of the trial or of the integrator is invalid. The
    /// error names the quantity, the rule and the value.
    pub fn stepper<I: Integrator<R>>(
        &self,
        integrator: I,
    ) -> Result<TrialStepper<I, R>, SceneError> {
        // They are of the initial state, which the builder does not know.
        error::finite("tilt of the coin", self.tilt, " rad")?;
        let quantity = "angular momentum of the coin";
        error::finite(quantity, self.angular_momentum, " kg m²/s")?;
        Stepper::builder(self.coin())
            .ground(self.ground())
            .friction(self.friction())
            .gravity(self.gravity())
            .integrator(integrator)
            .build()
    }
}
