//! Time: a run ends at the requested time, samples are taken at the requested times, and
//! observation does not change the path.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used, clippy::panic)]
// The bits of times are compared, and small numbers of evaluations are counted.
#![allow(
    clippy::float_cmp,
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss
)]

use crate::kit;
use crate::kit::erased::Stepper;
use core::ops::ControlFlow;
use tumble::glam::DVec3;
use tumble::real::Vector;
use tumble::{
    AdaptiveEnergyMomentum, AdaptiveNystrom, BogackiShampine32, Cuboid, DormandPrince54,
    EnergyMomentum, Every, FlatGround, Flight, ForwardEuler, Integrator, Ledger, Nystrom, Observer,
    PointMass, Radau5, Real, RigidPointBody, Rk4, Sample, Sphere, State, StepError,
    StrangSplitting, SymplecticEuler, Timed, Trial, UniformGravity,
};

/// Requests two times in turn, and so for ever one that is past.
struct Undecided {
    asks_later: bool,
    seen: u32,
}

impl Observer for Undecided {
    fn observe(&mut self, _: &Sample<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
    fn requested_time(&self) -> Option<f64> {
        Some(if self.asks_later { 2e-3 } else { 1e-3 })
    }
    fn observe_requested(&mut self, _: &Sample<'_>) -> ControlFlow<()> {
        self.asks_later = !self.asks_later;
        self.seen += 1;
        ControlFlow::Continue(())
    }
}

#[test]
fn an_observer_that_goes_back_in_time_does_not_hold_a_run() {
    let stepper = trial().stepper(Rk4 { time_step: 5e-3 }).unwrap();
    let mut observer = Undecided {
        asks_later: false,
        seen: 0,
    };
    let mut state = trial().state();
    stepper.run(&mut state, 0.1, &mut observer).unwrap();
    // Both times are past from the second step on.
    assert_eq!(observer.seen, 2);
}

/// Requests these times, one after the other, and then none.
struct Requests {
    times: Vec<f64>,
    seen: Vec<(f64, DVec3)>,
}

impl Observer for Requests {
    fn observe(&mut self, _: &Sample<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
    fn requested_time(&self) -> Option<f64> {
        self.times.get(self.seen.len()).copied()
    }
    fn observe_requested(&mut self, sample: &Sample<'_>) -> ControlFlow<()> {
        self.seen.push((sample.time, sample.state.position));
        ControlFlow::Continue(())
    }
}

/// A time that is infinite or before the step has no state.
#[test]
fn a_requested_time_that_is_past_or_never_comes_is_not_sampled() {
    let cases: [(&[f64], usize); 5] = [
        (&[5e-3, f64::INFINITY, 0.03], 1),
        (&[5e-3, f64::MAX, 0.03], 1),
        (&[5e-3, f64::NAN, 0.03], 1),
        (&[0.022, 0.011, 0.03], 1),
        (&[-1.0, 0.03], 0),
    ];
    let fixed = trial().stepper(Rk4 { time_step: 0.01 }).unwrap();
    let adaptive = trial().stepper(DormandPrince54::new(1e-6)).unwrap();
    for (times, expected) in cases {
        let request = || Requests {
            times: times.to_vec(),
            seen: Vec::new(),
        };
        let (mut of_fixed, mut of_adaptive) = (request(), request());
        let (mut state, mut other) = (trial().state(), trial().state());
        fixed.run(&mut state, 0.05, &mut of_fixed).unwrap();
        adaptive.run(&mut other, 0.05, &mut of_adaptive).unwrap();
        for seen in [&of_fixed.seen, &of_adaptive.seen] {
            assert_eq!(seen.len(), expected, "{times:?}: {seen:?}");
        }
        for (time, place) in of_fixed.seen {
            let mut there = trial().state();
            fixed.advance(&mut there, time).unwrap();
            assert_eq!(place, there.position, "{time} s of {times:?}");
        }
    }
}

/// [`Every`] counts samples, also those between steps, and begins with the first of a run.
#[test]
fn every_passes_on_one_sample_in_n() {
    let stepper = trial().stepper(Rk4 { time_step: 1e-3 }).unwrap();
    let mut times = Vec::new();
    let note = |sample: &Sample<'_>| {
        times.push(sample.time);
        ControlFlow::Continue(())
    };
    let mut every = Timed::every(1.0 / 60.0, Every::steps(60, note).unwrap()).unwrap();
    let mut state = trial().state();
    for _ in 0..2 {
        stepper.run(&mut state, 2.1, &mut every).unwrap();
    }
    assert_eq!(times.len(), 6, "{times:?}");
    for (time, expected) in times.iter().zip([0.0, 1.0, 2.0, 0.0, 1.0, 2.0]) {
        assert!((time - expected).abs() < 1e-9, "{times:?}");
    }
}

fn trial() -> Trial {
    Trial {
        slip_speed: 1e-3,
        ..Trial::report(1).unwrap()
    }
}

/// Every state that an observer is shown, with its time.
fn watch(seen: &mut Vec<(f64, State)>) -> impl Observer {
    |sample: &Sample<'_>| {
        seen.push((sample.time, *sample.state));
        ControlFlow::Continue(())
    }
}

/// A sample agrees within `tolerance` (m) with a run to its time. The tolerance is 0 if the steps
/// of the method do not depend on the end.
fn nobodys_looking_changes_the_path<I: Integrator>(name: &str, tolerance: f64, integrator: I) {
    let stepper = trial().stepper(integrator).unwrap();
    let seconds = 0.211;
    let end = |observer: &mut dyn FnMut(&Sample<'_>) -> ControlFlow<()>| {
        let mut state = trial().state();
        stepper
            .run(&mut state, seconds, &mut |sample: &Sample<'_>| {
                observer(sample)
            })
            .unwrap();
        state
    };
    let mut steps = Vec::new();
    let alone = end(&mut |sample| {
        steps.push((sample.time, *sample.state));
        ControlFlow::Continue(())
    });
    assert_eq!(steps.last().unwrap().0, seconds, "{name}");
    for interval in [0.05, 0.01, 1.7e-3, 3e-4] {
        let (mut looks, mut seen, mut ledger) = (Vec::new(), Vec::new(), Ledger::new());
        let mut state = trial().state();
        let mut observers = (
            Timed::every(interval, watch(&mut looks)).unwrap(),
            (watch(&mut seen), &mut |sample: &Sample<'_>| {
                ledger.observe(sample)
            }),
        );
        stepper.run(&mut state, seconds, &mut observers).unwrap();
        drop(observers);
        assert_eq!(state, alone, "{name} looked at each {interval} s");
        assert_eq!(seen, steps, "{name} looked at each {interval} s");
        assert_eq!(looks.len(), (seconds / interval) as usize + 1, "{name}");
        for (k, (time, state)) in looks.iter().enumerate() {
            assert_eq!(*time, interval * k as f64);
            // Each tenth: a sample is the end of a run to its time.
            if k % 10 == 7 {
                let mut to_there = trial().state();
                stepper.advance(&mut to_there, *time).unwrap();
                let off = (state.position - to_there.position).length();
                assert!(off <= tolerance, "{name} at {time} s: {off:e}");
                assert!(tolerance > 0.0 || *state == to_there, "{name} at {time} s");
            }
        }
    }
}

/// A box of several observers, used as one observer.
#[test]
fn a_run_is_watched_by_an_observer_that_is_known_at_run_time_only() {
    let stepper = trial().stepper(Rk4 { time_step: 1e-3 }).unwrap();
    let counts = |watch: &mut dyn Observer| {
        let mut state = trial().state();
        stepper.run(&mut state, 0.01, watch).unwrap();
    };
    let mut ledger = Ledger::new();
    let mut times = 0;
    counts(&mut ledger);
    counts(&mut |_: &Sample<'_>| {
        times += 1;
        ControlFlow::Continue(())
    });
    assert_eq!(times, 11);
    assert!(ledger.work().friction < 0.0);
}

#[test]
fn nobodys_looking_changes_the_path_of_any_method() {
    kit::each_method!(1e-3, |integrator, name| {
        nobodys_looking_changes_the_path(name, 0.0, integrator);
    });
    nobodys_looking_changes_the_path("Bogacki and Shampine", 1e-5, BogackiShampine32::new(1e-5));
    nobodys_looking_changes_the_path("Dormand and Prince", 1e-5, DormandPrince54::new(1e-5));
    nobodys_looking_changes_the_path("AdaptiveNystrom", 1e-5, AdaptiveNystrom::new(1e-5));
    nobodys_looking_changes_the_path("Radau5", 1e-5, Radau5::new(1e-5));
    let implicit = AdaptiveEnergyMomentum::new(1e-3);
    nobodys_looking_changes_the_path("AdaptiveEnergyMomentum", 1e-3, implicit);
    nobodys_looking_changes_the_path("flight", 0.0, Flight(EnergyMomentum { time_step: 1e-3 }));
}

#[test]
fn a_run_ends_exactly_at_the_asked_time_with_steps_of_any_length() {
    fn ends<I: Integrator>(integrator: I) {
        let stepper = trial().stepper(integrator).unwrap();
        for seconds in [0.3, 1.0 / 60.0, 1e-7] {
            let mut last = 0.0;
            let time = stepper
                .run(&mut trial().state(), seconds, &mut |sample: &Sample<'_>| {
                    last = sample.time;
                    ControlFlow::Continue(())
                })
                .unwrap();
            assert!(
                (time - seconds).abs() <= 2.0 * f64::EPSILON * seconds,
                "{time}"
            );
            assert_eq!(last, time);
        }
    }
    kit::each_method!(7e-4, |integrator, _name| {
        ends(integrator);
    });
    ends(BogackiShampine32::new(1e-4));
    ends(DormandPrince54::new(1e-6));
}

#[test]
fn two_who_look_at_other_times_see_their_own() {
    let stepper = trial().stepper(DormandPrince54::new(1e-5)).unwrap();
    let (mut thirds, mut halves) = (Vec::new(), Vec::new());
    let mut both = (
        Timed::every(0.03, watch(&mut thirds)).unwrap(),
        Timed::every(0.02, watch(&mut halves)).unwrap(),
    );
    stepper.run(&mut trial().state(), 0.12, &mut both).unwrap();
    drop(both);
    assert_eq!(thirds.len(), 5);
    assert_eq!(halves.len(), 7);
    assert_eq!(thirds[2].1, halves[3].1);
}

#[test]
fn a_look_that_ends_the_run_leaves_the_state_after_its_step() {
    let stepper = trial().stepper(EnergyMomentum { time_step: 1e-3 }).unwrap();
    let mut looks = 0;
    let mut film = Timed::every(0.0104, |_: &Sample<'_>| {
        looks += 1;
        if looks > 1 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    })
    .unwrap();
    let mut state = trial().state();
    let time = stepper.run(&mut state, 1.0, &mut film).unwrap();
    assert!((time - 0.011).abs() < 1e-15, "{time}");
    let mut same = trial().state();
    stepper.advance(&mut same, 0.011).unwrap();
    assert_eq!(state, same);
}

/// The run ends after the step within which one observer of a pair has ended it. The other one
/// receives that state, with each method, so that a ledger hands on to the next run without a gap.
#[test]
fn a_look_that_ends_the_run_leaves_the_other_observer_at_the_end() {
    fn ends<I: Integrator>(name: &str, integrator: I) {
        let stepper = trial().stepper(integrator).unwrap();
        let mut state = trial().state();
        let mut books = (Ledger::new(), Ledger::new());
        for _ in 0..3 {
            let mut last = None;
            let partner = |sample: &Sample<'_>| {
                last = Some((sample.time, *sample.state));
                ControlFlow::Continue(())
            };
            let film = Timed::every(0.0137, |sample: &Sample<'_>| {
                if sample.time > 0.02 {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            });
            let mut all = ((film.unwrap(), partner), books);
            let time = stepper.run(&mut state, 1.0, &mut all).unwrap();
            books = all.1;
            assert!((0.0274..1.0).contains(&time), "{name}: {time}");
            assert_eq!(last, Some((time, state)), "{name}");
        }
        let (first, second) = books;
        for ledger in [first, second] {
            assert_eq!(
                ledger.now().total(),
                stepper.energy(&state).total(),
                "{name}"
            );
            assert_eq!(ledger.handed_in(), 0.0, "{name}");
        }
    }
    ends("EnergyMomentum", EnergyMomentum { time_step: 3e-3 });
    ends("Rk4", Rk4 { time_step: 1e-3 });
    ends("flight", Flight(Rk4 { time_step: 1e-3 }));
    ends("DormandPrince54", DormandPrince54::new(1e-5));
}

/// A free point in steps of one length: the time of the run, its steps, and their true sum.
fn run_of_steps<R: Real>(time_step: R, seconds: R) -> (R, u64, f64) {
    let stepper = Stepper::new(PointMass::new(R::ONE))
        .unwrap()
        .with_integrator(StrangSplitting { time_step })
        .unwrap();
    let (mut steps, mut whole, mut last) = (0, 0.0, R::ZERO);
    let mut state = State::<R>::default();
    // Every step but the last is a whole one.
    let time = stepper
        .run(&mut state, seconds, &mut |sample: &Sample<'_, R>| {
            (steps, whole) = (sample.step, last.to_f64());
            last = sample.time;
            ControlFlow::Continue(())
        })
        .unwrap();
    let last_step = time.to_f64() - whole;
    let sum = time_step.to_f64() * (steps.max(1) - 1) as f64 + last_step;
    (time, steps, sum)
}

/// Returns true if two positive numbers are equal or neighbours.
fn are_neighbours<R: Real>(a: R, b: R) -> bool {
    let apart = (a.to_f64() - b.to_f64()).abs();
    // A unit in the last place is less than `EPSILON` of the number, and half of that below a power
    // of 2.
    let middle = R::from_f64(0.5 * (a.to_f64() + b.to_f64()));
    apart <= b.to_f64() * R::EPSILON.to_f64() && (middle == a || middle == b)
}

/// Checks that the time of a run is the requested one, to one unit in the last place, in both
/// precisions, and that a whole number of steps is kept whole.
///
/// Durations and steps are drawn, as decimals that a person types and as arbitrary numbers, over
/// ranges that no constant was chosen on.
fn a_run_ends_at_any_time<R: Real>(draws: u32) {
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    let mut draw = |below: u64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) % below
    };
    for _ in 0..draws {
        let scale = 10.0_f64.powi(draw(7) as i32);
        let (units, count) = (1 + draw(9999), 1 + draw(300));
        let step = R::from_f64(units as f64 / scale);
        let seconds = R::from_f64((units * count) as f64 / scale);
        let (time, steps, _) = run_of_steps(step, seconds);
        assert_eq!(steps, count, "{seconds} s in steps of {step} s");
        assert!(are_neighbours(time, seconds), "{time} for {seconds} s");

        let seconds = R::from_f64(step.to_f64() * draw(1 << 30) as f64 / f64::from(1 << 23));
        let (time, _, _) = run_of_steps(step, seconds);
        assert!(
            are_neighbours(time, seconds),
            "{time} for {seconds} s in steps of {step} s"
        );
    }
}

#[test]
fn a_run_ends_at_any_time_to_one_unit_in_the_last_place() {
    a_run_ends_at_any_time::<f64>(3000);
    a_run_ends_at_any_time::<f32>(3000);
    // Rests that are no rounding are taken: 1e-12 and 1e-6 of a step beyond ten of them, or short
    // of them.
    for rest in [-1e-12, 1e-12] {
        let seconds = 0.01 * (1.0 + rest);
        let (time, steps, _) = run_of_steps(1e-3, seconds);
        assert_eq!((time, steps), (seconds, if rest > 0.0 { 11 } else { 10 }));
    }
    for rest in [-1e-6_f32, 1e-6] {
        let seconds = 0.01 * (1.0 + rest);
        let (time, steps, _) = run_of_steps(1e-3_f32, seconds);
        assert!(are_neighbours(time, seconds), "{time}");
        assert_eq!(steps, if rest > 0.0 { 11 } else { 10 });
    }
}

/// In `f32`, a unit in the last place of ten thousand seconds is a whole step of 1 ms. The sum of
/// the steps counts, not only the number that it is rounded to.
#[test]
fn ten_million_steps_in_single_precision_are_ten_million() {
    let (time, steps, sum) = run_of_steps(1e-3_f32, 1e4);
    assert_eq!((time, steps), (1e4, 10_000_000));
    // A unit in the last place of 1e4 in f32: 2⁻¹⁰.
    assert!((sum - 1e4).abs() <= 2.0_f64.powi(-10), "{sum}");
}

/// A sample at the end of a run is shown, although its time is another sum than the run's.
fn samples_come_to_the_end<R: Real>() {
    for count in 1..400_u32 {
        for seconds in [1.0, 0.3, 7.7, 1e-3, 123.4] {
            let interval = R::from_f64(seconds / f64::from(count));
            let stepper = Stepper::new(PointMass::new(R::ONE))
                .unwrap()
                .with_integrator(StrangSplitting {
                    time_step: R::from_f64(seconds * 0.37),
                })
                .unwrap();
            let mut times = Vec::new();
            let film = |sample: &Sample<'_, R>| {
                times.push(sample.time);
                // A velocity of 1 m/s says how far the state has come: to two units of the end's
                // time, and another rounding in each of the position's sums.
                let way = sample.state.position.x().to_f64();
                let off = (way - sample.time.to_f64()).abs();
                assert!(off <= 4.0 * R::EPSILON.to_f64() * seconds, "{off:e}");
                ControlFlow::Continue(())
            };
            let mut film = Timed::every(interval, film).unwrap();
            let start = State::<R>::default();
            let mut state = start.with_linear_velocity(Vector::new(R::ONE, R::ZERO, R::ZERO));
            let seconds = R::from_f64(seconds);
            stepper.run(&mut state, seconds, &mut film).unwrap();
            assert_eq!(
                times.len(),
                count as usize + 1,
                "{seconds} s by {interval} s"
            );
        }
    }
}

#[test]
fn samples_at_equal_intervals_come_to_the_end_of_a_run() {
    samples_come_to_the_end::<f64>();
    samples_come_to_the_end::<f32>();
}

/// States in which a step might take no time: at the event itself, above and below it by rounding,
/// penetrating, at the top of a path, during the rise, and without gravity.
fn starts<R: Real>() -> Vec<State<R>> {
    let at = |height: f64, speed: f64, spin: f64| {
        let vector = |x: f64, z: f64| R::Vec3::new(R::from_f64(x), R::ZERO, R::from_f64(z));
        State::<R> {
            position: vector(0.0, height),
            linear_velocity: vector(0.1, speed),
            angular_momentum: vector(spin, 0.0),
            ..State::default()
        }
    };
    let mut starts = Vec::new();
    for height in [
        0.0,
        0.1,
        0.1 + 1e-16,
        0.1 - 1e-16,
        0.1 + 1e-12,
        0.1 + 1e-7,
        0.05,
        0.14,
        1.0,
        1e3,
    ] {
        for (speed, spin) in [
            (0.0, 0.0),
            (-1.0, 0.0),
            (1.0, 0.0),
            (-1e-9, 1e-3),
            (0.0, 1e-3),
            (-30.0, 0.05),
        ] {
            starts.push(at(height, speed, spin));
        }
        starts.push(State {
            linear_velocity: R::Vec3::ZERO,
            ..at(height, 0.0, 0.0)
        });
    }
    starts
}

/// Checks that no step takes no time, and that none is longer than its limit. Limits range from one
/// that is 0 in `f32` to infinity.
fn every_step_takes_time<R: Real, I: Integrator<R> + Copy>(
    name: &str,
    body: &dyn RigidPointBody<R>,
    integrator: I,
) {
    let number = R::from_f64;
    for gravity in [0.0, 1e-3, 9.8] {
        let stepper = Stepper::new(body)
            .and_then(|it| it.with_ground(FlatGround::level(number(1e4), number(10.0))))
            .and_then(|it| it.with_gravity(UniformGravity::down(number(gravity))))
            .and_then(|it| it.with_integrator(integrator))
            .unwrap();
        for start in starts::<R>() {
            for limit in [
                1e-320,
                1e-40,
                1e-20,
                1e-12,
                1e-6,
                1e-3,
                1.0,
                1e3,
                f64::INFINITY,
            ] {
                // Without gravity, a body of three moments that rotates would fly for a million
                // parts of a revolution.
                if gravity == 0.0 && limit > 1.0 && start.angular_momentum != R::Vec3::ZERO {
                    continue;
                }
                let limit = number(limit);
                let step = stepper.session(start).step_within(limit);
                let step = step.unwrap_or_else(|error| panic!("{name}: {error}, {start:?}"));
                assert!(
                    limit == R::ZERO || (step.elapsed > R::ZERO && step.elapsed <= limit),
                    "{name}: {} s of {limit} s from {start:?}",
                    step.elapsed
                );
            }
            let time = stepper.run(&mut start.clone(), number(0.005), &mut ());
            assert!(time.is_ok(), "{name}: {time:?} from {start:?}");
        }
    }
}

/// Every method, alone and within closed-form flight.
fn every_method_takes_time<R: Real>(body: &dyn RigidPointBody<R>, tolerance: f64) {
    let (time_step, tolerance) = (R::from_f64(1e-4), R::from_f64(tolerance));
    macro_rules! check {
        ($($integrator:expr),*) => {$(
            every_step_takes_time(stringify!($integrator), body, $integrator);
            every_step_takes_time(stringify!(Flight($integrator)), body, Flight($integrator));
        )*};
    }
    check!(
        ForwardEuler { time_step },
        SymplecticEuler { time_step },
        StrangSplitting { time_step },
        Rk4 { time_step },
        Nystrom { time_step },
        EnergyMomentum { time_step },
        BogackiShampine32::new(tolerance),
        DormandPrince54::new(tolerance),
        AdaptiveNystrom::new(tolerance),
        AdaptiveEnergyMomentum::new(tolerance),
        Radau5::new(tolerance)
    );
}

/// All of these bodies are 0.1 m high above their centre of mass, or a point.
fn every_body_takes_time<R: Real>(tolerance: f64) {
    let number = R::from_f64;
    every_method_takes_time(&PointMass::new(number(1.0)), tolerance);
    every_method_takes_time(&Sphere::solid(number(1.0), number(0.1)), tolerance);
    let edges = Vector::new(number(0.3), number(0.25), number(0.2));
    every_method_takes_time(&Cuboid::solid(number(1.0), edges), tolerance);
}

#[test]
fn no_step_of_any_method_takes_no_time() {
    every_body_takes_time::<f64>(1e-6);
    every_body_takes_time::<f32>(1e-3);
}

/// Scenes that ended in `Stalled` once: a point that touches, and a weightless ball that is pressed
/// in.
#[test]
fn a_closed_form_flight_around_an_adaptive_method_goes_on_in_contact() {
    let ground = FlatGround::level(1e4, 10.0);
    let flight = Flight(DormandPrince54::new(1e-6));
    let point = Stepper::new(PointMass::new(1.0))
        .and_then(|it| it.with_gravity(UniformGravity::down(9.8)))
        .and_then(|it| it.with_ground(ground))
        .and_then(|it| it.with_integrator(flight))
        .unwrap();
    assert_eq!(point.advance(&mut State::at(DVec3::Z), 1.0), Ok(()));
    let ball = Stepper::new(Sphere::solid(1.0, 0.1))
        .and_then(|it| it.with_ground(ground))
        .and_then(|it| it.with_integrator(flight))
        .unwrap();
    let mut state = State::at(DVec3::Z * 0.05);
    assert_eq!(ball.advance(&mut state, 1.0), Ok(()));
    // It has left upwards.
    assert!(state.position.z > 0.1, "{state:?}");
}

/// The method that `Flight` wraps knows nothing of the flights: the run says when its step began.
#[test]
fn an_error_after_a_flight_names_the_time_of_the_run() {
    fn ends<I: Integrator>(name: &str, integrator: I) {
        let stepper = Stepper::builder(Cuboid::solid(0.02, DVec3::new(0.03, 0.02, 0.01)))
            .gravity(UniformGravity::down(9.8))
            .ground(FlatGround::level(1e4, 1.0))
            .integrator(Flight(integrator))
            .build()
            .unwrap();
        let start = State::at(DVec3::Z * 0.8).with_rotation_vector(DVec3::X * 0.4);
        let of = |error: StepError| match error {
            StepError::BudgetSpent { time, .. } | StepError::StepTooShort { time, .. } => time,
            error => panic!("{name}: {error}"),
        };
        // The fall alone takes 0.4 s, in a step that costs no attempt.
        let mut session = stepper.session(start);
        let time = of(session.advance(3.0).unwrap_err());
        assert!(time > 0.3 && time < 3.0, "{name}: {time}");
        assert_eq!(time, session.time(), "{name}");
        let of_run = stepper.advance(&mut start.clone(), 3.0).unwrap_err();
        assert_eq!(of(of_run), time, "{name}");
        let mut session = stepper.session(start);
        let of_events = session.run_with_events(3.0, [], |_| ControlFlow::Continue(()));
        assert_eq!(of(of_events.unwrap_err()), time, "{name}");
    }
    let mut method = DormandPrince54::new(1e-8);
    method.budget = 40;
    ends("DormandPrince54", method);
    let mut method = AdaptiveEnergyMomentum::new(1e-7);
    method.budget = 40;
    ends("AdaptiveEnergyMomentum", method);
}

/// The unit in the last place of the largest number was infinite, so that the run was over before
/// its first step.
#[test]
fn a_run_of_the_largest_number_of_seconds_is_not_over_at_once() {
    let adaptive = DormandPrince54 {
        budget: 10,
        ..DormandPrince54::new(1e-6)
    };
    let stepper = Stepper::new(PointMass::new(1.0))
        .and_then(|it| it.with_integrator(adaptive))
        .unwrap();
    let outcome = stepper.advance(&mut State::at(DVec3::Z), f64::MAX);
    assert!(
        matches!(outcome, Err(StepError::BudgetSpent { .. })),
        "{outcome:?}"
    );
}
