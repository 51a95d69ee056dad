//! Terrains: surfaces z = h(x, y).

use super::{GroundBounds, Plane, Shape, Surface};
use crate::error::SceneError;
use crate::real::{Real, Vector};

/// The height h(x, y) of a terrain, with its gradient.
///
/// *To the implementer:* height and gradient must be finite and continuous, and the gradient must
/// be the derivative of the height. The hessian only speeds up the search for the nearest point, by
/// a few iterations near the surface.
///
/// A closure is a height field:
///
/// ```
/// use tumble::{Elevation, Ground, SpringDamper, Terrain};
///
/// // A valley along y, 1 m high at x = 2 m.
/// let valley = Terrain::of(|x: f64, _y: f64| Elevation::new(x * x / 4.0, [x / 2.0, 0.0]).with_hessian([0.5, 0.0, 0.0]));
/// let ground = Ground { law: SpringDamper { stiffness: 1e4, damping: 10.0 }, shape: valley };
/// # use tumble::{Coin, Stepper};
/// # Stepper::new(Coin::ring(1.0, 0.5))?.with_ground(ground)?;
/// # Ok::<(), tumble::SceneError>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a height field: it does not implement `HeightField<{R}>`",
    label = "this should be a height field",
    note = "implement `elevation`, or use a closure from x and y to an `Elevation`"
)]
pub trait HeightField<R: Real = f64> {
    /// Height, gradient and hessian at the point (x, y) of the level plane (m, world axes).
    fn elevation(&self, x: R, y: R) -> Elevation<R>;

    /// Height (m) that the terrain never exceeds, if there is one. Contacts above it are not
    /// evaluated.
    #[inline]
    fn highest(&self) -> Option<R> {
        None
    }

    /// Checks that the height field is valid. Called once, when a scene is composed.
    ///
    /// # Errors
    /// Returns [`SceneError`] if a quantity is invalid. The error names the quantity, the rule and
    /// the value.
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }

    /// Returns true if the values of the height field need no check while a step evaluates them.
    /// Default: false.
    ///
    /// A step checks some values of a height field that is not trusted, and returns
    /// [`StepError::BrokenLaw`](crate::StepError::BrokenLaw) if they break the contract: that the
    /// gap is a number, and that the normal has length 1. Override this method if the height field
    /// keeps its contract for every finite input, and
    /// [`check_ground`](crate::contract::check_ground) finds no fault. The checks then cost
    /// nothing. A trusted height field that breaks its contract is not detected.
    #[inline]
    fn is_trusted(&self) -> bool {
        false
    }
}

impl<R: Real, F: Fn(R, R) -> Elevation<R>> HeightField<R> for F {
    #[inline]
    fn elevation(&self, x: R, y: R) -> Elevation<R> {
        self(x, y)
    }
}

/// Height, gradient and hessian of a terrain at a point (x, y).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elevation<R = f64> {
    /// Height h, m.
    pub height: R,
    /// Gradient ∂h/∂x and ∂h/∂y.
    pub gradient: [R; 2],
    /// Hessian ∂²h/∂x², ∂²h/∂x∂y and ∂²h/∂y², 1/m; or zeros.
    pub hessian: [R; 3],
}

impl<R: Real> Elevation<R> {
    /// Creates an elevation from a height (m) and a gradient, with a hessian of zeros.
    #[inline]
    #[must_use]
    pub fn new(height: R, gradient: [R; 2]) -> Self {
        Self {
            height,
            gradient,
            hessian: [R::ZERO; 3],
        }
    }

    /// Returns the elevation with the second derivatives xx, xy, yy (1/m).
    #[inline]
    #[must_use]
    pub fn with_hessian(self, hessian: [R; 3]) -> Self {
        Self { hessian, ..self }
    }
}

/// The surface z = h(x, y) of a [`HeightField`], solid below.
///
/// The gap is the *distance* to the nearest point of the surface, negative below it. Newton's
/// method finds this point. The gradient of the gap is therefore the unit normal, and a spring
/// force along the normal derives from a potential: the springs do no work along a closed path.
///
/// Other measures of the depth do not have this property:
///
/// * The vertical depth, h - z, changes by more than the displacement along the normal.
/// * The vertical depth times the cosine of the slope angle is a distance only on the surface.
///   Below it, the error is depth times curvature.
///
/// The property also holds for contacts with a radius: the centre of a ball rolls on the parallel
/// surface.
///
/// With the hessian, a search costs 2 to 4 elevations near the surface. Without it, each iteration
/// reduces the error by a factor of one over depth (or radius) times curvature. A point without a
/// radius that lies above the terrain costs one elevation.
///
/// *Limits:* depth and radius of a contact must be below the terrain's radius of curvature,
/// 1/hessian. This also limits the radius of a ball in a valley. Beyond the limit several points of
/// the surface can be nearest, and the gap has edges. The search starts at the point vertically
/// below or above. It may then find a point that is not the nearest, also for a contact in the air
/// that is further from the surface than the radius of curvature. The gap is too large there, so
/// that a contact in the air feels nothing, but may be found late. Even there the energy
/// never increases ([`EnergyMomentum`](crate::EnergyMomentum)), but the accuracy of the path is not
/// guaranteed. A million radii of curvature below the surface, a body was found to stay where a
/// force could still press it down.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Terrain<H> {
    /// Height function of the terrain.
    pub height_field: H,
}

impl<H> Terrain<H> {
    /// Creates the terrain of a height field.
    pub fn of<R: Real>(height_field: H) -> Self
    where
        H: HeightField<R>,
    {
        Self { height_field }
    }
}

impl<R: Real, H: HeightField<R>> Shape<R> for Terrain<H> {
    #[inline]
    fn surface(&self, point: R::Vec3) -> Surface<R> {
        let foot = Foot::below(&self.height_field, point);
        let is_above = foot.clearance(point) > R::ZERO;
        let nearest = foot.nearest(&self.height_field, point);
        nearest.surface(point, is_above)
    }

    /// The height of a bare point shows whether it is above the terrain, without a search.
    #[inline]
    fn surface_under(&self, centre: R::Vec3, radius: R) -> Option<Surface<R>> {
        let foot = Foot::below(&self.height_field, centre);
        let clearance = foot.clearance(centre);
        let is_clear = radius <= R::ZERO && clearance > foot.rounding(centre);
        (!is_clear).then(|| {
            let nearest = foot.nearest(&self.height_field, centre);
            nearest.surface(centre, clearance > R::ZERO)
        })
    }

    #[inline]
    fn bounds(&self) -> GroundBounds<R> {
        match self.height_field.highest() {
            Some(height) => GroundBounds::Below(Plane::level(height)),
            None => GroundBounds::Everywhere,
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        self.height_field.check()
    }
    #[inline]
    fn is_trusted(&self) -> bool {
        self.height_field.is_trusted()
    }
}

/// Maximum number of elevations in a search. With the hessian a few are enough. Without it, 24
/// elevations halve the distance to the nearest point 24 times.
const ELEVATIONS: u32 = 24;
/// Size of a step, in units in the last place, that counts as rounding.
const ROUNDING: f64 = 16.0;

/// Point of the terrain in a search for the point nearest to a given one.
#[derive(Clone, Copy)]
struct Foot<R: Real> {
    x: R,
    y: R,
    elevation: Elevation<R>,
    /// Square of its distance from the given point, m².
    square: R,
}

impl<R: Real> Foot<R> {
    #[inline]
    fn at<H: HeightField<R>>(height_field: &H, point: R::Vec3, x: R, y: R) -> Self {
        let elevation = height_field.elevation(x, y);
        let way = R::Vec3::new(x, y, elevation.height) - point;
        Self {
            x,
            y,
            elevation,
            square: way.length_squared(),
        }
    }

    /// Foot vertically below or above a point.
    #[inline]
    fn below<H: HeightField<R>>(height_field: &H, point: R::Vec3) -> Self {
        Self::at(height_field, point, point.x(), point.y())
    }

    /// Height of a point above the foot, m.
    #[inline]
    fn clearance(&self, point: R::Vec3) -> R {
        point.z() - self.elevation.height
    }

    /// Foot nearest to a point, in a search that begins at this one.
    #[inline]
    fn nearest<H: HeightField<R>>(self, height_field: &H, point: R::Vec3) -> Self {
        let mut foot = self;
        let mut step = foot.step(point);
        for _ in 1..ELEVATIONS {
            let rounding = foot.rounding(point);
            let is_step = step[0].abs() + step[1].abs() > rounding;
            if !is_step {
                break;
            }
            let next = Self::at(height_field, point, foot.x + step[0], foot.y + step[1]);
            // The difference of coordinates has their rounding, also where it is small.
            let slack = rounding * (foot.square.sqrt() + rounding);
            if next.square <= foot.square + slack {
                foot = next;
                step = foot.step(point);
            } else {
                // The step increases the distance. Try half of it.
                step = step.map(|along| along * R::HALF);
            }
        }
        foot
    }

    /// Size of a step that is due to rounding, m.
    #[inline]
    fn rounding(&self, point: R::Vec3) -> R {
        let size =
            point.x().abs() + point.y().abs() + point.z().abs() + self.elevation.height.abs();
        size * (R::EPSILON * R::from_f64(ROUNDING))
    }

    /// Newton's step towards the nearest point of the surface.
    ///
    /// Half the square of the distance is `((x-X)² + (y-Y)² + (h-Z)²)/2`. Its gradient is
    /// `(x-X + (h-Z) hₓ, ...)`, and its second derivatives are `1 + hₓ² + (h-Z) hₓₓ`, ... Newton's
    /// step leads to a gradient of 0. Where the second derivatives are not positive definite, the
    /// terms with the hessian are left out. The step then leads to the foot on the tangent plane
    /// (Gauss & Newton).
    #[inline]
    fn step(&self, point: R::Vec3) -> [R; 2] {
        let Elevation {
            height,
            gradient: [hx, hy],
            hessian: [hxx, hxy, hyy],
        } = self.elevation;
        let up = height - point.z();
        let (gx, gy) = (self.x - point.x() + up * hx, self.y - point.y() + up * hy);
        let (ax, axy, ay) = (R::ONE + hx * hx, hx * hy, R::ONE + hy * hy);
        let (bx, bxy, by) = (ax + up * hxx, axy + up * hxy, ay + up * hyy);
        let bowl = bx * by - bxy * bxy;
        // Positive definite by a margin, to keep the step short.
        let margin = (ax * ay - axy * axy) * R::from_f64(1e-2);
        let (ax, axy, ay, determinant) = if bowl > margin && bx > R::ZERO {
            (bx, bxy, by, bowl)
        } else {
            (ax, axy, ay, ax * ay - axy * axy)
        };
        let per = -(R::ONE / determinant);
        [(ay * gx - axy * gy) * per, (ax * gy - axy * gx) * per]
    }

    /// Distance to the tangent plane at the foot. It equals the distance to the terrain to second
    /// order in the error of the foot.
    ///
    /// A foot whose normal misses the point is not the nearest one. Its own distance is then the
    /// gap: it is never less than that of the terrain, so that no contact is felt in the air.
    #[inline]
    fn surface(&self, point: R::Vec3, is_above: bool) -> Surface<R> {
        let [hx, hy] = self.elevation.gradient;
        let upright = R::Vec3::new(-hx, -hy, R::ONE);
        let normal = upright * (R::ONE / upright.length());
        let foot = R::Vec3::new(self.x, self.y, self.elevation.height);
        let gap = normal.dot(point - foot);
        let misses = gap * gap < self.square * R::from_f64(0.98) || (gap > R::ZERO) != is_above;
        let gap = match (misses, is_above) {
            (false, _) => gap,
            (true, true) => self.square.sqrt(),
            (true, false) => -self.square.sqrt(),
        };
        Surface { gap, normal }
    }
}
