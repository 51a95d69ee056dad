//! What one call of [`Stepper::step`] costs for a body at rest, which no session remembers.
//!
//! A body that a step has left where it was may still hang on springs that are much too stiff for
//! the step, so the integrator searches for a motion downhill. For a body whose contacts carry its
//! weight there is none, and the search took up to tens of times the work of a step in motion.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::kit::counting::Counting;
use crate::kit::erased::Stepper;
use tumble::ground::Plane;
use tumble::real::{Real, Vector};
use tumble::{
    Block, Coin, Coulomb, Cuboid, Disc, EnergyMomentum, Ground, RigidPointBody, SpringDamper,
    SpringDamperGround, State, UniformGravity,
};

/// Most steps in motion whose questions a step at rest may ask. Beside a step's own questions it
/// asks whether the body has come to rest, and whether its forces balance. Where a step is long,
/// its first trial is far below the ground, and it needs one evaluation more: a box in `f32` takes
/// 3.04.
const MOST: u32 = 4;

/// Drops a body on a ground, and compares the questions of a step at rest with those of a step in
/// which it slides on the same contacts.
fn costs_little_at_rest<R: Real>(
    name: &str,
    body: &impl RigidPointBody<R>,
    ground: impl SpringDamperGround<R>,
    seconds: f64,
) {
    let number = R::from_f64;
    let vector = |[x, y, z]: [f64; 3]| R::Vec3::new(number(x), number(y), number(z));
    let (friction, time_step) = (
        Coulomb {
            coefficient: number(0.4),
            slip_speed: number(1e-3),
        },
        number(seconds),
    );
    let ground = Counting::new(ground);
    let stepper = Stepper::<_, R>::new(body)
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(number(3.7))))
        .and_then(|stepper| stepper.with_ground(&ground))
        .and_then(|stepper| stepper.with_friction(friction))
        .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
        .unwrap();
    let mut state =
        State::at(vector([0.1, -0.2, 0.4])).with_rotation_vector(vector([0.3, 0.5, -0.1]));
    let until_rest = |mut state: State<R>| {
        let mut calls = Vec::new();
        loop {
            let before = state;
            ground.take();
            stepper.step(&mut state).unwrap();
            let evaluated = ground.take();
            calls.push(evaluated.surfaces + evaluated.laws);
            if state == before {
                return (state, calls);
            }
            assert!(
                calls.len() < 200_000,
                "{name}, {seconds} s: it does not come to rest"
            );
        }
    };
    state = until_rest(state).0;
    // Pushed, it slides on the same contacts.
    let push = vector([0.2, -0.1, 0.0]);
    let (_, calls) = until_rest(state.with_linear_velocity(push));
    let (at_rest, in_motion) = (calls[calls.len() - 1], calls[0]);
    assert!(
        at_rest <= MOST * in_motion,
        "{name}, {seconds} s: {at_rest} questions at rest, {in_motion} in motion"
    );
}

fn each_costs_little_at_rest<R: Real>() {
    let number = R::from_f64;
    let law = SpringDamper {
        stiffness: number(5e3),
        damping: number(30.0),
    };
    let plane = || Ground {
        law,
        shape: Plane::level(number(-0.1)),
    };
    let block = || Ground {
        law,
        shape: Block {
            centre: R::Vec3::ZERO,
            half: R::Vec3::new(number(3.0), number(3.0), number(0.15)),
        },
    };
    macro_rules! on_each {
        ($name:literal, $body:expr) => {
            let body = $body;
            for seconds in [1.0 / 60.0, 3e-3, 5e-4] {
                costs_little_at_rest(concat!($name, " on a plane"), &body, plane(), seconds);
                costs_little_at_rest(concat!($name, " on a block"), &body, block(), seconds);
            }
        };
    }
    on_each!(
        "box",
        Cuboid::solid(
            number(0.9),
            R::Vec3::new(number(0.3), number(0.2), number(0.1))
        )
    );
    on_each!("ring", Coin::<R>::ring(number(0.5), number(0.15)));
    on_each!("disc", Disc::solid(number(0.5), number(0.15), 24));
}

#[test]
fn a_call_at_rest_costs_no_more_than_four_in_motion() {
    each_costs_little_at_rest::<f64>();
}

#[test]
fn a_call_at_rest_costs_no_more_than_four_in_motion_in_single_precision() {
    each_costs_little_at_rest::<f32>();
}
