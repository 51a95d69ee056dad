//! Checks for the user's own implementation of a body, ground, friction law, force or integrator,
//! to be run in the user's tests.
//!
//! The traits state their contracts in words. These functions check the contracts in numbers. Each
//! check tries a fixed set of inputs, extremes first, and then as many random inputs as a
//! [`CheckPlan`] specifies. It returns the first [`Violation`]: the [`Requirement`] that is broken,
//! the input that breaks it, and both numbers. An invalid quantity of a range is a violation too,
//! found before the implementation is evaluated. The checks do not allocate and do not panic, so
//! that they also run on an embedded target.
//!
//! ```
//! use tumble::contract::{CheckPlan, Requirement, GroundRange, check_ground};
//! use tumble::glam::DVec3;
//! use tumble::{SpringDamperGround, Surface};
//!
//! /// A spring and damper that also pulls.
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
//! | check | requirements |
//! |---|---|
//! | [`check_body`] | valid mass and inertia; contacts, bounding radius and [`contacts_below`](crate::RigidPointBody::contacts_below) that are consistent and never change |
//! | [`check_ground`] | a surface whose gap increases along its outward normal, as a distance does; a force that never pulls; springs that return what they stored; dampers that only dissipate; a mean force and bounds that are consistent with them |
//! | [`check_friction`] | a force along the surface that opposes the slip and tends to 0 with it, and a Jacobian that is consistent with it |
//! | [`check_force`] | finite, continuous; a passive force does no positive work; powers that add up |
//! | [`check_integrator`] | steps within their limit; equal bits; order, stability; every role |
//! | [`check_energy_never_rises`] | computed energy that never increases: among the built-in integrators only [`EnergyMomentum`](crate::EnergyMomentum), [`CompactEnergyMomentum`](crate::CompactEnergyMomentum) and [`AdaptiveEnergyMomentum`](crate::AdaptiveEnergyMomentum) pass |

mod body;
mod force;
mod friction;
mod ground;
mod integrator;
mod plan;
mod roles;
mod scenes;
mod stable_step;

pub use body::check_body;
pub use force::{ForceRange, check_force};
pub use friction::{FrictionRange, check_friction};
pub use ground::{GroundRange, check_ground};
pub use integrator::{check_energy_never_rises, check_integrator};
pub use plan::CheckPlan;

use core::fmt;

use glam::DVec3;

use crate::error::{self, Rule, SceneError, StepError};
use crate::real::{Real, Vector};

/// Requirement of a trait's contract that an implementation breaks, and the input that shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Violation {
    /// Requirement that is broken.
    pub requirement: Requirement,
    /// Input that breaks it.
    pub input: Input,
    /// Offending value, in the SI unit of the quantity that the requirement is about.
    pub value: f64,
    /// Bound of the requirement for this input, including rounding.
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
        // A rule of scenes names its own bound, except for a sum that depends on the body. A value
        // that is not a number has no bound.
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

/// Requirement of a contract.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Requirement {
    /// The implementation's own check passes, a scene can be composed with it, and the range of the
    /// check is valid.
    #[error("the parts and the range of a check must be valid: {quantity} {rule}")]
    Composes {
        /// Name of the invalid quantity, such as "mass".
        quantity: &'static str,
        /// Rule that it breaks.
        rule: Rule,
    },
    /// Every number is finite.
    #[error("every number must be finite")]
    Finite,

    /// Body: each method returns the same value at every call with the same arguments.
    #[error("the values of a body must be the same at every call")]
    Rigid,
    /// Body: no contact, rim or point of the support function lies beyond the bounding radius, and
    /// no contact beyond the support function.
    #[error("no contact may lie beyond the bounding radius or the support function")]
    Reach,
    /// Body: `contacts_below` omits no contact, and `contacts_below_near` returns the same range
    /// for any known range.
    #[error("contacts_below must omit no contact, and contacts_below_near must agree with it")]
    ContactsBelow,
    /// Smooth body: it has one contact, `support_point` is within the bounding radius, and no other
    /// value of it is farther in that direction.
    #[error("support_point must be the farthest point of one contact, within bounding_radius")]
    Support,

    /// Ground: the normal has length 1.
    #[error("the surface's normal must have length 1")]
    UnitNormal,
    /// Ground: the material of a ground that moves stays on its surface.
    #[error("the ground's material must move along its surface")]
    MotionAlongSurface,
    /// Ground: the gap changes by `normal · path` between two points.
    #[error(
        "the gap must change by normal · displacement, as a distance does; \
         use a Terrain for a height z = h(x, y)"
    )]
    GapAlongNormal,
    /// Ground: the `bounds` are true.
    #[error("the bounds must be true of the surface")]
    GroundBounds,
    /// Ground: `surface_under` returns the surface, or `None` for a contact that does not touch it.
    #[error("surface_under must be the surface, or None for a contact that does not touch it")]
    SurfaceUnder,
    /// Ground: the spring force is at least 0.
    #[error("the spring force must be at least 0, rounding included")]
    SpringPushes,
    /// Ground: the springs' energy is at least 0 and does not decrease with penetration depth.
    #[error("the springs' energy must be at least 0 and must not decrease with depth")]
    SpringEnergyRises,
    /// Ground: the springs' energy is the integral of their force.
    #[error("the springs' energy must be the integral of the spring force")]
    EnergyIsIntegral,
    /// Ground: the normal force is at least 0.
    #[error("the ground must not pull, not even by rounding")]
    NeverPulls,
    /// Ground: `(normal_force - spring_force) · closing_speed >= 0`.
    #[error("the damper must only dissipate energy")]
    DamperTakes,
    /// Ground: force, slope, stiffness and damping of the mean force are at least 0.
    #[error("the mean force and its slopes must be at least 0")]
    MeanForceSigns,
    /// Ground: the mean force is 0 on a path above ground.
    #[error("the mean force must be 0 above the ground")]
    MeanForceAbove,
    /// Ground: the mean force takes at least the energy that the springs store, and returns at most
    /// the energy that they stored.
    #[error("the mean force must take at least, and return at most, the energy of the springs")]
    MeanForceTakes,
    /// Ground: the mean force is the mean of the normal force along the path.
    #[error("the mean force must be the mean of the normal force")]
    MeanForceIsMean,

    /// Friction: `force · slip <= 0`.
    #[error("friction must oppose the slip")]
    Opposes,
    /// Friction: the force lies in the surface.
    #[error("friction must lie in the surface")]
    InSurface,
    /// Friction: force and resistance are proportional to the load, if `is_proportional_to_load`.
    #[error("friction and resistance must be proportional to the load, if is_proportional_to_load")]
    ProportionalToLoad,
    /// Friction: without load there is no force.
    #[error("friction must be 0 without load")]
    NoLoadNoForce,
    /// Friction: without slip there is no force.
    #[error("friction must be 0 without slip")]
    NoSlipNoForce,
    /// Friction: `rolling_resistance` is always `Some` or never, with torques of at least 0 and a
    /// rotation speed above 0.
    #[error("rolling_resistance must be always Some or always None, with valid values")]
    TurningOpposes,
    /// Friction: if `depends_on_position` is false, force and resistance are the same at every
    /// position.
    #[error("a law that varies over the ground needs depends_on_position to be true")]
    SameEverywhere,
    /// Friction: `jacobian` has a coefficient of `-force · slip/|slip|²`, a width above 0, and a
    /// growth between 0 and 1.
    #[error("the Jacobian must be consistent with the force")]
    JacobianFits,

    /// Friction: `per_load` of `jacobian` is the derivative of the coefficient with respect to the
    /// normal force.
    #[error("per_load of the Jacobian must be the derivative of |force|/|slip| by the load")]
    PerLoadFits,
    /// Friction: `growth` and `width` of `jacobian` are those by which the coefficient decreases
    /// with the slip.
    #[error("growth and width of the Jacobian must be those by which |force|/|slip| decreases")]
    GrowthFits,
    /// Friction: the metric is a symmetric matrix, and gives the direction of the force.
    #[error("the metric must be symmetric and give the direction of the force")]
    MetricFits,

    /// Force: a passive force does no positive work, and drag is at most 0.
    #[error("a passive force must not do positive work")]
    PassiveTakes,
    /// Force: the powers of drag and drive add up to the power of force and torque.
    #[error("drag and drive must add up to the power of force and torque")]
    PowerFits,
    /// Force: it is zero if [`acts`](crate::Force::acts) returns false.
    #[error("a force that does not act must be 0")]
    ActsOrZero,
    /// Force: it is continuous in the velocities. Friction: it has no jump at zero slip.
    #[error("the force must be continuous in the velocities")]
    Continuous,

    /// Integrator: a step of a well-resolved scene succeeds.
    #[error("a well-resolved step must succeed ({0})")]
    Steps(StepError),
    /// Integrator: the duration of a step is above 0 s.
    #[error("a step must take more than 0 s")]
    TakesTime,
    /// Integrator: the duration of a step is at most the limit.
    #[error("a step must not exceed its limit")]
    KeepsToLimit,
    /// Integrator: a step with a limit above the fixed step takes the fixed step.
    #[error("a step must take the fixed step of the method if its limit is larger")]
    FixedStep,
    /// Integrator: successive steps towards a time arrive at it.
    #[error("steps towards a time must arrive at it")]
    LandsOnLimit,
    /// Integrator: the duration that a step returns is the time by which the state was advanced.
    #[error("a step must advance by the time that it returns")]
    TellsTime,
    /// Force, integrator: the same input gives the same bits.
    #[error("the same input must give the same bits")]
    SameBits,
    /// Integrator: the content of the workspace changes no bit, and a cleared one is like a new
    /// one.
    #[error("the workspace must not change a result")]
    WorkspaceChangesNothing,
    /// Integrator: the orientation has length 1 after a step.
    #[error("the orientation must have length 1 after a step")]
    UnitOrientation,
    /// Integrator: the error decreases with the step size at the stated order, within 0.3.
    #[error("half the step size must divide the error by at least 2^(order - 0.3)")]
    Order,
    /// Integrator: with shorter steps, the result tends to the motion of the scene.
    #[error("the result must tend to the motion of the scene")]
    Motion,
    /// Integrator: a damped oscillator does not grow in steps below `largest_stable_step`.
    #[error("an oscillator must not grow in steps below largest_stable_step")]
    StableStep,
    /// Integrator: the computed energy after a step does not exceed the energy before it.
    #[error("the energy must not increase")]
    EnergyNeverRises,
}

/// Input that breaks a requirement, SI units.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Input {
    /// No specific input: the implementation as it is.
    #[error("for any input")]
    AsItIs,
    /// A contact of the body.
    #[error("at contact {index}")]
    Contact {
        /// Number of the contact.
        index: usize,
    },
    /// Plane below which contacts were requested, and one of the contacts.
    #[error("at contact {index} below the plane {normal} · p = {offset:e} m")]
    Below {
        /// Normal of its plane, body axes.
        normal: DVec3,
        /// Distance of its plane from the centre of mass along the normal, m.
        offset: f64,
        /// Number of the contact.
        index: usize,
    },
    /// Point in the world.
    #[error("at the point {point} m")]
    Point {
        /// Position, m, world axes.
        point: DVec3,
    },
    /// Displacement from one point to another.
    #[error("on the path from {from} m to {to} m")]
    Displacement {
        /// Start, m, world axes.
        from: DVec3,
        /// End, m, world axes.
        to: DVec3,
    },
    /// Interval of penetration depths.
    #[error("from depth {from:e} m to {to:e} m")]
    Depths {
        /// Smaller penetration depth, m.
        from: f64,
        /// Larger penetration depth, m.
        to: f64,
    },
    /// Penetrating contact.
    #[error("at depth {depth:e} m and closing speed {closing_speed:e} m/s")]
    Penetration {
        /// Penetration depth, m.
        depth: f64,
        /// Closing speed, m/s.
        closing_speed: f64,
    },
    /// Path of a contact at constant speed over a step.
    #[error("from depth {start:e} m to {end:e} m within {seconds:e} s")]
    Path {
        /// Penetration depth at the start, m.
        start: f64,
        /// Penetration depth at the end, m.
        end: f64,
        /// Duration, s.
        seconds: f64,
    },
    /// Sliding contact.
    #[error("at {position} m under {normal_force:e} N at a slip of {} m/s", Exponents(*slip))]
    Slide {
        /// Position of the contact, m, world axes.
        position: DVec3,
        /// Normal force, N.
        normal_force: f64,
        /// Slip velocity, m/s.
        slip: DVec3,
    },
    /// Motion of a body.
    #[error("at {linear_velocity} m/s and {angular_velocity} rad/s")]
    Motion {
        /// Velocity of the centre of mass, m/s.
        linear_velocity: DVec3,
        /// Angular velocity, rad/s.
        angular_velocity: DVec3,
    },
    /// Step of one of the test scenes.
    #[error("{scene} (case {case}), step {step} with a limit of {limit:e} s")]
    Step {
        /// Name of the scene.
        scene: &'static str,
        /// Number of the case.
        case: u32,
        /// Number of the step.
        step: u32,
        /// Limit of the step, s.
        limit: f64,
    },
    /// Damped oscillator in steps of one size.
    #[error(
        "at a stiffness of {stiffness:e} 1/s² and a damping of {damping:e} 1/s \
         in steps of {step:e} s"
    )]
    Oscillator {
        /// Stiffness per mass, 1/s².
        stiffness: f64,
        /// Damping per mass, 1/s.
        damping: f64,
        /// Step size, s.
        step: f64,
    },
}

/// Displays a vector with exponents. Without them, 1e-150 has 152 digits.
struct Exponents(DVec3);

impl fmt::Display for Exponents {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let DVec3 { x, y, z } = self.0;
        write!(f, "[{x:e}, {y:e}, {z:e}]")
    }
}

/// Returns `Ok` if a requirement holds, otherwise its violation.
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

/// Checks that a number is finite.
fn demand_finite<R: Real>(value: R, input: impl FnOnce() -> Input) -> Result<(), Violation> {
    demand(value.is_finite(), Requirement::Finite, value, R::MAX, input)
}

/// Checks that a number is at least a bound.
fn demand_at_least<R: Real>(
    value: R,
    bound: R,
    requirement: Requirement,
    input: impl FnOnce() -> Input,
) -> Result<(), Violation> {
    demand(value >= bound, requirement, value, bound, input)
}

/// Checks that a number is at most a bound.
fn demand_at_most<R: Real>(
    value: R,
    bound: R,
    requirement: Requirement,
    input: impl FnOnce() -> Input,
) -> Result<(), Violation> {
    demand(value <= bound, requirement, value, bound, input)
}

/// Checks the centre of a range.
fn check_centre<R: Real>(centre: R::Vec3) -> Result<(), SceneError> {
    for component in [centre.x(), centre.y(), centre.z()] {
        error::finite("a component of the centre of the range", component, " m")?;
    }
    Ok(())
}

/// Violation for a scene that cannot be composed, or for a range that is invalid.
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

/// Vector in f64, for a message.
fn wide<R: Real>(vector: R::Vec3) -> DVec3 {
    DVec3::new(
        vector.x().to_f64(),
        vector.y().to_f64(),
        vector.z().to_f64(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::StepError;

    #[test]
    fn the_bound_of_a_rule_of_scenes_is_its_number() {
        for (rule, bound) in [
            (Rule::AboveZeroToOne, 1.0),
            (Rule::UnitLength, 1.0),
            (Rule::AtLeast(3), 3.0),
            (Rule::AtMost(7), 7.0),
            (Rule::Exactly(5), 5.0),
            (Rule::Finite, f64::MAX),
            (Rule::AboveZero, 0.0),
        ] {
            let violation = cannot_be(SceneError::new("a number", rule, 9.0, ""));
            assert!(violation.bound.total_cmp(&bound).is_eq(), "{violation:?}");
            assert!(violation.value.total_cmp(&9.0).is_eq(), "{violation:?}");
        }
    }

    #[test]
    fn a_sentence_names_the_bound_where_the_requirement_does_not() {
        let violation = |requirement| Violation {
            requirement,
            input: Input::AsItIs,
            value: 3.0,
            bound: 2.0,
        };
        for (requirement, names_bound) in [
            (Requirement::Reach, true),
            (Requirement::Finite, false),
            (Requirement::Steps(StepError::Stalled), false),
            (composes(Rule::AboveZero), false),
            (composes(Rule::TriangleInequality), true),
        ] {
            let sentence = std::format!("{}", violation(requirement));
            let found = sentence.contains(", the bound is 2e0");
            assert_eq!(found, names_bound, "{sentence}");
        }
    }

    fn composes(rule: Rule) -> Requirement {
        Requirement::Composes {
            quantity: "mass",
            rule,
        }
    }
}
