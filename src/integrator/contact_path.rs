//! Path of one contact through a step: penetration depth, closing speed and normal force at both
//! ends, and the path between them.
//!
//! For the methods that treat contacts which begin or cease to push within a step.

use crate::body::ContactPoint;
use crate::contact::Motion;
use crate::ground::{Plane, SpringDamperGround};
use crate::quadrature::bisect;
use crate::real::{Real, Vector};
use crate::scene::Dynamics;

/// A contact at one end or stage of the step.
#[derive(Clone, Copy)]
pub(in crate::integrator) struct ContactEnd<R: Real> {
    pub(in crate::integrator) depth: R,
    pub(in crate::integrator) closing_speed: R,
    pub(in crate::integrator) normal_force: R,
}

impl<R: Real> ContactEnd<R> {
    #[inline(always)]
    pub(in crate::integrator) fn of<D: Dynamics<R>>(
        scene: &D,
        motion: &Motion<R>,
        point: &ContactPoint<R>,
    ) -> Self {
        let ground = scene.ground();
        let point = place_of(scene, motion, point);
        let arm = motion.axes.to_world(point.position);
        let surface = ground.surface(motion.position + arm);
        let depth = point.radius - surface.gap;
        let closing_speed = -motion
            .velocity_at(arm - surface.normal * point.radius)
            .dot(surface.normal);
        Self {
            depth,
            closing_speed,
            normal_force: push(scene, depth, closing_speed),
        }
    }

    #[inline]
    pub(in crate::integrator) fn pushes(&self) -> bool {
        self.normal_force > R::ZERO
    }
}

/// Returns the contact point in the body. That of a smooth body moves over its surface.
#[inline]
pub(in crate::integrator) fn place_of<R: Real, D: Dynamics<R>>(
    scene: &D,
    motion: &Motion<R>,
    point: &ContactPoint<R>,
) -> ContactPoint<R> {
    let (model, pose) = (scene.contact_model(), (motion.position, &motion.axes));
    model.contact_above(scene.ground(), pose, point)
}

/// Returns the normal force of one contact, N. It is 0 above ground.
#[inline]
pub(in crate::integrator) fn push<R: Real, D: Dynamics<R>>(
    scene: &D,
    depth: R,
    closing_speed: R,
) -> R {
    if depth > R::ZERO {
        scene.ground().normal_force(depth, closing_speed)
    } else {
        R::ZERO
    }
}

/// Returns the arm of the contact force from the centre of mass (m), and the ground normal there,
/// world axes.
#[inline(always)]
pub(in crate::integrator) fn arm<R: Real, D: Dynamics<R>>(
    scene: &D,
    motion: &Motion<R>,
    point: &ContactPoint<R>,
) -> (R::Vec3, R::Vec3) {
    let point = place_of(scene, motion, point);
    let arm = motion.axes.to_world(point.position);
    let normal = scene.ground().surface(motion.position + arm).normal;
    (arm - normal * point.radius, normal)
}

/// Returns the slip velocity of the body at an arm, along the ground with this normal and relative
/// to it, m/s, world axes.
#[inline(always)]
pub(in crate::integrator) fn slip<R: Real, D: Dynamics<R>>(
    scene: &D,
    motion: &Motion<R>,
    (arm, normal): (R::Vec3, R::Vec3),
) -> R::Vec3 {
    let velocity = scene.contact_model().seen(motion).velocity_at(arm);
    velocity - normal * velocity.dot(normal)
}

/// A moment of the step, prepared for computing penetration depth and closing speed of each
/// contact.
///
/// Above a plane `n · p = height` both are linear in the contact position `b` in body axes, because
/// `(ω × r) · n = (n × ω) · r`:
///
/// ```text
/// depth = radius + (height - n · x) - Qᵀn · b        closing speed = -n · v - Qᵀ(n × ω) · b
/// ```
pub(in crate::integrator) struct ContactView<'a, R: Real, D> {
    scene: &'a D,
    pub(in crate::integrator) motion: &'a Motion<R>,
    plane: Option<AbovePlane<R>>,
}

/// Penetration depth and closing speed of the centre of mass, and their decrease per metre along
/// the body axes.
pub(in crate::integrator) struct AbovePlane<R: Real> {
    pub(in crate::integrator) depth: R,
    pub(in crate::integrator) closing_speed: R,
    pub(in crate::integrator) rise: R::Vec3,
    pub(in crate::integrator) rising: R::Vec3,
}

impl<R: Real> AbovePlane<R> {
    #[inline(always)]
    fn of(plane: &Plane<R>, motion: &Motion<R>) -> Self {
        let (axes, spin) = (&motion.axes, motion.angular_velocity);
        if plane.is_level() {
            return Self::of_level(plane.height, motion);
        }
        let normal = plane.normal;
        Self {
            depth: -plane.gap(motion.position),
            closing_speed: -normal.dot(motion.linear_velocity),
            rise: axes.to_body(normal),
            rising: axes.to_body(normal.cross(spin)),
        }
    }

    /// Values above a level plane. Most planes are level, and most products are then with 0.
    #[inline(always)]
    pub(in crate::integrator) fn of_level(height: R, motion: &Motion<R>) -> Self {
        let (axes, spin) = (&motion.axes, motion.angular_velocity);
        let turning = [axes.x, axes.y, axes.z].map(|axis| spin.cross(axis).z());
        Self {
            depth: height - motion.position.z(),
            closing_speed: -motion.linear_velocity.z(),
            rise: axes.rise(),
            rising: R::Vec3::new(turning[0], turning[1], turning[2]),
        }
    }

    /// Returns penetration depth and closing speed of a bare point at this position in the body.
    #[inline(always)]
    pub(in crate::integrator) fn at(&self, position: R::Vec3) -> [R; 2] {
        [
            self.depth - self.rise.dot(position),
            self.closing_speed - self.rising.dot(position),
        ]
    }
}

impl<'a, R: Real, D: Dynamics<R>> ContactView<'a, R, D> {
    #[inline(always)]
    pub(in crate::integrator) fn of(scene: &'a D, motion: &'a Motion<R>) -> Self {
        let plane = scene.contact_model().plane_under_fixed_contacts();
        Self {
            scene,
            motion,
            plane: plane.map(|plane| AbovePlane::of(&plane, motion)),
        }
    }

    #[inline(always)]
    pub(in crate::integrator) fn side(&self, point: &ContactPoint<R>) -> ContactEnd<R> {
        let Some(plane) = &self.plane else {
            return ContactEnd::of(self.scene, self.motion, point);
        };
        let [depth, closing_speed] = plane.at(point.position);
        let depth = point.radius + depth;
        ContactEnd {
            depth,
            closing_speed,
            normal_force: push(self.scene, depth, closing_speed),
        }
    }
}

/// Path of a contact through the step: its penetration depth as Hermite's cubic of the fraction of
/// the step.
pub(in crate::integrator) struct Path<R: Real> {
    start: R,
    end: R,
    start_slope: R,
    end_slope: R,
    square: R,
    cube: R,
}

impl<R: Real> Path<R> {
    #[inline]
    pub(in crate::integrator) fn between(
        start: &ContactEnd<R>,
        end: &ContactEnd<R>,
        seconds: R,
    ) -> Self {
        let slopes = [start.closing_speed * seconds, end.closing_speed * seconds];
        let rise = end.depth - start.depth;
        Self {
            start: start.depth,
            end: end.depth,
            start_slope: slopes[0],
            end_slope: slopes[1],
            square: R::from_f64(3.0) * rise - R::TWO * slopes[0] - slopes[1],
            cube: slopes[0] + slopes[1] - R::TWO * rise,
        }
    }

    /// Returns the penetration depth, and its derivative by the fraction of the step.
    ///
    /// `d(s) = d₀ + m₀ s + (3Δ - 2m₀ - m₁) s² + (m₀ + m₁ - 2Δ) s³`
    #[inline]
    pub(in crate::integrator) fn at(&self, share: R) -> (R, R) {
        let (square, cube) = (self.square, self.cube);
        let depth = self.start + share * (self.start_slope + share * (square + share * cube));
        let slope =
            self.start_slope + share * (R::TWO * square + share * (R::from_f64(3.0) * cube));
        (depth, slope)
    }

    /// Returns the fraction at which the path crosses the surface, if its ends are on both sides of
    /// it.
    ///
    /// Newton's method starts at the crossing of the chord. Bisection is used if it does not
    /// converge.
    #[inline(always)]
    pub(in crate::integrator) fn surface(&self) -> Option<R> {
        if (self.start > R::ZERO) == (self.end > R::ZERO) {
            return None;
        }
        let nearer = |share: R| {
            let (depth, slope) = self.at(share);
            share - depth / slope
        };
        let first = nearer(self.start / (self.start - self.end));
        let share = nearer(first);
        let found =
            share >= R::ZERO && share <= R::ONE && (share - first).abs() < R::from_f64(CONVERGED);
        Some(if found {
            share
        } else {
            self.surface_by_halving()
        })
    }

    #[cold]
    fn surface_by_halving(&self) -> R {
        let ends = if self.start <= R::ZERO {
            [R::ZERO, R::ONE]
        } else {
            [R::ONE, R::ZERO]
        };
        let [above, below] = bisect(ends, HALVINGS, |share| self.at(share).0 > R::ZERO);
        (below + above) * R::HALF
    }

    /// Returns the fraction of greatest or least depth on a path whose ends have slopes of
    /// different signs.
    ///
    /// The slope `m₀ + 2 b s + 3 c s²` has one zero between the ends. The root is taken without
    /// cancellation.
    #[inline]
    pub(in crate::integrator) fn turn(&self) -> R {
        let (slope, square) = (self.start_slope, -self.square);
        let cube = R::from_f64(3.0) * self.cube;
        // The ends of the slope have different signs, so rounding alone makes it negative.
        let root = (square * square - cube * slope).at_least(R::ZERO).sqrt();
        let root = if slope < R::ZERO { -root } else { root };
        let share = if square * root < R::ZERO {
            (square - root) / cube
        } else {
            slope / (square + root)
        };
        share.at_least(R::ZERO).at_most(R::ONE)
    }

    /// Returns true if a path with both ends above ground is below it in between.
    #[inline]
    pub(in crate::integrator) fn turns_under_ground(&self) -> bool {
        self.greatest_depth(R::ZERO).is_some()
    }

    /// Returns the greatest depth that a path may reach with both ends above ground, m, or `None`
    /// if it stays above.
    ///
    /// The path is known within this `error` (m) in its middle. At the fraction `s` it is known
    /// within `16 s² (1 - s)²` of that.
    #[inline]
    pub(in crate::integrator) fn greatest_depth(&self, error: R) -> Option<R> {
        let above = self.start <= R::ZERO && self.end <= R::ZERO;
        let turns = self.start_slope > R::ZERO && self.end_slope < R::ZERO;
        if !(above && turns) {
            return None;
        }
        let share = self.turn();
        let part = R::from_f64(4.0) * share * (R::ONE - share);
        let (depth, _) = self.at(share);
        let depth = depth + error * part * part;
        (depth > R::ZERO).then_some(depth)
    }

    /// Returns true if a path with both ends below ground is above it in between.
    #[inline]
    pub(in crate::integrator) fn turns_above_ground(&self) -> bool {
        let below = self.start > R::ZERO && self.end > R::ZERO;
        let turns = self.start_slope < R::ZERO && self.end_slope > R::ZERO;
        below && turns && self.at(self.turn()).0 < R::ZERO
    }
}

/// Returns the largest distance of a contact from its [`Path`] between these motions, m.
///
/// Hermite's cubic is wrong by at most `s² (1 - s)² h⁴/24` times the fourth derivative. That is at
/// most `r ω⁴` at a distance `r` from the centre of mass.
#[inline]
pub(in crate::integrator) fn path_error<R: Real, D: Dynamics<R>>(
    scene: &D,
    ends: [&Motion<R>; 2],
    seconds: R,
) -> R {
    let [first, last] = ends.map(|motion| motion.angular_velocity.length());
    let angle = first.at_least(last) * seconds;
    let square = angle * angle;
    scene.bounding_radius() * (square * square * R::from_f64(1.0 / 384.0))
}

/// Largest change in the second iteration of Newton's method, as a fraction of the step, that
/// counts as converged. The remaining error is of the order of its square, at most 1e-3 of the
/// step.
const CONVERGED: f64 = 0.03;

/// Bisections, which resolve a 2000th of the step.
const HALVINGS: u32 = 10;
