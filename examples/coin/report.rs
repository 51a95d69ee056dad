//! The loop of the coin report, which passes its states to the recorder.

use std::error::Error;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

use tumble::glam::{DMat3, DQuat, DVec3};
use tumble::{Integrator, Observer, Sample, Start, State};

use crate::options::UsageError;
use crate::recorder::Recorder;
use crate::report_loop::{Direction, ReportLoop, ReportTrial, SLIP_SPEED};
use crate::run::CoinStepper;
use crate::setup::{RADIUS, Setup};

/// Runs the loop. The stepper is used only for queries about its states.
///
/// # Errors
///
/// Returns an error if the loop does not have a parameter, or if a number is not finite.
pub(crate) fn run<I: Integrator<f64>>(
    setup: &Setup,
    stepper: &CoinStepper<I>,
    recorder: &mut Recorder<'_>,
) -> Result<(), Box<dyn Error>> {
    let mut report = ReportLoop::new(trial(setup)?);
    let mut step = 0;
    loop {
        let state = state(&report, setup.points);
        if let Some(quantity) = state.not_finite() {
            return Err(format!(
                "the {quantity} is no longer finite after {} s",
                report.time()
            )
            .into());
        }
        let sample = Sample {
            time: report.time(),
            step,
            evaluations: step,
            rejected: 0,
            state: &state,
            scene: stepper.scene(),
        };
        // Slightly less than a step before the end counts as the end.
        let over = report.time() > setup.duration - 1e-6 * setup.time_step;
        if recorder.observe(&sample) == ControlFlow::Break(()) || over {
            return Ok(());
        }
        report.step();
        step += 1;
    }
}

fn trial(setup: &Setup) -> Result<ReportTrial, UsageError> {
    if setup.trial.slip_speed.to_bits() != SLIP_SPEED.to_bits() {
        let message =
            format!("the report's loop has a slip speed of {SLIP_SPEED:e} m/s and no other");
        return Err(UsageError::new(message));
    }
    Ok(ReportTrial {
        direction: match setup.trial.start {
            Start::Rolling => Direction::Rolling,
            Start::Spinning => Direction::Spinning,
        },
        tilt: setup.trial.tilt,
        coefficient: setup.trial.coefficient,
        angular_momentum: setup.trial.angular_momentum,
        damping: setup.trial.damping,
        stiffness: setup.stiffness,
        points: setup.points,
        time_step: setup.time_step,
    })
}

fn state(report: &ReportLoop, points: usize) -> State {
    State {
        position: DVec3::from(report.centre()),
        linear_velocity: DVec3::from(report.velocity()),
        orientation: orientation(report, points),
        angular_momentum: DVec3::from(report.angular_momentum()),
    }
}

/// Rotation from the initial ring to the current one.
///
/// The arm of point k was `r (y cos φ + z sin φ)` with `φ = 2πk/n`. So `2/(n r) Σ arm cos φ` is the
/// current y axis, and the same sum with sines is the z axis.
fn orientation(report: &ReportLoop, points: usize) -> DQuat {
    let (mut y, mut z) = (DVec3::ZERO, DVec3::ZERO);
    for point in 1..=points {
        let (sin, cos) = (TAU * point as f64 / points as f64).sin_cos();
        let arm = DVec3::from(report.arm(point));
        y += arm * cos;
        z += arm * sin;
    }
    let scale = 2.0 / (points as f64 * RADIUS);
    let (y, z) = (y * scale, z * scale);
    DQuat::from_mat3(&DMat3::from_cols(y.cross(z), y, z)).normalize()
}
