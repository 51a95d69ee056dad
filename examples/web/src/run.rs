//! A run: a state that is advanced, with its energy after every step and the path of its lowest
//! point.

use tumble::State;

use crate::memory::{Block, STATE, read_state, write_state};
use crate::scenes::error::PageError;
use crate::scenes::parameters::{PageStepper, take_step};

/// Samples of the path that one call leaves, at most.
const SAMPLES: u32 = 32;
const STEPS: usize = STATE;
const ENERGIES: usize = STEPS + 1;
const LARGEST_INCREASE: usize = ENERGIES + 5;
const SUM_OF_INCREASES: usize = LARGEST_INCREASE + 1;
const TOUCHING: usize = SUM_OF_INCREASES + 1;
const ANGULAR_VELOCITY: usize = TOUCHING + 1;
const SAMPLE_COUNT: usize = ANGULAR_VELOCITY + 3;
const PATH: usize = SAMPLE_COUNT + 1;

/// Numbers of a run.
pub const RUN: usize = PATH + 3 * SAMPLES as usize;

/// Starts a run at a state.
pub fn begin(run: &Block<RUN>, stepper: &PageStepper, state: &State) {
    for index in 0..RUN {
        run.set(index, 0.0);
    }
    write_state(run, state);
    measure(run, stepper, state);
    sample(run, stepper, state);
}

/// Takes a number of steps and compares the energy after each with the energy before it.
///
/// # Errors
/// Returns [`PageError`] if a step fails. The run then holds the last valid state.
pub fn advance(run: &Block<RUN>, stepper: &PageStepper, steps: u32) -> Result<(), PageError> {
    let mut session = stepper.session(read_state(run));
    let mut energy = session.energy().total();
    let mut largest = run.get(LARGEST_INCREASE);
    let mut sum = run.get(SUM_OF_INCREASES);
    let mut failure = None;
    let stride = steps.div_ceil(SAMPLES).max(1);
    let mut taken = 0;
    run.set(SAMPLE_COUNT, 0.0);
    while taken < steps {
        let before = *session.state();
        if let Err(error) = take_step(&mut session) {
            failure = Some(error);
            break;
        }
        taken += 1;
        // At rest the energy is the same number, too.
        if before != *session.state() {
            let after = session.energy().total();
            let increase = after - energy;
            energy = after;
            if increase > 0.0 {
                largest = f64::max(largest, increase);
                sum += increase;
            }
        }
        if taken % stride == 0 || taken == steps {
            sample(run, stepper, session.state());
        }
    }
    let state = session.into_state();
    write_state(run, &state);
    run.set(STEPS, run.get(STEPS) + f64::from(taken));
    run.set(LARGEST_INCREASE, largest);
    run.set(SUM_OF_INCREASES, sum);
    measure(run, stepper, &state);
    failure.map_or(Ok(()), |error| Err(error.into()))
}

/// Writes what the page shows of a state.
fn measure(run: &Block<RUN>, stepper: &PageStepper, state: &State) {
    let energy = stepper.energy(state);
    let kinds = [
        energy.translation,
        energy.rotation,
        energy.gravity,
        energy.springs,
    ];
    run.set_all(ENERGIES, &kinds);
    run.set(ENERGIES + kinds.len(), energy.total());
    run.set(
        TOUCHING,
        f64::from(u16::try_from(stepper.touching(state)).unwrap_or(u16::MAX)),
    );
    run.set_all(
        ANGULAR_VELOCITY,
        &stepper.angular_velocity(state).to_array(),
    );
}

/// Adds the lowest point to the path.
fn sample(run: &Block<RUN>, stepper: &PageStepper, state: &State) {
    let count = run.get(SAMPLE_COUNT);
    let (Some(index), Some(lowest)) = (crate::scenes::whole(count), stepper.lowest_point(state))
    else {
        return;
    };
    let place = [lowest.position.x, lowest.position.y, lowest.gap];
    run.set_all(PATH + 3 * index as usize, &place);
    run.set(SAMPLE_COUNT, count + 1.0);
}
