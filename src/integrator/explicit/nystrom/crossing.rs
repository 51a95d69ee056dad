//! Correction for contacts that begin or cease to push within a step: the error of the stages in
//! the integral of their forces.

use super::stages::{END, SECOND, Stage, THIRD_DIFFERENCE};
use crate::body::{ContactPoint, ContactRange, RigidPointBody};
use crate::contact::{Load, Motion};
use crate::friction::SlidingFriction;
use crate::integrator::contact_path::{ContactEnd, ContactView, Path, arm, push, slip};
use crate::integrator::point::Point;
use crate::quadrature::{bisect, nodes_of_2};
use crate::real::{Real, Vector};
use crate::rotation::Axes;
use crate::scene::{Dynamics, OnSurface};

/// End of a step, corrected for the error of its stages.
pub(super) struct Corrected<R: Real> {
    pub(super) end: Point<R>,
    /// Correction of the mean load of the step.
    pub(super) correction: Load<R>,
    /// Change of the correction by its last pass.
    pub(super) change: Load<R>,
    /// What the corrected contacts contribute to the [`THIRD_DIFFERENCE`] of the loads.
    pub(super) third_difference: Load<R>,
}

/// Returns the `end` of a step, corrected for the error of its stages.
///
/// The paths of a second pass lead to the end that the first has corrected. Its change tells how
/// inexact the correction is.
#[inline(always)]
pub(super) fn corrected<R: Real, D: Dynamics<R>>(
    scene: &D,
    stages: &SeenStages<'_, R>,
    end: Point<R>,
    seconds: R,
    passes: u32,
) -> Corrected<R> {
    let mut corrected = Corrected {
        end,
        correction: Load::default(),
        change: Load::default(),
        third_difference: Load::default(),
    };
    if stages.ranges.iter().all(|range| range.count == 0) {
        return corrected;
    }
    // A step as short as this moves nothing, and rounding of a penetration depth would give an
    // infinite speed.
    if !(R::ONE / seconds).is_finite() {
        return corrected;
    }
    for pass in 0..passes {
        let motion = corrected.end.motion(scene);
        let missed = missed(scene, stages, &motion, seconds);
        if pass == 0 && missed.speeds.touching == 0 {
            break;
        }
        let before = corrected.correction;
        corrected = Corrected {
            end: missed.added_to(end, scene, &motion.axes, seconds),
            correction: missed.speeds,
            change: Load {
                force: missed.speeds.force - before.force,
                torque: missed.speeds.torque - before.torque,
                touching: missed.speeds.touching,
            },
            third_difference: missed.third_difference,
        };
    }
    corrected
}

/// What the correction sees of the stages.
pub(super) struct SeenStages<'a, R: Real> {
    /// Motions of the first, third and last stage.
    pub(super) motions: [&'a Motion<R>; 3],
    /// Contact ranges of the first and last stage.
    pub(super) ranges: [ContactRange; 2],
}

impl<'a, R: Real> SeenStages<'a, R> {
    #[inline(always)]
    pub(super) fn at([first, _, third, last]: [&'a Stage<R>; 4]) -> Self {
        Self {
            motions: [&first.motion, &third.motion, &last.motion],
            ranges: [first.range, last.range],
        }
    }
}

/// Errors of the stages' weighted sums: true means of force and torque over the step, minus these
/// sums.
struct Missed<R: Real> {
    /// Error of `∫ f ds`, which corrects the velocities.
    speeds: Load<R>,
    /// Error of `∫ (1 - s) f ds`, which corrects position and orientation.
    places: Load<R>,
    /// Third difference of the forces that the stages have used.
    third_difference: Load<R>,
}

#[inline(always)]
fn missed<R: Real, D: Dynamics<R>>(
    scene: &D,
    stages: &SeenStages<'_, R>,
    end: &Motion<R>,
    seconds: R,
) -> Missed<R> {
    let mut missed = Missed {
        speeds: Load::default(),
        places: Load::default(),
        third_difference: Load::default(),
    };
    for surface in 0..scene.contact_model().surfaces() {
        let scene = OnSurface::of(scene, surface);
        add_missed(&scene, stages, end, seconds, &mut missed);
    }
    missed
}

/// Adds the errors of the contacts with one surface.
#[inline(always)]
fn add_missed<R: Real, D: Dynamics<R>>(
    scene: &D,
    stages: &SeenStages<'_, R>,
    end: &Motion<R>,
    seconds: R,
    missed: &mut Missed<R>,
) {
    let [first, third, last] = stages.motions;
    let step = SeenStep {
        scene,
        ends: [ContactView::of(scene, first), ContactView::of(scene, end)],
        late: [ContactView::of(scene, third), ContactView::of(scene, last)],
        seconds,
        per_second: R::ONE / seconds,
    };
    let contacts = scene.body().contacts();
    // The last stage differs from the end only by a power of the step size. A contact that
    // penetrates in only one of them does so for almost no time.
    let [first, last] = stages.ranges;
    let [head, tail] = last.without(first, contacts.len());
    for range in [first, head, tail] {
        for part in range.parts(contacts) {
            for point in part {
                step.add_contact(point, missed);
            }
        }
    }
}

/// A step that has been taken.
struct SeenStep<'a, R: Real, D> {
    scene: &'a D,
    ends: [ContactView<'a, R, D>; 2],
    /// Third and last stage.
    late: [ContactView<'a, R, D>; 2],
    seconds: R,
    per_second: R,
}

impl<R: Real, D: Dynamics<R>> SeenStep<'_, R, D> {
    #[inline(always)]
    fn add_contact(&self, point: &ContactPoint<R>, missed: &mut Missed<R>) {
        let [start, end] = &self.ends;
        let (start, end) = (start.side(point), end.side(point));
        if start.pushes() != end.pushes() {
            self.add_correction(point, [start, end], missed);
        }
    }

    /// Adds the correction for one contact that begins or ceases to push.
    #[inline(never)]
    fn add_correction(
        &self,
        point: &ContactPoint<R>,
        [start, end]: [ContactEnd<R>; 2],
        missed: &mut Missed<R>,
    ) {
        let path = Path::between(&start, &end, self.seconds);
        let per_second = self.per_second;
        let force = |share: R| {
            let (depth, slope) = path.at(share);
            push(self.scene, depth, slope * per_second)
        };
        let [from, to] = pushing(&path, force, start.pushes());
        let [mut speeds, mut places] = means(force, from, to);
        // The second stage is on the path. The later stages are not, and the forces to be replaced
        // are those that they have used.
        let [third, last] = &self.late;
        let taken = [
            start.normal_force,
            force(R::from_f64(SECOND.time)),
            third.side(point).normal_force,
            last.side(point).normal_force,
        ];
        for (taken, (speed, place)) in taken
            .into_iter()
            .zip(END.speeds.into_iter().zip(END.places))
        {
            speeds -= taken * R::from_f64(speed);
            places -= taken * R::from_f64(place);
        }
        let load = start.normal_force.at_least(end.normal_force);
        let [first, last] = &self.ends;
        let pushes = [
            self.direction(point, first.motion, load),
            self.direction(point, last.motion, load),
        ];
        missed.add(pushes, [speeds, places]);
        missed.add_third_difference(pushes, taken);
    }

    /// Returns force and torque on the body per newton of the contact's normal force, world axes.
    ///
    /// Both are evaluated in a motion and for a `load` (N).
    #[inline(always)]
    fn direction(&self, point: &ContactPoint<R>, motion: &Motion<R>, load: R) -> [R::Vec3; 2] {
        let (arm, normal) = arm(self.scene, motion, point);
        let along = slip(self.scene, motion, (arm, normal));
        let rub = (self.scene.friction()).force_at(motion.position + arm, load, along);
        let push = normal + rub * (R::ONE / load);
        [push, arm.cross(push)]
    }
}

impl<R: Real> Missed<R> {
    /// Adds one contact, with its force directions `D` at both ends.
    ///
    /// The integral `∫ f D ds` is computed to first order in the change of `D`, with
    /// `D(s) = (1 - s) D(0) + s D(1)`.
    #[inline(always)]
    fn add(&mut self, [first, last]: [[R::Vec3; 2]; 2], [speeds, places]: [R; 2]) {
        let rest = speeds - places;
        for (sum, [early, late]) in [
            (&mut self.speeds, [places, rest]),
            (&mut self.places, [places * R::HALF; 2]),
        ] {
            sum.force += first[0] * early + last[0] * late;
            sum.torque += first[1] * early + last[1] * late;
            sum.touching += 1;
        }
    }

    /// Adds the third difference of the normal forces that the stages have `taken` at one contact,
    /// with the mean of the force directions at both ends.
    fn add_third_difference(&mut self, directions: [[R::Vec3; 2]; 2], taken: [R; 4]) {
        let mut difference = R::ZERO;
        for (taken, weight) in taken.into_iter().zip(THIRD_DIFFERENCE) {
            difference += taken * R::from_f64(weight);
        }
        for [push, torque] in directions {
            self.third_difference.force += push * (difference * R::HALF);
            self.third_difference.torque += torque * (difference * R::HALF);
        }
    }

    /// Returns the end of a step, whose axes are `axes`, with this correction added.
    #[inline(always)]
    fn added_to<D: Dynamics<R>>(
        &self,
        mut end: Point<R>,
        scene: &D,
        axes: &Axes<R>,
        seconds: R,
    ) -> Point<R> {
        let mass = scene.inertia_properties();
        let inverse_mass = mass.inverse_mass();
        let turn = mass.angular_velocity(axes, self.places.torque);
        end.position += self.places.force * (inverse_mass * seconds * seconds);
        end.orientation = (end.orientation).plus(end.orientation.rate(turn), seconds * seconds);
        end.linear_velocity += self.speeds.force * (inverse_mass * seconds);
        end.angular_momentum += self.speeds.torque * seconds;
        end
    }
}

/// Returns the fractions of the step between which a contact pushes that does so at only one end.
///
/// The contact pushes at the start of the step if `at_start` is true, otherwise at its end.
#[inline(always)]
fn pushing<R: Real>(path: &Path<R>, force: impl Fn(R) -> R, at_start: bool) -> [R; 2] {
    let surface = path.surface();
    if at_start {
        // The contact may open before it leaves the ground.
        [R::ZERO, edge(force, R::ZERO, surface.unwrap_or(R::ONE))]
    } else {
        // A contact that enters through the surface pushes from there on, by spring and damper. A
        // contact that penetrated before begins to push later.
        let from = surface.unwrap_or_else(|| edge(force, R::ONE, R::ZERO));
        [from, R::ONE]
    }
}

/// Returns the fraction at which a force falls to 0, continuously or by a jump, between two
/// fractions of the step.
///
/// The result is the zero of the chord through the force at two fractions near the outer end, or at
/// two nearer to the middle. If the force is 0 at those, bisection is used.
#[inline(always)]
fn edge<R: Real>(force: impl Fn(R) -> R, inside: R, outside: R) -> R {
    let at = |share: f64| {
        let place = inside + (outside - inside) * R::from_f64(share);
        (place, force(place))
    };
    for [first, second] in [[0.75, 0.9], [0.5, 0.7]] {
        let second = at(second);
        if second.1 > R::ZERO {
            return beyond(at(first), second, outside);
        }
    }
    edge_by_halving(force, inside, outside)
}

/// Returns the fraction at which the chord through the force at two fractions falls to 0, at most
/// `limit`.
#[inline(always)]
fn beyond<R: Real>((first, more): (R, R), (second, less): (R, R), limit: R) -> R {
    let on = (second - first) * (less / (more - less));
    let rest = limit - second;
    // Both have the sign of the direction of search. A chord that does not fall has no zero ahead.
    if on.abs() < rest.abs() && less < more {
        second + on
    } else {
        limit
    }
}

/// Returns the fraction at which a force falls to 0, by bisection.
///
/// The chord continues from the last fraction at which the force acts, so that rounding does not
/// decide between two fractions.
#[inline(never)]
fn edge_by_halving<R: Real>(force: impl Fn(R) -> R, inside: R, outside: R) -> R {
    let has_ceased = |share: R| {
        let pushes = force(share) > R::ZERO;
        !pushes
    };
    let [near, far] = bisect([inside, outside], HALVINGS, has_ceased);
    let last = near - (far - near);
    beyond((last, force(last)), (near, force(near)), far)
}

/// Bisections, which resolve a 64th of the step. The chord resolves the square of that. The force
/// is almost 0 there, so the error of its integral decreases with the square once more.
const HALVINGS: u32 = 6;

/// Returns `∫ f ds` and `∫ (1 - s) f ds` over a part of the step, by Gauss's rule with two points.
///
/// The force of a spring-damper is a cubic there.
#[inline(always)]
fn means<R: Real>(force: impl Fn(R) -> R, from: R, to: R) -> [R; 2] {
    let ([early, late], half) = nodes_of_2(from, to);
    let (first, second) = (force(early), force(late));
    [
        (first + second) * half,
        (first * (R::ONE - early) + second * (R::ONE - late)) * half,
    ]
}
