//! Wrong derivatives of known size, and the laws of this crate.

use glam::{DVec3, Vec3};

use super::*;
use crate::contract::plan::Draw;
use crate::contract::{CheckPlan, FrictionRange, check_friction};
use crate::{
    AnisotropicCoulomb, Coulomb, FrictionField, FrictionPatch, Frictionless, LoadDependentCoulomb,
    Region, SmoothCoulomb, Stribeck, Viscous, WithResistance,
};

/// A law whose Jacobian is changed.
struct Changed<F>(F, fn(&mut FrictionJacobian));

impl<F: SlidingFriction> SlidingFriction for Changed<F> {
    fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
        self.0.force(normal_force, slip)
    }
    fn jacobian(&self, normal_force: f64, slip: DVec3) -> FrictionJacobian {
        let mut jacobian = self.0.jacobian(normal_force, slip);
        (self.1)(&mut jacobian);
        jacobian
    }
}

/// A law whose Jacobian is the provided one.
struct Plain<F>(F);

impl<R: Real, F: SlidingFriction<R>> SlidingFriction<R> for Plain<F> {
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        self.0.force(normal_force, slip)
    }
}

const RANGE: FrictionRange = FrictionRange {
    centre: DVec3::new(0.1, -0.2, 0.3),
    size: 1.0,
    normal: DVec3::new(0.1, 0.2, 1.0),
    normal_force: 1e3,
    slip: 10.0,
};

const COULOMB: Coulomb = Coulomb {
    coefficient: 0.3,
    slip_speed: 1e-3,
};

fn fault(law: &impl SlidingFriction) -> Violation {
    check_friction(law, &RANGE, CheckPlan::default()).expect_err("a wrong derivative")
}

#[test]
fn a_wrong_derivative_with_respect_to_the_load_is_told_with_the_measured_one() {
    let told = fault(&Changed(COULOMB, |j| j.per_load *= 1.01));
    assert_eq!(told.requirement, Requirement::PerLoadFits);
    assert!((told.value / told.bound - 1.01).abs() < 1e-5, "{told}");
    assert!(matches!(told.input, Input::Slide { .. }));
    let none = fault(&Changed(COULOMB, |j| j.per_load = 0.0));
    assert_eq!(none.requirement, Requirement::PerLoadFits);
    assert!(none.bound > 0.0, "{none}");
    // That of a constant coefficient, which the coefficient of this law is not.
    let falls = LoadDependentCoulomb {
        coefficient: 0.3,
        transition_load: 100.0,
        slip_speed: 1e-3,
    };
    let wrong = fault(&Changed(falls, |j| j.per_load = j.coefficient / 1e3));
    assert_eq!(wrong.requirement, Requirement::PerLoadFits, "{wrong}");
}

#[test]
fn a_wrong_growth_or_width_is_told() {
    let changes: [fn(&mut FrictionJacobian); 6] = [
        |j| j.growth = 0.0,
        |j| j.growth *= 0.99,
        |j| j.width *= 0.99,
        |j| j.width *= 1.01,
        |j| j.width *= 1e3,
        |j| j.width = 1.0,
    ];
    for (number, change) in changes.into_iter().enumerate() {
        let told = fault(&Changed(COULOMB, change));
        assert_eq!(
            told.requirement,
            Requirement::GrowthFits,
            "{number}: {told}"
        );
    }
    let told = fault(&Changed(COULOMB, |j| j.growth *= 0.99));
    assert!((told.value / told.bound - 0.99).abs() < 1e-5, "{told}");
    let told = fault(&Changed(Viscous { coefficient: 0.2 }, |j| j.growth = 0.01));
    assert_eq!(told.requirement, Requirement::GrowthFits, "{told}");
}

/// Each law of this crate with random parameters, and with differences in place of its Jacobian.
/// Parameters are up to `octaves` powers of two below the largest ones.
fn assert_all_pass<R: Real>(range: &FrictionRange<R>, octaves: u32) {
    let mut draw = CheckPlan::default().draw();
    let r = R::from_f64;
    for seed in 0..40 {
        let plan = CheckPlan { seed, cases: 40 };
        let size = |draw: &mut Draw, most: f64| draw.scale::<R>(octaves) * r(most);
        let coulomb = Coulomb {
            coefficient: size(&mut draw, 2.0),
            slip_speed: size(&mut draw, 1.0),
        };
        let smooth = SmoothCoulomb {
            coefficient: size(&mut draw, 2.0),
            slip_speed: size(&mut draw, 1.0),
        };
        let sticks = size(&mut draw, 2.0);
        let stribeck = Stribeck {
            static_coefficient: sticks,
            // Far above the static one, the coefficient would be a difference of large numbers.
            kinetic_coefficient: sticks * R::TWO * draw.share::<R>(),
            stribeck_speed: size(&mut draw, 10.0),
            viscous: size(&mut draw, 1.0),
            slip_speed: size(&mut draw, 1.0),
        };
        let plastic = LoadDependentCoulomb {
            coefficient: size(&mut draw, 2.0),
            transition_load: size(&mut draw, 1e4),
            slip_speed: size(&mut draw, 1.0),
        };
        let grain = [size(&mut draw, 2.0), size(&mut draw, 2.0)];
        let along = draw.direction::<R>();
        let wood = AnisotropicCoulomb::on(range.normal, along, grain, size(&mut draw, 1.0));
        let wet = Viscous {
            coefficient: size(&mut draw, 1.0),
        };
        let rolls = WithResistance {
            friction: stribeck,
            rolling: size(&mut draw, 0.1),
            spinning: size(&mut draw, 0.1),
            turn_speed: size(&mut draw, 1.0),
        };
        let ball = Region::Ball {
            centre: range.centre,
            radius: range.size,
        };
        let patch = FrictionPatch {
            outside: smooth,
            inside: plastic,
            region: ball,
        };
        let field = FrictionField::new(move |position: R::Vec3| Coulomb {
            coefficient: coulomb.coefficient * (R::ONE + position.x() * position.x()),
            ..coulomb
        });
        let several = (coulomb, wood, stribeck, rolls);
        let laws: [&dyn SlidingFriction<R>; 16] = [
            &Frictionless,
            &coulomb,
            &smooth,
            &stribeck,
            &plastic,
            &wood,
            &wet,
            &rolls,
            &patch,
            &field,
            &several,
            &Plain(coulomb),
            &Plain(smooth),
            &Plain(stribeck),
            &Plain(plastic),
            &Plain(wood),
        ];
        for (number, law) in laws.into_iter().enumerate() {
            let found = check_friction(law, range, plan);
            assert!(found.is_ok(), "law {number}, seed {seed}: {found:?}");
        }
    }
}

#[test]
fn the_laws_of_this_crate_pass_with_random_parameters() {
    assert_all_pass(&RANGE, 30);
    // Squares of smaller forces underflow.
    let range = FrictionRange::<f32> {
        centre: Vec3::new(0.1, -0.2, 0.3),
        size: 1.0,
        normal: Vec3::new(0.1, 0.2, 1.0),
        normal_force: 1e3,
        slip: 10.0,
    };
    assert_all_pass(&range, 10);
}

/// Linear up to a slip, and constant from there on: the derivative has a jump.
struct Corner(f64);

impl SlidingFriction for Corner {
    fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
        slip * (-0.3 * normal_force / slip.length().max(self.0))
    }
    fn jacobian(&self, normal_force: f64, slip: DVec3) -> FrictionJacobian {
        let width = slip.length().max(self.0);
        FrictionJacobian {
            coefficient: 0.3 * normal_force / width,
            per_load: 0.3 / width,
            width,
            growth: f64::from(u8::from(slip.length() > self.0)),
        }
    }
}

#[test]
fn a_law_with_a_jump_of_its_derivative_passes() {
    for corner in [1e-3, 0.1 * inward::<f64>(), 3.0] {
        let found = check_friction(&Corner(corner), &RANGE, CheckPlan::default());
        assert_eq!(found, Ok(()), "{corner}");
    }
}
