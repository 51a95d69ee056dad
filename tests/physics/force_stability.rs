//! The longest stable step of explicit methods under an applied force, from both sides, and between
//! surfaces whose dampers differ.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::growth::{factor_of_a_step, growing_from};
use crate::kit::each_explicit;
use crate::kit::erased::Stepper;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use tumble::glam::{DQuat, DVec3};
use tumble::{
    AirDrag, Cuboid, EnergyMomentum, FlatGround, Force, Ground, Integrator, Motion, Plane,
    PointMass, Sphere, SpinDrag, SpringDamper, State, SymplecticEuler, UniformGravity, Wrench,
};

/// A spring to the origin and a damper that holds the position, and a torsion spring that holds the
/// orientation. A body that moves feels a torque, and one that turns a force, so both are coupled.
#[derive(Clone, Copy)]
struct Mount {
    /// N/m along each axis.
    stiffness: DVec3,
    /// N s/m along each axis.
    damping: DVec3,
    /// N m/rad.
    torsion: f64,
    /// Lever arm of the damper, m, body axes.
    arm: DVec3,
}

impl Force for Mount {
    fn wrench(&self, motion: &Motion) -> Wrench {
        let arm = motion.axes.to_world(self.arm);
        let damper = -self.damping * motion.velocity_at(arm);
        // For a small rotation the sum of e × e' over the axes is twice its vector.
        let turned: DVec3 = (DVec3::AXES.iter())
            .map(|&axis| axis.cross(motion.axes.to_world(axis)))
            .sum();
        Wrench {
            force: damper - self.stiffness * motion.position,
            torque: arm.cross(damper) - turned * (0.5 * self.torsion),
        }
    }
    fn is_passive(&self) -> bool {
        false
    }
}

fn near(limit: Option<f64>, expected: f64) -> bool {
    (limit.unwrap() / expected - 1.0).abs() < 1e-5
}

/// A force with the damping rate δ, or with the square κ of a frequency, has the limit of the
/// method for (κ, δ): here in closed form for each force.
#[test]
fn a_force_in_flight_has_the_limit_of_its_rate() {
    let (mass, radius) = (0.3, 0.05);
    let inertia = 0.4 * mass * radius * radius;
    let moving = State::at(DVec3::Z).with_linear_velocity(DVec3::new(3.0, 0.0, -4.0)); // 5 m/s
    let spinning = State::at(DVec3::Z).with_angular_momentum(DVec3::X * inertia * 7.0); // 7 rad/s
    let still = Mount {
        stiffness: DVec3::ZERO,
        damping: DVec3::ZERO,
        torsion: 0.0,
        arm: DVec3::ZERO,
    };
    let spring = Mount {
        stiffness: DVec3::new(20.0, 90.0, 50.0),
        ..still
    };
    let torsion = Mount {
        torsion: 0.02,
        ..still
    };
    // Quadratic drag along the velocity: d(c v²)/dv = 2 c v, with c = cd ρ A/2.
    let area = 0.02;
    let quadratic = AirDrag::quadratic(0.5, area, 1.2);
    let per_speed = 0.5 * 0.5 * area * 1.2;
    let far = State::at(DVec3::X * 1e5);
    let cases: [(&str, &dyn Force, State, [f64; 2]); 6] = [
        ("linear", &AirDrag::linear(0.6), moving, [0.0, 0.6 / mass]),
        (
            "quadratic",
            &quadratic,
            moving,
            [0.0, 10.0 * per_speed / mass],
        ),
        (
            "spin",
            &SpinDrag::linear(1e-3),
            spinning,
            [0.0, 1e-3 / inertia],
        ),
        ("spring", &spring, State::default(), [90.0 / mass, 0.0]),
        ("torsion", &torsion, State::default(), [0.02 / inertia, 0.0]),
        ("torsion far away", &torsion, far, [0.02 / inertia, 0.0]),
    ];
    for (name, force, state, [stiffness, damping]) in cases {
        each_explicit!(1e-3, |integrator, method| {
            let stepper = Stepper::new(Sphere::solid(mass, radius))
                .and_then(|stepper| stepper.with_integrator(integrator))
                .unwrap();
            assert_eq!(
                stepper.largest_stable_step(&state),
                None,
                "{name}, {method}"
            );
            let limit = stepper
                .with_force(force)
                .unwrap()
                .largest_stable_step(&state);
            let expected = Integrator::<f64>::largest_stable_step(&integrator, stiffness, damping);
            let expected = expected.unwrap();
            if expected > 0.0 {
                assert!(
                    near(limit, expected),
                    "{name}, {method}: {limit:?}, not {expected}"
                );
            } else {
                assert_eq!(limit, Some(0.0), "{name}, {method}");
            }
        });
    }
}

/// The damping of a force counts while the body is at rest and the force is not, and so does its
/// stiffness for a point in equilibrium at the origin.
#[test]
fn a_force_has_its_rates_on_a_body_at_rest() {
    let mount = Mount {
        stiffness: DVec3::splat(1000.0),
        damping: DVec3::splat(100.0),
        torsion: 0.0,
        arm: DVec3::ZERO,
    };
    each_explicit!(1e-3, |integrator, method| {
        let stepper = Stepper::new(PointMass::new(1.0))
            .and_then(|stepper| stepper.with_integrator(integrator))
            .and_then(|stepper| stepper.with_force(mount))
            .unwrap();
        let expected = Integrator::<f64>::largest_stable_step(&integrator, 1000.0, 100.0).unwrap();
        for place in [DVec3::ZERO, DVec3::ONE] {
            let limit = stepper.largest_stable_step(&State::at(place)).unwrap();
            assert!(
                (0.5..1.001).contains(&(limit / expected)),
                "{method} at {place}: {limit}, not {expected}"
            );
        }
    });
}

/// Forces on a brick with and without ground: below the limit no disturbance grows, above it one
/// does. A disturbance that stays has a factor of 1.
#[test]
fn steps_are_stable_below_the_limit_of_a_force_and_grow_above_it() {
    let brick = Cuboid::solid(1.0, DVec3::new(0.5, 0.3, 0.2));
    let damper = Mount {
        stiffness: DVec3::ZERO,
        damping: DVec3::new(300.0, 100.0, 40.0),
        torsion: 0.0,
        arm: DVec3::new(0.1, -0.05, 0.08),
    };
    let mount = Mount {
        stiffness: DVec3::new(3e3, 500.0, 8e3),
        damping: DVec3::new(2.0, 5.0, 1.0),
        torsion: 30.0,
        ..damper
    };
    // The brick rests on its four lower corners, with 98 N on springs of 4000 N/m each.
    let resting = State::at(DVec3::Z * (0.1 - 98.0 / 16e3));
    let leaning = State::default().with_orientation(DQuat::from_axis_angle(DVec3::X, 0.02));
    for (name, force, start, has_ground) in [
        ("damper", damper, State::at(DVec3::Z), false),
        ("mount", mount, leaning, false),
        ("damper on ground", damper, resting, true),
    ] {
        each_explicit!(1e-3, |integrator, method| {
            let of_ground = |value: f64| if has_ground { value } else { 0.0 };
            let stepper = Stepper::new(brick)
                .and_then(|stepper| {
                    stepper.with_ground(FlatGround::level(of_ground(4e3), of_ground(1.0)))
                })
                .and_then(|stepper| stepper.with_gravity(UniformGravity::down(of_ground(98.0))))
                .and_then(|stepper| stepper.with_integrator(integrator))
                .unwrap();
            let stepper = stepper.with_force(force).unwrap();
            let limit = stepper.largest_stable_step(&start).unwrap();
            let factor = |part: f64| {
                let exact = crate::kit::with_time_step(integrator, limit * part);
                let stepper = stepper.with_integrator(exact).unwrap();
                factor_of_a_step(
                    |state| {
                        stepper.step(state).unwrap();
                    },
                    &start,
                    limit,
                )
            };
            // Explicit Euler has no stable step for a motion without damping. It and Nyström's
            // method amplify one with weak damping by little.
            let is_euler = method == "ForwardEuler";
            if limit > 0.0 {
                let (part, growth) = match method {
                    "ForwardEuler" => (3.0, 1.0004),
                    "Nystrom" => (1.03, 1.001),
                    _ => (1.03, 1.05),
                };
                let [below, above] = [factor(0.97), factor(part)];
                assert!(
                    below < 1.002,
                    "{name}, {method}: grows by {below} below {limit:e} s"
                );
                // With springs and dampers of the ground the limit may be shorter than needed:
                // explicit Euler's is that of the least damped motion with the stiffest spring.
                if !has_ground {
                    assert!(
                        above > growth,
                        "{name}, {method}: {above} above {limit:e} s"
                    );
                } else if !is_euler {
                    let from = growing_from(factor);
                    assert!(
                        from <= 1.2,
                        "{name}, {method}: from {from} of {limit:e} s only"
                    );
                }
            }
        });
    }
}

/// Drag shortens the limit of a body that touches. A weak drag shortens it by little.
#[test]
fn drag_adds_to_the_contacts() {
    let ball = Sphere::solid(1.0, 0.1);
    let state = State::at(DVec3::Z * 0.099);
    let limit = |drag: f64| {
        Stepper::new(ball)
            .and_then(|stepper| stepper.with_ground(FlatGround::level(1e4, 0.0)))
            .and_then(|stepper| stepper.with_integrator(SymplecticEuler { time_step: 1e-3 }))
            .and_then(|stepper| stepper.with_force(AirDrag::linear(drag)))
            .unwrap()
            .largest_stable_step(&state)
    };
    // Without damping 2/ω. With it, the step that turns `1 - h δ` and `h² κ` to a factor of -1.
    let expected =
        |damping: f64| SymplecticEuler { time_step: 1e-3 }.largest_stable_step(1e4, damping);
    for damping in [1e-6, 1.0, 30.0, 300.0, 3000.0] {
        assert!(
            near(limit(damping), expected(damping).unwrap()),
            "{damping}"
        );
    }
    assert!(limit(300.0) < limit(1.0));
}

/// A ball without friction between two planes at right angles has a motion along each normal, with
/// the spring and the damper of its plane. So the limit is the smaller of two scalar limits. In
/// some half of the 200 pairs of laws, the softer plane is the less damped one.
#[test]
fn the_motion_with_the_least_damping_bounds_the_step_between_two_planes() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut ranged = |low: f64, high: f64| {
        low * (high / low).powf(f64::from(random.next_u32()) / f64::from(u32::MAX))
    };
    let mass = 1.3;
    for _ in 0..200 {
        let laws = [0, 1].map(|_| {
            let stiffness = ranged(1e3, 1e5);
            SpringDamper {
                stiffness,
                damping: ranged(1e-4, 1.0) * (stiffness * mass).sqrt(),
            }
        });
        let [a, b] = laws;
        let wall = |law: SpringDamper, x: f64| {
            let shape = Plane::through(DVec3::ZERO, DVec3::new(x, 0.0, 1.0));
            Ground { law, shape }
        };
        let ground = (wall(a, 0.8), wall(b, -1.25));
        // In contact with both planes, and not moving.
        let depth = ranged(1e-5, 1e-3);
        let normals = [0.8, -1.25].map(|x: f64| DVec3::new(x, 0.0, 1.0).normalize());
        let state = State::at((normals[0] + normals[1]) * (0.1 - depth));
        each_explicit!(1e-3, |integrator, method| {
            let stepper = Stepper::new(Sphere::solid(mass, 0.1))
                .and_then(|stepper| stepper.with_ground(ground))
                .and_then(|stepper| stepper.with_integrator(integrator))
                .unwrap();
            let limit = stepper.largest_stable_step(&state).unwrap();
            let of = |law: SpringDamper| {
                let rates = [law.stiffness / mass, law.damping / mass];
                Integrator::<f64>::largest_stable_step(&integrator, rates[0], rates[1]).unwrap()
            };
            let expected = of(a).min(of(b));
            let share = limit / expected;
            assert!(
                share < 1.0 + 1e-4,
                "{method}: {limit:e} s, not {expected:e} s, {laws:?}"
            );
            assert!(share > 0.8, "{method}: only {share} of it, {laws:?}");
        });
    }
}

/// A plate on its four lower corners moves up and down, and rocks about two axes. A softer motion
/// may have a smaller limit than a stiffer one: with `Nystrom` that of 0.91 of the stiffness is 6 %
/// below, at a damping ratio of 0.63.
#[test]
fn the_motion_with_the_smallest_limit_bounds_the_step_of_a_plate() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut ranged = |low: f64, high: f64| {
        low * (high / low).powf(f64::from(random.next_u32()) / f64::from(u32::MAX))
    };
    for _ in 0..400 {
        let mass = 1.3;
        let sides = DVec3::new(ranged(0.1, 1.0), ranged(0.1, 1.0), ranged(0.01, 0.1));
        let stiffness = ranged(1e3, 1e5);
        let per_stiffness = ranged(1e-4, 1.0) * (mass / stiffness).sqrt();
        let stepper = Stepper::new(Cuboid::solid(mass, sides))
            .and_then(|stepper| {
                stepper.with_ground(FlatGround::level(stiffness, per_stiffness * stiffness))
            })
            .unwrap();
        let state = State::at(DVec3::Z * (sides.z / 2.0 - 1e-6));
        let moment = |side: f64| mass * (side * side + sides.z * sides.z) / 12.0;
        let rocking = |side: f64| stiffness * side * side / moment(side);
        let motions = [4.0 * stiffness / mass, rocking(sides.x), rocking(sides.y)];
        each_explicit!(1e-3, |integrator, method| {
            let stepper = stepper.with_integrator(integrator).unwrap();
            let limit = stepper.largest_stable_step(&state).unwrap();
            let limits = motions.map(|stiffness| {
                let damping = per_stiffness * stiffness;
                Integrator::<f64>::largest_stable_step(&integrator, stiffness, damping).unwrap()
            });
            let least = limits.into_iter().fold(f64::INFINITY, f64::min);
            let share = limit / least;
            assert!(
                share < 1.0 + 1e-3 && share > 0.85,
                "{method}: {share} of {limits:?} s, {sides}, {stiffness} N/m, {per_stiffness} s"
            );
        });
    }
}

/// A spring with a damper that holds a ball along the ground, or in the air: the limit is that of
/// the motion that it holds, or of the ground.
#[test]
fn a_force_with_damping_has_its_own_limit_beside_damped_ground() {
    let (mass, damping) = (0.7, 25.0);
    let force = Mount {
        stiffness: DVec3::new(3e3, 0.0, 0.0),
        damping: DVec3::new(damping, 0.0, 0.0),
        torsion: 0.0,
        arm: DVec3::ZERO,
    };
    for (height, ground) in [(0.099, Some([4e4, 90.0])), (0.5, None)] {
        each_explicit!(1e-3, |integrator, method| {
            let stepper = Stepper::new(Sphere::solid(mass, 0.1))
                .and_then(|stepper| stepper.with_ground(FlatGround::level(4e4, 90.0)))
                .and_then(|stepper| stepper.with_integrator(integrator))
                .and_then(|stepper| stepper.with_force(force))
                .unwrap();
            let limit = stepper.largest_stable_step(&State::at(DVec3::Z * height));
            let of = |[stiffness, damping]: [f64; 2]| {
                let rates = [stiffness / mass, damping / mass];
                Integrator::<f64>::largest_stable_step(&integrator, rates[0], rates[1]).unwrap()
            };
            let held = of([3e3, damping]);
            let expected = ground.map_or(held, |law| of(law).min(held));
            let part = limit.unwrap() / expected;
            assert!((part - 1.0).abs() < 1e-4, "{method}, {height} m: {part}");
        });
    }
}

/// A spring that holds a ball along the ground has no damper. It is softer than the ground, whose
/// dampers say nothing of it.
#[test]
fn a_force_without_damping_bounds_the_step_beside_damped_ground() {
    let force = Mount {
        stiffness: DVec3::new(3e3, 0.0, 0.0),
        damping: DVec3::ZERO,
        torsion: 0.0,
        arm: DVec3::ZERO,
    };
    let state = State::at(DVec3::Z * 0.099);
    each_explicit!(1e-3, |integrator, method| {
        let stepper = Stepper::new(Sphere::solid(0.7, 0.1))
            .and_then(|stepper| stepper.with_ground(FlatGround::level(4e4, 90.0)))
            .and_then(|stepper| stepper.with_integrator(integrator))
            .and_then(|stepper| stepper.with_force(force))
            .unwrap();
        let limit = stepper.largest_stable_step(&state).unwrap();
        let undamped = Integrator::<f64>::largest_stable_step(&integrator, 3e3 / 0.7, 0.0);
        assert!(limit <= undamped.unwrap(), "{method}: {limit:e} s");
    });
}

/// Half of an applied force acts at each end of a step of `EnergyMomentum`. On a spring that is the
/// method of Störmer and Verlet, which is stable up to `h ω = 2`.
#[test]
fn energy_momentum_is_stable_up_to_two_over_the_frequency_of_an_applied_spring() {
    let frequency = 10.0;
    let spring = Mount {
        stiffness: DVec3::splat(frequency * frequency),
        damping: DVec3::ZERO,
        torsion: 0.0,
        arm: DVec3::ZERO,
    };
    let farthest = |product: f64| {
        let time_step = product / frequency;
        let stepper = Stepper::new(PointMass::new(1.0))
            .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step }))
            .and_then(|stepper| stepper.with_force(spring))
            .unwrap();
        let mut state = State::at(DVec3::X);
        (0..200).fold(0.0_f64, |farthest, _| {
            stepper.step(&mut state).unwrap();
            farthest.max(state.position.length())
        })
    };
    for product in [0.1, 1.0, 1.9, 1.98] {
        let farthest = farthest(product);
        assert!(farthest < 1.0 + 1e-9, "{product}: {farthest:e}");
    }
    let farthest = farthest(2.02);
    assert!(farthest > 1e6, "{farthest:e}");
}

/// A thrust that turns with the body pushes it aside if the body leans, and nothing pushes back:
/// there is no oscillation. On the ground the limit is that of the contact.
#[test]
fn a_thrust_that_turns_with_the_body_bounds_no_step() {
    struct Thrust;
    impl Force for Thrust {
        fn wrench(&self, motion: &Motion) -> Wrench {
            Wrench::of_force(motion.axes.to_world(DVec3::Z) * 5.0)
        }
        fn is_passive(&self) -> bool {
            false
        }
    }
    let lean = DQuat::from_scaled_axis(DVec3::new(0.3, 0.2, 0.1));
    let at = |height: f64| State::at(DVec3::Z * height).with_orientation(lean);
    each_explicit!(1e-3, |integrator, method| {
        let plain = Stepper::new(Sphere::solid(1.0, 0.1))
            .and_then(|stepper| stepper.with_ground(FlatGround::level(1e4, 30.0)))
            .and_then(|stepper| stepper.with_integrator(integrator))
            .unwrap();
        let pushed = plain.with_force(Thrust).unwrap();
        assert_eq!(pushed.largest_stable_step(&at(1.0)), None, "{method}");
        let [with, without] = [
            pushed.largest_stable_step(&at(0.0999)),
            plain.largest_stable_step(&at(0.0999)),
        ];
        assert!(
            near(with, without.unwrap()),
            "{method}: {with:?}, not {without:?}"
        );
    });
}

/// A force that rotates the velocity at a rate ω has the rates `± i ω` in the velocities alone.
/// `Rk4` and `Nystrom`, which is `Rk4` for the velocities, are stable up to `2 √2/ω`. The other
/// methods amplify at every step size: by `√(1 + (h ω)²)`, and `StrangSplitting` by
/// `√(1 + (h ω)⁴/4)`. Their bound is where rounding hides it.
#[test]
fn a_force_that_rotates_the_velocity_bounds_the_step_by_its_rate() {
    struct Magnetic(f64);
    impl Force for Magnetic {
        fn wrench(&self, motion: &Motion) -> Wrench {
            Wrench::of_force(DVec3::Z.cross(motion.linear_velocity) * self.0)
        }
        fn is_passive(&self) -> bool {
            true
        }
    }
    let rate = 3.0;
    // In the air, and on damped ground whose own limit is shorter.
    for (height, is_bound_by_ground) in [(1.0, false), (0.099, true)] {
        let state = State::at(DVec3::Z * height).with_linear_velocity(DVec3::X);
        each_explicit!(1e-3, |integrator, method| {
            let plain = Stepper::new(Sphere::solid(1.0, 0.1))
                .and_then(|stepper| stepper.with_ground(FlatGround::level(1e4, 20.0)))
                .and_then(|stepper| stepper.with_integrator(integrator))
                .unwrap();
            let turned = plain.with_force(Magnetic(rate)).unwrap();
            let limit = turned.largest_stable_step(&state);
            let product = limit.unwrap() * rate;
            match method {
                "Rk4" | "Nystrom" if is_bound_by_ground => {
                    let ground = plain.largest_stable_step(&state).unwrap();
                    assert!(near(limit, ground), "{method}: {limit:?}, not {ground}");
                }
                "Rk4" | "Nystrom" => assert!(near(Some(product), 8.0_f64.sqrt()), "{product}"),
                "ForwardEuler" => assert_eq!(limit, Some(0.0)),
                _ => assert!(product < 0.01, "{method}: {product}"),
            }
        });
    }
}
