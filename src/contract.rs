//! Checks that an author runs on his own body, ground, friction law or integrator, in his own
//! tests.
//!
//! The traits say what they ask of an implementer in words; these functions ask it in numbers. Each
//! tries a fixed battery of inputs, extremes first, and then as many random ones as a [`CheckPlan`]
//! says, and returns the first [`Violation`]: the [`Requirement`] that is broken, the input that
//! breaks it, and both numbers. Nothing is allocated and nothing panics, so that they also run on
//! the target.
//!
//! ```
//! use tumble::contract::{CheckPlan, Requirement, GroundRange, check_ground};
//! use tumble::glam::DVec3;
//! use tumble::{SpringDamperGround, Surface};
//!
//! /// A spring and damper that forgets to let go.
//! struct Glue;
//!
//! impl SpringDamperGround for Glue {
//!     fn surface(&self, point: DVec3) -> Surface {
//!         Surface { gap: point.z, normal: DVec3::Z }
//!     }
//!     fn spring_force(&self, depth: f64) -> f64 {
//!         1e3 * depth
//!     }
//!     fn spring_energy(&self, depth: f64) -> f64 {
//!         5e2 * depth * depth
//!     }
//!     fn normal_force(&self, depth: f64, closing_speed: f64) -> f64 {
//!         1e3 * depth + 2.0 * closing_speed
//!     }
//! }
//!
//! let range = GroundRange { centre: DVec3::ZERO, size: 1.0, depth: 0.05, speed: 3.0 };
//! let violation = check_ground(&Glue, &range, CheckPlan::default()).unwrap_err();
//! assert_eq!(violation.requirement, Requirement::NeverPulls);
//! println!("{violation}");
//! ```
//!
//! | check | what it asks |
//! |---|---|
//! | [`check_body`] | mass and inertia that a body can have; contacts, reach and [`contacts_below`](crate::RigidPointBody::contacts_below) that fit each other and never change |
//! | [`check_ground`] | a surface whose gap falls along its normal; a force that never pulls; springs that give back what they took; dampers that only take; a mean force and an extent that agree with them |
//! | [`check_friction`] | a force along the surface that opposes the slip, and a drag that fits it |
//! | [`check_integrator`] | steps that keep to their limit, land on it, have the same bits each time, keep the orientation's length, and converge at the stated order |
//! | [`check_energy_never_rises`] | that the computed energy never rises: only [`EnergyMomentum`](crate::EnergyMomentum) among the built-in integrators passes |

mod body;
mod friction;
mod ground;
mod integrator;
mod plan;
mod scenes;

pub use body::check_body;
pub use friction::{FrictionRange, check_friction};
pub use ground::{GroundRange, check_ground};
pub use integrator::{check_energy_never_rises, check_integrator};
pub use plan::CheckPlan;

use core::fmt;

use glam::DVec3;

use crate::error::{Rule, SceneError, StepError};
use crate::real::{Real, Vector};

/// A clause of a trait's contract that an implementation breaks, and the input that shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Violation {
    /// What is broken.
    pub requirement: Requirement,
    /// With what input.
    pub input: Input,
    /// The offending value, in the SI unit of what the clause speaks of.
    pub value: f64,
    /// What the clause allows there, rounding included.
    pub bound: f64,
}

impl core::error::Error for Violation {}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            requirement,
            input,
            value,
            bound,
        } = self;
        write!(f, "{requirement}: got {value:e}")?;
        // A rule of scenes names its own bound, but for a sum that only the body knows; what is not
        // a number has none.
        let names_bound = match requirement {
            Requirement::Composes { rule, .. } => *rule != Rule::TriangleInequality,
            Requirement::Finite | Requirement::Steps(_) => true,
            _ => false,
        };
        if !names_bound {
            write!(f, ", the bound is {bound:e}")?;
        }
        write!(f, "; {input}")
    }
}

/// What a contract asks.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Requirement {
    /// The implementation's own check passes, and a scene can be composed with it.
    Composes {
        /// What is wrong, in words: "mass".
        quantity: &'static str,
        /// The rule of scenes that it breaks.
        rule: Rule,
    },
    /// Every number is finite.
    Finite,

    /// Body: mass, inertia, contacts, reach and `contacts_below` are the same whenever they are
    /// asked for.
    Rigid,
    /// Body: no contact's surface lies beyond the reach.
    Reach,
    /// Body: `contacts_below` misses no contact, and `contacts_below_near` answers alike whatever
    /// is known.
    ContactsBelow,
    /// Smooth body: it has one contact; `support_point` is a place within reach, and none other
    /// that it tells is farther in that direction.
    Support,

    /// Ground: the normal has length 1.
    UnitNormal,
    /// Ground: the gap changes by `normal · path` from place to place.
    GapAlongNormal,
    /// Ground: what `extent` says is so.
    GroundBounds,
    /// Ground: the spring force is at least 0.
    SpringPushes,
    /// Ground: the springs' energy is at least 0 and does not fall with depth.
    SpringEnergyRises,
    /// Ground: the springs' energy is the integral of their force.
    EnergyIsIntegral,
    /// Ground: the normal force is at least 0.
    NeverPulls,
    /// Ground: `(normal_force - spring_force) · closing_speed >= 0`.
    DamperTakes,
    /// Ground: force, slope, stiffness and damping of the mean force are at least 0.
    MeanForceSigns,
    /// Ground: the mean force is 0 on a path above the ground.
    MeanForceAbove,
    /// Ground: the mean force takes at least what the springs store, and gives at most what they
    /// stored.
    MeanForceTakes,
    /// Ground: the mean force is the mean of the normal force along the path.
    MeanForceIsMean,

    /// Friction: `force · slip <= 0`.
    Opposes,
    /// Friction: the force lies in the surface.
    InSurface,
    /// Friction: without load there is no force.
    NoLoadNoForce,
    /// Friction: without slip there is no force.
    NoSlipNoForce,
    /// Friction: `turning` is always there or never, with torques of at least 0 and a turn speed
    /// above 0.
    TurningOpposes,
    /// Friction: `drag` has a coefficient of `|force|/|slip|`, a width above 0, and a growth
    /// between 0 and 1.
    DragFits,

    /// Integrator: a step of a tame scene succeeds.
    Steps(StepError),
    /// Integrator: a step takes more than 0 s.
    TakesTime,
    /// Integrator: a step takes at most the limit.
    KeepsToLimit,
    /// Integrator: steps towards a moment arrive at it.
    LandsOnLimit,
    /// Integrator: the time that a step tells is the time that it has moved the state by.
    TellsTime,
    /// Integrator: the same input gives the same bits.
    SameBits,
    /// Integrator: what the workspace holds changes no bit.
    WorkspaceChangesNothing,
    /// Integrator: the orientation has length 1 after a step.
    UnitOrientation,
    /// Integrator: the error falls with the step at the stated order, to 0.3.
    Order,
    /// Integrator: the computed energy after a step is not above the one before.
    EnergyNeverRises,
}

impl fmt::Display for Requirement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Composes { quantity, rule } => {
                return write!(f, "a scene must be possible: {quantity} {rule}");
            }
            Self::Steps(error) => return write!(f, "a tame step must succeed ({error})"),
            Self::Finite => "every number must be finite",
            Self::Rigid => "a rigid body must answer alike whenever it is asked",
            Self::Reach => "no contact may lie beyond the reach",
            Self::ContactsBelow => "contacts_below must not miss a contact, and contacts_below_near must answer alike",
            Self::Support => {
                "support_point must be the farthest place of one contact, within reach"
            }
            Self::UnitNormal => "the surface's normal must have length 1",
            Self::GapAlongNormal => {
                "the gap must change by normal · path, as a distance does; a height z = h(x, y) makes a Terrain"
            }
            Self::GroundBounds => "the extent must be true of the surface",
            Self::SpringPushes => "the spring force must be at least 0, rounding included",
            Self::SpringEnergyRises => "the springs' energy must be at least 0 and rise with depth",
            Self::EnergyIsIntegral => {
                "the springs' energy must be the integral of the spring force"
            }
            Self::NeverPulls => "the ground must not pull, not even by rounding",
            Self::DamperTakes => "the damper must take energy",
            Self::MeanForceSigns => "the mean force and its slopes must be at least 0",
            Self::MeanForceAbove => "the mean force must be 0 above the ground",
            Self::MeanForceTakes => "the mean force must not give back more than the springs",
            Self::MeanForceIsMean => "the mean force must be the mean of the normal force",
            Self::Opposes => "friction must oppose the slip",
            Self::InSurface => "friction must lie in the surface",
            Self::NoLoadNoForce => "friction must be 0 without load",
            Self::NoSlipNoForce => "friction must be 0 without slip",
            Self::TurningOpposes => {
                "resistance to turning must be always there or never, and not below 0"
            }
            Self::DragFits => "the drag must fit the force",
            Self::TakesTime => "a step must take more than 0 s",
            Self::KeepsToLimit => "a step must keep to its limit",
            Self::LandsOnLimit => "steps towards a moment must arrive at it",
            Self::TellsTime => "a step must take the time that it tells",
            Self::SameBits => "the same input must give the same bits",
            Self::WorkspaceChangesNothing => "the workspace must not change a result",
            Self::UnitOrientation => "the orientation must have length 1 after a step",
            Self::Order => {
                "half the step must divide the error by at least 2^(order - 0.3)"
            }
            Self::EnergyNeverRises => "the energy must not rise",
        })
    }
}

/// With what input a clause is broken. SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Input {
    /// None: the implementation as it is.
    AsItIs,
    /// A contact of the body.
    Contact {
        /// Its number.
        index: usize,
    },
    /// A half-space below which contacts were asked for, and one of them.
    Below {
        /// Normal of its plane, body axes.
        normal: DVec3,
        /// Distance of its plane from the centre of mass along the normal, m.
        offset: f64,
        /// Number of the contact.
        index: usize,
    },
    /// A place in the world.
    Place {
        /// m, world axes.
        point: DVec3,
    },
    /// The way from one place to another.
    Way {
        /// m, world axes.
        from: DVec3,
        /// m, world axes.
        to: DVec3,
    },
    /// A range of depths from the surface's or a place's.
    Depths {
        /// m.
        from: f64,
        /// m.
        to: f64,
    },
    /// A contact in the ground.
    Press {
        /// m.
        depth: f64,
        /// m/s.
        closing_speed: f64,
    },
    /// The even path of a contact over a step.
    Path {
        /// Depth at the start, m.
        start: f64,
        /// Depth at the end, m.
        end: f64,
        /// s.
        seconds: f64,
    },
    /// A contact that slides.
    Slide {
        /// N.
        normal_force: f64,
        /// m/s.
        slip: DVec3,
    },
    /// A step of one of the battery's scenes.
    Step {
        /// The scene, in words.
        scene: &'static str,
        /// Its number in the battery.
        case: u32,
        /// Number of the step.
        step: u32,
        /// s.
        limit: f64,
    },
}

impl fmt::Display for Input {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AsItIs => f.write_str("whatever the input"),
            Self::Contact { index } => write!(f, "at contact {index}"),
            Self::Below {
                normal,
                offset,
                index,
            } => {
                write!(
                    f,
                    "at contact {index} below the plane {normal} · p = {offset:e} m"
                )
            }
            Self::Place { point } => write!(f, "at the place {point} m"),
            Self::Way { from, to } => write!(f, "on the way from {from} m to {to} m"),
            Self::Depths { from, to } => write!(f, "from depth {from:e} m to {to:e} m"),
            Self::Press {
                depth,
                closing_speed,
            } => {
                write!(
                    f,
                    "at depth {depth:e} m and closing speed {closing_speed:e} m/s"
                )
            }
            Self::Path {
                start,
                end,
                seconds,
            } => {
                write!(
                    f,
                    "from depth {start:e} m to {end:e} m within {seconds:e} s"
                )
            }
            Self::Slide { normal_force, slip } => {
                write!(f, "under {normal_force:e} N at a slip of {slip} m/s")
            }
            Self::Step {
                scene,
                case,
                step,
                limit,
            } => {
                write!(
                    f,
                    "{scene} (case {case}), step {step} with a limit of {limit:e} s"
                )
            }
        }
    }
}

/// `Ok` where a clause holds, else its breach.
fn demand<R: Real>(
    holds: bool,
    requirement: Requirement,
    value: R,
    bound: R,
    input: impl FnOnce() -> Input,
) -> Result<(), Violation> {
    if holds {
        Ok(())
    } else {
        Err(Violation {
            requirement,
            input: input(),
            value: value.to_f64(),
            bound: bound.to_f64(),
        })
    }
}

/// That a number is finite.
fn demand_finite<R: Real>(value: R, input: impl FnOnce() -> Input) -> Result<(), Violation> {
    demand(value.is_finite(), Requirement::Finite, value, R::MAX, input)
}

/// That a number is at least what rounding leaves of 0.
fn demand_at_least<R: Real>(
    value: R,
    bound: R,
    requirement: Requirement,
    input: impl FnOnce() -> Input,
) -> Result<(), Violation> {
    demand(value >= bound, requirement, value, bound, input)
}

/// That a number is at most a bound.
fn demand_at_most<R: Real>(
    value: R,
    bound: R,
    requirement: Requirement,
    input: impl FnOnce() -> Input,
) -> Result<(), Violation> {
    demand(value <= bound, requirement, value, bound, input)
}

/// A scene that cannot be composed.
fn cannot_be(error: SceneError) -> Violation {
    Violation {
        requirement: Requirement::Composes {
            quantity: error.quantity,
            rule: error.rule,
        },
        input: Input::AsItIs,
        value: error.value,
        bound: match error.rule {
            Rule::AboveZeroToOne | Rule::UnitLength => 1.0,
            Rule::AtLeast(least) => f64::from(least),
            Rule::AtMost(count) | Rule::Exactly(count) => f64::from_usize(count),
            Rule::Finite => f64::MAX,
            _ => 0.0,
        },
    }
}

/// `count` units in the last place of 1.
fn ulps<R: Real>(count: f64) -> R {
    R::EPSILON * R::from_f64(count)
}

/// A vector for a message.
fn wide<R: Real>(vector: R::Vec3) -> DVec3 {
    DVec3::new(
        vector.x().to_f64(),
        vector.y().to_f64(),
        vector.z().to_f64(),
    )
}
