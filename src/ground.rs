//! The ground: where it is, and how it pushes back.
//!
//! | you want | take |
//! |---|---|
//! | a plane with springs and dampers | [`FlatGround::level`], tilted or raised by [`on`](FlatGround::on) a [`Plane`] |
//! | one that is made for a bounce, or for how far a body sinks | [`Ground::level`] of [`SpringDamper::from_bounce`] or [`from_rest`](SpringDamper::from_rest), with the body that is [`Carried`] |
//! | another law of contact | [`Ground::level`] of [`LimitedDamper`] or [`HuntCrossley`]; [`ContactLaw`] says which when |
//! | hills, valleys, bowls, waves | [`Ground`] of a law and a [`Terrain`] |
//! | none: flight | [`NoGround`], which a scene has until it is given another |
//! | your own | [`Shape`], [`ContactLaw`] or [`SpringDamperGround`]: [`guide::extending::ground`](crate::guide::extending::ground) |

mod composed;
mod flat;
mod law;
mod shape;

pub use composed::Ground;
pub use flat::FlatGround;
pub use law::{Carried, ContactLaw, HuntCrossley, LimitedDamper, SpringDamper};
pub use shape::{Bowl, Elevation, HeightField, Ramp, Shape, Terrain, Waves};

use law::mean_force_by_quadrature;

use crate::error::{self, Rule, SceneError};
use crate::real::{Real, Vector};

/// A ground of springs and dampers.
///
/// *To the caller:* a contact whose `depth` (m, `radius - gap`) is above 0 is pushed along the
/// surface's outward normal by [`normal_force`](Self::normal_force) (N, never below 0).
///
/// *To the implementer:* [`spring_energy`](Self::spring_energy) must be the integral of
/// [`spring_force`](Self::spring_force) from depth 0, and the damper must take energy:
/// `(normal_force - spring_force) * closing_speed >= 0` whatever the depth and speed. Nothing is
/// asked at or above the surface. No value is NaN, at any depth above 0: a step evaluates trial
/// states that the motion never reaches. A step returns
/// [`StepError::BrokenLaw`](crate::StepError::BrokenLaw) for a NaN, a negative spring energy, and a
/// normal whose length is not 1. [`contract::check_ground`](crate::contract::check_ground) tests an
/// implementation.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{GroundBounds, Plane, SpringDamperGround, Surface};
///
/// /// A level ground that stiffens: force `k d + c d³`.
/// struct Rubber {
///     k: f64,
///     c: f64,
/// }
///
/// impl SpringDamperGround for Rubber {
///     fn surface(&self, point: DVec3) -> Surface {
///         Surface { gap: point.z, normal: DVec3::Z }
///     }
///     fn spring_force(&self, depth: f64) -> f64 {
///         (self.k + self.c * depth * depth) * depth
///     }
///     fn spring_energy(&self, depth: f64) -> f64 {
///         (self.k / 2.0 + self.c / 4.0 * depth * depth) * depth * depth
///     }
///     fn normal_force(&self, depth: f64, _closing_speed: f64) -> f64 {
///         self.spring_force(depth)
///     }
///     fn bounds(&self) -> GroundBounds {
///         GroundBounds::Plane(Plane::level(0.0))
///     }
/// }
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a ground: it does not implement `SpringDamperGround<{R}>`",
    label = "this should be a ground",
    note = "a `Shape`, such as `Plane` or `Terrain`, becomes a ground with a law: `Ground {{ law: SpringDamper {{ stiffness, damping }}, shape }}`",
    note = "implement `surface`, `spring_force`, `spring_energy` and `normal_force`; the precision `{R}` of body, ground, friction and gravity must be the same"
)]
pub trait SpringDamperGround<R: Real = f64> {
    /// The surface as seen from `point` (m, world axes): how far below it lies, and which way out
    /// is.
    fn surface(&self, point: R::Vec3) -> Surface<R>;

    /// Elastic force of one contact at a depth (m) above 0: N, at least 0.
    fn spring_force(&self, depth: R) -> R;

    /// Energy in the springs under one contact at a depth (m) above 0: J, the integral of
    /// [`spring_force`](Self::spring_force) from 0.
    fn spring_energy(&self, depth: R) -> R;

    /// Spring and damper together: force (N) on one contact at a depth (m) above 0 that goes deeper
    /// at `closing_speed` (m/s; negative while it leaves).
    ///
    /// Never below 0: the ground does not pull.
    fn normal_force(&self, depth: R, closing_speed: R) -> R;

    /// Mean force on one contact while its depth goes evenly from `start` to `end` (m; below 0 is
    /// above ground) in `seconds`, with its derivatives.
    ///
    /// This is what an implicit step needs of a ground. The provided method takes the spring's
    /// share from [`spring_energy`](Self::spring_energy), `ΔV/Δd`, so that the springs give back
    /// what they took, and the rest of [`normal_force`](Self::normal_force) by Gauss's rule with
    /// three points, each of which takes energy. A law with a closed form should override it: the
    /// provided method costs some twenty evaluations.
    #[inline]
    fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        mean_force_by_quadrature(&LawOf(self), start, end, seconds)
    }

    /// Where the ground can be at all. The default is everywhere; a ground that names a plane lets
    /// a body high above it move without a look at its contacts.
    #[inline]
    fn bounds(&self) -> GroundBounds<R> {
        GroundBounds::Everywhere
    }

    /// Whether the ground can be: called once, when a scene is composed.
    ///
    /// # Errors
    /// Names the quantity, the rule that it breaks, and its value.
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }

    /// Returns true if the values of the ground need no check while a step evaluates them. Default:
    /// false.
    ///
    /// A step checks the values of a law that is not trusted, and returns
    /// [`StepError::BrokenLaw`](crate::StepError::BrokenLaw) if one breaks the contract.
    /// Override it if the law keeps its contract for every finite input, and
    /// [`check_ground`](crate::contract::check_ground) finds nothing: the checks then cost nothing.
    /// A trusted law that breaks its contract goes unnoticed.
    #[inline]
    fn is_trusted(&self) -> bool {
        false
    }
}

/// Behind a pointer, also as `dyn`.
macro_rules! forward {
    ($pointer:ty) => {
        impl<R: Real, G: SpringDamperGround<R> + ?Sized> SpringDamperGround<R> for $pointer {
            #[inline]
            fn surface(&self, point: R::Vec3) -> Surface<R> {
                (**self).surface(point)
            }
            #[inline]
            fn spring_force(&self, depth: R) -> R {
                (**self).spring_force(depth)
            }
            #[inline]
            fn spring_energy(&self, depth: R) -> R {
                (**self).spring_energy(depth)
            }
            #[inline]
            fn normal_force(&self, depth: R, closing_speed: R) -> R {
                (**self).normal_force(depth, closing_speed)
            }
            #[inline]
            fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
                (**self).mean_force(start, end, seconds)
            }
            #[inline]
            fn bounds(&self) -> GroundBounds<R> {
                (**self).bounds()
            }
            #[inline]
            fn check(&self) -> Result<(), SceneError> {
                (**self).check()
            }
            #[inline]
            fn is_trusted(&self) -> bool {
                (**self).is_trusted()
            }
        }
    };
}
forward!(&G);
#[cfg(feature = "std")]
forward!(alloc::boxed::Box<G>);

/// The ground's surface as seen from a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface<R: Real = f64> {
    /// Height of the point above the surface, m; negative below it.
    pub gap: R,
    /// Outward normal of the surface, unit vector, world axes.
    pub normal: R::Vec3,
}

/// The mean normal force over a step, and how it answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanForce<R: Real = f64> {
    /// N, at least 0.
    pub force: R,
    /// Derivative of the force with respect to the depth at the end, N/m, at least 0.
    pub slope: R,
    /// The springs' share of the slope, N/m, at least 0.
    pub stiffness: R,
    /// Resistance of the dampers to closing speed, averaged over the step, N s/m, at least 0.
    pub damping: R,
}

impl<R: Real> MeanForce<R> {
    /// No force, and none to come with a little more depth.
    pub const NONE: Self = Self {
        force: R::ZERO,
        slope: R::ZERO,
        stiffness: R::ZERO,
        damping: R::ZERO,
    };
}

/// A ground's law without its surface.
struct LawOf<'a, G: ?Sized>(&'a G);

impl<R: Real, G: SpringDamperGround<R> + ?Sized> ContactLaw<R> for LawOf<'_, G> {
    #[inline]
    fn spring_force(&self, depth: R) -> R {
        self.0.spring_force(depth)
    }
    #[inline]
    fn spring_energy(&self, depth: R) -> R {
        self.0.spring_energy(depth)
    }
    #[inline]
    fn normal_force(&self, depth: R, closing_speed: R) -> R {
        self.0.normal_force(depth, closing_speed)
    }
}

/// Where a ground can be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GroundBounds<R: Real = f64> {
    /// Nowhere: nothing ever touches.
    Nowhere,
    /// The ground's surface is this plane: `gap` and `normal` of
    /// [`surface`](SpringDamperGround::surface) are the plane's.
    Plane(Plane<R>),
    /// Nothing that lies above this plane touches.
    Below(Plane<R>),
    /// Anywhere.
    Everywhere,
}

/// The points with `normal · point = height`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "R: serde::Serialize, R::Vec3: serde::Serialize",
        deserialize = "R: serde::Deserialize<'de>, R::Vec3: serde::Deserialize<'de>"
    ))
)]
pub struct Plane<R: Real = f64> {
    /// Unit vector, world axes, pointing out of the ground.
    pub normal: R::Vec3,
    /// Distance of the plane from the origin along `normal`, m.
    pub height: R,
}

impl<R: Real> Plane<R> {
    /// The horizontal plane z = `height` (m).
    #[must_use]
    pub fn level(height: R) -> Self {
        Self {
            normal: R::Vec3::new(R::ZERO, R::ZERO, R::ONE),
            height,
        }
    }

    /// The plane through `point` (m) at right angles to `normal` (any length above 0; not finite
    /// for 0).
    #[must_use]
    pub fn through(point: R::Vec3, normal: R::Vec3) -> Self {
        let normal = normal * (R::ONE / normal.length());
        Self {
            normal,
            height: normal.dot(point),
        }
    }

    /// Whether the plane is horizontal.
    #[inline]
    pub(crate) fn is_level(&self) -> bool {
        self.normal == Self::level(self.height).normal
    }

    /// Height of `point` (m, world axes) above the plane, m; negative below it.
    #[inline]
    #[must_use]
    pub fn gap(&self, point: R::Vec3) -> R {
        self.normal.dot(point) - self.height
    }

    /// That the normal has length 1 (to 16 units in the last place) and the height is finite.
    ///
    /// # Errors
    /// Names the quantity that is not so.
    pub fn check(&self) -> Result<(), SceneError> {
        let length = self.normal.length();
        let close = (length - R::ONE).abs() <= R::EPSILON * R::from_f64(16.0);
        if !close {
            let value = length.to_f64();
            return Err(SceneError::new(
                "normal of the plane",
                Rule::UnitLength,
                value,
                "",
            ));
        }
        error::finite("height of the plane", self.height, " m")
    }
}

/// Empty space: nothing to touch, nothing to compute.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NoGround;

impl<R: Real> SpringDamperGround<R> for NoGround {
    #[inline]
    fn surface(&self, _point: R::Vec3) -> Surface<R> {
        Surface {
            gap: R::MAX,
            normal: R::Vec3::new(R::ZERO, R::ZERO, R::ONE),
        }
    }
    #[inline]
    fn spring_force(&self, _depth: R) -> R {
        R::ZERO
    }
    #[inline]
    fn spring_energy(&self, _depth: R) -> R {
        R::ZERO
    }
    #[inline]
    fn normal_force(&self, _depth: R, _closing_speed: R) -> R {
        R::ZERO
    }
    #[inline]
    fn mean_force(&self, _start: R, _end: R, _seconds: R) -> MeanForce<R> {
        MeanForce::NONE
    }
    #[inline]
    fn bounds(&self) -> GroundBounds<R> {
        GroundBounds::Nowhere
    }
    #[inline]
    fn is_trusted(&self) -> bool {
        true
    }
}
