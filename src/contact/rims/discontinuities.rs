//! Discontinuities of the forces on an arc, or of their derivatives.
//!
//! Two effects are not smooth along an arc. Friction reverses where the slip is least, within a
//! width that depends on the least slip and on the law's slip speed. The contact opens where a
//! point separates faster than its spring expands. On a plane both are computed exactly for laws
//! that are linear in penetration depth and speed. The reason is that slip and force times
//! `1 + tan²(θ/2)` are polynomials of degree 2 in `tan(θ/2)`.

use crate::body::{Arc, CUTS, sink_last};
use crate::contact::invariants;
use crate::friction::SlidingFriction;
use crate::ground::SpringDamperGround;
use crate::quadrature::bisect;
use crate::real::{Real, Vector};
use crate::state::Motion;

/// Velocities of the material along an arc: `lowest + across sin θ - down (1 - cos θ)`.
pub(crate) struct Velocities<R: Real> {
    lowest: R::Vec3,
    across: R::Vec3,
    down: R::Vec3,
}

impl<R: Real> Velocities<R> {
    /// Velocities from that of the rim's middle and the contributions along the rim's two axes.
    #[inline]
    pub(crate) fn along(arc: &Arc<R>, middle: R::Vec3, turning: [R::Vec3; 2]) -> Self {
        Self::of_slopes(middle, arc.slopes(turning))
    }

    /// Velocities from that of the rim's middle and two contributions: at the point from which
    /// angles are counted, and a quarter of a revolution further.
    #[inline]
    pub(super) fn of_slopes(middle: R::Vec3, [down, across]: [R::Vec3; 2]) -> Self {
        Self {
            lowest: middle + down,
            across,
            down,
        }
    }

    /// Velocities from the spokes of the rim, m: from its middle to the lowest point, and to the
    /// point a quarter of a revolution further. `centre` is the vector from the centre of mass to
    /// the rim's middle, m.
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

    /// Components along a normal, and along two tangents of the ground.
    #[inline]
    fn over(&self, normal: R::Vec3, [first, second]: [R::Vec3; 2]) -> ([R; 3], [Complex<R>; 3]) {
        let each = [self.lowest, self.across, self.down];
        (
            each.map(|velocity| velocity.dot(normal)),
            each.map(|velocity| Complex(velocity.dot(first), velocity.dot(second))),
        )
    }

    /// Components along the normal z, and vectors along the ground.
    #[inline]
    pub(super) fn over_level(&self) -> ([R; 3], [R::Vec3; 3]) {
        let each = [self.lowest, self.across, self.down];
        let along = |v: R::Vec3| R::Vec3::new(v.x(), v.y(), R::ZERO);
        (each.map(|velocity| velocity.z()), each.map(along))
    }
}

/// Discontinuities of the forces on an arc, in order, as `u = sin(θ/2)/κ`, for the ground's unit
/// normal in world axes. The friction is that of a `position` on the arc (m, world axes).
#[inline]
pub(crate) fn discontinuities<R: Real, G: SpringDamperGround<R>, F: SlidingFriction<R>>(
    laws: (&G, &F),
    arc: &Arc<R>,
    [position, normal]: [R::Vec3; 2],
    velocities: &Velocities<R>,
) -> Discontinuities<R> {
    let chord = arc.chord();
    let deepest = arc.extent() * (chord * chord) * R::TWO;
    let depth = |u: R| deepest * ((R::ONE - u) * (R::ONE + u));
    discontinuities_over(laws, chord, [position, normal], velocities, &depth)
}

/// Discontinuities on any piece of arc, for a position on it with the normal there, and for the
/// penetration depth (m) along it.
#[inline]
pub(super) fn discontinuities_over<R: Real, G: SpringDamperGround<R>, F: SlidingFriction<R>>(
    (ground, law): (&G, &F),
    chord: R,
    [position, normal]: [R::Vec3; 2],
    velocities: &Velocities<R>,
    depth: &dyn Fn(R) -> R,
) -> Discontinuities<R> {
    let [first, second] = tangents::<R>(normal);
    let (rising, slips) = velocities.over(normal, [first, second]);
    let laws = Laws {
        normal_force: &|depth, speed| ground.normal_force(depth, speed),
        friction: &|slip: Complex<R>| {
            let slip = first * slip.0 + second * slip.1;
            law.force_at(position, R::ONE, slip).length()
        },
        depth,
    };
    discontinuities_by(laws, chord, rising, slips)
}

/// Two unit vectors perpendicular to a third and to each other.
fn tangents<R: Real>(normal: R::Vec3) -> [R::Vec3; 2] {
    let (o, one) = (R::ZERO, R::ONE);
    let beside = if normal.x().abs() < R::HALF {
        R::Vec3::new(one, o, o)
    } else {
        R::Vec3::new(o, one, o)
    };
    let across = normal.cross(beside);
    let first = across * (R::ONE / across.length());
    [first, normal.cross(first)]
}

/// Discontinuities on a short arc below a level plane, for the velocities along the normal and
/// along the ground. The friction is that of a `position` on the arc.
#[inline(always)]
pub(super) fn discontinuities_along<R: Real, G: SpringDamperGround<R>, F: SlidingFriction<R>>(
    (ground, law): (&G, &F),
    [chord, extent]: [R; 2],
    rising: [R; 3],
    slips: [R::Vec3; 3],
    position: R::Vec3,
) -> Discontinuities<R> {
    let deepest = extent * (chord * chord) * R::TWO;
    let laws = Laws {
        normal_force: &|depth, speed| ground.normal_force(depth, speed),
        friction: &|slip: Complex<R>| {
            let slip = R::Vec3::new(slip.0, slip.1, R::ZERO);
            law.force_at(position, R::ONE, slip).length()
        },
        depth: &|u: R| deepest * ((R::ONE - u) * (R::ONE + u)),
    };
    discontinuities_by(laws, chord, rising, slips.map(Complex::along))
}

/// What the discontinuities of an arc depend on. They are found by a few calls in rare steps, so
/// that this file is compiled once for all laws.
struct Laws<'a, R> {
    /// Normal force, N, for a penetration depth and a closing speed.
    normal_force: &'a dyn Fn(R, R) -> R,
    /// Friction force, N, of a slip under a load of 1 N.
    friction: &'a dyn Fn(Complex<R>) -> R,
    /// Penetration depth along the arc as a function of u, m.
    depth: &'a dyn Fn(R) -> R,
}

/// Discontinuities for the velocities along the normal and along the ground.
#[inline(always)]
fn discontinuities_by<R: Real>(
    laws: Laws<'_, R>,
    chord: R,
    [lowest, across, down]: [R; 3],
    slips: [Complex<R>; 3],
) -> Discontinuities<R> {
    let mut discontinuities = Discontinuities::none();
    let openings = Openings {
        laws: &laws,
        chord,
        speeds: [-lowest, -across, down],
    };
    let separates = [-R::ONE, R::ONE].map(|end| openings.separates(end));
    if separates != [false; 2] {
        openings.find(separates, &mut discontinuities);
    }
    if may_turn(slips, chord) {
        Slips::along(slips, chord).add_reversals(laws.friction, &mut discontinuities);
    }
    discontinuities
}

/// Returns true if the slip may come close to 0 on an arc. If the slip varies by no more than a
/// twelfth of itself, an arc is smooth to 1e-10 without a cut.
#[inline(always)]
fn may_turn<R: Real>([a, b, k]: [Complex<R>; 3], chord: R) -> bool {
    let square = R::from_f64(4.0) * (chord * chord);
    let varies = square * (b.square() + square * k.square());
    varies * R::from_f64(SMOOTH * SMOOTH) > a.square()
}

/// Slip along an arc as a polynomial.
///
/// With `w = tan(θ/2)`, `sin θ = 2 w/(1 + w²)` and `1 - cos θ = 2 w²/(1 + w²)`. So the slip
/// `a + b sin θ - k (1 - cos θ)` times `1 + w²` is exactly `a + 2 b w + (a - 2 k) w²`. With
/// `w = W ω` and `W = tan(α/2)`, the arc corresponds to ω from -1 to 1.
///
/// The two components of the slip along the ground are combined into one complex number. So this
/// polynomial `Q(ω) = A + B ω + C ω²` has two complex zeros. Since `|Q|² = Q(ω) Q*(ω)` for real ω,
/// the zeros and their conjugates are the singularities of the magnitude of the slip, and thus of
/// friction. Friction reverses at the real part of a zero, and the imaginary part is the width of
/// the reversal.
struct Slips<R: Real> {
    /// Coefficients of Q, m/s.
    powers: [Complex<R>; 3],
    /// `W²`.
    square: R,
}

impl<R: Real> Slips<R> {
    #[inline(always)]
    fn along([a, b, k]: [Complex<R>; 3], chord: R) -> Self {
        let square = chord * chord / ((R::ONE - chord) * (R::ONE + chord));
        let scale = square.sqrt();
        Self {
            powers: [
                a,
                b.scaled(scale + scale),
                Complex(a.0 - k.0 - k.0, a.1 - k.1 - k.1).scaled(square),
            ],
            square,
        }
    }

    /// Adds the points, at most two, at which friction reverses on the part of the arc on which the
    /// ground pushes.
    fn add_reversals(
        &self,
        friction: &dyn Fn(Complex<R>) -> R,
        discontinuities: &mut Discontinuities<R>,
    ) {
        let pushed = discontinuities.pushed;
        let [first, last] = pushed.map(|u| self.tangent_at(u));
        let zeros = self.zeros();
        for zero in zeros {
            let place = zero.0.at_least(first).at_most(last);
            let distance_of = |zero: Complex<R>| zero.minus(Complex(place, R::ZERO)).length();
            let distance = distance_of(zero);
            // The zero is far from the arc, at infinity, or NaN because nothing slips.
            let is_near = distance < R::from_f64(SMOOTH);
            if !is_near {
                continue;
            }
            discontinuities.add_points(if distance < R::from_f64(4.0) { 8 } else { 6 });
            if distance < R::TWO {
                let distance = (zeros.map(distance_of).into_iter())
                    .fold(distance, |least, one| if one < least { one } else { least });
                let width = distance + self.slip_speed_width(friction, place);
                let u = if place <= first {
                    pushed[0]
                } else if place >= last {
                    pushed[1]
                } else {
                    self.sine_at(place)
                };
                if width < R::TWO {
                    discontinuities.add(Discontinuity { u, width });
                }
            }
        }
    }

    /// Converts ω to `u = sin(θ/2)/κ`.
    #[inline]
    fn sine_at(&self, place: R) -> R {
        place * ((R::ONE + self.square) / (R::ONE + self.square * place * place)).sqrt()
    }

    /// Converts `u = sin(θ/2)/κ` to ω.
    #[inline]
    fn tangent_at(&self, u: R) -> R {
        u / (R::ONE + self.square * ((R::ONE - u) * (R::ONE + u))).sqrt()
    }

    /// Zeros of Q. They are infinite or NaN if the degree is lower.
    #[inline]
    fn zeros(&self) -> [Complex<R>; 2] {
        let [a, b, c] = self.powers;
        let half = b.scaled(-R::HALF);
        let root = half.times(half).minus(a.times(c)).sqrt();
        // The sum without cancellation.
        let sum = if half.0 * root.0 + half.1 * root.1 < R::ZERO {
            half.minus(root)
        } else {
            Complex(half.0 + root.0, half.1 + root.1)
        };
        [a.over(sum), sum.over(c)]
    }

    /// Q and its derivative at a real argument.
    #[inline]
    fn at(&self, place: R) -> [Complex<R>; 2] {
        let [a, b, c] = self.powers;
        let line = Complex(b.0 + c.0 * place, b.1 + c.1 * place);
        [
            Complex(a.0 + line.0 * place, a.1 + line.1 * place),
            Complex(line.0 + c.0 * place, line.1 + c.1 * place),
        ]
    }

    /// Length of the arc, in ω, over which the slip increases by the law's own slip speed.
    ///
    /// Friction per slip decreases as `1/(slip + slip_speed)`. So its values at a point of least
    /// slip and at the point of largest slip give the slip speed of any law. It is 0 for Coulomb's
    /// law, and infinite for a viscous one.
    #[inline]
    fn slip_speed_width(&self, friction: &dyn Fn(Complex<R>) -> R, place: R) -> R {
        let [near, slope] = self.at(place);
        let [far, middle, other] = [-R::ONE, R::ZERO, R::ONE].map(|place| self.at(place)[0]);
        let larger = |a: Complex<R>, b: Complex<R>| if a.square() < b.square() { b } else { a };
        let far = larger(larger(far, other), middle);
        let tiny = R::EPSILON * R::from_f64(1e4);
        let near = Complex(near.0 + far.0 * tiny, near.1 + far.1 * tiny);
        let per_slip = |slip: Complex<R>| friction(slip) / slip.length();
        let ratio = per_slip(far) / per_slip(near);
        // NaN without friction.
        let falls = ratio < R::ONE;
        if !falls {
            return R::MAX;
        }
        let slip_speed = (ratio * far.length() - near.length()) / (R::ONE - ratio);
        if slip_speed <= R::ZERO {
            return R::ZERO;
        }
        // β σ + γ σ² = slip speed.
        let (slope, bend) = (slope.length(), self.powers[2].length());
        let root = (slope * slope + R::from_f64(4.0) * bend * slip_speed).sqrt();
        R::TWO * slip_speed / (slope + root)
    }
}

/// Distance of a singularity from an arc, in half arcs, beyond which it has no effect. With
/// `ρ = 24` the error of four points is `ρ⁻⁸ = 1e-11`. From a distance of 4 on, six points have the
/// same error. From 2 on, eight points have an error of 1e-10.
const SMOOTH: f64 = 12.0;

/// Complex number.
#[derive(Clone, Copy)]
pub(super) struct Complex<R>(R, R);

impl<R: Real> Complex<R> {
    /// Components along a level ground.
    #[inline]
    fn along(vector: R::Vec3) -> Self {
        Self(vector.x(), vector.y())
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        Self(self.0 - other.0, self.1 - other.1)
    }

    #[inline(always)]
    fn times(self, other: Self) -> Self {
        Self(
            self.0 * other.0 - self.1 * other.1,
            self.0 * other.1 + self.1 * other.0,
        )
    }

    #[inline(always)]
    fn over(self, other: Self) -> Self {
        let per = R::ONE / other.square();
        self.times(Self(other.0 * per, -other.1 * per))
    }

    #[inline(always)]
    fn scaled(self, factor: R) -> Self {
        Self(self.0 * factor, self.1 * factor)
    }

    #[inline(always)]
    fn square(self) -> R {
        self.0 * self.0 + self.1 * self.1
    }

    #[inline(always)]
    fn length(self) -> R {
        self.square().sqrt()
    }

    /// Square root whose real part is not negative.
    #[inline(always)]
    fn sqrt(self) -> Self {
        let larger = ((self.length() + self.0.abs()) * R::HALF).sqrt();
        if larger == R::ZERO {
            return Self(R::ZERO, R::ZERO);
        }
        let smaller = self.1 * R::HALF / larger;
        if self.0 < R::ZERO {
            Self(
                smaller.abs(),
                if self.1 < R::ZERO { -larger } else { larger },
            )
        } else {
            Self(larger, smaller)
        }
    }
}

/// Points of an arc at which the contact opens, because the material separates faster than the
/// springs expand.
struct Openings<'a, R> {
    laws: &'a Laws<'a, R>,
    chord: R,
    /// Closing speed of the lowest point, and the coefficients of sine and fall, m/s.
    speeds: [R; 3],
}

impl<R: Real> Openings<'_, R> {
    #[inline(always)]
    fn separates(&self, u: R) -> bool {
        self.closing_speed(u) < R::ZERO
    }

    /// Closing speed at `sin(θ/2) = κ u`, m/s.
    #[inline(always)]
    fn closing_speed(&self, u: R) -> R {
        let [lowest, across, down] = self.speeds;
        let s = self.chord * u;
        let root = ((R::ONE - s) * (R::ONE + s)).sqrt();
        lowest + (across + across) * (s * root) + (down + down) * (s * s)
    }

    /// Normal force of a point at u, N.
    #[inline(always)]
    fn force(&self, u: R) -> R {
        let depth = (self.laws.depth)(u);
        if depth > R::ZERO {
            (self.laws.normal_force)(depth, self.closing_speed(u))
        } else {
            R::ZERO
        }
    }

    /// Adds the points at which the normal force reaches 0 before the penetration depth does, and
    /// the part between them that the ground pushes. The first argument tells which ends separate.
    #[inline(always)]
    fn find(&self, ends: [bool; 2], discontinuities: &mut Discontinuities<R>) {
        let square = self.chord * self.chord / ((R::ONE - self.chord) * (R::ONE + self.chord));
        let (all, beside) = (R::ONE + square, R::ONE + square * R::from_f64(0.25));
        let half = R::HALF * (all / beside).sqrt();
        let (left, middle, right) = (self.force(-half), self.force(R::ZERO), self.force(half));
        if left > R::ZERO && middle > R::ZERO && right > R::ZERO {
            let roots = roots_through([left * beside, middle, right * beside]);
            for (root, separates) in roots.into_iter().zip(ends) {
                let u = root * (all / (R::ONE + square * root * root)).sqrt();
                if is_within(u) && separates {
                    discontinuities.add(Discontinuity::of_opening(u));
                }
            }
        } else {
            self.seek(half, [left, middle, right], ends, discontinuities);
        }
        self.leave_out(ends, discontinuities);
    }

    /// Finds the points of opening by bisection between five points of the arc: its ends, and three
    /// with these forces. Part of an arc that pushes, or opens, between two of them is not found.
    fn seek(
        &self,
        half: R,
        forces: [R; 3],
        ends: [bool; 2],
        discontinuities: &mut Discontinuities<R>,
    ) {
        let pushes = |u: R| self.force(u) > R::ZERO;
        let [left, middle, right] = forces.map(|force| force > R::ZERO);
        // At an end of an arc the penetration depth is 0, and next to it the closing speed decides.
        let points = [
            (-R::ONE, !ends[0] || pushes(-R::ONE)),
            (-half, left),
            (R::ZERO, middle),
            (half, right),
            (R::ONE, !ends[1] || pushes(R::ONE)),
        ];
        for (from, to) in points.into_iter().zip(points.into_iter().skip(1)) {
            let around = match (from, to) {
                ((pushed, true), (open, false)) | ((open, false), (pushed, true)) => [open, pushed],
                _ => continue,
            };
            let [out, _] = bisect(around, HALVINGS, pushes);
            if is_within(out) {
                discontinuities.add(Discontinuity::of_opening(out));
            }
        }
    }

    /// Leaves out what is beyond the first and the last point of opening, if nothing pushes there.
    /// Nothing can be left out at an end that does not separate.
    #[inline(always)]
    fn leave_out(&self, ends: [bool; 2], discontinuities: &mut Discontinuities<R>) {
        let found = discontinuities.places.get(..discontinuities.count);
        let (Some([first, ..]), Some([.., last])) = (found, found) else {
            return;
        };
        let [first, last] = [first.u, last.u];
        let opens = |u: R, end: R| self.force((u + end) * R::HALF) <= R::ZERO;
        if ends[0] && opens(first, -R::ONE) {
            discontinuities.pushed[0] = first;
        }
        if ends[1] && opens(last, R::ONE) {
            discontinuities.pushed[1] = last;
        }
    }
}

/// Returns true if a point of an arc is not next to an end.
#[inline(always)]
fn is_within<R: Real>(u: R) -> bool {
    u.abs() < R::from_f64(1.0 - 1e-5)
}

/// Real zeros of a polynomial of degree 2, which is above 0 at -1/2, 0 and 1/2, from its values
/// there. A zero may be infinite or NaN.
///
/// For a law that is linear in penetration depth and speed, the force times `1 + w²` is such a
/// polynomial of ω, as in [`Slips`].
#[inline(always)]
fn roots_through<R: Real>([left, middle, right]: [R; 3]) -> [R; 2] {
    // middle + b ω - c ω²
    let (b, c) = (right - left, R::TWO * (middle + middle - left - right));
    let square_root = (b * b + R::from_f64(4.0) * middle * c).sqrt();
    if c > R::ZERO {
        let per = R::HALF / c;
        [(b - square_root) * per, (b + square_root) * per]
    } else {
        let near = R::TWO * middle;
        [-near / (b + square_root), near / (square_root - b)]
    }
}

/// Number of bisections, for an accuracy of 5e-7 of an arc.
const HALVINGS: u32 = 22;

/// Points of discontinuity of an arc, in order.
pub(crate) struct Discontinuities<R> {
    places: [Discontinuity<R>; CUTS],
    count: usize,
    /// Interval between two of them, or the ends, in which the ground pushes.
    pub(super) pushed: [R; 2],
    /// Least number of points that a piece needs.
    pub(super) points: usize,
}

/// Point at which a force or its derivative is discontinuous.
#[derive(Clone, Copy)]
pub(super) struct Discontinuity<R> {
    /// Position, `sin(θ/2)/κ`.
    pub(super) u: R,
    /// Distance over which friction reverses, in half arcs, or [`Real::MAX`] if it does not
    /// reverse.
    pub(super) width: R,
}

impl<R: Real> Discontinuities<R> {
    #[inline(always)]
    fn none() -> Self {
        Self {
            places: [Discontinuity::end(); CUTS],
            count: 0,
            pushed: [-R::ONE, R::ONE],
            points: 0,
        }
    }

    #[inline]
    pub(super) fn add_points(&mut self, points: usize) {
        self.points = self.points.max(points);
    }

    #[inline]
    fn add(&mut self, discontinuity: Discontinuity<R>) {
        // The slip may be least exactly where the contact opens, or twice at the same end.
        for place in self.places.iter_mut().take(self.count) {
            if place.u == discontinuity.u {
                place.width = place.width.at_most(discontinuity.width);
                return;
            }
        }
        let Some(place) = self.places.get_mut(self.count) else {
            return;
        };
        *place = discontinuity;
        self.count += 1;
        sink_last(
            self.places.get_mut(..self.count).unwrap_or_default(),
            |discontinuity| discontinuity.u,
        );
        debug_assert!(invariants::ascend(self.iter().map(|place| place.u)));
    }

    #[inline(always)]
    pub(super) fn iter(&self) -> impl Iterator<Item = Discontinuity<R>> + '_ {
        self.places.iter().take(self.count).copied()
    }

    /// Positions as `sin(θ/2)/κ`.
    pub(crate) fn places(self) -> impl Iterator<Item = R> {
        let places = self.places.into_iter().take(self.count);
        places.map(|discontinuity| discontinuity.u)
    }
}

impl<R: Real> Discontinuity<R> {
    /// Point at which the contact opens.
    #[inline(always)]
    fn of_opening(u: R) -> Self {
        Self { u, width: R::MAX }
    }

    /// End of the arc, where friction does not reverse.
    #[inline(always)]
    pub(super) fn end() -> Self {
        Self {
            u: R::ONE,
            width: R::MAX,
        }
    }
}
