//! Distances of states, the rounding of times, and the check that no energy increases.

use super::*;
use crate::error::{SceneError, StepError};
use crate::force::{Force, Wrench};
use crate::friction::{RollingResistance, SlidingFriction};
use crate::gravity::UniformGravity;
use crate::ground::{GroundMotion, SpringDamperGround, Surface};
use crate::scene::Scene;
use crate::state::Motion;
use crate::{
    BogackiShampine32, CompactEnergyMomentum, DormandPrince54, EnergyMomentum, Flight,
    ForwardEuler, SymplecticEuler,
};
use glam::{DQuat, DVec3};

/// `EnergyMomentum` with a fault: a change of the state after a step with a limit (s).
struct Faulty<F> {
    method: EnergyMomentum,
    fault: F,
}

impl<F: Fn(&mut State, f64)> Integrator for Faulty<F> {
    type Workspace = <EnergyMomentum as Integrator>::Workspace;

    fn step<D: Dynamics>(
        &self,
        scene: &D,
        state: &mut State,
        limit: f64,
        workspace: &mut Self::Workspace,
    ) -> Result<Step, StepError> {
        let step = self.method.step(scene, state, limit, workspace)?;
        (self.fault)(state, limit);
        Ok(step)
    }
    fn order(&self) -> u32 {
        self.method.order()
    }
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }
}

#[test]
fn the_distance_of_two_states_is_the_sum_of_its_parts() {
    let start = State::at(DVec3::new(1.0, 2.0, 3.0))
        .with_rotation_vector(DVec3::new(0.3, -0.2, 0.1))
        .with_linear_velocity(DVec3::new(-1.0, 0.5, 2.0))
        .with_angular_momentum(DVec3::new(0.3, 0.7, -0.2));
    let about = |axis: DVec3| {
        let mut state = start;
        state.orientation *= DQuat::from_axis_angle(axis, 0.2);
        state
    };
    // A point at 1 m moves by the chord of 0.2 rad.
    let chord = 2.0 * f64::sin(0.1);
    let shift = DVec3::new(2.0, 3.0, 6.0);
    let moved = |mut state: State| {
        state.linear_velocity += shift;
        state
    };
    let mut away = start;
    away.position += shift;
    for (other, expected) in [
        (start, 0.0),
        // Each point moves along.
        (away, 21.0),
        (about(DVec3::X), chord),
        (about(DVec3::Y), chord),
        (about(DVec3::Z), 2.0 * chord),
        (moved(start), 7.0 * 0.01),
        (
            start.with_angular_momentum(start.angular_momentum + shift),
            7.0 * 0.01,
        ),
        (moved(about(DVec3::Z)), 2.0 * chord + 7.0 * 0.01),
    ] {
        let found = distance(&start, &other, 0.01);
        assert!((found - expected).abs() < 1e-14, "{found}, not {expected}");
    }
}

#[test]
fn times_are_rounded_by_millions_of_units_in_the_last_place_and_a_share_at_most() {
    let exact = rounding_of_time::<f64>();
    assert!(
        (exact / (8e6 * f64::EPSILON) - 1.0).abs() < 1e-12,
        "{exact:e}"
    );
    let coarse = rounding_of_time::<f32>();
    assert!((coarse / 2e-4 - 1.0).abs() < 1e-6, "{coarse:e}");
}

#[test]
fn the_energy_of_an_explicit_method_increases_and_that_of_the_implicit_one_does_not() {
    let plan = CheckPlan { seed: 4, cases: 6 };
    let implicit = EnergyMomentum { time_step: 1e-2 };
    assert_eq!(check_energy_never_rises(&implicit, plan), Ok(()));
    let explicit = SymplecticEuler { time_step: 1e-2 };
    let violation = check_energy_never_rises(&explicit, plan).expect_err("an increase");
    assert_eq!(violation.requirement, Requirement::EnergyNeverRises);
    assert!(violation.value > violation.bound);
    let Input::Step { scene, limit, .. } = violation.input else {
        panic!("{:?}", violation.input);
    };
    assert_eq!(scene, "a random scene");
    assert!(limit > 0.0 && limit <= 1e-2, "{limit}");
}

#[test]
fn an_energy_that_increases_in_short_steps_alone_is_found() {
    let method = EnergyMomentum { time_step: 1e-2 };
    let fault = |state: &mut State, limit: f64| {
        if limit < 1e-2 {
            state.linear_velocity.x += 1e9;
        }
    };
    let plan = CheckPlan { seed: 4, cases: 2 };
    let found = check_energy_never_rises(&Faulty { method, fault }, plan);
    let violation = found.expect_err("an increase");
    assert_eq!(violation.requirement, Requirement::EnergyNeverRises);
}

/// 64 units in the last place of the lengths: the start, and the path of a whole step or of a
/// hundredth of one.
#[test]
fn a_path_that_is_not_velocity_times_time_is_found_beyond_the_rounding_of_both() {
    let time_step = 1e-2;
    let check = |off: f64| {
        let fault = |state: &mut State, _| state.position.x += off;
        let method = EnergyMomentum { time_step };
        let attempt = Attempt {
            integrator: &Faulty { method, fault },
            setup: &Setup::flight(time_step).unwrap(),
            time_step,
        };
        attempt.tells_time()
    };
    let start = Setup::flight(time_step).unwrap().start;
    let path = (start.linear_velocity * time_step).length();
    let unit = 64.0 * f64::EPSILON;
    assert_eq!(check(unit * (start.position.length() - 0.1 * path)), Ok(()));
    let off = unit * (start.position.length() + 1.2 * path);
    let violation = check(off).expect_err("another path");
    assert_eq!(violation.requirement, Requirement::TellsTime);
    assert_eq!(
        violation.input,
        Input::Step {
            scene: "free flight",
            case: 0,
            step: 0,
            limit: time_step
        }
    );
}

/// A method of a fixed step that states these numbers, whatever the inner one's are.
#[derive(Clone, Copy)]
struct Stated {
    inner: SymplecticEuler,
    order: u32,
    fixed_step: f64,
}

impl Integrator for Stated {
    type Workspace = <SymplecticEuler as Integrator>::Workspace;

    fn step<D: Dynamics>(
        &self,
        scene: &D,
        state: &mut State,
        limit: f64,
        workspace: &mut Self::Workspace,
    ) -> Result<Step, StepError> {
        self.inner.step(scene, state, limit, workspace)
    }
    fn order(&self) -> u32 {
        self.order
    }
    fn fixed_step(&self) -> Option<f64> {
        Some(self.fixed_step)
    }
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }
}

/// The first step of closed-form flight is the whole second that it may take.
#[test]
fn flight_is_checked_at_the_step_of_the_method_that_it_contains() {
    let plan = CheckPlan { seed: 4, cases: 20 };
    for time_step in [1e-6, 1e-4, 1e-3, 0.3] {
        let own = own_step::<f64, _>(&Flight(Rk4 { time_step }));
        assert_eq!(own, Ok(time_step));
        let found = check_integrator(&Flight(Rk4 { time_step }), plan);
        assert_eq!(found, Ok(()), "{time_step}");
        let flight = Flight(Stated {
            inner: SymplecticEuler { time_step },
            order: 3,
            fixed_step: time_step,
        });
        let violation = check_integrator(&flight, plan).expect_err("the order is 1");
        assert_eq!(violation.requirement, Requirement::Order, "{violation}");
    }
    // A second of free flight is the longest step that is measured.
    assert_eq!(own_step::<f64, _>(&Rk4 { time_step: 3.0 }), Ok(1.0));
    let flight = Flight(EnergyMomentum { time_step: 1e-2 });
    assert_eq!(check_energy_never_rises(&flight, plan), Ok(()));
}

#[test]
fn a_fixed_step_that_is_not_above_0_is_told() {
    for fixed_step in [0.0, -1e-3, f64::NAN] {
        let method = Stated {
            inner: SymplecticEuler { time_step: 1e-3 },
            order: 1,
            fixed_step,
        };
        let violation = check_integrator(&method, CheckPlan::default()).expect_err("no step");
        let sentence = std::format!("{violation}");
        assert!(
            sentence.contains("fixed step of the integrator"),
            "{sentence}"
        );
    }
}

#[test]
fn the_energy_never_increases_with_the_compact_method_either() {
    let plan = CheckPlan { seed: 4, cases: 6 };
    let compact = CompactEnergyMomentum::<8> { time_step: 1e-2 };
    assert_eq!(check_energy_never_rises(&compact, plan), Ok(()));
}

#[test]
fn a_fixed_step_other_than_that_of_the_steps_is_found() {
    let found = |found: Result<(), Violation>| found.map_err(|violation| violation.requirement);
    let plan = CheckPlan { seed: 4, cases: 20 };
    for time_step in [1e-6, 1e-3, 0.7, 3.0] {
        let inner = SymplecticEuler { time_step };
        let check = |factor: f64| {
            let method = Stated {
                inner,
                order: 1,
                fixed_step: factor * time_step,
            };
            let bare = check_integrator(&method, plan);
            [bare, check_integrator(&Flight(method), plan)].map(found)
        };
        assert_eq!(check(1.0), [Ok(()), Ok(())], "{time_step}");
        let other = Err(Requirement::FixedStep);
        // The whole steps of a method that spans steps may be two of those that it states.
        assert_eq!(check(0.5), [other, Ok(())], "{time_step}");
        for factor in [0.7, 1.0 - 1e-14, 1.0 + 1e-14, 2.0, 3.0] {
            assert_eq!(check(factor), [other; 2], "{factor} {time_step}");
        }
    }
}

#[test]
fn the_sentence_about_a_fixed_step_has_both_steps() {
    let method = Stated {
        inner: SymplecticEuler { time_step: 0.25 },
        order: 1,
        fixed_step: 0.5,
    };
    let violation = check_integrator(&method, CheckPlan::default()).expect_err("half the step");
    let sentence = std::format!("{violation}");
    assert!(sentence.contains("the fixed step"), "{sentence}");
    assert!(
        sentence.contains("got 2.5e-1, the bound is 5e-1"),
        "{sentence}"
    );
}

/// Error of `Rk4` in the scenes with one role each, from which the number of its steps follows.
#[test]
fn the_reference_is_more_exact_than_the_bound_that_it_is_used_for() {
    let time_step = 1e-3;
    for setup in with_each_role(time_step).map(Result::unwrap) {
        let attempt = Attempt {
            integrator: &Rk4 { time_step },
            setup: &setup,
            time_step,
        };
        let [coarse, fine, finest] = [128, 512, 1024].map(|steps| attempt.run_in(steps).unwrap().0);
        assert!(distance(&coarse, &finest, time_step) < 2e-10);
        assert!(distance(&fine, &finest, time_step) < 1e-12);
    }
}

/// A part of a scene that a method can forget.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    Force,
    Torque,
    GroundMotion,
    GroundRotation,
    Resistance,
    RollingResistance,
    SpinningResistance,
}

/// A force without its torque.
struct Central<'a, E>(&'a E);

impl<E: Force> Force for Central<'_, E> {
    fn wrench(&self, motion: &Motion) -> Wrench {
        Wrench::of_force(self.0.wrench(motion).force)
    }
    fn is_passive(&self) -> bool {
        self.0.is_passive()
    }
    fn acts(&self) -> bool {
        self.0.acts()
    }
}

/// A ground with another motion.
struct Moved<'a, G>(&'a G, Option<GroundMotion>);

impl<G: SpringDamperGround> SpringDamperGround for Moved<'_, G> {
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
    fn motion(&self) -> Option<GroundMotion> {
        self.1
    }
}

/// A friction law without one or both kinds of resistance.
struct Yielding<'a, F>(&'a F, Part);

impl<F: SlidingFriction> SlidingFriction for Yielding<'_, F> {
    fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
        self.0.force(normal_force, slip)
    }
    fn rolling_resistance(&self, normal_force: f64) -> Option<RollingResistance> {
        let resistance = self.0.rolling_resistance(normal_force)?;
        let (rolling, spinning) = match self.1 {
            Part::RollingResistance => (0.0, resistance.spinning),
            Part::SpinningResistance => (resistance.rolling, 0.0),
            _ => return None,
        };
        Some(RollingResistance {
            rolling,
            spinning,
            ..resistance
        })
    }
}

/// A method that forgets a part of each scene.
struct Without<I>(I, Part);

impl<I: Integrator> Integrator for Without<I> {
    type Workspace = ();

    fn step<D: Dynamics>(
        &self,
        scene: &D,
        state: &mut State,
        limit: f64,
        (): &mut (),
    ) -> Result<Step, StepError> {
        let (body, ground, friction) = (scene.body(), scene.ground(), scene.friction());
        let (force, acceleration) = (scene.force(), scene.gravity());
        let gravity = UniformGravity { acceleration };
        let (method, workspace) = (&self.0, &mut I::Workspace::default());
        let motion = ground.motion().filter(|_| self.1 == Part::GroundRotation);
        let motion = motion.map(|motion| GroundMotion::translation(motion.velocity));
        match self.1 {
            Part::Force => {
                let scene = Scene::new(body, ground, friction, gravity).unwrap();
                method.step(&scene, state, limit, workspace)
            }
            Part::Torque => {
                let scene = Scene::new(body, ground, friction, gravity).unwrap();
                let scene = scene.with_force(Central(force)).unwrap();
                method.step(&scene, state, limit, workspace)
            }
            Part::GroundMotion | Part::GroundRotation => {
                let ground = Moved(ground, motion);
                let scene = Scene::new(body, ground, friction, gravity).unwrap();
                let scene = scene.with_force(force).unwrap();
                method.step(&scene, state, limit, workspace)
            }
            _ => {
                let friction = Yielding(friction, self.1);
                let scene = Scene::new(body, ground, friction, gravity).unwrap();
                let scene = scene.with_force(force).unwrap();
                method.step(&scene, state, limit, workspace)
            }
        }
    }
    fn order(&self) -> u32 {
        self.0.order()
    }
    fn check(&self) -> Result<(), SceneError> {
        self.0.check()
    }
}

/// Checks that a method that forgets a part is found in the scene of that part.
fn demand_found<I: Integrator + Copy>(method: I, parts: &[Part]) {
    for &part in parts {
        let place = match part {
            Part::Force | Part::Torque => "a mount",
            Part::GroundMotion | Part::GroundRotation => "a turntable",
            _ => "resistance to rolling and spinning",
        };
        let plan = CheckPlan { seed: 4, cases: 20 };
        let found = check_integrator(&Without(method, part), plan);
        let violation = found.expect_err("a forgotten part");
        assert_eq!(violation.requirement, Requirement::Motion, "{part:?}");
        let Input::Step { scene, .. } = violation.input else {
            panic!("{violation}");
        };
        assert!(scene.ends_with(place), "{part:?}: {violation}");
    }
}

#[test]
fn a_method_that_forgets_a_part_of_a_scene_is_found() {
    let time_step = 1e-3;
    let parts = [
        Part::Force,
        Part::Torque,
        Part::GroundMotion,
        Part::GroundRotation,
        Part::Resistance,
        Part::RollingResistance,
        Part::SpinningResistance,
    ];
    demand_found(ForwardEuler { time_step }, &parts);
    demand_found(Rk4 { time_step }, &parts);
    demand_found(EnergyMomentum { time_step }, &parts);
    demand_found(DormandPrince54::new(1e-2), &parts);
}

/// It must agree to a twentieth of the motion only.
#[test]
fn a_method_that_takes_shorter_steps_and_forgets_a_role_is_found() {
    let parts = [Part::Force, Part::GroundMotion, Part::Resistance];
    demand_found(BogackiShampine32::new(1e-9), &parts);
    let plan = CheckPlan { seed: 4, cases: 20 };
    let method = Without(BogackiShampine32::new(1e-9), Part::Resistance);
    let violation = check_integrator(&method, plan).expect_err("a forgotten part");
    assert!(violation.bound > 0.02, "{violation}");
}
