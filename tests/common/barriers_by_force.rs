//! Least energy on the boundary of a face, by brute force.
//!
//! The test `physics` and the example `known_outcomes` share the file by `#[path]`.

// Each user of the file calls another part of it, and an invalid scene is an error of this file.
#![allow(dead_code, clippy::unwrap_used)]

use core::f64::consts::TAU;
use tumble::glam::{DQuat, DVec3};
use tumble::{
    Basin, Faces, FlatGround, Frictionless, HullFace, RigidPointBody, SpringDamperGround, State,
    Stepper, UniformGravity,
};

use super::decided_states::{Draw, GRAVITY};

pub(crate) type Level<B, G> = Stepper<B, G, Frictionless, UniformGravity>;

pub(crate) fn on<B: RigidPointBody, G: SpringDamperGround>(body: B, ground: G) -> Level<B, G> {
    Stepper::new(body)
        .unwrap()
        .with_gravity(UniformGravity::down(GRAVITY))
        .unwrap()
        .with_ground(ground)
        .unwrap()
}

/// Least potential energy over all heights with the body direction `down` pointing down, J.
pub(crate) fn least_energy<B: RigidPointBody, G: SpringDamperGround>(
    stepper: &Level<B, G>,
    down: DVec3,
) -> f64 {
    let orientation = DQuat::from_rotation_arc(down, -DVec3::Z);
    let top = stepper.body().support(down);
    let energy = |depth: f64| {
        let state = State::at(DVec3::Z * (top - depth)).with_orientation(orientation);
        stepper.energy(&state).total()
    };
    // The energy is convex in the height: golden section.
    let (mut low, mut high) = (0.0, top);
    let part = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..80 {
        let (a, b) = (high - part * (high - low), low + part * (high - low));
        if energy(a) < energy(b) {
            high = b;
        } else {
            low = a;
        }
    }
    energy(0.5 * (low + high))
}

/// The direction on the boundary of a face, on the great circle from a direction inside it to one
/// outside.
fn boundary(is_inside: impl Fn(DVec3) -> bool, inside: DVec3, outside: DVec3) -> DVec3 {
    let (mut near, mut far) = (inside, outside);
    for _ in 0..45 {
        let middle = (near + far).normalize();
        if is_inside(middle) {
            near = middle;
        } else {
            far = middle;
        }
    }
    near
}

/// Whether a direction is in a face of a body, by a query of the body.
pub(crate) fn by_query<B: Faces>(body: &B, face: &B::Face, down: DVec3) -> bool {
    body.basin(down).is_some_and(|basin| basin.face == *face)
}

/// Whether a direction is in a facet of a body, by the cone over its three corners. A query of the
/// hull costs a hundred times as much.
pub(crate) fn by_cone<B: RigidPointBody>(body: &B, face: &HullFace, down: DVec3) -> bool {
    let [a, b, c] = face.contacts.map(|number| body.contacts()[number].position);
    let sides = [a.cross(b), b.cross(c), c.cross(a)].map(|side| side.dot(down) >= 0.0);
    // The order of the corners about the facet's normal is not known.
    sides == [a.cross(b).dot(c) >= 0.0; 3]
}

/// Angle of the least height between `best - part` and `best + part`, where the height has a sharp
/// minimum: golden section.
fn lowest_near(best: f64, part: f64, height: impl Fn(f64) -> f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (best - part, best + part);
    let inner = |low: f64, high: f64| [high - golden * (high - low), low + golden * (high - low)];
    let [mut left, mut right] = inner(low, high);
    let (mut at_left, mut at_right) = (height(left), height(right));
    for _ in 0..40 {
        if at_left < at_right {
            (high, right, at_right) = (right, left, at_left);
            left = inner(low, high)[0];
            at_left = height(left);
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = inner(low, high)[1];
            at_right = height(right);
        }
    }
    0.5 * (low + high)
}

/// Barriers of random bodies against the least energy on the boundary, found by brute force: none
/// is above it. Returns whether there was a face, and whether its bound is sharp but for the
/// softness.
pub(crate) fn barriers_hold<B: Faces>(
    body: B,
    radius: f64,
    draw: &mut Draw,
    is_in: impl Fn(&B, &B::Face, DVec3) -> bool,
) -> (u32, u32) {
    let weight = body.mass() * GRAVITY;
    let ground = FlatGround::level(weight / (3e-3 * radius), 0.0);
    let stepper = on(body, ground);
    let (body, barriers) = (stepper.body(), stepper.barriers().unwrap());
    let inside = draw.direction();
    // The centre of mass of a flat body may be outside it.
    let Some(basin): Option<Basin<_>> = body.basin(inside) else {
        return (0, 0);
    };
    let across = inside.any_orthonormal_vector();
    let ridge = |angle: f64| {
        // The directions of a face lie within half a sphere, so that the opposite is outside.
        let outside = DQuat::from_axis_angle(inside, angle) * across * 0.1 - inside;
        boundary(
            |down| is_in(body, &basin.face, down),
            inside,
            outside.normalize(),
        )
    };
    let height = |angle: f64| body.support(ridge(angle));
    let part = TAU / 60.0;
    let around = (0..60).map(|step| part * f64::from(step));
    let around = around.map(|angle| (angle, height(angle)));
    let best = around.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap().0;
    let lowest = ridge(lowest_near(best, part, height));
    let beside = |shift: f64| (lowest + inside * shift).normalize();
    assert!(by_query(body, &basin.face, beside(1e-6)), "{basin:?}");
    assert!(!by_query(body, &basin.face, beside(-1e-6)), "{basin:?}");
    let (height, energy) = (body.support(lowest), least_energy(&stepper, lowest));
    assert!(
        height >= basin.height * (1.0 - 1e-11),
        "{basin:?}, {height}"
    );
    let barrier = barriers.barrier(&basin);
    assert!(energy >= barrier, "{basin:?}, {energy} {barrier}");
    let is_sharp = energy - barrier <= 1.01 * barriers.softness();
    (1, u32::from(is_sharp))
}
