//! A battery of the page: each body with each integrator, thrown and set down.
//!
//! *Thrown:* from a third of its bounding radius `R` above the floor, upwards and sideways, with the
//! spin of its first scene. It flies, hits the floor and slides. *Set down:* almost in a pose of
//! stable equilibrium, a fiftieth of `R` above it, so that it comes to rest.
//!
//! Lengths are measured in `R` and times in `√(R/g)`, so that bodies of all sizes go through the
//! same phases. The damping is half of the critical one for the contacts of the equilibrium.

use tumble::glam::DVec3;
use tumble::{Real, RigidPointBody, State};

use super::bodies::Exhibit;
use super::error::PageError;
use super::hash::Hash;
use super::method::Method;
use super::parameters::{PageStepper, Parameters, height_on_the_ground, take_step};

/// Name of the row in `tests/bits/hashes.txt`.
pub const ROW: &str = "f64 live page";
/// Steps of each run.
pub const STEPS: u32 = 192;
/// Steps in a time of `√(R/g)`.
const STEPS_PER_TIME: f64 = 96.0;

/// How a body of the battery starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Flies, hits the floor and slides.
    Thrown,
    /// Comes to rest.
    SetDown,
}

/// A run of the battery.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Body, thrown or set down.
    pub name: &'static str,
    /// Number of the body.
    pub body: u32,
    /// Number of the integrator.
    pub method: u32,
    /// How the body starts.
    pub start: Start,
}

/// Names of the bodies, thrown and set down.
const NAMES: [[&str; 2]; 7] = [
    ["coin thrown", "coin set down"],
    ["thick coin thrown", "thick coin set down"],
    ["ball thrown", "ball set down"],
    ["die thrown", "die set down"],
    ["tippe top thrown", "tippe top set down"],
    ["egg thrown", "egg set down"],
    ["rattleback thrown", "rattleback set down"],
];

/// All runs, in one order: for each integrator each body.
pub fn runs() -> impl Iterator<Item = Run> {
    (0..Method::COUNT).flat_map(|method| {
        (0_u32..).zip(NAMES).flat_map(move |(body, names)| {
            let starts = [Start::Thrown, Start::SetDown];
            names.into_iter().zip(starts).map(move |(name, start)| Run {
                name,
                body,
                method,
                start,
            })
        })
    })
}

/// Hash of the row: of all runs.
///
/// # Errors
/// Returns [`PageError`] if a run fails, which is a fault of the battery.
pub fn row() -> Result<u64, PageError> {
    let mut row = Hash::new();
    for run in runs() {
        row.word(run.hash()?);
    }
    Ok(row.0)
}

impl Run {
    /// Hash of the state and of the energy after each step.
    ///
    /// # Errors
    /// Returns [`PageError`] if a step fails.
    pub fn hash(&self) -> Result<u64, PageError> {
        let mut hash = Hash::new();
        self.follow(&mut |stepper, state| {
            hash.state(state);
            hash.number(stepper.energy(state).total());
        })?;
        Ok(hash.0)
    }

    /// Takes the steps, and shows the state after each.
    ///
    /// # Errors
    /// Returns [`PageError`] if a step fails.
    pub fn follow(&self, see: &mut dyn FnMut(&PageStepper, &State)) -> Result<(), PageError> {
        let parameters = self.parameters()?;
        let stepper = parameters.stepper()?;
        let mut session = stepper.session(self.first_state(&parameters)?);
        for _ in 0..STEPS {
            take_step(&mut session)?;
            see(&stepper, session.state());
        }
        Ok(())
    }

    /// Scene of the run.
    fn parameters(&self) -> Result<Parameters, PageError> {
        let Exhibit {
            body, parameters, ..
        } = Exhibit::from_number(self.body.into())?;
        let time = Real::sqrt(body.bounding_radius() / parameters.gravity);
        let mut sunk = self.equilibrium()?;
        sunk.position.z -= body.bounding_radius() / 1000.0;
        let contacts = parameters.default_stepper()?.touching(&sunk);
        let contacts = f64::from(u16::try_from(contacts).unwrap_or(u16::MAX));
        Ok(Parameters {
            method: self.method.into(),
            step: time / STEPS_PER_TIME,
            damping: Real::sqrt(parameters.stiffness * body.mass() / contacts),
            slip_speed: 1e-2,
            start: 0.0,
            ..parameters
        })
    }

    /// Pose of stable equilibrium, on the floor.
    fn equilibrium(&self) -> Result<State, PageError> {
        let exhibit = Exhibit::from_number(self.body.into())?;
        let state = State::default().with_rotation_vector(exhibit.equilibrium);
        let height = height_on_the_ground(&exhibit.body, &state);
        Ok(State {
            position: DVec3::Z * height,
            ..state
        })
    }

    fn first_state(&self, parameters: &Parameters) -> Result<State, PageError> {
        let radius = Exhibit::from_number(self.body.into())?
            .body
            .bounding_radius();
        let speed = Real::sqrt(radius * parameters.gravity);
        let (mut state, height) = match self.start {
            Start::Thrown => (parameters.start()?, radius / 3.0),
            Start::SetDown => (self.equilibrium()?, radius / 50.0),
        };
        state.position.z += height;
        if self.start == Start::Thrown {
            state.linear_velocity = DVec3::new(0.4, -0.3, 0.1) * speed;
        }
        Ok(state)
    }
}
