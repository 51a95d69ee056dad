//! Ground models: the surface of a ground and its contact force.
//!
//! | to model | use |
//! |---|---|
//! | a plane with springs and dampers | [`FlatGround::level`], tilted or raised by [`on`](FlatGround::on) a [`Plane`] |
//! | a spring and damper fitted to a bounce, or to the penetration depth at rest | [`Ground::level`] of [`SpringDamper::from_bounce`] or [`from_rest`](SpringDamper::from_rest), with the body's [`Carried`] mass |
//! | another contact law | [`Ground::level`] of [`LimitedDamper`] or [`HuntCrossley`]; [`ContactLaw`] compares the laws |
//! | hills, valleys, bowls, waves | [`Ground`] of a law and a [`Terrain`] |
//! | a conveyor or a turntable | [`MovingGround`] of any of these |
//! | a table with an edge, a step, a post | [`Ground`] of a law and a [`Block`] |
//! | a floor and walls, a groove, a lid | a tuple or an array of any of these: [several surfaces](SpringDamperGround#several-surfaces) |
//! | flight without ground | [`NoGround`], the default of a scene |
//! | your own ground | [`Shape`], [`ContactLaw`] or [`SpringDamperGround`]: [`guide::extending::ground`](crate::guide::extending::ground) |

mod composed;
mod flat;
mod law;
mod motion;
mod several;
mod shape;

pub use composed::Ground;
pub use flat::FlatGround;
pub use law::{Carried, ContactLaw, HuntCrossley, Impact, LimitedDamper, SpringDamper};
pub use motion::{GroundMotion, MovingGround};
pub(crate) use several::OneSurface;
pub use shape::{Block, Bowl, Elevation, HeightField, Ramp, Shape, Terrain, Waves};

use law::mean_force_by_quadrature;

use crate::error::{self, Rule, SceneError};
use crate::real::{Real, Vector, unit};

/// A ground that acts on each contact by a spring and a damper.
///
/// *To the caller:* a contact whose penetration depth (m, `radius - gap`) is above 0 is pushed
/// along the outward normal of the surface. [`normal_force`](Self::normal_force) returns this force
/// (N, never below 0).
///
/// *To the implementer:* an implementation must keep this contract:
///
/// * [`spring_energy`](Self::spring_energy) is the integral of [`spring_force`](Self::spring_force)
///   from depth 0.
/// * The damper dissipates energy: `(normal_force - spring_force) * closing_speed >= 0` at every
///   depth and speed.
/// * Neither [`spring_force`](Self::spring_force) nor [`spring_energy`](Self::spring_energy) nor
///   [`normal_force`](Self::normal_force) is NaN at any finite depth above 0 and any finite speed.
///   They may be infinite. A step evaluates trial states that the motion never reaches.
///
/// The forces and the energy are never evaluated at or above the surface. A step returns
/// [`StepError::BrokenLaw`](crate::StepError::BrokenLaw) for a NaN, for a negative spring energy,
/// and for a normal whose length is not 1.
/// [`contract::check_ground`](crate::contract::check_ground) tests an implementation.
///
/// # Several surfaces
///
/// A tuple of two to six grounds, an array or a slice of grounds is a ground of several surfaces. A
/// contact presses on each surface that it penetrates, with the law of that surface. So the energy
/// in the springs and the forces are sums over contacts and surfaces.
///
/// ```
/// use tumble::glam::DVec3;
/// use tumble::{FlatGround, Plane, Sphere, Stepper};
///
/// // A groove of 90 degrees.
/// let wall = |x: f64| {
///     FlatGround::level(1e4, 1.0).on(Plane::through(DVec3::ZERO, DVec3::new(x, 0.0, 1.0)))
/// };
/// let stepper = Stepper::new(Sphere::solid(0.1, 0.02))?.with_ground([wall(1.0), wall(-1.0)])?;
/// # Ok::<(), tumble::SceneError>(())
/// ```
///
/// * *Friction:* one law for all surfaces, or a tuple or an array with
///   [one law for each](crate::SlidingFriction#several-surfaces).
/// * *Edges:* a half-space has none. A [`Block`] has faces and edges. A contact beyond an edge has
///   no force from it.
/// * *Motion:* the surfaces are at rest, or [`MovingGround`] moves all of them as one. A surface
///   that moves among others is refused when a scene is composed. The work of moving ground follows
///   from the momentum that all contacts give in a step, and the part of each surface is not known.
///   For a belt beside a table use two steppers, and advance the state by that of the surface under
///   the body. A body on both at once cannot be computed.
/// * *The methods of the whole:* [`surface`](Self::surface) is the surface nearest to a point, and
///   the laws are those of the first surface. A step evaluates each surface through
///   [`with_surface`](Self::with_surface) instead.
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
    /// Returns the signed distance of `point` (m, world axes) from the surface, and the outward
    /// normal of the surface there.
    ///
    /// The gap must be a distance: a small displacement of the point changes it by
    /// `normal · displacement`. Otherwise the springs create or destroy energy as a contact moves
    /// along the surface. For a height z = h(x, y) use a [`Terrain`].
    fn surface(&self, point: R::Vec3) -> Surface<R>;

    /// Returns the surface as [`surface`](Self::surface) does, or `None` if a contact with this
    /// centre (m, world axes) and radius (m) certainly does not touch it.
    ///
    /// Override this method if that is cheaper to find out than the distance. A step asks for each
    /// contact that the [`bounds`](Self::bounds) do not exclude. Default: the surface.
    #[inline]
    fn surface_under(&self, centre: R::Vec3, radius: R) -> Option<Surface<R>> {
        let _ = radius;
        Some(self.surface(centre))
    }

    /// Elastic force of one contact at a depth (m) above 0: N, at least 0.
    fn spring_force(&self, depth: R) -> R;

    /// Energy in the springs of one contact at a depth (m) above 0: J, the integral of
    /// [`spring_force`](Self::spring_force) from 0.
    fn spring_energy(&self, depth: R) -> R;

    /// Force of spring and damper (N) on one contact at a depth (m) above 0. The depth increases at
    /// `closing_speed` (m/s), which is negative during rebound.
    ///
    /// The force is never below 0: the ground does not pull.
    fn normal_force(&self, depth: R, closing_speed: R) -> R;

    /// Mean force on one contact, with its derivatives, while the depth changes at a constant rate
    /// from `start` to `end` (m; below 0 is above ground) in `seconds`, above 0.
    ///
    /// Implicit integrators use this method. The provided method computes the mean force of the
    /// spring from [`spring_energy`](Self::spring_energy), as `ΔV/Δd`, so that the springs return
    /// exactly the energy that they stored. It integrates the rest of
    /// [`normal_force`](Self::normal_force) by Gauss's rule with three points, each of which
    /// dissipates energy. It costs about twenty evaluations, so a law with a closed form should
    /// override it.
    #[inline]
    fn mean_force(&self, start: R, end: R, seconds: R) -> MeanForce<R> {
        mean_force_by_quadrature(&LawOf(self), start, end, seconds)
    }

    /// Region that the ground can occupy. Default: everywhere.
    ///
    /// If the bounds are a plane, a body high above it moves without an evaluation of its contacts.
    #[inline]
    fn bounds(&self) -> GroundBounds<R> {
        GroundBounds::Everywhere
    }

    /// Number of surfaces, if the ground is made of several. Default: `None`, it is one surface.
    ///
    /// A ground that returns `Some` must also override [`with_surface`](Self::with_surface).
    /// Otherwise its surfaces exert no force. See [several surfaces](Self#several-surfaces).
    #[inline]
    fn surfaces(&self) -> Option<usize> {
        None
    }

    /// Calls `visit` once with one of [several](Self::surfaces) surfaces, as a ground of its own.
    /// Default: does nothing.
    ///
    /// The index is below the number of surfaces. The surface itself is not made of several.
    #[inline]
    fn with_surface(&self, index: usize, visit: &mut dyn FnMut(&dyn SpringDamperGround<R>)) {
        let _ = (index, visit);
    }

    /// Motion of the ground's material along its surface, or `None` if it is at rest. Default:
    /// `None`.
    ///
    /// Friction acts on the slip relative to the material. The returned motion never changes, and
    /// the material never moves across the surface. See [`MovingGround`].
    #[inline]
    fn motion(&self) -> Option<GroundMotion<R>> {
        None
    }

    /// Checks that the ground is valid. Called once, when a scene is composed.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a quantity is invalid. The error names the quantity, the rule and
    /// the value.
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }

    /// Returns true if the values of the ground need no check while a step evaluates them. Default:
    /// false.
    ///
    /// A step checks some values of a law that is not trusted, and returns
    /// [`StepError::BrokenLaw`](crate::StepError::BrokenLaw) if they break the contract: that no
    /// gap, force or energy is NaN, that the spring energy is not negative, and that the normal has
    /// length 1. Infinite values count as an overflow, not as a broken contract. It does not check
    /// that the ground never pulls or that its damper dissipates, as
    /// [`check_ground`](crate::contract::check_ground) does. [`Rk4`](crate::Rk4) and
    /// [`Nystrom`](crate::Nystrom) check the values of their last stage. Override this method if
    /// the law keeps its contract for every finite input, and `check_ground` finds no fault. The
    /// checks then cost nothing. A trusted law that breaks its contract is not detected.
    #[inline]
    fn is_trusted(&self) -> bool {
        false
    }
}

/// Implements the trait for a pointer to a ground, also to `dyn`.
macro_rules! forward {
    ($pointer:ty) => {
        impl<R: Real, G: SpringDamperGround<R> + ?Sized> SpringDamperGround<R> for $pointer {
            #[inline]
            fn surface(&self, point: R::Vec3) -> Surface<R> {
                (**self).surface(point)
            }
            #[inline]
            fn surface_under(&self, centre: R::Vec3, radius: R) -> Option<Surface<R>> {
                (**self).surface_under(centre, radius)
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
            fn surfaces(&self) -> Option<usize> {
                (**self).surfaces()
            }
            #[inline]
            fn with_surface(
                &self,
                index: usize,
                visit: &mut dyn FnMut(&dyn SpringDamperGround<R>),
            ) {
                (**self).with_surface(index, visit);
            }
            #[inline]
            fn motion(&self) -> Option<GroundMotion<R>> {
                (**self).motion()
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

/// The surface of the ground relative to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface<R: Real = f64> {
    /// Signed distance of the point from the surface, m: positive above it, negative below it.
    pub gap: R,
    /// Outward normal of the surface, unit vector, world axes.
    pub normal: R::Vec3,
}

/// Mean normal force over a step, with its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanForce<R: Real = f64> {
    /// Mean normal force, N, at least 0.
    pub force: R,
    /// Derivative of the force with respect to the depth at the end, N/m, at least 0.
    pub slope: R,
    /// Part of the slope that does not act through the closing speed, N/m, at least 0: `k/2` for
    /// a linear spring. An estimate if the damper's force depends on the depth.
    pub stiffness: R,
    /// Damping coefficient averaged over the step, N s/m, at least 0: `c` for a linear damper. An
    /// estimate, such as force per speed, if the damper's force is not proportional to the speed.
    pub damping: R,
}

impl<R: Real> MeanForce<R> {
    /// Zero force with zero derivatives.
    pub const NONE: Self = Self {
        force: R::ZERO,
        slope: R::ZERO,
        stiffness: R::ZERO,
        damping: R::ZERO,
    };
}

/// Contact law of a ground, without its surface.
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

/// Region that a ground can occupy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GroundBounds<R: Real = f64> {
    /// Nowhere. No contact ever touches.
    Nowhere,
    /// The ground's surface is this plane: `gap` and `normal` of
    /// [`surface`](SpringDamperGround::surface) are the plane's.
    Plane(Plane<R>),
    /// Region below this plane. No contact above the plane touches.
    Below(Plane<R>),
    /// Everywhere. Every contact is evaluated.
    Everywhere,
}

impl<R: Real> GroundBounds<R> {
    /// Checks the plane, if there is one.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the plane is invalid.
    pub(crate) fn check(&self) -> Result<(), SceneError> {
        match self {
            Self::Plane(plane) | Self::Below(plane) => plane.check(),
            Self::Nowhere | Self::Everywhere => Ok(()),
        }
    }
}

/// Plane of the points with `normal · point = height`.
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
    /// Outward normal of the ground, unit vector, world axes.
    pub normal: R::Vec3,
    /// Signed distance of the plane from the origin along `normal`, m.
    pub height: R,
}

impl<R: Real> Plane<R> {
    /// Creates the horizontal plane z = `height` (m).
    #[must_use]
    pub fn level(height: R) -> Self {
        Self {
            normal: R::Vec3::new(R::ZERO, R::ZERO, R::ONE),
            height,
        }
    }

    /// Creates the plane through `point` (m) perpendicular to `normal`.
    ///
    /// The normal has any length above 0. A normal of length 0 gives a plane that is not finite.
    #[must_use]
    pub fn through(point: R::Vec3, normal: R::Vec3) -> Self {
        let normal = unit::<R>(normal);
        Self {
            normal,
            height: normal.dot(point),
        }
    }

    /// Returns true if the plane is horizontal.
    #[inline]
    pub(crate) fn is_level(&self) -> bool {
        self.normal == Self::level(self.height).normal
    }

    /// Returns the signed distance of `point` (m, world axes) from the plane, m: positive above it.
    #[inline]
    #[must_use]
    pub fn gap(&self, point: R::Vec3) -> R {
        self.normal.dot(point) - self.height
    }

    /// Returns the size of the numbers of which the `gap` at `point` is the sum, m. On a tilted
    /// plane the horizontal position is one of them.
    #[inline]
    pub(crate) fn size_of_gap(&self, gap: R, point: R::Vec3) -> R {
        let size = if self.is_level() {
            gap.abs()
        } else {
            point.length()
        };
        size + self.height.abs()
    }

    /// Checks that the normal has length 1 (to 16 units in the last place) and that the height is
    /// finite.
    ///
    /// # Errors
    /// Returns [`SceneError`] if one of them is invalid. The error names the quantity.
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

/// Empty space without any ground.
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
