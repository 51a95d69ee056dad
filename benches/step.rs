//! Time of a step of each integrator, ns, in four phases of trial 1, with 12, 120 and 1200 points.
//!
//! `ratios` compares programs, and `.ci/instructions` counts instructions. Each sample takes 1000
//! steps from the start of the phase, so that the phase does not change: criterion's "µs" are ns a
//! step.

mod scenes;

use core::hint::black_box;
use core::time::Duration;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use scenes::{Phase, STEPS, TIME_STEP, ring, stepper};
use tumble::{
    EnergyMomentum, ForwardEuler, Integrator, Nystrom, Rk4, StrangSplitting, SymplecticEuler,
};

const TIME: f64 = TIME_STEP;

fn explicit(criterion: &mut Criterion) {
    every_phase(criterion, "ForwardEuler", ForwardEuler { time_step: TIME });
    every_phase(
        criterion,
        "SymplecticEuler",
        SymplecticEuler { time_step: TIME },
    );
    every_phase(
        criterion,
        "StrangSplitting",
        StrangSplitting { time_step: TIME },
    );
    every_phase(criterion, "Rk4", Rk4 { time_step: TIME });
    every_phase(criterion, "Nystrom", Nystrom { time_step: TIME });
}

fn implicit(criterion: &mut Criterion) {
    every_phase(
        criterion,
        "EnergyMomentum",
        EnergyMomentum { time_step: TIME },
    );
}

fn every_phase(criterion: &mut Criterion, name: &str, integrator: impl Integrator + Copy) {
    let mut group = criterion.benchmark_group(format!("1000 steps, {name}"));
    for phase in Phase::ALL {
        for points in [12, 120, 1200] {
            let stepper = stepper(ring(points), integrator);
            let start = phase.state();
            group.bench_with_input(
                BenchmarkId::new(phase.name(), points),
                &start,
                |bench, start| {
                    bench.iter(|| black_box(scenes::steps(&stepper, start, STEPS)));
                },
            );
        }
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(800));
    targets = explicit, implicit
}
criterion_main!(benches);
