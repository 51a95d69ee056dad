//! The method for several states in lanes. The stages are computed in lanes, the correction of
//! touch-downs state by state.

use super::crossing;
use super::stages::{END, FOURTH, SECOND, Stage, Start, THIRD, bend};
use crate::body::{ContactRange, InertiaProperties};
use crate::contact::{AxesInLanes, LANES, Loads, Motion, Vectors};
use crate::integrator::lanes::{Lanes, Points, Rotations, set_spins};
use crate::integrator::point::Point;
use crate::real::{Real, Vector};
use crate::scene::Dynamics;

/// A stage of each lane.
struct Stages<R: Real> {
    position: Vectors<R>,
    axes: AxesInLanes<R>,
    linear_velocity: Vectors<R>,
    angular_velocity: Vectors<R>,
    ranges: [ContactRange; LANES],
    accelerations: Accelerations<R>,
}

/// Accelerations of a stage of each lane.
struct Accelerations<R: Real> {
    acceleration: Vectors<R>,
    torque: Vectors<R>,
    bend: Rotations<R>,
}

impl<R: Real> Stages<R> {
    /// Computes the stage at the states, whose axes are known.
    #[inline(always)]
    fn at<D: Dynamics<R>>(scene: &D, lanes: &mut Lanes<R>) -> Self {
        lanes.find_contacts(scene);
        lanes.find_loads(scene);
        let mut accelerations = Accelerations {
            acceleration: Vectors::ZERO,
            torque: lanes.loads.torque,
            bend: Rotations::ZERO,
        };
        let mass = scene.inertia_properties();
        let motion = (&lanes.axes, &lanes.spins);
        accelerate(
            (mass, scene.gravity()),
            &lanes.states,
            motion,
            &lanes.loads,
            &mut accelerations,
        );
        Self {
            position: lanes.states.position,
            axes: lanes.axes,
            linear_velocity: lanes.states.linear_velocity,
            angular_velocity: lanes.spins,
            ranges: lanes.contact_ranges(),
            accelerations,
        }
    }

    #[inline(always)]
    fn get(&self, i: usize) -> Stage<R> {
        Stage {
            motion: Motion {
                position: self.position.get(i),
                axes: self.axes.get(i),
                linear_velocity: self.linear_velocity.get(i),
                angular_velocity: self.angular_velocity.get(i),
            },
            run: self.ranges[i],
            acceleration: self.accelerations.acceleration.get(i),
            torque: self.accelerations.torque.get(i),
            bend: self.accelerations.bend.get(i),
        }
    }
}

/// Computes acceleration and second derivative of the quaternion.
#[inline(never)]
fn accelerate<R: Real>(
    (mass, gravity): (&InertiaProperties<R>, R::Vec3),
    points: &Points<R>,
    (axes, spins): (&AxesInLanes<R>, &Vectors<R>),
    loads: &Loads<R>,
    result: &mut Accelerations<R>,
) {
    let mut turns = Vectors::ZERO;
    for i in 0..LANES {
        let momentum = points.angular_momentum.get(i);
        turns.set(i, loads.torque.get(i) - spins.get(i).cross(momentum));
    }
    let mut rates = Vectors::ZERO;
    set_spins(mass, axes, &turns, &mut rates);
    let inverse_mass = mass.inverse_mass();
    for i in 0..LANES {
        let force = loads.force.get(i);
        result.acceleration.set(i, force * inverse_mass + gravity);
        let orientation = points.orientation.get(i);
        result
            .bend
            .set(i, bend(orientation, rates.get(i), spins.get(i)));
    }
}

/// Start of a step of each lane.
struct Starts<R: Real> {
    points: Points<R>,
    /// First derivative of the quaternion, 1/s.
    turning: Rotations<R>,
    stages: Stages<R>,
    seconds: R,
}

impl<R: Real> Starts<R> {
    #[inline(always)]
    fn get(&self, i: usize) -> Start<R> {
        Start {
            point: self.points.get(i),
            turning: self.turning.get(i),
            stage: self.stages.get(i),
            seconds: self.seconds,
        }
    }
}

/// Takes a step of states of length 1 in lanes. Their axes are known.
#[inline]
pub(super) fn step<R: Real, D: Dynamics<R>>(scene: &D, lanes: &mut Lanes<R>, seconds: R) {
    let untested = scene.untested();
    let first = Stages::at(untested, lanes);
    let mut turning = Rotations::ZERO;
    set_rates(&lanes.states.orientation, &lanes.spins, &mut turning);
    let start = Starts {
        points: lanes.states,
        turning,
        stages: first,
        seconds,
    };
    let first = &start.stages;
    set_each(&mut lanes.states, |i| {
        start.get(i).ahead(&SECOND, [&first.get(i)])
    });
    lanes.set_axes_of_any_length();
    let second = Stages::at(untested, lanes);
    set_each(&mut lanes.states, |i| {
        start.get(i).ahead(&THIRD, [&first.get(i), &second.get(i)])
    });
    lanes.set_axes_of_any_length();
    let third = Stages::at(untested, lanes);
    set_each(&mut lanes.states, |i| {
        let stages = [&first.get(i), &second.get(i), &third.get(i)];
        start.get(i).ahead(&FOURTH, stages)
    });
    lanes.set_axes_of_any_length();
    let fourth = Stages::at(scene, lanes);
    set_each(&mut lanes.states, |i| {
        let stages = [&first.get(i), &second.get(i), &third.get(i), &fourth.get(i)];
        start.get(i).ahead(&END, stages)
    });
    correct(scene, &start, [&second, &third, &fourth], lanes);
    lanes.normalise();
}

/// Corrects the ends of the lanes for contacts that close or open within the step.
#[inline(never)]
fn correct<R: Real, D: Dynamics<R>>(
    scene: &D,
    start: &Starts<R>,
    [second, third, fourth]: [&Stages<R>; 3],
    lanes: &mut Lanes<R>,
) {
    for i in 0..LANES {
        if start.stages.ranges[i].count == 0 && fourth.ranges[i].count == 0 {
            continue;
        }
        let first = start.stages.get(i);
        let stages = [&first, &second.get(i), &third.get(i), &fourth.get(i)];
        let end = lanes.states.get(i);
        let (end, _) = crossing::corrected::<_, _, false>(scene, stages, end, start.seconds);
        lanes.states.set(i, &end);
    }
}

#[inline(never)]
fn set_rates<R: Real>(rotations: &Rotations<R>, spins: &Vectors<R>, rates: &mut Rotations<R>) {
    for i in 0..LANES {
        rates.set(i, rotations.get(i).rate(spins.get(i)));
    }
}

#[inline(never)]
fn set_each<R: Real>(points: &mut Points<R>, point: impl Fn(usize) -> Point<R>) {
    for i in 0..LANES {
        points.set(i, &point(i));
    }
}
