//! Error types: [`SceneError`] for a scene while it is composed, [`StepError`] for a step while it
//! is taken.

use crate::real::Real;

/// Rule that a quantity must satisfy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Rule {
    /// Finite and positive.
    AboveZero,
    /// Finite and at least 0.
    AtLeastZero,
    /// Greater than 0 and at most 1.
    AboveZeroToOne,
    /// Greater than 0 and less than 1.
    BetweenZeroAndOne,
    /// Zero. Whether rounding is allowed depends on the quantity.
    Zero,
    /// At most 0.
    AtMostZero,
    /// Not NaN; may be infinite.
    NotNan,
    /// Neither infinite nor NaN.
    Finite,
    /// At least this number.
    AtLeast(u32),
    /// At most this number.
    AtMost(usize),
    /// Exactly this number.
    Exactly(usize),
    /// A length of 1 within rounding.
    UnitLength,
    /// The moments of inertia of a solid: none is negative, and none exceeds the sum of the other
    /// two.
    TriangleInequality,
    /// Equal to its own transpose.
    Symmetric,
    /// An even number.
    Even,
    /// A surface without a hole or an edge.
    Closed,
    /// Large enough for a finite inverse.
    FiniteInverse,
    /// Large enough that its square is above 0, and that a force can be divided by it: above
    /// 1.6e-162 in f64, and 2.7e-23 in f32.
    SafeDivisor,
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
            Self::BetweenZeroAndOne => "must be above 0 and below 1",
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
            Self::SafeDivisor => "must not be so small that its square is 0",
        })
    }
}

/// A number in a message: with an exponent if it would have too many digits to be read without.
struct Readable(f64);

impl core::fmt::Display for Readable {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let (number, size) = (self.0, self.0.abs());
        let is_short = size == 0.0 || (1e-7..1e16).contains(&size) || !size.is_finite();
        if is_short {
            write!(f, "{number}")
        } else {
            write!(f, "{number:e}")
        }
    }
}

/// Invalid parameter of a part, a scene, an observer, an event, a saved session or an ensemble.
///
/// Parameters are checked once, when the object is created or loaded, so that a step need not check
/// them.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{quantity} {rule}, got {}{unit}", Readable(*value))]
#[non_exhaustive]
pub struct SceneError {
    /// Name of the quantity in words, for example "time step".
    pub quantity: &'static str,
    /// Rule that the value breaks.
    pub rule: Rule,
    /// Value that breaks the rule.
    pub value: f64,
    /// Unit with a space before it, for example " kg", or empty.
    pub unit: &'static str,
}

impl SceneError {
    /// Creates an error for a quantity with its unit ("" if it has none).
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

/// Checks that a quantity is finite and positive.
///
/// `quantity` is the name of `value` in words, for example "time step". `unit` begins with a space,
/// for example " s", or is empty.
///
/// # Errors
/// Returns [`SceneError`] with [`Rule::Finite`] if the value is infinite or NaN, and with
/// [`Rule::AboveZero`] if it is finite and not above 0.
pub fn above_zero<R: Real>(
    quantity: &'static str,
    value: R,
    unit: &'static str,
) -> Result<(), SceneError> {
    finite(quantity, value, unit)?;
    obey(value > R::ZERO, Rule::AboveZero, quantity, value, unit)
}

/// Checks that a quantity is finite and at least 0.
///
/// `quantity` is the name of `value` in words, for example "damping". `unit` begins with a space,
/// for example " N s/m", or is empty.
///
/// # Errors
/// Returns [`SceneError`] with [`Rule::Finite`] if the value is infinite or NaN, and with
/// [`Rule::AtLeastZero`] if it is below 0.
pub fn at_least_zero<R: Real>(
    quantity: &'static str,
    value: R,
    unit: &'static str,
) -> Result<(), SceneError> {
    finite(quantity, value, unit)?;
    obey(value >= R::ZERO, Rule::AtLeastZero, quantity, value, unit)
}

/// Checks that a quantity is neither infinite nor NaN.
///
/// `quantity` is the name of `value` in words, for example "tilt of the coin". `unit` begins with a
/// space, for example " rad", or is empty.
///
/// # Errors
/// Returns [`SceneError`] with [`Rule::Finite`] if the value is infinite or NaN.
pub fn finite<R: Real>(
    quantity: &'static str,
    value: R,
    unit: &'static str,
) -> Result<(), SceneError> {
    obey(value.is_finite(), Rule::Finite, quantity, value, unit)
}

/// Checks that the inverse of a positive quantity is finite.
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

/// Checks that a quantity is finite and positive, and that forces can be divided by it.
///
/// # Errors
/// Returns [`SceneError`] if it is not. The error names the quantity, the rule, the value and the
/// unit.
pub(crate) fn safe_divisor<R: Real>(
    quantity: &'static str,
    value: R,
    unit: &'static str,
) -> Result<(), SceneError> {
    above_zero(quantity, value, unit)?;
    // A slip whose square is rounded to 0 has the length 0. Its friction is within its limit only
    // if the divisor is larger. In f32 this also leaves room for a force of 9e15 N.
    let is_safe = value * value > R::ZERO;
    obey(is_safe, Rule::SafeDivisor, quantity, value, unit)
}

/// Checks the slip speed of a friction law, m/s, by which the friction is divided.
pub(crate) fn slip_speed<R: Real>(value: R) -> Result<(), SceneError> {
    safe_divisor("slip speed of the friction", value, " m/s")
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

/// The first of many states whose run failed, with the error.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("state {index}: {error}")]
pub struct StateError {
    /// Index of the state.
    pub index: usize,
    /// Error of its run.
    pub error: StepError,
}

/// Error of a step, a run, an impulse or a query within a step.
///
/// A step or an impulse that fails leaves the state unchanged. A run that fails leaves the state
/// after its last successful step.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// The state before the step contains a NaN or an infinity, or an invalid orientation. An
    /// orientation is invalid if its length is 0, or so near to 0 or infinity that the square of
    /// the length is 0 or infinite.
    #[error(
        "the {quantity} before the step must be finite{}, got {value}{}",
        if_orientation(*.quantity),
        .quantity.unit()
    )]
    BadState {
        /// The invalid quantity.
        quantity: Quantity,
        /// Its length, in the SI unit of the quantity.
        value: f64,
    },
    /// The applied force changes so fast with the velocities that no part of the step could be
    /// solved. An example is a lift that would turn the velocity by a thousand radians in a step,
    /// or by tens of radians if the body is a needle whose smallest moment is 1e-12 of the largest.
    #[error(
        "the applied force must change little within a step, got a step of {seconds:e} s: shorten the time step, or check the force with `contract::check_force`"
    )]
    ForceTooSteep {
        /// Length of the step, s.
        seconds: f64,
    },
    /// The result of the step is not finite. Either the step size exceeds the stability limit of
    /// the integrator, or a number has overflowed.
    #[error(
        "the {0} is no longer finite after the step: shorten the time step or choose an integrator that is stable for it"
    )]
    Diverged(Quantity),
    /// A ground, a friction law or an applied force has returned a value that violates its
    /// contract.
    #[error(
        "the {quantity} {}, got {value:e}{}; `contract::check_ground`, `check_friction` and `check_force` find such values before a run",
        .quantity.rule(),
        .quantity.unit()
    )]
    BrokenLaw {
        /// Name of the value, which also identifies the law.
        quantity: LawQuantity,
        /// Invalid value, in the SI unit of the quantity.
        value: f64,
    },
    /// An adaptive method cannot keep its tolerance with any step down to the rounding of the
    /// longest one that it has tried. Either the tolerance is below the rounding error, or a force
    /// does not satisfy the assumptions of the method.
    #[error(
        "the tolerance needs steps below {length:.1e} s at {time:.6} s, because of the {quantity}: increase it, or check the forces there"
    )]
    StepTooShort {
        /// Quantity whose error exceeds the tolerance.
        quantity: Quantity,
        /// Shortest step, s.
        length: f64,
        /// Time at which the step begins, s, from the start of the run or of the call. For a single
        /// step of a session it is the time of the session.
        time: f64,
    },
    /// An adaptive method has tried as many steps as its budget allows.
    ///
    /// A frequent cause is a contact that sticks or rolls. Stability then bounds each step of an
    /// explicit method by about `slip_speed/(μ g)`, whatever the tolerance, with the coefficient of
    /// friction μ and the acceleration of gravity g.
    /// [`EnergyMomentum`](crate::EnergyMomentum) has no such bound.
    #[error(
        "the budget of {attempts} steps is spent at {time:.6} s: loosen the tolerance or raise the budget; where contacts stick at a small slip speed take EnergyMomentum, or a larger slip speed"
    )]
    BudgetSpent {
        /// Number of steps tried.
        attempts: u32,
        /// Time at which the step begins, s, from the start of the run or of the call. For a single
        /// step of a session it is the time of the session.
        time: f64,
    },
    /// The sum of the magnitudes of all energies before the step is NaN, or so large that it
    /// overflows in the step.
    #[error(
        "the energy before the step must be finite and far from overflow, got {joules:e} J: check the velocities, the penetration depths and the laws of the ground"
    )]
    BadEnergy {
        /// Sum of the magnitudes of all kinds of energy, J.
        joules: f64,
    },
    /// The step is too long for its end to be resolved.
    ///
    /// [`EnergyMomentum`](crate::EnergyMomentum) returns it if the free motion in the step
    /// overflows or exceeds 1e25 bounding radii, or if no part of the step ends at an energy that
    /// is low enough. The bounding radius counts as 1 m if it is 0.
    #[error(
        "the step must be short enough for position and orientation to be resolved, got {seconds:e} s: shorten the time step"
    )]
    StepTooLong {
        /// Length of the step, s.
        seconds: f64,
    },
    /// The step of the integrator took no time, less time than the clock of the run resolves, or no
    /// finite time. The run would never end.
    #[error("a step must take a finite time above 0 s that the clock of the run can resolve")]
    Stalled,
    /// The time to advance by is negative or not finite, or the session's clock would overflow.
    #[error(
        "the time to advance by must be at least 0 s and end at a finite time, got {} s",
        Readable(*seconds)
    )]
    BadDuration {
        /// Requested time, s.
        seconds: f64,
    },
    /// The time within a step is negative, NaN, or above the length of the step.
    #[error(
        "the time within a step must be from 0 s to its length of {} s, got {} s",
        Readable(*length),
        Readable(*seconds)
    )]
    BadTime {
        /// Requested time, s.
        seconds: f64,
        /// Length of the step, s.
        length: f64,
    },
    /// The value of an event is NaN.
    #[error(
        "the value of the event with index {event} must not be NaN, got NaN at {} s",
        Readable(*time)
    )]
    BadEvent {
        /// Index of the event in the array of the run.
        event: usize,
        /// Time since the start of the session, s.
        time: f64,
    },
    /// The limit of a step is negative or NaN.
    #[error("the limit of a step must be at least 0 s, got {} s", Readable(*seconds))]
    BadLimit {
        /// Limit, s.
        seconds: f64,
    },
    /// An impulse or its point of application is not finite, or the impulse is so large that the
    /// motion after it is not finite.
    #[error("{quantity} must be finite, got {}", Readable(*value))]
    BadImpulse {
        /// Name of the quantity in words, for example "x of the impulse".
        quantity: &'static str,
        /// Value of the quantity.
        value: f64,
    },
    /// A run has more steps than its clock can count. The error is returned before the first step,
    /// or after a closed-form flight has ended.
    #[error(
        "a run of {seconds:e} s must have at most {most:.1e} steps, got a step size of {time_step:e} s: lengthen the steps or shorten the run"
    )]
    TooManySteps {
        /// Rest of the run, s.
        seconds: f64,
        /// Step size of the integrator, s.
        time_step: f64,
        /// Largest number of steps.
        most: f64,
    },
    /// A run has more samples at equal intervals than can be distinguished. The error is returned
    /// before the first step.
    #[error(
        "a run of {seconds:e} s must have at most {most:.1e} samples, got an interval of {interval:e} s: lengthen the interval or shorten the run"
    )]
    TooManySamples {
        /// Time to advance by, s.
        seconds: f64,
        /// Interval between the samples, s.
        interval: f64,
        /// Largest number of samples.
        most: f64,
    },
}

impl StepError {
    /// Returns the same error with this time (s) as the beginning of its step.
    #[cold]
    pub(crate) fn at(mut self, seconds: f64) -> Self {
        if let Self::StepTooShort { time, .. } | Self::BudgetSpent { time, .. } = &mut self {
            *time = seconds;
        }
        self
    }
}

/// Additional requirement on an orientation, beyond being finite.
const fn if_orientation(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Orientation => ", with a length that is not zero",
        _ => "",
    }
}

/// A quantity of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Position of the centre of mass.
    Position,
    /// Velocity of the centre of mass.
    LinearVelocity,
    /// Rotation from body axes to world axes.
    Orientation,
    /// Angular momentum about the centre of mass.
    AngularMomentum,
}

impl Quantity {
    /// Unit, with a space before it. Empty for an orientation.
    const fn unit(self) -> &'static str {
        match self {
            Self::Position => " m",
            Self::LinearVelocity => " m/s",
            Self::Orientation => "",
            Self::AngularMomentum => " kg m²/s",
        }
    }
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

/// A part of a scene that a user of the crate can implement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Role {
    /// Surface of the ground: a [`Shape`](crate::Shape), or the corresponding part of a ground.
    GroundShape,
    /// Springs and dampers of the ground: a [`ContactLaw`](crate::ContactLaw), or the corresponding
    /// part of a ground.
    GroundLaw,
    /// A [`SlidingFriction`](crate::SlidingFriction) law.
    FrictionLaw,
    /// An applied [`Force`](crate::Force).
    AppliedForce,
}

impl core::fmt::Display for Role {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::GroundShape => "shape of the ground",
            Self::GroundLaw => "contact law of the ground",
            Self::FrictionLaw => "friction law",
            Self::AppliedForce => "applied force",
        })
    }
}

/// A value that a law of the ground, of friction or of a force returns during a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LawQuantity {
    /// Height of a point above the surface, m.
    Gap,
    /// Length of the surface normal.
    Normal,
    /// Elastic force of a contact, N.
    SpringForce,
    /// Elastic energy of the springs under a contact, J.
    SpringEnergy,
    /// Force of spring and damper on a contact, N.
    NormalForce,
    /// Mean of the normal force over a path, N.
    MeanForce,
    /// Magnitude of the force along the surface, N.
    FrictionForce,
    /// Power of the friction force, `force · slip`, W.
    FrictionPower,
    /// Torque or turn speed of a [`RollingResistance`](crate::RollingResistance). All are finite,
    /// the torques are at least 0, and the turn speed is above 0.
    RollingResistance,
    /// Magnitude of an applied [`Force`](crate::Force), N.
    AppliedForce,
    /// Magnitude of the torque of an applied [`Force`](crate::Force), N m.
    AppliedTorque,
    /// Power of an applied force that is passive, W.
    AppliedPower,
}

impl LawQuantity {
    /// Part of the scene that has returned the value.
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
            Self::AppliedForce | Self::AppliedTorque | Self::AppliedPower => Role::AppliedForce,
        }
    }

    /// Rule that the value must satisfy.
    #[must_use]
    pub const fn rule(self) -> Rule {
        match self {
            Self::Gap | Self::SpringForce | Self::NormalForce | Self::MeanForce => Rule::NotNan,
            Self::Normal => Rule::UnitLength,
            Self::SpringEnergy | Self::RollingResistance => Rule::AtLeastZero,
            Self::FrictionForce | Self::AppliedForce | Self::AppliedTorque => Rule::Finite,
            Self::FrictionPower | Self::AppliedPower => Rule::AtMostZero,
        }
    }

    /// Unit of the value with a space before it, for example " J", or empty.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Gap => " m",
            Self::Normal | Self::RollingResistance => "",
            Self::SpringEnergy => " J",
            Self::FrictionPower | Self::AppliedPower => " W",
            Self::AppliedTorque => " N m",
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
            // One rule stands for all its values, so the rest of the requirement is here.
            Self::RollingResistance => "rolling resistance (finite, turn speed above 0)",
            Self::AppliedForce => "force",
            Self::AppliedTorque => "torque",
            Self::AppliedPower => "power",
        })?;
        write!(f, " of the {}", self.role())
    }
}
