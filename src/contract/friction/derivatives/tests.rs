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

/// Random parameters: up to `octaves` powers of two below the largest ones.
struct Sizes {
    draw: Draw,
    octaves: u32,
}

impl Sizes {
    fn size<R: Real>(&mut self, most: f64) -> R {
        self.draw.scale::<R>(self.octaves) * R::from_f64(most)
    }

    fn coulomb<R: Real>(&mut self) -> Coulomb<R> {
        Coulomb {
            coefficient: self.size(2.0),
            slip_speed: self.size(1.0),
        }
    }

    fn smooth<R: Real>(&mut self) -> SmoothCoulomb<R> {
        SmoothCoulomb {
            coefficient: self.size(2.0),
            slip_speed: self.size(1.0),
        }
    }

    fn stribeck<R: Real>(&mut self) -> Stribeck<R> {
        let sticks = self.size::<R>(2.0);
        Stribeck {
            static_coefficient: sticks,
            // Far above the static one, the coefficient would be a difference of large numbers.
            kinetic_coefficient: sticks * R::TWO * self.draw.share::<R>(),
            stribeck_speed: self.size(10.0),
            viscous: self.size(1.0),
            slip_speed: self.size(1.0),
        }
    }

    fn plastic<R: Real>(&mut self) -> LoadDependentCoulomb<R> {
        LoadDependentCoulomb {
            coefficient: self.size(2.0),
            transition_load: self.size(1e4),
            slip_speed: self.size(1.0),
        }
    }

    fn wood<R: Real>(&mut self, normal: R::Vec3) -> AnisotropicCoulomb<R> {
        let coefficients = [self.size(2.0), self.size(2.0)];
        let along = self.draw.direction::<R>();
        AnisotropicCoulomb::on(normal, along, coefficients, self.size(1.0))
    }

    fn rolls<R: Real>(&mut self) -> WithResistance<Stribeck<R>, R> {
        WithResistance {
            friction: self.stribeck(),
            rolling: self.size(0.1),
            spinning: self.size(0.1),
            turn_speed: self.size(1.0),
        }
    }
}

/// Each law of this crate, also with differences in place of its Jacobian.
fn assert_all_pass<R: Real>(range: &FrictionRange<R>, octaves: u32) {
    let draw = CheckPlan::default().draw();
    let mut sizes = Sizes { draw, octaves };
    for seed in 0..40 {
        let plan = CheckPlan { seed, cases: 40 };
        let pass = |law: &dyn SlidingFriction<R>| {
            let found = check_friction(law, range, plan);
            assert!(found.is_ok(), "seed {seed}: {found:?}");
        };
        let (coulomb, smooth) = (sizes.coulomb::<R>(), sizes.smooth::<R>());
        let (stribeck, plastic) = (sizes.stribeck::<R>(), sizes.plastic::<R>());
        let (wood, rolls) = (sizes.wood::<R>(range.normal), sizes.rolls::<R>());
        let coefficient = sizes.size(1.0);
        let laws: [&dyn SlidingFriction<R>; 6] =
            [&coulomb, &smooth, &stribeck, &plastic, &wood, &rolls];
        for law in laws {
            pass(law);
            pass(&Plain(law));
        }
        pass(&Frictionless);
        pass(&Viscous { coefficient });
        pass(&FrictionPatch {
            outside: smooth,
            inside: plastic,
            region: Region::Ball {
                centre: range.centre,
                radius: range.size,
            },
        });
        pass(&FrictionPatch {
            outside: coulomb,
            inside: wood,
            region: Region::Ball {
                centre: range.centre,
                radius: range.size,
            },
        });
        pass(&FrictionField::new(move |position: R::Vec3| Coulomb {
            coefficient: coulomb.coefficient * (R::ONE + position.x() * position.x()),
            ..coulomb
        }));
        pass(&(coulomb, wood, stribeck, rolls));
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
