//! The continuous rim: a circle all of whose places can touch, and the rule by which its contact is integrated.
//!
//! A ring of `n` points on springs `S` each has, in the limit of many points with `n S` the same, on every piece of arc `dφ` the contacts `n dφ/(2π)`. With the unit vectors `e(θ)` of the rim's plane, counted from the
//! lowest place, and `s` the length of the ground's normal in that plane, a place lies in the ground by
//!
//! ```text
//! d(θ) = r s cos θ - g = r s (cos θ - cos α)          cos α = g/(r s)
//! ```
//! where `g` is the gap of the rim's middle. So the arc `-α ... α` touches: none of the rim where `g >= r s`, all of it where `g <= -r s`. Force and energy are integrals over that arc,
//!
//! ```text
//! E = ∫ V(d(θ)) n dθ/(2π)          F = ∫ N(d(θ), ...) n dθ/(2π)
//! ```
//! and since `d = 0` at its ends, `dE` has no share of the ends' wandering: the springs are a true potential, and nothing jumps as the rim rolls on.
//!
//! **Quadrature.** With `κ = sin(α/2)` and `sin(θ/2) = κ u`, `u` from -1 to 1:
//!
//! ```text
//! cos θ = 1 - 2 κ² u²     sin θ = 2 κ u √(1 - κ² u²)     dθ = 2 κ du/√(1 - κ² u²)     d = 2 r s κ² (1 - u²)
//! ```
//! without a sine or an arc cosine, and without cancellation in a small depth. Gauss's rule in `u`, with six points on short arcs and eight on longer ones, integrates what is smooth on an arc of up to a quarter of the circle (`κ <= 0.38`) to 2e-10 of itself, and to rounding on
//! the arcs of less than 0.2 rad on which a body rolls; longer arcs are cut into quarters. Forces on a level plane make do with fewer points, to 4e-11, and to 3e-8 of a long arc on which friction turns round.

use crate::error::{self, SceneError};
use crate::real::{Real, Vector};

/// A circle fixed in a body, all of whose places can touch the ground.
///
/// It stands for a ring of so many `points`, each with the ground's law, in the limit of many more points of as much less stiffness: forces and energies are integrals over the arc below
/// ground. `points` is what the ground's numbers, which are given for each contact, are multiplied by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rim<R: Real = f64> {
    centre: R::Vec3,
    /// Unit vectors at right angles in its plane.
    axes: [R::Vec3; 2],
    radius: R,
    points: R,
}

impl<R: Real> Rim<R> {
    /// The circle around `centre` (m, body axes, from the centre of mass) at right angles to `normal` (any length above 0) with a radius in m, which stands for so many points.
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

    /// Distance of its farthest place from the centre of mass, and a little more where it is not around it, m.
    #[inline]
    #[must_use]
    pub fn reach(&self) -> R {
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

    /// Its farthest place in a direction (unit vector, body axes), m, body axes, from the centre of mass; any where all are as far.
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

    /// The arc that lies below a plane with this unit normal (body axes), above which the rim's middle has this gap (m).
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

    /// From its middle to the place in a direction, and to the one a quarter of a turn on, m, where its own axes are these.
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
/// The chord of a panel on which six points are as exact as numbers: what is left of the springs' energy is `2e-4 κ⁸` of it, 1e-14.
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

/// A piece of arc of at most a quarter of the circle, by its middle and `sin(half its half angle)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Panel<R> {
    middle: Direction<R>,
    chord: R,
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
    pub(crate) fn extent(&self) -> R {
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

    /// What is linear in a place, by its values for the rim's own axes, for the lowest place and across.
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

/// Most panels that two arcs make: their four ends, the four cuts into quarters and what else cuts them.
const MOST: usize = 8 + CUTS;
/// Most further cuts.
pub(crate) const CUTS: usize = 4;
/// Most nodes of a rim in a step.
pub(crate) const MOST_NODES: usize = MOST * GAUSS_8.len() * 2;

/// The panels of what lies below ground in one moment or in either of two: no end of an arc lies within one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Panels<R> {
    panels: [Panel<R>; MOST],
    count: usize,
}

impl<R: Real> Panels<R> {
    const NONE: Self = Self {
        panels: [Panel {
            middle: [R::ONE, R::ZERO],
            chord: R::ZERO,
        }; MOST],
        count: 0,
    };

    /// Those of one arc, cut at these places: `sin(θ/2)/sin(α/2)`, from -1 to 1 along the arc.
    #[inline]
    pub(crate) fn of(arc: Arc<R>, cuts: impl Iterator<Item = R>) -> Self {
        let mut panels = Self::NONE;
        match arc {
            Arc::Nothing => {}
            Arc::Part { lowest, chord, .. } if chord <= R::from_f64(QUARTER) => {
                let mut from = half_turn(-chord);
                for cut in cuts {
                    let to = half_turn(chord * cut);
                    panels.push_between(lowest, from, to);
                    from = to;
                }
                panels.push_between(lowest, from, half_turn(chord));
            }
            _ => {
                let places = cuts.map(|cut| arc.place(cut));
                return Self::of_both([arc, Arc::Nothing], places);
            }
        }
        panels
    }

    /// One between two half angles from the lowest place.
    #[inline]
    fn push_between(&mut self, lowest: Direction<R>, [a, b]: Direction<R>, [c, d]: Direction<R>) {
        // Of half the panel's angle.
        let (sin, cos) = (d * a - c * b, c * a + d * b);
        if sin > R::EPSILON {
            let middle = turned(lowest, turned([a, b], [c, d]));
            self.push(middle, half_of(sin, cos));
        }
    }

    /// Those of two arcs together, cut at these places.
    #[inline(never)]
    pub(crate) fn of_both(arcs: [Arc<R>; 2], places: impl Iterator<Item = Direction<R>>) -> Self {
        let mut panels = Self::NONE;
        if arcs == [Arc::Nothing; 2] {
            return panels;
        }
        let [first, second] = arcs;
        // The circle is counted from opposite the lowest place, so that no arc of rolling lies across the seam.
        let middle = first.lowest().or(second.lowest());
        let frame = middle.unwrap_or([R::ONE, R::ZERO]).map(|x| -x);
        let half = R::from_f64(core::f64::consts::FRAC_1_SQRT_2);
        let quarters = [[half, half], [-half, half], [-half, -half], [half, -half]];
        let mut cuts = Cuts::NONE;
        for cut in quarters {
            cuts.add(frame, turned(frame, cut));
        }
        for end in arcs.iter().filter_map(Arc::ends).flatten() {
            cuts.add(frame, end);
        }
        for place in places {
            cuts.add(frame, place);
        }
        let cuts = cuts.get();
        for (from, to) in cuts.iter().zip(cuts.iter().cycle().skip(1)) {
            let Some((middle, chord)) = between(from.place, to.place) else {
                continue;
            };
            if arcs.iter().any(|arc| arc.holds(middle)) {
                panels.push(middle, chord);
            }
        }
        panels
    }

    #[inline]
    fn push(&mut self, middle: Direction<R>, chord: R) {
        if let Some(panel) = self.panels.get_mut(self.count) {
            *panel = Panel { middle, chord };
            self.count += 1;
        }
    }

    #[inline]
    pub(crate) fn iter(&self) -> impl Iterator<Item = Panel<R>> + '_ {
        self.panels.iter().take(self.count).copied()
    }
}

/// Middle and chord of the shorter arc between two directions; `None` where they are the same to rounding.
fn between<R: Real>([a, b]: Direction<R>, [c, d]: Direction<R>) -> Option<(Direction<R>, R)> {
    let (x, y) = (a + c, b + d);
    let (across, along) = (c - a, d - b);
    // Twice the cosine and the sine of half the angle.
    let cos = (x * x + y * y).sqrt();
    let sin = (across * across + along * along).sqrt();
    if !(sin > R::EPSILON && cos > R::ZERO) {
        return None;
    }
    Some(([x / cos, y / cos], half_of(sin * R::HALF, cos * R::HALF)))
}

/// The sine of half an angle: `sin(h/2) = sin h/√(2 (1 + cos h))`.
#[inline]
fn half_of<R: Real>(sin: R, cos: R) -> R {
    sin / (R::TWO + R::TWO * cos).sqrt()
}

/// Cosine and sine of an angle with this sine.
#[inline]
fn half_turn<R: Real>(sin: R) -> Direction<R> {
    [(R::ONE - sin * sin).at_least(R::ZERO).sqrt(), sin]
}

/// A direction and its place in the order round the circle.
#[derive(Clone, Copy, Debug)]
struct Cut<R> {
    place: Direction<R>,
    order: R,
}

/// Where the circle is cut.
struct Cuts<R> {
    cuts: [Cut<R>; MOST],
    count: usize,
}

impl<R: Real> Cuts<R> {
    const NONE: Self = Self {
        cuts: [Cut {
            place: [R::ONE, R::ZERO],
            order: R::ZERO,
        }; MOST],
        count: 0,
    };

    fn add(&mut self, [a, b]: Direction<R>, place: Direction<R>) {
        let [x, y] = turned(place, [a, -b]);
        if let Some(cut) = self.cuts.get_mut(self.count) {
            let order = order(x, y);
            *cut = Cut { place, order };
            self.count += 1;
            sink_last(self.cuts.get_mut(..self.count).unwrap_or_default(), |cut| {
                cut.order
            });
        }
    }

    fn get(&self) -> &[Cut<R>] {
        self.cuts.get(..self.count).unwrap_or_default()
    }
}

/// Brings the last of what was in order to its place.
pub(crate) fn sink_last<T, R: Real>(mut sorted: &mut [T], order: impl Fn(&T) -> R) {
    while let [.., lower, last] = sorted {
        if order(last) >= order(lower) {
            return;
        }
        core::mem::swap(lower, last);
        let count = sorted.len() - 1;
        sorted = sorted.get_mut(..count).unwrap_or_default();
    }
}

/// Grows with the angle of a direction, from 0 to 4, without trigonometry.
fn order<R: Real>(x: R, y: R) -> R {
    let three = R::TWO + R::ONE;
    match (x >= R::ZERO, y >= R::ZERO) {
        (true, true) => y / (x + y),
        (false, true) => R::ONE - x / (y - x),
        (false, false) => R::TWO + y / (x + y),
        (true, false) => three + x / (x - y),
    }
}
