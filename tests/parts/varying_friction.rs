//! Friction that varies over the ground: closed forms of a block that crosses a patch, orders of
//! all methods in a smooth field and at a jump, and the positions that a law receives.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use core::cell::Cell;
use core::ops::ControlFlow;

use crate::kit::erased::Stepper;
use crate::kit::{GRAVITY as G, cases, difference, each_method, log_uniform, order, point_mass};
use proptest::prelude::*;
use tumble::glam::{DVec3, Vec3};
use tumble::{
    BogackiShampine32, Bowl, Coin, Coulomb, Cuboid, Disc, Dissipation, DormandPrince54, Ellipsoid,
    EnergyMomentum, FlatGround, FrictionField, FrictionJacobian, FrictionPatch, Frictionless,
    Ground, Integrator, Ledger, Plane, PointCloud, Region, RigidPointBody, Rk4, RollingResistance,
    Sample, SlidingFriction, SmoothCoulomb, Sphere, SpringDamper, SpringDamperGround, State,
    StepError, Terrain, UniformGravity, WithResistance,
};

const ROUGH: Coulomb = Coulomb {
    coefficient: 0.4,
    slip_speed: 1e-6,
};
const ICE: Coulomb = Coulomb {
    coefficient: 0.05,
    ..ROUGH
};
/// Edges of the strip of ice, m.
const STRIP: [f64; 2] = [0.5, 1.0];

fn strip_of_ice() -> FrictionPatch<Coulomb, Coulomb> {
    let [from, to] = STRIP;
    FrictionPatch {
        outside: ROUGH,
        inside: ICE,
        region: Region::Strip {
            across: DVec3::X,
            from,
            to,
        },
    }
}

fn compose<'a, I: Integrator>(
    body: impl RigidPointBody + 'a,
    ground: impl SpringDamperGround + 'a,
    friction: impl SlidingFriction + 'a,
    integrator: I,
) -> Stepper<'a, I> {
    Stepper::new(body)
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(G)))
        .and_then(|stepper| stepper.with_ground(ground))
        .and_then(|stepper| stepper.with_friction(friction))
        .and_then(|stepper| stepper.with_integrator(integrator))
        .unwrap()
}

/// A block of 1 kg that slides on its four corners, which lie in the plane of its centre of mass.
fn block() -> PointCloud<f64, [tumble::ContactPoint; 4]> {
    let corners = [[0.05, 0.03], [-0.05, 0.03], [-0.05, -0.03], [0.05, -0.03]];
    PointCloud::new(corners.map(|[x, y]| DVec3::new(x, y, 0.0)), [0.25; 4]).unwrap()
}

const STIFFNESS: f64 = 1e4;

fn floor() -> FlatGround {
    FlatGround::level(STIFFNESS, 100.0)
}

/// A body that slides along x with all contacts at their depth at rest.
fn sliding(body: &impl RigidPointBody, speed: f64) -> State {
    let depth = G / STIFFNESS / body.contacts().len() as f64;
    State::at(DVec3::Z * -depth).with_linear_velocity(DVec3::X * speed)
}

/// Each corner dissipates `μ m g/4` per metre, and each crosses the whole strip of width w. So
/// `v²/(2 g) = μ₁ (s - w) + μ₂ w`.
#[test]
fn a_block_stops_behind_an_ice_strip_where_its_energy_is_spent() {
    let (speed, [from, to]) = (2.5_f64, STRIP);
    let (rough, ice) = (ROUGH.coefficient, ICE.coefficient);
    let stops = (speed * speed / (2.0 * G) - ice * (to - from)) / rough + (to - from);
    let enters = (speed * speed - 2.0 * rough * G * from).sqrt();
    let leaves = (enters * enters - 2.0 * ice * G * (to - from)).sqrt();
    // The path of a step at an edge counts as on one side: `(μ₁ - μ₂) m g v h` of work. The methods
    // of order 1 are off by `v₀ h/2` besides.
    let bound = |h: f64| h * ((rough - ice) / rough * (enters + leaves) + speed / 2.0);
    each_method!(1e-3, |integrator, name| {
        for (body, what) in [
            (&block() as &dyn RigidPointBody, "block"),
            (&point_mass(1.0), "point"),
        ] {
            let stepper = compose(body, floor(), strip_of_ice(), integrator);
            let mut state = sliding(&body, speed);
            stepper.advance(&mut state, 1.5).unwrap();
            let off = (state.position.x - stops).abs();
            assert!(off < bound(1e-3), "{name}, {what}: {off} m off {stops} m");
            assert!(state.linear_velocity.length() < 1e-2, "{name}, {what}");
        }
    });
}

#[test]
fn a_block_stops_behind_an_ice_strip_in_single_precision() {
    use tumble::f32::{Coulomb, FrictionPatch, PointCloud, Region, State, UniformGravity};
    let (rough, ice, speed, g) = (0.4_f32, 0.05, 2.5, 9.8);
    let coulomb = |coefficient| Coulomb {
        coefficient,
        slip_speed: 1e-4,
    };
    let friction: FrictionPatch<_, _> = FrictionPatch {
        outside: coulomb(rough),
        inside: coulomb(ice),
        region: Region::Strip {
            across: Vec3::X,
            from: 0.5,
            to: 1.0,
        },
    };
    let field = tumble::FrictionField::new(|position: Vec3| {
        coulomb(if position.x >= 0.5 && position.x <= 1.0 {
            ice
        } else {
            rough
        })
    });
    let stops = (speed * speed / (2.0 * g) - ice * 0.5) / rough + 0.5;
    for friction in [&friction as &dyn SlidingFriction<f32>, &field] {
        let stepper = Stepper::new(PointCloud::new([Vec3::ZERO], [1.0]).unwrap())
            .unwrap()
            .with_gravity(UniformGravity::down(g))
            .unwrap()
            .with_ground(tumble::f32::FlatGround::level(1e4, 100.0))
            .unwrap()
            .with_friction(friction)
            .unwrap()
            .with_integrator(EnergyMomentum { time_step: 1e-3 })
            .unwrap();
        let mut state = State::at(Vec3::Z * (-g / 1e4)).with_linear_velocity(Vec3::X * speed);
        stepper.advance(&mut state, 1.5).unwrap();
        // The bound of double precision, and rounding of 1.2 m in 1500 steps.
        let off = (state.position.x - stops).abs();
        assert!(off < 4e-3 + 1500.0 * f32::EPSILON, "{off} m off {stops} m");
    }
}

/// With `μ(x) = a + b x`, `x'' = -g (a + b x)`: a quarter of a harmonic oscillation around `-a/b`
/// with `ω² = g b`.
#[test]
fn in_a_smooth_field_each_method_keeps_its_order() {
    let (a, b, speed, seconds) = (0.2_f64, 0.3_f64, 3.0, 0.4);
    let field = FrictionField::new(|position: DVec3| Coulomb {
        coefficient: a + b * position.x,
        slip_speed: 1e-15,
    });
    let omega = (G * b).sqrt();
    let exact = a / b * ((omega * seconds).cos() - 1.0) + speed / omega * (omega * seconds).sin();
    let ground = FlatGround::level(100.0, 10.0);
    let start = State::at(DVec3::Z * (-G / 100.0)).with_linear_velocity(DVec3::X * speed);
    let errors = |time_step: f64| {
        let mut errors = Vec::new();
        each_method!(time_step, |integrator, name| {
            let mut state = start;
            compose(point_mass(1.0), ground, field, integrator)
                .advance(&mut state, seconds)
                .unwrap();
            errors.push((name, (state.position.x - exact).abs()));
        });
        errors
    };
    for ((name, coarse), (_, fine)) in errors(0.04).into_iter().zip(errors(0.02)) {
        let expected = crate::common::methods::method(name).order;
        let found = order(coarse, fine);
        assert!(
            (found - f64::from(expected)).abs() < 0.3,
            "{name}: order {found}, errors {coarse:e} and {fine:e}"
        );
    }
}

/// `EnergyMomentum` evaluates friction where the contact is in the middle of the step. For a
/// rotating body, a ball and an egg the arm of that point must be of order 2, too.
#[test]
fn energy_momentum_keeps_order_2_on_rotating_bodies() {
    let field = FrictionField::new(|position: DVec3| SmoothCoulomb {
        coefficient: 0.3 + 0.2 * (4.0 * position.x).sin() * (3.0 * position.y).cos(),
        slip_speed: 0.1,
    });
    let ground = FlatGround::level(2e3, 20.0);
    let egg = Ellipsoid::solid(1.0, DVec3::new(0.2, 0.15, 0.1));
    let bodies: [(&dyn RigidPointBody, f64, &str); 4] = [
        (&block(), 0.0, "block"),
        (&Sphere::solid(1.0, 0.1), 0.1, "ball"),
        (&egg, 0.1, "egg"),
        (&Cuboid::cube(1.0, 0.2).rounded(0.03), 0.1, "die"),
    ];
    for (body, height, name) in bodies {
        let reference = compose(body, ground, field, Rk4 { time_step: 1e-4 });
        let touching = match name {
            "block" | "die" => 4.0,
            _ => 1.0,
        };
        let start = State::at(DVec3::Z * (height - G / 2e3 / touching))
            .with_linear_velocity(DVec3::new(2.0, 0.5, 0.0));
        let start = reference.with_angular_velocity(start, DVec3::new(0.0, 0.0, 6.0));
        let seconds = 0.24;
        let mut exact = start;
        reference.advance(&mut exact, seconds).unwrap();
        let error = |time_step: f64| {
            let mut state = start;
            compose(body, ground, field, EnergyMomentum { time_step })
                .advance(&mut state, seconds)
                .unwrap();
            difference(&state, &exact)
        };
        let (coarse, fine) = (error(2e-3), error(1e-3));
        let found = order(coarse, fine);
        assert!(
            (found - 2.0).abs() < 0.3,
            "{name}: order {found}, errors {coarse:e} and {fine:e}"
        );
    }
}

/// Position of a point that slides over one edge into ice, closed form.
fn beyond_an_edge(from: f64, speed: f64, seconds: f64) -> f64 {
    let [rough, ice] = [ROUGH, ICE].map(|law| law.coefficient * G);
    let enters = (speed * speed - 2.0 * rough * from).sqrt();
    let left = seconds - (speed - enters) / rough;
    from + enters * left - ice * left * left / 2.0
}

/// Largest and mean error of the position (m) over many distances of the edge from the start.
fn errors_at_an_edge(integrator: impl Integrator + Copy) -> [f64; 2] {
    const STARTS: u32 = 64;
    let (speed, seconds) = (2.5, 0.64);
    let (mut largest, mut sum) = (0.0_f64, 0.0);
    for start in 0..STARTS {
        // Irrational fractions of the path of a step.
        let from = 0.5 + 0.04 * (f64::from(start) * 0.618_033_988_75).fract();
        let friction = FrictionPatch {
            outside: ROUGH,
            inside: ICE,
            region: Region::HalfSpace {
                across: DVec3::X,
                from,
            },
        };
        let body = point_mass(1.0);
        let mut state = sliding(&body, speed);
        compose(body, floor(), friction, integrator)
            .advance(&mut state, seconds)
            .unwrap();
        let error = (state.position.x - beyond_an_edge(from, speed, seconds)).abs();
        (largest, sum) = (largest.max(error), sum + error);
    }
    [largest, sum / f64::from(STARTS)]
}

/// The step across the edge has the acceleration of one side for at most its duration, so the
/// velocity is off by `(μ₁ - μ₂) g h` at most.
#[test]
fn at_a_jump_of_the_coefficient_fixed_steps_are_of_order_1() {
    let rows = |time_step: f64| {
        let mut rows = Vec::new();
        each_method!(time_step, |integrator, name| {
            rows.push((name, errors_at_an_edge(integrator)));
        });
        rows
    };
    let steps = [8e-3, 2e-3];
    for ((name, [largest, coarse]), (_, [_, fine])) in
        rows(steps[0]).into_iter().zip(rows(steps[1]))
    {
        let found = order(coarse, fine) / 2.0;
        println!("{name:16} order {found:.2}, largest error {largest:.1e} m");
        assert!((found - 1.0).abs() < 0.25, "{name}: order {found}");
        // Over 0.64 s, and `v h/2` of the methods of order 1.
        let bound = steps[0] * (0.35 * G * 0.64 + 1.25);
        assert!(largest < bound, "{name}: {largest} m");
    }
}

/// The estimate of a pair of methods may miss a jump by a factor of 80. The integral along the path
/// does not.
#[test]
fn adaptive_methods_find_the_edge() {
    for tolerance in [1e-4, 1e-6] {
        let found = [
            errors_at_an_edge(DormandPrince54::new(tolerance)),
            errors_at_an_edge(BogackiShampine32::new(tolerance)),
        ];
        println!("tolerance {tolerance:e}: {found:?}");
        for [largest, _] in found {
            assert!(largest < 10.0 * tolerance, "{largest:e} m");
        }
    }
}

/// A ball rolls freely on wood. On the carpet it slows down by `5/7 ℓ/r g`.
#[test]
fn a_ball_rolls_out_on_a_carpet() {
    let (radius, rolling, speed, edge) = (0.03, 1e-3, 0.5, 0.2);
    let wood = Coulomb {
        coefficient: 0.5,
        slip_speed: 1e-3,
    };
    let carpet = WithResistance {
        friction: wood,
        rolling,
        spinning: 0.0,
        turn_speed: 1e-4,
    };
    let region = Region::HalfSpace {
        across: DVec3::X,
        from: edge,
    };
    let friction = FrictionPatch {
        outside: wood,
        inside: carpet,
        region,
    };
    let stops = edge + speed * speed / (2.0 * 5.0 / 7.0 * rolling / radius * G);
    each_method!(1e-4, |integrator, name| {
        let ball = Sphere::solid(1.0, radius);
        let stepper = compose(ball, FlatGround::level(1e5, 300.0), friction, integrator);
        let start = State::at(DVec3::Z * (radius - G / 1e5)).with_linear_velocity(DVec3::X * speed);
        let mut state = stepper.with_angular_velocity(start, DVec3::Y * (speed / radius));
        stepper.advance(&mut state, 4.0).unwrap();
        let off = (state.position.x - stops).abs();
        // The torque is lower by 1/(1 + ω/turn_speed), the end is a creep at up to 1e-4 rad/s, and
        // the ball slips by 1e-3 m/s · 0.02 while it slows down.
        assert!(off < 2e-3 * stops, "{name}: {off} m off {stops} m");
    });
}

/// A patch of the same law is the law, so no bit may differ.
#[test]
fn a_patch_of_the_same_law_changes_no_bit() {
    let law = Coulomb {
        coefficient: 0.3,
        slip_speed: 1e-3,
    };
    let patched = FrictionPatch {
        outside: law,
        inside: law,
        region: Region::Ball {
            centre: DVec3::new(0.1, 0.0, 0.0),
            radius: 0.2,
        },
    };
    let ground = FlatGround::level(1000.0, 0.5);
    let bodies: [&dyn RigidPointBody; 4] = [
        &Coin::ring(1.0, 0.5),
        &Disc::solid(1.0, 0.5, 40),
        &Ellipsoid::solid(1.0, DVec3::new(0.3, 0.2, 0.4)),
        &Cuboid::cube(1.0, 0.5).rounded(0.05),
    ];
    for body in bodies {
        each_method!(2e-4, |integrator, name| {
            let run = |friction: &dyn SlidingFriction| {
                let stepper = compose(body, ground, friction, integrator);
                let start = State::at(DVec3::Z * 0.5)
                    .with_linear_velocity(DVec3::new(1.0, 0.2, 0.0))
                    .with_rotation_vector(DVec3::new(0.3, 0.2, 0.1))
                    .with_angular_momentum(DVec3::new(0.1, 0.5, 0.2));
                let (mut state, mut ledger) = (start, Ledger::new());
                stepper.run(&mut state, 0.1, &mut ledger).unwrap();
                stepper.advance(&mut state, 0.2).unwrap();
                (state, ledger.energy_error())
            };
            assert_eq!(run(&law), run(&patched), "{name}");
        });
    }
}

/// A field that its user trusts has the same bits without the checks, and a field or a patch of
/// trusted laws is trusted. A patch of a user's law is not.
#[test]
fn a_trusted_field_changes_no_bit() {
    let field = FrictionField::new(|position: DVec3| Coulomb {
        coefficient: 0.3 + 0.2 * position.x.sin(),
        slip_speed: 1e-3,
    });
    assert!(!SlidingFriction::<f64>::is_trusted(&field));
    assert!(SlidingFriction::<f64>::is_trusted(&field.trusted()));
    assert!(strip_of_ice().is_trusted());
    let own = AtContacts {
        middle: &Cell::new(DVec3::ZERO),
        radius: 0.0,
        below: 0.0,
        calls: Cell::new(0),
    };
    let patch = FrictionPatch {
        outside: ROUGH,
        inside: own,
        region: strip_of_ice().region,
    };
    assert!(!patch.is_trusted());
    each_method!(1e-3, |integrator, name| {
        let run = |friction: &dyn SlidingFriction| {
            let stepper = compose(block(), floor(), friction, integrator);
            let mut state = sliding(&block(), 2.0);
            stepper.advance(&mut state, 0.3).unwrap();
            state
        };
        assert_eq!(run(&field), run(&field.trusted()), "{name}");
    });
}

/// A law that a user wrongly trusts is not detected as one that breaks its contract. Without that
/// trust a step names it.
#[test]
fn only_a_field_without_trust_is_checked() {
    let pushes = FrictionField::new(|_: DVec3| Coulomb {
        coefficient: -0.1,
        slip_speed: 1e-3,
    });
    let step = |friction: &dyn SlidingFriction| {
        let stepper = compose(block(), floor(), friction, Rk4 { time_step: 1e-3 });
        stepper.step(&mut sliding(&block(), 2.0)).map(|_| ())
    };
    assert!(matches!(step(&pushes), Err(StepError::BrokenLaw { .. })));
    assert_eq!(step(&pushes.trusted()), Ok(()));
}

/// A law that is defined by its position only, and requires that it is that of a contact.
struct AtContacts<'a> {
    middle: &'a Cell<DVec3>,
    radius: f64,
    below: f64,
    calls: Cell<u32>,
}

impl AtContacts<'_> {
    fn demand(&self, position: DVec3) {
        self.calls.set(self.calls.get() + 1);
        let distance = (position - self.middle.get()).length();
        assert!(distance <= self.radius, "{position}: {distance} m");
        assert!(position.z <= self.below, "{position}");
    }
}

impl SlidingFriction for AtContacts<'_> {
    fn force(&self, _normal_force: f64, _slip: DVec3) -> DVec3 {
        unreachable!("a force without a position")
    }
    fn jacobian(&self, _normal_force: f64, _slip: DVec3) -> FrictionJacobian {
        unreachable!("derivatives without a position")
    }
    fn rolling_resistance(&self, normal_force: f64) -> Option<RollingResistance> {
        assert!(normal_force <= 0.0, "a resistance without a position");
        Some(RollingResistance {
            rolling: 0.0,
            spinning: 0.0,
            turn_speed: 1.0,
        })
    }
    fn force_at(&self, position: DVec3, normal_force: f64, slip: DVec3) -> DVec3 {
        self.demand(position);
        ROUGH.force(normal_force, slip) * (1.0 + 0.1 * position.x.sin())
    }
    fn rolling_resistance_at(
        &self,
        position: DVec3,
        normal_force: f64,
    ) -> Option<RollingResistance> {
        self.demand(position);
        self.rolling_resistance(0.0).map(|none| RollingResistance {
            rolling: 1e-3 * normal_force,
            ..none
        })
    }
    fn depends_on_position(&self) -> bool {
        true
    }
}

fn each_integrator(time_step: f64, run: &mut dyn FnMut(tumble::AnyIntegrator)) {
    each_method!(time_step, |integrator, _name| {
        run(integrator);
    });
    run(DormandPrince54::new(1e-3).into());
    run(BogackiShampine32::new(1e-3).into());
}

#[test]
fn every_evaluation_is_at_the_position_of_a_contact() {
    let law = SpringDamper {
        stiffness: 1000.0,
        damping: 0.5,
    };
    let height_field = Bowl {
        curvatures: [0.2, 0.1],
    };
    let shape = Plane::through(DVec3::ZERO, DVec3::new(0.1, 0.0, 1.0));
    let grounds: [(&dyn SpringDamperGround, f64); 3] = [
        (&FlatGround::level(1000.0, 0.5), 0.0),
        (&Ground { law, shape }, 0.5),
        (
            &Ground {
                law,
                shape: Terrain { height_field },
            },
            0.5,
        ),
    ];
    let bodies: [&dyn RigidPointBody; 5] = [
        &Coin::ring(1.0, 0.5),
        &Disc::solid(1.0, 0.5, 40),
        &Ellipsoid::solid(1.0, DVec3::new(0.3, 0.2, 0.5)),
        &Sphere::solid(1.0, 0.5),
        &Cuboid::cube(1.0, 0.9).rounded(0.05),
    ];
    for (ground, hills) in grounds {
        for body in bodies {
            each_integrator(2e-4, &mut |integrator| {
                let middle = Cell::new(DVec3::Z * 0.45);
                // Motion within a step: some stages are ahead of the state by one step.
                let margin = 0.05;
                let friction = AtContacts {
                    middle: &middle,
                    radius: body.bounding_radius() + margin,
                    below: hills + margin,
                    calls: Cell::new(0),
                };
                let stepper = compose(body, ground, &friction, integrator);
                let mut state = State::at(middle.get())
                    .with_linear_velocity(DVec3::new(1.0, 0.2, -0.1))
                    .with_rotation_vector(DVec3::new(0.3, 0.2, 0.1))
                    .with_angular_momentum(DVec3::new(0.1, 0.5, 0.2));
                let watch = &mut |sample: &Sample<'_>| {
                    middle.set(sample.state.position);
                    let _ = sample.dissipation();
                    ControlFlow::Continue(())
                };
                stepper.run(&mut state, 0.02, watch).unwrap();
                let _ = stepper.largest_stable_step(&state);
                let _ = Dissipation::of(stepper.scene(), &state);
                assert!(friction.calls.get() > 0);
            });
        }
    }
}

/// The exact work of friction on a path that ends in the ice: `-g (μ₁ a + μ₂ (x - a))`.
#[test]
fn the_ledger_has_the_work_of_both_laws() {
    let time_step = 1e-3;
    let stepper = compose(
        point_mass(1.0),
        floor(),
        strip_of_ice(),
        EnergyMomentum { time_step },
    );
    let mut state = sliding(&point_mass(1.0), 2.5);
    let mut ledger = Ledger::new();
    stepper.run(&mut state, 0.4, &mut ledger).unwrap();
    let [from, to] = STRIP;
    let along = state.position.x;
    assert!(from < along && along < to);
    let work = -G * (ROUGH.coefficient * from + ICE.coefficient * (along - from));
    // The step across the edge, of 1.5 mm, may be on either side for the method and for the ledger.
    let bound = 2.0 * 0.35 * G * 1.6 * time_step;
    assert!((ledger.work().friction - work).abs() < bound);
    assert!(ledger.energy_error().abs() < bound);
}

fn regions() -> impl Strategy<Value = Region> {
    let place = || (-0.5..0.5_f64, -0.5..0.5_f64).prop_map(|(x, y)| DVec3::new(x, y, 0.0));
    let across = || (0.0..6.2_f64).prop_map(|angle| DVec3::new(angle.cos(), angle.sin(), 0.0));
    prop_oneof![
        (across(), -0.5..0.5_f64).prop_map(|(across, from)| Region::HalfSpace { across, from }),
        (across(), -0.5..0.5_f64, log_uniform(1e-3, 1.0)).prop_map(|(across, from, width)| {
            Region::Strip {
                across,
                from,
                to: from + width,
            }
        }),
        (place(), log_uniform(1e-2, 1.0))
            .prop_map(|(centre, radius)| Region::Ball { centre, radius }),
    ]
}

proptest! {
    #![proptest_config(cases(100))]

    /// Friction with a jump only dissipates energy, so the computed energy never increases, with
    /// any step.
    #[test]
    fn the_energy_never_increases_over_patches(
        region in regions(),
        inside in log_uniform(1e-3, 3.0),
        slip_speed in log_uniform(1e-12, 1e-1),
        time_step in log_uniform(1e-4, 0.1),
        velocity in (-3.0..3.0_f64, -3.0..3.0_f64),
        kind in 0..4_usize,
    ) {
        let friction = FrictionPatch {
            outside: Coulomb { coefficient: 0.3, slip_speed },
            inside: SmoothCoulomb { coefficient: inside, slip_speed },
            region,
        };
        let bodies: [&dyn RigidPointBody; 4] = [
            &Coin::ring(1.0, 0.5),
            &Disc::solid(1.0, 0.5, 40),
            &Ellipsoid::solid(1.0, DVec3::new(0.3, 0.2, 0.4)),
            &Cuboid::cube(1.0, 0.5),
        ];
        let ground = FlatGround::level(1000.0, 0.5);
        let stepper = compose(bodies[kind], ground, friction, EnergyMomentum { time_step });
        let mut state = State::at(DVec3::Z * 0.5)
            .with_linear_velocity(DVec3::new(velocity.0, velocity.1, 0.0))
            .with_rotation_vector(DVec3::new(0.3, 0.2, 0.1))
            .with_angular_momentum(DVec3::new(0.1, 0.5, 0.2));
        let mut before = stepper.energy(&state).total();
        for _ in 0..100 {
            stepper.step(&mut state).unwrap();
            let after = stepper.energy(&state).total();
            prop_assert!(after <= before, "{after} > {before}");
            before = after;
        }
    }
}

#[test]
fn a_region_contains_its_points_and_its_boundary() {
    let across = DVec3::new(0.6, 0.8, 0.0);
    let half = Region::HalfSpace { across, from: 1.0 };
    let strip = Region::Strip {
        across,
        from: 1.0,
        to: 2.0,
    };
    let ball = Region::Ball {
        centre: across,
        radius: 1.0,
    };
    for (distance, expected) in [
        (-0.5, [false, false, false]),
        (0.5, [false, false, true]),
        (1.5, [true, true, true]),
        (2.5, [true, false, false]),
    ] {
        let position = across * distance;
        let found = [half, strip, ball].map(|region: Region| region.contains(position));
        assert_eq!(found, expected, "{distance} m");
    }
    assert!(ball.contains(across + DVec3::X));
}

#[test]
fn a_law_without_a_position_ignores_it() {
    let far = DVec3::splat(1e9);
    assert_eq!(
        ROUGH.force_at(far, 3.0, DVec3::X),
        ROUGH.force(3.0, DVec3::X)
    );
    assert!(!SlidingFriction::<f64>::depends_on_position(&Frictionless));
    assert!(!SlidingFriction::<f64>::depends_on_position(&&ROUGH));
    let boxed: Box<dyn SlidingFriction> = Box::new(strip_of_ice());
    assert!(boxed.depends_on_position() && (&&boxed).depends_on_position());
    let inside = boxed.force_at(DVec3::X * 0.7, 3.0, DVec3::X);
    assert_eq!(inside, ICE.force(3.0, DVec3::X));
}

#[test]
fn a_patch_is_saved_and_loaded() {
    let friction = FrictionPatch {
        outside: strip_of_ice(),
        inside: ICE,
        region: Region::Ball {
            centre: DVec3::new(0.1, 0.2, 0.3),
            radius: 0.7,
        },
    };
    let text = serde_json::to_string(&friction).unwrap();
    let loaded: FrictionPatch<FrictionPatch<Coulomb, Coulomb>, Coulomb> =
        serde_json::from_str(&text).unwrap();
    assert_eq!(loaded, friction);
}
