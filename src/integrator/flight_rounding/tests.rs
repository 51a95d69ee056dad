//! What the search changes, and what it leaves as it is.

#![allow(clippy::float_cmp, reason = "what is not changed has the same bits")]

use super::*;
use crate::{Frictionless, Gravity, NoGravity, NoGround, Scene, Sphere, UniformGravity};
use glam::{DVec3, Vec3};

type Balls<A, R> = Scene<Sphere<R>, NoGround, Frictionless, A, R>;

fn ball<R: Real, A: Gravity<R>>(gravity: A) -> Balls<A, R> {
    let [mass, radius] = [2.0, 0.5].map(R::from_f64);
    Scene::new(Sphere::solid(mass, radius), NoGround, Frictionless, gravity).unwrap()
}

/// Looks for an end with the energy of the start, which is `gain` times that of the end.
fn found_in_single<A: Gravity<f32>>(gravity: A, gain: f32) -> [State<f32>; 2] {
    let scene = ball::<f32, A>(gravity);
    let start = State::at(Vec3::new(1.0, 2.0, 3.0)).with_linear_velocity(Vec3::new(3.0, 1.0, -2.0));
    let end = State::at(Vec3::new(1.03, 2.01, 2.98)).with_linear_velocity(start.linear_velocity);
    let after = Energy::of(&scene, &end);
    let before = Energy {
        translation: after.translation * gain,
        ..after
    };
    let (found, energy) = rounded(&scene, (&start, &before), (&end, &after)).unwrap();
    assert!(energy.total() <= before.total());
    [end, found]
}

#[test]
fn a_body_without_gravity_keeps_its_velocity() {
    let [end, found] = found_in_single(NoGravity, 1.0 + 4.0 * f32::EPSILON);
    assert_eq!(end, found);
}

#[test]
fn a_loss_of_more_than_rounding_is_not_restored() {
    let gravity = UniformGravity::down(9.8_f32);
    let [end, found] = found_in_single(gravity, 1.01);
    assert_eq!(end, found);
}

/// In contact up to 1e5 units in the last place of a kinetic energy count as rounding.
#[test]
fn in_contact_velocities_take_at_most_the_stated_fraction_of_their_energy() {
    let scene = ball::<f64, _>(NoGravity);
    let end = State::at(DVec3::ZERO).with_linear_velocity(DVec3::new(3.0, 1.0, -2.0));
    let after = Energy::of(&scene, &end);
    let taken = |units: f64| {
        let before = Energy {
            translation: after.translation * (1.0 - units * f64::EPSILON),
            ..after
        };
        rounded_in_contact(&scene, &before, (&end, &after)).map(|(state, _)| state)
    };
    let slower = taken(0.99e5).unwrap();
    assert!(slower.linear_velocity.x < 3.0);
    assert!(taken(1.01e5).is_none());
}

/// The rounding `lever ε` of the potential energy is doubled until it exceeds the excess.
#[test]
fn a_body_without_another_end_sinks_by_the_rounding_of_its_potential_energy() {
    let gravity = DVec3::new(0.0, -3.0, -4.0);
    let scene = ball::<f64, _>(UniformGravity {
        acceleration: gravity,
    });
    let end = State::at(DVec3::new(1.0, 2.0, 30.0));
    let after = Energy::of(&scene, &end);
    let unit = 1e6 * f64::EPSILON;
    for (units, doublings) in [(0.9, 0), (3.0, 2), (15.0, 4)] {
        let before = Energy {
            translation: -units * unit,
            ..after
        };
        let mut search = Search::new(&scene, &before, &end, &after);
        search.sink(1e6);
        let (sunk, _) = search.best.unwrap();
        // The energy `m |g| s` of the path s along gravity.
        let path = (sunk.position - end.position).dot(gravity) / 5.0;
        let expected = unit * f64::from(1 << doublings) / (2.0 * 5.0);
        assert!((path / expected - 1.0).abs() < 1e-3, "{path:e}");
        assert!((sunk.position - end.position).length() < 1.001 * expected);
    }
    let before = Energy {
        translation: -17.0 * unit,
        ..after
    };
    let mut search = Search::new(&scene, &before, &end, &after);
    search.sink(1e6);
    assert!(search.best.is_none());
}

#[test]
fn a_component_along_gravity_is_solved_for_whichever_it_is() {
    let state = State::at(DVec3::new(1.0, 2.0, 3.0));
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        for trial in 1..4 {
            let (gravity, slope) = (axis * -10.0, axis * 20.0);
            let excess = 8.0 * f64::EPSILON;
            let end = solved((&state, Adjusted::Position), gravity, slope, excess, trial).unwrap();
            let expected = state.position - axis * (excess / 20.0);
            assert_eq!(end.position, expected, "{axis} {trial}");
        }
    }
}

/// The finaliser of MurmurHash3 makes `514E28B7` of 1 (Appleby 2011).
#[test]
fn the_random_sequence_is_scrambled_by_a_published_function() {
    let mut seed = 1_u32.wrapping_sub(0x9e37_79b9);
    assert_eq!(scrambled(&mut seed), 0x514e_28b7);
    assert_eq!(seed, 1);
}
