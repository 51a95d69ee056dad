#![no_std]
#![cfg_attr(docsrs, feature(doc_cfg))]
//! One rigid body made of points that spins, slides, rolls, bounces and tumbles on a spring-damper ground with sliding friction.

#[cfg(any(test, feature = "std"))]
extern crate std;

pub use glam;

pub mod body;
pub mod contract;
pub mod energy;
pub mod error;
pub mod friction;
pub mod gravity;
pub mod ground;
pub mod integrator;
pub mod observer;
pub mod real;
pub mod rotation;
pub mod scene;
pub mod state;
pub mod stepper;
pub mod trial;

pub use body::{Coin, ContactPoint, Face, MassProperties, PointCloud, RigidPointBody, Run};
pub use energy::{Account, Dissipation, Energy};
pub use error::{SceneError, StepError};
pub use friction::{Coulomb, Drag, Frictionless, SlidingFriction, SmoothCoulomb};
pub use gravity::{Gravity, NoGravity, UniformGravity};
pub use ground::{Extent, FlatGround, MeanForce, NoGround, Plane, SpringDamperGround, Surface};
pub use integrator::{
    EnergyMomentum, ForwardEuler, Integrator, Rk4, Step, StrangSplitting, SymplecticEuler,
};
pub use observer::{Every, Ledger, Observer, Probe, Sample};
pub use real::Real;
pub use rotation::Rotation;
pub use scene::{Contact, Dynamics, Load, LowestPoint, Motion, Rates, Scene};
pub use state::State;
pub use stepper::Stepper;
pub use trial::{Start, Trial};
