//! Short arc below a level plane, with Gauss's rules for it.

use super::discontinuities::{Discontinuities, Discontinuity, Velocities, discontinuities_along};
use super::turning_rules::turning_rule;
use crate::body::{ContactPoint, Rim, SHORT};
use crate::contact::load::Load;
use crate::contact::point::Contact;
use crate::friction::SlidingFriction;
use crate::ground::SpringDamperGround;
use crate::quadrature::{GAUSS_2, GAUSS_4, GAUSS_5, GAUSS_6, GAUSS_8, HALF_OF_6, HALF_OF_8, Rule};
use crate::real::{Real, Vector};
use crate::rotation::Axes;
use crate::state::Motion;

/// Short arc below a level plane, along which all quantities are linear in 1, `sin θ` and the fall
/// `1 - cos θ`.
///
/// θ is the angle from the lowest point.
///
/// The variable `s = sin(θ/2)`, from `-κ` to `κ`, replaces θ. The extent is the depth of the rim's
/// lowest point below its middle. Then
///
/// ```text
/// sin θ = 2 s √(1 - s²)                1 - cos θ = 2 s²
/// depth = 2 extent (κ - s)(κ + s)      dθ = 2 ds/√(1 - s²)
/// velocity = lowest + across sin θ - down (1 - cos θ)
/// ```
/// A force f has the torque `(lowest + across sin θ - down (1 - cos θ)) × f`, with the positions
/// written in the same form. So the torque of all forces needs no arms, but only the sums of `f`,
/// `f sin θ` and `f (1 - cos θ)`.
pub(in crate::contact) struct Sweep<R: Real> {
    chord: R,
    /// Depth of the lowest point below the rim's middle, m.
    extent: R,
    /// Upward velocities, m/s: at the lowest point, and the coefficients of sine and fall.
    rising: [R; 3],
    /// Velocities along the ground, m/s, in the same form.
    slips: [R::Vec3; 3],
    discontinuities: Discontinuities<R>,
    /// Points on the rim for two radians: for a unit of `s` at the lowest point.
    density: R,
    lowest: [R; 2],
}

/// Gauss's rule for a piece of a sweep with this half length in s, of an arc with this chord:
/// positions from -1 to 1, and weights.
///
/// The springs' force is proportional to `(κ² - s²)/√(1 - s²)`. By the rule's error term, the
/// relative error of m points on the whole arc is `3.6e-3 κ⁶`, `8e-4 κ⁸`, `1.8e-4 κ¹⁰` for m = 4,
/// 5, 6. The error of two points is `0.07 (half/κ)⁵ κ²`. So each rule is accurate to 4e-11, as
/// eight points are at the longest arc. `least` is the number of points that friction needs.
#[inline(always)]
fn gauss_rule<R: Real>(half: R, chord: R, least: usize) -> Rule {
    if half > R::from_f64(0.2) || least > 6 {
        &GAUSS_8
    } else if half > R::from_f64(0.12) || least > 5 {
        &GAUSS_6
    } else if half > R::from_f64(0.04) {
        &GAUSS_5
    } else if half <= R::from_f64(1e-3) && half * R::from_f64(16.0) <= chord {
        &GAUSS_2
    } else {
        &GAUSS_4
    }
}

/// Quadrature point of a sweep.
pub(in crate::contact) struct Node<R: Real> {
    /// Sine of the angle from the lowest point.
    sin: R,
    /// 1 minus the cosine of that angle.
    fall: R,
    depth: R,
    closing_speed: R,
    slip: R::Vec3,
    weight: R,
}

/// Calls `visit` with each point `s = sin(θ/2)` of a rule for a part of an arc, and with its weight
/// as a length in s.
///
/// It proceeds piece by piece between discontinuities, none of which divides the part.
#[inline(always)]
pub(super) fn visit_between<R: Real>(
    discontinuities: &Discontinuities<R>,
    chord: R,
    [first, last]: [R; 2],
    mut visit: impl FnMut(R, R),
) {
    let mut from = Discontinuity {
        u: -R::ONE,
        width: R::MAX,
    };
    for to in discontinuities.iter().chain([Discontinuity::end()]) {
        if from.u >= first && to.u <= last && to.u - from.u > R::EPSILON {
            for piece in pieces(from, to) {
                visit_piece(piece, chord, discontinuities.points, &mut visit);
            }
        }
        from = to;
    }
}

/// Pieces between two discontinuities or ends. It is one piece from the end at which friction
/// reverses, if it does so at one of them. Otherwise two pieces meet in the middle.
#[inline(always)]
fn pieces<R: Real>(from: Discontinuity<R>, to: Discontinuity<R>) -> [Piece<R>; 2] {
    let none = R::MAX;
    let meet = if to.width >= none {
        to.u
    } else if from.width >= none {
        from.u
    } else {
        (from.u + to.u) * R::HALF
    };
    [from, to].map(|discontinuity| Piece {
        discontinuity,
        meet,
    })
}

/// Piece from a discontinuity to the start of the next piece, in either direction.
struct Piece<R> {
    discontinuity: Discontinuity<R>,
    meet: R,
}

#[inline(always)]
fn visit_piece<R: Real>(
    Piece {
        discontinuity,
        meet,
    }: Piece<R>,
    chord: R,
    least: usize,
    visit: &mut impl FnMut(R, R),
) {
    let span = meet - discontinuity.u;
    if span == R::ZERO {
        return;
    }
    // Negative if the rule runs from right to left.
    let half = span * chord * R::HALF;
    let middle = (discontinuity.u + meet) * chord * R::HALF;
    let length = half.abs();
    let rule = turning_rule(span.abs() / discontinuity.width * R::from_f64(SAFETY))
        .unwrap_or_else(|| gauss_rule(length, chord, least));
    for &[place, weight] in rule {
        visit(
            middle + half * R::from_f64(place),
            length * R::from_f64(weight),
        );
    }
}

/// Safety factor on the ratio of length to width. The width of a reversal is the sum of two
/// contributions. Each may have its own singularity, at most closer by a half.
const SAFETY: f64 = 1.5;

impl<R: Real> Sweep<R> {
    /// Sweep with this chord, and an extent in m, to both sides of the lowest point, which is at a
    /// position in world axes.
    #[inline(always)]
    pub(super) fn of<G: SpringDamperGround<R>, F: SlidingFriction<R>>(
        laws: (&G, &F),
        rim: &Rim<R>,
        velocities: Velocities<R>,
        [chord, extent]: [R; 2],
        lowest: [R; 2],
        position: R::Vec3,
    ) -> Self {
        let (rising, slips) = velocities.over_level();
        Self {
            chord,
            extent,
            rising,
            slips,
            discontinuities: discontinuities_along(laws, [chord, extent], rising, slips, position),
            density: rim.points() * R::from_f64(core::f64::consts::FRAC_1_PI),
            lowest,
        }
    }

    /// Calls `visit` with each quadrature point of the arc.
    #[inline(always)]
    pub(in crate::contact) fn visit(&self, mut visit: impl FnMut(&Node<R>)) {
        self.visit_within([-R::ONE, R::ONE], &mut visit);
    }

    /// Calls `visit` with each quadrature point within a part of the arc that no discontinuity
    /// divides.
    #[inline(always)]
    fn visit_within(&self, part: [R; 2], visit: &mut impl FnMut(&Node<R>)) {
        visit_between(&self.discontinuities, self.chord, part, |s, length| {
            let node = self.node(s, length * self.density);
            if node.depth > R::ZERO {
                visit(&node);
            }
        });
    }

    /// Energy of the springs, J, and the number of quadrature points. The energy needs a finer rule
    /// than the forces. The rule is symmetric, so half of it is evaluated.
    #[inline]
    pub(super) fn spring_energy<G: SpringDamperGround<R>>(&self, ground: &G) -> (R, usize) {
        let rule: &[[f64; 2]] = if self.chord <= R::from_f64(SHORT) {
            &HALF_OF_6
        } else {
            &HALF_OF_8
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

    /// Adds the load of the rim on a body with the first axes, at a position. The torque is that on
    /// a body with the second axes.
    #[inline(always)]
    pub(in crate::contact) fn load<G: SpringDamperGround<R>, F: SlidingFriction<R>>(
        &self,
        (ground, friction): (&G, &F),
        rim: &Rim<R>,
        [pose, axes]: [&Axes<R>; 2],
        position: R::Vec3,
        load: &mut Load<R>,
    ) {
        let zero = R::Vec3::ZERO;
        let (mut force, mut with_sin, mut with_fall) = (zero, zero, zero);
        self.visit_within(self.discontinuities.pushed, &mut |node: &Node<R>| {
            let normal_force = ground.normal_force(node.depth, node.closing_speed);
            let rub = if friction.depends_on_position() {
                let place = position + pose.to_world(self.place(rim, node));
                friction.force_at(place, normal_force, node.slip)
            } else {
                friction.force(normal_force, node.slip)
            };
            let push = R::Vec3::new(rub.x(), rub.y(), rub.z() + normal_force) * node.weight;
            force += push;
            with_sin += push * node.sin;
            with_fall += push * node.fall;
            load.touching += 1;
        });
        let [down, across] = rim.spokes(axes.both_to_world(rim.axes()), self.lowest);
        let lowest = axes.to_world(rim.centre()) + down;
        load.force += force;
        load.torque += lowest.cross(force) + across.cross(with_sin) - down.cross(with_fall);
    }

    /// Position of a quadrature point in the body, m, body axes.
    #[inline]
    fn place(&self, rim: &Rim<R>, node: &Node<R>) -> R::Vec3 {
        let [down, across] = rim.spokes(rim.axes(), self.lowest);
        rim.centre() + down + across * node.sin - down * node.fall
    }

    #[inline]
    pub(in crate::contact) fn contact(
        &self,
        surface: usize,
        rim: &Rim<R>,
        motion: &Motion<R>,
        node: &Node<R>,
    ) -> Contact<R> {
        let place = self.place(rim, node);
        let arm = motion.axes.to_world(place);
        Contact {
            point: ContactPoint::bare(place),
            surface,
            position: motion.position + arm,
            arm,
            normal: R::Vec3::new(R::ZERO, R::ZERO, R::ONE),
            depth: node.depth,
            closing_speed: node.closing_speed,
            slip_velocity: node.slip,
            weight: node.weight,
        }
    }
}
