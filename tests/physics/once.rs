//! [`Once`] has the bits of the method that it contains, and the stepper of [`erased`] those of one
//! that names its parts: the other tests may use them in their place.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::kit::erased;
use crate::kit::once::Once;
use tumble::glam::DVec3;
use tumble::{
    AdaptiveEnergyMomentum, AdaptiveNystrom, AirDrag, AnyIntegrator, BogackiShampine32, Coin,
    Coulomb, Cuboid, Disc, DormandPrince54, Elevation, EnergyMomentum, FlatGround, Flight, Force,
    Gravity, Ground, Integrator, MovingGround, NoForce, Radau5, Real, RigidPointBody,
    SlidingFriction, SpringDamper, SpringDamperGround, State, Step, StepError, Stepper, Terrain,
    Trial, UniformGravity,
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

/// Checks that a method takes the same steps from `start` with and without [`Once`], and in a
/// scene whose type does not name its parts: body, ground, friction and applied force.
fn same_steps<R, B, G, F, E, I>(
    name: &str,
    (body, ground, friction, force): (B, G, F, E),
    method: I,
    start: State<R>,
) -> Vec<Result<(Step<R>, State<R>), StepError>>
where
    R: Real,
    B: RigidPointBody<R> + Copy,
    G: SpringDamperGround<R> + Copy,
    F: SlidingFriction<R> + Copy,
    E: Force<R> + Copy,
    I: Integrator<R> + Copy,
{
    macro_rules! composed {
        ($stepper:ident) => {
            $stepper::builder(body)
                .gravity(UniformGravity::down(R::from_f64(Trial::<R>::GRAVITY)))
                .ground(ground)
                .friction(friction)
                .force(force)
                .integrator(method)
                .build()
                .unwrap()
        };
    }
    let plain = composed!(Stepper);
    let once = plain.with_integrator(Once(method)).unwrap();
    let erased = {
        use erased::Stepper;
        composed!(Stepper)
    };
    let taken = steps(&plain, start);
    // As text, in which a number that is not one is equal to itself, and -0 is not 0.
    let text = format!("{taken:?}");
    assert!(text == format!("{:?}", steps(&once, start)), "{name}, once");
    assert!(
        text == format!("{:?}", steps(&erased, start)),
        "{name}, erased"
    );
    taken
}

/// Runs a block with each method of one step size, by the method's own type and by name.
macro_rules! each_type {
    ($time_step:expr, |$method:ident, $name:ident| $block:block) => {
        each_type!(@ $time_step, |$method, $name| $block,
            ForwardEuler SymplecticEuler StrangSplitting Rk4 Nystrom EnergyMomentum)
    };
    (@ $time_step:expr, |$method:ident, $name:ident| $block:block, $($type:ident)*) => {$({
        let ($method, $name) = (tumble::$type { time_step: $time_step }, stringify!($type));
        $block
    })*};
}

/// Returns true if a contact has turned the body in one of the steps.
fn has_touched<R: Real>(
    steps: &[Result<(Step<R>, State<R>), StepError>],
    start: &State<R>,
) -> bool {
    let turned = |(_, state): &(_, State<R>)| state.angular_momentum != start.angular_momentum;
    steps.iter().flatten().any(turned)
}

/// Coin, ground and friction of trial 3 of the report, and its start.
fn trial<R: Real>() -> ((Coin<R>, FlatGround<R>, Coulomb<R>, NoForce), State<R>) {
    let trial = Trial::report(3).unwrap();
    let parts = (trial.coin(), trial.ground(), trial.friction(), NoForce);
    (parts, trial.state())
}

#[test]
fn the_coin_of_the_report_has_the_same_bits_with_every_method() {
    let (parts, start) = trial();
    each_type!(1e-3, |method, name| {
        let steps = same_steps(name, parts, method, start);
        assert!(has_touched(&steps, &start), "{name}");
    });
    let flight = Flight(EnergyMomentum { time_step: 1e-3 });
    same_steps("flight", parts, flight, start);
    macro_rules! adaptive {
        ($($method:ident)*) => {
            $(same_steps(stringify!($method), parts, $method::new(1e-4), start);)*
        };
    }
    adaptive!(BogackiShampine32 DormandPrince54 AdaptiveEnergyMomentum AdaptiveNystrom Radau5);
    let any = AnyIntegrator::from(EnergyMomentum { time_step: 1e-3 });
    same_steps("any", parts, any, start);
}

#[test]
fn the_coin_of_the_report_has_the_same_bits_in_single_precision() {
    let (parts, start) = trial::<f32>();
    let method = EnergyMomentum { time_step: 1e-3 };
    let steps = same_steps("f32", parts, method, start);
    assert!(has_touched(&steps, &start));
}

#[test]
fn a_ground_that_breaks_its_contract_is_found_in_the_same_step() {
    // The law of a user is tested value by value. Beyond 0.1 m its height is not a number.
    let field = |x: f64, _y: f64| {
        let height = if x > 0.1 { f64::NAN } else { 0.01 * x };
        Elevation::new(height, [0.01, 0.0])
    };
    let ground = Ground {
        law: SpringDamper {
            stiffness: 1e3,
            damping: 2.0,
        },
        shape: Terrain::of(field),
    };
    let friction = Coulomb {
        coefficient: 0.3,
        slip_speed: 1e-3,
    };
    let cuboid = Cuboid::solid(1.0, DVec3::new(0.1, 0.2, 0.18));
    let start = State::at(DVec3::Z * 0.09).with_linear_velocity(DVec3::X);
    each_type!(1e-3, |method, name| {
        let steps = same_steps(name, (cuboid, ground, friction, NoForce), method, start);
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
    let friction = Coulomb {
        coefficient: 0.3,
        slip_speed: 1e-3,
    };
    let drag = AirDrag::quadratic(1.1, 0.03, 1.2);
    let disc = Disc::solid(1.0, 0.1, 60);
    let steps = same_steps(
        "a rim on a belt",
        (disc, ground, friction, drag),
        method,
        start,
    );
    let worked = |(step, _): &(Step, State)| step.drive_work.abs() > 0.0;
    assert!(steps.iter().flatten().any(worked));
}
