//! Arcs, divided into panels for Gauss's rule.

use super::{Arc, Direction, QUARTER, turned};
use crate::real::Real;

/// Piece of arc of at most a quarter of the circle, given by its middle and
/// `sin(half its half angle)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Panel<R> {
    pub(super) middle: Direction<R>,
    pub(super) chord: R,
}

impl<R: Real> Panel<R> {
    #[inline]
    pub(crate) fn middle(&self) -> Direction<R> {
        self.middle
    }

    #[inline]
    pub(crate) fn chord(&self) -> R {
        self.chord
    }
}

/// Most cuts, and most panels: at two times the ends of twelve pieces that form four arcs, the cuts
/// into quarters, and four further cuts. Further cuts beyond those are left out.
const MOST: usize = 40;
/// Most further cuts.
pub(crate) const CUTS: usize = 4;

/// Panels of the arc below ground at one time, or at either of two times. No end of an arc lies
/// within a panel.
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

    /// Panels of one arc, cut at the positions `cuts`: `sin(θ/2)/sin(α/2)`, from -1 to 1 along the
    /// arc.
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
                let mut places = cuts.map(|cut| arc.place(cut));
                return Self::of_all([&[arc], &[]], &mut places);
            }
        }
        panels
    }

    /// Adds the panel between two half angles from the lowest point.
    #[inline]
    fn push_between(&mut self, lowest: Direction<R>, [a, b]: Direction<R>, [c, d]: Direction<R>) {
        // Sine and cosine of half the panel's angle.
        let (sin, cos) = (d * a - c * b, c * a + d * b);
        if sin > R::EPSILON {
            let middle = turned(lowest, turned([a, b], [c, d]));
            self.push(middle, half_of(sin, cos));
        }
    }

    /// Panels of the arcs at two times together, cut at these positions.
    #[inline(never)]
    pub(crate) fn of_all(
        times: [&[Arc<R>]; 2],
        places: &mut dyn Iterator<Item = Direction<R>>,
    ) -> Self {
        let mut panels = Self::NONE;
        let arcs = || times.into_iter().flatten();
        if arcs().all(|arc| *arc == Arc::Nothing) {
            return panels;
        }
        // The circle is counted from the point opposite the lowest one, so that no arc of rolling
        // contact crosses the seam.
        let middle = arcs().find_map(Arc::lowest);
        let frame = middle.unwrap_or([R::ONE, R::ZERO]).map(|x| -x);
        let half = R::from_f64(core::f64::consts::FRAC_1_SQRT_2);
        let quarters = [[half, half], [-half, half], [-half, -half], [half, -half]];
        let mut cuts = Cuts::NONE;
        for cut in quarters {
            cuts.add(frame, turned(frame, cut));
        }
        for pieces in times {
            cuts.add_ends(frame, pieces);
        }
        for place in places {
            cuts.add(frame, place);
        }
        let cuts = cuts.get();
        for (from, to) in cuts.iter().zip(cuts.iter().cycle().skip(1)) {
            let Some((middle, chord)) = between(from.place, to.place) else {
                continue;
            };
            if arcs().any(|arc| arc.holds(middle)) {
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

    /// Sum of the chords of all panels, which is that of their arcs if they are short.
    #[inline]
    pub(crate) fn total_chord(&self) -> R {
        self.iter().fold(R::ZERO, |sum, panel| sum + panel.chord)
    }

    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Panels, in the order along the rim.
    pub(crate) fn into_iter(self) -> impl Iterator<Item = Panel<R>> {
        self.panels.into_iter().take(self.count)
    }

    #[inline]
    pub(crate) fn iter(&self) -> impl Iterator<Item = Panel<R>> + '_ {
        self.panels.iter().take(self.count).copied()
    }
}

/// Middle and chord of the shorter arc between two directions. Returns `None` if they are equal to
/// rounding.
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

/// Returns true if two directions are equal to rounding.
fn meet<R: Real>([a, b]: Direction<R>, [c, d]: Direction<R>) -> bool {
    (c - a).abs() + (d - b).abs() <= R::EPSILON * R::from_f64(16.0)
}

/// Sine of half an angle: `sin(h/2) = sin h/√(2 (1 + cos h))`.
#[inline]
pub(super) fn half_of<R: Real>(sin: R, cos: R) -> R {
    sin / (R::TWO + R::TWO * cos).sqrt()
}

/// Cosine and sine of an angle with this sine.
#[inline]
pub(super) fn half_turn<R: Real>(sin: R) -> Direction<R> {
    [(R::ONE - sin * sin).at_least(R::ZERO).sqrt(), sin]
}

/// Direction and its position in the order round the circle.
#[derive(Clone, Copy, Debug)]
struct Cut<R> {
    place: Direction<R>,
    order: R,
}

/// Positions at which the circle is cut.
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
        let order = order(x, y);
        if let Some(cut) = self.cuts.get_mut(self.count) {
            *cut = Cut { place, order };
            self.count += 1;
            sink_last(self.cuts.get_mut(..self.count).unwrap_or_default(), |cut| {
                cut.order
            });
        }
    }

    /// Adds the ends of pieces, and only one where a piece begins at the end of another one.
    fn add_ends(&mut self, frame: Direction<R>, pieces: &[Arc<R>]) {
        let mut last = None;
        for [from, to] in pieces.iter().filter_map(Arc::ends) {
            if !last.is_some_and(|end| meet(end, from)) {
                self.add(frame, from);
            }
            self.add(frame, to);
            last = Some(to);
        }
    }

    fn get(&self) -> &[Cut<R>] {
        self.cuts.get(..self.count).unwrap_or_default()
    }
}

/// Moves the last element to its position in the sorted rest.
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

/// Increases with the angle of a direction, from 0 to 4, without trigonometry.
fn order<R: Real>(x: R, y: R) -> R {
    let three = R::TWO + R::ONE;
    match (x >= R::ZERO, y >= R::ZERO) {
        (true, true) => y / (x + y),
        (false, true) => R::ONE - x / (y - x),
        (false, false) => R::TWO + y / (x + y),
        (true, false) => three + x / (x - y),
    }
}
