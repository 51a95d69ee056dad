//! Continuous rim: a circle that can touch along its whole length, and the quadrature rule for its
//! contact.
//!
//! Consider a ring of `n` points on springs `S` each, in the limit of many points with `n S`
//! constant. Every piece of arc `dφ` then has `n dφ/(2π)` contacts. Let `e(θ)` be the unit vectors
//! of the rim's plane, counted from the lowest point. Let `s` be the length of the ground's normal
//! projected into that plane. The penetration depth of a point is
//!
//! ```text
//! d(θ) = r s cos θ - g = r s (cos θ - cos α)          cos α = g/(r s)
//! ```
//! where `g` is the gap of the rim's middle and `r` the radius. So the arc `-α ... α` touches. No
//! part of the rim touches if `g >= r s`, and all of it touches if `g <= -r s`. Force and energy
//! are integrals over that arc,
//!
//! ```text
//! E = ∫ V(d(θ)) n dθ/(2π)          F = ∫ N(d(θ), ...) n dθ/(2π)
//! ```
//! with the springs' energy `V` and the normal force `N` of a point. Since `d = 0` at its ends, the
//! movement of the ends does not contribute to `dE`. The springs are a true potential, and nothing
//! jumps as the rim rolls on.
//!
//! **Quadrature.** Substitute `κ = sin(α/2)` and `sin(θ/2) = κ u`, with `u` from -1 to 1:
//!
//! ```text
//! cos θ = 1 - 2 κ² u²             sin θ = 2 κ u √(1 - κ² u²)
//! dθ = 2 κ du/√(1 - κ² u²)        d = 2 r s κ² (1 - u²)
//! ```
//! The substitution needs no sine and no arc cosine, and has no cancellation at a small penetration
//! depth. Gauss's rule in `u` has six points on short arcs and eight on longer ones. On an arc of
//! up to a quarter of the circle (`κ <= 0.38`) it integrates smooth functions to a relative 2e-10.
//! On the arcs of less than 0.2 rad on which a body rolls it is accurate to rounding. Longer arcs
//! are cut into quarters. Forces on a level plane need fewer points, for an accuracy of 4e-11. Arcs
//! on which friction reverses have their own rules (`contact::rims::turning_rules`).

mod panels;

pub(crate) use panels::{CUTS, Panel, Panels, sink_last};
use panels::{half_of, half_turn};

use crate::error::{self, Rule, SceneError};
use crate::quadrature::{HALF_OF_2, HALF_OF_4, HALF_OF_6, HALF_OF_8};
use crate::real::{Real, Vector};

/// Circle fixed in a body that can touch the ground along its whole length.
///
/// It represents a ring of `points` points, each with the ground's law, in the limit of more and
/// proportionally softer points. Forces and energies are integrals over the arc below ground. The
/// ground's stiffness and damping are given per contact and are multiplied by `points`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "R: serde::Serialize, R::Vec3: serde::Serialize",
        deserialize = "R: serde::Deserialize<'de>, R::Vec3: serde::Deserialize<'de>"
    ))
)]
pub struct Rim<R: Real = f64> {
    centre: R::Vec3,
    /// Perpendicular unit vectors in the plane of the rim, body axes.
    axes: [R::Vec3; 2],
    radius: R,
    points: R,
}

impl<R: Real> Rim<R> {
    /// Creates the circle around `centre` (m, body axes, from the centre of mass), perpendicular to
    /// `normal`.
    ///
    /// `normal` has any length above 0. The radius is in m. The circle represents `points` contact
    /// points, at most 2³² - 1.
    #[must_use]
    pub fn new<V: Vector<R>>(centre: V, normal: V, radius: R, points: usize) -> Self
    where
        R: Real<Vec3 = V>,
    {
        let normal = unit(normal);
        // The axis that lies nearest to the rim's plane is taken. For the normal x, the rim's axes
        // are y and z.
        let (x, y, z) = (normal.x().abs(), normal.y().abs(), normal.z().abs());
        let (o, one) = (R::ZERO, R::ONE);
        let beside = if y <= x && y <= z {
            V::new(o, one, o)
        } else if z <= x {
            V::new(o, o, one)
        } else {
            V::new(one, o, o)
        };
        let first = unit(beside - normal * normal.dot(beside));
        Self {
            centre,
            axes: [first, normal.cross(first)],
            radius,
            points: R::from_usize(points),
        }
    }

    /// Centre of the circle, m, body axes, from the centre of mass.
    #[inline]
    #[must_use]
    pub fn centre(&self) -> R::Vec3 {
        self.centre
    }

    /// Radius, m.
    #[inline]
    #[must_use]
    pub fn radius(&self) -> R {
        self.radius
    }

    /// Number of points that the rim represents.
    #[inline]
    #[must_use]
    pub fn points(&self) -> R {
        self.points
    }

    /// Upper bound of the distance of the rim's points from the centre of mass, m.
    ///
    /// It is exact if the circle is centred at the centre of mass.
    #[inline]
    #[must_use]
    pub fn bounding_radius(&self) -> R {
        self.centre.length() + self.radius
    }

    /// Point of the circle that is farthest from the centre of mass, m.
    pub(super) fn farthest(&self) -> R::Vec3 {
        self.support_point(self.centre)
    }

    /// Support function: largest distance from the centre of mass in a direction (unit vector, body
    /// axes), m.
    #[inline]
    #[must_use]
    pub fn support(&self, direction: R::Vec3) -> R {
        let [along, across] = self.in_plane(direction);
        let extent = self.radius * (along * along + across * across).sqrt();
        // A point may lie outside the circle by rounding.
        direction.dot(self.centre) + extent * (R::ONE + R::EPSILON * R::from_f64(8.0))
    }

    /// Farthest point in a direction (unit vector, body axes), m, body axes, from the centre of
    /// mass.
    ///
    /// If all points are equally far, any of them is returned.
    #[inline]
    #[must_use]
    pub fn support_point(&self, direction: R::Vec3) -> R::Vec3 {
        let [along, across] = self.in_plane(direction);
        let extent = (along * along + across * across).sqrt();
        if extent > R::ZERO {
            self.place([along / extent, across / extent])
        } else {
            self.place([R::ONE, R::ZERO])
        }
    }

    /// Arc below a plane with this unit normal (body axes), for this gap of the rim's middle (m).
    #[inline]
    pub(crate) fn arc_below(&self, normal: R::Vec3, gap: R) -> Arc<R> {
        self.arc_of(self.in_plane(normal), gap)
    }

    /// Arc for the components of the normal along the rim's own axes.
    #[inline]
    pub(crate) fn arc_of(&self, [along, across]: [R; 2], gap: R) -> Arc<R> {
        let steepness = (along * along + across * across).sqrt();
        let extent = self.radius * steepness;
        if gap >= extent {
            return Arc::Nothing;
        }
        if gap <= -extent {
            return Arc::Whole;
        }
        Arc::Part {
            lowest: [-along / steepness, -across / steepness],
            chord: ((extent - gap) / (extent + extent)).sqrt(),
            extent,
        }
    }

    /// Vectors from the rim's middle to the point in a direction, and to the point a quarter of a
    /// revolution further, m. The first argument holds the rim's own axes.
    #[inline]
    pub(crate) fn spokes(
        &self,
        [first, second]: [R::Vec3; 2],
        direction: Direction<R>,
    ) -> [R::Vec3; 2] {
        let [along, across] = direction.map(|part| part * self.radius);
        [
            first * along + second * across,
            second * along - first * across,
        ]
    }

    /// Perpendicular unit vectors in the plane of the rim, body axes.
    #[inline]
    pub(crate) fn axes(&self) -> [R::Vec3; 2] {
        self.axes
    }

    /// Length of a unit vector's component in the rim's plane.
    #[inline]
    pub(crate) fn steepness(&self, normal: R::Vec3) -> R {
        let [along, across] = self.in_plane(normal);
        (along * along + across * across).sqrt()
    }

    /// Components along the rim's own axes.
    #[inline]
    fn in_plane(&self, v: R::Vec3) -> [R; 2] {
        let [first, second] = self.axes;
        [v.dot(first), v.dot(second)]
    }

    /// Point of the rim in a direction of its plane.
    #[inline]
    pub(crate) fn place(&self, [along, across]: Direction<R>) -> R::Vec3 {
        let [first, second] = self.axes;
        self.centre + (first * along + second * across) * self.radius
    }

    /// Point of a panel with `s = sin(θ/2)`, counted from the panel's middle.
    #[inline]
    pub(crate) fn place_on(&self, panel: Panel<R>, s: R) -> R::Vec3 {
        let root = (R::ONE - s * s).sqrt();
        let (cos, sin) = (R::ONE - R::TWO * s * s, R::TWO * s * root);
        self.place(turned(panel.middle, [cos, sin]))
    }

    /// Calls `visit` with the quadrature points of a panel, at most `most`, and with the number of
    /// contact points that each represents. There are two at least.
    #[inline(always)]
    pub(crate) fn visit_nodes(
        &self,
        panel: Panel<R>,
        most: usize,
        mut visit: impl FnMut(R::Vec3, R),
    ) {
        let (chord, density) = (panel.chord, panel.chord * self.points);
        let rule = match most {
            0..=3 => HALF_OF_2.as_slice(),
            4..=5 => HALF_OF_4.as_slice(),
            6..=7 => HALF_OF_6.as_slice(),
            _ if chord <= R::from_f64(SHORT) => HALF_OF_6.as_slice(),
            _ => HALF_OF_8.as_slice(),
        };
        for &[u, weight] in rule {
            let t = chord * R::from_f64(u);
            let root = (R::ONE - t * t).sqrt();
            let (cos, sin) = (R::ONE - R::TWO * t * t, R::TWO * t * root);
            let points = density * R::from_f64(weight * core::f64::consts::FRAC_1_PI) / root;
            for sin in [sin, -sin] {
                visit(self.place(turned(panel.middle, [cos, sin])), points);
            }
        }
    }

    /// Checks that the rim is valid.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the rim is invalid. The error names the quantity, the rule that it
    /// breaks, and its value.
    pub fn check(&self) -> Result<(), SceneError> {
        error::above_zero("radius of the rim", self.radius, " m")?;
        check_points(self.points)?;
        error::finite("x of the centre of the rim", self.centre.x(), " m")?;
        error::finite("y of the centre of the rim", self.centre.y(), " m")?;
        error::finite("z of the centre of the rim", self.centre.z(), " m")?;
        let [first, second] = self.axes;
        let normal = first.cross(second).length();
        error::finite("normal of the rim", normal, "")?;
        // A rim from a file may have any axes.
        to_rounding("first axis of the rim", first.length(), R::ONE)?;
        to_rounding("second axis of the rim", second.length(), R::ONE)?;
        to_rounding(
            "cosine between the axes of the rim",
            first.dot(second),
            R::ZERO,
        )
    }
}

/// Checks the number of points. A larger one would be another number after saving, because it is
/// saved as a whole number of 32 bits.
fn check_points<R: Real>(points: R) -> Result<(), SceneError> {
    let quantity = "number of points that the rim represents";
    error::above_zero(quantity, points, "")?;
    if points <= R::from_f64(f64::from(u32::MAX)) {
        return Ok(());
    }
    let most = usize::try_from(u32::MAX).unwrap_or(usize::MAX);
    let rule = Rule::AtMost(most);
    Err(SceneError::new(quantity, rule, points.to_f64(), ""))
}

/// Checks that a number is 1, as the length of an axis, or 0, to the rounding of [`Rim::new`].
fn to_rounding<R: Real>(quantity: &'static str, value: R, exact: R) -> Result<(), SceneError> {
    if (value - exact).abs() <= R::EPSILON * R::from_f64(64.0) {
        return Ok(());
    }
    let rule = if exact == R::ONE {
        Rule::UnitLength
    } else {
        Rule::Zero
    };
    Err(SceneError::new(quantity, rule, value.to_f64(), ""))
}

/// Unit vector along a vector, also if the square of its length overflows or underflows. Returns
/// NaN for 0.
fn unit<R: Real<Vec3 = V>, V: Vector<R>>(v: V) -> V {
    let largest = (v.x().abs()).at_least(v.y().abs()).at_least(v.z().abs());
    // Two steps, because the reciprocal of a number close to 0 is infinite.
    let v = V::new(v.x() / largest, v.y() / largest, v.z() / largest);
    v * (R::ONE / v.length())
}

/// Chord of a panel below which six points are accurate to rounding. The relative error of the
/// springs' energy is `2e-4 κ⁸`, 1e-14.
pub(crate) const SHORT: f64 = 0.05;

/// Cosine and sine in the rim's plane.
pub(crate) type Direction<R> = [R; 2];

/// Rotates `a` by the angle of `b`.
#[inline]
pub(crate) fn turned<R: Real>([a, b]: Direction<R>, [cos, sin]: Direction<R>) -> Direction<R> {
    [a * cos - b * sin, b * cos + a * sin]
}

/// Part of a rim that lies below ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Arc<R> {
    Nothing,
    /// Arc to both sides of the lowest point by the angle α. On ground that is not a plane, it is
    /// the middle of the arc, and the extent is the one that gives the penetration depth there.
    Part {
        lowest: Direction<R>,
        /// `sin(α/2)`: half of the chord from the lowest point to the end, over the radius.
        chord: R,
        /// `r s`: depth of the lowest point below the rim's middle, m.
        extent: R,
    },
    Whole,
}

/// `sin(π/8)`: chord of a quarter of the circle.
pub(crate) const QUARTER: f64 = 0.382_683_432_365_089_8;

impl<R: Real> Arc<R> {
    /// Creates the arc from one direction to another, for the gap at a point (m).
    pub(crate) fn between(
        [a, b]: Direction<R>,
        [c, d]: Direction<R>,
        gap: impl Fn(Direction<R>) -> R,
    ) -> Self {
        // Twice the middle times the sine of half the angle, turned back by a quarter, and times
        // the cosine. The larger of the two has no cancellation.
        let (sine, cosine) = ([d - b, a - c], [a + c, b + d]);
        let [sin, cos] = [sine, cosine].map(|[x, y]| (x * x + y * y).sqrt() * R::HALF);
        let is_wide = sine[0] * cosine[0] + sine[1] * cosine[1] < R::ZERO;
        let cos = if is_wide { -cos } else { cos };
        let (part, length) = if sin > cos.abs() {
            (sine, sin)
        } else {
            (cosine, cos)
        };
        let middle = part.map(|x| x * R::HALF / length);
        let chord = ((R::ONE - cos) * R::HALF).sqrt();
        let chord = if is_wide { chord } else { half_of(sin, cos) };
        let depth = -gap(middle);
        if chord > R::EPSILON {
            Self::Part {
                lowest: middle,
                chord,
                extent: depth.at_least(R::ZERO) / (chord * chord * R::TWO),
            }
        } else {
            Self::Nothing
        }
    }

    /// Returns true if the point in a direction is on the arc.
    #[inline]
    fn holds(&self, [a, b]: Direction<R>) -> bool {
        match *self {
            Self::Nothing => false,
            Self::Whole => true,
            Self::Part {
                lowest: [x, y],
                chord,
                ..
            } => (a - x) * (a - x) + (b - y) * (b - y) < chord * chord * R::from_f64(4.0),
        }
    }

    /// Both ends of a partial arc.
    fn ends(&self) -> Option<[Direction<R>; 2]> {
        self.lowest()?;
        Some([-R::ONE, R::ONE].map(|end| self.place(end)))
    }

    /// Direction of the point with `sin(θ/2) = κ u`.
    #[inline]
    pub(crate) fn place(&self, u: R) -> Direction<R> {
        match *self {
            Self::Part { lowest, chord, .. } => {
                let half = half_turn(chord * u);
                turned(lowest, turned(half, half))
            }
            _ => [R::ONE, R::ZERO],
        }
    }

    /// Depth of the lowest point below the rim's middle, m.
    #[inline]
    pub(crate) fn extent(&self) -> R {
        match *self {
            Self::Part { extent, .. } => extent,
            _ => R::ZERO,
        }
    }

    /// Half of the arc's chord over the radius, `sin(α/2)`.
    #[inline]
    pub(crate) fn chord(&self) -> R {
        match *self {
            Self::Nothing => R::ZERO,
            Self::Part { chord, .. } => chord,
            Self::Whole => R::ONE,
        }
    }

    /// Coefficients of a linear function of the point, for the lowest point and the direction
    /// across. The argument holds its values for the rim's own axes.
    #[inline]
    pub(crate) fn slopes<V: Vector<R>>(&self, [first, second]: [V; 2]) -> [V; 2] {
        let [x, y] = self.lowest().unwrap_or([R::ONE, R::ZERO]);
        [first * x + second * y, second * x - first * y]
    }

    pub(crate) fn lowest(&self) -> Option<Direction<R>> {
        match *self {
            Self::Part { lowest, .. } => Some(lowest),
            _ => None,
        }
    }
}
