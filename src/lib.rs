#![no_std]
#![cfg_attr(docsrs, feature(doc_cfg))]
//! One rigid body made of points that spins, slides, rolls, bounces and tumbles on a spring-damper
//! ground with sliding friction.
//!
//! Compose a [`Stepper`] from a body, a ground, a friction law, gravity and an integrator, and move
//! a [`State`] on in time:
//!
//! ```
//! use tumble::glam::DVec3;
//! use tumble::{Coin, Coulomb, FlatGround, State, Stepper, UniformGravity};
//!
//! let stepper = Stepper::new(Coin::ring(1.0, 0.5))? // kg, m
//!     .with_gravity(UniformGravity::down(9.8))? // m/s²
//!     .with_ground(FlatGround::level(1000.0, 0.5))? // N/m and N s/m, for each point
//!     .with_friction(Coulomb { coefficient: 0.3, slip_speed: 1e-3 })?; // -, m/s
//! let mut state = State::at(DVec3::Z) // m
//!     .with_angular_momentum(DVec3::new(0.3, 1.0, 0.2)); // kg m²/s
//! let before = stepper.energy(&state).total();
//! stepper.advance(&mut state, 2.0)?; // s
//! assert!(stepper.energy(&state).total() < before);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The integrator is [`EnergyMomentum`] with steps of 1 ms unless another is named. What a scene
//! does not name costs nothing.
//!
//! # Start here
//!
//! - To see something first: `cargo run --release --example coin` in the repository; the
//!   [gallery](guide::gallery) has the others.
//! - To study a motion: [`guide::choosing`] names integrator and step for an error, [`Ledger`]
//!   audits the energy, [`work_precision`](mod@work_precision) measures the error on your scene,
//!   [`Timed`] samples it.
//! - To throw dice and coins in a game: [`guide::game`] goes from the throw to the face that is up.
//!   A [`Session`] keeps a state with its clock, and a body at rest in it costs next to nothing.
//! - To add a body, a ground, a friction law or an integrator: [`guide::extending`].
//! - Where the compiler cannot tell `f64` from `f32`, as in `Ledger::new()` alone, take the names
//!   from [`mod@f64`]: `use tumble::f64::*;`.
//!
//! *The coin report* is the text that the crate began with: a ring of 120 points on a springy
//! floor, set rolling or spinning in eight ways, [`Trial`]s 1 to 8.
//!
//! # What is modelled
//!
//! - One rigid body with its full inertia tensor, from a single point to ten thousand; a contact is
//!   a point of it, or a small ball ([`ContactPoint`]). Gyroscopic motion is always right, and
//!   exact in flight for a body with two equal moments.
//! - A ground of springs and dampers under each contact, that never pulls. [`FlatGround`] is a
//!   plane at any height and tilt. [`Ground`] joins a choice of laws ([`ContactLaw`]) and a choice
//!   of shapes ([`Shape`]), among them hills and valleys ([`Terrain`]). Or take your own.
//! - Sliding friction at each contact: Coulomb's law, made finite at zero slip ([`Coulomb`],
//!   [`SmoothCoulomb`]), with a static and a kinetic coefficient ([`Stribeck`]), a coefficient that
//!   falls with the load ([`LoadDependentCoulomb`]), or two directions ([`AnisotropicCoulomb`]);
//!   [`Viscous`]; or your own. Beside any of them, resistance to rolling and spinning
//!   ([`WithResistance`]).
//! - Bodies: rings of points ([`Coin`]), solids ([bodies](body#bodies)), and anything put together
//!   from solids and points ([`Solid`], [`MassProperties`], [`PointCloud`]).
//! - The energy by kind ([`Energy`]) and the energy audit of a run ([`Ledger`]).
//!
//! # What is not
//!
//! - Several bodies, joints, motors, air, a ground that moves or keeps a dent.
//! - Sticking: on a slope of angle θ a body creeps at `slip_speed · tan θ/(coefficient - tan θ)`.
//!   With 1e-10 m/s that is a millimetre in four months.
//! - A coefficient of restitution: bounces follow from spring and damper. Laws can be made for a
//!   bounce ([`SpringDamper::from_bounce`], [`HuntCrossley::from_bounce`]).
//! - Two round rims on one body. A [`Coin`] of n points is a polygon, out of round by
//!   `r (1 - cos(π/n))`, 0.17 mm for 120 points on 0.5 m; a [`Disc`] is round, as spheres, capsules
//!   and [`Ellipsoid`]s are.
//!
//! # Units, frames, signs
//!
//! - SI units, angles in radians.
//! - World axes are right-handed with z up. Velocity, angular momentum (about the centre of mass),
//!   forces and torques are in world axes.
//! - Body axes have the centre of mass as their origin and need not be principal axes.
//!   `orientation` turns body axes to world axes.
//! - A *gap* is above 0 outside the ground, a *depth* inside it. A *closing speed* is above 0 while
//!   the depth grows. A ground's normal points out of it.
//! - Work on the body is above 0 where it gains energy, so friction's is below.
//!
//! # Promises
//!
//! | | promise | shown by |
//! |---|---|---|
//! | G1 | With [`EnergyMomentum`] the computed energy never increases, not even by one unit in the last place, at any step size, stiffness, damping, friction, spin, size, shape and precision. | `tests/contract.rs` (random scenes), `tests/extremes.rs` (a sweep of the extremes), [derivation](guide::energy) |
//! | G2 | The body stays rigid: distances and the orientation's length stay at rounding, however long the run. | `tests/rigidity.rs`, up to 10⁷ steps |
//! | G3 | The energy audit adds up: energy now is energy at the start less what friction, dampers and separation took, plus the energy error. The energy error is the integrator's own. It falls at the integrator's order, through touch-downs too, and with the tolerance of an adaptive method. | `tests/truth.rs`, against the true works of all eight trials |
//! | G4 | Accuracy is a number: each integrator states order, cost, stability limit, and when it can add energy. | `tests/truth.rs`, `tests/energy.rs` (both sides of each limit), `examples/accuracy`, [tables](guide::accuracy); `tests/validation`, [closed forms and printed numbers](guide::validation) |
//! | G5 | A scene pays for what it names: what it does not name costs nothing, flight visits no contact, and rest in a [`Session`] costs a comparison. | `benches/` |
//! | G6 | No standard library, no allocation, no panic. | `.ci/no_std.sh` (linked with nothing to panic with), `.ci/embedded.sh` (no panic in the image of a microcontroller), `tests/downstream/tests/no_allocation.rs` |
//! | G7 | Same input, same bits, on every machine that follows IEEE 754: `+ - * /` and square root in one order, all else from `libm` or, for `f32`, from the crate, no fused operations. | [`real`], by construction; `tests/bits.rs`, stored hashes of every integrator and law, on any machine and profile; `.ci/targets.sh`, the same hashes on other processors; `tests/symmetry.rs` |
//! | G8 | Invalid input returns a typed error that names quantity, rule and value. A step that cannot go on, or a law that breaks its contract, keeps the last valid state. | `tests/bad_input.rs`, a test a parameter |
//! | G9 | [`State`] is plain data: a run from a saved and loaded state has the same bits, and so has a saved [`Session`] that is resumed. | `tests/symmetry.rs` |
//! | G10 | Your own body, ground, friction law or integrator is as good as a built-in one, and can be checked. | `tests/downstream`, `tests/contract.rs` |
//!
//! # Integrators
//!
//! | | order | evaluations a step | keeps | may add energy | stable for |
//! |---|---|---|---|---|---|
//! | [`EnergyMomentum`] | 2 | 2 to 6 in contact, none in flight | energy, where nothing takes it | never | every step |
//! | [`StrangSplitting`] | 2, and 1 through touch-downs | 2 in contact, 1 in flight | energy without drift; flight exactly | O(dt²) | `dt < 2/ω` and `dt < 2/δ` |
//! | [`SymplecticEuler`] | 1 | 1 | energy without drift; rotation in flight exactly | O(dt) | `dt < 2 (√(1+ζ²) - ζ)/ω` |
//! | [`Rk4`] | 4, and 1 through touch-downs | 4 | nothing more | O(dt⁵) a step | `dt < 2.62/ω` and `dt < 2.78/δ`; `dt < 2.83/ω` without dampers |
//! | [`Nystrom`] | 4, and 2 through touch-downs | 4 | nothing more | O(dt⁶) a step | `dt < 2.36/ω` and `dt < 2.78/δ`, with `ζ > 2.1e-4 (ω dt)⁵` |
//! | [`BogackiShampine32`] | 3 | 3 | nothing more | by its error | chooses its steps for a tolerance |
//! | [`DormandPrince54`] | 5 | 6 | nothing more | by its error | chooses its steps for a tolerance |
//! | [`ForwardEuler`] | 1 | 1 | nothing more | in every step | `dt < 2 ζ/ω`, and `ζ < 1` |
//!
//! `ω` (rad/s) and `δ` (1/s) are the highest frequency and the highest rate of damping that the
//! contacts give the body, and `ζ = δ/2ω`. A contact at arm `r` with normal `n` feels the mass `M`,
//! with `1/M = 1/m + (r × n) · J⁻¹ (r × n)`. One contact has `ω² = k/M` and `δ = c/M`. Contacts
//! that act together add up. In stick, friction is a damper of `μ N/slip_speed` along the surface.
//! [`Stepper::largest_stable_step`] computes the limit at a state. All keep the angular momentum in
//! flight.
//!
//! The order holds in smooth motion. Through touch-downs it is what [`guide::accuracy`] measures on
//! all eight trials.
//!
//! - `EnergyMomentum` where a body must come to rest, at long steps and for stiff ground;
//! - `StrangSplitting` where sliding and flight are to be cheap;
//! - `Nystrom` for a tenth of a millimetre and less where a body rolls and slides;
//! - `DormandPrince54` for a tolerance instead of a step;
//! - the others as references. Each can have its flight in closed form ([`Flight`]);
//! - [`AnyIntegrator`] to choose one at run time.
//!
//! [`guide::choosing`] starts from the problem, [`guide::accuracy`] goes through the extremes.
//!
//! # Your own parts
//!
//! - [a body](guide::extending::body): [`RigidPointBody`], [`contract::check_body`]
//! - [a ground](guide::extending::ground): [`SpringDamperGround`], [`contract::check_ground`]
//! - [a friction law](guide::extending::friction): [`SlidingFriction`],
//!   [`contract::check_friction`]
//! - [an integrator](guide::extending::integrator): [`Integrator`], [`contract::check_integrator`],
//!   [`contract::check_energy_never_rises`]
//! - [an observer](guide::extending::observer): [`Observer`]; a closure is one
//!
//! [`guide::extending`] has a page for each: what to implement, what is provided, what the check
//! tests, and a whole example; `tests/downstream` in the repository is a crate with one of each.
//! Parts are taken by value, by reference, behind `&dyn` or in a `Box<dyn …>`. Every type has the
//! number as a parameter ([`Real`]: `f64` where nothing else is said, or `f32`); the modules
//! [`mod@f64`] and [`mod@f32`] name everything for one of them.
//!
//! # Features
//!
//! | feature | |
//! |---|---|
//! | `std` (default) | the standard library for the dependencies and the square root, parts in boxes, [`work_precision`](mod@work_precision); changes no bit of any result |
//! | `approx-05` | comparison of states by `approx` 0.5 |
//! | `serde` | states, sessions, parameters, laws, and bodies but `PointCloud` and `Solid` can be saved and loaded |
//! | `mint` | glam's conversions from and to `mint` |

#[cfg(any(test, feature = "std"))]
extern crate std;

#[cfg(feature = "std")]
extern crate alloc;

pub use glam;

mod aliases;
pub mod body;
pub mod contract;
pub mod energy;
pub mod error;
pub mod friction;
pub mod gravity;
pub mod ground;
pub mod integrator;
pub mod observer;
pub mod outcome;
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
    SolidCoin, Sphere,
};
pub use energy::{Dissipation, Energy, EnergyRates};
pub use error::{SceneError, StepError};
pub use friction::{
    AnisotropicCoulomb, Coulomb, FrictionJacobian, Frictionless, LoadDependentCoulomb,
    RollingResistance, SlidingFriction, SmoothCoulomb, Stribeck, Viscous, WithResistance,
};
pub use gravity::{Gravity, NoGravity, UniformGravity};
pub use ground::{
    Bowl, Carried, ContactLaw, Elevation, FlatGround, Ground, GroundBounds, HeightField,
    HuntCrossley, LimitedDamper, MeanForce, NoGround, Plane, Ramp, Shape, SpringDamper,
    SpringDamperGround, Surface, Terrain, Waves,
};
pub use integrator::{
    AnyIntegrator, BogackiShampine32, DormandPrince54, EnergyMomentum, Flight, ForwardEuler,
    Integrator, Nystrom, Rk4, Step, StepControl, StrangSplitting, SymplecticEuler,
};
pub use observer::{Every, Ledger, Observer, Sample, SceneQuery, Timed, UntilDecided, UntilRest};
pub use outcome::{Barriers, Basin, Faces, HullFace, Outcome};
pub use real::Real;
pub use rotation::Rotation;
pub use scene::{Contact, Dynamics, Load, LowestPoint, Motion, Rates, Scene};
pub use session::{Moment, SavedSession, Session};
pub use state::State;
pub use stepper::Stepper;
pub use trial::{Start, Trial};

/// Chapters, from the question to the page:
///
/// - Which integrator, which step? [`choosing`](guide::choosing)
/// - How do I throw dice and coins in a game? [`game`](guide::game)
/// - When is heads or tails decided, and how sure is a count? [`outcomes`](guide::outcomes)
/// - How accurate is a run at the extremes, and where is it only stable?
///   [`accuracy`](guide::accuracy)
/// - How do I add a body, a ground, a friction law, an integrator, an observer?
///   [`extending`](guide::extending)
/// - Why can the energy not rise? [`energy`](guide::energy)
/// - Does the model get right what is known? [`validation`](guide::validation), and beside a real
///   cube: [`measured`](guide::measured)
/// - What do other libraries do with the same scenes? [`peers`](guide::peers)
/// - Which examples are there, and what do they show? [`gallery`](guide::gallery)
pub mod guide {
    #[doc = include_str!("guide/energy.md")]
    pub mod energy {}

    #[doc = include_str!("guide/accuracy.md")]
    pub mod accuracy {}

    #[doc = include_str!("guide/choosing.md")]
    #[doc = ""]
    #[doc = include_str!("../assets/work_precision.svg")]
    pub mod choosing {}

    #[doc = include_str!("guide/game.md")]
    pub mod game {}

    #[doc = include_str!("guide/outcomes.md")]
    pub mod outcomes {}

    #[doc = include_str!("guide/peers.md")]
    pub mod peers {}

    #[doc = include_str!("guide/gallery.md")]
    pub mod gallery {}

    #[doc = include_str!("guide/measured.md")]
    pub mod measured {}

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

        #[doc = include_str!("guide/extending/integrator.md")]
        pub mod integrator {}

        #[doc = include_str!("guide/extending/observer.md")]
        pub mod observer {}
    }
}

/// The code of the README is compiled and run with the documentation's.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
