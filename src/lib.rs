#![no_std]
#![cfg_attr(docsrs, feature(doc_cfg))]
#![warn(clippy::too_many_lines)]
//! One rigid body that spins, slides, rolls, bounces and tumbles on a spring-damper ground with
//! sliding friction.
//!
//! Compose a [`Stepper`] from a body, a ground, a friction law, gravity and an integrator. It
//! advances a [`State`] in time:
//!
//! ```
//! use tumble::glam::DVec3;
//! use tumble::{Coin, Coulomb, FlatGround, State, Stepper, UniformGravity};
//!
//! let stepper = Stepper::builder(Coin::ring(1.0, 0.5)) // kg, m
//!     .gravity(UniformGravity::down(9.8)) // m/s²
//!     .ground(FlatGround::level(1000.0, 0.5)) // N/m and N s/m, for each point
//!     .friction(Coulomb { coefficient: 0.3, slip_speed: 1e-3 }) // -, m/s
//!     .build()?;
//! let mut state = State::at(DVec3::Z) // m
//!     .with_angular_momentum(DVec3::new(0.3, 1.0, 0.2)); // kg m²/s
//! let before = stepper.energy(&state).total();
//! stepper.advance(&mut state, 2.0)?; // s
//! assert!(stepper.energy(&state).total() < before);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The default integrator is [`EnergyMomentum`] with a step size of 1 ms. A part that is not added
//! to the scene costs nothing.
//!
//! # Start here
//!
//! | you want to | start with |
//! |---|---|
//! | see a motion first | `cargo run --release --example coin` in the repository; the [gallery](guide::gallery) lists the other examples |
//! | choose integrator and step size for an error | [`guide::choosing`] |
//! | measure the error on your scene | [`work_precision`](mod@work_precision) |
//! | audit the energy of a run | [`Ledger`] |
//! | sample a run at equal intervals of time | [`Timed`] |
//! | sample a state within a step | [`Session::dense_step`] |
//! | compute the orientation of a free body at any time | [`FreeRotation`] |
//! | know which parts a scene needs, and what they cost | [`guide::modelling`] |
//! | find the moment of a touch-down, an apex, the end of a slip or an event of your own | [`guide::events`], [`Event`], [`Session::run_until_event`] |
//! | throw dice and coins in a game | [`guide::game`] |
//! | know on which face a body ends, or toss it a million times | [`guide::outcomes`] |
//! | advance one state by many calls, at almost no cost while the body is at rest | [`Session`] |
//! | advance many states of one scene, faster than one by one | [`Stepper::advance_many`] |
//! | add a body, a ground, a friction law or an integrator | [`guide::extending`] |
//! | know what a new release may change: names, bits, saved data | [`guide::versions`] |
//!
//! If the compiler cannot infer the precision, as in `Ledger::new()` alone, use the names of
//! [`mod@f64`]: `use tumble::f64::*;`.
//!
//! *The coin report* is the text from which the crate was developed. It describes a ring of 120
//! points on an elastic floor, which starts to roll or to spin in eight [`Trial`]s.
//!
//! # What is modelled
//!
//! - One rigid body with its full inertia tensor and with any number of contacts. A contact
//!   is a point of the body with a radius, which may be 0 ([`ContactPoint`]): a ball is one
//!   contact, a capsule two. Gyroscopic motion is included. In flight it is exact to rounding for
//!   any moments of inertia with [`EnergyMomentum`] and other methods (see [below](#integrators)).
//! - A ground with a spring and a damper under each contact, which never pulls. [`FlatGround`] is a
//!   plane at any height and tilt. [`Ground`] combines a law ([`ContactLaw`]) with a shape
//!   ([`Shape`]), for example hills and valleys ([`Terrain`]). You can implement your own. Its
//!   material may move along its surface ([`MovingGround`]): a conveyor, a turntable. A tuple or an
//!   array of grounds is a ground of [several surfaces](SpringDamperGround#several-surfaces): a
//!   tray, a groove, a table with an edge ([`Block`]).
//! - Sliding friction at each contact, with a law from the [list of laws](SlidingFriction) or your
//!   own. Coulomb's law is finite at zero slip ([`Coulomb`], [`SmoothCoulomb`]). Other laws have a
//!   static and a kinetic coefficient ([`Stribeck`]), a coefficient that decreases with the load
//!   ([`LoadDependentCoulomb`]), or two directions ([`AnisotropicCoulomb`]). [`WithResistance`]
//!   adds resistance to rolling and spinning to any law. The law may vary over the ground
//!   ([`FrictionPatch`], [`FrictionField`]).
//! - An applied force: drag, lift of a spinning ball, wind, a constant force, or your own
//!   ([`Force`]).
//! - Bodies: rings of points ([`Coin`]), solids ([bodies](body#bodies)), and composites of solids
//!   and points ([`Solid`], [`MassProperties`], [`PointCloud`]).
//! - The energy by kind ([`Energy`]) and the energy audit of a run ([`Ledger`]).
//!
//! # What is not modelled
//!
//! - Several bodies or joints. A ground that changes its position, its shape or its velocity: the
//!   velocity of a conveyor or a turntable is constant. Surfaces that move against each other. An
//!   applied force does not depend on time, and has no point of application: it is a force at the
//!   centre of mass and a torque.
//! - Elasticity along the ground: a ball that grips leaves without the reversed spin of a
//!   superball. [`guide::modelling`] has the full list.
//! - Sticking: with [`Coulomb`], a body on a slope of angle θ creeps at
//!   `slip_speed · tan θ/(coefficient - tan θ)`. If `tan θ` is half of the coefficient, this is the
//!   slip speed: at 1e-10 m/s, a millimetre in four months.
//! - A given coefficient of restitution: bounces follow from spring and damper.
//!   [`SpringDamper::from_bounce`] and [`HuntCrossley::from_bounce`] compute the law for a bounce.
//! - A circle by points. A [`Coin`] of n points is a polygon, which deviates from the circle by
//!   `r (1 - cos(π/n))`. This is 0.17 mm for 120 points on 0.5 m. A [`Disc`] and a [`ThickDisc`]
//!   are round, as are spheres, capsules and [`Ellipsoid`]s.
//!
//! # Units, frames, signs
//!
//! - SI units, angles in radians.
//! - World axes are right-handed with z up. Velocity, angular momentum (about the centre of mass),
//!   forces and torques are in world axes.
//! - Body axes have the centre of mass as their origin and need not be principal axes.
//!   `orientation` is the rotation from body axes to world axes.
//! - A *gap* is positive above the ground, a *depth* (penetration depth) below its surface. A
//!   *closing speed* is positive while the depth increases. The normal points out of the ground.
//! - Work on the body is positive if the body gains energy. The work of friction on a ground at
//!   rest is at most 0. Work of a moving ground counts as work of a drive.
//!
//! # Promises
//!
//! | | promise | shown by |
//! |---|---|---|
//! | G1 | With [`EnergyMomentum`], [`CompactEnergyMomentum`] and [`AdaptiveEnergyMomentum`] the computed energy never increases, not even by one unit in the last place, at any step size, stiffness, damping, friction, spin, size, shape and precision. If an applied force or a moving ground drives the body, the energy increases at most by the work that the step states. | `tests/limits/contract.rs` (random scenes), `tests/limits/extremes.rs` (a sweep of the extremes with [`EnergyMomentum`], whose steps the adaptive method takes), `tests/physics/adaptive_energy_momentum.rs`, [derivation](guide::energy) |
//! | G2 | The body stays rigid: distances and the orientation's length stay at rounding, however long the run. | `tests/physics/rigidity.rs`, up to 10⁷ steps; [10⁹ steps](guide::long_runs) |
//! | G3 | The energy audit adds up: the energy equals the energy at the start, plus the works of friction, dampers, clamp and drag, each at most 0, and of drives, plus energy that was handed in between runs, plus the energy error. *Clamp* is the energy that springs lose where a contact separates faster than they expand. The energy error is the integrator's own, within the limits that [`Ledger`] states. It decreases at the integrator's order, through touch-downs too, and with the tolerance of an adaptive method. | `tests/physics/truth.rs`, against the true works of all eight trials |
//! | G4 | Accuracy is a number: each integrator states order, cost, stability limit, and when it can add energy. | `tests/physics/truth.rs`, `tests/physics/energy.rs` (both sides of each limit), `examples/accuracy`, [tables](guide::accuracy); `tests/validation`, [closed forms and printed numbers](guide::validation) |
//! | G5 | A scene has the cost of its parts only: an absent part costs nothing, flight evaluates no contact, and rest in a [`Session`] costs a comparison. | `benches/` |
//! | G6 | No standard library, no allocation, no panic. | `.ci/no_std.sh` (the linked object refers to no panic code), `.ci/embedded.sh` (no panic in the image of a microcontroller), `tests/downstream/tests/no_allocation.rs` |
//! | G7 | Same input, same bits, on every machine that follows IEEE 754: `+ - * /` and square root in one order, other functions from `libm` or, for `f32`, from the crate, and no fused operations. | [`real`], by construction; `tests/downstream/tests/bits.rs`, stored hashes of every integrator and law, on any machine and profile; `.ci/targets.sh`, the same hashes on other processors; `tests/physics/symmetry.rs` |
//! | G8 | Invalid input returns a typed error with the quantity, its rule and its value. If a step fails, or a law breaks its contract, the last valid state is kept. | `tests/limits/bad_input.rs`, one test for each parameter |
//! | G9 | [`State`] is plain data: a run from a saved and loaded state continues with the same bits, if the step size is fixed. With an adaptive method save the [`Session`], which continues with the same bits by every method. Bodies, scenes and settings can be saved, too. | `tests/physics/symmetry.rs`, `tests/parts/bodies.rs` |
//! | G10 | Your own body, ground, friction law, force or integrator is as good as a built-in one, and its contract can be checked. | `tests/downstream`, `tests/limits/contract.rs` |
//! | G11 | A decided outcome is proven: if the energy is below every barrier that leads away from a face, no later motion of the model leaves that face. An outcome that is not decided is reported as undecided. | `tests/physics/outcome.rs` (decided bodies are followed to rest, barriers are compared with a search), the fuzz target `outcome`, [derivation](outcome) |
//! | G12 | An ensemble has one answer: the same seed and range give the same counts for any split over threads, processes and machines, after any interruption. | `tests/ensemble.rs`, `.ci/example.sh` (a killed run is resumed), `.ci/hyperqueue.sh` (workers that are lost) |
//! | G13 | A measured figure in the documentation is written by a command. A check fails if a figure of arithmetic is stale. | `.ci/figures.sh`, the table in `tests/validation`, `.ci/embedded.sh`, `.ci/instructions`, `.ci/floors.py` |
//!
//! # Integrators
//!
//! All integrators conserve the angular momentum in flight. The column *conserves* has what is
//! conserved in addition. [`CompactEnergyMomentum`] has the properties of [`EnergyMomentum`].
//!
//! | | order | force evaluations a step | conserves | may add energy |
//! |---|---|---|---|---|
//! | [`EnergyMomentum`] | 2 | 2 to 5 of twice the cost; 0 in flight | energy, if no loss | never |
//! | [`StrangSplitting`] | 2 (1) | 2, and 1 in flight | energy (no bounces); flight | O(dt²) |
//! | [`SymplecticEuler`] | 1 | 1 | energy (no bounces); rotation in flight | O(dt) |
//! | [`Rk4`] | 4 (1) | 4 | - | O(dt⁵) a step |
//! | [`Nystrom`] | 4 (2) | 4 | - | O(dt⁶) a step |
//! | [`BogackiShampine32`] | 3 | 3 | - | by its error |
//! | [`DormandPrince54`] | 5 | 6 | - | by its error |
//! | [`AdaptiveEnergyMomentum`] | 2 | three times `EnergyMomentum` | as that | never |
//! | [`AdaptiveNystrom`] | 4 (2) | 4 | - | by its error |
//! | [`Radau5`] | 5 | 5 to 30, and 1 in flight | - | by its error |
//! | [`ForwardEuler`] | 1 | 1 | - | in every step |
//!
//! In parentheses is the order through touch-downs. Energy is conserved without drift, flight and
//! rotation exactly.
//!
//! | | stable for |
//! |---|---|
//! | [`EnergyMomentum`] | every step; `dt < 2/ω` on springs of an applied force |
//! | [`StrangSplitting`] | `dt < 2/ω` and `dt < 2/δ` |
//! | [`SymplecticEuler`] | `dt < 2 (√(1+ζ²) - ζ)/ω` |
//! | [`Rk4`] | `dt < 2.61/ω` and `dt < 2.78/δ`; `dt < 2.83/ω` without dampers |
//! | [`Nystrom`] | `dt < 2.36/ω` and `dt < 2.78/δ`, with `ζ > 2.1e-4 (ω dt)⁵` |
//! | [`ForwardEuler`] | `dt < 2 ζ/ω`, and `ζ < 1` |
//! | [`Radau5`] | any tolerance: implicit |
//! | the other adaptive ones | any tolerance: the step size is adaptive |
//!
//! `dt` is the step size (s). `ω` (rad/s) and `δ` (1/s) are the highest frequency and the highest
//! rate of damping that the contacts give the body, and `ζ = δ/(2 ω)`. A contact at arm `r` with
//! normal `n` acts on the effective mass `M`, with `1/M = 1/m + (r × n) · J⁻¹ (r × n)`. Here `m` is
//! the mass of the body and `J` its inertia tensor. One contact with the stiffness `k` and the
//! damping `c` has `ω² = k/M` and `δ = c/M`. Contacts that act together add up. A contact *sticks*
//! while its slip is well below the slip speed. With the normal force `N` and the coefficient of
//! friction `μ`, friction is then a damper of `μ N/slip_speed` along the surface.
//! [`Stepper::largest_stable_step`] computes the limit at a state. All integrators but
//! `ForwardEuler` are exact, to rounding, in the torque-free rotation of a body with three
//! different moments of inertia. With two or three equal moments [`Rk4`] and [`Nystrom`] have the
//! error of their order, unless the moment about the axis of symmetry is the smallest. A method
//! with a tolerance returns an error if it cannot keep it.
//!
//! The order holds in smooth motion. Through touch-downs it can be lower: [`guide::accuracy`] has
//! the orders that were measured on all eight trials.
//!
//! | use | for |
//! |---|---|
//! | `EnergyMomentum` | a body that must come to rest, long steps, stiff ground |
//! | `StrangSplitting` | errors of a centimetre at a low cost |
//! | `Nystrom` | errors of a tenth of a millimetre and less, if a body rolls and slides |
//! | `AdaptiveNystrom` | a tolerance instead of a step size, from a centimetre to a hundredth of a millimetre |
//! | `DormandPrince54` | a smaller tolerance |
//! | `Radau5` | a tolerance in stick or rolling at a small slip speed, or on stiff ground |
//! | `AdaptiveEnergyMomentum` | a tolerance and an energy that never increases; the error of each step |
//! | [`CompactEnergyMomentum`] | `EnergyMomentum` where memory is scarce: a microcontroller, thousands of sessions |
//! | any of them in [`Flight`] | flight in closed form |
//! | [`AnyIntegrator`] | a choice at run time |
//!
//! `Rk4` suits a body with a thousand points at a given error, `BogackiShampine32` suits tosses at
//! a loose tolerance, and `SymplecticEuler` has the least cost of a step. `ForwardEuler` serves as
//! a reference. [`guide::choosing`] starts from the problem, and [`guide::accuracy`] describes the
//! extremes.
//!
//! # Your own parts
//!
//! - [a body](guide::extending::body): [`RigidPointBody`], [`contract::check_body`]
//! - [a ground](guide::extending::ground): [`SpringDamperGround`], [`contract::check_ground`]
//! - [a friction law](guide::extending::friction): [`SlidingFriction`],
//!   [`contract::check_friction`]
//! - [an applied force](guide::extending::force): [`Force`], [`contract::check_force`]
//! - [an integrator](guide::extending::integrator): [`Integrator`], [`contract::check_integrator`],
//!   [`contract::check_energy_never_rises`]
//! - [an observer](guide::extending::observer): [`Observer`], or a closure
//! - an event: [`Event`], or a closure
//!
//! [`guide::extending`] has a page for each role but the event: what to implement, what is
//! provided, what the check tests, and a complete example. `tests/downstream` in the repository is
//! a crate with one part of each role. Parts are taken by value, by reference, behind `&dyn` or in
//! a `Box<dyn …>`. Every type has the number type as a parameter ([`Real`]), `f64` by default or
//! `f32`. The modules [`mod@f64`] and [`mod@f32`] contain the names for one precision. Import names
//! one by one rather than `tumble::*` and `tumble::glam::*` together: both have these modules, and
//! the compiler warns at each `f64`.
//!
//! # Features
//!
//! | feature | effect |
//! |---|---|
//! | `std` (default) | the standard library for the dependencies and the square root, parts in boxes, and [`work_precision`](mod@work_precision); it changes no bit of any result |
//! | `approx-05` | comparison of states by `approx` 0.5 |
//! | `serde` | saves and loads states, sessions, parameters, laws, bodies and whole steppers |
//! | `mint` | glam's conversions from and to `mint` |
//! | `ensemble` | tosses by the million with one answer: the module `ensemble`; brings `std`, `rayon` and `rand_chacha` |

#[cfg(any(test, feature = "std"))]
extern crate std;

#[cfg(feature = "std")]
extern crate alloc;

pub use glam;

mod aliases;
pub mod body;
pub mod contact;
pub mod contract;
pub mod energy;
#[cfg(feature = "ensemble")]
pub mod ensemble;
pub mod error;
pub mod event;
pub mod force;
pub mod free_rotation;
pub mod friction;
pub mod gravity;
pub mod ground;
mod inertia;
pub mod integrator;
pub mod observer;
pub mod outcome;
mod quadrature;
pub mod real;
pub mod rotation;
pub mod scene;
pub mod session;
mod stability;
pub mod state;
pub mod stepper;
pub mod trial;
#[cfg(feature = "std")]
pub mod work_precision;

pub use aliases::{f32, f64};
pub use body::{
    Capsule, Coin, CoinFace, Cone, ContactPoint, ContactRange, Cuboid, CuboidFace, Disc, Ellipsoid,
    InertiaProperties, MassProperties, PointCloud, PointMass, RigidPointBody, Rim, Rod, Solid,
    SolidCoin, Sphere, ThickDisc,
};
pub use contact::{Contact, ContactModel, Load, LowestPoint};
pub use energy::{Dissipation, Energy, EnergyRates};
pub use error::{SceneError, StateError, StepError};
pub use event::{
    Apex, ContactCloses, ContactOpens, Event, EventDirection, EventEnd, EventWith, Landing,
    LiftOff, Occurrence, SlipEnds,
};
pub use force::{
    AirDrag, ConstantForce, Force, ForcePower, NoForce, SpinDrag, SpinLift, Wind, Wrench,
};
pub use free_rotation::FreeRotation;
pub use friction::{
    AnisotropicCoulomb, Coulomb, FrictionField, FrictionJacobian, FrictionPatch, Frictionless,
    LoadDependentCoulomb, Region, RollingResistance, SlidingFriction, SmoothCoulomb, Stribeck,
    Viscous, WithResistance,
};
pub use gravity::{Gravity, NoGravity, UniformGravity};
pub use ground::{
    Block, Bowl, Carried, ContactLaw, Elevation, FlatGround, Ground, GroundBounds, GroundMotion,
    HeightField, HuntCrossley, Impact, LimitedDamper, MeanForce, MovingGround, NoGround, Plane,
    Ramp, Shape, SpringDamper, SpringDamperGround, Surface, Terrain, Waves,
};
pub use integrator::{
    AdaptiveEnergyMomentum, AdaptiveNystrom, AnyIntegrator, BogackiShampine32,
    CompactEnergyMomentum, DormandPrince54, EnergyMomentum, Flight, ForwardEuler, Integrator,
    Nystrom, Radau5, Rk4, Step, StepControl, StrangSplitting, SymplecticEuler,
};
pub use observer::{Every, Ledger, Observer, Sample, SceneQuery, Timed, UntilDecided, UntilRest};
pub use outcome::{Barriers, Basin, Faces, HullFace, Outcome};
pub use real::Real;
pub use rotation::Rotation;
pub use scene::{Dynamics, Rates, Scene};
pub use session::{DenseStep, Moment, SavedSession, Session};
pub use stability::LinearMotion;
pub use state::{Motion, State};
pub use stepper::{Stepper, StepperBuilder};
pub use trial::{Start, Trial};

/// Guide to the crate, with one page for each question.
///
/// - Which integrator, which step? [`choosing`](guide::choosing)
/// - Which parts does my scene need, and what do they cost? [`modelling`](guide::modelling)
/// - When does a body land, how high does it bounce? [`events`](guide::events)
/// - How do I throw dice and coins in a game? [`game`](guide::game)
/// - When is heads or tails decided, and how sure is a count? [`outcomes`](guide::outcomes)
/// - How often does a coin end on its edge? [`edge`](guide::edge)
/// - How accurate is a run at the extremes, and where is it only stable?
///   [`accuracy`](guide::accuracy)
/// - How do I add a body, a ground, a friction law, a force, an integrator, an observer?
///   [`extending`](guide::extending)
/// - Why does the energy never increase? [`energy`](guide::energy). In how many steps was this
///   checked? [`long_runs`](guide::long_runs)
/// - Does the model reproduce known results? [`validation`](guide::validation), and a comparison
///   with a real cube: [`measured`](guide::measured)
/// - How do other libraries perform on the same scenes? [`peers`](guide::peers)
/// - Which examples are there, and what do they show? [`gallery`](guide::gallery)
/// - What may a new release change? [`versions`](guide::versions)
pub mod guide {
    #[doc = include_str!("guide/energy.md")]
    pub mod energy {}

    #[doc = include_str!("guide/accuracy.md")]
    pub mod accuracy {}

    #[doc = include_str!("guide/choosing.md")]
    #[doc = ""]
    #[doc = include_str!("../assets/work_precision.svg")]
    pub mod choosing {}

    #[doc = include_str!("guide/modelling.md")]
    pub mod modelling {}

    #[doc = include_str!("guide/events.md")]
    pub mod events {}

    #[doc = include_str!("guide/game.md")]
    pub mod game {}

    // Its programs need the feature.
    #[cfg_attr(any(feature = "ensemble", not(doctest)), doc = include_str!("guide/outcomes.md"))]
    pub mod outcomes {}

    #[doc = include_str!("guide/edge.md")]
    pub mod edge {}

    #[doc = include_str!("guide/peers.md")]
    pub mod peers {}

    #[doc = include_str!("guide/gallery.md")]
    pub mod gallery {}

    #[doc = include_str!("guide/versions.md")]
    pub mod versions {}

    #[doc = include_str!("guide/measured.md")]
    pub mod measured {}

    #[doc = include_str!("guide/long_runs.md")]
    pub mod long_runs {}

    #[doc = include_str!("guide/validation.md")]
    pub mod validation {}

    #[doc = include_str!("guide/extending.md")]
    pub mod extending {
        #[doc = include_str!("guide/extending/body.md")]
        pub mod body {}

        #[doc = include_str!("guide/extending/ground.md")]
        pub mod ground {}

        #[doc = include_str!("guide/extending/friction.md")]
        pub mod friction {}

        #[doc = include_str!("guide/extending/force.md")]
        pub mod force {}

        #[doc = include_str!("guide/extending/integrator.md")]
        pub mod integrator {}

        #[doc = include_str!("guide/extending/observer.md")]
        pub mod observer {}
    }
}

/// Programs of the README, compiled and run as documentation tests. One needs the feature.
#[cfg(all(doctest, feature = "ensemble"))]
#[doc = include_str!("../README.md")]
struct Readme;
