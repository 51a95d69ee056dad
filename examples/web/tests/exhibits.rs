//! The bodies of the page move as they should, and its tosses are those of the library.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]
#![allow(clippy::float_cmp, reason = "counts are whole numbers")]

use tumble::ensemble::{Ensemble, RandomSpin, RandomStart, SceneHash, Throw, wilson};
use tumble::glam::DVec3;
use tumble::{Dynamics, RigidPointBody, State};
use tumble_page::bodies::Exhibit;
use tumble_page::memory::Block;
use tumble_page::run::{self, RUN};
use tumble_page::scene::{Parameters, read_state};
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
        for method in 0..6 {
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
