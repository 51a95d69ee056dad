//! Rims on the ground: the arc that touches, and where its forces have a kink.
//!
//! A Gauss rule is good for what is smooth. Along an arc two things are not: Coulomb friction turns round where the slip passes 0, and the ground lets go where a place leaves faster than its spring
//! expands. So the arc is cut there.

use super::{Dynamics, Motion};
use crate::body::{Arc, CUTS, Panels, Rim, sink_last};
use crate::friction::SlidingFriction;
use crate::ground::{Extent, SpringDamperGround, Surface};
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

/// The arc of a rim below ground, cut where its forces have a kink.
#[inline]
pub(super) fn panels<R: Real, D: Dynamics<R> + ?Sized>(
    scene: &D,
    rim: &Rim<R>,
    motion: &Motion<R>,
) -> Panels<R> {
    let arc = arc_below(rim, scene.ground(), motion.position, &motion.axes);
    if arc.lowest().is_none() {
        return Panels::of(arc, &[]);
    }
    let axes = &motion.axes;
    let centre = axes.to_world(rim.centre());
    let normal = scene.ground().surface(motion.position + centre).normal;
    let turning = rim.axes().map(|axis| {
        let spoke = axes.to_world(axis) * rim.radius();
        motion.angular_velocity.cross(spoke)
    });
    let velocities = Velocities::along(&arc, motion.velocity_at(centre), turning);
    let kinks = kinks(scene, rim, &arc, axes.to_body(normal), normal, &velocities);
    Panels::of(arc, kinks.get())
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
}

/// Where the forces on an arc have a kink, in order, as `u = sin(θ/2)/κ`. The ground's unit normal is given in body axes and in world axes.
#[inline]
pub(crate) fn kinks<R: Real, D: Dynamics<R> + ?Sized>(
    scene: &D,
    rim: &Rim<R>,
    arc: &Arc<R>,
    normal_in_body: R::Vec3,
    normal: R::Vec3,
    velocities: &Velocities<R>,
) -> Kinks<R> {
    let (chord, ground) = (arc.chord(), scene.ground());
    let mut kinks = Kinks::NONE;
    let slips = [velocities.lowest, velocities.across, velocities.down]
        .map(|velocity| velocity - normal * velocity.dot(normal));
    if rubs(scene.friction(), slips[0]) {
        for place in slowest(slips, chord).into_iter().flatten() {
            kinks.add(place);
        }
    }
    let depth = rim.steepness(normal_in_body) * rim.radius() * (chord * chord) * R::TWO;
    let rising = velocities.lowest.dot(normal);
    let across = velocities.across.dot(normal) * (R::TWO * chord);
    for side in [-R::ONE, R::ONE] {
        if let Some(place) = let_go(ground, depth, -(rising + across * side)) {
            kinks.add(place * side);
        }
    }
    kinks
}

/// Whether a law has friction at all.
#[inline]
fn rubs<R: Real, F: SlidingFriction<R>>(friction: &F, slip: R::Vec3) -> bool {
    friction.force(R::ONE, slip) != R::Vec3::ZERO
}

/// Where on an arc the slip is least, as `u = sin(θ/2)/κ`: at most two places.
///
/// With `t = 2 κ u` a place lies at `(1 - t²/2)` times the lowest and `t √(1 - t²/4)` across, so that the slip is `a + b t - k t²/2` but for a share t²/8 of the second term. Its square is least where
///
/// ```text
/// g(t) = (a + b t - k t²/2)·(b - k t) = 0
/// ```
/// with `g` rising: the first such place from the left, and the last one, by Newton's steps from both ends.
#[inline]
fn slowest<R: Real>([a, b, k]: [R::Vec3; 3], chord: R) -> [Option<R>; 2] {
    let scale = R::TWO * chord;
    let (b, k) = (b * scale, k * (scale * scale));
    let three = R::TWO + R::ONE;
    let (c0, c1) = (a.dot(b), b.dot(b) - a.dot(k));
    let (c2, c3) = (-(three * R::HALF * b.dot(k)), R::HALF * k.dot(k));
    let least = |end: R| {
        let mut u = end;
        for _ in 0..STEPS {
            let value = c0 + u * (c1 + u * (c2 + u * c3));
            let slope = c1 + u * (R::TWO * c2 + u * (three * c3));
            if slope > R::ZERO {
                u -= value / slope;
            } else {
                return None;
            }
        }
        (u > -R::ONE && u < R::ONE).then_some(u)
    };
    [least(-R::ONE), least(R::ONE)]
}

/// Newton's steps to a least slip: so many that what is left of a turning point is small beside a Gauss point's distance from the end.
const STEPS: u32 = 5;

/// Where, as u from 0 to 1, the ground lets go of an arc that is so deep in its middle and closes at this speed at one end: there the normal force falls to 0 before the depth does.
///
/// The law is asked at depths alone, at the speed of the end; it is straight between two of them, or nearly so.
#[inline]
fn let_go<R: Real, G: SpringDamperGround<R>>(ground: &G, depth: R, closing_speed: R) -> Option<R> {
    if closing_speed >= R::ZERO {
        return None;
    }
    let force = |depth: R| ground.normal_force(depth, closing_speed);
    let (mut deep, mut high) = (depth, force(depth));
    if high <= R::ZERO || force(depth * R::from_f64(1e-3)) > R::ZERO {
        return None;
    }
    let mut next = depth * R::HALF;
    for _ in 0..STEPS {
        let found = force(next);
        if found > R::ZERO {
            // Straight on from the last two, which for a law in proportion to the depth is there.
            let step = (deep - next) * (found / (high - found));
            (deep, high) = (next, found);
            next = (next - step).at_least(R::ZERO);
            if step <= deep * R::from_f64(1e-2) {
                break;
            }
        } else if high > R::ZERO && deep == depth {
            next = (next + deep) * R::HALF;
        } else {
            break;
        }
    }
    Some((R::ONE - next / depth).at_least(R::ZERO).sqrt())
}

/// Places of an arc, in order.
pub(crate) struct Kinks<R> {
    places: [R; CUTS],
    count: usize,
}

impl<R: Real> Kinks<R> {
    const NONE: Self = Self {
        places: [R::ZERO; CUTS],
        count: 0,
    };

    #[inline]
    fn add(&mut self, u: R) {
        let Some(place) = self.places.get_mut(self.count) else {
            return;
        };
        *place = u;
        self.count += 1;
        sink_last(self.places.get_mut(..self.count).unwrap_or_default(), |u| {
            *u
        });
    }

    pub(crate) fn get(&self) -> &[R] {
        self.places.get(..self.count).unwrap_or_default()
    }
}
