//! Error against cost, measured by the library.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use core::time::Duration;

use tumble::error::Quantity;
use tumble::work_precision::{
    Failure, Method, Row, Setting, WorkPrecision, measure, measure_against, measure_integrator,
    reference,
};
use tumble::{Rk4, State, StepError, Trial};

/// A trial of the report. All tests measure its type of scene, for which each method is compiled.
fn trial(number: usize) -> Trial {
    Trial {
        slip_speed: 1e-3,
        ..Trial::report(number).unwrap()
    }
}

fn settings() -> Vec<Setting> {
    let mut settings = Setting::built_in();
    settings.retain(|setting| {
        setting.parameter
            >= if setting.method.has_tolerance() {
                1e-6
            } else {
                1e-3
            }
    });
    settings
}

#[test]
fn the_table_has_a_row_for_each_setting_and_its_errors_are_those_of_runs() {
    let trial = trial(1);
    let stepper = trial.stepper(Rk4 { time_step: 1e-3 }).unwrap();
    let (start, settings) = (trial.state(), settings());
    let table = measure(stepper.scene(), &start, 0.1, &settings).unwrap();
    assert!(table.resolution < 1e-9, "{:e}", table.resolution);
    assert_eq!(table.rows.len(), settings.len());
    let reference = reference(stepper.scene(), &start, 0.1).unwrap().end;
    for (row, setting) in table.rows.iter().zip(&settings) {
        assert_eq!(row.setting, *setting);
        assert_eq!(row.failure, None);
        assert!(row.steps > 0 && row.evaluations > 0, "{setting}");
        if setting.method == Method::Rk4 && setting.parameter < 2e-3 {
            let mut state = start;
            stepper.advance(&mut state, 0.1).unwrap();
            let way = (state.position - reference.position).length();
            assert!(row.error >= way && row.error < way + 1e-4);
            assert_eq!((row.steps, row.evaluations), (100, 400));
        }
        if setting.method == Method::EnergyMomentum {
            assert!(row.energy_rise <= 0.0, "{setting}: {:e}", row.energy_rise);
        }
    }
    // No row of the Pareto front is dominated, and the cheapest for an error is one of them.
    let front = table.pareto_front();
    for pair in front.windows(2) {
        assert!(pair[0].time <= pair[1].time && pair[0].error > pair[1].error);
    }
    let best = table.cheapest(1e-4).unwrap();
    assert!(best.error <= 1e-4 && front.iter().any(|row| row.time == best.time));
    assert_eq!(table.cheapest(0.0), None);
    assert_eq!(table.to_string().lines().count(), settings.len() + 1);
}

/// Rows of equal time or equal error, in any order, and one that failed.
#[test]
fn rows_of_the_front_do_not_depend_on_the_order_of_the_table() {
    let row = |setting: &'static str, error: f64, micros: u64| Row {
        setting,
        error,
        time: Duration::from_micros(micros),
        evaluations: 1,
        steps: 1,
        rejected: 0,
        energy_rise: 0.0,
        failure: None,
    };
    let failed = Row {
        failure: Some(Failure::Step(StepError::Diverged(Quantity::Position))),
        ..row("failed", f64::INFINITY, 1)
    };
    let mut rows = vec![
        row("a", 2.0, 10),
        row("b", 1.0, 10),
        row("c", 1.0, 20),
        row("d", 0.5, 30),
        row("e", 0.5, 30),
        failed,
    ];
    for _ in 0..rows.len() {
        rows.rotate_left(1);
        let table = WorkPrecision {
            rows: rows.clone(),
            resolution: 0.0,
        };
        let mut front: Vec<_> = table.pareto_front().iter().map(|row| row.setting).collect();
        front.sort_unstable();
        assert_eq!(front, ["b", "d", "e"]);
        assert_eq!(table.cheapest(3.0).unwrap().setting, "b");
        assert_eq!(table.cheapest(f64::INFINITY).unwrap().setting, "b");
        let vague = WorkPrecision {
            resolution: 1.5,
            ..table
        };
        assert_eq!(vague.cheapest(3.0).unwrap().setting, "b");
        assert_eq!(vague.cheapest(1.0), None);
    }
}

#[test]
fn a_setting_that_fails_has_a_row_with_its_error() {
    // A position that is not a number.
    let stepper = trial(1).stepper(Rk4 { time_step: 1e-3 }).unwrap();
    let start = State::at(tumble::glam::DVec3::NAN);
    let settings = [Setting {
        method: Method::Rk4,
        parameter: 1e-2,
        flight: true,
    }];
    let end = tumble::work_precision::Reference {
        end: start,
        resolution: 0.0,
    };
    let table = measure_against(stepper.scene(), &start, 1.0, &settings, &end);
    assert!(matches!(
        table.rows[0].failure,
        Some(Failure::Step(StepError::BadState {
            quantity: Quantity::Position,
            ..
        }))
    ));
    assert!(table.rows[0].error.is_infinite());
    assert!(table.pareto_front().is_empty());
    assert_eq!(table.rows[0].setting.to_string(), "Rk4 1e-2 s + flight");
}

#[test]
fn a_setting_whose_knob_cannot_be_is_told_so() {
    let stepper = trial(1).stepper(Rk4 { time_step: 1e-3 }).unwrap();
    let settings = [Method::Rk4, Method::DormandPrince54].map(|method| Setting {
        method,
        parameter: -1.0,
        flight: false,
    });
    let table = measure(stepper.scene(), &trial(1).state(), 0.1, &settings).unwrap();
    let said = table
        .rows
        .iter()
        .map(|row| row.failure.unwrap().to_string());
    assert_eq!(
        said.collect::<Vec<_>>(),
        [
            "time step must be above 0, got -1 s",
            "tolerance must be above 0, got -1 m"
        ]
    );
}

#[test]
fn any_integrator_gets_the_row_that_a_built_in_setting_of_it_gets() {
    let trial = trial(3);
    let own = Rk4 { time_step: 1e-3 };
    let stepper = trial.stepper(own).unwrap();
    let (scene, start) = (stepper.scene(), trial.state());
    let truth = reference(scene, &start, 0.2).unwrap();
    let setting = Setting {
        method: Method::Rk4,
        parameter: 1e-3,
        flight: false,
    };
    let built_in = measure_against(scene, &start, 0.2, &[setting], &truth).with_text();
    let row = measure_integrator(scene, &start, 0.2, "own".to_owned(), own, &truth);
    let known = &built_in.rows[0];
    assert_eq!(known.setting, "Rk4 1e-3 s");
    assert_eq!(row.setting, "own");
    assert_eq!(row.error.to_bits(), known.error.to_bits());
    assert_eq!(row.energy_rise.to_bits(), known.energy_rise.to_bits());
    assert_eq!(
        (row.steps, row.evaluations, row.rejected, row.failure),
        (
            known.steps,
            known.evaluations,
            known.rejected,
            known.failure
        )
    );
    let mut table = built_in;
    table.rows.push(row);
    assert!(table.to_string().contains("own "));
}
