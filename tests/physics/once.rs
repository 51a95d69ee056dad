//! [`Once`] has the bits of the method that it contains: the other tests may use it in its place.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::kit::each_method;
use crate::kit::once::Once;
use tumble::glam::DVec3;
use tumble::{
    AdaptiveEnergyMomentum, AdaptiveNystrom, AirDrag, BogackiShampine32, Coulomb, Cuboid, Disc,
    DormandPrince54, Elevation, EnergyMomentum, FlatGround, Flight, Force, Gravity, Ground,
    Integrator, MovingGround, Radau5, Real, RigidPointBody, SlidingFriction, SpringDamper,
    SpringDamperGround, State, Step, StepError, Stepper, Terrain, Trial, UniformGravity,
};

/// The first steps of a method from `start`, each with the state after it, up to an error.
fn steps<R, B, G, F, A, I, E>(
    stepper: &Stepper<B, G, F, A, I, R, E>,
    start: State<R>,
) -> Vec<Result<(Step<R>, State<R>), StepError>>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    A: Gravity<R>,
    I: Integrator<R>,
    E: Force<R>,
{
    let mut session = stepper.session(start);
    let mut steps = Vec::new();
    while steps.len() < 400 && !matches!(steps.last(), Some(Err(_))) {
        let step = session.step();
        steps.push(step.map(|step| (step, *session.state())));
    }
    steps
}

/// Checks that a method takes the same steps from `start` with and without [`Once`].
macro_rules! assert_same_steps {
    ($name:expr, $method:expr, $start:expr, $compose:expr) => {{
        let (plain, once) = ($compose($method).unwrap(), $compose(Once($method)).unwrap());
        let (plain, once) = (steps(&plain, $start), steps(&once, $start));
        // As text, in which a number that is not one is equal to itself, and -0 is not 0.
        assert!(format!("{plain:?}") == format!("{once:?}"), "{}", $name);
        plain
    }};
}

/// Returns true if a contact has turned the body in one of the steps.
fn has_touched<R: Real>(
    steps: &[Result<(Step<R>, State<R>), StepError>],
    start: &State<R>,
) -> bool {
    let turned = |(_, state): &(_, State<R>)| state.angular_momentum != start.angular_momentum;
    steps.iter().flatten().any(turned)
}

fn trial() -> Trial {
    Trial::report(3).unwrap()
}

#[test]
fn the_coin_of_the_report_has_the_same_bits_with_every_method() {
    let start = trial().state();
    each_method!(1e-3, |method, name| {
        assert_same_steps!(name, method, start, |by| trial().stepper(by));
    });
    let flight = Flight(EnergyMomentum { time_step: 1e-3 });
    assert_same_steps!("flight", flight, start, |by| trial().stepper(by));
    macro_rules! adaptive {
        ($($method:ident)*) => {
            $(assert_same_steps!(
                stringify!($method),
                $method::new(1e-4),
                start,
                |by| trial().stepper(by)
            );)*
        };
    }
    adaptive!(BogackiShampine32 DormandPrince54 AdaptiveEnergyMomentum AdaptiveNystrom Radau5);
}

#[test]
fn the_coin_of_the_report_has_the_same_bits_in_single_precision() {
    let trial = Trial::<f32>::report(3).unwrap();
    let method = EnergyMomentum { time_step: 1e-3 };
    let steps = assert_same_steps!("f32", method, trial.state(), |by| trial.stepper(by));
    assert!(has_touched(&steps, &trial.state()));
}

#[test]
fn a_ground_that_breaks_its_contract_is_found_in_the_same_step() {
    // The law of a user is tested value by value. Beyond 0.1 m its height is not a number.
    let field = |x: f64, _y: f64| {
        let height = if x > 0.1 { f64::NAN } else { 0.01 * x };
        Elevation::new(height, [0.01, 0.0])
    };
    let law = SpringDamper {
        stiffness: 1e3,
        damping: 2.0,
    };
    let start = State::at(DVec3::Z * 0.09).with_linear_velocity(DVec3::X);
    each_method!(1e-3, |method, name| {
        let steps = assert_same_steps!(name, method, start, |by| {
            Stepper::builder(Cuboid::solid(1.0, DVec3::new(0.1, 0.2, 0.18)))
                .gravity(UniformGravity::down(9.8))
                .ground(Ground {
                    law,
                    shape: Terrain::of(field),
                })
                .friction(Coulomb {
                    coefficient: 0.3,
                    slip_speed: 1e-3,
                })
                .integrator(by)
                .build()
        });
        assert!(has_touched(&steps, &start), "{name}");
        let error = steps.last().unwrap();
        let is_broken = matches!(error, Err(StepError::BrokenLaw { .. }));
        assert!(is_broken, "{name}: {error:?}");
    });
}

#[test]
fn a_rim_on_a_belt_in_air_has_the_same_bits() {
    let ground = MovingGround::conveyor(FlatGround::level(1e4, 20.0), DVec3::X * 0.5);
    let start = State::at(DVec3::Z * 0.12)
        .with_rotation_vector(DVec3::new(0.2, 0.4, 0.1))
        .with_angular_momentum(DVec3::new(0.02, 0.01, 0.0));
    let method = EnergyMomentum { time_step: 1e-3 };
    let steps = assert_same_steps!("a rim on a belt", method, start, |by| {
        Stepper::builder(Disc::solid(1.0, 0.1, 60))
            .gravity(UniformGravity::down(9.8))
            .ground(ground)
            .friction(Coulomb {
                coefficient: 0.3,
                slip_speed: 1e-3,
            })
            .force(AirDrag::quadratic(1.1, 0.03, 1.2))
            .integrator(by)
            .build()
    });
    let worked = |(step, _): &(Step, State)| step.drive_work.abs() > 0.0;
    assert!(steps.iter().flatten().any(worked));
}
