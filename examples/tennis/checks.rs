//! Figures with their expected values: closed forms of bounce, spin and drop, and printed figures
//! of courts.

use std::f64::consts::TAU;

use common::{Check, Outcome};
use tumble::State;
use tumble::glam::DVec3;

use crate::Hit;
use crate::flight;
use crate::model::{self, Air, BETA, Court, GRAVITY, RADIUS};
use crate::rigid;

/// Revolutions a minute of one radian a second.
const PER_MINUTE: f64 = 60.0 / TAU;

/// All figures of the page.
pub(crate) fn all(hits: &[Hit], court: &Court, time_step: f64) -> Outcome<Vec<Check>> {
    let mut checks = Vec::new();
    for hit in hits {
        checks.extend(bounce(hit, court));
    }
    checks.extend(hits.iter().filter_map(spin_in_flight));
    for court in &Court::ALL {
        checks.push(pace(court, time_step)?);
    }
    checks.extend(drop_test(time_step)?);
    let gains = hits.iter().map(|hit| hit.in_air.energy_gain);
    checks.push(Check::energy_gains("in a step with drag and lift", gains));
    Ok(checks)
}

/// Compares a bounce in air with that of a rigid ball of the same normal impulse.
///
/// The normal impulse includes the weight during the contact. The air is left out, which changes a
/// velocity by up to its drag times the contact time.
fn bounce(hit: &Hit, court: &Court) -> [Check; 3] {
    let [before, after] = &hit.in_air.bounce;
    let seconds = after.time - before.time;
    let impulse = after.velocity.z - before.velocity.z + GRAVITY * seconds;
    let expected = rigid::bounce(before.velocity, before.spin, court.friction, impulse);
    let drag = Air::of_speed(hit.shot.speed).drag_per_mass();
    let slack = drag * before.velocity.length_squared() * seconds * (1.0 + court.friction);
    let (name, down) = (hit.shot.name, -before.velocity.z);
    let (how, source) = if expected.grips {
        (
            "grips",
            "rolls at the end: (v + β r ω)/(1 + β); Brody (1984)",
        )
    } else {
        ("slides", "slides throughout: v - μ J; Brody (1984)")
    };
    let fall = (2.0 * GRAVITY * seconds + slack) / down;
    [
        Check::near(
            &format!("{name} {how}: horizontal speed after the bounce, m/s"),
            source,
            after.velocity.with_z(0.0).length(),
            expected.along.length(),
            slack,
        ),
        Check::near(
            &format!("{name} {how}: spin after the bounce, revolutions a minute"),
            "moment of the same impulse",
            after.spin.length() * PER_MINUTE,
            expected.spin.length() * PER_MINUTE,
            slack / (BETA * RADIUS) * PER_MINUTE,
        ),
        Check::between(
            &format!("{name}: restitution"),
            "that of the court, less up to 2 g T/v by the weight during the contact",
            after.velocity.z / down,
            court.restitution - fall,
            court.restitution + slack / down,
        ),
    ]
}

/// Compares the spin before the bounce with its exponential decay.
fn spin_in_flight(hit: &Hit) -> Option<Check> {
    let before = &hit.in_air.bounce[0];
    let first = hit.shot.turns.length();
    let left = (-Air::of_speed(hit.shot.speed).spin_decay() * before.time).exp();
    (first > 0.0).then(|| {
        Check::near(
            &format!(
                "{}: spin before the bounce, revolutions a minute",
                hit.shot.name
            ),
            "exponential decay of the linear torque",
            before.spin.length() * PER_MINUTE,
            first * left,
            1e-6 * first,
        )
    })
}

/// Court pace rating of a court: 30 m/s at 16°, without spin (ITF CS 01/02).
fn pace(court: &Court, time_step: f64) -> Outcome<Check> {
    let game = model::stepper(court, &Air::none(), time_step)?;
    let (sin, cos) = 16.0_f64.to_radians().sin_cos();
    let start =
        State::at(DVec3::Z * RADIUS).with_linear_velocity(DVec3::new(cos, 0.0, -sin) * 30.0);
    let [before, after] = flight::fly(&game, start)?.bounce;
    let restitution = -after.velocity.z / before.velocity.z;
    let friction = (before.velocity.x - after.velocity.x) / (after.velocity.z - before.velocity.z);
    let rating = 100.0 * (1.0 - friction) + 150.0 * (0.81 - restitution);
    let (source, least, most) = match court.name {
        "grass" => ("most grass: categories 4 and 5, 40 and more", 40.0, 100.0),
        "clay" => ("most clay: category 1, up to 29", 0.0, 29.5),
        _ => (
            "most acrylic: categories 2 and 3, 30 to 39; chosen as 37",
            29.5,
            39.5,
        ),
    };
    Ok(Check::between(
        &format!("court pace rating of the {} court", court.name),
        &format!("Rules of Tennis, appendix I: {source}"),
        rating,
        least,
        most,
    ))
}

/// Heights of the drop test, m: the ball is dropped from the first and rebounds to between the
/// others (Rules of Tennis, appendix I).
const DROP: f64 = 2.54;
const REBOUND: [f64; 2] = [1.35, 1.47];

/// Drops a ball with the restitution for the middle of the allowed range, in air.
fn drop_test(time_step: f64) -> Outcome<[Check; 2]> {
    let air = Air::of_speed(0.0);
    let middle = 0.5 * (REBOUND[0] + REBOUND[1]);
    let concrete = Court {
        name: "concrete",
        restitution: restitution_of_drop(middle, air.drag_per_mass()),
        ..Court::HARD
    };
    let game = model::stepper(&concrete, &air, time_step)?;
    let flight = flight::fly(&game, State::at(DVec3::Z * (DROP + RADIUS)))?;
    let rebound = flight.top_after_bounce() - RADIUS;
    let [before, after] = &flight.bounce;
    let weight = 2.0 * GRAVITY * (after.time - before.time) / -before.velocity.z;
    Ok([
        Check::between(
            &format!(
                "drop test in air, restitution {:.3}: rebound from 2.54 m, m",
                concrete.restitution
            ),
            "Rules of Tennis, appendix I",
            rebound,
            REBOUND[0],
            REBOUND[1],
        ),
        Check::between(
            "the same",
            "1.41 m in closed form with drag, less up to twice the weight's fraction of the speed",
            rebound,
            middle * (1.0 - 2.0 * weight),
            middle,
        ),
    ])
}

/// Restitution with which a ball rebounds to a height (m) in air with the drag `k v²` for each unit
/// of mass. Falling from h: `v² = g/k (1 - e^(-2 k h))`. Rising to h: `v² = g/k (e^(2 k h) - 1)`.
fn restitution_of_drop(rebound: f64, per_mass: f64) -> f64 {
    let fall = -(-2.0 * per_mass * DROP).exp_m1();
    let rise = (2.0 * per_mass * rebound).exp_m1();
    (rise / fall).sqrt()
}
