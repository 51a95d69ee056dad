//! Hills and valleys: a surface z = h(x, y).

use super::{GroundBounds, Plane, Shape, Surface};
use crate::error::SceneError;
use crate::real::{Real, Vector};

/// The height of a terrain, h(x, y), with its gradient.
///
/// *To the implementer:* height and gradient must be finite and continuous, and the gradient be the
/// height's; the hessian only makes the search for the nearest point quicker, by a few iterations
/// near the surface. A closure is a relief:
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
    message = "`{Self}` is not the relief of a terrain: it does not implement `HeightField<{R}>`",
    label = "this should be a relief",
    note = "implement `elevation`, or take a closure from x and y to an `Elevation`"
)]
pub trait HeightField<R: Real = f64> {
    /// Height, gradient and hessian above a place of the level (m, world axes).
    fn elevation(&self, x: R, y: R) -> Elevation<R>;

    /// A height (m) that no place of the terrain exceeds, if there is one: above it nothing is
    /// looked at.
    #[inline]
    fn highest(&self) -> Option<R> {
        None
    }

    /// Whether the relief can be: called once, when a scene is composed.
    ///
    /// # Errors
    /// Names the quantity, the rule that it breaks, and its value.
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }

    /// Returns true if the values of the relief need no check while a step evaluates them. Default:
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

impl<R: Real, F: Fn(R, R) -> Elevation<R>> HeightField<R> for F {
    #[inline]
    fn elevation(&self, x: R, y: R) -> Elevation<R> {
        self(x, y)
    }
}

/// Height, gradient and hessian of a terrain above a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elevation<R = f64> {
    /// h, m.
    pub height: R,
    /// ∂h/∂x and ∂h/∂y.
    pub gradient: [R; 2],
    /// ∂²h/∂x², ∂²h/∂x∂y and ∂²h/∂y², 1/m; or zeros.
    pub hessian: [R; 3],
}

impl<R: Real> Elevation<R> {
    /// A height (m) and a gradient.
    #[inline]
    #[must_use]
    pub fn new(height: R, gradient: [R; 2]) -> Self {
        Self {
            height,
            gradient,
            hessian: [R::ZERO; 3],
        }
    }

    /// The same with its second derivatives xx, xy, yy (1/m).
    #[inline]
    #[must_use]
    pub fn with_hessian(self, hessian: [R; 3]) -> Self {
        Self { hessian, ..self }
    }
}

/// The surface z = h(x, y) of a [`HeightField`], solid below.
///
/// The gap is the *distance* to the nearest point of the surface, found by Newton's method, and
/// negative below it. So its gradient is the unit normal, and a spring's force along the normal is
/// a potential's: round a closed path the springs do no work. A depth measured otherwise does not
/// have this: the vertical one, h - z, changes by more than the way along the normal, and that one
/// times the cosine of the gradient is a distance on the surface only, and below it fails by depth
/// times curvature. It also holds for contacts with a radius: the centre of a ball rolls on the
/// parallel surface.
///
/// A search costs 2 to 4 elevations near the surface, with the hessian; without it, each iteration
/// gains a factor of one over depth (or radius) times curvature.
///
/// *Limits:* depth and radius of a contact, and so the radius of a ball in a valley, must be below
/// the terrain's radius of curvature, 1/hessian: from there on several places are nearest, the gap
/// has edges, and the search, which begins at the place right below, may find one that is near, but
/// not nearest. The energy does not rise there either ([`EnergyMomentum`](crate::EnergyMomentum)),
/// but no promise is made on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Terrain<H> {
    /// Its height.
    pub height_field: H,
}

impl<H> Terrain<H> {
    /// The terrain of a relief.
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
        Foot::nearest(&self.height_field, point).surface(point)
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

/// Elevations that a search looks at, at most: with the hessian a handful is enough; without it, so
/// many halve the way to the nearest point as often.
const LOOKS: u32 = 24;
/// A step of so many units in the last place is rounding.
const ROUNDING: f64 = 16.0;

/// A place of the terrain, as seen from a point.
#[derive(Clone, Copy)]
struct Foot<R: Real> {
    x: R,
    y: R,
    elevation: Elevation<R>,
    /// Of its distance from the point, m².
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

    #[inline]
    fn nearest<H: HeightField<R>>(height_field: &H, point: R::Vec3) -> Self {
        let mut foot = Self::at(height_field, point, point.x(), point.y());
        let mut step = foot.step(point);
        for _ in 1..LOOKS {
            let rounding = foot.rounding(point);
            let is_step = step[0].abs() + step[1].abs() > rounding;
            if !is_step {
                break;
            }
            let next = Self::at(height_field, point, foot.x + step[0], foot.y + step[1]);
            let slack = foot.square * (R::EPSILON * R::from_f64(ROUNDING)) + rounding * rounding;
            if next.square <= foot.square + slack {
                foot = next;
                step = foot.step(point);
            } else {
                // It leads away: half of it may not.
                step = step.map(|along| along * R::HALF);
            }
        }
        foot
    }

    /// What rounding leaves of a step, m.
    #[inline]
    fn rounding(&self, point: R::Vec3) -> R {
        let size =
            point.x().abs() + point.y().abs() + point.z().abs() + self.elevation.height.abs();
        size * (R::EPSILON * R::from_f64(ROUNDING))
    }

    /// Half the square of the distance, `((x-X)² + (y-Y)² + (h-Z)²)/2`, has the gradient
    /// `(x-X + (h-Z) hₓ, ...)` and the second derivatives `1 + hₓ² + (h-Z) hₓₓ`, ... Newton's step
    /// goes to where the gradient is 0; where the second derivatives are no bowl's, those without
    /// the hessian are, and the step is to the foot on the tangent plane (Gauss & Newton).
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
        // A bowl by a margin, so that the step is no leap.
        let margin = (ax * ay - axy * axy) * R::from_f64(1e-2);
        let (ax, axy, ay, determinant) = if bowl > margin && bx > R::ZERO {
            (bx, bxy, by, bowl)
        } else {
            (ax, axy, ay, ax * ay - axy * axy)
        };
        let per = -(R::ONE / determinant);
        [(ay * gx - axy * gy) * per, (ax * gy - axy * gx) * per]
    }

    /// The distance to the tangent plane is that to the terrain to second order in what the foot is
    /// off by.
    #[inline]
    fn surface(&self, point: R::Vec3) -> Surface<R> {
        let [hx, hy] = self.elevation.gradient;
        let upright = R::Vec3::new(-hx, -hy, R::ONE);
        let normal = upright * (R::ONE / upright.length());
        let foot = R::Vec3::new(self.x, self.y, self.elevation.height);
        Surface {
            gap: normal.dot(point - foot),
            normal,
        }
    }
}
