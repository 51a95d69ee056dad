//! The core where there is nothing: no standard library, no allocator, and no way to panic.
//!
//! Each `probe_*` is a root for the linker. Every number comes from outside, so that no check and
//! no branch can be worked out at compile time. A panic that is left anywhere below them shows as
//! the undefined symbol `a_panic_remains`; `.ci/no_std.sh` looks for it.
#![no_std]

mod roles;

use core::ops::ControlFlow;

use tumble::contract::{
    CheckPlan, FrictionRange, GroundRange, check_body, check_energy_never_rises, check_friction,
    check_ground, check_integrator,
};
use tumble::glam::DVec3;
use tumble::{
    AdaptiveEnergyMomentum, AdaptiveNystrom, BogackiShampine32, Capsule, Coin,
    CompactEnergyMomentum, Cone, ContactPoint, Coulomb, Cuboid, DormandPrince54, Ellipsoid,
    EnergyMomentum, FlatGround, Flight, Force, ForwardEuler, Gravity, Integrator, Ledger,
    MassProperties, Nystrom, Plane, PointCloud, PointMass, Radau5, Real, RigidPointBody, Rk4, Rod,
    Sample, SlidingFriction, Solid, SolidCoin, Sphere, SpringDamperGround, State, Stepper,
    StrangSplitting, SymplecticEuler, UniformGravity, UntilRest,
};

unsafe extern "C" {
    // Not defined anywhere.
    safe fn a_panic_remains() -> !;
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    a_panic_remains()
}

/// A scene's parameters, in SI units.
#[derive(Debug)]
pub struct Parameters<R: Real> {
    mass: R,
    radius: R,
    stiffness: R,
    damping: R,
    plane: Plane<R>,
    coefficient: R,
    slip_speed: R,
    gravity: R,
    seconds: R,
}

/// Energy error of the audit after the run, or nothing if scene or run fails.
fn run<R: Real>(
    body: impl RigidPointBody<R>,
    integrator: impl Integrator<R>,
    parameters: &Parameters<R>,
    state: &mut State<R>,
) -> Option<R> {
    let &Parameters {
        stiffness,
        damping,
        plane,
        coefficient,
        slip_speed,
        gravity,
        ..
    } = parameters;
    let stepper = Stepper::new(body).ok()?;
    let stepper = stepper.with_gravity(UniformGravity::down(gravity)).ok()?;
    let stepper = stepper
        .with_ground(FlatGround::level(stiffness, damping).on(plane))
        .ok()?;
    let stepper = stepper
        .with_friction(Coulomb {
            coefficient,
            slip_speed,
        })
        .ok()?;
    let stepper = stepper.with_integrator(integrator).ok()?;
    live(&stepper, parameters, state)
}

/// Energy error of the audit of a run with every kind of step, or nothing if a step fails.
fn live<R, B, G, F, A, I, E>(
    stepper: &Stepper<B, G, F, A, I, R, E>,
    parameters: &Parameters<R>,
    state: &mut State<R>,
) -> Option<R>
where
    R: Real,
    B: RigidPointBody<R>,
    G: SpringDamperGround<R>,
    F: SlidingFriction<R>,
    A: Gravity<R>,
    I: Integrator<R>,
    E: Force<R>,
{
    let seconds = parameters.seconds;
    stepper.step(state).ok()?;
    stepper.advance(state, seconds).ok()?;
    let mut states = [*state; 13];
    stepper.advance_many(&mut states, seconds).ok()?;
    *state = states[11];
    let stop_in_flight = |sample: &Sample<'_, R>| {
        if sample.touching() == 0 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let rest = UntilRest::new(stepper.body(), parameters.radius, seconds).ok()?;
    let mut observers = (Ledger::new(), (stop_in_flight, rest));
    stepper.run(state, seconds, &mut observers).ok()?;
    *state = stepper.with_angular_velocity(*state, stepper.angular_velocity(state));
    let lowest = stepper.lowest_point(state)?;
    Some(observers.0.energy_error() + stepper.energy(state).total() + lowest.gap)
}

/// A coin of as many points as there is room for.
fn coin<'a, R: Real>(
    room: &'a mut [ContactPoint<R>],
    parameters: &Parameters<R>,
) -> Coin<R, &'a mut [ContactPoint<R>]> {
    Coin::ring_with_storage(room, parameters.mass, parameters.radius)
}

/// The method of another capacity, beside that of the usual one.
type Compact<R> = CompactEnergyMomentum<32, R>;

macro_rules! probes {
    ($($probe:ident: $integrator:ident in $real:ty;)*) => {$(
        /// A coin by this method, in this precision.
        #[unsafe(no_mangle)]
        pub fn $probe(room: &mut [ContactPoint<$real>], parameters: &Parameters<$real>, time_step: $real, state: &mut State<$real>) -> Option<$real> {
            let coin = coin(room, parameters);
            let tilt = coin.tilt(state);
            Some(tilt + run(&coin, $integrator { time_step }, parameters, state)?)
        }
    )*};
}

probes! {
    probe_forward_euler_f64: ForwardEuler in f64;
    probe_forward_euler_f32: ForwardEuler in f32;
    probe_symplectic_euler_f64: SymplecticEuler in f64;
    probe_symplectic_euler_f32: SymplecticEuler in f32;
    probe_strang_splitting_f64: StrangSplitting in f64;
    probe_strang_splitting_f32: StrangSplitting in f32;
    probe_rk4_f64: Rk4 in f64;
    probe_rk4_f32: Rk4 in f32;
    probe_nystrom_f64: Nystrom in f64;
    probe_nystrom_f32: Nystrom in f32;
    probe_energy_momentum_f64: EnergyMomentum in f64;
    probe_energy_momentum_f32: EnergyMomentum in f32;
    probe_compact_energy_momentum_f64: Compact in f64;
    probe_compact_energy_momentum_f32: Compact in f32;
}

macro_rules! probes_of_pairs {
    ($($probe:ident: $integrator:ident in $real:ty;)*) => {$(
        /// A coin by this method, which chooses its steps, in this precision.
        #[unsafe(no_mangle)]
        pub fn $probe(room: &mut [ContactPoint<$real>], parameters: &Parameters<$real>, tolerance: $real, state: &mut State<$real>) -> Option<$real> {
            run(&coin(room, parameters), $integrator::new(tolerance), parameters, state)
        }
    )*};
}

probes_of_pairs! {
    probe_bogacki_shampine_32_f64: BogackiShampine32 in f64;
    probe_bogacki_shampine_32_f32: BogackiShampine32 in f32;
    probe_dormand_prince_54_f64: DormandPrince54 in f64;
    probe_dormand_prince_54_f32: DormandPrince54 in f32;
    probe_adaptive_nystrom_f64: AdaptiveNystrom in f64;
    probe_adaptive_nystrom_f32: AdaptiveNystrom in f32;
    probe_adaptive_energy_momentum_f64: AdaptiveEnergyMomentum in f64;
    probe_adaptive_energy_momentum_f32: AdaptiveEnergyMomentum in f32;
    probe_radau5_f64: Radau5 in f64;
    probe_radau5_f32: Radau5 in f32;
}

/// Flight in closed form, around a method of fixed steps and around one that chooses them.
#[unsafe(no_mangle)]
pub fn probe_flight_f64(
    room: &mut [ContactPoint],
    parameters: &Parameters<f64>,
    time_step: f64,
    state: &mut State,
) -> Option<f64> {
    let coin = coin(room, parameters);
    let fixed = Flight(EnergyMomentum { time_step });
    let adaptive = Flight(DormandPrince54::new(time_step));
    Some(run(&coin, fixed, parameters, state)? + run(&coin, adaptive, parameters, state)?)
}

/// The same in single precision.
#[unsafe(no_mangle)]
pub fn probe_flight_f32(
    room: &mut [ContactPoint<f32>],
    parameters: &Parameters<f32>,
    time_step: f32,
    state: &mut State<f32>,
) -> Option<f32> {
    let coin = coin(room, parameters);
    let fixed = Flight(EnergyMomentum { time_step });
    run(&coin, fixed, parameters, state)
}

/// A body of any points and masses, with the whole tensor and its principal axes.
#[unsafe(no_mangle)]
pub fn probe_point_cloud(
    points: &mut [ContactPoint],
    masses: &[f64],
    parameters: &Parameters<f64>,
    time_step: f64,
    state: &mut State,
) -> Option<f64> {
    let cloud = PointCloud::with_storage(points, masses).ok()?;
    run(&cloud, StrangSplitting { time_step }, parameters, state)
}

/// Solids put together, and each body that is made of one.
#[unsafe(no_mangle)]
pub fn probe_solids(
    room: &mut [ContactPoint],
    places: &[DVec3],
    triangles: &[[usize; 3]],
    parameters: &Parameters<f64>,
    time_step: f64,
    state: &mut State,
) -> Option<f64> {
    let &Parameters { mass, radius, .. } = parameters;
    let edges = parameters.plane.normal;
    let hull = MassProperties::hull(mass, places).ok()?;
    let mesh = MassProperties::mesh(mass, places, triangles).ok()?;
    let parts = MassProperties::capsule(mass, radius, radius)
        .ok()?
        .with(
            &MassProperties::cone(mass, radius, radius)
                .ok()?
                .rotated(state.rotation()),
        )
        .with(&MassProperties::ellipsoid(mass, edges).ok()?.at(edges))
        .with(&hull)
        .with(&mesh);
    let coin = SolidCoin::new_with_storage(&mut *room, mass, radius, radius);
    let _ = (coin.tilt(state), coin.face_up(state));
    let mut sum = run(&coin, EnergyMomentum { time_step }, parameters, state)?;
    let cone = Cone::solid_with_storage(&mut *room, mass, radius, radius);
    sum += run(&cone, Rk4 { time_step }, parameters, state)?;
    let die = Cuboid::loaded(edges, parts).rounded(radius);
    let _ = die.face_up(state)?.pips();
    sum += run(die, EnergyMomentum { time_step }, parameters, state)?;
    let egg = Ellipsoid::loaded(edges, parts);
    sum += run(egg, EnergyMomentum { time_step }, parameters, state)?;
    sum += run(
        Sphere::loaded(radius, parts),
        Rk4 { time_step },
        parameters,
        state,
    )?;
    sum += run(
        Capsule::solid(mass, radius, radius),
        Rk4 { time_step },
        parameters,
        state,
    )?;
    sum += run(Rod::new(mass, radius), Rk4 { time_step }, parameters, state)?;
    sum += run(PointMass::new(mass), Rk4 { time_step }, parameters, state)?;
    let solid = Solid::new(parts, room).ok()?;
    Some(sum + run(&solid, Rk4 { time_step }, parameters, state)?)
}

/// The checks of a user's parts, run on the target.
#[unsafe(no_mangle)]
pub fn probe_contract(
    room: &mut [ContactPoint],
    parameters: &Parameters<f64>,
    plan: CheckPlan,
    time_step: f64,
) -> bool {
    let ground = FlatGround::level(parameters.stiffness, parameters.damping).on(parameters.plane);
    let friction = Coulomb {
        coefficient: parameters.coefficient,
        slip_speed: parameters.slip_speed,
    };
    let normal = parameters.plane.normal;
    let range = GroundRange {
        centre: normal,
        size: parameters.radius,
        depth: parameters.radius,
        speed: parameters.gravity,
    };
    let slides = FrictionRange {
        centre: range.centre,
        size: range.size,
        normal,
        normal_force: parameters.mass,
        slip: parameters.gravity,
    };
    check_body(&coin(room, parameters), plan).is_ok()
        && check_ground(&ground, &range, plan).is_ok()
        && check_friction(&friction, &slides, plan).is_ok()
        && check_integrator::<f64, _>(&EnergyMomentum { time_step }, plan).is_ok()
        && check_energy_never_rises::<f64, _>(&EnergyMomentum { time_step }, plan).is_ok()
}

/// The control: it can panic, and the check must see that. It is linked by itself.
#[unsafe(no_mangle)]
pub fn probe_control(numbers: &[f64], at: usize) -> f64 {
    numbers[at]
}
