//! The bodies of the page move as they should, and its tosses are those of the library.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]
#![allow(clippy::float_cmp, reason = "counts are whole numbers")]

use tumble::ensemble::{Ensemble, RandomSpin, RandomStart, SceneHash, Throw, wilson};
use tumble::glam::DVec3;
use tumble::{Dynamics, RigidPointBody, State};
use tumble_page::memory::{Block, read_state};
use tumble_page::run::{self, RUN};
use tumble_page::scenes::battery::{self, Start};
use tumble_page::scenes::bodies::Exhibit;
use tumble_page::scenes::parameters::Parameters;
use tumble_page::tosses::{self, COUNTS, FAILED, Starts, UNDECIDED};

const LARGEST_INCREASE: usize = 19;

fn parameters(body: u32) -> Parameters {
    Exhibit::from_number(f64::from(body)).unwrap().parameters
}

/// Follows the first scene of a body and returns the states at equal intervals.
fn followed(parameters: &Parameters, seconds: f64, interval: f64) -> Vec<State> {
    let stepper = parameters.stepper().unwrap();
    let mut session = stepper.session(parameters.start().unwrap());
    let count = (seconds / interval) as usize;
    let moments = session.samples(interval).unwrap().take(count + 1);
    moments.map(|moment| moment.unwrap().state).collect()
}

#[test]
fn each_body_starts_with_its_lowest_point_on_the_ground() {
    for body in 0..7 {
        for start in [0.0, 1.0] {
            let parameters = Parameters {
                start,
                ..parameters(body)
            };
            let (stepper, state) = (parameters.stepper().unwrap(), parameters.start().unwrap());
            let gap = stepper.lowest_point(&state).unwrap().gap;
            // Rounding of lengths of the body.
            let rounding = 8.0 * f64::EPSILON * stepper.body().bounding_radius();
            assert!(gap.abs() <= rounding, "body {body}: {gap} m");
        }
    }
}

#[test]
fn the_energy_of_each_body_never_increases() {
    for body in 0..7 {
        for start in [0.0, 1.0, 2.0] {
            let parameters = Parameters {
                start,
                ..parameters(body)
            };
            let (stepper, block) = (parameters.stepper().unwrap(), Block::<RUN>::new());
            run::begin(&block, &stepper, &parameters.start().unwrap());
            run::advance(&block, &stepper, 2000).unwrap();
            assert_eq!(block.get(LARGEST_INCREASE).to_bits(), 0, "body {body}");
        }
    }
}

#[test]
fn an_explicit_step_too_long_gains_energy_and_says_so() {
    // Ten times the first step: the springs alone allow 2.8/ω = 4 ms for a die of 4.8 g.
    let parameters = Parameters {
        method: 3.0,
        step: 1e-2,
        start: 2.0,
        ..parameters(3)
    };
    let (stepper, block) = (parameters.stepper().unwrap(), Block::<RUN>::new());
    run::begin(&block, &stepper, &parameters.start().unwrap());
    run::advance(&block, &stepper, 200).unwrap();
    assert!(block.get(LARGEST_INCREASE) > 0.0);
}

#[test]
fn steps_in_parts_have_the_bits_of_steps_at_once() {
    for body in 0..7 {
        for method in 0..10 {
            let parameters = Parameters {
                method: f64::from(method),
                start: 2.0,
                ..parameters(body)
            };
            let stepper = parameters.stepper().unwrap();
            let [whole, parts] = [(); 2].map(|()| Block::<RUN>::new());
            for block in [&whole, &parts] {
                run::begin(block, &stepper, &parameters.start().unwrap());
            }
            run::advance(&whole, &stepper, 300).unwrap();
            for steps in [1, 7, 92, 200] {
                run::advance(&parts, &stepper, steps).unwrap();
            }
            assert_eq!(
                read_state(&whole),
                read_state(&parts),
                "body {body}, method {method}"
            );
        }
    }
}

/// Moffatt & Shimomura, Nature 416, 385 (2002).
#[test]
fn the_egg_rises() {
    let states = followed(&parameters(5), 6.0, 0.01);
    let rises = states.iter().map(|s| (s.orientation * DVec3::Z).z.abs());
    assert!(rises.fold(0.0, f64::max) > 80.0_f64.to_radians().sin());
}

#[test]
fn the_tippe_top_turns_upside_down() {
    let states = followed(&parameters(4), 15.0, 0.1);
    let lean = (states[states.len() - 1].orientation * DVec3::Z).z;
    assert!(lean < 170.0_f64.to_radians().cos(), "{lean}");
}

/// Garcia & Hubbard, Proc. R. Soc. Lond. A 418, 165 (1988).
#[test]
fn the_rattleback_reverses_far_sooner_in_one_direction() {
    let first_reversal = |spin: f64| {
        let parameters = Parameters {
            spin,
            ..parameters(6)
        };
        let stepper = parameters.stepper().unwrap();
        let states = followed(&parameters, 8.0, 0.01);
        let reversed = |state: &State| spin * stepper.angular_velocity(state).z < 0.0;
        states.iter().position(reversed).unwrap_or(states.len())
    };
    let (against, along) = (first_reversal(-4.0), first_reversal(4.0));
    assert!(3 * against < along, "{against} {along}");
}

#[test]
fn the_tosses_are_those_of_the_library() {
    for (body, faces) in [(0, 2), (1, 3), (3, 6)] {
        let (parameters, counts) = (parameters(body), Block::<COUNTS>::new());
        for part in [0..3, 3..4, 4..30] {
            tosses::play(&counts, &parameters, 7, part).unwrap();
        }
        let stepper = parameters.default_stepper().unwrap();
        let starts = Starts::of(stepper.body().bounding_radius(), parameters.gravity);
        let [height, rate] = [starts.height, starts.rate].map(|[low, high]| low..=high);
        let start =
            RandomStart::at_height(height).with_spin(RandomSpin::Isotropic { rate: rate.into() });
        let throw = Throw::new(&stepper, start, starts.seconds).unwrap();
        let ensemble = Ensemble::new(7, SceneHash::of_bytes(b"page"));
        let tally = ensemble.run(0..30, |toss| throw.play(toss)).unwrap();
        for face in 0..faces {
            let count = tally.count(&face);
            assert_eq!(counts.get(face), count as f64, "body {body}, face {face}");
        }
        assert_eq!(counts.get(UNDECIDED), tally.undecided().count() as f64);
        assert_eq!(counts.get(FAILED), 0.0);
    }
}

#[test]
fn the_interval_is_that_of_the_library() {
    for (count, total) in [(0_u32, 10_u32), (3, 10), (500, 1000), (1000, 1000)] {
        let expected = wilson(count.into(), total.into(), 0.95).unwrap();
        let found = tosses::wilson(count.into(), total.into());
        for (one, other) in found.iter().zip(expected) {
            // The library finds the quantile by bisection, to an ulp.
            assert!(
                (one - other).abs() < 4.0 * f64::EPSILON,
                "{found:?} {expected:?}"
            );
        }
    }
}

#[test]
fn invalid_parameters_are_refused_by_name() {
    let cases: [(Parameters, &str); 4] = [
        (
            Parameters {
                step: -1e-3,
                ..parameters(0)
            },
            "time step must be above 0, got -0.001 s",
        ),
        (
            Parameters {
                friction: f64::NAN,
                ..parameters(0)
            },
            "NaN",
        ),
        (
            Parameters {
                body: 7.0,
                ..parameters(0)
            },
            "there is no body with the number 7",
        ),
        (
            Parameters {
                method: 0.5,
                ..parameters(0)
            },
            "there is no integrator with the number 0.5",
        ),
    ];
    for (parameters, text) in cases {
        let error = parameters.stepper().unwrap_err().to_string();
        assert!(error.contains(text), "{error}");
    }
    assert!(
        Parameters {
            spin: f64::INFINITY,
            ..parameters(0)
        }
        .start()
        .is_err()
    );
}

#[test]
fn the_mass_of_the_thick_coin_is_that_of_steel() {
    let parameters = parameters(1);
    let stepper = parameters.stepper().unwrap();
    let volume = std::f64::consts::PI * 0.012 * 0.012 * 0.012 * std::f64::consts::FRAC_1_SQRT_2;
    let density = stepper.scene().inertia_properties().mass() / volume;
    assert!((7700.0..8000.0).contains(&density), "{density} kg/m³");
}

/// Runs of the battery with `EnergyMomentum`, which has the number 0.
fn runs_by_default() -> impl Iterator<Item = battery::Run> {
    battery::runs().filter(|run| run.method == 0)
}

#[test]
fn the_battery_has_each_body_with_each_integrator() {
    let mut runs: Vec<_> = battery::runs()
        .map(|run| (run.body, run.method, run.start == Start::Thrown))
        .collect();
    assert_eq!(runs.len(), 7 * 12 * 2);
    runs.sort_unstable();
    runs.dedup();
    assert_eq!(runs.len(), 7 * 12 * 2);
}

#[test]
fn a_thrown_body_of_the_battery_flies_hits_and_slides() {
    for run in runs_by_default().filter(|run| run.start == Start::Thrown) {
        // Steps before the touch-down, vertical velocity before it and the largest after it.
        let (mut flies, mut before, mut after, mut slides) = (0, 0.0, f64::NEG_INFINITY, 0);
        run.follow(&mut |stepper, state| {
            let fell = after == f64::NEG_INFINITY;
            if fell && stepper.touching(state) == 0 {
                (flies, before) = (flies + 1, state.linear_velocity.z);
                return;
            }
            after = f64::max(after, state.linear_velocity.z);
            let slip = stepper.slip_velocity(state).map_or(0.0, DVec3::length);
            slides += u32::from(stepper.touching(state) > 0 && slip > 1e-2);
        })
        .unwrap();
        assert!(flies > 10, "{}: flies {flies} steps", run.name);
        assert!(
            before < 0.0 && after > 0.5 * before,
            "{}: hits the floor at {before} m/s",
            run.name
        );
        assert!(slides > 3, "{}: slides {slides} steps", run.name);
    }
}

#[test]
fn a_body_of_the_battery_that_is_set_down_comes_to_rest() {
    for run in runs_by_default().filter(|run| run.start == Start::SetDown) {
        let (mut states, mut touching) = (Vec::new(), 0);
        run.follow(&mut |stepper, state| {
            states.push(*state);
            touching = stepper.touching(state);
        })
        .unwrap();
        let (first, last) = (states[0], states[states.len() - 1]);
        assert!(touching > 0 && first != last, "{}", run.name);
        assert_eq!(states[states.len() - 2], last, "{}: rests", run.name);
    }
}

#[test]
fn the_row_of_the_battery_is_the_stored_one() {
    let stored = include_str!("../../../tests/bits/hashes.txt");
    let row = format!("{} {:016x}", battery::ROW, battery::row().unwrap());
    assert!(stored.lines().any(|line| line == row), "{row}");
}
