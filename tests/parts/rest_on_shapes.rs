//! Bodies that come to rest on ground that is not a plane: a step costs what it costs on a plane.
//!
//! There the normal of a contact is corrected by a difference of gaps over the path, so that the
//! springs' work is exact. For a body at rest that difference is rounding, and the path is almost
//! nothing. When the quotient was used whatever its size, Newton's method did not converge: a step
//! took hundreds of iterations and was marked as a fallback.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::kit;
use crate::kit::erased::Stepper;
use tumble::ground::{Bowl, Terrain, Waves};
use tumble::real::{Real, Vector};
use tumble::{
    Block, Coin, Coulomb, Cuboid, Disc, EnergyMomentum, Ground, RigidPointBody, Rod, SpringDamper,
    SpringDamperGround, State, UniformGravity,
};

/// Steps in 10 s, of which the last are at rest.
const LENGTHS: [f64; 3] = [1.0 / 60.0, 4e-3, 1e-3];
/// Most iterations a step, on average. On a plane these bodies take 1 to 3, and up to 6 on a slope
/// on which they stick.
const MOST_ITERATIONS: f64 = 8.0;
/// Most steps in a thousand that may be marked as fallbacks, for hard impacts.
const MOST_FALLBACKS: f64 = 5.0;

/// Drops a body on a ground, and checks the work of its steps over 10 s.
fn comes_to_rest<R: Real>(
    name: &str,
    body: &impl RigidPointBody<R>,
    ground: &impl SpringDamperGround<R>,
) {
    let number = R::from_f64;
    let vector = |[x, y, z]: [f64; 3]| R::Vec3::new(number(x), number(y), number(z));
    let friction = Coulomb {
        coefficient: number(0.5),
        slip_speed: number(1e-3),
    };
    for seconds in LENGTHS {
        let time_step = number(seconds);
        let stepper = Stepper::<_, R>::new(body)
            .and_then(|stepper| stepper.with_gravity(UniformGravity::down(number(9.81))))
            .and_then(|stepper| stepper.with_ground(ground))
            .and_then(|stepper| stepper.with_friction(friction))
            .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
            .unwrap();
        let mut state = State::at(vector([3.1, -1.9, 2.4]))
            .with_rotation_vector(vector([0.4, -0.2, 0.3]))
            .with_linear_velocity(vector([-0.2, 0.1, 0.0]));
        let steps = (10.0 / seconds).round();
        let (mut iterations, mut fallbacks) = (0.0, 0.0);
        for _ in 0..kit::whole(steps) {
            let step = stepper.step(&mut state).unwrap();
            iterations += f64::from(step.iterations) / steps;
            fallbacks += 1e3 * f64::from(u8::from(step.fallback)) / steps;
        }
        assert!(
            iterations < MOST_ITERATIONS && fallbacks <= MOST_FALLBACKS,
            "{name}, {seconds} s: {iterations} iterations a step, {fallbacks} fallbacks in 1000"
        );
        let springs = stepper.energy(&state).springs;
        assert!(springs > R::ZERO, "{name}, {seconds} s: touches nothing");
    }
}

fn each_comes_to_rest<R: Real>() {
    let number = R::from_f64;
    let law = SpringDamper {
        stiffness: number(8e3),
        damping: number(20.0),
    };
    let centre = R::Vec3::new(number(3.0), number(-2.0), number(1.0));
    let half = R::Vec3::new(number(20.0), number(20.0), number(0.2));
    let block = Ground {
        law,
        shape: Block { centre, half },
    };
    let bowl = Ground {
        law,
        shape: Terrain::of(Bowl {
            curvatures: [number(0.3), number(0.2)],
        }),
    };
    let waves = Ground {
        law,
        shape: Terrain::of(Waves {
            amplitude: number(0.04),
            length: number(1.1),
        }),
    };
    macro_rules! on_each {
        ($name:literal, $body:expr) => {
            let body = $body;
            comes_to_rest(concat!($name, " on a block"), &body, &block);
            comes_to_rest(concat!($name, " in a bowl"), &body, &bowl);
            comes_to_rest(concat!($name, " on waves"), &body, &waves);
        };
    }
    on_each!("cube", Cuboid::cube(number(0.7), number(0.25)));
    on_each!("rod", Rod::new(number(0.7), number(0.4)));
    on_each!("ring", Coin::<R>::ring(number(0.7), number(0.2)));
    on_each!("disc", Disc::solid(number(0.7), number(0.25), 30));
}

#[test]
fn a_resting_step_is_short_in_double_precision() {
    each_comes_to_rest::<f64>();
}

#[test]
fn a_resting_step_is_short_in_single_precision() {
    each_comes_to_rest::<f32>();
}
