//! Requirements of an applied force.

use super::plan::{CheckPlan, cube_directions};
use super::{
    Input, Requirement, Violation, cannot_be, check_centre, demand, demand_at_most, demand_finite,
    ulps, wide,
};
use crate::error::{self, SceneError};
use crate::force::Force;
use crate::real::{Real, Vector};
use crate::state::Motion;

/// Range of motions for which an applied force is intended. The check evaluates nothing beyond it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceRange<R: Real = f64> {
    /// Centre of the region of positions, m.
    pub centre: R::Vec3,
    /// Half of the edge of the region, m, at least 0.
    pub size: R,
    /// Largest speed, m/s, at least 0.
    pub speed: R,
    /// Largest angular speed, rad/s, at least 0.
    pub angular_speed: R,
}

impl<R: Real> ForceRange<R> {
    fn check(&self) -> Result<(), SceneError> {
        check_centre::<R>(self.centre)?;
        error::at_least_zero("size of the range", self.size, " m")?;
        error::at_least_zero("speed of the range", self.speed, " m/s")?;
        error::at_least_zero("angular speed of the range", self.angular_speed, " rad/s")
    }
}

/// Checks an applied force in motions of a range: at rest, with speeds from 10⁻¹² of the largest to
/// the largest in all directions, and in random motions and poses.
///
/// The requirements are:
///
/// - Force, torque, power and the constant part are finite.
/// - A force that is passive does no positive work: `force · v + torque · ω <= 0`, and its power
///   counts as drag.
/// - The sum of drag and drive is the power of force and torque.
/// - The same motion gives the same force, and `is_passive`, `acts` and the constant part never
///   change. A force that does not act is zero.
/// - The force is continuous: a change of the velocities by 10⁻³ of the range in `f32`, and by
///   5·10⁻⁸ of it in `f64`, changes the force and the torque by at most half of their largest
///   values.
///
/// *Limits:* a jump of the force that is small compared with the largest force is not found, nor
/// one that no tried motion crosses.
///
/// ```
/// use tumble::contract::{CheckPlan, ForceRange, check_force};
/// use tumble::glam::DVec3;
/// use tumble::{AirDrag, SpinDrag};
///
/// let range = ForceRange {
///     centre: DVec3::ZERO,
///     size: 10.0,
///     speed: 50.0,
///     angular_speed: 500.0,
/// };
/// let air = (AirDrag::linear(0.01), SpinDrag::linear(1e-6));
/// check_force(&air, &range, CheckPlan::default())?;
/// # Ok::<(), tumble::contract::Violation>(())
/// ```
///
/// # Errors
/// Returns the first [`Violation`], with the requirement that is broken and the motion that breaks
/// it. A quantity of the range that is invalid is named with its rule and its value.
pub fn check_force<R: Real, E: Force<R> + ?Sized>(
    force: &E,
    range: &ForceRange<R>,
    plan: CheckPlan,
) -> Result<(), Violation> {
    range.check().map_err(cannot_be)?;
    force.check().map_err(cannot_be)?;
    let mut check = Check::of(force, range);
    check.constant()?;
    let motions = MOTIONS.saturating_add(plan.cases);
    for index in 0..motions {
        check.motion(&motion(range, plan, index))?;
    }
    // The largest values are known now.
    for index in 0..motions {
        check.continuous(&motion(range, plan, index))?;
    }
    Ok(())
}

/// Fractions of the largest speeds that are combined.
const SHARES: [f64; 5] = [1.0, 0.3, 1e-3, 1e-12, 0.0];
const DIRECTIONS: u32 = 26;
/// Number of fixed motions: each direction with each pair of speeds.
const MOTIONS: u32 = DIRECTIONS * 25;

/// Motion number `index`: the fixed ones first, then random ones.
fn motion<R: Real>(range: &ForceRange<R>, plan: CheckPlan, index: u32) -> Motion<R> {
    let mut draw = CheckPlan {
        seed: plan.seed ^ (u64::from(index) << 20),
        ..plan
    }
    .draw();
    let turn = draw.rotation::<R>();
    let place = draw.place::<R>() * range.size;
    let share = |number: u32| {
        let share = SHARES.get(number as usize % SHARES.len());
        R::from_f64(share.copied().unwrap_or(0.0))
    };
    let (linear, angular) = if index < MOTIONS {
        let pair = index / DIRECTIONS;
        let direction = cube_directions::<R>()
            .nth((index % DIRECTIONS) as usize)
            .unwrap_or(R::Vec3::ZERO);
        // The spin is at an angle to the velocity, except at every third direction.
        let axis = if index % 3 == 0 {
            direction
        } else {
            draw.direction::<R>()
        };
        (direction * share(pair), axis * share(pair / 5))
    } else {
        (
            draw.direction::<R>() * draw.scale::<R>(20),
            draw.direction::<R>() * draw.scale::<R>(20),
        )
    };
    Motion {
        position: range.centre + place,
        axes: turn.axes(),
        linear_velocity: linear * range.speed,
        angular_velocity: angular * range.angular_speed,
    }
}

struct Check<'a, R: Real, E: ?Sized> {
    force: &'a E,
    range: &'a ForceRange<R>,
    /// Largest force, N, and torque, N m, so far.
    largest: [R; 2],
    /// Values of the first calls.
    first: Constants<R>,
}

/// Values of a force that depend on no motion. They must never change.
#[derive(Clone, Copy, PartialEq)]
struct Constants<R: Real> {
    force: Option<R::Vec3>,
    is_passive: bool,
    acts: bool,
}

impl<R: Real> Constants<R> {
    fn of<E: Force<R> + ?Sized>(force: &E) -> Self {
        Self {
            force: force.constant_force(),
            is_passive: force.is_passive(),
            acts: force.acts(),
        }
    }
}

impl<'a, R: Real, E: Force<R> + ?Sized> Check<'a, R, E> {
    fn of(force: &'a E, range: &'a ForceRange<R>) -> Self {
        Self {
            force,
            range,
            largest: [R::ZERO; 2],
            first: Constants::of(force),
        }
    }

    fn constant(&self) -> Result<(), Violation> {
        let constant = self.first.force.map_or(R::ZERO, |force| force.length());
        demand_finite(constant, || Input::AsItIs)?;
        self.steady(|| Input::AsItIs)
    }

    /// Checks that the values that depend on no motion are those of the first calls.
    fn steady(&self, input: impl FnOnce() -> Input) -> Result<(), Violation> {
        let same = self.first == Constants::of(self.force);
        demand(same, Requirement::SameBits, R::ONE, R::ZERO, input)
    }

    fn motion(&mut self, motion: &Motion<R>) -> Result<(), Violation> {
        let input = || input(motion);
        self.steady(input)?;
        let wrench = self.force.wrench(motion);
        let [force, torque] = [wrench.force.length(), wrench.torque.length()];
        demand_finite(force, input)?;
        demand_finite(torque, input)?;
        self.largest = [
            self.largest[0].at_least(force),
            self.largest[1].at_least(torque),
        ];
        if !self.first.acts {
            demand_at_most(force + torque, R::ZERO, Requirement::ActsOrZero, input)?;
        }
        let again = self.force.wrench(motion);
        let off = again.plus(&wrench, -R::ONE);
        let off = off.force.length() + off.torque.length();
        demand_at_most(off, R::ZERO, Requirement::SameBits, input)?;
        self.power(motion)
    }

    fn power(&self, motion: &Motion<R>) -> Result<(), Violation> {
        let input = || input(motion);
        let wrench = self.force.wrench(motion);
        let terms = wrench.force.length() * motion.linear_velocity.length()
            + wrench.torque.length() * motion.angular_velocity.length();
        let rounding = terms * ulps(16.0);
        let (power, stated) = (wrench.power(motion), self.force.power(motion));
        self.steady(input)?;
        if self.first.is_passive {
            demand_at_most(power, rounding, Requirement::PassiveTakes, input)?;
            let drive = stated.drive.abs();
            demand_at_most(drive, R::ZERO, Requirement::PassiveTakes, input)?;
        }
        demand_at_most(stated.drag, rounding, Requirement::PassiveTakes, input)?;
        let off = (stated.drag + stated.drive - power).abs();
        demand_at_most(off, rounding, Requirement::PowerFits, input)
    }

    fn continuous(&self, motion: &Motion<R>) -> Result<(), Violation> {
        let share = R::from_f64(3.0) * R::EPSILON.sqrt();
        let nudge = share.at_most(R::from_f64(1e-3));
        let axis = R::Vec3::new(nudge, -nudge, nudge * R::HALF);
        let moved = Motion {
            linear_velocity: motion.linear_velocity + axis * self.range.speed,
            angular_velocity: motion.angular_velocity + axis * self.range.angular_speed,
            ..*motion
        };
        let change = (self.force.wrench(&moved)).plus(&self.force.wrench(motion), -R::ONE);
        let sizes = [change.force.length(), change.torque.length()];
        for (size, largest) in sizes.into_iter().zip(self.largest) {
            let bound = largest * R::HALF;
            demand_at_most(size, bound, Requirement::Continuous, || input(motion))?;
        }
        Ok(())
    }
}

fn input<R: Real>(motion: &Motion<R>) -> Input {
    Input::Motion {
        linear_velocity: wide::<R>(motion.linear_velocity),
        angular_velocity: wide::<R>(motion.angular_velocity),
    }
}

#[cfg(test)]
mod tests;
