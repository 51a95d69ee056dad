//! Oblique impacts of bodies in single precision, compared with those in double precision.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use core::f64::consts::FRAC_PI_2;

use crate::kit::erased::Stepper;
use crate::kit::{directions, log_uniform};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use tumble::glam::{DVec3, Vec3};
use tumble::real::{Real, Vector};
use tumble::{
    Capsule, Cone, Coulomb, Cuboid, EnergyMomentum, FlatGround, Ground, Plane, RigidPointBody,
    SlidingFriction, SolidCoin, Sphere, SpringDamper, State, UniformGravity,
};

/// A body that is thrown onto inclined ground, as a strategy draws it.
#[derive(Clone, Debug)]
struct Throw {
    kind: u8,
    normal: DVec3,
    /// rad/s of the spring, 1/s of the damper, of the whole body on one contact.
    law: [f64; 2],
    friction: [f64; 2],
    /// Rotation from which the body starts, rad.
    rotation: DVec3,
    /// m/s, kg m²/s
    velocity: DVec3,
    angular_momentum: DVec3,
}

/// Size of the bodies, m.
const SIZE: f64 = 0.2;

fn throws() -> impl Strategy<Value = Throw> {
    let velocity = (1.0..4.0_f64, directions(), 0.0..2.0_f64);
    (
        0..4_u8,
        directions(),
        (log_uniform(60.0, 300.0), 0.0..20.0_f64),
        (0.2..1.0_f64, log_uniform(1e-7, 1e-4)),
        [directions(), directions()],
        velocity,
    )
        .prop_map(
            |(kind, normal, law, friction, [rotation, momentum], velocity)| {
                let (down, aside, speed) = velocity;
                let along = aside - normal * normal.dot(aside);
                Throw {
                    kind,
                    normal,
                    law: law.into(),
                    friction: friction.into(),
                    rotation: rotation * 2.0,
                    velocity: along * speed - normal * down,
                    angular_momentum: momentum * 0.1,
                }
            },
        )
}

fn body<R: Real>(kind: u8) -> Box<dyn RigidPointBody<R>> {
    let [mass, size] = [1.0, SIZE].map(R::from_f64);
    match kind {
        0 => Box::new(Sphere::solid(mass, size)),
        1 => Box::new(Capsule::solid(mass, size * R::HALF, size)),
        2 => Box::new(Cone::solid(mass, size, size)),
        _ => Box::new(SolidCoin::new(mass, size, size * R::HALF)),
    }
}

impl Throw {
    /// Velocities (m/s, rad/s) at the end of the first contact, and the number of steps in it.
    fn bounced<R: Real>(&self) -> ([DVec3; 2], u32) {
        let vector = |v: DVec3| R::Vec3::new(R::from_f64(v.x), R::from_f64(v.y), R::from_f64(v.z));
        let double = |v: R::Vec3| DVec3::new(v.x().to_f64(), v.y().to_f64(), v.z().to_f64());
        let [rate, damping] = self.law;
        let [coefficient, slip_speed] = self.friction.map(R::from_f64);
        let scene = Stepper::builder(body::<R>(self.kind))
            .ground(Ground {
                law: SpringDamper {
                    stiffness: R::from_f64(rate * rate),
                    damping: R::from_f64(damping),
                },
                shape: Plane::through(R::Vec3::ZERO, vector(self.normal)),
            })
            .friction(Coulomb {
                coefficient,
                slip_speed,
            })
            .gravity(UniformGravity {
                acceleration: vector(self.normal * -9.8),
            })
            .integrator(EnergyMomentum {
                time_step: R::from_f64(1e-3),
            })
            .build()
            .unwrap();
        let mut state = State::<R>::at(vector(self.normal * (1.2 * SIZE)))
            .with_rotation_vector(vector(self.rotation))
            .with_linear_velocity(vector(self.velocity))
            .with_angular_momentum(vector(self.angular_momentum));
        let mut steps = 0;
        for _ in 0..500 {
            scene.step(&mut state).unwrap();
            if scene.touching(&state) > 0 {
                steps += 1;
            } else if steps > 0 {
                break;
            }
        }
        let spin = scene.angular_velocity(&state);
        ([double(state.linear_velocity), double(spin)], steps)
    }

    /// Error of the velocities in single precision as a fraction of the speed of the impact. `None`
    /// if the contact ends in another step.
    fn error(&self) -> Option<f64> {
        let (single, steps) = self.bounced::<f32>();
        let (double, same_steps) = self.bounced::<f64>();
        let [linear, angular] = [0, 1].map(|i| (single[i] - double[i]).length());
        let speed = self.velocity.length();
        (steps == same_steps).then(|| (linear + angular * SIZE) / speed)
    }
}

/// 400 throws, of bodies other than those on which the resolution of the slip was chosen. Of 20,000
/// throws, the errors of 0.2 % are above 1e-2, and of 16 % without the resolution. The test rejects
/// a part of 3 % with 99 %.
#[test]
fn friction_of_an_impact_has_its_direction_in_single_precision() {
    let mut runner = TestRunner::deterministic();
    let draw = throws();
    let errors: Vec<f64> = (0..400)
        .filter_map(|_| draw.new_tree(&mut runner).unwrap().current().error())
        .collect();
    let wrong = errors.iter().filter(|&&error| error > 1e-2).count();
    assert!(errors.len() > 390, "{} end in the same step", errors.len());
    assert!(wrong <= 4, "{wrong} have an error above 1e-2");
}

/// A body that lands flat and obliquely, so that all contacts of a face slide in the same way.
#[derive(Clone, Debug)]
struct FlatLanding {
    is_round: bool,
    /// m
    size: f64,
    /// Spring and damper of a contact: `h √(K/m)` for the face, and its damping ratio.
    law: [f64; 2],
    friction: [f64; 2],
    velocity: DVec3,
    /// Height above the ground, in steps of the fall.
    height: f64,
    /// s
    step: f64,
}

fn flat_landings() -> impl Strategy<Value = FlatLanding> {
    let law = (log_uniform(0.3, 3.0), 0.1..0.9_f64);
    let friction = (0.2..0.9_f64, log_uniform(1e-5, 1e-4));
    let velocity = (directions(), 0.8..0.97_f64, 1.0..4.0_f64);
    let step = (0.0..1.0_f64, log_uniform(1e-3, 1.0 / 60.0));
    let body = (any::<bool>(), log_uniform(0.01, 0.3));
    (body, law, friction, velocity, step).prop_map(
        |((is_round, size), law, friction, (aside, down, speed), (height, step))| {
            let along = DVec3::new(aside.x, aside.y, 0.0).normalize_or(DVec3::X);
            FlatLanding {
                is_round,
                size,
                law: law.into(),
                friction: friction.into(),
                velocity: (along * (1.0 - down * down).sqrt() - DVec3::Z * down) * speed,
                height,
                step,
            }
        },
    )
}

impl FlatLanding {
    /// The scene, its start, and four steps from there: velocities, m/s.
    fn velocities<R: Real>(&self) -> [DVec3; 4] {
        let real = R::from_f64;
        let half = self.size * 0.4;
        let (body, contacts): (Box<dyn RigidPointBody<R>>, f64) = if self.is_round {
            let coin = SolidCoin::new(R::ONE, real(self.size), real(2.0 * half));
            (Box::new(coin), 120.0)
        } else {
            let edges = [self.size, self.size * 0.7, half].map(|edge| real(2.0 * edge));
            let [x, y, z] = edges;
            (Box::new(Cuboid::solid(R::ONE, R::Vec3::new(x, y, z))), 4.0)
        };
        let [phase, ratio] = self.law;
        let rate = phase / self.step;
        let [coefficient, slip_speed] = self.friction.map(real);
        let law = [rate * rate, 2.0 * ratio * rate].map(|of_all| real(of_all / contacts));
        let scene = Stepper::builder(body)
            .gravity(UniformGravity::down(real(9.81)))
            .ground(FlatGround::level(law[0], law[1]))
            .friction(Coulomb {
                coefficient,
                slip_speed,
            })
            .integrator(EnergyMomentum {
                time_step: real(self.step),
            })
            .build()
            .unwrap();
        let [x, y, z] = self.velocity.to_array().map(real);
        let height = half + self.height * self.step * self.velocity.z.abs();
        // The axis of a coin is its x axis.
        let flat = if self.is_round { FRAC_PI_2 } else { 0.0 };
        let mut state = State::<R>::at(R::Vec3::new(R::ZERO, R::ZERO, real(height)))
            .with_rotation_vector(R::Vec3::new(R::ZERO, real(flat), R::ZERO))
            .with_linear_velocity(R::Vec3::new(x, y, z));
        [(); 4].map(|()| {
            scene.step(&mut state).unwrap();
            let v = state.linear_velocity;
            DVec3::new(v.x().to_f64(), v.y().to_f64(), v.z().to_f64())
        })
    }

    /// Largest error of the velocity in single precision, as a fraction of the speed.
    fn error(&self) -> f64 {
        let [single, double] = [self.velocities::<f32>(), self.velocities::<f64>()];
        let errors = single
            .iter()
            .zip(double)
            .map(|(one, other)| (*one - other).length());
        errors.fold(0.0, f64::max) / self.velocity.length()
    }
}

/// 400 landings. As long as the strain of friction was that before the last step of Newton's
/// method, a slide that this step ended went on, and 313 of 10,000 such landings had an error above
/// 1e-2, in place of 10. The test rejects 313 with 99 %.
#[test]
fn a_slide_ends_in_an_impact_in_single_precision() {
    let mut runner = TestRunner::deterministic();
    let draw = flat_landings();
    let errors = (0..400).map(|_| draw.new_tree(&mut runner).unwrap().current().error());
    let wrong = errors.filter(|&error| error > 1e-2).count();
    assert!(wrong <= 4, "{wrong} have an error above 1e-2");
}

/// A film of oil, as in the documentation of `SlidingFriction`: without derivatives of its own.
struct Oil;

impl SlidingFriction<f32> for Oil {
    fn force(&self, _: f32, slip: Vec3) -> Vec3 {
        -slip * 0.5
    }
}

/// Case: a ball that spins on the spot and slides slowly on oil. The slip is far below the
/// resolution for its spin, but the law is linear, so that it stays as it is: `e^(-7/2 c t/m)`.
#[test]
fn oil_rubs_a_ball_that_spins_in_single_precision() {
    let (radius, speed) = (0.1, 1e-4);
    let scene = tumble::Stepper::builder(Sphere::solid(1.0_f32, radius))
        .gravity(UniformGravity::down(9.8))
        .ground(FlatGround::level(1e4, 20.0))
        .friction(Oil)
        .integrator(EnergyMomentum { time_step: 1e-3 })
        .build()
        .unwrap();
    let start = State::<f32>::at(Vec3::Z * (radius - 9.8e-4)).with_linear_velocity(Vec3::X * speed);
    let mut state = scene.with_angular_velocity(start, Vec3::Z * 100.0);
    scene.advance(&mut state, 0.1).unwrap();
    // Friction decelerates the ball, and turns it until it rolls at 5/7 of its speed.
    let expected = speed * (5.0 + 2.0 * (-3.5 * 0.5 * 0.1_f32).exp()) / 7.0;
    let off = (state.linear_velocity.x / expected - 1.0).abs();
    assert!(off < 1e-3, "{off:e}");
}
