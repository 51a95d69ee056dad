//! The point law by `ode_solvers`: Dormand and Prince's methods of orders 5 and 8 with error control.

use std::cell::RefCell;

use ode_solvers::{Dop853, Dopri5, OutputType, SVector, System};
use tumble::State;
use tumble::glam::{DQuat, DVec3};

use super::{End, Program, Watch};
use crate::law::{Law, rates};

/// Thirteen numbers: position, velocity, orientation, angular momentum.
pub(crate) type Vector = SVector<f64, 13>;

/// Which of its methods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Method {
    Dopri5,
    Dop853,
}

pub(crate) struct OdeSolvers<'a> {
    pub(crate) law: &'a Law,
    pub(crate) start: State,
    pub(crate) seconds: f64,
    pub(crate) method: Method,
    /// Relative, and absolute in the scene's own units.
    pub(crate) tolerance: f64,
    /// Length (m) and time (s) of those units: the crate has one absolute tolerance for all thirteen numbers.
    pub(crate) scale: (f64, f64),
}

/// Length, time and mass by which the numbers are made about 1.
#[derive(Clone, Copy)]
struct Units {
    length: f64,
    time: f64,
    mass: f64,
}

impl Units {
    fn speed(self) -> f64 {
        self.length / self.time
    }

    fn momentum(self) -> f64 {
        self.mass * self.length * self.speed()
    }

    fn pack(self, state: &State) -> Vector {
        let (x, v) = (
            state.position / self.length,
            state.linear_velocity / self.speed(),
        );
        let (q, l) = (state.orientation, state.angular_momentum / self.momentum());
        Vector::from([
            x.x, x.y, x.z, v.x, v.y, v.z, q.x, q.y, q.z, q.w, l.x, l.y, l.z,
        ])
    }

    fn unpack(self, y: &Vector) -> State {
        let vector = |i: usize| DVec3::new(y[i], y[i + 1], y[i + 2]);
        State {
            position: vector(0) * self.length,
            linear_velocity: vector(3) * self.speed(),
            orientation: DQuat::from_xyzw(y[6], y[7], y[8], y[9]),
            angular_momentum: vector(10) * self.momentum(),
        }
    }
}

/// The law as the crate wants it.
struct Equations<'a, 'w> {
    law: &'a Law,
    units: Units,
    watch: RefCell<Option<Watch<'w>>>,
}

impl System<f64, Vector> for Equations<'_, '_> {
    fn system(&self, _: f64, y: &Vector, dy: &mut Vector) {
        let rates = rates(self.law, &self.units.unpack(y));
        let time = self.units.time;
        let rates = State {
            position: rates.position * time,
            linear_velocity: rates.velocity * time,
            orientation: rates.orientation * time,
            angular_momentum: rates.angular_momentum * time,
        };
        *dy = self.units.pack(&rates);
    }

    fn solout(&mut self, _: f64, y: &Vector, _: &Vector) -> bool {
        if let Some(watch) = self.watch.borrow_mut().as_mut() {
            watch(&self.units.unpack(y));
        }
        false
    }
}

/// More steps than any scene should take.
const MOST_STEPS: u32 = 3_000_000;

impl Program for OdeSolvers<'_> {
    fn name(&self) -> String {
        format!("ode_solvers {:?}", self.method)
    }

    fn settings(&self) -> String {
        format!("tol {:.0e}", self.tolerance)
    }

    fn run(&self, watch: Option<Watch<'_>>) -> Result<End, String> {
        let units = Units {
            length: self.scale.0,
            time: self.scale.1,
            mass: self.law.mass,
        };
        let equations = Equations {
            law: self.law,
            units,
            watch: RefCell::new(watch),
        };
        let end = self.seconds / units.time;
        let start = units.pack(&self.start);
        let (y, steps) = solve(equations, self.method, end, start, self.tolerance)?;
        let state = units.unpack(&y);
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

/// The end of a run from time 0, and how many steps it took, with the rejected ones.
pub(crate) fn solve(
    equations: impl System<f64, Vector>,
    method: Method,
    end: f64,
    start: Vector,
    tolerance: f64,
) -> Result<(Vector, u64), String> {
    // The crate's defaults but for the number of steps, and for its test of stiffness, which would end runs that go through.
    macro_rules! run {
        ($solver:ident, $beta:expr, $least:expr, $most:expr) => {{
            let mut solver = $solver::from_param(
                equations,
                0.0,
                end,
                end,
                start,
                tolerance,
                tolerance,
                0.9,
                $beta,
                $least,
                $most,
                end,
                0.0,
                MOST_STEPS,
                u32::MAX,
                OutputType::Sparse,
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
