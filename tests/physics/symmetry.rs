//! Symmetries: mirror images, rotations and shifts of the scene, interruptions of a run, and the
//! number type.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::kit::erased::Stepper;
use crate::kit::{
    self, angle_between, difference, directions, each_explicit, each_method, log_uniform, zero_or,
};
use core::ops::ControlFlow;
use proptest::prelude::*;
use tumble::glam::{DQuat, DVec3, Vec3};
use tumble::trial::TrialStepper;
use tumble::{
    AdaptiveEnergyMomentum, AdaptiveNystrom, AnyIntegrator, BogackiShampine32, Coin, ContactPoint,
    DormandPrince54, EnergyMomentum, FlatGround, Flight, Force, ForwardEuler, Gravity, Integrator,
    Nystrom, Plane, PointCloud, PointMass, Radau5, Real, RigidPointBody, Rk4, Rod, Sample,
    SavedSession, SlidingFriction, SmoothCoulomb, SpringDamperGround, State, StepError,
    StrangSplitting, SymplecticEuler, Trial, UniformGravity,
};

// -----------------------------------------------------------------------------------------------
// A scene whose every part can be mirrored, turned and moved
// -----------------------------------------------------------------------------------------------

/// Points with masses on a tilted ground, thrown: everything that has a direction.
#[derive(Clone, Debug)]
struct Throw {
    points: Vec<DVec3>,
    masses: Vec<f64>,
    /// Out of the ground; the plane goes through the origin.
    normal: DVec3,
    gravity: DVec3,
    stiffness: f64,
    damping: f64,
    friction: SmoothCoulomb,
    state: State,
}

type Cloud = PointCloud<f64, Vec<ContactPoint>>;

impl Throw {
    fn body(&self) -> Cloud {
        let points: Vec<_> = self
            .points
            .iter()
            .copied()
            .map(ContactPoint::bare)
            .collect();
        PointCloud::with_storage(points, &self.masses).unwrap()
    }

    /// The scene.
    fn stepper<I: Integrator>(&self, integrator: I) -> Stepper<'static, I> {
        let plane = Plane {
            normal: self.normal,
            height: 0.0,
        };
        Stepper::new(self.body())
            .unwrap()
            .with_ground(FlatGround::level(self.stiffness, self.damping).on(plane))
            .unwrap()
            .with_friction(self.friction)
            .unwrap()
            .with_gravity(UniformGravity {
                acceleration: self.gravity,
            })
            .unwrap()
            .with_integrator(integrator)
            .unwrap()
    }

    /// `from` after `steps` steps.
    fn go(&self, integrator: impl Integrator, from: State, steps: u32) -> Result<State, StepError> {
        let stepper = self.stepper(integrator);
        let mut state = from;
        for _ in 0..steps {
            stepper.step(&mut state)?;
        }
        Ok(state)
    }

    /// `state` after `seconds`.
    fn advance(
        &self,
        integrator: impl Integrator,
        state: &mut State,
        seconds: f64,
    ) -> Result<(), StepError> {
        self.stepper(integrator).advance(state, seconds)
    }

    /// The states after each tenth of `steps` steps.
    fn path(
        &self,
        integrator: impl Integrator + Copy,
        steps: u32,
    ) -> Result<Vec<State>, StepError> {
        let mut state = self.state;
        let mut tenth = || {
            state = self.go(integrator, state, steps / 10)?;
            Ok(state)
        };
        (0..10).map(|_| tenth()).collect()
    }
}

/// Throws that meet the ground soon, with springs that a step of 1e-3 s follows.
fn throws() -> impl Strategy<Value = Throw> {
    let component = || -1.0..1.0_f64;
    let place = (component(), component(), component()).prop_map(DVec3::from);
    let points = prop::collection::vec((place, 0.1..1.0_f64), 1..9);
    let tilt = (directions(), 0.0..0.4_f64)
        .prop_map(|(axis, angle)| (DQuat::from_axis_angle(axis, angle) * DVec3::Z).normalize());
    let ground = (
        prop_oneof![Just(DVec3::Z), tilt],
        log_uniform(10.0, 3e3),
        zero_or(1e-2, 10.0),
    );
    let friction = (zero_or(1e-2, 2.0), log_uniform(1e-3, 1.0));
    let motion = (
        directions(),
        zero_or(0.1, 5.0),
        kit::orientations(),
        directions(),
        zero_or(0.1, 5.0),
    );
    (points, ground, friction, motion).prop_map(
        |(points, (normal, stiffness, damping), (coefficient, slip_speed), motion)| {
            let (mut points, masses): (Vec<_>, Vec<_>) = points.into_iter().unzip();
            // A single point is one at the origin.
            if let [point] = points.as_mut_slice() {
                *point = DVec3::ZERO;
            }
            let (heading, speed, orientation, axis, momentum) = motion;
            Throw {
                points,
                masses,
                normal,
                gravity: DVec3::new(0.0, 0.0, -9.8),
                stiffness,
                damping,
                friction: SmoothCoulomb {
                    coefficient,
                    slip_speed,
                },
                state: State::at(normal * 0.5)
                    .with_linear_velocity(heading * speed)
                    .with_orientation(orientation)
                    .with_angular_momentum(axis * momentum),
            }
        },
    )
}

// -----------------------------------------------------------------------------------------------
// Mirrors
// -----------------------------------------------------------------------------------------------

/// Mirror image of a position, velocity or force in the coordinate plane perpendicular to an axis.
fn mirrored(axis: usize, vector: DVec3) -> DVec3 {
    let mut image = vector;
    image[axis] = -image[axis];
    image
}

/// Mirror image of a state. Angular momentum and the quaternion's vector part are axial: the mirror
/// keeps the component along the axis and changes the sign of the others.
fn mirrored_state(axis: usize, state: &State) -> State {
    let axial = |vector: DVec3| -mirrored(axis, vector);
    let turn = axial(state.orientation.xyz());
    State {
        position: mirrored(axis, state.position),
        linear_velocity: mirrored(axis, state.linear_velocity),
        orientation: DQuat::from_xyzw(turn.x, turn.y, turn.z, state.orientation.w),
        angular_momentum: axial(state.angular_momentum),
    }
}

fn mirrored_throw(axis: usize, throw: &Throw) -> Throw {
    let image = |vector| mirrored(axis, vector);
    Throw {
        points: throw.points.iter().copied().map(image).collect(),
        normal: image(throw.normal),
        gravity: image(throw.gravity),
        state: mirrored_state(axis, &throw.state),
        ..throw.clone()
    }
}

/// Returns true if all points lie on one line, to rounding.
fn on_a_line(points: &[DVec3]) -> bool {
    let arms = || points.iter().map(|&point| point - points[0]);
    let longest = arms().fold(DVec3::ZERO, |a, b| {
        if b.length_squared() > a.length_squared() {
            b
        } else {
            a
        }
    });
    arms().all(|arm| arm.cross(longest).length() <= 1e-6 * longest.length_squared())
}

proptest! {
    #![proptest_config(kit::cases(150))]

    /// Checks every bit for every method except `EnergyMomentum`: a mirror in a coordinate plane
    /// only changes signs, and rounding to nearest does not depend on signs.
    #[test]
    fn the_mirror_image_of_a_throw_takes_the_mirror_image_of_the_path(throw in throws(), axis in 0..3_usize) {
        // The principal axes across a rod are any two: which ones are found depends on the sign of
        // a rounding.
        prop_assume!(throw.points.len() == 1 || !on_a_line(&throw.points));
        // A level ground is summed without what is 0 there, its image, a ceiling, with it.
        prop_assume!(axis != 2 || throw.normal.z.abs() < 1.0);
        let image = mirrored_throw(axis, &throw);
        each_method!(1e-3, |integrator, method| {
            let path = throw.path(integrator, 500);
            let of_image = image.path(integrator, 500);
            let expected = path.map(|path| path.iter().map(|state| mirrored_state(axis, state)).collect::<Vec<_>>());
            // In flight its energy limiter tries last places of the orientation in directions of
            // the axes, which are not mirrored. The paths differ by such last places, which
            // contacts amplify.
            if !method.contains("EnergyMomentum") {
                prop_assert_eq!(of_image, expected, "{}", method);
            }
        });
    }
}

#[test]
fn a_coin_that_leans_left_rolls_like_one_that_leans_right() {
    // The coin's points change order in a mirror, so the sums round differently: 1e-16 a step,
    // which the motion amplifies. The amplification is measured as well.
    let trial = Trial {
        slip_speed: 1e-3,
        ..Trial::report(1).unwrap()
    };
    let stepper = trial.stepper(StrangSplitting { time_step: 1e-3 }).unwrap();
    let after = |mut state: State| {
        stepper.advance(&mut state, 1.0).unwrap();
        state
    };
    let start = trial.state();
    let end = after(start);
    // Its own mirror plane is xz: y changes sign. The coin's point k goes to n - k.
    let image = after(mirrored_state(1, &start));
    let nudge = 1e-9;
    let nudged = after(start.with_angular_momentum(start.angular_momentum * (1.0 + nudge)));
    let growth = difference(&end, &nudged) / nudge;
    let miss = difference(&mirrored_state(1, &end), &image);
    // A thousand steps, each of some 1e-15 (sums over ten contacts), amplified at most as the nudge
    // was.
    assert!(
        miss <= 1e-15 * 1000.0 * growth.max(1.0),
        "{miss:e}, growth {growth}"
    );
}

// -----------------------------------------------------------------------------------------------
// Turns about the vertical, and moves along the ground
// -----------------------------------------------------------------------------------------------

/// A state rotated about the origin.
fn turned(turn: DQuat, state: &State) -> State {
    State {
        position: turn * state.position,
        linear_velocity: turn * state.linear_velocity,
        orientation: turn * state.orientation,
        angular_momentum: turn * state.angular_momentum,
    }
}

proptest! {
    #![proptest_config(kit::cases(100))]

    /// No horizontal direction is special: a scene that is rotated about any axis, with ground and
    /// gravity, has the same motion rotated.
    #[test]
    fn a_throw_in_a_turned_world_takes_the_turned_path(
        throw in throws(), axis in directions(), angle in -3.2..3.2_f64,
    ) {
        // Soft springs and nearly viscous friction: where an explicit step chatters, it amplifies
        // rounding at its own whim.
        let friction = SmoothCoulomb { coefficient: throw.friction.coefficient.min(0.3), slip_speed: 1.0 };
        let throw = Throw { friction, stiffness: throw.stiffness.min(100.0), ..throw };
        let turn = DQuat::from_axis_angle(axis, angle);
        let elsewhere = Throw {
            normal: (turn * throw.normal).normalize(),
            gravity: turn * throw.gravity,
            state: turned(turn, &throw.state),
            ..throw.clone()
        };
        // The amplification of 1e-15 in the rotated start is measured by a shift of 1e-9, which is
        // far above rounding.
        let nudge = 1e-9;
        let nudged = Throw {
            state: State { angular_momentum: throw.state.angular_momentum + DVec3::ONE * nudge, position: throw.state.position + DVec3::ONE * nudge, ..throw.state },
            ..throw.clone()
        };
        each_method!(1e-3, |integrator, method| {
            let path = throw.path(integrator, 200);
            if let (Ok(path), Ok(there), Ok(beside)) = (path, elsewhere.path(integrator, 200), nudged.path(integrator, 200)) {
                let mut growth: f64 = 1.0;
                for ((here, there), beside) in path.iter().zip(there).zip(beside) {
                    growth = growth.max(difference(here, &beside) / nudge);
                    if growth > 1e4 {
                        // From here on the nudge measures no growth but a difference as large as
                        // the motion.
                        break;
                    }
                    let miss = difference(&turned(turn, here), &there);
                    // 200 steps, each of a few roundings of numbers up to 10; a nudge in one
                    // direction may miss the fastest growth tenfold. An implicit step is solved to
                    // 1.8e-12 of its momentum.
                    let each = if method == "EnergyMomentum" { 2e-12 } else { 2e-15 };
                    let allowed = 10.0 * growth * 200.0 * each;
                    prop_assert!(miss <= allowed, "{method}: {miss:e}, growth {growth}");
                }
            }
        });
    }

    /// Level ground is the same everywhere. Only the height enters the forces, so no bit of
    /// velocity, rotation and angular momentum changes.
    #[test]
    fn a_throw_that_begins_elsewhere_on_level_ground_is_the_same_throw(
        throw in throws(), x in -1e6..1e6_f64, y in -1e6..1e6_f64,
    ) {
        let throw = Throw { normal: DVec3::Z, state: State { position: DVec3::Z * 0.5, ..throw.state }, ..throw };
        let shift = DVec3::new(x, y, 0.0);
        let elsewhere = Throw { state: State { position: throw.state.position + shift, ..throw.state }, ..throw.clone() };
        each_explicit!(1e-3, |integrator, method| {
            if let (Ok(path), Ok(there)) = (throw.path(integrator, 500), elsewhere.path(integrator, 500)) {
                for (here, there) in path.iter().zip(there) {
                    prop_assert_eq!(here.linear_velocity, there.linear_velocity, "{}", method);
                    prop_assert_eq!(here.orientation, there.orientation, "{}", method);
                    prop_assert_eq!(here.angular_momentum, there.angular_momentum, "{}", method);
                    prop_assert_eq!(here.position.z.to_bits(), there.position.z.to_bits(), "{}", method);
                    // The position is known to its own last digit, 1.2e-10 m at 1e6 m, once or
                    // twice a step.
                    let miss = (there.position - here.position - shift).length();
                    prop_assert!(miss <= 1000.0 * f64::EPSILON * (shift.length() + 10.0), "{method}: {miss:e} m");
                }
            }
        });
    }
}

// -----------------------------------------------------------------------------------------------
// Stop and go on (promise G9)
// -----------------------------------------------------------------------------------------------

proptest! {
    #![proptest_config(kit::cases(60))]

    /// `State` has no hidden data: a copy taken at any time continues like the original, in another
    /// stepper of the same scene as well.
    #[test]
    fn a_run_that_is_stopped_anywhere_and_copied_goes_on_with_the_same_bits(throw in throws(), stop in 0..500_u32) {
        each_method!(1e-3, |integrator, method| {
            if let Ok(end) = throw.go(integrator, throw.state, 500) {
                let copy = throw.go(integrator, throw.state, stop).unwrap();
                let resumed = throw.go(integrator, copy, 500 - stop).unwrap();
                prop_assert_eq!(end, resumed, "{}", method);
            }
        });
    }
}

#[cfg(feature = "serde")]
proptest! {
    #![proptest_config(kit::cases(60))]

    /// Through JSON: sixteen or seventeen digits are all there are (and serde_json's
    /// `float_roundtrip` reads each of them).
    #[test]
    fn a_run_that_is_saved_to_json_and_loaded_goes_on_with_the_same_bits(throw in throws(), stop in 0..500_u32) {
        each_method!(1e-3, |integrator, method| {
            if let Ok(end) = throw.go(integrator, throw.state, 500) {
                let text = serde_json::to_string(&throw.go(integrator, throw.state, stop).unwrap()).unwrap();
                let loaded: State = serde_json::from_str(&text).unwrap();
                let resumed = throw.go(integrator, loaded, 500 - stop).unwrap();
                prop_assert_eq!(end, resumed, "{}", method);
            }
        });
    }
}

// -----------------------------------------------------------------------------------------------
// Sessions (promise G9)
// -----------------------------------------------------------------------------------------------

/// Written as JSON and read again, where the feature is there.
fn written_and_read(saved: SavedSession) -> SavedSession {
    #[cfg(feature = "serde")]
    let saved = serde_json::from_str(&serde_json::to_string(&saved).unwrap()).unwrap();
    saved
}

/// A session that is saved in the middle, and one that is not.
fn saved_or_not(stepper: &impl Sessions, parts: [f64; 2], start: State) -> [(State, f64, u64); 2] {
    stepper.saved_or_not(parts, start)
}

/// Steppers of the tests with any integrator.
trait Sessions {
    fn saved_or_not(&self, parts: [f64; 2], start: State) -> [(State, f64, u64); 2];
}

impl<B, G, F, A, I, E> Sessions for tumble::Stepper<B, G, F, A, I, f64, E>
where
    B: RigidPointBody,
    G: SpringDamperGround,
    F: SlidingFriction,
    A: Gravity,
    I: Integrator,
    E: Force,
{
    fn saved_or_not(&self, [first, second]: [f64; 2], start: State) -> [(State, f64, u64); 2] {
        let mut session = self.session(start);
        session.advance(first).unwrap();
        let saved = written_and_read(session.save());
        let mut resumed = self.resume(&saved).unwrap();
        for session in [&mut session, &mut resumed] {
            session.advance(second).unwrap();
            session.step().unwrap();
        }
        [session, resumed].map(|session| (*session.state(), session.time(), session.step_count()))
    }
}

proptest! {
    #![proptest_config(kit::cases(40))]

    /// The data that a session keeps change no bit of a method with a fixed step.
    #[test]
    fn a_session_with_a_fixed_step_has_the_bits_of_the_stepper(
        throw in throws(), parts in prop::collection::vec(1e-4..0.1_f64, 1..6),
    ) {
        each_method!(1e-3, |integrator, method| {
            let stepper = throw.stepper(integrator);
            let (mut state, mut session) = (throw.state, stepper.session(throw.state));
            for &part in &parts {
                prop_assert_eq!(session.advance(part), stepper.advance(&mut state, part), "{}", method);
                prop_assert_eq!(session.state(), &state, "{}", method);
            }
            let total: f64 = parts.iter().sum();
            prop_assert!((session.time() - total).abs() <= 1e-15, "{}", method);
        });
    }

    #[test]
    fn a_session_that_is_saved_and_resumed_goes_on_with_the_same_bits(throw in throws(), first in 1e-3..0.3_f64) {
        let runs = throw.go(Rk4 { time_step: 1e-3 }, throw.state, 600).is_ok();
        prop_assume!(runs);
        let alike = |[one, other]: [(State, f64, u64); 2]| one == other;
        each_method!(1e-3, |integrator, method| {
            if throw.go(integrator, throw.state, 600).is_ok() {
                let runs = saved_or_not(&*throw.stepper(integrator), [first, 0.2], throw.state);
                prop_assert!(alike(runs), "{}", method);
            }
        });
    }
}

#[test]
fn an_adaptive_session_of_each_trial_goes_on_with_the_same_bits_and_not_as_a_new_run() {
    let mut new_runs_differ = 0;
    for number in 1..=8 {
        let report = Trial::<f64>::report(number).unwrap();
        let trial = Trial {
            slip_speed: 1e-2,
            ..report
        };
        for tolerance in [1e-3, 1e-5] {
            let fifth = trial.stepper(DormandPrince54::new(tolerance)).unwrap();
            let third = trial.stepper(BogackiShampine32::new(tolerance)).unwrap();
            let aloft = trial.stepper(Flight(DormandPrince54::new(tolerance)));
            let aloft = aloft.unwrap();
            for first in [0.01, 0.1234, 0.3] {
                let parts = [first, 0.2];
                let start = trial.state();
                for [one, other] in [
                    saved_or_not(&fifth, parts, start),
                    saved_or_not(&third, parts, start),
                    saved_or_not(&aloft, parts, start),
                ] {
                    assert_eq!(one, other, "trial {number}, {tolerance} m, {first} s");
                }
                // The first call is that of the stepper. Later calls continue with the size of the
                // next step.
                let (mut state, mut session) = (start, fifth.session(start));
                fifth.advance(&mut state, first).unwrap();
                session.advance(first).unwrap();
                assert_eq!(session.state(), &state);
                fifth.advance(&mut state, 0.2).unwrap();
                session.advance(0.2).unwrap();
                new_runs_differ += u32::from(session.state() != &state);
            }
        }
    }
    assert!(new_runs_differ > 24, "{new_runs_differ}");
}

/// A coin that lies still, and where it lies.
fn coin_at_rest<I: Integrator>(integrator: I) -> (TrialStepper<I>, State) {
    let trial = Trial {
        slip_speed: 1e-3,
        ..Trial::report(1).unwrap()
    };
    let settle = trial.stepper(EnergyMomentum { time_step: 1e-3 }).unwrap();
    let mut state = State::at(DVec3::Z * 0.02).with_rotation_vector(DVec3::Y * 1.5);
    settle.advance(&mut state, 60.0).unwrap();
    // A step of another size may find a lower energy within its rounding, and move the body by some
    // 1e-12 m. So it settles by the frames of the tests, which end with a shorter step.
    let has_settled = (0..600).any(|_| {
        let before = state;
        settle.advance(&mut state, 1.0 / 60.0).unwrap();
        state == before
    });
    assert!(has_settled, "it still moves");
    (trial.stepper(integrator).unwrap(), state)
}

#[test]
fn a_body_at_rest_is_counted_on_and_not_evaluated() {
    let (stepper, rest) = coin_at_rest(EnergyMomentum { time_step: 1e-3 });
    let (frame, mut steps) = (1.0 / 60.0, 0);
    let mut count = |sample: &Sample<'_>| {
        steps = sample.step;
        ControlFlow::Continue(())
    };
    stepper.run(&mut rest.clone(), frame, &mut count).unwrap();
    let mut session = stepper.session(rest);
    session.advance(frame).unwrap();
    let evaluations = session.evaluation_count();
    for _ in 1..600 {
        session.advance(frame).unwrap();
    }
    assert_eq!(session.state(), &rest);
    assert_eq!(session.evaluation_count(), evaluations);
    assert_eq!(session.step_count(), 600 * steps);
    assert!((session.time() - 10.0).abs() <= 2e-15);
    // Ten thousand million steps: more than a test would wait for, if each were taken.
    session.advance(1e7).unwrap();
    assert_eq!(session.step_count(), 600 * steps + 10_000_000_000);
    assert!((session.time() - 10_000_010.0).abs() <= 2e-9);
    assert_eq!(session.state(), &rest);
    // Frames of other lengths take the shorter step at their end alone.
    let evaluations = session.evaluation_count();
    session.advance(0.020_5).unwrap();
    let (mut state, mut alone) = (rest, stepper.session(rest));
    stepper.advance(&mut state, 0.020_5).unwrap();
    alone.advance(0.020_5).unwrap();
    assert_eq!([session.state(), alone.state()], [&state; 2]);
    let of_frame = session.evaluation_count() - evaluations;
    assert!(of_frame <= alone.evaluation_count(), "{of_frame}");
}

#[test]
fn a_body_at_rest_that_is_pushed_moves_on_as_in_a_new_session() {
    let (stepper, rest) = coin_at_rest(EnergyMomentum { time_step: 1e-3 });
    let mut session = stepper.session(rest);
    for _ in 0..10 {
        session.advance(1.0 / 60.0).unwrap();
        session.step().unwrap();
    }
    session.state_mut().linear_velocity = DVec3::X;
    let pushed = rest.with_linear_velocity(DVec3::X);
    let mut new = stepper.session(pushed);
    for session in [&mut session, &mut new] {
        session.advance(1.0 / 60.0).unwrap();
        session.step().unwrap();
    }
    assert_eq!(session.state(), new.state());
    assert!(session.state().position.x > rest.position.x + 0.01);
    session.set_state(rest);
    session.run(0.5, &mut ()).unwrap();
    assert_eq!(session.into_state(), rest);
}

#[test]
fn the_steps_and_samples_of_a_session_are_those_of_a_run() {
    let trial = Trial::<f64>::report(1).unwrap();
    let stepper = trial.stepper(StrangSplitting { time_step: 1e-3 }).unwrap();
    let mut shown = Vec::new();
    let mut watch = |sample: &Sample<'_>| {
        shown.push((sample.time, sample.step, *sample.state));
        ControlFlow::Continue(())
    };
    stepper.run(&mut trial.state(), 0.1, &mut watch).unwrap();
    let mut session = stepper.session(trial.state());
    let first = session.moment();
    let seen: Vec<_> = session.steps().take(100).map(Result::unwrap).collect();
    let all = core::iter::once(first).chain(seen);
    let all: Vec<_> = all.map(|m| (m.time, m.steps, m.state)).collect();
    assert_eq!(all, shown);
    // A run of a session shows its own time, and the session continues.
    let mut last = 0.0;
    let mut watch = |sample: &Sample<'_>| {
        last = sample.time;
        ControlFlow::Continue(())
    };
    assert_eq!(session.run(0.1, &mut watch), Ok(0.1));
    assert!((last - 0.1_f64).abs() < 1e-16 && (session.time() - 0.2).abs() < 1e-15);
    // Samples: the first one is now, and the session stands at the last one.
    let mut session = stepper.session(trial.state());
    let samples = session.samples(0.01).unwrap().take(11);
    let samples: Vec<_> = samples.map(Result::unwrap).collect();
    assert_eq!(samples[0].state, trial.state());
    assert_eq!(samples[10], session.moment());
    assert_eq!(samples[10].state, shown[100].2);
    for (number, sample) in samples.iter().enumerate() {
        assert!((sample.time - 0.01 * number as f64).abs() < 1e-16);
    }
    let error = session.samples(-1.0).err().unwrap().to_string();
    assert_eq!(error, "interval of the samples must be above 0, got -1 s");
}

#[test]
fn a_session_keeps_the_last_good_state_after_an_error_and_has_a_budget_for_each_call() {
    let trial = Trial::<f64>::report(1).unwrap();
    let stepper = trial.stepper(StrangSplitting { time_step: 1e-3 }).unwrap();
    let mut session = stepper.session(trial.state());
    session.advance(0.1).unwrap();
    let good = session.moment();
    let error = session.advance(f64::NAN).unwrap_err();
    assert!(matches!(error, StepError::BadDuration { .. }));
    let bad = good.state.with_linear_velocity(DVec3::NAN);
    session.set_state(bad);
    let errors: Vec<_> = session.steps().collect();
    assert!(matches!(errors[..], [Err(StepError::BadState { .. })]));
    assert_eq!((session.time(), session.step_count()), (good.time, 100));

    let budget = 60;
    let method = DormandPrince54 {
        budget,
        ..DormandPrince54::new(1e-5)
    };
    let stepper = trial.stepper(method).unwrap();
    let mut session = stepper.session(trial.state());
    while session.time() < 1.0 {
        session.advance(0.01).unwrap();
    }
    assert!(session.step_count() + session.rejected_count() > u64::from(budget));
    let error = session.advance(10.0).unwrap_err();
    assert!(matches!(error, StepError::BudgetSpent { .. }));
    let (time, state) = (session.time(), *session.state());
    assert!(time > 1.0 && state != trial.state());
}

/// A method, and the same chosen at run time, for a session of a trial.
fn chosen_or_not<I: Integrator + Copy + Into<AnyIntegrator>>(method: I, name: &str) {
    let any: AnyIntegrator = method.into();
    assert_eq!(any.to_string(), name);
    #[cfg(feature = "serde")]
    let any: AnyIntegrator = serde_json::from_str(&serde_json::to_string(&any).unwrap()).unwrap();
    let trial = Trial::report(1).unwrap();
    let [plain, chosen] = [
        saved_or_not(&trial.stepper(method).unwrap(), [0.1, 0.2], trial.state()),
        saved_or_not(&trial.stepper(any).unwrap(), [0.1, 0.2], trial.state()),
    ];
    assert_eq!(plain, chosen, "{name}");
    assert_eq!(chosen[0], chosen[1], "{name}");
    // Also before the first step.
    let (method_alone, any_alone) = (trial.stepper(method).unwrap(), trial.stepper(any).unwrap());
    let new = method_alone.session(trial.state()).save();
    assert_eq!(new, any_alone.session(trial.state()).save(), "{name}");
    let one = any as AnyIntegrator;
    assert_eq!(
        Integrator::<f64>::order(&one),
        Integrator::<f64>::order(&method)
    );
    assert_eq!(one.fixed_step(), method.fixed_step());
    let [a, b] = [(40.0, 3.0), (4.0, 0.5)];
    for (stiffness, damping) in [a, b] {
        let limit = one.largest_stable_step(stiffness, damping);
        assert_eq!(limit, method.largest_stable_step(stiffness, damping));
    }
}

#[test]
fn an_integrator_that_is_chosen_at_run_time_has_the_bits_of_its_method() {
    let time_step = 1e-3;
    chosen_or_not(ForwardEuler { time_step }, "ForwardEuler");
    chosen_or_not(SymplecticEuler { time_step }, "SymplecticEuler");
    chosen_or_not(StrangSplitting { time_step }, "StrangSplitting");
    chosen_or_not(Rk4 { time_step }, "Rk4");
    chosen_or_not(Nystrom { time_step }, "Nystrom");
    chosen_or_not(BogackiShampine32::new(1e-4), "BogackiShampine32");
    chosen_or_not(DormandPrince54::new(1e-4), "DormandPrince54");
    chosen_or_not(EnergyMomentum { time_step }, "EnergyMomentum");
    let adaptive = AdaptiveEnergyMomentum::new(1e-3);
    chosen_or_not(adaptive, "AdaptiveEnergyMomentum");
    chosen_or_not(AdaptiveNystrom::new(1e-4), "AdaptiveNystrom");
    chosen_or_not(Radau5::new(1e-4), "Radau5");
    let bad = AnyIntegrator::from(Rk4 { time_step: -1.0 });
    let error = Trial::report(1).unwrap().stepper(bad).unwrap_err();
    assert_eq!(error.to_string(), "time step must be above 0, got -1 s");
    // One that is chosen with a fixed step lets a body at rest lie, too.
    let (stepper, rest) = coin_at_rest(AnyIntegrator::from(EnergyMomentum { time_step }));
    let mut session = stepper.session(rest);
    session.advance(1e7).unwrap();
    assert_eq!(session.step_count(), 10_000_000_000);
}

#[test]
fn an_impulse_on_a_rod_turns_it_about_the_centre_of_percussion() {
    let (mass, length, impulse) = (0.7_f64, 1.3_f64, 2.1_f64);
    let stepper = Stepper::new(Rod::new(mass, length)).unwrap();
    let along = DVec3::new(0.3, -0.5, 0.8).normalize();
    let across = along.cross(DVec3::X).normalize();
    let turn = DQuat::from_rotation_arc(DVec3::Z, along);
    let velocity = DVec3::new(0.1, 0.2, 0.3);
    for share in [-0.5, -0.2, 0.01, 1.0 / 6.0, 0.5] {
        let centre = DVec3::new(1.0, 2.0, 3.0);
        let start = State::at(centre)
            .with_orientation(turn)
            .with_linear_velocity(velocity);
        let mut state = start;
        let arm = share * length;
        let point = centre + along * arm;
        stepper
            .apply_impulse(&mut state, across * impulse, point)
            .unwrap();
        // v = J/m, ω = J b/(m l²/12): the point at -l²/(12 b) keeps its velocity.
        let spin = stepper.angular_velocity(&state);
        let expected = along.cross(across) * (impulse * arm * 12.0 / (mass * length * length));
        assert!((spin - expected).length() < 1e-13, "{spin}, {expected}");
        let still = along * (-length * length / (12.0 * arm));
        let left = state.linear_velocity - velocity + spin.cross(still);
        assert!(left.length() < 1e-12, "{left}");
        // The work of the impulse: its mean velocity at the point times the impulse.
        let at_point = |state: &State| {
            let spin = stepper.angular_velocity(state);
            state.linear_velocity + spin.cross(point - centre)
        };
        let work = (across * impulse).dot(at_point(&start) + at_point(&state)) * 0.5;
        let gained = stepper.energy(&state).total() - stepper.energy(&start).total();
        assert!((work - gained).abs() < 1e-12, "{work}, {gained}");
        // About itself the rod takes none.
        let spun = state;
        stepper
            .apply_impulse(&mut state, across.cross(along), centre + across)
            .unwrap();
        let change = state.angular_momentum - spun.angular_momentum;
        assert!(change.dot(along).abs() < 1e-15, "{change}");
    }
}

#[test]
fn an_impulse_that_is_not_finite_is_refused_and_leaves_the_state() {
    let stepper = Stepper::new(Coin::ring(1.0, 0.5)).unwrap();
    let mut session = stepper.session(State::at(DVec3::Z));
    let refused = |impulse, point| {
        let mut state = State::at(DVec3::Z);
        let error = stepper
            .apply_impulse(&mut state, impulse, point)
            .unwrap_err();
        assert_eq!(state, State::at(DVec3::Z));
        error.to_string()
    };
    for (impulse, point, message) in [
        (
            DVec3::Y * f64::NAN,
            DVec3::Z,
            "x of the impulse must be finite, got NaN",
        ),
        (
            DVec3::X,
            DVec3::new(0.0, f64::INFINITY, 0.0),
            "y of the impulse's point must be finite, got inf",
        ),
        (
            DVec3::X * 1e200,
            DVec3::Z * 1e200,
            "angular momentum after an impulse must be finite, got inf",
        ),
    ] {
        assert_eq!(refused(impulse, point), message);
    }
    session.apply_impulse(DVec3::X, DVec3::Z * 1.5).unwrap();
    assert_eq!(session.state().linear_velocity, DVec3::X);
    assert_eq!(session.state().angular_momentum, DVec3::Y * 0.5);
}

/// The angular velocity of a rod is that of its orientation, which would be NaN.
#[test]
fn an_impulse_on_an_invalid_orientation_names_the_orientation() {
    let invalid = State::at(DVec3::Z).with_orientation(DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0));
    let of_rod = Stepper::new(Rod::new(1.0, 0.5)).unwrap();
    let of_coin = Stepper::new(Coin::ring(1.0, 0.5)).unwrap();
    let mut states = [invalid; 2];
    let [rod, coin] = &mut states;
    let refused = [
        of_rod.apply_impulse(rod, DVec3::X, DVec3::ZERO),
        of_coin.apply_impulse(coin, DVec3::X, DVec3::ZERO),
    ];
    for error in refused {
        let quantity = tumble::error::Quantity::Orientation;
        assert!(
            matches!(error, Err(StepError::BadState { quantity: found, .. }) if found == quantity),
            "{error:?}"
        );
    }
    assert_eq!(states, [invalid; 2]);
}

#[test]
fn an_impulse_leaves_the_angular_momentum_of_a_point_as_it_is() {
    let stepper = Stepper::new(PointMass::new(1.0)).unwrap();
    let mut state = State::default().with_angular_momentum(DVec3::Z);
    stepper
        .apply_impulse(&mut state, DVec3::X, DVec3::Y)
        .unwrap();
    assert_eq!(state.linear_velocity, DVec3::X);
    assert_eq!(state.angular_momentum, DVec3::Z);
}

#[test]
fn a_step_is_displayed_on_one_line_with_its_units() {
    let stepper = Stepper::new(Coin::ring(1.0, 0.5)).unwrap();
    let stepper = stepper.with_integrator(Rk4 { time_step: 0.25 }).unwrap();
    let step = stepper.step(&mut State::default()).unwrap();
    let text = format!("{step:.1} | {step}");
    let digits = "0.2 s, 4 evaluations, 0 rejected, 0 iterations, 0.0 J removed";
    assert_eq!(
        text,
        format!("{digits} | 0.25 s, 4 evaluations, 0 rejected, 0 iterations, 0 J removed")
    );
}

#[cfg(feature = "serde")]
#[test]
fn an_invalid_session_is_refused_when_it_is_resumed() {
    let trial = Trial::<f64>::report(1).unwrap();
    let stepper = trial.stepper(DormandPrince54::new(1e-5)).unwrap();
    let mut session = stepper.session(trial.state());
    session.advance(0.01).unwrap();
    let good = serde_json::to_value(session.save()).unwrap();
    for (path, rule) in [
        (
            "/clock/time",
            "time of the saved session must be at least 0, got -1 s",
        ),
        (
            "/clock/lost",
            "rounding of the saved time must be 0, got -1 s",
        ),
        (
            "/control/next_step",
            "length of the next step must be above 0, got -1 s",
        ),
        (
            "/control/last_error",
            "error of the last step must be above 0, got -1",
        ),
    ] {
        let mut bad = good.clone();
        *bad.pointer_mut(path).unwrap() = (-1.0).into();
        let saved: SavedSession = serde_json::from_value(bad).unwrap();
        assert_eq!(stepper.resume(&saved).unwrap_err().to_string(), rule);
    }
}

/// Texts of the JSON in which one key of a map is missing, or has another name.
#[cfg(feature = "serde")]
fn without_one_key(good: &serde_json::Value, map: &str) -> Vec<(String, serde_json::Value)> {
    let entries = |value: &mut serde_json::Value| {
        let found = value.pointer_mut(map).unwrap();
        core::mem::take(found.as_object_mut().unwrap())
    };
    let whole = entries(&mut good.clone());
    let mut found = Vec::new();
    for key in whole.keys() {
        for name in [None, Some(format!("{key}_"))] {
            let mut changed = whole.clone();
            let value = changed.remove(key).unwrap();
            changed.extend(name.map(|name| (name, value)));
            let mut bad = good.clone();
            *bad.pointer_mut(map).unwrap() = changed.into();
            found.push((key.clone(), bad));
        }
    }
    found
}

#[cfg(feature = "serde")]
#[test]
fn a_saved_session_with_a_missing_or_unknown_key_is_refused() {
    let trial = Trial::<f64>::report(1).unwrap();
    let stepper = trial.stepper(DormandPrince54::new(1e-5)).unwrap();
    let mut session = stepper.session(trial.state());
    session.advance(0.01).unwrap();
    let good = serde_json::to_value(session.save()).unwrap();
    for (map, keys) in [("", 3), ("/state", 4), ("/clock", 5), ("/control", 3)] {
        let bad = without_one_key(&good, map);
        assert_eq!(bad.len(), 2 * keys, "{good}");
        for (key, bad) in bad {
            let error = serde_json::from_value::<SavedSession>(bad).unwrap_err();
            assert!(error.to_string().contains(&key), "{map}/{key}: {error}");
        }
    }
    for map in ["", "/clock", "/control"] {
        let mut bad = good.clone();
        bad.pointer_mut(map).unwrap()["extra"] = 1.into();
        let error = serde_json::from_value::<SavedSession>(bad).unwrap_err();
        assert!(error.to_string().contains("`extra`"), "{map}: {error}");
    }
    // An empty value has a key.
    let mut empty = good.clone();
    empty["control"] = serde_json::Value::Null;
    assert!(serde_json::from_value::<SavedSession>(empty).is_ok());
}

#[cfg(feature = "serde")]
#[test]
fn a_saved_session_with_the_largest_counts_goes_on_without_an_overflow() {
    let trial = Trial::<f64>::report(1).unwrap();
    let stepper = trial.stepper(Rk4 { time_step: 1e-3 }).unwrap();
    let mut saved = serde_json::to_value(stepper.session(trial.state()).save()).unwrap();
    for count in ["steps", "evaluations", "rejected"] {
        saved["clock"][count] = u64::MAX.into();
    }
    let saved: SavedSession = serde_json::from_value(saved).unwrap();
    let mut session = stepper.resume(&saved).unwrap();
    session.step().unwrap();
    assert_eq!(session.step_count(), 0);
    session.advance(2e-3).unwrap();
    assert_eq!(session.step_count(), 2);
}

proptest! {
    #![proptest_config(kit::cases(100))]

    /// A run of 1 s is its single steps, whatever they are: also those like 1/60 and 1/3 s that are
    /// a rounding short of it.
    #[test]
    fn a_run_of_a_second_has_the_bits_of_its_single_steps(throw in throws(), count in prop_oneof![1..10_u32, 10..2000_u32]) {
        let throw = Throw { stiffness: throw.stiffness.min(f64::from(count * count) * 0.1), damping: 0.0, ..throw };
        let dt = 1.0 / f64::from(count);
        each_method!(dt, |integrator, method| {
            let single = throw.go(integrator, throw.state, count);
            let mut state = throw.state;
            let run = throw.advance(integrator, &mut state, 1.0);
            prop_assert_eq!(run, single.map(|_| ()), "{}", method);
            if single.is_ok() {
                prop_assert_eq!(Ok(state), single, "{} in {} steps", method, count);
            }
        });
    }
}

// -----------------------------------------------------------------------------------------------
// f32 and f64
// -----------------------------------------------------------------------------------------------

fn single(vector: DVec3) -> Vec3 {
    vector.as_vec3()
}

/// A state rounded to seven digits.
fn rounded(state: &State) -> State<f32> {
    State {
        position: single(state.position),
        linear_velocity: single(state.linear_velocity),
        orientation: state.orientation.as_quat(),
        angular_momentum: single(state.angular_momentum),
    }
}

fn widened(state: &State<f32>) -> State {
    State {
        position: state.position.as_dvec3(),
        linear_velocity: state.linear_velocity.as_dvec3(),
        orientation: state.orientation.as_dquat(),
        angular_momentum: state.angular_momentum.as_dvec3(),
    }
}

/// A trial of the report in one precision, after `seconds` of steps of 1 ms.
fn trial_after<R: Real>(number: usize, seconds: f64, nudge: f64) -> State<R> {
    let report = Trial::<R>::report(number).unwrap();
    let trial = Trial {
        slip_speed: R::from_f64(1e-2),
        ..report
    };
    let stepper = trial
        .stepper(StrangSplitting {
            time_step: R::from_f64(1e-3),
        })
        .unwrap();
    let mut state = trial.state();
    state.angular_momentum = state.angular_momentum * R::from_f64(1.0 + nudge);
    stepper.advance(&mut state, R::from_f64(seconds)).unwrap();
    state
}

#[test]
fn f32_and_f64_agree_to_single_precision_in_every_trial_of_the_report() {
    for number in 1..=8 {
        let truth = trial_after::<f64>(number, 0.25, 0.0);
        let nudge = 1e-6;
        let growth = difference(&truth, &trial_after::<f64>(number, 0.25, nudge)) / nudge;
        let miss = difference(&truth, &widened(&trial_after::<f32>(number, 0.25, 0.0)));
        // 250 steps of some 6e-8 in numbers up to 5 (velocities and angular momenta of trials 6 and
        // 7), of random sign but for the worst; the motion amplifies them as it does the nudge.
        let allowed = 5.0 * 250.0 * 6e-8 * growth.max(1.0);
        assert!(
            miss < allowed,
            "trial {number}: {miss:e}, {allowed:e} allowed"
        );
    }
}

proptest! {
    #![proptest_config(kit::cases(100))]

    /// In flight nothing is amplified except the angle of rotation.
    #[test]
    fn f32_and_f64_agree_to_single_precision_in_flight(
        orientation in kit::orientations(),
        axis in directions(),
        size in zero_or(1e-3, 10.0),
        velocity in directions(),
        speed in zero_or(1e-3, 30.0),
    ) {
        let start = State::default()
            .with_orientation(orientation)
            .with_angular_momentum(axis * size)
            .with_linear_velocity(velocity * speed);
        each_method!(1e-3, |integrator, method| {
            let stepper = Stepper::new(Coin::ring(1.0, 0.5)).unwrap()
                .with_gravity(UniformGravity::down(9.8)).unwrap()
                .with_integrator(integrator).unwrap();
            let mut state = start;
            for _ in 0..200 {
                stepper.step(&mut state).unwrap();
            }
            let single = single_flight(method, &start, 200);
            let moved = (state.position - single.position).length();
            // 200 steps, half a last place (6e-8) of a number up to `speed` and of one up to a
            // displacement of 0.2 `speed` each; the fall of 0.2 m as well.
            prop_assert!(moved < 200.0 * 6e-8 * (1.0 + speed), "{method}: {moved:e} m");
            // The angle: half a last place of the start and of each of its few numbers, and of four
            // sums in each step.
            let angle = angle_between(state.orientation.normalize(), single.orientation.normalize());
            prop_assert!(angle < 6e-8 * (200.0 * 8.0 + 10.0 * size), "{method}: {angle:e} rad");
        });
    }
}

/// A coin in flight in single precision.
fn single_flight(method: &str, start: &State, steps: u32) -> State {
    fn go<I: Integrator<f32>>(integrator: I, start: &State, steps: u32) -> State {
        let stepper = Stepper::new(Coin::ring(1.0_f32, 0.5))
            .unwrap()
            .with_gravity(UniformGravity::down(9.8_f32))
            .unwrap()
            .with_integrator(integrator)
            .unwrap();
        let mut state = rounded(start);
        for _ in 0..steps {
            stepper.step(&mut state).unwrap();
        }
        widened(&state)
    }
    let time_step = 1e-3;
    match method {
        "ForwardEuler" => go(ForwardEuler { time_step }, start, steps),
        "SymplecticEuler" => go(SymplecticEuler { time_step }, start, steps),
        "StrangSplitting" => go(StrangSplitting { time_step }, start, steps),
        "EnergyMomentum" => go(EnergyMomentum { time_step }, start, steps),
        "Rk4" => go(Rk4 { time_step }, start, steps),
        "Nystrom" => go(Nystrom { time_step }, start, steps),
        _ => panic!("{method} has no flight in single precision here"),
    }
}
