//! The plain Rk4 as a program, in world axes with contacts, and in body axes for free rotation.

use tumble::State;

use super::{End, Program, Watch};
use crate::law::euler::Free;
use crate::law::{self, Law};

pub(crate) struct PlainRk4<'a> {
    pub(crate) law: &'a Law,
    pub(crate) start: State,
    pub(crate) seconds: f64,
    pub(crate) time_step: f64,
}

impl Program for PlainRk4<'_> {
    fn name(&self) -> String {
        "plain Rk4".into()
    }

    fn settings(&self) -> String {
        super::name_of_step(self.time_step)
    }

    fn run(&self, mut watch: Option<Watch<'_>>) -> Result<End, String> {
        let mut state = self.start;
        let (steps, dt) = even_steps(self.seconds, self.time_step);
        for _ in 0..steps {
            if let Some(watch) = &mut watch {
                watch(&state);
            }
            state = law::step(self.law, &state, dt);
        }
        if let Some(watch) = &mut watch {
            watch(&state);
        }
        ended(state, steps)
    }
}

/// The classical Runge-Kutta method on Euler's equations in body axes, for a body in free flight.
pub(crate) struct PlainEuler<'a> {
    pub(crate) law: &'a Law,
    pub(crate) start: State,
    pub(crate) seconds: f64,
    pub(crate) time_step: f64,
}

impl Program for PlainEuler<'_> {
    fn name(&self) -> String {
        "plain Rk4, body axes".into()
    }

    fn settings(&self) -> String {
        super::name_of_step(self.time_step)
    }

    fn run(&self, mut watch: Option<Watch<'_>>) -> Result<End, String> {
        let (law, start) = (self.law, &self.start);
        let mut free = Free::of(law, start);
        let (steps, dt) = even_steps(self.seconds, self.time_step);
        for step in 0..steps {
            if let Some(watch) = &mut watch {
                watch(&free.state(law, start, dt * step as f64));
            }
            free = free.step(law.inertia, dt);
        }
        let end = free.state(law, start, self.seconds);
        if let Some(watch) = &mut watch {
            watch(&end);
        }
        ended(end, steps)
    }
}

/// Number and size of equal steps that are at most `time_step`.
fn even_steps(seconds: f64, time_step: f64) -> (u64, f64) {
    let steps = (seconds / time_step).ceil();
    (steps as u64, seconds / steps)
}

fn ended(state: State, steps: u64) -> Result<End, String> {
    if state.not_finite().is_some() {
        return Err("diverged".into());
    }
    Ok(End {
        state,
        steps,
        preparation: 0.0,
    })
}
