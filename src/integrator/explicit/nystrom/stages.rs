//! Coefficients of the method, and its stages.

use crate::body::ContactRange;
use crate::contact::Motion;
use crate::integrator::point::Point;
use crate::real::{Real, Vector};
use crate::rotation::Rotation;
use crate::scene::Dynamics;

/// Time of a stage, and the weights of the previous stages for its pose (`A`) and its velocities
/// (`a`).
pub(super) struct Row<const N: usize> {
    /// Fraction of the step.
    pub(super) time: f64,
    pub(super) places: [f64; N],
    pub(super) speeds: [f64; N],
}

pub(super) const SECOND: Row<1> = Row {
    time: 1.0 / 4.0,
    places: [1.0 / 32.0],
    speeds: [1.0 / 4.0],
};
pub(super) const THIRD: Row<2> = Row {
    time: 5.0 / 8.0,
    places: [3.0 / 128.0, 11.0 / 64.0],
    speeds: [-5.0 / 16.0, 15.0 / 16.0],
};
pub(super) const FOURTH: Row<3> = Row {
    time: 1.0,
    places: [11.0 / 50.0, 1.0 / 35.0, 44.0 / 175.0],
    speeds: [47.0 / 35.0, -12.0 / 7.0, 48.0 / 35.0],
};
/// Weights `B` and `b` of the end of the step.
pub(super) const END: Row<4> = Row {
    time: 1.0,
    places: [1.0 / 10.0, 2.0 / 9.0, 8.0 / 45.0, 0.0],
    speeds: [1.0 / 10.0, 8.0 / 27.0, 64.0 / 135.0, 7.0 / 54.0],
};

/// Weights of the stages in the third divided difference of a function of time, in units of the
/// step size: `1/Π_j (c_i - c_j)`.
///
/// It is 0 for a function of degree 2 and 1 for the cube of the fraction of the step.
pub(super) const THIRD_DIFFERENCE: [f64; 4] = [-32.0 / 5.0, 128.0 / 9.0, -512.0 / 45.0, 32.0 / 9.0];

/// A stage of the step: the motion at which its forces were evaluated, and the resulting
/// accelerations.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrator) struct Stage<R: Real> {
    pub(in crate::integrator) motion: Motion<R>,
    /// Range of the penetrating contacts.
    pub(in crate::integrator) range: ContactRange,
    /// Acceleration of the centre of mass, m/s², world axes.
    pub(in crate::integrator) acceleration: R::Vec3,
    /// Torque about the centre of mass, N m, world axes.
    pub(in crate::integrator) torque: R::Vec3,
    /// Second derivative of the quaternion, 1/s².
    pub(super) bend: Rotation<R>,
}

impl<R: Real> Stage<R> {
    // Not inlined: four copies of the loop over contacts would be four times as large and no
    // faster.
    #[inline(never)]
    pub(in crate::integrator) fn at<D: Dynamics<R>>(
        scene: &D,
        point: Point<R>,
        near: ContactRange,
    ) -> Self {
        let motion = point.motion(scene);
        let range = scene
            .contact_model()
            .range_near(near, motion.position, &motion.axes);
        let contacts = scene.contact_model().load_on(range, &motion);
        let load = scene.with_applied_force(contacts, &motion);
        let mass = scene.inertia_properties();
        let spin = motion.angular_velocity;
        let turn = load.torque - spin.cross(point.angular_momentum);
        let turn = mass.angular_velocity(&motion.axes, turn);
        Self {
            motion,
            range,
            acceleration: load.force * mass.inverse_mass() + scene.gravity(),
            torque: load.torque,
            bend: bend(point.orientation, turn, spin),
        }
    }
}

/// Returns the second derivative of a quaternion, for an angular acceleration `turn` (rad/s²) and
/// an angular velocity `spin` (rad/s).
#[inline(always)]
pub(super) fn bend<R: Real>(rotation: Rotation<R>, turn: R::Vec3, spin: R::Vec3) -> Rotation<R> {
    let quarter = spin.length_squared() * R::from_f64(-0.25);
    rotation.rate(turn).plus(rotation, quarter)
}

/// Start of a step, with its first stage.
pub(in crate::integrator) struct Start<R: Real> {
    pub(in crate::integrator) point: Point<R>,
    /// First derivative of the quaternion, 1/s.
    pub(super) turning: Rotation<R>,
    pub(in crate::integrator) stage: Stage<R>,
    /// Step size, s.
    pub(in crate::integrator) seconds: R,
}

impl<R: Real> Start<R> {
    #[inline(always)]
    pub(in crate::integrator) fn of<D: Dynamics<R>>(
        scene: &D,
        point: &Point<R>,
        seconds: R,
        near: ContactRange,
    ) -> Self {
        Self::with_stage(*point, Stage::at(scene, *point, near), seconds)
    }

    /// Returns the start at a point whose stage is known.
    #[inline(always)]
    pub(in crate::integrator) fn with_stage(point: Point<R>, stage: Stage<R>, seconds: R) -> Self {
        Self {
            point,
            turning: point.orientation.rate(stage.motion.angular_velocity),
            stage,
            seconds,
        }
    }

    /// Computes the other three stages, and returns what `then` makes of all four.
    ///
    /// An array of stages would be a copy of them.
    #[inline(always)]
    pub(super) fn with_stages<T, D: Dynamics<R>>(
        &self,
        scene: &D,
        then: impl FnOnce([&Stage<R>; 4]) -> T,
    ) -> T {
        // The values of the laws are tested at the last stage.
        let untested = scene.untested();
        let first = &self.stage;
        let second = Stage::at(untested, self.ahead(&SECOND, [first]), first.range);
        let third = Stage::at(untested, self.ahead(&THIRD, [first, &second]), second.range);
        let place = self.ahead(&FOURTH, [first, &second, &third]);
        let fourth = Stage::at(scene, place, third.range);
        then([first, &second, &third, &fourth])
    }

    /// Returns the point that a row of coefficients gives from the start and the stages so far.
    #[inline(always)]
    pub(super) fn ahead<const N: usize>(&self, row: &Row<N>, stages: [&Stage<R>; N]) -> Point<R> {
        row.ahead((&self.point, self.turning), stages, self.seconds)
    }
}

/// Accelerations of a stage.
pub(super) trait Accelerated<R: Real>: Copy {
    fn acceleration(self) -> R::Vec3;
    fn torque(self) -> R::Vec3;
    fn bend(self) -> Rotation<R>;
}

impl<R: Real> Accelerated<R> for &Stage<R> {
    #[inline(always)]
    fn acceleration(self) -> R::Vec3 {
        self.acceleration
    }
    #[inline(always)]
    fn torque(self) -> R::Vec3 {
        self.torque
    }
    #[inline(always)]
    fn bend(self) -> Rotation<R> {
        self.bend
    }
}

impl<const N: usize> Row<N> {
    /// Returns the point at the time of this row, from the start of a step of `h` seconds, the
    /// first derivative of the quaternion there, and the stages so far.
    #[inline(always)]
    pub(super) fn ahead<R: Real>(
        &self,
        (start, mut turning): (&Point<R>, Rotation<R>),
        stages: [impl Accelerated<R>; N],
        h: R,
    ) -> Point<R> {
        let mut point = *start;
        // Position and orientation advance by their mean rates up to this time. A separate term of
        // h² would be lost in the rounding of the position.
        let mut velocity = start.linear_velocity;
        for ((stage, &place), &speed) in stages.into_iter().zip(&self.places).zip(&self.speeds) {
            let speed = h * R::from_f64(speed);
            // Known at compile time. The last position weight of the end is zero.
            if place != 0.0 {
                let place = h * R::from_f64(place / self.time);
                velocity += stage.acceleration() * place;
                turning = turning.plus(stage.bend(), place);
            }
            point.linear_velocity += stage.acceleration() * speed;
            point.angular_momentum += stage.torque() * speed;
        }
        let along = h * R::from_f64(self.time);
        point.position += velocity * along;
        point.orientation = point.orientation.plus(turning, along);
        point
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    type Matrix = [[f64; 4]; 4];
    type Weights = [f64; 4];

    fn dot(a: Weights, b: Weights) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    fn times(matrix: Matrix, vector: Weights) -> Weights {
        matrix.map(|row| dot(row, vector))
    }

    fn each(a: Weights, b: Weights) -> Weights {
        core::array::from_fn(|i| a[i] * b[i])
    }

    fn below<const N: usize>(row: [f64; N]) -> Weights {
        core::array::from_fn(|i| row.get(i).copied().unwrap_or(0.0))
    }

    const ONES: Weights = [1.0; 4];
    const NODES: Weights = [0.0, SECOND.time, THIRD.time, FOURTH.time];

    fn places() -> Matrix {
        [
            [0.0; 4],
            below(SECOND.places),
            below(THIRD.places),
            below(FOURTH.places),
        ]
    }

    fn speeds() -> Matrix {
        [
            [0.0; 4],
            below(SECOND.speeds),
            below(THIRD.speeds),
            below(FOURTH.speeds),
        ]
    }

    #[test]
    fn the_rows_keep_the_conditions_of_order_4_and_those_of_the_touch_downs() {
        let (c, b) = (NODES, END.speeds);
        let squares = each(c, c);
        for (sum, value) in [
            // Conditions on the weights and nodes, for positions and velocities.
            (dot(b, ONES), 1.0 / 1.0),
            (dot(b, c), 1.0 / 2.0),
            (dot(b, squares), 1.0 / 3.0),
            (dot(b, each(c, squares)), 1.0 / 4.0),
            // Conditions on the matrix of the velocities.
            (dot(b, times(speeds(), c)), 1.0 / 6.0),
            (dot(b, each(c, times(speeds(), c))), 1.0 / 8.0),
            (dot(b, times(speeds(), squares)), 1.0 / 12.0),
            (dot(b, times(speeds(), times(speeds(), c))), 1.0 / 24.0),
            // Conditions on the matrix of the positions, and the free number.
            (dot(b, times(places(), c)), 1.0 / 24.0),
            (
                dot(END.places, times(places(), c)),
                1.0 / 120.0 - 1.0 / 1440.0,
            ),
        ] {
            assert_relative_eq!(sum, value, max_relative = 1e-15);
        }
        for i in 0..4 {
            assert_relative_eq!(dot(speeds()[i], ONES), c[i], epsilon = 1e-15);
            assert_relative_eq!(dot(places()[i], ONES), squares[i] / 2.0, epsilon = 1e-15);
            assert_relative_eq!(END.places[i], b[i] * (1.0 - c[i]), epsilon = 1e-15);
        }
    }

    /// Returns the relative phase error and the growth of the amplitude per step of `y'' = -ω² y`
    /// at `ω dt = angle`.
    ///
    /// The phase error is positive if the computed phase is late. The growth is the excess of the
    /// amplification factor over 1.
    fn oscillation(
        angle: f64,
        matrix: Matrix,
        [places, speeds]: [Weights; 2],
        nodes: Weights,
    ) -> [f64; 2] {
        // Accelerations of the stages in turn, from a position of 1 and from a velocity of 1.
        let column = |start: [f64; 2]| {
            let mut bends = [0.0; 4];
            for i in 0..4 {
                bends[i] =
                    -angle * angle * (start[0] + nodes[i] * start[1] + dot(matrix[i], bends));
            }
            let speed = start[1] + dot(speeds, bends);
            [start[0] + start[1] + dot(places, bends), speed]
        };
        let [first, second] = [column([1.0, 0.0]), column([0.0, 1.0])];
        let growth = (first[0] * second[1] - first[1] * second[0]).sqrt();
        let phase = ((first[0] + second[1]) / (2.0 * growth)).acos();
        [1.0 - phase / angle, growth - 1.0]
    }

    #[test]
    fn an_oscillation_keeps_its_period_and_amplitude_better_than_with_the_numbers_of_nystrom() {
        let of = |angle| oscillation(angle, places(), [END.places, END.speeds], NODES);
        let ours = of(1.0);
        let theirs = oscillation(
            1.0,
            [
                [0.0; 4],
                [1.0 / 50.0, 0.0, 0.0, 0.0],
                [-1.0 / 27.0, 7.0 / 27.0, 0.0, 0.0],
                [3.0 / 10.0, -2.0 / 35.0, 9.0 / 35.0, 0.0],
            ],
            [
                [14.0 / 336.0, 100.0 / 336.0, 54.0 / 336.0, 0.0],
                [14.0 / 336.0, 125.0 / 336.0, 162.0 / 336.0, 35.0 / 336.0],
            ],
            [0.0, 1.0 / 5.0, 2.0 / 3.0, 1.0],
        );
        for ([phase, growth], [late, grown]) in
            [(ours, [9.9e-5, 1.9e-4]), (theirs, [1.45e-4, 2.4e-4])]
        {
            assert_relative_eq!(phase, late, max_relative = 0.02);
            assert_relative_eq!(growth, grown, max_relative = 0.02);
        }
        // Order 5 for the phase, and for the growth per unit of time.
        for (coarse, fine) in ours.into_iter().zip(of(0.5)) {
            assert!(coarse > 32.0 * fine, "{coarse:e} {fine:e}");
        }
    }
}
