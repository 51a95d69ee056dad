//! Energy audit of bodies that stick and rest, with slip speeds that no step resolves.
//!
//! A body that comes to rest on a level plane has dissipated all the energy that it has lost. At
//! rest it moves no further, so the audit must not change any more.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use tumble::glam::DVec3;
use tumble::{
    Coin, ContactPoint, Coulomb, Cuboid, Disc, Energy, FlatGround, Ledger, RigidPointBody, State,
    Stepper, UniformGravity,
};

/// Slip speeds far below the change of the velocity in one step, m/s.
const SLIP_SPEEDS: [f64; 3] = [1e-6, 1e-8, 1e-10];

/// Audits a body that is dropped and slides to rest in 6 s, and then for 2 s at rest.
fn audit<B: RigidPointBody>(name: &str, body: B, slip_speed: f64) {
    let mass = body.mass();
    let reach = body.bounding_radius();
    let springs = mass * 2000.0; // N/m a point: tenths of a millimetre at rest
    let stepper = Stepper::new(body)
        .and_then(|scene| scene.with_gravity(UniformGravity::down(9.81)))
        .and_then(|scene| scene.with_ground(FlatGround::level(springs, mass * 4.0)))
        .and_then(|scene| {
            scene.with_friction(Coulomb {
                coefficient: 0.4,
                slip_speed,
            })
        })
        .unwrap();
    let mut state = State::at(DVec3::Z * (0.6 * reach))
        .with_rotation_vector(DVec3::new(0.3, -0.2, 0.5))
        .with_linear_velocity(DVec3::new(0.4, 0.1, 0.0));
    let mut ledger = Ledger::new();
    stepper.run(&mut state, 6.0, &mut ledger).unwrap();
    let lost = ledger.start().total() - ledger.now().total();
    let (work, energy_error) = (ledger.work(), ledger.energy_error());
    assert!(
        energy_error.abs() < 0.02 * lost,
        "{name}, slip speed {slip_speed:e} m/s: {energy_error:e} of {lost:e} J unexplained"
    );

    let at_rest = Energy::of(stepper.scene(), &state);
    assert_eq!(
        state.linear_velocity,
        DVec3::ZERO,
        "{name} {slip_speed:e}: not at rest"
    );
    stepper.run(&mut state, 2.0, &mut ledger).unwrap();
    assert_eq!(stepper.energy(&state), at_rest);
    assert_eq!(
        (ledger.work(), ledger.energy_error()),
        (work, energy_error),
        "{name}, slip speed {slip_speed:e} m/s: the audit of a body at rest goes on"
    );
}

#[test]
fn the_audit_of_a_body_that_sticks_and_rests_explains_its_energy() {
    for slip_speed in SLIP_SPEEDS {
        audit(
            "ring",
            Coin::ring_with_storage([ContactPoint::default(); 36], 0.2, 0.1),
            slip_speed,
        );
        audit("disc", Disc::solid(0.1, 0.05, 36), slip_speed);
        audit(
            "cuboid",
            Cuboid::solid(0.5, DVec3::new(0.1, 0.08, 0.03)),
            slip_speed,
        );
    }
}
