//! A scene of any parts, from any state, by every integrator: each step returns an error and keeps
//! the state, or returns a valid state.

use tumble::real::{Quaternion, Vector};
use tumble::{Dynamics, Force, Real, SpringDamperGround, State, StepError};

use super::input::Input;
use super::parts::{AnyStepper, Parts, numbers, state};

/// Steps of an input.
const STEPS: u32 = 24;

/// Plays an input.
pub fn run(data: &[u8]) {
    let mut input = Input::new(data);
    if input.flag() {
        play::<f32>(&mut input);
    } else {
        play::<f64>(&mut input);
    }
}

fn play<R: Real>(input: &mut Input<'_>) {
    let Ok(parts) = Parts::<R>::read(input) else {
        return;
    };
    let Ok(stepper) = parts.stepper() else {
        return;
    };
    let mut state = state::<R>(input);
    query(&stepper, &state, input);
    steps(&stepper, &mut state, STEPS, input);
    query(&stepper, &state, input);
}

/// Calls every query about a state. None of them may panic.
fn query<R: Real>(stepper: &AnyStepper<'_, R>, state: &State<R>, input: &mut Input<'_>) {
    let _ = stepper.lowest_point(state);
    let _ = stepper.touching(state);
    let _ = stepper.angular_velocity(state);
    let stable = stepper.largest_stable_step(state);
    assert!(
        stable.is_none_or(|step| step >= R::ZERO),
        "the largest stable step is {stable:?}"
    );
    let turned = (stepper.free_rotation(state)).rotation_at(input.size(1e-3, 1e3));
    let _ = turned.axes();
    let mut pushed = *state;
    let (impulse, point) = (input.vector::<R>(1e-3, 1.0), input.vector::<R>(1e-3, 1.0));
    let outcome = stepper.apply_impulse(&mut pushed, impulse, point);
    if outcome.is_err() {
        assert_eq!(numbers(&pushed), numbers(state), "a refused impulse acts");
    } else {
        assert!(pushed.not_finite().is_none(), "an impulse gives {pushed:?}");
    }
}

/// Takes steps until one fails.
pub fn steps<R: Real>(
    stepper: &AnyStepper<'_, R>,
    state: &mut State<R>,
    count: u32,
    input: &mut Input<'_>,
) {
    let mut session = stepper.session(*state);
    let keeps_energy = stepper.integrator().keeps_energy();
    for number in 0..count {
        let limit = if input.byte() < 224 {
            R::MAX
        } else {
            input.size(1e-9, 1e-1)
        };
        let start = *session.state();
        let before = keeps_energy.then(|| session.energy().total());
        let step = session.step_within(limit);
        *state = *session.state();
        let (work, elapsed) = match step {
            Err(error) => {
                // The clock of a session cannot hold a step that is far shorter than the time. The
                // method has a memory there, and may choose a shorter step than alone.
                let mut alone = start;
                let shortest = match stepper.step(&mut alone) {
                    Ok(step) => step.elapsed.at_most(limit),
                    Err(StepError::StepTooShort { .. } | StepError::BudgetSpent { .. }) => R::ZERO,
                    Err(_) => limit,
                };
                fails_well([&start, state], [session.time(), limit, shortest], &error);
                return;
            }
            Ok(step) => {
                let takes_time = step.elapsed > R::ZERO || limit <= R::ZERO;
                assert!(
                    takes_time && step.elapsed <= limit,
                    "step {number} takes {:?} of {limit:?}",
                    step.elapsed
                );
                is_valid(state, &start, number);
                (step.drive_work, step.elapsed)
            }
        };
        let is_driven =
            !stepper.scene().force().is_passive() || stepper.scene().ground().motion().is_some();
        assert!(
            is_driven || work == R::ZERO,
            "step {number}: {work:e} J of no drive"
        );
        // A step of no time asks for no energy, which may not be a number.
        if let Some(before) = before.filter(|_| elapsed > R::ZERO) {
            let after = stepper.energy(state).total();
            assert!(
                after <= before + work,
                "step {number}: from {before:e} J to {after:e} J with {work:e} J of work"
            );
            if !is_driven {
                is_no_jump(stepper, [&start, state], before, elapsed, number);
            }
        }
    }
}

/// No step moves the body farther than its energy allows.
///
/// The speed is at most `√(2 (E + m g·x)/m)`, where E is the total energy, which only decreases,
/// and x the position. The greatest along the path is that of one of its ends, increased by what
/// the body falls in between.
fn is_no_jump<R: Real>(
    stepper: &AnyStepper<'_, R>,
    [start, end]: [&State<R>; 2],
    joules: R,
    seconds: R,
    number: u32,
) {
    let (mass, gravity) = (
        stepper.scene().inertia_properties().mass(),
        stepper.scene().gravity(),
    );
    let most = |state: &State<R>| {
        let (total, potential) = (joules / mass, gravity.dot(state.position));
        let rounding = (total.abs() + potential.abs()) * R::EPSILON * R::from_f64(64.0);
        ((total + potential + rounding).at_least(R::ZERO) * R::TWO).sqrt()
    };
    let speed = most(start) + most(end) + gravity.length() * seconds;
    let rounding = (start.position.length() + end.position.length()) * R::EPSILON;
    let path = (end.position - start.position).length();
    assert!(
        path <= seconds * speed * R::from_f64(4.0) + rounding * R::from_f64(4.0),
        "step {number} moves by {path:e} m in {seconds:e} s, at most at {speed:e} m/s: {start:?} to {end:?}"
    );
}

/// A step that fails keeps the state, and does not blame what is valid.
fn fails_well<R: Real>(
    [start, end]: [&State<R>; 2],
    [time, limit, length]: [R; 3],
    error: &StepError,
) {
    assert_eq!(numbers(end), numbers(start), "a failed step moves: {error}");
    assert!(!error.to_string().is_empty());
    match error {
        StepError::Stalled => assert!(
            length <= time * (R::EPSILON * R::EPSILON),
            "a step of {length:?} s takes no time at {time:?} s"
        ),
        StepError::BadLimit { .. } => {
            let order = limit.partial_cmp(&R::ZERO);
            assert!(order.is_none_or(|order| order.is_lt()), "{error}");
        }
        StepError::BadState { .. } => {
            let square = start.rotation().length_squared();
            let is_turn = (square - R::ONE).abs() < R::HALF;
            assert!(
                start.not_finite().is_some() || !is_turn,
                "{error}: {start:?}"
            );
        }
        _ => {}
    }
}

/// A state after a step is finite, and its quaternion has length 1 at rounding, unless the step did
/// not turn the body and kept a quaternion of another length.
///
/// The square of a scaled quaternion is off by the rounding of four products and of the factor,
/// each at most half a unit: 4 units, as in `tests/limits/extremes.rs`.
fn is_valid<R: Real>(state: &State<R>, start: &State<R>, number: u32) {
    assert!(
        state.not_finite().is_none(),
        "step {number}: {state:?}, from {start:?}"
    );
    let [x, y, z, w] = state.orientation.xyzw();
    let excess = (w - R::ONE) * (w + R::ONE) + x * x + (y * y + z * z);
    assert!(
        excess.abs() <= R::EPSILON * R::from_f64(4.0) || state.orientation == start.orientation,
        "step {number}: |q|² is off by {excess:e}, from {start:?}"
    );
}
