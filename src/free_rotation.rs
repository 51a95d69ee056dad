//! Torque-free rotation of any rigid body in closed form, for any time.
//!
//! # Derivation
//!
//! `polhode` solves Euler's equations. This is the direction `l = L/|L|` in the principal axes `a`,
//! `b`, `c`, as a function of an angle `φ` with `φ' = ±Δ`. The shortest rotation from `l` to `a` is
//! the quaternion
//!
//! ```text
//! G = (1 + l_a, l × a)/√(2 (1 + l_a))        l_a ≥ 0
//! ```
//! So the orientation is `q(t) = q(0) G(0)⁻¹ exp(ψ(t) a/2) G(t)`, in principal axes, where the
//! angle `ψ` about the angular momentum is 0 at the start. A shortest rotation does not turn about
//! `l + a`. So the angular velocity `ω` gives
//!
//! ```text
//! ψ' = ω·(l + a)/(1 + l_a) = η' - ζ'
//! η' = |L| (j_b l_b² + j_c l_c²)/(l_b² + l_c²) = |L| (j_b + (j_c - j_b) f)
//! ζ  = arg(l_b + i l_c) = π/2 - χ        tan χ = (p/λ) tan φ
//! ```
//! with the `f` of `precession`, where `a` stands for `λ`. The angle `η` is the precession of
//! Euler's angles, and `ζ` the azimuth of `l`. Both are undefined for a rotation about `a`, and `ψ`
//! is not. `χ` follows the phase `θ` of `landen`, `θ' = ±M`, which grows by π/2 in each quarter
//! period. `|L| (j_c - j_b)` is `∓B`. So `ψ` is a linear part and the difference of a periodic one,
//!
//! ```text
//! ψ(t) = (|L| (j_b + (j_c - j_b) C) ± M) t + D(t) - D(0)        D = (χ - θ) - P
//! ```
//! All three angles in `D` are between -π/2 and π/2, so `D/2` follows from cosine and sine of `D`.
//! The two rates are multiplied by the time with twice the digits, and whole revolutions are
//! removed before sine and cosine.
//!
//! On the separatrix the period is infinite. There the motion of `l` ends at the quarter period for
//! the smallest `g`, where `l = ±b` to rounding. The part of the rate that belongs to it ends, too.
//!
//! For two equal moments, `q(t) = exp(t j L/2) q(0) exp(t (j_a - j) L_a a/2)`.
//!
//! See R. van Zon and J. Schofield, J. Comput. Phys. 225 (2007) 145; E. Celledoni, F. Fassò,
//! N. Säfström and A. Zanna, SIAM J. Sci. Comput. 30 (2008) 2084.

mod angle;
mod landen;
mod polhode;
mod precession;
mod series;
mod step;
mod wide;

use crate::inertia::InertiaProperties;
use crate::real::{Quaternion, Real, Vector};
use crate::rotation::{BodyAxis, Rotation};
use angle::Angle;
use landen::Jacobi;
use polhode::{Polhode, Principal};
use precession::Chain;
use wide::Wide;

/// Torque-free rotation of a rigid body with any moments of inertia, in closed form.
///
/// It is created once from the inertia, the orientation and the angular momentum at t = 0.
/// [`rotation_at`](Self::rotation_at) then returns the orientation at any time. The angular
/// momentum in world axes is constant.
///
/// *Error:* about ten times `EPSILON`, in radians, for the exact values of moments, orientation and
/// angular momentum. It does not grow with the time up to `0.01/EPSILON` revolutions, because the
/// rates have a rounding of `EPSILON²`. This holds at a distance above 1e-3 from the separatrix.
/// Closer to it, at the distance `δ`, the error is up to 25 times `EPSILON`, and grows by up to
/// `EPSILON²/δ` for each radian. Energy and angular momentum in body axes are constant to rounding.
///
/// *Moments:* any, equal or not. A body does not rotate about an axis whose moment is zero, which
/// includes moments below 1.4e-14 of the largest in `f64` and 7.6e-6 in `f32`, as in
/// [`InertiaProperties`].
///
/// *Separatrix:* where `|L|² = 2 T I₂` with the middle moment `I₂`, the body approaches a rotation
/// about its middle axis and stays there. A relative distance `δ` from it is resolved down to
/// `δ = EPSILON²`. A rounding error of the input has its effect multiplied by `1/δ`. Closer starts
/// are on the separatrix. So are those next to the middle axis, at an angle below 1e-120 in f64 and
/// 1e-15 in f32.
///
/// ```
/// use tumble::glam::{DMat3, DVec3};
/// use tumble::{FreeRotation, InertiaProperties, Rotation};
///
/// let inertia = DMat3::from_diagonal(DVec3::new(1.0, 1.6, 2.3)); // kg m²
/// let body = InertiaProperties::new(1.0, inertia)?;
/// let momentum = DVec3::new(0.02, 3.2, 0.05); // kg m²/s
/// let rotation = FreeRotation::new(&body, Rotation::IDENTITY, momentum);
/// let end = rotation.rotation_at(1e6); // s
/// let energy = |q: Rotation| body.rotational_energy(&q.axes(), momentum);
/// assert!((energy(end) / energy(Rotation::IDENTITY) - 1.0).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeRotation<R: Real = f64> {
    start: Rotation<R>,
    /// Power of two by which times are multiplied.
    unit: R,
    motion: Motion<R>,
}

/// Kind of a rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(
    clippy::large_enum_variant,
    reason = "the larger one is the usual one, and there is no allocation"
)]
enum Motion<R: Real> {
    Symmetric(Symmetric<R>),
    Asymmetric(Asymmetric<R>),
}

/// Rotation of a body with two equal moments. The rates are half revolutions for each unit of time.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Symmetric<R: Real> {
    /// Direction of the angular momentum, world axes.
    direction: R::Vec3,
    precession: Wide<R>,
    /// Axis of symmetry, body axes.
    axis: R::Vec3,
    spin: Wide<R>,
}

/// Rotation of a body with three different moments.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Asymmetric<R: Real> {
    axes: [R::Vec3; 3],
    amplitudes: [R; 3],
    chain: Chain<R>,
    elongation: R,
    /// `±M`, revolutions of the phase for each unit of time, and the phase at the start.
    phase_rate: Wide<R>,
    phase: Angle<R>,
    /// Half revolutions of `ψ` for each unit of time.
    half_rate: Wide<R>,
    /// `-D(0)/2`, of length 1.
    half_start: Angle<R>,
    /// The shortest rotation `G(0)`, inverse, times some length: the scalar and the parts along b
    /// and c.
    back: [R; 3],
    /// On the separatrix, half revolutions of `ψ` for each revolution of the phase.
    separatrix: Option<R>,
}

impl<R: Real> FreeRotation<R> {
    /// Creates the rotation of a body from its orientation and its angular momentum (kg m²/s, world
    /// axes) at t = 0.
    ///
    /// If a number is not finite, the orientations are not finite.
    #[must_use]
    pub fn new(
        inertia: &InertiaProperties<R>,
        rotation: Rotation<R>,
        angular_momentum: R::Vec3,
    ) -> Self {
        let start = Start::of(inertia, rotation, angular_momentum);
        let [low, middle, high] = &start.axes;
        let (momentum, radian) = (start.momentum, start.radian);
        let symmetric = if low.inverse == middle.inverse || momentum == [R::ZERO; 3] {
            Symmetric::new(momentum, middle.inverse, high, radian)
        } else if middle.inverse == high.inverse {
            Symmetric::new(momentum, middle.inverse, low, radian)
        } else {
            return Self::asymmetric(&start, rotation);
        };
        Self {
            start: rotation,
            unit: start.unit,
            motion: Motion::Symmetric(symmetric),
        }
    }

    /// Creates the rotation of three different moments. It is not inlined, because the code is
    /// large and has two callers.
    #[inline(never)]
    fn asymmetric(start: &Start<R>, rotation: Rotation<R>) -> Self {
        let motion = Asymmetric::new(&Polhode::new(start.axes), start.radian);
        Self {
            start: rotation,
            unit: start.unit,
            motion: Motion::Asymmetric(motion),
        }
    }

    /// Orientation after `seconds`, which may be negative.
    #[must_use]
    pub fn rotation_at(&self, seconds: R) -> Rotation<R> {
        let time = seconds * self.unit;
        match &self.motion {
            Motion::Symmetric(motion) => motion.turned(self.start, time),
            Motion::Asymmetric(motion) => self.start.after(motion.increment(time)),
        }
        .normalised()
    }
}

/// Start of a rotation, in units that make the largest numbers about 1.
struct Start<R: Real> {
    /// The axes by their inverse moments, the smallest first.
    axes: [Principal<R>; 3],
    /// Angular momentum, world axes.
    momentum: [R; 3],
    /// A radian for each unit of time, in revolutions.
    radian: Wide<R>,
    /// Power of two by which times are multiplied.
    unit: R,
}

impl<R: Real> Start<R> {
    #[inline(always)]
    fn of(inertia: &InertiaProperties<R>, rotation: Rotation<R>, momentum: R::Vec3) -> Self {
        let [x, y, z] = [momentum.x(), momentum.y(), momentum.z()];
        let momentum_unit = (x.abs().at_least(y.abs()).at_least(z.abs())).power_of_two();
        let momentum = [x, y, z].map(|part| part / momentum_unit);
        let moments = inertia.moments();
        let [x, y, z] = [moments.x(), moments.y(), moments.z()];
        let largest = x.at_least(y).at_least(z);
        let moment_unit = if largest > R::ZERO {
            largest.power_of_two()
        } else {
            R::ONE
        };
        let (in_body, length) = in_body_axes(rotation, momentum);
        let axes = inertia.principal_axes();
        let principal = |axis, moment| Principal {
            axis,
            momentum: along(axis, &in_body),
            inverse: inverse(inertia, moment, moment_unit),
        };
        Self {
            axes: sorted([
                principal(axes.x, x),
                principal(axes.y, y),
                principal(axes.z, z),
            ]),
            momentum,
            radian: revolution().over(length),
            unit: momentum_unit / moment_unit,
        }
    }
}

/// Returns the orientation after `seconds`, for three different moments and an angular momentum
/// that is not 0. It has the bits of [`FreeRotation`], without its constants of equal moments.
#[inline(never)]
fn turned_far<R: Real>(
    inertia: &InertiaProperties<R>,
    rotation: Rotation<R>,
    angular_momentum: R::Vec3,
    seconds: R,
) -> Rotation<R> {
    let start = Start::of(inertia, rotation, angular_momentum);
    FreeRotation::asymmetric(&start, rotation).rotation_at(seconds)
}

impl<R: Real> Symmetric<R> {
    /// `radian` is a radian for each unit of time, in revolutions, for [`Principal::momentum`].
    fn new([x, y, z]: [R; 3], common: Wide<R>, symmetry: &Principal<R>, radian: Wide<R>) -> Self {
        let square = |part: R| Wide::product(part, part);
        let length = square(x).plus(square(y)).plus(square(z)).sqrt();
        let direction = if length.high > R::ZERO {
            R::Vec3::new(x, y, z) * (R::ONE / length.nearest())
        } else {
            R::Vec3::ZERO
        };
        let excess = symmetry.inverse.minus(common);
        Self {
            direction,
            precession: length.times(common).times(revolution().shifted(R::HALF)),
            axis: symmetry.axis,
            spin: symmetry
                .momentum
                .times(excess)
                .times(radian.shifted(R::HALF)),
        }
    }

    fn turned(&self, start: Rotation<R>, time: R) -> Rotation<R> {
        let precession = Angle::revolutions(self.precession.fraction_after(time));
        let spin = Angle::revolutions(self.spin.fraction_after(time));
        turn_about(self.direction, precession)
            .after(start)
            .after(turn_about(self.axis, spin))
    }
}

impl<R: Real> Asymmetric<R> {
    #[inline(always)]
    fn new(polhode: &Polhode<R>, radian: Wide<R>) -> Self {
        let weight = polhode.side.nearest().abs();
        let (chain, means) = Chain::new(polhode.pair, polhode.third, weight);
        let phase_rate = means.limit.shifted(polhode.direction);
        let steady = if polhode.is_separatrix {
            polhode.slow
        } else {
            let side = polhode.side.times(means.fraction);
            polhode.slow.plus(side).plus(phase_rate)
        };
        let ratio = R::ONE - weight * means.fraction.nearest() / means.limit.nearest();
        let phase = landen::phase(chain.steps(), polhode.start);
        let half_start = half_angle(&chain, polhode.elongation, polhode.start, phase).unit();
        let [cos, b, c] = shortest_rotation(direction(polhode.amplitudes, polhode.start));
        Self {
            axes: polhode.axes,
            amplitudes: polhode.amplitudes,
            chain,
            elongation: polhode.elongation,
            phase_rate: phase_rate.times(radian),
            phase,
            half_rate: steady.times(radian.shifted(R::HALF)),
            half_start: half_start.negated(),
            back: [cos, -b, -c],
            separatrix: polhode.is_separatrix.then_some(ratio * R::HALF),
        }
    }

    /// Rotation increment `q(0)⁻¹ q(t)`, body axes.
    fn increment(&self, time: R) -> Rotation<R> {
        let mut half = self.half_rate.fraction_after(time);
        let advance = match self.separatrix {
            None => self.phase_rate.fraction_after(time),
            Some(ratio) => {
                let advance = self.advance_to_middle(self.phase_rate.nearest() * time);
                half = Wide::sum(half, ratio * advance).fraction();
                advance
            }
        };
        let phase = self.phase.plus(Angle::revolutions(advance));
        let values = landen::functions(self.chain.steps(), self.chain.limit(), phase);
        let half = Angle::revolutions(half)
            .plus(self.half_start)
            .plus(half_angle(&self.chain, self.elongation, values, phase));
        // exp(ψ a/2) G(t), and then G(0)⁻¹ before it.
        let [w, y, z] = shortest_rotation(direction(self.amplitudes, values));
        let turned = [
            half.cos * w,
            half.sin * w,
            half.cos * y - half.sin * z,
            half.cos * z + half.sin * y,
        ];
        let [w, x, y, z] = after([self.back[0], R::ZERO, self.back[1], self.back[2]], turned);
        // Everything before has any length.
        let scale = R::ONE / (w * w + x * x + y * y + z * z).sqrt();
        let [a, b, c] = self.axes;
        rotation(
            w * scale,
            a * (x * scale) + b * (y * scale) + c * (z * scale),
        )
    }

    /// Advance of the phase on the separatrix, revolutions: it ends a quarter from the middle of
    /// the path.
    fn advance_to_middle(&self, advance: R) -> R {
        let turn = R::from_f64(core::f64::consts::TAU);
        // The path is on the side `cos φ > 0` or `cos φ < 0`, and its phase between -π/2 and π/2 of
        // the middle of that side.
        let side = if self.phase.cos < R::ZERO {
            -R::ONE
        } else {
            R::ONE
        };
        let start = (self.phase.sin * side).atan2(self.phase.cos * side) / turn;
        let quarter = R::from_f64(0.25);
        (start + advance).at_least(-quarter).at_most(quarter) - start
    }
}

/// `D/2`, half of the periodic part of `ψ`, of any length.
#[inline]
fn half_angle<R: Real>(
    chain: &Chain<R>,
    elongation: R,
    values: Jacobi<R>,
    phase: Angle<R>,
) -> Angle<R> {
    let azimuth = Angle {
        cos: values.cn,
        sin: elongation * values.sn,
    };
    (azimuth.plus(phase.negated()))
        .plus(chain.periodic_part(values).negated())
        .half()
}

/// Direction `l` in the principal axes.
#[inline]
fn direction<R: Real>([a, b, c]: [R; 3], values: Jacobi<R>) -> [R; 3] {
    [a * values.dn, b * values.sn, c * values.cn]
}

/// The shortest rotation from `l` to the axis `a`, times a length between 1 and 2: its scalar, and
/// its parts along b and c.
#[inline]
fn shortest_rotation<R: Real>([a, b, c]: [R; 3]) -> [R; 3] {
    [R::ONE + a, c, -b]
}

/// Product of two quaternions w, x, y, z.
#[inline]
fn after<R: Real>([a, b, c, d]: [R; 4], [w, x, y, z]: [R; 4]) -> [R; 4] {
    [
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y + c * w + d * x - b * z,
        a * z + d * w + b * y - c * x,
    ]
}

fn rotation<R: Real>(scalar: R, vector: R::Vec3) -> Rotation<R> {
    Rotation::unscaled(R::Quat::new(vector.x(), vector.y(), vector.z(), scalar))
}

/// Rotation about a unit vector by twice an angle.
fn turn_about<R: Real>(axis: R::Vec3, half: Angle<R>) -> Rotation<R> {
    rotation(half.cos, axis * half.sin)
}

/// A radian in revolutions, `1/(2π)`.
fn revolution<R: Real>() -> Wide<R> {
    Wide::from_f64(0.159_154_943_091_895_35, -9.839_338_337_591_243e-18)
}

/// Angular momentum in body axes for the exact values of the quaternion, `Qᵀ L`, times the square
/// of the quaternion's length; and that square.
fn in_body_axes<R: Real>(rotation: Rotation<R>, momentum: [R; 3]) -> ([Wide<R>; 3], Wide<R>) {
    let [x, y, z, w] = rotation.to_quat().xyzw();
    let (v, product) = ([x, y, z], Wide::product);
    let dot = |a: [R; 3], b: [R; 3]| {
        product(a[0], b[0])
            .plus(product(a[1], b[1]))
            .plus(product(a[2], b[2]))
    };
    let (square, scalar) = (dot(v, v), product(w, w));
    // (w² - v²) L + 2 v (v·L) - 2 w v × L
    let (straight, along) = (scalar.minus(square), dot(v, momentum).shifted(R::TWO));
    let cross = |i: usize, j: usize| {
        product(nth(v, i), nth(momentum, j)).minus(product(nth(v, j), nth(momentum, i)))
    };
    let part = |i: usize, cross: Wide<R>| {
        straight
            .scaled(nth(momentum, i))
            .plus(along.scaled(nth(v, i)))
            .minus(cross.scaled(w * R::TWO))
    };
    let parts = [
        part(0, cross(1, 2)),
        part(1, cross(2, 0)),
        part(2, cross(0, 1)),
    ];
    (parts, scalar.plus(square))
}

/// Inverse of a principal moment in a unit, and 0 if the body does not rotate about its axis.
fn inverse<R: Real>(inertia: &InertiaProperties<R>, moment: R, unit: R) -> Wide<R> {
    if inertia.is_dead(moment) {
        Wide::ZERO
    } else {
        Wide::ONE.over(Wide::new(moment / unit))
    }
}

/// Component along an axis of the body.
fn along<R: Real>(axis: R::Vec3, [x, y, z]: &[Wide<R>; 3]) -> Wide<R> {
    match BodyAxis::<R>::along(axis) {
        BodyAxis::X => *x,
        BodyAxis::Y => *y,
        BodyAxis::Z => *z,
        BodyAxis::Other(axis) => x
            .scaled(axis.x())
            .plus(y.scaled(axis.y()))
            .plus(z.scaled(axis.z())),
    }
}

/// The axes by their inverse moments, the smallest first.
fn sorted<R: Real>([x, y, z]: [Principal<R>; 3]) -> [Principal<R>; 3] {
    let ordered = |a: Principal<R>, b: Principal<R>| {
        if b.inverse.is_below(a.inverse) {
            (b, a)
        } else {
            (a, b)
        }
    };
    let (x, y) = ordered(x, y);
    let (y, z) = ordered(y, z);
    let (x, y) = ordered(x, y);
    [x, y, z]
}

/// Element of an array of three, without a bounds check that could panic.
#[inline]
fn nth<T>([x, y, z]: [T; 3], index: usize) -> T {
    match index {
        0 => x,
        1 => y,
        _ => z,
    }
}
