//! A fixed-step Rk4 on the point law, as anyone would write it in an hour: all points in each evaluation, a quaternion as four more numbers.

use tumble::State;
use tumble::glam::{DMat3, DQuat, DVec3};

use super::{End, Program, Watch};
use crate::law::Law;

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
        format!("{:.0e} s", self.time_step)
    }

    fn run(&self, mut watch: Option<Watch<'_>>) -> Result<End, String> {
        let mut state = self.start;
        let steps = (self.seconds / self.time_step).ceil();
        let dt = self.seconds / steps;
        for _ in 0..steps as u64 {
            if let Some(watch) = &mut watch {
                watch(&state);
            }
            state = step(self.law, &state, dt);
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

/// Rates of change of a state's four parts.
#[derive(Clone, Copy)]
pub(crate) struct Rates {
    pub(crate) position: DVec3,
    pub(crate) velocity: DVec3,
    pub(crate) orientation: DQuat,
    pub(crate) angular_momentum: DVec3,
}

/// `x' = v`, `v' = F/m`, `q' = ω q/2`, `L' = T`.
pub(crate) fn rates(law: &Law, state: &State) -> Rates {
    let load = law.load(state);
    let axes = DMat3::from_quat(state.orientation.normalize());
    let spin = law.spin(axes, state.angular_momentum);
    Rates {
        position: state.linear_velocity,
        velocity: load.force / law.mass,
        orientation: DQuat::from_vec4((0.5 * spin).extend(0.0)) * state.orientation,
        angular_momentum: load.torque,
    }
}

fn step(law: &Law, state: &State, dt: f64) -> State {
    let k1 = rates(law, state);
    let k2 = rates(law, &moved(state, &k1, 0.5 * dt));
    let k3 = rates(law, &moved(state, &k2, 0.5 * dt));
    let k4 = rates(law, &moved(state, &k3, dt));
    let mut next = moved(state, &k1, dt / 6.0);
    next = moved(&next, &k2, dt / 3.0);
    next = moved(&next, &k3, dt / 3.0);
    next = moved(&next, &k4, dt / 6.0);
    next.with_orientation(next.orientation.normalize())
}

fn moved(state: &State, rates: &Rates, dt: f64) -> State {
    State {
        position: state.position + rates.position * dt,
        linear_velocity: state.linear_velocity + rates.velocity * dt,
        orientation: state.orientation + rates.orientation * dt,
        angular_momentum: state.angular_momentum + rates.angular_momentum * dt,
    }
}
