//! Every integrator of the library on the report's coin: one list, from which the tests of accuracy
//! and of physics take them.

use core::ops::ControlFlow;
use tumble::glam::{DQuat, DVec3};
use tumble::{
    Coin, Coulomb, Dissipation, Energy, EnergyMomentum, FlatGround, ForwardEuler, Integrator,
    Ledger, Nystrom, Observer, RigidPointBody, Rk4, Sample, SlidingFriction, SpringDamperGround,
    State, StepError, Stepper, StrangSplitting, SymplecticEuler, Trial, UniformGravity,
};

/// The report's coin (1 kg, 0.5 m, 120 points, 9.8 m/s^2) on a flat ground, and how it starts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setup {
    pub(crate) ground: FlatGround,
    pub(crate) friction: Coulomb,
    pub(crate) state: State,
}

impl Setup {
    /// A trial of the report, with its parameters as they are given.
    pub(crate) fn of(trial: &Trial) -> Self {
        Self {
            ground: trial.ground(),
            friction: trial.friction(),
            state: trial.state(),
        }
    }

    /// A trial of the report by its number, with another slip speed (m/s).
    pub(crate) fn trial(number: usize, slip_speed: f64) -> Self {
        Self::of(&Trial {
            slip_speed,
            ..Trial::report(number).unwrap()
        })
    }

    fn composed<I: Integrator>(&self, integrator: I) -> impl Run + use<I> {
        Stepper::new(Coin::ring(1.0, 0.5))
            .and_then(|stepper| stepper.with_ground(self.ground))
            .and_then(|stepper| stepper.with_friction(self.friction))
            .and_then(|stepper| stepper.with_gravity(UniformGravity::down(9.8)))
            .and_then(|stepper| stepper.with_integrator(integrator))
            .unwrap()
    }
}

/// An integrator, as the tests see it.
#[derive(Clone, Copy)]
pub(crate) struct Method {
    pub(crate) name: &'static str,
    /// Order in smooth motion.
    pub(crate) order: i32,
    /// A step (s) that is short enough for whole trials.
    pub(crate) time_step: f64,
    compose: fn(&Setup, f64) -> Box<dyn Run>,
}

/// Every integrator with a fixed step. A new one is tested as soon as it stands here.
pub(crate) const METHODS: [Method; 6] = [
    Method {
        name: "ForwardEuler",
        order: 1,
        // Stable below damping/stiffness = 5e-4 s.
        time_step: 2e-4,
        compose: |setup, time_step| Box::new(setup.composed(ForwardEuler { time_step })),
    },
    Method {
        name: "SymplecticEuler",
        order: 1,
        time_step: 1e-3,
        compose: |setup, time_step| Box::new(setup.composed(SymplecticEuler { time_step })),
    },
    Method {
        name: "StrangSplitting",
        order: 2,
        time_step: 1e-3,
        compose: |setup, time_step| Box::new(setup.composed(StrangSplitting { time_step })),
    },
    Method {
        name: "Rk4",
        order: 4,
        time_step: 1e-3,
        compose: |setup, time_step| Box::new(setup.composed(Rk4 { time_step })),
    },
    Method {
        name: "Nystrom",
        order: 4,
        time_step: 1e-3,
        compose: |setup, time_step| Box::new(setup.composed(Nystrom { time_step })),
    },
    Method {
        name: "EnergyMomentum",
        order: 2,
        time_step: 1e-3,
        compose: |setup, time_step| Box::new(setup.composed(EnergyMomentum { time_step })),
    },
];

/// The method called `name`.
pub(crate) fn method(name: &str) -> Method {
    *(METHODS.iter().find(|method| method.name == name)).unwrap()
}

impl Method {
    /// The scene of `setup`, moved on by this method in steps of `time_step` (s).
    pub(crate) fn stepper(&self, setup: &Setup, time_step: f64) -> Box<dyn Run> {
        (self.compose)(setup, time_step)
    }

    /// The records of a run in steps of `time_step` (s) at `times` (s, multiples of the step,
    /// rising).
    pub(crate) fn records(&self, setup: &Setup, time_step: f64, times: &[f64]) -> Vec<Record> {
        let mut recorder = Recorder {
            ledger: Ledger::new(),
            times,
            records: Vec::new(),
        };
        let mut state = setup.state;
        self.stepper(setup, time_step)
            .run(&mut state, *times.last().unwrap(), &mut recorder);
        assert_eq!(recorder.records.len(), times.len(), "a time was missed");
        recorder.records
    }
}

/// A stepper whose integrator is forgotten.
pub(crate) trait Run {
    /// [`Stepper::run`], which must not fail.
    fn run(&self, state: &mut State, seconds: f64, observer: &mut dyn Observer);
    /// [`Stepper::energy`].
    fn energy(&self, state: &State) -> Energy;
}

impl<B, G, F, I> Run for Stepper<B, G, F, UniformGravity, I>
where
    B: RigidPointBody,
    G: SpringDamperGround,
    F: SlidingFriction,
    I: Integrator,
{
    fn run(&self, state: &mut State, seconds: f64, observer: &mut dyn Observer) {
        let mut watch = |sample: &Sample<'_>| observer.observe(sample);
        let result: Result<f64, StepError> = Stepper::run(self, state, seconds, &mut watch);
        result.unwrap();
    }

    fn energy(&self, state: &State) -> Energy {
        Stepper::energy(self, state)
    }
}

/// A state of a run, and the energy audit up to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Record {
    pub(crate) time: f64,
    pub(crate) state: State,
    pub(crate) energy: Energy,
    pub(crate) work: Dissipation,
    pub(crate) residue: f64,
}

struct Recorder<'a> {
    ledger: Ledger,
    times: &'a [f64],
    records: Vec<Record>,
}

impl Observer for Recorder<'_> {
    fn observe(&mut self, sample: &Sample<'_>) -> ControlFlow<()> {
        let flow = self.ledger.observe(sample);
        let next = self.times.get(self.records.len());
        // The times are multiples of the step; the clock's rounding is far below a nanosecond.
        if next.is_some_and(|next| (sample.time - next).abs() < 1e-9) {
            self.records.push(Record {
                time: sample.time,
                state: *sample.state,
                energy: sample.energy(),
                work: self.ledger.work(),
                residue: self.ledger.energy_error(),
            });
        }
        flow
    }
}

/// Distance of two states of the report's coin (1 kg, 0.5 m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Distance {
    /// Distance of the centres, and of the rim by the angle between the orientations:
    /// `sqrt(|dx|^2 + (r angle)^2)`, m.
    pub(crate) place: f64,
    /// Distance of the velocities, and of the rim by the angular momenta: `|dv| + |dL|/(m r)`, m/s.
    pub(crate) motion: f64,
}

/// The distance of two states of the report's coin.
pub(crate) fn apart(a: &State, b: &State) -> Distance {
    let between = a.orientation * b.orientation.conjugate();
    let angle = 2.0 * between.xyz().length().atan2(between.w.abs());
    Distance {
        place: (a.position - b.position).length().hypot(0.5 * angle),
        motion: (a.linear_velocity - b.linear_velocity).length()
            + (a.angular_momentum - b.angular_momentum).length() / 0.5,
    }
}

/// The order of convergence: the slope of log(error) over log(time step), by least squares.
pub(crate) fn convergence(errors: &[(f64, f64)]) -> f64 {
    let logs = || (errors.iter()).map(|(step, error)| (step.ln(), error.ln()));
    let count = errors.len() as f64;
    let x = logs().map(|(x, _)| x).sum::<f64>() / count;
    let y = logs().map(|(_, y)| y).sum::<f64>() / count;
    let covariance: f64 = logs().map(|log| (log.0 - x) * (log.1 - y)).sum();
    let variance: f64 = logs().map(|log| (log.0 - x).powi(2)).sum();
    covariance / variance
}

/// The rows of `tests/data/truth_table.csv` of one trial and slip speed (m/s), up to a time (s).
pub(crate) fn truths(trial: usize, slip_speed: f64, until: f64) -> Vec<Record> {
    let same = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
    let rows: Vec<_> = (super::truth_table().rows())
        .filter(|row| same(row.get("trial"), trial as f64) && same(row.get("v_eps"), slip_speed))
        .filter(|row| row.get("t") < until + 1e-9)
        .map(truth)
        .collect();
    assert!(rows.len() >= 3, "{} rows of truth", rows.len());
    rows
}

fn truth(row: super::Row<'_>) -> Record {
    let energy = Energy {
        translation: row.get("E_trans"),
        rotation: row.get("E_rot"),
        gravity: row.get("E_grav"),
        springs: row.get("E_spring"),
    };
    let work = Dissipation {
        friction: row.get("W_friction"),
        damper: row.get("W_damper"),
        clamp: row.get("W_clamped"),
        ..Dissipation::default()
    };
    let [x, y, z, w] = ["qx", "qy", "qz", "qw"].map(|name| row.get(name));
    let vector = |names| DVec3::from(row.vector(names));
    Record {
        time: row.get("t"),
        state: State::at(vector(["x", "y", "z"]))
            .with_linear_velocity(vector(["ux", "uy", "uz"]))
            .with_orientation(DQuat::from_xyzw(x, y, z, w))
            .with_angular_momentum(vector(["Lx", "Ly", "Lz"])),
        energy,
        work,
        residue: 0.0,
    }
}
