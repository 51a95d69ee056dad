//! The continuous rim: a circle all of whose places can touch, and the rule by which its contact is
//! integrated.
//!
//! A ring of `n` points on springs `S` each has, in the limit of many points with `n S` the same,
//! on every piece of arc `dφ` the contacts `n dφ/(2π)`. With the unit vectors `e(θ)` of the rim's
//! plane, counted from the lowest place, and `s` the length of the ground's normal in that plane, a
//! place lies in the ground by
//!
//! ```text
//! d(θ) = r s cos θ - g = r s (cos θ - cos α)          cos α = g/(r s)
//! ```
//! where `g` is the gap of the rim's middle. So the arc `-α ... α` touches: none of the rim where
//! `g >= r s`, all of it where `g <= -r s`. Force and energy are integrals over that arc,
//!
//! ```text
//! E = ∫ V(d(θ)) n dθ/(2π)          F = ∫ N(d(θ), ...) n dθ/(2π)
//! ```
//! and since `d = 0` at its ends, `dE` has no share of the ends' wandering: the springs are a true
//! potential, and nothing jumps as the rim rolls on.
//!
//! **Quadrature.** With `κ = sin(α/2)` and `sin(θ/2) = κ u`, `u` from -1 to 1:
//!
//! ```text
//! cos θ = 1 - 2 κ² u²     sin θ = 2 κ u √(1 - κ² u²)     dθ = 2 κ du/√(1 - κ² u²)     d = 2 r s κ² (1 - u²)
//! ```
//! without a sine or an arc cosine, and without cancellation in a small depth. Gauss's rule in `u`,
//! with six points on short arcs and eight on longer ones, integrates what is smooth on an arc of
//! up to a quarter of the circle (`κ <= 0.38`) to 2e-10 of itself, and to rounding on the arcs of
//! less than 0.2 rad on which a body rolls; longer arcs are cut into quarters. Forces on a level
//! plane make do with fewer points, to 4e-11. Where friction reverses on the arc, they have rules
//! of their own (`scene::rims::turning_rules`).

mod panels;

use panels::half_turn;
pub(crate) use panels::{CUTS, MOST_NODES, Panel, Panels, sink_last};

use crate::error::{self, SceneError};
use crate::real::{Real, Vector};

/// A circle fixed in a body, all of whose places can touch the ground.
///
/// It stands for a ring of so many `points`, each with the ground's law, in the limit of many more
/// points of as much less stiffness: forces and energies are integrals over the arc below ground.
/// `points` is what the ground's numbers, which are given for each contact, are multiplied by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rim<R: Real = f64> {
    centre: R::Vec3,
    /// Unit vectors at right angles in its plane.
    axes: [R::Vec3; 2],
    radius: R,
    points: R,
}

impl<R: Real> Rim<R> {
    /// The circle around `centre` (m, body axes, from the centre of mass) at right angles to
    /// `normal` (any length above 0) with a radius in m, which stands for so many points.
    #[must_use]
    pub fn new<V: Vector<R>>(centre: V, normal: V, radius: R, points: usize) -> Self
    where
        R: Real<Vec3 = V>,
    {
        let normal = unit(normal);
        // The axis that lies nearest to its plane: for the normal x, the rim's axes are y and z.
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

    /// m, body axes, from the centre of mass.
    #[inline]
    #[must_use]
    pub fn centre(&self) -> R::Vec3 {
        self.centre
    }

    /// m.
    #[inline]
    #[must_use]
    pub fn radius(&self) -> R {
        self.radius
    }

    /// How many points it stands for.
    #[inline]
    #[must_use]
    pub fn points(&self) -> R {
        self.points
    }

    /// Distance of its farthest place from the centre of mass, and a little more where it is not
    /// around it, m.
    #[inline]
    #[must_use]
    pub fn bounding_radius(&self) -> R {
        self.centre.length() + self.radius
    }

    /// How far it reaches in a direction (unit vector, body axes), m from the centre of mass.
    #[inline]
    #[must_use]
    pub fn support(&self, direction: R::Vec3) -> R {
        let [along, across] = self.in_plane(direction);
        let extent = self.radius * (along * along + across * across).sqrt();
        // A place may lie beyond the circle by its rounding.
        direction.dot(self.centre) + extent * (R::ONE + R::EPSILON * R::from_f64(8.0))
    }

    /// Its farthest place in a direction (unit vector, body axes), m, body axes, from the centre of
    /// mass; any where all are as far.
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

    /// The arc that lies below a plane with this unit normal (body axes), above which the rim's
    /// middle has this gap (m).
    #[inline]
    pub(crate) fn arc_below(&self, normal: R::Vec3, gap: R) -> Arc<R> {
        self.arc_of(self.in_plane(normal), gap)
    }

    /// The same by the parts of the normal along the rim's own axes.
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

    /// From its middle to the place in a direction, and to the one a quarter of a turn on, m, where
    /// its own axes are these.
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

    /// Its own axes.
    #[inline]
    pub(crate) fn axes(&self) -> [R::Vec3; 2] {
        self.axes
    }

    /// The length of a unit vector's part in its plane.
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

    /// The place of the rim in a direction of its plane.
    #[inline]
    fn place(&self, [along, across]: Direction<R>) -> R::Vec3 {
        let [first, second] = self.axes;
        self.centre + (first * along + second * across) * self.radius
    }

    /// The place of a panel with `s = sin(θ/2)`, counted from its middle.
    #[inline]
    pub(crate) fn place_on(&self, panel: Panel<R>, s: R) -> R::Vec3 {
        let root = (R::ONE - s * s).sqrt();
        let (cos, sin) = (R::ONE - R::TWO * s * s, R::TWO * s * root);
        self.place(turned(panel.middle, [cos, sin]))
    }

    /// The places of a panel, each with the number of points that it stands for.
    #[inline]
    pub(crate) fn nodes(&self, panel: Panel<R>) -> impl Iterator<Item = (R::Vec3, R)> {
        let (chord, density) = (panel.chord, panel.chord * self.points);
        let rim = *self;
        let rule = if chord <= R::from_f64(SHORT) {
            GAUSS_6.as_slice()
        } else {
            GAUSS_8.as_slice()
        };
        rule.iter().flat_map(move |&[u, weight]| {
            let t = chord * R::from_f64(u);
            let root = (R::ONE - t * t).sqrt();
            let (cos, sin) = (R::ONE - R::TWO * t * t, R::TWO * t * root);
            let points = density * R::from_f64(weight * core::f64::consts::FRAC_1_PI) / root;
            [sin, -sin].map(|sin| (rim.place(turned(panel.middle, [cos, sin])), points))
        })
    }

    /// That it can be.
    ///
    /// # Errors
    /// Names the quantity, the rule that it breaks, and its value.
    pub fn check(&self) -> Result<(), SceneError> {
        error::above_zero("radius of the rim", self.radius, " m")?;
        error::above_zero("number of points that the rim stands for", self.points, "")?;
        error::finite(
            "distance of the rim from the centre of mass",
            self.centre.length(),
            " m",
        )?;
        let [first, second] = self.axes;
        error::finite("normal of the rim", first.cross(second).length(), "")
    }
}

/// The unit vector along a vector, also of one whose square is no number; not a number for 0.
fn unit<R: Real<Vec3 = V>, V: Vector<R>>(v: V) -> V {
    let largest = (v.x().abs()).at_least(v.y().abs()).at_least(v.z().abs());
    // In two steps: one over a number close to 0 is infinite.
    let v = V::new(v.x() / largest, v.y() / largest, v.z() / largest);
    v * (R::ONE / v.length())
}

/// Gauss's rule on [-1, 1]: the places above 0, and their weights.
pub(crate) const GAUSS_8: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_3],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_5],
    [0.960_289_856_497_536_3, 0.101_228_536_290_376_3],
];
pub(crate) const GAUSS_6: [[f64; 2]; 3] = [
    [0.23861918608319693, 0.46791393457269126],
    [0.6612093864662646, 0.3607615730481386],
    [0.932469514203152, 0.1713244923791705],
];
/// The chord of a panel on which six points are as exact as numbers: what is left of the springs'
/// energy is `2e-4 κ⁸` of it, 1e-14.
pub(crate) const SHORT: f64 = 0.05;

/// Cosine and sine in the rim's plane.
pub(crate) type Direction<R> = [R; 2];

/// `a` turned by the angle of `b`.
#[inline]
fn turned<R: Real>([a, b]: Direction<R>, [cos, sin]: Direction<R>) -> Direction<R> {
    [a * cos - b * sin, b * cos + a * sin]
}

/// What of a rim lies below ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Arc<R> {
    Nothing,
    /// To both sides of the lowest place by the angle α.
    Part {
        lowest: Direction<R>,
        /// `sin(α/2)`: half of the chord from the lowest place to the end, over the radius.
        chord: R,
        /// `r s`: how far the rim reaches below its middle, m.
        extent: R,
    },
    Whole,
}

/// `sin(π/8)`: of a quarter of the circle.
pub(crate) const QUARTER: f64 = 0.382_683_432_365_089_8;

impl<R: Real> Arc<R> {
    /// Whether a place in a direction is on it.
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

    /// Both ends of a part.
    fn ends(&self) -> Option<[Direction<R>; 2]> {
        self.lowest()?;
        Some([-R::ONE, R::ONE].map(|end| self.place(end)))
    }

    /// The place with `sin(θ/2) = κ u`.
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

    /// How far the rim reaches below its middle, m.
    #[inline]
    pub(crate) fn bounds(&self) -> R {
        match *self {
            Self::Part { extent, .. } => extent,
            _ => R::ZERO,
        }
    }

    /// The longer of two that are parts.
    pub(crate) fn longer(arcs: &[Self; 2]) -> Option<Self> {
        let parts = arcs.iter().filter(|arc| arc.lowest().is_some());
        parts
            .copied()
            .reduce(|a, b| if a.chord() < b.chord() { b } else { a })
    }

    /// `sin(α/2)`.
    #[inline]
    pub(crate) fn chord(&self) -> R {
        match *self {
            Self::Nothing => R::ZERO,
            Self::Part { chord, .. } => chord,
            Self::Whole => R::ONE,
        }
    }

    /// What is linear in a place, by its values for the rim's own axes, for the lowest place and
    /// across.
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
