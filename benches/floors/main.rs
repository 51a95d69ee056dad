//! Floors: the arithmetic that the formulas of a step need, for the scenes of
//! `benches/instructions.rs`. `.ci/floors.py` puts it beside the instructions that are executed.
//!
//! The arguments are `floors INTEGRATOR PHASE POINTS FEWER MORE`. The library takes `MORE` steps.
//! Each is taken again by the formulas of its method, on [numbers](number) that count the
//! operations. Both ends must be the same to rounding: otherwise the count would be that of another
//! step. Printed are the operations of a step, as a mean over the steps after the first `FEWER`:
//! all, and the sums, products, divisions, roots and comparisons among them. The iterations and the
//! evaluations of all contacts that the library reports follow.
//!
//! What is counted:
//!
//! - The formulas are those of a body with two equal moments, of bare points and of level ground,
//!   as the scene has them. A value that a formula contains twice is computed once.
//! - The forces are those of the contacts that touch. The search for them, and the test of the
//!   others, is no part of the formulas.
//! - `EnergyMomentum` has the iterations that the library has taken. Its test of convergence, the
//!   energies, and the limiter that compares them are no part of the formulas.
//! - A quaternion is scaled to length 1 where a formula changes its length: at the end of a step of
//!   `Rk4`, of `Nystrom` and of the Cayley map. The rotations of the other methods keep it.

// A benchmark that fails ends with a panic.
#![allow(clippy::unwrap_used, clippy::panic)]

mod explicit;
mod implicit;
mod number;
mod nystrom;
mod scene;
#[path = "../scenes.rs"]
mod scenes;

use implicit::Work;
use number::{Counts, counted};
use scene::{Point, Scene};
use scenes::{Phase, TIME_STEP, ring, stepper};
use tumble::{
    EnergyMomentum, ForwardEuler, Integrator, Nystrom, RigidPointBody, Rk4, State, StrangSplitting,
    SymplecticEuler,
};

/// Largest relative difference between the ends of a step by the library and by the formulas.
const ROUNDING: f64 = 1e-12;

fn main() {
    let arguments = Vec::from_iter(std::env::args().skip(1));
    // `cargo bench` and `cargo test --all-targets` start it with options of their own.
    let [integrator, phase, points, fewer, more] = &arguments[..] else {
        println!("floors INTEGRATOR PHASE POINTS FEWER MORE");
        return;
    };
    let phase = Phase::ALL.into_iter().find(|p| p.name() == phase).unwrap();
    let points = points.parse().unwrap();
    let steps = [fewer.parse().unwrap(), more.parse().unwrap()];
    let time_step = TIME_STEP;
    let run = Run {
        phase,
        points,
        steps,
    };
    match &integrator[..] {
        "ForwardEuler" => run.with(ForwardEuler { time_step }, |scene, start, _| {
            scene.forward_euler(start)
        }),
        "SymplecticEuler" => run.with(SymplecticEuler { time_step }, |scene, start, _| {
            scene.symplectic_euler(start)
        }),
        "StrangSplitting" => run.with(StrangSplitting { time_step }, |scene, start, _| {
            scene.strang_splitting(start)
        }),
        "Rk4" => run.with(Rk4 { time_step }, |scene, start, _| scene.rk4(start)),
        "Nystrom" => run.with(Nystrom { time_step }, |scene, start, _| {
            scene.nystrom(start)
        }),
        "EnergyMomentum" => run.with(EnergyMomentum { time_step }, |scene, start, work| {
            scene.energy_momentum(start, work)
        }),
        other => panic!("no integrator {other}"),
    }
}

/// A row: a scene, and the steps that are counted.
struct Run {
    phase: Phase,
    points: usize,
    steps: [u32; 2],
}

impl Run {
    fn with<I: Integrator>(self, integrator: I, formulas: impl Fn(&Scene, &Point, Work) -> Point) {
        let [fewer, more] = self.steps;
        let stepper = stepper(ring(self.points), integrator);
        let points = stepper.body().contacts().iter().map(|point| point.position);
        let scene = Scene::ring(&Vec::from_iter(points), TIME_STEP);
        let (mut state, mut workspace) = (self.phase.state(), I::Workspace::default());
        let (mut sum, mut iterations, mut evaluations) = (Counts::default(), 0, 0);
        for number in 0..more {
            let start = Point::of(&state);
            let integrator = stepper.integrator();
            let step = integrator.step(stepper.scene(), &mut state, f64::MAX, &mut workspace);
            let step = step.unwrap();
            assert!(!step.fallback, "a fallback is no part of the formulas");
            let work = Work {
                iterations: step.iterations,
                evaluations: step.evaluations,
            };
            let (end, counts) = counted(|| formulas(&scene, &start, work));
            assert_same(&end.to_state(), &state, number);
            if number >= fewer {
                sum = core::array::from_fn(|i| sum[i] + counts[i]);
                iterations += u64::from(step.iterations);
                evaluations += u64::from(step.evaluations);
            }
        }
        let mean = |count: u64| count as f64 / f64::from(more - fewer);
        print!("{:.0}", mean(sum.iter().sum()));
        sum.into_iter()
            .for_each(|count| print!(" {:.0}", mean(count)));
        println!(" {:.2} {:.2}", mean(iterations), mean(evaluations));
    }
}

/// Panics if two ends of a step differ by more than rounding.
fn assert_same(formulas: &State, library: &State, step: u32) {
    let differences = [
        (formulas.position - library.position).length() / library.position.length(),
        (formulas.linear_velocity - library.linear_velocity).length()
            / library.linear_velocity.length(),
        (formulas.orientation - library.orientation).length(),
        (formulas.angular_momentum - library.angular_momentum).length()
            / library.angular_momentum.length(),
    ];
    for difference in differences {
        assert!(
            difference <= ROUNDING,
            "step {step}: position, velocity, orientation and angular momentum differ by \
             {differences:?}"
        );
    }
}
