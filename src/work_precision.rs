//! Accuracy against cost of every integrator on a user's scene (feature `std`).
//!
//! [`measure()`] runs the scene with each [`Setting`], and compares the final states with that of a
//! reference run of much higher accuracy. It returns a table, which has
//!
//! - the [cheapest](WorkPrecision::cheapest) row within an error;
//! - the [Pareto front](WorkPrecision::pareto_front), the rows for which no other row is at least
//!   as good in both error and time and better in one.
//!
//! The error is a length, in m. It is the error of the position, plus the error of the orientation
//! times the bounding radius of the body (or its radius of gyration, if that is larger). The cost
//! is the time on this machine, in a program built with `--release`. Compare rows, not machines.
//! The number of force evaluations is the same on every machine. [`Setting::built_in`] lists
//! settings of all integrators of this crate. [`measure_integrator`] takes any other
//! [`Integrator`].
//!
//! ```
//! use tumble::work_precision::{Setting, measure};
//! use tumble::Trial;
//!
//! let trial = Trial { slip_speed: 1e-3, ..Trial::report(1).ok_or("no such trial")? };
//! let stepper = trial.stepper(tumble::Rk4 { time_step: 1e-3 })?;
//! let table = measure(stepper.scene(), &trial.state(), 0.1, &Setting::built_in())?;
//! let best = table.cheapest(1e-4).ok_or("no setting is so good")?;
//! println!("{}: {:.1e} m for {} evaluations", best.setting, best.error, best.evaluations);
//! println!("\nall of them, good to {:.0e} m:\n{table}", table.resolution);
//! # assert!(best.error <= 1e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::cmp::Ordering;
use core::fmt;
use core::ops::ControlFlow;
use core::time::Duration;
use std::time::Instant;

use crate::error::{SceneError, StepError};
use crate::force::Force;
use crate::gravity::UniformGravity;
use crate::integrator::{
    AdaptiveEnergyMomentum, AdaptiveNystrom, BogackiShampine32, DormandPrince54, EnergyMomentum,
    Flight, ForwardEuler, Integrator, Nystrom, Radau5, Rk4, StrangSplitting, SymplecticEuler,
};
use crate::observer::Sample;
use crate::real::{Quaternion, Real, Vector};
use crate::rotation::Rotation;
use crate::scene::{Dynamics, size};
use crate::state::State;
use crate::stepper::Stepper;

/// Integrator of the library, without its parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// [`ForwardEuler`]
    ForwardEuler,
    /// [`SymplecticEuler`]
    SymplecticEuler,
    /// [`StrangSplitting`]
    StrangSplitting,
    /// [`Rk4`]
    Rk4,
    /// [`Nystrom`]
    Nystrom,
    /// [`EnergyMomentum`]
    EnergyMomentum,
    /// [`BogackiShampine32`]
    BogackiShampine32,
    /// [`DormandPrince54`]
    DormandPrince54,
    /// [`AdaptiveEnergyMomentum`]
    AdaptiveEnergyMomentum,
    /// [`AdaptiveNystrom`]
    AdaptiveNystrom,
    /// [`Radau5`]
    Radau5,
}

impl Method {
    /// All methods.
    pub const ALL: [Self; 11] = [
        Self::ForwardEuler,
        Self::SymplecticEuler,
        Self::StrangSplitting,
        Self::Rk4,
        Self::Nystrom,
        Self::EnergyMomentum,
        Self::BogackiShampine32,
        Self::DormandPrince54,
        Self::AdaptiveEnergyMomentum,
        Self::AdaptiveNystrom,
        Self::Radau5,
    ];

    /// Returns the name of the integrator in the library.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::ForwardEuler => "ForwardEuler",
            Self::SymplecticEuler => "SymplecticEuler",
            Self::StrangSplitting => "StrangSplitting",
            Self::Rk4 => "Rk4",
            Self::Nystrom => "Nystrom",
            Self::EnergyMomentum => "EnergyMomentum",
            Self::BogackiShampine32 => "BogackiShampine32",
            Self::DormandPrince54 => "DormandPrince54",
            Self::AdaptiveEnergyMomentum => "AdaptiveEnergyMomentum",
            Self::AdaptiveNystrom => "AdaptiveNystrom",
            Self::Radau5 => "Radau5",
        }
    }

    /// Returns true if the parameter is a tolerance (m) and not a step size (s).
    #[must_use]
    pub const fn has_tolerance(self) -> bool {
        matches!(
            self,
            Self::BogackiShampine32
                | Self::DormandPrince54
                | Self::AdaptiveEnergyMomentum
                | Self::AdaptiveNystrom
                | Self::Radau5
        )
    }
}

/// Integrator with its parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Integrator.
    pub method: Method,
    /// Step size (s) or tolerance (m).
    pub parameter: f64,
    /// True if flight is computed [in closed form](Flight).
    pub flight: bool,
}

impl Setting {
    /// Returns each method with six to eight parameters: step sizes from 10 ms to 0.1 ms,
    /// tolerances from 1e-2 to 1e-9 m. Flight is computed step by step. `AdaptiveEnergyMomentum`
    /// has tolerances down to 1e-7 m only: its cost grows with their inverse root.
    #[must_use]
    pub fn built_in() -> Vec<Self> {
        const TIME_STEPS: [f64; 7] = [1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4];
        const TOLERANCES: [f64; 8] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9];
        let mut settings = Vec::new();
        for method in Method::ALL {
            let parameters: &[f64] = if method == Method::AdaptiveEnergyMomentum {
                &TOLERANCES[..6]
            } else if method.has_tolerance() {
                &TOLERANCES
            } else {
                &TIME_STEPS
            };
            settings.extend(parameters.iter().map(|&parameter| Self {
                method,
                parameter,
                flight: false,
            }));
        }
        settings
    }
}

/// Writes `Rk4 1e-3 s` or `DormandPrince54 1e-5 m`, with ` + flight` for flight in closed form.
impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = if self.method.has_tolerance() {
            "m"
        } else {
            "s"
        };
        let flight = if self.flight { " + flight" } else { "" };
        write!(
            f,
            "{} {:e} {unit}{flight}",
            self.method.name(),
            self.parameter
        )
    }
}

/// Result of one integrator on a scene.
///
/// `S` is what names it: a [`Setting`] of a built-in integrator, or a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<S = Setting> {
    /// Integrator with its parameter.
    pub setting: S,
    /// Error at the end of the run, m; infinite if the run failed.
    ///
    /// It is the error of the position, plus the error of the orientation times the bounding radius
    /// (or the radius of gyration, if that is larger).
    pub error: f64,
    /// Time of the run on this machine: the shortest of three runs, or the first alone if it took
    /// more than 0.1 s. [`Duration::MAX`] if the scene refused the integrator.
    pub time: Duration,
    /// Number of force evaluations, 0 if the run failed.
    pub evaluations: u64,
    /// Number of accepted steps, 0 if the run failed.
    pub steps: u64,
    /// Number of rejected attempts, 0 if the run failed.
    pub rejected: u64,
    /// Largest increase of the energy in a step, J; 0 if it never increased, or if the run failed.
    pub energy_rise: f64,
    /// Cause of the failure, if the run failed.
    pub failure: Option<Failure>,
}

/// Cause of a failed run.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Failure {
    /// The scene or the parameter of a setting is invalid.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A step failed.
    #[error(transparent)]
    Step(#[from] StepError),
}

/// Error and cost of several settings on one scene.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkPrecision<S = Setting> {
    /// One row for each setting, in the order of the settings.
    pub rows: Vec<Row<S>>,
    /// Difference between the reference and a reference of one tenth of its accuracy, m. Errors
    /// below this difference have no meaning.
    pub resolution: f64,
}

impl<S> WorkPrecision<S> {
    /// Returns the row with the least time for an error of at most `error` (m). `None` if no row is
    /// that accurate, or if the reference is not: the [`resolution`](Self::resolution) is above
    /// `error`.
    #[must_use]
    pub fn cheapest(&self, error: f64) -> Option<&Row<S>> {
        (self.rows.iter())
            .filter(|row| row.failure.is_none() && row.error <= error && self.resolution <= error)
            .min_by(|a, b| by_cost(a, b))
    }

    /// Returns the rows for which no other row is at least as good in both error and time and
    /// better in one, in order of time.
    #[must_use]
    pub fn pareto_front(&self) -> Vec<&Row<S>> {
        let mut rows: Vec<_> = (self.rows.iter())
            .filter(|row| row.failure.is_none())
            .collect();
        rows.sort_by(|a, b| by_cost(a, b));
        let mut last: Option<&Row<S>> = None;
        rows.retain(|&row| {
            let is_equal = |last: &Row<S>| (row.time, row.error) == (last.time, last.error);
            let is_best = last.is_none_or(|last| row.error < last.error || is_equal(last));
            if is_best {
                last = Some(row);
            }
            is_best
        });
        rows
    }
}

/// Order by time, and by error at the same time.
fn by_cost<S>(a: &Row<S>, b: &Row<S>) -> Ordering {
    (a.time.cmp(&b.time)).then(a.error.total_cmp(&b.error))
}

impl<S: fmt::Display> WorkPrecision<S> {
    /// Names each row by its text, so that a row of another integrator can be added.
    #[must_use]
    pub fn with_text(self) -> WorkPrecision<String> {
        let rows = self.rows.into_iter().map(|row| Row {
            setting: row.setting.to_string(),
            error: row.error,
            time: row.time,
            evaluations: row.evaluations,
            steps: row.steps,
            rejected: row.rejected,
            energy_rise: row.energy_rise,
            failure: row.failure,
        });
        WorkPrecision {
            rows: rows.collect(),
            resolution: self.resolution,
        }
    }
}

/// Writes `setting, error, time, evaluations, energy rise`, one row a line, or the cause of a
/// failure.
impl<S: fmt::Display> fmt::Display for WorkPrecision<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{:<36} {:>9} {:>11} {:>11} {:>12}",
            "setting", "error, m", "time, µs", "evaluations", "rise, J"
        )?;
        for row in &self.rows {
            let setting = row.setting.to_string();
            if let Some(failure) = row.failure {
                let none = "-";
                writeln!(
                    f,
                    "{setting:<36} {none:>9} {none:>11} {none:>11} {none:>12}  {failure}"
                )?;
                continue;
            }
            let (error, micros) = (row.error, row.time.as_secs_f64() * 1e6);
            writeln!(
                f,
                "{setting:<36} {error:>9.1e} {micros:>11.1} {:>11} {:>12.1e}",
                row.evaluations, row.energy_rise
            )?;
        }
        Ok(())
    }
}

/// Runs a scene from `start` for `seconds` with each setting, and compares the final states with
/// that of its [`reference()`].
///
/// The scene may be any [`Dynamics`], with the user's own body, ground and friction. A setting that
/// fails gets a row with its error.
///
/// # Errors
/// Returns [`Failure`] if the reference run fails.
pub fn measure<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &State<R>,
    seconds: R,
    settings: &[Setting],
) -> Result<WorkPrecision, Failure> {
    let reference = reference(scene, start, seconds)?;
    Ok(measure_against(scene, start, seconds, settings, &reference))
}

/// Runs a scene with each setting, and compares the final states with a known final state.
///
/// Examples of a known state are a closed form, or the double-precision result for a scene in
/// single precision. Otherwise the function equals [`measure`].
pub fn measure_against<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &State<R>,
    seconds: R,
    settings: &[Setting],
    reference: &Reference<R>,
) -> WorkPrecision {
    let bench = Bench {
        scene,
        start,
        seconds,
    };
    WorkPrecision {
        rows: settings
            .iter()
            .map(|setting| bench.measure(*setting, &reference.end))
            .collect(),
        resolution: reference.resolution,
    }
}

/// Runs a scene with any [`Integrator`], and compares the final state with that of a
/// [`reference()`].
///
/// `setting` names the integrator in its row. `WorkPrecision::with_text` gives the table of the
/// built-in integrators the same type, so that the row can be added:
///
/// ```
/// use tumble::work_precision::{Setting, measure_against, measure_integrator, reference};
/// use tumble::{Rk4, Trial};
///
/// let trial = Trial { slip_speed: 1e-3, ..Trial::report(1).ok_or("no such trial")? };
/// let own = Rk4 { time_step: 5e-4 };
/// let stepper = trial.stepper(own)?;
/// let (scene, start) = (stepper.scene(), trial.state());
/// let truth = reference(scene, &start, 0.1)?;
///
/// let table = measure_against(scene, &start, 0.1, &Setting::built_in()[..3], &truth);
/// let mut table = table.with_text();
/// let row = measure_integrator(scene, &start, 0.1, "own, 0.5 ms".to_owned(), own, &truth);
/// table.rows.push(row);
/// println!("{table}");
/// # assert!(table.rows.iter().all(|row| row.failure.is_none()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn measure_integrator<R: Real, D: Dynamics<R>, I: Integrator<R>, S>(
    scene: &D,
    start: &State<R>,
    seconds: R,
    setting: S,
    integrator: I,
    reference: &Reference<R>,
) -> Row<S> {
    let bench = Bench {
        scene,
        start,
        seconds,
    };
    bench.row(setting, integrator, &reference.end)
}

/// Reference result that settings are compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference<R: Real = f64> {
    /// Final state of the run.
    pub end: State<R>,
    /// Difference between this reference and one of a tenth of its accuracy, m.
    pub resolution: f64,
}

/// Computes the final state of a run by [`DormandPrince54`] with a tolerance of 1e-11 of the
/// bounding radius (or of the radius of gyration or of 1 mm, if that is larger).
///
/// # Errors
/// Returns [`Failure`] if the run fails. In stick with a very small slip speed the run may exceed
/// its budget of 20 million steps.
pub fn reference<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &State<R>,
    seconds: R,
) -> Result<Reference<R>, Failure> {
    let bench = Bench {
        scene,
        start,
        seconds,
    };
    let method = |share: f64| DormandPrince54 {
        budget: 20_000_000,
        ..DormandPrince54::new(R::from_f64(share) * size(scene).at_least(R::from_f64(1e-3)))
    };
    let end = bench.end(method(1e-11))?;
    let coarse = bench.end(method(1e-10))?;
    Ok(Reference {
        end,
        resolution: bench.apart(&end, &coarse),
    })
}

/// Scene on which settings are measured.
struct Bench<'a, R: Real, D> {
    scene: &'a D,
    start: &'a State<R>,
    seconds: R,
}

type Borrowed<'a, R, D, I> = Stepper<
    &'a <D as Dynamics<R>>::Body,
    &'a <D as Dynamics<R>>::Ground,
    &'a <D as Dynamics<R>>::Friction,
    UniformGravity<R>,
    I,
    R,
    &'a <D as Dynamics<R>>::Force,
>;

impl<'a, R: Real, D: Dynamics<R>> Bench<'a, R, D> {
    /// Gravity without the constant part of the applied force, m/s².
    fn gravity(&self) -> R::Vec3 {
        let gravity = self.scene.gravity();
        match self.scene.force().constant_force() {
            Some(force) => gravity - force * self.scene.inertia_properties().inverse_mass(),
            None => gravity,
        }
    }

    fn stepper<I: Integrator<R>>(
        &self,
        integrator: I,
    ) -> Result<Borrowed<'a, R, D, I>, SceneError> {
        Stepper::builder(self.scene.body())
            .ground(self.scene.ground())
            .friction(self.scene.friction())
            .gravity(UniformGravity {
                acceleration: self.gravity(),
            })
            .force(self.scene.force())
            .integrator(integrator)
            .build()
    }

    fn end<I: Integrator<R>>(&self, integrator: I) -> Result<State<R>, Failure> {
        let mut state = *self.start;
        self.stepper(integrator)?
            .advance(&mut state, self.seconds)?;
        Ok(state)
    }

    fn apart(&self, a: &State<R>, b: &State<R>) -> f64 {
        let turn = a.rotation().after(b.rotation().inverse());
        let angle = R::TWO * sine_of_half(turn);
        ((a.position - b.position).length() + angle * size(self.scene)).to_f64()
    }

    fn measure(&self, setting: Setting, reference: &State<R>) -> Row {
        let parameter = R::from_f64(setting.parameter);
        macro_rules! with {
            ($integrator:expr) => {
                if setting.flight {
                    self.row(setting, Flight($integrator), reference)
                } else {
                    self.row(setting, $integrator, reference)
                }
            };
        }
        match setting.method {
            Method::ForwardEuler => with!(ForwardEuler {
                time_step: parameter
            }),
            Method::SymplecticEuler => with!(SymplecticEuler {
                time_step: parameter
            }),
            Method::StrangSplitting => with!(StrangSplitting {
                time_step: parameter
            }),
            Method::Rk4 => with!(Rk4 {
                time_step: parameter
            }),
            Method::Nystrom => with!(Nystrom {
                time_step: parameter
            }),
            Method::EnergyMomentum => with!(EnergyMomentum {
                time_step: parameter
            }),
            Method::BogackiShampine32 => with!(BogackiShampine32::new(parameter)),
            Method::DormandPrince54 => with!(DormandPrince54::new(parameter)),
            Method::AdaptiveEnergyMomentum => with!(AdaptiveEnergyMomentum::new(parameter)),
            Method::AdaptiveNystrom => with!(AdaptiveNystrom::new(parameter)),
            Method::Radau5 => with!(Radau5::new(parameter)),
        }
    }

    fn row<I: Integrator<R>, S>(&self, setting: S, integrator: I, reference: &State<R>) -> Row<S> {
        let mut row = Row {
            setting,
            error: f64::INFINITY,
            time: Duration::MAX,
            evaluations: 0,
            steps: 0,
            rejected: 0,
            energy_rise: 0.0,
            failure: None,
        };
        let stepper = match self.stepper(integrator) {
            Ok(stepper) => stepper,
            Err(error) => {
                row.failure = Some(error.into());
                return row;
            }
        };
        for _ in 0..3 {
            let (mut state, clock) = (*self.start, Instant::now());
            row.failure = (stepper.advance(&mut state, self.seconds).err()).map(Failure::Step);
            row.time = row.time.min(clock.elapsed());
            if row.failure.is_some() {
                return row;
            }
            row.error = self.apart(&state, reference);
            if row.time > Duration::from_millis(100) {
                break;
            }
        }
        self.count(&stepper, &mut row);
        row
    }

    /// Counts steps and evaluations, and the largest increase of the energy, in a run that is not
    /// timed.
    fn count<I: Integrator<R>, S>(&self, stepper: &Borrowed<'a, R, D, I>, row: &mut Row<S>) {
        let mut last: Option<R> = None;
        let mut rise = R::ZERO;
        let mut state = *self.start;
        let _ = stepper.run(&mut state, self.seconds, &mut |sample: &Sample<'_, R>| {
            let energy = sample.energy().total();
            if let Some(before) = last.replace(energy) {
                rise = rise.at_least(energy - before);
            }
            row.steps = sample.step;
            row.evaluations = sample.evaluations;
            row.rejected = sample.rejected;
            ControlFlow::Continue(())
        });
        row.energy_rise = rise.to_f64();
    }
}

/// Sine of half the angle of a rotation.
fn sine_of_half<R: Real>(turn: Rotation<R>) -> R {
    let [x, y, z, _] = turn.to_quat().xyzw();
    (x * x + y * y + z * z).sqrt()
}
