//! Nyström's method, with a correction for the contacts that come and go within a step.

mod crossing;
mod oscillator;

use super::rk4::Point;
use super::{Integrator, Step, step_length};
use crate::body::ContactRange;
use crate::error::{self, SceneError, StepError};
use crate::real::{Real, Vector};
use crate::rotation::Rotation;
use crate::scene::{Dynamics, Motion};
use crate::state::State;

/// Nyström's method: that of Runge and Kutta for equations which say how velocities change, with
/// the contacts that touch down or let go within a step set right.
///
/// Place and quaternion `y = (x, q)` follow from their second derivatives, velocity and angular
/// momentum `p = (v, L)` from the same loads:
///
/// ```text
/// y_i = y + c_i h y' + h² Σ_j A_ij y''_j     p_i = p + h Σ_j a_ij p'_j     x'' = F/m + g     q'' = (0, J⁻¹ (T - ω × L)) q/2 - ω² q/4
/// ```
/// Four evaluations a step. Order 4 in smooth motion, 5 on linear springs. The conditions of these
/// orders (Hairer, Nørsett & Wanner I, section II.14), `B_i = b_i (1 - c_i)`, which the touch-downs
/// ask for, and `c_4 = 1` leave three numbers free; the choice of Nyström (1925) has order 5
/// wherever forces depend on the place alone. Here two nodes are `1/4` and `5/8`, and
/// `Σ_ij B_i A_ij c_j = 1/120 - 1/1440`: at `ω dt = 1` the phase of a swing on springs then errs by
/// 9.9e-5 of itself and its size grows by 1.9e-4 a step, where Nyström's do by 1.45e-4 and 2.4e-4.
/// `a` is the one matrix that makes the velocities a method of order 4 with these nodes and
/// weights, by `Σ_i b_i a_ij = b_j (1 - c_j)` and `b_4 a_43 a_32 c_2 = 1/24`.
///
/// *Touch-downs.* Where a contact touches down, its force jumps (the damper's) and bends (the
/// spring's). The weighted sum over the stages makes an error of `h Δf` of that, whatever the
/// order, and every method of high order falls to order 1 (Gear & Østerby, ACM Transactions on
/// Mathematical Software 10, 23, 1984; Hairer, Nørsett & Wanner I, section II.6). But the path of
/// the contact between both ends of the step is known, and with it the leading term of that error.
/// For each contact that pushes at one end of the step and not at the other, the end is moved by
///
/// ```text
/// Δp = h (∫ f ds - Σ b_i f(c_i))     and the place that follows from     h² (∫ (1 - s) f ds - Σ B_i f(c_i))
/// ```
/// with `f(s)` its force where the depth goes by Hermite's cubic from end to end, and `f(c_i)` what
/// the stages have seen of it. Arm and direction of the force are those at both ends,
/// `Δp = Δp_B D(0) + (Δp - Δp_B) D(1)`, because `B_i = b_i (1 - c_i)`: with the share `Δp_B` that
/// the place takes and the rest. What is left is what the stages did to each other by it, a power
/// of the step smaller: order 2 through touch-downs. In trial 1 of the report, with 150 of them in
/// a second, the error is 8.6e-5 m with a step of 16.1 ms, 1.1e-6 m with 4 ms and 6e-8 m with 1 ms
/// (`tests/truth.rs`): there a 290th of [`Rk4`](crate::Rk4)'s.
///
/// *Limits* (ω and δ are the highest frequency and damping rate that the contacts give the body at
/// their arms, see [integrators](crate#integrators); `ζ = δ/2ω`):
/// - Stable for `dt < 2.36/ω` and `dt < 2.78/δ`, and up to `3.08/ω` with `ζ = 0.1`, as long as
///   damping takes what the next line says.
///   [`Stepper::largest_stable_step`](crate::Stepper::largest_stable_step) computes the limit at a
///   state: exact for a body that slides, up to 10 % too long where friction damps some motions and
///   not others.
/// - *May add energy*: a swing without dampers grows by 2.1e-4 (ω dt)⁶ of itself a step. Damping of
///   `ζ > 2.1e-4 (ω dt)⁵` takes more than that.
/// - A contact that dips into the ground and out of it within one step is seen by the stages alone;
///   torques that [resist turning](crate::WithResistance) are not set right.
///
/// The least cost for an error between 1e-4 and 1e-6 m where a body rolls and slides.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Nystrom<R = f64> {
    /// s, above 0.
    pub time_step: R,
}

impl<R: Real> Integrator<R> for Nystrom<R> {
    /// The contacts that were low in the step before: where to look for them first.
    type Workspace = ContactRange;

    #[inline]
    fn step<D: Dynamics<R>>(
        &self,
        scene: &D,
        state: &mut State<R>,
        limit: R,
        near: &mut ContactRange,
    ) -> Result<Step<R>, StepError> {
        let dt = step_length(self.time_step, limit);
        let start = Start::of(scene, state, dt, *near);
        let first = &start.stage;
        let second = Stage::at(scene, start.ahead(&SECOND, [first]), first.run);
        let third = Stage::at(scene, start.ahead(&THIRD, [first, &second]), second.run);
        let fourth = Stage::at(
            scene,
            start.ahead(&FOURTH, [first, &second, &third]),
            third.run,
        );
        *near = fourth.run;
        let stages = [first, &second, &third, &fourth];
        let end = start.ahead(&END, stages);
        *state = crossing::corrected(scene, stages, end, dt).to_state();
        Ok(Step::new(dt, 4))
    }

    fn order(&self) -> u32 {
        4
    }

    fn fixed_step(&self) -> Option<R> {
        Some(self.time_step)
    }

    /// Where a factor of a step on the oscillator passes 1, which is no function of `h λ`: found
    /// among 64 steps and between two of them.
    fn largest_stable_step(&self, stiffness: R, damping: R) -> Option<R> {
        // Without damping every step grows.
        if damping <= R::ZERO {
            return Some(R::ZERO);
        }
        // No step beyond is stable.
        let by_springs = R::from_f64(3.3) / stiffness.sqrt();
        let longest = (R::from_f64(3.8) / damping).at_most(by_springs);
        let part = longest * R::from_f64(1.0 / 64.0);
        let grows = |h: R| oscillator::grows(stiffness * (h * h), damping * h);
        let mut end = part;
        while end < longest && !grows(end) {
            end += part;
        }
        Some(super::last_before([end - part, end], grows))
    }

    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("time step", self.time_step, " s")
    }
}

/// Where a stage stands, and what the stages before it weigh for its place (`A`) and for its
/// velocities (`a`).
struct Row<const N: usize> {
    /// Share of the step.
    time: f64,
    places: [f64; N],
    speeds: [f64; N],
}

const SECOND: Row<1> = Row {
    time: 1.0 / 4.0,
    places: [1.0 / 32.0],
    speeds: [1.0 / 4.0],
};
const THIRD: Row<2> = Row {
    time: 5.0 / 8.0,
    places: [3.0 / 128.0, 11.0 / 64.0],
    speeds: [-5.0 / 16.0, 15.0 / 16.0],
};
const FOURTH: Row<3> = Row {
    time: 1.0,
    places: [11.0 / 50.0, 1.0 / 35.0, 44.0 / 175.0],
    speeds: [47.0 / 35.0, -12.0 / 7.0, 48.0 / 35.0],
};
/// The weights `B` and `b` of the end.
const END: Row<4> = Row {
    time: 1.0,
    places: [1.0 / 10.0, 2.0 / 9.0, 8.0 / 45.0, 0.0],
    speeds: [1.0 / 10.0, 8.0 / 27.0, 64.0 / 135.0, 7.0 / 54.0],
};

/// A stage: what its forces were computed from, and how they bend the path.
struct Stage<R: Real> {
    motion: Motion<R>,
    /// The contacts that touch.
    run: ContactRange,
    /// m/s².
    acceleration: R::Vec3,
    /// N m.
    torque: R::Vec3,
    /// Second derivative of the quaternion, 1/s².
    bend: Rotation<R>,
}

impl<R: Real> Stage<R> {
    // Four copies of the loop over contacts would be no faster and four times as large.
    #[inline(never)]
    fn at<D: Dynamics<R>>(scene: &D, point: Point<R>, near: ContactRange) -> Self {
        let motion = point.motion(scene);
        let run = scene.contacts_near(near, motion.position, &motion.axes);
        let load = scene.load_on(run, &motion);
        let mass = scene.inertia_properties();
        let spin = motion.angular_velocity;
        let turn = load.torque - spin.cross(point.angular_momentum);
        let turn = mass.angular_velocity(&motion.axes, turn);
        let quarter = spin.length_squared() * R::from_f64(-0.25);
        Self {
            motion,
            run,
            acceleration: load.force * mass.inverse_mass() + scene.gravity(),
            torque: load.torque,
            bend: point
                .orientation
                .rate(turn)
                .plus(point.orientation, quarter),
        }
    }
}

/// The start of a step.
struct Start<R: Real> {
    point: Point<R>,
    /// Derivative of the quaternion, 1/s.
    turning: Rotation<R>,
    stage: Stage<R>,
    seconds: R,
}

impl<R: Real> Start<R> {
    #[inline(always)]
    fn of<D: Dynamics<R>>(scene: &D, state: &State<R>, seconds: R, near: ContactRange) -> Self {
        let point = Point::of(state);
        let stage = Stage::at(scene, point, near);
        Self {
            point,
            turning: point.orientation.rate(stage.motion.angular_velocity),
            stage,
            seconds,
        }
    }

    /// The point that a row of the method makes of the start and of so many stages.
    #[inline(always)]
    fn ahead<const N: usize>(&self, row: &Row<N>, stages: [&Stage<R>; N]) -> Point<R> {
        let h = self.seconds;
        let mut point = self.point;
        // Place and turn by their mean rates up to here: a term of h² by itself would be lost in
        // the rounding of the place.
        let (mut velocity, mut turning) = (self.point.linear_velocity, self.turning);
        for ((stage, &place), &speed) in stages.into_iter().zip(&row.places).zip(&row.speeds) {
            let speed = h * R::from_f64(speed);
            // Known when the program is made: the end's last place weighs nothing.
            if place != 0.0 {
                let place = h * R::from_f64(place / row.time);
                velocity += stage.acceleration * place;
                turning = turning.plus(stage.bend, place);
            }
            point.linear_velocity += stage.acceleration * speed;
            point.angular_momentum += stage.torque * speed;
        }
        let along = h * R::from_f64(row.time);
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
            // Of places and speeds both.
            (dot(b, ONES), 1.0 / 1.0),
            (dot(b, c), 1.0 / 2.0),
            (dot(b, squares), 1.0 / 3.0),
            (dot(b, each(c, squares)), 1.0 / 4.0),
            // Of the speeds.
            (dot(b, times(speeds(), c)), 1.0 / 6.0),
            (dot(b, each(c, times(speeds(), c))), 1.0 / 8.0),
            (dot(b, times(speeds(), squares)), 1.0 / 12.0),
            (dot(b, times(speeds(), times(speeds(), c))), 1.0 / 24.0),
            // Of the places, and the number that is free.
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

    /// Of a swing `y'' = -ω² y` in a step of `ω dt = angle`: by what share the angle by which it
    /// goes on is late, and what the factor by which it grows has above 1.
    fn swing(
        angle: f64,
        matrix: Matrix,
        [places, speeds]: [Weights; 2],
        nodes: Weights,
    ) -> [f64; 2] {
        // The stages' accelerations, one after the other, from a place of 1 and from a speed of 1.
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
    fn a_swing_keeps_its_time_and_its_size_better_than_with_the_numbers_of_nystrom() {
        let of = |angle| swing(angle, places(), [END.places, END.speeds], NODES);
        let ours = of(1.0);
        let theirs = swing(
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
        // Order 5: of the angle, and of the growth in a time.
        for (coarse, fine) in ours.into_iter().zip(of(0.5)) {
            assert!(coarse > 32.0 * fine, "{coarse:e} {fine:e}");
        }
    }
}
