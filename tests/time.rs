//! Time: a run ends at the asked time, samples come at the times that are asked for, and nobody's looking changes the path.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]
// The bits of times are compared, and few looks counted.
#![allow(clippy::float_cmp, clippy::cast_possible_truncation)]

mod kit;

use core::ops::ControlFlow;
use tumble::{
    BogackiShampine32, DormandPrince54, EnergyMomentum, Flight, Integrator, Ledger, Observer, Rk4,
    Sample, State, Timed, Trial,
};

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

/// A look is up to `tolerance` (m) from a run to its time: 0 where the method has its steps from nobody's end.
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
            Timed::every(interval, watch(&mut looks)),
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
            // Each tenth: what a look sees is the end of a run to its time.
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

/// A box of observers of any kind: each by itself, as one.
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
        Timed::every(0.03, watch(&mut thirds)),
        Timed::every(0.02, watch(&mut halves)),
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
    });
    let mut state = trial().state();
    let time = stepper.run(&mut state, 1.0, &mut film).unwrap();
    assert!((time - 0.011).abs() < 1e-15, "{time}");
    let mut same = trial().state();
    stepper.advance(&mut same, 0.011).unwrap();
    assert_eq!(state, same);
}

#[test]
fn an_interval_that_is_none_asks_for_the_start_alone() {
    let stepper = trial().stepper(EnergyMomentum { time_step: 1e-3 }).unwrap();
    for interval in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let mut seen = Vec::new();
        let mut film = Timed::every(interval, watch(&mut seen));
        stepper.run(&mut trial().state(), 0.01, &mut film).unwrap();
        drop(film);
        assert_eq!(seen.len(), 1);
    }
}
