//! Distributions of the start of a toss.

use core::f64::consts::TAU;

use super::error::TossError;
use super::toss::Toss;
use super::uniform::Uniform;
use crate::body::InertiaProperties;
use crate::error::{self, Rule, SceneError};
use crate::real::{Quaternion, Real, Vector, scaled};
use crate::rotation::Rotation;
use crate::state::State;

type Vec3 = <f64 as Real>::Vec3;

/// Distribution of the state at the start of a toss: a [`RandomStart`], or a closure
/// `Fn(&mut Toss<'_>) -> State<R>`.
pub trait StartDistribution<R: Real = f64> {
    /// Checks the parameters. The default accepts them.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a parameter is invalid. The error names the quantity, the rule and
    /// the value.
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }

    /// Returns the state at the start of a toss of a body with these inertia properties.
    ///
    /// *To the implementer:* the state must depend on the toss only.
    ///
    /// # Errors
    /// Returns [`TossError`] if there is no start. The ensemble counts it.
    fn draw(
        &self,
        inertia: &InertiaProperties<R>,
        toss: &mut Toss<'_>,
    ) -> Result<State<R>, TossError>;
}

impl<R: Real, F: Fn(&mut Toss<'_>) -> State<R>> StartDistribution<R> for F {
    fn draw(&self, _: &InertiaProperties<R>, toss: &mut Toss<'_>) -> Result<State<R>, TossError> {
        Ok(self(toss))
    }
}

/// Distribution of the orientation at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum RandomOrientation {
    /// Uniform over all rotations (K. Shoemake, Graphics Gems III, 1992, p. 124).
    Uniform,
    /// An axis of the body is tilted from the vertical.
    Tilted {
        /// Axis in the body, which points up at a tilt of 0. Its length, above 0, does not matter.
        axis: Vec3,
        /// Angle between the axis and world z, rad. The axis is tilted about world y, towards
        /// world x.
        tilt: Uniform,
        /// Angle of rotation of the body about the axis, rad.
        ///
        /// At the phase 0 and the tilt 0, the body is rotated from the world axes by the shortest
        /// rotation that brings the axis to world z. If the unit axis has a z component below -1/2,
        /// half a revolution about x comes first.
        phase: Uniform,
    },
}

/// Distribution of the angular velocity at the start. The sign of a rate is that of the
/// right-handed rotation about the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum RandomSpin {
    /// About an axis of the world.
    World {
        /// Axis, world axes. Its length, above 0, does not matter.
        axis: Vec3,
        /// Angular velocity about the axis, rad/s.
        rate: Uniform,
    },
    /// About an axis of the body.
    Body {
        /// Axis, body axes. Its length, above 0, does not matter.
        axis: Vec3,
        /// Angular velocity about the axis, rad/s.
        rate: Uniform,
    },
    /// About an axis that is uniform over all directions.
    Isotropic {
        /// Angular velocity about the axis, rad/s.
        rate: Uniform,
    },
    /// About a horizontal axis whose direction is uniform.
    Horizontal {
        /// Angular velocity about the axis, rad/s.
        rate: Uniform,
    },
}

/// How the random numbers of a start are drawn.
///
/// Wilson's interval is derived for independent tosses. A stratified fraction varies less, mostly,
/// so that the interval is too wide.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Sampling {
    /// Independently.
    #[default]
    Independent,
    /// Stratified in the phase, and independently otherwise: [`Toss::stratified`]. With
    /// [`RandomOrientation::Uniform`], the first of the three random numbers of the orientation is
    /// stratified.
    StratifiedPhase {
        /// Number of strata, at least 1.
        strata: u32,
    },
    /// The starts form a Latin hypercube in all parameters: [`Toss::latin`].
    Latin {
        /// Number of strata, from 1 to 4096. A start costs about that many random numbers for
        /// each parameter.
        strata: u32,
    },
}

/// Largest number of strata of a Latin hypercube, whose cost is proportional to it.
const MOST_STRATA: u32 = 4096;

/// Built-in distribution of the start: orientation, spin, height and speed.
///
/// The parameters are independent of each other. Each uses its own random numbers, so that a change
/// of one leaves the others as they are.
///
/// ```
/// use tumble::ensemble::{RandomSpin, RandomStart, Sampling};
/// use tumble::glam::DVec3;
///
/// // A coin with its normal along body x, tilted by up to 0.1 rad, at any phase.
/// let start = RandomStart::at_height(0.1..=0.3) // m
///     .with_tilt(DVec3::X, 0.0..=0.1) // rad
///     .with_spin(RandomSpin::World { axis: DVec3::Y, rate: (40.0..=60.0).into() }) // rad/s
///     .with_speed(DVec3::Z, 1.0..=2.0) // m/s
///     .with_sampling(Sampling::Latin { strata: 100 });
/// # let _ = start;
/// ```
///
/// *Limits:* the position is on the z axis. The caller ensures that the body does not start in the
/// ground. A start of single precision is the start of double precision, rounded.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[must_use]
pub struct RandomStart {
    /// Orientation.
    pub orientation: RandomOrientation,
    /// Angular velocity.
    pub spin: RandomSpin,
    /// Height of the centre of mass over the origin of the world, m.
    pub height: Uniform,
    /// Direction of the velocity, world axes. Its length, above 0, does not matter.
    pub direction: Vec3,
    /// Speed along the direction, m/s.
    pub speed: Uniform,
    /// How the random numbers are drawn.
    pub sampling: Sampling,
}

impl RandomStart {
    /// Creates a start at rest at a height (m), with an orientation uniform over all rotations.
    pub fn at_height(height: impl Into<Uniform>) -> Self {
        Self {
            orientation: RandomOrientation::Uniform,
            spin: RandomSpin::Isotropic {
                rate: Uniform::default(),
            },
            height: height.into(),
            direction: Vec3::Z,
            speed: Uniform::default(),
            sampling: Sampling::Independent,
        }
    }

    /// Returns the start with an axis of the body tilted from the vertical by an angle (rad), at
    /// any phase about the axis.
    pub fn with_tilt(self, axis: Vec3, tilt: impl Into<Uniform>) -> Self {
        let (tilt, phase) = (tilt.into(), (0.0..=TAU).into());
        self.with_orientation(RandomOrientation::Tilted { axis, tilt, phase })
    }

    /// Returns the start with this distribution of the orientation.
    pub fn with_orientation(self, orientation: RandomOrientation) -> Self {
        Self {
            orientation,
            ..self
        }
    }

    /// Returns the start with this distribution of the angular velocity.
    pub fn with_spin(self, spin: RandomSpin) -> Self {
        Self { spin, ..self }
    }

    /// Returns the start with a speed (m/s) along a direction (world axes).
    pub fn with_speed(self, direction: Vec3, speed: impl Into<Uniform>) -> Self {
        let speed = speed.into();
        Self {
            direction,
            speed,
            ..self
        }
    }

    /// Returns the start with random numbers drawn in this manner.
    pub fn with_sampling(self, sampling: Sampling) -> Self {
        Self { sampling, ..self }
    }

    fn check_spin(&self) -> Result<(), SceneError> {
        let rate = match self.spin {
            RandomSpin::World { axis, rate } | RandomSpin::Body { axis, rate } => {
                check_axis("length of the spin axis", axis)?;
                rate
            }
            RandomSpin::Isotropic { rate } | RandomSpin::Horizontal { rate } => rate,
        };
        rate.check(
            ["low end of the spin rate", "width of the spin rates"],
            " rad/s",
        )
    }

    /// Rotation from body to world axes.
    fn rotation(&self, [phase, tilt, third]: [f64; 3]) -> Rotation<f64> {
        match self.orientation {
            RandomOrientation::Uniform => uniform_rotation([phase, tilt, third]),
            RandomOrientation::Tilted {
                axis,
                tilt: angles,
                phase: phases,
            } => {
                let about = |axis: Vec3, angle| Rotation::from_rotation_vector(axis * angle);
                let leaning = about(Vec3::Y, angles.at(tilt));
                leaning
                    .after(about(Vec3::Z, phases.at(phase)))
                    .after(raising(axis))
            }
        }
    }

    /// Angular velocity, rad/s, world axes.
    fn angular_velocity(&self, rotation: Rotation<f64>, numbers: [f64; 3]) -> Vec3 {
        let [rate, heading, rise] = numbers;
        let (sin, cos) = sin_cos(TAU * heading);
        match self.spin {
            RandomSpin::World { axis, rate: rates } => unit(axis) * rates.at(rate),
            RandomSpin::Body { axis, rate: rates } => rotation.apply(unit(axis)) * rates.at(rate),
            RandomSpin::Isotropic { rate: rates } => {
                // Archimedes: the height of a point that is uniform on the sphere is uniform.
                let z = 2.0 * rise - 1.0;
                let level = (1.0 - z * z).sqrt();
                Vec3::new(level * cos, level * sin, z) * rates.at(rate)
            }
            RandomSpin::Horizontal { rate: rates } => Vec3::new(cos, sin, 0.0) * rates.at(rate),
        }
    }
}

impl<R: Real> StartDistribution<R> for RandomStart {
    fn check(&self) -> Result<(), SceneError> {
        if let RandomOrientation::Tilted { axis, tilt, phase } = self.orientation {
            check_axis("length of the tilted axis", axis)?;
            tilt.check(["low end of the tilt", "width of the tilts"], " rad")?;
            phase.check(["low end of the phase", "width of the phases"], " rad")?;
        }
        self.check_spin()?;
        let height = ["low end of the height", "width of the heights"];
        self.height.check(height, " m")?;
        check_axis("length of the direction", self.direction)?;
        let speed = ["low end of the speed", "width of the speeds"];
        self.speed.check(speed, " m/s")?;
        let strata = |rule, strata| {
            Err(SceneError::new(
                "number of strata",
                rule,
                f64::from(strata),
                "",
            ))
        };
        match self.sampling {
            Sampling::StratifiedPhase { strata: 0 } | Sampling::Latin { strata: 0 } => {
                strata(Rule::AtLeast(1), 0)
            }
            Sampling::Latin { strata: many } if many > MOST_STRATA => {
                strata(Rule::AtMost(MOST_STRATA as usize), many)
            }
            _ => Ok(()),
        }
    }

    fn draw(
        &self,
        inertia: &InertiaProperties<R>,
        toss: &mut Toss<'_>,
    ) -> Result<State<R>, TossError> {
        let numbers = random_numbers(self.sampling, toss);
        let [phase, tilt, third, rate, heading, rise, height, speed] = numbers;
        let rotation = self.rotation([phase, tilt, third]);
        let spin = self.angular_velocity(rotation, [rate, heading, rise]);
        let [x, y, z, w] = rotation.to_quat().xyzw().map(R::from_f64);
        let position = converted::<R>(Vec3::Z * self.height.at(height));
        let state = State::<R>::at(position)
            .with_orientation(R::Quat::new(x, y, z, w))
            .with_linear_velocity(converted::<R>(unit(self.direction) * self.speed.at(speed)));
        let momentum = inertia.angular_momentum(&state.rotation().axes(), converted::<R>(spin));
        Ok(state.with_angular_momentum(momentum))
    }
}

/// Uniform numbers of a start: one for each parameter, whether it is used or not.
fn random_numbers(sampling: Sampling, toss: &mut Toss<'_>) -> [f64; 8] {
    [0, 1, 2, 3, 4, 5, 6, 7].map(|coordinate| match sampling {
        Sampling::StratifiedPhase { strata } if coordinate == 0 => toss.stratified(strata),
        Sampling::Latin { strata } => toss.latin(strata, coordinate),
        _ => toss.fraction(),
    })
}

/// Rotation that is uniform for three uniform numbers.
fn uniform_rotation([phase, share, third]: [f64; 3]) -> Rotation<f64> {
    let (small, large) = ((1.0 - share).max(0.0).sqrt(), share.sqrt());
    let ([sin1, cos1], [sin2, cos2]) = (
        <[f64; 2]>::from(sin_cos(TAU * phase)),
        <[f64; 2]>::from(sin_cos(TAU * third)),
    );
    let quaternion = Quaternion::new(small * sin1, small * cos1, large * sin2, large * cos2);
    Rotation::from_quat(quaternion)
}

/// Shortest rotation of an axis of the body to world z.
fn raising(axis: Vec3) -> Rotation<f64> {
    let axis = unit(axis);
    // `1 + a·z + a × z` has half of the angle between a and z. Near -z it loses its digits, so the
    // axis is first rotated by half a revolution about x.
    if axis.z < -0.5 {
        let upward = Vec3::new(axis.x, -axis.y, -axis.z);
        return raising(upward).after(Rotation::from_quat(Quaternion::new(1.0, 0.0, 0.0, 0.0)));
    }
    Rotation::from_quat(Quaternion::new(axis.y, -axis.x, 0.0, 1.0 + axis.z))
}

fn unit(axis: Vec3) -> Vec3 {
    // By a power of two, which changes no bit of the direction.
    let axis = scaled::<f64>(axis);
    axis / Vector::length(axis)
}

/// Sine and cosine with the same bits everywhere, which those of `std` have not.
fn sin_cos(angle: f64) -> (f64, f64) {
    <f64 as Real>::sin_cos(angle)
}

fn check_axis(quantity: &'static str, axis: Vec3) -> Result<(), SceneError> {
    // The length of a valid axis may overflow or underflow.
    let length = if axis.is_finite() {
        axis.abs().max_element()
    } else {
        Vector::length(axis)
    };
    error::above_zero(quantity, length, "")
}

fn converted<R: Real>(vector: Vec3) -> R::Vec3 {
    let [x, y, z] = [vector.x, vector.y, vector.z].map(R::from_f64);
    R::Vec3::new(x, y, z)
}
