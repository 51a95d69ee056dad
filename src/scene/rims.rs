//! Rims on the ground: the arc that touches, and where its forces have a kink.
//!
//! A Gauss rule is good for what is smooth. Along an arc two things are not: Coulomb friction turns round where the slip passes 0, and the ground lets go where a place leaves faster than its spring
//! expands. So the arc is cut there.
//!
//! On a level plane depth and velocity are linear in sine and cosine along the arc, and a short one goes the short way of a [`Sweep`]; any other arc goes place by place ([`visit_any`]).

use super::{Contact, Dynamics, Load, Motion};
use crate::body::{Arc, CUTS, ContactPoint, Panels, QUARTER, Rim, SHORT, sink_last};
use crate::friction::SlidingFriction;
use crate::ground::{Extent, Plane, SpringDamperGround, Surface};
use crate::real::{Real, Vector};
use crate::rotation::Axes;

/// What of a rim lies below ground: below the plane that touches the ground under the rim's lowest place.
#[inline]
pub(crate) fn arc_below<R: Real, G: SpringDamperGround<R>>(
    rim: &Rim<R>,
    ground: &G,
    position: R::Vec3,
    axes: &Axes<R>,
) -> Arc<R> {
    let centre = position + axes.to_world(rim.centre());
    match ground.extent() {
        Extent::Nowhere => Arc::Nothing,
        Extent::Plane(plane) => rim.arc_below(axes.to_body(plane.normal), plane.gap(centre)),
        Extent::Below(plane)
            if plane.gap(centre) > rim.radius() * rim.steepness(axes.to_body(plane.normal)) =>
        {
            Arc::Nothing
        }
        Extent::Below(_) | Extent::Everywhere => {
            let (surface, place) = lowest(rim, ground, position, axes);
            let normal = axes.to_body(surface.normal);
            rim.arc_below(normal, surface.gap + normal.dot(rim.centre() - place))
        }
    }
}

/// The lowest place of a rim (body axes), and the surface under it: by a few looks along the normal under the last one, exact on a plane.
pub(super) fn lowest<R: Real, G: SpringDamperGround<R>>(
    rim: &Rim<R>,
    ground: &G,
    position: R::Vec3,
    axes: &Axes<R>,
) -> (Surface<R>, R::Vec3) {
    let under = |place: R::Vec3| ground.surface(position + axes.to_world(place));
    let mut place = rim.centre();
    let mut surface = under(place);
    for _ in 0..LOOKS {
        place = rim.support_point(axes.to_body(-surface.normal));
        surface = under(place);
    }
    (surface, place)
}

/// Each takes the angle that is lacking to its ratio of the rim's radius to the ground's radius of curvature.
const LOOKS: u32 = 3;

/// What of a rim touches.
pub(super) enum Touching<R: Real> {
    Nothing,
    /// A short arc below a level plane.
    Arc(Sweep<R>),
    /// More than a quarter of the circle, or on another ground.
    Any,
}

impl<R: Real> Touching<R> {
    #[inline(always)]
    pub(super) fn of<D: Dynamics<R> + ?Sized>(scene: &D, rim: &Rim<R>, motion: &Motion<R>) -> Self {
        match scene.ground().extent() {
            Extent::Plane(plane) if plane == Plane::level(plane.height) => {
                Self::above(scene, plane.height, rim, motion)
            }
            _ => Self::Any,
        }
    }

    #[inline(always)]
    fn above<D: Dynamics<R> + ?Sized>(
        scene: &D,
        height: R,
        rim: &Rim<R>,
        motion: &Motion<R>,
    ) -> Self {
        let centre = motion.axes.to_world(rim.centre());
        let axes = rim.axes().map(|axis| motion.axes.to_world(axis));
        let gap = motion.position.z() + centre.z() - height;
        match rim.arc_of(axes.map(|axis| axis.z()), gap) {
            Arc::Nothing => Self::Nothing,
            Arc::Part {
                lowest,
                chord,
                extent,
            } if chord <= R::from_f64(QUARTER) => {
                let [down, across] = rim.spokes(axes, lowest);
                let spin = motion.angular_velocity;
                let velocities = Velocities {
                    lowest: motion.velocity_at(centre + down),
                    across: spin.cross(across),
                    down: spin.cross(down),
                };
                let (rising, slips) = velocities.over_level();
                Self::Arc(Sweep {
                    chord,
                    extent,
                    rising,
                    slips,
                    kinks: kinks_along(scene, [chord, extent], rising, slips),
                    density: rim.points() * R::from_f64(core::f64::consts::FRAC_1_PI),
                    lowest,
                })
            }
            _ => Self::Any,
        }
    }
}

/// The energy of the springs under a rim, J, and how many places stand for it.
#[inline]
pub(super) fn spring_energy<R: Real, D: Dynamics<R> + ?Sized>(
    scene: &D,
    rim: &Rim<R>,
    at_rest: &Motion<R>,
) -> (R, usize) {
    let (mut energy, mut touching) = (R::ZERO, 0);
    match Touching::of(scene, rim, at_rest) {
        Touching::Nothing => {}
        Touching::Arc(sweep) => (energy, touching) = sweep.spring_energy(scene.ground()),
        Touching::Any => visit_any(scene, rim, at_rest, &mut |contact| {
            energy += scene.ground().spring_energy(contact.depth) * contact.weight;
            touching += 1;
        }),
    }
    (energy, touching)
}

/// A short arc below a level plane, along which everything is linear in 1, the sine of the angle θ from the lowest place, and the fall `1 - cos θ`.
///
/// With `s = sin(θ/2)` in place of θ, from `-κ` to `κ`, and the extent `r s` of the rim below its middle,
///
/// ```text
/// sin θ = 2 s √(1 - s²)     1 - cos θ = 2 s²     depth = 2 extent (κ - s)(κ + s)     dθ = 2 ds/√(1 - s²)
/// velocity = lowest + across sin θ - down (1 - cos θ)
/// ```
/// A force f has the torque `(lowest + across sin θ - down (1 - cos θ)) × f` with the places in the same words, so that all of them together need no arms, but the sums of `f`, `f sin θ` and `f (1 - cos θ)`.
pub(super) struct Sweep<R: Real> {
    chord: R,
    /// m.
    extent: R,
    /// Upward velocities, m/s: at the lowest place, and those that sine and fall add.
    rising: [R; 3],
    /// The same along the ground.
    slips: [R::Vec3; 3],
    kinks: Kinks<R>,
    /// Points on the rim for half a radian.
    density: R,
    lowest: [R; 2],
}

/// Gauss's rule for a piece of a sweep with this half length in s, of an arc with this chord: places from -1 to 1, and weights.
///
/// The springs' force goes with `(κ² - s²)/√(1 - s²)`, of which m points on the whole arc leave `3.6e-3 κ⁶`, `8e-4 κ⁸`, `1.8e-4 κ¹⁰` for m = 4, 5, 6 by the rule's error term; two points leave `0.07 (half/κ)⁵ κ²` of it. So each is
/// good to 4e-11, as eight are at the longest arc.
///
/// At an end where friction turns round, within a slip speed of it, places stand closer: with `x = y²` from there, or `x = (3y - y³)/2` between two such ends. There a rule is as good as one of half as many points: to 3e-8 on a quarter of the circle.
#[inline(always)]
fn gauss_rule<R: Real>(half: R, chord: R, turns: [bool; 2]) -> &'static [[f64; 2]] {
    if half <= R::from_f64(1e-3) && half * R::from_f64(16.0) <= chord {
        return &GAUSS_2;
    }
    let is_short = half <= R::from_f64(0.12);
    match turns {
        [false, false] if half <= R::from_f64(0.04) => &GAUSS_4,
        [false, false] if is_short => &GAUSS_5,
        [false, false] if half <= R::from_f64(0.2) => &GAUSS_6,
        [false, false] => &GAUSS_8,
        [true, false] if is_short => &FROM_5,
        [true, false] => &FROM_8,
        [false, true] if is_short => &UP_TO_5,
        [false, true] => &UP_TO_8,
        [true, true] if is_short => &BETWEEN_5,
        [true, true] => &BETWEEN_8,
    }
}

const GAUSS_2: [[f64; 2]; 2] = both([[0.577_350_269_189_625_8, 1.0]]);
const GAUSS_4: [[f64; 2]; 4] = both([
    [0.339_981_043_584_856_3, 0.652_145_154_862_546_1],
    [0.861_136_311_594_052_6, 0.347_854_845_137_453_9],
]);
const GAUSS_5: [[f64; 2]; 5] = [
    [0.0, 0.568_888_888_888_888_9],
    [0.538_469_310_105_683_1, 0.478_628_670_499_366_5],
    [-0.538_469_310_105_683_1, 0.478_628_670_499_366_5],
    [0.906_179_845_938_664, 0.236_926_885_056_189_1],
    [-0.906_179_845_938_664, 0.236_926_885_056_189_1],
];
const GAUSS_6: [[f64; 2]; 6] = both(crate::body::GAUSS_6);
const GAUSS_8: [[f64; 2]; 8] = both(crate::body::GAUSS_8);
const FROM_5: [[f64; 2]; 5] = from_left(GAUSS_5, 1.0);
const FROM_8: [[f64; 2]; 8] = from_left(GAUSS_8, 1.0);
const UP_TO_5: [[f64; 2]; 5] = from_left(GAUSS_5, -1.0);
const UP_TO_8: [[f64; 2]; 8] = from_left(GAUSS_8, -1.0);
const BETWEEN_5: [[f64; 2]; 5] = between(GAUSS_5);
const BETWEEN_8: [[f64; 2]; 8] = between(GAUSS_8);

/// The places above 0, and those below.
const fn both<const HALF: usize, const ALL: usize>(half: [[f64; 2]; HALF]) -> [[f64; 2]; ALL] {
    let mut all = [[0.0; 2]; ALL];
    let mut i = 0;
    while i < ALL {
        let [place, weight] = half[i / 2];
        all[i] = [if i % 2 == 0 { place } else { -place }, weight];
        i += 1;
    }
    all
}

/// Closer towards -1, or towards 1 where the side is -1: `x = 2y² - 1` with y from 0 to 1.
const fn from_left<const N: usize>(mut rule: [[f64; 2]; N], side: f64) -> [[f64; 2]; N] {
    let mut i = 0;
    while i < N {
        let [place, weight] = rule[i];
        let y = 0.5 + 0.5 * place;
        rule[i] = [side * (2.0 * y * y - 1.0), 2.0 * y * weight];
        i += 1;
    }
    rule
}

/// Closer towards both ends.
const fn between<const N: usize>(mut rule: [[f64; 2]; N]) -> [[f64; 2]; N] {
    let mut i = 0;
    while i < N {
        let [y, weight] = rule[i];
        rule[i] = [0.5 * y * (3.0 - y * y), 1.5 * (1.0 - y * y) * weight];
        i += 1;
    }
    rule
}

/// A place of a sweep.
pub(super) struct Node<R: Real> {
    /// Of the angle from the lowest place.
    sin: R,
    /// 1 less its cosine.
    fall: R,
    depth: R,
    closing_speed: R,
    slip: R::Vec3,
    weight: R,
}

impl<R: Real> Sweep<R> {
    /// Calls `visit` with each place that stands for the arc.
    #[inline(always)]
    pub(super) fn visit(&self, mut visit: impl FnMut(&Node<R>)) {
        self.visit_within([-R::ONE, R::ONE], &mut visit);
    }

    /// The same within a part of the arc that no kink cuts short.
    #[inline(always)]
    fn visit_within(&self, [first, last]: [R; 2], visit: &mut impl FnMut(&Node<R>)) {
        let mut from = Kink {
            u: -R::ONE,
            turns: false,
        };
        for to in self.kinks.iter().chain([Kink::end()]) {
            let is_within = from.u >= first && to.u <= last;
            let (begin, end) = (from.u * self.chord, to.u * self.chord);
            let turns = [from.turns, to.turns];
            from = to;
            let (middle, half) = ((begin + end) * R::HALF, (end - begin) * R::HALF);
            if !is_within || half <= self.chord * R::EPSILON {
                continue;
            }
            let density = half * self.density;
            for &[place, weight] in gauss_rule(half, self.chord, turns) {
                let s = middle + half * R::from_f64(place);
                let node = self.node(s, density * R::from_f64(weight));
                if node.depth > R::ZERO {
                    visit(&node);
                }
            }
        }
    }

    /// The energy needs a finer rule than forces do: a symmetric one, of which half is enough.
    #[inline]
    fn spring_energy<G: SpringDamperGround<R>>(&self, ground: &G) -> (R, usize) {
        let rule: &[[f64; 2]] = if self.chord <= R::from_f64(SHORT) {
            &crate::body::GAUSS_6
        } else {
            &crate::body::GAUSS_8
        };
        let (mut energy, mut touching) = (R::ZERO, 0);
        for &[place, weight] in rule {
            let s = self.chord * R::from_f64(place);
            let depth = R::TWO * self.extent * ((self.chord - s) * (self.chord + s));
            if depth > R::ZERO {
                let share = R::from_f64(weight) / (R::ONE - s * s).sqrt();
                energy += ground.spring_energy(depth) * share;
                touching += 2;
            }
        }
        (energy * (R::TWO * self.chord * self.density), touching)
    }

    #[inline(always)]
    fn node(&self, s: R, weight: R) -> Node<R> {
        let root = (R::ONE - s * s).sqrt();
        let (sin, fall) = (R::TWO * s * root, R::TWO * s * s);
        let [lowest, across, down] = self.rising;
        let [slip, slip_across, slip_down] = self.slips;
        let slip_along = |along: fn(R::Vec3) -> R| {
            along(slip) + along(slip_across) * sin - along(slip_down) * fall
        };
        Node {
            sin,
            fall,
            depth: R::TWO * self.extent * ((self.chord - s) * (self.chord + s)),
            closing_speed: down * fall - across * sin - lowest,
            slip: R::Vec3::new(slip_along(R::Vec3::x), slip_along(R::Vec3::y), R::ZERO),
            weight: weight / root,
        }
    }

    /// Adds the load of the rim, with the torque that it has on a body with these axes.
    #[inline(always)]
    pub(super) fn load<D: Dynamics<R> + ?Sized>(
        &self,
        scene: &D,
        rim: &Rim<R>,
        axes: &Axes<R>,
        load: &mut Load<R>,
    ) {
        let (ground, friction) = (scene.ground(), scene.friction());
        let zero = R::Vec3::ZERO;
        let (mut force, mut with_sin, mut with_fall) = (zero, zero, zero);
        self.visit_within(self.kinks.pushed, &mut |node: &Node<R>| {
            let normal_force = ground.normal_force(node.depth, node.closing_speed);
            let rub = friction.force(normal_force, node.slip);
            let push = R::Vec3::new(rub.x(), rub.y(), rub.z() + normal_force) * node.weight;
            force += push;
            with_sin += push * node.sin;
            with_fall += push * node.fall;
            load.touching += 1;
        });
        let [down, across] = rim.spokes(rim.axes().map(|axis| axes.to_world(axis)), self.lowest);
        let lowest = axes.to_world(rim.centre()) + down;
        load.force += force;
        load.torque += lowest.cross(force) + across.cross(with_sin) - down.cross(with_fall);
    }

    #[inline]
    pub(super) fn contact(&self, rim: &Rim<R>, axes: &Axes<R>, node: &Node<R>) -> Contact<R> {
        let [down, across] = rim.spokes(rim.axes(), self.lowest);
        let place = rim.centre() + down + across * node.sin - down * node.fall;
        Contact {
            point: ContactPoint::bare(place),
            arm: axes.to_world(place),
            normal: R::Vec3::new(R::ZERO, R::ZERO, R::ONE),
            depth: node.depth,
            closing_speed: node.closing_speed,
            slip: node.slip,
            weight: node.weight,
        }
    }
}

/// The arc of a rim below ground, cut where its forces have a kink: of any length and on any ground.
fn panels<R: Real, D: Dynamics<R> + ?Sized>(
    scene: &D,
    rim: &Rim<R>,
    motion: &Motion<R>,
) -> Panels<R> {
    let arc = arc_below(rim, scene.ground(), motion.position, &motion.axes);
    if arc.lowest().is_none() {
        return Panels::of(arc, core::iter::empty());
    }
    let axes = &motion.axes;
    let centre = axes.to_world(rim.centre());
    let normal = scene.ground().surface(motion.position + centre).normal;
    let turning = rim.axes().map(|axis| {
        let spoke = axes.to_world(axis) * rim.radius();
        motion.angular_velocity.cross(spoke)
    });
    let velocities = Velocities::along(&arc, motion.velocity_at(centre), turning);
    let kinks = kinks(scene, &arc, normal, &velocities);
    Panels::of(arc, kinks.places())
}

/// Calls `visit` with each place that stands for a rim: the way that is always right.
#[inline(never)]
pub(super) fn visit_any<R: Real, D: Dynamics<R> + ?Sized>(
    scene: &D,
    rim: &Rim<R>,
    motion: &Motion<R>,
    visit: &mut dyn FnMut(&Contact<R>),
) {
    let panels = panels(scene, rim, motion);
    for (place, weight) in panels.iter().flat_map(|panel| rim.nodes(panel)) {
        let point = ContactPoint::bare(place);
        if let Some(contact) = Contact::of(scene.ground(), motion, &point, weight) {
            visit(&contact);
        }
    }
}

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
    fn over_level(&self) -> ([R; 3], [R::Vec3; 3]) {
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
fn kinks_along<R: Real, D: Dynamics<R> + ?Sized>(
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
    pushed: [R; 2],
}

/// Where a force has a kink.
#[derive(Clone, Copy)]
struct Kink<R> {
    /// `sin(θ/2)/κ`
    u: R,
    /// Whether the slip is least there, so that friction turns round within a slip speed of it.
    turns: bool,
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
    fn iter(&self) -> impl Iterator<Item = Kink<R>> + '_ {
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
    fn end() -> Self {
        Self {
            u: R::ONE,
            turns: false,
        }
    }
}
