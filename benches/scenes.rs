//! Scenes that the benchmarks share: four phases of trial 1, with 12, 120 or 1200 points.

// Each benchmark uses a different part of the file.
#![allow(dead_code)]
// A benchmark that fails ends with a panic.
#![allow(clippy::unwrap_used)]

use core::ops::ControlFlow;

use tumble::glam::{DQuat, DVec3};
use tumble::{
    AirDrag, Apex, Coin, ContactPoint, Coulomb, Cuboid, Disc, Event, FlatGround, Force,
    FrictionField, FrictionJacobian, FrictionPatch, Gravity, Ground, GroundBounds, HuntCrossley,
    Integrator, Landing, LiftOff, MeanForce, MovingGround, Plane, Region, RigidPointBody,
    SlidingFriction, SpinDrag, SpinLift, SpringDamperGround, State, Stepper, Surface, ThickDisc,
    Trial, UniformGravity, Wind, WithResistance,
};

/// Step size of the coin report, s.
pub(crate) const TIME_STEP: f64 = 1e-4;

/// Number of steps of a phase. A measurement takes these steps and starts again, so that the phase
/// does not change.
pub(crate) const STEPS: u32 = 1000;

/// Phase of the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    /// Three metres high and spinning: nothing touches.
    Flight,
    /// The start of trial 1: it rolls on its rim, 15 degrees from upright; 3 to 6 of 120 points
    /// touch.
    Upright,
    /// Trial 1 at t = 15 s: it tumbles, 16 degrees from flat; 5 to 7 of 120 points touch.
    Tumbling,
    /// Flat on the ground, at rest: all points touch.
    Rest,
}

impl Phase {
    pub(crate) const ALL: [Self; 4] = [Self::Flight, Self::Upright, Self::Tumbling, Self::Rest];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Flight => "flight",
            Self::Upright => "upright",
            Self::Tumbling => "tumbling",
            Self::Rest => "rest",
        }
    }

    pub(crate) fn state(self) -> State {
        match self {
            Self::Flight => State {
                position: DVec3::new(0.0, 0.0, 3.0),
                linear_velocity: DVec3::new(0.5, 0.0, 2.0),
                ..trial_1().state()
            },
            Self::Upright => trial_1().state(),
            // Taken from a run of `StrangSplitting` with this step size.
            Self::Tumbling => State {
                position: DVec3::new(1.8045000262650326, -1.0858973814216588, 0.13355363851744725),
                linear_velocity: DVec3::new(
                    0.04625249458272729,
                    0.07989534722088171,
                    0.14849411243599242,
                ),
                orientation: DQuat::from_xyzw(
                    -0.12272222338871726,
                    -0.7710593339504414,
                    0.1971235281257335,
                    -0.592915739438324,
                ),
                angular_momentum: DVec3::new(
                    -0.27987993527479316,
                    -0.0078086557169935785,
                    0.04029300250255166,
                ),
            },
            Self::Rest => {
                let depth = Trial::<f64>::GRAVITY / (120.0 * Trial::<f64>::STIFFNESS);
                State::at(DVec3::new(0.0, 0.0, -depth)).with_rotation_vector(DVec3::new(
                    0.0,
                    core::f64::consts::FRAC_PI_2,
                    0.0,
                ))
            }
        }
    }
}

pub(crate) fn trial_1() -> Trial {
    Trial::report(1).unwrap()
}

/// The coin of the coin report with any number of points.
pub(crate) type Ring = Coin<f64, Vec<ContactPoint>>;

/// Returns the coin of the coin report with `points` points.
pub(crate) fn ring(points: usize) -> Ring {
    let storage = vec![ContactPoint::default(); points];
    Coin::ring_with_storage(storage, Trial::<f64>::MASS, Trial::<f64>::RADIUS)
}

/// Returns the coin of the coin report with a round rim.
pub(crate) fn round() -> Disc {
    Disc::ring(Trial::<f64>::MASS, Trial::<f64>::RADIUS, 120)
}

/// Returns a coin of a tenth of the radius in thickness, with two round rims.
pub(crate) fn thick() -> ThickDisc {
    let radius = Trial::<f64>::RADIUS;
    ThickDisc::solid(Trial::<f64>::MASS, radius, 0.1 * radius, 120)
}

/// Returns the state of a phase, raised so that the lower rim of [`thick`] is as deep in the ground
/// as that of the thin coin.
pub(crate) fn on_one_rim(phase: Phase) -> State {
    let mut state = phase.state();
    let normal = state.orientation * DVec3::X;
    state.position.z += 0.5 * thick().thickness() * normal.z.abs();
    state
}

/// Returns a box with three different moments of inertia, m.
pub(crate) fn cuboid() -> Cuboid {
    Cuboid::solid(Trial::<f64>::MASS, DVec3::new(0.3, 0.6, 0.9))
}

/// Returns the ground for a coin of `points` points. Its total stiffness and damping are those of
/// the 120 points of the coin report.
pub(crate) fn ground(points: usize) -> FlatGround {
    let share = 120.0 / points as f64;
    FlatGround::level(
        Trial::<f64>::STIFFNESS * share,
        Trial::<f64>::DAMPING * share,
    )
}

/// Stepper of any body in the scene of trial 1, with the ground of [`ground`].
pub(crate) type SceneStepper<B, I> = Stepper<B, FlatGround, Coulomb, UniformGravity, I>;

/// Returns the stepper of `body` in the scene of trial 1.
pub(crate) fn stepper<B: RigidPointBody, I: Integrator>(
    body: B,
    integrator: I,
) -> SceneStepper<B, I> {
    // A round rim represents the 120 points of the coin report.
    let points = match body.contacts().len() {
        0 => 120,
        points => points,
    };
    Stepper::new(body)
        .and_then(|stepper| stepper.with_ground(ground(points)))
        .and_then(|stepper| stepper.with_friction(trial_1().friction()))
        .and_then(|stepper| stepper.with_gravity(trial_1().gravity()))
        .and_then(|stepper| stepper.with_integrator(integrator))
        .unwrap()
}

/// A law that does not say that it is trusted, as a user writes it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Own<L>(L);

impl<G: SpringDamperGround> SpringDamperGround for Own<G> {
    fn surface(&self, point: DVec3) -> Surface {
        self.0.surface(point)
    }
    fn spring_force(&self, depth: f64) -> f64 {
        self.0.spring_force(depth)
    }
    fn spring_energy(&self, depth: f64) -> f64 {
        self.0.spring_energy(depth)
    }
    fn normal_force(&self, depth: f64, closing_speed: f64) -> f64 {
        self.0.normal_force(depth, closing_speed)
    }
    fn mean_force(&self, start: f64, end: f64, seconds: f64) -> MeanForce {
        self.0.mean_force(start, end, seconds)
    }
    fn bounds(&self) -> GroundBounds {
        self.0.bounds()
    }
}

impl<F: SlidingFriction> SlidingFriction for Own<F> {
    fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
        self.0.force(normal_force, slip)
    }
    fn jacobian(&self, normal_force: f64, slip: DVec3) -> FrictionJacobian {
        self.0.jacobian(normal_force, slip)
    }
}

/// The report's coin in the scene of trial 1, on laws that every step tests.
pub(crate) fn own_laws<I: Integrator>(
    integrator: I,
) -> Stepper<Ring, Own<FlatGround>, Own<Coulomb>, UniformGravity, I> {
    Stepper::new(ring(120))
        .and_then(|stepper| stepper.with_ground(Own(ground(120))))
        .and_then(|stepper| stepper.with_friction(Own(trial_1().friction())))
        .and_then(|stepper| stepper.with_gravity(trial_1().gravity()))
        .and_then(|stepper| stepper.with_integrator(integrator))
        .unwrap()
}

/// What a scene may have beside a body on a level ground with Coulomb's friction, with the names of
/// the tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// A ground that is not level, by a millionth, so that the motion stays the same.
    Tilt,
    /// Hunt and Crossley's law with Hertz's exponent.
    HuntCrossley,
    /// Another coefficient of friction on a half of the ground.
    Patch,
    /// The same by a function of the position, which is trusted.
    Field,
    /// Four walls that the body does not reach.
    Walls,
    /// A belt under the body.
    Belt,
    /// Rolling resistance and spinning friction.
    Resistance,
    /// Quadratic drag.
    Drag,
    /// Quadratic drag, lift and drag of the spin.
    Air,
    /// These in wind.
    Wind,
}

impl Part {
    pub(crate) const ALL: [(&'static str, Self); 10] = [
        ("tilt", Self::Tilt),
        ("hertz", Self::HuntCrossley),
        ("patch", Self::Patch),
        ("field", Self::Field),
        ("walls", Self::Walls),
        ("belt", Self::Belt),
        ("rolling", Self::Resistance),
        ("drag", Self::Drag),
        ("air", Self::Air),
        ("wind", Self::Wind),
    ];

    pub(crate) fn named(name: &str) -> Option<Self> {
        let found = Self::ALL.into_iter().find(|(one, _)| *one == name);
        found.map(|(_, part)| part)
    }
}

/// Drag, lift and drag of the spin of a ball as large as the coin, in air of 1.2 kg/m³.
pub(crate) fn air() -> (AirDrag, SpinLift, SpinDrag) {
    (
        drag(),
        SpinLift::tennis_ball(Trial::<f64>::RADIUS, 1.2),
        SpinDrag::quadratic(0.05, Trial::<f64>::RADIUS, 1.2),
    )
}

pub(crate) fn drag() -> AirDrag {
    let area = core::f64::consts::PI * Trial::<f64>::RADIUS * Trial::<f64>::RADIUS;
    AirDrag::quadratic(0.5, area, 1.2)
}

pub(crate) fn wind() -> Wind<(AirDrag, SpinLift, SpinDrag)> {
    Wind {
        velocity: DVec3::new(3.0, 1.0, 0.0),
        force: air(),
    }
}

pub(crate) fn tilted() -> FlatGround {
    let normal = DVec3::new(1e-6, 0.0, 1.0).normalize();
    ground(120).on(Plane {
        normal,
        height: 0.0,
    })
}

/// Hertz's law that holds the coin at the depth of the linear ground.
pub(crate) fn hunt_crossley() -> Ground<HuntCrossley> {
    let depth = Trial::<f64>::MASS * Trial::<f64>::GRAVITY / (120.0 * Trial::<f64>::STIFFNESS);
    Ground::level(HuntCrossley {
        stiffness: Trial::<f64>::STIFFNESS / depth.sqrt(),
        exponent: 1.5,
        damping: 0.5,
    })
}

pub(crate) fn patch() -> FrictionPatch<Coulomb, Coulomb> {
    let outside = trial_1().friction();
    FrictionPatch {
        outside,
        inside: Coulomb {
            coefficient: 0.1,
            ..outside
        },
        region: Region::HalfSpace {
            across: DVec3::X,
            from: 1.0,
        },
    }
}

pub(crate) fn field() -> FrictionField<fn(DVec3) -> Coulomb> {
    let law_at: fn(DVec3) -> Coulomb = |position| {
        let rough = trial_1().friction();
        let coefficient = if position.x < 1.0 {
            rough.coefficient
        } else {
            0.1
        };
        Coulomb {
            coefficient,
            ..rough
        }
    };
    FrictionField::new(law_at).trusted()
}

/// The level ground and four walls, 20 m from the start.
pub(crate) fn walls() -> [FlatGround; 5] {
    let wall = |inwards: DVec3| ground(120).on(Plane::through(inwards * -20.0, inwards));
    let [x, y] = [DVec3::X, DVec3::Y];
    [ground(120), wall(x), wall(-x), wall(y), wall(-y)]
}

pub(crate) fn belt() -> MovingGround<FlatGround> {
    MovingGround::conveyor(ground(120), DVec3::X * 0.1)
}

pub(crate) fn resistance() -> WithResistance<Coulomb> {
    WithResistance {
        friction: trial_1().friction(),
        rolling: 1e-4,
        spinning: 1e-4,
        turn_speed: 1e-2,
    }
}

/// Takes steps of the method, with one workspace, for any type of stepper.
pub(crate) trait Advance {
    fn advance(&self, start: &State, steps: u32) -> State;
}

impl<B, G, F, A, I, E> Advance for Stepper<B, G, F, A, I, f64, E>
where
    B: RigidPointBody,
    G: SpringDamperGround,
    F: SlidingFriction,
    A: Gravity,
    I: Integrator,
    E: Force,
{
    #[inline]
    fn advance(&self, start: &State, steps: u32) -> State {
        let (mut state, mut workspace) = (*start, I::Workspace::default());
        for _ in 0..steps {
            let step = (self.integrator()).step(self.scene(), &mut state, f64::MAX, &mut workspace);
            step.unwrap();
        }
        state
    }
}

/// Runs for the time of `steps` steps with three events. Two of them evaluate the lowest point.
#[inline(never)]
pub(crate) fn steps_with_events(
    stepper: &SceneStepper<Ring, impl Integrator>,
    start: &State,
    steps: u32,
) -> State {
    let mut session = stepper.session(*start);
    let events: [&dyn Event; 3] = [&Landing, &LiftOff, &Apex];
    let seconds = TIME_STEP * f64::from(steps);
    let end = session.run_with_events(seconds, events, |_| ControlFlow::Continue(()));
    assert!(end.is_ok(), "{end:?}");
    *session.state()
}

/// Runs for the time of `steps` steps. The stepper tests the values of laws that are not trusted.
#[inline(never)]
pub(crate) fn steps_of_run<B, G, F, I>(
    stepper: &Stepper<B, G, F, UniformGravity, I>,
    start: &State,
    steps: u32,
) -> State
where
    B: RigidPointBody,
    G: SpringDamperGround,
    F: SlidingFriction,
    I: Integrator,
{
    let mut state = *start;
    let seconds = TIME_STEP * f64::from(steps);
    stepper.run(&mut state, seconds, &mut ()).unwrap();
    state
}

/// Takes `steps` steps in a session, which has a clock and detects rest.
#[inline(never)]
pub(crate) fn steps_of_session(
    stepper: &SceneStepper<Ring, impl Integrator>,
    start: &State,
    steps: u32,
) -> State {
    let mut session = stepper.session(*start);
    for _ in 0..steps {
        session.step().unwrap();
    }
    session.into_state()
}

/// Takes `steps` steps from `start`. This loop is timed and counted.
#[inline(never)]
pub(crate) fn steps<S: Advance>(stepper: &S, start: &State, steps: u32) -> State {
    stepper.advance(start, steps)
}
