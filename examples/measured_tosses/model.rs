//! The cube on its table: eight corners on springs and dampers, with sliding friction.

use std::error::Error;

use tumble::glam::{DMat3, DQuat, DVec3};
use tumble::{
    ContactPoint, Coulomb, EnergyMomentum, FlatGround, LoadDependentCoulomb, RigidPointBody,
    SlidingFriction, State, Stepper, UniformGravity,
};

use crate::flights;
use crate::tosses::{RATE, Sample, Toss};

/// Edge of the cube, m (Pfrommer, Halm & Posa).
pub(crate) const WIDTH: f64 = 0.1048;
/// Mass, kg.
const MASS: f64 = 0.37;
/// Moment of inertia about every axis, kg m².
const INERTIA: f64 = 8.1e-4;
/// Acceleration of gravity, m/s².
pub(crate) const GRAVITY: f64 = 9.81;

/// Fitted parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parameters {
    /// Stiffness of a corner, N/m.
    pub(crate) stiffness: f64,
    /// Damping of a corner, N s/m.
    pub(crate) damping: f64,
    pub(crate) coefficient: f64,
    /// Slip speed, m/s.
    pub(crate) slip_speed: f64,
    /// Load at which the coefficient has begun to decrease, N. `None` for a constant coefficient.
    pub(crate) transition_load: Option<f64>,
    /// Differences between the measured cube and the printed one.
    pub(crate) body: Corrections,
}

impl Parameters {
    fn friction(&self) -> Box<dyn SlidingFriction + Send + Sync> {
        match self.transition_load {
            None => Box::new(Coulomb {
                coefficient: self.coefficient,
                slip_speed: self.slip_speed,
            }),
            Some(transition_load) => Box::new(LoadDependentCoulomb {
                coefficient: self.coefficient,
                transition_load,
                slip_speed: self.slip_speed,
            }),
        }
    }

    /// Coefficient of friction of the cube that slides on a face, with a quarter of the weight on
    /// each corner.
    pub(crate) fn coefficient_on_a_face(&self) -> f64 {
        let load = 0.25 * MASS * GRAVITY;
        let fast = DVec3::X * (1e9 * self.slip_speed);
        self.friction().force(load, fast).length() / load
    }
}

/// Data of the measured toss that a prediction uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Start {
    /// The first sample alone.
    FirstSample,
    /// All samples before the first touch-down, at most 15.
    Flight,
}

/// Corrections of the printed values of body and tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corrections {
    /// Moment of inertia over the printed one.
    pub(crate) inertia: f64,
    /// Radius of the corners, m.
    pub(crate) corner_radius: f64,
    /// Centre of mass from the cube's middle, which the tracker follows, m, body axes.
    pub(crate) centre_of_mass: DVec3,
    /// True lengths over measured lengths.
    pub(crate) scale: f64,
}

impl Corrections {
    pub(crate) const NONE: Self = Self {
        inertia: 1.0,
        corner_radius: 0.0,
        centre_of_mass: DVec3::ZERO,
        scale: 1.0,
    };
}

/// A cube of corners with a radius.
pub(crate) struct Cube {
    inertia: f64,
    corners: [ContactPoint; 8],
}

impl Cube {
    fn new(corrections: &Corrections) -> Self {
        let radius = corrections.corner_radius;
        let corners = core::array::from_fn(|k| {
            let sign = |bit: usize| if k >> bit & 1 == 0 { -1.0 } else { 1.0 };
            let position = DVec3::new(sign(0), sign(1), sign(2)) * (0.5 * WIDTH - radius);
            ContactPoint {
                position: position - corrections.centre_of_mass,
                radius,
            }
        });
        Self {
            inertia: INERTIA * corrections.inertia,
            corners,
        }
    }
}

impl RigidPointBody for Cube {
    fn mass(&self) -> f64 {
        MASS
    }
    fn inertia(&self) -> DMat3 {
        DMat3::from_diagonal(DVec3::splat(self.inertia))
    }
    fn contacts(&self) -> &[ContactPoint] {
        &self.corners
    }
}

/// Number of steps between two samples, for the figures. The run prints the change of the results
/// with twice as many.
pub(crate) const STEPS: u32 = 32;
pub(crate) const STEPS_OF_FIT: u32 = 8;
/// Number of steps between two samples of synthetic tosses, which are made and fitted with one step
/// size.
pub(crate) const STEPS_OF_SYNTHETIC: u32 = 16;

/// The cube with its table, ready to predict.
pub(crate) struct Model {
    stepper: Stepper<
        Cube,
        FlatGround,
        Box<dyn SlidingFriction + Send + Sync>,
        UniformGravity,
        EnergyMomentum,
    >,
    corrections: Corrections,
}

impl Model {
    pub(crate) fn new(parameters: &Parameters, steps: u32) -> Result<Self, Box<dyn Error>> {
        let time_step = 1.0 / (RATE * f64::from(steps));
        let stepper = Stepper::builder(Cube::new(&parameters.body))
            .gravity(UniformGravity::down(GRAVITY))
            .ground(FlatGround::level(parameters.stiffness, parameters.damping))
            .friction(parameters.friction())
            .integrator(EnergyMomentum { time_step })
            .build()?;
        Ok(Self {
            stepper,
            corrections: parameters.body,
        })
    }

    /// True lengths over measured ones.
    pub(crate) fn scale(&self) -> f64 {
        self.corrections.scale
    }

    /// The first state of a toss, in true lengths.
    fn start(&self, toss: &Toss, start: Start) -> State {
        let start = flights::start(toss, &self.corrections, start);
        let momentum = start.orientation * (start.spin * self.stepper.body().inertia);
        State::at(start.position)
            .with_linear_velocity(start.velocity)
            .with_orientation(start.orientation)
            .with_angular_momentum(momentum)
    }

    /// Returns the states at the times of a toss's samples, with the cube's middle as their
    /// position, or `None` if a step fails.
    pub(crate) fn predict(&self, toss: &Toss, start: Start) -> Option<Vec<State>> {
        let mut state = self.start(toss, start);
        let mut states = vec![state];
        for _ in 1..toss.samples.len() {
            self.stepper.advance(&mut state, 1.0 / RATE).ok()?;
            states.push(state);
        }
        for state in &mut states {
            state.position -= state.orientation * self.corrections.centre_of_mass;
        }
        Some(states)
    }

    /// Errors of a prediction.
    pub(crate) fn score(&self, toss: &Toss, start: Start) -> Score {
        let Some(states) = self.predict(toss, start) else {
            return Score::LOST;
        };
        let pairs = || states.iter().zip(&toss.samples);
        let mean = |of: &dyn Fn(&State, &Sample) -> f64| {
            pairs()
                .map(|(state, sample)| of(state, sample))
                .sum::<f64>()
                / states.len() as f64
        };
        let scale = self.corrections.scale;
        let (last_state, last_sample) = (
            states[states.len() - 1],
            toss.samples[toss.samples.len() - 1],
        );
        Score {
            position: mean(&|state, sample| (state.position - sample.position * scale).length())
                / WIDTH
                * 100.0,
            rotation: mean(&|state, sample| state.orientation.angle_between(sample.orientation))
                .to_degrees(),
            right_face: f64::from(
                face_down(last_state.orientation) == face_down(last_sample.orientation),
            ),
        }
    }
}

/// The face that points down: an axis and its sign.
fn face_down(orientation: DQuat) -> (usize, bool) {
    let down = (orientation.inverse() * DVec3::NEG_Z).to_array();
    let axis = (0..3)
        .max_by(|&a, &b| down[a].abs().total_cmp(&down[b].abs()))
        .unwrap_or(0);
    (axis, down[axis] > 0.0)
}

/// Errors of the prediction of a toss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Score {
    /// Mean distance of the centres over the samples, % of the width.
    pub(crate) position: f64,
    /// Mean angle between the orientations, degrees.
    pub(crate) rotation: f64,
    /// 1 if the predicted face is down at the end, else 0.
    pub(crate) right_face: f64,
}

impl Score {
    /// Errors of a failed prediction.
    const LOST: Self = Self {
        position: 1000.0,
        rotation: 180.0,
        right_face: 0.0,
    };

    /// Mean errors over tosses.
    pub(crate) fn mean<'a>(scores: impl Iterator<Item = &'a Score>) -> Self {
        let mut sum = Self {
            position: 0.0,
            rotation: 0.0,
            right_face: 0.0,
        };
        let mut count = 0.0;
        for score in scores {
            sum.position += score.position;
            sum.rotation += score.rotation;
            sum.right_face += score.right_face;
            count += 1.0;
        }
        Self {
            position: sum.position / count,
            rotation: sum.rotation / count,
            right_face: sum.right_face / count,
        }
    }
}

/// Errors of many tosses, computed by as many threads as the machine has.
pub(crate) fn scores(model: &Model, tosses: &[Toss], start: Start) -> Vec<Score> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let chunk = tosses.len().div_ceil(threads).max(1);
    std::thread::scope(|scope| {
        let workers: Vec<_> = (tosses.chunks(chunk))
            .map(|part| {
                scope.spawn(move || {
                    part.iter()
                        .map(|toss| model.score(toss, start))
                        .collect::<Vec<_>>()
                })
            })
            .collect();
        (workers.into_iter())
            .flat_map(|worker| worker.join().unwrap_or_default())
            .collect()
    })
}
