//! Scenes on which the first version of the library broke a promise, as they were found.

use crate::kit::erased::Stepper;
use core::ops::ControlFlow;

use tumble::contract::{self, CheckPlan};
use tumble::glam::{DMat3, DVec3, Vec3};
use tumble::{
    Coin, ContactPoint, ContactRange, Cuboid, DormandPrince54, EnergyMomentum, FlatGround, Flight,
    PointMass, RigidPointBody, Sample, Sphere, SpringDamperGround, State, StrangSplitting, Surface,
    UniformGravity,
};

/// The book turned its velocity into spin: after 5 s the angular momentum was 1.54 times as large.
#[test]
fn a_book_in_free_flight_keeps_both_momenta_in_single_precision() {
    let stepper = Stepper::builder(Cuboid::solid(1.0_f32, Vec3::new(0.3, 0.2, 0.05)))
        .integrator(EnergyMomentum {
            time_step: 1.0_f32 / 60.0,
        })
        .build()
        .unwrap();
    let start = State::at(Vec3::ZERO).with_linear_velocity(Vec3::X * 10.0);
    let start = stepper.with_angular_velocity(start, Vec3::new(9.0, 24.0, 15.0));
    let mut state = start;
    for _ in 0..300 {
        stepper.step(&mut state).unwrap();
    }
    // 1e-5 a second.
    let off = (state.angular_momentum - start.angular_momentum).length();
    assert!(
        off < 5e-5 * start.angular_momentum.length(),
        "{off} kg m²/s"
    );
    assert!((state.linear_velocity - Vec3::X * 10.0).length() < 5e-5 * 10.0);
}

/// The coin kept .86 of its energy after 10 s and .31 after 100 s.
#[test]
fn a_coin_that_bounces_without_losses_keeps_its_energy_in_single_precision() {
    let stepper = Stepper::builder(Coin::ring(1.0_f32, 0.2))
        .gravity(UniformGravity::down(9.8_f32))
        .ground(FlatGround::level(1e5_f32, 0.0))
        .integrator(EnergyMomentum {
            time_step: 1.0_f32 / 60.0,
        })
        .build()
        .unwrap();
    let mut state = stepper.with_angular_velocity(State::at(Vec3::Z), Vec3::new(3.0, 8.0, 5.0));
    let start = stepper.energy(&state).total();
    for _ in 0..6000 {
        stepper.step(&mut state).unwrap();
    }
    let kept = stepper.energy(&state).total() / start;
    assert!((kept - 1.0).abs() < 1e-3, "{kept} of the energy is kept");
}

/// Both ended in `Stalled`.
#[test]
fn flight_around_an_adaptive_method_goes_on() {
    let adaptive = DormandPrince54::new(1e-6);
    let ground = FlatGround::level(1e4, 10.0);
    let ball = Stepper::builder(PointMass::new(1.0))
        .gravity(UniformGravity::down(9.8))
        .ground(ground)
        .integrator(Flight(adaptive))
        .build()
        .unwrap();
    let (mut by_flight, mut by_steps) = (State::at(DVec3::Z), State::at(DVec3::Z));
    ball.advance(&mut by_flight, 1.0).unwrap();
    let without = ball.with_integrator(adaptive).unwrap();
    without.advance(&mut by_steps, 1.0).unwrap();
    // The stated range of the error is ten tolerances.
    assert!((by_flight.position - by_steps.position).length() < 1e-5);

    let pressed_in = Stepper::builder(Sphere::solid(1.0, 0.1))
        .ground(ground)
        .integrator(Flight(adaptive))
        .build()
        .unwrap();
    pressed_in
        .advance(&mut State::at(DVec3::Z * 0.05), 1.0)
        .unwrap();
}

/// The mass fell by 0.31 mm instead of 48.5 m.
#[test]
fn a_mass_far_from_the_origin_falls_in_single_precision() {
    let acceleration = Vec3::new(0.3, 0.2, -0.9);
    let stepper = Stepper::builder(PointMass::new(1.0_f32))
        .gravity(UniformGravity { acceleration })
        .integrator(EnergyMomentum {
            time_step: 1e-4_f32,
        })
        .build()
        .unwrap();
    let start = State::at(Vec3::new(30.0, 70.0, 100.0));
    let mut state = start;
    stepper.advance(&mut state, 10.0).unwrap();
    let fallen = (state.position - start.position).length();
    let exact = 0.5 * acceleration.length() * 100.0;
    assert!((fallen / exact - 1.0).abs() < 1e-3, "{fallen} of {exact} m");
}

/// Springs whose energy `k (eˣ - 1 - x)` is rounded below 0.
struct Exponential {
    stiffness: f32,
}

impl SpringDamperGround<f32> for Exponential {
    fn surface(&self, point: Vec3) -> Surface<f32> {
        Surface {
            gap: point.z,
            normal: Vec3::Z,
        }
    }
    fn spring_force(&self, depth: f32) -> f32 {
        self.stiffness * (depth.exp() - 1.0)
    }
    fn spring_energy(&self, depth: f32) -> f32 {
        self.stiffness * (depth.exp() - 1.0 - depth)
    }
    fn normal_force(&self, depth: f32, _: f32) -> f32 {
        self.spring_force(depth)
    }
}

/// The energy increased.
#[test]
fn a_spring_energy_that_is_rounded_below_zero_adds_no_energy() {
    for number in 0..100_u8 {
        let stepper = Stepper::builder(PointMass::new(0.04_f32))
            .gravity(UniformGravity::down(9.8_f32))
            .ground(Exponential {
                stiffness: 1e5 + 1e4 * f32::from(number),
            })
            .integrator(EnergyMomentum {
                time_step: 0.015_f32,
            })
            .build()
            .unwrap();
        let mut state = State::at(Vec3::Z * 1e-3);
        for step in 0..50 {
            let before = stepper.energy(&state).total();
            stepper.step(&mut state).unwrap();
            let after = stepper.energy(&state).total();
            assert!(after <= before, "{number}, {step}: {before:e} {after:e} J");
        }
    }
}

/// One point, which a contact range of any length may contain.
struct Endless([ContactPoint; 1]);

impl RigidPointBody for Endless {
    fn mass(&self) -> f64 {
        1.0
    }
    fn inertia(&self) -> DMat3 {
        DMat3::IDENTITY
    }
    fn contacts(&self) -> &[ContactPoint] {
        &self.0
    }
    fn contacts_below(&self, _: DVec3, _: f64) -> ContactRange {
        ContactRange {
            first: 0,
            count: usize::MAX,
        }
    }
}

/// The check overflowed.
#[test]
fn a_contact_range_without_end_is_checked_without_a_panic() {
    let body = Endless([ContactPoint::bare(DVec3::X)]);
    contract::check_body(&body, CheckPlan::default()).unwrap();
}

/// The run stopped up to ten steps early.
#[test]
fn a_run_of_ten_million_steps_is_exact_in_single_precision() {
    let stepper = Stepper::builder(PointMass::new(1.0_f32))
        .integrator(StrangSplitting {
            time_step: 1e-3_f32,
        })
        .build()
        .unwrap();
    let mut samples = 0_u32;
    let mut count = |_: &Sample<'_, f32>| {
        samples += 1;
        ControlFlow::Continue(())
    };
    let covered = stepper.run(&mut State::at(Vec3::ZERO), 10_000.0, &mut count);
    assert_eq!(covered.unwrap().to_bits(), 10_000_f32.to_bits());
    assert_eq!(samples, 10_000_001);
}
