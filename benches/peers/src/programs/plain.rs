//! The plain Rk4 as a program.

use tumble::State;

use super::{End, Program, Watch};
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
        let steps = (self.seconds / self.time_step).ceil();
        let dt = self.seconds / steps;
        for _ in 0..steps as u64 {
            if let Some(watch) = &mut watch {
                watch(&state);
            }
            state = law::step(self.law, &state, dt);
        }
        if let Some(watch) = &mut watch {
            watch(&state);
        }
        if state.not_finite().is_some() {
            return Err("diverged".into());
        }
        Ok(End {
            state,
            steps: steps as u64,
            preparation: 0.0,
        })
    }
}
