//! Events: touch-downs, apexes, slips and a user's own functions, against closed forms, with every
//! integrator.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used, clippy::panic)]
// Bits of states and times are compared.
#![allow(clippy::float_cmp, clippy::cast_precision_loss)]

use core::f64::consts::PI;
use core::ops::ControlFlow;

use crate::common::methods::convergence;
use crate::kit;
use crate::kit::erased::Stepper;
use crate::kit::once::Once;
use tumble::glam::{DVec3, Vec3};
use tumble::real::Vector;
use tumble::{
    AdaptiveEnergyMomentum, AdaptiveNystrom, AnyIntegrator, Apex, BogackiShampine32, Coin,
    ContactCloses, ContactOpens, Coulomb, DormandPrince54, EnergyMomentum, Event, EventDirection,
    EventEnd, FlatGround, Flight, ForwardEuler, Integrator, Landing, LiftOff, Nystrom, Occurrence,
    PointCloud, PointMass, Radau5, Real, Rk4, Sample, SceneError, SlipEnds, Sphere, State,
    StepError, StrangSplitting, SymplecticEuler, Trial, UniformGravity,
};

const GRAVITY: f64 = 9.8;
const MASS: f64 = 0.1;

fn ball<I: Integrator>(ground: FlatGround, integrator: I) -> Stepper<'static, I> {
    Stepper::builder(PointMass::new(MASS))
        .gravity(UniformGravity::down(GRAVITY))
        .ground(ground)
        .integrator(integrator)
        .build()
        .unwrap()
}

/// A body at rest under a method that spans flights: the run is refused as that of `advance` is.
#[test]
fn a_run_with_events_of_a_body_at_rest_is_refused_if_it_would_not_end() {
    let method = Flight(EnergyMomentum { time_step: 1e-3 });
    let stepper = ball(FlatGround::level(100.0, 10.0), method);
    let mut session = stepper.session(State::at(DVec3::Z * -0.009));
    session.advance(20.0).unwrap();
    let before = *session.state();
    session.step().unwrap();
    assert_eq!(*session.state(), before, "it rests");
    let error = (session.run_with_events(1e20, [&Landing], |_| ControlFlow::Continue(()))).err();
    assert!(
        matches!(error, Some(StepError::TooManySteps { .. })),
        "{error:?}"
    );
    assert_eq!(session.advance(1e20).err(), error);
}

/// All occurrences of a run from `start`, and how it ended.
fn all<I: Integrator, const N: usize>(
    stepper: &Stepper<I>,
    start: State,
    seconds: f64,
    events: [&dyn Event; N],
) -> (Vec<Occurrence>, EventEnd) {
    let mut found = Vec::new();
    let mut session = stepper.session(start);
    let end = session
        .run_with_events(seconds, events, |occurrence| {
            found.push(*occurrence);
            ControlFlow::Continue(())
        })
        .unwrap();
    (found, end)
}

/// Runs a block with each integrator that moves a ball in flight on a parabola to rounding.
macro_rules! each_exact_in_flight {
    ($time_step:expr, |$integrator:ident, $name:ident| $block:block) => {{
        let time_step = $time_step;
        let methods: [AnyIntegrator; 9] = [
            StrangSplitting { time_step }.into(),
            Rk4 { time_step }.into(),
            Nystrom { time_step }.into(),
            EnergyMomentum { time_step }.into(),
            DormandPrince54::new(1e-9).into(),
            BogackiShampine32::new(1e-7).into(),
            AdaptiveNystrom::new(1e-7).into(),
            Radau5::new(1e-7).into(),
            AdaptiveEnergyMomentum::new(1e-5).into(),
        ];
        for $integrator in methods {
            let $name = $integrator.to_string();
            $block
        }
        for $integrator in [methods[3], methods[4]].map(Flight) {
            let $name = format!("flight by {}", $integrator.0);
            $block
        }
    }};
}

/// A throw of 4.9 m/s from 1 m: the top after half a second, the landing by `1 + 4.9 t = 4.9 t²`.
/// Rounding is 2.2e-16 of a metre in each of 1500 steps, over a speed of some metres a second.
#[test]
fn a_throw_is_located_to_1e_12_s_in_flight() {
    let landing = 0.5 + (0.25_f64 + 1.0 / 4.9).sqrt();
    each_exact_in_flight!(1e-3, |integrator, name| {
        let stepper = ball(FlatGround::level(1e4, 0.0), integrator);
        let start = State::at(DVec3::Z).with_linear_velocity(DVec3::Z * 4.9);
        let (found, _) = all(&stepper, start, 1.2, [&Landing, &Apex]);
        let [apex, down] = found[..] else {
            panic!("{name}: {found:?}");
        };
        assert_eq!([apex.event, down.event], [1, 0], "{name}");
        assert!(
            (apex.time - 0.5).abs() < 1e-12,
            "{name}: {}",
            apex.time - 0.5
        );
        let height = 1.0 + 4.9 * 0.25;
        assert!((apex.state.position.z - height).abs() < 1e-12, "{name}");
        let off = down.time - landing;
        assert!(off.abs() < 1e-12, "{name}: {off:e}");
        let gap = down.state.position.z;
        assert!(gap < 0.0 && gap > -1e-15, "{name}: {gap:e}");
    });
}

/// A body falls from the height `h` to the ground in `√(2h/g)`. This holds for each flight,
/// whatever happened in the contact before it.
#[test]
fn each_fall_of_a_bouncing_ball_is_a_parabola_to_1e_12_s() {
    each_exact_in_flight!(1e-3, |integrator, name| {
        let stepper = ball(FlatGround::level(1e4, 3.0), integrator);
        let (found, _) = all(&stepper, State::at(DVec3::Z), 3.0, [&Apex, &Landing]);
        let falls = found.chunks_exact(2);
        assert!(falls.len() >= 4, "{name}: {}", falls.len());
        for fall in falls {
            let [apex, down] = fall else {
                panic!("two events")
            };
            assert_eq!([apex.event, down.event], [0, 1], "{name}");
            let height = apex.state.position.z;
            let off = down.time - apex.time - (2.0 * height / GRAVITY).sqrt();
            assert!(off.abs() < 1e-12, "{name}: {off:e} s");
        }
    });
}

/// Touch-downs of a ball on spring and damper, in closed form.
struct Bounces {
    /// Restitution and duration (s) of a contact whose weight is negligible.
    restitution: f64,
    contact: f64,
    /// Speed (m/s) and time (s) of the first touch-down.
    speed: f64,
    first: f64,
}

impl Bounces {
    /// A drop from 1 m. The ratio of damping is `ζ`, the frequency `ω` (rad/s).
    ///
    /// In contact `z = -v/w e^(-ζωt) sin(w t)` with `w = ω √(1 - ζ²)`. The force `-k z - c z'` ends
    /// at `w t = π - 2 asin(ζ)`, and the ball leaves the ground from below its surface at the speed
    /// `v e^(-ζωt)`.
    fn new(ratio: f64, frequency: f64) -> Self {
        let slowed = frequency * (1.0 - ratio * ratio).sqrt();
        let contact = (core::f64::consts::PI - 2.0 * ratio.asin()) / slowed;
        let speed = (2.0 * GRAVITY).sqrt();
        Self {
            restitution: (-ratio * frequency * contact).exp(),
            contact,
            speed,
            first: speed / GRAVITY,
        }
    }

    /// Time of the n-th touch-down (from 1), s, and a bound of its error by the weight in contact.
    ///
    /// It is the geometric series `t = v/g (1 + 2 e + 2 e² + …)` with the contacts. Weight changes
    /// the speed in each contact by less than `2 g` times its duration, and so each later flight by
    /// less than four durations. The way out of the ground takes less than another duration.
    fn touch_down(&self, number: u32) -> (f64, f64) {
        let flights = (1..number).map(|n| {
            let power = f64::from(n);
            2.0 * self.speed * self.restitution.powf(power) / GRAVITY + self.contact
        });
        let bounces = f64::from(number - 1);
        (
            self.first + flights.sum::<f64>(),
            5.0 * self.contact * bounces * bounces,
        )
    }
}

/// On a ground of 3e5 rad/s a contact takes 1e-5 s, so the bound is below 1 ms after 10 bounces
/// that take 2 s. A bounce that is missed or found twice shifts the series by tenths of a second.
#[test]
fn the_nth_touch_down_is_that_of_the_geometric_series() {
    let (ratio, frequency) = (0.1, 3e5);
    let ground = FlatGround::level(MASS * frequency * frequency, 2.0 * MASS * ratio * frequency);
    let series = Bounces::new(ratio, frequency);
    let check = |name: &str, found: &[Occurrence]| {
        let of = |event: usize| found.iter().filter(move |one| one.event == event);
        // The first top is the start, from which the ball falls.
        assert_eq!([of(0).count(), of(1).count()], [10, 10], "{name}");
        for (top, number) in of(1).zip(0..) {
            let height = series.restitution.powi(2 * number);
            // Each flight is shorter or longer by the bound, at a speed of less than 4.5 m/s.
            let bound = 4.5 * series.touch_down(10).1 + 1e-15;
            let off = top.state.position.z - height;
            assert!(off.abs() <= bound, "{name}, top {number}: {off:e} m");
        }
        for (landing, number) in of(0).zip(1..) {
            let (time, bound) = series.touch_down(number);
            assert_eq!(landing.count, u64::from(number), "{name}");
            let off = landing.time - time;
            assert!(
                off.abs() <= bound + 1e-12,
                "{name}, bounce {number}: {off:e} s"
            );
        }
    };
    let (last, bound) = series.touch_down(10);
    let seconds = last + bound;
    let fixed = Flight(Rk4 { time_step: 2e-9 });
    let (found, _) = all(
        &ball(ground, fixed),
        State::at(DVec3::Z),
        seconds,
        [&Landing, &Apex],
    );
    check("Rk4", &found);
    let fixed = Flight(EnergyMomentum { time_step: 2e-9 });
    let (found, _) = all(
        &ball(ground, fixed),
        State::at(DVec3::Z),
        seconds,
        [&Landing, &Apex],
    );
    check("EnergyMomentum", &found);
    let chosen = Flight(DormandPrince54::new(1e-9));
    let (found, _) = all(
        &ball(ground, chosen),
        State::at(DVec3::Z),
        seconds,
        [&Landing, &Apex],
    );
    check("DormandPrince54", &found);
}

/// A ball that stays in contact oscillates about its rest as `z = z₀ + a cos(ω t)`: the height
/// falls through `z₀` at `ω t = π/2`, `5π/2` and so on, and the velocity rises through 0 at `π`,
/// `3π`. The error of the time has the order of the method, which an event must not lower.
#[test]
fn an_event_in_contact_has_the_order_of_the_method() {
    fn errors<I: Integrator>(steps: [f64; 3], method: impl Fn(f64) -> I) -> [Vec<(f64, f64)>; 2] {
        let frequency = 20.0;
        let stiffness = MASS * frequency * frequency;
        let rest = -MASS * GRAVITY / stiffness;
        let start = State::at(DVec3::Z * (rest * 0.6));
        let middle = |sample: &Sample<'_>| sample.state.position.z - rest;
        let mut both = [Vec::new(), Vec::new()];
        for step in steps {
            let stepper = ball(FlatGround::level(stiffness, 0.0), method(step));
            let events: [&dyn Event; 2] = [&middle.falling(), &Apex.rising()];
            let (found, _) = all(&stepper, start, 0.6, events);
            // Two periods of 0.31 s.
            assert_eq!(found.len(), 4);
            let last = |event: usize| found.iter().rfind(|one| one.event == event).unwrap();
            let truth = [2.5, 3.0].map(|turn| turn * core::f64::consts::PI / frequency);
            for event in [0, 1] {
                let off: f64 = last(event).time - truth[event];
                both[event].push((step, off.abs()));
            }
        }
        both
    }
    let steps = [4e-3, 2e-3, 1e-3];
    let check = |name: &str, order: f64, [by_height, by_speed]: [Vec<(f64, f64)>; 2]| {
        for errors in [by_height, by_speed] {
            let found = convergence(&errors);
            assert!(found > order - 0.25, "{name}: {found} {errors:?}");
        }
    };
    check(
        "ForwardEuler",
        1.0,
        errors(steps, |time_step| ForwardEuler { time_step }),
    );
    check(
        "SymplecticEuler",
        1.0,
        errors(steps, |time_step| SymplecticEuler { time_step }),
    );
    check(
        "StrangSplitting",
        2.0,
        errors(steps, |time_step| StrangSplitting { time_step }),
    );
    check(
        "EnergyMomentum",
        2.0,
        errors(steps, |time_step| EnergyMomentum { time_step }),
    );
    check("Rk4", 4.0, errors(steps, |time_step| Rk4 { time_step }));
    check(
        "Nystrom",
        4.0,
        errors(steps, |time_step| Nystrom { time_step }),
    );
    let tolerances = [1e-6, 1e-8, 1e-10];
    // The error of the time follows the tolerance, so its order in the tolerance is about 1.
    check(
        "DormandPrince54",
        1.0,
        errors(tolerances, DormandPrince54::new),
    );
}

/// A dumbbell of two points at `±r` rotates at `ω` with its centre at the height `h`. A point is
/// below ground while its angle from the vertical is below `acos(h/r)`. The springs are too soft to
/// matter: 1e-12 N/m. A step covers the whole dip.
#[test]
fn a_grazing_touch_is_found_within_a_step_and_a_miss_is_not() {
    fn grazes<I: Integrator>(name: &str, integrator: I) {
        let (radius, spin) = (0.1, 1.0);
        let stepper = Stepper::builder(
            PointCloud::new([DVec3::X * radius, -DVec3::X * radius], [1.0; 2]).unwrap(),
        )
        .ground(FlatGround::level(1e-12, 0.0))
        .integrator(integrator)
        .build()
        .unwrap();
        for depth in [1e-4, 1e-6, 1e-9, -1e-9, -1e-6] {
            let state = State::at(DVec3::Z * (radius - depth));
            let state = stepper.with_angular_velocity(state, DVec3::Y * spin);
            let mut session = stepper.session(state);
            let mut found = Vec::new();
            let end = session.run_with_events(3.0, [&Landing, &LiftOff], |event| {
                found.push((event.event, event.time));
                ControlFlow::Continue(())
            });
            assert_eq!(end, Ok(EventEnd::TimeCovered), "{name} {depth:e}");
            if depth < 0.0 {
                assert_eq!(found, [], "{name} {depth:e}");
                continue;
            }
            let half = (1.0 - depth / radius).acos();
            let lowest = core::f64::consts::FRAC_PI_2;
            let [(0, down), (1, up)] = found[..] else {
                panic!("{name} {depth:e}: {found:?}")
            };
            // The height near its minimum is rounded to 1e-16 m, and has a slope of r ω sin(half).
            let rounding = 1e-15 / (radius * spin * half.sin());
            let off = [down - (lowest - half) / spin, up - (lowest + half) / spin];
            assert!(off[0].abs() < rounding + 1e-12, "{name} {depth:e}: {off:?}");
            assert!(off[1].abs() < rounding + 1e-12, "{name} {depth:e}: {off:?}");
        }
    }
    // Steps in which the rotation of a body with two equal moments is exact.
    let time_step = 0.11;
    grazes("SymplecticEuler", SymplecticEuler { time_step });
    grazes("StrangSplitting", StrangSplitting { time_step });
}

/// A height that a throw passes twice within one step, 1e-9 m below the top.
#[test]
fn a_pair_of_events_around_the_top_lies_in_one_step() {
    each_exact_in_flight!(0.09, |integrator, name| {
        let stepper = ball(FlatGround::level(1e4, 0.0), integrator);
        let start = State::at(DVec3::Z).with_linear_velocity(DVec3::Z * 4.9);
        let top = 1.0 + 4.9 * 0.25;
        let near = |sample: &Sample<'_>| sample.state.position.z - (top - 1e-9);
        let above = |sample: &Sample<'_>| sample.state.position.z - (top + 1e-9);
        let (found, _) = all(&stepper, start, 0.8, [&near, &Apex, &above]);
        let events: Vec<_> = found.iter().map(|one| (one.event, one.direction)).collect();
        let (rising, falling) = (EventDirection::Rising, EventDirection::Falling);
        assert_eq!(events, [(0, rising), (1, falling), (0, falling)], "{name}");
        // Heights are rounded to 2e-16 m, at a speed of 1.4e-4 m/s.
        let half = (2e-9 / GRAVITY).sqrt();
        for (one, time) in found.iter().zip([0.5 - half, 0.5, 0.5 + half]) {
            assert!(
                (one.time - time).abs() < 1e-10,
                "{name}: {}",
                one.time - time
            );
        }
    });
}

/// Heights that a fall passes in one step come in the order of time, whatever the order of the
/// events. Two equal events occur both.
#[test]
fn events_of_one_step_come_in_the_order_of_time() {
    each_exact_in_flight!(0.25, |integrator, name| {
        let stepper = ball(FlatGround::level(1e4, 0.0), integrator);
        let at = |height: f64| move |sample: &Sample<'_>| sample.state.position.z - height;
        let (low, high) = (at(9.0), at(9.9));
        let events: [&dyn Event; 4] = [&low, &high, &low, &Landing];
        let (found, end) = all(&stepper, State::at(DVec3::Z * 10.0), 0.5, events);
        assert_eq!(end, EventEnd::TimeCovered, "{name}");
        let order: Vec<_> = found.iter().map(|one| one.event).collect();
        assert_eq!(order, [1, 0, 2], "{name}");
        let times = [0.1, 1.0, 1.0].map(|fall: f64| (2.0 * fall / GRAVITY).sqrt());
        for (one, time) in found.iter().zip(times) {
            assert!((one.time - time).abs() < 1e-12, "{name}");
        }
        assert_eq!(found[1].time, found[2].time, "{name}");
    });
}

/// A ball at height 0 lands at the time 0 if it falls, and leaves the ground at the time 0 if it
/// rises. A value that stays at 0 is no event.
#[test]
fn an_event_at_the_very_start_is_found_once() {
    each_exact_in_flight!(1e-3, |integrator, name| {
        let stepper = ball(FlatGround::level(1e4, 0.0), integrator);
        for (speed, event) in [(-1.0, 0), (1.0, 1)] {
            let start = State::at(DVec3::ZERO).with_linear_velocity(DVec3::Z * speed);
            let (found, _) = all(&stepper, start, 0.005, [&Landing, &LiftOff]);
            assert_eq!(found.len(), 1, "{name}: {found:?}");
            assert_eq!(found[0].event, event, "{name}");
            assert!(found[0].time < 1e-15, "{name}: {:e}", found[0].time);
        }
        let nothing = |_: &Sample<'_>| 0.0;
        let (found, _) = all(&stepper, State::at(DVec3::Z), 0.1, [&nothing]);
        assert_eq!(found, [], "{name}");
    });
}

/// A throw from the height at which the event is 0 returns there after `2v/g`, within its first
/// step too. The acceleration bends the path by the same way in each method.
#[test]
fn an_event_at_the_very_start_and_one_later_in_the_first_step_are_both_found() {
    for time_step in [0.9, 0.65, 0.4, 1e-3] {
        each_exact_in_flight!(time_step, |integrator, name| {
            let stepper = ball(FlatGround::level(1e4, 0.0), integrator);
            let height = |sample: &Sample<'_>| sample.state.position.z - 50.0;
            for (speed, expected) in [(3.0, 2), (-3.0, 1)] {
                let start = State::at(DVec3::Z * 50.0).with_linear_velocity(DVec3::Z * speed);
                let (found, _) = all(&stepper, start, 0.9, [&height]);
                assert_eq!(found.len(), expected, "{name}, {speed} m/s: {found:?}");
                assert!(found[0].time < 1e-14, "{name}: {:e}", found[0].time);
                let rises = found[0].direction == EventDirection::Rising;
                assert_eq!(rises, speed > 0.0, "{name}");
                if let Some(back) = found.get(1) {
                    let off = back.time - 2.0 * speed / GRAVITY;
                    assert!(off.abs() < 1e-11, "{name}: {off:e}");
                    assert_eq!(back.direction, EventDirection::Falling, "{name}");
                }
            }
        });
    }
}

/// An axis of a body that spins about a fixed one has the cosine of the angle as its component: an
/// extremum at the start of the step, or at its end, and two changes of the sign in between.
#[test]
fn a_pair_of_events_behind_an_extremum_at_an_end_of_the_step_is_found() {
    let spin = 5.0; // rad/s
    let axis = |sample: &Sample<'_>| (sample.state.orientation * DVec3::X).x;
    let stepper = Stepper::builder(Coin::ring(1.0, 0.5))
        .integrator(Flight(EnergyMomentum { time_step: 1e-3 }))
        .build()
        .unwrap();
    for (ahead, seconds) in [
        (0.0, 1.1),
        (0.4, (2.0 * PI - 0.4) / spin),
        (0.0, 2.0 * PI / spin),
    ] {
        let start = State::at(DVec3::Z).with_rotation_vector(DVec3::Z * ahead);
        let start = stepper.with_angular_velocity(start, DVec3::Z * spin);
        let (found, _) = all(&stepper, start, seconds, [&axis]);
        assert_eq!(found.len(), 2, "{ahead} rad: {found:?}");
        for (occurrence, angle) in found.iter().zip([0.5 * PI, 1.5 * PI]) {
            let off = occurrence.time - (angle - ahead) / spin;
            assert!(off.abs() < 1e-12, "{ahead} rad: {off:e}");
        }
    }
}

/// A run that ends at each event and continues finds the events of one run, and none twice.
#[test]
fn a_run_that_ends_at_an_event_continues_behind_it() {
    each_exact_in_flight!(1e-3, |integrator, name| {
        let stepper = ball(FlatGround::level(1e4, 0.0), integrator);
        let start = State::at(DVec3::Z);
        let (found, _) = all(&stepper, start, 1.3, [&Apex, &Landing]);
        let mut session = stepper.session(start);
        let mut times = Vec::new();
        loop {
            let left = 1.3 - session.time();
            match session.run_until_event(left, [&Apex, &Landing]).unwrap() {
                EventEnd::Event(one) => {
                    assert_eq!(one.time, session.time(), "{name}");
                    assert_eq!(one.state, *session.state(), "{name}");
                    times.push((one.event, one.time));
                }
                end => {
                    assert_eq!(end, EventEnd::TimeCovered, "{name}");
                    break;
                }
            }
        }
        // The steps lie elsewhere after an end, so the contact differs by the error of the method.
        assert_eq!(times.len(), found.len(), "{name}: {times:?} {found:?}");
        for (time, one) in times.iter().zip(&found) {
            assert_eq!(time.0, one.event, "{name}");
            assert!((time.1 - one.time).abs() < 2e-3, "{name}: {times:?}");
        }
        assert!((session.time() - 1.3).abs() < 1e-15, "{name}");
    });
}

/// The session and the occurrence add the same times, in `f32` and `f64`: after a run that has
/// ended anywhere, at an event within a step, and at the end of one.
#[test]
fn the_clock_after_an_event_is_that_of_the_event_to_the_last_place() {
    fn ends_alike<R: Real>(methods: [AnyIntegrator<R>; 4]) -> u32 {
        let mut count = 0;
        for method in methods {
            let stepper = Stepper::builder(PointMass::new(R::from_f64(0.3)))
                .gravity(UniformGravity::down(R::from_f64(9.8)))
                .ground(FlatGround::level(R::from_f64(2e3), R::from_f64(0.2)))
                .integrator(Once(method))
                .build()
                .unwrap();
            for tenths in 1..40_u32 {
                let height = R::from_f64(0.07 * f64::from(tenths));
                let mut session =
                    stepper.session(State::at(R::Vec3::new(R::ZERO, R::ZERO, height)));
                session.advance(height * R::from_f64(0.0437)).unwrap();
                while let EventEnd::Event(one) = session
                    .run_until_event(R::from_f64(1.3) - session.time(), [&Landing, &Apex])
                    .unwrap()
                {
                    assert_eq!(one.time, session.time(), "{method:?}, {height:?} m");
                    count += 1;
                }
            }
        }
        count
    }
    let seconds = 1.7e-3;
    let double = ends_alike::<f64>([
        Rk4 { time_step: seconds }.into(),
        EnergyMomentum { time_step: seconds }.into(),
        DormandPrince54::new(1e-6).into(),
        Nystrom { time_step: seconds }.into(),
    ]);
    let time_step = 1.7e-3_f32;
    let single = ends_alike::<f32>([
        Rk4 { time_step }.into(),
        EnergyMomentum { time_step }.into(),
        DormandPrince54::new(1e-4_f32).into(),
        Nystrom { time_step }.into(),
    ]);
    assert!(double > 300 && single > 300, "{double}, {single}");
}

/// The third landing ends the run, in the chosen direction alone.
#[test]
fn direction_and_count_are_chosen() {
    let stepper = ball(
        FlatGround::level(1e4, 0.0),
        EnergyMomentum { time_step: 1e-3 },
    );
    let (found, _) = all(&stepper, State::at(DVec3::Z), 4.0, [&Landing]);
    let height = |sample: &Sample<'_>| sample.state.position.z;
    let mut session = stepper.session(State::at(DVec3::Z));
    let third: &dyn Event = &height.falling().nth(3).unwrap();
    let end = session
        .run_until_event(10.0, [&Apex.rising().nth(9).unwrap(), third])
        .unwrap();
    assert_eq!(end.occurrence().unwrap().time, found[2].time);
    assert_eq!(
        (
            end.occurrence().unwrap().event,
            end.occurrence().unwrap().count
        ),
        (1, 3)
    );
    let (found, _) = all(
        &stepper,
        State::at(DVec3::Z),
        4.0,
        [&height, &height.rising()],
    );
    assert!(found.len() > 5);
    // Both directions alternate, and each rise is found by both.
    let both: Vec<_> = found.iter().filter(|one| one.event == 0).collect();
    assert!(
        both.windows(2)
            .all(|pair| pair[0].direction != pair[1].direction)
    );
    let rises = both
        .iter()
        .filter(|one| one.direction == EventDirection::Rising)
        .count();
    assert_eq!(rises, found.iter().filter(|one| one.event == 1).count());
}

/// Who goes on after each event has the bits of a run without events: states, clock and counts.
#[test]
fn events_do_not_change_the_steps() {
    fn same<I: Integrator>(name: &str, integrator: I) {
        let trial = Trial {
            slip_speed: 1e-2,
            ..Trial::report(1).unwrap()
        };
        let stepper = trial.stepper(integrator).unwrap();
        let [mut alone, mut watched] = [(), ()].map(|()| stepper.session(trial.state()));
        let mut count = 0;
        for _ in 0..2 {
            alone.advance(0.1505).unwrap();
            let slip = SlipEnds::below(0.05).unwrap();
            let events: [&dyn Event; 4] = [&Landing, &Apex, &ContactOpens, &slip];
            let end = watched.run_with_events(0.1505, events, |_| {
                count += 1;
                ControlFlow::Continue(())
            });
            assert_eq!(end, Ok(EventEnd::TimeCovered), "{name}");
        }
        assert!(count > 0, "{name}");
        assert_eq!(alone.state(), watched.state(), "{name}");
        assert_eq!(alone.save(), watched.save(), "{name}");
    }
    kit::each_method!(1e-4, |integrator, name| {
        same(name, integrator);
    });
    same("flight", Flight(EnergyMomentum { time_step: 1e-3 }));
    same("DormandPrince54", DormandPrince54::new(1e-5));
    same("BogackiShampine32", BogackiShampine32::new(1e-4));
}

/// A solid ball slides at `s` and is slowed by Coulomb friction that is `μ m g s/(s + ε)`. The slip
/// decreases by `7/2 μ g s/(s + ε)`, so it falls from `s₀` to `s` in
/// `(s₀ - s + ε ln(s₀/s))/(7/2 μ g)`.
#[test]
fn a_slip_ends_when_the_ball_rolls() {
    fn ends<I: Integrator>(name: &str, tolerance: f64, integrator: I) {
        let (radius, stiffness) = (0.05, 1e3);
        let friction = Coulomb {
            coefficient: 0.3,
            slip_speed: 1e-3,
        };
        let stepper = Stepper::builder(Sphere::solid(MASS, radius))
            .gravity(UniformGravity::down(GRAVITY))
            .ground(FlatGround::level(stiffness, 0.0))
            .friction(friction)
            .integrator(integrator)
            .build()
            .unwrap();
        let height = radius - MASS * GRAVITY / stiffness;
        let start = State::at(DVec3::Z * height).with_linear_velocity(DVec3::X);
        let slip = SlipEnds::below(0.01).unwrap();
        let mut session = stepper.session(start);
        let end = session.run_until_event(2.0, [&slip]).unwrap();
        let rate = 3.5 * friction.coefficient * GRAVITY;
        let time = (0.99 + friction.slip_speed * 100.0_f64.ln()) / rate;
        let off = end.occurrence().unwrap().time - time;
        assert!(off.abs() < tolerance, "{name}: {off:e}");
        // It rolls at 5/7 of its speed, up to the remaining slip.
        let speed = session.state().linear_velocity.x;
        assert!(
            (speed - (5.0 + 2.0 * 0.01) / 7.0).abs() < tolerance,
            "{name}: {speed}"
        );
    }
    // At the end the friction changes with the slip at the rate `λ = 3.5 μ g ε/(s + ε)² = 85 1/s`.
    // The friction differs from its full value by a tenth, so a step of the order p shifts the time
    // by less than `h (λ h)^(p - 1)/10`, up to rounding.
    let time_step = 1e-5;
    ends("SymplecticEuler", 1e-6, SymplecticEuler { time_step });
    ends("EnergyMomentum", 1e-9, EnergyMomentum { time_step });
    ends("StrangSplitting", 1e-9, StrangSplitting { time_step });
    ends("Rk4", 1e-11, Rk4 { time_step });
    ends("Nystrom", 1e-11, Nystrom { time_step });
    ends("DormandPrince54", 1e-6, DormandPrince54::new(1e-7));
}

/// Three points at different heights fall onto springs that are too soft to matter. Each contact
/// closes at `√(2h/g)`, two of them in one step. Thrown up through the ground, they open in turn.
#[test]
fn each_contact_closes_and_opens_in_its_turn() {
    each_exact_in_flight!(0.04, |integrator, name| {
        let heights = [0.2, 0.21, 0.4];
        let places = heights.map(|height| DVec3::new(height, height, height));
        let body = PointCloud::new(places, [1.0; 3]).unwrap();
        let centre = body.centre_of_mass();
        let stepper = Stepper::builder(body)
            .gravity(UniformGravity::down(GRAVITY))
            .ground(FlatGround::level(1e-14, 0.0))
            .integrator(integrator)
            .build()
            .unwrap();
        let mut session = stepper.session(State::at(centre));
        let mut found = Vec::new();
        let end = session.run_with_events(0.5, [&ContactCloses, &ContactOpens], |one| {
            found.push((one.event, one.time));
            ControlFlow::Continue(())
        });
        assert_eq!(end, Ok(EventEnd::TimeCovered), "{name}");
        assert_eq!(found.len(), 3, "{name}: {found:?}");
        for ((event, time), height) in found.iter().zip(heights) {
            let off = time - (2.0 * height / GRAVITY).sqrt();
            assert!(*event == 0 && off.abs() < 1e-12, "{name}: {off:e}");
        }
        // From below the ground at 5 m/s: the highest point opens first.
        let below = State::at(centre - DVec3::Z * 0.5).with_linear_velocity(DVec3::Z * 5.0);
        let mut session = stepper.session(below);
        let mut found = Vec::new();
        let end = session.run_with_events(0.2, [&ContactCloses, &ContactOpens], |one| {
            found.push((one.event, one.time));
            ControlFlow::Continue(())
        });
        assert_eq!(end, Ok(EventEnd::TimeCovered), "{name}");
        assert_eq!(found.len(), 3, "{name}: {found:?}");
        for ((event, time), height) in found.iter().zip([0.4, 0.21, 0.2]) {
            let depth = 0.5 - height;
            let off = time - (5.0 - (25.0 - 2.0 * GRAVITY * depth).sqrt()) / GRAVITY;
            assert!(*event == 1 && off.abs() < 1e-12, "{name}: {off:e}");
        }
    });
}

/// A flight of 1 s is one step. A ball spun at 100 rad/s about y shows its x axis level at each
/// half turn: 31 times, `π/100` apart.
#[test]
fn samples_within_a_long_step_find_every_half_turn() {
    let stepper = Stepper::builder(Sphere::solid(MASS, 0.05))
        .gravity(UniformGravity::down(GRAVITY))
        .ground(FlatGround::level(1e4, 1.0))
        .integrator(Flight(EnergyMomentum { time_step: 1e-3 }))
        .build()
        .unwrap();
    let start = State::at(DVec3::Z * 6.0);
    let start = stepper.with_angular_velocity(start, DVec3::Y * 100.0);
    let level = |sample: &Sample<'_>| (sample.state.orientation * DVec3::X).z;
    let times = |event: &dyn Event| {
        let (mut session, mut times) = (stepper.session(start), Vec::new());
        let end = session.run_with_events(1.0, [event], |one| {
            times.push(one.time);
            ControlFlow::Continue(())
        });
        assert_eq!(end, Ok(EventEnd::TimeCovered));
        assert_eq!(session.step_count(), 1);
        times
    };
    let half_turn = core::f64::consts::PI / 100.0;
    let found = times(&level.sampled_every(0.7 * half_turn).unwrap());
    // The value is 0 at the start and then falls.
    assert_eq!(found.len(), 32);
    for (number, time) in found.iter().enumerate() {
        assert!(
            (time - number as f64 * half_turn).abs() < 1e-12,
            "{number}: {time}"
        );
    }
    // Without samples within the step at most two changes of the 32 are found.
    assert!(times(&level).len() <= 2);
}

/// Rotations of 0.5 to 1.9 half revolutions in a step of 1 ms, from any phase. Without samples
/// within the step most of them are chatter.
#[test]
fn samples_within_a_step_resolve_a_fast_rotation() {
    let stepper = Stepper::new(Coin::<f64>::ring(1.0, 0.5)).unwrap();
    let runner = |rate: f64, phase: f64, direction: Option<EventDirection>| {
        let start = State::at(DVec3::Z).with_rotation_vector(DVec3::Y * phase);
        let start = stepper.with_angular_velocity(start, DVec3::Y * rate);
        let level = |sample: &Sample<'_>| (sample.state.orientation * DVec3::X).z;
        let half_turn = core::f64::consts::PI / rate;
        // Half of the time between two occurrences, as the documentation says.
        let (each, event): (f64, Box<dyn Event>) = match direction {
            None => (1.0, Box::new(level.sampled_every(0.5 * half_turn).unwrap())),
            Some(EventDirection::Rising) => (
                2.0,
                Box::new(level.rising().sampled_every(half_turn).unwrap()),
            ),
            _ => (
                2.0,
                Box::new(level.falling().sampled_every(half_turn).unwrap()),
            ),
        };
        let (found, end) = all(&stepper, start, 0.5, [&*event]);
        assert_eq!(end, EventEnd::TimeCovered, "{rate} rad/s from {phase}");
        let expected = 0.5 / (each * half_turn);
        let off = found.len() as f64 - expected;
        assert!(
            off.abs() < 1.0,
            "{rate} rad/s from {phase}: {} of {expected}",
            found.len()
        );
        // The ends of a step differ in sign in most steps.
        if rate < 4500.0 {
            let (_, end) = all(&stepper, start, 0.5, [&level]);
            let is_chatter = matches!(end, EventEnd::Chatter { .. });
            assert!(is_chatter, "{rate} rad/s: {end:?}");
        }
    };
    for number in 0..24 {
        let share = f64::from(number) / 24.0;
        let (rate, phase) = (1700.0 + 4300.0 * share, 0.1 + 2.0 * share);
        runner(rate, phase, None);
        runner(rate, phase, Some(EventDirection::Rising));
        runner(rate, phase, Some(EventDirection::Falling));
    }
}

/// A value that changes its sign in most steps is chatter, and ends the run in a typed end. So may
/// the velocity of a ball that comes to rest. The bounces before rest are a finite list.
#[test]
fn chatter_ends_a_run() {
    let stepper = ball(FlatGround::level(1e4, 3.0), Rk4 { time_step: 1e-3 });
    let fast = |sample: &Sample<'_>| (1234.5 * sample.time).sin() + 1e-3;
    let (found, end) = all(&stepper, State::at(DVec3::Z * 10.0), 1.0, [&Landing, &fast]);
    // The sine changes in 39 of 100 steps; twice as fast it does so in 79 of 100.
    assert_eq!(end, EventEnd::TimeCovered);
    assert!(found.len() > 300, "{}", found.len());
    let fast = |sample: &Sample<'_>| (2469.0 * sample.time).sin() + 1e-3;
    let (found, end) = all(&stepper, State::at(DVec3::Z * 10.0), 1.0, [&Landing, &fast]);
    let EventEnd::Chatter { event: 1, time } = end else {
        panic!("{end:?}");
    };
    assert!(
        found.len() < 64 && time < 0.064 + 1e-9,
        "{} {time}",
        found.len()
    );

    // Samples of another event do not hide it.
    let other = Apex.sampled_every(5e-4).unwrap();
    let events: [&dyn Event; 2] = [&other, &fast];
    let (_, end) = all(&stepper, State::at(DVec3::Z * 10.0), 1.0, events);
    assert!(matches!(end, EventEnd::Chatter { event: 1, .. }), "{end:?}");

    // A thousand changes within one step: the mantissa of the time is odd or even.
    let noise = |sample: &Sample<'_>| {
        if sample.time.to_bits() % 2 == 0 {
            1.0
        } else {
            -1.0
        }
    };
    let (_, end) = all(&stepper, State::at(DVec3::Z * 10.0), 1.0, [&noise]);
    assert!(matches!(end, EventEnd::Chatter { event: 0, .. }), "{end:?}");

    each_exact_in_flight!(1e-3, |integrator, name| {
        // The damping is light: 97 % of the speed is left, and the steps are a tenth of a contact.
        let stepper = ball(FlatGround::level(1e4, 0.6), integrator);
        let events: [&dyn Event; 3] = [&Landing, &LiftOff, &Apex];
        let (found, end) = all(&stepper, State::at(DVec3::Z * 0.05), 60.0, events);
        // Its bounces end after `t₀ (1 + e)/(1 - e)`, some 7 s. Then it oscillates at 50 Hz, until
        // the velocity is rounding, or 0 for good.
        let of = |event: usize| found.iter().filter(|one| one.event == event).count();
        assert!(of(2) > 20 && of(2) < 3100, "{name}: {}", of(2));
        assert!(of(0) > 20 && of(0) < 200, "{name}: {}", of(0));
        assert!(
            matches!(
                end,
                EventEnd::TimeCovered | EventEnd::Chatter { event: 2, .. }
            ),
            "{name}: {end:?}"
        );
    });
}

/// The sum of the step sizes is kept with what rounding took from it.
#[test]
fn a_dense_step_starts_at_the_time_of_the_session() {
    for time_step in [0.1, 1e-3, 1.0 / 60.0, 0.3, 7e-4] {
        let stepper = ball(FlatGround::level(1e3, 1.0), Rk4 { time_step });
        let mut session = stepper.session(State::at(DVec3::Z));
        for _ in 0..2000 {
            let before = session.moment();
            let step = session.dense_step().unwrap();
            assert_eq!(step.start(), before);
            assert_eq!(step.end(), session.moment());
        }
    }
}

/// The value changes twice within a step, which its slopes beside the samples show. A value that is
/// NaN beside a sample would hide both.
#[test]
fn an_event_that_is_nan_beside_a_sample_is_a_typed_error() {
    let stepper = ball(
        FlatGround::level(1e4, 0.0),
        EnergyMomentum { time_step: 1e-3 },
    );
    let twice = |sample: &Sample<'_>| (sample.time - 4.4e-3).powi(2) - 1e-8;
    let run = |event: &dyn Event| {
        let mut session = stepper.session(State::at(DVec3::Z));
        session
            .run_until_event(1.0, [event])
            .map(|_| session.time())
    };
    assert!((run(&twice).unwrap() - 4.3e-3).abs() < 1e-9);
    let is_beside = |time: f64| {
        let steps = time * 1e3;
        let off = (steps - steps.round()).abs();
        off > 1e-6 && off <= 1.0 / 256.0
    };
    let holed = |sample: &Sample<'_>| {
        if is_beside(sample.time) {
            f64::NAN
        } else {
            twice(sample)
        }
    };
    let error = run(&holed).unwrap_err();
    assert!(
        matches!(error, StepError::BadEvent { event: 0, .. }),
        "{error:?}"
    );
}

/// Invalid events are errors, and the last state stays.
#[test]
fn an_invalid_event_is_a_typed_error() {
    let stepper = ball(
        FlatGround::level(1e4, 0.0),
        EnergyMomentum { time_step: 1e-3 },
    );
    let root = |sample: &Sample<'_>| (sample.state.position.z - 0.9).sqrt();
    let mut session = stepper.session(State::at(DVec3::Z));
    let error = session.run_until_event(1.0, [&Landing, &root]).unwrap_err();
    // 0.1 m below the start after 143 ms: the value is NaN for the first time at the step after.
    assert_eq!(
        error,
        StepError::BadEvent {
            event: 1,
            time: session.time()
        }
    );
    assert!((session.time() - 0.143).abs() < 1e-12);
    let text = error.to_string();
    assert!(
        text.starts_with("the value of the event with index 1 must not be NaN, got NaN at 0.143")
    );

    let mut session = stepper.session(State::at(DVec3::Z));
    let dense = Apex.sampled_every(1e-12).unwrap();
    let answer = session.run_until_event(1.0, [&dense]);
    assert!(
        matches!(answer, Err(StepError::TooManySamples { .. })),
        "{answer:?}"
    );
    for seconds in [-1.0, f64::NAN, f64::INFINITY] {
        let answer = session.run_until_event(seconds, [&Apex]);
        assert!(
            matches!(answer, Err(StepError::BadDuration { .. })),
            "{answer:?}"
        );
    }
    assert_eq!(
        (session.time(), *session.state()),
        (0.0, State::at(DVec3::Z))
    );

    let message = |error: SceneError| error.to_string();
    for (seconds, rule) in [
        (0.0, "must be above 0"),
        (-1.0, "must be above 0"),
        (f64::NAN, "must be finite"),
        (f64::INFINITY, "must be finite"),
    ] {
        let answer = message(Apex.sampled_every(seconds).unwrap_err());
        let expected = format!("interval of the samples of an event {rule}, got ");
        assert!(answer.starts_with(&expected), "{answer}");
        let answer = message(SlipEnds::below(seconds).unwrap_err());
        let expected = format!("speed at which a slip ends {rule}, got ");
        assert!(answer.starts_with(&expected), "{answer}");
    }
    let answer = message(Event::<f64>::nth(Apex, 0).unwrap_err());
    assert_eq!(answer, "number of the occurrence must be at least 1, got 0");

    let mut step = session.dense_step().unwrap();
    for seconds in [-1e-9, 2e-3, f64::NAN] {
        let answer = step.state_after(seconds);
        assert!(
            matches!(answer, Err(StepError::BadTime { .. })),
            "{answer:?}"
        );
    }
}

/// Infinite values have a sign: an event may be absent by being infinite.
#[test]
fn an_infinite_value_is_no_error() {
    let stepper = ball(
        FlatGround::level(1e4, 0.0),
        EnergyMomentum { time_step: 1e-3 },
    );
    let jump = |sample: &Sample<'_>| {
        if sample.time < 0.1234 {
            f64::INFINITY
        } else {
            f64::NEG_INFINITY
        }
    };
    let (found, _) = all(&stepper, State::at(DVec3::Z), 0.2, [&jump]);
    assert_eq!(found.len(), 1);
    assert!((found[0].time - 0.1234).abs() < 1e-15, "{}", found[0].time);
}

/// In `f32` the clock and the height are rounded to 6e-8 of some metres and seconds.
#[test]
fn events_are_located_in_single_precision() {
    let stepper = Stepper::builder(PointMass::new(0.1_f32))
        .gravity(UniformGravity::down(9.8))
        .ground(FlatGround::level(1e4, 0.0))
        .integrator(Flight(EnergyMomentum { time_step: 1e-3 }))
        .build()
        .unwrap();
    let start = State::at(Vec3::Z).with_linear_velocity(Vec3::Z * 4.9);
    let mut session = stepper.session(start);
    let apex = session.run_until_event(1.2, [&Landing, &Apex]).unwrap();
    assert_eq!(apex.occurrence().unwrap().event, 1);
    assert!((session.time() - 0.5).abs() < 1e-6, "{}", session.time());
    let next = session.run_until_event(1.2, [&Landing, &Apex]).unwrap();
    assert_eq!(next.occurrence().unwrap().event, 0);
    let landing = 0.5 + (0.25_f32 + 1.0 / 4.9).sqrt();
    assert!(
        (session.time() - landing).abs() < 1e-6,
        "{}",
        session.time()
    );
}

/// A state within a step has the order of the method: the error of the height in contact falls with
/// it. At the ends of the step it is the state of the run.
#[test]
fn dense_output_has_the_order_of_the_method() {
    fn errors<I: Integrator>(method: impl Fn(f64) -> I) -> f64 {
        let frequency = 20.0;
        let stiffness = MASS * frequency * frequency;
        let rest = -MASS * GRAVITY / stiffness;
        let start = State::at(DVec3::Z * (rest * 0.6));
        let errors = [4e-3, 2e-3, 1e-3].map(|time_step| {
            let stepper = ball(FlatGround::level(stiffness, 0.0), method(time_step));
            let mut session = stepper.session(start);
            session.advance(0.3).unwrap();
            let mut step = session.dense_step().unwrap();
            assert_eq!(step.state_after(0.0).unwrap(), step.start().state);
            assert_eq!(step.state_after(time_step).unwrap(), *session.state());
            assert_eq!((step.end(), step.length()), (session.moment(), time_step));
            let inside = step.state_after(0.3 * time_step).unwrap();
            let time = step.start().time + 0.3 * time_step;
            let truth = rest * (1.0 - 0.4 * (frequency * time).cos());
            (time_step, (inside.position.z - truth).abs())
        });
        convergence(&errors)
    }
    let orders = [
        (1.0, errors(|time_step| ForwardEuler { time_step })),
        (1.0, errors(|time_step| SymplecticEuler { time_step })),
        (2.0, errors(|time_step| StrangSplitting { time_step })),
        (2.0, errors(|time_step| EnergyMomentum { time_step })),
        (4.0, errors(|time_step| Rk4 { time_step })),
        (4.0, errors(|time_step| Nystrom { time_step })),
    ];
    for (order, found) in orders {
        assert!(found > order - 0.25, "{orders:?}");
    }
}
