//! Aims relative to other programs.

use tumble::glam::{DMat3, DVec3};
use tumble::{
    Coulomb, Ellipsoid, EnergyMomentum, FlatGround, Integrator, MassProperties, Radau5, Stepper,
    UniformGravity,
};

use crate::aims::Aim;
use crate::aims::alone::{least, text};
use crate::answers::{coins, free, rolling_ball};
use crate::law::Law;
use crate::measure::{self, Row};
use crate::programs::{Program, ours, plain};
use crate::scene::Scene;
use crate::trials;

/// Error of position and rim in the eight trials, m.
const ERROR: f64 = 1e-4;
/// Method that has one tolerance for all trials, and its tolerances a decade.
const METHOD: &str = "tumble AdaptiveNystrom";
const A_DECADE: i32 = 10;

/// Cost of one tolerance for the eight trials, over that of a plain Rk4.
///
/// The tolerance keeps the error in each trial, and so does every tighter one that was tried. The
/// step of the plain Rk4 is chosen in the same way in each trial by itself.
pub(super) fn of_one_tolerance(turns: usize) -> Result<[Aim; 2], String> {
    let mut scenes = Vec::new();
    for trial in 1..=8 {
        eprintln!("trial {trial}, one tolerance ...");
        let mut scene = coins::trial_without_answer(trial)?;
        scene.soft.answer = trials::answer(&scene)?;
        scenes.push(scene);
    }
    let mut tolerance = f64::INFINITY;
    for scene in &scenes {
        let found = largest(scene, &tolerances(), |value| of_method(scene, value))?;
        tolerance = tolerance.min(found);
    }
    let mut ratios = Vec::new();
    for scene in &scenes {
        let step = largest(scene, &steps(), |step| Ok(plain_rk4(scene, step)))?;
        let programs = vec![of_method(scene, tolerance)?, plain_rk4(scene, step)];
        let rows = measure::rows_of(scene, &programs, turns)?;
        ratios.push(price(&rows[0])? / price(&rows[1])?);
    }
    let mean = (ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len() as f64).exp();
    let worst = ratios.iter().copied().fold(0.0, f64::max);
    let what = |which: &str| {
        format!(
            "{ERROR:.0e} m in the eight trials by `AdaptiveNystrom` with one tolerance: cost over \
             that of a plain Rk4, {which}"
        )
    };
    Ok([
        Aim::new(what("geometric mean"), 0.15, Some(mean)),
        Aim::new(what("worst"), 0.5, Some(worst)),
    ])
}

/// Tolerances from the tightest on, m.
fn tolerances() -> Vec<f64> {
    (-7 * A_DECADE..=-2 * A_DECADE)
        .map(|tenth| 10_f64.powf(f64::from(tenth) / f64::from(A_DECADE)))
        .collect()
}

/// Steps from the shortest on, s: halved below 0.05 ms, and its multiples.
fn steps() -> Vec<f64> {
    const GRID: f64 = 5e-5;
    let halved = [8.0, 4.0, 2.0].map(|part| GRID / part);
    let even = (1..=200).map(|count| GRID * f64::from(count));
    halved.into_iter().chain(even).collect()
}

/// Largest setting that keeps the error, as every smaller one does.
fn largest<'a>(
    scene: &'a Scene,
    settings: &[f64],
    program: impl Fn(f64) -> Result<Box<dyn Program + 'a>, String>,
) -> Result<f64, String> {
    let mut largest = None;
    for &setting in settings {
        let end = program(setting)?.run(None);
        let keeps = end.is_ok_and(|end| scene.error(&end.state, &scene.soft.answer) <= ERROR);
        if !keeps {
            break;
        }
        largest = Some(setting);
    }
    largest.ok_or_else(|| format!("{}: no setting keeps {ERROR:e} m", scene.name))
}

fn of_method<'a>(scene: &'a Scene, tolerance: f64) -> Result<Box<dyn Program + 'a>, String> {
    let programs = ours::with_tolerances(scene, &[tolerance], false)?;
    let found = programs
        .into_iter()
        .find(|program| program.name() == METHOD);
    found.ok_or_else(|| format!("there is no {METHOD}"))
}

fn plain_rk4(scene: &Scene, time_step: f64) -> Box<dyn Program + '_> {
    Box::new(plain::PlainRk4 {
        law: &scene.law,
        start: scene.soft.start,
        seconds: scene.seconds,
        time_step,
    })
}

fn price(row: &Row) -> Result<f64, String> {
    row.outcome
        .as_ref()
        .map(|outcome| outcome.price)
        .map_err(Clone::clone)
}

/// Cost of loose tolerances over that of Dopri5, in the worst trial.
pub(super) fn of_loose_tolerances(turns: usize) -> Result<Vec<Aim>, String> {
    let lines = trials::measure(turns)?;
    let method = trials::summary(&lines)
        .into_iter()
        .find(|(method, _)| *method == METHOD);
    let (_, cells) = method.ok_or_else(|| format!("there is no {METHOD}"))?;
    let headings = trials::headings();
    let loose = headings.iter().zip(cells).take(3);
    let aims = loose.map(|(heading, cell)| {
        let what = format!("`AdaptiveNystrom` in one call, worst of eight trials, over {heading}");
        Aim::new(what, 0.8, cell.map(|(_, worst)| worst))
    });
    Ok(aims.collect())
}

/// Free rotation of a box about its middle axis, beside a Rk4 and Dop853 in body axes.
pub(super) fn of_free_rotation(turns: usize) -> Result<Vec<Aim>, String> {
    eprintln!("free rotation ...");
    let scene = free::middle_axis();
    let rows = measure::rows(&scene, turns)?;
    let flight = rows.iter().find(|row| row.name == "tumble Flight");
    let outcome = flight.and_then(|row| row.outcome.as_ref().ok());
    let call = outcome.map(|outcome| 1e9 * outcome.price * scene.seconds);
    let what = "box about its middle axis for 10 s";
    // The motion amplifies rounding, so that no program of steps has less than some 1e-9.
    let errors = || (3..=8).map(|decade| 10_f64.powi(-decade));
    let over = |peer: &str| {
        let ratios = errors().map(|error| {
            let ours = cheapest(&rows, error, |row| {
                row.is_ours && row.name != "tumble Flight"
            })?;
            // An error that the peer does not reach costs it any price.
            let peer = cheapest(&rows, error, |row| row.name == peer);
            Some(peer.map_or(0.0, |peer| ours / peer))
        });
        ratios.reduce(|one, other| Some(one?.max(other?))).flatten()
    };
    Ok(vec![
        Aim::new(format!("{what}: `Flight`, one call"), 1e3, call).in_unit("ns"),
        Aim::new(
            format!("{what}: error of `Flight`"),
            1e-12,
            outcome.map(|outcome| outcome.error),
        )
        .in_unit(scene.unit.1),
        Aim::new(
            format!(
                "{what}: steps over those of a Rk4 in body axes, 1e-3 to 1e-8 {}",
                scene.unit.1
            ),
            1.0,
            over("plain Rk4, body axes"),
        ),
        Aim::new(
            format!(
                "{what}: steps over Dop853 in body axes, 1e-3 to 1e-8 {}",
                scene.unit.1
            ),
            1.0,
            over("ode_solvers Dop853, body axes"),
        ),
    ])
}

/// Least cost of a program, in one call, with at most this error.
fn cheapest(rows: &[Row], error: f64, is_wanted: impl Fn(&Row) -> bool) -> Option<f64> {
    (rows.iter())
        .filter(|row| !row.is_sampled && is_wanted(row))
        .filter_map(|row| row.outcome.as_ref().ok())
        .filter(|outcome| outcome.error <= error)
        .map(|outcome| outcome.price)
        .min_by(f64::total_cmp)
}

/// Stick at high accuracy, beside a stiff method.
pub(super) fn of_stick(turns: usize) -> Result<Vec<Aim>, String> {
    let mut aims = of_hoop(turns)?;
    for slip_speed in [1e-4, 1e-6] {
        eprintln!("stick, slip speed {slip_speed:e} m/s ...");
        let scene = rolling_ball::slides_then_rolls(1e6, slip_speed);
        let rows = measure::rows(&scene, turns)?;
        for error in [1e-8, 1e-9] {
            let ours = cheapest(&rows, error, |row| row.is_ours);
            let peer = cheapest(&rows, error, |row| row.name.starts_with("diffsol"));
            let ratio = ours.map(|ours| peer.map_or(0.0, |peer| ours / peer));
            let what = format!(
                "a ball slides and then rolls, slip speed {slip_speed:.0e} m/s, {error:.0e} m: \
                 cost over that of `diffsol`"
            );
            aims.push(Aim::new(what, 1.0, ratio));
        }
    }
    Ok(aims)
}

/// A hoop that rolls round a circle for ten seconds: beside a stiff method, and as a body of the
/// library.
fn of_hoop(turns: usize) -> Result<Vec<Aim>, String> {
    const SLIP_SPEED: f64 = 1e-4;
    const ERROR: f64 = 1e-7;
    eprintln!("rolling hoop ...");
    let mut scene = coins::hoop_on_one_point(SLIP_SPEED);
    scene.soft.answer = trials::answer(&scene)?;
    let rows = measure::rows_of(&scene, &measure::programs_for_stick(&scene)?, turns)?;
    let ours = cheapest(&rows, ERROR, |row| row.is_ours);
    let peer = cheapest(&rows, ERROR, |row| row.name.starts_with("diffsol"));
    let what = format!(
        "a hoop rolls round a circle for 10 s, slip speed {SLIP_SPEED:.0e} m/s, {ERROR:.0e} m: \
         cost over that of `diffsol`"
    );
    let ratio = ours.map(|ours| peer.map_or(0.0, |peer| ours / peer));
    let mut yielding = coins::hoop_on_one_point(1e2 * SLIP_SPEED);
    yielding.soft.answer = trials::answer(&yielding)?;
    Ok(vec![
        Aim::new(what, 1.0, ratio),
        of_thin_ellipsoid(&scene, SLIP_SPEED)?,
        of_thin_ellipsoid(&yielding, 1e2 * SLIP_SPEED)?,
    ])
}

/// Cost of a simulated second of the hoop as a thin `Ellipsoid`, with an angle of its normal to
/// 0.01° after ten seconds.
fn of_thin_ellipsoid(scene: &Scene, slip_speed: f64) -> Result<Aim, String> {
    let tolerances = [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5];
    let steps = [8e-3, 6e-3, 4e-3, 3e-3, 2e-3, 1.5e-3, 1e-3];
    let by_radau = tolerances.map(|tolerance| roll(scene, Radau5::new(tolerance)));
    let by_steps = steps.map(|time_step| roll(scene, EnergyMomentum { time_step }));
    let what = format!(
        "a thin `Ellipsoid` rolls as a hoop for 10 s, slip speed {slip_speed:.0e} m/s, 0.01°: CPU \
         a second"
    );
    let least = [robust(by_radau)?, robust(by_steps)?].into_iter().flatten();
    let cost = least.min_by(f64::total_cmp);
    Ok(Aim::new(what, 130.0, cost).in_unit("µs"))
}

/// Cost of the coarsest setting that keeps 0.01° together with all finer ones.
fn robust<const N: usize>(settings: [Result<[f64; 2], String>; N]) -> Result<Option<f64>, String> {
    let mut cost = None;
    for setting in settings.into_iter().rev() {
        let [angle, micros] = setting?;
        if angle > 0.01_f64.to_radians() {
            break;
        }
        cost = Some(micros);
    }
    Ok(cost)
}

/// Angle (rad) between the normal of the hoop and that of the known result, and CPU a simulated
/// second, µs.
fn roll(scene: &Scene, integrator: impl Integrator<f64>) -> Result<[f64; 2], String> {
    let Law { mass, inertia, .. } = &scene.law;
    let hoop = MassProperties {
        mass: *mass,
        centre_of_mass: DVec3::ZERO,
        inertia: DMat3::from_diagonal(*inertia),
    };
    // Its edge deviates from a circle by the square of the thickness over the radius, 2e-8 m.
    let semi_axes = DVec3::new(1e-4, scene.law.rim, scene.law.rim);
    let stepper = Stepper::builder(Ellipsoid::loaded(semi_axes, hoop))
        .gravity(UniformGravity::down(scene.law.gravity))
        .ground(FlatGround::level(scene.law.stiffness, scene.law.damping))
        .friction(Coulomb {
            coefficient: scene.law.coefficient,
            slip_speed: scene.law.slip_speed,
        })
        .integrator(integrator)
        .build()
        .map_err(text)?;
    let mut end = scene.soft.start;
    let time = least(3, || {
        end = scene.soft.start;
        stepper.advance(&mut end, scene.seconds).map_err(text)
    })?;
    let [normal, answer] = [end, scene.soft.answer].map(|state| state.orientation * DVec3::X);
    Ok([normal.angle_between(answer), 1e-3 * time / scene.seconds])
}
