//! Common scenes of several groups.

use core::f64::consts::FRAC_PI_2;

use tumble::glam::{DMat3, DVec3};
use tumble::{
    FlatGround, MassProperties, Rk4, SlidingFriction, Sphere, SpringDamperGround, State,
    UniformGravity,
};

use crate::kit::erased::Stepper;
use crate::kit::point_mass;

/// A single point under gravity on a ground, moved on by Runge-Kutta in steps of a given length.
pub(crate) fn move_point(
    [mass, g]: [f64; 2],
    ground: impl SpringDamperGround,
    friction: impl SlidingFriction,
    state: &mut State,
    [seconds, time_step]: [f64; 2],
) {
    Stepper::new(point_mass(mass))
        .unwrap()
        .with_gravity(UniformGravity::down(g))
        .unwrap()
        .with_ground(ground)
        .unwrap()
        .with_friction(friction)
        .unwrap()
        .with_integrator(Rk4 { time_step })
        .unwrap()
        .advance(state, seconds)
        .unwrap();
}

/// A coin flat on the ground at a height.
pub(crate) fn flat(height: f64) -> State {
    State::at(DVec3::Z * height).with_rotation_vector(DVec3::Y * FRAC_PI_2)
}

/// A ground whose springs oscillate with `mass` on `count` contacts by 0.3 rad in a step, without
/// dampers: a stiffness that Runge-Kutta resolves easily.
pub(crate) fn ground_for(time_step: f64, mass: f64, count: usize) -> FlatGround {
    FlatGround::level(mass * (0.3 / time_step).powi(2) / count as f64, 0.0)
}

/// A ball of 1 kg with `moment` times `m r²` about every axis: 2/5 for a solid ball, 2/3 for a
/// shell, 1/2 and 1 for what rolls as a disc and a hoop do.
pub(crate) fn ball(moment: f64, radius: f64) -> Sphere {
    Sphere::loaded(
        radius,
        MassProperties {
            mass: 1.0,
            centre_of_mass: DVec3::ZERO,
            inertia: DMat3::from_diagonal(DVec3::splat(moment * radius * radius)),
        },
    )
}
