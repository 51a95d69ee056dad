//! What can be wrong: with a scene while it is composed ([`SceneError`]), with a step while it is
//! taken ([`StepError`]).

use crate::real::Real;

/// What a quantity must obey.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Rule {
    /// Finite and above 0.
    AboveZero,
    /// Finite and at least 0.
    AtLeastZero,
    /// Above 0 and at most 1.
    AboveZeroToOne,
    /// 0, to rounding.
    Zero,
    /// At most 0.
    AtMostZero,
    /// A number, which may be infinite.
    NotNan,
    /// Neither infinite nor NaN.
    Finite,
    /// At least this many.
    AtLeast(u32),
    /// At most this many.
    AtMost(usize),
    /// As many as this.
    Exactly(usize),
    /// Of length 1, to rounding.
    UnitLength,
    /// The moments of inertia of a solid: none negative, none above the sum of the two others.
    TriangleInequality,
    /// Equal to its own transpose.
    Symmetric,
    /// A number of pairs.
    Even,
    /// A surface without a hole or an edge.
    Closed,
    /// So large that its inverse is finite.
    FiniteInverse,
}

impl core::fmt::Display for Rule {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::AtLeast(least) => return write!(f, "must be at least {least}"),
            Self::AtMost(most) => return write!(f, "must be at most {most}"),
            Self::Exactly(count) => return write!(f, "must be {count}"),
            Self::AboveZero => "must be above 0",
            Self::AtLeastZero => "must be at least 0",
            Self::AboveZeroToOne => "must be above 0 and at most 1",
            Self::Zero => "must be 0",
            Self::AtMostZero => "must be at most 0",
            Self::NotNan => "must not be NaN",
            Self::Finite => "must be finite",
            Self::UnitLength => "must have length 1",
            Self::TriangleInequality => "must not exceed the sum of the other two moments",
            Self::Symmetric => "must be symmetric",
            Self::Even => "must be even",
            Self::Closed => "must be closed",
            Self::FiniteInverse => "must not be so small that its inverse overflows",
        })
    }
}

/// An invalid parameter of a scene or of an observer: raised once, when that is composed, so that a
/// step need not check.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{quantity} {rule}, got {value}{unit}")]
#[non_exhaustive]
pub struct SceneError {
    /// What is wrong, in words: "time step".
    pub quantity: &'static str,
    /// The rule that it breaks.
    pub rule: Rule,
    /// The offending value.
    pub value: f64,
    /// Its unit with a space before it, or nothing: " kg".
    pub unit: &'static str,
}

impl SceneError {
    /// An error for a quantity with its unit ("" where it has none).
    #[must_use]
    pub const fn new(quantity: &'static str, rule: Rule, value: f64, unit: &'static str) -> Self {
        Self {
            quantity,
            rule,
            value,
            unit,
        }
    }
}

/// That a quantity is finite and above 0.
///
/// # Errors
/// Names quantity, rule, value and unit where it is not.
pub fn above_zero<R: Real>(
    quantity: &'static str,
    value: R,
    unit: &'static str,
) -> Result<(), SceneError> {
    obey(
        value > R::ZERO && value.is_finite(),
        Rule::AboveZero,
        quantity,
        value,
        unit,
    )
}

/// That a quantity is finite and at least 0.
///
/// # Errors
/// Names quantity, rule, value and unit where it is not.
pub fn at_least_zero<R: Real>(
    quantity: &'static str,
    value: R,
    unit: &'static str,
) -> Result<(), SceneError> {
    obey(
        value >= R::ZERO && value.is_finite(),
        Rule::AtLeastZero,
        quantity,
        value,
        unit,
    )
}

/// That a quantity is neither infinite nor NaN.
///
/// # Errors
/// Names quantity, rule, value and unit where it is.
pub fn finite<R: Real>(
    quantity: &'static str,
    value: R,
    unit: &'static str,
) -> Result<(), SceneError> {
    obey(value.is_finite(), Rule::Finite, quantity, value, unit)
}

/// Checks that the inverse of a quantity above 0 is finite.
///
/// # Errors
/// Returns [`SceneError`] if it overflows. The error names the quantity, the rule and the value.
pub(crate) fn finite_inverse<R: Real>(
    quantity: &'static str,
    value: R,
    unit: &'static str,
) -> Result<(), SceneError> {
    let is_finite = (R::ONE / value).is_finite();
    obey(is_finite, Rule::FiniteInverse, quantity, value, unit)
}

fn obey<R: Real>(
    holds: bool,
    rule: Rule,
    quantity: &'static str,
    value: R,
    unit: &'static str,
) -> Result<(), SceneError> {
    if holds {
        Ok(())
    } else {
        Err(SceneError::new(quantity, rule, value.to_f64(), unit))
    }
}

/// A step that cannot go on. The state that was handed in is left as it was: the last good one.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// The state that was handed in holds a NaN or an infinity, or an orientation of length 0 (or
    /// so near to 0 or infinity that its square is).
    #[error("the {0} before the step must be finite{nor_zero}", nor_zero = if_orientation(*.0))]
    BadState(Quantity),
    /// The step's result is not finite: the time step is beyond the integrator's stability limit,
    /// or a number has overflowed.
    #[error(
        "the {0} is no longer finite after the step: shorten the time step or choose an integrator that is stable for it"
    )]
    Diverged(Quantity),
    /// A ground or a friction law has returned a value that its contract rules out.
    #[error(
        "the {quantity} {}, got {value:e}{}; `contract::check_ground` and `contract::check_friction` find such values before a run",
        .quantity.rule(),
        .quantity.unit()
    )]
    BrokenLaw {
        /// The value's name; it tells the law as well.
        quantity: LawQuantity,
        /// The offending value, in the SI unit of the quantity.
        value: f64,
    },
    /// A method that chooses its steps cannot keep its tolerance with any step that the clock
    /// resolves: the tolerance is below what rounding leaves, or a force is not what the method
    /// takes it for.
    #[error(
        "the tolerance needs steps below {length:.1e} s at {time:.6} s, because of the {quantity}: loosen it, or look at the forces there"
    )]
    StepTooShort {
        /// What the error is in.
        quantity: Quantity,
        /// The shortest step, s.
        length: f64,
        /// Since the workspace was new, which is the start of a run, s.
        time: f64,
    },
    /// A method that chooses its steps has tried as many as its budget has.
    ///
    /// Often because a contact sticks or rolls: stability then bounds each step by about
    /// `2 slip_speed/(3 μ g)`, whatever the tolerance, which no explicit method can exceed.
    /// [`EnergyMomentum`](crate::EnergyMomentum) has no such bound.
    #[error(
        "the budget of {attempts} steps is spent at {time:.6} s: loosen the tolerance or raise the budget; where contacts stick at a small slip speed take EnergyMomentum, or a larger slip speed"
    )]
    BudgetSpent {
        /// Steps tried.
        attempts: u32,
        /// Since the workspace was new, which is the start of a run, s.
        time: f64,
    },
    /// The sum of the energies' sizes before the step is NaN, or so large that it overflows in the
    /// step.
    #[error(
        "the energy before the step must be finite and far from overflow, got {joules:e} J: look at the velocities, the depth in the ground and its laws"
    )]
    BadEnergy {
        /// Sum of the sizes of all kinds of energy, J.
        joules: f64,
    },
    /// The step is so long that numbers cannot hold where the body would be.
    #[error(
        "the step must be short enough for position and orientation to be resolved, got {seconds:e} s: shorten the time step"
    )]
    StepTooLong {
        /// Length of the step, s.
        seconds: f64,
    },
    /// The integrator's step took no time, or less than the clock of the run resolves, so that the
    /// run would never end.
    #[error("a step must take more than 0 s, and enough for the clock of the run to go on")]
    Stalled,
    /// The time to advance by is negative or not finite.
    #[error("the time to advance by must be finite and at least 0 s, got {seconds} s")]
    BadDuration {
        /// The time that was asked for, s.
        seconds: f64,
    },
    /// The limit of a step is negative or NaN.
    #[error("the limit of a step must be at least 0 s, got {seconds} s")]
    BadLimit {
        /// The limit, s.
        seconds: f64,
    },
    /// An impulse, or the point where it acts, is not finite, or the impulse is so large that the
    /// motion after it is not.
    #[error("{quantity} must be finite, got {value}")]
    BadImpulse {
        /// What is not finite, in words: "x of the impulse".
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
    /// A run has more steps than its clock can count. Raised before the first of them, or after a
    /// closed-form flight has ended.
    #[error(
        "a run of {seconds:e} s must have at most {most:.1e} steps, got a step size of {time_step:e} s: lengthen the steps or shorten the run"
    )]
    TooManySteps {
        /// What is left of the run, s.
        seconds: f64,
        /// The integrator's step size, s.
        time_step: f64,
        /// The largest number of steps.
        most: f64,
    },
    /// A run has more samples at equal intervals than can be told apart. Raised before its first
    /// step.
    #[error(
        "a run of {seconds:e} s must have at most {most:.1e} samples, got an interval of {interval:e} s: lengthen the interval or shorten the run"
    )]
    TooManySamples {
        /// The time to advance by, s.
        seconds: f64,
        /// The interval between the samples, s.
        interval: f64,
        /// The largest number of samples.
        most: f64,
    },
}

/// What an orientation must be, beyond finite.
const fn if_orientation(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Orientation => ", with a length that is not zero",
        _ => "",
    }
}

/// A part of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The place of the centre of mass.
    Position,
    /// The velocity of the centre of mass.
    LinearVelocity,
    /// The turn from body axes to world axes.
    Orientation,
    /// The angular momentum about the centre of mass.
    AngularMomentum,
}

impl core::fmt::Display for Quantity {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Position => "position",
            Self::LinearVelocity => "linear velocity",
            Self::Orientation => "orientation",
            Self::AngularMomentum => "angular momentum",
        })
    }
}

/// A part of a scene that an author can supply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Role {
    /// The surface of the ground: a [`Shape`](crate::Shape), or the part of a ground that is one.
    GroundShape,
    /// The springs and dampers of the ground: a [`ContactLaw`](crate::ContactLaw), or the part of a
    /// ground that is one.
    GroundLaw,
    /// A [`SlidingFriction`](crate::SlidingFriction).
    FrictionLaw,
}

impl core::fmt::Display for Role {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::GroundShape => "shape of the ground",
            Self::GroundLaw => "law of the ground",
            Self::FrictionLaw => "friction law",
        })
    }
}

/// A value that a ground or a friction law returns during a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LawQuantity {
    /// Height of a point above the surface, m.
    Gap,
    /// Length of the surface's normal.
    Normal,
    /// Elastic force of a contact, N.
    SpringForce,
    /// Energy in the springs under a contact, J.
    SpringEnergy,
    /// Force of spring and damper on a contact, N.
    NormalForce,
    /// Mean of the normal force over a path, N.
    MeanForce,
    /// Size of the force along the surface, N.
    FrictionForce,
    /// Power of the friction force, `force · slip`, W.
    FrictionPower,
    /// A torque or the turn speed of a [`RollingResistance`](crate::RollingResistance).
    RollingResistance,
}

impl LawQuantity {
    /// The part of the scene that has returned the value.
    #[must_use]
    pub const fn role(self) -> Role {
        match self {
            Self::Gap | Self::Normal => Role::GroundShape,
            Self::SpringForce | Self::SpringEnergy | Self::NormalForce | Self::MeanForce => {
                Role::GroundLaw
            }
            Self::FrictionForce | Self::FrictionPower | Self::RollingResistance => {
                Role::FrictionLaw
            }
        }
    }

    /// The rule that the value must obey.
    #[must_use]
    pub const fn rule(self) -> Rule {
        match self {
            Self::Gap | Self::SpringForce | Self::NormalForce | Self::MeanForce => Rule::NotNan,
            Self::Normal => Rule::UnitLength,
            Self::SpringEnergy | Self::RollingResistance => Rule::AtLeastZero,
            Self::FrictionForce => Rule::Finite,
            Self::FrictionPower => Rule::AtMostZero,
        }
    }

    /// The unit of the value with a space before it, or nothing: " J".
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Gap => " m",
            Self::Normal | Self::RollingResistance => "",
            Self::SpringEnergy => " J",
            Self::FrictionPower => " W",
            _ => " N",
        }
    }
}

impl core::fmt::Display for LawQuantity {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Gap => "gap",
            Self::Normal => "normal",
            Self::SpringForce => "spring force",
            Self::SpringEnergy => "spring energy",
            Self::NormalForce => "normal force",
            Self::MeanForce => "mean force",
            Self::FrictionForce => "friction force",
            Self::FrictionPower => "power of the friction force",
            Self::RollingResistance => "resistance to turning",
        })?;
        write!(f, " of the {}", self.role())
    }
}
