//! The point law by `ode_solvers`: the methods of Dormand and Prince of orders 5 and 8 with error
//! control.
//!
//! A body in free flight is passed to them as Euler's equations in body axes, seven numbers, which
//! is how a user would write free rotation.

use std::cell::RefCell;

use ode_solvers::{Dop853, Dopri5, OutputType, SVector, System};
use tumble::State;
use tumble::glam::{DQuat, DVec3};

use super::{End, Program, Watch};
use crate::law::euler::Free;
use crate::law::{Law, rates};

/// State of thirteen numbers: position, velocity, orientation, angular momentum.
pub(crate) type Vector = SVector<f64, 13>;

/// State of seven numbers: orientation, angular velocity in body axes.
type FreeVector = SVector<f64, 7>;

/// Method of the program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Method {
    Dopri5,
    Dop853,
}

/// Form of the equations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Form {
    /// The point law in world axes.
    World,
    /// Euler's equations in body axes, for a body in free flight.
    Body,
}

pub(crate) struct OdeSolvers<'a> {
    pub(crate) law: &'a Law,
    pub(crate) start: State,
    pub(crate) seconds: f64,
    pub(crate) method: Method,
    pub(crate) form: Form,
    /// Relative tolerance, and absolute tolerance in the units of the scene.
    pub(crate) tolerance: f64,
    /// Length (m) and time (s) of these units. The program has one absolute tolerance for all
    /// numbers.
    pub(crate) scale: (f64, f64),
    /// True if its dense output is sampled 240 times a second.
    pub(crate) is_sampled: bool,
}

/// Length, time and mass by which the numbers are scaled to about 1.
#[derive(Clone, Copy)]
pub(crate) struct Units {
    pub(crate) length: f64,
    pub(crate) time: f64,
    mass: f64,
}

impl Units {
    pub(crate) fn of(law: &Law, (length, time): (f64, f64)) -> Self {
        Self {
            length,
            time,
            mass: law.mass,
        }
    }

    pub(crate) fn speed(self) -> f64 {
        self.length / self.time
    }

    fn momentum(self) -> f64 {
        self.mass * self.length * self.speed()
    }

    pub(crate) fn pack(self, state: &State) -> Vector {
        let (x, v) = (
            state.position / self.length,
            state.linear_velocity / self.speed(),
        );
        let (q, l) = (state.orientation, state.angular_momentum / self.momentum());
        Vector::from([
            x.x, x.y, x.z, v.x, v.y, v.z, q.x, q.y, q.z, q.w, l.x, l.y, l.z,
        ])
    }

    pub(crate) fn unpack(self, y: &Vector) -> State {
        let vector = |i: usize| DVec3::new(y[i], y[i + 1], y[i + 2]);
        State {
            position: vector(0) * self.length,
            linear_velocity: vector(3) * self.speed(),
            orientation: DQuat::from_xyzw(y[6], y[7], y[8], y[9]),
            angular_momentum: vector(10) * self.momentum(),
        }
    }

    /// Rates of change of the thirteen numbers.
    pub(crate) fn rates(self, law: &Law, y: &Vector) -> Vector {
        let rates = rates(law, &self.unpack(y));
        self.pack(&State {
            position: rates.position * self.time,
            linear_velocity: rates.velocity * self.time,
            orientation: rates.orientation * self.time,
            angular_momentum: rates.angular_momentum * self.time,
        })
    }
}

/// Point law in the form that the program requires.
struct Equations<'a, 'w> {
    law: &'a Law,
    units: Units,
    watch: RefCell<Option<Watch<'w>>>,
}

impl System<f64, Vector> for Equations<'_, '_> {
    fn system(&self, _: f64, y: &Vector, dy: &mut Vector) {
        *dy = self.units.rates(self.law, y);
    }

    fn solout(&mut self, _: f64, y: &Vector, _: &Vector) -> bool {
        if let Some(watch) = self.watch.borrow_mut().as_mut() {
            watch(&self.units.unpack(y));
        }
        false
    }
}

/// Euler's equations in the form that the program requires.
struct FreeEquations<'a, 'w> {
    law: &'a Law,
    start: State,
    units: Units,
    watch: RefCell<Option<Watch<'w>>>,
}

impl FreeEquations<'_, '_> {
    fn pack(&self, free: &Free) -> FreeVector {
        let (q, w) = (free.orientation, free.spin * self.units.time);
        FreeVector::from([q.x, q.y, q.z, q.w, w.x, w.y, w.z])
    }

    fn unpack(&self, y: &FreeVector) -> Free {
        Free {
            orientation: DQuat::from_xyzw(y[0], y[1], y[2], y[3]),
            spin: DVec3::new(y[4], y[5], y[6]) / self.units.time,
        }
    }
}

impl System<f64, FreeVector> for FreeEquations<'_, '_> {
    fn system(&self, _: f64, y: &FreeVector, dy: &mut FreeVector) {
        let rates = self.unpack(y).rates(self.law.inertia);
        *dy = self.pack(&Free {
            orientation: rates.orientation * self.units.time,
            spin: rates.spin * self.units.time,
        });
    }

    fn solout(&mut self, time: f64, y: &FreeVector, _: &FreeVector) -> bool {
        if let Some(watch) = self.watch.borrow_mut().as_mut() {
            let seconds = time * self.units.time;
            watch(&self.unpack(y).state(self.law, &self.start, seconds));
        }
        false
    }
}

impl Program for OdeSolvers<'_> {
    fn name(&self) -> String {
        let axes = match self.form {
            Form::World => "",
            Form::Body => ", body axes",
        };
        format!("ode_solvers {:?}{axes}", self.method)
    }

    fn settings(&self) -> String {
        super::name_of_tolerance(self.tolerance, self.is_sampled)
    }

    fn is_sampled(&self) -> bool {
        self.is_sampled
    }

    fn run(&self, watch: Option<Watch<'_>>) -> Result<End, String> {
        let units = Units::of(self.law, self.scale);
        let (state, steps) = match self.form {
            Form::World => self.run_in_world_axes(units, watch)?,
            Form::Body => self.run_in_body_axes(units, watch)?,
        };
        if state.not_finite().is_some() {
            return Err("diverged".into());
        }
        Ok(End {
            state,
            steps,
            preparation: 0.0,
        })
    }
}

impl OdeSolvers<'_> {
    fn run_in_world_axes(
        &self,
        units: Units,
        watch: Option<Watch<'_>>,
    ) -> Result<(State, u64), String> {
        let equations = Equations {
            law: self.law,
            units,
            watch: RefCell::new(watch),
        };
        let start = units.pack(&self.start);
        let (y, steps) = solve(
            equations,
            self.method,
            self.span(units),
            start,
            self.tolerance,
        )?;
        Ok((units.unpack(&y), steps))
    }

    fn run_in_body_axes(
        &self,
        units: Units,
        watch: Option<Watch<'_>>,
    ) -> Result<(State, u64), String> {
        let (law, start) = (self.law, self.start);
        let equations = |watch| FreeEquations {
            law,
            start,
            units,
            watch: RefCell::new(watch),
        };
        let packed = equations(None).pack(&Free::of(law, &start));
        let (method, span) = (self.method, self.span(units));
        let (y, steps) = solve(equations(watch), method, span, packed, self.tolerance)?;
        let end = equations(None).unpack(&y);
        Ok((end.state(law, &start, self.seconds), steps))
    }

    fn span(&self, units: Units) -> Span {
        Span {
            end: self.seconds / units.time,
            most_steps: super::most_steps(self.law),
            sample: (self.is_sampled).then(|| super::sample_interval(self.seconds) / units.time),
        }
    }
}

/// End time of a run from time 0, and the interval of the samples, in the units of the scene.
#[derive(Clone, Copy)]
pub(crate) struct Span {
    pub(crate) end: f64,
    pub(crate) sample: Option<f64>,
    pub(crate) most_steps: u32,
}

/// Returns the end of a run from time 0, and the number of steps, including rejected ones.
pub(crate) fn solve<const N: usize>(
    equations: impl System<f64, SVector<f64, N>>,
    method: Method,
    span: Span,
    start: SVector<f64, N>,
    tolerance: f64,
) -> Result<(SVector<f64, N>, u64), String> {
    let end = span.end;
    let (output, interval) = match span.sample {
        Some(interval) => (OutputType::Dense, interval),
        None => (OutputType::Sparse, end),
    };
    // The defaults of the program, except for the number of steps and for the stiffness test, which
    // would end runs that succeed.
    macro_rules! run {
        ($solver:ident, $beta:expr, $least:expr, $most:expr) => {{
            let mut solver = $solver::from_param(
                equations,
                0.0,
                end,
                interval,
                start,
                tolerance,
                tolerance,
                0.9,
                $beta,
                $least,
                $most,
                end,
                0.0,
                span.most_steps,
                u32::MAX,
                output,
            );
            let stats = solver.integrate().map_err(|error| error.to_string())?;
            let y = *solver.y_out().last().ok_or("no output")?;
            Ok((y, u64::from(stats.accepted_steps + stats.rejected_steps)))
        }};
    }
    match method {
        Method::Dopri5 => run!(Dopri5, 0.04, 0.2, 10.0),
        Method::Dop853 => run!(Dop853, 0.0, 0.333, 6.0),
    }
}
