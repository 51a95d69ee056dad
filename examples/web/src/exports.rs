//! Functions that the page calls.

// An exported name is shared by the whole program, which no compiler can check. The names below are
// those of this file only.
#![allow(unsafe_code, reason = "an exported function needs an unmangled name")]

use core::sync::atomic::{AtomicU8, AtomicU64};

use tumble::glam::DVec3;
use tumble::{RigidPointBody, State};

use crate::memory::{self, Block, STATE, read_parameters, read_state, write_state};
use crate::run::{self, RUN};
use crate::scenes::battery;
use crate::scenes::bodies::Exhibit;
use crate::scenes::error::PageError;
use crate::scenes::parameters::{PageStepper, Parameters, height_on_the_ground};
use crate::tosses::{self, COUNTS};

static PARAMETERS: Block<{ Parameters::COUNT }> = Block::new();
static START: Block<STATE> = Block::new();
/// The run of the chosen method, and that of the default method from the same start.
static RUNS: [Block<RUN>; 2] = [Block::new(), Block::new()];
static TOSSES: Block<COUNTS> = Block::new();
static INTERVAL: Block<2> = Block::new();

/// Returns 0, or 1 with the error's text.
fn code(result: Result<(), PageError>) -> u32 {
    match result {
        Ok(()) => 0,
        Err(error) => {
            memory::write_text(&error);
            1
        }
    }
}

/// Scene of a run: 0 has the chosen method, 1 the default method.
fn stepper_of(number: usize) -> Result<PageStepper, PageError> {
    let parameters = read_parameters(&PARAMETERS);
    if number == 0 {
        parameters.stepper()
    } else {
        parameters.default_stepper()
    }
}

/// Starts both runs at a state, and stores it as their start.
fn begin_at(state: &State) -> Result<(), PageError> {
    write_state(&START, state);
    for (number, run) in RUNS.iter().enumerate() {
        run::begin(run, &stepper_of(number)?, state);
    }
    Ok(())
}

/// Address of the parameters.
#[unsafe(no_mangle)]
pub extern "C" fn parameters() -> *const AtomicU64 {
    PARAMETERS.address()
}

/// Address of the start of the runs.
#[unsafe(no_mangle)]
pub extern "C" fn start() -> *const AtomicU64 {
    START.address()
}

/// Address of a run: 0 with the chosen method, 1 with the default one.
#[unsafe(no_mangle)]
pub extern "C" fn run(number: u32) -> *const AtomicU64 {
    let [chosen, default] = &RUNS;
    if number == 0 {
        chosen.address()
    } else {
        default.address()
    }
}

/// Address of the counts of the tosses.
#[unsafe(no_mangle)]
pub extern "C" fn tosses() -> *const AtomicU64 {
    TOSSES.address()
}

/// Address of the interval that [`wilson`] leaves.
#[unsafe(no_mangle)]
pub extern "C" fn interval() -> *const AtomicU64 {
    INTERVAL.address()
}

/// Address of the text of the last error or report.
#[unsafe(no_mangle)]
pub extern "C" fn text() -> *const AtomicU8 {
    memory::text_address()
}

/// Length of the text, bytes.
#[unsafe(no_mangle)]
pub extern "C" fn text_length() -> u32 {
    memory::text_length()
}

/// Writes the parameters of the first scene of a body.
#[unsafe(no_mangle)]
pub extern "C" fn choose(body: f64) -> u32 {
    code(
        Exhibit::from_number(body)
            .map(|exhibit| PARAMETERS.set_all(0, &exhibit.parameters.numbers())),
    )
}

/// Bounding radius of the chosen body, m; NaN if there is none.
#[unsafe(no_mangle)]
pub extern "C" fn radius() -> f64 {
    Exhibit::from_number(PARAMETERS.get(0))
        .map_or(f64::NAN, |exhibit| exhibit.body.bounding_radius())
}

/// Checks the parameters.
#[unsafe(no_mangle)]
pub extern "C" fn check() -> u32 {
    code(stepper_of(0).map(|_| ()))
}

/// Starts both runs at the start that the parameters describe.
#[unsafe(no_mangle)]
pub extern "C" fn place() -> u32 {
    code(
        read_parameters(&PARAMETERS)
            .start()
            .and_then(|state| begin_at(&state)),
    )
}

/// Starts both runs at the stored start.
#[unsafe(no_mangle)]
pub extern "C" fn restart() -> u32 {
    code(begin_at(&read_state(&START)))
}

/// Starts both runs at the present state of the chosen method's run.
#[unsafe(no_mangle)]
pub extern "C" fn restart_here() -> u32 {
    let [chosen, _] = &RUNS;
    code(begin_at(&read_state(chosen)))
}

/// Takes steps in a run.
#[unsafe(no_mangle)]
pub extern "C" fn advance(number: u32, steps: u32) -> u32 {
    let number = usize::from(number != 0);
    let run = RUNS.get(number).ok_or(PageError::Unknown {
        kind: "run",
        value: 1.0,
    });
    code(run.and_then(|run| run::advance(run, &stepper_of(number)?, steps)))
}

/// Holds the body at a position (m), not below the ground, without velocity and spin.
#[unsafe(no_mangle)]
pub extern "C" fn hold(x: f64, y: f64, z: f64) -> u32 {
    let [chosen, _] = &RUNS;
    let turned = read_state(chosen);
    code(stepper_of(0).and_then(|stepper| {
        let lowest = height_on_the_ground(stepper.body(), &turned);
        let state = State {
            orientation: turned.orientation,
            ..State::at(DVec3::new(x, y, f64::max(z, lowest)))
        };
        begin_at(&state)
    }))
}

/// Hits the body: the velocity (m/s) that the centre of mass gains, and the arm (m) from the centre
/// of mass to the point that is hit.
#[unsafe(no_mangle)]
pub extern "C" fn flick(vx: f64, vy: f64, vz: f64, ax: f64, ay: f64, az: f64) -> u32 {
    let [chosen, _] = &RUNS;
    let mut state = read_state(chosen);
    code(stepper_of(0).and_then(|stepper| {
        let impulse = DVec3::new(vx, vy, vz) * stepper.body().mass();
        let point = state.position + DVec3::new(ax, ay, az);
        stepper.apply_impulse(&mut state, impulse, point)?;
        begin_at(&state)
    }))
}

/// Face on which the body provably stays, or -1.
#[unsafe(no_mangle)]
pub extern "C" fn face() -> i32 {
    let [chosen, _] = &RUNS;
    let found = stepper_of(0).map(|stepper| tosses::proven_face(&stepper, &read_state(chosen)));
    let number = found
        .ok()
        .flatten()
        .and_then(|face| i32::try_from(face).ok());
    number.unwrap_or(-1)
}

/// Largest step size (s) for which the chosen method is stable at the present state, or infinity.
#[unsafe(no_mangle)]
pub extern "C" fn stable_step() -> f64 {
    let [chosen, _] = &RUNS;
    let found = stepper_of(0).map(|stepper| stepper.largest_stable_step(&read_state(chosen)));
    found.ok().flatten().unwrap_or(f64::INFINITY)
}

/// Plays tosses `first` to `end`, without `end`, and adds them to the counts.
#[unsafe(no_mangle)]
pub extern "C" fn toss(seed: u32, first: u32, end: u32) -> u32 {
    code(tosses::play(
        &TOSSES,
        &read_parameters(&PARAMETERS),
        seed.into(),
        first..end,
    ))
}

/// Leaves the interval of Wilson at 95 % for a count of a total.
#[unsafe(no_mangle)]
pub extern "C" fn wilson(count: f64, total: f64) {
    INTERVAL.set_all(0, &tosses::wilson(count, total));
}

/// Computes the hash of the page's battery and leaves it as the text.
#[unsafe(no_mangle)]
pub extern "C" fn bits() -> u32 {
    code(battery::row().map(|hash| memory::write_text(&format_args!("{hash:016x}"))))
}
