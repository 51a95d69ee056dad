//! Any sequence of calls of a session: it has the bits of a session that is saved and resumed
//! between the calls, and a run ends at its time.

use core::ops::ControlFlow;

use serde::Serialize;
use serde::de::DeserializeOwned;
use tumble::real::Vector;
use tumble::{
    Apex, Event, EventEnd, Every, Integrator, Landing, Ledger, LiftOff, Observer, Real, Sample,
    SavedSession, Session, State, StepControl, Timed, UniformGravity, UntilRest,
};

use super::input::Input;
use super::parts::{AnyStepper, Meter, Method, Parts, numbers, state};

type AnySession<'a, R> = Session<
    'a,
    &'a dyn tumble::RigidPointBody<R>,
    &'a Meter<R>,
    &'a dyn tumble::SlidingFriction<R>,
    UniformGravity<R>,
    Method<R>,
    R,
    &'a dyn tumble::Force<R>,
>;

/// Calls of an input.
const CALLS: u32 = 12;

/// Plays an input.
pub fn run(data: &[u8]) {
    let mut input = Input::new(data);
    if input.flag() {
        play::<f32>(&mut input);
    } else {
        play::<f64>(&mut input);
    }
}

fn play<R>(input: &mut Input<'_>)
where
    R: Real + Serialize + DeserializeOwned,
    State<R>: Serialize + DeserializeOwned,
    StepControl<R>: Serialize + DeserializeOwned,
{
    let Ok(parts) = Parts::<R>::read(input) else {
        return;
    };
    let Ok(stepper) = parts.stepper() else {
        return;
    };
    let start = state::<R>(input);
    let mut session = stepper.session(start);
    let mut resumed = stepper.session(start);
    for _ in 0..CALLS {
        if input.is_empty() {
            break;
        }
        let is_saved = input.flag();
        if is_saved && !resume(&stepper, &mut resumed) {
            break;
        }
        let call = Call::read(input, &stepper, parts.is_extended);
        let (ours, theirs) = (call.apply(&mut session), call.apply(&mut resumed));
        assert_eq!(ours, theirs, "{call:?}");
        same(&session, &resumed, &call);
        if ours.is_err() {
            break;
        }
    }
}

/// Saves the session as text and continues from it. Returns false if its text has no numbers.
fn resume<'a, R>(stepper: &'a AnyStepper<'a, R>, session: &mut AnySession<'a, R>) -> bool
where
    R: Real + Serialize + DeserializeOwned,
    State<R>: Serialize + DeserializeOwned,
    StepControl<R>: Serialize + DeserializeOwned,
{
    let saved = session.save();
    // JSON has no infinity and no NaN.
    if saved.state().not_finite().is_some() {
        return false;
    }
    let text = serde_json::to_string(&saved).unwrap();
    let loaded: SavedSession<R> = serde_json::from_str(&text).unwrap();
    assert_eq!(loaded, saved, "{text}");
    *session = stepper.resume(&loaded).unwrap();
    true
}

/// Both sessions have the same bits.
fn same<R: Real>(a: &AnySession<'_, R>, b: &AnySession<'_, R>, call: &Call<R>) {
    let is_finite = a.state().not_finite().is_none();
    assert!(
        !is_finite || numbers(a.state()) == numbers(b.state()),
        "{call:?}: {:?}, {:?}",
        a.state(),
        b.state()
    );
    let times = [a.time(), b.time()].map(|time| time.to_f64().to_bits());
    assert_eq!(times[0], times[1], "{call:?}");
    assert_eq!(a.step_count(), b.step_count(), "{call:?}");
}

/// A call of a session.
#[derive(Clone, Copy, Debug)]
enum Call<R: Real> {
    Step,
    Steps(u8),
    Advance(R),
    Samples(R, u8),
    Run(R, u8, R),
    Impulse(R::Vec3, R::Vec3),
    Set(State<R>),
    /// Longest time, number of events after which the run ends, and height of one event.
    Events(R, u8, R),
}

impl<R: Real> Call<R> {
    fn read(input: &mut Input<'_>, stepper: &AnyStepper<'_, R>, is_extended: bool) -> Self {
        match input.below(if is_extended { 10 } else { 8 }) {
            0 => Self::Step,
            1 => Self::Steps(input.below(8)),
            2 | 3 => Self::Advance(duration(input, stepper)),
            4 => Self::Samples(duration(input, stepper), input.below(4)),
            5 => {
                let (seconds, kind) = (duration(input, stepper), input.below(6));
                // A hundred samples, or an interval that is refused.
                let interval = if input.flag() {
                    seconds / R::from_usize(usize::from(input.byte() / 2) + 1)
                } else {
                    let any: R = input.signed(1e-3, 1.0);
                    any.at_least(seconds * R::from_f64(1e-2))
                };
                Self::Run(seconds, kind, interval)
            }
            6 => Self::Impulse(input.vector::<R>(1e-3, 1.0), input.vector::<R>(1e-3, 1.0)),
            7 => Self::Set(state(input)),
            _ => Self::Events(
                duration(input, stepper),
                input.byte(),
                input.signed(1e-3, 1.0),
            ),
        }
    }

    /// Time or number of samples that the call returned, or the text of its error.
    fn apply(&self, session: &mut AnySession<'_, R>) -> Result<u64, String> {
        match *self {
            Self::Step => {
                let step = session.step().map_err(text)?;
                Ok(step.elapsed.to_f64().to_bits())
            }
            Self::Steps(count) => {
                let mut taken = 0;
                for moment in session.steps().take(count.into()) {
                    moment.map_err(text)?;
                    taken += 1;
                }
                Ok(taken)
            }
            Self::Advance(seconds) => {
                ends_in_time(session, seconds);
                session.advance(seconds).map_err(text)?;
                Ok(0)
            }
            Self::Samples(interval, count) => {
                let mut taken = 0;
                let samples = session.samples(interval).map_err(text)?;
                for moment in samples.take(count.into()) {
                    moment.map_err(text)?;
                    taken += 1;
                }
                Ok(taken)
            }
            Self::Run(seconds, kind, interval) => observed(session, seconds, kind, interval),
            Self::Impulse(impulse, point) => {
                session.apply_impulse(impulse, point).map_err(text)?;
                Ok(0)
            }
            Self::Set(state) => {
                session.set_state(state);
                Ok(0)
            }
            Self::Events(seconds, most, height) => events(session, seconds, most, height),
        }
    }
}

fn text(error: impl core::fmt::Display) -> String {
    error.to_string()
}

/// Up to 32 steps of a fixed size, or any time for a method with a budget. Some are below 0.
fn duration<R: Real>(input: &mut Input<'_>, stepper: &AnyStepper<'_, R>) -> R {
    let own = stepper.integrator().fixed_step();
    match own {
        // The size may be any number, also below 0: a run of that many seconds would take hours.
        _ if input.byte() >= 248 => -input.size::<R>(1e-3, 1.0).abs(),
        Some(own) => own * R::from_f64(f64::from(input.byte()) / 8.0),
        None => input.size(1e-4, 1.0),
    }
}

/// A run of the state ends at its time to one unit in the last place, and an advance of a fixed
/// step has the bits of the stepper's.
fn ends_in_time<R: Real>(session: &AnySession<'_, R>, seconds: R) {
    let stepper = session.stepper();
    let mut state = *session.state();
    let Ok(time) = stepper.run(&mut state, seconds, &mut ()) else {
        return;
    };
    let unit = seconds * R::EPSILON;
    assert!(
        (time - seconds).abs() <= unit.at_least(R::from_f64(5e-324)),
        "a run of {seconds:e} s takes {time:e} s"
    );
    let mut advanced = session.clone();
    let is_fixed = stepper.integrator().fixed_step().is_some();
    if is_fixed && advanced.advance(seconds).is_ok() {
        assert_eq!(
            numbers(advanced.state()),
            numbers(&state),
            "an advance by {seconds:e} s"
        );
    }
}

/// A run with an observer, which leaves the path as it is unless it ends the run.
fn observed<R: Real>(
    session: &mut AnySession<'_, R>,
    seconds: R,
    kind: u8,
    interval: R,
) -> Result<u64, String> {
    let mut count = 0_u32;
    let mut counter = |sample: &Sample<'_, R>| {
        count += 1;
        let _ = (sample.energy(), sample.lowest_point(), sample.touching());
        if count < 1000 {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    };
    let body = *session.stepper().body();
    let mut watch: Box<dyn Observer<R> + '_> = match kind {
        0 => Box::new(Ledger::<R>::new()),
        1 => Box::new(Timed::every(interval, counter).map_err(text)?),
        2 => Box::new(UntilRest::new(body, interval, interval).map_err(text)?),
        3 => Box::new(Every::steps(3, counter).map_err(text)?),
        4 => {
            let timed = Timed::every(interval, &mut counter).map_err(text)?;
            Box::new((Ledger::<R>::new(), timed))
        }
        _ => Box::new(counter),
    };
    let time = session.run(seconds, &mut *watch).map_err(text)?;
    Ok(time.to_f64().to_bits())
}

/// A run with events, which come in the order of time. If none of them ends the run, it has the
/// bits of an advance. Returns a hash of the occurrences and of the end.
fn events<R: Real>(
    session: &mut AnySession<'_, R>,
    seconds: R,
    most: u8,
    height: R,
) -> Result<u64, String> {
    let mut plain = session.clone();
    let start = session.time();
    let (mut count, mut hash, mut last) = (0_u64, 0_u64, start);
    let passes = |sample: &Sample<'_, R>| sample.state.position.z() - height;
    let watched: [&dyn Event<R>; 4] = [&Landing, &LiftOff, &Apex, &passes];
    let end = session.run_with_events(seconds, watched, |occurrence| {
        let time = occurrence.time;
        assert!(
            time >= last,
            "an event at {time:e} s comes after {last:e} s"
        );
        last = time;
        count += 1;
        let words = numbers(&occurrence.state);
        for word in [time.to_f64().to_bits(), occurrence.event as u64]
            .iter()
            .chain(&words)
        {
            hash = (hash ^ word).wrapping_mul(0x0100_0000_01b3).rotate_left(7);
        }
        if count > u64::from(most) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    let end = end.map_err(text)?;
    if matches!(end, EventEnd::TimeCovered) && plain.advance(seconds).is_ok() {
        assert_eq!(
            numbers(session.state()),
            numbers(plain.state()),
            "a run with events"
        );
    }
    Ok(hash)
}
