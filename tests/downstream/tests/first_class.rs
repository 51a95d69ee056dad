//! A user's parts have the same rights as built-in ones: they fit everywhere, and a copy of a
//! built-in law has its bits.

use core::ops::ControlFlow;

use downstream::{Ball, Carpet, Midpoint, Motor, Sail, Turf, Turning, Viscous};
use tumble::body::ContactRange;
use tumble::glam::{DMat3, DVec3};
use tumble::integrator::step_length;
use tumble::real::{Quaternion, Vector};
use tumble::{
    Apex, Coin, ContactPoint, Coulomb, Dynamics, EnergyMomentum, Event, EventDirection, FlatGround,
    Force, ForwardEuler, FrictionField, GroundBounds, Integrator, Motion, MovingGround, Nystrom,
    Plane, Real, RigidPointBody, Rk4, Sample, SceneError, SlidingFriction, SpringDamperGround,
    State, Step, StepError, Stepper, StrangSplitting, Surface, SymplecticEuler, UniformGravity,
    Wrench, error,
};

/// A ball that is thrown forward with a rotation, in the air for its first 40 ms.
fn thrown<R: Real>() -> State<R> {
    let v = |x, y, z| R::Vec3::new(R::from_f64(x), R::from_f64(y), R::from_f64(z));
    State::at(v(0.1, -0.2, 0.22))
        .with_linear_velocity(v(1.0, 0.5, -0.3))
        .with_angular_momentum(v(0.02, -0.05, 0.03))
}

/// A body on a ground with friction under gravity.
fn compose<R, B, G, F, I>(
    body: B,
    ground: G,
    friction: F,
    integrator: I,
) -> Stepper<B, G, F, UniformGravity<R>, I, R>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    I: Integrator<R>,
{
    Stepper::new(body)
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(R::from_f64(9.8))))
        .and_then(|stepper| stepper.with_ground(ground))
        .and_then(|stepper| stepper.with_friction(friction))
        .and_then(|stepper| stepper.with_integrator(integrator))
        .expect("every part is valid")
}

/// Half a second from [`thrown`]: in the air, at first touch, sliding and rolling.
fn run<R, B, G, F, I>(body: B, ground: G, friction: F, integrator: I) -> State<R>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    I: Integrator<R>,
{
    let stepper = compose(body, ground, friction, integrator);
    let mut state = thrown();
    let mut touched = false;
    let watch = &mut |sample: &Sample<'_, R>| {
        touched |= sample.touching() > 0;
        ControlFlow::Continue(())
    };
    stepper
        .run(&mut state, R::HALF, watch)
        .expect("the step is short enough");
    assert!(touched, "the body has touched the ground");
    state
}

fn ball<R: Real>() -> Ball<R> {
    Ball::new(R::from_f64(0.5), R::from_f64(0.1))
}

fn turf<R: Real>() -> Turf<R> {
    Turf {
        stiffness: R::from_f64(2e3),
        stiffening: R::from_f64(1e6),
        damping: R::from_f64(2e3),
    }
}

fn oil<R: Real>() -> Viscous<R> {
    Viscous {
        drag: R::from_f64(0.5),
    }
}

/// A law that varies over the ground: the edge of the carpet is where the ball touches down.
fn carpet<R: Real>() -> Carpet<R> {
    Carpet {
        drag: R::from_f64(0.5),
        width: R::from_f64(0.3),
    }
}

fn four_ways<R: Real>(integrator: impl Integrator<R> + Copy) {
    four_ways_on(&oil::<R>(), integrator);
    four_ways_on(&carpet::<R>(), integrator);
}

/// A user's body, ground and friction, passed in four forms. All must end in the same state, to the
/// last bit.
fn four_ways_on<R: Real>(
    friction: &(impl SlidingFriction<R> + Copy + Send + 'static),
    integrator: impl Integrator<R> + Copy,
) {
    let (body, ground) = (&ball::<R>(), &turf::<R>());
    let by_value = run(*body, *ground, *friction, integrator);
    let by_reference = run(body, ground, friction, integrator);
    let by_dyn = run(
        body as &dyn RigidPointBody<R>,
        ground as &dyn SpringDamperGround<R>,
        friction as &dyn SlidingFriction<R>,
        integrator,
    );
    assert_eq!(by_value, by_reference);
    let by_box = run(
        Box::new(*body) as Box<dyn RigidPointBody<R> + Send>,
        Box::new(*ground) as Box<dyn SpringDamperGround<R> + Send>,
        Box::new(*friction) as Box<dyn SlidingFriction<R> + Send>,
        integrator,
    );
    assert_eq!(by_value, by_dyn);
    assert_eq!(by_value, by_box);
}

fn four_ways_with_every_integrator<R: Real>() {
    let time_step = R::from_f64(1e-3);
    four_ways(ForwardEuler { time_step });
    four_ways(SymplecticEuler { time_step });
    four_ways(StrangSplitting { time_step });
    four_ways(Rk4 { time_step });
    four_ways(Nystrom { time_step });
    four_ways(EnergyMomentum { time_step });
    four_ways(Midpoint { time_step });
}

#[test]
fn value_reference_dyn_and_box_give_the_same_bits_in_f64() {
    four_ways_with_every_integrator::<f64>();
}

#[test]
fn value_reference_dyn_and_box_give_the_same_bits_in_f32() {
    four_ways_with_every_integrator::<f32>();
}

/// The state of a ball under a user's force after some time (s), of which 40 ms are in the air.
fn sailed(force: impl Force, integrator: impl Integrator, seconds: f64) -> State {
    let stepper = compose(ball(), turf(), oil(), integrator)
        .with_force(force)
        .expect("the force is valid");
    let mut state = thrown();
    stepper
        .advance(&mut state, seconds)
        .expect("the step is short enough");
    state
}

#[test]
fn a_users_force_has_the_same_bits_by_value_reference_dyn_and_box() {
    let sail = Sail {
        normal: DVec3::Y,
        drag: 0.3,
    };
    let integrators = || EnergyMomentum { time_step: 1e-3 };
    let by_value = sailed(sail, integrators(), 0.3);
    let by_reference: &Sail<f64> = &sail;
    assert_eq!(by_value, sailed(by_reference, integrators(), 0.3));
    assert_eq!(by_value, sailed(&sail as &dyn Force, integrators(), 0.3));
    let boxed = Box::new(sail) as Box<dyn Force + Send>;
    assert_eq!(by_value, sailed(boxed, integrators(), 0.3));
    // A user's integrator knows the force as well. In the air both methods agree to their order, and
    // the sail brakes by 0.15 m/s².
    let [ours, theirs] = [
        sailed(sail, integrators(), 0.03),
        sailed(sail, Midpoint { time_step: 1e-3 }, 0.03),
    ];
    let still = sailed(tumble::NoForce, integrators(), 0.03);
    let gap = (theirs.position - ours.position).length();
    assert!(gap < 1e-7, "{gap:e}");
    assert!((still.position - ours.position).length() > 1e-5);
}

/// A user's body, ground and friction in many states, each of which ends as it does alone.
fn many_at_once<R: Real>(integrator: impl Integrator<R>) {
    let stepper = compose(ball::<R>(), turf(), carpet(), integrator);
    let start = |i: usize| {
        let state = thrown::<R>();
        // The lowest balls touch, the highest reach the ground later.
        let height = R::from_f64(0.09 + 0.01 * i as f64);
        State {
            position: R::Vec3::new(state.position.x(), state.position.y(), height),
            ..state
        }
    };
    let mut together = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9].map(start);
    let seconds = R::from_f64(0.05);
    assert_eq!(stepper.advance_many(&mut together, seconds), Ok(()));
    let mut touching = 0;
    for (i, state) in together.into_iter().enumerate() {
        let mut alone = start(i);
        stepper.advance(&mut alone, seconds).expect("a short step");
        assert_eq!(state, alone);
        touching += stepper.touching(&alone);
    }
    assert!((1..10).contains(&touching), "{touching} of 10 touch");
}

#[test]
fn many_states_of_a_users_scene_end_as_each_does_alone() {
    let time_step = 1e-3;
    many_at_once::<f64>(Midpoint { time_step });
    many_at_once::<f64>(SymplecticEuler { time_step });
    many_at_once::<f64>(Nystrom { time_step });
    many_at_once::<f32>(StrangSplitting { time_step: 1e-3 });
}

/// Two precisions of one motion differ by the rounding of f32, 500 steps of it: position below 1,
/// so 500 * 6e-8 m, ten times over for the springs.
#[test]
fn a_users_ball_moves_alike_in_f32_and_f64() {
    let fine = run::<f64, _, _, _, _>(ball(), turf(), oil(), StrangSplitting { time_step: 1e-3 });
    let coarse = run::<f32, _, _, _, _>(ball(), turf(), oil(), StrangSplitting { time_step: 1e-3 });
    let gap = (coarse.position.as_dvec3() - fine.position).length();
    assert!(gap < 3e-4, "{gap}");
}

/// Mixed company: each of the user's parts among built-in ones.
#[test]
fn each_part_fits_among_built_in_ones() {
    let (ground, friction) = (
        FlatGround::level(2e3, 5.0),
        Coulomb {
            coefficient: 0.3,
            slip_speed: 1e-2,
        },
    );
    let strang = StrangSplitting { time_step: 1e-3 };
    let ring = Coin::ring_with_storage([ContactPoint::default(); 12], 0.5, 0.1);
    let ends: [State; 4] = [
        run(ball(), ground, friction, strang),
        run(ring, turf(), friction, strang),
        run(ring, ground, oil(), strang),
        run(ring, ground, friction, Midpoint { time_step: 1e-3 }),
    ];
    for state in ends {
        assert!(
            state.position.z.abs() < 0.3 && state.position.x > 0.1,
            "{state:?}"
        );
    }
}

/// The built-in laws, line by line, in a user's type.
mod copies {
    use super::*;

    pub struct Ground(pub FlatGround);
    impl SpringDamperGround for Ground {
        fn surface(&self, point: DVec3) -> Surface {
            let plane = self.0.plane;
            Surface {
                gap: Vector::dot(plane.normal, point) - plane.height,
                normal: plane.normal,
            }
        }
        fn spring_force(&self, depth: f64) -> f64 {
            self.0.stiffness * depth
        }
        fn spring_energy(&self, depth: f64) -> f64 {
            self.0.stiffness * depth * depth * 0.5
        }
        fn normal_force(&self, depth: f64, closing_speed: f64) -> f64 {
            (self.0.stiffness * depth + self.0.damping * closing_speed).max(0.0)
        }
        fn bounds(&self) -> GroundBounds {
            GroundBounds::Plane(self.0.plane)
        }
    }

    pub struct Friction(pub Coulomb);
    impl SlidingFriction for Friction {
        fn force(&self, normal_force: f64, slip: DVec3) -> DVec3 {
            slip * -(self.0.coefficient * normal_force / (Vector::length(slip) + self.0.slip_speed))
        }
    }

    /// A built-in ring whose contacts are copied. The original computes which contacts are low.
    pub struct Ring(pub Coin<f64, [ContactPoint; 12]>, pub Vec<ContactPoint>);
    impl RigidPointBody for Ring {
        fn mass(&self) -> f64 {
            self.0.mass()
        }
        fn inertia(&self) -> DMat3 {
            let moment = self.0.mass() * self.0.radius() * self.0.radius();
            DMat3::from_diagonal(DVec3::new(moment, moment * 0.5, moment * 0.5))
        }
        fn contacts(&self) -> &[ContactPoint] {
            &self.1
        }
        fn contacts_below(&self, normal: DVec3, offset: f64) -> ContactRange {
            self.0.contacts_below(normal, offset)
        }
    }

    #[derive(Clone, Copy)]
    pub struct Euler(pub f64);
    impl Integrator for Euler {
        type Workspace = ();
        fn step<D: Dynamics>(
            &self,
            scene: &D,
            state: &mut State,
            limit: f64,
            _workspace: &mut (),
        ) -> Result<Step, StepError> {
            let dt = step_length(self.0, limit);
            let motion = scene.motion(state);
            let load = scene.load(&motion);
            let mass = scene.inertia_properties();
            state.linear_velocity += (load.force * mass.inverse_mass() + scene.gravity()) * dt;
            state.angular_momentum += load.torque * dt;
            state.position += state.linear_velocity * dt;
            state.orientation = mass
                .turn_freely(state.rotation(), &motion.axes, state.angular_momentum, dt)
                .to_quat();
            Ok(Step::new(dt, 1))
        }
        fn order(&self) -> u32 {
            1
        }
        // The run uses this to recognise that its last step is a whole one.
        fn fixed_step(&self) -> Option<f64> {
            Some(self.0)
        }
        fn check(&self) -> Result<(), SceneError> {
            error::above_zero("time step", self.0, " s")
        }
    }
}

#[test]
fn a_copy_of_a_built_in_law_has_its_bits() {
    let ring = Coin::ring_with_storage([ContactPoint::default(); 12], 0.5, 0.1);
    let copied_ring = || copies::Ring(ring, ring.contacts().to_vec());
    let ground = FlatGround::level(2e3, 5.0);
    let friction = Coulomb {
        coefficient: 0.3,
        slip_speed: 1e-2,
    };
    let integrator = SymplecticEuler { time_step: 1e-3 };
    let built_in = run(ring, ground, friction, integrator);
    assert_eq!(built_in, run(copied_ring(), ground, friction, integrator));
    assert_eq!(
        built_in,
        run(ring, copies::Ground(ground), friction, integrator)
    );
    assert_eq!(
        built_in,
        run(ring, ground, copies::Friction(friction), integrator)
    );
    assert_eq!(built_in, run(ring, ground, friction, copies::Euler(1e-3)));
    assert_eq!(
        built_in,
        run(
            copied_ring(),
            copies::Ground(ground),
            copies::Friction(friction),
            copies::Euler(1e-3)
        )
    );
}

/// Friction, whatever its law, acts at the lowest point of a ball, so the angular momentum about a
/// line of the ground along y stays: a ball of radius r that slides at v without spin ends rolling
/// at 5/7 v. The rest is rounding: 4000 steps of it.
#[test]
fn a_sliding_ball_ends_rolling_at_five_sevenths_of_its_speed() {
    let (mass, radius, speed) = (0.5, 0.1, 2.0);
    let stepper = compose(
        Ball::new(mass, radius),
        turf(),
        oil(),
        Midpoint { time_step: 1e-3 },
    );
    let mut state =
        State::at(DVec3::new(0.0, 0.0, radius)).with_linear_velocity(DVec3::new(speed, 0.0, 0.0));
    stepper
        .advance(&mut state, 10.0)
        .expect("the step is short enough");
    let (velocity, slip) = (
        state.linear_velocity.x,
        stepper
            .lowest_point(&state)
            .expect("a ball has a lowest point")
            .slip_velocity,
    );
    assert!(slip.length() < 1e-6, "still slides at {slip}");
    assert!((velocity - speed * 5.0 / 7.0).abs() < 1e-6, "{velocity}");
    assert_eq!(state.linear_velocity.y, 0.0);
    let about_the_ground = mass * velocity * radius + state.angular_momentum.y;
    assert!(
        (about_the_ground - mass * speed * radius).abs() < 1e4 * f64::EPSILON,
        "{about_the_ground}"
    );
}

/// Checks the energy of a ball with the default integrator for any step size and precision, without
/// a tolerance.
fn energy_never_rises<R: Real>(
    ground: impl SpringDamperGround<R>,
    friction: impl SlidingFriction<R>,
) {
    for time_step in [1e-4, 1e-3, 1e-2, 0.1, 1.0] {
        let time_step = R::from_f64(time_step);
        let integrator = EnergyMomentum { time_step };
        let stepper = compose(ball::<R>(), &ground, &friction, integrator);
        let mut state = thrown();
        let mut before = stepper.energy(&state).total();
        for _ in 0..2000 {
            stepper.step(&mut state).expect("the step goes on");
            let after = stepper.energy(&state).total();
            assert!(
                after <= before,
                "step {time_step}: from {before} to {after}"
            );
            before = after;
        }
    }
}

#[test]
fn the_energy_of_a_users_scene_never_rises_in_f64() {
    energy_never_rises::<f64>(turf(), oil());
}

#[test]
fn the_energy_of_a_users_scene_never_rises_in_f32() {
    energy_never_rises::<f32>(turf(), oil());
}

/// Halving the step of a method of order 2 takes the error to a quarter, in a contact that never
/// opens: here to a 3.5th to a 4.6th.
#[test]
fn the_users_integrator_has_the_order_that_it_states() {
    let swing = |time_step: f64| {
        let stepper = compose(ball::<f64>(), turf(), oil(), Midpoint { time_step });
        let mut state = State::at(DVec3::new(0.0, 0.0, 0.0965))
            .with_linear_velocity(DVec3::new(0.3, 0.0, 0.0))
            .with_angular_momentum(DVec3::new(1e-3, 2e-3, 1e-3));
        stepper
            .advance(&mut state, 0.2)
            .expect("the step is short enough");
        assert!(state.orientation.is_normalized() && state.orientation.xyzw()[3] < 1.0);
        state.position
    };
    let truth = swing(1e-6);
    let [coarse, fine] = [1e-3, 5e-4].map(|step| (swing(step) - truth).length());
    assert!((3.5..4.6).contains(&(coarse / fine)), "{coarse:e} {fine:e}");
}

/// A user's event: the body passes a plane `x = place` (m) forwards.
struct Passes<R>(R);

impl<R: Real> Event<R> for Passes<R> {
    fn value(&self, sample: &Sample<'_, R>) -> R {
        sample.state.position.x() - self.0
    }
    fn direction(&self) -> EventDirection {
        EventDirection::Rising
    }
}

/// With a user's parts and a user's method. A ball that flies at 1 m/s from 0.1 m passes 0.13 m after
/// 30 ms, before its first touch. A step of the midpoint rule is exact in flight.
fn a_users_event_is_located<R: Real>(tolerance: f64) {
    let time_step = R::from_f64(7e-4);
    let stepper = compose(ball::<R>(), turf(), oil(), Midpoint { time_step });
    let mut session = stepper.session(thrown());
    let plane = Passes(R::from_f64(0.13));
    let end = session
        .run_until_event(R::HALF, [&Apex, &plane.nth(1).expect("1 is a count")])
        .expect("the steps are good");
    let found = end.occurrence().expect("the ball passes the plane");
    assert_eq!((found.event, found.count), (1, 1));
    let off = found.time.to_f64() - 0.03;
    assert!(off.abs() < tolerance, "{off:e}");
}

#[test]
fn a_users_event_is_located_in_both_precisions() {
    a_users_event_is_located::<f64>(1e-12);
    // The place is rounded to 6e-8 of 0.13 m in each of 43 steps, at 1 m/s.
    a_users_event_is_located::<f32>(43.0 * 1e-8);
}

/// A user's lift: across velocity and spin, so that it does no work. Its computed power is rounding
/// of either sign, which no step may take for a gain.
struct Magnus(f64);

impl Force for Magnus {
    fn wrench(&self, motion: &Motion) -> Wrench {
        let across = motion.angular_velocity.cross(motion.linear_velocity);
        Wrench::of_force(across * self.0)
    }
    fn is_passive(&self) -> bool {
        true
    }
}

#[test]
fn a_users_lift_whose_power_is_rounding_is_no_broken_law() {
    let stepper = compose(ball(), turf(), oil(), EnergyMomentum { time_step: 1e-3 })
        .with_force(Magnus(0.03))
        .expect("the force is valid");
    let mut state = thrown();
    let mut before = stepper.energy(&state).total();
    let mut gains = 0;
    for _ in 0..1000 {
        let motion = stepper.scene().motion(&state);
        gains += u32::from(Magnus(0.03).wrench(&motion).power(&motion) > 0.0);
        stepper.step(&mut state).expect("the lift is passive");
        let after = stepper.energy(&state).total();
        assert!(after <= before, "from {before} to {after}");
        before = after;
    }
    assert!(gains > 100, "{gains} powers above 0");
}

/// The energy minus the work of a user's drives never increases: a motor, and a ground that turns.
fn energy_minus_work_never_rises<R: Real>() {
    let number = R::from_f64;
    let ground = Turning {
        ground: turf::<R>(),
        rate: number(7.0),
    };
    let motor = Motor {
        rate: number(-20.0),
        drag: number(1e-3),
    };
    let mut gained = R::ZERO;
    for time_step in [1e-4, 1e-3, 1e-2, 0.1] {
        let time_step = number(time_step);
        let stepper = compose(ball::<R>(), ground, carpet(), EnergyMomentum { time_step })
            .with_force(motor)
            .expect("the force is valid");
        let mut state = thrown();
        let mut before = stepper.energy(&state).total();
        for _ in 0..2000 {
            let step = stepper.step(&mut state).expect("the step goes on");
            let after = stepper.energy(&state).total();
            assert!(
                after <= before + step.drive_work,
                "step {time_step}: from {before} to {after} with {}",
                step.drive_work
            );
            gained += step.drive_work.at_least(R::ZERO);
            before = after;
        }
    }
    assert!(gained > number(0.01), "the drives give {gained} J");
}

#[test]
fn the_energy_minus_the_work_of_a_users_drives_never_rises() {
    energy_minus_work_never_rises::<f64>();
    energy_minus_work_never_rises::<f32>();
}

/// A copy of the moving ground, in a user's type, has its bits.
#[test]
fn a_users_moving_ground_has_the_bits_of_the_built_in_one() {
    let (ground, rate) = (FlatGround::level(2e3, 5.0), 7.0);
    let built_in = MovingGround::turntable(ground, DVec3::ZERO, rate);
    let law = oil();
    let integrators = || EnergyMomentum { time_step: 1e-3 };
    let expected = run(ball(), built_in, law, integrators());
    let ours = Turning { ground, rate };
    assert_eq!(expected, run(ball(), ours, law, integrators()));
    assert_eq!(
        expected,
        run(ball(), &ours as &dyn SpringDamperGround, law, integrators())
    );
    assert_ne!(expected, run(ball(), ground, law, integrators()));
}

/// A user's law in a field by position has the bits of his own law that varies over the ground.
#[test]
fn a_field_of_a_users_laws_has_the_bits_of_his_own() {
    let Carpet { drag, width } = carpet::<f64>();
    let field = FrictionField::new(move |position: DVec3| Viscous {
        drag: drag * (position.x / width).clamp(0.0, 1.0),
    });
    let strang = StrangSplitting { time_step: 1e-3 };
    let by_field = run(ball(), turf::<f64>(), field, strang);
    let by_law = run(ball(), turf::<f64>(), carpet::<f64>(), strang);
    assert_eq!(by_field, by_law);
    let bare = run(ball(), turf::<f64>(), Viscous { drag: 0.0 }, strang);
    assert!((bare.position - by_law.position).length() > 1e-3);
}

/// A wall of a user's turf in the way of [`thrown`] bodies, beside the floor.
fn walled<R: Real>() -> (Turf<R>, FlatGround<R>) {
    let plane = Plane::through(
        R::Vec3::new(R::from_f64(0.3), R::ZERO, R::ZERO),
        R::Vec3::new(-R::ONE, R::ZERO, R::ZERO),
    );
    let wall = FlatGround::level(R::from_f64(2e3), R::from_f64(5.0)).on(plane);
    (turf(), wall)
}

/// A user's ground is a surface among others, with a user's law: by value, by reference, behind
/// `dyn` and boxed it has the same bits, and the wall is felt.
fn a_users_ground_beside_a_wall<R: Real>(integrator: impl Integrator<R> + Copy) {
    let (floor, wall) = walled::<R>();
    let laws = (oil::<R>(), carpet::<R>());
    let by_value = run(ball(), (floor, wall), laws, integrator);
    let parts = (
        &floor as &dyn SpringDamperGround<R>,
        &wall as &dyn SpringDamperGround<R>,
    );
    let of_surfaces = (
        &laws.0 as &dyn SlidingFriction<R>,
        &laws.1 as &dyn SlidingFriction<R>,
    );
    assert_eq!(by_value, run(ball(), parts, of_surfaces, integrator));
    let boxed: Vec<Box<dyn SpringDamperGround<R>>> = vec![Box::new(floor), Box::new(wall)];
    assert_eq!(by_value, run(ball(), &boxed[..], laws, integrator));
    // The ball of 0.1 m meets the wall at 0.2 m.
    let within = R::from_f64(0.21);
    assert!(by_value.position.x() < within);
    let floor_alone = run(ball(), floor, oil(), integrator);
    assert!(floor_alone.position.x() > within);
}

#[test]
fn a_users_ground_is_a_surface_among_others_in_both_precisions() {
    fn with_every_integrator<R: Real>() {
        let time_step = R::from_f64(1e-3);
        a_users_ground_beside_a_wall(ForwardEuler { time_step });
        a_users_ground_beside_a_wall(Nystrom { time_step });
        a_users_ground_beside_a_wall(EnergyMomentum { time_step });
        a_users_ground_beside_a_wall(Midpoint { time_step });
    }
    with_every_integrator::<f64>();
    with_every_integrator::<f32>();
}

#[test]
fn the_energy_of_a_users_surface_beside_a_wall_never_rises() {
    energy_never_rises::<f64>(walled(), (oil(), carpet()));
    energy_never_rises::<f32>(walled(), (oil(), carpet()));
}
