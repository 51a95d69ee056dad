//! A step takes no memory, whatever the integrator, and neither does composing a scene or watching
//! a run.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::hint::black_box;
use std::ops::ControlFlow;

use downstream::{Ball, Midpoint, Turf, Viscous};
use tumble::glam::DVec3;
use tumble::{
    AdaptiveEnergyMomentum, AdaptiveNystrom, Apex, BogackiShampine32, Coin, CompactEnergyMomentum,
    Coulomb, DormandPrince54, EnergyMomentum, FlatGround, Flight, ForwardEuler, Integrator,
    Landing, Ledger, Nystrom, Plane, Radau5, RigidPointBody, Rk4, Sample, SlidingFriction,
    SpringDamperGround, State, Stepper, StrangSplitting, SymplecticEuler, UniformGravity,
    UntilRest,
};

/// The system's allocator, with a count of this thread's allocations.
struct Counting;

thread_local! {
    static REQUESTS: Cell<u64> = const { Cell::new(0) };
}

fn count() {
    REQUESTS.with(|requests| requests.set(requests.get() + 1));
}

// SAFETY: every call is passed to the system's allocator unchanged. The count is a plain number of
// this thread and does not allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc(layout) }
    }
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc_zeroed(layout) }
    }
    unsafe fn realloc(&self, place: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        unsafe { System.realloc(place, layout, size) }
    }
    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        unsafe { System.dealloc(place, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Number of allocations of `work`.
fn requests(work: impl FnOnce()) -> u64 {
    let before = REQUESTS.get();
    work();
    REQUESTS.get() - before
}

/// Composes a scene, steps, advances and observes a run with the energy audit. The body falls at
/// first, then touches and slides.
fn live<I: Integrator>(
    body: impl RigidPointBody,
    ground: impl SpringDamperGround,
    friction: impl SlidingFriction,
    integrator: I,
) {
    let stepper = Stepper::new(body)
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(9.8)))
        .and_then(|stepper| stepper.with_ground(ground))
        .and_then(|stepper| stepper.with_friction(friction))
        .and_then(|stepper| stepper.with_integrator(integrator))
        .expect("every part is valid");
    let mut state = State::at(DVec3::new(0.0, 0.0, 0.6))
        .with_linear_velocity(DVec3::X)
        .with_angular_momentum(DVec3::new(0.1, 0.2, 0.3));
    // On a copy: a step that chooses its own length may go as far as the first touch.
    let mut aside = state;
    stepper.step(&mut aside).expect("the step is good");
    stepper
        .advance(&mut state, 0.1)
        .expect("the steps are good");
    let mut touched = 0;
    let watch = |sample: &Sample<'_>| {
        touched = touched.max(sample.touching());
        ControlFlow::Continue(())
    };
    let rest = UntilRest::new(stepper.body(), 1e-4, 1.0).expect("the limits are good");
    let mut observers = (Ledger::new(), (watch, rest));
    stepper
        .run(&mut state, 0.2, &mut observers)
        .expect("the steps are good");
    black_box((
        observers.0.energy_error(),
        stepper.energy(&state).total(),
        stepper.lowest_point(&state),
    ));
    assert!(touched > 0, "the body has touched the ground");
    let mut session = stepper.session(state);
    let end = session
        .run_with_events(0.05, [&Landing, &Apex], |_| ControlFlow::Continue(()))
        .expect("the steps are good");
    assert!(end.occurrence().is_none(), "no event ends such a run");
}

fn live_with_every_integrator(
    body: impl RigidPointBody + Copy,
    ground: impl SpringDamperGround + Copy,
    friction: impl SlidingFriction + Copy,
) {
    let time_step = 1e-4;
    live(body, ground, friction, ForwardEuler { time_step });
    live(body, ground, friction, SymplecticEuler { time_step });
    live(body, ground, friction, StrangSplitting { time_step });
    live(body, ground, friction, Rk4 { time_step });
    live(body, ground, friction, Nystrom { time_step });
    live(body, ground, friction, EnergyMomentum { time_step });
    live(body, ground, friction, BogackiShampine32::new(1e-6));
    live(body, ground, friction, DormandPrince54::new(1e-6));
    live(body, ground, friction, AdaptiveNystrom::new(1e-6));
    live(body, ground, friction, AdaptiveEnergyMomentum::new(1e-4));
    live(body, ground, friction, Radau5::new(1e-6));
    live(
        body,
        ground,
        friction,
        CompactEnergyMomentum::<32, f64> { time_step },
    );
    live(body, ground, friction, Flight(EnergyMomentum { time_step }));
    live(body, ground, friction, Midpoint { time_step });
}

#[test]
fn the_allocator_counts() {
    assert_eq!(requests(|| drop(black_box(Box::new(1)))), 1);
}

#[test]
fn no_integrator_asks_for_memory() {
    let (coin, ground, friction) = (
        Coin::ring(1.0, 0.5),
        FlatGround::level(1e3, 0.5),
        Coulomb {
            coefficient: 0.3,
            slip_speed: 1e-3,
        },
    );
    assert_eq!(
        requests(|| live_with_every_integrator(coin, ground, friction)),
        0
    );
}

#[test]
fn no_users_body_ground_or_friction_makes_a_step_ask_for_memory() {
    let (ball, turf, oil) = (
        Ball::new(1.0, 0.5),
        Turf {
            stiffness: 1e4,
            stiffening: 1e6,
            damping: 1e3,
        },
        Viscous { drag: 0.5 },
    );
    assert_eq!(requests(|| live_with_every_integrator(ball, turf, oil)), 0);
    let (ball, turf, oil): (
        &dyn RigidPointBody,
        &dyn SpringDamperGround,
        &dyn SlidingFriction,
    ) = (&ball, &turf, &oil);
    assert_eq!(requests(|| live_with_every_integrator(ball, turf, oil)), 0);
}

#[test]
fn several_surfaces_make_no_step_ask_for_memory() {
    let turf = Turf {
        stiffness: 1e4,
        stiffening: 1e6,
        damping: 1e3,
    };
    let wall = FlatGround::level(1e3, 0.5).on(Plane::through(DVec3::X, -DVec3::X));
    let (body, ground) = (Coin::ring(1.0, 0.5), (turf, wall));
    let laws = (
        Viscous { drag: 0.5 },
        Coulomb {
            coefficient: 0.3,
            slip_speed: 1e-3,
        },
    );
    assert_eq!(
        requests(|| live_with_every_integrator(body, ground, laws)),
        0
    );
}
