//! Single precision: the error that it adds for each integrator at each step size, and the gain of
//! compensated summation.

#![allow(
    clippy::cast_possible_truncation,
    reason = "rounding to f32 is what is measured"
)]

use core::error::Error;

use crate::truth::{DURATION, SLIP_SPEED, distance, truth};
use common::table::{self, cells};
use common::{marked, say};
use tumble::error::SceneError;
use tumble::glam::{DQuat, DVec3, Vec3};
use tumble::integrator::step_length;
use tumble::{
    Dynamics, EnergyMomentum, ForwardEuler, Integrator, Ledger, Nystrom, Observer, Real, Rk4,
    State, Step, StepError, StrangSplitting, SymplecticEuler, Trial,
};

const STEPS: [f64; 6] = [3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5];

const PAGE: &str = "src/guide/accuracy.md";
const BY_STEP: [&str; 2] = [
    "<!-- f32 steps: begin; written by `accuracy -- --f32 --write` -->",
    "<!-- f32 steps: end -->",
];
const COMPENSATED: [&str; 2] = [
    "<!-- f32 sums: begin; written by `accuracy -- --f32 --write` -->",
    "<!-- f32 sums: end -->",
];

/// Prints all tables, or writes them into the page of the guide.
pub(crate) fn tables(is_written: bool) -> Result<(), Box<dyn Error>> {
    let truth = truth()?;
    macro_rules! measured {
        ($($integrator:ident)*) => {[$((
            stringify!($integrator),
            STEPS.map(|time_step| [
                audited::<f64, _>($integrator { time_step }),
                audited::<f32, _>($integrator { time_step: time_step as f32 }),
            ]),
        )),*]};
    }
    let measured =
        measured!(EnergyMomentum StrangSplitting Rk4 Nystrom SymplecticEuler ForwardEuler);
    let errors = table("error in f32 (f64), m", &measured, |end| {
        distance(&end.state, &truth)
    });
    let energies = table("energy error in f32 (f64), J", &measured, |end| {
        end.energy_error.abs()
    });
    let by_step = [errors, energies].join("\n");
    let sums = compensation(&truth);
    if !is_written {
        say([by_step, sums].join("\n"));
        return Ok(());
    }
    marked::write(PAGE, BY_STEP, &by_step)?;
    marked::write(PAGE, COMPENSATED, &sums)
}

type Measured = (&'static str, [[Option<End>; 2]; STEPS.len()]);

/// Returns a row for each integrator, a column for each step size, and the step size with the least
/// figure in f32.
fn table(what: &str, measured: &[Measured], figure: impl Fn(&End) -> f64) -> String {
    let mut head = vec![what.to_owned()];
    head.extend(STEPS.map(milliseconds));
    head.push("best".to_owned());
    let mut rows = vec![head];
    for (name, ends) in measured {
        let mut best = (f64::INFINITY, 0.0);
        let mut row = vec![format!("`{name}`")];
        for (time_step, [double, single]) in STEPS.iter().zip(ends) {
            let [double, single] = [double, single].map(|end| end.as_ref().map(&figure));
            row.push(format!("{} ({})", or_none(single), or_none(double)));
            best = match single {
                Some(single) if single < best.0 => (single, *time_step),
                _ => best,
            };
        }
        row.push(milliseconds(best.1));
        rows.push(row);
    }
    table::text(&rows)
}

/// Measures the gain of compensated summation, near the origin and far from it.
fn compensation(truth: &State) -> String {
    let mut rows = vec![cells([
        "`SymplecticEuler`, error in m",
        "time step",
        "f32",
        "position compensated",
        "velocity and momentum too",
        "f64",
    ])];
    let places = [
        ("at the origin", 0.0),
        ("100 m away", 100.0),
        ("1 km away", 1000.0),
    ];
    for (name, away) in places {
        for double in [1e-3, 1e-4, 1e-5, 1e-6] {
            let time_step = double as f32;
            rows.push(cells([
                name.to_owned(),
                milliseconds(double),
                error_of(SymplecticEuler { time_step }, away, truth),
                error_of(Compensated::<false> { time_step }, away, truth),
                error_of(Compensated::<true> { time_step }, away, truth),
                error_of(SymplecticEuler { time_step: double }, away, truth),
            ]));
        }
    }
    table::text(&rows)
}

fn error_of<R: Widen, I: Integrator<R>>(integrator: I, away: f64, truth: &State) -> String {
    or_none(run(integrator, away, &mut ()).map(|end| distance(&end, truth)))
}

fn milliseconds(time_step: f64) -> String {
    format!("{} ms", (time_step * 1e6).round() * 1e-3)
}

/// Formats a figure, or a dash if the run failed.
fn or_none(figure: Option<f64>) -> String {
    match figure {
        Some(figure) if figure.abs() < 1.0 => format!("{figure:.1e}"),
        _ => "-".into(),
    }
}

/// End of a run, in f64.
struct End {
    state: State,
    /// Energy that no force dissipated or supplied, J.
    energy_error: f64,
}

/// Number type whose states can be compared with the exact solution.
trait Widen: Real {
    fn widen(state: &State<Self>) -> State;
}

impl Widen for f64 {
    fn widen(state: &State) -> State {
        *state
    }
}

impl Widen for f32 {
    fn widen(state: &State<f32>) -> State {
        let turn = state.orientation;
        let turn = DQuat::from_xyzw(turn.x.into(), turn.y.into(), turn.z.into(), turn.w.into());
        State::at(state.position.into()).with_orientation(turn.normalize())
    }
}

/// Trial 1, started at a distance along x and shifted back at the end. Returns `None` if a step
/// fails.
fn run<R: Widen, I: Integrator<R>>(
    integrator: I,
    away: f64,
    observer: &mut impl Observer<R>,
) -> Option<State> {
    let trial = Trial::<R> {
        slip_speed: R::from_f64(SLIP_SPEED),
        ..Trial::report(1)?
    };
    let stepper = trial.stepper(integrator).ok()?;
    let mut state = trial.state();
    let aside = <R::Vec3 as tumble::real::Vector<R>>::new(R::from_f64(away), R::ZERO, R::ZERO);
    state.position += aside;
    stepper
        .run(&mut state, R::from_f64(DURATION), observer)
        .ok()?;
    let mut end = R::widen(&state);
    end.position -= DVec3::X * away;
    Some(end)
}

/// Trial 1 with its energy audit.
fn audited<R: Widen, I: Integrator<R>>(integrator: I) -> Option<End> {
    let mut ledger = Ledger::new();
    let state = run(integrator, 0.0, &mut ledger)?;
    Some(End {
        state,
        energy_error: ledger.energy_error().to_f64(),
    })
}

/// [`SymplecticEuler`] with compensated summation over the steps (Kahan 1965): of the position, or
/// also of velocity and angular momentum.
struct Compensated<const ALL: bool> {
    time_step: f32,
}

/// Rounding errors of the sums.
#[derive(Clone, Debug, Default)]
struct Lost {
    position: Vec3,
    velocity: Vec3,
    momentum: Vec3,
}

impl<const ALL: bool> Integrator<f32> for Compensated<ALL> {
    type Workspace = Lost;

    fn step<D: Dynamics<f32>>(
        &self,
        scene: &D,
        state: &mut State<f32>,
        limit: f32,
        lost: &mut Lost,
    ) -> Result<Step<f32>, StepError> {
        let dt = step_length(self.time_step, limit);
        let mass = scene.inertia_properties();
        let rotation = state.rotation();
        let motion = scene.motion_along(state, rotation.axes());
        let load = scene.load(&motion);
        let kick = (load.force * mass.inverse_mass() + scene.gravity()) * dt;
        let twist = load.torque * dt;
        if ALL {
            add(&mut state.linear_velocity, &mut lost.velocity, kick);
            add(&mut state.angular_momentum, &mut lost.momentum, twist);
        } else {
            state.linear_velocity += kick;
            state.angular_momentum += twist;
        }
        add(
            &mut state.position,
            &mut lost.position,
            state.linear_velocity * dt,
        );
        state.orientation = mass
            .turn_freely(rotation, &motion.axes, state.angular_momentum, dt)
            .to_quat();
        Ok(Step::new(dt, 1))
    }

    fn order(&self) -> u32 {
        1
    }

    fn check(&self) -> Result<(), SceneError> {
        SymplecticEuler {
            time_step: self.time_step,
        }
        .check()
    }
}

/// Computes `sum += term` with the previous rounding error, and stores the new one.
fn add(sum: &mut Vec3, lost: &mut Vec3, term: Vec3) {
    let corrected = term - *lost;
    let next = *sum + corrected;
    *lost = (next - *sum) - corrected;
    *sum = next;
}
