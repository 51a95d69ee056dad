//! Error against price of every integrator on a scene of one's own (feature `std`).
//!
//! [`measure()`] runs the scene with each [`Setting`] and compares the ends with that of a far
//! finer run. It returns a table that can be printed, asked for its
//! [cheapest](WorkPrecision::cheapest) row within an error, and for its
//! [front](WorkPrecision::pareto_front): the rows that no other beats. The error is a length, in m:
//! of the place, and of the turn by way of the body's reach. The price is the time on this machine,
//! in a program that was built with `--release`; compare rows, not machines. The evaluations of the
//! forces are the same everywhere. [`Setting::ladder`] has 58 settings, which together take about a
//! second for a second of trial 1.
//!
//! ```
//! use tumble::work_precision::{Setting, measure};
//! use tumble::Trial;
//!
//! let trial = Trial { slip_speed: 1e-3, ..Trial::report(1).ok_or("no such trial")? };
//! let stepper = trial.stepper(tumble::Rk4 { time_step: 1e-3 })?;
//! let table = measure(stepper.scene(), &trial.state(), 0.1, &Setting::ladder())?;
//! let best = table.cheapest(1e-4).ok_or("no setting is so good")?;
//! println!("{}: {:.1e} m for {} evaluations", best.setting, best.error, best.evaluations);
//! println!("\nall of them, good to {:.0e} m:\n{table}", table.resolution);
//! # assert!(best.error <= 1e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use alloc::vec::Vec;
use core::fmt;
use core::ops::ControlFlow;
use core::time::Duration;
use std::time::Instant;

use crate::error::{SceneError, StepError};
use crate::gravity::UniformGravity;
use crate::integrator::{
    BogackiShampine32, DormandPrince54, EnergyMomentum, Flight, ForwardEuler, Integrator, Nystrom,
    Rk4, StrangSplitting, SymplecticEuler,
};
use crate::observer::Sample;
use crate::real::{Quaternion, Real, Vector};
use crate::rotation::Rotation;
use crate::scene::{Dynamics, size};
use crate::state::State;
use crate::stepper::Stepper;

/// An integrator of the library, without its parameter.
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
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::ForwardEuler,
        Self::SymplecticEuler,
        Self::StrangSplitting,
        Self::Rk4,
        Self::Nystrom,
        Self::EnergyMomentum,
        Self::BogackiShampine32,
        Self::DormandPrince54,
    ];

    /// Its name in the library.
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
        }
    }

    /// Whether its parameter is a tolerance (m) and not a time step (s).
    #[must_use]
    pub const fn has_tolerance(self) -> bool {
        matches!(self, Self::BogackiShampine32 | Self::DormandPrince54)
    }
}

/// An integrator with its parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Which one.
    pub method: Method,
    /// Its time step (s) or tolerance (m).
    pub parameter: f64,
    /// Whether it [flies in closed form](Flight).
    pub flight: bool,
}

impl Setting {
    /// Each method with seven or eight parameters: time steps from 10 ms to 0.1 ms, tolerances from
    /// 1e-2 to 1e-9 m; flight step by step.
    #[must_use]
    pub fn ladder() -> Vec<Self> {
        const TIME_STEPS: [f64; 7] = [1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4];
        const TOLERANCES: [f64; 8] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9];
        let mut ladder = Vec::new();
        for method in Method::ALL {
            let parameters: &[f64] = if method.has_tolerance() {
                &TOLERANCES
            } else {
                &TIME_STEPS
            };
            ladder.extend(parameters.iter().map(|&parameter| Self {
                method,
                parameter,
                flight: false,
            }));
        }
        ladder
    }
}

/// `Rk4 1e-3 s`, `DormandPrince54 1e-5 m`; with ` + flight` where it flies in closed form.
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

/// What a setting does on a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Which one.
    pub setting: Setting,
    /// At the end of the run, m: of the place and, by the reach (or the radius of gyration, where
    /// that is more), of the turn. Infinite where the run failed.
    pub error: f64,
    /// What the run took on this machine: the shortest of three, or the only one where that took
    /// above 0.1 s.
    pub time: Duration,
    /// How often the forces were evaluated.
    pub evaluations: u64,
    /// Steps taken.
    pub steps: u64,
    /// Attempts that were turned down.
    pub rejected: u64,
    /// The largest rise of the energy in a step, J; 0 where it never rose.
    pub energy_rise: f64,
    /// Why the run failed, if it did.
    pub failure: Option<Failure>,
}

/// Why a run has no end.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Failure {
    /// The scene, or a setting's parameter, cannot be.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The run could not go on.
    #[error(transparent)]
    Step(#[from] StepError),
}

/// Error and price of several settings on one scene.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkPrecision {
    /// In the order of the settings that were asked for.
    pub rows: Vec<Row>,
    /// How far the reference is from one ten times less accurate, m: below this the errors mean
    /// nothing.
    pub resolution: f64,
}

impl WorkPrecision {
    /// The setting that takes the least time for an error of at most `error` (m).
    #[must_use]
    pub fn cheapest(&self, error: f64) -> Option<&Row> {
        (self.rows.iter())
            .filter(|row| row.error <= error)
            .min_by_key(|row| row.time)
    }

    /// The rows that no other beats in both error and time, from the fastest on.
    #[must_use]
    pub fn pareto_front(&self) -> Vec<&Row> {
        let mut rows: Vec<_> = (self.rows.iter())
            .filter(|row| row.failure.is_none())
            .collect();
        rows.sort_by_key(|row| row.time);
        let mut best = f64::INFINITY;
        rows.retain(|row| {
            let better = row.error < best;
            best = best.min(row.error);
            better
        });
        rows
    }
}

/// `setting, error, time, evaluations, energy rise`, a row a line.
impl fmt::Display for WorkPrecision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{:<36} {:>9} {:>11} {:>11} {:>12}",
            "setting", "error, m", "time, µs", "evaluations", "rise, J"
        )?;
        for row in &self.rows {
            let (error, micros) = (row.error, row.time.as_secs_f64() * 1e6);
            let setting = alloc::format!("{}", row.setting);
            write!(
                f,
                "{setting:<36} {error:>9.1e} {micros:>11.1} {:>11} {:>12.1e}",
                row.evaluations, row.energy_rise
            )?;
            match row.failure {
                Some(failure) => writeln!(f, "  {failure}")?,
                None => writeln!(f)?,
            }
        }
        Ok(())
    }
}

/// Runs a scene from `start` for `seconds` with each setting and compares the ends with that of its
/// [`reference()`].
///
/// The scene may be any [`Dynamics`], with the user's own body, ground and friction. A setting that
/// fails gets a row with its error.
///
/// # Errors
/// Where the reference fails.
pub fn measure<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &State<R>,
    seconds: R,
    settings: &[Setting],
) -> Result<WorkPrecision, Failure> {
    let reference = reference(scene, start, seconds)?;
    Ok(measure_against(scene, start, seconds, settings, &reference))
}

/// As [`measure`], against an end that is known: a closed form, say, or the end in double precision
/// for a scene in single.
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

/// What settings are compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference<R: Real = f64> {
    /// The end of the run.
    pub end: State<R>,
    /// How far it is from one ten times less accurate, m.
    pub resolution: f64,
}

/// The end of a run by [`DormandPrince54`] with a tolerance of 1e-11 of the reach (or the radius of
/// gyration, where that is more).
///
/// # Errors
/// Where the run fails: in stick with a tiny slip speed its 20 million steps may be spent.
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

/// A scene to try settings on.
struct Bench<'a, R: Real, D> {
    scene: &'a D,
    start: &'a State<R>,
    seconds: R,
}

type Borrowed<'a, R, D, I> = Stepper<
    R,
    &'a <D as Dynamics<R>>::Body,
    &'a <D as Dynamics<R>>::Ground,
    &'a <D as Dynamics<R>>::Friction,
    UniformGravity<R>,
    I,
>;

impl<'a, R: Real, D: Dynamics<R>> Bench<'a, R, D> {
    fn stepper<I: Integrator<R>>(
        &self,
        integrator: I,
    ) -> Result<Borrowed<'a, R, D, I>, SceneError> {
        Stepper::new(self.scene.body())?
            .with_ground(self.scene.ground())?
            .with_friction(self.scene.friction())?
            .with_gravity(UniformGravity {
                acceleration: self.scene.gravity(),
            })?
            .with_integrator(integrator)
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
        }
    }

    fn row<I: Integrator<R> + Copy>(
        &self,
        setting: Setting,
        integrator: I,
        reference: &State<R>,
    ) -> Row {
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

    /// What the clock does not tell.
    fn count<I: Integrator<R>>(&self, stepper: &Borrowed<'a, R, D, I>, row: &mut Row) {
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

/// Sine of half the angle of a turn.
fn sine_of_half<R: Real>(turn: Rotation<R>) -> R {
    let [x, y, z, _] = turn.to_quat().xyzw();
    (x * x + y * y + z * z).sqrt()
}
