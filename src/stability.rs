//! Stiffness and damping of the contacts of a state, and the longest step for which a method is
//! stable there.
//!
//! # Derivation
//!
//! Let `y` be a small displacement of the body (translation and rotation) and `M` its mass matrix.
//! A contact at lever arm `r` with normal `n` has a penetration depth that decreases by `g · y`,
//! where `g = (n, r × n)`. With stiffness `k`, damping `c` and friction force `F`, the linearised
//! equation of motion is
//!
//! ```text
//! M y'' + C y' + K y = 0
//! K = Σ k (g + f) gᵀ      f = (t, r × t), t = ∂F/∂N: friction grows with the load
//! C = Σ c (g + f) gᵀ + Σ d (e, r × e) (e, r × e)ᵀ      e: both directions along the surface
//! ```
//!
//! `N` is the normal force. `d` is the derivative of friction with respect to the slip,
//! `μ N/slip speed` in stick. The lever arm and the inertia enter through `M⁻¹`. A single contact
//! has `ω² = k (1/m + (r × n) · J⁻¹ (r × (n + t)))`.
//!
//! An applied force with the wrench `W(y, y')` adds `-∂W/∂y` to K and `-∂W/∂y'` to C. Its damping
//! needs no springs, as that of friction.
//!
//! Every solution `e^(λ t) x` satisfies `λ² + δ λ + κ = 0` with the Rayleigh quotients `κ = x* K x`
//! and `δ = x* C x` (in coordinates where M = 1). If K and C are symmetric, the pairs (κ, δ)
//! therefore lie in the joint numerical range of K and C, which is convex. Each λ is then that of a
//! scalar oscillator `y'' + δ y' + κ y = 0` with (κ, δ) in that range.
//!
//! A Runge-Kutta method is stable if it is stable for all of these oscillators. The same holds for
//! two other methods. The amplification factor of a step of `SymplecticEuler` solves a quadratic
//! eigenvalue problem in the same matrices. In that of Strang splitting the mass is
//! `(1 - h C/2)⁻¹`, whose quotient is at least `1/(1 - h δ/2)`.
//!
//! The range is enclosed by its supporting lines: the largest eigenvalue of `p K + q C` bounds
//! `p κ + q δ`. The limit is the smallest of the scalar limits along the outline of that polygon.
//! Its lower side matters where surfaces differ, or under an applied force: a softer motion may
//! have less damping than the stiffest, and a method that amplifies oscillations is limited by it.
//!
//! The derivative of friction with respect to the load, `f`, makes K and the first part of C
//! non-symmetric by the same factors. There are two limiting cases:
//!
//! * While the body slides, both matrices have the same eigenvectors, and the spectral radius
//!   replaces the largest eigenvalue.
//! * Where the damping by friction is strong, it holds the contact along the surface. The normal
//!   stiffness is then at most the stiffness without `f`.
//!
//! The limit is the lesser of both. It is not proven for the intermediate case, where the damping
//! by friction across the slip, `μ N/slip`, is comparable with the damping or the stiffness along
//! the normal: a slip near the slip speed, or a small load. There the motion itself can flutter.
//! Two effects are neglected: the rotation of lever arms and normals under load (of relative size
//! depth/arm), and the gyroscopic torque.

use crate::contact::{Contact, Motion};
use crate::force::{Force, Wrench};
use crate::friction::{FrictionJacobian, Metric, SlidingFriction};
use crate::ground::SpringDamperGround;
use crate::real::{Real, Vector};
use crate::scene::{Dynamics, ForceDerivatives, size};
use crate::state::State;

/// Longest stable step of a method at a state, s, from its scalar `limit(κ, δ)`, s. `None` if there
/// is no bound.
pub(crate) fn largest_stable_step<R: Real>(
    scene: &impl Dynamics<R>,
    state: &State<R>,
    limit: impl Fn(R, R) -> Option<R>,
) -> Option<R> {
    // A method without a limit needs no evaluation of the contacts.
    limit(R::ONE, R::ONE)?;
    if state.not_finite().is_some() {
        return None;
    }
    let response = Response::at(scene, state, Friction::GrowsWithLoad);
    let mut least = least_along(&response.outline(), &limit)?;
    if response.is_coupled {
        let response = Response::at(scene, state, Friction::HasNoLoad);
        least = least.at_most(least_along(&response.outline(), &limit)?);
    }
    (least < R::MAX).then_some(least)
}

/// Whether the response includes the increase of friction with the load.
#[derive(Clone, Copy, PartialEq)]
enum Friction {
    GrowsWithLoad,
    HasNoLoad,
}

/// Smallest limit along the outline, s. `R::MAX` for an empty outline.
///
/// A softer motion may have a smaller limit than the stiffest, because the stability region of a
/// method need not be convex. So the smallest of some limits is improved between its neighbours,
/// also across a corner.
fn least_along<R: Real>(outline: &[[R; 2]], limit: &impl Fn(R, R) -> Option<R>) -> Option<R> {
    let limit_at = |place: R| {
        let [stiffness, damping] = along(outline, place);
        let is_empty = stiffness <= R::ZERO && damping <= R::ZERO;
        if is_empty {
            Some(R::MAX)
        } else {
            limit(stiffness, damping)
        }
    };
    let edges = outline.len().saturating_sub(1);
    let part = R::ONE / R::from_usize(PARTS);
    let (mut least, mut at) = (R::MAX, R::ZERO);
    for number in 0..=edges * PARTS {
        let place = R::from_usize(number) * part;
        let value = limit_at(place)?;
        if value < least {
            (least, at) = (value, place);
        }
    }
    let start = (at - part).at_least(R::ZERO);
    let length = (at + part).at_most(R::from_usize(edges)) - start;
    let found = smallest(|share| limit_at(start + length * share))?;
    Some(found.at_most(least))
}

/// Number of parts into which an edge of the outline is divided.
const PARTS: usize = 8;
/// Steps of the search in two parts, each of which reduces its range by the golden ratio.
const SECTIONS: usize = 16;
/// `(√5 - 1)/2`
const GOLDEN_RATIO: f64 = 0.618_033_988_749_894_8;

/// Point at a place along the outline, in edges from its beginning.
fn along<R: Real>(outline: &[[R; 2]], place: R) -> [R; 2] {
    let mut rest = place;
    for (&start, &end) in outline.iter().zip(outline.iter().skip(1)) {
        if rest <= R::ONE {
            return between(start, end, rest);
        }
        rest -= R::ONE;
    }
    [R::ZERO; 2]
}

/// Point at a fraction of the way between two points.
fn between<R: Real>(start: [R; 2], end: [R; 2], fraction: R) -> [R; 2] {
    let rest = R::ONE - fraction;
    [
        start[0] * rest + end[0] * fraction,
        start[1] * rest + end[1] * fraction,
    ]
}

/// Returns the smallest value of a function between 0 and 1 that has one minimum there, by golden
/// section. Returns `None` if the function does.
fn smallest<R: Real>(value_at: impl Fn(R) -> Option<R>) -> Option<R> {
    let golden = R::from_f64(GOLDEN_RATIO);
    let [mut low, mut high] = [R::ZERO, R::ONE];
    let [mut left, mut right] = [R::ONE - golden, golden];
    let [mut at_left, mut at_right] = [value_at(left)?, value_at(right)?];
    for _ in 0..SECTIONS {
        if at_left < at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - (high - low) * golden;
            at_left = value_at(left)?;
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + (high - low) * golden;
            at_right = value_at(right)?;
        }
    }
    Some(at_left.at_most(at_right))
}

/// Response of the contacts of a state to a small displacement and a small velocity, as
/// accelerations.
struct Response<R> {
    /// `M⁻¹ K`, 1/s².
    stiffness: Matrix<R>,
    /// `M⁻¹ C`, 1/s.
    damping: Matrix<R>,
    /// Part of the damping that needs no springs, 1/s: that of friction and of the applied force.
    friction: Matrix<R>,
    /// Damping of the applied force alone, 1/s.
    applied: Matrix<R>,
    /// Ratio of damping to stiffness, s: of all contacts together, and the smallest and the largest
    /// of a single contact. An applied force with a stiffness has the smallest possible one, 0.
    mean_ratio: R,
    smallest_ratio: R,
    largest_ratio: R,
    load: Friction,
    /// Whether a contact slides with a friction force that increases with its load.
    is_coupled: bool,
}

impl<R: Real> Response<R> {
    fn at<D: Dynamics<R>>(scene: &D, state: &State<R>, load: Friction) -> Self {
        let motion = scene.motion(state);
        let frame = Frame {
            scene,
            motion: &motion,
            length: size(scene),
        };
        let mut response = Self {
            stiffness: Matrix::ZERO,
            damping: Matrix::ZERO,
            friction: Matrix::ZERO,
            applied: Matrix::ZERO,
            mean_ratio: R::ZERO,
            smallest_ratio: R::MAX,
            largest_ratio: R::ZERO,
            load,
            is_coupled: false,
        };
        let (mut stiffness, mut damping) = (R::ZERO, R::ZERO);
        scene.visit_contacts(&motion, |contact| {
            let [k, c] = response.add(&frame, contact);
            stiffness += k;
            damping += c;
            response.largest_ratio = response.largest_ratio.at_least(ratio(c, k));
            if k > R::ZERO {
                response.smallest_ratio = response.smallest_ratio.at_most(c / k);
            }
        });
        if scene.force().acts() {
            response.add_applied_force(&frame);
        }
        response.damping.add(&response.friction);
        response.mean_ratio = if damping > R::ZERO {
            ratio(damping, stiffness)
        } else {
            ratio(response.applied.trace(), response.stiffness.trace())
        };
        response.smallest_ratio = response.smallest_ratio.at_most(response.mean_ratio);
        response
    }

    /// Adds a contact. Returns its stiffness and its damping along the normal.
    fn add<D: Dynamics<R>>(&mut self, frame: &Frame<'_, R, D>, contact: &Contact<R>) -> [R; 2] {
        let normal = contact.normal;
        let (ground, friction_law) = contact.laws(frame.scene.ground(), frame.scene.friction());
        let load = ground.normal_force(contact.depth, contact.closing_speed);
        let jacobian = jacobian_at(&friction_law, load, contact);
        let by_load = friction_by_load(&friction_law, contact, &jacobian);
        self.is_coupled |= by_load != R::Vec3::ZERO;
        let pushed = match self.load {
            Friction::GrowsWithLoad => normal + by_load,
            Friction::HasNoLoad => normal,
        };
        let answer = frame.acceleration(pushed, contact.arm.cross(pushed));
        let row = frame.row(normal, contact.arm.cross(normal));
        let [k, c] =
            slopes(&ground, contact, dot(&answer, &row)).map(|slope| slope * contact.weight);
        self.stiffness.add_outer(k, &answer, &row);
        self.damping.add_outer(c, &answer, &row);

        let speed = contact.slip_velocity.length();
        let [along, across] = tangents(normal, contact.slip_velocity, speed);
        let shares = friction_shares(&friction_law, contact, &jacobian, [along, across]);
        for (direction, share) in [along, across].into_iter().zip(shares) {
            let damping = jacobian.coefficient * contact.weight * share;
            self.add_damper(frame, direction, contact.arm.cross(direction), damping);
        }
        self.add_turning(frame, contact, (&friction_law, load), [along, across]);
        [k, c]
    }

    /// Adds a damper of friction along a direction with the given moment about the centre of mass.
    fn add_damper<D: Dynamics<R>>(
        &mut self,
        frame: &Frame<'_, R, D>,
        direction: R::Vec3,
        moment: R::Vec3,
        damping: R,
    ) {
        let answer = frame.acceleration(direction, moment);
        (self.friction).add_outer(damping, &answer, &frame.row(direction, moment));
    }

    /// Adds rolling resistance and spinning friction, if the friction law has them.
    fn add_turning<D: Dynamics<R>>(
        &mut self,
        frame: &Frame<'_, R, D>,
        contact: &Contact<R>,
        (law, load): (&impl SlidingFriction<R>, R),
        tangents: [R::Vec3; 2],
    ) {
        let Some(resistance) = law.rolling_resistance_at(contact.position, load) else {
            return;
        };
        let seen = frame.scene.contact_model().seen(frame.motion);
        let spin = seen.angular_velocity;
        let about = spin.dot(contact.normal);
        let rolling = (spin - contact.normal * about).length();
        let [per_rolling, per_spinning] = resistance.per_turn(rolling, about.abs());
        self.add_damper(
            frame,
            R::Vec3::ZERO,
            contact.normal,
            per_spinning * contact.weight,
        );
        for axis in tangents {
            self.add_damper(frame, R::Vec3::ZERO, axis, per_rolling * contact.weight);
        }
    }

    /// Adds the stiffness and the damping of the applied force.
    fn add_applied_force<D: Dynamics<R>>(&mut self, frame: &Frame<'_, R, D>) {
        let force = ForceDerivatives::at(frame.scene, frame.motion);
        for (index, [shift, turn]) in frame.columns().into_iter().enumerate() {
            let per_speed = force.along_velocity(shift, turn);
            let per_path = force.along_path(shift, turn);
            for (matrix, change) in [
                (&mut self.applied, per_speed),
                (&mut self.stiffness, per_path),
            ] {
                let answer = frame.acceleration(-change.force, -change.torque);
                matrix.add_column(index, &answer);
            }
            if per_path != Wrench::ZERO {
                self.smallest_ratio = R::ZERO;
            }
        }
        self.friction.add(&self.applied);
    }

    /// Corners (κ, δ) of a polygon around the joint numerical range. They run along its least
    /// damping to the stiffest motion, and on to the motions without stiffness.
    fn outline(&self) -> [[R; 2]; 9] {
        let (zero, one, two) = (R::ZERO, R::ONE, R::TWO);
        let stiffest = self.stiffness.spectral_radius();
        let most_damped = self.damping.spectral_radius();
        let per = |value: R| if value > zero { one / value } else { zero };
        let [k, c] = [per(stiffest), per(most_damped)];
        // Supporting lines p X + q Y = s of X = κ/stiffest and Y = δ/most_damped, each at most 1.
        let support = |p: R, q: R| {
            let sum = self.stiffness.combined(p * k, &self.damping, q * c);
            sum.spectral_radius()
        };
        let [flat, even, steep] = [support(two, one), support(one, one), support(one, two)];
        let within = |value: R| value.at_least(zero).at_most(one);
        let below = self.least_damping(stiffest);
        let low = |x: R| within(below.at(x * stiffest) * c);
        let bend = within(below.bend() * k);
        let bend = if bend > R::from_f64(LEAST_BEND) {
            bend
        } else {
            zero
        };
        // The lines of non-symmetric matrices may cross below the least damping.
        let crossing = |x: R, y: R| [within(x), within(y).at_least(low(within(x)))];
        let resting = within(self.friction.spectral_radius() * c);
        let top = within(steep - two);
        let ratio = self.largest_ratio * stiffest * c;
        let corners = [
            [zero, zero],
            [bend, low(bend)],
            [one, low(one)],
            crossing(one, flat - two),
            crossing(flat - even, two * even - flat),
            crossing(two * even - steep, steep - even),
            [top, one],
            [((one - resting) / ratio).at_most(top), one],
            [zero, resting],
        ];
        corners.map(|[x, y]| [x * stiffest, y * most_damped])
    }

    /// Lower bound for the damping of a motion by its stiffness, from lines `δ >= t κ - s` below
    /// the range of stiffness and the damping by normal and applied forces. Friction only adds to
    /// that damping.
    ///
    /// No motion has a smaller ratio of damping to stiffness than a single contact. Where contacts
    /// act together, the ratio of every motion may be larger: that of a line with `s = 0`.
    fn least_damping(&self, stiffest: R) -> LeastDamping<R> {
        let mut bound = LeastDamping {
            ratio: self.smallest_ratio,
            slope: self.smallest_ratio,
            offset: R::ZERO,
        };
        let mut normal = self.damping.combined(R::ONE, &self.friction, -R::ONE);
        normal.add(&self.applied);
        let most_damped = normal.spectral_radius();
        let rounding = R::from_f64(ROUNDING).at_least(R::EPSILON * R::from_f64(64.0));
        let mut slope = self.mean_ratio;
        for _ in 0..LINES {
            if slope <= bound.ratio {
                break;
            }
            // All eigenvalues of t K - C + most_damped are at least 0, so the largest equals the
            // spectral radius.
            let mut shifted = self.stiffness.combined(slope, &normal, -R::ONE);
            shifted.add_identity(most_damped);
            let offset = (shifted.spectral_radius() - most_damped).at_least(R::ZERO);
            if slope * stiffest - offset > bound.at(stiffest) {
                (bound.slope, bound.offset) = (slope, offset);
            }
            if offset <= most_damped * rounding {
                bound.ratio = slope;
            }
            slope *= R::HALF;
        }
        bound
    }
}

/// Most lines below the range of stiffness and damping, each of half the slope of the last.
const LINES: usize = 8;
/// Error of a spectral radius in f64, relative. In f32 the numbers are rounded by more.
const ROUNDING: f64 = 4e-6;
/// Smallest stiffness of a motion without damping that counts, relative to the stiffest motion.
/// Below it, the offset of a line is rounding.
const LEAST_BEND: f64 = 1e-6;

/// Lower bound for the damping of a motion with the stiffness κ: `δ >= ratio κ` and
/// `δ >= slope κ - offset`.
struct LeastDamping<R> {
    ratio: R,
    slope: R,
    offset: R,
}

impl<R: Real> LeastDamping<R> {
    fn at(&self, stiffness: R) -> R {
        (self.ratio * stiffness).at_least(self.slope * stiffness - self.offset)
    }

    /// Stiffness at which both bounds are equal, or 0.
    fn bend(&self) -> R {
        if self.slope > self.ratio {
            self.offset / (self.slope - self.ratio)
        } else {
            R::ZERO
        }
    }
}

fn ratio<R: Real>(damping: R, stiffness: R) -> R {
    if stiffness > R::ZERO {
        damping / stiffness
    } else {
        R::ZERO
    }
}

/// Coordinates of a small displacement: translation, and rotation multiplied by a length, both in
/// m.
struct Frame<'a, R: Real, D> {
    scene: &'a D,
    motion: &'a Motion<R>,
    length: R,
}

impl<R: Real, D: Dynamics<R>> Frame<'_, R, D> {
    /// Displacement along a direction with the given moment about the centre of mass.
    fn row(&self, direction: R::Vec3, moment: R::Vec3) -> [R; 6] {
        let per_length = if self.length > R::ZERO {
            R::ONE / self.length
        } else {
            R::ZERO
        };
        joined(direction, moment * per_length)
    }

    /// Acceleration due to a force and a torque.
    fn acceleration(&self, force: R::Vec3, torque: R::Vec3) -> [R; 6] {
        let mass = self.scene.inertia_properties();
        let spin = mass.angular_velocity(&self.motion.axes, torque);
        joined(force * mass.inverse_mass(), spin * self.length)
    }

    /// Translation (m) and rotation (rad) of each coordinate for 1 m.
    fn columns(&self) -> [[R::Vec3; 2]; 6] {
        let (o, one) = (R::ZERO, R::ONE);
        let turn = if self.length > o {
            one / self.length
        } else {
            o
        };
        let axes = |size: R| {
            [
                R::Vec3::new(size, o, o),
                R::Vec3::new(o, size, o),
                R::Vec3::new(o, o, size),
            ]
        };
        let ([x, y, z], [a, b, c]) = (axes(one), axes(turn));
        let none = R::Vec3::ZERO;
        [
            [x, none],
            [y, none],
            [z, none],
            [none, a],
            [none, b],
            [none, c],
        ]
    }
}

fn joined<R: Real>(a: R::Vec3, b: R::Vec3) -> [R; 6] {
    [a.x(), a.y(), a.z(), b.x(), b.y(), b.z()]
}

fn dot<R: Real>(a: &[R; 6], b: &[R; 6]) -> R {
    (a.iter().zip(b)).fold(R::ZERO, |sum, (&a, &b)| sum + a * b)
}

/// Derivatives of the normal force of a contact with respect to depth (N/m) and closing speed (N
/// s/m), by central differences.
///
/// The width of the differences is `ε^(3/8)` of the depth, 1.4e-6 in f64 and 2.5e-3 in f32. The
/// relative error of a derivative is `ε^(5/8)` from rounding and `ε^(3/4)` from curvature. The unit
/// of speed is the depth times the natural frequency of the contact, at which spring and damper
/// have equal weight.
fn slopes<R: Real, G: SpringDamperGround<R>>(
    ground: &G,
    contact: &Contact<R>,
    inverse_mass: R,
) -> [R; 2] {
    let root = R::EPSILON.sqrt();
    let nudge = (root * root.sqrt()).sqrt();
    let (depth, speed) = (contact.depth, contact.closing_speed);
    let slope = |low: R, high: R, width: R| {
        if width > R::ZERO {
            ((high - low) / (width + width)).at_least(R::ZERO)
        } else {
            R::ZERO
        }
    };
    let width = depth * nudge;
    let at_depth = |depth| ground.normal_force(depth, speed);
    let stiffness = slope(at_depth(depth - width), at_depth(depth + width), width);
    let natural = depth * (stiffness * inverse_mass).at_least(R::ZERO).sqrt();
    let width = (speed.abs() + natural) * nudge;
    let at_speed = |speed| ground.normal_force(depth, speed);
    let damping = if width > R::ZERO {
        slope(at_speed(speed - width), at_speed(speed + width), width)
    } else {
        // A damper without a spring, at rest. It only pushes, against any speed of approach.
        ((at_speed(nudge) - at_speed(R::ZERO)) / nudge).at_least(R::ZERO)
    };
    [stiffness, damping]
}

/// Jacobian of the friction law at a contact. If a law returns none at zero slip, the Jacobian at
/// 1e-12 m/s is used.
fn jacobian_at<R: Real, F: SlidingFriction<R>>(
    friction: &F,
    load: R,
    contact: &Contact<R>,
) -> FrictionJacobian<R> {
    let jacobian = friction.jacobian_at(contact.position, load, contact.slip_velocity);
    if jacobian.coefficient > R::ZERO || contact.slip_velocity != R::Vec3::ZERO {
        return jacobian;
    }
    let [direction, _] = tangents(contact.normal, contact.slip_velocity, R::ZERO);
    friction.jacobian_at(contact.position, load, direction * R::from_f64(1e-12))
}

/// Derivative of the friction force with respect to its load, dimensionless.
fn friction_by_load<R: Real, F: SlidingFriction<R>>(
    friction: &F,
    contact: &Contact<R>,
    jacobian: &FrictionJacobian<R>,
) -> R::Vec3 {
    let slip = contact.slip_velocity;
    let metric = Metric::of(friction, contact.position, slip);
    metric.map_or(slip, |metric| metric.along_friction(slip)) * -jacobian.per_load
}

/// Derivative of the friction along the slip and across it, relative to its coefficient.
///
/// In a law that is not isotropic, the coupling of the two directions counts for both: the sum of
/// the magnitudes in a row is an upper bound of an eigenvalue.
fn friction_shares<R: Real, F: SlidingFriction<R>>(
    friction: &F,
    contact: &Contact<R>,
    jacobian: &FrictionJacobian<R>,
    [along, across]: [R::Vec3; 2],
) -> [R; 2] {
    let slip = contact.slip_velocity;
    let Some(metric) = Metric::of(friction, contact.position, slip) else {
        let weakening = jacobian.growth * slip.length() / jacobian.width;
        return [(R::ONE - weakening).at_least(R::ZERO), R::ONE];
    };
    let [x, y, z] = metric.derivative(jacobian, slip);
    let times = |v: R::Vec3| x * v.x() + y * v.y() + z * v.z();
    let coupling = along.dot(times(across)).abs();
    [along, across].map(|direction| (direction.dot(times(direction)) + coupling).at_least(R::ZERO))
}

/// Two unit vectors along the surface, the first along the slip if the slip is not zero.
fn tangents<R: Real>(normal: R::Vec3, slip: R::Vec3, speed: R) -> [R::Vec3; 2] {
    let along = if speed > R::ZERO {
        slip * (R::ONE / speed)
    } else {
        let (o, one) = (R::ZERO, R::ONE);
        let steep = normal.z().abs() > R::HALF;
        let other = if steep {
            R::Vec3::new(one, o, o)
        } else {
            R::Vec3::new(o, o, one)
        };
        let along = normal.cross(other);
        along * (R::ONE / along.length())
    };
    [along, normal.cross(along)]
}

/// 6 by 6 matrix, stored by rows.
#[derive(Clone, Copy)]
struct Matrix<R>([[R; 6]; 6]);

/// Number of squarings for a spectral radius: the 2²⁰th power leaves a factor of
/// `condition^(1/2²⁰)`.
const SQUARINGS: usize = 20;

impl<R: Real> Matrix<R> {
    const ZERO: Self = Self([[R::ZERO; 6]; 6]);

    fn add(&mut self, other: &Self) {
        *self = self.combined(R::ONE, other, R::ONE);
    }

    /// Returns `p self + q other`.
    fn combined(&self, p: R, other: &Self, q: R) -> Self {
        let mut sum = *self;
        for (row, others) in sum.0.iter_mut().zip(&other.0) {
            for (value, &other) in row.iter_mut().zip(others) {
                *value = *value * p + other * q;
            }
        }
        sum
    }

    fn add_identity(&mut self, factor: R) {
        for (i, row) in self.0.iter_mut().enumerate() {
            if let Some(value) = row.get_mut(i) {
                *value += factor;
            }
        }
    }

    /// Adds `factor column rowᵀ`.
    fn add_outer(&mut self, factor: R, column: &[R; 6], row: &[R; 6]) {
        for (values, &left) in self.0.iter_mut().zip(column) {
            for (value, &right) in values.iter_mut().zip(row) {
                *value += factor * left * right;
            }
        }
    }

    /// Adds a vector to a column.
    fn add_column(&mut self, index: usize, column: &[R; 6]) {
        for (row, &value) in self.0.iter_mut().zip(column) {
            if let Some(sum) = row.get_mut(index) {
                *sum += value;
            }
        }
    }

    fn trace(&self) -> R {
        (self.0.iter().enumerate()).fold(R::ZERO, |sum, (i, row)| {
            sum + row.get(i).copied().unwrap_or_default()
        })
    }

    fn largest(&self) -> R {
        (self.0.iter().flatten()).fold(R::ZERO, |largest, value| value.abs().at_least(largest))
    }

    fn squared(&self, scale: R) -> Self {
        let mut square = Self::ZERO;
        for (row, left) in square.0.iter_mut().zip(&self.0) {
            for (&factor, right) in left.iter().zip(&self.0) {
                for (value, &other) in row.iter_mut().zip(right) {
                    *value += (factor * scale) * (other * scale);
                }
            }
        }
        square
    }

    /// Largest magnitude of an eigenvalue, by repeated squaring: `ρ(A) = s₀ √(s₁ √(s₂ …))`, where
    /// the s are the scales of the powers.
    fn spectral_radius(&self) -> R {
        let mut scales = [R::ONE; SQUARINGS];
        let mut power = *self;
        for scale in &mut scales {
            *scale = power.largest();
            if !(*scale > R::ZERO && scale.is_finite()) {
                return R::ZERO;
            }
            power = power.squared(R::ONE / *scale);
        }
        let radius = |inner: R, &scale: &R| scale * inner.sqrt();
        scales.iter().rev().fold(R::ONE, radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// From either direction, the smallest sample is the corner, and the smallest value lies a
    /// twentieth of an edge beyond it.
    #[test]
    fn the_smallest_limit_is_found_across_a_corner() {
        let limit = |stiffness: f64, damping: f64| {
            let dip = 1.0 + (damping - 0.95).powi(2) + (1.0 - stiffness);
            Some(dip)
        };
        let mut outline = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
        for _ in 0..2 {
            let least = least_along(&outline, &limit).unwrap();
            assert_relative_eq!(least, 1.0, epsilon = 1e-6);
            outline.reverse();
        }
    }

    #[test]
    fn the_spectral_radius_is_that_of_symmetric_skew_and_defective_matrices() {
        let mut matrix = Matrix::<f64>::ZERO;
        assert_relative_eq!(matrix.spectral_radius(), 0.0);
        // A block of rotation by a right angle times 3, a diagonal of 2, and a coupling of 1e3
        // between equal eigenvalues.
        matrix.0[0][1] = 3.0;
        matrix.0[1][0] = -3.0;
        matrix.0[2][2] = 2.0;
        matrix.0[3][3] = 2.0;
        matrix.0[2][3] = 1e3;
        assert_relative_eq!(matrix.spectral_radius(), 3.0, max_relative = 1e-5);
        // Defective and dominant: the last scale is that of the power n = 2¹⁹, whose largest entry
        // is 1e3 n 2ⁿ⁻¹. The relative error of its root is ln(500 n)/n = 3.7e-5.
        matrix.0[0][1] = 1.0;
        assert_relative_eq!(matrix.spectral_radius(), 2.0, max_relative = 4e-5);
        // Scales far from 1.
        let small = matrix.combined(1e-200, &matrix, 0.0);
        assert_relative_eq!(small.spectral_radius(), 2e-200, max_relative = 4e-5);
    }
}
