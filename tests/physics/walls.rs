//! The speed at which a body passes through a wall of finite thickness, in the table of
//! `guide::game`.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::kit::erased::Stepper;
use crate::kit::page::Table;
use tumble::glam::DVec3;
use tumble::{Block, Carried, EnergyMomentum, Ground, Sphere, SpringDamper, State};

const MASS: f64 = 0.005; // kg
const RADIUS: f64 = 0.008; // m

const SPEEDS: Table = Table {
    page: "game",
    begin: "<!-- walls: begin; rows written by \
            `UPDATE=1 cargo test --test physics walls` -->\n\n\
            | step size | 2 cm | 5 cm | 10 cm |\n\
            |---|---|---|---|\n",
    end: "\n<!-- walls: end -->",
    command: "cargo test --test physics walls",
};

/// A ball is thrown at a wall between 0 and `thickness` (m). Returns true if it ends behind the
/// wall, for any of 32 moments within the step at which it arrives.
fn passes(thickness: f64, time_step: f64, speed: f64) -> bool {
    let corner = Carried {
        mass: MASS,
        contacts: 1,
    };
    let half = 0.5 * thickness;
    let wall = Block {
        centre: DVec3::X * half,
        half: DVec3::new(half, 1.0, 1.0),
    };
    let stepper = Stepper::builder(Sphere::solid(MASS, RADIUS))
        .ground(Ground {
            law: SpringDamper::from_rest(corner, 0.5, 5e-5, 9.81).unwrap(),
            shape: wall,
        })
        .integrator(EnergyMomentum { time_step })
        .build()
        .unwrap();
    (0..32).any(|moment| {
        let way = RADIUS + speed * time_step * (1.0 + f64::from(moment) / 32.0);
        let mut ball = State::at(DVec3::X * -way).with_linear_velocity(DVec3::X * speed);
        stepper.advance(&mut ball, 64.0 * time_step).unwrap();
        let is_behind = ball.position.x > thickness && ball.linear_velocity.x > 0.0;
        let is_before = ball.position.x < 0.0 && ball.linear_velocity.x < 0.0;
        assert!(
            is_behind != is_before,
            "{thickness} m, {time_step} s: {ball:?}"
        );
        is_behind
    })
}

#[test]
fn a_ball_passes_through_walls_from_the_speeds_of_the_guide_on() {
    let speeds = || (1..200).map(|half| 0.5 * f64::from(half)); // m/s
    let mut rows = String::new();
    for (name, time_step) in [
        ("1/60 s", 1.0 / 60.0),
        ("1/240 s", 1.0 / 240.0),
        ("1 ms", 1e-3),
    ] {
        let least = [0.02, 0.05, 0.1].map(|thickness| {
            let mut speeds = speeds();
            let least = speeds
                .find(|&speed| passes(thickness, time_step, speed))
                .unwrap();
            // The claim is about every speed from there on.
            assert!(speeds.all(|speed| passes(thickness, time_step, speed)));
            // It has to reach the middle of the wall: in a step, or against the spring, which
            // stops a speed v after v √(d/g), with the depth d of 0.05 mm at rest.
            let way = time_step.max((5e-5_f64 / 9.81).sqrt());
            assert!(least * way > 0.5 * thickness);
            least
        });
        let [thin, middle, thick] = least;
        rows.push_str(&format!("| {name} | {thin} | {middle} | {thick} |\n"));
    }
    SPEEDS.has(&rows);
}
