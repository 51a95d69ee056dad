//! The coin on its ground: rolling round a circle, the trials of the coin report at three sizes,
//! and spinning on the spot.

use tumble::glam::{DQuat, DVec3};
use tumble::{Coin, ContactPoint, RigidPointBody, State, Trial};

use super::{GRAVITY, rigid_hoop};
use crate::law::Law;
use crate::scene::{Case, Measure, Scene, Shape};

#[path = "../../../../examples/common/hoop_circle.rs"]
mod hoop_circle;

use hoop_circle::{RADIUS, SPIN};

/// A ring of 1 kg and 0.5 m on a ground.
fn law(points: usize, stiffness: f64, damping: f64, coefficient: f64, slip_speed: f64) -> Law {
    let ring = Coin::ring_with_storage(vec![ContactPoint::default(); points], 1.0, 0.5);
    Law {
        mass: 1.0,
        inertia: DVec3::new(0.25, 0.125, 0.125),
        contacts: ring.contacts().to_vec(),
        rim: 0.0,
        stiffness,
        damping,
        coefficient,
        slip_speed,
        gravity: GRAVITY,
    }
}

fn scene(
    name: &'static str,
    about: String,
    law: Law,
    seconds: f64,
    soft: Case,
    rigid: Case,
) -> Scene {
    Scene {
        name,
        about,
        law,
        shape: Shape::Coin(0.5),
        restitution: 0.0,
        seconds,
        soft,
        rigid,
        measure: Measure::Rim(0.5),
        unit: (1.0, "m"),
        useful: 0.1,
        steps: vec![1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5],
        plain_steps: vec![3e-3, 1e-3, 1e-4],
        rapier_steps: vec![1e-2, 1e-3, 1e-4],
        scale: (1.0, 1.0),
    }
}

/// Start and end of the circle on a rigid floor.
pub(super) fn circle(seconds: f64) -> (State, State) {
    (hoop_circle::after(0.0), hoop_circle::after(seconds))
}

/// The hoop that rolls round a circle.
pub(crate) fn rolling_hoop() -> Result<Scene, String> {
    let seconds = 1.0;
    let (start, answer) = circle(seconds);
    let law = law(480, 1e5, 20.0, 0.3, 1e-4);
    let sagged = law.height_at_rest(start.orientation) - start.position.z;
    let soft = |state: State| State {
        position: state.position + DVec3::Z * sagged,
        ..state
    };
    let about = format!(
        "ring of {RADIUS} m, 75° from flat, spin {SPIN} rad/s, on a circle of 3.08 m; its place after {seconds} s, closed form of the rigid smooth hoop; 480 points, S = 1e5 N/m"
    );
    Ok(Scene {
        measure: Measure::Centre,
        ..scene(
            "hoop rolls round a circle",
            about,
            law,
            seconds,
            Case {
                start: soft(start),
                answer: soft(answer),
            },
            Case { start, answer },
        )
    })
}

/// The same hoop for ten seconds, touching at its lowest point alone, without a known result.
///
/// It starts at the height at which the springs carry the centripetal motion, and soon follows the
/// circle of a ground and a friction that yield.
pub(crate) fn hoop_on_one_point(slip_speed: f64) -> Scene {
    let seconds = 10.0;
    let (start, _) = circle(seconds);
    let law = Law {
        contacts: Vec::new(),
        rim: RADIUS,
        ..law(0, 1e6, 400.0, 0.3, slip_speed)
    };
    let sag = DVec3::Z * (law.mass * law.gravity / law.stiffness);
    let start = State {
        position: start.position - sag,
        ..start
    };
    let case = Case {
        start,
        answer: start,
    };
    Scene {
        shape: Shape::Hoop(RADIUS),
        ..scene("hoop on one point", String::new(), law, seconds, case, case)
    }
}

/// A trial of the coin report with a slip speed of 1e-3 m/s and all lengths multiplied by `size`.
///
/// Masses scale with the cube of `size` and times with its root. The other parameters follow, so
/// that the motion is similar.
pub(crate) fn trial(number: usize, size: f64) -> Result<Scene, String> {
    let trial = Trial {
        slip_speed: 1e-3,
        ..Trial::report(number).ok_or("no such trial")?
    };
    let (mass, time) = (size.powi(3), size.sqrt());
    let speed = size / time;
    let momentum = mass * size * speed;
    let grown = |state: &State| State {
        position: state.position * size,
        linear_velocity: state.linear_velocity * speed,
        orientation: state.orientation,
        angular_momentum: state.angular_momentum * momentum,
    };
    let mut law = law(
        120,
        1000.0,
        0.5,
        trial.coefficient,
        trial.slip_speed * speed,
    );
    law.mass *= mass;
    law.inertia *= mass * size * size;
    law.stiffness *= mass / (time * time);
    law.damping *= mass / time;
    for contact in &mut law.contacts {
        contact.position *= size;
    }
    let start = trial.state();
    let case = |answer: &State| Case {
        start: grown(&start),
        answer: grown(answer),
    };
    let seconds = 1.0;
    let rigid = rigid_hoop::after(&start, trial.coefficient, seconds)?;
    let soft = truth(number, trial.slip_speed, seconds)?;
    let name = match (number, size < 0.1, size > 10.0) {
        (_, true, _) => "trial 1, coin of 1 mm",
        (_, _, true) => "trial 1, coin of 1 km",
        (1, ..) => "trial 1",
        (3, ..) => "trial 3, sticks and rolls",
        _ => "trial 8",
    };
    let apart = (rigid.position - soft.position).length();
    let about = if size == 1.0 {
        format!(
            "the report's, 120 points, v_ε = 1e-3 m/s; place and turn after 1 s against 13 digits of the truth; rapier against a rigid smooth hoop, whose centre ends {apart:.1e} m away"
        )
    } else {
        "the same with all lengths, masses and times to scale; the error in radii of the coin"
            .into()
    };
    let scaled = |steps: Vec<f64>| steps.into_iter().map(|step| step * time).collect();
    let plain = scene(name, about, law, seconds * time, case(&soft), case(&rigid));
    Ok(Scene {
        shape: Shape::Coin(RADIUS * size),
        measure: Measure::Rim(RADIUS * size),
        unit: if size == 1.0 {
            (1.0, "m")
        } else {
            (RADIUS * size, "radii")
        },
        useful: if size == 1.0 { 0.1 } else { 0.2 },
        // Finer than those of the other scenes, so that the cheapest step for 1e-4 m is among them.
        steps: scaled(vec![
            1.25e-2, 1e-2, 5e-3, 2.5e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5,
        ]),
        plain_steps: scaled(vec![1e-2, 5e-3, 2.5e-3, 1e-3, 1e-4]),
        rapier_steps: scaled(plain.rapier_steps),
        scale: (size, time),
        ..plain
    })
}

/// A trial of the coin report without a known result, for [`crate::trials`].
pub(crate) fn trial_without_answer(number: usize) -> Result<Scene, String> {
    const NAMES: [&str; 8] = [
        "trial 1", "trial 2", "trial 3", "trial 4", "trial 5", "trial 6", "trial 7", "trial 8",
    ];
    let slip_speed = 1e-3;
    let trial = Trial::report(number).ok_or("no such trial")?;
    let law = law(120, 1000.0, 0.5, trial.coefficient, slip_speed);
    let start = trial.state();
    let case = Case {
        start,
        answer: start,
    };
    let name = NAMES[number - 1];
    Ok(scene(name, String::new(), law, 1.0, case, case))
}

/// Returns the row of the table of reference solutions.
fn truth(trial: usize, slip_speed: f64, seconds: f64) -> Result<State, String> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/data/truth_table.csv"
    );
    let mut table = csv::Reader::from_path(path).map_err(|error| format!("{path}: {error}"))?;
    let headings = table.headers().map_err(|error| error.to_string())?.clone();
    for line in table.records() {
        let line = line.map_err(|error| error.to_string())?;
        let number = |name: &str| -> Option<f64> {
            let column = headings.iter().position(|heading| heading == name)?;
            line.get(column)?.parse().ok()
        };
        let vector = |x, y, z| Some(DVec3::new(number(x)?, number(y)?, number(z)?));
        let row = || {
            Some((
                [number("trial")?, number("v_eps")?, number("t")?],
                State {
                    position: vector("x", "y", "z")?,
                    linear_velocity: vector("ux", "uy", "uz")?,
                    orientation: DQuat::from_xyzw(
                        number("qx")?,
                        number("qy")?,
                        number("qz")?,
                        number("qw")?,
                    ),
                    angular_momentum: vector("Lx", "Ly", "Lz")?,
                },
            ))
        };
        let (key, state) = row().ok_or("the table of truth lacks a column")?;
        if key == [trial as f64, slip_speed, seconds] {
            return Ok(state);
        }
    }
    Err(format!("the table of truth lacks trial {trial}"))
}

/// A flat coin that spins on the spot; friction slows it by `μ g/r`.
pub(crate) fn spinning() -> Scene {
    let (spin, seconds, coefficient) = (1e4, 1.0, 0.3);
    let law = law(120, 1000.0, 0.5, coefficient, 1e-3);
    let flat = DQuat::from_rotation_y(-core::f64::consts::FRAC_PI_2);
    let slowed = spin - coefficient * GRAVITY / RADIUS * seconds;
    let sag = GRAVITY / (120.0 * law.stiffness);
    let case = |height: f64| Case {
        start: State::at(DVec3::Z * height)
            .with_orientation(flat)
            .with_angular_momentum(DVec3::Z * (0.25 * spin)),
        answer: State::at(DVec3::Z * height)
            .with_orientation(flat)
            .with_angular_momentum(DVec3::Z * (0.25 * slowed)),
    };
    let about =
        "flat on the ground, μ = 0.3; friction takes μ g/r = 5.88 rad/s in 1 s, closed form".into();
    Scene {
        measure: Measure::BodySpin,
        unit: (1.0, "rad/s"),
        useful: 0.6,
        steps: vec![1e-3, 1e-4, 1e-5],
        plain_steps: vec![1e-4, 1e-5],
        ..scene(
            "coin spins flat at 10⁴ rad/s",
            about,
            law,
            seconds,
            case(-sag),
            case(0.0),
        )
    }
}
