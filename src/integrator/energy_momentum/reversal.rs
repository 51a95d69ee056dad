//! A point of a rim at which friction reverses.

use super::dual::direction;
use super::problem::Problem;
use super::touch::{Push, Touch};
use crate::real::{Real, Vector};
use crate::scene::Dynamics;

/// A point of a rim at which friction reverses, between the points on either side.
///
/// A shift `δ` of the slip moves that point by `δ/u'`, where `u'` is the slope of the slip along
/// the rim. The neighbouring points move with the rim and keep their friction, which is far from
/// its reversal. Their own derivatives therefore do not contain the reversal. The friction that
/// changes its sign is `2 μ p δ/u'`, with `p` the load per length at the reversal. For any law,
/// `μ p` follows from the frictions on both sides. The slope `u'` is that of the parabolas through
/// the slips of three points, two on one side and one on the other. It differs from the slope
/// between the two nearest points by several per cent, and with it the rate at which Newton's
/// iteration converges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reversal<R: Real> {
    /// Lever arm from the centre of mass, mean over the step, m.
    pub(super) arm: R::Vec3,
    /// Lever arm at the end of the step, m.
    pub(super) end_arm: R::Vec3,
    /// Direction in which the slip changes along the rim, unit vector.
    pub(super) direction: R::Vec3,
    /// Resistance to a slip in that direction, excluding that of the points themselves, N s/m.
    pub(super) coefficient: R,
}

impl<R: Real> Reversal<R> {
    /// Creates the reversal between the middle two of four neighbouring points if their slips are
    /// opposite.
    pub(super) fn between<D: Dynamics<R>>(
        problem: &Problem<'_, R, D>,
        [before, left, right, after]: [&Touch<R>; 4],
        points_per_metre: R,
    ) -> Option<Self> {
        let (a, b) = (&left.push, &right.push);
        let is_beside =
            |touch: &Touch<R>| touch.push.surface == a.surface && touch.push.is_active();
        if !(is_beside(left) && is_beside(right) && a.slip.dot(b.slip) < R::ZERO) {
            return None;
        }
        let change = b.slip - a.slip;
        let direction = direction::<R>(change);
        let slips = [before, left, right, after].map(|touch| touch.push.slip.dot(direction));
        let gap = |from: &Touch<R>, to: &Touch<R>| (to.arm - from.arm).length();
        let gaps = [gap(before, left), gap(left, right), gap(right, after)];
        // Position of the reversal between the two points, from 0 to 1.
        let place = slips[1] / (slips[1] - slips[2]);
        // The slip of a point that is not active is that of an earlier trial.
        let bend = if is_beside(before) && is_beside(after) {
            relative_slope(slips, gaps, place)
        } else {
            R::ONE
        };
        let braking = |push: &Push<R>| -push.force.dot(direction) / push.weight;
        let reversed = (braking(b) * place - braking(a) * (R::ONE - place)) * R::TWO;
        let slope = reversed / (change.length() * bend);
        let of_points = (left.friction_slope(problem) + right.friction_slope(problem)) * R::HALF;
        let coefficient = (slope - of_points) * (gaps[1] * points_per_metre);
        (coefficient > R::ZERO).then(|| Self {
            arm: (a.arm + b.arm) * R::HALF,
            end_arm: (a.end_arm + b.end_arm) * R::HALF,
            direction,
            coefficient,
        })
    }
}

/// Slope of a function at a position (0 to 1) between the middle two of four points, divided by the
/// slope between these two. The function is known at the points by its values and by the gaps
/// between them. A slope of less than half is not used.
fn relative_slope<R: Real>(values: [R; 4], gaps: [R; 3], place: R) -> R {
    let slope = |i: usize| (values[i + 1] - values[i]) / gaps[i];
    let [first, middle, last] = [slope(0), slope(1), slope(2)];
    let bend = (middle - first) / (gaps[0] + gaps[1]) + (last - middle) / (gaps[1] + gaps[2]);
    let more = bend * (place - R::HALF) * gaps[1] / middle;
    if more > -R::HALF {
        R::ONE + more
    } else {
        R::ONE
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Coulomb, Disc, Energy, FlatGround, State, Stepper};
    use glam::DVec3;

    /// Four neighbouring points with these slips along y, m/s.
    fn four_points(slips: [f64; 4], active: [bool; 4]) -> [Touch<f64>; 4] {
        core::array::from_fn(|i| {
            let mut touch = Touch::NONE;
            touch.arm = DVec3::new(0.0, 0.01 * i as f64, -0.3);
            touch.push.slip = DVec3::Y * slips[i];
            touch.push.force = DVec3::Y * -slips[i].signum();
            (touch.push.normal, touch.push.weight) = (DVec3::Z, 2.0);
            touch.push.mean.force = if active[i] { 2.0 } else { 0.0 };
            touch
        })
    }

    fn coefficient(points: &[Touch<f64>; 4]) -> Option<f64> {
        let stepper = Stepper::builder(Disc::<f64>::solid(1.0, 0.3, 40))
            .ground(FlatGround::level(1e3, 1.0))
            .friction(Coulomb {
                coefficient: 0.3,
                slip_speed: 1e-3,
            })
            .build()
            .unwrap();
        let start = State::at(DVec3::Z * 0.3);
        let energy = Energy::of(stepper.scene(), &start);
        let problem = Problem::new(stepper.scene(), &start, &energy, 1e-3);
        Reversal::between(&problem, points.each_ref(), 100.0).map(|found| found.coefficient)
    }

    /// The slip of a point that is not active is that of an earlier trial, or of an earlier step.
    #[test]
    fn a_reversal_of_friction_reads_no_slip_of_a_point_that_is_not_active() {
        let all = |slips| coefficient(&four_points(slips, [true; 4]));
        let [flat, bent] = [[-0.25, -0.05, 0.15, 0.35], [-0.25, -0.05, 0.15, 0.5]].map(all);
        assert!(flat.is_some() && flat != bent, "{flat:?}");
        for active in [[true, true, true, false], [false, true, true, true]] {
            for outer in [0.5, -7.0, f64::NAN] {
                let left = if active[0] { -0.25 } else { outer };
                let right = if active[3] { 0.35 } else { outer };
                let slips = [left, -0.05, 0.15, right];
                assert_eq!(coefficient(&four_points(slips, active)), flat, "{outer}");
            }
        }
        let inner = four_points([-0.25, -0.05, 0.15, 0.35], [true, true, false, true]);
        assert_eq!(coefficient(&inner), None);
    }
}
