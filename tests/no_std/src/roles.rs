//! One probe for each role that a scene may have and that the coin of the other probes has not.

use core::ops::ControlFlow;

use tumble::glam::DVec3;
use tumble::real::Vector;
use tumble::{
    AirDrag, AnisotropicCoulomb, Apex, Block, Bowl, Carried, ConstantForce, ContactCloses,
    ContactOpens, ContactPoint, Coulomb, Cuboid, Disc, DormandPrince54, Dynamics, Elevation,
    Ellipsoid, EnergyMomentum, Event, Every, Faces, FlatGround, Flight, Force, FreeRotation,
    FrictionField, FrictionPatch, Ground, HuntCrossley, Impact, Integrator, Landing, LiftOff,
    LimitedDamper, LoadDependentCoulomb, MassProperties, MovingGround, Outcome, Radau5, Ramp, Real,
    Region, RigidPointBody, Sample, SlidingFriction, SlipEnds, SmoothCoulomb, Solid, Sphere,
    SpinDrag, SpinLift, SpringDamper, SpringDamperGround, State, Stepper, Stribeck, Terrain,
    ThickDisc, Timed, UniformGravity, UntilDecided, Viscous, Waves, Wind, WithResistance,
};

use super::{Parameters, live};

fn gravity<R: Real>(parameters: &Parameters<R>) -> UniformGravity<R> {
    UniformGravity::down(parameters.gravity)
}

fn flat<R: Real>(parameters: &Parameters<R>) -> FlatGround<R> {
    FlatGround::level(parameters.stiffness, parameters.damping).on(parameters.plane)
}

fn spring<R: Real>(parameters: &Parameters<R>) -> SpringDamper<R> {
    SpringDamper {
        stiffness: parameters.stiffness,
        damping: parameters.damping,
    }
}

fn coulomb<R: Real>(parameters: &Parameters<R>) -> Coulomb<R> {
    Coulomb {
        coefficient: parameters.coefficient,
        slip_speed: parameters.slip_speed,
    }
}

fn smooth<R: Real>(parameters: &Parameters<R>) -> SmoothCoulomb<R> {
    SmoothCoulomb {
        coefficient: parameters.coefficient,
        slip_speed: parameters.slip_speed,
    }
}

/// A scene of any parts and its run.
fn run<R: Real>(
    body: impl RigidPointBody<R>,
    (ground, friction): (impl SpringDamperGround<R>, impl SlidingFriction<R>),
    integrator: impl Integrator<R>,
    parameters: &Parameters<R>,
    state: &mut State<R>,
) -> Option<R> {
    let stepper = Stepper::builder(body)
        .gravity(gravity(parameters))
        .ground(ground)
        .friction(friction)
        .integrator(integrator)
        .build()
        .ok()?;
    live(&stepper, parameters, state)
}

fn energy_momentum<R: Real>(parameters: &Parameters<R>) -> EnergyMomentum<R> {
    let time_step = parameters.seconds;
    EnergyMomentum { time_step }
}

macro_rules! probes_of_rims {
    ($($probe:ident in $real:ty;)*) => {$(
        /// Round rims, alone and as a pair, on a plane and on hills.
        #[unsafe(no_mangle)]
        pub fn $probe(
            points: usize,
            bowl: Bowl<$real>,
            parameters: &Parameters<$real>,
            state: &mut State<$real>,
        ) -> Option<$real> {
            let &Parameters { mass, radius, .. } = parameters;
            let laws = (flat(parameters), coulomb(parameters));
            let method = energy_momentum(parameters);
            let disc = Disc::ring(mass, radius, points);
            let tilt = disc.tilt(state);
            let coin = ThickDisc::solid(mass, radius, radius, points);
            let sum = run(&disc, laws, method, parameters, state)?
                + run(&coin, laws, method, parameters, state)?;
            let hills = Ground {
                law: spring(parameters),
                shape: Terrain::of::<$real>(bowl),
            };
            let laws = (hills, coulomb(parameters));
            Some(tilt + sum + run(&disc, laws, method, parameters, state)?)
        }
    )*};
}

probes_of_rims! {
    probe_round_rims_f64 in f64;
    probe_round_rims_f32 in f32;
}

/// Each shape of ground that is no plane, under points and under a smooth body.
#[unsafe(no_mangle)]
pub fn probe_terrain(
    ramp: Ramp<f64>,
    waves: Waves<f64>,
    block: Block<f64>,
    parameters: &Parameters<f64>,
    state: &mut State,
) -> Option<f64> {
    let &Parameters { mass, radius, .. } = parameters;
    let edges = parameters.plane.normal;
    let method = energy_momentum(parameters);
    let (law, friction) = (spring(parameters), coulomb(parameters));
    let shape = Terrain::of::<f64>(ramp);
    let laws = (Ground { law, shape }, friction);
    let mut sum = run(Cuboid::solid(mass, edges), laws, method, parameters, state)?;
    let shape = Terrain::of::<f64>(waves);
    let laws = (Ground { law, shape }, friction);
    sum += run(
        Ellipsoid::solid(mass, edges),
        laws,
        method,
        parameters,
        state,
    )?;
    let saddle = |x: f64, y: f64| Elevation::new(radius * x * y, [radius * y, radius * x]);
    let shape = Terrain::of::<f64>(saddle);
    let laws = (Ground { law, shape }, friction);
    let pair = DormandPrince54::new(parameters.slip_speed);
    sum += run(Sphere::solid(mass, radius), laws, pair, parameters, state)?;
    let laws = (Ground { law, shape: block }, friction);
    Some(sum + run(Cuboid::solid(mass, edges), laws, method, parameters, state)?)
}

/// Each contact law beside the spring-damper, by its constructors for a bounce.
#[unsafe(no_mangle)]
pub fn probe_contact_laws(
    carried: Carried<f64>,
    impact: Impact<f64>,
    parameters: &Parameters<f64>,
    state: &mut State,
) -> Option<f64> {
    let &Parameters { mass, radius, .. } = parameters;
    let (shape, friction) = (parameters.plane, coulomb(parameters));
    let method = energy_momentum(parameters);
    let law = HuntCrossley::from_bounce(carried, parameters.coefficient, impact, radius).ok()?;
    let laws = (Ground { law, shape }, friction);
    let mut sum = run(Sphere::solid(mass, radius), laws, method, parameters, state)?;
    let law = LimitedDamper::from_bounce(carried, impact.restitution, radius).ok()?;
    let laws = (Ground { law, shape }, friction);
    sum += run(Sphere::solid(mass, radius), laws, method, parameters, state)?;
    let law = SpringDamper::from_bounce(carried, impact.restitution, radius).ok()?;
    let laws = (Ground { law, shape }, friction);
    let radau = Radau5::new(parameters.slip_speed);
    Some(sum + run(Sphere::solid(mass, radius), laws, radau, parameters, state)?)
}

/// Friction laws beside Coulomb's on a coin, by the method that solves for them.
#[unsafe(no_mangle)]
pub fn probe_friction_laws(
    room: &mut [ContactPoint],
    grain: AnisotropicCoulomb<f64>,
    stribeck: Stribeck<f64>,
    load_dependent: LoadDependentCoulomb<f64>,
    parameters: &Parameters<f64>,
    state: &mut State,
) -> Option<f64> {
    let coin = &super::coin(room, parameters);
    let (ground, method) = (flat(parameters), energy_momentum(parameters));
    let mut sum = run(coin, (ground, grain), method, parameters, state)?;
    sum += run(coin, (ground, stribeck), method, parameters, state)?;
    Some(sum + run(coin, (ground, load_dependent), method, parameters, state)?)
}

/// Resistance to rolling and spinning.
#[unsafe(no_mangle)]
pub fn probe_resistance(
    room: &mut [ContactPoint],
    rolling: f64,
    spinning: f64,
    parameters: &Parameters<f64>,
    state: &mut State,
) -> Option<f64> {
    let &Parameters { mass, radius, .. } = parameters;
    let resistance = WithResistance {
        friction: smooth(parameters),
        rolling,
        spinning,
        turn_speed: parameters.slip_speed,
    };
    let laws = (flat(parameters), resistance);
    let method = energy_momentum(parameters);
    let coin = &super::coin(room, parameters);
    let sum = run(coin, laws, method, parameters, state)?;
    Some(sum + run(Sphere::solid(mass, radius), laws, method, parameters, state)?)
}

/// Friction that depends on the position: a patch of another law, and a field.
#[unsafe(no_mangle)]
pub fn probe_friction_by_position(
    room: &mut [ContactPoint],
    region: Region<f64>,
    viscous: Viscous<f64>,
    parameters: &Parameters<f64>,
    state: &mut State,
) -> Option<f64> {
    let coin = &super::coin(room, parameters);
    let (ground, method) = (flat(parameters), energy_momentum(parameters));
    let patch = FrictionPatch {
        outside: coulomb(parameters),
        inside: viscous,
        region,
    };
    let sum = run(coin, (ground, patch), method, parameters, state)?;
    let &Parameters {
        coefficient,
        slip_speed,
        radius,
        ..
    } = parameters;
    let field = FrictionField::new(move |position: DVec3| Coulomb {
        coefficient: coefficient + radius * position.x * position.x,
        slip_speed,
    });
    let radau = Radau5::new(slip_speed);
    Some(sum + run(coin, (ground, field), radau, parameters, state)?)
}

/// Ground of several surfaces, each with its own law: a tuple and a slice.
#[unsafe(no_mangle)]
pub fn probe_several_surfaces(
    room: &mut [ContactPoint],
    floor_and_walls: &[FlatGround<f64>],
    laws: &[Coulomb<f64>],
    block: Block<f64>,
    parameters: &Parameters<f64>,
    state: &mut State,
) -> Option<f64> {
    let coin = &super::coin(room, parameters);
    let method = energy_momentum(parameters);
    let mut sum = run(coin, (floor_and_walls, laws), method, parameters, state)?;
    let table = Ground {
        law: spring(parameters),
        shape: block,
    };
    let pair = (
        (flat(parameters), table),
        (coulomb(parameters), smooth(parameters)),
    );
    sum += run(coin, pair, method, parameters, state)?;
    let radau = Radau5::new(parameters.slip_speed);
    Some(sum + run(coin, pair, radau, parameters, state)?)
}

/// Ground that moves: a turntable, and a conveyor as one of several surfaces.
#[unsafe(no_mangle)]
pub fn probe_moving_ground(
    room: &mut [ContactPoint],
    rate: f64,
    parameters: &Parameters<f64>,
    state: &mut State,
) -> Option<f64> {
    let coin = &super::coin(room, parameters);
    let method = energy_momentum(parameters);
    let (ground, friction) = (flat(parameters), coulomb(parameters));
    let normal = parameters.plane.normal;
    let table = MovingGround::turntable(ground, normal, rate);
    let mut sum = run(coin, (table, friction), method, parameters, state)?;
    let conveyor = MovingGround::conveyor(ground, normal);
    sum += run(
        coin,
        ((conveyor, ground), (friction, friction)),
        method,
        parameters,
        state,
    )?;
    let radau = Radau5::new(parameters.slip_speed);
    Some(sum + run(coin, (table, friction), radau, parameters, state)?)
}

/// A scene with an applied force and its run.
fn driven<R: Real>(
    body: impl RigidPointBody<R>,
    force: impl Force<R>,
    integrator: impl Integrator<R>,
    parameters: &Parameters<R>,
    state: &mut State<R>,
) -> Option<R> {
    let stepper = Stepper::builder(body)
        .gravity(gravity(parameters))
        .ground(flat(parameters))
        .friction(coulomb(parameters))
        .force(force)
        .integrator(integrator)
        .build()
        .ok()?;
    live(&stepper, parameters, state)
}

macro_rules! probes_of_forces {
    ($($probe:ident in $real:ty;)*) => {$(
        /// Each applied force, by a method that solves for it and by one that evaluates it.
        #[unsafe(no_mangle)]
        pub fn $probe(
            room: &mut [ContactPoint<$real>],
            air: (AirDrag<$real>, SpinLift<$real>, SpinDrag<$real>),
            constant: ConstantForce<$real>,
            parameters: &Parameters<$real>,
            state: &mut State<$real>,
        ) -> Option<$real> {
            let coin = &super::coin(room, parameters);
            let method = energy_momentum(parameters);
            let (drag, lift, spin) = air;
            let velocity = parameters.plane.normal;
            let wind = Wind { force: drag, velocity };
            let mut sum = driven(coin, drag, method, parameters, state)?;
            sum += driven(coin, (wind, lift, spin, constant), method, parameters, state)?;
            let pair = DormandPrince54::new(parameters.slip_speed);
            sum += driven(coin, (wind, lift, spin), pair, parameters, state)?;
            let radau = Radau5::new(parameters.slip_speed);
            sum += driven(coin, (wind, spin), radau, parameters, state)?;
            Some(sum + driven(coin, constant, Flight(method), parameters, state)?)
        }
    )*};
}

probes_of_forces! {
    probe_applied_forces_f64 in f64;
    probe_applied_forces_f32 in f32;
}

macro_rules! probes_of_free_rotation {
    ($($probe:ident in $real:ty;)*) => {$(
        /// Free rotation in closed form, of any moments and at any time.
        #[unsafe(no_mangle)]
        pub fn $probe(
            parts: &MassProperties<$real>,
            time: $real,
            state: &mut State<$real>,
            room: &mut [ContactPoint<$real>],
        ) -> Option<()> {
            let solid = Solid::new(*parts, room).ok()?;
            let stepper = Stepper::new(&solid).ok()?;
            let inertia = stepper.scene().inertia_properties();
            let momentum = state.angular_momentum;
            let free = FreeRotation::new(inertia, state.rotation(), momentum);
            state.orientation = free.rotation_at(time).to_quat();
            let again = stepper.free_rotation(state).rotation_at(time);
            state.orientation = again.to_quat();
            Some(())
        }
    )*};
}

probes_of_free_rotation! {
    probe_free_rotation_f64 in f64;
    probe_free_rotation_f32 in f32;
}

/// Runs until the face is decided, by the barriers of a body with faces.
fn decided<B: RigidPointBody + Faces>(
    body: B,
    parameters: &Parameters<f64>,
    state: &mut State,
) -> Option<bool> {
    let stepper = Stepper::builder(body)
        .gravity(gravity(parameters))
        .ground(flat(parameters))
        .friction(coulomb(parameters))
        .integrator(Flight(energy_momentum(parameters)))
        .build()
        .ok()?;
    let barriers = stepper.barriers()?;
    let at_start = matches!(barriers.outcome(state), Outcome::Decided(_));
    let mut observer = UntilDecided::new(barriers);
    stepper.run(state, parameters.seconds, &mut observer).ok()?;
    Some(at_start || observer.face().is_some())
}

/// Outcomes of a cuboid, of coins and of a hull.
#[unsafe(no_mangle)]
pub fn probe_outcomes(
    room: &mut [ContactPoint],
    parts: &MassProperties,
    points: usize,
    parameters: &Parameters<f64>,
    state: &mut State,
) -> Option<bool> {
    let &Parameters { mass, radius, .. } = parameters;
    let edges = parameters.plane.normal;
    let mut any = decided(Cuboid::solid(mass, edges), parameters, state)?;
    any |= decided(Disc::solid(mass, radius, points), parameters, state)?;
    any |= decided(
        ThickDisc::solid(mass, radius, radius, points),
        parameters,
        state,
    )?;
    any |= decided(super::coin(&mut *room, parameters), parameters, state)?;
    let coin = tumble::SolidCoin::new_with_storage(&mut *room, mass, radius, radius);
    any |= decided(coin, parameters, state)?;
    let hull = Solid::new(*parts, room).ok()?;
    Some(any | decided(hull, parameters, state)?)
}

/// A session with events, states within a step, samples, an impulse, and a save.
fn attended<R: Real>(
    room: &mut [ContactPoint<R>],
    integrator: impl Integrator<R>,
    parameters: &Parameters<R>,
    state: &mut State<R>,
) -> Option<R> {
    let &Parameters {
        seconds,
        radius,
        slip_speed,
        ..
    } = parameters;
    let stepper = Stepper::builder(super::coin(room, parameters))
        .gravity(gravity(parameters))
        .ground(flat(parameters))
        .friction(coulomb(parameters))
        .integrator(integrator)
        .build()
        .ok()?;
    let mut session = stepper.session(*state);
    let end = session
        .run_until_event(seconds, [&Landing, &Apex, &LiftOff])
        .ok()?;
    let mut time = end
        .occurrence()
        .map_or(R::ZERO, |occurrence| occurrence.time);
    let user = |sample: &Sample<'_, R>| sample.state.position.dot(parameters.plane.normal) - radius;
    let sampled = user.rising().sampled_every(slip_speed).ok()?;
    let ends = SlipEnds::below(slip_speed).ok()?;
    let events: [&dyn Event<R>; 4] = [&ContactCloses, &ContactOpens, &ends, &sampled];
    let end = session.run_with_events(seconds, events, |occurrence| {
        time += occurrence.time;
        ControlFlow::Continue(())
    });
    end.ok()?.occurrence().is_none().then_some(())?;
    let normal = parameters.plane.normal;
    session.apply_impulse(normal, normal).ok()?;
    session.step_within(seconds).ok()?;
    let mut dense = session.dense_step().ok()?;
    *state = dense.state_after(radius).ok()?;
    for moment in session.samples(seconds).ok()?.take(3) {
        *state = moment.ok()?.state;
    }
    let saved = session.save();
    let mut session = stepper.resume(&saved).ok()?;
    session.advance(seconds).ok()?;
    let watch = |_: &Sample<'_, R>| ControlFlow::Continue(());
    let mut observers = (
        Timed::every(radius, watch).ok()?,
        Every::steps(3, watch).ok()?,
    );
    session.run(seconds, &mut observers).ok()?;
    *state = session.into_state();
    Some(time)
}

macro_rules! probes_of_sessions {
    ($($probe:ident in $real:ty;)*) => {$(
        /// A session by a method of fixed steps and by one that chooses them.
        #[unsafe(no_mangle)]
        pub fn $probe(
            room: &mut [ContactPoint<$real>],
            parameters: &Parameters<$real>,
            state: &mut State<$real>,
        ) -> Option<$real> {
            let fixed = energy_momentum(parameters);
            let adaptive = DormandPrince54::new(parameters.slip_speed);
            let time = attended(&mut *room, fixed, parameters, state)?;
            Some(time + attended(room, adaptive, parameters, state)?)
        }
    )*};
}

probes_of_sessions! {
    probe_session_f64 in f64;
    probe_session_f32 in f32;
}
