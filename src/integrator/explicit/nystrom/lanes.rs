//! The method for several states in lanes: the stages, and the test whether a contact begins or
//! ceases to push. The correction for such a contact is computed state by state.

mod changes;

use super::crossing::{self, SeenStages};
use super::stages::{Accelerated, END, FOURTH, Row, SECOND, THIRD, bend};
use crate::body::{ContactRange, InertiaProperties};
use crate::contact::{AxesInLanes, LANES, Loads, Motions, Vectors};
use crate::integrator::lanes::{Lanes, Points, Rotations, set_spins};
use crate::integrator::point::Point;
use crate::real::{Real, Vector};
use crate::rotation::Rotation;
use crate::scene::Dynamics;

/// Motion of a stage of each lane.
struct Poses<R: Real> {
    position: Vectors<R>,
    axes: AxesInLanes<R>,
    linear_velocity: Vectors<R>,
    angular_velocity: Vectors<R>,
    ranges: [ContactRange; LANES],
}

impl<R: Real> Poses<R> {
    #[inline(always)]
    fn of(lanes: &Lanes<R>) -> Self {
        Self {
            position: lanes.states.position,
            axes: lanes.axes,
            linear_velocity: lanes.states.linear_velocity,
            angular_velocity: lanes.spins,
            ranges: lanes.contact_ranges(),
        }
    }

    #[inline(always)]
    fn motions(&self) -> Motions<'_, R> {
        Motions {
            position: &self.position,
            axes: &self.axes,
            linear_velocity: &self.linear_velocity,
            angular_velocity: &self.angular_velocity,
        }
    }
}

/// Accelerations of a stage of each lane.
struct Accelerations<R: Real> {
    acceleration: Vectors<R>,
    torque: Vectors<R>,
    bend: Rotations<R>,
}

impl<R: Real> Accelerations<R> {
    /// Computes the stage at the states, whose axes are known.
    #[inline(always)]
    fn at<D: Dynamics<R>>(scene: &D, lanes: &mut Lanes<R>) -> Self {
        lanes.find_contacts(scene);
        lanes.find_loads(scene);
        let (mass, gravity) = (scene.inertia_properties(), scene.gravity());
        let motion = (&lanes.axes, &lanes.spins);
        accelerations((mass, gravity), &lanes.states, motion, &lanes.loads)
    }

    #[inline(always)]
    fn of(&self, lane: usize) -> OfLane<'_, R> {
        OfLane(self, lane)
    }
}

/// Accelerations of a stage of one lane.
struct OfLane<'a, R: Real>(&'a Accelerations<R>, usize);

impl<R: Real> Clone for OfLane<'_, R> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<R: Real> Copy for OfLane<'_, R> {}

impl<R: Real> Accelerated<R> for OfLane<'_, R> {
    #[inline(always)]
    fn acceleration(self) -> R::Vec3 {
        self.0.acceleration.get(self.1)
    }
    #[inline(always)]
    fn torque(self) -> R::Vec3 {
        self.0.torque.get(self.1)
    }
    #[inline(always)]
    fn bend(self) -> Rotation<R> {
        self.0.bend.get(self.1)
    }
}

/// Returns acceleration, torque and second derivative of the quaternion.
#[inline(never)]
fn accelerations<R: Real>(
    (mass, gravity): (&InertiaProperties<R>, R::Vec3),
    points: &Points<R>,
    (axes, spins): (&AxesInLanes<R>, &Vectors<R>),
    loads: &Loads<R>,
) -> Accelerations<R> {
    let mut turns = Vectors::ZERO;
    for i in 0..LANES {
        let momentum = points.angular_momentum.get(i);
        turns.set(i, loads.torque.get(i) - spins.get(i).cross(momentum));
    }
    let mut rates = Vectors::ZERO;
    set_spins(mass, axes, &turns, &mut rates);
    let inverse_mass = mass.inverse_mass();
    let mut result = Accelerations {
        acceleration: Vectors::ZERO,
        torque: loads.torque,
        bend: Rotations::ZERO,
    };
    for i in 0..LANES {
        let force = loads.force.get(i);
        result.acceleration.set(i, force * inverse_mass + gravity);
        let orientation = points.orientation.get(i);
        result
            .bend
            .set(i, bend(orientation, rates.get(i), spins.get(i)));
    }
    result
}

/// Start of a step of each lane.
struct Starts<R: Real> {
    points: Points<R>,
    /// First derivative of the quaternion, 1/s.
    turning: Rotations<R>,
    seconds: R,
}

impl<R: Real> Starts<R> {
    /// Returns the point of a lane that a row of coefficients gives from the stages so far.
    #[inline(always)]
    fn ahead<const N: usize>(
        &self,
        row: &Row<N>,
        stages: [OfLane<'_, R>; N],
        i: usize,
    ) -> Point<R> {
        let start = (&self.points.get(i), self.turning.get(i));
        row.ahead(start, stages, self.seconds)
    }
}

/// Takes a step of states of length 1 in lanes. Their axes are known.
#[inline]
pub(super) fn step<R: Real, D: Dynamics<R>>(scene: &D, lanes: &mut Lanes<R>, seconds: R) {
    let untested = scene.untested();
    let first = Accelerations::at(untested, lanes);
    let first_pose = Poses::of(lanes);
    let mut start = Starts {
        points: lanes.states,
        turning: Rotations::ZERO,
        seconds,
    };
    set_rates(&start.points.orientation, &lanes.spins, &mut start.turning);
    set_each(&mut lanes.states, |i| {
        start.ahead(&SECOND, [first.of(i)], i)
    });
    lanes.set_axes_of_any_length();
    let second = Accelerations::at(untested, lanes);
    set_each(&mut lanes.states, |i| {
        start.ahead(&THIRD, [first.of(i), second.of(i)], i)
    });
    lanes.set_axes_of_any_length();
    let third = Accelerations::at(untested, lanes);
    let third_pose = Poses::of(lanes);
    set_each(&mut lanes.states, |i| {
        start.ahead(&FOURTH, [first.of(i), second.of(i), third.of(i)], i)
    });
    lanes.set_axes_of_any_length();
    let fourth = Accelerations::at(scene, lanes);
    let fourth_pose = Poses::of(lanes);
    set_each(&mut lanes.states, |i| {
        let stages = [first.of(i), second.of(i), third.of(i), fourth.of(i)];
        start.ahead(&END, stages, i)
    });
    correct(
        scene,
        [&first_pose, &third_pose, &fourth_pose],
        lanes,
        seconds,
    );
    lanes.normalise();
}

/// Corrects the ends of the lanes for contacts that begin or cease to push within the step.
#[inline]
fn correct<R: Real, D: Dynamics<R>>(
    scene: &D,
    poses: [&Poses<R>; 3],
    lanes: &mut Lanes<R>,
    seconds: R,
) {
    let [first, _, last] = poses;
    let touches = |range: &ContactRange| range.count > 0;
    if !first.ranges.iter().chain(&last.ranges).any(touches) {
        return;
    }
    let changes = changes::found(scene, (&first.motions(), &first.ranges), lanes);
    for (i, changes) in changes.into_iter().enumerate() {
        if changes {
            correct_lane(scene, poses, (i, lanes), seconds);
        }
    }
}

/// Corrects the end of one lane.
#[inline(never)]
fn correct_lane<R: Real, D: Dynamics<R>>(
    scene: &D,
    poses: [&Poses<R>; 3],
    (i, lanes): (usize, &mut Lanes<R>),
    seconds: R,
) {
    let [first, third, last] = poses.map(|pose| pose.motions().get(i));
    let stages = SeenStages {
        motions: [&first, &third, &last],
        ranges: [poses[0].ranges[i], poses[2].ranges[i]],
    };
    let end = lanes.states.get(i);
    let end = crossing::corrected(scene, &stages, end, seconds, 1).end;
    lanes.states.set(i, &end);
}

#[inline(never)]
fn set_each<R: Real>(points: &mut Points<R>, point: impl Fn(usize) -> Point<R>) {
    for i in 0..LANES {
        points.set(i, &point(i));
    }
}

#[inline(never)]
fn set_rates<R: Real>(rotations: &Rotations<R>, spins: &Vectors<R>, rates: &mut Rotations<R>) {
    for i in 0..LANES {
        rates.set(i, rotations.get(i).rate(spins.get(i)));
    }
}
