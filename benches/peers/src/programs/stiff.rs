//! The point law by a stiff method: the backward differentiation formulas of `diffsol`.
//!
//! They are implicit, of orders 1 to 5, with error control. A user would choose them if stiff
//! friction makes explicit steps short. The Jacobian is computed by central differences.

use std::cell::Cell;

use diffsol::{NalgebraLU, NalgebraMat, OdeBuilder, OdeSolverMethod, OdeSolverStopReason};
use tumble::State;

use super::ode::{Units, Vector};
use super::{End, Program, Watch};
use crate::law::Law;

pub(crate) struct Bdf<'a> {
    pub(crate) law: &'a Law,
    pub(crate) start: State,
    pub(crate) seconds: f64,
    /// Relative tolerance, and absolute tolerance in the units of the scene.
    pub(crate) tolerance: f64,
    /// Length (m) and time (s) of these units.
    pub(crate) scale: (f64, f64),
    pub(crate) is_sampled: bool,
}

type Matrix = NalgebraMat<f64>;

impl Program for Bdf<'_> {
    fn name(&self) -> String {
        "diffsol BDF".into()
    }

    fn settings(&self) -> String {
        super::name_of_tolerance(self.tolerance, self.is_sampled)
    }

    fn is_sampled(&self) -> bool {
        self.is_sampled
    }

    fn run(&self, mut watch: Option<Watch<'_>>) -> Result<End, String> {
        let units = Units::of(self.law, self.scale);
        let start = units.pack(&self.start);
        let rates = |y: &[f64]| units.rates(self.law, &Vector::from_column_slice(y));
        let nudge = self.nudge(units);
        let mut problem = OdeBuilder::<Matrix>::new()
            .rtol(self.tolerance)
            .atol([self.tolerance])
            .rhs_implicit(
                move |y, _, _, dy| dy.copy_from_slice(rates(y).as_slice()),
                move |y, _, _, v, jv| {
                    let (y, v) = (Vector::from_column_slice(y), Vector::from_column_slice(v));
                    let h = nudge / v.amax().max(f64::MIN_POSITIVE);
                    let change =
                        units.rates(self.law, &(y + v * h)) - units.rates(self.law, &(y - v * h));
                    jv.copy_from_slice((change / (2.0 * h)).as_slice());
                },
            )
            .init(move |_, _, y| y.copy_from_slice(start.as_slice()), 13)
            .build()
            .map_err(|error| error.to_string())?;
        // Where friction changes from slip to stick, Newton's method fails many times in a run.
        problem.ode_options.max_nonlinear_solver_failures = 10_000;
        let mut solver = (problem.bdf::<NalgebraLU<f64>>()).map_err(|error| error.to_string())?;
        let end = self.seconds / units.time;
        (solver.set_stop_time(end)).map_err(|error| error.to_string())?;
        let interval = super::sample_interval(self.seconds) / units.time;
        let samples = Samples::every(self.is_sampled.then_some(interval));
        let mut steps = 0;
        loop {
            let reason = solver.step().map_err(|error| error.to_string())?;
            steps += 1;
            let reached = solver.state().t;
            while let Some(time) = samples.next_up_to(reached) {
                let y = (solver.interpolate(time)).map_err(|error| error.to_string())?;
                core::hint::black_box(y);
            }
            if let Some(watch) = &mut watch {
                watch(&unpacked(units, solver.state().y));
            }
            match reason {
                OdeSolverStopReason::TstopReached => break,
                _ if steps >= u64::from(super::most_steps(self.law)) => {
                    return Err("too many steps".into());
                }
                _ => {}
            }
        }
        let state = unpacked(units, solver.state().y);
        Ok(End {
            state,
            steps,
            preparation: 0.0,
        })
    }
}

impl Bdf<'_> {
    /// Half-width of the differences, in the units of the scene: small compared with the slip
    /// speed.
    fn nudge(&self, units: Units) -> f64 {
        1e-3 * (self.law.slip_speed / units.speed()).min(1e-3)
    }
}

fn unpacked(units: Units, y: &diffsol::NalgebraVec<f64>) -> State {
    units.unpack(&Vector::from_column_slice(y.batch_as_slice(0)))
}

/// Times at which a sampled run returns its state, in the units of the scene.
struct Samples {
    interval: Option<f64>,
    taken: Cell<u32>,
}

impl Samples {
    fn every(interval: Option<f64>) -> Self {
        Self {
            interval,
            taken: Cell::new(1),
        }
    }

    fn next_up_to(&self, time: f64) -> Option<f64> {
        let next = self.interval? * f64::from(self.taken.get());
        if next > time {
            return None;
        }
        self.taken.set(self.taken.get() + 1);
        Some(next)
    }
}
