//! Arcs of a rim below ground that need not be a plane.
//!
//! Along a rim, the gap is a function of the angle, with the slope `normal · dp/dθ`. It is
//! evaluated at equally spaced points of the rim. Between two of them,
//!
//! - a change of its sign is an end of an arc, found by the Illinois method (Dowell & Jarratt
//!   1971),
//! - a minimum above the ground or a maximum below it may cross the ground twice. Where the gap is
//!   convex, it lies above its tangents, so their intersection decides whether it can. If it can,
//!   the point of intersection divides the interval, until a point on the other side is found or
//!   excluded,
//! - a large turn of the normal is an edge of the ground. The interval is halved down to 0.06°.
//!
//! *Limits:* a rim that touches along more than twelve arcs is integrated as a whole, since a point
//! above the ground has no force. Pieces between edges of the ground count as arcs, and edges
//! beyond the twelfth piece are not taken into account. A box divides a rim into twelve at most,
//! three along each of four arcs, but for the rare section that is a hexagon. An arc is missed if
//! the gap has two minima between two neighbouring points, that is on smooth hills shorter than an
//! eighth of the rim's radius. Edges are missed between two equal normals at neighbouring points.

use crate::body::{Arc, Direction, Rim, turned};
use crate::ground::{GroundBounds, SpringDamperGround};
use crate::real::{Real, Vector};
use crate::rotation::Axes;

/// Number of points at which the gap is evaluated, 15° apart.
const POINTS: u32 = 24;
/// Cosine and sine of the angle between two of them.
const STEP: [f64; 2] = [0.965_925_826_289_068_3, 0.258_819_045_102_520_74];
/// Chord of that angle.
const STEP_CHORD: f64 = 0.261_052_384_440_103_2;
/// Cosine of the angle between two normals from which an edge is searched for between them: 26°.
const SHARP: f64 = 0.9;
/// Most halvings of the angle between two points next to an edge of the ground, down to 0.06°.
const MOST_HALVINGS: u32 = 8;
/// Most halvings where the lowest point is searched for next to an edge, down to 0.9°.
const HALVINGS_OF_MINIMA: u32 = 4;
/// Most halvings next to edges in all, so that a rim on a ground that is all edges takes no longer.
const MOST_HALVINGS_IN_ALL: u32 = 256;
/// Most evaluations for an end of an arc, or for the decision whether there is one.
const MOST: u32 = 40;

/// Most arcs of a rim below one surface, and most of their ends.
const MOST_ARCS: usize = 12;
const MOST_ENDS: usize = 2 * MOST_ARCS;

/// Arcs of a rim below one surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arcs<R> {
    arcs: [Arc<R>; MOST_ARCS],
    count: usize,
}

impl<R: Real> Arcs<R> {
    pub(super) const NONE: Self = Self {
        arcs: [Arc::Nothing; MOST_ARCS],
        count: 0,
    };

    #[inline]
    pub(super) fn one(arc: Arc<R>) -> Self {
        let mut arcs = Self::NONE;
        arcs.add(arc);
        arcs
    }

    /// Adds an arc. Arcs beyond the last place are left out.
    #[inline]
    fn add(&mut self, arc: Arc<R>) {
        if let Some(place) = self.arcs.get_mut(self.count) {
            *place = arc;
            self.count += 1;
        }
    }

    /// Arcs, some of which may be [`Arc::Nothing`].
    #[inline]
    pub(crate) fn get(&self) -> &[Arc<R>] {
        self.arcs.get(..self.count).unwrap_or_default()
    }

    /// Arcs that are not the whole rim.
    #[inline]
    pub(crate) fn parts(&self) -> impl Iterator<Item = Arc<R>> + '_ {
        let parts = self.get().iter().filter(|arc| arc.lowest().is_some());
        parts.copied()
    }

    /// Chord of the longest partial arc over the diameter of the rim, 0 if there is none.
    #[inline]
    pub(crate) fn longest(&self) -> R {
        let chords = self.parts().map(|arc| arc.chord());
        chords.fold(R::ZERO, R::at_least)
    }
}

/// Rim of a body in the world, with the ground under it.
pub(super) struct Placed<'a, R: Real, G> {
    rim: &'a Rim<R>,
    ground: &'a G,
    /// Centre, m, world axes.
    centre: R::Vec3,
    /// Axes of the rim's plane, world axes.
    axes: [R::Vec3; 2],
}

impl<'a, R: Real, G: SpringDamperGround<R>> Placed<'a, R, G> {
    pub(super) fn new(rim: &'a Rim<R>, ground: &'a G, position: R::Vec3, axes: &Axes<R>) -> Self {
        Self {
            rim,
            ground,
            centre: position + axes.to_world(rim.centre()),
            axes: axes.both_to_world(rim.axes()),
        }
    }

    /// Gap at the point of the rim in a direction.
    fn height(&self, place: Direction<R>) -> Height<R> {
        let [down, across] = self.rim.spokes(self.axes, place);
        let surface = self.ground.surface(self.centre + down);
        Height {
            place,
            normal: surface.normal,
            gap: surface.gap,
            slope: surface.normal.dot(across),
        }
    }

    /// Gap between two points, for a fraction of their chord.
    fn height_between(&self, [left, right]: [&Height<R>; 2], fraction: R) -> Height<R> {
        self.height(between(left.place, right.place, fraction))
    }

    /// Calls `visit` with both ends of each interval between equally spaced points of the rim.
    /// Returns the first point.
    fn visit_intervals(&self, mut visit: impl FnMut([Height<R>; 2])) -> Height<R> {
        let step = STEP.map(R::from_f64);
        let start = self.height([R::ONE, R::ZERO]);
        let mut left = start;
        for number in 1..=POINTS {
            let right = if number == POINTS {
                start
            } else {
                self.height(turned(left.place, step))
            };
            visit([left, right]);
            left = right;
        }
        start
    }
}

/// Gap at a point of a rim.
#[derive(Clone, Copy)]
struct Height<R: Real> {
    place: Direction<R>,
    normal: R::Vec3,
    /// m.
    gap: R,
    /// Change of the gap with the angle along the rim, m.
    slope: R,
}

impl<R: Real> Height<R> {
    fn is_below(&self) -> bool {
        self.gap < R::ZERO
    }
}

/// Arcs of a rim below the ground.
#[inline]
pub(super) fn below<R: Real, G: SpringDamperGround<R>>(
    rim: &Rim<R>,
    ground: &G,
    position: R::Vec3,
    axes: &Axes<R>,
) -> Arcs<R> {
    let centre = position + axes.to_world(rim.centre());
    match ground.bounds() {
        GroundBounds::Nowhere => Arcs::NONE,
        GroundBounds::Plane(plane) => {
            Arcs::one(rim.arc_below(axes.to_body(plane.normal), plane.gap(centre)))
        }
        GroundBounds::Below(plane)
            if plane.gap(centre) > rim.radius() * rim.steepness(axes.to_body(plane.normal)) =>
        {
            Arcs::NONE
        }
        GroundBounds::Below(_) | GroundBounds::Everywhere => {
            arcs_below(&Placed::new(rim, ground, position, axes))
        }
    }
}

/// Finds the arcs of a rim below the ground.
#[inline(never)]
fn arcs_below<R: Real, G: SpringDamperGround<R>>(placed: &Placed<'_, R, G>) -> Arcs<R> {
    let mut ends = Ends::NONE;
    let start = placed.visit_intervals(|interval| {
        add_ends(placed, interval, MOST_HALVINGS, &mut ends);
    });
    if ends.count > MOST_ENDS {
        return Arcs::one(Arc::Whole);
    }
    if ends.count == 0 {
        return if start.is_below() {
            Arcs::one(Arc::Whole)
        } else {
            Arcs::NONE
        };
    }
    if start.is_below() {
        ends.turn();
    }
    cut_at_edges(placed, &ends).arcs(|place| placed.height(place).gap)
}

/// Divides arcs at the edges of the ground, where its normal has a jump. There the slope of the
/// penetration depth has a discontinuity, across which a Gauss rule would lose accuracy.
fn cut_at_edges<R: Real, G: SpringDamperGround<R>>(
    placed: &Placed<'_, R, G>,
    ends: &Ends<R>,
) -> Ends<R> {
    let mut cut = Ends::NONE;
    let step = STEP.map(R::from_f64);
    let mut arcs_left = ends.count / 2;
    for [from, to] in ends.pairs() {
        cut.add(from);
        let (mut left, last) = (placed.height(from), placed.height(to));
        // The end of an arc along almost the whole rim is also close behind its beginning.
        let is_end_behind = from[0] * to[1] - from[1] * to[0] < -R::EPSILON;
        let first_with_end = if is_end_behind { POINTS / 4 } else { 0 };
        for number in 0..=POINTS {
            let next = turned(left.place, step);
            let is_near = chord_between(left.place, to) <= R::from_f64(STEP_CHORD);
            let is_last = is_near && number >= first_with_end;
            let right = if is_last { last } else { placed.height(next) };
            // This arc still needs an end, and each that follows two.
            let room = MOST_ENDS - (cut.count + 2 * arcs_left - 1).min(MOST_ENDS);
            add_edges(placed, [left, right], room / 2, &mut cut);
            if is_last {
                break;
            }
            left = right;
        }
        cut.add(to);
        arcs_left -= 1;
    }
    cut
}

/// Adds the edges between two points, at most `most` of them, in order.
fn add_edges<R: Real, G: SpringDamperGround<R>>(
    placed: &Placed<'_, R, G>,
    [left, right]: [Height<R>; 2],
    most: usize,
    cut: &mut Ends<R>,
) {
    let found = (most > 0).then(|| edge(placed, [left, right])).flatten();
    let Some([before, after]) = found else {
        return;
    };
    // The others are those before and those after it.
    let count = cut.count;
    add_edges(placed, [left, before], most - 1, cut);
    cut.add(after.place);
    cut.add(after.place);
    let added = (cut.count - count) / 2;
    add_edges(placed, [after, right], most.saturating_sub(added), cut);
}

/// Points on both sides of an edge between two points, at which the normal has a jump, if it has
/// one. On both sides of an edge the gap is smooth, so the intersection of its tangents comes close
/// to it.
fn edge<R: Real, G: SpringDamperGround<R>>(
    placed: &Placed<'_, R, G>,
    [mut left, mut right]: [Height<R>; 2],
) -> Option<[Height<R>; 2]> {
    let close = R::EPSILON.sqrt();
    for _ in 0..MOST {
        if !turns(&left, &right) {
            return None;
        }
        let width = chord_between(left.place, right.place);
        if width <= close * R::from_f64(4.0) {
            break;
        }
        let bend = (right.slope - left.slope) * width;
        let share = (right.slope * width - (right.gap - left.gap)) / bend;
        // Near an end, a small step beyond the intersection brings the other end close as well.
        let share = if share > R::ZERO && share < R::ONE {
            let beyond = close / width;
            if share < R::HALF {
                share + beyond
            } else {
                share - beyond
            }
        } else {
            R::HALF
        };
        let middle = placed.height_between([&left, &right], share);
        if middle.normal.dot(left.normal) > middle.normal.dot(right.normal) {
            left = middle;
        } else {
            right = middle;
        }
    }
    Some([left, right])
}

/// Finds the point of a rim with the least gap.
#[inline(never)]
pub(super) fn lowest<R: Real, G: SpringDamperGround<R>>(placed: &Placed<'_, R, G>) -> Direction<R> {
    let mut lowest = placed.height([R::ONE, R::ZERO]);
    placed.visit_intervals(|interval| {
        lower(placed, interval, HALVINGS_OF_MINIMA, &mut lowest);
    });
    lowest.place
}

/// Replaces the lowest point by one between two others, or by the second of them, if that is lower.
/// An interval with an edge of the ground may have several minima, so it is halved.
fn lower<R: Real, G: SpringDamperGround<R>>(
    placed: &Placed<'_, R, G>,
    [left, right]: [Height<R>; 2],
    halvings: u32,
    lowest: &mut Height<R>,
) {
    if halvings > 0 && turns(&left, &right) {
        let middle = placed.height_between([&left, &right], R::HALF);
        lower(placed, [left, middle], halvings - 1, lowest);
        lower(placed, [middle, right], halvings - 1, lowest);
        return;
    }
    let has_minimum = left.slope < R::ZERO && right.slope > R::ZERO;
    let minimum = has_minimum.then(|| zero_of(placed, |at| at.slope, [left, right]));
    for height in [Some(right), minimum].into_iter().flatten() {
        if height.gap < lowest.gap {
            *lowest = height;
        }
    }
}

/// Adds the ends of arcs between two points.
///
/// An interval with an edge of the ground may have any number of ends, so it is halved. There the
/// gap is a distance, which changes by no more than the path, so many halves are left out.
fn add_ends<R: Real, G: SpringDamperGround<R>>(
    placed: &Placed<'_, R, G>,
    [left, right]: [Height<R>; 2],
    halvings: u32,
    ends: &mut Ends<R>,
) {
    let has_end = left.is_below() != right.is_below();
    if halvings > 0 && ends.halvings < MOST_HALVINGS_IN_ALL && turns(&left, &right) {
        let path = chord_between(left.place, right.place) * placed.rim.radius();
        if has_end || left.gap.abs() + right.gap.abs() <= path {
            ends.halvings += 1;
            let middle = placed.height_between([&left, &right], R::HALF);
            add_ends(placed, [left, middle], halvings - 1, ends);
            add_ends(placed, [middle, right], halvings - 1, ends);
        }
    } else if has_end {
        ends.add(end(placed, [left, right]));
    } else if let Some(beyond) = other_side(placed, [left, right]) {
        ends.add(end(placed, [left, beyond]));
        ends.add(end(placed, [beyond, right]));
    }
}

/// End of an arc between two points on different sides of the ground.
fn end<R: Real, G: SpringDamperGround<R>>(
    placed: &Placed<'_, R, G>,
    around: [Height<R>; 2],
) -> Direction<R> {
    zero_of(placed, |height| height.gap, around).place
}

/// Returns true if there may be an edge of the ground between two points.
fn turns<R: Real>(a: &Height<R>, b: &Height<R>) -> bool {
    a.normal.dot(b.normal) < R::from_f64(SHARP)
}

/// Point between two on the same side of the ground that is on the other side, if there is one.
///
/// For intervals in which the gap is convex towards the ground.
fn other_side<R: Real, G: SpringDamperGround<R>>(
    placed: &Placed<'_, R, G>,
    [mut left, mut right]: [Height<R>; 2],
) -> Option<Height<R>> {
    let is_below = left.is_below();
    let side = if is_below { -R::ONE } else { R::ONE };
    for _ in 0..MOST {
        // Towards the ground on both sides.
        let (falls, rises) = (left.slope * side, right.slope * side);
        if !(falls < R::ZERO && rises > R::ZERO) {
            return None;
        }
        let width = chord_between(left.place, right.place);
        let (from, to) = (left.gap * side, right.gap * side);
        let share = ((to - from) - rises * width) / ((falls - rises) * width);
        let least = from + falls * width * share;
        if !(least < R::ZERO && share > R::ZERO && share < R::ONE) {
            return None;
        }
        let middle = placed.height_between([&left, &right], share);
        if middle.is_below() != is_below {
            return Some(middle);
        }
        if middle.slope * side < R::ZERO {
            left = middle;
        } else {
            right = middle;
        }
    }
    None
}

/// Point between two at which a value that has opposite signs there is 0.
fn zero_of<R: Real, G: SpringDamperGround<R>>(
    placed: &Placed<'_, R, G>,
    value: fn(&Height<R>) -> R,
    [left, right]: [Height<R>; 2],
) -> Height<R> {
    let ([mut a, mut b], [mut at_a, mut at_b]) = ([R::ZERO, R::ONE], [value(&left), value(&right)]);
    let mut middle = left;
    let mut last = None;
    for _ in 0..MOST {
        let share = a + (b - a) * (at_a / (at_a - at_b));
        middle = placed.height_between([&left, &right], share);
        let here = value(&middle);
        if here.abs() <= placed.rim.radius() * R::EPSILON || b - a <= R::EPSILON {
            break;
        }
        let is_left = (here < R::ZERO) == (value(&left) < R::ZERO);
        if is_left {
            (a, at_a) = (share, here);
        } else {
            (b, at_b) = (share, here);
        }
        // The end that stays twice counts half, so that it moves.
        if last == Some(is_left) {
            let stays = if is_left { &mut at_b } else { &mut at_a };
            *stays *= R::HALF;
        }
        last = Some(is_left);
    }
    middle
}

/// Direction between two, for a share of the chord.
fn between<R: Real>([a, b]: Direction<R>, [c, d]: Direction<R>, share: R) -> Direction<R> {
    let (x, y) = (a + (c - a) * share, b + (d - b) * share);
    let per_length = R::ONE / (x * x + y * y).sqrt();
    [x * per_length, y * per_length]
}

/// Chord between two directions: between neighbours their angle, to 0.3 %.
fn chord_between<R: Real>([a, b]: Direction<R>, [c, d]: Direction<R>) -> R {
    ((c - a) * (c - a) + (d - b) * (d - b)).sqrt()
}

/// Ends of arcs, in order along the rim. Arcs begin and end in turn.
struct Ends<R> {
    places: [Direction<R>; MOST_ENDS],
    count: usize,
    /// Number of intervals that were halved in the search.
    halvings: u32,
}

impl<R: Real> Ends<R> {
    const NONE: Self = Self {
        places: [[R::ONE, R::ZERO]; MOST_ENDS],
        count: 0,
        halvings: 0,
    };

    /// Adds the next end. Ends beyond the last place are only counted.
    fn add(&mut self, place: Direction<R>) {
        if let Some(next) = self.places.get_mut(self.count) {
            *next = place;
        }
        self.count += 1;
    }

    /// Makes the second end the first.
    fn turn(&mut self) {
        if let Some(places) = self.places.get_mut(..self.count) {
            places.rotate_left(1);
        }
    }

    /// Both ends of each arc.
    fn pairs(&self) -> impl Iterator<Item = [Direction<R>; 2]> + '_ {
        let pairs = self.places.chunks_exact(2).take(self.count / 2);
        pairs.filter_map(|pair| pair.try_into().ok())
    }

    /// Arcs between the ends, for the gap at a point (m).
    fn arcs(&self, gap: impl Fn(Direction<R>) -> R) -> Arcs<R> {
        let mut arcs = Arcs::NONE;
        for [from, to] in self.pairs() {
            arcs.add(Arc::between(from, to, &gap));
        }
        arcs
    }
}
