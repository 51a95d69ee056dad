//! Friction with one law in a region of the ground and another law around it.

use super::metric::isotropic;
use super::several::check_is_one;
use super::{FrictionJacobian, RollingResistance, SlidingFriction};
use crate::error::{self, Rule, SceneError};
use crate::real::{Real, Vector};

/// Friction with one law inside a region of the ground and another law outside: an ice patch, a
/// carpet.
///
/// The law of a contact is `inside` if the region contains the contact, and `outside` otherwise.
/// The contacts of a body may be on both sides. The force is that of one of the two laws, so it
/// never adds energy. Either law may be a `FrictionPatch` itself.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{Coulomb, FlatGround, FrictionPatch, PointCloud, Region, State, Stepper};
/// use tumble::UniformGravity;
///
/// // A strip of ice, 0.5 m wide, across the way.
/// let rough = Coulomb { coefficient: 0.4, slip_speed: 1e-5 }; // -, m/s
/// let ice = Coulomb { coefficient: 0.05, ..rough };
/// let floor = FrictionPatch {
///     outside: rough,
///     inside: ice,
///     region: Region::Strip { across: DVec3::X, from: 0.5, to: 1.0 }, // m
/// };
/// let stepper = Stepper::builder(PointCloud::new([DVec3::ZERO], [1.0])?) // kg
///     .gravity(UniformGravity::down(9.8)) // m/s²
///     .ground(FlatGround::level(1e4, 50.0)) // N/m, N s/m
///     .friction(floor)
///     .build()?;
/// let mut state = State::at(DVec3::Z * -9.8e-4).with_linear_velocity(DVec3::X * 2.5); // m, m/s
/// stepper.advance(&mut state, 2.0)?; // s
/// // v²/(2 g) = μ₁ (s - w) + μ₂ w, with the width w of the strip.
/// let stops = (2.5 * 2.5 / (2.0 * 9.8) - 0.05 * 0.5) / 0.4 + 0.5;
/// // In a step of 1 ms that crosses an edge, the deceleration is wrong by up to 0.35 g.
/// assert!((state.position.x - stops).abs() < 2e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// *Limits:* those of [`FrictionField`](super::FrictionField) at a jump. Only friction may vary
/// over the ground. Springs may not, because they store energy:
/// [`Ground`](crate::Ground#uniform-law) derives why.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "R: serde::Serialize, R::Vec3: serde::Serialize, O: serde::Serialize, I: serde::Serialize",
        deserialize = "R: serde::Deserialize<'de>, R::Vec3: serde::Deserialize<'de>, O: serde::Deserialize<'de>, I: serde::Deserialize<'de>"
    ))
)]
pub struct FrictionPatch<O, I, R: Real = f64> {
    /// Law outside the region.
    pub outside: O,
    /// Law inside the region.
    pub inside: I,
    /// Region of the second law.
    pub region: Region<R>,
}

/// Region of space in which another friction law holds.
///
/// On a plane ground, a half-space is a half-plane, and a ball around a point of the ground is a
/// disc.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "R: serde::Serialize, R::Vec3: serde::Serialize",
        deserialize = "R: serde::Deserialize<'de>, R::Vec3: serde::Deserialize<'de>"
    ))
)]
#[non_exhaustive]
pub enum Region<R: Real = f64> {
    /// Points `x` with `across · x >= from`.
    HalfSpace {
        /// Unit vector into the region, world axes.
        across: R::Vec3,
        /// Distance of the edge from the origin along `across`, m.
        from: R,
    },
    /// Points `x` with `from <= across · x <= to`.
    Strip {
        /// Unit vector across the strip, world axes.
        across: R::Vec3,
        /// Distance of the first edge from the origin along `across`, m.
        from: R,
        /// Distance of the second edge from the origin along `across`, m, at least `from`.
        to: R,
    },
    /// Points at most `radius` from `centre`.
    Ball {
        /// Centre, m, world axes.
        centre: R::Vec3,
        /// Radius, m, at least 0.
        radius: R,
    },
}

impl<R: Real> Region<R> {
    /// Returns true if the region contains a position (m, world axes). Its boundary belongs to it.
    #[inline]
    #[must_use]
    pub fn contains(&self, position: R::Vec3) -> bool {
        match *self {
            Self::HalfSpace { across, from } => across.dot(position) >= from,
            Self::Strip { across, from, to } => {
                let along = across.dot(position);
                from <= along && along <= to
            }
            Self::Ball { centre, radius } => (position - centre).length() <= radius,
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        match *self {
            Self::HalfSpace { across, from } => {
                check_unit::<R>(across)?;
                error::finite("edge of the friction region", from, " m")
            }
            Self::Strip { across, from, to } => {
                check_unit::<R>(across)?;
                error::finite("lower edge of the friction region", from, " m")?;
                error::finite("upper edge of the friction region", to, " m")?;
                error::at_least_zero("width of the friction region", to - from, " m")
            }
            Self::Ball { centre, radius } => {
                error::finite("x of the centre of the friction region", centre.x(), " m")?;
                error::finite("y of the centre of the friction region", centre.y(), " m")?;
                error::finite("z of the centre of the friction region", centre.z(), " m")?;
                error::at_least_zero("radius of the friction region", radius, " m")
            }
        }
    }
}

fn check_unit<R: Real>(direction: R::Vec3) -> Result<(), SceneError> {
    let length = direction.length();
    let is_one = (length - R::ONE).abs() <= R::EPSILON * R::from_f64(16.0);
    let quantity = "direction of the friction region";
    let error = SceneError::new(quantity, Rule::UnitLength, length.to_f64(), "");
    if is_one { Ok(()) } else { Err(error) }
}

impl<O, I, R: Real> SlidingFriction<R> for FrictionPatch<O, I, R>
where
    O: SlidingFriction<R>,
    I: SlidingFriction<R>,
{
    #[inline]
    fn is_proportional_to_load(&self) -> bool {
        self.outside.is_proportional_to_load() && self.inside.is_proportional_to_load()
    }

    #[inline]
    fn is_trusted(&self) -> bool {
        self.outside.is_trusted() && self.inside.is_trusted()
    }

    #[inline]
    fn force(&self, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        self.force_at(R::Vec3::ZERO, normal_force, slip)
    }

    #[inline]
    fn force_at(&self, position: R::Vec3, normal_force: R, slip: R::Vec3) -> R::Vec3 {
        if self.region.contains(position) {
            self.inside.force_at(position, normal_force, slip)
        } else {
            self.outside.force_at(position, normal_force, slip)
        }
    }

    #[inline]
    fn jacobian(&self, normal_force: R, slip: R::Vec3) -> FrictionJacobian<R> {
        self.jacobian_at(R::Vec3::ZERO, normal_force, slip)
    }

    #[inline]
    fn jacobian_at(
        &self,
        position: R::Vec3,
        normal_force: R,
        slip: R::Vec3,
    ) -> FrictionJacobian<R> {
        if self.region.contains(position) {
            self.inside.jacobian_at(position, normal_force, slip)
        } else {
            self.outside.jacobian_at(position, normal_force, slip)
        }
    }

    #[inline]
    fn metric_at(&self, position: R::Vec3) -> Option<[R::Vec3; 3]> {
        let (inside, outside) = (
            self.inside.metric_at(position),
            self.outside.metric_at(position),
        );
        let (here, there) = if self.region.contains(position) {
            (inside, outside)
        } else {
            (outside, inside)
        };
        // A law has a metric everywhere or nowhere.
        here.or(there.map(|_| isotropic::<R>()))
    }

    #[inline]
    fn rolling_resistance(&self, normal_force: R) -> Option<RollingResistance<R>> {
        self.rolling_resistance_at(R::Vec3::ZERO, normal_force)
    }

    #[inline]
    fn rolling_resistance_at(
        &self,
        position: R::Vec3,
        normal_force: R,
    ) -> Option<RollingResistance<R>> {
        let [inside, outside] = [
            self.inside.rolling_resistance_at(position, normal_force),
            self.outside.rolling_resistance_at(position, normal_force),
        ];
        let (here, there) = if self.region.contains(position) {
            (inside, outside)
        } else {
            (outside, inside)
        };
        // A law has a resistance everywhere or nowhere, so that of a law without one is 0.
        here.or(there.map(|there| RollingResistance {
            rolling: R::ZERO,
            spinning: R::ZERO,
            ..there
        }))
    }

    #[inline]
    fn depends_on_position(&self) -> bool {
        true
    }

    fn check(&self) -> Result<(), SceneError> {
        self.region.check()?;
        check_is_one(&self.outside)?;
        check_is_one(&self.inside)?;
        self.outside.check()?;
        self.inside.check()
    }
}
