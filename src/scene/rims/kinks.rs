//! Where the forces on an arc have a kink.
//!
//! Two things are not smooth along it: Coulomb friction turns round where the slip passes 0, and the ground lets go where a place leaves faster than its spring expands.

use crate::body::{Arc, CUTS, sink_last};
use crate::friction::SlidingFriction;
use crate::ground::SpringDamperGround;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, Motion};

/// Velocities of the material along an arc: `lowest + across t - down t²/2` at `t = 2 κ u`, but for a share t²/8 of the second term.
pub(crate) struct Velocities<R: Real> {
    lowest: R::Vec3,
    across: R::Vec3,
    down: R::Vec3,
}

impl<R: Real> Velocities<R> {
    /// By that of the rim's middle, and by what its own two axes add.
    #[inline]
    pub(crate) fn along(arc: &Arc<R>, middle: R::Vec3, turning: [R::Vec3; 2]) -> Self {
        let [down, across] = arc.slopes(turning);
        Self {
            lowest: middle + down,
            across,
            down,
        }
    }

    /// By where the lowest place is from the rim's middle, and the one a quarter of a turn on; the middle from the centre of mass, all m.
    #[inline(always)]
    pub(super) fn of_spokes(
        motion: &Motion<R>,
        centre: R::Vec3,
        [down, across]: [R::Vec3; 2],
    ) -> Self {
        let spin = motion.angular_velocity;
        Self {
            lowest: motion.velocity_at(centre + down),
            across: spin.cross(across),
            down: spin.cross(down),
        }
    }

    /// Along a normal, and along the ground.
    #[inline]
    fn over(&self, normal: R::Vec3) -> ([R; 3], [R::Vec3; 3]) {
        let each = [self.lowest, self.across, self.down];
        let rising = each.map(|velocity| velocity.dot(normal));
        (
            rising,
            each.map(|velocity| velocity - normal * velocity.dot(normal)),
        )
    }

    /// The same where the normal is z.
    #[inline]
    pub(super) fn over_level(&self) -> ([R; 3], [R::Vec3; 3]) {
        let each = [self.lowest, self.across, self.down];
        let along = |v: R::Vec3| R::Vec3::new(v.x(), v.y(), R::ZERO);
        (each.map(|velocity| velocity.z()), each.map(along))
    }
}

/// Where the forces on an arc have a kink, in order, as `u = sin(θ/2)/κ`, with the ground's unit normal in world axes.
#[inline]
pub(crate) fn kinks<R: Real, D: Dynamics<R> + ?Sized>(
    scene: &D,
    arc: &Arc<R>,
    normal: R::Vec3,
    velocities: &Velocities<R>,
) -> Kinks<R> {
    let (rising, slips) = velocities.over(normal);
    kinks_along(scene, [arc.chord(), arc.extent()], rising, slips)
}

/// The same by the velocities along the normal and along the ground.
#[inline(always)]
pub(super) fn kinks_along<R: Real, D: Dynamics<R> + ?Sized>(
    scene: &D,
    [chord, extent]: [R; 2],
    rising: [R; 3],
    slips: [R::Vec3; 3],
) -> Kinks<R> {
    let mut kinks = Kinks::none();
    if may_turn(slips, chord) && rubs(scene.friction(), slips) {
        for place in slowest(slips, chord).into_iter().flatten() {
            kinks.add(Kink {
                u: place,
                turns: true,
            });
        }
    }
    let [lowest, across, down] = rising;
    let edges = Edges {
        ground: scene.ground(),
        deepest: extent * (chord * chord) * R::TWO,
        chord,
        speeds: [-lowest, -across, down],
    };
    edges.let_go(&mut kinks);
    kinks
}

/// Whether a law has friction at all. It is asked at more than the first slip, which is 0 where the lowest place stands still.
#[inline]
fn rubs<R: Real, F: SlidingFriction<R>>(friction: &F, slips: [R::Vec3; 3]) -> bool {
    (slips.into_iter()).any(|slip| friction.force(R::ONE, slip) != R::Vec3::ZERO)
}

/// Whether the slip may come near to 0 on an arc: where it varies by no more than a seventh of itself, an arc is smooth to 1e-9 without a cut.
#[inline(always)]
fn may_turn<R: Real>([a, b, k]: [R::Vec3; 3], chord: R) -> bool {
    let square = R::from_f64(4.0) * (chord * chord);
    let varies = square * (b.length_squared() + square * k.length_squared());
    varies * R::from_f64(49.0) > a.length_squared()
}

/// Where on an arc the slip is least, as `u = sin(θ/2)/κ`: at most two places.
///
/// With `t = 2 κ u` a place lies at `(1 - t²/2)` times the lowest and `t √(1 - t²/4)` across, so that the slip is `a + b t - k t²/2` but for a share t²/8 of the second term. Its square is least where
///
/// ```text
/// g(t) = (a + b t - k t²/2)·(b - k t) = 0
/// ```
/// with `g` rising: the first such place from the left, by Newton's steps from the end, and the last one, by the quadratic that is left without the first; or the other way round.
#[inline]
fn slowest<R: Real>([a, b, k]: [R::Vec3; 3], chord: R) -> [Option<R>; 2] {
    let scale = R::TWO * chord;
    let (b, k) = (b * scale, k * (scale * scale));
    let three = R::TWO + R::ONE;
    let (c0, c1) = (a.dot(b), b.dot(b) - a.dot(k));
    let (c2, c3) = (-(three * R::HALF * b.dot(k)), R::HALF * k.dot(k));
    let root = |end: R| {
        let mut u = end;
        for _ in 0..STEPS {
            let slope = c1 + u * (R::TWO * c2 + u * (three * c3));
            if slope <= R::ZERO {
                return None;
            }
            let step = (c0 + u * (c1 + u * (c2 + u * c3))) / slope;
            u -= step;
            if step.abs() < R::from_f64(1e-9) {
                break;
            }
        }
        Some(u)
    };
    let on_arc = |u: R| (u > -R::ONE && u < R::ONE).then_some(u);
    let (first, side) = match root(-R::ONE) {
        Some(first) => (first, R::ONE),
        None => match root(R::ONE) {
            Some(last) => (last, -R::ONE),
            None => return [None; 2],
        },
    };
    // g/(u - first) = c3 u² + d1 u + d0
    let d1 = c2 + c3 * first;
    let d0 = c1 + d1 * first;
    let square = d1 * d1 - R::from_f64(4.0) * c3 * d0;
    let other = if square > R::ZERO {
        on_arc((square.sqrt() * side - d1) / (R::TWO * c3))
    } else {
        None
    };
    [on_arc(first), other]
}

/// Newton's steps to a least slip: so many that what is left of a turning point is small beside a Gauss point's distance from the end.
const STEPS: u32 = 5;

/// The ends of an arc, of which one may leave the ground.
struct Edges<'a, R, G> {
    ground: &'a G,
    /// Of the lowest place, m.
    deepest: R,
    chord: R,
    /// At which the lowest place closes, and what sine and fall add, m/s.
    speeds: [R; 3],
}

impl<R: Real, G: SpringDamperGround<R>> Edges<'_, R, G> {
    /// Closing speed at `sin(θ/2) = κ u`, m/s.
    #[inline(always)]
    fn closing_speed(&self, u: R) -> R {
        let [lowest, across, down] = self.speeds;
        let s = self.chord * u;
        // √(1 - s²) to s⁴/8.
        lowest + (across + across) * (s * (R::ONE - s * s * R::HALF)) + (down + down) * (s * s)
    }

    /// The normal force of a point there, N.
    #[inline(always)]
    fn force(&self, u: R) -> R {
        let depth = self.deepest * ((R::ONE - u) * (R::ONE + u));
        if depth > R::ZERO {
            self.ground.normal_force(depth, self.closing_speed(u))
        } else {
            R::ZERO
        }
    }

    /// Adds where the ground lets go, if an end leaves so fast that the normal force falls to 0 before the depth does.
    ///
    /// For a law that is linear in depth and speed the force is `a + b u - c u²` along the arc, but for κ² of the speed's part: three places tell its roots. They serve others too, as far as the force is 0 beyond.
    #[inline(always)]
    fn let_go(&self, kinks: &mut Kinks<R>) {
        let leaves = [-R::ONE, R::ONE].map(|end| self.closing_speed(end) < R::ZERO);
        if leaves == [false; 2] {
            return;
        }
        let (a, left, right) = (
            self.force(R::ZERO),
            self.force(-R::HALF),
            self.force(R::HALF),
        );
        if left <= R::ZERO || right <= R::ZERO || a <= R::ZERO {
            self.seek(leaves, kinks);
            return;
        }
        let (b, c) = (right - left, R::TWO * (a + a - left - right));
        if c <= R::ZERO {
            return;
        }
        let (root, per) = ((b * b + R::from_f64(4.0) * a * c).sqrt(), R::HALF / c);
        for (side, ends) in [(b - root) * per, (b + root) * per].into_iter().enumerate() {
            if leaves[side] && ends.abs() < R::from_f64(1.0 - 1e-5) {
                self.add(kinks, side, ends);
            }
        }
    }

    /// Cuts at a place that a side lets go at.
    #[inline(always)]
    fn add(&self, kinks: &mut Kinks<R>, side: usize, u: R) {
        kinks.add(Kink { u, turns: false });
        let end = if side == 0 { -R::ONE } else { R::ONE };
        if self.force((u + end) * R::HALF) <= R::ZERO {
            kinks.pushed[side] = u;
        }
    }

    /// The same for dampers so strong that they hold the half of an arc: by bisection.
    #[inline(never)]
    fn seek(&self, leaves: [bool; 2], kinks: &mut Kinks<R>) {
        for (side, end) in [-R::ONE, R::ONE].into_iter().enumerate() {
            let (mut out, mut within) = (end, -end);
            // From the other end, which pushes, or does not leave.
            if !leaves[side] || leaves[1 - side] && self.force(R::ZERO) <= R::ZERO {
                continue;
            }
            if leaves[1 - side] {
                within = R::ZERO;
            }
            for _ in 0..BISECTIONS {
                let middle = (out + within) * R::HALF;
                if self.force(middle) > R::ZERO {
                    within = middle;
                } else {
                    out = middle;
                }
            }
            if (out - end).abs() > R::from_f64(1e-5) && (out + end).abs() > R::from_f64(1e-5) {
                self.add(kinks, side, out);
            }
        }
    }
}

/// To 5e-7 of an arc.
const BISECTIONS: u32 = 22;

/// Places of an arc, in order.
pub(crate) struct Kinks<R> {
    places: [Kink<R>; CUTS],
    count: usize,
    /// Between which of them, or the ends, the ground pushes.
    pub(super) pushed: [R; 2],
}

/// Where a force has a kink.
#[derive(Clone, Copy)]
pub(super) struct Kink<R> {
    /// `sin(θ/2)/κ`
    pub(super) u: R,
    /// Whether the slip is least there, so that friction turns round within a slip speed of it.
    pub(super) turns: bool,
}

impl<R: Real> Kinks<R> {
    #[inline(always)]
    fn none() -> Self {
        Self {
            places: [Kink::end(); CUTS],
            count: 0,
            pushed: [-R::ONE, R::ONE],
        }
    }

    #[inline]
    fn add(&mut self, kink: Kink<R>) {
        let Some(place) = self.places.get_mut(self.count) else {
            return;
        };
        *place = kink;
        self.count += 1;
        sink_last(
            self.places.get_mut(..self.count).unwrap_or_default(),
            |kink| kink.u,
        );
    }

    #[inline(always)]
    pub(super) fn iter(&self) -> impl Iterator<Item = Kink<R>> + '_ {
        self.places.iter().take(self.count).copied()
    }

    /// As `sin(θ/2)/κ`.
    pub(crate) fn places(&self) -> impl Iterator<Item = R> + '_ {
        self.iter().map(|kink| kink.u)
    }
}

impl<R: Real> Kink<R> {
    /// The end of the arc, where nothing turns.
    #[inline(always)]
    pub(super) fn end() -> Self {
        Self {
            u: R::ONE,
            turns: false,
        }
    }
}
