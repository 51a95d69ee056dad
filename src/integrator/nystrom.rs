//! Nyström's method, corrected for contacts that close or open within a step.
//!
//! # Coefficients
//!
//! Three sets of conditions leave three numbers free:
//! - the conditions of the orders (Hairer, Nørsett & Wanner I, section II.14)
//! - `B_i = b_i (1 - c_i)`, which the correction of touch-downs requires
//! - `c_4 = 1`
//!
//! The choice of Nyström (1925) has order 5 if forces depend on the position alone. Here two nodes
//! are `1/4` and `5/8`, and `Σ_ij B_i A_ij c_j = 1/120 - 1/1440`. This choice has smaller errors of
//! phase and amplitude for an oscillation on springs. The matrix `a` then follows from
//! `Σ_i b_i a_ij = b_j (1 - c_j)` and `b_4 a_43 a_32 c_2 = 1/24`. It is the only one that makes the
//! velocities a method of order 4 with these nodes and weights.
//!
//! # Correction of touch-downs
//!
//! The force of a contact that closes is discontinuous by `Δf`, or its derivative is. The weighted
//! sum over the stages then has an error of `h Δf`, whatever the order. The path of the contact
//! between both ends of the step is known, however, and with it the leading term of that error. For
//! each contact that pushes at one end of the step and not at the other, the end of the step is
//! corrected by
//!
//! ```text
//! Δp = h (∫ f ds - Σ b_i f(c_i))     and the pose by     h² (∫ (1 - s) f ds - Σ B_i f(c_i))
//! ```
//! Here `s` is the fraction of the step, and `f(s)` is the normal force for a penetration depth
//! that follows Hermite's cubic between both ends. `f(c_i)` is the force that the stages have used.
//!
//! The arm and the direction `D` of the force are those at both ends:
//! `Δp = Δp_B D(0) + (Δp - Δp_B) D(1)`. This follows from `B_i = b_i (1 - c_i)`, and `Δp_B` is the
//! part that corrects the pose. The remaining error is the effect of one stage on the next. It is
//! smaller by one power of the step size, hence order 2.

mod crossing;
mod oscillator;

use super::rk4::Point;
use super::{Integrator, Step, step_length};
use crate::body::ContactRange;
use crate::contact::Motion;
use crate::error::{self, SceneError, StepError};
use crate::quadrature::bisect;
use crate::real::{Real, Vector};
use crate::rotation::Rotation;
use crate::scene::Dynamics;
use crate::state::State;

/// Nyström's method of order 4, corrected for contacts that close or open within a step.
///
/// Nyström's methods are Runge-Kutta methods for second-order differential equations. This one has
/// the lowest cost for errors between 1e-4 and 1e-6 m when a body rolls and slides.
///
/// The pose `y = (x, q)` follows from its second derivative. Velocity and angular momentum
/// `p = (v, L)` follow from the same loads:
///
/// ```text
/// y_i = y + c_i h y' + h² Σ_j A_ij y''_j     p_i = p + h Σ_j a_ij p'_j
/// x'' = F/m + g                              q'' = (0, J⁻¹ (T - ω × L)) q/2 - ω² q/4
/// ```
/// Here `h` is the step size, `c` are the nodes, and `A` and `a` are the matrices of coefficients.
/// F and T are force and torque of the contacts, and J is the inertia tensor. `(0, v)` is the
/// quaternion with the vector part v, and `ω²` is the squared length of the angular velocity ω.
///
/// Four force evaluations per step. Order 4 in smooth motion, order 5 on linear springs.
///
/// Relative errors of an oscillation on springs at `ω dt = 1`:
///
/// | coefficients | phase | amplitude growth per step |
/// |---|---|---|
/// | this method | 9.9e-5 | 1.9e-4 |
/// | Nyström (1925) | 1.45e-4 | 2.4e-4 |
///
/// *Touch-downs.* When a contact closes, the damper's force is discontinuous, and so is the
/// derivative of the spring's force. Every method of high order then falls to order 1 (Gear &
/// Østerby, ACM Transactions on Mathematical Software 10, 23, 1984; Hairer, Nørsett & Wanner I,
/// section II.6). This method computes the leading term of that error from the path of the contact
/// between both ends of the step. It corrects the end of the step by it, which gives order 2
/// through touch-downs.
///
/// In trial 1 of the coin report, with 150 touch-downs in a second (`tests/physics/truth.rs`):
///
/// | step size | error |
/// |---|---|
/// | 16.1 ms | 8.6e-5 m |
/// | 4 ms | 1.1e-6 m |
/// | 1 ms | 6e-8 m |
///
/// *Limits.* ω and δ are the highest frequency and damping rate that the contacts give the body at
/// their arms (see [integrators](crate#integrators)), and `ζ = δ/2ω`.
/// - *Stable* for `dt < 2.36/ω` and `dt < 2.78/δ`, and up to `3.08/ω` with `ζ = 0.1`, if the
///   damping exceeds the growth stated in the next item.
///   [`Stepper::largest_stable_step`](crate::Stepper::largest_stable_step) computes the limit at a
///   state. It is exact for a body that slides. It is up to 10 % too large if friction damps some
///   motions and not others.
/// - *May add energy.* An oscillation without dampers grows by the relative amount 2.1e-4 (ω dt)⁶
///   per step. Damping of `ζ > 2.1e-4 (ω dt)⁵` removes more than that.
/// - *Not corrected:* a contact that closes and opens again within one step, which only the stages
///   can include, and torques of [rolling and spinning resistance](crate::WithResistance).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Nystrom<R = f64> {
    /// Step size, s, above 0.
    pub time_step: R,
}

impl<R: Real> Integrator<R> for Nystrom<R> {
    /// Contact range of the previous step, in which the next step searches first.
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

    /// The limit is where an amplification factor of the oscillator exceeds 1 in magnitude. The
    /// factor is not a function of `h λ`. The limit is searched among 64 step sizes, then by
    /// bisection.
    fn largest_stable_step(&self, stiffness: R, damping: R) -> Option<R> {
        // Without damping the oscillation grows at every step size.
        if damping <= R::ZERO {
            return Some(R::ZERO);
        }
        // No larger step size is stable.
        let by_springs = R::from_f64(3.3) / stiffness.sqrt();
        let longest = (R::from_f64(3.8) / damping).at_most(by_springs);
        let part = longest * R::from_f64(1.0 / 64.0);
        let grows = |h: R| oscillator::grows(stiffness * (h * h), damping * h);
        let mut end = part;
        while end < longest && !grows(end) {
            end += part;
        }
        let [stable, _] = bisect([end - part, end], super::LIMIT_HALVINGS, grows);
        Some(stable)
    }

    fn check(&self) -> Result<(), SceneError> {
        error::above_zero("time step", self.time_step, " s")
    }
}

/// Time of a stage, and the weights of the previous stages for its pose (`A`) and its velocities
/// (`a`).
struct Row<const N: usize> {
    /// Fraction of the step.
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
/// Weights `B` and `b` of the end of the step.
const END: Row<4> = Row {
    time: 1.0,
    places: [1.0 / 10.0, 2.0 / 9.0, 8.0 / 45.0, 0.0],
    speeds: [1.0 / 10.0, 8.0 / 27.0, 64.0 / 135.0, 7.0 / 54.0],
};

/// A stage of the step: the motion at which its forces were evaluated, and the resulting
/// accelerations.
struct Stage<R: Real> {
    motion: Motion<R>,
    /// Range of the penetrating contacts.
    run: ContactRange,
    /// Acceleration of the centre of mass, m/s², world axes.
    acceleration: R::Vec3,
    /// Torque about the centre of mass, N m, world axes.
    torque: R::Vec3,
    /// Second derivative of the quaternion, 1/s².
    bend: Rotation<R>,
}

impl<R: Real> Stage<R> {
    // Not inlined: four copies of the loop over contacts would be four times as large and no
    // faster.
    #[inline(never)]
    fn at<D: Dynamics<R>>(scene: &D, point: Point<R>, near: ContactRange) -> Self {
        let motion = point.motion(scene);
        let run = scene
            .contact_model()
            .range_near(near, motion.position, &motion.axes);
        let load = scene.contact_model().load_on(run, &motion);
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

/// Start of a step, with its first stage.
struct Start<R: Real> {
    point: Point<R>,
    /// First derivative of the quaternion, 1/s.
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

    /// Returns the point that a row of coefficients gives from the start and the stages so far.
    #[inline(always)]
    fn ahead<const N: usize>(&self, row: &Row<N>, stages: [&Stage<R>; N]) -> Point<R> {
        let h = self.seconds;
        let mut point = self.point;
        // Position and orientation advance by their mean rates up to this time. A separate term of
        // h² would be lost in the rounding of the position.
        let (mut velocity, mut turning) = (self.point.linear_velocity, self.turning);
        for ((stage, &place), &speed) in stages.into_iter().zip(&row.places).zip(&row.speeds) {
            let speed = h * R::from_f64(speed);
            // Known at compile time. The last position weight of the end is zero.
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
    fn swing(
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
        // Order 5 for the phase, and for the growth per unit of time.
        for (coarse, fine) in ours.into_iter().zip(of(0.5)) {
            assert!(coarse > 32.0 * fine, "{coarse:e} {fine:e}");
        }
    }
}
